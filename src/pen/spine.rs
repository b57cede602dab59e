//! Takes a sub-path's segments, makes its spine: the stations where the pen stops, each with the
//! direction in which the path goes there.
//!
//! Curves are cut in halves until a part turns little and at an even pace, then into steps of nearly equal
//! t, as many as the outer side of the outline needs. Where the inner end of the pen begins to go backwards,
//! and where it ceases to, the pen stops, too. Where a curve turns on the spot (a cusp) it turns with it.

use super::nib::Nib;
use super::quarter;
use crate::chords::{chord_end, Curve};
use kurbo::{Point, Vec2};

/// Halvings of a curve: enough to get as near to a cusp as double precision can tell.
const MOST_HALVINGS: u32 = 24;

/// A curve that turns within this share of the tolerance turns on the spot.
const ON_THE_SPOT: f64 = 0.1;

/// Cosine of the angle at which a curve has a cusp between two of its parts.
const STRAIGHT_ON: f64 = 0.999;

/// The least speed along a part that goes at an even pace, as a share of the largest.
const LEAST_EVEN: f64 = 1.0 / 3.0;

/// Stops within one part of a curve.
const MOST_STEPS: f64 = 16384.0;

/// Where the pen stops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub at: Point,
    /// Unit vector.
    pub along: Vec2,
}

impl Station {
    fn on(curve: &Curve, t: f64) -> Station {
        let velocity = curve.derivative(t);
        Station { at: curve.point(t), along: velocity / velocity.hypot() }
    }
}

/// A sub-path as the pen walks it, segment by segment. Segments that go nowhere are left out.
#[derive(Default)]
pub(super) struct Spine {
    pub start: Point,
    /// Was there any segment, even one that goes nowhere?
    pub drawn: bool,
    stations: Vec<Station>,
    pub segments: Vec<Segment>,
}

/// One segment: its stations, two or more.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    first: usize,
    end: usize,
    is_line: bool,
}

impl Spine {
    pub fn clear(&mut self, start: Point) {
        self.start = start;
        self.drawn = false;
        self.stations.clear();
        self.segments.clear();
    }

    pub fn stations(&self, segment: usize) -> &[Station] {
        let Segment { first, end, .. } = self.segments[segment];
        &self.stations[first..end]
    }

    pub fn begin(&self, segment: usize) -> Station {
        self.stations[self.segments[segment].first]
    }

    pub fn end(&self, segment: usize) -> Station {
        self.stations[self.segments[segment].end - 1]
    }

    pub fn is_line(&self, segment: usize) -> bool {
        self.segments[segment].is_line
    }

    /// The length of a segment, if it is a line.
    pub fn line_length(&self, segment: usize) -> Option<f64> {
        let length = || (self.end(segment).at - self.begin(segment).at).hypot();
        self.is_line(segment).then(length)
    }

    pub fn line(&mut self, from: Point, to: Point) {
        let Some(along) = direction(&[from, to]) else {
            return;
        };
        let first = self.stations.len();
        self.stations.extend([Station { at: from, along }, Station { at: to, along }]);
        self.segments.push(Segment { first, end: first + 2, is_line: true });
    }

    /// A cubic; one that is not `seen` needs nothing between its ends.
    pub fn cubic(&mut self, hull: [Point; 4], seen: bool, nib: Nib) {
        let hull = without_noise(hull);
        let mut reverse = hull;
        reverse.reverse();
        let Some(begins) = direction(&hull) else {
            return;
        };
        let first = self.stations.len();
        if !seen {
            let ends = direction(&reverse).map_or(begins, |back| -back);
            let [from, .., to] = hull;
            self.stations.extend([Station { at: from, along: begins }, Station { at: to, along: ends }]);
        } else {
            // Always walked from the same end, so that both directions have the same stations.
            let key = |hull: [Point; 4]| hull.map(|p| (p.y, p.x));
            let reversed = key(hull) > key(reverse);
            let hull = if reversed { reverse } else { hull };
            self.stations.extend(direction(&hull).map(|along| Station { at: hull[0], along }));
            self.part(hull, nib, 0);
            if reversed {
                let stations = &mut self.stations[first..];
                stations.reverse();
                stations.iter_mut().for_each(|station| station.along = -station.along);
            }
        }
        self.segments.push(Segment { first, end: self.stations.len(), is_line: false });
    }

