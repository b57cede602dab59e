//! Takes folders of drawings with a picture beside each (`NAME.svg` and `NAME.png` or `NAME-ref.png`), makes
//! the pass rate of every folder, and a list of all failures with their reasons.
//!
//! A drawing passes when its picture, rendered at the size of the given one, is the same after a blur of
//! 3 x 3 pixels within 24 levels everywhere and 1 level in the mean. The blur allows for better edges.
//! A given picture that is opaque all over was drawn on white, so ours is laid on white too.
//!
//! Where the blur is not enough (thin strokes), a drawing passes *by the reference*, counted apart, if all
//! of this holds: it is without filters and images of pixels, and nothing in it is left out; ours is exact by
//! this library's own reference (within 2 levels), which shares no code with the renderer; and both pictures show the same
//! thing: the mean is within its bound, and what is off is off at an edge by 85 levels at most. The last clause is for
//! what reference and renderer might both get wrong, since they read the same parsed tree.
//!
//! A picture that is blank all over says that there is nothing to draw, and a drawing that is refused
//! because it has no size is nothing: the two are alike.
//!
//! Pictures age. `--by-resvg` says that resvg made them, and takes apart those that the resvg linked here
//! does not draw itself, by the same tolerance: the second rate is over the others.
//!
//! Known failures and their reasons stand in `conformance-reasons.tsv`: the end of a path, a tab, the
//! reason. Other failures are listed as unexplained, and entries whose drawing passes as stale.
//!
//! ```text
//! cargo run --release --example conformance -- DIR... [--fonts DIR] [--sans-serif FAMILY] [--serif FAMILY] [--by-resvg]
//!     [--list] [--write DIR]
//! ```
//!
//! `--list` also names what passes by the reference, and pictures that resvg draws otherwise; `--write` writes ours and theirs side by side for each
//! failure. Exit code 2 for wrong usage, otherwise 0: the report is the result.

