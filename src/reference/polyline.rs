//! Takes paths, makes polylines which remember where they were smooth, and their dashes.

use kurbo::{
    BezPath, CubicBez, Line, ParamCurve, ParamCurveDeriv, ParamCurveExtrema, ParamCurveNearest, PathEl,
    Point, QuadBez, Vec2,
};

/// A flattened sub-path in user space.
#[derive(Clone, Debug, Default)]
pub(super) struct Polyline {
    /// No two neighbours are equal; a closed line does not repeat its first point.
    pub(super) points: Vec<Point>,
    /// For each point, whether the line turns there only because a curve was flattened.
    pub(super) smooth: Vec<bool>,
    /// For each segment, the directions (of length 1) in which the true path leaves its first point
    /// and arrives at its last. They are the chord's own but along curves and at the ends of dashes.
    pub(super) headings: Vec<(Vec2, Vec2)>,
    pub(super) closed: bool,
    /// The direction of a line of one point, for its caps.
    pub(super) direction: Vec2,
}

impl Polyline {
    /// Adds a point; whether there is a new segment.
    fn push(&mut self, point: Point, smooth: bool) -> bool {
        let Some(&last) = self.points.last() else {
            self.points.push(point);
            self.smooth.push(smooth);
            return false;
        };
        if last == point {
            return false;
        }
        let heading = (point - last).normalize();
        self.headings.push((heading, heading));
        self.points.push(point);
        self.smooth.push(smooth);
        true
    }

    /// The sub-paths of `path` which have at least one segment. Within the tolerance lie the path, and both ends of a pen
    /// that reaches so far to either side of it.
    pub(super) fn all(path: &BezPath, tolerance: f64, reach: f64) -> Vec<Polyline> {
        let mut all = Vec::new();
        let mut line = Polyline::default();
        let mut segments = 0;
        let mut start = Point::ZERO;
        for element in path.elements() {
            let last = line.points.last().copied().unwrap_or(start);
            match *element {
                PathEl::MoveTo(p) => {
                    line.finish(segments, &mut all);
                    (start, segments) = (p, 0);
                    line = Polyline { direction: Vec2::new(1.0, 0.0), ..Polyline::default() };
                    line.push(p, false);
                    continue;
                }
                PathEl::ClosePath => {
                    line.closed = true;
                    line.finish(segments + 1, &mut all);
                    segments = 0;
                    line = Polyline { direction: Vec2::new(1.0, 0.0), ..Polyline::default() };
                    line.push(start, false);
                    continue;
                }
                PathEl::LineTo(p) => {
                    line.push(p, false);
                }
                PathEl::QuadTo(..) | PathEl::CurveTo(..) => line.push_curve(last, *element, tolerance, reach),
            }
            segments += 1;
        }
        line.finish(segments, &mut all);
        all
    }

    fn push_curve(&mut self, from: Point, curve: PathEl, tolerance: f64, reach: f64) {
        let mut stations = flattened(from, curve, tolerance, reach);
        let end = stations.pop();
        // A chord of almost no length has the direction of its rounding.
        let apart = |a: Point, b: Point| a.distance(b) > tolerance;
        let mut last = from;
        stations.retain(|&(point, _)| {
            let keep = apart(point, last) && end.is_none_or(|(end, _)| apart(point, end));
            if keep {
                last = point;
            }
            keep
        });
        let (leaves, arrives) = tangents(from, curve);
        let mut before = Some(leaves);
        let mut push = |point: Point, tangent: Option<Vec2>, smooth: bool| {
            if self.push(point, smooth) {
                let (leaves, arrives) = self.headings.last_mut().expect("just pushed");
                (*leaves, *arrives) = (before.unwrap_or(*leaves), tangent.unwrap_or(*arrives));
            }
            before = tangent;
        };
        stations.into_iter().for_each(|(point, tangent)| push(point, tangent, true));
        if let Some((end, _)) = end {
            push(end, Some(arrives), false);
            // A last chord of no length must not make the end look smooth.
            self.smooth.last_mut().into_iter().for_each(|smooth| *smooth = false);
        }
    }

