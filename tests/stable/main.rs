//! Hard cases: what breaks rasterizers, each held against an oracle or a figure worked out on paper.

mod absurd;
mod borders;
mod degenerate;
mod hatches;
mod integrator;
mod sizes;
mod strokes;
#[path = "../support/mod.rs"]
mod support;
mod thin;

use std::time::{Duration, Instant};
use support::*;
use toon_raster::reference;
use toon_raster::{Error, Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// Farthest a level may be off where hundreds of pieces cross in one pixel and the renderer may
/// fall back from its recursion to samples.
const DENSE: f64 = 8.0;

/// Longest any one picture of this file may take, in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

const RED: [u8; 3] = [255, 0, 0];
const WHITE: [u8; 3] = [255, 255, 255];

/// The document of opaque layers, back to front, on black.
fn document(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]]) -> String {
    let mut body = rect(0.0, 0.0, width.into(), height.into(), "#000");
    for (layer, colour) in layers.iter().zip(colours) {
        let rule = if layer.rule == Rule::EvenOdd { "fill-rule=\"evenodd\"" } else { "" };
        body += &path(&rings(&layer.rings), &hex(*colour), rule);
    }
    svg(width, height, &body)
}

fn draw(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]]) -> Pixmap {
    let started = Instant::now();
    let picture = render(&document(width, height, layers, colours));
    assert!(started.elapsed() < PATIENCE, "one picture took {:?}", started.elapsed());
    picture
}

/// Draws opaque layers on black and holds every pixel against the exact sweep.
#[track_caller]
fn assert_exact(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]], what: &str) {
    let truth = Sweep::exact(layers).picture(width, height, opaque([0, 0, 0], colours));
    assert_matches(&draw(width, height, layers, colours), &truth, STRAIGHT, what);
}

#[track_caller]
fn assert_white(width: u32, height: u32, rings: &[Vec<Point>], what: &str) {
    assert_exact(width, height, &[Layer::of(rings)], &[WHITE], what);
    assert_exact(width, height, &[Layer::of(rings).even_odd()], &[WHITE], what);
}

fn colours(rng: &mut Rng, count: usize) -> Vec<[u8; 3]> {
    (0..count).map(|_| rng.colour()).collect()
}

/// Many small pictures at once: `side` × `side` cells of 3 × 3 pixels, each with its own layers,
/// which `make` gives inside [0, 3]²; each cell is held against its own sweep.
#[track_caller]
fn assert_cells(side: u32, what: &str, mut make: impl FnMut(u32) -> Vec<Layer>) {
    let mut rng = Rng::new(side.into());
    let mut all = (Vec::new(), Vec::new());
    let mut cells = Vec::new();
    for cell in 0..side * side {
        let layers = make(cell);
        let colours = colours(&mut rng, layers.len());
        let (left, top) = (f64::from(cell % side * 3), f64::from(cell / side * 3));
        for layer in &layers {
            let moved = |ring: &Vec<Point>| ring.iter().map(|p| [p[0] + left, p[1] + top]).collect();
            all.0.push(Layer { rings: layer.rings.iter().map(moved).collect(), rule: layer.rule });
        }
        all.1.extend(&colours);
        cells.push((layers, colours));
    }
    let picture = draw(side * 3, side * 3, &all.0, &all.1);
    for (cell, (layers, colours)) in cells.iter().enumerate() {
        let truth = Sweep::exact(layers).picture(3, 3, opaque([0, 0, 0], colours));
        for i in 0..9 {
            let (x, y) = (cell as u32 % side * 3 + i % 3, cell as u32 / side * 3 + i / 3);
            let (found, expected) = (picture.pixel(x, y), truth.pixel(i % 3, i / 3));
            let off = distance(premultiplied(found), expected);
            assert!(
                off <= STRAIGHT,
                "{what}, cell {cell}, pixel ({}, {}): {found:?}, should be {expected:?}: off by {off:.3}; {layers:?}",
                i % 3,
                i / 3
            );
        }
    }
}
