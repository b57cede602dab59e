//! Takes a gradient's stops and spread, makes the mean of its colours over a polygon.
//!
//! A gradient is a pattern function and a colour map. Where the map turns or jumps within what one
//! pixel sees of the parameter, the colour at the pixel's middle is wrong however exact the pixel's
//! areas are: Worley's *index aliasing* (Texturing & Modeling, ch. 5). His cure is a table of the map's
//! integral, so that the mean over a stretch of the parameter is a difference of two of its values. Over a
//! polygon, on which the parameter t is linear, it takes the integral's integral: with G'' = F' = f and s along
//! the gradient's lines of one colour, Green's theorem makes ∬ f dt ds the sum of ∫ F ds over the sides, and
//! on a side, where s is linear in t, that is a difference of G. It is exact, hard stops and all, and costs the
//! same for a part of one stop as for a thousand repeats.
//!
//! Rows of many pixels in each of which the map turns have these means from tables of them, one for each of some
//! ways in which the parameter changes in a pixel ([`super::gradient_shader`]).
//!
//! Of a map that repeats the integrals are those of its difference from its mean, which repeat too: nothing
//! grows with the number of repeats, and no digits are lost to it.

use super::paint::{Spread, Stop};
use kurbo::Vec2;

/// A component for each of premultiplied red, green, blue and alpha.
type Sum = [f64; 4];

/// Of colours over an area, whose sign is the way round the polygon.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Integral {
    pub sum: Sum,
    pub area: f64,
}

impl Integral {
    pub fn add(&mut self, other: Integral) {
        (0..4).for_each(|i| self.sum[i] += other.sum[i]);
        self.area += other.area;
    }

    /// Premultiplied red, green, blue and alpha; `None` without an area.
    pub fn mean(self) -> Option<[f32; 4]> {
        let is_flat = self.area.abs() < 1e-12 || !self.area.is_finite();
        (!is_flat).then(|| self.sum.map(|v| (v / self.area).clamp(0.0, 1.0) as f32))
    }
}

/// Integrals of a colour map.
#[derive(Clone, Debug)]
pub(crate) struct ColorMap {
    /// Where each part begins. The first goes on before, the last beyond.
    starts: Vec<f64>,
    /// G on each part, as coefficients of the powers of the way from its start: where straight colours go
    /// straight, premultiplied ones go as a square, and G as its second integral.
    parts: Vec<[Sum; 5]>,
    /// G's own integral where each part begins.
    thirds: Vec<Sum>,
    /// How often it repeats in a unit of the parameter: 1, 1/2, or 0 if it does not; and its mean, which the
    /// integrals of one that does are without.
    frequency: f64,
    mean: Sum,
    /// Is any of the last coefficients other than 0?
    fades: bool,
}

/// Along one side of a square the parameter is taken to change by no less than this share of its change along the
/// other: no more than an eighth of this share of the square is then on the wrong side of an edge.
const NARROW: f64 = 3e-4;

impl ColorMap {
    /// `stops` are not empty.
    pub fn new(stops: &[Stop], spread: Spread) -> ColorMap {
        let mut places: Vec<(f64, Sum)> =
            stops.iter().map(|stop| (f64::from(stop.offset), stop.color.map(f64::from))).collect();
        let frequency = match spread {
            Spread::Pad => 0.0,
            Spread::Repeat => 1.0,
            Spread::Reflect => {
                let back: Vec<_> = places.iter().rev().map(|&(t, color)| (2.0 - t, color)).collect();
                places.extend(back);
                0.5
            }
        };
        let (first, last) = (places[0], places[places.len() - 1]);
        let ends = if frequency > 0.0 { (0.0, 1.0 / frequency) } else { (first.0 - 1.0, last.0 + 1.0) };
        places.insert(0, (ends.0, first.1));
        places.push((ends.1, last.1));
        let lines = places.windows(2).filter(|pair| pair[0].0 < pair[1].0);
        let lines: Vec<_> =
            lines.map(|pair| (pair[0].0, pair[1].0, straight_line(pair[0], pair[1]))).collect();
        let mut map = ColorMap {
            starts: Vec::new(),
            parts: Vec::new(),
            thirds: Vec::new(),
            frequency,
            mean: [0.0; 4],
            fades: false,
        };
        const ZERO: Sum = [0.0; 4];
        if frequency > 0.0 {
            // Integrated from 0 on, without the mean F ends as 0, with F's own mean taken away so does G, and
            // with G's its integral.
            let mean = |sum: Sum| sum.map(|v| v * frequency);
            let [sum, ..] = map.integrate(&lines, [ZERO; 3]);
            map.mean = mean(sum);
            let [_, second, _] = map.integrate(&lines, [ZERO; 3]);
            let first = mean(second).map(|v| -v);
            let [.., third] = map.integrate(&lines, [first, ZERO, ZERO]);
            map.integrate(&lines, [first, mean(third).map(|v| -v), ZERO]);
        } else {
            map.integrate(&lines, [ZERO; 3]);
        }
        map
    }

