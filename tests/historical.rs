//! The methods of other days: adaptive sampling, corners of pixels, cones, beams, areas painted over one
//! another, and resvg's renderer. What each gets right, and that it gets wrong what its papers say.
//!
//! What they do not promise stands in `methods.rs`.

mod support;

use std::f64::consts::PI;
use std::path::Path;
use support::*;
use toon_raster::{Error, Method, Pixmap, Renderer, Scene, Settings, Viewport};

/// The methods this file is about.
const METHODS: [Method; 8] = [
    Method::Adaptive(64),
    Method::Adaptive(1),
    Method::Corner,
    Method::CornerTiny,
    Method::Cone,
    Method::Beam,
    Method::Area,
    Method::TinySkia,
];

fn by(method: Method) -> Settings {
    Settings { method, ..settings() }
}

fn render_by(method: Method, document: &str) -> Pixmap {
    render_with(document, by(method))
}

fn sample(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
    std::fs::read_to_string(file).expect("a readable sample")
}

/// A sample at a width, with these settings.
fn sample_with(name: &str, width: u32, settings: Settings) -> Pixmap {
    let scene = scene(&sample(name));
    let height = (f64::from(width) * scene.size().height / scene.size().width).round() as u32;
    let viewport = Viewport::fit(&scene, width, height);
    Renderer::new(settings).expect("good settings").render(&scene, &viewport).expect("a picture")
}

/// How light the pixel is, 0 ..= 1.
fn light(picture: &Pixmap, x: u32, y: u32) -> f64 {
    f64::from(picture.pixel(x, y)[0]) / 255.0
}

/// Our own samples that need no font.
const SAMPLES: [&str; 12] = [
    "abutting.svg",
    "catmull-line.svg",
    "clip.svg",
    "clip-complement.svg",
    "crisp.svg",
    "even-odd.svg",
    "fox.svg",
    "gradients.svg",
    "group-opacity.svg",
    "stacked.svg",
    "strokes.svg",
    "thin-stars.svg",
];

// ------------------------------------------------------------------------------- all of them

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

// -------------------------------------------------------------------------- Catmull's figures

#[test]
fn catmulls_hidden_colour_does_not_show() {
    // His figure 1: a quarter green, a quarter black, half blue, and red behind them all.
    for method in [Method::Exact, Method::Beam] {
        let picture = render_by(method, &sample("catmull-pixel.svg"));
        assert_eq!(picture.pixel(0, 0), [0, 64, 128, 255], "{method}");
    }
    for method in [Method::Area, Method::Cone, Method::TinySkia] {
        let [red, ..] = render_by(method, &sample("catmull-pixel.svg")).pixel(0, 0);
        assert!(red > 15, "{method} shows no red: {red}");
    }
}

#[test]
fn nothing_shines_through_beside_catmulls_black_line() {
    // His figure 6: a black line over the border of two colours, on a green table.
    let document = svg(
        12,
        9,
        &[
            rect(0.0, 0.0, 12.0, 9.0, "#0f0"),
            rect(0.0, 0.0, 6.5, 9.0, "#f00"),
            rect(6.5, 0.0, 12.0, 9.0, "#00f"),
            rect(6.25, 0.0, 6.75, 9.0, "#000"),
        ]
        .concat(),
    );
    for method in [Method::Exact, Method::Beam] {
        assert_levels(render_by(method, &document).pixel(6, 4), [63.75, 0.0, 63.75, 255.0], 0.6);
    }
    // Half red, then half blue over that, then half black: and a quarter of the green is left of it.
    assert_levels(render_by(Method::Area, &document).pixel(6, 4), [31.9, 31.9, 63.75, 255.0], 1.0);
}

// ---------------------------------------------------------------------------------- adaptive

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

// ------------------------------------------------------------------------------------ corner

/// The largest difference from the exact picture, in levels, over a sample at its own size.
fn off(method: Method, name: &str) -> f64 {
    let (picture, exact) = (render_by(method, &sample(name)), render(&sample(name)));
    let pairs = picture.data().chunks(4).zip(exact.data().chunks(4));
    let level = |p: &[u8]| [p[0], p[1], p[2], p[3]].map(f64::from);
    pairs.map(|(a, b)| distance(level(a), level(b))).fold(0.0, f64::max)
}

