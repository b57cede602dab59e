//! Strokes are the outline of what is inked.

use super::super::Stroker;
use super::*;

const STROKERS: [Stroker; 2] = [Stroker::Kurbo, Stroker::Pieces];

fn truth_by(stroker: Stroker, width: u32, height: u32, body: &str) -> Truth {
    truth_with(width, height, body, &Options { stroker, ..Options::default() })
}

#[test]
fn a_stroke_over_itself_inks_once() {
    // A cross drawn as one path: two bars of 1 x 8 that share a square.
    for stroker in STROKERS {
        let t = truth_by(stroker, 9, 9, "<path stroke='#000' fill='none' d='M.5 4.5H8.5M4.5 .5V8.5'/>");
        assert_near(area(&t), 15.0, 1e-9);
    }
}

#[test]
fn a_butt_line_is_a_box_and_a_square_cap_adds_half_a_width() {
    for stroker in STROKERS {
        let line = |cap: &str| {
            let body = format!("<path stroke='#000' stroke-width='2' stroke-linecap='{cap}' d='M3 4L9 4'/>");
            area(&truth_by(stroker, 12, 8, &body))
        };
        assert_near(line("butt"), 12.0, 1e-9);
        assert_near(line("square"), 16.0, 1e-9);
        assert_near(line("round"), 12.0 + std::f64::consts::PI, 2e-3);
    }
}

#[test]
fn joins_add_their_corners() {
    for stroker in STROKERS {
        let corner = |join: &str| {
            let body = format!(
                "<path fill='none' stroke='#000' stroke-width='4' stroke-linejoin='{join}'
                    d='M2 16V4H16'/>"
            );
            area(&truth_by(stroker, 20, 20, &body))
        };
        // Two bars of 4 x 12 and 4 x 14 whose inner quarters (2 x 2) overlap.
        let bars = 48.0 + 56.0 - 4.0;
        assert_near(corner("miter"), bars + 4.0, 1e-9);
        assert_near(corner("bevel"), bars + 2.0, 1e-9);
        assert_near(corner("round"), bars + std::f64::consts::PI, 2e-3);
    }
}

#[test]
fn a_clipped_miter_loses_its_tip_beyond_half_the_limit_times_the_width() {
    for stroker in STROKERS {
        let corner = |limit: f64| {
            let body = format!(
                "<path fill='none' stroke='#000' stroke-width='4' stroke-linejoin='miter-clip'
                    stroke-miterlimit='{limit}' d='M2 16V4H16'/>"
            );
            area(&truth_by(stroker, 20, 20, &body))
        };
        let whole = corner(4.0);
        // The tip stands 2 sqrt(2) from the corner, and is a right angle.
        for limit in [1.0, 1.25] {
            let lost = (2.0 * 2f64.sqrt() - 2.0 * limit).powi(2);
            assert_near(corner(limit), whole - lost, 1e-6);
        }
    }
}

#[test]
fn a_miter_beyond_its_limit_is_a_bevel() {
    for stroker in STROKERS {
        let tip = |limit: f64| {
            let body =
                format!("<path fill='none' stroke='#000' stroke-miterlimit='{limit}' d='M4 2L10 20L16 2'/>");
            area(&truth_by(stroker, 20, 26, &body))
        };
        // sin(half the angle) = 6 / hypot(6, 18): the mitre is 3.162 widths long. Beyond the bevel's
        // chord stands a triangle of base cos(half) and height cos(half) / tan(half) / 2.
        let half = 6f64.atan2(18.0);
        assert_near(tip(3.17) - tip(3.16), half.cos().powi(2) / half.tan() / 4.0, 1e-6);
    }
}

