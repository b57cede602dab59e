//! Takes paint and the set of shapes which cover a place, makes its colour.

use super::blend::blended;
use super::clip::Cover;
use super::drawing::{Drawing, Role};
use super::gradient::{Gradient, GradientShape};
use super::Colour;
use kurbo::{Affine, Point};
use usvg::{BlendMode, MaskType, Paint};

/// What a shape is painted with.
pub(super) enum Brush {
    Flat(Colour),
    Gradient(Box<Gradient>),
}

impl Brush {
    /// `None` for a gradient whose space has no area, which paints nothing, and for a pattern, which is
    /// shapes of its own.
    pub(super) fn new(paint: &Paint, opacity: usvg::Opacity, to_pixels: Affine) -> Option<Brush> {
        let opacity = f64::from(opacity.get());
        let gradient = |base: &usvg::BaseGradient, shape: GradientShape| {
            Gradient::new(base, shape, opacity, to_pixels).map(|made| Brush::Gradient(Box::new(made)))
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

    pub(super) fn gradient(&self) -> Option<&Gradient> {
        match self {
            Brush::Flat(_) => None,
            Brush::Gradient(gradient) => Some(gradient),
        }
    }

    fn colour(&self, at: Point) -> Colour {
        match self {
            Brush::Flat(colour) => *colour,
            Brush::Gradient(gradient) => gradient.colour_at(at),
        }
    }
}

/// `front` over `back`.
fn over(front: Colour, back: Colour) -> Colour {
    std::array::from_fn(|c| front[c] + back[c] * (1.0 - front[3]))
}

/// A group with what lies in it so far.
struct Open {
    layer: u32,
    colour: Colour,
    /// How much its mask shows, which is drawn last.
    shown: f64,
}

impl Drawing {
    /// Those of `shapes` which cover a region of which `covers` gives each geometry's standing.
    pub(super) fn covering(&self, shapes: &[u32], covers: &[Cover]) -> Vec<u32> {
        let inside = |shape: u32| {
            covers[shape as usize] == Cover::Inside && self.clip_cover(shape, covers) == Cover::Inside
        };
        shapes.iter().copied().filter(|&shape| inside(shape)).collect()
    }

    /// The colour at a point (in pixels) which `shapes` cover, the front first.
    pub(super) fn composite(&self, shapes: &[u32], at: Point, background: Colour) -> Colour {
        let mut open: Vec<Open> = Vec::new();
        let mut base = background;
        for &shape in shapes.iter().rev() {
            let chain = self.chain(shape);
            while open.last().is_some_and(|group| !chain.contains(&group.layer)) {
                self.close_group(&mut open, &mut base);
            }
            for &layer in &chain[open.len()..] {
                open.push(Open { layer, colour: [0.0; 4], shown: 0.0 });
            }
            let brush = self.geometries[shape as usize].brush.as_ref().expect("a painted shape");
            let below = open.last_mut().map_or(&mut base, |group| &mut group.colour);
            *below = over(brush.colour(at), *below);
        }
        while !open.is_empty() {
            self.close_group(&mut open, &mut base);
        }
        base
    }

    fn close_group(&self, open: &mut Vec<Open>, base: &mut Colour) {
        let Some(Open { layer, colour, shown }) = open.pop() else { return };
        let layer = &self.layers[layer as usize];
        let shown = layer.opacity * if layer.is_masked { shown } else { 1.0 };
        let colour = colour.map(|c| c * shown);
        match (layer.role, open.last_mut()) {
            (Role::Mask(kind), Some(masked)) => masked.shown = shown_by(kind, colour),
            (Role::Mask(_), None) => unreachable!("a mask lies in the group that it masks"),
            (Role::Content(mode), below) => {
                let below = below.map_or(base, |group| &mut group.colour);
                *below = match mode {
                    BlendMode::Normal => over(colour, *below),
                    _ => blended(mode, colour, *below),
                };
            }
        }
    }
}

/// How much a colour of a mask shows (CSS Masking 1, 7.10.1; the shares of SVG 1.1's luminanceToAlpha).
fn shown_by(kind: MaskType, [r, g, b, a]: Colour) -> f64 {
    match kind {
        MaskType::Alpha => a,
        MaskType::Luminance => 0.2125 * r + 0.7154 * g + 0.0721 * b,
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
        self.add_integral(light_of(self.linear, colour).map(|c| c * area));
    }

    /// What [`light_of`] has summed up to over an area.
    pub(super) fn add_integral(&mut self, integral: Colour) {
        self.sum.iter_mut().zip(integral).for_each(|(sum, channel)| *sum += channel);
    }

    /// The average in levels 0..=255, sRGB-encoded, premultiplied; the areas must sum to 1.
    pub(super) fn levels(&self) -> [f64; 4] {
        let colour = if self.linear { per_straight_channel(self.sum, encode) } else { self.sum };
        colour.map(|c| c * 255.0)
    }
}

/// A colour as it is mixed with others.
pub(super) fn light_of(linear: bool, colour: Colour) -> Colour {
    if linear {
        per_straight_channel(colour, decode)
    } else {
        colour
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
