//! Takes straight RGBA rows from the top, writes a PNG: parts of it go out as their rows come in.
//!
//! Promises: the file is valid once [`PngWriter::finish`] has returned, and depends only on the
//! pixels, the effort and whether the picture was announced as opaque; never on how the rows were
//! grouped. Memory: the rows of a part, half a megabyte or eight rows, a few times.

use super::packed::{rows_in_part, Adler, Effort, Packed, Packer};
use crate::Error;
use std::io::{self, Write};

/// Zlib's header: a window of 32 KB.
const ZLIB: [u8; 2] = [0x78, 0x9c];
/// An empty block that is the last.
const LAST: [u8; 2] = [3, 0];

/// Writes one PNG, row by row.
pub struct PngWriter<W: Write> {
    parts: PartWriter<W>,
    packer: Packer,
    /// Rows that are not yet a part.
    waiting: Vec<u8>,
    width: usize,
    rows_left: u32,
}

impl<W: Write> PngWriter<W> {
    /// Begins a picture of `width` x `height` pixels. `opaque` announces that every pixel's alpha
    /// will be 255: the file then has no alpha channel.
    ///
    /// # Errors
    /// When the header cannot be written, or the picture has no pixel.
    pub fn new(to: W, width: u32, height: u32, opaque: bool, effort: Effort) -> Result<PngWriter<W>, Error> {
        Ok(PngWriter {
            parts: PartWriter::new(to, (width, height), opaque)?,
            packer: Packer::new(effort, opaque),
            waiting: Vec::new(),
            width: width as usize,
            rows_left: height,
        })
    }

    /// Writes the next whole rows.
    ///
    /// # Errors
    /// When they cannot be written, are not whole, or are more than the picture has.
    pub fn write_rows(&mut self, mut rows: &[u8]) -> Result<(), Error> {
        let bytes_per_row = self.width * 4;
        let count = rows.len() / bytes_per_row;
        if !rows.len().is_multiple_of(bytes_per_row) || count > self.rows_left as usize {
            return Err(wrong_rows(format!("{} bytes are not the picture's next rows", rows.len())));
        }
        self.rows_left -= count as u32;
        let part = self.parts.rows_in_part() as usize * bytes_per_row;
        while self.waiting.len() + rows.len() >= part {
            let missing = part - self.waiting.len();
            let packed = if self.waiting.is_empty() {
                self.packer.pack(&rows[..part], self.width)
            } else {
                self.waiting.extend_from_slice(&rows[..missing]);
                self.packer.pack(&self.waiting, self.width)
            };
            self.waiting.clear();
            self.parts.write(&packed)?;
            rows = &rows[missing..];
        }
        self.waiting.extend_from_slice(rows);
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written, or rows are missing.
    pub fn finish(mut self) -> Result<(), Error> {
        if self.rows_left > 0 {
            return Err(wrong_rows(format!("{} rows are missing", self.rows_left)));
        }
        if !self.waiting.is_empty() {
            self.parts.write(&self.packer.pack(&self.waiting, self.width))?;
        }
        self.parts.finish()
    }
}

fn wrong_rows(what: String) -> Error {
    Error::Io(io::Error::new(io::ErrorKind::InvalidInput, what))
}

/// Takes the parts of a PNG, packed, writes the file: a chunk for each, which goes out when the next one comes.
pub(crate) struct PartWriter<W: Write> {
    file: ::png::Writer<W>,
    chunk: Vec<u8>,
    sum: Adler,
    width: u32,
}

impl<W: Write> PartWriter<W> {
    /// Begins the file of a picture of such a size.
    pub fn new(to: W, (width, height): (u32, u32), opaque: bool) -> Result<PartWriter<W>, Error> {
        let mut encoder = ::png::Encoder::new(to, width, height);
        encoder.set_color(if opaque { ::png::ColorType::Rgb } else { ::png::ColorType::Rgba });
        encoder.set_depth(::png::BitDepth::Eight);
        let file = encoder.write_header().map_err(to_io)?;
        Ok(PartWriter { file, chunk: ZLIB.to_vec(), sum: Adler::NOTHING, width })
    }

    /// Rows of each part but the last.
    pub fn rows_in_part(&self) -> u32 {
        rows_in_part(self.width)
    }

