//! Feeds the program broken and hostile drawings: each is answered in bounded time and memory, with a
//! picture or with one line and exit code 3, and never with a half-written file.

#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Far more than any of them needs, far less than what a failure would take.
const TIME: Duration = Duration::from_secs(60);
/// Address space of the program, in KiB: 2 GiB.
const MEMORY: u64 = 2 << 20;

/// The files in `tests/bad_input` which are no drawings; all others are to be rendered.
const REFUSED: &[&str] = &[
    "billion-laughs.svg",
    "canvas-65536x65536.svg",
    "canvas-negative.svg",
    "canvas-zero.svg",
    "circle-by-inherited-fill.svg",
    "circle-by-style-sheet.svg",
    "duplicate-attributes.svg",
    "empty-file.svg",
    "html-not-svg.svg",
    "latin1-undeclared.svg",
    "svgz-bad-crc.svgz",
    "svgz-double.svgz",
    "svgz-not-svg.svgz",
    "svgz-truncated.svgz",
    "use-exponential-2pow20.svg",
    "whitespace-only.svg",
    "wrong-namespace.svg",
    "xxe-parameter-entity-http.svg",
];

struct Answer {
    code: i32,
    said: String,
}

/// Runs the program on `input`, in a folder of its own, within the bounds.
#[track_caller]
fn answer(input: &Path, arguments: &[&str]) -> Answer {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = format!("toon-raster-bad-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let folder = std::env::temp_dir().join(name);
    fs::create_dir_all(folder.join("out")).unwrap();
    let started = Instant::now();
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {MEMORY}; exec \"$@\""), "sh"])
        .arg(env!("CARGO_BIN_EXE_toon-raster"))
        .args(arguments)
        .arg(input)
        .arg(folder.join("out/out.png"))
        .stdin(Stdio::null())
        .stderr(fs::File::create(folder.join("said")).unwrap())
        .spawn()
        .unwrap();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if started.elapsed() > TIME {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{}: not answered in {TIME:?}", input.display());
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let said = fs::read_to_string(folder.join("said")).unwrap();
    let left: Vec<_> = fs::read_dir(folder.join("out")).unwrap().map(|e| e.unwrap().path()).collect();
    let code = status.code().unwrap_or_else(|| panic!("{}: {status}, {said}", input.display()));
    if code == 0 {
        assert_eq!(left, [folder.join("out/out.png")], "{}", input.display());
        assert_whole(&left[0]);
    } else {
        assert_eq!(left, Vec::<PathBuf>::new(), "{}", input.display());
    }
    fs::remove_dir_all(&folder).unwrap();
    Answer { code, said }
}

#[track_caller]
fn assert_whole(picture: &Path) {
    let mut png =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(picture).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; png.output_buffer_size().unwrap()];
    png.next_frame(&mut pixels).expect("a whole picture");
}

#[track_caller]
fn assert_refused(input: &Path, arguments: &[&str], because: &str) {
    let Answer { code, said } = answer(input, arguments);
    assert_eq!(code, 3, "{}: {said}", input.display());
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with(&format!("toon-raster: {}: ", input.display())), "{said}");
    assert!(said.contains(because), "{said:?} does not contain {because:?}");
    for word in ["panicked", "internal error", "parser failed", "RUST_BACKTRACE"] {
        assert!(!said.contains(word), "{said}");
    }
}

#[track_caller]
fn assert_rendered(input: &Path) {
    let Answer { code, said } = answer(input, &[]);
    assert_eq!(code, 0, "{}: {said}", input.display());
    let errors: Vec<&str> = said.lines().filter(|line| !line.contains(": warning: ")).collect();
    assert_eq!(errors, Vec::<&str>::new(), "{}", input.display());
}

/// A drawing made for one test.
struct Made(PathBuf);

impl Made {
    fn new(name: &str, bytes: impl AsRef<[u8]>) -> Made {
        let path = std::env::temp_dir().join(format!("toon-raster-made-{}-{name}", std::process::id()));
        fs::write(&path, bytes).unwrap();
        Made(path)
    }

