//! Takes filters and the picture's rectangle, says over which pixels they have to be run: no more than
//! the filter region, and no more than what the picture can show of it.

use super::blur;
use crate::effects::layer::{IntRect, Layer};
use kurbo::{Affine, Rect};
use std::sync::Arc;
use usvg::filter::{EdgeMode, Filter, Kind};
use usvg::NonZeroRect;

/// A transform in two steps: filters run on a canvas that is only scaled, with axes along the user
/// space's, and the result is turned and skewed into the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Canvas {
    /// From user units to the canvas's pixels: positive scales and a translation.
    pub to_canvas: Affine,
    /// From the canvas to the picture; the identity where nothing is turned, skewed or mirrored.
    pub to_picture: Affine,
}

impl Canvas {
    /// `None` where the transform leaves no area.
    pub fn new(transform: Affine) -> Option<Canvas> {
        let [a, b, c, d, ..] = transform.as_coeffs();
        let (sx, sy) = (a.hypot(b), c.hypot(d));
        let to_picture = Affine::new([a / sx, b / sx, c / sy, d / sy, 0.0, 0.0]);
        // Rounding must not turn what stands straight.
        const STRAIGHT: f64 = 1e-7;
        let mut off = to_picture.as_coeffs().into_iter().zip(Affine::IDENTITY.as_coeffs());
        if off.all(|(one, other)| (one - other).abs() < STRAIGHT) {
            let [.., e, f] = transform.as_coeffs();
            return Some(Canvas {
                to_canvas: Affine::new([sx, 0.0, 0.0, sy, e, f]),
                to_picture: Affine::IDENTITY,
            });
        }
        if !to_picture.is_finite() || to_picture.determinant().abs() < 1e-9 {
            return None;
        }
        let [_, _, _, _, e, f] = (to_picture.inverse() * transform).as_coeffs();
        Some(Canvas { to_canvas: Affine::new([sx, 0.0, 0.0, sy, e, f]), to_picture })
    }

    /// The pixels of the canvas that the picture's rectangle shows.
    pub fn rect_of(&self, picture: IntRect) -> IntRect {
        if self.to_picture == Affine::IDENTITY || picture.is_empty() {
            return picture;
        }
        // One pixel more: colours are taken from between pixels.
        let shown = self.to_picture.inverse().transform_rect_bbox(picture.to_rect());
        IntRect::around(shown.inflate(1.0, 1.0))
    }

    /// A layer of the canvas, seen in the picture's rectangle.
    pub fn shown(&self, layer: Layer, picture: IntRect) -> Layer {
        if self.to_picture == Affine::IDENTITY {
            let shown = layer.rect().intersect(picture);
            layer.into_rect(shown)
        } else {
            let covered = IntRect::around(self.to_picture.transform_rect_bbox(layer.rect().to_rect()));
            layer.resampled(self.to_picture, covered.grown(1, 1).intersect(picture))
        }
    }
}

/// For each of a chain of filters, the pixels to run it over so that `shown` comes out right, which is part
/// of `all` that the picture shows. Empty where nothing is to be seen.
pub(crate) fn regions(
    filters: &[Arc<Filter>],
    to_canvas: Affine,
    shown: IntRect,
    all: IntRect,
) -> Vec<IntRect> {
    // A blur may reach a hundred thousand pixels out, where nothing that matters lies.
    let far = 2 * all.width().max(all.height()) as i64;
    let outermost = shown.grown(far, far);
    let mut needed = shown;
    let mut regions: Vec<IntRect> = filters
        .iter()
        .rev()
        .map(|filter| {
            let region = pixels_of(filter.rect(), to_canvas);
            needed = match reach(filter, to_canvas) {
                Some((x, y)) => region.intersect(needed.grown(x, y)),
                None => region,
            }
            .intersect(outermost);
            needed
        })
        .collect();
    regions.reverse();
    regions
}

/// The whole pixels of a region in user units.
pub(super) fn pixels_of(rect: NonZeroRect, to_canvas: Affine) -> IntRect {
    let rect = to_canvas.transform_rect_bbox(Rect::new(
        rect.left().into(),
        rect.top().into(),
        rect.right().into(),
        rect.bottom().into(),
    ));
    // As browsers do: all pixels that it touches, and at least one. Sizes come from single precision:
    // edges must not move to the next pixel because of its last bits.
    let (x, y) = ((rect.x0 + LAST_BITS).floor(), (rect.y0 + LAST_BITS).floor());
    let (right, bottom) = ((rect.x1 - LAST_BITS).ceil(), (rect.y1 - LAST_BITS).ceil());
    IntRect::from_edges(x as i64, y as i64, right.max(x + 1.0) as i64, bottom.max(y + 1.0) as i64)
}

