//! Takes a path and a pen, makes the outline of the line that it draws, as polygons for whatever takes
//! [`Lines`], to be filled non-zero.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`dashes`] | a path → its dashes, each a path |
//! | [`spine`] | a sub-path → the places where the pen stops, and its direction there |
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
//! the true one, and has its area (see [`crate::polygons`]).

mod corner;
mod dashes;
mod side;
mod spine;

use crate::edges::Lines;
use crate::polygons::{chord_count, AREA_SHARE};
use crate::scene::StrokeStyle;
use corner::{cap, Corner, InnerJoin};
use dashes::dashed;
use kurbo::{Affine, BezPath, Cap, PathEl, Point, Vec2};
use side::{Folds, Side};
use spine::Spine;

/// As [`AREA_SHARE`], for round joins and caps: they often lie on one another, and all that sticks out of any of them is
/// inked, so that lobes add up there which otherwise cancel.
const AREA_SHARE_OF_ARCS: f64 = 0.03;

/// Draws outlines; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Pen {
    spine: Spine,
    corners: Vec<Option<Corner>>,
    back: Vec<Point>,
    folds: Folds,
}

/// How wide and how fine an outline is drawn.
#[derive(Clone, Copy)]
struct Nib {
    /// Half the pen's width, in the path's units.
    radius: f64,
    /// Pixels of one of the path's units, at most.
    scale: f64,
    /// In pixels.
    tolerance: f64,
}

impl Nib {
    /// How many steps keep both sides within the tolerance along a path of this length which turns by
    /// this angle, evenly.
    fn stops(&self, length: f64, turn: f64) -> f64 {
        let outer = (length + self.radius * turn) * self.scale;
        chord_count(outer, 0.125 * outer * turn, self.tolerance, AREA_SHARE)
    }

    /// How many steps do so along an arc of the pen's end.
    fn arc_stops(&self, turn: f64) -> f64 {
        let outer = self.radius * turn * self.scale;
        chord_count(outer, 0.125 * outer * turn, self.tolerance, AREA_SHARE_OF_ARCS)
    }

