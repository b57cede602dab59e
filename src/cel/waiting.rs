//! Blended groups that wait for their backdrops: takes a group that is complete, keeps what it has on each
//! pixel, with what was painted there before it, until all that lies behind it in the group around it has
//! been painted; then puts the three together.
//!
//! A pixel on which a source waits becomes new: what is painted there next is the source's backdrop. Sources
//! wait in runs of pixels that are the same, so that they take room, and blending takes time, by what is
//! visible of them.

use super::blends::Blends;
use super::groups::Content;
use super::Cel;
use crate::bitmap::{for_bits, for_runs, word_masks};
use crate::coverage::Parts;
use crate::scene::paint::Sheet;
use crate::zlist::Entry;
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
    /// The source, without its opacity.
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
            let open = group.touched(row, word) & !self.finished.row(row)[word];
            if open == 0 {
                continue;
            }
            let with_lists = open & (group.listed.row(row)[word] | self.listed.row(row)[word]);
            self.suspend_runs(group, (row, word), open & !with_lists);
            for_bits(with_lists, |x| {
                let x = word * 64 + x;
                let (before, source) = (self.content(row, x), group.content(row, x));
                self.waiting.pixels.push(Pixel { at: (row, x), before, source });
            });
            self.covered.row_mut(row)[word] &= !open;
            self.listed.row_mut(row)[word] &= !open;
            self.waiting.rows |= 1 << row;
        }
    }

    /// The same for pixels of a word that are uniform in both cels.
    fn suspend_runs(&mut self, group: &Cel, (row, word): (usize, usize), pixels: u64) {
        let covered = self.covered.row(row)[word];
        let Cel { waiting, sheets, .. } = self;
        let mut push = |from: usize, to: usize, before: Sheet, source: Sheet| {
            waiting.push_run(Run { row, from: word * 64 + from, to: word * 64 + to, before, source });
        };
        group.for_uniform((row, word), pixels & !covered, |from, to, source| {
            push(from, to, Sheet::CLEAR, source);
        });
        group.for_uniform((row, word), pixels & covered, |a, b, source| {
            sheets.for_runs((row, word), (a, b), |from, to, before| push(from, to, before, source));
        });
    }

    /// Blends all that wait with what lies behind them, which is complete; `background` is what will be put
    /// behind that, if it is part of the backdrop.
    pub fn resume<A: Parts>(&mut self, background: Sheet, parts: &mut A, entries: &mut Vec<Entry<A::Part>>) {
        let mut waiting = std::mem::take(&mut self.waiting);
        while let Some(Source { mode, opacity, first_run, first_pixel }) = waiting.sources.pop() {
            let blends = &mut waiting.blends;
            blends.start(mode, opacity, background);
            for run in waiting.runs.drain(first_run..) {
                self.resume_run(run, blends, parts, entries);
            }
            for Pixel { at: (row, x), before, source } in waiting.pixels.drain(first_pixel..) {
                let behind = self.content(row, x);
                let blended = blends.of_lists(source, behind, parts, entries);
                self.put((row, x), before.before(blended, entries));
            }
        }
        waiting.rows = 0;
        self.waiting = waiting;
    }

    fn resume_run<A: Parts>(
        &mut self,
        Run { row, from, to, before, source }: Run,
        blends: &mut Blends,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) {
        let nothing_before = before.is_same(Sheet::CLEAR);
        let blended = blends.before(source);
        let seen = |behind: Sheet| {
            let seen = blended(behind);
            if nothing_before {
                seen
            } else {
                before.over(seen)
            }
        };
        for (word, mask) in word_masks(from, to) {
            let (_, uniform, listed) = self.states(row, word);
            for_runs(mask & !(uniform | listed), |a, b| {
                self.sheets.fill((row, word), (a, b), seen(Sheet::CLEAR));
            });
            for_runs(mask & uniform, |a, b| {
                self.sheets.change((row, word), (a, b), |_, _, behind| seen(behind));
            });
            self.covered.row_mut(row)[word] |= mask & !listed;
            for_bits(mask & listed, |x| {
                let at = (row, word * 64 + x);
                let mut behind = self.content(at.0, at.1);
                if behind.is_partition(entries) {
                    behind.repaint(&seen, entries);
                    // The list may have grown; there is still no sheet before it.
                    self.lists[at.0 * self.width + at.1] = (behind.first, behind.last);
                } else {
                    let blended = blends.of_lists(Content::of_sheet(source), behind, parts, entries);
                    self.put(at, Content::of_sheet(before).before(blended, entries));
                }
            });
        }
    }
}
