//! Takes a rectangle of the picture, fills it with Perlin's noise by SVG's reference algorithm
//! (feTurbulence; SVG 1.1, 15.24): the same random numbers and lattice, so the same picture wherever
//! it is drawn. Stitching takes the primitive's subregion, in user units, for the tile.

use crate::effects::layer::{premultiplied, IntRect, Layer, Pixel, Space};
use kurbo::{Affine, Point, Rect};
use usvg::filter::{Turbulence, TurbulenceKind};

/// The noise over `rect`, in the primitive's own space; `tile` in user units.
pub(super) fn noise(fe: &Turbulence, space: Space, rect: IntRect, to_pixels: Affine, tile: Rect) -> Layer {
    let mut layer = Layer::clear(rect, space);
    if to_pixels.determinant() == 0.0 || !to_pixels.is_finite() || rect.is_empty() {
        return layer;
    }
    let to_user = to_pixels.inverse();
    let field = Field::new(fe, tile);
    for (row, pixels) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
        let y = f64::from(rect.y()) + row as f64;
        for (column, pixel) in pixels.iter_mut().enumerate() {
            // At the pixel's corner, as the reference algorithm is called everywhere.
            let point = to_user * Point::new(f64::from(rect.x()) + column as f64, y);
            *pixel = premultiplied(field.at(point));
        }
    }
    layer
}

/// The noise half a pixel up and left of where [`noise`] looks, over one column and one row more: the
/// corners of a spot around each of its points.
pub(super) fn corners(fe: &Turbulence, space: Space, rect: IntRect, to_pixels: Affine, tile: Rect) -> Layer {
    let rect = IntRect::from_edges(
        rect.x().into(),
        rect.y().into(),
        i64::from(rect.right()) + 1,
        i64::from(rect.bottom()) + 1,
    );
    noise(fe, space, rect, Affine::translate((0.5, 0.5)) * to_pixels, tile)
}

/// Octaves beyond these add less than a millionth.
const MOST_OCTAVES: u32 = 20;

/// Noise in user space.
struct Field {
    lattice: Lattice,
    frequency: (f64, f64),
    octaves: u32,
    fractal: bool,
    stitch: Option<Stitch>,
}

/// Where lattice points wrap around, for one octave.
#[derive(Clone, Copy)]
struct Stitch {
    width: i64,
    height: i64,
    wrap_x: i64,
    wrap_y: i64,
}

/// Keeps lattice coordinates of points near the origin positive.
const LATTICE_OFFSET: f64 = 4096.0;

impl Field {
    fn new(fe: &Turbulence, tile: Rect) -> Field {
        let mut frequency = (f64::from(fe.base_frequency_x().get()), f64::from(fe.base_frequency_y().get()));
        let mut stitch = None;
        if fe.stitch_tiles() {
            frequency.0 = whole_cycles(frequency.0, tile.width());
            frequency.1 = whole_cycles(frequency.1, tile.height());
            let cycles = |size: f64, frequency: f64| (size * frequency + 0.5) as i64;
            let (width, height) = (cycles(tile.width(), frequency.0), cycles(tile.height(), frequency.1));
            stitch = Some(Stitch {
                width,
                height,
                wrap_x: (tile.x0 * frequency.0 + LATTICE_OFFSET + width as f64) as i64,
                wrap_y: (tile.y0 * frequency.1 + LATTICE_OFFSET + height as f64) as i64,
            });
        }
        Field {
            lattice: Lattice::new(fe.seed()),
            frequency,
            octaves: fe.num_octaves().min(MOST_OCTAVES),
            fractal: fe.kind() == TurbulenceKind::FractalNoise,
            stitch,
        }
    }

    /// Straight RGBA, not clamped.
    fn at(&self, point: Point) -> Pixel {
        let (mut x, mut y) = (point.x * self.frequency.0, point.y * self.frequency.1);
        let (mut sum, mut share, mut stitch) = ([0.0f32; 4], 1.0f32, self.stitch);
        for _ in 0..self.octaves {
            let octave = self.lattice.noise(x, y, stitch);
            for c in 0..4 {
                sum[c] += share * if self.fractal { octave[c] } else { octave[c].abs() };
            }
            (x, y, share) = (x * 2.0, y * 2.0, share * 0.5);
            stitch = stitch.map(Stitch::doubled);
        }
        if self.fractal {
            sum.map(|v| (v + 1.0) * 0.5)
        } else {
            sum
        }
    }
}

impl Stitch {
    fn doubled(self) -> Stitch {
        let offset = LATTICE_OFFSET as i64;
        Stitch {
            width: self.width.saturating_mul(2),
            height: self.height.saturating_mul(2),
            wrap_x: self.wrap_x.saturating_mul(2).saturating_sub(offset),
            wrap_y: self.wrap_y.saturating_mul(2).saturating_sub(offset),
        }
    }
}

/// The frequency nearest by ratio at which a tile of this size holds whole cycles.
fn whole_cycles(frequency: f64, size: f64) -> f64 {
    if frequency == 0.0 {
        return frequency;
    }
    let (low, high) = ((size * frequency).floor() / size, (size * frequency).ceil() / size);
    if frequency / low < high / frequency {
        low
    } else {
        high
    }
}

/// Lattice points of the noise.
const POINTS: usize = 256;

/// A permutation and, at each lattice point, a gradient for each of the four channels.
struct Lattice {
    permutation: [u8; POINTS],
    /// x of the four channels, then y.
    gradients: Vec<[[f32; 4]; 2]>,
}

