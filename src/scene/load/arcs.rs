//! Takes the XML of a drawing, refuses arcs so large that the parser would cut them into millions of
//! curves, in time that grows with the square of their number.

use crate::Error;
use usvg::roxmltree::Document;

/// Largest coordinate or radius beside an arc, in user units. An arc of this radius becomes some 50
/// curves; one of 1e38 three million.
const FARTHEST: f64 = 1e9;

/// Digits and exponents that a number beyond [`FARTHEST`] must have.
const DIGITS: usize = 10;

/// # Errors
/// [`Error::Limit`] for the first such arc.
pub(super) fn check(xml: &Document) -> Result<(), Error> {
    for node in xml.descendants() {
        let Some(data) = node.attribute("d") else { continue };
        if has_far_arc(data) {
            let id = node.attribute("id").map(|id| format!(" '{id}'")).unwrap_or_default();
            return Err(Error::Limit(format!(
                "the path{id} has an arc with coordinates beyond {FARTHEST:e} (take it out)"
            )));
        }
    }
    Ok(())
}

/// Whether path data has such an arc.
pub(crate) fn has_far_arc(data: &str) -> bool {
    may_hold_one(data) && holds_one(data)
}

/// Fast, and never wrongly false: an arc, and either an exponent or a long run of digits.
fn may_hold_one(data: &str) -> bool {
    let bytes = data.as_bytes();
    let has = |byte: u8| bytes.contains(&byte);
    if !has(b'a') && !has(b'A') {
        return false;
    }
    has(b'e')
        || has(b'E')
        || bytes.chunk_by(|a, b| a.is_ascii_digit() && b.is_ascii_digit()).any(|run| run.len() >= DIGITS)
}

/// Whether there is an arc and a number beyond [`FARTHEST`], before the first error.
fn holds_one(data: &str) -> bool {
    use svgtypes::PathSegment as S;
    let mut arc = false;
    let mut far = false;
    for segment in svgtypes::PathParser::from(data).map_while(Result::ok) {
        let numbers = match segment {
            S::MoveTo { x, y, .. } | S::LineTo { x, y, .. } | S::SmoothQuadratic { x, y, .. } => {
                [x, y, 0.0, 0.0]
            }
            S::HorizontalLineTo { x, .. } => [x, 0.0, 0.0, 0.0],
            S::VerticalLineTo { y, .. } => [y, 0.0, 0.0, 0.0],
            S::CurveTo { x, y, .. } | S::SmoothCurveTo { x, y, .. } | S::Quadratic { x, y, .. } => {
                [x, y, 0.0, 0.0]
            }
            S::EllipticalArc { rx, ry, x, y, .. } => {
                arc = true;
                [rx, ry, x, y]
            }
            S::ClosePath { .. } => continue,
        };
        far |= numbers.iter().any(|n| n.is_nan() || n.abs() > FARTHEST);
    }
    arc && far
}