#[test]
fn corner_is_exact_where_one_straight_border_crosses() {
    let mut rng = Rng::new(7);
    for _ in 0..40 {
        let angle = rng.between(0.0, 2.0 * PI);
        let (sin, cos) = angle.sin_cos();
        let at = rng.point(14.0, 18.0);
        let point = |u: f64, v: f64| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos];
        let plane = [point(-64.0, 0.0), point(64.0, 0.0), point(64.0, 64.0), point(-64.0, 64.0)];
        let document = white_on_black(32, 32, &ring(&plane), "");
        assert_within(&render_by(Method::Corner, &document), &render(&document), 1.0, "a half-plane");
    }
}

#[test]
fn corner_misses_polygons_inside_a_pixel_and_tiny_finds_them() {
    let picture = render_by(Method::Corner, &sample("corner-inside.svg"));
    assert!(picture.data().iter().all(|&level| level == 255), "it saw some of the squares");
    assert!(off(Method::Corner, "corner-inside.svg") > 90.0);
    assert!(off(Method::CornerTiny, "corner-inside.svg") <= 3.0);
}

#[test]
fn corner_misses_what_reaches_in_through_one_side_and_tiny_finds_it() {
    let picture = render_by(Method::Corner, &sample("corner-one-side.svg"));
    assert_eq!(picture.pixel(1, 3), [255; 4], "it saw a tooth");
    assert!(off(Method::Corner, "corner-one-side.svg") > 70.0);
    assert!(off(Method::CornerTiny, "corner-one-side.svg") <= 3.0);
}

#[test]
fn corner_finds_one_border_of_several_across_a_side() {
    // Both bars, 60% of the pixel, cross its sides between corners that see nothing.
    assert_eq!(render_by(Method::Corner, &sample("corner-several.svg")).pixel(2, 10), [255; 4]);
    assert!(off(Method::Corner, "corner-several.svg") > 140.0);
    // Where the colours at the ends differ, one of the borders is found.
    let document = white_on_black(9, 9, "M4.2 -1h.2v11h-.2zM4.6 -1H10V10H4.6z", "");
    let found = light(&render_by(Method::Corner, &document), 4, 4);
    assert!((found - 0.6).abs() > 0.1, "{found}");
}

#[test]
fn corner_breaks_thin_polygons_and_tiny_does_not_mend_them() {
    for method in [Method::Corner, Method::CornerTiny] {
        assert!(off(method, "corner-thin.svg") > 60.0, "{method}");
    }
    // It comes and goes along the line, which is as dark everywhere.
    let picture = render_by(Method::Corner, &sample("corner-thin.svg"));
    let along: Vec<bool> = (4..28).map(|y| (3..14).any(|x| picture.pixel(x, y)[0] < 250)).collect();
    assert!(along.contains(&true) && along.contains(&false), "{along:?}");
}

#[test]
fn corner_halves_a_quarter_and_tiny_finds_the_vertex() {
    // Vertices at the middle of pixels: an eighth for a quarter.
    let picture = render_by(Method::Corner, &sample("corner-vertex.svg"));
    assert_levels(picture.pixel(2, 2), [223.1, 223.1, 223.1, 255.0], 1.0);
    assert!(off(Method::CornerTiny, "corner-vertex.svg") <= 2.0);
}

#[test]
fn corner_misses_a_line_between_two_colours() {
    let picture = render_by(Method::Corner, &sample("corner-colours.svg"));
    let [red, green, blue, _] = picture.pixel(24, 5);
    // The black line, half of the pixel, counts as the colour that it is more like, the darker one.
    let mixed = |dark: f64, light: f64| 0.75 * dark + 0.25 * light;
    let expected = [mixed(17.0, 238.0), mixed(170.0, 136.0), mixed(102.0, 187.0), 255.0];
    assert_levels([red, green, blue, 255], expected, 1.0);
    assert!(off(Method::Corner, "corner-colours.svg") > 100.0);
}

#[test]
fn corner_is_nearer_with_its_remedy() {
    for name in ["fox.svg", "even-odd.svg", "strokes.svg", "crisp.svg"] {
        let exact = sample_with(name, 128, settings());
        let error = |method| {
            let picture = sample_with(name, 128, by(method));
            let pairs = picture.data().iter().zip(exact.data());
            pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).sum::<f64>()
        };
        let (plain, tiny) = (error(Method::Corner), error(Method::CornerTiny));
        assert!(tiny < 0.9 * plain, "{name}: {tiny} and {plain}");
    }
}

// -------------------------------------------------------------------------------------- cone

