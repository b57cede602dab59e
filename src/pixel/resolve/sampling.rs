//! Takes a pixel too complex to be split, makes its colour by sub-scanlines ([`Sampler`]).

use super::{Formula, Item, Mean, Place, Resolver, NEGLIGIBLE};
use crate::edges::ONE;
use crate::pixel::fragment::PieceSet;
use crate::pixel::sample::Sampler;
use crate::scene::paint::Sheet;
use crate::scene::shader::Spot;
use crate::scene::FillRule;
use crate::strips::Piece;

/// Parts of a sub-scanline as long as the pixel is wide over which gradients are averaged, where a pixel is sampled.
const PARTS_OF_LINE: f64 = 16.0;

impl Resolver {
    /// The mean colour of the pixel by sub-scanlines.
    pub(super) fn sample(&mut self, place: Place, pieces: &[Piece]) -> Mean {
        let mut sampler = std::mem::take(&mut self.sampler);
        sampler.clear();
        let mean = match self.plain_sheets() {
            Some(sheets) => self.sample_sheets(&mut sampler, &sheets, place, pieces),
            None => self.sample_formulas(&mut sampler, place, pieces),
        };
        self.sampler = sampler;
        mean
    }

    /// The items, if each is a sheet over the whole pixel or over one fragment.
    fn plain_sheets(&self) -> Option<Vec<(Sheet, Option<usize>)>> {
        let plain = |item: &Item| match *item {
            Item::Sheet(sheet, None) => Some((sheet, None)),
            Item::Sheet(sheet, Some(formula)) => match self.formulas[formula] {
                Formula::Leaf(leaf) => Some((sheet, Some(leaf))),
                _ => None,
            },
            _ => None,
        };
        self.items.iter().map(plain).collect()
    }

    /// Samples with one set a sheet, so that a region asks only for the sheets that it lies under.
    fn sample_sheets(
        &mut self,
        sampler: &mut Sampler,
        sheets: &[(Sheet, Option<usize>)],
        place: Place,
        pieces: &[Piece],
    ) -> Mean {
        for &(_, leaf) in sheets {
            match leaf.map(|leaf| self.leaves[leaf]) {
                Some(leaf) => {
                    self.set.gather(leaf.pieces, leaf.cover_left, pieces);
                    sampler.add(&self.set, leaf.rule);
                }
                None => sampler.add(&PieceSet::everywhere(), FillRule::NonZero),
            }
        }
        let mut mean = Mean::default();
        sampler.sample(|inside, area, _| {
            let mut front = Sheet::CLEAR;
            'sheets: for (word, bits) in inside.iter().enumerate() {
                let mut bits = *bits;
                while bits != 0 {
                    front = front.over(sheets[word * 64 + bits.trailing_zeros() as usize].0);
                    bits &= bits - 1;
                    if front.through() < NEGLIGIBLE {
                        break 'sheets;
                    }
                }
            }
            mean.add(front.over(place.around.background), area, place.around.linear);
        });
        mean
    }

    fn sample_formulas(&mut self, sampler: &mut Sampler, place: Place, pieces: &[Piece]) -> Mean {
        for leaf in &self.leaves {
            self.set.gather(leaf.pieces, leaf.cover_left, pieces);
            sampler.add(&self.set, leaf.rule);
        }
        let mut mean = Mean::default();
        sampler.sample(|inside, area, stretch| {
            let known = |leaf: usize| Some(inside[leaf / 64] >> (leaf % 64) & 1 != 0);
            // Gradients change along a stretch.
            let length = (stretch.to - stretch.from) / f64::from(ONE);
            let parts = if self.has_gradient { (length * PARTS_OF_LINE).ceil().max(1.0) } else { 1.0 };
            let share = |i: i64| i as f64 / parts;
            for i in 0..parts as i64 {
                let part = stretch.part(share(i), share(i + 1));
                let corners = part.corners().map(|corner| place.point(corner));
                let spot = Spot::Polygon(place.point(part.centre()), &corners);
                let sheet = self.compose(&known, Some(spot), place.around);
                let area = area * (i + 1) / parts as i64 - area * i / parts as i64;
                mean.add(sheet.expect("every fragment is known"), area, place.around.linear);
            }
        });
        mean
    }
}
