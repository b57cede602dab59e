//! Takes polygon edges, makes an estimate of how often they cross, before anyone looks for the places:
//! crossings, not edges, are what a cut costs where edges lie criss-cross.
//!
//! Edges are sorted into the cells of a grid; in each cell some pairs are tried, and the others taken to
//! be like them. Promises: time in proportion to the edges and the grid, whatever they do.

use super::region::{Contour, Corner};

/// Cells along one side of the grid.
const SIDE: i64 = 32;
/// Pairs that are tried in a cell.
const TRIED: usize = 48;
/// So few pairs are not worth an estimate: this many crossings are done in a second or two.
const FEW_PAIRS: usize = 1 << 20;

/// An edge of a polygon.
type Edge = (Corner, Corner);

/// About how often edges of the one cross edges of the other; less than [`FEW_PAIRS`] is 0. Given the same
/// polygons twice, it counts each crossing twice.
pub(super) fn estimate<'a>(
    one: impl Iterator<Item = &'a Contour>,
    other: impl Iterator<Item = &'a Contour>,
) -> usize {
    let (one, other): (Vec<Edge>, Vec<Edge>) =
        (one.flat_map(edges).collect(), other.flat_map(edges).collect());
    if one.len().saturating_mul(other.len()) < FEW_PAIRS {
        return 0;
    }
    let Some(grid) = Grid::around(&one) else {
        return 0;
    };
    let (one_cells, other_cells) = (grid.sort(&one), grid.sort(&other));
    let mut total = 0;
    for cell in 0..(SIDE * SIDE) as usize {
        let (a, b) = (&one_cells[cell], &other_cells[cell]);
        if a.is_empty() || b.is_empty() {
            continue;
        }
        let pairs = a.len().saturating_mul(b.len());
        let tried = pairs.min(TRIED);
        // Steps that have no divisor in common with most counts of pairs.
        let pair = |i: usize| if tried == pairs { i } else { i.wrapping_mul(0x9e37_79b1) % pairs };
        let crosses = |i: &usize| {
            let at = pair(*i);
            grid.cross_in(cell, one[a[at / b.len()] as usize], other[b[at % b.len()] as usize])
        };
        let found = (0..tried).filter(crosses).count();
        total += pairs / tried * found;
    }
    total
}

fn edges(contour: &Contour) -> impl Iterator<Item = Edge> + '_ {
    let before = contour.iter().cycle().skip(contour.len().saturating_sub(1));
    before.copied().zip(contour.iter().copied())
}

/// Square cells over a rectangle.
struct Grid {
    left: i64,
    top: i64,
    cell: i64,
}

impl Grid {
    /// Around some edges; `None` when there are none.
    fn around(edges: &[Edge]) -> Option<Grid> {
        let xs = || edges.iter().map(|(a, _)| i64::from(a.x));
        let ys = || edges.iter().map(|(a, _)| i64::from(a.y));
        let (left, top) = (xs().min()?, ys().min()?);
        let span = (xs().max()? - left).max(ys().max()? - top);
        Some(Grid { left, top, cell: span / SIDE + 1 })
    }

    /// The numbers of the edges in each cell, row by row.
    fn sort(&self, edges: &[Edge]) -> Vec<Vec<u32>> {
        let mut cells = vec![Vec::new(); (SIDE * SIDE) as usize];
        for (number, (a, b)) in edges.iter().enumerate() {
            let (upper, lower) = if a.y <= b.y { (a, b) } else { (b, a) };
            let (y0, y1) = (i64::from(upper.y) - self.top, i64::from(lower.y) - self.top);
            let (x0, x1) = (i64::from(upper.x) - self.left, i64::from(lower.x) - self.left);
            let x_at = |y: i64| match y {
                y if y <= y0 => x0,
                y if y >= y1 => x1,
                y => x0 + ((x1 - x0) as f64 * ((y - y0) as f64 / (y1 - y0) as f64)) as i64,
            };
            let rows = (y0 / self.cell).max(0)..=(y1 / self.cell).min(SIDE - 1);
            for row in rows {
                let (from, to) = (x_at(row * self.cell), x_at((row + 1) * self.cell));
                let columns = (from.min(to) / self.cell).max(0)..=(from.max(to) / self.cell).min(SIDE - 1);
                for column in columns {
                    cells[(row * SIDE + column) as usize].push(number as u32);
                }
            }
        }
        cells
    }

    /// Do two edges cross at a place in this cell, which is an end of neither?
    fn cross_in(&self, cell: usize, (a, b): Edge, (c, d): Edge) -> bool {
        let point = |p: Corner| ((i64::from(p.x) - self.left) as f64, (i64::from(p.y) - self.top) as f64);
        let ((ax, ay), (bx, by), (cx, cy), (dx, dy)) = (point(a), point(b), point(c), point(d));
        let (ux, uy, vx, vy) = (bx - ax, by - ay, dx - cx, dy - cy);
        let sine = ux * vy - uy * vx;
        let (s, t) = (((cx - ax) * vy - (cy - ay) * vx) / sine, ((cx - ax) * uy - (cy - ay) * ux) / sine);
        let inside = |v: f64| v > 0.0 && v < 1.0;
        let side = self.cell as f64;
        let (column, row) = (((ax + s * ux) / side).floor(), ((ay + s * uy) / side).floor());
        inside(s) && inside(t) && row * SIDE as f64 + column == cell as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_of_lines_crosses_as_often_as_it_has_nodes() {
        let n = 1500;
        let lines = |is_upright: bool| -> Vec<Contour> {
            let line = |i: i32| {
                let at = |u: i32, v: i32| if is_upright { Corner::new(v, u) } else { Corner::new(u, v) };
                vec![at(0, 1000 * i + 500), at(1000 * n, 1000 * i + 503)]
            };
            (0..n).map(line).collect()
        };
        let (one, other) = (lines(true), lines(false));
        let found = estimate(one.iter(), other.iter()) as f64;
        // Each contour is a line there and back.
        let nodes = 4.0 * f64::from(n) * f64::from(n);
        assert!((0.5..2.0).contains(&(found / nodes)), "{found} of {nodes}");
    }

    #[test]
    fn edges_that_lie_side_by_side_do_not_cross() {
        let line = |i: i32| vec![Corner::new(0, 1000 * i), Corner::new(2_000_000, 1000 * i + 700)];
        let lines: Vec<Contour> = (0..2000).map(line).collect();
        assert_eq!(estimate(lines.iter(), lines.iter()), 0);
    }
}