#[test]
fn dashes_ink_their_share() {
    let body = "<path stroke='#000' stroke-dasharray='2 1' d='M1 1.5H13'/>";
    for stroker in STROKERS {
        let t = truth_by(stroker, 14, 3, body);
        assert_near(area(&t), 8.0, 1e-9);
        assert_near(alpha(&t, 1, 1), 1.0, 1e-9);
        assert_near(alpha(&t, 3, 1), 0.0, 1e-9);
    }
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

#[test]
fn the_two_strokers_agree_on_curves_corners_and_dashes() {
    let body = "<path d='M5 40C5 -20 30 70 44 8' fill='none' stroke='#822' stroke-width='5'
            stroke-linecap='round' stroke-linejoin='round'/>
        <path d='M60 5C50 20 58 40 40 44L62 60z' fill='none' stroke='#258' stroke-width='3.3'
            stroke-dasharray='7 3 1.5 2' stroke-dashoffset='-4'/>
        <circle cx='20' cy='48' r='9' fill='none' stroke='#000' stroke-width='1.3'/>
        <path transform='rotate(20) scale(1 .4)' d='M30 20q20 60 30 0t-9 -9' fill='none'
            stroke='#0a0' stroke-width='2' stroke-linecap='square'/>";
    let [one, other] = STROKERS.map(|stroker| truth_by(stroker, 64, 64, body));
    let levels = |t: &Truth| t.premultiplied().iter().flatten().copied().collect::<Vec<f64>>();
    let errors = levels(&one).into_iter().zip(levels(&other)).map(|(a, b)| (a - b).abs());
    let worst = errors.fold(0.0, f64::max);
    println!("the two strokers differ by at most {worst:.3} levels");
    assert!(worst < 0.5, "{worst} levels");
}

#[test]
fn a_dash_or_a_line_of_no_length_is_a_dot_if_its_caps_are_round_or_square() {
    let body = |cap: &str| {
        format!(
            "<path stroke='#000' stroke-width='2' stroke-linecap='{cap}' d='M2 2h0M6 2h3'/>
             <path stroke='#000' stroke-width='2' stroke-linecap='{cap}' stroke-dasharray='0 4'
                d='M13 2H24'/>"
        )
    };
    // usvg drops a path of no length whole, so here it is beside a line of 3: with its caps, which make
    // a dot as well, there are five.
    for (cap, dot) in [("butt", 0.0), ("round", std::f64::consts::PI), ("square", 4.0)] {
        for stroker in STROKERS {
            assert_near(area(&truth_by(stroker, 28, 4, &body(cap))), 6.0 + 5.0 * dot, 1e-2);
        }
    }
}

#[test]
fn a_dashed_sub_path_of_no_length_is_nothing() {
    for d in ["M2 2h0M6 2h3", "M2 2zM6 2h3", "M6 2h3M2 2z"] {
        let body = format!(
            "<path stroke='#000' stroke-width='2' stroke-linecap='round' stroke-dasharray='9' d='{d}'/>"
        );
        let truth = truth_by(Stroker::Pieces, 12, 4, &body);
        // The line with its caps.
        assert_near(area(&truth), 6.0 + std::f64::consts::PI, 1e-2);
    }
}

#[test]
fn a_round_join_stands_before_a_line_that_turns_back() {
    for stroker in STROKERS {
        for d in ["M10 3H4H10", "M4 3H10H4", "M4 3C6 3 10 3 10 3H4z"] {
            let body = format!(
                "<path fill='none' stroke='#000' stroke-width='2' stroke-linejoin='round'
                    d='{d}'/>"
            );
            let ends = if d.ends_with('z') { 2.0 } else { 1.0 };
            let wanted = 12.0 + ends * std::f64::consts::PI / 2.0;
            assert_near(area(&truth_by(stroker, 14, 6, &body)), wanted, 5e-3);
        }
    }
}

#[test]
fn a_pen_turns_where_its_curve_turns_on_the_spot() {
    let body = |d: &str| {
        format!("<path fill='none' stroke='#000' stroke-width='4' stroke-linejoin='round' d='{d}'/>")
    };
    // It sets out upwards, and has turned before it has gone anywhere: what a pen inks on its outer
    // side while it turns. On the inner side the strokers differ.
    let [kurbo, pieces] = STROKERS.map(|s| truth_by(s, 16, 16, &body("M4 4C4 3.999 10 10 10 14")));
    for (x, y) in [(2, 2), (3, 2), (4, 2), (5, 2), (2, 3), (5, 3)] {
        assert!(alpha(&pieces, x, y) > 0.2, "the pen's turn is inked");
        assert_near(alpha(&pieces, x, y), alpha(&kurbo, x, y), 2e-3);
    }
    // Out and back: a line with a round end.
    let out_and_back = truth_by(Stroker::Pieces, 16, 16, &body("M3 5C11 9 11 9 3 5"));
    let line = truth_by(Stroker::Pieces, 16, 16, &body("M3 5L9 8L3 5"));
    assert_near(area(&out_and_back), area(&line), 5e-3);
}
