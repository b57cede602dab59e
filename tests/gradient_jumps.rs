//! Gradients that jump are edges like any other: what lies before and behind them in a pixel is composited on
//! either side of the jump.

use toon_raster::reference;
use toon_raster::{Pixmap, Renderer, Scene, Settings, Viewport};

const SIZE: u32 = 24;

fn svg(body: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='{SIZE}' height='{SIZE}'>{body}</svg>")
}

fn render(svg: &str, linear: bool) -> (usvg::Tree, Viewport, Pixmap) {
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).expect("valid SVG");
    let scene = Scene::from_tree(&tree).expect("a scene");
    let viewport = Viewport::fit(&scene, SIZE, SIZE);
    let settings = Settings { linear, ..Settings::default() };
    let picture = Renderer::new(settings).expect("settings").render(&scene, &viewport).expect("a picture");
    (tree, viewport, picture)
}

/// The gray in the pixel at column 10, row 5.
#[track_caller]
fn assert_gray(body: &str, linear: bool, expected: f64) {
    let (.., picture) = render(&svg(body), linear);
    let [r, g, b, a] = picture.pixel(10, 5);
    let off = [r, g, b].map(|v| (f64::from(v) - expected).abs()).into_iter().fold(0.0, f64::max);
    assert!(off <= 0.75 && a == 255, "{:?} is not {expected:.1}", [r, g, b, a]);
}

/// The picture is within so many levels of the truth.
#[track_caller]
fn assert_true(body: &str, linear: bool, most: f64) {
    let svg = svg(body);
    let (tree, viewport, picture) = render(&svg, linear);
    assert!(reference::unsupported(&tree).is_empty(), "the truth draws all of it");
    let options = reference::Options { linear, ..Default::default() };
    let truth = reference::render(&tree, &viewport, &options).expect("a truth");
    let difference = truth.compare(&picture);
    let (x, y) = difference.worst;
    assert!(
        difference.max <= most,
        "{:.2} levels off in ({x}, {y}): {:?} is not {:.1?}; {svg}",
        difference.max,
        picture.pixel(x, y),
        truth.straight(x, y)
    );
}

/// Black that jumps from one opacity to another at 10.5 across a rectangle.
fn jump(id: &str, from: f64, to: f64) -> String {
    format!(
        "<linearGradient id='{id}' gradientUnits='userSpaceOnUse' x1='0' x2='21'>
         <stop offset='.5' stop-opacity='{from}'/><stop offset='.5' stop-opacity='{to}'/></linearGradient>"
    )
}

const PAPER: &str = "<rect width='24' height='24' fill='#fff'/>";

/// A white rectangle whose left border is at 10.5, before black.
const EDGE: &str = "<rect width='24' height='24'/><rect width='10.5' height='24' fill='#fff'/>";

const WHOLE: &str = "<rect width='24' height='24' fill='url(#g)'/>";

#[test]
fn a_jump_of_alpha_over_an_edge_at_the_same_place_is_one_edge() {
    // White at .8 on the left; black on the right.
    let gradient = jump("g", 0.2, 0.9);
    assert_gray(&format!("{gradient}{EDGE}{WHOLE}"), false, 0.5 * 0.8 * 255.0);
}

#[test]
fn jumps_of_alpha_at_the_same_place_are_one_edge() {
    let gradient = jump("g", 0.2, 0.9);
    let expected = 0.5 * (0.8 * 0.8 + 0.1 * 0.1) * 255.0;
    assert_gray(&format!("{gradient}{PAPER}{WHOLE}{WHOLE}"), false, expected);
    // In a part of a pixel just as well.
    let part = "<rect y='5.5' width='24' height='24' fill='url(#g)'/>";
    assert_gray(&format!("{gradient}{PAPER}{part}{part}"), false, 0.5 * (255.0 + expected));
    // Flat paint, in front of them and between them.
    let veil = "<rect width='24' height='24' fill-opacity='.5'/>";
    assert_gray(&format!("{gradient}{PAPER}{WHOLE}{veil}{WHOLE}{veil}"), false, 0.25 * expected);
}

