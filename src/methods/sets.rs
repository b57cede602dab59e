//! Sets of samples in a pixel, one bit each; as parts of a z-list they combine by logic, and a list of
//! them resolves front to back.
//!
//! Carpenter's A-buffer (*The A-buffer*, SIGGRAPH 1984, section 5, "packing") goes down a list with the
//! mask of what is still to be filled, and where a fragment lets light through, does so once for what
//! the fragment covers and once for what it leaves. [`resolve`] does the same from the other end: it
//! asks for the colour of one sample, keeps the set of those that had the same answer at every entry,
//! and goes on with what remains.

use crate::coverage::{Part, Parts};
use crate::pixel::fragment::PIXEL_AREA;
use crate::pixel::paint_tree::PaintTree;
use crate::pixel::resolve::{Mean, Surroundings};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Head, Kind};
use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::{BitAnd, BitOr, BitXor, Not};

/// A set of samples.
pub(crate) trait Bits:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
{
    const NONE: Self;
    const ALL: Self;

    fn count(self) -> u32;

    /// The first sample in it; there is one.
    fn first(self) -> u32;

    fn has(self, sample: u32) -> bool;

    /// Those of the first `count` samples for which it is so.
    fn where_true(count: usize, is_in: impl Fn(usize) -> bool) -> Self;
}

macro_rules! bits_of_a_word {
    ($word:ty) => {
        impl Bits for $word {
            const NONE: $word = 0;
            const ALL: $word = <$word>::MAX;

            #[inline]
            fn count(self) -> u32 {
                self.count_ones()
            }

            #[inline]
            fn first(self) -> u32 {
                self.trailing_zeros()
            }

            #[inline]
            fn has(self, sample: u32) -> bool {
                self >> sample & 1 != 0
            }

            #[inline]
            fn where_true(count: usize, is_in: impl Fn(usize) -> bool) -> $word {
                (0..count).fold(0, |set, i| set | <$word>::from(is_in(i)) << i)
            }
        }
    };
}

bits_of_a_word!(u16);
bits_of_a_word!(u64);

/// A set of up to 64 * W samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Words<const W: usize>(pub [u64; W]);

impl<const W: usize> Default for Words<W> {
    fn default() -> Self {
        Words::NONE
    }
}

macro_rules! word_by_word {
    ($trait:ident, $method:ident) => {
        impl<const W: usize> $trait for Words<W> {
            type Output = Self;

            #[inline]
            fn $method(self, other: Self) -> Self {
                Words(std::array::from_fn(|i| self.0[i].$method(other.0[i])))
            }
        }
    };
}

word_by_word!(BitAnd, bitand);
word_by_word!(BitOr, bitor);
word_by_word!(BitXor, bitxor);

impl<const W: usize> Not for Words<W> {
    type Output = Self;

    #[inline]
    fn not(self) -> Self {
        Words(self.0.map(|word| !word))
    }
}

impl<const W: usize> Bits for Words<W> {
    const NONE: Self = Words([0; W]);
    const ALL: Self = Words([u64::MAX; W]);

    fn count(self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    fn first(self) -> u32 {
        let word = self.0.iter().position(|&word| word != 0).expect("the set is not empty");
        word as u32 * 64 + self.0[word].trailing_zeros()
    }

    fn has(self, sample: u32) -> bool {
        self.0[sample as usize / 64] >> (sample % 64) & 1 != 0
    }

    fn where_true(count: usize, is_in: impl Fn(usize) -> bool) -> Self {
        Words(std::array::from_fn(|word| {
            let first = word * 64;
            u64::where_true(count.saturating_sub(first).min(64), |i| is_in(first + i))
        }))
    }
}

impl<B: Bits> Part for B {
    const WHOLE: B = B::ALL;
}

/// Sets need no keeping: a part is the set itself, and clipping is a logical operation.
#[derive(Default)]
pub(crate) struct Sets<B>(PhantomData<B>);

impl<B: Bits> Parts for Sets<B> {
    type Fragment = B;
    type Part = B;

    #[inline]
    fn keep(&mut self, fragment: B) -> B {
        fragment
    }

    fn both(&mut self, a: B, b: B) -> B {
        a & b
    }

