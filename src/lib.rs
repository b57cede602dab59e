//! Exact anti-aliasing of 2D vector cartoons.
//!
//! The journey from SVG to pixel is the module list, read downwards; calls go down it, never up.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`scene`] | SVG bytes → [`Scene`]: depth-ordered shapes, their paint, clips and groups |
//! | [`render`] | [`Scene`] + [`Viewport`] + [`Settings`] → pixel rows; the only file that knows the order of the stages |
//! | [`methods`] | which way of anti-aliasing → who paints |
//! | `layers` | filters, patterns, images, and for some methods masks and blend modes → layers of pixels that shapes are painted with; their content goes through [`render`] again |
//! | `slabs` | scene + viewport → the rows whose layers are held at once |
//! | [`plan`] | scene + viewport → what will run for it and what that costs, without running it |
//! | `effects` | layers of pixels → filtered, blended, masked ones |
//! | `texture` | an image at a scale → a layer |
//! | `outlines` | scene + viewport → outlines with bounds, sorted into bands; flattened when first needed |
//! | `tiles` | what each tile of a picture sees → which tiles another picture shows already |
//! | `pen`, `polygons`, `chords` | strokes → outlines; curves → chords |
//! | `edges` | polygons → edges in fixed point, sorted in y |
//! | `band` | the shapes that meet one band, front to back → its pixels, by the stages below |
//! | `coverage` | how fragments are kept: what the stages from `strips` to `pixel` are to a method |
//! | `strips` | edges → irregular pieces, clipped to scanline strips and filed in x-buckets |
//! | `sweep` | x-buckets → solid runs and fragments |
//! | `clip` | a clip's members → which pixels lie inside, outside or partly |
//! | `cel` | runs and fragments → what is seen of them, pixel by pixel |
//! | `zlist` | a pixel's entries, front to back → its colour where that is easy |
//! | `pixel` | a pixel's z-list → visible regions and their areas (Catmull's integrator) → colour |
//! | [`pixmap`] | rows of pixels → [`Pixmap`] |
//! | [`encode`] | rows of pixels → PNG; frames → APNG, GIF, Y4M, sprite sheets |
//! | [`frames`] | a drawing that moves → the document or the scene at any time, frames in order, what stands still made once |
//! | [`mod@reference`] | the same drawing computed another way, slowly: the truth the tests compare with |
//! | [`mod@compare`] | a drawing → what each method gets wrong on it, and what it costs; a page to look at |
//!
//! # Example
//!
//! ```
//! use toon_raster::{Options, Renderer, Scene, Settings, Viewport};
//!
//! # fn main() -> Result<(), toon_raster::Error> {
//! let svg = br##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 3 2">
//!     <path d="M0 0H1.5V2H0z" fill="#f80"/><path d="M3 0H1.5V2H3z" fill="#f80"/>
//! </svg>"##;
//! let scene = Scene::from_bytes(svg, &Options::default())?;
//! for warning in scene.warnings() {
//!     eprintln!("{} are not drawn: {}", warning.kind, warning.element);
//! }
//! let mut renderer = Renderer::new(Settings::default())?;
//! let picture = renderer.render(&scene, &Viewport::fit(&scene, 3, 2))?;
//! // Both halves of the middle pixel are orange, so it is orange: no seam.
//! assert_eq!(picture.pixel(1, 0), [255, 136, 0, 255]);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]
// The journey goes on in the private modules: `cargo doc --document-private-items` shows them.
#![allow(rustdoc::private_intra_doc_links)]
#![warn(missing_docs)]

pub mod scene;

pub mod render;

pub mod methods;

mod layers;

mod slabs;

pub mod plan;

mod effects;

mod texture;

mod outlines;

mod tiles;

mod pen;

mod polygons;

mod chords;

mod edges;

mod band;

mod coverage;

mod strips;

mod sweep;

mod clip;

mod cel;

mod zlist;

mod pixel;

pub mod pixmap;

pub mod encode;

pub mod frames;

pub mod error;

pub mod reference;

pub mod compare;

mod bitmap;

#[cfg(test)]
mod random;

pub use effects::highlights::Highlights;
pub use effects::log::{EffectRuns, LitSurface};
pub use error::Error;
pub use methods::Method;
pub use pixmap::Pixmap;
pub use plan::Plan;
pub use render::{Renderer, Settings, Stages, Viewport};
pub use scene::{Census, FontSource, Limits, Options, Scene, Warning};

/// The geometry types of the public interface ([`kurbo::Affine`] and friends).
pub use kurbo;
/// The SVG parser whose trees [`Scene::from_tree`] takes.
pub use usvg;

/// README's example compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
