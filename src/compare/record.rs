//! What is known of one method on one drawing, as the JSON says it: the names of the fields are the
//! interface.

use super::curves::Curve;
use super::seams::Seams;
use super::spots::Spot;
use super::standard::About;
use super::temporal::Pan;
use super::timing::Spread;
use crate::reference::Difference;
use serde::Serialize;

/// One method on one drawing. What could not be measured is `null`, and `failed` or `notes` say why.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// The drawing, as it was named.
    pub input: String,
    /// Columns of the picture.
    pub width: u32,
    /// Rows of the picture.
    pub height: u32,
    /// The method, or the file of another renderer's picture.
    pub method: String,
    /// It is another renderer's picture: there are no times.
    pub against: bool,
    /// Threads that the method could use.
    pub threads: usize,
    /// Time from bytes to scene, the same for all methods.
    pub parse_ms: f64,
    /// Time from scene to pixels.
    pub raster_ms: Option<Spread>,
    /// Time from pixels to PNG.
    pub encode_ms: Option<f64>,
    /// Time of each stage of rasterizing, summed over all threads; taken in runs of their own, for
    /// reading the clock in every band costs time.
    pub stages: Vec<Stage>,
    /// Time in that of others.
    pub times: Ratios,
    /// How far the picture is from the truth.
    pub error: Option<ErrorFigures>,
    /// Error where the truth is flat all around.
    pub seams: Option<Seams>,
    /// Where to look.
    pub worst: Vec<Spot>,
    /// Under motion, if that was asked for.
    pub pan: Option<Pan>,
    /// Error and time against the method's numbers.
    pub curves: Vec<Curve>,
    /// How the truth was made.
    pub reference: About,
    /// Why there is no picture.
    pub failed: Option<String>,
    /// What else is to be said.
    pub notes: Vec<String>,
}

/// One stage.
#[derive(Clone, Debug, Serialize)]
pub struct Stage {
    /// As the renderer calls it.
    pub name: &'static str,
    /// Its time.
    #[serde(flatten)]
    pub ms: Spread,
}

/// How many times as long as another method: the median over the rounds in which both ran.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Ratios {
    /// As `exact`.
    pub exact: Option<f64>,
    /// As `tiny-skia`.
    #[serde(rename = "tiny-skia")]
    pub tiny_skia: Option<f64>,
}

/// How far a picture is from the truth, in 8-bit levels.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ErrorFigures {
    /// Mean over the four channels of all pixels.
    pub mean: f64,
    /// Root of the mean square over the same.
    pub rms: f64,
    /// The largest.
    pub max: f64,
    /// Column and row of the largest.
    pub at: (u32, u32),
    /// Share of pixels whose worst channel is off by more than half a level.
    pub over_half: f64,
    /// By more than 1.
    pub over_1: f64,
    /// By more than 4.
    pub over_4: f64,
    /// By more than 16.
    pub over_16: f64,
    /// Peak signal to noise ratio in decibels, of `rms`; `null` where there is no noise.
    pub psnr: Option<f64>,
    /// Structural similarity of luma, on white; 1 is alike. `null` for very large pictures.
    pub ssim: Option<f64>,
    /// Mean of LDR-FLIP, on white; 0 is alike. `null` for very large pictures.
    pub flip: Option<f64>,
}

impl ErrorFigures {
    /// The difference, and what the other measures say.
    pub fn new(difference: &Difference, ssim: Option<f64>, flip: Option<f64>) -> ErrorFigures {
        let &Difference { mean, rms, max, worst, over_half, over_1, over_4, over_16 } = difference;
        ErrorFigures {
            mean,
            rms,
            max,
            at: worst,
            over_half,
            over_1,
            over_4,
            over_16,
            psnr: psnr(rms),
            ssim,
            flip,
        }
    }
}

/// Of a root mean square error in 8-bit levels.
fn psnr(rms: f64) -> Option<f64> {
    (rms > 0.0).then(|| 20.0 * (255.0 / rms).log10())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn psnr_of_known_errors() {
        assert_eq!(psnr(0.0), None);
        assert_eq!(psnr(255.0), Some(0.0));
        assert_eq!(psnr(25.5), Some(20.0));
    }
}
