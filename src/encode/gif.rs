//! Takes frames, writes an animated GIF: of each frame the smallest rectangle that changed, with its own
//! palette, exact where it has no more than 256 colours (255 and one for transparency).
//!
//! A pixel is seen or not: alpha from [`OPAQUE_FROM`] on is opaque. Where a pixel vanishes, the frame
//! before is wiped, so each frame waits for the next. Times are in hundredths of a second and sum up
//! without drift.

use super::changed::Area;
use super::palette::Palette;
use super::Rate;
use crate::Error;
use ::gif::{DisposalMethod, Encoder, Frame, Repeat};
use std::io::{self, Write};

/// The smallest alpha that is seen.
const OPAQUE_FROM: u8 = 128;

/// Longest side of a GIF.
const LONGEST: u32 = u16::MAX as u32;

/// Writes one animation, frame by frame.
pub struct GifWriter<W: Write> {
    file: Encoder<W>,
    width: usize,
    rate: Rate,
    /// Frames given so far.
    count: u64,
    /// What a viewer shows before the frame that waits.
    canvas: Vec<u8>,
    /// The frame that waits for the next, its alpha 0 or 255.
    waiting: Option<Vec<u8>>,
}

impl<W: Write> GifWriter<W> {
    /// Begins an animation, shown `plays` times (0: for ever).
    ///
    /// # Errors
    /// When it is too large or cannot be written.
    pub fn new(to: W, width: u32, height: u32, rate: Rate, plays: u16) -> Result<GifWriter<W>, Error> {
        if width > LONGEST || height > LONGEST {
            return Err(Error::Size(format!(
                "{width} x {height} pixels are too large for a GIF (at most {LONGEST} a side)"
            )));
        }
        let mut file = Encoder::new(to, width as u16, height as u16, &[]).map_err(to_io)?;
        let repeat = if plays == 0 { Repeat::Infinite } else { Repeat::Finite(plays - 1) };
        file.set_repeat(repeat).map_err(to_io)?;
        let canvas = vec![0; width as usize * height as usize * 4];
        Ok(GifWriter { file, width: width as usize, rate, count: 0, canvas, waiting: None })
    }

    /// Adds the next frame: straight RGBA.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_frame(&mut self, pixels: &[u8]) -> Result<(), Error> {
        let mut next = pixels.to_vec();
        for pixel in next.as_chunks_mut::<4>().0 {
            *pixel = if pixel[3] < OPAQUE_FROM { [0; 4] } else { [pixel[0], pixel[1], pixel[2], 255] };
        }
        if let Some(waiting) = self.waiting.take() {
            self.put(waiting, Some(&next))?;
        }
        self.waiting = Some(next);
        self.count += 1;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(mut self) -> Result<(), Error> {
        if let Some(waiting) = self.waiting.take() {
            self.put(waiting, None)?;
        }
        self.file.into_inner().map_err(to_io)?.flush()?;
        Ok(())
    }

    /// Writes frame number `count - 1`, knowing what comes after.
    fn put(&mut self, frame: Vec<u8>, next: Option<&[u8]>) -> Result<(), Error> {
        let vanishes = |a: &[u8; 4], b: &[u8; 4]| a[3] != 0 && b[3] == 0;
        let wiped = next.and_then(|next| Area::of(&frame, next, self.width, vanishes));
        let changed = Area::changed(&self.canvas, &frame, self.width);
        let area = match (changed, wiped) {
            (Some(changed), Some(wiped)) => changed.with(wiped),
            (Some(area), None) | (None, Some(area)) => area,
            // It changes nothing but takes its time.
            (None, None) => Area::whole(1, 1),
        };
        let n = self.count - 1;
        let delay = self.rate.hundredths(n + 1) - self.rate.hundredths(n);
        let mut written = indexed(&frame, area, self.width);
        written.delay = delay.min(u64::from(u16::MAX)) as u16;
        written.dispose = if wiped.is_some() { DisposalMethod::Background } else { DisposalMethod::Keep };
        self.file.write_frame(&written).map_err(to_io)?;
        self.canvas = frame;
        if wiped.is_some() {
            let stride = self.width * 4;
            for row in self.canvas.chunks_exact_mut(stride).skip(area.y).take(area.height) {
                row[area.x * 4..(area.x + area.width) * 4].fill(0);
            }
        }
        Ok(())
    }
}

