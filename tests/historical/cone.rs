//! Cones: rays with a width (Amanatides).

use super::*;

#[test]
fn a_cones_share_of_a_half_plane_is_a_circular_segment() {
    let radius = 1.0 / PI.sqrt();
    let mut rng = Rng::new(5);
    for _ in 0..60 {
        let (sin, cos) = rng.between(0.0, 2.0 * PI).sin_cos();
        let at = rng.point(7.0, 9.0);
        let point = |u: f64, v: f64| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos];
        let plane = [point(-64.0, 0.0), point(64.0, 0.0), point(64.0, 64.0), point(-64.0, 64.0)];
        let picture = render_by(Method::Cone, &white_on_black(16, 16, &ring(&plane), ""));
        for (x, y) in [(7, 7), (8, 7), (7, 8), (8, 8), (6, 9), (3, 12)] {
            // How far the pixel's centre lies inside the plane.
            let (dx, dy) = (f64::from(x) + 0.5 - at[0], f64::from(y) + 0.5 - at[1]);
            let depth = (cos * dy - sin * dx).clamp(-radius, radius);
            let outside =
                radius * radius * (depth / radius).acos() - depth * (radius * radius - depth * depth).sqrt();
            let off = (255.0 * (1.0 - outside) - f64::from(picture.pixel(x, y)[0])).abs();
            assert!(off <= 0.6, "({x}, {y}) is off by {off} levels, its centre lies {depth} inside");
        }
    }
}

#[test]
fn a_cone_sees_a_little_of_the_neighbours() {
    // A border between two pixels, where the box filter sees none of the other side.
    let picture = render_by(Method::Cone, &white_on_black(9, 9, "M5 -1H10V10H5z", ""));
    assert!((5..15).contains(&picture.pixel(4, 4)[0]), "{:?}", picture.pixel(4, 4));
    assert!((240..250).contains(&picture.pixel(5, 4)[0]), "{:?}", picture.pixel(5, 4));
}

#[test]
fn cones_and_areas_multiply_what_lies_side_by_side() {
    // Two halves of a pixel abut: a quarter of what lies behind is left.
    let document = svg(
        9,
        9,
        &(rect(0.0, 0.0, 9.0, 9.0, "#000")
            + &path("M0 0H4.5V9H0z", "#fff", "")
            + &path("M4.5 0H9V9H4.5z", "#fff", "")),
    );
    for method in [Method::Area, Method::Cone] {
        assert_levels(render_by(method, &document).pixel(4, 4), [191.25, 191.25, 191.25, 255.0], 1.0);
    }
    for method in [Method::Exact, Method::Beam, Method::Corner, Method::CornerTiny, Method::Adaptive(64)] {
        assert_eq!(render_by(method, &document).pixel(4, 4), [255; 4], "{method}");
    }
}
