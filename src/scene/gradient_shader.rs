//! Takes a gradient at a picture's scale, makes the colours of rows, of pixels and of parts of them.
//!
//! Its colour over a region is that at the region's centre as long as the colour map goes straight there.
//! Where the map turns or jumps within the region, it is the mean ([`super::color_map`]), for which the
//! parameter is taken to be linear; the circles of a radial gradient are taken so in triangles.

use super::color_map::{ColorMap, Integral};
use super::paint::{Gradient, GradientShape, Sheet, Spread};
use super::shader::sheet_of;
use kurbo::{Affine, Point, Vec2};
use std::sync::OnceLock;

/// A gradient at a picture's scale.
#[derive(Clone, Debug)]
pub(crate) struct GradientShader<'a> {
    gradient: &'a Gradient,
    /// From pixels to the gradient's plane.
    to_plane: Affine,
    /// As [`crate::Settings::spot_scale`].
    spot_scale: f64,
    /// The parameter changes by no more between the centre of the spot and its corners, anywhere.
    farthest: f64,
    /// Below it lie the circles of a radial gradient that are too small to be taken for straight lines in a
    /// pixel.
    apex: f64,
    /// A radial gradient's quadratic coefficient, and its inverse.
    quadratic: (f64, f64),
    /// Made for the first region in which the colour map turns.
    map: OnceLock<ColorMap>,
}

/// A stretch of the parameter, as it is before it is spread, over which straight colours go straight.
#[derive(Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
    /// Where `color` is.
    origin: f64,
    color: [f32; 4],
    /// Change of the colour with the parameter.
    slope: [f32; 4],
    /// At least the second coefficient of any premultiplied component: 0 where alpha stays or colour does.
    bend: f64,
}

/// The square of a length l of the parameter, times the bend, of which a twelfth is what the colour in the
/// middle is off by: a quarter of an 8-bit level.
const MOST_BEND: f64 = 12.0 * 0.25 / 255.0;

impl Stretch {
    #[inline]
    fn at(&self, t: f64) -> Sheet {
        let by = (t - self.origin) as f32;
        let [r, g, b, alpha]: [f32; 4] = std::array::from_fn(|i| self.color[i] + self.slope[i] * by);
        Sheet::new([r, g, b], alpha)
    }

    /// Is the colour in the middle of [from, to] the mean over it?
    #[inline]
    fn holds(&self, from: f64, to: f64) -> bool {
        self.from <= from && to <= self.to && self.bend * (to - from) * (to - from) <= MOST_BEND
    }

    /// At least the change of any premultiplied component with the parameter.
    fn steepness(&self) -> f64 {
        let [r, g, b, alpha] = self.slope.map(f32::abs);
        f64::from(r.max(g).max(b) + alpha)
    }
}

/// The parameter at a point, and its change along x and y, a pixel.
#[derive(Clone, Copy)]
struct Local {
    t: f64,
    along: (f64, f64),
}

/// A radial gradient's mean over a pixel differs from its colour in the middle by the change a pixel over 24
/// times the circle's radius in pixels. At half a pixel from the middle that is half an 8-bit level if the
/// change is this.
const STEEP: f64 = 6.0 / 255.0;
/// Radii in pixels of circles that are too small: of gradients that change by no more than [`STEEP`] a pixel,
/// and of others, where a circle leaves its tangent by 1/64 of a pixel.
const SMALL: f64 = 2.0;
const SMALL_IF_STEEP: f64 = 16.0;

/// The corners of a square of side 1 around its middle.
const CORNERS: [(f64, f64); 4] = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];

/// A gradient whose colours change by no more than this within a pixel is even there. A region that is a
/// share s of the pixel has its centre at most (1 - s) / 2 from the pixel's, so that the pixel's colour is
/// off by at most s (1 - s) / 2 of the change: a quarter of an 8-bit level.
const EVEN: f64 = 2.0 / 255.0;

