//! What a scene calls for is what runs for it: the census, the plan, `explain`, and the effects that
//! `--perf` tells of.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use toon_raster::{Census, Method, Options, Plan, Renderer, Scene, Settings, Viewport};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

fn scene_of(name: &str) -> Scene {
    let svg = std::fs::read(sample(name)).expect("a sample");
    Scene::from_bytes(&svg, &Options::default()).expect("a drawing")
}

fn drawing(body: &str) -> Scene {
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='40' height='40'>{body}</svg>"
    );
    Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing")
}

/// Names of the effects that ran, with how often, in alphabetical order.
fn effects(scene: &Scene, settings: Settings) -> Vec<(&'static str, u64)> {
    let mut renderer = Renderer::new(Settings { threads: 1, ..settings }).expect("a renderer");
    let viewport = Viewport::fit(scene, 80, 80);
    renderer.render(scene, &viewport).expect("a picture");
    let mut ran: Vec<_> = renderer.stages().effects.iter().map(|e| (e.name, e.runs)).collect();
    ran.sort_unstable();
    ran
}

#[test]
fn the_census_counts_what_stands_in_the_samples() {
    // Counted by hand. A path without fill="none" has a fill, seen or not.
    let all = Census::default();
    let known = [
        ("fox.svg", Census { shapes: 74, ..all }),
        ("group-opacity.svg", Census { shapes: 21, opacity: 7, groups: 3, ..all }),
        ("clip.svg", Census { shapes: 17, clips: 8, ..all }),
        ("gradients.svg", Census { shapes: 11, linear_gradients: 5, radial_gradients: 3, opacity: 2, ..all }),
        (
            "effects.svg",
            Census {
                shapes: 10,
                masks: 1,
                patterns: 1,
                filters: 1,
                blend_modes: 2,
                linear_gradients: 1,
                ..all
            },
        ),
        (
            "highlights.svg",
            Census {
                shapes: 19,
                filters: 9,
                highlights: 9,
                linear_gradients: 5,
                radial_gradients: 4,
                opacity: 9,
                ..all
            },
        ),
    ];
    for (name, wanted) in known {
        let census = scene_of(name).census().expect("a census");
        assert_eq!(census, Census { segments: census.segments, ..wanted }, "{name}");
    }
    // A triangle is three lines, a rectangle four, a circle four curves and a line without length.
    let census = drawing("<path d='M0 0H9V9z'/><rect width='3' height='3'/><circle r='4' clip-path='none'/>");
    assert_eq!(census.census().expect("a census").segments, 3 + 4 + 5);
}

#[test]
fn a_flat_scene_makes_no_shader_no_layer_and_no_table() {
    for name in ["fox.svg", "island.svg", "planet.svg", "strokes.svg", "even-odd.svg"] {
        let scene = scene_of(name);
        assert!(scene.census().expect("a census").is_flat(), "{name}");
        for stage_times in [false, true] {
            assert_eq!(effects(&scene, Settings { stage_times, ..Settings::default() }), [], "{name}");
        }
        let plan = Plan::of(&scene, &Viewport::fit(&scene, 80, 80), &Settings::default()).expect("a plan");
        assert!(plan.layers.is_empty() && plan.layer_bytes == 0 && plan.color_map_bytes == 0, "{name}");
        assert!(plan.streams && plan.edges > 0, "{name}");
    }
}

#[test]
fn opacity_clips_and_groups_are_geometry_and_make_no_layer() {
    for name in ["clip.svg", "group-opacity.svg", "clip-complement.svg"] {
        let scene = scene_of(name);
        assert!(!scene.census().expect("a census").is_flat(), "{name}");
        assert_eq!(effects(&scene, Settings::default()), [], "{name}");
    }
}

