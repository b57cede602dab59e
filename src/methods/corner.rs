//! `corner` and `corner:tiny`: take the colours at the corners of pixels, make pixels without looking
//! inside: Ramos & Borges, *Anti-aliasing rápido para algoritmo de scan line*, after Wyvill & Sharp,
//! *Volume and Boundary Sampling* (1989).
//!
//! ```text
//!   c0 ----p-------- c1      Corners and what is found along a row's lower border serve the row below
//!   |     / `.       |       as well. Where two neighbouring corners differ by more than a threshold, a
//!   |    /    `.     |       binary search finds where (p, q). m is the mean of all such points; the
//!   |   / .-' m `-.  |       triangle between m and a stretch of the border has that stretch's colour.
//!   |  q           ` |
//!   c3 ------------- c2
//! ```
//!
//! Promises: one straight border through a pixel is exact but for the search's step; the areas sum to
//! the pixel. A corner that lies on a border of polygons would count for the pixel at its lower right
//! alone: the others look again from just inside.
//!
//! What it gets wrong is all that the corners cannot tell: polygons inside a pixel; polygons that reach
//! in through one side only; several borders across one side, of which one is found at most; thin
//! polygons, that pass between the corners; vertices inside a pixel, for which m stands; more colours on
//! one side than its ends have (`samples/corner-*.svg`, one each). The remedy for tiny polygons is
//! `corner:tiny`: a pixel that holds corners of polygons is cut in four, three times at most, and each
//! part treated as a pixel. It does not help thin polygons, whose corners lie elsewhere.
//!
//! Where two corners differ by a gradient, the change is taken to be where the colour is as near to one
//! as to the other.

use super::points::PointRow;
use super::BandPainter;
use crate::band::Picture;
use crate::cel::Rows;
use crate::edges::{FRACTION_BITS, ONE};
use crate::pixel::resolve::Mean;
use crate::scene::paint::Sheet;

/// Corners of which no channel differs by more than this have one colour: two 8-bit levels.
const THRESHOLD: f32 = 2.0 / 255.0;

/// A search ends at this part of the side that it looks along.
const SEARCH_SHARE: i32 = 1 << 10;

/// `corner:tiny` cuts pixels this often.
const DEEPEST: u32 = 3;

/// Paints from corners.
pub(super) struct Corner {
    tiny: bool,
    height: u32,
    /// The row of pixels at hand, and the one below, whose upper corners are this one's lower ones.
    row: PointRow,
    below: PointRow,
    upper: Line,
    lower: Line,
    sides: Vec<Option<i32>>,
    samples: u64,
    cut: u64,
}

/// What is seen along a border between two rows.
#[derive(Default)]
struct Line {
    corners: Vec<Sheet>,
    /// For each pixel, where between its corners the colour changes, in fixed point pixels.
    changes: Vec<Option<i32>>,
}

/// A square of the picture whose border is looked at, in fixed point pixels.
#[derive(Clone, Copy)]
struct Square {
    x: i32,
    y: i32,
    side: i32,
}

/// What is seen along a square's border: corners clockwise from the upper left one, and the places
/// where the colour changes between each and the next.
#[derive(Clone, Copy)]
struct Border {
    corners: [Sheet; 4],
    changes: [Option<i32>; 4],
}

impl Corner {
    pub fn new(width: u32, height: u32) -> Corner {
        Corner {
            tiny: false,
            height,
            row: PointRow::new(width, height),
            below: PointRow::new(width, height),
            upper: Line::default(),
            lower: Line::default(),
            sides: Vec::new(),
            samples: 0,
            cut: 0,
        }
    }

    pub fn tiny(width: u32, height: u32) -> Corner {
        Corner { tiny: true, ..Corner::new(width, height) }
    }

    /// The colour at a point in this row of pixels, or on its lower border.
    fn color(&mut self, picture: &Picture, y: u32, at: (i32, i32)) -> Sheet {
        self.samples += 1;
        let is_below = at.1 >= (y as i32 + 1) << FRACTION_BITS && y + 1 < self.height;
        let row = if is_below { &mut self.below } else { &mut self.row };
        row.color(picture, at.0, at.1)
    }

