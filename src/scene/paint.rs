//! What a shape is painted with, and what colours are in the renderer.
//!
//! Colours in the renderer are [`Sheet`]s: premultiplied and sRGB-encoded, with the share of light
//! that still passes in place of alpha, so that sheets compose front to back.

use super::raster::Raster;
use crate::effects::layer::Layer;
use kurbo::Affine;
use std::sync::Arc;

/// A uniform sheet of colour: what it adds, and how much of what lies behind still shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sheet {
    /// Premultiplied red, green, blue, sRGB-encoded, and transmittance (1 - alpha), all 0 ..= 1.
    channels: [f32; 4],
}

impl Sheet {
    /// Nothing at all.
    pub const CLEAR: Sheet = Sheet { channels: [0.0, 0.0, 0.0, 1.0] };

    /// From straight colour, all 0 ..= 1.
    pub fn new([r, g, b]: [f32; 3], alpha: f32) -> Sheet {
        Sheet { channels: [r * alpha, g * alpha, b * alpha, 1.0 - alpha] }
    }

    /// From premultiplied red, green, blue, and transmittance.
    #[inline]
    pub fn from_channels(channels: [f32; 4]) -> Sheet {
        Sheet { channels }
    }

    /// Premultiplied red, green, blue, and transmittance.
    #[inline]
    pub fn channels(self) -> [f32; 4] {
        self.channels
    }

    /// The share of light from behind that still shows.
    #[inline]
    pub fn through(self) -> f32 {
        self.channels[3]
    }

    /// This sheet in front of another (Porter & Duff's `over`).
    #[inline]
    pub fn over(self, behind: Sheet) -> Sheet {
        // One formula for all four, so that it can be one vector operation: of transmittances,
        // t + t (u - 1) is their product.
        const CLEAR: [f32; 4] = Sheet::CLEAR.channels;
        let through = self.through();
        let channel = |i: usize| self.channels[i] + through * (behind.channels[i] - CLEAR[i]);
        Sheet { channels: std::array::from_fn(channel) }
    }

    /// Bit by bit.
    #[inline]
    pub fn is_same(self, other: Sheet) -> bool {
        // All four at once.
        let differing = |i: usize| self.channels[i].to_bits() ^ other.channels[i].to_bits();
        (0..4).fold(0, |any, i| any | differing(i)) == 0
    }

    /// This sheet at less opacity.
    #[inline]
    pub fn faded(self, opacity: f32) -> Sheet {
        let [r, g, b, through] = self.channels;
        Sheet { channels: [r * opacity, g * opacity, b * opacity, 1.0 - opacity * (1.0 - through)] }
    }

    #[inline]
    pub fn is_opaque(self) -> bool {
        self.through() <= 0.0
    }

    /// The channels to 22 binary digits: sums of their multiples by parts of a pixel's area are exact.
    #[inline]
    pub fn rounded_channels(self) -> [f32; 4] {
        // Between 2 and 4 a float has 22 digits behind the point.
        self.channels.map(|v| (v + 2.0) - 2.0)
    }

    /// Straight 8-bit RGBA; a clear sheet is all 0. One half of a level is rounded up, and so is what may be one but
    /// for the rounding of floats: a colour is the same whether it was summed up in parts or not.
    #[inline]
    pub fn to_rgba8(self) -> [u8; 4] {
        const HALF: f32 = 0.5 + 1.0 / 1024.0;
        let bytes = |channels: [f32; 4]| channels.map(|v| (v * 255.0 + HALF) as u8);
        let [r, g, b, through] = self.rounded_channels();
        let alpha = 1.0 - through;
        if alpha <= 0.0 {
            return [0; 4];
        }
        if alpha == 1.0 {
            return bytes([r, g, b, alpha]);
        }
        bytes([r / alpha, g / alpha, b / alpha, alpha])
    }

    /// The same colour in linear light, still premultiplied.
    pub fn to_linear(self) -> Sheet {
        self.recoded(linear_of_srgb)
    }

    /// The inverse of [`Sheet::to_linear`].
    // Apart, so that the way without it keeps all channels in one vector.
    #[inline(never)]
    pub fn to_srgb(self) -> Sheet {
        self.recoded(srgb_of_linear)
    }

    fn recoded(self, code: fn(f32) -> f32) -> Sheet {
        let alpha = 1.0 - self.through();
        if alpha <= 0.0 {
            return self;
        }
        let [r, g, b, through] = self.channels;
        let [r, g, b] = [r, g, b].map(|c| code(c / alpha) * alpha);
        Sheet { channels: [r, g, b, through] }
    }
}

/// IEC 61966-2-1; `libm`'s power is the same on every machine, the platform's is not.
fn linear_of_srgb(v: f32) -> f32 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        libm::powf((v + 0.055) / 1.055, 2.4)
    }
}

fn srgb_of_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 {
        v * 12.92
    } else {
        1.055 * libm::powf(v, 1.0 / 2.4) - 0.055
    }
}

/// What a shape is painted with.
#[derive(Clone, Debug)]
pub(crate) enum Paint {
    Flat(Sheet),
    Gradient(Box<Gradient>),
    Raster(Arc<Raster>),
    /// A raster that is made already, moved by whole pixels into the picture.
    Layer(Arc<Layer>, (i32, i32)),
}

