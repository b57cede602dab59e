//! Takes encoded bytes, makes a whole file or none: they are written under another name in the same
//! folder, and the file gets its name by [`Output::commit`]. Without that it is removed.
//!
//! Standard output and devices are written to as the bytes come.

use super::places::Target;
use super::report::Failure;
use super::temporary::Temporary;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

/// An output being written.
pub struct Output {
    // Removed, if it comes to that, before the writer lifts its lock.
    unfinished: Option<Temporary>,
    writer: BufWriter<Box<dyn Write + Send>>,
    name: String,
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
        let (writer, unfinished) = opened.map_err(|e| failure(&name, &e))?;
        Ok(Output { writer: BufWriter::with_capacity(1 << 16, writer), unfinished, name })
    }

    /// The file that is to get the name, for another program to write over; `None` if it is no file.
    pub fn hand_over(&mut self) -> Option<&Path> {
        // There a lock keeps others from writing.
        if cfg!(windows) && self.unfinished.is_some() {
            self.writer = BufWriter::new(Box::new(io::sink()));
        }
        self.unfinished.as_ref().map(Temporary::path)
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// When the last bytes cannot be written, or the name cannot be given.
    pub fn commit(mut self) -> Result<(), Failure> {
        self.writer.flush().map_err(|e| self.failure(&e))?;
        match self.unfinished.take() {
            Some(temporary) => temporary.take_place().map_err(|e| self.failure(&e)),
            None => Ok(()),
        }
    }

    /// What to say if a write failed.
    pub fn failure(&self, error: &io::Error) -> Failure {
        failure(&self.name, error)
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

fn open(path: &Path) -> io::Result<(Box<dyn Write + Send>, Option<Temporary>)> {
    // A link keeps pointing where it points: the file behind it is replaced.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let there = fs::metadata(&place).ok();
    if there.as_ref().is_some_and(|m| m.is_dir()) {
        return Err(ErrorKind::IsADirectory.into());
    }
    if there.as_ref().is_some_and(|m| !m.is_file()) {
        return Ok((Box::new(OpenOptions::new().write(true).open(&place)?), None));
    }
    if there.as_ref().is_some_and(|m| m.permissions().readonly()) {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "the file there is write-protected"));
    }
    let (temporary, file) = Temporary::create(&place)?;
    if let Some(there) = there {
        // Permissions are a courtesy: a file system without them still gets the picture.
        let _ = fs::set_permissions(temporary.path(), there.permissions());
    }
    Ok((Box::new(file), Some(temporary)))
}

fn failure(name: &str, error: &io::Error) -> Failure {
    let why = match error.kind() {
        ErrorKind::BrokenPipe => return Failure::ClosedPipe,
        ErrorKind::NotFound => "its folder does not exist (make it first)".to_string(),
        ErrorKind::PermissionDenied if error.get_ref().is_none() => {
            "permission denied (choose a folder that you may write to)".to_string()
        }
        ErrorKind::IsADirectory => "a folder is there".to_string(),
        ErrorKind::StorageFull => "no space left (free some, or write elsewhere)".to_string(),
        _ => error.to_string(),
    };
    let message = format!("{name} cannot be written: {why}");
    match error.kind() {
        // What is wrong with the place, not with this file.
        ErrorKind::NotFound
        | ErrorKind::StorageFull
        | ErrorKind::QuotaExceeded
        | ErrorKind::ReadOnlyFilesystem => Failure::Place(message),
        ErrorKind::PermissionDenied if error.get_ref().is_none() => Failure::Place(message),
        _ => Failure::Io(message),
    }
}
