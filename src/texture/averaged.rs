//! Takes an image, makes each pixel of a layer the mean of the image over the pixel's footprint, in two
//! passes (Catmull and Smith 1980, *3-D Transformations of Images in Scanline Order*).
//!
//! The first pass makes of a row of texels (the image's pixels) one mean for each strip, a column of the
//! layer's pixels or a part of its width: the differences of the row's running sums, a summed-area table
//! (Crow 1984, *Summed-Area Tables for Texture Mapping*) of one row. The second shares these means out among
//! the pixels of the strips. Every texel is read once, nothing of the image is held but one row, and the
//! footprints of neighbours abut: within its strip a pixel's is the parallelogram with two sides
//! along the strip and two along the rows of texels, as large as the pixel itself; the narrower the strips,
//! the nearer their union is to the pixel. A footprint that would lie within a texel's width or height is made
//! as wide or high as a texel, so where an image is enlarged along an axis its texels blend into one another
//! linearly.
//!
//! Where an image lies on its side, strips are rows of the layer. Where a strip crosses several texels within
//! a row, the row is read in slices. Where an edge of the image lies askew in a pixel, a strip and a row count
//! for as much as they see of the image.

use super::levels::{Level, UNIT};
use super::piles::{Piles, Sums};
use super::scan::{Scan, Span};
use super::Image;
use crate::effects::layer::{IntRect, Layer, Pixel, Space, CLEAR};
use std::ops::Range;

/// The layer over `rect`: premultiplied means, clear where no footprint meets the image. The scan is over the
/// image's level `log2`.
pub(super) fn drawn(image: &Image, log2: u32, scan: &Scan, rect: IntRect) -> Layer {
    let opaque = image.is_opaque();
    if log2 > 0 {
        let level = Level::of(image, log2);
        let texels = Texels { texels: &level.texels, columns: level.columns, unit: UNIT };
        return averaged(&texels, scan, rect, opaque, |texel| texel.map(u32::from));
    }
    let (texels, columns) = (image.pixels(), image.rect().width());
    if opaque && !scan.blends() {
        averaged(&Texels { texels, columns, unit: 255 }, scan, rect, opaque, |texel| texel.map(u32::from))
    } else {
        averaged(&Texels { texels, columns, unit: UNIT }, scan, rect, opaque, |[r, g, b, a]| {
            [r, g, b, 255].map(|v| u32::from(v) * u32::from(a))
        })
    }
}

/// What is read: texels row by row, each channel up to `unit` once it is weighted.
struct Texels<'t, T> {
    texels: &'t [T],
    columns: usize,
    unit: u32,
}

impl<T> Texels<'_, T> {
    fn row(&self, row: usize) -> &[T] {
        &self.texels[row * self.columns..][..self.columns]
    }
}

/// `weighted` gives a texel's premultiplied channels as whole numbers up to the texels' unit.
fn averaged<T: Copy>(
    texels: &Texels<T>,
    scan: &Scan,
    rect: IntRect,
    opaque: bool,
    weighted: impl Fn(T) -> [u32; 4],
) -> Layer {
    let mut layer = Layer::clear(rect, Space::Srgb);
    let mut on_its_side = vec![CLEAR; if scan.turned { rect.width() * rect.height() } else { 0 }];
    let pixels = if scan.turned { &mut on_its_side[..] } else { layer.pixels_mut() };
    let mut first_pass = FirstPass::new(texels.columns, scan, 1.0 / texels.unit as f32);
    let mut read = |row: usize, strips: Range<usize>, pass: &mut FirstPass| {
        let (one, other) = scan.texels_of(row);
        let one = texels.row(one);
        match other {
            None => pass.run(scan, row, strips, |range| one[range].iter().map(|&texel| weighted(texel))),
            Some((other, share)) => {
                let other = texels.row(other);
                pass.run(scan, row, strips, |range| {
                    let pairs = one[range.clone()].iter().zip(&other[range]);
                    pairs.map(|(&one, &other)| blended(weighted(one), weighted(other), share))
                });
            }
        }
    };
    match scan.is_straight() {
        true => straight(scan, pixels, &mut first_pass, &mut read),
        false => askew(scan, pixels, &mut first_pass, &mut read),
    }
    bounded(pixels, opaque);
    if scan.turned {
        for (strip, row) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
            for (pixel, to) in row.iter_mut().enumerate() {
                *to = on_its_side[pixel * scan.columns() + strip];
            }
        }
    }
    layer
}

/// Reads a row for some strips.
type Read<'r> = &'r mut dyn FnMut(usize, Range<usize>, &mut FirstPass);

