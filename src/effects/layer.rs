//! Takes pixels over a rectangle of the picture, keeps them as a [`Layer`]: premultiplied RGBA in
//! `f32`, which knows whether its colours are sRGB-encoded or linear. Eight bits would not do: dark
//! colours in linear light need twelve, and every primitive of a chain would round again.

pub(crate) use super::int_rect::IntRect;
use super::srgb;
use kurbo::{Affine, Point};

/// How a layer's colours are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Space {
    Srgb,
    Linear,
}

impl From<usvg::filter::ColorInterpolation> for Space {
    fn from(interpolation: usvg::filter::ColorInterpolation) -> Space {
        match interpolation {
            usvg::filter::ColorInterpolation::SRGB => Space::Srgb,
            usvg::filter::ColorInterpolation::LinearRGB => Space::Linear,
        }
    }
}

/// Premultiplied red, green, blue, alpha: each 0 ..= 1, no colour above its alpha.
pub(crate) type Pixel = [f32; 4];

/// Nothing.
pub(crate) const CLEAR: Pixel = [0.0; 4];

/// Less alpha than this a byte would not hold.
const FAINT: f32 = 0.5 / 255.0;

/// A premultiplied pixel from a straight one, clamped to what a pixel may hold; NaN is 0.
#[inline]
pub(crate) fn premultiplied([r, g, b, a]: Pixel) -> Pixel {
    let a = unit(a);
    [unit(r) * a, unit(g) * a, unit(b) * a, a]
}

/// Straight colour of a premultiplied pixel; a clear one is black.
#[inline]
pub(crate) fn straight([r, g, b, a]: Pixel) -> Pixel {
    if a >= 1.0 {
        [r, g, b, a]
    } else if a > 0.0 {
        [r / a, g / a, b / a, a].map(|v| v.min(1.0))
    } else {
        CLEAR
    }
}

/// Clamped to 0 ..= 1; NaN is 0.
#[inline]
pub(crate) fn unit(v: f32) -> f32 {
    // `clamp` would keep NaN.
    if v > 0.0 {
        v.min(1.0)
    } else {
        0.0
    }
}

/// A colour as it is written in SVG, sRGB-encoded and straight, as a pixel in some space.
pub(crate) fn pixel_of(color: usvg::Color, opacity: f32, space: Space) -> Pixel {
    let [r, g, b] = [color.red, color.green, color.blue].map(|v| {
        let v = f32::from(v) / 255.0;
        match space {
            Space::Srgb => v,
            Space::Linear => srgb::linear_of_encoded(v),
        }
    });
    premultiplied([r, g, b, opacity])
}

/// Pixels over a rectangle; all beyond it is clear.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    rect: IntRect,
    space: Space,
    /// Row by row from the top.
    pixels: Vec<Pixel>,
}

/// Adds pixels to some, from sRGB-encoded bytes with straight alpha.
pub(crate) fn add_rgba8(pixels: &mut Vec<Pixel>, bytes: &[u8]) {
    // Runs of one colour are the rule in drawings.
    let (mut known, mut known_pixel) = ([0; 4], CLEAR);
    let pixel = |&bytes: &[u8; 4]| {
        if bytes != known {
            (known, known_pixel) = (bytes, premultiplied(bytes.map(|v| f32::from(v) / 255.0)));
        }
        known_pixel
    };
    pixels.extend(bytes.as_chunks().0.iter().map(pixel));
}

impl Layer {
    /// # Panics
    /// When there is not exactly one pixel for each of the rectangle.
    pub fn new(rect: IntRect, space: Space, pixels: Vec<Pixel>) -> Layer {
        assert_eq!(pixels.len() as u64, rect.area(), "one for each");
        Layer { rect, space, pixels }
    }

    /// Nothing, over a rectangle.
    pub fn clear(rect: IntRect, space: Space) -> Layer {
        Layer::filled(rect, space, CLEAR)
    }

    /// One colour.
    pub fn filled(rect: IntRect, space: Space, pixel: Pixel) -> Layer {
        Layer { rect, space, pixels: vec![pixel; rect.width() * rect.height()] }
    }

    /// From sRGB-encoded bytes with straight alpha, rows without padding.
    ///
    /// # Panics
    /// When there are not exactly four bytes for every pixel.
    pub fn from_rgba8(rect: IntRect, bytes: &[u8]) -> Layer {
        let mut pixels = Vec::with_capacity(rect.width() * rect.height());
        add_rgba8(&mut pixels, bytes);
        Layer::new(rect, Space::Srgb, pixels)
    }