    fn either(&mut self, a: B, b: B) -> B {
        a | b
    }
}

/// The colour of a pixel whose samples are `all`; `middle` gives the mean place of some of them, within
/// the pixel. Every sample weighs the same, and the weights sum exactly to the pixel.
#[inline]
pub(crate) fn resolve<B: Bits>(
    head: Head,
    entries: &[Entry<B>],
    all: B,
    middle: impl Fn(B) -> (f64, f64),
    at: (u32, u32),
    around: &Surroundings,
) -> [u8; 4] {
    let mut shares = Shares { mean: Mean::default(), done: 0, spent: 0, count: all.count().into() };
    let mut remaining = all;
    let mut next = head.first;
    // As long as nothing is seen behind fragments, and they are of one colour, each has what those before it left.
    while let Some(entry) = entries.get(next as usize) {
        let sheet = match entry.kind {
            Kind::Sheet(sheet) if sheet.is_opaque() => sheet,
            Kind::Knockout(sheet) => sheet.over(around.background),
            _ => {
                let rest = Head { front: head.front, first: next };
                resolve_rest(rest, entries, remaining, middle, at, around, &mut shares);
                return shares.mean.to_rgba8(around.linear);
            }
        };
        let seen = remaining & entry.part;
        if seen != B::NONE {
            shares.add(head.front.over(sheet), seen.count(), around);
            remaining = remaining & !seen;
            if remaining == B::NONE {
                break;
            }
        }
        next = entry.next;
    }
    if remaining != B::NONE {
        shares.add(head.front.over(around.background), remaining.count(), around);
    }
    shares.mean.to_rgba8(around.linear)
}

/// Any list, as seen by the samples that remain.
#[inline(never)]
fn resolve_rest<B: Bits>(
    head: Head,
    entries: &[Entry<B>],
    mut remaining: B,
    middle: impl Fn(B) -> (f64, f64),
    (x, y): (u32, u32),
    around: &Surroundings,
    shares: &mut Shares,
) {
    while remaining != B::NONE {
        let mut region = remaining;
        let list = Composer { head, entries, around, sample: remaining.first() };
        let (mut sheet, has_gradient) = list.compose(&mut region, None);
        if has_gradient {
            // They stood in for themselves until it was known where they are asked for.
            let (dx, dy) = middle(region);
            sheet = list.compose(&mut region, Some((f64::from(x) + dx, f64::from(y) + dy))).0;
        }
        shares.add(sheet, region.count(), around);
        remaining = remaining & !region;
    }
}

/// Colours, weighted by how many samples see them.
struct Shares {
    mean: Mean,
    /// Samples so far, and the area they took.
    done: i64,
    spent: i64,
    /// All samples.
    count: i64,
}

impl Shares {
    #[inline]
    fn add(&mut self, sheet: Sheet, samples: u32, around: &Surroundings) {
        self.done += i64::from(samples);
        // A division that is exact for powers of two; else the areas round to the nearest below, and sum
        // to the pixel all the same.
        let area = match self.count.count_ones() {
            1 => (PIXEL_AREA >> self.count.trailing_zeros()) * self.done,
            _ => PIXEL_AREA * self.done / self.count,
        };
        self.mean.add(sheet, area - self.spent, around.linear);
        self.spent = area;
    }
}

/// Looks down on one sample.
struct Composer<'a, B> {
    head: Head,
    entries: &'a [Entry<B>],
    around: &'a Surroundings<'a>,
    sample: u32,
}

impl<B: Bits> Composer<'_, B> {
    /// The colour seen, and whether there is a gradient in it; `region` loses the samples for which it
    /// may be another. Gradients are taken at a point, in pixels. Without one they are opaque only if
    /// they are so everywhere, so that whatever could matter at some point is looked at.
    #[inline]
    fn compose(&self, region: &mut B, at: Option<(f64, f64)>) -> (Sheet, bool) {
        let mut tree = PaintTree::behind(self.head.front);
        let mut has_gradient = false;
        let mut next = self.head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            next = entry.next;
            match entry.kind {
                Kind::GroupStart(composite) => tree.start(composite),
                Kind::GroupMiddle => tree.middle(),
                Kind::GroupEnd => tree.end(),
                _ if tree.is_done() => break,
                _ if tree.is_hidden() => {}
                Kind::Blended(mode, source) => tree.blend(mode, source),
                _ if !entry.part.has(self.sample) => *region = *region & !entry.part,
                Kind::Sheet(sheet) => {
                    *region = *region & entry.part;
                    tree.paint(sheet);
                }
                Kind::Knockout(sheet) => {
                    *region = *region & entry.part;
                    tree.knock_out(sheet);
                }
                Kind::Gradient(shape) => {
                    *region = *region & entry.part;
                    has_gradient = true;
                    let shader =
                        self.around.shaders[shape as usize].as_ref().expect("gradients have shaders");
                    match at {
                        Some((x, y)) => tree.paint(shader.at(x, y)),
                        None => tree.paint_vaguely(shader.least()),
                    }
                }
            }
        }
        (tree.over(self.around.background), has_gradient)
    }
}
