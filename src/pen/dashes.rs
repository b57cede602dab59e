//! Takes a path, makes its dashes (SVG 2, 13.5.6).
//!
//! kurbo makes dashes, too, but they go wrong behind a curve of no length, where a pattern begins just where a dash
//! ends, and in the seam of a closed sub-path.

use crate::scene::StrokeStyle;
use kurbo::{BezPath, Cap, Line, ParamCurve, ParamCurveArclen, PathEl, PathSeg, Point};

/// The length of a dot, as a share of the pen's width.
const NO_LENGTH: f64 = 1e-6;

/// A dash or a gap that begins or ends this near to the end of a line or curve, as a share of the pattern, does so there:
/// whether there is a little more of it behind the corner would be a matter of rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// A gap before the seam of a closed sub-path that is no wider than this, as a share of the pen's width, is none: who
/// gives a ring one dash of its circumference wants it whole, and the cubics that stand for a circle are a little longer.
const NO_GAP: f64 = 0.01;

/// How well curves are measured, as a share of the path's length.
const ACCURACY: f64 = 1e-9;

/// More dashes than this are drawn as one line.
const MOST_DASHES: f64 = 1_000_000.0;

/// The dashes of a path, or `None` where it is drawn as one line. A sub-path of no length has none, not even dots.
pub(super) fn dashed(path: &BezPath, style: &StrokeStyle) -> Option<BezPath> {
    let mut dashes = style.dash_pattern.to_vec();
    if dashes.len() % 2 == 1 {
        // What was a dash is a gap the second time.
        dashes.extend_from_within(..);
    }
    let period: f64 = dashes.iter().sum();
    let length: f64 = path.segments().map(hull_length).sum();
    let count = length * dashes.len() as f64 / period;
    // A period that is nothing, or not a number, would not end either.
    if count.is_nan() || count > MOST_DASHES {
        return None;
    }
    let pattern = Pattern {
        dashes,
        period,
        offset: style.dash_offset,
        dot: if style.start_cap == Cap::Butt { 0.0 } else { NO_LENGTH * style.width },
        no_gap: NO_GAP * style.width,
        accuracy: ACCURACY * length,
    };
    let mut walk = Walk { place: pattern.start(), pattern, dashed: Vec::new() };
    let mut segments = Vec::new();
    for sub_path in path.elements().chunk_by(|_, next| !matches!(next, PathEl::MoveTo(_))) {
        segments.clear();
        let own = kurbo::segments(sub_path.iter().copied());
        segments.extend(own.filter_map(|segment| walk.pattern.measured(segment)));
        walk.sub_path(&segments, matches!(sub_path.last(), Some(PathEl::ClosePath)));
    }
    Some(BezPath::from_vec(walk.dashed))
}

/// Dash, gap, dash, gap ... Lengths are in the path's units.
struct Pattern {
    dashes: Vec<f64>,
    /// Their sum.
    period: f64,
    /// How far into the pattern each sub-path begins.
    offset: f64,
    /// A dash shorter than this is drawn so long, for its caps want a direction.
    dot: f64,
    /// A gap of this length before a seam is none.
    no_gap: f64,
    /// How well curves are measured.
    accuracy: f64,
}

/// Where in the pattern one is.
struct Place {
    /// The dash, if it is even, or the gap.
    at: usize,
    /// What is left of it; a little less than nothing where it has ended at a corner.
    left: f64,
}

impl Place {
    fn is_inked(&self) -> bool {
        self.at.is_multiple_of(2)
    }
}

/// A line or a cubic and its length, which is not 0.
struct Measured {
    segment: PathSeg,
    length: f64,
}

impl Pattern {
    fn measured(&self, segment: PathSeg) -> Option<Measured> {
        let segment = match segment {
            PathSeg::Line(_) => segment,
            // Lengths along a parabola have a closed form, which fails where it is nearly a line.
            _ => PathSeg::Cubic(segment.to_cubic()),
        };
        let length = segment.arclen(self.accuracy);
        (length > 0.0).then_some(Measured { segment, length })
    }

    fn negligible(&self) -> f64 {
        NEGLIGIBLE * self.period
    }

    /// Where a sub-path begins.
    fn start(&self) -> Place {
        let mut gone = self.offset.rem_euclid(self.period);
        let mut at = 0;
        // A dash of no length is a dot: it is not passed over where it stands.
        while gone > 0.0 && gone >= self.dashes[at] - self.negligible() {
            gone -= self.dashes[at];
            at = (at + 1) % self.dashes.len();
        }
        Place { at, left: self.dashes[at] - gone.max(0.0) }
    }

    fn after(&self, place: &Place) -> Place {
        let at = (place.at + 1) % self.dashes.len();
        Place { at, left: self.dashes[at] }
    }
}

/// A walk along a path.
struct Walk {
    pattern: Pattern,
    place: Place,
    dashed: Vec<PathEl>,
}

