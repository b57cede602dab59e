//! Takes a gradient at a picture's scale, makes the colours of rows, of pixels and of parts of them.
//!
//! Its colour over a region is that at the region's centre as long as the colour map goes straight there.
//! Where the map turns or jumps within the region, it is the mean ([`super::color_map`]), for which the
//! parameter is taken to be linear; where the circles of a radial gradient are too small for that, the region is
//! cut ([`parts`]). Where what lies before or behind a region changes with the gradient, its mean will not do: the
//! caller is told by which lines to cut it ([`cuts`]).
//!
//! Where the map turns in every pixel and pixels are many, rows of them ([`rows`]) have their means from tables
//! ([`spots`]); whether there are any is a matter of the shape and the picture, not of which of its pixels are asked
//! for.

mod circles;
mod cuts;
mod parts;
mod pattern;
mod rows;
mod spots;
mod stretch;

pub(crate) use cuts::Chord;
pub(crate) use rows::LeftOut;

use super::color_map::ColorMap;
use super::paint::{Gradient, Sheet, Spread, Stop};
use super::shader::sheet_of;
use crate::outlines::bounds_in_pixels;
use crate::scene::Geometry;
use crate::scene::{Group, Role, Scene};
use crate::{Method, Settings, Viewport};
use kurbo::{Affine, Point, Rect, Vec2};
use parts::{square_of, MOST_HALVINGS};
use pattern::{Local, Pattern};
use spots::{Demand, Filtered, Spots};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::OnceLock;
use stretch::{Stretch, Stretches};

/// What gradients of a scene are asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demands {
    /// As [`crate::Settings::spot_scale`].
    spot_scale: f64,
    /// As [`crate::Settings::linear`].
    linear: bool,
    /// Does the scene have masks or blend modes, which may make anything of colours?
    has_effects: bool,
    /// Are they asked for parts of pixels? Other methods look at points, around which they get means.
    by_parts: bool,
}

impl Demands {
    pub fn new(scene: &Scene, settings: &Settings) -> Demands {
        let Settings { spot_scale, linear, method, .. } = *settings;
        let is_effect =
            |group: &Group| matches!(group.role, Role::Mask(_) | Role::Masked(_) | Role::Blend(_));
        let has_effects = scene.groups.iter().any(is_effect);
        Demands { spot_scale, linear, has_effects, by_parts: method == Method::Exact }
    }
}

/// A gradient at a picture's scale.
#[derive(Clone, Debug)]
pub(crate) struct GradientShader<'a> {
    gradient: &'a Gradient,
    pattern: Pattern,
    stretches: Stretches,
    /// From the gradient's plane.
    to_pixels: Affine,
    spot_scale: f64,
    /// Are means taken in linear light?
    linear: bool,
    /// The components whose differences within a pixel matter to what they are laid over or under.
    mattering: Range<usize>,
    /// Does it matter whether it has colour in all of a pixel?
    ends_at_borders: bool,
    /// Below it the circles of a radial gradient, if they lie within one another, may be too small for the colour in
    /// the middle of a pixel to be the mean, even where the map goes straight.
    apex: f64,
    /// At least the change of any component with the parameter, but for jumps.
    steepness: f64,
    /// At least any of its jumps, 0 ..= 1.
    jump: f64,
    /// At least the change of any component within a pixel, 0 ..= 1.
    contrast: f64,
    /// Is no pixel where the map goes straight?
    turns_everywhere: bool,
    /// Made for the first region in which the colour map turns.
    map: OnceLock<ColorMap>,
    /// The pixels that may be asked for, if none is where the map goes straight.
    pixels: f64,
    /// Planned for the first of them.
    spots: OnceLock<Option<Spots>>,
}

/// A gradient whose colours change by no more than this within a pixel is even there. A region that is a
/// share s of the pixel has its centre at most (1 - s) / 2 from the pixel's, so that the pixel's colour is
/// off by at most s (1 - s) / 2 of the change: a quarter of an 8-bit level.
const EVEN: f64 = 2.0 / 255.0;

/// A gradient that changes by no more than this within a pixel is laid over others as its mean: a border through
/// the pixel's middle makes an eighth of it, a level. That is of its alpha; of its colours it is twice as much, as
/// they are mixed with others only under effects and in linear light.
const NEARLY_EVEN: [f32; 4] = [16.0 / 255.0, 16.0 / 255.0, 16.0 / 255.0, 8.0 / 255.0];

/// The straight components of a colour that are mixed with the light that it lets through, and all of them.
const ALPHA: Range<usize> = 3..4;
const ALL: Range<usize> = 0..4;

/// What the colour in the middle of a pixel may be off by because circles are no straight lines, where the map
/// goes straight.
const MOST_LIFT: f64 = 0.125 / 255.0;

