//! The truth on known areas, and against three other ways to the same picture: exact fractions,
//! brute-force sampling, and another renderer sixteen times as large.

mod against_resvg;
mod clips_and_groups;
mod gradients;
mod groups_and_patterns;
mod known_areas;
mod random_scenes;
mod strokes;

use super::{render, Options, Truth};
use crate::Viewport;
use kurbo::Affine;

/// A drawing of `width` x `height` user units, shown at one unit a pixel.
fn tree(width: u32, height: u32, body: &str) -> usvg::Tree {
    let svg =
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}'>{body}</svg>");
    usvg::Tree::from_str(&svg, &usvg::Options::default()).expect("valid SVG")
}

fn truth_with(width: u32, height: u32, body: &str, options: &Options) -> Truth {
    let viewport = Viewport { width, height, transform: Affine::IDENTITY };
    let truth = render(&tree(width, height, body), &viewport, options).expect("a picture");
    assert!(truth.area_defect < 1e-9, "areas sum to 1, not off by {}", truth.area_defect);
    assert_eq!(truth.approximate, 0, "all pixels are cut at all crossings");
    truth
}

fn truth(width: u32, height: u32, body: &str) -> Truth {
    truth_with(width, height, body, &Options::default())
}

/// Alpha in column `x` and row `y`, 0..=1.
fn alpha(truth: &Truth, x: u32, y: u32) -> f64 {
    truth.straight(x, y)[3] / 255.0
}

/// The sum of all pixels' alpha: an area.
fn area(truth: &Truth) -> f64 {
    truth.premultiplied().iter().map(|pixel| pixel[3] / 255.0).sum()
}

#[track_caller]
fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted} within {tolerance}");
}

/// A small generator of numbers: the same on every machine.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A whole number in [from, to).
    fn whole(&mut self, from: i64, to: i64) -> i64 {
        from + (self.next() % (to - from) as u64) as i64
    }

    /// A number in [from, to).
    fn real(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}
