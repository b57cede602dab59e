//! Takes polygons, makes regions of the plane, and cuts them by one another: what `beam` asks of
//! i_overlay, in one place.
//!
//! Promises: the parts that a cut makes are what they were cut from, but for crossings, which are
//! rounded to a grid of 1/16,384 of a pixel; a picture's work is bounded.

use super::crossings;
use crate::Error;
use i_overlay::core::fill_rule::FillRule as Rule;
use i_overlay::core::overlay::Overlay;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::{IntContour, IntShape};

/// A corner in fixed point pixels.
pub(super) type Corner = IntPoint<i32>;
/// A closed polygon.
pub(super) type Contour = IntContour<i32>;

/// Polygon edges that one picture may hand over to be cut: five to ten seconds' work for most drawings.
const MOST_EDGES: usize = 12_000_000;

/// Crossings of edges that one picture may lead to: about as long.
const MOST_CROSSINGS: usize = 2_000_000;

/// A part of the plane: connected pieces that do not overlap, unless [`Region::united`] is still to be called.
#[derive(Clone, Debug, Default)]
pub(super) struct Region {
    pieces: Vec<Piece>,
}

/// A polygon with its holes.
#[derive(Clone, Debug)]
struct Piece {
    shape: IntShape<i32>,
    bounds: Bounds,
}

/// Both ends belong to it.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
}

impl Bounds {
    fn of<'a>(corners: impl Iterator<Item = &'a Corner>) -> Bounds {
        let none = Bounds { left: i32::MAX, right: i32::MIN, top: i32::MAX, bottom: i32::MIN };
        corners.fold(none, |b, c| Bounds {
            left: b.left.min(c.x),
            right: b.right.max(c.x),
            top: b.top.min(c.y),
            bottom: b.bottom.max(c.y),
        })
    }

    fn meets(&self, other: &Bounds) -> bool {
        self.left <= other.right
            && other.left <= self.right
            && self.top <= other.bottom
            && other.top <= self.bottom
    }
}

/// How much may still be cut.
pub(super) struct Work {
    edges: usize,
    crossings: usize,
}

impl Work {
    pub fn new() -> Work {
        Work { edges: MOST_EDGES, crossings: MOST_CROSSINGS }
    }

    fn spend(&mut self, edges: usize, crossings: usize) -> Result<(), Error> {
        let left = self.edges.checked_sub(edges).zip(self.crossings.checked_sub(crossings));
        (self.edges, self.crossings) = left.ok_or_else(|| {
            Error::Limit(format!(
                "the method beam gives up after cutting {MOST_EDGES} polygon edges or finding {MOST_CROSSINGS} \
                 crossings: this drawing is too large for it, use exact"
            ))
        })?;
        Ok(())
    }
}

impl Region {
    /// What polygons fill.
    pub fn new(contours: &[Contour], rule: crate::scene::FillRule, work: &mut Work) -> Result<Region, Error> {
        let crossings = crossings::estimate(contours.iter(), contours.iter()) / 2;
        work.spend(contours.iter().map(Vec::len).sum(), crossings)?;
        let rule = match rule {
            crate::scene::FillRule::NonZero => Rule::NonZero,
            crate::scene::FillRule::EvenOdd => Rule::EvenOdd,
        };
        Ok(Region::of(Overlay::from_subj(contours).overlay(OverlayRule::Subject, rule)))
    }

    /// A rectangle.
    pub fn rectangle(right: i32, bottom: i32) -> Region {
        let corner = Corner::new;
        let contour = vec![corner(0, 0), corner(right, 0), corner(right, bottom), corner(0, bottom)];
        Region::of(vec![vec![contour]])
    }

    fn of(shapes: Vec<IntShape<i32>>) -> Region {
        let piece = |shape: IntShape<i32>| Piece { bounds: Bounds::of(shape.iter().flatten()), shape };
        Region { pieces: shapes.into_iter().map(piece).collect() }
    }

    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The borders of all pieces: the outer ones run one way, those of holes the other.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.pieces.iter().flat_map(|piece| &piece.shape)
    }

    /// The number of its corners.
    pub fn corners(&self) -> usize {
        self.contours().map(Vec::len).sum()
    }

    /// Adds a region, which does not overlap this one or is united with it later.
    pub fn append(&mut self, other: Region) {
        self.pieces.extend(other.pieces);
    }

    /// The same where its pieces may overlap.
    pub fn united(self, work: &mut Work) -> Result<Region, Error> {
        let contours: Vec<Contour> = self.contours().cloned().collect();
        Region::new(&contours, crate::scene::FillRule::NonZero, work)
    }

    /// What lies in both, and what lies in this one alone.
    pub fn cut(self, by: &Region, work: &mut Work) -> Result<(Region, Region), Error> {
        let meets = |a: &Piece, others: &[Piece]| others.iter().any(|b| a.bounds.meets(&b.bounds));
        let (near, far): (Vec<Piece>, Vec<Piece>) =
            self.pieces.into_iter().partition(|piece| meets(piece, &by.pieces));
        let shapes: Vec<IntShape<i32>> = near.iter().map(|piece| piece.shape.clone()).collect();
        let by: Vec<IntShape<i32>> =
            by.pieces.iter().filter(|piece| meets(piece, &near)).map(|piece| piece.shape.clone()).collect();
        let mut outside = Region { pieces: far };
        let crossings = crossings::estimate(shapes.iter().flatten(), by.iter().flatten());
        work.spend(shapes.iter().chain(&by).flatten().map(Vec::len).sum(), crossings)?;
        let mut overlay = Overlay::from_subj_and_clip(&shapes, &by);
        let Some(graph) = overlay.build_graph_view(Rule::NonZero) else {
            return Ok((Region::default(), outside));
        };
        let mut buffer = Default::default();
        let inside = Region::of(graph.extract_shapes(OverlayRule::Intersect, &mut buffer));
        outside.append(Region::of(graph.extract_shapes(OverlayRule::Difference, &mut buffer)));
        Ok((inside, outside))
    }
}
