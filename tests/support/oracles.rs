//! What pictures should be, found in other ways than the renderer's.
//!
//! The oracles share no code with the renderer and little with each other:
//!
//! * [`area_in_pixel`] clips one polygon to one pixel (Sutherland & Hodgman 1974) and measures it;
//! * [`Sweep`] cuts a stack of polygons into slabs in which nothing changes and integrates each;
//! * [`sampled`] asks many points of each pixel, and knows nothing of edges.
//!
//! `oracles.rs` holds them against each other.

use super::Point;

/// What a picture should be: premultiplied RGBA in 8-bit levels, not rounded.
pub struct Truth {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels, row by row.
    pub data: Vec<[f64; 4]>,
}

impl Truth {
    /// A picture of nothing.
    pub fn new(width: u32, height: u32) -> Truth {
        Truth { width, height, data: vec![[0.0; 4]; (width * height) as usize] }
    }

    /// The pixel in column `x` and row `y`.
    pub fn pixel(&self, x: u32, y: u32) -> [f64; 4] {
        self.data[(y * self.width + x) as usize]
    }
}

/// Signed area of a polygon; positive where its corners go clockwise on the screen.
pub fn area(polygon: &[Point]) -> f64 {
    let mut twice = 0.0;
    for (i, [x0, y0]) in polygon.iter().enumerate() {
        let [x1, y1] = polygon[(i + 1) % polygon.len()];
        twice += x0 * y1 - x1 * y0;
    }
    twice / 2.0
}

/// The part of a polygon where `normal · p <= offset` (Sutherland & Hodgman, one plane).
pub fn clip_to_half_plane(polygon: &[Point], normal: Point, offset: f64) -> Vec<Point> {
    let height = |p: Point| normal[0] * p[0] + normal[1] * p[1] - offset;
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (h, k) = (height(p), height(q));
        if h <= 0.0 {
            kept.push(p);
        }
        if (h < 0.0 && k > 0.0) || (h > 0.0 && k < 0.0) {
            let t = h / (h - k);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}

/// The signed area of a polygon inside pixel (x, y): of any polygon, the mean winding number there.
pub fn area_in_pixel(polygon: &[Point], x: u32, y: u32) -> f64 {
    let (x, y) = (f64::from(x), f64::from(y));
    let mut part: Vec<Point> = polygon.iter().map(|p| [p[0] - x, p[1] - y]).collect();
    for (normal, offset) in [([-1.0, 0.0], 0.0), ([1.0, 0.0], 1.0), ([0.0, -1.0], 0.0), ([0.0, 1.0], 1.0)] {
        part = clip_to_half_plane(&part, normal, offset);
    }
    area(&part)
}

/// A picture of disjoint simple polygons, white on black, by [`area_in_pixel`].
pub fn coverage(width: u32, height: u32, polygons: &[Vec<Point>]) -> Truth {
    let mut truth = Truth::new(width, height);
    for (i, pixel) in truth.data.iter_mut().enumerate() {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let light = 255.0 * polygons.iter().map(|p| area_in_pixel(p, x, y).abs()).sum::<f64>();
        *pixel = [light, light, light, 255.0];
    }
    truth
}

/// When a point is inside a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Where the winding number is not 0.
    NonZero,
    /// Where it is odd.
    EvenOdd,
}

impl Rule {
    fn covers(self, winding: i32) -> bool {
        match self {
            Rule::NonZero => winding != 0,
            Rule::EvenOdd => winding & 1 != 0,
        }
    }
}

/// One path of a stack: the rings wind together under one rule.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Closed polygons.
    pub rings: Vec<Vec<Point>>,
    /// The fill rule.
    pub rule: Rule,
}

impl Layer {
    /// A path of one ring.
    pub fn new(points: &[Point]) -> Layer {
        Layer { rings: vec![points.to_vec()], rule: Rule::NonZero }
    }

    /// A path of several rings under the non-zero rule.
    pub fn of(rings: &[Vec<Point>]) -> Layer {
        Layer { rings: rings.to_vec(), rule: Rule::NonZero }
    }

    /// The same under the even-odd rule.
    pub fn even_odd(self) -> Layer {
        Layer { rule: Rule::EvenOdd, ..self }
    }
}

