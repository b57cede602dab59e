//! The frames job: an animated drawing, or many drawings, to a sequence of files or to one that holds
//! all frames. Frames are made on all threads, each whole, and are the same bytes as one by one.

use super::movie::{Look, Reel};
use super::output::Output;
use super::perf::SequencePerf;
use super::places::{Source, Target};
use super::render::RenderJob;
use super::report::{self, Failure, Progress};
use super::sequence::{Destination, Numbered, Origin};
use super::size::{self, Part};
use super::values::{self, Format};
use super::{input, render};
use std::io::Write;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::Arc;
use std::time::Instant;
use toon_raster::encode::{Layout, PngWriter, Rate, Yuv};
use toon_raster::frames::list::FrameList;
use toon_raster::frames::sequence::{in_order, Cels, AHEAD};
use toon_raster::frames::{blur, Timeline};
use toon_raster::scene::load;
use toon_raster::{usvg, Error, Pixmap, Renderer, Scene, Settings, Viewport};

/// The options of sequences.
#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Sequences and animations")]
pub struct SequenceOptions {
    /// Frames a second, such as 24, 23.976 or 30000/1001 [default: 24]
    #[arg(long, visible_alias = "framerate", value_name = "F", value_parser = values::parsed::<Rate>)]
    pub fps: Option<Rate>,
    /// Only these frames: 7, 1-100, 1..100, 1-100x2, 1-100:2 or several by commas
    #[arg(long, value_name = "LIST", value_parser = values::parsed::<FrameList>)]
    pub frames: Option<FrameList>,
    /// Refuse longer sequences
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    pub max_frames: u64,
    /// Only part I of N equal parts of the frames
    #[arg(long, value_name = "I/N", value_parser = values::chunk)]
    pub chunk: Option<(u64, u64)>,
    /// Leave frames whose files are there
    #[arg(long)]
    pub skip_existing: bool,
    /// How often a GIF or APNG plays; 0 is for ever
    #[arg(long = "loop", value_name = "N", default_value_t = 0)]
    pub plays: u16,
    /// One PNG with the frames in rows of COLS, and a JSON of where they are
    #[arg(long, value_name = "COLSx", value_parser = values::columns)]
    pub sheet: Option<u32>,
    /// Chroma and matrix of y4m: 444 or 420, 601 or 709 [default: 444,601]
    #[arg(long, value_name = "LIST", value_parser = values::yuv)]
    pub yuv: Option<Yuv>,
    /// Motion blur: how long the shutter is open, 360 being the time of a frame
    #[arg(long, value_name = "DEGREES", value_parser = values::shutter)]
    pub shutter: Option<f64>,
    /// Moments that a blurred frame is the mean of
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub shutter_samples: u32,
}

impl SequenceOptions {
    /// Whether any of them asks for a sequence by itself.
    pub fn ask(&self) -> bool {
        self.fps.is_some()
            || self.frames.is_some()
            || self.chunk.is_some()
            || self.skip_existing
            || self.sheet.is_some()
            || self.shutter.is_some()
    }

    /// Whether they ask for no more than one frame.
    pub fn single(&self) -> bool {
        self.frames.as_ref().is_some_and(|list| list.count_at_most() == 1)
    }
}

/// A sequence to be made.
pub struct FramesJob {
    /// How each picture is made; its plan has no tasks.
    pub picture: RenderJob,
    pub origin: Origin,
    pub destination: Destination,
    pub options: SequenceOptions,
    pub start_number: u64,
}

/// One frame to be made.
struct Frame {
    number: u64,
    /// For messages.
    name: String,
    what: What,
}

enum What {
    /// The animated drawing at this many seconds.
    At(f64),
    Drawing(Source),
}

/// Does it.
pub fn run(job: FramesJob) -> ExitCode {
    let name = job.origin.name();
    render::on_a_deep_stack(|| match report::catching(|| Studio::open(job)) {
        Ok(studio) => studio.run(),
        Err(failure) => {
            report::failure(&name, &failure);
            report::exit_code(1, &[failure])
        }
    })
}

