//! Takes a parsed drawing, makes a list of vello_cpu commands, and plays it.
//!
//! Translating (paths into kurbo's, paints into peniko's) happens once and is not timed; playing the
//! list is: vello_cpu flattens, strokes and makes strips while commands arrive.

use resvg::usvg;
use vello_cpu::color::{AlphaColor, DynamicColor, Srgb};
use vello_cpu::kurbo::{Affine, BezPath, Cap, Join, Point, Stroke};
use vello_cpu::peniko::{
    ColorStop, ColorStops, Extend, Fill, Gradient, InterpolationAlphaSpace, LinearGradientPosition,
    RadialGradientPosition,
};
use vello_cpu::{Level, PaintType, PixmapMut, RenderContext, RenderSettings, Resources};

/// What to draw with, and where it is anchored.
struct Paint {
    kind: PaintType,
    /// From gradient space to the path's own space.
    transform: Affine,
}

/// One step of a drawing. Transforms go from the path's space to the drawing's user units.
enum Command {
    Fill { path: BezPath, rule: Fill, paint: Paint, transform: Affine, crisp: bool },
    Stroke { path: BezPath, stroke: Stroke, paint: Paint, transform: Affine, crisp: bool },
    PushClip { path: BezPath, rule: Fill, transform: Affine },
    PushOpacity(f32),
    Pop,
}

/// A drawing as vello_cpu wants it, in user units.
pub struct Commands {
    list: Vec<Command>,
    left_out: Vec<&'static str>,
}

impl Commands {
    /// Translates the whole tree.
    pub fn from_tree(tree: &usvg::Tree) -> Commands {
        let mut commands = Commands { list: Vec::new(), left_out: Vec::new() };
        commands.group(tree.root(), Affine::IDENTITY);
        commands
    }

    /// Kinds of elements that are not translated, so that nobody compares different pictures.
    pub fn left_out(&self) -> &[&'static str] {
        &self.left_out
    }

