//! Takes an `animateMotion`, makes the translation and turn at a share of its duration. After SVG 1.1,
//! 19.2.13.

use super::function::{shares, Between, Calc, Pace, Progress};
use super::value::Short;
use kurbo::{ParamCurve, ParamCurveArclen, ParamCurveDeriv, PathSeg, Point, Vec2};
use svgtypes::{SimplePathSegment, SimplifyingPathParser};
use usvg::roxmltree::Node;

/// Most segments of a path: their lengths are measured.
const MOST_SEGMENTS: usize = 100_000;
/// Error of a length, in user units.
const ACCURACY: f64 = 1e-6;

/// A course along a path.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    segments: Vec<PathSeg>,
    /// Length of the path up to the end of each segment.
    lengths: Vec<f64>,
    /// Shares of the length, which the pace's key times belong to.
    points: Vec<f64>,
    pace: Pace,
    rotate: Rotate,
    /// It goes on from what other motions did.
    pub sum: bool,
    accumulate: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Rotate {
    /// Degrees.
    By(f64),
    /// Along the path; and this many degrees.
    Along(f64),
}

impl Motion {
    /// Reads one; `path_of` finds the path data of an element by its id.
    ///
    /// # Errors
    /// Which attribute is wrong or missing.
    pub(super) fn read<'a>(
        node: Node<'a, 'a>,
        path_of: impl Fn(&str) -> Option<&'a str>,
    ) -> Result<Motion, &'static str> {
        let mut sum = node.attribute("additive") == Some("sum");
        let mpath = node.children().find(|child| child.tag_name().name() == "mpath");
        let segments = if let Some(mpath) = mpath {
            parse(path_of(super::href(mpath).ok_or("mpath")?).ok_or("mpath")?)
        } else if let Some(data) = node.attribute("path") {
            parse(data)
        } else {
            sum |= node.attribute("by").is_some()
                && node.attribute("from").is_none()
                && node.attribute("to").is_none();
            through(node)
        };
        let segments = segments.filter(|s| !s.is_empty()).ok_or("path")?;
        let mut total = 0.0;
        let lengths: Vec<f64> = segments
            .iter()
            .map(|segment| {
                total += segment.arclen(ACCURACY);
                total
            })
            .collect();
        let vertices =
            || std::iter::once(0.0).chain(lengths.iter().map(|l| if total > 0.0 { l / total } else { 0.0 }));
        let points = match node.attribute("keyPoints") {
            Some(text) => shares(text).ok_or("keyPoints")?,
            None => vertices().collect(),
        };
        let mut pace = Pace::read(node, points.len(), Calc::Paced)?;
        if pace.calc == Calc::Paced {
            let steps: Vec<f64> = points.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
            pace.follow(&steps);
        }
        let rotate = match node.attribute("rotate").map(str::trim) {
            Some("auto") => Rotate::Along(0.0),
            Some("auto-reverse") => Rotate::Along(180.0),
            Some(text) => Rotate::By(text.parse().map_err(|_| "rotate")?),
            None => Rotate::By(0.0),
        };
        let accumulate = node.attribute("accumulate") == Some("sum");
        Ok(Motion { segments, lengths, points, pace, rotate, sum, accumulate })
    }

    /// The transform, as it stands in an attribute.
    pub(super) fn at(&self, progress: Progress) -> String {
        let Between { from, to, share } = self.pace.between(self.points.len(), progress.share);
        let (a, b) = (self.points[from], self.points[to]);
        let (mut place, direction) = self.along(a + (b - a) * share);
        if self.accumulate {
            let end = self.segments.last().expect("a path has segments").end();
            place += end.to_vec2() * progress.iteration;
        }
        let mut text = format!("translate({} {})", Short(place.x), Short(place.y));
        let degrees = match self.rotate {
            Rotate::By(degrees) => degrees,
            Rotate::Along(more) => direction.atan2().to_degrees() + more,
        };
        if degrees != 0.0 {
            text += &format!(" rotate({})", Short(degrees));
        }
        text
    }

    /// The point at a share of the path's length, and the path's direction there.
    fn along(&self, share: f64) -> (Point, Vec2) {
        let total = *self.lengths.last().expect("a path has segments");
        let gone = share * total;
        let at = self.lengths.partition_point(|&length| length < gone).min(self.segments.len() - 1);
        let before = if at == 0 { 0.0 } else { self.lengths[at - 1] };
        let segment = self.segments[at];
        let t = match self.lengths[at] - before {
            length if gone - before >= length => 1.0,
            _ => segment.inv_arclen((gone - before).max(0.0), ACCURACY),
        };
        (segment.eval(t), direction(segment, t))
    }
}

/// Where a segment leads at `t`; where it stands still, where it leads as a whole.
fn direction(segment: PathSeg, t: f64) -> Vec2 {
    let slope = match segment {
        PathSeg::Line(line) => line.p1 - line.p0,
        PathSeg::Quad(quad) => quad.deriv().eval(t).to_vec2(),
        PathSeg::Cubic(cubic) => cubic.deriv().eval(t).to_vec2(),
    };
    if slope.hypot() > 1e-9 {
        slope
    } else {
        segment.end() - segment.start()
    }
}

fn parse(data: &str) -> Option<Vec<PathSeg>> {
    let mut path = kurbo::BezPath::new();
    if crate::scene::load::has_far_arc(data) {
        return None;
    }
    for segment in SimplifyingPathParser::from(data) {
        use SimplePathSegment as S;
        // What comes before an error is drawn, as in a path.
        let Ok(segment) = segment else { break };
        match segment {
            S::MoveTo { x, y } => path.move_to((x, y)),
            S::LineTo { x, y } => path.line_to((x, y)),
            S::CurveTo { x1, y1, x2, y2, x, y } => path.curve_to((x1, y1), (x2, y2), (x, y)),
            S::Quadratic { x1, y1, x, y } => path.quad_to((x1, y1), (x, y)),
            S::ClosePath => path.close_path(),
        }
        if path.elements().len() > MOST_SEGMENTS {
            return None;
        }
    }
    let finite = path.elements().iter().all(|e| e.is_finite());
    finite.then(|| path.segments().collect())
}

/// The polygon through `values`, or `from`, `to` and `by`.
fn through(node: Node) -> Option<Vec<PathSeg>> {
    let get = |name: &str| node.attribute(name).map(point);
    let points: Vec<Point> = if let Some(values) = node.attribute("values") {
        values.trim().trim_end_matches(';').split(';').map(point).collect::<Option<_>>()?
    } else {
        match (get("from"), get("to"), get("by")) {
            (Some(from), Some(to), _) => vec![from?, to?],
            (None, Some(to), _) => vec![Point::ZERO, to?],
            (Some(from), None, Some(by)) => vec![from?, from? + by?.to_vec2()],
            (None, None, Some(by)) => vec![Point::ZERO, by?],
            _ => return None,
        }
    };
    let line = |pair: &[Point]| PathSeg::Line(kurbo::Line::new(pair[0], pair[1]));
    match points[..] {
        [] => None,
        [only] => Some(vec![line(&[only, only])]),
        _ => Some(points.windows(2).map(line).collect()),
    }
}

fn point(text: &str) -> Option<Point> {
    let numbers = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|n| !n.is_empty());
    let numbers: Vec<f64> = numbers.map(|n| n.parse().ok()).collect::<Option<_>>()?;
    match numbers[..] {
        [x, y] if x.is_finite() && y.is_finite() => Some(Point::new(x, y)),
        _ => None,
    }
}
