//! Takes images, and groups and patterns that pixels may have to be made of, makes shapes that are painted with
//! them; their contents are scenes of their own.

use super::{affine, blends_inside, rect, Place, Walk};
use crate::scene::paint::Paint;
use crate::scene::raster::{image_contents, Mask, Raster, RasterGroup, Source};
use crate::scene::{Geometry, Outline, Scene, Shape, Warning};
use crate::{texture, Error};
use kurbo::{Affine, Rect};
use std::sync::Arc;

/// Filters and patterns within one another beyond this are refused: each holds a picture.
const DEEPEST_LAYER: usize = 32;

/// Filters, masks and patterns of a drawing, counted again wherever they are drawn.
const MOST_RASTERS: usize = 1 << 16;

/// Pixels of all images of a drawing: 512 MB.
const MOST_IMAGE_PIXELS: u64 = 1 << 27;

impl Walk {
    pub(super) fn image(&mut self, image: &usvg::Image, place: Place) -> Result<(), Error> {
        use usvg::ImageKind::{GIF, JPEG, PNG, SVG, WEBP};
        let bytes = match image.kind() {
            SVG(tree) => return self.drawing(tree.root(), place),
            JPEG(bytes) | PNG(bytes) | GIF(bytes) | WEBP(bytes) => bytes,
        };
        let Some(decoded) = self.decoded(bytes)? else {
            let id = self.last_id.clone();
            self.warn("images", if image.id().is_empty() { &id } else { image.id() });
            return Ok(());
        };
        let (width, height) = (decoded.rect().width() as f64, decoded.rect().height() as f64);
        let bounds = Rect::new(0.0, 0.0, width, height);
        let nearest = matches!(
            image.rendering_mode(),
            usvg::ImageRendering::OptimizeSpeed
                | usvg::ImageRendering::CrispEdges
                | usvg::ImageRendering::Pixelated
        );
        let source = Source::Image { image: decoded, nearest };
        let raster = Raster { source, transform: place.transform, bounds, opacity: 1.0 };
        let geometry = Geometry::of_rect(bounds, place.transform);
        let paint = Paint::Raster(Arc::new(raster));
        self.shapes.push(Shape { geometry, paint, clip: place.clip, group: place.group });
        Ok(())
    }

    /// A drawing that is an image: nothing in it blends with what lies below.
    fn drawing(&mut self, root: &usvg::Group, place: Place) -> Result<(), Error> {
        if !blends_inside(root) {
            return self.group(root, place);
        }
        let transform = place.transform * affine(root.transform());
        self.raster(root, Place { transform, ..place })
    }

    /// An image, decoded once however often it is drawn; `None` when its bytes are no image, or
    /// too large a one.
    fn decoded(&mut self, bytes: &Arc<Vec<u8>>) -> Result<Option<Arc<texture::Image>>, Error> {
        if let Some(known) = self.images.get(bytes) {
            return Ok(known.clone());
        }
        let image = self.shared.get(bytes);
        self.images.insert(bytes.clone(), image.clone());
        let all: u64 = self.images.values().flatten().map(|image| image.rect().area()).sum();
        match all > MOST_IMAGE_PIXELS {
            true => Err(Error::Limit(format!(
                "its images have more than {MOST_IMAGE_PIXELS} pixels in all (use smaller ones)"
            ))),
            false => Ok(image),
        }
    }

