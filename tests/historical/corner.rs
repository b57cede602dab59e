//! Corners of pixels (Ramos & Borges).

use super::*;

/// The largest difference from the exact picture, in levels, over a sample at its own size.
fn off(method: Method, name: &str) -> f64 {
    let (picture, exact) = (render_by(method, &sample(name)), render(&sample(name)));
    let pairs = picture.data().chunks(4).zip(exact.data().chunks(4));
    let level = |p: &[u8]| [p[0], p[1], p[2], p[3]].map(f64::from);
    pairs.map(|(a, b)| distance(level(a), level(b))).fold(0.0, f64::max)
}

#[test]
fn corner_is_exact_where_one_straight_border_crosses() {
    let mut rng = Rng::new(7);
    for _ in 0..40 {
        let angle = rng.between(0.0, 2.0 * PI);
        let (sin, cos) = angle.sin_cos();
        let at = rng.point(14.0, 18.0);
        let point = |u: f64, v: f64| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos];
        let plane = [point(-64.0, 0.0), point(64.0, 0.0), point(64.0, 64.0), point(-64.0, 64.0)];
        let document = white_on_black(32, 32, &ring(&plane), "");
        assert_within(&render_by(Method::Corner, &document), &render(&document), 1.0, "a half-plane");
    }
}

#[test]
fn corner_misses_polygons_inside_a_pixel_and_tiny_finds_them() {
    let picture = render_by(Method::Corner, &sample("corner-inside.svg"));
    assert!(picture.data().iter().all(|&level| level == 255), "it saw some of the squares");
    assert!(off(Method::Corner, "corner-inside.svg") > 90.0);
    assert!(off(Method::CornerTiny, "corner-inside.svg") <= 3.0);
}

#[test]
fn corner_misses_what_reaches_in_through_one_side_and_tiny_finds_it() {
    let picture = render_by(Method::Corner, &sample("corner-one-side.svg"));
    assert_eq!(picture.pixel(1, 3), [255; 4], "it saw a tooth");
    assert!(off(Method::Corner, "corner-one-side.svg") > 70.0);
    assert!(off(Method::CornerTiny, "corner-one-side.svg") <= 3.0);
}

#[test]
fn corner_finds_one_border_of_several_across_a_side() {
    // Both bars, 60% of the pixel, cross its sides between corners that see nothing.
    assert_eq!(render_by(Method::Corner, &sample("corner-several.svg")).pixel(2, 10), [255; 4]);
    assert!(off(Method::Corner, "corner-several.svg") > 140.0);
    // Where the colours at the ends differ, one of the borders is found.
    let document = white_on_black(9, 9, "M4.2 -1h.2v11h-.2zM4.6 -1H10V10H4.6z", "");
    let found = light(&render_by(Method::Corner, &document), 4, 4);
    assert!((found - 0.6).abs() > 0.1, "{found}");
}

#[test]
fn corner_breaks_thin_polygons_and_tiny_does_not_mend_them() {
    for method in [Method::Corner, Method::CornerTiny] {
        assert!(off(method, "corner-thin.svg") > 60.0, "{method}");
    }
    // It comes and goes along the line, which is as dark everywhere.
    let picture = render_by(Method::Corner, &sample("corner-thin.svg"));
    let along: Vec<bool> = (4..28).map(|y| (3..14).any(|x| picture.pixel(x, y)[0] < 250)).collect();
    assert!(along.contains(&true) && along.contains(&false), "{along:?}");
}

#[test]
fn corner_halves_a_quarter_and_tiny_finds_the_vertex() {
    // Vertices at the middle of pixels: an eighth for a quarter.
    let picture = render_by(Method::Corner, &sample("corner-vertex.svg"));
    assert_levels(picture.pixel(2, 2), [223.1, 223.1, 223.1, 255.0], 1.0);
    assert!(off(Method::CornerTiny, "corner-vertex.svg") <= 2.0);
}

#[test]
fn corner_misses_a_line_between_two_colours() {
    let picture = render_by(Method::Corner, &sample("corner-colours.svg"));
    let [red, green, blue, _] = picture.pixel(24, 5);
    // The black line, half of the pixel, counts as the colour that it is more like, the darker one.
    let mixed = |dark: f64, light: f64| 0.75 * dark + 0.25 * light;
    let expected = [mixed(17.0, 238.0), mixed(170.0, 136.0), mixed(102.0, 187.0), 255.0];
    assert_levels([red, green, blue, 255], expected, 1.0);
    assert!(off(Method::Corner, "corner-colours.svg") > 100.0);
}

#[test]
fn corner_is_nearer_with_its_remedy() {
    for name in ["fox.svg", "even-odd.svg", "strokes.svg", "crisp.svg"] {
        let exact = sample_with(name, 128, settings());
        let error = |method| {
            let picture = sample_with(name, 128, by(method));
            let pairs = picture.data().iter().zip(exact.data());
            pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).sum::<f64>()
        };
        let (plain, tiny) = (error(Method::Corner), error(Method::CornerTiny));
        assert!(tiny < 0.9 * plain, "{name}: {tiny} and {plain}");
    }
}
