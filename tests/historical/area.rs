//! Areas painted over one another.

use super::*;

#[test]
fn the_area_of_one_shape_is_exact() {
    let mut rng = Rng::new(11);
    for _ in 0..30 {
        let polygon: Vec<Point> = (0..5).map(|_| rng.point(1.0, 31.0)).collect();
        for rule in ["fill-rule='nonzero'", "fill-rule='evenodd'"] {
            let document = white_on_black(32, 32, &ring(&polygon), rule);
            assert_within(&render_by(Method::Area, &document), &render(&document), 1.0, rule);
            assert_within(&render_by(Method::Beam, &document), &render(&document), 1.0, rule);
        }
    }
}

#[test]
fn areas_leave_a_seam_between_abutting_cells_and_the_exact_picture_none() {
    // Inside the plate of 256 cells of one colour at the left of this sample.
    let (exact, area) =
        (sample_with("abutting.svg", 400, settings()), sample_with("abutting.svg", 400, by(Method::Area)));
    let beam = sample_with("abutting.svg", 400, by(Method::Beam));
    let mut seams = 0;
    for y in 60..140 {
        for x in 60..140 {
            assert_eq!(exact.pixel(x, y), [0xfc, 0xa3, 0x11, 255], "({x}, {y})");
            assert_eq!(beam.pixel(x, y), [0xfc, 0xa3, 0x11, 255], "({x}, {y})");
            seams += u32::from(area.pixel(x, y)[0] < 0xfc - 16);
        }
    }
    assert!(seams > 800, "{seams} pixels of a seam");
}
