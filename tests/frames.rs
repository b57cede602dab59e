//! Drives the program on sequences: every way to make the frames gives the same bytes, each format holds
//! the frames it was given, and what goes wrong with one frame stays with it.

#[path = "support/folder.rs"]
mod folder;

use folder::{said, sample, Folder};
use std::fs;
use std::process::Output;

/// With drawings of a square that moves, as `f.0001.svg` and so on.
fn with_frames(count: u32) -> Folder {
    let folder = Folder::new();
    for n in 1..=count {
        fs::write(folder.path(&format!("f.{n:04}.svg")), square(n)).unwrap();
    }
    folder
}

fn run(folder: &Folder, arguments: &[&str]) -> Output {
    folder.command(arguments).output().unwrap()
}

fn read(folder: &Folder, name: &str) -> Vec<u8> {
    fs::read(folder.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn square(n: u32) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20"><circle cx="{n}.5" cy="9" r="6" fill="#07c"/></svg>"##
    )
}

/// The frames of an animated PNG, as a viewer shows them, on its canvas.
fn apng_frames(file: &[u8]) -> Vec<Vec<u8>> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let count = reader.info().animation_control().unwrap().num_frames;
    let mut canvas = vec![0; width * height * 4];
    let frames = (0..count).map(|_| {
        let mut pixels = vec![0; width * height * 4];
        reader.next_frame(&mut pixels).unwrap();
        let area = reader.info().frame_control().unwrap();
        let (x, y, w) = (area.x_offset as usize, area.y_offset as usize, area.width as usize);
        for row in 0..area.height as usize {
            let at = ((y + row) * width + x) * 4;
            canvas[at..at + w * 4].copy_from_slice(&pixels[row * w * 4..(row + 1) * w * 4]);
        }
        canvas.clone()
    });
    frames.collect()
}

#[test]
fn a_sequence_is_its_frames_one_by_one_for_every_thread_count_and_chunking() {
    let folder = Folder::new();
    for drawing in ["bounce", "frames", "keyframes", "transforms"] {
        let input = sample(drawing);
        let to = |place: &str| format!("{drawing}-{place}/f.###.png");
        let common = ["--fps", "7", "--frames", "1-9", "-w", "60", &input, "-o"];
        let run = |more: &[&str], place: &str| {
            let place = to(place);
            let arguments: Vec<&str> = more.iter().copied().chain(common).chain([place.as_str()]).collect();
            folder.make(&arguments);
        };
        run(&["-t", "1"], "one");
        run(&["-t", "2"], "two");
        run(&["-t", "5"], "five");
        (1..=4).for_each(|i| run(&["--chunk", &format!("{i}/4"), "-t", "2"], "chunks"));
        let one = folder.files(&format!("{drawing}-one"));
        assert_eq!(one.len(), 9);
        for place in ["two", "five", "chunks"] {
            assert!(folder.files(&format!("{drawing}-{place}")) == one, "{drawing} {place}");
        }
        for n in 1..=9 {
            folder.make(&["--fps", "7", "--frames", &n.to_string(), "-w", "60", &input, "-o", &to("alone")]);
        }
        assert!(folder.files(&format!("{drawing}-alone")) == one, "{drawing} alone");
    }
}

#[test]
fn drawings_by_pattern_glob_or_folder_are_the_same_as_one_by_one() {
    let folder = with_frames(11);
    folder.make(&["f.####.svg", "-o", "pattern/f.####.png"]);
    folder.make(&["f.*.svg", "-o", "glob/f.####.png"]);
    folder.make(&[".", "-o", "folder/"]);
    (1..=11).for_each(|n| {
        let (input, output) = (format!("f.{n:04}.svg"), format!("alone/f.{n:04}.png"));
        fs::create_dir_all(folder.path("alone")).unwrap();
        folder.make(&[&input, &output]);
    });
    let alone = folder.files("alone");
    assert_eq!(alone.len(), 11);
    for place in ["pattern", "glob", "folder"] {
        assert!(folder.files(place) == alone, "{place}");
    }
    folder.make(&["f.%04d.svg", "-o", "some/f.####.png", "--frames", "2-11x4"]);
    let names: Vec<String> = folder.files("some").into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["f.0002.png", "f.0006.png", "f.0010.png"]);
}

