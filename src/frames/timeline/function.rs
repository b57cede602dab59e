//! Takes `values`, `from`, `to`, `by` and the rest of what shapes an animation's course, makes the value
//! at a share of its simple duration. After SMIL 3.0, 12.4 (animation function) and SVG 1.1, 19.2.

use super::easing::Easing;
use super::value::Value;
use usvg::roxmltree::Node;

/// Where an animation is within its simple duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Progress {
    /// 0..=1.
    pub share: f64,
    /// Repetitions that are done.
    pub iteration: f64,
}

/// How values follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Calc {
    Discrete,
    Linear,
    Paced,
    Spline,
}

/// Which share of the time belongs to which value.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    pub calc: Calc,
    /// One for each value, or none if all are equally long.
    pub key_times: Vec<f64>,
    /// One for each step between values, or none.
    pub easings: Vec<Easing>,
}

/// Two neighbouring values, by number, and the share of the way between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Between {
    pub from: usize,
    pub to: usize,
    pub share: f64,
}

impl Pace {
    /// Reads `calcMode`, `keyTimes` and `keySplines` of an animation with `count` values (key points,
    /// for a motion that has them).
    ///
    /// # Errors
    /// Which attribute is wrong: the animation then has no effect, as SMIL says.
    pub(super) fn read(node: Node, count: usize, default: Calc) -> Result<Pace, &'static str> {
        let calc = match node.attribute("calcMode").map(str::trim) {
            Some("discrete") => Calc::Discrete,
            Some("linear") => Calc::Linear,
            Some("paced") => Calc::Paced,
            Some("spline") => Calc::Spline,
            _ => default,
        };
        let mut pace = Pace { calc, key_times: Vec::new(), easings: Vec::new() };
        if let Some(text) = node.attribute("keyTimes").filter(|_| calc != Calc::Paced) {
            pace.key_times = shares(text).filter(|times| pace.fits(times, count)).ok_or("keyTimes")?;
        }
        if calc == Calc::Spline {
            let text = node.attribute("keySplines").ok_or("keySplines")?;
            pace.easings = splines(text).filter(|list| list.len() + 1 == count.max(1)).ok_or("keySplines")?;
        }
        Ok(pace)
    }

    fn fits(&self, times: &[f64], count: usize) -> bool {
        let ends = self.calc == Calc::Discrete || count < 2 || times.last() == Some(&1.0);
        times.len() == count && times.first() == Some(&0.0) && ends && times.is_sorted()
    }

    /// Makes time follow distance: `distances` from each value to the next.
    pub(super) fn follow(&mut self, distances: &[f64]) {
        let total: f64 = distances.iter().sum();
        if total > 0.0 {
            let mut gone = 0.0;
            let mut times = vec![0.0];
            for distance in distances {
                gone += distance;
                times.push((gone / total).min(1.0));
            }
            self.key_times = times;
        }
    }

    /// The values of `count` that a share of the time lies between.
    pub(super) fn between(&self, count: usize, share: f64) -> Between {
        let last = count.saturating_sub(1);
        let even = |parts: usize| ((share * parts as f64 + 1e-9) as usize).min(parts.saturating_sub(1));
        let key = || self.key_times.partition_point(|&time| time <= share + 1e-9).saturating_sub(1);
        if self.calc == Calc::Discrete || count < 2 {
            let at = if self.key_times.is_empty() { even(count) } else { key().min(last) };
            return Between { from: at, to: at, share: 0.0 };
        }
        let (from, within) = if self.key_times.is_empty() {
            let from = even(last);
            (from, share * last as f64 - from as f64)
        } else {
            let from = key().min(last - 1);
            let (begin, end) = (self.key_times[from], self.key_times[from + 1]);
            (from, if end > begin { (share - begin) / (end - begin) } else { 1.0 })
        };
        let within = within.clamp(0.0, 1.0);
        let share = self.easings.get(from).map_or(within, |easing| easing.at(within));
        Between { from, to: from + 1, share }
    }
}

/// Numbers within 0..=1, by semicolons; one may end the list.
pub(super) fn shares(text: &str) -> Option<Vec<f64>> {
    let list = text.trim().trim_end_matches(';').split(';').map(|item| item.trim().parse::<f64>().ok());
    list.map(|share| share.filter(|s| (0.0..=1.0).contains(s))).collect()
}

fn splines(text: &str) -> Option<Vec<Easing>> {
    let curve = |item: &str| {
        let numbers = item.split(|c: char| c == ',' || c.is_whitespace()).filter(|n| !n.is_empty());
        let numbers: Vec<f64> = numbers.map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let points: [f64; 4] = numbers.try_into().ok()?;
        points.iter().all(|p| (0.0..=1.0).contains(p)).then_some(Easing::Bezier(points))
    };
    text.trim().trim_end_matches(';').split(';').map(curve).collect()
}

