//! Takes paths, makes straight segments in pixels.

use kurbo::{BezPath, PathEl, Point};
use usvg::tiny_skia_path::{self, PathSegment};

/// One straight piece of a shape's boundary, in pixels, from top to bottom (y grows downward); it
/// counts for y in [y_top, y_bottom).
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) x_top: f64,
    pub(super) y_top: f64,
    pub(super) x_bottom: f64,
    pub(super) y_bottom: f64,
    /// What it adds to the winding number of all that lies to its right: 1 if the path runs down, -1
    /// if up.
    pub(super) winding: i32,
    /// Whose boundary it is.
    pub(super) geometry: u32,
}

/// The same path in f64.
pub(super) fn bez_path(path: &tiny_skia_path::Path) -> BezPath {
    let point = |p: tiny_skia_path::Point| Point::new(f64::from(p.x), f64::from(p.y));
    let mut bez = BezPath::new();
    for segment in path.segments() {
        match segment {
            PathSegment::MoveTo(p) => bez.move_to(point(p)),
            PathSegment::LineTo(p) => bez.line_to(point(p)),
            PathSegment::QuadTo(c, p) => bez.quad_to(point(c), point(p)),
            PathSegment::CubicTo(c, d, p) => bez.curve_to(point(c), point(d), point(p)),
            PathSegment::Close => bez.close_path(),
        }
    }
    bez
}

/// Flattens `path`, closes each sub-path, and calls `emit` with each segment which is not
/// horizontal; geometry 0. A path with a coordinate that is not finite has none.
pub(super) fn segments(path: &BezPath, tolerance: f64, mut emit: impl FnMut(Segment)) {
    if !path.is_finite() {
        return;
    }
    let mut line = |from: Point, to: Point| {
        let (top, bottom, winding) = if from.y < to.y { (from, to, 1) } else { (to, from, -1) };
        if top.y < bottom.y {
            emit(Segment {
                x_top: top.x,
                y_top: top.y,
                x_bottom: bottom.x,
                y_bottom: bottom.y,
                winding,
                geometry: 0,
            });
        }
    };
    let (mut start, mut last) = (Point::ZERO, Point::ZERO);
    kurbo::flatten(path, tolerance, |element| match element {
        PathEl::MoveTo(p) => {
            line(last, start);
            (start, last) = (p, p);
        }
        PathEl::LineTo(p) => {
            line(last, p);
            last = p;
        }
        PathEl::ClosePath => {
            line(last, start);
            last = start;
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => unreachable!("flattened"),
    });
    line(last, start);
}
