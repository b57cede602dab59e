//! Hard cases: what breaks rasterizers, each held against an oracle or a figure worked out on paper.

mod support;

use std::time::{Duration, Instant};
use support::*;
use toon_raster::reference;
use toon_raster::{Error, Options, Pixmap, Scene, Settings, Viewport};

/// Farthest a level may be off where hundreds of pieces cross in one pixel and the renderer may
/// fall back from its recursion to samples.
const DENSE: f64 = 8.0;

/// Longest any one picture of this file may take, in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

const RED: [u8; 3] = [255, 0, 0];
const WHITE: [u8; 3] = [255, 255, 255];

/// The document of opaque layers, back to front, on black.
fn document(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]]) -> String {
    let mut body = rect(0.0, 0.0, width.into(), height.into(), "#000");
    for (layer, colour) in layers.iter().zip(colours) {
        let rule = if layer.rule == Rule::EvenOdd { "fill-rule=\"evenodd\"" } else { "" };
        body += &path(&rings(&layer.rings), &hex(*colour), rule);
    }
    svg(width, height, &body)
}

fn draw(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]]) -> Pixmap {
    let started = Instant::now();
    let picture = render(&document(width, height, layers, colours));
    assert!(started.elapsed() < PATIENCE, "one picture took {:?}", started.elapsed());
    picture
}

/// Draws opaque layers on black and holds every pixel against the exact sweep.
#[track_caller]
fn assert_exact(width: u32, height: u32, layers: &[Layer], colours: &[[u8; 3]], what: &str) {
    let truth = Sweep::exact(layers).picture(width, height, opaque([0, 0, 0], colours));
    assert_matches(&draw(width, height, layers, colours), &truth, STRAIGHT, what);
}

#[track_caller]
fn assert_white(width: u32, height: u32, rings: &[Vec<Point>], what: &str) {
    assert_exact(width, height, &[Layer::of(rings)], &[WHITE], what);
    assert_exact(width, height, &[Layer::of(rings).even_odd()], &[WHITE], what);
}

fn colours(rng: &mut Rng, count: usize) -> Vec<[u8; 3]> {
    (0..count).map(|_| rng.colour()).collect()
}

/// Many small pictures at once: `side` × `side` cells of 3 × 3 pixels, each with its own layers,
/// which `make` gives inside [0, 3]²; each cell is held against its own sweep.
#[track_caller]
fn assert_cells(side: u32, what: &str, mut make: impl FnMut(u32) -> Vec<Layer>) {
    let mut rng = Rng::new(side.into());
    let mut all = (Vec::new(), Vec::new());
    let mut cells = Vec::new();
    for cell in 0..side * side {
        let layers = make(cell);
        let colours = colours(&mut rng, layers.len());
        let (left, top) = (f64::from(cell % side * 3), f64::from(cell / side * 3));
        for layer in &layers {
            let moved = |ring: &Vec<Point>| ring.iter().map(|p| [p[0] + left, p[1] + top]).collect();
            all.0.push(Layer { rings: layer.rings.iter().map(moved).collect(), rule: layer.rule });
        }
        all.1.extend(&colours);
        cells.push((layers, colours));
    }
    let picture = draw(side * 3, side * 3, &all.0, &all.1);
    for (cell, (layers, colours)) in cells.iter().enumerate() {
        let truth = Sweep::exact(layers).picture(3, 3, opaque([0, 0, 0], colours));
        for i in 0..9 {
            let (x, y) = (cell as u32 % side * 3 + i % 3, cell as u32 / side * 3 + i / 3);
            let (found, expected) = (picture.pixel(x, y), truth.pixel(i % 3, i / 3));
            let off = distance(premultiplied(found), expected);
            assert!(
                off <= STRAIGHT,
                "{what}, cell {cell}, pixel ({}, {}): {found:?}, should be {expected:?}: off by {off:.3}; {layers:?}",
                i % 3,
                i / 3
            );
        }
    }
}

// ------------------------------------------------------------------------------ thin and crowded

#[test]
fn slivers_have_their_area_however_thin_they_are() {
    let mut rng = Rng::new(1);
    let slivers: Vec<Layer> = (0..40)
        .map(|_| {
            let (a, b) = (rng.point(0.0, 32.0), rng.point(0.0, 32.0));
            Layer::new(&[a, b, [b[0] + 1.0 / 64.0, b[1]], [a[0] + 1.0 / 64.0, a[1]]])
        })
        .collect();
    let colours = colours(&mut rng, 40);
    assert_exact(32, 32, &slivers, &colours, "slivers");
}

#[test]
fn needles_have_their_area_to_the_tip() {
    let needles: Vec<Layer> = (0..48)
        .map(|i| {
            let y = f64::from(i) / 2.0 + 1.0;
            Layer::new(&[[0.5, 12.0 + f64::from(i % 7) / 64.0], [31.5, y], [31.5, y + 1.0 / 64.0]])
        })
        .collect();
    let colours = colours(&mut Rng::new(2), 48);
    assert_exact(32, 28, &needles, &colours, "needles");
}

/// The wedges of a disk around (8.125, 8.375), between corners on the 1/64 grid.
fn wedges(count: usize) -> Vec<Vec<Point>> {
    let hub = [8.125, 8.375];
    let rim = |i: usize| {
        let angle = std::f64::consts::TAU * (i % count) as f64 / count as f64;
        let snap = |v: f64| (v * 64.0).round() / 64.0;
        [snap(hub[0] + 200.0 * angle.cos()), snap(hub[1] + 200.0 * angle.sin())]
    };
    (0..count).map(|i| vec![hub, rim(i), rim(i + 1)]).collect()
}

#[test]
fn thousands_of_edges_through_one_point_keep_their_areas() {
    let wedges = wedges(2000);
    let white: Vec<Vec<Point>> = wedges.iter().step_by(2).cloned().collect();
    let truth = coverage(16, 16, &white);
    let one_path = draw(16, 16, &[Layer::of(&white)], &[WHITE]);
    assert_matches(&one_path, &truth, STRAIGHT, "one path");
    let layers: Vec<Layer> = wedges.iter().map(|w| Layer::new(w)).collect();
    let colours: Vec<[u8; 3]> = (0..2000).map(|i| if i % 2 == 0 { WHITE } else { [0; 3] }).collect();
    let shapes = draw(16, 16, &layers, &colours);
    assert_matches(&shapes, &truth, DENSE, "a shape each");
    assert!(mean_error(&shapes, &truth) < STRAIGHT, "mean error {}", mean_error(&shapes, &truth));
}

