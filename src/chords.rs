//! Takes a curve and a tolerance, makes the chords that stand for it: how many, where they end, and how
//! far out their vertices lie.
//!
//! A chord polygon through points of a curve lies on its inner side; each inner vertex is therefore moved
//! outwards by `-p'' h^2 / 12`, which gives back the two half slivers beside it. The first and the last
//! chord are shorter: beside them a vertex gives back a whole sliver.

use crate::edges::Lines;
use kurbo::{Point, Vec2};

/// A curve becomes at most this many chords, however large it is.
const MOST_CHORDS: f64 = 16384.0;

/// Parts of a curve that are looked at alone.
const SPANS: usize = 4;

/// About the area that a pixel may be off by along a curve, as a share of the tolerance times a pixel's side.
pub(crate) const AREA_SHARE: f64 = 0.07;

/// How much shorter a curve's first and last chord are than the others, as a share of one.
const ENDS_SHORTER: f64 = 0.19;

/// One chord, which has no vertex to give back its sliver, does for a curve that needs no more than this.
const ENOUGH_FOR_ONE: f64 = 0.57;

/// The chords of one curve, whose control polygon is `hull`. `stops` is scratch.
pub(crate) fn chords(
    curve: Curve,
    hull: &[Point],
    tolerance: f64,
    stops: &mut Vec<f64>,
    edges: &mut impl Lines,
) {
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
        let outwards = outwards((t - before, i == 1), (after - t, i == inner));
        edges.line_to(curve.outer_point(t, outwards));
    }
    edges.line_to(last);
}

/// How many chords keep a border within `tolerance` of a curve, and the area it covers of any pixel within
/// `area_share` of that. `length` is no less than the curve's and `sagitta` no less than its distance from one chord; both
/// grow evenly along it.
pub(crate) fn chord_count(length: f64, sagitta: f64, tolerance: f64, area_share: f64) -> f64 {
    whole_chords(chords_needed(sagitta, length * sagitta, tolerance, area_share))
}

/// Where chord number `i` of `count` ends, as a share of the curve; 0 < `i` < `count`.
#[inline]
pub(crate) fn chord_end(i: usize, count: f64) -> f64 {
    (i as f64 - ENDS_SHORTER) / (count - 2.0 * ENDS_SHORTER)
}

/// How far a vertex between two chords, each over a step of t, is moved against the second derivative, as a share of
/// that: it gives back half the slivers beside the chords, and all of one that is the curve's first or last and has no
/// other vertex.
#[inline]
pub(crate) fn outwards((h0, is_first): (f64, bool), (h1, is_last): (f64, bool)) -> f64 {
    // (h0^3 + h1^3) / (h0 + h1)
    let mut slivers = h0 * h0 - h0 * h1 + h1 * h1;
    if is_first || is_last {
        let (first, last) = (f64::from(is_first), f64::from(is_last));
        slivers += (first * h0 * h0 * h0 + last * h1 * h1 * h1) / (h0 + h1);
    }
    slivers * (1.0 / 12.0)
}

/// The number of chords, of which the first and the last are shorter, for what [`chords_needed`] gives.
#[inline]
fn whole_chords(needed: f64) -> f64 {
    match needed <= ENOUGH_FOR_ONE {
        true => 1.0,
        false => (needed + 2.0 * ENDS_SHORTER).ceil().clamp(2.0, MOST_CHORDS),
    }
}

