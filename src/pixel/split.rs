//! Catmull's pixel integrator: takes the fragments of one pixel, makes its visible regions and their
//! areas (Catmull 1978, section 4, step 2b).
//!
//! The pixel is one convex region. As long as a region's colour depends on a fragment whose border
//! runs through it, the region is split along the straight line of one piece of that border. Which
//! fragment is looked at next is decided from the front of the z-list, so nothing behind the first
//! opaque fragment that covers a region is ever looked at. Splitting convex regions by whole lines,
//! where Catmull splits polygons by each other's edges, leaves no case but "left or right of a line".
//!
//! It is general and slow: some 20,000 instructions a pixel where the sums along borders
//! ([`super::boundary`]) need 4,000 on the same pixels. It is called where those do not go: for paint
//! that varies within a pixel, whose colour is taken in each region's centre; for borders that cross
//! often; and by the tests, which hold every closed form against it.
//!
//! Promises: the areas of the regions sum exactly to the pixel, for each split gives one side what the
//! other leaves of an integer. It ends, for a piece lies on the border of both regions that its line
//! made, and is not inside a region again. Work is capped; past the cap the caller samples instead.

use super::fragment::{PieceSet, PIXEL_AREA};
use crate::edges::ONE;

/// A piece this close to a region's border, in fixed point units, runs along it: a 16-millionth of a
/// pixel, far above the rounding of the arithmetic here and far below what can be seen.
const ON_BORDER: f64 = 1e-3;

/// Fragments that can be told apart in one pixel.
pub(crate) const MOST_LEAVES: usize = 64;

/// A line through the plane of the pixel; `a x + b y + c` is the distance of a point on its left.
#[derive(Clone, Copy, Debug)]
struct Line {
    a: f64,
    b: f64,
    c: f64,
}

impl Line {
    fn through(x0: f64, y0: f64, x1: f64, y1: f64) -> Line {
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = (dx * dx + dy * dy).sqrt();
        let (a, b) = (-dy / length, dx / length);
        Line { a, b, c: -(a * x0 + b * y0) }
    }

    #[inline]
    fn distance(&self, x: f64, y: f64) -> f64 {
        self.a * x + self.b * y + self.c
    }

    fn reversed(self) -> Line {
        Line { a: -self.a, b: -self.b, c: -self.c }
    }
}

/// A corner of a region, and the line along which its border goes on; the inside has positive distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub x: f64,
    pub y: f64,
    border: Line,
}

/// A piece in floating point.
#[derive(Clone, Copy, Debug)]
struct Chord {
    x0: f64,
    y0: f64,
    x1: f64,
    y1: f64,
    line: Line,
    winding: i32,
}

/// One fragment's share of [`Integrator::chords`] and [`Integrator::steps`].
#[derive(Clone, Copy, Debug)]
struct Leaf {
    chords: (u32, u32),
    steps: (u32, u32),
    base: i32,
    rule: crate::scene::FillRule,
}

/// Which fragments a region is known to lie inside or outside of, one bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Known {
    pub known: u64,
    pub inside: u64,
}

#[derive(Clone, Copy, Debug)]
struct Region {
    first_corner: u32,
    area: i64,
    known: Known,
}

/// The cap on work was reached.
#[derive(Debug)]
pub(crate) struct TooComplex;

/// Splits pixels; keeps its buffers from one to the next.
#[derive(Default)]
pub(crate) struct Integrator {
    chords: Vec<Chord>,
    steps: Vec<(f64, i32)>,
    leaves: Vec<Leaf>,
    corners: Vec<Corner>,
    regions: Vec<Region>,
    split: [Vec<Corner>; 3],
    /// Regions made since the start.
    pub nodes: u64,
}

impl Integrator {
    /// Forgets the last pixel's fragments.
    pub fn clear(&mut self) {
        self.chords.clear();
        self.steps.clear();
        self.leaves.clear();
    }

    /// Adds a fragment; its number is the count of those added before.
    pub fn add(&mut self, set: &PieceSet, rule: crate::scene::FillRule) {
        let chords = self.chords.len() as u32;
        let steps = self.steps.len() as u32;
        self.chords.extend(set.pieces.iter().map(|p| {
            let [x0, y0, x1, y1] = [p.x0, p.y0, p.x1, p.y1].map(f64::from);
            Chord { x0, y0, x1, y1, line: Line::through(x0, y0, x1, y1), winding: p.winding }
        }));
        self.steps.extend(set.steps.iter().map(|&(y, step)| (f64::from(y), step)));
        self.leaves.push(Leaf {
            chords: (chords, self.chords.len() as u32),
            steps: (steps, self.steps.len() as u32),
            base: set.base,
            rule,
        });
    }

