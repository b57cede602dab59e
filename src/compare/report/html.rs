//! Takes comparisons, makes the page's text: `report.html` with the style, the script, the plots and all
//! figures put in their places.

use super::image::{self, Part};
use super::machine::Circumstances;
use super::plot::{escape, short, Mark, Plot, Series};
use crate::compare::{Comparison, Curve, Record};
use serde::Serialize;

const TEMPLATE: &str = include_str!("report.html");
const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

/// Longest side of a picture in the page; of a larger one the page shows the part with most error.
const LONGEST_SIDE: u32 = 1024;

/// Errors below this are drawn here: a logarithm needs a number above 0.
const LEAST_ERROR: f64 = 1e-3;

/// The page, as far as it has come.
pub struct Page {
    circumstances: Circumstances,
    inputs: Vec<Input>,
}

/// One drawing, as the script reads it.
#[derive(Serialize)]
struct Input {
    name: String,
    width: u32,
    height: u32,
    part: Part,
    truth: String,
    pictures: Vec<Option<String>>,
    errors: Vec<Option<String>>,
    records: Vec<Record>,
    plots: Vec<(&'static str, &'static str, String)>,
    curves: Vec<(&'static str, String)>,
}

impl Page {
    /// With nothing on it yet.
    pub fn new(circumstances: Circumstances) -> Page {
        Page { circumstances, inputs: Vec::new() }
    }

    /// Adds a drawing.
    pub fn add(&mut self, comparison: &Comparison) {
        let truth = comparison.truth.to_pixmap();
        let errors: Vec<Option<Vec<f32>>> =
            comparison.pictures.iter().map(|p| p.as_ref().map(|p| comparison.truth.errors(p))).collect();
        let part = part_to_show(truth.width(), truth.height(), &errors);
        let width = truth.width();
        self.inputs.push(Input {
            name: comparison.input.clone(),
            width,
            height: truth.height(),
            part,
            truth: image::picture(&truth, part),
            pictures: comparison
                .pictures
                .iter()
                .map(|p| p.as_ref().map(|p| image::picture(p, part)))
                .collect(),
            errors: errors.iter().map(|e| e.as_ref().map(|e| image::errors(e, width, part))).collect(),
            records: comparison.records.clone(),
            plots: plots(&comparison.records),
            curves: curves(&comparison.records),
        });
    }

