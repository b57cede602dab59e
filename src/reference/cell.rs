//! Takes the edges in one pixel, makes the exact area which each set of shapes covers: the slab
//! sweep. All in pixel units, (0, 0) at the pixel's top left corner, y downward.

use super::turns::Trapezoid;
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
#[derive(Default)]
pub(super) struct Region {
    pub(super) area: f64,
    /// What it consists of, if that is wanted.
    pub(super) trapezoids: Vec<Trapezoid>,
}

/// Crossings this near to each other in y (in pixels) are one cut: edges through one point cross at
/// as many y as rounding has it. The area lost is less than that times the crossings.
const SAME_CROSSING: f64 = 1e-12;
/// In one pixel, so many edges times cuts at crossings are worth their time (some milliseconds).
const MOST_WORK: usize = 500_000;
/// Beyond that, slabs are no higher than one part in so many, and the crossings inside them are
/// missed, each to either side: the tests find some hundredths of a
/// level at most.
const SLABS_INSTEAD: f64 = 1024.0;
/// Crossings are collected by so many before equal ones are merged.
const MOST_CROSSINGS: usize = 100_000;

/// Where an edge crosses a slab: x at half the slab's height, at its top and at its bottom.
#[derive(Clone, Copy)]
struct Crossing {
    middle: f64,
    ends: [f64; 2],
    winding: i32,
    local: u32,
}

/// The sweep of one pixel, and its buffers.
pub(super) struct Sweep {
    /// Whether the regions' trapezoids are wanted.
    shapes_wanted: bool,
    /// What is left of the work that the crossings may cost.
    work: usize,
    most_work: usize,
    edges: Vec<Edge>,
    active: Vec<Edge>,
    order: Vec<Crossing>,
    cuts: Vec<f64>,
    windings: Vec<i32>,
    at_left: Vec<i32>,
    covered: Vec<u64>,
    regions: BTreeMap<Box<[u64]>, Region>,
}

impl Default for Sweep {
    fn default() -> Sweep {
        Sweep::with_most_work(MOST_WORK)
    }
}

impl Sweep {
    fn with_most_work(most_work: usize) -> Sweep {
        Sweep {
            shapes_wanted: false,
            work: most_work,
            most_work,
            edges: Vec::new(),
            active: Vec::new(),
            order: Vec::new(),
            cuts: Vec::new(),
            windings: Vec::new(),
            at_left: Vec::new(),
            covered: Vec::new(),
            regions: BTreeMap::new(),
        }
    }

    /// The regions found: which cells cover them (bit i of word i / 64 for cell i), and their area.
    pub(super) fn regions(&self) -> impl Iterator<Item = (&[u64], &Region)> {
        self.regions.iter().map(|(covered, region)| (&**covered, region))
    }

    /// Sweeps the pixel; `holds(i, winding)` is the fill rule of cell i. False if the crossings were
    /// too many to be cut at.
    pub(super) fn run(
        &mut self,
        cells: &[&Cell],
        shapes_wanted: bool,
        holds: impl Fn(usize, i32) -> bool,
    ) -> bool {
        self.shapes_wanted = shapes_wanted;
        self.regions.clear();
        self.edges.clear();
        self.active.clear();
        self.work = self.most_work;
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
        let most = self.work / ends.len().max(1);
        // From their order at the top to that at the bottom by exchanging neighbours: each exchange
        // is a crossing, and there are no others.
        for last in 1..ends.len() {
            let mut at = last;
            while at > 0 && ends[at - 1].1 > ends[at].1 {
                let (before, after) = (ends[at].0 - ends[at - 1].0, ends[at - 1].1 - ends[at].1);
                self.cuts.push(top + (bottom - top) * (before / (before + after)).clamp(0.0, 1.0));
                ends.swap(at - 1, at);
                at -= 1;
            }
            if self.cuts.len() > MOST_CROSSINGS {
                self.merge_cuts(top, bottom);
                if self.cuts.len() > most {
                    break;
                }
            }
        }
        self.merge_cuts(top, bottom);
        if self.cuts.len() <= 2 || self.cuts.len() - 2 <= most {
            self.work -= (self.cuts.len() - 2) * ends.len();
            return true;
        }
        let count = ((bottom - top) * SLABS_INSTEAD).ceil().max(1.0);
        self.cuts.clear();
        self.cuts.extend((0..count as usize).map(|i| top + (bottom - top) * (i as f64 / count)));
        self.cuts.push(bottom);
        false
    }

