//! Takes a scene and a viewport, makes what its shapes are shaded with: gradients as they are, and a
//! layer of pixels for each group under a filter, a mask or a blend mode, each pattern and each image.
//!
//! A layer's content goes through the same renderer, at the picture's own pixels; the layer then is
//! the paint of a shape like any other. A scene of flat paint makes nothing here. Methods that composite
//! region by region are given masks and blend modes as groups ([`Scene::unfolded`]), and no layers for them.

use crate::effects::blend;
use crate::effects::filter::region::{regions, Canvas};
use crate::effects::filter::{self, Job};
use crate::effects::layer::{add_rgba8, between, IntRect, Layer, Pixel, Space, CLEAR};
use crate::effects::log::Log;
use crate::effects::mask;
use crate::outlines::Outlines;
use crate::scene::gradient_shader::GradientShader;
use crate::scene::paint::Paint;
use crate::scene::print::{self, Print};
use crate::scene::raster::{Mask, Raster, RasterGroup, Source};
use crate::scene::shader::Shader;
use crate::scene::{Clip, ClipMember, Geometry, Scene, Shape};
use crate::slabs::{Budget, Slab};
use crate::tiles::{self, TilePlan};
use crate::{texture, Error, Renderer, Settings, Viewport};
use kurbo::{Affine, Point, Rect, Vec2};
use std::ops::Range;
use std::sync::Arc;

/// Layers within one another, where masks and blend modes are layers too: each holds a picture.
const DEEPEST: usize = 32;

/// Tiles of a pattern that are drawn one by one, and the shapes in all of them; beyond, tiles are copies
/// of one tile's pixels.
const MOST_TILES: f64 = 1024.0;
const MOST_TILED_SHAPES: f64 = 16384.0;

/// A tile that is copied is made in no more pixels than this a side.
const LARGEST_TILE: f64 = 2048.0;

/// Pixels of the layers that are kept from one picture to the next: 512 MB.
const MOST_KEPT: u64 = 1 << 25;

/// Layers of the last picture, by what they were made from.
#[derive(Default)]
pub(crate) struct KeptLayers(Vec<KeptLayer>);

struct KeptLayer {
    print: Print,
    layer: Arc<Layer>,
    opaque: bool,
}

/// What is wanted of the layers where only some tiles are rendered.
pub(crate) struct Wanted<'a> {
    pub plan: &'a TilePlan,
    pub outlines: &'a Outlines<'a>,
    pub kept: &'a mut KeptLayers,
}

impl Wanted<'_> {
    /// Whether each shape's shader will be asked for.
    fn shapes(&self, scene: &Scene) -> Vec<bool> {
        let bounds = self.outlines.shapes.iter().map(|outline| outline.bounds);
        let mut wanted: Vec<bool> = bounds.map(|b| b.is_some_and(|b| self.plan.renders(b))).collect();
        // What blends looks at all that lies below it.
        let blends = |(shape, wanted): (&Shape, &bool)| *wanted && is_blend(&shape.paint);
        if let Some(last) = scene.shapes.iter().zip(&wanted).rposition(blends) {
            wanted[..last].fill(true);
        }
        wanted
    }
}

impl KeptLayers {
    fn find(&self, print: Print) -> Option<Shader<'static>> {
        let kept = self.0.iter().find(|kept| kept.print == print)?;
        Some(Shader::Layer { layer: kept.layer.clone(), by: (0, 0), opaque: kept.opaque })
    }

    /// Keeps a shader's layer. One tile that repeats is made again.
    fn keep(&mut self, print: Print, shader: Shader<'static>) -> Shader<'static> {
        if let Shader::Layer { layer, opaque, .. } = &shader {
            self.0.push(KeptLayer { print, layer: layer.clone(), opaque: *opaque });
        }
        shader
    }

    /// Keeps the layers of a new picture, and as many of those before as there is room for.
    fn take(&mut self, new: KeptLayers) {
        let old = std::mem::replace(self, new);
        let is_new = |print: Print| self.0.iter().any(|kept| kept.print == print);
        let mut old: Vec<_> = old.0.into_iter().filter(|kept| !is_new(kept.print)).collect();
        self.0.append(&mut old);
        let mut pixels = 0;
        self.0.retain(|kept| {
            pixels += kept.layer.rect().area();
            pixels <= MOST_KEPT
        });
    }
}

