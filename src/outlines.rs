//! Takes a scene and a viewport, makes a list of outlines with their bounds in the picture, each to be
//! flattened when a band first needs it. What is hidden or outside is never flattened or stroked.

use crate::edges::{BandedEdges, Bounds, EdgeList, BAND_ROWS};
use crate::polygons::{largest_scale, Flattener};
use crate::scene::{Clip, ClipId, FillRule, Geometry, GroupId, Outline, Role, Scene};
use crate::{Settings, Viewport};
use kurbo::{Affine, Point, Rect};
use std::sync::OnceLock;
use usvg::tiny_skia_path::PathVerb;

/// A shape or clip member at the picture's scale.
pub(crate) struct PlacedOutline<'a> {
    geometry: &'a Geometry,
    pub rule: FillRule,
    pub crisp: bool,
    /// Pixels that it may touch, half-open: columns and rows; `None` when there are none.
    pub bounds: Option<Bounds>,
    edges: OnceLock<BandedEdges>,
}

impl<'a> PlacedOutline<'a> {
    pub fn new(geometry: &'a Geometry, viewport: &Viewport, all_crisp: bool) -> PlacedOutline<'a> {
        let rule = match geometry.outline {
            Outline::Fill(rule) => rule,
            Outline::Stroke(_) | Outline::Pixels => FillRule::NonZero,
        };
        let bounds = bounds(geometry, viewport);
        PlacedOutline { geometry, rule, crisp: geometry.crisp || all_crisp, bounds, edges: OnceLock::new() }
    }

    /// The edges, flattened by whoever asks first.
    pub fn edges(
        &self,
        flattener: &mut Flattener,
        list: &mut EdgeList,
        to_pixels: Affine,
        tolerance: f64,
    ) -> &BandedEdges {
        // A jagged pixel that flips is off by all of it: methods that flatten coarsely do not here.
        let tolerance = if self.crisp { tolerance.min(Settings::DEFAULT_TOLERANCE) } else { tolerance };
        self.edges.get_or_init(|| {
            flattener.flatten(self.geometry, to_pixels, tolerance, list);
            list.take_banded()
        })
    }

    /// Frees the edges when no band from this row on needs them.
    pub fn forget_above(&mut self, row: usize) {
        if self.bounds.is_some_and(|bounds| bounds.bottom <= row) {
            self.edges.take();
        }
    }
}

/// The bounds of the control points, and of all that a stroke may add around them, in pixels.
pub(crate) fn bounds_in_pixels(geometry: &Geometry, viewport: &Viewport) -> Rect {
    bounds_under(geometry, viewport.transform).inflate(1.0, 1.0)
}

/// The same where a transform from the scene's user units leads to, without a margin.
pub(crate) fn bounds_under(geometry: &Geometry, transform: Affine) -> Rect {
    let b = geometry.path.bounds();
    let own = Rect::new(b.left().into(), b.top().into(), b.right().into(), b.bottom().into());
    let transform = transform * geometry.transform;
    let reach = match &geometry.outline {
        Outline::Fill(_) | Outline::Pixels => 0.0,
        Outline::Stroke(stroke) => {
            let miter = if stroke.join == kurbo::Join::Miter { stroke.miter_limit.max(1.0) } else { 1.0 };
            // A square cap reaches to the corner of a square, a clipped miter to that of a rectangle.
            0.5 * stroke.width * miter.hypot(1.0) * largest_scale(transform)
        }
    };
    transform.transform_rect_bbox(own).inflate(reach, reach)
}

/// The pixels of the picture in those bounds.
fn bounds(geometry: &Geometry, viewport: &Viewport) -> Option<Bounds> {
    let placed = bounds_in_pixels(geometry, viewport);
    if !(placed.x0 + placed.y0 + placed.x1 + placed.y1).is_finite() {
        // Coordinates that overflow cannot be placed; lines drop them one by one.
        return pixels(Rect::new(0.0, 0.0, viewport.width.into(), viewport.height.into()), viewport);
    }
    pixels(placed, viewport)
}

fn pixels(rect: Rect, viewport: &Viewport) -> Option<Bounds> {
    let (width, height) = (f64::from(viewport.width), f64::from(viewport.height));
    let bounds = Bounds {
        left: rect.x0.clamp(0.0, width).floor() as usize,
        right: rect.x1.clamp(0.0, width).ceil() as usize,
        top: rect.y0.clamp(0.0, height).floor() as usize,
        bottom: rect.y1.clamp(0.0, height).ceil() as usize,
    };
    (bounds.left < bounds.right && bounds.top < bounds.bottom).then_some(bounds)
}

/// For each band the shapes that may touch it, front to back.
pub(crate) struct BandLists {
    starts: Vec<u32>,
    shapes: Vec<u32>,
}

impl BandLists {
    /// `bounds` gives each shape's, back to front.
    pub fn new(outlines: &[PlacedOutline], height: u32) -> BandLists {
        let bands = height.div_ceil(BAND_ROWS) as usize;
        let range =
            |bounds: Bounds| bounds.top / BAND_ROWS as usize..=(bounds.bottom - 1) / BAND_ROWS as usize;
        let mut starts = vec![0u32; bands + 1];
        for bounds in outlines.iter().filter_map(|outline| outline.bounds) {
            range(bounds).for_each(|band| starts[band + 1] += 1);
        }
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let mut next = starts.clone();
        let mut shapes = vec![0; total as usize];
        for (shape, outline) in outlines.iter().enumerate().rev() {
            for band in outline.bounds.into_iter().flat_map(range) {
                shapes[next[band] as usize] = shape as u32;
                next[band] += 1;
            }
        }
        BandLists { starts, shapes }
    }

