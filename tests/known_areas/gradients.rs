//! Gradients.

use super::*;

const STOPS: &str = "<stop offset=\"0\" stop-color=\"#000\"/><stop offset=\"1\" stop-color=\"#fff\"/>";

/// A document filled by a gradient from black to white.
fn gradient(width: u32, height: u32, kind: &str, attributes: &str, stops: &str) -> Pixmap {
    let fill = rect(0.0, 0.0, width.into(), height.into(), "url(#g)");
    render(&svg(width, height, &format!("<{kind} id=\"g\" {attributes}>{stops}</{kind}>{fill}")))
}

/// Holds every pixel against a shade of its centre; `None` where it is not known well.
#[track_caller]
fn assert_shades(picture: &Pixmap, tolerance: f64, shade: impl Fn(f64, f64) -> Option<f64>) {
    let mut known = 0;
    for y in 0..picture.height() {
        for x in 0..picture.width() {
            if let Some(shade) = shade(f64::from(x) + 0.5, f64::from(y) + 0.5) {
                assert_levels(picture.pixel(x, y), grey(shade), tolerance);
                known += 1;
            }
        }
    }
    assert!(known * 2 > picture.width() * picture.height(), "too few pixels are known");
}

/// How far from the true shade of its centre a gradient's pixel may be.
const SHADE: f64 = 0.75;

#[test]
fn a_linear_gradient_runs_evenly_from_stop_to_stop() {
    let user = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"256\"";
    assert_shades(&gradient(256, 2, "linearGradient", user, STOPS), SHADE, |x, _| Some(x / 256.0));
    let down = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"0\" y1=\"0\" y2=\"64\"";
    assert_shades(&gradient(2, 64, "linearGradient", down, STOPS), SHADE, |_, y| Some(y / 64.0));
    let slanted = "gradientUnits=\"userSpaceOnUse\" x1=\"8\" y1=\"8\" x2=\"56\" y2=\"40\"";
    assert_shades(&gradient(64, 48, "linearGradient", slanted, STOPS), SHADE, |x, y| {
        let t = ((x - 8.0) * 48.0 + (y - 8.0) * 32.0) / (48.0 * 48.0 + 32.0 * 32.0);
        (0.03..0.97).contains(&t).then_some(t)
    });
}

#[test]
fn a_linear_gradient_pads_reflects_and_repeats() {
    let with = |spread: &str| {
        format!("gradientUnits=\"userSpaceOnUse\" x1=\"64\" x2=\"128\" spreadMethod=\"{spread}\"")
    };
    let pad = gradient(256, 1, "linearGradient", &with("pad"), STOPS);
    assert_shades(&pad, SHADE, |x, _| Some(((x - 64.0) / 64.0).clamp(0.0, 1.0)));
    let reflect = gradient(256, 1, "linearGradient", &with("reflect"), STOPS);
    assert_shades(&reflect, SHADE, |x, _| {
        let t = (x / 64.0 - 1.0).rem_euclid(2.0);
        Some(if t > 1.0 { 2.0 - t } else { t })
    });
    let repeat = gradient(256, 1, "linearGradient", &with("repeat"), STOPS);
    assert_shades(&repeat, SHADE, |x, _| Some((x / 64.0).fract()));
}

#[test]
fn a_gradient_in_units_of_the_bounding_box_spans_the_shape() {
    let fill = rect(10.0, 0.0, 110.0, 4.0, "url(#g)");
    let document = svg(120, 4, &format!("<linearGradient id=\"g\">{STOPS}</linearGradient>{fill}"));
    let picture = with_background(&document);
    assert_shades(&picture, SHADE, |x, _| (10.0..110.0).contains(&x).then_some((x - 10.0) / 100.0));
}

#[test]
fn a_gradient_transform_moves_the_gradient() {
    let moved = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"1\" \
                 gradientTransform=\"translate(16 0) scale(128 1)\"";
    let picture = gradient(160, 2, "linearGradient", moved, STOPS);
    assert_shades(&picture, SHADE, |x, _| Some(((x - 16.0) / 128.0).clamp(0.0, 1.0)));
    let turned = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"64\" gradientTransform=\"rotate(90)\"";
    assert_shades(&gradient(4, 64, "linearGradient", turned, STOPS), SHADE, |_, y| Some(y / 64.0));
}

