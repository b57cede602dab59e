//! Shapes that abut show no seam, and what is finer than a pixel keeps its light.

use super::*;

/// A triangulation of more than the picture: a jittered grid whose cells are cut along either diagonal.
fn triangulation(rng: &mut Rng, pitch: f64) -> Vec<Vec<Point>> {
    let count = (f64::from(SIDE) / pitch) as usize + 4;
    let mut grid = vec![vec![[0.0; 2]; count]; count];
    for (j, row) in grid.iter_mut().enumerate() {
        for (i, point) in row.iter_mut().enumerate() {
            let jitter = |rng: &mut Rng| rng.on_grid(-0.3 * pitch, 0.3 * pitch);
            *point = [(i as f64 - 1.0) * pitch + jitter(rng), (j as f64 - 1.0) * pitch + jitter(rng)];
        }
    }
    let mut triangles = Vec::new();
    for j in 0..count - 1 {
        for i in 0..count - 1 {
            let [a, b, c, d] = [grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]];
            let (first, second) =
                if rng.below(2) == 0 { ([a, b, c], [a, c, d]) } else { ([a, b, d], [b, c, d]) };
            triangles.push(first.to_vec());
            triangles.push(second.into_iter().rev().collect());
        }
    }
    triangles
}

#[test]
fn a_tiling_in_one_colour_is_that_colour_exactly() {
    let mut rng = Rng::new(12);
    for pitch in [7.25, 2.5, 0.75] {
        let body: String =
            triangulation(&mut rng, pitch).iter().map(|t| path(&ring(t), "#4e8a2c", "")).collect();
        for settings in [settings(), Settings { linear: true, ..settings() }] {
            let picture = render_with(&svg(SIDE, SIDE, &body), settings);
            assert!(picture.data().chunks(4).all(|p| p == [0x4e, 0x8a, 0x2c, 255]), "pitch {pitch}");
        }
    }
}

#[test]
fn a_tiling_hides_what_is_behind_it() {
    let mut rng = Rng::new(13);
    for pitch in [6.5, 1.25] {
        let mut body = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#f00");
        for triangle in triangulation(&mut rng, pitch) {
            let [_, g, b] = rng.colour();
            body += &path(&ring(&triangle), &hex([0, g, b]), "");
        }
        let picture = render(&svg(SIDE, SIDE, &body));
        assert!(picture.data().chunks(4).all(|p| p[0] == 0 && p[3] == 255), "red shows at pitch {pitch}");
    }
}

#[test]
fn a_tiling_shows_no_seam_under_opacity_clip_or_gradient() {
    let mut rng = Rng::new(14);
    let triangles = triangulation(&mut rng, 3.75);
    let tiles = |fill: &str, attributes: &str| -> String {
        triangles.iter().map(|t| path(&ring(t), fill, attributes)).collect()
    };
    let whole = |fill: &str, attributes: &str| path("M-9 -9H99V99H-9Z", fill, attributes);
    let defs = "<clipPath id=\"c\"><path d=\"M3 2.5L30 5.25L26.5 29L2 20Z\"/></clipPath>\
                <linearGradient id=\"g\" gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"32\" y2=\"16\">\
                <stop stop-color=\"#f60\"/><stop offset=\"1\" stop-color=\"#06f\"/></linearGradient>";
    let half = "fill-opacity=\".5\"";
    let cases = [
        ("each tile half opaque", tiles("#8c4", half), whole("#8c4", half), 0.0),
        (
            "the group half opaque",
            format!("<g opacity=\".5\">{}</g>", tiles("#8c4", "")),
            format!("<g opacity=\".5\">{}</g>", whole("#8c4", "")),
            0.0,
        ),
        (
            "the group clipped",
            format!("<g clip-path=\"url(#c)\">{}</g>", tiles("#8c4", "")),
            format!("<g clip-path=\"url(#c)\">{}</g>", whole("#8c4", "")),
            1.0,
        ),
        (
            "each tile clipped",
            tiles("#8c4", "clip-path=\"url(#c)\""),
            whole("#8c4", "clip-path=\"url(#c)\""),
            1.0,
        ),
        ("one gradient", tiles("url(#g)", ""), whole("url(#g)", ""), 1.0),
    ];
    for (what, tiled, plain, levels) in cases {
        let draw = |body: &str| render(&svg(SIDE, SIDE, &format!("{defs}{body}")));
        let plain = draw(&plain);
        assert_within(&draw(&tiled), &plain, levels, what);
    }
}

/// A fence of 90 slanted bars narrower than half a pixel, moved by `shift`, inside 128 × 128 pixels.
///
/// The widths are no multiples of a 64th: 255 levels times such a part would all round upwards.
fn fence(shift: f64) -> Vec<Vec<Point>> {
    let mut rng = Rng::new(20);
    let bar = |i: i32| {
        let left = 8.0 + f64::from(i) * 57.0 / 64.0 + rng.between(0.0, 0.25);
        let right = left + rng.between(0.2, 0.5);
        let slant = 23.0;
        let points = [[left, 8.0], [right, 8.0], [right + slant, 116.0], [left + slant, 116.0]];
        points.map(|p| p.map(|v| f64::from((v + shift) as f32))).to_vec()
    };
    (0..90).map(bar).collect()
}

#[test]
fn a_fence_finer_than_a_pixel_keeps_its_light_while_it_moves() {
    let light = |bars: &[Vec<Point>], as_shapes: bool| {
        let body = if as_shapes {
            bars.iter().map(|bar| path(&ring(bar), "#fff", "")).collect()
        } else {
            path(&rings(bars), "#fff", "")
        };
        let picture = render(&svg(128, 128, &(rect(0.0, 0.0, 128.0, 128.0, "#000") + &body)));
        picture.data().chunks(4).map(|p| f64::from(p[0])).sum::<f64>() / 255.0
    };
    for step in (0..=64).step_by(8).chain([1, 5, 13]) {
        let bars = fence(f64::from(step) / 64.0);
        let expected: f64 = bars.iter().map(|bar| area(bar)).sum();
        for as_shapes in [false, true] {
            let found = light(&bars, as_shapes);
            let off = (found / expected - 1.0).abs();
            assert!(off < 1e-4, "step {step}: light {found}, should be {expected}: off by {off}");
        }
    }
}
