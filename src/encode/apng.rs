//! Takes frames, writes an animated PNG: the first frame whole, of each other the smallest rectangle
//! that changed.

use super::changed::Area;
use super::png::to_io;
use super::{Effort, Rate};
use crate::Error;
use ::png::{BlendOp, ColorType, Compression, DisposeOp};
use std::io::Write;

/// Writes one animation, frame by frame.
pub struct ApngWriter<W: Write> {
    file: ::png::Writer<W>,
    width: usize,
    opaque: bool,
    before: Option<Vec<u8>>,
    bytes: Vec<u8>,
}

impl<W: Write> ApngWriter<W> {
    /// Begins an animation of `frames` frames, shown `plays` times (0: for ever). `opaque` announces
    /// that every pixel's alpha will be 255.
    ///
    /// # Errors
    /// When the header cannot be written.
    pub fn new(
        to: W,
        (width, height): (u32, u32),
        opaque: bool,
        frames: u32,
        rate: Rate,
        plays: u32,
        effort: Effort,
    ) -> Result<ApngWriter<W>, Error> {
        let mut encoder = ::png::Encoder::new(to, width, height);
        encoder.set_color(if opaque { ColorType::Rgb } else { ColorType::Rgba });
        encoder.set_depth(::png::BitDepth::Eight);
        encoder.set_compression(match effort {
            Effort::Fast => Compression::Fast,
            Effort::Flat => Compression::Balanced,
            Effort::Small => Compression::High,
        });
        encoder.set_animated(frames, plays).map_err(to_io)?;
        let (shown, of) = rate.delay();
        encoder.set_frame_delay(shown, of).map_err(to_io)?;
        encoder.set_blend_op(BlendOp::Source).map_err(to_io)?;
        encoder.set_dispose_op(DisposeOp::None).map_err(to_io)?;
        let file = encoder.write_header().map_err(to_io)?;
        Ok(ApngWriter { file, width: width as usize, opaque, before: None, bytes: Vec::new() })
    }

    /// Writes the next frame: straight RGBA.
    ///
    /// # Errors
    /// When it cannot be written, or is more than were announced.
    pub fn write_frame(&mut self, pixels: &[u8]) -> Result<(), Error> {
        let height = pixels.len() / 4 / self.width;
        let area = match &self.before {
            None => Area::whole(self.width, height),
            Some(before) => {
                // A frame that changes nothing still takes its time: one pixel of it is written.
                let same = Area::whole(1, 1);
                let area = Area::changed(before, pixels, self.width).unwrap_or(same);
                self.file.set_frame_position(0, 0).map_err(to_io)?;
                self.file.set_frame_dimension(area.width as u32, area.height as u32).map_err(to_io)?;
                self.file.set_frame_position(area.x as u32, area.y as u32).map_err(to_io)?;
                area
            }
        };
        self.bytes.clear();
        for row in area.rows(pixels, self.width) {
            match self.opaque {
                true => {
                    self.bytes.extend(row.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]))
                }
                false => self.bytes.extend_from_slice(row),
            }
        }
        self.file.write_image_data(&self.bytes).map_err(to_io)?;
        match &mut self.before {
            Some(before) => before.copy_from_slice(pixels),
            None => self.before = Some(pixels.to_vec()),
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written, or frames are missing.
    pub fn finish(self) -> Result<(), Error> {
        Ok(self.file.finish().map_err(to_io)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_back_and_only_what_changed_is_written() {
        let blank = vec![0; 6 * 5 * 4];
        let mut dot = blank.clone();
        dot[(2 * 6 + 3) * 4..][..4].copy_from_slice(&[10, 20, 30, 255]);
        let mut file = Vec::new();
        let rate = Rate { frames: 25, seconds: 1 };
        let mut apng = ApngWriter::new(&mut file, (6, 5), false, 3, rate, 0, Effort::Flat).unwrap();
        [&blank, &dot, &dot].iter().for_each(|frame| apng.write_frame(frame).unwrap());
        apng.finish().unwrap();
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
        let mut areas = Vec::new();
        for _ in 0..3 {
            let mut pixels = vec![0; 6 * 5 * 4];
            reader.next_frame(&mut pixels).unwrap();
            let control = reader.info().frame_control().unwrap();
            assert_eq!((control.delay_num, control.delay_den), (1, 25));
            areas.push((
                control.x_offset,
                control.y_offset,
                control.width,
                control.height,
                pixels[..4].to_vec(),
            ));
        }
        assert_eq!(areas[0], (0, 0, 6, 5, vec![0; 4]));
        assert_eq!(areas[1], (3, 2, 1, 1, vec![10, 20, 30, 255]));
        assert_eq!((areas[2].2, areas[2].3), (1, 1));
    }
}
