//! Blended groups that wait for their backdrops: takes a group that is complete, keeps what it has on each
//! pixel, with what was painted there before it, until all that lies behind it in the group around it has
//! been painted; then puts the three together.
//!
//! A pixel on which a source waits becomes new: what is painted there next is the source's backdrop. Sources
//! wait in runs of pixels that are the same, so that they take room, and blending takes time, by what is
//! visible of them.
//!
//! Where each sheet of a z-list is all that is seen where it lies, blending makes of each another sheet, and
//! the list stays as short as it was however many sources are blended with it. Where borders of both cross it
//! becomes a list of what lies in both. Other lists get the marks of groups ([`crate::pixel::paint_tree`]).

use super::groups::{count_same, for_same, Content};
use super::Cel;
use crate::bitmap::{for_bits, for_runs, word_masks};
use crate::coverage::{Part, Parts};
use crate::pixel::paint_tree::{blended, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind, NO_ENTRY};
use usvg::BlendMode;

/// Sources that wait, the one at the front first.
#[derive(Default)]
pub(super) struct Waiting {
    sources: Vec<Source>,
    runs: Vec<Run>,
    pixels: Vec<Pixel>,
    /// A bit for each row in which a source waits.
    rows: u64,
    blends: Blends,
}

/// A source: its runs and pixels go from these to the next one's.
struct Source {
    mode: BlendMode,
    opacity: f32,
    first_run: usize,
    first_pixel: usize,
}

/// Pixels [from, to) of a row, uniform and the same.
struct Run {
    row: usize,
    from: usize,
    to: usize,
    /// What was painted before the source.
    before: Sheet,
    /// The source, with its opacity.
    source: Sheet,
}

/// A pixel with a z-list.
struct Pixel {
    at: (usize, usize),
    before: Content,
    source: Content,
}

impl Waiting {
    pub fn clear(&mut self) {
        self.sources.clear();
        self.runs.clear();
        self.pixels.clear();
        self.rows = 0;
    }

    /// Adds a run to the last source's, or goes on with the last run.
    fn push_run(&mut self, run: Run) {
        let first = self.sources.last().map_or(0, |source| source.first_run);
        if let Some(last) = self.runs[first..].last_mut() {
            let follows = last.row == run.row && last.to == run.from;
            if follows && last.source.is_same(run.source) && last.before.is_same(run.before) {
                last.to = run.to;
                return;
            }
        }
        self.runs.push(run);
    }
}

impl Cel {
    /// Does a source wait in this row, so that nothing painted here is what is seen in the end?
    #[inline]
    pub fn waits_in(&self, row: usize) -> bool {
        self.waiting.rows >> row & 1 != 0
    }

    /// Lets a group that is blended with whatever will be painted in this cel wait for it.
    pub fn suspend(&mut self, group: &Cel, mode: BlendMode, rows: usize) {
        let Waiting { runs, pixels, .. } = &self.waiting;
        let (opacity, first_run, first_pixel) = (group.opacity, runs.len(), pixels.len());
        self.waiting.sources.push(Source { mode, opacity, first_run, first_pixel });
        for (row, word) in self.words(rows) {
            let open = group.touched.row(row)[word] & !self.finished.row(row)[word];
            if open == 0 {
                continue;
            }
            let (touched, listed) = (self.touched.row(row)[word], self.listed.row(row)[word]);
            let with_lists = open & (group.listed.row(row)[word] | touched & listed);
            self.suspend_runs(group, (row, word), open & !with_lists);
            for_bits(with_lists, |x| {
                let x = word * 64 + x;
                let (before, source) = (self.content(row, x), group.content(row, x));
                self.waiting.pixels.push(Pixel { at: (row, x), before, source });
            });
            self.touched.row_mut(row)[word] &= !open;
            self.listed.row_mut(row)[word] &= !open;
            self.waiting.rows |= 1 << row;
        }
    }

    /// The same for pixels of a word that are uniform in both cels.
    fn suspend_runs(&mut self, group: &Cel, (row, word): (usize, usize), pixels: u64) {
        let touched = self.touched.row(row)[word];
        let start = row * self.width + word * 64;
        let Cel { waiting, sheets, .. } = self;
        let mut push = |from: usize, to: usize, before: Sheet, source: Sheet| {
            let source = source.faded(group.opacity);
            waiting.push_run(Run { row, from: word * 64 + from, to: word * 64 + to, before, source });
        };
        for_runs(pixels & !touched, |a, b| {
            for_same(&group.sheets[start + a..start + b], |from, to, source| {
                push(a + from, a + to, Sheet::CLEAR, source);
            });
        });
        for_runs(pixels & touched, |a, b| {
            for_same(&group.sheets[start + a..start + b], |from, to, source| {
                let (a, b) = (a + from, a + to);
                for_same(&sheets[start + a..start + b], |from, to, before| {
                    push(a + from, a + to, before, source);
                });
            });
        });
    }

