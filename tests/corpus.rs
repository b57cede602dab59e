//! Every drawing among the samples that the truth can draw, and a few small ones, is within its bounds. (A whole folder
//! of drawings: `cargo run --release --example corpus_check -- DIR`.)

use std::path::Path;
use toon_raster::reference::{self, Bounds};
use toon_raster::{Renderer, Scene, Settings, Viewport};

/// A message for each way in which the drawing, `width` pixels wide, is not within the bounds.
fn faults(name: &str, tree: &usvg::Tree, width: u32) -> Vec<String> {
    let scene = Scene::from_tree(tree).expect("a scene");
    let height = (f64::from(width) * scene.size().height / scene.size().width).round().max(1.0) as u32;
    let viewport = Viewport::fit(&scene, width, height);
    let mut faults = Vec::new();
    for (linear, background) in [(false, None), (false, Some([255; 4])), (true, Some([0, 40, 90, 128]))] {
        let options = reference::Options { linear, background, ..Default::default() };
        let truth = reference::render(tree, &viewport, &options).expect("a picture");
        let settings = Settings { linear, background, ..Settings::default() };
        let picture =
            Renderer::new(settings).expect("settings").render(&scene, &viewport).expect("a picture");
        let difference = truth.compare(&picture);
        let mut bounds = Bounds::of(tree, &truth);
        if linear {
            // The sRGB encoding is steep near black: there an error of area shows up to 13 times.
            bounds.max *= 2.0;
        }
        println!("{name}, {width} px, linear {linear}, background {background:?}: {difference:.3?}");
        if !bounds.hold(&difference) {
            let (x, y) = difference.worst;
            faults.push(format!(
                "{name}, {width} px, linear {linear}, background {background:?}: \
                 max {:.2} (at most {}), mean {:.3} (at most {:.3}); pixel ({x}, {y}) is {:?}, not {:.2?}",
                difference.max,
                bounds.max,
                difference.mean,
                bounds.mean,
                picture.pixel(x, y),
                truth.straight(x, y),
            ));
        }
    }
    faults
}

#[track_caller]
fn assert_within_bounds(name: &str, body: &str) {
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 64 48'>{body}</svg>");
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).expect("valid SVG");
    let faults: Vec<String> = [64, 97].into_iter().flat_map(|width| faults(name, &tree, width)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_sample_without_filters_and_images_is_within_the_bounds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("no samples in {}", folder.display());
        return;
    };
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "svg" || e == "svgz"));
    files.sort();
    let mut all = Vec::new();
    for file in files {
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let bytes = std::fs::read(&file).expect("a readable sample");
        let tree = usvg::Tree::from_data(&bytes, &usvg::Options::default()).expect("valid SVG");
        let unsupported = reference::unsupported(&tree);
        if !unsupported.is_empty() {
            println!("{name}: skipped, the truth leaves something out: {unsupported:?}");
            continue;
        }
        all.extend(faults(&name, &tree, 256));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn abutting_and_stacked_shapes_are_within_the_bounds() {
    assert_within_bounds(
        "abutting and stacked",
        "<path fill='#07a' d='M0 0H20.3L31.7 48H0z'/><path fill='#07a' d='M64 0H20.3L31.7 48H64z'/>
         <path d='M5 5L60 9L33 44z'/><path fill='#fff' d='M5 5L60 9L33 44z'/>
         <path fill='#e62' fill-rule='evenodd' d='M32 8L41 38L14 19H50L23 38z'/>",
    );
}

#[test]
fn curves_and_strokes_are_within_the_bounds() {
    assert_within_bounds(
        "curves and strokes",
        "<circle cx='24' cy='24' r='20' fill='#fc3' stroke='#620' stroke-width='1.5'/>
         <path d='M13 29Q24 41 35 29' fill='none' stroke='#822' stroke-width='2.5'
            stroke-linecap='round'/>
         <path d='M40 6C70 6 34 40 60 44' fill='none' stroke='#258' stroke-width='3'
            stroke-dasharray='5 2' stroke-linejoin='round'/>
         <path d='M44 30l14 4l-13 4l12 5' fill='none' stroke='#000' stroke-width='.6'/>",
    );
}

#[test]
fn clips_groups_and_opacity_are_within_the_bounds() {
    assert_within_bounds(
        "clips, groups and opacity",
        "<clipPath id='a'><circle cx='24' cy='24' r='18'/><path d='M40 4H60V44z'/></clipPath>
         <clipPath id='b' clip-path='url(#a)'><path clip-rule='evenodd' d='M4 4H60V44H4zM20 16H50V30H20z'/>
         </clipPath>
         <g clip-path='url(#b)' opacity='.7'><rect width='64' height='48' fill='#27a'/>
         <g transform='rotate(20 32 24)' opacity='.5'><rect x='8' y='10' width='30' height='20'/>
         <rect x='20' y='3' width='12' height='40' fill='#fff'/></g></g>
         <path fill='#2a2' fill-opacity='.4' stroke='#a22' stroke-opacity='.6' stroke-width='3'
            paint-order='stroke' d='M30 2L62 40L50 46z'/>",
    );
}

#[test]
fn crisp_edges_are_within_the_bounds() {
    assert_within_bounds(
        "crisp edges",
        "<path shape-rendering='crispEdges' fill='#c33' d='M3.1 2.2L40.3 9.7L18.9 44.6z'/>
         <path fill='#3c3' fill-opacity='.5' d='M10.3 2.2L60.3 19.7L18.9 40.6z'/>",
    );
}

#[test]
fn thin_strips_and_needles_are_within_the_bounds() {
    let strips: String = (0..60)
        .map(|i| {
            let x = f64::from(i) * 0.83 + 2.0;
            let colour = ["#000", "#f50", "#06c"][i as usize % 3];
            format!("<path fill='{colour}' d='M{x} 2L{} 2L{} 46z'/>", x + 0.21, x + 7.0)
        })
        .collect();
    assert_within_bounds("strips", &strips);
}
