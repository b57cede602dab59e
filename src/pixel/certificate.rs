//! Takes the pieces of one shape in one pixel, makes a certificate that the winding number takes two
//! neighbouring values there, so that the covered area is a closed form of the mean winding number.
//!
//! Where no two pieces cross, the winding number stays what it is all along one side of a border, up
//! to a point in which other pieces end; and every region of the pixel has a piece at its border. So
//! it is looked up where a border begins, and once more behind each such point.

use super::fragment::{interiors_meet, joint, shared_ends, PieceSteps};
use crate::edges::ONE;
use crate::strips::{Piece, NO_PIECE};

/// More pieces than this are not searched for crossings pair by pair.
const MOST_PIECES: usize = 48;

/// Looks for certificates; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Certifier {
    lines: Vec<Line>,
    /// Points in which pieces end that do not follow one another along a border.
    meetings: Vec<(i32, i32)>,
    /// Steps of the winding number going down the pixel's left border: (y, step).
    steps: Vec<(i32, i32)>,
    /// The winding number in the pixel's top left corner.
    corner: i32,
}

/// A piece: x0, y0, x1, y1, and its winding.
#[derive(Clone, Copy)]
struct Line {
    ends: [i32; 4],
    winding: i32,
}

impl Line {
    /// Does it begin at one height where the other ends, as most pieces of a border do? Then they meet
    /// nowhere else.
    fn goes_on_from(&self, other: &Line) -> bool {
        let is_level = |[_, y0, _, y1]: [i32; 4]| y0 == y1;
        self.winding == other.winding
            && joint(self.ends, other.ends).is_some()
            && !(is_level(self.ends) || is_level(other.ends))
    }
}

impl Certifier {
    /// Does the winding number take no values but `low` and `low + 1`? A `false` may be wrong, a `true`
    /// is not.
    pub fn is_two_valued(&mut self, last: u32, cover_left: i32, low: i32, pieces: &[Piece]) -> bool {
        self.read(last, cover_left, pieces) && self.are_apart() && self.windings_are(low)
    }

    fn read(&mut self, last: u32, cover_left: i32, pieces: &[Piece]) -> bool {
        self.lines.clear();
        self.steps.clear();
        let mut base = PieceSteps::new(cover_left);
        let mut next = last;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            self.steps.extend(base.step(piece).map(|(y, step)| (i32::from(y), step)));
            let ends = [piece.x0, piece.y0, piece.x1, piece.y1].map(i32::from);
            debug_assert_ne!(ends[1], ONE, "below a piece on the lower border nothing is known");
            if (ends[0], ends[1]) != (ends[2], ends[3]) {
                self.lines.push(Line { ends, winding: piece.winding.into() });
            }
        }
        self.corner = base.corner();
        self.lines.len() <= MOST_PIECES
    }

    /// Does no piece meet another but in end points, or lie upon it? Notes those points.
    fn are_apart(&mut self) -> bool {
        self.meetings.clear();
        for (i, a) in self.lines.iter().enumerate() {
            let ([ax0, ay0, ax1, ay1], follows) = (a.ends, i.wrapping_sub(1));
            let (left, right) = (ax0.min(ax1), ax0.max(ax1));
            for (j, b) in self.lines[..i].iter().enumerate() {
                let [bx0, by0, bx1, by1] = b.ends;
                if by1 < ay0 || ay1 < by0 || bx0.max(bx1) < left || right < bx0.min(bx1) {
                    continue;
                }
                if j == follows && a.goes_on_from(b) {
                    continue;
                }
                if a.ends == b.ends || interiors_meet(a.ends, b.ends) {
                    return false;
                }
                if j != follows {
                    self.meetings.extend(shared_ends(a.ends, b.ends));
                }
            }
        }
        true
    }

    fn windings_are(&self, low: i32) -> bool {
        let mut left = 0;
        self.lines.iter().enumerate().all(|(i, line)| {
            let before = i.checked_sub(1).map(|before| &self.lines[before]);
            let before = before.filter(|before| before.winding == line.winding);
            let joint = before.and_then(|before| joint(line.ends, before.ends));
            if joint.is_none_or(|joint| self.meetings.contains(&joint)) {
                left = self.winding_left_of(i);
            }
            // Right of a piece its winding is added; the upper side of a horizontal one is its right.
            low <= left.min(left + line.winding) && left.max(left + line.winding) <= low + 1
        })
    }

    /// The winding number left of the middle of a piece; below it, when it is horizontal.
    fn winding_left_of(&self, i: usize) -> i32 {
        let [x0, y0, x1, y1] = self.lines[i].ends;
        // In halves of fixed point.
        let (x, y) = (x0 + x1, y0 + y1);
        let left: i32 = self.steps.iter().map(|&(at, step)| step * i32::from(2 * at <= y)).sum();
        let is_left = |line: &Line| {
            let [x0, y0, x1, y1] = line.ends.map(|v| 2 * v);
            y0 <= y && y < y1 && (x1 - x0) * (y - y0) <= (x - x0) * (y1 - y0)
        };
        let others = self.lines.iter().enumerate().filter(|&(j, line)| j != i && is_left(line));
        self.corner + left + others.map(|(_, line)| line.winding).sum::<i32>()
    }
}
