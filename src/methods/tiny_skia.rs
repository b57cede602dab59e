//! `tiny-skia`: takes a scene, makes the picture that resvg's renderer makes of it, for comparison.
//!
//! The paths, strokes, dashes, gradients, clips and groups are handed over as resvg does: colours and
//! opacities in 8 bits, a group as a layer that is drawn with its opacity, shapes that share a clip as a
//! layer that is multiplied with its mask. Promises: what resvg draws, but for rounding. Its own areas
//! are of 4 x 4 samples a pixel, and shapes are painted over one another, with the seams that this leaves.
//! Exceptions: where clips lie within clips, resvg applies the outer one once to all that is in it, and
//! this once to each; a curve's tolerance is tiny-skia's own; and it cannot mix in linear light, so
//! `--linear` is refused.

use crate::outlines::PlacedOutline;
use crate::scene::paint::{Gradient, GradientShape, Paint, Sheet, Spread};
use crate::scene::{Clip, ClipId, FillRule, Geometry, GroupId, Outline, Scene, StrokeStyle};
use crate::{Error, Settings, Viewport};
use kurbo::Affine;
use tiny_skia::{BlendMode, Color, GradientStop, IntRect, Mask, MaskType, Pixmap, Shader, Transform};

/// Layers reach this far beyond what is known to be in them, in pixels, as resvg's do.
const ROOM: i32 = 2;

/// Coordinates beyond this, in pixels, are refused: tiny-skia panics at larger ones.
const FARTHEST: f64 = 1e9;

/// Paints a scene.
pub(super) fn paint(
    scene: &Scene,
    viewport: &Viewport,
    settings: &Settings,
    bytes: &mut [u8],
    stride: usize,
) -> Result<(), Error> {
    if settings.linear {
        return Err(Error::Setting(
            "the method tiny-skia cannot mix in linear light: leave out --linear or choose another method"
                .into(),
        ));
    }
    scene.refuse_rasters("tiny-skia")?;
    if geometries(scene).any(|geometry| reaches_too_far(geometry, viewport)) {
        return Err(Error::Limit(format!(
            "tiny-skia cannot draw what lies more than {FARTHEST:e} pixels away: use another method"
        )));
    }
    let (width, height) = (viewport.width, viewport.height);
    let too_large = || Error::Limit(format!("tiny-skia makes no picture of {width} x {height} pixels"));
    let place = IntRect::from_xywh(0, 0, width, height).ok_or_else(too_large)?;
    let mut canvas = Layer { place, pixmap: Pixmap::new(width, height).ok_or_else(too_large)? };
    if let Some([r, g, b, a]) = settings.background {
        canvas.pixmap.fill(Color::from_rgba8(r, g, b, a));
    }
    Painter { scene, viewport }.group(0..scene.shapes.len(), 0, &mut canvas);
    for (row, pixels) in bytes.chunks_mut(stride).zip(canvas.pixmap.pixels().chunks(width as usize)) {
        for (bytes, pixel) in row.as_chunks_mut().0.iter_mut().zip(pixels) {
            let color = pixel.demultiply();
            *bytes = [color.red(), color.green(), color.blue(), color.alpha()];
        }
    }
    Ok(())
}

fn geometries(scene: &Scene) -> impl Iterator<Item = &Geometry> {
    let members = scene.clips.iter().flat_map(|clip| &clip.members).map(|member| &member.geometry);
    scene.shapes.iter().map(|shape| &shape.geometry).chain(members)
}

fn reaches_too_far(geometry: &Geometry, viewport: &Viewport) -> bool {
    let b = geometry.path.bounds();
    let own = kurbo::Rect::new(b.left().into(), b.top().into(), b.right().into(), b.bottom().into());
    let placed = (viewport.transform * geometry.transform).transform_rect_bbox(own);
    // What is not a number is too far as well.
    ![placed.x0, placed.y0, placed.x1, placed.y1].iter().all(|v| v.abs() <= FARTHEST)
}

/// A part of the picture that is drawn by itself.
struct Layer {
    place: IntRect,
    pixmap: Pixmap,
}

impl Layer {
    /// From the picture's pixels to this layer's.
    fn shift(&self) -> Affine {
        Affine::translate((f64::from(-self.place.x()), f64::from(-self.place.y())))
    }
}

struct Painter<'a> {
    scene: &'a Scene,
    viewport: &'a Viewport,
}

