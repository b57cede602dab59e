//! Takes pieces of different fragments, makes the points where they cross one another, in order along
//! each piece.
//!
//! A crossing is plain if each piece has its ends strictly on different sides of the other. The point
//! is rounded to the fixed-point grid, which moves the areas beside it by no more than half a unit
//! times a piece's length: what lies on which side is known exactly, and not from the rounded point.

use super::fragment::side;

/// Where one piece crosses another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// The piece that is crossed.
    pub piece: u32,
    /// The fragment that the other piece bounds.
    pub leaf: u32,
    pub x: i32,
    pub y: i32,
    /// Does it lie nearer to the piece's upper end than to its lower one?
    pub is_above_middle: bool,
    /// Share of the piece above it.
    share: f64,
}

/// Finds crossings; keeps its buffer from one pixel to the next.
#[derive(Default)]
pub(crate) struct Crossings {
    crossings: Vec<Crossing>,
}

impl Crossings {
    pub fn clear(&mut self) {
        self.crossings.clear();
    }

    /// Notes where two pieces cross, each given as number, x0, y0, x1, y1 and fragment; `false` if they
    /// meet in any other way, or too nearly do.
    #[inline]
    pub fn meet(
        &mut self,
        (i, a, leaf_a): (usize, [i32; 4], u32),
        (j, b, leaf_b): (usize, [i32; 4], u32),
    ) -> bool {
        let (a0, a1) = (side(b, a[0], a[1]), side(b, a[2], a[3]));
        if (a0 > 0 && a1 > 0) || (a0 < 0 && a1 < 0) {
            return true;
        }
        let (b0, b1) = (side(a, b[0], b[1]), side(a, b[2], b[3]));
        if (b0 > 0 && b1 > 0) || (b0 < 0 && b1 < 0) {
            return true;
        }
        // Nor may a piece be crossed in its very middle, where its sides are looked up.
        if [a0, a1, b0, b1].contains(&0) || a0 == -a1 || b0 == -b1 {
            return false;
        }
        let share = |from: i32, to: i32| f64::from(from) / (f64::from(from) - f64::from(to));
        let (share_a, share_b) = (share(a0, a1), share(b0, b1));
        // From the same piece, so that both get the same point.
        let (line, along) = if a <= b { (a, share_a) } else { (b, share_b) };
        let at = |from: i32, to: i32| from + crate::edges::round(f64::from(to - from) * along);
        let (x, y) = (at(line[0], line[2]), at(line[1], line[3]));
        let above = |from: i32, to: i32| from.abs() < to.abs();
        self.crossings.extend([
            Crossing { piece: i as u32, leaf: leaf_b, x, y, is_above_middle: above(a0, a1), share: share_a },
            Crossing { piece: j as u32, leaf: leaf_a, x, y, is_above_middle: above(b0, b1), share: share_b },
        ]);
        true
    }

    /// Puts them in order.
    pub fn sort(&mut self) {
        self.crossings.sort_unstable_by(|a, b| {
            a.piece.cmp(&b.piece).then(a.share.total_cmp(&b.share)).then(a.leaf.cmp(&b.leaf))
        });
    }

    /// All, piece by piece from the first, and on each from its upper end on.
    pub fn sorted(&self) -> &[Crossing] {
        &self.crossings
    }
}
