//! Lists of a few fragments within groups: takes one, makes the pixel's colour by the closed form for
//! fragments ([`crate::pixel::few`]) and one walk through the paint tree for each set of them.
//!
//! Along a border pixel after pixel has the same list but for its fragments' areas. So the colours of the
//! sets are kept with the list, and a tree of groups is walked through once for many pixels.

use super::{Borders, Head, Kind, ZLists, WHOLE};
use crate::pixel::few::MOST_LEAVES;
use crate::pixel::fragment::{Fragment, PIXEL_AREA};
use crate::pixel::paint_tree::{Composite, Effect, PaintTree};
use crate::pixel::resolve::{Mean, Node, Resolver, Surroundings};
use crate::scene::paint::Sheet;
use crate::strips::Piece;

/// Steps of a list that is kept.
const MOST_STEPS: usize = 16;

/// Lists that are kept: a row of pixels crosses so many borders.
const KEPT_BITS: u32 = 7;

/// An entry of a list: what is known of it without its geometry.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// A sheet over the whole pixel, or where the fragment of this number lies.
    Sheet(Sheet, Option<u8>),
    Start(Composite),
    Middle,
    End,
}

/// A step as words, which are quick to compare.
type Key = [u64; 3];

/// A list, and the colours of its sets of fragments as far as they have been asked for.
#[derive(Clone)]
struct Kept {
    keys: [Key; MOST_STEPS],
    steps: [Step; MOST_STEPS],
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
struct Reading {
    keys: [Key; MOST_STEPS],
    steps: [Step; MOST_STEPS],
    count: usize,
    hash: u64,
    /// Their places in the list of all nodes.
    leaves: [u32; MOST_LEAVES],
    leaf_count: usize,
}

impl Default for Reading {
    fn default() -> Reading {
        let (keys, steps) = ([[0; 3]; MOST_STEPS], [Step::Middle; MOST_STEPS]);
        Reading { keys, steps, count: 0, hash: 0, leaves: [0; MOST_LEAVES], leaf_count: 0 }
    }
}

impl Reading {
    fn clear(&mut self) {
        (self.count, self.hash, self.leaf_count) = (0, 0, 0);
    }

    /// The number of the fragment that a node is, or `None` if there are too many. One with the border and
    /// the area of another is the same.
    #[inline]
    fn leaf(&mut self, node: u32, fragment: &Fragment, lists: &ZLists) -> Option<u8> {
        for (number, &known) in self.leaves[..self.leaf_count].iter().enumerate() {
            let known = lists.fragment(known)?;
            if known.area() == fragment.area() && is_same(known, fragment, lists.pieces) {
                return Some(number as u8);
            }
        }
        *self.leaves.get_mut(self.leaf_count)? = node;
        self.leaf_count += 1;
        Some(self.leaf_count as u8 - 1)
    }

    /// `None` if there are too many.
    #[inline]
    fn push(&mut self, step: Step) -> Option<()> {
        let key = step.key();
        *self.steps.get_mut(self.count)? = step;
        self.keys[self.count] = key;
        self.count += 1;
        let own = key[0] ^ key[1].rotate_left(19) ^ key[2].rotate_left(41);
        self.hash = (self.hash ^ own).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        Some(())
    }
}

impl Step {
    #[inline]
    fn key(self) -> Key {
        match self {
            Step::Sheet(sheet, leaf) => {
                let [r, g, b, through] = sheet.channels().map(|v| u64::from(v.to_bits()));
                [r | g << 32, b | through << 32, leaf.map_or(4, |leaf| 5 + u64::from(leaf))]
            }
            Step::Start(Composite { opacity, effect }) => {
                let effect = match effect {
                    Effect::Fade => 0,
                    Effect::Mask(kind) => 1 | (kind as u64) << 8,
                    Effect::Blend(mode) => 2 | (mode as u64) << 8,
                };
                [opacity.to_bits().into(), effect, 1]
            }
            Step::Middle => [0, 0, 2],
            Step::End => [0, 0, 3],
        }
    }
}

impl ZLists<'_> {
    /// The colour of a pixel with a few fragments and groups, or `None` if this is not so.
    pub fn few_in_groups(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        let colors = &mut resolver.known_colors;
        self.read_few(head, &mut colors.reading)?;
        let slot = colors.slot(around.background);
        let mut areas = [0; 1 << MOST_LEAVES];
        let (leaves, count) = (colors.reading.leaves, colors.reading.leaf_count);
        match leaves[..count] {
            [] => areas[0] = PIXEL_AREA,
            [leaf] => {
                let area = self.fragment(leaf)?.area();
                (areas[0], areas[1]) = (PIXEL_AREA - area, area);
                resolver.counts.one_fragment += 1;
            }
            ref leaves => {
                resolver.few.clear();
                for &leaf in leaves {
                    if !resolver.few.add(self.fragment(leaf)?, self.pieces) {
                        return None;
                    }
                }
                areas = resolver.few.areas()?;
                resolver.counts.few += 1;
            }
        }
        let mut mean = Mean::default();
        for (set, &area) in areas[..1 << count].iter().enumerate().filter(|(_, &area)| area > 0) {
            mean.add(colors.color(slot, set), area, around.linear);
        }
        Some(mean)
    }

