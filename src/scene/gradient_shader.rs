//! Takes a gradient at a picture's scale, makes the colours of rows, of pixels and of parts of them.
//!
//! Its colour over a region is that at the region's centre as long as the colour map goes straight there.
//! Where the map turns or jumps within the region, it is the mean ([`super::color_map`]), for which the
//! parameter is taken to be linear; where the circles of a radial gradient are too small for that, the region is
//! cut. Where it turns in every pixel and pixels are many, rows of them have their means from tables ([`spots`]);
//! whether there are any is a matter of the shape and the picture, not of which of its pixels are asked for.

mod cuts;
mod pattern;
mod spots;
mod stretch;

pub(crate) use cuts::Chord;

use super::color_map::{ColorMap, Integral};
use super::paint::{Gradient, Sheet, Spread, Stop};
use super::shader::sheet_of;
use crate::outlines::bounds_in_pixels;
use crate::scene::Geometry;
use crate::scene::{Group, Role, Scene};
use crate::{Method, Settings, Viewport};
use kurbo::{Affine, Point, Rect, Vec2};
use pattern::{Aims, Local, Pattern, AT_A_TIME};
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
    /// The parameter changes by no more between the centre of the spot and its corners, anywhere.
    farthest: f64,
    /// Below it the circles of a radial gradient may be too small for the colour in the middle of a pixel to be the
    /// mean, even where the map goes straight.
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

/// The same of a triangle's corners, where it bends by six times as much.
const MOST_SHARE_OF_BEND: f64 = 6.0 * MOST_SHARE_OF_LIFT;

/// What a part of a pixel may be off by, of which there are some dozens.
const MOST_OF_PARTS: f64 = 0.01 / 255.0;

/// What a pixel may be off by because circles are no straight lines, where the map turns.
const MOST_CURVE: f64 = 0.15 / 255.0;

/// The change of a component between two cuts. Of what two gradients that change together make of a third, a twelfth
/// of the changes' product is lost; of light in which one changes, up to six twelfths of its square near black.
const MOST_CHANGE: f32 = 1.0 / 6.0;
const MOST_CHANGE_OF_LIGHT: f32 = 1.0 / 8.0;

/// Parts of a full change of colour between which it is taken to go straight in linear light: a tenth of a level.
const LIGHT_PARTS: f32 = 64.0;

/// A point this near to a border lies on it, in pixels.
const ON_BORDER: f64 = 1e-6;

/// How often a pixel's side is halved at most where circles are no straight lines: next to an apex, and where the
/// places are that have no colour.
const MOST_HALVINGS: u32 = 5;

/// The corners of a square of side 1 around its middle.
const CORNERS: [Vec2; 4] =
    [Vec2::new(-0.5, -0.5), Vec2::new(0.5, -0.5), Vec2::new(0.5, 0.5), Vec2::new(-0.5, 0.5)];

