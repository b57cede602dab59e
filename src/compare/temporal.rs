//! Takes a drawing and a method, makes the measures of motion: the drawing moves by one pixel, across
//! and down, in N equal steps, and each picture is held against the truth of the same moment.
//!
//! The frame is [`MARGIN`] pixels larger on each side, so that nothing on the page leaves it. A picture
//! that is off by the same amount at every step does not flicker: what counts is how the error changes.
//!
//! * **Light.** The total light of a picture is the sum over its pixels of the mean of its four
//!   premultiplied channels; its unit here is one pixel, fully lit. Moving changes the total of
//!   content inside the frame by nothing, so what a method changes it by from one step to the next,
//!   beyond what the truth does (content at the frame's edge), is an error: thin things that wax and
//!   wane.
//! * **Flicker.** Of each pixel: the standard deviation over time of its signed error, root mean square
//!   over the channels, in levels. The mean is over the pixels in which the truth moves by more than a
//!   level, for the rest of the picture stands still in any case.

use super::standard::Source;
use super::Options;
use crate::reference::{self, Truth};
use crate::{Error, Method, Pixmap, Renderer, Scene, Viewport};
use kurbo::Affine;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Pixels around the page.
const MARGIN: u32 = 2;

/// Pixels of all truths together; they are kept in memory as single floats, 16 bytes each.
const MOST_PIXELS: u64 = 24_000_000;

/// The truths of a pan take no longer than this, about.
const PATIENCE: Duration = Duration::from_secs(60);

/// Curves are cut this finely, in pixels: below a third of a level.
const TOLERANCE: f64 = 1e-3;

/// A pan, seen by one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pan {
    /// Steps to move by one pixel across and one down.
    pub steps: u32,
    /// Change of the total light from one step to the next beyond the truth's: mean over the steps,
    /// in fully lit pixels.
    pub light_step: f64,
    /// The largest.
    pub light_step_max: f64,
    /// Total light beyond the truth's at each moment.
    pub light: Vec<f64>,
    /// Mean flicker, in levels, of pixels in which the truth moves.
    pub flicker: f64,
    /// The most that any pixel flickers.
    pub flicker_max: f64,
    /// Share of pixels that flicker by more than 4 levels, of those in which the truth moves.
    pub flicker_over_4: f64,
}

/// The truths of a pan.
pub struct Panned {
    viewports: Vec<Viewport>,
    /// Premultiplied levels, moment by moment.
    truths: Vec<Vec<[f32; 4]>>,
    /// Total light of each.
    light: Vec<f64>,
    /// The truth moves here by more than a level.
    moves: Vec<bool>,
    /// What was left out, and why.
    pub note: Option<String>,
}

impl Panned {
    /// The truths of `steps` steps; fewer where they would take too long.
    ///
    /// # Errors
    /// [`Error::Limit`] when the pictures are too large for any; otherwise as [`reference::render`].
    pub fn new(source: &Source, viewport: &Viewport, options: &Options, steps: u32) -> Result<Panned, Error> {
        let pixels = u64::from(viewport.width + 2 * MARGIN) * u64::from(viewport.height + 2 * MARGIN);
        let fit = (MOST_PIXELS / pixels).saturating_sub(1).min(u64::from(steps)) as u32;
        if fit < 2 {
            return Err(Error::Limit("the pictures are too large for a pan (ask for less with -w)".into()));
        }
        let settings = reference::Options { tolerance: TOLERANCE, ..options.reference() };
        let start = Instant::now();
        // The first truth tells how many there is time for.
        let first = source.truth(&moment(viewport, 0, fit), &settings)?.0;
        let affordable = (PATIENCE.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-6)) as u32;
        let fit = affordable.clamp(2, fit);
        let viewports: Vec<Viewport> = (0..=fit).map(|i| moment(viewport, i, fit)).collect();
        let mut panned = Panned {
            truths: vec![narrow(&first)],
            light: vec![light(first.premultiplied().iter().copied())],
            moves: Vec::new(),
            note: (fit < steps)
                .then(|| format!("the pan has {fit} steps in place of {steps}: more would take too long")),
            viewports,
        };
        for viewport in &panned.viewports[1..] {
            let truth = source.truth(viewport, &settings)?.0;
            panned.light.push(light(truth.premultiplied().iter().copied()));
            panned.truths.push(narrow(&truth));
        }
        let moves = |i: usize| {
            let first = panned.truths[0][i];
            let far = |truth: &Vec<[f32; 4]>| truth[i].iter().zip(first).any(|(a, b)| (a - b).abs() > 1.0);
            panned.truths.iter().any(far)
        };
        panned.moves = (0..panned.truths[0].len()).map(moves).collect();
        Ok(panned)
    }

    /// What the method makes of it.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn seen_by(&self, method: Method, scene: &Scene, options: &Options) -> Result<Pan, Error> {
        let mut renderer = Renderer::new(options.settings(method))?;
        let mut sums = vec![[0.0f32; 4]; self.moves.len()];
        let mut squares = sums.clone();
        let mut light_beyond = Vec::new();
        for ((viewport, truth), true_light) in self.viewports.iter().zip(&self.truths).zip(&self.light) {
            let picture = renderer.render(scene, viewport)?;
            light_beyond.push(light(premultiplied(&picture)) - true_light);
            for (i, (seen, truth)) in premultiplied(&picture).zip(truth).enumerate() {
                for c in 0..4 {
                    let error = seen[c] as f32 - truth[c];
                    sums[i][c] += error;
                    squares[i][c] += error * error;
                }
            }
        }
        let moments = self.truths.len() as f64;
        let variance = |i: usize, c: usize| {
            (f64::from(squares[i][c]) - f64::from(sums[i][c]).powi(2) / moments).max(0.0) / moments
        };
        let flicker = |i: usize| ((0..4).map(|c| variance(i, c)).sum::<f64>() / 4.0).sqrt();
        let all: Vec<f64> = (0..self.moves.len()).map(flicker).collect();
        let moving = || all.iter().zip(&self.moves).filter(|(_, moves)| **moves).map(|(flicker, _)| *flicker);
        let count = moving().count().max(1) as f64;
        let steps: Vec<f64> = light_beyond.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        Ok(Pan {
            steps: steps.len() as u32,
            light_step: steps.iter().sum::<f64>() / steps.len() as f64,
            light_step_max: steps.iter().copied().fold(0.0, f64::max),
            light: light_beyond,
            flicker: moving().sum::<f64>() / count,
            flicker_max: all.iter().copied().fold(0.0, f64::max),
            flicker_over_4: moving().filter(|f| *f > 4.0).count() as f64 / count,
        })
    }
}

