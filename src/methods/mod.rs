//! The ways of anti-aliasing: [`Method`] names them, and here each is given the code that does it.
//!
//! | module | methods |
//! |---|---|
//! | [`exact`] | `exact`: fragments as geometry |
//! | [`mask`] | `mask`, `mask64`, and with a single sample `none`: the A-buffer |
//! | [`mod@sampled`] | `grid`, `random`, `jitter`, `poisson`: supersampling |
//! | [`accumulate`] | `accumulate`: the mean of jagged pictures |
//! | [`adaptive`] | `adaptive:N`: more samples where the first ones differ |
//! | [`corner`] | `corner`, `corner:tiny`: borders found between the corners of pixels |
//! | [`area`], [`cone`] | each shape's share of a square or a disk, painted over what is below |
//! | [`beam`] | the visible polygons of the whole picture |
//! | [`tiny_skia`] | resvg's renderer |
//!
//! They share:
//!
//! | module | takes → makes |
//! |---|---|
//! | [`lattice`] | an edge's part of a pixel → the samples right of it |
//! | [`patterns`] | a pixel → points in it |
//! | [`tally`] | sets of samples, with signs → winding numbers |
//! | [`sets`] | a z-list of sets → the pixel's colour |
//! | [`borders`] | an outline → one row of it, and what cuts its pixels |
//! | [`points`] | a band's shapes → the colour at a point |
//! | [`footprint`] | a row of an outline → its area within a pixel's square or disk |
//! | [`shares`] | such areas → pixels, shape painted over shape |
//!
//! A method that works band by band is a [`BandPainter`]; one that must see the whole picture at once is
//! a [`PicturePainter`]. A new method is an arm of [`Method`], a line in [`Method::ALL`], a file here
//! and an arm of [`painter`].

use self::accumulate::Accumulate;
use self::exact::Exact;
use self::mask::{Masks, CENTRE};
use self::patterns::{Pattern, PoissonTile};
use self::sampled::Sampled;
use self::sets::Words;
use crate::band::{BandRenderer, Laps, Picture};
use crate::cel::Rows;
use crate::coverage::Coverage;
use crate::{Error, Scene, Settings, Viewport};
use std::fmt;
use std::str::FromStr;

pub(crate) mod accumulate;
pub(crate) mod adaptive;
pub(crate) mod area;
pub(crate) mod beam;
pub(crate) mod borders;
pub(crate) mod cone;
pub(crate) mod corner;
pub(crate) mod exact;
pub(crate) mod footprint;
pub(crate) mod lattice;
pub(crate) mod mask;
pub(crate) mod patterns;
pub(crate) mod points;
pub(crate) mod sampled;
pub(crate) mod sets;
pub(crate) mod shares;
pub(crate) mod tally;
pub(crate) mod tiny_skia;

/// A way of anti-aliasing. [`FromStr`] and [`fmt::Display`] give its name, as `--aa` takes it.
///
/// The numbers are samples a pixel (of `Grid`: along one side of it), 1 up to [`Method::MOST_SAMPLES`]
/// in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// The exact visible area of every colour in every pixel (Catmull 1978).
    #[default]
    Exact,
    /// The A-buffer: visible areas by a 4x4 bitmask (Carpenter 1984).
    Mask,
    /// The A-buffer with 64 samples on a lattice.
    Mask64,
    /// Jagged: a pixel has the colour seen at its centre.
    None,
    /// Supersampling on a regular grid of N x N.
    Grid(u16),
    /// N samples anywhere in the pixel.
    Random(u16),
    /// N samples, one in each cell of the pixel.
    Jitter(u16),
    /// N samples that keep their distance from each other.
    Poisson(u16),
    /// Up to N samples, more only where the first ones differ.
    Adaptive(u16),
    /// The mean of N jagged pictures, each moved by a part of a pixel (Haeberli & Akeley 1990).
    Accumulate(u16),
    /// Colours at the corners of pixels, borders found by binary search (Ramos & Borges).
    Corner,
    /// The same, with pixels that hold a tiny polygon split further.
    CornerTiny,
    /// A disk for each pixel's footprint (Amanatides 1984).
    Cone,
    /// Visible polygons of the whole picture, found once (Heckbert & Hanrahan 1984). Rendering fails
    /// with [`Error::Limit`] where a drawing or a picture is too large for it.
    Beam,
    /// Exact area of each shape alone, painted over what is below: seams and all.
    Area,
    /// tiny-skia, resvg's renderer. Rendering fails with [`Error::Setting`] where light is to be mixed
    /// linearly, which it cannot do.
    TinySkia,
}

