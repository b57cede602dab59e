//! Takes a pixel's z-list, front to back, makes its colour: finds the visible regions by the cheapest
//! way that is exact for it, composites the paint of each region once, and mixes them by area.
//!
//! Promises: the weights are integers, none negative, and sum exactly to the pixel.

mod sampling;

use super::boundary::Boundary;
use super::few::Few;
use super::fragment::{Fragment, PieceSet, PIXEL_AREA};
use super::paint_tree::{Composite, Effect, PaintTree};
use super::sample::Sampler;
use super::split::{centroid, Integrator, Known, MOST_LEAVES};
use crate::edges::ONE;
use crate::scene::gradient_shader::Chord;
use crate::scene::paint::Sheet;
use crate::scene::shader::{Shader, Spot};
use crate::strips::Piece;
use crate::zlist::groups::KnownColors;
use crate::zlist::{Borders, ZLists};
use kurbo::Point;
use std::cell::RefCell;
use usvg::BlendMode;

/// Less light than this from behind cannot be seen: a thirtieth of an 8-bit level.
pub(crate) const NEGLIGIBLE: f32 = 1.0 / 8192.0;

/// Where in a pixel something is painted: a formula over fragments.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Node {
    Leaf(Fragment),
    And(u32, u32),
    Or(u32, u32),
}

/// A formula of the pixel at hand; numbers are places in [`Resolver::formulas`].
#[derive(Clone, Copy, Debug)]
enum Formula {
    Leaf(usize),
    And(usize, usize),
    Or(usize, usize),
}

/// One entry of the z-list.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Item {
    /// A sheet of one colour over all of the pixel, or where the formula holds.
    Sheet(Sheet, Option<usize>),
    /// The same, and nothing behind it is seen there.
    Knockout(Sheet, Option<usize>),
    /// A sheet with a gradient, by its shape's number. With it goes what the integrator knows the lines by at which
    /// the gradient jumps in the pixel, if there are any.
    Gradient(u32, Option<usize>, Option<usize>),
    /// A blended group of one colour. Its backdrop follows.
    Blended(BlendMode, Sheet),
    /// What follows, up to the matching end, composites as one.
    GroupStart(Composite),
    GroupMiddle,
    GroupEnd,
}

/// How many pixels went which way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    pub one_fragment: u64,
    pub tiled: u64,
    pub few: u64,
    pub along_borders: u64,
    pub split: u64,
    pub sampled: u64,
}

/// Resolves z-lists; keeps its buffers from one pixel to the next.
#[derive(Default)]
pub(crate) struct Resolver {
    items: Vec<Item>,
    formulas: Vec<Formula>,
    leaves: Vec<Fragment>,
    /// What the leaves are known by: their borders' sum, and their area.
    identities: Vec<Option<(u64, i64)>>,
    /// Formulas that several items share, by their node.
    shared: Vec<(u32, usize)>,
    has_gradient: bool,
    /// Does the list blend?
    has_blends: bool,
    /// The lines at which gradients jump, and for each gradient with any where its own end.
    chords: Vec<Chord>,
    cuts: Vec<usize>,
    tree: RefCell<PaintTree>,
    /// Does the scene have clips?
    pub has_clips: bool,
    /// Does it have groups?
    pub has_groups: bool,
    /// Is any shape of the picture not of one colour?
    pub has_shaders: bool,
    pub known_colors: KnownColors,
    set: PieceSet,
    pub few: Few,
    boundary: Boundary,
    integrator: Integrator,
    sampler: Sampler,
    pub counts: Counts,
}

/// What a picture's pixels have in common.
pub(crate) struct Surroundings<'a> {
    /// By shape number.
    pub shaders: &'a [Option<Shader<'a>>],
    /// Behind everything.
    pub background: Sheet,
    pub linear: bool,
    /// As [`crate::Settings::most_work`].
    pub most_work: u32,
}

impl<'a> Surroundings<'a> {
    /// The shader of a shape that is not of one colour.
    #[inline]
    pub fn shader(&self, shape: u32) -> &Shader<'a> {
        self.shaders[shape as usize].as_ref().expect("gradients have shaders")
    }
}

impl Resolver {
    /// Starts a z-list.
    pub fn clear(&mut self) {
        self.items.clear();
        self.formulas.clear();
        self.leaves.clear();
        self.identities.clear();
        self.shared.clear();
        self.chords.clear();
        self.cuts.clear();
        (self.has_gradient, self.has_blends) = (false, false);
    }

