//! Takes what a blended group has on a pixel and what lies behind it, each a sheet or a z-list, makes what stands
//! for both.
//!
//! Lists that are simple enough become partitions ([`super::partition`]), of which blending makes another. Others
//! get the marks of groups ([`crate::pixel::paint_tree`]).

use super::groups::Content;
use crate::coverage::{Part, Parts};
use crate::pixel::paint_tree::{Blended, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind};
use usvg::BlendMode;

/// Blends what one group after the other holds. Remembers what it made where borders are: from pixel to pixel and from
/// row to row the same comes again.
pub(super) struct Blends {
    mode: BlendMode,
    /// Of the group.
    opacity: f32,
    /// As for [`super::Cel::resume`].
    background: Sheet,
    /// Of the group: what was known under another is forgotten.
    number: u64,
    known: Vec<KnownBlend>,
}

#[derive(Clone, Copy)]
struct KnownBlend {
    number: u64,
    sheet: Sheet,
    behind: Sheet,
    seen: Sheet,
}

/// Blends that are known.
const KNOWN_BITS: u32 = 8;

impl Default for Blends {
    fn default() -> Blends {
        let (mode, background) = (BlendMode::Normal, Sheet::CLEAR);
        Blends { mode, opacity: 1.0, background, number: 0, known: Vec::new() }
    }
}

impl Blends {
    /// Goes on to another group.
    pub fn start(&mut self, mode: BlendMode, opacity: f32, background: Sheet) {
        let clear = Sheet::CLEAR;
        let nothing = KnownBlend { number: 0, sheet: clear, behind: clear, seen: clear };
        self.known.resize(1 << KNOWN_BITS, nothing);
        (self.mode, self.opacity, self.background) = (mode, opacity, background);
        self.number += 1;
    }

    /// Makes of what lies behind a sheet in the group the sheet that stands for both.
    pub fn before(&self, sheet: Sheet) -> impl Fn(Sheet) -> Sheet + Copy {
        let (source, background) = (Blended::new(self.mode, sheet.faded(self.opacity)), self.background);
        move |behind| source.before(behind, background)
    }

    /// The same where borders are.
    #[inline(always)]
    fn of(&mut self, sheet: Sheet, behind: Sheet) -> Sheet {
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        let word = |sheet: Sheet| {
            let [r, g, b, through] = sheet.channels().map(|v| u64::from(v.to_bits()));
            (r | g << 32) ^ (b | through << 32).rotate_left(23)
        };
        if sheet.is_same(Sheet::CLEAR) {
            return behind;
        }
        let hash = (word(sheet).rotate_left(9) ^ word(behind)).wrapping_mul(FACTOR);
        let place = (hash >> (64 - KNOWN_BITS)) as usize;
        let known = &self.known[place];
        if known.number == self.number && known.behind.is_same(behind) && known.sheet.is_same(sheet) {
            return known.seen;
        }
        self.learn(place, sheet, behind)
    }

    /// Apart, for it is seldom called.
    #[inline(never)]
    fn learn(&mut self, place: usize, sheet: Sheet, behind: Sheet) -> Sheet {
        let seen = self.before(sheet)(behind);
        self.known[place] = KnownBlend { number: self.number, sheet, behind, seen };
        seen
    }

    /// What stands for what the group has on a pixel and what lies behind it, where one of them has a list.
    pub fn of_lists<A: Parts>(
        &mut self,
        mut source: Content,
        mut behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        if behind.make_simple(parts, entries) && source.make_simple(parts, entries) {
            let both = match (source.is_uniform(), behind.is_uniform()) {
                (true, true) => Some(Content::of_sheet(self.of(source.sheet, behind.sheet))),
                (true, false) => {
                    behind.repaint(|sheet| self.of(source.sheet, sheet), entries);
                    Some(behind)
                }
                (false, true) => {
                    source.repaint(|sheet| self.of(sheet, behind.sheet), entries);
                    Some(source)
                }
                (false, false) => {
                    source.over_partition(behind, |source, behind| self.of(source, behind), parts, entries)
                }
            };
            if let Some(both) = both {
                return both;
            }
        }
        self.as_marks(source, entries).before(behind, entries)
    }

    /// What the group has on a pixel in a list, before its backdrop.
    fn as_marks<P: Part>(&self, source: Content, entries: &mut Vec<Entry<P>>) -> Content {
        let mut content = Content::of_sheet(Sheet::CLEAR);
        if source.is_uniform() {
            content.push(Kind::Blended(self.mode, source.sheet.faded(self.opacity)), entries);
        } else {
            let composite = Composite { opacity: self.opacity, effect: Effect::Blend(self.mode) };
            content.push(Kind::GroupStart(composite), entries);
            content.append(source, entries);
            content.push(Kind::GroupEnd, entries);
        }
        content
    }
}
