//! Circles that do not lie within one another: all touch two lines, the borders, between which places lie on one or
//! two of them, and beyond which on none.
//!
//! With |d| the step of their centres, a = |d|² less the square of the radius's step, and l, m the distances from the
//! borders, the parameter is the greater root of a quadratic equation: t = (b + |d| √(l m)) / a, with b linear. So along
//! a row of pixels between the borders it is as cheap as a cone's; how much it bends is told by l and m.

use super::pattern::{Local, Run};
use super::Chord;
use kurbo::{Affine, Point, Vec2};

/// Pixels of a row whose slopes and bends are bounded together; and fewer, if they bend too much.
const TOGETHER: usize = 16;
const FEW_TOGETHER: usize = 4;

/// Pixels so near to a border are looked at one by one: beyond, their lift is all that bends do, as of the lift the
/// root's next term is at most a quarter of the square of (half a pixel over the distance); and their corners are not
/// on the border.
const NEAR: f64 = 2.0;

/// The circle (centre, radius) at parameter 0, and the steps from it to the one at 1, in the gradient's plane.
#[derive(Clone, Debug)]
pub(super) struct Circles {
    to_plane: Affine,
    start: (f64, f64, f64),
    step: (f64, f64, f64),
    /// The quadratic coefficient of the parameter's equation, and its inverse.
    quadratic: (f64, f64),
    borders: Vec<Chord>,
    /// If no place beyond the borders has a parameter, and all between them.
    between: Option<Between>,
}

/// Figures over pixels of circles whose parameter's equation is a quadratic one.
#[derive(Clone, Debug)]
struct Between {
    /// The distances from the borders, in the gradient's plane.
    distances: [Plane; 2],
    /// The parameter as it would be without the root: b / a.
    linear: Plane,
    /// |d| / a.
    root: f64,
}

/// A linear function of points in pixels.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// In the origin.
    start: f64,
    along: Vec2,
}

impl Circles {
    pub fn new(start: (f64, f64, f64), step: (f64, f64, f64), to_plane: Affine) -> Circles {
        let (dx, dy, dr) = step;
        let quadratic = dx * dx + dy * dy - dr * dr;
        let borders = borders(start, step);
        Circles {
            to_plane,
            start,
            step,
            quadratic: (quadratic, 1.0 / quadratic),
            between: borders.as_ref().and_then(|borders| Between::new(borders, start, step, to_plane)),
            borders: borders.map_or_else(Vec::new, |borders| in_pixels(&borders, to_plane.inverse())),
        }
    }

    /// See [`super::pattern::Pattern::borders`].
    pub fn borders(&self) -> &[Chord] {
        &self.borders
    }

    /// At a point in pixels.
    pub fn parameter(&self, p: Point) -> Option<f64> {
        self.circle(self.to_plane * p).map(|(t, _)| t)
    }

    /// See [`super::pattern::Pattern::row`].
    pub fn row(&self, first: Point, spot: (f64, f64), parameters: &mut [f64]) -> Run {
        match &self.between {
            Some(between) => between.row(first, spot, parameters),
            None => Run::Mixed { count: parameters.len() },
        }
    }

    /// The greatest t with a radius of at least 0 whose circle passes through the point (SVG 2, 14.2.3; HTML
    /// canvas).
    pub fn local(&self, p: Point) -> Option<Local> {
        let [a, b, c, d, ..] = self.to_plane.as_coeffs();
        let ((x0, y0, r0), (dx, dy, dr)) = (self.start, self.step);
        let in_plane = self.to_plane * p;
        let (t, root) = self.circle(in_plane)?;
        // With u from the circle's centre to the point and the circle's radius R, |u| = R: differentiated,
        // the parameter's slope is u / root.
        let u = Vec2::new(in_plane.x - x0 - t * dx, in_plane.y - y0 - t * dy);
        let along = Vec2::new(u.x * a + u.y * b, u.x * c + u.y * d) / root;
        // Along the circle it stays: it bends there by the slope over the radius. It does not along the ray from
        // where the circles have no radius, if that is anywhere.
        let ray = Vec2::new((in_plane.x - x0) * dr + r0 * dx, (in_plane.y - y0) * dr + r0 * dy);
        let across = Vec2::new(ray.x * b - ray.y * a, ray.x * d - ray.y * c) * u.hypot() / ray.dot(u);
        if along.is_finite() && across.is_finite() {
            return Some(Local { t, along, across, bend: 1.0 / root });
        }
        // In the focal point, or on a border, the slope is nothing to go by.
        let step = |by: Vec2| 2.0 * (self.parameter(p + by).unwrap_or(t) - t);
        let along = Vec2::new(step(Vec2::new(0.5, 0.0)), step(Vec2::new(0.0, 0.5)));
        Some(Local::on_plane(t, along))
    }

