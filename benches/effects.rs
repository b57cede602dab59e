//! Raster time of each effect beside resvg's, on one thread: `cargo bench --bench effects`.
//!
//! One scene an effect, 1024 x 1024 pixels. Both render in turns; the ratio is the median of the ratios
//! of the turns, so that a busy moment of the machine falls on both.

#[path = "support/machine.rs"]
mod machine;
#[path = "support/random.rs"]
mod random;

use base64::Engine;
use clap::Parser;
use random::Random;
use resvg::{tiny_skia, usvg};
use std::fmt::Write;
use std::time::Instant;
use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// Times this crate and resvg in turns on one scene for each effect.
#[derive(Parser)]
struct Args {
    /// Timed rounds of each scene.
    #[arg(long, default_value_t = 11)]
    runs: usize,
    /// Only scenes whose name contains this; may be given several times.
    #[arg(long)]
    scene: Vec<String>,
    /// Renders only with this crate (`ours`) or only with resvg, for a profiler.
    #[arg(long)]
    only: Option<String>,
    /// Writes the scenes as SVG files, and both pictures of each, into this folder, and stops.
    #[arg(long)]
    write: Option<std::path::PathBuf>,
    /// What cargo adds; without it every scene runs once, small, to see that it runs.
    #[arg(long, hide = true)]
    bench: bool,
}

/// User units and pixels of a side.
const SIDE: u32 = 1024;

fn main() {
    let args = Args::parse();
    let (side, runs) = if args.bench { (SIDE, args.runs.max(1)) } else { (64, 1) };
    println!("{}\n{side} px, one thread, medians of {runs} rounds\n", machine::line());
    println!("| scene | toon-raster ms | resvg ms | ratio |\n|---|---|---|---|");
    for (name, body) in scenes() {
        if !args.scene.is_empty() && !args.scene.iter().any(|part| name.contains(part.as_str())) {
            continue;
        }
        let mut pair = Pair::new(&document(&body), side);
        if let Some(folder) = &args.write {
            std::fs::create_dir_all(folder).expect("a folder");
            let file = |end: &str| folder.join(format!("{}{end}", name.replace([' ', ','], "-")));
            std::fs::write(file(".svg"), document(&body)).expect("a file");
            pair.time_ours();
            pair.time_resvg();
            let ours =
                image::RgbaImage::from_raw(side, side, pair.picture.data().to_vec()).expect("its size");
            ours.save(file("-ours.png")).expect("a file");
            let theirs = pair.pixmap.clone().take_demultiplied();
            let theirs = image::RgbaImage::from_raw(side, side, theirs).expect("its size");
            theirs.save(file("-resvg.png")).expect("a file");
            continue;
        }
        if let Some(only) = &args.only {
            for _ in 0..runs {
                if only == "ours" {
                    pair.time_ours()
                } else {
                    pair.time_resvg()
                };
            }
            continue;
        }
        pair.time_ours();
        pair.time_resvg();
        let rounds: Vec<(f64, f64)> = (0..runs).map(|_| (pair.time_ours(), pair.time_resvg())).collect();
        let of = |figure: fn(&(f64, f64)) -> f64| median(rounds.iter().map(figure).collect());
        println!("| {name} | {:.2} | {:.2} | {:.2} |", of(|r| r.0), of(|r| r.1), of(|r| r.0 / r.1));
    }
}

fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

fn document(body: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='{SIDE}' height='{SIDE}'>{body}</svg>"
    )
}

/// A drawing, ready to be rendered by both.
struct Pair {
    tree: usvg::Tree,
    scene: Scene,
    renderer: Renderer,
    viewport: Viewport,
    picture: Pixmap,
    pixmap: tiny_skia::Pixmap,
    scale: f32,
}

impl Pair {
    fn new(svg: &str, side: u32) -> Pair {
        let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).expect("a drawing");
        let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
        assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
        Pair {
            renderer: Renderer::new(Settings { threads: 1, ..Settings::default() }).expect("the defaults"),
            viewport: Viewport::fit(&scene, side, side),
            picture: Pixmap::new(side, side),
            pixmap: tiny_skia::Pixmap::new(side, side).expect("a size"),
            scale: side as f32 / SIDE as f32,
            tree,
            scene,
        }
    }

    fn time_ours(&mut self) -> f64 {
        let stride = self.picture.stride();
        let start = Instant::now();
        self.renderer
            .render_into(&self.scene, &self.viewport, self.picture.data_mut(), stride)
            .expect("the viewport and the buffer fit");
        start.elapsed().as_secs_f64() * 1e3
    }

    fn time_resvg(&mut self) -> f64 {
        self.pixmap.data_mut().fill(0);
        let transform = tiny_skia::Transform::from_scale(self.scale, self.scale);
        let start = Instant::now();
        resvg::render(&self.tree, transform, &mut self.pixmap.as_mut());
        start.elapsed().as_secs_f64() * 1e3
    }
}