    pub fn band(&self, band: usize) -> &[u32] {
        &self.shapes[self.starts[band] as usize..self.starts[band + 1] as usize]
    }
}

/// For each group that is a mask the pixels that what it masks may touch.
fn masked(scene: &Scene, outlines: &[PlacedOutline]) -> Vec<Option<Bounds>> {
    let mut masked = vec![None; scene.groups.len()];
    if !scene.groups.iter().any(|group| matches!(group.role, Role::Masked(_))) {
        return masked;
    }
    for (shape, outline) in scene.shapes.iter().zip(outlines).filter(|(shape, _)| shape.group != 0) {
        for group in scene.group_path(shape.group) {
            if let (Role::Masked(mask), Some(bounds)) = (scene.groups[group as usize].role, outline.bounds) {
                let all: &mut Option<Bounds> = &mut masked[mask as usize];
                *all = Some(all.map_or(bounds, |all| all.united(bounds)));
            }
        }
    }
    masked
}

/// For each clip a rectangle in pixels from which it takes nothing away: a page or an artboard as a rule.
fn spared(scene: &Scene, viewport: &Viewport) -> Vec<Rect> {
    let mut spared: Vec<Rect> = Vec::with_capacity(scene.clips.len());
    for Clip { members, within } in &scene.clips {
        let whole = members.iter().filter(|member| member.clip.is_none());
        let rects = whole.filter_map(|member| rectangle(&member.geometry, viewport));
        let largest = rects.max_by(|a, b| a.area().total_cmp(&b.area())).unwrap_or(Rect::ZERO);
        // All that it refers to stands before it.
        spared.push(within.iter().fold(largest, |rect, &outer| rect.intersect(spared[outer as usize])));
    }
    spared
}

/// The rectangle in pixels that a geometry fills, if it is one.
fn rectangle(geometry: &Geometry, viewport: &Viewport) -> Option<Rect> {
    let (points, verbs) = (geometry.path.points(), geometry.path.verbs());
    let is_filled = matches!(geometry.outline, Outline::Fill(_));
    let is_polygon = verbs.iter().all(|v| matches!(v, PathVerb::Move | PathVerb::Line | PathVerb::Close));
    let ([a, b, c, d], true, true, 4 | 5) = (points, is_filled, is_polygon, verbs.len()) else { return None };
    let across_first = a.y == b.y && b.x == c.x && c.y == d.y && d.x == a.x;
    let down_first = a.x == b.x && b.y == c.y && c.x == d.x && d.y == a.y;
    let transform = viewport.transform * geometry.transform;
    let [_, skew_y, skew_x, ..] = transform.as_coeffs();
    let corners = [a, c].map(|p| transform * Point::new(p.x.into(), p.y.into()));
    let rect = Rect::from_points(corners[0], corners[1]);
    ((across_first || down_first) && (skew_x, skew_y) == (0.0, 0.0) && rect.is_finite()).then_some(rect)
}

/// All outlines of a scene: its shapes', and its clips' members', clip by clip.
pub(crate) struct Outlines<'a> {
    pub shapes: Vec<PlacedOutline<'a>>,
    pub clips: Vec<Vec<PlacedOutline<'a>>>,
    /// For each group that is a mask the pixels that what it masks may touch.
    masked: Vec<Option<Bounds>>,
    /// For each clip a rectangle in pixels from which it takes nothing away.
    spared: Vec<Rect>,
}

