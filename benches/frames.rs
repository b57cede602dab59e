//! Time of whole sequences, drawing to frames, beside resvg: `cargo bench --bench frames`.
//!
//! `benches/README.md` says what is timed. A drawing of cel animation is generated; `--dir` takes others.

#[path = "support/cel_animation.rs"]
mod cel_animation;
#[path = "support/machine.rs"]
mod machine;
#[path = "support/random.rs"]
mod random;

use clap::Parser;
use std::io::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;
use toon_raster::frames::Timeline;
use toon_raster::{usvg, Options};

/// Times this program, a process of resvg's for each frame, and one process that calls resvg::render.
#[derive(Parser)]
struct Args {
    /// resvg's program.
    #[arg(long, default_value = "resvg")]
    resvg: PathBuf,
    /// Timed rounds, all in turns.
    #[arg(long, default_value_t = 3)]
    runs: usize,
    /// Folders of frames and animated files, in place of the generated animation.
    #[arg(long)]
    dir: Vec<PathBuf>,
    /// Pixels in a row, of --dir.
    #[arg(long, default_value_t = 1000)]
    width: u32,
    /// Frames of an animated file, at most.
    #[arg(long, default_value_t = 100)]
    frames: usize,
    /// Frames a second of an animated file.
    #[arg(long, default_value_t = 24)]
    fps: u32,
    /// What cargo adds; without it two frames are made, small, to see that it runs.
    #[arg(long, hide = true)]
    bench: bool,
}