/// Shares rows out among whole rows of pixels.
fn straight(scan: &Scan, pixels: &mut [Pixel], pass: &mut FirstPass, read: Read) {
    for row in scan.rows_seen() {
        let strips = scan.strips_in(row);
        if strips.is_empty() {
            continue;
        }
        read(row, strips.clone(), pass);
        scan.shares(0, row, |pixel, share, _| {
            let pixels = &mut pixels[pixel * scan.strips..][strips.clone()];
            pixels.iter_mut().zip(&pass.means).for_each(|(pixel, mean)| add(pixel, mean, share as f32));
        });
    }
}

/// Shares rows out strip by strip.
fn askew(scan: &Scan, pixels: &mut [Pixel], pass: &mut FirstPass, read: Read) {
    let mut piles = (scan.across_strips != 0.0 && scan.along.abs() >= 1.0).then(|| Piles::new(scan));
    let mut sums = Sums::new(pixels);
    for row in scan.rows_seen() {
        let strips = scan.strips_in(row);
        if strips.is_empty() {
            continue;
        }
        read(row, strips.clone(), pass);
        if let Some(piles) = &mut piles {
            piles.add(row, strips.clone(), &pass.spans, &pass.means, &mut sums);
            if row == 0 {
                piles.add_above(strips.clone(), &pass.spans, &pass.means, &mut sums);
            }
            if row == scan.last_row() {
                piles.add_below(strips, &pass.spans, &pass.means, &mut sums);
            }
        } else if scan.across_strips == 0.0 {
            scan.shares(0, row, |pixel, share, seen| {
                let first = pixel * scan.strips + strips.start;
                for (at, (mean, span)) in pass.means.iter().zip(&pass.spans).enumerate() {
                    sums.add(first + at, mean, share, seen * span.seen);
                }
            });
        } else {
            for (strip, (mean, span)) in strips.zip(pass.means.iter().zip(&pass.spans)) {
                scan.shares(strip, row, |pixel, share, seen| {
                    sums.add(pixel * scan.strips + strip, mean, share, seen * span.seen);
                });
            }
        }
    }
    sums.divide();
}

/// The first pass: a row's means over strips, and what it takes to make them.
struct FirstPass {
    spans: Vec<Span>,
    means: Vec<Pixel>,
    /// Of each texel, the sum of those before it; room for two more than there are texels.
    sums: Vec<[u32; 4]>,
    unit: f32,
}

impl FirstPass {
    fn new(columns: usize, scan: &Scan, unit: f32) -> FirstPass {
        FirstPass {
            spans: Vec::with_capacity(scan.strips),
            means: Vec::with_capacity(scan.strips),
            sums: vec![[0; 4]; columns + 2],
            unit,
        }
    }

    /// Makes the means of a row for some strips; `texels` gives the row's texels in a range.
    fn run<I: Iterator<Item = [u32; 4]>>(
        &mut self,
        scan: &Scan,
        row: usize,
        strips: Range<usize>,
        texels: impl FnOnce(Range<usize>) -> I,
    ) {
        if self.spans.is_empty() || !scan.is_upright() {
            scan.spans(row, strips, &mut self.spans);
        }
        // Spans go either way.
        let (one, other) = (&self.spans[0], &self.spans[self.spans.len() - 1]);
        let first = one.first.min(other.first) as usize;
        let end = (one.last.max(other.last) as usize + 1).min(self.sums.len() - 2);
        // One texel of nothing more, where spans may end.
        let sums = &mut self.sums[..end - first + 2];
        let mut sum = [0u32; 4];
        for (texel, after) in texels(first..end).zip(&mut sums[1..]) {
            sum = std::array::from_fn(|i| sum[i].wrapping_add(texel[i]));
            *after = sum;
        }
        sums[end - first + 1] = sum;
        self.means.clear();
        self.means.extend(self.spans.iter().map(|span| mean(sums, span, first, self.unit)));
    }
}

/// The mean over a span, of running sums from a texel on.
#[inline]
fn mean(sums: &[[u32; 4]], span: &Span, first: usize, unit: f32) -> Pixel {
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
    std::array::from_fn(|i| (last[i] + sum[i]) * share)
}

/// Between running sums which may have overflowed since.
#[inline]
fn difference(from: [u32; 4], to: [u32; 4]) -> Pixel {
    std::array::from_fn(|i| to[i].wrapping_sub(from[i]) as i32 as f32)
}

/// Texels whose sum surely is an `i32`.
const MOST_TEXELS: usize = 1 << 15;

/// Between two texels of [`UNIT`], a share of the way to the other.
fn blended(one: [u32; 4], other: [u32; 4], share: f64) -> [u32; 4] {
    const WHOLE: u32 = 1 << 14;
    let share = (share * f64::from(WHOLE)) as u32;
    std::array::from_fn(|i| (one[i] * (WHOLE - share) + other[i] * share + WHOLE / 2) / WHOLE)
}

#[inline]
pub(super) fn add(sum: &mut Pixel, pixel: &Pixel, share: f32) {
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
