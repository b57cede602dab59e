//! What all of them promise.

use super::*;

#[test]
fn half_a_pixel_is_half_white() {
    // Half-planes through the middle of a pixel.
    let halves = [
        "M-1 -1H4.5V10H-1z",
        "M4.5 -1H10V10H4.5z",
        "M-1 -1H10V4.5H-1z",
        "M-1 4.5H10V10H-1z",
        "M-1 -1L10 10H-1z",
        "M-1 -1H10V4L-1 5z",
    ];
    for method in METHODS {
        // One sample sees one side.
        let levels = match method {
            Method::Adaptive(1) => continue,
            Method::Adaptive(_) => 12.0,
            // Eight of its sixteen samples, or four more.
            Method::TinySkia => 34.0,
            _ => 1.0,
        };
        for half in halves {
            let picture = render_by(method, &white_on_black(9, 9, half, ""));
            let off = 255.0 * (light(&picture, 4, 4) - 0.5).abs();
            assert!(off <= levels, "{method}: {half} is off by {off} levels");
        }
    }
}

#[test]
fn a_quarter_of_a_pixel_is_a_quarter_white_to_those_who_look_inside() {
    let picture = |method| render_by(method, &white_on_black(9, 9, "M4.5 4.5H7V7H4.5z", ""));
    for method in [Method::Beam, Method::Area, Method::CornerTiny] {
        let found = light(&picture(method), 4, 4);
        assert!((found - 0.25).abs() < 0.01, "{method}: {found}");
    }
    assert!((light(&picture(Method::Adaptive(256)), 4, 4) - 0.25).abs() < 0.05);
    // The triangle between the two places where the colour changes, and its corner.
    assert!((light(&picture(Method::Corner), 4, 4) - 0.125).abs() < 0.01);
}

