//! Takes the lines of one shape, makes edges in fixed point, listed for each band that they meet.
//!
//! Promises: a line between two points is the same [`Edge`] whichever way it was drawn; its direction
//! is kept as the sign of its winding. Nothing outside the picture is kept, but for what its winding
//! does to the pixels right of it.

use kurbo::Point;
use std::cmp::Ordering;

/// Binary digits behind the point: 14 keep a vertex within 1/32768 px of its place, which moves a
/// pixel's area by .01 of an 8-bit level at most.
pub(crate) const FRACTION_BITS: u32 = 14;
/// One pixel in fixed point.
pub(crate) const ONE: i32 = 1 << FRACTION_BITS;
/// Rows of one band: a strip of the picture that one thread makes at a time.
pub(crate) const BAND_ROWS: u32 = 8;
/// Largest picture side in pixels. Coordinates are cut off a little beyond, where they still fit.
pub(crate) const LARGEST_SIDE: u32 = 65_535;

/// Edges for which a band keeps room from one shape to the next.
const MOST_KEPT: usize = 1024;

/// Coordinates are cut off here, in pixels.
const GUARD: f64 = 100_000.0;

/// The low 32 bits of the nearest integer, ties to even, for |v| < 2^51.
#[inline]
pub(crate) fn round(v: f64) -> i32 {
    // Adding 1.5 * 2^52 leaves the rounded integer in the low bits of the mantissa.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    (v + MAGIC).to_bits() as i32
}

/// A coordinate of at most [`GUARD`] in fixed point.
#[inline]
fn fixed(v: f64) -> i32 {
    round(v * f64::from(ONE))
}

/// The band that a height lies in, the first if it lies above the picture.
#[inline]
fn band_at(y: i32) -> usize {
    const BAND_BITS: u32 = FRACTION_BITS + BAND_ROWS.trailing_zeros();
    (y.max(0) >> BAND_BITS) as usize
}

/// A straight piece of a shape's border in fixed point pixels, always from the upper end to the lower
/// (from left to right when horizontal).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edge {
    pub x0: i32,
    pub y0: i32,
    pub x1: i32,
    pub y1: i32,
    /// What crossing it from left to right adds to the winding number: 1 when drawn downwards
    /// (rightwards), -1 when drawn upwards (leftwards).
    pub winding: i32,
}

/// Pixels [left, right) x [top, bottom), within the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bounds {
    pub left: usize,
    pub right: usize,
    pub top: usize,
    pub bottom: usize,
}

