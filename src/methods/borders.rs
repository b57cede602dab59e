//! Takes an outline's edges, makes one row of it for the methods that ask about places rather than
//! pieces: runs of pixels that lie inside, and for every other pixel the borders that cut it and what
//! winds round it from the left.
//!
//! Promises: where no border cuts a pixel it is inside as a whole or not listed; a shared border is
//! looked at by the same arithmetic from both sides. A point on a border belongs to the right or lower
//! side, as in [`crate::strips`], with which this file shares nothing but the edges.

use crate::band::Picture;
use crate::edges::{Edge, EdgeList, BAND_ROWS, FRACTION_BITS, ONE};
use crate::outlines::PlacedOutline;
use crate::polygons::Flattener;
use crate::scene::FillRule;

/// The part of the plane that a row of pixels looks at, in fixed point pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Rows [top, bottom).
    pub top: i32,
    pub bottom: i32,
    /// How far a pixel looks beyond its left and right border.
    pub margin: i32,
}

impl Window {
    /// A row of pixels, and nothing beyond it.
    pub fn row(y: u32) -> Window {
        let top = (y as i32) << FRACTION_BITS;
        Window { top, bottom: top + ONE, margin: 0 }
    }
}

/// Pixels [from, to) of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub from: usize,
    pub to: usize,
    /// How they are cut; `None` when they lie inside as a whole.
    pub cut: Option<Cut>,
}

/// What a pixel needs to know to tell where in its window the outline is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// The winding number at the upper end of the window's left side.
    base: i32,
    /// Places in [`BorderRow::steps`] and [`BorderRow::edges`].
    steps: (u32, u32),
    edges: (u32, u32),
}

/// What the winding number left of a pixel changes by, from this y on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub y: i32,
    pub winding: i32,
}

/// One row of an outline.
#[derive(Debug)]
pub(super) struct BorderRow {
    pub rule: FillRule,
    /// From the left; pixels in none lie outside.
    runs: Vec<Run>,
    steps: Vec<Step>,
    edges: Vec<Edge>,
}

impl Default for BorderRow {
    fn default() -> Self {
        BorderRow { rule: FillRule::NonZero, runs: Vec::new(), steps: Vec::new(), edges: Vec::new() }
    }
}

impl BorderRow {
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What winds round a cut pixel: the winding number at the window's top left, and its changes
    /// down the left side.
    pub fn left_of(&self, cut: Cut) -> (i32, &[Step]) {
        (cut.base, &self.steps[cut.steps.0 as usize..cut.steps.1 as usize])
    }

    /// The edges that may pass through a cut pixel's window.
    pub fn edges_of(&self, cut: Cut) -> &[Edge] {
        &self.edges[cut.edges.0 as usize..cut.edges.1 as usize]
    }

    /// The run that holds a pixel.
    pub fn run_at(&self, pixel: usize) -> Option<&Run> {
        let after = self.runs.partition_point(|run| run.to <= pixel);
        self.runs.get(after).filter(|run| run.from <= pixel)
    }

    /// Is a point of a cut pixel inside? It is given in fixed point pixels.
    pub fn holds(&self, cut: Cut, x: i32, y: i32) -> bool {
        let (base, steps) = self.left_of(cut);
        let left: i32 = steps.iter().take_while(|step| step.y <= y).map(|step| step.winding).sum();
        let crossed = |edge: &&Edge| edge.y0 <= y && y < edge.y1 && lies_left(edge, x, y);
        let here: i32 = self.edges_of(cut).iter().filter(crossed).map(|edge| edge.winding).sum();
        self.rule.inside(base + left + here)
    }

    /// Is a point of the row inside?
    pub fn holds_point(&self, x: i32, y: i32) -> bool {
        let run = self.run_at((x >> FRACTION_BITS) as usize);
        run.is_some_and(|run| run.cut.is_none_or(|cut| self.holds(cut, x, y)))
    }

    /// Makes every pixel inside or outside by its centre (`shape-rendering: crispEdges`).
    fn make_crisp(&mut self, window: Window) {
        let y = window.top + (window.bottom - window.top) / 2;
        for run in std::mem::take(&mut self.runs) {
            let Some(cut) = run.cut else {
                self.push_whole(run.from, run.to);
                continue;
            };
            for x in run.from..run.to {
                if self.holds(cut, ((x as i32) << FRACTION_BITS) + ONE / 2, y) {
                    self.push_whole(x, x + 1);
                }
            }
        }
    }