    /// Adds the stations behind the first of a part of a curve.
    fn part(&mut self, hull: [Point; 4], nib: Nib, halvings: u32) {
        let legs = Legs::of(hull);
        let (Some(begins), Some(ends)) = (legs.first_direction(), legs.last_direction()) else {
            return;
        };
        if self.stations.last().is_some_and(|before| before.along.dot(begins) < STRAIGHT_ON) {
            self.turn_on_the_spot(hull[0], begins, nib);
        }
        let [.., last] = hull;
        let (length, turn) = (legs.length, legs.turn);
        let turns_back = nib.radius * turn > LEAST_EVEN * length;
        if nib.stops(length, turn) <= 1.0 && !turns_back || !length.is_finite() {
            self.stations.push(Station { at: last, along: ends });
        } else if legs.are_even() {
            self.steps(hull, nib);
            self.stations.push(Station { at: last, along: ends });
        } else if halvings == MOST_HALVINGS || length * nib.scale < ON_THE_SPOT * nib.tolerance {
            self.turn_on_the_spot(last, ends, nib);
        } else {
            let (one, other) = halves(hull);
            self.part(one, nib, halvings + 1);
            self.part(other, nib, halvings + 1);
        }
    }

    /// Stations within a part that turns at an even pace, at steps of t, and wherever one end of the pen turns back:
    /// what it reaches there no other place of the pen does.
    fn steps(&mut self, [p0, p1, p2, p3]: [Point; 4], nib: Nib) {
        let curve = Curve::cubic(p0, p1, p2, p3);
        let mut from = 0.0;
        // On either side of an inflection one side of the pen goes back, if any.
        for to in curve.inflection().into_iter().chain([1.0]) {
            let span = to - from;
            let (mut fastest, mut most_turn) = (0.0f64, 0.0f64);
            for t in [from, from + 0.5 * span, to] {
                let (velocity, bend) = (curve.derivative(t), curve.second_derivative(t));
                let speed = velocity.hypot2();
                fastest = fastest.max(speed);
                most_turn = most_turn.max(velocity.cross(bend).abs() / speed);
            }
            let fastest = fastest.sqrt();
            let may_turn_back = nib.radius * most_turn > LEAST_EVEN * fastest;
            let steps = nib.stops(span * fastest, span * most_turn).min(MOST_STEPS);
            let mut before = from;
            for t in (1..steps as usize).map(|i| from + span * chord_end(i, steps)).chain([to]) {
                if may_turn_back {
                    let turn = turning_back(&curve, nib.radius, (before, t));
                    self.stations.extend(turn.map(|t| Station::on(&curve, t)));
                }
                if t < 1.0 {
                    self.stations.push(Station::on(&curve, t));
                }
                before = t;
            }
            from = to;
        }
    }

    /// From the last station's direction to `ends`, the shorter way round.
    fn turn_on_the_spot(&mut self, at: Point, ends: Vec2, nib: Nib) {
        let Some(&Station { along: begins, .. }) = self.stations.last() else {
            return;
        };
        let turn = libm::atan2(begins.cross(ends), begins.dot(ends));
        let stops = nib.arc_stops(turn.abs()).min(MOST_STEPS);
        for i in 1..stops as usize {
            let (sine, cosine) = libm::sincos(turn * chord_end(i, stops));
            self.stations.push(Station { at, along: cosine * begins + sine * quarter(begins) });
        }
        self.stations.push(Station { at, along: ends });
    }
}

