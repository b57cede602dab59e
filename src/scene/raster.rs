//! What of a drawing is not geometry: groups under filters, masks and blend modes, and patterns. They
//! are kept as scenes of their own, to be made into layers of pixels at a picture's scale
//! ([`crate::layers`]), or groups of the scene around them ([`super::unfold`]).

use super::paint::Paint;
use super::Scene;
use crate::texture;
use kurbo::{Affine, Rect};
use std::sync::Arc;
use usvg::filter::{Filter, Kind};

/// Paint that is a picture.
#[derive(Clone, Debug)]
pub(crate) struct Raster {
    pub source: Source,
    /// From the source's coordinates to the scene's user units.
    pub transform: Affine,
    /// All that it may paint, in the source's coordinates.
    pub bounds: Rect,
    pub opacity: f32,
}

impl Raster {
    /// Bytes of the images that it shows, but in masks, if all were its own.
    pub fn image_bytes(&self) -> usize {
        let of_scene = |scene: &Scene| -> usize {
            let rasters = scene.shapes.iter().filter_map(|shape| match &shape.paint {
                Paint::Raster(raster) => Some(raster.image_bytes()),
                _ => None,
            });
            rasters.sum()
        };
        match &self.source {
            Source::Image { image, .. } => image.bytes().len(),
            Source::Tiles(tile, _) => of_scene(tile),
            Source::Group(group) => of_scene(&group.content),
        }
    }

    /// How deep rasters lie in what it shows.
    pub fn depth_within(&self) -> usize {
        match &self.source {
            Source::Image { .. } => 0,
            Source::Tiles(tile, _) => tile.raster_depth(),
            Source::Group(group) => {
                let masks = std::iter::successors(group.mask.as_ref(), |mask| mask.within.as_deref());
                masks.map(|mask| mask.content.raster_depth()).fold(group.content.raster_depth(), usize::max)
            }
        }
    }
}

/// Where the pixels come from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Group(Box<RasterGroup>),
    /// An image, smooth or each of its pixels a square.
    Image {
        image: Arc<texture::Image>,
        nearest: bool,
    },
    /// A tile, its rectangle in the source's coordinates, repeated over the plane.
    Tiles(Box<Scene>, Rect),
}

/// A group whose pixels are worked on as pixels.
#[derive(Clone, Debug)]
pub(crate) struct RasterGroup {
    pub content: Scene,
    /// Applied first, one after the other.
    pub filters: Vec<Arc<Filter>>,
    /// What their feImages show, in the order of these.
    pub images: Vec<Arc<Scene>>,
    /// Without what the last filter puts before all else, which is the content as it is.
    pub without_front: bool,
    pub mask: Option<Mask>,
    /// How it meets what lies below it in its scene.
    pub blend_mode: usvg::BlendMode,
}

impl RasterGroup {
    /// What an feImage of its filters shows, which refers to this content.
    pub fn image(&self, content: &usvg::Group) -> Option<&Scene> {
        let mut images = image_contents(&self.filters).zip(&self.images);
        images.find(|(of, _)| std::ptr::eq(*of, content)).map(|(_, image)| &**image)
    }
}

/// What feImages of filters refer to.
pub(super) fn image_contents(filters: &[Arc<Filter>]) -> impl Iterator<Item = &usvg::Group> {
    let primitives = filters.iter().flat_map(|filter| filter.primitives());
    primitives.filter_map(|primitive| match primitive.kind() {
        Kind::Image(image) => Some(image.root()),
        _ => None,
    })
}

/// What shows of a group, in the group's own coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Mask {
    pub content: Scene,
    /// Nothing shows beyond.
    pub rect: Rect,
    pub kind: usvg::MaskType,
    /// A mask on the mask.
    pub within: Option<Box<Mask>>,
}
