//! Takes a layer's alpha as a height map and a light source, makes the lit layer: feDiffuseLighting
//! and feSpecularLighting (SVG 1.1, 15.14 and 15.22). The eye looks straight down; heights and
//! distances are pixels, the layer's border has normals of its own.

use super::Job;
use crate::effects::highlights::{Aliasing, Phong};
use crate::effects::layer::{pixel_of, unit, IntRect, Layer, Pixel, Space};
use crate::effects::log::LitSurface;
use kurbo::{Affine, Point};
use usvg::filter::{DiffuseLighting, LightSource, SpecularLighting};

/// A vector: right, down, towards the eye.
pub(in crate::effects) type Vector = [f32; 3];

#[inline]
pub(in crate::effects) fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Of length 1; a vector without length stays as it is.
#[inline]
pub(in crate::effects) fn normalized(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    if length > 0.0 {
        v.map(|c| c / length)
    } else {
        v
    }
}

/// feDiffuseLighting: opaque.
pub(super) fn diffuse(heights: &Layer, fe: &DiffuseLighting, space: Space, to_pixels: Affine) -> Layer {
    let light = Light::new(fe.light_source(), to_pixels);
    let surface = Surface::new(heights, fe.surface_scale());
    let color = pixel_of(fe.lighting_color(), 1.0, space);
    lit(&surface, &light, space, |column, row, to_light, lightness| {
        let facing = dot(surface.normal(column, row), to_light);
        let strength = fe.diffuse_constant() * facing * lightness;
        let [r, g, b] = [color[0], color[1], color[2]].map(|c| unit(c * strength));
        [r, g, b, 1.0]
    })
}

/// feSpecularLighting, of the filter with this id: as opaque as it is bright.
pub(super) fn specular(
    heights: &Layer,
    fe: &SpecularLighting,
    space: Space,
    (filter, job): (&str, &Job),
) -> Layer {
    let light = Light::new(fe.light_source(), job.to_canvas);
    let surface = Surface::new(heights, fe.surface_scale());
    if job.log.is_timed() {
        let aliasing = Aliasing::of(&surface, fe.specular_exponent(), job.highlights);
        job.log.lit(LitSurface {
            filter: filter.to_string(),
            exponent: fe.specular_exponent(),
            pixels: surface.rect.area(),
            aliasing: aliasing.pixels,
            sampling_rate: aliasing.sampling_rate,
        });
    }
    let color = pixel_of(fe.lighting_color(), 1.0, space);
    let phong = Phong::new(fe.specular_exponent(), job.highlights);
    lit(&surface, &light, space, |column, row, to_light, lightness| {
        let halfway = normalized([to_light[0], to_light[1], to_light[2] + 1.0]);
        let shine = phong.at(&surface, column, row, halfway);
        let strength = fe.specular_constant() * shine * lightness;
        let [r, g, b] = [color[0], color[1], color[2]].map(|c| unit(c * strength));
        [r, g, b, r.max(g).max(b)]
    })
}

/// Calls `shade` on every pixel: column, row, the direction towards the light, and how much of the
/// light's colour comes from there.
fn lit(
    surface: &Surface,
    light: &Light,
    space: Space,
    shade: impl Fn(usize, usize, Vector, f32) -> Pixel,
) -> Layer {
    let rect = surface.rect;
    let mut layer = Layer::clear(rect, space);
    // Without a pixel that has neighbours on all sides there is no surface to speak of.
    if rect.width() < 3 || rect.height() < 3 {
        return layer;
    }
    for (row, pixels) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let (x, y) = (rect.x() as f32 + column as f32, rect.y() as f32 + row as f32);
            let to_light = light.direction([x, y, surface.height(column, row)]);
            *pixel = shade(column, row, to_light, light.strength(to_light));
        }
    }
    layer
}

/// A height map and its slopes.
///
/// SVG's kernels are the plane of least squares through a pixel and its neighbours, weighted 1 2 1 across
/// and down, at twice its slope: the normal over a spot as Worley has it, not a difference at one point.
/// Where the heights are an image made smaller they are means already, and the plane is that through all
/// of the image under the spot.
pub(in crate::effects) struct Surface {
    rect: IntRect,
    heights: Vec<f32>,
    /// How much the normal leans right and down, for one unit towards the eye.
    leans: Vec<[f32; 2]>,
}

