//! Takes usvg's tree, makes a [`Scene`]: walks it once, back to front, with the transform, clip and
//! group that hold at each node.

mod rasters;

use super::images::Images;
use super::paint::{Gradient, GradientShape, Paint, Spread, Stop};
use super::parts::CUT_ID;
use super::print::{self, Print};
use super::raster::{Raster, Source};
use super::{
    Clip, ClipId, ClipMember, FillRule, Geometry, Group, GroupId, Outline, Role, Scene, Shape, StrokeStyle,
    Warning,
};
use crate::{texture, Error};
use kurbo::{Affine, Rect, Size};
use std::collections::HashMap;
use std::sync::Arc;

/// Groups with opacity, masks and blend modes nested deeper than this are refused, filters and patterns
/// counted too: each open one holds a strip of the picture, a mask a second one.
const DEEPEST_GROUP: usize = 256;

/// The scene of `tree`, or of one node of it.
pub(super) fn scene(tree: &usvg::Tree, node: Option<&usvg::Node>) -> Result<Scene, Error> {
    let mut walk = Walk::default();
    let place = Place { transform: Affine::IDENTITY, clip: None, group: 0, depth: 0 };
    let bounds = match node {
        None => {
            walk.group(tree.root(), place)?;
            tree.root().abs_stroke_bounding_box()
        }
        Some(node) => {
            // A group's own transform is applied as the walk enters it; a path has none of its own.
            let own = match node {
                usvg::Node::Group(group) => affine(group.transform()),
                _ => Affine::IDENTITY,
            };
            let transform = affine(node.abs_transform()) * own.inverse();
            walk.node(node, Place { transform, ..place })?;
            if walk.shapes.is_empty() {
                return Err(Error::Element(format!("the element with id '{}' draws nothing", node.id())));
            }
            node.abs_stroke_bounding_box()
        }
    };
    let bounds =
        Rect::new(bounds.left().into(), bounds.top().into(), bounds.right().into(), bounds.bottom().into());
    Ok(Scene {
        size: Size::new(tree.size().width().into(), tree.size().height().into()),
        bounding_box: (!walk.shapes.is_empty()).then_some(bounds),
        warnings: walk.warnings,
        shapes: walk.shapes,
        clips: walk.clips,
        groups: walk.groups,
        prints: Vec::new(),
        texts: walk.texts,
    })
}

/// What holds where the walk stands.
#[derive(Clone, Copy)]
struct Place {
    /// From the node's coordinates to the scene's user units.
    transform: Affine,
    clip: Option<ClipId>,
    group: GroupId,
    /// As [`DEEPEST_GROUP`] counts: groups around the node, also those around the drawing it is in.
    depth: usize,
}

pub(super) struct Walk {
    pub shapes: Vec<Shape>,
    pub clips: Vec<Clip>,
    /// By the element in usvg's tree, the transform where it applies, and the clip outside it.
    known_clips: HashMap<(usize, [u64; 6], Option<ClipId>), ClipId>,
    /// By content, and what that is.
    printed_clips: HashMap<Print, ClipId>,
    clip_prints: Vec<Print>,
    pub groups: Vec<Group>,
    pub texts: usize,
    pub warnings: Vec<Warning>,
    /// Shapes and groups before each cut ([`super::parts`]).
    pub cuts: Vec<(usize, usize)>,
    /// Images, by their bytes.
    images: HashMap<Arc<Vec<u8>>, Option<Arc<texture::Image>>>,
    /// Those of other drawings as well.
    shared: Arc<Images>,
    /// What feImages show, by what they refer to in usvg's tree.
    filter_images: HashMap<usize, Arc<Scene>>,
    /// Rasters around the walk.
    nesting: usize,
    /// Those of them that are filters or patterns.
    layers: usize,
    /// Contents of rasters so far.
    contents: usize,
    /// Shapes drawn before the walk, in the drawings around it.
    before: usize,
    /// The id nearest around the walk.
    around: String,
    /// The last group's id: usvg puts an image's own on a group around it.
    last_id: String,
}

