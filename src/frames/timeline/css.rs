//! Takes style sheets with `@keyframes` and `animation-…`, makes the values of properties at a time.
//! After CSS Animations 1 and, for how values mix, CSS Transforms 1 and CSS Values 3.

use super::cascade::{is_property, style_texts, Cascade};
use super::document::{element, Element, Name, Values};
use super::easing::Easing;
use super::transforms::{self, Frame};
use super::value::Value;
use super::Unevaluated;
use simplecss::DeclarationTokenizer;
use std::collections::HashMap;
use usvg::roxmltree::{Document, Node};

/// All that style sheets animate in a drawing, in the order in which it applies.
#[derive(Debug, Default)]
pub(super) struct Css {
    tracks: Vec<Track>,
}

/// One animation of one property of one element.
#[derive(Debug)]
struct Track {
    node: Element,
    name: Name,
    run: Run,
    /// By their share of the duration; the first is at 0, the last at 1.
    stops: Vec<Stop>,
    /// For currentColor and for where keyframes leave the property out.
    current: String,
    base: String,
    frame: Frame,
}

#[derive(Clone, Debug)]
struct Stop {
    at: f64,
    /// `None` is the value that the element has without this animation.
    value: Option<String>,
    easing: Option<Easing>,
}

/// `animation-…` of one animation.
#[derive(Clone, Debug)]
struct Run {
    name: String,
    duration: f64,
    easing: Easing,
    delay: f64,
    count: f64,
    direction: Direction,
    before: bool,
    after: bool,
    paused: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Normal,
    Reverse,
    Alternate,
    AlternateReverse,
}

type Keyframes = HashMap<String, Vec<(f64, Vec<(String, String)>)>>;

impl Css {
    pub(super) fn read<'a>(
        xml: &'a Document<'a>,
        cascade: &Cascade<'a>,
        injected: Option<&'a str>,
        unevaluated: &mut Unevaluated,
    ) -> Css {
        let mut keyframes = Keyframes::new();
        for text in injected.into_iter().chain(style_texts(xml)) {
            find_keyframes(text, &mut keyframes);
        }
        let mut css = Css::default();
        if keyframes.is_empty() {
            return css;
        }
        for node in xml.descendants().filter(Node::is_element) {
            for run in runs(&cascade.declarations(node)) {
                if let Some(blocks) = keyframes.get(&run.name) {
                    css.add(node, run, blocks, cascade, unevaluated);
                }
            }
        }
        css
    }

    fn add<'a>(
        &mut self,
        node: Node<'a, 'a>,
        run: Run,
        blocks: &[(f64, Vec<(String, String)>)],
        cascade: &Cascade<'a>,
        unevaluated: &mut Unevaluated,
    ) {
        let mut names: Vec<&str> =
            blocks.iter().flat_map(|(_, list)| list).map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let place = match name {
                "animation-timing-function" => continue,
                name if is_property(name) || name == "transform" => Name::Property(name.to_string()),
                "d" | "x" | "y" | "cx" | "cy" | "r" | "rx" | "ry" | "width" | "height" => {
                    Name::Attribute(name.to_string())
                }
                name => {
                    unevaluated.add(format!("the property {name} in @keyframes"));
                    continue;
                }
            };
            let frame = if name == "transform" { Frame::of(node, cascade) } else { Frame::default() };
            self.tracks.push(Track {
                node: element(node),
                name: place,
                run: run.clone(),
                stops: stops(name, blocks),
                current: cascade.current_color(node),
                base: cascade.value(node, name),
                frame,
            });
        }
    }

    /// What is changed at all.
    pub(super) fn places(&self) -> impl Iterator<Item = (Element, Name)> + '_ {
        self.tracks.iter().map(|track| (track.node, track.name.clone()))
    }

    /// The elements whose boxes transforms refer to, and what is to be told about them.
    pub(super) fn boxes(&mut self) -> impl Iterator<Item = (Element, &mut Frame)> {
        self.tracks
            .iter_mut()
            .filter(|track| track.frame.needs_box())
            .map(|track| (track.node, &mut track.frame))
    }

    /// Puts the values at `time` over those of SMIL.
    pub(super) fn values(&self, time: f64, values: &mut Values) {
        for track in &self.tracks {
            let Some(share) = track.run.share(time) else { continue };
            let below = values.get(&track.node).and_then(|of| of.get(&track.name)).unwrap_or(&track.base);
            let text = track.value(share, below);
            let own = values.entry(track.node).or_default();
            own.insert(track.name.clone(), text);
            if let Some(origin) =
                track.frame.origin().filter(|_| track.name == Name::Property("transform".into()))
            {
                own.insert(Name::Property("transform-origin".into()), origin);
            }
        }
    }

    /// For each animation: when its last change is, and its period if it has no end.
    pub(super) fn ends(&self) -> impl Iterator<Item = (f64, Option<f64>)> + '_ {
        self.tracks.iter().filter(|track| !track.run.paused).map(|track| {
            let run = &track.run;
            let turns = matches!(run.direction, Direction::Alternate | Direction::AlternateReverse);
            let period = run.duration * if turns { 2.0 } else { 1.0 };
            match run.count.is_finite() {
                true => (run.delay + run.duration * run.count, None),
                false => (run.delay, Some(period)),
            }
        })
    }
}

