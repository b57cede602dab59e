//! The closed form for a few fragments: takes their borders, makes the area of each set of them.
//!
//! By Green's theorem a set's area is a sum over the pixel's left border, and over the pieces: each adds
//! the area right of it to the set on its right side and takes it from the set on its left. The two
//! differ by the piece's own fragment; inside which of the others it lies is looked up where a border
//! begins, and changes where it crosses theirs. Borders that touch are left to [`super::boundary`].

use super::fragment::{joint, side, Fragment, PieceSteps, PIXEL_AREA};
use crate::edges::{round, ONE};
use crate::scene::FillRule;
use crate::strips::{Piece, NO_PIECE};

/// Fragments that are few.
pub(crate) const MOST_LEAVES: usize = 4;

/// Borders of more pieces than this are left to the general sum along borders.
const MOST_PIECES: usize = 24;

/// The area of each set of fragments, which are its bits, in the units of [`super::fragment::PIXEL_AREA`].
pub(crate) type Areas = [i64; 1 << MOST_LEAVES];

/// Finds regions; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Few {
    borders: [Border; MOST_LEAVES],
    count: usize,
    crossings: Vec<Crossing>,
    /// Steps of the winding numbers going down the pixel's left border: (y, step, fragment).
    steps: Vec<(i32, i32, usize)>,
    /// What crosses the piece at hand: the share above, the other fragment, and where.
    here: Vec<(f64, usize, (i32, i32))>,
}

/// One fragment's border.
struct Border {
    lines: Vec<Line>,
    /// Steps of the winding number going down the pixel's left border, sorted: (y, step).
    steps: Vec<(i32, i32)>,
    /// The winding number in the pixel's top left corner.
    corner: i32,
    rule: FillRule,
    sense: i32,
    /// Of the fragment.
    area: i64,
    /// Left, top, right, bottom.
    bounds: [i32; 4],
}

/// A piece, from the upper end to the lower.
#[derive(Clone, Copy)]
struct Line {
    ends: [i32; 4],
    winding: i32,
}

/// Where lines of two borders cross.
#[derive(Clone, Copy)]
struct Crossing {
    /// The borders, and the lines in them.
    lines: [(usize, usize); 2],
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

impl Few {
    /// Forgets the last pixel's fragments.
    #[inline]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a fragment; `false` if there are too many, or too little is known of it.
    #[inline]
    pub fn add(&mut self, fragment: &Fragment, pieces: &[Piece]) -> bool {
        self.count += 1;
        self.borders.get_mut(self.count - 1).is_some_and(|border| border.read(fragment, pieces))
    }

    /// The regions' areas, which are all of the pixel, if no borders touch.
    pub fn areas(&mut self) -> Option<Areas> {
        if !self.find_crossings() {
            return None;
        }
        let mut areas = [0; 1 << MOST_LEAVES];
        if self.count == 2 && self.crossings.is_empty() {
            // So it is with most of these pixels.
            let [one, other, ..] = &self.borders;
            let both = area_of_both(one, other);
            let (one, other) = (one.area - both, other.area - both);
            areas[..4].copy_from_slice(&[PIXEL_AREA - one - other - both, one, other, both]);
            return Some(areas);
        }
        self.along_left_border(&mut areas);
        for own in 0..self.count {
            self.along(own, &mut areas);
        }
        mend_rounding(&mut areas);
        Some(areas)
    }

    /// `false` if any lines touch.
    fn find_crossings(&mut self) -> bool {
        self.crossings.clear();
        let borders = &self.borders[..self.count];
        for (b, other) in borders.iter().enumerate() {
            for (a, one) in borders[..b].iter().enumerate() {
                if are_apart(one.bounds, other.bounds) {
                    continue;
                }
                for (i, line) in one.lines.iter().enumerate() {
                    for (j, other_line) in other.lines.iter().enumerate() {
                        match meeting(line.ends, other_line.ends) {
                            Meeting::Apart => {}
                            Meeting::Touch => return false,
                            Meeting::Cross { shares, at } => {
                                self.crossings.push(Crossing { lines: [(a, i), (b, j)], shares, at });
                            }
                        }
                    }
                }
            }
        }
        true
    }

    /// What lies right of the pixel's left border.
    fn along_left_border(&mut self, areas: &mut Areas) {
        let borders = &self.borders[..self.count];
        let mut windings = [0; MOST_LEAVES];
        let mut set = 0;
        self.steps.clear();
        for (leaf, border) in borders.iter().enumerate() {
            windings[leaf] = border.corner;
            set |= usize::from(border.rule.inside(border.corner)) << leaf;
            self.steps.extend(border.steps.iter().map(|&(y, step)| (y, step, leaf)));
        }
        self.steps.sort_unstable();
        let mut from = 0;
        for &(y, step, leaf) in &self.steps {
            areas[set] += i64::from(y - from) * i64::from(2 * ONE);
            from = y;
            windings[leaf] += step;
            set = set & !(1 << leaf) | usize::from(borders[leaf].rule.inside(windings[leaf])) << leaf;
        }
        areas[set] += i64::from(ONE - from) * i64::from(2 * ONE);
    }