/// The viewport after step `i` of `steps`.
fn moment(viewport: &Viewport, i: u32, steps: u32) -> Viewport {
    let by = f64::from(MARGIN) + f64::from(i) / f64::from(steps);
    Viewport {
        width: viewport.width + 2 * MARGIN,
        height: viewport.height + 2 * MARGIN,
        transform: Affine::translate((by, by)) * viewport.transform,
    }
}

fn narrow(truth: &Truth) -> Vec<[f32; 4]> {
    truth.premultiplied().iter().map(|pixel| pixel.map(|c| c as f32)).collect()
}

fn premultiplied(picture: &Pixmap) -> impl Iterator<Item = [f64; 4]> + '_ {
    picture.data().chunks_exact(4).map(|p| {
        let alpha = f64::from(p[3]) / 255.0;
        [f64::from(p[0]) * alpha, f64::from(p[1]) * alpha, f64::from(p[2]) * alpha, f64::from(p[3])]
    })
}

/// In fully lit pixels.
fn light(pixels: impl Iterator<Item = [f64; 4]>) -> f64 {
    pixels.map(|pixel| pixel.iter().sum::<f64>()).sum::<f64>() / (4.0 * 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pan(method: Method, steps: u32) -> Pan {
        // A white line a quarter of a pixel wide, eight pixels long.
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="12" height="12">
            <path d="M5.6 2H5.85V10H5.6z" fill="#fff"/></svg>"##;
        let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).unwrap();
        let scene = Scene::from_tree(&tree).unwrap();
        let viewport = Viewport::fit(&scene, 12, 12);
        let source = Source::new(svg.as_bytes(), &tree, None);
        let options = Options { threads: 1, ..Options::default() };
        let panned = Panned::new(&source, &viewport, &options, steps).unwrap();
        panned.seen_by(method, &scene, &options).unwrap()
    }

    #[test]
    fn by_half_a_pixel_a_thin_line_keeps_its_light_only_where_areas_are_exact() {
        let (exact, jagged) = (pan(Method::Exact, 2), pan(Method::None, 2));
        // Half a level of rounding in two columns of nine pixels, at most.
        assert!(exact.light_step_max < 18.0 * 0.5 / 255.0, "{exact:?}");
        assert!(exact.flicker_max < 1.0, "{exact:?}");
        // At x = 5.6 and 6.6 no centre lies on the line, in between none either: 6.1 ..= 6.35 misses
        // 6.5. So the line is never seen, and nothing changes.
        assert!(jagged.light_step_max < 0.1, "{jagged:?}");
        // In quarters it is: 6.35 ..= 6.6 holds 6.5. Eight pixels light up, and go out.
        let jagged = pan(Method::None, 4);
        assert!((jagged.light_step_max - 8.0).abs() < 0.1, "{jagged:?}");
        assert!(jagged.flicker_max > 90.0, "{jagged:?}");
    }

    #[test]
    fn a_whole_pixel_further_the_light_is_what_it_was() {
        for method in [Method::Exact, Method::None] {
            let pan = pan(method, 4);
            assert_eq!(pan.light.len(), 5);
            assert!((pan.light[0] - pan.light[4]).abs() < 1e-3, "{pan:?}");
        }
    }

    #[test]
    fn a_picture_too_large_for_a_pan_is_refused() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>"#;
        let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).unwrap();
        let viewport = Viewport { width: 9000, height: 9000, transform: Affine::IDENTITY };
        let source = Source::new(svg.as_bytes(), &tree, None);
        assert!(Panned::new(&source, &viewport, &Options::default(), 4).is_err());
    }
}
