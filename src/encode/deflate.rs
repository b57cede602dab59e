//! Takes bytes, makes deflate blocks ([RFC 1951]): made for filtered rows of flat art, which are mostly zeros.
//!
//! Runs of a byte or a pixel are found first, as fast as memory is read, and nothing within them is looked
//! at again; elsewhere bytes that came before are found by chains of hashes.
//!
//! Promises: what comes out depends on the bytes alone, not on what was packed before; it ends at a whole byte, and
//! other blocks may follow.
//!
//! [RFC 1951]: https://www.rfc-editor.org/rfc/rfc1951

use super::huffman::{Bits, Code};

/// Farthest that a match lies back.
const WINDOW: usize = 1 << 15;
/// Shortest match that is looked for.
const SHORTEST: usize = 4;
/// Longest that there is a symbol for.
const LONGEST: usize = 258;
/// A run of this many bytes is taken without a look at anything else.
const RUN: usize = 16;
/// Literals and matches in a block.
const BLOCK: usize = 1 << 15;
/// Bytes in a block that is not packed.
const STORED: usize = 0xffff;

const HASH_BITS: u32 = 15;

/// How hard it works.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    /// Places that are looked at for a match.
    pub depth: usize,
    /// A shorter match is taken only if none at the next byte is longer.
    pub lazy: usize,
    /// A match this long ends the search.
    pub nice: usize,
}

/// Packs bytes, piece by piece; keeps its tables.
pub(super) struct Deflater {
    search: Search,
    /// The latest place of each hash, counted over all pieces.
    heads: Vec<u32>,
    /// The place before of the same hash, by place.
    before: Vec<u32>,
    /// Place of the piece's first byte.
    start: u32,
    block: Block,
}

impl Deflater {
    /// With these tables kept, 300 KB or so.
    pub fn new(search: Search) -> Deflater {
        let (heads, before) = (vec![0; 1 << HASH_BITS], vec![0; WINDOW]);
        // Place 0 is nowhere.
        Deflater { search, heads, before, start: 1, block: Block::new() }
    }

    /// Appends `data`, packed, to `out`. Its pixels have `step` bytes.
    pub fn deflate(&mut self, data: &[u8], step: usize, out: &mut Vec<u8>) {
        if u32::try_from(data.len()).ok().and_then(|length| self.start.checked_add(length)).is_none() {
            self.heads.fill(0);
            self.start = 1;
        }
        let mut bits = Bits::default();
        // Behind the last literal or match.
        let (mut at, mut block_from) = (0, 0);
        while at < data.len() {
            at = self.next(data, at, step);
            if self.block.tokens.len() >= BLOCK || at == data.len() {
                self.block.write(&data[block_from..at], &mut bits, out);
                block_from = at;
            }
        }
        // An empty stored block ends at a whole byte.
        store(&[], &mut bits, out);
        self.start = self.start.saturating_add(data.len() as u32);
    }

    /// Adds what is next to the block; returns where that ends.
    fn next(&mut self, data: &[u8], at: usize, step: usize) -> usize {
        if let Some((length, distance)) = run(data, at, step) {
            return self.block.run(at, length, distance);
        }
        // Where a run of one byte begins, that byte is the cheapest way in.
        let found = if repeats_once(data, at) { None } else { self.find(data, at, SHORTEST - 1) };
        let Some((mut length, mut distance)) = found else {
            self.block.literal(data[at]);
            return at + 1;
        };
        let mut from = at;
        while length < self.search.lazy {
            let longer = match run(data, from + 1, step) {
                Some((run, _)) if run > length => None,
                _ => self.find(data, from + 1, length),
            };
            let Some(better) = longer else { break };
            self.block.literal(data[from]);
            from += 1;
            (length, distance) = better;
        }
        for at in (from..from + length).step_by(step).skip(1) {
            self.file(data, at);
        }
        self.block.run(from, length, distance)
    }

    /// A match at `at` that is longer than `least`, and how far back it lies; files `at`.
    #[inline]
    fn find(&mut self, data: &[u8], at: usize, least: usize) -> Option<(usize, usize)> {
        let mut place = self.file(data, at)?;
        let here = self.start + at as u32;
        let oldest = self.start.max((here + 1).saturating_sub(WINDOW as u32));
        let most = LONGEST.min(data.len() - at);
        let mut best = (least, 0);
        for _ in 0..self.search.depth {
            if place < oldest || best.0 >= most {
                break;
            }
            let from = (place - self.start) as usize;
            if data[from + best.0] == data[at + best.0] {
                let length = common(data, from, at, most);
                if length > best.0 {
                    best = (length, at - from);
                    if length >= self.search.nice {
                        break;
                    }
                }
            }
            place = self.before[place as usize % WINDOW];
        }
        (best.1 > 0).then_some(best)
    }

