//! Takes a path and its stroke, makes the outline of what is inked, in pixels.

use super::polyline::Polyline;
use super::{outline, pieces, Options, Stroker};
use kurbo::{Affine, BezPath, Cap, Join, StrokeOpts};
use usvg::{tiny_skia_path, LineCap, LineJoin};

/// The outline of `path` stroked in its own user space, brought to pixels by `transform`: to be
/// filled non-zero. Empty where the transform has no area.
pub(super) fn outline(
    path: &tiny_skia_path::Path,
    stroke: &usvg::Stroke,
    transform: Affine,
    options: &Options,
) -> BezPath {
    let scale = largest_stretch(transform);
    if !(scale > 0.0 && scale.is_finite()) {
        return BezPath::new();
    }
    let tolerance = options.tolerance / scale;
    let path = outline::bez_path(path);
    let style = style(stroke);
    let mut outline = BezPath::new();
    match options.stroker {
        // It knows no clipped miters.
        Stroker::Kurbo if !style.clips_miters => {
            outline = kurbo::stroke(&path, &style.line, &StrokeOpts::default(), tolerance);
            // It draws no dots: lines and dashes without length.
            let dots = style.line.dash_pattern.is_empty() || style.line.dash_pattern.contains(&0.0);
            if dots && style.line.start_cap != Cap::Butt {
                let is_dot = |line: &Polyline| line.points.len() == 1;
                lines(&path, &style, tolerance)
                    .filter(is_dot)
                    .for_each(|dot| pieces::stroke(&dot, &style, tolerance, &mut outline));
            }
        }
        _ => lines(&path, &style, tolerance)
            .for_each(|line| pieces::stroke(&line, &style, tolerance, &mut outline)),
    }
    transform * outline
}

/// A closed sub-path has no gap before its seam that is thinner than this, as a share of the pen's width.
const NO_GAP: f64 = 0.01;

/// The sub-paths, or their dashes.
fn lines<'a>(path: &BezPath, style: &'a Style, tolerance: f64) -> impl Iterator<Item = Polyline> + 'a {
    // Dashes are measured along the chords, and where one ends its direction lies between those of the chord's ends.
    let finer = if style.line.dash_pattern.is_empty() { 1.0 } else { 0.05 };
    Polyline::all(path, finer * tolerance, 0.5 * style.line.width).into_iter().flat_map(|line| {
        if style.line.dash_pattern.is_empty() {
            vec![line]
        } else {
            line.dashes(&style.line.dash_pattern, style.line.dash_offset, NO_GAP * style.line.width)
        }
    })
}

/// The stroke's style in kurbo's words, and one for which it has none.
pub(super) struct Style {
    pub(super) line: kurbo::Stroke,
    /// `miter-clip`.
    pub(super) clips_miters: bool,
}

fn style(stroke: &usvg::Stroke) -> Style {
    let cap = match stroke.linecap() {
        LineCap::Butt => Cap::Butt,
        LineCap::Round => Cap::Round,
        LineCap::Square => Cap::Square,
    };
    let join = match stroke.linejoin() {
        LineJoin::Miter | LineJoin::MiterClip => Join::Miter,
        LineJoin::Round => Join::Round,
        LineJoin::Bevel => Join::Bevel,
    };
    let line = kurbo::Stroke::new(f64::from(stroke.width().get()))
        .with_caps(cap)
        .with_join(join)
        .with_miter_limit(f64::from(stroke.miterlimit().get()));
    let line = match stroke.dasharray() {
        Some(dashes) => {
            line.with_dashes(f64::from(stroke.dashoffset()), dashes.iter().copied().map(f64::from))
        }
        None => line,
    };
    Style { line, clips_miters: stroke.linejoin() == LineJoin::MiterClip }
}

/// The most that `transform` stretches any direction: its larger singular value.
fn largest_stretch(transform: Affine) -> f64 {
    let [a, b, c, d, ..] = transform.as_coeffs();
    0.5 * ((a + d).hypot(b - c) + (a - d).hypot(b + c))
}
