//! How a path is walked, and how a file lists its parts, changes nothing.

use super::*;

/// Walks the outlines of random scenes in another way, which must change no byte.
#[track_caller]
fn assert_walk_is_free(seed: u64, what: &str, walk: impl Fn(&[Outline]) -> Vec<Outline>) {
    let mut rng = Rng::new(seed);
    for round in 0..16 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let expected = render(&document(&shapes));
        assert_same_bytes(&render(&walked(&shapes, &walk)), &expected, &format!("{what}, round {round}"));
    }
}

#[test]
fn a_path_walked_backwards_gives_the_same_bytes() {
    assert_walk_is_free(1, "backwards", |outlines| outlines.iter().map(Outline::reversed).collect());
}

#[test]
fn a_path_begun_at_another_vertex_gives_the_same_bytes() {
    for by in 1..4 {
        assert_walk_is_free(2, "shifted", |outlines| outlines.iter().map(|o| o.shifted(by)).collect());
    }
}

#[test]
fn doubled_vertices_give_the_same_bytes() {
    assert_walk_is_free(3, "doubled", |outlines| outlines.iter().map(Outline::doubled).collect());
}

#[test]
fn sub_paths_in_another_order_give_the_same_bytes() {
    assert_walk_is_free(4, "reordered", |outlines| outlines.iter().rev().cloned().collect());
}

#[test]
fn a_line_cut_at_its_exact_middle_gives_the_same_picture() {
    // Ends on the grid of 1/64: the middle is on that of 1/128, exact in single precision.
    let cut = |outline: &Outline| {
        let mut from = outline.start;
        let mut pieces = Vec::new();
        for &piece in &outline.pieces {
            if let Piece::Line(to) = piece {
                pieces.push(Piece::Line(middle(from, to)));
            }
            pieces.push(piece);
            from = piece.end();
        }
        Outline { start: outline.start, pieces }
    };
    let mut rng = Rng::new(5);
    for round in 0..16 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let halves = walked(&shapes, |outlines| outlines.iter().map(cut).collect());
        assert_within(&render(&halves), &render(&document(&shapes)), 1.0, &format!("round {round}"));
    }
}

#[test]
fn a_stroke_walked_backwards_is_the_same_picture() {
    let mut rng = Rng::new(6);
    for round in 0..12 {
        let outline = Outline::random(&mut rng, round % 2 == 1);
        let join = ["miter", "round", "bevel"][round % 3];
        let attributes = format!("stroke=\"#fff\" stroke-width=\"2.5\" stroke-linejoin=\"{join}\"");
        let draw = |o: &Outline| {
            let body =
                rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#000") + &path(&o.data(), "none", &attributes);
            render(&svg(SIDE, SIDE, &body))
        };
        assert_within(&draw(&outline.reversed()), &draw(&outline), CURVED, &format!("stroke {round}"));
    }
}
