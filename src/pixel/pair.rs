//! The closed form for two fragments: takes their borders, makes the area that they share.
//!
//! By Green's theorem it is a sum over the pixel's left border, as far as it lies in both, and over the
//! pieces of each fragment, as far as they lie inside the other: each adds the area right of it where
//! it has its fragment's inside on its right, and takes that away where it has it on its left. Whether
//! a piece lies inside the other fragment is looked up where a border begins; it changes where the
//! other's border is crossed. Borders that touch are left to others.

use super::fragment::{side, Fragment, PieceSteps, PIXEL_AREA};
use crate::edges::{round, ONE};
use crate::scene::FillRule;
use crate::strips::{Piece, NO_PIECE};

/// Borders of more pieces than this are left to the general sum along borders.
const MOST_PIECES: usize = 24;

/// Pairs fragments; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Pair {
    borders: [Border; 2],
    crossings: Vec<Crossing>,
}

/// One fragment's border.
struct Border {
    lines: Vec<Line>,
    /// Steps of the winding number going down the pixel's left border: (y, step).
    steps: Vec<(i32, i32)>,
    /// The winding number in the pixel's top left corner.
    corner: i32,
    rule: FillRule,
    sense: i32,
    /// Left, top, right, bottom.
    bounds: [i32; 4],
}

/// A piece, from the upper end to the lower.
#[derive(Clone, Copy)]
struct Line {
    ends: [i32; 4],
    winding: i32,
}

/// Where a line of the first border, and one of the second, cross.
#[derive(Clone, Copy)]
struct Crossing {
    lines: [u32; 2],
    /// Shares of the lines above it.
    shares: [f64; 2],
    at: (i32, i32),
}

/// How two lines meet.
enum Meeting {
    Apart,
    Touch,
    Cross { shares: [f64; 2], at: (i32, i32) },
}

impl Pair {
    /// The area that two fragments share, if their borders do not touch.
    pub fn shared_area(&mut self, a: &Fragment, b: &Fragment, pieces: &[Piece]) -> Option<i64> {
        let [border_a, border_b] = &mut self.borders;
        if !(border_a.read(a, pieces) && border_b.read(b, pieces) && self.find_crossings()) {
            return None;
        }
        let shared = self.along_left_border() + self.along(0) + self.along(1);
        // Crossings are rounded to the fixed-point grid.
        Some(shared.clamp((a.area() + b.area() - PIXEL_AREA).max(0), a.area().min(b.area())))
    }

    /// `false` if any lines touch.
    fn find_crossings(&mut self) -> bool {
        let [a, b] = &self.borders;
        self.crossings.clear();
        if are_apart(a.bounds, b.bounds) {
            return true;
        }
        for (i, one) in a.lines.iter().enumerate() {
            for (j, other) in b.lines.iter().enumerate() {
                match meeting(one.ends, other.ends) {
                    Meeting::Apart => {}
                    Meeting::Touch => return false,
                    Meeting::Cross { shares, at } => {
                        self.crossings.push(Crossing { lines: [i as u32, j as u32], shares, at });
                    }
                }
            }
        }
        true
    }

    /// What lies right of the pixel's left border where that lies in both.
    fn along_left_border(&mut self) -> i64 {
        let [a, b] = &mut self.borders;
        let (mut from, mut height) = (0, 0);
        let (mut winding_a, mut winding_b) = (a.corner, b.corner);
        a.steps.sort_unstable();
        b.steps.sort_unstable();
        let (mut steps_a, mut steps_b) = (&a.steps[..], &b.steps[..]);
        loop {
            let next = |steps: &[(i32, i32)]| steps.first().map_or(ONE, |&(y, _)| y);
            let y = next(steps_a).min(next(steps_b));
            if a.rule.inside(winding_a) && b.rule.inside(winding_b) {
                height += y - from;
            }
            from = y;
            match (steps_a, steps_b) {
                ([(at, step), rest @ ..], _) if *at == y => (winding_a, steps_a) = (winding_a + step, rest),
                (_, [(at, step), rest @ ..]) if *at == y => (winding_b, steps_b) = (winding_b + step, rest),
                _ => break,
            }
        }
        i64::from(height) * i64::from(2 * ONE)
    }