/// An area of a frame by palette and numbers.
fn indexed(pixels: &[u8], area: Area, width: usize) -> Frame<'static> {
    let all = || area.rows(pixels, width).flat_map(|row| row.as_chunks::<4>().0);
    let has_holes = all().any(|pixel| pixel[3] == 0);
    let rgb = |pixel: &[u8; 4]| [pixel[0], pixel[1], pixel[2]];
    let most = if has_holes { 255 } else { 256 };
    let palette = Palette::new(all().filter(|pixel| pixel[3] != 0).map(rgb), most);
    // The hole's number is behind those of the colours.
    let hole = palette.colors.len() as u8;
    let buffer: Vec<u8> =
        all().map(|pixel| if pixel[3] == 0 { hole } else { palette.index(rgb(pixel)) }).collect();
    let mut colors = palette.colors.concat();
    if has_holes {
        colors.extend([0; 3]);
    }
    Frame {
        left: area.x as u16,
        top: area.y as u16,
        width: area.width as u16,
        height: area.height as u16,
        transparent: has_holes.then_some(hole),
        palette: Some(colors),
        buffer: buffer.into(),
        ..Frame::default()
    }
}

fn to_io(error: ::gif::EncodingError) -> io::Error {
    match error {
        ::gif::EncodingError::Io(e) => e,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a viewer shows, frame by frame, with the delays.
    fn shown(file: &[u8], width: usize, height: usize) -> Vec<(Vec<u8>, u16)> {
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(file).unwrap();
        let mut canvas = vec![0; width * height * 4];
        let mut shown = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let (left, top, w) = (frame.left as usize, frame.top as usize, frame.width as usize);
            let mut after = canvas.clone();
            for (i, pixel) in frame.buffer.chunks_exact(4).enumerate() {
                let at = ((top + i / w) * width + left + i % w) * 4;
                if pixel[3] != 0 {
                    after[at..at + 4].copy_from_slice(pixel);
                }
            }
            shown.push((after.clone(), frame.delay));
            if frame.dispose == DisposalMethod::Background {
                for i in 0..frame.buffer.len() / 4 {
                    let at = ((top + i / w) * width + left + i % w) * 4;
                    after[at..at + 4].fill(0);
                }
            }
            canvas = after;
        }
        shown
    }

    #[test]
    fn every_frame_is_shown_as_it_was_even_where_pixels_vanish() {
        let (width, height) = (9, 7);
        let frame = |n: usize| -> Vec<u8> {
            let pixel = |i: usize| match ((i % width + n) % 5, (i / width + n) % 3) {
                (0, _) | (_, 0) if n != 3 => [0; 4],
                (a, b) => [40 * a as u8, 60 * b as u8, n as u8, 255],
            };
            (0..width * height).flat_map(pixel).collect()
        };
        let frames: Vec<Vec<u8>> = [0, 1, 1, 2, 3, 4, 0].map(frame).to_vec();
        let mut file = Vec::new();
        let rate = Rate { frames: 24, seconds: 1 };
        let mut gif = GifWriter::new(&mut file, width as u32, height as u32, rate, 0).unwrap();
        frames.iter().for_each(|frame| gif.write_frame(frame).unwrap());
        gif.finish().unwrap();
        let shown = shown(&file, width, height);
        assert_eq!(shown.iter().map(|(_, delay)| *delay).collect::<Vec<_>>(), [4, 4, 5, 4, 4, 4, 4]);
        for (n, (shown, frame)) in shown.iter().zip(&frames).enumerate() {
            assert!(shown.0 == *frame, "frame {n}");
        }
        assert_eq!(shown.len(), frames.len());
    }

    #[test]
    fn half_transparent_pixels_are_seen_or_not() {
        let mut file = Vec::new();
        let mut gif = GifWriter::new(&mut file, 2, 1, Rate { frames: 10, seconds: 1 }, 1).unwrap();
        gif.write_frame(&[9, 9, 9, 127, 9, 9, 9, 128]).unwrap();
        gif.finish().unwrap();
        assert_eq!(shown(&file, 2, 1)[0].0, [0, 0, 0, 0, 9, 9, 9, 255]);
    }
}
