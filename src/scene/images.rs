//! Takes the bytes of image files, makes images; those of drawings with much in common are decoded once.
//!
//! An image that some drawing still shows is found again by its bytes, with the levels that were made of it.
//! Promises: no image is kept for its own sake.

use crate::texture::Image;
use std::collections::HashMap;
use std::io::Cursor;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Images of drawings that are still around, by their bytes.
#[derive(Debug, Default)]
pub(crate) struct Images(Mutex<HashMap<Arc<Vec<u8>>, Weak<Image>>>);

impl Images {
    /// An image; `None` when its bytes are no image, or decoding would take more than 512 MiB.
    pub fn get(&self, bytes: &Arc<Vec<u8>>) -> Option<Arc<Image>> {
        let known = |known: &HashMap<_, Weak<Image>>| known.get(bytes).and_then(Weak::upgrade);
        if let Some(image) = known(&self.0.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Some(image);
        }
        let image = Arc::new(decoded(bytes)?);
        let mut images = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // Another thread may have been faster.
        if let Some(image) = known(&images) {
            return Some(image);
        }
        images.retain(|_, image| image.strong_count() > 0);
        images.insert(bytes.clone(), Arc::downgrade(&image));
        Some(image)
    }
}

fn decoded(bytes: &[u8]) -> Option<Image> {
    const MOST_BYTES: u64 = 512 << 20;
    let mut reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let pixels = reader.decode().ok()?.into_rgba8();
    Some(Image::new(pixels.width(), pixels.height(), pixels.into_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_decoded_once_while_something_shows_it_and_then_dropped() {
        let mut bytes = Cursor::new(Vec::new());
        image::RgbaImage::new(3, 2).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let bytes = bytes.into_inner();
        let images = Images::default();
        let one = images.get(&Arc::new(bytes.clone())).unwrap();
        let other = images.get(&Arc::new(bytes.clone())).unwrap();
        assert!(Arc::ptr_eq(&one, &other));
        let gone = Arc::downgrade(&one);
        drop((one, other));
        assert_eq!(gone.strong_count(), 0);
        assert_eq!(images.get(&Arc::new(bytes)).unwrap().rect().width(), 3);
        assert!(images.get(&Arc::new(vec![1, 2, 3])).is_none());
    }
}