    fn fragment(&self, node: u32) -> Option<&Fragment> {
        match self.nodes.get(node as usize)? {
            Node::Leaf(fragment) => Some(fragment),
            _ => None,
        }
    }

    /// `None` if the list is too long, or holds something else.
    fn read_few(&self, head: Head, reading: &mut Reading) -> Option<()> {
        reading.clear();
        if head.front != Sheet::CLEAR {
            reading.push(Step::Sheet(head.front, None))?;
        }
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            next = entry.next;
            let step = match entry.kind {
                Kind::Sheet(sheet) if entry.part == WHOLE => Step::Sheet(sheet, None),
                Kind::Sheet(sheet) => {
                    let fragment = self.fragment(entry.part)?;
                    Step::Sheet(sheet, Some(reading.leaf(entry.part, fragment, self)?))
                }
                Kind::Gradient(_) => return None,
                Kind::GroupStart(composite) => Step::Start(composite),
                Kind::GroupMiddle => Step::Middle,
                Kind::GroupEnd => Step::End,
            };
            reading.push(step)?;
        }
        Some(())
    }
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

impl KnownColors {
    /// Where the list that was read is kept from now on.
    fn slot(&mut self, background: Sheet) -> usize {
        let KnownColors { kept, reading, .. } = self;
        if kept.is_empty() {
            let (keys, steps) = (reading.keys, reading.steps);
            let colors = [Sheet::CLEAR; 1 << MOST_LEAVES];
            *kept = vec![Kept { keys, steps, count: 0, background, known: 0, colors }; 1 << KEPT_BITS];
        }
        let slot = (reading.hash.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - KEPT_BITS)) as usize;
        let (kept, count) = (&mut kept[slot], reading.count);
        let is_same = kept.count == count
            && kept.background.is_same(background)
            && kept.keys[..count] == reading.keys[..count];
        if !is_same {
            kept.keys[..count].copy_from_slice(&reading.keys[..count]);
            kept.steps[..count].copy_from_slice(&reading.steps[..count]);
            (kept.count, kept.background, kept.known) = (count, background, 0);
        }
        slot
    }

    #[inline]
    fn color(&mut self, slot: usize, set: usize) -> Sheet {
        let kept = &mut self.kept[slot];
        if kept.known >> set & 1 == 0 {
            kept.colors[set] = composed(&mut self.tree, &kept.steps[..kept.count], set, kept.background);
            kept.known |= 1 << set;
        }
        kept.colors[set]
    }
}

/// The colour of a region that lies in a set of fragments.
fn composed(tree: &mut PaintTree, steps: &[Step], set: usize, background: Sheet) -> Sheet {
    tree.clear();
    for step in steps {
        match *step {
            Step::Start(composite) => tree.start(composite),
            Step::Middle => tree.middle(),
            Step::End => tree.end(),
            Step::Sheet(..) if tree.is_done() => break,
            Step::Sheet(..) if tree.is_hidden() => {}
            Step::Sheet(sheet, leaf) => {
                if leaf.is_none_or(|leaf| set >> leaf & 1 != 0) {
                    tree.paint(sheet);
                }
            }
        }
    }
    tree.over(background)
}
