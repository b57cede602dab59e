//! Takes a part of a pixel, makes the mean of a gradient's colours there.
//!
//! Where the map turns, it is cut into triangles or squares in which the circles of a radial gradient are
//! straight; where a border beyond which there is no colour runs through it, it is cut there first.

use super::pattern::Local;
use super::{Chord, GradientShader, CORNERS, MOST_SHARE_OF_LIFT};
use crate::scene::color_map::Integral;
use crate::scene::paint::Sheet;
use kurbo::{Point, Vec2};

/// A point this near to a border lies on it, in pixels.
const ON_BORDER: f64 = 1e-6;

/// How often a pixel's side is halved at most where circles are no straight lines: next to an apex, and where the
/// places are that have no colour.
pub(super) const MOST_HALVINGS: u32 = 5;

/// What the parameter bends up to a triangle's corner as a share of its reach, beyond which that is not all: six times
/// a square's lift.
const MOST_SHARE_OF_BEND: f64 = 6.0 * MOST_SHARE_OF_LIFT;

/// Next to a border the parameter goes as the root of the distance. Of a triangle that touches it, the mean that is told
/// by the bend in the middle is off by an eighth of what the parameter bends up to the border; this is twice that.
const MOST_SHARE_OF_ROOT: f64 = 0.25;

/// What a part of a pixel may be off by, of which there are some dozens.
const MOST_OF_PARTS: f64 = 0.01 / 255.0;

impl GradientShader<'_> {
    /// The mean over a convex polygon, by the gradient's slope at the polygon's centre.
    pub fn over(&self, centre: Point, corners: &[Point]) -> Sheet {
        if self.is_partly_clear(corners) {
            return self.mean_of_colored(corners);
        }
        let Some(local) = self.pattern.local(centre) else {
            return self.least();
        };
        let stretch = self.stretches.around(local.t);
        let parameters = corners.iter().map(|&p| local.t + local.along.dot(p - centre));
        let (from, to) = parameters.fold((local.t, local.t), |(from, to), t| (t.min(from), t.max(to)));
        let bent = local.far(1.0) - local.reach();
        if stretch.holds(from - bent, to + bent) && self.keeps_mean(&local) {
            return stretch.at(local.t);
        }
        let integral = match self.is_straight(&local, 1.0) {
            true => self.linear_integral(&local, centre, corners),
            false => self.in_triangles(centre, corners),
        };
        integral.mean().map_or_else(|| stretch.at(local.t), |mean| self.sheet_of(mean))
    }

    /// Over a square of this side, cut into ones in which circles are straight.
    pub(super) fn square(&self, centre: Point, side: f64, halvings: u32) -> Integral {
        let (local, area) = (self.pattern.local(centre), side * side);
        if let Some(local) = local.filter(|local| halvings == 0 || self.is_straight(local, area)) {
            let t = local.t + area * local.lift();
            let mean = self.map().over_square(t, (side * local.along.x, side * local.along.y));
            let mean = mean.unwrap_or_else(|| self.color_of(self.stretches.around(t).at(t)));
            return Integral { sum: mean.map(|v| f64::from(v) * area), area };
        }
        let mut sum = Integral { area: if halvings == 0 { area } else { 0.0 }, ..Integral::default() };
        if halvings > 0 {
            for corner in CORNERS {
                sum.add(self.square(centre + 0.5 * side * corner, 0.5 * side, halvings - 1));
            }
        }
        sum
    }

    /// Does a border beyond which there is no colour run through a polygon?
    #[inline]
    pub(super) fn is_partly_clear(&self, corners: &[Point]) -> bool {
        let runs_through = |border: &Chord| {
            let sides = corners.iter().map(|&p| side_of(border, p));
            let (least, most) = sides.fold((0.0f64, 0.0f64), |(least, most), v| (least.min(v), most.max(v)));
            least < -ON_BORDER && most > ON_BORDER
        };
        self.pattern.borders().iter().any(runs_through)
    }

    /// The mean over a convex polygon through which borders run beyond which there is no colour.
    #[inline(never)]
    pub(super) fn mean_of_colored(&self, corners: &[Point]) -> Sheet {
        let mut parts = vec![corners.to_vec()];
        for border in self.pattern.borders() {
            let sides = |part: Vec<Point>| [1.0, -1.0].map(|side| on_side(&part, border, side));
            parts = parts.into_iter().flat_map(sides).filter(|part| part.len() > 2).collect();
        }
        let mut sum = Integral::default();
        for part in &parts {
            let Some(centre) = centre_of(part) else { continue };
            match self.pattern.local(centre) {
                Some(_) => sum.add(self.in_triangles(centre, part)),
                None => sum.area += area_of(part),
            }
        }
        sum.mean().map_or_else(|| self.least(), |mean| self.sheet_of(mean))
    }

    fn in_triangles(&self, centre: Point, corners: &[Point]) -> Integral {
        let mut sum = Integral::default();
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            sum.add(self.triangle([centre, corner, next], MOST_HALVINGS));
        }
        sum
    }

    /// Over a triangle, cut into ones in which circles are straight.
    fn triangle(&self, corners: [Point; 3], halvings: u32) -> Integral {
        let [a, b, c] = corners;
        let centre = Point::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
        let (local, area) = (self.pattern.local(centre), 0.5 * (b - a).cross(c - a));
        if let Some(local) = local {
            if let Some(color) = self.even_on(&local, centre, &corners) {
                return Integral { sum: color.map(|v| f64::from(v) * area), area };
            }
            if halvings == 0 || self.is_straight(&local, 2.0 * area.abs()) {
                return self.linear_integral(&local, centre, &corners);
            }
        }
        // Where there is no colour there is nothing to add but area.
        let mut sum = Integral { area: if halvings == 0 { area } else { 0.0 }, ..Integral::default() };
        if halvings > 0 {
            let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
            for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                sum.add(self.triangle(part, halvings - 1));
            }
        }
        sum
    }

    /// The mean over a triangle on which the map goes straight and the parameter bends little, or where neither does
    /// much.
    fn even_on(&self, local: &Local, centre: Point, corners: &[Point; 3]) -> Option<[f32; 4]> {
        let most = |of: &dyn Fn(Vec2) -> f64| corners.iter().map(|&p| of(p - centre)).fold(0.0, f64::max);
        let reach = most(&|by| local.along.dot(by).abs());
        let bent = most(&|by| 0.5 * local.bend.abs() * local.across.dot(by).powi(2));
        let bends_little = bent <= MOST_SHARE_OF_BEND * reach;
        // Where it bends more, what the middle tells of it is up to half of what it does.
        let far = if bends_little { reach + bent } else { 2.0 * (reach + bent) };
        let stretch = self.stretches.around(local.t);
        let most_off = match stretch.holds(local.t - far, local.t + far) {
            true if bends_little => 0.0,
            true => MOST_SHARE_OF_ROOT * stretch.steepness() * bent,
            false => self.jump + self.steepness * far,
        };
        let lifts = corners.iter().map(|&p| local.across.dot(p - centre).powi(2)).sum::<f64>();
        (most_off * area_of(corners).abs() <= MOST_OF_PARTS)
            .then(|| self.color_of(stretch.at(local.t + local.bend * lifts / 24.0)))
    }

    /// Over a polygon on which the parameter is taken to be linear, with the mean that it has.
    fn linear_integral(&self, local: &Local, centre: Point, corners: &[Point]) -> Integral {
        let square = local.along.hypot2();
        if square == 0.0 {
            let (color, area) = (self.color_of(self.stretches.around(local.t).at(local.t)), area_of(corners));
            return Integral { sum: color.map(|v| f64::from(v) * area), area };
        }
        let lifts = corners.iter().map(|&p| local.across.dot(p - centre).powi(2)).sum::<f64>();
        let t = local.t + local.bend * lifts / 24.0;
        self.map().over(corners.iter().map(|&p| {
            let from_centre = p - centre;
            (t + local.along.dot(from_centre), local.along.cross(from_centre) / square)
        }))
    }
}

