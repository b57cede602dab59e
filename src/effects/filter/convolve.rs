//! Takes a layer and a kernel, makes the convolved layer (feConvolveMatrix).

use crate::effects::layer::{premultiplied, straight, unit, Layer, Pixel, CLEAR};
use crate::Error;
use std::collections::BTreeMap;
use usvg::filter::{ConvolveMatrix, EdgeMode};

/// Most products of a kernel value and a pixel: some seconds' work.
const MOST_PRODUCTS: u64 = 1 << 32;

/// # Errors
/// [`Error::Limit`] when the kernel is too large for a layer of this size.
pub(super) fn apply(layer: Layer, fe: &ConvolveMatrix) -> Result<Layer, Error> {
    if layer.rect().is_empty() {
        return Ok(layer);
    }
    let taps = within_reach(taps(fe), (layer.rect().width(), layer.rect().height()), fe.edge_mode());
    if taps.len() as u64 * layer.rect().area() > MOST_PRODUCTS {
        return Err(Error::Limit(format!(
            "feConvolveMatrix: a kernel of {} x {} over {} x {} pixels is too much work (make either smaller)",
            fe.matrix().columns(),
            fe.matrix().rows(),
            layer.rect().width(),
            layer.rect().height()
        )));
    }
    let (rect, space) = (layer.rect(), layer.space());
    let (width, height) = (rect.width(), rect.height());
    let mut seen = layer.into_pixels();
    // With preserveAlpha the kernel sees straight colour.
    if fe.preserve_alpha() {
        seen.iter_mut().for_each(|pixel| *pixel = straight(*pixel));
    }
    let (scale, bias) = (1.0 / fe.divisor().get(), fe.bias());
    let mut made = Layer::clear(rect, space);
    let mut sums = vec![CLEAR; width];
    for (y, row) in made.pixels_mut().chunks_exact_mut(width).enumerate() {
        sums.fill(CLEAR);
        for tap in &taps {
            let from = folded(y as i64 + tap.dy, height, fe.edge_mode());
            if let Some(from) = from.map(|y| &seen[y * width..][..width]) {
                tap.add(from, fe.edge_mode(), &mut sums);
            }
        }
        for ((sum, to), seen) in sums.iter().zip(row).zip(&seen[y * width..]) {
            *to = if fe.preserve_alpha() {
                let alpha = seen[3];
                let color = |c: usize| sum[c] * scale + bias * alpha;
                premultiplied([color(0), color(1), color(2), alpha])
            } else {
                let alpha = sum[3] * scale + bias;
                let bounded = unit(alpha);
                // `max` before `min`: NaN becomes 0.
                let color = |c: usize| (sum[c] * scale + bias * alpha).max(0.0).min(bounded);
                [color(0), color(1), color(2), bounded]
            };
        }
    }
    Ok(made)
}

/// A kernel value and the pixel it looks at, relative to the one that is made.
struct Tap {
    dx: i64,
    dy: i64,
    weight: f32,
}

impl Tap {
    /// What it adds to the sums of a row, looking at one.
    fn add(&self, from: &[Pixel], edges: EdgeMode, sums: &mut [Pixel]) {
        let add = |sum: &mut Pixel, pixel: &Pixel| {
            for c in 0..4 {
                sum[c] += self.weight * pixel[c];
            }
        };
        // The part of the row from which it looks at the row itself.
        let width = sums.len() as i64;
        let first = (-self.dx).clamp(0, width);
        let end = (width - self.dx).clamp(first, width);
        let seen = from.iter().skip((first + self.dx).max(0) as usize);
        sums[first as usize..end as usize].iter_mut().zip(seen).for_each(|(sum, pixel)| add(sum, pixel));
        for x in (0..first).chain(end..width) {
            if let Some(column) = folded(x + self.dx, from.len(), edges) {
                add(&mut sums[x as usize], &from[column]);
            }
        }
    }
}

/// The kernel turned half around, as convolution has it, without its zeros.
fn taps(fe: &ConvolveMatrix) -> Vec<Tap> {
    let matrix = fe.matrix();
    let (columns, rows) = (matrix.columns() as usize, matrix.rows() as usize);
    let tap = |(i, &weight): (usize, &f32)| Tap {
        dx: (columns - 1 - i % columns) as i64 - i64::from(matrix.target_x()),
        dy: (rows - 1 - i / columns) as i64 - i64::from(matrix.target_y()),
        weight,
    };
    matrix.data().iter().enumerate().filter(|(_, &weight)| weight != 0.0).map(tap).collect()
}

/// The same without what looks beyond the layer from everywhere in it: there all see nothing, or the same.
fn within_reach(taps: Vec<Tap>, (width, height): (usize, usize), edges: EdgeMode) -> Vec<Tap> {
    let (width, height) = (width as i64, height as i64);
    if taps.iter().all(|tap| tap.dx.abs() < width && tap.dy.abs() < height) {
        return taps;
    }
    let near = |away: i64, length: i64| match edges {
        EdgeMode::None => Some(away).filter(|away| away.abs() < length),
        EdgeMode::Duplicate => Some(away.clamp(-length, length)),
        EdgeMode::Wrap => Some(away % length),
    };
    let mut merged = BTreeMap::new();
    for tap in taps {
        if let (Some(dx), Some(dy)) = (near(tap.dx, width), near(tap.dy, height)) {
            *merged.entry((dy, dx)).or_insert(0.0) += tap.weight;
        }
    }
    merged.into_iter().map(|((dy, dx), weight)| Tap { dx, dy, weight }).collect()
}

/// Where beyond the layer's edge is looked instead.
#[inline]
fn folded(at: i64, length: usize, edges: EdgeMode) -> Option<usize> {
    if (0..length as i64).contains(&at) {
        return Some(at as usize);
    }
    match edges {
        EdgeMode::None => None,
        EdgeMode::Duplicate => Some(at.clamp(0, length as i64 - 1) as usize),
        EdgeMode::Wrap => Some(at.rem_euclid(length as i64) as usize),
    }
}
