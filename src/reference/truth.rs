//! Takes painted rows, keeps them: the true picture, in fractions of a level.

use super::difference::{worst_channel, Difference};
use super::row::PaintedRow;
use crate::Pixmap;

/// The true picture: sRGB-encoded, premultiplied, in 8-bit levels that are not rounded.
#[derive(Clone, Debug)]
pub struct Truth {
    width: u32,
    height: u32,
    /// Row by row from the top: red, green, blue times alpha, and alpha, each 0..=255.
    premultiplied: Vec<[f64; 4]>,
    /// Pixels that were swept.
    pub swept: usize,
    /// Pixels with more crossings than are worth cutting at; their areas are approximate.
    pub approximate: usize,
    /// How far the sum of a pixel's areas was from 1, at worst.
    pub area_defect: f64,
}

impl Truth {
    pub(super) fn from_rows(width: u32, height: u32, rows: Vec<PaintedRow>) -> Truth {
        let mut truth = Truth {
            width,
            height,
            premultiplied: Vec::with_capacity(width as usize * height as usize),
            swept: 0,
            approximate: 0,
            area_defect: 0.0,
        };
        for row in rows {
            truth.premultiplied.extend_from_slice(&row.pixels);
            truth.swept += row.swept;
            truth.approximate += row.approximate;
            truth.area_defect = truth.area_defect.max(row.area_defect);
        }
        truth
    }

    /// A truth that was kept elsewhere.
    ///
    /// # Panics
    /// When there is not one pixel for each place.
    pub(crate) fn from_pixels(width: u32, height: u32, premultiplied: Vec<[f64; 4]>) -> Truth {
        assert_eq!(premultiplied.len(), width as usize * height as usize, "one pixel for each place");
        Truth { width, height, premultiplied, swept: 0, approximate: 0, area_defect: 0.0 }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top: red, green, blue times alpha, and alpha, in levels
    /// 0..=255.
    pub fn premultiplied(&self) -> &[[f64; 4]] {
        &self.premultiplied
    }

    /// The pixel in column `x` and row `y`, straight (not premultiplied): red, green, blue, alpha in
    /// levels 0..=255; zeros where nothing is drawn.
    ///
    /// # Panics
    /// When `x` or `y` lies outside the picture.
    pub fn straight(&self, x: u32, y: u32) -> [f64; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside the picture");
        straight(self.premultiplied[(y * self.width + x) as usize])
    }

    /// The nearest picture of 8 bits: each straight channel rounded once. Its difference from the
    /// truth is what no 8-bit picture can better by much.
    pub fn to_pixmap(&self) -> Pixmap {
        let mut pixmap = Pixmap::new(self.width, self.height);
        for (bytes, &pixel) in pixmap.data_mut().chunks_exact_mut(4).zip(&self.premultiplied) {
            let levels = straight(pixel);
            for channel in 0..4 {
                bytes[channel] = levels[channel].round().clamp(0.0, 255.0) as u8;
            }
        }
        pixmap
    }

    /// How far `pixmap` is from the truth.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn compare(&self, pixmap: &Pixmap) -> Difference {
        assert_eq!((self.width, self.height), (pixmap.width(), pixmap.height()), "pictures of one size");
        let bytes = pixmap.data().chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]);
        Difference::between(self.width, bytes, &self.premultiplied)
    }
}

impl Truth {
    /// How far each pixel's worst channel is from the truth, row by row, in levels: what
    /// [`Truth::compare`] sums up.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn errors(&self, pixmap: &Pixmap) -> Vec<f32> {
        assert_eq!((self.width, self.height), (pixmap.width(), pixmap.height()), "pictures of one size");
        let pixels = pixmap.data().chunks_exact(4).zip(&self.premultiplied);
        pixels.map(|(p, &levels)| worst_channel([p[0], p[1], p[2], p[3]], levels) as f32).collect()
    }
}

/// Levels without their alpha; zeros where alpha is nothing.
pub(super) fn straight(premultiplied: [f64; 4]) -> [f64; 4] {
    let [r, g, b, a] = premultiplied;
    if a <= 0.0 {
        return [0.0; 4];
    }
    let by = 255.0 / a;
    [r * by, g * by, b * by, a]
}
