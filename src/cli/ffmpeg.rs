//! Takes frames, makes an MP4, WebM or WebP by the program ffmpeg, which gets raw pixels on its standard
//! input. What it has to say when it fails is one line.

use super::values::Format;
use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};
use std::thread::JoinHandle;
use toon_raster::encode::{Rate, Yuv};
use toon_raster::Error;

/// What a video is to be.
#[derive(Clone, Copy, Debug)]
pub struct Video {
    pub format: Format,
    pub width: u32,
    pub height: u32,
    pub rate: Rate,
    /// No pixel is transparent.
    pub opaque: bool,
    /// But for WebP, which is RGB.
    pub yuv: Yuv,
    /// How often a WebP plays; 0 is for ever.
    pub plays: u16,
}

/// The encoder at work; killed unless it is finished.
pub struct Ffmpeg {
    child: Child,
    /// Closed at the end.
    frames: Option<ChildStdin>,
    /// Its first words.
    words: Option<JoinHandle<String>>,
}

impl Ffmpeg {
    /// Starts it, to write over `file`.
    ///
    /// # Errors
    /// When it is not installed, or the video cannot be made as wanted.
    pub fn start(file: &Path, video: &Video) -> Result<Ffmpeg, Error> {
        let mut command = Command::new("ffmpeg");
        command.args(input(video)).args(coding(video)?).arg("-y").arg(file);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|e| match e.kind() {
            ErrorKind::NotFound => io::Error::other(
                "that takes ffmpeg, which is not installed (install it, or make a .gif, .apng or .y4m)",
            ),
            _ => io::Error::new(e.kind(), format!("ffmpeg cannot be run: {e}")),
        })?;
        let frames = child.stdin.take();
        let errors = child.stderr.take().expect("it is piped");
        let words = Some(std::thread::Builder::new().spawn(move || first_words(errors))?);
        Ok(Ffmpeg { child, frames, words })
    }

    /// Adds a frame: straight RGBA.
    ///
    /// # Errors
    /// When the encoder has given up; in its words.
    pub fn write_frame(&mut self, pixels: &[u8]) -> Result<(), Error> {
        match self.frames.as_mut().map(|pipe| pipe.write_all(pixels)) {
            Some(Ok(())) => Ok(()),
            _ => Err(self.end().err().unwrap_or_else(|| io::Error::other("ffmpeg ended too early").into())),
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// As [`Ffmpeg::write_frame`].
    pub fn finish(mut self) -> Result<(), Error> {
        self.end()
    }

    fn end(&mut self) -> Result<(), Error> {
        self.frames = None;
        let status = self.child.wait()?;
        let words = self.words.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        match status.success() {
            true => Ok(()),
            false if words.is_empty() => Err(io::Error::other(format!("ffmpeg ended with {status}")).into()),
            false => Err(io::Error::other(format!("ffmpeg says: {words}")).into()),
        }
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        self.frames = None;
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Raw frames.
fn input(video: &Video) -> Vec<String> {
    let Video { width, height, rate, .. } = video;
    let size = format!("{width}x{height}");
    let rate = format!("{}/{}", rate.frames, rate.seconds);
    let words = ["-hide_banner", "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgba"];
    let words = words.into_iter().chain(["-video_size", &size, "-framerate", &rate, "-i", "pipe:0", "-an"]);
    words.map(str::to_string).collect()
}

/// The codec with its settings. Flat colours and hard edges want more bits than films do.
fn coding(video: &Video) -> Result<Vec<String>, Error> {
    let yuv = video.yuv;
    let chroma = if yuv.halved { "420" } else { "444" };
    let mut words: Vec<String> = Vec::new();
    let mut add = |more: &str| words.extend(more.split(' ').map(str::to_string));
    match video.format {
        Format::Mp4 => {
            add(&format!("-vf {}", filters(video, &format!("yuv{chroma}p"))));
            add("-c:v libx264 -preset medium -tune animation -crf 14 -movflags +faststart");
        }
        Format::Webm if video.opaque => {
            add(&format!("-vf {}", filters(video, &format!("yuv{chroma}p"))));
            add("-c:v libvpx-vp9 -crf 12 -b:v 0 -row-mt 1 -cpu-used 4");
        }
        Format::Webm if yuv.halved => {
            add(&format!("-vf {}", filters(video, "yuva420p")));
            // VP9 hides no frames where there is alpha.
            add("-c:v libvpx-vp9 -crf 12 -b:v 0 -row-mt 1 -cpu-used 4 -auto-alt-ref 0");
        }
        Format::Webm => {
            let why = "webm keeps transparency only with --yuv 420 (or say --background COLOR)";
            return Err(Error::Setting(why.to_string()));
        }
        _ => add(&format!(
            "-c:v libwebp_anim -pix_fmt bgra -lossless 1 -compression_level 4 -loop {}",
            video.plays
        )),
    }
    if video.format != Format::Webp {
        let matrix = matrix(yuv);
        add(&format!("-colorspace {matrix} -color_primaries bt709 -color_trc iec61966-2-1 -color_range tv"));
    }
    let container = video.format.extension();
    // Without dates and version numbers.
    add(&format!("-fflags +bitexact -flags:v +bitexact -f {container}"));
    Ok(words)
}

fn matrix(yuv: Yuv) -> &'static str {
    if yuv.bt709 {
        "bt709"
    } else {
        "smpte170m"
    }
}

/// From RGB to limited-range YUV, exactly; H.264 with half the chroma wants an even size, so that a last
/// column or row comes twice.
fn filters(video: &Video, pixels: &str) -> String {
    let yuv = video.yuv;
    let matrix = matrix(yuv);
    let scale = format!(
        "scale=out_color_matrix={matrix}:out_range=tv:flags=accurate_rnd+full_chroma_int+full_chroma_inp"
    );
    let (right, below) = (video.width % 2, video.height % 2);
    let even = match yuv.halved && video.format == Format::Mp4 && right + below > 0 {
        true => format!(
            "pad={}:{},fillborders=right={right}:bottom={below}:mode=smear,",
            video.width + right,
            video.height + below
        ),
        false => String::new(),
    };
    format!("{even}{scale},format={pixels}")
}

/// The first line of what it says, without the addresses of who says it. The rest is read away.
fn first_words(errors: ChildStderr) -> String {
    let mut first = String::new();
    for line in BufReader::new(errors).lines().map_while(Result::ok) {
        if first.is_empty() {
            let mut words = line.trim();
            while let Some((_, after)) = words.strip_prefix('[').and_then(|rest| rest.split_once("] ")) {
                words = after.trim();
            }
            first = words.to_string();
        }
    }
    first
}
