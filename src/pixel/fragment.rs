//! Takes what one shape leaves in one pixel, makes a fragment: empty, the whole pixel, or a part with
//! its exact area.
//!
//! A cell knows the mean winding number of its pixel. That is the covered share as long as the winding
//! takes two neighbouring values there, one of them outside: the closed form. One piece always has it,
//! and so has a chain of pieces; for others there may be a certificate ([`super::certificate`]).
//! Anything else is cut at its crossings first ([`super::indicator`]).

use super::certificate::Certifier;
use super::indicator::Cleaner;
use super::sample::Sampler;
use crate::coverage::Style;
use crate::edges::{FRACTION_BITS, ONE};
use crate::scene::FillRule;
use crate::strips::{Cell, CrossesLeft, Piece, NO_PIECE};
use crate::sweep::FindCover;

/// Bits of [`PIXEL_AREA`].
const AREA_BITS: u32 = 2 * FRACTION_BITS + 1;
/// The whole pixel, in halves of a square of fixed point.
pub(crate) const PIXEL_AREA: i64 = 1 << AREA_BITS;

/// The part of a pixel that a shape covers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    /// The last of its pieces.
    pub pieces: u32,
    /// Winding times height of all edges left of the pixel, in 1/ONE.
    pub cover_left: i32,
    pub rule: FillRule,
    area: i32,
    /// In the pixel the fragment's indicator (1 inside, 0 outside) is, up to a constant, this times its
    /// winding number: 1 or -1. It is 0 when no such relation is known.
    pub sense: i8,
    /// Is its border one line through the pixel, which does not cross itself?
    pub is_chain: bool,
}

impl Fragment {
    /// 0 < area < [`PIXEL_AREA`].
    #[inline]
    pub fn area(&self) -> i64 {
        self.area.into()
    }
}

/// How much of a pixel a shape covers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cover<F = Fragment> {
    Empty,
    Full,
    Part(F),
}

/// Finds covers; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Coverer {
    set: PieceSet,
    certifier: Certifier,
    cleaner: Cleaner,
    sampler: Sampler,
    /// Fragments that crossed themselves, and those of them that had to be sampled.
    pub cleaned: u64,
    pub sampled: u64,
}

impl FindCover for Coverer {
    type Fragment = Fragment;

    #[inline(always)]
    fn find_cover(
        &mut self,
        cell: Cell,
        cover_left: i32,
        _: usize,
        style: Style,
        pieces: &mut Vec<Piece>,
    ) -> Cover {
        match style.crisp {
            false => self.cover(cell, cover_left, style.rule, pieces),
            true if self.has_centre_inside(cell.pieces, cover_left, style.rule, pieces) => Cover::Full,
            true => Cover::Empty,
        }
    }
}

impl Coverer {
    /// The exact cover of a pixel that holds pieces.
    #[inline(always)]
    pub fn cover(&mut self, cell: Cell, cover_left: i32, rule: FillRule, pieces: &mut Vec<Piece>) -> Cover {
        let total = i64::from(cover_left) * i64::from(2 * ONE) + cell.area;
        let mut border = Border { pieces: cell.pieces, cover_left, rule };
        let last = &pieces[cell.pieces as usize];
        if last.next == NO_PIECE || is_one_chain(last, pieces) {
            return part(two_valued(total, rule), border, true);
        }
        let area = self.area_of_many(&mut border, total, pieces);
        part(area, border, false)
    }

    /// Is a pixel's centre inside? Then all of it is, of a shape that is not anti-aliased.
    #[inline(never)]
    fn has_centre_inside(&mut self, last: u32, cover_left: i32, rule: FillRule, pieces: &[Piece]) -> bool {
        self.set.gather(last, cover_left, pieces);
        rule.inside(self.set.winding_at_half_units(ONE, ONE))
    }