impl Surface {
    fn new(layer: &Layer, scale: f32) -> Surface {
        let heights: Vec<f32> = layer.pixels().iter().map(|p| p[3] * scale).collect();
        let (width, height) = (layer.rect().width(), layer.rect().height());
        let mut leans = vec![[0.0; 2]; heights.len()];
        for (row, leans) in leans.chunks_exact_mut(width.max(1)).enumerate() {
            let down = Lines::around(row, height);
            let rows = down.numbers.map(|row| &heights[row * width..][..width]);
            let (first, last) = (Lines::around(0, width), Lines::around(width - 1, width));
            leans[0] = lean(rows, &down, &first);
            leans[width - 1] = lean(rows, &down, &last);
            for (column, lean_to) in leans.iter_mut().enumerate().take(width - 1).skip(1) {
                *lean_to = lean(rows, &down, &Lines::around(column, width));
            }
        }
        Surface { rect: layer.rect(), heights, leans }
    }

    /// A surface of given leans, row by row.
    #[cfg(test)]
    pub fn leaning(width: usize, leans: Vec<[f32; 2]>) -> Surface {
        let rect = IntRect::new(0, 0, width as u32, (leans.len() / width) as u32);
        Surface { rect, heights: vec![0.0; leans.len()], leans }
    }

    pub fn width(&self) -> usize {
        self.rect.width()
    }

    pub fn rows(&self) -> usize {
        self.rect.height()
    }

    fn height(&self, column: usize, row: usize) -> f32 {
        self.heights[row * self.rect.width() + column]
    }

    #[inline]
    pub fn lean(&self, column: usize, row: usize) -> [f32; 2] {
        self.leans[row * self.rect.width() + column]
    }

    #[inline]
    pub fn normal(&self, column: usize, row: usize) -> Vector {
        let [x, y] = self.lean(column, row);
        normalized([x, y, 1.0])
    }
}

/// A row or column, the one before and the one after it; at a border it is one of these itself.
struct Lines {
    numbers: [usize; 3],
    /// Sobel's; a line beyond the border has none.
    weights: [f32; 3],
    /// From the first to the last.
    span: f32,
}

impl Lines {
    #[inline]
    fn around(line: usize, count: usize) -> Lines {
        let (before, after) = (line.saturating_sub(1), (line + 1).min(count - 1));
        let weight = |other: usize| if other == line { 0.0 } else { 1.0 };
        Lines {
            numbers: [before, line, after],
            weights: [weight(before), 2.0, weight(after)],
            span: (after - before).max(1) as f32,
        }
    }
}

/// How much the normal leans right and down between three rows of heights and three columns.
#[inline]
fn lean(rows: [&[f32]; 3], down: &Lines, across: &Lines) -> [f32; 2] {
    let [left, column, right] = across.numbers;
    let weighted = |[before, own, after]: [f32; 3], differences: [f32; 3]| {
        before * differences[0] + own * differences[1] + after * differences[2]
    };
    let slope_x = weighted(down.weights, rows.map(|row| row[right] - row[left]));
    let slope_y = weighted(across.weights, [left, column, right].map(|at| rows[2][at] - rows[0][at]));
    // Twice the mean slope: the specification's factors 1/4, 1/3, 1/2 and 2/3.
    let factor = |weights: [f32; 3], span: f32| 2.0 / (weights.iter().sum::<f32>() * span);
    [-factor(down.weights, across.span) * slope_x, -factor(across.weights, down.span) * slope_y]
}

/// A light source in pixels.
enum Light {
    /// The same direction everywhere.
    Distant(Vector),
    Point(Vector),
    Spot {
        at: Vector,
        direction: Vector,
        exponent: f32,
        least_cosine: f32,
    },
}

