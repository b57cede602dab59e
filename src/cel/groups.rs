//! Puts cels together: takes a group that is complete, or the two parts of one, and paints it behind all
//! that was painted before in the cel around it.
//!
//! A pixel that is uniform in all parts stays uniform; another one becomes a z-list with the group's
//! marks ([`crate::pixel::paint_tree`]).

use super::{Brush, Cel};
use crate::bitmap::{for_bits, for_runs, word_mask};
use crate::coverage::Part;
use crate::edges::BAND_ROWS;
use crate::pixel::paint_tree::{shown, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind, NO_ENTRY};
use usvg::MaskType;

impl Cel {
    /// Makes it the cel of what a mask shows: what is finished in `parent`, or hidden by the mask, needs
    /// nothing here. Without a mask all is hidden.
    pub fn open_behind_mask(&mut self, mask: Option<(&Cel, MaskType)>, parent: &Cel, opacity: f32) {
        self.open_in(parent, opacity);
        let Some((mask, kind)) = mask else {
            self.finished.bits_mut().fill(u64::MAX);
            return;
        };
        for (row, word) in mask.words(BAND_ROWS as usize) {
            self.finished.row_mut(row)[word] |= !mask.touched(row, word);
            let (_, uniform, _) = mask.states(row, word);
            mask.for_uniform((row, word), uniform, |from, to, sheet| {
                if shown(kind, sheet) <= 0.0 {
                    self.finished.row_mut(row)[word] |= word_mask(from, to);
                }
            });
        }
    }

    /// Takes a group whose content is painted over what will lie behind it.
    pub fn take_group<P: Part>(&mut self, group: &Cel, rows: usize, entries: &mut Vec<Entry<P>>) {
        let opacity = group.opacity;
        for (row, word) in self.words(rows) {
            let (_, uniform, listed) = group.states(row, word);
            group.for_uniform((row, word), uniform & !self.finished.row(row)[word], |from, to, sheet| {
                self.take_sheet((row, word), (from, to), sheet.faded(opacity), entries);
            });
            self.for_open((row, word), listed, |cel, x| {
                cel.append_group(x, Composite::faded(opacity), group, None, entries);
            });
        }
    }

    /// Takes a mask and what it masks.
    pub fn take_masked<P: Part>(
        &mut self,
        (mask, content): (&Cel, &Cel),
        kind: MaskType,
        rows: usize,
        entries: &mut Vec<Entry<P>>,
    ) {
        let opacity = content.opacity;
        let composite = Composite { opacity, effect: Effect::Mask(kind) };
        for (row, word) in self.words(rows) {
            let touched = mask.touched(row, word) & content.touched(row, word);
            let listed = touched & (mask.listed.row(row)[word] | content.listed.row(row)[word]);
            let uniform = touched & !listed & !self.finished.row(row)[word];
            mask.for_uniform((row, word), uniform, |a, b, mask| {
                let opacity = opacity * shown(kind, mask);
                content.sheets.for_runs((row, word), (a, b), |from, to, sheet| {
                    self.take_sheet((row, word), (from, to), sheet.faded(opacity), entries);
                });
            });
            self.for_open((row, word), listed, |cel, x| {
                cel.append_group(x, composite, mask, Some(content), entries);
            });
        }
    }

    /// Rows and words of as many rows.
    pub(super) fn words(&self, rows: usize) -> impl Iterator<Item = (usize, usize)> {
        let words = self.finished.words();
        (0..rows).flat_map(move |row| (0..words).map(move |word| (row, word)))
    }

    /// Calls `take` with each pixel of a word that is not finished: its row and its column.
    fn for_open(
        &mut self,
        (row, word): (usize, usize),
        pixels: u64,
        mut take: impl FnMut(&mut Cel, (usize, usize)),
    ) {
        for_runs(pixels & !self.finished.row(row)[word], |a, b| {
            (word * 64 + a..word * 64 + b).for_each(|x| take(self, (row, x)));
        });
    }

