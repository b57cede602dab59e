//! Takes a colour map that repeats and the pattern it is a map of, makes tables of what pixels see: of the map's
//! means over spots.
//!
//! A pixel sees the map filtered by two boxes, as wide as the parameter changes along its two sides, a and b. These
//! stay along a ray from the apex of a radial gradient, and everywhere on a linear one. So a table has the
//! filtered map at so many samples of a period, for rays next to one another, and a pixel lies between four of its
//! entries, as it does in Williams's pyramids (Pyramidal Parametrics, 1983), but of spots of its own width and
//! breadth. What a circle's bend adds to it is small and goes as the parameter's lift: a second table.
//!
//! Promises: colours within [`MOST_OFF`] twice of the mean over the spot on which the parameter is linear. With R
//! the range of a component, the filtered map is G at four places over ab, so that its second derivatives are at
//! most 2R / (ab) by the parameter and 5R / (4ab) by a and b; and by a and b alone it changes by R / a and R / (4a) at
//! most. A straight line between two places is off by an eighth of the second derivative.
//! What is cheaper computed than tabled has no table: the same pixels whoever asks and in whatever order.

use super::pattern::{Aims, Pattern, STEPS};
use crate::scene::color_map::{changes, ColorMap};
use kurbo::{Point, Vec2};
use std::sync::OnceLock;

/// Of a component, premultiplied, 0 ..= 255.
type Color = [f32; 4];

/// What a mean may be off by between samples, and between rays: 8-bit levels.
const MOST_OFF: f64 = 0.05;

/// Rays that bend this many times more than straight ones may are looked up, with their bend.
const MOST_BENT: f32 = 16.0;

/// Entries of all tables of one gradient, at most: 8 MB.
const MOST_ENTRIES: usize = 1 << 18;

/// For fewer pixels nothing is planned.
const LEAST_PIXELS: f64 = 4096.0;

const FEWEST_SAMPLES: f64 = 8.0;

/// Pixels that can be computed in the time in which a sample is, on two rays and with its bends.
const COST: f64 = 4.0;

/// Of a linear gradient or a cone whose colours turn in every pixel.
#[derive(Clone, Copy)]
pub(super) struct Filtered<'a> {
    pub pattern: &'a Pattern,
    pub map: &'a ColorMap,
    /// Of the spot, in pixels.
    pub side: f64,
}

/// What a picture asks of it.
#[derive(Clone, Copy)]
pub(super) struct Demand {
    /// The pixels that may be asked for.
    pub pixels: f64,
    /// At least the difference of two values of a component of the map, 0 ..= 1.
    pub range: f64,
    /// Up to this share of the parameter's reach in a pixel circles may lift it and be taken for straight.
    pub most_lift: f64,
}

/// Tables of a gradient at a picture's scale: of each fan, from half a period before the map's start on, a pair of
/// colours for each sample, on the fan's first and its last ray.
#[derive(Clone, Debug)]
pub(super) struct Spots {
    /// Of each step of the direction, the fan it lies in.
    steps: Vec<Fan>,
    /// Entries of either table.
    entries: [usize; 2],
    means: OnceLock<Vec<[Color; 2]>>,
    bends: OnceLock<Vec<[Color; 2]>>,
}

/// The rays from one to another. It lies in one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Fan {
    /// Its first step, and one over their number.
    from: f32,
    inverse: f32,
    /// Up to this lift circles are straight; negative if there is no table.
    straight: f32,
    /// In a period, for means and for bends.
    samples: [f32; 2],
    /// Its first entry in either table.
    first: [u32; 2],
}

/// Of both tables of a fan.
const MEANS: usize = 0;
const BENDS: usize = 1;