    pub fn push_sheet(&mut self, sheet: Sheet, node: Option<u32>, lists: &ZLists) {
        let formula = node.map(|node| self.formula(node, lists));
        self.items.push(Item::Sheet(sheet, formula));
    }

    pub fn push_knockout(&mut self, sheet: Sheet, node: Option<u32>, lists: &ZLists) {
        let formula = node.map(|node| self.formula(node, lists));
        self.items.push(Item::Knockout(sheet, formula));
    }

    pub fn push_gradient(&mut self, shape: u32, node: Option<u32>, lists: &ZLists) {
        let formula = node.map(|node| self.formula(node, lists));
        self.items.push(Item::Gradient(shape, formula, None));
        self.has_gradient = true;
    }

    /// Adds a group's mark.
    pub fn push(&mut self, mark: Item) {
        let blends = |composite: &Composite| matches!(composite.effect, Effect::Blend(_));
        self.has_blends |= match &mark {
            Item::Blended(..) => true,
            Item::GroupStart(composite) => blends(composite),
            _ => false,
        };
        self.items.push(mark);
    }

    /// The formula of a node; a node that several items share gives one formula.
    fn formula(&mut self, node: u32, lists: &ZLists) -> usize {
        // Only clips are shared.
        if self.has_clips {
            if let Some(&(_, formula)) = self.shared.iter().find(|(shared, _)| *shared == node) {
                return formula;
            }
        }
        let formula = match lists.nodes[node as usize] {
            Node::Leaf(fragment) => Formula::Leaf(self.leaf(fragment, lists.pieces)),
            Node::And(a, b) => Formula::And(self.formula(a, lists), self.formula(b, lists)),
            Node::Or(..) => self.union(node, lists),
        };
        self.formulas.push(formula);
        let index = self.formulas.len() - 1;
        if self.has_clips {
            self.shared.push((node, index));
        }
        index
    }

    /// The number of a fragment. One with the border and the area of another is the same.
    fn leaf(&mut self, fragment: Fragment, pieces: &[Piece]) -> usize {
        let mut borders = Borders::default();
        borders.add(&fragment, pieces);
        let identity = borders.identity().map(|sum| (sum, fragment.area()));
        if identity.is_some() {
            let near = self.identities.iter().enumerate().rev().take(MOST_LEAVES);
            if let Some((same, _)) = near.into_iter().find(|(_, other)| **other == identity) {
                return same;
            }
        }
        self.leaves.push(fragment);
        self.identities.push(identity);
        self.leaves.len() - 1
    }

    /// The formula of a union, whose left side may be a long chain of unions.
    fn union(&mut self, mut node: u32, lists: &ZLists) -> Formula {
        let mut members = Vec::new();
        while let Node::Or(others, member) = lists.nodes[node as usize] {
            members.push(member);
            node = others;
        }
        let mut union = self.formula(node, lists);
        let last = members.remove(0);
        for &member in members.iter().rev() {
            let member = self.formula(member, lists);
            self.formulas.push(Formula::Or(union, member));
            union = self.formulas.len() - 1;
        }
        Formula::Or(union, self.formula(last, lists))
    }

    /// The mean colour of the pixel at column `x` and row `y` of the picture.
    pub fn resolve(&mut self, x: u32, y: u32, pieces: &[Piece], around: &Surroundings) -> Mean {
        let place = Place { x: f64::from(x), y: f64::from(y), around };
        let mut mean = Mean::default();
        if self.has_gradient {
            if self.must_cut(around) {
                self.cut_gradients(place);
            }
            match self.leaves.is_empty() && self.cuts.is_empty() {
                true => mean.add(self.sheet_of(|_| false, place), PIXEL_AREA, around.linear),
                false => self.split(place, pieces, &mut mean),
            }
        } else if let [only] = self.leaves[..] {
            self.counts.one_fragment += 1;
            mean.add(self.sheet_of(|_| true, place), only.area(), around.linear);
            mean.add(self.sheet_of(|_| false, place), PIXEL_AREA - only.area(), around.linear);
        } else if self.tiles(pieces) {
            self.counts.tiled += 1;
            for (leaf, fragment) in self.leaves.iter().enumerate() {
                mean.add(self.sheet_of(|other| other == leaf, place), fragment.area(), around.linear);
            }
        } else if self.along_borders(place, pieces, &mut mean) {
            self.counts.along_borders += 1;
        } else {
            self.split(place, pieces, &mut mean);
        }
        mean
    }

