//! Takes a band's shapes, makes the colour seen at a point: for the methods that sample.
//!
//! A row of the picture is prepared once: each pixel gets the shapes that may be seen in it, front to
//! back, down to the first that hides the rest. A point then asks each of them for its winding number
//! there, until nothing shines through. Promises: the colour at a point depends on nothing but the
//! drawing and the point.

use super::borders::{BorderRow, Cut, RowMaker, Window};
use crate::band::Picture;
use crate::edges::{BAND_ROWS, FRACTION_BITS, ONE};
use crate::outlines::PlacedOutline;
use crate::pixel::resolve::NEGLIGIBLE;
use crate::scene::paint::{Paint, Sheet};
use crate::scene::{ClipId, GroupId, Scene};
use std::collections::HashMap;

/// What may be seen in a pixel, of one shape.
#[derive(Clone, Copy)]
struct Item {
    shape: u32,
    /// Its border, by its place in [`PointRow::borders`]; `None` when it covers the pixel.
    border: Option<(u32, Cut)>,
    /// The clip that still matters here, by its place in [`PointRow::clips`].
    clip: Option<u32>,
}

/// How a pixel lies to a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Outside,
    Inside,
    Partly,
}

/// One row of a clip.
struct ClipRow {
    members: Vec<(BorderRow, Option<u32>)>,
    within: Vec<u32>,
    sides: Vec<Side>,
    /// The last point that was asked for, and the answer.
    known: (u64, bool),
}

/// One row of the picture, ready to be asked for colours.
pub(super) struct PointRow {
    maker: RowMaker,
    width: usize,
    height: u32,
    lists: Vec<Vec<Item>>,
    /// Pixels of which all that can be seen is listed.
    finished: Vec<bool>,
    borders: Vec<BorderRow>,
    borders_used: usize,
    clips: Vec<ClipRow>,
    clip_numbers: HashMap<ClipId, u32>,
    /// Counts points, so that no clip is asked twice for one.
    point: u64,
}

impl PointRow {
    pub fn new(width: u32, height: u32) -> PointRow {
        PointRow {
            maker: RowMaker::new(width, height),
            width: width as usize,
            height,
            lists: vec![Vec::new(); width as usize],
            finished: vec![false; width as usize],
            borders: Vec::new(),
            borders_used: 0,
            clips: Vec::new(),
            clip_numbers: HashMap::new(),
            point: 0,
        }
    }

    /// Prepares row `y` of the picture.
    pub fn prepare(&mut self, picture: &Picture, y: u32) {
        self.lists.iter_mut().for_each(Vec::clear);
        self.finished.fill(false);
        self.borders_used = 0;
        self.clips.clear();
        self.clip_numbers.clear();
        for &number in picture.bands.band((y / BAND_ROWS) as usize) {
            self.add(picture, y, number);
        }
    }

    /// Adds a shape behind those before it.
    fn add(&mut self, picture: &Picture, y: u32, number: u32) {
        let shape = &picture.scene.shapes[number as usize];
        let outline = &picture.outlines.shapes[number as usize];
        let Some(bounds) = outline.bounds.filter(|b| (b.top..b.bottom).contains(&(y as usize))) else {
            return;
        };
        if self.finished[bounds.left..bounds.right].iter().all(|&finished| finished) {
            return;
        }
        let clip = shape.clip.map(|clip| self.clip(picture, y, clip));
        let mut border = self.take_border();
        self.maker.make(picture, outline, y, Window::row(y), &mut border);
        let hides = shape.group == 0 && shape.paint.is_opaque();
        let place = self.borders_used as u32;
        for run in border.runs() {
            for x in run.from..run.to {
                let side = clip.map_or(Side::Inside, |clip| self.clips[clip as usize].sides[x]);
                if self.finished[x] || side == Side::Outside {
                    continue;
                }
                let clip = clip.filter(|_| side == Side::Partly);
                self.lists[x].push(Item { shape: number, border: run.cut.map(|cut| (place, cut)), clip });
                self.finished[x] = hides && clip.is_none() && run.cut.is_none();
            }
        }
        self.borders[self.borders_used] = border;
        self.borders_used += 1;
    }

    fn take_border(&mut self) -> BorderRow {
        if self.borders.len() == self.borders_used {
            self.borders.push(BorderRow::default());
        }
        std::mem::take(&mut self.borders[self.borders_used])
    }

