//! Outlines of paths, by their areas and their edges.

use super::*;
use crate::edges::{Edge, EdgeList, BAND_ROWS, ONE};
use kurbo::{Join, Stroke};

/// All edges of an outline on 64 x 64 pixels, sorted: x0, y0, x1, y1, winding.
fn edges(path: &str, style: &Stroke) -> Vec<[i32; 5]> {
    edges_of(path, &style.clone().into())
}

fn edges_of(path: &str, style: &StrokeStyle) -> Vec<[i32; 5]> {
    let path = BezPath::from_svg(path).expect("a path");
    let mut list = EdgeList::new(64, 64);
    Pen::default().stroke(path.iter(), style, (Affine::IDENTITY, 1.0), 0.01, &mut list);
    let banded = list.take_banded();
    // An edge stands in every band that it meets; it counts in the one in which it begins.
    let begins = |edge: &Edge, band: usize| edge.y0.max(0) / (BAND_ROWS as i32 * ONE) == band as i32;
    let mut all: Vec<_> = (0..64 / BAND_ROWS as usize)
        .flat_map(|band| banded.band(band).iter().filter(move |edge| begins(edge, band)))
        .map(|e| [e.x0, e.y0, e.x1, e.y1, e.winding])
        .collect();
    all.sort_unstable();
    all
}

/// The outline's signed area in pixels: positive if it winds the other way.
fn area(path: &str, style: &Stroke) -> f64 {
    area_of(path, &style.clone().into())
}

fn area_of(path: &str, style: &StrokeStyle) -> f64 {
    let one = f64::from(ONE);
    let doubled: f64 = edges_of(path, style)
        .iter()
        .map(|&[x0, y0, x1, y1, winding]| f64::from(winding) * f64::from(y1 - y0) * f64::from(x0 + x1))
        .sum();
    0.5 * doubled / one / one
}

fn assert_area(path: &str, style: &Stroke, expected: f64) {
    let found = area(path, style).abs();
    assert!((found - expected).abs() < 2e-3 * expected.max(1.0), "{path}: {found}, not {expected}");
}

fn pen(width: f64) -> Stroke {
    Stroke::new(width).with_caps(Cap::Butt).with_join(Join::Bevel)
}

#[test]
fn a_line_is_its_box_and_its_caps() {
    assert_area("M10 10H30", &pen(4.0), 80.0);
    assert_area("M10 10H30", &pen(4.0).with_caps(Cap::Square), 96.0);
    assert_area("M10 10H30", &pen(4.0).with_caps(Cap::Round), 80.0 + 4.0 * std::f64::consts::PI);
}

#[test]
fn a_corner_of_long_lines_has_no_loop() {
    // The inner sides end where they meet, so the sum is the true area: two boxes, less the square
    // that both cover, and the join on the outer side.
    let corner = |join| pen(4.0).with_join(join);
    let boxes = 2.0 * 20.0 * 4.0 - 4.0;
    assert_area("M10 30H30V10", &corner(Join::Miter), boxes + 4.0);
    assert_area("M10 30H30V10", &corner(Join::Bevel), boxes + 2.0);
    assert_area("M10 30H30V10", &corner(Join::Round), boxes + std::f64::consts::PI);
}

#[test]
fn sides_of_lines_that_meet_in_a_point_have_no_other_vertex() {
    let count = |path: &str, join| edges(path, &pen(2.0).with_join(join)).len();
    // Two lines on either side, and the two ends.
    assert_eq!(count("M10 30.3H20.2L30 20", Join::Miter), 6);
    assert_eq!(count("M10 30.3H20.2L30 29.7", Join::Round), 6);
    // Across a bevel, and along an arc.
    assert_eq!(count("M10 30.3H20.2L30 20", Join::Bevel), 7);
    assert!(count("M10 30.3H20.2L30 20", Join::Round) > 7);
}

#[test]
fn a_line_that_turns_back_has_its_joins_in_every_direction() {
    for i in 0..720 {
        let (sine, cosine) = (f64::from(i) * std::f64::consts::TAU / 720.0).sin_cos();
        // As the parser reads it.
        let [x, y] = [cosine, sine].map(|v| (31.7 + 25.3 * v) as f32);
        let length = f64::from(x - 31.7).hypot(f64::from(y - 31.7));
        for (join, one) in [(Join::Miter, 0.0), (Join::Bevel, 0.0), (Join::Round, 2.0 * std::f64::consts::PI)]
        {
            // Each of the two lines has its box.
            let boxes = 2.0 * 4.0 * length;
            assert_area(&format!("M31.7 31.7L{x} {y}L31.7 31.7"), &pen(4.0).with_join(join), boxes + one);
            assert_area(&format!("M31.7 31.7L{x} {y}z"), &pen(4.0).with_join(join), boxes + 2.0 * one);
        }
    }
}

#[test]
fn a_miter_over_its_limit_is_a_bevel() {
    let sharp = "M10 10L40 14L10 18";
    let miter = |limit| area(sharp, &pen(2.0).with_join(Join::Miter).with_miter_limit(limit)).abs();
    assert_eq!(miter(4.0), area(sharp, &pen(2.0)).abs());
    assert!(miter(12.0) > miter(4.0) + 5.0, "{} {}", miter(12.0), miter(4.0));
}

