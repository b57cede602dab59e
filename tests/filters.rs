//! Filters and layers by the hundred: small drawings whose pixels are known, and what is warned of.

use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

fn scene(width: u32, height: u32, body: &str) -> Scene {
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='{width}' height='{height}'>{body}</svg>"
    );
    Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing")
}

fn render(width: u32, height: u32, body: &str) -> Pixmap {
    let scene = scene(width, height, body);
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let mut renderer = Renderer::new(Settings::default()).expect("a renderer");
    renderer.render(&scene, &Viewport::fit(&scene, width, height)).expect("a picture")
}

#[test]
fn an_image_of_a_filter_that_cannot_be_read_is_warned_of_by_the_filter_s_name() {
    let broken = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJ";
    for href in ["no-such.png", broken, "#nobody"] {
        let body = format!(
            "<filter id='f'><feImage xlink:href='{href}'/></filter>
            <rect width='9' height='9' filter='url(#f)'/><rect x='9' width='9' height='9' filter='url(#f)'/>"
        );
        let scene = scene(20, 20, &body);
        let [warning] = scene.warnings() else { panic!("{href}: {:?}", scene.warnings()) };
        assert_eq!(warning.kind, "images", "{href}");
        assert_eq!(warning.element, "the feImage of filter 'f'", "{href}");
        let mut renderer = Renderer::new(Settings::default()).expect("a renderer");
        let picture = renderer.render(&scene, &Viewport::fit(&scene, 20, 20)).expect("a picture");
        assert_eq!(picture.pixel(4, 4), [0; 4], "{href}");
    }
}

#[test]
fn an_image_of_a_filter_that_can_be_read_is_drawn_and_not_warned_of() {
    let body = "<rect id='r' width='20' height='20' fill='#0f0'/>
        <filter id='f' filterUnits='userSpaceOnUse' width='20' height='20'><feImage xlink:href='#r'/></filter>
        <rect x='3' y='3' width='2' height='2' filter='url(#f)'/>";
    assert_eq!(render(20, 20, body).pixel(15, 15), [0, 255, 0, 255]);
}

/// A filter over all of a picture of 64 pixels.
fn filtered(primitives: &str, content: &str) -> String {
    format!(
        "<filter id='f' filterUnits='userSpaceOnUse' x='0' y='0' width='64' height='64' color-interpolation-filters='sRGB'>
        {primitives}</filter><g filter='url(#f)'>{content}</g>"
    )
}

const SHAPES: &str = "<rect width='40' height='40' fill='#0af'/><circle cx='30' cy='34' r='13' fill='#c20'/>
    <path d='M2 60L60 2V60z' fill='#2a4' opacity='.7'/>";

#[test]
fn a_tile_of_what_other_primitives_made_repeats_what_they_made_there() {
    for made in [
        "<feOffset dx='3' dy='-2' x='20' y='22' width='12' height='9'/>",
        "<feGaussianBlur stdDeviation='2'/><feColorMatrix type='saturate' values='.4' x='20' y='22' width='12' height='9'/>",
        "<feGaussianBlur in='SourceAlpha' stdDeviation='1.5' x='20' y='22' width='12' height='9'/>",
        "<feMorphology radius='2' result='thin'/><feBlend in='SourceGraphic' in2='thin' mode='multiply' x='20' y='22' width='12' height='9'/>",
        "<feTurbulence baseFrequency='.1' x='20' y='22' width='12' height='9'/>",
    ] {
        let once = render(64, 64, &filtered(made, SHAPES));
        let tiled = render(64, 64, &filtered(&format!("{made}<feTile/>"), SHAPES));
        for (x, y) in (0..64 * 64).map(|i| (i % 64, i / 64)) {
            // 36 and 27 are multiples of the tile's sides that leave nothing negative.
            let from = (20 + (x + 36 - 20) % 12, 22 + (y + 27 - 22) % 9);
            assert_eq!(tiled.pixel(x, y), once.pixel(from.0, from.1), "{made} at {x}, {y}");
        }
    }
}