    /// Adds the next part.
    pub fn write(&mut self, part: &Packed) -> Result<(), Error> {
        if self.chunk.len() > ZLIB.len() {
            self.write_chunk()?;
        }
        self.chunk.extend_from_slice(&part.blocks);
        self.sum = self.sum.then(part.sum);
        Ok(())
    }

    /// Ends the file.
    pub fn finish(mut self) -> Result<(), Error> {
        self.chunk.extend_from_slice(&LAST);
        self.chunk.extend_from_slice(&self.sum.sum().to_be_bytes());
        self.write_chunk()?;
        Ok(self.file.finish().map_err(to_io)?)
    }

    fn write_chunk(&mut self) -> Result<(), Error> {
        self.file.write_chunk(::png::chunk::IDAT, &self.chunk).map_err(to_io)?;
        self.chunk.clear();
        Ok(())
    }
}

pub(super) fn to_io(error: ::png::EncodingError) -> io::Error {
    match error {
        ::png::EncodingError::IoError(e) => e,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat parts, a gradient and noise, opaque or not.
    fn picture(width: usize, height: usize, alpha: Option<u8>) -> Vec<u8> {
        let mut noise = 1_u32;
        let pixels = (0..width * height).flat_map(|i| {
            let (x, y) = (i % width, i / width);
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            match y % 3 {
                0 => [200, 10, 10, alpha.unwrap_or(y as u8)],
                1 => [(x + y) as u8, (2 * x) as u8, y as u8, alpha.unwrap_or(x as u8)],
                _ => [
                    noise as u8,
                    (noise >> 8) as u8,
                    (noise >> 16) as u8,
                    alpha.unwrap_or((noise >> 24) as u8),
                ],
            }
        });
        pixels.collect()
    }

    fn decode(file: &[u8]) -> Vec<u8> {
        let mut decoder = ::png::Decoder::new(io::Cursor::new(file));
        decoder.set_transformations(::png::Transformations::ALPHA);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
    }

    fn encode(pixels: &[u8], width: u32, opaque: bool, effort: Effort, rows_at_once: usize) -> Vec<u8> {
        let stride = width as usize * 4;
        let mut file = Vec::new();
        let height = (pixels.len() / stride) as u32;
        let mut png = PngWriter::new(&mut file, width, height, opaque, effort).unwrap();
        pixels.chunks(stride * rows_at_once).for_each(|rows| png.write_rows(rows).unwrap());
        png.finish().unwrap();
        file
    }

    #[test]
    fn pixels_come_back_as_they_went_in() {
        for (width, height) in [(1, 1), (1, 7), (7, 1), (300, 200)] {
            for alpha in [None, Some(255)] {
                let pixels = picture(width, height, alpha);
                for effort in [Effort::Fast, Effort::Flat, Effort::Small] {
                    let file = encode(&pixels, width as u32, alpha.is_some(), effort, 3);
                    assert!(decode(&file) == pixels, "{width} x {height}, {alpha:?}, {effort:?}");
                }
            }
        }
    }

    #[test]
    fn noise_comes_back_though_it_grows() {
        let mut noise = 1_u32;
        let mut next = || {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (noise >> 24) as u8
        };
        let pixels: Vec<u8> = (0..4 * 600 * 500).map(|_| next()).collect();
        for effort in [Effort::Fast, Effort::Flat, Effort::Small] {
            assert!(decode(&encode(&pixels, 600, false, effort, 500)) == pixels, "{effort:?}");
        }
    }

    #[test]
    fn the_grouping_of_rows_does_not_change_the_file() {
        let pixels = picture(100, 90, None);
        let one = encode(&pixels, 100, false, Effort::Flat, 1);
        assert!(one == encode(&pixels, 100, false, Effort::Flat, 90));
    }

    #[test]
    fn too_few_or_too_many_rows_are_an_error() {
        let new = || PngWriter::new(Vec::new(), 2, 2, false, Effort::Flat).unwrap();
        assert!(new().write_rows(&[0; 24]).is_err());
        assert!(new().write_rows(&[0; 7]).is_err());
        assert!(new().finish().is_err());
    }

    #[test]
    fn a_picture_without_pixels_is_an_error() {
        assert!(PngWriter::new(Vec::new(), 0, 2, false, Effort::Flat).is_err());
    }
}