    /// The clip's row, made when first asked for.
    fn clip(&mut self, picture: &Picture, y: u32, id: ClipId) -> u32 {
        if let Some(&number) = self.clip_numbers.get(&id) {
            return number;
        }
        let clip = &picture.scene.clips[id as usize];
        let mut members = Vec::new();
        for (member, outline) in clip.members.iter().zip(&picture.outlines.clips[id as usize]) {
            let within = member.clip.map(|inner| self.clip(picture, y, inner));
            members.push((self.border_of(picture, outline, y), within));
        }
        let within: Vec<u32> = clip.within.iter().map(|&other| self.clip(picture, y, other)).collect();
        let mut row = ClipRow { members, within, sides: Vec::new(), known: (0, false) };
        row.sides = row.sides(self.width, &self.clips);
        self.clips.push(row);
        let number = (self.clips.len() - 1) as u32;
        self.clip_numbers.insert(id, number);
        number
    }

    fn border_of(&mut self, picture: &Picture, outline: &PlacedOutline, y: u32) -> BorderRow {
        let mut row = BorderRow::default();
        if outline.bounds.is_some_and(|b| (b.top..b.bottom).contains(&(y as usize))) {
            self.maker.make(picture, outline, y, Window::row(y), &mut row);
        }
        row
    }

    /// Is nothing at all drawn in this pixel?
    pub fn is_empty(&self, pixel: usize) -> bool {
        self.lists[pixel].is_empty()
    }

    /// Does no border pass through this pixel?
    pub fn is_whole(&self, pixel: usize) -> bool {
        self.lists[pixel].iter().all(|item| item.border.is_none() && item.clip.is_none())
    }

    /// The corners of outlines that may be seen in this pixel, in fixed point pixels.
    pub fn corners(&self, pixel: usize, mut take: impl FnMut(i32, i32)) {
        let mut corners_of = |row: &BorderRow, cut: Cut| {
            for edge in row.edges_of(cut) {
                take(edge.x0, edge.y0);
                take(edge.x1, edge.y1);
            }
        };
        for item in &self.lists[pixel] {
            if let Some((border, cut)) = item.border {
                corners_of(&self.borders[border as usize], cut);
            }
            let clip = item.clip.map(|clip| &self.clips[clip as usize]);
            for (row, _) in clip.iter().flat_map(|clip| &clip.members) {
                if let Some(cut) = row.run_at(pixel).and_then(|run| run.cut) {
                    corners_of(row, cut);
                }
            }
        }
    }

    /// The colour at a point of the row, with what lies behind the drawing. A point on the picture's
    /// right or lower border belongs to the pixels inside.
    pub fn color(&mut self, picture: &Picture, x: i32, y: i32) -> Sheet {
        let x = x.min(((self.width as i32) << FRACTION_BITS) - 1);
        let y = y.min(((self.height as i32) << FRACTION_BITS) - 1);
        self.point += 1;
        let pixel = (x >> FRACTION_BITS) as usize;
        let mut open = OpenGroups::new();
        for at in 0..self.lists[pixel].len() {
            let Item { shape: number, border, clip } = self.lists[pixel][at];
            let shape = &picture.scene.shapes[number as usize];
            open.enter(picture.scene, shape.group);
            if open.is_hidden() {
                if open.groups.is_empty() {
                    break;
                }
                continue;
            }
            let inside = border.is_none_or(|(row, cut)| self.borders[row as usize].holds(cut, x, y))
                && clip.is_none_or(|clip| self.in_clip(clip, x, y));
            if inside {
                let sheet = match &shape.paint {
                    Paint::Flat(sheet) => *sheet,
                    _ => {
                        let shader = picture.around.shaders[number as usize].as_ref();
                        let pixels = |v: i32| f64::from(v) / f64::from(ONE);
                        shader.expect("gradients have shaders").at(pixels(x), pixels(y))
                    }
                };
                open.front = open.front.over(sheet);
            }
        }
        open.finish(picture.scene).over(picture.around.background)
    }

    /// The colour at a pixel's centre.
    pub fn middle(&mut self, picture: &Picture, pixel: usize, y: u32) -> Sheet {
        let middle = |v: i32| (v << FRACTION_BITS) + ONE / 2;
        self.color(picture, middle(pixel as i32), middle(y as i32))
    }

