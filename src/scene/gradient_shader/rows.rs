//! Takes pixels of a row, makes their colours: many at a time where the map goes straight or there are tables.

use super::pattern::{Aims, Run, AT_A_TIME};
use super::stretch::{self, Stretch};
use super::{sheet_of, GradientShader, MOST_LIFT};
use crate::bitmap::word_mask;
use crate::scene::paint::Sheet;
use kurbo::Point;
use std::cell::Cell;

/// Some of a row's colours.
enum Span<'a> {
    /// Of pixels with these parameters, each of which lies on a stretch with all parameters so far to either side.
    Straight(&'a Stretch, &'a [f64], f64),
    /// Of so many pixels that have none.
    Clear(usize),
    /// Of one pixel.
    Pixel(Sheet),
    /// Of these pixels, premultiplied, 0 ..= 255.
    Tabled(&'a [[f32; 4]]),
}

/// Pixels that a row of colours leaves out, a bit for each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeftOut {
    /// The mean over the pixel will not do.
    pub uneven: u64,
    /// The paint has no colour there.
    pub clear: u64,
    /// It hides what lies behind; its colour stands in the picture.
    pub finished: u64,
}

impl GradientShader<'_> {
    /// Gives `put` the colours of up to 64 pixels of row `y` from column `x` on, each with its place among them, and
    /// returns those left out. `picture` has the same pixels, if nothing lies before them, and is given those that
    /// lie on opaque stretches.
    #[inline]
    pub fn row(
        &self,
        (x, y): (usize, u32),
        count: usize,
        mut picture: Option<&mut [[u8; 4]]>,
        mut put: impl FnMut(usize, Sheet),
    ) -> LeftOut {
        let (mut clear, mut finished) = (0, 0);
        let uneven = Cell::new(0);
        let is_uneven = |i: usize| {
            let is_uneven = self.is_uneven(Point::new((x + i) as f64 + 0.5, f64::from(y) + 0.5));
            uneven.set(uneven.get() | u64::from(is_uneven) << i);
            is_uneven
        };
        self.spans(x, y, count, is_uneven, |first, span| match (span, &mut picture) {
            (Span::Straight(stretch, parameters, _), Some(picture)) if stretch.is_opaque() => {
                let end = first + parameters.len();
                stretch.write(parameters, &mut picture[first..end]);
                finished |= word_mask(first, end);
            }
            (Span::Straight(stretch, parameters, far), _) if self.may_be_uneven(stretch, far) => {
                for (i, &t) in parameters.iter().enumerate() {
                    if !is_uneven(first + i) {
                        put(first + i, stretch.at(t));
                    }
                }
            }
            (Span::Straight(stretch, parameters, _), _) => {
                parameters.iter().enumerate().for_each(|(i, &t)| put(first + i, stretch.at(t)));
            }
            (Span::Clear(count), _) => clear |= word_mask(first, first + count),
            (Span::Pixel(sheet), _) => put(first, sheet),
            (Span::Tabled(colors), _) => {
                let sheet = |color: &[f32; 4]| sheet_of(color.map(|v| v * (1.0 / 255.0)));
                colors.iter().enumerate().for_each(|(i, color)| put(first + i, sheet(color)));
            }
        });
        LeftOut { uneven: uneven.get(), clear, finished }
    }

    /// The same in bytes, of a gradient that hides what lies behind.
    pub fn write_row(&self, x: usize, y: u32, pixels: &mut [[u8; 4]]) {
        self.spans(
            x,
            y,
            pixels.len(),
            |_| false,
            |first, span| match span {
                Span::Straight(stretch, parameters, _) => {
                    stretch.write(parameters, &mut pixels[first..first + parameters.len()]);
                }
                Span::Clear(_) => unreachable!("circles that leave places clear hide nothing"),
                Span::Pixel(sheet) => pixels[first] = stretch::opaque_bytes(sheet),
                Span::Tabled(colors) => {
                    let pixels = &mut pixels[first..first + colors.len()];
                    pixels
                        .iter_mut()
                        .zip(colors)
                        .for_each(|(pixel, &[r, g, b, _])| *pixel = stretch::rounded_bytes([r, g, b]));
                }
            },
        );
    }

    /// The colours of pixels of row `y` from column `x` on, each time with the place of the first. Of pixels of
    /// which each has its own mean it leaves out those that are to be skipped.
    #[inline]
    fn spans(
        &self,
        x: usize,
        y: u32,
        count: usize,
        mut skip: impl FnMut(usize) -> bool,
        mut take: impl FnMut(usize, Span),
    ) {
        let centre = |i: usize| Point::new((x + i) as f64 + 0.5, f64::from(y) + 0.5);
        if let Some(spots) = self.spots() {
            let (mut aims, mut colors) = (Aims::default(), [[0.0; 4]; AT_A_TIME]);
            for first in (0..count).step_by(AT_A_TIME) {
                let colors = &mut colors[..(count - first).min(AT_A_TIME)];
                let other = |i: usize| self.mean_at(centre(first + i));
                spots.row(self.filtered(), centre(first), &mut aims, (&mut *colors, other));
                take(first, Span::Tabled(colors));
            }
            return;
        }
        if self.turns_everywhere {
            self.pattern.each_of_row(centre(0), count, |i, local| {
                if !skip(i) {
                    take(i, Span::Pixel(self.mean(centre(i), local)));
                }
            });
            return;
        }
        let mut stretch = None;
        let mut parameters = [0.0; AT_A_TIME];
        let mut first = 0;
        while first < count {
            let some = &mut parameters[..(count - first).min(AT_A_TIME)];
            let run = self.pattern.row(centre(first), (self.spot_scale, MOST_LIFT / self.steepness), some);
            let (some, far) = match run {
                Run::Clear { count } => {
                    take(first, Span::Clear(count));
                    first += count;
                    continue;
                }
                Run::Colored { count, far } => (&some[..count], Some(far)),
                Run::Mixed { count } => (&some[..count], None),
            };
            let mut done = 0;
            while let Some(&t) = some.get(done) {
                // As far as the colours go straight.
                let mut straight = 0;
                if let Some(far) = far {
                    let stretch = stretch.get_or_insert_with(|| self.stretches.around(t));
                    if !stretch.holds(t, t) {
                        *stretch = self.stretches.around(t);
                    }
                    straight = self.straight_ones(stretch, &some[done..], far);
                    if straight > 0 {
                        take(first + done, Span::Straight(stretch, &some[done..done + straight], far));
                    }
                }
                if straight == 0 && !skip(first + done) {
                    take(first + done, Span::Pixel(self.pixel(centre(first + done), &mut stretch)));
                }
                done += straight.max(1);
            }
            first += some.len();
        }
    }

    /// How many parameters from the first on lie on a stretch with all that are so far to either side.
    #[inline]
    fn straight_ones(&self, stretch: &Stretch, parameters: &[f64], far: f64) -> usize {
        let (from, to) = stretch.middle(far);
        let from = from.max(self.apex);
        let lies = |t: f64| (from <= t) & (t <= to);
        // Mostly it is all or none.
        if !lies(parameters[0]) {
            return 0;
        }
        let others: u64 = parameters.iter().map(|&t| u64::from(!lies(t))).sum();
        match others {
            0 => parameters.len(),
            _ => parameters.iter().take_while(|&&t| lies(t)).count(),
        }
    }
}
