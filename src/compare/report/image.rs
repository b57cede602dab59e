//! Takes pictures and errors, makes PNG files as text that a page can hold.

use crate::Pixmap;
use base64::prelude::{Engine, BASE64_STANDARD};

/// Columns [x, x + width) and rows [y, y + height) of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Part {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// A picture of straight RGBA.
pub fn picture(pixmap: &Pixmap, part: Part) -> String {
    let bytes = |x: usize, y: usize| {
        let at = y * pixmap.stride() + x * Pixmap::BYTES_PER_PIXEL;
        &pixmap.data()[at..at + part.width as usize * Pixmap::BYTES_PER_PIXEL]
    };
    let rows = (part.y..part.y + part.height).flat_map(|y| bytes(part.x as usize, y as usize));
    data_uri(&rows.copied().collect::<Vec<_>>(), part, png::ColorType::Rgba)
}

/// Errors as grey levels: 255 log2(1 + e) / 8, so that small ones can be told apart. `report.js` turns
/// them into colours and back into errors.
pub fn errors(errors: &[f32], width: u32, part: Part) -> String {
    let grey = |error: f32| ((1.0 + error).log2() * (255.0 / 8.0)).round().clamp(0.0, 255.0) as u8;
    let row = |y: u32| {
        let at = (y * width + part.x) as usize;
        errors[at..at + part.width as usize].iter().map(|&e| grey(e))
    };
    let greys: Vec<u8> = (part.y..part.y + part.height).flat_map(row).collect();
    data_uri(&greys, part, png::ColorType::Grayscale)
}

fn data_uri(pixels: &[u8], part: Part, color: png::ColorType) -> String {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, part.width, part.height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let written = encoder.write_header().and_then(|mut png| png.write_image_data(pixels));
    written.expect("a PNG of its own size can be written to memory");
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&file))
}
