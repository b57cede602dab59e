//! Takes an animated SVG, makes the document that is seen at any time: attributes and properties have
//! the values which SMIL and CSS animations give them, and nothing moves any more. The parser and the
//! renderer know nothing of time.
//!
//! | module | takes → makes |
//! |---|---|
//! | `clock` | `1.5s`, `a.end+2s` → seconds, conditions |
//! | `intervals` | when animations begin and end, by the clock and by each other → intervals |
//! | `easing` | share of a time → share of the way |
//! | `value` | text → numbers, colours, paths, and what lies between them |
//! | `function` | `values`, `from`, `to`, `by`, `keyTimes` … → the value at a share of the duration |
//! | `motion` | `animateMotion` → a transform |
//! | `transforms` | two CSS transform lists → the matrix between them |
//! | `run` | `animation-…` of an element → where in its keyframes it is |
//! | `individual` | `translate`, `rotate`, `scale` of an element → part of its transform |
//! | `cascade` | style sheets → the value a property has before it moves |
//! | `smil`, `css` | all that moves → values at a time |
//! | `document` | the drawing and values → the document |
//! | `parts` | the drawing and values → the scene, of which only what moves is parsed anew |

mod cascade;
mod clock;
mod css;
mod document;
mod easing;
mod function;
mod individual;
mod intervals;
mod motion;
mod parts;
mod run;
mod smil;
mod transforms;
mod value;

#[cfg(test)]
mod tests;

use super::split::Split;
use crate::scene::load;
use crate::{Error, Options};
use cascade::Cascade;
use css::Css;
use document::{Element, Name, Template, Values};
use intervals::{Schedule, Timed};
use smil::{href, Smil};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, OnceLock};
use usvg::roxmltree::Document;

/// A drawing that moves.
#[derive(Debug)]
pub struct Timeline {
    template: Template,
    smil: Smil,
    css: Css,
    /// The intervals as far as they were asked for.
    schedule: Mutex<Arc<Schedule>>,
    length: Length,
    unevaluated: Unevaluated,
    /// The template in pieces, if it can be cut.
    split: OnceLock<Option<Split>>,
}

/// How long a drawing moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// When the last change is over, in seconds. If some of it repeats for ever: the shortest time
    /// after which all of it does so together (at most [`Length::LONGEST_PERIOD`]; else the longest
    /// period), as often as it takes for the rest to be over.
    pub seconds: f64,
    /// Some of it repeats for ever.
    pub repeats: bool,
    /// What is seen at the end stays, so that the end itself is worth a frame.
    pub stays: bool,
}

impl Length {
    /// Periods that have no common multiple up to this have none that is of use, in seconds.
    pub const LONGEST_PERIOD: f64 = 60.0;

    /// How many frames show all of it, the first of them at time 0.
    pub fn frames(&self, fps: f64) -> u64 {
        const ROUNDING: f64 = 1e-6;
        let frames = self.seconds * fps;
        let count = if self.stays && !self.repeats {
            (frames + ROUNDING).floor() + 1.0
        } else {
            (frames - ROUNDING).ceil()
        };
        count.clamp(1.0, u64::MAX as f64) as u64
    }
}

/// What is not evaluated, and how often.
#[derive(Debug, Default)]
struct Unevaluated(BTreeMap<String, usize>);

impl Unevaluated {
    fn add(&mut self, what: String) {
        *self.0.entry(what).or_default() += 1;
    }
}

/// Time up to which intervals are looked at to find the length, in seconds.
const SEARCHED: f64 = 120.0;

impl Timeline {
    /// Reads an SVG or svgz.
    ///
    /// # Errors
    /// As [`load::tree_from_bytes`], but for what only shows when the drawing is built.
    pub fn read(bytes: &[u8], options: &Options) -> Result<Timeline, Error> {
        let text = load::text(bytes, &options.limits)?;
        let xml = load::parse_xml(&text)?;
        let injected = options.usvg.style_sheet.as_deref();
        let cascade = Cascade::new(&xml, injected)?;
        let mut unevaluated = Unevaluated::default();
        for script in xml.descendants().filter(|node| ["script", "discard"].contains(&node.tag_name().name()))
        {
            unevaluated.add(format!("<{}>", script.tag_name().name()));
        }
        let smil = Smil::read(&xml, &cascade, &mut unevaluated);
        let mut css = Css::read(&xml, &cascade, injected, &mut unevaluated);
        if smil.places().next().is_none() && css.places().next().is_none() {
            css.forget_rest();
        }
        measure_boxes(&mut css, &xml, options);
        let animated: BTreeSet<(Element, Name)> = smil.places().cloned().chain(css.all_places()).collect();
        let schedule = Schedule::new(&smil.timed, SEARCHED);
        if schedule.cut {
            unevaluated.add("animations that begin each other without end".to_string());
        }
        let length = length(&smil, &css, &schedule);
        let schedule = Mutex::new(Arc::new(schedule));
        let template = Template::new(&xml, &animated);
        Ok(Timeline { template, smil, css, schedule, length, unevaluated, split: OnceLock::new() })
    }

    /// The document that is seen `seconds` after the start, as SVG text.
    pub fn document_at(&self, seconds: f64) -> String {
        let mut values = Values::new();
        self.values_at(seconds, &mut values);
        self.template.filled(&values)
    }

    fn values_at(&self, seconds: f64, values: &mut Values) {
        self.css.values_at_rest(values);
        self.smil.values(&self.schedule(seconds), seconds, values);
        self.css.values(seconds, values);
    }

    /// How long it moves.
    pub fn length(&self) -> Length {
        self.length
    }

