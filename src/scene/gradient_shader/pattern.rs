//! Takes the geometry of a gradient at a picture's scale, makes its parameter at points in pixels and tells how
//! it changes around them: the pattern function of which the colours are a map.
//!
//! The circles of a radial gradient are the sections of a cone: where the cone holds its focal circle, as it does
//! unless a drawing says otherwise, the parameter is that at the apex plus a norm of the way from there,
//! t = t₀ + h·v + √(vᵀ M v). So it is convex, its slope is h + M v / √(vᵀ M v), and its second derivative, which is
//! 0 along v, is det M / √(vᵀ M v)³ times (v turned by a right angle) twice.

use super::circles::Circles;
use super::CORNERS;
use crate::scene::paint::GradientShape;
use kurbo::{Affine, Point, Vec2};

/// The parameter at points in pixels.
#[derive(Clone, Debug)]
pub(super) enum Pattern {
    /// `start` in the origin, and its change along x and y.
    Linear {
        start: f64,
        along: Vec2,
    },
    Cone(Cone),
    /// Circles that do not lie within one another: places may lie on two of them or on none.
    Circles(Circles),
}

/// The parameter at a point, and around it: at a step d from there it is t + along·d + bend (across·d)² / 2, next
/// to the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub t: f64,
    /// Its change along x and y, a pixel.
    pub along: Vec2,
    pub across: Vec2,
    pub bend: f64,
}

impl Local {
    #[inline]
    pub fn on_plane(t: f64, along: Vec2) -> Local {
        Local { t, along, across: Vec2::ZERO, bend: 0.0 }
    }

    /// How far the parameter goes to either side in a pixel, were it linear.
    #[inline]
    pub fn reach(&self) -> f64 {
        0.5 * (self.along.x.abs() + self.along.y.abs())
    }

    /// How far it goes to either side in a spot of this side. Up to a corner it bends by six lifts, and a little more
    /// where the bend grows.
    #[inline]
    pub fn far(&self, side: f64) -> f64 {
        side * self.reach() + 8.0 * side * side * self.lift().abs()
    }

    /// By how much its mean over the pixel is more than what it is in the middle.
    #[inline]
    pub fn lift(&self) -> f64 {
        self.bend * self.across.hypot2() / 24.0
    }
}

/// How many pixels of a row are alike, and how.
#[derive(Clone, Copy, Debug)]
pub(super) enum Run {
    /// They have parameters, which change by no more than `far` between the centre of a pixel's spot and its corners.
    Colored { count: usize, far: f64 },
    /// No place in them has a parameter.
    Clear { count: usize },
    /// Each is to be looked at by itself.
    Mixed { count: usize },
}

/// Pixels of a row that are looked up in tables at a time.
pub(super) const AT_A_TIME: usize = 64;

/// Steps of the direction in an eighth of a turn.
pub(super) const STEPS: usize = 256;

/// A little less, so that the direction at the end of an eighth is not in the next.
const SPAN: f64 = STEPS as f64 - 1.0 / 64.0;

/// What pixels of a row are looked up by.
pub(super) struct Aims {
    /// The mean of the parameter over the spot, in periods without whole ones: -.5 ..= .5.
    pub phases: [f32; AT_A_TIME],
    /// In which direction from the apex it lies, in steps, which tells how the parameter changes.
    pub directions: [f32; AT_A_TIME],
    /// By how much that mean is more than what the parameter is in the middle.
    pub lifts: [f32; AT_A_TIME],
}

impl Default for Aims {
    fn default() -> Aims {
        Aims { phases: [0.0; AT_A_TIME], directions: [0.0; AT_A_TIME], lifts: [0.0; AT_A_TIME] }
    }
}

/// Without whole ones: -.5 ..= .5. Numbers too great to have digits behind the point leave anything.
#[inline]
fn phase(periods: f64) -> f32 {
    // Sums with it have no digits behind the point: quicker than rounding.
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    (periods - ((periods + ROUNDER) - ROUNDER)) as f32
}

impl Pattern {
    pub fn new(shape: GradientShape, to_plane: Affine) -> Pattern {
        match shape {
            GradientShape::Linear(map) => {
                let [a, _, c, _, e, _] = (map * to_plane).as_coeffs();
                Pattern::Linear { start: e, along: Vec2::new(a, c) }
            }
            GradientShape::Radial { start, step } => match Cone::new(start, step, to_plane) {
                Some(cone) => Pattern::Cone(cone),
                None => Pattern::Circles(Circles::new(start, step, to_plane)),
            },
        }
    }

