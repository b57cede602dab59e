//! Shapes whose areas are known.

use super::*;

#[test]
fn half_a_pixel_is_half_covered() {
    let t = truth(2, 1, "<path d='M.5 0H1V1H.5z'/>");
    assert_near(alpha(&t, 0, 0), 0.5, 1e-12);
    assert_eq!(alpha(&t, 1, 0), 0.0);
}

#[test]
fn a_triangle_covers_half_of_its_box() {
    let t = truth(1, 1, "<path d='M0 0L1 0L0 1z'/>");
    assert_near(alpha(&t, 0, 0), 0.5, 1e-12);
    let t = truth(4, 3, "<path d='M0 3L4 3L2 0z'/>");
    assert_near(area(&t), 6.0, 1e-12);
    assert_near(alpha(&t, 0, 2), 2.0 / 3.0, 1e-6);
}

#[test]
fn a_shape_inside_one_pixel_keeps_its_area() {
    let t = truth(3, 3, "<path d='M1.25 1.25h.5v.25h-.5z'/>");
    assert_near(alpha(&t, 1, 1), 0.125, 1e-12);
    assert_near(area(&t), 0.125, 1e-12);
}

#[test]
fn a_horizontal_edge_cuts_pixels_that_hold_no_vertex() {
    let t = truth(9, 1, "<path d='M.5 .25H8.5V1H.5z'/>");
    for x in 1..8 {
        assert_near(alpha(&t, x, 0), 0.75, 1e-12);
    }
    assert_near(alpha(&t, 0, 0), 0.375, 1e-12);
}

#[test]
fn shapes_that_share_an_edge_leave_no_seam() {
    let body = "<rect width='7' height='7' fill='#fff'/>
        <path fill='#0a0' d='M0 0H3.3L4.7 7H0z'/><path fill='#0a0' d='M7 0H3.3L4.7 7H7z'/>";
    let t = truth(7, 7, body);
    for y in 0..7 {
        for x in 0..7 {
            let [r, g, b, a] = t.straight(x, y);
            assert_near(r.abs().max((g - 170.0).abs()).max(b.abs()).max((a - 255.0).abs()), 0.0, 1e-9);
        }
    }
}

#[test]
fn a_shape_exactly_on_another_leaves_no_fringe() {
    let d = "M.3 .4L6.1 1.2L3.7 6.6z";
    let body = format!("<path d='{d}'/><path fill='#fff' d='{d}'/>");
    for pixel in truth(7, 7, &body).premultiplied() {
        assert_near(pixel[0], pixel[3], 1e-9);
    }
}

#[test]
fn a_thin_sliver_keeps_its_area() {
    let t = truth(64, 64, "<path d='M1 1L63 62L63.001 62z'/>");
    // Half of the base, .001 as f32 stores it, times the height.
    let base = f64::from(63.001f32) - 63.0;
    assert_near(area(&t), base * 61.0 / 2.0, 1e-9);
}

const STAR: &str = "M32 4L48.458 54.652L5.371 23.348L58.629 23.348L15.542 54.652z";

#[test]
fn a_star_has_its_heart_under_nonzero_and_a_hole_under_evenodd() {
    // A pentagram of circumradius 28: its outline has area 10 R^2 sin^2(18) tan(54) ... by shoelace
    // over the ten corners; the heart is a pentagon of circumradius R (sin 18 / sin 54).
    let r: f64 = 28.0;
    let inner = r * 18f64.to_radians().sin() / 54f64.to_radians().sin();
    let outline = 5.0 * r * inner * 36f64.to_radians().sin();
    let heart = 2.5 * inner * inner * 72f64.to_radians().sin();
    let whole = truth(64, 64, &format!("<path d='{STAR}'/>"));
    let pierced = truth(64, 64, &format!("<path fill-rule='evenodd' d='{STAR}'/>"));
    assert_near(area(&whole), outline, 0.05);
    assert_near(area(&pierced), outline - heart, 0.05);
    assert_near(alpha(&whole, 32, 32), 1.0, 1e-12);
    assert_near(alpha(&pierced, 32, 32), 0.0, 1e-12);
}

