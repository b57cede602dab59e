//! `adaptive:N`: takes a row's colours at points, makes pixels of up to N samples, more only where the
//! first ones differ: a jittered quadtree (Cook, *Stochastic Sampling in Computer Graphics*, 1986;
//! Dippé & Wold, *Antialiasing Through Stochastic Sampling*, 1985; Mitchell, *Generating Antialiased
//! Images at Low Sampling Densities*, 1987).
//!
//! A pixel starts as a grid of squares with one sample anywhere in each: a quarter of N of them at most,
//! but four at least. Where four squares of one parent differ, each is cut in four: its sample stays with
//! the quarter that it lies in, and the other three get one of their own. So it goes on, all squares of
//! one size before the smaller ones, until N samples are spent or all fours agree. A square weighs what
//! its area is. A pixel that no border passes through is one sample, at its centre.
//!
//! Promises: what is drawn depends on the drawing and on N alone; the places of the samples come from
//! the pixel's own by an integer hash, so that they are the same on every machine and for any number of
//! threads. What it gets wrong: a thing that all first samples miss stays missed, and that it looks
//! again only where they differ is a bias towards what they saw (Kirk & Arvo 1991).

use super::points::PointRow;
use super::BandPainter;
use crate::band::Picture;
use crate::cel::Rows;
use crate::edges::{FRACTION_BITS, ONE};
use crate::pixel::fragment::PIXEL_AREA;
use crate::pixel::resolve::Mean;
use crate::scene::paint::Sheet;
use std::collections::VecDeque;

/// Samples of which no channel differs by more than this are the same: less than an 8-bit level.
const SAME: f32 = 0.5 / 255.0;

/// Squares are not cut below this side, in fixed point: a 1,024th of a pixel.
const SMALLEST: i32 = ONE >> 10;

/// The first samples are this part of all, at most.
const FIRST_SHARE: usize = 4;

/// Paints by adaptive sampling.
pub(super) struct Adaptive {
    most: usize,
    row: PointRow,
    /// Squares of one parent that may have to be cut, the largest first.
    waiting: VecDeque<[Square; 4]>,
    samples: u64,
    /// Pixels that a border passes through, and those of them that took more than the first samples.
    bordered: u64,
    refined: u64,
}

/// A part of a pixel with the one sample in it, in fixed point pixels.
#[derive(Clone, Copy)]
struct Square {
    x: i32,
    y: i32,
    side: i32,
    sample: (i32, i32),
    color: Sheet,
}

impl Square {
    /// Its quarters' upper left corners.
    fn quarters(x: i32, y: i32, side: i32) -> [(i32, i32); 4] {
        let half = side / 2;
        [(x, y), (x + half, y), (x, y + half), (x + half, y + half)]
    }

    fn holds(&self, (x, y): (i32, i32)) -> bool {
        (self.x..self.x + self.side).contains(&x) && (self.y..self.y + self.side).contains(&y)
    }

    fn area(&self) -> i64 {
        PIXEL_AREA / (i64::from(ONE) * i64::from(ONE)) * i64::from(self.side) * i64::from(self.side)
    }
}

impl Adaptive {
    pub fn new(most: u16, width: u32, height: u32) -> Adaptive {
        Adaptive {
            most: most.into(),
            row: PointRow::new(width, height),
            waiting: VecDeque::new(),
            samples: 0,
            bordered: 0,
            refined: 0,
        }
    }

    /// The mean colour of one pixel.
    fn pixel(&mut self, picture: &Picture, pixel: u32, y: u32) -> Mean {
        let mut random = Random::new(pixel, y);
        let (left, top) = ((pixel as i32) << FRACTION_BITS, (y as i32) << FRACTION_BITS);
        if self.most < 4 {
            return self.few(picture, (left, top), &mut random);
        }
        let parents = self.first_parents();
        let side = ONE / parents;
        for parent in 0..parents * parents {
            let (x, y) = (left + parent % parents * side, top + parent / parents * side);
            let four = Square::quarters(x, y, side)
                .map(|corner| self.sample(picture, corner, side / 2, &mut random));
            self.waiting.push_back(four);
        }
        // Where the samples do not reach for all, no side of the pixel shall come first.
        self.waiting.rotate_left(random.below(self.waiting.len() as u32) as usize);
        let first = 4 * (parents * parents) as usize;
        let (mean, spent) = self.refine(picture, first, &mut random);
        self.refined += u64::from(spent > first);
        mean
    }

