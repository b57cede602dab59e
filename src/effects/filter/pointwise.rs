//! What a filter does to a colour, where it does the same to every colour everywhere; and whether what it
//! filters comes out before all else. Neither then needs pixels.

use super::color;
use crate::effects::layer::{IntRect, Layer, Pixel, Space};
use usvg::filter::{Filter, Input, Kind, Primitive};

/// The filter as a function of one sRGB-encoded colour, which holds within the primitives' subregions;
/// `None` where it is no such function.
pub(crate) fn recolored(filter: &Filter, pixel: Pixel) -> Option<Pixel> {
    let one = IntRect::new(0, 0, 1, 1);
    let mut layer = Layer::filled(one, Space::Srgb, pixel);
    let mut before: Option<&Primitive> = None;
    for primitive in filter.primitives() {
        let is_next = |input: &Input| match (input, before) {
            (Input::SourceGraphic, None) => true,
            (Input::Reference(name), Some(before)) => name == before.result(),
            _ => false,
        };
        layer = layer.into_space(primitive.color_interpolation().into());
        layer = match primitive.kind() {
            Kind::ColorMatrix(fe) if is_next(fe.input()) => color::matrix(layer, fe.kind()),
            Kind::ComponentTransfer(fe) if is_next(fe.input()) => color::transfer(layer, fe),
            _ => return None,
        };
        before = Some(primitive);
    }
    Some(layer.into_space(Space::Srgb).pixel(0, 0))
}

/// Does the filter put what it filters, as it is, before whatever else it makes? Encodings make no
/// difference to opaque colours; `all_opaque` says that there are no others.
pub(crate) fn has_source_in_front(filter: &Filter, all_opaque: bool) -> bool {
    filter.primitives().last().is_some_and(|last| {
        let is_exact = all_opaque || Space::from(last.color_interpolation()) == Space::Srgb;
        is_exact
            && match last.kind() {
                Kind::DropShadow(fe) => *fe.input() == Input::SourceGraphic,
                Kind::Merge(fe) => fe.inputs().last() == Some(&Input::SourceGraphic),
                _ => false,
            }
    })
}
