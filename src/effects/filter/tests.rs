//! Filters against resvg's own pictures: the source layer is resvg's picture of the same drawing
//! without the filter, so that only the filter differs.

use super::region::{regions, Canvas};
use super::*;
use usvg::{Options, Tree};

const SIZE: u32 = 48;

/// A picture of the drawing by resvg, in straight bytes.
fn by_resvg(svg: &str) -> Vec<u8> {
    let tree = Tree::from_str(svg, &Options::default()).unwrap();
    let mut pixmap = tiny_skia::Pixmap::new(SIZE, SIZE).unwrap();
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
    let straight = |p: &tiny_skia::PremultipliedColorU8| {
        let p = p.demultiply();
        [p.red(), p.green(), p.blue(), p.alpha()]
    };
    pixmap.pixels().iter().flat_map(straight).collect()
}

/// A drawing of `content` with `filter`'s primitives, in a filter over the whole picture, or without.
fn drawing(attributes: &str, primitives: &str, content: &str, filtered: bool) -> String {
    let use_of = if filtered { "filter='url(#f)'" } else { "" };
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{SIZE}' height='{SIZE}'>
         <filter id='f' filterUnits='userSpaceOnUse' x='0' y='0' width='{SIZE}' height='{SIZE}' {attributes}>
         {primitives}</filter><g {use_of}>{content}</g></svg>"
    )
}

/// Overlapping shapes, opaque and not, away from the borders.
const SHAPES: &str = "<path d='M8 8H30V26H8z' fill='#c84a20'/>
    <circle cx='28' cy='28' r='11' fill='#2060d0' fill-opacity='.6'/>
    <path d='M20 36L40 14L43 40z' fill='#3a3' fill-opacity='.9'/>";

fn first_filtered(group: &usvg::Group) -> Option<&usvg::Group> {
    if !group.filters().is_empty() {
        return Some(group);
    }
    group.children().iter().find_map(|node| match node {
        usvg::Node::Group(group) => first_filtered(group),
        _ => None,
    })
}

/// What feImage refers to, by resvg.
fn draw_by_resvg(group: &usvg::Group, transform: Affine, rect: IntRect) -> Result<Layer, Error> {
    let mut pixmap = tiny_skia::Pixmap::new(rect.width() as u32, rect.height() as u32).unwrap();
    let [a, b, c, d, e, f] = transform.as_coeffs().map(|v| v as f32);
    let moved = (e - rect.x() as f32, f - rect.y() as f32);
    let transform = tiny_skia::Transform::from_row(a, b, c, d, moved.0, moved.1);
    for child in group.children() {
        // A node is drawn from its own bounding box's corner: put it back.
        let Some(bounds) = child.abs_layer_bounding_box() else { continue };
        let transform = transform.pre_translate(bounds.x(), bounds.y());
        resvg::render_node(child, transform, &mut pixmap.as_mut());
    }
    let bytes: Vec<u8> = pixmap
        .pixels()
        .iter()
        .map(|p| p.demultiply())
        .flat_map(|p| [p.red(), p.green(), p.blue(), p.alpha()])
        .collect();
    Ok(Layer::from_rgba8(rect, &bytes))
}

/// The filters of the drawing's first filtered group run on a source.
fn filtered_by_us(svg: &str, source: Layer, highlights: Highlights) -> Result<Layer, Error> {
    let tree = Tree::from_str(svg, &Options::default()).unwrap();
    let group = first_filtered(tree.root()).expect("a filter");
    let picture = source.rect();
    let t = group.abs_transform();
    let transform = Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from));
    let canvas = Canvas::new(transform).unwrap();
    let regions = regions(group.filters(), canvas.to_canvas, canvas.rect_of(picture), picture);
    let log = Log::default();
    let mut job = Job {
        to_canvas: canvas.to_canvas,
        highlights,
        without_front: false,
        index_aa: false,
        log: &log,
        draw: &mut draw_by_resvg,
    };
    let layer = apply(group.filters(), &regions, source, &mut job)?;
    Ok(canvas.shown(layer, picture).over_rect(picture))
}

