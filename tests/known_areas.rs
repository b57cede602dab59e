//! Known-answer tests: pictures whose every pixel can be worked out on paper.

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

#[test]
fn half_a_pixel_is_half_lit_whichever_half_it_is() {
    for (x0, y0, x1, y1) in
        [(0.0, 0.0, 0.5, 1.0), (0.5, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 0.5), (0.0, 0.5, 1.0, 1.0)]
    {
        assert_light(&rect(x0, y0, x1, y1, "#fff"), 0.5);
    }
    assert_light(&rect(0.25, -5.0, 0.75, 5.0, "#fff"), 0.5);
}

#[test]
fn a_quarter_of_a_pixel_is_a_quarter_lit_wherever_it_lies() {
    for (x, y) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.25, 0.25), (0.375, 0.125)] {
        assert_light(&rect(x, y, x + 0.5, y + 0.5, "#fff"), 0.25);
    }
}

#[test]
fn every_64th_of_a_pixel_has_its_light() {
    for n in 0..=64 {
        let part = f64::from(n) / 64.0;
        assert_light(&rect(-1.0, -1.0, part, 2.0, "#fff"), part);
        assert_light(&rect(-1.0, -1.0, 2.0, part, "#fff"), part);
        assert_light(&rect(part, part, 2.0, 2.0, "#fff"), (1.0 - part) * (1.0 - part));
    }
}

#[test]
fn a_shape_alone_keeps_its_colour_and_takes_its_area_as_alpha() {
    assert_levels(unit_pixel(&rect(0.0, 0.0, 0.5, 1.0, "#c86432")), [200.0, 100.0, 50.0, 127.5], STRAIGHT);
    assert_levels(unit_pixel(&rect(0.0, 0.0, 0.5, 0.25, "#f00")), [255.0, 0.0, 0.0, 31.875], STRAIGHT);
}

#[test]
fn triangles_have_their_area() {
    assert_light(&path("M0 0L1 0L0 1Z", "#fff", ""), 0.5);
    assert_light(&path("M0 0L.5 1L1 0Z", "#fff", ""), 0.5);
    assert_light(&path("M.25 .25L.75 .25L.5 .75Z", "#fff", ""), 0.125);
    // The corner cut off by x + y = 1/2, and what is left.
    assert_light(&path("M0 0L.5 0L0 .5Z", "#fff", ""), 0.125);
    assert_light(&path("M.5 0L3 0L3 3L0 3L0 .5Z", "#fff", ""), 0.875);
}

#[test]
fn a_large_triangle_lights_every_pixel_by_its_area() {
    let triangle = vec![[1.25, 0.5], [30.75, 11.0], [7.5, 31.25]];
    let picture = render(&white_on_black(32, 32, &ring(&triangle), ""));
    assert_matches(&picture, &coverage(32, 32, &[triangle]), STRAIGHT, "triangle");
}

#[test]
fn a_thin_sliver_has_its_area_in_every_pixel_that_it_crosses() {
    assert_light(&rect(0.5, 0.0, 0.515625, 1.0, "#fff"), 1.0 / 64.0);
    let sliver = vec![[0.5, 0.25], [15.5, 6.25], [15.5, 6.28125]];
    let picture = render(&white_on_black(16, 8, &ring(&sliver), ""));
    assert_matches(&picture, &coverage(16, 8, &[sliver]), STRAIGHT, "sliver");
}

#[test]
fn a_rectangle_on_pixel_borders_is_full_inside_and_leaves_no_trace_outside() {
    let picture = render(&svg(8, 8, &rect(2.0, 3.0, 6.0, 5.0, "#123456")));
    for y in 0..8 {
        for x in 0..8 {
            let inside = (2..6).contains(&x) && (3..5).contains(&y);
            let expected = if inside { [0x12, 0x34, 0x56, 255] } else { [0; 4] };
            assert_eq!(picture.pixel(x, y), expected, "pixel ({x}, {y})");
        }
    }
}

#[test]
fn shapes_outside_the_picture_leave_no_trace_in_it() {
    let outside = rect(-9.0, -9.0, 0.0, 9.0, "#f00")
        + &rect(4.0, -9.0, 9.0, 9.0, "#f00")
        + &rect(-9.0, -9.0, 9.0, 0.0, "#f00")
        + &rect(-9.0, 4.0, 9.0, 9.0, "#f00");
    let inside = rect(1.0, 1.0, 2.5, 3.0, "#00f");
    let both = render(&svg(4, 4, &(outside + &inside)));
    assert_same_bytes(&both, &render(&svg(4, 4, &inside)), "shapes outside");
}