    fn finish(mut self, segments: usize, all: &mut Vec<Polyline>) {
        while self.closed && self.points.len() > 1 && self.points.first() == self.points.last() {
            self.points.pop();
            self.smooth.pop();
        }
        if self.closed && self.points.len() > self.headings.len() && self.points.len() > 1 {
            let heading = (self.points[0] - self.points[self.points.len() - 1]).normalize();
            self.headings.push((heading, heading));
        }
        if segments > 0 && !self.points.is_empty() {
            all.push(self);
        }
    }

    /// Of segment `i`.
    fn length(&self, i: usize) -> f64 {
        self.points[i].distance(self.points[(i + 1) % self.points.len()])
    }

    /// The true path's direction at `part` (0..=1) of segment `i`.
    fn heading(&self, i: usize, part: f64) -> Vec2 {
        let (leaves, arrives) = self.headings[i];
        (leaves * (1.0 - part) + arrives * part).normalize()
    }

    /// The dashes of the line: `pattern` is dash, gap, dash, gap ... and begins `offset` before the
    /// line does. In a closed line the last dash and the first are one where they meet, or come as near as `no_gap`. A
    /// line of no length has none.
    pub(super) fn dashes(&self, pattern: &[f64], offset: f64, no_gap: f64) -> Vec<Polyline> {
        let period: f64 = pattern.iter().sum();
        if period.is_nan() || period <= 0.0 || !pattern.len().is_multiple_of(2) {
            return vec![self.clone()];
        }
        if self.headings.is_empty() {
            return Vec::new();
        }
        let (mut at, mut left) = (0, offset.rem_euclid(period));
        // What begins or ends this near to a corner does so there.
        let nothing = 1e-6 * period;
        // A dash of no length is a dot; it is not passed over where it stands.
        while left > 0.0 && left >= pattern[at] - nothing {
            left -= pattern[at];
            at = (at + 1) % pattern.len();
        }
        left = pattern[at] - left.max(0.0);
        let begins_inked = at % 2 == 0;
        let mut dashes: Vec<Polyline> = Vec::new();
        let mut dash = Polyline::default();
        if begins_inked {
            dash.push(self.points[0], self.smooth[0]);
        }
        for i in 0..self.headings.len() {
            let length = self.length(i);
            let (mut gone, mut part) = (0.0, 0.0);
            while gone + left < length - nothing {
                let goes_on = left > nothing || pattern[at] <= nothing;
                gone += left.max(0.0);
                let cut = gone / length;
                if at % 2 == 0 {
                    if goes_on {
                        self.copy_part(i, part, cut, &mut dash);
                    }
                    dashes.push(std::mem::take(&mut dash));
                } else {
                    self.copy_part(i, cut, cut, &mut dash);
                }
                part = cut;
                at = (at + 1) % pattern.len();
                left = pattern[at];
            }
            left -= length - gone;
            if at % 2 == 0 {
                self.copy_part(i, part, 1.0, &mut dash);
            }
        }
        let closes = self.closed && begins_inked && at % 2 == 1 && pattern[at] - left <= no_gap;
        if let Some(mut last) = dashes.pop_if(|_| closes) {
            last.push(self.points[0], false);
            match dashes.is_empty() {
                true => dashes.push(last),
                false => dash = last,
            }
        }
        self.join_at_seam(begins_inked, dash, &mut dashes);
        dashes
    }

    /// Adds [from, to], parts 0..=1 of segment `i`, to a dash.
    fn copy_part(&self, i: usize, from: f64, to: f64, dash: &mut Polyline) {
        let (start, end) = (self.points[i], self.points[(i + 1) % self.points.len()]);
        let heading = |part: f64| match part {
            0.0 => self.headings[i].0,
            1.0 => self.headings[i].1,
            _ => self.heading(i, part),
        };
        let whole = to == 1.0;
        let point = if whole { end } else { start.lerp(end, to) };
        let smooth = whole && self.smooth[(i + 1) % self.points.len()];
        if dash.push(point, smooth) {
            *dash.headings.last_mut().expect("just pushed") = (heading(from), heading(to));
        }
        dash.direction = heading(to);
    }

