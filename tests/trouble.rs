//! What goes wrong with a sequence through no fault of the drawing: disks, folders, pipes, numbers. One
//! line each, the right exit code, nothing lost and nothing half.
#![cfg(unix)]

#[path = "support/folder.rs"]
mod folder;

use folder::{said, sample, Folder};
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

#[test]
fn wrong_numbers_are_a_wrong_command_line() {
    let folder = Folder::new();
    let input = sample("bounce");
    for (wrong, words) in [
        ("--fps=0", "above 0"),
        ("--fps=-24", "above 0"),
        ("--fps=1/0", "above 0"),
        ("--frames=10-1", "1-10"),
        ("--frames=", "frame numbers"),
        ("--frames=5-", "frame numbers"),
        ("--frames=1-9x0", "frame numbers"),
        ("--chunk=0/3", "1/N"),
        ("--chunk=4/3", "1/N"),
        ("--shutter=0", "above 0"),
        ("--sheet=0x", "columns"),
    ] {
        folder.fail(2, &[words, wrong.split('=').next().unwrap()], &[&input, "-o", "f.##.png", wrong]);
    }
    assert!(folder.files(".").is_empty());
}

#[test]
fn frames_that_do_not_exist_and_too_many_cannot_be_rendered() {
    let folder = Folder::new();
    let input = sample("bounce");
    let fail = |words: &[&str], more: &[&str]| {
        folder.fail(3, words, &[&[input.as_str(), "-o", "f.##.png"], more].concat());
    };
    fail(&["frame 0", "--start-number"], &["--frames", "0-3"]);
    fail(&["--max-frames"], &["--frames", "1-1000000"]);
    fs::write(folder.path("f.01.svg"), "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>")
        .unwrap();
    folder.fail(3, &["--frames"], &["f.##.svg", "-o", "g.##.png", "--frames", "7-9"]);
    assert_eq!(folder.files(".").len(), 1);
}

#[test]
fn a_place_that_takes_nothing_ends_the_sequence_in_one_line() {
    let folder = Folder::new();
    let input = sample("bounce");
    fs::write(folder.path("file"), "no folder").unwrap();
    for to in ["file/f.##.png", "file/"] {
        folder.fail(1, &["file", "cannot be made"], &[&input, "--fps", "24", "-o", to]);
    }
    folder.fail(1, &["its folder does not exist"], &[&input, "nowhere/film.gif"]);
    if Path::new("/proc/self").exists() {
        // Not even root can write there.
        folder.fail(
            1,
            &["/proc/f.01.png cannot be written"],
            &[&input, "--fps", "24", "-o", "/proc/f.##.png"],
        );
    }
    if Path::new("/dev/full").exists() {
        folder.fail(1, &["no space left"], &[&input, "--format", "rgba", "--fps", "24", "-o", "/dev/full"]);
    }
    let closed = folder.path("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, std::os::unix::fs::PermissionsExt::from_mode(0o555)).unwrap();
    match fs::write(closed.join("probe"), "") {
        Err(_) => folder.fail(1, &["permission denied"], &[&input, "--fps", "24", "-o", "closed/f.##.png"]),
        Ok(()) => println!("SKIPPED a folder without permission: this user may write anywhere"),
    }
}

/// A file system of 64 KiB in a folder, unmounted at the end.
struct SmallDisk<'f>(&'f Folder);

impl SmallDisk<'_> {
    fn mount(folder: &Folder) -> Option<SmallDisk<'_>> {
        fs::create_dir(folder.path("disk")).unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"]).arg(folder.path("disk")).stderr(Stdio::null());
        mount.status().is_ok_and(|status| status.success()).then_some(SmallDisk(folder))
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path("disk")).status();
    }
}

#[test]
fn a_full_disk_ends_the_sequence_in_one_line_and_what_is_there_is_whole() {
    let folder = Folder::new();
    let Some(_disk) = SmallDisk::mount(&folder) else {
        println!("SKIPPED: only root can mount a small disk, where it is allowed");
        return;
    };
    let input = sample("bounce");
    let common = [input.as_str(), "--fps", "30", "-w", "200", "-o"];
    folder.make(&[common.as_slice(), &["whole/f.##.png"]].concat());
    let whole = folder.files("whole");
    folder.fail(1, &["no space left", "disk/f."], &[common.as_slice(), &["disk/f.##.png"]].concat());
    let some = folder.files("disk");
    assert!((1..whole.len()).contains(&some.len()), "{}", some.len());
    assert!(some.iter().all(|file| whole.contains(file)));
    // With room again, the rest comes.
    let remount = Command::new("mount").args(["-o", "remount,size=4m"]).arg(folder.path("disk")).status();
    assert!(remount.unwrap().success());
    folder.make(&[common.as_slice(), &["disk/f.##.png", "--skip-existing"]].concat());
    assert!(folder.files("disk") == whole);
}

#[test]
fn a_film_cut_short_by_the_system_leaves_nothing() {
    let folder = Folder::new();
    let input = sample("bounce");
    // Blocks of 512 bytes; past them writing fails.
    let limited = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    for film in ["film.apng", "film.gif", "sheet.png"] {
        let output = Command::new("sh")
            .args([
                "-c",
                limited,
                env!("CARGO_BIN_EXE_toon-raster"),
                &input,
                film,
                "--fps",
                "24",
                "-w",
                "300",
            ])
            .args((film == "sheet.png").then_some("--sheet=4x"))
            .current_dir(&folder.0)
            .output()
            .unwrap();
        assert_eq!((output.status.code(), said(&output).lines().count()), (Some(1), 1), "{}", said(&output));
        assert!(said(&output).contains(&format!("{film} cannot be written")), "{}", said(&output));
        assert!(folder.files(".").is_empty(), "{film}");
    }
}

#[test]
fn a_reader_that_leaves_ends_it_without_a_word() {
    let folder = Folder::new();
    let input = sample("bounce");
    let arguments = [&input, "-", "--format", "y4m", "-b", "white", "--fps", "1000", "-w", "400"];
    let mut command = folder.command(&arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut head = [0; 10];
    child.stdout.take().unwrap().read_exact(&mut head).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!((&head, output.status.code(), said(&output).as_str()), (b"YUV4MPEG2 ", Some(0), ""));
}

#[test]
fn a_frame_that_breaks_does_not_take_its_older_picture_along() {
    let folder = Folder::new();
    let square = |x| {
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><rect x='{x}' width='4' height='9'/></svg>")
    };
    (1..=4).for_each(|n| fs::write(folder.path(&format!("f.{n}.svg")), square(n)).unwrap());
    let arguments = ["f.%d.svg", "-o", "out/f.%d.png"];
    folder.make(&arguments);
    let before = folder.files("out");
    fs::write(folder.path("f.2.svg"), "<svg").unwrap();
    fs::write(folder.path("f.3.svg"), square(5)).unwrap();
    folder.fail(1, &["f.2.svg"], &arguments);
    let same: Vec<bool> = before.iter().zip(folder.files("out")).map(|(a, b)| *a == b).collect();
    assert_eq!(same, [true, true, false, true]);
}
