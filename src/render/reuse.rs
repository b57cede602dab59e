//! Takes a scene and pictures of others, makes its picture: tiles that one of them shows at the same place
//! are kept or copied, the rest is rendered. In cel animation most tiles show the same background.
//!
//! Promises: the same bytes as [`Renderer::render`].

use super::{check, Renderer, Viewport};
use crate::band::band_count;
use crate::edges::BAND_ROWS;
use crate::methods::{painter, Painter};
use crate::outlines::{BandLists, Outlines};
use crate::scene::print::Print;
use crate::tiles::{self, tile_columns, Origin, TilePlan, TILE_COLUMNS};
use crate::{Error, Pixmap, Scene};

/// A picture that knows what its tiles were made from.
#[derive(Debug)]
pub struct Canvas {
    picture: Pixmap,
    /// By tile, band by band; empty where nothing is known.
    prints: Vec<Print>,
}

/// Tiles of pictures: in all, and rendered. A tile is 8 rows by 64 columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileCount {
    /// All.
    pub all: u64,
    /// Those of them that no picture at hand showed.
    pub rendered: u64,
}

impl Canvas {
    /// A transparent picture that shows nothing known.
    pub fn new(width: u32, height: u32) -> Canvas {
        Canvas { picture: Pixmap::new(width, height), prints: Vec::new() }
    }

    /// What was rendered.
    pub fn picture(&self) -> &Pixmap {
        &self.picture
    }

    /// Paints a tile, given as columns [x0, x1) and rows [y0, y1), with these pixels, row by row. What it
    /// shows is no longer known.
    pub(crate) fn repaint(&mut self, [x0, y0, x1, y1]: [u32; 4], pixels: impl IntoIterator<Item = [u8; 4]>) {
        let columns = tile_columns(self.picture.width());
        let tile = y0 as usize / BAND_ROWS as usize * columns + x0 as usize / TILE_COLUMNS;
        if let Some(print) = self.prints.get_mut(tile) {
            *print = Print::unique();
        }
        let mut pixels = pixels.into_iter();
        let stride = self.picture.stride();
        let rows = self.picture.data_mut().chunks_exact_mut(stride).take(y1 as usize).skip(y0 as usize);
        let places = rows.flat_map(|row| &mut row.as_chunks_mut::<4>().0[x0 as usize..x1 as usize]);
        places.for_each(|place| *place = pixels.next().expect("there is a pixel for each place"));
    }

    /// The same, for good.
    pub fn into_picture(self) -> Pixmap {
        self.picture
    }

    fn shows(&self, tile: usize, print: Print) -> bool {
        self.prints.get(tile) == Some(&print)
    }

    /// Which tiles are not those of another, as columns [x0, x1) and rows [y0, y1); all, where nothing is
    /// known.
    pub fn tiles_unlike<'a>(&'a self, other: &'a Canvas) -> impl Iterator<Item = [u32; 4]> + 'a {
        let (width, height) = (self.picture.width(), self.picture.height());
        let unlike = move |&tile: &usize| match self.prints.get(tile) {
            Some(&print) => !other.shows(tile, print),
            None => true,
        };
        let tiles = tile_columns(width) * band_count(height);
        (0..tiles).filter(unlike).map(move |tile| place(tile, width, height))
    }

    /// Of all that these rows are made from, and where they are; `None` where that is not known. Rows are counted in whole
    /// tiles.
    pub(crate) fn print_of_rows(&self, from: u32, count: u32) -> Option<Print> {
        let columns = tile_columns(self.picture.width());
        let first = (from / BAND_ROWS) as usize * columns;
        let count = count.div_ceil(BAND_ROWS) as usize * columns;
        let tiles = self.prints.get(first..)?;
        let tiles = tiles.get(..count).unwrap_or(tiles);
        let mut print = Print::new(u64::from(from));
        tiles.iter().for_each(|&tile| print.add_print(tile));
        (!tiles.is_empty()).then_some(print)
    }

