//! Takes straight RGBA rows from the top, writes a PNG: rows go out as they come in.
//!
//! Promises: the file is valid once [`PngWriter::finish`] has returned, and depends only on the
//! pixels, the effort and whether the picture was announced as opaque; never on how the rows were
//! grouped. Memory: three rows, one chunk and the compressor's window.

use super::filter::Filter;
use crate::Error;
use flate2::write::ZlibEncoder;
use flate2::Compression;
use std::io::{self, Write};

/// How hard the compressor works. Flat art is long runs of one colour, which the compressor's cheap
/// levels find already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The least time.
    Fast,
    /// About the size of usual encoders in a fraction of the time.
    #[default]
    Flat,
    /// The smallest file.
    Small,
}

impl Effort {
    /// zlib's level. The one for flat art is the lowest at which no file of the samples is more than
    /// 1.25 times what the `png` crate makes by default. Time and size relative to that, for 29
    /// pictures 2,048 pixels wide (size: geometric mean, largest): level 2 takes .40, 1.11, 1.56;
    /// 3: .44, 1.09, 1.36; 4: .51, 1.08, 1.24; 5: .67, 1.05, 1.22.
    fn level(self) -> u32 {
        match self {
            Effort::Fast => 1,
            Effort::Flat => 4,
            Effort::Small => 9,
        }
    }
}

/// Bytes of compressed data in one chunk of the file.
const CHUNK: usize = 1 << 16;

/// Writes one PNG, row by row.
pub struct PngWriter<W: Write> {
    compressor: ZlibEncoder<DataChunks<W>>,
    filter: Filter,
    /// One row as it goes to the compressor: the filter's number, then the filtered pixels.
    row: Vec<u8>,
    /// One row without alpha.
    narrow: Vec<u8>,
    bytes_per_row: usize,
    rows_left: u32,
    opaque: bool,
}

impl<W: Write> PngWriter<W> {
    /// Begins a picture of `width` x `height` pixels. `opaque` announces that every pixel's alpha
    /// will be 255: the file then has no alpha channel.
    ///
    /// # Errors
    /// When the header cannot be written, or the picture has no pixel.
    pub fn new(to: W, width: u32, height: u32, opaque: bool, effort: Effort) -> Result<PngWriter<W>, Error> {
        let mut encoder = ::png::Encoder::new(to, width, height);
        encoder.set_color(if opaque { ::png::ColorType::Rgb } else { ::png::ColorType::Rgba });
        encoder.set_depth(::png::BitDepth::Eight);
        let file = encoder.write_header().map_err(to_io)?;
        let bytes_per_pixel = if opaque { 3 } else { 4 };
        let chunks = DataChunks { file, data: Vec::with_capacity(CHUNK) };
        Ok(PngWriter {
            compressor: ZlibEncoder::new(chunks, Compression::new(effort.level())),
            filter: Filter::new(width as usize * bytes_per_pixel, bytes_per_pixel),
            row: Vec::new(),
            narrow: Vec::new(),
            bytes_per_row: width as usize * 4,
            rows_left: height,
            opaque,
        })
    }

    /// Writes the next whole rows.
    ///
    /// # Errors
    /// When they cannot be written, are not whole, or are more than the picture has.
    pub fn write_rows(&mut self, rows: &[u8]) -> Result<(), Error> {
        let count = rows.len() / self.bytes_per_row;
        if !rows.len().is_multiple_of(self.bytes_per_row) || count > self.rows_left as usize {
            return Err(wrong_rows(format!("{} bytes are not the picture's next rows", rows.len())));
        }
        for row in rows.chunks_exact(self.bytes_per_row) {
            if self.opaque {
                self.narrow.clear();
                self.narrow.extend(row.as_chunks().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]));
                self.filter.filter(&self.narrow, &mut self.row);
            } else {
                self.filter.filter(row, &mut self.row);
            }
            self.compressor.write_all(&self.row)?;
        }
        self.rows_left -= count as u32;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written, or rows are missing.
    pub fn finish(self) -> Result<(), Error> {
        if self.rows_left > 0 {
            return Err(wrong_rows(format!("{} rows are missing", self.rows_left)));
        }
        let mut chunks = self.compressor.finish()?;
        chunks.write_chunk()?;
        Ok(chunks.file.finish().map_err(to_io)?)
    }
}

fn wrong_rows(what: String) -> Error {
    Error::Io(io::Error::new(io::ErrorKind::InvalidInput, what))
}

/// Takes compressed bytes, writes them to the file as chunks of image data.
struct DataChunks<W: Write> {
    file: ::png::Writer<W>,
    data: Vec<u8>,
}

impl<W: Write> DataChunks<W> {
    fn write_chunk(&mut self) -> io::Result<()> {
        if !self.data.is_empty() {
            self.file.write_chunk(::png::chunk::IDAT, &self.data).map_err(to_io)?;
            self.data.clear();
        }
        Ok(())
    }
}

impl<W: Write> Write for DataChunks<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(CHUNK - self.data.len());
        self.data.extend_from_slice(&bytes[..taken]);
        if self.data.len() == CHUNK {
            self.write_chunk()?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
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