    /// A group that is made into pixels first.
    pub(super) fn raster(&mut self, group: &usvg::Group, place: Place) -> Result<(), Error> {
        let blends = usize::from(group.blend_mode() != usvg::BlendMode::Normal);
        let own = if group.mask().is_some() { 2 + blends } else { 1 };
        let depth = self.deeper(place.depth, own, group.id())?;
        let content = self.content(group, depth, !group.filters().is_empty())?;
        if content.shapes.is_empty() && group.filters().is_empty() {
            return Ok(());
        }
        let mask = group.mask().map(|mask| self.mask(mask, depth)).transpose()?;
        let images = self.filter_images(group.filters())?;
        let bounds = rect(group.layer_bounding_box());
        let source = Source::Group(Box::new(RasterGroup {
            content,
            filters: group.filters().to_vec(),
            images,
            without_front: false,
            mask,
            blend_mode: group.blend_mode(),
        }));
        let opacity = group.opacity().get();
        let raster = Raster { source, transform: place.transform, bounds, opacity };
        let geometry = Geometry { outline: Outline::Pixels, ..Geometry::of_rect(bounds, place.transform) };
        let paint = Paint::Raster(Arc::new(raster));
        self.shapes.push(Shape { geometry, paint, clip: place.clip, group: place.group });
        Ok(())
    }

    fn mask(&mut self, mask: &usvg::Mask, depth: usize) -> Result<Mask, Error> {
        let inner = match mask.mask() {
            Some(within) => Some((within, self.deeper(depth, 2, within.id())?)),
            None => None,
        };
        let content = self.content(mask.root(), inner.map_or(depth, |(_, depth)| depth), false)?;
        let within = inner.map(|(within, depth)| self.mask(within, depth)).transpose()?.map(Box::new);
        Ok(Mask { content, rect: rect(mask.rect()), kind: mask.kind(), within })
    }

    /// What the feImages of filters show, made once for each filter; warns of images in it that cannot be read.
    fn filter_images(&mut self, filters: &[Arc<usvg::filter::Filter>]) -> Result<Vec<Arc<Scene>>, Error> {
        let mut images = Vec::new();
        for filter in filters {
            for content in image_contents(std::slice::from_ref(filter)) {
                let key = std::ptr::from_ref(content) as usize;
                if let Some(known) = self.filter_images.get(&key) {
                    images.push(known.clone());
                    continue;
                }
                let warnings = std::mem::take(&mut self.warnings);
                let image = Arc::new(self.content(content, 0, true)?);
                let unread = std::mem::replace(&mut self.warnings, warnings);
                for Warning { kind, .. } in unread {
                    self.warn_of(kind, format!("the feImage of filter '{}'", filter.id()));
                }
                self.filter_images.insert(key, image.clone());
                images.push(image);
            }
        }
        Ok(images)
    }

    /// What a group holds, as a scene of its own, which may have to be a layer of pixels.
    pub(super) fn content(
        &mut self,
        group: &usvg::Group,
        depth: usize,
        is_layer: bool,
    ) -> Result<Scene, Error> {
        if is_layer && self.layers == DEEPEST_LAYER {
            return Err(Error::Limit(format!(
                "filters and patterns are nested more than {DEEPEST_LAYER} deep at {} (take out groups within groups that have the same effect)",
                self.name(group.id())
            )));
        }
        self.contents += 1;
        if self.contents > MOST_RASTERS {
            return Err(Error::Limit(format!(
                "it repeats filters, masks, blended groups and patterns too often: more than {MOST_RASTERS} of them at {} (flatten them)",
                self.name(group.id())
            )));
        }
        let (nesting, layers) = (self.nesting + 1, self.layers + usize::from(is_layer));
        let mut walk = Walk { nesting, layers, contents: self.contents, ..Walk::default() };
        walk.warnings = std::mem::take(&mut self.warnings);
        walk.images = std::mem::take(&mut self.images);
        walk.shared = self.shared.clone();
        walk.filter_images = std::mem::take(&mut self.filter_images);
        walk.before = self.before + self.shapes.len();
        walk.around = if group.id().is_empty() { self.around.clone() } else { group.id().to_string() };
        let place = Place { transform: Affine::IDENTITY, clip: None, group: 0, depth };
        let done = group.children().iter().try_for_each(|child| walk.node(child, place));
        self.warnings = std::mem::take(&mut walk.warnings);
        self.images = std::mem::take(&mut walk.images);
        self.filter_images = std::mem::take(&mut walk.filter_images);
        self.contents = walk.contents;
        done?;
        Ok(walk.into_scene())
    }
}
