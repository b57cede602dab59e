//! Takes a shape's edges in one band, makes irregular pieces: edges clipped to scanline strips
//! [y, y+1) and there to pixels, filed in x-buckets (Catmull 1978, section 4, steps 1 and 2).
//!
//! Promises: where an edge enters a strip or a pixel depends on the edge alone, never on how it was
//! reached, so that the two sides of a shared border are cut bit-identically. A point on the border
//! between two pixels belongs to the right or lower one, everywhere.

use crate::bitmap::{word_mask, Bitmap};
use crate::coverage::BandPlace;
use crate::edges::{round, Edge, BAND_ROWS, FRACTION_BITS, ONE};

/// No piece.
pub(crate) const NO_PIECE: u32 = u32::MAX;

/// The part of an edge in one pixel, in fixed point from the pixel's top left corner, 0 ..= ONE; none lies on the
/// pixel's lower border. Like its edge it runs from the upper end to the lower (from left to right when horizontal).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    pub x0: u16,
    pub y0: u16,
    pub x1: u16,
    pub y1: u16,
    /// The next piece of the same shape in the same pixel, or [`NO_PIECE`].
    pub next: u32,
    /// As [`Edge::winding`].
    pub winding: i8,
    /// Which end lies on the pixel's left border because the edge crosses it there.
    pub crosses_left: CrossesLeft,
}

/// Where an edge crosses the left border of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CrossesLeft {
    No,
    AtStart,
    AtEnd,
}

/// What a shape leaves in one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cell {
    /// Winding times height of the pieces here, in 1/ONE: what the pixels to the right see.
    pub cover: i32,
    /// The last piece, or [`NO_PIECE`].
    pub pieces: u32,
    /// Twice the winding times the area right of the pieces, in 1/ONE^2.
    pub area: i64,
}

impl Default for Cell {
    #[inline]
    fn default() -> Cell {
        Cell { cover: 0, pieces: NO_PIECE, area: 0 }
    }
}

/// One shape's x-buckets in one band: a cell for each pixel, which cells are in use, and for each row
/// what lies left of the picture. Here a cell is a [`Cell`], and its [`Cell::cover`] all that is known
/// of what lies left.
pub(crate) struct Buckets<C = Cell, L = i32> {
    width: usize,
    cells: Vec<C>,
    touched: Bitmap,
    left: [L; BAND_ROWS as usize],
}

impl<C: Clone + Default, L: Default> Buckets<C, L> {
    /// For a picture of this many pixels in a row.
    pub fn new(width: u32) -> Self {
        let (width, rows) = (width as usize, BAND_ROWS as usize);
        let (cells, touched) = (vec![C::default(); width * rows], Bitmap::new(width, rows));
        Buckets { width, cells, touched, left: Default::default() }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// All that lies left of the picture, which is emptied.
    pub fn take_left(&mut self, row: usize) -> L {
        std::mem::take(&mut self.left[row])
    }

    /// What lies left of the picture.
    #[inline]
    pub fn left_mut(&mut self, row: usize) -> &mut L {
        &mut self.left[row]
    }

    /// The cell of a pixel, in use from now on, and whether the pixel is `finished`. Finished pixels side by
    /// side, of one word, have one cell, the first one's: where among them a shape goes on is not asked for.
    #[inline(always)]
    pub fn touch(&mut self, row: usize, pixel: usize, finished: &Bitmap) -> (&mut C, bool) {
        let (word, bit) = (row * finished.words() + pixel / 64, 1 << (pixel % 64));
        let hidden = finished.bits()[word];
        if hidden & bit == 0 {
            self.touched.bits_mut()[word] |= bit;
            return (&mut self.cells[row * self.width + pixel], false);
        }
        let back = (hidden << (63 - pixel % 64)).leading_ones() as usize - 1;
        self.touched.bits_mut()[word] |= bit >> back;
        (&mut self.cells[row * self.width + pixel - back], true)
    }

    /// The pixels in use in `row` within columns [from, to), from the left, with their cells, which
    /// are emptied.
    #[inline]
    pub fn drain_row(&mut self, row: usize, (from, to): (usize, usize), mut take: impl FnMut(usize, C)) {
        let cells = &mut self.cells[row * self.width..][..self.width];
        let words = &mut self.touched.row_mut(row)[from / 64..to.div_ceil(64)];
        for (index, word) in words.iter_mut().enumerate() {
            let mut bits = std::mem::take(word);
            while bits != 0 {
                let x = (from / 64 + index) * 64 + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                take(x, std::mem::take(&mut cells[x]));
            }
        }
    }
}

impl Buckets {
    /// Files the pieces of `edge`. Pixels that are `finished` get none.
    #[inline(always)]
    pub fn add(&mut self, edge: &Edge, place: BandPlace, finished: &Bitmap, pieces: &mut Vec<Piece>) {
        let width = self.width;
        clip_edge(edge, place, width, &mut Filer { buckets: self, finished, pieces });
    }
}

/// Takes the parts of an edge, pixel by pixel.
pub(crate) trait Bins {
    /// The pixels of which nothing is asked but how much of an edge lies there or left of there.
    fn finished(&self) -> &Bitmap;

