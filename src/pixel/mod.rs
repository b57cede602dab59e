//! Takes a pixel's z-list, makes its colour.
//!
//! | module | takes → makes |
//! |---|---|
//! | [`fragment`] | one shape's cell → its fragment, with the exact area |
//! | [`certificate`] | a fragment's pieces → is its area a closed form? |
//! | [`crossings`] | pieces of two fragments → where they cross |
//! | [`cuts`] | pieces that meet → the parts between |
//! | [`indicator`] | a fragment that crosses itself → the border of what its rule fills |
//! | [`few`] | a few fragments whose borders do not touch → visible regions |
//! | [`boundary`] | fragments whose borders cross seldom or never → visible regions |
//! | [`split`] | several fragments → visible regions (Catmull's integrator) |
//! | [`sample`] | the same, bounded, where splitting would take too long |
//! | [`paint_tree`] | what lies over a region → its colour |
//! | [`resolve`] | z-list → regions by the cheapest exact way → colour |

pub(crate) mod boundary;
pub(crate) mod certificate;
pub(crate) mod crossings;
pub(crate) mod cuts;
pub(crate) mod few;
pub(crate) mod fragment;
pub(crate) mod indicator;
pub(crate) mod paint_tree;
pub(crate) mod resolve;
pub(crate) mod sample;
pub(crate) mod split;

#[cfg(test)]
mod tests;
