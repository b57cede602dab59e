//! Images and patterns as SVG places them, held against many points of each pixel: the truth is asked of the
//! squares themselves, at places worked out by hand.

mod support;

use base64::prelude::{Engine, BASE64_STANDARD};
use support::svg;
use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// A grey square of an image.
fn square(x: usize, y: usize) -> u8 {
    ((x * 37 + y * 101 + x * y * 7) % 256) as u8
}

/// An image of these, as a data URL.
fn url(width: u32, height: u32) -> String {
    let picture =
        image::GrayImage::from_fn(width, height, |x, y| image::Luma([square(x as usize, y as usize)]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes all");
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes.into_inner()))
}

fn drawn(document: &str, side: u32) -> Pixmap {
    let scene = Scene::from_bytes(document.as_bytes(), &Options::default()).expect("good SVG");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let settings = Settings { threads: 1, ..Settings::default() };
    let viewport = Viewport::fit(&scene, side, side);
    Renderer::new(settings).and_then(|mut renderer| renderer.render(&scene, &viewport)).expect("a picture")
}

/// Of 32 x 32 points of a pixel, the mean value times alpha and the mean alpha, where `value` knows both.
fn points((x, y): (u32, u32), value: impl Fn(f64, f64) -> Option<u8>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for i in 0..1024 {
        let (dx, dy) = ((f64::from(i % 32) + 0.5) / 32.0, (f64::from(i / 32) + 0.5) / 32.0);
        if let Some(v) = value(f64::from(x) + dx, f64::from(y) + dy) {
            sums[0] += f64::from(v) / 1024.0;
            sums[1] += 255.0 / 1024.0;
        }
    }
    sums
}

/// How far a grey picture is from points, in levels: in the mean, and at worst.
fn off(picture: &Pixmap, value: impl Fn(f64, f64) -> Option<u8>) -> (f64, f64) {
    off_within(picture, 0..picture.width(), value)
}

/// The same of the pixels in a range of columns and rows.
fn off_within(
    picture: &Pixmap,
    range: std::ops::Range<u32>,
    value: impl Fn(f64, f64) -> Option<u8>,
) -> (f64, f64) {
    let (mut sum, mut worst) = (0.0, 0.0f64);
    for y in range.clone() {
        for x in range.clone() {
            let [grey, alpha] = points((x, y), &value);
            let [r, _, _, a] = picture.pixel(x, y).map(f64::from);
            let off = (r * a / 255.0 - grey).abs().max((a - alpha).abs());
            (sum, worst) = (sum + off, worst.max(off));
        }
    }
    (sum / (range.len() * range.len()) as f64, worst)
}

/// Half a level of rounding, of a colour and of its alpha.
const ROUNDED: f64 = 1.1;

#[test]
fn an_image_made_smaller_is_where_its_aspect_ratio_puts_it() {
    let (width, height) = (160.0, 80.0);
    let url = url(160, 80);
    // The box is 20 x 20 pixels. Of its texels as many are in a pixel, and begin at such places, that points
    // see them all alike.
    let (left, top) = (2.25, 1.75);
    for (ratio, texels, corner) in [
        ("none", [8.0, 4.0], [left, top]),
        ("xMidYMid meet", [8.0; 2], [left, top + 5.0]),
        ("xMinYMax meet", [8.0; 2], [left, top + 10.0]),
        ("xMidYMid slice", [4.0; 2], [left - 10.0, top]),
        ("xMaxYMin slice", [4.0; 2], [left - 20.0, top]),
    ] {
        for rendering in ["auto", "pixelated", "optimizeSpeed"] {
            let element = format!(
                "<image x='{left}' y='{top}' width='20' height='20' preserveAspectRatio='{ratio}' \
                 style='image-rendering:{rendering}' href='{url}'/>"
            );
            let value = |x: f64, y: f64| {
                let inside = (left..left + 20.0).contains(&x) && (top..top + 20.0).contains(&y);
                let (column, row) = ((x - corner[0]) * texels[0], (y - corner[1]) * texels[1]);
                let inside = inside && (0.0..width).contains(&column) && (0.0..height).contains(&row);
                inside.then(|| square(column as usize, row as usize))
            };
            let picture = drawn(&svg(24, 24, &element), 24);
            let ((mean, worst), (_, worst_inside)) =
                (off(&picture, value), off_within(&picture, 3..21, value));
            println!("{ratio}, {rendering}: {mean:.3}, at worst {worst:.2}, inside {worst_inside:.2}");
            // What the box's sides cut off a pixel is still part of the mean that is seen in the rest.
            let most = if ratio.ends_with("slice") { 14.0 } else { ROUNDED };
            assert!(worst < most && mean < 0.6, "{ratio}, {rendering}: {mean}, {worst}");
            assert!(worst_inside < ROUNDED, "{ratio}, {rendering}: {worst_inside}");
        }
    }
}

#[test]
fn squares_that_are_enlarged_along_one_side_alone_stay_squares() {
    let element = format!(
        "<image width='24' height='20' preserveAspectRatio='none' style='image-rendering:pixelated' href='{}'/>",
        url(768, 8)
    );
    let (mean, worst) = off(&drawn(&svg(24, 24, &element), 24), |x, y| {
        (y < 20.0).then(|| square((x * 32.0) as usize, (y / 2.5) as usize))
    });
    println!("{mean:.3}, at worst {worst:.2}");
    assert!(worst < ROUNDED, "{mean}, {worst}");
}

#[test]
fn tiles_too_small_to_be_counted_are_their_mean_however_they_lie() {
    for tile in [1e-3, 1e-6] {
        for transform in ["", "rotate(30)", "rotate(77) skewX(40)", "scale(3,.2)"] {
            let half = tile / 2.0;
            let body = format!(
                "<pattern id='p' width='{tile}' height='{tile}' patternUnits='userSpaceOnUse' \
                 patternTransform='{transform}'><rect width='{half}' height='{tile}' fill='#c80000'/>\
                 <rect x='{half}' width='{half}' height='{half}' fill='#0000c8'/></pattern>\
                 <rect width='16' height='16' fill='url(#p)'/>"
            );
            let picture = drawn(&svg(16, 16, &body), 16);
            for y in 0..16 {
                for x in 0..16 {
                    let [r, g, b, a] = picture.pixel(x, y).map(f64::from);
                    // Half red, a quarter blue, a quarter nothing.
                    let found = [r * a / 255.0, g, b * a / 255.0, a];
                    let right = [100.0, 0.0, 50.0, 191.25];
                    let off = found.iter().zip(right).map(|(v, right)| (v - right).abs()).fold(0.0, f64::max);
                    assert!(off < 1.5, "{tile} {transform}: {found:?} at {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn what_an_image_of_svg_holds_blends_with_nothing_outside_it() {
    let image = "<svg xmlns='http://www.w3.org/2000/svg' width='10' height='10'>\
                 <rect width='10' height='10' fill='%23fc0' style='mix-blend-mode:multiply'/></svg>"
        .replace('<', "&lt;");
    let body = format!(
        "<rect width='16' height='16' fill='#00f'/><image width='10' height='10' href=\"data:image/svg+xml;utf8,{image}\"/>"
    );
    let picture = drawn(&svg(16, 16, &body), 16);
    assert_eq!(picture.pixel(5, 5), [255, 204, 0, 255]);
    assert_eq!(picture.pixel(12, 12), [0, 0, 255, 255]);
}
