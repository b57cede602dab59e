//! `cone`: takes each shape's share of a disk around each pixel's centre, makes pixels by painting the
//! shapes over one another: Amanatides, *Ray Tracing with Cones* (1984), seen in the plane, where the
//! cone through a pixel is a disk.
//!
//! The disk has the pixel's area, so its radius is 1/sqrt(pi): it leaves out the pixel's corners and takes
//! in as much of its four neighbours. A shape's share is exact for polygons: circular segments and
//! trapezoids between the disk's border and the shape's. At the picture's upper and lower border, where
//! nothing is known beyond, the disk ends with the picture.
//!
//! Amanatides goes front to back and keeps nothing of a shape but its fraction of the disk: what is left
//! for those behind is multiplied by the rest. Here the same products are made from the back, which comes
//! to the same and lets `--linear` mix each shape's part with the rest in linear light. What that gets
//! wrong: fractions say nothing of where; two halves of a pixel that abut leave a quarter of what lies
//! behind, as in `area`. And disks overlap: an edge is blurred a little over more pixels, and a pixel's
//! light is not kept, its corners count for nothing.

use super::footprint::Footprint;
use super::shares::SharePainter;
use super::BandPainter;

/// The disk of the pixel's area.
struct Disk;

/// 1/sqrt(pi).
const RADIUS: f64 = 0.564_189_583_547_756_3;

impl Footprint for Disk {
    const REACH: f64 = RADIUS;

    fn half_area(from: f64, to: f64) -> f64 {
        // The integral of sqrt(r^2 - y^2).
        let until = |y: f64| {
            let y = y.clamp(-RADIUS, RADIUS);
            0.5 * (y * Disk::reach_at(y) + RADIUS * RADIUS * libm::asin(y / RADIUS))
        };
        until(to) - until(from)
    }

    fn reach_at(y: f64) -> f64 {
        (RADIUS * RADIUS - y * y).max(0.0).sqrt()
    }

    fn meets(x: f64, slope: f64) -> [f64; 4] {
        // (x + slope y)^2 + y^2 = r^2
        let a = 1.0 + slope * slope;
        let half_b = x * slope;
        let root = (half_b * half_b - a * (x * x - RADIUS * RADIUS)).sqrt();
        let (first, second) = ((-half_b - root) / a, (-half_b + root) / a);
        [first, second, first, second]
    }
}

pub(super) fn painter(width: u32, height: u32) -> Box<dyn BandPainter> {
    Box::new(SharePainter::<Disk>::new(width, height))
}