    /// The parameter of the circle through a point of the gradient's plane, and what its slope is to be
    /// divided by.
    fn circle(&self, p: Point) -> Option<(f64, f64)> {
        // |p - start - t (dx, dy)| = r0 + t dr
        let ((x0, y0, r0), (dx, dy, dr)) = (self.start, self.step);
        let (px, py) = (p.x - x0, p.y - y0);
        let (a, inverse) = self.quadratic;
        let half_b = px * dx + py * dy + r0 * dr;
        let c = px * px + py * py - r0 * r0;
        let valid = |t: f64, slope: f64| (t.is_finite() && r0 + t * dr >= 0.0).then_some((t, slope));
        if a.abs() <= 1e-12 * dr * dr {
            return valid(c / (2.0 * half_b), half_b);
        }
        let square = half_b * half_b - a * c;
        if square < 0.0 {
            return None;
        }
        // The greater of the two first: the one with the root's sign that of a.
        let root = square.sqrt().copysign(a);
        valid((half_b + root) * inverse, -root).or_else(|| valid((half_b - root) * inverse, root))
    }
}

impl Between {
    /// `None` unless the equation is well a quadratic one.
    fn new(
        borders: &[Border; 2],
        (x, y, r): (f64, f64, f64),
        (dx, dy, dr): (f64, f64, f64),
        to_plane: Affine,
    ) -> Option<Between> {
        let [a, b, c, d, e, f] = to_plane.as_coeffs();
        let in_pixels = |normal: Vec2, start: f64| Plane {
            start: start + normal.x * e + normal.y * f,
            along: Vec2::new(normal.x * a + normal.y * b, normal.x * c + normal.y * d),
        };
        let square = dx * dx + dy * dy;
        let quadratic = square - dr * dr;
        let distances = borders
            .each_ref()
            .map(|Border { touched, normal }| in_pixels(*normal, -normal.dot(touched.to_vec2())));
        let linear = in_pixels(Vec2::new(dx, dy) / quadratic, (r * dr - x * dx - y * dy) / quadratic);
        let mut planes = distances.into_iter().chain([linear]);
        let are_finite = planes.all(|plane| plane.start.is_finite() && plane.along.is_finite());
        let between = Between { distances, linear, root: square.sqrt() / quadratic };
        (quadratic > 1e-6 * square && are_finite).then_some(between)
    }

    /// See [`super::pattern::Pattern::row`].
    fn row(&self, first: Point, (side, most_lift): (f64, f64), parameters: &mut [f64]) -> Run {
        let beyond = self.distances.map(|plane| plane.stays(first, -1.0, 0.5 * side * plane.change()));
        if let Some(count) = beyond.into_iter().flatten().max() {
            return Run::Clear { count: count.min(parameters.len()) };
        }
        let within = self.distances.map(|plane| plane.stays(first, 1.0, side * NEAR * plane.along.hypot()));
        let [Some(l), Some(m)] = within else {
            return Run::Mixed { count: 1 };
        };
        let alike = l.min(m).min(parameters.len());
        for together in [TOGETHER, FEW_TOGETHER] {
            let count = alike.min(together);
            let ends = self.ends(first, count);
            if side * side * self.lift(ends) <= most_lift {
                self.parameters(first, &mut parameters[..count]);
                return Run::Colored { count, far: self.far(ends, side) };
            }
        }
        Run::Mixed { count: alike.min(FEW_TOGETHER) }
    }

