//! Takes a [`usvg::Tree`], makes a list of what the truth leaves out and what kind of edges it has.

use usvg::tiny_skia_path::PathSegment;
use usvg::{Group, Node, Paint, Path};

/// Something in the drawing which the truth does not draw as SVG says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported {
    /// In the plural: `masks`, `filters`, `patterns`, `images`, `blend modes`.
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
            if group.mask().is_some() {
                note("masks", name(group));
            }
            if !group.filters().is_empty() {
                note("filters", name(group));
            }
            if group.blend_mode() != usvg::BlendMode::Normal {
                note("blend modes", name(group));
            }
        }
        Item::Path(path) => {
            if paints(path).any(|paint| matches!(paint, Paint::Pattern(_))) {
                note("patterns", path.id());
            }
        }
        Item::Image(id) => note("images", id),
    });
    found
}

/// Whether a visible path has a linear or radial gradient: there the truth is approximate.
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

/// Every group, visible path and visible image below `group`, in images that are drawings as well.
fn visit<'a>(group: &'a Group, look: &mut impl FnMut(Item<'a>)) {
    for node in group.children() {
        match node {
            Node::Group(child) => {
                look(Item::Group(child));
                visit(child, look);
            }
            Node::Path(path) if path.is_visible() => look(Item::Path(path)),
            Node::Image(image) if image.is_visible() => match image.kind() {
                usvg::ImageKind::SVG(tree) => {
                    look(Item::Group(tree.root()));
                    visit(tree.root(), look);
                }
                _ => look(Item::Image(image.id())),
            },
            Node::Text(text) => {
                look(Item::Group(text.flattened()));
                visit(text.flattened(), look);
            }
            _ => {}
        }
    }
}

fn paints(path: &Path) -> impl Iterator<Item = &Paint> {
    path.fill().map(|f| f.paint()).into_iter().chain(path.stroke().map(|s| s.paint()))
}
