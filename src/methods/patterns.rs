//! Where in a pixel the sampled methods look: takes the pixel's place in the picture, makes N points.
//!
//! All but the grid differ from pixel to pixel, so that what they miss is noise and no pattern (Cook,
//! *Stochastic Sampling in Computer Graphics*, TOG 1986). Promises: integers throughout, so that a pixel
//! has the same points on every machine.

use crate::edges::{FRACTION_BITS, ONE};
use std::sync::OnceLock;

/// Darts that may miss one after the other before the disks become smaller.
const MOST_MISSES: u32 = 300;

/// What the radius of the disks shrinks to, in 1/32, when darts find no room.
const SHRINK: i64 = 31;

/// A kind of pattern, and how many points it has.
#[derive(Clone, Debug)]
pub(crate) enum Pattern {
    /// N x N, regular.
    Grid(u16),
    /// Anywhere.
    Random(u16),
    /// One in each of N cells of equal area.
    Jitter(u16),
    /// N points that keep their distance from each other.
    Poisson(PoissonTile),
}

impl Pattern {
    /// How many points it has.
    pub fn count(&self) -> usize {
        match self {
            Pattern::Grid(side) => usize::from(*side) * usize::from(*side),
            Pattern::Random(count) | Pattern::Jitter(count) => usize::from(*count),
            Pattern::Poisson(tile) => usize::from(tile.count),
        }
    }

    /// Replaces `points` by those of the pixel at column `x` and row `y`: 0 .. ONE, in fixed point from
    /// the pixel's top left corner.
    pub fn points(&self, (x, y): (u32, u32), points: &mut Vec<(i32, i32)>) {
        let mut random = Random::of_pixel(x, y);
        points.clear();
        match self {
            Pattern::Grid(side) => {
                let (cells, side) = (i32::from(*side), i32::from(*side));
                let middle = |i: i32| (2 * i + 1) * ONE / (2 * side);
                points.extend((0..cells * cells).map(|i| (middle(i % cells), middle(i / cells))));
            }
            Pattern::Random(count) => points.extend((0..*count).map(|_| random.point())),
            Pattern::Jitter(count) => jittered(i32::from(*count), &mut random, points),
            Pattern::Poisson(tile) => {
                let (dx, dy) = random.point();
                points
                    .extend(tile.points().iter().map(|(x, y)| ((x + dx) & (ONE - 1), (y + dy) & (ONE - 1))));
            }
        }
    }
}

/// Points in a square that keep their distance, also across its borders. Every pixel sees the tile moved
/// by another way, so that one is enough. It is made when first looked at.
#[derive(Clone, Debug)]
pub(crate) struct PoissonTile {
    count: u16,
    points: OnceLock<Vec<(i32, i32)>>,
}

impl PoissonTile {
    pub fn new(count: u16) -> PoissonTile {
        PoissonTile { count, points: OnceLock::new() }
    }

    /// Darts that fall too near to others are thrown again, with ever smaller disks until all fit (McCool
    /// & Fiume, *Hierarchical Poisson Disk Sampling Distributions*, 1992).
    fn points(&self) -> &[(i32, i32)] {
        self.points.get_or_init(|| {
            let mut random = Random(0x5eed);
            let mut tile: Vec<(i32, i32)> = Vec::with_capacity(self.count.into());
            // Disks in the densest packing: farther apart they cannot be.
            let mut square = i64::from(ONE) * i64::from(ONE) * 8 / 7 / i64::from(self.count);
            let mut misses = 0;
            while tile.len() < usize::from(self.count) {
                let (x, y) = random.point();
                let apart = |a: i32, b: i32| {
                    let d = i64::from((a - b).abs());
                    d.min(i64::from(ONE) - d)
                };
                let far = |&(px, py): &(i32, i32)| apart(px, x).pow(2) + apart(py, y).pow(2) >= square;
                if tile.iter().all(far) {
                    tile.push((x, y));
                    misses = 0;
                } else {
                    misses += 1;
                }
                if misses > MOST_MISSES {
                    square = square * SHRINK * SHRINK / (32 * 32);
                    misses = 0;
                }
            }
            tile
        })
    }
}

/// One point in each of `count` cells of equal area: rows of nearly equal numbers of cells, as high as
/// they hold many.
fn jittered(count: i32, random: &mut Random, points: &mut Vec<(i32, i32)>) {
    // The nearest whole number to the root.
    let rows = ((4 * count + 1).isqrt() + 1) / 2;
    for row in 0..rows {
        let (before, after) = (count * row / rows, count * (row + 1) / rows);
        let cells = after - before;
        for cell in 0..cells {
            let (dx, dy) = random.point();
            points.push(((cell * ONE + dx) / cells, (before * ONE + cells * dy) / count));
        }
    }
}

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn of_pixel(x: u32, y: u32) -> Random {
        // One step spreads the two numbers over all bits.
        Random(Random(u64::from(x) << 32 | u64::from(y)).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Anywhere in a pixel.
    fn point(&mut self) -> (i32, i32) {
        let bits = self.next();
        let part = |shift: u32| (bits >> shift) as i32 & (ONE - 1);
        (part(0), part(FRACTION_BITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_has_its_number_of_points_and_all_lie_in_the_pixel() {
        let mut points = Vec::new();
        for count in [1, 2, 3, 5, 7, 16, 30, 64, 100, 256] {
            let patterns =
                [Pattern::Random(count), Pattern::Jitter(count), Pattern::Poisson(PoissonTile::new(count))];
            for pattern in patterns.into_iter().chain([Pattern::Grid(count.isqrt())]) {
                for pixel in [(0, 0), (1, 0), (65_534, 65_534)] {
                    pattern.points(pixel, &mut points);
                    assert_eq!(points.len(), pattern.count(), "{pattern:?}");
                    assert!(points.iter().all(|(x, y)| (0..ONE).contains(x) && (0..ONE).contains(y)));
                }
            }
        }
    }

    #[test]
    fn jittered_points_stand_one_in_each_cell() {
        let mut points = Vec::new();
        Pattern::Jitter(16).points((3, 9), &mut points);
        let mut cells: Vec<_> = points.iter().map(|(x, y)| (x * 4 / ONE, y * 4 / ONE)).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 16);
    }

    #[test]
    fn poisson_points_keep_their_distance() {
        let mut points = Vec::new();
        for count in [4, 16, 64, 256] {
            Pattern::Poisson(PoissonTile::new(count)).points((7, 5), &mut points);
            // .6 of what the densest packing has.
            let least = 0.6 * (2.0 / 3.0f64.sqrt() / f64::from(count)).sqrt() * f64::from(ONE);
            for (i, a) in points.iter().enumerate() {
                for b in &points[..i] {
                    let (dx, dy) = (f64::from(a.0 - b.0), f64::from(a.1 - b.1));
                    assert!(dx.hypot(dy) >= least, "{count}: {a:?} and {b:?}");
                }
            }
        }
    }
}
