//! Takes a scene, makes masks, blend modes and isolated groups groups of its own paint tree, where they
//! are kept as scenes within rasters.
//!
//! In a tree of groups each is evaluated for every region of a pixel in which the same shapes are seen,
//! so that no seam comes through it; a layer of pixels has mixed the regions before. What works on pixels
//! (filters, patterns, images) stays as it is.

use super::paint::Paint;
use super::raster::{Mask, Raster, RasterGroup, Source};
use super::{Clip, ClipId, ClipMember, Geometry, Group, GroupId, Role, Scene, Shape};
use kurbo::{Affine, Rect};
use std::sync::Arc;
use usvg::BlendMode;

pub(super) fn unfolded(scene: &Scene) -> Option<Scene> {
    scene.shapes.iter().any(|shape| foldable(&shape.paint).is_some()).then(|| {
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
            let is_plain_filter =
                !group.filters.is_empty() && group.mask.is_none() && group.blend_mode == BlendMode::Normal;
            (!is_plain_filter).then_some((&**raster, group))
        }
        Source::Image { .. } | Source::Tiles(..) => None,
    }
}

fn unfold_shape(scene: &mut Scene, shape: Shape) {
    let Some((raster, group)) = foldable(&shape.paint) else {
        scene.shapes.push(shape);
        return;
    };
    let mut place = Place { transform: raster.transform, clip: shape.clip, group: shape.group };
    let mut opacity = raster.opacity;
    if group.blend_mode != BlendMode::Normal || group.mask.is_none() {
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
            let (content, filters) = (group.content.clone(), filters.to_vec());
            let filtered = RasterGroup { content, filters, mask: None, blend_mode: BlendMode::Normal };
            let raster = Raster { source: Source::Group(filtered), opacity: 1.0, ..raster.clone() };
            let paint = Paint::Raster(Arc::new(raster));
            Content::Filtered(Box::new(Shape { geometry: shape.geometry.clone(), paint, clip: None, group: 0 }))
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
    /// One shape, in the outer scene's coordinates, without clip and group.
    Filtered(Box<Shape>),
}

fn add_content(scene: &mut Scene, content: Content, place: Place) {
    match content {
        Content::Scene(inner) => add_scene(scene, inner, place),
        Content::Filtered(shape) => {
            scene.shapes.push(Shape { clip: place.clip, group: place.group, ..*shape });
        }
    }
}

fn add_group(scene: &mut Scene, parent: GroupId, opacity: f32, role: Role) -> GroupId {
    scene.groups.push(Group { parent, opacity, role });
    (scene.groups.len() - 1) as GroupId
}

/// Adds content, which lies within `bounds`, and the mask before it.
fn add_masked(
    scene: &mut Scene,
    mask: &Mask,
    content: Content,
    bounds: Rect,
    opacity: f32,
    place: Place,
) {
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
