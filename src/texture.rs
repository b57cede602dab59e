//! Takes an image and a transform, makes a layer: each pixel is the mean of the image over the pixel's
//! footprint, or lies between four samples where the image is enlarged.
//!
//! | spot in the image | read | |
//! |---|---|---|
//! | less than a texel each way | four texels, or the nearest | [`between`] |
//! | up to 64 texels across | every texel once, through running sums of its row (Crow 1984) | [`averaged`] |
//! | more | the same of a level of the image's pyramid (Williams 1983) | [`levels`] |
//!
//! The spot's shorter axis chooses the level: by the longer one a MIP map blurs across it (Heckbert 1986, *Survey
//! of Texture Mapping*). Along the longer axis the sums add up as many texels as there are. A table of sums over
//! the whole plane would make every spot cost the same, but takes four times the image's memory and knows boxes
//! alone, not parallelograms.
//!
//! Images are kept as they are decoded, four bytes a pixel; levels, an eighth and a third of that again, are
//! made when a drawing first asks for one.

mod averaged;
mod levels;
mod piles;
mod scan;

use crate::effects::layer::{premultiplied, IntRect, Layer, Pixel, Space};
use crate::scene::print::Print;
use kurbo::{Affine, Point};
use std::sync::OnceLock;

/// Decoded pixels, which are unit squares from the origin on: sRGB-encoded with straight alpha.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    rect: IntRect,
    /// Row by row from the top.
    bytes: Vec<u8>,
    opaque: bool,
    coarser: OnceLock<levels::Level>,
    print: OnceLock<Print>,
}

impl Image {
    /// # Panics
    /// When there are not exactly four bytes for every pixel.
    pub fn new(width: u32, height: u32, bytes: Vec<u8>) -> Image {
        let rect = IntRect::new(0, 0, width, height);
        assert_eq!(bytes.len() as u64, rect.area() * 4, "four bytes a pixel");
        let opaque = bytes.as_chunks().0.iter().all(|&[.., alpha]: &[u8; 4]| alpha == 255);
        Image { rect, bytes, opaque, coarser: OnceLock::new(), print: OnceLock::new() }
    }

    pub fn rect(&self) -> IntRect {
        self.rect
    }

    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Has it no pixel that lets anything through?
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// Of its size and its pixels: however often it is drawn, these are gone through once.
    pub fn print(&self) -> Print {
        *self.print.get_or_init(|| {
            let mut print = Print::new(self.rect.width() as u64);
            print.add_bytes(&self.bytes);
            print
        })
    }

    fn pixels(&self) -> &[[u8; 4]] {
        self.bytes.as_chunks().0
    }

    fn row(&self, y: usize) -> &[[u8; 4]] {
        &self.pixels()[y * self.rect.width()..][..self.rect.width()]
    }

    fn pixel(&self, x: usize, y: usize) -> Pixel {
        premultiplied(self.pixels()[y * self.rect.width() + x].map(|v| f32::from(v) * (1.0 / 255.0)))
    }

    /// Moved by whole pixels, then cut to a rectangle; clear beyond its edges.
    fn moved(&self, (dx, dy): (i32, i32), rect: IntRect) -> Layer {
        let mut layer = Layer::clear(rect, Space::Srgb);
        let (width, height) = (i64::from(self.rect.right()), i64::from(self.rect.bottom()));
        let (left, top) = (i64::from(dx), i64::from(dy));
        let common = IntRect::from_edges(left, top, left + width, top + height).intersect(rect);
        for y in common.y()..common.bottom() {
            let from = &self.row((y - dy) as usize)[(common.x() - dx) as usize..];
            premultiply(from, layer.span_mut(y, common));
        }
        layer
    }
}

fn premultiply(from: &[[u8; 4]], to: &mut [Pixel]) {
    // Runs of one colour are the rule in drawings.
    let (mut known, mut known_pixel) = ([0; 4], [0.0; 4]);
    for (&bytes, pixel) in from.iter().zip(to) {
        if bytes != known {
            (known, known_pixel) = (bytes, premultiplied(bytes.map(|v| f32::from(v) / 255.0)));
        }
        *pixel = known_pixel;
    }
}