#[test]
fn stops_at_one_offset_make_a_hard_edge() {
    let stops = "<stop offset=\".5\" stop-color=\"#000\"/><stop offset=\".5\" stop-color=\"#fff\"/>";
    let user = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"64\"";
    let picture = gradient(64, 1, "linearGradient", user, stops);
    assert_shades(&picture, 0.0, |x, _| Some(if x < 32.0 { 0.0 } else { 1.0 }));
}

#[test]
fn stops_interpolate_colour_and_opacity_apart_from_each_other() {
    let stops = "<stop offset=\"0\" stop-color=\"#fff\"/>\
                 <stop offset=\"1\" stop-color=\"#000\" stop-opacity=\"0\"/>";
    let user = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"255\"";
    let fill = rect(0.0, 0.0, 255.0, 1.0, "url(#g)");
    let document = svg(255, 1, &format!("<linearGradient id=\"g\" {user}>{stops}</linearGradient>{fill}"));
    let picture = with_background(&document);
    // Colour and opacity both fall as 1 - t, before black: their product.
    assert_shades(&picture, SHADE, |x, _| Some((1.0 - x / 255.0).powi(2)));
}

#[test]
fn a_fills_opacity_multiplies_its_gradients() {
    let user = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"64\"";
    let fill = path("M0 0H64V1H0Z", "url(#g)", "fill-opacity=\".5\"");
    let document = svg(64, 1, &format!("<linearGradient id=\"g\" {user}>{STOPS}</linearGradient>{fill}"));
    assert_shades(&with_background(&document), SHADE, |x, _| Some(x / 128.0));
}

#[test]
fn a_radial_gradient_grows_with_the_distance() {
    let user = "gradientUnits=\"userSpaceOnUse\" cx=\"32\" cy=\"32\" r=\"32\"";
    let picture = gradient(64, 64, "radialGradient", user, STOPS);
    assert_shades(&picture, SHADE, |x, y| {
        let t = (x - 32.0).hypot(y - 32.0) / 32.0;
        (0.1..0.97).contains(&t).then_some(t)
    });
    let boxed = gradient(64, 32, "radialGradient", "", STOPS);
    assert_shades(&boxed, SHADE, |x, y| {
        let t = (x / 32.0 - 1.0).hypot(y / 16.0 - 1.0);
        (0.15..0.95).contains(&t).then_some(t)
    });
}

#[test]
fn a_radial_gradient_reflects() {
    let user = "gradientUnits=\"userSpaceOnUse\" cx=\"64\" cy=\"64\" r=\"32\" spreadMethod=\"reflect\"";
    assert_shades(&gradient(128, 128, "radialGradient", user, STOPS), SHADE, |x, y| {
        let t = (x - 64.0).hypot(y - 64.0) / 32.0;
        let folded = if t > 1.0 { 2.0 - t } else { t };
        ((0.1..0.95).contains(&folded) && t < 2.0).then_some(folded)
    });
}

#[test]
fn a_focal_point_is_where_the_gradient_begins() {
    let user = "gradientUnits=\"userSpaceOnUse\" cx=\"32\" cy=\"32\" r=\"32\" fx=\"16\" fy=\"32\"";
    assert_shades(&gradient(64, 64, "radialGradient", user, STOPS), SHADE, |x, y| {
        // The circle of shade t has centre f + t (c - f) and radius t r: |p - f - t d| = t r.
        let (px, py, d, r) = (x - 16.0, y - 32.0, 16.0, 32.0);
        let (a, half_b, c) = (r * r - d * d, px * d, -(px * px + py * py));
        let t: f64 = (-half_b + (half_b * half_b - a * c).sqrt()) / a;
        // Near the focal point the shade bends sharply within a pixel.
        (px.hypot(py) > 4.0 && t < 0.96).then_some(t)
    });
}

#[test]
fn shapes_which_abut_under_one_gradient_show_no_seam() {
    let user = "gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"64\"";
    let defs = format!("<linearGradient id=\"g\" {user}>{STOPS}</linearGradient>");
    let halves = path("M0 0L20.25 0L43.5 16L0 16Z", "url(#g)", "")
        + &path("M20.25 0L64 0L64 16L43.5 16Z", "url(#g)", "");
    let picture = render(&svg(64, 16, &(defs + &halves)));
    assert_shades(&picture, SHADE, |x, _| Some(x / 64.0));
}
