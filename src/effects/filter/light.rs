//! Takes a layer's alpha as a height map and a light source, makes the lit layer: feDiffuseLighting
//! and feSpecularLighting (SVG 1.1, 15.14 and 15.22). The eye looks straight down; heights and
//! distances are pixels, the layer's border has normals of its own.

use super::Job;
use crate::effects::highlights::{powers, Aliasing, Phong};
use crate::effects::layer::{pixel_of, unit, IntRect, Layer, Pixel, Space};
use crate::effects::log::LitSurface;
use kurbo::{Affine, Point};
use std::rc::Rc;
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
pub(super) fn diffuse(input: Rc<Layer>, fe: &DiffuseLighting, space: Space, to_pixels: Affine) -> Layer {
    let heights = Heights::of(&input, fe.surface_scale());
    let light = Light::new(fe.light_source(), to_pixels);
    let color = pixel_of(fe.lighting_color(), 1.0, space);
    let shown = |share: f32| {
        let strength = fe.diffuse_constant() * share;
        let [r, g, b, _] = color.map(|c| unit(c * strength));
        [r, g, b, 1.0]
    };
    lit((&heights, input), &light, space, |_, row| row.face(), shown)
}

/// feSpecularLighting, of the filter with this id: as opaque as it is bright.
pub(super) fn specular(
    input: Rc<Layer>,
    fe: &SpecularLighting,
    space: Space,
    (filter, job): (&str, &Job),
) -> Layer {
    let heights = Heights::of(&input, fe.surface_scale());
    let light = Light::new(fe.light_source(), job.to_canvas);
    if job.log.is_timed() {
        let aliasing = Aliasing::of(&Surface::of(&heights), fe.specular_exponent(), job.highlights);
        job.log.lit(LitSurface {
            filter: filter.to_string(),
            exponent: fe.specular_exponent(),
            pixels: heights.rect.area(),
            aliasing: aliasing.pixels,
            sampling_rate: aliasing.sampling_rate,
        });
    }
    let color = pixel_of(fe.lighting_color(), 1.0, space);
    let shown = |share: f32| {
        let strength = fe.specular_constant() * share;
        let [r, g, b, _] = color.map(|c| unit(c * strength));
        [r, g, b, r.max(g).max(b)]
    };
    let phong = Phong::new(fe.specular_exponent(), job.highlights);
    let surface = phong.cures().then(|| Surface::of(&heights));
    let shade = |number: usize, row: &mut Row| {
        row.turn_halfway();
        row.face();
        powers(&mut row.shares, fe.specular_exponent());
        let Some(surface) = &surface else { return };
        for column in 0..surface.width() {
            let halfway = normalized(row.toward.each_ref().map(|v| v[column]));
            if let Some(cured) = phong.cured(surface, column, number, halfway) {
                row.shares[column] = cured;
            }
        }
    };
    lit((&heights, input), &light, space, shade, shown)
}

/// Lights a surface row by row: `shade` makes the shares of its light that a row sends to the eye, `shown` the
/// colour of a share. The pixels are in the place of those that the heights were read from, if nobody else looks at these.
fn lit(
    (heights, input): (&Heights, Rc<Layer>),
    light: &Light,
    space: Space,
    shade: impl Fn(usize, &mut Row),
    shown: impl Fn(f32) -> Pixel,
) -> Layer {
    let rect = heights.rect;
    // Without a pixel that has neighbours on all sides there is no surface to speak of.
    if rect.width() < 3 || rect.height() < 3 {
        return Layer::clear(rect, space);
    }
    let mut layer = match Rc::try_unwrap(input) {
        Ok(own) => own.taken_for(space),
        Err(_) => Layer::clear(rect, space),
    };
    let mut row = Row::new(rect.width());
    for (number, pixels) in layer.pixels_mut().chunks_exact_mut(rect.width()).enumerate() {
        heights.leans(number, &mut row.leans);
        light.shine_on(heights, number, &mut row);
        shade(number, &mut row);
        for ((pixel, &share), &lightness) in pixels.iter_mut().zip(&row.shares).zip(&row.lightness) {
            *pixel = shown(share * lightness);
        }
    }
    layer
}

/// One row of a surface and the light on it, in step.
struct Row {
    /// How much the normals lean right and down, for one unit towards the eye.
    leans: [Vec<f32>; 2],
    /// Towards the light, or halfway between light and eye; of any length.
    toward: [Vec<f32>; 3],
    /// How much of the light's colour comes from there.
    lightness: Vec<f32>,
    /// The share of it that the surface sends to the eye.
    shares: Vec<f32>,
}

impl Row {
    fn new(width: usize) -> Row {
        let zeros = || vec![0.0; width];
        Row {
            leans: [zeros(), zeros()],
            toward: [zeros(), zeros(), zeros()],
            lightness: vec![1.0; width],
            shares: zeros(),
        }
    }

    /// From towards the light to halfway between light and eye.
    fn turn_halfway(&mut self) {
        let [x, y, z] = &mut self.toward;
        for ((x, y), z) in x.iter().zip(&*y).zip(z) {
            *z += (x * x + y * y + *z * *z).sqrt();
        }
    }

