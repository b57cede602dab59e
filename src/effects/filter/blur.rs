//! Takes a layer and two standard deviations in pixels, makes the blurred layer (feGaussianBlur).
//!
//! Beyond the layer all is clear, and what is blurred out of it is lost. Three ways, by the deviation
//! along the axis:
//! * below [`DIRECT`] pixels: convolution with the sampled Gaussian;
//! * above: five box filters whose ends are fractional, so that the variance is right for any
//!   deviation (Gwosdek, Grewenig, Bruhn, Weickert: Theoretical Foundations of Gaussian Convolution
//!   by Extended Box Filtering, 2011), at a cost that does not depend on the deviation;
//! * from half the layer's length on: so smooth that it is summed from 64 shares of the line, which
//!   bounds time and memory for any deviation.

use super::lines::{along, Axis, Step};
use crate::effects::layer::Layer;

/// Deviations below this many pixels are convolved directly: there a box of whole pixels is coarse.
const DIRECT: f64 = 2.0;
/// Deviations below this many pixels do nothing: the neighbour's weight is below 1e-80.
const NOTHING: f64 = 0.05;
/// The direct kernel ends after this many deviations, where the weight is 1/3000 of the middle's.
const KERNEL_REACH: f64 = 4.0;
/// Box filters in a row. Five leave an edge off by 1.5 levels of 255 and a dot's peak by 3%, as in
/// resvg; three, as SVG has it, by 2.5 levels and 5%.
const BOXES: usize = 5;
/// Shares of a line, and of the deviation at least half as many.
const SHARES: usize = 64;
/// Sums below this are what rounding has left over where there is nothing.
const FAINTEST: f32 = 1e-7;

/// The layer blurred along both axes; deviations that are no numbers or not positive do nothing.
pub(super) fn gaussian(mut layer: Layer, (x, y): (f64, f64)) -> Layer {
    for (axis, deviation) in [(Axis::X, x), (Axis::Y, y)] {
        let length = match axis {
            Axis::X => layer.rect().width(),
            Axis::Y => layer.rect().height(),
        };
        if deviation.is_nan() || deviation < NOTHING || layer.rect().is_empty() {
            continue;
        }
        if deviation < DIRECT {
            let mut kernel = Kernel::new(deviation);
            along(&mut layer, axis, |line| kernel.convolve(line));
        } else if deviation < length as f64 * 0.5 {
            let mut boxes = Boxes::new(deviation, length);
            along(&mut layer, axis, |line| boxes.blur(line));
        } else {
            along(&mut layer, axis, |line| blur_smoothly(line, deviation));
        }
    }
    layer
}

/// How many pixels away a pixel still changes something.
pub(super) fn reach(deviation: f64) -> f64 {
    if deviation < NOTHING {
        0.0
    } else if deviation < DIRECT {
        (deviation * KERNEL_REACH).ceil()
    } else {
        let (radius, _) = box_size(deviation);
        ((radius + 1) * BOXES) as f64
    }
}

/// A sampled Gaussian: the middle's weight, then outwards.
struct Kernel {
    weights: Vec<f32>,
    padded: Vec<Step>,
}

impl Kernel {
    fn new(deviation: f64) -> Kernel {
        let reach = (deviation * KERNEL_REACH).ceil() as usize;
        let weight = |i: usize| libm::exp(-((i * i) as f64) / (2.0 * deviation * deviation));
        let sum = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
        Kernel { weights: (0..=reach).map(|i| (weight(i) / sum) as f32).collect(), padded: Vec::new() }
    }

    fn convolve(&mut self, line: &mut [Step]) {
        let reach = self.weights.len() - 1;
        self.padded.clear();
        self.padded.resize(line.len() + 2 * reach, ZERO);
        self.padded[reach..reach + line.len()].copy_from_slice(line);
        for (at, step) in line.iter_mut().enumerate() {
            let window = &self.padded[at..=at + 2 * reach];
            let mut sum = ZERO;
            add(&mut sum, &window[reach], self.weights[0]);
            for (i, &weight) in self.weights.iter().enumerate().skip(1) {
                for lane in 0..sum.len() {
                    sum[lane] += weight * (window[reach - i][lane] + window[reach + i][lane]);
                }
            }
            *step = sum;
        }
    }
}

const ZERO: Step = [0.0; 16];

#[inline]
fn add(sum: &mut Step, step: &Step, weight: f32) {
    for lane in 0..sum.len() {
        sum[lane] += weight * step[lane];
    }
}