/// A sequence: what our program is given, and its frames as drawings.
struct Sequence {
    name: String,
    input: PathBuf,
    /// Arguments of an animated file.
    animated: Vec<String>,
    frames: Vec<PathBuf>,
    width: u32,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.bench {
        (args.runs, args.frames) = (1, 2);
    }
    let scratch = std::env::temp_dir().join(format!("toon-raster-bench-{}", std::process::id()));
    let done = std::fs::create_dir_all(&scratch).and_then(|()| run(&args, &scratch));
    let _ = std::fs::remove_dir_all(&scratch);
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("frames: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args, scratch: &Path) -> Result<()> {
    println!("{}", machine::line());
    println!("| sequence | frames | to | toon-raster | 1 thread | tiles reused | a resvg process a frame | ÷ | resvg::render and png | ÷ |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let resvg = Command::new(&args.resvg).arg("--version").output().is_ok();
    if !resvg {
        eprintln!("{} is not there (say --resvg PATH, or cargo install resvg)", args.resvg.display());
    }
    let inputs = if args.dir.is_empty() {
        let input = scratch.join("cel.svg");
        std::fs::write(&input, cel_animation::drawing())?;
        vec![input]
    } else {
        args.dir.clone()
    };
    for (number, input) in inputs.iter().enumerate() {
        let folder = scratch.join(number.to_string());
        std::fs::create_dir_all(&folder)?;
        let sequence = open(args, input, &folder)?;
        for format in ["rgba", "png"] {
            measure(args, &sequence, format, resvg, &folder)?;
        }
    }
    Ok(())
}

/// The frames of a folder, or those of an animated file, written to `folder` one by one.
fn open(args: &Args, input: &Path, folder: &Path) -> Result<Sequence> {
    let name = input.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let width = if !args.bench {
        64
    } else if args.dir.is_empty() {
        1920
    } else {
        args.width
    };
    let (input, mut frames, mut animated) = (input.to_path_buf(), Vec::new(), Vec::new());
    if input.is_dir() {
        frames = std::fs::read_dir(&input)?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
        frames.retain(|path| path.extension().is_some_and(|e| e == "svg"));
        frames.sort();
    } else {
        let timeline = Timeline::read(&std::fs::read(&input)?, &Options::default()).map_err(Error::other)?;
        let count = (timeline.length().frames(args.fps.into()) as usize).clamp(1, args.frames);
        animated =
            ["--fps", &args.fps.to_string(), "--frames", &format!("1-{count}")].map(String::from).to_vec();
        for n in 0..count {
            frames.push(folder.join(format!("f.{n:04}.svg")));
            std::fs::write(&frames[n], timeline.document_at(n as f64 / f64::from(args.fps)))?;
        }
    }
    Ok(Sequence { name, input, animated, frames, width })
}

fn measure(args: &Args, sequence: &Sequence, format: &str, resvg: bool, scratch: &Path) -> Result<()> {
    let mut times: [Vec<f64>; 4] = Default::default();
    let mut reused = 0.0;
    for _ in 0..args.runs {
        let mut lap = |which: usize, work: &mut dyn FnMut() -> Result<()>| {
            let start = Instant::now();
            work()?;
            times[which].push(start.elapsed().as_secs_f64() * 1e3 / sequence.frames.len() as f64);
            Ok::<_, Error>(())
        };
        lap(0, &mut || ours(sequence, format, "0", scratch).map(|share| reused = share))?;
        lap(1, &mut || ours(sequence, format, "1", scratch).map(drop))?;
        if resvg {
            lap(2, &mut || processes(&args.resvg, sequence, scratch))?;
        }
        lap(3, &mut || in_process(sequence))?;
    }
    let [all, one, processes, inside] = times.map(median);
    println!(
        "| {} | {} | {format} | {all:.2} | {one:.2} | {:.0}% | {processes:.1} | {:.1} | {inside:.1} | {:.1} |",
        sequence.name,
        sequence.frames.len(),
        100.0 * reused,
        processes / all,
        inside / all
    );
    Ok(())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Our program; raw frames go nowhere. The share of tiles that it reused.
fn ours(sequence: &Sequence, format: &str, threads: &str, scratch: &Path) -> Result<f64> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_toon-raster"));
    command.arg(&sequence.input).args(&sequence.animated);
    command.args(["-w", &sequence.width.to_string(), "-t", threads, "--perf=json", "-q"]);
    match format {
        "rgba" => command.args(["-", "--format", "rgba"]),
        _ => command.arg("-o").arg(scratch.join("ours.####.png")),
    };
    let done = command.stdout(Stdio::null()).stderr(Stdio::piped()).output()?;
    let said: serde_json::Value = serde_json::from_slice(&done.stderr)?;
    match done.status.success() {
        true => Ok(said["tiles_reused"].as_f64().unwrap_or(0.0)),
        false => Err(Error::other(String::from_utf8_lossy(&done.stderr).into_owned())),
    }
}

/// One process a frame.
fn processes(resvg: &Path, sequence: &Sequence, scratch: &Path) -> Result<()> {
    for frame in &sequence.frames {
        let mut command = Command::new(resvg);
        command.args(["-w", &sequence.width.to_string()]).arg(frame).arg(scratch.join("theirs.png"));
        if !command.stderr(Stdio::null()).status()?.success() {
            return Err(Error::other(format!("resvg failed on {}", frame.display())));
        }
    }
    Ok(())
}

/// Parses, renders and packs each frame here, one after the other, in memory.
fn in_process(sequence: &Sequence) -> Result<()> {
    let options = usvg::Options::default();
    for frame in &sequence.frames {
        let tree = usvg::Tree::from_data(&std::fs::read(frame)?, &options).map_err(Error::other)?;
        let size = tree.size().scale_to_width(sequence.width as f32).expect("a width above zero");
        let mut pixmap =
            resvg::tiny_skia::Pixmap::new(size.width().ceil() as u32, size.height().ceil() as u32)
                .expect("a picture of some pixels");
        let scale = size.width() / tree.size().width();
        resvg::render(&tree, resvg::tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
        let (width, height) = (pixmap.width(), pixmap.height());
        let mut encoder = png::Encoder::new(Vec::new(), width, height);
        encoder.set_color(png::ColorType::Rgba);
        let straight: Vec<u8> = pixmap
            .pixels()
            .iter()
            .map(|pixel| pixel.demultiply())
            .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()])
            .collect();
        encoder.write_header()?.write_image_data(&straight)?;
    }
    Ok(())
}