/// Some of a row's colours.
enum Span<'a> {
    /// Of pixels with these parameters, which lie on a stretch.
    Straight(&'a Stretch, &'a [f64]),
    /// Of one pixel.
    Pixel(Sheet),
    /// Of these pixels, premultiplied, 0 ..= 255.
    Tabled(&'a [[f32; 4]]),
}

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
            Pattern::Linear { .. } => f64::NEG_INFINITY,
            Pattern::Circles(_) => f64::INFINITY,
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
            farthest: farthest * spot_scale,
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

    pub fn even_at(&self, x: f64, y: f64) -> Option<Sheet> {
        let centre = Point::new(x, y);
        if self.is_partly_clear(&square_of(centre, 1.0)) {
            return None;
        }
        let Some(local) = self.pattern.local(centre) else {
            return Some(self.least());
        };
        let (stretch, reach) = (self.stretches.around(local.t), self.spot_scale * local.reach());
        let is_even = self.keeps_mean(&local)
            && stretch.holds(local.t - reach, local.t + reach)
            && stretch.steepness() * 2.0 * reach <= EVEN;
        is_even.then(|| stretch.at(local.t))
    }

    /// Gives `put` the colours of up to 64 pixels of row `y` from column `x` on, each with its place among them, but
    /// for those for which the mean over the pixel will not do. These it returns, a bit for each.
    #[inline]
    pub fn row(&self, x: usize, y: u32, count: usize, mut put: impl FnMut(usize, Sheet)) -> u64 {
        let mut uneven = 0;
        let is_uneven = |i: usize| self.is_uneven(Point::new((x + i) as f64 + 0.5, f64::from(y) + 0.5));
        let mut of_pixels = 0;
        let skip = |i: usize| {
            let skip = is_uneven(i);
            of_pixels |= u64::from(skip) << i;
            skip
        };
        self.spans(x, y, count, skip, |first, span| match span {
            Span::Straight(stretch, parameters) if self.may_be_uneven(stretch) => {
                for (i, &t) in parameters.iter().enumerate() {
                    match is_uneven(first + i) {
                        true => uneven |= 1 << (first + i),
                        false => put(first + i, stretch.at(t)),
                    }
                }
            }
            Span::Straight(stretch, parameters) => {
                parameters.iter().enumerate().for_each(|(i, &t)| put(first + i, stretch.at(t)));
            }
            Span::Pixel(sheet) => put(first, sheet),
            Span::Tabled(colors) => {
                let sheet = |color: &[f32; 4]| sheet_of(color.map(|v| v * (1.0 / 255.0)));
                colors.iter().enumerate().for_each(|(i, color)| put(first + i, sheet(color)));
            }
        });
        uneven | of_pixels
    }

    /// Is there a pixel on a stretch whose colours differ so much that it matters?
    #[inline]
    fn may_be_uneven(&self, stretch: &Stretch) -> bool {
        stretch
            .changes(self.mattering.clone(), NEARLY_EVEN.map(|most| f64::from(most) / (2.0 * self.farthest)))
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

    /// The same in bytes, of a gradient that hides what lies behind.
    pub fn write_row(&self, x: usize, y: u32, pixels: &mut [[u8; 4]]) {
        self.spans(
            x,
            y,
            pixels.len(),
            |_| false,
            |first, span| match span {
                Span::Straight(stretch, parameters) => {
                    stretch.write(parameters, &mut pixels[first..first + parameters.len()]);
                }
                Span::Pixel(sheet) => pixels[first] = stretch::opaque_bytes(sheet),
                Span::Tabled(colors) => {
                    let pixels = &mut pixels[first..first + colors.len()];
                    pixels
                        .iter_mut()
                        .zip(colors)
                        .for_each(|(pixel, color)| *pixel = stretch::rounded_opaque(*color));
                }
            },
        );
    }

    /// The colours of pixels of row `y` from column `x` on, each time with the place of the first. Of pixels of
    /// which each has its own mean it leaves out those that are to be skipped.
    #[inline]
    fn spans(
        &self,
        x: usize,
        y: u32,
        count: usize,
        mut skip: impl FnMut(usize) -> bool,
        mut take: impl FnMut(usize, Span),
    ) {
        let centre = |i: usize| Point::new((x + i) as f64 + 0.5, f64::from(y) + 0.5);
        if let Some(spots) = self.spots() {
            let (mut aims, mut colors) = (Aims::default(), [[0.0; 4]; AT_A_TIME]);
            for first in (0..count).step_by(AT_A_TIME) {
                let colors = &mut colors[..(count - first).min(AT_A_TIME)];
                let other = |i: usize| self.mean_at(centre(first + i));
                spots.row(self.filtered(), centre(first), &mut aims, (&mut *colors, other));
                take(first, Span::Tabled(colors));
            }
            return;
        }
        if self.turns_everywhere {
            self.pattern.each_of_row(centre(0), count, |i, local| {
                if !skip(i) {
                    take(i, Span::Pixel(self.mean(centre(i), local)));
                }
            });
            return;
        }
        let mut stretch = None;
        let mut parameters = [0.0; AT_A_TIME];
        for first in (0..count).step_by(AT_A_TIME) {
            let some = &mut parameters[..(count - first).min(AT_A_TIME)];
            let has_all = self.pattern.row(centre(first), some);
            let mut done = 0;
            while let Some(&t) = some.get(done) {
                // As far as the colours go straight.
                let mut straight = 0;
                if has_all {
                    let stretch = stretch.get_or_insert_with(|| self.stretches.around(t));
                    if !stretch.holds(t, t) {
                        *stretch = self.stretches.around(t);
                    }
                    straight = self.straight_ones(stretch, &some[done..]);
                    if straight > 0 {
                        take(first + done, Span::Straight(stretch, &some[done..done + straight]));
                    }
                }
                if straight == 0 && !skip(first + done) {
                    take(first + done, Span::Pixel(self.pixel(centre(first + done), &mut stretch)));
                }
                done += straight.max(1);
            }
        }
    }

    /// How many parameters from the first on lie so far within a stretch that pixels do.
    #[inline]
    fn straight_ones(&self, stretch: &Stretch, parameters: &[f64]) -> usize {
        let (from, to) = stretch.middle(self.farthest);
        let from = from.max(self.apex);
        let lies = |t: f64| (from <= t) & (t <= to);
        // Mostly it is all or none.
        if !lies(parameters[0]) {
            return 0;
        }
        let others: u64 = parameters.iter().map(|&t| u64::from(!lies(t))).sum();
        match others {
            0 => parameters.len(),
            _ => parameters.iter().take_while(|&&t| lies(t)).count(),
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
        let (t, reach) = (local.t + side * side * local.lift(), side * local.reach());
        let stretch = stretch.get_or_insert_with(|| self.stretches.around(t));
        if !stretch.holds(t - reach, t + reach) {
            *stretch = self.stretches.around(t);
        }
        let straight_enough =
            || self.keeps_mean(&local) || self.is_straight(&local, side * side) || bends_little(&local);
        match stretch.holds(t - reach, t + reach) && straight_enough() {
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
        local.t >= self.apex
            || matches!(self.pattern, Pattern::Circles(_))
                && self.steepness * local.lift().abs() <= MOST_LIFT
                && bends_little(local)
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

    /// Does a border beyond which there is no colour run through a polygon?
    #[inline]
    fn is_partly_clear(&self, corners: &[Point]) -> bool {
        let runs_through = |border: &Chord| {
            let sides = corners.iter().map(|&p| side_of(border, p));
            let (least, most) = sides.fold((0.0f64, 0.0f64), |(least, most), v| (least.min(v), most.max(v)));
            least < -ON_BORDER && most > ON_BORDER
        };
        self.pattern.borders().iter().any(runs_through)
    }

    /// The mean over a convex polygon through which borders run beyond which there is no colour.
    #[inline(never)]
    fn mean_of_colored(&self, corners: &[Point]) -> Sheet {
        let mut parts = vec![corners.to_vec()];
        for border in self.pattern.borders() {
            let sides = |part: Vec<Point>| [1.0, -1.0].map(|side| on_side(&part, border, side));
            parts = parts.into_iter().flat_map(sides).filter(|part| part.len() > 2).collect();
        }
        let mut sum = Integral::default();
        for part in &parts {
            let Some(centre) = centre_of(part) else { continue };
            match self.pattern.local(centre) {
                Some(_) => sum.add(self.in_triangles(centre, part)),
                None => sum.area += area_of(part),
            }
        }
        sum.mean().map_or_else(|| self.least(), |mean| self.sheet_of(mean))
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
        !self.mattering.is_empty() && self.stretches.are_few_in(2.0 * self.farthest)
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

    /// Over a square of this side, cut into ones in which circles are straight.
    fn square(&self, centre: Point, side: f64, halvings: u32) -> Integral {
        let (local, area) = (self.pattern.local(centre), side * side);
        if let Some(local) = local.filter(|local| halvings == 0 || self.is_straight(local, area)) {
            let t = local.t + area * local.lift();
            let mean = self.map().over_square(t, (side * local.along.x, side * local.along.y));
            let mean = mean.unwrap_or_else(|| self.color_of(self.stretches.around(t).at(t)));
            return Integral { sum: mean.map(|v| f64::from(v) * area), area };
        }
        let mut sum = Integral { area: if halvings == 0 { area } else { 0.0 }, ..Integral::default() };
        if halvings > 0 {
            for corner in CORNERS {
                sum.add(self.square(centre + 0.5 * side * corner, 0.5 * side, halvings - 1));
            }
        }
        sum
    }

    /// The mean over a convex polygon, by the gradient's slope at the polygon's centre.
    pub fn over(&self, centre: Point, corners: &[Point]) -> Sheet {
        if self.is_partly_clear(corners) {
            return self.mean_of_colored(corners);
        }
        let Some(local) = self.pattern.local(centre) else {
            return self.least();
        };
        let stretch = self.stretches.around(local.t);
        let parameters = corners.iter().map(|&p| local.t + local.along.dot(p - centre));
        let (from, to) = parameters.fold((local.t, local.t), |(from, to), t| (t.min(from), t.max(to)));
        if stretch.holds(from, to) && self.keeps_mean(&local) {
            return stretch.at(local.t);
        }
        let integral = match self.is_straight(&local, 1.0) {
            true => self.linear_integral(&local, centre, corners),
            false => self.in_triangles(centre, corners),
        };
        integral.mean().map_or_else(|| stretch.at(local.t), |mean| self.sheet_of(mean))
    }

    fn in_triangles(&self, centre: Point, corners: &[Point]) -> Integral {
        let mut sum = Integral::default();
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            sum.add(self.triangle([centre, corner, next], MOST_HALVINGS));
        }
        sum
    }

    /// Over a triangle, cut into ones in which circles are straight.
    fn triangle(&self, corners: [Point; 3], halvings: u32) -> Integral {
        let [a, b, c] = corners;
        let centre = Point::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
        let (local, area) = (self.pattern.local(centre), 0.5 * (b - a).cross(c - a));
        if let Some(local) = local {
            if let Some(color) = self.even_on(&local, centre, &corners) {
                return Integral { sum: color.map(|v| f64::from(v) * area), area };
            }
            if halvings == 0 || self.is_straight(&local, 2.0 * area.abs()) {
                return self.linear_integral(&local, centre, &corners);
            }
        }
        // Where there is no colour there is nothing to add but area.
        let mut sum = Integral { area: if halvings == 0 { area } else { 0.0 }, ..Integral::default() };
        if halvings > 0 {
            let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
            for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                sum.add(self.triangle(part, halvings - 1));
            }
        }
        sum
    }

    /// The mean over a triangle on which the map goes straight and the parameter bends little, or which does not count
    /// for more.
    fn even_on(&self, local: &Local, centre: Point, corners: &[Point; 3]) -> Option<[f32; 4]> {
        let most = |of: &dyn Fn(Vec2) -> f64| corners.iter().map(|&p| of(p - centre)).fold(0.0, f64::max);
        let reach = most(&|by| local.along.dot(by).abs());
        let bent = most(&|by| 0.5 * local.bend.abs() * local.across.dot(by).powi(2));
        let (stretch, far) = (self.stretches.around(local.t), reach + bent);
        let most_off = (self.jump + self.steepness * far) * area_of(corners).abs();
        let goes_straight = bent <= MOST_SHARE_OF_BEND * reach && stretch.holds(local.t - far, local.t + far);
        let lifts = corners.iter().map(|&p| local.across.dot(p - centre).powi(2)).sum::<f64>();
        (goes_straight || most_off <= MOST_OF_PARTS)
            .then(|| self.color_of(stretch.at(local.t + local.bend * lifts / 24.0)))
    }

    /// Over a polygon on which the parameter is taken to be linear, with the mean that it has.
    fn linear_integral(&self, local: &Local, centre: Point, corners: &[Point]) -> Integral {
        let square = local.along.hypot2();
        if square == 0.0 {
            let (color, area) = (self.color_of(self.stretches.around(local.t).at(local.t)), area_of(corners));
            return Integral { sum: color.map(|v| f64::from(v) * area), area };
        }
        let lifts = corners.iter().map(|&p| local.across.dot(p - centre).powi(2)).sum::<f64>();
        let t = local.t + local.bend * lifts / 24.0;
        self.map().over(corners.iter().map(|&p| {
            let from_centre = p - centre;
            (t + local.along.dot(from_centre), local.along.cross(from_centre) / square)
        }))
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

/// The corners of a square of this side around a point.
#[inline]
fn square_of(centre: Point, side: f64) -> [Point; 4] {
    CORNERS.map(|corner| centre + side * corner)
}

/// How far a point lies on one side of a line whose ends are a pixel apart.
#[inline]
fn side_of([from, to]: &Chord, p: Point) -> f64 {
    (*to - *from).cross(p - *from)
}

/// The part of a convex polygon on one side of a line.
fn on_side(corners: &[Point], line: &Chord, side: f64) -> Vec<Point> {
    let mut part = Vec::with_capacity(corners.len() + 1);
    for (i, &corner) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let (d, next_d) = (side * side_of(line, corner), side * side_of(line, next));
        if d >= 0.0 {
            part.push(corner);
        }
        if d * next_d < 0.0 {
            part.push(corner.lerp(next, d / (d - next_d)));
        }
    }
    part
}

/// The area of a polygon, whose sign is the way round it.
fn area_of(corners: &[Point]) -> f64 {
    let triangle = |pair: &[Point]| 0.5 * (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    corners.windows(2).map(triangle).sum()
}

/// The centre of gravity of a convex polygon; `None` without an area.
fn centre_of(corners: &[Point]) -> Option<Point> {
    let (mut sum, mut area) = (Vec2::ZERO, 0.0);
    for pair in corners.windows(2) {
        let (a, b) = (pair[0] - corners[0], pair[1] - corners[0]);
        (sum, area) = (sum + a.cross(b) * (a + b), area + a.cross(b));
    }
    (area.abs() > 1e-12).then(|| corners[0] + sum / (3.0 * area))
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
