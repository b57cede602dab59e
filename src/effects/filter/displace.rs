//! Takes layers, moves their pixels about: feDisplacementMap and feTile.

use crate::effects::layer::{straight, IntRect, Layer};
use usvg::filter::{ColorChannel, DisplacementMap};

/// feDisplacementMap: each pixel comes from where the map's straight colour says, between pixels
/// bilinearly, so that displaced edges stay anti-aliased; `(scale_x, scale_y)` are pixels by which the
/// greatest and least colour differ.
pub(super) fn displaced(
    layer: &Layer,
    map: Layer,
    fe: &DisplacementMap,
    (scale_x, scale_y): (f64, f64),
) -> Layer {
    let rect = map.rect();
    let mut made = map.taken_for(layer.space());
    let (x_channel, y_channel) = (channel(fe.x_channel_selector()), channel(fe.y_channel_selector()));
    for (row, pixels) in made.pixels_mut().chunks_exact_mut(rect.width().max(1)).enumerate() {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let color = straight(*pixel);
            let away = |channel: usize, scale: f64| (f64::from(color[channel]) - 0.5) * scale;
            let x = f64::from(rect.x()) + column as f64 + away(x_channel, scale_x);
            let y = f64::from(rect.y()) + row as f64 + away(y_channel, scale_y);
            *pixel = layer.between(x, y);
        }
    }
    made
}

fn channel(channel: ColorChannel) -> usize {
    match channel {
        ColorChannel::R => 0,
        ColorChannel::G => 1,
        ColorChannel::B => 2,
        ColorChannel::A => 3,
    }
}

/// feTile: the layer's pixels within `tile`, repeated over `region` in step with the tile. What of the tile
/// lies outside the layer or the region is clear, and is repeated as such.
pub(super) fn tiled(layer: &Layer, tile: IntRect, region: IntRect) -> Layer {
    let mut made = Layer::clear(region, layer.space());
    let seen = tile.intersect(layer.rect()).intersect(region);
    if seen.is_empty() {
        return made;
    }
    let width = tile.width() as i64;
    // Where the tile's columns begin in the row for the first time.
    let first = i64::from(seen.x() - region.x());
    let start = first - (first + seen.width() as i64 - 1).div_euclid(width) * width;
    for (row, pixels) in made.pixels_mut().chunks_exact_mut(region.width()).enumerate() {
        let below = i64::from(region.y()) + row as i64 - i64::from(tile.y());
        let y = tile.y() + below.rem_euclid(tile.height() as i64) as i32;
        if !(seen.y()..seen.bottom()).contains(&y) {
            continue;
        }
        let line = layer.span(y, seen);
        let mut at = start;
        while at < pixels.len() as i64 {
            // Its first repetition may begin left of the row.
            let (to, cut) = (at.max(0) as usize, (-at).max(0) as usize);
            let line = &line[cut..];
            let count = line.len().min(pixels.len() - to);
            pixels[to..to + count].copy_from_slice(&line[..count]);
            at += width;
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer::{Pixel, Space};

    #[test]
    fn tiles_repeat_both_ways_from_where_the_tile_stands() {
        let mut layer = Layer::clear(IntRect::new(-2, 0, 9, 7), Space::Srgb);
        let width = layer.rect().width();
        let mark = |x: i32, y: i32| -> Pixel { [0.1, 0.2, (x * 3 + y) as f32 / 100.0, 1.0] };
        for y in 3..5 {
            for x in 1..4 {
                layer.pixels_mut()[y as usize * width + (x + 2) as usize] = mark(x, y);
            }
        }
        let tiled = tiled(&layer, IntRect::new(1, 3, 3, 2), layer.rect());
        for y in 0..7 {
            for x in -2..7 {
                let wanted = mark(1 + (x - 1i32).rem_euclid(3), 3 + (y - 3i32).rem_euclid(2));
                assert_eq!(tiled.pixel(x, y), wanted, "at {x}, {y}");
            }
        }
    }
}