/// All that the threads share.
struct Studio {
    job: FramesJob,
    frames: Vec<Frame>,
    rate: Rate,
    timeline: Option<Timeline>,
    /// Of an animated drawing: the same for all frames, whatever moves.
    viewport: Option<Viewport>,
    cels: Cels<Arc<Result<Pixmap, Failure>>>,
    threads: usize,
    started: Instant,
    /// Pictures that were painted; the others were there already.
    painted: AtomicU64,
}

impl Studio {
    /// Reads what is to be read first, and lists the frames.
    fn open(mut job: FramesJob) -> Result<Studio, Failure> {
        let started = Instant::now();
        let rate = job.options.fps.unwrap_or(Rate { frames: 24, seconds: 1 });
        if let Some(folder) = &job.picture.plan.folder {
            std::fs::create_dir_all(folder)
                .map_err(|e| Failure::io(format!("the folder {} cannot be made: {e}", folder.display())))?;
        }
        let (mut timeline, mut viewport) = (None, None);
        let frames = match &job.origin {
            Origin::Animated(source) => {
                let name = source.name();
                let bytes = input::read(source)?;
                let picture = &mut job.picture;
                picture.options.usvg.resources_dir =
                    picture.resources_dir.clone().or_else(|| render::folder_of(source));
                let read = Timeline::read(&bytes, &picture.options)?;
                viewport = Some(first_look(&read, &name, picture)?);
                let count = read.length().frames(rate.fps());
                timeline = Some(read);
                sampled(&job, &name, count, rate)?
            }
            Origin::Files(files) => {
                // The frames of a film stand side by side.
                let folder = files.first().and_then(|(_, source)| render::folder_of(source));
                let picture = &mut job.picture;
                picture.options.usvg.resources_dir = picture.resources_dir.clone().or(folder);
                listed(&job, files)
            }
        };
        let frames = chunk(frames, job.options.chunk);
        let most = job.options.max_frames;
        if frames.len() as u64 > most {
            return Err(too_many(frames.len() as u64, most));
        }
        if frames.is_empty() && job.options.chunk.is_none() {
            return Err(Failure::input("no frame of it is in --frames"));
        }
        let threads = job.picture.settings.thread_count();
        let cels = Cels::new((AHEAD + 1) * threads);
        let painted = AtomicU64::new(0);
        Ok(Studio { job, frames, rate, timeline, viewport, cels, threads, started, painted })
    }

    fn run(self) -> ExitCode {
        let mut progress = Progress::new(self.job.picture.progress, self.frames.len());
        let (failures, made) = match &self.job.destination {
            Destination::One(target) => self.to_one(target, &mut progress),
            _ => (self.to_files(&mut progress), true),
        };
        progress.clear();
        if let Some(style) = self.job.picture.perf {
            self.perf().print(style);
        }
        // Without a file, all frames are lost with the one that failed.
        report::exit_code(if made { self.frames.len() } else { failures.len() }, &failures)
    }

    fn perf(&self) -> SequencePerf {
        SequencePerf {
            input: self.job.origin.name(),
            frames: self.frames.len(),
            painted: self.painted.load(Ordering::Relaxed),
            threads: self.threads,
            total: self.started.elapsed(),
        }
    }

    /// Renderers with one thread each, but for a frame alone.
    fn renderer(&self) -> Option<Renderer> {
        let threads = if self.frames.len() > 1 { 1 } else { self.job.picture.settings.threads };
        Renderer::new(Settings { threads, ..self.job.picture.settings.clone() }).ok()
    }

