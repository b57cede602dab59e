//! Takes the pieces of a fragment that crosses itself, makes the border of what its rule fills.
//!
//! Pieces are cut where they meet, in points of the fixed-point grid; of the parts only those stay that
//! have the inside on one side. From there on the fragment is 1 inside and 0 outside, its own border
//! does not cross itself, and no later stage needs its fill rule.

use super::cuts::{Cuts, MOST_ROUNDS};
use super::fragment::{PieceSet, Segment};
use crate::edges::ONE;
use crate::scene::FillRule;
use crate::strips::{CrossesLeft, Piece, NO_PIECE};

/// More pieces than this in one pixel are sampled.
const MOST_PIECES: usize = 160;

/// Pieces that are cut more often than this in one pixel are sampled.
const MOST_CUTS: usize = 400;

/// Cleans fragments; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Cleaner {
    cuts: Cuts,
    parts: PieceSet,
    uncut: Vec<Segment>,
}

/// A clean fragment: the last of its pieces, what the edges left of it cover, and its area.
pub(crate) struct Clean {
    pub pieces: u32,
    pub cover_left: i32,
    pub area: i64,
}

impl Cleaner {
    /// Cleans `set` and adds the pieces to `pieces`; `None` when there are too many.
    pub fn clean(&mut self, set: &PieceSet, rule: FillRule, pieces: &mut Vec<Piece>) -> Option<Clean> {
        if set.pieces.len() > MOST_PIECES {
            return None;
        }
        self.parts.clone_from(set);
        for _ in 0..MOST_ROUNDS {
            self.find_cuts();
            match self.cuts.len() {
                0 => return Some(self.keep_borders(rule, pieces)),
                1..=MOST_CUTS => self.cut(),
                _ => return None,
            }
        }
        None
    }

    fn find_cuts(&mut self) {
        self.cuts.clear();
        let all = &self.parts.pieces[..];
        for (i, a) in all.iter().enumerate() {
            let (left, right) = (a.x0.min(a.x1), a.x0.max(a.x1));
            // They are sorted by their upper ends.
            for (j, b) in all.iter().enumerate().skip(i + 1).take_while(|(_, b)| b.y0 <= a.y1) {
                if b.x0.max(b.x1) >= left && b.x0.min(b.x1) <= right {
                    self.cuts.meet((i, a.ends()), (j, b.ends()));
                }
            }
            if self.cuts.len() > MOST_CUTS {
                return;
            }
        }
    }

    /// Replaces the pieces by their parts between the cuts.
    fn cut(&mut self) {
        self.uncut.clear();
        std::mem::swap(&mut self.uncut, &mut self.parts.pieces);
        let mut cuts = self.cuts.sorted();
        for (i, piece) in self.uncut.iter().enumerate() {
            let parts = &mut self.parts.pieces;
            cuts.parts(i, piece.ends(), |from, to| parts.extend(Segment::between(from, to, piece.winding)));
        }
        self.parts.pieces.sort_unstable();
        self.parts.merge_equal();
    }

    /// Adds the parts that have the inside on one side.
    fn keep_borders(&mut self, rule: FillRule, pieces: &mut Vec<Piece>) -> Clean {
        let mut clean = Clean { pieces: NO_PIECE, cover_left: 0, area: 0 };
        let mut push = |x0: u16, y0: u16, x1: u16, y1: u16, winding: i32, crosses_left| {
            let next = std::mem::replace(&mut clean.pieces, pieces.len() as u32);
            pieces.push(Piece { x0, y0, x1, y1, next, winding: winding as i8, crosses_left });
        };
        // Down the left border.
        self.parts.steps.sort_unstable();
        let mut winding = self.parts.base;
        let mut inside = i32::from(rule.inside(winding));
        let mut from = 0;
        for &(y, step) in &self.parts.steps {
            clean.cover_left += inside * (i32::from(y) - from);
            from = y.into();
            winding += step;
            let now = i32::from(rule.inside(winding));
            if now != inside {
                push(0, y, 0, y, now - inside, CrossesLeft::AtEnd);
                inside = now;
            }
        }
        clean.cover_left += inside * (ONE - from);
        let mut area = i64::from(clean.cover_left) * i64::from(2 * ONE);
        // A part on the lower border bounds nothing inside.
        for (i, part) in self.parts.pieces.iter().enumerate().filter(|(_, part)| i32::from(part.y0) < ONE) {
            let left = self.parts.winding_left_of_piece(i);
            let change = i32::from(rule.inside(left + part.winding)) - i32::from(rule.inside(left));
            if change != 0 {
                let [x0, y0, x1, y1] = part.ends();
                area += i64::from(change * (y1 - y0)) * i64::from(2 * ONE - x0 - x1);
                push(part.x0, part.y0, part.x1, part.y1, change, CrossesLeft::No);
            }
        }
        Clean { area, ..clean }
    }
}