#[test]
fn wedges_which_meet_in_one_point_in_one_colour_leave_no_hole() {
    for count in [3, 5, 64, 1000] {
        let layers: Vec<Layer> = wedges(count).iter().map(|w| Layer::new(w)).collect();
        let picture = draw(16, 16, &layers, &vec![[90, 120, 150]; count]);
        assert!(picture.data().chunks(4).all(|p| p == [90, 120, 150, 255]), "{count} wedges");
    }
}

#[test]
fn edges_a_millionth_of_a_pixel_apart_act_as_one() {
    let near = 1e-6;
    for (a, b) in [
        // Beside each other, crossing, level, and parallel at a slant.
        (corners(-1.0, -1.0, 0.5, 2.0), corners(-1.0, -1.0, 0.5 + near, 2.0)),
        (
            vec![[-1.0, 0.0], [0.5, 0.0], [0.5 + near, 1.0], [-1.0, 1.0]],
            vec![[-1.0, 0.0], [0.5 + near, 0.0], [0.5, 1.0], [-1.0, 1.0]],
        ),
        (corners(0.0, -1.0, 1.0, 0.5), corners(0.0, -1.0, 1.0, 0.5 + near)),
        (
            vec![[0.25, 0.0], [0.75, 1.0], [-9.0, 1.0], [-9.0, 0.0]],
            vec![[0.25 + near, 0.0], [0.75 + near, 1.0], [-9.0, 1.0], [-9.0, 0.0]],
        ),
    ] {
        for (back, front) in [(&a, &b), (&b, &a)] {
            let picture =
                render(&svg(1, 1, &(path(&ring(back), "#f00", "") + &path(&ring(front), "#0f0", ""))));
            assert_levels(picture.pixel(0, 0), [0.0, 255.0, 0.0, 127.5], STRAIGHT);
        }
        // As one path, one ring the hole of the other.
        let hole: Vec<Point> = b.iter().rev().copied().collect();
        let picture = render(&white_on_black(1, 1, &(ring(&a) + &ring(&hole)), ""));
        assert_levels(picture.pixel(0, 0), [0.0, 0.0, 0.0, 255.0], STRAIGHT);
    }
}

#[test]
fn of_a_hundred_identical_shapes_only_the_front_shows() {
    let mut rng = Rng::new(3);
    for corners in 3..9 {
        let shape: Vec<Point> = (0..corners).map(|_| rng.point(-2.0, 18.0)).collect();
        let backwards: Vec<Point> = shape.iter().rev().copied().collect();
        let front = path(&ring(&shape), "#35f", "");
        let mut stack = String::new();
        for i in 0..100 {
            let ring = ring(if i % 3 == 1 { &backwards } else { &shape });
            stack += &path(&ring, &hex(rng.colour()), "");
        }
        let alone = render(&svg(16, 16, &front));
        assert_same_bytes(&render(&svg(16, 16, &(stack + &front))), &alone, "stack");
    }
}

#[test]
fn a_hundred_identical_veils_darken_by_their_power_and_keep_their_edge() {
    let shape = [[1.25, 0.5], [14.75, 3.25], [6.5, 15.0]];
    let veil = path(&ring(&shape), "#fff", "fill-opacity=\".03125\"");
    let body = rect(0.0, 0.0, 16.0, 16.0, "#000") + &veil.repeat(100);
    let opacity = 1.0 - 0.96875f64.powi(100);
    let truth = Sweep::exact(&[Layer::new(&shape)]).picture(16, 16, blended([0; 3], &[(WHITE, opacity)]));
    assert_matches(&render(&svg(16, 16, &body)), &truth, STRAIGHT, "veils");
}

// ----------------------------------------------------------------------------- borders and levels

#[test]
fn edges_on_pixel_borders_light_one_side_only() {
    for (x, y) in [(2.0, 3.0), (3.0, 2.0)] {
        let ring =
            [[x, y], [x, y + 3.0], [x + 2.0, y + 3.0], [x + 2.0, y + 1.0], [x + 3.0, y + 1.0], [x + 3.0, y]];
        assert_white(8, 8, &[ring.to_vec()], "on borders");
        let picture = draw(8, 8, &[Layer::new(&ring)], &[WHITE]);
        assert!(picture.data().chunks(4).all(|p| p[0] == 0 || p[0] == 255), "a border leaks");
    }
}

#[test]
fn edges_through_pixel_corners_halve_the_pixels_on_their_way() {
    let diamond = vec![[8.0, 2.0], [14.0, 8.0], [8.0, 14.0], [2.0, 8.0]];
    let truth = coverage(16, 16, std::slice::from_ref(&diamond));
    assert!(truth.data.iter().all(|p| [0.0, 127.5, 255.0].contains(&p[0])));
    let picture = draw(16, 16, &[Layer::new(&diamond)], &[WHITE]);
    assert_matches(&picture, &truth, STRAIGHT, "diamond");
    // Slopes 1/2, 2, 1/3 meet corners only now and then.
    assert_white(16, 16, &[vec![[0.0, 0.0], [16.0, 8.0], [12.0, 16.0]]], "slopes");
    assert_white(16, 16, &[vec![[1.0, 1.0], [13.0, 5.0], [7.0, 15.0], [3.0, 7.0]]], "slopes");
}

#[test]
fn vertices_on_borders_and_corners_of_pixels_count_once() {
    // Every triangle and quadrangle of a cell's corners, mid-borders and centres.
    let mut rng = Rng::new(4);
    assert_cells(20, "half-pixel grid", |cell| {
        let corners = 3 + cell as u64 % 3;
        let mut point = || [rng.below(7) as f64 / 2.0, rng.below(7) as f64 / 2.0];
        let ring: Vec<Point> = (0..corners).map(|_| point()).collect();
        let layer = Layer::new(&ring);
        vec![if cell % 2 == 0 { layer } else { layer.even_odd() }]
    });
}

