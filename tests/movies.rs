//! Films by ffmpeg, and pipes into it: as many frames as were given, of that size, in those colours. What
//! needs the real ffmpeg is skipped without one.

#[path = "support/folder.rs"]
mod folder;

use folder::{said, sample, Folder};
use image::AnimationDecoder;
use std::fs;
use std::io::{Cursor, Write};
use std::process::{Command, Stdio};

const WIDTH: usize = 100;
const FRAME: usize = WIDTH * WIDTH * 4;
/// Of `bounce`, which takes .8 s, at 20 frames a second.
const FRAMES: usize = 16;

fn has_ffmpeg() -> bool {
    let there = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).status().is_ok();
    if !there {
        println!("SKIPPED: ffmpeg is not installed");
    }
    there
}

/// Raw RGBA of our frames, or the file named by the arguments.
fn shoot(folder: &Folder, more: &[&str]) -> Vec<u8> {
    let input = sample("bounce");
    let width = WIDTH.to_string();
    folder.make(&[&[input.as_str(), "--fps", "20", "-w", &width], more].concat())
}

/// What ffmpeg makes of `stdin`, or of the files named by the arguments.
fn ffmpeg(folder: &Folder, stdin: &[u8], arguments: &str) -> Vec<u8> {
    let mut command = Command::new("ffmpeg");
    command.current_dir(&folder.0).args(["-v", "error"]).args(arguments.split(' '));
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    std::thread::scope(|scope| {
        scope.spawn(move || pipe.write_all(stdin));
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "ffmpeg {arguments}: {}", said(&output));
        output.stdout
    })
}

const TO_RGBA: &str =
    "-vf scale=flags=accurate_rnd+full_chroma_int+full_chroma_inp -f rawvideo -pix_fmt rgba pipe:1";

/// Fails unless both have the same frames: each pixel in the middle of 9 x 9 of one colour within
/// `levels`, and within 1.5 in the mean, what luma and chroma of 8 bits allow; and there are many of those.
fn assert_flat_colors_survive(ours: &[u8], theirs: &[u8], levels: u8) {
    assert_eq!((ours.len() / FRAME, theirs.len()), (FRAMES, ours.len()));
    let (mut flat, mut sum) = (0, 0);
    for (frame, decoded) in ours.chunks(FRAME).zip(theirs.chunks(FRAME)) {
        let pixel = |from: &[u8], x: usize, y: usize| -> [u8; 4] {
            from[(y * WIDTH + x) * 4..][..4].try_into().unwrap()
        };
        for (x, y) in (4..WIDTH - 4).flat_map(|x| (4..WIDTH - 4).map(move |y| (x, y))) {
            let color = pixel(frame, x, y);
            if (0..81).any(|i| pixel(frame, x + i % 9 - 4, y + i / 9 - 4) != color) {
                continue;
            }
            flat += 1;
            let seen = pixel(decoded, x, y);
            let off: u8 = color.iter().zip(seen).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            // What is behind full transparency is nobody's matter.
            let off = if color[3] == 0 { seen[3] } else { off };
            assert!(off <= levels, "{color:?} is {seen:?} at {x} {y}");
            sum += usize::from(off);
        }
    }
    assert!(flat > FRAMES * WIDTH * WIDTH / 2 && 2 * sum < 3 * flat, "{sum} in {flat} pixels");
}

#[test]
fn pipes_bring_ffmpeg_all_frames_in_their_colours() {
    if !has_ffmpeg() {
        return;
    }
    let folder = Folder::new();
    let raw = shoot(&folder, &["-", "--format", "rgba"]);
    let input = format!("-f rawvideo -pixel_format rgba -video_size {WIDTH}x{WIDTH} -framerate 20 -i pipe:0");
    ffmpeg(&folder, &raw, &format!("{input} -c:v ffv1 -pix_fmt bgra raw.mkv"));
    assert!(ffmpeg(&folder, &[], "-i raw.mkv -f rawvideo -pix_fmt rgba pipe:1") == raw);
    let raw = shoot(&folder, &["-", "--format", "rgba", "-b", "white"]);
    for yuv in ["444,601", "420,601"] {
        let y4m = shoot(&folder, &["-", "--format", "y4m", "-b", "white", "--yuv", yuv]);
        assert_flat_colors_survive(&raw, &ffmpeg(&folder, &y4m, &format!("-i pipe:0 {TO_RGBA}")), 2);
    }
}

