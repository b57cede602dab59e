//! One bit for each pixel of a band, and walks over runs of them.

/// Rows of bits, 64 to a word.
#[derive(Clone, Debug)]
pub(crate) struct Bitmap {
    words: usize,
    bits: Vec<u64>,
}

impl Bitmap {
    /// All bits 0.
    pub fn new(columns: usize, rows: usize) -> Bitmap {
        let words = columns.div_ceil(64);
        Bitmap { words, bits: vec![0; words * rows] }
    }

    /// Makes all bits 0.
    pub fn clear(&mut self) {
        self.bits.fill(0);
    }

    /// Takes over another of the same size.
    pub fn copy_from(&mut self, other: &Bitmap) {
        self.bits.copy_from_slice(&other.bits);
    }

    /// Words in a row.
    pub fn words(&self) -> usize {
        self.words
    }

    /// All words, row by row.
    #[inline]
    pub fn bits(&self) -> &[u64] {
        &self.bits
    }

    /// All words, row by row.
    #[inline]
    pub fn bits_mut(&mut self) -> &mut [u64] {
        &mut self.bits
    }

    #[inline]
    pub fn row(&self, row: usize) -> &[u64] {
        &self.bits[row * self.words..(row + 1) * self.words]
    }

    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [u64] {
        &mut self.bits[row * self.words..(row + 1) * self.words]
    }

    #[inline]
    pub fn get(&self, row: usize, column: usize) -> bool {
        self.bits[row * self.words + column / 64] >> (column % 64) & 1 != 0
    }

    #[inline]
    pub fn set(&mut self, row: usize, column: usize) {
        self.bits[row * self.words + column / 64] |= 1 << (column % 64);
    }

    #[inline]
    pub fn unset(&mut self, row: usize, column: usize) {
        self.bits[row * self.words + column / 64] &= !(1 << (column % 64));
    }

    /// Are all bits of columns [from, to) 1?
    pub fn all_set(&self, row: usize, from: usize, to: usize) -> bool {
        let words = self.row(row);
        word_masks(from, to).all(|(word, mask)| words[word] & mask == mask)
    }
}

/// The words that hold columns [from, to), each with the mask of those columns.
#[inline(always)]
pub(crate) fn word_masks(from: usize, to: usize) -> impl Iterator<Item = (usize, u64)> {
    (from / 64..to.div_ceil(64)).map(move |word| {
        let low = from.saturating_sub(word * 64);
        let high = (to - word * 64).min(64);
        (word, word_mask(low, high))
    })
}

/// Pixels [a, b) of a word, of which there is one at least.
#[inline(always)]
pub(crate) fn word_mask(a: usize, b: usize) -> u64 {
    (u64::MAX << a) & (u64::MAX >> (64 - b))
}

/// Calls `take` with each run [from, to) of set bits in one word; columns count from the word's first.
#[inline(always)]
pub(crate) fn for_runs(mut bits: u64, mut take: impl FnMut(usize, usize)) {
    while bits != 0 {
        // Adding its lowest bit to a run clears it, and sets the bit behind it.
        let behind = bits.wrapping_add(bits & bits.wrapping_neg());
        take(bits.trailing_zeros() as usize, behind.trailing_zeros() as usize);
        bits &= behind;
    }
}

/// Calls `take` with each set bit of one word.
#[inline(always)]
pub(crate) fn for_bits(mut bits: u64, mut take: impl FnMut(usize)) {
    while bits != 0 {
        take(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_cover_exactly_the_columns() {
        for (from, to) in [(0, 1), (0, 64), (63, 65), (5, 200), (64, 128), (70, 70)] {
            let mut columns = Vec::new();
            for (word, mask) in word_masks(from, to) {
                for_runs(mask, |a, b| columns.extend(word * 64 + a..word * 64 + b));
            }
            assert_eq!(columns, (from..to).collect::<Vec<_>>());
        }
    }

    #[test]
    fn runs_of_a_word_are_found_in_order() {
        let mut runs = Vec::new();
        for_runs(0b1011 | 1 << 63, |a, b| runs.push((a, b)));
        assert_eq!(runs, [(0, 2), (3, 4), (63, 64)]);
        for_runs(u64::MAX, |a, b| assert_eq!((a, b), (0, 64)));
    }
}
