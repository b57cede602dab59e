//! Takes a gradient at a picture's scale, makes the colours of rows, of pixels and of parts of them.
//!
//! Its colour over a region is that at the region's centre as long as the colour map goes straight there.
//! Where the map turns or jumps within the region, it is the mean ([`super::color_map`]), for which the
//! parameter is taken to be linear; where the circles of a radial gradient are too small for that, the region is
//! cut. Where it turns in every pixel and pixels are many, rows of them have their means from tables ([`spots`]);
//! whether there are any is a matter of the shape and the picture, not of which of its pixels are asked for.

mod pattern;
mod spots;
mod stretch;

use super::color_map::{ColorMap, Integral};
use super::paint::{Gradient, Sheet, Spread, Stop};
use super::shader::sheet_of;
use crate::outlines::bounds_in_pixels;
use crate::scene::Geometry;
use crate::Viewport;
use kurbo::{Point, Rect, Vec2};
use pattern::{Aims, Local, Pattern, AT_A_TIME};
use spots::{Demand, Filtered, Spots};
use std::sync::OnceLock;
use stretch::{Stretch, Stretches};

/// A gradient at a picture's scale.
#[derive(Clone, Debug)]
pub(crate) struct GradientShader<'a> {
    gradient: &'a Gradient,
    pattern: Pattern,
    stretches: Stretches,
    /// As [`crate::Settings::spot_scale`].
    spot_scale: f64,
    /// The parameter changes by no more between the centre of the spot and its corners, anywhere.
    farthest: f64,
    /// Below it lie the circles of a radial gradient that are too small for the colour in the middle of a pixel to
    /// be the mean, even where the map goes straight.
    apex: f64,
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

/// What the colour in the middle of a pixel may be off by because circles are no straight lines, where the map
/// goes straight.
const MOST_LIFT: f64 = 0.125 / 255.0;

/// What a pixel may be off by because circles are no straight lines, where the map turns.
const MOST_CURVE: f64 = 0.15 / 255.0;

