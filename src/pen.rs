//! Takes a path and a pen, makes the outline of the line that it draws, by kurbo's stroker.
//!
//! The stroker leaves out lines and dashes that have no length, of which SVG draws the round and
//! square caps; they are given one too short to be seen. And on the inner side of a corner it goes
//! straight from one line's border to the next one's, which is a hole where a line is shorter than the
//! pen is wide; there the corner's inner triangle is filled.

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
    let dashed = match pen.dash_pattern.is_empty() {
        true => path,
        false => kurbo::dash(path.into_iter(), pen.dash_offset, &pen.dash_pattern).collect(),
    };
    pen.dash_pattern.clear();
    kurbo::stroke_with(&dashed, &pen, &Default::default(), tolerance, context);
    context.output().iter().chain(inner_triangles(&dashed, 0.5 * pen.width))
}

/// A segment of a path, as its joins see it.
#[derive(Clone, Copy)]
struct Stretch {
    /// Unit vectors along it, where it begins and where it ends.
    begins: Vec2,
    ends: Vec2,
    /// From end to end.
    length: f64,
}

impl Stretch {
    /// From its control points; `None` of a segment that goes nowhere.
    fn of(hull: &[Point]) -> Option<Stretch> {
        let (&first, &last) = (hull.first()?, hull.last()?);
        let second = *hull.iter().find(|&&p| p != first)?;
        let last_but_one = *hull.iter().rev().find(|&&p| p != last)?;
        let (begins, ends) = ((second - first).normalize(), (last - last_but_one).normalize());
        Some(Stretch { begins, ends, length: (last - first).hypot() })
    }
}

/// The triangles between corners and the ends of the borders on their inner sides, where one of the
/// lines that meet is too short to cover its own. They wind as the stroker's outlines do.
fn inner_triangles(path: &BezPath, radius: f64) -> Vec<PathEl> {
    let (mut triangles, mut hull) = (Vec::new(), Vec::new());
    let (mut start, mut here) = (Point::ZERO, Point::ZERO);
    let (mut first, mut last): (Option<Stretch>, Option<Stretch>) = (None, None);
    for element in path {
        hull.clear();
        hull.push(here);
        match element {
            PathEl::MoveTo(p) => {
                (start, here) = (p, p);
                (first, last) = (None, None);
                continue;
            }
            PathEl::ClosePath => hull.push(start),
            _ => hull.extend(control_points(&element)),
        };
        if let Some(stretch) = Stretch::of(&hull) {
            triangles.extend(
                last.and_then(|last| inner_triangle(here, last, stretch, radius)).into_iter().flatten(),
            );
            first.get_or_insert(stretch);
            last = Some(stretch);
        }
        here = hull[hull.len() - 1];
        if element == PathEl::ClosePath {
            let closing =
                first.zip(last).and_then(|(first, last)| inner_triangle(start, last, first, radius));
            triangles.extend(closing.into_iter().flatten());
            (first, last) = (None, None);
        }
    }
    triangles
}

/// The triangle inside one corner, if it is needed.
fn inner_triangle(corner: Point, before: Stretch, after: Stretch, radius: f64) -> Option<[PathEl; 4]> {
    let (sine, cosine) = (before.ends.cross(after.begins), before.ends.dot(after.begins));
    // How far back along a line the border of the other one begins.
    let reach = if cosine > 0.0 { radius * sine.abs() } else { radius };
    if sine == 0.0 || before.length.min(after.length) >= reach {
        return None;
    }
    let side = radius * sine.signum();
    let border = |along: Vec2| corner + side * Vec2::new(-along.y, along.x);
    let (one, other) = (border(before.ends), border(after.begins));
    let (one, other) = if sine > 0.0 { (one, other) } else { (other, one) };
    Some([PathEl::MoveTo(corner), PathEl::LineTo(one), PathEl::LineTo(other), PathEl::ClosePath])
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