    /// Where between two points on one line the colour changes; they are `side` apart.
    fn search(
        &mut self,
        picture: &Picture,
        y: u32,
        (from, to): (Sheet, Sheet),
        side: i32,
        at: impl Fn(i32) -> (i32, i32),
    ) -> Option<i32> {
        if distance(from, to) <= THRESHOLD {
            return None;
        }
        let (mut low, mut high) = (0, side);
        while high - low > (side / SEARCH_SHARE).max(1) {
            let middle = (low + high) / 2;
            let color = self.color(picture, y, at(middle));
            if distance(color, to) < distance(color, from) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some((low + high) / 2)
    }

    /// Looks along the upper border of row `y`, or below the last row along its lower one. The line
    /// belongs to the row whose points are asked for.
    fn line(&mut self, picture: &Picture, y: u32, border: u32, line: &mut Line) {
        let (width, border) = (picture.width as i32, (border as i32) << FRACTION_BITS);
        line.corners.clear();
        line.changes.clear();
        for x in 0..=width {
            line.corners.push(self.color(picture, y, (x << FRACTION_BITS, border)));
        }
        for x in 0..width {
            let ends = (line.corners[x as usize], line.corners[x as usize + 1]);
            let at = |along| ((x << FRACTION_BITS) + along, border);
            line.changes.push(self.search(picture, y, ends, ONE, at));
        }
    }

    /// Looks down the left sides of a row's pixels, and the right side of the last.
    fn look_down(&mut self, picture: &Picture, y: u32) {
        let mut sides = std::mem::take(&mut self.sides);
        sides.clear();
        for x in 0..=picture.width as usize {
            let ends = (self.upper.corners[x], self.lower.corners[x]);
            let at = |along| ((x as i32) << FRACTION_BITS, ((y as i32) << FRACTION_BITS) + along);
            sides.push(self.search(picture, y, ends, ONE, at));
        }
        self.sides = sides;
    }

    /// The border of one pixel.
    fn border(&self, x: usize) -> Border {
        let (upper, lower) = (&self.upper, &self.lower);
        let back = |change: Option<i32>| change.map(|along| ONE - along);
        Border {
            corners: [upper.corners[x], upper.corners[x + 1], lower.corners[x + 1], lower.corners[x]],
            changes: [upper.changes[x], self.sides[x + 1], back(lower.changes[x]), back(self.sides[x])],
        }
    }

    /// Cuts a square in which polygons have corners, and mixes its parts.
    fn split(
        &mut self,
        picture: &Picture,
        y: u32,
        square: Square,
        corners: &[(i32, i32)],
        depth: u32,
        mean: &mut Mean,
    ) {
        let Square { x: left, y: top, side } = square;
        let inside: Vec<(i32, i32)> = corners
            .iter()
            .copied()
            .filter(|&(x, y)| (left..left + side).contains(&x) && (top..top + side).contains(&y))
            .collect();
        if inside.is_empty() || depth == 0 {
            self.look_round(picture, y, square).mix(side, picture.around.linear, mean);
            return;
        }
        let half = side / 2;
        for (x, at_y) in [(left, top), (left + half, top), (left, top + half), (left + half, top + half)] {
            let part = Square { x, y: at_y, side: half };
            self.split(picture, y, part, &inside, depth - 1, mean);
        }
    }

    /// Looks along the border of a pixel or a part of one, from just inside.
    fn look_round(&mut self, picture: &Picture, y: u32, Square { x, y: top, side }: Square) -> Border {
        let at = |number: usize, along: i32| {
            let (u, v) = place(side - 1, number, along.min(side - 1));
            (x + u, top + v)
        };
        let corners: [Sheet; 4] = std::array::from_fn(|i| self.color(picture, y, at(i, 0)));
        let changes = std::array::from_fn(|i| {
            let ends = (corners[i], corners[(i + 1) % 4]);
            self.search(picture, y, ends, side, |along| at(i, along))
        });
        Border { corners, changes }
    }

    fn pixel(&mut self, picture: &Picture, x: usize, y: u32) -> Mean {
        let mut mean = Mean::default();
        let square = Square { x: (x as i32) << FRACTION_BITS, y: (y as i32) << FRACTION_BITS, side: ONE };
        if self.tiny && !self.row.is_whole(x) {
            let mut corners = Vec::new();
            self.row.corners(x, |x, y| corners.push((x, y)));
            corners.retain(|&(x, y)| {
                (square.x..square.x + ONE).contains(&x) && (square.y..square.y + ONE).contains(&y)
            });
            if !corners.is_empty() {
                self.cut += 1;
                self.split(picture, y, square, &corners, DEEPEST, &mut mean);
                return mean;
            }
        }
        let mut border = self.border(x);
        if border.is_met_at_a_corner() {
            border = self.look_round(picture, y, square);
        }
        border.mix(ONE, picture.around.linear, &mut mean);
        mean
    }
}

impl Border {
    /// Does a colour end where a side does? A corner on a border of polygons, as where these lie on the
    /// grid of pixels, shows only one of the pixels around it what it looks like.
    fn is_met_at_a_corner(&self) -> bool {
        const STEP: i32 = ONE / SEARCH_SHARE;
        self.changes.iter().flatten().any(|along| !(STEP..=ONE - STEP).contains(along))
    }

