//! Takes a shape's [`Geometry`] and the transform to pixels, makes flat polygons: strokes become
//! outlines, curves become chords, each handed to an [`EdgeList`].
//!
//! Promises: a curve walked either way gives the same vertices bit for bit, and the polygon has the
//! curve's area ([`crate::chords`]).

use crate::chords::{chords, Curve};
use crate::edges::EdgeList;
use crate::pen::Pen;
use crate::scene::{Geometry, Outline};
use kurbo::{Affine, PathEl, Point, Rect, Shape};
use usvg::tiny_skia_path::PathSegment;

/// Flattens shapes; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Flattener {
    pen: Pen,
    stops: Vec<f64>,
}

impl Flattener {
    /// Adds the edges of `geometry` to `edges`. `tolerance` is a distance in pixels.
    pub fn flatten(&mut self, geometry: &Geometry, to_pixels: Affine, tolerance: f64, edges: &mut EdgeList) {
        let transform = to_pixels * geometry.transform;
        match &geometry.outline {
            Outline::Fill(_) => {
                polygons(elements(&geometry.path), transform, tolerance, &mut self.stops, edges);
            }
            Outline::Pixels => {
                let b = geometry.path.bounds();
                let own = Rect::new(b.left().into(), b.top().into(), b.right().into(), b.bottom().into());
                let pixels = transform.transform_rect_bbox(own).expand();
                let border = pixels.path_elements(tolerance);
                polygons(border, Affine::IDENTITY, tolerance, &mut self.stops, edges);
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
fn polygons(
    path: impl Iterator<Item = PathEl>,
    transform: Affine,
    tolerance: f64,
    stops: &mut Vec<f64>,
    edges: &mut EdgeList,
) {
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
                chords(Curve::quadratic(last, p1, p2), &[last, p1, p2], tolerance, stops, edges);
                last = p2;
            }
            PathEl::CurveTo(p1, p2, p3) => {
                let (p1, p2, p3) = (transform * p1, transform * p2, transform * p3);
                chords(Curve::cubic(last, p1, p2, p3), &[last, p1, p2, p3], tolerance, stops, edges);
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
