//! Winding numbers of many samples at once: bit-sliced counters, one bit of a word for each sample.
//!
//! A winding number is a sum of digits -1, 0 or 1 times powers of two. It is 0 only if all its digits
//! are (the lowest is as odd as the number, then so on upwards), so that the non-zero rule needs no
//! carries to be worked off, and the even-odd rule needs the lowest digit alone. Nearly all windings of
//! nearly all drawings have one digit.

use super::sets::Bits;
use crate::scene::FillRule;

/// One digit for each sample: 1 in `plus`, -1 in `minus`, 0 in neither; never in both.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally<B> {
    plus: B,
    minus: B,
}

impl<B: Bits> Tally<B> {
    /// Adds `sign` (1 or -1) to the samples of a set. Those returned take a carry: as much again, to
    /// the next digit.
    #[inline]
    #[must_use]
    pub fn add(&mut self, set: B, sign: i32) -> B {
        let (same, other) =
            if sign > 0 { (&mut self.plus, &mut self.minus) } else { (&mut self.minus, &mut self.plus) };
        let rest = set & !*other;
        *other = *other & !set;
        let carry = *same & rest;
        *same = *same ^ rest;
        carry
    }

    fn any(self) -> B {
        self.plus | self.minus
    }

    /// Where the sum of both, each of one digit, lies inside.
    #[inline]
    pub fn inside_of_sum(self, other: Tally<B>, rule: FillRule) -> B {
        match rule {
            FillRule::NonZero => (self.plus ^ other.minus) | (self.minus ^ other.plus),
            FillRule::EvenOdd => self.plus ^ self.minus ^ other.plus ^ other.minus,
        }
    }
}

/// Winding numbers of any size.
#[derive(Clone, Debug, Default)]
pub(crate) struct Windings<B> {
    low: Tally<B>,
    /// The digits above, from the lowest.
    high: Vec<Tally<B>>,
}

impl<B: Bits> Windings<B> {
    /// All 0.
    pub fn clear(&mut self) {
        self.low = Tally::default();
        self.high.clear();
    }

    /// The lowest digit, if there are no others.
    #[inline]
    pub fn one_digit(&self) -> Option<Tally<B>> {
        self.high.is_empty().then_some(self.low)
    }

    /// Adds `sign` (1 or -1) to the samples of a set.
    #[inline]
    pub fn add(&mut self, set: B, sign: i32) {
        let carry = self.low.add(set, sign);
        if carry != B::NONE {
            self.carry(carry, sign);
        }
    }

    /// Adds twice `sign` to the samples of a set.
    pub fn carry(&mut self, mut set: B, sign: i32) {
        for digit in &mut self.high {
            set = digit.add(set, sign);
            if set == B::NONE {
                break;
            }
        }
        if set != B::NONE {
            let mut digit = Tally::default();
            let none = digit.add(set, sign);
            debug_assert!(none == B::NONE);
            self.high.push(digit);
        }
        while self.high.last().is_some_and(|digit| digit.any() == B::NONE) {
            self.high.pop();
        }
    }

    #[inline]
    pub fn add_tally(&mut self, tally: Tally<B>) {
        self.add(tally.plus, 1);
        self.add(tally.minus, -1);
    }

    /// Adds a number to the samples of a set.
    pub fn add_number(&mut self, set: B, number: i32) {
        for _ in 0..number.unsigned_abs() {
            self.add(set, number.signum());
        }
    }

    /// Where they lie inside.
    #[inline]
    pub fn inside(&self, rule: FillRule) -> B {
        match rule {
            FillRule::NonZero => self.high.iter().fold(self.low.any(), |any, digit| any | digit.any()),
            FillRule::EvenOdd => self.low.any(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn windings_are_sums_whatever_was_added_in_whatever_order() {
        let mut numbers = Random::new(1);
        let mut random = || numbers.bits();
        for round in 0..200 {
            let mut windings = Windings::<u16>::default();
            let mut sums = [0i32; 16];
            for _ in 0..round {
                let (set, sign) = (random() as u16, if random() % 3 == 0 { -1 } else { 1 });
                let twice = random() % 4 == 0;
                if twice {
                    windings.carry(set, sign);
                } else {
                    windings.add(set, sign);
                }
                for (i, sum) in sums.iter_mut().enumerate() {
                    *sum += i32::from(set >> i & 1) * sign * (1 + i32::from(twice));
                }
                for (i, &sum) in sums.iter().enumerate() {
                    let inside = |rule| windings.inside(rule) >> i & 1 != 0;
                    assert_eq!(inside(FillRule::NonZero), sum != 0, "round {round}");
                    assert_eq!(inside(FillRule::EvenOdd), sum % 2 != 0, "round {round}");
                }
            }
        }
    }
}