impl<'a> GradientShader<'a> {
    pub fn new(gradient: &'a Gradient, to_pixels: Affine, spot_scale: f64) -> GradientShader<'a> {
        let to_plane = (to_pixels * gradient.transform).inverse();
        let to_plane = match gradient.shape {
            GradientShape::Linear(map) => map * to_plane,
            GradientShape::Radial { .. } => to_plane,
        };
        let [a, b, c, d, ..] = to_plane.as_coeffs();
        let (farthest, quadratic) = match gradient.shape {
            GradientShape::Linear(_) => (0.5 * (a.abs() + c.abs()), 0.0),
            GradientShape::Radial { step: (dx, dy, dr), .. } => {
                // On a cone that holds its focal circle the parameter is nowhere steeper than where the
                // circles lie closest.
                let closest = dr - dx.hypot(dy);
                let farthest =
                    if closest > 0.0 { 0.5 * (a.hypot(b) + c.hypot(d)) / closest } else { f64::INFINITY };
                (farthest, dx * dx + dy * dy - dr * dr)
            }
        };
        let quadratic = (quadratic, 1.0 / quadratic);
        let (apex, map) = (f64::NEG_INFINITY, OnceLock::new());
        let mut shader = GradientShader {
            gradient,
            to_plane,
            spot_scale,
            farthest: farthest * spot_scale,
            apex,
            quadratic,
            map,
        };
        let smallest = if steepness(gradient) * 2.0 * farthest > STEEP { SMALL_IF_STEEP } else { SMALL };
        shader.apex = shader.with_radius(smallest);
        shader
    }

    /// Does it hide what lies behind, everywhere?
    pub fn is_opaque(&self) -> bool {
        self.gradient.opaque
    }

    /// Did the colour map turn within a pixel?
    pub fn has_table(&self) -> bool {
        self.map.get().is_some()
    }

    /// The colour of the pixel around a point, in pixels; clear where a radial gradient has none.
    pub fn at(&self, x: f64, y: f64) -> Sheet {
        match self.local(x, y) {
            Some(local) => self.pixel((x, y), local, &mut self.stretch(local.t)),
            None => self.least(),
        }
    }

    pub fn even_at(&self, x: f64, y: f64) -> Option<Sheet> {
        let Some(local) = self.local(x, y) else {
            return Some(self.least());
        };
        let (stretch, reach) = (self.stretch(local.t), self.reach(local));
        let is_even = local.t >= self.apex
            && stretch.holds(local.t - reach, local.t + reach)
            && stretch.steepness() * 2.0 * reach <= EVEN;
        is_even.then(|| stretch.at(local.t))
    }

    #[inline]
    pub fn row(&self, x: usize, y: u32, count: usize, mut put: impl FnMut(usize, Sheet)) {
        let y = f64::from(y) + 0.5;
        let mut stretch = self.stretch(0.0);
        if let GradientShape::Linear(_) = self.gradient.shape {
            let [a, _, c, _, e, _] = self.to_plane.as_coeffs();
            let (start, along, reach) = (c * y + e, (a, c), self.farthest);
            let mut i = 0;
            while i < count {
                let at = |i: usize| a * ((x + i) as f64 + 0.5) + start;
                let t = at(i);
                if !stretch.holds(t - reach, t + reach) {
                    put(i, self.pixel(((x + i) as f64 + 0.5, y), Local { t, along }, &mut stretch));
                    i += 1;
                    continue;
                }
                // Pixels until the stretch ends; the cast saturates, and takes NaN to 0.
                let end = if a > 0.0 { stretch.to - reach } else { stretch.from + reach };
                let more = if a == 0.0 { count } else { ((end - t) / a) as usize };
                let next = count.min(i.saturating_add(more.max(1)));
                (i..next).for_each(|i| put(i, stretch.at(at(i))));
                i = next;
            }
            return;
        }
        let slowly = |x: usize, stretch: &mut Stretch| {
            let x = x as f64 + 0.5;
            match self.local(x, y) {
                Some(local) => self.pixel((x, y), local, stretch),
                None => self.least(),
            }
        };
        if self.farthest == f64::INFINITY {
            (0..count).for_each(|i| put(i, slowly(x + i, &mut stretch)));
            return;
        }
        let mut parameters = [0.0; 32];
        for first in (0..count).step_by(parameters.len()) {
            let some = &mut parameters[..(count - first).min(32)];
            self.cone_row((x + first) as f64 + 0.5, y, some);
            for (i, &t) in some.iter().enumerate() {
                // Most pixels are far from where the map turns.
                let i = first + i;
                match t >= self.apex && stretch.holds(t - self.farthest, t + self.farthest) {
                    true => put(i, stretch.at(t)),
                    false => put(i, slowly(x + i, &mut stretch)),
                }
            }
        }
    }

    /// The parameters of pixels from a centre on, of a radial gradient whose cone holds its focal circle:
    /// each point has just one.
    fn cone_row(&self, x: f64, y: f64, parameters: &mut [f64]) {
        let GradientShape::Radial { start: (x0, y0, r0), step: (dx, dy, dr) } = self.gradient.shape else {
            return;
        };
        let [a, b, c, d, e, f] = self.to_plane.as_coeffs();
        let (left, top) = (c * y + e - x0, d * y + f - y0);
        let (quadratic, inverse) = self.quadratic;
        for (i, t) in parameters.iter_mut().enumerate() {
            let x = x + i as f64;
            let (px, py) = (a * x + left, b * x + top);
            let half_b = px * dx + py * dy + r0 * dr;
            let square = half_b * half_b - quadratic * (px * px + py * py - r0 * r0);
            *t = (half_b - square.max(0.0).sqrt()) * inverse;
        }
    }

    /// The colour of a pixel. `stretch` is one that may hold it, and is replaced if it does not.
    fn pixel(&self, (x, y): (f64, f64), local: Local, stretch: &mut Stretch) -> Sheet {
        let reach = self.reach(local);
        let (from, to) = (local.t - reach, local.t + reach);
        if !stretch.holds(from, to) {
            *stretch = self.stretch(local.t);
        }
        if stretch.holds(from, to) && local.t >= self.apex {
            return stretch.at(local.t);
        }
        let at = Point::new(x, y);
        self.mean(local, at, &CORNERS.map(|(dx, dy)| at + self.spot_scale * Vec2::new(dx, dy)))
    }

    /// How far the parameter goes to either side within the spot around a point.
    #[inline]
    fn reach(&self, local: Local) -> f64 {
        0.5 * self.spot_scale * (local.along.0.abs() + local.along.1.abs())
    }

    /// The mean over a convex polygon, by the gradient's slope at the polygon's centre.
    pub fn over(&self, centre: Point, corners: &[Point]) -> Sheet {
        let Some(local) = self.local(centre.x, centre.y) else {
            return self.least();
        };
        let stretch = self.stretch(local.t);
        let parameters = corners.iter().map(|&p| parameter_at(local, centre, p));
        let (from, to) = parameters.fold((local.t, local.t), |(from, to), t| (t.min(from), t.max(to)));
        match stretch.holds(from, to) && local.t >= self.apex {
            true => stretch.at(local.t),
            false => self.mean(local, centre, corners),
        }
    }

    /// The mean over a convex polygon, in triangles that are small where the circles of a radial gradient are.
    #[inline(never)]
    fn mean(&self, local: Local, centre: Point, corners: &[Point]) -> Sheet {
        let map = self.map.get_or_init(|| ColorMap::new(&self.gradient.stops, self.gradient.spread));
        let integral = match self.halvings(local.t) {
            0 => linear_integral(map, local, centre, corners),
            depth => {
                let mut sum = Integral::default();
                for (i, &corner) in corners.iter().enumerate() {
                    let next = corners[(i + 1) % corners.len()];
                    sum.add(self.triangle_integral(map, [centre, corner, next], depth));
                }
                sum
            }
        };
        integral.mean().map_or_else(|| self.stretch(local.t).at(local.t), sheet_of)
    }

    /// How often triangles have to be halved until a circle leaves no straight line in them by more than
    /// 1/512 of a pixel; those around the middle are as small as is worth it.
    fn halvings(&self, t: f64) -> u32 {
        let radii = [64.0, 8.0, 2.0, 0.5];
        radii.into_iter().filter(|&radius| t < self.with_radius(radius)).count() as u32
    }

    /// The parameter of a radial gradient's circle whose radius is at least so many pixels; of others none is
    /// too small.
    fn with_radius(&self, pixels: f64) -> f64 {
        let [a, b, c, d, ..] = self.to_plane.as_coeffs();
        match self.gradient.shape {
            GradientShape::Radial { start: (_, _, r0), step: (_, _, dr) } if dr > 0.0 => {
                (pixels * a.hypot(b).max(c.hypot(d)) - r0) / dr
            }
            _ => f64::NEG_INFINITY,
        }
    }

    fn triangle_integral(&self, map: &ColorMap, corners: [Point; 3], depth: u32) -> Integral {
        let [a, b, c] = corners;
        if depth > 0 {
            let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
            let mut sum = Integral::default();
            for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                sum.add(self.triangle_integral(map, part, depth - 1));
            }
            return sum;
        }
        let centre = Point::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
        // Where there is no colour there is nothing to add but area.
        match self.local(centre.x, centre.y) {
            Some(local) => linear_integral(map, local, centre, &corners),
            None => Integral { area: 0.5 * (b - a).cross(c - a), ..Integral::default() },
        }
    }