    /// Cuts squares for as long as they differ and samples are left; the mean of all, and the number
    /// of samples.
    fn refine(&mut self, picture: &Picture, first: usize, random: &mut Random) -> (Mean, usize) {
        let linear = picture.around.linear;
        let (mut mean, mut spent) = (Mean::default(), first);
        while let Some(four) = self.waiting.pop_front() {
            let done = agree(&four) || four[0].side <= SMALLEST;
            let turn = random.below(4) as usize;
            for i in 0..4 {
                let square = four[(turn + i) % 4];
                if done || spent + 3 > self.most {
                    mean.add(square.color, square.area(), linear);
                    continue;
                }
                spent += 3;
                let quarters = Square::quarters(square.x, square.y, square.side);
                let quarter = |(x, y)| Square { x, y, side: square.side / 2, ..square };
                let four = quarters.map(|corner| match quarter(corner) {
                    same if same.holds(square.sample) => same,
                    _ => self.sample(picture, corner, square.side / 2, random),
                });
                self.waiting.push_back(four);
            }
        }
        (mean, spent)
    }

    /// Fewer samples than there are quarters lie anywhere.
    fn few(&mut self, picture: &Picture, (x, y): (i32, i32), random: &mut Random) -> Mean {
        let mut mean = Mean::default();
        let count = self.most as i64;
        for i in 0..count {
            let area = PIXEL_AREA * (i + 1) / count - PIXEL_AREA * i / count;
            mean.add(self.sample(picture, (x, y), ONE, random).color, area, picture.around.linear);
        }
        mean
    }

    /// Fours along one side of a pixel at the start.
    fn first_parents(&self) -> i32 {
        let mut parents = 1;
        while FIRST_SHARE * 4 * (2 * parents) * (2 * parents) <= self.most {
            parents *= 2;
        }
        parents as i32
    }

    /// A square with a sample anywhere in it.
    fn sample(&mut self, picture: &Picture, (x, y): (i32, i32), side: i32, random: &mut Random) -> Square {
        self.samples += 1;
        let at = (x + random.below(side as u32) as i32, y + random.below(side as u32) as i32);
        Square { x, y, side, sample: at, color: self.row.color(picture, at.0, at.1) }
    }
}

/// Do four samples show the same?
fn agree(four: &[Square; 4]) -> bool {
    let first = four[0].color.channels();
    let same =
        |square: &Square| square.color.channels().iter().zip(first).all(|(a, b)| (a - b).abs() <= SAME);
    four[1..].iter().all(same)
}

impl BandPainter for Adaptive {
    fn render(&mut self, picture: &Picture, _band: usize, mut rows: Rows) {
        let (width, linear) = (picture.width as usize, picture.around.linear);
        let background = picture.around.background.to_rgba8();
        for row in 0..rows.count {
            let y = rows.top + row as u32;
            self.row.prepare(picture, y);
            for (x, pixel) in rows.row(row, width).iter_mut().enumerate() {
                if self.row.is_empty(x) {
                    *pixel = background;
                } else if self.row.is_whole(x) {
                    self.samples += 1;
                    *pixel = self.row.middle(picture, x, y).to_rgba8();
                } else {
                    self.bordered += 1;
                    *pixel = self.pixel(picture, x as u32, y).to_rgba8(linear);
                }
            }
        }
    }

    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        vec![
            ("samples", std::mem::take(&mut self.samples)),
            ("pixels_with_borders", std::mem::take(&mut self.bordered)),
            ("pixels_refined", std::mem::take(&mut self.refined)),
        ]
    }
}

/// Random numbers of one pixel: a counter through a mixing function, the finalizer of MurmurHash3's
/// 32-bit form with the constants of Wellons' `lowbias32`.
struct Random {
    state: u32,
}

impl Random {
    fn new(x: u32, y: u32) -> Random {
        Random { state: mix(x ^ mix(y ^ 0x9e37_79b9)) }
    }

    fn next(&mut self) -> u32 {
        self.state = self.state.wrapping_add(0x9e37_79b9);
        mix(self.state)
    }

    /// 0 .. `end`.
    fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.next()) * u64::from(end)) >> 32) as u32
    }
}

fn mix(mut v: u32) -> u32 {
    v = (v ^ (v >> 16)).wrapping_mul(0x7feb_352d);
    v = (v ^ (v >> 15)).wrapping_mul(0x846c_a68b);
    v ^ (v >> 16)
}