    /// Makes the parts, with F, G and G's integral beginning as `before`; returns these at the end.
    fn integrate(&mut self, lines: &[(f64, f64, [Sum; 3])], mut before: [Sum; 3]) -> [Sum; 3] {
        (self.starts, self.parts) = (Vec::with_capacity(lines.len()), Vec::with_capacity(lines.len()));
        self.thirds = Vec::with_capacity(lines.len());
        for &(from, to, [c0, c1, c2]) in lines {
            let [first, second, third] = before;
            let c0: Sum = std::array::from_fn(|i| c0[i] - self.mean[i]);
            let part = [second, first, c0.map(|c| c / 2.0), c1.map(|c| c / 6.0), c2.map(|c| c / 12.0)];
            let length = to - from;
            before = [slope(&part, length), value(&part, length), area(third, &part, length)];
            self.fades |= c2 != [0.0; 4];
            self.starts.push(from);
            self.parts.push(part);
            self.thirds.push(third);
        }
        before
    }

    /// Bytes of one with this many stops, at most.
    pub fn bytes(stops: usize) -> u64 {
        let part = std::mem::size_of::<[Sum; 6]>() + std::mem::size_of::<f64>();
        (std::mem::size_of::<ColorMap>() + (2 * stops + 1) * part) as u64
    }

