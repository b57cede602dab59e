//! Takes a drawing, makes the truth that methods are held against, and says how far that may itself be
//! off: the f64 slab sweep of [`crate::reference`], from the cache if it is there.

use super::cache::{Cache, DrawingHash};
use super::timing::milliseconds;
use crate::reference::{self, Stroker, Truth};
use crate::{Error, Viewport};
use serde::Serialize;
use std::time::{Duration, Instant};
use usvg::tiny_skia_path::PathSegment;

/// How many times coarser the truth is that the truth is held against.
const COARSER: f64 = 4.0;

/// A truth that took longer is not computed twice unless asked for.
const PATIENCE: Duration = Duration::from_secs(10);

/// A drawing with more curves than this has them cut more coarsely, to bound time and memory: 170,000
/// stroked ones (counted three times) at 1,024 pixels take 40 s and 3 GB at the usual tolerance, and
/// 30 s and 1.6 GB so.
const MANY_CURVES: usize = 250_000;

/// How many times coarser those are cut.
const BOUNDED: f64 = 4.0;

/// A truth and where it came from.
pub struct Standard {
    /// The picture.
    pub truth: Truth,
    /// What is said of it.
    pub about: About,
}

/// How the reference was made and how exact it is.
#[derive(Clone, Debug, Serialize)]
pub struct About {
    /// In words.
    pub how: &'static str,
    /// Farthest a flattened curve lies from the true one, in pixels.
    pub tolerance: f64,
    /// What that may shift one edge across a pixel by, from black to white, in levels.
    pub tolerance_levels: f64,
    /// How far the sum of a pixel's areas is from 1, at worst.
    pub area_defect: f64,
    /// Pixels with so many crossings that their areas are approximate.
    pub approximate_pixels: usize,
    /// Pixels that hold edges.
    pub edge_pixels: usize,
    /// Differences from the same truth computed otherwise, in levels.
    pub own_error: Vec<OwnError>,
    /// Mean error of the truth itself once it is rounded to 8 bits: no picture can better that by much.
    pub rounding_mean: f64,
    /// Its root mean square error.
    pub rounding_rms: f64,
    /// What of the drawing the truth leaves out, in the plural.
    pub leaves_out: Vec<&'static str>,
    /// Time to get it.
    pub ms: f64,
    /// It was kept from an earlier run.
    pub cached: bool,
}

/// How far the truth is from another computation of it.
#[derive(Clone, Debug, Serialize)]
pub struct OwnError {
    /// The other computation, in words.
    pub against: String,
    /// Mean over all channels, in levels.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

/// Where truths come from: one drawing, one cache.
pub struct Source<'a> {
    tree: &'a usvg::Tree,
    cache: Option<(&'a Cache, DrawingHash)>,
}

impl<'a> Source<'a> {
    /// Of this drawing; without a cache every truth is computed.
    pub fn new(bytes: &[u8], tree: &'a usvg::Tree, cache: Option<&'a Cache>) -> Source<'a> {
        Source { tree, cache: cache.map(|cache| (cache, DrawingHash::of(bytes, tree))) }
    }

    /// One truth, and whether it was kept from an earlier run.
    ///
    /// # Errors
    /// As [`reference::render`].
    pub fn truth(&self, viewport: &Viewport, options: &reference::Options) -> Result<(Truth, bool), Error> {
        let Some((cache, hash)) = &self.cache else {
            return Ok((reference::render(self.tree, viewport, options)?, false));
        };
        let key = hash.key(viewport, options);
        if let Some(truth) = cache.find(key, viewport.width, viewport.height) {
            return Ok((truth, true));
        }
        let truth = reference::render(self.tree, viewport, options)?;
        cache.keep(key, &truth);
        Ok((truth, false))
    }

    /// These options, or coarser ones if the drawing calls for it.
    fn bounded(&self, options: &reference::Options) -> reference::Options {
        let coarser = if curves(self.tree.root()) > MANY_CURVES { BOUNDED } else { 1.0 };
        reference::Options { tolerance: options.tolerance * coarser, ..options.clone() }
    }

    /// The truth and what is to be said of it. `thorough` holds it against a finer one too, and
    /// against one whose strokes are made another way.
    ///
    /// # Errors
    /// As [`reference::render`].
    pub fn standard(
        &self,
        viewport: &Viewport,
        options: &reference::Options,
        thorough: bool,
    ) -> Result<Standard, Error> {
        let options = &self.bounded(options);
        let start = Instant::now();
        let (truth, cached) = self.truth(viewport, options)?;
        let took = start.elapsed();
        let mut others = Vec::new();
        if cached || took < PATIENCE || thorough {
            let tolerance = options.tolerance * COARSER;
            others.push((tolerance, options.stroker, format!("curves cut at {tolerance} px")));
        }
        if thorough {
            let tolerance = options.tolerance / COARSER;
            others.push((tolerance, options.stroker, format!("curves cut at {tolerance} px")));
            others.push((options.tolerance, Stroker::Pieces, "strokes as unions of boxes and wedges".into()));
        }
        let mut own_error = Vec::new();
        for (tolerance, stroker, against) in others {
            let (other, _) =
                self.truth(viewport, &reference::Options { tolerance, stroker, ..options.clone() })?;
            let (mean, max) = difference(&truth, &other);
            own_error.push(OwnError { against, mean, max });
        }
        let rounding = truth.compare(&truth.to_pixmap());
        let about = About {
            how: "exact areas by a sweep over slabs in 64-bit floats, box filter, composited once for \
                  each set of shapes; shares no code with the methods",
            tolerance: options.tolerance,
            // The longest way across a pixel is its diagonal.
            tolerance_levels: options.tolerance * std::f64::consts::SQRT_2 * 255.0,
            area_defect: truth.area_defect,
            approximate_pixels: truth.approximate,
            edge_pixels: truth.swept,
            own_error,
            rounding_mean: rounding.mean,
            rounding_rms: rounding.rms,
            leaves_out: reference::unsupported(self.tree).into_iter().map(|u| u.kind).collect(),
            ms: milliseconds(start.elapsed()),
            cached,
        };
        Ok(Standard { truth, about })
    }
}

/// Curved segments to be flattened: those of a stroked path count twice more, for its two sides.
fn curves(group: &usvg::Group) -> usize {
    let node = |node: &usvg::Node| match node {
        usvg::Node::Group(group) => curves(group),
        usvg::Node::Text(text) => curves(text.flattened()),
        usvg::Node::Path(path) => {
            let curved = |s: &PathSegment| matches!(s, PathSegment::QuadTo(..) | PathSegment::CubicTo(..));
            let sides = usize::from(path.fill().is_some()) + 2 * usize::from(path.stroke().is_some());
            sides * path.data().segments().filter(curved).count()
        }
        usvg::Node::Image(_) => 0,
    };
    group.children().iter().map(node).sum()
}

/// Mean and largest difference of two truths' channels.
fn difference(a: &Truth, b: &Truth) -> (f64, f64) {
    let pixels = a.premultiplied().iter().zip(b.premultiplied());
    let channels = pixels.flat_map(|(a, b)| [0, 1, 2, 3].map(|c| (a[c] - b[c]).abs()));
    let (sum, max) = channels.fold((0.0, 0.0f64), |(sum, max), d| (sum + d, max.max(d)));
    (sum / (4.0 * a.premultiplied().len().max(1) as f64), max)
}
