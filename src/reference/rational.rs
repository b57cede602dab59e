//! Takes polygons with small integer coordinates, makes the exact area of each that is seen in every
//! pixel: a second truth, in fractions, to hold the first one against.
//!
//! Every decision (which edges cross, in which order they stand, which polygon is in front) and
//! every trapezoid's area is exact in 128-bit fractions; each area is then rounded once to `f64` and
//! the areas are summed. It is as plain as can be, and slow: all edges of a row, in every pixel.

use crate::Error;
use std::cmp::Ordering;
use usvg::FillRule;

/// Coordinates lie in -LARGEST..=LARGEST units: all products then fit 128 bits.
pub const LARGEST: i64 = 1 << 10;

/// An opaque polygon, closed, perhaps crossing itself.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Its corners, x to the right and y downward, in units of which [`visible_areas`] is told how
    /// many make a pixel.
    pub points: Vec<(i64, i64)>,
    /// Which winding numbers are inside.
    pub rule: FillRule,
}

/// For each pixel, row by row from the top: the area (0..=1) of each polygon that is seen in it, and
/// last that of none. The first polygon lies at the back.
///
/// # Errors
/// [`Error::Limit`] when a coordinate is above [`LARGEST`], or the picture is.
pub fn visible_areas(
    polygons: &[Polygon],
    units_per_pixel: i64,
    width: u32,
    height: u32,
) -> Result<Vec<Vec<f64>>, Error> {
    let limits = -LARGEST..=LARGEST;
    let corners =
        polygons.iter().flat_map(|p| &p.points).all(|(x, y)| limits.contains(x) && limits.contains(y));
    let size = i64::from(width.max(height)).saturating_mul(units_per_pixel);
    if !corners || !(1..=LARGEST).contains(&size) {
        return Err(Error::Limit(format!("exact fractions need coordinates of at most {LARGEST} units")));
    }
    let edges: Vec<Edge> = polygons.iter().enumerate().flat_map(|(number, p)| edges(number, p)).collect();
    let rules: Vec<FillRule> = polygons.iter().map(|p| p.rule).collect();
    let pixels = (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).map(move |x| (x, y)));
    Ok(pixels
        .map(|(x, y)| pixel(&edges, &rules, x * units_per_pixel, y * units_per_pixel, units_per_pixel))
        .collect())
}

/// A fraction; the denominator is above 0.
#[derive(Clone, Copy, Debug)]
struct Fraction {
    over: i128,
    under: i128,
}

impl Fraction {
    fn new(over: i128, under: i128) -> Fraction {
        assert!(under != 0, "a fraction of nothing");
        let divisor = common_divisor(over.unsigned_abs(), under.unsigned_abs()) as i128;
        let sign = under.signum();
        Fraction { over: over / divisor * sign, under: under / divisor * sign }
    }

    fn whole(value: i64) -> Fraction {
        Fraction { over: i128::from(value), under: 1 }
    }

    fn minus(self, other: Fraction) -> Fraction {
        self.plus(Fraction { over: -other.over, under: other.under })
    }

    fn plus(self, other: Fraction) -> Fraction {
        let left = product(self.over, other.under);
        let right = product(other.over, self.under);
        Fraction::new(left.checked_add(right).expect("fits"), product(self.under, other.under))
    }

    fn times(self, other: Fraction) -> Fraction {
        Fraction::new(product(self.over, other.over), product(self.under, other.under))
    }

    fn to_f64(self) -> f64 {
        self.over as f64 / self.under as f64
    }
}

/// # Panics
/// When the product needs more than 128 bits; [`LARGEST`] forbids that.
fn product(a: i128, b: i128) -> i128 {
    a.checked_mul(b).expect("coordinates up to LARGEST give products of 128 bits")
}

fn common_divisor(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Fraction) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Fraction {}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Fraction) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Fraction) -> Ordering {
        product(self.over, other.under).cmp(&product(other.over, self.under))
    }
}

/// An edge from its upper end to its lower one.
#[derive(Clone, Copy)]
struct Edge {
    top: (i64, i64),
    bottom: (i64, i64),
    winding: i32,
    polygon: usize,
}

/// A polygon's edges but for the horizontal ones.
fn edges(number: usize, polygon: &Polygon) -> Vec<Edge> {
    let points = &polygon.points;
    (0..points.len())
        .filter_map(|i| {
            let (from, to) = (points[i], points[(i + 1) % points.len()]);
            match from.1.cmp(&to.1) {
                Ordering::Less => Some(Edge { top: from, bottom: to, winding: 1, polygon: number }),
                Ordering::Greater => Some(Edge { top: to, bottom: from, winding: -1, polygon: number }),
                Ordering::Equal => None,
            }
        })
        .collect()
}

impl Edge {
    fn width(&self) -> i128 {
        i128::from(self.bottom.0 - self.top.0)
    }

    fn height(&self) -> i128 {
        i128::from(self.bottom.1 - self.top.1)
    }

    fn x_at(&self, y: Fraction) -> Fraction {
        let slope = Fraction::new(self.width(), self.height());
        Fraction::whole(self.top.0).plus(slope.times(y.minus(Fraction::whole(self.top.1))))
    }