/// From progress to value.
#[derive(Clone, Debug)]
pub(super) struct Function {
    course: Course,
    pace: Pace,
    /// Its values are added to what is below.
    pub sum: bool,
    accumulate: bool,
}

#[derive(Clone, Debug)]
enum Course {
    /// Through these values.
    Through(Vec<Value>),
    /// From whatever is below to this.
    To(Value),
}

impl Function {
    /// Reads the values of an animation; `parse` makes a value of a text, `zero` what `by` starts from.
    ///
    /// # Errors
    /// Which attribute is wrong or missing.
    pub(super) fn read(
        node: Node,
        parse: impl Fn(&str) -> Value,
        zero: impl Fn(&Value) -> Option<Value>,
    ) -> Result<Function, &'static str> {
        let get = |name: &str| node.attribute(name).map(&parse);
        let mut sum = node.attribute("additive") == Some("sum");
        let course = if node.tag_name().name() == "set" {
            Course::Through(vec![get("to").ok_or("to")?])
        } else if let Some(values) = node.attribute("values") {
            let list: Vec<&str> = values.trim().trim_end_matches(';').split(';').collect();
            Course::Through(list.into_iter().map(|text| parse(text.trim())).collect())
        } else {
            match (get("from"), get("to"), get("by")) {
                (Some(from), Some(to), _) => Course::Through(vec![from, to]),
                (None, Some(to), _) => Course::To(to),
                (Some(from), None, Some(by)) => {
                    let to = from.plus(&by, 1.0).ok_or("by")?;
                    Course::Through(vec![from, to])
                }
                (None, None, Some(by)) => {
                    sum = true;
                    Course::Through(vec![zero(&by).ok_or("by")?, by])
                }
                (_, None, None) => return Err("values"),
            }
        };
        let count = match &course {
            Course::Through(values) => values.len(),
            Course::To(_) => 2,
        };
        let mut pace = Pace::read(node, count, Calc::Linear)?;
        if let Course::Through(values) = &course {
            pace.suit(values);
        }
        let is_to = matches!(course, Course::To(_));
        let accumulate = node.attribute("accumulate") == Some("sum") && !is_to;
        Ok(Function { course, pace, sum: sum && !is_to, accumulate })
    }

    /// A course to a value which starts from a known one.
    pub(super) fn starting(mut self, from: impl FnOnce(&Value) -> Value) -> Function {
        if let Course::To(to) = &self.course {
            self.course = Course::Through(vec![from(to), to.clone()]);
        }
        self
    }

    /// The value over `below`; an addition only if they add up.
    pub(super) fn over(&self, below: &Value, progress: Progress) -> Value {
        let value = self.alone(below, progress);
        match self.sum {
            true if is_empty(below) => value,
            true => below.plus(&value, 1.0).unwrap_or(value),
            false => value,
        }
    }

    /// The value before it is added to anything.
    pub(super) fn alone(&self, below: &Value, progress: Progress) -> Value {
        match &self.course {
            Course::To(to) => {
                let nothing = to.plus(to, -1.0).filter(|_| is_empty(below));
                let from = nothing.as_ref().unwrap_or(below);
                let Between { from: first, share, .. } = self.pace.between(2, progress.share);
                if self.pace.calc == Calc::Discrete {
                    return if first == 0 && !self.pace.key_times.is_empty() {
                        from.clone()
                    } else {
                        to.clone()
                    };
                }
                from.mix(to, share).unwrap_or_else(|| to.clone())
            }
            Course::Through(values) => {
                let Between { from, to, share } = self.pace.between(values.len(), progress.share);
                let value = values[from].mix(&values[to], share).filter(|_| from != to);
                let value = value.unwrap_or_else(|| values[from].clone());
                match values.last().filter(|_| self.accumulate && progress.iteration > 0.0) {
                    Some(last) => value.plus(last, progress.iteration).unwrap_or(value),
                    None => value,
                }
            }
        }
    }
}

impl Pace {
    /// Values that do not mix jump; paced ones take time by their distances.
    fn suit(&mut self, values: &[Value]) {
        let pairs = || values.iter().zip(values.iter().skip(1));
        if pairs().any(|(a, b)| a.mix(b, 0.5).is_none()) {
            // A jump's key times end before 1, or reach it and never show the last value.
            self.calc = Calc::Discrete;
        } else if self.calc == Calc::Paced {
            if let Some(distances) = pairs().map(|(a, b)| a.distance(b)).collect::<Option<Vec<_>>>() {
                self.follow(&distances);
            }
        }
    }
}

fn is_empty(value: &Value) -> bool {
    matches!(value, Value::Text(text) if text.is_empty())
}