    /// sRGB-encoded bytes with straight alpha.
    #[cfg(test)]
    pub fn to_rgba8(&self) -> Vec<u8> {
        let space = self.space;
        let bytes = move |&pixel: &Pixel| {
            let pixel = match space {
                Space::Srgb => pixel,
                Space::Linear => recoded(pixel, srgb::encoded_of_linear),
            };
            straight(pixel).map(|v| (unit(v) * 255.0 + 0.5) as u8)
        };
        self.pixels.iter().flat_map(bytes).collect()
    }

    pub fn rect(&self) -> IntRect {
        self.rect
    }

    pub fn space(&self) -> Space {
        self.space
    }

    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    pub fn pixels_mut(&mut self) -> &mut [Pixel] {
        &mut self.pixels
    }

    pub fn into_pixels(self) -> Vec<Pixel> {
        self.pixels
    }

    /// Its place and its pixels for another layer, whose colours are encoded so. They are to be overwritten.
    pub fn taken_for(self, space: Space) -> Layer {
        Layer { space, ..self }
    }

    /// The pixel in column x and row y of the picture.
    #[inline]
    pub fn pixel(&self, x: i32, y: i32) -> Pixel {
        let (column, row) = (x.wrapping_sub(self.rect.x()) as u32, y.wrapping_sub(self.rect.y()) as u32);
        if (column as usize) < self.rect.width() && (row as usize) < self.rect.height() {
            self.pixels[row as usize * self.rect.width() + column as usize]
        } else {
            CLEAR
        }
    }

    /// Gives `put` the pixels of row `y` from column `x` on, each with its place among them.
    #[inline]
    pub fn row(&self, x: i32, y: i32, count: usize, mut put: impl FnMut(usize, Pixel)) {
        let wanted = IntRect::new(x, y, count as u32, 1);
        let common = wanted.intersect(self.rect);
        let (mut i, left) = (0, if common.is_empty() { count } else { (common.x() - x) as usize });
        while i < left {
            put(i, CLEAR);
            i += 1;
        }
        if !common.is_empty() {
            let first = self.index(common.x(), y);
            for &pixel in &self.pixels[first..first + common.width()] {
                put(i, pixel);
                i += 1;
            }
        }
        (i..count).for_each(|i| put(i, CLEAR));
    }

    /// Row y of a rectangle which lies within this layer's.
    pub fn span(&self, y: i32, within: IntRect) -> &[Pixel] {
        let first = self.index(within.x(), y);
        &self.pixels[first..first + within.width()]
    }

    /// The same, to be written.
    pub fn span_mut(&mut self, y: i32, within: IntRect) -> &mut [Pixel] {
        let first = self.index(within.x(), y);
        &mut self.pixels[first..first + within.width()]
    }

    fn index(&self, x: i32, y: i32) -> usize {
        (y - self.rect.y()) as usize * self.rect.width() + (x - self.rect.x()) as usize
    }

    /// The same colours in another encoding.
    pub fn into_space(mut self, space: Space) -> Layer {
        match (self.space, space) {
            (Space::Srgb, Space::Linear) => self.recode(srgb::linear_of_encoded),
            (Space::Linear, Space::Srgb) => self.recode(srgb::encoded_of_linear),
            _ => {}
        }
        self.space = space;
        self
    }

    fn recode(&mut self, code: impl Fn(f32) -> f32) {
        // Runs of one colour are the rule in drawings.
        let (mut known, mut known_recoded) = (CLEAR, CLEAR);
        for pixel in &mut self.pixels {
            if *pixel != known {
                (known, known_recoded) = (*pixel, recoded(*pixel, &code));
            }
            *pixel = known_recoded;
        }
    }

    /// Every pixel by itself; the result is clamped to what a pixel may hold. What is fainter than a byte would hold
    /// is clear: its straight colour, and what is made of that, might be anything, as in the tails of a blur.
    pub fn map_straight(mut self, map: impl Fn(Pixel) -> Pixel) -> Layer {
        let clear = premultiplied(map(CLEAR));
        let (mut known, mut known_mapped) = (CLEAR, clear);
        for pixel in &mut self.pixels {
            if *pixel != known {
                let is_faint = pixel[3] < FAINT;
                known = *pixel;
                known_mapped = if is_faint { clear } else { premultiplied(map(straight(*pixel))) };
            }
            *pixel = known_mapped;
        }
        self
    }

