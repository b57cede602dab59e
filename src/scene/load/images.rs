//! Takes what image elements refer to, makes usvg's image kinds: embedded data, and regular files. A
//! link may name a device that never ends, or the drawing itself: files have a largest size, and
//! drawings within drawings are read without their own images.

use super::guard;
use super::{decode, parse_xml};
use crate::Options;
use std::sync::Arc;
use usvg::ImageKind;

/// Bytes of an image file: 64 MiB.
const MOST_BYTES: u64 = 64 << 20;

/// Opens images under the limits of the drawing that holds them, and with its fonts.
pub(super) fn resolver(outer: &Options) -> usvg::ImageHrefResolver<'_> {
    usvg::ImageHrefResolver {
        resolve_data: Box::new(|_, data, options| {
            Some(kind(data, options, outer).unwrap_or_else(placeholder))
        }),
        resolve_string: Box::new(|link, options| {
            let found = file(link, options).and_then(|data| kind(data, options, outer));
            Some(found.unwrap_or_else(placeholder))
        }),
    }
}

/// Opens none.
fn closed() -> usvg::ImageHrefResolver<'static> {
    usvg::ImageHrefResolver {
        resolve_data: Box::new(|_, _, _| Some(placeholder())),
        resolve_string: Box::new(|_, _| Some(placeholder())),
    }
}

fn file(link: &str, options: &usvg::Options) -> Option<Arc<Vec<u8>>> {
    let path = options.get_abs_path(std::path::Path::new(link));
    let about = std::fs::metadata(&path).ok()?;
    if !about.is_file() || about.len() > MOST_BYTES {
        return None;
    }
    std::fs::read(&path).ok().map(Arc::new)
}

/// By its first bytes, whatever it is said to be.
fn kind(data: Arc<Vec<u8>>, options: &usvg::Options, outer: &Options) -> Option<ImageKind> {
    match image::guess_format(&data) {
        Ok(image::ImageFormat::Png) => Some(ImageKind::PNG(data)),
        Ok(image::ImageFormat::Jpeg) => Some(ImageKind::JPEG(data)),
        Ok(image::ImageFormat::Gif) => Some(ImageKind::GIF(data)),
        Ok(image::ImageFormat::WebP) => Some(ImageKind::WEBP(data)),
        _ => drawing(&data, options, outer).map(ImageKind::SVG),
    }
}

fn drawing(data: &[u8], options: &usvg::Options, outer: &Options) -> Option<usvg::Tree> {
    let limits = &outer.limits;
    let text = decode::text(data, limits.bytes).ok()?;
    decode::check_entities(&text, limits.bytes).ok()?;
    let xml = parse_xml(&text).ok()?;
    let census = guard::check(&xml, None, limits).ok()?;
    if !census.circles.is_empty() || census.depth > super::SHALLOW {
        return None;
    }
    let inner = usvg::Options {
        fontdb: super::fonts(outer, census.has_text),
        font_family: options.font_family.clone(),
        font_size: options.font_size,
        languages: options.languages.clone(),
        dpi: options.dpi,
        image_href_resolver: closed(),
        ..usvg::Options::default()
    };
    super::parse_guarded(&xml, &inner).ok()
}

/// Stands for a picture that could not be opened: the header of a PNG of one pixel.
fn placeholder() -> ImageKind {
    const HEADER: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x06\0\0\0\x1f\x15\xc4\x89";
    ImageKind::PNG(Arc::new(HEADER.to_vec()))
}
