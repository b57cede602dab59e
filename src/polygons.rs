//! Takes a shape's [`Geometry`] and the transform to pixels, makes flat polygons: strokes become
//! outlines, curves become chords, each handed to an [`EdgeList`].
//!
//! Promises: a curve walked either way gives the same vertices bit for bit, and the polygon has the
//! curve's area. A chord polygon through points of a curve lies on its inner side; each inner vertex
//! is therefore moved outwards by `-p'' h^2 / 12`, which gives back the two half slivers beside it.

use crate::edges::EdgeList;
use crate::pen::Pen;
use crate::scene::{Geometry, Outline};
use kurbo::{Affine, PathEl, Point, Rect, Shape, Vec2};
use usvg::tiny_skia_path::PathSegment;

/// A curve becomes at most this many chords, however large it is.
const MOST_CHORDS: f64 = 16384.0;

/// The area that a pixel may be off by, as a share of the tolerance times a pixel's side.
const AREA_SHARE: f64 = 0.075;

/// Flattens shapes; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Flattener {
    pen: Pen,
}

impl Flattener {
    /// Adds the edges of `geometry` to `edges`. `tolerance` is a distance in pixels.
    pub fn flatten(&mut self, geometry: &Geometry, to_pixels: Affine, tolerance: f64, edges: &mut EdgeList) {
        let transform = to_pixels * geometry.transform;
        match &geometry.outline {
            Outline::Fill(_) => {
                polygons(elements(&geometry.path), transform, tolerance, edges);
            }
            Outline::Pixels => {
                let b = geometry.path.bounds();
                let own = Rect::new(b.left().into(), b.top().into(), b.right().into(), b.bottom().into());
                let pixels = transform.transform_rect_bbox(own).expand();
                polygons(pixels.path_elements(tolerance), Affine::IDENTITY, tolerance, edges);
            }
            Outline::Stroke(style) => {
                let scale = largest_scale(transform);
                if scale <= 0.0 || !scale.is_finite() {
                    return;
                }
                let path = elements(&geometry.path);
                self.pen.stroke(path, style, (transform, scale), tolerance, edges);
            }
        }
    }
}

/// Flattens sub-paths; each is closed, as filling asks.
fn polygons(path: impl Iterator<Item = PathEl>, transform: Affine, tolerance: f64, edges: &mut EdgeList) {
    let mut start = Point::ZERO;
    let mut last = Point::ZERO;
    for element in path {
        match element {
            PathEl::MoveTo(p) => {
                start = transform * p;
                last = start;
                edges.move_to(start);
            }
            PathEl::LineTo(p) => {
                last = transform * p;
                edges.line_to(last);
            }
            PathEl::QuadTo(p1, p2) => {
                let (p1, p2) = (transform * p1, transform * p2);
                chords(Curve::quadratic(last, p1, p2), &[last, p1, p2], tolerance, edges);
                last = p2;
            }
            PathEl::CurveTo(p1, p2, p3) => {
                let (p1, p2, p3) = (transform * p1, transform * p2, transform * p3);
                chords(Curve::cubic(last, p1, p2, p3), &[last, p1, p2, p3], tolerance, edges);
                last = p3;
            }
            PathEl::ClosePath => {
                edges.close();
                last = start;
            }
        }
    }
    edges.close();
}

/// The chords of one curve, whose control polygon is `hull`.
fn chords(curve: Curve, hull: &[Point], tolerance: f64, edges: &mut EdgeList) {
    let last = hull[hull.len() - 1];
    if edges.sees_no_curve(hull) {
        edges.line_to(last);
        return;
    }
    // Always flattened from the same end, so that neighbours get the same vertices.
    let reversed = hull.iter().map(|p| (p.y, p.x)).gt(hull.iter().rev().map(|p| (p.y, p.x)));
    let curve = if reversed { Curve::from_hull(hull.iter().rev().copied()) } else { curve };
    let chords = curve.chords(tolerance);
    let h = 1.0 / chords;
    let chords = chords as usize;
    for i in 1..chords {
        let i = if reversed { chords - i } else { i };
        // The slivers beside the ends have no second vertex to share them.
        let ends = usize::from(i == 1) + usize::from(i + 1 == chords);
        let share = 1.0 + 0.5 * ends as f64;
        edges.line_to(curve.outer_point(i as f64 * h, share * h * h / 12.0));
    }
    edges.line_to(last);
}