/// The lift as a share of the parameter's reach, beyond which it is not all that bends do.
const MOST_SHARE_OF_LIFT: f64 = 0.02;

/// What a pixel may be off by because circles are no straight lines, where the map turns.
const MOST_CURVE: f64 = 0.15 / 255.0;

/// The change of a component between two cuts. Of what two gradients that change together make of a third, a twelfth
/// of the changes' product is lost; of light in which one changes, up to six twelfths of its square near black.
const MOST_CHANGE: f32 = 1.0 / 6.0;
const MOST_CHANGE_OF_LIGHT: f32 = 1.0 / 8.0;

/// Parts of a full change of colour between which it is taken to go straight in linear light: a tenth of a level.
const LIGHT_PARTS: f32 = 64.0;

/// The corners of a square of side 1 around its middle.
const CORNERS: [Vec2; 4] =
    [Vec2::new(-0.5, -0.5), Vec2::new(0.5, -0.5), Vec2::new(0.5, 0.5), Vec2::new(-0.5, 0.5)];

impl<'a> GradientShader<'a> {
    /// Of a shape in a picture.
    pub fn new(
        gradient: &'a Gradient,
        geometry: &Geometry,
        viewport: &Viewport,
        Demands { spot_scale, linear, has_effects, by_parts }: Demands,
    ) -> GradientShader<'a> {
        let to_pixels = viewport.transform * gradient.transform;
        let pattern = Pattern::new(gradient.shape, to_pixels.inverse());
        let stretches = Stretches::new(&gradient.stops, gradient.spread, linear);
        let (steepness, farthest) = (stretches.steepness(), pattern.farthest());
        let change = if steepness > 0.0 { steepness * 2.0 * farthest } else { 0.0 };
        let apex = match &pattern {
            Pattern::Cone(cone) => cone.straight_from(MOST_LIFT / steepness),
            Pattern::Linear { .. } | Pattern::Circles(_) => f64::NEG_INFINITY,
        };
        let turns_everywhere = farthest.is_finite() && stretches.longest() < 2.0 * farthest * spot_scale;
        // Other spots are means of what lies around a pixel.
        let has_parts = by_parts && spot_scale == 1.0;
        let mattering = match linear || has_effects {
            true if has_parts => ALL,
            false if has_parts && !has_one_alpha(&gradient.stops) => ALPHA,
            _ => 0..0,
        };
        GradientShader {
            gradient,
            to_pixels,
            spot_scale,
            linear,
            ends_at_borders: has_parts && !pattern.borders().is_empty(),
            mattering,
            steepness,
            jump: greatest_jump(gradient),
            apex,
            contrast: (greatest_jump(gradient) + change).min(1.0),
            turns_everywhere,
            pattern,
            stretches,
            map: OnceLock::new(),
            pixels: if turns_everywhere { pixels_in(geometry, viewport) } else { 0.0 },
            spots: OnceLock::new(),
        }
    }

    /// Does it hide what lies behind, everywhere?
    pub fn is_opaque(&self) -> bool {
        self.gradient.opaque
    }

    /// Did the colour map turn within a pixel?
    pub fn has_table(&self) -> bool {
        self.map.get().is_some()
    }

    /// Bytes of its tables, if the colour map turns within a pixel.
    pub fn table_bytes(&self) -> u64 {
        ColorMap::bytes(self.light_stops().len()) + self.spots().map_or(0, Spots::bytes)
    }

    /// The colour of the pixel around a point, in pixels; clear where a radial gradient has none.
    pub fn at(&self, x: f64, y: f64) -> Sheet {
        self.pixel(Point::new(x, y), &mut None)
    }

    /// See [`super::shader::Shader::even_at`].
    pub fn even_at(&self, x: f64, y: f64) -> Option<Sheet> {
        let centre = Point::new(x, y);
        if self.is_partly_clear(&square_of(centre, 1.0)) {
            return None;
        }
        let Some(local) = self.pattern.local(centre) else {
            return Some(self.least());
        };
        let (stretch, far) = (self.stretches.around(local.t), local.far(self.spot_scale));
        let is_even = self.keeps_mean(&local)
            && stretch.holds(local.t - far, local.t + far)
            && stretch.steepness() * 2.0 * far <= EVEN;
        is_even.then(|| stretch.at(local.t))
    }

    /// May there be a pixel on a stretch whose colours differ so much that it matters, if the parameter changes by
    /// no more than `far` to either side?
    #[inline]
    fn may_be_uneven(&self, stretch: &Stretch, far: f64) -> bool {
        stretch.changes(self.mattering.clone(), NEARLY_EVEN.map(|most| f64::from(most) / (2.0 * far)))
    }

    /// Do the colours in the pixel around a point differ so much that it matters?
    #[inline(never)]
    fn is_uneven(&self, centre: Point) -> bool {
        let differ = |range| self.stretches.differ(range, self.mattering.clone(), NEARLY_EVEN);
        self.ends_at_borders && self.is_partly_clear(&square_of(centre, 1.0))
            || !self.mattering.is_empty() && self.pattern.range(centre).is_some_and(differ)
    }

    /// Adds chords between which the colours change little in the pixel around a point.
    pub fn cut(&self, centre: Point, chords: &mut Vec<Chord>) {
        for &border in self.pattern.borders() {
            cuts::of_line(border, centre, chords);
        }
        let most_change = if self.linear { MOST_CHANGE_OF_LIGHT } else { MOST_CHANGE };
        let parameters = self.pattern.range(centre).map(|range| self.stretches.cuts(range, most_change));
        for t in parameters.unwrap_or_default() {
            cuts::of_parameter(&self.pattern, (self.gradient.shape, self.to_pixels), t, centre, chords);
        }
    }

    /// The colour of the pixel around a point. `stretch` is one that may hold it, and is replaced if it does not.
    fn pixel(&self, centre: Point, stretch: &mut Option<Stretch>) -> Sheet {
        let side = self.spot_scale;
        let corners = square_of(centre, side);
        if self.is_partly_clear(&corners) {
            return self.mean_of_colored(&corners);
        }
        let Some(local) = self.pattern.local(centre) else {
            return self.least();
        };
        let (t, far) = (local.t + side * side * local.lift(), local.far(side));
        let stretch = stretch.get_or_insert_with(|| self.stretches.around(t));
        if !stretch.holds(t - far, t + far) {
            *stretch = self.stretches.around(t);
        }
        let straight_enough =
            || self.keeps_mean(&local) || self.is_straight(&local, side * side) || bends_little(&local);
        match stretch.holds(t - far, t + far) && straight_enough() {
            true => stretch.at(t),
            false => self.mean(centre, &local),
        }
    }

    /// The mean over the spot around a point.
    #[inline]
    fn mean(&self, centre: Point, local: &Local) -> Sheet {
        let side = self.spot_scale;
        let t = local.t + side * side * local.lift();
        let mean = if self.is_straight(local, side * side) {
            self.map().over_square(t, (side * local.along.x, side * local.along.y))
        } else {
            self.square(centre, side, MOST_HALVINGS).mean()
        };
        mean.map_or_else(|| self.stretches.around(t).at(t), |mean| self.sheet_of(mean))
    }

    /// The colour with this premultiplied mean.
    #[inline]
    fn sheet_of(&self, mean: [f32; 4]) -> Sheet {
        let sheet = sheet_of(mean);
        if self.linear {
            sheet.to_srgb()
        } else {
            sheet
        }
    }

    /// The inverse.
    fn color_of(&self, sheet: Sheet) -> [f32; 4] {
        color_of(if self.linear { sheet.to_linear() } else { sheet })
    }

    /// Is the colour in the middle of a pixel the mean, where the map goes straight?
    #[inline]
    fn keeps_mean(&self, local: &Local) -> bool {
        match self.pattern {
            Pattern::Linear { .. } | Pattern::Cone(_) => local.t >= self.apex,
            Pattern::Circles(_) => self.steepness * local.lift().abs() <= MOST_LIFT && bends_little(local),
        }
    }

    /// May lines of one colour be taken for straight where the map turns, in a region that is such a share of a
    /// pixel? In a square of side h they leave straight lines of the same mean by up to h² / 12 of their curvature,
    /// and as much as a full diagonal of the square is on their wrong side, 1 / h times in a pixel.
    #[inline]
    fn is_straight(&self, local: &Local, share: f64) -> bool {
        self.contrast_around(local) * local.lift().abs() * share <= MOST_CURVE * local.reach()
    }

    /// At least the change of any component within the pixel of which this is the middle, 0 ..= 1.
    #[inline]
    fn contrast_around(&self, local: &Local) -> f64 {
        match &self.pattern {
            Pattern::Circles(_) => (self.jump + self.steepness * 2.0 * local.reach()).min(1.0),
            Pattern::Linear { .. } | Pattern::Cone(_) => self.contrast,
        }
    }

    /// The mean over the spot around a point, of a gradient that has colour everywhere: premultiplied, 0 ..= 255.
    #[inline(never)]
    fn mean_at(&self, centre: Point) -> [f32; 4] {
        let sheet = self.pattern.local(centre).map(|local| self.mean(centre, &local));
        color_of(sheet.unwrap_or_else(|| self.least())).map(|v| v * 255.0)
    }

    /// Tables, where pixels are many.
    #[inline]
    fn spots(&self) -> Option<&Spots> {
        // A tenth of a level of light is more in the dark.
        if !self.turns_everywhere || self.linear || self.may_differ() {
            return None;
        }
        let demand = || Demand {
            pixels: self.pixels,
            range: range(&self.gradient.stops),
            most_lift: MOST_CURVE / self.contrast,
        };
        self.spots.get_or_init(|| Spots::plan(self.filtered(), demand())).as_ref()
    }

    /// May means not do in some pixels, in each of which the map turns?
    fn may_differ(&self) -> bool {
        let farthest = self.spot_scale * self.pattern.farthest();
        !self.mattering.is_empty() && self.stretches.are_few_in(2.0 * farthest)
    }

    fn filtered(&self) -> Filtered<'_> {
        Filtered { pattern: &self.pattern, map: self.map(), side: self.spot_scale }
    }

    fn map(&self) -> &ColorMap {
        self.map.get_or_init(|| ColorMap::new(&self.light_stops(), self.gradient.spread))
    }

    /// The stops, between which means are taken: in linear light more of them, as there colours do not go straight.
    fn light_stops(&self) -> Cow<'a, [Stop]> {
        let stops = &self.gradient.stops;
        if !self.linear {
            return Cow::Borrowed(stops);
        }
        let light = |offset: f32, color: [f32; 4]| {
            let [r, g, b, alpha] = color;
            let [r, g, b, _] = Sheet::new([r, g, b], 1.0).to_linear().channels();
            Stop { offset, color: [r, g, b, alpha] }
        };
        let mut all = vec![light(stops[0].offset, stops[0].color)];
        for pair in stops.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let change = (0..3).map(|i| (to.color[i] - from.color[i]).abs()).fold(0.0, f32::max);
            let parts = if from.offset < to.offset { (change * LIGHT_PARTS).ceil().max(1.0) } else { 1.0 };
            all.extend((1..=parts as u32).map(|i| {
                let share = i as f32 / parts;
                let between = |a: f32, b: f32| if i as f32 == parts { b } else { a + (b - a) * share };
                let color = std::array::from_fn(|i| between(from.color[i], to.color[i]));
                light(between(from.offset, to.offset), color)
            }));
        }
        Cow::Owned(all)
    }

    /// A sheet that lets no less light through than the gradient does anywhere.
    pub fn least(&self) -> Sheet {
        if self.gradient.opaque {
            let [r, g, b, _] = self.gradient.stops[self.gradient.stops.len() - 1].color;
            Sheet::new([r, g, b], 1.0)
        } else {
            Sheet::CLEAR
        }
    }
}

