//! Takes the edges in one pixel, makes the exact area which each set of shapes covers: the slab
//! sweep. All in pixel units, (0, 0) at the pixel's top left corner, y downward.

use kurbo::Point;
use std::collections::BTreeMap;

/// What one geometry has in one pixel.
pub(super) struct Cell {
    pub(super) column: usize,
    pub(super) geometry: u32,
    pub(super) edges: Vec<Edge>,
    /// Its winding number along the pixel's left border.
    pub(super) steps: Steps,
}

/// A piece of a boundary inside the pixel, from top to bottom; it counts for y in [y_top, y_bottom).
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub(super) x_top: f64,
    pub(super) y_top: f64,
    pub(super) x_bottom: f64,
    pub(super) y_bottom: f64,
    pub(super) winding: i32,
    /// Which of the pixel's cells it belongs to.
    pub(super) local: u32,
}

impl Edge {
    fn x_at(&self, y: f64) -> f64 {
        let part = (y - self.y_top) / (self.y_bottom - self.y_top);
        self.x_top + (self.x_bottom - self.x_top) * part
    }
}

/// A winding number as a function of y, by its steps: sorted by y, none is zero. The vertices to the
/// left of a border cancel bit by bit, so that what is left are the crossings of the border itself.
#[derive(Clone, Default)]
pub(super) struct Steps(Vec<(f64, i32)>);

impl Steps {
    /// Adds `winding` for y in [top, bottom).
    pub(super) fn add(&mut self, top: f64, bottom: f64, winding: i32) {
        self.step(top, winding);
        self.step(bottom, -winding);
    }

    fn step(&mut self, y: f64, by: i32) {
        let at = self.0.partition_point(|&(known, _)| known < y);
        match self.0.get_mut(at) {
            Some((known, sum)) if *known == y => {
                *sum += by;
                if *sum == 0 {
                    self.0.remove(at);
                }
            }
            _ => self.0.insert(at, (y, by)),
        }
    }

    /// The winding number, if it is one for all y in [0, 1).
    pub(super) fn constant(&self) -> Option<i32> {
        match self.0.as_slice() {
            [] => Some(0),
            [(y, winding), rest @ ..] if *y <= 0.0 => {
                rest.first().is_none_or(|(y, _)| *y >= 1.0).then_some(*winding)
            }
            [(y, _), ..] => (*y >= 1.0).then_some(0),
        }
    }

    fn at(&self, y: f64) -> i32 {
        self.0.iter().take_while(|(step, _)| *step <= y).map(|(_, by)| by).sum()
    }
}

/// The part of the pixel which one set of shapes covers.
#[derive(Clone, Copy, Default)]
pub(super) struct Region {
    pub(super) area: f64,
    moment_x: f64,
    moment_y: f64,
}

impl Region {
    /// Nearly its centroid: each trapezoid counts at half its height.
    pub(super) fn centroid(&self) -> Point {
        Point::new(self.moment_x / self.area, self.moment_y / self.area)
    }
}

/// More crossings than this between two vertices are not cut at one by one.
const MOST_CROSSINGS: usize = 20_000;
/// Cuts in their stead. With so many edges in a slab the error of each cell is about its width over
/// this number, and of either sign.
const CUTS_INSTEAD: usize = 2_000;

/// The sweep of one pixel, and its buffers.
#[derive(Default)]
pub(super) struct Sweep {
    edges: Vec<Edge>,
    active: Vec<Edge>,
    order: Vec<(f64, i32, u32)>,
    cuts: Vec<f64>,
    windings: Vec<i32>,
    at_left: Vec<i32>,
    covered: Vec<u64>,
    regions: BTreeMap<Box<[u64]>, Region>,
}

impl Sweep {
    /// The regions found: which cells cover them (bit i of word i / 64 for cell i), and their area.
    pub(super) fn regions(&self) -> impl Iterator<Item = (&[u64], &Region)> {
        self.regions.iter().map(|(covered, region)| (&**covered, region))
    }

