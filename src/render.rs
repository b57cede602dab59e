//! Takes a [`Scene`], makes pixel rows: calls the stages in their order, and alone knows it.
//!
//! The stages: place the outlines and sort them into bands ([`crate::outlines`]); then for each band,
//! on any thread, from the front: flatten ([`crate::polygons`]), sort in y ([`crate::edges`]), clip to
//! strips and file in x-buckets ([`crate::strips`]), sweep into solid runs and fragments
//! ([`crate::sweep`]), keep what is seen in z-lists ([`crate::cel`]), and resolve those
//! ([`crate::pixel`]). Bands come out from the top.

mod reuse;

pub use reuse::{Canvas, TileCount};

use crate::band::{band_count, Laps, Picture};
use crate::cel::Rows;
use crate::edges::{BAND_ROWS, LARGEST_SIDE};
use crate::effects::highlights::Highlights;
use crate::effects::log::{EffectRuns, LitSurface, Log};
use crate::layers::{self, KeptLayers, Wanted};
use crate::methods::{painter, BandPainter, Method, Painter, PicturePainter};
use crate::outlines::{BandLists, Outlines};
use crate::pixel::resolve::Surroundings;
use crate::scene::paint::Sheet;
use crate::scene::shader::Shader;
use crate::scene::Role;
use crate::slabs::{Budget, Slabs};
use crate::tiles::TilePlan;
use crate::{Error, Pixmap, Scene};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// How a picture is made.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The way of anti-aliasing.
    pub method: Method,
    /// Farthest a flattened curve may lie from the true one, in output pixels; 1e-4 ..= 100. What a
    /// method needs is [`Method::tolerance`].
    pub tolerance: f64,
    /// Areas of different colour in a pixel are mixed in linear light; opacity still composites in
    /// sRGB encoding.
    pub linear: bool,
    /// Painted behind everything, straight RGBA; `None` keeps the picture's alpha.
    pub background: Option<[u8; 4]>,
    /// Pieces that Catmull's recursion may hold against regions in one pixel, before the pixel is
    /// sampled on 128 lines instead. Pixels whose closed form is known never come to it.
    pub most_work: u32,
    /// What is done about specular highlights (feSpecularLighting) that alias.
    pub highlights: Highlights,
    /// Component-transfer tables over noise (feComponentTransfer of feTurbulence) are averaged over each
    /// pixel by Worley's index anti-aliasing, where SVG's algorithm looks at one point.
    pub index_aa: bool,
    /// Width in pixels of the spot over which gradients are averaged where their colour map turns within
    /// it, 0 ..= 16; at 0 they are sampled at a point. The least error is at 1.
    pub spot_scale: f64,
    /// Threads to use; 0 for one a core. The bytes do not depend on it.
    pub threads: usize,
    /// Take the time of each stage for [`Renderer::stages`]. Without it no clock is read in a band.
    pub stage_times: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Exact,
            tolerance: Settings::DEFAULT_TOLERANCE,
            linear: false,
            background: None,
            most_work: Settings::DEFAULT_MOST_WORK,
            highlights: Highlights::AsIs,
            index_aa: false,
            spot_scale: 1.0,
            threads: 0,
            stage_times: false,
        }
    }
}

impl Settings {
    /// Keeps every pixel within one 8-bit level of the true curve's area.
    pub const DEFAULT_TOLERANCE: f64 = 0.01;
    /// A hundredth of a second or so for a pixel.
    pub const DEFAULT_MOST_WORK: u32 = 30_000;

    /// Threads that [`Settings::threads`] comes to.
    pub fn thread_count(&self) -> usize {
        match self.threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            threads => threads,
        }
    }

    /// Farthest that curves lie from their chords, in pixels: a dark mean of linear light errs more once it is
    /// encoded.
    pub(crate) fn flattening_tolerance(&self) -> f64 {
        const LINEAR_SHARE: f64 = 0.3;
        self.tolerance * if self.linear { LINEAR_SHARE } else { 1.0 }
    }

    /// The defaults of a method: curves are flattened only as finely as it can show.
    pub fn of(method: Method) -> Settings {
        Settings { method, tolerance: method.tolerance(), ..Settings::default() }
    }
}

