//! Takes a scene and a viewport, makes slabs: bands of the picture whose layers are held at once. Where all
//! of the layers fit, the picture is one slab. Else they are made slab by slab, over its rows only, and memory does
//! not grow with their number.
//!
//! Promises: the slabs do not depend on threads. The picture is the one made whole but for rounding, and for the
//! points of methods that draw lots by where a pixel stands in its layer.

use crate::band::band_count;
use crate::edges::BAND_ROWS;
use crate::effects::layer::IntRect;
use crate::layers::{held_rect, place_of};
use crate::scene::paint::Paint;
use crate::{Error, Scene, Viewport};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::Arc;

/// Pixels of layers that are held at once: 512 MB, and half of that for layers within a layer. What lies deeper is
/// made whole: slabs overlap, and at each depth more would be drawn twice.
const PIXELS_AT_ONCE: u64 = 1 << 25;

/// Pixels of the layers of one slab, which is one band at least: 4 GB.
const MOST_PIXELS: u64 = 1 << 28;

/// Pixels of all layers of a picture, those within layers as well, however often they are made.
const MOST_WORK: u64 = 1 << 30;

/// Rows around a slab that its bands may look at: a point on a band's lower border is in the row below, and so
/// it is again for what is drawn there.
const MARGIN: i64 = 2;

/// What the layers of a picture may cost, or those within a layer of it.
#[derive(Clone, Debug)]
pub(crate) struct Budget {
    /// Pixels of layers that are held at once, and of those within one of them.
    at_once: u64,
    at_once_within: u64,
    /// Pixels so far, of the picture and all that is drawn for it.
    work: Arc<AtomicU64>,
}

impl Default for Budget {
    fn default() -> Budget {
        Budget { at_once: PIXELS_AT_ONCE, at_once_within: PIXELS_AT_ONCE / 2, work: Arc::default() }
    }
}

impl Budget {
    /// For what is drawn for a layer.
    pub fn within(&self) -> Budget {
        Budget { at_once: self.at_once_within, at_once_within: MOST_PIXELS, work: self.work.clone() }
    }

    /// Counts one more layer, over these pixels.
    ///
    /// # Errors
    /// [`Error::Limit`] when all layers so far are too much work.
    pub fn afford(&self, rect: IntRect) -> Result<(), Error> {
        match self.work.fetch_add(rect.area(), Relaxed) + rect.area() > MOST_WORK {
            true => Err(too_much_work()),
            false => Ok(()),
        }
    }
}

fn too_much_work() -> Error {
    Error::Limit(format!(
        "filters, masks and patterns would take more than {MOST_WORK} pixels, those within one another as \
         well (flatten them, or render a smaller picture)"
    ))
}

/// How a picture is cut into slabs.
pub(crate) struct Slabs {
    width: u32,
    height: u32,
    at_once: u64,
    /// Pixels of all layers, were they held at once.
    all: u64,
    /// Those of each band; empty where the picture is one slab.
    of_bands: Vec<u64>,
}

/// Bands whose layers are held at once.
pub(crate) struct Slab {
    pub bands: Range<usize>,
    /// The pixels to make layers over.
    pub rect: IntRect,
    /// Is it the whole picture?
    pub is_whole: bool,
}

impl Slabs {
    /// # Errors
    /// [`Error::Limit`] when the layers of a band would hold too many pixels, or all of them are too much work.
    pub fn of(scene: &Scene, viewport: &Viewport, budget: &Budget) -> Result<Slabs, Error> {
        let rasters = || {
            scene.shapes.iter().filter_map(|shape| match &shape.paint {
                Paint::Raster(raster) => Some((&**raster, shape)),
                _ => None,
            })
        };
        let held = |(raster, shape)| held_rect(raster, shape, viewport).area();
        let Viewport { width, height, .. } = *viewport;
        let all: u64 = rasters().map(held).sum();
        let mut slabs = Slabs { width, height, at_once: budget.at_once, all, of_bands: Vec::new() };
        if all > MOST_WORK {
            return Err(too_much_work());
        }
        if all > budget.at_once {
            slabs.of_bands =
                pixels_of_bands(rasters().map(|(raster, shape)| place_of(raster, shape, viewport).1), height);
        }
        match slabs.of_bands.iter().any(|&pixels| pixels > MOST_PIXELS) {
            true => Err(Error::Limit(format!(
                "filters, masks and patterns would hold more than {MOST_PIXELS} pixels (render a smaller picture)"
            ))),
            false => Ok(slabs),
        }
    }

    /// Of a scene whose layers are all held.
    pub fn whole(viewport: &Viewport) -> Slabs {
        let Viewport { width, height, .. } = *viewport;
        Slabs { width, height, at_once: 0, all: 0, of_bands: Vec::new() }
    }

