//! Strokes.

use super::*;

/// A white stroke of this path on black.
fn stroked(width: u32, height: u32, d: &str, attributes: &str) -> Pixmap {
    let line = path(d, "none", &format!("stroke=\"#fff\" {attributes}"));
    with_background(&svg(width, height, &line))
}

fn light_of(picture: &Pixmap) -> f64 {
    picture.data().chunks(4).map(|pixel| f64::from(pixel[0]) / 255.0).sum()
}

#[track_caller]
fn assert_rectangles(picture: &Pixmap, rectangles: &[[f64; 4]], what: &str) {
    let polygons: Vec<_> = rectangles.iter().map(|r| corners(r[0], r[1], r[2], r[3])).collect();
    assert_matches(picture, &coverage(picture.width(), picture.height(), &polygons), CURVED, what);
}

#[test]
fn butt_caps_end_at_the_ends_and_square_caps_half_a_width_beyond() {
    let butt = stroked(12, 8, "M3 4H8.5", "stroke-width=\"2.5\"");
    assert_rectangles(&butt, &[[3.0, 2.75, 8.5, 5.25]], "butt");
    let square = stroked(12, 8, "M3 4H8.5", "stroke-width=\"2.5\" stroke-linecap=\"square\"");
    assert_rectangles(&square, &[[1.75, 2.75, 9.75, 5.25]], "square");
    let upright = stroked(8, 12, "M4.25 2.5V9.25", "stroke-width=\".75\"");
    assert_rectangles(&upright, &[[3.875, 2.5, 4.625, 9.25]], "upright");
}

#[test]
fn round_caps_add_a_half_disk_at_each_end() {
    let picture = stroked(32, 16, "M8 8H24", "stroke-width=\"10\" stroke-linecap=\"round\"");
    let expected = 160.0 + PI * 25.0;
    let light = light_of(&picture);
    assert!((light / expected - 1.0).abs() < 1e-3, "light {light}, area {expected}");
    assert_levels(picture.pixel(3, 8), grey(0.95), 12.0);
    assert_levels(picture.pixel(2, 8), BLACK, CURVED);
    assert_levels(picture.pixel(12, 2), BLACK, 0.0);
}

#[test]
fn a_dot_is_drawn_by_round_and_square_caps_and_not_by_butt_ones() {
    let round = stroked(16, 16, "M8 8H8", "stroke-width=\"10\" stroke-linecap=\"round\"");
    let light = light_of(&round);
    assert!((light / (PI * 25.0) - 1.0).abs() < 2e-3, "light {light}");
    let square = stroked(16, 16, "M8 8H8", "stroke-width=\"10\" stroke-linecap=\"square\"");
    assert_rectangles(&square, &[[3.0, 3.0, 13.0, 13.0]], "square dot");
    assert_rectangles(&stroked(16, 16, "M8 8H8", "stroke-width=\"10\""), &[], "butt dot");
}

#[test]
fn a_mitered_corner_is_square_a_bevelled_one_cut_and_a_round_one_a_quarter_disk() {
    let corner = |join: &str| stroked(24, 24, "M4 12H14V22", &format!("stroke-width=\"6\" {join}"));
    // Arms of 10 by 6 share a square of 3; the outer corner's square of 3 is the join's.
    let arms = vec![
        [4.0, 9.0],
        [14.0, 9.0],
        [14.0, 12.0],
        [17.0, 12.0],
        [17.0, 22.0],
        [11.0, 22.0],
        [11.0, 15.0],
        [4.0, 15.0],
    ];
    let with = |i: usize, p: Point| {
        let mut polygon = arms.clone();
        polygon[i] = p;
        polygon
    };
    let miter = coverage(24, 24, &[with(2, [17.0, 9.0])]);
    assert_matches(&corner("stroke-linejoin=\"miter\""), &miter, CURVED, "miter");
    let mut bevel = arms.clone();
    bevel.remove(2);
    assert_matches(&corner("stroke-linejoin=\"bevel\""), &coverage(24, 24, &[bevel]), CURVED, "bevel");
    let round = light_of(&corner("stroke-linejoin=\"round\""));
    let expected = area(&arms).abs() + PI * 9.0 / 4.0;
    assert!((round - expected).abs() < 0.05, "light {round}, area {expected}");
}

#[test]
fn a_miter_beyond_its_limit_is_bevelled() {
    // A right angle's miter is √2 widths long.
    let corner = |limit: &str| {
        stroked(24, 24, "M4 12H14V22", &format!("stroke-width=\"6\" stroke-miterlimit=\"{limit}\""))
    };
    assert_levels(corner("1.5").pixel(16, 9), WHITE, CURVED);
    assert_levels(corner("1.3").pixel(16, 9), BLACK, CURVED);
}

#[test]
fn a_closed_rectangle_has_a_square_frame() {
    let picture = stroked(16, 16, "M4.5 4.5H11.5V11.5H4.5Z", "stroke-width=\"1.5\"");
    let frame = [
        [3.75, 3.75, 12.25, 5.25],
        [3.75, 10.75, 12.25, 12.25],
        [3.75, 5.25, 5.25, 10.75],
        [10.75, 5.25, 12.25, 10.75],
    ];
    assert_rectangles(&picture, &frame, "frame");
}