    /// Whether anything moves.
    pub fn is_animated(&self) -> bool {
        self.smil.places().next().is_some() || self.css.places().next().is_some()
    }

    /// What moves: each attribute or property, and of how many elements.
    pub fn moving(&self) -> BTreeMap<String, usize> {
        let places: BTreeSet<(Element, Name)> =
            self.smil.places().cloned().chain(self.css.places()).collect();
        let mut moving = BTreeMap::new();
        for (_, Name::Attribute(name) | Name::Property(name)) in places {
            *moving.entry(name).or_default() += 1;
        }
        moving
    }

    /// What of the animation is not evaluated, in words; `None` if all is.
    pub fn not_evaluated(&self) -> Option<String> {
        let Unevaluated(list) = &self.unevaluated;
        let words = list.iter().map(|(what, &count)| match count {
            1 => what.clone(),
            _ => format!("{what} ({count} times)"),
        });
        (!list.is_empty()).then(|| words.collect::<Vec<_>>().join(", "))
    }

    /// The intervals up to `seconds`, at least.
    fn schedule(&self, seconds: f64) -> Arc<Schedule> {
        let mut schedule = self.schedule.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if seconds > schedule.horizon && !schedule.cut {
            *schedule = Arc::new(Schedule::new(&self.smil.timed, 2.0 * seconds));
        }
        schedule.clone()
    }
}

/// Tells CSS transforms the boxes of their elements, at rest.
fn measure_boxes(css: &mut Css, xml: &Document, options: &Options) {
    let id = |node: Element| format!("toon-box-{}", node);
    let nodes: BTreeSet<Element> = css.boxes().map(|(node, _)| node).collect();
    if nodes.is_empty() {
        return;
    }
    let name = Name::Attribute("id".to_string());
    let named = nodes.iter().map(|&node| (node, name.clone())).collect();
    let values = nodes.iter().map(|&node| (node, BTreeMap::from([(name.clone(), id(node))]))).collect();
    let document = Template::new(xml, &named).filled(&values);
    let Ok(tree) = load::tree_from_bytes(document.as_bytes(), options) else { return };
    for (node, frame) in css.boxes() {
        if let Some(found) = tree.node_by_id(&id(node)) {
            let bounds = found.bounding_box();
            frame.set_box([bounds.x(), bounds.y(), bounds.width(), bounds.height()].map(f64::from));
        }
    }
}

fn length(smil: &Smil, css: &Css, schedule: &Schedule) -> Length {
    let mut over = 0.0_f64;
    let mut periods = Vec::new();
    let mut staying = 0.0_f64;
    let endless = endless(&smil.timed);
    for (number, timed) in smil.timed.iter().enumerate() {
        let intervals = &schedule.intervals[number];
        if endless[number] {
            if let Some(period) = period(intervals, schedule.horizon) {
                periods.push(period);
                continue;
            }
        }
        for interval in intervals {
            over = over.max(interval.begin);
            if interval.end.is_finite() {
                over = over.max(interval.end);
                if smil.freezes(number) {
                    staying = staying.max(interval.end);
                }
            } else if let Some(simple) = timed.simple {
                periods.push(simple);
            } else {
                staying = staying.max(interval.begin);
            }
        }
    }
    for (end, period) in css.ends() {
        over = over.max(end);
        periods.extend(period.filter(|&p| p > 0.0));
    }
    let Some(period) = common(&periods) else {
        return Length { seconds: over, repeats: false, stays: staying >= over };
    };
    let rounds = (over / period - 1e-6).ceil().max(1.0);
    Length { seconds: period * rounds, repeats: true, stays: false }
}

/// Which animations wait, however indirectly, for some that wait for each other in a circle.
fn endless(all: &[Timed]) -> Vec<bool> {
    let mut waits_for: Vec<usize> = all.iter().map(|timed| timed.begin_syncs.len()).collect();
    let mut dependents = vec![Vec::new(); all.len()];
    for (number, timed) in all.iter().enumerate() {
        timed.begin_syncs.iter().for_each(|sync| dependents[sync.other].push(number));
    }
    // Whoever waits for nobody left is settled; what is never settled is in a circle or behind one.
    let mut settled: Vec<usize> = (0..all.len()).filter(|&number| waits_for[number] == 0).collect();
    let mut endless = vec![true; all.len()];
    while let Some(number) = settled.pop() {
        endless[number] = false;
        for &dependent in &dependents[number] {
            waits_for[dependent] -= 1;
            if waits_for[dependent] == 0 {
                settled.push(dependent);
            }
        }
    }
    endless
}

/// The time between the last two beginnings, if there is another to come beyond the horizon.
fn period(intervals: &[intervals::Interval], horizon: f64) -> Option<f64> {
    let [.., before, last] = intervals else { return None };
    let period = last.begin - before.begin;
    (period > 0.0 && last.begin + 1.5 * period >= horizon).then_some(period)
}

/// The least common multiple, to a tenth of a millisecond.
fn common(periods: &[f64]) -> Option<f64> {
    const TICKS: f64 = 1e4;
    let longest = periods.iter().copied().fold(0.0, f64::max);
    let mut whole = 1_u64;
    for period in periods {
        let ticks = (period * TICKS).round().max(1.0) as u64;
        whole = whole / gcd(whole, ticks) * ticks;
        if whole as f64 > Length::LONGEST_PERIOD * TICKS {
            return Some(longest);
        }
    }
    (longest > 0.0).then_some(whole as f64 / TICKS)
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 {
        a
    } else {
        gcd(b, a % b)
    }
}
