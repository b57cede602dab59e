//! Takes opaque frames, writes YUV4MPEG2: what ffmpeg and most encoders read from a pipe.
//!
//! Y'CbCr of 8 bits in the limited range (Y' 16–235, Cb and Cr 16–240), by BT.601 or BT.709. The format
//! has no field for the matrix: readers take BT.601 unless told otherwise. 4:2:0 is sited at the centre
//! of each 2 x 2 pixels (`C420jpeg`); an odd last row or column counts twice.

use super::Rate;
use crate::Error;
use std::io::Write;

/// How colours become Y'CbCr.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Yuv {
    /// One chroma sample for 2 x 2 pixels (4:2:0) rather than one a pixel (4:4:4).
    pub halved: bool,
    /// BT.709 rather than BT.601.
    pub bt709: bool,
}

/// Writes a stream, frame by frame.
pub struct Y4mWriter<W: Write> {
    to: W,
    width: usize,
    height: usize,
    yuv: Yuv,
    planes: [Vec<u8>; 3],
}

impl<W: Write> Y4mWriter<W> {
    /// Begins a stream.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn new(mut to: W, width: u32, height: u32, rate: Rate, yuv: Yuv) -> Result<Self, Error> {
        let chroma = if yuv.halved { "420jpeg" } else { "444" };
        let Rate { frames, seconds } = rate;
        writeln!(
            to,
            "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C{chroma} XCOLORRANGE=LIMITED"
        )?;
        let (width, height) = (width as usize, height as usize);
        Ok(Y4mWriter { to, width, height, yuv, planes: Default::default() })
    }

    /// Writes the next frame: straight RGBA, all of it opaque.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_frame(&mut self, pixels: &[u8]) -> Result<(), Error> {
        debug_assert_eq!(pixels.len(), self.width * self.height * 4);
        self.planes.iter_mut().for_each(Vec::clear);
        let matrix = Matrix::new(self.yuv.bt709);
        for pixel in pixels.as_chunks::<4>().0 {
            let [y, cb, cr] = matrix.apply([pixel[0], pixel[1], pixel[2]].map(f32::from));
            self.planes[0].push(y);
            if !self.yuv.halved {
                self.planes[1].push(cb);
                self.planes[2].push(cr);
            }
        }
        if self.yuv.halved {
            self.halve(pixels.as_chunks::<4>().0, &matrix);
        }
        self.to.write_all(b"FRAME\n")?;
        self.planes.iter().try_for_each(|plane| self.to.write_all(plane))?;
        Ok(())
    }

    fn halve(&mut self, pixels: &[[u8; 4]], matrix: &Matrix) {
        for y in (0..self.height).step_by(2) {
            for x in (0..self.width).step_by(2) {
                let (right, below) = ((x + 1).min(self.width - 1), (y + 1).min(self.height - 1));
                let four =
                    [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| pixels[y * self.width + x]);
                let mean = std::array::from_fn(|c| four.iter().map(|p| f32::from(p[c])).sum::<f32>() / 4.0);
                let [_, cb, cr] = matrix.apply(mean);
                self.planes[1].push(cb);
                self.planes[2].push(cr);
            }
        }
    }

    /// Ends the stream.
    ///
    /// # Errors
    /// When the last bytes cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        Ok(self.to.flush()?)
    }
}

/// Shares of red and blue in luma; green has the rest.
struct Matrix {
    red: f32,
    blue: f32,
}

impl Matrix {
    fn new(bt709: bool) -> Matrix {
        match bt709 {
            true => Matrix { red: 0.2126, blue: 0.0722 },
            false => Matrix { red: 0.299, blue: 0.114 },
        }
    }

    /// Levels 0..=255 to Y', Cb and Cr.
    fn apply(&self, [r, g, b]: [f32; 3]) -> [u8; 3] {
        let luma = self.red * r + (1.0 - self.red - self.blue) * g + self.blue * b;
        let chroma = |c: f32, share: f32| 128.0 + 224.0 / 255.0 * (c - luma) / (2.0 * (1.0 - share));
        let y = 16.0 + 219.0 / 255.0 * luma;
        [y, chroma(b, self.blue), chroma(r, self.red)].map(|v| v.round() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(yuv: Yuv, width: u32, pixels: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        let height = pixels.len() as u32 / 4 / width;
        let mut writer =
            Y4mWriter::new(&mut out, width, height, Rate { frames: 24, seconds: 1 }, yuv).unwrap();
        writer.write_frame(pixels).unwrap();
        writer.finish().unwrap();
        out
    }

    #[test]
    fn primaries_have_the_levels_of_the_standards() {
        let pixels = [[255, 255, 255, 255], [0, 0, 0, 255], [255, 0, 0, 255], [0, 0, 255, 255]].concat();
        let out = stream(Yuv { halved: false, bt709: false }, 4, &pixels);
        let head = b"YUV4MPEG2 W4 H1 F24:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\nFRAME\n";
        assert!(out.starts_with(head));
        assert_eq!(out[head.len()..], [235, 16, 81, 41, 128, 128, 90, 240, 128, 128, 240, 110]);
        let out = stream(Yuv { halved: false, bt709: true }, 4, &pixels);
        assert_eq!(out[head.len()..], [235, 16, 63, 32, 128, 128, 102, 240, 128, 128, 240, 118]);
    }

    #[test]
    fn halved_chroma_has_a_sample_for_every_started_square() {
        let out = stream(Yuv { halved: true, bt709: false }, 3, &[255; 3 * 3 * 4]);
        let head = b"YUV4MPEG2 W3 H3 F24:1 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\nFRAME\n";
        assert_eq!(out[head.len()..], [[235; 9].as_slice(), &[128; 8]].concat());
    }
}