use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toon_raster::kurbo;
use toon_raster::reference::{self, Bounds};
use toon_raster::scene::load;
use toon_raster::{FontSource, Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// The most that any channel may be off after the blur, in levels.
const MAX: f64 = 24.0;
/// The most that all channels may be off in the mean.
const MEAN: f64 = 1.0;
/// The same as [`MAX`], for what passes by the reference: an edge which lies another row or column of the
/// window's three, as it may where jagged edges meet pixels' centres.
const MAX_AT_EDGES: f64 = 255.0 / 3.0;

const REASONS: &str = include_str!("conformance-reasons.tsv");

#[derive(Default)]
struct Arguments {
    folders: Vec<PathBuf>,
    fonts: Option<PathBuf>,
    sans_serif: Option<String>,
    serif: Option<String>,
    by_resvg: bool,
    list: bool,
    write: Option<PathBuf>,
}

fn main() {
    let arguments = arguments();
    let options = options(&arguments);
    let mut pairs = Vec::new();
    arguments.folders.iter().for_each(|folder| find(folder, &mut pairs));
    pairs.sort();
    let verdicts: Vec<Verdict> = pairs.par_iter().map(|pair| judge(pair, &options, &arguments)).collect();
    let mut folders: BTreeMap<&Path, Tally> = BTreeMap::new();
    let mut all = Tally::default();
    for (pair, verdict) in pairs.iter().zip(&verdicts) {
        let folder = pair.drawing.parent().unwrap_or(Path::new(""));
        folders.entry(folder).or_default().count(verdict);
        all.count(verdict);
        report(&pair.drawing, verdict, arguments.list);
    }
    for (folder, tally) in &folders {
        println!("{}  {}", tally.rate(), folder.display());
    }
    println!("{}  in all, {} of them by the reference", all.rate(), all.exact);
    println!("{} failures, {} of them unexplained", all.files - all.passed, all.unexplained);
    if arguments.by_resvg {
        println!("{}", all.without_outdated());
    }
}

fn arguments() -> Arguments {
    let mut arguments = Arguments::default();
    let mut given = std::env::args_os().skip(1);
    let text = |given: std::ffi::OsString| given.to_string_lossy().into_owned();
    while let Some(argument) = given.next() {
        match argument.to_str() {
            Some("--fonts") => arguments.fonts = given.next().map(PathBuf::from),
            Some("--sans-serif") => arguments.sans_serif = given.next().map(text),
            Some("--serif") => arguments.serif = given.next().map(text),
            Some("--by-resvg") => arguments.by_resvg = true,
            Some("--list") => arguments.list = true,
            Some("--write") => arguments.write = given.next().map(PathBuf::from),
            Some(other) if other.starts_with("--") => usage(&format!("unknown option {other}")),
            _ => arguments.folders.push(argument.into()),
        }
    }
    if arguments.folders.is_empty() {
        usage("name at least one folder");
    }
    arguments
}

fn usage(why: &str) -> ! {
    eprintln!("conformance: {why}");
    std::process::exit(2);
}

/// How a folder fares.
#[derive(Default)]
struct Tally {
    files: usize,
    passed: usize,
    /// Of those passed, by the reference.
    exact: usize,
    unexplained: usize,
    /// Pictures that resvg draws otherwise, and those of them that ours is like all the same.
    outdated: usize,
    outdated_passed: usize,
}

impl Tally {
    fn count(&mut self, Verdict { end, outdated, .. }: &Verdict) {
        let passed = !matches!(end, End::Fails { .. });
        self.files += 1;
        self.passed += usize::from(passed);
        self.exact += usize::from(matches!(end, End::Exact { .. }));
        self.unexplained += usize::from(matches!(end, End::Fails { reason: None, .. }));
        self.outdated += usize::from(*outdated);
        self.outdated_passed += usize::from(*outdated && passed);
    }

    fn rate(&self) -> String {
        let percent = 100.0 * self.passed as f64 / self.files.max(1) as f64;
        format!("{:5} of {:5}  {percent:5.1}%", self.passed, self.files)
    }

    fn without_outdated(&self) -> String {
        let (files, passed) = (self.files - self.outdated, self.passed - self.outdated_passed);
        let percent = 100.0 * passed as f64 / files.max(1) as f64;
        let outdated = self.outdated;
        format!("without {outdated} pictures that resvg itself draws otherwise: {passed} of {files}, {percent:.1}%")
    }
}

fn report(drawing: &Path, Verdict { end, outdated }: &Verdict, list: bool) {
    let drawing = drawing.display();
    let note = if *outdated { " [resvg draws it otherwise, too]" } else { "" };
    match end {
        End::Fails { how, reason } => {
            println!("FAIL {drawing}: {how}: {}{note}", reason.unwrap_or("unexplained"));
        }
        End::Alike { stale: true } | End::Exact { stale: true, .. } => {
            println!("STALE {drawing}: passes, take it out of conformance-reasons.tsv");
        }
        End::Exact { how, .. } if list => println!("exact, unlike the picture: {drawing}: {how}{note}"),
        End::Alike { .. } if list && *outdated => println!("like the picture, unlike resvg: {drawing}"),
        _ => {}
    }
}

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    drawing: PathBuf,
    picture: PathBuf,
}

/// Drawings with a picture beside them.
fn find(folder: &Path, pairs: &mut Vec<Pair>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        usage(&format!("{} cannot be read", folder.display()));
    };
    for drawing in entries.flatten().map(|entry| entry.path()) {
        if drawing.is_dir() {
            find(&drawing, pairs);
        } else if drawing.extension().is_some_and(|e| e == "svg" || e == "svgz") {
            let name = drawing.file_stem().unwrap_or_default().to_string_lossy();
            let beside =
                |end: &str| Some(drawing.with_file_name(format!("{name}{end}"))).filter(|p| p.exists());
            if let Some(picture) = beside(".png").or_else(|| beside("-ref.png")) {
                pairs.push(Pair { drawing, picture });
            }
        }
    }
}

struct Verdict {
    end: End,
    /// resvg made the picture and does not draw it any more.
    outdated: bool,
}

enum End {
    /// Like the picture beside it.
    Alike {
        stale: bool,
    },
    /// Like the truth, and like the picture but for edges.
    Exact {
        how: String,
        stale: bool,
    },
    Fails {
        how: String,
        reason: Option<&'static str>,
    },
}

