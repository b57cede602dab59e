//! Takes two pictures as shown, makes the map of how different they look when one flips between them:
//! LDR-FLIP (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild, *FLIP: A Difference
//! Evaluator for Alternating Images*, HPG 2020), written from the paper; 0 is alike, 1 the most.
//!
//! Two differences are taken of each pixel. Colour: both pictures are blurred as far as the eye does
//! at this distance (its contrast sensitivity, in the opponent space YCxCz), and compared in CIELAB
//! under Hunt's adjustment by the HyAB distance. Feature: edges and points of the achromatic plane,
//! whose difference raises that of colour to a power below 1. The tests hold it against the figures
//! of the published program.

use super::filter::{separable, weights};
use super::picture::Shown;
use rayon::prelude::*;
use std::f64::consts::PI;

/// The published default: a screen .7 m wide of 3,840 pixels, seen from .7 m.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;
/// Exponents of the colour and of the feature difference.
const COLOUR_POWER: f32 = 0.7;
const FEATURE_POWER: f32 = 0.5;
/// Colour differences up to this share of the largest are spread over this much of the result.
const KNEE_FROM: f32 = 0.4;
const KNEE_TO: f32 = 0.95;
/// Width of the edge detector, in degrees.
const DETECTOR: f64 = 0.082;
/// Contrast sensitivity of the achromatic, red-green and blue-yellow plane: sums of Gaussians of
/// height a and width b, in degrees squared.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The largest b above, which sets the reach of all three filters.
const WIDEST: f64 = 0.04;

/// Linear sRGB to CIE XYZ, in the fractions of the published program.
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// A picture prepared to be compared with others.
pub struct Flip {
    width: usize,
    /// CIELAB under Hunt's adjustment, of the picture as the eye blurs it.
    colours: Vec<[f32; 3]>,
    /// How strong an edge and a point there are at each pixel.
    features: Vec<[f32; 2]>,
}

impl Flip {
    /// Prepares a picture.
    pub fn new(shown: &Shown) -> Flip {
        let opponent: Vec<[f32; 3]> = shown.pixels.par_iter().map(|&p| opponent(p.map(decode))).collect();
        let plane = |i: usize| -> Vec<f32> { opponent.iter().map(|p| p[i]).collect() };
        let filtered: [Vec<f32>; 3] = [0, 1, 2].map(|i| blur(&plane(i), shown.width, SENSITIVITY[i]));
        let colours = (0..opponent.len())
            .into_par_iter()
            .map(|i| hunt(lab(from_opponent([0, 1, 2].map(|c| filtered[c][i])).map(|c| c.clamp(0.0, 1.0)))))
            .collect();
        let achromatic: Vec<f32> = opponent.iter().map(|p| (p[0] + 16.0) / 116.0).collect();
        Flip { width: shown.width, colours, features: features(&achromatic, shown.width) }
    }

    /// The difference at each pixel, row by row, 0 ..= 1.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn difference(&self, other: &Flip) -> Vec<f32> {
        assert_eq!(
            (self.width, self.colours.len()),
            (other.width, other.colours.len()),
            "pictures of one size"
        );
        let largest = hyab(hunt(lab([0.0, 1.0, 0.0])), hunt(lab([0.0, 0.0, 1.0]))).powf(COLOUR_POWER);
        let pixel = |i: usize| {
            let colour = redistribute(hyab(self.colours[i], other.colours[i]).powf(COLOUR_POWER), largest);
            let ([edge, point], [other_edge, other_point]) = (self.features[i], other.features[i]);
            let feature = (edge - other_edge).abs().max((point - other_point).abs());
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).clamp(0.0, 1.0).powf(FEATURE_POWER);
            colour.powf(1.0 - feature)
        };
        (0..self.colours.len()).into_par_iter().map(pixel).collect()
    }
}

/// The mean of a map.
pub fn mean(map: &[f32]) -> f64 {
    map.iter().map(|&v| f64::from(v)).sum::<f64>() / map.len().max(1) as f64
}

/// What the eye makes of one plane: a weighted sum of Gaussians.
fn blur(plane: &[f32], width: usize, gaussians: &[(f64, f64)]) -> Vec<f32> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil();
    let gaussian = |b: f64| move |x: f64| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp();
    // What each adds to the two-dimensional filter before that is scaled to a sum of 1.
    let mass = |&(a, b): &(f64, f64)| {
        let sum: f64 = (-radius as i32..=radius as i32).map(|x| gaussian(b)(x.into())).sum();
        a * (PI / b).sqrt() * sum * sum
    };
    let all: f64 = gaussians.iter().map(mass).sum();
    let mut out = vec![0.0; plane.len()];
    for part in gaussians {
        let weights = weights(radius as usize, gaussian(part.1));
        let share = (mass(part) / all) as f32;
        let blurred = separable(plane, width, &weights, &weights);
        out.iter_mut().zip(&blurred).for_each(|(to, from)| *to += share * from);
    }
    out
}

