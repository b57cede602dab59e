//! Takes a pattern's tile, makes the layer of a shape that is painted with it: tiles drawn one by one, or copies of
//! one.

use super::Artist;
use crate::effects::layer::{between, IntRect, Layer, Pixel, Space, CLEAR};
use crate::scene::{Clip, ClipMember, Geometry, Scene};
use crate::Error;
use kurbo::{Affine, Point, Rect, Vec2};
use std::ops::Range;

/// Tiles of a pattern that are drawn one by one, and the shapes in all of them; beyond, tiles are copies
/// of one tile's pixels.
const MOST_TILES: f64 = 1024.0;
const MOST_TILED_SHAPES: f64 = 16384.0;

/// A tile that is copied is made in no more pixels than this a side.
const LARGEST_TILE: f64 = 2048.0;

impl Artist<'_> {
    pub(super) fn tiles(
        &self,
        (tile, place): (&Scene, Rect),
        to_pixels: Affine,
        rect: IntRect,
    ) -> Result<Layer, Error> {
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
pub(super) fn plane_of(tile: &Scene, place: Rect, to_pixels: Affine, rect: IntRect) -> Option<Scene> {
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
