//! Takes folders of drawings, makes a verdict on each: renders every SVG and svgz and holds it
//! against the truth. Drawings with something the truth leaves out are skipped by name, and
//! those with gradients, for which it is slow, but with `--gradients`.
//!
//! ```text
//! cargo run --release --example corpus_check -- DIR... [--size N] [--stroker kurbo|pieces]
//!     [--gradients] [--truth-only] [--strokers] [--resvg N]
//! ```
//!
//! `--size` is the width in pixels (256). Ways to look at the truth itself: `--truth-only`
//! compares nothing but its own rounding; `--strokers` compares the two strokers; `--resvg N` puts resvg's picture, N times as large and
//! filtered down, in the place of ours (it nears the truth as N grows).

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use toon_raster::reference::{self, Bounds, Difference, Stroker, Truth};
use toon_raster::{Pixmap, Renderer, Scene, Settings, Viewport};

struct Arguments {
    folders: Vec<PathBuf>,
    width: u32,
    stroker: Stroker,
    gradients: bool,
    truth_only: bool,
    both_strokers: bool,
    resvg_times: Option<u32>,
}

fn main() {
    let arguments = match arguments() {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("corpus_check: {message}");
            std::process::exit(2);
        }
    };
    let mut files = Vec::new();
    arguments.folders.iter().for_each(|folder| find_drawings(folder, &mut files));
    files.sort();
    println!("verdict  edges     width height     max    mean  floor  over 1    worst pixel   render ms  truth ms  file");
    let mut tally = Tally::default();
    for file in &files {
        match check(file, &arguments) {
            Ok(checked) => tally.add(file, &checked),
            Err(reason) => {
                tally.skipped += 1;
                println!("skipped  {}: {reason}", file.display());
            }
        }
    }
    tally.print();
    std::process::exit(i32::from(tally.failed > 0));
}

fn arguments() -> Result<Arguments, String> {
    let mut parsed = Arguments {
        folders: Vec::new(),
        width: 256,
        stroker: Stroker::default(),
        gradients: false,
        truth_only: false,
        both_strokers: false,
        resvg_times: None,
    };
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        let mut value = || given.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--size" => {
                let width = value()?.parse().ok().filter(|w| (1..=8192).contains(w));
                parsed.width = width.ok_or("--size is a number of pixels from 1 to 8192")?;
            }
            "--stroker" => {
                parsed.stroker = match value()?.as_str() {
                    "kurbo" => Stroker::Kurbo,
                    "pieces" => Stroker::Pieces,
                    _ => return Err("--stroker is kurbo or pieces".into()),
                }
            }
            "--resvg" => {
                let times = value()?.parse().ok().filter(|times| (1..=64).contains(times));
                parsed.resvg_times = Some(times.ok_or("--resvg is a number from 1 to 64")?);
            }
            "--strokers" => parsed.both_strokers = true,
            "--gradients" => parsed.gradients = true,
            "--truth-only" => parsed.truth_only = true,
            flag if flag.starts_with("--") => return Err(format!("there is no {flag}")),
            folder => parsed.folders.push(folder.into()),
        }
    }
    if parsed.folders.is_empty() {
        return Err("name at least one folder or file".into());
    }
    Ok(parsed)
}

/// All .svg and .svgz below `path`, or `path` itself.
fn find_drawings(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_dir() {
        match std::fs::read_dir(path) {
            Ok(entries) => entries.flatten().for_each(|entry| find_drawings(&entry.path(), files)),
            Err(error) => eprintln!("corpus_check: {}: {error}", path.display()),
        }
    } else if path.extension().is_some_and(|e| e == "svg" || e == "svgz") {
        files.push(path.to_owned());
    }
}

struct Checked {
    straight: bool,
    difference: Difference,
    passes: bool,
    /// The truth against its own rounding: what no 8-bit picture can better by much.
    floor: Difference,
    truth: Truth,
    render_time: Duration,
    truth_time: Duration,
}

/// `Err` says why the file is skipped.
fn check(file: &Path, arguments: &Arguments) -> Result<Checked, String> {
    let bytes = std::fs::read(file).map_err(|error| error.to_string())?;
    // usvg panics on some hostile files and reads whatever an image refers to, without end if it is
    // a device; neither is what is checked here.
    let parsed = std::panic::catch_unwind(|| {
        let mut options = usvg::Options::default();
        options.image_href_resolver.resolve_string = Box::new(|_, _| None);
        usvg::Tree::from_data(&bytes, &options)
    });
    let tree = parsed.map_err(|_| "usvg panics")?.map_err(|error| error.to_string())?;
    let unsupported = reference::unsupported(&tree);
    if let Some(first) = unsupported.first() {
        let kinds: Vec<&str> = unsupported.iter().map(|u| u.kind).collect();
        return Err(format!("has {} (first: '{}')", kinds.join(", "), first.element));
    }
    if !arguments.gradients && reference::has_gradients(&tree) {
        return Err("has gradients".into());
    }
    if tree.has_text_nodes() {
        return Err("has text, which depends on the fonts".into());
    }
    let scene = Scene::from_tree(&tree).map_err(|error| error.to_string())?;
    let height = f64::from(arguments.width) * scene.size().height / scene.size().width;
    if height.is_nan() || height > 16384.0 {
        return Err("is too high for its width".into());
    }
    let viewport = Viewport::fit(&scene, arguments.width, (height.round() as u32).max(1));

    let start = Instant::now();
    let options = reference::Options { stroker: arguments.stroker, ..Default::default() };
    let truth = reference::render(&tree, &viewport, &options).map_err(|error| error.to_string())?;
    let truth_time = start.elapsed();

    let start = Instant::now();
    let picture = match arguments.resvg_times {
        Some(times) => resvg_filtered_down(&tree, &viewport, times)?,
        None if arguments.both_strokers => {
            let other = match arguments.stroker {
                Stroker::Kurbo => Stroker::Pieces,
                Stroker::Pieces => Stroker::Kurbo,
            };
            let options = reference::Options { stroker: other, ..options };
            reference::render(&tree, &viewport, &options).map_err(|error| error.to_string())?.to_pixmap()
        }
        None if arguments.truth_only => truth.to_pixmap(),
        None => render(&scene, &viewport)?,
    };
    let render_time = start.elapsed();
    let difference = truth.compare(&picture);
    Ok(Checked {
        straight: reference::edges_are_straight(&tree),
        difference,
        passes: Bounds::of(&tree, &truth).hold(&difference),
        floor: truth.compare(&truth.to_pixmap()),
        truth,
        render_time,
        truth_time,
    })
}

