//! Traps of the integrator.

use super::*;

#[test]
fn random_triangles_of_two_to_five_share_each_pixel_exactly() {
    let mut rng = Rng::new(12);
    assert_cells(24, "random triangles", |cell| {
        let mut triangle = || Layer::new(&[rng.point(0.0, 3.0), rng.point(0.0, 3.0), rng.point(0.0, 3.0)]);
        (0..2 + cell % 4).map(|_| triangle()).collect()
    });
}

#[test]
fn random_paths_of_several_rings_share_each_pixel_exactly() {
    let mut rng = Rng::new(13);
    assert_cells(16, "random rings", |cell| {
        let mut ring = || (0..5).map(|_| rng.point(0.0, 3.0)).collect::<Vec<_>>();
        let layers = [Layer::of(&[ring(), ring()]), Layer::of(&[ring(), ring()]).even_odd()];
        if cell % 2 == 0 {
            layers.into()
        } else {
            layers.into_iter().rev().collect()
        }
    });
}

#[test]
fn crossings_which_tie_on_the_grid_are_shared_exactly() {
    // Lines through the same mid-points of a coarse grid: every crossing falls on a grid point.
    let mut rng = Rng::new(14);
    assert_cells(20, "ties", |cell| {
        let centre = [1.0 + rng.below(5) as f64 / 4.0, 1.0 + rng.below(5) as f64 / 4.0];
        (0..2 + cell % 3)
            .map(|_| {
                let mut away = || 0.25 * (rng.below(3) as f64 - 1.0);
                let d = [away(), away()];
                let e = [away(), away()];
                Layer::new(&[
                    [centre[0] - 2.0 * d[0], centre[1] - 2.0 * d[1]],
                    [centre[0] + 2.0 * d[0], centre[1] + 2.0 * d[1]],
                    [centre[0] + 3.0 * e[0], centre[1] + 3.0 * e[1]],
                ])
            })
            .collect()
    });
}

#[test]
fn lines_through_the_middle_of_a_pixel_split_it_without_loss_at_every_angle() {
    for dx in -6..=6 {
        for dy in -6..=6 {
            if (dx, dy) == (0, 0) {
                continue;
            }
            let (dx, dy) = (f64::from(dx), f64::from(dy));
            for at in [[1.5, 1.5], [1.0, 1.0], [1.0, 1.5], [1.5, 2.0]] {
                let p = [at[0] - 9.0 * dx, at[1] - 9.0 * dy];
                let q = [at[0] + 9.0 * dx, at[1] + 9.0 * dy];
                let left =
                    vec![p, q, [q[0] - 90.0 * dy, q[1] + 90.0 * dx], [p[0] - 90.0 * dy, p[1] + 90.0 * dx]];
                let right =
                    vec![p, q, [q[0] + 90.0 * dy, q[1] - 90.0 * dx], [p[0] + 90.0 * dy, p[1] - 90.0 * dx]];
                let both = [Layer::new(&left), Layer::new(&right)];
                let one = draw(3, 3, &both, &[[70, 80, 90]; 2]);
                assert!(one.data().chunks(4).all(|p| p == [70, 80, 90, 255]), "a seam at ({dx}, {dy})");
                let truth = coverage(3, 3, &[left]);
                assert_matches(&draw(3, 3, &both, &[WHITE, [0; 3]]), &truth, STRAIGHT, "split");
            }
        }
    }
}

#[test]
fn two_edges_which_run_one_way_without_a_shared_end_are_no_chain() {
    // Both edges go down through the pixel's height together, but apart, and from different shapes.
    let a = [[-1.0, -1.0], [0.25, 0.0], [0.25, 0.5], [-1.0, 0.5]];
    let b = [[-1.0, 0.5], [0.75, 0.5], [0.75, 1.0], [-1.0, 1.0]];
    assert_exact(1, 1, &[Layer::new(&a), Layer::new(&b)], &[WHITE, RED], "steps apart");
    assert_exact(1, 1, &[Layer::of(&[a.to_vec(), b.to_vec()])], &[WHITE], "one path");
    // From border to middle and from middle to border, at different places.
    let c = [[0.125, -0.5], [0.375, 0.5], [-2.0, 0.5], [-2.0, -0.5]];
    let d = [[0.875, 0.5], [0.625, 1.5], [-2.0, 1.5], [-2.0, 0.5]];
    for order in [[&c, &d], [&d, &c]] {
        let layers = order.map(|ring| Layer::new(ring));
        assert_exact(1, 1, &layers, &[WHITE, RED], "slants apart");
    }
}

