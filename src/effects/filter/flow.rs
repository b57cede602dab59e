//! Takes a filter's primitives, makes what goes where between them: whose results each one looks at, how
//! often, and at which pixels of them.

use super::region::{pixels_of, primitive_reach};
use crate::effects::layer::IntRect;
use kurbo::Affine;
use std::collections::HashMap;
use usvg::filter::{Filter, Input, Kind, Primitive};

/// Where an input comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    Source,
    SourceAlpha,
    /// The result of the primitive with this number.
    Result(usize),
}

/// May the result leave where its input is? So it is with an feOffset that names no place of its own, for which
/// usvg gives the filter's.
pub(super) fn moves_freely(primitive: &Primitive, filter: &Filter) -> bool {
    matches!(primitive.kind(), Kind::Offset(_)) && primitive.rect() == filter.rect()
}

/// The inputs of a filter's primitives.
pub(super) struct Flow {
    /// Of each primitive that the last one's result depends on, its inputs in order; `None` for the others.
    origins: Vec<Option<Vec<Origin>>>,
    /// Of each primitive, the last one that looks at its result.
    last_use: Vec<usize>,
}

/// How often a filter's source, the source's alpha and each primitive's result are still looked at. Making
/// the alpha is one look at the source.
pub(super) struct Uses {
    pub source: usize,
    pub source_alpha: usize,
    pub results: Vec<usize>,
}

/// The pixels that are looked at of a filter's source and of each primitive's result.
pub(super) struct Needed {
    pub source: IntRect,
    pub results: Vec<IntRect>,
}

impl Flow {
    pub fn of(primitives: &[Primitive]) -> Flow {
        let mut origins = origins(primitives);
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
        Flow { origins, last_use }
    }

    /// Is the primitive's result called for?
    pub fn calls_for(&self, number: usize) -> bool {
        self.origins[number].is_some()
    }

    /// The inputs of a primitive that is called for, in order.
    pub fn inputs(&self, number: usize) -> &[Origin] {
        self.origins[number].as_deref().unwrap_or_default()
    }

    /// Layers at once, at most: results in use, the source, its alpha, and two being worked on.
    pub fn most_layers(&self) -> usize {
        let (mut in_use, mut most) = (0usize, 0);
        // A result is in use until the last primitive that looks at it is done.
        let mut ends = vec![0usize; self.last_use.len() + 1];
        for (number, &last) in self.last_use.iter().enumerate() {
            in_use += 1;
            ends[last.max(number)] += 1;
            most = most.max(in_use);
            in_use -= ends[number];
        }
        most + 4
    }

    pub fn uses(&self) -> Uses {
        let mut uses = Uses { source: 0, source_alpha: 0, results: vec![0; self.origins.len()] };
        for origin in self.origins.iter().flatten().flatten() {
            match *origin {
                Origin::Source => uses.source += 1,
                Origin::SourceAlpha => uses.source_alpha += 1,
                Origin::Result(of) => uses.results[of] += 1,
            }
        }
        uses.source += usize::from(uses.source_alpha > 0);
        uses
    }

    /// Where each primitive's result has anything: feTile's tile. An feOffset that names no place is where its
    /// input is.
    pub fn subregions(&self, filter: &Filter, to_canvas: Affine) -> Vec<IntRect> {
        let mut subregions: Vec<IntRect> = Vec::with_capacity(filter.primitives().len());
        for (number, primitive) in filter.primitives().iter().enumerate() {
            let subregion = match self.inputs(number) {
                &[Origin::Result(of)] if moves_freely(primitive, filter) => subregions[of],
                _ => pixels_of(primitive.rect(), to_canvas),
            };
            subregions.push(subregion);
        }
        subregions
    }

    /// What is looked at for the last primitive's result over `region`, on which the filter is run. An
    /// feTile looks at its tile; what leads to it needs no more.
    pub fn needed(
        &self,
        primitives: &[Primitive],
        subregions: &[IntRect],
        region: IntRect,
        to_canvas: Affine,
    ) -> Needed {
        let mut needed = Needed { source: IntRect::EMPTY, results: vec![IntRect::EMPTY; primitives.len()] };
        if let Some(last) = needed.results.last_mut() {
            *last = region;
        }
        for (number, primitive) in primitives.iter().enumerate().rev() {
            for &origin in self.inputs(number) {
                let seen = match (primitive.kind(), origin) {
                    (Kind::Tile(_), Origin::Result(of)) => subregions[of],
                    (kind, _) => match primitive_reach(kind, to_canvas) {
                        Some((x, y)) => needed.results[number].grown(x.ceil() as i64, y.ceil() as i64),
                        None => region,
                    },
                };
                let of = match origin {
                    Origin::Source | Origin::SourceAlpha => &mut needed.source,
                    Origin::Result(of) => &mut needed.results[of],
                };
                *of = of.united(seen.intersect(region));
            }
        }
        needed
    }
}

/// Where the inputs of each primitive come from.
fn origins(primitives: &[Primitive]) -> Vec<Option<Vec<Origin>>> {
    let mut named = HashMap::new();
    let mut origins = Vec::with_capacity(primitives.len());
    for (number, primitive) in primitives.iter().enumerate() {
        let kind = primitive.kind();
        // Lights look at nothing but alpha, which the source has too.
        let is_light = matches!(kind, Kind::DiffuseLighting(_) | Kind::SpecularLighting(_));
        let origin = |input: &Input| match input {
            Input::SourceAlpha if !is_light => Origin::SourceAlpha,
            Input::SourceGraphic | Input::SourceAlpha => Origin::Source,
            Input::Reference(name) => {
                named.get(name.as_str()).map_or(Origin::Source, |&of| Origin::Result(of))
            }
        };
        let of_primitive: Vec<Origin> = inputs(kind).into_iter().map(origin).collect();
        origins.push(Some(of_primitive));
        named.insert(primitive.result(), number);
    }
    origins
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