impl Default for Walk {
    fn default() -> Self {
        let picture = Group { parent: 0, opacity: 1.0, role: Role::Paint };
        Walk {
            shapes: Vec::new(),
            clips: Vec::new(),
            known_clips: HashMap::new(),
            printed_clips: HashMap::new(),
            clip_prints: Vec::new(),
            groups: vec![picture],
            texts: 0,
            warnings: Vec::new(),
            cuts: Vec::new(),
            images: HashMap::new(),
            shared: Arc::default(),
            filter_images: HashMap::new(),
            nesting: 0,
            layers: 0,
            contents: 0,
            before: 0,
            around: String::new(),
            last_id: String::new(),
        }
    }
}

impl Walk {
    /// Through a whole tree, which may have images of others.
    pub fn of(tree: &usvg::Tree, shared: &Arc<Images>) -> Result<Walk, Error> {
        let mut walk = Walk { shared: shared.clone(), ..Walk::default() };
        let place = Place { transform: Affine::IDENTITY, clip: None, group: 0, depth: 0 };
        walk.group(tree.root(), place)?;
        Ok(walk)
    }

    fn node(&mut self, node: &usvg::Node, place: Place) -> Result<(), Error> {
        match node {
            usvg::Node::Group(group) => self.group(group, place),
            usvg::Node::Path(path) => self.path(path, place),
            usvg::Node::Text(text) => {
                self.texts += usize::from(text.flattened().has_children());
                self.group(text.flattened(), place)
            }
            usvg::Node::Image(image) if image.is_visible() => self.image(image, place),
            usvg::Node::Image(_) => Ok(()),
        }
    }

    fn group(&mut self, group: &usvg::Group, mut place: Place) -> Result<(), Error> {
        if group.id() == CUT_ID && self.nesting == 0 {
            self.cuts.push((self.shapes.len(), self.groups.len()));
            return Ok(());
        }
        place.transform *= affine(group.transform());
        self.last_id.clear();
        self.last_id.push_str(group.id());
        if let Some(clip) = group.clip_path() {
            place.clip = Some(self.clip(clip, place.transform, place.clip));
        }
        if is_raster(group) {
            return self.raster(group, place);
        }
        let opacity = group.opacity().get();
        if opacity >= 1.0 {
            return group.children().iter().try_for_each(|child| self.node(child, place));
        }
        let depth = self.deeper(place.depth, 1, group.id())?;
        let (first_shape, first_group) = (self.shapes.len(), self.groups.len());
        self.groups.push(Group { parent: place.group, opacity, role: Role::Paint });
        let inside = Place { group: first_group as GroupId, depth, ..place };
        group.children().iter().try_for_each(|child| self.node(child, inside))?;
        // A group of one shape is that shape with less opacity: nothing in it can overlap.
        if let [only] = &mut self.shapes[first_shape..] {
            if self.groups.len() == first_group + 1 {
                only.paint.fade(opacity);
                only.group = place.group;
                self.groups.pop();
            }
        }
        Ok(())
    }

    /// How deep it is within some more groups, the innermost with this id.
    fn deeper(&self, depth: usize, more: usize, id: &str) -> Result<usize, Error> {
        match depth + more {
            depth if depth <= DEEPEST_GROUP => Ok(depth),
            _ => Err(Error::Limit(format!(
                "groups with opacity, blend modes and masks, which count twice, are nested more than \
                 {DEEPEST_GROUP} deep at {} (flatten them)",
                self.name(id)
            ))),
        }
    }

    fn into_scene(self) -> Scene {
        let Walk { shapes, clips, groups, texts, warnings, .. } = self;
        let (size, bounding_box, prints) = (Size::ZERO, None, Vec::new());
        Scene { size, bounding_box, warnings, shapes, clips, groups, prints, texts }
    }