    /// Adds the colours of a square of this side, each by its area.
    fn mix(&self, side: i32, linear: bool, mean: &mut Mean) {
        // The pixel's area is twice the square of its side: a triangle's is its cross product.
        let whole = 2 * i64::from(side) * i64::from(side);
        let place = |number, along| place(side, number, along);
        let found: Vec<(i32, i32)> =
            self.changes.iter().enumerate().filter_map(|(i, at)| at.map(|along| place(i, along))).collect();
        if found.is_empty() {
            self.corners.iter().for_each(|&corner| mean.add(corner, whole / 4, linear));
            return;
        }
        let count = found.len() as i32;
        let middle =
            (found.iter().map(|p| p.0).sum::<i32>() / count, found.iter().map(|p| p.1).sum::<i32>() / count);
        for i in 0..4 {
            // Without a change, either half has its corner's colour.
            let change = place(i, self.changes[i].unwrap_or(side / 2));
            let (from, to) = (place(i, 0), place((i + 1) % 4, 0));
            mean.add(self.corners[i], triangle(middle, from, change), linear);
            mean.add(self.corners[(i + 1) % 4], triangle(middle, change, to), linear);
        }
    }
}

/// The point this far along a side of a square, clockwise; from the square's upper left corner.
fn place(side: i32, number: usize, along: i32) -> (i32, i32) {
    match number {
        0 => (along, 0),
        1 => (side, along),
        2 => (side - along, side),
        _ => (0, side - along),
    }
}

/// Twice the area of a triangle; never negative where `a` lies inside a square and `b` and `c` follow
/// each other clockwise on its border.
fn triangle(a: (i32, i32), b: (i32, i32), c: (i32, i32)) -> i64 {
    let (b, c) = ((b.0 - a.0, b.1 - a.1), (c.0 - a.0, c.1 - a.1));
    i64::from(b.0) * i64::from(c.1) - i64::from(b.1) * i64::from(c.0)
}

/// The largest difference of any channel.
fn distance(a: Sheet, b: Sheet) -> f32 {
    a.channels().iter().zip(b.channels()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

impl BandPainter for Corner {
    fn render(&mut self, picture: &Picture, _band: usize, mut rows: Rows) {
        self.below.prepare(picture, rows.top);
        for row in 0..rows.count {
            let y = rows.top + row as u32;
            std::mem::swap(&mut self.row, &mut self.below);
            if y + 1 < self.height {
                self.below.prepare(picture, y + 1);
            }
            let (mut upper, mut lower) = (std::mem::take(&mut self.upper), std::mem::take(&mut self.lower));
            if row == 0 {
                self.line(picture, y, y, &mut upper);
            } else {
                std::mem::swap(&mut upper, &mut lower);
            }
            self.line(picture, y, y + 1, &mut lower);
            (self.upper, self.lower) = (upper, lower);
            self.look_down(picture, y);
            let linear = picture.around.linear;
            for (x, pixel) in rows.row(row, picture.width as usize).iter_mut().enumerate() {
                *pixel = self.pixel(picture, x, y).to_rgba8(linear);
            }
        }
    }

    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        vec![("samples", std::mem::take(&mut self.samples)), ("pixels_cut", std::mem::take(&mut self.cut))]
    }
}