#[test]
fn several_shapes_with_vertices_on_borders_share_the_pixels_exactly() {
    let mut rng = Rng::new(5);
    assert_cells(20, "several on the half-pixel grid", |cell| {
        let mut triangle = || {
            let mut point = || [rng.below(7) as f64 / 2.0, rng.below(7) as f64 / 2.0];
            Layer::new(&[point(), point(), point()])
        };
        (0..2 + cell % 4).map(|_| triangle()).collect()
    });
}

#[test]
fn horizontal_edges_at_any_fraction_of_a_row_count_whichever_way_they_run() {
    // Stairs to the right and to the left, whose treads cross many pixels' left borders.
    let fractions =
        [0.0, 1.0 / 64.0, 0.25, 1.0 / 3.0, 0.5, 0.515_625, 0.75, 63.0 / 64.0, 1.0 / 4096.0, 0.999_9];
    for &f in &fractions {
        let f = f64::from(f as f32);
        let mut down = vec![[0.25, f]];
        let mut up = Vec::new();
        for step in 0..5 {
            let (x, y) = (3.0 * f64::from(step) + 0.5, f64::from(2 * step) + f);
            down.extend([[x, y], [x, y + 2.0]]);
            up.extend([[15.5 - x, y], [15.5 - x, y + 2.0]]);
        }
        let (left, right) = ([[0.25, 10.0 + f]], [[15.75, 10.0 + f], [15.75, f]]);
        let stairs: Vec<Point> = down.into_iter().chain(left).collect();
        let mirrored: Vec<Point> = up.into_iter().chain(right).collect();
        let reversed: Vec<Point> = stairs.iter().rev().copied().collect();
        for (i, ring) in [stairs, mirrored, reversed].into_iter().enumerate() {
            assert_white(16, 12, &[ring], &format!("stairs {i} at {f}"));
        }
    }
}

#[test]
fn a_zero_height_piece_on_a_pixels_left_border_moves_nothing() {
    // Out and back along a level line, to the left and to the right, at the border of pixel 1.
    let plain = "M1.5 .25H2.75V1.75H1.5Z";
    let spiked = [
        "M1.5 .25H2.75V1.75H1.5V.5H.5H1.5Z",
        "M1.5 .25H2.75V1.75H1.5V.5H1H1.5Z",
        "M1.5 .25H2.75V1.75H1.5V1H0H1.5Z",
        "M1.5 .25H2.75V.75H3.5H2.75V1.75H1.5Z",
        "M1.5 .25H2.75V.75H1H2.75V1.75H1.5Z",
        "M1 .25H1.5H2.75V1.75H1.5V.25H1Z",
    ];
    let expected = render(&white_on_black(4, 2, plain, ""));
    assert_levels(expected.pixel(1, 0), [95.625, 95.625, 95.625, 255.0], STRAIGHT);
    for d in spiked {
        assert_same_bytes(&render(&white_on_black(4, 2, d, "")), &expected, d);
    }
}

#[test]
fn rectangles_stacked_on_fractional_rows_show_no_seam_and_keep_their_areas() {
    let mut rng = Rng::new(6);
    let mut heights: Vec<f64> = (0..60).map(|_| rng.on_grid(0.0, 16.0)).collect();
    heights.extend([-1.0, 17.0]);
    heights.sort_by(f64::total_cmp);
    let layers: Vec<Layer> = heights
        .windows(2)
        .enumerate()
        .map(|(i, y)| {
            let bar = corners(-1.0, y[0], 17.0, y[1]);
            Layer::new(&if i % 2 == 0 { bar } else { bar.into_iter().rev().collect() })
        })
        .collect();
    let one = draw(16, 16, &layers, &vec![[40, 130, 220]; layers.len()]);
    assert!(one.data().chunks(4).all(|p| p == [40, 130, 220, 255]), "a seam");
    let colours = colours(&mut rng, layers.len());
    assert_exact(16, 16, &layers, &colours, "bars");
}

#[test]
fn a_chequerboard_of_fractional_cells_in_one_colour_shows_no_seam() {
    // Pitches which are no multiple of anything: cells share their corners' coordinates all the same.
    let at = |i: u32| f64::from((f64::from(i) * 7.3 - 3.0) as f32) / 4.0;
    let mut body = String::new();
    for i in 0..20 {
        for j in 0..20 {
            body += &rect(at(i), at(j), at(i + 1), at(j + 1), "#28a");
        }
    }
    let picture = render(&svg(32, 32, &body));
    assert!(picture.data().chunks(4).all(|p| p == [0x22, 0x88, 0xaa, 255]), "a seam");
}

// ---------------------------------------------------------------------------- degenerate paths

#[test]
fn paths_without_area_draw_nothing() {
    let square = rect(6.0, 6.0, 8.0, 8.0, "#00f");
    let plain = render(&svg(12, 12, &square));
    for d in
        ["M2 2L9 9Z", "M2 2L9 9", "M2 2L9 9L5 5Z", "M2 2H9H3Z", "M5 5", "M5 5Z", "M2 1V9V1Z", "M3 3L3 3L3 3Z"]
    {
        let both = render(&svg(12, 12, &(path(d, "#f00", "") + &square)));
        assert_same_bytes(&both, &plain, d);
    }
}

#[test]
fn sub_paths_without_area_change_no_byte_of_their_path() {
    let shape = "M1.5 2.25L10.25 1L8 10.75Z";
    let plain = render(&white_on_black(12, 12, shape, ""));
    for extra in ["M0 0L12 12Z", "M0 5.5H12", "M6 0V12Z", "M4 4", "M4 4Z", "M4 4L4 4Z", "M0 12L12 0L6 6Z"] {
        let both = render(&white_on_black(12, 12, &format!("{extra}{shape}{extra}"), ""));
        assert_same_bytes(&both, &plain, extra);
    }
}

#[test]
fn an_open_sub_path_is_filled_as_if_it_were_closed() {
    let open = render(&white_on_black(12, 12, "M1.5 2.25L10.25 1L8 10.75M2 8L4 8L3 11", ""));
    let closed = render(&white_on_black(12, 12, "M1.5 2.25L10.25 1L8 10.75ZM2 8L4 8L3 11Z", ""));
    assert_levels(open.pixel(7, 4), [255.0; 4], 0.0);
    assert_same_bytes(&open, &closed, "open");
}

