//! Every closed form is held against Catmull's recursion, on random fragments of one pixel.

use super::boundary::Boundary;
use super::few::Few;
use super::fragment::{Cover, Coverer, Fragment, PieceSet, PIXEL_AREA};
use super::sample::Sampler;
use super::split::Integrator;
use crate::bitmap::Bitmap;
use crate::coverage::BandPlace;
use crate::edges::{EdgeList, BAND_ROWS};
use crate::random::Random;
use crate::scene::FillRule;
use crate::strips::{Buckets, Piece};
use crate::zlist::Borders;
use crate::Settings;
use kurbo::Point;
use std::collections::BTreeMap;

/// The pixel looked at is the middle one of a small picture.
const SIDE: u32 = 5;
const MIDDLE: usize = 2;

/// A meeting point that is rounded to the grid moves the border on either side of it by up to half a
/// unit, 1/32768 of a pixel: this is room for some of them, and a twentieth of an 8-bit level.
const TOLERANCE: i64 = PIXEL_AREA / 5_000;

/// Points and polygons from a fixed sequence.
struct Shapes(Random);

impl Shapes {
    fn next(&mut self) -> f64 {
        self.0.bits() as f64 / (1u64 << 31) as f64
    }

    /// In and around the middle pixel; on a coarse grid every second time, for coincidences.
    fn point(&mut self, coarse: bool) -> Point {
        let (x, y) = (1.5 + 2.0 * self.next(), 1.5 + 2.0 * self.next());
        let snap = |v: f64| if coarse { (v * 4.0).round() / 4.0 } else { v };
        Point::new(snap(x), snap(y))
    }

    fn polygon(&mut self, corners: usize, coarse: bool) -> Vec<Point> {
        (0..corners).map(|_| self.point(coarse)).collect()
    }
}

/// Fragments of the middle pixel, with their pieces.
#[derive(Default)]
struct Pixel {
    pieces: Vec<Piece>,
    covers: Vec<Cover>,
    fragments: Vec<Fragment>,
    /// What the fragments were before any closed form: their pieces as drawn.
    raw: Vec<(PieceSet, FillRule)>,
}

impl Pixel {
    fn add(&mut self, polygon: &[Point], rule: FillRule) {
        let mut list = EdgeList::new(SIDE, SIDE);
        list.move_to(polygon[0]);
        polygon[1..].iter().for_each(|&p| list.line_to(p));
        list.close();
        let edges = list.take_banded();
        let mut buckets = Buckets::new(SIDE);
        let finished = Bitmap::new(SIDE as usize, BAND_ROWS as usize);
        for edge in edges.band(0) {
            buckets.add(edge, BandPlace { top: 0, count: SIDE as usize }, &finished, &mut self.pieces);
        }
        let mut cover_left = buckets.take_left(MIDDLE);
        let mut cell = None;
        buckets.drain_row(MIDDLE, (0, SIDE as usize), |x, here| {
            if x < MIDDLE {
                cover_left += here.cover;
            } else if x == MIDDLE {
                cell = Some(here);
            }
        });
        let Some(cell) = cell else {
            return;
        };
        let mut set = PieceSet::default();
        set.gather(cell.pieces, cover_left, &self.pieces);
        let cover = Coverer::default().cover(cell, cover_left, rule, &mut self.pieces);
        self.covers.push(cover);
        self.raw.push((set, rule));
        if let Cover::Part(fragment) = cover {
            self.fragments.push(fragment);
        }
    }

    /// Areas by set of fragments, by the recursion; `None` past its cap.
    fn regions(&self) -> Option<BTreeMap<u64, i64>> {
        let mut integrator = Integrator::default();
        let mut set = PieceSet::default();
        for fragment in &self.fragments {
            set.gather(fragment.pieces, fragment.cover_left, &self.pieces);
            integrator.add(&set, fragment.rule);
        }
        let mut regions = BTreeMap::new();
        let count = self.fragments.len() as u32;
        let wanted = |known: super::split::Known| {
            let next = (!known.known).trailing_zeros();
            (next < count).then_some(next as usize)
        };
        let emit = |known: super::split::Known, area: i64, _: &[super::split::Corner]| {
            *regions.entry(known.inside).or_insert(0) += area;
        };
        integrator.integrate(Settings::DEFAULT_MOST_WORK, wanted, emit).ok()?;
        assert_eq!(regions.values().sum::<i64>(), PIXEL_AREA, "the areas sum exactly to the pixel");
        Some(regions)
    }
}

fn raw_area(set: &PieceSet, rule: FillRule) -> Option<i64> {
    let mut integrator = Integrator::default();
    integrator.add(set, rule);
    let mut inside = 0;
    let wanted = |known: super::split::Known| (known.known == 0).then_some(0);
    integrator
        .integrate(Settings::DEFAULT_MOST_WORK, wanted, |known, area, _| inside += area * known.inside as i64)
        .ok()?;
    Some(inside)
}

#[test]
fn the_area_of_one_fragment_is_what_the_recursion_finds() {
    let mut random = Shapes(Random::new(1));
    let (mut parts, mut crossing) = (0, 0);
    for round in 0..6000 {
        let mut pixel = Pixel::default();
        let rule = if round % 2 == 0 { FillRule::NonZero } else { FillRule::EvenOdd };
        let polygon = random.polygon(3 + round % 7, round % 3 == 0);
        pixel.add(&polygon, rule);
        for (cover, (set, rule)) in pixel.covers.iter().zip(&pixel.raw) {
            let area = match cover {
                Cover::Empty => 0,
                Cover::Full => PIXEL_AREA,
                Cover::Part(fragment) => fragment.area(),
            };
            let truth = raw_area(set, *rule).expect("ten pieces are no burden");
            assert!((area - truth).abs() <= TOLERANCE, "round {round}: {area} for {truth}, {polygon:?}");
            parts += 1;
            crossing += usize::from(matches!(cover, Cover::Part(f) if !f.is_chain));
        }
    }
    assert!(parts > 4000 && crossing > 500, "{parts} fragments, {crossing} of them not one line");
}

