//! Takes a gradient's stops and spread, makes the stretches of the parameter on which its colours go straight.

use crate::scene::paint::{Sheet, Spread, Stop};

/// A stretch of the parameter, as it is before it is spread, over which straight colours go straight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub from: f64,
    pub to: f64,
    /// Where `color` is.
    origin: f64,
    color: [f32; 4],
    /// Change of the colour with the parameter.
    slope: [f32; 4],
    /// At least the second coefficient of any premultiplied component: 0 where alpha stays or colour does.
    bend: f64,
}

/// The square of a length l of the parameter, times the bend, of which a twelfth is what the colour in the
/// middle is off by: a quarter of an 8-bit level.
const MOST_BEND: f64 = 12.0 * 0.25 / 255.0;

/// At least half the second derivative of light by its encoding over the first: what bends in linear light, as a
/// change of the encoding, in which colours go straight.
const LIGHT_BEND: f64 = 7.4;

/// Colours that differ by less are one.
const SAME: f32 = 0.5 / 255.0;

/// Stretches are looked at one by one in a pixel that has no more.
const MOST_STRETCHES: usize = 12;

/// Added to a float of 0 ..= 255 it makes a sum whose last 8 binary digits are that number, rounded: floats of
/// this size have no digits behind the point.
const ROUNDER: f32 = 8_388_608.0;

/// Red, green and blue of 0 ..= 255 and full alpha.
#[inline]
pub(super) fn rounded_bytes(color: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = color.map(|v| (v + ROUNDER).to_bits());
    // What stands before the last 8 digits is the same for all; shifted by 8 or 16 nothing of it is left.
    let word = r.wrapping_add(0xff00_0000 - ROUNDER.to_bits()).wrapping_add(g << 8).wrapping_add(b << 16);
    word.to_le_bytes()
}

/// Of a sheet that hides what lies behind.
#[inline]
pub(super) fn opaque_bytes(sheet: Sheet) -> [u8; 4] {
    let [r, g, b, _] = sheet.channels();
    rounded_bytes([r, g, b].map(|v| v * 255.0))
}

impl Stretch {
    fn flat(from: f64, to: f64, color: [f32; 4]) -> Stretch {
        Stretch { from, to, origin: 0.0, color, slope: [0.0; 4], bend: 0.0 }
    }

    fn between(a: Stop, b: Stop, linear: bool) -> Stretch {
        let length = b.offset - a.offset;
        let slope: [f32; 4] = std::array::from_fn(|i| (b.color[i] - a.color[i]) / length);
        let (from, to) = (f64::from(a.offset), f64::from(b.offset));
        let [red, green, blue, alpha] = slope.map(|v| f64::from(v).abs());
        let color = red.max(green).max(blue);
        let bend = color * alpha + if linear { LIGHT_BEND * color * color } else { 0.0 };
        Stretch { from, to, origin: from, color: a.color, slope, bend }
    }

    #[inline]
    pub fn at(&self, t: f64) -> Sheet {
        let [r, g, b, alpha] = self.straight(t);
        Sheet::new([r, g, b], alpha)
    }

    /// Straight red, green, blue and alpha.
    #[inline]
    fn straight(&self, t: f64) -> [f32; 4] {
        let by = t - self.origin;
        // Only where the colour stays is it farther.
        let by = if by.abs() < 1e30 { by as f32 } else { 0.0 };
        std::array::from_fn(|i| self.color[i] + self.slope[i] * by)
    }

    /// Does it hide what lies behind, everywhere?
    #[inline]
    pub fn is_opaque(&self) -> bool {
        self.color[3] == 1.0 && self.slope[3] == 0.0
    }

    /// Does one of some components change by more than this with the parameter?
    #[inline]
    pub fn changes(&self, mut components: std::ops::Range<usize>, most: [f64; 4]) -> bool {
        components.any(|i| f64::from(self.slope[i].abs()) > most[i])
    }

    /// The colours at parameters on it, if it hides what lies behind.
    #[inline]
    pub fn write(&self, parameters: &[f64], pixels: &mut [[u8; 4]]) {
        if self.slope == [0.0; 4] {
            pixels.fill(self.at(self.origin).to_rgba8());
            return;
        }
        let [[r, g, b, _], [by_r, by_g, by_b, _]] = [self.color, self.slope].map(|c| c.map(|v| v * 255.0));
        for (pixel, &t) in pixels.iter_mut().zip(parameters) {
            let by = (t - self.origin) as f32;
            *pixel = rounded_bytes([r + by_r * by, g + by_g * by, b + by_b * by]);
        }
    }

    /// Is the colour in the middle of [from, to] the mean over it?
    #[inline]
    pub fn holds(&self, from: f64, to: f64) -> bool {
        self.from <= from && to <= self.to && self.bend * (to - from) * (to - from) <= MOST_BEND
    }

    /// The parameters around which it holds `reach` to either side.
    #[inline]
    pub fn middle(&self, reach: f64) -> (f64, f64) {
        if self.bend * 4.0 * reach * reach > MOST_BEND {
            return (f64::INFINITY, f64::NEG_INFINITY);
        }
        (self.from + reach, self.to - reach)
    }

