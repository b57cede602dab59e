//! Strokes over themselves, along lines that lie on one another, and round tight curves.

use super::*;

#[test]
fn a_stroke_over_itself_covers_once_in_every_pixel() {
    // A zigzag whose thick level strokes overlap, half transparent: nothing is lit twice.
    let d = "M3 4H29V6H3V8H29V10H3";
    let attributes = "stroke=\"#fff\" stroke-width=\"4\" stroke-opacity=\".5\"";
    let body = rect(0.0, 0.0, 32.0, 16.0, "#000") + &path(d, "none", attributes);
    let picture = render(&svg(32, 16, &body));
    for y in 2..12 {
        for x in 5..27 {
            assert_levels(picture.pixel(x, y), [127.5, 127.5, 127.5, 255.0], STRAIGHT);
        }
    }
    assert!(picture.data().chunks(4).all(|p| p[0] <= 128), "something is lit twice");
}

#[test]
fn thin_strokes_which_cross_themselves_inside_pixels_cover_their_union() {
    // A level comb of bars .3 wide against an upright one, each one path: bars of polygons.
    let mut d = String::new();
    let mut bars = Vec::new();
    for i in 0..16 {
        let at = 0.4375 + f64::from(i);
        d += &format!("M0 {at}H16M{at} 0V16");
        bars.push(corners(0.0, at - 0.15625, 16.0, at + 0.15625));
        bars.push(corners(at - 0.15625, 0.0, at + 0.15625, 16.0));
    }
    let body =
        rect(0.0, 0.0, 16.0, 16.0, "#000") + &path(&d, "none", "stroke=\"#fff\" stroke-width=\".3125\"");
    let truth = Sweep::exact(&[Layer::of(&bars)]).picture(16, 16, opaque([0; 3], &[WHITE]));
    assert_matches(&render(&svg(16, 16, &body)), &truth, CURVED, "combs");
}

#[test]
fn a_stroke_wound_twice_round_covers_what_lies_within_half_its_width() {
    // Twice round a square spiral with round joins, each turn overlapping the one before.
    let turns = [
        [8.0, 8.0],
        [24.0, 8.0],
        [24.0, 24.0],
        [8.0, 24.0],
        [8.0, 10.0],
        [22.0, 10.0],
        [22.0, 22.0],
        [10.0, 22.0],
    ];
    let d = ring(&turns).replace('Z', "");
    let attributes = "stroke=\"#fff\" stroke-width=\"6\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
    let body = rect(0.0, 0.0, 32.0, 32.0, "#000") + &path(&d, "none", attributes);
    let picture = render(&svg(32, 32, &body));
    let (mut inside, mut outside) = (0, 0);
    for y in 0..32 {
        for x in 0..32 {
            let centre = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let far = turns.windows(2).map(|e| distance_to_segment(centre, e[0], e[1])).fold(99.0, f64::min);
            // A pixel reaches .71 from its centre.
            if far < 3.0 - 0.75 {
                assert_eq!(picture.pixel(x, y), [255; 4], "pixel ({x}, {y})");
                inside += 1;
            } else if far > 3.0 + 0.75 {
                assert_eq!(picture.pixel(x, y), [0, 0, 0, 255], "pixel ({x}, {y})");
                outside += 1;
            }
        }
    }
    assert!(inside > 300 && outside > 200, "{inside} inside, {outside} outside");
}

fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (e[0] - t * d[0]).hypot(e[1] - t * d[1])
}

#[test]
fn a_stroke_wider_than_its_curl_has_no_hole() {
    // A loop of radius about 2 under a stroke of 12: all within 4 of it is covered.
    let body =
        path("M16 14C20 14 20 18 16 18C12 18 12 14 16 14", "none", "stroke=\"#0a0\" stroke-width=\"12\"");
    let picture = render(&svg(32, 32, &body));
    for y in 11..21 {
        for x in 11..21 {
            assert_eq!(picture.pixel(x, y), [0, 0xaa, 0, 255], "pixel ({x}, {y})");
        }
    }
}

