//! Ends the program at all moments of a sequence, then runs it again: no file is ever half, none is
//! lost, and nothing unfinished stays.
#![cfg(unix)]

#[path = "support/folder.rs"]
mod folder;

use folder::{sample, Folder};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

const SIGINT: i32 = 2;
const SIGKILL: i32 = 9;
const SIGTERM: i32 = 15;

fn end(child: &mut Child, signal: i32) -> ExitStatus {
    let id = child.id().to_string();
    // A child that is over is still ours until we have waited for it.
    assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
    child.wait().unwrap()
}

fn is_hidden(file: &(String, Vec<u8>)) -> bool {
    file.0.starts_with('.')
}

#[test]
fn a_sequence_killed_at_any_moment_is_completed_to_the_same_bytes() {
    let folder = Folder::new();
    let input = sample("bounce");
    let common = ["--fps", "60", "-w", "200", input.as_str(), "--skip-existing", "-o"];
    folder.make(&[common.as_slice(), &["whole/f.##.png"]].concat());
    let whole = folder.files("whole");
    assert_eq!(whole.len(), 48);
    let arguments = [common.as_slice(), &["killed/f.##.png"]].concat();
    for signal in [SIGTERM, SIGKILL, SIGINT] {
        let mut killed = 0;
        // Moments of a run: before, at the first frames, in the middle.
        for frames in [0, 1, 2, 5, 11, 23, 37] {
            let mut child = folder.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
            let started = Instant::now();
            while folder.files("killed").iter().filter(|f| !is_hidden(f)).count() < frames {
                assert!(started.elapsed() < Duration::from_secs(60));
            }
            let status = end(&mut child, signal);
            killed += usize::from(status.signal() == Some(signal));
            assert!(status.signal() == Some(signal) || status.success(), "{status}");
            for file in folder.files("killed") {
                match is_hidden(&file) {
                    true => assert_eq!(signal, SIGKILL, "{} is left", file.0),
                    false => assert!(whole.contains(&file), "{} is not whole", file.0),
                }
            }
            folder.make(&arguments);
            assert!(folder.files("killed") == whole, "signal {signal} at {frames} frames");
            fs::remove_dir_all(folder.path("killed")).unwrap();
        }
        assert!(killed > 0, "signal {signal} always came too late");
    }
}

/// A child that is writing its file: hidden, and not yet whole.
fn writing(folder: &Folder, arguments: &[&str]) -> Child {
    let child = folder.command(arguments).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    while !folder.files(".").iter().any(is_hidden) {
        assert!(started.elapsed() < Duration::from_secs(60));
    }
    child
}

#[test]
fn a_film_that_is_ended_leaves_nothing_and_what_it_was_to_replace() {
    let folder = Folder::new();
    fs::write(folder.path("film.apng"), "an older film").unwrap();
    let input = sample("bounce");
    let arguments = ["--fps", "60", "-w", "400", &input, "film.apng"];
    for signal in [SIGTERM, SIGINT] {
        assert_eq!(end(&mut writing(&folder, &arguments), signal).signal(), Some(signal));
        assert!(folder.files(".") == [("film.apng".to_string(), b"an older film".to_vec())]);
    }
    // Nothing of ours runs when SIGKILL ends it: the next run clears up.
    assert_eq!(end(&mut writing(&folder, &arguments), SIGKILL).signal(), Some(SIGKILL));
    assert_eq!(folder.files(".").len(), 2);
    folder.make(&[arguments.as_slice(), &["--skip-existing"]].concat());
    assert!(folder.files(".") == [("film.apng".to_string(), b"an older film".to_vec())]);
    assert_eq!(end(&mut writing(&folder, &arguments), SIGKILL).signal(), Some(SIGKILL));
    folder.make(&arguments);
    assert_eq!(folder.files(".").len(), 1);
    assert!(folder.files(".")[0].1.starts_with(b"\x89PNG"));
}

#[test]
fn two_runs_at_once_on_one_place_do_not_disturb_each_other() {
    let folder = Folder::new();
    let input = sample("bounce");
    let arguments = ["--fps", "30", "-w", "100", &input, "-o", "f.##.png"];
    let mut children: Vec<Child> = (0..3).map(|_| folder.command(&arguments).spawn().unwrap()).collect();
    assert!(children.iter_mut().all(|child| child.wait().unwrap().success()));
    let together = folder.files(".");
    folder.make(&arguments);
    assert_eq!(together.len(), 24);
    assert!(folder.files(".") == together);
}
