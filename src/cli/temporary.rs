//! Takes the place of a file to be, makes a hidden file beside it, which takes that name once it is whole.
//!
//! Promises: a file under its final name is whole. Whoever ends the program by Ctrl-C or SIGTERM leaves
//! no hidden file; one left by SIGKILL is removed by the next who writes to the same place. A lock tells
//! whose writer is alive: the system lifts it when the process ends, however it does.

use same_file::Handle;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Bytes of a target's name in its hidden file's: file systems allow some 255.
const NAME: usize = 180;
/// Files beside one place that are tried: two processes that write to the same are rare, more an error.
const ATTEMPTS: u32 = 100;

/// Hidden files of this process.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A hidden file; removed unless it takes its place.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    place: PathBuf,
    /// Until it has its name.
    hidden: bool,
}

impl Temporary {
    /// Begins one for `place`. The file is to stay open until [`Temporary::take_place`]: it bears the lock.
    ///
    /// # Errors
    /// When nothing can be written there.
    pub fn create(place: &Path) -> io::Result<(Temporary, File)> {
        #[cfg(unix)]
        signals::remove_all_on_signals();
        for attempt in 0..ATTEMPTS {
            let path = hidden(place, attempt)?;
            remove_abandoned(&path);
            let mut live = live();
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                // Between being made and locked it may have passed for an abandoned one.
                Ok(file) if is_ours(&file) && is_at(&file, &path) => {
                    live.insert(path.clone());
                    return Ok((Temporary { path, place: place.to_path_buf(), hidden: true }, file));
                }
                Ok(_) => continue,
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(e) => return Err(e),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Where it is meanwhile.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// When the name cannot be given: the file is then removed.
    pub fn take_place(mut self) -> io::Result<()> {
        let mut live = live();
        fs::rename(&self.path, &self.place)?;
        live.remove(&self.path);
        self.hidden = false;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if self.hidden {
            // Nothing more can be done if even this fails.
            let _ = fs::remove_file(&self.path);
            live().remove(&self.path);
        }
    }
}

/// Removes what a process that was killed left beside a place.
pub fn clear(place: &Path) {
    if let Ok(path) = hidden(place, 0) {
        remove_abandoned(&path);
    }
}

fn live() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The name of a place's hidden file: the same every time, so that it is found again; others only while
/// the first is in use.
fn hidden(place: &Path, attempt: u32) -> io::Result<PathBuf> {
    let name = place.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_string_lossy().into_owned();
    // Numbers are at the end.
    let from = (0..name.len()).find(|&at| name.is_char_boundary(at) && name.len() - at <= NAME);
    let name = &name[from.unwrap_or(0)..];
    Ok(place.with_file_name(match attempt {
        0 => format!(".{name}.toon-raster"),
        _ => format!(".{name}.{}-{attempt}.toon-raster", std::process::id()),
    }))
}

/// Locks a new file; where the file system knows no locks, it is taken as it is.
fn is_ours(file: &File) -> bool {
    !matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

/// Removes a hidden file unless its writer is alive.
fn remove_abandoned(path: &Path) {
    if let Ok(file) = OpenOptions::new().write(true).open(path) {
        remove_if_abandoned(path, &file);
    }
}

/// The same, of a file that was found there: meanwhile it may have taken its place, and another writer's
/// may have its hidden name.
fn remove_if_abandoned(path: &Path, file: &File) {
    if file.try_lock().is_ok() && is_at(file, path) {
        let _ = fs::remove_file(path);
    }
}

/// Whether a path still leads to an open file.
fn is_at(file: &File, path: &Path) -> bool {
    let open = file.try_clone().and_then(Handle::from_file);
    open.is_ok_and(|open| Handle::from_path(path).is_ok_and(|there| open == there))
}

#[cfg(unix)]
mod signals {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use std::sync::Once;

    /// Waits for Ctrl-C and SIGTERM on a thread of its own; they then end the program as ever.
    pub fn remove_all_on_signals() {
        static STARTED: Once = Once::new();
        STARTED.call_once(|| {
            let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
            let wait = move || {
                if let Some(signal) = signals.forever().next() {
                    // Held to the end: no file is begun or named any more.
                    let live = super::live();
                    live.iter().for_each(|path| drop(std::fs::remove_file(path)));
                    if std::process::id() == 1 {
                        // The first process of a container takes no signal by default.
                        std::process::exit(128 + signal);
                    }
                    let _ = signal_hook::low_level::emulate_default_handler(signal);
                }
            };
            // Without a thread, signals would be swallowed.
            if let Err(e) = std::thread::Builder::new().spawn(wait) {
                crate::cli::report::line(&format!("Ctrl-C is not heard: {e}"));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// A place in a folder of its own.
    fn place(test: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("toon-raster-temporary-{}-{test}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder.join("a.png")
    }

    fn beside(place: &Path) -> usize {
        fs::read_dir(place.parent().unwrap()).unwrap().count()
    }

    #[test]
    fn a_file_gets_its_name_or_is_removed() {
        let place = place("named");
        drop(Temporary::create(&place).unwrap());
        assert_eq!(beside(&place), 0);
        let (temporary, mut file) = Temporary::create(&place).unwrap();
        file.write_all(b"whole").unwrap();
        assert!(!place.exists());
        temporary.take_place().unwrap();
        assert_eq!((fs::read(&place).unwrap(), beside(&place)), (b"whole".to_vec(), 1));
        fs::remove_dir_all(place.parent().unwrap()).unwrap();
    }

    #[test]
    fn what_a_dead_writer_left_is_removed_and_what_a_living_one_writes_is_not() {
        let place = place("abandoned");
        let left = hidden(&place, 0).unwrap();
        fs::write(&left, "left").unwrap();
        clear(&place);
        assert!(!left.exists());
        fs::write(&left, "left").unwrap();
        let (mine, mut file) = Temporary::create(&place).unwrap();
        assert_eq!((mine.path(), beside(&place)), (left.as_path(), 1));
        file.write_all(b"mine").unwrap();
        clear(&place);
        let (other, _its_file) = Temporary::create(&place).unwrap();
        assert!(other.path() != mine.path());
        drop(other);
        mine.take_place().unwrap();
        assert_eq!(fs::read(&place).unwrap(), b"mine");
        fs::remove_dir_all(place.parent().unwrap()).unwrap();
    }

    #[test]
    fn whoever_found_a_file_that_has_its_name_by_now_leaves_the_next_writers_alone() {
        let place = place("found");
        let (first, first_file) = Temporary::create(&place).unwrap();
        let found = OpenOptions::new().write(true).open(first.path()).unwrap();
        first.take_place().unwrap();
        drop(first_file);
        let (second, _second_file) = Temporary::create(&place).unwrap();
        remove_if_abandoned(second.path(), &found);
        second.take_place().unwrap();
        fs::remove_dir_all(place.parent().unwrap()).unwrap();
    }

    #[test]
    fn long_names_keep_their_end() {
        let name = format!("{}é0007.png", "a".repeat(240));
        let short = hidden(Path::new(&name), 0).unwrap();
        let short = short.to_str().unwrap();
        assert!(short.len() < 220 && short.ends_with("é0007.png.toon-raster"), "{short}");
    }
}
