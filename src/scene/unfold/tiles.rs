//! Takes a shape painted with a pattern of few tiles, makes the tiles' shapes, clipped to it: so that what
//! is seen of a tile in a pixel through which the shape's border runs is what lies within the border.

use super::{add_group, add_scene, Place};
use crate::outlines::bounds_under;
use crate::scene::paint::Paint;
use crate::scene::raster::{Raster, Source};
use crate::scene::{Clip, ClipId, ClipMember, Geometry, Role, Scene, Shape};
use kurbo::{Affine, Rect};
use std::ops::RangeInclusive;

/// Shapes of all the tiles of one pattern, and those of a scene beyond which no pattern is unfolded.
/// More tiles are faster as pixels.
const MOST_TILED: f64 = 256.0;
const MOST_SHAPES: usize = 1 << 16;

/// The tiles that a shape shows.
pub(super) struct Tiles<'a> {
    raster: &'a Raster,
    tile: &'a Scene,
    /// The tile's place, in the coordinates of the raster.
    place: Rect,
    columns: RangeInclusive<i32>,
    rows: RangeInclusive<i32>,
}

impl<'a> Tiles<'a> {
    /// If the shape is painted with few tiles of plain shapes.
    pub fn of(shape: &'a Shape) -> Option<Tiles<'a>> {
        let Paint::Raster(raster) = &shape.paint else {
            return None;
        };
        let Source::Tiles(tile, place) = &raster.source else {
            return None;
        };
        let bounds = bounds_under(&shape.geometry, raster.transform.inverse());
        let range = |from: f64, to: f64| (from.floor(), to.floor());
        let columns = range((bounds.x0 - place.x0) / place.width(), (bounds.x1 - place.x0) / place.width());
        let rows = range((bounds.y0 - place.y0) / place.height(), (bounds.y1 - place.y0) / place.height());
        let count = (columns.1 - columns.0 + 1.0) * (rows.1 - rows.0 + 1.0);
        // Written so that no number fails it.
        let is_small = count * (tile.shapes.len() as f64) <= MOST_TILED
            && [columns.0, columns.1, rows.0, rows.1].iter().all(|n| n.abs() < 1e6);
        (is_small && !tile.shapes.is_empty() && tile.raster_depth() == 0).then(|| Tiles {
            raster,
            tile,
            place: *place,
            columns: columns.0 as i32..=columns.1 as i32,
            rows: rows.0 as i32..=rows.1 as i32,
        })
    }
}

/// Can a scene take tiles as shapes?
pub(super) fn has_room(scene: &Scene) -> bool {
    scene.shapes.len() < MOST_SHAPES
}

pub(super) fn add_tiles(scene: &mut Scene, shape: &Shape, tiles: &Tiles) {
    let Tiles { raster, tile, place, .. } = tiles;
    let clip = add_clip(scene, shape.geometry.clone(), shape.clip);
    let group = match raster.opacity < 1.0 {
        true => add_group(scene, shape.group, raster.opacity, Role::Paint),
        false => shape.group,
    };
    let within = |shape: &Shape| bounds_under(&shape.geometry, Affine::IDENTITY).union(*place) == *place;
    let overflows = !tile.shapes.iter().all(within);
    for row in tiles.rows.clone() {
        for column in tiles.columns.clone() {
            let step = (f64::from(column) * place.width(), f64::from(row) * place.height());
            let transform = raster.transform * Affine::translate(step);
            let clip = match overflows {
                true => add_clip(scene, Geometry::of_rect(*place, transform), Some(clip)),
                false => clip,
            };
            add_scene(scene, tile, Place { transform, clip: Some(clip), group });
        }
    }
}

fn add_clip(scene: &mut Scene, geometry: Geometry, within: Option<ClipId>) -> ClipId {
    let members = vec![ClipMember { geometry, clip: None }];
    scene.clips.push(Clip { members, within: within.into_iter().collect() });
    (scene.clips.len() - 1) as ClipId
}
