//! Takes paint and the set of shapes which cover a place, makes its colour.

use super::clip::Cover;
use super::drawing::{affine, Drawing};
use kurbo::{Affine, Point, Vec2};
use usvg::{Paint, SpreadMethod, Stop};

/// A colour: red, green, blue times alpha, and alpha, each 0..=1, sRGB-encoded.
pub(super) type Colour = [f64; 4];

/// What a shape is painted with.
pub(super) enum Brush {
    Flat(Colour),
    Gradient(Box<Gradient>),
}

/// A gradient, from pixels to colour.
pub(super) struct Gradient {
    /// From pixels to the gradient's own space.
    from_pixels: Affine,
    shape: GradientShape,
    spread: SpreadMethod,
    /// Offset, and straight colour with alpha 0..=1, in order of offset.
    stops: Vec<(f64, [f64; 4])>,
}

enum GradientShape {
    Linear {
        from: Point,
        to: Point,
    },
    /// From the circle around `focus` to the one around `centre`.
    Radial {
        focus: Point,
        focus_radius: f64,
        centre: Point,
        radius: f64,
    },
}

impl Brush {
    /// `None` for a pattern, or a gradient whose space has no area: nothing is painted.
    pub(super) fn new(paint: &Paint, opacity: usvg::Opacity, to_pixels: Affine) -> Option<Brush> {
        let opacity = f64::from(opacity.get());
        let gradient = |base: &usvg::BaseGradient, shape: GradientShape| {
            let transform = to_pixels * affine(base.transform());
            (transform.determinant() != 0.0 && transform.is_finite()).then(|| {
                Brush::Gradient(Box::new(Gradient {
                    from_pixels: transform.inverse(),
                    shape,
                    spread: base.spread_method(),
                    stops: base.stops().iter().map(|stop| straight_stop(stop, opacity)).collect(),
                }))
            })
        };
        let point = |x: f32, y: f32| Point::new(f64::from(x), f64::from(y));
        match paint {
            Paint::Color(c) => {
                let level = |byte: u8| f64::from(byte) / 255.0 * opacity;
                Some(Brush::Flat([level(c.red), level(c.green), level(c.blue), opacity]))
            }
            Paint::LinearGradient(g) => {
                let (from, to) = (point(g.x1(), g.y1()), point(g.x2(), g.y2()));
                gradient(g, GradientShape::Linear { from, to })
            }
            Paint::RadialGradient(g) => gradient(
                g,
                GradientShape::Radial {
                    focus: point(g.fx(), g.fy()),
                    focus_radius: f64::from(g.fr().get()),
                    centre: point(g.cx(), g.cy()),
                    radius: f64::from(g.r().get()),
                },
            ),
            Paint::Pattern(_) => None,
        }
    }

    pub(super) fn is_opaque(&self) -> bool {
        match self {
            Brush::Flat(colour) => colour[3] >= 1.0,
            Brush::Gradient(gradient) => gradient.is_opaque(),
        }
    }

    pub(super) fn is_flat(&self) -> bool {
        matches!(self, Brush::Flat(_))
    }

    fn colour(&self, at: Point) -> Colour {
        match self {
            Brush::Flat(colour) => *colour,
            Brush::Gradient(gradient) => gradient.colour(at),
        }
    }
}

fn straight_stop(stop: &Stop, opacity: f64) -> (f64, [f64; 4]) {
    let c = stop.color();
    let level = |byte: u8| f64::from(byte) / 255.0;
    let alpha = f64::from(stop.opacity().get()) * opacity;
    (f64::from(stop.offset().get()), [level(c.red), level(c.green), level(c.blue), alpha])
}

impl Gradient {
    /// A radial gradient whose circles do not nest leaves part of the plane unpainted.
    fn is_opaque(&self) -> bool {
        let everywhere = match self.shape {
            GradientShape::Linear { .. } => true,
            GradientShape::Radial { focus, focus_radius, centre, radius } => {
                focus.distance(centre) + focus_radius < radius
            }
        };
        everywhere && self.stops.iter().all(|(_, colour)| colour[3] >= 1.0)
    }

    /// The mean over the pixel around `at`: by samples where the colour map turns within it, and
    /// otherwise the colour in its middle.
    fn colour(&self, at: Point) -> Colour {
        /// Samples along one side.
        const SIDE: i32 = 64;
        if !self.turns_around(at) {
            return self.colour_at(at);
        }
        let offset = |i: i32| (f64::from(i) + 0.5) / f64::from(SIDE) - 0.5;
        let mut sum = [0.0; 4];
        for i in 0..SIDE * SIDE {
            let colour = self.colour_at(at + Vec2::new(offset(i % SIDE), offset(i / SIDE)));
            sum.iter_mut().zip(colour).for_each(|(sum, c)| *sum += c);
        }
        sum.map(|sum| sum / f64::from(SIDE * SIDE))
    }