    fn push_whole(&mut self, from: usize, to: usize) {
        match self.runs.last_mut() {
            Some(last) if last.to == from && last.cut.is_none() => last.to = to,
            _ => self.runs.push(Run { from, to, cut: None }),
        }
    }
}

/// Does an edge that passes this height lie left of the point, or on it?
fn lies_left(edge: &Edge, x: i32, y: i32) -> bool {
    let (dx, dy) = (f64::from(edge.x1) - f64::from(edge.x0), f64::from(edge.y1) - f64::from(edge.y0));
    (f64::from(x) - f64::from(edge.x0)) * dy >= (f64::from(y) - f64::from(edge.y0)) * dx
}

/// Where an edge is in a row: pixels [first, end), none for one on a border between pixels.
#[derive(Clone, Copy)]
struct Extent {
    first: i32,
    end: i32,
    edge: Edge,
}

impl Extent {
    /// `None` when it does not meet the window.
    fn of(edge: &Edge, window: Window) -> Option<Extent> {
        let (top, bottom) = (edge.y0.max(window.top), edge.y1.min(window.bottom));
        if top >= bottom {
            return None;
        }
        let slope = (f64::from(edge.x1) - f64::from(edge.x0)) / (f64::from(edge.y1) - f64::from(edge.y0));
        let x_at = |y: i32| match y {
            y if y == edge.y0 => f64::from(edge.x0),
            y if y == edge.y1 => f64::from(edge.x1),
            y => f64::from(edge.x0) + (f64::from(y) - f64::from(edge.y0)) * slope,
        };
        let (a, b) = (x_at(top), x_at(bottom));
        let margin = f64::from(window.margin);
        let first = ((a.min(b) - margin) / f64::from(ONE)).floor() as i32;
        let end = ((a.max(b) + margin) / f64::from(ONE)).ceil() as i32;
        Some(Extent { first, end, edge: *edge })
    }
}

/// Makes rows of outlines; keeps its buffers.
pub(super) struct RowMaker {
    flattener: Flattener,
    list: EdgeList,
    width: i32,
    extents: Vec<Extent>,
    /// Pixel and extent.
    local: Vec<(i32, u32)>,
    left: Vec<Step>,
}

impl RowMaker {
    pub fn new(width: u32, height: u32) -> RowMaker {
        RowMaker {
            flattener: Flattener::default(),
            list: EdgeList::new(width, height),
            width: width as i32,
            extents: Vec::new(),
            local: Vec::new(),
            left: Vec::new(),
        }
    }

    /// Makes the row of an outline that lies in a window, of which the row of pixels `y` is the middle.
    pub fn make(
        &mut self,
        picture: &Picture,
        outline: &PlacedOutline,
        y: u32,
        window: Window,
        row: &mut BorderRow,
    ) {
        (row.rule, row.runs) = (outline.rule, std::mem::take(&mut row.runs));
        row.runs.clear();
        row.steps.clear();
        row.edges.clear();
        let edges = outline.edges(&mut self.flattener, &mut self.list, picture.to_pixels, picture.tolerance);
        let band = (y / BAND_ROWS) as usize;
        let (top, bottom) = ((band as i32 * BAND_ROWS as i32) << FRACTION_BITS, BAND_ROWS as i32 * ONE);
        self.extents.clear();
        let mut take = |edge: &Edge| self.extents.extend(Extent::of(edge, window));
        edges.band(band).iter().for_each(&mut take);
        // An edge stands in each band that it meets, and is wanted once.
        if let Some(above) = band.checked_sub(1).filter(|_| window.top < top) {
            edges.band(above).iter().filter(|edge| edge.y1 <= top).for_each(&mut take);
        }
        if window.bottom > top + bottom {
            edges.band(band + 1).iter().filter(|edge| edge.y0 >= top + bottom).for_each(&mut take);
        }
        self.sweep(window, row);
        if outline.crisp {
            row.make_crisp(window);
        }
    }

