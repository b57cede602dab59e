//! Takes a row of an outline, makes the share of each pixel's footprint that it covers, by itself.
//!
//! A footprint is a figure around the pixel's centre that is symmetric in x: at each height y it reaches
//! from -c(y) to c(y). It is cut in slabs in y, at every vertex and every crossing of borders; within a
//! slab borders have an order in x, and the area right of each is an integral with a closed form (Green's
//! theorem, slab by slab): a trapezoid where the border lies in the footprint, the footprint's own area
//! where it lies beside it.

use super::borders::{BorderRow, Cut, Window};
use crate::edges::{Edge, FRACTION_BITS, ONE};

/// Pixels with more borders than this, or more places to cut at than that, are cut in [`FINE_SLABS`]
/// only, and each taken to be like its middle.
const MOST_BORDERS: usize = 48;
const MOST_CUTS: usize = 96;
const FINE_SLABS: usize = 64;

/// The figure over which a pixel's light is gathered; lengths in pixels from the pixel's centre.
pub(super) trait Footprint {
    /// It reaches from -this to this in y, and no farther in x.
    const REACH: f64;

    /// The area within heights [from, to) and -c(y) .. 0.
    fn half_area(from: f64, to: f64) -> f64;

    /// c(y).
    fn reach_at(y: f64) -> f64;

    /// The heights at which a line through (x, 0), that runs `slope` in x for each step in y, meets the
    /// border of the footprint; those outside it may be anything.
    fn meets(x: f64, slope: f64) -> [f64; 4];
}

/// A border in a slab: x at y = 0, run over rise, and what crossing it from left to right adds.
#[derive(Clone, Copy)]
struct Line {
    x: f64,
    slope: f64,
    top: f64,
    bottom: f64,
    winding: i32,
}

impl Line {
    /// In pixels from a point.
    fn of(edge: &Edge, (x, y): (f64, f64)) -> Line {
        let pixels = |v: i32| f64::from(v) / f64::from(ONE);
        let (x0, y0, x1, y1) =
            (pixels(edge.x0) - x, pixels(edge.y0) - y, pixels(edge.x1) - x, pixels(edge.y1) - y);
        let slope = (x1 - x0) / (y1 - y0);
        Line { x: x0 - y0 * slope, slope, top: y0, bottom: y1, winding: edge.winding }
    }

    fn x_at(&self, y: f64) -> f64 {
        self.x + self.slope * y
    }

    /// The footprint's area left of it within [from, to).
    fn area_left<F: Footprint>(&self, from: f64, to: f64) -> f64 {
        let mut cuts =
            F::meets(self.x, self.slope).map(|y| if y.is_finite() { y.clamp(from, to) } else { from });
        cuts.sort_unstable_by(f64::total_cmp);
        let mut area = F::half_area(from, to);
        let mut last = from;
        for y in cuts.into_iter().chain([to]) {
            let middle = 0.5 * (last + y);
            let (x, reach) = (self.x_at(middle), F::reach_at(middle));
            if x >= reach {
                area += F::half_area(last, y);
            } else if x <= -reach {
                area -= F::half_area(last, y);
            } else {
                area += x * (y - last);
            }
            last = y;
        }
        area
    }
}

/// Measures shares; keeps its buffers.
#[derive(Default)]
pub(super) struct Ruler {
    lines: Vec<Line>,
    cuts: Vec<f64>,
    active: Vec<(f64, usize)>,
}

impl Ruler {
    /// The share of a cut pixel's footprint that lies inside, 0 ..= 1. What of the footprint lies above
    /// or below the window is left out, and the rest counts as all of it.
    pub fn share<F: Footprint>(
        &mut self,
        row: &BorderRow,
        cut: Cut,
        (pixel, y): (usize, u32),
        window: Window,
    ) -> f64 {
        let middle = |v: f64| v + 0.5;
        let center = (middle(pixel as f64), middle(f64::from(y)));
        let height = |v: i32| f64::from(v) / f64::from(ONE) - center.1;
        let (top, bottom) = (height(window.top).max(-F::REACH), height(window.bottom).min(F::REACH));
        self.lines.clear();
        self.lines.extend(row.edges_of(cut).iter().map(|edge| Line::of(edge, center)));
        let (base, steps) = row.left_of(cut);
        self.cuts.clear();
        self.cuts.extend([top, bottom]);
        self.cuts.extend(steps.iter().map(|step| height(step.y)));
        if self.lines.len() <= MOST_BORDERS {
            self.cuts.extend(self.lines.iter().flat_map(|line| [line.top, line.bottom]));
            self.cut_at_crossings();
        }
        self.cuts.retain(|&y| y >= top && y <= bottom);
        if self.lines.len() > MOST_BORDERS || self.cuts.len() > MOST_CUTS {
            let step = (bottom - top) / FINE_SLABS as f64;
            self.cuts.clear();
            self.cuts.extend((0..=FINE_SLABS).map(|i| top + step * i as f64));
        }
        self.cuts.sort_unstable_by(f64::total_cmp);
        self.cuts.dedup();
        let mut area = 0.0;
        for i in 1..self.cuts.len() {
            let (from, to) = (self.cuts[i - 1], self.cuts[i]);
            let fixed = ((0.5 * (from + to) + center.1) * f64::from(ONE)).floor() as i32;
            let left: i32 = steps.iter().take_while(|step| step.y <= fixed).map(|step| step.winding).sum();
            area += self.slab::<F>(row, base + left, from, to);
        }
        let whole = 2.0 * F::half_area(top, bottom);
        (area / whole).clamp(0.0, 1.0)
    }

    fn cut_at_crossings(&mut self) {
        for (i, a) in self.lines.iter().enumerate() {
            for b in &self.lines[..i] {
                let y = (b.x - a.x) / (a.slope - b.slope);
                if y > a.top.max(b.top) && y < a.bottom.min(b.bottom) {
                    self.cuts.push(y);
                }
            }
        }
    }

    /// The area inside within one slab, in which no borders cross.
    fn slab<F: Footprint>(&mut self, row: &BorderRow, left: i32, from: f64, to: f64) -> f64 {
        let middle = 0.5 * (from + to);
        self.active.clear();
        for (number, line) in self.lines.iter().enumerate() {
            if line.top < middle && middle < line.bottom {
                self.active.push((line.x_at(middle), number));
            }
        }
        self.active.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (mut winding, mut area) = (left, 0.0);
        // Where the stretch inside begins, as the area left of it.
        let mut begin = row.rule.inside(winding).then_some(0.0);
        for &(_, number) in &self.active {
            let line = self.lines[number];
            winding += line.winding;
            match (begin, row.rule.inside(winding)) {
                (None, true) => begin = Some(line.area_left::<F>(from, to)),
                (Some(left), false) => {
                    area += line.area_left::<F>(from, to) - left;
                    begin = None;
                }
                _ => {}
            }
        }
        area + begin.map_or(0.0, |left| 2.0 * F::half_area(from, to) - left)
    }
}

/// The window of a row of pixels whose footprints reach this far, within the picture's rows.
pub(super) fn window<F: Footprint>(y: u32, height: u32) -> Window {
    let margin = ((F::REACH - 0.5) * f64::from(ONE)).ceil().max(0.0) as i32;
    let Window { top, bottom, .. } = Window::row(y);
    Window {
        top: (top - margin).max(0),
        bottom: (bottom + margin).min((height as i32) << FRACTION_BITS),
        margin,
    }
}
