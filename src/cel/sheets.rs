//! The sheets of a band's pixels: of each that is uniform so far, all that was painted on it.
//!
//! Neighbours that have the same share one, which is kept at the first of them, and a bit tells where such a
//! run begins. So painting takes time by the borders that were painted before and not by pixels. Runs end
//! with the 64 pixels of a word.
//!
//! What stands for pixels that nobody has painted is not defined.

use crate::bitmap::{word_mask, Bitmap};
use crate::pixel::resolve::NEGLIGIBLE;
use crate::scene::paint::Sheet;

/// Rows of sheets, 64 to a word. A word is given by its row and its number there; pixels [a, b) count from
/// its first.
pub(super) struct Sheets {
    /// Where runs begin; each word's first pixel begins one, whether its bit is set or not.
    starts: Bitmap,
    sheets: Vec<[Sheet; 64]>,
}

impl Sheets {
    pub fn new(columns: usize, rows: usize) -> Sheets {
        let starts = Bitmap::new(columns, rows);
        Sheets { sheets: vec![[Sheet::CLEAR; 64]; starts.bits().len()], starts }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.starts.clear();
    }

    /// The sheet of one pixel.
    #[inline]
    pub fn get(&self, row: usize, x: usize) -> Sheet {
        let at = row * self.starts.words() + x / 64;
        self.sheets[at][first_of(self.starts.bits()[at], x % 64)]
    }

    /// Gives one pixel a sheet.
    #[inline]
    pub fn set(&mut self, row: usize, x: usize, sheet: Sheet) {
        self.fill((row, x / 64), (x % 64, x % 64 + 1), sheet);
    }

    /// Gives pixels [a, b) a sheet.
    #[inline]
    pub fn fill(&mut self, word: (usize, usize), (a, b): (usize, usize), sheet: Sheet) {
        let (starts, sheets) = self.word(word);
        start_at(starts, sheets, b);
        *starts = *starts & !word_mask(a, b) | 1 << a;
        sheets[a] = sheet;
    }

    /// Puts a sheet behind those of pixels [a, b); tells which of them let no light through then.
    #[inline]
    pub fn put_behind(&mut self, word: (usize, usize), (a, b): (usize, usize), behind: Sheet) -> u64 {
        let mut saturated = 0;
        self.change(word, (a, b), |from, to, sheet| {
            let both = sheet.over(behind);
            if both.through() < NEGLIGIBLE {
                saturated |= word_mask(from, to);
            }
            both
        });
        saturated
    }

    /// Gives each run of pixels [a, b) another sheet; `new` is told where it lies and what it has.
    #[inline]
    pub fn change(
        &mut self,
        word: (usize, usize),
        (a, b): (usize, usize),
        mut new: impl FnMut(usize, usize, Sheet) -> Sheet,
    ) {
        let (starts, sheets) = self.word(word);
        start_at(starts, sheets, a);
        start_at(starts, sheets, b);
        for_each(*starts, (a, b), |from, to| sheets[from] = new(from, to, sheets[from]));
    }

    /// Calls `take` with each run of pixels [a, b): where it lies and what it has.
    #[inline]
    pub fn for_runs(
        &self,
        (row, word): (usize, usize),
        (a, b): (usize, usize),
        mut take: impl FnMut(usize, usize, Sheet),
    ) {
        let at = row * self.starts.words() + word;
        let (starts, sheets) = (self.starts.bits()[at], &self.sheets[at]);
        let first = first_of(starts, a);
        for_each(starts, (a, b), |from, to| take(from, to, sheets[if from == a { first } else { from }]));
    }

    /// The sheets of pixels [a, b), each its own from now on.
    pub fn each(&mut self, word: (usize, usize), (a, b): (usize, usize)) -> &mut [Sheet] {
        let (starts, sheets) = self.word(word);
        start_at(starts, sheets, a);
        start_at(starts, sheets, b);
        for_each(*starts, (a, b), |from, to| {
            let sheet = sheets[from];
            sheets[from..to].fill(sheet);
        });
        *starts |= word_mask(a, b);
        &mut sheets[a..b]
    }

    /// The same for pixels that had none before: what they have is not defined until it is written.
    pub fn start_each(&mut self, word: (usize, usize), (a, b): (usize, usize)) -> &mut [Sheet] {
        let (starts, sheets) = self.word(word);
        start_at(starts, sheets, b);
        *starts |= word_mask(a, b);
        &mut sheets[a..b]
    }

