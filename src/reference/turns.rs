//! Takes curves at which a colour turns or jumps and a trapezoid, makes the colour's integral over it.
//!
//! Along a row the places where it meets the curves are known, and Gauss's rule is nearly exact between
//! them. So are the heights at which the curves meet the trapezoid's sides, or are highest and lowest.
//! Where curves cross in between, the intervals are halved until two rules agree.

use super::Colour;
use kurbo::{Affine, Point, Vec2};

/// A part of a pixel between two edges, in pixel units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trapezoid {
    pub(super) top: f64,
    pub(super) bottom: f64,
    /// x at the top and at the bottom.
    pub(super) left: [f64; 2],
    pub(super) right: [f64; 2],
}

/// A whole pixel.
pub(super) const PIXEL: Trapezoid = Trapezoid { top: 0.0, bottom: 1.0, left: [0.0; 2], right: [1.0; 2] };

impl Trapezoid {
    pub(super) fn moved(self, by: Vec2) -> Trapezoid {
        Trapezoid {
            top: self.top + by.y,
            bottom: self.bottom + by.y,
            left: self.left.map(|x| x + by.x),
            right: self.right.map(|x| x + by.x),
        }
    }

    /// Where a row begins and ends.
    fn row(&self, y: f64) -> (f64, f64) {
        let part = (y - self.top) / (self.bottom - self.top);
        let x = |side: [f64; 2]| side[0] + (side[1] - side[0]) * part;
        (x(self.left), x(self.right))
    }
}

/// A curve at which a colour turns or jumps.
pub(super) struct Turn {
    /// From pixels to the curve's own space, and back.
    pub(super) from_pixels: Affine,
    pub(super) to_pixels: Affine,
    pub(super) curve: Curve,
}

#[derive(Clone, Copy)]
pub(super) enum Curve {
    /// `normal` is of any length but 0.
    Line {
        through: Point,
        normal: Vec2,
    },
    Circle {
        centre: Point,
        radius: f64,
    },
}

impl Turn {
    /// Each s at which `from` + s `along` (pixels) meets the curve.
    pub(super) fn crossings(&self, from: Point, along: Vec2) -> impl Iterator<Item = f64> {
        let at = self.from_pixels * from;
        let along = self.from_pixels * (from + along) - at;
        let found = match self.curve {
            Curve::Line { through, normal } => [(through - at).dot(normal) / along.dot(normal), f64::NAN],
            Curve::Circle { centre, radius } => {
                let (out, squared) = (at - centre, along.hypot2());
                let middle = -out.dot(along) / squared;
                let nearest = (out + along * middle).hypot2();
                let half = ((radius * radius - nearest) / squared).sqrt();
                [middle - half, middle + half]
            }
        };
        found.into_iter().filter(|s| s.is_finite())
    }

    /// A closed curve's highest and lowest y, in pixels.
    fn extremes(&self) -> impl Iterator<Item = f64> {
        let found = match self.curve {
            Curve::Line { .. } => None,
            Curve::Circle { centre, radius } => {
                let [_, b, _, d, ..] = self.to_pixels.as_coeffs();
                let (y, reach) = ((self.to_pixels * centre).y, radius * b.hypot(d));
                Some([y - reach, y + reach])
            }
        };
        found.into_iter().flatten()
    }
}

/// Intervals of an integral over a pixel are halved until two rules agree within this, in parts of full
/// colour: .025 levels. The better one is far nearer.
const TOLERANCE: f64 = 1e-4;
/// Intervals are halved this often at most.
const MOST_HALVINGS: u32 = 8;

/// The integral of `colour`, a function of the place in pixels that is smooth between `turns`.
pub(super) fn integral(area: &Trapezoid, turns: &[Turn], mut colour: impl FnMut(Point) -> Colour) -> Colour {
    let height = area.bottom - area.top;
    let sides = [area.left, area.right]
        .map(|[top, bottom]| (Point::new(top, area.top), Vec2::new(bottom - top, height)));
    let heights = turns.iter().flat_map(|turn| {
        let met = move |(from, along): (Point, Vec2)| turn.crossings(from, along);
        sides.into_iter().flat_map(met).map(|part| area.top + part * height).chain(turn.extremes())
    });
    pieces((area.top, area.bottom), heights, TOLERANCE, &mut |y| {
        let (left, right) = area.row(y);
        let from = Point::new(left, y);
        let met = turns.iter().flat_map(|turn| turn.crossings(from, Vec2::new(1.0, 0.0)));
        pieces((left, right), met.map(|x| left + x), 0.1 * TOLERANCE, &mut |x| colour(Point::new(x, y)))
    })
}

/// The same, nearly: by points on a lattice, on which no line has many.
pub(super) fn sampled(area: &Trapezoid, mut colour: impl FnMut(Point) -> Colour) -> Colour {
    const POINTS: u32 = 4096;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let height = area.bottom - area.top;
    if height <= 0.0 {
        // As thin as the last digit.
        return [0.0; 4];
    }
    (0..POINTS).fold([0.0; 4], |sum, i| {
        let y = area.top + height * (f64::from(i) + 0.5) / f64::from(POINTS);
        let (left, right) = area.row(y);
        let at = Point::new(left + (right - left) * (f64::from(i) * GOLDEN).fract(), y);
        plus(sum, times(colour(at), (right - left) * height / f64::from(POINTS)))
    })
}

/// The integral from one place to another of a function that is smooth between `breaks`.
fn pieces(
    (from, to): (f64, f64),
    breaks: impl Iterator<Item = f64>,
    tolerance: f64,
    f: &mut impl FnMut(f64) -> Colour,
) -> Colour {
    let mut ends: Vec<f64> = breaks.filter(|&at| from < at && at < to).chain([from, to]).collect();
    ends.sort_unstable_by(f64::total_cmp);
    ends.windows(2)
        .filter(|pair| pair[0] < pair[1])
        .fold([0.0; 4], |sum, pair| plus(sum, halved((pair[0], pair[1]), tolerance, MOST_HALVINGS, f)))
}

/// By Gauss's rule for three points; in halves as long as that for two points says otherwise.
fn halved(
    (from, to): (f64, f64),
    tolerance: f64,
    halvings: u32,
    f: &mut impl FnMut(f64) -> Colour,
) -> Colour {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut pair = |part: f64| plus(f(middle - half * part), f(middle + half * part));
    let two = times(pair((1.0f64 / 3.0).sqrt()), half);
    let outer = times(pair(0.6f64.sqrt()), half * 5.0 / 9.0);
    let three = plus(outer, times(f(middle), half * 8.0 / 9.0));
    let off = two.iter().zip(three).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if off <= tolerance || halvings == 0 {
        return three;
    }
    plus(
        halved((from, middle), 0.5 * tolerance, halvings - 1, f),
        halved((middle, to), 0.5 * tolerance, halvings - 1, f),
    )
}

fn plus(a: Colour, b: Colour) -> Colour {
    std::array::from_fn(|c| a[c] + b[c])
}

fn times(a: Colour, by: f64) -> Colour {
    a.map(|v| v * by)
}
