//! Takes the text of one option, makes its value, or says what would have been right.

use toon_raster::encode::{Effort, Yuv};
use toon_raster::{usvg, Highlights, Method};

/// What comes out of the renderer's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A PNG file.
    Png,
    /// The pixels alone: 8-bit straight RGBA, rows from the top.
    Rgba,
    /// Frames in one PNG file.
    Apng,
    /// Frames in one GIF file.
    Gif,
    /// Frames in one stream, for video encoders.
    Y4m,
    /// Video, by ffmpeg: H.264.
    Mp4,
    /// Video, by ffmpeg: VP9.
    Webm,
    /// Frames in one WebP file, without loss, by ffmpeg.
    Webp,
}

impl Format {
    /// The usual extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::Rgba => "rgba",
            Format::Apng => "apng",
            Format::Gif => "gif",
            Format::Y4m => "y4m",
            Format::Mp4 => "mp4",
            Format::Webm => "webm",
            Format::Webp => "webp",
        }
    }

    /// Whether it is for many frames in one file.
    pub fn holds_many(self) -> bool {
        !matches!(self, Format::Png | Format::Rgba)
    }

    /// Whether all of its pixels are opaque.
    pub fn lacks_alpha(self) -> bool {
        matches!(self, Format::Y4m | Format::Mp4)
    }

    /// Whether the program ffmpeg makes it.
    pub fn is_by_ffmpeg(self) -> bool {
        matches!(self, Format::Mp4 | Format::Webm | Format::Webp)
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
    /// What Open Job Description's runners read: `openjd_progress: 50.0`.
    OpenJd,
    /// Not at all.
    None,
}

pub fn format(text: &str) -> Result<Format, String> {
    match text.to_ascii_lowercase().as_str() {
        "png" => Ok(Format::Png),
        "rgba" => Ok(Format::Rgba),
        "apng" => Ok(Format::Apng),
        "gif" => Ok(Format::Gif),
        "y4m" => Ok(Format::Y4m),
        "mp4" => Ok(Format::Mp4),
        "webm" => Ok(Format::Webm),
        "webp" => Ok(Format::Webp),
        _ => Err("unknown format; use png, rgba, apng, gif, y4m, mp4, webm or webp".to_string()),
    }
}

pub fn method(text: &str) -> Result<Method, String> {
    text.parse().map_err(|e: toon_raster::Error| e.to_string())
}

/// By the type's own parser.
pub fn parsed<T: std::str::FromStr<Err = String>>(text: &str) -> Result<T, String> {
    text.parse()
}

pub fn chunk(text: &str) -> Result<(u64, u64), String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    parts
        .filter(|(i, n)| (1..=*n).contains(i))
        .ok_or_else(|| "must be I/N, from 1/N to N/N, such as 2/8".to_string())
}

pub fn columns(text: &str) -> Result<u32, String> {
    let columns = text.strip_suffix('x').unwrap_or(text).parse().ok().filter(|&n| n > 0);
    columns.ok_or_else(|| "must be a number of columns, such as 8x".to_string())
}

/// `--yuv`: what of it was said.
#[derive(Clone, Copy, Debug, Default)]
pub struct YuvChoice {
    halved: Option<bool>,
    bt709: Option<bool>,
}

impl YuvChoice {
    /// With the rest as the format has it.
    pub fn or(self, usual: Yuv) -> Yuv {
        Yuv { halved: self.halved.unwrap_or(usual.halved), bt709: self.bt709.unwrap_or(usual.bt709) }
    }
}

pub fn yuv(text: &str) -> Result<YuvChoice, String> {
    let mut yuv = YuvChoice::default();
    for part in text.split(',').map(str::trim) {
        match part {
            "444" => yuv.halved = Some(false),
            "420" => yuv.halved = Some(true),
            "601" => yuv.bt709 = Some(false),
            "709" => yuv.bt709 = Some(true),
            _ => return Err("must be 444 or 420, 601 or 709, or one of each by a comma".to_string()),
        }
    }
    Ok(yuv)
}

pub fn shutter(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees <= 3600.0 => Ok(degrees),
        _ => Err("must be degrees above 0, 180 or 360 most often, up to 3600".to_string()),
    }
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
    color::parse_color(&text.to_ascii_lowercase())
        .map(|color| Color(color.to_alpha_color::<color::Srgb>().to_rgba8().to_u8_array()))
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

pub fn highlights(text: &str) -> Result<Highlights, String> {
    match text {
        "as-is" => Ok(Highlights::AsIs),
        "clamp" => Ok(Highlights::Clamp),
        "aggressive" => Ok(Highlights::Aggressive),
        "supersample" => Ok(Highlights::Supersample),
        _ => Err("must be as-is, clamp, aggressive or supersample".to_string()),
    }
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
        "openjd" => Ok(ProgressStyle::OpenJd),
        _ => Err("must be bar, json, openjd or none".to_string()),
    }
}

pub fn effort(fast: bool, small: bool) -> Effort {
    match (fast, small) {
        (true, _) => Effort::Fast,
        (_, true) => Effort::Small,
        _ => Effort::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_css() {
        for (text, expected) in [
            ("White", [255, 255, 255, 255]),
            (" #0f08 ", [0, 255, 0, 136]),
            ("rebeccapurple", [102, 51, 153, 255]),
            ("rgb(1 2 3 / 20%)", [1, 2, 3, 51]),
            ("rgba(1,2,3,.2)", [1, 2, 3, 51]),
            ("hsl(120, 100%, 50%)", [0, 255, 0, 255]),
            ("color(srgb 1 0 0)", [255, 0, 0, 255]),
            ("transparent", [0; 4]),
        ] {
            assert_eq!(color(text).map(|color| color.0), Ok(expected), "{text}");
        }
        assert!(color("nonsense").is_err() && color("").is_err() && color("#ff").is_err());
    }
}