    /// At least the change of any premultiplied component with the parameter.
    #[inline]
    pub fn steepness(&self) -> f64 {
        let [r, g, b, alpha] = self.slope.map(f32::abs);
        f64::from(r.max(g).max(b) + alpha)
    }
}

/// All stretches of a gradient.
#[derive(Clone, Debug)]
pub(super) struct Stretches {
    /// Without a spread: from before the first stop, where the colour stays for ever, to beyond the last.
    all: Vec<Stretch>,
    spread: Spread,
}

impl Stretches {
    /// `stops` are not empty.
    pub fn new(stops: &[Stop], spread: Spread, linear: bool) -> Stretches {
        let (first, last) = (stops[0], stops[stops.len() - 1]);
        let mut all = vec![Stretch::flat(f64::NEG_INFINITY, first.offset.into(), first.color)];
        all.extend(stops.windows(2).map(|pair| Stretch::between(pair[0], pair[1], linear)));
        all.push(Stretch::flat(last.offset.into(), f64::INFINITY, last.color));
        Stretches { all, spread }
    }

    /// The stretch around a parameter.
    pub fn around(&self, t: f64) -> Stretch {
        let period = t.floor();
        let backwards = match self.spread {
            Spread::Pad => return *self.within(t),
            Spread::Repeat => false,
            Spread::Reflect => period % 2.0 != 0.0,
        };
        let within = if backwards { 1.0 - (t - period) } else { t - period };
        let inner = *self.within(within);
        let (from, to) = (inner.from.max(0.0), inner.to.min(1.0));
        match backwards {
            false => Stretch { from: period + from, to: period + to, origin: period + inner.origin, ..inner },
            true => {
                let back = |t: f64| period + 1.0 - t;
                let slope = inner.slope.map(|v| -v);
                Stretch { from: back(to), to: back(from), origin: back(inner.origin), slope, ..inner }
            }
        }
    }

    /// The same without a spread.
    #[inline]
    fn within(&self, t: f64) -> &Stretch {
        &self.all[self.all[1..].partition_point(|stretch| stretch.from <= t)]
    }

    /// Gives `take` the stretches of a range of the parameter one by one, with where they begin and end in it;
    /// `false` if they are too many.
    fn each_in(&self, (from, to): (f64, f64), mut take: impl FnMut(&Stretch, f64, f64)) -> bool {
        let mut t = from;
        for _ in 0..MOST_STRETCHES {
            let stretch = self.around(t);
            take(&stretch, t, stretch.to.min(to));
            if stretch.to >= to {
                return true;
            }
            // Whole periods are no digits behind the point.
            t = stretch.to.max(t + 1e-9 * (to - from));
        }
        false
    }

    /// May a range of this length hold so few that they are looked at one by one?
    pub fn are_few_in(&self, length: f64) -> bool {
        length <= MOST_STRETCHES as f64 * self.longest()
    }

    /// Does one of some components of the straight colour change by more than this in a range of the parameter? Not
    /// if there are too many changes to tell.
    pub fn differ(&self, range: (f64, f64), mut components: std::ops::Range<usize>, most: [f32; 4]) -> bool {
        let (mut least, mut greatest) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        let are_few = self.each_in(range, |stretch, from, to| {
            for color in [from, to].map(|t| stretch.straight(t)) {
                for i in 0..4 {
                    (least[i], greatest[i]) = (least[i].min(color[i]), greatest[i].max(color[i]));
                }
            }
        });
        are_few && components.any(|i| greatest[i] - least[i] > most[i])
    }

    /// The parameters in a range between which no component changes by more than this: where they jump, and in between
    /// where they are steep. Nothing if they are too many.
    pub fn cuts(&self, range: (f64, f64), most_change: f32) -> Vec<f64> {
        let mut cuts = Vec::new();
        let mut before: Option<([f32; 4], f32)> = None;
        let are_few = self.each_in(range, |stretch, from, to| {
            let (first, last) = (stretch.straight(from), stretch.straight(to));
            let change = (0..4).map(|i| (last[i] - first[i]).abs()).fold(0.0, f32::max);
            if let Some((before, other)) = before {
                let jumps = (0..4).any(|i| (first[i] - before[i]).abs() > SAME);
                if jumps || change + other > most_change {
                    cuts.push(from);
                }
            }
            let steps = (change / most_change).ceil();
            let step = (to - from) / f64::from(steps);
            cuts.extend((1..steps as u32).map(|i| from + step * f64::from(i)));
            before = Some((last, change));
        });
        if are_few {
            cuts
        } else {
            Vec::new()
        }
    }

    /// The length of the longest one.
    pub fn longest(&self) -> f64 {
        let (before, beyond) = (self.all[0].to, 1.0 - self.all[self.all.len() - 1].from);
        let (before, beyond) = match self.spread {
            Spread::Pad => return f64::INFINITY,
            Spread::Repeat => (before, beyond),
            Spread::Reflect => (2.0 * before, 2.0 * beyond),
        };
        let between = self.all[1..self.all.len() - 1].iter().map(|stretch| stretch.to - stretch.from);
        between.fold(before.max(beyond), f64::max)
    }

    /// The greatest change of colour with the parameter, but for hard stops.
    pub fn steepness(&self) -> f64 {
        let slopes = self.all.iter().filter(|stretch| stretch.from < stretch.to);
        slopes.map(Stretch::steepness).fold(0.0, f64::max)
    }
}
