//! Takes the truth and a picture's errors, makes the measure of seams: the error where the truth is
//! flat all around. There no edge can be seen, so whatever a method leaves there (the hairline between
//! two shapes that abut, the fringe of a shape behind another) was invented by it.

use crate::reference::Truth;
use serde::Serialize;

/// Colours this close, in levels, are one colour.
const ALIKE: f64 = 1e-3;

/// The error in pixels whose neighbourhood of 3 x 3 pixels has one colour in the truth. At the
/// picture's border the neighbourhood is what of it lies within.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seams {
    /// Share of the picture's pixels that are so.
    pub flat: f64,
    /// Mean, over those, of the worst channel's error in levels.
    pub mean: f64,
    /// The largest.
    pub max: f64,
    /// Share of those that are off by more than 1 level.
    pub over_1: f64,
    /// Column and row of the largest.
    pub at: (u32, u32),
}

/// `errors` are those of [`Truth::errors`].
pub fn seams(truth: &Truth, errors: &[f32]) -> Seams {
    let width = truth.width() as usize;
    let mut seams = Seams::default();
    let mut count = 0.0;
    for (i, &error) in errors.iter().enumerate() {
        let (x, y) = (i % width, i / width);
        if !is_flat(truth, x, y) {
            continue;
        }
        let error = f64::from(error);
        count += 1.0;
        seams.mean += error;
        seams.over_1 += f64::from(error > 1.0 + 1e-6);
        if error > seams.max {
            seams.max = error;
            seams.at = (x as u32, y as u32);
        }
    }
    seams.flat = count / errors.len().max(1) as f64;
    if count > 0.0 {
        seams.mean /= count;
        seams.over_1 /= count;
    }
    seams
}

fn is_flat(truth: &Truth, x: usize, y: usize) -> bool {
    let (width, height) = (truth.width() as usize, truth.height() as usize);
    let pixels = truth.premultiplied();
    let here = pixels[y * width + x];
    let alike = |other: &[f64; 4]| other.iter().zip(here).all(|(a, b)| (a - b).abs() <= ALIKE);
    (y.saturating_sub(1)..=(y + 1).min(height - 1)).all(|row| {
        pixels[row * width + x.saturating_sub(1)..=row * width + (x + 1).min(width - 1)].iter().all(alike)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten by five pixels: the left five columns black, the others white.
    fn halves() -> Truth {
        let pixel = |i: usize| if i % 10 < 5 { [0.0, 0.0, 0.0, 255.0] } else { [255.0; 4] };
        Truth::from_pixels(10, 5, (0..50).map(pixel).collect())
    }

    #[test]
    fn an_error_beside_an_edge_is_no_seam() {
        let mut errors = vec![0.0; 50];
        errors[2 * 10 + 4] = 100.0;
        let seams = seams(&halves(), &errors);
        assert_eq!((seams.max, seams.over_1), (0.0, 0.0));
        assert_eq!(seams.flat, 0.8);
    }

    #[test]
    fn a_hairline_on_a_flat_ground_is_one() {
        let mut errors = vec![0.0; 50];
        for y in 0..5 {
            errors[y * 10 + 8] = 64.0;
        }
        let seams = seams(&halves(), &errors);
        assert_eq!((seams.max, seams.mean, seams.over_1), (64.0, 8.0, 0.125));
        assert_eq!(seams.at, (8, 0));
    }
}
