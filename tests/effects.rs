//! Filters, masks, blend modes, patterns, images and colour maps: small drawings whose pixels are known.

use toon_raster::{Error, Highlights, Method, Options, Pixmap, Renderer, Scene, Settings, Viewport};

fn render_with(width: u32, height: u32, body: &str, settings: Settings) -> Pixmap {
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='{width}' height='{height}'>{body}</svg>"
    );
    let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let mut renderer = Renderer::new(settings).expect("a renderer");
    renderer.render(&scene, &Viewport::fit(&scene, width, height)).expect("a picture")
}

fn scene_of(width: u32, height: u32, body: &str) -> Scene {
    let svg =
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}'>{body}</svg>");
    Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing")
}

fn render(width: u32, height: u32, body: &str) -> Pixmap {
    render_with(width, height, body, Settings::default())
}

#[track_caller]
fn assert_pixel(picture: &Pixmap, (x, y): (u32, u32), expected: [u8; 4]) {
    let found = picture.pixel(x, y);
    let near = found.iter().zip(expected).all(|(&a, b)| a.abs_diff(b) <= 1);
    assert!(near, "pixel ({x}, {y}) is {found:?}, not {expected:?}");
}

#[test]
fn a_blur_spreads_light_and_keeps_all_of_it() {
    let body = "<filter id='f' x='-2' y='-2' width='5' height='5' color-interpolation-filters='sRGB'>
        <feGaussianBlur stdDeviation='3'/></filter>
        <rect x='24' y='24' width='16' height='16' filter='url(#f)'/>";
    let picture = render(64, 64, body);
    let alpha = |x, y| f64::from(picture.pixel(x, y)[3]);
    let sum: f64 = (0..64 * 64).map(|i| alpha(i % 64, i / 64)).sum();
    assert!((sum / 255.0 - 256.0).abs() < 3.0, "{}", sum / 255.0);
    assert!((alpha(24, 32) + alpha(23, 32) - 255.0).abs() < 6.0, "an edge is half way in its middle");
    assert_eq!(picture.pixel(5, 5), [0; 4]);
}

#[test]
fn a_mask_lets_through_by_luminance_or_by_alpha() {
    let masked = |kind: &str, paint: &str| {
        let body = format!(
            "<mask id='m' mask-type='{kind}'><rect width='4' height='8' {paint}/></mask>
            <rect width='8' height='8' fill='#f00' mask='url(#m)'/>"
        );
        render(8, 8, &body)
    };
    let white = masked("luminance", "fill='#fff'");
    assert_pixel(&white, (1, 1), [255, 0, 0, 255]);
    assert_pixel(&white, (6, 1), [0; 4]);
    assert_pixel(&masked("luminance", "fill='#000'"), (1, 1), [0; 4]);
    assert_pixel(&masked("luminance", "fill='#808080'"), (1, 1), [255, 0, 0, 128]);
    assert_pixel(&masked("alpha", "fill='#000' opacity='.5'"), (1, 1), [255, 0, 0, 128]);
}

#[test]
fn a_blend_mode_mixes_with_what_lies_below_in_its_own_group_only() {
    let multiply = "style='mix-blend-mode:multiply'";
    let open = render(
        4,
        4,
        &format!(
            "<rect width='4' height='4' fill='#ff0'/><rect width='2' height='4' fill='#0ff' {multiply}/>"
        ),
    );
    assert_pixel(&open, (0, 0), [0, 255, 0, 255]);
    assert_pixel(&open, (3, 0), [255, 255, 0, 255]);
    // Isolated, it has nothing below.
    let isolated = render(
        4,
        4,
        &format!("<rect width='4' height='4' fill='#ff0'/><g style='isolation:isolate'><rect width='2' height='4' fill='#0ff' {multiply}/></g>"),
    );
    assert_pixel(&isolated, (0, 0), [0, 255, 255, 255]);
    // Two in a row, and half transparent: multiply of .5 white over red is red still.
    let twice = render(
        4,
        4,
        &format!("<rect width='4' height='4' fill='#f00'/><rect width='4' height='4' fill='#fff' opacity='.5' {multiply}/><rect width='4' height='4' fill='#888' {multiply}/>"),
    );
    assert_pixel(&twice, (1, 1), [0x88, 0, 0, 255]);
}