    /// Black with the same alpha.
    pub fn alpha(&self) -> Layer {
        let pixels = self.pixels.iter().map(|p| [0.0, 0.0, 0.0, p[3]]).collect();
        Layer { pixels, ..*self }
    }

    /// The same.
    pub fn into_alpha(mut self) -> Layer {
        self.pixels.iter_mut().for_each(|p| *p = [0.0, 0.0, 0.0, p[3]]);
        self
    }

    /// The same pixels over another rectangle: cut off or clear where this one ends.
    pub fn into_rect(self, rect: IntRect) -> Layer {
        match rect == self.rect {
            true => self,
            false => self.moved_over_rect(0, 0, rect),
        }
    }

    /// Does it hide all that lies behind it?
    pub fn is_opaque(&self) -> bool {
        self.pixels.iter().all(|pixel| pixel[3] >= 1.0)
    }

    /// The same pixels over another rectangle: cut off or clear where this one ends.
    pub fn over_rect(&self, rect: IntRect) -> Layer {
        if rect == self.rect {
            return self.clone();
        }
        self.moved_over_rect(0, 0, rect)
    }

    /// Moved by whole pixels, then cut to a rectangle.
    pub fn moved_over_rect(&self, dx: i32, dy: i32, rect: IntRect) -> Layer {
        let mut moved = Layer::clear(rect, self.space);
        let from = self.rect.moved(dx, dy);
        let common = from.intersect(rect);
        for y in common.y()..common.bottom() {
            let first = (y - from.y()) as usize * from.width() + (common.x() - from.x()) as usize;
            moved.span_mut(y, common).copy_from_slice(&self.pixels[first..first + common.width()]);
        }
        moved
    }

    /// Moved by whole pixels, and cut to the rectangle where it was.
    pub fn moved(mut self, dx: i32, dy: i32) -> Layer {
        let kept = self.rect.moved(dx, dy).intersect(self.rect);
        if !kept.is_empty() {
            // In the order of memory; what comes out at the other side is cleared with the rest.
            let by = dy as isize * self.rect.width() as isize + dx as isize;
            let (from, to) = ((-by).max(0) as usize, by.max(0) as usize);
            let end = self.pixels.len() - to;
            self.pixels.copy_within(from..end, to);
        }
        self.clear_outside(kept);
        self
    }

    /// Clears all pixels outside a rectangle.
    pub fn clear_outside(&mut self, keep: IntRect) {
        let keep = keep.intersect(self.rect);
        if keep == self.rect {
            return;
        }
        let (left, right) = (keep.x() - self.rect.x(), keep.right() - self.rect.x());
        for (y, row) in (self.rect.y()..).zip(self.pixels.chunks_exact_mut(self.rect.width())) {
            if (keep.y()..keep.bottom()).contains(&y) {
                row[..left as usize].fill(CLEAR);
                row[right as usize..].fill(CLEAR);
            } else {
                row.fill(CLEAR);
            }
        }
    }

    /// The picture under a transform, bilinearly between the pixels' centres.
    pub fn resampled(&self, transform: Affine, rect: IntRect) -> Layer {
        let mut resampled = Layer::clear(rect, self.space);
        if transform.determinant() == 0.0 || !transform.is_finite() || rect.is_empty() {
            return resampled;
        }
        let back = transform.inverse();
        for (row, pixels) in resampled.pixels.chunks_exact_mut(rect.width()).enumerate() {
            let y = f64::from(rect.y()) + row as f64 + 0.5;
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let p = back * Point::new(f64::from(rect.x()) + column as f64 + 0.5, y);
                *pixel = self.between(p.x - 0.5, p.y - 0.5);
            }
        }
        resampled
    }

    /// Bilinear: whole numbers are pixels' centres. Clear at what is no number.
    #[inline]
    pub fn between(&self, x: f64, y: f64) -> Pixel {
        if !(x.is_finite() && y.is_finite()) {
            return CLEAR;
        }
        // What is far off stays far off.
        const FAR: f64 = (IntRect::FARTHEST * 2) as f64;
        between(x.clamp(-FAR, FAR), y.clamp(-FAR, FAR), |x, y| self.pixel(x as i32, y as i32))
    }
}

/// Bilinear between the four samples around a point; samples lie at whole numbers.
#[inline]
pub(crate) fn between(x: f64, y: f64, sample: impl Fn(i64, i64) -> Pixel) -> Pixel {
    let (left, top) = (floor(x), floor(y));
    let (right, below) = ((x - left as f64) as f32, (y - top as f64) as f32);
    let upper = mix(sample(left, top), sample(left + 1, top), right);
    let lower = mix(sample(left, top + 1), sample(left + 1, top + 1), right);
    mix(upper, lower, below)
}