/// The largest and mean difference of premultiplied components, in 8-bit levels.
fn difference(ours: &Layer, theirs: &[u8]) -> (f32, f32) {
    let theirs = Layer::from_rgba8(ours.rect(), theirs);
    let each = ours.pixels().iter().flatten().zip(theirs.pixels().iter().flatten());
    let off: Vec<f32> = each.map(|(a, b)| (a - b).abs() * 255.0).collect();
    (off.iter().fold(0.0, |most, &v| most.max(v)), off.iter().sum::<f32>() / off.len() as f32)
}

/// Ours and resvg's pictures of the shapes under these primitives.
fn compared(attributes: &str, primitives: &str, content: &str) -> (f32, f32) {
    let svg = drawing(attributes, primitives, content, true);
    let source = by_resvg(&drawing(attributes, primitives, content, false));
    let source = Layer::from_rgba8(IntRect::new(0, 0, SIZE, SIZE), &source);
    let ours = filtered_by_us(&svg, source, Highlights::AsIs).unwrap();
    difference(&ours, &by_resvg(&svg))
}

const SRGB: &str = "color-interpolation-filters='sRGB'";
const LINEAR: &str = "color-interpolation-filters='linearRGB'";

#[track_caller]
fn agrees(primitives: &str, most: f32, mean: f32) {
    agrees_on(SRGB, primitives, SHAPES, most, mean);
}

#[track_caller]
fn agrees_on(attributes: &str, primitives: &str, content: &str, most: f32, mean: f32) {
    let (their_most, their_mean) = compared(attributes, primitives, content);
    assert!(their_most <= most && their_mean <= mean, "off by up to {their_most}, {their_mean} in the mean");
}

#[test]
fn blurs_agree() {
    // Below 2 pixels resvg solves the heat equation in four steps, which makes an edge some levels
    // harder or softer than the Gaussian does.
    for deviation in ["1", "1.5 0", "0 1.9", "0.5"] {
        agrees(&format!("<feGaussianBlur stdDeviation='{deviation}'/>"), 19.0, 1.2);
    }
    // Light that leaves the region between two of resvg's passes is lost to it: no more than this.
    for deviation in ["3", "6 2.5", "0 8", "5"] {
        agrees(&format!("<feGaussianBlur stdDeviation='{deviation}'/>"), 9.0, 1.3);
    }
}

#[test]
fn a_blur_that_does_nothing_leaves_the_picture() {
    agrees("<feGaussianBlur stdDeviation='0'/>", 0.01, 0.01);
}

#[test]
fn offsets_agree() {
    agrees("<feOffset dx='5' dy='-3.7'/>", 0.01, 0.01);
    agrees("<feOffset dx='200'/>", 0.01, 0.01);
}

#[test]
fn floods_and_subregions_agree() {
    agrees(
        "<feFlood flood-color='#48c' flood-opacity='.4' x='5.5' y='7' width='20.2' height='9'/>",
        1.0,
        0.1,
    );
}

#[test]
fn blends_agree_in_every_mode() {
    for mode in [
        "normal",
        "multiply",
        "screen",
        "overlay",
        "darken",
        "lighten",
        "color-dodge",
        "color-burn",
        "hard-light",
        "soft-light",
        "difference",
        "exclusion",
        "hue",
        "saturation",
        "color",
        "luminosity",
    ] {
        agrees(
            &format!(
                "<feFlood flood-color='#b83' flood-opacity='.8'/><feBlend in='SourceGraphic' mode='{mode}'/>"
            ),
            3.0,
            0.7,
        );
    }
}

#[test]
fn composites_agree() {
    for operator in
        ["over", "in", "out", "atop", "xor", "lighter", "arithmetic' k1='.5' k2='.7' k3='-.3' k4='.1"]
    {
        agrees(
            &format!(
                "<feFlood flood-color='#b83' flood-opacity='.8' x='4' y='16' width='30' height='20'/>
                 <feComposite in='SourceGraphic' operator='{operator}'/>"
            ),
            2.0,
            1.0,
        );
    }
}