impl Method {
    /// Every method, those with a number at the number that is compared by default.
    pub const ALL: &[Method] = &[
        Method::Exact,
        Method::Mask,
        Method::Mask64,
        Method::None,
        Method::Grid(4),
        Method::Random(16),
        Method::Jitter(16),
        Method::Poisson(16),
        Method::Adaptive(64),
        Method::Accumulate(16),
        Method::Corner,
        Method::CornerTiny,
        Method::Cone,
        Method::Beam,
        Method::Area,
        Method::TinySkia,
    ];

    /// The most samples a pixel may have.
    pub const MOST_SAMPLES: u16 = 1024;

    /// Names and forms, for messages and help.
    pub const NAMES: &str = "exact, mask, mask64, none, grid:N, random:N, jitter:N, poisson:N, adaptive:N, \
                             accumulate:N, corner, corner:tiny, cone, beam, area or tiny-skia";

    /// The flattening tolerance ([`Settings::tolerance`]) that suits it: the area of a pixel then errs by
    /// less than a tenth of what the method itself errs by in the mean.
    pub fn tolerance(self) -> f64 {
        match self {
            // A twentieth of the tolerance is what a pixel's area may be off by; these err by 1/32 and
            // 1/64.
            Method::Mask => 0.0625,
            Method::Mask64 => 0.03125,
            _ => Settings::DEFAULT_TOLERANCE,
        }
    }

    /// Does it evaluate the whole paint tree, masks and blend modes too, where the same shapes are seen?
    /// Other methods are given those as layers of pixels.
    pub(crate) fn composites_regions(self) -> bool {
        match self {
            Method::Exact | Method::Mask | Method::Mask64 | Method::None | Method::Accumulate(_) => true,
            Method::Grid(_) | Method::Random(_) | Method::Jitter(_) | Method::Poisson(_) => true,
            Method::Adaptive(_) | Method::Corner | Method::CornerTiny | Method::Cone => false,
            Method::Beam | Method::Area | Method::TinySkia => false,
        }
    }

    /// Does it take one sample a pixel, at its centre?
    pub(crate) fn is_jagged(self) -> bool {
        self == Method::None
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Method::Exact => f.write_str("exact"),
            Method::Mask => f.write_str("mask"),
            Method::Mask64 => f.write_str("mask64"),
            Method::None => f.write_str("none"),
            Method::Grid(n) => write!(f, "grid:{n}"),
            Method::Random(n) => write!(f, "random:{n}"),
            Method::Jitter(n) => write!(f, "jitter:{n}"),
            Method::Poisson(n) => write!(f, "poisson:{n}"),
            Method::Adaptive(n) => write!(f, "adaptive:{n}"),
            Method::Accumulate(n) => write!(f, "accumulate:{n}"),
            Method::Corner => f.write_str("corner"),
            Method::CornerTiny => f.write_str("corner:tiny"),
            Method::Cone => f.write_str("cone"),
            Method::Beam => f.write_str("beam"),
            Method::Area => f.write_str("area"),
            Method::TinySkia => f.write_str("tiny-skia"),
        }
    }
}

impl FromStr for Method {
    type Err = Error;

