//! Takes a [`usvg::Tree`], makes its box-filtered picture by another road than the renderer's,
//! slowly: the truth that the tests compare with. It shares no code with the renderer.
//!
//! Every curve is flattened at a quarter of a thousandth of a pixel (less than .07 of a level). A pixel which holds edges is cut into slabs
//! in y, at every vertex and every crossing; inside a slab no two edges cross, so they have an order
//! in x, and the trapezoids between neighbours are exact cells of the pixel's arrangement. The set
//! of shapes that cover a cell (winding numbers under each fill rule) gives one colour by full
//! compositing: groups, clips and opacity included. The pixel is the average of its cells' colours
//! over their areas.
//!
//! ```text
//!   y=0 +-----+--------+       a slab lies between two dashed lines;
//!       |    /|        |       inside it every edge is straight and
//!   - - |- -/-+--- - - |- -    none cross, so the area between two
//!       |  /   \       |       neighbours is their distance at half
//!   - - |-/- - -\- - - |- -    height, times the slab's height.
//!       |/       \     |
//!   y=1 +---------\----+
//! ```
//!
//! Only pixels with edges are swept; shapes hidden in a pixel by an opaque one which covers it whole
//! are left out, and runs of pixels without edges are composited once. Where gradients are seen, the
//! composited colour is integrated over each cell, cut where a colour map turns or jumps ([`turns`]).
//! The tiles of a pattern are drawn one by one, clipped to the shape; a mask is a group, of which the
//! colour at each cell says how much shows. Filters are ignored, images of pixels are not drawn: see
//! [`unsupported`].
//!
//! [`rational`] is a second, smaller truth: polygons with small integer coordinates, in exact
//! fractions.

mod blend;
mod cell;
mod census;
mod clip;
mod difference;
mod drawing;
mod gradient;
mod outline;
mod paint;
mod pattern;
mod pieces;
mod polyline;
pub mod rational;
mod row;
mod stroke;
mod truth;
mod turns;

#[cfg(test)]
mod tests;

pub use census::{edges_are_straight, has_gradients, unsupported, Unsupported};
pub use difference::{Bounds, Difference};
pub use truth::Truth;

use crate::{Error, Viewport};
use drawing::Drawing;
use rayon::prelude::*;

/// A colour: red, green, blue times alpha, and alpha, each 0..=1, sRGB-encoded.
type Colour = [f64; 4];

/// How the truth is computed.
#[derive(Clone, Debug)]
pub struct Options {
    /// Farthest a flattened curve or a stroke's outline may lie from the true one, in output pixels.
    pub tolerance: f64,
    /// Areas of different colour in a pixel are mixed in linear light; opacity still composites in
    /// sRGB encoding.
    pub linear: bool,
    /// Painted behind everything, straight RGBA.
    pub background: Option<[u8; 4]>,
    /// Who makes the outlines of strokes.
    pub stroker: Stroker,
}

impl Default for Options {
    fn default() -> Self {
        Options { tolerance: 2.5e-4, linear: false, background: None, stroker: Stroker::Pieces }
    }
}

/// Who makes the outlines of strokes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stroker {
    /// [`kurbo::stroke`]: few edges. Round caps and joins are off by up to 3e-4 of their radius; where
    /// a curve turns tighter than half the stroke's width, what the pen sweeps on the way round is
    /// left out, as most renderers do.
    Kurbo,
    /// The union of a box a flattened segment and a wedge a turn: all that a pen held across the path
    /// sweeps, by construction; twice the time, more where many strokes overlap.
    #[default]
    Pieces,
}

/// The box-filtered, conflation-free picture of `tree`.
///
/// # Errors
/// [`Error::Size`] when the viewport is empty or its transform is not finite, [`Error::Setting`]
/// when the tolerance is not a positive number.
pub fn render(tree: &usvg::Tree, viewport: &Viewport, options: &Options) -> Result<Truth, Error> {
    if viewport.width == 0 || viewport.height == 0 || !viewport.transform.is_finite() {
        return Err(Error::Size("the reference needs a viewport with area and a finite transform".into()));
    }
    if !(options.tolerance > 0.0 && options.tolerance.is_finite()) {
        return Err(Error::Setting("the reference's tolerance must be a positive number".into()));
    }
    let drawing = Drawing::from_tree(tree, viewport, options);
    let rows = row::sort_into_rows(&drawing.segments, viewport.height as usize);
    let width = viewport.width as usize;
    let painted: Vec<row::PaintedRow> = (0..viewport.height as usize)
        .into_par_iter()
        .map_init(
            || row::RowPainter::new(&drawing, width, options),
            |painter, y| painter.paint(y, rows.segments(y)),
        )
        .collect();
    Ok(Truth::from_rows(viewport.width, viewport.height, painted))
}
