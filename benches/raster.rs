//! Raster time of toon-raster beside tiny-skia (resvg) and vello_cpu: `cargo bench --bench raster`.
//!
//! Parsing and encoding are not timed. `benches/README.md` says what is.

mod support;

use clap::Parser;
use std::path::PathBuf;
use std::process::ExitCode;
use support::{drawings, machine, measure, report};

/// Times this crate, resvg and vello_cpu in turns on the same drawings.
#[derive(Parser)]
struct Args {
    /// Pixels on the longer side.
    #[arg(long, value_delimiter = ',', default_values_t = [512, 1024, 2048])]
    size: Vec<u16>,
    /// Numbers of threads; tiny-skia always has one.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    threads: Vec<usize>,
    /// Timed rounds of each scene.
    #[arg(long, default_value_t = 11)]
    runs: usize,
    /// Only scenes or files whose name contains this; may be given several times.
    #[arg(long)]
    scene: Vec<String>,
    /// The .svg and .svgz files of this folder in place of the generated scenes.
    #[arg(long)]
    dir: Option<PathBuf>,
    /// Writes all figures to this file.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Also compares the pictures with resvg's: mean difference in 8-bit levels.
    #[arg(long)]
    check: bool,
    /// Writes the generated scenes as SVG files into this folder, and stops.
    #[arg(long)]
    write_scenes: Option<PathBuf>,
    /// What cargo adds; without it every scene runs once, small, to see that it runs.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    if !args.bench {
        (args.size, args.threads, args.runs) = (vec![64], vec![1], 1);
    }
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> std::io::Result<()> {
    if let Some(folder) = &args.write_scenes {
        std::fs::create_dir_all(folder)?;
        for drawing in support::scenes::all() {
            std::fs::write(folder.join(drawing.name + ".svg"), drawing.svg)?;
        }
        return Ok(());
    }
    let machine = machine::line();
    println!("{machine}\nmedian milliseconds of {} runs, raster only\n", args.runs.max(1));
    println!("{}", report::heading(args.check));
    let mut rows = Vec::new();
    for drawing in drawings::chosen(args.dir.as_deref(), &args.scene)? {
        for &size in &args.size {
            for &threads in &args.threads {
                let plan =
                    measure::Plan { size: size.max(1), threads, runs: args.runs.max(1), check: args.check };
                let row = measure::measure(&drawing, plan);
                println!("{}", report::line(&row));
                rows.push(row);
            }
        }
    }
    println!("\n{}\n{}", report::means(&rows), report::stages(&rows));
    match &args.json {
        Some(file) => std::fs::write(file, report::json(&machine, &rows)),
        None => Ok(()),
    }
}
