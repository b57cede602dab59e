//! `beam`: takes a scene, makes the visible polygons of the whole picture, and their exact areas in each
//! pixel: Heckbert & Hanrahan, *Beam Tracing Polygonal Objects* (1984), seen in the plane.
//!
//! One beam, the picture's rectangle, meets the shapes front to back. Each cuts it into what the shape
//! covers, which is visible, and the rest, which goes on. No pixel is looked at until nothing hidden is
//! left; then areas are summed by Green's theorem. What is not opaque does not end the beam: the part
//! goes on beside the rest with a list of what lies in front of it, parts with the same list as one. In a
//! group it goes on until the group ends.
//!
//! Promises: an independent witness for `exact`: it shares the scene and the pen with it, and neither
//! flattening, strips, nor integrator. Opacity, groups, clips and shapes that are not smoothed are done as
//! they should be. Gradients are taken at the middle of what is visible in a pixel, of each part once:
//! where one is steep within a pixel, it and `exact` look at different places and may differ.
//! What it cannot do: large drawings. The work grows with the beam's edges times the shapes, and with
//! how often they cross; past a number of either it says so.

mod contours;
mod crossings;
mod region;
mod sums;

use self::contours::contours;
use self::region::{Region, Work};
use self::sums::Sums;
use crate::edges::ONE;
use crate::scene::gradient_shader::{Demands, GradientShader};
use crate::scene::paint::{Paint, Sheet};
use crate::scene::shader::Shader;
use crate::scene::{ClipId, FillRule, Geometry, GroupId, Outline, Scene};
use crate::{Error, Settings, Viewport};
use std::collections::HashMap;

/// The most parts of the beam that go on beside each other.
const MOST_PARTS: usize = 4096;
/// The most corners of all of them: some 200 MB.
const MOST_CORNERS: usize = 8_000_000;
/// The most pixels: sums take 40 bytes each.
const MOST_PIXELS: u64 = 1 << 23;

/// What lies in front of a part of the beam, front to back.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Item {
    Sheet(Sheet),
    /// By its shape's number.
    Gradient(u32),
    /// What follows, up to the matching end, fades by that end's opacity.
    GroupStart,
    GroupEnd(f32),
}

/// A part of the beam.
#[derive(Clone, Debug)]
struct Part {
    region: Region,
    front: Front,
}

/// What is known of all points of a part.
#[derive(Clone, Debug, Default, PartialEq)]
struct Front {
    items: Vec<Item>,
    /// The groups that are open, outermost first.
    open: Vec<GroupId>,
    /// Something opaque lies in the innermost of them: nothing more of that group can be seen.
    hidden: bool,
}

/// Paints a scene.
pub(super) fn paint(
    scene: &Scene,
    viewport: &Viewport,
    settings: &Settings,
    bytes: &mut [u8],
    stride: usize,
) -> Result<(), Error> {
    let (width, height) = (viewport.width, viewport.height);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(Error::Limit(format!(
            "the method beam makes pictures of up to {MOST_PIXELS} pixels, not {width} x {height}: use exact"
        )));
    }
    scene.refuse_rasters("beam")?;
    let sheet_of = |[r, g, b, a]: [u8; 4]| {
        let unit = |v: u8| f32::from(v) / 255.0;
        Sheet::new([r, g, b].map(unit), unit(a))
    };
    let background = settings.background.map_or(Sheet::CLEAR, sheet_of);
    let demands = Demands::new(scene, settings);
    let shader = |paint, geometry| match paint {
        &Paint::Flat(_) => None,
        Paint::Gradient(gradient) => {
            let shader = GradientShader::new(gradient, geometry, viewport, demands);
            Some(Shader::Gradient(Box::new(shader)))
        }
        Paint::Raster(_) | Paint::Layer(..) => unreachable!("refused above"),
    };
    let shaders: Vec<Option<Shader>> =
        scene.shapes.iter().map(|shape| shader(&shape.paint, &shape.geometry)).collect();
    let around = Around { shaders: &shaders, background };
    let mut tracer = Tracer {
        scene,
        viewport,
        tolerance: settings.tolerance,
        around: &around,
        clips: HashMap::new(),
        work: Work::new(),
        sums: Sums::new(width, height, settings.linear),
    };
    tracer.trace()?;
    for (y, row) in bytes.chunks_mut(stride).take(height as usize).enumerate() {
        tracer.sums.write(y, &mut row.as_chunks_mut().0[..width as usize]);
    }
    Ok(())
}

/// What all parts have in common.
struct Around<'a> {
    /// By shape number.
    shaders: &'a [Option<Shader<'a>>],
    /// Behind everything.
    background: Sheet,
}

struct Tracer<'a> {
    scene: &'a Scene,
    viewport: &'a Viewport,
    tolerance: f64,
    around: &'a Around<'a>,
    clips: HashMap<ClipId, Region>,
    work: Work,
    sums: Sums,
}