    /// A part that lies left of the picture, at heights [y0, y1) of a row.
    fn left_of_picture(&mut self, row: usize, heights: (i32, i32), winding: i32);

    /// A part in one pixel: its ends from the pixel's top left corner in fixed point, 0 ..= ONE, and where
    /// it crosses the left border. It runs from the upper end to the lower.
    fn put(&mut self, row: usize, pixel: usize, ends: [i32; 4], winding: i32, crosses_left: CrossesLeft);
}

/// Clips `edge` to the strips of a band, and there to the pixels of a picture that is `width` wide. Rows
/// below the picture's end get nothing.
#[inline(always)]
pub(crate) fn clip_edge<B: Bins>(edge: &Edge, place: BandPlace, width: usize, bins: &mut B) {
    let top = (place.top as i32) << FRACTION_BITS;
    let row = (edge.y0 - top) >> FRACTION_BITS;
    if row < 0 || edge.y1 > top + ((row + 1) << FRACTION_BITS) {
        return clip_to_strips(edge, place, width, bins);
    }
    let row_top = top + (row << FRACTION_BITS);
    let (y0, y1) = (edge.y0 - row_top, edge.y1 - row_top);
    // It lies in one strip. On the strip's upper border it would bound nothing inside.
    if y1 == 0 {
        return;
    }
    let row = row as usize;
    let pixel = edge.x0 >> FRACTION_BITS;
    if pixel == edge.x1 >> FRACTION_BITS && (0..width as i32).contains(&pixel) {
        // And in one pixel, as most chords of curves do.
        let left = pixel << FRACTION_BITS;
        let ends = [edge.x0 - left, y0, edge.x1 - left, y1];
        return bins.put(row, pixel as usize, ends, edge.winding, CrossesLeft::No);
    }
    if let Some(pixel) = hidden_at(edge, (row, row), width, bins.finished()) {
        return bins.put(row, pixel, [0, y0, 0, y1], edge.winding, CrossesLeft::No);
    }
    let mut clipper = Clipper { bins, width: width as i32, winding: edge.winding, row };
    clipper.strip(Strip { x0: edge.x0, y0, x1: edge.x1, y1 });
}

/// The leftmost pixel of an edge of which all pixels in rows `first ..= last` are finished. Not found where it may meet
/// pixels of several words, or lies beside the picture.
#[inline(always)]
fn hidden_at(edge: &Edge, (first, last): (usize, usize), width: usize, finished: &Bitmap) -> Option<usize> {
    let word_at = |row: usize, pixel: usize| row * finished.words() + pixel / 64;
    // Of most that are not hidden the first pixel tells.
    let start = (edge.x0 >> FRACTION_BITS) as usize;
    let word = *finished.bits().get(word_at(first, start))?;
    if word >> (start % 64) & 1 == 0 {
        return None;
    }
    let left = (edge.x0.min(edge.x1) >> FRACTION_BITS) as usize;
    let right = (edge.x0.max(edge.x1) >> FRACTION_BITS) as usize;
    if right >= width || left / 64 != right / 64 {
        return None;
    }
    let mask = word_mask(left % 64, right % 64 + 1);
    (first..=last).all(|row| finished.bits()[word_at(row, left)] & mask == mask).then_some(left)
}

/// As [`clip_edge`], for an edge that may meet several strips.
fn clip_to_strips<B: Bins>(edge: &Edge, place: BandPlace, width: usize, bins: &mut B) {
    let top = (place.top as i32) << FRACTION_BITS;
    let end = edge.y1.min(top + place.count as i32 * ONE);
    let start = edge.y0.max(top);
    if start >= end {
        return;
    }
    let row_at = |y: i32| ((y - top) >> FRACTION_BITS) as usize;
    let (first, last) = (row_at(start), row_at(end - 1));
    if let Some(pixel) = hidden_at(edge, (first, last), width, bins.finished()) {
        for row in first..=last {
            let row_top = top + ((row as i32) << FRACTION_BITS);
            let ends = [0, (start - row_top).max(0), 0, (end - row_top).min(ONE)];
            bins.put(row, pixel, ends, edge.winding, CrossesLeft::No);
        }
        return;
    }
    let mut clipper = Clipper { bins, width: width as i32, winding: edge.winding, row: 0 };
    let slope = SlopeX::of(edge);
    let mut y = start;
    let mut x = slope.x_at(edge, y);
    while y < end {
        let row = (y - top) >> FRACTION_BITS;
        let row_top = top + (row << FRACTION_BITS);
        let next_y = (row_top + ONE).min(end);
        let next_x = slope.x_at(edge, next_y);
        clipper.row = row as usize;
        clipper.strip(Strip { x0: x, y0: y - row_top, x1: next_x, y1: next_y - row_top });
        (x, y) = (next_x, next_y);
    }
}

/// The part of an edge in one strip: x in fixed point pixels, y in fixed point from the strip's top.
#[derive(Clone, Copy)]
struct Strip {
    x0: i32,
    y0: i32,
    x1: i32,
    y1: i32,
}

impl Strip {
    /// Rise over run, for [`Strip::y_at`].
    fn slope(&self) -> f64 {
        f64::from(self.y1 - self.y0) / (f64::from(self.x1) - f64::from(self.x0))
    }