/// How often a pixel's side is halved at most where circles are no straight lines: next to an apex, and where the
/// places are that have no colour.
const MOST_HALVINGS: u32 = 5;
const MOST_HALVINGS_OF_CIRCLES: u32 = 3;

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
        spot_scale: f64,
    ) -> GradientShader<'a> {
        let pattern = Pattern::new(gradient.shape, (viewport.transform * gradient.transform).inverse());
        let stretches = Stretches::new(&gradient.stops, gradient.spread);
        let (steepness, farthest) = (stretches.steepness(), pattern.farthest());
        let change = if steepness > 0.0 { steepness * 2.0 * farthest } else { 0.0 };
        let apex = match &pattern {
            Pattern::Cone(cone) => cone.straight_from(MOST_LIFT / steepness),
            Pattern::Linear { .. } | Pattern::Circles(_) => f64::NEG_INFINITY,
        };
        let turns_everywhere = farthest.is_finite() && stretches.longest() < 2.0 * farthest * spot_scale;
        GradientShader {
            gradient,
            spot_scale,
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
        ColorMap::bytes(self.gradient.stops.len()) + self.spots().map_or(0, Spots::bytes)
    }

    /// The colour of the pixel around a point, in pixels; clear where a radial gradient has none.
    pub fn at(&self, x: f64, y: f64) -> Sheet {
        self.pixel(Point::new(x, y), &mut None)
    }

    pub fn even_at(&self, x: f64, y: f64) -> Option<Sheet> {
        let centre = Point::new(x, y);
        if self.is_partly_clear(&CORNERS.map(|corner| centre + corner)) {
            return None;
        }
        let Some(local) = self.pattern.local(centre) else {
            return Some(self.least());
        };
        let (stretch, reach) = (self.stretches.around(local.t), self.spot_scale * local.reach());
        let is_even = local.t >= self.apex
            && stretch.holds(local.t - reach, local.t + reach)
            && stretch.steepness() * 2.0 * reach <= EVEN;
        is_even.then(|| stretch.at(local.t))
    }

    /// Gives `put` the colours of pixels of row `y` from column `x` on, each with its place among them.
    #[inline]
    pub fn row(&self, x: usize, y: u32, count: usize, mut put: impl FnMut(usize, Sheet)) {
        self.spans(x, y, count, |first, span| match span {
            Span::Straight(stretch, parameters) => {
                parameters.iter().enumerate().for_each(|(i, &t)| put(first + i, stretch.at(t)));
            }
            Span::Pixel(sheet) => put(first, sheet),
            Span::Tabled(colors) => {
                let sheet = |color: &[f32; 4]| sheet_of(color.map(|v| v * (1.0 / 255.0)));
                colors.iter().enumerate().for_each(|(i, color)| put(first + i, sheet(color)));
            }
        });
    }

    /// The same in bytes, of a gradient that hides what lies behind.
    pub fn write_row(&self, x: usize, y: u32, pixels: &mut [[u8; 4]]) {
        self.spans(x, y, pixels.len(), |first, span| match span {
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
        });
    }

    /// The colours of pixels of row `y` from column `x` on, each time with the place of the first.
    #[inline]
    fn spans(&self, x: usize, y: u32, count: usize, mut take: impl FnMut(usize, Span)) {
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
                take(i, Span::Pixel(self.mean(centre(i), local)));
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
                if straight == 0 {
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
        if self.is_partly_clear(&CORNERS.map(|corner| centre + side * corner)) {
            let mean = self.square(centre, side, self.most_halvings()).mean();
            return mean.map_or_else(|| self.least(), sheet_of);
        }
        let Some(local) = self.pattern.local(centre) else {
            return self.least();
        };
        let (t, reach) = (local.t + side * side * local.lift(), side * local.reach());
        let stretch = stretch.get_or_insert_with(|| self.stretches.around(t));
        if !stretch.holds(t - reach, t + reach) {
            *stretch = self.stretches.around(t);
        }
        let straight_enough = local.t >= self.apex || self.is_straight(&local, side * side);
        match stretch.holds(t - reach, t + reach) && straight_enough {
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
            self.square(centre, side, self.most_halvings()).mean()
        };
        mean.map_or_else(|| self.stretches.around(t).at(t), sheet_of)
    }

    /// May lines of one colour be taken for straight where the map turns, in a region that is such a share of a
    /// pixel? In a square of side h they leave straight lines of the same mean by up to h² / 12 of their curvature,
    /// and as much as a full diagonal of the square is on their wrong side, 1 / h times in a pixel.
    #[inline]
    fn is_straight(&self, local: &Local, share: f64) -> bool {
        self.contrast * local.lift() * share <= MOST_CURVE * local.reach()
    }

    /// Are there colours in some of these places, and none in others?
    #[inline]
    fn is_partly_clear(&self, places: &[Point]) -> bool {
        if !matches!(self.pattern, Pattern::Circles(_)) {
            return false;
        }
        let colored = places.iter().filter(|&&p| self.pattern.local(p).is_some()).count();
        0 < colored && colored < places.len()
    }

    fn most_halvings(&self) -> u32 {
        match self.pattern {
            Pattern::Circles(_) => MOST_HALVINGS_OF_CIRCLES,
            Pattern::Linear { .. } | Pattern::Cone(_) => MOST_HALVINGS,
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
        if !self.turns_everywhere {
            return None;
        }
        let demand = || Demand {
            pixels: self.pixels,
            range: range(&self.gradient.stops),
            most_lift: MOST_CURVE / self.contrast,
        };
        self.spots.get_or_init(|| Spots::plan(self.filtered(), demand())).as_ref()
    }

    fn filtered(&self) -> Filtered<'_> {
        Filtered { pattern: &self.pattern, map: self.map(), side: self.spot_scale }
    }

    fn map(&self) -> &ColorMap {
        self.map.get_or_init(|| ColorMap::new(&self.gradient.stops, self.gradient.spread))
    }

    /// Over a square of this side, cut into ones in which circles are straight.
    fn square(&self, centre: Point, side: f64, halvings: u32) -> Integral {
        let (local, area) = (self.pattern.local(centre), side * side);
        let is_even = |local: &Local| {
            self.is_straight(local, area)
                && !self.is_partly_clear(&CORNERS.map(|corner| centre + side * corner))
        };
        if let Some(local) = local.filter(|local| halvings == 0 || is_even(local)) {
            let t = local.t + area * local.lift();
            let mean = self.map().over_square(t, (side * local.along.x, side * local.along.y));
            let mean = mean.unwrap_or_else(|| color_of(self.stretches.around(t).at(t)));
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
            return self.in_triangles(centre, corners).mean().map_or_else(|| self.least(), sheet_of);
        }
        let Some(local) = self.pattern.local(centre) else {
            return self.least();
        };
        let stretch = self.stretches.around(local.t);
        let parameters = corners.iter().map(|&p| local.t + local.along.dot(p - centre));
        let (from, to) = parameters.fold((local.t, local.t), |(from, to), t| (t.min(from), t.max(to)));
        if stretch.holds(from, to) && local.t >= self.apex {
            return stretch.at(local.t);
        }
        let integral = match self.is_straight(&local, 1.0) {
            true => self.linear_integral(&local, centre, corners),
            false => self.in_triangles(centre, corners),
        };
        integral.mean().map_or_else(|| stretch.at(local.t), sheet_of)
    }

    fn in_triangles(&self, centre: Point, corners: &[Point]) -> Integral {
        let mut sum = Integral::default();
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            sum.add(self.triangle([centre, corner, next], self.most_halvings()));
        }
        sum
    }

    /// Over a triangle, cut into ones in which circles are straight.
    fn triangle(&self, corners: [Point; 3], halvings: u32) -> Integral {
        let [a, b, c] = corners;
        let centre = Point::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
        let (local, area) = (self.pattern.local(centre), 0.5 * (b - a).cross(c - a));
        if let Some(local) = local.filter(|local| halvings == 0 || self.is_straight(local, 2.0 * area.abs()))
        {
            return self.linear_integral(&local, centre, &corners);
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

    /// Over a polygon on which the parameter is taken to be linear, with the mean that it has.
    fn linear_integral(&self, local: &Local, centre: Point, corners: &[Point]) -> Integral {
        let square = local.along.hypot2();
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

/// At least the difference of any two values of a component, premultiplied, 0 ..= 1.
fn range(stops: &[Stop]) -> f64 {
    let alpha = stops[0].color[3];
    // Where colours fade they may go beyond those of the stops.
    if stops.iter().any(|stop| stop.color[3] != alpha) {
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