    /// What the parameter is and does at a point in pixels; nothing where there is none.
    #[inline]
    pub fn local(&self, p: Point) -> Option<Local> {
        match self {
            Pattern::Linear { start, along } => {
                let t = start + along.dot(p.to_vec2());
                t.is_finite().then_some(Local::on_plane(t, *along))
            }
            Pattern::Cone(cone) => Some(cone.local(p)),
            Pattern::Circles(circles) => circles.local(p),
        }
    }

    /// A range that holds the parameters of all places in the pixel around a point that have one.
    pub fn range(&self, centre: Point) -> Option<(f64, f64)> {
        match self {
            Pattern::Linear { .. } => {
                let local = self.local(centre)?;
                Some((local.t - local.reach(), local.t + local.reach()))
            }
            Pattern::Cone(cone) => {
                // It lies above its planes, and between the corners below what it is in them.
                let local = cone.local(centre);
                let corners = CORNERS.map(|corner| cone.local(centre + corner).t);
                Some((local.t - local.reach(), corners.into_iter().fold(local.t, f64::max)))
            }
            Pattern::Circles(circles) => {
                let has_any = |by: Vec2| circles.parameter(centre + by).is_some();
                let local = circles.local(centre);
                if local.is_none() && !CORNERS.into_iter().any(has_any) {
                    return None;
                }
                // Nearly straight.
                if let Some(local) = local.filter(|local| local.lift().abs() < 0.02 * local.reach()) {
                    return Some((local.t - 1.5 * local.reach(), local.t + 1.5 * local.reach()));
                }
                const SIDE: usize = 5;
                let place = |i: usize| i as f64 / (SIDE - 1) as f64 - 0.5;
                let places = (0..SIDE * SIDE).map(|i| Vec2::new(place(i % SIDE), place(i / SIDE)));
                let parameters = places.filter_map(|by| circles.parameter(centre + by));
                let ends = (f64::INFINITY, f64::NEG_INFINITY);
                let (least, most) = parameters.fold(ends, |(least, most), t| (least.min(t), most.max(t)));
                let margin = 0.5 * (most - least);
                (least <= most).then_some((least - margin, most + margin))
            }
        }
    }

    /// The lines beyond which there is no colour, each by two points that are a pixel apart, in pixels.
    pub fn borders(&self) -> &[[Point; 2]] {
        match self {
            Pattern::Linear { .. } | Pattern::Cone(_) => &[],
            Pattern::Circles(circles) => circles.borders(),
        }
    }

    /// The first of a row's pixels from a centre on, as many as are alike, with their parameters if they are coloured.
    /// Spots have side `side`; where circles that do not lie within one another lift the parameter by more than
    /// `most_lift`, pixels are mixed.
    #[inline]
    pub fn row(&self, first: Point, (side, most_lift): (f64, f64), parameters: &mut [f64]) -> Run {
        let count = parameters.len();
        match self {
            Pattern::Linear { start, along } => {
                let start = along.y * first.y + start;
                for (i, t) in parameters.iter_mut().enumerate() {
                    *t = along.x * (first.x + f64::from(i as u32)) + start;
                }
                Run::Colored { count, far: side * self.farthest() }
            }
            Pattern::Cone(cone) => {
                cone.row(first, parameters);
                Run::Colored { count, far: side * cone.farthest }
            }
            Pattern::Circles(circles) => circles.row(first, (side, most_lift), parameters),
        }
    }

    /// Gives `put` what the parameter is and does in pixels of a row from a centre on, if every place has one.
    #[inline]
    pub fn each_of_row(&self, first: Point, count: usize, mut put: impl FnMut(usize, &Local)) {
        let at = |i: usize| Point::new(first.x + f64::from(i as u32), first.y);
        match self {
            Pattern::Linear { start, along } => {
                let local = |p: Point| Local::on_plane(start + along.dot(p.to_vec2()), *along);
                (0..count).for_each(|i| put(i, &local(at(i))));
            }
            Pattern::Cone(cone) => {
                // Some at a time, as their roots and divisions do not wait for one another.
                const SOME: usize = 8;
                let mut locals = [Local::on_plane(0.0, Vec2::ZERO); SOME];
                for from in (0..count).step_by(SOME) {
                    let some = &mut locals[..(count - from).min(SOME)];
                    some.iter_mut().enumerate().for_each(|(i, local)| *local = cone.local(at(from + i)));
                    some.iter().enumerate().for_each(|(i, local)| put(from + i, local));
                }
            }
            Pattern::Circles(_) => {}
        }
    }

