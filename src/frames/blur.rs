//! Takes pictures of moments within one frame, makes their mean: motion blur by an accumulation buffer
//! (Haeberli and Akeley 1990), in the encoding of the pictures or in linear light.
//!
//! Only tiles that some moment shows otherwise than the first are summed: the mean of what rests is the
//! first picture's bytes.

use crate::effects::srgb::{encoded_of_linear, linear_of_encoded};
use crate::render::Canvas;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Columns [x0, x1) and rows [y0, y1).
type Place = [u32; 4];

/// The sum of some pictures of one size.
pub struct Exposure {
    linear: bool,
    /// Of each tile that moves: premultiplied sums, pixel by pixel.
    sums: BTreeMap<Place, Vec<[u64; 4]>>,
    count: u64,
}

/// Linear light of each byte, in parts of 2^24.
static LINEAR: LazyLock<[u64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| (f64::from(linear_of_encoded(byte as f32 / 255.0)) * ONE) as u64)
});

const ONE: f64 = (1 << 24) as f64;

impl Exposure {
    /// Pictures that an exposure has room for.
    pub const MOST: u64 = 1 << 32;

    /// One picture, which must be there again for all that follows. Colours are mixed in linear light if
    /// `linear`, else as they are encoded.
    pub fn new(linear: bool) -> Exposure {
        Exposure { linear, sums: BTreeMap::new(), count: 1 }
    }

    /// Adds a picture of the size of the `first`.
    pub fn add(&mut self, first: &Canvas, picture: &Canvas) {
        debug_assert!(self.count < Exposure::MOST);
        for place in picture.tiles_unlike(first) {
            if !self.sums.contains_key(&place) {
                let mut sums = vec![[0; 4]; ((place[2] - place[0]) * (place[3] - place[1])) as usize];
                add(&mut sums, first, place, self.count, self.linear);
                self.sums.insert(place, sums);
            }
        }
        for (place, sums) in &mut self.sums {
            add(sums, picture, *place, 1, self.linear);
        }
        self.count += 1;
    }

    /// Makes the `first` picture the mean of all.
    pub fn develop(self, first: &mut Canvas) {
        for (place, sums) in &self.sums {
            let mean = |(sum, first)| mean(sum, self.count, self.linear).unwrap_or(first);
            let means: Vec<[u8; 4]> = sums.iter().copied().zip(pixels(first, *place)).map(mean).collect();
            first.repaint(*place, means);
        }
    }
}

/// Adds a tile's pixels so many times.
fn add(sums: &mut [[u64; 4]], canvas: &Canvas, place: Place, times: u64, linear: bool) {
    for (sum, pixel) in sums.iter_mut().zip(pixels(canvas, place)) {
        let alpha = u64::from(pixel[3]) * times;
        for channel in 0..3 {
            let light = if linear { LINEAR[usize::from(pixel[channel])] } else { pixel[channel].into() };
            sum[channel] += alpha * light;
        }
        sum[3] += alpha;
    }
}

/// A tile's pixels, row by row.
fn pixels(canvas: &Canvas, [x0, y0, x1, y1]: Place) -> impl Iterator<Item = [u8; 4]> + '_ {
    let picture = canvas.picture();
    let rows = picture.data().chunks_exact(picture.stride()).take(y1 as usize).skip(y0 as usize);
    rows.flat_map(move |row| row.as_chunks::<4>().0[x0 as usize..x1 as usize].iter().copied())
}

/// `None` where nothing was seen: what rests there keeps its bytes, which may tell a colour.
fn mean(sum: [u64; 4], count: u64, linear: bool) -> Option<[u8; 4]> {
    let alpha = sum[3];
    if alpha == 0 {
        return None;
    }
    let straight = |channel: u64| match linear {
        true => (encoded_of_linear((channel as f64 / alpha as f64 / ONE) as f32) * 255.0 + 0.5) as u8,
        false => ((channel + alpha / 2) / alpha) as u8,
    };
    let opacity = (alpha + count / 2) / count;
    Some([straight(sum[0]), straight(sum[1]), straight(sum[2]), opacity as u8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pixmap;

    fn dot(pixel: [u8; 4]) -> Canvas {
        let mut dot = Pixmap::new(1, 1);
        dot.data_mut().copy_from_slice(&pixel);
        dot.into()
    }

    fn mean(pixels: &[[u8; 4]], linear: bool) -> [u8; 4] {
        let mut first = dot(pixels[0]);
        let mut exposure = Exposure::new(linear);
        pixels[1..].iter().for_each(|&pixel| exposure.add(&first, &dot(pixel)));
        exposure.develop(&mut first);
        first.picture().pixel(0, 0)
    }

    #[test]
    fn what_does_not_move_keeps_its_bytes() {
        for byte in 0..=255 {
            for pixel in [[byte, 255 - byte, 50, 255], [byte, 100, 50, 7], [byte, 100, 50, 0]] {
                assert_eq!(mean(&[pixel; 5], false), pixel);
                assert_eq!(mean(&[pixel; 5], true), pixel);
            }
        }
        assert_eq!(mean(&[[0; 4]; 3], true), [0; 4]);
    }

    #[test]
    fn a_shape_seen_half_the_time_is_half_transparent_in_its_own_colour() {
        for linear in [false, true] {
            assert_eq!(mean(&[[200, 100, 50, 255], [0; 4]], linear), [200, 100, 50, 128]);
        }
        assert_eq!(mean(&[[255, 0, 0, 255], [0, 0, 255, 255]], false), [128, 0, 128, 255]);
    }

    #[test]
    fn in_linear_light_half_of_the_light_is_188() {
        assert_eq!(mean(&[[255, 255, 255, 255], [0, 0, 0, 255]], true), [188, 188, 188, 255]);
        assert_eq!(mean(&[[255, 255, 255, 255], [0, 0, 0, 255]], false), [128, 128, 128, 255]);
    }
}