    /// Files a place under its hash; the last one before with the same.
    #[inline]
    fn file(&mut self, data: &[u8], at: usize) -> Option<u32> {
        let word = u32::from_le_bytes(*data.get(at..)?.first_chunk()?);
        let hash = word.wrapping_mul(0x9e37_79b1) >> (32 - HASH_BITS);
        let here = self.start + at as u32;
        let last = std::mem::replace(&mut self.heads[hash as usize], here);
        self.before[here as usize % WINDOW] = last;
        Some(last)
    }
}

/// How many bytes from `b` on are those from `a` on, `most` at most; `a < b`.
#[inline]
fn common(data: &[u8], a: usize, b: usize, most: usize) -> usize {
    /// Bytes that are compared at once in what is long.
    const WIDE: usize = 32;
    let (mut one, mut other) = (&data[a..a + most], &data[b..b + most]);
    let mut same = 0;
    if let Some(length) = differing_word(one, other) {
        return length;
    }
    let differ = |x: &[u8; WIDE], y: &[u8; WIDE]| {
        let words = x.as_chunks::<8>().0.iter().zip(y.as_chunks::<8>().0);
        words.fold(0, |all, (x, y)| all | (u64::from_le_bytes(*x) ^ u64::from_le_bytes(*y)))
    };
    while let (Some(x), Some(y)) = (one.first_chunk(), other.first_chunk()) {
        if differ(x, y) != 0 {
            break;
        }
        same += WIDE;
        (one, other) = (&one[WIDE..], &other[WIDE..]);
    }
    while let (Some(x), Some(y)) = (one.first_chunk::<8>(), other.first_chunk::<8>()) {
        if let Some(length) = differing_word(x, y) {
            return same + length;
        }
        same += 8;
        (one, other) = (&one[8..], &other[8..]);
    }
    same + one.iter().zip(other).take_while(|(x, y)| x == y).count()
}

/// How many of the first eight bytes are the same, if not all.
#[inline]
fn differing_word(one: &[u8], other: &[u8]) -> Option<usize> {
    let differ = u64::from_le_bytes(*one.first_chunk()?) ^ u64::from_le_bytes(*other.first_chunk()?);
    (differ != 0).then_some(differ.trailing_zeros() as usize / 8)
}

/// A run that begins here: as many bytes as are the byte, or the pixel, before.
#[inline]
fn run(data: &[u8], at: usize, step: usize) -> Option<(usize, usize)> {
    let left = data.len() - at;
    for back in [1, step] {
        if at >= back && left >= RUN && data[at..at + 8] == data[at - back..][..8] {
            let length = common(data, at - back, at, left);
            if length >= RUN {
                return Some((length, back));
            }
        }
    }
    None
}

/// Is a byte the first of a run?
#[inline]
fn repeats_once(data: &[u8], at: usize) -> bool {
    data[at..].first_chunk::<RUN>().is_some_and(|bytes| *bytes == [bytes[0]; RUN])
}

/// A literal, or a match: its length and distance above a flag.
#[derive(Clone, Copy)]
struct Token(u32);

const MATCH: u32 = 1 << 31;
const LENGTHS: usize = 286;
const DISTANCES: usize = 30;
/// The symbol that ends a block.
const END: usize = 256;

/// Literals and matches, and how often each symbol comes.
struct Block {
    tokens: Vec<Token>,
    lengths: [u32; LENGTHS],
    distances: [u32; DISTANCES],
}

impl Block {
    fn new() -> Block {
        Block { tokens: Vec::new(), lengths: [0; LENGTHS], distances: [0; DISTANCES] }
    }

    #[inline]
    fn literal(&mut self, byte: u8) {
        self.tokens.push(Token(byte.into()));
        self.lengths[byte as usize] += 1;
    }

    /// Adds matches for bytes that lie `distance` back, from `at` on; returns where they end. Two bytes or fewer that
    /// are left over are not added.
    #[inline]
    fn run(&mut self, at: usize, length: usize, distance: usize) -> usize {
        let far = distance as u32 - 1;
        let mut left = length;
        while left >= 3 {
            let length = left.min(LONGEST);
            self.tokens.push(Token(MATCH | (length as u32 - 3) << 15 | far));
            self.lengths[LENGTH_SYMBOLS[length - 3].symbol()] += 1;
            self.distances[distance_symbol(far).0] += 1;
            left -= length;
        }
        at + length - left
    }

