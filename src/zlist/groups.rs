//! Lists of a few fragments within groups: takes one, makes the pixel's colour by the closed form for
//! fragments ([`crate::pixel::few`]) and one walk through the paint tree for each set of them, or in a partition
//! ([`crate::cel`]) one look for what is seen there.
//!
//! Along a border pixel after pixel has the same list but for its fragments' areas. So the colours of the
//! sets are kept with the list, and a tree of groups is walked through once for many pixels.

use super::{Borders, Head, Kind, ZLists, WHOLE};
use crate::pixel::few::{Areas, MOST_LEAVES};
use crate::pixel::fragment::{Fragment, PIXEL_AREA};
use crate::pixel::paint_tree::{Composite, Effect, PaintTree};
use crate::pixel::resolve::{Mean, Node, Resolver, Surroundings};
use crate::scene::paint::Sheet;
use crate::strips::Piece;

/// Entries of a list that is kept.
const MOST_KEYS: usize = 16;

/// Lists that are kept: a row of pixels crosses so many borders.
const KEPT_BITS: u32 = 7;

/// The set of fragments in all of which what covers the whole pixel lies.
const EVERYWHERE: u8 = 0;

/// An entry without its geometry as words, which are quick to compare. The last tells its kind, and the set of
/// fragments.
type Key = [u64; 3];

/// A list, and the colours of its sets of fragments as far as they have been asked for.
#[derive(Clone)]
struct Kept {
    keys: [Key; MOST_KEYS],
    count: usize,
    background: Sheet,
    /// A bit for each set whose colour is known.
    known: u32,
    colors: [Sheet; 1 << MOST_LEAVES],
}

/// Lists with the colours of their sets, by what the lists are.
#[derive(Default)]
pub(crate) struct KnownColors {
    /// None of them before the first list.
    kept: Vec<Kept>,
    reading: Reading,
    tree: PaintTree,
}

/// A list as it is read.
#[derive(Default)]
struct Reading {
    /// Of the first entries.
    keys: [Key; MOST_KEYS],
    hash: u64,
    /// For each entry the set of fragments in all of which it lies, a bit for each.
    sets: Vec<u8>,
    /// Of a partition, front to back: the set of fragments in all of which each lies, and the entry that tells what is
    /// seen there.
    regions: Vec<(u8, u32)>,
    /// The fragments' places in the list of all nodes, [`WHOLE`] where there are no more.
    leaves: [u32; MOST_LEAVES],
    leaf_count: usize,
}

impl Reading {
    #[inline]
    fn clear(&mut self) {
        self.sets.clear();
        self.regions.clear();
        (self.hash, self.leaf_count, self.leaves) = (0, 0, [WHOLE; MOST_LEAVES]);
    }

    /// The set of fragments in all of which a part lies, or `None` if there are too many or it is not where all of them
    /// lie.
    #[inline]
    fn set(&mut self, part: u32, lists: &ZLists) -> Option<u8> {
        if part == WHOLE {
            return Some(EVERYWHERE);
        }
        if let Some(number) = self.leaves.iter().position(|&known| known == part) {
            return Some(1 << number);
        }
        match lists.nodes.get(part as usize)? {
            Node::Leaf(fragment) => self.leaf(part, fragment, lists),
            &Node::And(a, b) => self.set_of_both(a, b, lists),
            Node::Or(..) => None,
        }
    }

    fn set_of_both(&mut self, a: u32, b: u32, lists: &ZLists) -> Option<u8> {
        Some(self.set(a, lists)? | self.set(b, lists)?)
    }

    /// The bit of a fragment whose node is new. One with the border and the area of another is the same.
    fn leaf(&mut self, node: u32, fragment: &Fragment, lists: &ZLists) -> Option<u8> {
        for number in 0..self.leaf_count {
            let known = lists.fragment(self.leaves[number])?;
            if known.area() == fragment.area() && is_same(known, fragment, lists.pieces) {
                return Some(1 << number);
            }
        }
        *self.leaves.get_mut(self.leaf_count)? = node;
        self.leaf_count += 1;
        Some(1 << (self.leaf_count - 1))
    }

