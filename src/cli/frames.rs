//! The frames job: an animated drawing, or many drawings, to a sequence of files or to one that holds
//! all frames. Frames are made on all threads, each whole, and are the same bytes as one by one.

use super::movie::{Look, Reel};
use super::output::Output;
use super::painting::{Film, Frame, Painter, Shutter, Studio, What};
use super::perf::SequencePerf;
use super::places::Target;
use super::render::RenderJob;
use super::report::{self, Failure, Progress};
use super::sequence::{Destination, Numbered, Origin};
use super::values::{self, Format, YuvChoice};
use super::view::{Seen, View};
use super::{input, render, temporary};
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;
use toon_raster::encode::{Layout, Rate};
use toon_raster::frames::gallery::Made;
use toon_raster::frames::list::FrameList;
use toon_raster::frames::packing::Packing;
use toon_raster::frames::sequence::in_order;
use toon_raster::frames::Timeline;
use toon_raster::render::Canvas;
use toon_raster::{Error, Viewport};

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
    /// How often a GIF, APNG or WebP plays; 0 is for ever
    #[arg(long = "loop", value_name = "N", default_value_t = 0)]
    pub plays: u16,
    /// One PNG with the frames in rows of COLS, and a JSON of where they are
    #[arg(long, value_name = "COLSx", value_parser = values::columns)]
    pub sheet: Option<u32>,
    /// Chroma and matrix of video: 444 or 420, 601 or 709 [default: y4m 444,601; mp4 and webm 420,709]
    #[arg(long, value_name = "LIST", value_parser = values::yuv)]
    pub yuv: Option<YuvChoice>,
    /// Motion blur: how long the shutter is open, 360 being the time of a frame
    #[arg(long, value_name = "DEGREES", value_parser = values::shutter)]
    pub shutter: Option<f64>,
    /// Moments that a blurred frame is the mean of
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub shutter_samples: u32,
    /// Render each frame also without reusing what others show, and fail if a byte differs
    #[arg(long)]
    pub verify_reuse: bool,
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
            || self.verify_reuse
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

/// What became of a frame that did not fail.
enum Done {
    Made,
    WasThere,
}

/// Does it.
pub fn run(job: FramesJob) -> ExitCode {
    let name = job.origin.name();
    render::on_a_deep_stack(|| match report::catching(|| Shoot::open(job)) {
        Ok(shoot) => shoot.run(),
        Err(failure) => {
            report::failure(&name, &failure);
            report::exit_code(1, &[failure])
        }
    })
}

/// A sequence of which all frames are known.
struct Shoot {
    job: FramesJob,
    frames: Vec<Frame>,
    rate: Rate,
    film: Option<Film>,
    threads: usize,
    started: Instant,
}

