//! Takes a transform and the sizes of a layer and an image, makes the order in which the image is read and
//! where its rows lie in the layer: strips, spans of texels and shares of pixels ([`super::averaged`]).

use crate::effects::layer::IntRect;
use kurbo::Affine;
use std::ops::Range;

/// Where the strips and pixels of a layer lie in an image: pixel j of strip i has its middle in row
/// `top + across_strips * i + along * j`.
///
/// A strip that crosses many texels within one row sees it in slices, each a little farther on. Rows are
/// counted in slices here.
pub(super) struct Scan {
    /// Are strips rows of the layer?
    pub turned: bool,
    /// Strips beside one another in a pixel: two to the power of this.
    pub parts_log2: u32,
    pub strips: usize,
    /// Pixels of a strip.
    pub pixels: usize,
    /// Slices of a row of texels: two to the power of this.
    pub slices_log2: u32,
    /// Over how much of a row's height neighbouring rows blend, where slices are made of enlarged rows.
    blend: f64,
    /// Texels from one strip to the next, and from one row to the next along a strip.
    step: f64,
    slant: f64,
    /// The middle of the first strip in the upper edge of the first row.
    start: f64,
    pub across_strips: f64,
    pub along: f64,
    pub top: f64,
    /// Width and height of a footprint.
    width: f64,
    height: f64,
    /// Longest side of a footprint, in texels.
    longest: f64,
    /// Texels beyond the edges where pixels may lie that see the image, and rows.
    margin: f64,
    pub row_margin: f64,
    /// The image's width in texels and height in rows. The last ones of a level may be less than whole.
    texels: f64,
    pub rows: f64,
}

/// Slices of a pixel, at most, and how much of a strip's width it may go on within one.
const MOST_SLICES: f64 = 32.0;
const SLICE: f64 = 0.25;
const MOST_SLANT: f64 = 0.75;
/// Numbers of strips in a pixel which are doubled where it is at least so many texels wide.
const PARTS: [(f64, f64); 4] = [(1.0, 1.5), (2.0, 4.0), (4.0, 16.0), (8.0, 32.0)];
/// Strips in a pixel at 45 degrees, at least, where the widths allow it; and in one of many texels.
const ASKEW: f64 = 4.0;
const ASKEW_OF_MANY: f64 = 16.0;
const MANY: f64 = 16.0;

impl Scan {
    /// Over the pixels of a rectangle; `back` leads from them to an image so wide and high, at least one
    /// texel each, which are `squares` or blend where they are enlarged. `None` where numbers end: one is
    /// millions of times as large as the other, or as far away.
    pub fn new(back: Affine, rect: IntRect, (texels, rows): (f64, f64), squares: bool) -> Option<Scan> {
        let [a, b, c, d, e, f] = (back * Affine::translate(rect.to_rect().origin().to_vec2())).as_coeffs();
        let turned = b.abs() > d.abs();
        let (a, b, c, d) = if turned { (c, d, a, b) } else { (a, b, c, d) };
        let (strips, pixels) =
            if turned { (rect.height(), rect.width()) } else { (rect.width(), rect.height()) };
        let margin = 3.0 * (a.abs() + b.abs() + c.abs() + d.abs()) + 2.0;
        let slant = c / d;
        let step = a - b * slant;
        let longest = [a, b, c, d, step].into_iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let slices_log2 = slices_log2(step, slant, d);
        let slices = f64::from(1u32 << slices_log2);
        // What a pixel lacks of a texel.
        let (lack, row_lack) = match squares {
            false => ((1.0 - a.abs() - c.abs()).max(0.0), (1.0 - b.abs() - d.abs()).max(0.0)),
            true => (0.0, 0.0),
        };
        let blend = if slices_log2 > 0 { row_lack } else { 0.0 };
        let (b, d, f, slant, rows) = (b * slices, d * slices, f * slices, slant / slices, rows * slices);
        let across = a.abs().max(step.abs()).max((b / slices).abs());
        let parts_log2 = if d.abs() >= 1.0 { parts_log2(b / d, across) } else { 0 };
        let parts = f64::from(1u32 << parts_log2);
        let (step, b) = (step / parts, b / parts);
        let scan = Scan {
            turned,
            parts_log2,
            strips: strips << parts_log2,
            pixels,
            slices_log2,
            blend,
            step,
            slant,
            start: e + 0.5 * step - f * slant,
            across_strips: b,
            along: d,
            top: f + 0.5 * (b + d),
            // A row sees as much of a strip as the strip moves on in it.
            width: step.abs().max(slant.abs()) + lack,
            height: if blend > 0.0 { d.abs().max(1.0) } else { d.abs() + row_lack * slices },
            longest,
            margin,
            row_margin: margin * slices,
            texels,
            rows,
        };
        let numbers = [
            scan.start,
            scan.step * scan.strips as f64,
            scan.slant * scan.rows,
            scan.rows,
            scan.top,
            scan.across_strips * scan.strips as f64,
            scan.along * scan.pixels as f64,
            scan.row_margin,
        ];
        numbers.iter().all(|v| v.abs() < LARGEST).then_some(scan)
    }

