//! Takes what image elements refer to, makes usvg's image kinds: embedded data, and regular files. A
//! link may name a device that never ends, or the drawing itself: files have a largest size, one by one
//! and in all, and drawings within drawings are read without their own images.
//!
//! Promises: a file is read once for a drawing, and a drawing in it parsed once, however often it is used.

use super::guard;
use super::{decode, parse_xml};
use crate::Options;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use usvg::ImageKind;

/// Bytes of an image file: 64 MiB.
const MOST_BYTES: u64 = 64 << 20;
/// Bytes of all of them: 256 MiB.
const MOST_BYTES_IN_ALL: u64 = 256 << 20;

/// Pixels of an image's side.
const MOST_SIDE: u32 = 1 << 24;

/// What the images of one drawing have called for so far.
#[derive(Default)]
struct Opened {
    files: HashMap<PathBuf, Option<ImageKind>>,
    /// Bytes of the files.
    bytes: u64,
    /// Elements of drawings, again wherever one is used: the parser's tree has a copy for each.
    elements: u64,
}

/// Opens images under the limits of the drawing that holds them, and with its fonts.
pub(super) fn resolver(outer: &Options) -> usvg::ImageHrefResolver<'_> {
    let opened = Arc::new(Mutex::new(Opened::default()));
    let (of_data, of_files) = (opened.clone(), opened);
    usvg::ImageHrefResolver {
        resolve_data: Box::new(move |_, data, options| {
            let image = kind(data, options, outer);
            Some(image.filter(|image| is_affordable(image, &of_data, outer)).unwrap_or_else(placeholder))
        }),
        resolve_string: Box::new(move |link, options| {
            let image = linked(link, options, outer, &of_files);
            Some(image.filter(|image| is_affordable(image, &of_files, outer)).unwrap_or_else(placeholder))
        }),
    }
}

/// Within the limit on elements, which this use of the image counts towards.
fn is_affordable(image: &ImageKind, opened: &Mutex<Opened>, outer: &Options) -> bool {
    let (ImageKind::SVG(tree), Ok(mut opened)) = (image, opened.lock()) else { return true };
    opened.elements = opened.elements.saturating_add(elements(tree.root()));
    opened.elements <= outer.limits.elements
}

fn elements(group: &usvg::Group) -> u64 {
    let of_node = |node: &usvg::Node| match node {
        usvg::Node::Group(inner) => elements(inner),
        usvg::Node::Text(text) => elements(text.flattened()),
        usvg::Node::Path(_) | usvg::Node::Image(_) => 1,
    };
    1 + group.children().iter().map(of_node).sum::<u64>()
}

/// What a link leads to.
fn linked(link: &str, options: &usvg::Options, outer: &Options, opened: &Mutex<Opened>) -> Option<ImageKind> {
    let path = options.get_abs_path(std::path::Path::new(link));
    let mut opened = opened.lock().ok()?;
    if let Some(known) = opened.files.get(&path) {
        return known.clone();
    }
    let image = file(&path, &mut opened.bytes).and_then(|data| kind(data, options, outer));
    opened.files.insert(path, image.clone());
    image
}

fn file(path: &std::path::Path, so_far: &mut u64) -> Option<Arc<Vec<u8>>> {
    let about = std::fs::metadata(path).ok()?;
    if !about.is_file() || about.len() > MOST_BYTES || about.len() > MOST_BYTES_IN_ALL - *so_far {
        return None;
    }
    let data = std::fs::read(path).ok()?;
    *so_far = (*so_far + data.len() as u64).min(MOST_BYTES_IN_ALL);
    Some(Arc::new(data))
}

/// Opens none.
fn closed() -> usvg::ImageHrefResolver<'static> {
    usvg::ImageHrefResolver {
        resolve_data: Box::new(|_, _, _| Some(placeholder())),
        resolve_string: Box::new(|_, _| Some(placeholder())),
    }
}

/// By its first bytes, whatever it is said to be.
fn kind(data: Arc<Vec<u8>>, options: &usvg::Options, outer: &Options) -> Option<ImageKind> {
    match image::guess_format(&data) {
        Ok(image::ImageFormat::Png) => (!is_too_long(&data)).then_some(ImageKind::PNG(data)),
        Ok(image::ImageFormat::Jpeg) => Some(ImageKind::JPEG(data)),
        Ok(image::ImageFormat::Gif) => Some(ImageKind::GIF(data)),
        Ok(image::ImageFormat::WebP) => Some(ImageKind::WEBP(data)),
        _ => drawing(&data, options, outer).map(ImageKind::SVG),
    }
}

/// Does a PNG claim to be longer than the parser can count? All other formats have less room to.
fn is_too_long(png: &[u8]) -> bool {
    let sides = png.get(16..24).unwrap_or_default().as_chunks::<4>().0;
    sides.iter().any(|&side| u32::from_be_bytes(side) > MOST_SIDE)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn made(name: &str, bytes: &[u8]) -> PathBuf {
        let path = std::env::temp_dir().join(format!("toon-raster-image-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).expect("a temporary file");
        path
    }

    #[test]
    fn a_linked_image_is_read_once_however_often_it_is_used() {
        let path = made("once.png", b"\x89PNG\r\n\x1a\n and more");
        let link = path.to_str().expect("a name in UTF-8").to_owned();
        let (outer, options) = (Options::default(), usvg::Options::default());
        let resolver = resolver(&outer);
        let bytes = || match (resolver.resolve_string)(&link, &options) {
            Some(ImageKind::PNG(bytes)) => bytes,
            other => panic!("{other:?}"),
        };
        let first = bytes();
        std::fs::remove_file(&path).expect("it is there");
        assert!(Arc::ptr_eq(&first, &bytes()));
        assert_eq!(*first, b"\x89PNG\r\n\x1a\n and more");
    }

    #[test]
    fn a_png_longer_than_can_be_counted_is_not_opened() {
        let png = |width: u32| {
            let header =
                [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", &width.to_be_bytes()[..], b"\0\0\0\x01\x08\x06\0\0\0"];
            kind(Arc::new(header.concat()), &usvg::Options::default(), &Options::default())
        };
        assert!(png(60_000).is_some());
        assert!(png(i32::MAX as u32).is_none());
    }

    #[test]
    fn files_are_opened_up_to_a_bound_for_all() {
        let path = made("bound.png", &[7; 100]);
        let mut so_far = MOST_BYTES_IN_ALL - 150;
        assert!(file(&path, &mut so_far).is_some());
        assert_eq!(so_far, MOST_BYTES_IN_ALL - 50);
        assert!(file(&path, &mut so_far).is_none());
        std::fs::remove_file(&path).expect("it is there");
    }

    #[test]
    fn drawings_count_towards_the_limit_on_elements_wherever_they_are_used() {
        let shapes = "<rect width='9' height='9'/>".repeat(30);
        let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>{shapes}</svg>");
        let path = made("elements.svg", svg.as_bytes());
        let link = path.to_str().expect("a name in UTF-8").to_owned();
        let mut outer = Options::default();
        outer.limits.elements = 100;
        let (resolver, options) = (resolver(&outer), usvg::Options::default());
        let is_drawing = || matches!((resolver.resolve_string)(&link, &options), Some(ImageKind::SVG(_)));
        let drawn = (0..5).filter(|_| is_drawing()).count();
        std::fs::remove_file(&path).expect("it is there");
        assert_eq!(drawn, 3);
    }
}
