//! Takes a paint that differs from place to place, at a picture's scale, makes colours: of a row of
//! pixels, of one pixel, or of a part of one.

use super::gradient_shader::{Chord, GradientShader, LeftOut};
use super::paint::Sheet;
use crate::effects::layer::{Layer, Pixel, CLEAR};
use kurbo::Point;
use std::sync::Arc;

/// A paint at a picture's scale.
#[derive(Clone, Debug)]
pub(crate) enum Shader<'a> {
    Gradient(Box<GradientShader<'a>>),
    /// A layer, moved by whole pixels; does it hide all that lies behind it?
    Layer {
        layer: Arc<Layer>,
        by: (i32, i32),
        opaque: bool,
    },
    /// A layer that repeats over the plane.
    Tile {
        layer: Layer,
        opaque: bool,
    },
}

/// A part of a pixel.
#[derive(Clone, Copy)]
pub(crate) enum Spot<'a> {
    /// All of the pixel around this point, in pixels.
    Pixel(f64, f64),
    /// A convex polygon around its centre of gravity, both in pixels.
    Polygon(Point, &'a [Point]),
}

impl Shader<'_> {
    /// The colour of the pixel around a point, in pixels.
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> Sheet {
        match self {
            Shader::Gradient(gradient) => gradient.at(x, y),
            Shader::Layer { layer, by, .. } => {
                sheet_of(layer.pixel(x.floor() as i32 - by.0, y.floor() as i32 - by.1))
            }
            Shader::Tile { layer, .. } => {
                let mut pixel = CLEAR;
                repeated(layer, x.floor() as i32, y.floor() as i32, 1, |_, found| pixel = found);
                sheet_of(pixel)
            }
        }
    }

    /// Does it hide what lies behind, everywhere?
    pub fn is_opaque(&self) -> bool {
        match self {
            Shader::Gradient(gradient) => gradient.is_opaque(),
            Shader::Layer { opaque, .. } | Shader::Tile { opaque, .. } => *opaque,
        }
    }

    /// The mean colour over a part of a pixel.
    pub fn over(&self, spot: Spot) -> Sheet {
        match (self, spot) {
            (Shader::Gradient(gradient), Spot::Polygon(centre, corners)) => gradient.over(centre, corners),
            (_, Spot::Pixel(x, y) | Spot::Polygon(Point { x, y }, _)) => self.at(x, y),
        }
    }

    /// The colour of the pixel around a point, if what part of it is seen makes no visible difference.
    pub fn even_at(&self, x: f64, y: f64) -> Option<Sheet> {
        match self {
            Shader::Gradient(gradient) => gradient.even_at(x, y),
            Shader::Layer { .. } | Shader::Tile { .. } => Some(self.at(x, y)),
        }
    }

    /// Gives `put` the colours of up to 64 pixels of row `y` from column `x` on, each with its place among them, and
    /// returns those left out. `picture` has the same pixels, if nothing lies before them, and may be given opaque
    /// ones.
    #[inline]
    pub fn row(
        &self,
        (x, y): (usize, u32),
        count: usize,
        picture: Option<&mut [[u8; 4]]>,
        mut put: impl FnMut(usize, Sheet),
    ) -> LeftOut {
        match self {
            Shader::Gradient(gradient) => gradient.row((x, y), count, picture, put),
            Shader::Layer { layer, by, .. } => {
                layer.row(x as i32 - by.0, y as i32 - by.1, count, |i, pixel| put(i, sheet_of(pixel)));
                LeftOut::default()
            }
            Shader::Tile { layer, .. } => {
                repeated(layer, x as i32, y as i32, count, |i, pixel| put(i, sheet_of(pixel)));
                LeftOut::default()
            }
        }
    }

    /// Adds chords between which the colours change little in the pixel around a point.
    pub fn cut(&self, centre: Point, chords: &mut Vec<Chord>) {
        if let Shader::Gradient(gradient) = self {
            gradient.cut(centre, chords);
        }
    }

    /// The colours of pixels of row `y` from column `x` on, of a paint that hides what lies behind.
    #[inline]
    pub fn write_row(&self, x: usize, y: u32, pixels: &mut [[u8; 4]]) {
        match self {
            Shader::Gradient(gradient) => gradient.write_row(x, y, pixels),
            Shader::Layer { .. } | Shader::Tile { .. } => {
                self.row((x, y), pixels.len(), None, |i, sheet| pixels[i] = sheet.to_rgba8());
            }
        }
    }

    pub fn as_gradient(&self) -> Option<&GradientShader<'_>> {
        match self {
            Shader::Gradient(gradient) => Some(gradient),
            Shader::Layer { .. } | Shader::Tile { .. } => None,
        }
    }

    /// A sheet that lets no less light through than the paint does anywhere.
    pub fn least(&self) -> Sheet {
        match self {
            Shader::Gradient(gradient) => gradient.least(),
            Shader::Layer { opaque, .. } | Shader::Tile { opaque, .. } => match opaque {
                true => Sheet::new([0.0; 3], 1.0),
                false => Sheet::CLEAR,
            },
        }
    }
}

/// Gives `put` the pixels of row `y` from column `x` on of a layer that repeats.
#[inline]
fn repeated(layer: &Layer, x: i32, y: i32, count: usize, mut put: impl FnMut(usize, Pixel)) {
    let rect = layer.rect();
    let row = (y - rect.y()).rem_euclid(rect.height() as i32) as usize;
    let mut column = (x - rect.x()).rem_euclid(rect.width() as i32) as usize;
    let pixels = &layer.pixels()[row * rect.width()..][..rect.width()];
    for i in 0..count {
        put(i, pixels[column]);
        column = if column + 1 == pixels.len() { 0 } else { column + 1 };
    }
}

#[inline]
pub(super) fn sheet_of([r, g, b, alpha]: [f32; 4]) -> Sheet {
    Sheet::from_channels([r, g, b, 1.0 - alpha])
}