/// How many chords keep a border within `tolerance` of a curve, and the area it covers of any pixel
/// within [`AREA_SHARE`] of that. `length` is no less than the curve's and `sagitta` no less than its
/// distance from one chord; both grow evenly along it.
///
/// With n chords, a vertex is moved by up to d = sagitta / n^2, and a chord is up to L = length / n
/// long. On the moved polygon's outer side lies .19 L d beside each vertex, and as much on its inner
/// side beside each chord; a pixel sees no more of it than 1.4 d.
pub(crate) fn chord_count(length: f64, sagitta: f64, tolerance: f64) -> f64 {
    let by_distance = (sagitta / tolerance).sqrt();
    let area = AREA_SHARE * tolerance;
    let by_lobe = libm::cbrt(0.192 * length * sagitta / area);
    let by_pixel = (1.414 * sagitta / area).sqrt();
    by_distance.max(by_lobe.min(by_pixel)).ceil().clamp(1.0, MOST_CHORDS)
}

/// A cubic in powers of t: `((a t + b) t + c) t + d`.
pub(crate) struct Curve {
    a: Vec2,
    b: Vec2,
    c: Vec2,
    d: Vec2,
}

impl Curve {
    fn quadratic(p0: Point, p1: Point, p2: Point) -> Curve {
        let (p0, p1, p2) = (p0.to_vec2(), p1.to_vec2(), p2.to_vec2());
        Curve { a: Vec2::ZERO, b: p0 - 2.0 * p1 + p2, c: 2.0 * (p1 - p0), d: p0 }
    }

    pub fn cubic(p0: Point, p1: Point, p2: Point, p3: Point) -> Curve {
        let (p0, p1, p2, p3) = (p0.to_vec2(), p1.to_vec2(), p2.to_vec2(), p3.to_vec2());
        Curve { a: p3 - p0 + 3.0 * (p1 - p2), b: 3.0 * (p0 - 2.0 * p1 + p2), c: 3.0 * (p1 - p0), d: p0 }
    }

    /// Three control points or four.
    fn from_hull(mut hull: impl Iterator<Item = Point>) -> Curve {
        let mut next = || hull.next();
        match (next(), next(), next(), next()) {
            (Some(p0), Some(p1), Some(p2), Some(p3)) => Curve::cubic(p0, p1, p2, p3),
            (Some(p0), Some(p1), Some(p2), None) => Curve::quadratic(p0, p1, p2),
            _ => unreachable!("a curve has three or four control points"),
        }
    }

    /// The second derivative is linear: it is largest at an end.
    fn largest_second_derivative(&self) -> f64 {
        let at_start = 2.0 * self.b;
        let at_end = 6.0 * self.a + 2.0 * self.b;
        at_start.hypot2().max(at_end.hypot2()).sqrt()
    }

    /// As [`chord_count`].
    fn chords(&self, tolerance: f64) -> f64 {
        chord_count(self.largest_derivative(), 0.125 * self.largest_second_derivative(), tolerance)
    }

    /// No less than the first derivative anywhere.
    fn largest_derivative(&self) -> f64 {
        // The derivative's own control points.
        let (first, last) = (self.c, self.c + 2.0 * self.b + 3.0 * self.a);
        let middle = self.c + self.b;
        first.hypot2().max(middle.hypot2()).max(last.hypot2()).sqrt()
    }

    pub fn point(&self, t: f64) -> Point {
        (((self.a * t + self.b) * t + self.c) * t + self.d).to_point()
    }

    pub fn derivative(&self, t: f64) -> Vec2 {
        (3.0 * t * self.a + 2.0 * self.b) * t + self.c
    }

    pub fn second_derivative(&self, t: f64) -> Vec2 {
        6.0 * t * self.a + 2.0 * self.b
    }

    /// The point at `t`, moved against the second derivative by `outwards` times that.
    fn outer_point(&self, t: f64, outwards: f64) -> Point {
        self.point(t) - outwards * self.second_derivative(t)
    }
}

/// The path's elements in double precision.
fn elements(path: &usvg::tiny_skia_path::Path) -> impl Iterator<Item = PathEl> + '_ {
    let point = |p: usvg::tiny_skia_path::Point| Point::new(p.x.into(), p.y.into());
    path.segments().map(move |segment| match segment {
        PathSegment::MoveTo(p) => PathEl::MoveTo(point(p)),
        PathSegment::LineTo(p) => PathEl::LineTo(point(p)),
        PathSegment::QuadTo(p1, p2) => PathEl::QuadTo(point(p1), point(p2)),
        PathSegment::CubicTo(p1, p2, p3) => PathEl::CurveTo(point(p1), point(p2), point(p3)),
        PathSegment::Close => PathEl::ClosePath,
    })
}

/// How much longer the transform makes a vector at most (its larger singular value).
pub(crate) fn largest_scale(transform: Affine) -> f64 {
    let [a, b, c, d, _, _] = transform.as_coeffs();
    let (x, y) = (a * a + b * b, c * c + d * d);
    let mixed = a * c + b * d;
    let spread = ((x - y) * (x - y) + 4.0 * mixed * mixed).sqrt();
    (0.5 * (x + y + spread)).sqrt()
}