impl Run {
    /// Where in its keyframes it is, 0..=1; `None` where it has no effect.
    fn share(&self, time: f64) -> Option<f64> {
        let elapsed = if self.paused { 0.0 } else { time } - self.delay;
        let active = if self.count == 0.0 { 0.0 } else { self.duration * self.count };
        let (elapsed, over) = if elapsed < -1e-9 {
            self.before.then_some((0.0, false))?
        } else if elapsed >= active - 1e-9 {
            self.after.then_some((active, true))?
        } else {
            (elapsed, false)
        };
        let rounds = if self.duration > 0.0 {
            elapsed / self.duration
        } else if over {
            self.count
        } else {
            0.0
        };
        let rounds = if rounds.is_finite() { rounds } else { 1.0 };
        let whole = if (rounds - rounds.round()).abs() < 1e-9 { rounds.round() } else { rounds.floor() };
        let (iteration, share) = match over && whole > 0.0 && rounds - whole < 1e-9 {
            true => (whole - 1.0, 1.0),
            false => (whole, (rounds - whole).clamp(0.0, 1.0)),
        };
        let odd = iteration % 2.0 == 1.0;
        let backwards = match self.direction {
            Direction::Normal => false,
            Direction::Reverse => true,
            Direction::Alternate => odd,
            Direction::AlternateReverse => !odd,
        };
        Some(if backwards { 1.0 - share } else { share })
    }
}

impl Track {
    fn value(&self, share: f64, below: &str) -> String {
        let last = self.stops.len() - 1;
        let from = self.stops.partition_point(|stop| stop.at <= share + 1e-9).clamp(1, last) - 1;
        let (a, b) = (&self.stops[from], &self.stops[from + 1]);
        let within = if b.at > a.at { ((share - a.at) / (b.at - a.at)).clamp(0.0, 1.0) } else { 1.0 };
        let way = a.easing.as_ref().unwrap_or(&self.run.easing).at(within);
        let (from, to) = (a.value.as_deref().unwrap_or(below), b.value.as_deref().unwrap_or(below));
        let name = match &self.name {
            Name::Attribute(name) | Name::Property(name) => name.as_str(),
        };
        if name == "transform" {
            return transforms::mix(from, to, way, &self.frame);
        }
        let parse = |text: &str| Value::parse(name, unwrap_path(name, text), Some(&self.current));
        let (a, b) = (parse(from), parse(to));
        match a.mix(&b, way) {
            Some(value) => value.text(),
            None if name == "visibility" && (from == "visible" || to == "visible") => {
                // It is seen all the way between hidden and visible.
                let hidden = if way <= 0.0 {
                    from
                } else if way >= 1.0 {
                    to
                } else {
                    "visible"
                };
                hidden.to_string()
            }
            None => if way < 0.5 { a } else { b }.text(),
        }
    }
}

