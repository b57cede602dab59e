//! Takes pieces that meet, makes the parts between their meeting points, all on the fixed-point grid.
//!
//! Rounding a meeting point may make a part meet another piece, so one cuts until nothing meets any
//! more: what is summed along parts counts on that, and a careless rest would cost whole pixels.

use super::fragment::{interiors_meet, side};

/// Rounds of cutting after which one gives up.
pub(crate) const MOST_ROUNDS: usize = 5;

/// Where pieces are cut.
#[derive(Default)]
pub(crate) struct Cuts {
    /// (piece, y, x)
    cuts: Vec<(u32, i32, i32)>,
}

impl Cuts {
    pub fn clear(&mut self) {
        self.cuts.clear();
    }

    /// How often pieces are cut.
    pub fn len(&self) -> usize {
        self.cuts.len()
    }

    /// Cuts two pieces, given as number and x0, y0, x1, y1, where they meet.
    #[inline]
    pub fn meet(&mut self, (i, a): (usize, [i32; 4]), (j, b): (usize, [i32; 4])) {
        if interiors_meet(a, b) {
            // In one order, so that the same two lines give the same point, whoever they belong to.
            let (one, other) = ((i as u32, a), (j as u32, b));
            if a <= b {
                self.cut(one, other);
            } else {
                self.cut(other, one);
            }
        }
    }

    fn cut(&mut self, (i, a): (u32, [i32; 4]), (j, b): (u32, [i32; 4])) {
        let [ax0, ay0, ax1, ay1] = a;
        let [bx0, by0, bx1, by1] = b;
        let (a0, a1) = (side(b, ax0, ay0), side(b, ax1, ay1));
        let (b0, b1) = (side(a, bx0, by0), side(a, bx1, by1));
        if (a0, a1) == (0, 0) {
            // On one line: each is cut at the other's ends. Those outside are dropped later.
            self.cuts.extend([(i, by0, bx0), (i, by1, bx1), (j, ay0, ax0), (j, ay1, ax1)]);
            return;
        }
        // An end that lies on the other piece is where they meet; it need not be rounded.
        let (x, y) = match [a0, a1, b0, b1].iter().position(|&side| side == 0) {
            Some(0) => (ax0, ay0),
            Some(1) => (ax1, ay1),
            Some(2) => (bx0, by0),
            Some(_) => (bx1, by1),
            None => {
                let share = f64::from(a0) / (f64::from(a0) - f64::from(a1));
                let at = |from: i32, to: i32| from + crate::edges::round(f64::from(to - from) * share);
                (at(ax0, ax1), at(ay0, ay1))
            }
        };
        self.cuts.extend([(i, y, x), (j, y, x)]);
    }

    /// Puts the cuts in order; [`SortedCuts::parts`] may be called for the pieces from the first to the last.
    pub fn sorted(&mut self) -> SortedCuts<'_> {
        self.cuts.sort_unstable();
        SortedCuts { rest: &self.cuts }
    }
}

/// Cuts that are handed out piece by piece.
pub(crate) struct SortedCuts<'a> {
    rest: &'a [(u32, i32, i32)],
}

impl SortedCuts<'_> {
    /// Gives `take` the ends of each part of the next piece, from its start on; some may be of no
    /// length.
    pub fn parts(&mut self, piece: usize, ends: [i32; 4], mut take: impl FnMut((i32, i32), (i32, i32))) {
        let own = self.rest.iter().take_while(|cut| cut.0 == piece as u32).count();
        let (mut here, rest) = self.rest.split_at(own);
        self.rest = rest;
        let [x0, y0, x1, y1] = ends;
        let mut from = (x0, y0);
        let mut part_to = |x: i32, y: i32| {
            if y0 <= y && y <= y1 && x0.min(x1) <= x && x <= x0.max(x1) {
                take(from, (x, y));
                from = (x, y);
            }
        };
        // In order of y, and of one y in order along the piece.
        while let Some(&(_, y, _)) = here.first() {
            let same = here.partition_point(|cut| cut.1 == y);
            let (row, rest) = here.split_at(same);
            here = rest;
            if x1 < x0 {
                row.iter().rev().for_each(|cut| part_to(cut.2, cut.1));
            } else {
                row.iter().for_each(|cut| part_to(cut.2, cut.1));
            }
        }
        part_to(x1, y1);
    }
}
