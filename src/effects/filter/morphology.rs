//! Takes a layer and two radii in pixels, makes it thinner or fatter (feMorphology): each component
//! is the least or greatest within a rectangle around the pixel. A window that leaves the layer looks
//! at what of it lies inside, as browsers do.
//!
//! By van Herk's method (Pattern Recognition Letters 13, 1992): three comparisons a pixel for any
//! radius. Running extremes forwards and backwards through blocks as long as the window; each window
//! is the end of one block and the start of the next.

use super::lines::{along, Axis, Step};
use crate::effects::layer::Layer;
use usvg::filter::MorphologyOperator;

/// Radii are rounded to whole pixels.
pub(super) fn apply(mut layer: Layer, operator: MorphologyOperator, (rx, ry): (f64, f64)) -> Layer {
    if layer.rect().is_empty() {
        return layer;
    }
    // Not positive, or no number: SVG 1.1 disables the effect, which makes a clear picture.
    if !(rx > 0.0 && ry > 0.0) {
        return Layer::clear(layer.rect(), layer.space());
    }
    let (width, height) = (layer.rect().width(), layer.rect().height());
    for (axis, radius, length) in [(Axis::X, rx, width), (Axis::Y, ry, height)] {
        let radius = (radius.round() as usize).min(length - 1);
        if radius == 0 {
            continue;
        }
        match operator {
            MorphologyOperator::Erode => {
                let mut window = Window::new(radius, length, f32::INFINITY, f32::min);
                along(&mut layer, axis, |line| window.slide(line));
            }
            MorphologyOperator::Dilate => {
                let mut window = Window::new(radius, length, f32::NEG_INFINITY, f32::max);
                along(&mut layer, axis, |line| window.slide(line));
            }
        }
    }
    layer
}

struct Window<F> {
    radius: usize,
    choose: F,
    /// Running extremes from each block's start, and to its end; padded with what is never chosen.
    forwards: Vec<Step>,
    backwards: Vec<Step>,
    never: Step,
}

impl<F: Fn(f32, f32) -> f32> Window<F> {
    fn new(radius: usize, length: usize, never: f32, choose: F) -> Self {
        let never = [never; 16];
        let padded = vec![never; length + 2 * radius];
        Window { radius, choose, forwards: padded.clone(), backwards: padded, never }
    }

    fn slide(&mut self, line: &mut [Step]) {
        let (radius, window) = (self.radius, 2 * self.radius + 1);
        for padded in [&mut self.forwards, &mut self.backwards] {
            padded.fill(self.never);
            padded[radius..radius + line.len()].copy_from_slice(line);
        }
        let choose = |one: &Step, other: &Step| -> Step {
            std::array::from_fn(|lane| (self.choose)(one[lane], other[lane]))
        };
        for at in 1..self.forwards.len() {
            if at % window != 0 {
                self.forwards[at] = choose(&self.forwards[at - 1], &self.forwards[at]);
            }
        }
        for at in (0..self.backwards.len() - 1).rev() {
            if (at + 1) % window != 0 {
                self.backwards[at] = choose(&self.backwards[at + 1], &self.backwards[at]);
            }
        }
        for (at, step) in line.iter_mut().enumerate() {
            *step = choose(&self.backwards[at], &self.forwards[at + 2 * radius]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer::{IntRect, Pixel, Space};

    fn noise(width: u32, height: u32) -> Layer {
        let mut layer = Layer::clear(IntRect::new(0, 0, width, height), Space::Srgb);
        let mut seed = 1u32;
        for pixel in layer.pixels_mut() {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let alpha = (seed >> 24) as f32 / 255.0;
            *pixel = [alpha * 0.3, alpha * 0.9, alpha * ((seed >> 16) & 1) as f32, alpha];
        }
        layer
    }

    fn by_looking(layer: &Layer, (rx, ry): (i32, i32), choose: fn(f32, f32) -> f32) -> Vec<Pixel> {
        let (width, height) = (layer.rect().width() as i32, layer.rect().height() as i32);
        let mut found = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let mut best = layer.pixel(x, y);
                for ny in (y - ry).max(0)..=(y + ry).min(height - 1) {
                    for nx in (x - rx).max(0)..=(x + rx).min(width - 1) {
                        let other = layer.pixel(nx, ny);
                        best = std::array::from_fn(|i| choose(best[i], other[i]));
                    }
                }
                found.push(best);
            }
        }
        found
    }

    #[test]
    fn every_radius_finds_what_looking_at_each_window_finds() {
        let layer = noise(13, 9);
        for rx in 1..15 {
            for ry in [1, 2, 5, 30] {
                let radii = (f64::from(rx), f64::from(ry));
                let eroded = apply(layer.clone(), MorphologyOperator::Erode, radii);
                assert_eq!(eroded.pixels(), by_looking(&layer, (rx, ry), f32::min));
                let dilated = apply(layer.clone(), MorphologyOperator::Dilate, radii);
                assert_eq!(dilated.pixels(), by_looking(&layer, (rx, ry), f32::max));
            }
        }
    }

    #[test]
    fn absurd_radii_end() {
        let layer = noise(20, 20);
        for radius in [1e5, 1e30, f64::INFINITY] {
            let dilated = apply(layer.clone(), MorphologyOperator::Dilate, (radius, radius));
            assert!(dilated.pixels().iter().all(|p| p == &dilated.pixels()[0]));
        }
        for radius in [0.0, -3.0, f64::NAN] {
            let gone = apply(layer.clone(), MorphologyOperator::Dilate, (radius, 1.0));
            assert!(gone.pixels().iter().all(|p| p == &[0.0; 4]));
        }
    }
}
