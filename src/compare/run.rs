//! Takes a [`Subject`] and [`Options`], makes a [`Comparison`]: the truth first, then a picture of each
//! method and its errors, then rounds of timed runs in which the methods take turns (A B C A B C …, so
//! that a busy moment of the machine falls on all), then the rest.
//!
//! Promises: a method that cannot do this drawing is a record that says why; it ends nothing.

use super::curves::curves;
use super::flip::{mean, Flip};
use super::picture::Shown;
use super::record::{ErrorFigures, Ratios, Record, Stage};
use super::seams::seams;
use super::spots::spots;
use super::ssim::ssim;
use super::standard::{About, Source};
use super::temporal::Panned;
use super::timing::{milliseconds, ratio, Spread};
use super::{Options, Subject};
use crate::encode::{Effort, PngWriter};
use crate::reference::Truth;
use crate::{Error, Method, Pixmap, Renderer, Settings};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::time::{Duration, Instant};

/// Runs with the clock read in every stage.
const STAGE_RUNS: usize = 3;

/// Pictures of more pixels are not judged by SSIM and FLIP, which take some 100 bytes a pixel.
const MOST_SEEN: usize = 1 << 23;

/// What came out, one drawing.
pub struct Comparison {
    /// The drawing's name.
    pub input: String,
    /// One a method, then one a picture of another renderer.
    pub records: Vec<Record>,
    /// Their pictures, in the same order.
    pub pictures: Vec<Option<Pixmap>>,
    /// What they are held against.
    pub truth: Truth,
}

/// How many times [`compare`] calls `watch` for one drawing.
pub fn steps(options: &Options) -> usize {
    let methods = options.methods.len();
    let optional = |wanted: bool| if wanted { methods } else { 0 };
    let pan = options.pan.map_or(0, |_| methods + 1);
    1 + methods + options.runs + methods + pan + optional(options.curves)
}

/// Compares. `watch` is told what begins; it is called [`steps`] times.
///
/// # Errors
/// As [`crate::reference::render`], and [`Error::Size`] when another renderer's picture has another
/// size than this drawing's.
pub fn compare(
    subject: &Subject,
    options: &Options,
    watch: &mut dyn FnMut(&str),
) -> Result<Comparison, Error> {
    let (width, height) = (subject.viewport.width, subject.viewport.height);
    for (name, picture) in &options.against {
        if (picture.width(), picture.height()) != (width, height) {
            return Err(Error::Size(format!(
                "{name} has {} x {} pixels, the drawing {width} x {height} (choose the drawing's size with -w, -h or -z)",
                picture.width(),
                picture.height()
            )));
        }
    }
    watch("reference");
    let source = Source::new(subject.bytes, subject.tree, options.cache.as_ref());
    let standard = source.standard(&subject.viewport, &options.reference(), options.check_reference)?;
    let judge = Judge::new(&standard.truth);
    let mut runners = Vec::new();
    for &method in &options.methods {
        watch(&method.to_string());
        runners.push(Runner::new(method, subject, options, &standard.about, &judge));
    }
    rounds(&mut runners, subject, options, watch);
    for runner in &mut runners {
        watch(&format!("{}, stage by stage", runner.record.method));
        runner.finish(subject, options);
    }
    pan(&mut runners, &source, subject, options, watch);
    if options.curves {
        for runner in &mut runners {
            watch(&format!("{}, curves", runner.record.method));
            if runner.renderer.is_some() {
                let Subject { scene, viewport, .. } = subject;
                let made = guarded(|| Ok(curves(runner.method, scene, viewport, &standard.truth, options)));
                runner.record.curves = made.unwrap_or_default();
            }
        }
    }
    let (mut records, mut pictures): (Vec<Record>, Vec<Option<Pixmap>>) =
        runners.into_iter().map(|runner| (runner.record, runner.picture)).unzip();
    for (name, picture) in &options.against {
        let mut record = blank(name.clone(), subject, options, &standard.about);
        record.against = true;
        judge.measure(picture, &mut record);
        records.push(record);
        pictures.push(Some(picture.clone()));
    }
    Ok(Comparison { input: subject.name.clone(), records, pictures, truth: standard.truth })
}

