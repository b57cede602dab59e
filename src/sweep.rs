//! Takes the x-buckets of one shape in one row, makes solid runs and fragments, from left to right.

use crate::edges::FRACTION_BITS;
use crate::pixel::fragment::{Cover, Coverer, Fragment};
use crate::scene::FillRule;
use crate::strips::{Buckets, Piece, NO_PIECE};

/// What a row of a shape consists of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Span {
    /// Pixels [from, to) lie inside.
    Solid(usize, usize),
    /// A part of this pixel does.
    Part(usize, Fragment),
}

/// Sweeps rows; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Sweep {
    pub coverer: Coverer,
}

impl Sweep {
    /// Sweeps one row of a shape that lies within columns [from, to) and what winds round them, and
    /// empties its buckets. `crisp` shapes have no fragments: a pixel is inside if its centre is.
    #[inline]
    pub fn row(
        &mut self,
        buckets: &mut Buckets,
        (row, columns): (usize, (usize, usize)),
        (rule, crisp): (FillRule, bool),
        pieces: &mut Vec<Piece>,
        mut take: impl FnMut(Span),
    ) {
        // Winding times height of all that lies left, in 1/ONE. Between cells it is a whole number of
        // windings, for every edge that starts or ends there is in a cell.
        let mut cover_left = buckets.take_left(row);
        let mut inside = rule.inside(cover_left >> FRACTION_BITS);
        // Where the pixels inside that are not given out yet begin.
        let mut from = 0;
        buckets.drain_row(row, columns, |x, cell| {
            if cell.pieces != NO_PIECE {
                let here = if crisp {
                    self.coverer.cover_of_centre(cell, cover_left, rule, pieces)
                } else {
                    self.coverer.cover(cell, cover_left, rule, pieces)
                };
                let is_full = matches!(here, Cover::Full);
                if inside && !is_full && from < x {
                    take(Span::Solid(from, x));
                } else if !inside && is_full {
                    from = x;
                }
                inside = is_full;
                if let Cover::Part(fragment) = here {
                    take(Span::Part(x, fragment));
                }
            }
            cover_left += cell.cover;
            let goes_on = rule.inside(cover_left >> FRACTION_BITS);
            if inside && !goes_on {
                take(Span::Solid(from, x + 1));
            } else if !inside && goes_on {
                from = x + 1;
            }
            inside = goes_on;
        });
        let width = buckets.width();
        if inside && from < width {
            take(Span::Solid(from, width));
        }
    }
}
