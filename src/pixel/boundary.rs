//! The closed form for fragments whose borders cross seldom or never: takes them, makes the visible
//! regions and their areas, in integers.
//!
//! Where no border meets another but in end points, the set of fragments over a point is the same all
//! along one side of a piece. By Green's theorem a set's area is then a sum over the left border of
//! the pixel and over the pieces: each adds the area right of it to the set on its right side and
//! takes it from the set on its left.
//!
//! Where borders cross one another plainly, each such point takes the other fragment into the set or
//! out of it, for all that follows along the border ([`super::crossings`]). Borders that touch, or share
//! pieces, are cut until nothing meets but in end points, and the sides of each piece looked up anew;
//! pieces that two fragments share are both crossed at once. With many cuts Catmull's recursion is
//! cheaper.

use super::crossings::{Crossing, Crossings};
use super::cuts::{Cuts, MOST_ROUNDS};
use super::fragment::{joint, shared_ends, Fragment, PieceSteps, PIXEL_AREA};
use super::split::MOST_LEAVES;
use crate::edges::ONE;
use crate::scene::FillRule;
use crate::strips::{Piece, NO_PIECE};

/// More pieces than this are left to the integrator.
const MOST_PIECES: usize = 128;

/// Pieces cut more often than this are left to the integrator.
const MOST_CUTS: usize = 160;

/// A piece of one of the fragments.
#[derive(Clone, Copy, Debug)]
struct Chord {
    x0: i32,
    y0: i32,
    x1: i32,
    y1: i32,
    winding: i32,
    leaf: u32,
    /// The lesser and the greater of x0 and x1.
    left: i32,
    right: i32,
}

/// Integrates along borders; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Boundary {
    chords: Vec<Chord>,
    crossings: Crossings,
    cuts: Cuts,
    /// The fragments whose borders are one line, one bit each.
    is_chain: u64,
    /// Points in which pieces end that do not follow one another along a border.
    meetings: Vec<(i32, i32)>,
    parts: Vec<Chord>,
    /// (y, step of the winding number, fragment), down the left border.
    steps: Vec<(u16, i32, u32)>,
    /// Each fragment's winding number in the top left corner, and its rule.
    corner: Vec<(i32, FillRule)>,
    windings: Vec<i32>,
    /// The sets of fragments found, one bit each, and their areas.
    regions: Vec<(u64, i64)>,
}

impl Boundary {
    /// Forgets the last pixel's fragments.
    pub fn clear(&mut self) {
        self.chords.clear();
        self.steps.clear();
        self.corner.clear();
        self.is_chain = 0;
    }