    #[inline]
    fn word(&mut self, (row, word): (usize, usize)) -> (&mut u64, &mut [Sheet; 64]) {
        let at = row * self.starts.words() + word;
        (&mut self.starts.bits_mut()[at], &mut self.sheets[at])
    }
}

/// Where the run of a pixel begins.
#[inline]
fn first_of(starts: u64, x: usize) -> usize {
    63 - ((starts | 1) & (u64::MAX >> (63 - x))).leading_zeros() as usize
}

/// Lets a run begin at a pixel, or behind the last one.
#[inline]
fn start_at(starts: &mut u64, sheets: &mut [Sheet; 64], x: usize) {
    if x < 64 && *starts >> x & 1 == 0 {
        sheets[x] = sheets[first_of(*starts, x)];
        *starts |= 1 << x;
    }
}

/// Calls `take` with the runs of pixels [a, b), of which the first begins at `a`.
#[inline]
fn for_each(starts: u64, (a, b): (usize, usize), mut take: impl FnMut(usize, usize)) {
    let mut from = a;
    let mut rest = starts & word_mask(a, b) & !(1 << a);
    while rest != 0 {
        let to = rest.trailing_zeros() as usize;
        take(from, to);
        from = to;
        rest &= rest - 1;
    }
    take(from, b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// What is the same is one run, and what was split stays what it was.
    #[test]
    fn pixels_keep_what_was_painted_on_them() {
        let sheet = |v: f32| Sheet::new([v; 3], 0.5);
        let mut sheets = Sheets::new(100, 2);
        let mut expected = vec![Sheet::CLEAR; 200];
        sheets.fill((0, 0), (0, 64), Sheet::CLEAR);
        sheets.fill((1, 0), (0, 64), Sheet::CLEAR);
        sheets.fill((0, 1), (0, 36), Sheet::CLEAR);
        sheets.fill((1, 1), (0, 36), Sheet::CLEAR);
        let mut numbers = Random::new(1);
        let mut random = |below: u64| numbers.below(below);
        for step in 0..2000 {
            let (row, word) = (random(2) as usize, random(2) as usize);
            let columns = if word == 0 { 64 } else { 36 };
            let (a, b) = (random(columns) as usize, random(columns) as usize);
            let (a, b) = (a.min(b), a.max(b) + 1);
            let pixels = &mut expected[row * 100 + word * 64..][a..b];
            let new = sheet(random(1000) as f32 / 1000.0);
            match step % 5 {
                0 => {
                    sheets.fill((row, word), (a, b), new);
                    pixels.fill(new);
                }
                1 => {
                    sheets.put_behind((row, word), (a, b), new);
                    pixels.iter_mut().for_each(|sheet| *sheet = sheet.over(new));
                }
                2 => {
                    sheets.change((row, word), (a, b), |_, _, sheet| sheet.faded(0.9));
                    pixels.iter_mut().for_each(|sheet| *sheet = sheet.faded(0.9));
                }
                3 => {
                    let each = sheets.start_each((row, word), (a, b));
                    each.iter_mut().enumerate().for_each(|(i, sheet)| *sheet = new.faded(i as f32 / 64.0));
                    pixels.copy_from_slice(each);
                }
                _ => {
                    let each = sheets.each((row, word), (a, b));
                    each[0] = new;
                    pixels[0] = new;
                }
            }
            let found: Vec<Sheet> = (0..200).map(|pixel| sheets.get(pixel / 100, pixel % 100)).collect();
            assert_eq!(found, expected, "after step {step}");
            let mut seen = a;
            sheets.for_runs((row, word), (a, b), |from, to, sheet| {
                assert_eq!(from, seen);
                assert!(expected[row * 100 + word * 64..][from..to].iter().all(|&pixel| pixel == sheet));
                seen = to;
            });
            assert_eq!(seen, b);
        }
    }

    #[test]
    fn a_sheet_that_lets_no_light_through_is_told_of() {
        let mut sheets = Sheets::new(64, 1);
        sheets.fill((0, 0), (0, 64), Sheet::new([0.0; 3], 0.5));
        sheets.fill((0, 0), (10, 20), Sheet::CLEAR);
        assert_eq!(sheets.put_behind((0, 0), (0, 64), Sheet::new([1.0; 3], 0.5)), 0);
        assert_eq!(sheets.put_behind((0, 0), (5, 15), Sheet::new([1.0; 3], 1.0)), word_mask(5, 15));
    }
}