#[test]
fn a_shape_larger_than_the_picture_fills_it() {
    let picture = render(&svg(5, 3, &rect(-100.0, -50.0, 200.0, 70.0, "#abcdef")));
    assert!(picture.data().chunks(4).all(|pixel| pixel == [0xab, 0xcd, 0xef, 255]));
}

#[test]
fn a_circle_has_the_light_of_its_area() {
    let picture = render(&white_on_black(32, 32, "M4 16A12 12 0 0 1 28 16A12 12 0 0 1 4 16Z", ""));
    let light: f64 = picture.data().chunks(4).map(|pixel| f64::from(pixel[0]) / 255.0).sum();
    let expected = PI * 144.0;
    assert!((light / expected - 1.0).abs() < 5e-4, "light {light}, area {expected}");
}

#[test]
fn curves_bound_their_area_pixel_by_pixel() {
    // y = (x - 16)² / 16 + 2, exactly one quadratic curve; the area under it is known in each column.
    let picture = render(&white_on_black(32, 20, "M0 18Q16 -14 32 18L32 20L0 20Z", ""));
    for x in 0..32u32 {
        let column: f64 = (0..20).map(|y| f64::from(picture.pixel(x, y)[0]) / 255.0).sum();
        let power = |x: f64| (x - 16.0).powi(3) / 48.0;
        let above = 2.0 + power(f64::from(x) + 1.0) - power(f64::from(x));
        // Up to three pixels of the column are partly lit.
        assert!((column - (20.0 - above)).abs() * 255.0 < 3.0 * CURVED, "column {x}: {column}, {above}");
    }
}

// --------------------------------------------------------------------------------- winding rules

#[test]
fn windings_of_one_two_and_minus_one_fill_and_of_zero_do_not() {
    let clockwise = "M.25 .25H.75V.75H.25Z";
    let back = "M.25 .25V.75H.75V.25Z";
    assert_light(&path(clockwise, "#fff", ""), 0.25);
    assert_light(&path(back, "#fff", ""), 0.25);
    assert_light(&path(&format!("{clockwise}{clockwise}"), "#fff", ""), 0.25);
    assert_light(&path(&format!("{back}{back}{back}"), "#fff", ""), 0.25);
    assert_light(&path(&format!("{clockwise}{back}"), "#fff", ""), 0.0);
    assert_light(&path(&format!("{clockwise}{back}{back}"), "#fff", ""), 0.25);
}

#[test]
fn a_hole_is_a_ring_walked_the_other_way() {
    assert_light(&path("M0 0H1V1H0ZM.25 .25V.75H.75V.25Z", "#fff", ""), 0.75);
    assert_light(&path("M0 0H1V1H0ZM.25 .25H.75V.75H.25Z", "#fff", ""), 1.0);
}

#[test]
fn even_odd_fills_where_the_winding_is_odd() {
    let rule = "fill-rule=\"evenodd\"";
    assert_light(&path("M0 0H1V1H0ZM.25 .25H.75V.75H.25Z", "#fff", rule), 0.75);
    assert_light(&path("M0 0H1V1H0ZM0 0H1V1H0Z", "#fff", rule), 0.0);
    assert_light(&path("M0 0H.5V1H0ZM.25 0H1V1H.25Z", "#fff", rule), 0.75);
}

#[test]
fn overlapping_rings_of_one_path_cover_their_union_not_their_sum() {
    // Half and half meet in a quarter; the sum of the areas would fill the pixel.
    assert_light(&path("M0 0H.5V1H0ZM0 0H1V.5H0Z", "#fff", ""), 0.75);
}

#[test]
fn a_bow_tie_fills_both_of_its_wings() {
    assert_light(&path("M0 0L1 1L1 0L0 1Z", "#fff", ""), 0.5);
    assert_light(&path("M0 0L1 1L1 0L0 1Z", "#fff", "fill-rule=\"evenodd\""), 0.5);
}

// ------------------------------------------------------------------- several shapes in one pixel

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

// ------------------------------------------------------------------------------------------ clips

fn clipped(clip: &str, units: &str, body: &str) -> String {
    format!("<clipPath id=\"c\" {units}>{clip}</clipPath><g clip-path=\"url(#c)\">{body}</g>")
}

