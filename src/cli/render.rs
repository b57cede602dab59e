//! The render job: every input of the plan to its place, one after the other.
//!
//! Where there are several threads, encoding overlaps rasterizing: the rows go to an encoder thread
//! through a short queue, so that the picture is still never in memory whole.

use super::input;
use super::output::Output;
use super::perf::Perf;
use super::places::{Plan, Source, Target};
use super::report::{self, Failure, Progress};
use super::values::{Format, PerfStyle, ProgressStyle};
use super::view::{Seen, View};
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::mpsc;
use std::time::{Duration, Instant};
use toon_raster::encode::{Effort, PngWriter};
use toon_raster::{Error, Renderer, Scene, Viewport};

/// Drawings to pictures.
pub struct RenderJob {
    pub plan: Plan,
    pub view: View,
    pub effort: Effort,
    pub perf: Option<PerfStyle>,
    pub progress: ProgressStyle,
}

/// Stack of the working thread: drawings may be nested a thousand levels deep.
const DEEP_STACK: usize = 64 << 20;

/// Pictures of fewer pixels are encoded before a second thread would have begun.
const WORTH_A_THREAD: u64 = 1 << 16;

/// Bands waiting for the encoder.
const QUEUE: usize = 4;

/// Does it.
pub fn run(job: RenderJob) -> ExitCode {
    on_a_deep_stack(|| run_here(job))
}

/// Runs `work` on a thread with room for deep drawings, or right here if there is no thread to be had.
pub fn on_a_deep_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let mut work = Some(work);
    let done = std::thread::scope(|scope| {
        let work = &mut work;
        let thread = std::thread::Builder::new().stack_size(DEEP_STACK);
        let thread = thread.spawn_scoped(scope, || work.take().expect("taken once")());
        thread.ok().and_then(|thread| thread.join().ok())
    });
    done.unwrap_or_else(|| work.take().expect("the thread did not begin")())
}

fn run_here(mut job: RenderJob) -> ExitCode {
    let tasks = std::mem::take(&mut job.plan.tasks);
    if let Some(folder) = &job.plan.folder {
        if let Err(e) = std::fs::create_dir_all(folder) {
            let failure = Failure::io(format!("the folder cannot be made: {e}"));
            report::failure(&folder.display().to_string(), &failure);
            return report::exit_code(1, &[failure]);
        }
    }
    let mut progress = Progress::new(job.progress, tasks.len());
    let mut failures = Vec::new();
    let mut renderer = None;
    for (source, target) in &tasks {
        let done = report::catching(|| one(&mut job, source, target, &mut renderer));
        if let Err(failure) = done {
            progress.clear();
            report::failure(&source.name(), &failure);
            // After a panic the renderer's buffers are in an unknown state.
            renderer = None;
            let nowhere = matches!(failure, Failure::ClosedPipe | Failure::Place(_));
            failures.push(failure);
            if nowhere {
                break;
            }
            progress.tick(&source.name(), false);
        } else {
            progress.tick(&source.name(), true);
        }
    }
    progress.clear();
    report::exit_code(tasks.len(), &failures)
}

fn one(
    job: &mut RenderJob,
    source: &Source,
    target: &Target,
    renderer: &mut Option<Renderer>,
) -> Result<(), Failure> {
    let started = Instant::now();
    let bytes = input::read(source)?;
    let read = started.elapsed();
    let parsing = Instant::now();
    let Seen { scene, viewport, .. } = job.view.open(source, &bytes)?;
    drop(bytes);
    let parse = parsing.elapsed();

    let renderer = match renderer {
        Some(renderer) => renderer,
        None => renderer.insert(Renderer::new(job.view.settings.clone())?),
    };
    let mut output = Output::create(target)?;
    let times = picture(job, renderer, &scene, &viewport, &mut output);
    let (raster, encode) = times.map_err(|e| match e {
        Error::Io(e) => output.failure(&e),
        other => other.into(),
    })?;
    output.commit()?;
    if let Some(style) = job.perf {
        let perf = Perf {
            input: source.name(),
            output: target.name(),
            width: viewport.width,
            height: viewport.height,
            threads: job.view.settings.thread_count(),
            read,
            parse,
            raster,
            encode,
            total: started.elapsed(),
            stages: renderer.stages().clone(),
        };
        perf.print(style);
    }
    Ok(())
}

