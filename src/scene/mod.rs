//! Takes SVG bytes, makes a [`Scene`]: depth-ordered shapes with their paint, clips and groups.
//!
//! A scene has no size in pixels: curves stay curves and strokes stay strokes until a picture is
//! made of them. Shapes are listed back to front, as SVG paints them.

pub mod census;
pub(crate) mod color_map;
mod convert;
pub(crate) mod gradient_shader;
pub(crate) mod images;
pub(crate) mod paint;
pub(crate) mod parts;
pub(crate) mod print;
pub(crate) mod raster;
pub(crate) mod shader;
mod unfold;

pub mod load;

pub use census::Census;
pub use load::{FontSource, Limits};

use crate::Error;
use kurbo::{Affine, Rect, Size};
use paint::Paint;
use std::sync::Arc;
use usvg::tiny_skia_path::Path;

/// How SVG bytes are read.
#[derive(Default)]
pub struct Options {
    /// What usvg asks for: dpi, languages, style sheet, default font family. Its image resolver is
    /// not called (images are opened under this library's own limits), and its font database stands in for
    /// [`Options::fonts`] if it holds any font.
    pub usvg: usvg::Options<'static>,
    /// Where fonts come from, asked only for drawings with text; by default the system's.
    pub fonts: FontSource,
    /// How much a drawing may ask for.
    pub limits: Limits,
}

/// Something in the drawing which is not drawn as SVG says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What is left out, in the plural: `images` (that cannot be read), `texts without a
    /// font`, `links by which elements draw themselves`, `foreign objects`, `elements of other files`,
    /// `vector effects`, `linear colours of masks`, `elements with filters that are not there`.
    pub kind: &'static str,
    /// The first element that has it: its `id`, or where it stands when it has none.
    pub element: String,
    /// How many elements have it.
    pub count: usize,
}

/// A drawing, ready to be rendered at any size.
#[derive(Clone, Debug)]
pub struct Scene {
    size: Size,
    bounding_box: Option<Rect>,
    warnings: Vec<Warning>,
    /// Back to front.
    pub(crate) shapes: Vec<Shape>,
    /// A clip stands behind the clips it refers to.
    pub(crate) clips: Vec<Clip>,
    /// Groups that composite as one; number 0 is the picture itself. Parents stand before children.
    pub(crate) groups: Vec<Group>,
    /// Of each shape, if they are known already.
    pub(crate) prints: Vec<print::Print>,
    /// Texts that became shapes.
    texts: usize,
}

/// One flat region of the drawing: a fill or the outline of a stroke.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub geometry: Geometry,
    pub paint: Paint,
    /// Only what lies inside this clip is seen.
    pub clip: Option<ClipId>,
    /// The innermost group that composites as one.
    pub group: GroupId,
}

/// Where a shape is, before it is flattened.
#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    pub path: Arc<Path>,
    /// From the path's coordinates to the scene's user units.
    pub transform: Affine,
    pub outline: Outline,
    /// Not anti-aliased (`shape-rendering: crispEdges`).
    pub crisp: bool,
}

impl Geometry {
    /// The inside of a rectangle.
    pub fn of_rect(rect: Rect, transform: Affine) -> Geometry {
        let (left, top) = (rect.x0 as f32, rect.y0 as f32);
        let (right, bottom) = (rect.x1 as f32, rect.y1 as f32);
        let mut path = usvg::tiny_skia_path::PathBuilder::new();
        path.move_to(left, top);
        path.line_to(right, top);
        path.line_to(right, bottom);
        path.line_to(left, bottom);
        path.close();
        let path = Arc::new(path.finish().expect("four points make a path"));
        Geometry { path, transform, outline: Outline::Fill(FillRule::NonZero), crisp: false }
    }
}

/// What of a path is filled.
#[derive(Clone, Debug)]
pub(crate) enum Outline {
    /// The inside, by this rule.
    Fill(FillRule),
    /// The line along it; widths and dashes in the path's coordinates.
    Stroke(Arc<StrokeStyle>),
    /// All pixels that the path's bounds touch.
    Pixels,
}

/// How a line is drawn along a path.
#[derive(Clone, Debug)]
pub(crate) struct StrokeStyle {
    pub line: kurbo::Stroke,
    /// A miter beyond the limit is cut off at it, rather than left out (`stroke-linejoin: miter-clip`).
    pub clips_miters: bool,
}

impl From<kurbo::Stroke> for StrokeStyle {
    fn from(line: kurbo::Stroke) -> StrokeStyle {
        StrokeStyle { line, clips_miters: false }
    }
}

impl std::ops::Deref for StrokeStyle {
    type Target = kurbo::Stroke;

    fn deref(&self) -> &kurbo::Stroke {
        &self.line
    }
}

/// Which winding numbers are inside (SVG 2, 13.3.1): those that have any of these bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i8)]
pub(crate) enum FillRule {
    NonZero = -1,
    EvenOdd = 1,
}

impl FillRule {
    /// Is a point with this winding number inside?
    #[inline]
    pub fn inside(self, winding: i32) -> bool {
        winding & i32::from(self as i8) != 0
    }
}

/// Index into [`Scene::clips`].
pub(crate) type ClipId = u32;
/// Index into [`Scene::groups`].
pub(crate) type GroupId = u32;