/// The colour of a stack of opaque layers, back to front, above a backdrop.
pub fn opaque<'a>(backdrop: [u8; 3], colours: &'a [[u8; 3]]) -> impl Fn(&[bool]) -> [f64; 4] + 'a {
    move |inside| {
        let front = inside.iter().rposition(|&inside| inside);
        let [r, g, b] = front.map_or(backdrop, |layer| colours[layer]);
        [f64::from(r), f64::from(g), f64::from(b), 255.0]
    }
}

/// The colour of a stack of layers of one opacity each, back to front, above an opaque backdrop.
pub fn blended<'a>(backdrop: [u8; 3], colours: &'a [([u8; 3], f64)]) -> impl Fn(&[bool]) -> [f64; 4] + 'a {
    move |inside| {
        let mut mixed = [f64::from(backdrop[0]), f64::from(backdrop[1]), f64::from(backdrop[2]), 255.0];
        for (layer, (colour, opacity)) in colours.iter().enumerate() {
            if inside[layer] {
                for (mixed, colour) in mixed.iter_mut().zip(colour) {
                    *mixed += opacity * (f64::from(*colour) - *mixed);
                }
            }
        }
        mixed
    }
}

/// A stack of paths to integrate.
pub struct Sweep<'a> {
    /// The paths, from the back to the front.
    pub layers: &'a [Layer],
    /// `None`: exact, cutting at each vertex, crossing and column, for up to some thousand edges.
    /// `Some(n)`: `n` lines a row, each exact in x.
    pub lines: Option<u32>,
}

/// An edge which goes down, and whether its path walked it so.
#[derive(Clone, Copy)]
struct Edge {
    layer: usize,
    winding: i32,
    top: Point,
    bottom: Point,
}

impl Edge {
    fn x_at(&self, y: f64) -> f64 {
        let t = (y - self.top[1]) / (self.bottom[1] - self.top[1]);
        self.top[0] + t * (self.bottom[0] - self.top[0])
    }

    fn y_at(&self, x: f64) -> f64 {
        let t = (x - self.top[0]) / (self.bottom[0] - self.top[0]);
        self.top[1] + t * (self.bottom[1] - self.top[1])
    }
}

impl<'a> Sweep<'a> {
    /// The exact integral.
    pub fn exact(layers: &'a [Layer]) -> Self {
        Sweep { layers, lines: None }
    }

    /// The integral over `n` lines a row.
    pub fn by_lines(layers: &'a [Layer], n: u32) -> Self {
        Sweep { layers, lines: Some(n) }
    }

    /// The picture, where `colour` tells what is seen where exactly these layers are.
    pub fn picture(&self, width: u32, height: u32, colour: impl Fn(&[bool]) -> [f64; 4]) -> Truth {
        let edges = self.edges();
        let mut truth = Truth::new(width, height);
        for (row, pixels) in truth.data.chunks_exact_mut(width as usize).enumerate() {
            let (top, bottom) = (row as f64, row as f64 + 1.0);
            let active: Vec<Edge> =
                edges.iter().copied().filter(|e| e.top[1] < bottom && e.bottom[1] > top).collect();
            let cuts = match self.lines {
                Some(n) => (0..=n).map(|i| top + f64::from(i) / f64::from(n)).collect(),
                None => exact_cuts(&active, top, bottom, width),
            };
            for slab in cuts.windows(2) {
                self.add_slab(&active, slab[0], slab[1], pixels, &colour);
            }
        }
        truth
    }

    fn edges(&self) -> Vec<Edge> {
        let mut edges = Vec::new();
        for (layer, path) in self.layers.iter().enumerate() {
            for ring in &path.rings {
                for (i, &a) in ring.iter().enumerate() {
                    let b = ring[(i + 1) % ring.len()];
                    if a[1] < b[1] {
                        edges.push(Edge { layer, winding: 1, top: a, bottom: b });
                    } else if a[1] > b[1] {
                        edges.push(Edge { layer, winding: -1, top: b, bottom: a });
                    }
                }
            }
        }
        edges
    }