#[test]
fn a_clipped_miter_ends_at_half_the_limit_times_the_width() {
    // A quarter turn of a line 4 wide: its miter, 2 wide and high, ends 2 sqrt(2) from the corner.
    let corner = |limit: f64| {
        let line = pen(4.0).with_join(Join::Miter).with_miter_limit(limit);
        area_of("M10 30H30V10", &StrokeStyle { line, clips_miters: true }).abs()
    };
    let boxes = 2.0 * 20.0 * 4.0 - 4.0;
    assert!((corner(4.0) - (boxes + 4.0)).abs() < 0.01, "{}", corner(4.0));
    // Of the miter's tip, what lies beyond 2 * limit from the corner is a right triangle that high.
    let missing = |limit: f64| (2.0 * 2f64.sqrt() - 2.0 * limit).powi(2);
    for limit in [1.0, 1.2, 1.4] {
        let expected = boxes + 4.0 - missing(limit);
        assert!((corner(limit) - expected).abs() < 0.01, "{limit}: {} not {expected}", corner(limit));
    }
    // A path that turns back: both edges go on for half the limit times the width.
    let line = pen(4.0).with_join(Join::Miter).with_miter_limit(3.0);
    let clipped = StrokeStyle { line, clips_miters: true };
    assert!((area_of("M10 10H30H20", &clipped).abs() - (20.0 + 10.0 + 6.0) * 4.0).abs() < 0.01);
    assert_eq!(edges_of("M10 10L30 14L10 19", &clipped), edges_of("M10 19L30 14L10 10", &clipped));
}

#[test]
fn a_ring_has_its_area() {
    // Four cubics within 3e-4 of the circle's radius.
    let k = 0.5522847498 * 20.0;
    let (low, high) = (32.0 - k, 32.0 + k);
    let circle = format!(
        "M52 32C52 {high} {high} 52 32 52C{low} 52 12 {high} 12 32C12 {low} {low} 12 32 12C{high} 12 52 {low} 52 32Z"
    );
    assert_area(&circle, &pen(6.0), 2.0 * std::f64::consts::PI * 20.0 * 6.0);
}

#[test]
fn both_directions_have_the_same_outline() {
    let styles =
        [pen(3.0), pen(9.0).with_join(Join::Round).with_caps(Cap::Round), pen(5.0).with_join(Join::Miter)];
    let paths = [
        ("M10 10L40 14L20 30", "M20 30L40 14L10 10"),
        ("M10 50C10 10 50 10 50 50", "M50 50C50 10 10 10 10 50"),
        ("M10 50C60 10 0 10 50 50L20 20", "M20 20L50 50C0 10 60 10 10 50"),
        // Tighter than the pen, and with a cusp.
        ("M20 40C34 10 26 10 30 40", "M30 40C26 10 34 10 20 40"),
        ("M10 50C50 10 10 10 50 50", "M50 50C10 10 50 10 10 50"),
    ];
    for style in &styles {
        for (there, back) in paths {
            assert_eq!(edges(there, style), edges(back, style), "{there}, width {}", style.width);
        }
    }
}

#[test]
fn all_pieces_wind_one_way() {
    // A tight curl under a wide pen: as a sum of pieces of one sign, it covers no less than its union.
    let curl = "M28 28C32 28 32 32 28 32C24 32 24 28 28 28";
    assert!(area(curl, &pen(20.0)).abs() > std::f64::consts::PI * 100.0);
    let cusp = "M10 50C50 10 10 10 50 50";
    assert!(area(cusp, &pen(8.0)).abs() > 8.0 * 40.0);
}

#[test]
fn a_control_point_beside_its_end_by_rounding_gives_no_direction() {
    let corner =
        |control: &str| area(&format!("M40 10L26 6C26 6 {control} 26 40"), &pen(6.0).with_join(Join::Miter));
    let expected = corner("26 6");
    for control in ["26.000000000000004 6.000000000000003", "25.999999999999996 6"] {
        assert!((corner(control) - expected).abs() < 1e-3, "{control}");
    }
}

#[test]
fn a_path_that_goes_nowhere_has_caps_only() {
    let round = pen(10.0).with_caps(Cap::Round);
    assert_area("M30 30Z", &round, 25.0 * std::f64::consts::PI);
    assert_area("M30 30L30 30", &round, 25.0 * std::f64::consts::PI);
    assert_area("M30 30Z", &pen(10.0).with_caps(Cap::Square), 100.0);
    assert_eq!(edges("M30 30Z", &pen(10.0)), Vec::<[i32; 5]>::new());
    assert_eq!(edges("M30 30", &round), Vec::<[i32; 5]>::new());
    let around = edges("M30 30Z", &round);
    let is_near = |v: i32| (24 * ONE..36 * ONE).contains(&v);
    assert!(around.iter().all(|edge| edge[..4].iter().all(|&v| is_near(v))), "{around:?}");
}

#[test]
fn points_that_are_not_numbers_end_in_time() {
    for path in ["M0 0C1e300 1e300 -1e300 1e300 9 9", "M0 0L1e308 1e308L-1e308 0Z", "M5 5C5 5 5 5 5 5"] {
        edges(path, &pen(3.0));
    }
}
