//! Translucent shapes and groups.

use super::*;

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
