//! One property suite for every method that there is, with the honest exceptions in one place.
//!
//! What a property says otherwise for a method is an [`Exception`] below. Beside these, by their nature:
//!
//! | method | exception |
//! |---|---|
//! | `tiny-skia` | refuses `--linear` and coordinates past 1e9 pixels; 4 x 4 samples a pixel |
//! | `beam` | refuses drawings past a number of polygon edges or crossings, and pictures past 2^23 pixels |
//! | `cone` | a disk, not the pixel: areas differ from the pixel's even for one shape |
//! | `area`, `cone`, `tiny-skia` | shared borders leave seams, stacked shapes fringes |
//! | `corner` | knows nothing but the corners: see its six samples |
//! | `area`, `cone` | pixels with more than 48 borders or 96 places to cut at are sampled in 64 lines |
//! | `adaptive` | what all first samples miss stays missed |

mod support;

use support::*;
use toon_raster::{Method, Pixmap, Renderer, Scene, Settings, Viewport};

// -------------------------------------------------------------------------- the methods

/// A property that a method does not have by its nature.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Exception {
    /// Pixels that one colour covers may come out by this many levels otherwise.
    SolidWithin(u8),
    /// Not held against the exact picture where nothing is partly covered.
    NotExactOnWholePixels,
    /// There, within this many levels of it.
    WholePixelsWithin(u8),
    /// A straight colour may come out by this many levels otherwise, rather than by one.
    StraightColourWithin(u8),
    /// A shape that is not to be smoothed is not, bit for bit, as jagged as by `none`.
    CrispInItsOwnWay,
    /// The same within this many levels.
    CrispWithin(u8),
    /// It does not mix in linear light.
    RefusesLinear,
    /// Straight colours may be off by more than rounding where alpha is low.
    StraightColourIsRounded,
}

/// The exceptions, and why.
fn exceptions(method: Method) -> &'static [Exception] {
    use Exception::*;
    match method {
        // Premultiplied bytes inside: one level where opacity is mixed, and straight colour from them.
        // Its curves and its rule for pixel centres are its own.
        Method::TinySkia => {
            &[SolidWithin(1), NotExactOnWholePixels, StraightColourIsRounded, RefusesLinear, CrispInItsOwnWay]
        }
        // A disk sees the neighbours; a gradient is the mean of what the corners see.
        Method::Cone | Method::Corner | Method::CornerTiny => &[NotExactOnWholePixels],
        // A mean of bytes: each is rounded, with the error that its alpha allows, and the mean again.
        Method::Accumulate(_) => &[WholePixelsWithin(1), StraightColourWithin(2), CrispWithin(1)],
        // Shapes laid over one another from the back, and a mean over areas: rounded otherwise.
        Method::Area | Method::Beam => &[WholePixelsWithin(1)],
        _ => &[],
    }
}

/// The levels of the exception that `which` picks, 0 without one.
fn levels(method: Method, which: fn(&Exception) -> Option<u8>) -> u8 {
    exceptions(method).iter().find_map(which).unwrap_or(0)
}

fn is_excepted(method: Method, exception: Exception) -> bool {
    exceptions(method).contains(&exception)
}

/// Every method that can be used.
fn methods() -> Vec<Method> {
    let usable = |method: &Method| Renderer::new(Settings { method: *method, ..settings() }).is_ok();
    let methods: Vec<Method> = Method::ALL.iter().copied().filter(usable).collect();
    assert!(methods.contains(&Method::Exact) && methods.contains(&Method::Mask), "{methods:?}");
    methods
}

fn by(method: Method) -> Settings {
    Settings { threads: 1, ..Settings::of(method) }
}

// --------------------------------------------------------------------------- the scenes

const SIDE: u32 = 96;

fn triangle(rng: &mut Rng) -> Vec<Point> {
    (0..3).map(|_| rng.point(-8.0, f64::from(SIDE) + 8.0)).collect()
}

/// Opaque triangles of different colours over one another.
fn triangles(seed: u64, count: usize) -> String {
    let mut rng = Rng::new(seed);
    let body: String = (0..count).map(|_| path(&ring(&triangle(&mut rng)), &hex(rng.colour()), "")).collect();
    svg(SIDE, SIDE, &body)
}

