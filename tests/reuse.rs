//! What a frame takes over from others changes no byte: sequences in which much stands still, and all the
//! ways in which something may not, rendered both ways by `--verify-reuse`; and by the library.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use toon_raster::frames::cels::Cels;
use toon_raster::frames::Timeline;
use toon_raster::render::Canvas;
use toon_raster::{Method, Options, Renderer, Scene, Settings, Viewport};

/// A background of everything that takes time, which stays.
const BACKGROUND: &str = r##"<defs>
    <linearGradient id="sky" x2="0" y2="1"><stop stop-color="#8cf"/><stop offset="1" stop-color="#fec"/></linearGradient>
    <filter id="soft"><feGaussianBlur stdDeviation="2"/></filter>
    <pattern id="dots" width="7" height="5" patternUnits="userSpaceOnUse"><circle cx="3" cy="2" r="2" fill="#a60"/></pattern>
    <clipPath id="window"><path d="M20 15h60l-9 40h-40z"/></clipPath>
    <mask id="fade"><rect width="200" height="120" fill="#999"/><circle cx="150" cy="60" r="20" fill="#fff"/></mask>
</defs>
<rect width="200" height="120" fill="url(#sky)"/>
<circle cx="60" cy="30" r="18" fill="#fff" filter="url(#soft)"/>
<g clip-path="url(#window)"><path d="M0 50L90 10V70z" fill="#385"/><path d="M10 50L99 20" stroke="#000" stroke-width="3"/></g>
<path d="M0 90q50-30 100 0t100 0v40H0z" fill="url(#dots)" stroke="#420" stroke-width="2"/>
<g opacity=".6"><circle cx="120" cy="80" r="25" fill="#c33"/><circle cx="140" cy="80" r="25" fill="#33c"/></g>
<g mask="url(#fade)"><rect x="120" y="20" width="70" height="60" fill="#094"/></g>
<path d="M100 20h40v40z" fill="#ff0" style="mix-blend-mode:multiply"/>"##;

fn drawing(content: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="200" height="120">{content}</svg>"#)
}

/// A character that walks over the background.
fn character() -> String {
    drawing(&format!(
        r##"{BACKGROUND}<g stroke="#000"><animateTransform attributeName="transform" type="translate" from="-20 0" to="200 30" dur="1s"/>
        <circle cx="10" cy="50" r="9" fill="#fc8"/><path d="M4 60h12l4 25H0z" fill="#e63" opacity=".9"/></g>"##
    ))
}

/// Nothing stands still.
fn camera(kind: &str, from: &str, to: &str) -> String {
    drawing(&format!(
        r#"<g>{BACKGROUND}<animateTransform attributeName="transform" type="{kind}" from="{from}" to="{to}" dur="1s"/></g>"#
    ))
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("toon-raster-reuse-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    fn write(&self, name: &str, svg: &str) -> String {
        let path = self.0.join(name);
        fs::write(&path, svg).unwrap();
        path.to_str().unwrap().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Raw frames of an input.
fn frames(input: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_toon-raster"));
    command.args([input, "-", "--format", "rgba"]).args(arguments).stdin(Stdio::null());
    command.output().unwrap()
}

/// Raw frames, which must be the same rendered both ways.
fn verified(input: &str, arguments: &[&str]) -> Vec<u8> {
    let output = frames(input, &[&["--verify-reuse", "-q"], arguments].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), said.as_ref()), (Some(0), ""), "{input} {arguments:?}");
    output.stdout
}

#[test]
fn a_character_over_a_background_pans_and_zooms_are_the_same_rendered_whole() {
    let folder = Folder::new("generated");
    for (name, svg) in [
        ("character.svg", character()),
        ("pan.svg", camera("translate", "0 0", "-30 7")),
        ("zoom.svg", camera("scale", "1", "2.5")),
        ("turn.svg", camera("rotate", "0", "20")),
    ] {
        let input = folder.write(name, &svg);
        let frames = verified(&input, &["--fps", "8"]);
        assert_eq!(frames.len(), 8 * 200 * 120 * 4, "{name}");
    }
}

#[test]
fn every_sample_that_moves_is_the_same_rendered_whole() {
    let samples = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/anim")).unwrap();
    let mut count = 0;
    for sample in
        samples.map(|entry| entry.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "svg"))
    {
        verified(sample.to_str().unwrap(), &["--fps", "5", "-w", "150"]);
        count += 1;
    }
    assert!(count >= 9);
}

#[test]
fn threads_and_chunks_change_no_byte_of_a_sequence_that_reuses_tiles() {
    let folder = Folder::new("threads");
    let input = folder.write("character.svg", &character());
    let all = frames(&input, &["--fps", "24", "-t", "1"]).stdout;
    assert_eq!(all.len(), 24 * 200 * 120 * 4);
    for threads in ["2", "5"] {
        assert!(frames(&input, &["--fps", "24", "-t", threads]).stdout == all, "{threads} threads");
    }
    for count in [3, 24] {
        let part = |i: i32| frames(&input, &["--chunk", &format!("{i}/{count}"), "-t", "2"]).stdout;
        assert!((1..=count).flat_map(part).eq(all.iter().copied()), "{count} chunks");
    }
}