/// Strength of edges and points: first and second derivatives of a Gaussian, across and down.
fn features(plane: &[f32], width: usize) -> Vec<[f32; 2]> {
    let sigma = 0.5 * DETECTOR * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as usize;
    let bell = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
    let smooth = weights(radius, bell);
    let strength = |detector: &dyn Fn(f64) -> f64| -> Vec<f32> {
        let detector = balanced(radius, detector);
        let across = separable(plane, width, &detector, &smooth);
        let down = separable(plane, width, &smooth, &detector);
        across.iter().zip(&down).map(|(a, d)| a.hypot(*d)).collect()
    };
    let edges = strength(&|x| -x * bell(x));
    let points = strength(&|x| (x * x / (sigma * sigma) - 1.0) * bell(x));
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// `f` at the whole numbers within `radius`; what is above zero sums to 1, what is below to -1.
fn balanced(radius: usize, f: &dyn Fn(f64) -> f64) -> Vec<f32> {
    let raw: Vec<f64> = (0..=2 * radius).map(|i| f(i as f64 - radius as f64)).collect();
    let above: f64 = raw.iter().filter(|w| **w > 0.0).sum();
    let below: f64 = -raw.iter().filter(|w| **w < 0.0).sum::<f64>();
    raw.iter().map(|&w| (if w < 0.0 { w / below } else { w / above }) as f32).collect()
}

fn decode(encoded: f32) -> f32 {
    if encoded > 0.04045 {
        ((encoded + 0.055) / 1.055).powf(2.4)
    } else {
        encoded / 12.92
    }
}

/// XYZ of a linear colour, each part of that of white.
fn relative_xyz(linear: [f32; 3]) -> [f64; 3] {
    let dot = |row: [f64; 3]| row.iter().zip(linear).map(|(w, c)| w * f64::from(c)).sum::<f64>();
    TO_XYZ.map(|row| dot(row) / row.iter().sum::<f64>())
}

/// YCxCz of a linear colour: luminance, red-green and blue-yellow.
fn opponent(linear: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(linear);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)].map(|c| c as f32)
}

/// The linear colour of YCxCz.
fn from_opponent([luminance, red_green, blue_yellow]: [f32; 3]) -> [f32; 3] {
    let y = (f64::from(luminance) + 16.0) / 116.0;
    let relative = [y + f64::from(red_green) / 500.0, y, y - f64::from(blue_yellow) / 200.0];
    let m = TO_XYZ;
    let xyz = [0, 1, 2].map(|i| relative[i] * m[i].iter().sum::<f64>());
    // Cramer's rule.
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * minor(0, c)).sum();
    [0, 1, 2].map(|c| ((0..3).map(|r| minor(r, c) * xyz[r]).sum::<f64>() / determinant) as f32)
}

/// CIELAB of a linear colour.
fn lab(linear: [f32; 3]) -> [f32; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let curve = |t: f64| {
        if t > DELTA.powi(3) {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(linear).map(curve);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)].map(|c| c as f32)
}

/// Colours look less colourful when dark.
fn hunt([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// The distance for large differences: city block between lightness and chroma.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Stretches small differences over most of 0 ..= 1.
fn redistribute(power: f32, largest: f32) -> f32 {
    let knee = KNEE_FROM * largest;
    if power < knee {
        KNEE_TO / knee * power
    } else {
        KNEE_TO + (power - knee) / (largest - knee) * (1.0 - KNEE_TO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::against;

    fn shown(bytes: &[u8]) -> Shown {
        Shown::of_pixmap(&against::decode(bytes).expect("the test's own PNG"))
    }

    /// `tests/flip/README.md` says where the figures come from.
    #[test]
    fn figures_are_those_of_the_published_program() {
        let edges = shown(include_bytes!("../../tests/flip/edges.png"));
        let jagged = shown(include_bytes!("../../tests/flip/jagged.png"));
        let figures = include_str!("../../tests/flip/figures.txt");
        let figures: Vec<f64> = figures.lines().map(|line| line.trim().parse().unwrap()).collect();
        let map = Flip::new(&edges).difference(&Flip::new(&jagged));
        assert_eq!(figures.len(), map.len() + 1, "the mean, then each pixel");
        assert!((mean(&map) - figures[0]).abs() < 1e-5, "mean {} is not {}", mean(&map), figures[0]);
        for (i, (&ours, theirs)) in map.iter().zip(&figures[1..]).enumerate() {
            assert!((f64::from(ours) - theirs).abs() < 1e-3, "pixel {i}: {ours} is not {theirs}");
        }
    }

    #[test]
    fn a_picture_looks_like_itself() {
        let edges = shown(include_bytes!("../../tests/flip/edges.png"));
        assert_eq!(mean(&Flip::new(&edges).difference(&Flip::new(&edges))), 0.0);
    }

    #[test]
    fn opponent_colours_return() {
        for colour in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.2, 0.7, 0.4]] {
            let back = from_opponent(opponent(colour));
            assert!(colour.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-5), "{colour:?} {back:?}");
        }
    }
}
