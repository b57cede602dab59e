//! Takes the shares that shapes have of pixels' footprints, makes pixels: paints shape over shape, from
//! the back, as if each share were a degree of opacity. `area` and `cone` differ in the footprint alone.
//!
//! A clip's share is that of its members united, times those of the clips that it refers to; a shape's is
//! multiplied by its clip's. A group is a picture of its own that is faded and laid over what is below.

use super::borders::{BorderRow, RowMaker};
use super::footprint::{window, Footprint, Ruler};
use super::BandPainter;
use crate::band::Picture;
use crate::cel::Rows;
use crate::edges::BAND_ROWS;
use crate::outlines::PlacedOutline;
use crate::scene::paint::{Paint, Sheet};
use crate::scene::{ClipId, GroupId};
use std::collections::HashMap;
use std::marker::PhantomData;

/// Paints shares over one another.
pub(super) struct SharePainter<F> {
    maker: RowMaker,
    ruler: Ruler,
    width: usize,
    height: u32,
    border: BorderRow,
    /// The picture's row, and one for each open group.
    layers: Vec<Vec<Sheet>>,
    open: Vec<GroupId>,
    clips: HashMap<ClipId, Vec<f32>>,
    footprint: PhantomData<fn(F)>,
}

impl<F: Footprint> SharePainter<F> {
    pub fn new(width: u32, height: u32) -> SharePainter<F> {
        SharePainter {
            maker: RowMaker::new(width, height),
            ruler: Ruler::default(),
            width: width as usize,
            height,
            border: BorderRow::default(),
            layers: vec![Vec::new()],
            open: vec![0],
            clips: HashMap::new(),
            footprint: PhantomData,
        }
    }

    /// Paints one row.
    fn row(&mut self, picture: &Picture, y: u32) {
        let width = self.width;
        let start = |layer: &mut Vec<Sheet>, sheet| {
            layer.clear();
            layer.resize(width, sheet);
        };
        start(&mut self.layers[0], picture.around.background);
        self.clips.clear();
        for &number in picture.bands.band((y / BAND_ROWS) as usize).iter().rev() {
            let shape = &picture.scene.shapes[number as usize];
            if !touches(&picture.outlines.shapes[number as usize], y) {
                continue;
            }
            self.enter_group(picture, shape.group);
            if let Some(clip) = shape.clip {
                self.clip(picture, y, clip);
            }
            self.shape(picture, y, number);
        }
        self.enter_group(picture, 0);
    }

    /// Paints one shape over what is there.
    fn shape(&mut self, picture: &Picture, y: u32, number: u32) {
        let shape = &picture.scene.shapes[number as usize];
        let window = window::<F>(y, self.height);
        let mut border = std::mem::take(&mut self.border);
        self.maker.make(picture, &picture.outlines.shapes[number as usize], y, window, &mut border);
        let clip = shape.clip.map(|clip| &self.clips[&clip]);
        let layer = self.layers.get_mut(self.open.len() - 1).expect("one for each open group");
        let linear = picture.around.linear;
        for run in border.runs() {
            for x in run.from..run.to {
                let clip = clip.map_or(1.0, |clip| clip[x]);
                if clip <= 0.0 {
                    continue;
                }
                let own =
                    run.cut.map_or(1.0, |cut| self.ruler.share::<F>(&border, cut, (x, y), window) as f32);
                let sheet = match &shape.paint {
                    Paint::Flat(sheet) => *sheet,
                    _ => {
                        let shader = picture.around.shaders[number as usize].as_ref();
                        shader.expect("gradients have shaders").at(x as f64 + 0.5, f64::from(y) + 0.5)
                    }
                };
                layer[x] = mix(layer[x], sheet.over(layer[x]), own * clip, linear);
            }
        }
        self.border = border;
    }

    /// Opens and closes groups until `group` is the innermost.
    fn enter_group(&mut self, picture: &Picture, group: GroupId) {
        if self.open.last() == Some(&group) {
            return;
        }
        let groups = &picture.scene.groups;
        let path = picture.scene.group_path(group);
        let common = self.open.iter().zip(&path).take_while(|(a, b)| a == b).count();
        while self.open.len() > common {
            let opacity = groups[self.open.pop().expect("one is open") as usize].opacity;
            let (outer, inner) = self.layers.split_at_mut(self.open.len());
            for (below, sheet) in outer[self.open.len() - 1].iter_mut().zip(&inner[0]) {
                *below = sheet.faded(opacity).over(*below);
            }
        }
        for &inner in &path[common..] {
            if self.layers.len() == self.open.len() {
                self.layers.push(Vec::new());
            }
            let layer = &mut self.layers[self.open.len()];
            layer.clear();
            layer.resize(self.width, Sheet::CLEAR);
            self.open.push(inner);
        }
    }

    /// Makes sure that the clip's shares of this row are known.
    fn clip(&mut self, picture: &Picture, y: u32, id: ClipId) {
        if self.clips.contains_key(&id) {
            return;
        }
        let clip = &picture.scene.clips[id as usize];
        let inner = clip.members.iter().filter_map(|member| member.clip);
        inner.chain(clip.within.iter().copied()).for_each(|other| self.clip(picture, y, other));
        // The share that no member covers.
        let mut outside = vec![1.0f32; self.width];
        for (member, outline) in clip.members.iter().zip(&picture.outlines.clips[id as usize]) {
            if !touches(outline, y) {
                continue;
            }
            let window = window::<F>(y, self.height);
            self.maker.make(picture, outline, y, window, &mut self.border);
            let within = member.clip.map(|inner| &self.clips[&inner]);
            for run in self.border.runs() {
                for x in run.from..run.to {
                    let share = |cut| self.ruler.share::<F>(&self.border, cut, (x, y), window) as f32;
                    outside[x] *= 1.0 - run.cut.map_or(1.0, share) * within.map_or(1.0, |within| within[x]);
                }
            }
        }
        let mut shares: Vec<f32> = outside.iter().map(|outside| 1.0 - outside).collect();
        for other in &clip.within {
            shares.iter_mut().zip(&self.clips[other]).for_each(|(share, other)| *share *= other);
        }
        self.clips.insert(id, shares);
    }
}

/// May an outline be seen in a row? Its bounds leave room for footprints.
fn touches(outline: &PlacedOutline, y: u32) -> bool {
    outline.bounds.is_some_and(|bounds| (bounds.top..bounds.bottom).contains(&(y as usize)))
}

/// A pixel of which this share looks like `there`, and the rest like `here`.
fn mix(here: Sheet, there: Sheet, share: f32, linear: bool) -> Sheet {
    if share >= 1.0 {
        return there;
    }
    if linear {
        return mix(here.to_linear(), there.to_linear(), share, false).to_srgb();
    }
    let (here, there) = (here.channels(), there.channels());
    Sheet::from_channels(std::array::from_fn(|i| here[i] + (there[i] - here[i]) * share))
}

impl<F: Footprint> BandPainter for SharePainter<F> {
    fn render(&mut self, picture: &Picture, _band: usize, mut rows: Rows) {
        for row in 0..rows.count {
            self.row(picture, rows.top + row as u32);
            let pixels = rows.row(row, self.width);
            for (pixel, sheet) in pixels.iter_mut().zip(&self.layers[0]) {
                *pixel = sheet.to_rgba8();
            }
        }
    }
}
