//! Takes a scene and a viewport, makes the plan: what will run for the picture and what it costs, in
//! pixels, bytes and edges, found without running it.
//!
//! Promises: a layer of the plan is one that rendering makes, over the same pixels.

use crate::edges::EdgeList;
use crate::effects::filter::region::{regions, Canvas};
use crate::effects::filter::{held_pixels, passes, source_rect, Step};
use crate::effects::layer::{IntRect, Pixel};
use crate::layers::{copied_size, held_rect, over, place_of, tiles_to_draw};
use crate::methods::{painter, Painter};
use crate::polygons::Flattener;
use crate::render::rows_at_once;
use crate::scene::census::stands_for_a_layer;
use crate::scene::gradient_shader::{Demands, GradientShader};
use crate::scene::paint::Paint;
use crate::scene::raster::{Mask, Raster, RasterGroup, Source};
use crate::scene::{Geometry, Scene, Shape};
use crate::slabs::{Budget, Slabs};
use crate::{Error, Settings, Viewport};
use kurbo::{Affine, Vec2};
use serde::Serialize;

const BYTES_PER_PIXEL: u64 = std::mem::size_of::<Pixel>() as u64;

/// What rendering a scene at a size comes to.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Plan {
    /// Straight edges within the picture and its layers, once curves are chords and strokes outlines;
    /// those that turn out hidden are among them, though they are never made.
    pub edges: u64,
    /// In the order in which they are made; one within another stands behind it.
    pub layers: Vec<LayerPlan>,
    /// Bytes that layers take at once, at most, the work of filters among them.
    pub layer_bytes: u64,
    /// Bytes of the tables of colour maps, if every gradient turns within a pixel somewhere, and of those of
    /// their means over pixels, where they turn in each.
    pub color_map_bytes: u64,
    /// The picture is made band by band and is never in memory whole; layers are, up to 512 MB of them.
    pub streams: bool,
    /// Rows of the picture that are in memory at once.
    pub rows_at_once: u32,
    /// Why rendering will refuse, if it will.
    pub refused: Option<String>,
}

/// One layer of pixels.
#[derive(Clone, Debug, Serialize)]
pub struct LayerPlan {
    /// What it is for: `filter`, `mask`, `mix-blend-mode`, `isolation`, `pattern` or `image`; several
    /// with `+` between.
    pub what: String,
    /// The filter's id, where it has one.
    pub id: String,
    /// Layers around it.
    pub depth: usize,
    /// Columns and rows of the picture that it lies over.
    pub width: usize,
    /// See `width`.
    pub height: usize,
    /// What runs over its pixels, in order.
    pub passes: Vec<Pass>,
    /// Bytes that it and the work on it take at once, at most.
    pub bytes: u64,
}

/// One step of the work on a layer.
#[derive(Clone, Debug, Serialize)]
pub struct Pass {
    /// The primitive's name, or what is drawn.
    pub name: String,
    /// Columns and rows of its region.
    pub width: usize,
    /// See `width`.
    pub height: usize,
    /// A component transfer of noise, which [`Settings::index_aa`] averages over each pixel: at the price
    /// of the same noise once more, over one column and one row more.
    pub is_table_over_noise: bool,
}

impl Pass {
    /// Points at which there would be noise for [`Settings::index_aa`].
    pub fn noise_points(&self) -> u64 {
        match self.is_table_over_noise {
            true => (self.width as u64 + 1) * (self.height as u64 + 1),
            false => 0,
        }
    }
}

impl Plan {
    /// What rendering `scene` will come to.
    ///
    /// # Errors
    /// [`Error::Setting`] when the method has a number that it cannot have.
    pub fn of(scene: &Scene, viewport: &Viewport, settings: &Settings) -> Result<Plan, Error> {
        let streams = matches!(painter(settings.method, 1, 1)?, Painter::Bands(_));
        let rows_at_once = match streams {
            true => rows_at_once(settings.thread_count()).min(viewport.height),
            false => viewport.height,
        };
        let mut planner = Planner { settings, plan: Plan { streams, rows_at_once, ..Plan::default() } };
        planner.scene(scene, viewport, 0);
        let mut plan = planner.plan;
        let outer = || plan.layers.iter().filter(|layer| layer.depth == 0);
        let kept = |layer: &LayerPlan| (layer.width * layer.height) as u64;
        // The layers of a slab are kept until it is done; the work on one ends before the next.
        let work = outer().map(|layer| layer.bytes.saturating_sub(kept(layer) * BYTES_PER_PIXEL)).max();
        let unfolded = settings.method.composites_regions().then(|| scene.unfolded()).flatten();
        match Slabs::of(unfolded.as_ref().unwrap_or(scene), viewport, &Budget::default()) {
            Ok(slabs) => plan.layer_bytes = slabs.most_held() * BYTES_PER_PIXEL + work.unwrap_or(0),
            Err(why) => plan.refuse(why.to_string()),
        }
        if let (false, Err(why)) = (streams, scene.refuse_rasters(&settings.method.to_string())) {
            plan.refuse(why.to_string());
        }
        Ok(plan)
    }

