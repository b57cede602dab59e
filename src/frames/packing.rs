//! Takes canvases, writes PNGs: parts of a picture that another frame showed at the same place are not packed again.
//!
//! Promises: the bytes that [`PngWriter`](crate::encode::PngWriter) makes of the picture; bounded memory.

use super::shelf::Shelf;
use crate::encode::packed::{Packed, Packer};
use crate::encode::png::PartWriter;
use crate::encode::Effort;
use crate::render::Canvas;
use crate::Error;
use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes of packed parts that are kept.
const ROOM: usize = 64 << 20;

/// Packs the frames of one sequence, on any number of threads.
pub struct Packing {
    effort: Effort,
    opaque: bool,
    parts: Shelf<Packed>,
    idle: Mutex<Vec<Packer>>,
}

impl Packing {
    /// `opaque` announces that every pixel's alpha will be 255.
    pub fn new(effort: Effort, opaque: bool) -> Packing {
        Packing { effort, opaque, parts: Shelf::new(ROOM), idle: Mutex::default() }
    }

    /// Writes a frame as a PNG.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, to: impl Write, canvas: &Canvas) -> Result<(), Error> {
        let picture = canvas.picture();
        let (width, height) = (picture.width(), picture.height());
        let mut file = PartWriter::new(to, (width, height), self.opaque)?;
        let rows = file.rows_in_part();
        let parts: Vec<_> = picture.data().chunks(picture.stride() * rows as usize).collect();
        let prints: Vec<_> =
            (0..parts.len() as u32).map(|part| canvas.print_of_rows(part * rows, rows)).collect();
        let (mut found, now) = self.parts.find(prints.iter().copied());
        let mut packer = None;
        let mut new = Vec::new();
        for ((found, pixels), print) in found.iter_mut().zip(parts).zip(prints) {
            let packed = found.get_or_insert_with(|| {
                let packer = packer.get_or_insert_with(|| self.packer());
                let packed = Arc::new(packer.pack(pixels, width as usize));
                new.extend(print.map(|print| (print, packed.clone(), packed.blocks.len())));
                packed
            });
            file.write(packed)?;
        }
        self.parts.keep(new, now);
        self.idle().extend(packer);
        file.finish()
    }

    fn packer(&self) -> Packer {
        let idle = self.idle().pop();
        idle.unwrap_or_else(|| Packer::new(self.effort, self.opaque))
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Packer>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
