//! Takes pixel rows, keeps them: a picture in memory.

/// A picture: `width` x `height` pixels of 8-bit RGBA, sRGB-encoded, straight (not premultiplied)
/// alpha, rows from the top, no padding: PNG's own order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixmap {
    width: u32,
    height: u32,
    data: Vec<u8>,
}

impl Pixmap {
    /// Bytes of one pixel.
    pub const BYTES_PER_PIXEL: usize = 4;

    /// A transparent picture.
    pub fn new(width: u32, height: u32) -> Self {
        let bytes = width as usize * height as usize * Self::BYTES_PER_PIXEL;
        Pixmap { width, height, data: vec![0; bytes] }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Bytes from the start of one row to the start of the next.
    pub fn stride(&self) -> usize {
        self.width as usize * Self::BYTES_PER_PIXEL
    }

    /// All pixels, row by row, 4 bytes each: red, green, blue, alpha.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// All pixels, to be written.
    pub fn data_mut(&mut self) -> &mut [u8] {
        &mut self.data
    }

    /// The pixel in column `x` (from the left) and row `y` (from the top): red, green, blue, alpha.
    ///
    /// # Panics
    /// When `x` or `y` lies outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside the picture");
        let at = y as usize * self.stride() + x as usize * Self::BYTES_PER_PIXEL;
        [self.data[at], self.data[at + 1], self.data[at + 2], self.data[at + 3]]
    }
}

impl From<Pixmap> for image::RgbaImage {
    fn from(pixmap: Pixmap) -> Self {
        image::RgbaImage::from_raw(pixmap.width, pixmap.height, pixmap.data)
            .expect("a pixmap holds exactly its pixels")
    }
}