impl Walk {
    /// Adds the dashes of one sub-path.
    fn sub_path(&mut self, segments: &[Measured], is_closed: bool) {
        let Some(start) = segments.first().map(|first| first.segment.start()) else {
            return;
        };
        self.place = self.pattern.start();
        let (first, begins_inked) = (self.dashed.len(), self.place.is_inked());
        if begins_inked {
            self.dashed.push(PathEl::MoveTo(start));
        }
        segments.iter().for_each(|measured| self.along(measured));
        if is_closed && begins_inked {
            self.join_at_seam(first, start);
        }
    }

    fn along(&mut self, Measured { segment, length }: &Measured) {
        let parameter = |pattern: &Pattern, gone: f64| match segment {
            PathSeg::Line(_) => gone / length,
            curve => curve.inv_arclen(gone, pattern.accuracy),
        };
        let (mut gone, mut from) = (0.0, 0.0);
        while gone + self.place.left < length - self.pattern.negligible() {
            let is_dot = self.pattern.dashes[self.place.at] < self.pattern.dot;
            let is_over = self.place.left <= self.pattern.negligible() && !is_dot;
            gone += self.place.left.max(0.0);
            let to = if is_over { from } else { parameter(&self.pattern, gone) };
            if !self.place.is_inked() {
                self.dashed.push(PathEl::MoveTo(segment.eval(to)));
            } else if is_dot {
                let end = parameter(&self.pattern, (gone + self.pattern.dot).min(*length));
                self.dashed.push(part(segment, to, end));
            } else if !is_over {
                self.dashed.push(part(segment, from, to));
            }
            (from, self.place) = (to, self.pattern.after(&self.place));
        }
        self.place.left -= length - gone;
        if self.place.is_inked() {
            self.dashed.push(part(segment, from, 1.0));
        }
    }

    /// Makes one dash of the last and the first where they meet in the seam. One that is as long as all of the sub-path
    /// keeps its two caps there, as in browsers.
    fn join_at_seam(&mut self, first: usize, start: Point) {
        if !self.place.is_inked() {
            if self.pattern.dashes[self.place.at] - self.place.left > self.pattern.no_gap {
                return;
            }
            self.dashed.push(PathEl::LineTo(start));
        }
        let dashes = &mut self.dashed[first..];
        let next = dashes.iter().skip(1).position(|element| matches!(element, PathEl::MoveTo(_)));
        if let Some(more_elements) = next {
            dashes.rotate_left(1 + more_elements);
            let again = self.dashed.len() - 1 - more_elements;
            self.dashed.remove(again);
        }
    }
}

/// A part of a segment, to go on with from where it begins.
fn part(segment: &PathSeg, from: f64, to: f64) -> PathEl {
    match segment {
        PathSeg::Line(Line { p1, .. }) if to == 1.0 => PathEl::LineTo(*p1),
        PathSeg::Line(line) => PathEl::LineTo(line.eval(to)),
        curve => {
            let part = curve.subsegment(from..to).to_cubic();
            PathEl::CurveTo(part.p1, part.p2, part.p3)
        }
    }
}