fn judge(pair: &Pair, options: &Options, arguments: &Arguments) -> Verdict {
    let name = pair.drawing.to_string_lossy().replace('\\', "/");
    let reason = known_reason(&name);
    let stale = reason.is_some();
    let Case { bytes, theirs, options } = &match Case::read(pair, options) {
        Ok(case) => case,
        Err(how) => return Verdict { end: End::Fails { how, reason }, outdated: false },
    };
    let outdated = arguments.by_resvg && !resvg_draws(bytes, options, theirs);
    let end = match compared(bytes, options, theirs, |ours| {
        if let Some(folder) = &arguments.write {
            write_both(folder, &pair.drawing, ours, theirs);
        }
    }) {
        Ok((_, Outcome::Alike)) => End::Alike { stale },
        Ok((how, Outcome::Exact)) => End::Exact { how, stale },
        Ok((how, Outcome::Unlike)) | Err(how) => End::Fails { how, reason },
    };
    Verdict { end, outdated }
}

/// A drawing, its picture, and how it is to be read.
struct Case {
    bytes: Vec<u8>,
    theirs: image::RgbaImage,
    options: Options,
}

impl Case {
    fn read(pair: &Pair, options: &Options) -> Result<Case, String> {
        let theirs = image::open(&pair.picture).map_err(|e| e.to_string())?.to_rgba8();
        let bytes = std::fs::read(&pair.drawing).map_err(|e| e.to_string())?;
        let options = Options {
            usvg: toon_raster::usvg::Options {
                resources_dir: pair.drawing.parent().map(Path::to_path_buf),
                fontdb: options.usvg.fontdb.clone(),
                ..Default::default()
            },
            ..Default::default()
        };
        Ok(Case { bytes, theirs, options })
    }
}

fn known_reason(drawing: &str) -> Option<&'static str> {
    let entries =
        REASONS.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once('\t'));
    entries.filter(|(end, _)| drawing.ends_with(end)).map(|(_, reason)| reason).next()
}

enum Outcome {
    Alike,
    Exact,
    Unlike,
}

/// The figures, and what they amount to; `show` is given a picture that is unlike.
fn compared(
    bytes: &[u8],
    options: &Options,
    theirs: &image::RgbaImage,
    show: impl Fn(&image::RgbaImage),
) -> Result<(String, Outcome), String> {
    let (ours, warnings) = match rendered(bytes, options, theirs.dimensions()) {
        Ok(made) => made,
        Err(toon_raster::Error::Size(_)) if is_blank(theirs) => {
            return Ok(("nothing".to_string(), Outcome::Alike));
        }
        Err(why) => return Err(why.to_string()),
    };
    let (our_blur, their_blur) = blurred(&ours, theirs);
    let (max, mean) = our_blur.difference(&their_blur);
    let mut how = format!("max {max:.0}, mean {mean:.2}");
    if max <= MAX && mean <= MEAN {
        return Ok((how, Outcome::Alike));
    }
    let same_but_for_edges =
        mean <= MEAN && max <= MAX_AT_EDGES && our_blur.differs_at_edges_only(&their_blur);
    if warnings.is_empty() && same_but_for_edges && is_exact(bytes, options, &ours) {
        return Ok((how, Outcome::Exact));
    }
    show(&ours);
    if !warnings.is_empty() {
        how += &format!("; not drawn: {warnings}");
    }
    Ok((how, Outcome::Unlike))
}

fn is_blank(picture: &image::RgbaImage) -> bool {
    picture.pixels().all(|p| p.0[3] == 0)
}

fn blurred(ours: &image::RgbaImage, theirs: &image::RgbaImage) -> (Levels, Levels) {
    let ground = theirs.pixels().all(|p| p.0[3] == 255).then_some([255.0; 4]);
    (Levels::of(ours, ground).blurred(), Levels::of(theirs, ground).blurred())
}