    /// A sheet that lets no less light through than the gradient does anywhere.
    pub fn least(&self) -> Sheet {
        if self.gradient.opaque {
            let [r, g, b, _] = self.gradient.stops[self.gradient.stops.len() - 1].color;
            Sheet::new([r, g, b], 1.0)
        } else {
            Sheet::CLEAR
        }
    }

    /// The stretch around a parameter.
    fn stretch(&self, t: f64) -> Stretch {
        let period = t.floor();
        let (first, backwards) = match self.gradient.spread {
            Spread::Pad => return self.stretch_within(t),
            Spread::Repeat => (period, false),
            Spread::Reflect => (period, period % 2.0 != 0.0),
        };
        let within = if backwards { 1.0 - (t - first) } else { t - first };
        let inner = self.stretch_within(within);
        let (from, to) = (inner.from.max(0.0), inner.to.min(1.0));
        match backwards {
            false => Stretch { from: first + from, to: first + to, origin: first + inner.origin, ..inner },
            true => {
                let back = |t: f64| first + 1.0 - t;
                let slope = inner.slope.map(|v| -v);
                Stretch { from: back(to), to: back(from), origin: back(inner.origin), slope, ..inner }
            }
        }
    }

    /// The same without a spread: the ends go on for ever.
    fn stretch_within(&self, t: f64) -> Stretch {
        let stops = &self.gradient.stops;
        let behind = stops.partition_point(|stop| f64::from(stop.offset) <= t);
        let from = behind.checked_sub(1).map(|i| stops[i]);
        let flat =
            |from: f64, to: f64, color| Stretch { from, to, origin: 0.0, color, slope: [0.0; 4], bend: 0.0 };
        match (from, stops.get(behind)) {
            (Some(a), Some(b)) => {
                let length = b.offset - a.offset;
                let slope: [f32; 4] = std::array::from_fn(|i| (b.color[i] - a.color[i]) / length);
                let (from, to) = (f64::from(a.offset), f64::from(b.offset));
                let [red, green, blue, alpha] = slope.map(|v| f64::from(v).abs());
                let bend = red.max(green).max(blue) * alpha;
                Stretch { from, to, origin: from, color: a.color, slope, bend }
            }
            (Some(last), None) => flat(f64::from(last.offset), f64::INFINITY, last.color),
            (None, Some(first)) => flat(f64::NEG_INFINITY, f64::from(first.offset), first.color),
            (None, None) => flat(f64::NEG_INFINITY, f64::INFINITY, [0.0; 4]),
        }
    }