    /// What lies right of one fragment's pieces inside the other, less what lies right of those that
    /// have their own fragment on their left.
    fn along(&mut self, own: usize) -> i64 {
        let (border, other) = (&self.borders[own], &self.borders[1 - own]);
        let crossings = &mut self.crossings;
        if crossings.len() > 1 {
            crossings.sort_unstable_by(|a, b| a.shares[own].total_cmp(&b.shares[own]));
        }
        let mut sum = 0;
        // The ends of the piece before, and whether they lie inside the other fragment.
        let mut before: Option<([i32; 4], bool, bool)> = None;
        for (i, line) in border.lines.iter().enumerate() {
            let [x0, y0, x1, y1] = line.ends;
            let here = || crossings.iter().filter(|crossing| crossing.lines[own] == i as u32);
            let swaps = !crossings.is_empty() && here().count() % 2 != 0;
            let known = before.and_then(|([bx0, by0, bx1, by1], upper, lower)| match () {
                _ if (x0, y0) == (bx1, by1) => Some(lower),
                _ if (x1, y1) == (bx0, by0) => Some(upper ^ swaps),
                _ if (x0, y0) == (bx0, by0) => Some(upper),
                _ if (x1, y1) == (bx1, by1) => Some(lower ^ swaps),
                _ => None,
            });
            // On the pixel's lower border nothing can be looked up, nor does it count.
            let Some(upper) = known.or_else(|| (y0 < ONE).then(|| other.has_inside(x0, y0))) else {
                before = None;
                continue;
            };
            before = Some((line.ends, upper, upper ^ swaps));
            let mut inside = upper;
            let (mut x, mut y, mut area) = (x0, y0, 0);
            let mut part_to = |to_x: i32, to_y: i32| {
                if inside {
                    area += i64::from(to_y - y) * i64::from(2 * ONE - x - to_x);
                }
                (x, y, inside) = (to_x, to_y, !inside);
            };
            if !crossings.is_empty() {
                here().for_each(|crossing| part_to(crossing.at.0, crossing.at.1));
            }
            part_to(x1, y1);
            sum += area * i64::from(line.winding);
        }
        sum * i64::from(border.sense)
    }
}

impl Border {
    /// Reads a fragment's border; `false` if nothing is known of it, or it has too many pieces.
    fn read(&mut self, fragment: &Fragment, pieces: &[Piece]) -> bool {
        self.lines.clear();
        self.steps.clear();
        self.bounds = [i32::MAX, i32::MAX, -1, -1];
        let mut base = PieceSteps::new(fragment.cover_left);
        let mut next = fragment.pieces;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            if let Some((y, step)) = base.step(piece) {
                self.steps.push((y.into(), step));
            }
            let [x0, y0, x1, y1] = [piece.x0, piece.y0, piece.x1, piece.y1].map(i32::from);
            if (x0, y0) != (x1, y1) {
                self.lines.push(Line { ends: [x0, y0, x1, y1], winding: piece.winding.into() });
                let [left, top, right, bottom] = self.bounds;
                self.bounds = [left.min(x0).min(x1), top.min(y0), right.max(x0).max(x1), bottom.max(y1)];
            }
        }
        (self.corner, self.rule, self.sense) = (base.corner(), fragment.rule, fragment.sense.into());
        self.sense != 0 && self.lines.len() <= MOST_PIECES
    }

    /// Does a point above the pixel's lower border, which lies on none of the lines, lie in the fragment?
    fn has_inside(&self, x: i32, y: i32) -> bool {
        let steps: i32 = self.steps.iter().map(|&(at, step)| step * i32::from(at <= y)).sum();
        let is_left =
            |[x0, y0, x1, y1]: [i32; 4]| (y0 <= y) & (y < y1) & ((x1 - x0) * (y - y0) < (x - x0) * (y1 - y0));
        let lines: i32 = self.lines.iter().map(|line| line.winding * i32::from(is_left(line.ends))).sum();
        self.rule.inside(self.corner + steps + lines)
    }
}

impl Default for Border {
    fn default() -> Border {
        let (lines, steps) = (Vec::new(), Vec::new());
        Border { lines, steps, corner: 0, rule: FillRule::NonZero, sense: 0, bounds: [0; 4] }
    }
}

/// Are two rectangles, given as left, top, right, bottom, apart?
#[inline]
fn are_apart(a: [i32; 4], b: [i32; 4]) -> bool {
    a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1]
}

/// How two lines meet. Some that have no point in common are said to touch.
#[inline]
fn meeting(a: [i32; 4], b: [i32; 4]) -> Meeting {
    let [ax0, ay0, ax1, ay1] = a;
    let [bx0, by0, bx1, by1] = b;
    if ay1 < by0 || by1 < ay0 || ax0.max(ax1) < bx0.min(bx1) || bx0.max(bx1) < ax0.min(ax1) {
        return Meeting::Apart;
    }
    let (a0, a1) = (side(b, ax0, ay0), side(b, ax1, ay1));
    if (a0 > 0 && a1 > 0) || (a0 < 0 && a1 < 0) {
        return Meeting::Apart;
    }
    let (b0, b1) = (side(a, bx0, by0), side(a, bx1, by1));
    if (b0 > 0 && b1 > 0) || (b0 < 0 && b1 < 0) {
        return Meeting::Apart;
    }
    if a0 == 0 || a1 == 0 || b0 == 0 || b1 == 0 {
        return Meeting::Touch;
    }
    let share = |from: i32, to: i32| f64::from(from) / (f64::from(from) - f64::from(to));
    let shares = [share(a0, a1), share(b0, b1)];
    // Along the same line whichever comes first.
    let ([x0, y0, x1, y1], share) = if a <= b { (a, shares[0]) } else { (b, shares[1]) };
    let at = |from: i32, to: i32| from + round(f64::from(to - from) * share);
    Meeting::Cross { shares, at: (at(x0, x1), at(y0, y1)) }
}