#[test]
fn winding_twice_is_inside_under_nonzero_and_outside_under_evenodd() {
    let d = "M.5 0H1V1H.5zM.5 0H1V1H.5z";
    assert_near(alpha(&truth(1, 1, &format!("<path d='{d}'/>")), 0, 0), 0.5, 1e-12);
    let even = truth(1, 1, &format!("<path fill-rule='evenodd' d='{d}'/>"));
    assert_near(alpha(&even, 0, 0), 0.0, 1e-12);
}

#[test]
fn overlap_in_one_pixel_is_not_counted_twice() {
    let t = truth(1, 1, "<path d='M0 0H.5V1H0z'/><path d='M0 0H1V.5H0z'/>");
    assert_near(alpha(&t, 0, 0), 0.75, 1e-12);
    let t = truth(1, 1, "<path fill='red' d='M0 0H.5V1H0z'/><path fill='blue' d='M0 0H1V.5H0z'/>");
    let [r, _, b, a] = t.premultiplied()[0];
    assert_near(r, 0.25 * 255.0, 1e-9);
    assert_near(b, 0.5 * 255.0, 1e-9);
    assert_near(a, 0.75 * 255.0, 1e-9);
}

#[test]
fn a_shape_far_outside_changes_nothing_and_one_that_starts_outside_is_cut() {
    let t = truth(4, 4, "<path d='M-900 -900H-10V900z'/><path d='M-100 -100H2.5V100H-100z'/>");
    assert_near(area(&t), 10.0, 1e-12);
}

