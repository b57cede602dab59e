//! Takes the lines of one shape, makes edges in fixed point, sorted in y into bands.
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

/// Coordinates are cut off here, in pixels.
const GUARD: f64 = 100_000.0;

/// The low 32 bits of the nearest integer, ties to even, for |v| < 2^51.
#[inline]
pub(crate) fn round(v: f64) -> i32 {
    // Adding 1.5 * 2^52 leaves the rounded integer in the low bits of the mantissa.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    (v + MAGIC).to_bits() as i32
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

/// A shape's edges, still in the order of its outline.
pub(crate) struct EdgeList {
    edges: Vec<Edge>,
    /// For each band, and one more: how many more edges come into it from above, or begin there, than have left
    /// behind the band before.
    changes: Vec<i32>,
    /// Where the picture ends, in fixed point.
    right: i32,
    bottom: i32,
    /// Where the polygon began, and where it has got to.
    start: Corner,
    last: Corner,
    extent: Extent,
}

/// The rectangle around edges, in fixed point.
#[derive(Clone, Copy)]
struct Extent {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Extent {
    const EMPTY: Extent = Extent { left: i32::MAX, top: i32::MAX, right: i32::MIN, bottom: i32::MIN };

    #[inline]
    fn add(&mut self, edge: &Edge) {
        self.left = self.left.min(edge.x0.min(edge.x1));
        self.top = self.top.min(edge.y0);
        self.right = self.right.max(edge.x0.max(edge.x1));
        self.bottom = self.bottom.max(edge.y1);
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
        let fixed = |v: f64| round(v * f64::from(ONE));
        Corner { exact, fixed: within.then(|| (fixed(exact.x), fixed(exact.y))) }
    }
}

impl EdgeList {
    /// For a picture of this many pixels: one with none, or more a side than [`LARGEST_SIDE`], is not rendered.
    pub fn new(width: u32, height: u32) -> EdgeList {
        let [width, height] = [width, height].map(|side| side.clamp(1, LARGEST_SIDE));
        let origin = Corner::new(Point::ZERO);
        EdgeList {
            edges: Vec::new(),
            changes: vec![0; height.div_ceil(BAND_ROWS) as usize + 1],
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
    }

    /// Adds a line, in pixels. A point that is not a number adds nothing.
    #[inline]
    pub fn line_to(&mut self, p: Point) {
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
        let fixed = |p: Point| {
            let clamped = Point::new(p.x.clamp(-GUARD, GUARD), p.y.clamp(-GUARD, GUARD));
            (round(clamped.x * f64::from(ONE)), round(clamped.y * f64::from(ONE)))
        };
        let mut last = top;
        let mut cuts = [-GUARD, GUARD];
        if top.x > bottom.x {
            cuts.reverse();
        }
        let mut line = |from, to| {
            let (from, to) = (fixed(from), fixed(to));
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
        self.extent.add(&edge);
        let (first, last) = self.bands(&edge);
        self.changes[first] += 1;
        self.changes[last + 1] -= 1;
        self.edges.push(edge);
    }

    /// The first and the last band that an edge meets: those of [y0, y1) or, of a horizontal edge, that of the row it
    /// lies in.
    #[inline]
    fn bands(&self, edge: &Edge) -> (usize, usize) {
        const BAND_BITS: u32 = FRACTION_BITS + BAND_ROWS.trailing_zeros();
        let last = (edge.y1 - 1).max(edge.y0).clamp(0, self.bottom - 1);
        ((edge.y0.max(0) >> BAND_BITS) as usize, (last >> BAND_BITS) as usize)
    }

    /// The pixels that edges lie in.
    fn bounds(&self) -> Bounds {
        let pixel = |v: i32, end: i32| (v.clamp(0, end) >> FRACTION_BITS) as usize;
        let Extent { left, top, right, bottom } = self.extent;
        if self.edges.is_empty() {
            return Bounds::default();
        }
        Bounds {
            left: pixel(left, self.right),
            right: pixel(right + ONE, self.right),
            top: pixel(top, self.bottom),
            bottom: pixel(bottom + ONE, self.bottom),
        }
    }

    /// Edges so far.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Sorts the edges into bands, and is empty again.
    pub fn take_banded(&mut self) -> BandedEdges {
        let banded = self.sort();
        self.edges.clear();
        self.extent = Extent::EMPTY;
        let origin = Corner::new(Point::ZERO);
        (self.start, self.last) = (origin, origin);
        banded
    }

    /// Counting sort.
    fn sort(&mut self) -> BandedEdges {
        let bounds = self.bounds();
        if self.edges.is_empty() {
            return BandedEdges::default();
        }
        let first_band = bounds.top / BAND_ROWS as usize;
        let bands = (bounds.bottom - 1) / BAND_ROWS as usize + 1 - first_band;
        let mut starts = Vec::with_capacity(bands + 1);
        let (mut total, mut here) = (0, 0);
        for change in &mut self.changes[first_band..=first_band + bands] {
            starts.push(total);
            here += std::mem::take(change);
            total += here as u32;
        }
        let mut sorted = vec![Edge { x0: 0, y0: 0, x1: 0, y1: 0, winding: 0 }; total as usize];
        // Each start moves on to the next one's place, and is put back at the end.
        for edge in &self.edges {
            let (first, last) = self.bands(edge);
            for start in &mut starts[first - first_band..=last - first_band] {
                sorted[*start as usize] = *edge;
                *start += 1;
            }
        }
        starts.rotate_right(1);
        starts[0] = 0;
        BandedEdges { first_band, starts, edges: sorted, bounds }
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
    /// The pixels that edges lie in.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The edges that meet a band.
    pub fn band(&self, band: usize) -> &[Edge] {
        let at = band.wrapping_sub(self.first_band);
        match (self.starts.get(at), self.starts.get(at.wrapping_add(1))) {
            (Some(&start), Some(&end)) => &self.edges[start as usize..end as usize],
            _ => &[],
        }
    }
}
