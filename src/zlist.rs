//! A pixel's z-list: what is painted on it behind the first border, front to back.
//!
//! Takes entries as [`crate::cel`] keeps them; gives the colour at once where that is easy, or else the
//! items that [`crate::pixel::resolve`] works on.

pub(crate) mod groups;

use crate::coverage::Part;
use crate::pixel::fragment::{Fragment, PIXEL_AREA};
use crate::pixel::paint_tree::Composite;
use crate::pixel::resolve::{Item, Mean, Node, Resolver, Surroundings};
use crate::scene::paint::Sheet;
use crate::strips::{Piece, NO_PIECE};
use usvg::BlendMode;

/// The node that is the whole pixel.
const WHOLE: u32 = u32::WHOLE;

/// Sheets in a list of few fragments.
const MOST_SHEETS: usize = 8;

/// No entry, or the end of a list.
pub(crate) const NO_ENTRY: u32 = u32::MAX;

/// One element of a z-list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<P> {
    /// The one behind, or [`NO_ENTRY`].
    pub next: u32,
    /// Where in the pixel it is.
    pub part: P,
    pub kind: Kind,
}

/// What an entry paints. Its tag is as wide as a channel, so that it is copied by loads as wide as the stores that wrote
/// it: from others nothing is forwarded, and a copy waits until all is in memory.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(crate) enum Kind {
    Sheet(Sheet),
    /// All that is seen where it lies, however much light it lets through.
    Knockout(Sheet),
    /// A shape's number.
    Gradient(u32),
    /// A blended group of one colour. Its backdrop follows.
    Blended(BlendMode, Sheet),
    /// What follows, up to the matching end, composites as one.
    GroupStart(Composite),
    /// Between a mask and what it masks.
    GroupMiddle,
    GroupEnd,
}

impl Kind {
    /// What is seen of an entry that is one region of a partition.
    #[inline]
    pub fn seen(&self) -> Option<Sheet> {
        match *self {
            Kind::Sheet(sheet) | Kind::Knockout(sheet) => Some(sheet),
            _ => None,
        }
    }

    /// The sheet of an entry that paints one, and hides no more than that does.
    #[inline]
    fn sheet(&self) -> Option<Sheet> {
        match *self {
            Kind::Sheet(sheet) => Some(sheet),
            Kind::Knockout(sheet) if sheet.is_opaque() => Some(sheet),
            _ => None,
        }
    }
}

/// Where a pixel's list begins, and what lies in front of it.
#[derive(Clone, Copy)]
pub(crate) struct Head {
    pub front: Sheet,
    pub first: u32,
}

/// Makes sheets of those gradients in a list that have one colour all over the pixel at column `x` and row `y`.
pub(crate) fn settle_gradients<P>(
    head: Head,
    entries: &mut [Entry<P>],
    (x, y): (u32, u32),
    around: &Surroundings,
) {
    let middle = (f64::from(x) + 0.5, f64::from(y) + 0.5);
    let mut next = head.first;
    while let Some(entry) = entries.get_mut(next as usize) {
        next = entry.next;
        if let Kind::Gradient(shape) = entry.kind {
            if let Some(sheet) = around.shader(shape).even_at(middle.0, middle.1) {
                entry.kind = Kind::Sheet(sheet);
            }
        }
    }
}

/// The z-lists of one band, with fragments kept as geometry: a part is the number of a node.
pub(crate) struct ZLists<'a> {
    pub entries: &'a [Entry<u32>],
    pub nodes: &'a [Node],
    pub pieces: &'a [Piece],
}

