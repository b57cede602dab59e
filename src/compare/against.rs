//! Takes the bytes of another renderer's picture, makes it one of ours: a PNG of any kind to straight
//! 8-bit RGBA.

use crate::{Error, Pixmap};
use image::ImageFormat;

/// Decodes a PNG; 16 bits become 8, greys and palettes become colours.
///
/// # Errors
/// [`Error::Parse`] for other bytes.
pub fn decode(bytes: &[u8]) -> Result<Pixmap, Error> {
    let picture = image::load_from_memory_with_format(bytes, ImageFormat::Png)
        .map_err(|e| Error::Parse(format!("not a PNG that can be read: {e}")))?
        .into_rgba8();
    let mut pixmap = Pixmap::new(picture.width(), picture.height());
    pixmap.data_mut().copy_from_slice(picture.as_raw());
    Ok(pixmap)
}
