//! Takes a [`usvg::Tree`], makes a list of what the truth leaves out and what kind of edges it has.

use super::pattern;
use usvg::tiny_skia_path::PathSegment;
use usvg::{Group, Node, Paint, Path, Pattern};

/// Something in the drawing which the truth does not draw as SVG says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported {
    /// In the plural: `filters`, `images`, `patterns of very many tiles`.
    pub kind: &'static str,
    /// The first element's id, which may be empty.
    pub element: String,
    /// How many elements have it.
    pub count: usize,
}

/// What the drawing calls for and the truth leaves out, one entry a kind; empty: the truth is whole.
pub fn unsupported(tree: &usvg::Tree) -> Vec<Unsupported> {
    let mut found: Vec<Unsupported> = Vec::new();
    let mut note = |kind: &'static str, id: &str| match found.iter_mut().find(|f| f.kind == kind) {
        Some(known) => known.count += 1,
        None => found.push(Unsupported { kind, element: id.to_owned(), count: 1 }),
    };
    visit(tree.root(), &mut |item| match item {
        Item::Group(group) => {
            if !group.filters().is_empty() {
                note("filters", name(group));
            }
        }
        Item::Path(path) => {
            if patterns(path).any(|(pattern, bounds)| pattern::is_too_much(pattern, bounds)) {
                note("patterns of very many tiles", path.id());
            }
        }
        Item::Image(id) => note("images", id),
    });
    found
}

/// Whether a visible path has a linear or radial gradient.
pub fn has_gradients(tree: &usvg::Tree) -> bool {
    let mut found = false;
    visit(tree.root(), &mut |item| {
        if let Item::Path(path) = item {
            found |= paints(path)
                .any(|paint| matches!(paint, Paint::LinearGradient(_) | Paint::RadialGradient(_)));
        }
    });
    found
}

/// Whether nothing in the drawing or in its clips has a curve or a stroke.
pub fn edges_are_straight(tree: &usvg::Tree) -> bool {
    let mut straight = true;
    let mut look = |item: Item<'_>| {
        if let Item::Path(path) = item {
            let curved = path
                .data()
                .segments()
                .any(|s| matches!(s, PathSegment::QuadTo(..) | PathSegment::CubicTo(..)));
            straight &= !curved && path.stroke().is_none();
        }
    };
    visit(tree.root(), &mut look);
    for clip in tree.clip_paths() {
        visit(clip.root(), &mut look);
    }
    straight
}

/// The group's id, or the first below it: usvg keeps a shape's id and wraps it in a nameless group.
fn name(group: &Group) -> &str {
    let inside = || {
        group.children().iter().map(|node| match node {
            Node::Group(child) => name(child),
            other => other.id(),
        })
    };
    if group.id().is_empty() {
        inside().find(|id| !id.is_empty()).unwrap_or_default()
    } else {
        group.id()
    }
}

enum Item<'a> {
    Group(&'a Group),
    Path(&'a Path),
    Image(&'a str),
}

/// Every group, visible path and visible image below `group`, in masks, tiles of patterns and images that
/// are drawings as well.
fn visit<'a>(group: &'a Group, look: &mut impl FnMut(Item<'a>)) {
    for node in group.children() {
        match node {
            Node::Group(child) => visit_with_masks(child, look),
            Node::Path(path) if path.is_visible() => {
                look(Item::Path(path));
                let drawn =
                    |&(pattern, bounds): &(&'a Pattern, usvg::Rect)| !pattern::is_too_much(pattern, bounds);
                patterns(path).filter(drawn).for_each(|(pattern, _)| visit(pattern.root(), look));
            }
            Node::Image(image) if image.is_visible() => match image.kind() {
                usvg::ImageKind::SVG(tree) => visit_with_masks(tree.root(), look),
                _ => look(Item::Image(image.id())),
            },
            Node::Text(text) => visit_with_masks(text.flattened(), look),
            _ => {}
        }
    }
}

fn visit_with_masks<'a>(group: &'a Group, look: &mut impl FnMut(Item<'a>)) {
    look(Item::Group(group));
    visit(group, look);
    std::iter::successors(group.mask(), |mask| mask.mask()).for_each(|mask| visit(mask.root(), look));
}

fn paints(path: &Path) -> impl Iterator<Item = &Paint> {
    path.fill().map(|f| f.paint()).into_iter().chain(path.stroke().map(|s| s.paint()))
}

/// The patterns that a path is painted with, and the boxes that they paint.
pub(super) fn patterns(path: &Path) -> impl Iterator<Item = (&Pattern, usvg::Rect)> {
    let fill = path.fill().map(|fill| (fill.paint(), path.bounding_box()));
    let stroke = path.stroke().map(|stroke| (stroke.paint(), path.stroke_bounding_box()));
    fill.into_iter().chain(stroke).filter_map(|(paint, bounds)| match paint {
        Paint::Pattern(pattern) => Some((&**pattern, bounds)),
        _ => None,
    })
}