    fn parameters(&self, first: Point, parameters: &mut [f64]) {
        let start = self.linear.at(first);
        let [l, m] = self.distances.map(|plane| plane.at(first));
        let [l_step, m_step] = self.distances.map(|plane| plane.along.x);
        for (i, t) in parameters.iter_mut().enumerate() {
            let i = f64::from(i as u32);
            let square = (l + i * l_step) * (m + i * m_step);
            *t = start + i * self.linear.along.x + self.root * square.sqrt();
        }
    }

    /// The least and the greatest distances from the borders of pixels of a row from a centre on.
    fn ends(&self, first: Point, count: usize) -> [(f64, f64); 2] {
        let last = Point::new(first.x + (count - 1) as f64, first.y);
        self.distances.map(|plane| {
            let (from, to) = (plane.at(first), plane.at(last));
            (from.min(to), from.max(to))
        })
    }

    /// At least the change of the parameter from the centre of a spot to its corners, if centres are so far from the
    /// borders.
    fn far(&self, [l, m]: [(f64, f64); 2], side: f64) -> f64 {
        let [along_l, along_m] = self.distances.map(|plane| side * plane.change());
        let with_corners = |(least, most): (f64, f64), along: f64| (least - 0.5 * along, most + 0.5 * along);
        let (l, m) = (with_corners(l, along_l), with_corners(m, along_m));
        // The slope of the root of l m is half that of l times the root of m / l, and the other way round.
        let along_root = 0.5 * (along_l * (m.1 / l.0).sqrt() + along_m * (l.1 / m.0).sqrt());
        0.5 * (side * self.linear.change() + self.root * along_root)
    }

    /// At least what its mean over a pixel is off by from what it is in the middle, but for the next term, in pixels
    /// whose centres are so far from the borders.
    fn lift(&self, [l, m]: [(f64, f64); 2]) -> f64 {
        // The second derivatives of the root of l m along x and y sum to the square of m l' - l m' over
        // -4 (l m)^(3/2).
        let [along_l, along_m] = self.distances.map(|plane| plane.along.hypot());
        let most = m.1 * along_l + l.1 * along_m;
        let least = l.0 * m.0;
        self.root * most * most / (96.0 * least * least.sqrt())
    }
}

impl Plane {
    fn at(&self, p: Point) -> f64 {
        self.start + self.along.dot(p.to_vec2())
    }

    /// In how many pixels of a row, from a centre on, it is `least` or more, times this sign; `None` if it is not in the
    /// first.
    fn stays(&self, first: Point, sign: f64, least: f64) -> Option<usize> {
        let (room, step) = (sign * self.at(first) - least, sign * self.along.x);
        let others = if step < 0.0 { (room / -step) as usize } else { usize::MAX };
        (room >= 0.0).then_some(others.saturating_add(1))
    }

    /// From a corner of a pixel to the one across, at most.
    fn change(&self) -> f64 {
        self.along.x.abs() + self.along.y.abs()
    }
}

/// A line that touches all circles, in the gradient's plane.
struct Border {
    /// Where it touches the one at parameter 0.
    touched: Point,
    /// Of length 1, to the side on which the circles are.
    normal: Vec2,
}

/// `None` if the circles nest.
fn borders((x, y, r): (f64, f64, f64), (dx, dy, dr): (f64, f64, f64)) -> Option<[Border; 2]> {
    let distance = dx.hypot(dy);
    let sine = dr / distance;
    // They do if they lie within one another, or are around one centre.
    if sine.is_nan() || sine.abs() > 1.0 + 1e-9 {
        return None;
    }
    // A unit normal n touches the circle at t where n . t (dx, dy) = t dr: the same for all t.
    let (ahead, aside) = (Vec2::new(dx, dy) / distance, Vec2::new(-dy, dx) / distance);
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let border = |cosine: f64| {
        let normal = sine * ahead + cosine * aside;
        Border { touched: Point::new(x, y) - r * normal, normal }
    };
    Some([border(cosine), border(-cosine)])
}

