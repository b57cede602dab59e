//! Takes an image, makes each pixel of a layer the mean of the image over the pixel's footprint, in two
//! passes (Catmull and Smith 1980, *3-D Transformations of Images in Scanline Order*).
//!
//! The first pass makes of a row of texels (the image's pixels) one mean for each strip, a column of the
//! layer's pixels or a part of its width: the differences of the row's running sums. The second shares these
//! means out among the pixels of the strips. Every texel is read once, nothing of the image is held but one
//! row, and the footprints of neighbours abut: within its strip a pixel's is the parallelogram with two sides
//! along the strip and two along the rows of texels, as large as the pixel itself; the narrower the strips,
//! the nearer their union is to the pixel. No footprint is narrower or lower than a texel, so where an
//! image is enlarged along an axis its texels blend into one another linearly.
//!
//! Where an image lies on its side, strips are rows of the layer.

use super::Image;
use crate::effects::layer::{floor, IntRect, Layer, Pixel, Space, CLEAR};
use kurbo::Affine;

/// Where the strips and pixels of a layer lie in an image: pixel j of strip i has its middle in row
/// `top + across_strips * i + along * j`.
pub(super) struct Scan {
    /// Are strips rows of the layer?
    turned: bool,
    /// Strips beside one another in a pixel.
    parts: usize,
    strips: usize,
    /// Pixels of a strip.
    pixels: usize,
    /// Texels from one strip to the next, and from one row to the next along a strip.
    step: f64,
    slant: f64,
    /// The middle of the first strip in the upper edge of the first row.
    start: f64,
    across_strips: f64,
    along: f64,
    top: f64,
    /// Width and height of a footprint.
    width: f64,
    height: f64,
    /// Texels beyond the edges where pixels may lie that see the image.
    margin: f64,
}

impl Scan {
    /// Over the pixels of a rectangle; `back` leads from them to the image. `None` where numbers end.
    pub fn new(back: Affine, rect: IntRect) -> Option<Scan> {
        let [a, b, c, d, e, f] = (back * Affine::translate(rect.to_rect().origin().to_vec2())).as_coeffs();
        let turned = b.abs() > d.abs();
        let (a, b, c, d) = if turned { (c, d, a, b) } else { (a, b, c, d) };
        let (strips, pixels) =
            if turned { (rect.height(), rect.width()) } else { (rect.width(), rect.height()) };
        let margin = 3.0 * (a.abs() + b.abs() + c.abs() + d.abs()) + 2.0;
        let slant = c / d;
        let step = a - b * slant;
        // Strips no narrower than a texel; more of them, the more askew the parallelograms are.
        let parts = match d.abs() >= 1.0 {
            true => (MOST_PARTS * b / d).abs().ceil().min(step.abs().floor()).max(1.0),
            false => 1.0,
        };
        let (step, b) = (step / parts, b / parts);
        let scan = Scan {
            turned,
            parts: parts as usize,
            strips: strips * parts as usize,
            pixels,
            step,
            slant,
            start: e + 0.5 * step - f * slant,
            across_strips: b,
            along: d,
            top: f + 0.5 * (b + d),
            // A row sees as much of a strip as the strip moves on in it.
            width: step.abs().max(slant.abs()).max(1.0),
            height: d.abs().max(1.0),
            margin,
        };
        let numbers = [scan.step, scan.slant, scan.start, scan.along, scan.top, scan.margin];
        (d != 0.0 && numbers.iter().all(|v| v.is_finite())).then_some(scan)
    }

    /// Pixels from one strip's to the same strip's next in a layer.
    fn columns(&self) -> usize {
        self.strips / self.parts
    }

    /// Do the pixels' and the image's sides have the same directions?
    pub fn is_straight(&self) -> bool {
        self.slant == 0.0 && self.across_strips == 0.0
    }

    /// Is a footprint more than a texel?
    pub fn averages(&self) -> bool {
        self.width.max(self.height) > 1.0
    }