/// A bit of everything: curves, both rules, strokes, gradients, opacity, groups, clips, crisp shapes.
fn everything() -> String {
    let star = "M48 4L76 88L4 36H92L20 88Z";
    svg(
        SIDE,
        SIDE,
        &format!(
            r##"<defs><linearGradient id="g" x2="1" y2="1"><stop stop-color="#f04"/>
            <stop offset="1" stop-color="#04f" stop-opacity=".4"/></linearGradient>
            <clipPath id="in"><circle cx="50" cy="40" r="37.3"/></clipPath>
            <clipPath id="both" clip-path="url(#in)"><path d="M3.3 9.1L90.7 30.2L60.1 93.3z"/></clipPath></defs>
            <rect x="5.5" y="7.25" width="60" height="70.5" fill="#fc3"/>
            <path d="{star}" fill="url(#g)" fill-rule="evenodd"/>
            <g opacity=".6"><path d="{star}" fill="#0a8" transform="translate(9 5) scale(.7)"/>
            <circle cx="60" cy="60" r="21.5" fill="#408"/></g>
            <g clip-path="url(#both)"><rect width="96" height="96" fill="#222" fill-opacity=".7"/>
            <circle cx="52" cy="44" r="18" fill="none" stroke="#fff" stroke-width="2.5"/></g>
            <path d="M10 85C30 40 60 120 90 66" fill="none" stroke="#063" stroke-width="5"/>
            <rect x="70.4" y="8.6" width="19" height="15" fill="#b00" shape-rendering="crispEdges"/>"##
        ),
    )
}

/// Whole pixels only, with opacity, groups, clips and gradients.
const WHOLE_PIXELS: &str = r##"<defs><linearGradient id="g"><stop stop-color="#f04"/>
    <stop offset="1" stop-color="#04f" stop-opacity=".4"/></linearGradient>
    <clipPath id="in"><path d="M8 8H40V56H8z"/></clipPath></defs>
    <rect x="4" y="3" width="50" height="40" fill="#fc3"/>
    <rect x="20" y="20" width="60" height="50" fill="#08f" fill-opacity=".5"/>
    <g opacity=".6"><rect x="10" y="50" width="30" height="30" fill="#0a8"/>
    <rect x="30" y="60" width="30" height="30" fill="#408"/></g>
    <rect width="96" height="96" fill="#222" clip-path="url(#in)" fill-opacity=".7"/>
    <rect x="60" y="2" width="30" height="80" fill="url(#g)"/>
    <path d="M64 64h20v20h-20zM70 70v8h8v-8z" fill="#000"/>"##;

// ----------------------------------------------------------------------- the properties

#[test]
fn pixels_that_one_colour_covers_are_untouched() {
    for seed in 0..4 {
        let document = triangles(seed, 12);
        let exact = render_with(&document, by(Method::Exact));
        // Around a pixel that no border touches, too, nothing changes.
        let flat = |x: u32, y: u32| {
            let near = |d: u32| d.saturating_sub(1)..(d + 2).min(SIDE);
            near(y).all(|v| near(x).all(|u| exact.pixel(u, v) == exact.pixel(x, y)))
        };
        let places: Vec<_> =
            (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)).filter(|&(x, y)| flat(x, y)).collect();
        assert!(places.len() > 1000, "there is something to look at: {}", places.len());
        for method in methods() {
            let within = levels(method, |e| match e {
                Exception::SolidWithin(levels) => Some(*levels),
                _ => None,
            });
            let picture = render_with(&document, by(method));
            for &(x, y) in &places {
                let (is, should) = (picture.pixel(x, y), exact.pixel(x, y));
                let off = is.iter().zip(should).map(|(a, b)| a.abs_diff(b)).max();
                assert!(off <= Some(within), "{method}, seed {seed}, ({x}, {y}): {is:?} for {should:?}");
            }
        }
    }
}

