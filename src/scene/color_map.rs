//! Takes a gradient's stops and spread, makes the mean of its colours over a polygon.
//!
//! A gradient is a pattern function and a colour map. Where the map turns or jumps within what one
//! pixel sees of the parameter, the colour at the pixel's middle is wrong however exact the pixel's
//! areas are: Worley's *index aliasing* (Texturing & Modeling, ch. 5). His cure is a table of the map's
//! integral, so that the mean over a stretch of the parameter is a difference of two of its values. Over a
//! polygon, on which the parameter t is linear, it takes the integral's integral: with F' = f and s along
//! the gradient's lines of one colour, Green's theorem makes ∬ f dt ds the sum of ∫ F ds over the sides, and
//! on a side, where s is linear in t, that is a difference of the second integral. It is exact, hard stops
//! and all, and costs the same for a part of one stop as for a thousand repeats.

use super::paint::{Spread, Stop};

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
    /// From 0 to 1, without gaps; the first begins at 0.
    parts: Vec<Part>,
    /// Before 0, and beyond 1.
    ends: [Sum; 2],
    spread: Spread,
    /// The integral, and its integral, from 0 to 1.
    whole: (Sum, Sum),
}

/// Where straight colours go straight, premultiplied ones go as a square.
#[derive(Clone, Copy, Debug)]
struct Part {
    from: f64,
    /// Colour at `from` and its change with the parameter; times alpha makes three coefficients.
    coefficients: [Sum; 3],
    /// The integral, and its integral, from 0 to `from`.
    before: (Sum, Sum),
}

impl Part {
    /// The integral, and its integral, from 0 to a parameter in this part.
    fn integrals(&self, t: f64) -> (Sum, Sum) {
        let u = t - self.from;
        let [c0, c1, c2] = &self.coefficients;
        let (first, second) = &self.before;
        (
            std::array::from_fn(|i| first[i] + u * (c0[i] + u * (c1[i] / 2.0 + u * c2[i] / 3.0))),
            std::array::from_fn(|i| {
                second[i] + u * (first[i] + u * (c0[i] / 2.0 + u * (c1[i] / 6.0 + u * c2[i] / 12.0)))
            }),
        )
    }
}

impl ColorMap {
    /// `stops` are not empty.
    pub fn new(stops: &[Stop], spread: Spread) -> ColorMap {
        let (first, last) = (stops[0], stops[stops.len() - 1]);
        let mut map = ColorMap {
            parts: Vec::with_capacity(stops.len() + 1),
            ends: [first, last].map(|stop| straight_line(stop, stop)[0]),
            spread,
            whole: ([0.0; 4], [0.0; 4]),
        };
        map.push(0.0, f64::from(first.offset), straight_line(first, first));
        for pair in stops.windows(2) {
            map.push(pair[0].offset.into(), pair[1].offset.into(), straight_line(pair[0], pair[1]));
        }
        map.push(last.offset.into(), 1.0, straight_line(last, last));
        map
    }

    /// Bytes of one with this many stops, at most.
    pub fn bytes(stops: usize) -> u64 {
        (std::mem::size_of::<ColorMap>() + (stops + 1) * std::mem::size_of::<Part>()) as u64
    }

    fn push(&mut self, from: f64, to: f64, coefficients: [Sum; 3]) {
        if from < to {
            let part = Part { from, coefficients, before: self.whole };
            self.whole = part.integrals(to);
            self.parts.push(part);
        }
    }

    /// The integral over a polygon whose corners are parameter, not spread yet, and place along the lines
    /// of one colour; areas are in the units of both.
    pub fn over(&self, corners: impl Iterator<Item = (f64, f64)> + Clone) -> Integral {
        let (least, most) =
            corners.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (t, _)| (a.min(t), b.max(t)));
        // The nearer to 0 the more digits are left.
        let moved = match self.spread {
            Spread::Pad => 0.0,
            Spread::Repeat | Spread::Reflect => 2.0 * (0.25 * (least + most)).floor(),
        };
        // Sides that go along a line of one colour, nearly.
        let along = 1e-6 * (most - least);
        let mut points = corners.map(|(t, s)| (t - moved, s, self.integrals(t - moved)));
        let Some(first) = points.next() else {
            return Integral::default();
        };
        let (mut made, mut last) = (Integral::default(), first);
        for point in points.chain([first]) {
            let ((t0, s0, one), (t1, s1, other)) = (last, point);
            let (dt, ds) = (t1 - t0, s1 - s0);
            for i in 0..4 {
                let mean = if dt.abs() > along {
                    (other.1[i] - one.1[i]) / dt
                } else {
                    0.5 * (one.0[i] + other.0[i])
                };
                made.sum[i] += ds * mean;
            }
            made.area += ds * 0.5 * (t0 + t1);
            last = point;
        }
        made
    }

    /// The integral, and its integral, from 0 to a parameter, over the map as it is spread.
    fn integrals(&self, t: f64) -> (Sum, Sum) {
        let (one, two) = self.whole;
        match self.spread {
            Spread::Pad => {
                let (end, beyond) =
                    if t < 0.0 { (self.ends[0], t) } else { (self.ends[1], (t - 1.0).max(0.0)) };
                let (first, second) = self.within(t.clamp(0.0, 1.0));
                let more = |i: usize| second[i] + beyond * (first[i] + beyond * end[i] / 2.0);
                (std::array::from_fn(|i| first[i] + beyond * end[i]), std::array::from_fn(more))
            }
            Spread::Repeat => {
                let periods = t.floor();
                periodic(periods, 1.0, t - periods, self.within(t - periods), (one, two))
            }
            Spread::Reflect => {
                let periods = (0.5 * t).floor();
                let part = t - 2.0 * periods;
                let there_and_back = one.map(|v| 2.0 * v);
                let within = match part <= 1.0 {
                    true => self.within(part),
                    false => {
                        // What is left of the way back is not walked yet.
                        let (first, second) = self.within(2.0 - part);
                        (
                            std::array::from_fn(|i| 2.0 * one[i] - first[i]),
                            std::array::from_fn(|i| 2.0 * one[i] * (part - 1.0) + second[i]),
                        )
                    }
                };
                periodic(periods, 2.0, part, within, (there_and_back, there_and_back))
            }
        }
    }

    /// From 0 to a parameter of 0 ..= 1.
    fn within(&self, t: f64) -> (Sum, Sum) {
        let behind = self.parts.partition_point(|part| part.from <= t);
        self.parts[behind.max(1) - 1].integrals(t)
    }
}

/// Integrals from 0 on over whole periods of a length, and a part of one more.
fn periodic(count: f64, length: f64, part: f64, within: (Sum, Sum), whole: (Sum, Sum)) -> (Sum, Sum) {
    let pairs = 0.5 * count * (count - 1.0) * length;
    (
        std::array::from_fn(|i| count * whole.0[i] + within.0[i]),
        std::array::from_fn(|i| count * whole.1[i] + (pairs + count * part) * whole.0[i] + within.1[i]),
    )
}

/// From one stop to the next: the coefficients of premultiplied colour.
fn straight_line(a: Stop, b: Stop) -> [Sum; 3] {
    let (from, to) = (a.color.map(f64::from), b.color.map(f64::from));
    let length = f64::from(b.offset) - f64::from(a.offset);
    let slope = |i: usize| if length > 0.0 { (to[i] - from[i]) / length } else { 0.0 };
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