    /// Adds a fragment whose own pieces do not cross each other; its number is the count of those added before.
    pub fn add(&mut self, fragment: &Fragment, pieces: &[Piece]) {
        let leaf = self.corner.len() as u32;
        self.is_chain |= u64::from(fragment.is_chain) << (leaf % 64);
        let mut base = PieceSteps::new(fragment.cover_left);
        let mut next = fragment.pieces;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            let winding = i32::from(piece.winding);
            if let Some((y, step)) = base.step(piece) {
                self.steps.push((y, step, leaf));
            }
            let [x0, y0, x1, y1] = [piece.x0, piece.y0, piece.x1, piece.y1].map(i32::from);
            if (x0, y0) != (x1, y1) {
                self.chords.push(Chord::new([x0, y0, x1, y1], winding, leaf));
            }
        }
        self.corner.push((base.corner(), fragment.rule));
    }

    /// The regions: sets of fragments, one bit each, and their areas, or `None` where borders cross.
    pub fn regions(&mut self) -> Option<&[(u64, i64)]> {
        if self.corner.len() > MOST_LEAVES || self.chords.len() > MOST_PIECES {
            return None;
        }
        let is_plain = self.find_crossings();
        if !is_plain && !self.part_borders() {
            return None;
        }
        self.regions.clear();
        self.sum_left_border();
        match is_plain {
            true => self.sum_across(),
            false => self.sum_pieces(),
        }
        self.mend_rounding();
        Some(&self.regions)
    }

    /// Finds where pieces of different fragments cross; `false` if any meet in another way.
    fn find_crossings(&mut self) -> bool {
        self.crossings.clear();
        for (i, a) in self.chords.iter().enumerate() {
            for (j, b) in self.chords[..i].iter().enumerate() {
                if a.is_apart(b) {
                    continue;
                }
                if a.leaf != b.leaf {
                    if !self.crossings.meet((i, a.ends(), a.leaf), (j, b.ends(), b.leaf)) {
                        return false;
                    }
                } else if self.is_chain >> a.leaf & 1 == 0 && a.touches(b, i - j) {
                    return false;
                }
            }
        }
        self.crossings.sort();
        true
    }

    /// The sums over pieces where borders cross but do not touch.
    fn sum_across(&mut self) {
        let crossings = std::mem::take(&mut self.crossings);
        let mut rest = crossings.sorted();
        // What lies left of the piece before, at its upper end and at its lower one.
        let mut before = (0, 0);
        for i in 0..self.chords.len() {
            let chord = self.chords[i];
            let own = rest.iter().take_while(|crossing| crossing.piece == i as u32).count();
            let (here, others) = rest.split_at(own);
            rest = others;
            let all = here.iter().fold(0, |all, crossing| all ^ 1 << crossing.leaf);
            let start = match i.checked_sub(1).and_then(|i| chord.joint(&self.chords[i])) {
                Some(joint) if joint == (chord.x0, chord.y0) => before.1,
                Some(_) => before.0 ^ all,
                None => {
                    let above = here.iter().filter(|crossing| crossing.is_above_middle);
                    above.fold(self.sides(i).0, |set, crossing| set ^ 1 << crossing.leaf)
                }
            };
            self.sum_parts(&chord, start, here);
            before = (start, start ^ all);
        }
        self.crossings = crossings;
    }

    /// The sums over the parts of one piece; `left` is the set left of its upper end.
    fn sum_parts(&mut self, chord: &Chord, mut left: u64, crossings: &[Crossing]) {
        let (mut x, mut y) = (chord.x0, chord.y0);
        let ends = crossings.iter().map(|c| (c.x, c.y, 1u64 << c.leaf));
        for (next_x, next_y, leaf) in ends.chain([(chord.x1, chord.y1, 0)]) {
            let area = i64::from(next_y - y) * i64::from(2 * ONE - x - next_x);
            self.add_area(left ^ 1 << chord.leaf, area);
            self.add_area(left, -area);
            (x, y) = (next_x, next_y);
            left ^= leaf;
        }
    }

    /// Cuts pieces until none meets another; `false` when there would be too many cuts.
    fn part_borders(&mut self) -> bool {
        for round in 0..MOST_ROUNDS {
            self.find_cuts(round > 0);
            match self.cuts.len() {
                0 => return true,
                1..=MOST_CUTS => self.cut(),
                _ => return false,
            }
        }
        false
    }

    /// Where pieces meet. Those of one fragment do not until they are `cut`.
    fn find_cuts(&mut self, cut: bool) {
        self.cuts.clear();
        self.meetings.clear();
        for (i, a) in self.chords.iter().enumerate() {
            for (j, b) in self.chords[..i].iter().enumerate() {
                let own = b.leaf == a.leaf;
                if own && self.is_chain >> a.leaf & 1 != 0 && !cut {
                    break;
                }
                if a.is_apart(b) {
                    continue;
                }
                if !(own && j + 1 == i) {
                    self.meetings.extend(shared_ends(a.ends(), b.ends()));
                }
                if !own || cut {
                    self.cuts.meet((i, a.ends()), (j, b.ends()));
                }
            }
        }
    }

    /// Replaces pieces by their parts between the cuts.
    fn cut(&mut self) {
        self.parts.clear();
        let mut cuts = self.cuts.sorted();
        for (i, chord) in self.chords.iter().enumerate() {
            let parts = &mut self.parts;
            cuts.parts(i, chord.ends(), |from, to| parts.extend(chord.part(from, to)));
        }
        std::mem::swap(&mut self.chords, &mut self.parts);
    }

    fn sum_left_border(&mut self) {
        self.steps.sort_unstable();
        self.windings.clear();
        self.windings.extend(self.corner.iter().map(|&(winding, _)| winding));
        let mut from = 0;
        for i in 0..self.steps.len() {
            let (y, step, leaf) = self.steps[i];
            self.add_area(self.inside(), i64::from(i32::from(y) - from) * i64::from(2 * ONE));
            from = y.into();
            self.windings[leaf as usize] += step;
        }
        self.add_area(self.inside(), i64::from(ONE - from) * i64::from(2 * ONE));
    }

    fn sum_pieces(&mut self) {
        let mut sides = (0, 0);
        for i in 0..self.chords.len() {
            let chord = self.chords[i];
            // Along a border the sides stay what they are until it meets another fragment's.
            let joint = i.checked_sub(1).and_then(|before| chord.joint(&self.chords[before]));
            if joint.is_none_or(|joint| self.meetings.contains(&joint)) {
                sides = self.sides(i);
            }
            let (left, right) = sides;
            if left != right {
                let area = i64::from(chord.y1 - chord.y0) * i64::from(2 * ONE - chord.x0 - chord.x1);
                self.add_area(right, area);
                self.add_area(left, -area);
            }
        }
    }

    /// The sets of fragments left and right of a piece; of a piece that several fragments share, all but
    /// the first count as having nothing on either side.
    fn sides(&mut self, i: usize) -> (u64, u64) {
        let Chord { x0, y0, x1, y1, .. } = self.chords[i];
        // The middle, in halves of fixed point; of a horizontal piece, just below it.
        let (x, y) = (x0 + x1, y0 + y1);
        self.windings.clear();
        self.windings.extend(self.corner.iter().map(|&(winding, _)| winding));
        for &(at, step, leaf) in &self.steps {
            self.windings[leaf as usize] += step * i32::from(2 * i32::from(at) <= y);
        }
        for (j, c) in self.chords.iter().enumerate() {
            if 2 * c.y0 <= y && y < 2 * c.y1 {
                let side = (c.x1 - c.x0) * (y - 2 * c.y0) - (x - 2 * c.x0) * (c.y1 - c.y0);
                self.windings[c.leaf as usize] += c.winding * i32::from(side < 0);
                if side == 0 && j < i {
                    return (0, 0);
                }
            }
        }
        let left = self.inside();
        for c in &self.chords[i..] {
            if (c.x0, c.y0, c.x1, c.y1) == (x0, y0, x1, y1) {
                self.windings[c.leaf as usize] += c.winding;
            }
        }
        (left, self.inside())
    }

    /// The fragments whose winding number is inside by their rule.
    #[inline]
    fn inside(&self) -> u64 {
        let bit = |(i, (&winding, &(_, rule))): (usize, (&i32, &(i32, FillRule)))| {
            u64::from(rule.inside(winding)) << i
        };
        self.windings.iter().zip(&self.corner).enumerate().map(bit).sum()
    }

    #[inline]
    fn add_area(&mut self, set: u64, area: i64) {
        match self.regions.iter_mut().find(|(known, _)| *known == set) {
            Some((_, sum)) => *sum += area,
            None => self.regions.push((set, area)),
        }
    }

    /// Pieces that were cut where they cross have rounded ends, so that a region may come out a few
    /// units short of nothing. It becomes nothing, at the largest one's cost.
    fn mend_rounding(&mut self) {
        let mut missing = 0;
        for (_, area) in &mut self.regions {
            missing += (*area).min(0);
            *area = (*area).max(0);
        }
        if let Some((_, largest)) = self.regions.iter_mut().max_by_key(|(set, area)| (*area, *set)) {
            *largest += missing;
        }
        debug_assert_eq!(self.regions.iter().map(|(_, area)| area).sum::<i64>(), PIXEL_AREA);
    }
}

