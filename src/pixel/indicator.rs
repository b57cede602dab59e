//! Takes the pieces of a fragment that crosses itself, makes the border of what its rule fills.
//!
//! Pieces are cut where they meet, in points of the fixed-point grid; of the parts only those stay that
//! have the inside on one side. From there on the fragment is 1 inside and 0 outside, its own border
//! does not cross itself, and no later stage needs its fill rule.

use super::fragment::{interiors_meet, side, PieceSet, Segment};
use crate::edges::ONE;
use crate::scene::FillRule;
use crate::strips::{CrossesLeft, Piece, NO_PIECE};

/// More pieces than this in one pixel are sampled.
const MOST_PIECES: usize = 200;

/// More crossings than this in one pixel are sampled.
const MOST_CUTS: usize = 4000;

/// Cleans fragments; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Cleaner {
    /// (piece, y, x): where a piece is cut.
    cuts: Vec<(u32, i32, i32)>,
    parts: PieceSet,
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
        self.find_cuts(&set.pieces);
        if self.cuts.len() > MOST_CUTS {
            return None;
        }
        self.cut(set);
        Some(self.keep_borders(rule, pieces))
    }

    fn find_cuts(&mut self, all: &[Segment]) {
        self.cuts.clear();
        for (i, a) in all.iter().enumerate() {
            // They are sorted by their upper ends.
            for (j, b) in all.iter().enumerate().skip(i + 1).take_while(|(_, b)| b.y0 <= a.y1) {
                let (ends_a, ends_b) = (a.ends(), b.ends());
                if interiors_meet(ends_a, ends_b) {
                    self.cut_pair((i as u32, ends_a), (j as u32, ends_b));
                }
            }
            if self.cuts.len() > MOST_CUTS {
                return;
            }
        }
    }

    fn cut_pair(&mut self, (i, a): (u32, [i32; 4]), (j, b): (u32, [i32; 4])) {
        let [ax0, ay0, ax1, ay1] = a;
        let [bx0, by0, bx1, by1] = b;
        let (a0, a1) = (side(b, ax0, ay0), side(b, ax1, ay1));
        let (b0, b1) = (side(a, bx0, by0), side(a, bx1, by1));
        if (a0, a1) == (0, 0) {
            // On one line: each is cut at the other's ends. Ends outside are dropped later.
            self.cuts.extend([(i, by0, bx0), (i, by1, bx1), (j, ay0, ax0), (j, ay1, ax1)]);
            return;
        }
        // An end that lies on the other piece is where they meet; it need not be rounded.
        let (x, y) = if a0 == 0 {
            (ax0, ay0)
        } else if a1 == 0 {
            (ax1, ay1)
        } else if b0 == 0 {
            (bx0, by0)
        } else if b1 == 0 {
            (bx1, by1)
        } else {
            let share = f64::from(a0) / (f64::from(a0) - f64::from(a1));
            let at = |from: i32, to: i32| from + (f64::from(to - from) * share).round_ties_even() as i32;
            (at(ax0, ax1), at(ay0, ay1))
        };
        self.cuts.extend([(i, y, x), (j, y, x)]);
    }

    /// Makes `parts` the pieces between the cuts.
    fn cut(&mut self, set: &PieceSet) {
        self.cuts.sort_unstable();
        self.parts.base = set.base;
        self.parts.steps.clone_from(&set.steps);
        self.parts.pieces.clear();
        let mut cuts = &self.cuts[..];
        for (i, piece) in set.pieces.iter().enumerate() {
            let own = cuts.partition_point(|cut| cut.0 == i as u32);
            let (here, rest) = cuts.split_at(own);
            cuts = rest;
            let [x0, y0, x1, y1] = piece.ends();
            let (mut x, mut y) = (x0, y0);
            let mut part_to = |next_x: i32, next_y: i32| {
                self.parts.pieces.extend(Segment::between((x, y), (next_x, next_y), piece.winding));
                (x, y) = (next_x, next_y);
            };
            // Cuts are sorted by y; along a piece that runs to the left, those in one row are not by x.
            let leftwards = x1 < x0;
            let mut from = 0;
            while from < here.len() {
                let same_y = here[from..].partition_point(|cut| cut.1 == here[from].1);
                let row = &here[from..from + same_y];
                let mut one = |&(_, cut_y, cut_x): &(u32, i32, i32)| {
                    let within = y0 <= cut_y && cut_y <= y1 && x0.min(x1) <= cut_x && cut_x <= x0.max(x1);
                    if within {
                        part_to(cut_x, cut_y);
                    }
                };
                if leftwards {
                    row.iter().rev().for_each(&mut one);
                } else {
                    row.iter().for_each(&mut one);
                }
                from += same_y;
            }
            part_to(x1, y1);
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
        for (i, part) in self.parts.pieces.iter().enumerate() {
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