    /// Blends all that wait with what lies behind them, which is complete; `background` is what will be put
    /// behind that, if it is part of the backdrop.
    pub fn resume<A: Parts>(&mut self, background: Sheet, parts: &mut A, entries: &mut Vec<Entry<A::Part>>) {
        let mut waiting = std::mem::take(&mut self.waiting);
        while let Some(Source { mode, opacity, first_run, first_pixel }) = waiting.sources.pop() {
            let blends = &mut waiting.blends;
            blends.start(mode, background);
            for run in waiting.runs.drain(first_run..) {
                self.resume_run(run, blends, entries);
            }
            for Pixel { at: (row, x), before, source } in waiting.pixels.drain(first_pixel..) {
                let behind = self.content(row, x);
                let blended = blends.of_lists((source, opacity), behind, parts, entries);
                self.put((row, x), before.before(blended, entries));
            }
        }
        waiting.rows = 0;
        self.waiting = waiting;
    }

    fn resume_run<P: Part>(
        &mut self,
        Run { row, from, to, before, source }: Run,
        blends: &mut Blends,
        entries: &mut Vec<Entry<P>>,
    ) {
        for (word, mask) in word_masks(from, to) {
            let touched = mask & self.touched.row(row)[word];
            let listed = touched & self.listed.row(row)[word];
            let start = row * self.width + word * 64;
            for_runs(mask & !touched, |a, b| {
                let sheet = before.over(blends.of(source, Sheet::CLEAR));
                self.sheets[start + a..start + b].fill(sheet);
            });
            for_runs(touched & !listed, |a, b| {
                let sheets = &mut self.sheets[start + a..start + b];
                let mut from = 0;
                while let Some(&behind) = sheets.get(from) {
                    let same = 1 + count_same(&sheets[from + 1..], behind);
                    sheets[from..from + same].fill(before.over(blends.of(source, behind)));
                    from += same;
                }
            });
            self.touched.row_mut(row)[word] |= mask;
            for_bits(listed, |x| {
                let at = (row, word * 64 + x);
                let blended = blends.before_list(source, self.content(at.0, at.1), entries);
                self.put(at, Content::of_sheet(before).before(blended, entries));
            });
        }
    }
}

/// Blends sources with backdrops, and remembers the last: from pixel to pixel and from row to row the same
/// come again.
struct Blends {
    mode: BlendMode,
    /// As for [`Cel::resume`].
    background: Sheet,
    /// Of the group: what was known under another is forgotten.
    number: u64,
    known: Vec<KnownBlend>,
}

#[derive(Clone, Copy)]
struct KnownBlend {
    number: u64,
    source: Sheet,
    behind: Sheet,
    blended: Sheet,
}

/// Blends that are remembered.
const KNOWN_BITS: u32 = 8;

impl Default for Blends {
    fn default() -> Blends {
        Blends { mode: BlendMode::Normal, background: Sheet::CLEAR, number: 0, known: Vec::new() }
    }
}

impl Blends {
    /// Goes on to sources of another group.
    fn start(&mut self, mode: BlendMode, background: Sheet) {
        let clear = Sheet::CLEAR;
        let nothing = KnownBlend { number: 0, source: clear, behind: clear, blended: clear };
        self.known.resize(1 << KNOWN_BITS, nothing);
        (self.mode, self.background) = (mode, background);
        self.number += 1;
    }

    /// The sheet that stands for a source, with its opacity, and what lies behind it.
    #[inline]
    fn of(&mut self, source: Sheet, behind: Sheet) -> Sheet {
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        let word = |sheet: Sheet| {
            let [r, g, b, through] = sheet.channels().map(|v| u64::from(v.to_bits()));
            (r | g << 32) ^ (b | through << 32).rotate_left(23)
        };
        let hash = (word(source).rotate_left(9) ^ word(behind)).wrapping_mul(FACTOR);
        let known = &mut self.known[(hash >> (64 - KNOWN_BITS)) as usize];
        let is_same =
            known.number == self.number && known.behind.is_same(behind) && known.source.is_same(source);
        if !is_same {
            let blended = blended(self.mode, source, behind, self.background);
            *known = KnownBlend { number: self.number, source, behind, blended };
        }
        known.blended
    }