    /// Sweeps the pixel; `holds(i, winding)` is the fill rule of cell i. False if the crossings were
    /// too many to be cut at.
    pub(super) fn run(&mut self, cells: &[&Cell], holds: impl Fn(usize, i32) -> bool) -> bool {
        self.regions.clear();
        self.edges.clear();
        self.active.clear();
        let mut ys = vec![0.0, 1.0];
        for (local, cell) in cells.iter().enumerate() {
            self.edges.extend(cell.edges.iter().map(|&edge| Edge { local: local as u32, ..edge }));
            ys.extend(cell.steps.0.iter().map(|&(y, _)| y).filter(|y| 0.0 < *y && *y < 1.0));
        }
        ys.extend(self.edges.iter().flat_map(|edge| [edge.y_top, edge.y_bottom]));
        ys.sort_by(f64::total_cmp);
        ys.dedup();
        self.edges.sort_by(|a, b| a.y_top.total_cmp(&b.y_top));
        let mut next = 0;
        let mut exact = true;
        for slab in ys.windows(2) {
            let (top, bottom) = (slab[0], slab[1]);
            while next < self.edges.len() && self.edges[next].y_top <= top {
                self.active.push(self.edges[next]);
                next += 1;
            }
            self.active.retain(|edge| edge.y_bottom > top);
            self.at_left.clear();
            self.at_left.extend(cells.iter().map(|cell| cell.steps.at(top)));
            exact &= self.cut_at_crossings(top, bottom);
            for cut in 1..self.cuts.len() {
                self.add_trapezoids(self.cuts[cut - 1], self.cuts[cut], &holds);
            }
        }
        exact
    }

    /// Fills `cuts` with top, bottom and each crossing of active edges in between.
    fn cut_at_crossings(&mut self, top: f64, bottom: f64) -> bool {
        self.cuts.clear();
        self.cuts.extend([top, bottom]);
        let mut ends: Vec<(f64, f64)> =
            self.active.iter().map(|edge| (edge.x_at(top), edge.x_at(bottom))).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        if ends.is_sorted_by(|a, b| a.1 <= b.1) {
            return true;
        }
        for (i, one) in ends.iter().enumerate() {
            for other in &ends[i + 1..] {
                let (before, after) = (other.0 - one.0, other.1 - one.1);
                if before > 0.0 && after < 0.0 {
                    let y = top + (bottom - top) * (before / (before - after));
                    if top < y && y < bottom {
                        self.cuts.push(y);
                    }
                }
            }
            if self.cuts.len() > MOST_CROSSINGS {
                self.cuts.clear();
                let share = (bottom - top) / CUTS_INSTEAD as f64;
                self.cuts.extend((0..CUTS_INSTEAD).map(|i| top + share * i as f64));
                self.cuts.push(bottom);
                return false;
            }
        }
        self.cuts.sort_by(f64::total_cmp);
        self.cuts.dedup();
        true
    }

    /// The trapezoids of one slab in which no edges cross: each is as wide as at half its height.
    fn add_trapezoids(&mut self, top: f64, bottom: f64, holds: &impl Fn(usize, i32) -> bool) {
        let (middle, height) = (0.5 * (top + bottom), bottom - top);
        self.order.clear();
        self.order.extend(self.active.iter().map(|edge| (edge.x_at(middle), edge.winding, edge.local)));
        self.order.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.windings.clear();
        self.windings.extend_from_slice(&self.at_left);
        self.covered.clear();
        self.covered.resize(self.windings.len().div_ceil(64), 0);
        for (local, &winding) in self.windings.iter().enumerate() {
            if holds(local, winding) {
                self.covered[local / 64] |= 1 << (local % 64);
            }
        }
        let mut x = 0.0;
        for at in 0..=self.order.len() {
            let end = self.order.get(at).map_or(1.0, |edge| edge.0.clamp(x, 1.0));
            if end > x {
                let area = (end - x) * height;
                let region = match self.regions.get_mut(self.covered.as_slice()) {
                    Some(region) => region,
                    None => self.regions.entry(self.covered.clone().into()).or_default(),
                };
                region.area += area;
                region.moment_x += area * 0.5 * (x + end);
                region.moment_y += area * middle;
                x = end;
            }
            let Some(&(_, winding, local)) = self.order.get(at) else { break };
            let local = local as usize;
            self.windings[local] += winding;
            let bit = 1 << (local % 64);
            if holds(local, self.windings[local]) {
                self.covered[local / 64] |= bit;
            } else {
                self.covered[local / 64] &= !bit;
            }
        }
    }
}