/// Whole pixels either side of the middle, and the weight of the pixel beyond them, of each box.
fn box_size(deviation: f64) -> (usize, f64) {
    // A variance at which neither sizes nor products overflow.
    let variance = deviation.min(1e6) * deviation.min(1e6) / BOXES as f64;
    let radius = (0.5 * (12.0 * variance + 1.0).sqrt() - 0.5).floor();
    let end = (2.0 * radius + 1.0) * (radius * (radius + 1.0) - 3.0 * variance)
        / (6.0 * (variance - (radius + 1.0) * (radius + 1.0)));
    (radius as usize, end)
}

/// Box filters, and two lines to work between, padded so that what leaves the line may come back.
struct Boxes {
    radius: usize,
    end: f32,
    scale: f64,
    from: Vec<Step>,
    to: Vec<Step>,
    padding: usize,
}

impl Boxes {
    fn new(deviation: f64, length: usize) -> Boxes {
        let (radius, end) = box_size(deviation);
        // All that leaves the line and returns stays within half of the boxes.
        let padding = (radius + 1) * BOXES;
        let padded = vec![ZERO; length + 2 * padding];
        Boxes {
            radius,
            end: end as f32,
            scale: 1.0 / (2.0 * radius as f64 + 1.0 + 2.0 * end),
            from: padded.clone(),
            to: padded,
            padding,
        }
    }

    fn blur(&mut self, line: &mut [Step]) {
        self.from.fill(ZERO);
        self.from[self.padding..self.padding + line.len()].copy_from_slice(line);
        for pass in 1..=BOXES {
            // What later passes can still bring back to the line.
            let margin = (self.radius + 1) * (BOXES - pass);
            self.pass(self.padding - margin..self.padding + line.len() + margin);
            std::mem::swap(&mut self.from, &mut self.to);
        }
        line.copy_from_slice(&self.from[self.padding..self.padding + line.len()]);
        for step in line.iter_mut() {
            step.iter_mut().for_each(|v| *v = if *v < FAINTEST { 0.0 } else { *v });
        }
    }

    /// One box over a range that ends at least a box's length inside the padded line.
    fn pass(&mut self, range: std::ops::Range<usize>) {
        let radius = self.radius;
        let mut sum = [0.0f64; 16];
        for step in &self.from[range.start - radius..range.start + radius] {
            for lane in 0..sum.len() {
                sum[lane] += f64::from(step[lane]);
            }
        }
        for at in range {
            let (before, after) = (&self.from[at - radius - 1], &self.from[at + radius + 1]);
            let (leaving, entering) = (&self.from[at - radius], &self.from[at + radius]);
            let to = &mut self.to[at];
            for lane in 0..sum.len() {
                sum[lane] += f64::from(entering[lane]);
                let ends = self.end * (before[lane] + after[lane]);
                to[lane] = ((sum[lane] + f64::from(ends)) * self.scale) as f32;
                sum[lane] -= f64::from(leaving[lane]);
            }
        }
    }
}