impl Spots {
    /// `None` where no table is worth its making, or all would be too large.
    pub fn plan(filtered: Filtered, demand: Demand) -> Option<Spots> {
        let count = filtered.pattern.steps();
        if count == 0 || demand.pixels < LEAST_PIXELS {
            return None;
        }
        let (mut steps, mut entries) = (Vec::with_capacity(count), [0; 2]);
        for eighth in (0..count).step_by(STEPS) {
            let end = (eighth + STEPS).min(count);
            let rays: Vec<Vec2> = (eighth..=end)
                .map(|step| filtered.side * filtered.pattern.local_after(step, step == end).0.along)
                .collect();
            let mut from = 0;
            while eighth + from < end {
                let most = end - eighth - from;
                let width = (2..=most).take_while(|width| demand.off(&rays[from..=from + width]) <= MOST_OFF);
                let to = from + width.last().unwrap_or(1);
                let pixels = demand.pixels * (to - from) as f64 / count as f64;
                let fan = demand.fan(eighth + from, &rays[from..=to], filtered, pixels, &mut entries);
                steps.resize(eighth + to, fan);
                from = to;
            }
        }
        let is_some = (1..=MOST_ENTRIES).contains(&entries.iter().sum());
        is_some.then_some(Spots { steps, entries, means: OnceLock::new(), bends: OnceLock::new() })
    }

    /// Bytes of both tables, once each has been made.
    pub fn bytes(&self) -> u64 {
        let entries: usize = self.entries.iter().sum();
        (size_of::<[Color; 2]>() * entries + size_of::<Fan>() * self.steps.len()) as u64
    }

    /// The colours of pixels of a row from a centre on; `other` gives those of which there is no table, by their
    /// place among them.
    #[inline]
    pub fn row(
        &self,
        filtered: Filtered,
        first: Point,
        aims: &mut Aims,
        (colors, other): (&mut [Color], impl Fn(usize) -> Color),
    ) {
        filtered.pattern.aim(first, colors.len(), (filtered.side, filtered.map.frequency()), aims);
        let means = self.means(filtered);
        let aims = aims.phases.iter().zip(&aims.directions).zip(&aims.lifts);
        for (i, (to, ((&phase, &direction), &lift))) in colors.iter_mut().zip(aims).enumerate() {
            match self.straight_color(means, phase, direction, lift) {
                Some(color) => *to = color,
                None => self.bent_color(filtered, (phase, direction, lift), to, || other(i)),
            }
        }
    }

    /// Where circles are straight.
    #[inline(always)]
    fn straight_color(&self, means: &[[Color; 2]], phase: f32, direction: f32, lift: f32) -> Option<Color> {
        let fan = self.steps.get(whole(direction).0)?;
        if lift <= fan.straight {
            fan.color(means, MEANS, phase, direction)
        } else {
            None
        }
    }

    /// Where they bend; `other` gives it if there is no table.
    #[inline(never)]
    fn bent_color(
        &self,
        filtered: Filtered,
        (phase, direction, lift): (f32, f32, f32),
        to: &mut Color,
        other: impl Fn() -> Color,
    ) {
        let color = || {
            // Not a number where there is no direction.
            let fan = self.steps.get(whole(direction).0).filter(|fan| lift <= MOST_BENT * fan.straight)?;
            let mean = fan.color(self.means(filtered), MEANS, phase, direction)?;
            let bend = fan.color(self.bends(filtered), BENDS, phase, direction)?;
            Some(std::array::from_fn(|i| (mean[i] + lift * bend[i]).clamp(0.0, 255.0)))
        };
        *to = color().unwrap_or_else(other);
    }

    #[inline]
    fn means(&self, filtered: Filtered) -> &[[Color; 2]] {
        let mean =
            |t: f64, along: Vec2, _| filtered.map.over_square(t, (along.x, along.y)).unwrap_or_default();
        self.means.get_or_init(|| self.table(MEANS, filtered, mean))
    }

    #[inline]
    fn bends(&self, filtered: Filtered) -> &[[Color; 2]] {
        let bend = |t: f64, along: Vec2, ray: Vec2| filtered.map.bend_of_square(t, along, ray);
        self.bends.get_or_init(|| self.table(BENDS, filtered, bend))
    }

