//! Takes solid runs and fragments front to back, keeps what is seen of them: a cel is one group's
//! picture of one band, with a z-list for every pixel in which borders lie over one another.
//!
//! A pixel is in one of these states, each a bit in a bitmap:
//!
//! | finished | covered | listed | |
//! |---|---|---|---|
//! | 0 | 0 | 0 | nothing drawn yet |
//! | 1 | 0 | 0 | done; its colour stands in the picture, or it is among those `to_resolve` |
//! | 0 or 1 | 1 | 0 | uniform so far: `sheets` holds all that was drawn |
//! | 0 or 1 | 0 | 1 | the z-list holds all that was drawn |
//! | 0 or 1 | 1 | 1 | `sheets` holds what lies in front, the z-list goes on from there |
//!
//! Promises: a finished pixel is never visited again, and no entry is kept behind an opaque solid run.

mod blends;
mod groups;
mod partition;
mod sheets;
mod waiting;

use crate::bitmap::{for_bits, for_runs, word_masks, Bitmap};
use crate::coverage::Part;
use crate::edges::{Bounds, BAND_ROWS};
use crate::pixel::resolve::NEGLIGIBLE;
use crate::scene::gradient_shader::LeftOut;
use crate::scene::paint::Sheet;
use crate::scene::shader::Shader;
use crate::zlist::{Entry, Head, Kind, NO_ENTRY};

/// What a shape is painted with, at the picture's scale.
#[derive(Clone, Copy)]
pub(crate) enum Brush<'a> {
    /// One colour, and the same in bytes.
    Flat(Sheet, [u8; 4]),
    Gradient {
        shape: u32,
        shader: &'a Shader<'a>,
        opaque: bool,
    },
}

impl Brush<'_> {
    pub fn flat(sheet: Sheet) -> Self {
        Brush::Flat(sheet, sheet.to_rgba8())
    }

    fn is_opaque(&self) -> bool {
        match self {
            Brush::Flat(sheet, _) => sheet.is_opaque(),
            Brush::Gradient { opaque, .. } => *opaque,
        }
    }

    pub fn kind(&self) -> Kind {
        match self {
            Brush::Flat(sheet, _) => Kind::Sheet(*sheet),
            Brush::Gradient { shape, .. } => Kind::Gradient(*shape),
        }
    }
}

/// Rows of the picture that a band writes to.
pub(crate) struct Rows<'a> {
    pub bytes: &'a mut [u8],
    /// Bytes from row to row.
    pub stride: usize,
    /// The picture's row that comes first here.
    pub top: u32,
    /// How many there are.
    pub count: usize,
}

impl Rows<'_> {
    #[inline]
    pub fn row(&mut self, row: usize, width: usize) -> &mut [[u8; 4]] {
        let bytes = &mut self.bytes[row * self.stride..][..width * 4];
        bytes.as_chunks_mut().0
    }
}

/// One group's picture of one band.
pub(crate) struct Cel {
    pub width: usize,
    pub opacity: f32,
    pub finished: Bitmap,
    covered: Bitmap,
    listed: Bitmap,
    sheets: sheets::Sheets,
    /// First and last entry of each pixel's z-list.
    lists: Vec<(u32, u32)>,
    /// Pixels whose z-list the last shape has ended with an opaque colour, which is not in it.
    to_resolve: Vec<Pixels>,
    /// Blended groups that wait for what lies behind them.
    waiting: waiting::Waiting,
}

/// Some of the 64 pixels of one word of a row.
#[derive(Clone, Copy)]
pub(crate) struct Pixels {
    pub row: usize,
    pub word: usize,
    pub bits: u64,
    /// Which pixels of the word have a sheet before their z-list.
    covered: u64,
}

impl Cel {
    pub fn new(width: u32) -> Cel {
        let (width, rows) = (width as usize, BAND_ROWS as usize);
        let bitmap = Bitmap::new(width, rows);
        Cel {
            width,
            opacity: 1.0,
            finished: bitmap.clone(),
            covered: bitmap.clone(),
            listed: bitmap,
            sheets: sheets::Sheets::new(width, rows),
            lists: vec![(NO_ENTRY, NO_ENTRY); width * rows],
            to_resolve: Vec::new(),
            waiting: waiting::Waiting::default(),
        }
    }

