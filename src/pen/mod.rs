//! Takes a path and a pen, makes the outline of the line that it draws, as polygons for whatever takes
//! [`Lines`], to be filled non-zero.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`dashes`] | a path → its dashes, each a path |
//! | [`spine`] | a sub-path → the places where the pen stops, and its direction there |
//! | [`nib`] | how far the pen goes and turns → how many stops that takes |
//! | [`corner`] | two segments that meet → the join's outline; an end → the cap's |
//! | [`side`] | places along one segment → one side of its outline |
//!
//! The inked area is a sum of plain pieces that all wind the same way: between two stops of the pen a
//! quadrilateral on each side of the path, at a corner a wedge on the outer side, at an end a cap. The
//! borders that two pieces share are left out, and nothing else, so that whatever overlaps the outline
//! has no hole (a stroker that joins offset curves by straight lines leaves some where a curve is
//! tighter than the pen, or a line shorter than the pen is wide).
//!
//! ```text
//!     a +---------------+ b      one segment's two sides, ab and dc;
//!       |               |  \     the wedge at the turn on its outer side;
//!       *---------------*   .    on the inner side the outlines meet in x,
//!       |             x |\  |    or, where a line is too short for that,
//!     d +-------------.-+ c .    go to the corner and back
//! ```
//!
//! Promises: a path walked either way has the same outline bit for bit. It lies within the tolerance of
//! the true one, and has its area (see [`crate::chords`]).

mod corner;
mod dashes;
mod nib;
mod side;
mod spine;
#[cfg(test)]
mod tests;

use crate::edges::Lines;
use crate::scene::StrokeStyle;
use corner::{cap, Corner, InnerJoin};
use dashes::dashed;
use kurbo::{Affine, BezPath, Cap, PathEl, Point, Vec2};
use nib::Nib;
use side::{Folds, Side};
use spine::Spine;

/// Draws outlines; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Pen {
    spine: Spine,
    corners: Vec<Option<Corner>>,
    back: Vec<Point>,
    folds: Folds,
}

impl Pen {
    /// Adds the outline of `path`, drawn by the pen in the path's own units and brought to pixels by
    /// `transform`, which makes them `scale` pixels long at most.
    pub fn stroke(
        &mut self,
        path: impl Iterator<Item = PathEl>,
        style: &StrokeStyle,
        (transform, scale): (Affine, f64),
        tolerance: f64,
        edges: &mut impl Lines,
    ) {
        let nib = Nib { radius: 0.5 * style.width, scale, tolerance };
        if style.dash_pattern.is_empty() {
            self.lines(path, style, transform, nib, edges);
            return;
        }
        let path: BezPath = path.collect();
        match dashed(&path, style) {
            Some(dashes) => self.lines(dashes.into_iter(), style, transform, nib, edges),
            None => self.lines(path.into_iter(), style, transform, nib, edges),
        }
    }

    fn lines(
        &mut self,
        path: impl Iterator<Item = PathEl>,
        style: &StrokeStyle,
        transform: Affine,
        nib: Nib,
        edges: &mut impl Lines,
    ) {
        let mut pen = Drawing { pen: self, style, transform, nib, edges };
        pen.start_at(Point::ZERO);
        let mut here = Point::ZERO;
        for element in path {
            match element {
                PathEl::MoveTo(p) => {
                    pen.end();
                    pen.start_at(p);
                    here = p;
                }
                PathEl::LineTo(p) => {
                    pen.draw(&[here, p]);
                    here = p;
                }
                PathEl::QuadTo(p1, p2) => {
                    pen.draw(&[here, here + (p1 - here) * (2.0 / 3.0), p2 + (p1 - p2) * (2.0 / 3.0), p2]);
                    here = p2;
                }
                PathEl::CurveTo(p1, p2, p3) => {
                    pen.draw(&[here, p1, p2, p3]);
                    here = p3;
                }
                PathEl::ClosePath => {
                    here = pen.pen.spine.start;
                    pen.close();
                    pen.start_at(here);
                }
            }
        }
        pen.end();
    }
}

/// An outline being drawn.
struct Drawing<'a, E> {
    pen: &'a mut Pen,
    style: &'a StrokeStyle,
    transform: Affine,
    nib: Nib,
    edges: &'a mut E,
}

