//! Takes folders of drawings with a picture beside each (`NAME.svg`, `NAME.png`), makes the pass rate of
//! every folder: a drawing passes when its picture, rendered at the size of the given one, is the same
//! after a blur of 3 x 3 pixels within 24 levels everywhere and 1 level in the mean. The blur allows
//! for better edges. Where that is not enough (thin strokes), a drawing of flat paint also passes if it
//! is exact by this library's own reference, which shares no code with the renderer; such passes are
//! counted apart.
//!
//! ```text
//! cargo run --release --example conformance -- DIR... [--fonts DIR] [--list] [--write DIR]
//! ```
//!
//! `--list` names every failure with its figures; `--write` writes ours and theirs side by side for each.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toon_raster::reference::{self, Bounds};
use toon_raster::scene::load;
use toon_raster::{FontSource, Options, Pixmap, Renderer, Scene, Settings, Viewport};

/// The most that any channel may be off after the blur, in levels.
const MAX: f64 = 24.0;
/// The most that all channels may be off in the mean.
const MEAN: f64 = 1.0;

#[derive(Default)]
struct Arguments {
    folders: Vec<PathBuf>,
    fonts: Option<PathBuf>,
    list: bool,
    write: Option<PathBuf>,
}

fn main() {
    let mut arguments = Arguments::default();
    let mut given = std::env::args_os().skip(1);
    while let Some(argument) = given.next() {
        match argument.to_str() {
            Some("--fonts") => arguments.fonts = given.next().map(PathBuf::from),
            Some("--list") => arguments.list = true,
            Some("--write") => arguments.write = given.next().map(PathBuf::from),
            _ => arguments.folders.push(argument.into()),
        }
    }
    if arguments.folders.is_empty() {
        eprintln!("conformance: name at least one folder");
        std::process::exit(2);
    }
    let mut files = Vec::new();
    arguments.folders.iter().for_each(|folder| find(folder, &mut files));
    files.sort();
    let mut folders: BTreeMap<PathBuf, (usize, usize)> = BTreeMap::new();
    let mut exact = 0;
    for file in &files {
        let verdict = judge(file, &arguments);
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        let (passed, all) = folders.entry(folder).or_default();
        *all += 1;
        match verdict {
            Ok(Pass::Alike) => *passed += 1,
            Ok(Pass::Exact) => {
                *passed += 1;
                exact += 1;
                if arguments.list {
                    println!("exact, unlike the picture: {}", file.display());
                }
            }
            Err(reason) if arguments.list => println!("FAIL {}: {reason}", file.display()),
            Err(_) => {}
        }
    }
    for (folder, (passed, all)) in &folders {
        println!("{passed:5} of {all:5}  {:5.1}%  {}", percent(*passed, *all), folder.display());
    }
    let (passed, all) = folders.values().fold((0, 0), |(p, a), (q, b)| (p + q, a + b));
    println!(
        "{passed:5} of {all:5}  {:5.1}%  in all, {exact} of them by the reference",
        percent(passed, all)
    );
}

fn percent(passed: usize, all: usize) -> f64 {
    100.0 * passed as f64 / all.max(1) as f64
}

/// Drawings with a picture beside them.
fn find(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        eprintln!("conformance: {} cannot be read", folder.display());
        return;
    };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            find(&path, files);
        } else if path.extension().is_some_and(|e| e == "svg") && path.with_extension("png").exists() {
            files.push(path);
        }
    }
}

enum Pass {
    /// Like the picture beside it.
    Alike,
    /// Like the truth, where the picture is not.
    Exact,
}

