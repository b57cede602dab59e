//! A folder of its own for each test, and the program run in it.

// Each test file uses its own part of this.
#![allow(dead_code)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// Removed at the end of the test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Folder {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let (process, number) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let binary = env!("CARGO_CRATE_NAME");
        let folder = std::env::temp_dir().join(format!("toon-raster-{binary}-{process}-{number}"));
        fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_toon-raster"));
        command.current_dir(&self.0).args(arguments).stdin(Stdio::null());
        command
    }

    /// The exit code and what was said on standard error.
    pub fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let output = self.command(arguments).output().unwrap();
        (output.status.code(), said(&output))
    }

    /// Runs it, and expects all to go well without a word.
    pub fn make(&self, arguments: &[&str]) -> Vec<u8> {
        let output = self.command(arguments).output().unwrap();
        assert_eq!((output.status.code(), said(&output).as_str()), (Some(0), ""), "{arguments:?}");
        output.stdout
    }

    /// Runs it, and expects this exit code and one line with these words.
    pub fn fail(&self, code: i32, words: &[&str], arguments: &[&str]) {
        let (found, said) = self.run(arguments);
        assert_eq!((found, said.lines().count()), (Some(code), 1), "{arguments:?}: {said}");
        for word in words {
            assert!(said.contains(word), "{arguments:?} says nothing of {word}: {said}");
        }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Names and bytes of the files in a folder, hidden ones too.
    pub fn files(&self, folder: &str) -> Vec<(String, Vec<u8>)> {
        let Ok(entries) = fs::read_dir(self.path(folder)) else { return Vec::new() };
        let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_string();
        // One may get its name meanwhile.
        let read = |path: PathBuf| Some((name(&path), fs::read(&path).ok()?));
        let mut files: Vec<_> = entries.filter_map(|entry| read(entry.unwrap().path())).collect();
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The file of a sample that moves.
pub fn sample(name: &str) -> String {
    format!("{}/samples/anim/{name}.svg", env!("CARGO_MANIFEST_DIR"))
}