impl Lattice {
    fn new(seed: i32) -> Lattice {
        let mut random = Random::new(seed);
        let mut gradients = vec![[[0.0f32; 4]; 2]; POINTS];
        for channel in 0..4 {
            for gradient in &mut gradients {
                let mut component = || {
                    let side = POINTS as i64;
                    (random.next() % (2 * side) - side) as f64 / side as f64
                };
                let (x, y) = (component(), component());
                let length = (x * x + y * y).sqrt();
                // The generator has no zero vector for any seed that is tested; NaN must not be made.
                if length > 0.0 {
                    gradient[0][channel] = (x / length) as f32;
                    gradient[1][channel] = (y / length) as f32;
                }
            }
        }
        let mut permutation: [u8; POINTS] = std::array::from_fn(|i| i as u8);
        for i in (1..POINTS).rev() {
            permutation.swap(i, (random.next() % POINTS as i64) as usize);
        }
        Lattice { permutation, gradients }
    }

    /// One octave at a point in lattice units: about -1 ..= 1 a channel.
    fn noise(&self, x: f64, y: f64, stitch: Option<Stitch>) -> [f32; 4] {
        let (x, y) = (x + LATTICE_OFFSET, y + LATTICE_OFFSET);
        let (column, row) = (x.floor(), y.floor());
        let (rx, ry) = ((x - column) as f32, (y - row) as f32);
        if !(rx.is_finite() && ry.is_finite()) {
            return [0.0; 4];
        }
        // Saturating casts; the sums below stay far from the ends because of the mask.
        let wrapped = |at: i64, wrap: Option<(i64, i64)>| match wrap {
            Some((from, by)) if at >= from => at - by,
            _ => at,
        };
        let (wrap_x, wrap_y) = (stitch.map(|s| (s.wrap_x, s.width)), stitch.map(|s| (s.wrap_y, s.height)));
        let (left, top) = ((column as i64).min(i64::MAX - 1), (row as i64).min(i64::MAX - 1));
        let index = |at: i64, wrap| wrapped(at, wrap) as usize % POINTS;
        let (left, right) = (index(left, wrap_x), index(left + 1, wrap_x));
        let (top, bottom) = (index(top, wrap_y), index(top + 1, wrap_y));
        let point = |column: usize, row: usize| {
            let first = usize::from(self.permutation[column]);
            &self.gradients[usize::from(self.permutation[(first + row) % POINTS])]
        };
        let corners = [point(left, top), point(right, top), point(left, bottom), point(right, bottom)];
        let (share_x, share_y) = (eased(rx), eased(ry));
        std::array::from_fn(|c| {
            let slope = |corner: &[[f32; 4]; 2], x: f32, y: f32| x * corner[0][c] + y * corner[1][c];
            let upper = between(share_x, slope(corners[0], rx, ry), slope(corners[1], rx - 1.0, ry));
            let lower =
                between(share_x, slope(corners[2], rx, ry - 1.0), slope(corners[3], rx - 1.0, ry - 1.0));
            between(share_y, upper, lower)
        })
    }
}

fn eased(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

fn between(share: f32, one: f32, other: f32) -> f32 {
    one + share * (other - one)
}

/// Park and Miller's generator, as SVG has it.
struct Random(i64);

impl Random {
    const MODULUS: i64 = 2_147_483_647;

    fn new(seed: i32) -> Random {
        let seed = i64::from(seed);
        let seed = if seed <= 0 { -seed % (Self::MODULUS - 1) + 1 } else { seed };
        Random(seed.min(Self::MODULUS - 1))
    }

    fn next(&mut self) -> i64 {
        self.0 = self.0 * 16_807 % Self::MODULUS;
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_gives_the_specifications_number() {
        // SVG 1.1, 15.24: "a test: seed 1, result after 10,000 calls".
        let mut random = Random::new(1);
        (0..9_999).for_each(|_| {
            random.next();
        });
        assert_eq!(random.next(), 1_043_618_065);
        for seed in [i32::MIN, -1, 0, i32::MAX] {
            let mut random = Random::new(seed);
            assert!((1..Random::MODULUS).contains(&random.next()));
        }
    }

    #[test]
    fn noise_is_nothing_at_lattice_points_and_bounded_between() {
        let lattice = Lattice::new(7);
        assert_eq!(lattice.noise(3.0, -5.0, None), [0.0; 4]);
        for i in 0..1000 {
            let octave = lattice.noise(f64::from(i) * 0.37, f64::from(i) * -1.13, None);
            assert!(octave.iter().all(|v| v.abs() <= 1.0));
        }
        for absurd in [1e300, f64::INFINITY, f64::NAN, -1e300] {
            assert!(lattice.noise(absurd, 0.5, None).iter().all(|v| v.is_finite()));
        }
    }

    #[test]
    fn stitched_noise_meets_itself_at_the_tiles_borders() {
        let stitch = Stitch { width: 4, height: 3, wrap_x: 4096 + 4, wrap_y: 4096 + 3 };
        let lattice = Lattice::new(3);
        for i in 0..50 {
            let t = f64::from(i) * 0.06;
            let (left, right) =
                (lattice.noise(1e-9, t, Some(stitch)), lattice.noise(4.0 - 1e-9, t, Some(stitch)));
            let (top, bottom) =
                (lattice.noise(t, 1e-9, Some(stitch)), lattice.noise(t, 3.0 - 1e-9, Some(stitch)));
            for c in 0..4 {
                assert!((left[c] - right[c]).abs() < 1e-5 && (top[c] - bottom[c]).abs() < 1e-5);
            }
        }
    }
}