#[test]
fn a_clip_and_a_shape_multiply_only_where_they_cross() {
    let left = "<path d=\"M-1 -1H.5V2H-1Z\"/>";
    assert_light(&clipped(left, "", &rect(-1.0, 0.5, 2.0, 2.0, "#fff")), 0.25);
    assert_light(&clipped(left, "", &rect(-1.0, -1.0, 0.5, 2.0, "#fff")), 0.5);
    assert_light(&clipped(left, "", &rect(0.5, -1.0, 2.0, 2.0, "#fff")), 0.0);
    assert_light(&clipped(left, "", &rect(0.25, -1.0, 2.0, 2.0, "#fff")), 0.25);
}

#[test]
fn a_shape_clipped_beside_its_complement_shows_no_seam() {
    let full = "M-1 -1H2V2H-1Z";
    let body = format!(
        "<clipPath id=\"l\"><path d=\"M-1 -1L.2 -1L.9 2L-1 2Z\"/></clipPath>\
         <clipPath id=\"r\"><path d=\"M.2 -1L2 -1L2 2L.9 2Z\"/></clipPath>{}{}",
        path(full, "#fff", "clip-path=\"url(#l)\""),
        path(full, "#fff", "clip-path=\"url(#r)\"")
    );
    assert_eq!(unit_pixel(&body), [255; 4]);
}

#[test]
fn nested_clips_meet() {
    let body = format!(
        "<clipPath id=\"a\"><path d=\"M0 0H.5V1H0Z\"/></clipPath>\
         <clipPath id=\"b\"><path d=\"M0 0H1V.5H0Z\"/></clipPath>\
         <clipPath id=\"ab\" clip-path=\"url(#a)\"><path d=\"M0 0H1V.5H0Z\"/></clipPath>\
         <g clip-path=\"url(#a)\"><g clip-path=\"url(#b)\">{0}</g></g>\
         <g clip-path=\"url(#ab)\">{0}</g>",
        rect(0.0, 0.0, 1.0, 1.0, "#fff")
    );
    assert_light(&body, 0.25);
}

#[test]
fn the_children_of_a_clip_unite() {
    let body = rect(0.0, 0.0, 1.0, 1.0, "#fff");
    assert_light(&clipped("<path d=\"M0 0H.5V1H0Z\"/><path d=\"M0 0H1V.5H0Z\"/>", "", &body), 0.75);
    assert_light(&clipped("<path d=\"M0 0H.3V1H0Z\"/><path d=\"M.3 0H1V1H.3Z\"/>", "", &body), 1.0);
}

#[test]
fn a_clip_may_be_even_odd_and_may_be_in_units_of_the_bounding_box() {
    let body = rect(0.0, 0.0, 1.0, 1.0, "#fff");
    let even_odd = "<path clip-rule=\"evenodd\" d=\"M0 0H1V1H0ZM.25 .25H.75V.75H.25Z\"/>";
    assert_light(&clipped(even_odd, "", &body), 0.75);
    let half = "<path d=\"M0 0H.5V1H0Z\"/>";
    let narrow = rect(0.25, 0.0, 0.75, 1.0, "#fff");
    assert_light(&clipped(half, "clipPathUnits=\"objectBoundingBox\"", &narrow), 0.25);
}

#[test]
fn a_clip_without_children_hides_all() {
    assert_light(&clipped("", "", &rect(0.0, 0.0, 1.0, 1.0, "#fff")), 0.0);
}

// ---------------------------------------------------------------------------------------- opacity

#[test]
fn two_half_opaque_shapes_stack_where_they_overlap() {
    let half = "fill-opacity=\".5\"";
    let full = path("M0 0H1V1H0Z", "#fff", half);
    assert_light(&full, 0.5);
    assert_light(&(full.clone() + &full), 0.75);
    // Both in the left half: 1/2 · 3/4, not 1 - (1 - 1/4)².
    let left = path("M0 0H.5V1H0Z", "#fff", half);
    assert_light(&(left.clone() + &left), 0.375);
    // Side by side under opacity each point has one of them.
    let right = path("M.5 0H1V1H.5Z", "#fff", half);
    assert_light(&(left + &right), 0.5);
}

#[test]
fn a_stack_of_translucent_colours_composites_front_over_back() {
    let stack = rect(0.0, 0.0, 1.0, 1.0, "#000")
        + &path("M0 0H1V1H0Z", "#f00", "fill-opacity=\".5\"")
        + &path("M0 0H1V1H0Z", "#0f0", "fill-opacity=\".25\"");
    assert_levels(unit_pixel(&stack), [95.625, 63.75, 0.0, 255.0], STRAIGHT);
}

#[test]
fn an_opaque_front_hides_the_translucent_shapes_behind_it() {
    let stack = path("M0 0H1V1H0Z", "#f00", "fill-opacity=\".5\"") + &rect(0.0, 0.0, 0.5, 1.0, "#00f");
    // Blue half; the other half is red at 1/2.
    assert_levels(unit_pixel(&stack), [85.0, 0.0, 170.0, 191.25], STRAIGHT);
}