    /// What pixels of a row from a centre on are looked up by, up to [`AT_A_TIME`]; with spots of side `side`, of a
    /// map that repeats `frequency` times in a unit of the parameter.
    #[inline]
    pub fn aim(&self, first: Point, count: usize, (side, frequency): (f64, f64), aims: &mut Aims) {
        match self {
            Pattern::Linear { start, along } => {
                let start = along.y * first.y + start;
                for (i, to) in aims.phases[..count].iter_mut().enumerate() {
                    *to = phase((along.x * (first.x + f64::from(i as u32)) + start) * frequency);
                }
            }
            Pattern::Cone(cone) => cone.aim(first, count, (side, frequency), aims),
            Pattern::Circles(_) => {}
        }
    }

    /// Steps of the direction all around, those left out that are like others; none if places may have no
    /// parameter.
    pub fn steps(&self) -> usize {
        match self {
            Pattern::Linear { .. } => 1,
            Pattern::Cone(cone) => STEPS * cone.eighths,
            Pattern::Circles(_) => 0,
        }
    }

    /// What the parameter does in the direction at the end of so many steps, and the way there from the apex. In
    /// eighths of a turn `after` tells that it is the end of one, not the beginning of the next.
    pub fn local_after(&self, step: usize, after: bool) -> (Local, Vec2) {
        match self {
            Pattern::Linear { along, .. } => (Local::on_plane(0.0, *along), *along),
            Pattern::Cone(cone) => {
                let eighth = step.saturating_sub(usize::from(after)) / STEPS;
                let ray = cone.ray(eighth, (step - eighth * STEPS) as f64 / SPAN);
                (cone.local_on(ray), ray)
            }
            Pattern::Circles(_) => unreachable!("it has no steps"),
        }
    }

    /// The parameter changes by no more between the centre of a pixel and its corners, anywhere.
    pub fn farthest(&self) -> f64 {
        match self {
            Pattern::Linear { along, .. } => 0.5 * (along.x.abs() + along.y.abs()),
            Pattern::Cone(cone) => cone.farthest,
            Pattern::Circles(_) => f64::INFINITY,
        }
    }
}

/// A cone that holds its focal circle.
#[derive(Clone, Debug)]
pub(super) struct Cone {
    /// The place where its circles have no radius, in pixels, and their parameter there.
    apex: Point,
    t: f64,
    /// The linear share of the parameter.
    linear: Vec2,
    /// The quadratic form vᵀ M v is `scale` (x + `skew` y)² + `rest` y².
    scale: f64,
    skew: f64,
    rest: f64,
    /// Eighths of a turn that are not like others turned over: 1 of circles around one centre, 2 of ellipses along
    /// the pixels' rows, all 8 of others.
    eighths: usize,
    farthest: f64,
    /// The bend times the square of across is at most this over the parameter's distance from the apex's.
    curvature: f64,
}

impl Cone {
    /// `None` unless each circle lies well within those of greater parameters.
    fn new((x, y, r): (f64, f64, f64), (dx, dy, dr): (f64, f64, f64), to_plane: Affine) -> Option<Cone> {
        let square = dr * dr - dx * dx - dy * dy;
        if !(dr > 0.0 && square > 1e-9 * dr * dr) {
            return None;
        }
        // With p from the apex's place and τ from its parameter on: |p - τ (dx, dy)| = τ dr, so that
        // τ square = √((p·(dx, dy))² + square |p|²) - p·(dx, dy).
        let t = -r / dr;
        let apex = to_plane.inverse() * Point::new(x + t * dx, y + t * dy);
        let [a, b, c, d, ..] = to_plane.as_coeffs();
        let linear = Vec2::new(a * dx + b * dy, c * dx + d * dy) / -square;
        let scale = linear.x * linear.x + (a * a + b * b) / square;
        let mixed = linear.x * linear.y + (a * c + b * d) / square;
        let last = linear.y * linear.y + (c * c + d * d) / square;
        let determinant = (a * d - b * c).powi(2) * dr * dr / square.powi(3);
        // It is nowhere steeper than where the circles lie closest.
        let closest = dr - dx.hypot(dy);
        let farthest = 0.5 * (a.hypot(b) + c.hypot(d)) / closest;
        let greatest = 0.5 * (scale + last + (scale - last).hypot(2.0 * mixed));
        let (skew, rest) = (mixed / scale, determinant / scale);
        let is_small = |v: f64| v.abs() < 1e-9;
        let eighths = match is_small(skew) && is_small(linear.hypot() / scale.sqrt()) {
            true if is_small(rest / scale - 1.0) => 1,
            true => 2,
            false => 8,
        };
        let cone = Cone { apex, t, linear, scale, skew, rest, eighths, farthest, curvature: 2.0 * greatest };
        let figures = [t, linear.x, linear.y, cone.skew, cone.rest, farthest, greatest];
        (apex.is_finite() && figures.into_iter().all(f64::is_finite)).then_some(cone)
    }