fn is_blend(paint: &Paint) -> bool {
    let Paint::Raster(raster) = paint else { return false };
    let Source::Group(group) = &raster.source else { return false };
    group.blend_mode != usvg::BlendMode::Normal
}

/// The shader of every shape, for a scene that calls for any ([`Scene::calls_for_effects`]), to shade the
/// bands of a slab; `log` is told what ran for them. Where only some are `wanted`, the others have none, and
/// layers that were made for the last picture are not made again.
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
    let artist = Artist { scene, viewport, settings, slab, budget, log };
    let mut shaders = Vec::with_capacity(scene.shapes.len());
    let shapes = wanted.as_ref().map(|wanted| wanted.shapes(scene));
    let mut kept = KeptLayers::default();
    for (number, shape) in scene.shapes.iter().enumerate() {
        let shader = match &shape.paint {
            Paint::Flat(_) => None,
            _ if shapes.as_ref().is_some_and(|wanted| !wanted[number]) => None,
            Paint::Gradient(gradient) => {
                let shader = GradientShader::new(gradient, &shape.geometry, viewport, settings.spot_scale);
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
    match &mut wanted {
        Some(wanted) if slab.is_whole => wanted.kept.take(kept),
        // There is no room for others.
        Some(wanted) => *wanted.kept = kept,
        None => {}
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
            *source = blend::own_color(mode, *source, behind);
        }
        Ok(())
    }

    fn tiles(&self, (tile, place): (&Scene, Rect), to_pixels: Affine, rect: IntRect) -> Result<Layer, Error> {
        if to_pixels.determinant() == 0.0 || !to_pixels.is_finite() || rect.is_empty() {
            return Ok(Layer::clear(rect, Space::Srgb));
        }
        match plane_of(tile, place, to_pixels, rect) {
            Some(plane) => self.draw(&plane, to_pixels, rect),
            None => self.copied((tile, place), to_pixels, rect),
        }
    }

    /// Copies of one tile's pixels, or its mean colour where it is smaller than a pixel.
    fn copied(
        &self,
        (tile, place): (&Scene, Rect),
        to_pixels: Affine,
        rect: IntRect,
    ) -> Result<Layer, Error> {
        let (width, height) = copied_size(place, to_pixels);
        let to_tile = Affine::scale_non_uniform(width / place.width(), height / place.height())
            * Affine::translate(-place.origin().to_vec2());
        let pixels = self.draw(tile, to_tile, IntRect::new(0, 0, width as u32, height as u32))?;
        let back = to_tile * to_pixels.inverse();
        let [ba, bb, bc, bd, ..] = back.as_coeffs();
        let is_tiny = ba.hypot(bb) >= width || bc.hypot(bd) >= height;
        let mean = mean_of(pixels.pixels());
        let mut layer = Layer::clear(rect, Space::Srgb);
        for (i, pixel) in layer.pixels_mut().iter_mut().enumerate() {
            let (column, row) = (i % rect.width(), i / rect.width());
            let at =
                Point::new(f64::from(rect.x()) + column as f64 + 0.5, f64::from(rect.y()) + row as f64 + 0.5);
            *pixel = if is_tiny { mean } else { wrapped(&pixels, back * at) };
        }
        Ok(layer)
    }
}

/// The pixels at the corner of `rect` after which a pattern repeats in whole pixels, as far as can be seen
/// in the rectangle; `None` where it does not, or not within it.
pub(crate) fn period(to_pixels: Affine, place: Rect, rect: IntRect) -> Option<IntRect> {
    /// A quarter of an 8-bit level, at an edge.
    const MOST_DRIFT: f64 = 1.0 / 1024.0;
    const MOST_TILES_A_SIDE: u32 = 24;
    let [a, b, c, d, ..] = to_pixels.as_coeffs();
    if b != 0.0 || c != 0.0 || rect.is_empty() {
        return None;
    }
    let side = |tile: f64, seen: usize| {
        let seen = seen as f64;
        let lengths = (1..=MOST_TILES_A_SIDE).map(|count| f64::from(count) * tile);
        let repeats = |length: &f64| {
            let off = (length - length.round()).abs();
            length.round() >= 1.0 && *length <= seen && off * (seen / length) < MOST_DRIFT
        };
        lengths.into_iter().find(repeats).map(|length| length.round() as u32)
    };
    let width = side(a.abs() * place.width(), rect.width())?;
    let height = side(d.abs() * place.height(), rect.height())?;
    Some(IntRect::new(rect.x(), rect.y(), width, height))
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

/// Columns and rows of the tiles that are seen, if there are few enough to be drawn one by one.
pub(crate) fn tiles_to_draw(
    (tile, place): (&Scene, Rect),
    to_pixels: Affine,
    rect: IntRect,
) -> Option<(Range<f64>, Range<f64>)> {
    if to_pixels.determinant() == 0.0 || !to_pixels.is_finite() {
        return None;
    }
    let seen = to_pixels.inverse().transform_rect_bbox(rect.to_rect());
    let columns =
        ((seen.x0 - place.x0) / place.width()).floor()..((seen.x1 - place.x0) / place.width()).ceil();
    let rows =
        ((seen.y0 - place.y0) / place.height()).floor()..((seen.y1 - place.y0) / place.height()).ceil();
    let count = (columns.end - columns.start) * (rows.end - rows.start);
    let shapes = (tile.shapes.len() as f64).max(1.0);
    // What lies within a tile's layers is made once, not once for each tile. Written so that no number
    // fails it.
    let is_affordable =
        count <= MOST_TILES && count * shapes <= MOST_TILED_SHAPES && tile.raster_depth() <= 1;
    is_affordable.then_some((columns, rows))
}

/// The tiles that are seen in a rectangle, one by one; `None` where they are too many.
fn plane_of(tile: &Scene, place: Rect, to_pixels: Affine, rect: IntRect) -> Option<Scene> {
    let (columns, rows) = tiles_to_draw((tile, place), to_pixels, rect)?;
    let mut plane = tile.with_shapes(Vec::new());
    plane.clips.clear();
    for row in rows.start as i64..rows.end as i64 {
        for column in columns.start as i64..columns.end as i64 {
            let by = Vec2::new(column as f64 * place.width(), row as f64 * place.height());
            add_tile(&mut plane, tile, place, by);
        }
    }
    Some(plane)
}

/// Width and height in pixels of a tile that is copied.
pub(crate) fn copied_size(place: Rect, to_pixels: Affine) -> (f64, f64) {
    let [a, b, c, d, ..] = to_pixels.as_coeffs();
    let side = |scale: f64, length: f64| (scale * length).ceil().clamp(1.0, LARGEST_TILE);
    (side(a.hypot(b), place.width()), side(c.hypot(d), place.height()))
}

/// Bilinear between the pixels of a tile that repeats.
fn wrapped(tile: &Layer, at: Point) -> Pixel {
    between(at.x - 0.5, at.y - 0.5, |x, y| {
        let column = x.rem_euclid(tile.rect().width() as i64);
        let row = y.rem_euclid(tile.rect().height() as i64);
        tile.pixel(column as i32, row as i32)
    })
}

fn mean_of(pixels: &[Pixel]) -> Pixel {
    let mut sums = [0.0f64; 4];
    for pixel in pixels {
        sums.iter_mut().zip(pixel).for_each(|(sum, &v)| *sum += f64::from(v));
    }
    match pixels.len() {
        0 => CLEAR,
        count => sums.map(|sum| (sum / count as f64) as f32),
    }
}

/// Adds a tile, moved, and clipped to its own place.
fn add_tile(plane: &mut Scene, tile: &Scene, place: Rect, by: Vec2) {
    let moved = Affine::translate(by);
    let window = plane.clips.len() as u32;
    let geometry = Geometry::of_rect(place, moved);
    plane.clips.push(Clip { members: vec![ClipMember { geometry, clip: None }], within: Vec::new() });
    let first = plane.clips.len() as u32;
    for clip in &tile.clips {
        let mut clip = clip.clone();
        for member in &mut clip.members {
            member.geometry.transform = moved * member.geometry.transform;
            member.clip = member.clip.map(|clip| clip + first);
        }
        clip.within.iter_mut().for_each(|within| *within += first);
        clip.within.push(window);
        plane.clips.push(clip);
    }
    for shape in &tile.shapes {
        let mut shape = shape.clone();
        shape.geometry.transform = moved * shape.geometry.transform;
        shape.clip = Some(shape.clip.map_or(window, |clip| clip + first));
        shape.paint.transform(moved);
        plane.shapes.push(shape);
    }
}
