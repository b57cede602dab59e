//! Takes the stations along one segment, makes one side of its outline.
//!
//! Each vertex lies at the end of the pen, and then a little further out than that, so that the side
//! encloses the area that the true offset curve does: a step of the outline of length c that turns by
//! the angle a cuts off a sliver of c^2 a / 12.
//!
//! Where the path is tighter than the pen, its inner side runs backwards, from q to q', and the pens
//! there cross each other. The outline then follows the crossings x, and what the pens sweep behind
//! them is a polygon of its own, a fold, wound like the rest:
//!
//! ```text
//!     p +---+ p'     the path, turning upwards
//!        \ /
//!         x          where the two pens cross
//!        / \
//!    q' +---+ q      their ends, in the opposite order
//! ```

use super::nib::Nib;
use super::quarter;
use super::spine::Station;
use kurbo::{Point, Vec2};

/// One side of one segment.
pub(super) struct Side<'a> {
    pub stations: &'a [Station],
    /// 1 for the side that a quarter turn of the direction points to, -1 for the other.
    pub which: f64,
    pub nib: Nib,
}

/// Polygons that folds add to an outline.
#[derive(Default)]
pub(super) struct Folds {
    points: Vec<Point>,
    ends: Vec<usize>,
}

impl Folds {
    /// Each polygon, once.
    pub fn drain(&mut self, mut take: impl FnMut(&[Point])) {
        let mut start = 0;
        for end in self.ends.drain(..) {
            take(&self.points[start..end]);
            start = end;
        }
        self.points.clear();
    }
}

impl Side<'_> {
    /// Its vertices in the path's direction, with or without the first and the last, and its folds.
    pub fn walk(
        &self,
        (with_first, with_last): (bool, bool),
        folds: &mut Folds,
        add: &mut impl FnMut(Point),
    ) {
        let last = self.stations.len() - 1;
        if with_first {
            add(self.pen(0));
        }
        let mut before = self.step(1);
        let mut i = 1;
        while i <= last {
            if before.0 < 0.0 {
                i = self.fold(i, folds, add);
                before = if i < last { self.step(i + 1) } else { before };
                if i < last {
                    add(self.pen(i));
                }
            } else if i < last {
                let after = self.step(i + 1);
                let outwards = match after.0 < 0.0 {
                    true => Vec2::ZERO,
                    false => self.outwards(i, before, after, (i == 1, i + 1 == last)),
                };
                add(self.pen(i) + outwards);
                before = after;
            }
            i += 1;
        }
        if with_last {
            add(self.pen(last));
        }
    }

    /// The outline along the steps from number `first` on that run backwards; returns the last of them.
    fn fold(&self, first: usize, folds: &mut Folds, add: &mut impl FnMut(Point)) -> usize {
        let start = folds.points.len();
        let mut end = first;
        loop {
            let x = self.crossing(end);
            add(x);
            folds.points.push(x);
            if end + 1 == self.stations.len() || self.step(end + 1).0 >= 0.0 {
                break;
            }
            end += 1;
        }
        folds.points.extend((first - 1..=end).rev().map(|i| {
            // The pens at its ends bound the sides before and behind it, too.
            let outwards = match first <= i && i < end {
                true => self.outwards(i, self.step(i), self.step(i + 1), (i == first, i + 1 == end)),
                false => Vec2::ZERO,
            };
            self.pen(i) + outwards
        }));
        if self.which < 0.0 {
            folds.points[start..].reverse();
        }
        folds.ends.push(folds.points.len());
        end
    }

    /// The end of the pen at a station.
    #[inline]
    fn pen(&self, i: usize) -> Point {
        self.stations[i].at + self.offset(i)
    }

    #[inline]
    fn offset(&self, i: usize) -> Vec2 {
        self.which * self.nib.radius * quarter(self.stations[i].along)
    }

    /// The length of the step to a station, negative backwards, and the angle by which it turns.
    #[inline]
    fn step(&self, i: usize) -> (f64, f64) {
        let (from, to) = (self.stations[i - 1].along, self.stations[i].along);
        let step = self.pen(i) - self.pen(i - 1);
        (0.5 * step.dot(from + to), from.cross(to))
    }

    /// How far a vertex between two steps in one direction goes out. A sliver's area goes to its two vertices by halves;
    /// of the first step and the last, which have one vertex only, all of it.
    #[inline]
    fn outwards(
        &self,
        i: usize,
        (c0, a0): (f64, f64),
        (c1, a1): (f64, f64),
        (is_first, is_last): (bool, bool),
    ) -> Vec2 {
        let length = c0 + c1;
        if length == 0.0 {
            return Vec2::ZERO;
        }
        let share = |is_end: bool| if is_end { 2.0 } else { 1.0 };
        let by = (share(is_first) * c0 * c0 * a0 + share(is_last) * c1 * c1 * a1) / (12.0 * length);
        -by * quarter(self.stations[i].along)
    }

    /// Where the pens before and after a step cross.
    fn crossing(&self, i: usize) -> Point {
        let (from, to) = (self.stations[i - 1].at, self.stations[i].at);
        let (here, there) = (self.offset(i - 1), self.offset(i));
        let share = (to - from).cross(there) / here.cross(there);
        // Pens that turn by half a circle, or not at all, are parallel.
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        from + share * here
    }
}
