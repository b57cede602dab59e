//! Takes the animation elements of a drawing, makes what they do: a [`Timed`] and an [`Effect`] each,
//! filed by the place that they change.

use super::cascade::{is_property, Cascade};
use super::clock::{self, When};
use super::document::{element, Element, Name, Values, ANIMATION_ELEMENTS};
use super::function::{Function, Progress};
use super::intervals::{Interval, Restart, Schedule, Sync, Timed, SAME};
use super::motion::Motion;
use super::transforms::{self, Frame};
use super::value::{Short, Value};
use super::Unevaluated;
use std::collections::{BTreeMap, HashMap};
use svgtypes::LengthUnit;
use usvg::roxmltree::{Document, Node};

/// All that SMIL says in a drawing.
#[derive(Debug, Default)]
pub(super) struct Smil {
    /// By number, in document order.
    pub timed: Vec<Timed>,
    animations: Vec<Animation>,
    tracks: BTreeMap<(Element, Name), Track>,
}

#[derive(Debug)]
struct Animation {
    effect: Effect,
    freeze: bool,
}

#[derive(Debug)]
enum Effect {
    Value(Function),
    Transform(Kind, Function),
    Motion(Motion),
    /// In error: only its intervals count, for those that wait for it.
    Nothing,
}

/// `type` of an `animateTransform`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Translate,
    Scale,
    Rotate,
    SkewX,
    SkewY,
}

/// One place that changes, and what changes it, in document order.
#[derive(Debug)]
struct Track {
    base: Value,
    animations: Vec<usize>,
}

