//! Takes a picture or the truth, makes it as it is seen on white: three planes of sRGB-encoded light,
//! 0 ..= 1. SSIM and FLIP judge what is seen, and know no alpha.

use crate::reference::Truth;
use crate::Pixmap;

/// A picture on a white ground.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue, each 0 ..= 1, sRGB-encoded, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

impl Shown {
    /// An 8-bit picture.
    pub fn of_pixmap(pixmap: &Pixmap) -> Shown {
        let on_white = |p: &[u8]| {
            let alpha = f32::from(p[3]) / 255.0;
            [p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0 * alpha + 1.0 - alpha)
        };
        Shown {
            width: pixmap.width() as usize,
            height: pixmap.height() as usize,
            pixels: pixmap.data().chunks_exact(4).map(on_white).collect(),
        }
    }

    /// The truth, not rounded to levels.
    pub fn of_truth(truth: &Truth) -> Shown {
        let on_white = |&[r, g, b, a]: &[f64; 4]| [r, g, b].map(|c| ((c + 255.0 - a) / 255.0) as f32);
        Shown {
            width: truth.width() as usize,
            height: truth.height() as usize,
            pixels: truth.premultiplied().iter().map(on_white).collect(),
        }
    }

    /// Luma of Rec. 601, in levels 0 ..= 255.
    pub fn luma(&self) -> Vec<f32> {
        self.pixels.iter().map(|[r, g, b]| 255.0 * (0.299 * r + 0.587 * g + 0.114 * b)).collect()
    }
}
