//! Takes the outlines of a scene, sorted into bands, makes a print of each tile of the picture: of all
//! that its pixels are made from. A tile whose print another picture has at the same place looks the same
//! there, to the byte.
//!
//! A tile is a band's rows by [`TILE_COLUMNS`] columns. It sees the shapes whose bounds touch it, front to
//! back, each with its paint, clip and groups; and how the picture is made. Bands need nothing of each
//! other, and a pixel nothing of shapes that do not touch it: that makes prints enough.

use crate::edges::{Bounds, BAND_ROWS};
use crate::outlines::{BandLists, Outlines};
use crate::scene::print::{self, Print};
use crate::scene::{Group, GroupId, Role, Scene};
use crate::{Settings, Viewport};
use std::borrow::Cow;

/// Words of a band's bitmap in one row of a tile.
const TILE_WORDS: usize = 1;

/// Columns of a tile.
pub(crate) const TILE_COLUMNS: usize = 64 * TILE_WORDS;

/// Tiles side by side in a picture of this many columns.
pub(crate) fn tile_columns(width: u32) -> usize {
    (width as usize).div_ceil(TILE_COLUMNS)
}

/// The print of each tile, band by band.
pub(crate) fn prints(
    scene: &Scene,
    (outlines, bands): (&Outlines, &BandLists),
    viewport: &Viewport,
    settings: &Settings,
) -> Vec<Print> {
    let columns = tile_columns(viewport.width);
    let count = viewport.height.div_ceil(BAND_ROWS) as usize;
    let shapes = match scene.prints.len() == scene.shapes.len() {
        true => Cow::Borrowed(&scene.prints),
        false => Cow::Owned(print::of_shapes(scene)),
    };
    let groups = Groups::new(scene);
    let mut prints = vec![of_setup(viewport, settings); columns * count];
    // The group of the last shape that each tile of a band saw.
    let mut last: Vec<GroupId> = Vec::new();
    for (band, tiles) in prints.chunks_exact_mut(columns).enumerate() {
        last.clear();
        last.resize(columns, 0);
        for &number in bands.band(band) {
            let Some(bounds) = outlines.shapes[number as usize].bounds else { continue };
            let (print, group) = (shapes[number as usize], scene.shapes[number as usize].group);
            let touched = bounds.left / TILE_COLUMNS..=(bounds.right - 1) / TILE_COLUMNS;
            for (tile, last) in tiles[touched.clone()].iter_mut().zip(&mut last[touched]) {
                if group | *last != 0 {
                    groups.enter(*last, group, tile);
                    *last = group;
                }
                tile.add_print(print);
            }
        }
    }
    prints
}

/// The print of what holds for all tiles.
pub(crate) fn of_setup(viewport: &Viewport, settings: &Settings) -> Print {
    let Viewport { width, height, transform } = viewport;
    // The threads do not matter, nor do the times.
    let Settings {
        method, tolerance, linear, background, most_work, highlights, index_aa, spot_scale, ..
    } = settings;
    let transform = transform.as_coeffs().map(f64::to_bits);
    let look = (method, tolerance.to_bits(), linear, background, most_work, highlights);
    let spots = (index_aa, spot_scale.to_bits());
    print::of_bytes(format!("{width} {height} {transform:?} {look:?} {spots:?}").as_bytes())
}

/// The groups of a scene: which of them are around which.
struct Groups<'a> {
    scene: &'a Scene,
    /// From the picture inwards.
    paths: Vec<Vec<GroupId>>,
}

impl Groups<'_> {
    fn new(scene: &Scene) -> Groups<'_> {
        let paths = (0..scene.groups.len() as GroupId).map(|group| scene.group_path(group)).collect();
        Groups { scene, paths }
    }

    /// Tells a tile that after a shape in one group it sees one in another: how many groups stay open, and
    /// what those are like that open.
    fn enter(&self, from: GroupId, to: GroupId, tile: &mut Print) {
        let (from, to) = (&self.paths[from as usize], &self.paths[to as usize]);
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        tile.add((common as u64) << 32 | to.len() as u64);
        for (depth, &group) in to.iter().enumerate().skip(common) {
            let Group { opacity, role, .. } = &self.scene.groups[group as usize];
            let role = match *role {
                Role::Paint => 0,
                Role::Blend(mode) => 0x100 | mode as u64,
                Role::Mask(kind) => 0x200 | kind as u64,
                // Is its mask what the tile saw last, or is there nothing of that here?
                Role::Masked(mask) => 0x300 | u64::from(from.get(depth) == Some(&mask)),
            };
            tile.add(u64::from(opacity.to_bits()) | role << 32);
        }
    }
}

/// Where the pixels of a tile come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// They stand in the picture already.
    Kept,
    /// Another picture, by its number.
    Copied(usize),
    Rendered,
}

/// Where all tiles of a picture come from.
pub(crate) struct TilePlan {
    columns: usize,
    /// By tile, band by band.
    pub origins: Vec<Origin>,
    pub prints: Vec<Print>,
}

impl TilePlan {
    /// Of a picture this wide: `origin` tells where a tile with this number and print comes from. Without
    /// `by_tiles` a band is rendered whole if any of its tiles is.
    pub fn new(
        width: u32,
        prints: Vec<Print>,
        by_tiles: bool,
        origin: impl Fn(usize, Print) -> Origin,
    ) -> TilePlan {
        let columns = tile_columns(width);
        let mut origins: Vec<Origin> =
            prints.iter().enumerate().map(|(tile, &print)| origin(tile, print)).collect();
        if !by_tiles {
            for band in origins.chunks_mut(columns).filter(|band| band.contains(&Origin::Rendered)) {
                band.fill(Origin::Rendered);
            }
        }
        TilePlan { columns, origins, prints }
    }

    /// The tiles of a band.
    fn band(&self, band: usize) -> &[Origin] {
        &self.origins[band * self.columns..][..self.columns]
    }

    /// Is nothing of a band rendered?
    pub fn leaves(&self, band: usize) -> bool {
        !self.band(band).contains(&Origin::Rendered)
    }

    /// Does a shape with these bounds touch a tile that is rendered?
    pub fn renders(&self, bounds: Bounds) -> bool {
        let bands = bounds.top / BAND_ROWS as usize..=(bounds.bottom - 1) / BAND_ROWS as usize;
        let tiles = bounds.left / TILE_COLUMNS..=(bounds.right - 1) / TILE_COLUMNS;
        bands.into_iter().any(|band| self.band(band)[tiles.clone()].contains(&Origin::Rendered))
    }

    /// Does a word of a band's bitmap, counted within its row, belong to a tile that is not rendered?
    pub fn leaves_word(&self, band: usize, word: usize) -> bool {
        self.band(band)[word / TILE_WORDS] != Origin::Rendered
    }
}