    #[inline]
    fn push(&mut self, key: Key, set: u8) {
        if let Some(here) = self.keys.get_mut(self.sets.len()) {
            *here = key;
        }
        self.sets.push(set);
        let own = key[0] ^ key[1].rotate_left(19) ^ key[2].rotate_left(41);
        self.hash = (self.hash ^ own).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    }
}

/// The key of an entry that lies in this set of fragments.
#[inline]
fn key_of(kind: &Kind, set: u8) -> Key {
    let bits = |sheet: Sheet| {
        let [r, g, b, through] = sheet.channels().map(|v| u64::from(v.to_bits()));
        [r | g << 32, b | through << 32]
    };
    match *kind {
        Kind::Sheet(sheet) => {
            let [a, b] = bits(sheet);
            [a, b, u64::from(set)]
        }
        Kind::Knockout(sheet) => {
            let [a, b] = bits(sheet);
            [a, b, 5 << 8 | u64::from(set)]
        }
        Kind::Blended(mode, sheet) => {
            let [a, b] = bits(sheet);
            [a, b, 1 << 8 | (mode as u64) << 16]
        }
        Kind::GroupStart(Composite { opacity, effect }) => {
            let effect = match effect {
                Effect::Fade => 0,
                Effect::Mask(kind) => 1 | (kind as u64) << 8,
                Effect::Blend(mode) => 2 | (mode as u64) << 8,
            };
            [opacity.to_bits().into(), effect, 2 << 8]
        }
        Kind::GroupMiddle => [0, 0, 3 << 8],
        Kind::GroupEnd => [0, 0, 4 << 8],
        Kind::Gradient(_) => unreachable!("lists with gradients are not read"),
    }
}

impl ZLists<'_> {
    /// The colour of a pixel with a few fragments and groups, or `None` if this is not so.
    pub fn few_in_groups(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        match self.entries.get(head.first as usize)?.kind {
            Kind::Knockout(_) => self.few_in_partition(head, around, resolver),
            _ => self.few_in_list(head, around, resolver),
        }
    }

    /// The same for a partition: each set of fragments looks for what is seen there.
    fn few_in_partition(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        self.read_partition(head, &mut resolver.known_colors.reading)?;
        let areas = self.areas_of_sets(resolver)?;
        let regions = &resolver.known_colors.reading.regions;
        let mut mean = Mean::default();
        for (set, area) in some_area(&areas) {
            let region = regions.iter().find(|(own, _)| holds(set, *own));
            let sheet = |&(_, entry): &(u8, u32)| self.entries[entry as usize].kind.seen();
            let seen = region.and_then(sheet).unwrap_or(Sheet::CLEAR);
            mean.add(head.front.over(seen.over(around.background)), area, around.linear);
        }
        Some(mean)
    }

    /// The same for any list: each set is composited once, and kept.
    fn few_in_list(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        self.read_few(head, &mut resolver.known_colors.reading)?;
        let areas = self.areas_of_sets(resolver)?;
        let KnownColors { kept, reading, tree } = &mut resolver.known_colors;
        let mut kept = reading.find(kept, around.background);
        let mut mean = Mean::default();
        for (set, area) in some_area(&areas) {
            let color = match &mut kept {
                Some(kept) if kept.known >> set & 1 != 0 => kept.colors[set],
                _ => self.composed(head, &reading.sets, set, around.background, tree),
            };
            if let Some(kept) = &mut kept {
                kept.colors[set] = color;
                kept.known |= 1 << set;
            }
            mean.add(color, area, around.linear);
        }
        Some(mean)
    }

    /// The areas of the sets of those fragments that have been read.
    fn areas_of_sets(&self, resolver: &mut Resolver) -> Option<Areas> {
        let reading = &resolver.known_colors.reading;
        match reading.leaves[..reading.leaf_count] {
            [] => Some(areas_of_one(0)),
            [leaf] => {
                resolver.counts.one_fragment += 1;
                Some(areas_of_one(self.fragment(leaf)?.area()))
            }
            ref leaves => {
                resolver.few.clear();
                for &leaf in leaves {
                    if !resolver.few.add(self.fragment(leaf)?, self.pieces) {
                        return None;
                    }
                }
                let areas = resolver.few.areas()?;
                resolver.counts.few += 1;
                Some(areas)
            }
        }
    }

    #[inline]
    fn fragment(&self, node: u32) -> Option<&Fragment> {
        match self.nodes.get(node as usize)? {
            Node::Leaf(fragment) => Some(fragment),
            _ => None,
        }
    }

    /// `None` if the list has too many fragments, or holds something else.
    #[inline]
    fn read_few(&self, head: Head, reading: &mut Reading) -> Option<()> {
        reading.clear();
        let front = Kind::Sheet(head.front);
        reading.push(key_of(&front, EVERYWHERE), EVERYWHERE);
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            next = entry.next;
            let set = match entry.kind {
                Kind::Gradient(_) => return None,
                _ => reading.set(entry.part, self)?,
            };
            reading.push(key_of(&entry.kind, set), set);
        }
        Some(())
    }

    /// `None` if the list has too many fragments.
    #[inline]
    fn read_partition(&self, head: Head, reading: &mut Reading) -> Option<()> {
        reading.clear();
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            let set = reading.set(entry.part, self)?;
            entry.kind.seen()?;
            reading.regions.push((set, next));
            next = entry.next;
        }
        Some(())
    }

    /// The colour of a region that lies in a set of fragments.
    fn composed(
        &self,
        head: Head,
        sets: &[u8],
        set: usize,
        background: Sheet,
        tree: &mut PaintTree,
    ) -> Sheet {
        tree.clear();
        tree.paint(head.front);
        let mut next = head.first;
        for &own in &sets[1..] {
            let entry = &self.entries[next as usize];
            next = entry.next;
            match entry.kind {
                Kind::GroupStart(composite) => tree.start(composite),
                Kind::GroupMiddle => tree.middle(),
                Kind::GroupEnd => tree.end(),
                _ if tree.is_done() => break,
                _ if tree.is_hidden() => {}
                Kind::Blended(mode, source) => tree.blend(mode, source),
                Kind::Sheet(sheet) if holds(set, own) => tree.paint(sheet),
                Kind::Knockout(sheet) if holds(set, own) => tree.knock_out(sheet),
                Kind::Sheet(_) | Kind::Knockout(_) => {}
                Kind::Gradient(_) => unreachable!("lists with gradients are not read"),
            }
        }
        tree.over(background)
    }
}

