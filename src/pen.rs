//! Takes a path and a pen, makes the outline of the line that it draws, by kurbo's stroker.
//!
//! The stroker leaves out lines and dashes that have no length, of which SVG draws the round and
//! square caps; they are given one too short to be seen.

use kurbo::{BezPath, Cap, PathEl, Point, Stroke, StrokeCtx, Vec2};

/// The length of a line without one, as a share of the pen's width.
const NO_LENGTH: f64 = 1e-6;

/// More dashes than this are drawn as one line.
const MOST_DASHES: f64 = 1_000_000.0;

/// Draws the outline within `tolerance` of the true one, in the path's units. It may lie over itself,
/// and is to be filled non-zero.
pub(crate) fn outline<'a>(
    context: &'a mut StrokeCtx,
    path: impl Iterator<Item = PathEl>,
    pen: &Stroke,
    tolerance: f64,
) -> impl Iterator<Item = PathEl> + 'a {
    let has_dots = pen.start_cap != Cap::Butt;
    let path = if has_dots { with_dots(path, NO_LENGTH * pen.width) } else { path.collect() };
    let mut pen = pen.clone();
    if has_dots {
        pen.dash_pattern.iter_mut().for_each(|dash| *dash = dash.max(NO_LENGTH * pen.width));
    }
    let period: f64 = pen.dash_pattern.iter().sum();
    let dashes = length(&path) * pen.dash_pattern.len() as f64 / period;
    // A period that is nothing, or not a number, would not end either.
    if !pen.dash_pattern.is_empty() && (dashes.is_nan() || dashes > MOST_DASHES) {
        pen.dash_pattern.clear();
    }
    kurbo::stroke_with(&path, &pen, &Default::default(), tolerance, context);
    context.output().iter()
}

/// The path, with sub-paths that go nowhere going a little to the right.
fn with_dots(path: impl Iterator<Item = PathEl>, step: f64) -> BezPath {
    let mut dotted = BezPath::new();
    let mut start = Point::ZERO;
    // Has the sub-path drawn anything yet, and has it left its start?
    let (mut drawn, mut left) = (false, false);
    for element in path.chain([PathEl::MoveTo(Point::ZERO)]) {
        let ends = matches!(element, PathEl::MoveTo(_) | PathEl::ClosePath);
        drawn |= !matches!(element, PathEl::MoveTo(_));
        left |= !ends && control_points(&element).any(|p| p != start);
        let is_dot = ends && drawn && !left;
        if is_dot {
            dotted.line_to(start + Vec2::new(step, 0.0));
        }
        if let PathEl::MoveTo(p) = element {
            start = p;
        }
        if ends {
            (drawn, left) = (false, false);
        }
        // Closing a dot would draw a join where there are nothing but caps.
        if !(is_dot && element == PathEl::ClosePath) {
            dotted.push(element);
        }
    }
    dotted.pop();
    dotted
}

fn control_points(element: &PathEl) -> impl Iterator<Item = Point> {
    let (points, count) = match *element {
        PathEl::MoveTo(p) | PathEl::LineTo(p) => ([p; 3], 1),
        PathEl::QuadTo(p1, p2) => ([p1, p2, p2], 2),
        PathEl::CurveTo(p1, p2, p3) => ([p1, p2, p3], 3),
        PathEl::ClosePath => ([Point::ZERO; 3], 0),
    };
    points.into_iter().take(count)
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
