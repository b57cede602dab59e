//! argv of `explain` -> its [`Job`]. Options that say how a picture is made mean what they mean there.

use super::args::{self, PartOptions, PictureOptions, ReadingOptions, SizeOptions};
use super::explain::ExplainJob;
use super::fonts::FontOptions;
use super::parser_log;
use super::places::Source;
use super::report::Voice;
use super::view::View;
use super::Job;
use clap::ValueHint;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
#[command(
    disable_help_flag = true,
    args_override_self = true,
    override_usage = "toon-raster explain [OPTIONS] IN...",
    after_help = "Nothing is rendered, but for drawings with specular highlights: whether these alias shows \
                  only in their pixels."
)]
pub struct ExplainArguments {
    /// Drawings (SVG or svgz; `-` is standard input)
    #[arg(value_name = "IN", required = true, value_hint = ValueHint::FilePath)]
    inputs: Vec<PathBuf>,
    /// Print this help
    #[arg(long, action = clap::ArgAction::Help)]
    help: Option<bool>,
    /// One JSON object for each drawing, on a line of its own
    #[arg(long)]
    json: bool,
    /// Errors only on standard error
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// All that the SVG parser has to say, as it says it
    #[arg(short, long)]
    verbose: bool,
    #[command(flatten)]
    size: SizeOptions,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    part: PartOptions,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    fonts: FontOptions,
}

impl ExplainArguments {
    /// What they ask for.
    ///
    /// # Errors
    /// One line about the first thing wrong.
    pub fn job(self) -> Result<Job, String> {
        let inputs: Vec<Source> = self.inputs.iter().map(|path| Source::from_argument(path)).collect();
        if inputs.iter().filter(|input| **input == Source::Stdin).count() > 1 {
            return Err("standard input can be read only once".to_string());
        }
        parser_log::hear(self.quiet, self.verbose);
        self.part.warn_of_idle(self.quiet);
        Ok(Job::Explain(Box::new(ExplainJob {
            inputs,
            json: self.json,
            view: View {
                options: args::options(&self.reading, &self.size, &self.fonts)?,
                resources_dir: self.reading.resources_dir,
                fit: args::fit(&self.size),
                part: self.part.part(),
                max_pixels: self.size.max_pixels,
                settings: self.picture.settings(true)?,
                voice: Voice { quiet: self.quiet },
            },
        })))
    }
}
