//! Known-answer tests: pictures whose every pixel can be worked out on paper.

mod areas;
mod clips;
mod crisp;
mod gradients;
mod light;
mod neighbours;
mod opacity;
mod strokes;
#[path = "../support/mod.rs"]
mod support;

use std::f64::consts::PI;
use support::*;
use toon_raster::{Method, Pixmap, Renderer, Settings, Viewport};

const BLACK: [f64; 4] = [0.0, 0.0, 0.0, 255.0];
const WHITE: [f64; 4] = [255.0; 4];
const NOTHING: [f64; 4] = [0.0; 4];

/// The one pixel [0, 1) × [0, 1) of a drawing: as a picture of one pixel, and amid eight others.
#[track_caller]
fn unit_pixel_with(body: &str, settings: &Settings) -> [u8; 4] {
    let alone = render_with(&svg(1, 1, body), settings.clone()).pixel(0, 0);
    let moved = svg(3, 3, &format!("<g transform=\"translate(1 1)\">{body}</g>"));
    let amid = render_with(&moved, settings.clone()).pixel(1, 1);
    assert_eq!(alone, amid, "the pixel differs alone and amid others");
    alone
}

#[track_caller]
fn unit_pixel(body: &str) -> [u8; 4] {
    unit_pixel_with(body, &settings())
}

/// The light of the unit pixel, with white shapes before black.
#[track_caller]
fn light(shapes: &str) -> f64 {
    let [r, g, b, a] = unit_pixel(&(rect(0.0, 0.0, 1.0, 1.0, "#000") + shapes));
    assert_eq!([r, r, 255], [g, b, a], "white and black make grey");
    f64::from(r) / 255.0
}

#[track_caller]
fn assert_light(shapes: &str, expected: f64) {
    let found = light(shapes);
    let off = (found - expected).abs() * 255.0;
    assert!(off <= STRAIGHT, "light is {found}, should be {expected}: off by {off} levels");
}

fn grey(coverage: f64) -> [f64; 4] {
    [255.0 * coverage, 255.0 * coverage, 255.0 * coverage, 255.0]
}

fn with_background(body: &str) -> Pixmap {
    render_with(body, Settings { background: Some([0, 0, 0, 255]), ..settings() })
}

// ------------------------------------------------------------------------------- one plain shape
