//! `mask` and `mask64`: Carpenter's A-buffer (*The A-buffer, an Antialiased Hidden Surface Method*,
//! SIGGRAPH 1984). A fragment is a set of 16 or 64 samples of its pixel.
//!
//! No pieces are kept: each edge adds its winding to the samples right of it in its own pixel, and to
//! all of its heights in the pixels further right. The sweep runs over those sums from left to right;
//! solid runs, z-lists and clips are as in the exact method.
//!
//! Promises: where two shapes share a border every sample beside it belongs to exactly one of them.

use super::lattice::Lattice;
use super::sets::{self, Sets};
use super::tally::{Tally, Windings};
use crate::band::Picture;
use crate::bitmap::Bitmap;
use crate::coverage::{BandPlace, Coverage, Style, TakeSpans};
use crate::edges::{Edge, ONE};
use crate::pixel::resolve::Surroundings;
use crate::scene::FillRule;
use crate::strips::{clip_edge, Bins, Buckets, CrossesLeft};
use crate::zlist::{Entry, Head};

/// A point of the pixel in fixed point.
pub(crate) type Probe = (i32, i32);

/// The pixel's centre.
pub(crate) const CENTRE: Probe = (ONE / 2, ONE / 2);

/// Fragments as sets of samples.
pub(crate) struct Masks<B> {
    buckets: Buckets<Cell<B>, Windings<B>>,
    carries: Vec<Carry<B>>,
    parts: Sets<B>,
    /// The one point that is asked for in place of all samples.
    probe: Option<Probe>,
}

/// What a shape's edges add to the windings of one pixel and those right of it.
#[derive(Clone, Copy, Debug, Default)]
struct Cell<B> {
    here: Tally<B>,
    beyond: Tally<B>,
    /// The last of its carries, counted from 1; 0 when there are none.
    carries: u32,
}

/// What does not fit in a cell: twice a sign for the samples of a set.
#[derive(Clone, Copy, Debug)]
struct Carry<B> {
    set: B,
    sign: i32,
    here: bool,
    next: u32,
}

impl<B: Lattice> Masks<B> {
    pub fn new(width: u32) -> Self {
        Masks { buckets: Buckets::new(width), carries: Vec::new(), parts: Sets::default(), probe: None }
    }

    /// With one sample a pixel, at this point; crisp shapes stay with the centre.
    pub fn at(width: u32, probe: Probe) -> Self {
        Masks { probe: Some(probe), ..Masks::new(width) }
    }

    /// Has one sample a pixel from now on, at this point.
    pub fn look_at(&mut self, probe: Probe) {
        self.probe = Some(probe);
    }
}

impl<B: Lattice> Coverage for Masks<B> {
    type Parts = Sets<B>;

    fn start(&mut self, _: &Picture) {
        self.carries.clear();
    }

    fn parts(&mut self) -> &mut Sets<B> {
        &mut self.parts
    }

    #[inline(always)]
    fn add(&mut self, edge: &Edge, place: BandPlace, style: Style, finished: &Bitmap) {
        let width = self.buckets.width();
        let (buckets, carries) = (&mut self.buckets, &mut self.carries);
        match if style.crisp { Some(CENTRE) } else { self.probe } {
            None => clip_edge(edge, place, width, &mut Filer { buckets, carries, finished, sampler: Every }),
            Some(at) => clip_edge(edge, place, width, &mut Filer { buckets, carries, finished, sampler: at }),
        }
    }

    #[inline(always)]
    fn row(
        &mut self,
        row: usize,
        columns: (usize, usize),
        _: BandPlace,
        style: Style,
        take: &mut impl TakeSpans<Sets<B>>,
    ) {
        let Masks { buckets, carries, parts, .. } = self;
        let rule = style.rule;
        let mut left = buckets.take_left(row);
        let mut runs = Runs { open: None, parts, take };
        // Up to here all is given out, and from here on the windings are as on the left.
        let mut from = 0;
        let mut set = left.inside(rule);
        buckets.drain_row(row, columns, |x, cell| {
            if from < x {
                runs.give(from, x, set);
            }
            runs.give(x, x + 1, cell.pass(&mut left, rule, carries));
            set = left.inside(rule);
            from = x + 1;
        });
        let width = buckets.width();
        if from < width {
            runs.give(from, width, set);
        }
        runs.end(width);
    }

    #[inline]
    fn resolve(
        &mut self,
        head: Head,
        entries: &mut [Entry<B>],
        at: (u32, u32),
        around: &Surroundings,
    ) -> [u8; 4] {
        sets::resolve(head, entries, B::ALL, B::middle, at, around)
    }
}