/// Are all of these fragments in the set?
#[inline]
fn holds(set: usize, fragments: u8) -> bool {
    set & usize::from(fragments) == usize::from(fragments)
}

/// The areas of what lies outside and inside one fragment.
fn areas_of_one(area: i64) -> Areas {
    let mut areas = [0; 1 << MOST_LEAVES];
    (areas[0], areas[1]) = (PIXEL_AREA - area, area);
    areas
}

/// Sets with their areas, without those that are nowhere.
fn some_area(areas: &Areas) -> impl Iterator<Item = (usize, i64)> + '_ {
    areas.iter().copied().enumerate().filter(|&(_, area)| area > 0)
}

/// Have two fragments of one area the same border too?
fn is_same(a: &Fragment, b: &Fragment, pieces: &[Piece]) -> bool {
    let identity = |fragment| {
        let mut borders = Borders::default();
        borders.add(fragment, pieces);
        borders.identity()
    };
    identity(a).is_some_and(|a| identity(b) == Some(a))
}

impl Reading {
    /// Where the list that was read is kept from now on, if it is short enough.
    #[inline]
    fn find<'a>(&self, kept: &'a mut Vec<Kept>, background: Sheet) -> Option<&'a mut Kept> {
        let count = self.sets.len();
        let keys = self.keys.get(..count)?;
        if kept.is_empty() {
            let (keys, colors) = ([[0; 3]; MOST_KEYS], [Sheet::CLEAR; 1 << MOST_LEAVES]);
            *kept = vec![Kept { keys, count: 0, background, known: 0, colors }; 1 << KEPT_BITS];
        }
        let slot = self.hash.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - KEPT_BITS);
        let kept = &mut kept[slot as usize];
        let is_same =
            kept.count == count && kept.background.is_same(background) && kept.keys[..count] == *keys;
        if !is_same {
            kept.keys[..count].copy_from_slice(keys);
            (kept.count, kept.background, kept.known) = (count, background, 0);
        }
        Some(kept)
    }
}