    fn to_files(&self, progress: &mut Progress) -> Vec<Failure> {
        let make = |renderer: &mut Option<Renderer>, n: usize| {
            report::catching(|| self.to_file(renderer, &self.frames[n]))
        };
        let mut failures = Vec::new();
        let sink = |n: usize, done: Result<(), Failure>| {
            let frame = &self.frames[n];
            let ok = done.is_ok();
            if let Err(failure) = done {
                progress.clear();
                report::failure(&frame.name, &failure);
                failures.push(failure);
            }
            progress.tick(&frame.name, ok);
            true
        };
        let done = in_order(self.frames.len(), self.threads, || self.renderer(), make, sink);
        failures.extend(done.err().map(|e| Failure::io(format!("no thread can be started: {e}"))));
        failures
    }

    /// Where a frame goes if it has a file of its own.
    fn target(&self, frame: &Frame) -> Target {
        let extension = self.job.picture.plan.format.extension();
        match (&self.job.destination, &frame.what) {
            (Destination::Numbered(pattern), _) => Target::File(pattern.numbered(frame.number)),
            (Destination::Folder(folder), What::Drawing(source)) => {
                Target::File(folder.join(format!("{}.{extension}", source.stem())))
            }
            (Destination::Folder(folder), What::At(_)) => {
                let stem = match &self.job.origin {
                    Origin::Animated(source) => source.stem(),
                    Origin::Files(_) => String::new(),
                };
                Target::File(folder.join(format!("{stem}.{:04}.{extension}", frame.number)))
            }
            (Destination::One(target), _) => target.clone(),
        }
    }

    fn to_file(&self, renderer: &mut Option<Renderer>, frame: &Frame) -> Result<(), Failure> {
        let target = self.target(frame);
        if self.job.options.skip_existing && exists(&target) {
            return Ok(());
        }
        let picture = self.picture(renderer, frame);
        let picture = picture.as_ref().as_ref().map_err(Clone::clone)?;
        let mut output = Output::create(&target)?;
        self.write(&mut output, picture).map_err(|e| match e {
            Error::Io(e) => output.failure(&e),
            other => other.into(),
        })?;
        output.commit()
    }

    fn write(&self, output: &mut Output, picture: &Pixmap) -> Result<(), Error> {
        if self.job.picture.plan.format == Format::Rgba {
            return Ok(output.write_all(picture.data())?);
        }
        let effort = self.job.picture.effort;
        let mut png = PngWriter::new(output, picture.width(), picture.height(), self.opaque(), effort)?;
        png.write_rows(picture.data())?;
        png.finish()
    }

    fn opaque(&self) -> bool {
        self.job.picture.settings.background.is_some_and(|color| color[3] == 255)
    }

    /// What failed, and whether the file was made all the same.
    fn to_one(&self, target: &Target, progress: &mut Progress) -> (Vec<Failure>, bool) {
        let mut failures = Vec::new();
        if self.frames.is_empty() || (self.job.options.skip_existing && exists(target)) {
            return (failures, true);
        }
        // Whose fault it is if no file is made.
        let mut name = self.job.origin.name();
        let done = Output::create(target).and_then(|mut output| {
            let size = self.shoot(&mut output, progress, &mut failures, &mut name).map_err(|e| match e {
                Error::Io(e) => output.failure(&e),
                other => other.into(),
            })?;
            let Some(size) = size else { return Ok(false) };
            output.commit()?;
            self.write_layout(target, size)?;
            Ok(true)
        });
        let made = done.unwrap_or_else(|failure| {
            progress.clear();
            report::failure(&name, &failure);
            failures.push(failure);
            false
        });
        (failures, made)
    }

