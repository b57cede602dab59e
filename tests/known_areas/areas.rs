//! Shapes alone: their areas, curves and winding numbers.

use super::*;

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
