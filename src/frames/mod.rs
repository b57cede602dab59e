//! Frame sequences: a drawing that moves, or many drawings, to pictures in order.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`timeline`] | an animated SVG → the document at any time, its duration, what is not evaluated |
//! | [`list`] | the text of a frame list (`1-100x2`) → frame numbers |
//! | [`blur`] | pictures of moments within a frame → their mean |
//! | [`sequence`] | how to make one frame, how many → frames in order, on all threads, in bounded memory |

pub mod blur;
pub mod list;
pub mod sequence;
pub mod timeline;

pub use timeline::Timeline;
