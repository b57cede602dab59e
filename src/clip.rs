//! Takes a clip's members, makes for each pixel of a band whether it lies inside, outside, or partly.
//!
//! A clip is geometry, not a mask: where its border runs through a pixel it takes part in that
//! pixel's z-list as a formula over fragments, so a clip beside its complement leaves no seam.

use crate::bitmap::{for_runs, word_masks, Bitmap};
use crate::edges::BAND_ROWS;
use crate::pixel::resolve::Node;
use crate::sweep::Span;

/// One clip in one band.
#[derive(Clone)]
pub(crate) struct ClipBand {
    width: usize,
    /// Pixels wholly inside.
    pub full: Bitmap,
    /// Pixels partly inside, where `nodes` says how.
    pub part: Bitmap,
    nodes: Vec<u32>,
}

impl ClipBand {
    /// Nothing is inside.
    pub fn empty(width: usize) -> ClipBand {
        let bitmap = Bitmap::new(width, BAND_ROWS as usize);
        ClipBand { width, full: bitmap.clone(), part: bitmap, nodes: vec![0; width * BAND_ROWS as usize] }
    }

    /// Where in a partly covered pixel the clip is.
    pub fn node(&self, row: usize, x: usize) -> u32 {
        self.nodes[row * self.width + x]
    }

    /// Adds a span of a member, as far as it lies in the member's own clip.
    pub fn unite(&mut self, row: usize, span: Span, within: Option<&ClipBand>, nodes: &mut Vec<Node>) {
        clipped(row, span, within, nodes, |piece, nodes| match piece {
            Clipped::Whole(from, to) => {
                for (word, mask) in word_masks(from, to) {
                    self.full.row_mut(row)[word] |= mask;
                    self.part.row_mut(row)[word] &= !mask;
                }
            }
            Clipped::Part(x, node) => {
                let at = row * self.width + x;
                if self.part.get(row, x) {
                    nodes.push(Node::Or(self.nodes[at], node));
                    self.nodes[at] = nodes.len() as u32 - 1;
                } else if !self.full.get(row, x) {
                    self.part.set(row, x);
                    self.nodes[at] = node;
                }
            }
        });
    }

    /// Keeps what lies in the other as well.
    pub fn intersect(&mut self, other: &ClipBand, nodes: &mut Vec<Node>) {
        for row in 0..BAND_ROWS as usize {
            for word in 0..self.full.row(row).len() {
                let (full, part) = (self.full.row(row)[word], self.part.row(row)[word]);
                let (other_full, other_part) = (other.full.row(row)[word], other.part.row(row)[word]);
                for_runs(part & other_part, |a, b| {
                    for at in row * self.width + word * 64 + a..row * self.width + word * 64 + b {
                        nodes.push(Node::And(self.nodes[at], other.nodes[at]));
                        self.nodes[at] = nodes.len() as u32 - 1;
                    }
                });
                for_runs(full & other_part, |a, b| {
                    let range = row * self.width + word * 64 + a..row * self.width + word * 64 + b;
                    self.nodes[range.clone()].copy_from_slice(&other.nodes[range]);
                });
                self.full.row_mut(row)[word] = full & other_full;
                self.part.row_mut(row)[word] = (part & (other_full | other_part)) | (full & other_part);
            }
        }
    }
}

/// A span after clipping.
#[derive(Clone, Copy)]
pub(crate) enum Clipped {
    /// Pixels [from, to) as a whole.
    Whole(usize, usize),
    /// A part of one pixel.
    Part(usize, u32),
}

/// Clips a span of a row, and gives `take` what is left of it.
#[inline]
pub(crate) fn clipped(
    row: usize,
    span: Span,
    clip: Option<&ClipBand>,
    nodes: &mut Vec<Node>,
    mut take: impl FnMut(Clipped, &mut Vec<Node>),
) {
    let new_leaf = |fragment, nodes: &mut Vec<Node>| {
        nodes.push(Node::Leaf(fragment));
        nodes.len() as u32 - 1
    };
    match (span, clip) {
        (Span::Solid(from, to), None) => take(Clipped::Whole(from, to), nodes),
        (Span::Part(x, fragment), None) => {
            let leaf = new_leaf(fragment, nodes);
            take(Clipped::Part(x, leaf), nodes);
        }
        (Span::Solid(from, to), Some(clip)) => {
            for (word, mask) in word_masks(from, to) {
                for_runs(mask & clip.full.row(row)[word], |a, b| {
                    take(Clipped::Whole(word * 64 + a, word * 64 + b), nodes);
                });
                for_runs(mask & clip.part.row(row)[word], |a, b| {
                    for x in word * 64 + a..word * 64 + b {
                        take(Clipped::Part(x, clip.node(row, x)), nodes);
                    }
                });
            }
        }
        (Span::Part(x, fragment), Some(clip)) => {
            if clip.full.get(row, x) {
                let leaf = new_leaf(fragment, nodes);
                take(Clipped::Part(x, leaf), nodes);
            } else if clip.part.get(row, x) {
                let leaf = new_leaf(fragment, nodes);
                nodes.push(Node::And(leaf, clip.node(row, x)));
                take(Clipped::Part(x, nodes.len() as u32 - 1), nodes);
            }
        }
    }
}