impl Paint {
    /// One colour.
    pub fn flat(color: usvg::Color, opacity: f32) -> Paint {
        Paint::Flat(Sheet::new(unit_rgb(color), opacity))
    }

    /// Does nothing of it show?
    pub fn is_invisible(&self) -> bool {
        match self {
            Paint::Flat(sheet) => sheet.through() >= 1.0,
            Paint::Gradient(gradient) => gradient.stops.iter().all(|stop| stop.color[3] <= 0.0),
            Paint::Raster(raster) => raster.opacity <= 0.0,
            Paint::Layer(..) => false,
        }
    }

    /// Does it hide what lies behind, everywhere?
    pub fn is_opaque(&self) -> bool {
        match self {
            Paint::Flat(sheet) => sheet.is_opaque(),
            Paint::Gradient(gradient) => gradient.opaque,
            Paint::Raster(_) | Paint::Layer(..) => false,
        }
    }

    /// Moves what it looks like with the shape.
    pub fn transform(&mut self, by: Affine) {
        match self {
            Paint::Flat(_) => {}
            Paint::Gradient(gradient) => gradient.transform = by * gradient.transform,
            Paint::Raster(raster) => {
                let raster = Arc::make_mut(raster);
                raster.transform = by * raster.transform;
            }
            Paint::Layer(..) => unreachable!("layers lie where their pixels are"),
        }
    }

    /// Takes away opacity.
    pub fn fade(&mut self, opacity: f32) {
        match self {
            Paint::Flat(sheet) => *sheet = sheet.faded(opacity),
            Paint::Gradient(gradient) => {
                gradient.stops.iter_mut().for_each(|stop| stop.color[3] *= opacity);
                gradient.opaque = false;
            }
            Paint::Raster(raster) => Arc::make_mut(raster).opacity *= opacity,
            Paint::Layer(..) => unreachable!("layers are made of what has faded"),
        }
    }
}

fn unit_rgb(color: usvg::Color) -> [f32; 3] {
    [color.red, color.green, color.blue].map(|c| f32::from(c) / 255.0)
}

/// What lies beyond a gradient's ends.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spread {
    Pad,
    Reflect,
    Repeat,
}

/// A colour at a place on the gradient.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// 0 ..= 1, never falling.
    pub offset: f32,
    /// Straight red, green, blue, alpha, 0 ..= 1: SVG interpolates before premultiplying.
    pub color: [f32; 4],
}

impl Stop {
    pub fn new(offset: f32, color: usvg::Color, opacity: f32) -> Stop {
        let [r, g, b] = unit_rgb(color);
        Stop { offset, color: [r, g, b, opacity] }
    }
}

/// The function from a point of the gradient's plane to its parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) enum GradientShape {
    /// The parameter is x.
    Linear(Affine),
    /// The circle (centre, radius) at parameter 0, and the steps from it to the one at 1.
    Radial { start: (f64, f64, f64), step: (f64, f64, f64) },
}

impl GradientShape {
    /// 0 at `from`, 1 at `to`.
    pub fn linear(from: (f64, f64), to: (f64, f64)) -> GradientShape {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let square = dx * dx + dy * dy;
        // x' = ((x - from.x) dx + (y - from.y) dy) / square; y' is not looked at.
        GradientShape::Linear(Affine::new([
            dx / square,
            0.0,
            dy / square,
            0.0,
            -(from.0 * dx + from.1 * dy) / square,
            0.0,
        ]))
    }

    /// 0 on the focal circle, 1 on the outer one; each is x, y, radius.
    pub fn radial(focal: (f64, f64, f64), outer: (f64, f64, f64)) -> GradientShape {
        GradientShape::Radial {
            start: focal,
            step: (outer.0 - focal.0, outer.1 - focal.1, outer.2 - focal.2),
        }
    }
}

/// A pattern function and a colour map.
#[derive(Clone, Debug)]
pub(crate) struct Gradient {
    pub shape: GradientShape,
    pub spread: Spread,
    pub stops: Vec<Stop>,
    /// From the gradient's plane to the scene's user units.
    pub transform: Affine,
    pub opaque: bool,
}

impl Gradient {
    /// `None` when the transform has no inverse; a gradient without extent is its last colour.
    pub fn paint(shape: GradientShape, spread: Spread, stops: Vec<Stop>, transform: Affine) -> Option<Paint> {
        let last = *stops.last()?;
        if transform.determinant() == 0.0 || !transform.is_finite() {
            return None;
        }
        let [r, g, b, alpha] = last.color;
        if matches!(shape, GradientShape::Linear(map) if !map.is_finite()) {
            return Some(Paint::Flat(Sheet::new([r, g, b], alpha)));
        }
        // A cone that its focal circle does not lie within leaves points without colour.
        let covers = match shape {
            GradientShape::Linear(_) => true,
            GradientShape::Radial { step: (dx, dy, dr), .. } => dx.hypot(dy) < dr,
        };
        let opaque = covers && stops.iter().all(|stop| stop.color[3] >= 1.0);
        Some(Paint::Gradient(Box::new(Gradient { shape, spread, stops, transform, opaque })))
    }
}