impl Painter<'_> {
    /// Draws shapes that all lie in `group`, back to front.
    fn group(&self, shapes: std::ops::Range<usize>, group: GroupId, canvas: &mut Layer) {
        let mut first = shapes.start;
        while first < shapes.end {
            let shape = &self.scene.shapes[first];
            let rest = first..shapes.end;
            if let Some(inner) = self.child_of(group, shape.group) {
                let is_inside = |&i: &usize| self.child_of(group, self.scene.shapes[i].group) == Some(inner);
                let end = first + rest.take_while(is_inside).count();
                let opacity = self.scene.groups[inner as usize].opacity;
                self.layer(first..end, opacity, None, canvas, |layer| self.group(first..end, inner, layer));
                first = end;
            } else if let Some(clip) = shape.clip {
                let alike = |&i: &usize| {
                    let other = &self.scene.shapes[i];
                    (other.group, other.clip) == (shape.group, shape.clip)
                };
                let end = first + rest.take_while(alike).count();
                self.layer(first..end, 1.0, Some(clip), canvas, |layer| {
                    (first..end).for_each(|i| self.shape(i, layer));
                });
                first = end;
            } else {
                self.shape(first, canvas);
                first += 1;
            }
        }
    }

    /// The child of `group` that `other` is or lies in; `None` when it is `group` itself.
    fn child_of(&self, group: GroupId, mut other: GroupId) -> Option<GroupId> {
        let mut child = None;
        while other != group {
            child = Some(other);
            other = self.scene.groups[other as usize].parent;
        }
        child
    }

    /// Draws some shapes on a layer of their own, clips that, and lays it over the canvas.
    fn layer(
        &self,
        shapes: std::ops::Range<usize>,
        opacity: f32,
        clip: Option<ClipId>,
        canvas: &mut Layer,
        draw: impl FnOnce(&mut Layer),
    ) {
        let bounds = shapes.filter_map(|i| {
            let bounds = PlacedOutline::new(&self.scene.shapes[i].geometry, self.viewport, false).bounds?;
            let int = |v: usize| v as i32;
            IntRect::from_ltrb(int(bounds.left), int(bounds.top), int(bounds.right), int(bounds.bottom))
        });
        let Some(place) = bounds.reduce(around).and_then(|b| b.make_outset(ROOM, ROOM)) else {
            return;
        };
        let Some(pixmap) = Pixmap::new(place.width(), place.height()) else {
            return;
        };
        let mut layer = Layer { place, pixmap };
        draw(&mut layer);
        if let Some(clip) = clip {
            self.apply_clip(clip, &mut layer);
        }
        let (x, y) = (place.x() - canvas.place.x(), place.y() - canvas.place.y());
        let paint = tiny_skia::PixmapPaint { opacity, ..Default::default() };
        canvas.pixmap.draw_pixmap(x, y, layer.pixmap.as_ref(), &paint, Transform::identity(), None);
    }

    fn shape(&self, number: usize, canvas: &mut Layer) {
        let shape = &self.scene.shapes[number];
        let Some(shader) = shader(&shape.paint, &shape.geometry) else {
            return;
        };
        self.draw(&shape.geometry, shader, BlendMode::SourceOver, canvas);
    }

    fn draw(&self, geometry: &Geometry, shader: Shader, blend_mode: BlendMode, canvas: &mut Layer) {
        let paint =
            tiny_skia::Paint { shader, blend_mode, anti_alias: !geometry.crisp, ..Default::default() };
        let transform = transform(canvas.shift() * self.viewport.transform * geometry.transform);
        match &geometry.outline {
            Outline::Fill(rule) => {
                let bounds = geometry.path.bounds();
                if bounds.width() > 0.0 && bounds.height() > 0.0 {
                    let rule = match rule {
                        FillRule::NonZero => tiny_skia::FillRule::Winding,
                        FillRule::EvenOdd => tiny_skia::FillRule::EvenOdd,
                    };
                    canvas.pixmap.fill_path(&geometry.path, &paint, rule, transform, None);
                }
            }
            Outline::Pixels => unreachable!("scenes with rasters are refused"),
            Outline::Stroke(pen) => {
                canvas.pixmap.stroke_path(&geometry.path, &paint, &stroke(pen), transform, None);
            }
        }
    }

    /// Takes away what lies outside a clip.
    fn apply_clip(&self, id: ClipId, layer: &mut Layer) {
        let clip = &self.scene.clips[id as usize];
        clip.within.iter().rev().for_each(|&other| self.apply_clip(other, layer));
        let Some(mut outside) = Pixmap::new(layer.place.width(), layer.place.height()) else {
            return;
        };
        outside.fill(Color::BLACK);
        let mut outside = Layer { place: layer.place, pixmap: outside };
        self.clear_members(clip, &mut outside);
        let mut mask = Mask::from_pixmap(outside.pixmap.as_ref(), MaskType::Alpha);
        mask.invert();
        layer.pixmap.apply_mask(&mask);
    }

    fn clear_members(&self, clip: &Clip, outside: &mut Layer) {
        let black = || Shader::SolidColor(Color::BLACK);
        for member in &clip.members {
            let Some(inner) = member.clip else {
                self.draw(&member.geometry, black(), BlendMode::Clear, outside);
                continue;
            };
            let Some(pixmap) = Pixmap::new(outside.place.width(), outside.place.height()) else {
                return;
            };
            let mut layer = Layer { place: outside.place, pixmap };
            self.draw(&member.geometry, black(), BlendMode::SourceOver, &mut layer);
            self.apply_clip(inner, &mut layer);
            let paint = tiny_skia::PixmapPaint { blend_mode: BlendMode::Xor, ..Default::default() };
            outside.pixmap.draw_pixmap(0, 0, layer.pixmap.as_ref(), &paint, Transform::identity(), None);
        }
    }
}

