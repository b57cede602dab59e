//! Takes a gradient's stops and spread, makes the mean of its colours over a stretch of the parameter.
//!
//! A gradient is a pattern function and a colour map. Where the map turns or jumps within what one
//! pixel sees of the parameter, the colour at the pixel's middle is wrong however exact the pixel's
//! areas are: Worley's *index aliasing* (Texturing & Modeling, ch. 5). His cure is a table of the map's
//! integral: the mean is a difference of two of its values, and costs the same for a part of one stop
//! as for a thousand repeats.

use super::paint::{Spread, Stop};

/// Integrals of a colour map: premultiplied red, green, blue and alpha.
#[derive(Clone, Debug)]
pub(crate) struct ColorMap {
    stops: Vec<Stop>,
    spread: Spread,
    /// The integral from 0 to each stop, and to 1 behind the last.
    sums: Vec<[f64; 4]>,
}

impl ColorMap {
    pub fn new(stops: &[Stop], spread: Spread) -> ColorMap {
        let mut map = ColorMap { stops: stops.to_vec(), spread, sums: Vec::with_capacity(stops.len() + 1) };
        let mut sum = [0.0; 4];
        let mut from = 0.0;
        for i in 0..=stops.len() {
            let to = stops.get(i).map_or(1.0, |stop| f64::from(stop.offset));
            add(&mut sum, map.between(i, from, to));
            map.sums.push(sum);
            from = to;
        }
        map
    }

    /// Premultiplied red, green, blue and alpha in the mean over parameters [from, to], not spread yet.
    pub fn mean(&self, from: f64, to: f64) -> [f32; 4] {
        let (start, end) = (self.integral(from), self.integral(to));
        std::array::from_fn(|i| ((end[i] - start[i]) / (to - from)) as f32)
    }

    /// From 0 to a parameter, over the map as it is spread.
    fn integral(&self, t: f64) -> [f64; 4] {
        let whole = self.sums[self.sums.len() - 1];
        let scaled = |sum: [f64; 4], by: f64| sum.map(|v| v * by);
        let mut sum;
        match self.spread {
            Spread::Pad => {
                sum = self.within(t.clamp(0.0, 1.0));
                let (first, last) = (self.stops[0], self.stops[self.stops.len() - 1]);
                let beyond = if t < 0.0 { (first, t) } else { (last, (t - 1.0).max(0.0)) };
                add(&mut sum, scaled(premultiplied(beyond.0.color), beyond.1));
            }
            Spread::Repeat => {
                sum = self.within(t - t.floor());
                add(&mut sum, scaled(whole, t.floor()));
            }
            Spread::Reflect => {
                let periods = (0.5 * t).floor();
                let part = t - 2.0 * periods;
                sum = self.within(part.min(1.0));
                if part > 1.0 {
                    // There and back: what is left of the way back is not walked yet.
                    add(&mut sum, whole);
                    add(&mut sum, scaled(self.within(2.0 - part), -1.0));
                }
                add(&mut sum, scaled(whole, 2.0 * periods));
            }
        }
        sum
    }

    /// From 0 to a parameter of 0 ..= 1.
    fn within(&self, t: f64) -> [f64; 4] {
        let behind = self.stops.partition_point(|stop| f64::from(stop.offset) <= t);
        let (mut sum, from) = match behind.checked_sub(1) {
            None => ([0.0; 4], 0.0),
            Some(stop) => (self.sums[stop], f64::from(self.stops[stop].offset)),
        };
        add(&mut sum, self.between(behind, from, t));
        sum
    }

    /// Over [from, to], which lies between stop `i - 1` and stop `i`.
    fn between(&self, i: usize, from: f64, to: f64) -> [f64; 4] {
        let at = |t: f64| {
            let (before, after) = (i.checked_sub(1).map(|i| self.stops[i]), self.stops.get(i).copied());
            let color = match (before, after) {
                (Some(a), Some(b)) if b.offset > a.offset => {
                    let share = (t - f64::from(a.offset)) / f64::from(b.offset - a.offset);
                    std::array::from_fn(|i| a.color[i] + (b.color[i] - a.color[i]) * share as f32)
                }
                (Some(stop), _) | (None, Some(stop)) => stop.color,
                (None, None) => [0.0; 4],
            };
            premultiplied(color)
        };
        if to <= from {
            return [0.0; 4];
        }
        // Colour times alpha is a square in t: Simpson's rule is exact.
        let (start, middle, end) = (at(from), at(0.5 * (from + to)), at(to));
        std::array::from_fn(|i| (to - from) / 6.0 * (start[i] + 4.0 * middle[i] + end[i]))
    }
}

fn premultiplied([r, g, b, a]: [f32; 4]) -> [f64; 4] {
    [r * a, g * a, b * a, a].map(f64::from)
}

fn add(sum: &mut [f64; 4], more: [f64; 4]) {
    sum.iter_mut().zip(more).for_each(|(sum, v)| *sum += v);
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

    fn assert_near(found: [f32; 4], gray: f32, alpha: f32) {
        assert!(
            (found[0] - gray).abs() < 1e-5 && (found[3] - alpha).abs() < 1e-5,
            "{found:?}: {gray}, {alpha}"
        );
    }

    #[test]
    fn a_jump_gives_its_two_sides_by_their_lengths() {
        assert_near(map(Spread::Pad).mean(0.2, 0.30001), 0.0001, 1.0);
        let ends = ColorMap::new(&[stop(0.5, 0.0, 1.0), stop(0.5, 1.0, 1.0)], Spread::Pad);
        assert_near(ends.mean(0.4, 0.6), 0.5, 1.0);
        assert_near(ends.mean(-3.0, 4.0), 0.5, 1.0);
    }

    #[test]
    fn a_whole_period_is_the_map_s_mean_however_many_there_are() {
        // White: .7 long, half of it gone.
        let (gray, alpha) = (0.35, 0.3 + 0.35);
        for periods in [1.0, 2.0, 1000.0] {
            assert_near(map(Spread::Repeat).mean(0.17, 0.17 + periods), gray, alpha);
            assert_near(map(Spread::Reflect).mean(-0.4, -0.4 + 2.0 * periods), gray, alpha);
        }
    }

    #[test]
    fn the_mean_is_that_of_many_points() {
        for spread in [Spread::Pad, Spread::Repeat, Spread::Reflect] {
            let map = map(spread);
            let (from, to) = (-1.37, 2.21);
            let count = 20_000;
            let points = (0..count).map(|i| from + (to - from) * (i as f64 + 0.5) / count as f64);
            let sum: f64 = points.map(|t| f64::from(map.mean(t - 1e-7, t + 1e-7)[0])).sum();
            assert!((map.mean(from, to)[0] - (sum / count as f64) as f32).abs() < 1e-3, "{spread:?}");
        }
    }
}
