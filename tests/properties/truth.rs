//! Random scenes are the exact picture, as an oracle has it.

use super::*;

/// The layers of straight shapes and their clips, and of each shape which layers are its own.
fn layers(shapes: &[Shape]) -> (Vec<Layer>, Vec<(usize, Option<usize>)>) {
    let ring = |outline: &Outline| {
        let ends = outline.pieces.iter().map(|piece| piece.end());
        std::iter::once(outline.start).chain(ends).collect::<Vec<Point>>()
    };
    let (mut layers, mut own) = (Vec::new(), Vec::new());
    for shape in shapes {
        own.push((layers.len(), shape.clip.as_ref().map(|_| layers.len() + 1)));
        layers.push(Layer { rings: shape.outlines.iter().map(ring).collect(), rule: shape.rule });
        layers.extend(shape.clip.as_ref().map(|clip| Layer::new(&ring(clip))));
    }
    (layers, own)
}

/// Premultiplied colour, 0 to 1, in front of another.
fn over(front: [f64; 4], back: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| front[i] + (1.0 - front[3]) * back[i])
}

#[test]
fn random_scenes_of_rules_veils_clips_and_a_group_are_the_exact_picture() {
    let mut rng = Rng::new(21);
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, false);
        let (back, front) = shapes.split_at(6);
        // Six shapes in a group of opacity 3/4, four before it, on white.
        let same = <[Outline]>::to_vec;
        let body = format!(
            "{}<g opacity=\".75\">{}</g>{}",
            rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#fff"),
            elements(0, back, same),
            elements(6, front, same)
        );
        let (layers, own) = layers(&shapes);
        let truth = Sweep::exact(&layers).picture(SIDE, SIDE, |inside| {
            let seen = |range: std::ops::Range<usize>, mut below: [f64; 4]| {
                for i in range {
                    let (shape, clip) = own[i];
                    if inside[shape] && clip.is_none_or(|clip| inside[clip]) {
                        let [r, g, b] = shapes[i].colour.map(|c| f64::from(c) / 255.0 * shapes[i].opacity);
                        below = over([r, g, b, shapes[i].opacity], below);
                    }
                }
                below
            };
            let group = seen(0..6, [0.0; 4]).map(|channel| 0.75 * channel);
            seen(6..10, over(group, [1.0; 4])).map(|channel| 255.0 * channel)
        });
        assert_matches(&render(&svg(SIDE, SIDE, &body)), &truth, STRAIGHT, &format!("round {round}"));
    }
}