#[test]
fn merges_and_named_results_agree() {
    agrees(
        "<feOffset dx='4' result='a'/><feOffset in='SourceAlpha' dx='-3' result='b'/>
         <feMerge><feMergeNode in='b'/><feMergeNode in='SourceGraphic'/><feMergeNode in='a'/></feMerge>",
        1.5,
        0.2,
    );
}

#[test]
fn a_result_may_be_looked_at_twice_by_one_primitive() {
    agrees("<feOffset dx='4' result='a'/><feBlend in='a' in2='a' mode='multiply'/>", 2.0, 0.5);
    agrees(
        "<feOffset dx='4' result='a'/><feComposite in='a' in2='a' operator='arithmetic' k2='.5' k3='.25'/>
         <feMerge><feMergeNode/><feMergeNode in='a'/><feMergeNode/></feMerge>",
        2.5,
        0.8,
    );
    agrees("<feOffset dx='0' result='a'/><feDisplacementMap in='a' in2='a' scale='0'/>", 0.01, 0.01);
}

#[test]
fn results_that_nobody_looks_at_are_not_made() {
    let image = "<feImage href='#leaf' result='unused'/><feOffset in='SourceGraphic'/>";
    let leaf = "<defs><path id='leaf' d='M0 0H9V9z'/></defs>";
    let svg = drawing(SRGB, image, &format!("{SHAPES}{leaf}"), true);
    let tree = Tree::from_str(&svg, &Options::default()).unwrap();
    let filters = first_filtered(tree.root()).unwrap().filters();
    assert_eq!(filters[0].primitives().len(), 2);
    let region = IntRect::new(0, 0, SIZE, SIZE);
    let mut job = Job {
        to_canvas: Affine::IDENTITY,
        highlights: Highlights::AsIs,
        without_front: false,
        index_aa: false,
        log: &Log::default(),
        draw: &mut |_, _, _| panic!("the image is not called for"),
    };
    let source = Layer::filled(region, Space::Srgb, [0.5, 0.2, 0.1, 0.6]);
    assert_eq!(apply(filters, &[region], source.clone(), &mut job).unwrap(), source);
}

#[test]
fn aliasing_is_detected_and_its_cure_told() {
    let lit = |exponent: u32| {
        let primitive = format!(
            "<feSpecularLighting surfaceScale='5' specularExponent='{exponent}'>
             <feDistantLight azimuth='45' elevation='60'/></feSpecularLighting>"
        );
        let tree = Tree::from_str(&drawing(SRGB, &primitive, SHAPES, true), &Options::default()).unwrap();
        let filters = first_filtered(tree.root()).unwrap().filters().to_vec();
        let source = by_resvg(&drawing(SRGB, &primitive, SHAPES, false));
        let region = IntRect::new(0, 0, SIZE, SIZE);
        let log = Log::new(true);
        let mut job = Job {
            to_canvas: Affine::IDENTITY,
            highlights: Highlights::Clamp,
            without_front: false,
            index_aa: false,
            log: &log,
            draw: &mut draw_by_resvg,
        };
        apply(&filters, &[region], Layer::from_rgba8(region, &source), &mut job).unwrap();
        let entries = log.into_entries();
        assert_eq!((entries.effects[0].name, entries.effects[0].runs), ("feSpecularLighting", 1));
        entries.lit[0].clone()
    };
    assert_eq!((lit(1).aliasing, lit(1).sampling_rate), (0, 0.0));
    let found = lit(100);
    assert!(found.aliasing > 100 && found.aliasing < 1500 && found.sampling_rate > 10.0, "{found:?}");
}