    /// Is the colour of a region with gradients in it not what their means make of it? So it is with more than one,
    /// and with one if it is blended.
    fn must_cut(&self, around: &Surroundings) -> bool {
        let is_gradient = |item: &&Item| matches!(item, Item::Gradient(..));
        self.has_blends || around.linear || self.items.iter().filter(is_gradient).count() > 1
    }

    /// Finds the lines between which gradients change little.
    fn cut_gradients(&mut self, place: Place) {
        let (x, y) = place.middle();
        for item in &mut self.items {
            if let Item::Gradient(shape, _, cut) = item {
                let before = self.chords.len();
                place.around.shader(*shape).cut(Point::new(x, y), &mut self.chords);
                let number = self.leaves.len() + self.cuts.len();
                if self.chords.len() > before && number < MOST_LEAVES {
                    *cut = Some(number);
                    self.cuts.push(self.chords.len());
                }
            }
        }
    }

    /// The closed form, where borders do not cross.
    fn along_borders(&mut self, place: Place, pieces: &[Piece], mean: &mut Mean) -> bool {
        if self.leaves.iter().any(|leaf| leaf.sense == 0) {
            return false;
        }
        let mut boundary = std::mem::take(&mut self.boundary);
        boundary.clear();
        for leaf in &self.leaves {
            boundary.add(leaf, pieces);
        }
        let regions = boundary.regions();
        for &(set, area) in regions.unwrap_or(&[]) {
            if area > 0 {
                mean.add(self.sheet_of(|leaf| set >> leaf & 1 != 0, place), area, place.around.linear);
            }
        }
        let done = regions.is_some();
        self.boundary = boundary;
        done
    }

    /// The colour of a region of which it is known whether it lies inside each fragment.
    fn sheet_of(&self, inside: impl Fn(usize) -> bool, place: Place) -> Sheet {
        let sheet = self.compose(&|leaf| Some(inside(leaf)), Some(place.whole()), place.around);
        sheet.expect("every fragment is known")
    }

    /// Do the fragments tile the pixel?
    fn tiles(&self, pieces: &[Piece]) -> bool {
        let mut borders = Borders::default();
        self.leaves.iter().map(Fragment::area).sum::<i64>() == PIXEL_AREA && {
            self.leaves.iter().for_each(|leaf| borders.add(leaf, pieces));
            borders.cancel()
        }
    }

    /// Catmull's integrator, or sub-scanlines past its cap.
    fn split(&mut self, place: Place, pieces: &[Piece], mean: &mut Mean) {
        let linear = place.around.linear;
        let mut integrator = std::mem::take(&mut self.integrator);
        let mut done = Err(super::split::TooComplex);
        let mut polygon = Vec::new();
        if self.leaves.len() <= MOST_LEAVES {
            integrator.clear();
            for leaf in &self.leaves {
                self.set.gather(leaf.pieces, leaf.cover_left, pieces);
                integrator.add(&self.set, leaf.rule);
            }
            let mut from = 0;
            for &to in &self.cuts {
                let ends = |chord: &Chord| chord.map(|end| place.fixed(end));
                integrator.add_lines(self.chords[from..to].iter().map(ends));
                from = to;
            }
            let is_known = |known: Known| {
                move |leaf| (known.known >> leaf & 1 != 0).then_some(known.inside >> leaf & 1 != 0)
            };
            done = integrator.integrate(
                place.around.most_work,
                |known| self.compose(&is_known(known), None, place.around).err(),
                |known, area, corners| {
                    polygon.clear();
                    let centre = centroid(corners).filter(|_| self.has_gradient);
                    let spot = match centre {
                        None => place.whole(),
                        Some(centre) => {
                            polygon.extend(corners.iter().map(|c| place.point((c.x, c.y))));
                            Spot::Polygon(place.point(centre), &polygon)
                        }
                    };
                    let sheet = self.compose(&is_known(known), Some(spot), place.around);
                    mean.add(sheet.expect("the integrator knows what was wanted"), area, linear);
                },
            );
        }
        self.integrator = integrator;
        match done {
            Ok(()) => self.counts.split += 1,
            Err(super::split::TooComplex) => {
                self.counts.sampled += 1;
                *mean = self.sample(place, pieces);
            }
        }
    }

