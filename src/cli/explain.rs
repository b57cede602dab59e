//! The explain job: takes drawings, prints what each calls for, what will run for it and what that
//! costs, as a table or as one JSON object a line.

use super::perf::samples_a_side;
use super::places::Source;
use super::report::{self, Failure};
use super::view::{Seen, View};
use super::{input, render};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::ExitCode;
use toon_raster::frames::Timeline;
use toon_raster::plan::{LayerPlan, Pass};
use toon_raster::{
    Census, Highlights, LitSurface, Options, Plan, Renderer, Scene, Settings, Viewport, Warning,
};

/// What is asked of which drawings.
pub struct ExplainJob {
    pub inputs: Vec<Source>,
    pub json: bool,
    pub view: View,
}

/// Does it.
pub fn run(job: ExplainJob) -> ExitCode {
    render::on_a_deep_stack(|| run_here(job))
}

fn run_here(mut job: ExplainJob) -> ExitCode {
    let inputs = std::mem::take(&mut job.inputs);
    let mut failures = Vec::new();
    let mut above = "";
    for source in &inputs {
        match report::catching(|| one(&mut job, source)) {
            Ok(explanation) => {
                let printed = match job.json {
                    true => report::print(&explanation.json()),
                    false => report::print(&format!("{above}{}", explanation.table())),
                };
                if printed != ExitCode::SUCCESS {
                    return printed;
                }
                above = "\n";
            }
            Err(failure) => {
                report::failure(&source.name(), &failure);
                failures.push(failure);
            }
        }
    }
    report::exit_code(inputs.len(), &failures)
}

fn one(job: &mut ExplainJob, source: &Source) -> Result<Explanation, Failure> {
    let bytes = input::read(source)?;
    let Seen { scene, viewport, unmatched } = job.view.open(source, &bytes)?;
    let settings = &job.view.settings;
    let census = scene.census()?;
    let plan = Plan::of(&scene, &viewport, settings)?;
    let lights = match census.highlights > 0 && plan.refused.is_none() {
        true => lights(&scene, &viewport, settings)?,
        false => Vec::new(),
    };
    let warnings = scene.warnings().iter().chain(&unmatched);
    Ok(Explanation {
        input: source.name(),
        width: viewport.width,
        height: viewport.height,
        method: settings.method.to_string(),
        threads: settings.thread_count(),
        motion: Motion::of(&bytes, &job.view.options),
        not_drawn: warnings.map(not_drawn).collect(),
        settings: settings.clone(),
        census,
        plan,
        lights,
    })
}

fn not_drawn(Warning { kind, element, count }: &Warning) -> String {
    match count {
        1 => format!("{kind}: {element}"),
        _ => format!("{kind}: {element} and {} more", count - 1),
    }
}

/// What aliases of the highlights: told by their pixels, so that the picture has to be made.
fn lights(scene: &Scene, viewport: &Viewport, settings: &Settings) -> Result<Vec<Light>, Failure> {
    let mut renderer = Renderer::new(Settings { stage_times: true, ..settings.clone() })?;
    renderer.render_bands(scene, viewport, |_| Ok(()))?;
    let light = |lit: &LitSurface| Light {
        filter: lit.filter.clone(),
        exponent: lit.exponent,
        pixels: lit.pixels,
        aliasing: lit.aliasing,
        samples_a_side: samples_a_side(lit),
    };
    Ok(renderer.stages().lit.iter().map(light).collect())
}

/// One feSpecularLighting on one surface.
#[derive(Serialize)]
struct Light {
    filter: String,
    exponent: f32,
    pixels: u64,
    aliasing: u64,
    samples_a_side: u64,
}

/// What moves.
#[derive(Default, Serialize)]
struct Motion {
    /// Attributes and properties, each with how many elements it moves on.
    moving: BTreeMap<String, usize>,
    seconds: f64,
    repeats: bool,
    frames: u64,
    not_evaluated: Option<String>,
}

impl Motion {
    /// Frames a second if nothing else is said.
    const FPS: f64 = 24.0;

    fn of(bytes: &[u8], options: &Options) -> Motion {
        // What is wrong with the drawing has been found when it was parsed.
        let Ok(timeline) = Timeline::read(bytes, options) else { return Motion::default() };
        let not_evaluated = timeline.not_evaluated();
        if !timeline.is_animated() {
            return Motion { not_evaluated, ..Motion::default() };
        }
        let length = timeline.length();
        Motion {
            moving: timeline.moving(),
            seconds: length.seconds,
            repeats: length.repeats,
            frames: length.frames(Motion::FPS),
            not_evaluated,
        }
    }

    fn count(&self) -> usize {
        self.moving.values().sum()
    }
}

/// All that is found of one drawing.
struct Explanation {
    input: String,
    width: u32,
    height: u32,
    method: String,
    threads: usize,
    settings: Settings,
    census: Census,
    plan: Plan,
    lights: Vec<Light>,
    motion: Motion,
    not_drawn: Vec<String>,
}

