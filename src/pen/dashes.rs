//! Takes a path, makes its dashes (SVG 2, 13.5.6).

use crate::scene::StrokeStyle;
use kurbo::{Affine, BezPath, Cap};

/// The length of a dash without one, as a share of the pen's width.
const NO_LENGTH: f64 = 1e-6;

/// More dashes than this are drawn as one line.
const MOST_DASHES: f64 = 1_000_000.0;

/// The dashes of a path, or `None` where it is drawn as one line.
pub(super) fn dashed(path: &BezPath, style: &StrokeStyle) -> Option<BezPath> {
    let mut dashes = style.dash_pattern.clone();
    if style.start_cap != Cap::Butt {
        // Those without a length have caps all the same.
        dashes.iter_mut().for_each(|dash| *dash = dash.max(NO_LENGTH * style.width));
    }
    let period: f64 = dashes.iter().sum();
    let length = length(path);
    let count = length * dashes.len() as f64 / period;
    // A period that is nothing, or not a number, would not end either.
    if count.is_nan() || count > MOST_DASHES {
        return None;
    }
    let scale = scale_for_dashes(length);
    if scale == 1.0 {
        return Some(kurbo::dash(path.iter(), style.dash_offset, &dashes).collect());
    }
    dashes.iter_mut().for_each(|dash| *dash *= scale);
    let scaled = Affine::scale(scale) * path;
    let dashed: BezPath = kurbo::dash(scaled.iter(), style.dash_offset * scale, &dashes).collect();
    Some(Affine::scale(1.0 / scale) * dashed)
}

/// A power of two by which a path of this length becomes one of 1/2 to 2^20. kurbo measures curves to a millionth of
/// whatever unit they are in: it would not end where floats are coarser, and of a short one see nothing.
fn scale_for_dashes(length: f64) -> f64 {
    match length {
        0.0 | 1.0..=1_048_576.0 => 1.0,
        _ => libm::exp2((if length < 1.0 { 0.0 } else { 20.0 } - libm::log2(length)).floor()),
    }
}

/// Length of the control polygon: never less than the path's own.
fn length(path: &BezPath) -> f64 {
    let hull = |segment: kurbo::PathSeg| match segment {
        kurbo::PathSeg::Line(l) => (l.p1 - l.p0).hypot(),
        kurbo::PathSeg::Quad(q) => (q.p1 - q.p0).hypot() + (q.p2 - q.p1).hypot(),
        kurbo::PathSeg::Cubic(c) => (c.p1 - c.p0).hypot() + (c.p2 - c.p1).hypot() + (c.p3 - c.p2).hypot(),
    };
    path.segments().map(hull).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{PathEl, Stroke};

    #[test]
    fn dashes_of_a_curve_of_any_size_end_and_are_alike() {
        let dashed = |size: f64| {
            let path = format!("M0 0C{size} 0 {size} {size} 0 {size}");
            let pen = Stroke::new(size).with_dashes(0.1 * size, [0.3 * size, 0.2 * size]);
            let style: StrokeStyle = pen.into();
            let path = BezPath::from_svg(&path).expect("a path");
            let dashes: BezPath = super::dashed(&path, &style).expect("dashes");
            (Affine::scale(1.0 / size) * dashes).into_elements()
        };
        let expected = dashed(1000.0);
        assert_eq!(expected.iter().filter(|element| matches!(element, PathEl::MoveTo(_))).count(), 5);
        for size in [1e-30, 1e-3, 1e8, 1e12, 1e15, 1e30] {
            let found = dashed(size);
            assert_eq!(found.len(), expected.len(), "{size}");
            for (a, b) in found.iter().zip(&expected) {
                let (a, b) = (a.end_point().expect("a point"), b.end_point().expect("a point"));
                assert!((a - b).hypot() < 1e-5, "{size}: {a} and not {b}");
            }
        }
    }
}
