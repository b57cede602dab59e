//! Takes what a blended group has on a pixel and what lies behind it, each a sheet or a z-list, makes what stands
//! for both.
//!
//! Lists that are simple enough become partitions ([`super::partition`]), of which blending makes another. Others
//! get the marks of groups ([`crate::pixel::paint_tree`]).

use super::groups::Content;
use crate::coverage::Parts;
use crate::pixel::paint_tree::{Blended, Composite, Effect};
use crate::scene::paint::Sheet;
use crate::zlist::{Entry, Kind};
use usvg::BlendMode;

/// How sources of one group are blended.
#[derive(Clone, Copy)]
pub(super) struct Blend {
    pub mode: BlendMode,
    /// As for [`super::Cel::resume`].
    pub background: Sheet,
}

impl Blend {
    /// A source, with its opacity.
    pub fn source(&self, sheet: Sheet) -> Blended {
        Blended::new(self.mode, sheet)
    }

    /// The sheet that stands for a source and what lies behind it.
    #[inline]
    pub fn of(&self, source: &Blended, behind: Sheet) -> Sheet {
        source.before(behind, self.background)
    }

    /// What stands for a source and what lies behind it, where one of them has a list.
    pub fn of_lists<A: Parts>(
        &self,
        (mut source, opacity): (Content, f32),
        mut behind: Content,
        parts: &mut A,
        entries: &mut Vec<Entry<A::Part>>,
    ) -> Content {
        let own = |sheet| self.source(of_group(sheet, opacity));
        let mut is_simple =
            |content: &mut Content| content.is_uniform() || content.make_partition(parts, entries);
        if is_simple(&mut behind) && is_simple(&mut source) {
            let both = match (source.is_uniform(), behind.is_uniform()) {
                (true, true) => Some(Content::of_sheet(self.of(&own(source.sheet), behind.sheet))),
                (true, false) => {
                    let own = own(source.sheet);
                    behind.repaint(|sheet| self.of(&own, sheet), entries);
                    Some(behind)
                }
                (false, true) => {
                    source.repaint(|sheet| self.of(&own(sheet), behind.sheet), entries);
                    Some(source)
                }
                (false, false) => {
                    let blended = |source, behind| self.of(&own(source), behind);
                    source.over_partition(behind, blended, parts, entries)
                }
            };
            if let Some(both) = both {
                return both;
            }
        }
        let mut content = Content::of_sheet(Sheet::CLEAR);
        if source.is_uniform() {
            content.push(Kind::Blended(self.mode, of_group(source.sheet, opacity)), entries);
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
