//! Blended groups that wait for their backdrops: takes a group that is complete, keeps what it has on each
//! pixel, with what was painted there before it, until all that lies behind it in the group around it has
//! been painted; then puts the three together.
//!
//! A pixel on which a source waits becomes new: what is painted there next is the source's backdrop. Sources
//! wait in runs of pixels that are the same, so that they take room, and blending takes time, by what is
//! visible of them.
//!
//! Where each sheet of a z-list is all that is seen where it lies, blending makes of each another sheet, and
//! the list stays as short as it was however many sources are blended with it. Other lists get the marks of
//! groups ([`crate::pixel::paint_tree`]).

use super::groups::{count_same, for_same, Content};
use super::Cel;
use crate::bitmap::{for_bits, for_runs, word_masks};
use crate::coverage::Part;
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
    pub fn resume<P: Part>(&mut self, background: Sheet, entries: &mut Vec<Entry<P>>) {
        let mut waiting = std::mem::take(&mut self.waiting);
        while let Some(Source { mode, opacity, first_run, first_pixel }) = waiting.sources.pop() {
            let blending = Blending { mode, opacity, background };
            for run in waiting.runs.drain(first_run..) {
                self.resume_run(run, &blending, entries);
            }
            for Pixel { at, before, source } in waiting.pixels.drain(first_pixel..) {
                self.resume_list(at, before, source, &blending, entries);
            }
        }
        waiting.rows = 0;
        self.waiting = waiting;
    }

    fn resume_run<P: Part>(
        &mut self,
        Run { row, from, to, before, source }: Run,
        blending: &Blending,
        entries: &mut Vec<Entry<P>>,
    ) {
        let blend = |behind: Sheet| before.over(blending.of(source, behind));
        // Where there is nothing behind.
        let mut alone = None;
        for (word, mask) in word_masks(from, to) {
            let touched = mask & self.touched.row(row)[word];
            let listed = touched & self.listed.row(row)[word];
            let start = row * self.width + word * 64;
            if touched != mask {
                let sheet = *alone.get_or_insert_with(|| blend(Sheet::CLEAR));
                for_runs(mask & !touched, |a, b| self.sheets[start + a..start + b].fill(sheet));
            }
            for_runs(touched & !listed, |a, b| {
                let sheets = &mut self.sheets[start + a..start + b];
                let mut from = 0;
                while let Some(&behind) = sheets.get(from) {
                    let same = 1 + count_same(&sheets[from + 1..], behind);
                    sheets[from..from + same].fill(blend(behind));
                    from += same;
                }
            });
            self.touched.row_mut(row)[word] |= mask;
            for_bits(listed, |x| {
                let at = (row, word * 64 + x);
                let blended = blending.before_list(source, self.content(at.0, at.1), entries);
                let mut content = Content::of_sheet(before);
                content.append(blended, entries);
                self.put(at, content);
            });
        }
    }

    /// Makes the list of a pixel: what was painted before, the source, what lies behind.
    fn resume_list<P: Part>(
        &mut self,
        (row, x): (usize, usize),
        mut before: Content,
        source: Content,
        blending: &Blending,
        entries: &mut Vec<Entry<P>>,
    ) {
        let behind = self.content(row, x);
        let own = |sheet| Sheet::CLEAR.over(sheet).faded(blending.opacity);
        let alone = source.is_alone(entries) && behind.sheet.is_opaque();
        let hides = |sheet: Sheet| alone || blending.opacity >= 1.0 && sheet.is_opaque();
        if source.is_uniform() {
            let blended = match behind.is_uniform() {
                true => Content::of_sheet(blending.of(own(source.sheet), behind.sheet)),
                false => blending.before_list(own(source.sheet), behind, entries),
            };
            before.append(blended, entries);
        } else if behind.is_uniform() && source.is_plain(hides, entries) {
            let covers = source.repaint(|sheet| blending.of(own(sheet), behind.sheet), entries);
            before.append(source, entries);
            if !covers {
                before.append(behind, entries);
            }
        } else {
            let Blending { mode, opacity, .. } = *blending;
            before.push(Kind::GroupStart(Composite { opacity, effect: Effect::Blend(mode) }), entries);
            before.append(source, entries);
            before.push(Kind::GroupEnd, entries);
            before.append(behind, entries);
        }
        self.put((row, x), before);
    }
}

/// How a source meets what lies behind it.
struct Blending {
    mode: BlendMode,
    opacity: f32,
    /// As for [`Cel::resume`].
    background: Sheet,
}

impl Blending {
    /// The sheet that stands for a source, with its opacity, and what lies behind it.
    #[inline]
    fn of(&self, source: Sheet, behind: Sheet) -> Sheet {
        blended(self.mode, source, behind, self.background)
    }

    /// What stands for a uniform source, with its opacity, and a list behind it.
    fn before_list<P: Part>(
        &self,
        source: Sheet,
        mut behind: Content,
        entries: &mut Vec<Entry<P>>,
    ) -> Content {
        if behind.is_plain(Sheet::is_opaque, entries) {
            if !behind.repaint(|sheet| self.of(source, sheet), entries) {
                behind.push(Kind::Sheet(self.of(source, Sheet::CLEAR)), entries);
            }
            return behind;
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        content.push(Kind::Blended(self.mode, source), entries);
        content.append(behind, entries);
        content
    }
}

/// Plain lists: each sheet is all that is seen where it lies and none of those before it does.
impl Content {
    /// Is it a list of one entry?
    fn is_alone<P>(&self, entries: &[Entry<P>]) -> bool {
        self.first == self.last && !self.is_uniform() && entries[self.first as usize].next == NO_ENTRY
    }

    /// Is it a plain list? `hides` tells of a sheet whether nothing behind it will be seen. What covers the
    /// whole pixel and comes last has nothing behind it.
    fn is_plain<P: Part>(&self, hides: impl Fn(Sheet) -> bool, entries: &[Entry<P>]) -> bool {
        let mut next = self.first;
        while let Some(entry) = entries.get(next as usize) {
            next = entry.next;
            match entry.kind {
                Kind::Sheet(sheet) if hides(sheet) || next == NO_ENTRY && entry.part == P::WHOLE => {}
                _ => return false,
            }
        }
        self.sheet == Sheet::CLEAR
    }

    /// Makes another sheet of each; tells whether the last covers the whole pixel.
    fn repaint<P: Part>(&self, new: impl Fn(Sheet) -> Sheet, entries: &mut [Entry<P>]) -> bool {
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
