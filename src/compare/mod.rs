//! What each way of anti-aliasing gets wrong on a drawing, and what it costs in time.
//!
//! | module | takes → makes |
//! |---|---|
//! | `run` | a [`Subject`] and [`Options`] → a [`Comparison`]; the only file that knows the order |
//! | `standard` | drawing → the truth, and how exact it is itself |
//! | [`cache`] | truths → files and back |
//! | [`against`] | another renderer's PNG → a picture |
//! | `picture` | a picture → how it is seen on white |
//! | [`record`] | one method on one drawing: the JSON's fields; PSNR |
//! | `seams`, `spots` | errors → error where the truth is flat; where to look |
//! | `ssim`, `flip`, `filter` | two pictures → how alike they look |
//! | `timing` | clock readings → median, spread, ratios |
//! | `temporal` | a drawing in motion → change of light, flicker |
//! | `curves` | a method's number → error and time against it |
//! | [`report`] | comparisons → a page to look at |

pub mod against;
pub mod cache;
mod curves;
mod filter;
mod flip;
mod picture;
pub mod record;
pub mod report;
mod run;
mod seams;
mod spots;
mod ssim;
mod standard;
mod temporal;
mod timing;

pub use curves::{Curve, Point};
pub use record::Record;
pub use run::{compare, steps, Comparison};
pub use seams::Seams;
pub use spots::Spot;
pub use standard::{About, OwnError};
pub use temporal::Pan;
pub use timing::Spread;

use crate::{reference, usvg, Method, Pixmap, Scene, Settings, Viewport};
use cache::Cache;
use std::time::Duration;

/// A drawing to compare on, at a size.
pub struct Subject<'a> {
    /// As it is called in the report.
    pub name: String,
    /// Its bytes.
    pub bytes: &'a [u8],
    /// What usvg made of them.
    pub tree: &'a usvg::Tree,
    /// What we made of that.
    pub scene: &'a Scene,
    /// The part of the plane to render.
    pub viewport: Viewport,
    /// Time from the bytes to the scene.
    pub parse: Duration,
}

/// What is compared, and how long that may take.
#[derive(Clone, Debug)]
pub struct Options {
    /// The methods, in the order of the report.
    pub methods: Vec<Method>,
    /// Other renderers' pictures and what they are called.
    pub against: Vec<(String, Pixmap)>,
    /// Timed runs of each method, at least 1.
    pub runs: usize,
    /// Time for all runs of one method, and for one curve: a slow method has fewer runs.
    pub budget: Duration,
    /// Threads of each method; 0 is one a core.
    pub threads: usize,
    /// As [`Settings::tolerance`]; `None` for what suits each method ([`Method::tolerance`]).
    pub tolerance: Option<f64>,
    /// As [`Settings::linear`].
    pub linear: bool,
    /// As [`Settings::background`].
    pub background: Option<[u8; 4]>,
    /// Steps of a pan by one pixel; `None` for no pan.
    pub pan: Option<u32>,
    /// Make curves of error and time.
    pub curves: bool,
    /// Hold the truth against finer ones, too.
    pub check_reference: bool,
    /// Where truths are kept.
    pub cache: Option<Cache>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            methods: Method::ALL.to_vec(),
            against: Vec::new(),
            runs: 7,
            budget: Duration::from_secs(5),
            threads: 0,
            tolerance: None,
            linear: false,
            background: None,
            pan: None,
            curves: false,
            check_reference: false,
            cache: None,
        }
    }
}

impl Options {
    /// How a method renders.
    fn settings(&self, method: Method) -> Settings {
        let Options { linear, background, threads, .. } = *self;
        let tolerance = self.tolerance.unwrap_or(method.tolerance());
        Settings { tolerance, linear, background, threads, ..Settings::of(method) }
    }

    /// How the truth is made.
    fn reference(&self) -> reference::Options {
        let Options { linear, background, .. } = *self;
        reference::Options { linear, background, ..reference::Options::default() }
    }
}
