//! Takes a [`Source`], makes its bytes, of a bounded number.

use super::places::Source;
use super::report::Failure;
use std::io::{ErrorKind, Read};

/// Most bytes of a file as it lies on the disk, packed or not.
const MAX_BYTES: u64 = 256 << 20;

/// Reads the whole of it.
///
/// # Errors
/// When it is not there, cannot be read, or does not end.
pub fn read(source: &Source) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let read = match source {
        Source::Stdin => std::io::stdin().lock().take(MAX_BYTES + 1).read_to_end(&mut bytes),
        Source::File(path) => std::fs::File::open(path).and_then(|file| {
            if let Ok(length) = file.metadata().map(|m| m.len()) {
                bytes.reserve(length.min(MAX_BYTES) as usize + 1);
            }
            file.take(MAX_BYTES + 1).read_to_end(&mut bytes)
        }),
    };
    match read {
        Ok(_) if bytes.len() as u64 > MAX_BYTES => {
            Err(Failure::input(format!("longer than {} MiB", MAX_BYTES >> 20)))
        }
        Ok(_) => Ok(bytes),
        Err(e) if e.kind() == ErrorKind::NotFound => Err(Failure::input("no such file (check the path)")),
        Err(e) if e.kind() == ErrorKind::IsADirectory => {
            Err(Failure::input("a folder, not a file (name the files in it)"))
        }
        Err(e) => Err(Failure::io(format!("cannot be read: {e}"))),
    }
}
