//! Takes what a truth is made of, keeps the truth in a folder and finds it again.
//!
//! A truth's name is a hash of all that it depends on: the drawing as usvg understood it (so style
//! sheets, fonts and resolution count), its bytes, the viewport, the settings, and this program's
//! version. Promises: what is found is bit for bit what was kept; a file that is cut short, changed or
//! not ours is not found; a file is written beside its place and renamed when whole; a folder that
//! cannot be written costs time, never a result.

use crate::reference::{Options, Stroker, Truth};
use crate::Viewport;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use flate2::Compression;
use sha2::{Digest, Sha256};
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// First bytes of a file, unpacked; the number is that of this layout.
const MAGIC: &[u8; 16] = b"toon-raster tru3";

/// The folder is kept below this, the oldest files go first.
const MOST_BYTES: u64 = 1 << 30;

/// What a truth depends on, hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key([u8; 32]);

/// What of a drawing its truths depend on, hashed; the larger part of the work of a [`Key`].
#[derive(Clone, Copy, Debug)]
pub struct DrawingHash([u8; 32]);

impl DrawingHash {
    /// Of a drawing's bytes and what usvg made of them.
    pub fn of(bytes: &[u8], tree: &usvg::Tree) -> DrawingHash {
        let mut hash = Sha256::new();
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
        hash.update(tree.to_string(&usvg::WriteOptions::default()));
        DrawingHash(hash.finalize().into())
    }

    /// Of one truth of this drawing.
    pub fn key(&self, viewport: &Viewport, options: &Options) -> Key {
        let mut hash = Sha256::new();
        hash.update(MAGIC);
        hash.update(env!("CARGO_PKG_VERSION"));
        hash.update(self.0);
        hash.update(viewport.width.to_le_bytes());
        hash.update(viewport.height.to_le_bytes());
        for number in viewport.transform.as_coeffs().into_iter().chain([options.tolerance]) {
            hash.update(number.to_bits().to_le_bytes());
        }
        let Options { linear, background, stroker, .. } = options;
        hash.update([
            u8::from(*linear),
            u8::from(*stroker == Stroker::Pieces),
            u8::from(background.is_some()),
        ]);
        hash.update(background.unwrap_or_default());
        Key(hash.finalize().into())
    }
}

/// A folder of truths.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// In this folder, which need not exist yet.
    pub fn new(folder: impl Into<PathBuf>) -> Cache {
        Cache { folder: folder.into() }
    }

    /// Where the system wants such files, if it says so.
    pub fn of_the_user() -> Option<Cache> {
        use etcetera::BaseStrategy;
        let places = etcetera::choose_base_strategy().ok()?;
        Some(Cache::new(places.cache_dir().join("toon-raster").join("truths")))
    }

    /// The truth of this name and size, if it is here and whole.
    pub fn find(&self, key: Key, width: u32, height: u32) -> Option<Truth> {
        let file = fs::File::open(self.path(key)).ok()?;
        read(file, key, width, height).ok()
    }

    /// Keeps a truth; it is no loss if that fails.
    pub fn keep(&self, key: Key, truth: &Truth) {
        let path = self.path(key);
        let temporary = path.with_extension(format!("{}.tmp", std::process::id()));
        let written = fs::create_dir_all(&self.folder)
            .and_then(|()| write(fs::File::create(&temporary)?, key, truth))
            .and_then(|()| fs::rename(&temporary, &path));
        if written.is_err() {
            let _ = fs::remove_file(&temporary);
        }
        self.prune(&path);
    }

    fn path(&self, key: Key) -> PathBuf {
        let name: String = key.0.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        self.folder.join(name + ".truth")
    }

    /// Removes the oldest truths while there are too many bytes; `newest` stays.
    fn prune(&self, newest: &Path) {
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        let mut files: Vec<(SystemTime, u64, PathBuf)> = entries
            .filter_map(|entry| {
                let path = entry.ok()?.path();
                let metadata = path.metadata().ok()?;
                let ours = path.extension().is_some_and(|e| e == "truth");
                (ours && path != newest).then_some((metadata.modified().ok()?, metadata.len(), path))
            })
            .collect();
        files.sort();
        let mut bytes: u64 = files.iter().map(|(_, length, _)| length).sum();
        for (_, length, path) in files {
            if bytes <= MOST_BYTES {
                break;
            }
            let _ = fs::remove_file(path);
            bytes -= length;
        }
    }
}

fn write(file: fs::File, key: Key, truth: &Truth) -> io::Result<()> {
    let mut gz = GzEncoder::new(io::BufWriter::new(file), Compression::new(1));
    gz.write_all(MAGIC)?;
    gz.write_all(&key.0)?;
    for number in
        [u64::from(truth.width()), truth.height().into(), truth.swept as u64, truth.approximate as u64]
    {
        gz.write_all(&number.to_le_bytes())?;
    }
    gz.write_all(&truth.area_defect.to_le_bytes())?;
    // All reds, then all greens …: flat pictures pack better so.
    let mut plane = Vec::with_capacity(truth.premultiplied().len() * 8);
    for channel in 0..4 {
        plane.clear();
        plane.extend(truth.premultiplied().iter().flat_map(|pixel| pixel[channel].to_le_bytes()));
        gz.write_all(&plane)?;
    }
    gz.finish()?.into_inner()?.sync_all()
}

