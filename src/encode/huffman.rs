//! Takes how often each symbol comes, makes codes for them: deflate's canonical ones ([RFC 1951, 3.2.2]), the
//! shortest that keep its limit of length, or nearly so.
//!
//! [RFC 1951, 3.2.2]: https://www.rfc-editor.org/rfc/rfc1951#page-8

/// Bits from the lowest up, as deflate packs them.
#[derive(Default)]
pub(super) struct Bits {
    waiting: u64,
    count: u32,
}

impl Bits {
    /// Appends the low `count` bits, up to 32, of `bits`; the others are 0.
    #[inline]
    pub fn push(&mut self, bits: u64, count: u32, out: &mut Vec<u8>) {
        self.waiting |= bits << self.count;
        self.count += count;
        if self.count >= 32 {
            out.extend_from_slice(&(self.waiting as u32).to_le_bytes());
            self.waiting >>= 32;
            self.count -= 32;
        }
    }

    /// Fills the last byte with zeros.
    pub fn align(&mut self, out: &mut Vec<u8>) {
        let bytes = self.count.div_ceil(8) as usize;
        out.extend_from_slice(&self.waiting.to_le_bytes()[..bytes]);
        *self = Bits::default();
    }
}

/// A code for N symbols. One that does not come has no bits.
pub(super) struct Code<const N: usize> {
    /// Bits, the first the lowest.
    pub bits: [u16; N],
    pub lengths: [u8; N],
}

impl<const N: usize> Code<N> {
    /// By how often each symbol comes, with words of up to `limit` bits: `N <= 2^limit`, and `limit <= 15`.
    pub fn new(counts: &[u32; N], limit: usize) -> Code<N> {
        let mut order: Vec<u16> = (0..N as u16).filter(|&symbol| counts[symbol as usize] > 0).collect();
        order.sort_unstable_by_key(|&symbol| (counts[symbol as usize], symbol));
        let sorted: Vec<u32> = order.iter().map(|&symbol| counts[symbol as usize]).collect();
        let mut lengths = [0; N];
        let mut rarest = order.iter();
        let of_length = words_of_length(&sorted, limit);
        for (length, &words) in of_length.iter().enumerate().rev() {
            rarest.by_ref().take(words).for_each(|&symbol| lengths[symbol as usize] = length as u8);
        }
        let mut code = Code { bits: [0; N], lengths };
        code.number(&of_length);
        code
    }

    /// Gives every word its bits: shorter ones first, then by symbol.
    fn number(&mut self, of_length: &[usize]) {
        let mut next = [0u16; 16];
        for length in 1..of_length.len() {
            next[length] =
                (next[length - 1] + if length > 1 { of_length[length - 1] as u16 } else { 0 }) << 1;
        }
        for (bits, &length) in self.bits.iter_mut().zip(&self.lengths).filter(|(_, &length)| length > 0) {
            let word = &mut next[length as usize];
            *bits = word.reverse_bits() >> (16 - u32::from(length));
            *word = word.wrapping_add(1);
        }
    }

    /// Appends a symbol's word.
    #[inline]
    pub fn write(&self, symbol: usize, to: &mut Bits, out: &mut Vec<u8>) {
        to.push(u64::from(self.bits[symbol]), u32::from(self.lengths[symbol]), out);
    }
}

/// How many words have each length, `0..=limit`, in a code for symbols that come so often, rarest first.
fn words_of_length(counts: &[u32], limit: usize) -> Vec<usize> {
    let mut words = vec![0; limit + 1];
    match counts.len() {
        0 => return words,
        1 => {
            words[1] = 1;
            return words;
        }
        _ => {}
    }
    for depth in depths(counts) {
        words[depth.min(limit)] += 1;
    }
    // Where words were cut there are too many: a longest one moves up beside one that is made longer.
    let room = 1usize << limit;
    let mut taken: usize = words.iter().enumerate().skip(1).map(|(length, &n)| n << (limit - length)).sum();
    while taken > room {
        let shorter = (1..limit).rev().find(|&length| words[length] > 0).expect("there is room for all");
        words[limit] -= 1;
        words[shorter] -= 1;
        words[shorter + 1] += 2;
        taken -= 1;
    }
    words
}

/// How deep each of two or more symbols lies in Huffman's tree.
fn depths(counts: &[u32]) -> Vec<usize> {
    let leaves = counts.len();
    // Inner nodes come in order of weight, so the lightest two are always at the front of two queues.
    let mut weights: Vec<u64> = Vec::with_capacity(leaves - 1);
    let mut parents = vec![0; 2 * leaves - 1];
    let (mut leaf, mut inner) = (0, 0);
    for parent in leaves..2 * leaves - 1 {
        let mut lightest = || {
            let (a, b) = (counts.get(leaf).map(|&c| u64::from(c)), weights.get(inner).copied());
            if a.is_some_and(|a| b.is_none_or(|b| a <= b)) {
                leaf += 1;
                (leaf - 1, a)
            } else {
                inner += 1;
                (leaves + inner - 1, b)
            }
        };
        let both = [lightest(), lightest()];
        both.iter().for_each(|&(node, _)| parents[node] = parent);
        weights.push(both.iter().filter_map(|(_, weight)| *weight).sum());
    }
    let mut depths = vec![0; 2 * leaves - 1];
    for node in (0..2 * leaves - 2).rev() {
        depths[node] = depths[parents[node]] + 1;
    }
    depths.truncate(leaves);
    depths
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The room that words take, of 2^15.
    fn taken(lengths: &[u8]) -> u32 {
        lengths.iter().filter(|&&length| length > 0).map(|&length| 1 << (15 - length)).sum()
    }

    #[test]
    fn a_code_is_full_and_its_frequent_words_are_short() {
        let code = Code::new(&[5, 0, 1, 1, 2, 40], 15);
        assert_eq!(code.lengths, [2, 0, 4, 4, 3, 1]);
        assert_eq!(taken(&code.lengths), 1 << 15);
        // As the standard numbers them, read from the highest bit: 0, 10, 110, 1110, 1111.
        assert_eq!(code.bits, [0b01, 0, 0b0111, 0b1111, 0b011, 0]);
    }

    #[test]
    fn no_word_is_longer_than_the_limit() {
        let mut counts = [0; 19];
        let (mut a, mut b) = (1, 1);
        for count in &mut counts {
            // Fibonacci's numbers make the deepest tree.
            *count = a;
            (a, b) = (b, a + b);
        }
        assert_eq!(*Code::new(&counts, 15).lengths.iter().max().unwrap(), 15);
        let short = Code::new(&counts, 7);
        assert_eq!(*short.lengths.iter().max().unwrap(), 7);
        assert_eq!(taken(&short.lengths), 1 << 15);
    }

    #[test]
    fn one_symbol_still_takes_a_bit_and_none_has_no_code() {
        assert_eq!(Code::new(&[0, 3, 0], 15).lengths, [0, 1, 0]);
        assert_eq!(Code::new(&[0; 3], 15).lengths, [0; 3]);
    }
}