    /// Where it crosses a vertical line between its ends.
    fn y_at(&self, slope: f64, x: i32) -> i32 {
        let dy = round((f64::from(x) - f64::from(self.x0)) * slope);
        (self.y0 + dy).clamp(self.y0, self.y1)
    }
}

/// Run over rise of an edge.
struct SlopeX(f64);

impl SlopeX {
    fn of(edge: &Edge) -> SlopeX {
        let run = f64::from(edge.x1) - f64::from(edge.x0);
        SlopeX(run / (f64::from(edge.y1) - f64::from(edge.y0)))
    }

    /// Where the edge crosses a horizontal line between its ends. The offset from the upper end is
    /// rounded, not the place itself, so that moving a drawing by whole pixels moves all crossings.
    #[inline]
    fn x_at(&self, edge: &Edge, y: i32) -> i32 {
        if y == edge.y0 {
            return edge.x0;
        }
        if y == edge.y1 {
            return edge.x1;
        }
        let dx = (f64::from(y) - f64::from(edge.y0)) * self.0;
        // An offset beyond 2^31 wraps, and its sum wraps back to the right place.
        edge.x0.wrapping_add(round(dx))
    }
}

/// Clips one edge, strip by strip.
struct Clipper<'a, B> {
    bins: &'a mut B,
    width: i32,
    winding: i32,
    row: usize,
}