    /// What lies right of one fragment's pieces.
    fn along(&mut self, own: usize, areas: &mut Areas) {
        let border = &self.borders[own];
        // The ends of the piece before, and the other fragments in which they lie.
        let mut before: Option<([i32; 4], usize, usize)> = None;
        for (i, line) in border.lines.iter().enumerate() {
            let [x0, y0, x1, y1] = line.ends;
            self.here.clear();
            for crossing in &self.crossings {
                let [(a, _), (b, _)] = crossing.lines;
                if crossing.lines[0] == (own, i) {
                    self.here.push((crossing.shares[0], b, crossing.at));
                } else if crossing.lines[1] == (own, i) {
                    self.here.push((crossing.shares[1], a, crossing.at));
                }
            }
            let swaps = self.here.iter().fold(0, |swaps, &(_, leaf, _)| swaps ^ 1 << leaf);
            let known = before.and_then(|([bx0, by0, bx1, by1], upper, lower)| match () {
                _ if (x0, y0) == (bx1, by1) => Some(lower),
                _ if (x1, y1) == (bx0, by0) => Some(upper ^ swaps),
                _ if (x0, y0) == (bx0, by0) => Some(upper),
                _ if (x1, y1) == (bx1, by1) => Some(lower ^ swaps),
                _ => None,
            });
            // On the pixel's lower border nothing can be looked up, nor does it count.
            let Some(upper) = known.or_else(|| (y0 < ONE).then(|| self.others_around(own, x0, y0))) else {
                before = None;
                continue;
            };
            before = Some((line.ends, upper, upper ^ swaps));
            if self.here.len() > 1 {
                self.here.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            }
            let sign = i64::from(line.winding * border.sense);
            let (mut set, mut x, mut y) = (upper, x0, y0);
            let mut part_to = |(to_x, to_y): (i32, i32), swap: usize| {
                let area = sign * i64::from(to_y - y) * i64::from(2 * ONE - x - to_x);
                areas[set | 1 << own] += area;
                areas[set] -= area;
                (x, y) = (to_x, to_y);
                set ^= swap;
            };
            self.here.iter().for_each(|&(_, leaf, at)| part_to(at, 1 << leaf));
            part_to((x1, y1), 0);
        }
    }

    /// The fragments but for one in which a point on that one's border lies.
    #[inline]
    fn others_around(&self, own: usize, x: i32, y: i32) -> usize {
        let others = self.borders[..self.count].iter().enumerate().filter(|(leaf, _)| *leaf != own);
        others.map(|(leaf, border)| usize::from(border.has_inside(x, y)) << leaf).sum()
    }
}

/// The area that two fragments have in common, whose borders do not meet: of each border all or nothing of
/// what hangs together lies in the other fragment.
fn area_of_both(one: &Border, other: &Border) -> i64 {
    one.area_right_of_part_in(other)
        + other.area_right_of_part_in(one)
        + area_right_of_left_border(one, other)
}

/// What lies right of the part of the pixel's left border that is in both.
fn area_right_of_left_border(one: &Border, other: &Border) -> i64 {
    let (mut a, mut b) = (one.corner, other.corner);
    let is_inside = |a: i32, b: i32| one.rule.inside(a) && other.rule.inside(b);
    let (mut one_steps, mut other_steps) = (one.steps.as_slice(), other.steps.as_slice());
    let (mut height, mut from) = (0, 0);
    loop {
        let is_one_next = match (one_steps.first(), other_steps.first()) {
            (Some(next), Some(others)) => next.0 <= others.0,
            (next, _) => next.is_some(),
        };
        let steps = if is_one_next { &mut one_steps } else { &mut other_steps };
        let next = steps.split_off_first();
        let to = next.map_or(ONE, |next| next.0);
        if is_inside(a, b) {
            height += to - from;
        }
        let Some(&(y, step)) = next else {
            return i64::from(height) * i64::from(2 * ONE);
        };
        from = y;
        *if is_one_next { &mut a } else { &mut b } += step;
    }
}

/// Where borders cross, their parts have rounded ends, so that an area may come out a few units short of
/// nothing. It becomes nothing, at the largest one's cost.
fn mend_rounding(areas: &mut Areas) {
    let missing: i64 = areas.iter().map(|area| (*area).min(0)).sum();
    if missing < 0 {
        areas.iter_mut().for_each(|area| *area = (*area).max(0));
        let largest = (0..areas.len()).max_by_key(|&set| areas[set]).expect("there are sets");
        areas[largest] += missing;
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
        self.area = fragment.area();
        self.steps.sort_unstable();
        self.sense != 0 && self.lines.len() <= MOST_PIECES
    }

    /// What lies right of the lines that are in another fragment, whose border they do not meet.
    fn area_right_of_part_in(&self, other: &Border) -> i64 {
        let mut area = 0;
        let mut before = [-1; 4];
        let mut is_inside = false;
        for line in &self.lines {
            let [x0, y0, x1, y1] = line.ends;
            if y0 == y1 {
                // It has no height.
                continue;
            }
            if joint(line.ends, before).is_none() {
                is_inside = other.has_inside(x0, y0);
            }
            before = line.ends;
            if is_inside {
                area += i64::from(line.winding * (y1 - y0)) * i64::from(2 * ONE - x0 - x1);
            }
        }
        i64::from(self.sense) * area
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
        Border { lines, steps, corner: 0, rule: FillRule::NonZero, sense: 0, area: 0, bounds: [0; 4] }
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
