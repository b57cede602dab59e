//! Takes a gradient, makes the colour at a point, and the curves at which that colour turns or jumps.

use super::drawing::affine;
use super::turns::{Curve, Turn};
use super::Colour;
use kurbo::{Affine, Point, Vec2};
use usvg::{SpreadMethod, Stop};

/// A gradient, from pixels to colour.
pub(super) struct Gradient {
    /// From pixels to the gradient's own space, and back.
    from_pixels: Affine,
    to_pixels: Affine,
    shape: GradientShape,
    spread: SpreadMethod,
    /// Offset, and straight colour with alpha 0..=1, in order of offset.
    stops: Vec<(f64, [f64; 4])>,
}

pub(super) enum GradientShape {
    Linear {
        from: Point,
        to: Point,
    },
    /// From the circle around `focus` to the one around `centre`.
    Radial {
        focus: Point,
        focus_radius: f64,
        centre: Point,
        radius: f64,
    },
}

/// A pixel in which a gradient turns more often than this is sampled.
const MOST_TURNS: usize = 32;

impl Gradient {
    /// `None` where its space has no area: nothing is painted. `opacity` is 0..=1.
    pub(super) fn new(
        base: &usvg::BaseGradient,
        shape: GradientShape,
        opacity: f64,
        to_pixels: Affine,
    ) -> Option<Gradient> {
        let to_pixels = to_pixels * affine(base.transform());
        (to_pixels.determinant() != 0.0 && to_pixels.is_finite()).then(|| Gradient {
            from_pixels: to_pixels.inverse(),
            to_pixels,
            shape,
            spread: base.spread_method(),
            stops: base.stops().iter().map(|stop| straight_stop(stop, opacity)).collect(),
        })
    }

    /// A radial gradient whose circles do not nest leaves part of the plane unpainted.
    pub(super) fn is_opaque(&self) -> bool {
        let everywhere = match self.shape {
            GradientShape::Linear { .. } => true,
            GradientShape::Radial { focus, focus_radius, centre, radius } => {
                focus.distance(centre) + focus_radius < radius
            }
        };
        everywhere && self.stops.iter().all(|(_, colour)| colour[3] >= 1.0)
    }

    pub(super) fn colour_at(&self, at: Point) -> Colour {
        let Some(t) = self.shape.offset(self.from_pixels * at) else { return [0.0; 4] };
        let t = match self.spread {
            SpreadMethod::Pad => t.clamp(0.0, 1.0),
            SpreadMethod::Repeat => t.rem_euclid(1.0),
            SpreadMethod::Reflect => 1.0 - (t.rem_euclid(2.0) - 1.0).abs(),
        };
        let after = self.stops.partition_point(|&(offset, _)| offset <= t);
        let [r, g, b, a] = match (after.checked_sub(1).map(|i| self.stops[i]), self.stops.get(after)) {
            (Some((from, below)), Some(&(to, above))) => {
                let part = (t - from) / (to - from);
                std::array::from_fn(|c| below[c] + (above[c] - below[c]) * part)
            }
            (Some((_, only)), None) => only,
            (None, Some(&(_, only))) => only,
            (None, None) => [0.0; 4],
        };
        [r * a, g * a, b * a, a]
    }

    /// The curves in the pixel whose top left corner is `corner` at which the colour is not smooth;
    /// `None` where they are too many.
    pub(super) fn turns(&self, corner: Point) -> Option<Vec<Turn>> {
        let turn = |curve| Turn { from_pixels: self.from_pixels, to_pixels: self.to_pixels, curve };
        let mut turns: Vec<Turn> = self.shape.borders().into_iter().map(turn).collect();
        let Some((least, most)) = self.offsets_within(corner) else { return Some(turns) };
        let within = |t: &f64| least <= *t && *t <= most;
        let stops = self.stops.iter().map(|&(offset, _)| offset);
        let offsets: Vec<f64> = match self.spread {
            SpreadMethod::Pad => stops.filter(within).collect(),
            _ => {
                let first = least.floor();
                let periods = most - first;
                if periods.is_nan() || periods * (self.stops.len() + 1) as f64 > MOST_TURNS as f64 {
                    return None;
                }
                let mirrored =
                    |period: f64| self.spread == SpreadMethod::Reflect && period.rem_euclid(2.0) == 1.0;
                (0..=periods as usize)
                    .map(|i| first + i as f64)
                    .flat_map(|period| {
                        let place = move |t: f64| if mirrored(period) { 1.0 - t } else { t };
                        stops.clone().map(move |t| period + place(t)).chain([period])
                    })
                    .filter(within)
                    .collect()
            }
        };
        if offsets.len() > MOST_TURNS {
            return None;
        }
        turns.extend(offsets.into_iter().filter_map(|t| self.shape.curve_at(t)).map(turn));
        Some(turns)
    }