#[test]
fn dashes_lie_where_the_pattern_says() {
    let dashed = |attributes: &str| stroked(24, 4, "M2 2H22", &format!("stroke-width=\"1.5\" {attributes}"));
    let bars = |spans: &[[f64; 2]]| -> Vec<[f64; 4]> {
        spans.iter().map(|span| [span[0], 1.25, span[1], 2.75]).collect()
    };
    let plain = bars(&[[2.0, 5.0], [7.25, 10.25], [12.5, 15.5], [17.75, 20.75]]);
    assert_rectangles(&dashed("stroke-dasharray=\"3 2.25\""), &plain, "3 2.25");
    let shifted = bars(&[[2.0, 4.0], [6.25, 9.25], [11.5, 14.5], [16.75, 19.75]]);
    let offset = "stroke-dasharray=\"3 2.25\" stroke-dashoffset=\"1\"";
    assert_rectangles(&dashed(offset), &shifted, "offset");
    // An odd list is repeated: 4 on, 3 off, 2 on, 4 off, 3 on, 2 off.
    let odd = bars(&[[2.0, 6.0], [9.0, 11.0], [15.0, 18.0], [20.0, 22.0]]);
    assert_rectangles(&dashed("stroke-dasharray=\"4 3 2\""), &odd, "odd");
    let capped = bars(&[[1.25, 5.75], [9.25, 13.75], [17.25, 21.75]]);
    let square = "stroke-dasharray=\"3 5\" stroke-linecap=\"square\"";
    assert_rectangles(&dashed(square), &capped, "square caps");
}

#[test]
fn dashes_turn_corners() {
    let picture = stroked(
        16,
        16,
        "M2 4H10V14",
        "stroke-width=\"2\" stroke-dasharray=\"5 1\" stroke-linejoin=\"miter\"",
    );
    // Dashes at 0 – 5, 6 – 11, 12 – 17 along 8 + 10: the second bends at 8 with its mitre.
    let dashes = [[2.0, 3.0, 7.0, 5.0], [8.0, 3.0, 11.0, 5.0], [9.0, 5.0, 11.0, 7.0], [9.0, 8.0, 11.0, 13.0]];
    assert_rectangles(&picture, &dashes, "corner");
}

#[test]
fn a_stroke_scales_with_its_user_space() {
    let line = path("M2 2H5", "none", "stroke=\"#fff\" stroke-width=\"1\" transform=\"scale(2 3)\"");
    assert_rectangles(&with_background(&svg(16, 12, &line)), &[[4.0, 4.5, 10.0, 7.5]], "scaled");
    let upright = path("M2 1V3", "none", "stroke=\"#fff\" stroke-width=\"1\" transform=\"scale(2 3)\"");
    assert_rectangles(&with_background(&svg(8, 12, &upright)), &[[3.0, 3.0, 5.0, 9.0]], "upright");
    let dashed = path("M1 1H7", "none", "stroke=\"#fff\" stroke-dasharray=\"2 1\" transform=\"scale(2 3)\"");
    let dashes = [[2.0, 1.5, 6.0, 4.5], [8.0, 1.5, 12.0, 4.5]];
    assert_rectangles(&with_background(&svg(16, 8, &dashed)), &dashes, "dashed");
}

#[test]
fn a_stroke_is_as_fine_as_its_width_says() {
    // No hairline: a tenth of a pixel lights a tenth.
    let picture = stroked(16, 4, "M0 1.5H16", "stroke-width=\".1\"");
    for x in 0..16 {
        assert_levels(picture.pixel(x, 1), grey(0.1), STRAIGHT);
        assert_levels(picture.pixel(x, 0), BLACK, 0.0);
    }
}

#[test]
fn a_stroked_circle_has_the_light_of_its_ring() {
    let circle = "<circle cx=\"20\" cy=\"20\" r=\"14\" fill=\"none\" stroke=\"#fff\" stroke-width=\"3\"/>";
    let light = light_of(&with_background(&svg(40, 40, circle)));
    let expected = 2.0 * PI * 14.0 * 3.0;
    assert!((light / expected - 1.0).abs() < 1e-3, "light {light}, area {expected}");
}

#[test]
fn a_stroke_which_crosses_itself_covers_the_crossing_once() {
    let cross = stroked(16, 16, "M2 8H14M8 2V14", "stroke-width=\"3\" stroke-opacity=\".5\"");
    assert_levels(cross.pixel(8, 8), grey(0.5), STRAIGHT);
    assert_levels(cross.pixel(3, 8), grey(0.5), STRAIGHT);
    // Inside one pixel: two strips of 1/2 cover 3/4 together.
    let thin = stroked(3, 3, "M0 1.5H3M1.5 0V3", "stroke-width=\".5\"");
    assert_levels(thin.pixel(1, 1), grey(0.75), CURVED);
}