fn render(scene: &Scene, viewport: &Viewport) -> Result<Pixmap, String> {
    let mut renderer = Renderer::new(Settings::default()).map_err(|error| error.to_string())?;
    renderer.render(scene, viewport).map_err(|error| error.to_string())
}

/// resvg's picture `times` as large, each pixel the mean of its `times` x `times`.
fn resvg_filtered_down(tree: &usvg::Tree, viewport: &Viewport, times: u32) -> Result<Pixmap, String> {
    let (width, height) = (viewport.width * times, viewport.height * times);
    let mut large = resvg::tiny_skia::Pixmap::new(width, height).ok_or("is too large for resvg")?;
    let [a, b, c, d, e, f] = viewport.transform.as_coeffs().map(|value| (value * f64::from(times)) as f32);
    resvg::render(tree, resvg::tiny_skia::Transform::from_row(a, b, c, d, e, f), &mut large.as_mut());
    let mut sums = vec![[0u64; 4]; viewport.width as usize * viewport.height as usize];
    for (at, pixel) in large.pixels().iter().enumerate() {
        let (x, y) = (at as u32 % width / times, at as u32 / width / times);
        let levels = [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()];
        let sum = &mut sums[(y * viewport.width + x) as usize];
        sum.iter_mut().zip(levels).for_each(|(sum, level)| *sum += u64::from(level));
    }
    let mut picture = Pixmap::new(viewport.width, viewport.height);
    for (bytes, sum) in picture.data_mut().chunks_exact_mut(4).zip(sums) {
        let alpha = sum[3].max(1) as f64;
        for c in 0..3 {
            bytes[c] = (sum[c] as f64 / alpha * 255.0).round() as u8;
        }
        bytes[3] = (sum[3] as f64 / f64::from(times * times)).round() as u8;
    }
    Ok(picture)
}

#[derive(Default)]
struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
    worst: f64,
    worst_mean: f64,
    means: f64,
    truth_time: Duration,
    render_time: Duration,
    approximate: usize,
    area_defect: f64,
}

impl Tally {
    fn add(&mut self, file: &Path, checked: &Checked) {
        let Difference { max, mean, worst, over_1, .. } = checked.difference;
        let passes = checked.passes;
        println!(
            "{}  {}  {:>5}  {:>5}  {max:>6.2}  {mean:>6.4} {:>6.4}  {:>5.2}%  {:>13}  {:>10.1}  {:>8.0}  {}{}",
            if passes { "PASS   " } else { "FAIL   " },
            if checked.straight { "straight" } else { "curved  " },
            checked.truth.width(),
            checked.truth.height(),
            checked.floor.mean,
            over_1 * 100.0,
            format!("({}, {})", worst.0, worst.1),
            checked.render_time.as_secs_f64() * 1e3,
            checked.truth_time.as_secs_f64() * 1e3,
            file.display(),
            if checked.truth.approximate > 0 {
                format!(" (truth approximate in {} pixels)", checked.truth.approximate)
            } else {
                String::new()
            },
        );
        self.passed += usize::from(passes);
        self.failed += usize::from(!passes);
        self.worst = self.worst.max(max);
        self.worst_mean = self.worst_mean.max(mean);
        self.means += mean;
        self.truth_time += checked.truth_time;
        self.render_time += checked.render_time;
        self.approximate += checked.truth.approximate;
        self.area_defect = self.area_defect.max(checked.truth.area_defect);
    }

    fn print(&self) {
        let checked = self.passed + self.failed;
        println!(
            "\n{checked} drawings compared: {} passed, {} failed; {} skipped",
            self.passed, self.failed, self.skipped
        );
        println!(
            "worst error {:.2}, worst mean {:.4}, mean of means {:.4} levels",
            self.worst,
            self.worst_mean,
            self.means / checked.max(1) as f64
        );
        println!(
            "rendered in {:.2} s, truth in {:.1} s ({} pixels approximate, areas sum to 1 within {:.1e})",
            self.render_time.as_secs_f64(),
            self.truth_time.as_secs_f64(),
            self.approximate,
            self.area_defect
        );
    }
}
