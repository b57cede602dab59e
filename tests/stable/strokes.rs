//! Strokes over themselves.

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