#[test]
fn each_effect_runs_for_scenes_that_call_for_it_and_no_others() {
    let square = "<rect width='30' height='30' fill='#f00'";
    let filtered =
        |primitives: &str| format!("<filter id='f'>{primitives}</filter>{square} filter='url(#f)'/>");
    let one = |name| vec![("layer content", 1), (name, 1)];
    let stops = "<stop stop-color='#000'/><stop offset='1' stop-color='#fff'/>";
    let image = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/4iOeWQAAAABJRU5ErkJggg==";
    let cases: Vec<(String, Vec<(&str, u64)>)> = vec![
        (filtered("<feGaussianBlur stdDeviation='2'/>"), one("feGaussianBlur")),
        (filtered("<feTurbulence baseFrequency='.1'/>"), one("feTurbulence")),
        (filtered("<feMorphology radius='2'/>"), one("feMorphology")),
        (filtered("<feSpecularLighting><feDistantLight/></feSpecularLighting>"), one("feSpecularLighting")),
        (filtered("<feDiffuseLighting><feDistantLight/></feDiffuseLighting>"), one("feDiffuseLighting")),
        (
            format!("{square}/><g style='mix-blend-mode:multiply'>{square}/></g>"),
            vec![("mix-blend-mode", 1)],
        ),
        (
            format!("<mask id='m'>{square}/></mask><g mask='url(#m)'>{square}/></g>"),
            vec![("mask", 1)],
        ),
        // What nobody looks at is not run.
        (filtered("<feGaussianBlur stdDeviation='2' result='a'/><feFlood/>"), one("feFlood")),
        (
            "<pattern id='p' width='1.3' height='1.3' patternUnits='userSpaceOnUse'><rect width='.4' height='.4'/></pattern>
                <rect width='30' height='30' fill='url(#p)'/>".to_string(),
            vec![("pattern", 1)],
        ),
        // Few tiles are shapes like others.
        (
            "<pattern id='p' width='9' height='9' patternUnits='userSpaceOnUse'><rect width='4' height='4'/></pattern>
                <rect width='30' height='30' fill='url(#p)'/>".to_string(),
            vec![],
        ),
        (format!("<image width='20' height='9' xlink:href='{image}'/>"), vec![("image", 1)]),
        (
            format!("<linearGradient id='g' x1='-1' x2='2'>{stops}</linearGradient><rect width='30' height='30' fill='url(#g)'/>"),
            vec![("gradient", 1)],
        ),
        (
            format!(
                "<radialGradient id='g' r='.1' spreadMethod='repeat'>{stops}</radialGradient><rect width='30' height='30' fill='url(#g)'/>"
            ),
            vec![("colour map", 1), ("gradient", 1)],
        ),
    ];
    for (body, wanted) in cases {
        let mut wanted = wanted;
        wanted.sort_unstable();
        assert_eq!(effects(&drawing(&body), Settings::default()), wanted, "{body}");
    }
}

#[test]
fn filters_run_as_often_as_the_plan_says() {
    let viewport = |scene: &Scene| Viewport::fit(scene, 80, 80);
    for name in ["effects.svg", "highlights.svg"] {
        let scene = scene_of(name);
        let plan = Plan::of(&scene, &viewport(&scene), &Settings::default()).expect("a plan");
        let planned = |wanted: &str| {
            let passes = plan.layers.iter().flat_map(|layer| &layer.passes);
            passes.filter(|pass| pass.name == wanted).count() as u64
        };
        let ran = effects(&scene, Settings::default());
        let primitives: Vec<_> = ran.iter().filter(|(name, _)| name.starts_with("fe")).collect();
        assert!(!primitives.is_empty(), "{name}: {ran:?}");
        for (primitive, runs) in primitives {
            assert_eq!(planned(primitive), *runs, "{name}: {primitive}");
        }
    }
}

#[test]
fn the_plan_refuses_what_rendering_refuses() {
    let huge = drawing(
        "<filter id='huge' x='-1e5' y='-1e5' width='2e5' height='2e5'><feGaussianBlur stdDeviation='1e4'/>
        <feMerge><feMergeNode in='SourceGraphic'/><feMergeNode/></feMerge></filter><rect width='40' height='40' filter='url(#huge)'/>",
    );
    let (pattern, plain) = (scene_of("effects.svg"), scene_of("fox.svg"));
    let beam = Settings::of(Method::Beam);
    for (scene, side, settings) in
        [(&huge, 9000, Settings::default()), (&pattern, 40, beam.clone()), (&plain, 40, beam)]
    {
        let viewport = Viewport::fit(scene, side, side);
        let plan = Plan::of(scene, &viewport, &settings).expect("a plan");
        let made = Renderer::new(settings).expect("a renderer").render(scene, &viewport);
        assert_eq!(plan.refused.is_some(), made.is_err(), "{:?} {:?}", plan.refused, made.err());
    }
}

fn run(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_toon-raster"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program");
    child.stdin.take().expect("its input").write_all(input).expect("it listens");
    child.wait_with_output().expect("its end")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

#[test]
fn explain_tells_of_each_drawing_by_itself() {
    let arguments = ["explain", "--json", "samples/fox.svg", "samples/corpus/snail-pixels.svgz", "-"];
    let island = std::fs::read(sample("island.svg")).expect("a sample");
    let output = run(&arguments, &island);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let lines: Vec<serde_json::Value> =
        text(&output.stdout).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let [fox, snail, island] = &lines[..] else { panic!("three drawings") };
    assert_eq!((&fox["shapes"], &fox["flat"], &fox["layers"]), (&74.into(), &true.into(), &0.into()));
    assert_eq!((&snail["opacity"]["count"], &snail["flat"]), (&253.into(), &false.into()));
    assert_eq!((&island["input"], &island["shapes"]), (&"standard input".into(), &53.into()));
    let effects = [
        "opacity",
        "groups",
        "clips",
        "masks",
        "linear_gradients",
        "radial_gradients",
        "patterns",
        "images",
        "filters",
        "highlights",
        "text",
        "blend_modes",
        "animation",
    ];
    for effect in effects {
        assert_eq!((&fox[effect]["count"], &fox[effect]["machinery"]), (&0.into(), &serde_json::Value::Null));
    }
    assert!(snail["opacity"]["machinery"].is_string() && fox["edges"].as_u64() > Some(1000));
}

