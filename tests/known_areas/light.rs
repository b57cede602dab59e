//! Areas mixed in linear light; backgrounds and viewports.

use super::*;

fn linear() -> Settings {
    Settings { linear: true, ..settings() }
}

fn encode(light: f64) -> f64 {
    255.0 * if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

fn decode(level: f64) -> f64 {
    let v = level / 255.0;
    if v <= 0.040_45 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

#[test]
fn half_white_and_half_black_is_188_in_linear_light_and_128_in_srgb() {
    let half = rect(0.0, 0.0, 1.0, 1.0, "#000") + &rect(0.0, 0.0, 0.5, 1.0, "#fff");
    assert_eq!(unit_pixel_with(&half, &linear()), [188, 188, 188, 255]);
    assert_levels(unit_pixel(&half), grey(0.5), STRAIGHT);
}

#[test]
fn areas_mix_in_linear_light_by_their_share() {
    for n in 1..16 {
        let part = f64::from(n) / 16.0;
        let body = rect(0.0, 0.0, 1.0, 1.0, "#c03000") + &rect(0.0, 0.0, part, 1.0, "#0060f0");
        let mix = |a: f64, b: f64| encode(decode(a) * part + decode(b) * (1.0 - part));
        let expected = [mix(0.0, 192.0), mix(96.0, 48.0), mix(240.0, 0.0), 255.0];
        assert_levels(unit_pixel_with(&body, &linear()), expected, STRAIGHT);
    }
}

#[test]
fn opacity_composites_in_srgb_encoding_even_where_areas_mix_in_linear_light() {
    let veil = path("M0 0H1V1H0Z", "#fff", "fill-opacity=\".5\"");
    let full = rect(0.0, 0.0, 1.0, 1.0, "#000") + &veil;
    assert_levels(unit_pixel_with(&full, &linear()), grey(0.5), STRAIGHT);
    let half = rect(0.0, 0.0, 1.0, 1.0, "#000") + &path("M0 0H.5V1H0Z", "#fff", "fill-opacity=\".5\"");
    let level = encode(decode(127.5) / 2.0);
    assert_levels(unit_pixel_with(&half, &linear()), [level, level, level, 255.0], STRAIGHT);
}

#[test]
fn in_linear_light_every_grey_which_abuts_itself_stays_itself() {
    let mut body = String::new();
    for v in 0..=255u8 {
        let (x, y) = (f64::from(v % 16), f64::from(v / 16));
        let grey = hex([v, v, v]);
        body += &rect(x, y, x + 0.3, y + 1.0, &grey);
        body += &rect(x + 0.3, y, x + 1.0, y + 1.0, &grey);
    }
    let picture = render_with(&svg(16, 16, &body), linear());
    for v in 0..=255u8 {
        assert_eq!(picture.pixel((v % 16).into(), (v / 16).into()), [v, v, v, 255]);
    }
}

#[test]
fn in_linear_light_a_shape_alone_keeps_its_colour() {
    let pixel = unit_pixel_with(&rect(0.0, 0.0, 0.5, 1.0, "#c86432"), &linear());
    assert_levels(pixel, [200.0, 100.0, 50.0, 127.5], STRAIGHT);
}

#[test]
fn the_background_is_painted_behind_everything() {
    let behind = Settings { background: Some([10, 20, 30, 255]), ..settings() };
    let half = rect(0.0, 0.0, 0.5, 1.0, "#fff");
    assert_levels(unit_pixel_with(&half, &behind), [132.5, 137.5, 142.5, 255.0], STRAIGHT);
    assert_eq!(unit_pixel_with("", &behind), [10, 20, 30, 255]);
}

#[test]
fn a_translucent_background_keeps_its_colour_and_alpha_where_nothing_is() {
    let behind = Settings { background: Some([200, 100, 0, 128]), ..settings() };
    assert_eq!(unit_pixel_with("", &behind), [200, 100, 0, 128]);
    let veil = path("M0 0H1V1H0Z", "#000", "fill-opacity=\".5\"");
    // Black at 1/2 before (200, 100, 0) at 128/255.
    let alpha = 0.5 + 0.5 * 128.0 / 255.0;
    let share = 0.5 * 128.0 / 255.0 / alpha;
    let expected = [200.0 * share, 100.0 * share, 0.0, 255.0 * alpha];
    assert_levels(unit_pixel_with(&veil, &behind), expected, STRAIGHT);
}

#[test]
fn without_a_background_what_is_empty_is_transparent() {
    assert_levels(unit_pixel(""), NOTHING, 0.0);
}

#[test]
fn a_viewport_scales_stretches_and_crops() {
    let drawing = scene(&svg(2, 2, &rect(0.0, 0.0, 1.0, 2.0, "#fff")));
    let black = Settings { background: Some([0, 0, 0, 255]), ..settings() };
    let mut renderer = Renderer::new(black).expect("good settings");
    let stretched = renderer.render(&drawing, &Viewport::fit(&drawing, 5, 3)).expect("a picture");
    for y in 0..3 {
        let row = [0, 1, 2, 3, 4].map(|x| stretched.pixel(x, y));
        assert_levels(row[1], WHITE, 0.0);
        assert_levels(row[2], grey(0.5), STRAIGHT);
        assert_levels(row[3], BLACK, 0.0);
    }
    let transform = toon_raster::kurbo::Affine::new([4.0, 0.0, 0.0, 4.0, -2.25, -1.0]);
    let cropped = Viewport { width: 3, height: 2, transform };
    let cropped = renderer.render(&drawing, &cropped).expect("a picture");
    // The white edge at x = 1 falls on 4 - 2.25 = 1.75.
    assert_levels(cropped.pixel(0, 1), WHITE, 0.0);
    assert_levels(cropped.pixel(1, 0), grey(0.75), STRAIGHT);
    assert_levels(cropped.pixel(2, 1), BLACK, 0.0);
}