    /// A range that holds the offsets of all points in a pixel; `None` where it has no colour.
    fn offsets_within(&self, corner: Point) -> Option<(f64, f64)> {
        // Those of a linear gradient are extreme in corners. Others are looked at more closely.
        let (side, margin) = match self.shape {
            GradientShape::Linear { .. } => (1, 1e-9),
            GradientShape::Radial { .. } => (8, 0.5),
        };
        let places = (0..=side).flat_map(|j| (0..=side).map(move |i| (f64::from(i), f64::from(j))));
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, j) in places {
            let at = corner + Vec2::new(i, j) / f64::from(side);
            if let Some(t) = self.shape.offset(self.from_pixels * at) {
                (least, most) = (least.min(t), most.max(t));
            }
        }
        let margin = margin * (most - least);
        let (least, most) = (least - margin, most + margin);
        let extended = self.offsets_at_borders(corner).fold((least, most), |(a, b), t| (a.min(t), b.max(t)));
        (extended.0 <= extended.1).then_some(extended)
    }

    /// The offsets at the ends of what a pixel holds of the borders. Next to a border they go as the root of the
    /// distance, so that places around it do not tell what they are there.
    fn offsets_at_borders(&self, corner: Point) -> impl Iterator<Item = f64> + '_ {
        let sides = [(0.0, 0.0, 1.0, 0.0), (0.0, 1.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0)];
        let sides = sides.map(|(x, y, right, down)| (corner + Vec2::new(x, y), Vec2::new(right, down)));
        self.shape.borders().into_iter().flat_map(move |curve| {
            let turn = Turn { from_pixels: self.from_pixels, to_pixels: self.to_pixels, curve };
            sides.into_iter().flat_map(move |(from, along)| {
                let on_side = turn.crossings(from, along).filter(|s| (0.0..=1.0).contains(s));
                let points: Vec<Point> = on_side.map(|s| self.from_pixels * (from + along * s)).collect();
                points.into_iter().filter_map(move |p| self.shape.offset_at_border(curve, p))
            })
        })
    }
}

fn straight_stop(stop: &Stop, opacity: f64) -> (f64, [f64; 4]) {
    let c = stop.color();
    let level = |byte: u8| f64::from(byte) / 255.0;
    let alpha = f64::from(stop.opacity().get()) * opacity;
    (f64::from(stop.offset().get()), [level(c.red), level(c.green), level(c.blue), alpha])
}

impl GradientShape {
    /// Where `at` lies between the gradient's start (0) and end (1); `None` where it is not defined.
    fn offset(&self, at: Point) -> Option<f64> {
        match *self {
            GradientShape::Linear { from, to } => {
                let along = to - from;
                let length = along.hypot2();
                // usvg makes a gradient without length flat; here the last colour is as good.
                Some(if length > 0.0 { (at - from).dot(along) / length } else { 1.0 })
            }
            // The circle at t has centre f + t (c - f) and radius a + t (r - a); the largest t whose
            // circle passes through the point, with a radius that is not negative, paints it.
            GradientShape::Radial { focus, focus_radius, centre, radius } => {
                let (d, p, growth) = (centre - focus, at - focus, radius - focus_radius);
                let a = d.hypot2() - growth * growth;
                let half_b = p.dot(d) + focus_radius * growth;
                let c = p.hypot2() - focus_radius * focus_radius;
                let holds = |t: &f64| t.is_finite() && focus_radius + t * growth >= 0.0;
                if a.abs() < 1e-12 * (d.hypot2() + growth * growth) {
                    return Some(c / (2.0 * half_b)).filter(holds);
                }
                let root = half_b * half_b - a * c;
                if root < 0.0 {
                    return None;
                }
                let (one, other) = ((half_b + root.sqrt()) / a, (half_b - root.sqrt()) / a);
                Some(one.max(other)).filter(holds).or(Some(one.min(other)).filter(holds))
            }
        }
    }

    /// The offset at a point of a border.
    fn offset_at_border(&self, border: Curve, at: Point) -> Option<f64> {
        let (GradientShape::Radial { focus, focus_radius, centre, radius }, Curve::Line { through, normal }) =
            (self, border)
        else {
            return None;
        };
        let growth = radius - focus_radius;
        // The circle at t touches it at through + t step.
        let step = (*centre - *focus) - normal * growth;
        match step.hypot2() {
            // All touch it in one point; around, circles without end come near to it.
            square if square <= 1e-12 * growth * growth => Some(f64::INFINITY.copysign(growth)),
            square => Some((at - through).dot(step) / square),
        }
    }

    /// All points at offset `t` lie on this.
    fn curve_at(&self, t: f64) -> Option<Curve> {
        match *self {
            GradientShape::Linear { from, to } => {
                let along = to - from;
                (along.hypot2() > 0.0).then(|| Curve::Line { through: from + along * t, normal: along })
            }
            GradientShape::Radial { focus, focus_radius, centre, radius } => {
                let radius = focus_radius + t * (radius - focus_radius);
                (radius >= 0.0).then(|| Curve::Circle { centre: focus + (centre - focus) * t, radius })
            }
        }
    }

    /// The lines beyond which there is no colour: those that touch all circles, if they do not nest.
    fn borders(&self) -> Vec<Curve> {
        let GradientShape::Radial { focus, focus_radius, centre, radius } = *self else { return Vec::new() };
        let (d, growth) = (centre - focus, radius - focus_radius);
        // A unit normal n touches the circle at t where n . t d = t growth: the same for all t.
        let (distance, sine) = (d.hypot(), growth / d.hypot());
        if distance == 0.0 || sine.abs() > 1.0 + 1e-9 {
            return Vec::new();
        }
        let (ahead, aside) = (d / distance, Vec2::new(-d.y, d.x) / distance);
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        [cosine, -cosine]
            .map(|cosine| ahead * sine + aside * cosine)
            .map(|normal| Curve::Line { through: focus - normal * focus_radius, normal })
            .to_vec()
    }
}