/// Tables over noise, which `--index-aa` averages.
#[derive(Serialize)]
struct IndexAa {
    on: bool,
    tables: usize,
    /// What that takes: points at which there is noise once more.
    noise_points: u64,
}

/// One effect: its name in the JSON, how often the scene calls for it, and what that brings in.
struct Effect {
    name: &'static str,
    count: usize,
    machinery: &'static str,
}

impl Explanation {
    /// In the order in which they meet a shape.
    fn effects(&self) -> [Effect; 13] {
        let Census { opacity, groups, clips, masks, patterns, images, filters, highlights, .. } = self.census;
        let Census { linear_gradients, radial_gradients, text, blend_modes, .. } = self.census;
        let highlight = match self.settings.highlights {
            Highlights::AsIs => "Phong's highlight at one normal a pixel, as SVG has it",
            Highlights::Clamp => "exponents clamped where any of their cycles alias (Amanatides)",
            Highlights::Aggressive => {
                "exponents clamped where a thousandth of their power aliases (Amanatides)"
            }
            Highlights::Supersample => "up to 16 x 16 normals in pixels that alias",
        };
        let gradient = "evaluated where it is seen; tables of its colour map once that turns within a pixel";
        let by_region = "evaluated in each region of a pixel where the same shapes are seen; no layer";
        let in_layers = |what: &str| self.plan.layers.iter().any(|layer| layer.what.contains(what));
        let mask = match in_layers("mask") {
            true => "a layer of pixels for the content and one for the mask",
            false => by_region,
        };
        let blend = match in_layers("mix-blend-mode") {
            true => "a layer of pixels, and what lies below it drawn a second time there",
            false => by_region,
        };
        let pattern = match in_layers("pattern") {
            true => "a layer of pixels; tiles drawn one by one, or one copied if there are many",
            false => "the shapes of its few tiles; no layer",
        };
        let filter = match in_layers("filter") {
            true => "a layer of pixels over the filter region, and one for each primitive in use",
            false => "shapes in other colours; no layer",
        };
        [
            ("opacity", opacity, "what lies behind stays in the z-list and is composited"),
            ("groups", groups, "a cel of its own for each open group, one band high"),
            ("clips", clips, "geometry, cut by the same integrator as shapes"),
            ("masks", masks, mask),
            ("linear_gradients", linear_gradients, gradient),
            ("radial_gradients", radial_gradients, gradient),
            ("patterns", patterns, pattern),
            (
                "images",
                images,
                "decoded once; a layer of means over footprints where smaller, by four samples where larger",
            ),
            ("filters", filters, filter),
            ("highlights", highlights, highlight),
            ("text", text, "fonts are loaded; outlines like any others"),
            ("blend_modes", blend_modes, blend),
            ("animation", self.motion.count(), "a document for each frame, parsed and drawn like any other"),
        ]
        .map(|(name, count, machinery)| Effect { name, count, machinery })
    }

    fn index_aa(&self) -> IndexAa {
        let passes = || self.plan.layers.iter().flat_map(|layer| &layer.passes);
        IndexAa {
            on: self.settings.index_aa,
            tables: passes().filter(|pass| pass.is_table_over_noise).count(),
            noise_points: passes().map(Pass::noise_points).sum(),
        }
    }

    fn is_flat(&self) -> bool {
        self.census.is_flat() && self.motion.count() == 0
    }

