//! Takes pictures of moments within one frame, makes their mean: motion blur by an accumulation buffer
//! (Haeberli and Akeley 1990), in the encoding of the pictures.

use crate::Pixmap;

/// The sum of some pictures, premultiplied: 255 x 255 a channel and picture at most.
pub struct Exposure {
    width: u32,
    height: u32,
    sums: Vec<u32>,
    count: u32,
}

impl Exposure {
    /// Pictures that an exposure has room for.
    pub const MOST: u32 = u32::MAX / (255 * 255);

    /// Nothing yet, of the size of `picture`.
    pub fn new(picture: &Pixmap) -> Exposure {
        let (width, height) = (picture.width(), picture.height());
        Exposure { width, height, sums: vec![0; picture.data().len()], count: 0 }
    }

    /// Adds a picture of the same size.
    pub fn add(&mut self, picture: &Pixmap) {
        debug_assert_eq!((picture.width(), picture.height()), (self.width, self.height));
        debug_assert!(self.count < Exposure::MOST);
        self.count += 1;
        for (sum, pixel) in self.sums.as_chunks_mut::<4>().0.iter_mut().zip(picture.data().as_chunks::<4>().0)
        {
            let alpha = u32::from(pixel[3]);
            for channel in 0..3 {
                sum[channel] += alpha * u32::from(pixel[channel]);
            }
            sum[3] += alpha;
        }
    }

    /// The mean of what was added.
    pub fn mean(&self) -> Pixmap {
        let mut mean = Pixmap::new(self.width, self.height);
        for (pixel, sum) in
            mean.data_mut().as_chunks_mut::<4>().0.iter_mut().zip(self.sums.as_chunks::<4>().0)
        {
            let alpha = sum[3];
            if alpha > 0 {
                let straight = |channel: u32| ((channel + alpha / 2) / alpha) as u8;
                let opacity = (alpha + self.count / 2) / self.count;
                *pixel = [straight(sum[0]), straight(sum[1]), straight(sum[2]), opacity as u8];
            }
        }
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(pixel: [u8; 4]) -> Pixmap {
        let mut dot = Pixmap::new(1, 1);
        dot.data_mut().copy_from_slice(&pixel);
        dot
    }

    fn mean(pixels: &[[u8; 4]]) -> [u8; 4] {
        let mut exposure = Exposure::new(&dot([0; 4]));
        pixels.iter().for_each(|&pixel| exposure.add(&dot(pixel)));
        exposure.mean().pixel(0, 0)
    }

    #[test]
    fn what_does_not_move_keeps_its_bytes() {
        for pixel in [[1, 2, 3, 255], [200, 100, 50, 7], [0; 4]] {
            assert_eq!(mean(&[pixel; 5]), pixel);
        }
    }

    #[test]
    fn a_shape_seen_half_the_time_is_half_transparent_in_its_own_colour() {
        assert_eq!(mean(&[[200, 100, 50, 255], [0; 4]]), [200, 100, 50, 128]);
        assert_eq!(mean(&[[255, 0, 0, 255], [0, 0, 255, 255]]), [128, 0, 128, 255]);
    }
}