/// A region that shapes are clipped to: the union of its members, within the clips it refers to.
#[derive(Clone, Debug)]
pub(crate) struct Clip {
    pub members: Vec<ClipMember>,
    /// All of these apply as well: the clip of an outer group, and the `clip-path` of the clip itself.
    pub within: Vec<ClipId>,
}

/// One shape of a clip, perhaps clipped itself.
#[derive(Clone, Debug)]
pub(crate) struct ClipMember {
    pub geometry: Geometry,
    pub clip: Option<ClipId>,
}

/// Shapes that composite into one before they meet what is below (SVG's isolated group opacity).
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub parent: GroupId,
    /// 0 ..= 1.
    pub opacity: f32,
    pub role: Role,
}

/// How a group meets what is around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// Painted over what lies behind it.
    Paint,
    /// Blended with what lies behind it in the group around it, which is its backdrop.
    Blend(usvg::BlendMode),
    /// Not painted: a mask. Its shapes stand right before those which it masks, seen from the front.
    Mask(usvg::MaskType),
    /// Painted as far as the mask with this number shows it. Both have the same parent.
    Masked(GroupId),
}

impl Role {
    pub fn mask_type(self) -> Option<usvg::MaskType> {
        match self {
            Role::Mask(kind) => Some(kind),
            _ => None,
        }
    }
}

impl Scene {
    /// Reads an SVG or svgz.
    ///
    /// # Errors
    /// As [`load::tree_from_bytes`] and [`Scene::from_tree`].
    pub fn from_bytes(bytes: &[u8], options: &Options) -> Result<Scene, Error> {
        let (tree, warnings) = load::tree_and_warnings(bytes, options)?;
        let mut scene = Scene::from_tree(&tree)?;
        scene.warnings.extend(warnings);
        Ok(scene)
    }

    /// Takes a tree that usvg has parsed already.
    ///
    /// # Errors
    /// [`Error::Limit`] when opacity groups are nested too deep.
    pub fn from_tree(tree: &usvg::Tree) -> Result<Scene, Error> {
        convert::scene(tree, None)
    }

    /// Only the element with this id, with its own transform but not its parents' clips and opacity.
    ///
    /// # Errors
    /// [`Error::Element`] when there is no such element or it draws nothing.
    pub fn from_element(tree: &usvg::Tree, id: &str) -> Result<Scene, Error> {
        let node = tree.node_by_id(id).ok_or_else(|| {
            Error::Element(format!("no element with id '{id}' is drawn (--query-all lists them)"))
        })?;
        convert::scene(tree, Some(node))
    }

    /// A white rectangle.
    pub(crate) fn of_rect(rect: Rect) -> Scene {
        let white = usvg::Color::new_rgb(255, 255, 255);
        let geometry = Geometry::of_rect(rect, Affine::IDENTITY);
        let shape = Shape { geometry, paint: Paint::flat(white, 1.0), clip: None, group: 0 };
        convert::of_shapes(vec![shape])
    }

    /// The groups around and including this one, from the picture inwards.
    pub(crate) fn group_path(&self, group: GroupId) -> Vec<GroupId> {
        let mut path = vec![group];
        while let Some(&inner) = path.last().filter(|&&inner| inner != 0) {
            path.push(self.groups[inner as usize].parent);
        }
        path.reverse();
        path
    }

    /// How deep rasters lie within one another; 0 where there is none.
    pub(crate) fn raster_depth(&self) -> usize {
        let depth = |shape: &Shape| match &shape.paint {
            Paint::Raster(raster) => 1 + raster.depth_within(),
            _ => 0,
        };
        self.shapes.iter().map(depth).max().unwrap_or(0)
    }

    /// The same drawing with masks, blend modes and isolated groups as groups of shapes, for methods that
    /// composite region by region; `None` when it has none, or has them that way.
    pub(crate) fn unfolded(&self) -> Option<Scene> {
        unfold::unfolded(self)
    }

    /// Other shapes, with this scene's clips and groups.
    pub(crate) fn with_shapes(&self, shapes: Vec<Shape>) -> Scene {
        let (clips, groups) = (self.clips.clone(), self.groups.clone());
        Scene { shapes, clips, groups, ..convert::of_shapes(Vec::new()) }
    }

    /// # Errors
    /// [`Error::Setting`] when the scene calls for more than the method named can draw.
    pub(crate) fn refuse_rasters(&self, method: &str) -> Result<(), Error> {
        let has_rasters = self.shapes.iter().any(|shape| matches!(shape.paint, Paint::Raster(_)));
        match has_rasters {
            false => Ok(()),
            true => Err(Error::Setting(format!(
                "the method {method} draws no filters, masks, blend modes and patterns: use another method"
            ))),
        }
    }

    /// Width and height of the drawing in user units (CSS px).
    pub fn size(&self) -> Size {
        self.size
    }

    /// The smallest rectangle around all that is drawn, strokes included, in user units; `None` for
    /// a drawing with nothing in it.
    pub fn bounding_box(&self) -> Option<Rect> {
        self.bounding_box
    }

    /// What the drawing calls for and is not drawn, one entry a kind.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
