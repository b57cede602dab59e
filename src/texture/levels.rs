//! Takes an image, makes smaller ones of it: a pyramid (Williams 1983, *Pyramidal Parametrics*) in which
//! each texel is the mean of a square of the image's own, 4 or 8 or 16 and so on a side.
//!
//! An image at the size of an icon then costs as much as the icon has pixels, not as the image has. The level
//! is taken from the spot's shorter axis, so that a spot always has [`TEXELS`] of a level's texels across and
//! twice as many at most; the longer axis has as many more as it is longer, and those are summed
//! ([`super::averaged`]). Squares are summed with equal weight and spots cut through texels in proportion, so
//! that the one thing lost is where within a texel an edge lies that a spot ends in.
//!
//! Which level is read depends on the transform alone, not on what was drawn before. A level is made when it
//! is first asked for and kept with the image.

use super::Image;
use std::sync::OnceLock;

/// Texels of a level across a spot, at least.
const TEXELS: f64 = 16.0;

/// Sides of the texels of the first level, in the image's own: two to the power of this. Smaller ones would
/// take more memory than the image.
const FIRST: u32 = 2;

/// What stands for a whole of a channel. Premultiplied products of bytes are kept as they are.
pub(super) const UNIT: u32 = 255 * 255;

/// An image's squares of some size. Those at the right and lower end may be cut off, and are the mean of
/// what is left.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub columns: usize,
    /// Row by row from the top: premultiplied, in parts of [`UNIT`].
    pub texels: Vec<[u16; 4]>,
    /// Squares twice as large.
    coarser: OnceLock<Box<Level>>,
}

/// The level for spots so many texels across, as the power of two that its squares are large; 0 is the image.
pub(super) fn level_for(spot: f64, image: &Image) -> u32 {
    // Of a level smaller than a texel nothing could be read.
    let shorter = image.rect().width().min(image.rect().height()) as f64;
    let side = (spot / TEXELS).min(shorter);
    if side < f64::from(1 << FIRST) {
        return 0;
    }
    (FIRST..31).take_while(|&log2| f64::from(1u32 << log2) <= side).last().unwrap_or(0)
}

impl Level {
    /// The level of an image that [`level_for`] says, if it is not the image.
    pub fn of(image: &Image, log2: u32) -> &Level {
        let first = image.coarser.get_or_init(|| Level::first(image));
        (FIRST..log2).fold(first, |level, finer| {
            let fine = (image.rect().width(), image.rect().height(), finer);
            level.coarser.get_or_init(|| Box::new(level.halved(fine)))
        })
    }

    fn first(image: &Image) -> Level {
        if image.is_opaque() {
            Level::of_squares(image, |texel| texel.map(u32::from), 255)
        } else {
            let premultiplied = |[r, g, b, a]: [u8; 4]| [r, g, b, 255].map(|v| u32::from(v) * u32::from(a));
            Level::of_squares(image, premultiplied, 1)
        }
    }

    /// The means of squares of texels, each weighted and then times a factor a part of [`UNIT`].
    fn of_squares(image: &Image, weighted: impl Fn([u8; 4]) -> [u32; 4], factor: u32) -> Level {
        const SIDE: usize = 1 << FIRST;
        let (width, height) = (image.rect().width(), image.rect().height());
        let columns = width.div_ceil(SIDE);
        let mut texels = Vec::with_capacity(columns * height.div_ceil(SIDE));
        let mut sums = vec![[0u32; 4]; columns];
        for top in (0..height).step_by(SIDE) {
            let rows = top..height.min(top + SIDE);
            let count = rows.len() * SIDE;
            sums.fill([0; 4]);
            for row in rows {
                let (squares, rest) = image.row(row).as_chunks::<SIDE>();
                for (sum, square) in sums.iter_mut().zip(squares) {
                    let [one, two, three, four] = square.map(&weighted);
                    *sum = std::array::from_fn(|i| sum[i] + (one[i] + two[i]) + (three[i] + four[i]));
                }
                for &texel in rest {
                    let texel = weighted(texel);
                    sums[columns - 1].iter_mut().zip(texel).for_each(|(sum, v)| *sum += v);
                }
            }
            let mean = |sum: [u32; 4], count: usize| {
                let count = count as u32;
                sum.map(|sum| ((sum * factor + count / 2) / count) as u16)
            };
            // Nearly all squares are whole: a constant is divided by in a few multiplications.
            match count == SIDE * SIDE {
                true => texels.extend(sums.iter().map(|&sum| mean(sum, SIDE * SIDE))),
                false => texels.extend(sums.iter().map(|&sum| mean(sum, count))),
            }
            if let (rest @ 1.., Some(last)) = (width % SIDE, texels.last_mut()) {
                *last = mean(sums[columns - 1], count / SIDE * rest);
            }
        }
        Level { columns, texels, coarser: OnceLock::new() }
    }

    /// Squares twice as large, of a level of an image so wide and high with squares so large.
    fn halved(&self, (width, height, log2): (usize, usize, u32)) -> Level {
        let rows = self.texels.len() / self.columns;
        let columns = self.columns.div_ceil(2);
        let mut texels = Vec::with_capacity(columns * rows.div_ceil(2));
        // What of the image lies in a column or row.
        let seen = |at: usize, length: usize| (length - (at << log2)).min(1 << log2) as u64;
        for (row, pair) in self.texels.chunks(self.columns * 2).enumerate() {
            let heights =
                [0, 1].map(|i| if i * self.columns < pair.len() { seen(2 * row + i, height) } else { 0 });
            for column in (0..self.columns).step_by(2) {
                let (mut sum, mut area) = ([0u64; 4], 0);
                for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    if column + x < self.columns && heights[y] > 0 {
                        let share = seen(column + x, width) * heights[y];
                        let texel = pair[y * self.columns + column + x];
                        sum.iter_mut().zip(texel).for_each(|(sum, v)| *sum += u64::from(v) * share);
                        area += share;
                    }
                }
                texels.push(sum.map(|sum| ((sum + area / 2) / area) as u16));
            }
        }
        Level { columns, texels, coarser: OnceLock::new() }
    }
}
