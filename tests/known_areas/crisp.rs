//! Shapes and pictures that are not anti-aliased.

use super::*;

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