    /// Where the edge's line meets the vertical line at `x`.
    fn y_at(&self, x: i64) -> Option<Fraction> {
        (self.width() != 0).then(|| {
            let down = Fraction::new(i128::from(x - self.top.0) * self.height(), self.width());
            Fraction::whole(self.top.1).plus(down)
        })
    }

    /// Where the lines of two edges cross: x = top.x + width / height (y - top.y) for both.
    fn crossing(&self, other: &Edge) -> Option<Fraction> {
        let turn = self.width() * other.height() - other.width() * self.height();
        let start = |e: &Edge| i128::from(e.top.0) * e.height() - e.width() * i128::from(e.top.1);
        (turn != 0).then(|| Fraction::new(start(other) * self.height() - start(self) * other.height(), turn))
    }
}

/// The areas in the pixel whose top left corner is (x, y).
fn pixel(edges: &[Edge], rules: &[FillRule], x: i64, y: i64, size: i64) -> Vec<f64> {
    let (top, bottom) = (Fraction::whole(y), Fraction::whole(y + size));
    let edges: Vec<Edge> = edges.iter().copied().filter(|e| e.top.1 < y + size && e.bottom.1 > y).collect();
    let mut cuts = vec![top, bottom];
    for (i, edge) in edges.iter().enumerate() {
        cuts.extend([Fraction::whole(edge.top.1), Fraction::whole(edge.bottom.1)]);
        cuts.extend(edge.y_at(x));
        cuts.extend(edge.y_at(x + size));
        cuts.extend(edges[i + 1..].iter().filter_map(|other| edge.crossing(other)));
    }
    cuts.retain(|cut| (top..=bottom).contains(cut));
    cuts.sort();
    cuts.dedup();
    let mut areas = vec![0.0; rules.len() + 1];
    for slab in cuts.windows(2) {
        add_slab(&edges, rules, (x, x + size), (slab[0], slab[1]), &mut areas);
    }
    let pixel = (size * size) as f64;
    areas.iter_mut().for_each(|area| *area /= pixel);
    areas
}

/// One slab: no two edges cross in it, and none crosses the pixel's left or right border.
fn add_slab(
    edges: &[Edge],
    rules: &[FillRule],
    columns: (i64, i64),
    slab: (Fraction, Fraction),
    areas: &mut [f64],
) {
    let middle = slab.0.plus(slab.1).times(Fraction::new(1, 2));
    let height = slab.1.minus(slab.0);
    let (left, right) = (Fraction::whole(columns.0), Fraction::whole(columns.1));
    let mut order: Vec<(Fraction, Edge)> = edges
        .iter()
        .filter(|e| Fraction::whole(e.top.1) < middle && middle < Fraction::whole(e.bottom.1))
        .map(|e| (e.x_at(middle), *e))
        .collect();
    order.sort_by_key(|edge| edge.0);
    let mut windings = vec![0; rules.len()];
    let mut x = left;
    let ends = order.iter().map(|&(x, edge)| (x, Some(edge))).chain([(right, None)]);
    for (end, edge) in ends {
        let end = end.clamp(left, right);
        if x < end {
            let inside = |&number: &usize| match rules[number] {
                FillRule::NonZero => windings[number] != 0,
                FillRule::EvenOdd => windings[number] % 2 != 0,
            };
            let front = (0..rules.len()).rev().find(inside).unwrap_or(rules.len());
            areas[front] += end.minus(x).times(height).to_f64();
            x = end;
        }
        if let Some(edge) = edge {
            windings[edge.polygon] += edge.winding;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(i64, i64)]) -> Polygon {
        Polygon { points: points.to_vec(), rule: FillRule::NonZero }
    }

    #[test]
    fn a_triangle_in_front_takes_its_half_from_the_square_behind() {
        let square = polygon(&[(0, 0), (16, 0), (16, 16), (0, 16)]);
        let triangle = polygon(&[(0, 0), (16, 0), (0, 16)]);
        let areas = visible_areas(&[square, triangle], 16, 1, 1).unwrap();
        assert_eq!(areas, [vec![0.5, 0.5, 0.0]]);
    }

    #[test]
    fn a_bow_tie_is_two_triangles() {
        let bow = polygon(&[(0, 0), (3, 0), (0, 3), (3, 3)]);
        let areas = visible_areas(&[bow], 3, 1, 1).unwrap();
        assert_eq!(areas, [vec![0.5, 0.5]]);
    }

    #[test]
    fn the_largest_coordinates_fit_and_larger_ones_are_refused() {
        let l = LARGEST;
        let star = polygon(&[(-l, -l + 1), (l, l), (l - 1, -l), (1 - l, l - 1), (l, 3), (-l, 7)]);
        for areas in visible_areas(std::slice::from_ref(&star), l / 4, 4, 4).unwrap() {
            assert!((areas.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert!(visible_areas(&[polygon(&[(0, 0), (l + 1, 0), (0, 1)])], 1, 1, 1).is_err());
    }
}
