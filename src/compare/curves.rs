//! Takes a method with a number to turn, makes its curve: error and time at several values of it.
//!
//! The sampled methods have their number of samples; the exact one has the tolerance at which curves
//! are flattened, the cap on the recursion, and, for drawings with gradients, the width of the spot over
//! which these are averaged (Worley: the best is found by trying). A curve stops before a point that would take longer than
//! what is left of its budget.

use super::timing::{milliseconds, Spread};
use super::Options;
use crate::reference::Truth;
use crate::{Method, Renderer, Scene, Settings, Viewport};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Timed runs a point, at most.
const RUNS: usize = 3;
/// Numbers of samples; a method that does not take one of them goes without it.
const SAMPLES: [u16; 6] = [1, 4, 16, 64, 256, 1024];
/// Samples along one side of the pixel.
const SIDES: [u16; 6] = [1, 2, 4, 8, 16, 32];
/// Distances in pixels.
const TOLERANCES: [f64; 8] = [2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.01, 0.002];
/// Widths in pixels.
const SPOTS: [f64; 9] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0];
/// Pieces held against regions in one pixel.
const CAPS: [u32; 6] = [0, 10, 100, 1_000, 10_000, 100_000];

/// Error and time against one number.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// The method's name without its number.
    pub family: String,
    /// What the number is: `samples`, `samples a side`, `tolerance`, `cap` or `spot`.
    pub parameter: &'static str,
    /// From the cheap end to the dear one.
    pub points: Vec<Point>,
}

/// One point of a curve.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Point {
    /// The number.
    pub value: f64,
    /// Mean error in levels.
    pub mean: f64,
    /// Root mean square error in levels.
    pub rms: f64,
    /// Largest error in levels.
    pub max: f64,
    /// Median time.
    pub ms: f64,
}

/// The curves of this method, one for each number to turn.
pub fn curves(
    method: Method,
    scene: &Scene,
    viewport: &Viewport,
    truth: &Truth,
    options: &Options,
) -> Vec<Curve> {
    let census = scene.census().unwrap_or_default();
    let has_gradients = census.linear_gradients + census.radial_gradients > 0;
    let variants = variants(method, has_gradients, options).into_iter();
    variants.filter_map(|variants| curve(variants, scene, viewport, truth, options)).collect()
}

fn curve(
    (family, parameter, settings): Variants,
    scene: &Scene,
    viewport: &Viewport,
    truth: &Truth,
    options: &Options,
) -> Option<Curve> {
    let mut points = Vec::new();
    let start = Instant::now();
    let mut last = Duration::ZERO;
    for (value, settings) in settings {
        // Four times the samples take four times as long.
        if start.elapsed() + last * 4 > options.budget && !points.is_empty() {
            break;
        }
        let Ok(mut renderer) = Renderer::new(settings) else { continue };
        let begun = Instant::now();
        let Ok(mut picture) = renderer.render(scene, viewport) else { continue };
        last = begun.elapsed();
        let stride = picture.stride();
        let difference = truth.compare(&picture);
        let mut times = vec![last];
        while times.len() < RUNS && last * (times.len() as u32) < options.budget / 10 {
            let begun = Instant::now();
            if renderer.render_into(scene, viewport, picture.data_mut(), stride).is_err() {
                break;
            }
            times.push(begun.elapsed());
        }
        let ms = Spread::of(times).map_or(milliseconds(last), |s| s.median);
        points.push(Point { value, mean: difference.mean, rms: difference.rms, max: difference.max, ms });
    }
    (points.len() > 1).then_some(Curve { family, parameter, points })
}

/// A family's name, what its number is, and settings for several values of it.
type Variants = (String, &'static str, Vec<(f64, Settings)>);

/// The method's families: their members differ by a number.
fn variants(method: Method, has_gradients: bool, options: &Options) -> Vec<Variants> {
    let name = method.to_string();
    let (family, number) = name.split_once(':').unwrap_or((&name, ""));
    if method == Method::Exact {
        let with = |&tolerance: &f64| (tolerance, Settings { tolerance, ..options.settings(method) });
        let capped = |&cap: &u32| (f64::from(cap), Settings { most_work: cap, ..options.settings(method) });
        let spot = |&scale: &f64| (scale, Settings { spot_scale: scale, ..options.settings(method) });
        let mut variants = vec![
            (name.clone(), "tolerance", TOLERANCES.iter().map(with).collect()),
            (name.clone(), "cap", CAPS.iter().map(capped).collect()),
        ];
        if has_gradients {
            variants.push((name, "spot", SPOTS.iter().map(spot).collect()));
        }
        return variants;
    }
    if number.parse::<u16>().is_err() {
        return Vec::new();
    }
    let (parameter, numbers) = match method {
        Method::Grid(_) => ("samples a side", SIDES),
        _ => ("samples", SAMPLES),
    };
    let with = |n: u16| Some((f64::from(n), options.settings(format!("{family}:{n}").parse().ok()?)));
    vec![(family.to_string(), parameter, numbers.into_iter().filter_map(with).collect())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_with_a_number_has_a_curve_and_no_other_but_exact() {
        for &method in Method::ALL {
            let name = method.to_string();
            let number = name.split_once(':').is_some_and(|(_, n)| n.parse::<u16>().is_ok());
            let variants = variants(method, true, &Options::default());
            assert_eq!(!variants.is_empty(), number || method == Method::Exact, "{name}");
            assert!(variants.iter().all(|(_, _, all)| all.len() > 3), "{name}");
        }
    }
}
