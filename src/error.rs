//! Everything that can go wrong between SVG bytes and pixels, as one type.

/// Why a picture could not be made. Each message names the element, value or limit at fault.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The bytes are not an SVG that can be parsed.
    #[error("{0}")]
    Parse(String),
    /// The drawing or the wanted picture has no area, or a size that is not a number.
    #[error("{0}")]
    Size(String),
    /// The element asked for is not in the drawing, or draws nothing.
    #[error("{0}")]
    Element(String),
    /// A limit would be passed.
    #[error("{0}")]
    Limit(String),
    /// The caller's buffer is too small for the picture.
    #[error(
        "a picture of {width} x {height} pixels needs {needed} bytes at this stride, the buffer has {given}"
    )]
    Buffer {
        /// Columns of the picture.
        width: u32,
        /// Rows of the picture.
        height: u32,
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
    /// A setting is outside its range.
    #[error("{0}")]
    Setting(String),
    /// The rows could not be written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
