//! Takes measured rows, makes a table for people and JSON for scripts.

use super::measure::{Row, Times};
use std::fmt::Write;

/// Titles and widths of the columns behind scene, size and threads.
const COLUMNS: [(&str, usize); 16] = [
    ("tiny-skia", 9),
    ("vello", 8),
    ("exact", 8),
    ("mask", 8),
    ("mask64", 8),
    ("E/S", 6),
    ("E/V", 6),
    ("M/E", 6),
    ("M/V", 6),
    ("M64/E", 6),
    ("M64/V", 6),
    ("min S", 8),
    ("min V", 8),
    ("min E", 8),
    ("min M", 8),
    ("min M64", 8),
];

pub fn heading(check: bool) -> String {
    let mut line = format!("{:<14} {:>9} {:>3}", "scene", "size", "thr");
    for (title, width) in COLUMNS {
        write!(line, " {title:>width$}").expect("a string takes all");
    }
    if check {
        line += "   vello-S  exact-S";
    }
    line
}

/// Medians in milliseconds, their ratios, and the shortest times.
pub fn line(row: &Row) -> String {
    let size = format!("{}x{}", row.width, row.height);
    let mut line = format!("{:<14} {size:>9} {:>3}", row.scene, row.threads);
    let times = [row.tiny_skia, row.vello, row.exact, row.mask, row.mask64];
    let ratios = RATIOS.map(|(_, ratio)| ratio(row));
    let figures = times.iter().map(|t| t.median).chain(ratios).chain(times.iter().map(|t| t.min));
    for (figure, (_, width)) in figures.zip(COLUMNS) {
        write!(line, " {figure:>width$.2}").expect("a string takes all");
    }
    if let Some(d) = row.differences {
        write!(line, "  {:>8.3} {:>8.3}", d.vello, d.exact).expect("a string takes all");
    }
    line
}

/// One median time in another.
type Ratio = fn(&Row) -> f64;

/// The ratios of medians, in the order of their columns.
const RATIOS: [(&str, Ratio); 6] = [
    ("exact/tiny-skia", Row::exact_to_tiny_skia),
    ("exact/vello", Row::exact_to_vello),
    ("mask/exact", Row::mask_to_exact),
    ("mask/vello", Row::mask_to_vello),
    ("mask64/exact", Row::mask64_to_exact),
    ("mask64/vello", Row::mask64_to_vello),
];

/// One line for each size and number of threads: the geometric means of the ratios over its scenes.
pub fn means(rows: &[Row]) -> String {
    let mut text = String::from("geometric means of the ratios\n");
    let mut seen = Vec::new();
    for row in rows {
        let longest = |r: &Row| r.width.max(r.height);
        let key = (longest(row), row.threads);
        if seen.contains(&key) {
            continue;
        }
        seen.push(key);
        let group: Vec<&Row> = rows.iter().filter(|r| (longest(r), r.threads) == key).collect();
        let mean =
            |ratio: Ratio| (group.iter().map(|r| ratio(r).ln()).sum::<f64>() / group.len() as f64).exp();
        let ratios = RATIOS.map(|(name, ratio)| format!("{name} {:.3}", mean(ratio))).join(", ");
        writeln!(text, "  {} px, {} thread(s), {} scene(s): {ratios}", key.0, key.1, group.len())
            .expect("a string takes all");
    }
    text
}

/// Where the exact method's time goes, and what it counted.
pub fn stages(rows: &[Row]) -> String {
    let mut text = String::from("exact by stage: milliseconds, summed over threads\n");
    for row in rows.iter().filter(|r| !r.stages.is_empty() || !r.counts.is_empty()) {
        let total: f64 = row.stages.iter().map(|(_, time)| time).sum();
        write!(text, "  {} {} px, {} thr:", row.scene, row.width.max(row.height), row.threads)
            .expect("a string takes all");
        for (name, time) in &row.stages {
            let share = 100.0 * time / total.max(f64::MIN_POSITIVE);
            write!(text, "  {name} {time:.2} ({share:.0}%)").expect("a string takes all");
        }
        if !row.counts.is_empty() {
            write!(text, "\n     ").expect("a string takes all");
        }
        for (name, count) in &row.counts {
            write!(text, " {name} {count}").expect("a string takes all");
        }
        text.push('\n');
    }
    text
}

/// The same figures as one JSON object: `machine`, and `results` with one object a row.
pub fn json(machine: &str, rows: &[Row]) -> String {
    let results: Vec<String> = rows.iter().map(row_json).collect();
    format!("{{\"machine\": {}, \"results\": [\n{}\n]}}\n", quoted(machine), results.join(",\n"))
}

fn row_json(row: &Row) -> String {
    let stages: Vec<String> = row.stages.iter().map(|(n, ms)| format!("{}: {ms:.4}", quoted(n))).collect();
    let counts: Vec<String> = row.counts.iter().map(|(n, count)| format!("{}: {count}", quoted(n))).collect();
    let mut text = format!(
        "  {{\"scene\": {}, \"width\": {}, \"height\": {}, \"threads\": {}, \"runs\": {}, \"tiny_skia_ms\": {}, \
         \"vello_ms\": {}, \"exact_ms\": {}, \"mask_ms\": {}, \"mask64_ms\": {}, \"exact_to_tiny_skia\": {:.4}, \"exact_to_vello\": {:.4}, \
         \"stages_ms\": {{{}}}, \"counts\": {{{}}}",
        quoted(&row.scene),
        row.width,
        row.height,
        row.threads,
        row.runs,
        times_json(row.tiny_skia),
        times_json(row.vello),
        times_json(row.exact),
        times_json(row.mask),
        times_json(row.mask64),
        row.exact_to_tiny_skia(),
        row.exact_to_vello(),
        stages.join(", "),
        counts.join(", "),
    );
    if let Some(d) = row.differences {
        write!(text, ", \"mean_difference\": {{\"vello\": {:.4}, \"exact\": {:.4}}}", d.vello, d.exact)
            .expect("a string takes all");
    }
    text + "}"
}

fn times_json(times: Times) -> String {
    format!("{{\"median\": {:.4}, \"min\": {:.4}, \"max\": {:.4}}}", times.median, times.min, times.max)
}

fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c < ' ' => write!(out, "\\u{:04x}", c as u32).expect("a string takes all"),
            c => out.push(c),
        }
    }
    out + "\""
}