impl Light {
    fn new(source: LightSource, to_pixels: Affine) -> Light {
        let [a, b, c, d, ..] = to_pixels.as_coeffs();
        // A length without direction is scaled by the root of the mean square of the two scales.
        let scale = ((a * a + b * b + c * c + d * d) / 2.0).sqrt();
        let place = |x: f32, y: f32, z: f32| -> Vector {
            let p = to_pixels * Point::new(x.into(), y.into());
            [p.x as f32, p.y as f32, (f64::from(z) * scale) as f32]
        };
        match source {
            LightSource::DistantLight(light) => {
                let (azimuth, elevation) = (light.azimuth.to_radians(), light.elevation.to_radians());
                let level = libm::cosf(elevation);
                Light::Distant([
                    libm::cosf(azimuth) * level,
                    libm::sinf(azimuth) * level,
                    libm::sinf(elevation),
                ])
            }
            LightSource::PointLight(light) => Light::Point(place(light.x, light.y, light.z)),
            LightSource::SpotLight(light) => {
                let at = place(light.x, light.y, light.z);
                let to = place(light.points_at_x, light.points_at_y, light.points_at_z);
                let cone = |degrees: f32| libm::cosf(degrees.to_radians());
                Light::Spot {
                    at,
                    direction: normalized(std::array::from_fn(|i| to[i] - at[i])),
                    exponent: light.specular_exponent.get(),
                    least_cosine: light.limiting_cone_angle.map_or(0.0, cone),
                }
            }
        }
    }

    /// From a place on the surface towards the light, of length 1.
    fn direction(&self, from: Vector) -> Vector {
        match self {
            Light::Distant(direction) => *direction,
            Light::Point(at) | Light::Spot { at, .. } => normalized(std::array::from_fn(|i| at[i] - from[i])),
        }
    }