    fn svg(name: &str, inside: &str) -> Made {
        let head = r#"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">"#;
        Made::new(name, format!("{head}{inside}</svg>"))
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

#[test]
fn every_bad_drawing_is_rendered_or_refused_as_listed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input");
    let mut seen = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if !file.extension().is_some_and(|e| e == "svg" || e == "svgz") {
            continue;
        }
        seen += 1;
        if REFUSED.contains(&file.file_name().unwrap().to_str().unwrap()) {
            assert_refused(&file, &[], "");
        } else {
            assert_rendered(&file);
        }
    }
    assert!(seen > REFUSED.len(), "only {seen} files");
}

/// A shape under a filter of these primitives.
fn filtered(primitives: &str) -> String {
    format!(
        r##"<filter id="f">{primitives}</filter><rect x="10" y="10" width="80" height="80" fill="#2a6" filter="url(#f)"/>"##
    )
}

#[test]
fn filters_with_absurd_numbers_are_drawn_in_bounded_time() {
    let kernel = |count: usize| "1 ".repeat(count);
    let cases = [
        ("blur", r#"<feGaussianBlur stdDeviation="1e5"/>"#.to_string()),
        ("blur-far", r#"<feGaussianBlur stdDeviation="3e38 1e-38"/>"#.into()),
        ("shadow", r#"<feDropShadow stdDeviation="1e5" dx="1e30" dy="-1e30"/>"#.into()),
        ("offset", r#"<feOffset dx="1e38" dy="-1e38"/>"#.into()),
        ("kernel-long", format!(r#"<feConvolveMatrix order="100000 1" kernelMatrix="{}"/>"#, kernel(100_000))),
        (
            "kernel-wrapped",
            format!(r#"<feConvolveMatrix edgeMode="wrap" order="1 9999" kernelMatrix="{}"/>"#, kernel(9_999)),
        ),
        (
            "kernel-far",
            r#"<feConvolveMatrix order="3" divisor="1e-38" bias="1e38" kernelMatrix="1e38 1e38 -1e38 1e38 1e38 -1e38 1 1 1"/>"#.into(),
        ),
        ("octaves", r#"<feTurbulence baseFrequency="0.1" numOctaves="1000000"/>"#.into()),
        ("frequency", r#"<feTurbulence baseFrequency="1e30" numOctaves="8" stitchTiles="stitch" seed="1e30"/>"#.into()),
        ("displacement", r#"<feDisplacementMap in2="SourceGraphic" scale="1e30" xChannelSelector="R"/>"#.into()),
        ("tile-tiny", r#"<feFlood x="10" y="10" width="1e-9" height="1e-9"/><feTile/>"#.into()),
        ("tile-huge", r#"<feFlood x="-1e9" y="-1e9" width="2e9" height="2e9"/><feTile/>"#.into()),
        (
            "light",
            r#"<feSpecularLighting surfaceScale="1e38" specularConstant="1e38" specularExponent="128"><fePointLight x="1e38" y="-1e38" z="1e38"/></feSpecularLighting>"#.into(),
        ),
        (
            "spot",
            r#"<feDiffuseLighting surfaceScale="-1e38"><feSpotLight x="5" y="5" z="5" pointsAtX="5" pointsAtY="5" pointsAtZ="5" specularExponent="1e38" limitingConeAngle="1e30"/></feDiffuseLighting>"#.into(),
        ),
        (
            "transfer",
            format!(
                r#"<feComponentTransfer><feFuncR type="table" tableValues="{}"/><feFuncB type="gamma" amplitude="1e38" exponent="-1e38" offset="1e38"/></feComponentTransfer>"#,
                kernel(100_000)
            ),
        ),
        ("matrix", format!(r#"<feColorMatrix values="{}"/>"#, "1e38 ".repeat(20))),
        ("composite", r#"<feComposite operator="arithmetic" in2="SourceGraphic" k1="1e38" k2="-1e38" k4="1e38"/>"#.into()),
        ("morphology", r#"<feMorphology operator="dilate" radius="1e5 1e-5"/>"#.into()),
        ("chain", r#"<feOffset dx="1"/>"#.repeat(5_000)),
        ("merge", format!("<feMerge>{}</feMerge>", r#"<feMergeNode in="SourceGraphic"/>"#.repeat(300))),
        (
            "doubling",
            (0..60).map(|i| format!(r#"<feBlend in="r{i}" in2="r{i}" result="r{}"/>"#, i + 1)).collect(),
        ),
    ];
    for (name, primitives) in cases {
        assert_rendered(&Made::svg(&format!("filter-{name}.svg"), &filtered(&primitives)).0);
    }
}

#[test]
fn effects_that_draw_themselves_are_cut_with_a_warning() {
    let shape = r##"<rect id="r" width="90" height="90" filter="url(#f)" mask="url(#m)"/>"##;
    for (name, effect) in [
        ("feimage", r##"<filter id="f"><feImage href="#r"/></filter>"##),
        ("mask", r##"<mask id="m"><rect width="90" height="90" mask="url(#m)"/></mask>"##),
        ("mask-on-mask", r##"<mask id="m" mask="url(#m)"><rect width="90" height="90"/></mask>"##),
    ] {
        let Answer { code, said } =
            answer(&Made::svg(&format!("self-{name}.svg"), &format!("{effect}{shape}")).0, &[]);
        assert_eq!(code, 0, "{name}: {said}");
        assert!(said.contains("warning: links by which elements draw themselves"), "{name}: {said}");
    }
}

#[test]
fn a_circle_of_gradients_keeps_its_stops_wherever_it_is_entered() {
    let circle = r##"<linearGradient id="a" href="#b"/><linearGradient id="b" href="#c"><stop stop-color="red"/></linearGradient><linearGradient id="c" href="#a"/>"##;
    for entry in ["a", "b", "c"] {
        let file = Made::svg(
            &format!("gradients-{entry}.svg"),
            &format!(r#"{circle}<rect width="9" height="9" fill="url(#{entry})"/>"#),
        );
        let scene = toon_raster::Scene::from_bytes(&fs::read(&file.0).unwrap(), &Default::default()).unwrap();
        assert!(scene.bounding_box().is_some() && scene.warnings().is_empty(), "{entry}");
    }
    // From outside the parser would go round for ever.
    let outside = r##"<linearGradient id="o" href="#a"/><rect width="9" height="9" fill="url(#o)"/>"##;
    assert_rendered(&Made::svg("gradients-outside.svg", &format!("{circle}{outside}")).0);
}

#[test]
fn patterns_within_patterns_are_drawn_in_bounded_time() {
    let nest = |depth: usize, uses: usize| -> String {
        let pattern = |i: usize| {
            let shape = format!(r##"<rect width="90" height="90" fill="url(#p{})"/>"##, i + 1).repeat(uses);
            let turn = 7 * i;
            format!(
                r##"<pattern id="p{i}" width="5" height="7.3" patternTransform="rotate({turn})" patternUnits="userSpaceOnUse">{shape}</pattern>"##
            )
        };
        let patterns: String = (0..depth).map(pattern).collect();
        let last =
            r#"width="3" height="3" patternUnits="userSpaceOnUse"><rect width="2" height="2"/></pattern>"#;
        format!(r##"{patterns}<pattern id="p{depth}" {last}<rect width="90" height="90" fill="url(#p0)"/>"##)
    };
    assert_rendered(&Made::svg("patterns-30.svg", &nest(30, 1)).0);
    assert_rendered(&Made::svg("patterns-8x2.svg", &nest(8, 2)).0);
    assert_refused(&Made::svg("patterns-20x2.svg", &nest(20, 2)).0, &[], "too often");
    for size in ["0", "1e-30", "1e30", "-5"] {
        let pattern = format!(
            r#"<pattern id="p" width="{size}" height="9" patternUnits="userSpaceOnUse"><rect width="5" height="5"/></pattern>"#
        );
        assert_rendered(
            &Made::svg(
                "pattern-size.svg",
                &format!(r##"{pattern}<rect width="90" height="90" fill="url(#p)"/>"##),
            )
            .0,
        );
    }
}

#[test]
fn six_thousand_stops_in_a_millionth_of_a_pixel_are_drawn() {
    let stops: String = (0..6000)
        .map(|i| format!(r##"<stop offset="{}" stop-color="#{:06x}"/>"##, i as f64 / 6000.0, i * 2796))
        .collect();
    for tag in [r#"linearGradient id="g" x2="1e-6""#, r#"radialGradient id="g" r="1e-4""#] {
        let name = tag.split_whitespace().next().unwrap();
        let gradient = format!(r#"<{tag} spreadMethod="reflect">{stops}</{name}>"#);
        assert_rendered(
            &Made::svg(
                &format!("stops-{name}.svg"),
                &format!(r##"{gradient}<rect width="90" height="90" fill="url(#g)"/>"##),
            )
            .0,
        );
    }
}

#[test]
fn a_drawing_used_as_an_image_two_thousand_times_is_bounded() {
    let inner = Made::svg("inner.svg", &r#"<rect width="1" height="1"/>"#.repeat(1_000));
    let link = format!(r#"<image width="9" height="9" href="{}"/>"#, inner.0.display());
    let Answer { code, said } = answer(&Made::svg("outer.svg", &link.repeat(2_000)).0, &[]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("warning: images are not drawn"), "{said}");
}

#[test]
fn what_is_not_there_is_refused() {
    assert_refused(Path::new("/no/such/drawing.svg"), &[], "no such file");
}

#[test]
fn a_device_that_never_ends_is_refused() {
    if Path::new("/dev/zero").exists() {
        assert_refused(Path::new("/dev/zero"), &[], "MiB");
    }
}

fn nested(depth: usize, tag: &str) -> String {
    let (open, close) = (format!("<{tag}>").repeat(depth), "</g>".repeat(depth));
    format!(r#"{open}<rect width="5" height="5"/>{close}"#)
}

#[test]
fn nesting_is_refused_beyond_the_parser_s_depth_and_survived_up_to_it() {
    assert_refused(&Made::svg("deep.svg", &nested(200_000, "g")).0, &[], "nested deeper");
    assert_rendered(&Made::svg("deep-1000.svg", &nested(1_000, r#"g transform="translate(.01)""#)).0);
    let clipped = format!(
        r##"<clipPath id="c"><rect width="9" height="9"/></clipPath>{}"##,
        nested(1_000, r##"g clip-path="url(#c)""##)
    );
    assert_rendered(&Made::svg("deep-clips.svg", &clipped).0);
}

#[test]
fn groups_with_opacity_are_refused_beyond_their_depth_and_survived_up_to_it() {
    let deep = |depth: usize| nested(depth, r#"g opacity=".99""#);
    assert_refused(&Made::svg("fading-1000.svg", &deep(1_000)).0, &[], "nested more than 256 deep");
    assert_refused(&Made::svg("fading-257.svg", &deep(257)).0, &[], "nested more than 256 deep");
    assert_rendered(&Made::svg("fading-256.svg", &deep(256)).0);
    assert_rendered(&Made::svg("fading-200.svg", &deep(200)).0);
    // The limit is on groups within groups, not on how many there are.
    assert_rendered(&Made::svg("fading-beside.svg", &deep(100).repeat(20)).0);
}

#[test]
fn a_long_chain_of_clips_is_survived() {
    let chain: String = (0..20_000)
        .map(|i| {
            format!(
                r##"<clipPath id="c{i}" clip-path="url(#c{})"><rect width="9" height="9"/></clipPath>"##,
                i + 1
            )
        })
        .collect();
    let file =
        Made::svg("chain.svg", &format!(r##"{chain}<rect width="9" height="9" clip-path="url(#c0)"/>"##));
    assert_ne!(answer(&file.0, &[]).code, 1);
}

#[test]
fn links_that_multiply_are_refused() {
    let doubling = |one: &dyn Fn(usize) -> String| -> String { (1..40).map(one).collect() };
    let masks = doubling(&|i| {
        let shape = format!(r##"<rect width="9" height="9" fill="#fff" mask="url(#m{})"/>"##, i - 1);
        format!(r#"<mask id="m{i}">{shape}{shape}</mask>"#)
    });
    let file = Made::svg("masks.svg", &format!(r##"{masks}<rect width="9" height="9" mask="url(#m39)"/>"##));
    assert_refused(&file.0, &[], "repeats its elements");
    let groups =
        doubling(&|i| format!(r##"<g id="g{i}"><use href="#g{0}"/><use href="#g{0}"/></g>"##, i - 1));
    assert_refused(&Made::svg("groups.svg", &groups).0, &[], "repeats its elements");
    let dots = "1 1 ".repeat(100_000);
    let path = format!(
        r##"<marker id="m">{}</marker><path d="M0 0L{dots}" marker-mid="url(#m)"/>"##,
        r#"<rect width="1" height="1"/>"#.repeat(100)
    );
    assert_refused(&Made::svg("markers.svg", &path).0, &[], "repeats its elements");
}

#[test]
fn patterns_and_masks_that_multiply_are_refused_even_where_they_are_shared() {
    let units = r#"width="9" height="9" patternUnits="userSpaceOnUse" maskUnits="userSpaceOnUse""#;
    for (tag, property) in [("pattern", "fill"), ("mask", "mask")] {
        let links: String = (1..40)
            .map(|i| {
                let shape = format!(r##"<rect width="9" height="9" {property}="url(#p{})"/>"##, i - 1);
                format!(r#"<{tag} id="p{i}" {units}>{shape}{shape}</{tag}>"#)
            })
            .collect();
        let file = format!(r##"{links}<rect width="9" height="9" {property}="url(#p39)"/>"##);
        assert_refused(&Made::svg(&format!("shared-{tag}.svg"), &file).0, &[], "repeats its elements");
    }
}

#[test]
fn arcs_out_to_infinity_are_refused() {
    let file = Made::svg("arc.svg", r#"<path id="far" d="M0 0a4 4 0 0 0-4 1e38c0 1 2 3 4 5z"/>"#);
    assert_refused(&file.0, &[], "'far' has an arc");
    assert_rendered(&Made::svg("arcs.svg", r#"<path d="M1e9 0A4e0 4 0 0 0 .0000000000004 1e-38z"/>"#).0);
}

#[test]
fn entities_that_swell_are_refused() {
    let file = Made::new(
        "entities.svg",
        format!(
            r#"<!DOCTYPE svg [<!ENTITY a "{}">]><svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><text>{}</text></svg>"#,
            "x".repeat(100_000),
            "&a;".repeat(20_000)
        ),
    );
    assert_refused(&file.0, &[], "entities");
}

#[test]
fn a_bomb_in_gzip_is_refused() {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    let spaces = vec![b' '; 1 << 20];
    for _ in 0..1_000 {
        std::io::Write::write_all(&mut packer, &spaces).unwrap();
    }
    assert_refused(&Made::new("bomb.svgz", packer.finish().unwrap()).0, &[], "more than 256 MiB");
}

#[test]
fn every_prefix_of_a_drawing_is_answered() {
    let whole =
        fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/doctype-and-pis.svg")).unwrap();
    let end = whole.windows(6).position(|w| w == b"</svg>").unwrap();
    for length in (0..end).step_by(23) {
        assert_refused(&Made::new("prefix.svg", &whole[..length]).0, &[], "");
    }
}

#[test]
fn encodings_other_than_utf_8_are_read() {
    let svg = r#"<?xml version="1.0" encoding="E"?><svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><title>é</title></svg>"#;
    let wide = |svg: &str, unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{svg}").encode_utf16().flat_map(unit).collect()
    };
    let utf16 = svg.replace("\"E\"", "\"UTF-16\"");
    assert_rendered(&Made::new("le.svg", wide(&utf16, u16::to_le_bytes)).0);
    assert_rendered(&Made::new("be.svg", wide(&utf16, u16::to_be_bytes)).0);
    assert_rendered(&Made::new("bom.svg", format!("\u{feff}{}", svg.replace("\"E\"", "\"UTF-8\""))).0);
    let latin1: Vec<u8> = svg.replace("\"E\"", "\"ISO-8859-1\"").chars().map(|c| c as u8).collect();
    assert_rendered(&Made::new("latin1.svg", latin1).0);
}

#[test]
fn a_canvas_beyond_the_limit_is_refused_with_the_name_of_the_flag() {
    let file =
        Made::new("huge.svg", r#"<svg xmlns="http://www.w3.org/2000/svg" width="1e30" height="1e30"/>"#);
    assert_refused(&file.0, &[], "a side of the picture");
    assert_refused(&file.0, &["--max-pixels", "18446744073709551615"], "a side of the picture");
    let file = Made::new("wide.svg", r#"<svg xmlns="http://www.w3.org/2000/svg" width="1e5" height="1e5"/>"#);
    assert_refused(&file.0, &[], "--max-pixels");
}