    fn path(&mut self, path: &usvg::Path, place: Place) -> Result<(), Error> {
        if !path.is_visible() {
            return Ok(());
        }
        let data = Arc::new(path.data().clone());
        let crisp = !path.rendering_mode().use_shape_antialiasing();
        let shape = |outline, paint| {
            let geometry = Geometry { path: data.clone(), transform: place.transform, outline, crisp };
            Shape { geometry, paint, clip: place.clip, group: place.group }
        };
        let mut fill = None;
        if let Some(style) = path.fill() {
            let paint = self.paint(style.paint(), style.opacity().get(), place.transform, place.depth)?;
            fill = paint.map(|paint| shape(fill_outline(style), paint));
        }
        let mut stroke = None;
        if let Some(style) = path.stroke() {
            let paint = self.paint(style.paint(), style.opacity().get(), place.transform, place.depth)?;
            stroke = paint.map(|paint| shape(stroke_outline(style), paint));
        }
        match path.paint_order() {
            usvg::PaintOrder::FillAndStroke => self.shapes.extend(fill.into_iter().chain(stroke)),
            usvg::PaintOrder::StrokeAndFill => self.shapes.extend(stroke.into_iter().chain(fill)),
        }
        Ok(())
    }

    /// The paint in pixels' terms, or `None` when nothing would be seen of it.
    fn paint(
        &mut self,
        paint: &usvg::Paint,
        opacity: f32,
        transform: Affine,
        depth: usize,
    ) -> Result<Option<Paint>, Error> {
        let paint = match paint {
            usvg::Paint::Color(color) => Some(Paint::flat(*color, opacity)),
            usvg::Paint::LinearGradient(linear) => {
                let shape = GradientShape::linear(
                    (linear.x1().into(), linear.y1().into()),
                    (linear.x2().into(), linear.y2().into()),
                );
                gradient(linear, shape, opacity, transform)
            }
            usvg::Paint::RadialGradient(radial) => {
                let shape = GradientShape::radial(
                    (radial.fx().into(), radial.fy().into(), radial.fr().get().into()),
                    (radial.cx().into(), radial.cy().into(), radial.r().get().into()),
                );
                gradient(radial, shape, opacity, transform)
            }
            usvg::Paint::Pattern(pattern) => {
                let corner = rect(pattern.rect());
                let tile = Rect::new(0.0, 0.0, corner.width(), corner.height());
                let transform =
                    transform * affine(pattern.transform()) * Affine::translate(corner.origin().to_vec2());
                let content = self.content(pattern.root(), depth, true)?;
                let source = Source::Tiles(Box::new(content), tile);
                Some(Paint::Raster(Arc::new(Raster { source, transform, bounds: tile, opacity })))
            }
        };
        Ok(paint.filter(|paint| !paint.is_invisible()))
    }

    /// The clip's number. Where the same one applies to many elements, as plotting programs write it, or one
    /// like it, they share it.
    fn clip(&mut self, clip: &usvg::ClipPath, transform: Affine, outer: Option<ClipId>) -> ClipId {
        let key = (std::ptr::from_ref(clip) as usize, transform.as_coeffs().map(f64::to_bits), outer);
        if let Some(&known) = self.known_clips.get(&key) {
            return known;
        }
        let own = clip.clip_path().map(|own| self.clip(own, transform, None));
        let mut members = Vec::new();
        self.clip_members(clip.root(), transform * affine(clip.transform()), None, &mut members);
        let clip = Clip { members, within: outer.into_iter().chain(own).collect() };
        let print = print::of_clip(&clip, &self.clip_prints);
        let number = *self.printed_clips.entry(print).or_insert_with(|| {
            self.clips.push(clip);
            self.clip_prints.push(print);
            (self.clips.len() - 1) as ClipId
        });
        self.known_clips.insert(key, number);
        number
    }

    fn clip_members(
        &mut self,
        parent: &usvg::Group,
        transform: Affine,
        clip: Option<ClipId>,
        members: &mut Vec<ClipMember>,
    ) {
        for child in parent.children() {
            match child {
                usvg::Node::Path(path) if path.is_visible() => {
                    if let Some(fill) = path.fill() {
                        let crisp = !path.rendering_mode().use_shape_antialiasing();
                        let path = Arc::new(path.data().clone());
                        let geometry = Geometry { path, transform, outline: fill_outline(fill), crisp };
                        members.push(ClipMember { geometry, clip });
                    }
                }
                usvg::Node::Group(group) => self.clip_group(group, transform, clip, members),
                usvg::Node::Text(text) => {
                    self.texts += usize::from(text.flattened().has_children());
                    self.clip_group(text.flattened(), transform, clip, members);
                }
                usvg::Node::Path(_) | usvg::Node::Image(_) => {}
            }
        }
    }

