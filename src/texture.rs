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
    let table =
        (!nearest && width.max(height) > 1.0).then(|| SummedArea::of(image, block(image, width.min(height))));
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

/// Pixels of an image from which on its table is of blocks of pixels, if the footprint holds some.
const LARGE: u64 = 1 << 22;
/// Blocks along the footprint's shorter side, at least.
const BLOCKS: f64 = 8.0;

/// The side of a table's blocks: what the pixels of a large image share of a small picture's.
fn block(image: &Layer, footprint: f64) -> usize {
    match image.rect().area() < LARGE {
        true => 1,
        false => (footprint / BLOCKS).max(1.0) as usize,
    }
}

/// Of each corner of a block of pixels, the sum of all pixels above and left of it.
struct SummedArea {
    width: usize,
    height: usize,
    /// Side of the blocks; the last ones may be cut off.
    block: usize,
    /// Corners in a row.
    corners: usize,
    sums: Vec<[f64; 4]>,
}

impl SummedArea {
    fn of(image: &Layer, block: usize) -> SummedArea {
        let (width, height) = (image.rect().width(), image.rect().height());
        let corners = width.div_ceil(block) + 1;
        let mut sums = vec![[0.0; 4]; corners];
        for rows in image.pixels().chunks(width * block) {
            let above = sums.len() - corners;
            let mut columns = vec![[0.0f64; 4]; corners];
            for pixels in rows.chunks_exact(width) {
                for (sum, pixels) in columns[1..].iter_mut().zip(pixels.chunks(block)) {
                    pixels.iter().for_each(|pixel| add(sum, pixel.map(f64::from)));
                }
            }
            let mut row = [0.0f64; 4];
            for (column, sum) in columns.into_iter().enumerate() {
                add(&mut row, sum);
                let above = sums[above + column];
                sums.push(std::array::from_fn(|i| above[i] + row[i]));
            }
        }
        SummedArea { width, height, block, corners, sums }
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
        let (column, right) = self.between(x, self.width);
        let (row, below) = self.between(y, self.height);
        let at = |dx: usize, dy: usize| self.sums[(row + dy) * self.corners + column + dx];
        let (one, two, three, four) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        std::array::from_fn(|i| {
            let upper = one[i] + (two[i] - one[i]) * right;
            let lower = three[i] + (four[i] - three[i]) * right;
            upper + (lower - upper) * below
        })
    }

    /// The corner before a place, and the share of the way to the next.
    fn between(&self, at: f64, length: usize) -> (usize, f64) {
        let corner = (at as usize).min(length - 1) / self.block;
        let (start, end) = (corner * self.block, ((corner + 1) * self.block).min(length));
        (corner, (at - start as f64) / (end - start) as f64)
    }
}

fn add(sum: &mut [f64; 4], more: [f64; 4]) {
    sum.iter_mut().zip(more).for_each(|(sum, v)| *sum += v);
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
    fn a_table_of_blocks_has_the_means_of_one_of_pixels() {
        let pixel = |i: u32| [(i * 7 % 256) as u8, (i * 31 % 256) as u8, (i / 50) as u8, 255];
        let bytes: Vec<u8> = (0..50 * 37).flat_map(pixel).collect();
        let image = Layer::from_rgba8(IntRect::new(0, 0, 50, 37), &bytes);
        let (fine, coarse) = (SummedArea::of(&image, 1), SummedArea::of(&image, 3));
        for (x, y) in [(25.0, 18.0), (3.0, 2.0), (49.0, 36.0), (33.3, 11.7)] {
            let (one, other) =
                (fine.mean(Point::new(x, y), 24.0, 24.0), coarse.mean(Point::new(x, y), 24.0, 24.0));
            for i in 0..4 {
                assert!((one[i] - other[i]).abs() < 0.02, "at {x}, {y}: {one:?}, {other:?}");
            }
        }
        assert_eq!(fine.sum(50.0, 37.0)[3], 50.0 * 37.0);
        assert!((coarse.sum(50.0, 37.0)[3] - 50.0 * 37.0).abs() < 1e-9);
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