    fn merge_cuts(&mut self, top: f64, bottom: f64) {
        self.cuts.retain(|&cut| top < cut && cut < bottom);
        self.cuts.extend([top, bottom]);
        self.cuts.sort_by(f64::total_cmp);
        self.cuts.pop();
        self.cuts.dedup_by(|below, above| *below - *above < SAME_CROSSING);
        self.cuts.push(bottom);
    }

    /// The trapezoids of one slab in which no edges cross: each is as wide as at half its height.
    fn add_trapezoids(&mut self, top: f64, bottom: f64, holds: &impl Fn(usize, i32) -> bool) {
        let (middle, height) = (0.5 * (top + bottom), bottom - top);
        self.order.clear();
        self.order.extend(self.active.iter().map(|edge| Crossing {
            middle: edge.x_at(middle),
            ends: [edge.x_at(top), edge.x_at(bottom)],
            winding: edge.winding,
            local: edge.local,
        }));
        self.order.sort_by(|a, b| a.middle.total_cmp(&b.middle));
        self.windings.clear();
        self.windings.extend_from_slice(&self.at_left);
        self.covered.clear();
        self.covered.resize(self.windings.len().div_ceil(64), 0);
        for (local, &winding) in self.windings.iter().enumerate() {
            if holds(local, winding) {
                self.covered[local / 64] |= 1 << (local % 64);
            }
        }
        let (mut x, mut left) = (0.0, [0.0; 2]);
        for at in 0..=self.order.len() {
            let end = self.order.get(at).map_or(1.0, |edge| edge.middle.clamp(x, 1.0));
            if end > x {
                let area = (end - x) * height;
                let region = match self.regions.get_mut(self.covered.as_slice()) {
                    Some(region) => region,
                    None => self.regions.entry(self.covered.clone().into()).or_default(),
                };
                region.area += area;
                let right = self.order.get(at).map_or([1.0; 2], |edge| edge.ends);
                if self.shapes_wanted {
                    region.trapezoids.push(Trapezoid { top, bottom, left, right });
                }
                (x, left) = (end, right);
            }
            let Some(&Crossing { winding, local, .. }) = self.order.get(at) else { break };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A cell of one closed polygon of random corners in the pixel.
    fn scribble(corners: usize) -> Cell {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let points: Vec<(f64, f64)> = (0..corners).map(|_| (random(), random())).collect();
        let edges = (0..corners).map(|i| {
            let (from, to) = (points[i], points[(i + 1) % corners]);
            let (top, bottom, winding) = if from.1 < to.1 { (from, to, 1) } else { (to, from, -1) };
            let (x_top, y_top, x_bottom, y_bottom) = (top.0, top.1, bottom.0, bottom.1);
            Edge { x_top, y_top, x_bottom, y_bottom, winding, local: 0 }
        });
        Cell { column: 0, geometry: 0, edges: edges.collect(), steps: Steps::default() }
    }

    #[test]
    fn missing_the_crossings_costs_less_than_a_twentieth_of_a_level() {
        for corners in [60, 200, 600] {
            let cell = scribble(corners);
            let [exact, rough] = [usize::MAX, 0].map(|most_work| {
                let mut sweep = Sweep::with_most_work(most_work);
                let is_exact = sweep.run(&[&cell], false, |_, winding| winding % 2 != 0);
                assert_eq!(is_exact, most_work > 0);
                sweep.regions[[1].as_slice()].area
            });
            println!("{corners} corners: {:.1e} of a level", (exact - rough).abs() * 255.0);
            assert!((exact - rough).abs() * 255.0 < 0.05, "{exact} and {rough}");
        }
    }
}
