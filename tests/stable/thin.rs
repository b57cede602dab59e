//! Slivers, needles, what lies within a millionth of a pixel, and stacks of the same.

use super::*;

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