impl Tracer<'_> {
    /// Sends the beam through all shapes, front to back.
    fn trace(&mut self) -> Result<(), Error> {
        let (right, bottom) = (self.viewport.width as i32 * ONE, self.viewport.height as i32 * ONE);
        let mut beam = vec![Part { region: Region::rectangle(right, bottom), front: Front::default() }];
        for number in (0..self.scene.shapes.len()).rev() {
            if beam.is_empty() {
                return Ok(());
            }
            let shape = &self.scene.shapes[number];
            let mut region = self.region(&shape.geometry)?;
            if let Some(clip) = shape.clip {
                self.prepare_clip(clip)?;
                region = region.cut(&self.clips[&clip], &mut self.work)?.0;
            }
            if !region.is_empty() {
                beam = self.meet(beam, number as u32, &region)?;
            }
        }
        for part in beam {
            self.show(part);
        }
        Ok(())
    }

    /// Cuts all parts of the beam by one shape.
    fn meet(&mut self, beam: Vec<Part>, number: u32, shape: &Region) -> Result<Vec<Part>, Error> {
        let Tracer { scene, .. } = *self;
        let group = scene.shapes[number as usize].group;
        let (mut on, mut covered): (Vec<Part>, Vec<Part>) = Default::default();
        for mut part in beam {
            part.front.enter(scene, group);
            if part.front.hidden {
                on.push(part);
                continue;
            }
            let (inside, outside) = part.region.cut(shape, &mut self.work)?;
            if !inside.is_empty() {
                let mut front = part.front.clone();
                front.push(&scene.shapes[number as usize].paint, number);
                covered.push(Part { region: inside, front });
            }
            if !outside.is_empty() {
                on.push(Part { region: outside, front: part.front });
            }
        }
        for part in covered {
            if part.front.hidden && part.front.open.is_empty() {
                self.show(part);
            } else if let Some(same) = on.iter_mut().find(|other| other.front == part.front) {
                same.region.append(part.region);
            } else {
                on.push(part);
            }
        }
        let corners: usize = on.iter().map(|part| part.region.corners()).sum();
        if on.len() > MOST_PARTS || corners > MOST_CORNERS {
            return Err(Error::Limit(format!(
                "the method beam keeps up to {MOST_PARTS} parts with {MOST_CORNERS} corners: \
                 this drawing has too many translucent shapes over one another for it, use exact"
            )));
        }
        Ok(on)
    }

    /// Sums a part's areas: nothing more can come in front of what it shows.
    fn show(&mut self, Part { region, mut front }: Part) {
        front.enter(self.scene, 0);
        let is_even = front.items.iter().all(|item| !matches!(item, Item::Gradient(_)));
        let around = self.around;
        let even = is_even.then(|| compose(&front.items, around, (0.0, 0.0)));
        self.sums.add(&region, |x, y| even.unwrap_or_else(|| compose(&front.items, around, (x, y))));
    }

    /// What an outline fills.
    fn region(&mut self, geometry: &Geometry) -> Result<Region, Error> {
        let rule = match geometry.outline {
            Outline::Fill(rule) => rule,
            Outline::Stroke(_) | Outline::Pixels => FillRule::NonZero,
        };
        Region::new(&contours(geometry, self.viewport, self.tolerance), rule, &mut self.work)
    }

    /// Makes sure that the clip's region is known.
    fn prepare_clip(&mut self, id: ClipId) -> Result<(), Error> {
        if self.clips.contains_key(&id) {
            return Ok(());
        }
        let clip = &self.scene.clips[id as usize];
        let mut members = Region::default();
        for member in &clip.members {
            let mut own = self.region(&member.geometry)?;
            if let Some(inner) = member.clip {
                self.prepare_clip(inner)?;
                own = own.cut(&self.clips[&inner], &mut self.work)?.0;
            }
            members.append(own);
        }
        let mut region = members.united(&mut self.work)?;
        for &other in &clip.within {
            self.prepare_clip(other)?;
            region = region.cut(&self.clips[&other], &mut self.work)?.0;
        }
        self.clips.insert(id, region);
        Ok(())
    }
}

impl Front {
    /// Opens and closes groups until `group` is the innermost.
    fn enter(&mut self, scene: &Scene, group: GroupId) {
        let mut path = Vec::new();
        let mut inner = group;
        while inner != 0 {
            path.push(inner);
            inner = scene.groups[inner as usize].parent;
        }
        path.reverse();
        let common = self.open.iter().zip(&path).take_while(|(a, b)| a == b).count();
        while self.open.len() > common {
            let inner = self.open.pop().expect("one is open");
            self.close(scene.groups[inner as usize].opacity);
        }
        // Inside what is hidden nothing needs to be opened.
        if !self.hidden {
            for &inner in &path[common..] {
                self.open.push(inner);
                self.items.push(Item::GroupStart);
            }
        }
    }

    fn close(&mut self, opacity: f32) {
        self.hidden = false;
        match self.items[..] {
            [.., Item::GroupStart] => {
                self.items.pop();
            }
            [.., Item::GroupStart, Item::Sheet(sheet)] => {
                self.items.truncate(self.items.len() - 2);
                self.push_sheet(sheet.faded(opacity));
            }
            _ => self.items.push(Item::GroupEnd(opacity)),
        }
    }

    fn push(&mut self, paint: &Paint, number: u32) {
        match paint {
            Paint::Flat(sheet) => self.push_sheet(*sheet),
            _ => self.items.push(Item::Gradient(number)),
        }
        self.hidden = paint.is_opaque();
    }

    fn push_sheet(&mut self, behind: Sheet) {
        match self.items.last_mut() {
            Some(Item::Sheet(front)) => *front = front.over(behind),
            _ => self.items.push(Item::Sheet(behind)),
        }
    }
}

/// The colour of items at a point, with what lies behind the drawing.
fn compose(items: &[Item], around: &Around, (x, y): (f64, f64)) -> Sheet {
    let mut front = Sheet::CLEAR;
    let mut outer = Vec::new();
    for item in items {
        match *item {
            Item::Sheet(sheet) => front = front.over(sheet),
            Item::Gradient(number) => {
                let shader = around.shaders[number as usize].as_ref().expect("gradients have shaders");
                front = front.over(shader.at(x, y));
            }
            Item::GroupStart => outer.push(std::mem::replace(&mut front, Sheet::CLEAR)),
            Item::GroupEnd(opacity) => {
                let before = outer.pop().expect("groups end after they start");
                front = before.over(front.faded(opacity));
            }
        }
    }
    front.over(around.background)
}