#[test]
fn an_offset_shows_nothing_outside_the_place_that_it_names() {
    let body =
        filtered("<feOffset dx='2' x='20' y='22' width='12' height='9'/>", "<rect width='64' height='64'/>");
    let picture = render(64, 64, &body);
    for (x, y) in (0..64 * 64).map(|i| (i % 64, i / 64)) {
        let inside = (20..32).contains(&x) && (22..31).contains(&y);
        assert_eq!(picture.pixel(x, y)[3], if inside { 255 } else { 0 }, "{x}, {y}");
    }
}

#[test]
fn what_is_filtered_blends_with_nothing_that_the_filter_makes() {
    let content = "<rect width='40' height='40' fill='#fc0' style='mix-blend-mode:multiply'/>";
    for primitives in [
        "<feDropShadow dx='8' dy='8' stdDeviation='4'/>",
        "<feFlood flood-color='#048'/><feMerge><feMergeNode/><feMergeNode in='SourceGraphic'/></feMerge>",
        "<feMerge><feMergeNode in='SourceGraphic'/><feMergeNode in='SourceGraphic'/></feMerge>",
    ] {
        let picture = render(64, 64, &filtered(primitives, content));
        assert_eq!(picture.pixel(20, 20), [255, 204, 0, 255], "{primitives}");
    }
}

#[test]
fn a_result_that_is_looked_at_again_is_what_it_was() {
    // Blurred, moved, tiled or lit in its place, it would not be.
    for other in [
        "<feGaussianBlur stdDeviation='3'/>",
        "<feOffset dx='9' dy='5'/>",
        "<feTile/>",
        "<feDiffuseLighting><feDistantLight azimuth='20' elevation='40'/></feDiffuseLighting>",
        "<feDisplacementMap in2='SourceGraphic' scale='9' xChannelSelector='R'/>",
        "<feMerge><feMergeNode/><feMergeNode in='SourceAlpha'/></feMerge>",
        "<feDropShadow dx='3' stdDeviation='2'/>",
        "<feConvolveMatrix order='3' kernelMatrix='1 1 1 1 1 1 1 1 1' preserveAlpha='true'/>",
    ] {
        let kept =
            "<feComponentTransfer result='kept'><feFuncR type='linear' slope='.5'/></feComponentTransfer>";
        let plain = render(64, 64, &filtered(kept, SHAPES));
        let last = "<feComposite in='kept' in2='other' operator='arithmetic' k2='1'/>";
        let (name, rest) = other.split_at(other.find([' ', '/', '>']).expect("an element"));
        let body = format!("{kept}{name} result='other'{rest}{last}");
        assert_eq!(render(64, 64, &filtered(&body, SHAPES)), plain, "{other}");
    }
}

#[test]
fn more_layers_than_are_held_at_once_are_drawn_like_few() {
    // 40 million pixels of layers, and 2^25 are held at once.
    let side = 1000;
    let patterned = |count: usize| {
        let pattern = "<pattern id='p' patternUnits='userSpaceOnUse' width='37.3' height='41.7' patternTransform='rotate(7)'>
            <path d='M2 2L35 9L12 38z' fill='#06c' fill-opacity='.02'/></pattern>";
        pattern.to_string() + &format!("<rect width='{side}' height='{side}' fill='url(#p)'/>").repeat(count)
    };
    let (few, many) = (render(side, side, &patterned(20)), render(side, side, &patterned(40)));
    let mut painted = 0;
    for (few, many) in few.data().chunks_exact(4).zip(many.data().chunks_exact(4)) {
        // Twice as many let the square of the light through.
        let through = 1.0 - f64::from(few[3]) / 255.0;
        let expected = 255.0 * (1.0 - through * through);
        assert!((f64::from(many[3]) - expected).abs() < 1.7, "{} after {}", many[3], few[3]);
        painted += usize::from(many[3] > 100);
    }
    assert!(painted > 100_000, "{painted}");
}