/// A deviation of at least half the line: the line's light, gathered at the centroids of its shares,
/// spreads to their borders, and linearly between these.
fn blur_smoothly(line: &mut [Step], deviation: f64) {
    let length = line.len();
    let shares = SHARES.min(length);
    let border = |share: usize| share * length / shares;
    let gathered: Vec<(Step, Step)> = (0..shares)
        .map(|share| {
            let (mut sum, mut moment) = (ZERO, ZERO);
            let first = border(share);
            for (i, step) in line[first..border(share + 1)].iter().enumerate() {
                add(&mut sum, step, 1.0);
                add(&mut moment, step, (first + i) as f32 + 0.5);
            }
            (sum, moment)
        })
        .collect();
    let peak = (1.0 / (deviation * (2.0 * std::f64::consts::PI).sqrt())) as f32;
    let reciprocal = (1.0 / deviation) as f32;
    let at_border: Vec<Step> = (0..=shares)
        .map(|share| {
            let mut spread = ZERO;
            for (sum, moment) in &gathered {
                for lane in 0..16 {
                    if sum[lane] > 0.0 {
                        let away = (border(share) as f32 - moment[lane] / sum[lane]) * reciprocal;
                        spread[lane] += sum[lane] * peak * libm::expf(-0.5 * away * away);
                    }
                }
            }
            spread
        })
        .collect();
    for share in 0..shares {
        let (first, last) = (border(share), border(share + 1));
        for (at, step) in line[first..last].iter_mut().enumerate() {
            let along = (at as f32 + 0.5) / (last - first) as f32;
            *step = ZERO;
            add(step, &at_border[share], 1.0 - along);
            add(step, &at_border[share + 1], along);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer::{IntRect, Space};

    fn dot(width: u32, height: u32) -> Layer {
        let mut layer = Layer::clear(IntRect::new(0, 0, width, height), Space::Linear);
        let middle = (height / 2 * width + width / 2) as usize;
        layer.pixels_mut()[middle] = [1.0, 0.5, 0.25, 1.0];
        layer
    }

    fn bar(length: u32, from: usize, to: usize) -> Layer {
        let mut layer = Layer::clear(IntRect::new(0, 0, length, 1), Space::Linear);
        layer.pixels_mut()[from..to].fill([1.0; 4]);
        layer
    }

    /// The bar blurred by the formula, at a pixel's centre.
    fn exact(from: usize, to: usize, deviation: f64, at: usize) -> f64 {
        let edge = |v: usize| libm::erf((v as f64 - at as f64 - 0.5) / (deviation * 2f64.sqrt()));
        0.5 * (edge(to) - edge(from))
    }

    #[test]
    fn a_blurred_dot_keeps_its_light_and_has_the_variance_asked_for() {
        for deviation in [0.3, 0.8, 1.7, 2.0, 2.6, 5.0, 11.3] {
            let blurred = gaussian(dot(161, 3), (deviation, 0.0));
            let row: Vec<f64> = (0..161).map(|x| f64::from(blurred.pixel(x, 1)[0])).collect();
            let sum: f64 = row.iter().sum();
            let variance: f64 = row.iter().enumerate().map(|(x, v)| v * (x as f64 - 80.0).powi(2)).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{deviation}: {sum}");
            let wanted = deviation * deviation;
            // A narrow Gaussian, sampled, is narrower than itself.
            let tolerance = if deviation < 0.5 { 0.95 } else { 0.005 };
            assert!((variance - wanted).abs() < tolerance * wanted, "{deviation}: {variance}");
        }
    }

    #[test]
    fn a_blurred_bar_follows_the_error_function() {
        for (deviation, tolerance) in [(1.0, 0.01), (1.9, 0.005), (2.0, 0.01), (6.5, 0.006), (30.0, 0.008)] {
            let blurred = gaussian(bar(400, 150, 230), (deviation, 0.0));
            for x in 0..400 {
                let off = f64::from(blurred.pixel(x as i32, 0)[3]) - exact(150, 230, deviation, x);
                assert!(off.abs() < tolerance, "{deviation} at {x}: off by {off}");
            }
        }
    }

    #[test]
    fn the_ways_to_blur_agree_where_they_meet() {
        for deviation in [99.0, 101.0, 300.0, 4000.0] {
            let blurred = gaussian(bar(200, 20, 90), (deviation, 0.0));
            for x in 0..200 {
                let off = f64::from(blurred.pixel(x as i32, 0)[3]) - exact(20, 90, deviation, x);
                assert!(off.abs() < 0.01, "{deviation} at {x}: off by {off}");
            }
        }
    }

    #[test]
    fn rows_and_columns_are_blurred_alike() {
        let blurred = gaussian(dot(63, 63), (4.0, 4.0));
        for y in 0..63 {
            for x in 0..63 {
                assert!((blurred.pixel(x, y)[3] - blurred.pixel(y, x)[3]).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn absurd_deviations_end_and_leave_almost_nothing() {
        for deviation in [1e5, 1e9, 1e30, f64::INFINITY] {
            let blurred = gaussian(dot(40, 40), (deviation, deviation));
            assert!(blurred.pixels().iter().flatten().all(|v| (0.0..1e-4).contains(v)), "{deviation}");
        }
        assert_eq!(gaussian(dot(5, 5), (f64::NAN, -1.0)), dot(5, 5));
        assert_eq!(gaussian(dot(1, 1), (3.0, 1.0)).rect().width(), 1);
    }

    #[test]
    fn beyond_its_reach_a_blur_leaves_nothing() {
        let blurred = gaussian(bar(400, 199, 200), (10.0, 0.0));
        let reach = reach(10.0) as i32;
        assert_eq!(blurred.pixel(199 - reach - 1, 0), [0.0; 4]);
        assert_eq!(blurred.pixel(199 + reach + 1, 0), [0.0; 4]);
    }
}
