//! Coordinates beyond all measure.

use super::*;

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