    /// Adds lines, by their ends in fixed point, numbered as a fragment is: a region is known once none of them
    /// runs through it. What has no length, or no end, is left out.
    pub fn add_lines(&mut self, lines: impl Iterator<Item = [(f64, f64); 2]>) {
        let (chords, steps) = (self.chords.len() as u32, self.steps.len() as u32);
        let is_line = |&[(x0, y0), (x1, y1)]: &[(f64, f64); 2]| {
            let length = (x1 - x0).hypot(y1 - y0);
            length.is_finite() && length > 0.0
        };
        self.chords.extend(lines.filter(is_line).map(|[(x0, y0), (x1, y1)]| Chord {
            x0,
            y0,
            x1,
            y1,
            line: Line::through(x0, y0, x1, y1),
            winding: 0,
        }));
        self.leaves.push(Leaf {
            chords: (chords, self.chords.len() as u32),
            steps: (steps, steps),
            base: 0,
            rule: crate::scene::FillRule::NonZero,
        });
    }

    /// Splits the pixel until `wanted` asks for no more fragment. `wanted` is told what is known of a
    /// region and answers with the number of a fragment it must know, front ones first; `emit` is
    /// given each region: what is known of it, its area and its corners in fixed point. It gives up
    /// when more than `most_work` pieces have been held against regions.
    pub fn integrate(
        &mut self,
        most_work: u32,
        mut wanted: impl FnMut(Known) -> Option<usize>,
        mut emit: impl FnMut(Known, i64, &[Corner]),
    ) -> Result<(), TooComplex> {
        let mut work = 0u32;
        self.start();
        while let Some(mut region) = self.regions.pop() {
            let first = region.first_corner as usize;
            loop {
                let Some(leaf) = wanted(region.known) else {
                    emit(region.known, region.area, &self.corners[first..]);
                    self.corners.truncate(first);
                    break;
                };
                let Leaf { chords: (from, to), .. } = self.leaves[leaf];
                work += to - from;
                if work > most_work {
                    return Err(TooComplex);
                }
                let chords = &self.chords[from as usize..to as usize];
                let corners = &self.corners[first..];
                match chords.iter().find(|chord| runs_through(chord, corners)) {
                    Some(chord) => {
                        let line = chord.line;
                        self.split(region, line);
                        break;
                    }
                    None => {
                        region.known.known |= 1 << leaf;
                        region.known.inside |= u64::from(self.is_inside(leaf, first)) << leaf;
                    }
                }
            }
        }
        Ok(())
    }

    /// The whole pixel as the only region.
    fn start(&mut self) {
        let one = f64::from(ONE);
        self.regions.clear();
        self.corners.clear();
        for ((x, y), (a, b, c)) in [
            ((0.0, 0.0), (0.0, 1.0, 0.0)),
            ((one, 0.0), (-1.0, 0.0, one)),
            ((one, one), (0.0, -1.0, one)),
            ((0.0, one), (1.0, 0.0, 0.0)),
        ] {
            self.corners.push(Corner { x, y, border: Line { a, b, c } });
        }
        self.regions.push(Region { first_corner: 0, area: PIXEL_AREA, known: Known::default() });
    }

    /// Replaces the region, which is the last, by the two on either side of the line.
    fn split(&mut self, region: Region, line: Line) {
        self.nodes += 2;
        let [whole, left, right] = &mut self.split;
        whole.clear();
        whole.extend(self.corners.drain(region.first_corner as usize..));
        cut(whole, line, left, right);
        let left_area = doubled_area(left).clamp(0, region.area);
        for (corners, area) in [(left, left_area), (right, region.area - left_area)] {
            if area > 0 {
                let first_corner = self.corners.len() as u32;
                self.corners.append(corners);
                self.regions.push(Region { first_corner, area, ..region });
            }
        }
    }