impl Smil {
    /// Reads all animation elements.
    pub(super) fn read<'a>(
        xml: &'a Document<'a>,
        cascade: &Cascade<'a>,
        unevaluated: &mut Unevaluated,
    ) -> Smil {
        let mut ids: HashMap<&str, Node> = HashMap::new();
        for node in xml.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        let is_animation = |node: &Node| ANIMATION_ELEMENTS.contains(&node.tag_name().name());
        let nodes: Vec<Node> = xml.descendants().filter(is_animation).collect();
        let numbers: HashMap<&str, usize> =
            nodes.iter().enumerate().filter_map(|(i, node)| Some((node.attribute("id")?, i))).collect();
        let mut smil = Smil::default();
        for (number, &node) in nodes.iter().enumerate() {
            smil.timed.push(timed(node, &numbers, unevaluated));
            let target = match href(node) {
                Some(id) => ids.get(id).copied(),
                None => node.parent_element(),
            };
            let effect = match target {
                Some(target) => smil.place(number, node, target, cascade, &ids).unwrap_or_else(|what| {
                    unevaluated.add(format!("<{}> with wrong {what}", node.tag_name().name()));
                    Effect::Nothing
                }),
                None => Effect::Nothing,
            };
            let freeze = node.attribute("fill") == Some("freeze");
            smil.animations.push(Animation { effect, freeze });
        }
        smil
    }

    /// Files an animation, and says what it does.
    fn place<'a>(
        &mut self,
        number: usize,
        node: Node<'a, 'a>,
        target: Node<'a, 'a>,
        cascade: &Cascade<'a>,
        ids: &HashMap<&str, Node<'a, 'a>>,
    ) -> Result<Effect, &'static str> {
        let tag = node.tag_name().name();
        let name = match tag {
            "animateMotion" => "transform",
            "animateTransform" => node.attribute("attributeName").unwrap_or("transform"),
            _ => node.attribute("attributeName").ok_or("attributeName")?,
        };
        let name = name.trim().rsplit(':').next().filter(|name| can_move(name)).ok_or("attributeName")?;
        let in_style = is_property(name) || (name == "transform" && cascade.declared(target, name).is_some());
        let base = match in_style && name == "transform" {
            true => transforms::still(&cascade.value(target, name), &Frame::of(target, cascade)),
            false => cascade.value(target, name),
        };
        let current = cascade.current_color(target);
        let parse = |text: &str| match text.trim() {
            "inherit" => target.parent_element().map_or(Value::Text(String::new()), |parent| {
                Value::parse(name, &cascade.value(parent, name), Some(&current))
            }),
            text => Value::parse(name, text, Some(&current)),
        };
        let (effect, base) = match tag {
            "animateMotion" => {
                let motion = Motion::read(node, |id| ids.get(id)?.attribute("d"))?;
                (Effect::Motion(motion), Value::Text(base))
            }
            "animateTransform" => {
                let (kind, function) = transform(node, &base)?;
                (Effect::Transform(kind, function), Value::Text(base))
            }
            _ if name.ends_with("ransform") => return Err("attributeName"),
            _ => (Effect::Value(Function::read(node, parse, |by| by.plus(by, -1.0))?), parse(&base)),
        };
        let name = name.to_string();
        let name = if in_style { Name::Property(name) } else { Name::Attribute(name) };
        let track =
            self.tracks.entry((element(target), name)).or_insert(Track { base, animations: Vec::new() });
        track.animations.push(number);
        Ok(effect)
    }

    /// What is changed at all.
    pub(super) fn places(&self) -> impl Iterator<Item = &(Element, Name)> {
        self.tracks.keys()
    }

    /// The values at `time`, of the places whose values are not their own.
    pub(super) fn values(&self, schedule: &Schedule, time: f64, values: &mut Values) {
        for ((node, name), track) in &self.tracks {
            let mut acting: Vec<(f64, usize, Progress)> = Vec::new();
            for &number in &track.animations {
                let Some(interval) = schedule.current(number, time) else { continue };
                if let Some(progress) = self.progress(number, interval, time) {
                    acting.push((interval.begin, number, progress));
                }
            }
            // Who began last is on top; a tie is in document order.
            acting.sort_by(|a, b| a.0.total_cmp(&b.0));
            if !acting.is_empty() {
                let text = self.over(&track.base, &acting);
                values.entry(*node).or_default().insert(name.clone(), text);
            }
        }
    }

    /// How far an animation is, if it does anything at `time`.
    fn progress(&self, number: usize, interval: Interval, time: f64) -> Option<Progress> {
        // It may be active for longer than it moves: `min` says so.
        let end = interval.end.min(interval.begin + self.timed[number].repeated());
        let over = time >= end - SAME;
        if over && !self.animations[number].freeze {
            return None;
        }
        let elapsed = if over { end } else { time } - interval.begin;
        let Some(simple) = self.timed[number].simple else {
            return Some(Progress { share: 0.0, iteration: 0.0 });
        };
        let rounds = (elapsed / simple).max(0.0);
        // A time that is a multiple but for rounding is one.
        let whole = rounds.round();
        let mut iteration =
            if (rounds - whole).abs() <= SAME / simple.min(1.0) { whole } else { rounds.floor() };
        let mut share = (rounds - iteration).clamp(0.0, 1.0);
        if over && share <= SAME && iteration > 0.0 {
            // The end of the last repetition, not the start of the next.
            iteration -= 1.0;
            share = 1.0;
        }
        Some(Progress { share, iteration })
    }

    /// The sandwich: each animation over those below.
    fn over(&self, base: &Value, acting: &[(f64, usize, Progress)]) -> String {
        let mut value = base.clone();
        let mut motion = String::new();
        for &(_, number, progress) in acting {
            match &self.animations[number].effect {
                Effect::Value(function) => value = function.over(&value, progress),
                Effect::Transform(kind, function) => {
                    let own = kind.text(&function.alone(&Value::Text(String::new()), progress));
                    value = Value::Text(if function.sum { format!("{} {own}", value.text()) } else { own });
                }
                Effect::Motion(course) if course.sum => motion = format!("{motion} {}", course.at(progress)),
                Effect::Motion(course) => motion = course.at(progress),
                Effect::Nothing => {}
            }
        }
        // The motion stands outside of the element's transform.
        match motion.is_empty() {
            true => value.text().trim().to_string(),
            false => format!("{motion} {}", value.text()).trim().to_string(),
        }
    }

    /// Whether an animation's value at its end stays.
    pub(super) fn freezes(&self, number: usize) -> bool {
        self.animations[number].freeze
    }
}

/// The id in an element's link.
pub(super) fn href<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    const XLINK: &str = "http://www.w3.org/1999/xlink";
    let link = node.attribute("href").or_else(|| node.attribute((XLINK, "href")))?;
    link.trim().strip_prefix('#')
}

/// Whether this is the name of an attribute that may change.
fn can_move(name: &str) -> bool {
    let plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
    plain && name.starts_with(|c: char| c.is_ascii_alphabetic()) && !["id", "style", "xmlns"].contains(&name)
}

