//! Takes what is drawn, makes prints: 128 bits that tell whether two shapes, clips or pictures were drawn
//! from the same. Kept in memory only, to know which pixels of one frame are those of another.
//!
//! Promises: equal content has equal prints; two that differ are equal by one chance in 2^128 or so.
//! A print says nothing of numbers that shift when something else comes or goes: ids, places in lists.

use super::paint::{Gradient, GradientShape, Paint};
use super::raster::{Mask, Raster, RasterGroup, Source};
use super::{Clip, FillRule, Geometry, Outline, Scene, Shape, StrokeStyle};
use crate::effects::layer::Layer;
use kurbo::Rect;
use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use usvg::filter;
use usvg::tiny_skia_path::{Path, PathVerb};

/// A print, or one in the making: two halves that are mixed by themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Print([u64; 2]);

/// Digits of the golden ratio and of the square root of 2, made odd.
const FACTORS: [u64; 2] = [0x9e37_79b9_7f4a_7c15, 0x6a09_e667_f3bc_c909];

/// Both halves of a product, folded: every bit of the result depends on every bit of `v`.
#[inline]
fn fold(v: u64, factor: u64) -> u64 {
    let product = u128::from(v) * u128::from(factor);
    product as u64 ^ (product >> 64) as u64
}

impl Print {
    /// Of nothing; `kind` keeps prints of different things apart.
    pub const fn new(kind: u64) -> Print {
        Print([kind ^ FACTORS[1], kind ^ FACTORS[0]])
    }

    /// Like no other: of what cannot be told apart.
    pub fn unique() -> Print {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let mut print = Print::new(u64::MAX);
        print.add(COUNT.fetch_add(1, Ordering::Relaxed));
        print
    }

    /// Goes on with 64 bits.
    #[inline]
    pub fn add(&mut self, bits: u64) {
        let [a, b] = &mut self.0;
        *a = fold(*a ^ bits, FACTORS[0]).wrapping_add(FACTORS[1]);
        *b = fold(*b ^ bits.rotate_left(32), FACTORS[1]).wrapping_add(FACTORS[0]);
    }

    /// Goes on with another print.
    #[inline]
    pub fn add_print(&mut self, other: Print) {
        let [a, b] = &mut self.0;
        *a = fold(*a ^ other.0[0], FACTORS[0]).wrapping_add(FACTORS[1]);
        *b = fold(*b ^ other.0[1], FACTORS[1]).wrapping_add(FACTORS[0]);
    }

    /// Goes on with bytes, and how many they are.
    pub fn add_bytes(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|&word| self.add(u64::from_le_bytes(word)));
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        self.add(u64::from_le_bytes(last));
        self.add(bytes.len() as u64);
    }

    fn add_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.add(number.to_bits()));
    }

    fn add_pair(&mut self, a: f32, b: f32) {
        self.add(u64::from(a.to_bits()) << 32 | u64::from(b.to_bits()));
    }
}

/// Of text.
pub(crate) fn of_bytes(bytes: &[u8]) -> Print {
    let mut print = Print::new(0);
    print.add_bytes(bytes);
    print
}

/// Of where a shape is in its scene.
pub(crate) fn of_geometry(geometry: &Geometry) -> Print {
    let mut print = Print::new(1);
    add_path(&mut print, &geometry.path);
    print.add_numbers(geometry.transform.as_coeffs());
    print.add(u64::from(geometry.crisp));
    match &geometry.outline {
        Outline::Fill(FillRule::NonZero) => print.add(0),
        Outline::Fill(FillRule::EvenOdd) => print.add(1),
        Outline::Pixels => print.add(2),
        Outline::Stroke(stroke) => {
            print.add(3);
            let StrokeStyle { line, clips_miters } = &**stroke;
            print.add(u64::from(*clips_miters));
            let kurbo::Stroke { width, join, miter_limit, start_cap, end_cap, dash_pattern, dash_offset } =
                line;
            print.add(*join as u64 | (*start_cap as u64) << 8 | (*end_cap as u64) << 16);
            print.add_numbers([*width, *miter_limit, *dash_offset]);
            print.add(dash_pattern.len() as u64);
            print.add_numbers(dash_pattern.iter().copied());
        }
    }
    print
}