    /// The integral over a polygon whose corners are parameter, not spread yet, and place along the lines
    /// of one colour; areas are in the units of both.
    pub fn over(&self, corners: impl Iterator<Item = (f64, f64)> + Clone) -> Integral {
        let (least, most) =
            corners.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (t, _)| (a.min(t), b.max(t)));
        // Sides that go along a line of one colour, nearly.
        let along = 1e-6 * (most - least);
        let mut points = corners.map(|(t, s)| (t, s, self.second(self.reduced(t))));
        let Some(first) = points.next() else {
            return Integral::default();
        };
        let (mut made, mut last) = (Integral::default(), first);
        for point in points.chain([first]) {
            let ((t0, s0, one), (t1, s1, other)) = (last, point);
            let (dt, ds) = (t1 - t0, s1 - s0);
            if dt.abs() > along {
                (0..4).for_each(|i| made.sum[i] += ds * (other[i] - one[i]) / dt);
            } else {
                let first = self.first(self.reduced(0.5 * (t0 + t1)));
                (0..4).for_each(|i| made.sum[i] += ds * first[i]);
            }
            // From the least on, so that no digits are lost far out.
            made.area += ds * (0.5 * (t0 + t1) - least);
            last = point;
        }
        (0..4).for_each(|i| made.sum[i] += self.mean[i] * made.area);
        made
    }

    /// The mean, premultiplied, over a square around a parameter, which changes by so much along its two sides;
    /// `None` if it does not change. With a and b these changes, ∬ f over it is G at its corners, two of them taken
    /// from the other two, over a b.
    #[inline]
    pub fn over_square(&self, t: f64, along: (f64, f64)) -> Option<[f32; 4]> {
        let (a, b) = changes(along);
        if !(1e-12..1e12).contains(&a) {
            return None;
        }
        let (far, near) = (0.5 * (a + b), 0.5 * (a - b));
        let around = [t + far, t + near, t - near, t - far].map(|t| self.reduced(t));
        let [last, third, second, first] = around.map(|t| self.second(t));
        let inverse = 1.0 / (a * b);
        let mean = |i: usize| ((last[i] - third[i]) - (second[i] - first[i])) * inverse + self.mean[i];
        Some(std::array::from_fn(|i| (mean(i) as f32).clamp(0.0, 1.0)))
    }

    /// By how much the mean over a square of side 1 changes, premultiplied, with how much the parameter bends in
    /// it: with what is added to it in a place d from the middle, as a multiple of q = 12 (e·d)² - 1 for a unit
    /// vector e across `ray`, along which it grows and does not bend. That is the integral of f' q, the divergence
    /// of f q m with m = `ray` / (`ray`·`along`), and so a sum over the sides; on one, where q is a polynomial of
    /// the parameter, the integral of f q is that of F q - G q' + ∫G q'' at its ends.
    pub fn bend_of_square(&self, t: f64, along: Vec2, ray: Vec2) -> [f32; 4] {
        let least = NARROW * along.x.abs().max(along.y.abs());
        let along = Vec2::new(apart_from_0(along.x, least), apart_from_0(along.y, least));
        let across = Vec2::new(-ray.y, ray.x) / ray.hypot();
        let m = ray / ray.dot(along);
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| {
            let d = Vec2::new(x, y);
            (across.dot(d), self.integrals(self.reduced(t + along.dot(d))))
        });
        // Of one side, on which the parameter changes by `step` and (e·d) by `turn`.
        let side = |from: usize, to: usize, step: f64, turn: f64| -> Sum {
            let (slope, bend) = (24.0 * turn / step, 24.0 * (turn / step).powi(2));
            let end = |corner: usize, i: usize| {
                let (e, [f, g, third]) = &corners[corner];
                f[i] * (12.0 * e * e - 1.0) - g[i] * slope * e + third[i] * bend
            };
            std::array::from_fn(|i| (end(to, i) - end(from, i)) / step)
        };
        let [top, bottom] = [(0, 1), (3, 2)].map(|(from, to)| side(from, to, along.x, across.x));
        let [left, right] = [(0, 3), (1, 2)].map(|(from, to)| side(from, to, along.y, across.y));
        std::array::from_fn(|i| (m.x * (right[i] - left[i]) + m.y * (bottom[i] - top[i])) as f32)
    }

    /// How often it repeats in a unit of the parameter: 1, 1/2, or 0 if it does not.
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// A parameter without whole periods.
    #[inline]
    fn reduced(&self, t: f64) -> f64 {
        // Sums with it have no digits behind the point: quicker than rounding downwards.
        const ROUNDER: f64 = 6_755_399_441_055_744.0;
        if self.frequency == 0.0 {
            return t;
        }
        let periods = t * self.frequency;
        let rest = periods - ((periods + ROUNDER) - ROUNDER);
        let rest = rest + if rest < 0.0 { 1.0 } else { 0.0 };
        // Numbers too great to have digits behind the point leave anything.
        rest.min(1.0) * (1.0 / self.frequency)
    }

    /// F, G and G's integral at a reduced parameter.
    fn integrals(&self, t: f64) -> [Sum; 3] {
        let at = self.index(t);
        let (part, u) = (&self.parts[at], t - self.starts[at]);
        [slope(part, u), value(part, u), area(self.thirds[at], part, u)]
    }

    /// F at a reduced parameter.
    #[inline]
    fn first(&self, t: f64) -> Sum {
        let (part, u) = self.part(t);
        slope(part, u)
    }

    /// G at a reduced parameter.
    #[inline]
    fn second(&self, t: f64) -> Sum {
        let (part, u) = self.part(t);
        if self.fades {
            return value(part, u);
        }
        let [c0, c1, c2, c3, _] = part;
        std::array::from_fn(|i| c0[i] + u * (c1[i] + u * (c2[i] + u * c3[i])))
    }

    /// The part of a reduced parameter, and the way from its start.
    #[inline]
    fn part(&self, t: f64) -> (&[Sum; 5], f64) {
        let part = self.index(t);
        (&self.parts[part], t - self.starts[part])
    }

    #[inline]
    fn index(&self, t: f64) -> usize {
        self.starts[1..].partition_point(|&start| start <= t)
    }
}

