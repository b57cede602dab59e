//! What the integration tests share: SVG text, rendering, comparison in 8-bit levels, and the
//! oracles. Points are in pixels, y downward; pixel (x, y) is the half-open square
//! [x, x+1) × [y, y+1).

// Each test file is a program of its own and uses its own part of this module.
#![allow(dead_code)]

mod oracles;

pub use oracles::*;
use std::fmt::Write;
use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// Farthest an 8-bit level may lie from the true one where all edges are straight: half a level of
/// rounding and a tenth for the renderer's own arithmetic.
pub const STRAIGHT: f64 = 0.6;
/// The same where curves or strokes are flattened at the default tolerance.
pub const CURVED: f64 = 1.0;

// --------------------------------------------------------------------------------------- drawing

/// A point in pixels.
pub type Point = [f64; 2];

/// An SVG document of `width` × `height` user units, one a pixel.
pub fn svg(width: u32, height: u32, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">{body}</svg>"
    )
}

/// Path data of one closed polygon.
pub fn ring(points: &[Point]) -> String {
    let mut d = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        write!(d, "{}{x} {y}", if i == 0 { 'M' } else { 'L' }).unwrap();
    }
    d.push('Z');
    d
}

/// Path data of several closed polygons.
pub fn rings(polygons: &[Vec<Point>]) -> String {
    polygons.iter().map(|polygon| ring(polygon)).collect()
}

/// A path element with this data, fill and further attributes.
pub fn path(d: &str, fill: &str, attributes: &str) -> String {
    format!("<path d=\"{d}\" fill=\"{fill}\" {attributes}/>")
}

/// A filled rectangle with corners (x0, y0) and (x1, y1).
pub fn rect(x0: f64, y0: f64, x1: f64, y1: f64, fill: &str) -> String {
    path(&ring(&corners(x0, y0, x1, y1)), fill, "")
}

