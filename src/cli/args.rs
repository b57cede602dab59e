//! argv -> [`Job`], or one line on what is wrong with it. Flags mean what they mean to resvg.

use super::compare_args::CompareArguments;
use super::explain_args::ExplainArguments;
use super::fonts::FontOptions;
use super::frames::{FramesJob, SequenceOptions};
use super::parser_log;
use super::places::{self, Pattern, Plan, Source, Wanted};
use super::query::QueryJob;
use super::render::RenderJob;
use super::report::Voice;
use super::sequence::{self, Origin};
use super::size::{Fit, Part};
use super::values::{self, Color, Format, PerfStyle, ProgressStyle};
use super::view::View;
use super::Job;
use clap::{CommandFactory, Parser, ValueHint};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use toon_raster::{usvg, Highlights, Method, Options, Settings};

/// Most pixels of a picture if nothing else is said: 16,384 squared, 1 GiB of raw RGBA.
const MAX_PIXELS: u64 = 1 << 28;

/// Renders SVG cartoons with the exact visible area of every colour in every pixel.
#[derive(Parser, Debug)]
#[command(
    name = "toon-raster",
    version,
    disable_help_flag = true,
    disable_help_subcommand = true,
    args_override_self = true,
    args_conflicts_with_subcommands = true,
    override_usage = "toon-raster [OPTIONS] IN.svg OUT.png\n       \
                      toon-raster [OPTIONS] IN... -o FOLDER|shot.####.png\n       \
                      toon-raster compare [OPTIONS] IN...\n       \
                      toon-raster explain [OPTIONS] IN...\n       \
                      toon-raster [OPTIONS] ANIMATED.svg|f.####.svg|'f*.svg'|FOLDER -o shot.####.png|OUT.gif|OUT.mp4|-\n       \
                      toon-raster completions SHELL",
    after_help = "`-` is standard input or output. Exit codes: 0 all done, 1 some input failed, \
                  2 usage, 3 the input can't be rendered."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Drawings (SVG or svgz; `-` is standard input); without -o the last one names the output
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath)]
    paths: Vec<PathBuf>,
    /// Output: a file, a folder, a pattern such as shot.####.png or shot.%04d.png, or `-`
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::AnyPath)]
    output: Option<PathBuf>,
    /// Write to standard output
    #[arg(short = 'c', conflicts_with = "output")]
    to_stdout: bool,
    /// Print this help
    #[arg(long, action = clap::ArgAction::Help)]
    help: Option<bool>,
    #[command(flatten)]
    size: SizeOptions,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    file: FileOptions,
    #[command(flatten)]
    sequence: SequenceOptions,
    #[command(flatten)]
    part: PartOptions,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    fonts: FontOptions,
    #[command(flatten)]
    query: QueryOptions,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(clap::Subcommand, Debug)]
