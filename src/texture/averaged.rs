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
use crate::effects::layer::{IntRect, Layer, Pixel, Space, CLEAR};
use kurbo::Affine;
use std::ops::Range;

/// Where the strips and pixels of a layer lie in an image: pixel j of strip i has its middle in row
/// `top + across_strips * i + along * j`.
pub(super) struct Scan {
    /// Are strips rows of the layer?
    turned: bool,
    /// Strips beside one another in a pixel: two to the power of this.
    parts_log2: u32,
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
    /// Over the pixels of a rectangle; `back` leads from them to an image over another. `None` where
    /// numbers end: one is millions of times as large as the other, or as far away.
    pub fn new(back: Affine, rect: IntRect, image: IntRect) -> Option<Scan> {
        let [a, b, c, d, e, f] = (back * Affine::translate(rect.to_rect().origin().to_vec2())).as_coeffs();
        let turned = b.abs() > d.abs();
        let (a, b, c, d) = if turned { (c, d, a, b) } else { (a, b, c, d) };
        let (strips, pixels) =
            if turned { (rect.height(), rect.width()) } else { (rect.width(), rect.height()) };
        let margin = 3.0 * (a.abs() + b.abs() + c.abs() + d.abs()) + 2.0;
        let slant = c / d;
        let step = a - b * slant;
        // Strips no narrower than a texel; more of them, the more askew the parallelograms are.
        let askew = (MOST_PARTS * b / d).abs();
        let halvings = [1.0, 2.0].iter().take_while(|&&parts| askew > parts && step.abs() >= 2.0 * parts);
        let parts_log2 = if d.abs() >= 1.0 { halvings.count() as u32 } else { 0 };
        let parts = f64::from(1 << parts_log2);
        let (step, b) = (step / parts, b / parts);
        let scan = Scan {
            turned,
            parts_log2,
            strips: strips << parts_log2,
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
        let numbers = [
            scan.start,
            scan.step * scan.strips as f64,
            scan.slant * image.height() as f64,
            scan.top,
            scan.across_strips * scan.strips as f64,
            scan.along * scan.pixels as f64,
            scan.margin,
        ];
        numbers.iter().all(|v| v.abs() < LARGEST).then_some(scan)
    }

    /// Pixels of the layer beside one another, each of one strip or of several.
    fn columns(&self) -> usize {
        self.strips >> self.parts_log2
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
    fn rows(&self, height: usize) -> Range<usize> {
        let ends = [0.0, self.across_strips * (self.strips - 1) as f64];
        let far = self.along * (self.pixels - 1) as f64;
        let ys = ends.iter().flat_map(|&y| [self.top + y, self.top + y + far]);
        let (top, bottom) = ys.fold((f64::MAX, f64::MIN), |(top, bottom), y| (top.min(y), bottom.max(y)));
        let first = (top - 0.5 * self.height).max(0.0).min((height - 1) as f64) as usize;
        // One more, as rounded pixels may end a little beyond.
        let end = ((bottom + 0.5 * self.height).max(0.0) as usize).saturating_add(2);
        first..end.clamp(first + 1, height)
    }

    /// The strips that meet the image in a row, or lie just beside it.
    fn strips_in(&self, row: usize, width: usize) -> Range<usize> {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        let strip = |x: f64| (x - middle) / self.step;
        let (one, other) = (strip(-self.margin), strip(width as f64 + self.margin));
        let first = one.min(other).max(0.0) as usize;
        let end = (one.max(other).max(0.0) as usize).saturating_add(1).min(self.strips);
        first.min(end)..end
    }

    /// What a row of texels has of each of these strips.
    fn spans(&self, row: usize, strips: Range<usize>, texels: usize, spans: &mut Vec<Span>) {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        let (step, width) = (fixed(self.step), fixed(self.width));
        let texels = (texels as i64) << FRACTION_BITS;
        let full = (1.0 / self.width) as f32;
        let mut from = fixed(middle + self.step * strips.start as f64 - 0.5 * self.width);
        spans.clear();
        spans.extend(strips.map(|_| {
            // At least one texel, so that the image's ends go on.
            let start = from.max(0).min(texels - ONE);
            let end = (from + width).max(start + ONE).min(texels);
            from += step;
            Span {
                first: whole(start) as u32,
                last: whole(end) as u32,
                before: fraction(start),
                beyond: fraction(end),
                share: if end - start == width { full } else { 1.0 / ((end - start) as f32 / ONE as f32) },
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

/// Numbers of texels and pixels with a fraction: sums of them are exact, and parts need no conversion.
const FRACTION_BITS: u32 = 32;
const ONE: i64 = 1 << FRACTION_BITS;
/// Numbers that leave room for sums of a few.
const LARGEST: f64 = (1 << 28) as f64;

fn fixed(v: f64) -> i64 {
    (v * ONE as f64) as i64
}

fn whole(v: i64) -> i64 {
    v >> FRACTION_BITS
}

fn fraction(v: i64) -> f32 {
    (v & (ONE - 1)) as f32 / ONE as f32
}

/// Strips in a pixel at 45 degrees.
const MOST_PARTS: f64 = 4.0;

/// From where to where a footprint around a place sees an image of some length: at least one texel, so
/// that the image's ends go on.
#[inline]
fn extent(middle: f64, width: f64, length: f64) -> (f64, f64) {
    let from = (middle - 0.5 * width).max(0.0).min(length - 1.0);
    (from, (middle + 0.5 * width).max(from + 1.0).min(length))
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

/// The layer over `rect`: premultiplied means, clear where no footprint meets the image.
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
    let mut sums = vec![[0u32; 4]; width + 2];
    let (mut spans, mut means) = (Vec::new(), vec![CLEAR; scan.strips]);
    let mut piles = (scan.across_strips != 0.0 && scan.along.abs() >= 1.0).then(|| Piles::new(scan));
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
        if let Some(piles) = &mut piles {
            piles.add(scan, row, strips.clone(), means, pixels);
            if row == 0 {
                piles.add_above(scan, strips.clone(), means, pixels);
            }
            if row + 1 == height {
                piles.add_below(scan, height, strips, means, pixels);
            }
        } else if scan.across_strips == 0.0 {
            scan.shares(0, row, height, |pixel, share| {
                let pixels = &mut pixels[pixel * scan.strips..][strips.clone()];
                pixels.iter_mut().zip(&*means).for_each(|(pixel, mean)| add(pixel, mean, share));
            });
        } else {
            for (strip, mean) in strips.zip(&*means) {
                scan.shares(strip, row, height, |pixel, share| {
                    add(&mut pixels[pixel * scan.strips + strip], mean, share);
                });
            }
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
    /// The upper edge of the first row in the first strip, in pixels from the strip's upper end; and how
    /// much farther it is in the next strip, and in the next row.
    start: i64,
    step: i64,
    row_height: i64,
    /// Is a strip's upper end its last pixel?
    upside_down: bool,
    piles: Vec<Pile>,
}

#[derive(Clone, Copy)]
struct Pile {
    sum: Pixel,
    /// The height of the rows in it.
    height: f32,
}

impl Piles {
    fn new(scan: &Scan) -> Piles {
        let upside_down = scan.along < 0.0;
        let first = if upside_down { scan.top + scan.along * (scan.pixels - 1) as f64 } else { scan.top };
        let row_height = 1.0 / scan.along.abs();
        Piles {
            start: fixed(0.5 - first * row_height),
            step: fixed(-scan.across_strips * row_height),
            row_height: fixed(row_height),
            upside_down,
            piles: vec![Pile { sum: CLEAR, height: 0.0 }; scan.strips],
        }
    }

    /// Where the upper edge of a row is in a strip.
    fn top(&self, row: usize, strip: usize) -> i64 {
        self.start + self.row_height * row as i64 + self.step * strip as i64
    }

    /// Adds what strips have of a row.
    fn add(&mut self, scan: &Scan, row: usize, strips: Range<usize>, means: &[Pixel], pixels: &mut [Pixel]) {
        let target = self.target(scan);
        let mut top = self.top(row, strips.start);
        let piles = &mut self.piles[strips.clone()];
        for ((strip, mean), pile) in strips.zip(means).zip(piles) {
            let bottom = top + self.row_height;
            let pixel = whole(top);
            if whole(bottom) == pixel {
                pile.add(mean, self.row_height);
            } else {
                let end = (pixel + 1) << FRACTION_BITS;
                pile.add(mean, end - top);
                target.put(pixels, strip, pixel, &pile.mean());
                *pile = Pile { sum: CLEAR, height: 0.0 };
                pile.add(mean, bottom - end);
            }
            top += self.step;
        }
    }

    /// Adds what strips have of an image's first row, where it goes on above.
    fn add_above(&self, scan: &Scan, strips: Range<usize>, means: &[Pixel], pixels: &mut [Pixel]) {
        let target = self.target(scan);
        for (strip, mean) in strips.zip(means) {
            let pixel = whole(self.top(0, strip));
            for above in (pixel - target.margin).max(0)..pixel.min(target.pixels) {
                target.put(pixels, strip, above, mean);
            }
        }
    }

    /// Adds what is left when the last row of an image so high is done, and what strips have of the row
    /// where it goes on below.
    fn add_below(
        &self,
        scan: &Scan,
        height: usize,
        strips: Range<usize>,
        means: &[Pixel],
        pixels: &mut [Pixel],
    ) {
        let target = self.target(scan);
        for (strip, mean) in strips.zip(means) {
            let (mut pixel, pile) = (whole(self.top(height, strip)), &self.piles[strip]);
            if pile.height > 0.0 {
                target.put(pixels, strip, pixel, &pile.mean());
                pixel += 1;
            }
            for below in pixel.max(0)..(pixel + target.margin).min(target.pixels) {
                target.put(pixels, strip, below, mean);
            }
        }
    }

    fn target(&self, scan: &Scan) -> Target {
        Target {
            pixels: scan.pixels as i64,
            upside_down: self.upside_down,
            columns: scan.columns(),
            parts_log2: scan.parts_log2,
            part: 1.0 / (1 << scan.parts_log2) as f32,
            margin: (scan.margin / scan.along.abs()) as i64,
        }
    }
}

/// The layer that piles become pixels of.
struct Target {
    pixels: i64,
    upside_down: bool,
    columns: usize,
    parts_log2: u32,
    /// One strip's share of a pixel.
    part: f32,
    /// Pixels beyond an image's edges that see it.
    margin: i64,
}

impl Target {
    #[inline]
    fn put(&self, pixels: &mut [Pixel], strip: usize, pixel: i64, mean: &Pixel) {
        if (0..self.pixels).contains(&pixel) {
            let pixel = if self.upside_down { self.pixels - 1 - pixel } else { pixel } as usize;
            add(&mut pixels[pixel * self.columns + (strip >> self.parts_log2)], mean, self.part);
        }
    }
}

impl Pile {
    #[inline]
    fn add(&mut self, mean: &Pixel, height: i64) {
        let height = height as f32;
        add(&mut self.sum, mean, height);
        self.height += height;
    }

    #[inline]
    fn mean(&self) -> Pixel {
        let share = 1.0 / self.height;
        self.sum.map(|v| v * share)
    }
}

/// The mean of a row of texels over each span; `sums` has room for two more than there are texels.
fn strip_means(
    texels: &[[u8; 4]],
    weighted: impl Fn([u8; 4]) -> [u32; 4],
    unit: f32,
    spans: &[Span],
    sums: &mut [[u32; 4]],
    means: &mut [Pixel],
) {
    // Spans go either way.
    let (one, other) = (&spans[0], &spans[spans.len() - 1]);
    let first = one.first.min(other.first) as usize;
    let end = (one.last.max(other.last) as usize + 1).min(texels.len());
    // Of each texel, the sum of those before it; one texel of nothing more, where spans may end.
    let sums = &mut sums[..end - first + 2];
    let mut sum = [0u32; 4];
    for (&texel, after) in texels[first..end].iter().zip(&mut sums[1..]) {
        let texel = weighted(texel);
        sum = std::array::from_fn(|i| sum[i].wrapping_add(texel[i]));
        *after = sum;
    }
    sums[end - first + 1] = sum;
    let unit = 1.0 / unit;
    for (span, mean) in spans.iter().zip(means) {
        let (mut from, to) = (span.first as usize - first, span.last as usize - first);
        let (starts, ends) = (&sums[from..from + 2], &sums[to..to + 2]);
        let (start, end) = (difference(starts[0], starts[1]), difference(ends[0], ends[1]));
        let mut sum: Pixel = std::array::from_fn(|i| end[i] * span.beyond - start[i] * span.before);
        while to - from > MOST_TEXELS {
            add(&mut sum, &difference(sums[from], sums[from + MOST_TEXELS]), 1.0);
            from += MOST_TEXELS;
        }
        let last = difference(sums[from], sums[to]);
        let share = span.share * unit;
        *mean = std::array::from_fn(|i| (last[i] + sum[i]) * share);
    }
}

/// Between running sums which may have overflowed since.
#[inline]
fn difference(from: [u32; 4], to: [u32; 4]) -> Pixel {
    std::array::from_fn(|i| to[i].wrapping_sub(from[i]) as i32 as f32)
}

/// Texels whose sum surely is an `i32`.
const MOST_TEXELS: usize = 1 << 15;

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
