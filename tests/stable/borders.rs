//! Edges on the borders, corners and levels of pixels.

use super::*;

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

#[test]
fn what_rounding_lays_on_a_pixel_s_lower_border_bounds_nothing() {
    // Two borders down one pixel, the second within the first and ending on the lower border, from where a nearly
    // level one goes on to the right, so little upwards that in this pixel it is rounded to the border.
    let unit = 1.0 / 16384.0;
    for i in 0..200 {
        let i = f64::from(i);
        let (x0, x1) = (0.02 + 0.002 * i, 0.3 + 0.003 * i);
        let (inner0, inner1) = (0.5 + 0.002 * i, 0.92 + 0.0003 * i);
        let outer = [[x0, 0.0], [x1.min(inner1 - 0.01), 1.0], [6.0, 1.0], [6.0, 0.0]];
        let knee = [0.6 * inner0 + 0.4 * inner1, 0.45];
        let inner = [[inner0, 0.0], knee, [inner1, 1.0], [4.0, 1.0 - (1.0 + i % 20.0) * unit], [4.0, 0.0]];
        let path = rings(&[outer.to_vec(), inner.to_vec()]);
        let picture = render(&white_on_black(8, 2, &path, ""));
        let covered = 1.0 - 0.5 * (outer[0][0] + outer[1][0]);
        assert_levels(
            picture.pixel(0, 0),
            [255.0 * covered, 255.0 * covered, 255.0 * covered, 255.0],
            STRAIGHT,
        );
    }
}