    /// All entries of one of both tables.
    #[cold]
    fn table(
        &self,
        which: usize,
        Filtered { pattern, map, side }: Filtered,
        color: impl Fn(f64, Vec2, Vec2) -> Color,
    ) -> Vec<[Color; 2]> {
        let mut entries = Vec::with_capacity(self.entries[which]);
        for fans in self.steps.chunk_by(|a, b| a.from == b.from).filter(|fans| fans[0].straight >= 0.0) {
            let from = fans[0].from as usize;
            let rays = [(from, false), (from + fans.len(), true)]
                .map(|(step, after)| pattern.local_after(step, after));
            let samples = fans[0].samples[which];
            entries.extend((0..entries_of(samples)).map(|i| {
                let t = (i as f64 / f64::from(samples) - 0.5) / map.frequency();
                rays.map(|(local, ray)| color(t, side * local.along, ray).map(|v| 255.0 * v))
            }));
        }
        entries
    }
}

/// One more than the ends of a period, for rounding.
fn entries_of(samples: f32) -> usize {
    samples as usize + 2
}

impl Demand {
    /// What colours may be off by between the first and the last of these rays, in levels.
    fn off(&self, rays: &[Vec2]) -> f64 {
        let (first, last) = (rays[0], rays[rays.len() - 1]);
        let mut sides = (f64::INFINITY, f64::INFINITY);
        let (mut way, mut off_line) = (0.0, Vec2::ZERO);
        for (i, &ray) in rays.iter().enumerate() {
            let (a, b) = changes((ray.x, ray.y));
            sides = (sides.0.min(a), sides.1.min(b));
            let next = rays.get(i + 1).map_or(Vec2::ZERO, |next| *next - ray);
            way += next.x.abs() + next.y.abs();
            let off = ray - first.lerp(last, i as f64 / (rays.len() - 1) as f64);
            off_line = Vec2::new(off_line.x.max(off.x.abs()), off_line.y.max(off.y.abs()));
        }
        // 1/8 (a'a' + 5/2 a'b' + b'b') is at most 9/64 of the square of the sum.
        let between = 9.0 / 64.0 * way * way / (sides.0 * sides.1);
        255.0 * self.range * (between + (off_line.x + off_line.y) / sides.0)
    }

    /// The fan of these rays, of which so many pixels are thought to be asked for; its entries are added to those
    /// before.
    fn fan(
        &self,
        first: usize,
        rays: &[Vec2],
        filtered: Filtered,
        pixels: f64,
        entries: &mut [usize; 2],
    ) -> Fan {
        let least = |of: fn(f64, f64) -> f64| {
            rays.iter()
                .map(|ray| changes((ray.x, ray.y)))
                .fold(f64::INFINITY, |least, (a, b)| least.min(of(a, b)))
        };
        let samples = (255.0 * self.range / (4.0 * MOST_OFF * least(|a, b| a * b))).sqrt();
        let samples = (samples / filtered.map.frequency()).ceil().max(FEWEST_SAMPLES);
        let is_worth_it = COST * samples <= pixels && self.off(rays) <= MOST_OFF && least(|a, _| a) > 1e-9;
        let straight = self.most_lift * least(|a, b| 0.5 * (a + b)) / filtered.side;
        let fan = Fan {
            from: first as f32,
            inverse: 1.0 / (rays.len() - 1) as f32,
            straight: if is_worth_it { straight as f32 } else { -1.0 },
            // Bends are small.
            samples: [samples, (samples / 4.0).ceil()].map(|samples| samples as f32),
            first: entries.map(|entries| entries as u32),
        };
        if is_worth_it {
            (MEANS..=BENDS).for_each(|which| entries[which] += entries_of(fan.samples[which]));
        }
        fan
    }
}

impl Fan {
    /// In a table, at a phase, -.5 ..= .5, and in a direction.
    #[inline(always)]
    fn color(&self, table: &[[Color; 2]], which: usize, phase: f32, direction: f32) -> Option<Color> {
        let (sample, rest) = whole((phase + 0.5) * self.samples[which]);
        let at = self.first[which] as usize + sample;
        let (&other, &one) = (table.get(at + 1)?, &table[at]);
        let turn = (direction - self.from) * self.inverse;
        let between = |[first, last]: [Color; 2]| -> Color {
            std::array::from_fn(|i| first[i] + turn * (last[i] - first[i]))
        };
        let (one, other) = (between(one), between(other));
        Some(std::array::from_fn(|i| one[i] + rest * (other[i] - one[i])))
    }
}

