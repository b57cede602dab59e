//! Takes comparisons, makes a page to look at: one HTML file that loads nothing.
//!
//! | module | takes → makes |
//! |---|---|
//! | `html` | comparisons → the page: the template, its style and script, and all figures as JSON |
//! | `image` | pictures and errors → PNG as text, for the page |
//! | [`plot`] | points → a plot as SVG, for the page and on its own |
//! | `machine` | this machine → what is said of it |

mod html;
mod image;
mod machine;
pub mod plot;

pub use html::Page;
pub use machine::Circumstances;