impl<B: Lattice> Cell<B> {
    /// The samples inside, where these windings come from the left; they become those that go on to the
    /// right.
    #[inline]
    fn pass(self, left: &mut Windings<B>, rule: FillRule, carries: &[Carry<B>]) -> B {
        if self.carries == 0 {
            if let Some(low) = left.one_digit() {
                left.add_tally(self.beyond);
                return low.inside_of_sum(self.here, rule);
            }
        }
        self.pass_digits(left, rule, carries)
    }

    #[cold]
    fn pass_digits(self, left: &mut Windings<B>, rule: FillRule, carries: &[Carry<B>]) -> B {
        let mut here = left.clone();
        here.add_tally(self.here);
        left.add_tally(self.beyond);
        let mut next = self.carries;
        while next != 0 {
            let carry = carries[next as usize - 1];
            if carry.here { &mut here } else { &mut *left }.carry(carry.set, carry.sign);
            next = carry.next;
        }
        here.inside(rule)
    }
}

/// Joins pixels to runs.
struct Runs<'a, A, T> {
    /// Where a solid run begins that may go on.
    open: Option<usize>,
    parts: &'a mut A,
    take: &'a mut T,
}

impl<B: Lattice, T: TakeSpans<Sets<B>>> Runs<'_, Sets<B>, T> {
    /// The pixels [from, to) have all this set; they follow those given before.
    #[inline]
    fn give(&mut self, from: usize, to: usize, set: B) {
        if set == B::ALL {
            self.open.get_or_insert(from);
            return;
        }
        if let Some(start) = self.open.take() {
            self.take.solid(start, from, self.parts);
        }
        if set != B::NONE {
            for x in from..to {
                self.take.part(x, set, self.parts);
            }
        }
    }

    /// The row ends here.
    fn end(self, width: usize) {
        if let Some(start) = self.open {
            self.take.solid(start, width, self.parts);
        }
    }
}

/// Which samples an edge's part of a pixel concerns.
trait Sampler<B> {
    /// Those at heights [y0, y1).
    fn rows(&self, y0: i32, y1: i32) -> B;

    /// Those right of a line, for these rows.
    fn right_of(&self, ends: [i32; 4]) -> B;
}

/// All samples of the pattern.
struct Every;

impl<B: Lattice> Sampler<B> for Every {
    #[inline(always)]
    fn rows(&self, y0: i32, y1: i32) -> B {
        B::rows(y0, y1)
    }

    #[inline(always)]
    fn right_of(&self, ends: [i32; 4]) -> B {
        B::right_of(ends)
    }
}

/// One point stands for all.
impl<B: Lattice> Sampler<B> for Probe {
    fn rows(&self, y0: i32, y1: i32) -> B {
        if (y0..y1).contains(&self.1) {
            B::ALL
        } else {
            B::NONE
        }
    }

    fn right_of(&self, [x0, y0, x1, y1]: [i32; 4]) -> B {
        if (x1 - x0) * (self.1 - y0) <= (self.0 - x0) * (y1 - y0) {
            B::ALL
        } else {
            B::NONE
        }
    }
}

/// Files what edges add to windings.
struct Filer<'a, B, S> {
    buckets: &'a mut Buckets<Cell<B>, Windings<B>>,
    carries: &'a mut Vec<Carry<B>>,
    finished: &'a Bitmap,
    sampler: S,
}

impl<B: Lattice, S: Sampler<B>> Bins for Filer<'_, B, S> {
    #[inline(always)]
    fn finished(&self) -> &Bitmap {
        self.finished
    }

    #[inline]
    fn left_of_picture(&mut self, row: usize, (y0, y1): (i32, i32), winding: i32) {
        self.buckets.left_mut(row).add(self.sampler.rows(y0, y1), winding);
    }

    #[inline(always)]
    fn put(&mut self, row: usize, pixel: usize, ends: [i32; 4], winding: i32, _: CrossesLeft) {
        let rows = self.sampler.rows(ends[1], ends[3]);
        if rows == B::NONE {
            return;
        }
        let (cell, is_finished) = self.buckets.touch(row, pixel, self.finished);
        let beyond = cell.beyond.add(rows, winding);
        let here = match is_finished {
            true => B::NONE,
            false => cell.here.add(rows & self.sampler.right_of(ends), winding),
        };
        if (here | beyond) != B::NONE {
            keep_carries(self.carries, cell, here, beyond, winding);
        }
    }
}

#[cold]
fn keep_carries<B: Lattice>(carries: &mut Vec<Carry<B>>, cell: &mut Cell<B>, here: B, beyond: B, sign: i32) {
    for (set, here) in [(here, true), (beyond, false)] {
        if set != B::NONE {
            carries.push(Carry { set, sign, here, next: cell.carries });
            cell.carries = carries.len() as u32;
        }
    }
}