#[test]
fn shapes_of_one_colour_show_no_other_at_any_alpha() {
    let colour = [200, 100, 50];
    let mut rng = Rng::new(5);
    let fill = hex(colour);
    let mut body = String::new();
    for i in 0..16 {
        let opacity = ["", "fill-opacity=\".5\"", "fill-opacity=\".1\""][i % 3];
        let element = path(&ring(&triangle(&mut rng)), &fill, opacity);
        body += &if i % 4 == 0 { format!("<g opacity=\".4\">{element}{element}</g>") } else { element };
    }
    let document = svg(SIDE, SIDE, &body);
    for method in methods() {
        let picture = render_with(&document, by(method));
        let mut partly = 0;
        for [r, g, b, a] in picture.data().chunks(4).map(|p| [p[0], p[1], p[2], p[3]]) {
            if a == 0 {
                // Nothing, or an alpha that rounds to it.
                continue;
            }
            partly += usize::from(a < 255);
            if is_excepted(method, Exception::StraightColourIsRounded) {
                continue;
            }
            let within = levels(method, |e| match e {
                Exception::StraightColourWithin(levels) => Some(*levels),
                _ => None,
            });
            let off = [r, g, b].iter().zip(colour).map(|(is, should)| is.abs_diff(should)).max();
            assert!(off <= Some(within.max(1)), "{method}: {:?} at alpha {a}", [r, g, b]);
        }
        assert!(partly > 1000, "{method}: {partly} pixels let light through");
    }
}

#[test]
fn threads_and_bands_change_no_byte() {
    let (document, map) = (everything(), triangles(9, 60));
    for method in methods() {
        for document in [&document, &map] {
            for linear in [false, true] {
                if linear && is_excepted(method, Exception::RefusesLinear) {
                    continue;
                }
                let settings = Settings { linear, ..by(method) };
                let one = render_with(document, settings.clone());
                assert_drawn(&one, &method.to_string());
                for threads in [2, 3] {
                    let more = render_with(document, Settings { threads, ..settings.clone() });
                    assert_same_bytes(&more, &one, &format!("{method} with {threads} threads"));
                }
                let mut rows = Vec::new();
                let scene = scene(document);
                let viewport = Viewport::fit(&scene, SIDE, SIDE);
                let mut renderer = Renderer::new(settings).unwrap();
                let sink = |bytes: &[u8]| {
                    rows.extend_from_slice(bytes);
                    Ok(())
                };
                renderer.render_bands(&scene, &viewport, sink).unwrap();
                assert!(rows == one.data(), "{method} in bands");
                assert!(
                    renderer.render(&scene, &viewport).unwrap().data() == one.data(),
                    "{method} once again"
                );
            }
        }
    }
}

#[test]
fn where_nothing_is_partly_covered_all_are_exact() {
    let document = svg(SIDE, SIDE, WHOLE_PIXELS);
    for linear in [false, true] {
        for background in [None, Some([40, 80, 120, 255])] {
            let exact = render_with(&document, Settings { linear, background, ..by(Method::Exact) });
            for method in methods() {
                if is_excepted(method, Exception::NotExactOnWholePixels) {
                    continue;
                }
                let picture = render_with(&document, Settings { linear, background, ..by(method) });
                let within = levels(method, |e| match e {
                    Exception::WholePixelsWithin(levels) => Some(*levels),
                    _ => None,
                });
                assert_within(&picture, &exact, within.into(), &method.to_string());
            }
        }
    }
}

#[test]
fn a_crisp_shape_is_as_jagged_by_every_method_as_by_none() {
    let body = r##"<g shape-rendering="crispEdges"><path d="M9.2 4.1L90.4 33.3L40.7 88.8z" fill="#06c"/>
        <circle cx="60.3" cy="50.6" r="22.2" fill="#c60" fill-opacity=".5"/></g>"##;
    let document = svg(SIDE, SIDE, body);
    let jagged = render_with(&document, by(Method::None));
    for method in methods() {
        if is_excepted(method, Exception::CrispInItsOwnWay) {
            continue;
        }
        // The masks flatten more coarsely of their own accord.
        let settings = Settings { tolerance: Settings::DEFAULT_TOLERANCE, ..by(method) };
        let within = levels(method, |e| match e {
            Exception::CrispWithin(levels) => Some(*levels),
            _ => None,
        });
        assert_within(&render_with(&document, settings), &jagged, within.into(), &method.to_string());
    }
}