#[test]
fn windings_of_many_turns_fill_like_one() {
    let shape = [[1.25, 1.5], [13.5, 3.25], [10.75, 14.5], [2.0, 12.25]];
    let backwards: Vec<Point> = shape.iter().rev().copied().collect();
    let once = render(&white_on_black(16, 16, &ring(&shape), ""));
    for turns in [2, 3, 7, 100] {
        let many = white_on_black(16, 16, &ring(&shape).repeat(turns), "");
        assert_same_bytes(&render(&many), &once, "same way");
        let against = ring(&backwards).repeat(turns) + &ring(&shape);
        assert_same_bytes(&render(&white_on_black(16, 16, &against, "")), &once, "one turn against");
    }
    let none = render(&white_on_black(16, 16, &(ring(&shape) + &ring(&backwards)), ""));
    assert!(none.data().chunks(4).all(|p| p == [0, 0, 0, 255]), "one turn each way is none");
}

#[test]
fn random_stars_fill_by_their_winding_numbers() {
    let mut rng = Rng::new(7);
    for _ in 0..12 {
        let star: Vec<Point> = (0..12).map(|_| rng.point(0.0, 16.0)).collect();
        assert_white(16, 16, &[star], "star");
    }
}

#[test]
fn the_mean_winding_number_of_a_pixel_is_not_its_coverage() {
    // Two strips of 3/8 which cross in the pixel: mean winding 3/4, covered 39/64.
    let strips = [corners(-1.0, 0.25, 2.0, 0.625), corners(0.5, -1.0, 0.875, 2.0)];
    assert_white(1, 1, &strips, "cross");
    // Winding 2 in one half and 0 in the other has the mean of a full pixel.
    let twice = corners(-1.0, -1.0, 0.5, 2.0);
    let picture = draw(1, 1, &[Layer::of(&[twice.clone(), twice])], &[WHITE]);
    assert_levels(picture.pixel(0, 0), [127.5, 127.5, 127.5, 255.0], STRAIGHT);
    // Winding +1 in the left half and -1 in the right has the mean of an empty one.
    let [left, right] = [corners(-1.0, -1.0, 0.5, 2.0), corners(0.5, -1.0, 2.0, 2.0)];
    let right: Vec<Point> = right.into_iter().rev().collect();
    let picture = draw(1, 1, &[Layer::of(&[left, right])], &[WHITE]);
    assert_eq!(picture.pixel(0, 0), [255; 4]);
}

// --------------------------------------------------------------------------------------- strokes

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

// --------------------------------------------------------------------------- large, small, many

#[test]
fn coordinates_of_a_million_under_a_view_box_are_as_exact_as_small_ones() {
    // Multiples of 1/16 are exact in single precision up to a million.
    let local = [[1.1875, 0.5], [30.5625, 8.25], [17.0, 31.4375], [3.75, 20.0]];
    let far: Vec<Point> = local.iter().map(|p| [p[0] + 1e6, p[1] + 1e6]).collect();
    let document = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"32\" height=\"32\" \
         viewBox=\"1000000 1000000 32 32\">{}{}</svg>",
        rect(999_999.0, 999_999.0, 1_000_033.0, 1_000_033.0, "#000"),
        path(&ring(&far), "#fff", "")
    );
    assert_matches(&render(&document), &coverage(32, 32, &[local.to_vec()]), STRAIGHT, "far away");
    let wide: Vec<Point> = local.iter().map(|p| [p[0] * 32768.0, p[1] * 32768.0]).collect();
    let document = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"32\" height=\"32\" \
         viewBox=\"0 0 1048576 1048576\">{}{}</svg>",
        rect(0.0, 0.0, 1048576.0, 1048576.0, "#000"),
        path(&ring(&wide), "#fff", "")
    );
    assert_matches(&render(&document), &coverage(32, 32, &[local.to_vec()]), STRAIGHT, "large");
}

#[test]
fn a_slanted_edge_between_far_off_corners_is_exact_where_it_crosses_the_picture() {
    for far in [1e3, 1e6, 1.34217728e8] {
        for (a, b) in [
            ([-far, -far / 2.0], [far, far / 2.0]),
            ([8.0 - far / 4.0, -far], [8.0 + far / 4.0, far]),
            ([-far, 12.0], [far, 3.0]),
        ] {
            let triangle = vec![a, b, [-far, far]];
            let picture = draw(16, 16, &[Layer::new(&triangle)], &[WHITE]);
            let truth = coverage(16, 16, &[triangle]);
            assert!(truth.data.iter().any(|p| p[0] > 1.0 && p[0] < 254.0), "the edge crosses the picture");
            assert_matches(&picture, &truth, STRAIGHT, &format!("{a:?} to {b:?}"));
        }
    }
}

#[test]
fn thousands_of_tiny_polygons_in_one_pixel_add_up() {
    // A chequerboard of 64 × 64 squares of 1/64 px: half of one pixel; then all of it.
    let square = |i: u32| {
        let (x, y) = (f64::from(i % 64) / 64.0, f64::from(i / 64) / 64.0);
        corners(x, y, x + 1.0 / 64.0, y + 1.0 / 64.0)
    };
    let odd: Vec<_> = (0..4096).filter(|i| (i % 64 + i / 64) % 2 == 0).map(square).collect();
    let all: Vec<_> = (0..4096).map(square).collect();
    let picture = draw(1, 1, &[Layer::of(&odd)], &[WHITE]);
    assert_levels(picture.pixel(0, 0), [127.5, 127.5, 127.5, 255.0], STRAIGHT);
    assert_eq!(draw(1, 1, &[Layer::of(&all)], &[WHITE]).pixel(0, 0), [255; 4]);
    let layers: Vec<Layer> = all.iter().map(|square| Layer::new(square)).collect();
    assert_eq!(draw(1, 1, &layers, &vec![WHITE; 4096]).pixel(0, 0), [255; 4]);
    let few: Vec<Layer> = odd.iter().map(|square| Layer::new(square)).collect();
    let picture = draw(1, 1, &few, &vec![WHITE; few.len()]);
    assert_levels(picture.pixel(0, 0), [127.5, 127.5, 127.5, 255.0], DENSE);
}

