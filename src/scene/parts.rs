//! Takes a drawing in which cuts are marked, makes the parts of its scene that lie between them; and from
//! parts a scene again. A part that several drawings have in common is parsed once.
//!
//! Promises: parts put together are the scene that the whole drawing makes, if nothing around a cut
//! composites: see `crate::frames::cels`, which knows where that is so.

use super::convert::Walk;
use super::images::Images;
use super::paint::Paint;
use super::print::{self, Print};
use super::{Clip, ClipId, Group, GroupId, Scene, Shape};
use crate::Error;
use kurbo::Size;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// The id of the group that marks a cut.
pub(crate) const CUT_ID: &str = "toon-raster-cut";

/// What marks a cut. It has something to draw, or the parser would leave it out, but is never drawn.
pub(crate) const CUT: &str = concat!(
    r#"<g id="toon-raster-cut" style="display:inline"><path d="M0 0h1v1z" "#,
    r#"style="display:inline;visibility:visible;fill:red;stroke:none"/></g>"#
);

/// What a drawing shows between two cuts.
#[derive(Debug)]
pub(crate) struct ScenePart {
    /// Of the drawing.
    size: Size,
    shapes: Vec<Shape>,
    /// Of each shape.
    prints: Vec<Print>,
    /// Those that the shapes need, numbered from 0.
    clips: Vec<Clip>,
    clip_prints: Vec<Print>,
    /// From number 1 on: 0 is the picture.
    groups: Vec<Group>,
}

/// The parts of a drawing behind each of its cuts, which may have `images` of others; `None` if there are not
/// `count`, or something before the first, or not all can be drawn as SVG says.
///
/// # Errors
/// As [`Scene::from_tree`].
pub(crate) fn cut(
    tree: &usvg::Tree,
    count: usize,
    images: &Arc<Images>,
) -> Result<Option<Vec<ScenePart>>, Error> {
    let walk = Walk::of(tree, images)?;
    let starts_behind_a_cut = walk.cuts.first().is_none_or(|&(shapes, _)| shapes == 0);
    if walk.cuts.len() != count || !starts_behind_a_cut || !walk.warnings.is_empty() {
        return Ok(None);
    }
    let size = Size::new(tree.size().width().into(), tree.size().height().into());
    let end = (walk.shapes.len(), walk.groups.len());
    let ends = walk.cuts.iter().skip(1).chain([&end]);
    Ok(Some(walk.cuts.iter().zip(ends).map(|(&from, &to)| part(&walk, size, from, to)).collect()))
}

/// Shapes and groups from some numbers to others.
fn part(walk: &Walk, size: Size, from: (usize, usize), to: (usize, usize)) -> ScenePart {
    let mut shapes = walk.shapes[from.0..to.0].to_vec();
    let mut groups = walk.groups[from.1..to.1].to_vec();
    let inner = |group: GroupId| if group == 0 { 0 } else { group - from.1 as GroupId + 1 };
    groups.iter_mut().for_each(|group| group.parent = inner(group.parent));
    let mut wanted: BTreeSet<ClipId> = shapes.iter().filter_map(|shape| shape.clip).collect();
    let mut next = wanted.last().copied();
    while let Some(id) = next {
        // All that it refers to stands before it.
        let clip = &walk.clips[id as usize];
        wanted.extend(clip.within.iter().copied().chain(clip.members.iter().filter_map(|m| m.clip)));
        next = wanted.range(..id).next_back().copied();
    }
    let numbers: HashMap<ClipId, ClipId> = wanted.iter().copied().zip(0..).collect();
    let clips: Vec<Clip> =
        wanted.iter().map(|&id| renumbered(&walk.clips[id as usize], |id| numbers[&id])).collect();
    let clip_prints = print::of_clips(&clips);
    for shape in &mut shapes {
        shape.group = inner(shape.group);
        shape.clip = shape.clip.map(|id| numbers[&id]);
    }
    let prints = shapes.iter().map(|shape| print::of_shape(shape, &clip_prints)).collect();
    ScenePart { size, shapes, prints, clips, clip_prints, groups }
}

fn renumbered(clip: &Clip, number: impl Fn(ClipId) -> ClipId) -> Clip {
    let mut clip = clip.clone();
    clip.within.iter_mut().for_each(|id| *id = number(*id));
    clip.members.iter_mut().for_each(|member| member.clip = member.clip.map(&number));
    clip
}

/// The scene of parts, back to front; `None` without any.
pub(crate) fn assemble<'p>(parts: impl Iterator<Item = &'p ScenePart> + Clone) -> Option<Scene> {
    let first = parts.clone().next()?;
    let count = parts.clone().map(|part| part.shapes.len()).sum();
    let mut scene = Scene { size: first.size, ..super::convert::of_shapes(Vec::with_capacity(count)) };
    scene.prints.reserve(count);
    let mut known: HashMap<Print, ClipId> = HashMap::new();
    for part in parts {
        let first_group = scene.groups.len() as GroupId;
        let outer = |group: GroupId| if group == 0 { 0 } else { group + first_group - 1 };
        scene.groups.extend(part.groups.iter().map(|g| Group { parent: outer(g.parent), ..g.clone() }));
        let mut numbers: Vec<ClipId> = Vec::new();
        for (clip, &print) in part.clips.iter().zip(&part.clip_prints) {
            let id = *known.entry(print).or_insert_with(|| {
                scene.clips.push(renumbered(clip, |id| numbers[id as usize]));
                (scene.clips.len() - 1) as ClipId
            });
            numbers.push(id);
        }
        scene.shapes.extend(part.shapes.iter().map(|shape| Shape {
            clip: shape.clip.map(|id| numbers[id as usize]),
            group: outer(shape.group),
            ..shape.clone()
        }));
        scene.prints.extend_from_slice(&part.prints);
    }
    Some(scene)
}

impl ScenePart {
    /// About as many bytes as it takes, were its images its own.
    pub fn weight(&self) -> usize {
        let weight = |shape: &Shape| match &shape.paint {
            Paint::Raster(raster) => 800 + raster.image_bytes(),
            _ => 400 + shape.geometry.path.points().len() * 8,
        };
        self.shapes.iter().map(weight).sum::<usize>() + self.clips.len() * 400
    }
}
