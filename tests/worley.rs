//! Worley's claims (Advanced Antialiasing, in Texturing & Modeling, ch. 5), each with a number: gradients
//! finer than a pixel against 64 x 64 points of it and against what more and more points tend to, the width of
//! the spot, tables over noise.

use toon_raster::kurbo::Affine;
use toon_raster::{Options, Renderer, Scene, Settings, Viewport};

const SIDE: u32 = 48;

fn scene(body: &str) -> Scene {
    sized_scene(SIDE, body)
}

fn sized_scene(side: u32, body: &str) -> Scene {
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='{side}' height='{side}'>{body}</svg>");
    Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing")
}

/// A square full of a gradient: black, then a hard stop to white, which turns grey.
fn gradient(element: &str, attributes: &str) -> Scene {
    scene(&filled(SIDE, element, attributes))
}

fn filled(side: u32, element: &str, attributes: &str) -> String {
    format!(
        "<{element} id='g' gradientUnits='userSpaceOnUse' {attributes}><stop stop-color='#000'/>
        <stop offset='.4' stop-color='#000'/><stop offset='.4' stop-color='#fff'/>
        <stop offset='1' stop-color='#808080'/></{element}>
        <rect width='{side}' height='{side}' fill='url(#g)'/>"
    )
}

/// The stops above: 0 ..= 255.
fn level(t: f64) -> f64 {
    match t {
        t if t < 0.4 => 0.0,
        t => 255.0 - 127.0 * (t - 0.4) / 0.6,
    }
}

fn levels(scene: &Scene, settings: Settings) -> Vec<f64> {
    let mut renderer = Renderer::new(Settings { threads: 1, ..settings }).expect("a renderer");
    let picture = renderer.render(scene, &Viewport::fit(scene, SIDE, SIDE)).expect("a picture");
    picture.data().chunks_exact(4).map(|pixel| f64::from(pixel[0])).collect()
}

