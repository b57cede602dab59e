//! Takes folders or files of animated SVG, compares frames at given times with those of headless
//! Chromium, which has its own clock for SMIL and CSS animations and is paused at the same times.
//!
//!     cargo run --release --example against_chromium -- samples/anim
//!
//! Prints for each file the mean difference in 8-bit levels at each time, after a 3 x 3 blur (the two
//! smooth edges differently), and the largest difference of all; marks files above [`TOLERATED`].
//!
//! Two samples differ by intent: `kinds` has `animateColor`, which Chromium has dropped, and `motion` has
//! a path with `calcMode="linear"`, whose vertices SVG gives equal times and Chromium times by distance.
//!
//!     --save FOLDER     ours, Chromium's and the difference side by side, a row for each time
//!     --answers FILE    stores what was found to be right, for the tests, which need no Chromium

#[path = "../tests/support/moments.rs"]
mod moments;

use moments::{cells, picture, SIDE, TIMES};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use toon_raster::frames::Timeline;
use toon_raster::Options;

/// Pictures side by side on the page that Chromium draws.
const COLUMNS: usize = 15;
/// Mean difference in levels which edges alone may make.
const TOLERATED: f64 = 2.0;
/// Largest difference where no shape is anywhere else, in levels: only such pictures are stored.
const ALIKE: f64 = 64.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut files, mut save, mut answers) = (Vec::new(), None, None);
    let mut arguments = std::env::args_os().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.to_str() {
            Some("--save") => save = arguments.next().map(PathBuf::from),
            Some("--answers") => answers = arguments.next().map(PathBuf::from),
            _ => collect(Path::new(&argument), &mut files),
        }
    }
    files.sort();
    let folder = std::env::temp_dir().join(format!("against-chromium-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let page = screenshot(&files, &folder);
    std::fs::remove_dir_all(&folder)?;
    let (width, page) = page?;
    let (mut above, mut right) = (0, String::new());
    for (row, file) in files.iter().enumerate() {
        let timeline = Timeline::read(&std::fs::read(file)?, &Options::default())?;
        let (mut line, mut far, mut worst) = (String::new(), false, 0.0_f64);
        let (mut strip, mut stored) = (Vec::new(), String::new());
        for (column, time) in TIMES.into_iter().enumerate() {
            let ours = picture(&timeline, time)?;
            let cell = row * TIMES.len() + column;
            let (left, top) = (cell % COLUMNS * SIDE, cell / COLUMNS * SIDE);
            let theirs = |x: usize, y: usize, c: usize| page[((top + y) * width + left + x) * 3 + c];
            let own = |x: usize, y: usize, c: usize| ours[(y * SIDE + x) * 4 + c];
            let (mean, largest) = difference(own, theirs);
            far |= mean > TOLERATED;
            worst = worst.max(largest);
            write!(line, "{mean:6.2} ")?;
            let hex: String = cells(&ours).iter().map(|byte| format!("{byte:02x}")).collect();
            writeln!(stored, "{} {time} {hex}", file.display())?;
            strip.extend(side_by_side(own, theirs));
        }
        above += usize::from(far);
        let alike = worst <= ALIKE;
        let mark = match (far, alike) {
            (true, _) => "  <-- above",
            (false, false) => "  <-- a shape differs",
            (false, true) => "",
        };
        println!("{line} {worst:4.0} {}{mark}", file.display());
        if !far && alike {
            right += &stored;
        }
        if let Some(folder) = &save {
            std::fs::create_dir_all(folder)?;
            let name = folder.join(file.with_extension("png").file_name().unwrap_or_default());
            let rows = (SIDE * TIMES.len()) as u32;
            image::save_buffer(name, &strip, 3 * SIDE as u32, rows, image::ColorType::Rgb8)?;
        }
    }
    println!("{} of {} files within {TOLERATED} levels", files.len() - above, files.len());
    if let Some(file) = answers {
        std::fs::write(file, right)?;
    }
    Ok(())
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    match std::fs::read_dir(path) {
        Ok(entries) => entries.flatten().for_each(|entry| collect(&entry.path(), files)),
        Err(_) if path.extension().is_some_and(|e| e == "svg") => files.push(path.to_path_buf()),
        Err(_) => {}
    }
}

/// Width and RGB rows of a page with every file at every time.
fn screenshot(files: &[PathBuf], folder: &Path) -> Result<(usize, Vec<u8>), Box<dyn std::error::Error>> {
    let width = SIDE * COLUMNS;
    let height = SIDE * (files.len() * TIMES.len()).div_ceil(COLUMNS);
    let mut page = format!("<body style='margin:0;width:{width}px'>");
    for file in files {
        let svg = std::fs::read_to_string(file)?;
        for time in TIMES {
            let document = format!(
                "<body style='margin:0'>{svg}<style>body>svg{{width:{SIDE}px;height:{SIDE}px;display:block}}\
                 </style><script>var s=document.querySelector('svg');s.pauseAnimations();s.setCurrentTime({time});\
                 document.getAnimations().forEach(a=>{{if(a.playState!='paused'){{a.pause();a.currentTime={}}}}})</script>",
                1000.0 * time
            );
            let document = document.replace('&', "&amp;").replace('"', "&quot;");
            page += &format!(
                "<iframe srcdoc=\"{document}\" width={SIDE} height={SIDE} style='border:0;float:left'></iframe>"
            );
        }
    }
    std::fs::write(folder.join("page.html"), page)?;
    let status = Command::new("chromium")
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--virtual-time-budget=4000",
        ])
        .arg("--force-device-scale-factor=1")
        .arg(format!("--window-size={width},{height}"))
        .arg(format!("--screenshot={}", folder.join("page.png").display()))
        .arg(folder.join("page.html"))
        .stderr(Stdio::null())
        .status()
        .map_err(|e| format!("chromium cannot be run (install it): {e}"))?;
    let page = image::open(folder.join("page.png"))
        .map_err(|e| format!("chromium ended with {status} and made no picture: {e}"))?;
    Ok((page.width() as usize, page.into_rgb8().into_raw()))
}

/// Mean and largest difference of two pictures, each blurred by the mean of 3 x 3 pixels.
fn difference(a: impl Fn(usize, usize, usize) -> u8, b: impl Fn(usize, usize, usize) -> u8) -> (f64, f64) {
    let (mut sum, mut largest) = (0, 0);
    for y in 1..SIDE - 1 {
        for x in 1..SIDE - 1 {
            for c in 0..3 {
                let around = (0..9).map(|i| (x + i % 3 - 1, y + i / 3 - 1));
                let off = around.map(|(x, y)| i32::from(a(x, y, c)) - i32::from(b(x, y, c))).sum::<i32>();
                sum += off.unsigned_abs();
                largest = largest.max(off.unsigned_abs());
            }
        }
    }
    (f64::from(sum) / (9 * 3 * (SIDE - 2) * (SIDE - 2)) as f64, f64::from(largest) / 9.0)
}

/// RGB rows of both and of their difference.
fn side_by_side(a: impl Fn(usize, usize, usize) -> u8, b: impl Fn(usize, usize, usize) -> u8) -> Vec<u8> {
    let pixel = |place: usize, x: usize, y: usize, c: usize| match place {
        0 => a(x, y, c),
        1 => b(x, y, c),
        _ => a(x, y, c).abs_diff(b(x, y, c)),
    };
    let row = |y: usize| (0..3 * SIDE * 3).map(move |i| pixel(i / (3 * SIDE), i / 3 % SIDE, y, i % 3));
    (0..SIDE).flat_map(row).collect()
}
