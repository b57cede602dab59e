//! Beams.

use super::*;

#[test]
fn beam_bears_witness_for_exact() {
    for name in SAMPLES {
        for (linear, background) in [(false, None), (true, Some([255; 4])), (false, Some([0, 40, 90, 128]))] {
            let with = |method| Settings { linear, background, ..by(method) };
            let (exact, beam) =
                (sample_with(name, 120, with(Method::Exact)), sample_with(name, 120, with(Method::Beam)));
            // In linear light, near black, a level is a thirteenth of one.
            let levels = if linear { 3.0 } else { 1.0 };
            // Where a gradient turns, beam takes its mean over a pixel around the middle of a visible part,
            // exact that over the part.
            let levels = if name == "gradients.svg" { levels + 8.0 } else { levels };
            assert_within(&beam, &exact, levels, &format!("{name}, linear {linear}, {background:?}"));
        }
    }
}

#[test]
fn beam_bears_witness_on_random_translucent_scenes() {
    let mut rng = Rng::new(21);
    for round in 0..12 {
        let body: String = (0..12)
            .map(|i| {
                let polygon: Vec<Point> = (0..3 + rng.below(3)).map(|_| rng.point(-4.0, 36.0)).collect();
                let opacity = [1.0, 0.5, 0.8][rng.below(3) as usize];
                let shape = path(&ring(&polygon), &hex(rng.colour()), &format!("fill-opacity='{opacity}'"));
                match i % 5 {
                    0 => format!("<g opacity='.6'>{shape}"),
                    3 => format!("{shape}</g>"),
                    _ => shape,
                }
            })
            .collect();
        let document = svg(32, 32, &format!("{body}</g>"));
        assert_within(
            &render_by(Method::Beam, &document),
            &render(&document),
            1.0,
            &format!("round {round}"),
        );
    }
}

#[test]
fn beam_says_when_a_drawing_is_too_large() {
    // Each translucent disk doubles the number of colours that may be seen somewhere.
    let body: String = (0..400)
        .map(|i| {
            let (x, y) = (f64::from(i % 20) * 5.0 + 3.0, f64::from(i / 20) * 5.0 + 3.0);
            format!("<circle cx='{x}' cy='{y}' r='14' fill='#{:03x}' fill-opacity='.37'/>", i * 9 + 17)
        })
        .collect();
    let scene = scene(&svg(110, 110, &body));
    let render = |width| {
        let viewport = Viewport::fit(&scene, width, width);
        Renderer::new(by(Method::Beam)).expect("settings").render(&scene, &viewport)
    };
    for (what, result) in [("parts", render(110)), ("pixels", render(5000))] {
        match result {
            Err(Error::Limit(message)) => {
                assert!(message.contains("beam") && message.contains("exact"), "{message}");
                assert!(message.contains(what) && !message.contains('\n'), "{message}");
            }
            other => panic!("{what}: {other:?}"),
        }
    }
}

#[test]
fn beam_does_not_begin_what_crosses_too_often() {
    let mut rng = Rng::new(3);
    let star: Vec<Point> = (0..6000).map(|_| rng.point(0.0, 90.0)).collect();
    let scene = scene(&svg(90, 90, &path(&ring(&star), "#000", "")));
    let picture =
        Renderer::new(by(Method::Beam)).expect("settings").render(&scene, &Viewport::fit(&scene, 90, 90));
    assert!(matches!(picture, Err(Error::Limit(message)) if message.contains("crossings")));
}