/// Where between two places on a curve the inner end of the pen begins or ceases to go backwards, if it does in one of
/// them only.
fn turning_back(curve: &Curve, radius: f64, (mut from, mut to): (f64, f64)) -> Option<f64> {
    /// They find the place to a billionth of the way.
    const HALVINGS: u32 = 30;
    let goes_back = |t: f64| {
        let (velocity, bend) = (curve.derivative(t), curve.second_derivative(t));
        radius * velocity.cross(bend).abs() > velocity.hypot2() * velocity.hypot()
    };
    let at_first = goes_back(from);
    if goes_back(to) == at_first {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        *if goes_back(middle) == at_first { &mut from } else { &mut to } = middle;
    }
    Some(to)
}

/// The legs of a control polygon.
struct Legs {
    legs: [Vec2; 3],
    lengths: [f64; 3],
    length: f64,
    /// No less than the angle by which the curve turns, as long as that is small.
    turn: f64,
}

impl Legs {
    fn of([p0, p1, p2, p3]: [Point; 4]) -> Legs {
        let legs = [p1 - p0, p2 - p1, p3 - p2];
        let lengths = legs.map(Vec2::hypot);
        let mut turn = 0.0;
        let mut before: Option<Vec2> = None;
        for (&leg, &length) in legs.iter().zip(&lengths) {
            if length > 0.0 {
                turn += before.map_or(0.0, |before| angle(before, leg));
                before = Some(leg);
            }
        }
        Legs { legs, lengths, length: lengths.iter().sum(), turn }
    }

    fn first_direction(&self) -> Option<Vec2> {
        let first = self.legs.iter().zip(&self.lengths).find(|(_, &length)| length > 0.0);
        first.map(|(&leg, &length)| leg / length)
    }

    fn last_direction(&self) -> Option<Vec2> {
        let last = self.legs.iter().zip(&self.lengths).rev().find(|(_, &length)| length > 0.0);
        last.map(|(&leg, &length)| leg / length)
    }

    /// Does the curve turn by less than a right angle in all, with a speed that varies little?
    fn are_even(&self) -> bool {
        let [a, b, c] = self.legs;
        let [la, lb, lc] = self.lengths;
        let (least, most) = (la.min(lb).min(lc), la.max(lb).max(lc));
        least > LEAST_EVEN * most && a.dot(b) > 0.7 * la * lb && b.dot(c) > 0.7 * lb * lc
    }
}

/// A control point that lies this near to an end, as a share of the hull's size, has no direction from there: it would
/// be of rounding, as in a part of a curve that is cut off where it stands still.
const SAME_POINT: f64 = 1e-9;

/// The hull with such control points put where the ends are.
fn without_noise([p0, p1, p2, p3]: [Point; 4]) -> [Point; 4] {
    let size = [p1, p2, p3].iter().fold(0.0, |size: f64, p| size.max((*p - p0).hypot2()));
    let is_near = |a: Point, b: Point| (a - b).hypot2() <= SAME_POINT * SAME_POINT * size;
    let placed = |p: Point, ends: [Point; 2]| ends.into_iter().find(|&end| is_near(p, end)).unwrap_or(p);
    [p0, placed(p1, [p0, p3]), placed(p2, [p3, p0]), p3]
}

/// No less than the angle between two vectors.
#[inline]
fn angle(a: Vec2, b: Vec2) -> f64 {
    let (sine, cosine) = (a.cross(b).abs(), a.dot(b));
    if cosine > sine {
        sine / cosine
    } else {
        std::f64::consts::PI
    }
}

/// The direction in which a control polygon starts; `None` of one that goes nowhere, or not to numbers.
fn direction(hull: &[Point]) -> Option<Vec2> {
    let first = hull[0];
    let leg = *hull.iter().find(|&&p| p != first)? - first;
    let along = leg / leg.hypot();
    along.is_finite().then_some(along)
}

/// De Casteljau's halves.
fn halves([p0, p1, p2, p3]: [Point; 4]) -> ([Point; 4], [Point; 4]) {
    let (p01, p12, p23) = (p0.midpoint(p1), p1.midpoint(p2), p2.midpoint(p3));
    let (p012, p123) = (p01.midpoint(p12), p12.midpoint(p23));
    let middle = p012.midpoint(p123);
    ([p0, p01, p012, middle], [middle, p123, p23, p3])
}
