//! Takes a scene, makes masks, blend modes and isolated groups groups of its own paint tree, where they
//! are kept as scenes within rasters.
//!
//! In a tree of groups each is evaluated for every region of a pixel in which the same shapes are seen,
//! so that no seam comes through it; a layer of pixels has mixed the regions before. Filters too become
//! shapes where they only change colours of opaque shapes, and where they put what they filter before what
//! they make of it, as a drop shadow does. Patterns of few tiles become the shapes of those ([`tiles`]). What
//! else works on pixels (other filters, patterns of more tiles, images) stays as it is.

mod tiles;

use super::paint::{Paint, Sheet};
use super::raster::{Mask, Raster, RasterGroup, Source};
use super::{Clip, ClipId, ClipMember, Geometry, Group, GroupId, Role, Scene, Shape};
use crate::effects::filter::pointwise;
use crate::effects::layer::{Pixel, CLEAR};
use crate::outlines::bounds_under;
use kurbo::{Affine, Rect};
use std::sync::Arc;
use tiles::Tiles;
use usvg::filter::Filter;
use usvg::BlendMode;

pub(super) fn unfolded(scene: &Scene) -> Option<Scene> {
    let unfolds = |shape: &Shape| foldable(&shape.paint).is_some() || Tiles::of(shape).is_some();
    scene.shapes.iter().any(unfolds).then(|| {
        let mut unfolded = scene.with_shapes(Vec::new());
        for shape in &scene.shapes {
            unfold_shape(&mut unfolded, shape.clone());
        }
        unfolded
    })
}

/// Where a scene within the scene goes.
#[derive(Clone, Copy)]
struct Place {
    /// From its coordinates to the scene's user units.
    transform: Affine,
    clip: Option<ClipId>,
    group: GroupId,
}

/// The raster that a paint is, if it can be a group.
fn foldable(paint: &Paint) -> Option<(&Raster, &RasterGroup)> {
    let Paint::Raster(raster) = paint else {
        return None;
    };
    match &raster.source {
        Source::Group(group) => {
            let has_only_filters =
                !group.filters.is_empty() && group.mask.is_none() && group.blend_mode == BlendMode::Normal;
            let is_pixels = has_only_filters && Simple::of(group).is_none();
            (!is_pixels).then_some((&**raster, group))
        }
        Source::Image { .. } | Source::Tiles(..) => None,
    }
}

/// Filters that need no pixels, or not for what they filter.
enum Simple<'a> {
    /// The content comes out in other colours.
    Recolored(&'a Filter),
    /// The content comes out as it is, before whatever else the filter makes.
    InFront,
}

impl Simple<'_> {
    fn of(group: &RasterGroup) -> Option<Simple<'_>> {
        let [filter] = &group.filters[..] else {
            return None;
        };
        let content = &group.content;
        let is_opaque = |shape: &Shape| matches!(shape.paint, Paint::Flat(sheet) if sheet.is_opaque());
        let all_opaque = content.groups.len() == 1 && content.shapes.iter().all(is_opaque);
        let is_cut = || {
            let bounds = content.shapes.iter().map(|shape| bounds_under(&shape.geometry, Affine::IDENTITY));
            let mut subregions = filter.primitives().iter().map(|primitive| rect_of(primitive.rect()));
            // Written so that no number fails it.
            !bounds.reduce(|a, b| a.union(b)).is_some_and(|bounds| {
                subregions.all(|subregion| {
                    subregion.x0 <= bounds.x0
                        && subregion.y0 <= bounds.y0
                        && subregion.x1 >= bounds.x1
                        && subregion.y1 >= bounds.y1
                })
            })
        };
        if group.without_front || content.shapes.is_empty() {
            return None;
        }
        if pointwise::has_source_in_front(filter, all_opaque) && !is_cut() {
            return Some(Simple::InFront);
        }
        let color = |pixel| pointwise::recolored(filter, pixel);
        let stays_opaque = |shape: &Shape| match shape.paint {
            Paint::Flat(sheet) => color(pixel_of(sheet)).is_some_and(|pixel| pixel[3] >= 1.0),
            _ => false,
        };
        let is_recolored =
            all_opaque && color(CLEAR) == Some(CLEAR) && content.shapes.iter().all(stays_opaque) && !is_cut();
        is_recolored.then_some(Simple::Recolored(filter))
    }
}

