//! Clips.

use super::*;

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