    /// Makes all pixels new.
    pub fn clear(&mut self) {
        self.opacity = 1.0;
        self.finished.clear();
        self.covered.clear();
        self.listed.clear();
        self.sheets.clear();
        self.waiting.clear();
    }

    /// Takes for finished the pixels of those words of a row which `stands` says are in the picture already.
    pub fn keep(&mut self, stands: impl Fn(usize) -> bool) {
        for word in (0..self.finished.words()).filter(|&word| stands(word)) {
            for row in 0..BAND_ROWS as usize {
                self.finished.row_mut(row)[word] = u64::MAX;
            }
        }
    }

    /// Makes it the cel of a group inside `parent`: what is finished there needs nothing here.
    pub fn open_in(&mut self, parent: &Cel, opacity: f32) {
        self.clear();
        self.opacity = opacity;
        self.finished.copy_from(&parent.finished);
    }

    /// Takes for finished what lies outside these bounds: nothing there is of use.
    pub fn leave_outside(&mut self, bounds: Option<Bounds>, rows: &Rows) {
        let Bounds { left, right, top, bottom } = bounds.unwrap_or_default();
        for row in 0..rows.count {
            let y = rows.top as usize + row;
            let finished = self.finished.row_mut(row);
            if !(top..bottom).contains(&y) {
                finished.fill(u64::MAX);
                continue;
            }
            for (from, to) in [(0, left), (right, finished.len() * 64)] {
                word_masks(from, to).for_each(|(word, mask)| finished[word] |= mask);
            }
        }
    }

    /// Paints pixels [from, to) of a row, behind all that was painted before. In the cel that is the
    /// picture's, opaque paint on new pixels goes there at once, and z-lists before an opaque colour end:
    /// [`Cel::take_to_resolve`].
    pub fn solid<P: Part>(
        &mut self,
        row: usize,
        (from, to): (usize, usize),
        brush: &Brush,
        top: u32,
        mut picture: Option<&mut Rows>,
        entries: &mut Vec<Entry<P>>,
    ) {
        let opaque = brush.is_opaque();
        let ends_lists = opaque && picture.is_some() && matches!(brush, Brush::Flat(..));
        for (word, mask) in word_masks(from, to) {
            let open = mask & !self.finished.row(row)[word];
            if open == 0 {
                continue;
            }
            let mut touched = open & self.touched(row, word);
            let fresh = open & !touched;
            let mut done = if opaque { open } else { 0 };
            if fresh != 0 {
                match &mut picture {
                    Some(picture) if opaque => paint_fresh(picture, row, self.width, (word, fresh), brush),
                    _ => {
                        let picture = picture.as_deref_mut();
                        done |= self.start_sheets(row, top, (word, fresh), brush, picture, entries);
                    }
                }
            }
            if ends_lists && touched != 0 {
                touched &= !self.end_lists(row, word, touched);
            }
            if touched != 0 {
                done |= self.paint_touched(row, top, (word, touched), brush, entries);
            }
            self.finished.row_mut(row)[word] |= done;
        }
    }

    /// Leaves those of some pixels of a word that have z-lists to be resolved; tells which these are.
    #[inline(always)]
    fn end_lists(&mut self, row: usize, word: usize, touched: u64) -> u64 {
        let listed = touched & self.listed.row(row)[word];
        if listed != 0 {
            self.to_resolve.push(self.pixels(row, word, listed));
            self.listed.row_mut(row)[word] &= !listed;
            self.covered.row_mut(row)[word] &= !listed;
        }
        listed
    }

    /// Pixels whose z-list the last shape has ended, to be resolved with its colour behind everything.
    pub fn take_to_resolve(&mut self) -> Option<Pixels> {
        self.to_resolve.pop()
    }