#[test]
fn a_mask_that_jumps_where_what_it_masks_does_is_one_edge() {
    let gradients = jump("g", 0.2, 0.9) + &jump("m", 1.0, 0.25);
    let mask = "<mask id='k' maskUnits='userSpaceOnUse' x='0' y='0' width='24' height='24' mask-type='alpha'>
        <rect width='24' height='24' fill='url(#m)'/></mask>";
    let masked = format!("<g mask='url(#k)'>{WHOLE}</g>");
    let expected = 0.5 * (0.8 + (1.0 - 0.9 * 0.25)) * 255.0;
    assert_gray(&format!("{gradients}{mask}{PAPER}{masked}"), false, expected);
}

#[test]
fn opaque_jumps_that_are_blended_with_one_another_are_one_edge() {
    let stops = "<stop offset='.5' stop-color='#fff'/><stop offset='.5' stop-color='#000'/>";
    let gradient = format!(
        "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='0' x2='21'>{stops}</linearGradient>"
    );
    // The difference is nothing on either side.
    let blended = format!("<g style='mix-blend-mode:difference'>{WHOLE}</g>");
    assert_gray(&format!("{gradient}{WHOLE}{blended}"), false, 0.0);
}

#[test]
fn a_jump_in_linear_light_is_half_the_light() {
    let stops = "<stop offset='.5' stop-color='#fff'/><stop offset='.5' stop-color='#000'/>";
    let gradient = format!(
        "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='0' x2='21'>{stops}</linearGradient>"
    );
    let encoded = |light: f64| 255.0 * (1.055 * light.powf(1.0 / 2.4) - 0.055);
    let half = encoded(0.5);
    assert_gray(&format!("{gradient}{WHOLE}"), true, half);
    let part = "<rect y='5.5' width='24' height='24' fill='url(#g)'/>";
    assert_gray(&format!("{gradient}<rect width='24' height='24'/>{part}"), true, encoded(0.25));
    // Laid over one another colours are encoded: half of white is 127.5 there.
    let veil = "<rect width='24' height='24' fill-opacity='.5'/>";
    let quarter = ((0.5f64 + 0.055) / 1.055).powf(2.4);
    assert_gray(&format!("{gradient}{WHOLE}{veil}"), true, encoded(0.5 * quarter));
    assert_gray(&format!("{}{PAPER}{WHOLE}", jump("g", 0.5, 1.0)), true, encoded(0.5 * quarter));
}

/// Two gradients over an edge in every pixel through which the circles run.
fn rings(radius: f64, focus: f64) -> String {
    let gradient = |id: &str, cx: f64| {
        format!(
            "<radialGradient id='{id}' gradientUnits='userSpaceOnUse' cx='{cx}' cy='11.7' r='{radius}' fx='{}'>
             <stop offset='0' stop-opacity='.1'/><stop offset='.5' stop-opacity='.3'/>
             <stop offset='.5' stop-color='#f00' stop-opacity='.9'/><stop offset='1' stop-color='#00f' stop-opacity='.7'/>
             <stop offset='1' stop-color='#0f0' stop-opacity='.1'/></radialGradient>",
            cx + focus
        )
    };
    format!(
        "{}{}{PAPER}<path d='M0 9L24 15V24H0z' fill='#07a'/>{WHOLE}<rect width='24' height='24' fill='url(#h)'/>",
        gradient("g", 12.3),
        gradient("h", 12.6)
    )
}

#[test]
fn rings_that_jump_over_one_another_and_over_an_edge_are_true() {
    for (radius, focus) in [(10.0, 0.0), (8.0, 3.0), (3.0, 1.0), (1.3, 0.2)] {
        assert_true(&rings(radius, focus), false, 1.0);
    }
}