/// The mean of 64 x 64 points of each pixel, spread by the golden ratio rather than in rows, which would
/// be off by two levels where an edge goes along them.
fn supersampled(level_at: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    const POINTS: u32 = 64 * 64;
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let pixel = |i: u32| {
        let (x, y) = (f64::from(i % SIDE), f64::from(i / SIDE));
        let point = |p: u32| (f64::from(p) + 0.5) / f64::from(POINTS);
        let points = (0..POINTS).map(|p| level_at(x + point(p), y + (f64::from(p) * GOLDEN).fract()));
        points.sum::<f64>() / f64::from(POINTS)
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

/// Largest and root mean square difference.
fn difference(a: &[f64], b: &[f64]) -> (f64, f64) {
    let off = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    (off().fold(0.0, f64::max), (off().map(|d| d * d).sum::<f64>() / a.len() as f64).sqrt())
}

/// The centre of rings, between pixels.
const CENTRE: (f64, f64) = (20.3, 17.6);

/// Rings of this width: the parameter at a point.
fn ring(width: f64) -> impl Fn(f64, f64) -> f64 {
    move |x, y| ((x - CENTRE.0).hypot(y - CENTRE.1) / width).fract()
}

fn rings(width: f64) -> Scene {
    let (x, y) = CENTRE;
    gradient("radialGradient", &format!("cx='{x}' cy='{y}' r='{width}' spreadMethod='repeat'"))
}

/// Of 8-bit levels.
const ROUNDING: f64 = 0.5;

/// Where the rings' stops are, in turns: the last of one turn is the first of the next.
const STOPS: [f64; 2] = [0.0, 0.4];

/// The mean of rings of this width over each pixel of a square from a corner on: 512 rows of it, each integrated
/// from ring to ring, between which Gauss's four points are exact to a thousandth of a level.
fn integrated(width: f64, (left, top): (u32, u32)) -> Vec<f64> {
    const ROWS: u32 = 512;
    const GAUSS: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
    ];
    let parameter = |x: f64, y: f64| x.hypot(y) / width;
    // Of a piece of a row to the right of the centre.
    let piece = |from: f64, to: f64, y: f64| {
        let (first, last) = (parameter(from, y), parameter(to, y));
        let turns = first.floor() as u32..=last as u32;
        let stops = turns.flat_map(|turn| STOPS.map(|stop| f64::from(turn) + stop));
        let rings = stops.filter(|&t| first < t && t < last);
        let edges = rings.map(|t| ((t * width).powi(2) - y * y).max(0.0).sqrt()).chain([to]);
        let mut sum = 0.0;
        edges.fold(from, |a, b| {
            let at = |node: f64| level(parameter(a + (b - a) * (node + 1.0) / 2.0, y).fract());
            sum += (b - a) / 2.0 * GAUSS.iter().map(|&(node, weight)| weight * at(node)).sum::<f64>();
            b
        });
        sum
    };
    let row = |x: f64, y: f64| match (x, x + 1.0) {
        (from, to) if from >= 0.0 => piece(from, to, y),
        (from, to) if to <= 0.0 => piece(-to, -from, y),
        (from, to) => piece(0.0, -from, y) + piece(0.0, to, y),
    };
    let pixel = |i: u32| {
        let (x, y) = (f64::from(left + i % SIDE) - CENTRE.0, f64::from(top + i / SIDE) - CENTRE.1);
        let rows = (0..ROWS).map(|r| row(x, y + (f64::from(r) + 0.5) / f64::from(ROWS)));
        rows.sum::<f64>() / f64::from(ROWS)
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

#[test]
fn rings_finer_than_a_pixel_are_within_a_quarter_level_of_their_mean_and_rounding() {
    for width in [7.0, 3.0, 1.5, 0.9, 0.6] {
        let parameter = ring(width);
        let found = levels(&rings(width), Settings::default());
        let truth = integrated(width, (0, 0));
        let points = supersampled(|x, y| level(parameter(x, y)));
        let (most, rms) = difference(&found, &truth);
        let (most_of_points, rms_of_points) = difference(&points, &truth);
        let (apart, _) = difference(&found, &points);
        println!(
            "rings {width} px wide: at most {most:.3} levels off, rms {rms:.3}; \
            64 x 64 points {most_of_points:.3}, rms {rms_of_points:.3}; {apart:.3} from one another"
        );
        // Rounding alone makes an rms of 1 / √12.
        assert!(rms < 0.3 && most < ROUNDING + 0.25, "{width}: {most}, rms {rms}");
        // What is more than a level from 64 x 64 points is so by the points' own error.
        assert!(apart < ROUNDING + 0.25 + most_of_points, "{width}: {apart}, {most_of_points}");
    }
}

#[test]
fn rings_in_a_picture_so_large_that_there_are_tables_are_as_near_to_their_mean_on_any_threads() {
    const LARGE: u32 = 512;
    for width in [1.9, 0.9] {
        let (x, y) = CENTRE;
        let attributes = format!("cx='{x}' cy='{y}' r='{width}' spreadMethod='repeat'");
        let scene = sized_scene(LARGE, &filled(LARGE, "radialGradient", &attributes));
        let picture = |threads: usize| {
            let mut renderer =
                Renderer::new(Settings { threads, ..Settings::default() }).expect("a renderer");
            renderer.render(&scene, &Viewport::fit(&scene, LARGE, LARGE)).expect("a picture")
        };
        let found = picture(1);
        assert!(found.data() == picture(3).data(), "{width}");
        for (left, top) in [(0, 0), (20, 17), (90, 30), (18, 300), (400, 0), (464, 464)] {
            let pixel = |i: u32| found.pixel(left + i % SIDE, top + i / SIDE)[0];
            let part: Vec<f64> = (0..SIDE * SIDE).map(|i| f64::from(pixel(i))).collect();
            let truth = integrated(width, (left, top));
            let (most, rms) = difference(&part, &truth);
            // Means of fine rings are nearly all alike, and so is what rounding them is off by.
            let rounded: Vec<f64> = truth.iter().map(|v| v.round()).collect();
            let (_, rounding) = difference(&rounded, &truth);
            println!(
                "rings {width} px wide from {left}, {top}: at most {most:.3} levels off, rms {rms:.3}; \
                rounding {rounding:.3}"
            );
            assert!(
                rms < rounding + 0.03 && most < ROUNDING + 0.25,
                "{width}, {left}, {top}: {most}, rms {rms}"
            );
        }
    }
}

#[test]
fn stripes_at_any_angle_and_width_are_within_a_level_of_64_x_64_points() {
    for (width, degrees) in [(5.0, 30.0), (1.3, 41.0), (0.7, 10.0), (0.02, 77.0)] {
        let angle = f64::to_radians(degrees);
        let (along_x, along_y) = (angle.cos() / width, angle.sin() / width);
        let attributes = format!(
            "x1='0' y1='0' x2='{}' y2='{}' spreadMethod='repeat'",
            angle.cos() * width,
            angle.sin() * width
        );
        let truth = supersampled(|x, y| level((x * along_x + y * along_y).fract()));
        let found = levels(&gradient("linearGradient", &attributes), Settings::default());
        let (most, rms) = difference(&found, &truth);
        println!("stripes {width} px wide at {degrees}: at most {most:.3} levels off, rms {rms:.3}");
        assert!(rms < 0.5 && most < 1.0 + ROUNDING, "{width}: {most}, rms {rms}");
    }
}

#[test]
fn a_thousand_cycles_a_pixel_cost_no_more_colours_than_one() {
    // Not a matter of time: the mean of a whole pixel of cycles is the map's, everywhere.
    let mean = (0..10_000).map(|i| level((f64::from(i) + 0.5) / 10_000.0)).sum::<f64>() / 10_000.0;
    let found = levels(&rings(0.001), Settings::default());
    assert!(found.iter().all(|level| (level - mean).abs() <= 1.0), "{mean}");
}

#[test]
fn the_error_is_least_where_the_spot_is_one_pixel_wide() {
    for width in [3.0, 0.8] {
        let parameter = ring(width);
        let truth = supersampled(|x, y| level(parameter(x, y)));
        let error = |spot_scale: f64| {
            difference(&levels(&rings(width), Settings { spot_scale, ..Settings::default() }), &truth).1
        };
        let scales = [0.0, 0.25, 0.5, 0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0];
        let curve: Vec<f64> = scales.iter().map(|&scale| error(scale)).collect();
        println!("rings {width} px wide: {curve:.2?} at {scales:?}");
        let best = (0..scales.len()).min_by(|&a, &b| curve[a].total_cmp(&curve[b])).expect("some");
        assert_eq!(scales[best], 1.0, "{curve:?}");
        assert!(curve[0] > 10.0 * curve[best], "points alias: {curve:?}");
    }
}

/// Noise through a table of hard steps.
fn noise(frequency: f64) -> Scene {
    scene(&format!(
        "<filter id='f' x='0' y='0' width='1' height='1' color-interpolation-filters='sRGB'>
        <feTurbulence type='fractalNoise' baseFrequency='{frequency}' numOctaves='2' seed='3'/>
        <feColorMatrix values='0 0 0 0 0  1 0 0 0 0  0 1 0 0 0  0 0 0 0 1'/>
        <feComponentTransfer><feFuncG type='discrete' tableValues='0 1 0 1 0 1 0 1'/>
        <feFuncB type='table' tableValues='0 1 0 1 0 1 0'/></feComponentTransfer></filter>
        <rect width='{SIDE}' height='{SIDE}' filter='url(#f)'/>"
    ))
}

/// Green and blue, row by row, `fine` pixels a unit.
fn colours(scene: &Scene, fine: u32, index_aa: bool) -> Vec<[f64; 2]> {
    let settings = Settings { threads: 1, index_aa, ..Settings::default() };
    let side = SIDE * fine;
    let viewport = Viewport { width: side, height: side, transform: Affine::scale(f64::from(fine)) };
    let picture = Renderer::new(settings).and_then(|mut r| r.render(scene, &viewport)).expect("a picture");
    picture.data().chunks_exact(4).map(|p| [p[1], p[2]].map(f64::from)).collect()
}

#[test]
fn tables_over_noise_alias_less_where_index_anti_aliasing_is_asked_for() {
    const FINE: u32 = 16;
    for frequency in [0.08, 0.2] {
        let scene = noise(frequency);
        let fine = colours(&scene, FINE, false);
        let (points, spots) = (colours(&scene, 1, false), colours(&scene, 1, true));
        let mut sums = [[0.0f64; 2]; 2];
        // Noise is looked at in pixels' corners: the spot is around the corner.
        for (x, y) in (1..SIDE - 1).flat_map(|x| (1..SIDE - 1).map(move |y| (x, y))) {
            let (left, top) = (x * FINE - FINE / 2, y * FINE - FINE / 2);
            let within = (0..FINE * FINE).map(|i| (left + i % FINE, top + i / FINE));
            for channel in 0..2 {
                let all = within.clone().map(|(x, y)| fine[(y * SIDE * FINE + x) as usize][channel]);
                let truth = all.sum::<f64>() / f64::from(FINE * FINE);
                let at = (y * SIDE + x) as usize;
                for (sum, found) in sums.iter_mut().zip([points[at], spots[at]]) {
                    sum[channel] += (found[channel] - truth).powi(2);
                }
            }
        }
        let count = f64::from((SIDE - 2) * (SIDE - 2));
        let rms = sums.map(|sum| sum.map(|s| (s / count).sqrt()));
        println!("noise of {frequency}: rms error of steps and of slopes {:.1?} -> {:.1?}", rms[0], rms[1]);
        for channel in 0..2 {
            assert!(rms[1][channel] < 0.5 * rms[0][channel], "{frequency}: {rms:?}");
        }
    }
}

#[test]
fn index_anti_aliasing_changes_nothing_but_tables_over_noise() {
    let blurred = scene(&format!(
        "<filter id='f'><feGaussianBlur stdDeviation='2'/><feComponentTransfer>
        <feFuncA type='discrete' tableValues='0 1 0 1'/></feComponentTransfer></filter>
        <rect x='9' y='9' width='20' height='20' filter='url(#f)'/><rect width='{SIDE}' height='4'/>"
    ));
    assert_eq!(colours(&blurred, 1, true), colours(&blurred, 1, false));
}

/// A channel of a picture 16 times as fine, as means over each pixel.
fn means_of_fine_pixels(scene: &Scene, channel: usize) -> Vec<f64> {
    const FINE: u32 = 16;
    let side = SIDE * FINE;
    let viewport = Viewport { width: side, height: side, transform: Affine::scale(f64::from(FINE)) };
    let settings = Settings { threads: 1, ..Settings::default() };
    let fine = Renderer::new(settings).and_then(|mut r| r.render(scene, &viewport)).expect("a picture");
    let mean = |i: u32| {
        let (left, top) = (i % SIDE * FINE, i / SIDE * FINE);
        let pixels = (0..FINE * FINE).map(|p| fine.pixel(left + p % FINE, top + p / FINE)[channel]);
        pixels.map(f64::from).sum::<f64>() / f64::from(FINE * FINE)
    };
    (0..SIDE * SIDE).map(mean).collect()
}

#[test]
fn where_circles_leave_places_without_colour_the_border_of_these_is_smooth() {
    // From a small circle on to a greater one beside it: outside their tangents there is nothing.
    let scene = gradient("radialGradient", "cx='30' cy='25' r='9' fx='8.3' fy='20.1' fr='2'");
    let mut renderer = Renderer::new(Settings { threads: 1, ..Settings::default() }).expect("a renderer");
    let picture = renderer.render(&scene, &Viewport::fit(&scene, SIDE, SIDE)).expect("a picture");
    let found: Vec<f64> = picture.data().chunks_exact(4).map(|pixel| f64::from(pixel[3])).collect();
    let truth = means_of_fine_pixels(&scene, 3);
    let (most, rms) = difference(&found, &truth);
    let far_off = found.iter().zip(&truth).filter(|(a, b)| (*a - *b).abs() > 16.0).count();
    println!("alpha: at most {most:.1} levels off, {far_off} pixels by more than 16, rms {rms:.2}");
    // Eight by eight points a pixel are off by up to a sixteenth of it, but in the pixel where the tangents meet,
    // of which no corner has colour.
    assert!(far_off <= 1 && rms < 1.5, "{far_off}, rms {rms}");
}

#[test]
fn rings_that_are_ellipses_around_a_focus_are_within_a_level_of_a_picture_16_times_as_fine() {
    let squeezed = "gradientTransform='translate(22 25) rotate(30) scale(1 .2)'";
    let cases = [
        ("an ellipse", format!("cx='0' cy='0' r='8' {squeezed}")),
        ("a focus", "cx='24' cy='24' r='6' fx='20.5' fy='22'".to_string()),
        ("a focal circle", "cx='24' cy='24' r='9' fx='22' fy='23' fr='2.5'".to_string()),
        ("both", format!("cx='0' cy='0' r='9' fx='4' fy='-5' {squeezed}")),
    ];
    for (name, attributes) in cases {
        for spread in ["repeat", "reflect", "pad"] {
            let scene = gradient("radialGradient", &format!("{attributes} spreadMethod='{spread}'"));
            let found = levels(&scene, Settings::default());
            let truth = means_of_fine_pixels(&scene, 0);
            let (most, rms) = difference(&found, &truth);
            println!("{name}, {spread}: at most {most:.3} levels off, rms {rms:.3}");
            assert!(most < 1.0 && rms < 0.35, "{name}, {spread}: {most}, rms {rms}");
        }
    }
}