/// The part of the plane that the picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Columns of the picture, 1 ..= 65,535.
    pub width: u32,
    /// Rows of the picture, 1 ..= 65,535.
    pub height: u32,
    /// From the scene's user units to pixels; (0, 0) is the top left corner of the first pixel.
    pub transform: kurbo::Affine,
}

impl Viewport {
    /// The whole drawing on `width` x `height` pixels, stretched where the aspect differs.
    pub fn fit(scene: &Scene, width: u32, height: u32) -> Viewport {
        let size = scene.size();
        let transform =
            kurbo::Affine::scale_non_uniform(width as f64 / size.width, height as f64 / size.height);
        Viewport { width, height, transform }
    }
}

/// Time and work of each stage of the last picture, summed over all threads.
#[derive(Clone, Debug, Default)]
pub struct Stages {
    /// Stage name and time, in the order in which they run. Unless [`Settings::stage_times`] asks for
    /// more, all that is done in bands is one stage, whose time is the clock's.
    pub times: Vec<(&'static str, Duration)>,
    /// Counter name and value: pixels by class, nodes of the recursion, fallbacks.
    pub counts: Vec<(&'static str, u64)>,
    /// What ran beyond flat shapes, clips and groups, those within layers too; empty for a scene that
    /// calls for no effect.
    pub effects: Vec<EffectRuns>,
    /// What aliases of each specular highlight, where [`Settings::stage_times`] asks.
    pub lit: Vec<LitSurface>,
}

/// Rows that are made before they are handed on: of four bands for each thread.
pub(crate) fn rows_at_once(threads: usize) -> u32 {
    4 * threads as u32 * BAND_ROWS
}

/// Renders scenes; keeps its buffers and threads from one picture to the next.
pub struct Renderer {
    settings: Settings,
    /// `None` with one thread.
    pool: Option<rayon::ThreadPool>,
    /// Idle painters for pictures of this size.
    idle: Mutex<Vec<Box<dyn BandPainter>>>,
    size: (u32, u32),
    /// Layers of the last picture rendered onto a canvas.
    layers: KeptLayers,
    stages: Stages,
    /// Where this draws a layer's content: what is left of the whole picture's budget.
    budget: Option<Budget>,
}

impl Renderer {
    /// A renderer with these settings.
    ///
    /// # Errors
    /// [`Error::Setting`] when a value is out of its range.
    pub fn new(settings: Settings) -> Result<Renderer, Error> {
        if !(1e-4..=100.0).contains(&settings.tolerance) {
            return Err(Error::Setting(format!(
                "tolerance {} is not within 0.0001 and 100 pixels",
                settings.tolerance
            )));
        }
        if !(0.0..=16.0).contains(&settings.spot_scale) {
            return Err(Error::Setting(format!(
                "a spot of {} pixels is not within 0 and 16",
                settings.spot_scale
            )));
        }
        painter(settings.method, 1, 1)?;
        let threads = settings.thread_count();
        let pool = match threads {
            1 => None,
            _ => Some(
                rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .map_err(|e| Error::Setting(format!("{threads} threads cannot be started: {e}")))?,
            ),
        };
        Ok(Renderer {
            settings,
            pool,
            idle: Mutex::default(),
            size: (0, 0),
            layers: KeptLayers::default(),
            stages: Stages::default(),
            budget: None,
        })
    }

    /// A renderer for a layer's content, whose own layers have this budget.
    pub(crate) fn for_layer(settings: Settings, budget: Budget) -> Result<Renderer, Error> {
        Ok(Renderer { budget: Some(budget), ..Renderer::new(settings)? })
    }

    /// Renders into a new picture.
    ///
    /// # Errors
    /// [`Error::Size`] when the viewport is empty or too large, or its transform is not finite;
    /// [`Error::Limit`] or [`Error::Setting`] when the method cannot make the picture ([`Method`]).
    pub fn render(&mut self, scene: &Scene, viewport: &Viewport) -> Result<Pixmap, Error> {
        check(viewport)?;
        let mut pixmap = Pixmap::new(viewport.width, viewport.height);
        let stride = pixmap.stride();
        self.render_into(scene, viewport, pixmap.data_mut(), stride)?;
        Ok(pixmap)
    }

    /// Renders into the caller's buffer: straight 8-bit RGBA, row `y` at `y * stride` bytes. Every
    /// pixel of the viewport is written, bytes between the rows are left alone.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Buffer`] when the buffer is too small.
    pub fn render_into(
        &mut self,
        scene: &Scene,
        viewport: &Viewport,
        buffer: &mut [u8],
        stride: usize,
    ) -> Result<(), Error> {
        check(viewport)?;
        let Viewport { width, height, .. } = *viewport;
        let row = width as usize * Pixmap::BYTES_PER_PIXEL;
        let needed = stride.max(row).saturating_mul(height as usize - 1).saturating_add(row);
        if stride < row || buffer.len() < needed {
            return Err(Error::Buffer { width, height, needed, given: buffer.len() });
        }
        if let Some(paint) = self.picture_painter() {
            return self.whole(paint, scene, viewport, buffer, stride);
        }
        let plan = |_: &Scene, _: &Outlines, _: &BandLists| None;
        self.prepare(scene, viewport, plan, |renderer, picture, bands| {
            let rows = &mut buffer[bands.start * BAND_ROWS as usize * stride..];
            renderer.bands(picture, height, bands.clone(), rows, stride);
            Ok(bands.end)
        })
        .map(drop)
    }

    /// Renders band by band, from the top: `sink` is given each time some whole rows without padding,
    /// and the whole picture is never in memory.
    ///
    /// # Errors
    /// As [`Renderer::render`], and what `sink` returns.
    pub fn render_bands(
        &mut self,
        scene: &Scene,
        viewport: &Viewport,
        mut sink: impl FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        check(viewport)?;
        let Viewport { width, height, .. } = *viewport;
        if self.picture_painter().is_some() {
            return sink(self.render(scene, viewport)?.data());
        }
        let stride = width as usize * Pixmap::BYTES_PER_PIXEL;
        let rows = rows_at_once(self.pool.as_ref().map_or(1, rayon::ThreadPool::current_num_threads));
        let at_once = (rows / BAND_ROWS) as usize;
        let mut buffer = vec![0; stride * rows.min(height) as usize];
        let plan = |_: &Scene, _: &Outlines, _: &BandLists| None;
        self.prepare(scene, viewport, plan, |renderer, picture, bands| {
            let (first, last) = (bands.start, bands.end.min(bands.start + at_once));
            let rows = (last * BAND_ROWS as usize).min(height as usize) - first * BAND_ROWS as usize;
            renderer.bands(picture, height, first..last, &mut buffer[..rows * stride], stride);
            sink(&buffer[..rows * stride])?;
            Ok(last)
        })
        .map(drop)
    }

    /// Time and work of each stage of the last picture.
    pub fn stages(&self) -> &Stages {
        &self.stages
    }

    /// Who paints the picture if the method needs it whole.
    fn picture_painter(&self) -> Option<PicturePainter> {
        // They are the same for all sizes, and for the smallest no buffers are made that are not used.
        match painter(self.settings.method, 1, 1) {
            Ok(Painter::Picture(paint)) => Some(paint),
            _ => None,
        }
    }

    /// Paints a picture whole.
    fn whole(
        &mut self,
        paint: PicturePainter,
        scene: &Scene,
        viewport: &Viewport,
        buffer: &mut [u8],
        stride: usize,
    ) -> Result<(), Error> {
        let start = Instant::now();
        let mut paint = || paint(scene, viewport, &self.settings, buffer, stride);
        match &self.pool {
            Some(pool) => pool.install(paint)?,
            None => paint()?,
        }
        self.stages = Stages { times: vec![("picture", start.elapsed())], ..Stages::default() };
        Ok(())
    }

    /// Places the scene's outlines, asks `plan` which tiles are to be rendered, then makes the layers of one
    /// slab after the other and calls `part` with bands of it, which says from which band on there is more to do.
    fn prepare(
        &mut self,
        scene: &Scene,
        viewport: &Viewport,
        plan: impl FnOnce(&Scene, &Outlines, &BandLists) -> Option<TilePlan>,
        mut part: impl FnMut(&Renderer, &Picture, Range<usize>) -> Result<usize, Error>,
    ) -> Result<Option<TilePlan>, Error> {
        let start = Instant::now();
        self.resize(viewport);
        let unfolded = self.settings.method.composites_regions().then(|| scene.unfolded()).flatten();
        let scene = unfolded.as_ref().unwrap_or(scene);
        let mut outlines = Outlines::new(scene, viewport, self.settings.method.is_jagged());
        let bands = BandLists::new(&outlines.shapes, viewport.height);
        let plan = plan(scene, &outlines, &bands);
        let log = scene.calls_for_effects().then(|| Log::new(self.settings.stage_times));
        let budget = self.budget.clone().unwrap_or_default();
        let slabs = match &log {
            Some(_) => Slabs::of(scene, viewport, &budget)?,
            None => Slabs::whole(viewport),
        };
        let background = self.settings.background.map_or(Sheet::CLEAR, |[r, g, b, a]| {
            Sheet::new([r, g, b].map(|c| f32::from(c) / 255.0), f32::from(a) / 255.0)
        });
        let Settings { linear, most_work, .. } = self.settings;
        let (mut placed, mut first) = (start.elapsed(), 0);
        let shaders = loop {
            let (slab, start) = (slabs.from(first), Instant::now());
            let wanted =
                plan.as_ref().map(|plan| Wanted { plan, outlines: &outlines, kept: &mut self.layers });
            let shaders = match &log {
                Some(log) => layers::shaders(scene, viewport, &self.settings, (&slab, &budget), log, wanted)?,
                None => Vec::new(),
            };
            placed += start.elapsed();
            let around = Surroundings { shaders: &shaders, background, linear, most_work };
            while first < slab.bands.end {
                let picture = Picture {
                    scene,
                    outlines: &outlines,
                    bands: &bands,
                    around: &around,
                    to_pixels: viewport.transform,
                    tolerance: self.settings.flattening_tolerance(),
                    width: viewport.width,
                    plan: plan.as_ref(),
                };
                first = part(self, &picture, first..slab.bands.end)?;
                outlines.forget_above(first * BAND_ROWS as usize);
            }
            if first == band_count(viewport.height) {
                break shaders;
            }
        };
        self.stages.times = vec![("place", placed)];
        let laps = self.take_laps();
        match laps.is_empty() {
            true => self.stages.times.push(("bands", start.elapsed() - placed)),
            false => self.stages.times.extend(laps),
        }
        self.stages.counts = self.take_counts();
        (self.stages.effects, self.stages.lit) = match log {
            Some(log) => effects_of(scene, &shaders, log),
            None => (Vec::new(), Vec::new()),
        };
        Ok(plan)
    }

    /// Drops buffers that do not fit the picture.
    fn resize(&mut self, viewport: &Viewport) {
        let size = (viewport.width, viewport.height);
        if size != self.size {
            self.idle.get_mut().expect("no thread panicked").clear();
            self.size = size;
        }
    }

    /// Renders some bands into `buffer`, which starts with the first of their rows.
    fn bands(&self, picture: &Picture, height: u32, bands: Range<usize>, buffer: &mut [u8], stride: usize) {
        let (width, first, timed) = (picture.width, bands.start, self.settings.stage_times);
        let render = |renderer: &mut dyn BandPainter, (i, bytes): (usize, &mut [u8])| {
            if picture.plan.is_some_and(|plan| plan.leaves(first + i)) {
                return;
            }
            let top = (first + i) as u32 * BAND_ROWS;
            let count = (height - top).min(BAND_ROWS) as usize;
            if timed {
                renderer.time_stages();
            }
            renderer.render(picture, first + i, Rows { bytes, stride, top, count });
        };
        let chunk = stride * BAND_ROWS as usize;
        let take = || self.idle.lock().expect("no thread panicked").pop();
        let new = || match painter(self.settings.method, width, height) {
            Ok(Painter::Bands(painter)) => painter,
            _ => unreachable!("pictures that are painted whole have no bands"),
        };
        let idle = || Returned { renderer: take().or_else(|| Some(new())), to: &self.idle };
        match &self.pool {
            None => {
                let mut renderer = idle();
                let chunks = buffer.chunks_mut(chunk).enumerate();
                chunks.take(bands.len()).for_each(|band| render(renderer.get(), band));
            }
            Some(pool) => pool.install(|| {
                let chunks = buffer.par_chunks_mut(chunk).enumerate();
                chunks.take(bands.len()).for_each_init(idle, |renderer, band| render(renderer.get(), band));
            }),
        }
    }

    /// The time of each stage within the bands, summed over all threads.
    fn take_laps(&self) -> Vec<(&'static str, Duration)> {
        if !self.settings.stage_times {
            return Vec::new();
        }
        let mut sums = Laps::default();
        for renderer in self.idle.lock().expect("no thread panicked").iter_mut() {
            sums.add(renderer.take_laps());
        }
        sums.named().into()
    }

    fn take_counts(&self) -> Vec<(&'static str, u64)> {
        let mut sums: Vec<(&'static str, u64)> = Vec::new();
        for renderer in self.idle.lock().expect("no thread panicked").iter_mut() {
            let counts = renderer.take_counts();
            match sums.is_empty() {
                true => sums = counts,
                false => sums.iter_mut().zip(counts).for_each(|((_, sum), (_, count))| *sum += count),
            }
        }
        sums
    }
}

/// What has run besides flat shapes, clips and groups.
fn effects_of(scene: &Scene, shaders: &[Option<Shader>], log: Log) -> (Vec<EffectRuns>, Vec<LitSurface>) {
    let gradients = || shaders.iter().flatten().filter_map(Shader::as_gradient);
    let in_groups = |is: fn(Role) -> bool| scene.groups.iter().filter(|group| is(group.role)).count();
    let masks = in_groups(|role| matches!(role, Role::Mask(_)));
    let blends = in_groups(|role| matches!(role, Role::Blend(_)));
    log.count("mask", masks as u64);
    log.count("mix-blend-mode", blends as u64);
    log.count("gradient", gradients().count() as u64);
    log.count("colour map", gradients().filter(|gradient| gradient.has_table()).count() as u64);
    let entries = log.into_entries();
    (entries.effects, entries.lit)
}

/// A painter that goes back to the idle ones when dropped.
struct Returned<'a> {
    renderer: Option<Box<dyn BandPainter>>,
    to: &'a Mutex<Vec<Box<dyn BandPainter>>>,
}

impl Returned<'_> {
    fn get(&mut self) -> &mut dyn BandPainter {
        self.renderer.as_deref_mut().expect("it is there until it is dropped")
    }
}

impl Drop for Returned<'_> {
    fn drop(&mut self) {
        if let (Some(renderer), Ok(mut idle)) = (self.renderer.take(), self.to.lock()) {
            idle.push(renderer);
        }
    }
}

fn check(viewport: &Viewport) -> Result<(), Error> {
    let Viewport { width, height, transform } = *viewport;
    let sides = 1..=LARGEST_SIDE;
    if !sides.contains(&width) || !sides.contains(&height) {
        return Err(Error::Size(format!(
            "a picture of {width} x {height} pixels is not within 1 and {LARGEST_SIDE} a side"
        )));
    }
    if !transform.is_finite() {
        return Err(Error::Size("the transform from the drawing to the picture is not finite".into()));
    }
    Ok(())
}
