//! Takes what a blended group has on a pixel and what lies behind it, each a sheet or a z-list, makes what stands
//! for both.
//!
//! Lists that are simple enough become partitions ([`super::partition`]), of which blending makes another. Others
//! get the marks of groups ([`crate::pixel::paint_tree`]).

use super::groups::Content;
use crate::coverage::Parts;
use crate::pixel::paint_tree::{blended, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind};
use usvg::BlendMode;

/// Blends sources with backdrops, and remembers the last: from pixel to pixel and from row to row the same
/// come again.
pub(super) struct Blends {
    mode: BlendMode,
    /// As for [`super::Cel::resume`].
    background: Sheet,
    /// The last.
    source: Sheet,
    /// Of that source in that group: what was known under another is forgotten.
    number: u64,
    known: Vec<KnownBlend>,
}

#[derive(Clone, Copy)]
struct KnownBlend {
    number: u64,
    behind: Sheet,
    blended: Sheet,
}

/// Blends that are remembered.
const KNOWN_BITS: u32 = 8;

impl Default for Blends {
    fn default() -> Blends {
        let (mode, clear) = (BlendMode::Normal, Sheet::CLEAR);
        Blends { mode, background: clear, source: clear, number: 0, known: Vec::new() }
    }
}

impl Blends {
    /// Goes on to sources of another group.
    pub fn start(&mut self, mode: BlendMode, background: Sheet) {
        let clear = Sheet::CLEAR;
        let nothing = KnownBlend { number: 0, behind: clear, blended: clear };
        self.known.resize(1 << KNOWN_BITS, nothing);
        (self.mode, self.background) = (mode, background);
        self.number += 1;
    }

    /// The sheet that stands for a source, with its opacity, and what lies behind it.
    #[inline]
    pub fn of(&mut self, source: Sheet, behind: Sheet) -> Sheet {
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        if !source.is_same(self.source) {
            self.source = source;
            self.number += 1;
        }
        let [r, g, b, through] = behind.channels().map(|v| u64::from(v.to_bits()));
        let hash = ((r | g << 32) ^ (b | through << 32).rotate_left(23)).wrapping_mul(FACTOR);
        let known = &mut self.known[(hash >> (64 - KNOWN_BITS)) as usize];
        if known.number != self.number || !known.behind.is_same(behind) {
            let blended = blended(self.mode, source, behind, self.background);
            *known = KnownBlend { number: self.number, behind, blended };
        }
        known.blended
    }

    /// What stands for a source and what lies behind it, where one of them has a list.
    pub fn of_lists<A: Parts>(
        &mut self,
        (mut source, opacity): (Content, f32),
        mut behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        let own = |sheet| of_group(sheet, opacity);
        let mut is_simple =
            |content: &mut Content| content.is_uniform() || content.make_partition(parts, entries);
        if is_simple(&mut behind) && is_simple(&mut source) {
            let both = match (source.is_uniform(), behind.is_uniform()) {
                (true, true) => Some(Content::of_sheet(self.of(own(source.sheet), behind.sheet))),
                (true, false) => {
                    behind.repaint(|sheet| self.of(own(source.sheet), sheet), entries);
                    Some(behind)
                }
                (false, true) => {
                    source.repaint(|sheet| self.of(own(sheet), behind.sheet), entries);
                    Some(source)
                }
                (false, false) => {
                    let blended = |source, behind| self.of(own(source), behind);
                    source.over_partition(behind, blended, parts, entries)
                }
            };
            if let Some(both) = both {
                return both;
            }
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        if source.is_uniform() {
            content.push(Kind::Blended(self.mode, own(source.sheet)), entries);
        } else {
            let composite = Composite { opacity, effect: Effect::Blend(self.mode) };
            content.push(Kind::GroupStart(composite), entries);
            content.append(source, entries);
            content.push(Kind::GroupEnd, entries);
        }
        content.before(behind, entries)
    }
}

/// What a group of one sheet is, rounded as the paint tree does it.
fn of_group(sheet: Sheet, opacity: f32) -> Sheet {
    Sheet::CLEAR.over(sheet).faded(opacity)
}
