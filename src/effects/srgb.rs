//! Takes one colour component, 0 ..= 1, in sRGB's encoding or in linear light; makes the other
//! (IEC 61966-2-1). Read from tables built by `libm`, so the bits are the same on every machine;
//! within 1e-5 of the formula, a four-hundredth of an 8-bit level.

use std::sync::LazyLock;

/// Below these the curve is a straight line through 0 with slope [`TOE_SLOPE`].
const ENCODED_TOE: f32 = 0.04045;
const LINEAR_TOE: f32 = 0.003_130_8;
const TOE_SLOPE: f32 = 12.92;

/// Linear light of an sRGB-encoded component; what lies outside 0 ..= 1 is clamped, NaN is 0.
#[inline]
pub(crate) fn linear_of_encoded(encoded: f32) -> f32 {
    if encoded > ENCODED_TOE {
        LINEAR.at(encoded)
    } else {
        encoded.max(0.0) / TOE_SLOPE
    }
}

/// The sRGB encoding of a component in linear light; what lies outside 0 ..= 1 is clamped, NaN is 0.
#[inline]
pub(crate) fn encoded_of_linear(linear: f32) -> f32 {
    if linear > LINEAR_TOE {
        ENCODED.at(linear)
    } else {
        linear.max(0.0) * TOE_SLOPE
    }
}

static LINEAR: LazyLock<Curve> = LazyLock::new(|| Curve::new(|v| libm::pow((v + 0.055) / 1.055, 2.4)));
static ENCODED: LazyLock<Curve> = LazyLock::new(|| Curve::new(|v| 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055));

/// A smooth function on [2^-9, 1], by chords whose length is a fixed share of the argument: the
/// first mantissa bits and the exponent of a float, read as an integer, number them.
struct Curve {
    /// Values at both ends of each chord.
    ends: Vec<f32>,
}

/// 2^8 chords an octave: the curves leave them by less than 1e-5 of their value.
const CHORD_BITS: u32 = 23 - 8;
/// The bits of 2^-9, the power of two below [`LINEAR_TOE`].
const FIRST: u32 = (127 - 9) << 23;
const ONE: u32 = 127 << 23;

impl Curve {
    fn new(function: impl Fn(f64) -> f64) -> Curve {
        let chords = (ONE - FIRST) >> CHORD_BITS;
        // One end more than needed, so that 1 itself has a chord to its right.
        let end = |i: u32| function(f64::from(f32::from_bits(FIRST + (i << CHORD_BITS)))) as f32;
        Curve { ends: (0..=chords + 1).map(end).collect() }
    }

    #[inline]
    fn at(&self, v: f32) -> f32 {
        let bits = v.to_bits().clamp(FIRST, ONE) - FIRST;
        let chord = (bits >> CHORD_BITS) as usize;
        let share = (bits & ((1 << CHORD_BITS) - 1)) as f32 * (1.0 / (1 << CHORD_BITS) as f32);
        let (a, b) = (self.ends[chord], self.ends[chord + 1]);
        a + (b - a) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_follow_the_formula() {
        for i in 0..=10_000 {
            let v = i as f32 / 10_000.0;
            let (linear, encoded) = (f64::from(linear_of_encoded(v)), f64::from(encoded_of_linear(v)));
            let v = f64::from(v);
            let right = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            assert!((linear - right).abs() < 1e-5, "{v}: {linear} {right}");
            let right = if v <= 0.0031308 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            assert!((encoded - right).abs() < 1e-5, "{v}: {encoded} {right}");
        }
    }

    #[test]
    fn the_ends_are_exact_and_nothing_leaves_them() {
        for curve in [linear_of_encoded, encoded_of_linear] {
            assert_eq!(curve(0.0), 0.0);
            assert_eq!(curve(1.0), 1.0);
            assert_eq!(curve(7.0), 1.0);
            assert_eq!(curve(-1.0), 0.0);
            assert_eq!(curve(f32::NAN), 0.0);
        }
    }
}
