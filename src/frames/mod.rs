//! Frame sequences: a drawing that moves, or many drawings, to pictures in order.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`timeline`] | an animated SVG → the document at any time, its duration, what is not evaluated |
//! | [`list`] | the text of a frame list (`1-100x2`) → frame numbers |
//! | `split` | the text of a drawing → pieces that do not depend on each other |
//! | [`cels`] | drawings that have much in common → their scenes, what was there before not parsed again |
//! | [`blur`] | pictures of moments within a frame → their mean |
//! | [`gallery`] | pictures made lately → the same picture again, or what a new one can take over |
//! | [`packing`] | pictures → PNGs, of which parts that others had are not packed again |
//! | `shelf` | what was made for frames lately → the same again |
//! | [`sequence`] | how to make one frame, how many → frames in order, on all threads, in bounded memory |
//!
//! # Example
//!
//! ```
//! use toon_raster::{frames::Timeline, Options, Renderer, Scene, Settings, Viewport};
//!
//! # fn main() -> Result<(), toon_raster::Error> {
//! let svg = br##"<svg xmlns="http://www.w3.org/2000/svg" width="4" height="1">
//!     <rect width="1" height="1" fill="#f80"><animate attributeName="x" from="0" to="4" dur="2s"/></rect>
//! </svg>"##;
//! let timeline = Timeline::read(svg, &Options::default())?;
//! assert_eq!(timeline.length().seconds, 2.0);
//! let document = timeline.document_at(1.0);
//! let scene = Scene::from_bytes(document.as_bytes(), &Options::default())?;
//! let picture = Renderer::new(Settings::default())?.render(&scene, &Viewport::fit(&scene, 4, 1))?;
//! // Half way: the square has come to the third pixel.
//! assert_eq!([picture.pixel(1, 0)[3], picture.pixel(2, 0)[3]], [0, 255]);
//! # Ok(())
//! # }
//! ```

pub mod blur;
pub mod cels;
pub mod gallery;
pub mod list;
pub mod packing;
pub mod sequence;
mod shelf;
mod split;
pub mod timeline;

pub use timeline::Timeline;
