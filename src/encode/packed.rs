//! Takes some rows of a picture, makes their part of a PNG's data: filtered and packed so that nothing of it depends on
//! the rows before. The same rows of two pictures have the same bytes, which need be made only once.

use super::filter::filter;
use crate::edges::BAND_ROWS;
use crate::Pixmap;
use flate2::{Compress, Compression, FlushCompress};

/// Bytes of pixels that are packed together, or fewer. Each part's first row and codes take 20 to 150 bytes more than
/// they would in the middle of a part: half as many bytes here make flat pictures up to 1.2 times as large.
const PART: usize = 1 << 19;

/// Rows that are packed together in pictures of this width: a multiple of 8.
pub(crate) fn rows_in_part(width: u32) -> u32 {
    let rows = PART / (width.max(1) as usize * Pixmap::BYTES_PER_PIXEL);
    (rows as u32 / BAND_ROWS * BAND_ROWS).max(BAND_ROWS)
}

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
    fn level(self) -> Compression {
        Compression::new(match self {
            Effort::Fast => 1,
            Effort::Flat => 4,
            Effort::Small => 9,
        })
    }
}

/// A part of a PNG's data.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Packed {
    /// Deflate blocks of whole bytes.
    pub blocks: Vec<u8>,
    /// Of what is packed.
    pub sum: Adler,
}

/// Packs rows; keeps its buffers.
pub(crate) struct Packer {
    compress: Compress,
    opaque: bool,
    filtered: Vec<u8>,
    /// Rows without alpha.
    narrow: Vec<u8>,
    blocks: Vec<u8>,
}

impl Packer {
    /// `opaque` leaves alpha out.
    pub fn new(effort: Effort, opaque: bool) -> Packer {
        let compress = Compress::new(effort.level(), false);
        Packer { compress, opaque, filtered: Vec::new(), narrow: Vec::new(), blocks: Vec::new() }
    }

    /// Packs whole rows of straight RGBA, `width` pixels each.
    pub fn pack(&mut self, rows: &[u8], width: usize) -> Packed {
        self.filtered.clear();
        if self.opaque {
            self.narrow.clear();
            self.narrow.extend(rows.as_chunks().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]));
            filter::<3, 48>(&self.narrow, 3 * width, &mut self.filtered);
        } else {
            filter::<4, 64>(rows, 4 * width, &mut self.filtered);
        }
        Packed { blocks: self.deflate(), sum: Adler::of(&self.filtered) }
    }

    /// The filtered rows as blocks that end at a whole byte, with nothing of what was packed before.
    fn deflate(&mut self) -> Vec<u8> {
        let bytes = self.filtered.len();
        self.compress.reset();
        self.blocks.clear();
        // A byte takes nine bits at most.
        self.blocks.reserve(bytes + bytes / 8 + 1024);
        let packed = self.compress.compress_vec(&self.filtered, &mut self.blocks, FlushCompress::Sync);
        assert!(packed.is_ok() && self.compress.total_in() == bytes as u64, "there is room for all");
        self.blocks.clone()
    }
}

/// Zlib's checksum of some bytes ([RFC 1950]), and how many they are.
///
/// [RFC 1950]: https://www.rfc-editor.org/rfc/rfc1950
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Adler {
    sum: u32,
    length: u64,
}

impl Adler {
    /// Of nothing.
    pub const NOTHING: Adler = Adler { sum: 1, length: 0 };

    fn of(bytes: &[u8]) -> Adler {
        Adler { sum: simd_adler32::adler32(&bytes), length: bytes.len() as u64 }
    }

    pub fn sum(self) -> u32 {
        self.sum
    }

    /// Of these bytes and then others.
    pub fn then(self, next: Adler) -> Adler {
        const PRIME: u64 = 65_521;
        let halves = |sum: u32| (u64::from(sum & 0xffff), u64::from(sum >> 16));
        let ((a, b), (next_a, next_b)) = (halves(self.sum), halves(next.sum));
        // Each starts from a = 1, b = 0; b is the sum of all a.
        let low = (a + next_a + PRIME - 1) % PRIME;
        let high = (b + next_b + next.length % PRIME * (a + PRIME - 1)) % PRIME;
        Adler { sum: (high << 16 | low) as u32, length: self.length + next.length }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_put_together_are_that_of_the_whole() {
        let bytes: Vec<u8> = (0..200_000u32).map(|i| (i.wrapping_mul(i) >> 3) as u8).collect();
        for cut in [0, 1, 70_000, 200_000] {
            let (one, other) = bytes.split_at(cut);
            assert_eq!(Adler::of(one).then(Adler::of(other)), Adler::of(&bytes), "{cut}");
        }
        assert_eq!(Adler::NOTHING.then(Adler::of(&bytes)), Adler::of(&bytes));
    }

    #[test]
    fn a_part_is_whole_bands_whatever_the_width() {
        for width in [1, 7, 1_000, 16_384, 16_385, 65_535] {
            let rows = rows_in_part(width);
            assert!(rows.is_multiple_of(BAND_ROWS) && rows >= BAND_ROWS, "{width}: {rows}");
        }
        assert_eq!(rows_in_part(1_920), 64);
    }
}
