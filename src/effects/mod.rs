//! What works on rasters rather than on shapes: filters, masks and blend modes. Nothing here runs
//! unless a scene calls for it, and nothing here knows of scenes: layers go in, layers come out.
//!
//! | module | takes → makes |
//! |---|---|
//! | `int_rect` | whole pixels → a rectangle of them |
//! | [`layer`] | pixels over a rectangle of the picture → [`layer::Layer`], sRGB-encoded or linear |
//! | `srgb` | one component in one encoding → the same in the other |
//! | [`blend`] | two premultiplied colours → one, by any of CSS's blend modes |
//! | [`mask`] | a layer → how much of another layer it lets through |
//! | [`filter`] | a layer + usvg's filters → the filtered layer |
//! | [`log`] | effects as they run → how often, how long, and what aliases of highlights |
//! | [`highlights`] | neighbouring normals + Phong's exponent → whether the highlight aliases, and one that does not |

pub(crate) mod blend;
pub(crate) mod filter;
pub(crate) mod highlights;
mod int_rect;
pub(crate) mod layer;
pub(crate) mod log;
pub(crate) mod mask;
pub(crate) mod srgb;
