//! Takes folders or files of animated SVG, compares frames at given times with those of headless
//! Chromium, which has its own clock for SMIL and CSS animations and is paused at the same times.
//!
//!     cargo run --release --example against_chromium -- samples/anim
//!
//! Prints for each file the mean difference in 8-bit levels at each time, after a 3 x 3 blur (the two
//! smooth edges differently), and marks those above [`TOLERATED`]. Chromium is not needed for the tests:
//! they hold values worked out by hand.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use toon_raster::frames::Timeline;
use toon_raster::{Options, Renderer, Scene, Settings, Viewport};

/// Moments compared, in seconds.
const TIMES: [f64; 3] = [0.33, 1.07, 2.71];
/// Side of a picture, in pixels.
const SIDE: usize = 96;
/// Pictures side by side on the page that Chromium draws.
const COLUMNS: usize = 12;
/// Mean difference in levels which edges alone may make.
const TOLERATED: f64 = 2.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut files = Vec::new();
    std::env::args_os().skip(1).for_each(|argument| collect(Path::new(&argument), &mut files));
    files.sort();
    let folder = std::env::temp_dir().join(format!("against-chromium-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let page = screenshot(&files, &folder);
    std::fs::remove_dir_all(&folder)?;
    let (width, page) = page?;
    let mut renderer = Renderer::new(Settings { background: Some([255; 4]), ..Settings::default() })?;
    let mut above = 0;
    for (row, file) in files.iter().enumerate() {
        let timeline = Timeline::read(&std::fs::read(file)?, &Options::default())?;
        let mut differences = Vec::new();
        for (column, time) in TIMES.into_iter().enumerate() {
            let ours = frame(&timeline, time, &mut renderer)?;
            let cell = row * TIMES.len() + column;
            let (left, top) = (cell % COLUMNS * SIDE, cell / COLUMNS * SIDE);
            let theirs = |x: usize, y: usize, c: usize| page[((top + y) * width + left + x) * 3 + c];
            differences.push(difference(|x, y, c| ours[(y * SIDE + x) * 4 + c], theirs));
        }
        let far = differences.iter().any(|&d| d > TOLERATED);
        above += usize::from(far);
        let list: Vec<String> = differences.iter().map(|d| format!("{d:6.2}")).collect();
        println!("{} {}{}", list.join(" "), file.display(), if far { "  <-- above" } else { "" });
    }
    println!("{} of {} files within {TOLERATED} levels", files.len() - above, files.len());
    Ok(())
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    match std::fs::read_dir(path) {
        Ok(entries) => entries.flatten().for_each(|entry| collect(&entry.path(), files)),
        Err(_) if path.extension().is_some_and(|e| e == "svg") => files.push(path.to_path_buf()),
        Err(_) => {}
    }
}

/// Our frame, as large as fits, in the middle of a square: where Chromium puts it.
fn frame(timeline: &Timeline, time: f64, renderer: &mut Renderer) -> Result<Vec<u8>, toon_raster::Error> {
    let scene = Scene::from_bytes(timeline.document_at(time).as_bytes(), &Options::default())?;
    let (size, side) = (scene.size(), SIDE as f64);
    let scale = side / size.width.max(size.height);
    let left = 0.5 * (side - scale * size.width);
    let top = 0.5 * (side - scale * size.height);
    let transform = toon_raster::kurbo::Affine::new([scale, 0.0, 0.0, scale, left, top]);
    let viewport = Viewport { width: SIDE as u32, height: SIDE as u32, transform };
    Ok(renderer.render(&scene, &viewport)?.data().to_vec())
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
                 document.getAnimations().forEach(a=>{{a.pause();a.currentTime={}}})</script>",
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
    let file = std::fs::File::open(folder.join("page.png"))
        .map_err(|e| format!("chromium ended with {status} and made no picture: {e}"))?;
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("the page is too large")?];
    let info = reader.next_frame(&mut pixels)?;
    let rgb = match info.color_type {
        png::ColorType::Rgba => pixels.as_chunks::<4>().0.iter().flat_map(|p| [p[0], p[1], p[2]]).collect(),
        _ => pixels,
    };
    Ok((info.width as usize, rgb))
}

/// Mean difference of two pictures, each blurred by the mean of 3 x 3 pixels.
fn difference(a: impl Fn(usize, usize, usize) -> u8, b: impl Fn(usize, usize, usize) -> u8) -> f64 {
    let mut sum = 0;
    for y in 1..SIDE - 1 {
        for x in 1..SIDE - 1 {
            for c in 0..3 {
                let around = (0..9).map(|i| (x + i % 3 - 1, y + i / 3 - 1));
                let off = around.map(|(x, y)| i32::from(a(x, y, c)) - i32::from(b(x, y, c))).sum::<i32>();
                sum += off.unsigned_abs();
            }
        }
    }
    f64::from(sum) / (9 * 3 * (SIDE - 2) * (SIDE - 2)) as f64
}
