//! Takes the size options and a drawing, makes the viewport: as resvg does, but sizes with an element
//! alone fit the element rather than its page.

use super::report::Failure;
use toon_raster::kurbo::Affine;
use toon_raster::{usvg, Viewport};

/// Longest side of a PNG.
const MAX_SIDE: u32 = i32::MAX as u32;

/// How large the picture is. The aspect is always kept.
#[derive(Clone, Copy, Debug)]
pub enum Fit {
    /// The drawing's own size.
    Original,
    /// As wide as this.
    Width(u32),
    /// As high as this.
    Height(u32),
    /// As large as fits in this width and height.
    Within(u32, u32),
    /// The drawing's own size times this.
    Zoom(f32),
}

impl Fit {
    /// In 32-bit floats, as resvg: the same drawing has the same number of pixels in both.
    fn size(self, original: usvg::Size) -> Option<usvg::Size> {
        match self {
            Fit::Original => Some(original),
            Fit::Width(width) => original.scale_to_width(width as f32),
            Fit::Height(height) => original.scale_to_height(height as f32),
            Fit::Within(width, height) => {
                usvg::Size::from_wh(width as f32, height as f32).map(|s| original.scale_to(s))
            }
            Fit::Zoom(zoom) => original.scale_by(zoom),
        }
    }
}

/// What of the drawing is in the picture.
#[derive(Clone, Debug)]
pub enum Part {
    /// The page that the drawing declares.
    Page,
    /// The box of all that is drawn, cut at the page.
    Drawing,
    /// One element: its own box, or the whole page with nothing else on it.
    Element { id: String, on_page: bool },
}

/// The viewport of this part of the drawing.
///
/// # Errors
/// When there is no such element, or nothing to be seen of it, or more than `max_pixels`.
pub fn viewport(tree: &usvg::Tree, part: &Part, fit: Fit, max_pixels: u64) -> Result<Viewport, Failure> {
    let (x, y, size) = match part {
        Part::Page | Part::Drawing | Part::Element { on_page: true, .. } => (0.0, 0.0, tree.size()),
        Part::Element { id, .. } => {
            let node = tree.node_by_id(id).ok_or_else(|| {
                Failure::input(format!("no element has the id '{id}' (--query-all lists them)"))
            })?;
            let bounds = node
                .abs_layer_bounding_box()
                .ok_or_else(|| Failure::input(format!("the element '{id}' draws nothing")))?;
            (bounds.x() as f64, bounds.y() as f64, bounds.size())
        }
    };
    let whole = placed((x, y), size, fit)?;
    let viewport = match part {
        Part::Drawing => drawing_area(tree, whole),
        _ => whole,
    };
    affordable(viewport, max_pixels)
}

/// The viewport of a page of this size.
///
/// # Errors
/// When it has more than `max_pixels`.
pub fn page(size: usvg::Size, fit: Fit, max_pixels: u64) -> Result<Viewport, Failure> {
    affordable(placed((0.0, 0.0), size, fit)?, max_pixels)
}

/// A rectangle of the drawing, by its corner and its size.
fn placed((x, y): (f64, f64), size: usvg::Size, fit: Fit) -> Result<Viewport, Failure> {
    let target = fit.size(size).ok_or_else(|| Failure::input("the picture would have no size"))?;
    let scale_x = target.width() as f64 / size.width() as f64;
    let scale_y = target.height() as f64 / size.height() as f64;
    let transform = Affine::scale_non_uniform(scale_x, scale_y) * Affine::translate((-x, -y));
    Ok(Viewport { width: target.width().ceil() as u32, height: target.height().ceil() as u32, transform })
}

fn affordable(viewport: Viewport, max_pixels: u64) -> Result<Viewport, Failure> {
    if viewport.width.max(viewport.height) > MAX_SIDE {
        return Err(Failure::input(format!(
            "a side of the picture would be longer than {MAX_SIDE} pixels (ask for less with -w, -h or -z)"
        )));
    }
    let pixels = viewport.width as u64 * viewport.height as u64;
    if pixels > max_pixels {
        return Err(Failure::input(format!(
            "{} x {} pixels are more than {max_pixels} (ask for less with -w, -h or -z, or raise --max-pixels)",
            viewport.width, viewport.height
        )));
    }
    Ok(viewport)
}

/// The pixels of `whole` which the drawing's box touches; all of them if it touches none.
fn drawing_area(tree: &usvg::Tree, whole: Viewport) -> Viewport {
    let bounds = tree.root().layer_bounding_box();
    let [scale_x, _, _, scale_y, ..] = whole.transform.as_coeffs();
    // Pixels [left, right) and [top, bottom).
    let left = (bounds.left() as f64 * scale_x).floor().max(0.0);
    let top = (bounds.top() as f64 * scale_y).floor().max(0.0);
    let right = (bounds.right() as f64 * scale_x).ceil().min(whole.width as f64);
    let bottom = (bounds.bottom() as f64 * scale_y).ceil().min(whole.height as f64);
    if left < right && top < bottom {
        Viewport {
            width: (right - left) as u32,
            height: (bottom - top) as u32,
            transform: Affine::translate((-left, -top)) * whole.transform,
        }
    } else {
        whole
    }
}