    /// May a stop, an end or a place without colour lie within the pixel around a point?
    fn turns_around(&self, at: Point) -> bool {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (dx, dy) in [(0.0, 0.0), (-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
            let Some(t) = self.shape.offset(self.from_pixels * (at + Vec2::new(dx, dy))) else {
                return true;
            };
            (least, most) = (least.min(t), most.max(t));
        }
        // The middle of a radial gradient may lie anywhere in the pixel.
        let margin = 0.5 * (most - least);
        let (least, most) = (least - margin, most + margin);
        let within = |t: f64| least < t && t < most;
        let period = least.floor();
        match self.spread {
            SpreadMethod::Pad => self.stops.iter().any(|&(offset, _)| within(offset)),
            _ if most > period + 1.0 => true,
            _ => {
                self.stops.iter().any(|&(offset, _)| within(period + offset) || within(period + 1.0 - offset))
            }
        }
    }

    fn colour_at(&self, at: Point) -> Colour {
        let Some(t) = self.shape.offset(self.from_pixels * at) else { return [0.0; 4] };
        let t = match self.spread {
            SpreadMethod::Pad => t.clamp(0.0, 1.0),
            SpreadMethod::Repeat => t.rem_euclid(1.0),
            SpreadMethod::Reflect => 1.0 - (t.rem_euclid(2.0) - 1.0).abs(),
        };
        let after = self.stops.partition_point(|&(offset, _)| offset <= t);
        let [r, g, b, a] = match (after.checked_sub(1).map(|i| self.stops[i]), self.stops.get(after)) {
            (Some((from, below)), Some(&(to, above))) => {
                let part = (t - from) / (to - from);
                std::array::from_fn(|c| below[c] + (above[c] - below[c]) * part)
            }
            (Some((_, only)), None) => only,
            (None, Some(&(_, only))) => only,
            (None, None) => [0.0; 4],
        };
        [r * a, g * a, b * a, a]
    }
}

impl GradientShape {
    /// Where `at` lies between the gradient's start (0) and end (1); `None` where it is not defined.
    fn offset(&self, at: Point) -> Option<f64> {
        match *self {
            GradientShape::Linear { from, to } => {
                let along = to - from;
                let length = along.hypot2();
                // usvg makes a gradient without length flat; here the last colour is as good.
                Some(if length > 0.0 { (at - from).dot(along) / length } else { 1.0 })
            }
            // The circle at t has centre f + t (c - f) and radius a + t (r - a); the largest t whose
            // circle passes through the point, with a radius that is not negative, paints it.
            GradientShape::Radial { focus, focus_radius, centre, radius } => {
                let (d, p, growth) = (centre - focus, at - focus, radius - focus_radius);
                let a = d.hypot2() - growth * growth;
                let half_b = p.dot(d) + focus_radius * growth;
                let c = p.hypot2() - focus_radius * focus_radius;
                let holds = |t: &f64| t.is_finite() && focus_radius + t * growth >= 0.0;
                if a.abs() < 1e-12 * (d.hypot2() + growth * growth) {
                    return Some(c / (2.0 * half_b)).filter(holds);
                }
                let root = half_b * half_b - a * c;
                if root < 0.0 {
                    return None;
                }
                let (one, other) = ((half_b + root.sqrt()) / a, (half_b - root.sqrt()) / a);
                Some(one.max(other)).filter(holds).or(Some(one.min(other)).filter(holds))
            }
        }
    }
}

/// `front` over `back`.
fn over(front: Colour, back: Colour) -> Colour {
    std::array::from_fn(|c| front[c] + back[c] * (1.0 - front[3]))
}

impl Drawing {
    /// The colour of a region: `shapes` (front first) which may cover it, `covers` whether they and
    /// the clip-paths do, `at` (in pixels) where gradients are evaluated.
    pub(super) fn composite(
        &self,
        shapes: &[u32],
        covers: &[Cover],
        at: Point,
        background: Colour,
    ) -> Colour {
        // The groups that are open, each with what lies in it so far.
        let mut open: Vec<(u32, Colour)> = Vec::new();
        let mut base = background;
        for &shape in shapes.iter().rev() {
            if covers[shape as usize] != Cover::Inside || self.clip_cover(shape, covers) != Cover::Inside {
                continue;
            }
            let chain = self.chain(shape);
            while open.last().is_some_and(|&(group, _)| !chain.contains(&group)) {
                self.close_group(&mut open, &mut base);
            }
            for &group in &chain[open.len()..] {
                open.push((group, [0.0; 4]));
            }
            let brush = self.geometries[shape as usize].brush.as_ref().expect("a painted shape");
            let below = open.last_mut().map_or(&mut base, |(_, colour)| colour);
            *below = over(brush.colour(at), *below);
        }
        while !open.is_empty() {
            self.close_group(&mut open, &mut base);
        }
        base
    }

    fn close_group(&self, open: &mut Vec<(u32, Colour)>, base: &mut Colour) {
        let Some((group, colour)) = open.pop() else { return };
        let opacity = self.layers[group as usize].opacity;
        let below = open.last_mut().map_or(base, |(_, colour)| colour);
        *below = over(colour.map(|c| c * opacity), *below);
    }
}

/// An average of colours over areas, in sRGB encoding or in linear light.
pub(super) struct Mixture {
    linear: bool,
    sum: Colour,
}

impl Mixture {
    pub(super) fn new(linear: bool) -> Mixture {
        Mixture { linear, sum: [0.0; 4] }
    }

    pub(super) fn add(&mut self, colour: Colour, area: f64) {
        let colour = if self.linear { per_straight_channel(colour, decode) } else { colour };
        for (sum, channel) in self.sum.iter_mut().zip(colour) {
            *sum += channel * area;
        }
    }

    /// The average in levels 0..=255, sRGB-encoded, premultiplied; the areas must sum to 1.
    pub(super) fn levels(&self) -> [f64; 4] {
        let colour = if self.linear { per_straight_channel(self.sum, encode) } else { self.sum };
        colour.map(|c| c * 255.0)
    }
}

/// Applies `curve` to the colour without its alpha.
fn per_straight_channel(colour: Colour, curve: impl Fn(f64) -> f64) -> Colour {
    let [r, g, b, a] = colour;
    if a <= 0.0 {
        return [0.0; 4];
    }
    [curve(r / a) * a, curve(g / a) * a, curve(b / a) * a, a]
}

/// From sRGB encoding to linear light, 0..=1.
fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// From linear light to sRGB encoding, 0..=1.
fn encode(light: f64) -> f64 {
    if light <= 0.0031308 {
        light * 12.92
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}
