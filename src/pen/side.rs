//! Takes the stations along one segment, makes one side of its outline.
//!
//! Each vertex lies at the end of the pen, and then a little further out than that, so that the side
//! encloses the area that the true offset curve does: a step of the outline of length c that turns by
//! the angle a cuts off a sliver of c^2 a / 12.
//!
//! Where the path is tighter than the pen, its inner side runs backwards. There the outline follows the
//! path itself, and what the pen sweeps is added as pairs of triangles, both wound like the rest:
//!
//! ```text
//!     p +---+ next p     the path, turning upwards
//!        \ /
//!         x              where the two pens cross
//!        / \
//!       +---+            their ends, in the opposite order
//! ```

use super::spine::Station;
use super::{quarter, Nib};
use kurbo::{Point, Vec2};

/// One side of one segment.
pub(super) struct Side<'a> {
    pub stations: &'a [Station],
    /// 1 for the side that a quarter turn of the direction points to, -1 for the other.
    pub which: f64,
    pub nib: Nib,
}

impl Side<'_> {
    /// Its vertices in the path's direction, with or without the first and the last, and its folds.
    pub fn walk(
        &self,
        (with_first, with_last): (bool, bool),
        folds: &mut Vec<[Point; 6]>,
        add: &mut impl FnMut(Point),
    ) {
        let stations = self.stations;
        let last = stations.len() - 1;
        if with_first {
            add(self.pen(0));
        }
        let mut before = self.step(1);
        let mut folded = false;
        for i in 1..=last {
            if before.0 < 0.0 && !folded {
                // The path itself stands for this side, until it runs forwards again.
                add(self.pen(i - 1));
                add(stations[i - 1].at);
                folded = true;
            }
            if before.0 < 0.0 {
                folds.extend(self.fold(i));
                add(stations[i].at);
            }
            let after = if i < last { self.step(i + 1) } else { (1.0, 0.0) };
            if folded && after.0 >= 0.0 {
                add(self.pen(i));
                folded = false;
            } else if i < last && !folded {
                let ends = usize::from(i == 1) + usize::from(i + 1 == last);
                add(self.pen(i) + self.outwards(i, before, after, 1.0 + 0.5 * ends as f64));
            }
            before = after;
        }
        if with_last {
            add(self.pen(last));
        }
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

    /// How far a vertex between two steps goes out. A sliver's area goes to its two vertices by halves;
    /// at the segment's ends, where there is but one, all of it.
    #[inline]
    fn outwards(&self, i: usize, (c0, a0): (f64, f64), (c1, a1): (f64, f64), share: f64) -> Vec2 {
        let length = c0 + c1;
        if length <= 0.0 {
            return Vec2::ZERO;
        }
        let by = share * (c0 * c0 * a0 + c1 * c1 * a1) / (12.0 * length);
        -by * quarter(self.stations[i].along)
    }

    /// The two triangles that the pen sweeps on the step to a station, as one polygon, or none where
    /// it does not turn.
    fn fold(&self, i: usize) -> Option<[Point; 6]> {
        let (from, to) = (self.stations[i - 1].at, self.stations[i].at);
        let (here, there) = (self.offset(i - 1), self.offset(i));
        let crossing = here.cross(there);
        let share = (to - from).cross(there) / crossing;
        if !(0.0..=1.0).contains(&share) {
            return None;
        }
        let x = from + share * here;
        let fold = [x, to, from, x, to + there, from + here];
        // The side that the direction's quarter turn points to winds one way, the other side the other.
        let [a, b, c, d, e, f] = fold;
        Some(if self.which > 0.0 { fold } else { [a, c, b, d, f, e] })
    }
}