    /// The covered area and [`Fragment::sense`]; `border` becomes a clean one if it is not.
    ///
    /// Not a whole [`Cover`]: that is handed over in memory, written in narrow stores, and a wide load of it, to copy the
    /// fragment, would find no store to be forwarded from.
    #[inline(never)]
    fn area_of_many(&mut self, border: &mut Border, total: i64, pieces: &mut Vec<Piece>) -> (i64, i8) {
        let Border { pieces: last, cover_left, rule } = *border;
        if self.certifier.is_two_valued(last, cover_left, (total >> AREA_BITS) as i32, pieces) {
            return two_valued(total, rule);
        }
        self.cleaned += 1;
        self.set.gather(last, cover_left, pieces);
        if let Some(clean) = self.cleaner.clean(&self.set, rule, pieces) {
            *border = Border { pieces: clean.pieces, cover_left: clean.cover_left, rule: FillRule::NonZero };
            return (clean.area.clamp(0, PIXEL_AREA), 1);
        }
        self.sampled += 1;
        self.sampler.clear();
        self.sampler.add(&self.set, rule);
        let mut area = 0;
        self.sampler.sample(|bits, share, _| area += share * (bits[0] & 1) as i64);
        (area, 0)
    }
}

/// What bounds a fragment: as the fields of [`Fragment`].
struct Border {
    pieces: u32,
    cover_left: i32,
    rule: FillRule,
}

#[inline(always)]
fn part((area, sense): (i64, i8), border: Border, is_chain: bool) -> Cover {
    let Border { pieces, cover_left, rule } = border;
    match area {
        0 => Cover::Empty,
        PIXEL_AREA => Cover::Full,
        _ => Cover::Part(Fragment { pieces, cover_left, rule, area: area as i32, sense, is_chain }),
    }
}

/// The covered area and [`Fragment::sense`] where the winding takes the values `floor(mean)` and
/// `floor(mean) + 1` only.
#[inline]
fn two_valued(total: i64, rule: FillRule) -> (i64, i8) {
    let low = (total >> AREA_BITS) as i32;
    let above = total & (PIXEL_AREA - 1);
    match (rule.inside(low), rule.inside(low + 1)) {
        (false, true) => (above, 1),
        (true, false) => (PIXEL_AREA - above, -1),
        (true, true) => (PIXEL_AREA, 0),
        // Unreachable for both rules: of two neighbours one is odd, and one is not zero.
        (false, false) => (0, 0),
    }
}

/// Are the pieces of the list that ends here one chain that cannot cross itself? So it is when each
/// goes on where the one before ends, always up or always down; or when there are just two, however
/// they meet.
#[inline]
fn is_one_chain(last: &Piece, pieces: &[Piece]) -> bool {
    let mut piece = last;
    let mut before = &pieces[last.next as usize];
    if before.next == NO_PIECE && before.winding != last.winding {
        return (before.x0, before.y0) == (last.x0, last.y0) || (before.x1, before.y1) == (last.x1, last.y1);
    }
    loop {
        let down = (before.x1, before.y1) == (piece.x0, piece.y0);
        let up = (before.x0, before.y0) == (piece.x1, piece.y1);
        // Two pieces of the same direction are a chain only if one ends where the other starts.
        if before.winding != piece.winding || !(if piece.winding > 0 { down } else { up }) {
            return false;
        }
        if before.next == NO_PIECE {
            return true;
        }
        (piece, before) = (before, &pieces[before.next as usize]);
    }
}

/// Finds the winding number in a pixel's top left corner from what crosses the left border.
pub(crate) struct PieceSteps {
    /// Winding times height down the left border, less what the steps so far add to it.
    left: i32,
}

impl PieceSteps {
    pub fn new(cover_left: i32) -> PieceSteps {
        PieceSteps { left: cover_left }
    }

    /// Where going down the left border the winding number changes, and by how much, due to this piece.
    #[inline]
    pub fn step(&mut self, piece: &Piece) -> Option<(u16, i32)> {
        let winding = i32::from(piece.winding);
        // An edge that comes in through the border was left of it above that point, one that goes out
        // is left of it below.
        let (y, step) = match piece.crosses_left {
            CrossesLeft::No => return None,
            CrossesLeft::AtStart => (piece.y0, -winding),
            CrossesLeft::AtEnd => (piece.y1, winding),
        };
        self.left -= step * (ONE - i32::from(y));
        Some((y, step))
    }