/// A number without its digits behind the point, 0 ..= 1 of them, and these. Of numbers from 0 to 4 million; others
/// leave anything.
#[inline]
fn whole(v: f32) -> (usize, f32) {
    // Sums with it have no digits behind the point; the number is in the last 22 binary digits.
    const ROUNDER: f32 = 12_582_912.0;
    let sum = v - 0.5 + ROUNDER;
    ((sum.to_bits() & 0x3f_ffff) as usize, v - (sum - ROUNDER))
}

#[cfg(test)]
mod tests {
    use super::super::pattern::AT_A_TIME;
    use super::*;
    use crate::scene::paint::{GradientShape, Spread, Stop};
    use kurbo::Affine;

    fn stop(offset: f32, gray: f32, alpha: f32) -> Stop {
        Stop { offset, color: [gray, 1.0 - gray, 0.3, alpha] }
    }

    /// Hard stops; the same and fading; both kinds of spread.
    fn maps() -> Vec<ColorMap> {
        let hard = [stop(0.0, 0.0, 1.0), stop(0.4, 0.1, 1.0), stop(0.4, 1.0, 1.0), stop(1.0, 0.5, 1.0)];
        let fading = [stop(0.1, 0.0, 0.2), stop(0.3, 0.9, 1.0), stop(0.3, 0.2, 0.0), stop(0.8, 1.0, 0.9)];
        let spreads = [Spread::Repeat, Spread::Reflect];
        spreads
            .iter()
            .flat_map(|&spread| [ColorMap::new(&hard, spread), ColorMap::new(&fading, spread)])
            .collect()
    }

    /// Rings and stripes of some pixels, around (0, 0) or through it: circles, ellipses, skewed ones, focal points.
    fn patterns() -> Vec<(&'static str, Pattern)> {
        let linear = |x: f64, y: f64| GradientShape::Linear(Affine::new([x, 0.0, y, 0.0, 0.0, 0.0]));
        let radial =
            |x: f64, y: f64, r: f64| GradientShape::Radial { start: (x, y, r), step: (-x, -y, 2.0 - r) };
        let skewed = Affine::rotate(0.5) * Affine::scale_non_uniform(1.7, 0.6) * Affine::rotate(0.9);
        [
            ("stripes", linear(0.31, 0.17), Affine::IDENTITY),
            ("stripes along pixels", linear(0.0, 0.7), Affine::IDENTITY),
            ("circles", radial(0.0, 0.0, 0.0), Affine::IDENTITY),
            ("ellipses", radial(0.0, 0.0, 0.0), Affine::scale_non_uniform(1.0, 0.4)),
            ("turned ellipses", radial(0.0, 0.0, 0.0), skewed),
            ("a focus", radial(1.1, -0.6, 0.0), Affine::IDENTITY),
            ("a focal circle, skewed", radial(0.4, 0.5, 0.3), skewed),
        ]
        .map(|(name, shape, transform)| (name, Pattern::new(shape, transform)))
        .into()
    }

    fn demand(pixels: f64) -> Demand {
        Demand { pixels, range: 1.0, most_lift: 0.15 / 255.0 }
    }

    /// By the parameter's own slope in so many by so many parts of the pixel.
    fn mean_of_parts(Filtered { pattern, map, side }: Filtered, centre: Point, parts: u32) -> Color {
        let mut sum = Color::default();
        let place = |i: u32| side * ((f64::from(i) + 0.5) / f64::from(parts) - 0.5);
        for (x, y) in (0..parts).flat_map(|x| (0..parts).map(move |y| (place(x), place(y)))) {
            let local = pattern.local(centre + Vec2::new(x, y)).expect("it has colour everywhere");
            let side = side / f64::from(parts);
            let along = side * local.along;
            let mean = map.over_square(local.t + side * side * local.lift(), (along.x, along.y));
            let mean = mean.expect("it changes");
            (0..4).for_each(|i| sum[i] += 255.0 * mean[i] / (parts * parts) as f32);
        }
        sum
    }