const COLORS: [&str; 8] =
    ["#d7263d", "#f46036", "#2e294e", "#1b998b", "#c5d86d", "#3f88c5", "#ffba08", "#8f2d56"];

/// Overlapping circles all over the page.
fn circles(count: usize, style: &str) -> String {
    let mut random = Random::new(7);
    let mut text = String::new();
    for _ in 0..count {
        let (x, y, r) = (random.within(60.0, 960.0), random.within(60.0, 960.0), random.within(30.0, 150.0));
        let color = random.pick(&COLORS);
        write!(text, "<circle cx='{x:.2}' cy='{y:.2}' r='{r:.2}' fill='{color}' {style}/>")
            .expect("a string");
    }
    text
}

/// Groups that blend, each of the whole page in a light colour.
fn pages(count: usize) -> String {
    let page = |i: usize| {
        let color = format!("#{:02x}{:02x}{:02x}", 255 - i % 3, 255 - i % 4, 255 - i % 5);
        format!("<g style='mix-blend-mode:multiply'><rect width='1024' height='1024' fill='{color}'/></g>")
    };
    (0..count).map(page).collect()
}

/// Circles that blend, each by itself, a tenth of them over a pixel, and of 300 and more their borders in most.
fn deep_circles(count: usize) -> String {
    let circle = |i: usize| {
        let (x, y, color) = ((i * 145) % 1024, (i * 219) % 1024, (i * 1237) % 0xfff);
        format!("<circle cx='{x}.3' cy='{y}' r='184' fill='#{color:03x}' fill-opacity='.05' style='mix-blend-mode:overlay'/>")
    };
    (0..count).map(circle).collect()
}

/// Groups that blend, each of one circle that covers much of the page.
fn large_circles(count: usize) -> String {
    let mut random = Random::new(11);
    let mut circle = |i: usize| {
        let (x, y, r) =
            (random.within(200.0, 824.0), random.within(200.0, 824.0), random.within(200.0, 500.0));
        let color = format!("#{:02x}{:02x}{:02x}", 255 - i % 9, 255 - i % 7, 255 - i % 8);
        format!("<g style='mix-blend-mode:multiply'><circle cx='{x:.2}' cy='{y:.2}' r='{r:.2}' fill='{color}'/></g>")
    };
    (0..count).map(&mut circle).collect()
}

/// A group of circles under a filter over the whole page.
fn filtered(primitives: &str) -> String {
    let filter = format!(
        "<filter id='f' filterUnits='userSpaceOnUse' x='0' y='0' width='1024' height='1024'>{primitives}</filter>"
    );
    format!("{filter}<g filter='url(#f)'>{}</g>", circles(40, ""))
}

/// Sixty small shapes, each under the same filter for itself.
fn small(primitives: &str) -> String {
    format!("<filter id='f'>{primitives}</filter>{}", circles(60, "filter='url(#f)'"))
}

/// An image of `side` pixels, as a data URL.
fn picture(side: u32) -> String {
    let pixel = |x: u32, y: u32| image::Rgba([(x * 7) as u8, (y * 5) as u8, ((x ^ y) * 3) as u8, 255]);
    let pixels = image::RgbaImage::from_fn(side, side, pixel);
    let mut bytes = std::io::Cursor::new(Vec::new());
    pixels.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes all");
    format!("data:image/png;base64,{}", base64::prelude::BASE64_STANDARD.encode(bytes.into_inner()))
}

fn image(pixels: u32, transform: &str) -> String {
    format!(
        "<image width='{pixels}' height='{pixels}' transform='{transform}' xlink:href='{}'/>",
        picture(pixels)
    )
}

