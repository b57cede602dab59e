//! Takes a picture's errors, makes a short list of where to look: the worst pixels that lie apart.

use serde::Serialize;

/// Places listed.
const SPOTS: usize = 8;
/// Two places are at least this many pixels apart, across or down.
const APART: u32 = 12;
/// Smaller errors are rounding.
const WORTH_A_LOOK: f32 = 1.0;

/// A pixel and its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spot {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Its worst channel's error in levels.
    pub error: f32,
}

/// The worst pixels, the worst first.
pub fn spots(width: u32, errors: &[f32]) -> Vec<Spot> {
    let mut found: Vec<Spot> = Vec::new();
    let mut worst: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > WORTH_A_LOOK).collect();
    worst.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
    for i in worst {
        let (x, y) = (i as u32 % width, i as u32 / width);
        if found.iter().all(|s| s.x.abs_diff(x).max(s.y.abs_diff(y)) >= APART) {
            found.push(Spot { x, y, error: errors[i] });
            if found.len() == SPOTS {
                break;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_a_worst_pixel_are_the_same_place() {
        let mut errors = vec![0.0; 40 * 10];
        errors[3 * 40 + 5] = 90.0;
        errors[3 * 40 + 6] = 80.0;
        errors[4 * 40 + 30] = 20.0;
        let found: Vec<_> = spots(40, &errors).iter().map(|s| (s.x, s.y, s.error)).collect();
        assert_eq!(found, [(5, 3, 90.0), (30, 4, 20.0)]);
    }
}