/// Holds pictures against the truth.
struct Judge<'a> {
    truth: &'a Truth,
    /// How the truth is seen; `None` where it is too large for that.
    seen: Option<(Shown, Flip)>,
}

impl<'a> Judge<'a> {
    fn new(truth: &'a Truth) -> Judge<'a> {
        let shown = (truth.premultiplied().len() <= MOST_SEEN).then(|| Shown::of_truth(truth));
        Judge { truth, seen: shown.map(|shown| (shown.clone(), Flip::new(&shown))) }
    }

    fn measure(&self, picture: &Pixmap, record: &mut Record) {
        let errors = self.truth.errors(picture);
        let (similarity, flip) = match &self.seen {
            Some((truth, truth_flip)) => {
                let shown = Shown::of_pixmap(picture);
                let flip = mean(&truth_flip.difference(&Flip::new(&shown)));
                (Some(ssim(truth, &shown)), Some(flip))
            }
            None => (None, None),
        };
        record.error = Some(ErrorFigures::new(&self.truth.compare(picture), similarity, flip));
        record.seams = Some(seams(self.truth, &errors));
        record.worst = spots(picture.width(), &errors);
    }
}

/// One method at work.
struct Runner {
    method: Method,
    renderer: Option<Renderer>,
    picture: Option<Pixmap>,
    /// Runs that there is time for.
    runs: usize,
    /// One a round; `None` where it did not run.
    times: Vec<Option<Duration>>,
    record: Record,
}

impl Runner {
    /// Renders for the first time, which warms up the method and tells how many runs there is time for.
    fn new(method: Method, subject: &Subject, options: &Options, about: &About, judge: &Judge) -> Runner {
        let mut record = blank(method.to_string(), subject, options, about);
        let first = guarded(|| {
            let mut renderer = Renderer::new(options.settings(method))?;
            let begun = Instant::now();
            let picture = renderer.render(subject.scene, &subject.viewport)?;
            Ok((renderer, picture, begun.elapsed()))
        });
        let (renderer, picture, runs, times) = match first {
            Ok((renderer, picture, took)) => {
                judge.measure(&picture, &mut record);
                let fit = options.budget.as_secs_f64() / took.as_secs_f64().max(1e-9);
                let runs = (fit as usize).min(options.runs);
                if runs < options.runs {
                    let of = options.runs;
                    let budget = options.budget.as_secs_f64();
                    record.notes.push(format!(
                        "{} of {of} runs: more would take longer than {budget} s",
                        runs.max(1)
                    ));
                }
                // Too slow for another: the first one is the one that counts.
                let times = if runs == 0 { vec![Some(took)] } else { Vec::new() };
                (Some(renderer), Some(picture), runs, times)
            }
            Err(why) => {
                record.failed = Some(why);
                (None, None, 0, Vec::new())
            }
        };
        Runner { method, renderer, picture, runs, times, record }
    }

    /// One timed run.
    fn run(&mut self, subject: &Subject) -> Option<Duration> {
        let (renderer, picture) = (self.renderer.as_mut()?, self.picture.as_mut()?);
        let stride = picture.stride();
        let begun = Instant::now();
        let rendered = guarded(|| {
            renderer.render_into(subject.scene, &subject.viewport, picture.data_mut(), stride)?;
            Ok(begun.elapsed())
        });
        rendered.map_err(|why| self.fail(why)).ok()
    }

    fn fail(&mut self, why: String) {
        self.renderer = None;
        self.picture = None;
        self.record.failed = Some(why);
    }

