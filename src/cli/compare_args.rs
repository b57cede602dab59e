//! argv of `compare` -> its [`Job`].

use super::args::{self, ReadingOptions, SizeOptions};
use super::compare::CompareJob;
use super::fonts::FontOptions;
use super::parser_log;
use super::places::Source;
use super::report::Voice;
use super::values::{self, Color, ProgressStyle};
use super::Job;
use clap::ValueHint;
use std::path::PathBuf;
use std::time::Duration;
use toon_raster::compare::cache::Cache;
use toon_raster::compare::Options;
use toon_raster::Method;

#[derive(clap::Args, Debug)]
#[command(
    disable_help_flag = true,
    args_override_self = true,
    override_usage = "toon-raster compare [OPTIONS] IN...",
    after_help = "The reference is the box-filtered picture without conflation, computed in 64-bit floats by \
                  code that shares nothing with the methods. Errors are in 8-bit levels."
)]
pub struct CompareArguments {
    /// Drawings (SVG or svgz; `-` is standard input)
    #[arg(value_name = "IN", required = true, value_hint = ValueHint::FilePath)]
    inputs: Vec<PathBuf>,
    /// Print this help
    #[arg(long, action = clap::ArgAction::Help)]
    help: Option<bool>,
    /// Methods to compare, as --aa takes them; by default all
    #[arg(long, value_name = "A,B,C", value_delimiter = ',', value_parser = values::method)]
    methods: Vec<Method>,
    /// Another renderer's picture (PNG) of the same size; may be given several times
    #[arg(long, value_name = "IMAGE", value_hint = ValueHint::FilePath)]
    against: Vec<PathBuf>,
    /// Timed runs of each method
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Time for all runs of one method on one drawing; a slow one has fewer runs
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = seconds)]
    budget: f64,
    /// Measure in motion, too: move the drawing by one pixel in N steps
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=64))]
    pan: Option<u32>,
    /// Curves of error and time against N and the tolerance; --report makes them anyway
    #[arg(long, overrides_with = "no_curves")]
    curves: bool,
    /// No curves in the report
    #[arg(long)]
    no_curves: bool,
    /// Also hold the reference against a finer one, and one with strokes made another way
    #[arg(long)]
    check_reference: bool,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    size: SizeOptions,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    fonts: FontOptions,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Output")]
struct OutputOptions {
    /// All figures, one object for each drawing and method; `-` is standard output, without the table
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    json: Option<PathBuf>,
    /// A page to look at, index.html in this folder, complete in one file
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    report: Option<PathBuf>,
    /// Folder in which references are kept; by default the user's cache
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath, conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Compute every reference anew and keep none
    #[arg(long)]
    no_cache: bool,
    /// Errors only on standard error
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// All that the SVG parser has to say, as it says it
    #[arg(short, long)]
    verbose: bool,
    /// bar (only on a terminal, only if the work is long), json or none
    #[arg(long, value_name = "STYLE", default_value = "bar", value_parser = values::progress)]
    progress: ProgressStyle,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Picture")]
struct PictureOptions {
    /// CSS colour behind the drawing
    #[arg(short, long, value_name = "COLOR", value_parser = values::color)]
    background: Option<Color>,
    /// Farthest a flattened curve may lie from the true one, in output pixels; by default what suits the method
    #[arg(long, value_name = "F", value_parser = values::tolerance)]
    tolerance: Option<f64>,
    /// Mix edges in linear light, in the reference too
    #[arg(long)]
    linear: bool,
    /// Threads of each method; 0 is one a core
    #[arg(short, long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
}

impl CompareArguments {
    /// What they ask for.
    ///
    /// # Errors
    /// One line about the first thing wrong.
    pub fn job(self) -> Result<Job, String> {
        let CompareArguments { inputs, output, size, picture, reading, fonts, .. } = self;
        if inputs.len() > 1 && !self.against.is_empty() {
            return Err("--against goes with one drawing (see --help)".to_string());
        }
        let inputs: Vec<Source> = inputs.iter().map(|path| Source::from_argument(path)).collect();
        if inputs.iter().filter(|input| **input == Source::Stdin).count() > 1 {
            return Err("standard input can be read only once".to_string());
        }
        parser_log::hear(output.quiet, output.verbose);
        let mut methods = self.methods;
        if methods.is_empty() {
            methods = Method::ALL.to_vec();
        }
        let mut seen = Vec::new();
        methods.retain(|method| {
            !seen.contains(method) && {
                seen.push(*method);
                true
            }
        });
        let cache = match output.cache {
            Some(folder) => Some(Cache::new(folder)),
            None if output.no_cache => None,
            None => Cache::of_the_user(),
        };
        let options = Options {
            methods,
            against: Vec::new(),
            runs: self.runs.into(),
            budget: Duration::from_secs_f64(self.budget),
            threads: picture.threads.into(),
            tolerance: picture.tolerance,
            linear: picture.linear,
            background: picture.background.map(|color| color.0),
            pan: self.pan,
            curves: self.curves || output.report.is_some() && !self.no_curves,
            check_reference: self.check_reference,
            cache,
        };
        Ok(Job::Compare(Box::new(CompareJob {
            inputs,
            against: self.against,
            reading: args::options(&reading, &size, &fonts)?,
            resources_dir: reading.resources_dir,
            fit: args::fit(&size),
            max_pixels: size.max_pixels,
            options,
            json: output.json,
            report: output.report,
            voice: Voice { quiet: output.quiet },
            progress: args::told(output.progress, output.quiet),
        })))
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if (0.01..=86_400.0).contains(&s) => Ok(s),
        _ => Err("must be a number of seconds from 0.01 to 86400".to_string()),
    }
}