    /// Composites the items over a region, front to back. `known` says whether the region lies inside
    /// a fragment; the first one that matters and is not known is the error. Gradients are taken
    /// over a spot. Without one they are opaque only if they are so everywhere, so that whatever
    /// could matter at some point is asked for.
    fn compose(
        &self,
        known: &impl Fn(usize) -> Option<bool>,
        spot: Option<Spot>,
        around: &Surroundings,
    ) -> Result<Sheet, usize> {
        let mut tree = self.tree.borrow_mut();
        tree.clear();
        // The lines of the only gradient so far, which do not matter if there is no other.
        let mut lines = None;
        let cut = |lines: Option<usize>| match lines.filter(|&lines| known(lines).is_none()) {
            Some(lines) => Err(lines),
            None => Ok(()),
        };
        for item in &self.items {
            match *item {
                Item::GroupStart(composite) => tree.start(composite),
                Item::GroupMiddle => tree.middle(),
                Item::GroupEnd => tree.end(),
                _ if tree.is_done() => break,
                _ if tree.is_hidden() => {}
                Item::Sheet(sheet, formula) => {
                    if self.holds(formula, known)? {
                        tree.paint(sheet);
                    }
                }
                Item::Knockout(sheet, formula) => {
                    if self.holds(formula, known)? {
                        tree.knock_out(sheet);
                    }
                }
                Item::Blended(mode, source) => tree.blend(mode, source),
                Item::Gradient(shape, formula, own_lines) => {
                    if self.holds(formula, known)? {
                        let shader = around.shader(shape);
                        match spot {
                            Some(spot) => tree.paint(shader.over(spot)),
                            None => {
                                let is_only = lines.is_none() && !self.must_cut(around);
                                if !(is_only || tree.is_empty() && shader.is_opaque()) {
                                    cut(lines.flatten())?;
                                    cut(own_lines)?;
                                }
                                lines = Some(own_lines);
                                tree.paint_vaguely(shader.least());
                            }
                        }
                    }
                }
            }
        }
        Ok(tree.over(around.background))
    }

    fn holds(&self, formula: Option<usize>, known: &impl Fn(usize) -> Option<bool>) -> Result<bool, usize> {
        let Some(mut formula) = formula else {
            return Ok(true);
        };
        loop {
            match self.formulas[formula] {
                Formula::Leaf(leaf) => return known(leaf).ok_or(leaf),
                Formula::And(a, b) => return Ok(self.holds(Some(a), known)? && self.holds(Some(b), known)?),
                Formula::Or(others, member) => {
                    if self.holds(Some(member), known)? {
                        return Ok(true);
                    }
                    formula = others;
                }
            }
        }
    }

    /// Regions that the integrator has made since this was last asked.
    pub fn take_nodes(&mut self) -> u64 {
        std::mem::take(&mut self.integrator.nodes)
    }
}

/// A pixel of the picture.
#[derive(Clone, Copy)]
struct Place<'a> {
    x: f64,
    y: f64,
    around: &'a Surroundings<'a>,
}

impl Place<'_> {
    /// Fixed point in the pixel to pixels in the picture.
    fn point(&self, (x, y): (f64, f64)) -> Point {
        Point::new(self.x + x / f64::from(ONE), self.y + y / f64::from(ONE))
    }

    /// The inverse.
    fn fixed(&self, p: Point) -> (f64, f64) {
        ((p.x - self.x) * f64::from(ONE), (p.y - self.y) * f64::from(ONE))
    }

    fn whole(&self) -> Spot<'static> {
        let (x, y) = self.middle();
        Spot::Pixel(x, y)
    }

    fn middle(&self) -> (f64, f64) {
        (self.x + 0.5, self.y + 0.5)
    }
}

/// Colours weighted by area: premultiplied, sRGB-encoded or linear. The sums are exact, so that the
/// order of the regions does not matter: a colour has 22 binary digits behind the point, an area 29.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    /// Red, green, blue and transmittance, times the area in the units of [`PIXEL_AREA`].
    sums: [f64; 4],
}

impl Mean {
    #[inline]
    pub fn add(&mut self, sheet: Sheet, area: i64, linear: bool) {
        debug_assert!((0..=PIXEL_AREA).contains(&area));
        let sheet = if linear { sheet.to_linear() } else { sheet };
        let area = area as f64;
        for (sum, share) in self.sums.iter_mut().zip(sheet.rounded_channels()) {
            *sum += f64::from(share) * area;
        }
    }

    /// The one rounding: to straight 8-bit RGBA, sRGB-encoded.
    #[inline]
    pub fn to_rgba8(self, linear: bool) -> [u8; 4] {
        const SCALE: f64 = 1.0 / PIXEL_AREA as f64;
        let sheet = Sheet::from_channels(self.sums.map(|sum| (sum * SCALE) as f32));
        if linear {
            return sheet.to_srgb().to_rgba8();
        }
        sheet.to_rgba8()
    }
}
