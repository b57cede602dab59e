//! The compare job: every method on every input, to a table on standard output, JSON and a page.

use super::output::Output;
use super::places::{Source, Target};
use super::report::{self, Failure, Progress, Voice};
use super::size::{self, Fit, Part};
use super::values::ProgressStyle;
use super::{input, parser_log, render, view};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use toon_raster::compare::report::{Circumstances, Page};
use toon_raster::compare::{against, compare, steps, Comparison, Record, Subject};
use toon_raster::scene::load;
use toon_raster::{compare, Pixmap, Scene};

/// Every method on some drawings.
pub struct CompareJob {
    pub inputs: Vec<Source>,
    /// Other renderers' pictures.
    pub against: Vec<PathBuf>,
    pub reading: toon_raster::Options,
    /// Where relative links start from; `None` for each drawing's own folder.
    pub resources_dir: Option<PathBuf>,
    pub fit: Fit,
    pub max_pixels: u64,
    pub options: compare::Options,
    pub json: Option<PathBuf>,
    pub report: Option<PathBuf>,
    pub voice: Voice,
    pub progress: ProgressStyle,
}

/// Does it.
pub fn run(job: CompareJob) -> ExitCode {
    render::on_a_deep_stack(|| run_here(job))
}

fn run_here(mut job: CompareJob) -> ExitCode {
    for path in &job.against {
        match picture(path) {
            Ok(picture) => job.options.against.push((path.display().to_string(), picture)),
            Err(failure) => {
                report::failure(&path.display().to_string(), &failure);
                return report::exit_code(1, &[failure]);
            }
        }
    }
    // Before the work: it may take minutes, and its figures would be lost.
    let json = job.json.clone().map(|path| (path.display().to_string(), json_output(&path)));
    let html = job.report.clone().map(|folder| (folder.display().to_string(), page_output(&folder)));
    let (json, html) = match (opened(json), opened(html)) {
        (Ok(json), Ok(html)) => (json, html),
        (Err(failure), _) | (_, Err(failure)) => return report::exit_code(1, &[failure]),
    };
    let inputs = std::mem::take(&mut job.inputs);
    let mut progress = Progress::new(job.progress, inputs.len() * steps(&job.options));
    let mut page = Page::new(Circumstances::here(std::env::args_os()));
    let mut records = Vec::new();
    let mut failures = Vec::new();
    for source in &inputs {
        match report::catching(|| one(&mut job, source, &mut progress)) {
            Ok(comparison) => {
                progress.clear();
                if job.json.as_deref() != Some(Path::new("-")) {
                    report::print(&table(&comparison));
                }
                if job.report.is_some() {
                    page.add(&comparison);
                }
                records.extend(comparison.records);
            }
            Err(failure) => {
                progress.clear();
                report::failure(&source.name(), &failure);
                failures.push(failure);
            }
        }
    }
    if !records.is_empty() {
        let json = json.map(|(name, output)| (name, write_json(output, &records)));
        let html = html.map(|(name, output)| (name, write(output, &[page.finish().as_bytes()])));
        for (name, written) in [json, html].into_iter().flatten() {
            if let Err(failure) = written {
                report::failure(&name, &failure);
                failures.push(failure);
            }
        }
    }
    report::exit_code(inputs.len(), &failures)
}

fn one(job: &mut CompareJob, source: &Source, progress: &mut Progress) -> Result<Comparison, Failure> {
    let bytes = input::read(source)?;
    job.reading.usvg.resources_dir = job.resources_dir.clone().or_else(|| view::folder_of(source));
    parser_log::begin();
    let parsing = Instant::now();
    let (tree, unmatched) = load::tree_and_warnings(&bytes, &job.reading)?;
    let viewport = size::viewport(&tree, &Part::Page, job.fit, job.max_pixels)?;
    let scene = Scene::from_tree(&tree)?;
    let parse = parsing.elapsed();
    let name = source.name();
    view::warn(&name, &scene, &unmatched, job.voice);
    let subject = Subject { name: name.clone(), bytes: &bytes, tree: &tree, scene: &scene, viewport, parse };
    let mut under_way = false;
    let compared = compare(&subject, &job.options, &mut |what| {
        if std::mem::replace(&mut under_way, true) {
            progress.tick(&name, true);
        }
        progress.begin(what);
    })?;
    progress.tick(&name, true);
    match compared.records.iter().find(|record| record.failed.is_none()) {
        Some(_) => Ok(compared),
        None => {
            let why = compared.records.first().and_then(|r| r.failed.clone()).unwrap_or_default();
            Err(Failure::input(format!("no method can do it: {why}")))
        }
    }
}

fn picture(path: &Path) -> Result<Pixmap, Failure> {
    let bytes = input::read(&Source::File(path.to_path_buf()))?;
    Ok(against::decode(&bytes)?)
}

/// An output by its name; that it cannot be written to is told.
fn opened(output: Option<(String, Result<Output, Failure>)>) -> Result<Option<(String, Output)>, Failure> {
    match output {
        None => Ok(None),
        Some((name, Ok(output))) => Ok(Some((name, output))),
        Some((name, Err(failure))) => {
            report::failure(&name, &failure);
            Err(failure)
        }
    }
}