    /// All frames to one output, and their size; `None` if none could be made.
    fn shoot(
        &self,
        output: &mut Output,
        progress: &mut Progress,
        failures: &mut Vec<Failure>,
        stopped_at: &mut String,
    ) -> Result<Option<(u32, u32)>, Error> {
        let look = self.look();
        let mut reel = Reel::new(output, &look);
        let mut stopped = None;
        let make = |renderer: &mut Option<Renderer>, n: usize| {
            report::catching(|| Ok::<_, Failure>(self.picture(renderer, &self.frames[n])))
        };
        let sink = |n: usize, made: Result<Arc<Result<Pixmap, Failure>>, Failure>| {
            let name = &self.frames[n].name;
            let (added, ok) = match made.as_deref() {
                Ok(Ok(picture)) => (reel.add(picture), true),
                Ok(Err(failure)) | Err(failure) => {
                    progress.clear();
                    report::failure(name, failure);
                    failures.push(failure.clone());
                    (reel.repeat(), false)
                }
            };
            progress.tick(name, ok && added.is_ok());
            stopped = added.err();
            if stopped.is_some() {
                stopped_at.clone_from(name);
            }
            stopped.is_none()
        };
        in_order(self.frames.len(), self.threads, || self.renderer(), make, sink)?;
        match stopped {
            Some(error) => Err(error),
            None => reel.finish(),
        }
    }

    fn look(&self) -> Look {
        let SequenceOptions { plays, sheet, yuv, .. } = self.job.options;
        Look {
            format: self.job.picture.plan.format,
            frames: self.frames.len() as u32,
            opaque: self.opaque(),
            rate: self.rate,
            effort: self.job.picture.effort,
            plays,
            sheet,
            yuv: yuv.unwrap_or(Yuv { halved: false, bt709: false }),
        }
    }

    /// The JSON beside a sprite sheet.
    fn write_layout(&self, target: &Target, (width, height): (u32, u32)) -> Result<(), Failure> {
        let (Some(columns), Target::File(sheet)) = (self.job.options.sheet, target) else { return Ok(()) };
        let layout = Layout { width, height, columns, frames: self.frames.len() as u32 };
        let names: Vec<String> = self.frames.iter().map(|frame| frame.number.to_string()).collect();
        let image = sheet.file_name().unwrap_or_default().to_string_lossy();
        let mut output = Output::create(&Target::File(sheet.with_extension("json")))?;
        let written = output.write_all(layout.json(&image, &names, self.rate).as_bytes());
        written.map_err(|e| output.failure(&e))?;
        output.commit()
    }

    /// One frame's pixels.
    fn picture(&self, renderer: &mut Option<Renderer>, frame: &Frame) -> Arc<Result<Pixmap, Failure>> {
        match (&frame.what, &self.timeline) {
            (What::Drawing(source), _) => {
                Arc::new(input::read(source).and_then(|bytes| self.paint(renderer, &bytes, &frame.name)))
            }
            (&What::At(time), Some(timeline)) => {
                let moment = |renderer: &mut Option<Renderer>, time: f64| {
                    let paint =
                        |document: &str| Arc::new(self.paint(renderer, document.as_bytes(), &frame.name));
                    self.cels.of(timeline.document_at(time), paint)
                };
                let Some(degrees) = self.job.options.shutter else { return moment(renderer, time) };
                let open = degrees / 360.0 / self.rate.fps();
                let samples = self.job.options.shutter_samples;
                let times = (0..samples).map(|k| time + open * f64::from(k) / f64::from(samples));
                let mut sum: Option<blur::Exposure> = None;
                for time in times {
                    let picture = moment(renderer, time);
                    match picture.as_ref() {
                        Ok(pixels) => sum.get_or_insert_with(|| blur::Exposure::new(pixels)).add(pixels),
                        Err(_) => return picture,
                    }
                }
                Arc::new(Ok(sum.expect("there is a sample").mean()))
            }
            (What::At(_), None) => unreachable!("times are of an animated drawing"),
        }
    }

