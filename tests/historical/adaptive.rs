//! Adaptive sampling.

use super::*;

/// The counter of this name after a picture was made.
fn count(method: Method, document: &str, name: &str) -> u64 {
    let scene = scene(document);
    let mut renderer = Renderer::new(by(method)).expect("settings");
    let size = scene.size();
    renderer
        .render(&scene, &Viewport::fit(&scene, size.width as u32, size.height as u32))
        .expect("a picture");
    renderer.stages().counts.iter().find(|(known, _)| *known == name).expect("a known counter").1
}

#[test]
fn adaptive_converges_to_the_exact_picture() {
    let wedges: String = (0..9)
        .map(|i| {
            let (a, b) = (f64::from(i) * 0.7, f64::from(i) * 0.7 + 0.4);
            let at = |t: f64| [20.0 + 30.0 * t.cos(), 20.0 + 30.0 * t.sin()];
            path(&ring(&[[20.0, 20.0], at(a), at(b)]), ["#fff", "#c40", "#06c"][i as usize % 3], "")
        })
        .collect();
    let document = svg(40, 40, &(rect(0.0, 0.0, 40.0, 40.0, "#000") + &wedges));
    let exact = render(&document);
    let rms = |n| {
        let picture = render_by(Method::Adaptive(n), &document);
        let squares: f64 = picture
            .data()
            .iter()
            .zip(exact.data())
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
            .sum();
        (squares / picture.data().len() as f64).sqrt()
    };
    let errors = [4, 16, 64, 256, 1024].map(rms);
    println!("rms error of adaptive:4, 16, 64, 256, 1024: {errors:.3?}");
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.7 * pair[0], "four times the samples leave {errors:.3?}");
    }
    // Faster than random samples, whose error falls by 16 here.
    assert!(errors[4] < errors[0] / 30.0, "{errors:.3?}");
}

#[test]
fn adaptive_spends_its_samples_where_borders_are() {
    let document = white_on_black(64, 64, "M10.3 10.7L50.2 20.1L30.5 60.3z", "");
    let samples = count(Method::Adaptive(64), &document, "samples");
    let bordered = count(Method::Adaptive(64), &document, "pixels_with_borders");
    // One for each even pixel, never more than N for the others.
    assert!(bordered < 64 * 64 / 8, "{bordered}");
    assert!(samples <= 64 * 64 - bordered + 64 * bordered, "{samples}");
    assert!(samples < 64 * 64 * 64 / 8, "{samples}");
    assert!(count(Method::Adaptive(64), &document, "pixels_refined") <= bordered);
}

#[test]
fn adaptive_does_not_depend_on_where_the_picture_ends() {
    // Places of samples come from the pixel's own.
    let body = path("M10.3 10.7L50.2 20.1L30.5 60.3z", "#000", "");
    let (large, small) = (svg(64, 64, &body), svg(40, 50, &body));
    let (large, small) = (render_by(Method::Adaptive(16), &large), render_by(Method::Adaptive(16), &small));
    for y in 0..50 {
        for x in 0..40 {
            assert_eq!(large.pixel(x, y), small.pixel(x, y), "({x}, {y})");
        }
    }
}
