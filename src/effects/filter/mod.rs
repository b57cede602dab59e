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
//! | `light` | feDiffuseLighting, feSpecularLighting |
//! | `morphology` | feMorphology |
//! | [`pointwise`] | filters that need no pixels, or not for what they filter |
//! | `turbulence` | feTurbulence |
//! | `lines` | rows and columns for what works along one axis |
//!
//! To run a group's filters: [`region::Canvas::new`] of its transform; [`region::regions`] for the
//! canvas's part that the picture shows; [`affordable`]; draw the group's content under `to_canvas`
//! over the first region; [`apply`]; [`region::Canvas::shown`]. Primitives whose results nobody looks
//! at are not run.

mod blur;
mod color;
mod combine;
mod convolve;
mod displace;
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
use kurbo::{Affine, Rect};
use region::{pixels_of, scales, LAST_BITS};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;
use usvg::filter::{DropShadow, Filter, Image, Input, Kind, Primitive};

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
        layer = Run::new(filter, region, layer).run(job)?;
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
    let (_, last_use) = origins_and_last_use(filter.primitives());
    region.area().saturating_mul(most_layers(&last_use) as u64)
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
    let (origins, _) = origins_and_last_use(primitives);
    let is_run = |number: &usize| origins[*number].is_some();
    let step = |number: usize| {
        let kind = primitives[number].kind();
        let is_table = matches!(kind, Kind::ComponentTransfer(_));
        let is_table_over_noise = is_table && way_to_noise(primitives, &origins, number).is_some();
        Step { name: name(kind), is_table_over_noise }
    };
    (0..primitives.len()).filter(is_run).map(step).collect()
}

/// The primitives that a primitive's input goes back through to noise, if there are none but colour matrices between:
/// the nearest first, feTurbulence last.
fn way_to_noise(
    primitives: &[Primitive],
    origins: &[Option<Vec<Origin>>],
    number: usize,
) -> Option<Vec<usize>> {
    let (mut way, mut at) = (Vec::new(), number);
    loop {
        let &[Origin::Result(of)] = origins[at].as_deref()? else { return None };
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

/// What a primitive made.
#[derive(Clone)]
struct Made {
    layer: Rc<Layer>,
    /// Where it has anything: feTile's tile.
    region: IntRect,
}

/// Where an input comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    Source,
    SourceAlpha,
    /// The result of the primitive with this number.
    Result(usize),
}

/// One filter at work.
struct Run<'a> {
    filter: &'a Filter,
    region: IntRect,
    source: Rc<Layer>,
    source_alpha: Option<Rc<Layer>>,
    /// Of each primitive that is called for, its inputs in order.
    origins: Vec<Option<Vec<Origin>>>,
    /// Of each primitive, the last one that looks at its result.
    last_use: Vec<usize>,
    /// Results, while somebody still looks at them.
    results: Vec<Option<Made>>,
}

