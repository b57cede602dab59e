//! `area`: takes each shape's exact area in each pixel, makes pixels by painting the shapes over one
//! another, as most renderers do: coverage times opacity, source over, from the back.
//!
//! Promises: the picture of one shape on an even ground is exact, by another road than `exact` takes; but
//! for pixels with dozens of its borders, which are cut in 64 lines.
//! What it gets wrong is why this project exists: that two shapes cover half a pixel each does not say
//! whether they lie side by side or over one another, so what lies behind shines through along shared
//! borders and around what is covered. Clips are products of areas, with the same error. `--linear`
//! mixes each shape's covered part with the rest in linear light.

use super::footprint::Footprint;
use super::shares::SharePainter;
use super::BandPainter;

/// The pixel itself.
struct Square;

impl Footprint for Square {
    const REACH: f64 = 0.5;

    fn half_area(from: f64, to: f64) -> f64 {
        0.5 * (to - from)
    }

    fn reach_at(_: f64) -> f64 {
        0.5
    }

    fn meets(x: f64, slope: f64) -> [f64; 4] {
        let (a, b) = ((-0.5 - x) / slope, (0.5 - x) / slope);
        [a, b, a, b]
    }
}

pub(super) fn painter(width: u32, height: u32) -> Box<dyn BandPainter> {
    Box::new(SharePainter::<Square>::new(width, height))
}
