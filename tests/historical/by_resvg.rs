//! resvg's renderer.

use super::*;

/// The picture that resvg makes, straight.
fn resvg(document: &str, width: u32) -> Pixmap {
    let tree = usvg::Tree::from_str(document, &usvg::Options::default()).expect("valid SVG");
    let (w, h) = (tree.size().width(), tree.size().height());
    let height = (width as f32 * h / w).round() as u32;
    let mut pixmap = tiny_skia::Pixmap::new(width, height).expect("a size");
    let scale = tiny_skia::Transform::from_scale(width as f32 / w, height as f32 / h);
    resvg::render(&tree, scale, &mut pixmap.as_mut());
    let mut straight = Pixmap::new(width, height);
    for (bytes, pixel) in straight.data_mut().chunks_exact_mut(4).zip(pixmap.pixels()) {
        let color = pixel.demultiply();
        bytes.copy_from_slice(&[color.red(), color.green(), color.blue(), color.alpha()]);
    }
    straight
}

#[test]
fn tiny_skia_draws_what_resvg_draws() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("samples")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        // No fonts here; and what needs layers is refused (tests/effects.rs).
        .filter(|name| {
            name.ends_with(".svg") && !["text.svg", "effects.svg", "highlights.svg"].contains(&&**name)
        })
        .collect();
    names.sort();
    assert!(names.len() > 15, "{names:?}");
    for name in names {
        let document = sample(&name);
        let size = scene(&document).size();
        // A whole factor, so that neither has to round it.
        let width = size.width as u32 * (1 + 199 / size.width as u32);
        let (ours, theirs) = (sample_with(&name, width, by(Method::TinySkia)), resvg(&document, width));
        let (mut worst, mut far) = (0.0f64, 0);
        for y in 0..ours.height() {
            for x in 0..ours.width() {
                let off = distance(premultiplied(ours.pixel(x, y)), premultiplied(theirs.pixel(x, y)));
                worst = worst.max(off);
                far += u32::from(off > 2.0);
            }
        }
        let share = f64::from(far) / f64::from(ours.width() * ours.height());
        println!("{name}: at most {worst:.1} levels, {far} pixels ({:.3}%) by more than 2", 100.0 * share);
        // Clips within clips, at the outer one's border.
        let (levels, most) = if name == "clip.svg" { (32.0, 0.001) } else { (2.0, 0.0) };
        assert!(worst <= levels && share <= most, "{name}: {worst} levels, {share} of all pixels");
    }
}

#[test]
fn tiny_skia_refuses_linear_light() {
    let settings = Settings { linear: true, ..by(Method::TinySkia) };
    let scene = scene(&svg(9, 9, &rect(0.0, 0.0, 5.0, 5.0, "#000")));
    match Renderer::new(settings).expect("settings").render(&scene, &Viewport::fit(&scene, 9, 9)) {
        Err(Error::Setting(message)) => assert!(message.contains("--linear"), "{message}"),
        other => panic!("{other:?}"),
    }
}
