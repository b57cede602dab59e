//! A drawing that is moved or mirrored is the same picture.

use super::*;

#[test]
fn a_drawing_moved_by_whole_pixels_gives_the_same_bytes_moved() {
    let mut rng = Rng::new(7);
    for round in 0..10 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let still = render(&document(&shapes));
        let (dx, dy) = (rng.below(9) as u32, rng.below(9) as u32);
        let by = |p: Point| [p[0] + f64::from(dx), p[1] + f64::from(dy)];
        let moved = render(&walked(&shapes, |outlines| outlines.iter().map(|o| o.mapped(by)).collect()));
        assert_overlap(&moved, &still, dx, dy, &format!("moved in the file, round {round}"));
        let transform = Affine::translate((dx.into(), dy.into()));
        let viewport = Viewport { width: SIDE, height: SIDE, transform };
        let scene = scene(&document(&shapes));
        let moved = Renderer::new(settings()).expect("good settings").render(&scene, &viewport);
        let moved = moved.expect("a picture");
        assert_overlap(&moved, &still, dx, dy, &format!("moved by the viewport, round {round}"));
    }
}

#[track_caller]
fn assert_overlap(moved: &Pixmap, still: &Pixmap, dx: u32, dy: u32, what: &str) {
    assert_drawn(still, what);
    for y in dy..SIDE {
        for x in dx..SIDE {
            assert_eq!(moved.pixel(x, y), still.pixel(x - dx, y - dy), "{what}: pixel ({x}, {y})");
        }
    }
}

#[test]
fn a_drawing_in_a_mirror_is_the_same_picture_in_a_mirror() {
    let mut rng = Rng::new(8);
    let side = f64::from(SIDE);
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let plain = render(&document(&shapes));
        let mirrored = |map: &dyn Fn(Point) -> Point| {
            render(&walked(&shapes, |outlines| outlines.iter().map(|o| o.mapped(map)).collect()))
        };
        let last = SIDE - 1;
        let sideways = mirrored(&|p| [side - p[0], p[1]]);
        assert_mapped_within(&sideways, &plain, CURVED, "sideways", |x, y| (last - x, y));
        let upside_down = mirrored(&|p| [p[0], side - p[1]]);
        assert_mapped_within(&upside_down, &plain, CURVED, "upside down", |x, y| (x, last - y));
        let transposed = mirrored(&|p| [p[1], p[0]]);
        assert_mapped_within(&transposed, &plain, CURVED, "transposed", |x, y| (y, x));
    }
}