#[test]
fn the_border_beyond_which_a_gradient_has_no_colour_is_an_edge() {
    let gradient = |fx: f64, fy: f64, fr: f64| {
        format!(
            "<radialGradient id='g' gradientUnits='userSpaceOnUse' cx='4' cy='4' r='9' fx='{fx}' fy='{fy}' fr='{fr}'>
             <stop offset='0' stop-color='#fff'/><stop offset='1' stop-color='#000'/></radialGradient>"
        )
    };
    for (fx, fy, fr) in [(20.0, 18.0, 0.0), (18.3, 9.2, 0.0), (17.0, 15.0, 3.0), (13.0, 4.0, 0.0)] {
        assert_true(&format!("{}{WHOLE}", gradient(fx, fy, fr)), false, 1.0);
        let over = format!("{}{PAPER}<path d='M0 9L24 15V24H0z' fill='#07a'/>{WHOLE}", gradient(fx, fy, fr));
        assert_true(&over, false, 1.0);
        assert_true(&over, true, 1.5);
    }
}

#[test]
fn steep_gradients_over_an_edge_and_over_one_another_are_true_in_either_light() {
    let gradient = |id: &str, from: f64, to: f64| {
        format!(
            "<linearGradient id='{id}' gradientUnits='userSpaceOnUse' x1='{from}' x2='{to}' y2='4'>
             <stop offset='0' stop-color='#fc0' stop-opacity='.1'/><stop offset='1' stop-color='#40c'/></linearGradient>"
        )
    };
    let body = format!(
        "{}{}{PAPER}<path d='M6 0L18 24H0V0z' fill='#07a'/>{WHOLE}<rect width='24' height='24' fill='url(#h)'/>",
        gradient("g", 8.0, 11.0),
        gradient("h", 9.0, 9.5)
    );
    assert_true(&body, false, 1.0);
    assert_true(&body, true, 1.5);
}

/// As circles of one size that run along a diagonal and jump, beside the line that all of them touch.
#[test]
fn jumps_beside_a_border_are_edges() {
    let stops = "<stop offset='.5' stop-color='#000'/><stop offset='.5' stop-color='#fff'/>";
    // Radius, step along x and y, and where the first circle is.
    let strips = [
        (5000.0, -150.0, (-3540.0, 3531.209)),
        (5000.0, -150.0, (-3540.0, 3530.209)),
        (5000.0, -150.0, (-3540.0, 3530.7)),
        (400.0, -37.0, (-312.0, 254.19)),
        (400.0, -37.0, (-438.0, 125.54)),
    ];
    for (r, step, (x, y)) in strips {
        let (cx, cy) = (x + step, y + step);
        let strip = format!(
            "<radialGradient id='s' gradientUnits='userSpaceOnUse' cx='{cx}' cy='{cy}' r='{r}' fx='{x}' fy='{y}'
             fr='{r}' spreadMethod='repeat'>{stops}</radialGradient>
             <rect width='24' height='24' fill='url(#s)'/>"
        );
        assert_true(&strip, false, 0.7);
    }
}

/// What is opaque of a gradient hides what lies behind, and what has faded of it, or has no colour, does not.
#[test]
fn gradients_that_are_opaque_in_part_hide_and_show_what_lies_behind() {
    let fading =
        "<stop offset='.4' stop-color='#a30'/><stop offset='.7' stop-color='#0a3' stop-opacity='0'/>";
    let cone = "<stop offset='.4' stop-color='#a30'/><stop offset='.7' stop-color='#0a3'/>";
    let behind = "<path d='M2 2 22 9 6 22z' fill='#024'/><circle cx='15' cy='14' r='6' fill='#fc0'/>";
    for (circle, stops) in [("r='14' fx='9'", fading), ("r='5' fx='19'", cone), ("r='5' fx='19'", fading)] {
        let gradient = format!(
            "<radialGradient id='p' gradientUnits='userSpaceOnUse' cx='10' cy='11' {circle} fy='11'>{stops}</radialGradient>"
        );
        assert_true(
            &format!("{gradient}{PAPER}{behind}<rect width='24' height='24' fill='url(#p)'/>"),
            false,
            1.0,
        );
        assert_true(
            &format!("{gradient}{behind}<path d='M0 0H24L3 24z' fill='url(#p)'/>{behind}"),
            false,
            1.0,
        );
    }
}
