//! Takes a layer and usvg's filters, makes the filtered layer: runs each primitive on the results of
//! others, in the space it asks for, and cuts it to its subregion (SVG 1.1, 15; Filter Effects 1).
//!
//! | module | primitives |
//! |---|---|
//! | [`region`] | over which pixels filters have to be run |
//! | `blur` | feGaussianBlur, and feDropShadow's |
//! | `color` | feColorMatrix, feComponentTransfer |
//! | `combine` | feBlend, feComposite, feMerge |
//! | `convolve` | feConvolveMatrix |
//! | `displace` | feDisplacementMap, feTile |
//! | `flow` | which results each primitive looks at, and at which of their pixels |
//! | `light` | feDiffuseLighting, feSpecularLighting |
//! | `morphology` | feMorphology |
//! | [`pointwise`] | filters that need no pixels, or not for what they filter |
//! | `turbulence` | feTurbulence |
//! | `lines` | rows and columns for what works along one axis |
//!
//! To run a group's filters: [`region::Canvas::new`] of its transform; [`region::regions`] for the
//! canvas's part that the picture shows; [`affordable`]; draw the group's content under `to_canvas`
//! over [`source_rect`]; [`apply`]; [`region::Canvas::shown`]. Primitives whose results nobody looks
//! at are not run, and a result lasts until the last one that looks at it, which works in its place.

mod blur;
mod color;
mod combine;
mod convolve;
mod displace;
mod flow;
pub(super) mod light;
mod lines;
mod morphology;
pub(crate) mod pointwise;
pub(crate) mod region;
mod turbulence;

#[cfg(test)]
mod tests;

use crate::effects::highlights::Highlights;
use crate::effects::layer::{pixel_of, IntRect, Layer, Pixel, Space};
use crate::effects::log::Log;
use crate::Error;
use flow::{moves_freely, Flow, Needed, Origin, Uses};
use kurbo::{Affine, Rect};
use region::{pixels_of, scales, LAST_BITS};
use std::rc::Rc;
use std::sync::Arc;
use usvg::filter::{DropShadow, Filter, Image, Kind, Merge, Primitive};

/// Draws what an feImage refers to: the group, the transform from its coordinates to pixels, and the
/// pixels to draw over.
pub(crate) type DrawContent<'a> = dyn FnMut(&usvg::Group, Affine, IntRect) -> Result<Layer, Error> + 'a;

/// What filters of one group have in common.
pub(crate) struct Job<'a> {
    /// From the group's user units to the canvas ([`region::Canvas::to_canvas`]).
    pub to_canvas: Affine,
    pub highlights: Highlights,
    /// Leave out what [`pointwise::has_source_in_front`] tells of: it is painted otherwise.
    pub without_front: bool,
    /// Tables over noise are averaged over a pixel ([`crate::Settings::index_aa`]).
    pub index_aa: bool,
    /// What runs, and what aliases of the highlights, is noted in it.
    pub log: &'a Log,
    pub draw: &'a mut DrawContent<'a>,
}

/// Pixels of all results that are held at once: 2 GB.
const MOST_PIXELS_HELD: u64 = 1 << 27;

/// Runs a chain of filters, each over the region that [`region::regions`] gave it. The result is
/// sRGB-encoded and lies over the last region.
///
/// # Errors
/// [`Error::Limit`] when a filter would hold or compute too much; and what `draw` returns.
pub(crate) fn apply(
    filters: &[Arc<Filter>],
    regions: &[IntRect],
    mut layer: Layer,
    job: &mut Job,
) -> Result<Layer, Error> {
    affordable(filters, regions)?;
    for (filter, &region) in filters.iter().zip(regions) {
        layer = Run::new(filter, region, layer, job.to_canvas).run(job)?;
    }
    Ok(layer.into_space(Space::Srgb))
}