/// A polynomial.
#[inline]
fn value(c: &[Sum; 5], u: f64) -> Sum {
    std::array::from_fn(|i| c[0][i] + u * (c[1][i] + u * (c[2][i] + u * (c[3][i] + u * c[4][i]))))
}

/// Its derivative.
#[inline]
fn slope(c: &[Sum; 5], u: f64) -> Sum {
    std::array::from_fn(|i| c[1][i] + u * (2.0 * c[2][i] + u * (3.0 * c[3][i] + u * 4.0 * c[4][i])))
}

/// Its integral, from what that is at 0.
fn area(at_0: Sum, c: &[Sum; 5], u: f64) -> Sum {
    let powers = |i: usize| {
        c[0][i] + u * (c[1][i] / 2.0 + u * (c[2][i] / 3.0 + u * (c[3][i] / 4.0 + u * c[4][i] / 5.0)))
    };
    std::array::from_fn(|i| at_0[i] + u * powers(i))
}

/// The greater and the lesser of the changes of a parameter along a square's sides, the lesser as it is taken to be.
#[inline]
pub(super) fn changes((x, y): (f64, f64)) -> (f64, f64) {
    let (x, y) = (x.abs(), y.abs());
    let (a, b) = if x > y { (x, y) } else { (y, x) };
    (a, if b > NARROW * a { b } else { NARROW * a })
}

fn apart_from_0(v: f64, least: f64) -> f64 {
    if v < 0.0 {
        v.min(-least)
    } else {
        v.max(least)
    }
}