/// A share of a pixel below which a position is taken for a whole number.
pub(super) const LAST_BITS: f64 = 1e-3;

/// How many pixels away, at most, a pixel of the source changes the result; `None`: anywhere.
fn reach(filter: &Filter, to_canvas: Affine) -> Option<(i64, i64)> {
    let mut sum = (0.0, 0.0);
    for primitive in filter.primitives() {
        let (x, y) = primitive_reach(primitive.kind(), to_canvas)?;
        sum = (sum.0 + x, sum.1 + y);
    }
    // Saturating casts.
    Some((sum.0.ceil() as i64, sum.1.ceil() as i64))
}

/// The same of one primitive, which looks at all of its inputs alike.
pub(super) fn primitive_reach(kind: &Kind, to_canvas: Affine) -> Option<(f64, f64)> {
    let (sx, sy) = scales(to_canvas);
    let size = |v: f32, scale: f64| f64::from(v).abs() * scale;
    Some(match kind {
        Kind::GaussianBlur(fe) => {
            (blur::reach(size(fe.std_dev_x().get(), sx)), blur::reach(size(fe.std_dev_y().get(), sy)))
        }
        Kind::DropShadow(fe) => (
            blur::reach(size(fe.std_dev_x().get(), sx)) + size(fe.dx(), sx),
            blur::reach(size(fe.std_dev_y().get(), sy)) + size(fe.dy(), sy),
        ),
        Kind::Offset(fe) => (size(fe.dx(), sx), size(fe.dy(), sy)),
        Kind::Morphology(fe) => (size(fe.radius_x().get(), sx) + 1.0, size(fe.radius_y().get(), sy) + 1.0),
        Kind::DisplacementMap(fe) => (size(fe.scale(), sx) * 0.5 + 1.0, size(fe.scale(), sy) * 0.5 + 1.0),
        Kind::ConvolveMatrix(fe) if fe.edge_mode() == EdgeMode::Wrap => return None,
        Kind::ConvolveMatrix(fe) => (fe.matrix().columns().into(), fe.matrix().rows().into()),
        // One for the slopes, one for the slopes' neighbours.
        Kind::DiffuseLighting(_) | Kind::SpecularLighting(_) => (2.0, 2.0),
        Kind::Tile(_) => return None,
        Kind::Blend(_)
        | Kind::ColorMatrix(_)
        | Kind::ComponentTransfer(_)
        | Kind::Composite(_)
        | Kind::Flood(_)
        | Kind::Image(_)
        | Kind::Merge(_)
        | Kind::Turbulence(_) => (0.0, 0.0),
    })
}

/// Pixels a user unit, across and down.
pub(super) fn scales(to_canvas: Affine) -> (f64, f64) {
    let [a, _, _, d, ..] = to_canvas.as_coeffs();
    (a.abs(), d.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_canvas_and_its_turn_make_the_transform() {
        for transform in [
            Affine::scale_non_uniform(2.0, 3.0).then_translate((4.0, 5.5).into()),
            Affine::rotate(0.7) * Affine::scale(2.0),
            Affine::skew(0.4, 0.0).then_translate((-9.0, 2.0).into()),
            Affine::FLIP_X * Affine::scale(1.5),
        ] {
            let canvas = Canvas::new(transform).unwrap();
            let both = (canvas.to_picture * canvas.to_canvas).as_coeffs();
            for (one, other) in both.iter().zip(transform.as_coeffs()) {
                assert!((one - other).abs() < 1e-9, "{both:?} is not {transform:?}");
            }
            let [a, b, c, d, ..] = canvas.to_canvas.as_coeffs();
            assert!(a > 0.0 && d > 0.0 && b == 0.0 && c == 0.0);
        }
        assert!(Canvas::new(Affine::scale(0.0)).is_none());
        assert!(Canvas::new(Affine::skew(f64::NAN, 1.0)).is_none());
        assert!(Canvas::new(Affine::new([1.0, 1.0, 1.0, 1.0, 0.0, 0.0])).is_none());
    }
}