impl Shoot {
    /// Reads what is to be read first, and lists the frames.
    fn open(mut job: FramesJob) -> Result<Shoot, Failure> {
        let started = Instant::now();
        let rate = job.options.fps.unwrap_or(Rate { frames: 24, seconds: 1 });
        if let Some(folder) = &job.picture.plan.folder {
            std::fs::create_dir_all(folder)
                .map_err(|e| Failure::io(format!("the folder {} cannot be made: {e}", folder.display())))?;
        }
        let mut film = None;
        let frames = match &job.origin {
            Origin::Animated(source) => {
                let name = source.name();
                let bytes = input::read(source)?;
                let view = &mut job.picture.view;
                view.stand_at(source);
                let timeline = Timeline::read(&bytes, &view.options)?;
                let viewport = first_look(&timeline, &name, view)?;
                let count = timeline.length().frames(rate.fps());
                film = Some(Film { timeline, viewport });
                sampled(&job, &name, count, rate)?
            }
            Origin::Files(files) => {
                // The frames of a film stand side by side.
                if let Some((_, source)) = files.first() {
                    job.picture.view.stand_at(source);
                }
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
        let threads = job.picture.view.settings.thread_count();
        Ok(Shoot { job, frames, rate, film, threads, started })
    }

    fn run(self) -> ExitCode {
        let mut progress = Progress::new(self.job.picture.progress, self.frames.len());
        let options = &self.job.options;
        let samples = options.shutter_samples;
        let open = |degrees: f64| Shutter { open: degrees / 360.0 / self.rate.fps(), samples };
        let shutter = options.shutter.map(open);
        let workers = self.threads.min(self.frames.len());
        let packing = Packing::new(self.job.picture.effort, self.job.picture.view.is_opaque());
        let (view, film) = (&self.job.picture.view, self.film.as_ref());
        let studio = Studio::new((view, film), shutter, options.verify_reuse, workers, packing);
        let (failures, made) = match &self.job.destination {
            Destination::One(target) => self.to_one(&studio, target, &mut progress),
            _ => (self.to_files(&studio, &mut progress), true),
        };
        progress.clear();
        let again = failures.windows(2).filter(|two| self.is_told(&two[1], &two[..1])).count();
        if again > 0 {
            report::line(&format!("{}: the same in {again} more frames", self.job.origin.name()));
        }
        if let Some(style) = self.job.picture.perf {
            self.perf(&studio).print(style);
        }
        // Without a file, all frames are lost with the one that failed.
        report::exit_code(if made { self.frames.len() } else { failures.len() }, &failures)
    }

    fn perf(&self, studio: &Studio) -> SequencePerf {
        SequencePerf {
            input: self.job.origin.name(),
            frames: self.frames.len(),
            work: studio.work(),
            threads: self.threads,
            total: self.started.elapsed(),
        }
    }

    /// Tells of a frame's failure.
    fn tell(&self, name: &str, failure: &Failure, before: &[Failure]) {
        if !self.is_told(failure, before) {
            report::failure(name, failure);
        }
    }

    /// What is wrong with one frame of a drawing is often wrong with all: that is said once.
    fn is_told(&self, failure: &Failure, before: &[Failure]) -> bool {
        matches!(self.job.origin, Origin::Animated(_)) && before.last() == Some(failure)
    }

    fn to_files(&self, studio: &Studio, progress: &mut Progress) -> Vec<Failure> {
        let make = |painter: &mut Painter, n: usize| {
            report::catching(|| self.to_file(studio, painter, &self.frames[n]))
        };
        let mut failures = Vec::new();
        let sink = |n: usize, done: Result<Done, Failure>| {
            let frame = &self.frames[n];
            match done {
                Ok(Done::Made) => progress.tick(&frame.name, true),
                Ok(Done::WasThere) => progress.skip(&frame.name),
                Err(failure) => {
                    progress.clear();
                    self.tell(&frame.name, &failure, &failures);
                    // Where this one cannot be written, no other can.
                    let nowhere = matches!(failure, Failure::Place(_));
                    failures.push(failure);
                    progress.tick(&frame.name, false);
                    return !nowhere;
                }
            }
            true
        };
        let done = in_order(self.frames.len(), self.threads, || studio.painter(), make, sink);
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

    fn to_file(&self, studio: &Studio, painter: &mut Painter, frame: &Frame) -> Result<Done, Failure> {
        let target = self.target(frame);
        if self.job.options.skip_existing && exists(&target) {
            return Ok(Done::WasThere);
        }
        let made = studio.picture(painter, frame);
        let canvas = made.as_ref().as_ref().map_err(Clone::clone)?;
        let mut output = Output::create(&target)?;
        self.write(&mut output, studio, canvas).map_err(|e| match e {
            Error::Io(e) => output.failure(&e),
            other => other.into(),
        })?;
        output.commit().map(|()| Done::Made)
    }

    fn write(&self, output: &mut Output, studio: &Studio, canvas: &Canvas) -> Result<(), Error> {
        match self.job.picture.plan.format {
            Format::Rgba => Ok(output.write_all(canvas.picture().data())?),
            _ => studio.packing.write(output, canvas),
        }
    }

    /// What failed, and whether the file was made all the same.
    fn to_one(&self, studio: &Studio, target: &Target, progress: &mut Progress) -> (Vec<Failure>, bool) {
        let mut failures = Vec::new();
        if self.frames.is_empty() || (self.job.options.skip_existing && exists(target)) {
            return (failures, true);
        }
        // Whose fault it is if no file is made.
        let mut name = self.job.origin.name();
        let done = Output::create(target).and_then(|mut output| {
            let size =
                self.shoot(studio, &mut output, progress, &mut failures, &mut name).map_err(|e| match e {
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
        studio: &Studio,
        output: &mut Output,
        progress: &mut Progress,
        failures: &mut Vec<Failure>,
        stopped_at: &mut String,
    ) -> Result<Option<(u32, u32)>, Error> {
        let look = self.look();
        let mut reel = Reel::new(output, &look);
        let mut stopped = None;
        let make = |painter: &mut Painter, n: usize| {
            report::catching(|| Ok::<_, Failure>(studio.picture(painter, &self.frames[n])))
        };
        let sink = |n: usize, made: Result<Made<Failure>, Failure>| {
            let name = &self.frames[n].name;
            let failed = match &made {
                Ok(frame) => frame.as_ref().as_ref().err(),
                Err(failure) => Some(failure),
            };
            let (added, ok) = match (&made, failed) {
                (Ok(frame), None) => (reel.add(frame), true),
                (_, Some(failure)) => {
                    progress.clear();
                    self.tell(name, failure, failures);
                    failures.push(failure.clone());
                    (reel.repeat(), false)
                }
                (Err(_), None) => unreachable!("a failure is one"),
            };
            progress.tick(name, ok && added.is_ok());
            stopped = added.err();
            if stopped.is_some() {
                stopped_at.clone_from(name);
            }
            stopped.is_none()
        };
        in_order(self.frames.len(), self.threads, || studio.painter(), make, sink)?;
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
            opaque: self.job.picture.view.is_opaque(),
            rate: self.rate,
            effort: self.job.picture.effort,
            plays,
            sheet,
            yuv: yuv.unwrap_or_default(),
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
}

/// Whether a file is there; if so, nothing unfinished is left beside it.
fn exists(target: &Target) -> bool {
    let Target::File(path) = target else { return false };
    let there = path.metadata().is_ok_and(|m| m.is_file() && m.len() > 0);
    if there {
        temporary::clear(path);
    }
    there
}

/// What an animated drawing shows at its start: the viewport of all its frames, and what to warn of.
fn first_look(timeline: &Timeline, name: &str, view: &View) -> Result<Viewport, Failure> {
    let Seen { viewport, .. } = view.see(timeline.document_at(0.0).as_bytes(), name)?;
    if let Some(what) = timeline.not_evaluated().filter(|_| !view.voice.quiet) {
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
