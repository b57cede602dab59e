//! Takes a stroke, makes the outline that it fills, by tiny-skia's stroker.
//!
//! The stroker errs by a quarter of a unit whatever the unit is, so it is given the path at a size
//! where that is nothing; sizes are powers of two, which leave every digit as it was.

use usvg::tiny_skia_path::{Path, PathStroker, Stroke, StrokeDash, Transform};

/// The stroker's own error, in the units of what it is given.
const STROKER_ERROR: f64 = 0.25;

/// Paths are not made larger than this many units, nor strokes: floats keep 24 binary digits.
const LARGEST: f32 = 1e9;

/// An outline, and the factor by which it is too large.
pub(crate) struct Outline {
    pub path: Path,
    pub size: f32,
}

/// Draws the outline of a stroke within `tolerance` of the true one, in the path's units. `None` of a
/// stroke that covers nothing.
pub(crate) fn outline(stroker: &mut PathStroker, path: &Path, style: &Stroke, tolerance: f64) -> Option<Outline> {
    let b = path.bounds();
    let extent = [b.left(), b.top(), b.right(), b.bottom(), style.width].into_iter().fold(1e-9, |a: f32, v| a.max(v.abs()));
    let wanted = (STROKER_ERROR / tolerance) as f32;
    let size = power_of_two_above(wanted.min(LARGEST / extent));
    let scaled = path.clone().transform(Transform::from_scale(size, size))?;
    let mut style = style.clone();
    style.width *= size;
    let dashed = style.dash.take().and_then(|dash| dashes(path, &dash, size));
    let path = stroker.stroke(dashed.as_ref().unwrap_or(&scaled), &style, 1.0)?;
    Some(Outline { path, size })
}

/// The dashes of a path, `size` times as large. A path of a million dashes or more stays whole: `None`.
fn dashes(path: &Path, dash: &StrokeDash, size: f32) -> Option<Path> {
    path.dash(dash, size)?.transform(Transform::from_scale(size, size))
}

fn power_of_two_above(v: f32) -> f32 {
    let exponent = (v.max(1.0).to_bits() >> 23) as i32 - 127 + 1;
    2f32.powi(exponent)
}