/// The smallest rectangle around two.
fn around(a: IntRect, b: IntRect) -> IntRect {
    let (left, top) = (a.left().min(b.left()), a.top().min(b.top()));
    let (right, bottom) = (a.right().max(b.right()), a.bottom().max(b.bottom()));
    IntRect::from_ltrb(left, top, right, bottom).expect("it is around one")
}

fn transform(affine: Affine) -> Transform {
    let [a, b, c, d, e, f] = affine.as_coeffs().map(|v| v as f32);
    Transform::from_row(a, b, c, d, e, f)
}

fn stroke(pen: &StrokeStyle) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: pen.width as f32,
        miter_limit: pen.miter_limit as f32,
        line_cap: match pen.start_cap {
            kurbo::Cap::Butt => tiny_skia::LineCap::Butt,
            kurbo::Cap::Round => tiny_skia::LineCap::Round,
            kurbo::Cap::Square => tiny_skia::LineCap::Square,
        },
        line_join: match pen.join {
            kurbo::Join::Miter if pen.clips_miters => tiny_skia::LineJoin::MiterClip,
            kurbo::Join::Miter => tiny_skia::LineJoin::Miter,
            kurbo::Join::Round => tiny_skia::LineJoin::Round,
            kurbo::Join::Bevel => tiny_skia::LineJoin::Bevel,
        },
        dash: match pen.dash_pattern.is_empty() {
            true => None,
            false => {
                let dashes = pen.dash_pattern.iter().map(|&dash| dash as f32).collect();
                tiny_skia::StrokeDash::new(dashes, pen.dash_offset as f32)
            }
        },
    }
}

/// The paint in the path's coordinates, in which tiny-skia wants it.
fn shader(paint: &Paint, geometry: &Geometry) -> Option<Shader<'static>> {
    match paint {
        Paint::Flat(sheet) => Some(Shader::SolidColor(color(sheet))),
        Paint::Gradient(gradient) => {
            gradient_shader(gradient, geometry.transform.inverse() * gradient.transform)
        }
        Paint::Raster(_) | Paint::Layer(..) => None,
    }
}

fn color(sheet: &Sheet) -> Color {
    let [r, g, b, through] = sheet.channels();
    let alpha = 1.0 - through;
    let byte = |v: f32| (v * 255.0 + 0.5) as u8;
    let [r, g, b] = [r, g, b].map(|c| byte(c / alpha));
    Color::from_rgba8(r, g, b, byte(alpha))
}

fn gradient_shader(gradient: &Gradient, to_path: Affine) -> Option<Shader<'static>> {
    let mode = match gradient.spread {
        Spread::Pad => tiny_skia::SpreadMode::Pad,
        Spread::Reflect => tiny_skia::SpreadMode::Reflect,
        Spread::Repeat => tiny_skia::SpreadMode::Repeat,
    };
    let stop = |stop: &crate::scene::paint::Stop| {
        let [r, g, b, a] = stop.color.map(|v| (v * 255.0 + 0.5) as u8);
        GradientStop::new(stop.offset, Color::from_rgba8(r, g, b, a))
    };
    let stops = gradient.stops.iter().map(stop).collect();
    let point = |x: f64, y: f64| tiny_skia::Point::from_xy(x as f32, y as f32);
    match gradient.shape {
        GradientShape::Linear(map) => {
            // The parameter is a x + c y + e: 0 and 1 lie on this line through the nearest such points.
            let [a, _, c, _, e, _] = map.as_coeffs();
            let square = a * a + c * c;
            let at = |t: f64| point((t - e) * a / square, (t - e) * c / square);
            tiny_skia::LinearGradient::new(at(0.0), at(1.0), stops, mode, transform(to_path))
        }
        GradientShape::Radial { start: (x, y, r), step: (dx, dy, dr) } => tiny_skia::RadialGradient::new(
            point(x, y),
            r as f32,
            point(x + dx, y + dy),
            (r + dr) as f32,
            stops,
            mode,
            transform(to_path),
        ),
    }
}