    /// Pixels of the layer beside one another, each of one strip or of several.
    pub fn columns(&self) -> usize {
        self.strips >> self.parts_log2
    }

    /// Do the pixels' and the image's sides have the same directions?
    pub fn is_straight(&self) -> bool {
        self.slant == 0.0 && self.across_strips == 0.0
    }

    /// Is a footprint more than a texel?
    pub fn averages(&self) -> bool {
        self.longest > 1.0
    }

    /// Do the spans of all rows begin and end at the same places?
    pub fn is_upright(&self) -> bool {
        self.slant == 0.0
    }

    /// Do enlarged rows of texels blend into one another?
    pub fn blends(&self) -> bool {
        self.blend > 0.0
    }

    /// The last row of the image, be it whole or not.
    pub fn last_row(&self) -> usize {
        (self.rows.ceil() as usize).saturating_sub(1)
    }

    /// The rows that the layer shows.
    pub fn rows_seen(&self) -> Range<usize> {
        let ends = [0.0, self.across_strips * (self.strips - 1) as f64];
        let far = self.along * (self.pixels - 1) as f64;
        let ys = ends.iter().flat_map(|&y| [self.top + y, self.top + y + far]);
        let (top, bottom) = ys.fold((f64::MAX, f64::MIN), |(top, bottom), y| (top.min(y), bottom.max(y)));
        let last = self.last_row();
        let first = (top - 0.5 * self.height).max(0.0).min(last as f64) as usize;
        // One more, as rounded pixels may end a little beyond.
        let end = ((bottom + 0.5 * self.height).max(0.0) as usize).saturating_add(2);
        first..end.clamp(first + 1, last + 1)
    }

    /// The row of texels that a row of the scan lies in; and where it blends with another, that one and its
    /// share.
    pub fn texels_of(&self, row: usize) -> (usize, Option<(usize, f64)>) {
        let one = row >> self.slices_log2;
        if self.blend == 0.0 {
            return (one, None);
        }
        let slices = f64::from(1u32 << self.slices_log2);
        let at = (row as f64 + 0.5) / slices - one as f64;
        let last = self.last_row() >> self.slices_log2;
        let (other, share) = if at < 0.5 {
            (one.checked_sub(1), 0.5 - at / self.blend)
        } else {
            (Some(one + 1).filter(|&other| other <= last), 0.5 - (1.0 - at) / self.blend)
        };
        (one, other.filter(|_| share > 0.0).map(|other| (other, share)))
    }

    /// The strips that meet the image in a row, or lie just beside it.
    pub fn strips_in(&self, row: usize) -> Range<usize> {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        let strip = |x: f64| (x - middle) / self.step;
        let (one, other) = (strip(-self.margin), strip(self.texels + self.margin));
        let first = one.min(other).max(0.0) as usize;
        let end = (one.max(other).max(0.0) as usize).saturating_add(1).min(self.strips);
        first.min(end)..end
    }

    /// What a row has of each of these strips.
    pub fn spans(&self, row: usize, strips: Range<usize>, spans: &mut Vec<Span>) {
        let middle = self.start + self.slant * (row as f64 + 0.5);
        let (step, width) = (fixed(self.step), fixed(self.width));
        let (texels, least) = (fixed(self.texels), width.min(ONE));
        let full = (1.0 / self.width) as f32;
        let mut from = fixed(middle + self.step * strips.start as f64 - 0.5 * self.width);
        spans.clear();
        spans.extend(strips.map(|_| {
            let (start, end) = (from, from + width);
            from += step;
            if start >= 0 && end <= texels {
                return Span::new(start, end, full, 1.0);
            }
            let seen = to_float(end.min(texels) - start.max(0)) * full;
            // At least as much as a texel, so that the image's ends go on.
            let start = start.max(0).min(texels - least);
            let end = end.max(start + least).min(texels);
            Span::new(start, end, 1.0 / to_float(end - start), glimpsed(seen))
        }));
    }