    /// # Errors
    /// [`Error::Setting`] for a name that is not known, or a number that is missing or out of range.
    fn from_str(text: &str) -> Result<Method, Error> {
        if let Some(&method) = Method::ALL.iter().find(|method| method.to_string() == text) {
            return Ok(method);
        }
        let (name, number) = text.split_once(':').unwrap_or((text, ""));
        let (make, most): (fn(u16) -> Method, u16) = match name {
            "grid" => (Method::Grid, Method::MOST_SAMPLES.isqrt()),
            "random" => (Method::Random, Method::MOST_SAMPLES),
            "jitter" => (Method::Jitter, Method::MOST_SAMPLES),
            "poisson" => (Method::Poisson, Method::MOST_SAMPLES),
            "adaptive" => (Method::Adaptive, Method::MOST_SAMPLES),
            "accumulate" => (Method::Accumulate, Method::MOST_SAMPLES),
            _ => return Err(Error::Setting(format!("unknown method '{text}'; use {}", Method::NAMES))),
        };
        match number.parse() {
            Ok(n) if (1..=most).contains(&n) => Ok(make(n)),
            _ => Err(Error::Setting(format!("'{text}' needs a number from 1 to {most}: {name}:N"))),
        }
    }
}

/// Paints bands one after the other; each thread has its own.
pub(crate) trait BandPainter: Send {
    /// Paints band number `band` into `rows`.
    fn render(&mut self, picture: &Picture, band: usize, rows: Rows);

    /// Does it leave alone the tiles that the picture's plan does not ask for? Otherwise it paints whole bands.
    fn keeps_tiles(&self) -> bool {
        false
    }

    /// Takes the time of each stage from now on.
    fn time_stages(&mut self) {}

    /// The time of each stage since this was last asked, if it was taken.
    fn take_laps(&mut self) -> Laps {
        Laps::default()
    }

    /// Counter name and value since this was last asked, always the same names in the same order.
    fn take_counts(&mut self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}

/// Paints a whole picture: straight 8-bit RGBA, row `y` at `y * stride` bytes of the buffer, which is
/// large enough.
pub(crate) type PicturePainter = fn(&Scene, &Viewport, &Settings, &mut [u8], usize) -> Result<(), Error>;

/// Who does it.
pub(crate) enum Painter {
    Bands(Box<dyn BandPainter>),
    Picture(PicturePainter),
}

/// Who paints by this method, for pictures of this size.
///
/// # Errors
/// [`Error::Setting`] for a method that cannot be used.
pub(crate) fn painter(method: Method, width: u32, height: u32) -> Result<Painter, Error> {
    let size = (width, height);
    match method {
        Method::Exact => bands(size, Exact::new(width)),
        Method::Mask => bands(size, Masks::<u16>::new(width)),
        Method::Mask64 => bands(size, Masks::<u64>::new(width)),
        Method::None => bands(size, Masks::<u16>::at(width, CENTRE)),
        Method::Grid(side) => supersampled(size, Pattern::Grid(side)),
        Method::Random(count) => supersampled(size, Pattern::Random(count)),
        Method::Jitter(count) => supersampled(size, Pattern::Jitter(count)),
        Method::Poisson(count) => supersampled(size, Pattern::Poisson(PoissonTile::new(count))),
        Method::Accumulate(count) => Ok(Painter::Bands(Box::new(Accumulate::new(width, height, count)))),
        Method::Adaptive(most) => Ok(Painter::Bands(Box::new(adaptive::Adaptive::new(most, width, height)))),
        Method::Corner => Ok(Painter::Bands(Box::new(corner::Corner::new(width, height)))),
        Method::CornerTiny => Ok(Painter::Bands(Box::new(corner::Corner::tiny(width, height)))),
        Method::Cone => Ok(Painter::Bands(cone::painter(width, height))),
        Method::Area => Ok(Painter::Bands(area::painter(width, height))),
        Method::Beam => Ok(Painter::Picture(beam::paint)),
        Method::TinySkia => Ok(Painter::Picture(tiny_skia::paint)),
    }
}

fn bands<C: Coverage + 'static>((width, height): (u32, u32), coverage: C) -> Result<Painter, Error> {
    Ok(Painter::Bands(Box::new(BandRenderer::new(width, height, coverage))))
}

/// With as many words as the samples need.
fn supersampled((width, height): (u32, u32), pattern: Pattern) -> Result<Painter, Error> {
    match pattern.count() {
        0..=64 => bands((width, height), Sampled::<u64>::new(width, pattern)),
        65..=256 => bands((width, height), Sampled::<Words<4>>::new(width, pattern)),
        _ => bands((width, height), Sampled::<Words<16>>::new(width, pattern)),
    }
}