/// Does resvg draw this picture, within the tolerance?
fn resvg_draws(bytes: &[u8], options: &Options, theirs: &image::RgbaImage) -> bool {
    let (width, height) = theirs.dimensions();
    let draw = || {
        let tree = match resvg::usvg::Tree::from_data(bytes, &options.usvg) {
            Ok(tree) => tree,
            Err(resvg::usvg::Error::InvalidSize) => return Some(image::RgbaImage::new(width, height)),
            Err(_) => return None,
        };
        let size = kurbo::Size::new(tree.size().width().into(), tree.size().height().into());
        let [sx, ky, kx, sy, tx, ty] = placed(size, width, height).transform.as_coeffs().map(|v| v as f32);
        let mut canvas = resvg::tiny_skia::Pixmap::new(width, height)?;
        let transform = resvg::tiny_skia::Transform::from_row(sx, ky, kx, sy, tx, ty);
        resvg::render(&tree, transform, &mut canvas.as_mut());
        image::RgbaImage::from_raw(width, height, canvas.take_demultiplied())
    };
    let drawn = std::panic::catch_unwind(std::panic::AssertUnwindSafe(draw)).ok().flatten();
    drawn.is_some_and(|drawn| {
        let (one, other) = blurred(&drawn, theirs);
        let (max, mean) = one.difference(&other);
        max <= MAX && mean <= MEAN
    })
}

/// The picture, and what it leaves out.
fn rendered(
    bytes: &[u8],
    options: &Options,
    (width, height): (u32, u32),
) -> Result<(image::RgbaImage, String), toon_raster::Error> {
    let render = || -> Result<_, toon_raster::Error> {
        let scene = Scene::from_bytes(bytes, options)?;
        let settings = Settings { threads: 1, ..Settings::default() };
        let picture = Renderer::new(settings)?.render(&scene, &placed(scene.size(), width, height))?;
        let warnings: Vec<&str> = scene.warnings().iter().map(|warning| warning.kind).collect();
        Ok((image::RgbaImage::from(picture), warnings.join(", ")))
    };
    let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(render));
    made.map_err(|_| toon_raster::Error::Parse("internal error".to_string()))?
}

/// The drawing as wide as the picture, whose height may have been rounded to a pixel; or, where the two
/// have another shape, all of the drawing in the middle.
fn placed(size: kurbo::Size, width: u32, height: u32) -> Viewport {
    let room = kurbo::Size::new(width.into(), height.into());
    let by_width = room.width / size.width;
    let scale = match (by_width * size.height - room.height).abs() < 1.0 {
        true => by_width,
        false => by_width.min(room.height / size.height),
    };
    let margin = (room - size * scale) * 0.5;
    let middle =
        if scale == by_width && margin.height.abs() < 0.5 { kurbo::Vec2::ZERO } else { margin.to_vec2() };
    Viewport { width, height, transform: kurbo::Affine::scale(scale).then_translate(middle) }
}

/// Is the picture within twice the bounds that the renderer promises (2 levels, for most)? Not where the
/// reference cannot tell.
fn is_exact(bytes: &[u8], options: &Options, ours: &image::RgbaImage) -> bool {
    let Ok(tree) = load::tree_from_bytes(bytes, options) else { return false };
    if !reference::unsupported(&tree).is_empty() {
        return false;
    }
    let Ok(scene) = Scene::from_tree(&tree) else { return false };
    let viewport = placed(scene.size(), ours.width(), ours.height());
    let Ok(truth) = reference::render(&tree, &viewport, &reference::Options::default()) else { return false };
    let mut picture = Pixmap::new(ours.width(), ours.height());
    picture.data_mut().copy_from_slice(ours);
    let Bounds { max, mean } = Bounds::of(&tree, &truth);
    Bounds { max: 2.0 * max, mean }.hold(&truth.compare(&picture))
}

/// With the fonts of a folder, or the system's, by default under the families of the resvg suite.
fn options(arguments: &Arguments) -> Options {
    let mut options = Options::default();
    let mut database = toon_raster::usvg::fontdb::Database::new();
    match &arguments.fonts {
        Some(folder) => database.load_fonts_dir(folder),
        None => database.load_system_fonts(),
    }
    database.set_sans_serif_family(arguments.sans_serif.as_deref().unwrap_or("Noto Sans"));
    database.set_serif_family(arguments.serif.as_deref().unwrap_or("Noto Serif"));
    database.set_cursive_family("Yellowtail");
    database.set_fantasy_family("Sedgwick Ave Display");
    database.set_monospace_family("Noto Mono");
    options.usvg.fontdb = std::sync::Arc::new(database);
    options.fonts = FontSource::none();
    options
}