    /// The rows of texels that the layer shows.
    fn rows(&self, height: usize) -> std::ops::Range<usize> {
        let ends = [0.0, self.across_strips * (self.strips - 1) as f64];
        let far = self.along * (self.pixels - 1) as f64;
        let ys = ends.iter().flat_map(|&y| [self.top + y, self.top + y + far]);
        let (top, bottom) = ys.fold((f64::MAX, f64::MIN), |(top, bottom), y| (top.min(y), bottom.max(y)));
        let first = (top - 0.5 * self.height).max(0.0).min((height - 1) as f64) as usize;
        let end = ((bottom + 0.5 * self.height).max(0.0) as usize).saturating_add(1);
        first..end.clamp(first + 1, height)
    }

    /// The strips that meet the image in a row, or lie just beside it.
    fn strips_in(&self, row: usize, width: usize) -> std::ops::Range<usize> {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        let strip = |x: f64| (x - middle) / self.step;
        let (one, other) = (strip(-self.margin), strip(width as f64 + self.margin));
        let first = one.min(other).max(0.0) as usize;
        let end = (one.max(other).max(0.0) as usize).saturating_add(1).min(self.strips);
        first.min(end)..end
    }

    /// What a row of texels has of each of these strips.
    fn spans(&self, row: usize, strips: std::ops::Range<usize>, texels: usize, spans: &mut Vec<Span>) {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        spans.clear();
        spans.extend(strips.map(|strip| {
            let at = middle + self.step * strip as f64;
            let (from, to) = extent(at, self.width, texels as f64);
            let (first, last) = (from as u32, to as u32);
            Span {
                first,
                last,
                before: (from - f64::from(first)) as f32,
                beyond: (to - f64::from(last)) as f32,
                share: 1.0 / (to - from) as f32,
            }
        }));
    }

    /// Calls `add` on all pixels of a strip that see a row of an image so high, each with the row's share.
    #[inline]
    fn shares(&self, strip: usize, row: usize, height: usize, mut add: impl FnMut(usize, f32)) {
        let (row_top, row_bottom) = (row as f64, row as f64 + 1.0);
        let reach = 0.5 * self.height;
        // The first and the last row are also seen from beyond.
        let above = if row == 0 { self.margin } else { reach };
        let below = if row + 1 == height { self.margin } else { reach };
        let middle = self.top + self.across_strips * strip as f64;
        let (one, other) =
            ((row_top - above - middle) / self.along, (row_bottom + below - middle) / self.along);
        let (first, last) = if one < other { (one, other) } else { (other, one) };
        if last < 0.0 {
            return;
        }
        let first = if first > 0.0 { first as usize } else { 0 };
        for pixel in first..=(last as usize).min(self.pixels - 1) {
            let (top, bottom) = extent(middle + self.along * pixel as f64, self.height, height as f64);
            let seen = if bottom < row_bottom { bottom } else { row_bottom }
                - if top > row_top { top } else { row_top };
            if seen > 0.0 {
                add(pixel, (seen / (bottom - top)) as f32);
            }
        }
    }
}

/// Strips in a pixel at 45 degrees.
const MOST_PARTS: f64 = 4.0;

/// From where to where a footprint around a place sees an image of some length: at least one texel, so
/// that the image's end goes on.
#[inline]
fn extent(middle: f64, width: f64, length: f64) -> (f64, f64) {
    let (from, to) = (middle - 0.5 * width, middle + 0.5 * width);
    if from >= 0.0 && to <= length {
        return (from, to);
    }
    let from = from.max(0.0).min(length - 1.0);
    (from, to.max(from + 1.0).min(length))
}

/// A part of a row of texels.
struct Span {
    /// The texels in which it begins and ends.
    first: u32,
    last: u32,
    /// Texels of the first one before it begins, and of the last one before it ends.
    before: f32,
    beyond: f32,
    /// One over its length.
    share: f32,
}

pub(super) fn drawn(image: &Image, scan: &Scan, rect: IntRect) -> Layer {
    if image.is_opaque() {
        averaged(image, scan, rect, 255.0, |texel| texel.map(u32::from))
    } else {
        averaged(image, scan, rect, 255.0 * 255.0, |[r, g, b, a]| {
            [r, g, b, 255].map(|v| u32::from(v) * u32::from(a))
        })
    }
}

