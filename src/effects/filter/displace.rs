//! Takes layers, moves their pixels about: feDisplacementMap and feTile.

use crate::effects::layer::{straight, IntRect, Layer};
use usvg::filter::{ColorChannel, DisplacementMap};

/// feDisplacementMap: each pixel comes from where the map's straight colour says, between pixels
/// bilinearly, so that displaced edges stay anti-aliased; `(scale_x, scale_y)` are pixels by which the
/// greatest and least colour differ.
pub(super) fn displaced(
    layer: &Layer,
    map: &Layer,
    fe: &DisplacementMap,
    (scale_x, scale_y): (f64, f64),
) -> Layer {
    let rect = layer.rect();
    let mut made = Layer::clear(rect, layer.space());
    let (x_channel, y_channel) = (channel(fe.x_channel_selector()), channel(fe.y_channel_selector()));
    for (i, (to, &pixel)) in made.pixels_mut().iter_mut().zip(map.pixels()).enumerate() {
        let pixel = straight(pixel);
        let away = |channel: usize, scale: f64| (f64::from(pixel[channel]) - 0.5) * scale;
        let x = f64::from(rect.x()) + (i % rect.width()) as f64 + away(x_channel, scale_x);
        let y = f64::from(rect.y()) + (i / rect.width()) as f64 + away(y_channel, scale_y);
        *to = layer.between(x, y);
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

/// feTile: the layer's pixels within `tile`, repeated over the whole of it in step with the tile.
pub(super) fn tiled(layer: &Layer, tile: IntRect) -> Layer {
    let rect = layer.rect();
    let mut made = Layer::clear(rect, layer.space());
    // What of the tile lies outside the layer is clear, and is repeated as such.
    if tile.intersect(rect).is_empty() {
        return made;
    }
    let width = tile.width() as i64;
    // The tile's columns that the layer has, and where they begin in the row for the first time.
    let seen = tile.intersect(rect);
    let columns = (seen.x() - rect.x()) as usize..(seen.right() - rect.x()) as usize;
    let start = columns.start as i64 - (columns.end as i64 - 1).div_euclid(width) * width;
    for (row, pixels) in made.pixels_mut().chunks_exact_mut(rect.width().max(1)).enumerate() {
        let down = (i64::from(rect.y()) + row as i64 - i64::from(tile.y())).rem_euclid(tile.height() as i64);
        let y = i64::from(tile.y()) + down - i64::from(rect.y());
        let Some(from) = usize::try_from(y).ok().filter(|y| *y < rect.height()) else { continue };
        let line = &layer.pixels()[from * rect.width()..][columns.clone()];
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
        let tiled = tiled(&layer, IntRect::new(1, 3, 3, 2));
        for y in 0..7 {
            for x in -2..7 {
                let wanted = mark(1 + (x - 1i32).rem_euclid(3), 3 + (y - 3i32).rem_euclid(2));
                assert_eq!(tiled.pixel(x, y), wanted, "at {x}, {y}");
            }
        }
    }
}