/// Can these filters be run over these regions? To be asked before the source is drawn.
///
/// # Errors
/// [`Error::Limit`] when a filter would hold too many pixels.
pub(crate) fn affordable(filters: &[Arc<Filter>], regions: &[IntRect]) -> Result<(), Error> {
    for (filter, region) in filters.iter().zip(regions) {
        let held = held_pixels(filter, *region);
        if held > MOST_PIXELS_HELD {
            return Err(Error::Limit(format!(
                "the filter '{}' has to hold {held} pixels at once, more than {MOST_PIXELS_HELD} \
                 (give it a smaller region, or draw a smaller picture)",
                filter.id()
            )));
        }
    }
    Ok(())
}

/// Pixels that a filter holds at once, at most.
pub(crate) fn held_pixels(filter: &Filter, region: IntRect) -> u64 {
    region.area().saturating_mul(Flow::of(filter.primitives()).most_layers() as u64)
}

/// The pixels of its source that a filter looks at when it is run over a region.
pub(crate) fn source_rect(filter: &Filter, region: IntRect, to_canvas: Affine) -> IntRect {
    let primitives = filter.primitives();
    let flow = Flow::of(primitives);
    flow.needed(primitives, &flow.subregions(filter, to_canvas), region, to_canvas).source
}

/// A primitive that is run.
pub(crate) struct Step {
    pub name: &'static str,
    /// It is a component transfer of noise: what index anti-aliasing averages.
    pub is_table_over_noise: bool,
}

/// The primitives of a filter that are run, in order.
pub(crate) fn passes(filter: &Filter) -> Vec<Step> {
    let primitives = filter.primitives();
    let flow = Flow::of(primitives);
    let is_run = |number: &usize| flow.calls_for(*number);
    let step = |number: usize| {
        let kind = primitives[number].kind();
        let is_table = matches!(kind, Kind::ComponentTransfer(_));
        let is_table_over_noise = is_table && way_to_noise(primitives, &flow, number).is_some();
        Step { name: name(kind), is_table_over_noise }
    };
    (0..primitives.len()).filter(is_run).map(step).collect()
}

/// The primitives that a primitive's input goes back through to noise, if there are none but colour matrices between:
/// the nearest first, feTurbulence last.
fn way_to_noise(primitives: &[Primitive], flow: &Flow, number: usize) -> Option<Vec<usize>> {
    let (mut way, mut at) = (Vec::new(), number);
    loop {
        let &[Origin::Result(of)] = flow.inputs(at) else { return None };
        way.push(of);
        match primitives[of].kind() {
            Kind::ColorMatrix(_) => at = of,
            Kind::Turbulence(_) => return Some(way),
            _ => return None,
        }
    }
}

/// What SVG calls a primitive.
fn name(kind: &Kind) -> &'static str {
    match kind {
        Kind::Blend(_) => "feBlend",
        Kind::ColorMatrix(_) => "feColorMatrix",
        Kind::ComponentTransfer(_) => "feComponentTransfer",
        Kind::Composite(_) => "feComposite",
        Kind::ConvolveMatrix(_) => "feConvolveMatrix",
        Kind::DiffuseLighting(_) => "feDiffuseLighting",
        Kind::DisplacementMap(_) => "feDisplacementMap",
        Kind::DropShadow(_) => "feDropShadow",
        Kind::Flood(_) => "feFlood",
        Kind::GaussianBlur(_) => "feGaussianBlur",
        Kind::Image(_) => "feImage",
        Kind::Merge(_) => "feMerge",
        Kind::Morphology(_) => "feMorphology",
        Kind::Offset(_) => "feOffset",
        Kind::SpecularLighting(_) => "feSpecularLighting",
        Kind::Tile(_) => "feTile",
        Kind::Turbulence(_) => "feTurbulence",
    }
}

/// One filter at work.
struct Run<'a> {
    filter: &'a Filter,
    region: IntRect,
    flow: Flow,
    subregions: Vec<IntRect>,
    needed: Needed,
    uses: Uses,
    /// While somebody still looks at it, as all of these.
    source: Option<Rc<Layer>>,
    source_alpha: Option<Rc<Layer>>,
    results: Vec<Option<Rc<Layer>>>,
}