fn add_path(print: &mut Print, path: &Path) {
    for verbs in path.verbs().chunks(16) {
        let word = verbs.iter().fold(1, |word, verb| {
            word << 3
                | match verb {
                    PathVerb::Move => 0,
                    PathVerb::Line => 1,
                    PathVerb::Quad => 2,
                    PathVerb::Cubic => 3,
                    PathVerb::Close => 4,
                }
        });
        print.add(word);
    }
    path.points().iter().for_each(|point| print.add_pair(point.x, point.y));
}

/// Of every clip of a scene.
pub(crate) fn of_clips(clips: &[Clip]) -> Vec<Print> {
    let mut prints: Vec<Print> = Vec::with_capacity(clips.len());
    for clip in clips {
        let print = of_clip(clip, &prints);
        prints.push(print);
    }
    prints
}

/// Of a clip; `before` are those it may refer to.
pub(crate) fn of_clip(clip: &Clip, before: &[Print]) -> Print {
    let mut print = Print::new(2);
    for member in &clip.members {
        print.add_print(of_geometry(&member.geometry));
        if let Some(clip) = member.clip {
            print.add_print(before[clip as usize]);
        }
    }
    print.add(clip.members.len() as u64);
    clip.within.iter().for_each(|&within| print.add_print(before[within as usize]));
    print
}

/// Of a shape, but for its group; `clips` are of its scene's clips.
pub(crate) fn of_shape(shape: &Shape, clips: &[Print]) -> Print {
    let mut print = of_geometry(&shape.geometry);
    print.add_print(of_paint(&shape.paint));
    if let Some(clip) = shape.clip {
        print.add_print(clips[clip as usize]);
    }
    print
}

/// Of every shape of a scene.
pub(crate) fn of_shapes(scene: &Scene) -> Vec<Print> {
    let clips = of_clips(&scene.clips);
    scene.shapes.iter().map(|shape| of_shape(shape, &clips)).collect()
}

/// Of what a shape is painted with.
pub(crate) fn of_paint(paint: &Paint) -> Print {
    let mut print = Print::new(3);
    match paint {
        Paint::Flat(sheet) => {
            let [r, g, b, through] = sheet.channels();
            print.add_pair(r, g);
            print.add_pair(b, through);
        }
        Paint::Gradient(gradient) => add_gradient(&mut print, gradient),
        Paint::Raster(raster) => print.add_print(of_raster(raster)),
        Paint::Layer(layer, (dx, dy)) => {
            add_layer(&mut print, layer);
            print.add_numbers([f64::from(*dx), f64::from(*dy)]);
        }
    }
    print
}

fn add_gradient(print: &mut Print, gradient: &Gradient) {
    match gradient.shape {
        GradientShape::Linear(map) => print.add_numbers(map.as_coeffs()),
        GradientShape::Radial { start: (x, y, r), step: (dx, dy, dr) } => {
            print.add(1);
            print.add_numbers([x, y, r, dx, dy, dr]);
        }
    }
    print.add(gradient.spread as u64);
    print.add_numbers(gradient.transform.as_coeffs());
    for stop in &gradient.stops {
        let [r, g, b, alpha] = stop.color;
        print.add(u64::from(stop.offset.to_bits()));
        print.add_pair(r, g);
        print.add_pair(b, alpha);
    }
    print.add(u64::from(gradient.opaque));
}

/// Of what a layer is made from.
pub(crate) fn of_raster(raster: &Raster) -> Print {
    let mut print = Print::new(4);
    print.add_numbers(raster.transform.as_coeffs());
    add_rect(&mut print, raster.bounds);
    print.add(u64::from(raster.opacity.to_bits()));
    match &raster.source {
        Source::Image { image, nearest } => {
            print.add(u64::from(*nearest));
            print.add_print(image.print());
        }
        Source::Tiles(scene, place) => {
            print.add(2);
            add_rect(&mut print, *place);
            print.add_print(of_scene(scene));
        }
        Source::Group(group) => {
            print.add(3);
            add_group(&mut print, group);
        }
    }
    print
}

fn add_group(print: &mut Print, group: &RasterGroup) {
    print.add_print(of_scene(&group.content));
    print.add(group.blend_mode as u64 | u64::from(group.without_front) << 8);
    let mut mask = group.mask.as_ref();
    while let Some(Mask { content, rect, kind, within }) = mask {
        print.add(*kind as u64);
        add_rect(print, *rect);
        print.add_print(of_scene(content));
        mask = within.as_deref();
    }
    for filter in &group.filters {
        // All of a primitive is in its debug text, but for the pixels of images.
        if filter.primitives().iter().any(|p| matches!(p.kind(), filter::Kind::Image(_))) {
            print.add_print(Print::unique());
        }
        let mut text = String::new();
        write!(text, "{:?} {:?}", filter.rect(), filter.primitives()).expect("a string takes all");
        print.add_bytes(text.as_bytes());
    }
}