/// `path("M0 0")` as it stands in an attribute.
fn unwrap_path<'a>(name: &str, text: &'a str) -> &'a str {
    let inside =
        || text.trim().strip_prefix("path(")?.strip_suffix(')').map(|t| t.trim().trim_matches(['"', '\'']));
    if name == "d" {
        inside().unwrap_or(text)
    } else {
        text
    }
}

/// The keyframes that mention a property, with those at 0 and 1 put in where they are missing.
fn stops(name: &str, blocks: &[(f64, Vec<(String, String)>)]) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::new();
    for (at, declarations) in blocks {
        let get =
            |wanted: &str| declarations.iter().rfind(|(other, _)| other == wanted).map(|(_, value)| value);
        let Some(value) = get(name) else { continue };
        let easing = get("animation-timing-function").and_then(|text| Easing::from_css(text));
        stops.push(Stop { at: *at, value: Some(value.clone()), easing });
    }
    stops.sort_by(|a, b| a.at.total_cmp(&b.at));
    // The last of several at one place wins.
    stops.reverse();
    stops.dedup_by(|later, first| later.at == first.at);
    stops.reverse();
    let missing = |at| Stop { at, value: None, easing: None };
    if stops.first().is_none_or(|stop| stop.at > 0.0) {
        stops.insert(0, missing(0.0));
    }
    if stops.last().is_none_or(|stop| stop.at < 1.0) || stops.len() == 1 {
        stops.push(missing(1.0));
    }
    stops
}

/// Adds the `@keyframes` of a style sheet; a later one of the same name wins.
fn find_keyframes(css: &str, found: &mut Keyframes) {
    let css = &without_comments(css);
    let mut rest = css.as_str();
    while let Some(at) = rest.find('@') {
        rest = &rest[at + 1..];
        let Some(after) = rest.strip_prefix("-webkit-").unwrap_or(rest).strip_prefix("keyframes") else {
            continue;
        };
        let Some((name, body)) = after.split_once('{') else { break };
        let mut blocks = Vec::new();
        let mut body = body;
        while let Some(open) = body.find(['{', '}']) {
            if body.as_bytes()[open] == b'}' {
                body = &body[open + 1..];
                break;
            }
            let close = body[open..].find('}').map_or(body.len(), |close| open + close);
            let declarations: Vec<(String, String)> =
                DeclarationTokenizer::from(body[open + 1..close].trim())
                    .map(|d| (d.name.trim_start_matches("-webkit-").to_string(), d.value.trim().to_string()))
                    .collect();
            for selector in body[..open].split(',').map(str::trim) {
                let at = match selector {
                    "from" => Some(0.0),
                    "to" => Some(1.0),
                    text => {
                        text.strip_suffix('%').and_then(|n| n.trim().parse::<f64>().ok()).map(|p| p / 100.0)
                    }
                };
                if let Some(at) = at.filter(|at| (0.0..=1.0).contains(at)) {
                    blocks.push((at, declarations.clone()));
                }
            }
            body = body.get(close + 1..).unwrap_or("");
        }
        found.insert(name.trim().trim_matches(['"', '\'']).to_string(), blocks);
        rest = body;
    }
}

fn without_comments(css: &str) -> String {
    let mut out = String::with_capacity(css.len());
    let mut rest = css;
    while let Some((before, comment)) = rest.split_once("/*") {
        out.push_str(before);
        rest = comment.split_once("*/").map_or("", |(_, after)| after);
    }
    out + rest
}