    /// Adds what is seen for y in [top, bottom), taking the line in its middle for all of it: exact
    /// where no edge meets another or a column's border inside the slab.
    fn add_slab(
        &self,
        active: &[Edge],
        top: f64,
        bottom: f64,
        pixels: &mut [[f64; 4]],
        colour: impl Fn(&[bool]) -> [f64; 4],
    ) {
        let y = (top + bottom) / 2.0;
        let mut crossings: Vec<(f64, usize, i32)> = active
            .iter()
            .filter(|e| e.top[1] <= y && y < e.bottom[1])
            .map(|e| (e.x_at(y), e.layer, e.winding))
            .collect();
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let width = pixels.len() as f64;
        crossings.push((width, usize::MAX, 0));
        let mut windings = vec![0; self.layers.len()];
        let mut inside = vec![false; self.layers.len()];
        let mut from: f64 = 0.0;
        for (x, layer, winding) in crossings {
            let to = x.clamp(0.0, width);
            if to > from {
                let seen = colour(&inside);
                let mut left = from;
                while left < to {
                    let right = (left.floor() + 1.0).min(to);
                    for (sum, seen) in pixels[left as usize].iter_mut().zip(seen) {
                        *sum += (right - left) * (bottom - top) * seen;
                    }
                    left = right;
                }
                from = to;
            }
            if layer != usize::MAX {
                windings[layer] += winding;
                inside[layer] = self.layers[layer].rule.covers(windings[layer]);
            }
        }
    }
}

/// Every y in [top, bottom] at which an edge ends, meets another or enters another column.
fn exact_cuts(active: &[Edge], top: f64, bottom: f64, width: u32) -> Vec<f64> {
    let mut cuts = vec![top, bottom];
    for (i, e) in active.iter().enumerate() {
        cuts.extend([e.top[1], e.bottom[1]]);
        let (a, b) = (e.x_at(top.max(e.top[1])), e.x_at(bottom.min(e.bottom[1])));
        let (left, right) = (a.min(b).ceil().max(0.0), a.max(b).floor().min(width.into()));
        let mut x = left;
        while x <= right {
            if e.top[0] != e.bottom[0] {
                cuts.push(e.y_at(x));
            }
            x += 1.0;
        }
        for f in &active[i + 1..] {
            let (y0, y1) = (e.top[1].max(f.top[1]), e.bottom[1].min(f.bottom[1]));
            let (d0, d1) = (e.x_at(y0) - f.x_at(y0), e.x_at(y1) - f.x_at(y1));
            if y0 < y1 && d0 * d1 < 0.0 {
                cuts.push(y0 + d0 / (d0 - d1) * (y1 - y0));
            }
        }
    }
    cuts.retain(|y| (top..=bottom).contains(y));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// The same picture from `n` × `n` points a pixel.
pub fn sampled(
    width: u32,
    height: u32,
    n: u32,
    layers: &[Layer],
    colour: impl Fn(&[bool]) -> [f64; 4],
) -> Truth {
    let mut truth = Truth::new(width, height);
    let step = 1.0 / f64::from(n);
    for (i, pixel) in truth.data.iter_mut().enumerate() {
        let (x, y) = (f64::from(i as u32 % width), f64::from(i as u32 / width));
        for sample in 0..n * n {
            let at = [x + (f64::from(sample % n) + 0.5) * step, y + (f64::from(sample / n) + 0.5) * step];
            let inside: Vec<bool> = layers.iter().map(|layer| covers(layer, at)).collect();
            for (sum, seen) in pixel.iter_mut().zip(colour(&inside)) {
                *sum += seen * step * step;
            }
        }
    }
    truth
}

/// Whether a path covers a point, by the winding of its rings around it.
pub fn covers(layer: &Layer, [x, y]: Point) -> bool {
    let mut winding = 0;
    for ring in &layer.rings {
        for (i, a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if (a[1] <= y) != (b[1] <= y) {
                let side = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
                // A point on an edge lies right of it, whichever way the edge was drawn.
                if a[1] <= y && side <= 0.0 {
                    winding += 1;
                } else if a[1] > y && side >= 0.0 {
                    winding -= 1;
                }
            }
        }
    }
    layer.rule.covers(winding)
}