#[test]
fn colour_changes_agree() {
    for primitive in [
        "<feColorMatrix type='saturate' values='.3'/>",
        "<feColorMatrix type='hueRotate' values='70'/>",
        "<feColorMatrix type='luminanceToAlpha'/>",
        "<feColorMatrix values='.2 .5 0 0 .1  0 .9 .3 0 0  1 0 -.4 0 0  0 .2 0 .8 0'/>",
        "<feComponentTransfer><feFuncR type='table' tableValues='.2 1 .1'/>
         <feFuncG type='discrete' tableValues='0 .5 1'/><feFuncB type='linear' slope='.7' intercept='.2'/>
         <feFuncA type='gamma' amplitude='.9' exponent='1.7' offset='.05'/></feComponentTransfer>",
    ] {
        // resvg cuts to whole levels, down, before and after it premultiplies.
        agrees(primitive, 3.5, 1.2);
    }
}

#[test]
fn convolutions_agree() {
    for attributes in [
        "kernelMatrix='1 2 0 -1 3 1 0 1 2' edgeMode='none'",
        "kernelMatrix='1 2 0 -1 3 1 0 1 2' edgeMode='wrap' targetX='0'",
        "kernelMatrix='-1 -1 -1 -1 9 -1 -1 -1 -1' preserveAlpha='true'",
        "order='4 2' kernelMatrix='1 2 3 4 5 6 7 8' divisor='50' bias='.1'",
    ] {
        // Straight colour of what is all but clear is coarse in eight bits: hence the mean.
        let most = if attributes.contains("preserve") { 20.0 } else { 2.0 };
        agrees(&format!("<feConvolveMatrix {attributes}/>"), most, 0.8);
    }
}

#[test]
fn morphology_agrees() {
    for operator in ["erode", "dilate"] {
        for radius in ["1", "3 1.6", "7", "0.3", "1000"] {
            agrees(&format!("<feMorphology operator='{operator}' radius='{radius}'/>"), 1.0, 0.3);
        }
    }
}

#[test]
fn turbulence_agrees() {
    for attributes in [
        "baseFrequency='.07'",
        "baseFrequency='.05 .11' numOctaves='3' seed='5' type='fractalNoise'",
        "baseFrequency='.2' numOctaves='2' seed='-8'",
    ] {
        agrees(&format!("<feTurbulence {attributes}/>"), 1.6, 0.6);
    }
}

#[test]
fn tiles_agree() {
    agrees("<feOffset x='10' y='11' width='13' height='9'/><feTile/>", 1.0, 0.3);
    agrees(
        "<feFlood flood-color='#48c' x='8' y='7' width='5' height='4'/>
         <feOffset dx='2'/><feTile/>",
        1.0,
        0.3,
    );
}

#[test]
fn lighting_agrees() {
    for light in [
        "<feDistantLight azimuth='200' elevation='35'/>",
        "<fePointLight x='10' y='20' z='15'/>",
        "<feSpotLight x='5' y='5' z='30' pointsAtX='30' pointsAtY='28' specularExponent='8'/>",
        "<feSpotLight x='24' y='20' z='30' pointsAtX='26' pointsAtY='28' limitingConeAngle='30'/>",
    ] {
        for lighting in [
            format!("<feDiffuseLighting surfaceScale='4' lighting-color='#fa8'>{light}</feDiffuseLighting>"),
            format!(
                "<feSpecularLighting surfaceScale='3' specularConstant='.8' specularExponent='12'
                 lighting-color='#adf'>{light}</feSpecularLighting>"
            ),
        ] {
            agrees(&lighting, 2.0, 0.7);
        }
    }
}

#[test]
fn displacement_agrees_but_for_edges_between_pixels() {
    // resvg 0.49 squares the scale, so it gets the root of ours.
    let compared = |map: &str, scale: f32| {
        let svg = |scale: f32| {
            let primitives = format!(
                "{map}<feDisplacementMap in='SourceGraphic' in2='map' scale='{scale}'
                 xChannelSelector='R' yChannelSelector='G'/>"
            );
            drawing(SRGB, &primitives, SHAPES, true)
        };
        let source = by_resvg(&drawing(SRGB, map, SHAPES, false));
        let source = Layer::from_rgba8(IntRect::new(0, 0, SIZE, SIZE), &source);
        let ours = filtered_by_us(&svg(scale), source, Highlights::AsIs).unwrap();
        difference(&ours, &by_resvg(&svg(scale.sqrt())))
    };
    // resvg takes the nearest pixel; ours lie between.
    let noise = "<feTurbulence baseFrequency='.05' type='fractalNoise'/>
        <feColorMatrix values='1 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 0 0 1' result='map'/>";
    let (_, mean) = compared(noise, 9.0);
    assert!(mean < 4.0, "off by {mean} in the mean");
    // A constant shift by whole pixels leaves no room to differ.
    let (most, _) = compared("<feFlood flood-color='#fff' result='map'/>", 16.0);
    assert!(most < 0.01, "off by up to {most}");
}