    /// Is the region from corner `first` on, which no piece of the fragment runs through, inside it?
    fn is_inside(&self, leaf: usize, first: usize) -> bool {
        let corners = &self.corners[first..];
        let share = 1.0 / corners.len() as f64;
        let x = corners.iter().map(|c| c.x).sum::<f64>() * share;
        let y = corners.iter().map(|c| c.y).sum::<f64>() * share;
        let Leaf { chords, steps, base, rule } = self.leaves[leaf];
        let steps = &self.steps[steps.0 as usize..steps.1 as usize];
        let chords = &self.chords[chords.0 as usize..chords.1 as usize];
        let at_border = steps.iter().filter(|(at, _)| *at <= y).map(|(_, step)| step).sum::<i32>();
        let crossed = chords.iter().filter(|c| c.y0 <= y && y < c.y1 && c.line.distance(x, y) <= 0.0);
        rule.inside(base + at_border + crossed.map(|c| c.winding).sum::<i32>())
    }
}

/// Does a stretch of the chord lie inside the region, off its border?
fn runs_through(chord: &Chord, corners: &[Corner]) -> bool {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for Corner { border, .. } in corners {
        let d0 = border.distance(chord.x0, chord.y0) - ON_BORDER;
        let d1 = border.distance(chord.x1, chord.y1) - ON_BORDER;
        if d0 <= 0.0 && d1 <= 0.0 {
            return false;
        }
        if d0 < 0.0 {
            from = from.max(d0 / (d0 - d1));
        } else if d1 < 0.0 {
            to = to.min(d0 / (d0 - d1));
        }
        if from >= to {
            return false;
        }
    }
    true
}

/// Cuts a convex region along a line: `left` has positive distance.
fn cut(whole: &[Corner], line: Line, left: &mut Vec<Corner>, right: &mut Vec<Corner>) {
    left.clear();
    right.clear();
    let distance = |corner: &Corner| {
        let d = line.distance(corner.x, corner.y);
        // A corner on the line belongs to both sides.
        if d.abs() < ON_BORDER * 0.5 {
            0.0
        } else {
            d
        }
    };
    let mut d = distance(&whole[0]);
    for (i, corner) in whole.iter().enumerate() {
        let next = &whole[(i + 1) % whole.len()];
        let next_d = distance(next);
        // Where the border leaves a side, that side goes on along the line.
        if d >= 0.0 {
            let border = if d == 0.0 && next_d < 0.0 { line } else { corner.border };
            left.push(Corner { border, ..*corner });
        }
        if d <= 0.0 {
            let border = if d == 0.0 && next_d > 0.0 { line.reversed() } else { corner.border };
            right.push(Corner { border, ..*corner });
        }
        if d * next_d < 0.0 {
            let t = d / (d - next_d);
            let (x, y) = (corner.x + (next.x - corner.x) * t, corner.y + (next.y - corner.y) * t);
            let (leaving, entering, along) = if d > 0.0 {
                (&mut *left, &mut *right, line)
            } else {
                (&mut *right, &mut *left, line.reversed())
            };
            leaving.push(Corner { x, y, border: along });
            entering.push(Corner { x, y, border: corner.border });
        }
        d = next_d;
    }
}

/// Twice the area, which is the area in the units of [`PIXEL_AREA`], rounded.
fn doubled_area(corners: &[Corner]) -> i64 {
    let Some(origin) = corners.first() else {
        return 0;
    };
    let triangle = |pair: &[Corner]| {
        (pair[0].x - origin.x) * (pair[1].y - origin.y) - (pair[1].x - origin.x) * (pair[0].y - origin.y)
    };
    corners.windows(2).map(triangle).sum::<f64>().abs().round_ties_even() as i64
}

/// The centre of gravity, in fixed point; `None` of a region without area.
pub(crate) fn centroid(corners: &[Corner]) -> Option<(f64, f64)> {
    let origin = corners.first()?;
    let (mut x, mut y, mut area) = (0.0, 0.0, 0.0);
    for pair in corners.windows(2) {
        let (ax, ay) = (pair[0].x - origin.x, pair[0].y - origin.y);
        let (bx, by) = (pair[1].x - origin.x, pair[1].y - origin.y);
        let doubled = ax * by - bx * ay;
        (x, y, area) = (x + (ax + bx) * doubled, y + (ay + by) * doubled, area + doubled);
    }
    (area.abs() > 1e-6).then(|| (origin.x + x / (3.0 * area), origin.y + y / (3.0 * area)))
}
