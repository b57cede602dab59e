//! Takes a layer, makes a [`Mask`]: how much of another layer shows, by the first one's luminance or
//! its alpha (CSS Masking 1, section 7.10.1).

use super::layer::{IntRect, Layer, Pixel, Space};

/// What of a layer is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Luminance times alpha, of colours in this space (the mask's `color-interpolation`; usvg
    /// leaves it at SVG's initial value, sRGB).
    Luminance(Space),
    Alpha,
}

impl From<usvg::MaskType> for Kind {
    fn from(kind: usvg::MaskType) -> Kind {
        match kind {
            usvg::MaskType::Luminance => Kind::Luminance(Space::Srgb),
            usvg::MaskType::Alpha => Kind::Alpha,
        }
    }
}

/// How much shows, 0 ..= 1 a pixel; nothing beyond its rectangle.
#[derive(Clone, Debug)]
pub(crate) struct Mask {
    rect: IntRect,
    values: Vec<f32>,
}

/// Red's, green's and blue's shares of luminance, as SVG 1.1's luminanceToAlpha has them.
const SHARES: [f32; 3] = [0.2125, 0.7154, 0.0721];

/// How much of another pixel one of a mask shows.
#[inline]
pub(crate) fn shown(kind: usvg::MaskType, pixel: Pixel) -> f32 {
    match kind {
        usvg::MaskType::Alpha => pixel[3],
        usvg::MaskType::Luminance => luminance(pixel),
    }
}

/// Luminance is linear in the premultiplied components: alpha is in them already.
#[inline]
fn luminance([r, g, b, _]: Pixel) -> f32 {
    (SHARES[0] * r + SHARES[1] * g + SHARES[2] * b).min(1.0)
}

impl Mask {
    pub fn of(layer: Layer, kind: Kind) -> Mask {
        let rect = layer.rect();
        let values = match kind {
            Kind::Alpha => layer.pixels().iter().map(|p| p[3]).collect(),
            Kind::Luminance(space) => {
                layer.into_space(space).pixels().iter().copied().map(luminance).collect()
            }
        };
        Mask { rect, values }
    }

    /// How much shows at column x, row y of the picture.
    #[inline]
    pub fn at(&self, x: i32, y: i32) -> f32 {
        let (column, row) =
            (i64::from(x) - i64::from(self.rect.x()), i64::from(y) - i64::from(self.rect.y()));
        let inside =
            (0..self.rect.width() as i64).contains(&column) && (0..self.rect.height() as i64).contains(&row);
        if inside {
            self.values[row as usize * self.rect.width() + column as usize]
        } else {
            0.0
        }
    }

    /// Only what both masks show.
    pub fn intersect(&mut self, other: &Mask) {
        let rect = self.rect;
        for (i, value) in self.values.iter_mut().enumerate() {
            *value *= other.at(rect.x() + (i % rect.width()) as i32, rect.y() + (i / rect.width()) as i32);
        }
    }

    /// Takes from a layer what the mask does not show.
    pub fn apply(&self, layer: &mut Layer) {
        let rect = layer.rect();
        if rect.is_empty() {
            return;
        }
        for (row, pixels) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let shown = self.at(rect.x() + column as i32, rect.y() + row as i32);
                pixel.iter_mut().for_each(|v| *v *= shown);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer() -> Layer {
        Layer::from_rgba8(
            IntRect::new(2, 3, 2, 2),
            &[255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 102, 128, 128, 128, 255],
        )
    }

    #[test]
    fn white_shows_black_hides_and_alpha_takes_its_share() {
        let mask = Mask::of(layer(), Kind::Luminance(Space::Srgb));
        assert!((mask.at(2, 3) - 1.0).abs() < 1e-6);
        assert_eq!(mask.at(3, 3), 0.0);
        assert!((mask.at(2, 4) - 0.4).abs() < 1e-6);
        assert!((mask.at(3, 4) - 128.0 / 255.0).abs() < 1e-6);
        assert_eq!(mask.at(1, 3), 0.0);
        assert_eq!(mask.at(i32::MIN, i32::MAX), 0.0);
    }

    #[test]
    fn luminance_in_linear_light_is_that_of_the_light() {
        let mask = Mask::of(layer(), Kind::Luminance(Space::Linear));
        assert!((mask.at(3, 4) - 0.2159).abs() < 1e-3);
    }

    #[test]
    fn an_alpha_mask_does_not_look_at_colour() {
        let mask = Mask::of(layer(), Kind::Alpha);
        assert_eq!([mask.at(2, 3), mask.at(3, 3), mask.at(3, 4)], [1.0; 3]);
        let mut masked = layer();
        mask.apply(&mut masked);
        assert!((masked.pixel(2, 4)[3] - 0.16).abs() < 1e-6);
    }

    #[test]
    fn masks_of_masks_multiply() {
        let mut mask = Mask::of(layer(), Kind::Alpha);
        mask.intersect(&Mask::of(layer(), Kind::Luminance(Space::Srgb)));
        assert_eq!(mask.at(3, 3), 0.0);
        assert!((mask.at(2, 4) - 0.16).abs() < 1e-6);
    }
}