#[test]
fn polygons_of_a_hundredth_pixel_spread_over_a_picture_keep_their_light() {
    // 10,000 disjoint triangles of 1/128 px legs: their whole light is known to the mean rounding.
    let mut rng = Rng::new(8);
    let mut triangles = Vec::new();
    for i in 0..10_000 {
        let (x, y) = (f64::from(i % 100) * 0.15625, f64::from(i / 100) * 0.15625);
        let (x, y) = (x + rng.on_grid(0.0, 0.125), y + rng.on_grid(0.0, 0.125));
        triangles.push(vec![[x, y], [x + 1.0 / 64.0, y], [x, y + 1.0 / 64.0]]);
    }
    let truth = coverage(16, 16, &triangles);
    let picture = draw(16, 16, &[Layer::of(&triangles)], &[WHITE]);
    assert_matches(&picture, &truth, STRAIGHT, "one path");
    let layers: Vec<Layer> = triangles.iter().map(|t| Layer::new(t)).collect();
    let picture = draw(16, 16, &layers, &vec![WHITE; layers.len()]);
    assert_matches(&picture, &truth, STRAIGHT, "a shape each");
}

#[test]
fn twenty_thousand_crossing_edges_in_one_shape_take_bounded_time() {
    let mut rng = Rng::new(9);
    let tangle: Vec<Point> = (0..20_000).map(|_| rng.point(0.0, 48.0)).collect();
    for layer in [Layer::new(&tangle), Layer::new(&tangle).even_odd()] {
        let layers = [layer];
        let picture = draw(48, 48, &layers, &[WHITE]);
        let truth = Sweep::by_lines(&layers, 32).picture(48, 48, opaque([0; 3], &[WHITE]));
        // The oracle itself is off by some two levels here.
        let mean = mean_error(&picture, &truth);
        assert!(mean < 6.0, "{:?}: mean error {mean}", layers[0].rule);
        let light = |p: &mut dyn Iterator<Item = f64>| p.sum::<f64>() / (48.0 * 48.0);
        let found = light(&mut picture.data().chunks(4).map(|p| f64::from(p[0])));
        let expected = light(&mut truth.data.iter().map(|p| p[0]));
        assert!((found - expected).abs() < 0.5, "{:?}: {found}, {expected}", layers[0].rule);
    }
}

#[test]
fn many_random_shapes_in_few_pixels_take_bounded_time_and_stay_near() {
    let mut rng = Rng::new(10);
    let layers: Vec<Layer> = (0..300)
        .map(|_| Layer::new(&[rng.point(-1.0, 5.0), rng.point(-1.0, 5.0), rng.point(-1.0, 5.0)]))
        .collect();
    let colours = colours(&mut rng, 300);
    let picture = draw(4, 4, &layers, &colours);
    let truth = Sweep::by_lines(&layers, 256).picture(4, 4, opaque([0; 3], &colours));
    assert_matches(&picture, &truth, STRAIGHT + 0.4, "shapes");
}

#[test]
fn many_random_veils_in_few_pixels_take_bounded_time_and_stay_near() {
    let mut rng = Rng::new(11);
    let layers: Vec<Layer> = (0..60)
        .map(|_| Layer::new(&[rng.point(-1.0, 5.0), rng.point(-1.0, 5.0), rng.point(-1.0, 5.0)]))
        .collect();
    let veils: Vec<([u8; 3], f64)> = (0..60).map(|_| (rng.colour(), 0.25)).collect();
    let mut body = rect(0.0, 0.0, 4.0, 4.0, "#000");
    for (layer, veil) in layers.iter().zip(&veils) {
        body += &path(&rings(&layer.rings), &hex(veil.0), "fill-opacity=\".25\"");
    }
    let started = Instant::now();
    let picture = render(&svg(4, 4, &body));
    assert!(started.elapsed() < PATIENCE, "took {:?}", started.elapsed());
    let truth = Sweep::exact(&layers).picture(4, 4, blended([0; 3], &veils));
    assert_matches(&picture, &truth, DENSE, "veils");
}

// --------------------------------------------------------------------------------------- hatches

/// Parallel strips along `along`, `pitch` apart, half of it wide, over a square of this side.
fn hatch(side: f64, along: Point, pitch: Point) -> Vec<Vec<Point>> {
    let steps = (3.0 * side / (pitch[0].abs() + pitch[1].abs())) as i32;
    (-steps..steps)
        .map(|i| {
            let at = |k: f64, t: f64| [k * pitch[0] + t * along[0], k * pitch[1] + t * along[1]];
            let k = f64::from(i);
            vec![at(k, -64.0), at(k, 64.0), at(k + 0.5, 64.0), at(k + 0.5, -64.0)]
        })
        .collect()
}

#[test]
fn a_hatch_finer_than_a_pixel_is_half_lit_as_one_path_and_as_many_shapes() {
    for (along, pitch) in [
        ([0.0, 1.0], [0.03125, 0.0]),
        ([1.0, 0.0], [0.0, 0.0625]),
        ([1.0, 1.0], [0.125, 0.0]),
        ([1.0, 3.0], [0.0, 0.25]),
    ] {
        let strips = hatch(4.0, along, pitch);
        let truth = coverage(4, 4, &strips);
        assert_matches(&draw(4, 4, &[Layer::of(&strips)], &[WHITE]), &truth, STRAIGHT, "one path");
        let layers: Vec<Layer> = strips.iter().map(|s| Layer::new(s)).collect();
        let shapes = draw(4, 4, &layers, &vec![WHITE; layers.len()]);
        assert_matches(&shapes, &truth, STRAIGHT, "a shape each");
    }
}

#[test]
fn strips_of_two_colours_which_tile_share_the_pixel() {
    let white = hatch(4.0, [1.0, 2.0], [0.125, 0.0]);
    let layers: Vec<Layer> = white
        .iter()
        .flat_map(|s| {
            let beside = s.iter().map(|p| [p[0] + 0.0625, p[1]]).collect::<Vec<_>>();
            [Layer::new(s), Layer::new(&beside)]
        })
        .collect();
    let colours: Vec<[u8; 3]> = (0..layers.len()).map(|i| if i % 2 == 0 { WHITE } else { RED }).collect();
    assert_matches(
        &draw(4, 4, &layers, &colours),
        &Sweep::exact(&layers).picture(4, 4, opaque([0; 3], &colours)),
        STRAIGHT,
        "strips",
    );
}