    /// The winding number in the corner, after all pieces.
    pub fn corner(&self) -> i32 {
        debug_assert_eq!(self.left % ONE, 0);
        self.left >> FRACTION_BITS
    }
}

/// The pieces of one fragment, each once, in an order that does not depend on how they were drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct PieceSet {
    /// Winding number at the pixel's top left corner.
    pub base: i32,
    /// Steps of the winding number going down the pixel's left border: (y, step).
    pub steps: Vec<(u16, i32)>,
    pub pieces: Vec<Segment>,
}

/// A piece, perhaps several times over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Segment {
    pub y0: u16,
    pub x0: u16,
    pub y1: u16,
    pub x1: u16,
    pub winding: i32,
}

impl PieceSet {
    /// The whole pixel.
    pub fn everywhere() -> PieceSet {
        PieceSet { base: 1, ..PieceSet::default() }
    }

    /// Reads the list that ends with piece `last`.
    pub fn gather(&mut self, last: u32, cover_left: i32, pieces: &[Piece]) {
        self.steps.clear();
        self.pieces.clear();
        let mut base = PieceSteps::new(cover_left);
        let mut next = last;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            let winding = i32::from(piece.winding);
            self.steps.extend(base.step(piece));
            if (piece.x0, piece.y0) != (piece.x1, piece.y1) {
                let Piece { x0, y0, x1, y1, .. } = *piece;
                self.pieces.push(Segment { y0, x0, y1, x1, winding });
            }
        }
        self.base = base.corner();
        self.pieces.sort_unstable();
        self.merge_equal();
    }

    /// Lines drawn there and back again vanish, those drawn twice count twice.
    pub fn merge_equal(&mut self) {
        let mut kept: usize = 0;
        for i in 0..self.pieces.len() {
            let piece = self.pieces[i];
            match self.pieces[..kept].last_mut() {
                Some(last)
                    if (last.x0, last.y0, last.x1, last.y1) == (piece.x0, piece.y0, piece.x1, piece.y1) =>
                {
                    last.winding += piece.winding;
                }
                _ => {
                    self.pieces[kept] = piece;
                    kept += 1;
                }
            }
        }
        self.pieces.truncate(kept);
        self.pieces.retain(|piece| piece.winding != 0);
    }

    /// The winding number at a point given in halves of fixed point. A piece through the point counts
    /// as left of it.
    pub fn winding_at_half_units(&self, x: i32, y: i32) -> i32 {
        self.winding_left_of(y)
            + self.pieces.iter().filter(|p| p.is_left_of(x, y)).map(|p| p.winding).sum::<i32>()
    }

    /// The winding number at the pixel's left border; `y` in halves of fixed point.
    pub fn winding_left_of(&self, y: i32) -> i32 {
        self.base
            + self.steps.iter().filter(|&&(at, _)| 2 * i32::from(at) <= y).map(|&(_, step)| step).sum::<i32>()
    }

    /// The winding number left of the middle of a piece; below it, when it is horizontal.
    pub fn winding_left_of_piece(&self, piece: usize) -> i32 {
        let [x0, y0, x1, y1] = self.pieces[piece].ends();
        let (x, y) = (x0 + x1, y0 + y1);
        // They are sorted by their upper ends.
        let near = self.pieces.iter().enumerate().take_while(|(_, p)| 2 * i32::from(p.y0) <= y);
        let left = near.filter(|&(i, p)| i != piece && p.is_left_of(x, y)).map(|(_, p)| p.winding);
        self.winding_left_of(y) + left.sum::<i32>()
    }
}

