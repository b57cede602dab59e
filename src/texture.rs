//! Takes an image and a transform, makes a layer: each pixel is the mean of the image over the pixel's
//! footprint, or lies between four samples where the image is enlarged.
//!
//! The mean comes from a summed-area table (Crow 1984, *Summed-Area Tables for Texture Mapping*): the
//! box around the pixel's parallelogram in the image costs four look-ups, however large it is. The
//! table is made only for images that are made smaller.

use crate::effects::layer::{between, IntRect, Layer, Pixel, Space, CLEAR};
use kurbo::{Affine, Point};

/// Draws `image`, whose pixels are unit squares from the origin on, over a rectangle. Beyond its edges
/// the image goes on as it ends.
pub(crate) fn drawn(image: &Layer, to_pixels: Affine, rect: IntRect, nearest: bool) -> Layer {
    let mut layer = Layer::clear(rect, Space::Srgb);
    if to_pixels.determinant() == 0.0 || !to_pixels.is_finite() || image.rect().is_empty() {
        return layer;
    }
    let back = to_pixels.inverse();
    let [a, b, c, d, ..] = back.as_coeffs();
    // The box around a pixel's footprint, in the image's pixels.
    let (width, height) = (a.abs() + c.abs(), b.abs() + d.abs());
    let table = (!nearest && width.max(height) > 1.0).then(|| SummedArea::of(image));
    for (i, pixel) in layer.pixels_mut().iter_mut().enumerate() {
        let (column, row) = (i % rect.width(), i / rect.width());
        let x = f64::from(rect.x()) + column as f64 + 0.5;
        let at = back * Point::new(x, f64::from(rect.y()) + row as f64 + 0.5);
        *pixel = match &table {
            Some(table) => table.mean(at, width.max(1.0), height.max(1.0)),
            None if nearest => clamped(image, at.x.floor(), at.y.floor()),
            None => between(at.x - 0.5, at.y - 0.5, |x, y| clamped(image, x, y)),
        };
    }
    layer
}

/// The image's pixel, or its nearest.
fn clamped(image: &Layer, x: f64, y: f64) -> Pixel {
    let last = |size: usize| (size - 1) as f64;
    let x = x.clamp(0.0, last(image.rect().width()));
    let y = y.clamp(0.0, last(image.rect().height()));
    image.pixel(x as i32, y as i32)
}

/// Of each corner of a pixel, the sum of all pixels above and left of it.
struct SummedArea {
    width: usize,
    height: usize,
    sums: Vec<[f64; 4]>,
}

impl SummedArea {
    fn of(image: &Layer) -> SummedArea {
        let (width, height) = (image.rect().width(), image.rect().height());
        let mut sums = vec![[0.0; 4]; (width + 1) * (height + 1)];
        for (y, pixels) in image.pixels().chunks_exact(width).enumerate() {
            let mut row = [0.0f64; 4];
            for (x, pixel) in pixels.iter().enumerate() {
                let above = sums[y * (width + 1) + x + 1];
                row.iter_mut().zip(pixel).for_each(|(sum, &v)| *sum += f64::from(v));
                sums[(y + 1) * (width + 1) + x + 1] = std::array::from_fn(|i| above[i] + row[i]);
            }
        }
        SummedArea { width, height, sums }
    }

    /// The mean over a box around a point, as far as it lies in the image.
    fn mean(&self, at: Point, width: f64, height: f64) -> Pixel {
        let (right_end, bottom_end) = (self.width as f64, self.height as f64);
        // At least one pixel of the image, so that its edge goes on.
        let left = (at.x - 0.5 * width).clamp(0.0, right_end - 1.0);
        let top = (at.y - 0.5 * height).clamp(0.0, bottom_end - 1.0);
        let right = (at.x + 0.5 * width).clamp(left + 1.0, right_end);
        let bottom = (at.y + 0.5 * height).clamp(top + 1.0, bottom_end);
        let area = (right - left) * (bottom - top);
        if area.is_nan() || area <= 0.0 {
            return CLEAR;
        }
        let (one, two) = (self.sum(left, top), self.sum(right, top));
        let (three, four) = (self.sum(left, bottom), self.sum(right, bottom));
        std::array::from_fn(|i| ((four[i] - two[i] - three[i] + one[i]) / area) as f32)
    }

    /// The table between its corners.
    fn sum(&self, x: f64, y: f64) -> [f64; 4] {
        let (column, row) = ((x as usize).min(self.width - 1), (y as usize).min(self.height - 1));
        let (right, below) = (x - column as f64, y - row as f64);
        let at = |dx: usize, dy: usize| self.sums[(row + dy) * (self.width + 1) + column + dx];
        let (one, two, three, four) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        std::array::from_fn(|i| {
            let upper = one[i] + (two[i] - one[i]) * right;
            let lower = three[i] + (four[i] - three[i]) * right;
            upper + (lower - upper) * below
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of black and white.
    fn columns(width: u32, height: u32) -> Layer {
        let pixel = |i: u32| if i.is_multiple_of(2) { [255, 255, 255, 255] } else { [0, 0, 0, 255] };
        let bytes: Vec<u8> = (0..height).flat_map(|_| (0..width).flat_map(pixel)).collect();
        Layer::from_rgba8(IntRect::new(0, 0, width, height), &bytes)
    }

    #[test]
    fn an_image_at_its_own_size_is_itself() {
        let image = columns(6, 4);
        assert_eq!(drawn(&image, Affine::IDENTITY, image.rect(), false), image);
        assert_eq!(drawn(&image, Affine::IDENTITY, image.rect(), true), image);
    }

    #[test]
    fn stripes_finer_than_a_pixel_are_their_mean() {
        let image = columns(64, 64);
        let small = drawn(&image, Affine::scale(0.125), IntRect::new(0, 0, 8, 8), false);
        for pixel in small.pixels() {
            assert!((pixel[0] - 0.5).abs() < 1e-6, "{pixel:?}");
        }
        // Also where the footprint holds no whole number of stripes: no beat is left in the middle.
        let odd = drawn(&image, Affine::scale(0.03), IntRect::new(0, 0, 2, 2), false);
        assert!((odd.pixel(0, 0)[0] - 0.5).abs() < 0.02, "{:?}", odd.pixel(0, 0));
    }

    #[test]
    fn an_enlarged_image_lies_between_its_samples_or_repeats_them() {
        let image = columns(2, 1);
        let smooth = drawn(&image, Affine::scale(4.0), IntRect::new(0, 0, 8, 4), false);
        assert_eq!(smooth.pixel(0, 0)[0], 1.0);
        assert!((smooth.pixel(3, 1)[0] - 0.625).abs() < 1e-6);
        let jagged = drawn(&image, Affine::scale(4.0), IntRect::new(0, 0, 8, 4), true);
        assert_eq!((jagged.pixel(3, 1)[0], jagged.pixel(4, 1)[0]), (1.0, 0.0));
    }
}
