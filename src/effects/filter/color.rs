//! Takes a layer, changes each pixel's colour by itself: feColorMatrix and feComponentTransfer. Both
//! see straight colour, and clamp what they make.

use crate::effects::layer::Layer;
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
