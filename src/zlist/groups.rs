//! Lists of a few fragments within groups: takes one, makes the pixel's colour by the closed form for
//! fragments ([`crate::pixel::few`]) and one walk through the paint tree for each set of them.
//!
//! Along a border pixel after pixel has the same list but for its fragments' areas. So the colours of the
//! sets are kept with the list, and a tree of groups is walked through once for many pixels.

use super::{Borders, Head, Kind, ZLists, WHOLE};
use crate::pixel::few::MOST_LEAVES;
use crate::pixel::fragment::{Fragment, PIXEL_AREA};
use crate::pixel::paint_tree::{Composite, PaintTree};
use crate::pixel::resolve::{Mean, Resolver, Surroundings};
use crate::scene::paint::Sheet;
use crate::strips::Piece;

/// Steps of a list that is kept.
const MOST_STEPS: usize = 16;

/// Lists that are kept: a row of pixels crosses so many borders.
const KEPT_BITS: u32 = 7;

/// An entry of a list: what is known of it without its geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// A sheet over the whole pixel, or where the fragment of this number lies.
    Sheet(Sheet, Option<u8>),
    Start(Composite),
    Middle,
    End,
}

/// A list, and the colours of its sets of fragments as far as they have been asked for.
#[derive(Clone)]
struct Kept {
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
    tree: PaintTree,
}

/// A list as it is read.
struct Reading<'a> {
    steps: [Step; MOST_STEPS],
    count: usize,
    leaves: [Option<&'a Fragment>; MOST_LEAVES],
    leaf_count: usize,
    hash: u64,
}

impl<'a> Reading<'a> {
    /// The number of a fragment, or `None` if there are too many. One with the border and the area of another
    /// is the same.
    fn leaf(&mut self, fragment: &'a Fragment, pieces: &[Piece]) -> Option<u8> {
        let known = self.leaves[..self.leaf_count].iter().flatten();
        let same = known.enumerate().find(|(_, leaf)| {
            leaf.area() == fragment.area()
                && identity(leaf, pieces).is_some_and(|own| identity(fragment, pieces) == Some(own))
        });
        if let Some((same, _)) = same {
            return Some(same as u8);
        }
        *self.leaves.get_mut(self.leaf_count)? = Some(fragment);
        self.leaf_count += 1;
        Some(self.leaf_count as u8 - 1)
    }

    /// `None` if there are too many.
    #[inline]
    fn push(&mut self, step: Step) -> Option<()> {
        *self.steps.get_mut(self.count)? = step;
        self.count += 1;
        let own = match step {
            Step::Sheet(sheet, leaf) => {
                let [r, g, b, through] = sheet.channels().map(|v| u64::from(v.to_bits()));
                (r | g << 32) ^ (b << 7 | through << 27) ^ leaf.map_or(0, |leaf| 1 + u64::from(leaf))
            }
            Step::Start(composite) => 0x51 + u64::from(composite.opacity.to_bits()),
            Step::Middle => 0x52,
            Step::End => 0x53,
        };
        self.hash = (self.hash ^ own).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        Some(())
    }
}

impl ZLists<'_> {
    /// The colour of a pixel with a few fragments and groups, or `None` if this is not so.
    pub fn few_in_groups(&self, head: Head, around: &Surroundings, resolver: &mut Resolver) -> Option<Mean> {
        let reading = self.reading(head)?;
        let mut only = [0; 1 << MOST_LEAVES];
        let leaves = &reading.leaves[..reading.leaf_count];
        let areas = match leaves {
            [] => {
                only[0] = PIXEL_AREA;
                only
            }
            [leaf] => {
                let area = leaf.map_or(0, Fragment::area);
                (only[0], only[1]) = (PIXEL_AREA - area, area);
                resolver.counts.one_fragment += 1;
                only
            }
            _ => {
                resolver.few.clear();
                if !leaves.iter().flatten().all(|leaf| resolver.few.add(leaf, self.pieces)) {
                    return None;
                }
                let areas = resolver.few.areas()?;
                resolver.counts.few += 1;
                areas
            }
        };
        let mut mean = Mean::default();
        let colors = &mut resolver.known_colors;
        let slot = colors.slot(&reading, around.background);
        for (set, &area) in areas[..1 << leaves.len()].iter().enumerate().filter(|(_, &area)| area > 0) {
            mean.add(colors.color(slot, set), area, around.linear);
        }
        Some(mean)
    }

    fn reading(&self, head: Head) -> Option<Reading<'_>> {
        let (leaves, steps) = ([None; MOST_LEAVES], [Step::Middle; MOST_STEPS]);
        let mut reading = Reading { steps, count: 0, leaves, leaf_count: 0, hash: 0 };
        if head.front != Sheet::CLEAR {
            reading.push(Step::Sheet(head.front, None))?;
        }
        let mut next = head.first;
        while let Some(entry) = self.entries.get(next as usize) {
            next = entry.next;
            let step = match entry.kind {
                Kind::Sheet(sheet) if entry.part == WHOLE => Step::Sheet(sheet, None),
                Kind::Sheet(_) => {
                    let (fragment, sheet) = self.leaf(entry)?;
                    Step::Sheet(sheet, Some(reading.leaf(fragment, self.pieces)?))
                }
                Kind::Gradient(_) => return None,
                Kind::GroupStart(composite) => Step::Start(composite),
                Kind::GroupMiddle => Step::Middle,
                Kind::GroupEnd => Step::End,
            };
            reading.push(step)?;
        }
        Some(reading)
    }
}

fn identity(fragment: &Fragment, pieces: &[Piece]) -> Option<u64> {
    let mut borders = Borders::default();
    borders.add(fragment, pieces);
    borders.identity()
}

impl KnownColors {
    /// Where the list is kept from now on.
    fn slot(&mut self, reading: &Reading, background: Sheet) -> usize {
        if self.kept.is_empty() {
            let (steps, colors) = ([Step::Middle; MOST_STEPS], [Sheet::CLEAR; 1 << MOST_LEAVES]);
            self.kept = vec![Kept { steps, count: 0, background, known: 0, colors }; 1 << KEPT_BITS];
        }
        let slot = (reading.hash.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - KEPT_BITS)) as usize;
        let (kept, count) = (&mut self.kept[slot], reading.count);
        let is_same = kept.count == count
            && kept.background.is_same(background)
            && kept.steps[..count] == reading.steps[..count];
        if !is_same {
            (kept.steps[..count]).copy_from_slice(&reading.steps[..count]);
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