impl<B: Bins> Clipper<'_, B> {
    /// Clips one strip's part of the edge to pixels.
    #[inline(always)]
    fn strip(&mut self, strip: Strip) {
        let (first, last) = (strip.x0 >> FRACTION_BITS, strip.x1 >> FRACTION_BITS);
        if first == last {
            let left = first << FRACTION_BITS;
            let ends = [strip.x0 - left, strip.y0, strip.x1 - left, strip.y1];
            self.put_leftwards(first, ends, CrossesLeft::No);
        } else if first < last {
            self.rightwards(strip, first, last);
        } else {
            self.leftwards(strip, first, last);
        }
    }

    /// From pixel `first` to pixel `last`, which lies right of it.
    #[inline(never)]
    fn rightwards(&mut self, strip: Strip, first: i32, last: i32) {
        let width = self.width;
        let slope = strip.slope();
        let mut y = strip.y0;
        let mut x = strip.x0 - (first << FRACTION_BITS);
        let mut crosses = CrossesLeft::No;
        let mut pixel = first;
        if first < 0 {
            // All that lies left of the picture is one bucket.
            if last < 0 {
                self.put(-1, [0, strip.y0, 0, strip.y1], CrossesLeft::No);
                return;
            }
            y = strip.y_at(slope, 0);
            self.put(-1, [0, strip.y0, 0, y], CrossesLeft::No);
            (pixel, x, crosses) = (0, 0, CrossesLeft::AtStart);
        }
        while pixel < last {
            if pixel >= width {
                return;
            }
            let next_y = strip.y_at(slope, (pixel + 1) << FRACTION_BITS);
            self.put(pixel, [x, y, ONE, next_y], crosses);
            (pixel, x, y, crosses) = (pixel + 1, 0, next_y, CrossesLeft::AtStart);
        }
        self.put(last, [x, y, strip.x1 - (last << FRACTION_BITS), strip.y1], crosses);
    }

    /// From pixel `first` to pixel `last`, which lies left of it.
    #[inline(never)]
    fn leftwards(&mut self, strip: Strip, first: i32, last: i32) {
        let width = self.width;
        let slope = strip.slope();
        let mut y = strip.y0;
        let mut x = strip.x0 - (first << FRACTION_BITS);
        let mut pixel = first;
        if first < 0 {
            self.put(-1, [0, strip.y0, 0, strip.y1], CrossesLeft::No);
            return;
        }
        if first >= width {
            // What lies right of the picture counts for nothing.
            if last >= width {
                return;
            }
            pixel = width - 1;
            x = ONE;
            y = strip.y_at(slope, width << FRACTION_BITS);
        }
        while pixel > last {
            if pixel < 0 {
                self.put(-1, [0, y, 0, strip.y1], CrossesLeft::No);
                return;
            }
            let next_y = strip.y_at(slope, pixel << FRACTION_BITS);
            self.put_leftwards(pixel, [x, y, 0, next_y], CrossesLeft::AtEnd);
            (pixel, x, y) = (pixel - 1, ONE, next_y);
        }
        self.put_leftwards(last, [x, y, strip.x1 - (last << FRACTION_BITS), strip.y1], CrossesLeft::No);
    }

    /// As [`Clipper::put`], for a piece that runs to the left: where rounding has made it horizontal it is
    /// turned round.
    #[inline(always)]
    fn put_leftwards(&mut self, pixel: i32, [x0, y0, x1, y1]: [i32; 4], crosses_left: CrossesLeft) {
        if y0 != y1 || x0 <= x1 {
            return self.put(pixel, [x0, y0, x1, y1], crosses_left);
        }
        let crosses_left = match crosses_left {
            CrossesLeft::AtEnd => CrossesLeft::AtStart,
            other => other,
        };
        self.winding = -self.winding;
        self.put(pixel, [x1, y0, x0, y1], crosses_left);
        self.winding = -self.winding;
    }

    /// Hands on a piece: its ends from the pixel's top left corner, and where it crosses the left border. What rounding
    /// has put on the strip's lower border bounds nothing inside.
    #[inline(always)]
    fn put(&mut self, pixel: i32, ends: [i32; 4], crosses_left: CrossesLeft) {
        if ends[1] == ONE {
            return;
        }
        if pixel < 0 {
            self.bins.left_of_picture(self.row, (ends[1], ends[3]), self.winding);
        } else if pixel < self.width {
            self.bins.put(self.row, pixel as usize, ends, self.winding, crosses_left);
        }
    }
}

