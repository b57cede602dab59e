//! Takes a shape's geometry, makes polygons in fixed point, cut to the picture: `beam`'s own flattening,
//! so that it is a witness for the edges that the other methods share.

use super::region::{Contour, Corner};
use crate::edges::{Lines, FRACTION_BITS, ONE};
use crate::pen::Pen;
use crate::polygons::largest_scale;
use crate::scene::{FillRule, Geometry, Outline};
use crate::Viewport;
use kurbo::{BezPath, PathEl, Point};
use usvg::tiny_skia_path::PathSegment;

/// How far a chord may lie from the curve, as a share of the tolerance: all of it lies on the curve's
/// inner side, which shows as area.
const CHORD_SHARE: f64 = 0.1;

/// Closed polygons, in pixels.
struct Rings(Vec<Vec<Point>>);

impl Lines for Rings {
    fn sees_no_curve(&self, _: &[Point]) -> bool {
        false
    }

    fn move_to(&mut self, p: Point) {
        self.0.push(vec![p]);
    }

    fn line_to(&mut self, p: Point) {
        match self.0.last_mut() {
            Some(ring) => ring.push(p),
            None => self.move_to(p),
        }
    }

    fn close(&mut self) {}
}

/// The closed polygons of an outline, as far as they lie in the picture. Shapes that are not to be
/// smoothed come as the pixels whose centres they hold, and are to be filled by either rule.
pub(super) fn contours(geometry: &Geometry, viewport: &Viewport, tolerance: f64) -> Vec<Contour> {
    let transform = viewport.transform * geometry.transform;
    let path = bez_path(&geometry.path);
    let mut rings = Rings(Vec::new());
    match &geometry.outline {
        Outline::Fill(_) | Outline::Pixels => {
            kurbo::flatten(transform * path, CHORD_SHARE * tolerance, |element| match element {
                PathEl::MoveTo(p) => rings.move_to(p),
                PathEl::LineTo(p) => rings.line_to(p),
                _ => {}
            });
        }
        Outline::Stroke(style) => {
            let scale = largest_scale(transform);
            if scale <= 0.0 || !scale.is_finite() {
                return Vec::new();
            }
            Pen::default().stroke(path.into_iter(), style, (transform, scale), tolerance, &mut rings);
        }
    }
    let Rings(mut rings) = rings;
    rings.retain(|ring| ring.iter().all(|p| p.is_finite()));
    let fixed = |v: f64| (v * f64::from(ONE)).round() as i32;
    let contours: Vec<Contour> = rings
        .into_iter()
        .map(|ring| cut_to_picture(ring, viewport))
        .map(|ring| ring.iter().map(|p| Corner::new(fixed(p.x), fixed(p.y))).collect())
        .filter(|contour: &Contour| contour.len() > 2)
        .collect();
    let rule = match geometry.outline {
        Outline::Fill(rule) => rule,
        Outline::Stroke(_) | Outline::Pixels => FillRule::NonZero,
    };
    if geometry.crisp {
        pixels(&contours, rule, viewport.height)
    } else {
        contours
    }
}

fn bez_path(path: &usvg::tiny_skia_path::Path) -> BezPath {
    let point = |p: usvg::tiny_skia_path::Point| Point::new(p.x.into(), p.y.into());
    path.segments()
        .map(|segment| match segment {
            PathSegment::MoveTo(p) => PathEl::MoveTo(point(p)),
            PathSegment::LineTo(p) => PathEl::LineTo(point(p)),
            PathSegment::QuadTo(p1, p2) => PathEl::QuadTo(point(p1), point(p2)),
            PathSegment::CubicTo(p1, p2, p3) => PathEl::CurveTo(point(p1), point(p2), point(p3)),
            PathSegment::Close => PathEl::ClosePath,
        })
        .collect()
}

/// Clips a closed polygon to the picture, side by side (Sutherland & Hodgman 1974). It keeps how often it
/// winds round what is inside.
fn cut_to_picture(ring: Vec<Point>, viewport: &Viewport) -> Vec<Point> {
    let (width, height) = (f64::from(viewport.width), f64::from(viewport.height));
    // How far inside each side a point lies.
    let sides: [&dyn Fn(Point) -> f64; 4] = [&|p| p.x, &|p| width - p.x, &|p| p.y, &|p| height - p.y];
    sides.into_iter().fold(ring, |ring, depth| {
        let mut cut = Vec::with_capacity(ring.len());
        let mut last = match ring.last() {
            Some(&last) => last,
            None => return ring,
        };
        for &p in &ring {
            let (a, b) = (depth(last), depth(p));
            if (a < 0.0) != (b < 0.0) {
                cut.push(last.lerp(p, a / (a - b)));
            }
            if b >= 0.0 {
                cut.push(p);
            }
            last = p;
        }
        cut
    })
}

/// The pixels whose centres polygons hold: a rectangle for each run of a row.
fn pixels(contours: &[Contour], rule: FillRule, height: u32) -> Vec<Contour> {
    let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); height as usize];
    for contour in contours {
        for (i, &b) in contour.iter().enumerate() {
            let a = contour[(i + contour.len() - 1) % contour.len()];
            let (upper, lower, winding) = if a.y < b.y { (a, b, 1) } else { (b, a, -1) };
            // Rows whose middle lies in [upper, lower).
            let row = |y: i32| (y + ONE / 2 - 1) >> FRACTION_BITS;
            for y in row(upper.y)..row(lower.y) {
                let middle = f64::from((y << FRACTION_BITS) + ONE / 2 - upper.y);
                let slope = f64::from(lower.x - upper.x) / f64::from(lower.y - upper.y);
                crossings[y as usize].push((f64::from(upper.x) + middle * slope, winding));
            }
        }
    }
    let mut rectangles = Vec::new();
    for (y, mut row) in crossings.into_iter().enumerate() {
        row.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // The first pixel whose centre lies on this border or right of it.
        let pixel = |x: f64| (x / f64::from(ONE) - 0.5).ceil() as i32;
        let (mut winding, mut from) = (0, None);
        for (x, crossed) in row {
            winding += crossed;
            match (from, rule.inside(winding)) {
                (None, true) => from = Some(pixel(x)),
                (Some(first), false) => {
                    from = None;
                    if first < pixel(x) {
                        rectangles.push(rectangle(first, pixel(x), y as i32));
                    }
                }
                _ => {}
            }
        }
    }
    rectangles
}

/// Pixels [from, to) of a row.
fn rectangle(from: i32, to: i32, y: i32) -> Contour {
    let [left, right, top, bottom] = [from, to, y, y + 1].map(|v| v << FRACTION_BITS);
    vec![
        Corner::new(left, top),
        Corner::new(right, top),
        Corner::new(right, bottom),
        Corner::new(left, bottom),
    ]
}