#[test]
fn hatches_which_cross_multiply_where_they_are_square_to_each_other() {
    // Eight strips a pixel each way: red before white, half and half of the rest.
    let (down, across) = (hatch(4.0, [0.0, 1.0], [0.125, 0.0]), hatch(4.0, [1.0, 0.0], [0.0, 0.125]));
    let layers = [Layer::of(&down), Layer::of(&across)];
    let picture = draw(4, 4, &layers, &[WHITE, RED]);
    for pixel in picture.data().chunks(4) {
        assert_levels([pixel[0], pixel[1], pixel[2], pixel[3]], [191.25, 63.75, 63.75, 255.0], STRAIGHT);
    }
    let shapes: Vec<Layer> = down.iter().chain(&across).map(|s| Layer::new(s)).collect();
    let mut colours = vec![WHITE; down.len()];
    colours.resize(shapes.len(), RED);
    for pixel in draw(4, 4, &shapes, &colours).data().chunks(4) {
        assert_levels([pixel[0], pixel[1], pixel[2], pixel[3]], [191.25, 63.75, 63.75, 255.0], STRAIGHT);
    }
}

#[test]
fn slanted_hatches_which_cross_keep_their_areas() {
    let (a, b) = (hatch(4.0, [1.0, 3.0], [0.25, 0.0]), hatch(4.0, [3.0, -1.0], [0.0, 0.25]));
    assert_exact(4, 4, &[Layer::of(&a), Layer::of(&b)], &[WHITE, RED], "two paths");
}

#[test]
fn fine_hatches_which_cross_take_bounded_time_and_stay_near() {
    let (a, b) = (hatch(4.0, [0.0, 1.0], [0.03125, 0.0]), hatch(4.0, [1.0, 0.0], [0.0, 0.03125]));
    let shapes: Vec<Layer> = a.iter().chain(&b).map(|s| Layer::new(s)).collect();
    let mut colours = vec![WHITE; a.len()];
    colours.resize(shapes.len(), RED);
    let truth = [191.25, 63.75, 63.75, 255.0];
    for layers in [vec![Layer::of(&a), Layer::of(&b)], shapes] {
        let colours = if layers.len() == 2 { vec![WHITE, RED] } else { colours.clone() };
        for pixel in draw(4, 4, &layers, &colours).data().chunks(4) {
            assert_levels([pixel[0], pixel[1], pixel[2], pixel[3]], truth, DENSE);
        }
    }
}

// ------------------------------------------------------------------------------ absurd coordinates

#[test]
fn huge_coordinates_draw_what_they_cover() {
    for size in ["1e7", "1e12", "1e30"] {
        let body = rect(0.0, 0.0, 8.0, 8.0, "#00f")
            + &path(&format!("M-{size} -{size}H{size}V{size}H-{size}Z"), "#0f0", "");
        let picture = render(&svg(8, 8, &body));
        assert!(picture.data().chunks(4).all(|p| p == [0, 255, 0, 255]), "{size}");
        // The half plane left of x = 4.
        let half = rect(0.0, 0.0, 8.0, 8.0, "#00f")
            + &path(&format!("M4 -{size}V{size}H-{size}V-{size}Z"), "#0f0", "");
        let picture = render(&svg(8, 8, &half));
        assert_eq!(picture.pixel(3, 4), [0, 255, 0, 255], "{size}");
        assert_eq!(picture.pixel(4, 4), [0, 0, 255, 255], "{size}");
    }
}

#[test]
fn absurd_coordinates_end_in_bounded_time_and_leave_the_other_shapes_alone() {
    let good = rect(2.0, 2.0, 6.0, 6.0, "#0f0");
    for d in [
        "M1e38 1e38L-1e38 1e38L0 -1e38Z",
        "M-3e38 0L3e38 1L3e38 2Z",
        "M0 0L1e39 1e39L5 9Z",
        "MNaN 0L1 1L2 0Z",
        "M0 0LNaN NaNL3 3Z",
        "M1e-40 1e-40L2e-40 0L0 1e-45Z",
        "M0 0C1e30 1e30 -1e30 1e30 1 1Z",
        "M0 0A1e8 1e8 0 1 1 5 5Z",
    ] {
        for attributes in [
            "",
            "stroke=\"#00f\"",
            "stroke=\"#00f\" stroke-dasharray=\"1 .001\"",
            "transform=\"scale(1e20)\"",
        ] {
            let started = Instant::now();
            let picture = render(&svg(8, 8, &(path(d, "#f00", attributes) + &good)));
            assert!(started.elapsed() < PATIENCE, "{d} {attributes} took {:?}", started.elapsed());
            assert_eq!(picture.pixel(4, 4), [0, 255, 0, 255], "{d} {attributes}");
        }
    }
}

#[test]
fn an_arc_of_absurd_size_is_refused_as_a_limit() {
    for d in ["M0 0A1e30 1e30 0 1 1 5 5Z", "M0 0A4 4 0 1 1 1e30 5Z"] {
        let document = svg(8, 8, &path(d, "#f00", ""));
        let refused = Scene::from_bytes(document.as_bytes(), &Options::default());
        assert!(matches!(refused, Err(Error::Limit(_))), "{d}: {refused:?}");
    }
}

#[test]
fn a_long_dashed_line_far_outside_the_picture_takes_bounded_time() {
    let line = path("M-1e9 4H1e9", "none", "stroke=\"#00f\" stroke-width=\"2\" stroke-dasharray=\"2 2\"");
    let started = Instant::now();
    let picture = render(&svg(8, 8, &(line + &rect(0.0, 6.0, 8.0, 8.0, "#0f0"))));
    assert!(started.elapsed() < PATIENCE, "took {:?}", started.elapsed());
    assert_eq!(picture.pixel(4, 7), [0, 255, 0, 255]);
}

// ---------------------------------------------------------------------- traps of the integrator

#[test]
fn random_triangles_of_two_to_five_share_each_pixel_exactly() {
    let mut rng = Rng::new(12);
    assert_cells(24, "random triangles", |cell| {
        let mut triangle = || Layer::new(&[rng.point(0.0, 3.0), rng.point(0.0, 3.0), rng.point(0.0, 3.0)]);
        (0..2 + cell % 4).map(|_| triangle()).collect()
    });
}

