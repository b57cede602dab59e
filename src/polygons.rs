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

/// Parts of a curve that are looked at alone.
const SPANS: usize = 4;

/// The area that a pixel may be off by, as a share of the tolerance times a pixel's side.
const AREA_SHARE: f64 = 0.05;

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

/// The chords of one curve, whose control polygon is `hull`. `stops` is scratch.
fn chords(curve: Curve, hull: &[Point], tolerance: f64, stops: &mut Vec<f64>, edges: &mut EdgeList) {
    let last = hull[hull.len() - 1];
    if edges.sees_no_curve(hull) {
        edges.line_to(last);
        return;
    }
    // Always flattened from the same end, so that neighbours get the same vertices.
    let reversed = hull.iter().map(|p| (p.y, p.x)).gt(hull.iter().rev().map(|p| (p.y, p.x)));
    let curve = if reversed { Curve::from_hull(hull.iter().rev().copied()) } else { curve };
    curve.stops(tolerance, stops);
    let inner = stops.len() - 2;
    for i in 1..=inner {
        let i = if reversed { inner + 1 - i } else { i };
        let [before, t, after] = [stops[i - 1], stops[i], stops[i + 1]];
        let (h0, h1) = (t - before, after - t);
        // (h0^3 + h1^3) / (h0 + h1)
        let mut slivers = h0 * h0 - h0 * h1 + h1 * h1;
        if i == 1 || i == inner {
            // The slivers beside the ends have no second vertex to share them.
            let (first, last) = (f64::from(i == 1), f64::from(i == inner));
            slivers += (first * h0 * h0 * h0 + last * h1 * h1 * h1) / (h0 + h1);
        }
        edges.line_to(curve.outer_point(t, slivers * (1.0 / 12.0)));
    }
    edges.line_to(last);
}

/// How many chords keep a border within `tolerance` of a curve, and the area it covers of any pixel
/// within [`AREA_SHARE`] of that. `length` is no less than the curve's and `sagitta` no less than its
/// distance from one chord; both grow evenly along it.
pub(crate) fn chord_count(length: f64, sagitta: f64, tolerance: f64) -> f64 {
    chords_needed(sagitta, length * sagitta, tolerance).ceil().clamp(1.0, MOST_CHORDS)
}

/// As [`chord_count`], not rounded: `lobe` is length times sagitta.
///
/// With n chords, a vertex is moved by up to d = sagitta / n^2, and a chord is up to L = length / n
/// long. On the moved polygon's outer side lies .19 L d beside each vertex, and as much on its inner
/// side beside each chord; a pixel sees no more of it than 1.4 d.
#[inline]
fn chords_needed(sagitta: f64, lobe: f64, tolerance: f64) -> f64 {
    let by_distance = (sagitta / tolerance).sqrt();
    let area = AREA_SHARE * tolerance;
    let by_lobe = cube_root(0.192 * lobe / area);
    let by_pixel = (1.414 * sagitta / area).sqrt();
    by_distance.max(by_lobe.min(by_pixel))
}

/// Within .2% above the cube root of a number that is not negative, by the bits of its exponent and one
/// step of Newton's.
#[inline]
fn cube_root(v: f64) -> f64 {
    /// Brings the exponent's bias back to its place, and the error of the straight line through
    /// the mantissa to where it is least.
    const THIRD: u64 = 0x2a9f_7893_782d_a1ce;
    let guess = f64::from_bits(v.to_bits() / 3 + THIRD);
    (2.0 * guess + v / (guess * guess)) / 3.0
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

    /// Puts into `stops` the parameters of the chords' ends, 0 and 1 among them: denser where the curve
    /// turns more, so that no chord is better than it needs to be.
    fn stops(&self, tolerance: f64, stops: &mut Vec<f64>) {
        const SPAN: f64 = 1.0 / SPANS as f64;
        let twist = Twist::of(self);
        // Chords up to the end of each span.
        let mut needed = [0.0; SPANS + 1];
        let mut bend = self.second_derivative(0.0).hypot();
        for span in 0..SPANS {
            let (from, to) = (span as f64 * SPAN, (span + 1) as f64 * SPAN);
            // The second derivative is linear: it is largest at an end.
            let next_bend = self.second_derivative(to).hypot();
            let sagitta = 0.125 * bend.max(next_bend);
            let lobe = 0.125 * twist.most(from, to);
            needed[span + 1] = needed[span] + SPAN * chords_needed(sagitta, lobe, tolerance);
            bend = next_bend;
        }
        let count = needed[SPANS].ceil().clamp(1.0, MOST_CHORDS);
        let step = needed[SPANS] / count;
        stops.clear();
        stops.push(0.0);
        let (mut span, mut t_per_chord) = (0, SPAN / (needed[1] - needed[0]));
        for i in 1..count as usize {
            let wanted = i as f64 * step;
            while wanted > needed[span + 1] {
                span += 1;
                t_per_chord = SPAN / (needed[span + 1] - needed[span]);
            }
            stops.push(span as f64 * SPAN + (wanted - needed[span]) * t_per_chord);
        }
        stops.push(1.0);
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

/// The cross product of a cubic's first two derivatives, `(a t + b) t + c`: a chord over a step h of t has
/// a sliver of h^3 / 12 times that beside it, however fast t runs along the curve.
struct Twist {
    a: f64,
    b: f64,
    c: f64,
}

impl Twist {
    fn of(curve: &Curve) -> Twist {
        Twist {
            a: 6.0 * curve.b.cross(curve.a),
            b: 6.0 * curve.c.cross(curve.a),
            c: 2.0 * curve.c.cross(curve.b),
        }
    }

    /// The largest size on [from, to].
    #[inline]
    fn most(&self, from: f64, to: f64) -> f64 {
        let at = |t: f64| ((self.a * t + self.b) * t + self.c).abs();
        let top = -0.5 * self.b / self.a;
        let top = if from < top && top < to { at(top) } else { 0.0 };
        at(from).max(at(to)).max(top)
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
