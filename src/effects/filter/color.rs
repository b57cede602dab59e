//! Takes a layer, changes each pixel's colour by itself: feColorMatrix and feComponentTransfer. Both
//! see straight colour, and clamp what they make.
//!
//! A table over noise aliases where the noise goes through several of its entries within a pixel. Worley's
//! cure (Texturing & Modeling, ch. 5): a few samples of the noise in the pixel tell how its values are
//! distributed there, and the table's mean over each even stretch of them is a difference of its integrals.

use crate::effects::layer::{premultiplied, straight, unit, IntRect, Layer};
use usvg::filter::{ColorMatrixKind, ComponentTransfer, TransferFunction};

/// feColorMatrix.
pub(super) fn matrix(layer: Layer, kind: &ColorMatrixKind) -> Layer {
    let m = rows(kind);
    layer.map_straight(|[r, g, b, a]| {
        let row = |i: usize| m[i][0] * r + m[i][1] * g + m[i][2] * b + m[i][3] * a + m[i][4];
        [row(0), row(1), row(2), row(3)]
    })
}

type Rows = [[f32; 5]; 4];

fn rows(kind: &ColorMatrixKind) -> Rows {
    const ALPHA: [f32; 5] = [0.0, 0.0, 0.0, 1.0, 0.0];
    // Luminance as SVG 1.1 rounds it for these two kinds.
    const GREY: [f32; 3] = [0.213, 0.715, 0.072];
    match kind {
        ColorMatrixKind::Matrix(values) => {
            let value = |i: usize| values.get(i).copied().unwrap_or(0.0);
            std::array::from_fn(|row| std::array::from_fn(|column| value(row * 5 + column)))
        }
        ColorMatrixKind::Saturate(share) => {
            let share = share.get();
            let row = |own: usize| {
                let v = |i: usize| GREY[i] + (f32::from(u8::from(i == own)) - GREY[i]) * share;
                [v(0), v(1), v(2), 0.0, 0.0]
            };
            [row(0), row(1), row(2), ALPHA]
        }
        ColorMatrixKind::HueRotate(degrees) => {
            let turn = degrees.to_radians();
            let (cos, sin) = (libm::cosf(turn), libm::sinf(turn));
            // The sine's share, row by row, is the specification's own; it is no rounded rotation.
            const SINE: [[f32; 3]; 3] =
                [[-0.213, -0.715, 0.928], [0.143, 0.140, -0.283], [-0.787, 0.715, 0.072]];
            let row = |own: usize| {
                let v =
                    |i: usize| GREY[i] + (f32::from(u8::from(i == own)) - GREY[i]) * cos + SINE[own][i] * sin;
                [v(0), v(1), v(2), 0.0, 0.0]
            };
            [row(0), row(1), row(2), ALPHA]
        }
        ColorMatrixKind::LuminanceToAlpha => {
            [[0.0; 5], [0.0; 5], [0.0; 5], [0.2125, 0.7154, 0.0721, 0.0, 0.0]]
        }
    }
}

/// feComponentTransfer.
pub(super) fn transfer(layer: Layer, functions: &ComponentTransfer) -> Layer {
    let functions = [functions.func_r(), functions.func_g(), functions.func_b(), functions.func_a()];
    layer.map_straight(|pixel| std::array::from_fn(|i| transferred(functions[i], pixel[i])))
}

/// feComponentTransfer, averaged within a rectangle over the spot of each pixel: `middles` has the middles
/// of the spots, `corners` their upper left corners, of which each spot has four.
pub(super) fn transfer_over_spots(
    middles: Layer,
    corners: &Layer,
    functions: &ComponentTransfer,
    within: IntRect,
) -> Layer {
    let tables = [functions.func_r(), functions.func_g(), functions.func_b(), functions.func_a()]
        .map(|function| SumTable::of(|c| unit(transferred(function, c))));
    let mut made = transfer(middles.clone(), functions);
    let within = within.intersect(made.rect());
    for y in within.y()..within.bottom() {
        for (x, pixel) in (within.x()..).zip(made.span_mut(y, within)) {
            let middle = straight(middles.pixel(x, y));
            let corners =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| straight(corners.pixel(x + i, y + j)));
            let mean = |i: usize| tables[i].mean_over_spot(middle[i], corners.map(|corner| corner[i]));
            *pixel = premultiplied(std::array::from_fn(mean));
        }
    }
    made
}

/// The integral of a function over 0 ..= 1.
struct SumTable {
    sums: Vec<f64>,
}

impl SumTable {
    /// Steps of the table: a jump of the function is at most half of one off its place.
    const STEPS: usize = 1 << 14;

    fn of(function: impl Fn(f32) -> f32) -> SumTable {
        let mut sums = Vec::with_capacity(Self::STEPS + 1);
        let mut sum = 0.0;
        for i in 0..=Self::STEPS {
            sums.push(sum);
            sum += f64::from(function((i as f32 + 0.5) / Self::STEPS as f32)) / Self::STEPS as f64;
        }
        SumTable { sums }
    }

    fn integral(&self, c: f32) -> f64 {
        let at = f64::from(c) * Self::STEPS as f64;
        let step = (at as usize).min(Self::STEPS - 1);
        self.sums[step] + (at - step as f64) * (self.sums[step + 1] - self.sums[step])
    }

