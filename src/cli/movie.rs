//! Takes frames in order, makes one file or stream of them, in any format that holds many.

use super::ffmpeg::{Ffmpeg, Video};
use super::output::Output;
use super::report::Failure;
use super::values::{Format, YuvChoice};
use std::io::Write;
use toon_raster::encode::{
    ApngWriter, Effort, GifWriter, Layout, PngWriter, Rate, SheetWriter, Y4mWriter, Yuv,
};
use toon_raster::frames::gallery::Made;
use toon_raster::render::Canvas;
use toon_raster::{Error, Pixmap};

/// What is known before the first frame.
pub struct Look {
    pub format: Format,
    pub frames: u32,
    /// All pixels will be.
    pub opaque: bool,
    pub rate: Rate,
    pub effort: Effort,
    /// How often it plays; 0 is for ever.
    pub plays: u16,
    /// Columns of a sprite sheet.
    pub sheet: Option<u32>,
    /// How colours become luma and chroma, where they do.
    pub yuv: YuvChoice,
}

/// A frame's picture, which others may look at too.
pub type Shown = Made<Failure>;

/// Frames on their way into one output: the first says how large all are.
pub struct Reel<'o> {
    look: &'o Look,
    /// Until there is a first frame.
    output: Option<&'o mut Output>,
    movie: Option<Movie<'o>>,
    last: Option<Shown>,
    /// Frames that failed before there was one to stand for them.
    missing: usize,
}

impl<'o> Reel<'o> {
    pub fn new(output: &'o mut Output, look: &'o Look) -> Reel<'o> {
        Reel { look, output: Some(output), movie: None, last: None, missing: 0 }
    }

    /// Adds the next frame.
    ///
    /// # Errors
    /// When it does not go with the others or with the format, or cannot be written.
    pub fn add(&mut self, frame: &Shown) -> Result<(), Error> {
        let Some(picture) = seen(frame) else { return self.repeat() };
        let (width, height) = (picture.width(), picture.height());
        if let Some(first) =
            self.last.as_ref().and_then(seen).filter(|f| (f.width(), f.height()) != (width, height))
        {
            return Err(Error::Size(format!(
                "{width} x {height} pixels after frames of {} x {} (give all one size with -w and -h)",
                first.width(),
                first.height()
            )));
        }
        let translucent = || picture.data().as_chunks::<4>().0.iter().any(|pixel| pixel[3] != 255);
        let format = self.look.format;
        if format.lacks_alpha() && !self.look.opaque && translucent() {
            return Err(Error::Setting(format!(
                "it has transparent pixels, and {} cannot (say --background COLOR)",
                format.extension()
            )));
        }
        if let Some(output) = self.output.take() {
            self.movie = Some(Movie::new(output, self.look, width, height)?);
        }
        let movie = self.movie.as_mut().expect("it was begun with the first frame");
        for _ in 0..=std::mem::take(&mut self.missing) {
            movie.add(picture)?;
        }
        self.last = Some(frame.clone());
        Ok(())
    }

    /// Stands in for a frame that failed: by the one before it or, without one, the one after.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn repeat(&mut self) -> Result<(), Error> {
        match (&mut self.movie, self.last.as_ref().and_then(seen)) {
            (Some(movie), Some(last)) => movie.add(last),
            _ => {
                self.missing += 1;
                Ok(())
            }
        }
    }

    /// Ends the file; the frames' size, if there was one.
    ///
    /// # Errors
    /// When the last bytes cannot be written.
    pub fn finish(self) -> Result<Option<(u32, u32)>, Error> {
        if let Some(movie) = self.movie {
            movie.finish()?;
        }
        Ok(self.last.as_ref().and_then(seen).map(|last| (last.width(), last.height())))
    }
}

fn seen(frame: &Shown) -> Option<&Pixmap> {
    frame.as_ref().as_ref().ok().map(Canvas::picture)
}

/// A file or stream of frames being written.
enum Movie<'o> {
    Raw(&'o mut Output),
    /// Of one frame.
    Png(Box<PngWriter<&'o mut Output>>),
    Y4m(Y4mWriter<&'o mut Output>),
    Apng(Box<ApngWriter<&'o mut Output>>),
    Gif(Box<GifWriter<&'o mut Output>>),
    Sheet(Box<SheetWriter<&'o mut Output>>),
    Ffmpeg(Ffmpeg),
}

impl<'o> Movie<'o> {
    fn new(to: &'o mut Output, look: &Look, width: u32, height: u32) -> Result<Movie<'o>, Error> {
        let &Look { frames, opaque, rate, effort, plays, .. } = look;
        Ok(match (look.format, look.sheet) {
            (Format::Rgba, _) => Movie::Raw(to),
            (Format::Y4m, _) => {
                let yuv = look.yuv.or(Yuv { halved: false, bt709: false });
                Movie::Y4m(Y4mWriter::new(to, width, height, rate, yuv)?)
            }
            (Format::Apng, _) => {
                let size = (width, height);
                Movie::Apng(Box::new(ApngWriter::new(to, size, opaque, frames, rate, plays.into(), effort)?))
            }
            (Format::Gif, _) => Movie::Gif(Box::new(GifWriter::new(to, width, height, rate, plays)?)),
            (format @ (Format::Mp4 | Format::Webm | Format::Webp), _) => {
                let file = to.hand_over().ok_or_else(|| {
                    Error::Setting(format!("ffmpeg makes {} only as a file (name one)", format.extension()))
                })?;
                // What players expect.
                let yuv = look.yuv.or(Yuv { halved: true, bt709: true });
                let video = Video { format, width, height, rate, opaque, yuv, plays };
                Movie::Ffmpeg(Ffmpeg::start(file, &video)?)
            }
            (Format::Png, Some(columns)) => {
                let layout = Layout { width, height, columns, frames };
                Movie::Sheet(Box::new(SheetWriter::new(to, layout, opaque, effort)?))
            }
            (Format::Png, None) => Movie::Png(Box::new(PngWriter::new(to, width, height, opaque, effort)?)),
        })
    }

    fn add(&mut self, frame: &Pixmap) -> Result<(), Error> {
        match self {
            Movie::Raw(output) => Ok(output.write_all(frame.data())?),
            Movie::Png(png) => png.write_rows(frame.data()),
            Movie::Y4m(y4m) => y4m.write_frame(frame.data()),
            Movie::Apng(apng) => apng.write_frame(frame.data()),
            Movie::Gif(gif) => gif.write_frame(frame.data()),
            Movie::Sheet(sheet) => sheet.write_frame(frame.data()),
            Movie::Ffmpeg(ffmpeg) => ffmpeg.write_frame(frame.data()),
        }
    }

    fn finish(self) -> Result<(), Error> {
        match self {
            Movie::Raw(output) => Ok(output.flush()?),
            Movie::Png(png) => png.finish(),
            Movie::Y4m(y4m) => y4m.finish(),
            Movie::Apng(apng) => apng.finish(),
            Movie::Gif(gif) => gif.finish(),
            Movie::Sheet(sheet) => sheet.finish(),
            Movie::Ffmpeg(ffmpeg) => ffmpeg.finish(),
        }
    }
}
