//! Puts cels together: takes a group that is complete, or the two parts of one, and paints it behind all
//! that was painted before in the cel around it.
//!
//! A pixel that is uniform in all parts stays uniform; another one becomes a z-list with the group's
//! marks ([`crate::pixel::paint_tree`]).

use super::{Brush, Cel};
use crate::bitmap::for_runs;
use crate::coverage::Part;
use crate::pixel::paint_tree::{blended, shown, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind, NO_ENTRY};
use usvg::{BlendMode, MaskType};

impl Cel {
    /// Makes it the cel of what a mask shows: what is finished in `parent`, or hidden by the mask, needs
    /// nothing here. Without a mask all is hidden.
    pub fn open_behind_mask(&mut self, mask: Option<(&Cel, MaskType)>, parent: &Cel, opacity: f32) {
        self.open_in(parent, opacity);
        let Some((mask, kind)) = mask else {
            self.finished.bits_mut().fill(u64::MAX);
            return;
        };
        for (finished, shows) in self.finished.bits_mut().iter_mut().zip(mask.touched.bits()) {
            *finished |= !shows;
        }
        for row in 0..mask.sheets.len() / mask.width {
            for word in 0..mask.touched.words() {
                let uniform = mask.touched.row(row)[word] & !mask.listed.row(row)[word];
                let mut hidden = 0;
                for_runs(uniform, |a, b| {
                    let sheets = &mask.sheets[row * mask.width + word * 64..];
                    for (i, &sheet) in sheets[a..b].iter().enumerate() {
                        hidden |= u64::from(shown(kind, sheet) <= 0.0) << (a + i);
                    }
                });
                self.finished.row_mut(row)[word] |= hidden;
            }
        }
    }

    /// Takes a group whose content is painted over what will lie behind it.
    pub fn take_group<P: Part>(&mut self, group: &Cel, rows: usize, entries: &mut Vec<Entry<P>>) {
        let opacity = group.opacity;
        let mut fade = remembered(move |sheet, _| sheet.faded(opacity));
        for (row, word) in self.words(rows) {
            let (touched, listed) = (group.touched.row(row)[word], group.listed.row(row)[word]);
            let sheet = |at: usize| fade(group.sheets[at], Sheet::CLEAR);
            self.take_sheets((row, word), touched & !listed, sheet, entries);
            self.for_open((row, word), touched & listed, |cel, x| {
                cel.append_group(x, Composite::faded(opacity), group, None, entries);
            });
        }
    }

    /// Takes a group that is blended with whatever will be painted in this cel from now on.
    pub fn take_source<P: Part>(
        &mut self,
        source: &Cel,
        mode: BlendMode,
        rows: usize,
        entries: &mut Vec<Entry<P>>,
    ) {
        let composite = Composite { opacity: source.opacity, effect: Effect::Blend(mode) };
        for (row, word) in self.words(rows) {
            self.for_open((row, word), source.touched.row(row)[word], |cel, x| {
                cel.append_group(x, composite, source, None, entries);
            });
        }
    }

    /// Takes a blended group and all that lies behind it here; `background` is what will be put behind
    /// that, if it is part of the backdrop. The work is done in the backdrop, which then changes places
    /// with this cel: it costs only where the source, or something before it, is.
    pub fn take_blended<P: Part>(
        &mut self,
        source: &Cel,
        backdrop: &mut Cel,
        mode: BlendMode,
        background: Sheet,
        rows: usize,
        entries: &mut Vec<Entry<P>>,
    ) {
        let opacity = source.opacity;
        let composite = Composite { opacity, effect: Effect::Blend(mode) };
        let mut blend = remembered(|source, behind| blended(mode, source.faded(opacity), behind, background));
        for (row, word) in self.words(rows) {
            let (touched, behind) = (source.touched.row(row)[word], backdrop.touched.row(row)[word]);
            let listed = touched & (source.listed.row(row)[word] | (behind & backdrop.listed.row(row)[word]));
            let start = row * self.width + word * 64;
            for_runs(touched & !listed, |a, b| {
                for i in a..b {
                    let sheet = if behind >> i & 1 != 0 { backdrop.sheets[start + i] } else { Sheet::CLEAR };
                    backdrop.sheets[start + i] = blend(source.sheets[start + i], sheet);
                }
            });
            for_runs(listed, |a, b| {
                for x in word * 64 + a..word * 64 + b {
                    let content = backdrop.content(row, x);
                    backdrop.touched.row_mut(row)[word] &= !(1 << (x % 64));
                    backdrop.start_empty_list(row, x);
                    backdrop.append_group((row, x), composite, source, None, entries);
                    backdrop.append_content((row, x), content, entries);
                }
            });
            backdrop.touched.row_mut(row)[word] |= touched;
            backdrop.put_behind(self, (row, word), entries);
        }
        backdrop.opacity = self.opacity;
        std::mem::swap(self, backdrop);
    }