    /// The slab that begins with a band: as many as have room together.
    pub fn from(&self, first: usize) -> Slab {
        let bands = band_count(self.height);
        let mut end = if self.of_bands.is_empty() { bands } else { first + 1 };
        let mut pixels = self.of_bands.get(first).copied().unwrap_or_default();
        while end < bands && pixels + self.of_bands[end] <= self.at_once {
            pixels += self.of_bands[end];
            end += 1;
        }
        let row = |band: usize| band as i64 * i64::from(BAND_ROWS);
        let rows = IntRect::from_edges(0, row(first) - MARGIN, self.width.into(), row(end) + MARGIN);
        Slab {
            bands: first..end,
            rect: rows.intersect(IntRect::new(0, 0, self.width, self.height)),
            is_whole: self.of_bands.is_empty(),
        }
    }

    /// Pixels of layers that are held at once, at most.
    pub fn most_held(&self) -> u64 {
        let of_band = self.of_bands.iter().copied().max().unwrap_or_default();
        self.all.min(of_band.max(self.at_once))
    }
}

/// How many pixels of some rectangles lie in each band.
fn pixels_of_bands(rects: impl Iterator<Item = IntRect>, height: u32) -> Vec<u64> {
    // How many more of them each row has than the one above.
    let mut more = vec![0i64; height as usize + 1];
    for rect in rects.filter(|rect| !rect.is_empty()) {
        more[rect.y() as usize] += rect.width() as i64;
        more[rect.bottom() as usize] -= rect.width() as i64;
    }
    let mut row = 0;
    let of_band = |rows: &[i64]| {
        let of_row = |&more: &i64| {
            row += more;
            row as u64
        };
        rows.iter().map(of_row).sum()
    };
    more[..height as usize].chunks(BAND_ROWS as usize).map(of_band).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, Options, Renderer, Settings};

    fn drawn(scene: &Scene, method: Method, at_once: u64) -> Vec<u8> {
        let viewport = Viewport::fit(scene, 150, 100);
        let budget = Budget { at_once, ..Budget::default() };
        let slabs = Slabs::of(scene, &viewport, &budget).expect("a small picture");
        assert_eq!(slabs.from(0).is_whole, at_once == u64::MAX);
        let settings = Settings { threads: 2, ..Settings::of(method) };
        let mut renderer = Renderer::for_layer(settings, budget).expect("good settings");
        let mut rows = Vec::new();
        let whole = renderer.render(scene, &viewport).expect("a picture");
        let take = |some: &[u8]| {
            rows.extend_from_slice(some);
            Ok(())
        };
        renderer.render_bands(scene, &viewport, take).expect("a picture");
        assert_eq!(whole.data(), rows, "{method}");
        rows
    }

    #[test]
    fn a_picture_in_slabs_is_the_one_made_whole_but_for_rounding() {
        let svg =
            std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/effects.svg")).expect("a sample");
        let scene = Scene::from_bytes(&svg, &Options::default()).expect("a drawing");
        let methods =
            [Method::Exact, Method::Mask, Method::Mask64, Method::None, Method::Grid(4), Method::Area];
        for method in methods {
            let whole = drawn(&scene, method, u64::MAX);
            for at_once in [1, 20_000] {
                let cut = drawn(&scene, method, at_once);
                let off = whole.iter().zip(&cut).map(|(a, b)| a.abs_diff(*b));
                assert!(off.clone().all(|off| off <= 1), "{method}, {at_once}: {:?}", off.max());
                let differ = off.filter(|&off| off > 0).count();
                assert!(differ * 1000 < whole.len(), "{method}, {at_once}: {differ} bytes differ");
            }
        }
    }

    #[test]
    fn slabs_are_as_high_as_there_is_room_and_one_band_at_least() {
        let rows = |y, height| IntRect::new(3, y, 10, height);
        let of_bands = pixels_of_bands([rows(0, 30), rows(7, 2), IntRect::EMPTY].into_iter(), 30);
        assert_eq!(of_bands, [90, 90, 80, 60]);
        let slabs = |at_once| Slabs { width: 20, height: 30, at_once, all: 320, of_bands: of_bands.clone() };
        let cut = |slabs: &Slabs| {
            let mut bands = vec![slabs.from(0).bands];
            while bands[bands.len() - 1].end < 4 {
                bands.push(slabs.from(bands[bands.len() - 1].end).bands);
            }
            bands
        };
        assert_eq!(cut(&slabs(1)), [0..1, 1..2, 2..3, 3..4]);
        assert_eq!(cut(&slabs(180)), [0..2, 2..4]);
        assert_eq!(cut(&slabs(170)), [0..1, 1..3, 3..4]);
        assert_eq!(slabs(1).from(1).rect, IntRect::new(0, 6, 20, 12));
        assert_eq!(slabs(1).from(3).rect, IntRect::new(0, 22, 20, 8));
    }
}