#[test]
fn an_mp4_and_a_webm_have_all_frames_in_their_colours() {
    if !has_ffmpeg() {
        return;
    }
    let folder = Folder::new();
    let raw = shoot(&folder, &["-", "--format", "rgba", "-b", "#fed"]);
    for film in ["film.mp4", "film.webm"] {
        for yuv in [&[][..], &["--yuv", "444,709"], &["--yuv", "601"]] {
            shoot(&folder, &[&["-b", "#fed", "-o", film], yuv].concat());
            assert_flat_colors_survive(&raw, &ffmpeg(&folder, &[], &format!("-i {film} {TO_RGBA}")), 16);
        }
    }
    // Transparency stays where the format has it.
    shoot(&folder, &["-o", "clear.webm"]);
    let raw = shoot(&folder, &["-", "--format", "rgba"]);
    let decoded = ffmpeg(&folder, &[], &format!("-c:v libvpx-vp9 -i clear.webm {TO_RGBA}"));
    assert_flat_colors_survive(&raw, &decoded, 16);
    folder.fail(3, &["mp4", "--background"], &[&sample("bounce"), "clear.mp4"]);
    assert!(!folder.path("clear.mp4").exists());
}

#[test]
fn an_mp4_of_odd_size_is_padded_by_its_last_column_and_row() {
    if !has_ffmpeg() {
        return;
    }
    let folder = Folder::new();
    folder.make(&[&sample("bounce"), "film.mp4", "--fps", "20", "-b", "#fed", "-w", "99"]);
    let decoded = ffmpeg(&folder, &[], &format!("-i film.mp4 {TO_RGBA}"));
    assert_eq!(decoded.len(), FRAMES * FRAME);
    let pixel = |x: usize, y: usize| &decoded[(y * WIDTH + x) * 4..][..3];
    // The ground, which the drawing has to its right edge and its lower one.
    for (x, y) in [(99, 84), (50, 99)] {
        let off = pixel(x, y).iter().zip([0xe8, 0xb0, 0x4b]).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off <= Some(5), "{:?} at {x} {y}", pixel(x, y));
    }
}

#[test]
fn a_webp_is_the_frames_without_loss() {
    if !has_ffmpeg() {
        return;
    }
    let folder = Folder::new();
    let raw = shoot(&folder, &["-", "--format", "rgba", "-b", "white"]);
    shoot(&folder, &["-o", "film.webp", "--loop", "3", "-b", "white"]);
    let file = fs::read(folder.path("film.webp")).unwrap();
    let decoder = image::codecs::webp::WebPDecoder::new(Cursor::new(file)).unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), FRAMES);
    for (frame, ours) in frames.iter().zip(raw.chunks(FRAME)) {
        let off = frame.buffer().as_raw().iter().zip(ours).map(|(a, b)| a.abs_diff(*b)).max();
        // One level is the decoder's own, where a frame lies over the one before.
        assert!(off <= Some(1), "{off:?}");
    }
}

#[test]
fn without_ffmpeg_one_line_says_what_is_missing() {
    let folder = Folder::new();
    for film in ["film.mp4", "film.webm", "film.webp"] {
        let mut command = folder.command(&[&sample("bounce"), film, "-b", "white", "-w", "20"]);
        let output = command.env("PATH", &folder.0).output().unwrap();
        assert_eq!((output.status.code(), said(&output).lines().count()), (Some(1), 1), "{}", said(&output));
        assert!(said(&output).contains("ffmpeg") && said(&output).contains("install"), "{}", said(&output));
        folder.fail(2, &["is a file"], &[&sample("bounce"), "-", "--format", &film[5..], "-b", "white"]);
    }
    assert!(folder.files(".").is_empty());
}

#[cfg(unix)]
#[test]
fn what_ffmpeg_says_is_passed_on_in_one_line_and_nothing_is_left() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let tools = Folder::new();
    let script = tools.path("ffmpeg");
    let path = format!("{}:{}", tools.0.display(), std::env::var("PATH").unwrap());
    for (does, words) in [
        (
            "echo '[libx264 @ 0x55d0] [opts @ 0x55d0] no such preset' >&2; echo 'Conversion failed!' >&2; exit 1",
            "ffmpeg says: no such preset",
        ),
        (
            "cat >/dev/null; echo 'No space left on device' >&2; exit 228",
            "ffmpeg says: No space left on device",
        ),
        ("exit 7", "ffmpeg ended with exit status: 7"),
    ] {
        fs::write(&script, format!("#!/bin/sh\n{does}\n")).unwrap();
        fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
        let mut command = folder.command(&[&sample("bounce"), "film.mp4", "-b", "white", "-w", "300"]);
        let output = command.env("PATH", &path).output().unwrap();
        assert_eq!((output.status.code(), said(&output).lines().count()), (Some(1), 1), "{}", said(&output));
        assert!(said(&output).contains(words), "{}", said(&output));
        assert!(!said(&output).contains("0x55d0"));
        assert!(folder.files(".").is_empty());
    }
}