#[test]
fn an_apng_and_raw_pixels_hold_the_same_frames() {
    let folder = Folder::new();
    let input = sample("bounce");
    folder.make(&[&input, "a.apng", "--fps", "10"]);
    let raw = folder.make(&[&input, "-", "--format", "rgba", "--fps", "10"]);
    let frames = apng_frames(&read(&folder, "a.apng"));
    assert_eq!(frames.len(), 8);
    assert!(frames.concat() == raw);
    assert!(frames[0] != frames[4]);
}

#[test]
fn a_gif_of_flat_art_keeps_its_colours_and_its_time() {
    let folder = Folder::new();
    folder.make(&[&sample("bounce"), "a.gif", "--fps", "30", "-b", "white", "--loop", "3"]);
    let file = read(&folder, "a.gif");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(file.as_slice()).unwrap();
    let mut delays = Vec::new();
    let mut first = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
        if first.is_empty() {
            first = frame.buffer.to_vec();
        }
    }
    assert_eq!((delays.len(), delays.iter().sum::<u16>()), (24, 80));
    for color in [[0xff, 0xf3, 0xd6, 255], [0xe8, 0xb0, 0x4b, 255], [0xd8, 0x43, 0x2f, 255], [255; 4]] {
        assert!(first.as_chunks::<4>().0.contains(&color), "{color:?}");
    }
}

#[test]
fn y4m_has_a_header_and_frames_of_the_right_length_and_asks_for_a_background() {
    let folder = Folder::new();
    let input = sample("bounce");
    let arguments = [&input, "-", "--format", "y4m", "--fps", "30000/1001", "-w", "33"];
    let output = run(&folder, &arguments);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("--background") && said(&output).lines().count() == 1);
    let more = ["-b", "white", "--yuv", "420,709"];
    let stream = folder.make(&[arguments.as_slice(), &more].concat());
    let head = b"YUV4MPEG2 W33 H33 F30000:1001 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
    assert!(stream.starts_with(head));
    assert_eq!(stream.len() - head.len(), 24 * (b"FRAME\n".len() + 33 * 33 + 2 * 17 * 17));
}

#[test]
fn a_sprite_sheet_has_its_json() {
    let folder = Folder::new();
    folder.make(&[&sample("frames"), "s.png", "--sheet", "3x", "--fps", "4", "-w", "20"]);
    let json: serde_json::Value = serde_json::from_slice(&read(&folder, "s.json")).unwrap();
    assert_eq!(json["frames"].as_array().unwrap().len(), 4);
    assert_eq!((&json["frames"][3]["frame"]["x"], &json["frames"][3]["frame"]["y"]), (&0.into(), &20.into()));
    assert_eq!((&json["meta"]["size"]["w"], &json["meta"]["size"]["h"]), (&60.into(), &40.into()));
    let reader = png::Decoder::new(std::io::Cursor::new(read(&folder, "s.png"))).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (60, 40));
}