fn judge(file: &Path, arguments: &Arguments) -> Result<Pass, String> {
    let theirs = image::open(file.with_extension("png")).map_err(|e| e.to_string())?.to_rgba8();
    let bytes = std::fs::read(file).map_err(|e| e.to_string())?;
    let mut options = Options::default();
    options.usvg.resources_dir = file.parent().map(Path::to_path_buf);
    if let Some(fonts) = &arguments.fonts {
        options.fonts = fonts_of(fonts);
    }
    let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| -> Result<_, String> {
        let scene = Scene::from_bytes(&bytes, &options).map_err(|e| e.to_string())?;
        let viewport = Viewport::fit(&scene, theirs.width(), theirs.height());
        let mut renderer = Renderer::new(Settings::default()).map_err(|e| e.to_string())?;
        let picture = renderer.render(&scene, &viewport).map_err(|e| e.to_string())?;
        let warnings: Vec<&str> = scene.warnings().iter().map(|warning| warning.kind).collect();
        Ok((image::RgbaImage::from(picture), warnings.join(", ")))
    }));
    let (ours, warnings) = made.map_err(|_| "internal error".to_string())??;
    let (max, mean) = difference(&blurred(&ours), &blurred(&theirs));
    if max <= MAX && mean <= MEAN {
        return Ok(Pass::Alike);
    }
    if is_exact(&bytes, &options, &ours) == Some(true) {
        return Ok(Pass::Exact);
    }
    if let Some(folder) = &arguments.write {
        write_both(folder, file, &ours, &theirs);
    }
    let warned = if warnings.is_empty() { String::new() } else { format!("; not drawn: {warnings}") };
    Err(format!("max {max:.0}, mean {mean:.2}{warned}"))
}

/// Is the picture as exact as the renderer promises? `None` where the reference cannot tell.
fn is_exact(bytes: &[u8], options: &Options, ours: &image::RgbaImage) -> Option<bool> {
    let tree = load::tree_from_bytes(bytes, options).ok()?;
    if !reference::unsupported(&tree).is_empty() || reference::has_gradients(&tree) {
        return None;
    }
    let scene = Scene::from_tree(&tree).ok()?;
    let viewport = Viewport::fit(&scene, ours.width(), ours.height());
    let truth = reference::render(&tree, &viewport, &reference::Options::default()).ok()?;
    let mut picture = Pixmap::new(ours.width(), ours.height());
    picture.data_mut().copy_from_slice(ours);
    Some(Bounds::of(&tree, &truth).hold(&truth.compare(&picture)))
}

/// The fonts of a folder, with the families that the resvg suite is drawn with.
fn fonts_of(folder: &Path) -> FontSource {
    let folder = folder.to_path_buf();
    FontSource::new(move || {
        let mut fonts = toon_raster::usvg::fontdb::Database::new();
        fonts.load_fonts_dir(&folder);
        fonts.set_sans_serif_family("Noto Sans");
        fonts.set_serif_family("Noto Serif");
        fonts.set_cursive_family("Yellowtail");
        fonts.set_fantasy_family("Sedgwick Ave Display");
        fonts.set_monospace_family("Noto Mono");
        fonts
    })
}

/// Premultiplied levels, each the mean of 3 x 3 pixels.
fn blurred(picture: &image::RgbaImage) -> Vec<[f64; 4]> {
    let (width, height) = (picture.width() as i64, picture.height() as i64);
    let at = |x: i64, y: i64| {
        let [r, g, b, a] =
            picture.get_pixel(x.clamp(0, width - 1) as u32, y.clamp(0, height - 1) as u32).0.map(f64::from);
        [r * a / 255.0, g * a / 255.0, b * a / 255.0, a]
    };
    let mean = |x: i64, y: i64| {
        let mut sum = [0.0; 4];
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            sum.iter_mut().zip(at(x + dx, y + dy)).for_each(|(sum, v)| *sum += v / 9.0);
        }
        sum
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect()
}

fn difference(one: &[[f64; 4]], other: &[[f64; 4]]) -> (f64, f64) {
    let off = one.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs());
    let (max, sum) = off.fold((0.0f64, 0.0), |(max, sum), v| (max.max(v), sum + v));
    (max, sum / (4 * one.len().max(1)) as f64)
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