    /// Is a round join as good as the point in which its lines meet, so far from the corner along each?
    fn is_flat(&self, trim: f64) -> bool {
        // With the tangent t of half the turn, the point lies r (sqrt(1 + t^2) - 1) outside the arc, and between them
        // an area of r^2 (t - atan t).
        let (radius, trim) = (self.radius * self.scale, trim * self.scale);
        let (distance, area) = (0.5 * trim * trim / radius, trim * trim * trim / (3.0 * radius));
        distance <= self.tolerance && area <= AREA_SHARE_OF_ARCS * self.tolerance
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edges::EdgeList;
    use crate::edges::{BAND_ROWS, ONE};
    use kurbo::{Join, Stroke};

    /// All edges of an outline on 64 x 64 pixels, sorted: x0, y0, x1, y1, winding.
    fn edges(path: &str, style: &Stroke) -> Vec<[i32; 5]> {
        edges_of(path, &style.clone().into())
    }

    fn edges_of(path: &str, style: &StrokeStyle) -> Vec<[i32; 5]> {
        let path = BezPath::from_svg(path).expect("a path");
        let mut list = EdgeList::new(64, 64);
        Pen::default().stroke(path.iter(), style, (Affine::IDENTITY, 1.0), 0.01, &mut list);
        let banded = list.take_banded();
        let mut all: Vec<_> = (0..64 / BAND_ROWS as usize)
            .flat_map(|band| banded.band(band).iter().map(|e| [e.x0, e.y0, e.x1, e.y1, e.winding]))
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The outline's signed area in pixels: positive if it winds the other way.
    fn area(path: &str, style: &Stroke) -> f64 {
        area_of(path, &style.clone().into())
    }

    fn area_of(path: &str, style: &StrokeStyle) -> f64 {
        let one = f64::from(ONE);
        let doubled: f64 = edges_of(path, style)
            .iter()
            .map(|&[x0, y0, x1, y1, winding]| f64::from(winding) * f64::from(y1 - y0) * f64::from(x0 + x1))
            .sum();
        0.5 * doubled / one / one
    }

    fn assert_area(path: &str, style: &Stroke, expected: f64) {
        let found = area(path, style).abs();
        assert!((found - expected).abs() < 2e-3 * expected.max(1.0), "{path}: {found}, not {expected}");
    }

    fn pen(width: f64) -> Stroke {
        Stroke::new(width).with_caps(Cap::Butt).with_join(Join::Bevel)
    }

    #[test]
    fn a_line_is_its_box_and_its_caps() {
        assert_area("M10 10H30", &pen(4.0), 80.0);
        assert_area("M10 10H30", &pen(4.0).with_caps(Cap::Square), 96.0);
        assert_area("M10 10H30", &pen(4.0).with_caps(Cap::Round), 80.0 + 4.0 * std::f64::consts::PI);
    }

    #[test]
    fn a_corner_of_long_lines_has_no_loop() {
        // The inner sides end where they meet, so the sum is the true area: two boxes, less the square
        // that both cover, and the join on the outer side.
        let corner = |join| pen(4.0).with_join(join);
        let boxes = 2.0 * 20.0 * 4.0 - 4.0;
        assert_area("M10 30H30V10", &corner(Join::Miter), boxes + 4.0);
        assert_area("M10 30H30V10", &corner(Join::Bevel), boxes + 2.0);
        assert_area("M10 30H30V10", &corner(Join::Round), boxes + std::f64::consts::PI);
    }

    #[test]
    fn sides_of_lines_that_meet_in_a_point_have_no_other_vertex() {
        let count = |path: &str, join| edges(path, &pen(2.0).with_join(join)).len();
        // Two lines on either side, and the two ends.
        assert_eq!(count("M10 30.3H20.2L30 20", Join::Miter), 6);
        assert_eq!(count("M10 30.3H20.2L30 29.7", Join::Round), 6);
        // Across a bevel, and along an arc.
        assert_eq!(count("M10 30.3H20.2L30 20", Join::Bevel), 7);
        assert!(count("M10 30.3H20.2L30 20", Join::Round) > 7);
    }

    #[test]
    fn a_miter_over_its_limit_is_a_bevel() {
        let sharp = "M10 10L40 14L10 18";
        let miter = |limit| area(sharp, &pen(2.0).with_join(Join::Miter).with_miter_limit(limit)).abs();
        assert_eq!(miter(4.0), area(sharp, &pen(2.0)).abs());
        assert!(miter(12.0) > miter(4.0) + 5.0, "{} {}", miter(12.0), miter(4.0));
    }

    #[test]
    fn a_clipped_miter_ends_at_half_the_limit_times_the_width() {
        // A quarter turn of a line 4 wide: its miter, 2 wide and high, ends 2 sqrt(2) from the corner.
        let corner = |limit: f64| {
            let line = pen(4.0).with_join(Join::Miter).with_miter_limit(limit);
            area_of("M10 30H30V10", &StrokeStyle { line, clips_miters: true }).abs()
        };
        let boxes = 2.0 * 20.0 * 4.0 - 4.0;
        assert!((corner(4.0) - (boxes + 4.0)).abs() < 0.01, "{}", corner(4.0));
        // Of the miter's tip, what lies beyond 2 * limit from the corner is a right triangle that high.
        let missing = |limit: f64| (2.0 * 2f64.sqrt() - 2.0 * limit).powi(2);
        for limit in [1.0, 1.2, 1.4] {
            let expected = boxes + 4.0 - missing(limit);
            assert!((corner(limit) - expected).abs() < 0.01, "{limit}: {} not {expected}", corner(limit));
        }
        // A path that turns back: both edges go on for half the limit times the width.
        let line = pen(4.0).with_join(Join::Miter).with_miter_limit(3.0);
        let clipped = StrokeStyle { line, clips_miters: true };
        assert!((area_of("M10 10H30H20", &clipped).abs() - (20.0 + 10.0 + 6.0) * 4.0).abs() < 0.01);
        assert_eq!(edges_of("M10 10L30 14L10 19", &clipped), edges_of("M10 19L30 14L10 10", &clipped));
    }

    #[test]
    fn a_ring_has_its_area() {
        // Four cubics within 3e-4 of the circle's radius.
        let k = 0.5522847498 * 20.0;
        let (low, high) = (32.0 - k, 32.0 + k);
        let circle = format!(
            "M52 32C52 {high} {high} 52 32 52C{low} 52 12 {high} 12 32C12 {low} {low} 12 32 12C{high} 12 52 {low} 52 32Z"
        );
        assert_area(&circle, &pen(6.0), 2.0 * std::f64::consts::PI * 20.0 * 6.0);
    }

    #[test]
    fn both_directions_have_the_same_outline() {
        let styles = [
            pen(3.0),
            pen(9.0).with_join(Join::Round).with_caps(Cap::Round),
            pen(5.0).with_join(Join::Miter),
        ];
        let paths = [
            ("M10 10L40 14L20 30", "M20 30L40 14L10 10"),
            ("M10 50C10 10 50 10 50 50", "M50 50C50 10 10 10 10 50"),
            ("M10 50C60 10 0 10 50 50L20 20", "M20 20L50 50C0 10 60 10 10 50"),
            // Tighter than the pen, and with a cusp.
            ("M20 40C34 10 26 10 30 40", "M30 40C26 10 34 10 20 40"),
            ("M10 50C50 10 10 10 50 50", "M50 50C10 10 50 10 10 50"),
        ];
        for style in &styles {
            for (there, back) in paths {
                assert_eq!(edges(there, style), edges(back, style), "{there}, width {}", style.width);
            }
        }
    }

    #[test]
    fn all_pieces_wind_one_way() {
        // A tight curl under a wide pen: as a sum of pieces of one sign, it covers no less than its union.
        let curl = "M28 28C32 28 32 32 28 32C24 32 24 28 28 28";
        assert!(area(curl, &pen(20.0)).abs() > std::f64::consts::PI * 100.0);
        let cusp = "M10 50C50 10 10 10 50 50";
        assert!(area(cusp, &pen(8.0)).abs() > 8.0 * 40.0);
    }

    #[test]
    fn a_path_that_goes_nowhere_has_caps_only() {
        let round = pen(10.0).with_caps(Cap::Round);
        assert_area("M30 30Z", &round, 25.0 * std::f64::consts::PI);
        assert_area("M30 30L30 30", &round, 25.0 * std::f64::consts::PI);
        assert_area("M30 30Z", &pen(10.0).with_caps(Cap::Square), 100.0);
        assert_eq!(edges("M30 30Z", &pen(10.0)), Vec::<[i32; 5]>::new());
        assert_eq!(edges("M30 30", &round), Vec::<[i32; 5]>::new());
        let around = edges("M30 30Z", &round);
        let is_near = |v: i32| (24 * ONE..36 * ONE).contains(&v);
        assert!(around.iter().all(|edge| edge[..4].iter().all(|&v| is_near(v))), "{around:?}");
    }

    #[test]
    fn points_that_are_not_numbers_end_in_time() {
        for path in ["M0 0C1e300 1e300 -1e300 1e300 9 9", "M0 0L1e308 1e308L-1e308 0Z", "M5 5C5 5 5 5 5 5"] {
            edges(path, &pen(3.0));
        }
    }
}