impl<E: Lines> Drawing<'_, E> {
    fn start_at(&mut self, start: Point) {
        self.pen.spine.clear(start);
    }

    /// A line or a cubic, by its control points.
    fn draw(&mut self, hull: &[Point]) {
        let spine = &mut self.pen.spine;
        spine.drawn = true;
        match *hull {
            [p0, p1] => spine.line(p0, p1),
            [p0, p1, p2, p3] => {
                let hull = [p0, p1, p2, p3];
                let seen = !self.edges.sees_no_curve(&self.around(hull));
                self.pen.spine.cubic(hull, seen, self.nib);
            }
            _ => unreachable!("lines and cubics"),
        }
    }

    /// The corners of a box in pixels around all that the pen may draw along a cubic.
    fn around(&self, hull: [Point; 4]) -> [Point; 4] {
        let placed = hull.map(|p| self.transform * p);
        let reach = self.nib.radius * self.nib.scale;
        let [mut least, mut most] = [placed[0]; 2];
        for p in &placed[1..] {
            least = Point::new(least.x.min(p.x), least.y.min(p.y));
            most = Point::new(most.x.max(p.x), most.y.max(p.y));
        }
        let (least, most) = (least - Vec2::new(reach, reach), most + Vec2::new(reach, reach));
        [least, Point::new(most.x, least.y), most, Point::new(least.x, most.y)]
    }

    /// The end of a sub-path that stays open.
    fn end(&mut self) {
        if self.pen.spine.segments.is_empty() {
            self.dot();
            return;
        }
        self.find_corners(false);
        let last = self.pen.spine.segments.len() - 1;
        let there = self.pen.spine.end(last);
        let here = self.pen.spine.begin(0);
        self.side(1.0);
        self.edges_of_cap(there.at, there.along);
        self.side_back(false);
        self.edges_of_cap(here.at, -here.along);
        self.edges.close();
        self.draw_folds();
    }

    /// The end of a sub-path that is closed.
    fn close(&mut self) {
        let spine = &mut self.pen.spine;
        if let Some(last) = spine.segments.len().checked_sub(1) {
            spine.line(spine.end(last).at, spine.start);
        } else {
            spine.drawn = true;
            self.dot();
            return;
        }
        self.find_corners(true);
        self.side(1.0);
        self.edges.close();
        self.side_back(true);
        self.edges.close();
        self.draw_folds();
    }

    /// A sub-path that goes nowhere has its two caps, looking left and right (SVG 2, 13.5.4).
    fn dot(&mut self) {
        if !self.pen.spine.drawn || self.style.start_cap == Cap::Butt {
            return;
        }
        let (at, right) = (self.pen.spine.start, Vec2::new(1.0, 0.0));
        let mut add = polygon(self.edges, self.transform);
        for outwards in [right, -right] {
            cap(at, outwards, self.style.start_cap, self.nib, &mut add);
        }
        drop(add);
        self.edges.close();
    }

    fn find_corners(&mut self, closed: bool) {
        let (spine, corners) = (&self.pen.spine, &mut self.pen.corners);
        let count = spine.segments.len();
        corners.clear();
        for before in 0..count {
            let after = (before + 1) % count;
            let meet = after > before || closed;
            corners.push(meet.then(|| Corner::new(spine, before, after, self.style, self.nib)).flatten());
        }
        for at in 0..count {
            let join = inner_join(spine, corners, at);
            if let Some(corner) = &mut corners[at] {
                corner.inner_join = join;
            }
        }
    }

    /// All of one side, in the path's direction: a new polygon.
    fn side(&mut self, which: f64) {
        let pen = &mut *self.pen;
        let mut add = polygon(self.edges, self.transform);
        walk(&pen.spine, &pen.corners, which, self.style, self.nib, &mut pen.folds, &mut add);
    }

    /// All of the other side, against the path's direction: the next part of the polygon, or a new one.
    fn side_back(&mut self, is_new: bool) {
        let pen = &mut *self.pen;
        let mut back = std::mem::take(&mut pen.back);
        back.clear();
        let mut add = |p: Point| back.push(p);
        walk(&pen.spine, &pen.corners, -1.0, self.style, self.nib, &mut pen.folds, &mut add);
        let points = back.iter().rev().copied();
        match is_new {
            true => points.for_each(polygon(self.edges, self.transform)),
            false => points.for_each(|p| self.edges.line_to(self.transform * p)),
        }
        pen.back = back;
    }

    fn edges_of_cap(&mut self, at: Point, outwards: Vec2) {
        let (edges, transform) = (&mut *self.edges, self.transform);
        cap(at, outwards, self.style.start_cap, self.nib, &mut |p| edges.line_to(transform * p));
    }

    fn draw_folds(&mut self) {
        let (edges, transform) = (&mut *self.edges, self.transform);
        self.pen.folds.drain(|fold| {
            fold.iter().copied().for_each(polygon(edges, transform));
            edges.close();
        });
    }
}

/// Takes the points of a polygon, the first of which begins it.
fn polygon<E: Lines>(edges: &mut E, transform: Affine) -> impl FnMut(Point) + '_ {
    let mut is_first = true;
    move |p| match std::mem::take(&mut is_first) {
        true => edges.move_to(transform * p),
        false => edges.line_to(transform * p),
    }
}

/// How the inner sides are joined in a corner between lines that are long enough for it.
fn inner_join(spine: &Spine, corners: &[Option<Corner>], at: usize) -> InnerJoin {
    let Some(corner) = &corners[at] else {
        return InnerJoin::Corner;
    };
    let count = corners.len();
    let (before, after) = ((at + count - 1) % count, (at + 1) % count);
    // Another join on the same side of a line must leave room on it.
    let taken = |other: usize| {
        corners[other].filter(|other| other.inner == corner.inner).map_or(0.0, |other| other.trim)
    };
    match (spine.line_length(at), spine.line_length(after)) {
        (Some(one), Some(other)) if corner.reach <= one.min(other) => {
            let room = (one - taken(before)).min(other - taken(after));
            if corner.trim <= room {
                InnerJoin::Meet
            } else {
                InnerJoin::Line
            }
        }
        _ => InnerJoin::Corner,
    }
}

/// Walks along one side of the whole sub-path.
fn walk(
    spine: &Spine,
    corners: &[Option<Corner>],
    which: f64,
    style: &StrokeStyle,
    nib: Nib,
    folds: &mut Folds,
    add: &mut impl FnMut(Point),
) {
    let count = corners.len();
    let met = |corner: &Option<Corner>| corner.is_some_and(|corner| corner.meets(which));
    for (segment, corner) in corners.iter().enumerate() {
        // Of a line nothing lies between these points. A curve has its own ends.
        let is_line = spine.is_line(segment);
        let ends = (!(is_line && met(&corners[(segment + count - 1) % count])), !(is_line && met(corner)));
        Side { stations: spine.stations(segment), which, nib }.walk(ends, folds, add);
        if let Some(corner) = corner {
            corner.walk(which, style, nib, add);
        }
    }
}

/// The vector turned by a quarter: one that points right is turned to point down (y grows downwards).
#[inline]
fn quarter(v: Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}
