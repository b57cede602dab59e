//! Takes the means of strips row by row, makes pixels of them: the second pass over an image that does not
//! lie straight ([`super::averaged`]), where rows are no higher than pixels.

use super::averaged::add;
use super::scan::{fixed, to_float, whole, Scan, Span, FRACTION_BITS, GLIMPSE, WHOLE};
use crate::effects::layer::{Pixel, CLEAR};
use std::ops::Range;

/// Pixels as sums of means, each times its share of the pixel.
pub(super) struct Sums<'p> {
    pixels: &'p mut [Pixel],
    /// How much of each pixel does not see the image, and in which runs of pixels there are such. They are
    /// few, and the rest of the table is not touched.
    lacks: Vec<f64>,
    lacking: Vec<bool>,
}

/// Pixels of a run.
const RUN: usize = 64;

impl Sums<'_> {
    pub fn new(pixels: &mut [Pixel]) -> Sums<'_> {
        let (lacks, lacking) = (vec![0.0; pixels.len()], vec![false; pixels.len().div_ceil(RUN)]);
        Sums { pixels, lacks, lacking }
    }

    /// Adds a share of a pixel, of which no more than a part was `seen`.
    #[inline]
    pub fn add(&mut self, at: usize, mean: &Pixel, share: f64, seen: f32) {
        add(&mut self.pixels[at], mean, share as f32 * seen);
        if seen < 1.0 {
            self.lacks[at] += share * (1.0 - f64::from(seen));
            self.lacking[at / RUN] = true;
        }
    }

    /// Makes means of what was seen, be it a glimpse of a glimpse beyond a corner.
    pub fn divide(&mut self) {
        let runs = self.pixels.chunks_mut(RUN).zip(self.lacks.chunks(RUN)).zip(&self.lacking);
        for ((pixels, lacks), _) in runs.filter(|(_, &lacking)| lacking) {
            for (pixel, lack) in pixels.iter_mut().zip(lacks) {
                let share = (1.0 / (1.0 - lack).max(1e-12)) as f32;
                pixel.iter_mut().for_each(|v| *v *= share);
            }
        }
    }
}

/// Of each strip, what its present pixel has of the rows so far.
pub(super) struct Piles {
    /// The upper edge of the first row in the first strip, in pixels from the strip's upper end; and how
    /// much farther it is in the next strip, and in the next row.
    start: i64,
    step: i64,
    row_height: i64,
    /// Of the last row.
    last_height: i64,
    last_row: usize,
    piles: Vec<Pile>,
    target: Target,
}

#[derive(Clone, Copy)]
struct Pile {
    sum: Pixel,
    /// How much of the pixel is in it.
    weight: f32,
}

/// The layer that piles become pixels of.
struct Target {
    pixels: i64,
    /// Is a strip's upper end its last pixel?
    upside_down: bool,
    columns: usize,
    parts_log2: u32,
    /// One strip's share of a pixel.
    part: f64,
    /// Pixels beyond an image's edges that see it.
    margin: i64,
}

impl Piles {
    pub fn new(scan: &Scan) -> Piles {
        let upside_down = scan.along < 0.0;
        let first = if upside_down { scan.top + scan.along * (scan.pixels - 1) as f64 } else { scan.top };
        let row_height = 1.0 / scan.along.abs();
        Piles {
            start: fixed(0.5 - first * row_height),
            step: fixed(-scan.across_strips * row_height),
            row_height: fixed(row_height),
            last_height: fixed(row_height * (scan.rows - scan.last_row() as f64)),
            last_row: scan.last_row(),
            piles: vec![Pile { sum: CLEAR, weight: 0.0 }; scan.strips],
            target: Target {
                pixels: scan.pixels as i64,
                upside_down,
                columns: scan.columns(),
                parts_log2: scan.parts_log2,
                part: 1.0 / f64::from(1 << scan.parts_log2),
                margin: (scan.row_margin / scan.along.abs()) as i64,
            },
        }
    }

    /// Where the upper edge of a row is in a strip.
    fn top(&self, row: usize, strip: usize) -> i64 {
        self.start + self.row_height * row as i64 + self.step * strip as i64
    }

    /// Adds what strips have of a row.
    pub fn add(&mut self, row: usize, strips: Range<usize>, spans: &[Span], means: &[Pixel], to: &mut Sums) {
        let mut top = self.top(row, strips.start);
        let row_height = if row == self.last_row { self.last_height } else { self.row_height };
        let share = to_float(row_height);
        let piles = &mut self.piles[strips.clone()];
        for (((strip, mean), span), pile) in strips.zip(means).zip(spans).zip(piles) {
            let bottom = top + row_height;
            let pixel = whole(top);
            if whole(bottom) == pixel {
                pile.add(mean, share * span.seen);
            } else {
                let end = (pixel + 1) << FRACTION_BITS;
                pile.add(mean, to_float(end - top) * span.seen);
                self.target.put(to, strip, pixel, pile);
                *pile = Pile { sum: CLEAR, weight: 0.0 };
                pile.add(mean, to_float(bottom - end) * span.seen);
            }
            top += self.step;
        }
    }

    /// Adds what strips have of an image's first row, where it goes on above.
    pub fn add_above(&self, strips: Range<usize>, spans: &[Span], means: &[Pixel], to: &mut Sums) {
        for ((strip, mean), span) in strips.zip(means).zip(spans) {
            let pixel = whole(self.top(0, strip));
            let glimpse = Pile::glimpse(mean, span);
            for above in (pixel - self.target.margin).max(0)..pixel.min(self.target.pixels) {
                self.target.put(to, strip, above, &glimpse);
            }
        }
    }

    /// Adds what is left when the last row is done, and what strips have of it where it goes on below.
    pub fn add_below(&self, strips: Range<usize>, spans: &[Span], means: &[Pixel], to: &mut Sums) {
        for ((strip, mean), span) in strips.zip(means).zip(spans) {
            let (mut pixel, pile) =
                (whole(self.top(self.last_row, strip) + self.last_height), &self.piles[strip]);
            if pile.weight > 0.0 {
                self.target.put(to, strip, pixel, pile);
                pixel += 1;
            }
            let glimpse = Pile::glimpse(mean, span);
            for below in pixel.max(0)..(pixel + self.target.margin).min(self.target.pixels) {
                self.target.put(to, strip, below, &glimpse);
            }
        }
    }
}

impl Target {
    #[inline]
    fn put(&self, to: &mut Sums, strip: usize, pixel: i64, pile: &Pile) {
        if (0..self.pixels).contains(&pixel) {
            let pixel = if self.upside_down { self.pixels - 1 - pixel } else { pixel } as usize;
            let at = pixel * self.columns + (strip >> self.parts_log2);
            let seen = if pile.weight < WHOLE { pile.weight } else { 1.0 };
            let share = 1.0 / pile.weight;
            to.add(at, &pile.sum.map(|v| v * share), self.part, seen);
        }
    }
}

impl Pile {
    fn glimpse(mean: &Pixel, span: &Span) -> Pile {
        let weight = GLIMPSE * span.seen;
        Pile { sum: mean.map(|v| v * weight), weight }
    }

    #[inline]
    fn add(&mut self, mean: &Pixel, weight: f32) {
        add(&mut self.sum, mean, weight);
        self.weight += weight;
    }
}
