//! Strokes are the outline of what is inked.

use super::*;

#[test]
fn a_stroke_over_itself_inks_once() {
    // A cross drawn as one path: two bars of 1 x 8 that share a square.
    let t = truth(9, 9, "<path stroke='#000' fill='none' d='M.5 4.5H8.5M4.5 .5V8.5'/>");
    assert_near(area(&t), 15.0, 1e-9);
}

#[test]
fn a_butt_line_is_a_box_and_a_square_cap_adds_half_a_width() {
    let line = |cap: &str| {
        let body = format!("<path stroke='#000' stroke-width='2' stroke-linecap='{cap}' d='M3 4L9 4'/>");
        area(&truth(12, 8, &body))
    };
    assert_near(line("butt"), 12.0, 1e-9);
    assert_near(line("square"), 16.0, 1e-9);
    assert_near(line("round"), 12.0 + std::f64::consts::PI, 2e-3);
}

#[test]
fn joins_add_their_corners() {
    let corner = |join: &str| {
        let body = format!(
            "<path fill='none' stroke='#000' stroke-width='4' stroke-linejoin='{join}' d='M2 16V4H16'/>"
        );
        area(&truth(20, 20, &body))
    };
    // Two bars of 4 x 12 and 4 x 14 whose inner quarters (2 x 2) overlap.
    let bars = 48.0 + 56.0 - 4.0;
    assert_near(corner("miter"), bars + 4.0, 1e-9);
    assert_near(corner("bevel"), bars + 2.0, 1e-9);
    assert_near(corner("round"), bars + std::f64::consts::PI, 2e-3);
}

#[test]
fn dashes_ink_their_share() {
    let body = "<path stroke='#000' stroke-dasharray='2 1' d='M1 1.5H13'/>";
    let t = truth(14, 3, body);
    assert_near(area(&t), 8.0, 1e-9);
    assert_near(alpha(&t, 1, 1), 1.0, 1e-9);
    assert_near(alpha(&t, 3, 1), 0.0, 1e-9);
}

#[test]
fn a_stroke_is_transformed_after_it_is_made() {
    let body = "<path transform='scale(3 1)' stroke='#000' stroke-width='2' d='M2 1V9'/>";
    assert_near(area(&truth(12, 10, body)), 48.0, 1e-9);
}

#[test]
fn paint_order_decides_whether_the_stroke_or_the_fill_is_in_front() {
    let shape = |order: &str| {
        let body = format!(
            "<rect x='2' y='2' width='4' height='4' fill='#f00' stroke='#00f' stroke-width='2'
                paint-order='{order}'/>"
        );
        truth(8, 8, &body).premultiplied().iter().map(|p| p[2] / 255.0).sum::<f64>()
    };
    assert_near(shape("fill"), 36.0 - 4.0, 1e-9);
    assert_near(shape("stroke"), 36.0 - 16.0, 1e-9);
}