#[test]
fn motion_blur_is_the_same_rendered_whole_in_either_light_and_by_every_kind_of_method() {
    let folder = Folder::new("blur");
    let input = folder.write("character.svg", &character());
    let blurred = ["--fps", "4", "--shutter", "180", "--shutter-samples", "5"];
    verified(&input, &blurred);
    verified(&input, &[blurred.as_slice(), &["--linear"]].concat());
    for method in ["mask", "corner", "area", "grid:2"] {
        verified(&input, &["--fps", "3", "--aa", method]);
    }
    // A trace of a shape, too little for alpha, in a tile that rests beside one that moves.
    let trace = drawing(
        r##"<rect width="9.001" height="8" fill="#8ad"/>
        <path d="M70 0h4v4z"><animateTransform attributeName="transform" type="translate" to="4" dur="1s"/></path>"##,
    );
    verified(&folder.write("trace.svg", &trace), &blurred);
    // Those that need the whole picture draw no filters.
    let plain = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/anim/bounce.svg");
    for method in ["beam", "tiny-skia"] {
        verified(plain, &["--fps", "8", "-w", "60", "--aa", method]);
    }
}

#[test]
fn drawings_as_frames_share_what_does_not_change_whatever_comes_and_goes() {
    let folder = Folder::new("files");
    let extra = [
        "",
        r##"<circle cx="50" cy="60" r="20" fill="#f0f"/>"##,
        r##"<g clip-path="url(#window)"><circle cx="50" cy="40" r="20" fill="#0ff"/></g>"##,
        r##"<g opacity=".5"><circle cx="50" cy="40" r="20"/><circle cx="60" cy="40" r="20"/></g>"##,
        r##"<g opacity=".5"><circle cx="50" cy="40" r="20"/></g><g opacity=".5"><circle cx="60" cy="40" r="20"/></g>"##,
        r##"<use href="#w"/><path id="w" d="M90 90h30v9z" transform="translate(9 9)"/>"##,
        r##"<style>circle { fill: #123 }</style>"##,
    ];
    for (n, extra) in extra.iter().enumerate() {
        let (before, after) = if n % 2 == 0 { (*extra, "") } else { ("", *extra) };
        folder.write(&format!("f.{n}.svg"), &drawing(&format!("{before}{BACKGROUND}{after}")));
    }
    let frames = verified(folder.0.to_str().unwrap(), &["-t", "1"]);
    assert_eq!(frames.len(), extra.len() * 200 * 120 * 4);
}

#[test]
fn most_tiles_of_a_fixed_background_are_painted_once() {
    let folder = Folder::new("share");
    let input = folder.write("character.svg", &character().replace("width=\"200\"", "width=\"1600\""));
    let output = frames(&input, &["--fps", "24", "-t", "1", "--perf=json"]);
    let perf: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert!(perf["tiles_reused"].as_f64().unwrap() > 0.8, "{perf}");
    let camera = folder.write("pan.svg", &camera("translate", "0 0", "-30 7"));
    let output = frames(&camera, &["--fps", "24", "-t", "1", "--perf=json"]);
    let perf: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert!(perf["tiles_reused"].as_f64().unwrap() < 0.2, "{perf}");
}

#[test]
fn a_canvas_takes_tiles_only_from_pictures_made_in_the_same_way() {
    let scene = Scene::from_bytes(drawing(BACKGROUND).as_bytes(), &Options::default()).unwrap();
    let viewport = Viewport::fit(&scene, 200, 120);
    let render = |settings: Settings, lender: Option<&Canvas>, viewport: &Viewport| {
        let mut canvas = Canvas::new(1, 1);
        let mut renderer = Renderer::new(Settings { threads: 2, ..settings }).unwrap();
        let lenders: Vec<&Canvas> = lender.into_iter().collect();
        let count = renderer.render_onto(&mut canvas, &lenders, &scene, viewport).unwrap();
        let whole = renderer.render(&scene, viewport).unwrap();
        assert!(canvas.picture() == &whole);
        (canvas, count.rendered)
    };
    let (first, rendered) = render(Settings::default(), None, &viewport);
    assert!(rendered > 0);
    assert_eq!(render(Settings::default(), Some(&first), &viewport).1, 0);
    let moved = Viewport { transform: viewport.transform.then_translate((0.25, 0.0).into()), ..viewport };
    let taller = Viewport { height: 119, ..viewport };
    for (settings, viewport) in [
        (Settings { linear: true, ..Settings::default() }, &viewport),
        (Settings { background: Some([9; 4]), ..Settings::default() }, &viewport),
        (Settings::of(Method::Mask), &viewport),
        (Settings::default(), &moved),
        (Settings::default(), &taller),
    ] {
        assert_eq!(render(settings, Some(&first), viewport).1, rendered);
    }
}

#[test]
fn a_scene_put_together_from_cels_is_that_of_the_whole_document() {
    let options = Options::default();
    let timeline = Timeline::read(character().as_bytes(), &options).unwrap();
    let cels = Cels::new();
    let mut renderer = Renderer::new(Settings { threads: 1, ..Settings::default() }).unwrap();
    for seconds in [0.0, 0.4, 0.2, 0.4] {
        let put_together = timeline.scene_at(seconds, &cels, &options).unwrap();
        let whole = Scene::from_bytes(timeline.document_at(seconds).as_bytes(), &options).unwrap();
        let viewport = Viewport::fit(&whole, 200, 120);
        let [a, b] = [&put_together, &whole].map(|scene| renderer.render(scene, &viewport).unwrap());
        assert!(a == b, "{seconds} s");
    }
}
