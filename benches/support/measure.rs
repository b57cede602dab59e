//! Takes prepared drawings, makes times: the renderers take turns, so that a busy moment of the machine
//! falls on all of them.

use super::drawings::Prepared;
use super::renderers::{Size, TinySkia, Toon, VelloCpu};
use std::time::Duration;
use toon_raster::Method;

/// Milliseconds of one renderer on one scene.
#[derive(Clone, Copy)]
pub struct Times {
    pub median: f64,
    pub min: f64,
    pub max: f64,
}

impl Times {
    fn of(mut times: Vec<f64>) -> Times {
        times.sort_by(f64::total_cmp);
        Times { median: times[times.len() / 2], min: times[0], max: times[times.len() - 1] }
    }
}

/// Mean difference from resvg's picture, in 8-bit levels over all premultiplied channels.
#[derive(Clone, Copy)]
pub struct Differences {
    pub vello: f64,
    pub exact: f64,
}

/// All that was measured on one scene at one size with one number of threads.
pub struct Row {
    pub scene: String,
    pub width: u16,
    pub height: u16,
    pub threads: usize,
    pub runs: usize,
    pub tiny_skia: Times,
    pub vello: Times,
    pub exact: Times,
    pub mask: Times,
    pub mask64: Times,
    /// Mean milliseconds of each stage of the exact method, summed over its threads.
    pub stages: Vec<(&'static str, f64)>,
    pub counts: Vec<(&'static str, u64)>,
    pub differences: Option<Differences>,
}

impl Row {
    pub fn exact_to_tiny_skia(&self) -> f64 {
        self.exact.median / self.tiny_skia.median
    }

    pub fn exact_to_vello(&self) -> f64 {
        self.exact.median / self.vello.median
    }

    pub fn mask_to_exact(&self) -> f64 {
        self.mask.median / self.exact.median
    }

    pub fn mask_to_vello(&self) -> f64 {
        self.mask.median / self.vello.median
    }

    pub fn mask64_to_exact(&self) -> f64 {
        self.mask64.median / self.exact.median
    }

    pub fn mask64_to_vello(&self) -> f64 {
        self.mask64.median / self.vello.median
    }
}

/// What to measure with.
#[derive(Clone, Copy)]
pub struct Plan {
    /// Pixels on the longer side.
    pub size: u16,
    pub threads: usize,
    pub runs: usize,
    /// Compare the pictures too.
    pub check: bool,
}

/// Times the renderers in turns, after one round to warm up.
pub fn measure(drawing: &Prepared, plan: Plan) -> Row {
    let size = Size::of(drawing, plan.size);
    let mut tiny_skia = TinySkia::new(drawing, size);
    let mut vello = VelloCpu::new(drawing, size, plan.threads);
    let toon = |method, stage_times| Toon::new(drawing, size, plan.threads, method, stage_times);
    let mut exact = toon(Method::Exact, false);
    let mut mask = toon(Method::Mask, false);
    let mut mask64 = toon(Method::Mask64, false);
    let mut staged = toon(Method::Exact, true);
    let mut times: [Vec<f64>; 5] = Default::default();
    let mut stages: Vec<(&'static str, f64)> = Vec::new();
    for run in 0..=plan.runs {
        let round = [
            tiny_skia.time(drawing),
            vello.time(drawing),
            exact.time(drawing),
            mask.time(drawing),
            mask64.time(drawing),
        ];
        staged.time(drawing);
        if run == 0 {
            continue;
        }
        for (times, time) in times.iter_mut().zip(round) {
            times.push(milliseconds(time));
        }
        for (stage, time) in &staged.stages().times {
            let share = milliseconds(*time) / plan.runs as f64;
            match stages.iter_mut().find(|(name, _)| name == stage) {
                Some((_, sum)) => *sum += share,
                None => stages.push((stage, share)),
            }
        }
    }
    let [tiny_skia_times, vello_times, exact_times, mask_times, mask64_times] = times.map(Times::of);
    let differences = plan.check.then(|| Differences {
        vello: mean_difference(vello.pixels(), tiny_skia.pixels()),
        exact: mean_difference(&exact.pixels(), tiny_skia.pixels()),
    });
    Row {
        scene: drawing.name.clone(),
        width: size.width,
        height: size.height,
        threads: plan.threads,
        runs: plan.runs,
        tiny_skia: tiny_skia_times,
        vello: vello_times,
        exact: exact_times,
        mask: mask_times,
        mask64: mask64_times,
        stages,
        counts: staged.stages().counts.clone(),
        differences,
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn mean_difference(a: &[u8], b: &[u8]) -> f64 {
    let sum: u64 = a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}