#[test]
fn regions_of_few_fragments_are_those_of_the_recursion() {
    let mut random = Shapes(Random::new(2));
    let mut used = [0; 5];
    for round in 0..8000 {
        let mut pixel = Pixel::default();
        for i in 0..2 + round % 3 {
            let rule = if i % 2 == 0 { FillRule::NonZero } else { FillRule::EvenOdd };
            pixel.add(&random.polygon(3 + (round + i) % 4, round % 4 == 0), rule);
        }
        let mut few = Few::default();
        if pixel.fragments.len() < 2 || !pixel.fragments.iter().all(|f| few.add(f, &pixel.pieces)) {
            continue;
        }
        let Some(areas) = few.areas() else {
            continue;
        };
        let truth = pixel.regions().expect("few pieces");
        for (set, &area) in areas.iter().enumerate() {
            let truth = truth.get(&(set as u64)).copied().unwrap_or(0);
            assert!((area - truth).abs() <= TOLERANCE, "round {round}, set {set:b}: {area} for {truth}");
        }
        assert_eq!(areas.iter().sum::<i64>(), PIXEL_AREA);
        used[pixel.fragments.len()] += 1;
    }
    assert!(used[2] > 2000 && used[3] > 1000 && used[4] > 500, "used {used:?} times");
}

#[test]
fn sums_along_borders_are_the_regions_of_the_recursion() {
    let mut random = Shapes(Random::new(3));
    let mut used = 0;
    for round in 0..6000 {
        let mut pixel = Pixel::default();
        for i in 0..2 + round % 4 {
            let rule = if i % 2 == 0 { FillRule::NonZero } else { FillRule::EvenOdd };
            let polygon = random.polygon(3 + (round + i) % 3, round % 3 == 0);
            pixel.add(&polygon, rule);
        }
        if pixel.fragments.len() < 2 || pixel.fragments.iter().any(|f| f.sense == 0) {
            continue;
        }
        let mut boundary = Boundary::default();
        pixel.fragments.iter().for_each(|fragment| boundary.add(fragment, &pixel.pieces));
        let Some(regions) = boundary.regions() else {
            continue;
        };
        let truth = pixel.regions().expect("few pieces");
        assert_eq!(regions.iter().map(|(_, area)| area).sum::<i64>(), PIXEL_AREA);
        for &(set, area) in regions {
            assert!(area >= 0, "no weight is negative");
            let wanted = truth.get(&set).copied().unwrap_or(0);
            assert!((area - wanted).abs() <= TOLERANCE, "round {round}, set {set:b}: {area} for {wanted}");
        }
        used += 1;
    }
    assert!(used > 3000, "the closed form was used {used} times");
}

#[test]
fn fragments_that_pass_the_partition_test_overlap_nowhere_and_leave_nothing() {
    let mut random = Shapes(Random::new(4));
    let mut tiled = 0;
    for round in 0..3000 {
        // A fan of triangles about a point of the pixel, wider than the pixel.
        let centre = random.point(false);
        let rim: Vec<Point> = (0..3 + round % 5)
            .map(|i| {
                let angle = (i as f64 + 0.8 * random.next()) * std::f64::consts::TAU / (3 + round % 5) as f64;
                centre + 9.0 * kurbo::Vec2::from_angle(angle)
            })
            .collect();
        let mut pixel = Pixel::default();
        for (i, &corner) in rim.iter().enumerate() {
            // Every second one is drawn the other way round.
            let next = rim[(i + 1) % rim.len()];
            let triangle = if i % 2 == 0 { [centre, corner, next] } else { [next, corner, centre] };
            pixel.add(&triangle, FillRule::NonZero);
        }
        let mut borders = Borders::default();
        pixel.fragments.iter().for_each(|fragment| borders.add(fragment, &pixel.pieces));
        let area: i64 = pixel.fragments.iter().map(Fragment::area).sum();
        if pixel.fragments.len() > 1 && borders.cancel() && area == PIXEL_AREA {
            tiled += 1;
            for (set, area) in pixel.regions().expect("few pieces") {
                assert!(set.count_ones() == 1 || area <= TOLERANCE, "round {round}: {set:b} has {area}");
            }
        }
    }
    assert!(tiled > 1000, "{tiled} pixels were tiled");
}

#[test]
fn sampling_errs_by_less_than_a_line_a_border() {
    let mut random = Shapes(Random::new(5));
    for round in 0..2000 {
        let mut pixel = Pixel::default();
        pixel.add(&random.polygon(3 + round % 5, false), FillRule::NonZero);
        for (set, rule) in &pixel.raw {
            let mut sampler = Sampler::default();
            sampler.add(set, *rule);
            let (mut inside, mut whole) = (0, 0);
            sampler.sample(|bits, area, _| {
                inside += area * (bits[0] & 1) as i64;
                whole += area;
            });
            assert_eq!(whole, PIXEL_AREA, "the areas sum exactly to the pixel");
            let truth = raw_area(set, *rule).expect("few pieces");
            let borders = set.pieces.len() as i64 + 1;
            assert!((inside - truth).abs() <= borders * PIXEL_AREA / 64, "round {round}");
        }
    }
}
