//! Takes a path, makes its dashes (SVG 2, 13.5.6).

use crate::scene::StrokeStyle;
use kurbo::{Affine, BezPath, Cap, PathEl, Point};

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
    dashes.iter_mut().for_each(|dash| *dash *= scale);
    let mut dashed = BezPath::new();
    let sub_paths = path.elements().chunk_by(|_, next| !matches!(next, PathEl::MoveTo(_)));
    for sub_path in sub_paths.filter(|sub_path| has_length(sub_path)) {
        let scaled = sub_path.iter().map(|element| Affine::scale(scale) * *element);
        dashed.extend(kurbo::dash(scaled, style.dash_offset * scale, &dashes));
    }
    Some(Affine::scale(1.0 / scale) * dashed)
}

/// Does a sub-path leave the point in which it begins? Otherwise it has no dashes, not even dots, and kurbo would begin
/// what comes next with it.
fn has_length(sub_path: &[PathEl]) -> bool {
    let start = sub_path.first().and_then(PathEl::end_point);
    let leaves = |point: &Point| Some(*point) != start;
    sub_path.iter().any(|element| match element {
        PathEl::MoveTo(_) | PathEl::ClosePath => false,
        PathEl::LineTo(p) => leaves(p),
        PathEl::QuadTo(p1, p) => leaves(p1) || leaves(p),
        PathEl::CurveTo(p1, p2, p) => leaves(p1) || leaves(p2) || leaves(p),
    })
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
    use kurbo::Stroke;

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
    #[test]
    fn a_sub_path_of_no_length_has_no_dashes_and_leaves_the_next_alone() {
        let dashed = |path: &str| {
            let style: StrokeStyle = Stroke::new(8.0).with_dashes(2.0, [10.0, 5.0]).into();
            let path = BezPath::from_svg(path).expect("a path");
            super::dashed(&path, &style).expect("dashes").into_elements()
        };
        for line in ["M3 4H40", "M3 4H40L9 9z"] {
            let expected = dashed(line);
            for nothing in ["M50 50z", "M50 50h0", "M50 50h0z", "M3 4C3 4 3 4 3 4z"] {
                for path in [format!("{nothing}{line}"), format!("{line}{nothing}")] {
                    assert_eq!(dashed(&path), expected, "{path}");
                }
            }
        }
    }
}