/// The corners of a square of this side around a point.
#[inline]
pub(super) fn square_of(centre: Point, side: f64) -> [Point; 4] {
    CORNERS.map(|corner| centre + side * corner)
}

/// How far a point lies on one side of a line whose ends are a pixel apart.
#[inline]
fn side_of([from, to]: &Chord, p: Point) -> f64 {
    (*to - *from).cross(p - *from)
}

/// The part of a convex polygon on one side of a line.
fn on_side(corners: &[Point], line: &Chord, side: f64) -> Vec<Point> {
    let mut part = Vec::with_capacity(corners.len() + 1);
    for (i, &corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let (d, next_d) = (side * side_of(line, corner), side * side_of(line, next));
        if d >= 0.0 {
            part.push(corner);
        }
        if d * next_d < 0.0 {
            part.push(corner.lerp(next, d / (d - next_d)));
        }
    }
    part
}

/// The area of a polygon, whose sign is the way round it.
fn area_of(corners: &[Point]) -> f64 {
    let triangle = |pair: &[Point]| 0.5 * (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    corners.windows(2).map(triangle).sum()
}

/// The centre of gravity of a convex polygon; `None` without an area.
fn centre_of(corners: &[Point]) -> Option<Point> {
    let (mut sum, mut area) = (Vec2::ZERO, 0.0);
    for pair in corners.windows(2) {
        let (a, b) = (pair[0] - corners[0], pair[1] - corners[0]);
        (sum, area) = (sum + a.cross(b) * (a + b), area + a.cross(b));
    }
    (area.abs() > 1e-12).then(|| corners[0] + sum / (3.0 * area))
}