    /// Puts what this cel holds behind what `front` does, in a word.
    fn put_behind<P: Part>(&mut self, front: &Cel, (row, word): (usize, usize), entries: &mut Vec<Entry<P>>) {
        let before = front.touched.row(row)[word];
        if before == 0 {
            return;
        }
        let touched = self.touched.row(row)[word];
        let listed = before & (front.listed.row(row)[word] | (touched & self.listed.row(row)[word]));
        let start = row * self.width + word * 64;
        for_runs(before & !listed, |a, b| {
            for i in a..b {
                let sheet = if touched >> i & 1 != 0 { self.sheets[start + i] } else { Sheet::CLEAR };
                self.sheets[start + i] = front.sheets[start + i].over(sheet);
            }
        });
        for_runs(listed, |a, b| {
            for x in word * 64 + a..word * 64 + b {
                let content = self.content(row, x);
                self.touched.row_mut(row)[word] &= !(1 << (x % 64));
                self.start_empty_list(row, x);
                self.append_content((row, x), front.content(row, x), entries);
                self.append_content((row, x), content, entries);
            }
        });
        self.touched.row_mut(row)[word] |= before;
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
        let mut fade = remembered(move |mask, sheet| sheet.faded(opacity * shown(kind, mask)));
        for (row, word) in self.words(rows) {
            let touched = mask.touched.row(row)[word] & content.touched.row(row)[word];
            let listed = touched & (mask.listed.row(row)[word] | content.listed.row(row)[word]);
            let sheet = |at: usize| fade(mask.sheets[at], content.sheets[at]);
            self.take_sheets((row, word), touched & !listed, sheet, entries);
            self.for_open((row, word), listed, |cel, x| {
                cel.append_group(x, composite, mask, Some(content), entries);
            });
        }
    }

    /// Rows and words of as many rows.
    fn words(&self, rows: usize) -> impl Iterator<Item = (usize, usize)> {
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

    /// Paints pixels of a word that are uniform where they come from, behind all that was painted before.
    fn take_sheets<P: Part>(
        &mut self,
        (row, word): (usize, usize),
        pixels: u64,
        mut sheet: impl FnMut(usize) -> Sheet,
        entries: &mut Vec<Entry<P>>,
    ) {
        let open = pixels & !self.finished.row(row)[word];
        if open == 0 {
            return;
        }
        let (touched, listed) = (self.touched.row(row)[word], self.listed.row(row)[word]);
        let start = row * self.width + word * 64;
        let mut done = 0;
        for_runs(open & !touched, |a, b| {
            for i in a..b {
                let behind = sheet(start + i);
                self.sheets[start + i] = behind;
                done |= u64::from(behind.is_opaque()) << i;
            }
        });
        self.touched.row_mut(row)[word] |= open;
        for_runs(open & touched & !listed, |a, b| {
            for i in a..b {
                let all = self.sheets[start + i].over(sheet(start + i));
                self.sheets[start + i] = all;
                done |= u64::from(all.through() < super::NEGLIGIBLE) << i;
            }
        });
        for_runs(open & touched & listed, |a, b| {
            for i in a..b {
                let behind = sheet(start + i);
                self.append_whole(start + i, &Brush::flat(behind), entries);
                done |= u64::from(behind.is_opaque()) << i;
            }
        });
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
        self.append_mark((row, x), Kind::GroupStart(composite), entries);
        self.append_content((row, x), first.content(row, x), entries);
        if let Some(second) = second {
            self.append_mark((row, x), Kind::GroupMiddle, entries);
            self.append_content((row, x), second.content(row, x), entries);
        }
        self.append_mark((row, x), Kind::GroupEnd, entries);
    }

    fn append_mark<P: Part>(&mut self, (row, x): (usize, usize), kind: Kind, entries: &mut Vec<Entry<P>>) {
        if !self.listed.get(row, x) {
            self.start_empty_list(row, x);
        }
        self.append(row * self.width + x, Entry { next: NO_ENTRY, part: P::WHOLE, kind }, entries);
    }

    fn start_empty_list(&mut self, row: usize, x: usize) {
        self.start_list(row, x);
        self.lists[row * self.width + x] = (NO_ENTRY, NO_ENTRY);
    }

    /// What a pixel holds.
    fn content(&self, row: usize, x: usize) -> Content {
        let pixel = row * self.width + x;
        if !self.touched.get(row, x) {
            return Content { sheet: Sheet::CLEAR, first: NO_ENTRY, last: NO_ENTRY };
        }
        let (first, last) = if self.listed.get(row, x) { self.lists[pixel] } else { (NO_ENTRY, NO_ENTRY) };
        Content { sheet: self.sheets[pixel], first, last }
    }

    /// Appends what another pixel holds. Its entries are taken over, not copied.
    fn append_content<P: Part>(
        &mut self,
        (row, x): (usize, usize),
        content: Content,
        entries: &mut Vec<Entry<P>>,
    ) {
        if content.sheet != Sheet::CLEAR {
            self.append_mark((row, x), Kind::Sheet(content.sheet), entries);
        }
        if content.first == NO_ENTRY {
            return;
        }
        if !self.listed.get(row, x) {
            self.start_empty_list(row, x);
        }
        let list = &mut self.lists[row * self.width + x];
        match list {
            (NO_ENTRY, _) => list.0 = content.first,
            (_, last) => entries[*last as usize].next = content.first,
        }
        list.1 = content.last;
    }
}

/// What a pixel holds: a sheet before a list.
#[derive(Clone, Copy)]
struct Content {
    sheet: Sheet,
    first: u32,
    last: u32,
}

/// A function of two sheets that remembers its last result: neighbours are often the same.
fn remembered(mut make: impl FnMut(Sheet, Sheet) -> Sheet) -> impl FnMut(Sheet, Sheet) -> Sheet {
    let mut last = None;
    move |one, other| match last {
        Some((a, b, made)) if one.is_same(a) && other.is_same(b) => made,
        _ => {
            let made = make(one, other);
            last = Some((one, other, made));
            made
        }
    }
}