#[test]
fn vertices_which_touch_a_pixels_border_mark_nothing() {
    // Tips which touch the pixel [1, 2)² from outside and inside, at corners and at borders.
    for tip in [[1.0, 1.0], [1.0, 1.5], [2.0, 1.25], [1.5, 1.0], [1.75, 2.0], [2.0, 2.0], [1.0, 2.0]] {
        for (a, b) in [
            ([0.0, 0.25], [0.25, 2.75]),
            ([3.0, 0.5], [2.75, 3.0]),
            ([0.25, 0.0], [2.5, 0.25]),
            ([0.5, 3.0], [3.0, 2.75]),
        ] {
            let triangle = vec![tip, a, b];
            assert_white(3, 3, std::slice::from_ref(&triangle), "tip");
            let back = Layer::new(&corners(0.0, 0.0, 3.0, 3.0));
            assert_exact(3, 3, &[back, Layer::new(&triangle)], &[RED, WHITE], "tip before red");
        }
    }
}

#[test]
fn shapes_which_share_part_of_their_outline_yield_to_the_front() {
    // The same edges in two shapes, in every order and direction: depth alone decides.
    let large = vec![[0.25, 0.25], [2.75, 0.5], [2.5, 2.75], [0.5, 2.25]];
    let upper = vec![[0.25, 0.25], [2.75, 0.5], [0.5, 2.25]];
    let lower = vec![[2.75, 0.5], [2.5, 2.75], [0.5, 2.25]];
    let turned = |ring: &Vec<Point>| ring.iter().rev().copied().collect::<Vec<_>>();
    let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for turns in 0..8 {
            let shapes = [&large, &upper, &lower];
            let layers: Vec<Layer> = order
                .iter()
                .map(|&i| {
                    Layer::new(&if turns >> i & 1 == 1 { turned(shapes[i]) } else { shapes[i].clone() })
                })
                .collect();
            let front = order.map(|i: usize| colours[i]);
            assert_exact(3, 3, &layers, &front, &format!("order {order:?}, turns {turns:03b}"));
            // Both halves before the whole: its red must not show at all.
            if order[0] == 0 {
                let picture = draw(3, 3, &layers, &front);
                assert!(picture.data().chunks(4).all(|p| p[0] == 0), "red shows in order {order:?}");
            }
        }
    }
}

#[test]
fn no_mix_leaves_the_range_of_its_colours() {
    let mut rng = Rng::new(15);
    for round in 0..10 {
        let mut body = rect(0.0, 0.0, 24.0, 24.0, "#787878");
        for _ in 0..60 {
            let [r, g, b] = rng.colour().map(|c| 100 + c % 51);
            let ring: Vec<Point> = (0..4).map(|_| rng.point(-2.0, 26.0)).collect();
            let opacity = ["1", ".5", ".125"][rng.below(3) as usize];
            body += &path(&support::ring(&ring), &hex([r, g, b]), &format!("fill-opacity=\"{opacity}\""));
        }
        for settings in [settings(), Settings { linear: true, ..settings() }] {
            let picture = render_with(&svg(24, 24, &body), settings);
            for pixel in picture.data().chunks(4) {
                let inside = pixel[..3].iter().all(|c| (100..=150).contains(c));
                assert!(inside && pixel[3] == 255, "round {round}: {pixel:?}");
            }
        }
    }
}