    fn is_like(&self, width: u32, height: u32) -> bool {
        (self.picture.width(), self.picture.height()) == (width, height)
    }
}

impl From<Pixmap> for Canvas {
    /// A picture of which nothing is known.
    fn from(picture: Pixmap) -> Canvas {
        Canvas { picture, prints: Vec::new() }
    }
}

impl Renderer {
    /// Renders as [`Renderer::render`] does, onto a canvas. Tiles that it shows already are kept, those that
    /// one of `others` shows are copied. Methods that need the whole picture render it whole.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_onto(
        &mut self,
        canvas: &mut Canvas,
        others: &[&Canvas],
        scene: &Scene,
        viewport: &Viewport,
    ) -> Result<TileCount, Error> {
        check(viewport)?;
        let Viewport { width, height, .. } = *viewport;
        let bands = band_count(height);
        let all = (tile_columns(width) * bands) as u64;
        if !canvas.is_like(width, height) {
            *canvas = Canvas::new(width, height);
        }
        // Should this fail, nothing is known any more.
        let known = std::mem::take(&mut canvas.prints);
        let stride = canvas.picture.stride();
        if self.picture_painter().is_some() {
            self.render_into(scene, viewport, canvas.picture.data_mut(), stride)?;
            return Ok(TileCount { all, rendered: all });
        }
        let by_tiles = match painter(self.settings.method, 1, 1)? {
            Painter::Bands(painter) => painter.keeps_tiles(),
            Painter::Picture(_) => false,
        };
        let shown = |tile: usize, print: Print| match known.get(tile) == Some(&print) {
            true => Origin::Kept,
            false => others
                .iter()
                .position(|c| c.is_like(width, height) && c.shows(tile, print))
                .map_or(Origin::Rendered, Origin::Copied),
        };
        let settings = self.settings.clone();
        let plan = |scene: &Scene, outlines: &Outlines, lists: &BandLists| {
            let prints = tiles::prints(scene, (outlines, lists), viewport, &settings);
            Some(TilePlan::new(width, prints, by_tiles, shown))
        };
        let buffer = canvas.picture.data_mut();
        let plan = self.prepare(scene, viewport, plan, |renderer, picture, bands| {
            let origins = &picture.plan.expect("it was just made").origins;
            let columns = tile_columns(width);
            let tiles = bands.start * columns..bands.end * columns;
            for (tile, origin) in tiles.clone().zip(&origins[tiles]) {
                if let Origin::Copied(other) = *origin {
                    copy(place(tile, width, height), &others[other].picture, buffer);
                }
            }
            let rows = &mut buffer[bands.start * BAND_ROWS as usize * stride..];
            renderer.bands(picture, height, bands.clone(), rows, stride);
            Ok(bands.end)
        })?;
        let TilePlan { origins, prints, .. } = plan.expect("it was made");
        canvas.prints = prints;
        let rendered = origins.iter().filter(|origin| **origin == Origin::Rendered).count() as u64;
        Ok(TileCount { all, rendered })
    }
}

/// The columns [x0, x1) and rows [y0, y1) of a tile.
fn place(tile: usize, width: u32, height: u32) -> [u32; 4] {
    let columns = tile_columns(width);
    let (x, y) = ((tile % columns * TILE_COLUMNS) as u32, (tile / columns) as u32 * BAND_ROWS);
    [x, y, (x + TILE_COLUMNS as u32).min(width), (y + BAND_ROWS).min(height)]
}

/// Copies the pixels at a place of a picture to the same place of another of its size.
fn copy([x0, y0, x1, y1]: [u32; 4], from: &Pixmap, to: &mut [u8]) {
    for y in y0..y1 {
        let at = |x: u32| y as usize * from.stride() + x as usize * Pixmap::BYTES_PER_PIXEL;
        to[at(x0)..at(x1)].copy_from_slice(&from.data()[at(x0)..at(x1)]);
    }
}