    /// The first paint on some pixels of a word; tells which of them are done with it.
    fn start_sheets<P: Part>(
        &mut self,
        row: usize,
        top: u32,
        (word, fresh): (usize, u64),
        brush: &Brush,
        mut picture: Option<&mut Rows>,
        entries: &mut Vec<Entry<P>>,
    ) -> u64 {
        self.covered.row_mut(row)[word] |= fresh;
        let mut done = 0;
        for_runs(fresh, |a, b| match brush {
            Brush::Flat(sheet, _) => self.sheets.fill((row, word), (a, b), *sheet),
            Brush::Gradient { shader, .. } => {
                let sheets = self.sheets.start_each((row, word), (a, b));
                let put = |i: usize, sheet| sheets[i] = sheet;
                let x = word * 64 + a;
                let picture = picture.as_mut().map(|rows| &mut rows.row(row, self.width)[x..]);
                let LeftOut { uneven, clear, finished } =
                    shader.row((x, top + row as u32), b - a, picture, put);
                self.covered.row_mut(row)[word] &= !((uneven | clear | finished) << a);
                self.list_whole(row, (word, uneven << a), brush, entries);
                done |= finished << a;
            }
        });
        done
    }

    /// Starts lists on pixels of a word with paint of which the mean over a pixel will not do.
    fn list_whole<P: Part>(
        &mut self,
        row: usize,
        (word, uneven): (usize, u64),
        brush: &Brush,
        entries: &mut Vec<Entry<P>>,
    ) {
        self.listed.row_mut(row)[word] |= uneven;
        for_bits(uneven, |x| {
            let pixel = row * self.width + word * 64 + x;
            self.lists[pixel] = (NO_ENTRY, NO_ENTRY);
            self.append(pixel, Entry { next: NO_ENTRY, part: P::WHOLE, kind: brush.kind() }, entries);
        });
    }

    /// More paint behind what was painted on some pixels of a word; tells which let no light through.
    fn paint_touched<P: Part>(
        &mut self,
        row: usize,
        top: u32,
        (word, touched): (usize, u64),
        brush: &Brush,
        entries: &mut Vec<Entry<P>>,
    ) -> u64 {
        let listed = touched & self.listed.row(row)[word];
        let mut saturated = 0;
        for_runs(touched & !listed, |a, b| match brush {
            Brush::Flat(behind, _) => saturated |= self.sheets.put_behind((row, word), (a, b), *behind),
            Brush::Gradient { shader, .. } => {
                let sheets = self.sheets.each((row, word), (a, b));
                let put = |i: usize, behind| {
                    sheets[i] = sheets[i].over(behind);
                    saturated |= u64::from(sheets[i].through() < NEGLIGIBLE) << (a + i);
                };
                let at = (word * 64 + a, top + row as u32);
                // What is clear changes nothing.
                let LeftOut { uneven, .. } = shader.row(at, b - a, None, put);
                self.list_whole(row, (word, uneven << a), brush, entries);
            }
        });
        let start = row * self.width + word * 64;
        for_bits(listed, |x| self.append_whole(start + x, brush, entries));
        saturated
    }

    /// Paints a part of one pixel, behind all that was painted before. `kind` is [`Brush::kind`].
    #[inline(always)]
    pub fn part<P: Part>(&mut self, row: usize, x: usize, part: P, kind: &Kind, entries: &mut Vec<Entry<P>>) {
        if self.finished.get(row, x) {
            return;
        }
        let pixel = row * self.width + x;
        let (at, entry) = (entries.len() as u32, Entry { next: NO_ENTRY, part, kind: *kind });
        entries.push(entry);
        if self.listed.get(row, x) {
            let (_, last) = &mut self.lists[pixel];
            entries[*last as usize].next = at;
            *last = at;
        } else {
            self.listed.set(row, x);
            self.lists[pixel] = (at, at);
        }
    }

    #[inline(always)]
    fn append<P: Part>(&mut self, pixel: usize, entry: Entry<P>, entries: &mut Vec<Entry<P>>) {
        let at = entries.len() as u32;
        entries.push(entry);
        let (first, last) = &mut self.lists[pixel];
        match *last {
            NO_ENTRY => *first = at,
            last => entries[last as usize].next = at,
        }
        *last = at;
    }