#[test]
fn a_stroke_there_and_back_is_the_stroke_there() {
    let line = |d: &str| render(&white_on_black(16, 8, d, "stroke=\"#fff\" stroke-width=\"2.5\""));
    assert_within(&line("M2 3L14 5L2 3"), &line("M2 3L14 5"), CURVED, "there and back");
}

/// Points on a coarse grid: lines that lie on one another, turn back, go nowhere or end where a dash does.
#[test]
fn strokes_on_a_coarse_grid_are_the_truth() {
    let mut rng = Rng::new(5);
    let mut body = String::new();
    for place in 0..400 {
        let steps = [2.0, 3.0, 5.0][place % 3];
        let mut at = || format!("{:.4}", 6.0 + 20.0 / steps * rng.below(steps as u64 + 1) as f64);
        let mut point = || format!("{} {}", at(), at());
        let mut path = format!("M{}", point());
        for step in 0..1 + place % 5 {
            path += &match (place + 3 * step) % 7 {
                0 => "z".to_owned(),
                1 => format!("zM{}L{}", point(), point()),
                2 => "q0 0 0 0".to_owned(),
                _ => format!("L{}", point()),
            };
        }
        let mut one_of = |values: &[&'static str]| values[rng.below(values.len() as u64) as usize];
        let dashes = one_of(&["none", "none", "4 2", "0 5", "3", "10 20", "5 0", "20 1 3", "6 4"]);
        let offset = one_of(&["0", "0", "3", "-4"]);
        let (cap, join) = (one_of(&["butt", "round", "square"]), one_of(&["miter", "round", "bevel"]));
        let (width, limit) = (one_of(&["0.5", "1", "2", "3", "6", "8"]), one_of(&["4", "10", "1.2"]));
        let turn = one_of(&["", "rotate(45 16 16)", "rotate(90 16 16)", "rotate(17.3 16 16)", "scale(1 .5)"]);
        let (x, y) = (place % 20 * 32, place / 20 * 32);
        body += &format!(
            "<path transform='translate({x} {y}) {turn}' d='{path}' stroke-width='{width}' stroke-linecap='{cap}'
                stroke-linejoin='{join}' stroke-miterlimit='{limit}' stroke-dasharray='{dashes}'
                stroke-dashoffset='{offset}'/>"
        );
    }
    let difference = difference_of_strokes(640, &body);
    assert!(difference.max <= CURVED, "{difference:?}");
}

/// Cubics that turn in less room than the pen has, up to cusps: one of its ends goes backwards there.
#[test]
fn wide_pens_on_tight_curves_are_near_the_truth() {
    const LEVELS: f64 = 1.5;
    let mut rng = Rng::new(11);
    let mut body = String::new();
    for place in 0..64 {
        let middle = [place % 8, place / 8].map(|at| f64::from(at) * 24.0 + 12.0);
        let reach = [0.3, 1.0, 2.0, 5.0][place as usize % 4];
        let mut point = || middle.map(|at| format!("{:.4}", at + rng.between(-reach, reach))).join(" ");
        let path = format!("M{}C{} {} {}", point(), point(), point(), point());
        body += &format!("<path d='{path}' stroke-width='{:.2}'/>", rng.between(4.0, 10.0));
    }
    let difference = difference_of_strokes(192, &body);
    assert!(difference.max <= LEVELS, "{difference:?}");
}

/// How far the renderer is from the truth on black strokes, in a square picture.
fn difference_of_strokes(side: u32, body: &str) -> reference::Difference {
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {side} {side}'><g fill='none' stroke='#000'>{body}</g></svg>"
    );
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).expect("valid SVG");
    let scene = Scene::from_tree(&tree).expect("a scene");
    let viewport = Viewport::fit(&scene, side, side);
    // Finer, and many pixels have more pieces than the truth takes exactly.
    let options = reference::Options { tolerance: 1e-3, ..Default::default() };
    let truth = reference::render(&tree, &viewport, &options).expect("a picture");
    let picture = Renderer::new(Settings::default()).expect("settings").render(&scene, &viewport);
    let difference = truth.compare(&picture.expect("a picture"));
    println!("{} pixels approximate, {difference:.3?}", truth.approximate);
    difference
}
