//! Makes a partition of what a pixel holds: a list in which each sheet is all that is seen where it lies and none of
//! those before it does. Such are knock-outs, opaque sheets, and the last. Then whatever is blended with the pixel makes
//! of each another knock-out, and the list stays as short as it was, however many sources are blended with it.

use super::groups::Content;
use crate::coverage::{Part, Parts};
use crate::pixel::few::MOST_LEAVES;
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind, NO_ENTRY};

/// Sheets of a partition at most: as many as there are sets of fragments that have a closed form.
const MOST_REGIONS: usize = 1 << MOST_LEAVES;

/// Entries of a list of which a partition is made. Most that are longer have too many regions.
const MOST_LAYERS: usize = 16;

impl Content {
    /// One knock-out.
    fn of_region<P: Part>(part: P, sheet: Sheet, entries: &mut Vec<Entry<P>>) -> Content {
        let mut content = Content::of_sheet(Sheet::CLEAR);
        content.push_part(part, Kind::Knockout(sheet), entries);
        content
    }

    /// Is it a partition, with no sheet before it?
    #[inline]
    pub fn is_partition<P: Part>(&self, entries: &[Entry<P>]) -> bool {
        self.sheet.is_same(Sheet::CLEAR) && self.has_partition(entries)
    }

    /// Is the list one?
    #[inline]
    fn has_partition<P: Part>(&self, entries: &[Entry<P>]) -> bool {
        let mut next = self.first;
        while let Some(entry) = entries.get(next as usize) {
            match entry.kind {
                // Knock-outs come only in partitions, and last.
                Kind::Knockout(_) => break,
                Kind::Sheet(sheet) if sheet.is_opaque() || entry.next == NO_ENTRY => next = entry.next,
                _ => return false,
            }
        }
        true
    }

    /// Makes another sheet of each region's, and one of the rest of the pixel, which was clear.
    #[inline]
    pub fn repaint<P: Part>(&mut self, mut new: impl FnMut(Sheet) -> Sheet, entries: &mut Vec<Entry<P>>) {
        let mut next = self.first;
        let mut covers = false;
        while let Some(entry) = entries.get_mut(next as usize) {
            match &mut entry.kind {
                // In its place: with the whole entry written, deep stacks took 1.7 times as long.
                Kind::Knockout(sheet) => *sheet = new(*sheet),
                Kind::Sheet(sheet) => entry.kind = Kind::Knockout(new(*sheet)),
                _ => {}
            }
            covers = entry.part == P::WHOLE;
            next = entry.next;
        }
        if !covers {
            let rest = new(Sheet::CLEAR);
            if !rest.is_same(Sheet::CLEAR) {
                self.push(Kind::Knockout(rest), entries);
            }
        }
    }

    /// Makes it one sheet or a partition; `false` if the list is too long, has groups or gradients.
    #[inline]
    pub fn make_simple<A: Parts>(&mut self, parts: &mut A, entries: &mut Vec<Entry<A::Part>>) -> bool {
        if self.is_uniform() {
            return true;
        }
        if !self.has_partition(entries) && !self.part_layers(parts, entries) {
            return false;
        }
        let front = std::mem::replace(&mut self.sheet, Sheet::CLEAR);
        if !front.is_same(Sheet::CLEAR) {
            self.repaint(|sheet| front.over(sheet), entries);
        }
        true
    }

    /// Makes the list one, of what its layers make of the pixel.
    fn part_layers<A: Parts>(&mut self, parts: &mut A, entries: &mut Vec<Entry<A::Part>>) -> bool {
        let mut layers = [(A::Part::WHOLE, Sheet::CLEAR, false); MOST_LAYERS];
        let mut count = 0;
        let mut next = self.first;
        while let Some(entry) = entries.get(next as usize) {
            let (sheet, hides) = match entry.kind {
                Kind::Sheet(sheet) => (sheet, sheet.is_opaque()),
                Kind::Knockout(sheet) => (sheet, true),
                _ => return false,
            };
            let Some(layer) = layers.get_mut(count) else {
                return false;
            };
            *layer = (entry.part, sheet, hides);
            count += 1;
            next = entry.next;
        }
        let mut all = Content::of_sheet(Sheet::CLEAR);
        for &(part, sheet, hides) in layers[..count].iter().rev() {
            let whole = part == A::Part::WHOLE;
            if whole && !hides && !all.is_uniform() {
                all.repaint(|behind| sheet.over(behind), entries);
                continue;
            }
            let layer = Content::of_region(part, sheet, entries);
            let over = match () {
                () if whole || all.is_uniform() => Some(layer),
                () if hides => Some(layer.before(all, entries)),
                () => layer.over_partition(all, Sheet::over, parts, entries),
            };
            match over {
                Some(over) => all = over,
                None => return false,
            }
        }
        (self.first, self.last) = (all.first, all.last);
        true
    }

    /// A partition in front of another: `both` makes the sheet of what lies in a region of each, or in none behind.
    /// `None` if there are too many.
    pub fn over_partition<A: Parts>(
        self,
        behind: Content,
        mut both: impl FnMut(Sheet, Sheet) -> Sheet,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Option<Content> {
        let whole = A::Part::WHOLE;
        let ((own, covers), (others, is_closed)) = (self.regions(entries), behind.regions(entries));
        let alone = if is_closed { 0 } else { own } + if covers { 0 } else { others };
        if own * others + alone > MOST_REGIONS {
            return None;
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        let mut next = self.first;
        while let Some((after, part, sheet)) = entries.get(next as usize).and_then(region_of) {
            next = after;
            let mut other = behind.first;
            while let Some((next, within, behind)) = entries.get(other as usize).and_then(region_of) {
                other = next;
                let shared = match (part, within) {
                    (part, within) if within == whole => part,
                    (part, within) if part == whole => within,
                    (part, within) => parts.both(part, within),
                };
                content.push_part(shared, Kind::Knockout(both(sheet, behind)), entries);
            }
            if !is_closed {
                content.push_part(part, Kind::Knockout(both(sheet, Sheet::CLEAR)), entries);
            }
        }
        Some(match covers {
            true => content,
            false => content.before(behind, entries),
        })
    }

    /// How many regions a partition has, and whether they cover the pixel.
    fn regions<P: Part>(&self, entries: &[Entry<P>]) -> (usize, bool) {
        let (mut count, mut covers) = (0, false);
        let mut next = self.first;
        while let Some(entry) = entries.get(next as usize) {
            (next, covers) = (entry.next, entry.part == P::WHOLE);
            count += 1;
        }
        (count, covers)
    }
}

/// Of an entry of a partition: the entry behind, where it is seen, and what.
#[inline]
fn region_of<P: Part>(entry: &Entry<P>) -> Option<(u32, P, Sheet)> {
    entry.kind.seen().map(|sheet| (entry.next, entry.part, sheet))
}
