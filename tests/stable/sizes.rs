//! What is very large, very small, or very many.

use super::*;

#[test]
fn coordinates_of_a_million_under_a_view_box_are_as_exact_as_small_ones() {
    // Multiples of 1/16 are exact in single precision up to a million.
    let local = [[1.1875, 0.5], [30.5625, 8.25], [17.0, 31.4375], [3.75, 20.0]];
    for (scale, offset, what) in [(1.0, 1e6, "far away"), (32768.0, 0.0, "large")] {
        let placed = |ring: &[Point]| -> Vec<Point> {
            ring.iter().map(|p| p.map(|v: f64| v * scale + offset)).collect()
        };
        let document = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"32\" height=\"32\" \
             viewBox=\"{offset} {offset} {side} {side}\">{}{}</svg>",
            path(&ring(&placed(&corners(-1.0, -1.0, 33.0, 33.0))), "#000", ""),
            path(&ring(&placed(&local)), "#fff", ""),
            side = 32.0 * scale
        );
        assert_matches(&render(&document), &coverage(32, 32, &[local.to_vec()]), STRAIGHT, what);
    }
}

#[test]
fn a_slanted_edge_between_far_off_corners_is_exact_where_it_crosses_the_picture() {
    for far in [1e3, 1e6, 1.34217728e8] {
        for (a, b) in [
            ([-far, -far / 2.0], [far, far / 2.0]),
            ([8.0 - far / 4.0, -far], [8.0 + far / 4.0, far]),
            ([-far, 12.0], [far, 3.0]),
        ] {
            let triangle = vec![a, b, [-far, far]];
            let picture = draw(16, 16, &[Layer::new(&triangle)], &[WHITE]);
            let truth = coverage(16, 16, &[triangle]);
            assert!(truth.data.iter().any(|p| p[0] > 1.0 && p[0] < 254.0), "the edge crosses the picture");
            assert_matches(&picture, &truth, STRAIGHT, &format!("{a:?} to {b:?}"));
        }
    }
}

#[test]
fn thousands_of_tiny_polygons_in_one_pixel_add_up() {
    // A chequerboard of 64 × 64 squares of 1/64 px: half of one pixel; then all of it.
    let square = |i: u32| {
        let (x, y) = (f64::from(i % 64) / 64.0, f64::from(i / 64) / 64.0);
        corners(x, y, x + 1.0 / 64.0, y + 1.0 / 64.0)
    };
    let odd: Vec<_> = (0..4096).filter(|i| (i % 64 + i / 64) % 2 == 0).map(square).collect();
    let all: Vec<_> = (0..4096).map(square).collect();
    let picture = draw(1, 1, &[Layer::of(&odd)], &[WHITE]);
    assert_levels(picture.pixel(0, 0), [127.5, 127.5, 127.5, 255.0], STRAIGHT);
    assert_eq!(draw(1, 1, &[Layer::of(&all)], &[WHITE]).pixel(0, 0), [255; 4]);
    let layers: Vec<Layer> = all.iter().map(|square| Layer::new(square)).collect();
    assert_eq!(draw(1, 1, &layers, &vec![WHITE; 4096]).pixel(0, 0), [255; 4]);
    let few: Vec<Layer> = odd.iter().map(|square| Layer::new(square)).collect();
    let picture = draw(1, 1, &few, &vec![WHITE; few.len()]);
    assert_levels(picture.pixel(0, 0), [127.5, 127.5, 127.5, 255.0], DENSE);
}

#[test]
fn polygons_of_a_hundredth_pixel_spread_over_a_picture_keep_their_light() {
    // 10,000 disjoint triangles of 1/128 px legs: their whole light is known to the mean rounding.
    let mut rng = Rng::new(8);
    let mut triangles = Vec::new();
    for i in 0..10_000 {
        let (x, y) = (f64::from(i % 100) * 0.15625, f64::from(i / 100) * 0.15625);
        let (x, y) = (x + rng.on_grid(0.0, 0.125), y + rng.on_grid(0.0, 0.125));
        triangles.push(vec![[x, y], [x + 1.0 / 64.0, y], [x, y + 1.0 / 64.0]]);
    }
    let truth = coverage(16, 16, &triangles);
    let picture = draw(16, 16, &[Layer::of(&triangles)], &[WHITE]);
    assert_matches(&picture, &truth, STRAIGHT, "one path");
    let layers: Vec<Layer> = triangles.iter().map(|t| Layer::new(t)).collect();
    let picture = draw(16, 16, &layers, &vec![WHITE; layers.len()]);
    assert_matches(&picture, &truth, STRAIGHT, "a shape each");
}

#[test]
fn twenty_thousand_crossing_edges_in_one_shape_take_bounded_time() {
    let mut rng = Rng::new(9);
    let tangle: Vec<Point> = (0..20_000).map(|_| rng.point(0.0, 48.0)).collect();
    for layer in [Layer::new(&tangle), Layer::new(&tangle).even_odd()] {
        let layers = [layer];
        let picture = draw(48, 48, &layers, &[WHITE]);
        let truth = Sweep::by_lines(&layers, 32).picture(48, 48, opaque([0; 3], &[WHITE]));
        // The oracle itself is off by some two levels here.
        let mean = mean_error(&picture, &truth);
        assert!(mean < 6.0, "{:?}: mean error {mean}", layers[0].rule);
        let light = |p: &mut dyn Iterator<Item = f64>| p.sum::<f64>() / (48.0 * 48.0);
        let found = light(&mut picture.data().chunks(4).map(|p| f64::from(p[0])));
        let expected = light(&mut truth.data.iter().map(|p| p[0]));
        assert!((found - expected).abs() < 0.5, "{:?}: {found}, {expected}", layers[0].rule);
    }
}

#[test]
fn many_random_shapes_in_few_pixels_take_bounded_time_and_stay_near() {
    let mut rng = Rng::new(10);
    let layers: Vec<Layer> = (0..300)
        .map(|_| Layer::new(&[rng.point(-1.0, 5.0), rng.point(-1.0, 5.0), rng.point(-1.0, 5.0)]))
        .collect();
    let colours = colours(&mut rng, 300);
    let picture = draw(4, 4, &layers, &colours);
    let truth = Sweep::by_lines(&layers, 256).picture(4, 4, opaque([0; 3], &colours));
    assert_matches(&picture, &truth, STRAIGHT + 0.4, "shapes");
}

#[test]
fn many_random_veils_in_few_pixels_take_bounded_time_and_stay_near() {
    let mut rng = Rng::new(11);
    let layers: Vec<Layer> = (0..60)
        .map(|_| Layer::new(&[rng.point(-1.0, 5.0), rng.point(-1.0, 5.0), rng.point(-1.0, 5.0)]))
        .collect();
    let veils: Vec<([u8; 3], f64)> = (0..60).map(|_| (rng.colour(), 0.25)).collect();
    let mut body = rect(0.0, 0.0, 4.0, 4.0, "#000");
    for (layer, veil) in layers.iter().zip(&veils) {
        body += &path(&rings(&layer.rings), &hex(veil.0), "fill-opacity=\".25\"");
    }
    let started = Instant::now();
    let picture = render(&svg(4, 4, &body));
    assert!(started.elapsed() < PATIENCE, "took {:?}", started.elapsed());
    let truth = Sweep::exact(&layers).picture(4, 4, blended([0; 3], &veils));
    assert_matches(&picture, &truth, DENSE, "veils");
}