fn is_flat(scene: &Scene) -> bool {
    scene.shapes.iter().all(|shape| matches!(shape.paint, Paint::Flat(_)))
}

/// Does anything in it blend?
fn blends(scene: &Scene) -> bool {
    scene.shapes.iter().any(|shape| match &shape.paint {
        Paint::Raster(raster) => {
            matches!(&raster.source, Source::Group(group) if group.blend_mode != BlendMode::Normal)
        }
        _ => false,
    })
}

fn pixel_of(sheet: Sheet) -> Pixel {
    let [r, g, b, through] = sheet.channels();
    [r, g, b, 1.0 - through]
}

fn rect_of(rect: usvg::NonZeroRect) -> Rect {
    Rect::new(rect.left().into(), rect.top().into(), rect.right().into(), rect.bottom().into())
}

fn recolored(content: &Scene, filter: &Filter) -> Scene {
    let mut shapes = content.shapes.clone();
    for shape in &mut shapes {
        if let Paint::Flat(sheet) = &mut shape.paint {
            if let Some([r, g, b, alpha]) = pointwise::recolored(filter, pixel_of(*sheet)) {
                *sheet = Sheet::from_channels([r, g, b, 1.0 - alpha]);
            }
        }
    }
    content.with_shapes(shapes)
}

fn unfold_shape(scene: &mut Scene, shape: Shape) {
    if let Some(tiles) = Tiles::of(&shape).filter(|_| tiles::has_room(scene)) {
        return tiles::add_tiles(scene, &shape, &tiles);
    }
    let Some((raster, group)) = foldable(&shape.paint) else {
        scene.shapes.push(shape);
        return;
    };
    let mut place = Place { transform: raster.transform, clip: shape.clip, group: shape.group };
    let mut opacity = raster.opacity;
    // Flat shapes by themselves do not have to be kept apart.
    let is_apart = opacity < 1.0 || group.filters.is_empty() || !is_flat(&group.content);
    if group.blend_mode != BlendMode::Normal || (group.mask.is_none() && is_apart) {
        let role = match group.blend_mode {
            BlendMode::Normal => Role::Paint,
            mode => Role::Blend(mode),
        };
        place.group = add_group(scene, place.group, opacity, role);
        opacity = 1.0;
    }
    let content = match &group.filters[..] {
        [] => Content::Scene(&group.content),
        filters => {
            let simple = Simple::of(group);
            let filtered = || {
                let filtered = RasterGroup {
                    content: group.content.clone(),
                    filters: filters.to_vec(),
                    images: group.images.clone(),
                    without_front: group.without_front || simple.is_some(),
                    mask: None,
                    blend_mode: BlendMode::Normal,
                };
                let raster =
                    Raster { source: Source::Group(Box::new(filtered)), opacity: 1.0, ..raster.clone() };
                let (geometry, paint) = (shape.geometry.clone(), Paint::Raster(Arc::new(raster)));
                Box::new(Shape { geometry, paint, clip: None, group: 0 })
            };
            match simple {
                Some(Simple::Recolored(filter)) => Content::Recolored(recolored(&group.content, filter)),
                Some(Simple::InFront) => Content::Behind(filtered(), &group.content),
                None => Content::Filtered(filtered()),
            }
        }
    };
    match &group.mask {
        None => add_content(scene, content, place),
        Some(mask) => add_masked(scene, mask, content, raster.bounds, opacity, place),
    }
}

