//! The way of rendering (threads, buffers, bands, a renderer used before) changes no byte, and wrong settings are errors.

use super::*;

#[test]
fn the_number_of_threads_changes_no_byte() {
    let mut rng = Rng::new(15);
    for round in 0..6 {
        let scene = scene(&document(&random_shapes(&mut rng, true)));
        let viewport = Viewport::fit(&scene, 97, 131);
        let draw = |threads| {
            let settings = Settings { threads, ..settings() };
            Renderer::new(settings).expect("good settings").render(&scene, &viewport).expect("a picture")
        };
        let one = draw(1);
        for threads in [0, 2, 3, 7] {
            assert_same_bytes(&draw(threads), &one, &format!("round {round}, {threads} threads"));
        }
    }
}

#[test]
fn a_stride_wider_than_a_row_leaves_the_padding_alone() {
    let mut rng = Rng::new(16);
    let scene = scene(&document(&random_shapes(&mut rng, true)));
    let viewport = Viewport::fit(&scene, 37, 41);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let plain = renderer.render(&scene, &viewport).expect("a picture");
    assert_drawn(&plain, "plain");
    for padding in [1, 4, 100] {
        let stride = 37 * 4 + padding;
        // The last row needs no padding.
        let mut buffer = vec![0xa5; stride * 40 + 37 * 4];
        renderer.render_into(&scene, &viewport, &mut buffer, stride).expect("a picture");
        for (y, row) in buffer.chunks(stride).enumerate() {
            assert_eq!(&row[..37 * 4], &plain.data()[y * 37 * 4..(y + 1) * 37 * 4], "row {y}");
            assert!(row[37 * 4..].iter().all(|&b| b == 0xa5), "padding of row {y}");
        }
    }
}

#[test]
fn a_buffer_or_a_stride_too_small_is_an_error_and_nothing_is_written() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let viewport = Viewport::fit(&scene, 8, 8);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut buffer = vec![7; 8 * 8 * 4 - 1];
    let result = renderer.render_into(&scene, &viewport, &mut buffer, 32);
    assert!(
        matches!(result, Err(Error::Buffer { width: 8, height: 8, needed: 256, given: 255 })),
        "{result:?}"
    );
    assert!(buffer.iter().all(|&b| b == 7));
    let mut buffer = vec![7; 999];
    assert!(renderer.render_into(&scene, &viewport, &mut buffer, 31).is_err(), "a stride below a row");
}

#[test]
fn bands_are_the_rows_of_the_picture_from_top_to_bottom() {
    let mut rng = Rng::new(17);
    let scene = scene(&document(&random_shapes(&mut rng, true)));
    for threads in [1, 3] {
        for (width, height) in [(1, 1), (61, 1), (1, 67), (64, 200), (100, 333)] {
            let viewport = Viewport::fit(&scene, width, height);
            let settings = Settings { threads, ..settings() };
            let mut renderer = Renderer::new(settings).expect("good settings");
            let whole = renderer.render(&scene, &viewport).expect("a picture");
            assert!(width * height < 1000 || whole.data().iter().any(|&b| b != 0), "an empty picture");
            let mut rows = Vec::new();
            let sink = |band: &[u8]| {
                assert!(
                    !band.is_empty() && band.len().is_multiple_of(width as usize * 4),
                    "a band of whole rows"
                );
                rows.extend_from_slice(band);
                Ok(())
            };
            renderer.render_bands(&scene, &viewport, sink).expect("a picture");
            assert!(rows == whole.data(), "{width} x {height}, {threads} threads");
        }
    }
}

#[test]
fn an_error_of_the_sink_ends_the_rendering_and_comes_back() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let viewport = Viewport::fit(&scene, 64, 4000);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut calls = 0;
    let result = renderer.render_bands(&scene, &viewport, |_| {
        calls += 1;
        Err(std::io::Error::other("full").into())
    });
    assert!(matches!(&result, Err(Error::Io(error)) if error.to_string() == "full"), "{result:?}");
    assert_eq!(calls, 1, "nothing is sent after an error");
}

#[test]
fn a_renderer_used_before_gives_the_bytes_of_a_new_one() {
    let mut rng = Rng::new(18);
    let mut used = Renderer::new(settings()).expect("good settings");
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let scene = scene(&document(&shapes));
        let (width, height) = ([97, 16, 200][round % 3], [33, 150, 7, 64][round % 4]);
        let viewport = Viewport::fit(&scene, width, height);
        let fresh = Renderer::new(settings()).expect("good settings").render(&scene, &viewport);
        let (again, fresh) = (used.render(&scene, &viewport).expect("a picture"), fresh.expect("a picture"));
        assert_same_bytes(&again, &fresh, &format!("round {round}"));
    }
}

#[test]
fn every_pixel_of_the_callers_buffer_is_written() {
    let scene = scene(&svg(16, 16, &rect(4.0, 4.0, 12.0, 12.0, "#fff")));
    let viewport = Viewport::fit(&scene, 16, 16);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut buffer = vec![0xa5; 16 * 16 * 4];
    renderer.render_into(&scene, &viewport, &mut buffer, 64).expect("a picture");
    assert!(buffer == renderer.render(&scene, &viewport).expect("a picture").data());
    assert_eq!(&buffer[..4], &[0; 4], "what is empty is transparent");
    assert_eq!(&buffer[8 * 64 + 32..][..4], &[255; 4], "the square is white");
}

#[test]
fn settings_out_of_range_are_errors() {
    for tolerance in [0.0, -1.0, 1e-5, 101.0, f64::NAN, f64::INFINITY] {
        let result = Renderer::new(Settings { tolerance, ..settings() });
        assert!(matches!(result, Err(Error::Setting(_))), "tolerance {tolerance}");
    }
    for tolerance in [1e-4, 0.1, 100.0] {
        assert!(Renderer::new(Settings { tolerance, ..settings() }).is_ok(), "tolerance {tolerance}");
    }
}

#[test]
fn a_viewport_of_no_size_or_not_finite_is_an_error() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let good = Viewport::fit(&scene, 8, 8);
    let nan = Affine::new([f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0]);
    for bad in [
        Viewport { width: 0, ..good },
        Viewport { height: 0, ..good },
        Viewport { transform: nan, ..good },
        Viewport { transform: Affine::translate((f64::INFINITY, 0.0)), ..good },
    ] {
        let result = renderer.render(&scene, &bad);
        assert!(matches!(result, Err(Error::Size(_))), "{bad:?} gives {:?}", result.map(|_| "a picture"));
    }
}

#[test]
fn a_finer_tolerance_changes_curves_by_less_than_a_level() {
    let mut rng = Rng::new(19);
    for round in 0..8 {
        let document = document(&random_shapes(&mut rng, true));
        let fine = render_with(&document, Settings { tolerance: 1e-3, ..settings() });
        assert_within(&render(&document), &fine, CURVED, &format!("round {round}"));
    }
}