    /// Paints a sheet on pixels [a, b) of a word, none of them finished, behind all that was painted before.
    fn take_sheet<P: Part>(
        &mut self,
        (row, word): (usize, usize),
        (a, b): (usize, usize),
        sheet: Sheet,
        entries: &mut Vec<Entry<P>>,
    ) {
        let mask = word_mask(a, b);
        let (_, uniform, listed) = self.states(row, word);
        let start = row * self.width + word * 64;
        let mut done = if sheet.is_opaque() { mask } else { 0 };
        for_runs(mask & !(uniform | listed), |a, b| self.sheets.fill((row, word), (a, b), sheet));
        for_runs(mask & uniform, |a, b| {
            done |= self.sheets.put_behind((row, word), (a, b), sheet);
        });
        for_bits(mask & listed, |x| {
            self.append_whole(start + x, &Brush::flat(sheet), entries);
        });
        self.covered.row_mut(row)[word] |= mask & !listed;
        self.finished.row_mut(row)[word] |= done;
    }

    /// Appends a group with its marks to a pixel's list; `first` and then `second` are its parts.
    fn append_group<P: Part>(
        &mut self,
        (row, x): (usize, usize),
        composite: Composite,
        first: &Cel,
        second: Option<&Cel>,
        entries: &mut Vec<Entry<P>>,
    ) {
        let mut content = self.content(row, x);
        content.push(Kind::GroupStart(composite), entries);
        content.append(first.content(row, x), entries);
        if let Some(second) = second {
            content.push(Kind::GroupMiddle, entries);
            content.append(second.content(row, x), entries);
        }
        content.push(Kind::GroupEnd, entries);
        self.put((row, x), content);
    }

    /// What a pixel holds.
    #[inline]
    pub(super) fn content(&self, row: usize, x: usize) -> Content {
        let (first, last) = match self.listed.get(row, x) {
            true => self.lists[row * self.width + x],
            false => (NO_ENTRY, NO_ENTRY),
        };
        Content { sheet: self.front(row, x), first, last }
    }

    /// Makes this what a pixel holds.
    #[inline]
    pub(super) fn put(&mut self, (row, x): (usize, usize), content: Content) {
        self.listed.set(row, x);
        match content.sheet.is_same(Sheet::CLEAR) {
            true => self.covered.unset(row, x),
            false => {
                self.covered.set(row, x);
                self.sheets.set(row, x, content.sheet);
            }
        }
        self.lists[row * self.width + x] = (content.first, content.last);
    }
}

/// What a pixel holds: a sheet before a list.
#[derive(Clone, Copy)]
pub(super) struct Content {
    pub sheet: Sheet,
    pub first: u32,
    pub last: u32,
}

impl Content {
    pub fn of_sheet(sheet: Sheet) -> Content {
        Content { sheet, first: NO_ENTRY, last: NO_ENTRY }
    }

    /// Has it no list?
    pub fn is_uniform(&self) -> bool {
        self.first == NO_ENTRY
    }

    /// Appends one entry for the whole pixel to the list.
    #[inline]
    pub fn push<P: Part>(&mut self, kind: Kind, entries: &mut Vec<Entry<P>>) {
        self.push_part(P::WHOLE, kind, entries);
    }

    /// Appends one entry to the list.
    #[inline]
    pub fn push_part<P: Part>(&mut self, part: P, kind: Kind, entries: &mut Vec<Entry<P>>) {
        let at = entries.len() as u32;
        entries.push(Entry { next: NO_ENTRY, part, kind });
        self.link((at, at), entries);
    }

    /// This with something else behind it.
    #[inline]
    pub fn before<P: Part>(mut self, behind: Content, entries: &mut Vec<Entry<P>>) -> Content {
        self.append(behind, entries);
        self
    }

    /// Appends what another pixel holds. Its entries are taken over, not copied.
    #[inline]
    pub fn append<P: Part>(&mut self, other: Content, entries: &mut Vec<Entry<P>>) {
        if other.sheet != Sheet::CLEAR {
            self.push(Kind::Sheet(other.sheet), entries);
        }
        if !other.is_uniform() {
            self.link((other.first, other.last), entries);
        }
    }

    /// Appends a list.
    #[inline]
    fn link<P: Part>(&mut self, (first, last): (u32, u32), entries: &mut [Entry<P>]) {
        match entries.get_mut(self.last as usize) {
            None => self.first = first,
            Some(end) => end.next = first,
        }
        self.last = last;
    }
}
