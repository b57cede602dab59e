//! How the part of a pixel that a shape covers is kept: as geometry, or as a set of samples.
//!
//! Everything before it (outlines, edges, bands) and beside it (cels, z-lists, clips, groups) is the
//! same for all methods. A [`Coverage`] takes one shape's edges, makes spans of whole pixels and
//! fragments, combines fragments where clips ask for it, and at last resolves a pixel's z-list.
//!
//! | implementation | a fragment is |
//! |---|---|
//! | [`crate::methods::exact`] | a list of irregular pieces with its exact area |
//! | [`crate::methods::mask`] | a set of samples, on a pattern that is the same in every pixel |
//! | [`crate::methods::sampled`] | a set of samples anywhere in the pixel |

use crate::band::Picture;
use crate::bitmap::Bitmap;
use crate::edges::Edge;
use crate::pixel::resolve::Surroundings;
use crate::scene::FillRule;
use crate::zlist::{Entry, Head};

/// Stands in a z-list for where in a pixel something is painted.
pub(crate) trait Part: Copy + PartialEq + Send + Sync {
    /// All of the pixel.
    const WHOLE: Self;
}

/// By number, in some list.
impl Part for u32 {
    const WHOLE: u32 = u32::MAX;
}

/// The parts of one band.
pub(crate) trait Parts {
    /// What a shape covers of a pixel, as it is found.
    type Fragment: Copy;
    /// The same as it is kept, or several of them combined.
    type Part: Part;

    /// Keeps a fragment.
    fn keep(&mut self, fragment: Self::Fragment) -> Self::Part;

    /// What lies in both.
    fn both(&mut self, a: Self::Part, b: Self::Part) -> Self::Part;

    /// What lies in one of them or in both. `a` may be the union of many.
    fn either(&mut self, a: Self::Part, b: Self::Part) -> Self::Part;
}

/// The parts of a method.
pub(crate) type PartOf<C> = <<C as Coverage>::Parts as Parts>::Part;

/// Takes what a row of a shape consists of, from left to right.
pub(crate) trait TakeSpans<A: Parts> {
    /// Pixels [from, to) lie inside.
    fn solid(&mut self, from: usize, to: usize, parts: &mut A);

    /// A part of pixel `x` does.
    fn part(&mut self, x: usize, fragment: A::Fragment, parts: &mut A);
}

/// How a shape is filled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    pub rule: FillRule,
    /// Not anti-aliased: a pixel is inside if its centre is.
    pub crisp: bool,
}

/// Where in the picture a band lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BandPlace {
    /// Its first row.
    pub top: u32,
    /// Rows, which may be fewer than a band has.
    pub count: usize,
}

/// A way to keep fragments, with the stages that depend on it. Each thread has its own.
pub(crate) trait Coverage: Send {
    type Parts: Parts;

    /// Forgets the last band.
    fn start(&mut self, picture: &Picture);

    fn parts(&mut self) -> &mut Self::Parts;

    /// Files one edge of the shape at hand. What it does in pixels that are `finished` is not asked for.
    fn add(&mut self, edge: &Edge, place: BandPlace, style: Style, finished: &Bitmap);

    /// Gives `take` the spans of the shape at hand in one row, from left to right, and forgets what was
    /// filed there. The shape lies within columns [from, to).
    fn row(
        &mut self,
        row: usize,
        columns: (usize, usize),
        place: BandPlace,
        style: Style,
        take: &mut impl TakeSpans<Self::Parts>,
    );

    /// The colour of the pixel at column `x` and row `y` of the picture: straight, 8-bit. Its entries are of no
    /// use then.
    fn resolve(
        &mut self,
        head: Head,
        entries: &mut [Entry<PartOf<Self>>],
        at: (u32, u32),
        around: &Surroundings,
    ) -> [u8; 4];

    /// Counter name and value since this was last asked, always the same names in the same order.
    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}