impl<'a> Outlines<'a> {
    pub fn new(scene: &'a Scene, viewport: &Viewport, all_crisp: bool) -> Outlines<'a> {
        let place = |geometry| PlacedOutline::new(geometry, viewport, all_crisp);
        let shapes: Vec<_> = scene.shapes.iter().map(|shape| place(&shape.geometry)).collect();
        Outlines {
            masked: masked(scene, &shapes),
            spared: spared(scene, viewport),
            shapes,
            clips: scene
                .clips
                .iter()
                .map(|clip| clip.members.iter().map(|m| place(&m.geometry)).collect())
                .collect(),
        }
    }

    /// The pixels that what a mask masks may touch.
    pub fn masked_by(&self, mask: GroupId) -> Option<Bounds> {
        self.masked[mask as usize]
    }

    /// Does a clip take nothing away from what lies in these bounds?
    pub fn spares(&self, clip: ClipId, bounds: Bounds) -> bool {
        let Rect { x0, y0, x1, y1 } = self.spared[clip as usize];
        let (left, top) = (bounds.left as f64, bounds.top as f64);
        x0 <= left && y0 <= top && x1 >= bounds.right as f64 && y1 >= bounds.bottom as f64
    }

    pub fn forget_above(&mut self, row: usize) {
        self.shapes
            .iter_mut()
            .chain(self.clips.iter_mut().flatten())
            .for_each(|outline| outline.forget_above(row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    #[test]
    fn only_a_clip_that_takes_something_away_takes_part() {
        let svg = br##"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">
            <clipPath id="page"><rect width="100" height="100"/></clipPath>
            <clipPath id="turned"><rect width="100" height="100" transform="rotate(45 50 50)"/></clipPath>
            <clipPath id="in" clip-path="url(#page)"><rect x="10" y="10" width="50" height="80"/></clipPath>
            <path clip-path="url(#page)" d="M0 0h100v100H0z"/><path clip-path="url(#in)" d="M20 20h5v5z"/>
            <path clip-path="url(#in)" d="M55 20h5v5z"/><path clip-path="url(#turned)" d="M50 50h5v5z"/></svg>"##;
        let scene = Scene::from_bytes(svg, &Options::default()).unwrap();
        let viewport = Viewport { width: 100, height: 100, transform: Affine::IDENTITY };
        let outlines = Outlines::new(&scene, &viewport, false);
        let shapes = scene.shapes.iter().zip(&outlines.shapes);
        let spared =
            shapes.map(|(shape, placed)| outlines.spares(shape.clip.unwrap(), placed.bounds.unwrap()));
        // Bounds have a margin of a pixel, which reaches out of the clip in the third.
        assert_eq!(spared.collect::<Vec<_>>(), [true, true, false, false]);
    }

    #[test]
    fn a_mask_is_wanted_where_what_it_masks_may_be_and_nowhere_else() {
        let svg = br##"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">
            <mask id="m" maskUnits="userSpaceOnUse" x="0" y="0" width="100" height="100">
            <path fill="#fff" d="M0 0h100v100H0z"/></mask>
            <g mask="url(#m)"><path d="M20 30h10v10H20z"/><g opacity=".5"><path d="M40 20h10v10H40z"/>
            <path d="M45 20h10v10H45z"/></g></g><path d="M90 90h10v10H90z"/></svg>"##;
        let scene = Scene::from_bytes(svg, &Options::default()).unwrap();
        let scene = scene.unfolded().expect("a mask is a group of the paint tree");
        let viewport = Viewport { width: 100, height: 100, transform: Affine::IDENTITY };
        let outlines = Outlines::new(&scene, &viewport, false);
        let masks: Vec<_> =
            (0..scene.groups.len()).filter(|&group| outlines.masked[group].is_some()).collect();
        assert!(matches!(masks[..], [mask] if matches!(scene.groups[mask].role, Role::Mask(_))), "{masks:?}");
        // With the margin of a pixel.
        let expected = Bounds { left: 19, right: 56, top: 19, bottom: 41 };
        assert_eq!(outlines.masked_by(masks[0] as GroupId), Some(expected));
    }
}
