//! Takes pixel rows, makes a file: [`PngWriter`] for PNG. Raw RGBA needs no encoder, the rows are it.
//!
//! Rows are those of [`crate::Renderer::render_bands`]: straight 8-bit RGBA from the top, without
//! padding. No encoder holds more than a few rows, so that a picture is never in memory whole.

mod filter;
mod png;

pub use png::{Effort, PngWriter};