    /// A whole sheet behind another is one sheet.
    fn append_whole<P: Part>(&mut self, pixel: usize, brush: &Brush, entries: &mut Vec<Entry<P>>) {
        let kind = brush.kind();
        let last = self.lists[pixel].1;
        if let (Kind::Sheet(behind), Some(Entry { part, kind: Kind::Sheet(front), .. })) =
            (kind, entries.get_mut(last as usize))
        {
            if *part == P::WHOLE {
                *front = front.over(behind);
                return;
            }
        }
        self.append(pixel, Entry { next: NO_ENTRY, part: P::WHOLE, kind }, entries);
    }

    /// The state of 64 pixels of a row: finished in the picture, uniform, with a z-list.
    pub fn states(&self, row: usize, word: usize) -> (u64, u64, u64) {
        let (covered, listed) = (self.covered.row(row)[word], self.listed.row(row)[word]);
        (self.finished.row(row)[word] & !(covered | listed), covered & !listed, listed)
    }

    /// Those of 64 pixels of a row of which something is kept here.
    #[inline]
    fn touched(&self, row: usize, word: usize) -> u64 {
        self.covered.row(row)[word] | self.listed.row(row)[word]
    }

    /// What was painted on all of a pixel, before its z-list if it has one.
    #[inline]
    fn front(&self, row: usize, x: usize) -> Sheet {
        match self.covered.get(row, x) {
            true => self.sheets.get(row, x),
            false => Sheet::CLEAR,
        }
    }

    /// Calls `take` with runs of those of a word's pixels, uniform all: where they lie in the word, and all that was
    /// painted there.
    #[inline]
    pub fn for_uniform(&self, word: (usize, usize), pixels: u64, mut take: impl FnMut(usize, usize, Sheet)) {
        for_runs(pixels, |a, b| self.sheets.for_runs(word, (a, b), &mut take));
    }

    /// Some of the pixels of a word, as they are.
    pub fn pixels(&self, row: usize, word: usize, bits: u64) -> Pixels {
        Pixels { row, word, bits, covered: self.covered.row(row)[word] }
    }

    /// The z-list of one of these pixels, which has one: the column counts from the word's first.
    #[inline]
    pub fn list(&self, pixels: &Pixels, column: usize) -> Head {
        let (row, x) = (pixels.row, pixels.word * 64 + column);
        let front = match pixels.covered >> column & 1 {
            0 => Sheet::CLEAR,
            _ => self.sheets.get(row, x),
        };
        Head { front, first: self.lists[row * self.width + x].0 }
    }
}

/// Opaque paint on new pixels of a word.
#[inline]
fn paint_fresh(picture: &mut Rows, row: usize, width: usize, (word, fresh): (usize, u64), brush: &Brush) {
    let (first, y) = (word * 64, picture.top + row as u32);
    let pixels = picture.row(row, width);
    for_runs(fresh, |a, b| {
        let pixels = &mut pixels[first + a..first + b];
        match brush {
            Brush::Flat(_, bytes) => pixels.fill(*bytes),
            Brush::Gradient { shader, .. } => shader.write_row(first + a, y, pixels),
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_outside_bounds_is_finished_and_nothing_within() {
        let (width, count, top) = (130, BAND_ROWS as usize, 64u32);
        for bounds in [None, Some(Bounds { left: 63, right: 65, top: 60, bottom: 66 })] {
            let mut cel = Cel::new(width);
            cel.leave_outside(bounds, &Rows { bytes: &mut [], stride: 0, top, count });
            for (row, x) in (0..count).flat_map(|row| (0..width as usize).map(move |x| (row, x))) {
                let within = bounds.is_some_and(|b| {
                    (b.left..b.right).contains(&x) && (b.top..b.bottom).contains(&(top as usize + row))
                });
                assert_eq!(cel.finished.get(row, x), !within, "{x}, {row}");
            }
        }
    }
}