    /// Shares are the cosines between the normals and what they are to face; no number where that has no
    /// length.
    fn face(&mut self) {
        let ([across, down], [x, y, z]) = (&self.leans, &self.toward);
        let normals = across.iter().zip(down);
        let toward = x.iter().zip(y).zip(z);
        for ((share, (&a, &d)), ((&x, &y), &z)) in self.shares.iter_mut().zip(normals).zip(toward) {
            // One root and one division for both lengths.
            let lengths = (a * a + d * d + 1.0) * (x * x + y * y + z * z);
            *share = (a * x + d * y + z) / lengths.sqrt();
        }
    }
}

/// A height map.
///
/// SVG's kernels are the plane of least squares through a pixel and its neighbours, weighted 1 2 1 across
/// and down, at twice its slope: the normal over a spot as Worley has it, not a difference at one point.
/// Where the heights are an image made smaller they are means already, and the plane is that through all
/// of the image under the spot.
struct Heights {
    rect: IntRect,
    /// In pixels, row by row.
    values: Vec<f32>,
}

impl Heights {
    fn of(layer: &Layer, scale: f32) -> Heights {
        Heights { rect: layer.rect(), values: layer.pixels().iter().map(|p| p[3] * scale).collect() }
    }

    fn row(&self, number: usize) -> &[f32] {
        &self.values[number * self.rect.width()..][..self.rect.width()]
    }

    /// How much the normals of a row lean right and down, for one unit towards the eye.
    fn leans(&self, row: usize, [across, down]: &mut [Vec<f32>; 2]) {
        let width = self.rect.width();
        let lines = Lines::around(row, self.rect.height());
        let rows = lines.numbers.map(|row| self.row(row));
        for column in [0, width - 1] {
            [across[column], down[column]] = lean(rows, &lines, &Lines::around(column, width));
        }
        if width < 3 {
            return;
        }
        // All others have the same weights.
        let inside = Lines::around(1, 3);
        let columns = across[1..width - 1].iter_mut().zip(&mut down[1..width - 1]);
        let [above, own, below] = rows.map(|row| row.windows(3));
        for ((across, down), ((above, own), below)) in columns.zip(above.zip(own).zip(below)) {
            [*across, *down] = lean([above, own, below], &lines, &inside);
        }
    }
}

/// The slopes of a height map.
pub(in crate::effects) struct Surface {
    rect: IntRect,
    /// How much the normal leans right and down, for one unit towards the eye.
    leans: Vec<[f32; 2]>,
}

impl Surface {
    fn of(heights: &Heights) -> Surface {
        let rect = heights.rect;
        let mut row = [vec![0.0; rect.width()], vec![0.0; rect.width()]];
        let mut leans = Vec::with_capacity(heights.values.len());
        for number in 0..rect.height() {
            heights.leans(number, &mut row);
            leans.extend(row[0].iter().zip(&row[1]).map(|(&across, &down)| [across, down]));
        }
        Surface { rect, leans }
    }

    /// A surface of given leans, row by row.
    #[cfg(test)]
    pub fn leaning(width: usize, leans: Vec<[f32; 2]>) -> Surface {
        let rect = IntRect::new(0, 0, width as u32, (leans.len() / width) as u32);
        Surface { rect, leans }
    }

    pub fn width(&self) -> usize {
        self.rect.width()
    }

    pub fn rows(&self) -> usize {
        self.rect.height()
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

    /// Says where the light of a row of the surface comes from, and how much of it.
    fn shine_on(&self, heights: &Heights, number: usize, row: &mut Row) {
        let rect = heights.rect;
        let [x, y, z] = &mut row.toward;
        match self {
            Light::Distant(direction) => {
                x.fill(direction[0]);
                y.fill(direction[1]);
                z.fill(direction[2]);
            }
            Light::Point(at) | Light::Spot { at, .. } => {
                let left = rect.x() as f32;
                x.iter_mut().enumerate().for_each(|(column, x)| *x = at[0] - (left + column as f32));
                y.fill(at[1] - (rect.y() as f32 + number as f32));
                z.iter_mut().zip(heights.row(number)).for_each(|(z, height)| *z = at[2] - height);
            }
        }
        if let Light::Spot { .. } = self {
            for (column, lightness) in row.lightness.iter_mut().enumerate() {
                *lightness = self.strength(normalized([x[column], y[column], z[column]]));
            }
        }
    }

    /// The share of its colour that goes the opposite way of this one, of length 1.
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
        let surface = Surface::of(&Heights::of(&slope(), 1.0));
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
        let surface = Surface::of(&Heights::of(&layer, 1.0));
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
        let surface = Surface::of(&Heights::of(&heights, 1.0));
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
        let flat = Rc::new(Layer::clear(IntRect::new(0, 0, 3, 3), Space::Srgb));
        let heights = Heights::of(&flat, 1.0);
        let light = Light::Distant([0.6, 0.0, 0.8]);
        let lit = lit((&heights, flat), &light, Space::Srgb, |_, row| row.face(), |share| [share; 4]);
        assert!(lit.pixels().iter().all(|p| (p[0] - 0.8).abs() < 1e-6));
    }

    #[test]
    fn a_place_the_light_touches_is_dark_and_no_nan() {
        let flat = Rc::new(Layer::clear(IntRect::new(0, 0, 3, 3), Space::Srgb));
        let heights = Heights::of(&flat, 1.0);
        let light = Light::Point([1.0, 1.0, 0.0]);
        let lit = lit((&heights, flat), &light, Space::Srgb, |_, row| row.face(), |share| [unit(share); 4]);
        assert_eq!(lit.pixel(1, 1), [0.0; 4]);
    }
}