#[test]
fn plus_lighter_adds_up_colours_and_alphas_on_paper_and_on_clear_pages() {
    let half = "<path d='M0 0h8v8h-8z' fill='#0f0' fill-opacity='.5' style='mix-blend-mode:plus-lighter'/>";
    let behind = |fill: &str| render(8, 8, &format!("<path d='M0 0h4.5v8h-4.5z' {fill}/>{half}"));
    let clear = behind("fill='#f00' fill-opacity='.5'");
    assert_pixel(&clear, (1, 1), [128, 128, 0, 255]);
    assert_pixel(&clear, (6, 1), [0, 255, 0, 128]);
    // Half of it opaque, half half so: of all light a third is red.
    assert_pixel(&clear, (4, 1), [85, 170, 0, 191]);
    let paper = behind("fill='#fff'");
    assert_pixel(&paper, (1, 1), [255, 255, 255, 255]);
    assert_pixel(&behind("fill='#804000'"), (1, 1), [128, 192, 0, 255]);
}

#[test]
fn a_background_is_what_blend_modes_meet_too() {
    let settings = Settings { background: Some([255, 255, 0, 255]), ..Settings::default() };
    let body = "<rect width='4' height='4' fill='#0ff' style='mix-blend-mode:multiply'/>";
    assert_pixel(&render_with(4, 4, body, settings), (1, 1), [0, 255, 0, 255]);
}

#[test]
fn a_pattern_repeats_its_tile_exactly_and_without_seams() {
    // Tiles of 2.5 pixels, one half red: their borders run through pixels, and every other column of
    // borders has red on one side only.
    let body = "<pattern id='p' width='2.5' height='2.5' patternUnits='userSpaceOnUse'>
        <rect width='2.5' height='2.5' fill='#00f'/><rect width='1.25' height='2.5' fill='#f00'/></pattern>
        <rect width='20' height='20' fill='url(#p)'/>";
    let picture = render(20, 20, body);
    for x in 0..20 {
        // Red covers [2.5 k, 2.5 k + 1.25).
        let red: f64 = (0..8)
            .map(|k| 2.5 * f64::from(k))
            .map(|start| ((start + 1.25).min(f64::from(x) + 1.0) - start.max(f64::from(x))).max(0.0))
            .sum();
        let level = (255.0 * red).round() as u8;
        for y in [0, 7, 19] {
            assert_pixel(&picture, (x, y), [level, 0, 255 - level, 255]);
        }
    }
}

#[test]
fn tiles_by_the_million_are_their_mean() {
    let body = "<pattern id='p' width='.01' height='.01' patternUnits='userSpaceOnUse'>
        <rect width='.005' height='.01' fill='#f00'/></pattern><rect width='64' height='64' fill='url(#p)'/>";
    assert_pixel(&render(64, 64, body), (30, 30), [255, 0, 0, 128]);
}

#[test]
fn a_tile_that_repeats_in_whole_pixels_counts_as_the_layer_it_is() {
    // As large as the picture: 1,105 million pixels, and 2^30 are the most.
    let (width, height) = (65_000, 17_000);
    // With fewer shapes it would need no layer.
    let shapes = "<path d='M1 1h9v9z'/>".repeat(300);
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}'>
        <pattern id='p' width='{width}' height='{height}' patternUnits='userSpaceOnUse'>{shapes}</pattern>
        <rect width='{width}' height='{height}' fill='url(#p)'/></svg>"
    );
    let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
    let mut renderer = Renderer::new(Settings::default()).expect("good settings");
    let done = renderer.render_bands(&scene, &Viewport::fit(&scene, width, height), |_| Ok(()));
    assert!(matches!(&done, Err(Error::Limit(why)) if why.contains("would take more")), "{done:?}");
}

#[test]
fn an_image_is_decoded_scaled_and_framed() {
    // Two pixels: red, blue.
    let image = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/4iOeWQAAAABJRU5ErkJggg==";
    let drawn = |style: &str| {
        render(
            8,
            4,
            &format!("<image width='8' height='4' preserveAspectRatio='none' {style} xlink:href='{image}'/>"),
        )
    };
    let squares = drawn("image-rendering='optimizeSpeed'");
    assert_pixel(&squares, (3, 1), [255, 0, 0, 255]);
    assert_pixel(&squares, (4, 1), [0, 0, 255, 255]);
    let smooth = drawn("");
    assert_pixel(&smooth, (0, 1), [255, 0, 0, 255]);
    let [r, _, b, a] = smooth.pixel(3, 1);
    assert!(r > 128 && b > 60 && b < 128 && a == 255, "{:?}", smooth.pixel(3, 1));
}

