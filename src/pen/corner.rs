//! Takes two segments that meet, makes the outline of their join; takes an end, makes that of its cap
//! (SVG 2, 13.5.4 and 13.5.5).

use super::nib::Nib;
use super::quarter;
use super::spine::Spine;
use crate::chords::{chord_end, outwards};
use crate::scene::StrokeStyle;
use kurbo::{Cap, Join, Point, Vec2};
use std::f64::consts::FRAC_PI_2;

/// A pen's end that moves less than this in a corner, in pixels, makes no join.
const SMOOTH: f64 = 1e-4;

/// Where the path turns from one segment to the next.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    at: Point,
    /// Unit vectors along the path, before and after.
    before: Vec2,
    after: Vec2,
    cosine: f64,
    /// The side, as [`super::side::Side::which`], that the path turns to.
    pub inner: f64,
    /// How far from the corner the two inner sides meet, measured along the path.
    pub trim: f64,
    /// How far one segment's inner side reaches along the other segment.
    pub reach: f64,
    pub inner_join: InnerJoin,
    /// Do the two outer sides go on to where they meet?
    pub is_pointed: bool,
}

/// How the two inner sides are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InnerJoin {
    /// Both end where they meet.
    Meet,
    /// By a straight line, which both segments cover.
    Line,
    /// By way of the corner: each segment has its own piece, however short the other is.
    Corner,
}

/// How far from the corner its inner join passes, in pixels: enough that the outline touches nothing
/// that has the path for its border, and too little to be seen.
const BESIDE: f64 = 2.5e-4;

impl Corner {
    /// The corner between two segments, or `None` where the path goes smoothly on.
    pub fn new(spine: &Spine, before: usize, after: usize, style: &StrokeStyle, nib: Nib) -> Option<Corner> {
        let (end, begin) = (spine.end(before), spine.begin(after));
        // Where the path turns back, rounding may carry the cosine a little too far.
        let (sine, cosine) = (end.along.cross(begin.along), end.along.dot(begin.along).max(-1.0));
        let radius = nib.radius;
        if cosine > 0.0 && sine.abs() * radius * nib.scale < SMOOTH {
            return None;
        }
        let trim = radius * ((1.0 - cosine) / (1.0 + cosine)).sqrt();
        let limit = style.miter_limit;
        let is_pointed = match style.join {
            Join::Miter => limit * limit * (1.0 + cosine) >= 2.0,
            Join::Round => spine.is_line(before) && spine.is_line(after) && nib.is_flat(trim),
            Join::Bevel => false,
        };
        Some(Corner {
            at: begin.at,
            before: end.along,
            after: begin.along,
            cosine,
            inner: if sine < 0.0 { -1.0 } else { 1.0 },
            trim,
            reach: radius * sine.abs(),
            inner_join: InnerJoin::Corner,
            is_pointed,
        })
    }

    /// Do the lines on one side end where they meet?
    pub fn meets(&self, which: f64) -> bool {
        match which == self.inner {
            true => self.inner_join == InnerJoin::Meet,
            false => self.is_pointed,
        }
    }

    /// The vertices on one side between the two segments'.
    pub fn walk(&self, which: f64, style: &StrokeStyle, nib: Nib, add: &mut impl FnMut(Point)) {
        if which == self.inner {
            match self.inner_join {
                InnerJoin::Meet => add(self.crossing(which, nib)),
                InnerJoin::Line => {}
                InnerJoin::Corner => {
                    let inwards = self.after - self.before;
                    add(self.at + BESIDE / nib.scale / inwards.hypot() * inwards);
                }
            }
            return;
        }
        match style.join {
            _ if self.is_pointed => add(self.crossing(which, nib)),
            Join::Miter if style.clips_miters => {
                self.clipped(which, style.miter_limit, nib).into_iter().for_each(add);
            }
            Join::Miter | Join::Bevel => {}
            Join::Round => self.arc(which, nib, add),
        }
    }

    /// Where the two segments' lines on one side cross.
    fn crossing(&self, which: f64, nib: Nib) -> Point {
        self.at + which * nib.radius / (1.0 + self.cosine) * quarter(self.before + self.after)
    }

    /// The two vertices where the miter is cut off, across its middle and half the limit times the pen's
    /// width from the corner (SVG 2, 13.5.5).
    fn clipped(&self, which: f64, limit: f64, nib: Nib) -> [Point; 2] {
        // The middle lies half the turn from either side's normal.
        let half_cosine = (0.5 * (1.0 + self.cosine)).max(0.0).sqrt();
        let half_sine = (0.5 * (1.0 - self.cosine)).sqrt();
        let along = nib.radius * (limit - half_cosine) / half_sine;
        [
            self.at + which * nib.radius * quarter(self.before) + along * self.before,
            self.at + which * nib.radius * quarter(self.after) - along * self.after,
        ]
    }

    fn arc(&self, which: f64, nib: Nib, add: &mut impl FnMut(Point)) {
        // Towards the middle of the arc; of the two ways to get it, the one that is not near zero.
        let middle = match self.cosine > 0.0 {
            true => which * quarter(self.before + self.after),
            false => self.before - self.after,
        };
        let sine = self.before.cross(self.after).abs();
        let half = 0.5 * libm::atan2(sine, self.cosine);
        arc(self.at, middle / middle.hypot(), -which * half, nib, add);
    }
}

/// The vertices of a cap between the ends of the two sides: from the side that a quarter turn of
/// `outwards` points to, to the other. Both ends are among them.
pub(super) fn cap(at: Point, outwards: Vec2, style: Cap, nib: Nib, add: &mut impl FnMut(Point)) {
    let side = nib.radius * quarter(outwards);
    let reach = nib.radius * outwards;
    add(at + side);
    match style {
        Cap::Butt => {}
        Cap::Square => {
            add(at + side + reach);
            add(at - side + reach);
        }
        Cap::Round => arc(at, outwards, -FRAC_PI_2, nib, add),
    }
    add(at - side);
}

/// The inner vertices of an arc around `middle` (a unit vector), from `-half` to `half` radians, which
/// enclose the arc's area.
fn arc(center: Point, middle: Vec2, half: f64, nib: Nib, add: &mut impl FnMut(Point)) {
    let turn = 2.0 * half.abs();
    let steps = nib.arc_stops(turn);
    let step = turn * (chord_end(2, steps) - chord_end(1, steps));
    let end_step = turn * chord_end(1, steps);
    let steps = steps as i32;
    for i in 1..steps {
        let (first, last) = (i == 1, i + 1 == steps);
        let length = |is_end: bool| if is_end { end_step } else { step };
        let radius = nib.radius * (1.0 + outwards((length(first), first), (length(last), last)));
        // The same for both ends of the arc.
        let from_middle = f64::from((2 * i - steps).abs()) * (0.5 * step);
        let (sine, cosine) = libm::sincos(from_middle);
        let side = f64::from((2 * i - steps).signum()) * half.signum() * sine;
        add(center + radius * (cosine * middle + side * quarter(middle)));
    }
}