#[test]
fn crisp_edges_are_jagged_and_go_by_the_centre() {
    let body = "<path shape-rendering='crispEdges' d='M.4 0H2.6V1H.4z'/>
        <path shape-rendering='crispEdges' d='M5.6 .6H8V1H5.6z'/>";
    let t = truth(8, 1, body);
    let alphas: Vec<f64> = (0..8).map(|x| alpha(&t, x, 0)).collect();
    assert_eq!(alphas, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

/// Which pixels of a drawing hold anything, row by row.
fn painted(truth: &Truth) -> Vec<bool> {
    truth.premultiplied().iter().map(|pixel| pixel[3] > 0.0).collect()
}

#[test]
fn a_jagged_shape_goes_on_to_the_border_which_it_crosses() {
    let t = truth(5, 1, "<path shape-rendering='crispEdges' d='M1.6 -9V9H50V-9z'/>");
    assert_eq!(painted(&t), [false, false, true, true, true]);
    let t = truth(3, 1, "<path shape-rendering='crispEdges' d='M1.2 .5L9 -4L9 5z'/>");
    assert_eq!(painted(&t), [false, true, true]);
    let t = truth(3, 2, "<path shape-rendering='crispEdges' d='M-9 -9H9V9H-9z'/>");
    assert_eq!(painted(&t), [true; 6]);
}

#[test]
fn a_centre_on_an_edge_of_a_jagged_shape_belongs_to_the_right_or_lower_side() {
    for (d, wanted) in [
        ("M.5 -1H9V9H.5z", true),
        ("M-9 -1H.5V9H-9z", false),
        ("M-1 .5H9V9H-1z", true),
        ("M-1 -9H9V.5H-1z", false),
        // The diagonals: of the upper right half, which has the right side, and so on.
        ("M-1 -1H2V2z", true),
        ("M-1 -1V2H2z", false),
        ("M-1 2H2V-1z", true),
        ("M-1 2V-1H2z", false),
        // A slope that no binary fraction is.
        ("M-2.5 -.5L3.5 1.5L4 -1z", true),
        ("M-2.5 -.5L3.5 1.5L-3 2z", false),
    ] {
        let t = truth(1, 1, &format!("<path shape-rendering='crispEdges' d='{d}'/>"));
        assert_eq!(painted(&t), [wanted], "{d}");
    }
}

#[test]
fn optimize_speed_is_as_jagged_as_crisp_edges() {
    for (mode, wanted) in [("optimizeSpeed", 1.0), ("crispEdges", 1.0), ("geometricPrecision", 0.75)] {
        let t = truth(1, 1, &format!("<path shape-rendering='{mode}' d='M0 0H.75V1H0z'/>"));
        assert_near(alpha(&t, 0, 0), wanted, 1e-12);
    }
}

#[test]
fn a_circle_has_the_area_of_a_circle() {
    let t = truth(41, 41, "<circle cx='20.3' cy='20.6' r='18'/>");
    // usvg's circle of four cubic (or conic) arcs is itself off by up to 3e-4 of the radius.
    assert_near(area(&t), std::f64::consts::PI * 18.0 * 18.0, 0.5);
}

#[test]
fn linear_light_mixes_areas_but_not_opacity() {
    let linear = Options { linear: true, ..Options::default() };
    let body = "<path fill='#fff' d='M0 0H2V1H0z'/><path d='M0 0H.5V1H0z'/>
        <path fill-opacity='.5' d='M1 0H2V1H1z'/>";
    let t = truth_with(2, 1, body, &linear);
    assert_near(t.straight(0, 0)[0], 187.516, 1e-3);
    assert_near(t.straight(1, 0)[0], 127.5, 1e-9);
    assert_near(truth(2, 1, body).straight(0, 0)[0], 127.5, 1e-9);
}

#[test]
fn the_background_lies_behind_everything() {
    let green = Options { background: Some([0, 255, 0, 255]), ..Options::default() };
    let t = truth_with(2, 1, "<path fill='red' d='M0 0H.5V1H0z'/>", &green);
    assert_eq!(t.premultiplied()[1], [0.0, 255.0, 0.0, 255.0]);
    assert_near(t.premultiplied()[0][0], 127.5, 1e-9);
    assert_near(t.premultiplied()[0][1], 127.5, 1e-9);
}

#[test]
fn a_linear_gradient_is_its_mean_in_every_pixel() {
    let body = "<linearGradient id='g' gradientUnits='userSpaceOnUse' x2='8'>
        <stop stop-color='#000'/><stop offset='1' stop-color='#fff'/></linearGradient>
        <path fill='url(#g)' d='M0 0H7.5V1H0z'/>";
    let t = truth(8, 1, body);
    for x in 0..7 {
        assert_near(t.straight(x, 0)[0], 255.0 * (f64::from(x) + 0.5) / 8.0, 1e-6);
    }
    assert_near(t.straight(7, 0)[0], 255.0 * 7.25 / 8.0, 1e-6);
    assert_near(alpha(&t, 7, 0), 0.5, 1e-12);
}

#[test]
fn a_difference_measures_the_worst_channel_and_finds_its_pixel() {
    let t = truth(3, 2, "<path fill='#646464' d='M0 0H3V2H0z'/>");
    let mut pixmap = t.to_pixmap();
    assert_eq!(t.compare(&pixmap).max, 0.0);
    pixmap.data_mut()[16] += 5;
    let d = t.compare(&pixmap);
    assert_near(d.max, 5.0, 1e-12);
    assert_eq!(d.worst, (1, 1));
    assert_near(d.mean, 5.0 / 24.0, 1e-12);
    assert_near(d.over_4, 1.0 / 6.0, 1e-12);
    assert_eq!(d.over_16, 0.0);
}

#[test]
fn the_rounded_truth_is_within_half_a_level() {
    let body = "<path fill='#37b' opacity='.7' d='M.3 .4L9.1 1.2L3.7 9.6z'/>
        <path fill='#fa3' d='M5.5 .1L9.9 9.7L1.7 6.6z'/>";
    let t = truth(10, 10, body);
    assert!(t.compare(&t.to_pixmap()).max <= 0.5 + 1e-9);
}
