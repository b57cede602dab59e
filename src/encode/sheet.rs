//! Takes frames, writes a sprite sheet: one PNG with the frames in rows, and a JSON of where each is, in
//! the array form that Aseprite and TexturePacker write and game engines read.

use super::{Effort, PngWriter, Rate};
use crate::Error;
use std::fmt::Write as _;
use std::io::Write;

/// Where the frames of a sheet are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Of one frame, in pixels.
    pub width: u32,
    /// Of one frame, in pixels.
    pub height: u32,
    /// Frames side by side.
    pub columns: u32,
    /// All frames.
    pub frames: u32,
}

impl Layout {
    /// Width and height of the sheet, in pixels; `None` if a PNG cannot be so large.
    pub fn size(&self) -> Option<(u32, u32)> {
        const LONGEST: u64 = i32::MAX as u64;
        let columns = self.columns.min(self.frames).max(1);
        let rows = self.frames.div_ceil(columns).max(1);
        let (width, height) =
            (u64::from(columns) * u64::from(self.width), u64::from(rows) * u64::from(self.height));
        (width <= LONGEST && height <= LONGEST).then_some((width as u32, height as u32))
    }

    /// The JSON beside the sheet called `image`; each frame is shown for as long as `rate` says.
    pub fn json(&self, image: &str, names: &[String], rate: Rate) -> String {
        let (sheet_width, sheet_height) = self.size().unwrap_or_default();
        let Layout { width, height, .. } = *self;
        let columns = self.columns.min(self.frames).max(1);
        let mut text = String::from("{\"frames\":[");
        for (i, name) in names.iter().enumerate() {
            let i = i as u32;
            let (x, y) = (i % columns * width, i / columns * height);
            let _ = write!(
                text,
                "{}\n{{\"filename\":{},\"frame\":{{\"x\":{x},\"y\":{y},\"w\":{width},\"h\":{height}}},\
                 \"rotated\":false,\"trimmed\":false,\
                 \"sourceSize\":{{\"w\":{width},\"h\":{height}}},\"duration\":{}}}",
                if i > 0 { "," } else { "" },
                quoted(name),
                rate.milliseconds(u64::from(i) + 1) - rate.milliseconds(u64::from(i)),
            );
        }
        let _ = write!(
            text,
            "\n],\"meta\":{{\"app\":\"toon-raster\",\"image\":{},\"format\":\"RGBA8888\",\
             \"size\":{{\"w\":{sheet_width},\"h\":{sheet_height}}},\"scale\":\"1\"}}}}\n",
            quoted(image)
        );
        text
    }
}

fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out + "\""
}

/// Writes the picture, frame by frame; one row of frames is in memory.
pub struct SheetWriter<W: Write> {
    png: PngWriter<W>,
    layout: Layout,
    sheet_width: u32,
    row: Vec<u8>,
    frames: u32,
}

impl<W: Write> SheetWriter<W> {
    /// Begins a sheet.
    ///
    /// # Errors
    /// When it is too large, or cannot be written.
    pub fn new(to: W, layout: Layout, opaque: bool, effort: Effort) -> Result<SheetWriter<W>, Error> {
        let (width, height) = layout.size().ok_or_else(|| {
            Error::Size(format!("a sheet of {} frames is too large for a PNG", layout.frames))
        })?;
        let png = PngWriter::new(to, width, height, opaque, effort)?;
        Ok(SheetWriter { png, layout, sheet_width: width, row: Vec::new(), frames: 0 })
    }

    /// Adds the next frame: straight RGBA.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_frame(&mut self, pixels: &[u8]) -> Result<(), Error> {
        let (stride, sheet_stride) = (self.layout.width as usize * 4, self.sheet_width as usize * 4);
        let columns = (self.sheet_width / self.layout.width) as usize;
        self.row.resize(sheet_stride * self.layout.height as usize, 0);
        let left = self.frames as usize % columns * stride;
        for (row, pixels) in self.row.chunks_exact_mut(sheet_stride).zip(pixels.chunks_exact(stride)) {
            row[left..left + stride].copy_from_slice(pixels);
        }
        self.frames += 1;
        if (self.frames as usize).is_multiple_of(columns) {
            self.flush()?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.png.write_rows(&self.row)?;
        self.row.fill(0);
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written, or frames are missing.
    pub fn finish(mut self) -> Result<(), Error> {
        if !self.frames.is_multiple_of(self.sheet_width / self.layout.width) {
            self.flush()?;
        }
        self.png.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_frames_in_two_columns_take_three_rows() {
        let layout = Layout { width: 3, height: 2, columns: 2, frames: 5 };
        assert_eq!(layout.size(), Some((6, 6)));
        let mut file = Vec::new();
        let mut sheet = SheetWriter::new(&mut file, layout, false, Effort::Flat).unwrap();
        for n in 1..=5 {
            sheet.write_frame(&[n; 3 * 2 * 4]).unwrap();
        }
        sheet.finish().unwrap();
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut pixels = vec![9; 6 * 6 * 4];
        reader.next_frame(&mut pixels).unwrap();
        let at = |x: usize, y: usize| pixels[(y * 6 + x) * 4];
        assert_eq!([at(0, 0), at(3, 1), at(2, 2), at(5, 3), at(0, 5), at(3, 4)], [1, 2, 3, 4, 5, 0]);
        let names: Vec<String> = (1..=5).map(|n| format!("a\"{n}")).collect();
        let json = layout.json("s.png", &names, Rate { frames: 24, seconds: 1 });
        assert!(json.contains(r#"{"filename":"a\"4","frame":{"x":3,"y":2,"w":3,"h":2}"#), "{json}");
    }
}