enum Command {
    /// Print a completion script for a shell
    Completions {
        /// bash, elvish, fish, powershell or zsh
        shell: clap_complete::Shell,
    },
    /// Compare the ways of anti-aliasing on drawings: error against a reference, and time
    Compare(Box<CompareArguments>),
    /// Say what drawings call for, what will run for it and what that costs
    Explain(Box<ExplainArguments>),
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Size (the aspect is always kept)")]
pub(super) struct SizeOptions {
    /// Width in pixels
    #[arg(short, long, value_name = "N", value_parser = values::length)]
    pub(super) width: Option<u32>,
    /// Height in pixels
    #[arg(short, long, value_name = "N", value_parser = values::length)]
    pub(super) height: Option<u32>,
    /// Factor on the drawing's own size, if neither width nor height is given
    #[arg(short, long, value_name = "F", value_parser = values::zoom)]
    zoom: Option<f32>,
    /// Pixels an inch, for lengths in mm, pt and so on
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(10..=4000))]
    dpi: u32,
    /// Refuse pictures of more pixels than this
    #[arg(long, value_name = "N", default_value_t = MAX_PIXELS)]
    pub(super) max_pixels: u64,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureOptions {
    /// CSS colour behind the drawing; without it the picture keeps its alpha
    #[arg(short, long, value_name = "COLOR", value_parser = values::color)]
    background: Option<Color>,
    /// How edges are smoothed: exact (visible areas, Catmull 1978), mask (A-buffer, 4x4), mask64 (A-buffer,
    /// 64 samples), none (jagged), grid:N (N x N samples), random:N, jitter:N, poisson:N, adaptive:N (up to
    /// N) or accumulate:N (N samples), corner, corner:tiny (borders found between pixel corners), cone (disk
    /// footprint), beam (visible polygons of the whole picture), area (shape over shape: seams and all) or
    /// tiny-skia (resvg's renderer)
    #[arg(long, value_name = "METHOD", default_value = "exact", value_parser = values::method)]
    aa: Method,
    /// Farthest a flattened curve may lie from the true one, in output pixels [default: 0.01; mask 0.0625,
    /// mask64 0.03125]
    #[arg(long, value_name = "F", value_parser = values::tolerance)]
    tolerance: Option<f64>,
    /// Mix edges in linear light (opacity still composites as SVG says)
    #[arg(long)]
    linear: bool,
    /// Specular highlights that alias: as-is, clamp (their exponent), aggressive (a thousandth of their
    /// power may alias) or supersample
    #[arg(long, value_name = "WAY", default_value = "as-is", value_parser = values::highlights)]
    highlights: Highlights,
    /// Average tables over noise (feComponentTransfer of feTurbulence) over each pixel, where SVG looks at
    /// one point of it
    #[arg(long)]
    index_aa: bool,
    /// Threads; 0 is one a core. The picture does not depend on it
    #[arg(short, long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    threads: u16,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "File")]
struct FileOptions {
    /// png, rgba (raw pixels), apng, gif, y4m (video, for pipes) or, by ffmpeg, mp4, webm or webp, where
    /// the output's name does not tell
    #[arg(long, value_name = "FORMAT", value_parser = values::format)]
    format: Option<Format>,
    /// Spend the least time on packing the PNG
    #[arg(long, conflicts_with = "small_png")]
    fast_png: bool,
    /// Spend more time on packing the PNG
    #[arg(long)]
    small_png: bool,
    /// First number of an output pattern; of an animated drawing, the frame that is at its start
    #[arg(long, value_name = "N", default_value_t = 1)]
    start_number: u64,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Part of the drawing")]
pub(super) struct PartOptions {
    /// Only the element with this id
    #[arg(short = 'i', long, value_name = "ID")]
    export_id: Option<String>,
    /// With --export-id: on the whole page rather than on the element's box
    #[arg(long)]
    export_area_page: bool,
    /// The box of all that is drawn rather than the page; without --export-id
    #[arg(long)]
    export_area_drawing: bool,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Query")]
struct QueryOptions {
    /// Print every id and its box (id,x,y,width,height) instead of a picture
    #[arg(long, conflicts_with = "query_bbox")]
    query_all: bool,
    /// Print the box of all that is drawn (x,y,width,height) instead of a picture
    #[arg(long)]
    query_bbox: bool,
    /// List the font faces that would be used
    #[arg(long)]
    list_fonts: bool,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Reading")]
pub(super) struct ReadingOptions {
    /// CSS file added before the drawing's own style sheets
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    stylesheet: Option<PathBuf>,
    /// Languages for systemLanguage, the first choice first
    #[arg(long, value_name = "LANG", default_value = "en", value_delimiter = ',', value_parser = values::languages)]
    languages: Vec<String>,
    /// Where the drawing says nothing: optimizeSpeed, crispEdges or geometricPrecision
    #[arg(long, value_name = "HINT", default_value = "geometricPrecision", value_parser = values::shape_rendering)]
    shape_rendering: usvg::ShapeRendering,
    /// Where the drawing says nothing: optimizeSpeed, optimizeLegibility or geometricPrecision
    #[arg(long, value_name = "HINT", default_value = "optimizeLegibility", value_parser = values::text_rendering)]
    text_rendering: usvg::TextRendering,
    /// Where the drawing says nothing: optimizeQuality, optimizeSpeed, smooth, high-quality,
    /// crisp-edges or pixelated
    #[arg(long, value_name = "HINT", default_value = "optimizeQuality", value_parser = values::image_rendering)]
    image_rendering: usvg::ImageRendering,
    /// Folder that relative links start from; by default the drawing's own
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(super) resources_dir: Option<PathBuf>,
}

#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Reports, on standard error")]
struct ReportOptions {
    /// Time of every stage; --perf=json for one JSON object a picture
    #[arg(long, value_name = "STYLE", num_args = 0..=1, require_equals = true, default_missing_value = "text",
          value_parser = values::perf)]
    perf: Option<PerfStyle>,
    /// Errors only
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// All that the SVG parser has to say, as it says it
    #[arg(short, long)]
    verbose: bool,
    /// bar (only on a terminal, only if the work is long), json, openjd or none
    #[arg(long, value_name = "STYLE", default_value = "bar", value_parser = values::progress)]
    progress: ProgressStyle,
}

/// What argv asks for.
///
/// # Errors
/// One line about the first thing wrong.
pub fn job(argv: impl Iterator<Item = OsString>) -> Result<Job, String> {
    let arguments = match Arguments::try_parse_from(argv) {
        Ok(arguments) => arguments,
        Err(e) if !e.use_stderr() => return Ok(Job::Print(e.render().to_string())),
        Err(e) => return Err(first_line(&e)),
    };
    match arguments.command {
        Some(Command::Completions { shell }) => return Ok(Job::Completions(shell)),
        Some(Command::Compare(arguments)) => return arguments.job(),
        Some(Command::Explain(arguments)) => return arguments.job(),
        None => {}
    }
    if arguments.query.list_fonts {
        return Ok(Job::ListFonts(arguments.fonts));
    }
    parser_log::hear(arguments.report.quiet, arguments.report.verbose);
    arguments.part.warn_of_idle(arguments.report.quiet);
    if arguments.query.query_all || arguments.query.query_bbox {
        return query_job(arguments);
    }
    render_job(arguments)
}

/// clap's message without its label, hint lines and usage.
fn first_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let mut lines = text.lines().map(str::trim);
    let mut message = lines.next().unwrap_or_default().trim_start_matches("error: ").to_string();
    if message.ends_with(':') {
        // The list that follows, up to the empty line: arguments missing or in conflict.
        let list: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
        message = format!("{message} {}", list.join(" "));
    }
    format!("{message} (see --help)")
}

fn query_job(arguments: Arguments) -> Result<Job, String> {
    let all = arguments.query.query_all;
    let [input] = &arguments.paths[..] else {
        return Err("a query takes one input and no output (see --help)".to_string());
    };
    let input = Source::from_argument(input);
    Ok(Job::Query(QueryJob {
        input,
        all,
        options: options(&arguments.reading, &arguments.size, &arguments.fonts)?,
    }))
}

fn render_job(mut arguments: Arguments) -> Result<Job, String> {
    let wanted = if arguments.to_stdout {
        Wanted::Stdout
    } else if let Some(output) = arguments.output.take() {
        Wanted::Named(output)
    } else {
        match arguments.paths.len() {
            0 => return Err("no input (see --help)".to_string()),
            1 => {
                return Err(
                    "no output (name it after the input, or with -o; - is standard output)".to_string()
                )
            }
            2 => Wanted::Beside(arguments.paths.pop().expect("two paths")),
            _ => return Err("several inputs need -o with a folder or a pattern (shot.####.png)".to_string()),
        }
    };
    if arguments.paths.is_empty() {
        return Err("no input (see --help)".to_string());
    }
    if let Some(origin) = frames_of(&arguments, &wanted)? {
        return frames_job(arguments, origin, wanted);
    }
    let plan = places::plan(&arguments.paths, wanted, arguments.file.format, arguments.file.start_number)?;
    picture_job(arguments, plan).map(|(job, _)| Job::Render(job))
}

/// Whether a sequence is asked for, by an option, by the format or by the names; where its frames come from.
fn frames_of(arguments: &Arguments, wanted: &Wanted) -> Result<Option<Origin>, String> {
    let paths = &arguments.paths;
    let path = match wanted {
        Wanted::Beside(path) | Wanted::Named(path) => Some(path.as_path()),
        Wanted::Stdout => None,
    };
    let extension = path.and_then(|path| path.extension()?.to_str()).and_then(|e| values::format(e).ok());
    let many = arguments.file.format.or(extension).is_some_and(Format::holds_many);
    let named =
        path.is_some_and(|path| matches!(wanted, Wanted::Named(_)) && Pattern::find(path, 1).is_some());
    let asked = many || arguments.sequence.ask() || (named && paths.len() == 1);
    Ok(match sequence::expand(paths)? {
        Some(files) => Some(Origin::Files(files)),
        None if !asked => None,
        None => Some(match &paths[..] {
            [only] => Origin::Animated(Source::from_argument(only)),
            several => Origin::Files(several.iter().map(|p| (None, Source::from_argument(p))).collect()),
        }),
    })
}

fn frames_job(mut arguments: Arguments, origin: Origin, wanted: Wanted) -> Result<Job, String> {
    let (sheet, start_number) = (arguments.sequence.sheet.is_some(), arguments.file.start_number);
    let single = arguments.sequence.single();
    let (destination, format, folder) =
        sequence::destination(&origin, wanted, arguments.file.format, sheet, single)?;
    arguments.paths.clear();
    let (picture, options) = picture_job(arguments, Plan { tasks: Vec::new(), format, folder })?;
    Ok(Job::Frames(Box::new(FramesJob { picture, origin, destination, options, start_number })))
}

/// How each picture is made.
fn picture_job(arguments: Arguments, plan: Plan) -> Result<(RenderJob, SequenceOptions), String> {
    let options = options(&arguments.reading, &arguments.size, &arguments.fonts)?;
    let Arguments { size, picture, file, sequence, part, reading, report, .. } = arguments;
    let job = RenderJob {
        plan,
        view: View {
            options,
            resources_dir: reading.resources_dir,
            fit: fit(&size),
            part: part.part(),
            max_pixels: size.max_pixels,
            settings: picture.settings(report.perf.is_some())?,
            voice: Voice { quiet: report.quiet },
        },
        effort: values::effort(file.fast_png, file.small_png),
        perf: report.perf,
        progress: told(report.progress, report.quiet),
    };
    Ok((job, sequence))
}

impl PictureOptions {
    /// # Errors
    /// One line, when two of them do not go together.
    pub(super) fn settings(self, stage_times: bool) -> Result<Settings, String> {
        if self.linear && self.aa == Method::TinySkia {
            return Err(
                "--aa tiny-skia cannot mix in linear light (leave out --linear, or choose another method)"
                    .to_string(),
            );
        }
        Ok(Settings {
            method: self.aa,
            tolerance: self.tolerance.unwrap_or(self.aa.tolerance()),
            linear: self.linear,
            highlights: self.highlights,
            index_aa: self.index_aa,
            background: self.background.map(|color| color.0),
            threads: self.threads.into(),
            stage_times,
            ..Settings::default()
        })
    }
}

impl PartOptions {
    /// Warns of an option that says nothing beside the others, as resvg does.
    pub(super) fn warn_of_idle(&self, quiet: bool) {
        let idle = match &self.export_id {
            None if self.export_area_page => "--export-area-page has no effect without --export-id",
            Some(_) if self.export_area_drawing => "--export-area-drawing has no effect with --export-id",
            _ => return,
        };
        if !quiet {
            super::report::line(&format!("warning: {idle}"));
        }
    }

    pub(super) fn part(self) -> Part {
        match self.export_id {
            Some(id) => Part::Element { id, on_page: self.export_area_page },
            None if self.export_area_drawing => Part::Drawing,
            None => Part::Page,
        }
    }
}

/// A bar is for people: only on a terminal, and not if they want quiet.
pub(super) fn told(progress: ProgressStyle, quiet: bool) -> ProgressStyle {
    match progress {
        ProgressStyle::Bar if !std::io::stderr().is_terminal() || quiet => ProgressStyle::None,
        style => style,
    }
}

pub(super) fn fit(size: &SizeOptions) -> Fit {
    match (size.width, size.height, size.zoom) {
        (Some(width), Some(height), _) => Fit::Within(width, height),
        (Some(width), None, _) => Fit::Width(width),
        (None, Some(height), _) => Fit::Height(height),
        (None, None, Some(zoom)) => Fit::Zoom(zoom),
        (None, None, None) => Fit::Original,
    }
}

pub(super) fn options(
    reading: &ReadingOptions,
    size: &SizeOptions,
    fonts: &FontOptions,
) -> Result<Options, String> {
    let style_sheet = match &reading.stylesheet {
        Some(file) => Some(
            std::fs::read_to_string(file)
                .map_err(|e| format!("the style sheet {} cannot be read: {e}", file.display()))?,
        ),
        None => None,
    };
    let (width, height) = (size.width.unwrap_or(100), size.height.unwrap_or(100));
    let usvg = usvg::Options {
        resources_dir: reading.resources_dir.clone(),
        dpi: size.dpi as f32,
        font_family: fonts.font_family.clone(),
        font_size: fonts.font_size as f32,
        languages: reading.languages.clone(),
        shape_rendering: reading.shape_rendering,
        text_rendering: reading.text_rendering,
        image_rendering: reading.image_rendering,
        default_size: usvg::Size::from_wh(width as f32, height as f32).expect("lengths are above zero"),
        style_sheet,
        ..Default::default()
    };
    Ok(Options { usvg, fonts: fonts.source(), ..Default::default() })
}

/// Prints a completion script.
pub fn completions(shell: clap_complete::Shell) -> ExitCode {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "toon-raster", &mut script);
    super::report::print(&String::from_utf8_lossy(&script))
}