    /// What the parameter is and does at a point in pixels: for circles the greatest t with a radius of at
    /// least 0 whose circle passes through the point (SVG 2, 14.2.3; HTML canvas).
    #[inline]
    fn local(&self, x: f64, y: f64) -> Option<Local> {
        let [a, b, c, d, ..] = self.to_plane.as_coeffs();
        let p = self.to_plane * Point::new(x, y);
        let GradientShape::Radial { start: (x0, y0, _), step: (dx, dy, _) } = self.gradient.shape else {
            return p.x.is_finite().then_some(Local { t: p.x, along: (a, c) });
        };
        let (t, root) = self.circle(p)?;
        // With u from the circle's centre to the point and the circle's radius R, |u| = R: differentiated,
        // the parameter's slope is u / root.
        let (ux, uy) = (p.x - x0 - t * dx, p.y - y0 - t * dy);
        let along = ((ux * a + uy * b) / root, (ux * c + uy * d) / root);
        // Next to the focal point the slope is nothing to go by.
        let pixel = a * a + b * b + c * c + d * d;
        if ux * ux + uy * uy > pixel && along.0.is_finite() && along.1.is_finite() {
            return Some(Local { t, along });
        }
        let step = |dx: f64, dy: f64| {
            let there = self.circle(self.to_plane * Point::new(x + dx, y + dy));
            2.0 * (there.map_or(t, |(t, _)| t) - t)
        };
        Some(Local { t, along: (step(0.5, 0.0), step(0.0, 0.5)) })
    }

    /// The parameter of the circle through a point of the gradient's plane, and what its slope is to be
    /// divided by.
    #[inline]
    fn circle(&self, p: Point) -> Option<(f64, f64)> {
        let GradientShape::Radial { start: (x0, y0, r0), step: (dx, dy, dr) } = self.gradient.shape else {
            return None;
        };
        // |p - start - t (dx, dy)| = r0 + t dr
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

/// The greatest change of colour with the parameter, all components together, but for hard stops, which are
/// edges.
fn steepness(gradient: &Gradient) -> f64 {
    let slopes = gradient.stops.windows(2).filter(|pair| pair[0].offset < pair[1].offset);
    let steepness = slopes.map(|pair| {
        let change = pair[0].color.iter().zip(pair[1].color).map(|(a, b)| (a - b).abs());
        f64::from(change.sum::<f32>() / (pair[1].offset - pair[0].offset))
    });
    steepness.fold(0.0, f64::max)
}

/// Over a polygon on which the parameter is linear.
fn linear_integral(map: &ColorMap, local: Local, centre: Point, corners: &[Point]) -> Integral {
    let (along_x, along_y) = local.along;
    let square = along_x * along_x + along_y * along_y;
    map.over(corners.iter().map(|&p| {
        let across = (along_x * (p.y - centre.y) - along_y * (p.x - centre.x)) / square;
        (parameter_at(local, centre, p), across)
    }))
}

#[inline]
fn parameter_at(local: Local, centre: Point, p: Point) -> f64 {
    local.t + local.along.0 * (p.x - centre.x) + local.along.1 * (p.y - centre.y)
}