/// One over the share of the curve that a chord between two others may span. `lobe` is length times sagitta.
///
/// A chord over a share h has the length L = h length and the distance d = h^2 sagitta from the curve. Its vertices are
/// moved outwards by 2/3 d. On the polygon's outer side lies .128 L d then around each vertex, and as much on its inner side
/// beside each chord; a pixel sees no more of it than 1.08 d. At the curve's ends a vertex gives back more: inside a first
/// chord as long as the others .281 L d would lie, of one that is shorter by [`ENDS_SHORTER`] .134, and .17 around its
/// vertex (.21 if that is the only one): near its ends a pixel may be off by 1.5 times its share. Of a single chord
/// 2/3 L d do: .577 cubed times that is .128.
#[inline]
fn chords_needed(sagitta: f64, lobe: f64, tolerance: f64, area_share: f64) -> f64 {
    let by_distance = (sagitta / tolerance).sqrt();
    let area = area_share * tolerance;
    let by_lobe = cube_root(0.128 * lobe / area);
    let by_pixel = (1.08 * sagitta / area).sqrt();
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
    pub fn quadratic(p0: Point, p1: Point, p2: Point) -> Curve {
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
            needed[span + 1] = needed[span] + SPAN * chords_needed(sagitta, lobe, tolerance, AREA_SHARE);
            bend = next_bend;
        }
        let count = whole_chords(needed[SPANS]);
        stops.clear();
        stops.push(0.0);
        let (mut span, mut t_per_chord) = (0, SPAN / (needed[1] - needed[0]));
        for i in 1..count as usize {
            let wanted = needed[SPANS] * chord_end(i, count);
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

    /// Where it begins to turn the other way, if it ends turning otherwise than it begins.
    pub fn inflection(&self) -> Option<f64> {
        let Twist { a, b, c } = Twist::of(self);
        if c * (a + b + c) >= 0.0 {
            return None;
        }
        // The roots, neither by a difference of what may be nearly the same.
        let q = -0.5 * (b + (b * b - 4.0 * a * c).max(0.0).sqrt().copysign(b));
        [q / a, c / q].into_iter().find(|&t| 0.0 < t && t < 1.0)
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

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 0.01;

    /// The points of an open polyline.
    #[derive(Default)]
    struct Points(Vec<Point>);

    impl Lines for Points {
        fn sees_no_curve(&self, _: &[Point]) -> bool {
            false
        }

        fn move_to(&mut self, p: Point) {
            self.0.push(p);
        }

        fn line_to(&mut self, p: Point) {
            self.0.push(p);
        }

        fn close(&mut self) {}
    }

    /// The chords of the parabola y = rise x^2 from -width to width.
    fn parabola(width: f64, rise: f64) -> Vec<Point> {
        let y = rise * width * width;
        let hull = [Point::new(-width, y), Point::new(0.0, -y), Point::new(width, y)];
        let mut points = Points(vec![hull[0]]);
        let [p0, p1, p2] = hull;
        chords(Curve::quadratic(p0, p1, p2), &hull, TOLERANCE, &mut Vec::new(), &mut points);
        points.0
    }

    /// The area between the chords and the parabola from its left end to each of many places.
    fn areas_beside(chords: &[Point], rise: f64) -> (f64, Vec<f64>) {
        const PLACES: usize = 2000;
        let (left, right) = (chords[0].x, chords[chords.len() - 1].x);
        let step = (right - left) / PLACES as f64;
        let mut area = 0.0;
        let areas = (0..PLACES).map(|i| {
            let x = left + (i as f64 + 0.5) * step;
            let next = chords.partition_point(|p| p.x <= x);
            let (a, b) = (chords[next - 1], chords[next]);
            let on_chord = a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
            area += step * (on_chord - rise * x * x);
            area
        });
        (step, std::iter::once(0.0).chain(areas).collect())
    }

    #[test]
    fn a_pixel_is_off_by_little_more_than_its_share_of_area() {
        let share = AREA_SHARE * TOLERANCE;
        let mut most = 0.0f64;
        for width in [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.0, 6.0, 12.0, 25.0, 100.0] {
            for slope in [0.01, 0.05, 0.2, 0.5, 1.0] {
                let rise = 0.5 * slope / width;
                let chords = parabola(width, rise);
                let (step, areas) = areas_beside(&chords, rise);
                // No stretch of it in a pixel is longer.
                let longest = (2f64.sqrt() / step) as usize;
                for from in 0..areas.len() {
                    let rest = &areas[from..areas.len().min(from.saturating_add(longest))];
                    let off = rest.iter().fold(0.0f64, |off, area| off.max((area - areas[from]).abs()));
                    let limit = if chords.len() == 3 { 1.7 } else { 1.5 };
                    assert!(off < limit * share, "width {width}, slope {slope}: {}", off / share);
                    most = most.max(off);
                }
                let whole = areas[areas.len() - 1];
                assert!(chords.len() == 2 || whole.abs() < 0.05 * share, "{}", whole / share);
            }
        }
        // And no finer than that asks for.
        assert!(most > 0.8 * share, "{}", most / share);
    }

    #[test]
    fn a_cubic_turns_the_other_way_at_its_inflection() {
        let p = |x: f64, y: f64| Point::new(x, y);
        let curve = Curve::cubic(p(0.0, 0.0), p(3.0, 5.0), p(4.0, -4.0), p(9.0, 1.0));
        let t = curve.inflection().expect("an S");
        let turn = |t: f64| curve.derivative(t).cross(curve.second_derivative(t));
        assert!(turn(t).abs() < 1e-9 && turn(t - 0.01) * turn(t + 0.01) < 0.0, "{t}");
        assert!(Curve::cubic(p(0.0, 0.0), p(1.0, 3.0), p(5.0, 3.0), p(6.0, 0.0)).inflection().is_none());
    }
}