    /// What stands for a source and what lies behind it, where one of them has a list.
    fn of_lists<A: Parts>(
        &mut self,
        (source, opacity): (Content, f32),
        behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        let own = |sheet| Sheet::CLEAR.over(sheet).faded(opacity);
        let hides = |sheet: Sheet| opacity >= 1.0 && sheet.is_opaque();
        if source.is_uniform() {
            return match behind.is_uniform() {
                true => Content::of_sheet(self.of(own(source.sheet), behind.sheet)),
                false => self.before_list(own(source.sheet), behind, entries),
            };
        }
        if behind.is_uniform() {
            let hides = |sheet| hides(sheet) || behind.sheet.is_opaque() && source.first == source.last;
            if source.plain_length(hides, entries).is_some() {
                return match source.repaint(|sheet| self.of(own(sheet), behind.sheet), entries) {
                    true => source,
                    false => source.before(behind, entries),
                };
            }
        }
        let lengths = (source.plain_length(hides, entries), behind.plain_length(Sheet::is_opaque, entries));
        if let (Some(a @ 1..), Some(b @ 1..)) = lengths {
            if (a + 1) * (b + 1) <= MOST_IN_BOTH {
                return self.of_plain_lists((source, opacity), behind, parts, entries);
            }
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        content.push(Kind::GroupStart(Composite { opacity, effect: Effect::Blend(self.mode) }), entries);
        content.append(source, entries);
        content.push(Kind::GroupEnd, entries);
        content.append(behind, entries);
        content
    }

    /// The same for plain lists: before the one behind comes what lies in both.
    fn of_plain_lists<A: Parts>(
        &mut self,
        (source, opacity): (Content, f32),
        behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        let whole = A::Part::WHOLE;
        let mut content = Content::of_sheet(Sheet::CLEAR);
        let mut covers = false;
        let mut next = source.first;
        while let Some(&Entry { next: after, part, kind: Kind::Sheet(sheet) }) = entries.get(next as usize) {
            let own = Sheet::CLEAR.over(sheet).faded(opacity);
            (next, covers) = (after, part == whole);
            let mut is_closed = false;
            let mut other = behind.first;
            while let Some(&Entry { next, part: within, kind: Kind::Sheet(behind) }) =
                entries.get(other as usize)
            {
                (other, is_closed) = (next, within == whole);
                let both = match (part, within) {
                    (part, within) if within == whole => part,
                    (part, within) if part == whole => within,
                    (part, within) => parts.both(part, within),
                };
                content.push_part(both, Kind::Sheet(self.of(own, behind)), entries);
            }
            if !is_closed {
                content.push_part(part, Kind::Sheet(self.of(own, Sheet::CLEAR)), entries);
            }
        }
        match covers {
            true => content,
            false => content.before(behind, entries),
        }
    }

    /// What stands for a uniform source, with its opacity, and a list behind it.
    fn before_list<P: Part>(
        &mut self,
        source: Sheet,
        mut behind: Content,
        entries: &mut Vec<Entry<P>>,
    ) -> Content {
        if behind.plain_length(Sheet::is_opaque, entries).is_some() {
            if !behind.repaint(|sheet| self.of(source, sheet), entries) {
                behind.push(Kind::Sheet(self.of(source, Sheet::CLEAR)), entries);
            }
            return behind;
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        content.push(Kind::Blended(self.mode, source), entries);
        content.before(behind, entries)
    }
}

/// Entries of a list of what lies in both of two.
const MOST_IN_BOTH: usize = 8;

/// Plain lists: each sheet is all that is seen where it lies and none of those before it does.
impl Content {
    /// The length of a plain list. `hides` tells of a sheet whether nothing behind it will be seen. What covers
    /// the whole pixel and comes last has nothing behind it.
    fn plain_length<P: Part>(&self, hides: impl Fn(Sheet) -> bool, entries: &[Entry<P>]) -> Option<usize> {
        let (mut next, mut length) = (self.first, 0);
        while let Some(entry) = entries.get(next as usize) {
            next = entry.next;
            match entry.kind {
                Kind::Sheet(sheet) if hides(sheet) || next == NO_ENTRY && entry.part == P::WHOLE => {
                    length += 1
                }
                _ => return None,
            }
        }
        (self.sheet == Sheet::CLEAR).then_some(length)
    }

    /// Makes another sheet of each; tells whether the last covers the whole pixel.
    fn repaint<P: Part>(&self, mut new: impl FnMut(Sheet) -> Sheet, entries: &mut [Entry<P>]) -> bool {
        let (mut next, mut covers) = (self.first, false);
        while let Some(entry) = entries.get_mut(next as usize) {
            if let Kind::Sheet(sheet) = &mut entry.kind {
                *sheet = new(*sheet);
            }
            covers = entry.part == P::WHOLE;
            next = entry.next;
        }
        covers
    }
}