/// Draws `image` over a rectangle, `nearest` where each of its pixels is to be a square: where these are
/// enlarged both ways, a pixel has the colour of the one at its middle. Up to a pixel beyond its edges the image
/// goes on as it ends; farther out it may do so, or be clear.
pub(crate) fn drawn(image: &Image, to_pixels: Affine, rect: IntRect, nearest: bool) -> Layer {
    if let Some(by) = whole_move(to_pixels) {
        return image.moved(by, rect);
    }
    let back = to_pixels.inverse();
    if to_pixels.determinant() == 0.0 || !back.is_finite() || image.rect.is_empty() || rect.is_empty() {
        return Layer::clear(rect, Space::Srgb);
    }
    let level = levels::level_for(spot(back), image);
    let side = f64::from(1u32 << level);
    let size = (image.rect.width() as f64 / side, image.rect.height() as f64 / side);
    match scan::Scan::new(Affine::scale(1.0 / side) * back, rect, size, nearest) {
        Some(scan) if scan.averages() || scan.is_straight() && !nearest => {
            averaged::drawn(image, level, &scan, rect)
        }
        _ if nearest => sampled(back, rect, |at| {
            let (x, y) = last(image);
            image.pixel(at.x.max(0.0).min(x) as usize, at.y.max(0.0).min(y) as usize)
        }),
        _ => sampled(back, rect, |at| between(image, at)),
    }
}

/// The shorter axis of a pixel's parallelogram in the image, across its longer side.
fn spot(back: Affine) -> f64 {
    let [a, b, c, d, ..] = back.as_coeffs();
    back.determinant().abs() / a.hypot(b).max(c.hypot(d))
}

/// The move of a transform that moves by whole pixels and does nothing else.
fn whole_move(transform: Affine) -> Option<(i32, i32)> {
    let [a, b, c, d, e, f] = transform.as_coeffs();
    let is_whole = [a, b, c, d] == [1.0, 0.0, 0.0, 1.0] && e.fract() == 0.0 && f.fract() == 0.0;
    (is_whole && e.abs().max(f.abs()) < 1e8).then_some((e as i32, f as i32))
}

/// A layer of what `sample` says at each pixel's middle, in the image's coordinates.
fn sampled(back: Affine, rect: IntRect, sample: impl Fn(Point) -> Pixel) -> Layer {
    let mut layer = Layer::clear(rect, Space::Srgb);
    for (row, pixels) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
        let y = f64::from(rect.y()) + row as f64 + 0.5;
        for (column, pixel) in pixels.iter_mut().enumerate() {
            *pixel = sample(back * Point::new(f64::from(rect.x()) + column as f64 + 0.5, y));
        }
    }
    layer
}

/// The last column and row.
fn last(image: &Image) -> (f64, f64) {
    ((image.rect.width() - 1) as f64, (image.rect.height() - 1) as f64)
}

/// Bilinear between the middles of four pixels.
fn between(image: &Image, at: Point) -> Pixel {
    let (right_end, bottom_end) = last(image);
    let (x, y) = ((at.x - 0.5).max(0.0).min(right_end), (at.y - 0.5).max(0.0).min(bottom_end));
    let (left, top) = (x as usize, y as usize);
    let (right, below) = ((x - left as f64) as f32, (y - top as f64) as f32);
    let (next, lower) = ((left + 1).min(right_end as usize), (top + 1).min(bottom_end as usize));
    let mix = |one: Pixel, other: Pixel, share: f32| -> Pixel {
        std::array::from_fn(|i| one[i] + (other[i] - one[i]) * share)
    };
    let upper = mix(image.pixel(left, top), image.pixel(next, top), right);
    mix(upper, mix(image.pixel(left, lower), image.pixel(next, lower), right), below)
}

#[cfg(test)]
mod tests;