impl Chord {
    fn new([x0, y0, x1, y1]: [i32; 4], winding: i32, leaf: u32) -> Chord {
        Chord { x0, y0, x1, y1, winding, leaf, left: x0.min(x1), right: x0.max(x1) }
    }

    /// Are the rectangles around them apart?
    #[inline]
    fn is_apart(&self, other: &Chord) -> bool {
        self.right < other.left || other.right < self.left || self.y1 < other.y0 || other.y1 < self.y0
    }

    /// Does it meet a piece of its own fragment, so many places before it, other than by following it?
    fn touches(&self, other: &Chord, places: usize) -> bool {
        shared_ends(self.ends(), other.ends()).count() > usize::from(places == 1)
    }

    /// Where this one goes on from the other, upwards or downwards as it does.
    #[inline]
    fn joint(&self, other: &Chord) -> Option<(i32, i32)> {
        if self.leaf != other.leaf || self.winding != other.winding {
            return None;
        }
        joint(self.ends(), other.ends())
    }

    fn ends(&self) -> [i32; 4] {
        [self.x0, self.y0, self.x1, self.y1]
    }

    /// The part between two points, if it has a length; it runs from the upper end to the lower.
    fn part(&self, (x0, y0): (i32, i32), (x1, y1): (i32, i32)) -> Option<Chord> {
        match (y0, x0).cmp(&(y1, x1)) {
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Less => Some(Chord::new([x0, y0, x1, y1], self.winding, self.leaf)),
            std::cmp::Ordering::Greater => Some(Chord::new([x1, y1, x0, y0], -self.winding, self.leaf)),
        }
    }
}
