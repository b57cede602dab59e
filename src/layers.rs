//! Takes a scene and a viewport, makes what its shapes are shaded with: gradients as they are, and a
//! layer of pixels for each group under a filter, a mask or a blend mode, each pattern and each image.
//!
//! A layer's content goes through the same renderer, at the picture's own pixels; the layer then is
//! the paint of a shape like any other. A scene of flat paint makes nothing here. Methods that composite
//! region by region are given masks and blend modes as groups ([`Scene::unfolded`]), and no layers for them.

mod kept;
mod pattern;

use crate::effects::blend;
use crate::effects::filter::region::{regions, Canvas};
use crate::effects::filter::{self, Job};
use crate::effects::layer::{add_rgba8, IntRect, Layer, Space};
use crate::effects::log::Log;
use crate::effects::mask;
use crate::scene::gradient_shader::{Demands, GradientShader};
use crate::scene::paint::Paint;
use crate::scene::print::{self, Print};
use crate::scene::raster::{Mask, Raster, RasterGroup, Source};
use crate::scene::shader::Shader;
use crate::scene::{Scene, Shape};
use crate::slabs::{Budget, Slab};
use crate::tiles;
use crate::{texture, Error, Renderer, Settings, Viewport};
use kurbo::{Affine, Vec2};
use std::sync::Arc;

pub(crate) use kept::{KeptLayers, Wanted};
pub(crate) use pattern::{copied_size, period, tiles_to_draw};

use pattern::plane_of;

/// Layers within one another, where masks and blend modes are layers too: each holds a picture.
const DEEPEST: usize = 32;

/// The shader of every shape, for a scene that calls for any ([`Scene::calls_for_effects`]), to shade the
/// bands of a slab, or no list if all paint is flat; `log` is told what ran for them. Where only some are `wanted`,
/// the others have none, and layers that were made for the last picture are not made again.
///
/// # Errors
/// [`Error::Limit`] when layers within one another lie too deep, or the work on one is beyond its bound.
pub(crate) fn shaders<'a>(
    scene: &'a Scene,
    viewport: &Viewport,
    settings: &Settings,
    (slab, budget): (&Slab, &Budget),
    log: &Log,
    mut wanted: Option<Wanted>,
) -> Result<Vec<Option<Shader<'a>>>, Error> {
    if !settings.method.composites_regions() && scene.raster_depth() > DEEPEST {
        return Err(Error::Limit(format!(
            "the method {} draws filters, masks, blended groups and patterns no more than {DEEPEST} deep within \
             one another: use another method",
            settings.method
        )));
    }
    let demands = Demands::new(scene, settings);
    let artist = Artist { scene, viewport, settings, slab, budget, log };
    let mut shaders = Vec::with_capacity(scene.shapes.len());
    let shapes = wanted.as_ref().map(|wanted| wanted.shapes(scene));
    let mut kept = KeptLayers::default();
    for (number, shape) in scene.shapes.iter().enumerate() {
        let shader = match &shape.paint {
            Paint::Flat(_) => None,
            _ if shapes.as_ref().is_some_and(|wanted| !wanted[number]) => None,
            Paint::Gradient(gradient) => {
                let shader = GradientShader::new(gradient, &shape.geometry, viewport, demands);
                Some(Shader::Gradient(Box::new(shader)))
            }
            Paint::Layer(layer, by) => {
                Some(Shader::Layer { layer: layer.clone(), by: *by, opaque: layer.is_opaque() })
            }
            Paint::Raster(raster) => Some(match &wanted {
                Some(wanted) if slab.is_whole && !is_blend(&shape.paint) => {
                    let print = artist.print(raster, shape);
                    match wanted.kept.find(print) {
                        Some(shader) => kept.keep(print, shader),
                        None => kept.keep(print, artist.raster(raster, shape, &shaders)?),
                    }
                }
                _ => artist.raster(raster, shape, &shaders)?,
            }),
        };
        shaders.push(shader);
    }
    if let Some(wanted) = &mut wanted {
        match slab.is_whole {
            true => wanted.kept.take(kept),
            // There is no room for others.
            false => *wanted.kept = KeptLayers::default(),
        }
    }
    if shaders.iter().all(Option::is_none) {
        // Nothing need ask for them.
        shaders.clear();
    }
    Ok(shaders)
}

/// What the drawing of a group's content is called where effects are timed.
const CONTENT: &str = "layer content";

/// Makes the layers of one scene.
struct Artist<'a> {
    scene: &'a Scene,
    viewport: &'a Viewport,
    settings: &'a Settings,
    slab: &'a Slab,
    budget: &'a Budget,
    log: &'a Log,
}

