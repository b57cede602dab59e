//! The renderers behind one signature: a prepared drawing in, pixels in a reused buffer.

use super::drawings::Prepared;
use super::vello::Vello;
use resvg::tiny_skia;
use std::time::{Duration, Instant};
use toon_raster::{kurbo, Method, Pixmap, Renderer, Settings, Stages, Viewport};

/// Columns and rows of a picture.
#[derive(Clone, Copy)]
pub struct Size {
    pub width: u16,
    pub height: u16,
}

impl Size {
    /// The drawing's shape, with `longest` pixels on its longer side.
    pub fn of(drawing: &Prepared, longest: u16) -> Size {
        let size = drawing.scene.size();
        let scale = f64::from(longest) / size.width.max(size.height);
        let pixels = |side: f64| (side * scale).round().max(1.0) as u16;
        Size { width: pixels(size.width), height: pixels(size.height) }
    }

    fn scale(self, drawing: &Prepared) -> (f64, f64) {
        let size = drawing.scene.size();
        (f64::from(self.width) / size.width, f64::from(self.height) / size.height)
    }
}

/// resvg, that is tiny-skia; it has one thread.
pub struct TinySkia {
    pixmap: tiny_skia::Pixmap,
    transform: tiny_skia::Transform,
}

impl TinySkia {
    pub fn new(drawing: &Prepared, size: Size) -> TinySkia {
        let pixmap = tiny_skia::Pixmap::new(u32::from(size.width), u32::from(size.height))
            .expect("a picture has at least one pixel");
        let (sx, sy) = size.scale(drawing);
        TinySkia { pixmap, transform: tiny_skia::Transform::from_scale(sx as f32, sy as f32) }
    }

    /// The buffer is cleared before the clock starts.
    pub fn time(&mut self, drawing: &Prepared) -> Duration {
        self.pixmap.data_mut().fill(0);
        let start = Instant::now();
        resvg::render(&drawing.tree, self.transform, &mut self.pixmap.as_mut());
        start.elapsed()
    }

    /// Premultiplied RGBA.
    pub fn pixels(&self) -> &[u8] {
        self.pixmap.data()
    }
}

/// vello_cpu; playing the commands and rasterizing are timed.
pub struct VelloCpu {
    vello: Vello,
    view: kurbo::Affine,
}

impl VelloCpu {
    pub fn new(drawing: &Prepared, size: Size, threads: usize) -> VelloCpu {
        let (sx, sy) = size.scale(drawing);
        let vello = Vello::new(size.width, size.height, threads);
        VelloCpu { vello, view: kurbo::Affine::scale_non_uniform(sx, sy) }
    }

    pub fn time(&mut self, drawing: &Prepared) -> Duration {
        let start = Instant::now();
        self.vello.render(&drawing.commands, self.view);
        start.elapsed()
    }

    /// Premultiplied RGBA.
    pub fn pixels(&self) -> &[u8] {
        self.vello.pixels()
    }
}

/// This crate, by one method.
pub struct Toon {
    renderer: Renderer,
    viewport: Viewport,
    pixmap: Pixmap,
}

impl Toon {
    /// With `stage_times` it reads the clock between stages, which costs a little.
    pub fn new(drawing: &Prepared, size: Size, threads: usize, method: Method, stage_times: bool) -> Toon {
        let (width, height) = (u32::from(size.width), u32::from(size.height));
        let settings = Settings { threads, stage_times, ..Settings::of(method) };
        let renderer = Renderer::new(settings).expect("the defaults are in range");
        let viewport = Viewport::fit(&drawing.scene, width, height);
        Toon { renderer, viewport, pixmap: Pixmap::new(width, height) }
    }

    pub fn time(&mut self, drawing: &Prepared) -> Duration {
        let stride = self.pixmap.stride();
        let start = Instant::now();
        self.renderer
            .render_into(&drawing.scene, &self.viewport, self.pixmap.data_mut(), stride)
            .expect("the viewport and the buffer fit");
        start.elapsed()
    }

    pub fn stages(&self) -> &Stages {
        self.renderer.stages()
    }

    /// Premultiplied RGBA, as the others have it.
    pub fn pixels(&self) -> Vec<u8> {
        let premultiply = |c: u8, a: u8| ((u32::from(c) * u32::from(a) + 127) / 255) as u8;
        self.pixmap
            .data()
            .chunks_exact(4)
            .flat_map(|p| [premultiply(p[0], p[3]), premultiply(p[1], p[3]), premultiply(p[2], p[3]), p[3]])
            .collect()
    }
}