/// `weighted` gives a texel's premultiplied channels as whole numbers up to `unit`.
fn averaged(
    image: &Image,
    scan: &Scan,
    rect: IntRect,
    unit: f32,
    weighted: impl Fn([u8; 4]) -> [u32; 4],
) -> Layer {
    let (width, height) = (image.rect().width(), image.rect().height());
    let mut layer = Layer::clear(rect, Space::Srgb);
    let mut on_its_side = vec![CLEAR; if scan.turned { rect.width() * rect.height() } else { 0 }];
    let pixels = if scan.turned { &mut on_its_side[..] } else { layer.pixels_mut() };
    let (mut sums, mut spans, mut means) = (Vec::new(), Vec::new(), vec![CLEAR; scan.strips]);
    let mut piles = Piles::new(scan);
    for row in scan.rows(height) {
        let strips = scan.strips_in(row, width);
        if strips.is_empty() {
            continue;
        }
        if spans.is_empty() || scan.slant != 0.0 {
            scan.spans(row, strips.clone(), width, &mut spans);
        }
        let means = &mut means[..strips.len()];
        strip_means(image.row(row), &weighted, unit, &spans, &mut sums, means);
        if scan.across_strips == 0.0 {
            scan.shares(0, row, height, |pixel, share| {
                let pixels = &mut pixels[pixel * scan.strips..][strips.clone()];
                pixels.iter_mut().zip(&*means).for_each(|(pixel, mean)| add(pixel, mean, share));
            });
        } else if scan.along.abs() < 1.0 {
            for (strip, mean) in strips.zip(&*means) {
                scan.shares(strip, row, height, |pixel, share| {
                    add(&mut pixels[pixel * scan.strips + strip], mean, share);
                });
            }
        } else {
            piles.add(scan, (row, height), strips.zip(&*means), pixels);
        }
    }
    bounded(pixels, image.is_opaque());
    if scan.turned {
        for (strip, row) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
            for (pixel, to) in row.iter_mut().enumerate() {
                *to = on_its_side[pixel * scan.columns() + strip];
            }
        }
    }
    layer
}

/// Of each strip, what its present pixel has of the rows so far, where rows are no higher than pixels.
struct Piles {
    /// Pixels of a strip that a row is high.
    row_height: f64,
    piles: Vec<Pile>,
}

#[derive(Clone, Copy)]
struct Pile {
    sum: Pixel,
    /// The height of the rows in it.
    height: f32,
}

const NO_PILE: Pile = Pile { sum: CLEAR, height: 0.0 };

impl Piles {
    fn new(scan: &Scan) -> Piles {
        Piles { row_height: 1.0 / scan.along.abs(), piles: vec![NO_PILE; scan.strips] }
    }