#[test]
fn the_alpha_of_a_group_never_exceeds_its_opacity() {
    let mut rng = Rng::new(16);
    for round in 0..10 {
        let mut body = String::new();
        for _ in 0..80 {
            let ring: Vec<Point> = (0..4).map(|_| rng.point(-2.0, 26.0)).collect();
            body += &path(&support::ring(&ring), "#a0b0c0", "");
        }
        let picture = render(&svg(24, 24, &format!("<g opacity=\".5\">{body}</g>")));
        assert_drawn(&picture, "group");
        for pixel in picture.data().chunks(4) {
            assert!(pixel[3] <= 128, "round {round}: {pixel:?}");
            assert!(pixel[3] == 0 || pixel[..3] == [0xa0, 0xb0, 0xc0], "round {round}: {pixel:?}");
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let mut rng = Rng::new(17);
    let mut body = String::from(
        "<linearGradient id=\"g\"><stop stop-color=\"#f80\"/><stop offset=\"1\" stop-color=\"#08f\" \
         stop-opacity=\".5\"/></linearGradient><clipPath id=\"c\"><circle cx=\"60\" cy=\"70\" r=\"50\"/></clipPath>",
    );
    for i in 0..80 {
        let (a, b, c) = (rng.point(0.0, 150.0), rng.point(0.0, 150.0), rng.point(0.0, 150.0));
        let d = format!("M{} {}Q{} {} {} {}T80 80Z", a[0], a[1], b[0], b[1], c[0], c[1]);
        let attributes = [
            "",
            "opacity=\".5\" stroke=\"#000\"",
            "clip-path=\"url(#c)\"",
            "stroke=\"#333\" stroke-width=\"3\"",
        ];
        let fill = if i % 5 == 0 { "url(#g)".into() } else { hex(rng.colour()) };
        body += &path(&d, &fill, attributes[i % 4]);
    }
    // An odd size, so that bands and threads never divide it evenly.
    let document = svg(149, 151, &body);
    let one = render(&document);
    for threads in [2, 3, 7] {
        let many = render_with(&document, Settings { threads, ..settings() });
        assert_same_bytes(&many, &one, &format!("{threads} threads"));
    }
}

#[test]
fn a_clip_shared_by_a_group_and_what_lies_behind_it_clips_both() {
    let clip = |id: &str| format!("<clipPath id=\"{id}\"><circle cx=\"8\" cy=\"8\" r=\"6.3\"/></clipPath>");
    let drawing = |behind: &str| {
        format!(
            "{}{}<rect width=\"16\" height=\"16\" fill=\"#c20\" clip-path=\"url(#{behind})\"/>\
             <g opacity=\".5\"><rect width=\"16\" height=\"16\" fill=\"#0a0\" clip-path=\"url(#a)\"/>\
             <rect x=\"2.5\" width=\"6\" height=\"16\" fill=\"#00f\"/></g>",
            clip("a"),
            clip("b"),
        )
    };
    let shared = render(&svg(16, 16, &drawing("a")));
    let apart = render(&svg(16, 16, &drawing("b")));
    assert_same_bytes(&shared, &apart, "one clip for both");
    // Blue at half opacity over red, inside the circle; green over red beside the bar.
    assert_levels(shared.pixel(5, 8), [102.0, 17.0, 127.5, 255.0], STRAIGHT);
    assert_levels(shared.pixel(11, 8), [102.0, 102.0, 0.0, 255.0], STRAIGHT);
}

#[test]
fn gradients_that_fade_within_a_pixel_show_what_lies_behind_them() {
    let mut rng = Rng::new(77);
    for round in 0..20 {
        let mut body = String::from("<rect width=\"12\" height=\"12\" fill=\"#fff\"/>");
        for i in 0..8 {
            // From opaque to clear over a third of a pixel, somewhere on the way.
            let at = rng.on_grid(1.0, 11.0);
            let kind = if i % 2 == 0 {
                format!(
                    "<linearGradient id=\"g{i}\" gradientUnits=\"userSpaceOnUse\" x1=\"{at}\" x2=\"{}\">",
                    at + 0.3
                )
            } else {
                format!("<radialGradient id=\"g{i}\" gradientUnits=\"userSpaceOnUse\" cx=\"{at}\" cy=\"6\" r=\".4\">")
            };
            let colour = hex(rng.colour());
            let end = if i % 2 == 0 { "linear" } else { "radial" };
            body += &format!(
                "{kind}<stop stop-color=\"{colour}\"/><stop offset=\"1\" stop-color=\"{colour}\" \
                 stop-opacity=\"0\"/></{end}Gradient>"
            );
            let corners: Vec<Point> = (0..3).map(|_| rng.point(-1.0, 13.0)).collect();
            body += &path(&ring(&corners), &format!("url(#g{i})"), "");
        }
        let document = svg(12, 12, &body);
        let picture = render(&document);
        let tree = usvg::Tree::from_str(&document, &usvg::Options::default()).expect("the test's own SVG");
        let viewport = Viewport { width: 12, height: 12, transform: kurbo::Affine::IDENTITY };
        let truth = reference::render(&tree, &viewport, &reference::Options::default()).expect("it is small");
        // Both take a gradient at one point of each region, and not of the same regions.
        let mean = truth.compare(&picture).mean;
        assert!(mean < 3.0, "round {round}: {mean} levels off in the mean");
    }
}