    /// Appends all, which stands for `data`, and is empty again.
    fn write(&mut self, data: &[u8], bits: &mut Bits, out: &mut Vec<u8>) {
        self.lengths[END] = 1;
        let lengths = Code::new(&self.lengths, 15);
        let distances = Code::new(&self.distances, 15);
        if self.size(&lengths.lengths, &distances.lengths) > 8 * data.len() as u64 {
            data.chunks(STORED).for_each(|data| store(data, bits, out));
        } else {
            // Not the last block; its codes are told.
            bits.push(0b100, 3, out);
            write_codes(&lengths.lengths, &distances.lengths, bits, out);
            for token in &self.tokens {
                token.write(&lengths, &distances, bits, out);
            }
            lengths.write(END, bits, out);
        }
        self.tokens.clear();
        self.lengths.fill(0);
        self.distances.fill(0);
    }

    /// Bits that the tokens take.
    fn size(&self, lengths: &[u8], distances: &[u8]) -> u64 {
        let of_symbols = |counts: &[u32], lengths: &[u8]| {
            counts
                .iter()
                .zip(lengths)
                .map(|(&count, &length)| u64::from(count) * u64::from(length))
                .sum::<u64>()
        };
        // The bits behind symbols are left out: they are few, and none where nothing repeats.
        of_symbols(&self.lengths, lengths) + of_symbols(&self.distances, distances)
    }
}

impl Token {
    #[inline]
    fn write(self, lengths: &Code<LENGTHS>, distances: &Code<DISTANCES>, bits: &mut Bits, out: &mut Vec<u8>) {
        let Token(token) = self;
        if token & MATCH == 0 {
            return lengths.write(token as usize, bits, out);
        }
        let length = (token & !MATCH) >> 15;
        let symbol = LENGTH_SYMBOLS[length as usize];
        lengths.write(symbol.symbol(), bits, out);
        bits.push(u64::from(length - symbol.least as u32), symbol.more.into(), out);
        let far = token & (WINDOW as u32 - 1);
        let (symbol, more) = distance_symbol(far);
        distances.write(symbol, bits, out);
        bits.push(u64::from(far) & ((1 << more) - 1), more, out);
    }
}

/// The symbol of a length.
#[derive(Clone, Copy)]
struct LengthSymbol {
    /// Above 257.
    number: u8,
    /// Bits that follow.
    more: u8,
    /// The least length of the symbol, above 3.
    least: u8,
}

impl LengthSymbol {
    fn symbol(self) -> usize {
        257 + self.number as usize
    }
}

/// By length, above 3.
const LENGTH_SYMBOLS: [LengthSymbol; 256] = {
    let mut symbols = [LengthSymbol { number: 28, more: 0, least: 255 }; 256];
    let (mut length, mut number) = (0, 0);
    while length < 255 {
        let more = if number < 8 { 0 } else { number / 4 - 1 };
        let (least, next) = (length, length + (1 << more));
        while length < next && length < 255 {
            symbols[length] = LengthSymbol { number, more, least: least as u8 };
            length += 1;
        }
        number += 1;
    }
    symbols
};

/// The symbol of a distance, above 1, and how many of its low bits follow.
#[inline]
fn distance_symbol(far: u32) -> (usize, u32) {
    if far < 4 {
        return (far as usize, 0);
    }
    let more = far.ilog2() - 1;
    ((2 * more + (far >> more)) as usize, more)
}

/// Appends up to [`STORED`] bytes as they are.
fn store(data: &[u8], bits: &mut Bits, out: &mut Vec<u8>) {
    bits.push(0, 3, out);
    bits.align(out);
    let length = data.len() as u16;
    out.extend_from_slice(&length.to_le_bytes());
    out.extend_from_slice(&(!length).to_le_bytes());
    out.extend_from_slice(data);
}

/// Symbols of the code of codes: lengths, repeats of one, zeros, many zeros.
const CODE_SYMBOLS: usize = 19;

/// Appends the lengths of both codes' words, packed.
fn write_codes(lengths: &[u8], distances: &[u8], bits: &mut Bits, out: &mut Vec<u8>) {
    /// In which the lengths of the code of codes are told: the likely ones first.
    const ORDER: [usize; CODE_SYMBOLS] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
    let used = |lengths: &[u8], least: usize| {
        lengths.iter().rposition(|&l| l > 0).map_or(least, |at| (at + 1).max(least))
    };
    let (lengths, distances) = (&lengths[..used(lengths, END + 1)], &distances[..used(distances, 1)]);
    let both: Vec<u8> = [lengths, distances].concat();
    let symbols = repeats(&both);
    let mut counts = [0; CODE_SYMBOLS];
    symbols.iter().for_each(|&(symbol, ..)| counts[symbol] += 1);
    let code = Code::new(&counts, 7);
    let told = ORDER.iter().rposition(|&symbol| code.lengths[symbol] > 0).map_or(4, |at| (at + 1).max(4));
    bits.push(lengths.len() as u64 - 257, 5, out);
    bits.push(distances.len() as u64 - 1, 5, out);
    bits.push(told as u64 - 4, 4, out);
    for &symbol in &ORDER[..told] {
        bits.push(code.lengths[symbol].into(), 3, out);
    }
    for (symbol, more, count) in symbols {
        code.write(symbol, bits, out);
        bits.push(more, count, out);
    }
}

