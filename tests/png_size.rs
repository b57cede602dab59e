//! How large our PNGs are beside what the png crate makes of the same pixels by default.

use std::path::Path;
use toon_raster::encode::{Effort, PngWriter};
use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

const WIDTH: u32 = 1024;
/// Ours may be this many times as large.
const MOST: f64 = 1.25;

fn ours(picture: &Pixmap) -> usize {
    let mut file = Vec::new();
    let mut png =
        PngWriter::new(&mut file, picture.width(), picture.height(), false, Effort::Flat).expect("a writer");
    png.write_rows(picture.data()).expect("rows are written to memory");
    png.finish().expect("a whole picture");
    file.len()
}

fn by_default(picture: &Pixmap) -> usize {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut png = encoder.write_header().expect("a header");
    png.write_image_data(picture.data()).expect("rows are written to memory");
    png.finish().expect("a whole picture");
    file.len()
}

#[test]
fn no_sample_takes_more_than_a_quarter_more_than_by_the_png_crate_s_default() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("samples").flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "svg"));
    files.sort();
    assert!(!files.is_empty());
    let mut renderer = Renderer::new(Settings::default()).expect("settings");
    for file in files {
        let options = Options { fonts: toon_raster::FontSource::none(), ..Default::default() };
        let scene =
            Scene::from_bytes(&std::fs::read(&file).expect("a sample"), &options).expect("a good sample");
        if !scene.warnings().is_empty() {
            // Text, which would need the system's fonts: without it there is no picture to speak of.
            continue;
        }
        let height = (f64::from(WIDTH) * scene.size().height / scene.size().width).round() as u32;
        let picture = renderer.render(&scene, &Viewport::fit(&scene, WIDTH, height)).expect("a picture");
        let (ours, theirs) = (ours(&picture), by_default(&picture));
        let ratio = ours as f64 / theirs as f64;
        println!("{}: {ours} bytes, {theirs} by default: {ratio:.3}", file.display());
        assert!(ratio <= MOST, "{}: {ratio:.3}", file.display());
    }
}
