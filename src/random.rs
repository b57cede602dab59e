//! Numbers for unit tests, the same in every run.

/// A linear congruential generator (Knuth's MMIX), of which the upper bits are given out.
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// 0 ..= 2^31 - 1.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// 0 ..= `count` - 1.
    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }
}