/// Renders and encodes; the time of each.
fn picture(
    job: &RenderJob,
    renderer: &mut Renderer,
    scene: &Scene,
    viewport: &Viewport,
    output: &mut Output,
) -> Result<(Duration, Duration), Error> {
    let pixels = viewport.width as u64 * viewport.height as u64;
    if job.view.settings.thread_count() > 1 && pixels >= WORTH_A_THREAD {
        overlapped(job, renderer, scene, viewport, output)
    } else {
        in_turn(job, renderer, scene, viewport, output)
    }
}

fn in_turn(
    job: &RenderJob,
    renderer: &mut Renderer,
    scene: &Scene,
    viewport: &Viewport,
    output: &mut Output,
) -> Result<(Duration, Duration), Error> {
    let started = Instant::now();
    let mut encode = Duration::ZERO;
    let mut encoder = Encoder::new(job, viewport, output)?;
    renderer.render_bands(scene, viewport, |rows| {
        let begun = Instant::now();
        encoder.write_rows(rows)?;
        encode += begun.elapsed();
        Ok(())
    })?;
    let begun = Instant::now();
    encoder.finish()?;
    encode += begun.elapsed();
    Ok((started.elapsed().saturating_sub(encode), encode))
}

fn overlapped(
    job: &RenderJob,
    renderer: &mut Renderer,
    scene: &Scene,
    viewport: &Viewport,
    output: &mut Output,
) -> Result<(Duration, Duration), Error> {
    let started = Instant::now();
    let mut waited = Duration::ZERO;
    std::thread::scope(|scope| {
        let (full, to_encode) = mpsc::sync_channel::<Vec<u8>>(QUEUE);
        let (empty, to_fill) = mpsc::channel::<Vec<u8>>();
        let thread = std::thread::Builder::new().name("encoder".to_string());
        let thread = thread.spawn_scoped(scope, move || -> Result<Duration, Error> {
            let mut encode = Duration::ZERO;
            let mut encoder = Encoder::new(job, viewport, output)?;
            for rows in to_encode {
                let begun = Instant::now();
                encoder.write_rows(&rows)?;
                encode += begun.elapsed();
                // The renderer may be done already and want no buffer back.
                let _ = empty.send(rows);
            }
            let begun = Instant::now();
            encoder.finish()?;
            Ok(encode + begun.elapsed())
        })?;
        let rendered = renderer.render_bands(scene, viewport, |rows| {
            let mut buffer = to_fill.try_recv().unwrap_or_default();
            buffer.clear();
            buffer.extend_from_slice(rows);
            let begun = Instant::now();
            // The encoder hangs up only when it has failed; its own error says why.
            full.send(buffer).map_err(|_| Error::Io(io::ErrorKind::Interrupted.into()))?;
            waited += begun.elapsed();
            Ok(())
        });
        let raster = started.elapsed().saturating_sub(waited);
        drop(full);
        let encoded = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        match (rendered, encoded) {
            (Err(Error::Io(_)), Err(e)) => Err(e),
            (Err(e), _) | (Ok(()), Err(e)) => Err(e),
            (Ok(()), Ok(encode)) => Ok((raster, encode)),
        }
    })
}

/// Rows to bytes, in any format.
enum Encoder<'o> {
    Png(Box<PngWriter<&'o mut Output>>),
    Rgba(&'o mut Output),
}

impl<'o> Encoder<'o> {
    fn new(job: &RenderJob, viewport: &Viewport, output: &'o mut Output) -> Result<Encoder<'o>, Error> {
        // Whatever is painted over an opaque background leaves it opaque.
        let opaque = job.view.is_opaque();
        match job.plan.format {
            Format::Png => {
                let Viewport { width, height, .. } = *viewport;
                Ok(Encoder::Png(Box::new(PngWriter::new(output, width, height, opaque, job.effort)?)))
            }
            Format::Rgba => Ok(Encoder::Rgba(output)),
            _ => unreachable!("the frames job writes what holds many"),
        }
    }

    fn write_rows(&mut self, rows: &[u8]) -> Result<(), Error> {
        match self {
            Encoder::Png(png) => png.write_rows(rows),
            Encoder::Rgba(output) => Ok(output.write_all(rows)?),
        }
    }

    fn finish(self) -> Result<(), Error> {
        match self {
            Encoder::Png(png) => png.finish(),
            Encoder::Rgba(_) => Ok(()),
        }
    }
}