fn timed(node: Node, numbers: &HashMap<&str, usize>, unevaluated: &mut Unevaluated) -> Timed {
    let get = |name: &str| node.attribute(name).map(str::trim);
    let clock = |name: &str| get(name).and_then(clock::clock).filter(|&seconds| seconds > 0.0);
    let mut timed = Timed {
        simple: clock("dur"),
        repeat_count: get("repeatCount").and_then(count),
        repeat_duration: match get("repeatDur") {
            Some("indefinite") => Some(f64::INFINITY),
            _ => clock("repeatDur"),
        },
        min: clock("min"),
        max: clock("max"),
        restart: match get("restart") {
            Some("never") => Restart::Never,
            Some("whenNotActive") => Restart::WhenNotActive,
            _ => Restart::Always,
        },
        has_end: get("end").is_some(),
        ..Timed::default()
    };
    for (name, text) in [("begin", get("begin").unwrap_or("0")), ("end", get("end").unwrap_or(""))] {
        for when in clock::list(text) {
            let is_end = name == "end";
            match when {
                When::At(seconds) if is_end => timed.ends.push(seconds),
                When::At(seconds) => timed.begins.push(seconds),
                When::Sync { id, moment, offset } => match numbers.get(id.as_str()) {
                    Some(&other) => {
                        let syncs = if is_end { &mut timed.end_syncs } else { &mut timed.begin_syncs };
                        syncs.push(Sync { other, moment, offset });
                    }
                    None => unevaluated.add(format!("{name} after '{id}', which is no animation")),
                },
                When::Never => timed.end_may_come |= is_end,
                When::Event => {
                    timed.end_may_come |= is_end;
                    unevaluated.add(format!("{name}=\"{text}\""));
                }
            }
        }
    }
    timed.end_may_come |= !timed.end_syncs.is_empty();
    timed
}

fn count(text: &str) -> Option<f64> {
    match text {
        "indefinite" => Some(f64::INFINITY),
        _ => text.parse().ok().filter(|&count: &f64| count > 0.0 && count.is_finite()),
    }
}

/// Reads an `animateTransform`; `base` is the element's own transform.
fn transform(node: Node, base: &str) -> Result<(Kind, Function), &'static str> {
    let kind = match node.attribute("type").map_or("translate", str::trim) {
        "translate" => Kind::Translate,
        "scale" => Kind::Scale,
        "rotate" => Kind::Rotate,
        "skewX" => Kind::SkewX,
        "skewY" => Kind::SkewY,
        _ => return Err("type"),
    };
    if node.tag_name().name() != "animateTransform" {
        return Err("type");
    }
    let identity = kind.value(kind.identity());
    let function = Function::read(node, |text| kind.parse(text), |_| Some(identity.clone()))?;
    // A base of the same single kind is what `to` starts from; of any other, the identity.
    let own =
        base.trim().strip_suffix(')').and_then(|b| b.strip_prefix(kind.name())?.trim().strip_prefix('('));
    let from = own.map(|numbers| kind.parse(numbers));
    let function = function.starting(|to| match from {
        Some(from) if from.mix(to, 0.5).is_some() => from,
        _ => identity,
    });
    Ok((kind, function))
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Translate => "translate",
            Kind::Scale => "scale",
            Kind::Rotate => "rotate",
            Kind::SkewX => "skewX",
            Kind::SkewY => "skewY",
        }
    }

    fn identity(self) -> &'static [f64] {
        match self {
            Kind::Translate => &[0.0, 0.0],
            Kind::Scale => &[1.0, 1.0],
            Kind::Rotate => &[0.0, 0.0, 0.0],
            Kind::SkewX | Kind::SkewY => &[0.0],
        }
    }

    fn value(self, numbers: &[f64]) -> Value {
        Value::Numbers(numbers.iter().map(|&n| (n, LengthUnit::None)).collect())
    }

    /// Numbers that may be left out are put in, so that all values mix.
    fn parse(self, text: &str) -> Value {
        let Value::Numbers(list) = Value::parse("transform", text, None) else {
            return Value::Text(String::new());
        };
        let mut numbers: Vec<f64> = list.into_iter().map(|(number, _)| number).collect();
        if self == Kind::Scale && numbers.len() == 1 {
            numbers.push(numbers[0]);
        }
        let identity = self.identity();
        numbers.extend_from_slice(identity.get(numbers.len()..).unwrap_or_default());
        numbers.truncate(identity.len());
        self.value(&numbers)
    }

    fn text(self, value: &Value) -> String {
        let Value::Numbers(list) = value else { return String::new() };
        let numbers: Vec<String> = list.iter().map(|(number, _)| Short(*number).to_string()).collect();
        format!("{}({})", self.name(), numbers.join(" "))
    }
}