/// Of all that a scene draws, in its own user units.
fn of_scene(scene: &Scene) -> Print {
    let mut print = Print::new(5);
    for group in &scene.groups {
        print.add(u64::from(group.parent) << 32 | u64::from(group.opacity.to_bits()));
    }
    for (shape, of_shape) in scene.shapes.iter().zip(of_shapes(scene)) {
        print.add_print(of_shape);
        print.add(u64::from(shape.group));
    }
    print
}

fn add_layer(print: &mut Print, layer: &Layer) {
    let rect = layer.rect();
    print.add_numbers([rect.x(), rect.y(), rect.right(), rect.bottom()].map(f64::from));
    print.add(layer.space() as u64);
    for &[r, g, b, alpha] in layer.pixels() {
        print.add_pair(r, g);
        print.add_pair(b, alpha);
    }
}

fn add_rect(print: &mut Print, rect: Rect) {
    print.add_numbers([rect.x0, rect.y0, rect.x1, rect.y1]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    fn print(content: &str) -> Print {
        let svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{content}</svg>"#);
        of_scene(&Scene::from_bytes(svg.as_bytes(), &Options::default()).unwrap())
    }

    #[test]
    fn the_same_drawing_has_the_same_print_and_any_difference_shows() {
        let drawings = [
            r##"<path d="M0 0h9v9z"/>"##,
            r##"<path d="M0 0h9v8z"/>"##,
            r##"<path d="M0 0h9v9z" fill-rule="evenodd"/>"##,
            r##"<path d="M0 0h9v9z" fill="#001"/>"##,
            r##"<path d="M0 0h9v9z" fill-opacity=".5"/>"##,
            r##"<path d="M0 0h9v9z" shape-rendering="crispEdges"/>"##,
            r##"<path d="M0 0h9v9z" transform="translate(1)"/>"##,
            r##"<path d="M0 0h9v9z" fill="none" stroke="#000"/>"##,
            r##"<path d="M0 0h9v9z" fill="none" stroke="#000" stroke-linecap="round"/>"##,
            r##"<path d="M0 0h9v9z" fill="none" stroke="#000" stroke-dasharray="1 2"/>"##,
            r##"<path d="M0 0h9v9z" fill="none" stroke="#000" stroke-dasharray="1 2" stroke-dashoffset="1"/>"##,
            r##"<clipPath id="c"><path d="M0 0h5v5z"/></clipPath><path d="M0 0h9v9z" clip-path="url(#c)"/>"##,
            r##"<clipPath id="c"><path d="M0 0h5v6z"/></clipPath><path d="M0 0h9v9z" clip-path="url(#c)"/>"##,
            r##"<mask id="c"><path d="M0 0h5v6z"/></mask><path d="M0 0h9v9z" mask="url(#c)"/>"##,
            r##"<filter id="f"><feGaussianBlur stdDeviation="1"/></filter><path d="M0 0h9v9z" filter="url(#f)"/>"##,
            r##"<filter id="f"><feGaussianBlur stdDeviation="2"/></filter><path d="M0 0h9v9z" filter="url(#f)"/>"##,
            r##"<linearGradient id="g"><stop stop-color="red"/><stop offset="1"/></linearGradient><path d="M0 0h9v9z" fill="url(#g)"/>"##,
            r##"<linearGradient id="g"><stop stop-color="red"/><stop offset=".9"/></linearGradient><path d="M0 0h9v9z" fill="url(#g)"/>"##,
            r##"<g opacity=".5"><path d="M0 0h9v9z"/><path d="M0 0h5v5z"/></g>"##,
            r##"<path d="M0 0h9v9z"/><path d="M0 0h5v5z"/>"##,
        ];
        for (i, a) in drawings.iter().enumerate() {
            for (j, b) in drawings.iter().enumerate() {
                assert_eq!(print(a) == print(b), i == j, "{a} {b}");
            }
        }
    }

    #[test]
    fn an_id_is_not_printed() {
        assert_eq!(print(r#"<path id="a" d="M0 0h9v9z"/>"#), print(r#"<path id="b" d="M0 0h9v9z"/>"#));
    }
}