fn read(file: fs::File, key: Key, width: u32, height: u32) -> io::Result<Truth> {
    let mut gz = GzDecoder::new(io::BufReader::new(file));
    let mut bytes = |count: usize| -> io::Result<Vec<u8>> {
        let mut buffer = vec![0; count];
        gz.read_exact(&mut buffer)?;
        Ok(buffer)
    };
    let corrupt = || io::Error::from(io::ErrorKind::InvalidData);
    if bytes(MAGIC.len())? != MAGIC || bytes(key.0.len())? != key.0 {
        return Err(corrupt());
    }
    let mut number = || -> io::Result<u64> { Ok(u64::from_le_bytes(bytes(8)?.try_into().expect("8 bytes"))) };
    let [stored_width, stored_height, swept, approximate] = [number()?, number()?, number()?, number()?];
    let area_defect = f64::from_bits(number()?);
    if (stored_width, stored_height) != (width.into(), height.into()) {
        return Err(corrupt());
    }
    let count = width as usize * height as usize;
    let mut pixels = vec![[0.0; 4]; count];
    for channel in 0..4 {
        let plane = bytes(count * 8)?;
        for (pixel, level) in pixels.iter_mut().zip(plane.as_chunks().0) {
            pixel[channel] = f64::from_le_bytes(*level);
        }
    }
    // The checksum stands at the end, and nothing after it.
    if gz.read(&mut [0])? != 0 {
        return Err(corrupt());
    }
    let mut truth = Truth::from_pixels(width, height, pixels);
    (truth.swept, truth.approximate, truth.area_defect) = (swept as usize, approximate as usize, area_defect);
    Ok(truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that is gone at the end of its test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Folder {
            Folder(std::env::temp_dir().join(format!("toon-raster-cache-{}-{name}", std::process::id())))
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn truth() -> Truth {
        let mut truth =
            Truth::from_pixels(3, 2, (0..6).map(|i| [i as f64 / 7.0, 0.1, 254.9, 255.0]).collect());
        (truth.swept, truth.approximate, truth.area_defect) = (4, 1, 1e-13);
        truth
    }

    fn same(a: &Truth, b: &Truth) -> bool {
        a.premultiplied() == b.premultiplied()
            && (a.swept, a.approximate, a.area_defect) == (b.swept, b.approximate, b.area_defect)
    }

    #[test]
    fn what_was_kept_is_found_bit_for_bit() {
        let folder = Folder::new("found");
        let (cache, key) = (Cache::new(&folder.0), Key([7; 32]));
        assert!(cache.find(key, 3, 2).is_none());
        cache.keep(key, &truth());
        assert!(same(&cache.find(key, 3, 2).unwrap(), &truth()));
        assert!(cache.find(Key([8; 32]), 3, 2).is_none());
        assert!(cache.find(key, 2, 3).is_none(), "a picture of another size");
        assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1, "no file is left half written");
    }

    #[test]
    fn a_damaged_file_is_not_found_and_is_replaced() {
        let folder = Folder::new("damaged");
        let (cache, key) = (Cache::new(&folder.0), Key([7; 32]));
        cache.keep(key, &truth());
        let path = cache.path(key);
        let whole = fs::read(&path).unwrap();
        let turned = |at: usize| {
            let mut turned = whole.clone();
            turned[at] ^= 0x10;
            turned
        };
        // In the packed pixels, and in the checksum: its last byte is the fifth from the end.
        let (pixels, checksum) = (turned(whole.len() / 2), turned(whole.len() - 5));
        for damaged in [&whole[..whole.len() / 2], &whole[..0], b"what is this?", &pixels, &checksum] {
            fs::write(&path, damaged).unwrap();
            assert!(cache.find(key, 3, 2).is_none(), "{} bytes", damaged.len());
        }
        cache.keep(key, &truth());
        assert!(same(&cache.find(key, 3, 2).unwrap(), &truth()));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_no_error() {
        let folder = Folder::new("file");
        fs::write(&folder.0, "not a folder").unwrap();
        Cache::new(&folder.0).keep(Key([7; 32]), &truth());
        assert!(Cache::new(&folder.0).find(Key([7; 32]), 3, 2).is_none());
        fs::remove_file(&folder.0).unwrap();
    }

    #[test]
    fn a_truth_depends_on_the_drawing_its_place_and_its_settings() {
        let tree = |colour: &str| {
            let svg = format!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M0 0H9V9z" fill="{colour}"/></svg>"#
            );
            usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap()
        };
        let viewport = Viewport { width: 9, height: 9, transform: kurbo::Affine::IDENTITY };
        let moved = Viewport { transform: kurbo::Affine::translate((0.5, 0.0)), ..viewport };
        let options = Options::default();
        let coarse = Options { tolerance: 1e-3, ..Options::default() };
        let red = DrawingHash::of(b"a", &tree("red"));
        let key = red.key(&viewport, &options);
        assert_eq!(key, DrawingHash::of(b"a", &tree("red")).key(&viewport, &options));
        assert_ne!(key, DrawingHash::of(b"a", &tree("blue")).key(&viewport, &options));
        assert_ne!(key, red.key(&moved, &options));
        assert_ne!(key, red.key(&viewport, &coarse));
    }
}