    /// The share of its colour that goes the opposite way.
    fn strength(&self, to_light: Vector) -> f32 {
        let Light::Spot { direction, exponent, least_cosine, .. } = self else {
            return 1.0;
        };
        let cosine = -dot(to_light, *direction);
        if cosine > 0.0 && cosine >= *least_cosine {
            libm::powf(cosine, *exponent)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope() -> Layer {
        let mut layer = Layer::clear(IntRect::new(0, 0, 5, 5), Space::Srgb);
        for (i, pixel) in layer.pixels_mut().iter_mut().enumerate() {
            pixel[3] = (i % 5) as f32 * 0.1;
        }
        layer
    }

    #[test]
    fn a_plane_has_one_normal_up_to_its_borders() {
        let surface = Surface::new(&slope(), 1.0);
        for row in 0..5 {
            for column in 0..5 {
                let [x, y] = surface.lean(column, row);
                assert!((x + 0.2).abs() < 1e-6 && y.abs() < 1e-6, "{column}, {row}: {x} {y}");
            }
        }
    }

    /// The slopes of the plane of least squares: normal equations, by Cramer's rule.
    fn plane(points: &[(f64, f64, f64, f64)]) -> [f64; 2] {
        // Of weight, x, y and height.
        let sum = |f: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            points.iter().map(|&(weight, x, y, height)| weight * f(x, y, height)).sum()
        };
        let (n, x, y) = (sum(&|_, _, _| 1.0), sum(&|x, _, _| x), sum(&|_, y, _| y));
        let (xx, xy, yy) = (sum(&|x, _, _| x * x), sum(&|x, y, _| x * y), sum(&|_, y, _| y * y));
        let (h, xh, yh) = (sum(&|_, _, h| h), sum(&|x, _, h| x * h), sum(&|_, y, h| y * h));
        let determinant = |m: [[f64; 3]; 3]| {
            let minor = |i: usize, j: usize| m[1][i] * m[2][j] - m[1][j] * m[2][i];
            m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
        };
        let whole = determinant([[n, x, y], [x, xx, xy], [y, xy, yy]]);
        [
            determinant([[n, h, y], [x, xh, xy], [y, yh, yy]]) / whole,
            determinant([[n, x, h], [x, xx, xh], [y, xy, yh]]) / whole,
        ]
    }

    #[test]
    fn the_normal_is_that_of_the_plane_of_least_squares_up_to_the_borders() {
        let mut layer = Layer::clear(IntRect::new(0, 0, 5, 4), Space::Srgb);
        for (i, pixel) in layer.pixels_mut().iter_mut().enumerate() {
            pixel[3] = ((i * 37 + i * i * 11) % 64) as f32 / 64.0;
        }
        let surface = Surface::new(&layer, 1.0);
        for row in 0..4i32 {
            for column in 0..5i32 {
                let mut points = Vec::new();
                for (dx, dy) in (0..9).map(|i| (i % 3 - 1, i / 3 - 1)) {
                    let (x, y) = (column + dx, row + dy);
                    if (0..5).contains(&x) && (0..4).contains(&y) {
                        let weight = f64::from((2 - dx.abs()) * (2 - dy.abs()));
                        points.push((weight, x.into(), y.into(), layer.pixel(x, y)[3].into()));
                    }
                }
                let [x, y] = surface.lean(column as usize, row as usize).map(f64::from);
                let [right, down] = plane(&points);
                let off = (x + 2.0 * right).abs().max((y + 2.0 * down).abs());
                assert!(off < 1e-5, "{column}, {row}: {x} {y}, not twice {right} {down}");
            }
        }
    }

    #[test]
    fn over_a_minified_height_map_the_normal_is_that_of_all_heights_under_the_spot() {
        // A slope with ridges of 3 texels on it, 16 texels a pixel.
        const TEXELS: usize = 16;
        let side = 8 * TEXELS;
        let height = |x: usize, y: usize| {
            0.1 + 0.7 * x as f64 / side as f64 + 0.1 * ((x + 2 * y) % 3) as f64
                - 0.05 * y as f64 / side as f64
        };
        let bytes = (0..side * side).flat_map(|i| [0, 0, 0, (255.0 * height(i % side, i / side)) as u8]);
        let image = crate::texture::Image::new(side as u32, side as u32, bytes.collect());
        let height = |x: usize, y: usize| f64::from(image.bytes()[(y * side + x) * 4 + 3]) / 255.0;
        let small = IntRect::new(0, 0, 8, 8);
        let heights = crate::texture::drawn(&image, Affine::scale(1.0 / TEXELS as f64), small, false);
        let surface = Surface::new(&heights, 1.0);
        let (column, row) = (4usize, 3usize);
        // All texels under the 3 x 3 pixels, each with its pixel's weight.
        let mut points = Vec::new();
        for (x, y) in (0..9 * TEXELS * TEXELS).map(|i| (i % (3 * TEXELS), i / (3 * TEXELS))) {
            let weight = |at: usize| if at / TEXELS == 1 { 2.0 } else { 1.0 };
            let (left, top) = ((column - 1) * TEXELS, (row - 1) * TEXELS);
            let middle = |at: usize| (at as f64 + 0.5) / TEXELS as f64;
            points.push((weight(x) * weight(y), middle(x), middle(y), height(left + x, top + y)));
        }
        let [right, down] = plane(&points);
        let [x, y] = surface.lean(column, row).map(f64::from);
        println!("leans {x:.4} {y:.4}, twice the plane's slope {:.4} {:.4}", -2.0 * right, -2.0 * down);
        assert!((x + 2.0 * right).abs() < 0.01 * 2.0 * right.abs(), "{x}, not twice {right}");
        assert!((y + 2.0 * down).abs() < 0.01 * 2.0 * right.abs(), "{y}, not twice {down}");
        // A difference at one point sees the ridge it stands on.
        let (fine_x, fine_y) = (column * TEXELS + 8, row * TEXELS + 8);
        let difference = (height(fine_x + 1, fine_y) - height(fine_x - 1, fine_y)) * TEXELS as f64 / 2.0;
        assert!((difference - right).abs() > 5.0 * right, "{difference} is not as good as {right}");
    }

    #[test]
    fn a_flat_surface_is_as_bright_as_the_light_stands_high() {
        let surface = Surface::new(&Layer::clear(IntRect::new(0, 0, 3, 3), Space::Srgb), 1.0);
        let light = Light::Distant([0.6, 0.0, 0.8]);
        let lit = lit(&surface, &light, Space::Srgb, |column, row, to_light, strength| {
            [dot(surface.normal(column, row), to_light) * strength, 0.0, 0.0, 1.0]
        });
        assert!(lit.pixels().iter().all(|p| (p[0] - 0.8).abs() < 1e-6));
    }
}