/// From one place to the next: the coefficients of premultiplied colour.
fn straight_line((start, from): (f64, Sum), (end, to): (f64, Sum)) -> [Sum; 3] {
    let slope = |i: usize| (to[i] - from[i]) / (end - start);
    let (alpha, fade) = (from[3], slope(3));
    let product = |i: usize| match i {
        3 => [alpha, fade, 0.0],
        _ => [from[i] * alpha, from[i] * fade + slope(i) * alpha, slope(i) * fade],
    };
    std::array::from_fn(|power| std::array::from_fn(|i| product(i)[power]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(offset: f32, gray: f32, alpha: f32) -> Stop {
        Stop { offset, color: [gray, gray, gray, alpha] }
    }

    /// Black for .3 of the way, then a jump to white, which fades out.
    fn map(spread: Spread) -> ColorMap {
        ColorMap::new(
            &[stop(0.0, 0.0, 1.0), stop(0.3, 0.0, 1.0), stop(0.3, 1.0, 1.0), stop(1.0, 1.0, 0.0)],
            spread,
        )
    }

    /// Over a rectangle.
    fn mean(map: &ColorMap, from: f64, to: f64) -> [f32; 4] {
        let corners = [(from, 0.0), (to, 0.0), (to, 1.0), (from, 1.0)];
        map.over(corners.into_iter()).mean().expect("it has area")
    }

    fn assert_near(found: [f32; 4], gray: f32, alpha: f32) {
        assert!(
            (found[0] - gray).abs() < 1e-5 && (found[3] - alpha).abs() < 1e-5,
            "{found:?}: {gray}, {alpha}"
        );
    }

    #[test]
    fn a_jump_gives_its_two_sides_by_their_lengths() {
        assert_near(mean(&map(Spread::Pad), 0.2, 0.30001), 0.0001, 1.0);
        let ends = ColorMap::new(&[stop(0.5, 0.0, 1.0), stop(0.5, 1.0, 1.0)], Spread::Pad);
        assert_near(mean(&ends, 0.4, 0.6), 0.5, 1.0);
        assert_near(mean(&ends, -3.0, 4.0), 0.5, 1.0);
    }

    #[test]
    fn a_whole_period_is_the_map_s_mean_however_many_there_are() {
        // White: .7 long, half of it gone.
        let (gray, alpha) = (0.35, 0.3 + 0.35);
        for periods in [1.0, 2.0, 1000.0] {
            assert_near(mean(&map(Spread::Repeat), 0.17, 0.17 + periods), gray, alpha);
            assert_near(mean(&map(Spread::Reflect), -0.4, -0.4 + 2.0 * periods), gray, alpha);
        }
    }

    #[test]
    fn the_mean_is_that_of_many_points() {
        for spread in [Spread::Pad, Spread::Repeat, Spread::Reflect] {
            let map = map(spread);
            let (from, to) = (-1.37, 2.21);
            let count = 20_000;
            let points = (0..count).map(|i| from + (to - from) * (i as f64 + 0.5) / count as f64);
            let sum: f64 = points.map(|t| f64::from(mean(&map, t - 1e-4, t + 1e-4)[0])).sum();
            assert!((mean(&map, from, to)[0] - (sum / count as f64) as f32).abs() < 1e-3, "{spread:?}");
        }
    }

    #[test]
    fn the_ends_go_on_where_the_first_and_the_last_stop_are_at_the_ends() {
        let map = ColorMap::new(&[stop(0.0, 0.2, 1.0), stop(1.0, 0.8, 1.0)], Spread::Pad);
        assert_near(mean(&map, -3.0, 0.0), 0.2, 1.0);
        assert_near(mean(&map, 1.0, 5.0), 0.8, 1.0);
        assert_near(mean(&map, -1.0, 2.0), 0.5, 1.0);
    }

    #[test]
    fn a_square_has_the_mean_of_its_polygon() {
        for spread in [Spread::Pad, Spread::Repeat, Spread::Reflect] {
            let map = map(spread);
            for (t, along) in
                [(0.37, (0.2, 0.15)), (1.4, (-0.9, 2.2)), (-0.6, (0.5, 0.0)), (31.3, (0.0, -9.7))]
            {
                let corner = |x: f64, y: f64| {
                    let square = along.0 * along.0 + along.1 * along.1;
                    (t + along.0 * x + along.1 * y, (along.0 * y - along.1 * x) / square)
                };
                let corners = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
                let polygon = map.over(corners.into_iter()).mean().expect("it has area");
                let square = map.over_square(t, along).expect("it changes");
                let off = |i: usize| (square[i] - polygon[i]).abs();
                assert!((0..4).all(|i| off(i) < 1e-4), "{spread:?}, {t}: {square:?}, {polygon:?}");
            }
        }
    }

    #[test]
    fn a_triangle_weighs_the_colours_by_its_width() {
        // Width falls from 1 at 0 to 0 at 1: of the area, .51 lies before .3.
        for corners in [[(0.0, 0.0), (0.0, 1.0), (1.0, 0.3)], [(1.0, 0.3), (0.0, 0.0), (0.0, 1.0)]] {
            let stops = [stop(0.3, 1.0, 1.0), stop(0.3, 0.0, 1.0)];
            let mean =
                ColorMap::new(&stops, Spread::Pad).over(corners.into_iter()).mean().expect("it has area");
            assert_near(mean, 0.51, 1.0);
        }
    }

    #[test]
    fn a_polygon_far_out_is_as_exact_as_one_near_0() {
        for spread in [Spread::Repeat, Spread::Reflect] {
            let corners = |far: f64| [(far + 0.2, 0.0), (far + 0.34, 0.7), (far + 0.31, 1.0)].into_iter();
            let map = map(spread);
            let mean = |far: f64| map.over(corners(far)).mean().expect("it has area");
            let (near, far) = (mean(0.0), mean(1e6));
            assert_near(far, near[0], near[3]);
        }
    }

    #[test]
    fn a_polygon_without_area_has_no_mean() {
        let corners = [(0.2, 0.0), (0.3, 0.0), (0.4, 0.0)];
        assert_eq!(map(Spread::Pad).over(corners.into_iter()).mean(), None);
    }
}
