//! The closed form for two fragments whose borders are one line each: takes them, makes the area that
//! they share.
//!
//! Two lines that do not touch leave four cases, told apart by which side of the other each line lies
//! on: the fragments share nothing, or one holds the other, or what they leave out shares nothing.

use super::fragment::{Fragment, PieceSteps, PIXEL_AREA};
use crate::edges::ONE;
use crate::strips::{Piece, NO_PIECE};

/// Lines of more pieces than this are left to the general sum along borders.
const MOST_PIECES: usize = 12;

/// One fragment's line.
struct Line<'a> {
    fragment: &'a Fragment,
    /// x0, y0, x1, y1, winding.
    pieces: [[i32; 5]; MOST_PIECES],
    count: usize,
    /// Left, top, right, bottom.
    bounds: [i32; 4],
    /// One of its points, above the pixel's lower border.
    point: [i32; 2],
}

/// The area that two fragments share, if their borders are lines that do not touch.
pub(crate) fn shared_area(a: &Fragment, b: &Fragment, pieces: &[Piece]) -> Option<i64> {
    if !(a.is_chain && b.is_chain) {
        return None;
    }
    let (line_a, line_b) = (Line::read(a, pieces)?, Line::read(b, pieces)?);
    if line_a.touches(&line_b) {
        return None;
    }
    match (line_b.is_inside(&line_a, pieces), line_a.is_inside(&line_b, pieces)) {
        (false, false) => Some(0),
        (false, true) => Some(b.area()),
        (true, false) => Some(a.area()),
        (true, true) => Some((a.area() + b.area() - PIXEL_AREA).max(0)),
    }
}

impl<'a> Line<'a> {
    fn read(fragment: &'a Fragment, pieces: &[Piece]) -> Option<Line<'a>> {
        let mut line = Line {
            fragment,
            pieces: [[0; 5]; MOST_PIECES],
            count: 0,
            bounds: [i32::MAX, i32::MAX, -1, -1],
            point: [0, ONE],
        };
        let mut next = fragment.pieces;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            let (x0, y0, x1, y1) = (piece.x0.into(), piece.y0.into(), piece.x1.into(), piece.y1.into());
            *line.pieces.get_mut(line.count)? = [x0, y0, x1, y1, piece.winding.into()];
            line.count += 1;
            if y0 < line.point[1] {
                line.point = [x0, y0];
            }
            let [left, top, right, bottom] = line.bounds;
            line.bounds = [left.min(x0).min(x1), top.min(y0), right.max(x0).max(x1), bottom.max(y1)];
        }
        (line.point[1] < ONE).then_some(line)
    }

    fn touches(&self, other: &Line) -> bool {
        let [left, top, right, bottom] = self.bounds;
        let [other_left, other_top, other_right, other_bottom] = other.bounds;
        let apart = right < other_left || other_right < left || bottom < other_top || other_bottom < top;
        let pieces = |line: &Line<'_>| line.pieces.into_iter().take(line.count);
        !apart && pieces(self).any(|a| pieces(other).any(|b| touch(a, b)))
    }

    /// Does the other line, which touches nothing of this one, lie inside this fragment?
    fn is_inside(&self, other: &Line, pieces: &[Piece]) -> bool {
        let [x, y] = other.point;
        let mut steps = PieceSteps::new(self.fragment.cover_left);
        let mut winding = 0;
        let mut next = self.fragment.pieces;
        for [x0, y0, x1, y1, piece_winding] in self.pieces.into_iter().take(self.count) {
            let piece = &pieces[next as usize];
            next = piece.next;
            if let Some((at, step)) = steps.step(piece) {
                winding += step * i32::from(i32::from(at) <= y);
            }
            let left = y0 <= y && y < y1 && (x1 - x0) * (y - y0) < (x - x0) * (y1 - y0);
            winding += piece_winding * i32::from(left);
        }
        self.fragment.rule.inside(winding + steps.corner())
    }
}

/// Do two pieces have a point in common? Some that have not are said to.
#[inline]
fn touch([ax0, ay0, ax1, ay1, _]: [i32; 5], [bx0, by0, bx1, by1, _]: [i32; 5]) -> bool {
    if ay1 < by0 || by1 < ay0 || ax0.max(ax1) < bx0.min(bx1) || bx0.max(bx1) < ax0.min(ax1) {
        return false;
    }
    let side_of_a = |x: i32, y: i32| (ax1 - ax0) * (y - ay0) - (ay1 - ay0) * (x - ax0);
    let side_of_b = |x: i32, y: i32| (bx1 - bx0) * (y - by0) - (by1 - by0) * (x - bx0);
    let (b0, b1) = (side_of_a(bx0, by0), side_of_a(bx1, by1));
    if (b0 > 0 && b1 > 0) || (b0 < 0 && b1 < 0) {
        return false;
    }
    let (a0, a1) = (side_of_b(ax0, ay0), side_of_b(ax1, ay1));
    !((a0 > 0 && a1 > 0) || (a0 < 0 && a1 < 0))
}