impl Piece {
    /// A number that only the same line in the same pixel has, but for one chance in 2^64.
    #[inline]
    pub fn identity(&self) -> u64 {
        let [x0, y0, x1, y1] = [self.x0, self.y0, self.x1, self.y1].map(u64::from);
        // The finalizer of SplitMix64 (Steele, Lea & Flood 2014).
        let mut z = (x0 | y0 << 16 | x1 << 32 | y1 << 48).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

impl Segment {
    /// The piece from one point to another, or none where they are the same; it runs from the upper
    /// end to the lower, so that its winding may turn round.
    pub fn between((x0, y0): (i32, i32), (x1, y1): (i32, i32), winding: i32) -> Option<Segment> {
        let [fx0, fy0, fx1, fy1] = [x0, y0, x1, y1].map(|v| v as u16);
        match (y0, x0).cmp(&(y1, x1)) {
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Less => Some(Segment { y0: fy0, x0: fx0, y1: fy1, x1: fx1, winding }),
            std::cmp::Ordering::Greater => {
                Some(Segment { y0: fy1, x0: fx1, y1: fy0, x1: fx0, winding: -winding })
            }
        }
    }

    /// Does a horizontal ray from the point to the left meet it? Heights are half-open: [y0, y1).
    #[inline]
    fn is_left_of(&self, x: i32, y: i32) -> bool {
        let (x0, y0) = (2 * i32::from(self.x0), 2 * i32::from(self.y0));
        let (x1, y1) = (2 * i32::from(self.x1), 2 * i32::from(self.y1));
        y0 <= y && y < y1 && i64::from(x1 - x0) * i64::from(y - y0) <= i64::from(x - x0) * i64::from(y1 - y0)
    }

    /// Where it crosses a horizontal line, in fixed point; `y` in halves of it, heights half-open.
    pub fn x_at(&self, y: i32) -> Option<f64> {
        let (y0, y1) = (2 * i32::from(self.y0), 2 * i32::from(self.y1));
        let share = || f64::from(y - y0) / f64::from(y1 - y0);
        let (x0, x1) = (f64::from(self.x0), f64::from(self.x1));
        (y0 <= y && y < y1).then(|| x0 + (x1 - x0) * share())
    }

    pub fn ends(&self) -> [i32; 4] {
        [self.x0, self.y0, self.x1, self.y1].map(i32::from)
    }
}

/// Where the first piece goes on from the second, upwards or downwards as it does.
#[inline]
pub(crate) fn joint([x0, y0, x1, y1]: [i32; 4], other: [i32; 4]) -> Option<(i32, i32)> {
    let [other_x0, other_y0, other_x1, other_y1] = other;
    match ((x0, y0) == (other_x1, other_y1), (x1, y1) == (other_x0, other_y0)) {
        (true, _) => Some((x0, y0)),
        (_, true) => Some((x1, y1)),
        _ => None,
    }
}

/// The end points that two pieces have in common.
#[inline]
pub(crate) fn shared_ends([x0, y0, x1, y1]: [i32; 4], other: [i32; 4]) -> impl Iterator<Item = (i32, i32)> {
    let [other_x0, other_y0, other_x1, other_y1] = other;
    let others = [(other_x0, other_y0), (other_x1, other_y1)];
    [(x0, y0), (x1, y1)].into_iter().filter(move |end| others.contains(end))
}

/// Which side of line `a` the point lies on: twice the area of the triangle they make, in fixed point.
#[inline]
pub(crate) fn side([x0, y0, x1, y1]: [i32; 4], x: i32, y: i32) -> i32 {
    (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
}

/// Do two pieces, given as x0, y0, x1, y1 from 0 to ONE, meet other than in their end points? The same
/// piece twice does not count.
#[inline]
pub(crate) fn interiors_meet(a: [i32; 4], b: [i32; 4]) -> bool {
    let [ax0, ay0, ax1, ay1] = a;
    let [bx0, by0, bx1, by1] = b;
    if ay1 < by0 || by1 < ay0 || ax0.max(ax1) < bx0.min(bx1) || bx0.max(bx1) < ax0.min(ax1) {
        return false;
    }
    let (a0, a1) = (side(b, ax0, ay0).signum(), side(b, ax1, ay1).signum());
    let (b0, b1) = (side(a, bx0, by0).signum(), side(a, bx1, by1).signum());
    if (a0, a1) == (0, 0) {
        // On one line they overlap unless one ends where the other starts, or before.
        let order = |x: i32, y: i32| if ay0 == ay1 { x } else { y };
        return a != b && order(ax0, ay0) < order(bx1, by1) && order(bx0, by0) < order(ax1, ay1);
    }
    a0 * a1 <= 0 && b0 * b1 <= 0 && (a0 * a1 < 0 || b0 * b1 < 0)
}
