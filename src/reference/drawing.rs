//! Takes a [`usvg::Tree`], makes a [`Drawing`]: all its outlines as straight segments in pixels,
//! the painted shapes in depth order (the back first), their groups and clip-paths.

use super::clip::{Clip, ClipShape, Clips, Cover};
use super::outline::{self, Segment};
use super::paint::Brush;
use super::{pattern, stroke, Options};
use crate::Viewport;
use kurbo::{Affine, BezPath, Rect, Shape};
use std::collections::HashMap;
use usvg::{BlendMode, FillRule, Group, MaskType, Node, Paint, PaintOrder, Path};

/// A drawing, ready for the sweep. Geometries are numbered in depth order, the back first; those of
/// clip-paths stand in between and have no paint.
#[derive(Default)]
pub(super) struct Drawing {
    /// Sorted by geometry.
    pub(super) segments: Vec<Segment>,
    pub(super) geometries: Vec<Geometry>,
    pub(super) layers: Vec<Layer>,
    pub(super) clips: Clips,
}

/// The inside of one outline.
pub(super) struct Geometry {
    pub(super) rule: FillRule,
    /// A pixel belongs to it whole if its centre does.
    pub(super) jagged: bool,
    /// What it is painted with; `None`: it belongs to a clip-path.
    pub(super) brush: Option<Brush>,
    /// The innermost group that it is composited in.
    pub(super) layer: Option<u32>,
}

/// A group which is composited apart: it has opacity below 1, a clip-path, a mask or a blend mode.
pub(super) struct Layer {
    /// From the outermost to this one.
    pub(super) chain: Vec<u32>,
    pub(super) role: Role,
    pub(super) opacity: f64,
    pub(super) clip: Option<u32>,
    /// Its last child is a mask.
    pub(super) is_masked: bool,
}

/// What comes of a layer.
#[derive(Clone, Copy)]
pub(super) enum Role {
    /// It is drawn onto what lies behind it.
    Content(BlendMode),
    /// It tells how much shows of the layer around it.
    Mask(MaskType),
}

impl Layer {
    /// Whether what is opaque in it hides what lies behind it.
    fn is_plain(&self) -> bool {
        matches!(self.role, Role::Content(BlendMode::Normal)) && self.opacity >= 1.0 && !self.is_masked
    }
}

impl Geometry {
    /// Whether `winding` means inside.
    pub(super) fn holds(&self, winding: i32) -> bool {
        match self.rule {
            FillRule::NonZero => winding != 0,
            FillRule::EvenOdd => winding % 2 != 0,
        }
    }
}

impl Drawing {
    pub(super) fn from_tree(tree: &usvg::Tree, viewport: &Viewport, options: &Options) -> Drawing {
        let mut builder = Builder {
            drawing: Drawing::default(),
            known_clips: HashMap::new(),
            width: viewport.width as f64,
            height: viewport.height as f64,
            options,
        };
        builder.children(tree.root(), viewport.transform, None);
        builder.drawing
    }

    /// The groups that a geometry is composited in, the outermost first.
    pub(super) fn chain(&self, geometry: u32) -> &[u32] {
        match self.geometries[geometry as usize].layer {
            Some(layer) => &self.layers[layer as usize].chain,
            None => &[],
        }
    }

    /// How the clip-paths of all a geometry's groups together stand to a region.
    pub(super) fn clip_cover(&self, geometry: u32, covers: &[Cover]) -> Cover {
        let mut cover = Cover::Inside;
        for &layer in self.chain(geometry) {
            if let Some(clip) = self.layers[layer as usize].clip {
                cover = cover.min(self.clips.cover(clip, covers));
                if cover == Cover::Outside {
                    break;
                }
            }
        }
        cover
    }

    /// Whether a geometry hides all behind it, where it covers and its clips let it.
    pub(super) fn is_opaque(&self, geometry: u32) -> bool {
        let brush = self.geometries[geometry as usize].brush.as_ref();
        brush.is_some_and(Brush::is_opaque)
            && self.chain(geometry).iter().all(|&layer| self.layers[layer as usize].is_plain())
    }
}

struct Builder<'a> {
    drawing: Drawing,
    /// By the clip-path's address and the transform of the element that refers to it.
    known_clips: HashMap<(usize, [u64; 6]), u32>,
    width: f64,
    height: f64,
    options: &'a Options,
}