fn json_output(path: &Path) -> Result<Output, Failure> {
    Output::create(&match path == Path::new("-") {
        true => Target::Stdout,
        false => Target::File(path.to_path_buf()),
    })
}

fn page_output(folder: &Path) -> Result<Output, Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::io(format!("the folder cannot be made: {e}")))?;
    Output::create(&Target::File(folder.join("index.html")))
}

fn write_json(output: Output, records: &[Record]) -> Result<(), Failure> {
    let json = serde_json::to_vec_pretty(records).map_err(|e| Failure::io(format!("no JSON: {e}")))?;
    write(output, &[&json, b"\n"])
}

fn write(mut output: Output, parts: &[&[u8]]) -> Result<(), Failure> {
    for part in parts {
        output.write_all(part).map_err(|e| output.failure(&e))?;
    }
    output.commit()
}

// ----------------------------------------------------------------------------------------- table

/// Heads and widths of the columns; the first is as wide as its longest name.
const COLUMNS: [(&str, usize); 13] = [
    ("ms", 9),
    ("±", 7),
    ("x exact", 8),
    ("mean", 7),
    ("rms", 7),
    ("worst", 7),
    (">.5 %", 7),
    (">1 %", 7),
    (">4 %", 7),
    (">16 %", 7),
    ("psnr", 6),
    ("flip", 7),
    ("seam", 7),
];

/// All figures of one drawing, for a terminal of 120 columns.
fn table(comparison: &Comparison) -> String {
    let Some(first) = comparison.records.first() else { return String::new() };
    let name_width = comparison.records.iter().map(|r| r.method.chars().count()).max().unwrap_or(0).max(6);
    let threads =
        if first.threads == 1 { "1 thread".to_string() } else { format!("{} threads", first.threads) };
    let mut text = format!("{}: {} x {} pixels, {threads}\n", first.input, first.width, first.height);
    let _ = write!(text, "{:name_width$}", "method");
    for (head, width) in COLUMNS {
        let _ = write!(text, "{head:>width$}");
    }
    text.push('\n');
    for record in &comparison.records {
        let _ = writeln!(text, "{:name_width$}{}", record.method, row(record));
    }
    let _ = writeln!(
        text,
        "errors in 8-bit levels; ±: half of the runs lie within it; seam: mean error where the truth is flat"
    );
    let about = &first.reference;
    let kept = if about.cached { " (kept)" } else { "" };
    let _ = write!(
        text,
        "reference: {:.0} ms{kept}; each edge within {:.2} levels",
        about.ms, about.tolerance_levels
    );
    for own in &about.own_error {
        let _ = write!(text, "; {:.4} mean, {:.3} at most from one with {}", own.mean, own.max, own.against);
    }
    if about.approximate_pixels > 0 {
        let _ = write!(text, "; approximate in {} pixels", about.approximate_pixels);
    }
    text.push('\n');
    if !about.leaves_out.is_empty() {
        let _ = writeln!(text, "reference: leaves out {}", about.leaves_out.join(", "));
    }
    pans(comparison, name_width, &mut text);
    for record in &comparison.records {
        for note in &record.notes {
            let _ = writeln!(text, "{}: {note}", record.method);
        }
    }
    text.push('\n');
    text
}

fn row(record: &Record) -> String {
    let Some(error) = &record.error else {
        return format!("  {}", record.failed.as_deref().unwrap_or("not measured"));
    };
    let number =
        |value: Option<f64>, digits: usize| value.map_or("-".to_string(), |v| format!("{v:.digits$}"));
    let percent = |share: f64| Some(100.0 * share);
    let cells = [
        number(record.raster_ms.map(|s| s.median), 2),
        number(record.raster_ms.map(|s| s.spread), 2),
        number(record.times.exact, 2),
        number(Some(error.mean), 3),
        number(Some(error.rms), 3),
        number(Some(error.max), 2),
        number(percent(error.over_half), 2),
        number(percent(error.over_1), 2),
        number(percent(error.over_4), 2),
        number(percent(error.over_16), 2),
        number(error.psnr, 1),
        number(error.flip, 4),
        number(record.seams.map(|s| s.mean), 3),
    ];
    cells.iter().zip(COLUMNS).map(|(cell, (_, width))| format!("{cell:>width$}")).collect()
}

fn pans(comparison: &Comparison, name_width: usize, text: &mut String) {
    let panned: Vec<_> =
        comparison.records.iter().filter_map(|r| Some((&r.method, r.pan.as_ref()?))).collect();
    let Some((_, first)) = panned.first() else { return };
    let _ = writeln!(
        text,
        "in motion, one pixel in {} steps: light gained or lost a step (fully lit pixels), flicker (levels)",
        first.steps
    );
    let _ = writeln!(
        text,
        "{:name_width$}{:>11}{:>11}{:>11}{:>11}{:>11}",
        "method", "light", "at most", "flicker", "at most", ">4 %"
    );
    for (method, pan) in panned {
        let _ = writeln!(
            text,
            "{method:name_width$}{:>11.4}{:>11.4}{:>11.3}{:>11.2}{:>11.2}",
            pan.light_step,
            pan.light_step_max,
            pan.flicker,
            pan.flicker_max,
            100.0 * pan.flicker_over_4
        );
    }
}