    fn join_at_seam(&self, begins_inked: bool, mut last: Polyline, dashes: &mut Vec<Polyline>) {
        if last.points.is_empty() {
            return;
        }
        match dashes.first_mut() {
            Some(first) if self.closed && begins_inked => {
                let rest = first.points.iter().zip(&first.smooth).skip(1).zip(&first.headings);
                for ((point, smooth), heading) in rest {
                    if last.push(*point, *smooth) {
                        *last.headings.last_mut().expect("just pushed") = *heading;
                    }
                }
                *first = last;
            }
            _ => dashes.push(last),
        }
    }
}

/// Control points this near to an end, in user units, give no direction: it would be of rounding.
const SAME_POINT: f64 = 1e-6;

/// Points along the curve, but for its first, each with the direction there if there is one. It is cut where it turns round
/// in x or in y, for one may run out and back along a line; then in halves, until both ends of the pen go straight.
fn flattened(from: Point, curve: PathEl, tolerance: f64, reach: f64) -> Vec<(Point, Option<Vec2>)> {
    let curve = match curve {
        PathEl::QuadTo(p1, p2) => QuadBez::new(from, p1, p2).raise(),
        PathEl::CurveTo(p1, p2, p3) => CubicBez::new(from, p1, p2, p3),
        _ => return Vec::new(),
    };
    let mut stations = Vec::new();
    let mut start = 0.0;
    for end in curve.extrema().into_iter().chain([1.0]) {
        halved(&curve, (start, end), tolerance, reach, MOST_HALVINGS, &mut stations);
        start = end;
    }
    stations
}

/// Parts of a curve are halved this often at most.
const MOST_HALVINGS: u32 = 16;

/// The same for a part of it.
fn halved(
    curve: &CubicBez,
    (from, to): (f64, f64),
    tolerance: f64,
    reach: f64,
    halvings: u32,
    stations: &mut Vec<(Point, Option<Vec2>)>,
) {
    let tangent = |t: f64| {
        let velocity = curve.deriv().eval(t).to_vec2();
        (velocity.hypot() > SAME_POINT).then(|| velocity.normalize())
    };
    let pen =
        |t: f64, reach: f64| curve.eval(t) + tangent(t).map_or(Vec2::ZERO, |along| along.turn_90() * reach);
    let goes_straight = |reach: f64| {
        let chord = Line::new(pen(from, reach), pen(to, reach));
        let is_near = |part: f64| {
            chord.nearest(pen(from + part * (to - from), reach), 0.0).distance_sq <= tolerance * tolerance
        };
        [0.25, 0.5, 0.75].into_iter().all(is_near)
    };
    if halvings == 0 || [-reach, 0.0, reach].into_iter().all(goes_straight) {
        stations.push((curve.eval(to), tangent(to)));
        return;
    }
    let middle = 0.5 * (from + to);
    halved(curve, (from, middle), tolerance, reach, halvings - 1, stations);
    halved(curve, (middle, to), tolerance, reach, halvings - 1, stations);
}

/// The directions, of length 1, in which a curve leaves and arrives.
fn tangents(from: Point, curve: PathEl) -> (Vec2, Vec2) {
    let points = match curve {
        PathEl::QuadTo(control, to) => vec![from, control, to],
        PathEl::CurveTo(one, other, to) => vec![from, one, other, to],
        _ => unreachable!("a curve"),
    };
    let last = points[points.len() - 1];
    let leaves = points.iter().map(|&p| p - from).find(|v| v.hypot2() > SAME_POINT.powi(2));
    let arrives = points.iter().rev().map(|&p| last - p).find(|v| v.hypot2() > SAME_POINT.powi(2));
    let along = Vec2::new(1.0, 0.0);
    (leaves.unwrap_or(along).normalize(), arrives.unwrap_or(along).normalize())
}