impl Artist<'_> {
    /// The shader of one shape; `before` has those of the shapes below it.
    fn raster(
        &self,
        raster: &Raster,
        shape: &Shape,
        before: &[Option<Shader>],
    ) -> Result<Shader<'static>, Error> {
        let (to_pixels, all) = place_of(raster, shape, self.viewport);
        let rect = all.intersect(self.slab.rect);
        let faded = |mut layer: Layer| {
            if raster.opacity < 1.0 {
                layer.pixels_mut().iter_mut().flatten().for_each(|v| *v *= raster.opacity);
            }
            layer
        };
        if let Source::Tiles(tile, place) = &raster.source {
            if let Some(period) = period(to_pixels, *place, rect) {
                if let Some(plane) = plane_of(tile, *place, to_pixels, period) {
                    self.budget.afford(period)?;
                    let drawn = self.log.run("pattern", || self.draw(&plane, to_pixels, period))?;
                    let layer = faded(drawn);
                    let opaque = layer.is_opaque();
                    return Ok(Shader::Tile { layer, opaque });
                }
            }
        }
        self.budget.afford(rect)?;
        let mut layer = match &raster.source {
            Source::Group(group) => self.group(group, to_pixels, (rect, all))?,
            Source::Image { image, nearest } => {
                self.log.run("image", || texture::drawn(image, to_pixels, rect, *nearest))
            }
            Source::Tiles(tile, place) => {
                self.log.run("pattern", || self.tiles((tile, *place), to_pixels, rect))?
            }
        };
        if let Source::Group(group) = &raster.source {
            let blend_mode = group.blend_mode;
            if blend_mode != usvg::BlendMode::Normal {
                self.log.run("mix-blend-mode", || self.blend(blend_mode, &mut layer, before))?;
            }
        }
        let layer = faded(layer);
        // Only what is opaque in its source has a chance to be so here.
        let opaque = match &raster.source {
            Source::Group(_) => false,
            // What its layer has beyond it is not painted.
            Source::Image { image, .. } => image.is_opaque() && raster.opacity >= 1.0,
            Source::Tiles(..) => layer.is_opaque(),
        };
        Ok(Shader::Layer { layer: Arc::new(layer), by: (0, 0), opaque })
    }

    /// Of all that a layer is made from, if it does not blend.
    fn print(&self, raster: &Raster, shape: &Shape) -> Print {
        let mut print = tiles::of_setup(self.viewport, self.settings);
        print.add_print(print::of_raster(raster));
        if matches!(raster.source, Source::Tiles(..)) {
            print.add_print(print::of_geometry(&shape.geometry));
        }
        print
    }

    /// Draws a scene over a rectangle of pixels. The time is that of the effect which asks for it.
    fn draw(&self, scene: &Scene, to_pixels: Affine, rect: IntRect) -> Result<Layer, Error> {
        if rect.is_empty() || scene.shapes.is_empty() {
            return Ok(Layer::clear(rect, Space::Srgb));
        }
        let viewport = over(rect, to_pixels);
        let settings = Settings { background: None, threads: 1, ..self.settings.clone() };
        let mut renderer = Renderer::for_layer(settings, self.budget.within())?;
        let mut pixels = Vec::with_capacity(rect.width() * rect.height());
        renderer.render_bands(scene, &viewport, |rows| {
            add_rgba8(&mut pixels, rows);
            Ok(())
        })?;
        self.log.absorb(&renderer.stages().effects, &renderer.stages().lit);
        Ok(Layer::new(rect, Space::Srgb, pixels))
    }

    /// A group over a rectangle, the slab's part of `all` that the picture shows of it.
    fn group(
        &self,
        group: &RasterGroup,
        to_pixels: Affine,
        (rect, all): (IntRect, IntRect),
    ) -> Result<Layer, Error> {
        let mut layer = match group.filters.is_empty() {
            true => self.log.run(CONTENT, || self.draw(&group.content, to_pixels, rect))?,
            false => self.filtered(group, to_pixels, (rect, all))?,
        };
        if let Some(mask) = &group.mask {
            self.log.run("mask", || {
                self.mask(mask, to_pixels, layer.rect()).map(|mask| mask.apply(&mut layer))
            })?;
        }
        Ok(layer)
    }

    fn filtered(
        &self,
        group: &RasterGroup,
        to_pixels: Affine,
        (rect, all): (IntRect, IntRect),
    ) -> Result<Layer, Error> {
        let Some(canvas) = Canvas::new(to_pixels) else {
            return Ok(Layer::clear(rect, Space::Srgb));
        };
        let (shown, all) = (canvas.rect_of(rect), canvas.rect_of(all));
        let regions = regions(&group.filters, canvas.to_canvas, shown, all);
        filter::affordable(&group.filters, &regions)?;
        let over = filter::source_rect(&group.filters[0], regions[0], canvas.to_canvas);
        let source = self.log.run(CONTENT, || self.draw(&group.content, canvas.to_canvas, over))?;
        let mut draw = |content: &usvg::Group, to_pixels: Affine, rect: IntRect| match group.image(content) {
            Some(image) => self.draw(image, to_pixels, rect),
            None => Ok(Layer::clear(rect, Space::Srgb)),
        };
        let mut job = Job {
            to_canvas: canvas.to_canvas,
            highlights: self.settings.highlights,
            without_front: group.without_front,
            index_aa: self.settings.index_aa,
            log: self.log,
            draw: &mut draw,
        };
        let layer = filter::apply(&group.filters, &regions, source, &mut job)?;
        Ok(canvas.shown(layer, rect))
    }

    fn mask(&self, mask: &Mask, to_pixels: Affine, rect: IntRect) -> Result<mask::Mask, Error> {
        let layer = self.draw(&mask.content, to_pixels, rect)?;
        let mut made = mask::Mask::of(layer, mask.kind.into());
        // Whose edges are smooth, as a clip's are.
        let window = self.draw(&Scene::of_rect(mask.rect), to_pixels, rect)?;
        made.intersect(&mask::Mask::of(window, mask::Kind::Alpha));
        if let Some(within) = &mask.within {
            made.intersect(&self.mask(within, to_pixels, rect)?);
        }
        Ok(made)
    }

    /// Gives each pixel the colour with which, painted over what lies below, it comes out as the blend
    /// of both.
    fn blend(
        &self,
        mode: usvg::BlendMode,
        layer: &mut Layer,
        before: &[Option<Shader>],
    ) -> Result<(), Error> {
        let rect = layer.rect();
        let mut below = self.scene.with_shapes(self.scene.shapes[..before.len()].to_vec());
        for (shape, shader) in below.shapes.iter_mut().zip(before) {
            if let Some(Shader::Layer { layer, by: (dx, dy), .. }) = shader {
                shape.paint = Paint::Layer(layer.clone(), (dx - rect.x(), dy - rect.y()));
            }
        }
        let mut backdrop = self.draw(&below, self.viewport.transform, rect)?;
        if let Some([r, g, b, a]) = self.settings.background {
            let behind = Layer::from_rgba8(IntRect::new(0, 0, 1, 1), &[r, g, b, a]).pixel(0, 0);
            for pixel in backdrop.pixels_mut() {
                *pixel = blend::over(*pixel, behind);
            }
        }
        for (source, &behind) in layer.pixels_mut().iter_mut().zip(backdrop.pixels()) {
            *source = blend::Source::new(mode, *source).own_color(behind);
        }
        Ok(())
    }
}