fn in_pixels(borders: &[Border; 2], to_pixels: Affine) -> Vec<Chord> {
    let line = |Border { touched, normal }: &Border| {
        let [from, to] = [*touched, *touched + normal.turn_90()].map(|p| to_pixels * p);
        [from, from + (to - from) / (to - from).hypot()]
    };
    borders.iter().map(line).filter(|ends| ends.iter().all(|end| end.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Focal points beside the circle, far and near, strips, circles that shrink; turned and skewed.
    fn patterns() -> Vec<Circles> {
        let circles = [
            ((60.0, 20.0, 0.0), (-50.0, 10.0, 20.0)),
            ((60.0, 20.0, 0.0), (-21.0, 3.0, 20.5)),
            ((20.0, 30.0, 25.0), (30.0, 15.0, 0.0)),
            ((20.0, 30.0, 40.0), (60.0, -20.0, -35.0)),
            ((3575.0, -3490.0, 5000.0), (700.0, 700.0, 0.0)),
        ];
        let turns = [Affine::IDENTITY, Affine::rotate(0.7) * Affine::skew(0.4, 0.0) * Affine::scale(0.8)];
        let all = circles.into_iter().flat_map(|circle| turns.map(|turn| (circle, turn)));
        all.map(|((start, step), turn)| Circles::new(start, step, turn)).collect()
    }

    /// The parameters at places all over a pixel.
    fn all_over(circles: &Circles, centre: Point) -> Vec<Option<f64>> {
        let place = |i: i32| (f64::from(i) + 0.5) / 20.0 - 0.5;
        let places = (0..400).map(|i| centre + Vec2::new(place(i % 20), place(i / 20)));
        places.map(|p| circles.parameter(p)).collect()
    }

    #[test]
    fn rows_have_the_parameters_of_their_pixels_and_bounds_of_what_these_change_by() {
        let most_lift = 1e-3;
        for (i, circles) in patterns().iter().enumerate() {
            let (mut colored, mut clear, mut mixed) = (0, 0, 0);
            for (x, y) in
                (0..40).flat_map(|y| (0..4).map(move |x| (f64::from(x * 40), f64::from(y * 7 - 60))))
            {
                let first = Point::new(x - 60.5, y + 0.5);
                let centre = |i: usize| first + Vec2::new(i as f64, 0.0);
                let mut parameters = [f64::NAN; 40];
                match circles.row(first, (1.0, most_lift), &mut parameters) {
                    Run::Clear { count } => {
                        clear += count;
                        let is_clear = |i: usize| all_over(circles, centre(i)).iter().all(Option::is_none);
                        assert!((0..count).all(is_clear), "{i}: {first}");
                    }
                    Run::Mixed { count } => mixed += count,
                    Run::Colored { count, far } => {
                        colored += count;
                        for (j, &t) in parameters[..count].iter().enumerate() {
                            let exact = circles.parameter(centre(j)).expect("it has colour");
                            assert!((t - exact).abs() < 1e-9 * (1.0 + t.abs()), "{i}: {t}, {exact}");
                            let all = all_over(circles, centre(j));
                            let all: Vec<f64> = all.into_iter().map(|t| t.expect("it has colour")).collect();
                            assert!(all.iter().all(|t| (t - exact).abs() <= far), "{i}: {first} {j}, {far}");
                            let lift = all.iter().map(|t| t - exact).sum::<f64>() / all.len() as f64;
                            assert!(lift.abs() <= 1.02 * most_lift, "{i}: {first} {j}, {lift}");
                        }
                    }
                }
            }
            assert!(colored > 300 && clear + mixed > 0, "{i}: {colored}, {clear}, {mixed}");
        }
    }
}
