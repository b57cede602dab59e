//! The bounded way out of a pixel that is too complex to split: takes its fragments, makes regions from
//! [`LINES`] sub-scanlines, each cut exactly in x.
//!
//! Promises: the areas sum exactly to the pixel; time grows with the pieces a sub-scanline meets, never
//! with the crossings of the pieces. What is lost is accuracy in y, 1/128 pixel a border.

use super::fragment::{PieceSet, PIXEL_AREA};
use crate::edges::ONE;
use crate::scene::FillRule;

/// Sub-scanlines in a pixel.
const LINES: i32 = 128;

/// Half the height of a sub-scanline, in fixed point.
const HALF_LINE: f64 = ONE as f64 / LINES as f64 * 0.5;

/// A stretch of a sub-scanline, in fixed point.
#[derive(Clone, Copy)]
pub(crate) struct Stretch {
    pub from: f64,
    pub to: f64,
    middle: f64,
}

impl Stretch {
    /// Its part from one share of its length to another.
    pub fn part(&self, from: f64, to: f64) -> Stretch {
        let at = |share: f64| self.from + (self.to - self.from) * share;
        Stretch { from: at(from), to: at(to), ..*self }
    }

    pub fn corners(&self) -> [(f64, f64); 4] {
        let (top, bottom) = (self.middle - HALF_LINE, self.middle + HALF_LINE);
        [(self.from, top), (self.to, top), (self.to, bottom), (self.from, bottom)]
    }

    pub fn centre(&self) -> (f64, f64) {
        (0.5 * (self.from + self.to), self.middle)
    }
}

/// Fragments held for sampling.
#[derive(Default)]
pub(crate) struct Sampler {
    sets: Vec<(PieceSet, FillRule)>,
    used: usize,
    windings: Vec<i32>,
    crossings: Vec<(f64, u32, i32)>,
    inside: Vec<u64>,
}

impl Sampler {
    /// Forgets the last pixel's fragments.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Adds a fragment; its number is the count of those added before.
    pub fn add(&mut self, set: &PieceSet, rule: FillRule) {
        if self.used == self.sets.len() {
            self.sets.push((PieceSet::default(), rule));
        }
        let (kept, kept_rule) = &mut self.sets[self.used];
        kept.clone_from(set);
        *kept_rule = rule;
        self.used += 1;
    }

    /// Gives `emit` each region: one bit a fragment for those that cover it, its area, and where it lies.
    pub fn sample(&mut self, mut emit: impl FnMut(&[u64], i64, Stretch)) {
        const LINE_AREA: i64 = PIXEL_AREA / LINES as i64;
        let sets = &self.sets[..self.used];
        self.inside.clear();
        self.inside.resize(sets.len().div_ceil(64), 0);
        for line in 0..LINES {
            // In halves of fixed point, off the grid that the ends of pieces lie on.
            let y = (2 * line + 1) * ONE / LINES + 1;
            self.windings.clear();
            self.crossings.clear();
            for (leaf, (set, rule)) in sets.iter().enumerate() {
                let winding = set.winding_left_of(y);
                self.windings.push(winding);
                set_bit(&mut self.inside, leaf, rule.inside(winding));
                let at = set.pieces.iter().filter_map(|p| Some((p.x_at(y)?, leaf as u32, p.winding)));
                self.crossings.extend(at);
            }
            self.crossings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let (mut from, mut spent) = (0.0, 0);
            let middle = f64::from(y) * 0.5;
            let stretch = |from: f64, to: f64| Stretch { from, to, middle };
            for &(x, leaf, winding) in &self.crossings {
                let area = ((x / f64::from(ONE) * LINE_AREA as f64) as i64).clamp(spent, LINE_AREA);
                if area > spent {
                    emit(&self.inside, area - spent, stretch(from, x));
                    (from, spent) = (x, area);
                }
                let leaf = leaf as usize;
                self.windings[leaf] += winding;
                set_bit(&mut self.inside, leaf, sets[leaf].1.inside(self.windings[leaf]));
            }
            if spent < LINE_AREA {
                emit(&self.inside, LINE_AREA - spent, stretch(from, f64::from(ONE)));
            }
        }
    }
}

#[inline]
fn set_bit(bits: &mut [u64], at: usize, on: bool) {
    let mask = 1 << (at % 64);
    if on {
        bits[at / 64] |= mask;
    } else {
        bits[at / 64] &= !mask;
    }
}