/// The whole number at or below, without the call that `f64::floor` is on baseline processors; NaN is 0, and
/// numbers end at 2^62 either way.
#[inline]
fn floor(x: f64) -> i64 {
    const FAR: f64 = (1i64 << 62) as f64;
    let whole = x.clamp(-FAR, FAR) as i64;
    whole - i64::from(whole as f64 > x)
}

/// From the one (share 0) to the other (share 1).
#[inline]
fn mix(one: Pixel, other: Pixel, share: f32) -> Pixel {
    std::array::from_fn(|i| one[i] + (other[i] - one[i]) * share)
}

#[inline]
fn recoded(pixel: Pixel, code: impl Fn(f32) -> f32) -> Pixel {
    let [r, g, b, a] = straight(pixel);
    if r == g && g == b {
        let grey = code(r) * a;
        return [grey, grey, grey, a];
    }
    [code(r) * a, code(g) * a, code(b) * a, a]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chequered() -> Layer {
        let bytes: Vec<u8> =
            (0..4 * 3 * 4).map(|i| if i % 4 == 3 { 255 } else { (i * 37 % 256) as u8 }).collect();
        Layer::from_rgba8(IntRect::new(-1, 2, 4, 3), &bytes)
    }

    #[test]
    fn bytes_go_through_linear_light_and_come_back() {
        let bytes: Vec<u8> = (0..=255u8).flat_map(|v| [v, 255 - v, v / 2, 255]).collect();
        let layer = Layer::from_rgba8(IntRect::new(0, 0, 256, 1), &bytes);
        assert_eq!(layer.clone().into_space(Space::Linear).into_space(Space::Srgb).to_rgba8(), bytes);
        assert_eq!(layer.into_space(Space::Linear).to_rgba8(), bytes);
    }

    #[test]
    fn a_translucent_pixel_keeps_its_colour_through_linear_light() {
        let layer = Layer::from_rgba8(IntRect::new(0, 0, 1, 1), &[200, 100, 50, 40]);
        assert_eq!(layer.into_space(Space::Linear).to_rgba8(), [200, 100, 50, 40]);
    }

    #[test]
    fn beyond_a_layer_all_is_clear() {
        let layer = chequered();
        assert_ne!(layer.pixel(-1, 2), CLEAR);
        for (x, y) in [(-2, 2), (3, 2), (0, 1), (0, 5), (i32::MIN, 2), (i32::MAX, i32::MAX)] {
            assert_eq!(layer.pixel(x, y), CLEAR);
        }
        assert_eq!(layer.between(1e300, f64::NAN), CLEAR);
    }

    #[test]
    fn a_moved_layer_is_cut_at_its_new_rectangle() {
        let layer = chequered();
        let moved = layer.moved_over_rect(1, -1, IntRect::new(0, 0, 3, 3));
        for y in 0..3 {
            for x in 0..3 {
                assert_eq!(moved.pixel(x, y), layer.pixel(x - 1, y + 1));
            }
        }
    }

    #[test]
    fn a_layer_moved_where_it_is_is_the_same_as_one_moved_into_another() {
        let layer = chequered();
        for dx in [-5, -4, -3, -1, 0, 1, 2, 3, 4, i32::MAX] {
            for dy in [i32::MIN, -3, -2, -1, 0, 1, 2, 3, 7] {
                let moved = layer.moved_over_rect(dx, dy, layer.rect());
                assert_eq!(layer.clone().moved(dx, dy), moved, "by {dx}, {dy}");
            }
        }
    }

    #[test]
    fn what_lies_outside_is_cleared_and_nothing_else() {
        let layer = chequered();
        for keep in [IntRect::new(0, 3, 2, 9), IntRect::new(-9, -9, 10, 14), IntRect::EMPTY] {
            let mut cleared = layer.clone();
            cleared.clear_outside(keep);
            assert_eq!(cleared, layer.over_rect(keep).over_rect(layer.rect()), "{keep:?}");
        }
    }

    #[test]
    fn a_quarter_turn_resamples_without_loss() {
        let layer = chequered();
        let turn = Affine::new([0.0, 1.0, -1.0, 0.0, 0.0, 0.0]);
        let turned = layer.resampled(turn, IntRect::new(-5, -1, 3, 4));
        assert_eq!(turned.pixel(-3, -1), layer.pixel(-1, 2));
        assert_eq!(turned.resampled(turn.inverse(), layer.rect()), layer);
    }
}