/// What a group holds.
enum Content<'a> {
    Scene(&'a Scene),
    Recolored(Scene),
    /// One shape, in the outer scene's coordinates, without clip and group.
    Filtered(Box<Shape>),
    /// The same behind a scene.
    Behind(Box<Shape>, &'a Scene),
}

fn add_content(scene: &mut Scene, content: Content, place: Place) {
    match content {
        Content::Scene(inner) => add_scene(scene, inner, place),
        Content::Recolored(inner) => add_scene(scene, &inner, place),
        Content::Filtered(shape) => {
            scene.shapes.push(Shape { clip: place.clip, group: place.group, ..*shape });
        }
        Content::Behind(shape, inner) => {
            scene.shapes.push(Shape { clip: place.clip, group: place.group, ..*shape });
            // It was whole before it was filtered: nothing in it blends with what comes of that.
            let group = match blends(inner) {
                true => add_group(scene, place.group, 1.0, Role::Paint),
                false => place.group,
            };
            add_scene(scene, inner, Place { group, ..place });
        }
    }
}

fn add_group(scene: &mut Scene, parent: GroupId, opacity: f32, role: Role) -> GroupId {
    scene.groups.push(Group { parent, opacity, role });
    (scene.groups.len() - 1) as GroupId
}

/// Adds content, which lies within `bounds`, and the mask before it.
fn add_masked(scene: &mut Scene, mask: &Mask, content: Content, bounds: Rect, opacity: f32, place: Place) {
    let mask_group = add_group(scene, place.group, 1.0, Role::Mask(mask.kind));
    let masked = add_group(scene, place.group, opacity, Role::Masked(mask_group));
    add_content(scene, content, Place { group: masked, ..place });
    let clip = match mask.rect.union(bounds) == mask.rect {
        true => None,
        false => {
            let geometry = Geometry::of_rect(mask.rect, place.transform);
            let members = vec![ClipMember { geometry, clip: None }];
            scene.clips.push(Clip { members, within: Vec::new() });
            Some((scene.clips.len() - 1) as ClipId)
        }
    };
    let shown = Place { clip, group: mask_group, ..place };
    match &mask.within {
        None => add_scene(scene, &mask.content, shown),
        Some(within) => add_masked(scene, within, Content::Scene(&mask.content), bounds, 1.0, shown),
    }
}

/// Adds the shapes of a scene with their clips and groups, and unfolds what can be.
fn add_scene(scene: &mut Scene, inner: &Scene, place: Place) {
    let first_clip = scene.clips.len() as ClipId;
    for clip in &inner.clips {
        let mut clip = clip.clone();
        for member in &mut clip.members {
            member.geometry.transform = place.transform * member.geometry.transform;
            member.clip = member.clip.map(|clip| clip + first_clip);
        }
        clip.within.iter_mut().for_each(|within| *within += first_clip);
        clip.within.extend(place.clip);
        scene.clips.push(clip);
    }
    // Number 0 is the inner picture itself.
    let first_group = scene.groups.len() as GroupId;
    let placed = |group: GroupId| if group == 0 { place.group } else { first_group + group - 1 };
    for group in &inner.groups[1..] {
        scene.groups.push(Group { parent: placed(group.parent), ..group.clone() });
    }
    for shape in &inner.shapes {
        let mut shape = shape.clone();
        shape.geometry.transform = place.transform * shape.geometry.transform;
        shape.paint.transform(place.transform);
        shape.clip = shape.clip.map(|clip| clip + first_clip).or(place.clip);
        shape.group = placed(shape.group);
        unfold_shape(scene, shape);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    fn scene(body: &str) -> Scene {
        let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='8' height='8'>{body}</svg>");
        Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing")
    }

    #[test]
    fn a_scene_without_masks_and_blend_modes_is_left_alone() {
        let blurred = "<filter id='f'><feGaussianBlur stdDeviation='1'/></filter><g opacity='.5'>
            <rect width='4' height='4' filter='url(#f)'/><rect width='2' height='2'/></g>";
        assert!(scene(blurred).unfolded().is_none());
    }

    #[test]
    fn masks_stand_before_what_they_mask_and_no_raster_is_left() {
        let unfolded = scene(
            "<mask id='a'><rect width='3' height='3' fill='#fff'/></mask>
            <mask id='b' mask='url(#a)'><rect width='5' height='5' fill='#fff'/></mask>
            <g style='mix-blend-mode:multiply' opacity='.5' mask='url(#b)'>
            <rect width='8' height='8'/><rect width='4' height='4' opacity='.3'/></g>",
        )
        .unfolded()
        .expect("it has a mask");
        let roles: Vec<Role> = unfolded.groups.iter().map(|group| group.role).collect();
        assert!(matches!(
            roles[..],
            [Role::Paint, Role::Blend(_), Role::Mask(_), Role::Masked(2), Role::Mask(_), Role::Masked(4)]
        ));
        let groups: Vec<GroupId> = unfolded.shapes.iter().map(|shape| shape.group).collect();
        assert_eq!(groups, [3, 3, 5, 4]);
        assert!(unfolded.groups.iter().enumerate().skip(1).all(|(i, group)| (group.parent as usize) < i));
        assert!(unfolded.unfolded().is_none());
    }
}
