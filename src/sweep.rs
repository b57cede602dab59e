//! Takes the x-buckets of one shape in one row, makes solid runs and fragments, from left to right.

use crate::coverage::{Parts, Style, TakeSpans};
use crate::edges::FRACTION_BITS;
use crate::pixel::fragment::Cover;
use crate::strips::{Buckets, Cell, Piece, NO_PIECE};

/// Finds how much of a pixel a shape covers, from the irregular pieces there.
pub(crate) trait FindCover {
    type Fragment;

    /// The cover of the pixel at column `x` of the row at hand, which holds pieces. `cover_left` is winding
    /// times height of all that lies left of it, in 1/ONE.
    fn find_cover(
        &mut self,
        cell: Cell,
        cover_left: i32,
        x: usize,
        style: Style,
        pieces: &mut Vec<Piece>,
    ) -> Cover<Self::Fragment>;
}

/// Sweeps one row of a shape that lies within columns [from, to) and what winds round them, and empties
/// its buckets.
#[inline]
pub(crate) fn row<A: Parts>(
    buckets: &mut Buckets,
    (row, columns): (usize, (usize, usize)),
    style: Style,
    (finder, pieces): (&mut impl FindCover<Fragment = A::Fragment>, &mut Vec<Piece>),
    parts: &mut A,
    take: &mut impl TakeSpans<A>,
) {
    let rule = style.rule;
    // Winding times height of all that lies left, in 1/ONE. Between cells it is a whole number of
    // windings, for every edge that starts or ends there is in a cell.
    let mut cover_left = buckets.take_left(row);
    let mut inside = rule.inside(cover_left >> FRACTION_BITS);
    // Where the pixels inside that are not given out yet begin.
    let mut from = 0;
    buckets.drain_row(row, columns, |x, cell| {
        let here = match cell.pieces {
            NO_PIECE if inside => Cover::Full,
            NO_PIECE => Cover::Empty,
            _ => finder.find_cover(cell, cover_left, x, style, pieces),
        };
        cover_left += cell.cover;
        let goes_on = rule.inside(cover_left >> FRACTION_BITS);
        let is_full = matches!(here, Cover::Full);
        if is_full && !inside {
            from = x;
        }
        let to = x + usize::from(is_full);
        if (inside || is_full) && !(is_full && goes_on) && from < to {
            take.solid(from, to, parts);
        }
        if let Cover::Part(fragment) = here {
            take.part(x, fragment, parts);
        }
        if goes_on && !is_full {
            from = x + 1;
        }
        inside = goes_on;
    });
    let width = buckets.width();
    if inside && from < width {
        take.solid(from, width, parts);
    }
}