#[test]
fn a_hard_stop_is_a_smooth_edge_and_fine_repeats_are_their_mean() {
    let gradient = |attributes: &str| {
        format!(
            "<linearGradient id='g' gradientUnits='userSpaceOnUse' {attributes}>
            <stop offset='.5' stop-color='#000'/><stop offset='.5' stop-color='#fff'/></linearGradient>
            <rect width='16' height='4' fill='url(#g)'/>"
        )
    };
    let hard = render(16, 4, &gradient("x1='0' x2='16.5'"));
    assert_pixel(&hard, (7, 1), [0, 0, 0, 255]);
    assert_pixel(&hard, (8, 1), [191, 191, 191, 255]);
    assert_pixel(&hard, (9, 1), [255, 255, 255, 255]);
    let fine = render(16, 4, &gradient("x1='0' x2='.001' spreadMethod='repeat'"));
    (0..16).for_each(|x| assert_pixel(&fine, (x, 2), [128, 128, 128, 255]));
}

#[test]
fn a_sharp_highlight_on_a_small_bump_is_clamped_and_told_of_only_where_asked() {
    let body = "<filter id='f' primitiveUnits='userSpaceOnUse' x='0' y='0' width='16' height='16'>
        <feSpecularLighting surfaceScale='6' specularExponent='128' lighting-color='#fff'>
        <feDistantLight azimuth='90' elevation='60'/></feSpecularLighting></filter>
        <circle cx='8' cy='8' r='4' filter='url(#f)'/>";
    let lit = |highlights| render_with(16, 16, body, Settings { highlights, ..Settings::default() });
    let as_is = lit(Highlights::AsIs);
    assert_eq!(as_is, render(16, 16, body));
    assert!(as_is.data().iter().any(|&level| level > 0), "something shines");
    for highlights in [Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
        assert_ne!(lit(highlights), as_is, "{highlights:?}");
    }
    let lit = |stage_times| {
        let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='16' height='16'>{body}</svg>");
        let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
        let mut renderer =
            Renderer::new(Settings { stage_times, ..Settings::default() }).expect("a renderer");
        renderer.render(&scene, &Viewport::fit(&scene, 16, 16)).expect("a picture");
        renderer.stages().lit.clone()
    };
    assert_eq!(lit(false), []);
    let [only] = &lit(true)[..] else { panic!("one light") };
    assert_eq!((&only.filter[..], only.exponent, only.pixels), ("f", 128.0, 196));
    assert!(only.aliasing > 0 && only.sampling_rate > 1.0, "{only:?}");
}

#[test]
fn a_highlight_that_does_not_alias_has_the_same_bytes_however_it_is_treated() {
    // A dome some hundred pixels wide, and an exponent that suits it.
    let body = "<filter id='f' primitiveUnits='userSpaceOnUse' x='0' y='0' width='96' height='96'>
        <feGaussianBlur stdDeviation='12'/>
        <feSpecularLighting surfaceScale='30' specularExponent='12' lighting-color='#fff'>
        <feDistantLight azimuth='225' elevation='60'/></feSpecularLighting></filter>
        <g filter='url(#f)'><circle cx='48' cy='48' r='40'/></g>";
    let lit = |highlights| {
        let settings = Settings { highlights, stage_times: true, ..Settings::default() };
        render_with(96, 96, body, settings)
    };
    let as_is = lit(Highlights::AsIs);
    assert!(as_is.data().iter().any(|&level| level > 100), "something shines");
    for highlights in [Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
        assert_eq!(lit(highlights), as_is, "{highlights:?}");
    }
}

/// How much the light of one element of the sample of cylinders and cones changes while it moves by a
/// pixel: standard deviation in shares of the mean.
fn flicker(id: &str, highlights: Highlights) -> f64 {
    const STEPS: usize = 8;
    let svg =
        std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/highlights.svg")).expect("a sample");
    let tree = toon_raster::scene::load::tree_from_bytes(&svg, &Options::default()).expect("a drawing");
    let scene = Scene::from_element(&tree, id).expect("an element");
    let mut renderer = Renderer::new(Settings { highlights, ..Settings::default() }).expect("a renderer");
    let light = |step: usize| -> f64 {
        let transform = toon_raster::kurbo::Affine::translate((step as f64 / STEPS as f64, 0.0));
        let viewport = Viewport { width: 320, height: 136, transform };
        let picture = renderer.render(&scene, &viewport).expect("a picture");
        picture.data().chunks_exact(4).map(|pixel| f64::from(pixel[3])).sum()
    };
    let sums: Vec<f64> = (0..STEPS).map(light).collect();
    let mean = sums.iter().sum::<f64>() / STEPS as f64;
    (sums.iter().map(|sum| (sum - mean) * (sum - mean)).sum::<f64>() / STEPS as f64).sqrt() / mean
}