    fn json(&self) -> String {
        #[derive(Serialize)]
        struct Counted<'a> {
            count: usize,
            machinery: Option<&'a str>,
        }
        // `explain`'s promise is these keys in this order; serde_json's maps would sort them.
        let mut text = String::from("{");
        let mut key = |name: &str, value: serde_json::Result<String>| {
            let comma = if text.len() > 1 { "," } else { "" };
            let value = value.expect("plain figures and text are JSON");
            let _ = write!(text, "{comma}\"{name}\":{value}");
        };
        key("input", serde_json::to_string(&self.input));
        key("width", serde_json::to_string(&self.width));
        key("height", serde_json::to_string(&self.height));
        key("method", serde_json::to_string(&self.method));
        key("threads", serde_json::to_string(&self.threads));
        key("shapes", serde_json::to_string(&self.census.shapes));
        key("segments", serde_json::to_string(&self.census.segments));
        key("edges", serde_json::to_string(&self.plan.edges));
        key("layers", serde_json::to_string(&self.plan.layers.len()));
        key("flat", serde_json::to_string(&self.is_flat()));
        for Effect { name, count, machinery } in self.effects() {
            let machinery = (count > 0).then_some(machinery);
            key(name, serde_json::to_string(&Counted { count, machinery }));
        }
        key("index_aa", serde_json::to_string(&self.index_aa()));
        key("motion", serde_json::to_string(&self.motion));
        key("lights", serde_json::to_string(&self.lights));
        key("plan", serde_json::to_string(&self.plan));
        key("not_drawn", serde_json::to_string(&self.not_drawn));
        text + "}\n"
    }

    fn table(&self) -> String {
        let Explanation { input, width, height, method, census, plan, .. } = self;
        let mut text = format!("{input}: {width} x {height} pixels, {method}, {} threads\n", self.threads);
        let mut line = |name: &str, count: &str, words: &str| {
            let _ = writeln!(text, "{name:>18} {count:>9}  {words}");
        };
        line("shapes", &census.shapes.to_string(), &format!("of {} lines and curves", census.segments));
        line("edges", &plan.edges.to_string(), "at this size, before what is hidden is left out");
        let effects = self.effects();
        for Effect { name, count, machinery } in effects.iter().filter(|effect| effect.count > 0) {
            line(&name.replace('_', " "), &count.to_string(), machinery);
        }
        let absent: Vec<String> =
            effects.iter().filter(|e| e.count == 0).map(|e| e.name.replace('_', " ")).collect();
        match self.is_flat() {
            true => line("effects", "none", "flat paint alone: no shader, layer, table or group is made"),
            false if absent.is_empty() => {}
            false => line("not called for", "", &absent.join(", ")),
        }
        self.layers(&mut text);
        self.costs(&mut text);
        text
    }

    fn layers(&self, text: &mut String) {
        /// More are not listed one by one.
        const LISTED: usize = 40;
        let layers = &self.plan.layers;
        for layer in layers.iter().take(LISTED) {
            let LayerPlan { what, id, depth, width, height, passes, bytes } = layer;
            let name = if id.is_empty() { what.clone() } else { format!("{what} '{id}'") };
            let within = "  ".repeat(*depth);
            let mut steps: Vec<String> = Vec::new();
            for pass in passes {
                let region = match (pass.width, pass.height) == (*width, *height) {
                    true => String::new(),
                    false => format!(" {} x {}", pass.width, pass.height),
                };
                steps.push(format!("{}{region}", pass.name));
            }
            let _ = writeln!(
                text,
                "{:>18} {:>9}  {within}{name}, {width} x {height}: {}",
                "layer",
                mebibytes(*bytes),
                steps.join(", ")
            );
        }
        if layers.len() > LISTED {
            let _ = writeln!(text, "{:>18} {:>9}  and {} more layers", "", "", layers.len() - LISTED);
        }
    }

    fn costs(&self, text: &mut String) {
        let plan = &self.plan;
        let mut line = |name: &str, count: &str, words: &str| {
            let _ = writeln!(text, "{name:>18} {count:>9}  {words}");
        };
        if !plan.layers.is_empty() {
            let words =
                format!("in {} layers, {} at most at once", plan.layers.len(), mebibytes(plan.layer_bytes));
            line("layer pixels", &plan.layer_pixels().to_string(), &words);
        }
        if plan.color_map_bytes > 0 {
            let words = "bytes, if every gradient turns within a pixel somewhere";
            line("colour maps", &plan.color_map_bytes.to_string(), words);
        }
        let IndexAa { on, tables, noise_points } = self.index_aa();
        if tables > 0 {
            let words = match on {
                true => {
                    format!("over noise, averaged over each pixel, for {noise_points} more points of noise")
                }
                false => format!(
                    "over noise, looked up at one point a pixel: --index-aa would average them, for \
                     {noise_points} more points of noise"
                ),
            };
            line("tables", &tables.to_string(), &words);
        }
        for Light { filter, exponent, pixels, aliasing, samples_a_side } in &self.lights {
            let words = match aliasing {
                0 => format!("of {pixels} pixels in '{filter}' (exponent {exponent}): nothing to cure"),
                _ => format!(
                    "of {pixels} pixels in '{filter}' (exponent {exponent}): {samples_a_side} x \
                     {samples_a_side} samples a pixel, or --highlights clamp, would cure it"
                ),
            };
            line("aliasing", &aliasing.to_string(), &words);
        }
        let Motion { moving, seconds, repeats, frames, not_evaluated } = &self.motion;
        if !moving.is_empty() {
            let of: Vec<String> = moving.iter().map(|(name, count)| format!("{name} {count}")).collect();
            let again = if *repeats { ", then over again" } else { "" };
            let length = format!("{frames} frames at {} a second{again}: {}", Motion::FPS, of.join(", "));
            line("moves", &format!("{seconds} s"), &length);
        }
        if let Some(what) = not_evaluated {
            line("not evaluated", "", what);
        }
        for what in &self.not_drawn {
            line("not drawn", "", what);
        }
        let at_once = u64::from(plan.rows_at_once) * u64::from(self.width) * 4;
        let words = match plan.streams {
            true => {
                format!(
                    "{} rows at a time, {}; layers are held whole up to 512 MB, by slabs of rows beyond",
                    plan.rows_at_once,
                    mebibytes(at_once)
                )
            }
            false => format!("the method holds the picture whole, {}", mebibytes(at_once)),
        };
        line("streams", if plan.streams { "yes" } else { "no" }, &words);
        if let Some(why) = &plan.refused {
            line("refused", "", why);
        }
    }
}

fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}
