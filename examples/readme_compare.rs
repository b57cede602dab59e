//! Measures README's figure and table of what accuracy costs:
//! `cargo run --release --example readme_compare`. Writes `docs/accuracy-cost.svg` and the part of
//! `README.md` between `<!-- methods:begin -->` and `<!-- methods:end -->`; nothing is edited by hand.
//!
//! All samples of flat paint (of gradients and layers of pixels the reference is no truth) without text
//! (fonts differ from machine to machine), 512 pixels wide, on one thread;
//! errors are means over the drawings, times and ratios geometric means.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use toon_raster::compare::report::plot::{Mark, Plot, Series};
use toon_raster::compare::report::Circumstances;
use toon_raster::compare::{compare, Options, Record, Subject};
use toon_raster::reference;
use toon_raster::scene::load;
use toon_raster::{usvg, Scene, Viewport};

const WIDTH: u32 = 512;
const RUNS: usize = 9;
const BEGIN: &str = "<!-- methods:begin -->";
const END: &str = "<!-- methods:end -->";

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let drawings = drawings(root)?;
    let options = Options { runs: RUNS, threads: 1, ..Options::default() };
    let mut all = Vec::new();
    for (i, path) in drawings.iter().enumerate() {
        let name = path.strip_prefix(root)?.display().to_string();
        eprintln!("{} of {}: {name}", i + 1, drawings.len());
        all.push(records(path, name, &options)?);
    }
    let rows = summary(&all);
    std::fs::write(root.join("docs/accuracy-cost.svg"), plot(&rows).standalone())?;
    let readme = std::fs::read_to_string(root.join("README.md"))?;
    let (before, rest) = readme.split_once(BEGIN).ok_or("README.md has lost its marks")?;
    let (_, after) = rest.split_once(END).ok_or("README.md has lost its marks")?;
    let table = table(&rows, &all);
    std::fs::write(root.join("README.md"), format!("{before}{BEGIN}\n{table}{END}{after}"))?;
    print!("{table}");
    Ok(())
}

/// The samples of flat paint without text, in the order of their names.
fn drawings(root: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut paths = Vec::new();
    for folder in ["samples", "samples/corpus"] {
        for entry in std::fs::read_dir(root.join(folder))? {
            let path = entry?.path();
            let is_drawing = path.extension().is_some_and(|e| e == "svg" || e == "svgz");
            if is_drawing && is_flat(&std::fs::read(&path)?)? {
                paths.push(path);
            }
        }
    }
    paths.sort();
    Ok(paths)
}

/// None of the packed ones has any text.
fn is_flat(bytes: &[u8]) -> Result<bool, Box<dyn Error>> {
    if bytes.windows(5).any(|five| five == b"<text") {
        return Ok(false);
    }
    let tree = load::tree_from_bytes(bytes, &Default::default())?;
    Ok(reference::unsupported(&tree).is_empty() && !reference::has_gradients(&tree))
}

fn records(path: &Path, name: String, options: &Options) -> Result<Vec<Record>, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let parsing = Instant::now();
    let tree: usvg::Tree = load::tree_from_bytes(&bytes, &Default::default())?;
    let scene = Scene::from_tree(&tree)?;
    let parse = parsing.elapsed();
    let size = scene.size();
    let height = (size.height * f64::from(WIDTH) / size.width).round().max(1.0) as u32;
    let viewport = Viewport::fit(&scene, WIDTH, height);
    let subject = Subject { name, bytes: &bytes, tree: &tree, scene: &scene, viewport, parse };
    Ok(compare(&subject, options, &mut |_| {})?.records)
}

/// One method, over all drawings.
struct Row {
    method: String,
    /// Drawings that it could do.
    drawings: usize,
    ms: f64,
    times_exact: Option<f64>,
    times_tiny_skia: Option<f64>,
    mean: f64,
    rms: f64,
    max: f64,
    over_1: f64,
    over_16: f64,
    flip: f64,
    seams: f64,
}

/// The fastest first.
fn summary(all: &[Vec<Record>]) -> Vec<Row> {
    let methods = all.first().map_or(0, Vec::len);
    let mut rows: Vec<Row> =
        (0..methods).filter_map(|i| row(all.iter().map(|records| &records[i]))).collect();
    rows.sort_by(|a, b| a.ms.total_cmp(&b.ms));
    rows
}

fn row<'a>(records: impl Iterator<Item = &'a Record>) -> Option<Row> {
    let done: Vec<&Record> = records.filter(|record| record.error.is_some()).collect();
    let mean = |of: &dyn Fn(&Record) -> Option<f64>| {
        done.iter().filter_map(|record| of(record)).sum::<f64>() / done.len() as f64
    };
    let geometric = |of: &dyn Fn(&Record) -> Option<f64>| {
        let logs: Vec<f64> = done.iter().filter_map(|record| Some(of(record)?.ln())).collect();
        (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
    };
    Some(Row {
        method: done.first()?.method.clone(),
        drawings: done.len(),
        ms: geometric(&|r| Some(r.raster_ms?.median))?,
        times_exact: geometric(&|r| r.times.exact),
        times_tiny_skia: geometric(&|r| r.times.tiny_skia),
        mean: mean(&|r| Some(r.error?.mean)),
        rms: mean(&|r| Some(r.error?.rms)),
        max: done.iter().filter_map(|r| Some(r.error?.max)).fold(0.0, f64::max),
        over_1: 100.0 * mean(&|r| Some(r.error?.over_1)),
        over_16: 100.0 * mean(&|r| Some(r.error?.over_16)),
        flip: mean(&|r| r.error?.flip),
        seams: mean(&|r| Some(r.seams?.mean)),
    })
}

fn plot(rows: &[Row]) -> Plot {
    let mark = |row: &Row| Mark {
        x: row.ms,
        y: row.rms,
        label: row.method.clone(),
        title: format!("{}: {:.2} ms, rms {:.3} levels", row.method, row.ms, row.rms),
    };
    Plot {
        x_label: "time from scene to pixels, milliseconds (faster is left)".into(),
        y_label: "root mean square error, 8-bit levels (exact is down)".into(),
        series: vec![Series { name: String::new(), marks: rows.iter().map(mark).collect() }],
        front: true,
        title: "Error against time of every method; no method betters those on the dashed line in both"
            .into(),
        size: (860.0, 480.0),
    }
}

fn table(rows: &[Row], all: &[Vec<Record>]) -> String {
    let mut text = format!(
        "{}; {} drawings, {WIDTH} px wide, 1 thread, median of {RUNS} interleaved runs.\n\n",
        Circumstances::here(std::iter::empty()).line(),
        all.len()
    );
    text += "| method | ms | ÷ exact | ÷ tiny-skia | mean error | rms | worst | > 1 level | > 16 levels | FLIP | seams |\n";
    text += "|---|---|---|---|---|---|---|---|---|---|---|\n";
    for row in rows {
        let ratio = |ratio: Option<f64>| ratio.map_or("–".to_string(), |r| format!("{r:.2}"));
        let few = match row.drawings {
            n if n < all.len() => format!(" ({n} drawings)"),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "| `{}`{few} | {:.2} | {} | {} | {:.3} | {:.3} | {:.1} | {:.2}% | {:.2}% | {:.4} | {:.3} |",
            row.method,
            row.ms,
            ratio(row.times_exact),
            ratio(row.times_tiny_skia),
            row.mean,
            row.rms,
            row.max,
            row.over_1,
            row.over_16,
            row.flip,
            row.seams
        );
    }
    text
}
