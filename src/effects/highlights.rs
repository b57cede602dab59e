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
//!
//! A clamped highlight keeps its energy only if all pixels under it have one exponent: the bend changes
//! from pixel to pixel, and were each pixel's own taken, the sum would be off by as much as the exponent
//! changes over the highlight. So the exponent is that of the bend in the highlight's middle, to which
//! the normals here lead. And a surface is seen foreshortened by the cosine of its normal, so that its
//! energy in the picture is the integral of one more cosine than on the surface. Together they keep the
//! energy of a cylinder 3 pixels thick within half a percent.

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
        let entries = (GREATEST_EXPONENT + 4) * STEPS as usize;
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
fn energy_ratio(exponent: f32, along: f32, across: f32) -> f32 {
    // Foreshortening is one more cosine of longitude and of latitude. The measure of the sphere, in
    // latitude off the bend's great circle, is another.
    energy(exponent + 1.0) * energy(exponent + 2.0) / (energy(along + 1.0) * energy(across + 2.0))
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

    /// Is there anything to be done about what aliases?
    pub fn cures(&self) -> bool {
        self.highlights != Highlights::AsIs
    }

    /// The highlight that is to be at a pixel of the surface for this halfway vector between light and eye, if it
    /// would alias there.
    pub fn cured(&self, surface: &Surface, column: usize, row: usize, halfway: Vector) -> Option<f32> {
        let neighbours = Neighbours::of(surface, column, row);
        if neighbours.smallest_dot(surface.normal(column, row)) >= self.smallest_dot {
            return None;
        }
        let at = [column as f32, row as f32];
        Some(match self.highlights {
            Highlights::Supersample => self.averaged(surface, at, halfway, &neighbours),
            _ => self.clamped(surface, at, halfway),
        })
    }

    /// The highlight at a pixel, cured if need be.
    #[cfg(test)]
    fn at(&self, surface: &Surface, column: usize, row: usize, halfway: Vector) -> f32 {
        let cured = self.cures().then(|| self.cured(surface, column, row, halfway)).flatten();
        cured.unwrap_or_else(|| power(dot(surface.normal(column, row), halfway), self.exponent))
    }

    fn clamped(&self, surface: &Surface, at: [f32; 2], halfway: Vector) -> f32 {
        let band = band_of(self.highlights);
        let middle = Middle::found_from(surface, at, halfway);
        let along = band.clamped(self.exponent, middle.bend.most);
        let across = band.clamped(self.exponent, middle.bend.least);
        power(libm::cosf(middle.longitude), along)
            * power(middle.latitude_cosine, across)
            * energy_ratio(self.exponent, along, across)
    }

    /// The mean over normals between the pixels, as many as the turn between neighbours calls for.
    fn averaged(&self, surface: &Surface, at: [f32; 2], halfway: Vector, neighbours: &Neighbours) -> f32 {
        let smallest = neighbours.smallest_dot(normal_at(surface, at));
        let rate = band_of(self.highlights).sampling_rate(self.exponent, smallest);
        let side = (rate.ceil() as usize).clamp(2, MOST_SAMPLES);
        let offset = |i: usize| (i as f32 + 0.5) / side as f32 - 0.5;
        let sum: f32 = (0..side * side)
            .map(|i| normal_at(surface, [at[0] + offset(i % side), at[1] + offset(i / side)]))
            .map(|normal| power(dot(normal, halfway), self.exponent))
            .sum();
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

/// cos^n of each cosine; what faces away, or is no number, is dark.
pub(super) fn powers(cosines: &mut [f32], exponent: f32) {
    cosines.iter_mut().for_each(|cosine| *cosine = cosine.max(0.0));
    let (eights, rest) = cosines.as_chunks_mut::<8>();
    let whole = exponent as u32;
    if whole as f32 != exponent {
        eights.as_flattened_mut().iter_mut().for_each(|cosine| *cosine = power(*cosine, exponent));
    } else {
        for cosines in eights {
            // As `power` does for one.
            let (mut square, mut bits) = (*cosines, whole);
            *cosines = [1.0; 8];
            while bits > 0 {
                if bits & 1 == 1 {
                    cosines.iter_mut().zip(square).for_each(|(power, square)| *power *= square);
                }
                square = square.map(|v| v * v);
                bits >>= 1;
            }
        }
    }
    rest.iter_mut().for_each(|cosine| *cosine = power(*cosine, exponent));
}

/// The normal at a place between pixels, whose middles are whole numbers: bilinear between their leans.
fn normal_at(surface: &Surface, at: [f32; 2]) -> Vector {
    let within = |v: f32, length: usize| v.clamp(0.0, (length - 1) as f32);
    let (x, y) = (within(at[0], surface.width()), within(at[1], surface.rows()));
    let (column, row) = (x as usize, y as usize);
    let (beside, below) = ((column + 1).min(surface.width() - 1), (row + 1).min(surface.rows() - 1));
    let (share_x, share_y) = (x - column as f32, y - row as f32);
    let lean = |i: usize| {
        let at = |column: usize, row: usize| surface.lean(column, row)[i];
        let here = at(column, row) * (1.0 - share_x) + at(beside, row) * share_x;
        let there = at(column, below) * (1.0 - share_x) + at(beside, below) * share_x;
        here * (1.0 - share_y) + there * share_y
    };
    normalized([lean(0), lean(1), 1.0])
}

/// The normals left, right, above and below; at the border the pixel's own.
struct Neighbours([Vector; 4]);

impl Neighbours {
    fn of(surface: &Surface, column: usize, row: usize) -> Neighbours {
        let (right, bottom) = ((column + 1).min(surface.width() - 1), (row + 1).min(surface.rows() - 1));
        Neighbours([
            surface.normal(column.saturating_sub(1), row),
            surface.normal(right, row),
            surface.normal(column, row.saturating_sub(1)),
            surface.normal(column, bottom),
        ])
    }

    fn smallest_dot(&self, normal: Vector) -> f32 {
        self.0.iter().fold(1.0, |least, &n| least.min(dot(n, normal)))
    }
}

/// How the normal turns around a place.
#[derive(Clone, Copy)]
struct Bend {
    /// Of length 1, at right angles to the normal: where it turns to fastest.
    direction: Vector,
    /// Where in the picture one has to go for it to turn so: right and down, of length 1.
    towards: [f32; 2],
    /// Radians a pixel in that direction, and across it.
    most: f32,
    least: f32,
}

impl Bend {
    /// The normal at a place and how it turns there.
    fn at(surface: &Surface, at: [f32; 2]) -> (Vector, Bend) {
        let normal = normal_at(surface, at);
        let beside = [-1.0, 1.0].map(|dx| normal_at(surface, [at[0] + dx, at[1]]));
        let above_below = [-1.0, 1.0].map(|dy| normal_at(surface, [at[0], at[1] + dy]));
        // Two directions at right angles to the normal, which has a part towards the eye.
        let first = normalized([normal[2], 0.0, -normal[0]]);
        let second = cross(normal, first);
        // The turns to either side, along rows and along columns: the greater one's direction and the
        // root of their mean square. The greater alone would favour the side that bends more.
        let turn = |[before, after]: [Vector; 2]| {
            let turns = [before, after].map(|other| angle_of(dot(other, normal)));
            let mean = ((turns[0] * turns[0] + turns[1] * turns[1]) / 2.0).sqrt();
            let (other, sense) = if turns[0] > turns[1] { (before, -1.0) } else { (after, 1.0) };
            let flat = [dot(other, first), dot(other, second)];
            let length = (flat[0] * flat[0] + flat[1] * flat[1]).sqrt();
            flat.map(|v| if length > 0.0 { sense * v * mean / length } else { 0.0 })
        };
        let (x, y) = (turn(beside), turn(above_below));
        // The axes of the ellipse with these two for conjugate radii.
        let (a, b, c) = (x[0] * x[0] + y[0] * y[0], x[0] * x[1] + y[0] * y[1], x[1] * x[1] + y[1] * y[1]);
        let (middle, half) = ((a + c) / 2.0, (((a - c) / 2.0) * ((a - c) / 2.0) + b * b).sqrt());
        let most = (middle + half).sqrt();
        // An eigenvector to the greater one, from whichever row of the matrix is longer.
        let (u, v) = if a > c { (middle + half - c, b) } else { (b, middle + half - a) };
        let length = (u * u + v * v).sqrt();
        let (u, v) = if length > 0.0 { (u / length, v / length) } else { (1.0, 0.0) };
        let towards = [x, y].map(|turn| if most > 0.0 { (turn[0] * u + turn[1] * v) / most } else { 0.0 });
        let direction = normalized(std::array::from_fn(|i| first[i] * u + second[i] * v));
        (normal, Bend { direction, towards, most, least: (middle - half).max(0.0).sqrt() })
    }
}

/// The place on a surface where the highlight that shines here has its middle.
struct Middle {
    /// How the normal turns there.
    bend: Bend,
    /// How far the normal here is turned from the one there, in radians.
    longitude: f32,
    /// The cosine of the halfway vector's angle off the great circle of the bend there.
    latitude_cosine: f32,
}

impl Middle {
    /// Goes from a place as many pixels along the bend as its turn makes of the angle that is left to the
    /// halfway vector, and so on from there (Newton's method).
    fn found_from(surface: &Surface, mut at: [f32; 2], halfway: Vector) -> Middle {
        const STEPS: usize = 3;
        /// Pixels. What is farther off has a highlight that is not seen here.
        const LONGEST_STEP: f32 = 4.0;
        /// More of the angle than that is left where the way did not lead to the middle.
        const MUCH: f32 = 0.5;
        /// Less than that is no bend, radians a pixel.
        const FLAT: f32 = 1e-6;
        let (here, own) = Bend::at(surface, at);
        let left = |normal, bend: &Bend| libm::atan2f(dot(halfway, bend.direction), dot(halfway, normal));
        let (mut normal, mut bend) = (here, own);
        for _ in 0..STEPS {
            let step = left(normal, &bend) / bend.most.max(FLAT);
            let step = step.clamp(-LONGEST_STEP, LONGEST_STEP);
            at = std::array::from_fn(|i| at[i] + bend.towards[i] * step);
            (normal, bend) = Bend::at(surface, at);
        }
        // A rough surface leads nowhere: then the bend is that of this place.
        let at_first = left(here, &own).abs();
        let at_last = left(normal, &bend).abs();
        let ((normal, bend), longitude) = match at_last <= MUCH * at_first {
            // What is still left counts as if the surface went on turning.
            true => ((normal, bend), angle_of(dot(here, normal)) + at_last),
            false => ((here, own), at_first),
        };
        let off = dot(cross(normal, bend.direction), halfway);
        Middle { bend, longitude, latitude_cosine: (1.0 - off * off).max(0.0).sqrt() }
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
