//! Takes pixel rows or frames, makes a file: [`PngWriter`] for one picture, [`ApngWriter`],
//! [`GifWriter`], [`Y4mWriter`] and [`SheetWriter`] for many. Raw RGBA needs no encoder, the rows are it.
//!
//! Rows are those of [`crate::Renderer::render_bands`]: straight 8-bit RGBA from the top, without
//! padding. The PNG encoder holds no more than some rows, so that a picture is never in memory whole;
//! those of frames hold one or two frames.

mod apng;
mod changed;
mod filter;
mod gif;
pub(crate) mod packed;
mod palette;
pub(crate) mod png;
mod rate;
mod sheet;
mod y4m;

pub use apng::ApngWriter;
pub use gif::GifWriter;
pub use packed::Effort;
pub use png::PngWriter;
pub use rate::Rate;
pub use sheet::{Layout, SheetWriter};
pub use y4m::{Y4mWriter, Yuv};
