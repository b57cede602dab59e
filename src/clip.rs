//! Takes a clip's members, makes for each pixel of a band whether it lies inside, outside, or partly.
//!
//! A clip is no mask of shares: where its border runs through a pixel it takes part in that pixel's
//! z-list as the fragment it is, so a clip beside its complement leaves no seam.

use crate::bitmap::{for_runs, word_masks, Bitmap};
use crate::coverage::{Part, Parts, TakeSpans};
use crate::edges::BAND_ROWS;

/// One clip in one band.
#[derive(Clone)]
pub(crate) struct ClipBand<P> {
    width: usize,
    /// Pixels wholly inside.
    pub full: Bitmap,
    /// Pixels partly inside, where `parts` says how.
    pub part: Bitmap,
    parts: Vec<P>,
}

impl<P: Part> ClipBand<P> {
    /// Nothing is inside.
    pub fn empty(width: usize) -> Self {
        let bitmap = Bitmap::new(width, BAND_ROWS as usize);
        let parts = vec![P::WHOLE; width * BAND_ROWS as usize];
        ClipBand { width, full: bitmap.clone(), part: bitmap, parts }
    }

    /// Where in a partly covered pixel the clip is.
    pub fn part(&self, row: usize, x: usize) -> P {
        self.parts[row * self.width + x]
    }

    /// Adds pixels [from, to) of a row.
    fn unite_whole(&mut self, row: usize, from: usize, to: usize) {
        for (word, mask) in word_masks(from, to) {
            self.full.row_mut(row)[word] |= mask;
            self.part.row_mut(row)[word] &= !mask;
        }
    }

    /// Adds a part of one pixel.
    fn unite_part(&mut self, row: usize, x: usize, part: P, parts: &mut impl Parts<Part = P>) {
        let at = row * self.width + x;
        if self.part.get(row, x) {
            self.parts[at] = parts.either(self.parts[at], part);
        } else if !self.full.get(row, x) {
            self.part.set(row, x);
            self.parts[at] = part;
        }
    }

    /// Keeps what lies in the other as well.
    pub fn intersect(&mut self, other: &Self, parts: &mut impl Parts<Part = P>) {
        for row in 0..BAND_ROWS as usize {
            for word in 0..self.full.row(row).len() {
                let (full, part) = (self.full.row(row)[word], self.part.row(row)[word]);
                let (other_full, other_part) = (other.full.row(row)[word], other.part.row(row)[word]);
                for_runs(part & other_part, |a, b| {
                    for at in row * self.width + word * 64 + a..row * self.width + word * 64 + b {
                        self.parts[at] = parts.both(self.parts[at], other.parts[at]);
                    }
                });
                for_runs(full & other_part, |a, b| {
                    let range = row * self.width + word * 64 + a..row * self.width + word * 64 + b;
                    self.parts[range.clone()].copy_from_slice(&other.parts[range]);
                });
                self.full.row_mut(row)[word] = full & other_full;
                self.part.row_mut(row)[word] = (part & (other_full | other_part)) | (full & other_part);
            }
        }
    }
}

/// Takes what is left of a row's spans.
pub(crate) trait TakeClipped<A: Parts> {
    /// Pixels [from, to) as a whole.
    fn whole(&mut self, from: usize, to: usize);

    /// A part of pixel `x`.
    fn part(&mut self, x: usize, part: A::Part, parts: &mut A);
}

/// Clips the spans of a row.
pub(crate) struct Clipping<'a, P, T> {
    pub row: usize,
    pub clip: Option<&'a ClipBand<P>>,
    pub take: T,
}

impl<A: Parts, T: TakeClipped<A>> TakeSpans<A> for Clipping<'_, A::Part, T> {
    #[inline(always)]
    fn solid(&mut self, from: usize, to: usize, parts: &mut A) {
        match self.clip {
            None => self.take.whole(from, to),
            Some(clip) => clip.clip_solid(self.row, (from, to), &mut self.take, parts),
        }
    }

    #[inline(always)]
    fn part(&mut self, x: usize, fragment: A::Fragment, parts: &mut A) {
        let Some(clip) = self.clip else {
            let part = parts.keep(fragment);
            return self.take.part(x, part, parts);
        };
        if clip.full.get(self.row, x) {
            let part = parts.keep(fragment);
            self.take.part(x, part, parts);
        } else if clip.part.get(self.row, x) {
            let part = parts.keep(fragment);
            let part = parts.both(part, clip.part(self.row, x));
            self.take.part(x, part, parts);
        }
    }
}

impl<P: Part> ClipBand<P> {
    fn clip_solid<A: Parts<Part = P>>(
        &self,
        row: usize,
        (from, to): (usize, usize),
        take: &mut impl TakeClipped<A>,
        parts: &mut A,
    ) {
        for (word, mask) in word_masks(from, to) {
            for_runs(mask & self.full.row(row)[word], |a, b| take.whole(word * 64 + a, word * 64 + b));
            for_runs(mask & self.part.row(row)[word], |a, b| {
                for x in word * 64 + a..word * 64 + b {
                    take.part(x, self.part(row, x), parts);
                }
            });
        }
    }
}

/// Unites what it is given with a clip.
pub(crate) struct Uniting<'a, P> {
    pub row: usize,
    pub clip: &'a mut ClipBand<P>,
}

impl<A: Parts> TakeClipped<A> for Uniting<'_, A::Part> {
    fn whole(&mut self, from: usize, to: usize) {
        self.clip.unite_whole(self.row, from, to);
    }

    fn part(&mut self, x: usize, part: A::Part, parts: &mut A) {
        self.clip.unite_part(self.row, x, part, parts);
    }
}