    fn clip_group(
        &mut self,
        group: &usvg::Group,
        transform: Affine,
        clip: Option<ClipId>,
        members: &mut Vec<ClipMember>,
    ) {
        let transform = transform * affine(group.transform());
        let clip = group.clip_path().map(|own| self.clip(own, transform, clip)).or(clip);
        self.clip_members(group, transform, clip, members);
    }

    fn warn(&mut self, kind: &'static str, id: &str) {
        self.warn_of(kind, self.name(id));
    }

    fn warn_of(&mut self, kind: &'static str, element: String) {
        if let Some(warning) = self.warnings.iter_mut().find(|w| w.kind == kind) {
            warning.count += 1;
            return;
        }
        self.warnings.push(Warning { kind, element, count: 1 });
    }

    /// What messages call the element where the walk stands.
    fn name(&self, id: &str) -> String {
        match id {
            "" => {
                let before = self.before + self.shapes.len();
                match &self.around[..] {
                    "" => format!("an element without id, behind {before} drawn shapes"),
                    around => {
                        format!(
                            "an element without id within element '{around}', behind {before} drawn shapes"
                        )
                    }
                }
            }
            _ => format!("element '{id}'"),
        }
    }
}

/// A scene of these shapes alone.
pub(super) fn of_shapes(shapes: Vec<Shape>) -> Scene {
    Walk { shapes, ..Walk::default() }.into_scene()
}

/// Is a group made into pixels before it is painted?
fn is_raster(group: &usvg::Group) -> bool {
    group.mask().is_some()
        || !group.filters().is_empty()
        || group.blend_mode() != usvg::BlendMode::Normal
        || (group.should_isolate() && blends_inside(group))
}

/// Does anything blend with what lies below it in this group?
fn blends_inside(group: &usvg::Group) -> bool {
    group.children().iter().any(|child| match child {
        usvg::Node::Group(inner) => {
            inner.blend_mode() != usvg::BlendMode::Normal || (!inner.should_isolate() && blends_inside(inner))
        }
        _ => false,
    })
}

fn rect(rect: usvg::NonZeroRect) -> Rect {
    Rect::new(rect.left().into(), rect.top().into(), rect.right().into(), rect.bottom().into())
}

fn fill_outline(fill: &usvg::Fill) -> Outline {
    Outline::Fill(match fill.rule() {
        usvg::FillRule::NonZero => FillRule::NonZero,
        usvg::FillRule::EvenOdd => FillRule::EvenOdd,
    })
}

fn stroke_outline(stroke: &usvg::Stroke) -> Outline {
    let join = match stroke.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => kurbo::Join::Miter,
        usvg::LineJoin::Round => kurbo::Join::Round,
        usvg::LineJoin::Bevel => kurbo::Join::Bevel,
    };
    let cap = match stroke.linecap() {
        usvg::LineCap::Butt => kurbo::Cap::Butt,
        usvg::LineCap::Round => kurbo::Cap::Round,
        usvg::LineCap::Square => kurbo::Cap::Square,
    };
    let pen = kurbo::Stroke::new(stroke.width().get().into())
        .with_join(join)
        .with_caps(cap)
        .with_miter_limit(stroke.miterlimit().get().into());
    let line = match stroke.dasharray() {
        Some(dashes) => pen.with_dashes(stroke.dashoffset().into(), dashes.iter().map(|&d| f64::from(d))),
        None => pen,
    };
    let clips_miters = stroke.linejoin() == usvg::LineJoin::MiterClip;
    Outline::Stroke(Arc::new(StrokeStyle { line, clips_miters }))
}

fn gradient(
    base: &usvg::BaseGradient,
    shape: GradientShape,
    opacity: f32,
    transform: Affine,
) -> Option<Paint> {
    let stops = base
        .stops()
        .iter()
        .map(|stop| Stop::new(stop.offset().get(), stop.color(), stop.opacity().get() * opacity))
        .collect();
    let spread = match base.spread_method() {
        usvg::SpreadMethod::Pad => Spread::Pad,
        usvg::SpreadMethod::Reflect => Spread::Reflect,
        usvg::SpreadMethod::Repeat => Spread::Repeat,
    };
    Gradient::paint(shape, spread, stops, transform * affine(base.transform()))
}

fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}
