//! `accumulate`: the mean of N jagged pictures, each of which looks at another point of every pixel, the
//! same in all pixels (Haeberli & Akeley, *The Accumulation Buffer*, SIGGRAPH 1990). The accumulation
//! buffer is one band high, and what is flattened once serves all passes.

use super::mask::{Masks, Probe};
use super::patterns::Pattern;
use crate::band::{BandRenderer, Laps, Picture};
use crate::cel::Rows;
use crate::methods::BandPainter;
use crate::pixel::fragment::PIXEL_AREA;
use crate::pixel::resolve::Mean;
use crate::scene::paint::Sheet;

/// Paints each band N times.
pub(crate) struct Accumulate {
    painter: BandRenderer<Masks<u16>>,
    passes: Vec<Probe>,
    /// One pass's rows.
    bytes: Vec<u8>,
    means: Vec<Mean>,
}

impl Accumulate {
    pub fn new(width: u32, height: u32, count: u16) -> Accumulate {
        let mut passes = Vec::new();
        Pattern::Jitter(count).points((0, 0), &mut passes);
        let painter = BandRenderer::new(width, height, Masks::at(width, passes[0]));
        Accumulate { painter, passes, bytes: Vec::new(), means: Vec::new() }
    }
}

impl BandPainter for Accumulate {
    fn render(&mut self, picture: &Picture, band: usize, mut rows: Rows) {
        let (width, linear) = (picture.width as usize, picture.around.linear);
        let (top, count, stride) = (rows.top, rows.count, width * 4);
        self.bytes.resize(stride * count, 0);
        self.means.clear();
        self.means.resize(width * count, Mean::default());
        let mut spent = 0;
        for (i, &probe) in self.passes.iter().enumerate() {
            let share = PIXEL_AREA * (i as i64 + 1) / self.passes.len() as i64 - spent;
            spent += share;
            self.painter.coverage.look_at(probe);
            self.painter.render(picture, band, Rows { bytes: &mut self.bytes, stride, top, count });
            for (mean, &[r, g, b, a]) in self.means.iter_mut().zip(self.bytes.as_chunks().0) {
                let unit = |v: u8| f32::from(v) / 255.0;
                mean.add(Sheet::new([r, g, b].map(unit), unit(a)), share, linear);
            }
        }
        for (row, means) in self.means.chunks(width).enumerate() {
            for (pixel, mean) in rows.row(row, width).iter_mut().zip(means) {
                *pixel = mean.to_rgba8(linear);
            }
        }
    }

    fn time_stages(&mut self) {
        self.painter.time_stages();
    }

    fn take_laps(&mut self) -> Laps {
        self.painter.take_laps()
    }

    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        self.painter.take_counts()
    }
}