    fn paint(&self, renderer: &mut Option<Renderer>, bytes: &[u8], name: &str) -> Result<Pixmap, Failure> {
        self.painted.fetch_add(1, Ordering::Relaxed);
        let job = &self.job.picture;
        let (tree, unmatched) = load::tree_and_warnings(bytes, &job.options)?;
        let viewport = match self.viewport {
            Some(viewport) => viewport,
            None => size::viewport(&tree, &job.part, job.fit, job.max_pixels)?,
        };
        let scene = scene(&tree, &job.part)?;
        if self.timeline.is_none() {
            report::warnings(name, scene.warnings(), job.voice);
            report::warnings(name, &unmatched, job.voice);
        }
        let painter = match renderer {
            Some(renderer) => renderer,
            None => renderer.insert(Renderer::new(Settings { threads: 1, ..job.settings.clone() })?),
        };
        Ok(painter.render(&scene, &viewport)?)
    }
}

fn scene(tree: &usvg::Tree, part: &Part) -> Result<Scene, Error> {
    match part {
        Part::Element { id, .. } => Scene::from_element(tree, id),
        Part::Page | Part::Drawing => Scene::from_tree(tree),
    }
}

fn exists(target: &Target) -> bool {
    matches!(target, Target::File(path) if path.metadata().is_ok_and(|m| m.is_file() && m.len() > 0))
}

/// What an animated drawing shows at its start: the viewport of all its frames, and what to warn of.
fn first_look(timeline: &Timeline, name: &str, picture: &RenderJob) -> Result<Viewport, Failure> {
    let (tree, unmatched) = load::tree_and_warnings(timeline.document_at(0.0).as_bytes(), &picture.options)?;
    let viewport = size::viewport(&tree, &picture.part, picture.fit, picture.max_pixels)?;
    report::warnings(name, scene(&tree, &picture.part)?.warnings(), picture.voice);
    report::warnings(name, &unmatched, picture.voice);
    if let Some(what) = timeline.not_evaluated().filter(|_| !picture.voice.quiet) {
        report::line(&format!("{name}: warning: not animated: {what}"));
    }
    Ok(viewport)
}

/// The frames of an animated drawing: number N is shown (N - start) / fps after the start.
fn sampled(job: &FramesJob, name: &str, count: u64, rate: Rate) -> Result<Vec<Frame>, Failure> {
    let (start, most) = (job.start_number, job.options.max_frames);
    let numbers = match &job.options.frames {
        Some(list) if list.count_at_most() > most => return Err(too_many(list.count_at_most(), most)),
        Some(list) => list.numbers(),
        None if count > most => return Err(too_many(count, most)),
        None => (start..start.saturating_add(count)).collect(),
    };
    if let Some(early) = numbers.first().filter(|&&number| number < start) {
        return Err(Failure::input(format!(
            "frame {early} is before the first (the first is {start}; --start-number says so)"
        )));
    }
    let frame = |number: u64| Frame {
        number,
        name: format!("{name}: frame {number}"),
        what: What::At(rate.time(number - start)),
    };
    Ok(numbers.into_iter().map(frame).collect())
}

/// Drawings as frames: by the numbers in their names, or counted.
fn listed(job: &FramesJob, files: &[Numbered]) -> Vec<Frame> {
    let wanted = job.options.frames.as_ref();
    let frames = files.iter().zip(job.start_number..).map(|((number, source), counted)| Frame {
        number: number.unwrap_or(counted),
        name: source.name(),
        what: What::Drawing(source.clone()),
    });
    frames.filter(|frame| wanted.is_none_or(|list| list.contains(frame.number))).collect()
}

/// Part `i` of `n`, counted from 1, as equal as can be.
fn chunk(mut frames: Vec<Frame>, part: Option<(u64, u64)>) -> Vec<Frame> {
    if let Some((i, n)) = part {
        let at = |part: u64| (frames.len() as u128 * u128::from(part) / u128::from(n)) as usize;
        let (from, to) = (at(i - 1), at(i));
        frames.truncate(to);
        frames.drain(..from);
    }
    frames
}

fn too_many(count: u64, most: u64) -> Failure {
    Failure::input(format!(
        "{count} frames are more than {most} (ask for fewer with --frames or --fps, or raise --max-frames)"
    ))
}
