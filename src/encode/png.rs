//! Takes straight RGBA rows from the top, writes a PNG: rows go out as they come in.
//!
//! Promises: the file is valid once [`PngWriter::finish`] has returned, and depends only on the
//! pixels, the effort and whether the picture was announced as opaque; never on how the rows were
//! grouped. Memory: one row, one chunk and the compressor's window.

use crate::Error;
use flate2::write::ZlibEncoder;
use flate2::Compression;
use std::io::{self, Write};

/// How hard the compressor works. Flat art is long runs of one colour: PNG's row filters gain
/// nothing on it, and the compressor's cheap levels find the runs already.
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
    fn level(self) -> u32 {
        match self {
            Effort::Fast => 1,
            Effort::Flat => 2,
            Effort::Small => 9,
        }
    }
}

/// Bytes of compressed data in one chunk of the file.
const CHUNK: usize = 1 << 16;

/// Writes one PNG, row by row.
pub struct PngWriter<W: Write> {
    compressor: ZlibEncoder<DataChunks<W>>,
    /// One row as it goes to the compressor: the filter's number (0 for none), then the pixels.
    row: Vec<u8>,
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
        let chunks = DataChunks { file, data: Vec::with_capacity(CHUNK) };
        Ok(PngWriter {
            compressor: ZlibEncoder::new(chunks, Compression::new(effort.level())),
            row: Vec::new(),
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
        if rows.len() % self.bytes_per_row != 0 || count > self.rows_left as usize {
            return Err(wrong_rows(format!("{} bytes are not the picture's next rows", rows.len())));
        }
        for row in rows.chunks_exact(self.bytes_per_row) {
            self.row.clear();
            self.row.push(0);
            if self.opaque {
                self.row.extend(row.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]));
            } else {
                self.row.extend_from_slice(row);
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

fn to_io(error: ::png::EncodingError) -> io::Error {
    match error {
        ::png::EncodingError::IoError(e) => e,
        other => io::Error::new(io::ErrorKind::InvalidInput, other.to_string()),
    }
}
