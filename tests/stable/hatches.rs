//! Hatches finer than a pixel.

use super::*;

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