impl<'a> Run<'a> {
    fn new(filter: &'a Filter, region: IntRect, source: Layer) -> Run<'a> {
        let primitives = filter.primitives();
        let (origins, last_use) = origins_and_last_use(primitives);
        Run {
            filter,
            region,
            source: Rc::new(source.into_rect(region)),
            source_alpha: None,
            origins,
            last_use,
            results: vec![None; primitives.len()],
        }
    }

    fn run(mut self, job: &mut Job) -> Result<Layer, Error> {
        let filter = self.filter;
        if self.region.is_empty() {
            return Ok(Layer::clear(IntRect::EMPTY, Space::Srgb));
        }
        for (number, primitive) in filter.primitives().iter().enumerate() {
            if self.origins[number].is_some() {
                let log = job.log;
                let made = log.run(name(primitive.kind()), || self.primitive(number, primitive, job))?;
                self.results[number] = Some(made);
            }
        }
        // usvg gives no filter without primitives.
        let last = self.results.pop().flatten().map(|made| Rc::unwrap_or_clone(made.layer));
        Ok(last.unwrap_or_else(|| Layer::clear(self.region, Space::Srgb)))
    }

    fn primitive(&mut self, number: usize, primitive: &Primitive, job: &mut Job) -> Result<Made, Error> {
        let mut subregion = pixels_of(primitive.rect(), job.to_canvas);
        // An feOffset is where its input is, and is not cut: what it moves may leave it.
        let offset = matches!(primitive.kind(), Kind::Offset(_));
        if offset {
            if let Some(Origin::Result(of)) = self.origins(number).first() {
                if let Some(made) = &self.results[*of] {
                    subregion = made.region;
                }
            }
        }
        let mut layer = self.layer(number, primitive, subregion, job)?;
        debug_assert_eq!(layer.rect(), self.region);
        if !offset {
            layer.clear_outside(subregion);
        }
        Ok(Made { layer: Rc::new(layer), region: subregion })
    }

    /// The primitive's result before it is cut to its subregion.
    fn layer(
        &mut self,
        number: usize,
        primitive: &Primitive,
        subregion: IntRect,
        job: &mut Job,
    ) -> Result<Layer, Error> {
        let space = Space::from(primitive.color_interpolation());
        let to_canvas = job.to_canvas;
        let (sx, sy) = scales(to_canvas);
        let sized = |x: f32, y: f32| (f64::from(x) * sx, f64::from(y) * sy);
        Ok(match primitive.kind() {
            Kind::GaussianBlur(fe) => blur::gaussian(
                self.input_in(number, 0, space),
                sized(fe.std_dev_x().get(), fe.std_dev_y().get()),
            ),
            Kind::DropShadow(fe) => {
                let shown = !(job.without_front && number + 1 == self.origins.len());
                self.drop_shadow(fe, number, space, (sx, sy), shown)
            }
            Kind::Offset(fe) => self.offset(number, sized(fe.dx(), fe.dy())),
            Kind::Flood(fe) => {
                let color = pixel_of(fe.color(), fe.opacity().get(), Space::Srgb);
                Layer::filled(self.region, Space::Srgb, color)
            }
            Kind::Blend(fe) => {
                let (upper, lower) = self.inputs_in(number, space);
                combine::blended(fe.mode(), &upper, lower)
            }
            Kind::Composite(fe) => {
                let (upper, lower) = self.inputs_in(number, space);
                combine::composite(fe.operator(), &upper, lower)
            }
            Kind::Merge(fe) => {
                let mut merged = Layer::clear(self.region, space);
                let is_cut = job.without_front && number + 1 == self.origins.len();
                for i in 0..fe.inputs().len() - usize::from(is_cut) {
                    merged = combine::merged(&self.input_in(number, i, space), merged);
                }
                merged
            }
            Kind::ColorMatrix(fe) => color::matrix(self.input_in(number, 0, space), fe.kind()),
            Kind::ComponentTransfer(fe) => match self.noise_corners(number, space, job) {
                None => color::transfer(self.input_in(number, 0, space), fe),
                Some((corners, within)) => {
                    color::transfer_over_spots(self.input_in(number, 0, space), &corners, fe, within)
                }
            },
            Kind::ConvolveMatrix(fe) => {
                // Its edges are those of the subregion.
                let within = self.input_in(number, 0, space).over_rect(subregion.intersect(self.region));
                convolve::apply(within, fe)?.over_rect(self.region)
            }
            Kind::Morphology(fe) => morphology::apply(
                self.input_in(number, 0, space),
                fe.operator(),
                sized(fe.radius_x().get(), fe.radius_y().get()),
            ),
            Kind::DisplacementMap(fe) => {
                // The space is the map's; what is displaced stays in its own.
                let layer = self.input(number, 0).layer;
                let map = self.input_in(number, 1, space);
                displace::displaced(&layer, &map, fe, sized(fe.scale(), fe.scale()))
            }
            Kind::Tile(_) => {
                let input = self.input(number, 0);
                displace::tiled(&input.layer, input.region)
            }
            Kind::Turbulence(fe) => {
                turbulence::noise(fe, space, self.region, to_canvas, user_rect(primitive))
            }
            Kind::DiffuseLighting(fe) => light::diffuse(&self.input(number, 0).layer, fe, space, to_canvas),
            Kind::SpecularLighting(fe) => {
                light::specular(&self.input(number, 0).layer, fe, space, (self.filter.id(), job))
            }
            Kind::Image(fe) => self.image(fe, subregion, job)?,
        })
    }

    fn origins(&self, number: usize) -> &[Origin] {
        self.origins[number].as_deref().unwrap_or_default()
    }

    /// An input as it is. Inputs are asked for in their order, each once.
    fn input(&mut self, number: usize, which: usize) -> Made {
        let made = |layer: &Rc<Layer>, region| Made { layer: layer.clone(), region };
        let origin = self.origins(number)[which];
        let later = self.origins(number)[which + 1..].contains(&origin);
        match origin {
            Origin::Source => made(&self.source, self.region),
            Origin::SourceAlpha => {
                let alpha = self.source_alpha.get_or_insert_with(|| Rc::new(self.source.alpha()));
                made(alpha, self.region)
            }
            Origin::Result(of) => {
                // The last to look at a result takes it, and may work in its place.
                let last = self.last_use[of] == number && !later;
                let result = &mut self.results[of];
                let result = if last { result.take() } else { result.clone() };
                result.unwrap_or_else(|| made(&self.source, self.region))
            }
        }
    }

    /// An input to be worked on.
    fn input_in(&mut self, number: usize, which: usize, space: Space) -> Layer {
        Rc::unwrap_or_clone(self.input(number, which).layer).into_space(space)
    }

    /// The first two inputs: in and in2.
    fn inputs_in(&mut self, number: usize, space: Space) -> (Layer, Layer) {
        (self.input_in(number, 0, space), self.input_in(number, 1, space))
    }

    /// If index anti-aliasing is asked for and the input is noise, recoloured perhaps: the same at the
    /// corners of pixels, and where it has not been cut off.
    fn noise_corners(&self, number: usize, space: Space, job: &Job) -> Option<(Layer, IntRect)> {
        if !job.index_aa {
            return None;
        }
        let primitives = self.filter.primitives();
        let way = way_to_noise(primitives, &self.origins, number)?;
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
        let input = self.input(number, 0).layer;
        match (whole(dx), whole(dy)) {
            (0, 0) => Rc::unwrap_or_clone(input),
            (dx, dy) => input.moved_over_rect(dx, dy, self.region),
        }
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
        let input = self.input_in(number, 0, space);
        let deviations = (f64::from(fe.std_dev_x().get()) * sx, f64::from(fe.std_dev_y().get()) * sy);
        let mut shadow = blur::gaussian(input.alpha(), deviations);
        let color: Pixel = pixel_of(fe.color(), fe.opacity().get(), space);
        for pixel in shadow.pixels_mut() {
            *pixel = color.map(|v| v * pixel[3]);
        }
        let (dx, dy) = (whole(f64::from(fe.dx()) * sx), whole(f64::from(fe.dy()) * sy));
        let moved = shadow.moved_over_rect(dx, dy, self.region);
        if shown {
            combine::merged(&input, moved)
        } else {
            moved
        }
    }

    fn image(&mut self, fe: &Image, subregion: IntRect, job: &mut Job) -> Result<Layer, Error> {
        let (sx, sy) = scales(job.to_canvas);
        let (x, y) = (f64::from(subregion.x()), f64::from(subregion.y()));
        let over = subregion.intersect(self.region);
        if over.is_empty() {
            return Ok(Layer::clear(self.region, Space::Srgb));
        }
        let drawn = (job.draw)(fe.root(), Affine::new([sx, 0.0, 0.0, sy, x, y]), over)?;
        Ok(drawn.into_rect(self.region))
    }
}

/// Where the inputs come from of each primitive that the last one's result depends on, `None` for the
/// others; and which primitive is the last to look at each one's result.
fn origins_and_last_use(primitives: &[Primitive]) -> (Vec<Option<Vec<Origin>>>, Vec<usize>) {
    let mut named = HashMap::new();
    let mut origins = Vec::with_capacity(primitives.len());
    for (number, primitive) in primitives.iter().enumerate() {
        let origin = |input: &Input| match input {
            Input::SourceGraphic => Origin::Source,
            Input::SourceAlpha => Origin::SourceAlpha,
            Input::Reference(name) => {
                named.get(name.as_str()).map_or(Origin::Source, |&of| Origin::Result(of))
            }
        };
        let of_primitive: Vec<Origin> = inputs(primitive.kind()).into_iter().map(origin).collect();
        origins.push(Some(of_primitive));
        named.insert(primitive.result(), number);
    }
    let mut last_use: Vec<Option<usize>> = vec![None; primitives.len()];
    for number in (0..primitives.len()).rev() {
        if number + 1 < primitives.len() && last_use[number].is_none() {
            origins[number] = None;
        }
        for origin in origins[number].iter().flatten() {
            if let Origin::Result(of) = origin {
                last_use[*of].get_or_insert(number);
            }
        }
    }
    let last_use = last_use.iter().enumerate().map(|(number, last)| last.unwrap_or(number)).collect();
    (origins, last_use)
}

/// Layers at once, at most: results in use, the source, its alpha, and two being worked on.
fn most_layers(last_use: &[usize]) -> usize {
    let (mut in_use, mut most) = (0usize, 0);
    // A result is in use until the last primitive that looks at it is done.
    let mut ends = vec![0usize; last_use.len() + 1];
    for (number, &last) in last_use.iter().enumerate() {
        in_use += 1;
        ends[last.max(number)] += 1;
        most = most.max(in_use);
        in_use -= ends[number];
    }
    most + 4
}

/// Whole pixels of an offset: towards 0, as browsers' filters have it.
fn whole(offset: f64) -> i32 {
    (offset + LAST_BITS.copysign(offset)) as i32
}

fn user_rect(primitive: &Primitive) -> Rect {
    let rect = primitive.rect();
    Rect::new(rect.left().into(), rect.top().into(), rect.right().into(), rect.bottom().into())
}

fn inputs(kind: &Kind) -> Vec<&Input> {
    match kind {
        Kind::Blend(fe) => vec![fe.input1(), fe.input2()],
        Kind::ColorMatrix(fe) => vec![fe.input()],
        Kind::ComponentTransfer(fe) => vec![fe.input()],
        Kind::Composite(fe) => vec![fe.input1(), fe.input2()],
        Kind::ConvolveMatrix(fe) => vec![fe.input()],
        Kind::DiffuseLighting(fe) => vec![fe.input()],
        Kind::DisplacementMap(fe) => vec![fe.input1(), fe.input2()],
        Kind::DropShadow(fe) => vec![fe.input()],
        Kind::Flood(_) | Kind::Image(_) | Kind::Turbulence(_) => vec![],
        Kind::GaussianBlur(fe) => vec![fe.input()],
        Kind::Merge(fe) => fe.inputs().iter().collect(),
        Kind::Morphology(fe) => vec![fe.input()],
        Kind::Offset(fe) => vec![fe.input()],
        Kind::SpecularLighting(fe) => vec![fe.input()],
        Kind::Tile(fe) => vec![fe.input()],
    }
}