fn is_blend(paint: &Paint) -> bool {
    let Paint::Raster(raster) = paint else { return false };
    let Source::Group(group) = &raster.source else { return false };
    group.blend_mode != usvg::BlendMode::Normal
}

/// The viewport that shows a rectangle of pixels.
pub(crate) fn over(rect: IntRect, to_pixels: Affine) -> Viewport {
    let corner = Vec2::new(f64::from(rect.x()), f64::from(rect.y()));
    Viewport {
        width: rect.width() as u32,
        height: rect.height() as u32,
        transform: Affine::translate(-corner) * to_pixels,
    }
}

/// From a raster's coordinates to pixels, and the pixels that its layer lies over.
pub(crate) fn place_of(raster: &Raster, shape: &Shape, viewport: &Viewport) -> (Affine, IntRect) {
    let to_pixels = viewport.transform * raster.transform;
    let picture = IntRect::new(0, 0, viewport.width, viewport.height);
    let bounds = match raster.source {
        Source::Group(_) | Source::Image { .. } => to_pixels.transform_rect_bbox(raster.bounds),
        // A pattern is seen as far as its shape goes.
        Source::Tiles(..) => crate::outlines::bounds_in_pixels(&shape.geometry, viewport),
    };
    (to_pixels, IntRect::around(bounds).intersect(picture))
}

/// The pixels that are held for a raster: once what repeats in whole pixels, else as far as it is seen.
pub(crate) fn held_rect(raster: &Raster, shape: &Shape, viewport: &Viewport) -> IntRect {
    let (to_pixels, rect) = place_of(raster, shape, viewport);
    let Source::Tiles(tile, place) = &raster.source else { return rect };
    let once = period(to_pixels, *place, rect);
    once.filter(|&once| tiles_to_draw((tile, *place), to_pixels, once).is_some()).unwrap_or(rect)
}
