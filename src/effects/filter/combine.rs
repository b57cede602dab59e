//! Takes two layers over one rectangle and in one space, makes one of them: feBlend, feComposite and
//! feMerge.

use crate::effects::blend::{blend, over};
use crate::effects::layer::{unit, Layer, Pixel};
use usvg::filter::CompositeOperator;

/// feBlend: `upper` (in) seen on `lower` (in2).
pub(super) fn blended(mode: usvg::BlendMode, upper: &Layer, lower: Layer) -> Layer {
    combined(upper, lower, |upper, lower| blend(mode, upper, lower))
}

/// feMerge, one step.
pub(super) fn merged(upper: &Layer, lower: Layer) -> Layer {
    combined(upper, lower, over)
}

/// feComposite: Porter and Duff's operators and a sum of products.
pub(super) fn composite(operator: CompositeOperator, upper: &Layer, lower: Layer) -> Layer {
    use CompositeOperator::{Arithmetic, Atop, In, Lighter, Out, Over, Xor};
    match operator {
        Over => combined(upper, lower, over),
        In => combined(upper, lower, |u, l| each(u, l, l[3], 0.0)),
        Out => combined(upper, lower, |u, l| each(u, l, 1.0 - l[3], 0.0)),
        Atop => combined(upper, lower, |u, l| each(u, l, l[3], 1.0 - u[3])),
        Xor => combined(upper, lower, |u, l| each(u, l, 1.0 - l[3], 1.0 - u[3])),
        Lighter => combined(upper, lower, |u, l| each(u, l, 1.0, 1.0).map(unit)),
        Arithmetic { k1, k2, k3, k4 } => combined(upper, lower, |u, l| {
            let [r, g, b, a] = std::array::from_fn(|i| k1 * u[i] * l[i] + k2 * u[i] + k3 * l[i] + k4);
            let a = unit(a);
            // `max` before `min`: NaN becomes 0.
            let [r, g, b] = [r, g, b].map(|v: f32| v.max(0.0).min(a));
            [r, g, b, a]
        }),
    }
}

/// So much of the one and so much of the other.
#[inline]
fn each(upper: Pixel, lower: Pixel, of_upper: f32, of_lower: f32) -> Pixel {
    std::array::from_fn(|i| upper[i] * of_upper + lower[i] * of_lower)
}

#[inline]
fn combined(upper: &Layer, mut lower: Layer, mix: impl Fn(Pixel, Pixel) -> Pixel) -> Layer {
    debug_assert_eq!((upper.rect(), upper.space()), (lower.rect(), lower.space()));
    for (lower, &upper) in lower.pixels_mut().iter_mut().zip(upper.pixels()) {
        *lower = mix(upper, *lower);
    }
    lower
}
