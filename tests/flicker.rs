//! Thin lines that move slowly keep their light: exact areas do not flicker, samples do.

use toon_raster::kurbo::Affine;
use toon_raster::{Method, Options, Renderer, Scene, Settings, Viewport};

/// A fence of 120 lines, a quarter to three quarters of a pixel wide and up to 2 degrees off the vertical,
/// within a margin.
fn fence() -> Scene {
    let lines: String = (0..120)
        .map(|i| {
            let (i, x) = (f64::from(i), 10.0 + 1.5 * f64::from(i));
            let (width, lean) = (0.25 + 0.5 * (i * 0.618).fract(), 12.0 * ((i * 0.382).fract() - 0.5));
            format!(r#"<path d="M{x} 15h{width}l{lean} 170h-{width}z" fill="white"/>"#)
        })
        .collect();
    let svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="210" height="200">{lines}</svg>"#);
    Scene::from_bytes(svg.as_bytes(), &Options::default()).unwrap()
}

/// The largest change of the total light from one frame to the next, as a share of it, in a pan of a
/// sixteenth of a pixel a frame.
fn largest_change(method: Method, scene: &Scene) -> f64 {
    let mut renderer = Renderer::new(Settings { threads: 1, ..Settings::of(method) }).unwrap();
    let mut light = |frame: u32| {
        let by = f64::from(frame) / 16.0;
        let viewport = Viewport { width: 210, height: 200, transform: Affine::translate((by, 0.3 * by)) };
        let picture = renderer.render(scene, &viewport).unwrap();
        picture.data().chunks_exact(4).map(|pixel| f64::from(pixel[3])).sum::<f64>()
    };
    let light: Vec<f64> = (0..32).map(&mut light).collect();
    light.windows(2).map(|pair| (pair[1] - pair[0]).abs() / pair[0]).fold(0.0, f64::max)
}

#[test]
fn a_slow_pan_of_thin_lines_keeps_its_light_to_a_ten_thousandth_a_frame() {
    let scene = fence();
    let (exact, tiny_skia) =
        (largest_change(Method::Exact, &scene), largest_change(Method::TinySkia, &scene));
    println!("largest change a frame: exact {exact:.2e}, tiny-skia {tiny_skia:.2e}");
    assert!(exact < 1e-4, "{exact}");
    assert!(tiny_skia > 10.0 * exact, "{tiny_skia}");
}
