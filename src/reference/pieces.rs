//! Takes polylines and a stroke's style, makes what is inked as a union of plain pieces: two half
//! boxes for each segment, a wedge for each turn, a cap for each end. All pieces wind the same way, so that
//! together, filled non-zero, they are their union, whatever overlaps.
//!
//! ```text
//!     a +---------------+ b      box of one segment, as wide as the stroke
//!       |   segment     |  \
//!       *---------------*   .    wedge at the turn, on its outer side: fan, kite or triangle
//!       |               |\  |
//!     d +---------------+ \ .
//! ```

use super::polyline::Polyline;
use super::stroke::Style;
use kurbo::{BezPath, Cap, Join, Point, Stroke, Vec2};

/// The pieces of `line`; `tolerance` is in user units.
pub(super) fn stroke(line: &Polyline, style: &Style, tolerance: f64, out: &mut BezPath) {
    let Style { line: ref stroke, clips_miters } = *style;
    let mut pieces = Pieces { style: stroke, clips_miters, radius: stroke.width / 2.0, tolerance, out };
    let points = &line.points;
    let count = points.len();
    if count == 1 {
        let direction = line.direction.normalize();
        pieces.cap(points[0], direction, stroke.end_cap);
        pieces.cap(points[0], -direction, stroke.start_cap);
        return;
    }
    for (i, &(leaves, arrives)) in line.headings.iter().enumerate() {
        let next = (i + 1) % count;
        pieces.segment(points[i], points[next], leaves, arrives);
        if let Some(after) = line.headings.get(if line.closed { next } else { i + 1 }) {
            let join = if line.smooth[next] { Join::Round } else { stroke.join };
            pieces.join(points[next], arrives, after.0, join);
        }
    }
    if let (false, Some(first), Some(last)) = (line.closed, line.headings.first(), line.headings.last()) {
        pieces.cap(points[0], -first.0, stroke.start_cap);
        pieces.cap(points[count - 1], last.1, stroke.end_cap);
    }
}

struct Pieces<'a> {
    style: &'a Stroke,
    clips_miters: bool,
    radius: f64,
    tolerance: f64,
    out: &'a mut BezPath,
}

impl Pieces<'_> {
    /// A polygon, turned so that all have the same sense.
    fn polygon(&mut self, points: &[Point]) {
        let area: f64 = (0..points.len())
            .map(|i| points[i].to_vec2().cross(points[(i + 1) % points.len()] - points[i]))
            .sum();
        let first = points[0];
        self.out.move_to(first);
        if area >= 0.0 {
            points[1..].iter().for_each(|&point| self.out.line_to(point));
        } else {
            points[1..].iter().rev().for_each(|&point| self.out.line_to(point));
        }
        self.out.close_path();
    }

    /// A box whose ends stand across the true path's directions, each half apart: two triangles where a tight turn folds
    /// one. Where the path turns on the spot, as a curve does in a cusp, the pen turns with it.
    fn segment(&mut self, from: Point, to: Point, leaves: Vec2, arrives: Vec2) {
        let chord = to - from;
        let mut leaves = leaves;
        if self.turns_on_the_spot(leaves, arrives) {
            self.turn(from, leaves, arrives);
            leaves = arrives;
        }
        for side in [1.0, -1.0] {
            let (start, end) =
                (leaves.turn_90() * (self.radius * side), arrives.turn_90() * (self.radius * side));
            let apart = start.cross(end);
            let (share, other) = (chord.cross(end) / apart, chord.cross(start) / apart);
            let within = |share: f64| 0.0 < share && share < 1.0;
            if within(share) && within(other) {
                let crossing = from + start * share;
                self.polygon(&[from, to, crossing]);
                self.polygon(&[crossing, from + start, to + end]);
            } else {
                self.polygon(&[from, to, to + end, from + start]);
            }
        }
    }

    /// Whether the arc of the pen's edge is farther than the tolerance from its chord.
    fn turns_on_the_spot(&self, before: Vec2, after: Vec2) -> bool {
        let half_cosine = (0.5 * (1.0 + before.dot(after))).max(0.0).sqrt();
        self.radius * (1.0 - half_cosine) > self.tolerance
    }

    /// What both ends of the pen ink when it turns on the spot, the shorter way round.
    fn turn(&mut self, at: Point, before: Vec2, after: Vec2) {
        let across = before.turn_90() * self.radius;
        let angle = before.cross(after).atan2(before.dot(after));
        self.fan(at, across, angle);
        self.fan(at, -across, angle);
    }

    /// The outer side of the turn from one direction to the next.
    fn join(&mut self, at: Point, before: Vec2, after: Vec2, join: Join) {
        let (cross, dot) = (before.cross(after), before.dot(after));
        if cross == 0.0 && dot > 0.0 {
            return;
        }
        let side = if cross > 0.0 { -1.0 } else { 1.0 };
        let across = |direction: Vec2| direction.turn_90() * (self.radius * side);
        let (from, to) = (across(before), across(after));
        match join {
            Join::Round => self.fan(at, from, -side * cross.abs().atan2(dot)),
            // The mitre's length over the width is 1 / sin(half the angle between the segments).
            Join::Miter if 2.0 <= (1.0 + dot) * self.style.miter_limit.powi(2) => {
                let tip = (from + to) / (1.0 + dot);
                self.polygon(&[at, at + from, at + tip, at + to]);
            }
            // Cut where the middle of the turn is half the limit times the width away.
            Join::Miter if self.clips_miters => {
                let middle = (before - after).normalize();
                let far = self.style.miter_limit * self.radius;
                let cut = |edge: Vec2, on: Vec2| at + edge + on * ((far - edge.dot(middle)) / on.dot(middle));
                self.polygon(&[at, at + from, cut(from, before), cut(to, -after), at + to]);
            }
            Join::Miter | Join::Bevel => self.polygon(&[at, at + from, at + to]),
        }
    }

    /// A fan of triangles from `at + from` through `angle`.
    fn fan(&mut self, at: Point, from: Vec2, angle: f64) {
        // The sagitta of each chord: radius (1 - cos(half its angle)).
        let most = 2.0 * (1.0 - (self.tolerance / self.radius).min(1.0)).acos();
        let count = (angle.abs() / most.max(1e-4)).ceil().max(1.0) as usize;
        let mut points = vec![at];
        for i in 0..=count {
            let turn = angle * i as f64 / count as f64;
            points.push(
                at + Vec2::new(
                    from.x * turn.cos() - from.y * turn.sin(),
                    from.x * turn.sin() + from.y * turn.cos(),
                ),
            );
        }
        self.polygon(&points);
    }

    /// What lies beyond an end at `at`, in `direction`.
    fn cap(&mut self, at: Point, direction: Vec2, cap: Cap) {
        match cap {
            Cap::Butt => {}
            Cap::Square => self.segment(at, at + direction * self.radius, direction, direction),
            Cap::Round => {
                self.fan(at, direction.turn_90() * self.radius, -std::f64::consts::PI);
            }
        }
    }
}
