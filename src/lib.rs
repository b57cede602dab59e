//! Exact anti-aliasing of 2D vector cartoons.
//!
//! The journey from SVG to pixel is the module list, read downwards; calls go down it, never up.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`scene`] | SVG bytes → [`Scene`]: depth-ordered shapes, their paint, clips and groups |
//! | [`render`] | [`Scene`] + [`Viewport`] + [`Settings`] → pixel rows; the only file that knows the order of the stages |
//! | `outlines` | scene + viewport → outlines with bounds, sorted into bands; flattened when first needed |
//! | `pen`, `polygons` | strokes → outlines; curves → chords |
//! | `edges` | polygons → edges in fixed point, sorted in y |
//! | `band` | the shapes that meet one band, front to back → its pixels, by the stages below |
//! | `strips` | edges → irregular pieces, clipped to scanline strips and filed in x-buckets |
//! | `sweep` | x-buckets → solid runs and fragments |
//! | `clip` | a clip's members → which pixels lie inside, outside or partly |
//! | `cel` | runs and fragments → what is seen of them, pixel by pixel |
//! | `zlist` | a pixel's entries, front to back → its colour where that is easy |
//! | `pixel` | a pixel's z-list → visible regions and their areas (Catmull's integrator) → colour |
//! | [`pixmap`] | rows of pixels → [`Pixmap`] |
//! | [`encode`] | rows of pixels → PNG |
//! | [`mod@reference`] | the same drawing computed another way, slowly: the truth the tests compare with |
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod scene;

pub mod render;

mod outlines;

mod pen;

mod polygons;

mod edges;

mod band;

mod strips;

mod sweep;

mod clip;

mod cel;

mod zlist;

mod pixel;

pub mod pixmap;

pub mod encode;

pub mod error;
pub mod reference;

mod bitmap;

pub use error::Error;
pub use pixmap::Pixmap;
pub use render::{Method, Renderer, Settings, Stages, Viewport};
pub use scene::{FontSource, Limits, Options, Scene, Warning};

/// The geometry types of the public interface ([`kurbo::Affine`] and friends).
pub use kurbo;
/// The SVG parser whose trees [`Scene::from_tree`] takes.
pub use usvg;