impl Builder<'_> {
    fn children(&mut self, group: &Group, transform: Affine, layer: Option<u32>) {
        for node in group.children() {
            match node {
                Node::Group(child) => self.group(child, transform, layer),
                Node::Path(path) if path.is_visible() => self.path(path, transform, layer),
                Node::Text(text) => self.group(text.flattened(), transform, layer),
                Node::Image(image) if image.is_visible() => {
                    if let usvg::ImageKind::SVG(tree) = image.kind() {
                        self.group(tree.root(), transform, layer);
                    }
                }
                Node::Path(_) | Node::Image(_) => {}
            }
        }
    }

    fn group(&mut self, group: &Group, transform: Affine, parent: Option<u32>) {
        let transform = transform * affine(group.transform());
        if !group.should_isolate() {
            return self.children(group, transform, parent);
        }
        let clip = group.clip_path().map(|clip| self.clip(clip, transform));
        let layer = self.layer(Layer {
            chain: self.chain(parent),
            role: Role::Content(group.blend_mode()),
            opacity: f64::from(group.opacity().get()),
            clip,
            is_masked: group.mask().is_some(),
        });
        self.children(group, transform, Some(layer));
        if let Some(mask) = group.mask() {
            self.mask(mask, transform, layer);
        }
    }

    /// A mask of a group, after all that the group shows.
    fn mask(&mut self, mask: &usvg::Mask, transform: Affine, masked: u32) {
        let clip = self.clip_to_rect(rect(mask.rect()), transform);
        let layer = self.layer(Layer {
            chain: self.chain(Some(masked)),
            role: Role::Mask(mask.kind()),
            opacity: 1.0,
            clip: Some(clip),
            is_masked: mask.mask().is_some(),
        });
        self.children(mask.root(), transform, Some(layer));
        if let Some(within) = mask.mask() {
            self.mask(within, transform, layer);
        }
    }

    fn chain(&self, layer: Option<u32>) -> Vec<u32> {
        layer.map_or(Vec::new(), |layer| self.drawing.layers[layer as usize].chain.clone())
    }

    /// Adds a layer, of which `chain` is still that of the one around it.
    fn layer(&mut self, mut layer: Layer) -> u32 {
        let number = self.drawing.layers.len() as u32;
        layer.chain.push(number);
        self.drawing.layers.push(layer);
        number
    }

    /// A group which is nothing but clipped and faded.
    fn plain_layer(&mut self, around: Option<u32>, clip: u32, opacity: f64) -> u32 {
        let chain = self.chain(around);
        let role = Role::Content(BlendMode::Normal);
        self.layer(Layer { chain, role, opacity, clip: Some(clip), is_masked: false })
    }

    fn path(&mut self, path: &Path, transform: Affine, layer: Option<u32>) {
        match path.paint_order() {
            PaintOrder::FillAndStroke => {
                self.fill(path, transform, layer);
                self.stroke(path, transform, layer);
            }
            PaintOrder::StrokeAndFill => {
                self.stroke(path, transform, layer);
                self.fill(path, transform, layer);
            }
        }
    }

    fn fill(&mut self, path: &Path, transform: Affine, layer: Option<u32>) {
        let Some(fill) = path.fill() else { return };
        let outline = transform * outline::bez_path(path.data());
        let geometry = Geometry { rule: fill.rule(), jagged: is_jagged(path), brush: None, layer };
        let bounds = path.bounding_box();
        self.paint(geometry, &outline, (fill.paint(), fill.opacity(), bounds), transform);
    }

    fn stroke(&mut self, path: &Path, transform: Affine, layer: Option<u32>) {
        let Some(stroke) = path.stroke() else { return };
        let outline = stroke::outline(path.data(), stroke, transform, self.options);
        let geometry = Geometry { rule: FillRule::NonZero, jagged: is_jagged(path), brush: None, layer };
        let bounds = path.stroke_bounding_box();
        self.paint(geometry, &outline, (stroke.paint(), stroke.opacity(), bounds), transform);
    }

    /// Paints a geometry whose box in user units is `bounds`.
    fn paint(
        &mut self,
        geometry: Geometry,
        outline: &BezPath,
        (paint, opacity, bounds): (&Paint, usvg::Opacity, usvg::Rect),
        transform: Affine,
    ) {
        if let Paint::Pattern(pattern) = paint {
            let around = geometry.layer;
            let clip = self.clip_to(Geometry { layer: None, ..geometry }, outline);
            let layer = self.plain_layer(around, clip, f64::from(opacity.get()));
            self.tiles(pattern, bounds, transform, layer);
        } else if let Some(brush) = Brush::new(paint, opacity, transform) {
            self.add(Geometry { brush: Some(brush), ..geometry }, outline);
        }
    }

    /// All tiles of a pattern that may show within `bounds`, each clipped to its rectangle.
    fn tiles(&mut self, pattern: &usvg::Pattern, bounds: usvg::Rect, transform: Affine, layer: u32) {
        if pattern::is_too_much(pattern, bounds) {
            return;
        }
        let (tile, places) = pattern::tiles(pattern, bounds);
        let seen = Rect::new(0.0, 0.0, self.width, self.height);
        for place in places {
            let transform = transform * affine(pattern.transform()) * Affine::translate(place);
            if transform.transform_rect_bbox(tile).overlaps(seen) {
                let clip = self.clip_to_rect(tile, transform);
                let layer = self.plain_layer(Some(layer), clip, 1.0);
                self.children(pattern.root(), transform, Some(layer));
            }
        }
    }

    fn clip_to_rect(&mut self, rect: Rect, transform: Affine) -> u32 {
        let geometry = Geometry { rule: FillRule::NonZero, jagged: false, brush: None, layer: None };
        self.clip_to(geometry, &(transform * rect.to_path(0.0)))
    }

    /// A clip-path of one shape.
    fn clip_to(&mut self, geometry: Geometry, outline: &BezPath) -> u32 {
        let shapes = vec![ClipShape { geometry: self.add(geometry, outline), within: Vec::new() }];
        self.drawing.clips.all.push(Clip { shapes, within: None });
        self.drawing.clips.all.len() as u32 - 1
    }

    /// `outline` in pixels. A geometry which cannot touch the picture gets no segments.
    fn add(&mut self, geometry: Geometry, outline: &BezPath) -> u32 {
        let number = self.drawing.geometries.len() as u32;
        self.drawing.geometries.push(geometry);
        outline::segments(outline, self.options.tolerance, |segment| {
            let seen = segment.y_bottom > 0.0
                && segment.y_top < self.height
                && segment.x_top.min(segment.x_bottom) < self.width;
            if seen {
                self.drawing.segments.push(Segment { geometry: number, ..segment });
            }
        });
        number
    }

    /// A clip-path, as referred to by an element whose user space is `transform`.
    fn clip(&mut self, clip: &usvg::ClipPath, transform: Affine) -> u32 {
        let key = (std::ptr::from_ref(clip) as usize, transform.as_coeffs().map(f64::to_bits));
        if let Some(&known) = self.known_clips.get(&key) {
            return known;
        }
        let within = clip.clip_path().map(|outer| self.clip(outer, transform));
        let mut shapes = Vec::new();
        self.clip_children(clip.root(), transform * affine(clip.transform()), &[], &mut shapes);
        let number = self.drawing.clips.all.len() as u32;
        self.drawing.clips.all.push(Clip { shapes, within });
        self.known_clips.insert(key, number);
        number
    }

    fn clip_children(
        &mut self,
        group: &Group,
        transform: Affine,
        within: &[u32],
        shapes: &mut Vec<ClipShape>,
    ) {
        for node in group.children() {
            match node {
                Node::Path(path) if path.is_visible() => {
                    let Some(fill) = path.fill() else { continue };
                    let outline = transform * outline::bez_path(path.data());
                    let jagged = is_jagged(path);
                    let geometry = Geometry { rule: fill.rule(), jagged, brush: None, layer: None };
                    let geometry = self.add(geometry, &outline);
                    shapes.push(ClipShape { geometry, within: within.to_vec() });
                }
                Node::Group(child) => self.clip_group(child, transform, within, shapes),
                Node::Text(text) => self.clip_group(text.flattened(), transform, within, shapes),
                Node::Path(_) | Node::Image(_) => {}
            }
        }
    }

    fn clip_group(&mut self, group: &Group, transform: Affine, within: &[u32], shapes: &mut Vec<ClipShape>) {
        let transform = transform * affine(group.transform());
        let mut within = within.to_vec();
        if let Some(clip) = group.clip_path() {
            within.push(self.clip(clip, transform));
        }
        self.clip_children(group, transform, &within, shapes);
    }
}

fn is_jagged(path: &Path) -> bool {
    !path.rendering_mode().use_shape_antialiasing()
}

/// The same rectangle in f64.
fn rect(r: usvg::NonZeroRect) -> Rect {
    Rect::new(r.left().into(), r.top().into(), r.right().into(), r.bottom().into())
}

/// The same transform in f64.
pub(super) fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}