/// The animations that an element's declarations ask for.
fn runs(declarations: &[(&str, &str)]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut longhands: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, value) in declarations {
        let name = name.trim_start_matches("-webkit-");
        if name == "animation" {
            runs = split(value, ',').into_iter().map(shorthand).collect();
            longhands.clear();
        } else if let Some(part) = name.strip_prefix("animation-") {
            longhands.push((part, split(value, ',')));
        }
    }
    if let Some((_, names)) = longhands.iter().rfind(|(part, _)| *part == "name") {
        runs.resize(names.len(), shorthand(""));
        names
            .iter()
            .zip(&mut runs)
            .for_each(|(name, run)| run.name = name.trim_matches(['"', '\'']).to_string());
    }
    for (part, values) in &longhands {
        for (run, value) in runs.iter_mut().zip(values.iter().cycle()) {
            run.set(part, value);
        }
    }
    // A negative delay is fine, a negative duration is not.
    runs.retain(|run| run.name != "none" && !run.name.is_empty() && run.duration >= 0.0);
    runs
}

impl Run {
    fn set(&mut self, part: &str, value: &str) {
        match part {
            "duration" => self.duration = seconds(value).unwrap_or(0.0),
            "delay" => self.delay = seconds(value).unwrap_or(0.0),
            "timing-function" => self.easing = Easing::from_css(value).unwrap_or(Easing::EASE),
            "iteration-count" => self.count = count(value).unwrap_or(1.0),
            "direction" => self.direction = direction(value).unwrap_or(Direction::Normal),
            "fill-mode" => {
                self.before = matches!(value, "backwards" | "both");
                self.after = matches!(value, "forwards" | "both");
            }
            "play-state" => self.paused = value == "paused",
            _ => {}
        }
    }
}

/// One animation of the `animation` property: its words are known by what they look like.
fn shorthand(text: &str) -> Run {
    let mut run = Run {
        name: String::new(),
        duration: 0.0,
        easing: Easing::EASE,
        delay: 0.0,
        count: 1.0,
        direction: Direction::Normal,
        before: false,
        after: false,
        paused: false,
    };
    let mut times = 0;
    for word in split(text, ' ') {
        if let Some(time) = seconds(word) {
            *[&mut run.duration, &mut run.delay][times.min(1)] = time;
            times += 1;
        } else if let Some(easing) = Easing::from_css(word) {
            run.easing = easing;
        } else if let Some(count) = count(word) {
            run.count = count;
        } else if let Some(direction) = direction(word) {
            run.direction = direction;
        } else {
            match word {
                "forwards" | "backwards" | "both" => run.set("fill-mode", word),
                "paused" | "running" => run.set("play-state", word),
                "none" if !run.name.is_empty() => {}
                name => run.name = name.trim_matches(['"', '\'']).to_string(),
            }
        }
    }
    run
}

/// Parts between separators that stand outside of parentheses; a space is any white space.
fn split(text: &str, separator: char) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut depth, mut from) = (0_usize, 0);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            c if depth == 0 && (c == separator || (separator == ' ' && c.is_whitespace())) => {
                parts.push(text[from..at].trim());
                from = at + c.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(text[from..].trim());
    parts.retain(|part| !part.is_empty());
    parts
}

fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e-3),
        None => (text.strip_suffix('s')?, 1.0),
    };
    number.parse::<f64>().ok().filter(|n| n.is_finite()).map(|n| n * unit)
}

fn count(text: &str) -> Option<f64> {
    match text {
        "infinite" => Some(f64::INFINITY),
        _ => text.parse().ok().filter(|&n: &f64| n >= 0.0 && n.is_finite()),
    }
}

fn direction(text: &str) -> Option<Direction> {
    Some(match text {
        "normal" => Direction::Normal,
        "reverse" => Direction::Reverse,
        "alternate" => Direction::Alternate,
        "alternate-reverse" => Direction::AlternateReverse,
        _ => return None,
    })
}