/// The corners of a rectangle, clockwise on the screen.
pub fn corners(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
    vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

/// A black document with white shapes, whose pixels are 255 times the coverage.
pub fn white_on_black(width: u32, height: u32, d: &str, attributes: &str) -> String {
    let black = rect(0.0, 0.0, width.into(), height.into(), "#000");
    svg(width, height, &(black + &path(d, "#fff", attributes)))
}

/// `#rrggbb`.
pub fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

// ------------------------------------------------------------------------------------- rendering

/// The default settings, on one thread: the tests themselves run side by side.
pub fn settings() -> Settings {
    Settings { threads: 1, ..Settings::default() }
}

/// Parses a document that must be good.
pub fn scene(document: &str) -> Scene {
    Scene::from_bytes(document.as_bytes(), &Options::default()).expect("the test's own SVG parses")
}

/// Renders a document at its own size.
pub fn render(document: &str) -> Pixmap {
    render_with(document, settings())
}

/// Renders a document at its own size with these settings.
pub fn render_with(document: &str, settings: Settings) -> Pixmap {
    let scene = scene(document);
    let size = scene.size();
    let viewport = Viewport::fit(&scene, size.width.round() as u32, size.height.round() as u32);
    Renderer::new(settings).expect("good settings").render(&scene, &viewport).expect("a picture")
}

// ------------------------------------------------------------------------------------ comparison

/// A pixel in premultiplied 8-bit levels.
pub fn premultiplied([r, g, b, a]: [u8; 4]) -> [f64; 4] {
    let alpha = f64::from(a) / 255.0;
    [f64::from(r) * alpha, f64::from(g) * alpha, f64::from(b) * alpha, f64::from(a)]
}

/// The largest difference between two colours' channels.
pub fn distance(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Holds one straight RGBA pixel against its true value in 8-bit levels.
#[track_caller]
pub fn assert_levels(actual: [u8; 4], expected: [f64; 4], tolerance: f64) {
    let off = distance(actual.map(f64::from), expected);
    assert!(off <= tolerance, "pixel is {actual:?}, should be {expected:?} within {tolerance}: off by {off}");
}

/// A picture in which there is something: two empty ones are alike and prove nothing.
#[track_caller]
pub fn assert_drawn(picture: &Pixmap, what: &str) {
    assert!(picture.data().chunks(4).any(|pixel| pixel[3] > 0), "{what}: the picture is empty");
}

/// Two pictures with the very same bytes.
#[track_caller]
pub fn assert_same_bytes(actual: &Pixmap, expected: &Pixmap, what: &str) {
    assert_within(actual, expected, 0.0, what);
    assert!(actual.data() == expected.data(), "{what}: bytes differ where the alpha is 0");
}

/// Two pictures of one size, no premultiplied channel of which differs by more than `levels`.
#[track_caller]
pub fn assert_within(actual: &Pixmap, expected: &Pixmap, levels: f64, what: &str) {
    assert_eq!((actual.width(), actual.height()), (expected.width(), expected.height()), "{what}: sizes");
    assert_mapped_within(actual, expected, levels, what, |x, y| (x, y));
}

/// As [`assert_within`], where pixel (x, y) of `actual` belongs to pixel `source(x, y)` of `expected`.
#[track_caller]
pub fn assert_mapped_within(
    actual: &Pixmap,
    expected: &Pixmap,
    levels: f64,
    what: &str,
    source: impl Fn(u32, u32) -> (u32, u32),
) {
    assert_drawn(expected, what);
    for y in 0..actual.height() {
        for x in 0..actual.width() {
            let (from_x, from_y) = source(x, y);
            let (a, e) = (actual.pixel(x, y), expected.pixel(from_x, from_y));
            // Two roundings of a straight colour may shift a premultiplied one by this much more.
            let slack = if levels > 0.0 && a[3] < 255 { 1.0 } else { 0.0 };
            let off = distance(premultiplied(a), premultiplied(e));
            assert!(
                off <= levels + slack,
                "{what}: pixel ({x}, {y}) is {a:?}, in the other picture {e:?}: off by {off} of {levels}"
            );
        }
    }
}

/// Holds a picture against an oracle's.
#[track_caller]
pub fn assert_matches(actual: &Pixmap, truth: &Truth, levels: f64, what: &str) {
    let (off, [x, y]) = worst(actual, truth);
    assert!(
        off <= levels,
        "{what}: pixel ({x}, {y}) is {:?}, should be {:?}: off by {off:.3} of {levels}",
        actual.pixel(x, y),
        truth.pixel(x, y)
    );
}

/// The largest error in levels and where it is.
pub fn worst(actual: &Pixmap, truth: &Truth) -> (f64, [u32; 2]) {
    assert_eq!((actual.width(), actual.height()), (truth.width, truth.height), "sizes");
    let mut worst = (0.0, [0, 0]);
    for y in 0..truth.height {
        for x in 0..truth.width {
            let off = distance(premultiplied(actual.pixel(x, y)), truth.pixel(x, y));
            if off > worst.0 {
                worst = (off, [x, y]);
            }
        }
    }
    worst
}

/// The mean error in levels over all pixels, each by its worst channel.
pub fn mean_error(actual: &Pixmap, truth: &Truth) -> f64 {
    let mut sum = 0.0;
    for y in 0..truth.height {
        for x in 0..truth.width {
            sum += distance(premultiplied(actual.pixel(x, y)), truth.pixel(x, y));
        }
    }
    sum / f64::from(truth.width * truth.height)
}

// ---------------------------------------------------------------------------------------- chance

/// SplitMix64 (Steele, Lea & Flood 2014): the same numbers on every machine.
pub struct Rng(u64);

impl Rng {
    /// The sequence of this seed.
    pub fn new(seed: u64) -> Rng {
        Rng(seed)
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer in [0, n).
    pub fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    /// A number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A multiple of 1/64 in [low, high): exact in usvg's single precision.
    pub fn on_grid(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low, high) * 64.0).floor() / 64.0
    }

    /// A point with both coordinates from [`Rng::on_grid`].
    pub fn point(&mut self, low: f64, high: f64) -> Point {
        [self.on_grid(low, high), self.on_grid(low, high)]
    }

    /// Any opaque colour.
    pub fn colour(&mut self) -> [u8; 3] {
        let bits = self.bits();
        [bits as u8, (bits >> 8) as u8, (bits >> 16) as u8]
    }
}