#[test]
fn thin_cylinders_and_small_cones_flicker_less_where_their_highlights_are_clamped() {
    for id in ["thin", "small"] {
        let as_is = flicker(id, Highlights::AsIs);
        for highlights in [Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
            let treated = flicker(id, highlights);
            println!("{id}: {highlights:?} {as_is:.5} -> {treated:.5}");
            assert!(treated < as_is, "{id}, {highlights:?}: {treated} was {as_is}");
        }
    }
}

#[test]
fn layers_are_the_same_for_every_thread_count_and_band_by_band() {
    let svg = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/effects.svg")).expect("a sample");
    let scene = Scene::from_bytes(&svg, &Options::default()).expect("a drawing");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let viewport = Viewport::fit(&scene, 300, 200);
    let picture = |threads| {
        let mut renderer = Renderer::new(Settings { threads, ..Settings::default() }).expect("a renderer");
        let whole = renderer.render(&scene, &viewport).expect("a picture");
        let mut rows = Vec::new();
        let sink = |some: &[u8]| {
            rows.extend_from_slice(some);
            Ok(())
        };
        renderer.render_bands(&scene, &viewport, sink).expect("a picture");
        assert_eq!(whole.data(), rows);
        whole
    };
    assert_eq!(picture(1), picture(2));
    assert_eq!(picture(1), picture(3));
}

#[test]
fn methods_that_cannot_draw_layers_say_so() {
    let svg = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/effects.svg")).expect("a sample");
    let scene = Scene::from_bytes(&svg, &Options::default()).expect("a drawing");
    let viewport = Viewport::fit(&scene, 60, 40);
    for &method in Method::ALL {
        let mut renderer =
            Renderer::new(Settings { threads: 1, ..Settings::of(method) }).expect("a renderer");
        let made = renderer.render(&scene, &viewport);
        let refuses = matches!(method, Method::Beam | Method::TinySkia);
        assert_eq!(made.is_err(), refuses, "{method}: {:?}", made.err());
    }
}

#[test]
fn absurd_effects_end_in_bounded_time() {
    for body in [
        "<filter id='f'><feGaussianBlur stdDeviation='1e9'/></filter><rect width='9' height='9' filter='url(#f)'/>",
        "<filter id='f' x='-1e6' y='-1e6' width='2e6' height='2e6'><feFlood/></filter><rect width='9' height='9' filter='url(#f)'/>",
        "<pattern id='p' width='1e-6' height='1e6' patternUnits='userSpaceOnUse'><rect width='1' height='1'/></pattern><rect width='64' height='64' fill='url(#p)'/>",
        "<mask id='m' x='-1e30' width='2e30'><rect width='1e30' height='9'/></mask><rect width='9' height='9' mask='url(#m)'/>",
    ] {
        render(64, 64, body);
    }
}

#[test]
fn a_hundred_blended_groups_each_blend_with_all_that_lies_behind() {
    let page = "<rect width='8' height='8' fill='#fafafa' style='mix-blend-mode:multiply'/>";
    let half = page.replace("width='8'", "width='4.5'");
    let body = format!(
        "<rect width='8' height='8' fill='#fff'/>{}{}<rect y='6' width='8' height='2' fill='#00f'/>",
        page.repeat(60),
        half.repeat(40)
    );
    let picture = render(8, 8, &body);
    let gray = |count: i32| 255.0 * (250.0f64 / 255.0).powi(count);
    let pixel = |v: f64| [v.round() as u8, v.round() as u8, v.round() as u8, 255];
    assert_pixel(&picture, (1, 1), pixel(gray(100)));
    assert_pixel(&picture, (6, 1), pixel(gray(60)));
    assert_pixel(&picture, (4, 1), pixel((gray(100) + gray(60)) / 2.0));
    assert_pixel(&picture, (1, 7), [0, 0, 255, 255]);
}

#[test]
fn what_is_painted_before_a_blended_group_is_no_backdrop_and_what_is_behind_is() {
    let body =
        "<rect width='8' height='8' fill='#f80'/><g opacity='.5'><rect width='8' height='8' fill='#08f'/>
        <rect width='4' height='8' fill='#fff' style='mix-blend-mode:difference'/>
        <rect width='8' height='4' fill='#fff' fill-opacity='.5'/></g>";
    let picture = render(8, 8, body);
    // In the group: #08f, where the blended one lies #ff7700, white before both; then half of it.
    assert_pixel(&picture, (1, 6), [255, 128, 0, 255]);
    assert_pixel(&picture, (6, 6), [128, 136, 128, 255]);
    assert_pixel(&picture, (1, 1), [255, 162, 64, 255]);
    assert_pixel(&picture, (6, 1), [191, 166, 128, 255]);
}