/// Length of the control polygon: never less than the segment's own.
fn hull_length(segment: PathSeg) -> f64 {
    let length = |points: &[Point]| points.windows(2).map(|pair| (pair[1] - pair[0]).hypot()).sum();
    match segment {
        PathSeg::Line(l) => length(&[l.p0, l.p1]),
        PathSeg::Quad(q) => length(&[q.p0, q.p1, q.p2]),
        PathSeg::Cubic(c) => length(&[c.p0, c.p1, c.p2, c.p3]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{Affine, Stroke};

    #[test]
    fn dashes_of_a_curve_of_any_size_end_and_are_alike() {
        let dashed = |size: f64| {
            let path = format!("M0 0C{size} 0 {size} {size} 0 {size}");
            let pen = Stroke::new(size).with_dashes(0.1 * size, [0.3 * size, 0.2 * size]);
            let style: StrokeStyle = pen.into();
            let path = BezPath::from_svg(&path).expect("a path");
            let dashes: BezPath = super::dashed(&path, &style).expect("dashes");
            (Affine::scale(1.0 / size) * dashes).into_elements()
        };
        let expected = dashed(1000.0);
        assert_eq!(expected.iter().filter(|element| matches!(element, PathEl::MoveTo(_))).count(), 5);
        for size in [1e-30, 1e-3, 1e8, 1e12, 1e15, 1e30] {
            let found = dashed(size);
            assert_eq!(found.len(), expected.len(), "{size}");
            for (a, b) in found.iter().zip(&expected) {
                let (a, b) = (a.end_point().expect("a point"), b.end_point().expect("a point"));
                assert!((a - b).hypot() < 1e-5, "{size}: {a} and not {b}");
            }
        }
    }
    #[test]
    fn a_sub_path_of_no_length_has_no_dashes_and_leaves_the_next_alone() {
        let dashed = |path: &str| {
            let style: StrokeStyle = Stroke::new(8.0).with_dashes(2.0, [10.0, 5.0]).into();
            let path = BezPath::from_svg(path).expect("a path");
            super::dashed(&path, &style).expect("dashes").into_elements()
        };
        for line in ["M3 4H40", "M3 4H40L9 9z"] {
            let expected = dashed(line);
            for nothing in ["M50 50z", "M50 50h0", "M50 50h0z", "M3 4C3 4 3 4 3 4z"] {
                for path in [format!("{nothing}{line}"), format!("{line}{nothing}")] {
                    assert_eq!(dashed(&path), expected, "{path}");
                }
            }
        }
    }
    fn dashes_of(path: &str, pattern: [f64; 2], offset: f64) -> String {
        let style: StrokeStyle = Stroke::new(1.0).with_caps(Cap::Round).with_dashes(offset, pattern).into();
        super::dashed(&BezPath::from_svg(path).expect("a path"), &style).expect("dashes").to_svg()
    }

    #[test]
    fn dashes_begin_and_end_where_the_pattern_says() {
        assert_eq!(dashes_of("M0 0H8", [3.0, 2.0], 0.0), "M0,0 L3,0 M5,0 L8,0");
        assert_eq!(dashes_of("M0 0H8", [3.0, 2.0], 1.0), "M0,0 L2,0 M4,0 L7,0");
        assert_eq!(dashes_of("M0 0H8", [3.0, 2.0], -1.0), "M1,0 L4,0 M6,0 L8,0");
        // Where a dash ends, none begins; nor at the end of the path.
        assert_eq!(dashes_of("M0 0H9", [3.0, 3.0], 3.0), "M3,0 L6,0");
        assert_eq!(dashes_of("M0 0H6", [3.0, 3.0], 0.0), "M0,0 L3,0");
        // At a corner a dash ends before it, and begins behind it.
        assert_eq!(dashes_of("M0 0H3V8", [3.0, 2.0], 0.0), "M0,0 L3,0 M3,2 L3,5 M3,7 L3,8");
        assert_eq!(dashes_of("M0 0H5V8", [3.0, 2.0], 0.0), "M0,0 L3,0 M5,0 L5,3 M5,5 L5,8");
        // What has no length counts for nothing.
        for nothing in ["L0 0", "Q0 0 0 0", "C0 0 0 0 0 0"] {
            assert_eq!(dashes_of(&format!("M0 0{nothing}H8"), [3.0, 2.0], 0.0), "M0,0 L3,0 M5,0 L8,0");
        }
    }

    #[test]
    fn dashes_that_meet_in_the_seam_are_one() {
        assert_eq!(dashes_of("M0 0H4V4H0z", [6.0, 4.0], 0.0), "M2,4 L0,4 L0,0 L4,0 L4,2");
        assert_eq!(dashes_of("M0 0H4V4H0z", [6.0, 2.0], 0.0), "M0,0 L4,0 L4,2 M4,4 L0,4 L0,2");
        assert_eq!(dashes_of("M0 0H4V4H0z", [20.0, 2.0], 0.0), "M0,0 L4,0 L4,4 L0,4 L0,0");
        // A gap too thin to be meant is closed.
        assert_eq!(
            dashes_of("M0 0H4V4H0z", [15.99609375, 2.0], 0.0),
            "M0,0 L4,0 L4,4 L0,4 L0,0.00390625 L0,0"
        );
        assert_eq!(dashes_of("M0 0H4V4H0z", [6.0, 3.995], 0.0).matches('M').count(), 1);
        assert_eq!(dashes_of("M0 0H4V4H0z", [15.984375, 2.0], 0.0), "M0,0 L4,0 L4,4 L0,4 L0,0.015625");
    }

    #[test]
    fn a_dash_of_no_length_is_a_dot_that_moves_nothing() {
        let dots = dashes_of("M0 0H6V9", [0.0, 3.0], 0.0);
        let begins: Vec<&str> = dots.split('M').map(|dot| dot.split(' ').next().expect("a point")).collect();
        assert_eq!(begins, ["", "0,0", "3,0", "6,0", "6,3", "6,6"]);
        assert_eq!(dots.matches('L').count(), 5);
    }
    /// Why they are not kurbo's: README names it. Where this fails, they may be.
    #[test]
    fn kurbo_s_dashes_are_others() {
        for (path, pattern, offset) in [
            ("M0 0Q0 0 0 0L8 0", [3.0, 2.0], 0.0),
            ("M0 0H9", [3.0, 3.0], 3.0),
            ("M0 0H4V4H0z", [20.0, 2.0], 0.0),
        ] {
            let elements = BezPath::from_svg(path).expect("a path").into_elements();
            let theirs: BezPath = kurbo::dash(elements.into_iter(), offset, &pattern).collect();
            assert_ne!(theirs.to_svg(), dashes_of(path, pattern, offset), "{path}");
        }
    }
}