#[test]
fn a_cones_share_of_a_half_plane_is_a_circular_segment() {
    let radius = 1.0 / PI.sqrt();
    let mut rng = Rng::new(5);
    for _ in 0..60 {
        let (sin, cos) = rng.between(0.0, 2.0 * PI).sin_cos();
        let at = rng.point(7.0, 9.0);
        let point = |u: f64, v: f64| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos];
        let plane = [point(-64.0, 0.0), point(64.0, 0.0), point(64.0, 64.0), point(-64.0, 64.0)];
        let picture = render_by(Method::Cone, &white_on_black(16, 16, &ring(&plane), ""));
        for (x, y) in [(7, 7), (8, 7), (7, 8), (8, 8), (6, 9), (3, 12)] {
            // How far the pixel's centre lies inside the plane.
            let (dx, dy) = (f64::from(x) + 0.5 - at[0], f64::from(y) + 0.5 - at[1]);
            let depth = (cos * dy - sin * dx).clamp(-radius, radius);
            let outside =
                radius * radius * (depth / radius).acos() - depth * (radius * radius - depth * depth).sqrt();
            let off = (255.0 * (1.0 - outside) - f64::from(picture.pixel(x, y)[0])).abs();
            assert!(off <= 0.6, "({x}, {y}) is off by {off} levels, its centre lies {depth} inside");
        }
    }
}

#[test]
fn a_cone_sees_a_little_of_the_neighbours() {
    // A border between two pixels, where the box filter sees none of the other side.
    let picture = render_by(Method::Cone, &white_on_black(9, 9, "M5 -1H10V10H5z", ""));
    assert!((5..15).contains(&picture.pixel(4, 4)[0]), "{:?}", picture.pixel(4, 4));
    assert!((240..250).contains(&picture.pixel(5, 4)[0]), "{:?}", picture.pixel(5, 4));
}

#[test]
fn cones_and_areas_multiply_what_lies_side_by_side() {
    // Two halves of a pixel abut: a quarter of what lies behind is left.
    let document = svg(
        9,
        9,
        &(rect(0.0, 0.0, 9.0, 9.0, "#000")
            + &path("M0 0H4.5V9H0z", "#fff", "")
            + &path("M4.5 0H9V9H4.5z", "#fff", "")),
    );
    for method in [Method::Area, Method::Cone] {
        assert_levels(render_by(method, &document).pixel(4, 4), [191.25, 191.25, 191.25, 255.0], 1.0);
    }
    for method in [Method::Exact, Method::Beam, Method::Corner, Method::CornerTiny, Method::Adaptive(64)] {
        assert_eq!(render_by(method, &document).pixel(4, 4), [255; 4], "{method}");
    }
}

// -------------------------------------------------------------------------------------- area

#[test]
fn the_area_of_one_shape_is_exact() {
    let mut rng = Rng::new(11);
    for _ in 0..30 {
        let polygon: Vec<Point> = (0..5).map(|_| rng.point(1.0, 31.0)).collect();
        for rule in ["fill-rule='nonzero'", "fill-rule='evenodd'"] {
            let document = white_on_black(32, 32, &ring(&polygon), rule);
            assert_within(&render_by(Method::Area, &document), &render(&document), 1.0, rule);
            assert_within(&render_by(Method::Beam, &document), &render(&document), 1.0, rule);
        }
    }
}

#[test]
fn areas_leave_a_seam_between_abutting_cells_and_the_exact_picture_none() {
    // Inside the plate of 256 cells of one colour at the left of this sample.
    let (exact, area) =
        (sample_with("abutting.svg", 400, settings()), sample_with("abutting.svg", 400, by(Method::Area)));
    let beam = sample_with("abutting.svg", 400, by(Method::Beam));
    let mut seams = 0;
    for y in 60..140 {
        for x in 60..140 {
            assert_eq!(exact.pixel(x, y), [0xfc, 0xa3, 0x11, 255], "({x}, {y})");
            assert_eq!(beam.pixel(x, y), [0xfc, 0xa3, 0x11, 255], "({x}, {y})");
            seams += u32::from(area.pixel(x, y)[0] < 0xfc - 16);
        }
    }
    assert!(seams > 800, "{seams} pixels of a seam");
}

// -------------------------------------------------------------------------------------- beam

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

// --------------------------------------------------------------------------------- tiny-skia

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
fn beam_does_not_begin_what_crosses_too_often() {
    let mut rng = Rng::new(3);
    let star: Vec<Point> = (0..6000).map(|_| rng.point(0.0, 90.0)).collect();
    let scene = scene(&svg(90, 90, &path(&ring(&star), "#000", "")));
    let picture =
        Renderer::new(by(Method::Beam)).expect("settings").render(&scene, &Viewport::fit(&scene, 90, 90));
    assert!(matches!(picture, Err(Error::Limit(message)) if message.contains("crossings")));
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
