//! Takes what a blended group has on a pixel and what lies behind it, each a sheet or a z-list, makes what stands
//! for both.
//!
//! Where each sheet of a list is all that is seen where it lies, blending makes of each another sheet, and
//! the list stays as short as it was however many sources are blended with it. Where borders of both cross it
//! becomes a list of what lies in both. Other lists get the marks of groups ([`crate::pixel::paint_tree`]).

use super::groups::Content;
use crate::coverage::{Part, Parts};
use crate::pixel::paint_tree::{blended, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind, NO_ENTRY};
use usvg::BlendMode;

/// Blends sources with backdrops, and remembers the last: from pixel to pixel and from row to row the same
/// come again.
pub(super) struct Blends {
    mode: BlendMode,
    /// As for [`super::Cel::resume`].
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
    pub fn start(&mut self, mode: BlendMode, background: Sheet) {
        let clear = Sheet::CLEAR;
        let nothing = KnownBlend { number: 0, source: clear, behind: clear, blended: clear };
        self.known.resize(1 << KNOWN_BITS, nothing);
        (self.mode, self.background) = (mode, background);
        self.number += 1;
    }

    /// The sheet that stands for a source, with its opacity, and what lies behind it.
    #[inline]
    pub fn of(&mut self, source: Sheet, behind: Sheet) -> Sheet {
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
    pub fn of_lists<A: Parts>(
        &mut self,
        (source, opacity): (Content, f32),
        behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        let own = |sheet| of_group(sheet, opacity);
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
            let own = of_group(sheet, opacity);
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

    /// Blends a uniform source, with its opacity, with a list behind it by giving its entries other colours;
    /// `false`, and nothing is done, unless the list is short, plain, and covers the pixel.
    pub fn in_place<P: Part>(&mut self, source: Sheet, behind: Content, entries: &mut [Entry<P>]) -> bool {
        let mut places = [0; MOST_IN_PLACE];
        let (mut next, mut count) = (behind.first, 0);
        while let Some(entry) = entries.get(next as usize) {
            let covers = entry.next == NO_ENTRY && entry.part == P::WHOLE;
            match (entry.kind, places.get_mut(count)) {
                (Kind::Sheet(sheet), Some(place)) if covers || sheet.is_opaque() => *place = next as usize,
                _ => return false,
            }
            count += 1;
            if covers {
                break;
            }
            next = entry.next;
        }
        if next == NO_ENTRY || !behind.sheet.is_same(Sheet::CLEAR) {
            return false;
        }
        for &place in &places[..count] {
            if let Kind::Sheet(sheet) = &mut entries[place].kind {
                *sheet = self.of(source, *sheet);
            }
        }
        true
    }

    /// What stands for a uniform source, with its opacity, and a list behind it.
    pub fn before_list<P: Part>(
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

/// What a group of one sheet is, rounded as the paint tree does it.
fn of_group(sheet: Sheet, opacity: f32) -> Sheet {
    Sheet::CLEAR.over(sheet).faded(opacity)
}

/// Entries of a list that is blended in place.
const MOST_IN_PLACE: usize = 8;

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