/// One image of 2048 pixels, at 16 pixels in as many places.
fn icons(count: usize) -> String {
    let place = |i: usize| format!("<use href='#i' x='{}' y='{}'/>", i % 25 * 40 + 5, i / 25 * 50 + 5);
    let picture = picture(2048);
    let first = format!("<defs><image id='i' width='16' height='16' xlink:href='{picture}'/></defs>");
    first + &(0..count).map(place).collect::<String>()
}

const STOPS: &str = "<stop offset='0' stop-color='#d7263d'/><stop offset='.4' stop-color='#c5d86d'/>
    <stop offset='1' stop-color='#3f88c5'/>";

fn gradient(kind: &str, attributes: &str, body: &str) -> String {
    format!("<{kind} id='g' gradientUnits='userSpaceOnUse' {attributes}>{STOPS}</{kind}>{body}")
}

const PAGE: &str = "<rect width='1024' height='1024' fill='url(#g)'/>";

fn scenes() -> Vec<(&'static str, String)> {
    let in_gradient = circles(40, "").replace("fill='#", "fill='url(#g)' stroke='#");
    let linear = "x1='50' y1='80' x2='900' y2='960'";
    let radial = "cx='500' cy='520' r='600' fx='400' fy='300'";
    let blended = |mode: &str| {
        format!("{}<g style='mix-blend-mode:{mode}'>{}</g>", circles(30, ""), circles(40, "stroke='#fff'"))
    };
    let paper = "<rect width='1024' height='1024' fill='#eee'/>";
    let mask = "<mask id='m' maskUnits='userSpaceOnUse' x='0' y='0' width='1024' height='1024'>
        <circle cx='512' cy='512' r='480' fill='#ccc'/><circle cx='400' cy='400' r='200' fill='#fff'/></mask>";
    let pattern = |size: u32, transform: &str| {
        format!(
            "<pattern id='p' width='{size}' height='{size}' patternUnits='userSpaceOnUse' patternTransform='{transform}'>
            <rect width='{size}' height='{size}' fill='#eee'/><circle cx='{0}' cy='{0}' r='{0}' fill='#1b998b'/></pattern>
            <rect width='1024' height='1024' fill='url(#p)'/>",
            size / 2
        )
    };
    vec![
        ("gradient, linear", gradient("linearGradient", linear, PAGE)),
        ("gradient, linear on 40 outlined circles", gradient("linearGradient", linear, &in_gradient)),
        ("gradient, radial", gradient("radialGradient", radial, PAGE)),
        ("gradient, radial on 40 outlined circles", gradient("radialGradient", radial, &in_gradient)),
        (
            "gradient, focus outside its circle",
            gradient("radialGradient", "cx='350' cy='512' r='200' fx='700' fy='512'", PAGE),
        ),
        (
            "gradient, 300 rings",
            gradient("radialGradient", "cx='500' cy='520' r='2' spreadMethod='repeat'", PAGE),
        ),
        ("300 translucent circles", circles(300, "fill-opacity='.5'")),
        (
            "300 translucent pages",
            format!("<g fill-opacity='.02'>{}</g>", "<rect width='1024' height='1024' fill='#d7263d'/>".repeat(300)),
        ),
        (
            "300 translucent gradients",
            gradient("linearGradient", linear, &"<rect x='100' y='100' width='824' height='824' fill='url(#g)' fill-opacity='.05'/>".repeat(300)),
        ),
        ("group opacity", format!("{}<g opacity='.5'>{}</g>", circles(40, ""), circles(40, "stroke='#fff'"))),
        ("clip", format!("<clipPath id='c'><circle cx='512' cy='512' r='480'/></clipPath><g clip-path='url(#c)'>{}</g>", circles(40, ""))),
        ("mask", format!("{paper}{mask}<g mask='url(#m)'>{}</g>", circles(40, ""))),
        (
            "mask, gradient",
            format!("{paper}<linearGradient id='g' gradientUnits='userSpaceOnUse' {linear}><stop offset='0' stop-color='#000'/><stop offset='1' stop-color='#fff'/></linearGradient><mask id='m' maskUnits='userSpaceOnUse' x='0' y='0' width='1024' height='1024'>{PAGE}</mask><g mask='url(#m)'>{}</g>", circles(40, "")),
        ),
        ("mask, 60 small", format!("<mask id='m'><rect width='1024' height='700' fill='#fff' fill-opacity='.7'/></mask>{}", circles(60, "mask='url(#m)'"))),
        ("blend, multiply", blended("multiply")),
        ("blend, multiply on paper", format!("{paper}{}", blended("multiply"))),
        ("blend, soft-light", blended("soft-light")),
        ("blend, luminosity", blended("luminosity")),
        ("blend, 200 pages", format!("{paper}{}", pages(200))),
        ("blend, 200 large circles", format!("{paper}{}", large_circles(200))),
        ("blend, 300 deep", deep_circles(300)),
        ("blend, 1000 deep", deep_circles(1000)),
        ("blend, 60 small", format!("{paper}{}", circles(60, "style='mix-blend-mode:multiply'"))),
        ("pattern", pattern(64, "")),
        ("pattern, turned", pattern(64, "rotate(13)")),
        ("pattern, tiny tiles", pattern(4, "scale(.3)")),
        ("image, at its size", image(1024, "")),
        ("image, 4 times down", image(2048, "scale(.25)")),
        ("image, half and turned", image(2048, "translate(500 0) rotate(30) scale(.4)")),
        ("image, 8 times up", image(128, "scale(8)")),
        ("image, 500 icons", icons(500)),
        ("blur, radius 2", filtered("<feGaussianBlur stdDeviation='2'/>")),
        ("blur, radius 30", filtered("<feGaussianBlur stdDeviation='30'/>")),
        ("blur, 60 small", small("<feGaussianBlur stdDeviation='4'/>")),
        ("drop shadow", filtered("<feDropShadow dx='6' dy='6' stdDeviation='5'/>")),
        ("drop shadow, 60 small", small("<feDropShadow dx='3' dy='3' stdDeviation='3'/>")),
        (
            "drop shadow by merging",
            filtered("<feGaussianBlur in='SourceAlpha' stdDeviation='5'/><feOffset dx='6' dy='6'/><feMerge><feMergeNode/><feMergeNode in='SourceGraphic'/></feMerge>"),
        ),
        ("offset", filtered("<feOffset dx='40' dy='30'/>")),
        ("flood and composite", filtered("<feFlood flood-color='#1b998b' flood-opacity='.6'/><feComposite in2='SourceGraphic' operator='atop'/>")),
        ("composite, arithmetic", filtered("<feFlood flood-color='#1b998b'/><feComposite in2='SourceGraphic' operator='arithmetic' k1='.3' k2='.3' k3='.5'/>")),
        ("feBlend", filtered("<feFlood flood-color='#1b998b'/><feBlend in2='SourceGraphic' mode='screen'/>")),
        ("colour matrix", filtered("<feColorMatrix type='hueRotate' values='70'/>")),
        ("colour matrix, sRGB", filtered("<feColorMatrix color-interpolation-filters='sRGB' type='saturate' values='.3'/>")),
        ("colour matrix, 60 small", small("<feColorMatrix type='saturate' values='.3'/>")),
        ("component transfer", filtered("<feComponentTransfer><feFuncR type='gamma' exponent='.5'/><feFuncG type='table' tableValues='0 .3 1'/></feComponentTransfer>")),
        ("convolve, 3 x 3", filtered("<feConvolveMatrix order='3' kernelMatrix='1 2 1 2 4 2 1 2 1'/>")),
        ("convolve, 9 x 9", filtered(&format!("<feConvolveMatrix order='9' kernelMatrix='{}'/>", "1 ".repeat(81)))),
        ("morphology, radius 2", filtered("<feMorphology operator='dilate' radius='2'/>")),
        ("morphology, radius 20", filtered("<feMorphology operator='erode' radius='20'/>")),
        ("displacement", filtered("<feDisplacementMap in2='SourceGraphic' scale='30' xChannelSelector='R' yChannelSelector='G'/>")),
        ("turbulence", filtered("<feTurbulence baseFrequency='.02' numOctaves='3'/>")),
        ("tile", filtered("<feOffset x='100' y='100' width='90' height='90'/><feTile/>")),
        ("diffuse light", filtered("<feDiffuseLighting in='SourceAlpha' surfaceScale='5'><fePointLight x='300' y='300' z='200'/></feDiffuseLighting>")),
        ("specular light", filtered("<feSpecularLighting in='SourceAlpha' surfaceScale='5' specularExponent='20'><feDistantLight azimuth='40' elevation='50'/></feSpecularLighting>")),
        ("feImage", filtered(&format!("<feImage width='1024' height='1024' xlink:href='{}'/>", picture(512)))),
    ]
}
