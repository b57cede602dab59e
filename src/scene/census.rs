//! Takes a parsed scene, makes the census of what it calls for: one pass over its shapes, and over those
//! within its layers.
//!
//! What the census does not name is not set up: a scene that calls for no effect never reaches
//! [`crate::layers`], and whatever is 0 here has no code run for it.

use super::paint::{GradientShape, Paint};
use super::raster::{Mask, Raster, RasterGroup, Source};
use super::{Clip, Geometry, Role, Scene};
use crate::Error;
use serde::Serialize;
use usvg::filter::{Kind, Primitive};
use usvg::tiny_skia_path::PathSegment;

/// How much a scene calls for of everything. How many layers of pixels that takes depends on the method:
/// see [`crate::Plan`]. A mask, pattern or filtered group counts with all that is
/// drawn within it; what is drawn several times over (a clip's members, a pattern's tile) counts once for
/// each place in the drawing that asks for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Census {
    /// Fills and strokes.
    pub shapes: usize,
    /// Lines and curves of their paths and of clips, before curves become chords and strokes outlines.
    pub segments: usize,
    /// Shapes and layers that let light through: a colour, a stop or the whole of it is translucent, or
    /// a radial gradient does not cover the plane.
    pub opacity: usize,
    /// Groups whose shapes composite as one before they fade.
    pub groups: usize,
    /// Clip paths.
    pub clips: usize,
    /// Masks, those on masks too.
    pub masks: usize,
    /// Shapes painted with a linear gradient.
    pub linear_gradients: usize,
    /// Shapes painted with a radial gradient.
    pub radial_gradients: usize,
    /// Shapes painted with a pattern.
    pub patterns: usize,
    /// Images of pixels; images of SVG count as the shapes they hold.
    pub images: usize,
    /// Filters, each a chain of primitives.
    pub filters: usize,
    /// Specular highlights (feSpecularLighting).
    pub highlights: usize,
    /// Texts that became shapes.
    pub text: usize,
    /// Groups that blend with what lies below them in another way than `normal`.
    pub blend_modes: usize,
}

impl Census {
    /// Does any code beyond flat shapes run?
    pub fn is_flat(&self) -> bool {
        let Census { shapes, segments, text, .. } = *self;
        *self == Census { shapes, segments, text, ..Census::default() }
    }

    fn add(&mut self, scene: &Scene) -> Result<(), Error> {
        // The first group is the picture.
        self.groups += scene.groups.len() - 1;
        self.clips += scene.clips.len();
        self.text += scene.texts;
        let members = scene.clips.iter().flat_map(|Clip { members, .. }| members);
        self.segments += members.map(|member| segments(&member.geometry)).sum::<usize>();
        for shape in &scene.shapes {
            match &shape.paint {
                Paint::Flat(sheet) => self.opacity += usize::from(!sheet.is_opaque()),
                Paint::Gradient(gradient) => {
                    self.opacity += usize::from(!shape.paint.is_opaque());
                    match gradient.shape {
                        GradientShape::Linear(_) => self.linear_gradients += 1,
                        GradientShape::Radial { .. } => self.radial_gradients += 1,
                    }
                }
                Paint::Raster(raster) => self.add_raster(raster)?,
                Paint::Layer(..) => {}
            }
            if !stands_for_a_layer(&shape.paint) {
                self.shapes += 1;
                self.segments += segments(&shape.geometry);
            }
        }
        Ok(())
    }

    fn add_raster(&mut self, raster: &Raster) -> Result<(), Error> {
        self.opacity += usize::from(raster.opacity < 1.0);
        match &raster.source {
            Source::Image { .. } => self.images += 1,
            Source::Tiles(tile, _) => {
                self.patterns += 1;
                self.add(tile)?;
            }
            Source::Group(group) => {
                let RasterGroup { content, filters, images, mask, blend_mode, .. } = &**group;
                self.blend_modes += usize::from(*blend_mode != usvg::BlendMode::Normal);
                self.filters += filters.len();
                let primitives = filters.iter().flat_map(|filter| filter.primitives());
                let is_highlight = |p: &&Primitive| matches!(p.kind(), Kind::SpecularLighting(_));
                self.highlights += primitives.filter(is_highlight).count();
                images.iter().try_for_each(|image| self.add(image))?;
                let mut next = mask.as_ref();
                while let Some(Mask { content, within, .. }) = next {
                    self.masks += 1;
                    self.add(content)?;
                    next = within.as_deref();
                }
                self.add(content)?;
            }
        }
        Ok(())
    }
}

impl Scene {
    /// What the scene calls for.
    ///
    /// # Errors
    /// [`Error::Limit`] when what an feImage shows is nested too deep, as rendering would find.
    pub fn census(&self) -> Result<Census, Error> {
        let mut census = Census::default();
        census.add(self)?;
        Ok(census)
    }

    /// Is anything painted with other than one colour, masked or blended? If not, no shader, layer or table
    /// is made, and nothing of effects runs.
    pub(crate) fn calls_for_effects(&self) -> bool {
        self.shapes.iter().any(|shape| !matches!(shape.paint, Paint::Flat(_)))
            || self.groups.iter().any(|group| group.role != Role::Paint)
    }
}

/// Is a shape only the place where a group or an image is painted?
pub(crate) fn stands_for_a_layer(paint: &Paint) -> bool {
    match paint {
        Paint::Raster(raster) => matches!(raster.source, Source::Group(_) | Source::Image { .. }),
        Paint::Layer(..) => true,
        Paint::Flat(_) | Paint::Gradient(_) => false,
    }
}

fn segments(geometry: &Geometry) -> usize {
    geometry.path.segments().filter(|segment| !matches!(segment, PathSegment::MoveTo(_))).count()
}
