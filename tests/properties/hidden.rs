//! A shape cut in two is the same picture, and what is hidden changes no byte.

use super::*;

/// The two parts of a ring on the sides of the line through `at` along `along`.
fn parts(polygon: &[Point], at: Point, along: Point) -> [Vec<Point>; 2] {
    let normal = [along[1], -along[0]];
    let offset = normal[0] * at[0] + normal[1] * at[1];
    let single =
        |part: Vec<Point>| -> Vec<Point> { part.iter().map(|p| p.map(|v| f64::from(v as f32))).collect() };
    [
        single(clip_to_half_plane(polygon, normal, offset)),
        single(clip_to_half_plane(polygon, [-normal[0], -normal[1]], -offset)),
    ]
}

#[test]
fn a_shape_cut_in_two_along_any_line_is_the_same_picture() {
    let mut rng = Rng::new(9);
    for round in 0..40 {
        let polygon: Vec<Point> = (0..3 + rng.below(4)).map(|_| rng.point(0.0, SIDE.into())).collect();
        let (at, along) = (rng.point(8.0, 24.0), [rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)]);
        let back =
            path(&ring(&[rng.point(0.0, 32.0), rng.point(0.0, 32.0), rng.point(0.0, 32.0)]), "#f40", "");
        let black = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#000") + &back;
        // Self-crossing outlines make rings of several turns: the same rule must hold for the parts.
        let opacity = ["1", ".5"][round % 2];
        let attributes = format!("fill-opacity=\"{opacity}\"");
        let whole = render(&svg(SIDE, SIDE, &(black.clone() + &path(&ring(&polygon), "#4af", &attributes))));
        let [left, right] = parts(&polygon, at, along);
        let mut halves = black;
        for part in [left, right].iter().filter(|part| part.len() > 2) {
            halves += &path(&ring(part), "#4af", &attributes);
        }
        let halves = render(&svg(SIDE, SIDE, &halves));
        assert_within(&halves, &whole, CURVED, &format!("round {round}"));
    }
}

#[test]
fn a_shape_added_behind_an_opaque_one_changes_no_byte() {
    let mut rng = Rng::new(10);
    for round in 0..30 {
        let shapes = random_shapes(&mut rng, false);
        let (before, after) = shapes.split_at(5);
        // A triangle, and in it another one: its own double, one with two of its corners, one inside.
        let front: Vec<Point> = (0..3).map(|_| rng.point(0.0, SIDE.into())).collect();
        let inner = [
            front.clone(),
            front.iter().rev().copied().collect(),
            vec![front[0], front[1], middle(front[1], front[2])],
            vec![middle(front[0], front[1]), middle(front[1], front[2]), middle(front[2], front[0])],
        ][round % 4]
            .clone();
        let triangle = |points: &[Point], colour: [u8; 3]| Shape {
            outlines: vec![Outline {
                start: points[0],
                pieces: [1, 2, 0].map(|i| Piece::Line(points[i])).into(),
            }],
            colour,
            opacity: 1.0,
            rule: Rule::NonZero,
            clip: None,
        };
        let without = [before, &[triangle(&front, [18, 52, 86])], after].concat();
        let with = [before, &[triangle(&inner, [255, 0, 0]), triangle(&front, [18, 52, 86])], after].concat();
        let expected = render(&document(&without));
        assert_same_bytes(&render(&document(&with)), &expected, &format!("round {round}"));
    }
}

#[test]
fn shapes_behind_an_opaque_backdrop_change_no_byte() {
    let mut rng = Rng::new(11);
    let backdrop = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#abc");
    for round in 0..8 {
        let front = elements(0, &random_shapes(&mut rng, round % 2 == 1), <[Outline]>::to_vec);
        let hidden = elements(100, &random_shapes(&mut rng, round % 2 == 1), <[Outline]>::to_vec);
        let without = render(&svg(SIDE, SIDE, &format!("{backdrop}{front}")));
        let with = render(&svg(SIDE, SIDE, &format!("{hidden}{backdrop}{front}")));
        assert_same_bytes(&with, &without, &format!("round {round}"));
    }
}