    /// Sums the rounds up, and takes the times that are not taken in rounds.
    fn finish(&mut self, subject: &Subject, options: &Options) {
        self.record.raster_ms = Spread::of(self.times.iter().flatten().copied());
        let (Some(picture), Some(_)) = (&self.picture, &self.renderer) else { return };
        let opaque = options.background.is_some_and(|colour| colour[3] == 255);
        self.record.encode_ms = encode(picture, opaque).ok().map(milliseconds);
        let settings = Settings { stage_times: true, ..options.settings(self.method) };
        let runs = self.runs.clamp(1, STAGE_RUNS);
        self.record.stages = guarded(|| stages(settings, runs, subject)).unwrap_or_default();
    }
}

/// The methods take turns.
fn rounds(runners: &mut [Runner], subject: &Subject, options: &Options, watch: &mut dyn FnMut(&str)) {
    for round in 0..options.runs {
        watch(&format!("run {} of {}", round + 1, options.runs));
        for runner in runners.iter_mut().filter(|runner| runner.times.len() <= round) {
            let time = if round < runner.runs { runner.run(subject) } else { None };
            runner.times.push(time);
        }
    }
    let times = |method: Method| {
        let base = runners.iter().find(|runner| runner.method == method);
        base.map(|runner| runner.times.clone()).unwrap_or_default()
    };
    let (exact, tiny_skia) = (times(Method::Exact), times(Method::TinySkia));
    for runner in runners {
        runner.record.times =
            Ratios { exact: ratio(&runner.times, &exact), tiny_skia: ratio(&runner.times, &tiny_skia) };
    }
}

fn pan(
    runners: &mut [Runner],
    source: &Source,
    subject: &Subject,
    options: &Options,
    watch: &mut dyn FnMut(&str),
) {
    let Some(steps) = options.pan else { return };
    watch("reference of the pan");
    let panned = Panned::new(source, &subject.viewport, options, steps);
    for runner in runners {
        watch(&format!("{}, pan", runner.record.method));
        if runner.renderer.is_none() {
            continue;
        }
        let seen = match &panned {
            Ok(panned) => {
                runner.record.notes.extend(panned.note.clone());
                guarded(|| panned.seen_by(runner.method, subject.scene, options))
            }
            Err(e) => Err(e.to_string()),
        };
        match seen {
            Ok(pan) => runner.record.pan = Some(pan),
            Err(why) => runner.record.notes.push(format!("no pan: {why}")),
        }
    }
}

fn stages(settings: Settings, runs: usize, subject: &Subject) -> Result<Vec<Stage>, Error> {
    let mut renderer = Renderer::new(settings)?;
    let mut all: Vec<(&'static str, Vec<Duration>)> = Vec::new();
    for _ in 0..runs {
        let begun = Instant::now();
        renderer.render(subject.scene, &subject.viewport)?;
        let whole = begun.elapsed();
        let mut times = renderer.stages().times.clone();
        // A method that does not tell its stages apart spends its time between them.
        times.retain(|(_, time)| !time.is_zero());
        let told: Duration = times.iter().map(|(_, time)| *time).sum();
        times.push(("other", whole.saturating_sub(told)));
        for (name, time) in times {
            match all.iter_mut().find(|(known, _)| *known == name) {
                Some((_, times)) => times.push(time),
                None => all.push((name, vec![time])),
            }
        }
    }
    Ok(all.into_iter().filter_map(|(name, times)| Some(Stage { name, ms: Spread::of(times)? })).collect())
}

fn encode(picture: &Pixmap, opaque: bool) -> Result<Duration, Error> {
    let begun = Instant::now();
    let mut png = PngWriter::new(Vec::new(), picture.width(), picture.height(), opaque, Effort::default())?;
    png.write_rows(picture.data())?;
    png.finish()?;
    Ok(begun.elapsed())
}

/// A record with nothing measured yet.
fn blank(method: String, subject: &Subject, options: &Options, about: &About) -> Record {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    Record {
        input: subject.name.clone(),
        width: subject.viewport.width,
        height: subject.viewport.height,
        method,
        against: false,
        threads: if options.threads == 0 { cores() } else { options.threads },
        parse_ms: milliseconds(subject.parse),
        raster_ms: None,
        encode_ms: None,
        stages: Vec::new(),
        times: Ratios::default(),
        error: None,
        seams: None,
        worst: Vec::new(),
        pan: None,
        curves: Vec::new(),
        reference: about.clone(),
        failed: None,
        notes: Vec::new(),
    }
}

/// What `work` makes; an error or a panic becomes the reason.
fn guarded<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<T, String> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(made)) => Ok(made),
        Ok(Err(e)) => Err(e.to_string()),
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map(String::as_str);
            let why = why.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
            Err(format!("internal error: {why}"))
        }
    }
}