    /// Adds what strips have of a row of an image so high.
    fn add<'a>(
        &mut self,
        scan: &Scan,
        (row, height): (usize, usize),
        strips: impl Iterator<Item = (usize, &'a Pixel)>,
        pixels: &mut [Pixel],
    ) {
        // Down the rows, so from a strip's last pixel to its first where it is upside down.
        let is_upright = scan.along > 0.0;
        let last = scan.pixels as i64 - 1;
        let part = 1.0 / scan.parts as f32;
        let mut put = |strip: usize, pixel: i64, sum: &Pixel, share: f32| {
            if (0..=last).contains(&pixel) {
                let pixel = if is_upright { pixel } else { last - pixel } as usize;
                add(&mut pixels[pixel * scan.columns() + strip / scan.parts], sum, share * part);
            }
        };
        let margin = (scan.margin * self.row_height).min(1e9) as i64;
        for (strip, mean) in strips {
            let middle = scan.top + scan.across_strips * strip as f64;
            let first = if is_upright { middle } else { middle + scan.along * last as f64 };
            // Where the first pixel begins, in rows; then where the row does, in pixels.
            let first = first - 0.5 * scan.height;
            let (top, bottom) =
                ((row as f64 - first) * self.row_height, ((row + 1) as f64 - first) * self.row_height);
            let (is_first, is_last) = (row == 0, row + 1 == height);
            if (bottom < 0.0 && !is_last) || (top > scan.pixels as f64 && !is_first) {
                continue;
            }
            let (mut pixel, next) = (floor(top), floor(bottom));
            if is_first {
                for above in (pixel - margin).max(0)..pixel.min(last + 1) {
                    put(strip, above, mean, 1.0);
                }
            }
            let pile = &mut self.piles[strip];
            let mut from = top;
            while pixel < next {
                let end = (pixel + 1) as f64;
                pile.add(mean, (end - from) as f32);
                put(strip, pixel, &pile.sum, 1.0 / pile.height);
                *pile = NO_PILE;
                (from, pixel) = (end, pixel + 1);
            }
            pile.add(mean, (bottom - from) as f32);
            if is_last {
                if pile.height > 0.0 {
                    put(strip, pixel, &pile.sum, 1.0 / pile.height);
                    pixel += 1;
                }
                for below in pixel.max(0)..(pixel + margin).min(last + 1) {
                    put(strip, below, mean, 1.0);
                }
            }
        }
    }
}

impl Pile {
    fn add(&mut self, mean: &Pixel, height: f32) {
        add(&mut self.sum, mean, height);
        self.height += height;
    }
}

/// The mean of a row of texels over each span.
fn strip_means(
    texels: &[[u8; 4]],
    weighted: impl Fn([u8; 4]) -> [u32; 4],
    unit: f32,
    spans: &[Span],
    sums: &mut Vec<[u32; 4]>,
    means: &mut [Pixel],
) {
    // Spans go either way.
    let (one, other) = (&spans[0], &spans[spans.len() - 1]);
    let first = one.first.min(other.first) as usize;
    let end = (one.last.max(other.last) as usize + 1).min(texels.len());
    // Of each texel, the sum of those before it; one texel of nothing more, where spans may end.
    sums.clear();
    sums.resize(end - first + 2, [0; 4]);
    let mut sum = [0u32; 4];
    for (&texel, after) in texels[first..end].iter().zip(&mut sums[1..]) {
        let texel = weighted(texel);
        sum = std::array::from_fn(|i| sum[i].wrapping_add(texel[i]));
        *after = sum;
    }
    let known = sums.len() - 2;
    sums[known + 1] = sums[known];
    let between = |from: usize, to: usize| -> Pixel {
        let (from, to) = (sums[from], sums[to]);
        std::array::from_fn(|i| to[i].wrapping_sub(from[i]) as f32)
    };
    for (span, mean) in spans.iter().zip(means) {
        let (mut from, to) = (span.first as usize - first, span.last as usize - first);
        let (start, end) = (between(from, from + 1), between(to, to + 1));
        let mut whole = CLEAR;
        while to - from > MOST_TEXELS {
            add(&mut whole, &between(from, from + MOST_TEXELS), 1.0);
            from += MOST_TEXELS;
        }
        let last = between(from, to);
        let share = span.share / unit;
        *mean = std::array::from_fn(|i| {
            (whole[i] + last[i] + end[i] * span.beyond - start[i] * span.before) * share
        });
    }
}

/// Texels whose sum surely is a difference of running sums, which may have overflowed.
const MOST_TEXELS: usize = 1 << 16;

#[inline]
fn add(sum: &mut Pixel, pixel: &Pixel, share: f32) {
    for (sum, v) in sum.iter_mut().zip(pixel) {
        *sum += v * share;
    }
}

/// Takes back what sums of rounded shares are too much, or of an opaque image too little.
fn bounded(pixels: &mut [Pixel], opaque: bool) {
    for [r, g, b, a] in pixels {
        *a = if opaque && *a > 0.5 { 1.0 } else { a.min(1.0) };
        (*r, *g, *b) = (r.min(*a), g.min(*a), b.min(*a));
    }
}