#[test]
fn drop_shadows_agree() {
    agrees("<feDropShadow dx='4' dy='3' stdDeviation='2.5' flood-opacity='.6'/>", 3.0, 0.5);
    agrees_on(
        LINEAR,
        "<feDropShadow dx='4' dy='3' stdDeviation='2.5' flood-color='#fff' flood-opacity='.8'/>",
        SHAPES,
        9.0,
        1.0,
    );
}

#[test]
fn images_agree() {
    let image = "<defs><path id='leaf' d='M3 3Q20 3 20 20Q3 20 3 3z' fill='#391'/></defs>";
    let content = format!("{SHAPES}{image}");
    let primitives =
        "<feImage href='#leaf'/><feMerge><feMergeNode in='SourceGraphic'/><feMergeNode/></feMerge>";
    agrees_on(SRGB, primitives, &content, 2.0, 0.4);
}

#[test]
fn linear_light_agrees_as_far_as_eight_bits_hold_it() {
    // Two adjacent bytes of linear light are up to 13 levels of sRGB apart.
    agrees_on(LINEAR, "<feGaussianBlur stdDeviation='4'/>", SHAPES, 14.0, 2.5);
    agrees_on(LINEAR, "<feGaussianBlur stdDeviation='1'/>", SHAPES, 19.0, 2.5);
}

#[test]
fn chains_agree() {
    // A box whose filter region, a tenth larger to all sides, is of whole pixels: resvg rounds another way.
    let all_around = "<path d='M4 4H44V44H4z' fill='#fff' fill-opacity='.1'/>";
    let svg = |filter: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='{SIZE}' height='{SIZE}'>
             <g style='{filter}'>{all_around}{SHAPES}</g></svg>"
        )
    };
    let filter = "filter:grayscale(.6) brightness(1.3) drop-shadow(3px 2px 2px black) opacity(.7)";
    let source = Layer::from_rgba8(IntRect::new(0, 0, SIZE, SIZE), &by_resvg(&svg("")));
    let ours = filtered_by_us(&svg(filter), source, Highlights::AsIs).unwrap();
    // resvg cuts down to whole levels after each of the four.
    let (most, mean) = difference(&ours, &by_resvg(&svg(filter)));
    assert!(most < 7.0 && mean < 0.8, "off by up to {most}, {mean} in the mean");
}

#[test]
fn a_turned_filter_agrees() {
    let turn = "rotate(30) translate(16 -8)";
    let primitives = "<feFlood flood-color='#48c' x='10' y='12' width='20' height='16'/>";
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{SIZE}' height='{SIZE}'>
         <filter id='f' filterUnits='userSpaceOnUse' x='0' y='0' width='{SIZE}' height='{SIZE}'>
         {primitives}</filter><g transform='{turn}'><g filter='url(#f)'>{SHAPES}</g></g></svg>"
    );
    let source = Layer::clear(IntRect::new(0, 0, SIZE, SIZE), Space::Srgb);
    let ours = filtered_by_us(&svg, source, Highlights::AsIs).unwrap();
    let (most, mean) = difference(&ours, &by_resvg(&svg));
    assert!(most < 3.0 && mean < 0.3, "off by up to {most}, {mean} in the mean");
}