    /// Pixels of all layers, each counted once.
    pub fn layer_pixels(&self) -> u64 {
        self.layers.iter().map(|layer| (layer.width * layer.height) as u64).sum()
    }

    fn refuse(&mut self, why: String) {
        self.refused.get_or_insert(why);
    }
}

/// Walks scenes within scenes.
struct Planner<'a> {
    settings: &'a Settings,
    plan: Plan,
}

impl Planner<'_> {
    /// Bytes that the scene's layers take at once, at most.
    fn scene(&mut self, scene: &Scene, viewport: &Viewport, depth: usize) -> u64 {
        // As rendering does: what is evaluated region by region needs no layer.
        let unfolded = self.settings.method.composites_regions().then(|| scene.unfolded()).flatten();
        let scene = unfolded.as_ref().unwrap_or(scene);
        let (mut kept, mut work) = (0, 0);
        let mut edges = EdgeList::new(viewport.width, viewport.height);
        let mut flattener = Flattener::default();
        let tolerance = self.settings.flattening_tolerance();
        let mut flatten = |geometry: &Geometry| {
            flattener.flatten(geometry, viewport.transform, tolerance, &mut edges);
            edges.take_banded().count() as u64
        };
        for shape in &scene.shapes {
            if !stands_for_a_layer(&shape.paint) {
                self.plan.edges += flatten(&shape.geometry);
            }
        }
        for member in scene.clips.iter().flat_map(|clip| &clip.members) {
            self.plan.edges += flatten(&member.geometry);
        }
        let demands = Demands::new(scene, self.settings);
        for (number, shape) in scene.shapes.iter().enumerate() {
            match &shape.paint {
                Paint::Raster(raster) => {
                    let (own, most) = self.layer(raster, (shape, number), viewport, depth);
                    kept += own;
                    work = work.max(most - own);
                }
                Paint::Gradient(gradient) => {
                    let shader = GradientShader::new(gradient, &shape.geometry, viewport, demands);
                    self.plan.color_map_bytes += shader.table_bytes();
                }
                Paint::Flat(_) | Paint::Layer(..) => {}
            }
        }
        kept + work
    }

    /// Bytes that are kept of a layer, and that are in use while it is made.
    fn layer(
        &mut self,
        raster: &Raster,
        (shape, number): (&Shape, usize),
        viewport: &Viewport,
        depth: usize,
    ) -> (u64, u64) {
        let (to_pixels, _) = place_of(raster, shape, viewport);
        let rect = held_rect(raster, shape, viewport);
        let own = rect.area() * BYTES_PER_PIXEL;
        let index = self.plan.layers.len();
        let (what, id, passes) = (String::new(), String::new(), Vec::new());
        let (width, height) = (rect.width(), rect.height());
        self.plan.layers.push(LayerPlan { what, id, depth, width, height, passes, bytes: own });
        let made = match &raster.source {
            Source::Group(group) => self.group(group, (to_pixels, rect), number, depth + 1),
            Source::Image { image, .. } => {
                let pass = pass("image", image.rect());
                Made { what: vec!["image"], passes: vec![pass], bytes: own, ..Made::default() }
            }
            Source::Tiles(tile, place) => self.tiles((tile, *place), to_pixels, rect, depth + 1),
        };
        let layer = &mut self.plan.layers[index];
        layer.what = made.what.join("+");
        layer.id = made.id;
        layer.passes = made.passes;
        layer.bytes = own.max(made.bytes);
        (own, layer.bytes)
    }

    /// The content of a layer, drawn over a rectangle: bytes of its pixels and of the layers within.
    fn content(&mut self, scene: &Scene, to_pixels: Affine, rect: IntRect, depth: usize) -> u64 {
        if rect.is_empty() || scene.shapes.is_empty() {
            return rect.area() * BYTES_PER_PIXEL;
        }
        // The picture in bytes, and the layer made of it.
        rect.area() * (4 + BYTES_PER_PIXEL) + self.scene(scene, &over(rect, to_pixels), depth)
    }

    fn group(
        &mut self,
        group: &RasterGroup,
        (to_pixels, rect): (Affine, IntRect),
        below: usize,
        depth: usize,
    ) -> Made {
        let mut made = Made::default();
        if group.filters.is_empty() {
            made.passes.push(pass("content", rect));
            made.bytes = self.content(&group.content, to_pixels, rect, depth);
        } else if let Some(canvas) = Canvas::new(to_pixels) {
            made.what.push("filter");
            made.id = group.filters[0].id().to_string();
            let shown = canvas.rect_of(rect);
            let regions = regions(&group.filters, canvas.to_canvas, shown, shown);
            let source = source_rect(&group.filters[0], regions[0], canvas.to_canvas);
            made.passes.push(pass("content", source));
            made.bytes = self.content(&group.content, canvas.to_canvas, source, depth);
            for (filter, &region) in group.filters.iter().zip(&regions) {
                let steps = passes(filter).into_iter();
                made.passes.extend(steps.map(|Step { name, is_table_over_noise }| Pass {
                    is_table_over_noise,
                    ..pass(name, region)
                }));
                made.bytes = made.bytes.max(held_pixels(filter, region) * BYTES_PER_PIXEL);
            }
            if let Err(why) = crate::effects::filter::affordable(&group.filters, &regions) {
                self.plan.refuse(why.to_string());
            }
        }
        let mut mask = group.mask.as_ref();
        while let Some(Mask { content, within, .. }) = mask {
            made.what.push("mask");
            made.passes.push(pass("mask", rect));
            let bytes = self.content(content, to_pixels, rect, depth);
            made.bytes = made.bytes.max(rect.area() * BYTES_PER_PIXEL + bytes);
            mask = within.as_deref();
        }
        if group.blend_mode != usvg::BlendMode::Normal {
            made.what.push("mix-blend-mode");
            made.passes.push(pass(&format!("backdrop of {below} shapes"), rect));
            made.bytes = made.bytes.max(2 * rect.area() * BYTES_PER_PIXEL);
        }
        if made.what.is_empty() {
            made.what.push("isolation");
        }
        made
    }

    fn tiles(
        &mut self,
        (tile, place): (&Scene, kurbo::Rect),
        to_pixels: Affine,
        rect: IntRect,
        depth: usize,
    ) -> Made {
        let mut made = Made { what: vec!["pattern"], ..Made::default() };
        if to_pixels.determinant() == 0.0 || !to_pixels.is_finite() || rect.is_empty() {
            return made;
        }
        match tiles_to_draw((tile, place), to_pixels, rect) {
            Some((columns, rows)) => {
                let count = (columns.end - columns.start) * (rows.end - rows.start);
                made.passes.push(pass(&format!("{count} tiles drawn"), rect));
                made.bytes = rect.area() * (4 + BYTES_PER_PIXEL);
                for row in rows.start as i64..rows.end as i64 {
                    for column in columns.start as i64..columns.end as i64 {
                        let by = Vec2::new(column as f64 * place.width(), row as f64 * place.height());
                        let viewport = over(rect, to_pixels * Affine::translate(by));
                        made.bytes += self.scene(tile, &viewport, depth);
                    }
                }
            }
            None => {
                let (width, height) = copied_size(place, to_pixels);
                let one = IntRect::new(0, 0, width as u32, height as u32);
                let to_tile = Affine::scale_non_uniform(width / place.width(), height / place.height())
                    * Affine::translate(-place.origin().to_vec2());
                made.passes.push(pass("one tile drawn", one));
                made.passes.push(pass("copied", rect));
                made.bytes = rect.area() * BYTES_PER_PIXEL + self.content(tile, to_tile, one, depth);
            }
        }
        made
    }
}

/// What is found of one layer.
#[derive(Default)]
struct Made {
    what: Vec<&'static str>,
    id: String,
    passes: Vec<Pass>,
    bytes: u64,
}

fn pass(name: &str, over: IntRect) -> Pass {
    let (width, height) = (over.width(), over.height());
    Pass { name: name.to_string(), width, height, is_table_over_noise: false }
}
