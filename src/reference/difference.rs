//! Takes an 8-bit picture and the true one, makes the measure of their difference.

use super::census::{edges_are_straight, has_gradients};
use super::truth::{straight, Truth};

/// How far an 8-bit picture is from the truth, in 8-bit levels.
///
/// Colours are compared as they are seen: times alpha. A picture of straight alpha may round its
/// colours for the true alpha or for its own rounded one; both are right roundings and neither errs
/// by more than half a level in its own terms, so the error of a colour channel is the smaller of
/// the premultiplied difference and of the straight difference times the true alpha. The alpha
/// channel is compared as it is, so an error of alpha does not hide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Mean over the four channels of all pixels.
    pub mean: f64,
    /// Root of the mean square over the four channels of all pixels.
    pub rms: f64,
    /// The largest of all.
    pub max: f64,
    /// Column and row of the pixel with the largest.
    pub worst: (u32, u32),
    /// Share of pixels whose worst channel is off by more than half a level.
    pub over_half: f64,
    /// Share of pixels whose worst channel is off by more than 1 level.
    pub over_1: f64,
    /// Share of pixels whose worst channel is off by more than 4 levels.
    pub over_4: f64,
    /// Share of pixels whose worst channel is off by more than 16 levels.
    pub over_16: f64,
}

impl Difference {
    /// Compares row by row; `picture` is straight RGBA, `truth` premultiplied levels.
    pub(super) fn between(
        width: u32,
        picture: impl Iterator<Item = [u8; 4]>,
        truth: &[[f64; 4]],
    ) -> Difference {
        let mut all = Difference::default();
        let (mut sum, mut squares) = (0.0, 0.0);
        for (at, (bytes, &levels)) in picture.zip(truth).enumerate() {
            let errors = channel_errors(bytes, levels);
            sum += errors.iter().sum::<f64>();
            squares += errors.iter().map(|e| e * e).sum::<f64>();
            let worst = errors.into_iter().fold(0.0, f64::max);
            if worst > all.max {
                all.max = worst;
                all.worst = (at as u32 % width, at as u32 / width);
            }
            // A millionth of a level of slack: an exact tie between two levels is not an error.
            let worst = worst - 1e-6;
            all.over_half += f64::from(worst > 0.5);
            all.over_1 += f64::from(worst > 1.0);
            all.over_4 += f64::from(worst > 4.0);
            all.over_16 += f64::from(worst > 16.0);
        }
        let pixels = truth.len().max(1) as f64;
        all.mean = sum / (4.0 * pixels);
        all.rms = (squares / (4.0 * pixels)).sqrt();
        for share in [&mut all.over_half, &mut all.over_1, &mut all.over_4, &mut all.over_16] {
            *share /= pixels;
        }
        all
    }
}

/// How far a picture may be from the truth and still be called exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The most that any channel may be off.
    pub max: f64,
    /// The most that the mean may be.
    pub mean: f64,
}

impl Bounds {
    /// .6 of a level where all edges are straight and all paint is flat, 1 level elsewhere, and a
    /// mean of .25. Half a level is rounding. A large area of one translucent colour may lie between
    /// two levels, so that no picture keeps that mean: then it may be what rounding leaves, and .01.
    pub fn of(tree: &usvg::Tree, truth: &Truth) -> Bounds {
        let floor = truth.compare(&truth.to_pixmap()).mean;
        let is_plain = edges_are_straight(tree) && !has_gradients(tree);
        Bounds { max: if is_plain { 0.6 } else { 1.0 }, mean: (floor + 0.01).max(0.25) }
    }

    /// Whether the difference stays within.
    pub fn hold(&self, difference: &Difference) -> bool {
        difference.max <= self.max && difference.mean <= self.mean
    }
}

/// The largest error of one pixel's channels.
pub(super) fn worst_channel(bytes: [u8; 4], truth: [f64; 4]) -> f64 {
    channel_errors(bytes, truth).into_iter().fold(0.0, f64::max)
}

/// The error of each channel of one pixel.
fn channel_errors(bytes: [u8; 4], truth: [f64; 4]) -> [f64; 4] {
    let (alpha, true_alpha) = (f64::from(bytes[3]), truth[3]);
    let true_straight = straight(truth);
    let colour = |c: usize| {
        let level = f64::from(bytes[c]);
        let seen = (level * alpha / 255.0 - truth[c]).abs();
        let stored = (level - true_straight[c]).abs() * true_alpha / 255.0;
        seen.min(stored)
    };
    [colour(0), colour(1), colour(2), (alpha - true_alpha).abs()]
}