#[test]
fn one_broken_frame_is_one_line_and_the_others_are_made() {
    let folder = with_frames(5);
    fs::write(folder.path("f.0003.svg"), "<svg").unwrap();
    let output = run(&folder, &["f.####.svg", "-o", "out/f.####.png"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(said(&output).lines().count(), 1, "{}", said(&output));
    assert!(said(&output).contains("f.0003.svg"));
    assert_eq!(folder.files("out").len(), 4);
    // In one file the frame before stands for it, so that the rest keeps its time.
    let output = run(&folder, &["f.####.svg", "out.apng"]);
    assert_eq!(output.status.code(), Some(1));
    let frames = apng_frames(&read(&folder, "out.apng"));
    assert_eq!(frames.len(), 5);
    assert!(frames[2] == frames[1] && frames[3] != frames[1]);
}

#[test]
fn frames_that_are_there_are_left_and_the_rest_is_completed() {
    let folder = Folder::new();
    let input = sample("bounce");
    let arguments = [&input, "-o", "f.##.png", "--fps", "10", "-w", "30", "--skip-existing"];
    folder.make(&arguments);
    let whole = folder.files(".");
    fs::remove_file(folder.path("f.03.png")).unwrap();
    fs::write(folder.path("f.05.png"), "kept").unwrap();
    folder.make(&arguments);
    for ((name, before), (_, after)) in whole.iter().zip(folder.files(".")) {
        assert!(if name == "f.05.png" { after == b"kept" } else { after == *before }, "{name}");
    }
}

#[test]
fn frames_of_two_sizes_are_no_movie() {
    let folder = with_frames(2);
    fs::write(folder.path("f.0003.svg"), square(3).replace("\"40\"", "\"41\"")).unwrap();
    let output = run(&folder, &["f.####.svg", "out.gif"]);
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("41 x 20") && said(&output).lines().count() == 1, "{}", said(&output));
    assert!(!folder.path("out.gif").exists());
}

#[test]
fn motion_blur_leaves_what_rests_and_spreads_what_moves() {
    let folder = Folder::new();
    let still = r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20"><rect width="9" height="9" fill="#123"/><circle cy="15" r="2"><animate attributeName="cx" from="2" to="38" dur="1s"/></circle></svg>"##;
    fs::write(folder.path("a.svg"), still).unwrap();
    let raw = |more: &[&str]| {
        folder.make(&[&["a.svg", "-", "--format", "rgba", "--fps", "4", "--frames", "2"], more].concat())
    };
    let (sharp, blurred) = (raw(&[]), raw(&["--shutter", "180", "--shutter-samples", "8"]));
    let row = |y: usize| y * 40 * 4..(y + 1) * 40 * 4;
    assert!(sharp[row(4)] == blurred[row(4)]);
    let seen = |pixels: &[u8]| pixels[row(15)].chunks(4).filter(|pixel| pixel[3] > 0).count();
    assert!(seen(&blurred) > seen(&sharp) + 2);
}

#[test]
fn what_is_not_animated_is_named_in_one_line() {
    let folder = Folder::new();
    let output = run(&folder, &[&sample("sync"), "-o", "f.#.png", "--fps", "2", "-w", "20"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(said(&output).contains("not animated: begin=\"f-rect.click\""), "{}", said(&output));
    assert_eq!(said(&output).lines().count(), 1);
}

#[test]
fn too_many_frames_are_refused_with_the_flag_that_allows_them() {
    let folder = Folder::new();
    for more in [&["--frames", "1-1000000"][..], &["--fps", "1000", "--max-frames", "20"]] {
        let output = run(&folder, &[&[sample("bounce").as_str(), "-o", "f.#.png"], more].concat());
        assert_eq!(output.status.code(), Some(3));
        assert!(said(&output).contains("--max-frames"), "{}", said(&output));
    }
}

#[test]
fn a_drawing_that_holds_still_is_painted_once() {
    let folder = Folder::new();
    let output = run(&folder, &["--perf=json", &sample("frames"), "a.gif", "--fps", "48", "-t", "2"]);
    let perf: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    // Each quarter of the second is one picture.
    assert_eq!((&perf["frames"], &perf["painted"]), (&48.into(), &4.into()));
}

#[test]
fn one_frame_goes_where_one_picture_goes() {
    let folder = Folder::new();
    let input = sample("bounce");
    let common = ["--fps", "10", "--frames", "4", "-w", "50", input.as_str()];
    folder.make(&[common.as_slice(), &["-o", "f.#.png"]].concat());
    folder.make(&[common.as_slice(), &["alone.png"]].concat());
    let piped = folder.make(&[common.as_slice(), &["-"]].concat());
    assert!(read(&folder, "f.4.png") == piped && read(&folder, "alone.png") == piped);
}

#[test]
fn a_million_frames_are_listed_but_not_kept() {
    let folder = Folder::new();
    let arguments = ["--frames", "1-1000000", "--max-frames", "1000000", "--chunk", "99999/100000"];
    folder.make(&[arguments.as_slice(), &[&sample("frames"), "-o", "f.#######.png", "-w", "9"]].concat());
    assert_eq!(folder.files(".").len(), 10);
}

#[test]
fn progress_speaks_open_job_description() {
    let folder = with_frames(4);
    let output = run(&folder, &["f.####.svg", "-o", "o.#.png", "--progress", "openjd"]);
    assert!(said(&output).starts_with("openjd_progress: 25.0\nopenjd_status: 1 of 4\n"), "{}", said(&output));
    assert!(said(&output).contains("openjd_progress: 100.0\n"));
}
