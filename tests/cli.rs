//! Drives the program as a user does: what it writes, what it says, how it ends.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

const SQUARE: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20"><rect id="r" x="5" y="5" width="10" height="10" fill="#f00"/></svg>"##;

/// A folder of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Folder {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name =
            format!("toon-raster-cli-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    /// With this drawing as `in.svg`.
    fn with(svg: &str) -> Folder {
        let folder = Folder::new();
        folder.write("in.svg", svg);
        folder
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_toon-raster"));
        command.current_dir(&self.0).args(arguments).stdin(Stdio::null());
        command
    }

    /// Width and height in the header of a PNG.
    fn png_size(&self, name: &str) -> (u32, u32) {
        png_size(&fs::read(self.0.join(name)).unwrap())
    }

    fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = walk(&self.0, &self.0);
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn walk(root: &Path, folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    entries
        .flat_map(|path| {
            if path.is_dir() {
                walk(root, &path)
            } else {
                vec![path.strip_prefix(root).unwrap().display().to_string()]
            }
        })
        .collect()
}

fn png_size(bytes: &[u8]) -> (u32, u32) {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    (reader.info().width, reader.info().height)
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[track_caller]
fn assert_success(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
}

/// It ended with this code and one line which contains this.
#[track_caller]
fn assert_fails(output: &Output, code: i32, message: &str) {
    let said = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with("toon-raster: "), "{said}");
    assert!(said.contains(message), "{said:?} does not contain {message:?}");
}

#[test]
fn a_drawing_becomes_a_png_of_its_own_size() {
    let folder = Folder::with(SQUARE);
    let output = folder.run(&["in.svg", "out.png"]);
    assert_success(&output);
    assert_eq!(stderr(&output), "");
    assert_eq!(folder.png_size("out.png"), (40, 20));
    assert_eq!(folder.files(), ["in.svg", "out.png"]);
}

#[test]
fn sizes_keep_the_aspect() {
    let folder = Folder::with(SQUARE);
    let cases: &[(&[&str], (u32, u32))] = &[
        (&["-w", "100"], (100, 50)),
        (&["--width=30"], (30, 15)),
        (&["-w", "33"], (33, 17)),
        (&["-h", "100"], (200, 100)),
        (&["-w", "100", "-h", "100"], (100, 50)),
        (&["-w", "100", "-h", "10"], (20, 10)),
        (&["-z", "2.5"], (100, 50)),
        (&["-w", "7", "-w", "80"], (80, 40)),
    ];
    for (arguments, size) in cases {
        let output = folder.run(&[arguments, &["in.svg", "out.png"][..]].concat());
        assert_success(&output);
        assert_eq!(folder.png_size("out.png"), *size, "{arguments:?}");
    }
}

#[test]
fn dpi_scales_lengths_in_inches_and_not_those_in_pixels() {
    let folder = Folder::with(r#"<svg xmlns="http://www.w3.org/2000/svg" width="1in" height="10"/>"#);
    assert_success(&folder.run(&["--dpi", "200", "in.svg", "out.png"]));
    assert_eq!(folder.png_size("out.png"), (200, 10));
}

#[test]
fn areas_of_export_have_their_sizes() {
    let folder = Folder::with(SQUARE);
    assert_success(&folder.run(&["--export-area-drawing", "-z", "2", "in.svg", "out.png"]));
    assert_eq!(folder.png_size("out.png"), (20, 20));
    // As with resvg, what says nothing beside the others is warned of.
    let output = folder.run(&["--export-area-page", "in.svg", "out.png"]);
    assert_success(&output);
    assert!(String::from_utf8_lossy(&output.stderr).contains("--export-area-page has no effect"));
    assert_success(&folder.run(&["-w", "30", "-z", "9", "in.svg", "out.png"]));
    assert_eq!(folder.png_size("out.png").0, 30);
    let output = folder.run(&["-i", "nobody", "in.svg", "x.png"]);
    assert_fails(&output, 3, "no element has the id 'nobody'");
    assert!(!folder.0.join("x.png").exists());
}

#[test]
fn a_dash_is_standard_input_and_standard_output() {
    let folder = Folder::new();
    for arguments in [&["-", "-"][..], &["-", "-c"], &["-", "-o", "-"]] {
        let mut child = folder
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(SQUARE.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_success(&output);
        assert_eq!(png_size(&output.stdout), (40, 20));
    }
    assert_eq!(folder.files(), Vec::<String>::new());
}

#[test]
fn raw_pixels_are_four_bytes_each() {
    let folder = Folder::with(SQUARE);
    let output = folder.run(&["in.svg", "-", "--format", "rgba"]);
    assert_success(&output);
    assert_eq!(output.stdout.len(), 40 * 20 * 4);
    assert_success(&folder.run(&["in.svg", "out.rgba"]));
    assert_eq!(fs::read(folder.0.join("out.rgba")).unwrap(), output.stdout);
}

#[test]
fn several_inputs_go_to_a_folder_or_a_pattern() {
    let folder = Folder::with(SQUARE);
    folder.write("b.svg", SQUARE);
    assert_success(&folder.run(&["in.svg", "b.svg", "-o", "made/"]));
    assert_success(&folder.run(&["in.svg", "b.svg", "-o", "shot.####.png"]));
    assert_success(&folder.run(&["in.svg", "b.svg", "-o", "seq/%03d.png", "--start-number", "9"]));
    let expected = [
        "b.svg",
        "in.svg",
        "made/b.png",
        "made/in.png",
        "seq/009.png",
        "seq/010.png",
        "shot.0001.png",
        "shot.0002.png",
    ];
    assert_eq!(folder.files(), expected);
}

#[test]
fn two_inputs_for_one_output_are_an_error_before_any_work() {
    let folder = Folder::with(SQUARE);
    folder.write("sub/in.svg", SQUARE);
    let output = folder.run(&["in.svg", "sub/in.svg", "-o", "made/"]);
    assert_fails(&output, 2, "would both become made/in.png");
    let output = folder.run(&["in.svg", "sub/in.svg", "-o", "one.png"]);
    assert_fails(&output, 2, "one.png is one file for 2 inputs");
    assert_eq!(folder.files(), ["in.svg", "sub/in.svg"]);
}

#[test]
fn an_input_is_never_written_over() {
    let folder = Folder::with(SQUARE);
    assert_fails(&folder.run(&["in.svg", "in.svg", "--format", "png"]), 2, "would be written over");
    assert_eq!(fs::read_to_string(folder.0.join("in.svg")).unwrap(), SQUARE);
}

#[test]
fn one_bad_input_of_several_ends_with_1_and_the_others_are_done() {
    let folder = Folder::with(SQUARE);
    folder.write("bad.svg", "<svg");
    folder.write("z.svg", SQUARE);
    let output = folder.run(&["in.svg", "bad.svg", "z.svg", "-o", "made/"]);
    assert_fails(&output, 1, "bad.svg: not well-formed XML");
    assert_eq!(folder.files(), ["bad.svg", "in.svg", "made/in.png", "made/z.png", "z.svg"]);
}

#[test]
fn wrong_command_lines_end_with_2_and_one_line() {
    let folder = Folder::with(SQUARE);
    let cases: &[(&[&str], &str)] = &[
        (&[], "no input"),
        (&["in.svg"], "no output"),
        (&["in.svg", "b.svg", "c.png"], "several inputs need -o"),
        (&["--bogus", "in.svg", "out.png"], "--bogus"),
        (&["-w", "0", "in.svg", "out.png"], "at least 1"),
        (&["-z", "nan", "in.svg", "out.png"], "above zero"),
        (&["--aa", "grid:0", "in.svg", "out.png"], "from 1 to 32"),
        (&["--aa", "jitter", "in.svg", "out.png"], "jitter:N"),
        (&["--aa", "magic", "in.svg", "out.png"], "unknown method"),
        (&["--aa", "tiny-skia", "--linear", "in.svg", "out.png"], "leave out --linear"),
        (&["--format", "bmp", "in.svg", "out.png"], "unknown format"),
        (&["--fps", "0", "in.svg", "out.gif"], "above 0"),
        (&["--frames", "9-3", "in.svg", "-o", "f.###.png"], "backwards"),
        (&["--chunk", "3/2", "in.svg", "-o", "f.###.png"], "I/N"),
        (&["--fps", "9", "in.svg", "out.png"], "one picture for many frames"),
        (&["--fps", "9", "in.svg", "-"], "need --format"),
        (&["--sheet", "3x", "in.svg", "out.gif"], "--sheet makes a PNG"),
        (&["f.####.svg", "out.gif"], "no file matches"),
        (&[".", "out.png"], "one picture for many frames"),
        (&["in.svg", "out.xyz"], "format of out.xyz"),
        (&["in.svg", "out"], "format of out"),
        (&["-b", "nocolour", "in.svg", "out.png"], "CSS colour"),
        (&["--tolerance", "0", "in.svg", "out.png"], "0.0001"),
        (&["--fast-png", "--small-png", "in.svg", "out.png"], "cannot be used with"),
        (&["--stylesheet", "none.css", "in.svg", "out.png"], "none.css"),
        (&["-", "-", "-o", "made/"], "only once"),
        (&["--query-all", "in.svg", "out.png"], "one input"),
        (&["compare"], "required arguments"),
        (&["explain"], "required arguments"),
        (&["explain", "-", "-"], "only once"),
        (&["explain", "--linear", "--aa", "tiny-skia", "in.svg"], "linear light"),
    ];
    for (arguments, message) in cases {
        assert_fails(&folder.run(arguments), 2, message);
    }
    assert_eq!(folder.files(), ["in.svg"]);
}

#[test]
fn an_output_that_cannot_be_written_is_said_in_one_line() {
    let folder = Folder::with(SQUARE);
    assert_fails(&folder.run(&["in.svg", "no/such/out.png"]), 1, "its folder does not exist");
    folder.write("file", "");
    assert_fails(&folder.run(&["in.svg", "-o", "file/out.png"]), 1, "cannot be written");
    assert_eq!(folder.files(), ["file", "in.svg"]);
}

#[test]
fn a_failed_input_leaves_an_earlier_output_as_it_was() {
    let folder = Folder::with(SQUARE);
    folder.write("out.png", "precious");
    folder.write("bad.svg", "<svg");
    assert_fails(&folder.run(&["bad.svg", "out.png"]), 3, "bad.svg");
    assert_eq!(fs::read_to_string(folder.0.join("out.png")).unwrap(), "precious");
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_said_in_one_line() {
    if !Path::new("/dev/full").exists() {
        return;
    }
    let folder = Folder::with(SQUARE);
    assert_fails(&folder.run(&["in.svg", "/dev/full"]), 1, "/dev/full cannot be written");
}

#[cfg(unix)]
#[test]
fn a_link_keeps_pointing_where_it_points() {
    let folder = Folder::with(SQUARE);
    folder.write("real.png", "old");
    std::os::unix::fs::symlink("real.png", folder.0.join("link.png")).unwrap();
    assert_success(&folder.run(&["in.svg", "link.png"]));
    assert!(fs::symlink_metadata(folder.0.join("link.png")).unwrap().is_symlink());
    assert_eq!(folder.png_size("real.png"), (40, 20));
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with(SQUARE);
    for arguments in [&["in.svg", "-", "--format", "rgba", "-w", "4000"][..], &["completions", "bash"]] {
        let mut child =
            folder.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!((child.wait().unwrap().code(), said.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

#[test]
fn what_is_wrong_with_every_frame_of_a_film_is_said_once() {
    let folder = Folder::with(
        "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><filter id='f'><feGaussianBlur stdDeviation='1'/></filter>
        <rect width='4' height='4' filter='url(#f)'><animate attributeName='x' to='5' dur='1s'/></rect></svg>",
    );
    for output in ["out.####.png", "out.gif"] {
        let output = folder.run(&["in.svg", "-o", output, "--fps", "5", "--aa", "beam"]);
        let said = stderr(&output);
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(lines.len() == 2 && lines[0].contains("the method beam draws no filters"), "{said}");
        assert!(lines[1].ends_with("in.svg: the same in 4 more frames"), "{said}");
        // Each drawing of several has its own line.
        folder.write("k1.svg", "<svg");
        folder.write("k2.svg", "<svg");
        let said = stderr(&folder.run(&["k*.svg", "-o", "films/"]));
        assert_eq!(said.lines().count(), 2, "{said}");
    }
}

#[test]
fn too_many_pixels_are_refused_with_the_name_of_the_flag() {
    let folder = Folder::with(SQUARE);
    assert_fails(&folder.run(&["-w", "65536", "in.svg", "out.png"]), 3, "--max-pixels");
    assert_fails(&folder.run(&["--max-pixels", "799", "in.svg", "out.png"]), 3, "40 x 20");
    assert_success(&folder.run(&["--max-pixels", "800", "in.svg", "out.png"]));
}

#[test]
fn perf_json_is_one_object_with_the_time_of_every_stage() {
    let folder = Folder::with(SQUARE);
    for threads in ["1", "2"] {
        let output = folder.run(&["--perf=json", "-t", threads, "-w", "1000", "in.svg", "out.png"]);
        assert_success(&output);
        let json: serde_json::Value = serde_json::from_str(&stderr(&output)).expect("JSON");
        for key in ["read_ms", "parse_ms", "raster_ms", "encode_ms", "total_ms"] {
            assert!(json[key].as_f64().is_some_and(|ms| ms >= 0.0), "{key}: {json}");
        }
        assert_eq!((json["width"].as_u64(), json["height"].as_u64()), (Some(1000), Some(500)));
        assert!(json["stages_ms"].is_object() && json["counts"].is_object());
    }
    let output = folder.run(&["--perf", "in.svg", "out.png"]);
    assert_success(&output);
    assert!(stderr(&output).contains("raster"));
}

#[test]
fn progress_json_is_one_line_an_input() {
    let folder = Folder::with(SQUARE);
    folder.write("bad.svg", "<svg");
    let output = folder.run(&["in.svg", "bad.svg", "-o", "made/", "--progress", "json"]);
    let said = stderr(&output);
    let objects: Vec<serde_json::Value> =
        said.lines().filter(|l| l.starts_with('{')).map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(objects.len(), 2, "{said}");
    assert_eq!((objects[0]["ok"].as_bool(), objects[1]["ok"].as_bool()), (Some(true), Some(false)));
    assert_eq!(objects[1]["total"].as_u64(), Some(2));
}

#[test]
fn queries_print_ids_and_boxes() {
    let folder = Folder::with(SQUARE);
    let output = folder.run(&["--query-all", "in.svg"]);
    assert_success(&output);
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "r,5,5,10,10\n");
    let output = folder.run(&["--query-bbox", "in.svg"]);
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "5,5,10,10\n");
}

#[test]
fn help_names_every_option_that_exists() {
    let output = Folder::new().run(&["--help"]);
    assert_success(&output);
    let help = String::from_utf8(output.stdout).unwrap();
    let options = "-w, --width|-h, --height|-z, --zoom|--dpi|-b, --background|-i, --export-id|\
        --export-area-page|--export-area-drawing|--query-all|--query-bbox|--use-font-file|--use-fonts-dir|\
        --skip-system-fonts|--font-family|--list-fonts|--aa|--tolerance|--linear|--highlights|-t, --threads|--format|\
        --fast-png|--small-png|--max-pixels|--perf|-q, --quiet|-v, --verbose|--progress|-o, --output|\
        -V, --version|--start-number|--stylesheet|--languages|--shape-rendering|--text-rendering|\
        --resources-dir|completions";
    for option in options.split('|') {
        assert!(help.contains(option), "--help does not name {option}");
    }
}

#[test]
fn version_names_the_program() {
    let output = Folder::new().run(&["--version"]);
    let expected = format!("toon-raster {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), expected);
}

#[test]
fn completions_are_printed_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = Folder::new().run(&["completions", shell]);
        assert_success(&output);
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(script.contains("export-area-page"), "{shell}");
    }
}

#[test]
fn an_opaque_background_makes_a_file_without_alpha_and_another_one_with() {
    let folder = Folder::with(SQUARE);
    for (colour, expected) in [("white", png::ColorType::Rgb), ("#ffffff80", png::ColorType::Rgba)] {
        assert_success(&folder.run(&["-b", colour, "in.svg", "out.png"]));
        let bytes = fs::read(folder.0.join("out.png")).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().color_type, expected, "{colour}");
    }
}

#[test]
fn every_effort_and_thread_count_gives_the_same_pixels() {
    let folder = Folder::with(SQUARE);
    let mut pixels = Vec::new();
    for flags in [&["-t", "1"][..], &["-t", "2"], &["--fast-png"], &["--small-png"]] {
        assert_success(&folder.run(&[flags, &["-w", "700", "in.svg", "out.png"]].concat()));
        let bytes = fs::read(folder.0.join("out.png")).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut data).unwrap();
        pixels.push(data);
    }
    assert!(pixels.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn selectors_that_would_be_tried_for_ever_are_refused_in_pictures_and_in_films() {
    let nested = |inside: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'>
            <style>x g g g g g g g g rect{{fill:red}}</style>{}<rect width='9' height='9'>{inside}</rect>{}</svg>",
            "<g>".repeat(60),
            "</g>".repeat(60)
        )
    };
    let still = Folder::with(&nested(""));
    assert_fails(&still.run(&["in.svg", "out.png"]), 3, "'x g g g g g g g g rect'");
    let film = Folder::with(&nested("<animate attributeName='x' to='9' dur='1s'/>"));
    let frames = film.run(&["--frames", "1-3", "--fps", "5", "in.svg", "-o", "shot.#.png"]);
    assert_fails(&frames, 3, "'x g g g g g g g g rect'");
    assert!(!film.0.join("shot.1.png").exists());
}