    fn in_clip(&mut self, number: u32, x: i32, y: i32) -> bool {
        let clip = &self.clips[number as usize];
        match clip.sides[(x >> FRACTION_BITS) as usize] {
            Side::Inside => return true,
            Side::Outside => return false,
            Side::Partly if clip.known.0 == self.point => return clip.known.1,
            Side::Partly => {}
        }
        let (members, others) = (clip.members.len(), clip.within.len());
        let inside = (0..others).all(|i| self.in_clip(self.clips[number as usize].within[i], x, y))
            && (0..members).any(|i| {
                let (row, within) = &self.clips[number as usize].members[i];
                let within = *within;
                row.holds_point(x, y) && within.is_none_or(|inner| self.in_clip(inner, x, y))
            });
        self.clips[number as usize].known = (self.point, inside);
        inside
    }
}

impl ClipRow {
    /// How each pixel lies to this clip; the clips that it refers to are known.
    fn sides(&self, width: usize, clips: &[ClipRow]) -> Vec<Side> {
        let mut sides = vec![Side::Outside; width];
        for (row, within) in &self.members {
            let within = within.map(|number| &clips[number as usize].sides);
            for run in row.runs() {
                let own = if run.cut.is_none() { Side::Inside } else { Side::Partly };
                for x in run.from..run.to {
                    let clipped = own.and(within.map_or(Side::Inside, |within| within[x]));
                    sides[x] = sides[x].or(clipped);
                }
            }
        }
        for &other in &self.within {
            let others = &clips[other as usize].sides;
            sides.iter_mut().zip(others).for_each(|(side, &other)| *side = side.and(other));
        }
        sides
    }
}

impl Side {
    fn and(self, other: Side) -> Side {
        match (self, other) {
            (Side::Outside, _) | (_, Side::Outside) => Side::Outside,
            (Side::Inside, Side::Inside) => Side::Inside,
            _ => Side::Partly,
        }
    }

    fn or(self, other: Side) -> Side {
        match (self, other) {
            (Side::Inside, _) | (_, Side::Inside) => Side::Inside,
            (Side::Outside, Side::Outside) => Side::Outside,
            _ => Side::Partly,
        }
    }
}

/// Composites sheets front to back, groups as one.
struct OpenGroups {
    /// What was drawn so far in the innermost group.
    front: Sheet,
    /// The groups that are open, outermost first, each with what stands in front of it.
    groups: Vec<(GroupId, Sheet)>,
}

impl OpenGroups {
    fn new() -> OpenGroups {
        OpenGroups { front: Sheet::CLEAR, groups: Vec::new() }
    }

    /// Opens and closes groups until `group` is the innermost.
    fn enter(&mut self, scene: &Scene, group: GroupId) {
        let innermost = |open: &OpenGroups| open.groups.last().map_or(0, |&(group, _)| group);
        while innermost(self) != group {
            // Parents stand before children, so a group with a larger number holds no other.
            if innermost(self) > group || !is_within(scene, group, innermost(self)) {
                self.close(scene);
                continue;
            }
            let mut next = group;
            while scene.groups[next as usize].parent != innermost(self) {
                next = scene.groups[next as usize].parent;
            }
            self.groups.push((next, std::mem::replace(&mut self.front, Sheet::CLEAR)));
        }
    }

    fn close(&mut self, scene: &Scene) {
        let (group, before) = self.groups.pop().expect("a group is open");
        self.front = before.over(self.front.faded(scene.groups[group as usize].opacity));
    }

    /// Can nothing that comes in this group be seen?
    fn is_hidden(&self) -> bool {
        let dark = |sheet: &Sheet| sheet.through() < NEGLIGIBLE;
        dark(&self.front) || self.groups.iter().any(|(_, before)| dark(before))
    }

    /// What was drawn, all groups closed.
    fn finish(mut self, scene: &Scene) -> Sheet {
        while !self.groups.is_empty() {
            self.close(scene);
        }
        self.front
    }
}

/// Does a group lie in another, or is it that one?
fn is_within(scene: &Scene, mut group: GroupId, outer: GroupId) -> bool {
    while group > outer {
        group = scene.groups[group as usize].parent;
    }
    group == outer
}
