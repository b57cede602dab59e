//! The methods of other days: adaptive sampling, corners of pixels, cones, beams, areas painted over one
//! another, and resvg's renderer. What each gets right, and that it gets wrong what its papers say.
//!
//! What they do not promise stands in `methods.rs`.

mod adaptive;
mod area;
mod beam;
mod by_resvg;
mod catmulls_figures;
mod cone;
mod corner;
#[path = "../support/mod.rs"]
mod support;
mod together;

use std::f64::consts::PI;
use std::path::Path;
use support::*;
use toon_raster::{Error, Method, Pixmap, Renderer, Scene, Settings, Viewport};

/// The methods this file is about.
const METHODS: [Method; 8] = [
    Method::Adaptive(64),
    Method::Adaptive(1),
    Method::Corner,
    Method::CornerTiny,
    Method::Cone,
    Method::Beam,
    Method::Area,
    Method::TinySkia,
];

fn by(method: Method) -> Settings {
    Settings { method, ..settings() }
}

fn render_by(method: Method, document: &str) -> Pixmap {
    render_with(document, by(method))
}

fn sample(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
    std::fs::read_to_string(file).expect("a readable sample")
}

/// A sample at a width, with these settings.
fn sample_with(name: &str, width: u32, settings: Settings) -> Pixmap {
    let scene = scene(&sample(name));
    let height = (f64::from(width) * scene.size().height / scene.size().width).round() as u32;
    let viewport = Viewport::fit(&scene, width, height);
    Renderer::new(settings).expect("good settings").render(&scene, &viewport).expect("a picture")
}

/// How light the pixel is, 0 ..= 1.
fn light(picture: &Pixmap, x: u32, y: u32) -> f64 {
    f64::from(picture.pixel(x, y)[0]) / 255.0
}

/// Our own samples that need no font.
const SAMPLES: [&str; 12] = [
    "abutting.svg",
    "catmull-line.svg",
    "clip.svg",
    "clip-complement.svg",
    "crisp.svg",
    "even-odd.svg",
    "fox.svg",
    "gradients.svg",
    "group-opacity.svg",
    "stacked.svg",
    "strokes.svg",
    "thin-stars.svg",
];
