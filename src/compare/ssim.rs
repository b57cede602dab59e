//! Takes two pictures as shown, makes their structural similarity (Wang, Bovik, Sheikh & Simoncelli,
//! *Image Quality Assessment: From Error Visibility to Structural Similarity*, 2004): on luma, with
//! their Gaussian window of 11 x 11 pixels (sigma 1.5) and their constants, the mean over all windows
//! that lie within the picture. 1 is alike.

use super::filter::{separable, weights};
use super::picture::Shown;

/// Pixels on each side of the window's middle.
const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
/// (.01 x 255)² and (.03 x 255)²: they keep the fractions of flat windows from 0/0.
const C1: f32 = 6.5025;
const C2: f32 = 58.5225;

/// The structural similarity of two pictures of one size. In a picture smaller than the window every
/// window counts, with the border's pixels repeated.
pub fn ssim(reference: &Shown, test: &Shown) -> f64 {
    let (width, height) = (reference.width, reference.height);
    let window = weights(RADIUS, |x| (-x * x / (2.0 * SIGMA * SIGMA)).exp());
    let blur = |plane: &[f32]| separable(plane, width, &window, &window);
    let product = |a: &[f32], b: &[f32]| -> Vec<f32> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
    // About the middle grey, so that squares lose no digits to a large mean.
    let centred = |shown: &Shown| -> Vec<f32> { shown.luma().iter().map(|v| v - 127.5).collect() };
    let (a, b) = (centred(reference), centred(test));
    let (mean_a, mean_b) = (blur(&a), blur(&b));
    let (aa, bb, ab) = (blur(&product(&a, &a)), blur(&product(&b, &b)), blur(&product(&a, &b)));
    let inner = |side: usize| if side > 2 * RADIUS { RADIUS..side - RADIUS } else { 0..side };
    let (mut sum, mut count) = (0.0, 0.0);
    for y in inner(height) {
        for x in inner(width) {
            let i = y * width + x;
            let (variance_a, variance_b) = (aa[i] - mean_a[i] * mean_a[i], bb[i] - mean_b[i] * mean_b[i]);
            let covariance = ab[i] - mean_a[i] * mean_b[i];
            let (mean_a, mean_b) = (mean_a[i] + 127.5, mean_b[i] + 127.5);
            let light = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1);
            let shape = (2.0 * covariance + C2) / (variance_a + variance_b + C2);
            sum += f64::from(light * shape);
            count += 1.0;
        }
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::against::decode;
    use crate::Pixmap;

    /// scikit-image 0.26: `structural_similarity(data_range=255, gaussian_weights=True, sigma=1.5,
    /// use_sample_covariance=False)` on .299 R + .587 G + .114 B.
    #[test]
    fn the_figure_is_that_of_scikit_image() {
        let shown = |bytes: &[u8]| Shown::of_pixmap(&decode(bytes).expect("the test's own PNG"));
        let edges = shown(include_bytes!("../../tests/flip/edges.png"));
        let jagged = shown(include_bytes!("../../tests/flip/jagged.png"));
        assert!((ssim(&edges, &jagged) - 0.915_860_89).abs() < 1e-5, "{}", ssim(&edges, &jagged));
        assert!((ssim(&edges, &edges) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_flat_picture_of_another_grey_has_the_light_term_alone() {
        let flat = |level: u8| {
            let mut pixmap = Pixmap::new(20, 20);
            pixmap
                .data_mut()
                .chunks_exact_mut(4)
                .for_each(|p| p.copy_from_slice(&[level, level, level, 255]));
            Shown::of_pixmap(&pixmap)
        };
        let (a, b) = (100.0, 150.0);
        let light = (2.0 * a * b + 6.5025) / (a * a + b * b + 6.5025);
        assert!((ssim(&flat(100), &flat(150)) - light).abs() < 1e-4);
    }

    #[test]
    fn a_picture_smaller_than_the_window_has_a_figure() {
        let white = Shown::of_pixmap(&Pixmap::new(3, 2));
        assert!((ssim(&white, &white) - 1.0).abs() < 1e-6);
    }
}