/// Files pieces in buckets.
struct Filer<'a> {
    buckets: &'a mut Buckets,
    finished: &'a Bitmap,
    pieces: &'a mut Vec<Piece>,
}

impl Bins for Filer<'_> {
    #[inline(always)]
    fn finished(&self) -> &Bitmap {
        self.finished
    }

    #[inline(always)]
    fn left_of_picture(&mut self, row: usize, (y0, y1): (i32, i32), winding: i32) {
        *self.buckets.left_mut(row) += (y1 - y0) * winding;
    }

    #[inline(always)]
    fn put(
        &mut self,
        row: usize,
        pixel: usize,
        [x0, y0, x1, y1]: [i32; 4],
        winding: i32,
        crosses_left: CrossesLeft,
    ) {
        let cover = (y1 - y0) * winding;
        let (cell, is_finished) = self.buckets.touch(row, pixel, self.finished);
        cell.cover += cover;
        if is_finished {
            return;
        }
        cell.area += i64::from(cover) * i64::from(2 * ONE - x0 - x1);
        let next = std::mem::replace(&mut cell.pieces, self.pieces.len() as u32);
        let (x0, y0, x1, y1) = (x0 as u16, y0 as u16, x1 as u16, y1 as u16);
        self.pieces.push(Piece { x0, y0, x1, y1, next, winding: winding as i8, crosses_left });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const WIDTH: usize = 150;

    /// For each pixel of the band how much of the edges lies left of it, and the cell's area and number of pieces.
    fn filed(edges: &[Edge], place: BandPlace, finished: &Bitmap) -> Vec<(i32, i64, usize)> {
        let (mut buckets, mut pieces) = (Buckets::new(WIDTH as u32), Vec::new());
        edges.iter().for_each(|edge| buckets.add(edge, place, finished, &mut pieces));
        let mut pixels = Vec::new();
        for row in 0..BAND_ROWS as usize {
            let mut cells = vec![Cell::default(); WIDTH];
            let mut left = buckets.take_left(row);
            buckets.drain_row(row, (0, WIDTH), |x, cell| cells[x] = cell);
            for cell in cells {
                let mut next = cell.pieces;
                let count = std::iter::from_fn(|| {
                    let piece = pieces.get(next as usize)?;
                    next = piece.next;
                    Some(())
                });
                pixels.push((left, cell.area, count.count()));
                left += cell.cover;
            }
        }
        pixels
    }

    /// Whatever is finished, the other pixels know as much of the edges as if nothing were.
    #[test]
    fn finished_pixels_keep_nothing_from_the_others() {
        let mut numbers = Random::new(1);
        let mut random = |below: u64| numbers.below(below);
        let place = BandPlace { top: 8, count: 7 };
        let nothing = Bitmap::new(WIDTH, BAND_ROWS as usize);
        for _ in 0..2000 {
            let mut finished = nothing.clone();
            for row in 0..BAND_ROWS as usize {
                for _ in 0..random(4) {
                    let from = random(WIDTH as u64) as usize;
                    let to = (from + random(80) as usize).min(WIDTH);
                    (from..to).for_each(|x| finished.set(row, x));
                }
            }
            let mut at = |range: i64, least: i64| {
                (random((range as u64) << FRACTION_BITS) as i64 + (least << FRACTION_BITS)) as i32
            };
            let mut edges = Vec::new();
            for i in 0..6 {
                let reach = [200, 12, 2][i % 3];
                let (x0, y0) = (at(200, -25), at(9, 7));
                let (x1, y1) = (x0 + at(reach, -reach / 2), y0 + at(reach, 0));
                edges.push(Edge { x0, y0, x1, y1, winding: 1 - 2 * (i as i32 / 3) });
            }
            let (all, seen) = (filed(&edges, place, &nothing), filed(&edges, place, &finished));
            for (pixel, (all, seen)) in all.iter().zip(&seen).enumerate() {
                let (row, x) = (pixel / WIDTH, pixel % WIDTH);
                if !finished.get(row, x) {
                    assert_eq!(seen, all, "pixel {x} of row {row}: {edges:?}");
                }
            }
        }
    }
}