    fn group(&mut self, group: &usvg::Group, parent: Affine) {
        let transform = parent * affine(group.transform());
        let opacity = group.opacity().get();
        let mut layers = 0;
        if group.mask().is_some() {
            self.leave_out("masks");
        }
        if !group.filters().is_empty() {
            self.leave_out("filters");
        }
        if group.blend_mode() != usvg::BlendMode::Normal {
            self.leave_out("blend modes");
        }
        if opacity < 1.0 {
            self.list.push(Command::PushOpacity(opacity));
            layers += 1;
        }
        let mut clip = group.clip_path();
        while let Some(link) = clip {
            self.clip(link, transform);
            layers += 1;
            clip = link.clip_path();
        }
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => self.group(inner, transform),
                usvg::Node::Text(text) => self.group(text.flattened(), transform),
                usvg::Node::Path(path) => self.path(path, transform),
                usvg::Node::Image(_) => self.leave_out("images"),
            }
        }
        self.list.extend((0..layers).map(|_| Command::Pop));
    }

    /// A clip layer holds one path and one fill rule: the children of a clip-path become one path,
    /// which is their union where they do not overlap or all wind the same way.
    fn clip(&mut self, clip: &usvg::ClipPath, parent: Affine) {
        let mut path = BezPath::new();
        let mut rules = Vec::new();
        let transform = affine(clip.transform());
        self.clip_children(clip.root(), transform, &mut path, &mut rules);
        let rule = rules.first().copied().unwrap_or(Fill::NonZero);
        if rules.iter().any(|r| *r != rule) {
            self.leave_out("clips of mixed fill rules");
        }
        self.list.push(Command::PushClip { path, rule, transform: parent });
    }

    fn clip_children(
        &mut self,
        group: &usvg::Group,
        parent: Affine,
        path: &mut BezPath,
        rules: &mut Vec<Fill>,
    ) {
        let transform = parent * affine(group.transform());
        if group.clip_path().is_some() {
            self.leave_out("clipped children of clips");
        }
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => self.clip_children(inner, transform, path, rules),
                usvg::Node::Text(text) => self.clip_children(text.flattened(), transform, path, rules),
                usvg::Node::Path(shape) => {
                    let Some(fill) = shape.fill().filter(|_| shape.is_visible()) else { continue };
                    path.extend(transform * bez_path(shape.data()));
                    rules.push(fill_rule(fill.rule()));
                }
                usvg::Node::Image(_) => {}
            }
        }
    }

    fn path(&mut self, path: &usvg::Path, transform: Affine) {
        if !path.is_visible() {
            return;
        }
        match path.paint_order() {
            usvg::PaintOrder::FillAndStroke => {
                self.fill(path, transform);
                self.stroke(path, transform);
            }
            usvg::PaintOrder::StrokeAndFill => {
                self.stroke(path, transform);
                self.fill(path, transform);
            }
        }
    }

    fn fill(&mut self, path: &usvg::Path, transform: Affine) {
        let Some(fill) = path.fill() else { return };
        let Some(paint) = self.paint(fill.paint(), fill.opacity()) else { return };
        let rule = fill_rule(fill.rule());
        let crisp = !path.rendering_mode().use_shape_antialiasing();
        self.list.push(Command::Fill { path: bez_path(path.data()), rule, paint, transform, crisp });
    }

    fn stroke(&mut self, path: &usvg::Path, transform: Affine) {
        let Some(stroke) = path.stroke() else { return };
        let Some(paint) = self.paint(stroke.paint(), stroke.opacity()) else { return };
        let crisp = !path.rendering_mode().use_shape_antialiasing();
        self.list.push(Command::Stroke {
            path: bez_path(path.data()),
            stroke: pen(stroke),
            paint,
            transform,
            crisp,
        });
    }

    fn paint(&mut self, paint: &usvg::Paint, opacity: usvg::Opacity) -> Option<Paint> {
        match paint {
            usvg::Paint::Color(c) => {
                let kind = PaintType::Solid(color(*c, opacity));
                Some(Paint { kind, transform: Affine::IDENTITY })
            }
            usvg::Paint::LinearGradient(g) => {
                let kind = LinearGradientPosition::new(
                    (f64::from(g.x1()), f64::from(g.y1())),
                    (f64::from(g.x2()), f64::from(g.y2())),
                );
                Some(gradient(kind.into(), g, opacity))
            }
            usvg::Paint::RadialGradient(g) => {
                let kind = RadialGradientPosition::new_two_point(
                    (f64::from(g.fx()), f64::from(g.fy())),
                    g.fr().get(),
                    (f64::from(g.cx()), f64::from(g.cy())),
                    g.r().get(),
                );
                Some(gradient(kind.into(), g, opacity))
            }
            usvg::Paint::Pattern(_) => {
                self.leave_out("patterns");
                None
            }
        }
    }

    fn leave_out(&mut self, kind: &'static str) {
        if !self.left_out.contains(&kind) {
            self.left_out.push(kind);
        }
    }
}

/// A vello_cpu renderer whose context and buffers are reused from picture to picture.
pub struct Vello {
    context: RenderContext,
    resources: Resources,
    pixels: Vec<u8>,
}

impl Vello {
    /// `threads` counts the calling thread: vello_cpu's own number is that of its extra workers.
    pub fn new(width: u16, height: u16, threads: usize) -> Vello {
        let level = Level::try_detect().unwrap_or(Level::baseline());
        let num_threads = threads.saturating_sub(1) as u16;
        Vello {
            context: RenderContext::new_with(width, height, RenderSettings { level, num_threads }),
            resources: Resources::new(),
            pixels: vec![0; usize::from(width) * usize::from(height) * 4],
        }
    }

    /// Plays the commands under `view` (user units to pixels) and rasterizes.
    pub fn render(&mut self, commands: &Commands, view: Affine) {
        self.context.reset();
        for command in &commands.list {
            self.play(command, view);
        }
        self.context.flush();
        let (width, height) = (self.context.width(), self.context.height());
        let target = PixmapMut::new(width, height, &mut self.pixels).expect("the buffer has the right size");
        self.context.render(target, &mut self.resources);
    }

