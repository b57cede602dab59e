//! Takes one plane and two rows of weights, makes the plane filtered across and down. SSIM and FLIP
//! share it. Beyond the border lies the nearest pixel within it.

use rayon::prelude::*;

/// `across` and `down` have an odd number of weights, the middle one on the pixel itself.
pub fn separable(plane: &[f32], width: usize, across: &[f32], down: &[f32]) -> Vec<f32> {
    let height = plane.len() / width;
    let mut half = vec![0.0; plane.len()];
    half.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(to, from)| {
        row(from, across, to);
    });
    let mut whole = vec![0.0; plane.len()];
    let reach = down.len() / 2;
    whole.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
        for (i, weight) in down.iter().enumerate() {
            let from = (y + i).saturating_sub(reach).min(height - 1) * width;
            for (to, from) in to.iter_mut().zip(&half[from..from + width]) {
                *to += weight * from;
            }
        }
    });
    whole
}

fn row(from: &[f32], weights: &[f32], to: &mut [f32]) {
    let (reach, last) = (weights.len() / 2, from.len() - 1);
    let clamped = |x: usize| {
        let at = |i: usize| from[(x + i).saturating_sub(reach).min(last)];
        weights.iter().enumerate().map(|(i, w)| w * at(i)).sum::<f32>()
    };
    let inner = reach..from.len().saturating_sub(reach).max(reach);
    for (x, to) in to.iter_mut().enumerate() {
        *to = match inner.contains(&x) {
            true => weights.iter().zip(&from[x - reach..]).map(|(w, f)| w * f).sum(),
            false => clamped(x),
        };
    }
}

/// `f` at the whole numbers within `radius`, of sum 1.
pub fn weights(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f32> {
    let raw: Vec<f64> = (0..=2 * radius).map(|i| f(i as f64 - radius as f64)).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| (w / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_plane_stays_flat_up_to_its_border() {
        let box_of_three = weights(1, |_| 1.0);
        let plane = separable(&[0.25; 20], 5, &box_of_three, &weights(4, |x| (-x * x).exp()));
        assert!(plane.iter().all(|v| (v - 0.25).abs() < 1e-6), "{plane:?}");
    }

    #[test]
    fn a_point_becomes_the_weights_turned_round() {
        let mut plane = vec![0.0; 25];
        plane[12] = 1.0;
        let filtered = separable(&plane, 5, &[1.0, 2.0, 3.0], &[0.0, 1.0, 0.0]);
        assert_eq!(filtered[10..15], [0.0, 3.0, 2.0, 1.0, 0.0]);
    }
}