impl<'a> Run<'a> {
    fn new(filter: &'a Filter, region: IntRect, source: Layer, to_canvas: Affine) -> Run<'a> {
        let primitives = filter.primitives();
        let flow = Flow::of(primitives);
        let subregions = flow.subregions(filter, to_canvas);
        let needed = flow.needed(primitives, &subregions, region, to_canvas);
        Run {
            filter,
            region,
            uses: flow.uses(),
            source: Some(Rc::new(source.into_rect(needed.source))),
            source_alpha: None,
            results: vec![None; primitives.len()],
            flow,
            subregions,
            needed,
        }
    }

    fn run(mut self, job: &mut Job) -> Result<Layer, Error> {
        let filter = self.filter;
        if self.region.is_empty() {
            return Ok(Layer::clear(IntRect::EMPTY, Space::Srgb));
        }
        for (number, primitive) in filter.primitives().iter().enumerate() {
            if self.flow.calls_for(number) {
                let log = job.log;
                let made = log.run(name(primitive.kind()), || self.primitive(number, primitive, job))?;
                self.results[number] = Some(Rc::new(made));
            }
        }
        // usvg gives no filter without primitives.
        let last = self.results.pop().flatten().map(Rc::unwrap_or_clone);
        Ok(last.unwrap_or_else(|| Layer::clear(self.region, Space::Srgb)))
    }

    /// The primitive's result, over the pixels that are looked at.
    fn primitive(&mut self, number: usize, primitive: &Primitive, job: &mut Job) -> Result<Layer, Error> {
        let mut layer = self.layer(number, primitive, job)?;
        if !moves_freely(primitive, self.filter) {
            layer.clear_outside(self.subregions[number]);
        }
        Ok(layer.into_rect(self.needed.results[number]))
    }

    /// The primitive's result before it is cut to its subregion.
    fn layer(&mut self, number: usize, primitive: &Primitive, job: &mut Job) -> Result<Layer, Error> {
        let space = Space::from(primitive.color_interpolation());
        let (subregion, needed) = (self.subregions[number], self.needed.results[number]);
        let to_canvas = job.to_canvas;
        let (sx, sy) = scales(to_canvas);
        let sized = |x: f32, y: f32| (f64::from(x) * sx, f64::from(y) * sy);
        let is_cut = job.without_front && number + 1 == self.results.len();
        Ok(match primitive.kind() {
            Kind::GaussianBlur(fe) => blur::gaussian(
                self.input_in(number, 0, space),
                sized(fe.std_dev_x().get(), fe.std_dev_y().get()),
            ),
            Kind::DropShadow(fe) => self.drop_shadow(fe, number, space, (sx, sy), !is_cut),
            Kind::Offset(fe) => self.offset(number, sized(fe.dx(), fe.dy())),
            Kind::Flood(fe) => {
                let color = pixel_of(fe.color(), fe.opacity().get(), Space::Srgb);
                Layer::filled(subregion.intersect(needed), Space::Srgb, color).into_rect(needed)
            }
            Kind::Blend(fe) => {
                let (upper, lower) = self.inputs_in(number, space);
                combine::blended(fe.mode(), &upper, lower)
            }
            Kind::Composite(fe) => {
                let (upper, lower) = self.inputs_in(number, space);
                combine::composite(fe.operator(), &upper, lower)
            }
            Kind::Merge(fe) => self.merge(fe, number, space, is_cut),
            Kind::ColorMatrix(fe) => color::matrix(self.input_in(number, 0, space), fe.kind()),
            Kind::ComponentTransfer(fe) => match self.noise_corners(number, space, job) {
                None => color::transfer(self.input_in(number, 0, space), fe),
                Some((corners, within)) => {
                    color::transfer_over_spots(self.input_in(number, 0, space), &corners, fe, within)
                }
            },
            Kind::ConvolveMatrix(fe) => {
                // Its edges are those of the subregion.
                let within = self.input_in(number, 0, space).into_rect(subregion.intersect(self.region));
                convolve::apply(within, fe)?.into_rect(self.region)
            }
            Kind::Morphology(fe) => morphology::apply(
                self.input_in(number, 0, space),
                fe.operator(),
                sized(fe.radius_x().get(), fe.radius_y().get()),
            ),
            Kind::DisplacementMap(fe) => {
                // The space is the map's; what is displaced stays in its own.
                let layer = self.input(number, 0);
                let map = self.input_in(number, 1, space);
                displace::displaced(&layer, map, fe, sized(fe.scale(), fe.scale()))
            }
            Kind::Tile(_) => {
                let tile = match self.flow.inputs(number) {
                    &[Origin::Result(of)] => self.subregions[of],
                    _ => self.region,
                };
                displace::tiled(&self.input(number, 0), tile, self.region)
            }
            Kind::Turbulence(fe) => turbulence::noise(fe, space, needed, to_canvas, user_rect(primitive)),
            Kind::DiffuseLighting(fe) => {
                light::diffuse(self.input_over_region(number, 0), fe, space, to_canvas)
            }
            Kind::SpecularLighting(fe) => {
                let heights = self.input_over_region(number, 0);
                light::specular(heights, fe, space, (self.filter.id(), job))
            }
            Kind::Image(fe) => self.image(fe, number, job)?,
        })
    }

    /// An input as it is, over the pixels of it that are looked at. Each is asked for once: the last to look
    /// at a layer takes it, and may work in its place.
    fn input(&mut self, number: usize, which: usize) -> Rc<Layer> {
        let Run { uses, source, source_alpha, results, .. } = self;
        match self.flow.inputs(number)[which] {
            Origin::Source => looked_at(source, &mut uses.source),
            Origin::SourceAlpha => {
                source_alpha.get_or_insert_with(|| {
                    let source = looked_at(source, &mut uses.source);
                    Rc::new(Rc::try_unwrap(source).map_or_else(|shared| shared.alpha(), Layer::into_alpha))
                });
                looked_at(source_alpha, &mut uses.source_alpha)
            }
            Origin::Result(of) => looked_at(&mut results[of], &mut uses.results[of]),
        }
    }

    fn input_over_region(&mut self, number: usize, which: usize) -> Rc<Layer> {
        let input = self.input(number, which);
        match input.rect() == self.region {
            true => input,
            false => Rc::new(input.over_rect(self.region)),
        }
    }

    /// An input to be looked at.
    fn seen_in(&mut self, number: usize, which: usize, space: Space) -> Rc<Layer> {
        let input = self.input_over_region(number, which);
        match input.space() == space {
            true => input,
            false => Rc::new(Rc::unwrap_or_clone(input).into_space(space)),
        }
    }

    /// An input to be worked on.
    fn input_in(&mut self, number: usize, which: usize, space: Space) -> Layer {
        Rc::unwrap_or_clone(self.seen_in(number, which, space))
    }

    /// The first two inputs: in, to be looked at, and in2, to be worked on.
    fn inputs_in(&mut self, number: usize, space: Space) -> (Rc<Layer>, Layer) {
        (self.seen_in(number, 0, space), self.input_in(number, 1, space))
    }

    /// If index anti-aliasing is asked for and the input is noise, recoloured perhaps: the same at the
    /// corners of pixels, and where it has not been cut off.
    fn noise_corners(&self, number: usize, space: Space, job: &Job) -> Option<(Layer, IntRect)> {
        if !job.index_aa {
            return None;
        }
        let primitives = self.filter.primitives();
        let way = way_to_noise(primitives, &self.flow, number)?;
        let regions = way.iter().map(|&of| pixels_of(primitives[of].rect(), job.to_canvas));
        let within = regions.fold(self.region, IntRect::intersect);
        let mut corners = None;
        for primitive in way.iter().rev().map(|&of| &primitives[of]) {
            let space = Space::from(primitive.color_interpolation());
            corners = match (primitive.kind(), corners) {
                (Kind::Turbulence(fe), _) => {
                    let tile = user_rect(primitive);
                    Some(turbulence::corners(fe, space, self.region, job.to_canvas, tile))
                }
                (Kind::ColorMatrix(fe), Some(corners)) => {
                    Some(color::matrix(Layer::into_space(corners, space), fe.kind()))
                }
                _ => return None,
            };
        }
        Some((corners?.into_space(space), within))
    }

    fn offset(&mut self, number: usize, (dx, dy): (f64, f64)) -> Layer {
        let needed = self.needed.results[number];
        let (dx, dy) = (whole(dx), whole(dy));
        match Rc::try_unwrap(self.input(number, 0)) {
            Ok(own) if own.rect() == needed || (dx, dy) == (0, 0) => own.moved(dx, dy),
            Ok(other) => other.moved_over_rect(dx, dy, needed),
            Err(shared) => shared.moved_over_rect(dx, dy, needed),
        }
    }

    /// All inputs, the first one undermost; without the last one if that is cut.
    fn merge(&mut self, fe: &Merge, number: usize, space: Space, is_cut: bool) -> Layer {
        let count = fe.inputs().len() - usize::from(is_cut);
        if count == 0 {
            return Layer::clear(self.region, space);
        }
        let lowest = self.input_in(number, 0, space);
        (1..count).fold(lowest, |lower, upper| combine::merged(&self.seen_in(number, upper, space), lower))
    }

    /// The shadow, and what casts it if that is shown.
    fn drop_shadow(
        &mut self,
        fe: &DropShadow,
        number: usize,
        space: Space,
        (sx, sy): (f64, f64),
        shown: bool,
    ) -> Layer {
        let input = self.seen_in(number, 0, space);
        let deviations = (f64::from(fe.std_dev_x().get()) * sx, f64::from(fe.std_dev_y().get()) * sy);
        let mut shadow = blur::gaussian(input.alpha(), deviations);
        let color: Pixel = pixel_of(fe.color(), fe.opacity().get(), space);
        for pixel in shadow.pixels_mut() {
            *pixel = color.map(|v| v * pixel[3]);
        }
        let moved = shadow.moved(whole(f64::from(fe.dx()) * sx), whole(f64::from(fe.dy()) * sy));
        if shown {
            combine::merged(&input, moved)
        } else {
            moved
        }
    }

    fn image(&mut self, fe: &Image, number: usize, job: &mut Job) -> Result<Layer, Error> {
        let (subregion, needed) = (self.subregions[number], self.needed.results[number]);
        let (sx, sy) = scales(job.to_canvas);
        let (x, y) = (f64::from(subregion.x()), f64::from(subregion.y()));
        let over = subregion.intersect(needed);
        if over.is_empty() {
            return Ok(Layer::clear(needed, Space::Srgb));
        }
        let drawn = (job.draw)(fe.root(), Affine::new([sx, 0.0, 0.0, sy, x, y]), over)?;
        Ok(drawn.into_rect(needed))
    }
}

/// A layer that is looked at so many times more: itself the last time.
fn looked_at(layer: &mut Option<Rc<Layer>>, uses: &mut usize) -> Rc<Layer> {
    *uses -= 1;
    let seen = if *uses == 0 { layer.take() } else { layer.clone() };
    seen.expect("it is kept while somebody looks at it")
}

/// Whole pixels of an offset: towards 0, as browsers' filters have it.
fn whole(offset: f64) -> i32 {
    (offset + LAST_BITS.copysign(offset)) as i32
}

fn user_rect(primitive: &Primitive) -> Rect {
    let rect = primitive.rect();
    Rect::new(rect.left().into(), rect.top().into(), rect.right().into(), rect.bottom().into())
}