#[test]
fn solid_areas_are_untouched() {
    // On and off the grid of pixels, over one another, translucent, and in a group.
    let document = svg(
        32,
        32,
        "<rect width='32' height='32' fill='#123456'/><path d='M2.3 2.4H29.1V28.7H2.3z' fill='#fedcba'/>
         <rect x='4' y='4' width='8' height='8' fill='#0a0'/><g opacity='.5'><rect x='14' y='4' width='8'
         height='8' fill='#00f'/><rect x='16' y='6' width='8' height='8' fill='#f00'/></g>
         <rect x='4' y='16' width='8' height='8' fill='#fff' fill-opacity='.4'/>",
    );
    let exact = render(&document);
    let solid =
        [(4, 4), (11, 11), (7, 8), (20, 10), (15, 5), (23, 13), (4, 16), (11, 23), (8, 20), (26, 26), (0, 0)];
    for method in METHODS {
        let picture = render_by(method, &document);
        for (x, y) in solid {
            let (found, wanted) = (picture.pixel(x, y).map(f64::from), exact.pixel(x, y).map(f64::from));
            // resvg rounds opacities and layers to 8 bits; cones see a little of the neighbours.
            let is_near_border = !matches!((x, y), (7, 8) | (8, 20) | (26, 26));
            let levels = match method {
                Method::Cone if is_near_border => continue,
                Method::TinySkia => 2.0,
                _ => 1.0,
            };
            let off = distance(found, wanted);
            assert!(off <= levels, "{method}: ({x}, {y}) is {found:?}, not {wanted:?}");
            let is_opaque = matches!((x, y), (4, 4) | (11, 11) | (7, 8) | (26, 26) | (0, 0));
            assert!(!is_opaque || off == 0.0, "{method}: ({x}, {y}) is {found:?}, not {wanted:?}");
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_threads_or_on_who_takes_the_rows() {
    for name in ["fox.svg", "clip.svg", "gradients.svg", "group-opacity.svg"] {
        let scene = scene(&sample(name));
        let viewport = Viewport::fit(&scene, 90, 70);
        for method in METHODS {
            let render = |threads| {
                let mut renderer = Renderer::new(Settings { threads, ..by(method) }).expect("settings");
                let mut rows = Vec::new();
                let picture = renderer.render(&scene, &viewport).expect("a picture");
                renderer
                    .render_bands(&scene, &viewport, |bytes| {
                        rows.extend_from_slice(bytes);
                        Ok(())
                    })
                    .expect("rows");
                assert_eq!(picture.data(), rows, "{name} by {method}: rows and picture differ");
                picture
            };
            let one = render(1);
            assert_drawn(&one, name);
            for threads in [2, 3] {
                assert_same_bytes(&render(threads), &one, &format!("{name} by {method}, {threads} threads"));
            }
        }
    }
}

#[test]
fn all_draw_the_same_picture_in_the_mean() {
    // Coarse, but it catches a fill rule, a clip, a group or a gradient that is not done at all.
    for name in SAMPLES {
        let exact = sample_with(name, 128, settings());
        for method in METHODS {
            let picture = sample_with(name, 128, by(method));
            let pixels = (exact.width() * exact.height()) as f64;
            let mut sum = 0.0;
            for y in 0..exact.height() {
                for x in 0..exact.width() {
                    sum += distance(premultiplied(picture.pixel(x, y)), premultiplied(exact.pixel(x, y)));
                }
            }
            // Seams, and single samples.
            let is_coarse =
                matches!(method, Method::Adaptive(1) | Method::Area | Method::Cone | Method::TinySkia);
            let most = if is_coarse { 12.0 } else { 5.0 };
            assert!(sum / pixels < most, "{name} by {method}: {:.2} levels off in the mean", sum / pixels);
        }
    }
}

#[test]
fn linear_light_mixes_half_black_and_half_white_to_188() {
    let document = white_on_black(9, 9, "M4.5 -1H10V10H4.5z", "");
    for method in METHODS {
        if matches!(method, Method::TinySkia | Method::Adaptive(1)) {
            continue;
        }
        let picture = render_with(&document, Settings { linear: true, ..by(method) });
        let levels = if matches!(method, Method::Adaptive(_)) { 8.0 } else { 1.0 };
        assert_levels(picture.pixel(4, 4), [188.0, 188.0, 188.0, 255.0], levels);
    }
}

#[test]
fn the_background_shows_behind_half_a_pixel() {
    let document = svg(9, 9, &path("M4.5 -1H10V10H4.5z", "#000", ""));
    for method in METHODS {
        if method == Method::Adaptive(1) {
            continue;
        }
        let picture = render_with(&document, Settings { background: Some([200, 100, 0, 255]), ..by(method) });
        assert_eq!(picture.pixel(0, 4), [200, 100, 0, 255], "{method}");
        let levels = if matches!(method, Method::Adaptive(_)) { 20.0 } else { 3.0 };
        assert_levels(picture.pixel(4, 4), [100.0, 50.0, 0.0, 255.0], levels);
        let bare = render_by(method, &document);
        assert_eq!(bare.pixel(0, 4), [0; 4], "{method}");
        assert_levels(bare.pixel(4, 4), [0.0, 0.0, 0.0, 127.5], levels);
    }
}

#[test]
fn a_fill_rule_decides_what_is_inside_a_star() {
    let star = "M16 1L25 29L2 11H30L7 29z";
    for method in METHODS {
        for (rule, middle) in [("nonzero", 255), ("evenodd", 0)] {
            let picture = render_by(method, &white_on_black(32, 32, star, &format!("fill-rule='{rule}'")));
            assert_eq!(picture.pixel(16, 16)[0], middle, "{method}, {rule}");
            assert_eq!(picture.pixel(16, 8)[0], 255, "{method}, {rule}");
        }
    }
}

#[test]
fn what_is_far_away_is_drawn_or_refused() {
    let far = "<path d='M-1e38 -1e38L1e38 1e38L1e38 -1e38Z'/><path d='M-1e30 4L1e30 5L1e30 3Z'/>";
    let scene = scene(&svg(9, 9, far));
    for method in METHODS {
        let picture =
            Renderer::new(by(method)).expect("settings").render(&scene, &Viewport::fit(&scene, 9, 9));
        match picture {
            Ok(picture) => assert_drawn(&picture, &method.to_string()),
            Err(Error::Limit(message)) => {
                assert!(method == Method::TinySkia && message.contains("1e9"), "{method}: {message}");
            }
            Err(error) => panic!("{method}: {error}"),
        }
    }
}

#[test]
fn an_empty_drawing_is_the_background() {
    let scene: Scene = scene(&svg(5, 4, ""));
    for method in METHODS {
        let settings = Settings { background: Some([1, 2, 3, 255]), ..by(method) };
        let picture = Renderer::new(settings)
            .expect("settings")
            .render(&scene, &Viewport::fit(&scene, 5, 4))
            .expect("a picture");
        assert!(picture.data().chunks(4).all(|pixel| pixel == [1, 2, 3, 255]), "{method}");
    }
}
