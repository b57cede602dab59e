//! Takes the normals around a pixel and Phong's exponent, makes the highlight: as it is, or one that
//! does not alias (Amanatides, Algorithms for the Detection and Elimination of Specular Aliasing,
//! SIGGRAPH 1992).
//!
//! cos^n of the angle between normal and halfway vector is a sum of cosines up to n cycles a turn, so
//! normals that turn by more than pi / n from pixel to pixel sample it too sparsely. That is the
//! conservative limit. Nearly all of its power lies in far fewer cycles, some 2.3 sqrt(n): the
//! aggressive limit counts those with 99.9% of it. Where the limit is passed, the exponent is clamped
//! to one that neighbouring normals do sample, and the wider, softer highlight made fainter by the
//! ratio of the energies. A surface may bend in one direction only, as cylinders and cones do; since
//! cos(c) = cos(a) cos(b) on the sphere, the exponent is clamped for each direction by itself. Where
//! no aliasing is detected, the highlight has the same bits as without.

use super::filter::light::{dot, normalized, Surface, Vector};
use std::sync::LazyLock;

/// What is done about highlights that alias.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Highlights {
    /// Nothing.
    #[default]
    AsIs,
    /// The exponent is clamped where any of the highlight's frequencies would alias.
    Clamp,
    /// It is clamped where more than a thousandth of the highlight's power would alias.
    Aggressive,
    /// Where it would alias (by the conservative limit), it is averaged over as many normals a pixel
    /// as it takes, up to 16 a side.
    Supersample,
}

/// Which frequencies of the highlight count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Band {
    /// All.
    Conservative,
    /// The lowest that hold [`POWER_KEPT`] of the power.
    Aggressive,
}

const POWER_KEPT: f64 = 0.999;
/// Samples along a pixel's side, at most.
const MOST_SAMPLES: usize = 16;
/// Exponents of SVG end here.
const GREATEST_EXPONENT: usize = 128;

impl Band {
    /// Cycles a turn that count in cos^n.
    pub fn cycles(self, exponent: f32) -> f32 {
        match self {
            Band::Conservative => exponent,
            Band::Aggressive => {
                let table = &*AGGRESSIVE_CYCLES;
                let at = exponent.clamp(0.0, GREATEST_EXPONENT as f32);
                let step = (at as usize).min(GREATEST_EXPONENT - 1);
                table[step] + (at - step as f32) * (table[step + 1] - table[step])
            }
        }
    }

    /// The smallest dot product of neighbouring normals at which the highlight is still sampled twice
    /// a cycle: a table with one entry for each exponent in Amanatides' paper.
    pub fn smallest_dot(self, exponent: f32) -> f32 {
        let turn = std::f32::consts::PI / self.cycles(exponent);
        libm::cosf(turn.min(std::f32::consts::PI))
    }

    /// How many samples where there is one now would cure a turn by this dot product; 1 or less: there
    /// is nothing to cure.
    pub fn sampling_rate(self, exponent: f32, dot: f32) -> f32 {
        angle_of(dot) * self.cycles(exponent) / std::f32::consts::PI
    }

    /// The greatest exponent which normals this many radians apart sample twice a cycle, between 1 and
    /// the given one.
    pub fn clamped(self, exponent: f32, radians: f32) -> f32 {
        let cycles = std::f32::consts::PI / radians;
        if cycles >= self.cycles(exponent) {
            return exponent;
        }
        let clamped = match self {
            Band::Conservative => cycles,
            Band::Aggressive => {
                let table = &*AGGRESSIVE_CYCLES;
                // The table rises.
                let next = table.partition_point(|&c| c < cycles).clamp(1, GREATEST_EXPONENT);
                let (low, high) = (table[next - 1], table[next]);
                (next - 1) as f32 + ((cycles - low) / (high - low)).clamp(0.0, 1.0)
            }
        };
        // `min` first: an exponent below 1 is nobody's clamp.
        clamped.max(1.0).min(exponent)
    }
}

/// For each whole exponent, the cycles below which its power is [`POWER_KEPT`], linear between whole
/// cycles: cos^n is the sum over j of C(n, j) / 2^n cos((n - 2j) x).
static AGGRESSIVE_CYCLES: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let mut rising = 0.0f32;
    (0..=GREATEST_EXPONENT)
        .map(|n| {
            rising = rising.max(cycles_with_power(n));
            rising
        })
        .collect()
});

fn cycles_with_power(n: usize) -> f32 {
    // Row n of Pascal's triangle, scaled to end in reach of floats.
    let mut row = vec![1.0f64];
    for _ in 0..n {
        let halves = |i: usize| row.get(i).copied().unwrap_or(0.0) * 0.5;
        row = (0..=row.len()).map(|i| halves(i) + if i > 0 { halves(i - 1) } else { 0.0 }).collect();
    }
    let total: f64 = row.iter().map(|c| c * c).sum();
    let mut sum = 0.0;
    // From the lowest frequency up: n - 2j is 0 or 1 in the middle, and grows both ways.
    for cycles in (n % 2..=n).step_by(2) {
        let coefficient = row[(n - cycles) / 2];
        let power = coefficient * coefficient * if cycles == 0 { 1.0 } else { 2.0 };
        if sum + power >= POWER_KEPT * total {
            let share = (POWER_KEPT * total - sum) / power;
            return (cycles as f64 - 2.0 * (1.0 - share)).max(1.0) as f32;
        }
        sum += power;
    }
    n as f32
}

