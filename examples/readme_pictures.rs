//! Draws README's picture: `cargo run --release --example readme_pictures` writes `docs/seams.png`.
//!
//! Two samples, each rendered small by resvg (left) and by this crate (right), a part of it enlarged so
//! that single pixels can be seen.

use resvg::{tiny_skia, usvg};
use std::error::Error;
use std::path::Path;
use toon_raster::{Pixmap, Renderer, Scene, Settings, Viewport};

/// How many times the pixels are enlarged.
const ZOOM: usize = 7;
/// White pixels between the pictures.
const GAP: usize = 14;

/// A part of a sample, in pixels of its rendering at `width`.
struct Detail {
    sample: &'static str,
    width: u32,
    left: usize,
    top: usize,
}

/// Columns and rows of each detail.
const PART: (usize, usize) = (60, 40);

const DETAILS: [Detail; 2] = [
    Detail { sample: "island.svg", width: 200, left: 62, top: 48 },
    Detail { sample: "abutting.svg", width: 260, left: 12, top: 12 },
];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let cell = (PART.0 * ZOOM, PART.1 * ZOOM);
    let width = 2 * cell.0 + GAP;
    let height = DETAILS.len() * (cell.1 + GAP) - GAP;
    let mut sheet = vec![255; width * height * 3];
    for (row, detail) in DETAILS.iter().enumerate() {
        let svg = std::fs::read(root.join("samples").join(detail.sample))?;
        let tree = usvg::Tree::from_data(&svg, &usvg::Options::default())?;
        for (column, picture) in
            [elsewhere(&tree, detail.width)?, here(&tree, detail.width)?].iter().enumerate()
        {
            let corner = (column * (cell.0 + GAP), row * (cell.1 + GAP));
            enlarge(picture, detail, &mut sheet, width, corner);
        }
    }
    write_png(&root.join("docs/seams.png"), &sheet, width, height)
}

/// Rows that keep the drawing's shape.
fn height_for(tree: &usvg::Tree, width: u32) -> u32 {
    (tree.size().height() * width as f32 / tree.size().width()).round() as u32
}

fn here(tree: &usvg::Tree, width: u32) -> Result<Pixmap, toon_raster::Error> {
    let scene = Scene::from_tree(tree)?;
    let viewport = Viewport::fit(&scene, width, height_for(tree, width));
    Renderer::new(Settings::default())?.render(&scene, &viewport)
}

fn elsewhere(tree: &usvg::Tree, width: u32) -> Result<Pixmap, toon_raster::Error> {
    let height = height_for(tree, width);
    let scale = tiny_skia::Transform::from_scale(
        width as f32 / tree.size().width(),
        height as f32 / tree.size().height(),
    );
    let mut drawn = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| toon_raster::Error::Size("the picture is empty".to_string()))?;
    resvg::render(tree, scale, &mut drawn.as_mut());
    let mut picture = Pixmap::new(width, height);
    for (to, from) in picture.data_mut().chunks_exact_mut(4).zip(drawn.pixels()) {
        let from = from.demultiply();
        to.copy_from_slice(&[from.red(), from.green(), from.blue(), from.alpha()]);
    }
    Ok(picture)
}

/// Copies the detail into the RGB sheet at `corner`, each pixel as a square.
fn enlarge(picture: &Pixmap, detail: &Detail, sheet: &mut [u8], sheet_width: usize, corner: (usize, usize)) {
    for y in 0..PART.1 * ZOOM {
        for x in 0..PART.0 * ZOOM {
            let from = ((detail.left + x / ZOOM) as u32, (detail.top + y / ZOOM) as u32);
            let [r, g, b, _] = picture.pixel(from.0, from.1);
            let at = ((corner.1 + y) * sheet_width + corner.0 + x) * 3;
            sheet[at..at + 3].copy_from_slice(&[r, g, b]);
        }
    }
}

fn write_png(path: &Path, rgb: &[u8], width: usize, height: usize) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(std::fs::File::create(path)?, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(())
}