/// Pixels in premultiplied levels.
struct Levels {
    width: i64,
    height: i64,
    pixels: Vec<[f64; 4]>,
}

impl Levels {
    /// On an opaque ground, where there is one.
    fn of(picture: &image::RgbaImage, ground: Option<[f64; 4]>) -> Levels {
        let behind = ground.unwrap_or_default();
        let premultiplied = |pixel: &image::Rgba<u8>| {
            let [r, g, b, a] = pixel.0.map(f64::from);
            let over = [r * a / 255.0, g * a / 255.0, b * a / 255.0, a];
            std::array::from_fn(|i| over[i] + behind[i] * (255.0 - a) / 255.0)
        };
        let (width, height) = (i64::from(picture.width()), i64::from(picture.height()));
        Levels { width, height, pixels: picture.pixels().map(premultiplied).collect() }
    }

    /// Each the mean of 3 x 3 pixels.
    fn blurred(&self) -> Levels {
        let mean = |(x, y): (i64, i64)| {
            let mut sum = [0.0; 4];
            self.around(x, y, 1)
                .for_each(|pixel| sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += v / 9.0));
            sum
        };
        Levels { pixels: self.places().map(mean).collect(), ..*self }
    }

    fn places(&self) -> impl Iterator<Item = (i64, i64)> + use<> {
        let (width, height) = (self.width, self.height);
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The pixels around one, so many each way; beyond the border, those on it again.
    fn around(&self, x: i64, y: i64, reach: i64) -> impl Iterator<Item = [f64; 4]> + '_ {
        let steps = (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)));
        steps.map(move |(dx, dy)| {
            let (x, y) = ((x + dx).clamp(0, self.width - 1), (y + dy).clamp(0, self.height - 1));
            self.pixels[(y * self.width + x) as usize]
        })
    }

    /// The greatest difference of a channel, and the mean.
    fn difference(&self, other: &Levels) -> (f64, f64) {
        let off = self.pixels.iter().flatten().zip(other.pixels.iter().flatten()).map(|(a, b)| (a - b).abs());
        let (max, sum) = off.fold((0.0f64, 0.0), |(max, sum), v| (max.max(v), sum + v));
        (max, sum / (4 * self.pixels.len().max(1)) as f64)
    }

    /// Does each picture change nearby wherever they differ? Where something is missing, one does not.
    fn differs_at_edges_only(&self, other: &Levels) -> bool {
        let pixels = self.pixels.iter().zip(&other.pixels);
        let off =
            |(one, other): (&[f64; 4], &[f64; 4])| one.iter().zip(other).any(|(a, b)| (a - b).abs() > MAX);
        self.places()
            .zip(pixels)
            .all(|((x, y), pair)| !off(pair) || self.changes(x, y) && other.changes(x, y))
    }

    /// Is there an edge within 2 pixels?
    fn changes(&self, x: i64, y: i64) -> bool {
        let (mut least, mut most) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
        for pixel in self.around(x, y, 2) {
            for i in 0..4 {
                (least[i], most[i]) = (least[i].min(pixel[i]), most[i].max(pixel[i]));
            }
        }
        (0..4).any(|i| most[i] - least[i] > 0.5 * MAX)
    }
}

fn write_both(folder: &Path, file: &Path, ours: &image::RgbaImage, theirs: &image::RgbaImage) {
    let mut both = image::RgbaImage::new(ours.width() + theirs.width(), ours.height().max(theirs.height()));
    image::imageops::replace(&mut both, ours, 0, 0);
    image::imageops::replace(&mut both, theirs, ours.width().into(), 0);
    let name: Vec<String> =
        file.components().rev().take(3).map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    let name = name.into_iter().rev().collect::<Vec<_>>().join("-");
    let _ = std::fs::create_dir_all(folder);
    let _ = both.save(folder.join(name).with_extension("png"));
}
