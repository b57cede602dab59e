//! Takes visible regions with their colours, makes the picture: each region's exact area in each pixel,
//! by Green's theorem, and where the middle of that area is.

use super::region::{Contour, Region};
use crate::edges::ONE;
use crate::scene::paint::Sheet;

/// Areas below this, in pixels, are the rounding of crossings.
const NOTHING: f64 = 1e-9;

/// A picture in the making: for each pixel the colours times their areas, and the areas.
pub(super) struct Sums {
    width: usize,
    height: usize,
    linear: bool,
    colors: Vec<[f64; 4]>,
    areas: Vec<f64>,
    /// A region's edges, cut to rows: the row, and the ends within it, in pixels from the row's top left.
    strips: Vec<(u32, [f64; 4])>,
    cells: Vec<Cell>,
}

/// What lies right of a region's edges in one pixel.
#[derive(Clone, Copy, Default)]
struct Cell {
    /// Within the pixel: area, and its first moments from the pixel's top left corner.
    area: f64,
    moment_x: f64,
    moment_y: f64,
    /// In each pixel further right: height, and its moment from the row's top.
    height: f64,
    height_y: f64,
}

impl Sums {
    pub fn new(width: u32, height: u32, linear: bool) -> Sums {
        let (width, height) = (width as usize, height as usize);
        Sums {
            width,
            height,
            linear,
            colors: vec![[0.0; 4]; width * height],
            areas: vec![0.0; width * height],
            strips: Vec::new(),
            cells: vec![Cell::default(); width + 1],
        }
    }

    /// Adds a region. `color` is asked for its colour at a point in pixels.
    pub fn add(&mut self, region: &Region, mut color: impl FnMut(f64, f64) -> Sheet) {
        self.strips.clear();
        region.contours().for_each(|contour| self.cut_to_rows(contour));
        self.strips.sort_unstable_by_key(|&(row, _)| row);
        let strips = std::mem::take(&mut self.strips);
        for row in strips.chunk_by(|a, b| a.0 == b.0) {
            self.row(row, &mut color);
        }
        self.strips = strips;
    }

    fn cut_to_rows(&mut self, contour: &Contour) {
        let pixels = |v: i32| f64::from(v) / f64::from(ONE);
        for (i, b) in contour.iter().enumerate() {
            let a = contour[(i + contour.len() - 1) % contour.len()];
            let (ax, ay, bx, by) = (pixels(a.x), pixels(a.y), pixels(b.x), pixels(b.y));
            let (top, bottom) = (ay.min(by), ay.max(by));
            for row in top.floor() as usize..(bottom.ceil() as usize).min(self.height) {
                let (upper, lower) = (top.max(row as f64), bottom.min(row as f64 + 1.0));
                let x_at = |y: f64| match y {
                    y if y == ay => ax,
                    y if y == by => bx,
                    y => ax + (bx - ax) * ((y - ay) / (by - ay)),
                };
                let (from, to) = if ay < by { (upper, lower) } else { (lower, upper) };
                let strip = [x_at(from), from - row as f64, x_at(to), to - row as f64];
                self.strips.push((row as u32, strip));
            }
        }
    }

    /// Adds what a region has in one row.
    fn row(&mut self, strips: &[(u32, [f64; 4])], color: &mut impl FnMut(f64, f64) -> Sheet) {
        let y = strips[0].0 as usize;
        let (mut first, mut last) = (self.width, 0);
        for &(_, [x0, y0, x1, y1]) in strips {
            let (left, right) = (x0.min(x1), x0.max(x1));
            let columns = left.floor() as usize..(right.ceil() as usize).max(left.floor() as usize + 1);
            first = first.min(columns.start);
            last = last.max(columns.end);
            let y_at = |x: f64| match x {
                x if x == x0 => y0,
                x if x == x1 => y1,
                x => y0 + (y1 - y0) * ((x - x0) / (x1 - x0)),
            };
            for column in columns {
                let (a, b) = (left.max(column as f64), right.min(column as f64 + 1.0));
                let (from, to) = if x0 < x1 { (a, b) } else { (b, a) };
                let (v0, v1) = if x0 == x1 { (y0, y1) } else { (y_at(from), y_at(to)) };
                let u = |x: f64| x - column as f64;
                self.cells[column].add(u(from), v0, u(to), v1);
            }
        }
        let mut carry = Cell::default();
        for x in first..(last + 1).min(self.width + 1) {
            let cell = std::mem::take(&mut self.cells[x]);
            let area = cell.area + carry.height;
            if x < self.width && area > NOTHING {
                let middle_x = (cell.moment_x + 0.5 * carry.height) / area;
                let middle_y = (cell.moment_y + carry.height_y) / area;
                let at = (x as f64 + middle_x.clamp(0.0, 1.0), y as f64 + middle_y.clamp(0.0, 1.0));
                self.put(y * self.width + x, color(at.0, at.1), area);
            }
            carry.height += cell.height;
            carry.height_y += cell.height_y;
        }
    }

    fn put(&mut self, pixel: usize, sheet: Sheet, area: f64) {
        let sheet = if self.linear { sheet.to_linear() } else { sheet };
        for (sum, channel) in self.colors[pixel].iter_mut().zip(sheet.channels()) {
            *sum += f64::from(channel) * area;
        }
        self.areas[pixel] += area;
    }

    /// Row `y` of the picture, straight RGBA.
    pub fn write(&self, y: usize, pixels: &mut [[u8; 4]]) {
        for (x, pixel) in pixels.iter_mut().enumerate().take(self.width) {
            let at = y * self.width + x;
            let mean = self.colors[at].map(|sum| (sum / self.areas[at]) as f32);
            let sheet = Sheet::from_channels(mean);
            *pixel = if self.linear { sheet.to_srgb() } else { sheet }.to_rgba8();
        }
    }
}

impl Cell {
    /// Adds an edge, whose region lies on its right where it runs upwards; ends in the pixel, 0 ..= 1.
    fn add(&mut self, u0: f64, v0: f64, u1: f64, v1: f64) {
        let (rise, run) = (v0 - v1, u1 - u0);
        self.area += rise * (1.0 - 0.5 * (u0 + u1));
        self.moment_x += 0.5 * rise * (1.0 - (u0 * u0 + u0 * u1 + u1 * u1) / 3.0);
        // The integral of v (1 - u) along the edge, v and u linear.
        let fall = v1 - v0;
        let mean = v0 * (1.0 - u0) + 0.5 * (fall * (1.0 - u0) - v0 * run) - fall * run / 3.0;
        self.moment_y += rise * mean;
        self.height += rise;
        self.height_y += rise * 0.5 * (v0 + v1);
    }
}