#[test]
fn explain_says_in_words_that_nothing_runs_for_a_flat_drawing() {
    let said = text(&run(&["explain", "samples/fox.svg"], b"").stdout);
    assert!(said.contains("none  flat paint alone") && !said.contains("layer pixels"), "{said}");
    let said = text(&run(&["explain", "samples/effects.svg", "-w", "600"], b"").stdout);
    for part in ["600 x 400", "filter 'shadow'", "feDropShadow", "not called for", "in 2 layers"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn explain_tells_how_long_a_drawing_moves_and_what_moves() {
    let output = run(&["explain", "--json", "samples/anim/bounce.svg"], b"");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(told["animation"]["count"], 3);
    assert_eq!(told["motion"]["moving"], serde_json::json!({"rx": 1, "transform": 2}));
    assert_eq!((&told["motion"]["seconds"], &told["motion"]["repeats"]), (&0.8.into(), &true.into()));
    assert_eq!(told["motion"]["frames"], 20);
}

#[test]
fn explain_tells_of_each_light_how_many_samples_would_cure_it() {
    let output = run(&["explain", "--json", "samples/highlights.svg"], b"");
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let lights = told["lights"].as_array().expect("lights");
    assert_eq!(lights.len(), 9);
    for light in lights {
        assert!(light["aliasing"].as_u64() <= light["pixels"].as_u64());
        assert_eq!(light["aliasing"].as_u64() > Some(0), light["samples_a_side"].as_u64() > Some(1));
    }
    let thinnest = lights.iter().find(|light| light["filter"] == "cylinder-4").expect("a cylinder");
    assert!(thinnest["samples_a_side"].as_u64() >= Some(4), "{thinnest}");
}

#[test]
fn explain_tells_where_index_aa_applies_and_what_it_costs() {
    let filtered = |primitives: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='30'><filter id='f' x='0' y='0' width='1' height='1'>
            {primitives}</filter><rect width='40' height='30' filter='url(#f)'/></svg>"
        )
    };
    let (noise, table) = (
        "<feTurbulence baseFrequency='.3'/>",
        "<feComponentTransfer><feFuncR type='discrete' tableValues='0 1'/></feComponentTransfer>",
    );
    let matrix = "<feColorMatrix type='hueRotate' values='40'/>";
    for (primitives, tables) in [
        (format!("{noise}{table}"), 1),
        (format!("{noise}{matrix}{matrix}{table}"), 1),
        (format!("{noise}<feOffset dx='1'/>{table}"), 0),
        (format!("{table}{noise}"), 0),
        (noise.to_string(), 0),
    ] {
        let svg = filtered(&primitives);
        for (flags, on) in
            [(&["explain", "--json", "-"][..], false), (&["explain", "--json", "--index-aa", "-"], true)]
        {
            let told: serde_json::Value =
                serde_json::from_slice(&run(flags, svg.as_bytes()).stdout).expect("JSON");
            // The noise at the corners of 40 x 30 pixels.
            let wanted = serde_json::json!({"on": on, "tables": tables, "noise_points": tables * 41 * 31});
            assert_eq!(told["index_aa"], wanted, "{primitives}");
        }
        // Where it says that nothing is averaged, nothing is.
        let picture =
            |flags: &[&str]| run(&[&["-", "-", "--format", "rgba"], flags].concat(), svg.as_bytes()).stdout;
        assert_eq!(picture(&[]) != picture(&["--index-aa"]), tables > 0, "{primitives}");
    }
    let said = text(&run(&["explain", "-"], filtered(&format!("{noise}{table}")).as_bytes()).stdout);
    assert!(said.contains("--index-aa would average them, for 1271 more points of noise"), "{said}");
}

#[test]
fn explain_fails_as_rendering_does() {
    let one = |arguments: &[&str], input: &[u8]| {
        let output = run(arguments, input);
        (output.status.code(), text(&output.stderr).lines().count())
    };
    assert_eq!(one(&["explain", "-"], b"<svg"), (Some(3), 1));
    assert_eq!(one(&["explain", "samples/none.svg"], b""), (Some(3), 1));
    assert_eq!(one(&["explain", "samples/none.svg", "samples/fox.svg"], b""), (Some(1), 1));
    assert_eq!(one(&["explain", "-i", "none", "samples/fox.svg"], b""), (Some(3), 1));
    assert_eq!(one(&["explain", "samples/fox.svg", "-w", "99999"], b""), (Some(3), 1));
}

#[test]
fn perf_gives_each_effect_its_time_and_a_flat_drawing_none() {
    let perf = |name: &str| -> serde_json::Value {
        let output = run(&[&format!("samples/{name}"), "-", "--format", "rgba", "--perf=json"], b"");
        assert_eq!(output.status.code(), Some(0));
        serde_json::from_slice(&output.stderr).expect("JSON")
    };
    assert_eq!(perf("fox.svg")["effects"], serde_json::json!({}));
    let told = perf("effects.svg");
    for effect in ["pattern", "feDropShadow"] {
        assert!(told["effects"][effect]["ms"].as_f64() > Some(0.0), "{effect}: {told}");
        assert_eq!(told["effects"][effect]["runs"], 1, "{effect}: {told}");
    }
    assert_eq!(perf("highlights.svg")["highlights"].as_array().map(Vec::len), Some(9));
}
