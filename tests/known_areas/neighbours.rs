//! Shapes that share an edge, hide each other or cross.

use super::*;

#[test]
fn two_shapes_of_one_colour_which_share_an_edge_show_no_seam() {
    let vertical = rect(0.0, 0.0, 0.3, 1.0, "#fff") + &rect(0.3, 0.0, 1.0, 1.0, "#fff");
    assert_eq!(unit_pixel(&vertical), [255; 4]);
    let slanted = path("M-1 -1L.2 -1L.9 2L-1 2Z", "#fff", "") + &path("M.2 -1L2 -1L2 2L.9 2Z", "#fff", "");
    assert_eq!(unit_pixel(&slanted), [255; 4]);
    let level = rect(0.0, 0.0, 1.0, 0.7, "#fff") + &rect(0.0, 0.7, 1.0, 1.0, "#fff");
    assert_eq!(unit_pixel(&level), [255; 4]);
}

#[test]
fn two_colours_which_share_an_edge_get_their_own_areas() {
    let both = rect(0.0, 0.0, 0.375, 1.0, "#f00") + &rect(0.375, 0.0, 1.0, 1.0, "#00f");
    assert_levels(unit_pixel(&both), [255.0 * 0.375, 0.0, 255.0 * 0.625, 255.0], STRAIGHT);
}

#[test]
fn three_colours_which_meet_in_a_point_get_their_own_areas() {
    let three = path("M0 0L1 0L.5 .5L0 .5Z", "#f00", "")
        + &path("M1 0L1 1L.5 1L.5 .5Z", "#0f0", "")
        + &path("M0 .5L.5 .5L.5 1L0 1Z", "#00f", "");
    // Trapezia of 1, 1/2 by 1/2 high; of 1, 1/2 by 1/2 wide; a square of 1/2.
    assert_levels(unit_pixel(&three), [95.625, 95.625, 63.75, 255.0], STRAIGHT);
}

#[test]
fn catmulls_first_figure_has_a_quarter_green_a_quarter_black_half_blue_and_no_red() {
    let scene = rect(0.0, 0.0, 1.0, 1.0, "#f00")
        + &path("M.5 0L1 0L1 1L0 1Z", "#000", "")
        + &path("M0 0L.5 0L.5 1L0 1Z", "#0f0", "")
        + &path("M0 .5L1 .5L1 1L0 1Z", "#00f", "");
    // Blue is before the lower half, green before the upper left quarter; of black the upper right
    // quarter is left, and red is hidden behind all three.
    assert_levels(unit_pixel(&scene), [0.0, 63.75, 127.5, 255.0], STRAIGHT);
    assert_eq!(unit_pixel(&scene)[0], 0, "red is hidden");
}

#[test]
fn catmulls_first_figure_holds_with_slanted_edges() {
    // Green and black share the diagonal of the upper half; blue is below.
    let scene = rect(0.0, 0.0, 1.0, 1.0, "#f00")
        + &path("M0 0L1 .5L0 .5Z", "#0f0", "")
        + &path("M0 0L1 0L1 .5Z", "#000", "")
        + &path("M0 .5L1 .5L1 1L0 1Z", "#00f", "");
    assert_levels(unit_pixel(&scene), [0.0, 63.75, 127.5, 255.0], STRAIGHT);
    assert_eq!(unit_pixel(&scene)[0], 0, "red is hidden");
}

#[test]
fn a_black_line_along_a_border_of_two_colours_leaves_each_its_rest() {
    let upright = rect(0.0, 0.0, 0.5, 1.0, "#f00")
        + &rect(0.5, 0.0, 1.0, 1.0, "#00f")
        + &rect(0.375, 0.0, 0.625, 1.0, "#000");
    assert_levels(unit_pixel(&upright), [95.625, 0.0, 95.625, 255.0], STRAIGHT);
    // Slanted: the border is the diagonal, the line reaches 1/4 to its left and right.
    let slanted = path("M0 0L1 1L0 1Z", "#f00", "")
        + &path("M0 0L1 0L1 1Z", "#00f", "")
        + &path("M-.25 0L.25 0L1.25 1L.75 1Z", "#000", "");
    let rest = 0.5 * 0.75 * 0.75 * 255.0;
    assert_levels(unit_pixel(&slanted), [rest, 0.0, rest, 255.0], STRAIGHT);
}

#[test]
fn a_shape_hidden_by_two_shapes_together_never_shows() {
    let scene = rect(0.0, 0.0, 1.0, 1.0, "#f00")
        + &path("M-1 -1L.3 -1L.6 2L-1 2Z", "#0f0", "")
        + &path("M.3 -1L2 -1L2 2L.6 2Z", "#00f", "");
    let pixel = unit_pixel(&scene);
    assert_eq!((pixel[0], pixel[3]), (0, 255), "red is hidden");
}

#[test]
fn a_white_shape_on_the_same_black_shape_has_no_dark_fringe() {
    let d = "M-1 -1L.25 -1L.75 2L-1 2Z";
    let stack = path(d, "#000", "") + &path(d, "#fff", "");
    let pixel = unit_pixel(&stack);
    assert_eq!(pixel[..3], [255; 3], "no black shows");
    assert_levels(pixel, [255.0, 255.0, 255.0, 127.5], STRAIGHT);
}

#[test]
fn the_front_of_two_crossing_shapes_keeps_its_area_and_the_back_its_rest() {
    let scene = rect(0.0, 0.0, 0.5, 1.0, "#f00") + &rect(0.0, 0.0, 1.0, 0.25, "#0f0");
    // Green 1/4, red 1/2 · 3/4, nothing in 3/8.
    let alpha = 0.625;
    let expected = [255.0 * 0.375 / alpha, 255.0 * 0.25 / alpha, 0.0, 255.0 * alpha];
    assert_levels(unit_pixel(&scene), expected, STRAIGHT);
}

#[test]
fn areas_add_by_geometry_and_not_by_chance() {
    // Both in the left half: together they cover a half, not 3/4.
    let same = rect(0.0, 0.0, 0.5, 1.0, "#fff") + &rect(0.0, 0.0, 0.5, 1.0, "#fff");
    assert_light(&same, 0.5);
    // In opposite halves: all of it, not 3/4.
    let apart = rect(0.0, 0.0, 0.5, 1.0, "#fff") + &rect(0.5, 0.0, 1.0, 1.0, "#fff");
    assert_light(&apart, 1.0);
}