#[test]
fn a_groups_opacity_does_not_double_where_its_shapes_overlap() {
    let both = rect(0.0, 0.0, 0.75, 1.0, "#fff") + &rect(0.25, 0.0, 1.0, 1.0, "#fff");
    assert_light(&format!("<g opacity=\".5\">{both}</g>"), 0.5);
    let colours = rect(0.0, 0.0, 0.75, 1.0, "#f00") + &rect(0.25, 0.0, 1.0, 1.0, "#00f");
    let pixel = unit_pixel(&format!("<g opacity=\".5\">{colours}</g>"));
    assert_levels(pixel, [63.75, 0.0, 191.25, 127.5], STRAIGHT);
}

#[test]
fn nested_group_opacities_multiply() {
    let shape = rect(0.0, 0.0, 1.0, 1.0, "#fff");
    assert_light(&format!("<g opacity=\".5\"><g opacity=\".5\">{shape}</g></g>"), 0.25);
    let beside = rect(0.0, 0.0, 0.5, 1.0, "#fff");
    // Outer group: white at 1/2 in the right half; inner group before it only in the left half.
    let nested =
        format!("<g opacity=\".5\">{}<g opacity=\".5\">{beside}</g></g>", rect(0.5, 0.0, 1.0, 1.0, "#fff"));
    assert_light(&nested, 0.375);
}

#[test]
fn an_isolated_group_mixes_its_own_shapes_before_the_backdrop() {
    // Inside: red at 1/2 before opaque blue = (1/2, 0, 1/2); that at 1/2 before white.
    let body = rect(0.0, 0.0, 1.0, 1.0, "#fff")
        + &format!(
            "<g opacity=\".5\">{}{}</g>",
            rect(0.0, 0.0, 1.0, 1.0, "#00f"),
            path("M0 0H1V1H0Z", "#f00", "fill-opacity=\".5\"")
        );
    assert_levels(unit_pixel(&body), [191.25, 127.5, 191.25, 255.0], STRAIGHT);
}

#[test]
fn shapes_which_abut_in_a_group_show_no_seam_under_its_opacity() {
    let halves = path("M-1 -1L.2 -1L.9 2L-1 2Z", "#fff", "") + &path("M.2 -1L2 -1L2 2L.9 2Z", "#fff", "");
    let group = format!("<g opacity=\".5\">{halves}</g>");
    let whole = format!("<g opacity=\".5\">{}</g>", rect(-1.0, -1.0, 2.0, 2.0, "#fff"));
    assert_eq!(unit_pixel(&group), unit_pixel(&whole));
    assert_levels(unit_pixel(&group), [255.0, 255.0, 255.0, 127.5], STRAIGHT);
}

#[test]
fn shapes_of_opacity_zero_are_not_there() {
    assert_light(&path("M0 0H1V1H0Z", "#fff", "fill-opacity=\"0\""), 0.0);
    assert_light(&format!("<g opacity=\"0\">{}</g>", rect(0.0, 0.0, 1.0, 1.0, "#fff")), 0.0);
}

#[test]
fn a_stroked_and_filled_shape_under_opacity_is_one_group() {
    // Stroke from 1 to 3 all round, fill inside it, both at once halved.
    let shape = |opacity: &str| {
        format!("<rect x=\"2\" y=\"2\" width=\"6\" height=\"6\" fill=\"#f00\" stroke=\"#00f\" stroke-width=\"2\" {opacity}/>")
    };
    let group = render(&svg(10, 10, &shape("opacity=\".5\"")));
    for at in [(1, 5), (2, 5), (5, 2), (8, 8)] {
        assert_levels(group.pixel(at.0, at.1), [0.0, 0.0, 255.0, 127.5], STRAIGHT);
    }
    assert_levels(group.pixel(5, 5), [255.0, 0.0, 0.0, 127.5], STRAIGHT);
    // With the opacity on the stroke alone the fill shines through its inner half.
    let stroke = render(&svg(10, 10, &shape("stroke-opacity=\".5\"")));
    assert_levels(stroke.pixel(1, 5), [0.0, 0.0, 255.0, 127.5], STRAIGHT);
    assert_levels(stroke.pixel(2, 5), [127.5, 0.0, 127.5, 255.0], STRAIGHT);
}

