//! Takes a pattern and the box that it paints, makes the places of its tiles.

use super::census::patterns;
use super::drawing::affine;
use kurbo::{Rect, Vec2};
use usvg::{Group, Node, Path, Pattern};

/// Shapes of all a pattern's tiles; one of more is not drawn.
const MOST_SHAPES: f64 = 50_000.0;

/// Whether all the tiles that `bounds` (in user units) may show have too many shapes.
pub(super) fn is_too_much(pattern: &Pattern, bounds: usvg::Rect) -> bool {
    let shapes = shapes_of(pattern, bounds, MOST_SHAPES);
    shapes.is_nan() || shapes > MOST_SHAPES
}

/// A tile with its corner in the origin, and where it is drawn so that all of `bounds` (in user units) is
/// covered: both in the units of the pattern.
pub(super) fn tiles(pattern: &Pattern, bounds: usvg::Rect) -> (Rect, impl Iterator<Item = Vec2>) {
    let rect = pattern.rect();
    let size = Vec2::new(rect.width().into(), rect.height().into());
    let origin = Vec2::new(rect.x().into(), rect.y().into());
    let Tiles { columns, rows } = Tiles::of(pattern, bounds);
    let count = |(first, last): (f64, f64)| 0..=(last - first) as u64;
    let place = move |i: u64, j: u64| {
        origin + Vec2::new((columns.0 + i as f64) * size.x, (rows.0 + j as f64) * size.y)
    };
    let places = count(rows).flat_map(move |j| count(columns).map(move |i| place(i, j)));
    (Rect::new(0.0, 0.0, size.x, size.y), places)
}

/// First and last column and row of the tiles.
struct Tiles {
    columns: (f64, f64),
    rows: (f64, f64),
}

impl Tiles {
    fn of(pattern: &Pattern, bounds: usvg::Rect) -> Tiles {
        let bounds = Rect::new(
            bounds.left().into(),
            bounds.top().into(),
            bounds.right().into(),
            bounds.bottom().into(),
        );
        let area = affine(pattern.transform()).inverse().transform_rect_bbox(bounds);
        let rect = pattern.rect();
        let (x, y) = (f64::from(rect.x()), f64::from(rect.y()));
        let (width, height) = (f64::from(rect.width()), f64::from(rect.height()));
        // The box is of 32-bit floats; a tile more on each side makes no difference.
        let range = |from: f64, to: f64| ((from - 1e-3).floor(), (to + 1e-3).floor());
        Tiles {
            columns: range((area.x0 - x) / width, (area.x1 - x) / width),
            rows: range((area.y0 - y) / height, (area.y1 - y) / height),
        }
    }

    fn count(&self) -> f64 {
        (self.columns.1 - self.columns.0 + 1.0) * (self.rows.1 - self.rows.0 + 1.0)
    }
}

/// How many shapes the tiles have, each counted as one more; not counted further than `most`.
fn shapes_of(pattern: &Pattern, bounds: usvg::Rect, most: f64) -> f64 {
    let count = Tiles::of(pattern, bounds).count();
    count * (1.0 + shapes_in(pattern.root(), most / count))
}

fn shapes_in(group: &Group, most: f64) -> f64 {
    let mut sum = 0.0;
    for node in group.children() {
        let rest = most - sum;
        if rest.is_nan() || rest < 0.0 {
            break;
        }
        sum += match node {
            Node::Group(child) => shapes_in(child, rest),
            Node::Path(path) => shapes_of_path(path, rest),
            Node::Text(text) => shapes_in(text.flattened(), rest),
            Node::Image(image) => match image.kind() {
                usvg::ImageKind::SVG(tree) => shapes_in(tree.root(), rest),
                _ => 1.0,
            },
        };
    }
    sum
}

fn shapes_of_path(path: &Path, most: f64) -> f64 {
    let nested = patterns(path).map(|(pattern, bounds)| shapes_of(pattern, bounds, most));
    1.0 + nested.sum::<f64>()
}
