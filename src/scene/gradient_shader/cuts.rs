//! Takes a gradient and a pixel, makes the chords along which a pixel is cut so that the colours change little on
//! either side: parts of the curves of one parameter, and of the borders beyond which there is no colour.
//!
//! A curve of one parameter is a straight line, or an ellipse. Of an ellipse the arcs within the pixel are found by
//! their ends, and cut into chords that leave as much area on either side as the arc does.

use super::pattern::Pattern;
use crate::scene::paint::GradientShape;
use kurbo::{Affine, Point, Vec2};
use std::f64::consts::TAU;

/// From one point to another, in pixels.
pub(crate) type Chord = [Point; 2];

/// Chords of an arc are no farther from it, in pixels.
const MOST_SAGITTA: f64 = 0.02;

/// Chords of an arc.
const MOST_CHORDS: f64 = 32.0;

/// The chords of the curve of parameter `t` in the pixel around a point.
pub(super) fn of_parameter(
    pattern: &Pattern,
    (shape, to_pixels): (GradientShape, Affine),
    t: f64,
    centre: Point,
    chords: &mut Vec<Chord>,
) {
    match (pattern, shape) {
        (Pattern::Linear { start, along }, _) => {
            let by = (t - start - along.dot(centre.to_vec2())) / along.hypot2();
            across_pixel(centre + by * *along, Vec2::new(-along.y, along.x), chords);
        }
        (_, GradientShape::Radial { start: (x, y, r), step: (dx, dy, dr) }) => {
            let radius = r + t * dr;
            let [a, b, c, d, ..] = to_pixels.as_coeffs();
            let middle = to_pixels * Point::new(x + t * dx, y + t * dy);
            let axes = [radius * Vec2::new(a, b), radius * Vec2::new(c, d)];
            if radius > 0.0 && middle.is_finite() && axes.iter().all(|axis| axis.is_finite()) {
                Ellipse { middle, axes }.chords(centre, chords);
            }
        }
        (_, GradientShape::Linear(_)) => unreachable!("its pattern is linear"),
    }
}

/// A straight line, if it runs through the pixel around a point.
pub(super) fn of_line([from, to]: Chord, centre: Point, chords: &mut Vec<Chord>) {
    let along = to - from;
    let foot = from + along.dot(centre - from) / along.hypot2() * along;
    across_pixel(foot, along, chords);
}

/// A line through a point next to a pixel, so long that it leaves the pixel.
fn across_pixel(through: Point, along: Vec2, chords: &mut Vec<Chord>) {
    let reach = 2.0 * along / along.hypot();
    if through.is_finite() && reach.is_finite() {
        chords.push([through - reach, through + reach]);
    }
}

/// The points m + u cos a + v sin a.
struct Ellipse {
    middle: Point,
    axes: [Vec2; 2],
}

impl Ellipse {
    fn at(&self, angle: f64) -> Point {
        self.middle + libm::cos(angle) * self.axes[0] + libm::sin(angle) * self.axes[1]
    }

    fn chords(&self, centre: Point, chords: &mut Vec<Chord>) {
        let [u, v] = self.axes;
        let mut ends = Vec::with_capacity(8);
        // Where a component of a point is what it is on two sides of the pixel.
        for (u, v, to_middle) in [(u.x, v.x, centre.x - self.middle.x), (u.y, v.y, centre.y - self.middle.y)]
        {
            let (most, turn) = (u.hypot(v), libm::atan2(v, u));
            for side in [to_middle - 0.5, to_middle + 0.5].map(|side| side / most) {
                if side.abs() < 1.0 {
                    let angle = libm::acos(side);
                    ends.extend([turn - angle, turn + angle].map(|angle| angle.rem_euclid(TAU)));
                }
            }
        }
        ends.sort_unstable_by(f64::total_cmp);
        if ends.is_empty() {
            ends.push(0.0);
        }
        for (i, &from) in ends.iter().enumerate() {
            let to = ends.get(i + 1).copied().unwrap_or(ends[0] + TAU);
            let by = self.at(0.5 * (from + to)) - centre;
            // Where it touches a side two ends are one.
            if from < to && by.x.abs() <= 0.5 && by.y.abs() <= 0.5 {
                self.arc(from, to, chords);
            }
        }
    }

    fn arc(&self, from: f64, to: f64, chords: &mut Vec<Chord>) {
        let longer = self.axes[0].hypot2().max(self.axes[1].hypot2()).sqrt();
        // Over an angle a the chord is a² / 8 of the longer half axis away from it.
        let count = ((to - from) * (longer / (8.0 * MOST_SAGITTA)).sqrt()).ceil();
        // A full turn has at least three.
        let count = count.max(((to - from) * 3.0 / TAU).ceil()).clamp(1.0, MOST_CHORDS);
        let step = (to - from) / count;
        // The triangles from the middle are as large as the arc's sectors.
        let scale = (step / libm::sin(step)).sqrt();
        let corner = |i: u32| {
            let at = self.at(from + step * f64::from(i));
            self.middle + scale * (at - self.middle)
        };
        chords.extend((0..count as u32).map(|i| [corner(i), corner(i + 1)]));
    }
}