/// Is what the parameter bends within a pixel all told by its lift?
#[inline]
fn bends_little(local: &Local) -> bool {
    local.lift().abs() <= MOST_SHARE_OF_LIFT * local.reach()
}

/// The pixels of a picture within a shape's bounds.
fn pixels_in(geometry: &Geometry, viewport: &Viewport) -> f64 {
    let picture = Rect::new(0.0, 0.0, viewport.width.into(), viewport.height.into());
    let seen = bounds_in_pixels(geometry, viewport).intersect(picture);
    if seen.is_finite() {
        seen.area()
    } else {
        picture.area()
    }
}

fn has_one_alpha(stops: &[Stop]) -> bool {
    stops.iter().all(|stop| stop.color[3] == stops[0].color[3])
}

/// At least the difference of any two values of a component, premultiplied, 0 ..= 1.
fn range(stops: &[Stop]) -> f64 {
    let alpha = stops[0].color[3];
    // Where colours fade they may go beyond those of the stops.
    if !has_one_alpha(stops) {
        return 1.0;
    }
    let range = |i: usize| {
        let values = stops.iter().map(|stop| stop.color[i]);
        values.fold((1.0f32, 0.0f32), |(least, most), v| (least.min(v), most.max(v)))
    };
    let ranges = (0..3).map(range).map(|(least, most)| most - least);
    f64::from(alpha * ranges.fold(0.0, f32::max))
}

/// The greatest change of a component at a hard stop, 0 ..= 1.
fn greatest_jump(gradient: &Gradient) -> f64 {
    let stops = &gradient.stops;
    let pairs = stops.windows(2).map(|pair| (pair[0], pair[1]));
    let wrapped = matches!(gradient.spread, Spread::Repeat).then(|| (stops[stops.len() - 1], stops[0]));
    let jumps = pairs.filter(|(a, b)| a.offset == b.offset).chain(wrapped);
    let changes = jumps.flat_map(|(a, b)| (0..4).map(move |i| (a.color[i] - b.color[i]).abs()));
    f64::from(changes.fold(0.0, f32::max))
}

/// Premultiplied red, green, blue and alpha.
fn color_of(sheet: Sheet) -> [f32; 4] {
    let [r, g, b, through] = sheet.channels();
    [r, g, b, 1.0 - through]
}