    /// The mean over a square of values known in its middle and its corners (row by row): between the
    /// corners they are bilinear, plus what the middle has more. They are walked along lines in the direction
    /// of the greater change, on each of which they go evenly from side to middle to side.
    fn mean_over_spot(&self, middle: f32, [a, b, c, d]: [f32; 4]) -> f32 {
        const LINES: usize = 8;
        let across = (b - a).abs() + (d - c).abs() >= (c - a).abs() + (d - b).abs();
        let (a, b, c, d) = if across { (a, b, c, d) } else { (a, c, b, d) };
        let more = middle - 0.25 * (a + b + c + d);
        let line = |i: usize| {
            let share = (i as f32 + 0.5) / LINES as f32;
            let (left, right) = (a + (c - a) * share, b + (d - b) * share);
            let middle = 0.5 * (left + right) + more * 4.0 * share * (1.0 - share);
            self.mean(left, middle) + self.mean(middle, right)
        };
        (0.5 / LINES as f64 * (0..LINES).map(line).sum::<f64>()) as f32
    }

    /// The mean between two values.
    fn mean(&self, one: f32, other: f32) -> f64 {
        let middle = 0.5 * (one + other);
        // No narrower than a step.
        let reach = (0.5 * (other - one).abs()).max(0.5 / Self::STEPS as f32);
        let (from, to) = ((middle - reach).max(0.0), (middle + reach).min(1.0));
        if from >= to {
            return 0.0;
        }
        (self.integral(to) - self.integral(from)) / f64::from(to - from)
    }
}

/// Components are sums of rounded products: one this close below a step is on it.
const ON_THE_STEP: f32 = 1e-5;

fn transferred(function: &TransferFunction, c: f32) -> f32 {
    match function {
        TransferFunction::Identity => c,
        TransferFunction::Table(values) => match values.as_slice() {
            [] => c,
            [only] => *only,
            values => {
                let at = c * (values.len() - 1) as f32;
                let step = (at as usize).min(values.len() - 2);
                values[step] + (at - step as f32) * (values[step + 1] - values[step])
            }
        },
        TransferFunction::Discrete(values) => match values.as_slice() {
            [] => c,
            values => {
                let step = ((c + ON_THE_STEP) * values.len() as f32) as usize;
                values[step.min(values.len() - 1)]
            }
        },
        TransferFunction::Linear { slope, intercept } => slope * c + intercept,
        TransferFunction::Gamma { amplitude, exponent, offset } => {
            amplitude * libm::powf(c, *exponent) + offset
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer::Space;

    #[test]
    fn tables_pass_through_their_values() {
        let table = TransferFunction::Table(vec![1.0, 0.0, 0.5]);
        for (c, wanted) in [(0.0, 1.0), (0.25, 0.5), (0.5, 0.0), (0.75, 0.25), (1.0, 0.5)] {
            assert!((transferred(&table, c) - wanted).abs() < 1e-6);
        }
        let steps = TransferFunction::Discrete(vec![0.1, 0.2, 0.3, 0.4]);
        for (c, wanted) in [(0.0, 0.1), (0.2, 0.1), (0.25, 0.2), (0.9, 0.4), (1.0, 0.4)] {
            assert_eq!(transferred(&steps, c), wanted);
        }
        for empty in [TransferFunction::Table(vec![]), TransferFunction::Discrete(vec![])] {
            assert_eq!(transferred(&empty, 0.3), 0.3);
        }
        assert_eq!(transferred(&TransferFunction::Table(vec![0.7]), 0.3), 0.7);
    }

    #[test]
    fn a_table_s_mean_over_a_spot_is_that_of_many_points_in_it() {
        let steps = TransferFunction::Discrete(vec![0.0, 1.0, 0.25, 0.75, 0.5]);
        let gamma = TransferFunction::Gamma { amplitude: 1.5, exponent: 2.0, offset: -0.2 };
        for function in [steps, gamma] {
            let value = |c: f32| unit(transferred(&function, c));
            let table = SumTable::of(value);
            for corners in [[0.1, 0.7, 0.3, 0.9], [0.2, 0.22, 0.9, 0.8], [0.5; 4], [0.0, 0.0, 1.0, 1.0]] {
                let [a, b, c, d] = corners;
                let point = |i: u32| {
                    let (x, y) = ((i % 500) as f32 / 500.0 + 0.001, (i / 500) as f32 / 500.0 + 0.001);
                    let (upper, lower) = (a + (b - a) * x, c + (d - c) * x);
                    f64::from(value(upper + (lower - upper) * y))
                };
                let mean = (0..250_000).map(point).sum::<f64>() / 250_000.0;
                let middle = corners.iter().sum::<f32>() / 4.0;
                let found = f64::from(table.mean_over_spot(middle, corners));
                assert!((found - mean).abs() < 0.01, "{corners:?}: {found}, not {mean}");
            }
        }
    }

    #[test]
    fn what_is_too_faint_for_a_byte_has_no_colour() {
        let alpha = |faint: f32| {
            let mut layer = Layer::clear(IntRect::new(0, 0, 1, 1), Space::Srgb);
            layer.span_mut(0, layer.rect())[0] = [faint; 4];
            matrix(layer, &ColorMatrixKind::LuminanceToAlpha).pixel(0, 0)[3]
        };
        assert_eq!(alpha(0.4 / 255.0), 0.0);
        assert!((alpha(0.6 / 255.0) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_whole_turn_of_hue_and_full_saturation_change_nothing() {
        let full = usvg::filter::ColorMatrixKind::HueRotate(360.0);
        let rows = rows(&full);
        for (own, row) in rows.iter().enumerate() {
            for (i, v) in row.iter().enumerate() {
                assert!((v - f32::from(u8::from(i == own))).abs() < 1e-5);
            }
        }
    }
}
