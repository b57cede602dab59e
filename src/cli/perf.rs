//! Takes the times of one picture, makes a table or one JSON object, on standard error.

use super::values::PerfStyle;
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;
use toon_raster::{EffectRuns, LitSurface, Stages};

/// Times of one picture. Where encoding overlaps rasterizing, both count in full.
#[derive(Clone, Debug, Default)]
pub struct Perf {
    pub input: String,
    pub output: String,
    pub width: u32,
    pub height: u32,
    pub threads: usize,
    /// Getting the bytes.
    pub read: Duration,
    /// Unpacking, XML, fonts, SVG, scene.
    pub parse: Duration,
    /// Scene to pixels.
    pub raster: Duration,
    /// Pixels to bytes of the file, and writing them.
    pub encode: Duration,
    /// From reading to the file's name.
    pub total: Duration,
    pub stages: Stages,
}

impl Perf {
    pub fn print(&self, style: PerfStyle) {
        let text = match style {
            PerfStyle::Text => self.table(),
            PerfStyle::Json => self.json(),
        };
        let _ = writeln!(std::io::stderr(), "{text}");
    }

    fn times(&self) -> [(&'static str, Duration); 5] {
        [
            ("read", self.read),
            ("parse", self.parse),
            ("raster", self.raster),
            ("encode", self.encode),
            ("total", self.total),
        ]
    }

    fn table(&self) -> String {
        let Perf { input, output, width, height, threads, .. } = self;
        let mut text = format!("{input} -> {output}: {width} x {height} pixels, {threads} threads");
        for (name, time) in self.times() {
            let _ = write!(text, "\n{name:>24} {:>10.3} ms", ms(time));
            if name == "raster" {
                for (stage, time) in &self.stages.times {
                    let _ = write!(text, "\n{stage:>24} {:>10.3} ms, all threads", ms(*time));
                }
            }
        }
        for EffectRuns { name, runs, time } in &self.stages.effects {
            let _ = match time.is_zero() {
                true => write!(text, "\n{name:>24} {runs:>10} x"),
                false => write!(text, "\n{name:>24} {:>10.3} ms, {runs} x", ms(*time)),
            };
        }
        for (counter, value) in &self.stages.counts {
            let _ = write!(text, "\n{counter:>24} {value:>10}");
        }
        for lit in self.stages.lit.iter().filter(|lit| lit.aliasing > 0) {
            let LitSurface { filter, exponent, pixels, aliasing, .. } = lit;
            let _ = write!(
                text,
                "\n{:>24} {aliasing:>10} of {pixels} pixels in '{filter}' (exponent {exponent}): {} samples a \
                 side would cure it",
                "highlight aliasing",
                samples_a_side(lit)
            );
        }
        if let Some(kib) = peak_memory_kib() {
            let _ = write!(text, "\n{:>24} {kib:>10} KiB", "peak memory");
        }
        text
    }

    fn json(&self) -> String {
        let Perf { width, height, threads, .. } = self;
        let mut text = format!(
            r#"{{"input":{},"output":{},"width":{width},"height":{height},"threads":{threads}"#,
            json_string(&self.input),
            json_string(&self.output)
        );
        for (name, time) in self.times() {
            let _ = write!(text, r#","{name}_ms":{:.3}"#, ms(time));
        }
        let stages =
            self.stages.times.iter().map(|(name, time)| format!("{}:{:.3}", json_string(name), ms(*time)));
        let effects = self.stages.effects.iter().map(|EffectRuns { name, runs, time }| {
            format!(r#"{}:{{"ms":{:.3},"runs":{runs}}}"#, json_string(name), ms(*time))
        });
        let lights = self.stages.lit.iter().map(|lit| {
            let LitSurface { filter, exponent, pixels, aliasing, .. } = lit;
            format!(
                r#"{{"filter":{},"exponent":{exponent},"pixels":{pixels},"aliasing":{aliasing},"samples_a_side":{}}}"#,
                json_string(filter),
                samples_a_side(lit)
            )
        });
        let counts = self.stages.counts.iter().map(|(name, value)| format!("{}:{value}", json_string(name)));
        let _ = write!(
            text,
            r#","stages_ms":{{{}}},"effects":{{{}}},"counts":{{{}}},"highlights":[{}]"#,
            stages.collect::<Vec<_>>().join(","),
            effects.collect::<Vec<_>>().join(","),
            counts.collect::<Vec<_>>().join(","),
            lights.collect::<Vec<_>>().join(",")
        );
        if let Some(kib) = peak_memory_kib() {
            let _ = write!(text, r#","peak_kib":{kib}"#);
        }
        text + "}"
    }
}

/// Samples along a pixel's side that would cure all of what aliases.
pub fn samples_a_side(lit: &LitSurface) -> u64 {
    lit.sampling_rate.ceil().max(1.0) as u64
}

/// Time of a sequence, all frames together.
#[derive(Clone, Debug)]
pub struct SequencePerf {
    pub input: String,
    pub frames: usize,
    pub work: SequenceWork,
    pub threads: usize,
    pub total: Duration,
}

/// What was done for a sequence.
#[derive(Clone, Copy, Debug)]
pub struct SequenceWork {
    /// Pictures painted: fewer than frames where frames show the same, more with motion blur.
    pub painted: u64,
    /// Tiles of those pictures.
    pub tiles: u64,
    /// Those of them that no picture before showed at the same place.
    pub rendered: u64,
}

impl SequencePerf {
    pub fn print(&self, style: PerfStyle) {
        let SequencePerf { input, frames, work, threads, total } = self;
        let SequenceWork { painted, tiles, rendered } = work;
        let rate = *frames as f64 / total.as_secs_f64();
        let reused = if *tiles == 0 { 0.0 } else { (tiles - rendered) as f64 / *tiles as f64 };
        let total = ms(*total);
        let text = match style {
            PerfStyle::Text => format!(
                "{input}: {frames} frames, {painted} pictures painted, {:.1}% of {tiles} tiles reused, {total:.3} ms, {rate:.1} frames/s, {threads} threads",
                100.0 * reused
            ),
            PerfStyle::Json => format!(
                r#"{{"input":{},"frames":{frames},"painted":{painted},"tiles":{tiles},"tiles_rendered":{rendered},"tiles_reused":{reused:.6},"threads":{threads},"total_ms":{total:.3},"frames_per_second":{rate:.3}}}"#,
                json_string(input)
            ),
        };
        let _ = writeln!(std::io::stderr(), "{text}");
    }
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// The most memory this process has had, where the system tells.
fn peak_memory_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// A JSON string, quoted.
pub fn json_string(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            c if (c as u32) < 0x20 => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::json_string;

    #[test]
    fn quotes_and_control_characters_are_escaped() {
        assert_eq!(json_string("a\"b\\c\nd\u{1}é"), "\"a\\\"b\\\\c\\nd\\u0001é\"");
    }
}