    /// The last picture: premultiplied 8-bit RGBA.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    fn play(&mut self, command: &Command, view: Affine) {
        let context = &mut self.context;
        match command {
            Command::Fill { path, rule, paint, transform, crisp } => {
                set_up(context, paint, view * *transform, *crisp);
                context.set_fill_rule(*rule);
                context.fill_path(path);
            }
            Command::Stroke { path, stroke, paint, transform, crisp } => {
                set_up(context, paint, view * *transform, *crisp);
                context.set_stroke(stroke.clone());
                context.stroke_path(path);
            }
            Command::PushClip { path, rule, transform } => {
                context.set_transform(view * *transform);
                context.set_fill_rule(*rule);
                context.push_clip_layer(path);
            }
            Command::PushOpacity(opacity) => context.push_opacity_layer(*opacity),
            Command::Pop => context.pop_layer(),
        }
    }
}

fn set_up(context: &mut RenderContext, paint: &Paint, transform: Affine, crisp: bool) {
    context.set_transform(transform);
    context.set_paint(paint.kind.clone());
    context.set_paint_transform(paint.transform);
    context.set_aliasing_threshold(crisp.then_some(127));
}

fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

fn bez_path(data: &resvg::tiny_skia::Path) -> BezPath {
    use resvg::tiny_skia::PathSegment;
    let at = |p: resvg::tiny_skia::Point| Point::new(f64::from(p.x), f64::from(p.y));
    let mut path = BezPath::new();
    for segment in data.segments() {
        match segment {
            PathSegment::MoveTo(p) => path.move_to(at(p)),
            PathSegment::LineTo(p) => path.line_to(at(p)),
            PathSegment::QuadTo(c, p) => path.quad_to(at(c), at(p)),
            PathSegment::CubicTo(c, d, p) => path.curve_to(at(c), at(d), at(p)),
            PathSegment::Close => path.close_path(),
        }
    }
    path
}

fn fill_rule(rule: usvg::FillRule) -> Fill {
    match rule {
        usvg::FillRule::NonZero => Fill::NonZero,
        usvg::FillRule::EvenOdd => Fill::EvenOdd,
    }
}

fn pen(stroke: &usvg::Stroke) -> Stroke {
    let cap = match stroke.linecap() {
        usvg::LineCap::Butt => Cap::Butt,
        usvg::LineCap::Round => Cap::Round,
        usvg::LineCap::Square => Cap::Square,
    };
    let join = match stroke.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => Join::Miter,
        usvg::LineJoin::Round => Join::Round,
        usvg::LineJoin::Bevel => Join::Bevel,
    };
    let pen = Stroke::new(f64::from(stroke.width().get()))
        .with_caps(cap)
        .with_join(join)
        .with_miter_limit(f64::from(stroke.miterlimit().get()));
    match stroke.dasharray() {
        Some(dashes) => pen.with_dashes(f64::from(stroke.dashoffset()), dashes.iter().map(|d| f64::from(*d))),
        None => pen,
    }
}

fn color(color: usvg::Color, opacity: usvg::Opacity) -> AlphaColor<Srgb> {
    AlphaColor::from_rgba8(color.red, color.green, color.blue, opacity.to_u8())
}

fn gradient(
    kind: vello_cpu::peniko::GradientKind,
    base: &usvg::BaseGradient,
    opacity: usvg::Opacity,
) -> Paint {
    let stops: Vec<ColorStop> = base
        .stops()
        .iter()
        .map(|stop| ColorStop {
            offset: stop.offset().get(),
            color: DynamicColor::from_alpha_color(color(stop.color(), stop.opacity() * opacity)),
        })
        .collect();
    let extend = match base.spread_method() {
        usvg::SpreadMethod::Pad => Extend::Pad,
        usvg::SpreadMethod::Reflect => Extend::Reflect,
        usvg::SpreadMethod::Repeat => Extend::Repeat,
    };
    let gradient = Gradient {
        kind,
        extend,
        stops: ColorStops::from(stops.as_slice()),
        interpolation_alpha_space: InterpolationAlphaSpace::Unpremultiplied,
        ..Gradient::default()
    };
    Paint { kind: PaintType::Gradient(gradient), transform: affine(base.transform()) }
}