/// The integral of cos^m over half a turn: the energy of a highlight along one direction.
fn energy(exponent: f32) -> f32 {
    const STEPS: f32 = 8.0;
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let entries = (GREATEST_EXPONENT + 3) * STEPS as usize;
        let value = |i: usize| {
            let m = i as f64 / f64::from(STEPS);
            let log = libm::lgamma((m + 1.0) / 2.0) - libm::lgamma(m / 2.0 + 1.0);
            (libm::exp(log) * std::f64::consts::PI.sqrt()) as f32
        };
        (0..=entries).map(value).collect()
    });
    let at = (exponent * STEPS).clamp(0.0, (TABLE.len() - 2) as f32);
    let step = at as usize;
    TABLE[step] + (at - step as f32) * (TABLE[step + 1] - TABLE[step])
}

/// What a highlight clamped to these exponents, along the bend and across it, is made fainter by.
pub(crate) fn energy_ratio(exponent: f32, along: f32, across: f32) -> f32 {
    // Over the sphere, in latitude off the bend's great circle: its measure is one more cosine.
    energy(exponent) * energy(exponent + 1.0) / (energy(along) * energy(across + 1.0))
}

/// What aliases of a highlight on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Aliasing {
    /// Pixels where the highlight, as it is, would be sampled too sparsely.
    pub pixels: u64,
    /// As many samples along a pixel's side would cure the worst of them.
    pub sampling_rate: f32,
}

impl Aliasing {
    /// By the limit of this way to treat highlights.
    pub fn of(surface: &Surface, exponent: f32, highlights: Highlights) -> Aliasing {
        let band = band_of(highlights);
        let limit = band.smallest_dot(exponent);
        let mut aliasing = Aliasing::default();
        for row in 0..surface.rows() {
            for column in 0..surface.width() {
                let neighbours = Neighbours::of(surface, column, row);
                let smallest = neighbours.smallest_dot(surface.normal(column, row));
                if smallest < limit {
                    aliasing.pixels += 1;
                    aliasing.sampling_rate =
                        aliasing.sampling_rate.max(band.sampling_rate(exponent, smallest));
                }
            }
        }
        aliasing
    }
}

/// Phong's highlight on a surface.
pub(super) struct Phong {
    exponent: f32,
    highlights: Highlights,
    /// The dot product of neighbouring normals below which it aliases.
    smallest_dot: f32,
}

impl Phong {
    pub fn new(exponent: f32, highlights: Highlights) -> Phong {
        let band = band_of(highlights);
        Phong { exponent, highlights, smallest_dot: band.smallest_dot(exponent) }
    }

    /// The highlight at a pixel of the surface, for this halfway vector between light and eye.
    #[inline]
    pub fn at(&self, surface: &Surface, column: usize, row: usize, halfway: Vector) -> f32 {
        let normal = surface.normal(column, row);
        if self.highlights != Highlights::AsIs {
            let neighbours = Neighbours::of(surface, column, row);
            if neighbours.smallest_dot(normal) < self.smallest_dot {
                return match self.highlights {
                    Highlights::Supersample => self.averaged(surface, column, row, halfway, &neighbours),
                    _ => self.clamped(normal, halfway, &neighbours),
                };
            }
        }
        power(dot(normal, halfway), self.exponent)
    }

    fn clamped(&self, normal: Vector, halfway: Vector, neighbours: &Neighbours) -> f32 {
        let band = band_of(self.highlights);
        let bend = Bend::at(normal, neighbours);
        let along = band.clamped(self.exponent, bend.most);
        let across = band.clamped(self.exponent, bend.least);
        // Off the bend's great circle by latitude, along it by longitude.
        let pole = cross(normal, bend.direction);
        let off = dot(pole, halfway);
        let latitude_cosine = (1.0 - off * off).max(0.0).sqrt();
        if latitude_cosine <= 0.0 {
            return 0.0;
        }
        let longitude_cosine = (dot(normal, halfway) / latitude_cosine).min(1.0);
        power(longitude_cosine, along)
            * power(latitude_cosine, across)
            * energy_ratio(self.exponent, along, across)
    }

    /// The mean over normals between the pixels, as many as the turn between neighbours calls for.
    fn averaged(
        &self,
        surface: &Surface,
        column: usize,
        row: usize,
        halfway: Vector,
        neighbours: &Neighbours,
    ) -> f32 {
        let normal = surface.normal(column, row);
        let rate = band_of(self.highlights).sampling_rate(self.exponent, neighbours.smallest_dot(normal));
        let side = (rate.ceil() as usize).clamp(2, MOST_SAMPLES);
        let mut sum = 0.0;
        for i in 0..side * side {
            let offset = |i: usize| (i as f32 + 0.5) / side as f32 - 0.5;
            let lean = lean_between(surface, column, row, offset(i % side), offset(i / side));
            sum += power(dot(normalized([lean[0], lean[1], 1.0]), halfway), self.exponent);
        }
        sum / (side * side) as f32
    }
}