#[test]
fn random_paths_of_several_rings_share_each_pixel_exactly() {
    let mut rng = Rng::new(13);
    assert_cells(16, "random rings", |cell| {
        let mut ring = || (0..5).map(|_| rng.point(0.0, 3.0)).collect::<Vec<_>>();
        let layers = [Layer::of(&[ring(), ring()]), Layer::of(&[ring(), ring()]).even_odd()];
        if cell % 2 == 0 {
            layers.into()
        } else {
            layers.into_iter().rev().collect()
        }
    });
}

#[test]
fn crossings_which_tie_on_the_grid_are_shared_exactly() {
    // Lines through the same mid-points of a coarse grid: every crossing falls on a grid point.
    let mut rng = Rng::new(14);
    assert_cells(20, "ties", |cell| {
        let centre = [1.0 + rng.below(5) as f64 / 4.0, 1.0 + rng.below(5) as f64 / 4.0];
        (0..2 + cell % 3)
            .map(|_| {
                let mut away = || 0.25 * (rng.below(3) as f64 - 1.0);
                let d = [away(), away()];
                let e = [away(), away()];
                Layer::new(&[
                    [centre[0] - 2.0 * d[0], centre[1] - 2.0 * d[1]],
                    [centre[0] + 2.0 * d[0], centre[1] + 2.0 * d[1]],
                    [centre[0] + 3.0 * e[0], centre[1] + 3.0 * e[1]],
                ])
            })
            .collect()
    });
}

#[test]
fn lines_through_the_middle_of_a_pixel_split_it_without_loss_at_every_angle() {
    for dx in -6..=6 {
        for dy in -6..=6 {
            if (dx, dy) == (0, 0) {
                continue;
            }
            let (dx, dy) = (f64::from(dx), f64::from(dy));
            for at in [[1.5, 1.5], [1.0, 1.0], [1.0, 1.5], [1.5, 2.0]] {
                let p = [at[0] - 9.0 * dx, at[1] - 9.0 * dy];
                let q = [at[0] + 9.0 * dx, at[1] + 9.0 * dy];
                let left =
                    vec![p, q, [q[0] - 90.0 * dy, q[1] + 90.0 * dx], [p[0] - 90.0 * dy, p[1] + 90.0 * dx]];
                let right =
                    vec![p, q, [q[0] + 90.0 * dy, q[1] - 90.0 * dx], [p[0] + 90.0 * dy, p[1] - 90.0 * dx]];
                let both = [Layer::new(&left), Layer::new(&right)];
                let one = draw(3, 3, &both, &[[70, 80, 90]; 2]);
                assert!(one.data().chunks(4).all(|p| p == [70, 80, 90, 255]), "a seam at ({dx}, {dy})");
                let truth = coverage(3, 3, &[left]);
                assert_matches(&draw(3, 3, &both, &[WHITE, [0; 3]]), &truth, STRAIGHT, "split");
            }
        }
    }
}

#[test]
fn two_edges_which_run_one_way_without_a_shared_end_are_no_chain() {
    // Both edges go down through the pixel's height together, but apart, and from different shapes.
    let a = [[-1.0, -1.0], [0.25, 0.0], [0.25, 0.5], [-1.0, 0.5]];
    let b = [[-1.0, 0.5], [0.75, 0.5], [0.75, 1.0], [-1.0, 1.0]];
    assert_exact(1, 1, &[Layer::new(&a), Layer::new(&b)], &[WHITE, RED], "steps apart");
    assert_exact(1, 1, &[Layer::of(&[a.to_vec(), b.to_vec()])], &[WHITE], "one path");
    // From border to middle and from middle to border, at different places.
    let c = [[0.125, -0.5], [0.375, 0.5], [-2.0, 0.5], [-2.0, -0.5]];
    let d = [[0.875, 0.5], [0.625, 1.5], [-2.0, 1.5], [-2.0, 0.5]];
    for order in [[&c, &d], [&d, &c]] {
        let layers = order.map(|ring| Layer::new(ring));
        assert_exact(1, 1, &layers, &[WHITE, RED], "slants apart");
    }
}

#[test]
fn vertices_which_touch_a_pixels_border_mark_nothing() {
    // Tips which touch the pixel [1, 2)² from outside and inside, at corners and at borders.
    for tip in [[1.0, 1.0], [1.0, 1.5], [2.0, 1.25], [1.5, 1.0], [1.75, 2.0], [2.0, 2.0], [1.0, 2.0]] {
        for (a, b) in [
            ([0.0, 0.25], [0.25, 2.75]),
            ([3.0, 0.5], [2.75, 3.0]),
            ([0.25, 0.0], [2.5, 0.25]),
            ([0.5, 3.0], [3.0, 2.75]),
        ] {
            let triangle = vec![tip, a, b];
            assert_white(3, 3, std::slice::from_ref(&triangle), "tip");
            let back = Layer::new(&corners(0.0, 0.0, 3.0, 3.0));
            assert_exact(3, 3, &[back, Layer::new(&triangle)], &[RED, WHITE], "tip before red");
        }
    }
}

#[test]
fn shapes_which_share_part_of_their_outline_yield_to_the_front() {
    // The same edges in two shapes, in every order and direction: depth alone decides.
    let large = vec![[0.25, 0.25], [2.75, 0.5], [2.5, 2.75], [0.5, 2.25]];
    let upper = vec![[0.25, 0.25], [2.75, 0.5], [0.5, 2.25]];
    let lower = vec![[2.75, 0.5], [2.5, 2.75], [0.5, 2.25]];
    let turned = |ring: &Vec<Point>| ring.iter().rev().copied().collect::<Vec<_>>();
    let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for turns in 0..8 {
            let shapes = [&large, &upper, &lower];
            let layers: Vec<Layer> = order
                .iter()
                .map(|&i| {
                    Layer::new(&if turns >> i & 1 == 1 { turned(shapes[i]) } else { shapes[i].clone() })
                })
                .collect();
            let front = order.map(|i: usize| colours[i]);
            assert_exact(3, 3, &layers, &front, &format!("order {order:?}, turns {turns:03b}"));
            // Both halves before the whole: its red must not show at all.
            if order[0] == 0 {
                let picture = draw(3, 3, &layers, &front);
                assert!(picture.data().chunks(4).all(|p| p[0] == 0), "red shows in order {order:?}");
            }
        }
    }
}

