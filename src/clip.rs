//! Takes a clip's members, makes for each pixel of a band whether it lies inside, outside, or partly.
//!
//! A clip is no mask of shares: where its border runs through a pixel it takes part in that pixel's
//! z-list as the fragment it is, so a clip beside its complement leaves no seam.

use crate::bitmap::{for_runs, word_masks, Bitmap};
use crate::coverage::{Part, Parts, Span};
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

    /// Adds a span of a member, as far as it lies in the member's own clip.
    pub fn unite<A: Parts<Part = P>>(
        &mut self,
        row: usize,
        span: Span<A::Fragment>,
        within: Option<&Self>,
        parts: &mut A,
    ) {
        let mut unite = |piece, parts: &mut A| match piece {
            Clipped::Whole(from, to) => {
                for (word, mask) in word_masks(from, to) {
                    self.full.row_mut(row)[word] |= mask;
                    self.part.row_mut(row)[word] &= !mask;
                }
            }
            Clipped::Part(x, part) => {
                let at = row * self.width + x;
                if self.part.get(row, x) {
                    self.parts[at] = parts.either(self.parts[at], part);
                } else if !self.full.get(row, x) {
                    self.part.set(row, x);
                    self.parts[at] = part;
                }
            }
        };
        match (span, within) {
            (span, Some(within)) => clipped(row, span, within, parts, unite),
            (Span::Solid(from, to), None) => unite(Clipped::Whole(from, to), parts),
            (Span::Part(x, fragment), None) => {
                let part = parts.keep(fragment);
                unite(Clipped::Part(x, part), parts);
            }
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

/// A span after clipping.
#[derive(Clone, Copy)]
pub(crate) enum Clipped<P> {
    /// Pixels [from, to) as a whole.
    Whole(usize, usize),
    /// A part of one pixel.
    Part(usize, P),
}

/// Clips a span of a row, and gives `take` what is left of it.
#[inline(always)]
pub(crate) fn clipped<A: Parts>(
    row: usize,
    span: Span<A::Fragment>,
    clip: &ClipBand<A::Part>,
    parts: &mut A,
    mut take: impl FnMut(Clipped<A::Part>, &mut A),
) {
    match span {
        Span::Solid(from, to) => {
            for (word, mask) in word_masks(from, to) {
                for_runs(mask & clip.full.row(row)[word], |a, b| {
                    take(Clipped::Whole(word * 64 + a, word * 64 + b), parts);
                });
                for_runs(mask & clip.part.row(row)[word], |a, b| {
                    for x in word * 64 + a..word * 64 + b {
                        take(Clipped::Part(x, clip.part(row, x)), parts);
                    }
                });
            }
        }
        Span::Part(x, fragment) => {
            if clip.full.get(row, x) {
                let part = parts.keep(fragment);
                take(Clipped::Part(x, part), parts);
            } else if clip.part.get(row, x) {
                let part = parts.keep(fragment);
                let part = parts.both(part, clip.part(row, x));
                take(Clipped::Part(x, part), parts);
            }
        }
    }
}