impl Bounds {
    /// The least that holds both.
    pub fn united(self, other: Bounds) -> Bounds {
        Bounds {
            left: self.left.min(other.left),
            right: self.right.max(other.right),
            top: self.top.min(other.top),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// A shape's edges as they come.
pub(crate) struct EdgeList {
    /// For each band those that meet it, in the order of the outline.
    bands: Vec<Vec<Edge>>,
    /// Where the picture ends, in fixed point.
    right: i32,
    bottom: i32,
    /// Where the polygon began, and where it has got to.
    start: Corner,
    last: Corner,
    extent: Extent,
}

/// The rectangle around points, in pixels.
#[derive(Clone, Copy)]
struct Extent {
    least: [f64; 2],
    most: [f64; 2],
}

impl Extent {
    const EMPTY: Extent = Extent { least: [f64::INFINITY; 2], most: [f64::NEG_INFINITY; 2] };

    /// A point that is not a number adds nothing.
    #[inline]
    fn add(&mut self, p: Point) {
        for (axis, v) in [p.x, p.y].into_iter().enumerate() {
            self.least[axis] = if v < self.least[axis] { v } else { self.least[axis] };
            self.most[axis] = if v > self.most[axis] { v } else { self.most[axis] };
        }
    }
}

/// Takes polygons line by line, in pixels.
pub(crate) trait Lines {
    /// As [`EdgeList::sees_no_curve`].
    fn sees_no_curve(&self, hull: &[Point]) -> bool;
    /// Begins a polygon; the one before is closed.
    fn move_to(&mut self, p: Point);
    fn line_to(&mut self, p: Point);
    /// Adds the line back to the polygon's beginning.
    fn close(&mut self);
}

impl Lines for EdgeList {
    fn sees_no_curve(&self, hull: &[Point]) -> bool {
        EdgeList::sees_no_curve(self, hull)
    }

    fn move_to(&mut self, p: Point) {
        EdgeList::move_to(self, p);
    }

    #[inline]
    fn line_to(&mut self, p: Point) {
        EdgeList::line_to(self, p);
    }

    fn close(&mut self) {
        EdgeList::close(self);
    }
}

/// A corner of a polygon: in pixels, and in fixed point if it lies within the guard rectangle.
#[derive(Clone, Copy)]
struct Corner {
    exact: Point,
    fixed: Option<(i32, i32)>,
}

impl Corner {
    #[inline]
    fn new(exact: Point) -> Corner {
        let within = exact.x.abs() <= GUARD && exact.y.abs() <= GUARD;
        Corner { exact, fixed: within.then(|| (fixed(exact.x), fixed(exact.y))) }
    }
}

impl EdgeList {
    /// For a picture of this many pixels: one with none, or more a side than [`LARGEST_SIDE`], is not rendered.
    pub fn new(width: u32, height: u32) -> EdgeList {
        let [width, height] = [width, height].map(|side| side.clamp(1, LARGEST_SIDE));
        let origin = Corner::new(Point::ZERO);
        EdgeList {
            bands: vec![Vec::new(); height.div_ceil(BAND_ROWS) as usize],
            right: (width as i32) << FRACTION_BITS,
            bottom: (height as i32) << FRACTION_BITS,
            start: origin,
            last: origin,
            extent: Extent::EMPTY,
        }
    }

    /// Is a curve in this hull as good as the line between its ends? So it is when it lies above,
    /// below or right of the picture, where nothing counts, or left of it, where only winding does.
    pub fn sees_no_curve(&self, hull: &[Point]) -> bool {
        let all = |outside: &dyn Fn(&Point) -> bool| hull.iter().all(outside);
        let [width, height] = [self.right, self.bottom].map(|end| f64::from(end >> FRACTION_BITS));
        all(&|p| p.y <= 0.0) || all(&|p| p.y >= height) || all(&|p| p.x >= width) || all(&|p| p.x <= 0.0)
    }

    /// Begins a polygon; the one before is closed.
    pub fn move_to(&mut self, p: Point) {
        self.close();
        self.start = Corner::new(p);
        self.last = self.start;
        self.extent.add(p);
    }

    /// Adds a line to a polygon that has begun, in pixels. A point that is not a number adds nothing.
    #[inline]
    pub fn line_to(&mut self, p: Point) {
        self.extent.add(p);
        self.line(Corner::new(p));
    }

    /// Adds the line back to the polygon's beginning.
    pub fn close(&mut self) {
        self.line(self.start);
    }

    #[inline]
    fn line(&mut self, to: Corner) {
        let from = std::mem::replace(&mut self.last, to);
        match (from.fixed, to.fixed) {
            (Some(from), Some(to)) => self.push(from, to),
            _ => self.long_line(from.exact, to.exact),
        }
    }

    fn long_line(&mut self, from: Point, to: Point) {
        if !(from.x + from.y + to.x + to.y).is_finite() {
            return;
        }
        // Cut from the same end whichever way it runs.
        if (from.y, from.x) <= (to.y, to.x) {
            self.cut_to_guard(from, to, 1);
        } else {
            self.cut_to_guard(to, from, -1);
        }
    }

    /// Cuts a long line to the guard rectangle. What lies left of it runs along its left side, since
    /// it still winds round the pixels.
    fn cut_to_guard(&mut self, a: Point, b: Point, winding: i32) {
        let at_y = |y: f64| Point::new(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)), y);
        let at_x = |x: f64| Point::new(x, a.y + (b.y - a.y) * ((x - a.x) / (b.x - a.x)));
        let top = if a.y < -GUARD { at_y(-GUARD) } else { a };
        let bottom = if b.y > GUARD { at_y(GUARD) } else { b };
        let cut_off = |p: Point| (fixed(p.x.clamp(-GUARD, GUARD)), fixed(p.y.clamp(-GUARD, GUARD)));
        let mut last = top;
        let mut cuts = [-GUARD, GUARD];
        if top.x > bottom.x {
            cuts.reverse();
        }
        let mut line = |from, to| {
            let (from, to) = (cut_off(from), cut_off(to));
            match winding > 0 {
                true => self.push(from, to),
                false => self.push(to, from),
            }
        };
        for x in cuts {
            if (top.x < x) != (bottom.x < x) {
                let cut = at_x(x);
                line(last, cut);
                last = cut;
            }
        }
        line(last, bottom);
    }

    #[inline]
    fn push(&mut self, (ax, ay): (i32, i32), (bx, by): (i32, i32)) {
        let edge = match (ay, ax).cmp(&(by, bx)) {
            Ordering::Equal => return,
            Ordering::Less => Edge { x0: ax, y0: ay, x1: bx, y1: by, winding: 1 },
            Ordering::Greater => Edge { x0: bx, y0: by, x1: ax, y1: ay, winding: -1 },
        };
        // Above, below and right of the picture nothing counts.
        if edge.y1 < 0 || edge.y0 >= self.bottom || edge.x0.min(edge.x1) >= self.right {
            return;
        }
        let (first, last) = self.bands_of(&edge);
        self.bands[first].push(edge);
        if first < last {
            self.push_on(edge, first + 1, last);
        }
    }

    /// Adds an edge to bands `first` to `last`. Apart, for few edges meet more than one.
    #[inline(never)]
    fn push_on(&mut self, edge: Edge, first: usize, last: usize) {
        self.bands[first..=last].iter_mut().for_each(|band| band.push(edge));
    }

    /// The first and the last band that an edge meets: those of [y0, y1) or, of a horizontal edge, that of the row it
    /// lies in.
    #[inline]
    fn bands_of(&self, edge: &Edge) -> (usize, usize) {
        (band_at(edge.y0), band_at((edge.y1 - 1).max(edge.y0).min(self.bottom - 1)))
    }

    /// No edge within the picture lies outside these pixels.
    fn bounds(&self) -> Bounds {
        let pixel = |v: i32, end: i32| (v.clamp(0, end) >> FRACTION_BITS) as usize;
        let Extent { least, most } = self.extent;
        let [left, top] = least.map(|v| fixed(v.clamp(-GUARD, GUARD)));
        let [right, bottom] = most.map(|v| fixed(v.clamp(-GUARD, GUARD)));
        Bounds {
            left: pixel(left, self.right),
            right: pixel(right + ONE, self.right),
            top: pixel(top, self.bottom),
            bottom: pixel(bottom + ONE, self.bottom),
        }
    }

    /// Gives away the edges, and is empty again.
    pub fn take_banded(&mut self) -> BandedEdges {
        let bounds = self.bounds();
        let first_band = bounds.top / BAND_ROWS as usize;
        let bands = &mut self.bands[first_band..bounds.bottom.div_ceil(BAND_ROWS as usize).max(first_band)];
        let mut starts = Vec::with_capacity(bands.len() + 1);
        let mut edges = Vec::with_capacity(bands.iter().map(Vec::len).sum());
        starts.push(0);
        for band in bands {
            edges.append(band);
            band.shrink_to(MOST_KEPT);
            starts.push(edges.len() as u32);
        }
        debug_assert!(self.bands.iter().all(Vec::is_empty));
        self.extent = Extent::EMPTY;
        let origin = Corner::new(Point::ZERO);
        (self.start, self.last) = (origin, origin);
        match edges.is_empty() {
            true => BandedEdges::default(),
            false => BandedEdges { first_band, starts, edges, bounds },
        }
    }
}

/// A shape's edges by band; an edge stands in each band that it meets.
#[derive(Debug, Default)]
pub(crate) struct BandedEdges {
    first_band: usize,
    /// The edges of band `first_band + i` are `edges[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    edges: Vec<Edge>,
    bounds: Bounds,
}

impl BandedEdges {
    /// Pixels outside which no edge lies.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// How many edges there are, each counted once.
    pub fn count(&self) -> usize {
        let begin = |band: usize| self.band(band).iter().filter(|edge| band_at(edge.y0) == band).count();
        (self.first_band..self.first_band + self.starts.len()).map(begin).sum()
    }

    /// The edges that meet a band, in the order of the outline.
    pub fn band(&self, band: usize) -> &[Edge] {
        let at = band.wrapping_sub(self.first_band);
        match (self.starts.get(at), self.starts.get(at.wrapping_add(1))) {
            (Some(&start), Some(&end)) => &self.edges[start as usize..end as usize],
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_stands_in_each_band_that_it_meets_and_counts_once() {
        let mut list = EdgeList::new(8, 4 * BAND_ROWS);
        list.move_to(Point::new(2.0, 1.0));
        list.line_to(Point::new(5.0, f64::from(3 * BAND_ROWS)));
        list.line_to(Point::new(5.0, 1.0));
        list.close();
        let edges = list.take_banded();
        // Two long ones, and a level one in the first.
        assert_eq!([0, 1, 2, 3].map(|band| edges.band(band).len()), [3, 2, 2, 0]);
        assert_eq!(edges.count(), 3);
        assert_eq!(list.take_banded().count(), 0);
    }
}