    /// The page's text.
    pub fn finish(self) -> String {
        let data = serde_json::json!({ "circumstances": self.circumstances, "inputs": self.inputs });
        // Nothing in the figures may end the script that holds them.
        let data = data.to_string().replace('<', "\\u003c");
        let title = match &self.inputs[..] {
            [one] => one.name.clone(),
            several => format!("{} drawings", several.len()),
        };
        // The data come last: names in them are not looked at again.
        TEMPLATE
            .replace("{{title}}", &escape(&title).replace('{', "&#123;"))
            .replace("{{style}}", STYLE)
            .replace("{{script}}", SCRIPT)
            .replacen("{{data}}", &data, 1)
    }
}

/// All of the picture, or the part of it whose errors are largest in all methods together.
fn part_to_show(width: u32, height: u32, errors: &[Option<Vec<f32>>]) -> Part {
    let (part_width, part_height) = (width.min(LONGEST_SIDE), height.min(LONGEST_SIDE));
    let mut across = vec![0.0f64; width as usize];
    let mut down = vec![0.0f64; height as usize];
    for errors in errors.iter().flatten() {
        for (y, row) in errors.chunks_exact(width as usize).enumerate() {
            for (x, &error) in row.iter().enumerate() {
                across[x] += f64::from(error);
                down[y] += f64::from(error);
            }
        }
    }
    Part {
        x: heaviest(&across, part_width as usize),
        y: heaviest(&down, part_height as usize),
        width: part_width,
        height: part_height,
    }
}

/// Where the window of this length with the largest sum begins.
fn heaviest(sums: &[f64], length: usize) -> u32 {
    let mut sum: f64 = sums[..length].iter().sum();
    let (mut best, mut at) = (sum, 0);
    for start in 1..=sums.len() - length {
        sum += sums[start + length - 1] - sums[start - 1];
        if sum > best {
            (best, at) = (sum, start);
        }
    }
    at as u32
}

/// Time against each measure of error: its short name, what it says, the plot.
fn plots(records: &[Record]) -> Vec<(&'static str, &'static str, String)> {
    type Measure = fn(&Record) -> Option<f64>;
    let measures: [(&'static str, &'static str, Measure); 5] = [
        ("RMS", "root mean square error, levels", |r| r.error.map(|e| e.rms)),
        ("Mean", "mean error, levels", |r| r.error.map(|e| e.mean)),
        ("Worst", "largest error, levels", |r| r.error.map(|e| e.max)),
        ("FLIP", "FLIP (0 is alike)", |r| r.error?.flip),
        ("Seams", "mean error where the truth is flat, levels", |r| r.seams.map(|s| s.mean)),
    ];
    let plot = |(short_name, label, measure): (&'static str, &'static str, Measure)| {
        let marks: Vec<Mark> = records
            .iter()
            .filter_map(|record| {
                let (time, error) = (record.raster_ms?.median, measure(record)?);
                Some(Mark {
                    x: time,
                    y: error.max(LEAST_ERROR),
                    label: record.method.clone(),
                    title: format!("{}: {} ms, {} {label}", record.method, short(time), short(error)),
                })
            })
            .collect();
        (!marks.is_empty()).then(|| {
            let plot = Plot {
                x_label: "time from scene to pixels, milliseconds (median)".into(),
                y_label: label.into(),
                series: vec![Series { name: String::new(), marks }],
                front: true,
                title: format!("Time against {label}"),
                size: (900.0, 480.0),
            };
            (short_name, label, plot.inline())
        })
    };
    measures.into_iter().filter_map(plot).collect()
}

/// One plot for each kind of number to turn.
fn curves(records: &[Record]) -> Vec<(&'static str, String)> {
    let of = |parameters: &[&str]| -> Vec<Series> {
        let curves = records.iter().flat_map(|record| &record.curves);
        let wanted = curves.filter(|curve| parameters.contains(&curve.parameter));
        // A drawing without curves has nothing to show of the tolerance, nor one without hard pixels of
        // the cap.
        let tells = |curve: &&Curve| {
            let rms = || curve.points.iter().map(|point| point.rms);
            rms().fold(0.0, f64::max) > 1.05 * rms().fold(f64::MAX, f64::min)
        };
        let series = wanted.filter(tells).map(|curve| Series {
            name: curve.family.clone(),
            marks: curve
                .points
                .iter()
                .map(|point| Mark {
                    x: point.ms,
                    y: point.rms.max(LEAST_ERROR),
                    label: short(point.value),
                    title: format!(
                        "{} {} {}: {} ms, rms {}, worst {}",
                        curve.family,
                        curve.parameter,
                        short(point.value),
                        short(point.ms),
                        short(point.rms),
                        short(point.max)
                    ),
                })
                .collect(),
        });
        series.collect()
    };
    let captions = [
        (&["tolerance"][..], "The tolerance at which curves are flattened, in pixels"),
        (&["cap"], "The cap on the recursion: pieces held against regions in one pixel"),
        (&["spot"], "The width of the spot that gradients are averaged over, in pixels"),
        (&["samples", "samples a side"], "The number of samples (of grid: along one side of the pixel)"),
    ];
    let plot = |(parameters, caption): (&[&str], &'static str)| {
        let series = of(parameters);
        (!series.is_empty()).then(|| {
            let plot = Plot {
                x_label: "time from scene to pixels, milliseconds".into(),
                y_label: "root mean square error, levels".into(),
                series,
                front: false,
                title: caption.into(),
                size: (600.0, 420.0),
            };
            (caption, plot.inline())
        })
    };
    captions.into_iter().filter_map(plot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_picture_is_shown_where_it_is_worst() {
        let mut errors = vec![0.0; 3000 * 20];
        errors[7 * 3000 + 2500] = 9.0;
        let part = part_to_show(3000, 20, &[None, Some(errors)]);
        assert!((part.x..part.x + part.width).contains(&2500), "{part:?}");
        assert_eq!((part.width, part.y, part.height), (1024, 0, 20));
    }
}
