//! Takes the text of one option, makes its value, or says what would have been right.

use toon_raster::encode::Effort;
use toon_raster::{usvg, Method};

/// What comes out of the renderer's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A PNG file.
    Png,
    /// The pixels alone: 8-bit straight RGBA, rows from the top.
    Rgba,
}

impl Format {
    /// The usual extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::Rgba => "rgba",
        }
    }
}

/// How `--perf` speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PerfStyle {
    /// A line for each stage.
    Text,
    /// One JSON object for each picture.
    Json,
}

/// How progress is told on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressStyle {
    /// A bar, on a terminal and if the work is long.
    Bar,
    /// One JSON object a line for each input done.
    Json,
    /// Not at all.
    None,
}

pub fn format(text: &str) -> Result<Format, String> {
    match text.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "rgba" => Ok(Format::Rgba),
        "apng" | "gif" | "y4m" => Err(later("png or rgba")),
        _ => Err("unknown format; use png or rgba".to_string()),
    }
}

pub fn method(text: &str) -> Result<Method, String> {
    text.parse().map_err(|e: toon_raster::Error| e.to_string())
}

fn later(now: &str) -> String {
    format!("comes in a later version; use {now}")
}

pub fn length(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(n) if n > 0 => Ok(n),
        _ => Err("must be a whole number of pixels, at least 1".to_string()),
    }
}

pub fn zoom(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(z) if z > 0.0 && z.is_finite() => Ok(z),
        _ => Err("must be a number above zero".to_string()),
    }
}

pub fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(t) if (1e-4..=100.0).contains(&t) => Ok(t),
        _ => Err("must be a number of pixels from 0.0001 to 100".to_string()),
    }
}

/// Straight 8-bit RGBA.
#[derive(Clone, Copy, Debug)]
pub struct Color(pub [u8; 4]);

pub fn color(text: &str) -> Result<Color, String> {
    text.trim()
        .parse::<svgtypes::Color>()
        .map(|c| Color([c.red, c.green, c.blue, c.alpha]))
        .map_err(|_| "must be a CSS colour, such as white, #fff or rgb(255 255 255)".to_string())
}

pub fn languages(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => Err("must be languages, such as en or en-US,fr".to_string()),
        language => Ok(language.to_string()),
    }
}

pub fn shape_rendering(text: &str) -> Result<usvg::ShapeRendering, String> {
    text.parse().map_err(|_| "must be optimizeSpeed, crispEdges or geometricPrecision".to_string())
}

pub fn text_rendering(text: &str) -> Result<usvg::TextRendering, String> {
    text.parse().map_err(|_| "must be optimizeSpeed, optimizeLegibility or geometricPrecision".to_string())
}

pub fn image_rendering(text: &str) -> Result<usvg::ImageRendering, String> {
    text.parse().map_err(|_| {
        "must be optimizeQuality, optimizeSpeed, smooth, high-quality, crisp-edges or pixelated".to_string()
    })
}

pub fn perf(text: &str) -> Result<PerfStyle, String> {
    match text {
        "text" => Ok(PerfStyle::Text),
        "json" => Ok(PerfStyle::Json),
        _ => Err("must be json or text".to_string()),
    }
}

pub fn progress(text: &str) -> Result<ProgressStyle, String> {
    match text {
        "bar" => Ok(ProgressStyle::Bar),
        "json" => Ok(ProgressStyle::Json),
        "none" => Ok(ProgressStyle::None),
        "openjd" => Err(later("bar, json or none")),
        _ => Err("must be bar, json or none".to_string()),
    }
}

pub fn effort(fast: bool, small: bool) -> Effort {
    match (fast, small) {
        (true, _) => Effort::Fast,
        (_, true) => Effort::Small,
        _ => Effort::default(),
    }
}
