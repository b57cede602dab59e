//! Takes encoded bytes, makes a whole file or none: they are written under another name in the same
//! folder, and the file gets its name by [`Output::commit`]. Without that it is removed.
//!
//! Standard output and devices are written to as the bytes come.

use super::places::Target;
use super::report::Failure;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// An output being written.
pub struct Output {
    writer: BufWriter<Box<dyn Write + Send>>,
    unfinished: Option<Unfinished>,
    name: String,
}

struct Unfinished {
    temporary: PathBuf,
    place: PathBuf,
}

impl Output {
    /// Begins.
    ///
    /// # Errors
    /// When nothing can be written there.
    pub fn create(target: &Target) -> Result<Output, Failure> {
        let name = target.name();
        let opened = match target {
            Target::Stdout => Ok((Box::new(io::stdout()) as Box<dyn Write + Send>, None)),
            Target::File(path) => open(path),
        };
        let (writer, unfinished) =
            opened.map_err(|e| Failure::io(format!("{name} cannot be written: {}", explain(&e))))?;
        Ok(Output { writer: BufWriter::with_capacity(1 << 16, writer), unfinished, name })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// When the last bytes cannot be written, or the name cannot be given.
    pub fn commit(mut self) -> Result<(), Failure> {
        self.writer.flush().map_err(|e| self.failure(&e))?;
        if let Some(Unfinished { temporary, place }) = &self.unfinished {
            fs::rename(temporary, place).map_err(|e| self.failure(&e))?;
        }
        self.unfinished = None;
        Ok(())
    }

    /// What to say if a write failed.
    pub fn failure(&self, error: &io::Error) -> Failure {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure::ClosedPipe;
        }
        Failure::io(format!("{} cannot be written: {}", self.name, explain(error)))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let Some(unfinished) = &self.unfinished {
            // Nothing more can be done if even this fails.
            let _ = fs::remove_file(&unfinished.temporary);
        }
    }
}

fn open(path: &Path) -> io::Result<(Box<dyn Write + Send>, Option<Unfinished>)> {
    // A link keeps pointing where it points: the file behind it is replaced.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let there = fs::metadata(&place).ok();
    if there.as_ref().is_some_and(|m| m.is_dir()) {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if there.as_ref().is_some_and(|m| !m.is_file()) {
        return Ok((Box::new(OpenOptions::new().write(true).open(&place)?), None));
    }
    if there.as_ref().is_some_and(|m| m.permissions().readonly()) {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    let (file, temporary) = create_beside(&place)?;
    if let Some(there) = there {
        // Permissions are a courtesy: a file system without them still gets the picture.
        let _ = fs::set_permissions(&temporary, there.permissions());
    }
    Ok((Box::new(file), Some(Unfinished { temporary, place })))
}

fn create_beside(place: &Path) -> io::Result<(File, PathBuf)> {
    let name = place.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_string_lossy().into_owned();
    // File systems allow some 255 bytes.
    let name: String = name.chars().take(40).collect();
    for attempt in 0.. {
        let temporary = place.with_file_name(format!(".{name}.{}-{attempt}.tmp", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((file, temporary)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => continue,
            Err(e) => return Err(e),
        }
    }
    unreachable!("the loop ends by returning")
}

fn explain(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "its folder does not exist (make it first)".to_string(),
        io::ErrorKind::PermissionDenied => "permission denied".to_string(),
        io::ErrorKind::IsADirectory => "a folder is there".to_string(),
        io::ErrorKind::StorageFull => "no space left (free some, or write elsewhere)".to_string(),
        _ => error.to_string(),
    }
}
