//! Paths without area, open ones, and winding numbers beyond one.

use super::*;

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