#[test]
fn what_is_nested_too_deep_is_named_by_the_id_around_it() {
    let nested = |count: usize, inner: &str| {
        let group = "<g style='mix-blend-mode:multiply'><rect width='9' height='9'/>";
        let (open, close) = (group.repeat(count), "</g>".repeat(count));
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><rect width='9' height='9'/>
            <g id='outer' opacity='.5'>{open}<g id='inner' style='mix-blend-mode:multiply'><path d='M0 0h9v9z'/>{inner}</g>{close}</g></svg>"
        );
        Scene::from_bytes(svg.as_bytes(), &Options::default())
    };
    let deepest = "<g style='mix-blend-mode:multiply'><path d='M0 0h9v9z'/><path d='M0 0h9v4z'/></g>";
    assert!(nested(253, deepest).is_ok());
    let error = nested(254, deepest).expect_err("the groups around them count too: 257").to_string();
    assert!(error.contains("256 deep at"), "{error}");
    assert!(error.contains("within element 'inner', behind 256 drawn shapes"), "{error}");
}

#[test]
fn blended_groups_are_drawn_as_deep_as_they_are_let_in() {
    // All but the innermost are white in the left half, and change nothing there.
    let nested = |depth: usize| {
        let open = "<g style='mix-blend-mode:multiply'><path d='M0 0h8v8h-8z' fill='#fff'/>".repeat(depth);
        format!(
            "<path d='M0 0h16v8h-16z' fill='#fb0'/>{open}<path d='M0 0h4.5v8h-4.5z' fill='#088'/>{}",
            "</g>".repeat(depth)
        )
    };
    let (deepest, shallow) = (render(16, 8, &nested(256)), render(16, 8, &nested(1)));
    assert_eq!(deepest, shallow);
    assert_pixel(&deepest, (1, 1), [0, 100, 0, 255]);
    assert_pixel(&deepest, (4, 4), [128, 143, 0, 255]);
    assert_pixel(&deepest, (12, 4), [255, 187, 0, 255]);
    let refused = Renderer::new(Settings { threads: 1, ..Settings::of(Method::Area) })
        .expect("a renderer")
        .render(&scene_of(16, 8, &nested(256)), &Viewport::fit(&scene_of(16, 8, &nested(1)), 16, 8));
    assert!(refused.is_err_and(|e| e.to_string().contains("no more than 32 deep")));
}

#[test]
fn masks_are_drawn_as_deep_as_they_are_let_in() {
    let mask = "<mask id='m' maskUnits='userSpaceOnUse' width='4.5' height='8'><path d='M0 0h8v8h-8z' fill='#fff'/></mask>";
    let nested = |depth: usize| {
        let open = "<g mask='url(#m)'><path d='M0 0h8v8h-8z'/>".repeat(depth);
        format!("{mask}{open}<path d='M0 0h8v8h-8z' fill='#f00'/>{}", "</g>".repeat(depth))
    };
    assert_eq!(render(8, 8, &nested(128)), render(8, 8, &nested(1)));
    let too_deep =
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='8' height='8'>{}</svg>", nested(129));
    assert!(Scene::from_bytes(too_deep.as_bytes(), &Options::default()).is_err());
}

#[test]
fn many_large_blended_groups_are_each_region_s_own_blend() {
    // Three edges through one pixel: each of its regions has its own colour.
    let half = |at: f64, color: &str| {
        format!("<path d='M0 0h{at}v8h-{at}z' fill='{color}' style='mix-blend-mode:multiply'/>")
    };
    let page = |color: &str| half(8.0, color);
    for (background, paper) in [("#fff", 255.0), ("#ccc", 204.0)] {
        let body = format!(
            "<path d='M0 0h8v8h-8z' fill='{background}'/>{}{}{}{}{}{}",
            half(4.25, "#f00"),
            page("#cfc"),
            half(4.5, "#ff0"),
            page("#ccf"),
            half(4.75, "#0ff"),
            page("#fcc")
        );
        let picture = render(8, 8, &body);
        let all = [204.0, 204.0, 204.0].map(|v: f64| v / 255.0 * v / 255.0 * paper);
        let of = |shares: [f64; 3]| {
            let [r, g, b] = std::array::from_fn(|i| (all[i] * shares[i]).round() as u8);
            [r, g, b, 255]
        };
        assert_pixel(&picture, (1, 1), of([0.0, 0.0, 0.0]));
        assert_pixel(&picture, (4, 4), of([0.25, 0.75, 0.5]));
        assert_pixel(&picture, (6, 4), of([1.0, 1.0, 1.0]));
    }
}