#[test]
fn every_method_is_near_the_exact_picture_of_everything() {
    let document = everything();
    let exact = render_with(&document, by(Method::Exact));
    for method in methods() {
        let most = if method == Method::None { 6.0 } else { 2.0 };
        let mean = mean_difference(&render_with(&document, by(method)), &exact);
        println!("{method:>16} {mean:.3} levels off the exact picture in the mean");
        assert!(mean <= most, "{method}: {mean} levels in the mean");
    }
}

// ------------------------------------------------------------------------- convergence

/// Mean difference over all premultiplied channels, in levels.
fn mean_difference(a: &Pixmap, b: &Pixmap) -> f64 {
    let pixels = |p: &Pixmap| -> Vec<[f64; 4]> {
        p.data().chunks(4).map(|p| premultiplied([p[0], p[1], p[2], p[3]])).collect()
    };
    let (a, b) = (pixels(a), pixels(b));
    let sum: f64 = a.iter().zip(&b).flat_map(|(a, b)| (0..4).map(move |i| (a[i] - b[i]).abs())).sum();
    sum / a.len() as f64 / 4.0
}

/// Root mean square error of coverage over the pixels of random borders.
fn rms_at_borders(method: Method, scenes: &[(Scene, Pixmap)]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (scene, exact) in scenes {
        let mut renderer = Renderer::new(by(method)).unwrap();
        let picture = renderer.render(scene, &Viewport::fit(scene, SIDE, SIDE)).unwrap();
        for (is, should) in picture.data().chunks(4).zip(exact.data().chunks(4)) {
            if (1..255).contains(&should[3]) {
                sum += (f64::from(is[3]) - f64::from(should[3])).powi(2);
                count += 1;
            }
        }
    }
    (sum / f64::from(count)).sqrt() / 255.0
}

#[test]
fn the_sampled_methods_converge_at_their_rates() {
    let scenes: Vec<(Scene, Pixmap)> = (0..6)
        .map(|seed| {
            let mut rng = Rng::new(100 + seed);
            let scene = scene(&svg(SIDE, SIDE, &path(&ring(&triangle(&mut rng)), "#fff", "")));
            let mut renderer = Renderer::new(by(Method::Exact)).unwrap();
            let exact = renderer.render(&scene, &Viewport::fit(&scene, SIDE, SIDE)).unwrap();
            (scene, exact)
        })
        .collect();
    // The number, and the power of it that the error falls with: at least, and at most where the method
    // is known to do no better.
    type Make = fn(u16) -> Method;
    let cases: [(Make, [u16; 2], f64, f64); 6] = [
        // N is the side of the grid here.
        (Method::Grid, [2, 16], 1.0, 2.0),
        (Method::Random, [4, 256], 0.5, 0.5),
        (Method::Jitter, [4, 256], 0.75, 0.75),
        (Method::Poisson, [4, 256], 0.75, 1.0),
        // One pattern of jittered points for all pixels: as lucky as that pattern is.
        (Method::Accumulate, [4, 256], 0.75, 1.0),
        (Method::Adaptive, [16, 1024], 0.75, 1.0),
    ];
    for (make, [few, many], least, most) in cases {
        let (coarse, fine) = (rms_at_borders(make(few), &scenes), rms_at_borders(make(many), &scenes));
        let rate = (coarse / fine).ln() / (f64::from(many) / f64::from(few)).ln();
        println!("{:>16} rms {coarse:.4}, {:>16} rms {fine:.4}: N^-{rate:.2}", make(few), make(many));
        assert!((least - 0.1..=most + 0.1).contains(&rate), "{}: N^-{rate}", make(many));
    }
}

#[test]
fn a_grid_of_one_sample_is_the_jagged_picture() {
    for seed in 0..4 {
        let document = triangles(40 + seed, 20);
        let jagged = render_with(&document, by(Method::None));
        assert_same_bytes(&render_with(&document, by(Method::Grid(1))), &jagged, "grid:1");
    }
}