    /// Pixels of rows that have tables, in places all around (0, 0), between these distances.
    fn compare(spots: &Spots, filtered: Filtered, (near, far): (f64, f64), parts: u32) -> (usize, f32) {
        let (mut count, mut worst) = (0, 0.0f32);
        for i in 0..400 {
            let far = near + (far - near) * (f64::from(i) * 0.618_034).fract();
            let turn = Vec2::from_angle(f64::from(i) * 2.399_963);
            let first = Point::new((far * turn.x).floor() + 0.5, (far * turn.y).floor() + 0.5);
            let mut colors = [[f32::NAN; 4]; AT_A_TIME];
            spots.row(filtered, first, &mut Aims::default(), (&mut colors, |_| [f32::NAN; 4]));
            for (i, color) in colors.iter().enumerate().step_by(7).filter(|(_, color)| !color[0].is_nan()) {
                let truth = mean_of_parts(filtered, first + Vec2::new(i as f64, 0.0), parts);
                count += 1;
                worst = (0..4).map(|i| (color[i] - truth[i]).abs()).fold(worst, f32::max);
            }
        }
        (count, worst)
    }

    #[test]
    fn where_circles_are_straight_tables_have_the_mean_over_the_spot_to_a_tenth_of_a_level() {
        for (name, pattern) in patterns() {
            for (i, map) in maps().iter().enumerate() {
                for side in [1.0, 1.7] {
                    let filtered = Filtered { pattern: &pattern, map, side };
                    let Some(spots) = Spots::plan(filtered, demand(4e6)) else {
                        println!("{name}, map {i}, side {side}: no tables");
                        continue;
                    };
                    let (count, worst) = compare(&spots, filtered, (1500.0, 3000.0), 1);
                    println!("{name}, map {i}, side {side}: {count} pixels, at most {worst:.3} levels off");
                    assert!(count > 2000, "{name}: {count}");
                    // Far out the parameter's digits in f32 are a part of it.
                    assert!(f64::from(worst) < 2.0 * MOST_OFF + 0.02, "{name}, {i}, {side}: {worst}");
                }
            }
        }
    }

    #[test]
    fn where_circles_bend_tables_are_within_a_quarter_of_a_level_of_what_small_parts_of_pixels_have() {
        for (name, pattern) in patterns().into_iter().skip(2) {
            for (i, map) in maps().iter().enumerate() {
                let filtered = Filtered { pattern: &pattern, map, side: 1.0 };
                let Some(spots) = Spots::plan(filtered, demand(4e6)) else {
                    println!("{name}, map {i}: no tables");
                    continue;
                };
                let (count, worst) = compare(&spots, filtered, (5.0, 100.0), 16);
                let straight = Spots {
                    steps: spots
                        .steps
                        .iter()
                        .map(|&fan| Fan { straight: fan.straight.signum(), ..fan })
                        .collect(),
                    ..spots
                };
                let (_, unbent) = compare(&straight, filtered, (5.0, 100.0), 16);
                println!("{name}, map {i}: {count} pixels, at most {worst:.3} levels off, {unbent:.2} without bends");
                assert!(count > 500, "{name}: {count}");
                assert!(worst < 0.25, "{name}, {i}: {worst}");
            }
        }
    }

    #[test]
    fn few_pixels_a_map_that_does_not_repeat_and_too_many_stops_have_no_table() {
        let (_, circles) = patterns().swap_remove(2);
        let maps = maps();
        let filtered = Filtered { pattern: &circles, map: &maps[0], side: 1.0 };
        assert!(Spots::plan(filtered, demand(4000.0)).is_none());
        assert!(Spots::plan(filtered, demand(1e6)).is_some());
        let wide = Pattern::new(
            GradientShape::Radial { start: (0.0, 0.0, 0.0), step: (0.0, 0.0, 6000.0) },
            Affine::IDENTITY,
        );
        assert!(Spots::plan(Filtered { pattern: &wide, ..filtered }, demand(1e9)).is_none());
    }
}