impl ZLists<'_> {
    /// The colour of a pixel with one fragment among sheets of one colour, or of opaque fragments that
    /// tile the pixel. These are nearly all pixels of most drawings.
    pub fn resolve_simply(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        let entry = self.entries.get(head.first as usize)?;
        let (first, sheet) = self.leaf(entry)?;
        if entry.next == NO_ENTRY && head.front == Sheet::CLEAR {
            // So it is with most pixels of all.
            let mut mean = Mean::default();
            mean.add(sheet.over(around.background), first.area(), around.linear);
            mean.add(around.background, PIXEL_AREA - first.area(), around.linear);
            resolver.counts.one_fragment += 1;
            return Some(mean);
        }
        if let Some(behind) = self.sheets_behind(entry.next, around.background) {
            let mut mean = Mean::default();
            mean.add(head.front.over(sheet.over(behind)), first.area(), around.linear);
            mean.add(head.front.over(behind), PIXEL_AREA - first.area(), around.linear);
            resolver.counts.one_fragment += 1;
            return Some(mean);
        }
        self.tiled(entry, head.front, around, resolver).or_else(|| self.few(head, around, resolver))
    }

    /// An entry of one fragment and one colour.
    fn leaf(&self, entry: &Entry<u32>) -> Option<(&Fragment, Sheet)> {
        match self.nodes.get(entry.part as usize)? {
            Node::Leaf(fragment) => Some((fragment, entry.kind.sheet()?)),
            _ => None,
        }
    }

    /// All from this entry on, if they are whole sheets of one colour.
    fn sheets_behind(&self, first: u32, background: Sheet) -> Option<Sheet> {
        let mut front = Sheet::CLEAR;
        let mut next = first;
        while let Some(entry) = self.entries.get(next as usize) {
            match entry.kind.sheet() {
                Some(sheet) if entry.part == WHOLE => front = front.over(sheet),
                _ => return None,
            }
            next = entry.next;
        }
        Some(front.over(background))
    }

    /// A few fragments among sheets, each of one colour.
    fn few(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        let few = &mut resolver.few;
        few.clear();
        // Each with the set of fragments that must be there for it to be seen: one or none.
        let mut sheets = [(Sheet::CLEAR, 0); MOST_SHEETS];
        let (mut count, mut leaves) = (0, 0);
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            next = entry.next;
            let here = sheets.get_mut(count)?;
            count += 1;
            *here = match entry.kind.sheet() {
                Some(sheet) if entry.part == WHOLE => (sheet, 0),
                _ => {
                    let (fragment, sheet) = self.leaf(entry)?;
                    if !few.add(fragment, self.pieces) {
                        return None;
                    }
                    leaves += 1;
                    (sheet, 1 << (leaves - 1))
                }
            };
        }
        let areas = few.areas()?;
        let mut mean = Mean::default();
        for (set, area) in areas[..1 << leaves].iter().enumerate().filter(|(_, &area)| area > 0) {
            let mut front = head.front;
            for (sheet, leaf) in &sheets[..count] {
                if set & leaf == *leaf {
                    front = front.over(*sheet);
                    if sheet.is_opaque() {
                        break;
                    }
                }
            }
            mean.add(front.over(around.background), *area, around.linear);
        }
        resolver.counts.few += 1;
        Some(mean)
    }

    /// Opaque fragments that tile the pixel.
    fn tiled(
        &self,
        first: &Entry<u32>,
        front: Sheet,
        around: &Surroundings,
        resolver: &mut Resolver,
    ) -> Option<Mean> {
        let mut mean = Mean::default();
        let mut area = 0;
        let mut borders = Borders::default();
        let mut entry = first;
        while area < PIXEL_AREA {
            let (fragment, sheet) = self.leaf(entry).filter(|(_, sheet)| sheet.is_opaque())?;
            area += fragment.area();
            if area > PIXEL_AREA || area < PIXEL_AREA && entry.next == NO_ENTRY {
                return None;
            }
            mean.add(front.over(sheet), fragment.area(), around.linear);
            borders.add(fragment, self.pieces);
            if area < PIXEL_AREA {
                entry = self.entries.get(entry.next as usize)?;
            }
        }
        resolver.counts.tiled += u64::from(borders.cancel());
        borders.cancel().then_some(mean)
    }

    /// Gives the list to the resolver.
    pub fn read(&self, head: Head, resolver: &mut Resolver) {
        resolver.clear();
        if head.front != Sheet::CLEAR {
            resolver.push_sheet(head.front, None, self);
        }
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            let node = (entry.part != WHOLE).then_some(entry.part);
            match entry.kind {
                Kind::Sheet(sheet) => resolver.push_sheet(sheet, node, self),
                Kind::Knockout(sheet) => resolver.push_knockout(sheet, node, self),
                Kind::Gradient(shape) => resolver.push_gradient(shape, node, self),
                Kind::Blended(mode, source) => resolver.push(Item::Blended(mode, source)),
                Kind::GroupStart(composite) => resolver.push(Item::GroupStart(composite)),
                Kind::GroupMiddle => resolver.push(Item::GroupMiddle),
                Kind::GroupEnd => resolver.push(Item::GroupEnd),
            }
            next = entry.next;
        }
    }
}

/// The partition test: do fragments tile the pixel, does each point lie in exactly one? They do when
/// all borders cancel, line by line, and the areas sum to the pixel: then the number of fragments over
/// a point is the same everywhere, and one on average.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Borders {
    sum: u64,
    unknown: bool,
}

impl Borders {
    /// Adds a fragment's border.
    #[inline]
    pub fn add(&mut self, fragment: &Fragment, pieces: &[Piece]) {
        self.unknown |= fragment.sense == 0;
        let mut next = fragment.pieces;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            if (piece.x0, piece.y0) != (piece.x1, piece.y1) {
                let times = i64::from(fragment.sense * piece.winding) as u64;
                self.sum = self.sum.wrapping_add(piece.identity().wrapping_mul(times));
            }
            next = piece.next;
        }
    }

    /// The sum of all lines added: the same for the same border, whichever way round it was drawn.
    pub fn identity(&self) -> Option<u64> {
        (!self.unknown).then_some(self.sum)
    }

    /// Has each line been added as often one way as the other?
    #[inline]
    pub fn cancel(&self) -> bool {
        self.sum == 0 && !self.unknown
    }
}