#[test]
fn absurd_values_end_without_panic() {
    for primitive in [
        "<feGaussianBlur stdDeviation='1e5'/>",
        "<feGaussianBlur stdDeviation='3e38 1e-38'/>",
        "<feOffset dx='1e9' dy='-3e38'/>",
        "<feDropShadow dx='-3e38' dy='1e9' stdDeviation='1e30'/>",
        "<feMorphology radius='1e30' operator='dilate'/>",
        "<feTurbulence baseFrequency='1e30' numOctaves='4000000000' stitchTiles='stitch'/>",
        "<feTurbulence baseFrequency='1e-30' numOctaves='3' stitchTiles='stitch' seed='-2147483648'/>",
        "<feDisplacementMap in2='SourceGraphic' scale='3e38'/>",
        "<feColorMatrix type='hueRotate' values='3e38'/>",
        "<feColorMatrix values='3e38 3e38 3e38 -3e38 0 0 0 0 0 0 0 0 0 0 0 0 0 0 3e38 3e38'/>",
        "<feComposite in2='SourceGraphic' operator='arithmetic' k1='3e38' k2='-3e38' k3='3e38' k4='-3e38'/>",
        "<feConvolveMatrix order='2' kernelMatrix='3e38 3e38 -3e38 3e38' divisor='1e-38'/>",
        "<feSpecularLighting surfaceScale='3e38' specularExponent='128'><fePointLight z='3e38'/></feSpecularLighting>",
        "<feDiffuseLighting surfaceScale='-3e38'><feSpotLight x='3e38' limitingConeAngle='1e9'/></feDiffuseLighting>",
        "<feFlood x='-1e9' y='-1e9' width='3e9' height='3e9'/><feTile/>",
        "<feComponentTransfer><feFuncR type='gamma' exponent='-3e38' amplitude='3e38'/></feComponentTransfer>",
    ] {
        for highlights in [Highlights::AsIs, Highlights::Clamp, Highlights::Aggressive, Highlights::Supersample] {
            let svg = drawing(SRGB, primitive, SHAPES, true);
            let source = by_resvg(&drawing(SRGB, primitive, SHAPES, false));
            let source = Layer::from_rgba8(IntRect::new(0, 0, SIZE, SIZE), &source);
            let made = filtered_by_us(&svg, source, highlights).unwrap();
            for &[r, g, b, a] in made.pixels() {
                assert!((0.0..=1.0).contains(&a), "{primitive}: alpha {a}");
                assert!([r, g, b].iter().all(|v| (0.0..=a + 1e-5).contains(v)), "{primitive}: {r} {g} {b} {a}");
            }
        }
    }
}

#[test]
fn regions_follow_the_picture_and_not_the_filter() {
    let blur = "<feGaussianBlur stdDeviation='2'/>";
    let svg = drawing("", blur, SHAPES, true).replace("width='48' height='48' ", "width='1e6' height='1e6' ");
    let tree = Tree::from_str(&svg, &Options::default()).unwrap();
    let group = first_filtered(tree.root()).unwrap();
    let picture = IntRect::new(0, 0, SIZE, SIZE);
    let found = regions(group.filters(), Affine::IDENTITY, picture, picture);
    assert!(found[0].right() > 48 + 6 && found[0].right() < 48 + 20, "{found:?}");
    let found = regions(group.filters(), Affine::scale(1e4), picture, picture);
    assert!(found[0].area() <= picture.area() * 25, "{found:?}");
}

#[test]
fn too_large_a_filter_is_refused() {
    let svg = drawing("", "<feFlood/>", SHAPES, true);
    let tree = Tree::from_str(&svg, &Options::default()).unwrap();
    let filters = first_filtered(tree.root()).unwrap().filters();
    let mut job = Job {
        to_canvas: Affine::IDENTITY,
        highlights: Highlights::AsIs,
        without_front: false,
        index_aa: false,
        log: &Log::default(),
        draw: &mut draw_by_resvg,
    };
    let region = IntRect::new(0, 0, 20_000, 20_000);
    let source = Layer::clear(IntRect::EMPTY, Space::Srgb);
    assert!(matches!(apply(filters, &[region], source, &mut job), Err(Error::Limit(_))));
}