#[test]
fn paint_order_puts_the_fill_before_the_stroke() {
    let shape = "<rect x=\"2\" y=\"2\" width=\"6\" height=\"6\" fill=\"#f00\" stroke=\"#00f\" \
                 stroke-width=\"2\" paint-order=\"stroke\"/>";
    let picture = render(&svg(10, 10, shape));
    assert_eq!(picture.pixel(1, 5), [0, 0, 255, 255]);
    assert_eq!(picture.pixel(2, 5), [255, 0, 0, 255]);
}

// ------------------------------------------------------------------------------- jagged and linear

#[test]
fn crisp_edges_make_their_own_shape_jagged_and_no_other() {
    let scene = path("M0 0H2.625V1H0Z", "#f00", "shape-rendering=\"crispEdges\"")
        + &rect(2.75, 0.0, 4.25, 1.0, "#00f");
    let picture = render(&svg(6, 1, &scene));
    // The crisp shape holds the centre of pixel 2: it is full, before blue takes its quarter.
    assert_eq!(picture.pixel(1, 0), [255, 0, 0, 255]);
    assert_levels(picture.pixel(2, 0), [191.25, 0.0, 63.75, 255.0], STRAIGHT);
    assert_eq!(picture.pixel(3, 0), [0, 0, 255, 255]);
    assert_levels(picture.pixel(4, 0), [0.0, 0.0, 255.0, 63.75], STRAIGHT);
    // Its edge before the centre leaves a pixel empty.
    let short = path("M0 0H2.375V1H0Z", "#f00", "shape-rendering=\"crispEdges\"");
    assert_eq!(render(&svg(6, 1, &short)).pixel(2, 0), [0; 4]);
}

#[test]
fn without_anti_aliasing_a_pixel_has_the_colour_at_its_centre() {
    let jagged = Settings { method: Method::None, ..settings() };
    let triangle = [[1.25, 0.75], [14.75, 4.5], [3.125, 15.25]];
    // No edge runs through a pixel's centre: which side such a pixel takes is a matter of rounding.
    let bar = [[0.25, 9.75], [15.5, 3.25], [15.75, 6.5], [1.25, 12.625]];
    let layers = [Layer::new(&triangle), Layer::new(&bar)];
    let colours = [[200, 100, 0], [0, 50, 250]];
    let body = rect(0.0, 0.0, 16.0, 16.0, "#000")
        + &path(&ring(&triangle), &hex(colours[0]), "")
        + &path(&ring(&bar), &hex(colours[1]), "");
    let picture = render_with(&svg(16, 16, &body), jagged);
    assert_matches(&picture, &sampled(16, 16, 1, &layers, opaque([0, 0, 0], &colours)), 0.0, "jagged");
}

#[test]
fn without_anti_aliasing_two_shapes_which_abut_on_a_centre_leave_no_hole_there() {
    let jagged = Settings { method: Method::None, ..settings() };
    for (a, b) in [
        ("M-1 -1H.5V2H-1Z", "M.5 -1H2V2H.5Z"),
        ("M-1 -1H2V.5H-1Z", "M-1 .5H2V2H-1Z"),
        ("M-1 -1L2 2L-1 2Z", "M-1 -1L2 -1L2 2Z"),
        ("M-1 2L2 -1L2 2Z", "M-1 2L-1 -1L2 -1Z"),
    ] {
        let body = path(a, "#f00", "") + &path(b, "#00f", "");
        let pixel = unit_pixel_with(&body, &jagged);
        assert!(pixel == [255, 0, 0, 255] || pixel == [0, 0, 255, 255], "{pixel:?} is a hole or a mix");
        // Under opacity a pixel which both claimed would be darker.
        let half = "fill-opacity=\".5\"";
        let alpha = unit_pixel_with(&(path(a, "#f00", half) + &path(b, "#00f", half)), &jagged)[3];
        assert!((127..=128).contains(&alpha), "alpha is {alpha}: a hole, or claimed twice");
    }
}

#[test]
fn crisp_edges_and_no_anti_aliasing_sample_alike() {
    let d = "M1.25 .75L14.75 4.5L9.5 9L13 15.5L3.125 15.25Z";
    let crisp = render(&svg(16, 16, &path(d, "#369", "shape-rendering=\"crispEdges\"")));
    let jagged = Settings { method: Method::None, ..settings() };
    let sampled = render_with(&svg(16, 16, &path(d, "#369", "")), jagged);
    assert_same_bytes(&crisp, &sampled, "crisp");
}

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

// ---------------------------------------------------------------------------- background and size

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

// -------------------------------------------------------------------------------------- gradients

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

// ---------------------------------------------------------------------------------------- strokes

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
