//! Takes how far the pen goes and turns, makes the number of stops that keep its outline within the tolerance.

use crate::chords::{chord_count, AREA_SHARE};

/// As [`AREA_SHARE`], for round joins and caps: they often lie on one another, and all that sticks out of any of them is
/// inked, so that lobes add up there which otherwise cancel.
const AREA_SHARE_OF_ARCS: f64 = 0.03;

/// How wide and how fine an outline is drawn.
#[derive(Clone, Copy)]
pub(super) struct Nib {
    /// Half the pen's width, in the path's units.
    pub radius: f64,
    /// Pixels of one of the path's units, at most.
    pub scale: f64,
    /// In pixels.
    pub tolerance: f64,
}

impl Nib {
    /// How many steps keep both sides within the tolerance along a path of this length which turns by
    /// this angle, evenly.
    pub fn stops(&self, length: f64, turn: f64) -> f64 {
        let outer = (length + self.radius * turn) * self.scale;
        chord_count(outer, 0.125 * outer * turn, self.tolerance, AREA_SHARE)
    }

    /// How many steps do so along an arc of the pen's end.
    pub fn arc_stops(&self, turn: f64) -> f64 {
        let outer = self.radius * turn * self.scale;
        chord_count(outer, 0.125 * outer * turn, self.tolerance, AREA_SHARE_OF_ARCS)
    }

    /// Is a round join as good as the point in which its lines meet, so far from the corner along each?
    pub fn is_flat(&self, trim: f64) -> bool {
        // With the tangent t of half the turn, the point lies r (sqrt(1 + t^2) - 1) outside the arc, and between them
        // an area of r^2 (t - atan t).
        let (radius, trim) = (self.radius * self.scale, trim * self.scale);
        let (distance, area) = (0.5 * trim * trim / radius, trim * trim * trim / (3.0 * radius));
        distance <= self.tolerance && area <= AREA_SHARE_OF_ARCS * self.tolerance
    }
}