    /// Calls `add` on all pixels of a strip that see a row, each with the row's share of the pixel and with
    /// how much of the pixel's height in this strip sees the image at all.
    #[inline]
    pub fn shares(&self, strip: usize, row: usize, mut add: impl FnMut(usize, f64, f32)) {
        let (row_top, row_bottom) = (row as f64, row as f64 + 1.0);
        let reach = 0.5 * self.height;
        // The first and the last row are also seen from beyond.
        let above = if row == 0 { self.row_margin } else { reach };
        let below = if row == self.last_row() { self.row_margin } else { reach };
        let middle = self.top + self.across_strips * strip as f64;
        let (one, other) =
            ((row_top - above - middle) / self.along, (row_bottom + below - middle) / self.along);
        let (first, last) = if one < other { (one, other) } else { (other, one) };
        if last < 0.0 {
            return;
        }
        let first = if first > 0.0 { first as usize } else { 0 };
        for pixel in first..=(last as usize).min(self.pixels - 1) {
            let middle = middle + self.along * pixel as f64;
            let (top, bottom) = self.extent(middle);
            let seen = if bottom < row_bottom { bottom } else { row_bottom }
                - if top > row_top { top } else { row_top };
            if seen > 0.0 {
                let inside = (middle + reach).min(self.rows) - (middle - reach).max(0.0);
                add(pixel, seen / (bottom - top), glimpsed((inside / self.height) as f32));
            }
        }
    }

    /// From where to where a footprint around a row sees the image: at least one row of it, so that the
    /// image's ends go on.
    #[inline]
    fn extent(&self, middle: f64) -> (f64, f64) {
        let least = self.height.min(1.0);
        let from = (middle - 0.5 * self.height).max(0.0).min(self.rows - least);
        (from, (middle + 0.5 * self.height).max(from + least).min(self.rows))
    }
}

/// How many slices of a row there are, as a power of two: the stairs of spans that strips become are to be
/// fine beside the strips' width. Their number is bounded by that of the slices in a pixel, beyond which a
/// strip is so long that its ends matter little.
fn slices_log2(step: f64, slant: f64, along: f64) -> u32 {
    let width = step.abs().max(1.0);
    if slant.abs() <= MOST_SLANT * width {
        return 0;
    }
    let is_coarse = |&log2: &u32| {
        let slices = f64::from(1u32 << log2);
        slant.abs() > SLICE * width * slices && along.abs() * slices < MOST_SLICES
    };
    (0..16).take_while(is_coarse).count() as u32
}

/// How many strips a pixel of so many texels has, as a power of two: the more, the more askew the
/// parallelograms are. In a wide one each costs little beside the reading of the texels.
fn parts_log2(slope: f64, across: f64) -> u32 {
    let askew = slope.abs() * if across >= MANY { ASKEW_OF_MANY } else { ASKEW };
    PARTS.iter().take_while(|(parts, least)| askew > *parts && across >= *least).count() as u32
}

/// The weight of what is seen only because the image goes on beyond its end.
pub(super) const GLIMPSE: f32 = 1.0 / 65536.0;

/// The whole, less what rounding may take of it.
pub(super) const WHOLE: f32 = 1.0 - 1.0 / 4096.0;

/// How much of a footprint lies in the image, rounded and no less than a glimpse.
fn glimpsed(seen: f32) -> f32 {
    if seen > WHOLE {
        1.0
    } else {
        seen.max(GLIMPSE)
    }
}

/// Numbers of texels and pixels with a fraction: sums of them are exact, and parts need no conversion.
pub(super) const FRACTION_BITS: u32 = 32;
pub(super) const ONE: i64 = 1 << FRACTION_BITS;
/// Numbers that leave room for sums of a few.
const LARGEST: f64 = (1 << 28) as f64;

pub(super) fn fixed(v: f64) -> i64 {
    (v * ONE as f64) as i64
}

pub(super) fn whole(v: i64) -> i64 {
    v >> FRACTION_BITS
}

pub(super) fn to_float(v: i64) -> f32 {
    v as f32 / ONE as f32
}

fn fraction(v: i64) -> f32 {
    to_float(v & (ONE - 1))
}

/// A part of a row of texels.
pub(super) struct Span {
    /// The texels in which it begins and ends.
    pub first: u32,
    pub last: u32,
    /// Texels of the first one before it begins, and of the last one before it ends.
    pub before: f32,
    pub beyond: f32,
    /// One over its length.
    pub share: f32,
    /// How much of its strip's width it is.
    pub seen: f32,
}

impl Span {
    #[inline]
    fn new(start: i64, end: i64, share: f32, seen: f32) -> Span {
        Span {
            first: whole(start) as u32,
            last: whole(end) as u32,
            before: fraction(start),
            beyond: fraction(end),
            share,
            seen,
        }
    }
}