#[test]
fn no_mix_leaves_the_range_of_its_colours() {
    let mut rng = Rng::new(15);
    for round in 0..10 {
        let mut body = rect(0.0, 0.0, 24.0, 24.0, "#787878");
        for _ in 0..60 {
            let [r, g, b] = rng.colour().map(|c| 100 + c % 51);
            let ring: Vec<Point> = (0..4).map(|_| rng.point(-2.0, 26.0)).collect();
            let opacity = ["1", ".5", ".125"][rng.below(3) as usize];
            body += &path(&support::ring(&ring), &hex([r, g, b]), &format!("fill-opacity=\"{opacity}\""));
        }
        for settings in [settings(), Settings { linear: true, ..settings() }] {
            let picture = render_with(&svg(24, 24, &body), settings);
            for pixel in picture.data().chunks(4) {
                let inside = pixel[..3].iter().all(|c| (100..=150).contains(c));
                assert!(inside && pixel[3] == 255, "round {round}: {pixel:?}");
            }
        }
    }
}

#[test]
fn the_alpha_of_a_group_never_exceeds_its_opacity() {
    let mut rng = Rng::new(16);
    for round in 0..10 {
        let mut body = String::new();
        for _ in 0..80 {
            let ring: Vec<Point> = (0..4).map(|_| rng.point(-2.0, 26.0)).collect();
            body += &path(&support::ring(&ring), "#a0b0c0", "");
        }
        let picture = render(&svg(24, 24, &format!("<g opacity=\".5\">{body}</g>")));
        assert_drawn(&picture, "group");
        for pixel in picture.data().chunks(4) {
            assert!(pixel[3] <= 128, "round {round}: {pixel:?}");
            assert!(pixel[3] == 0 || pixel[..3] == [0xa0, 0xb0, 0xc0], "round {round}: {pixel:?}");
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let mut rng = Rng::new(17);
    let mut body = String::from(
        "<linearGradient id=\"g\"><stop stop-color=\"#f80\"/><stop offset=\"1\" stop-color=\"#08f\" \
         stop-opacity=\".5\"/></linearGradient><clipPath id=\"c\"><circle cx=\"60\" cy=\"70\" r=\"50\"/></clipPath>",
    );
    for i in 0..80 {
        let (a, b, c) = (rng.point(0.0, 150.0), rng.point(0.0, 150.0), rng.point(0.0, 150.0));
        let d = format!("M{} {}Q{} {} {} {}T80 80Z", a[0], a[1], b[0], b[1], c[0], c[1]);
        let attributes = [
            "",
            "opacity=\".5\" stroke=\"#000\"",
            "clip-path=\"url(#c)\"",
            "stroke=\"#333\" stroke-width=\"3\"",
        ];
        let fill = if i % 5 == 0 { "url(#g)".into() } else { hex(rng.colour()) };
        body += &path(&d, &fill, attributes[i % 4]);
    }
    // An odd size, so that bands and threads never divide it evenly.
    let document = svg(149, 151, &body);
    let one = render(&document);
    for threads in [2, 3, 7] {
        let many = render_with(&document, Settings { threads, ..settings() });
        assert_same_bytes(&many, &one, &format!("{threads} threads"));
    }
}

#[test]
fn a_clip_shared_by_a_group_and_what_lies_behind_it_clips_both() {
    let clip = |id: &str| format!("<clipPath id=\"{id}\"><circle cx=\"8\" cy=\"8\" r=\"6.3\"/></clipPath>");
    let drawing = |behind: &str| {
        format!(
            "{}{}<rect width=\"16\" height=\"16\" fill=\"#c20\" clip-path=\"url(#{behind})\"/>\
             <g opacity=\".5\"><rect width=\"16\" height=\"16\" fill=\"#0a0\" clip-path=\"url(#a)\"/>\
             <rect x=\"2.5\" width=\"6\" height=\"16\" fill=\"#00f\"/></g>",
            clip("a"),
            clip("b"),
        )
    };
    let shared = render(&svg(16, 16, &drawing("a")));
    let apart = render(&svg(16, 16, &drawing("b")));
    assert_same_bytes(&shared, &apart, "one clip for both");
    // Blue at half opacity over red, inside the circle; green over red beside the bar.
    assert_levels(shared.pixel(5, 8), [102.0, 17.0, 127.5, 255.0], STRAIGHT);
    assert_levels(shared.pixel(11, 8), [102.0, 102.0, 0.0, 255.0], STRAIGHT);
}

#[test]
fn gradients_that_fade_within_a_pixel_show_what_lies_behind_them() {
    let mut rng = Rng::new(77);
    for round in 0..20 {
        let mut body = String::from("<rect width=\"12\" height=\"12\" fill=\"#fff\"/>");
        for i in 0..8 {
            // From opaque to clear over a third of a pixel, somewhere on the way.
            let at = rng.on_grid(1.0, 11.0);
            let kind = if i % 2 == 0 {
                format!(
                    "<linearGradient id=\"g{i}\" gradientUnits=\"userSpaceOnUse\" x1=\"{at}\" x2=\"{}\">",
                    at + 0.3
                )
            } else {
                format!("<radialGradient id=\"g{i}\" gradientUnits=\"userSpaceOnUse\" cx=\"{at}\" cy=\"6\" r=\".4\">")
            };
            let colour = hex(rng.colour());
            let end = if i % 2 == 0 { "linear" } else { "radial" };
            body += &format!(
                "{kind}<stop stop-color=\"{colour}\"/><stop offset=\"1\" stop-color=\"{colour}\" \
                 stop-opacity=\"0\"/></{end}Gradient>"
            );
            let corners: Vec<Point> = (0..3).map(|_| rng.point(-1.0, 13.0)).collect();
            body += &path(&ring(&corners), &format!("url(#g{i})"), "");
        }
        let document = svg(12, 12, &body);
        let picture = render(&document);
        let tree = usvg::Tree::from_str(&document, &usvg::Options::default()).expect("the test's own SVG");
        let viewport = Viewport { width: 12, height: 12, transform: kurbo::Affine::IDENTITY };
        let truth = reference::render(&tree, &viewport, &reference::Options::default()).expect("it is small");
        // Both take a gradient at one point of each region, and not of the same regions.
        let mean = truth.compare(&picture).mean;
        assert!(mean < 3.0, "round {round}: {mean} levels off in the mean");
    }
}
