//! The oracles of the other tests, held against each other and against resvg, supersampled.

mod support;

use support::*;

fn random_layers(rng: &mut Rng, count: usize, side: f64) -> Vec<Layer> {
    (0..count)
        .map(|i| {
            let corners = 3 + rng.below(4) as usize;
            let layer = Layer::new(&(0..corners).map(|_| rng.point(0.0, side)).collect::<Vec<_>>());
            if i % 2 == 0 {
                layer
            } else {
                layer.even_odd()
            }
        })
        .collect()
}

fn off(a: &Truth, b: &Truth) -> f64 {
    a.data.iter().zip(&b.data).map(|(&a, &b)| distance(a, b)).fold(0.0, f64::max)
}

#[test]
fn the_sweep_finds_the_area_that_clipping_finds() {
    let mut rng = Rng::new(1);
    for _ in 0..200 {
        let triangle: Vec<Point> = (0..3).map(|_| rng.point(-3.0, 11.0)).collect();
        let layers = [Layer::new(&triangle)];
        let sweep = Sweep::exact(&layers).picture(8, 8, opaque([0, 0, 0], &[[255, 255, 255]]));
        let off = off(&sweep, &coverage(8, 8, &[triangle]));
        assert!(off < 1e-9, "sweep and clipping differ by {off} levels");
    }
}

#[test]
fn the_sweep_finds_what_many_points_find() {
    let mut rng = Rng::new(2);
    for _ in 0..5 {
        let layers = random_layers(&mut rng, 5, 6.0);
        let colours: Vec<([u8; 3], f64)> = (0..5).map(|i| (rng.colour(), 0.2 * (i + 1) as f64)).collect();
        let sweep = Sweep::exact(&layers).picture(6, 6, blended([9, 99, 199], &colours));
        let points = sampled(6, 6, 128, &layers, blended([9, 99, 199], &colours));
        let off = off(&sweep, &points);
        assert!(off < 2.5, "sweep and points differ by {off} levels");
    }
}

#[test]
fn the_sweep_by_lines_is_near_the_exact_one() {
    let mut rng = Rng::new(3);
    let layers = random_layers(&mut rng, 12, 16.0);
    let colours: Vec<[u8; 3]> = (0..12).map(|_| rng.colour()).collect();
    let exact = Sweep::exact(&layers).picture(16, 16, opaque([0, 0, 0], &colours));
    let lines = Sweep::by_lines(&layers, 512).picture(16, 16, opaque([0, 0, 0], &colours));
    let off = off(&exact, &lines);
    assert!(off < 0.6, "lines and exact differ by {off} levels");
}

#[test]
fn the_sweep_finds_what_resvg_draws_without_anti_aliasing_at_32_times_the_size() {
    let mut rng = Rng::new(4);
    let layers = random_layers(&mut rng, 8, 12.0);
    let colours: Vec<[u8; 3]> = (0..8).map(|_| rng.colour()).collect();
    let mut body = rect(0.0, 0.0, 12.0, 12.0, "#102030");
    for (layer, colour) in layers.iter().zip(&colours) {
        let rule = if layer.rule == Rule::EvenOdd { "fill-rule=\"evenodd\"" } else { "" };
        body += &path(&rings(&layer.rings), &hex(*colour), rule);
    }
    let document = svg(12, 12, &format!("<g shape-rendering=\"crispEdges\">{body}</g>"));
    let tree = toon_raster::usvg::Tree::from_str(&document, &Default::default()).expect("good SVG");
    let mut large = tiny_skia::Pixmap::new(12 * 32, 12 * 32).expect("a size");
    resvg::render(&tree, tiny_skia::Transform::from_scale(32.0, 32.0), &mut large.as_mut());
    let mut reduced = Truth::new(12, 12);
    for (i, pixel) in large.pixels().iter().enumerate() {
        let (x, y) = (i % (12 * 32) / 32, i / (12 * 32) / 32);
        let channels = [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()];
        for (sum, channel) in reduced.data[y * 12 + x].iter_mut().zip(channels) {
            *sum += f64::from(channel) / 1024.0;
        }
    }
    let truth = Sweep::exact(&layers).picture(12, 12, opaque([0x10, 0x20, 0x30], &colours));
    let off = off(&truth, &reduced);
    assert!(off < 8.0, "sweep and resvg differ by {off} levels");
}

#[test]
fn the_sweep_knows_the_winding_rules() {
    let twice = Layer::of(&[corners(0.0, 0.0, 1.0, 1.0), corners(0.0, 0.0, 0.5, 1.0)]);
    let white = [[255, 255, 255]];
    let full = Sweep::exact(std::slice::from_ref(&twice)).picture(1, 1, opaque([0, 0, 0], &white));
    let half = Sweep::exact(&[twice.even_odd()]).picture(1, 1, opaque([0, 0, 0], &white));
    assert_eq!(full.pixel(0, 0), [255.0; 4]);
    assert_eq!(half.pixel(0, 0), [127.5, 127.5, 127.5, 255.0]);
}
