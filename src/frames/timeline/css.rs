//! Takes style sheets with `@keyframes` and `animation-…`, makes the values of properties at a time.
//! After CSS Animations 1 and, for how values mix, CSS Transforms 1 and CSS Values 3.

use super::cascade::{is_property, style_texts, Cascade};
use super::document::{element, Element, Name, Values};
use super::easing::Easing;
use super::individual::{self, Individual};
use super::run::{runs, shorthand, Direction, Run};
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
    /// Transforms that style sheets give and nothing moves: the parser knows no units in them.
    rest: Vec<Track>,
    individual: Vec<Individual>,
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
            conditions(text, unevaluated);
        }
        let mut css = Css::default();
        for node in xml.descendants().filter(Node::is_element) {
            let declarations = cascade.declarations(node);
            for run in runs(&declarations) {
                if let Some(blocks) = keyframes.get(&run.name) {
                    css.add(node, run, blocks, cascade, unevaluated);
                }
            }
            let mut has_individual = false;
            for (name, value) in &declarations {
                match (*name, *value) {
                    ("transform", value) => css.rest.push(Track::at_rest(node, value, cascade)),
                    ("translate" | "rotate" | "scale", _) => has_individual = true,
                    ("animation-composition", "add" | "accumulate") | ("animation-timeline", _) => {
                        unevaluated.add(format!("{name}: {value}"));
                    }
                    _ => {}
                }
            }
            let moves = |track: &Track| track.node == element(node) && track.is_individual();
            if has_individual || css.tracks.iter().rev().any(moves) {
                css.individual.push(Individual::of(node, cascade));
            }
        }
        css
    }

    /// Forgets what does not move, where nothing else does either.
    pub(super) fn forget_rest(&mut self) {
        self.rest.clear();
        self.individual.clear();
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
                name if is_property(name) || is_transform(name) => Name::Property(name.to_string()),
                "d" | "x" | "y" | "cx" | "cy" | "r" | "rx" | "ry" | "width" | "height" => {
                    Name::Attribute(name.to_string())
                }
                name => {
                    unevaluated.add(format!("the property {name} in @keyframes"));
                    continue;
                }
            };
            let frame = if is_transform(name) { Frame::of(node, cascade) } else { Frame::default() };
            let base = match individual::NAMES.contains(&name) {
                true => cascade.declared(node, name).unwrap_or_default().to_string(),
                false => cascade.value(node, name),
            };
            self.tracks.push(Track {
                node: element(node),
                name: place,
                run: run.clone(),
                stops: stops(name, blocks),
                current: cascade.current_color(node),
                base,
                frame,
            });
        }
    }

    /// What is changed at all.
    pub(super) fn places(&self) -> impl Iterator<Item = (Element, Name)> + '_ {
        self.tracks.iter().map(|track| (track.node, track.name.clone()))
    }

    /// What is set, whether it changes or not.
    pub(super) fn all_places(&self) -> impl Iterator<Item = (Element, Name)> + '_ {
        let whole = self.individual.iter().map(|i| (i.node, Name::Property("transform".to_string())));
        self.tracks.iter().chain(&self.rest).map(|track| (track.node, track.name.clone())).chain(whole)
    }

    /// The elements whose boxes transforms refer to, and what is to be told about them.
    pub(super) fn boxes(&mut self) -> impl Iterator<Item = (Element, &mut Frame)> {
        let tracks = self.tracks.iter_mut().chain(&mut self.rest);
        let tracks = tracks.map(|track| (track.node, &mut track.frame));
        let individual = self.individual.iter_mut().map(|i| (i.node, &mut i.frame));
        tracks.chain(individual).filter(|(_, frame)| frame.needs_box())
    }

    /// Puts what does not move where SMIL and keyframes may go over it.
    pub(super) fn values_at_rest(&self, values: &mut Values) {
        put(&self.rest, 0.0, values);
    }

    /// Puts the values at `time` over those of SMIL.
    pub(super) fn values(&self, time: f64, values: &mut Values) {
        put(&self.tracks, time, values);
        self.individual.iter().for_each(|individual| individual.compose(values));
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

fn put(tracks: &[Track], time: f64, values: &mut Values) {
    for track in tracks {
        let Some(share) = track.run.share(time) else { continue };
        let below = values.get(&track.node).and_then(|of| track.name.in_any_way(of)).unwrap_or(&track.base);
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

/// Whether a property's lengths refer to a box.
fn is_transform(name: &str) -> bool {
    name == "transform" || individual::NAMES.contains(&name)
}

impl Track {
    /// Whether it is `translate`, `rotate` or `scale`.
    fn is_individual(&self) -> bool {
        matches!(&self.name, Name::Property(name) if individual::NAMES.contains(&name.as_str()))
    }

    /// The transform of an element as it stands.
    fn at_rest<'a>(node: Node<'a, 'a>, transform: &str, cascade: &Cascade<'a>) -> Track {
        let stop = |at| Stop { at, value: Some(transform.to_string()), easing: None };
        Track {
            node: element(node),
            name: Name::Property("transform".to_string()),
            run: Run { before: true, after: true, paused: true, ..shorthand("") },
            stops: vec![stop(0.0), stop(1.0)],
            current: String::new(),
            base: String::new(),
            frame: Frame::of(node, cascade),
        }
    }

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
        if self.is_individual() {
            let function = |value: &str| individual::as_function(name, value);
            return transforms::mix(&function(from), &function(to), way, &self.frame);
        }
        let parse = |text: &str| Value::parse(name, unwrap_path(name, text), Some(&self.current));
        let (a, b) = (parse(from), parse(to));
        match a.mix_as_css(&b, way) {
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

/// Names the conditions under which there would be animations: none of them is taken as given, as in the
/// parser. Whoever asks for less motion is not meant.
fn conditions(css: &str, unevaluated: &mut Unevaluated) {
    let css = &without_comments(css);
    for (at, _) in css.match_indices("@media").chain(css.match_indices("@supports")) {
        let Some((condition, inside)) = css[at..].split_once('{') else { return };
        let mut depth = 1_usize;
        let end = inside.find(|c| {
            depth = match c {
                '{' => depth + 1,
                '}' => depth - 1,
                _ => depth,
            };
            depth == 0
        });
        let inside = &inside[..end.unwrap_or(inside.len())];
        if inside.contains("animation") && !condition.replace(' ', "").contains("reduced-motion:reduce") {
            unevaluated.add(format!("animations under {}", condition.trim()));
        }
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