fn band_of(highlights: Highlights) -> Band {
    match highlights {
        Highlights::Aggressive => Band::Aggressive,
        _ => Band::Conservative,
    }
}

/// cos^n; what faces away is dark.
#[inline]
fn power(cosine: f32, exponent: f32) -> f32 {
    if cosine <= 0.0 {
        return 0.0;
    }
    let whole = exponent as u32;
    if whole as f32 != exponent {
        return libm::powf(cosine, exponent);
    }
    // Most exponents are whole: by squares, which is quicker.
    let (mut power, mut square, mut bits) = (1.0, cosine, whole);
    while bits > 0 {
        if bits & 1 == 1 {
            power *= square;
        }
        square *= square;
        bits >>= 1;
    }
    power
}

/// Bilinear between pixels' leans, up to half a pixel away.
fn lean_between(surface: &Surface, column: usize, row: usize, dx: f32, dy: f32) -> [f32; 2] {
    let step = |at: usize, away: f32, length: usize| {
        if away < 0.0 {
            at.saturating_sub(1)
        } else {
            (at + 1).min(length - 1)
        }
    };
    let (beside, below) = (step(column, dx, surface.width()), step(row, dy, surface.rows()));
    let (share_x, share_y) = (dx.abs(), dy.abs());
    std::array::from_fn(|i| {
        let at = |column: usize, row: usize| surface.lean(column, row)[i];
        let here = at(column, row) * (1.0 - share_x) + at(beside, row) * share_x;
        let there = at(column, below) * (1.0 - share_x) + at(beside, below) * share_x;
        here * (1.0 - share_y) + there * share_y
    })
}

/// The normals left and right, above and below; at the border the pixel's own.
struct Neighbours {
    beside: [Vector; 2],
    above_below: [Vector; 2],
}

impl Neighbours {
    fn of(surface: &Surface, column: usize, row: usize) -> Neighbours {
        let (right, bottom) = ((column + 1).min(surface.width() - 1), (row + 1).min(surface.rows() - 1));
        Neighbours {
            beside: [surface.normal(column.saturating_sub(1), row), surface.normal(right, row)],
            above_below: [surface.normal(column, row.saturating_sub(1)), surface.normal(column, bottom)],
        }
    }

    fn smallest_dot(&self, normal: Vector) -> f32 {
        self.beside.iter().chain(&self.above_below).fold(1.0, |least, &n| least.min(dot(n, normal)))
    }
}

/// How the normal turns around a pixel.
struct Bend {
    /// Of length 1, at right angles to the normal: where it turns to fastest.
    direction: Vector,
    /// Radians a pixel in that direction, and across it.
    most: f32,
    least: f32,
}

impl Bend {
    fn at(normal: Vector, neighbours: &Neighbours) -> Bend {
        // Two directions at right angles to the normal, which has a part towards the eye.
        let first = normalized([normal[2], 0.0, -normal[0]]);
        let second = cross(normal, first);
        // The turns to either side, along rows and along columns: the greater one's direction and the
        // root of their mean square. The greater alone would favour the side that bends more.
        let turn = |pair: &[Vector; 2]| {
            let turns = pair.map(|other| (angle_of(dot(other, normal)), other));
            let mean = ((turns[0].0 * turns[0].0 + turns[1].0 * turns[1].0) / 2.0).sqrt();
            let other = if turns[0].0 > turns[1].0 { turns[0].1 } else { turns[1].1 };
            let flat = [dot(other, first), dot(other, second)];
            let length = (flat[0] * flat[0] + flat[1] * flat[1]).sqrt();
            flat.map(|v| if length > 0.0 { v * mean / length } else { 0.0 })
        };
        let (x, y) = (turn(&neighbours.beside), turn(&neighbours.above_below));
        // The axes of the ellipse with these two for conjugate radii.
        let (a, b, c) = (x[0] * x[0] + y[0] * y[0], x[0] * x[1] + y[0] * y[1], x[1] * x[1] + y[1] * y[1]);
        let (middle, half) = ((a + c) / 2.0, (((a - c) / 2.0) * ((a - c) / 2.0) + b * b).sqrt());
        let most = middle + half;
        // An eigenvector to `most`, from whichever row of the matrix is longer.
        let (u, v) = if a > c { (most - c, b) } else { (b, most - a) };
        let direction: Vector = std::array::from_fn(|i| first[i] * u + second[i] * v);
        let direction = if u == 0.0 && v == 0.0 { first } else { normalized(direction) };
        Bend { direction, most: most.sqrt(), least: (middle - half).max(0.0).sqrt() }
    }
}

fn angle_of(dot: f32) -> f32 {
    libm::acosf(dot.clamp(-1.0, 1.0))
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests;