/// Lengths of words as symbols of the code of codes, each with the bits behind it and how many they are.
fn repeats(lengths: &[u8]) -> Vec<(usize, u64, u32)> {
    let mut symbols = Vec::new();
    for same in lengths.chunk_by(|a, b| a == b) {
        let length = same[0];
        let mut left = same.len();
        if length > 0 {
            symbols.push((length.into(), 0, 0));
            left -= 1;
        }
        while left >= 3 {
            let (symbol, least, most, more) = match length {
                0 if left > 10 => (18, 11, 138, 7),
                0 => (17, 3, 10, 3),
                _ => (16, 3, 6, 2),
            };
            let count = left.min(most);
            symbols.push((symbol, (count - least) as u64, more));
            left -= count;
        }
        symbols.extend(std::iter::repeat_n((length.into(), 0, 0), left));
    }
    symbols
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::write::DeflateDecoder;
    use std::io::Write;

    fn packed(deflater: &mut Deflater, data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        deflater.deflate(data, 4, &mut out);
        out
    }

    fn unpacked(packed: &[u8]) -> Vec<u8> {
        let mut decoder = DeflateDecoder::new(Vec::new());
        decoder.write_all(packed).unwrap();
        // An empty block that is the last.
        decoder.write_all(&[3, 0]).unwrap();
        decoder.finish().unwrap()
    }

    fn noise(length: usize, values: u32) -> Vec<u8> {
        let mut state = 1u32;
        let bytes = (0..length).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 16) % values) as u8
        });
        bytes.collect()
    }

    fn pieces() -> Vec<Vec<u8>> {
        let mut pieces: Vec<Vec<u8>> = (0..300).map(|length| vec![7; length]).collect();
        pieces.extend((0..40).map(|length| noise(length, 3)));
        pieces.extend([1, 2, 3, 5, 17, 256].map(|values| noise(100_000, values)));
        pieces.push([1, 2, 3, 4].repeat(30_000));
        pieces.push(noise(WINDOW + 10, 256).repeat(2));
        pieces.push(noise(WINDOW - 1, 256).repeat(2));
        pieces
    }

    #[test]
    fn what_is_packed_comes_back_whatever_it_is_and_was_before() {
        for search in [Search { depth: 1, lazy: 4, nice: 8 }, Search { depth: 16, lazy: 16, nice: 64 }] {
            let mut deflater = Deflater::new(search);
            for piece in pieces() {
                let now = packed(&mut deflater, &piece);
                assert!(unpacked(&now) == piece, "{} bytes", piece.len());
                assert!(now == packed(&mut Deflater::new(search), &piece), "{} bytes", piece.len());
            }
        }
    }

    #[test]
    fn what_repeats_takes_little_and_noise_no_more_than_itself() {
        let mut deflater = Deflater::new(Search { depth: 8, lazy: 16, nice: 32 });
        assert!(packed(&mut deflater, &vec![0; 1_000_000]).len() < 1_100);
        assert!(packed(&mut deflater, &noise(WINDOW - 1, 256).repeat(2)).len() < WINDOW + 400);
        assert!(packed(&mut deflater, &noise(1_000_000, 256)).len() < 1_000_200);
    }

    #[test]
    fn every_length_and_distance_has_the_symbol_of_the_standard() {
        let of = |length: usize| {
            let LengthSymbol { more, least, .. } = LENGTH_SYMBOLS[length - 3];
            (LENGTH_SYMBOLS[length - 3].symbol(), more, least as usize + 3)
        };
        assert_eq!([of(3), of(10), of(11), of(12)], [(257, 0, 3), (264, 0, 10), (265, 1, 11), (265, 1, 11)]);
        assert_eq!([of(130), of(257), of(258)], [(280, 4, 115), (284, 5, 227), (285, 0, 258)]);
        let far = |distance: u32| distance_symbol(distance - 1);
        assert_eq!([far(1), far(4), far(5), far(7)], [(0, 0), (3, 0), (4, 1), (5, 1)]);
        assert_eq!([far(24_577), far(32_768)], [(29, 13), (29, 13)]);
    }
}