    /// The parameter beyond which its mean over a pixel is nowhere more than `lift` above what it is in the middle.
    pub fn straight_from(&self, lift: f64) -> f64 {
        self.t + self.curvature / (24.0 * lift)
    }

    #[inline]
    fn local(&self, p: Point) -> Local {
        self.local_on(p - self.apex)
    }

    /// At the end of a way from the apex.
    #[inline]
    fn local_on(&self, v: Vec2) -> Local {
        let x = v.x + self.skew * v.y;
        // No place is so near to the apex that it has no slope.
        let norm = (self.scale * x * x + self.rest * v.y * v.y).sqrt().max(1e-100);
        let inverse = 1.0 / norm;
        let across = Vec2::new(-v.y, v.x);
        let slope = Vec2::new(self.scale * x, self.scale * self.skew * x + self.rest * v.y);
        Local {
            t: self.t + self.linear.dot(v) + norm,
            along: self.linear + inverse * slope,
            across,
            bend: self.scale * self.rest * inverse * inverse * inverse,
        }
    }

    /// See [`Pattern::aim`]. Where the circles are around one centre the eighths of a turn are those of the plane,
    /// otherwise those of the one in which they are, the first from the x axis to the diagonal; in each, steps
    /// are of the tangent.
    #[inline]
    fn aim(&self, first: Point, count: usize, (side, frequency): (f64, f64), aims: &mut Aims) {
        let y = first.y - self.apex.y;
        let (rest, skewed, y_square) = (self.rest * y * y, self.skew * y, y * y);
        let start = self.t + self.linear.y * y;
        let curve = side * side * self.scale * self.rest / 24.0;
        let root = self.scale.sqrt();
        let mut across = [0.0; AT_A_TIME];
        for (i, across) in across[..count].iter_mut().enumerate() {
            let x = first.x + f64::from(i as u32) - self.apex.x;
            let u = x + skewed;
            let square = self.scale * u * u + rest;
            let norm = square.sqrt();
            let lift = curve * (x * x + y_square) / (square * norm);
            aims.phases[i] = phase((start + self.linear.x * x + norm + lift) * frequency);
            aims.lifts[i] = lift as f32;
            *across = (root * u) as f32;
        }
        let down = (self.rest.sqrt() * y) as f32;
        let eighths = |which: usize| if which < self.eighths { (which * STEPS) as f32 } else { 0.0 };
        let (beyond, left, above) = (eighths(1), eighths(2), if down < 0.0 { eighths(4) } else { 0.0 });
        let down = down.abs();
        for (to, &across) in aims.directions[..count].iter_mut().zip(&across) {
            let turned = if across < 0.0 { above + left } else { above };
            let across = across.abs();
            let (least, most) = if across < down { (across, down) } else { (down, across) };
            let turned = if across < down { turned + beyond } else { turned };
            *to = turned + least / most * SPAN as f32;
        }
    }

    /// A way from the apex in an eighth of a turn, by the tangent in it.
    fn ray(&self, eighth: usize, tangent: f64) -> Vec2 {
        let (across, down) = if eighth & 1 == 0 { (1.0, tangent) } else { (tangent, 1.0) };
        let sign = |bit: usize| if eighth & bit == 0 { 1.0 } else { -1.0 };
        let y = sign(4) * down / self.rest.sqrt();
        Vec2::new(sign(2) * across / self.scale.sqrt() - self.skew * y, y)
    }

    fn row(&self, first: Point, parameters: &mut [f64]) {
        let v = first - self.apex;
        let (start, rest) = (self.t + self.linear.y * v.y, self.rest * v.y * v.y);
        let skewed = self.skew * v.y;
        for (i, t) in parameters.iter_mut().enumerate() {
            let x = v.x + f64::from(i as u32);
            let u = x + skewed;
            *t = start + self.linear.x * x + (self.scale * u * u + rest).sqrt();
        }
    }
}