    /// Sweeps the row from left to right.
    fn sweep(&mut self, window: Window, row: &mut BorderRow) {
        self.extents.sort_unstable_by_key(|extent| {
            let Edge { x0, y0, x1, y1, winding } = extent.edge;
            (extent.end, y0, x0, y1, x1, winding)
        });
        self.local.clear();
        for (number, extent) in self.extents.iter().enumerate() {
            let pixels = extent.first.max(0)..extent.end.min(self.width);
            self.local.extend(pixels.map(|pixel| (pixel, number as u32)));
        }
        self.local.sort_unstable();
        self.left.clear();
        let (mut base, mut gone, mut at, mut x) = (0, 0, 0, 0);
        while x < self.width {
            while let Some(extent) = self.extents.get(gone).filter(|extent| extent.end <= x) {
                // One that ends where it begins may lie right of here.
                base += pass(&extent.edge, window, &mut self.left);
                gone += 1;
            }
            let first = at;
            while self.local.get(at).is_some_and(|&(pixel, _)| pixel == x) {
                at += 1;
            }
            let next_local = self.local.get(at).map_or(self.width, |&(pixel, _)| pixel);
            let next_gone = self.extents.get(gone).map_or(self.width, |extent| extent.end);
            let to = if at > first { x + 1 } else { next_local.min(next_gone).min(self.width) };
            let (from, to_pixel) = (x as usize, to as usize);
            if at > first || !self.left.is_empty() {
                let (steps, edges) = (row.steps.len() as u32, row.edges.len() as u32);
                row.steps.extend_from_slice(&self.left);
                row.edges.extend(self.local[first..at].iter().map(|&(_, n)| self.extents[n as usize].edge));
                let steps = (steps, row.steps.len() as u32);
                let edges = (edges, row.edges.len() as u32);
                row.runs.push(Run { from, to: to_pixel, cut: Some(Cut { base, steps, edges }) });
            } else if row.rule.inside(base) {
                row.push_whole(from, to_pixel);
            }
            x = to;
        }
    }
}

/// An edge comes to lie left of what is looked at: its steps join the others, and what it does to the
/// winding number at the window's top is given back.
fn pass(edge: &Edge, window: Window, steps: &mut Vec<Step>) -> i32 {
    let begins_inside = edge.y0 > window.top;
    if begins_inside {
        add_step(steps, Step { y: edge.y0, winding: edge.winding });
    }
    if edge.y1 < window.bottom {
        add_step(steps, Step { y: edge.y1, winding: -edge.winding });
    }
    if begins_inside {
        0
    } else {
        edge.winding
    }
}

/// Where one edge ends the next one of a border begins: most steps cancel.
fn add_step(steps: &mut Vec<Step>, step: Step) {
    let at = steps.partition_point(|other| other.y < step.y);
    match steps.get_mut(at).filter(|other| other.y == step.y) {
        None => steps.insert(at, step),
        Some(other) => {
            other.winding += step.winding;
            if other.winding == 0 {
                steps.remove(at);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Point;

    /// The row [0, 1) of a polygon on 8 pixels.
    fn row(points: &[(f64, f64)]) -> BorderRow {
        let mut maker = RowMaker::new(8, 8);
        maker.list.move_to(Point::new(points[0].0, points[0].1));
        points[1..].iter().for_each(|p| maker.list.line_to(Point::new(p.0, p.1)));
        maker.list.close();
        let edges = maker.list.take_banded();
        let window = Window::row(0);
        maker.extents.extend(edges.band(0).iter().filter_map(|edge| Extent::of(edge, window)));
        let mut row = BorderRow::default();
        maker.sweep(window, &mut row);
        row
    }

    fn runs(row: &BorderRow) -> Vec<(usize, usize, bool)> {
        row.runs().iter().map(|run| (run.from, run.to, run.cut.is_none())).collect()
    }

    #[test]
    fn a_rectangle_on_the_grid_cuts_no_pixel() {
        assert_eq!(runs(&row(&[(2.0, -1.0), (5.0, -1.0), (5.0, 3.0), (2.0, 3.0)])), [(2, 5, true)]);
    }

    #[test]
    fn the_pixels_over_a_horizontal_border_are_cut_without_edges() {
        let row = row(&[(1.5, -1.0), (5.5, -1.0), (5.5, 0.25), (1.5, 0.25)]);
        assert_eq!(runs(&row), [(1, 2, false), (2, 5, false), (5, 6, false)]);
        let at = |x: f64, y: f64| row.holds_point((x * 16384.0) as i32, (y * 16384.0) as i32);
        assert!(at(3.5, 0.24) && !at(3.5, 0.25) && at(1.5, 0.1) && !at(1.49, 0.1) && !at(5.5, 0.1));
    }

    #[test]
    fn a_vertex_between_two_edges_leaves_no_step() {
        let row = row(&[(1.5, -1.0), (5.5, -1.0), (5.7, 0.25), (5.2, 3.0), (1.5, 3.0)]);
        assert_eq!(runs(&row), [(1, 2, false), (2, 5, true), (5, 6, false)]);
    }
}
