//! Takes the XML of a drawing, finds what the parser would not survive: links in a circle, which are
//! to be cut, and links which multiply (a `use` of two `use`s of two `use`s …), which are refused.
//!
//! Promises: linear time and memory in the document and its links, and no recursion.

use super::links::{index, Finder, Link, Place};
use super::{arcs, unread, Limits};
use crate::scene::Warning;
use crate::Error;
use usvg::roxmltree::{Document, Node, NodeId};

/// The parser may look at its elements so many times for each that it may make.
const VISITS: u64 = 16;

/// What the loader must know before it parses.
#[derive(Debug)]
pub(super) struct Census {
    /// Whether there is a text element.
    pub(super) has_text: bool,
    /// Deepest nesting, links followed.
    pub(super) depth: usize,
    /// Links which close a circle.
    pub(super) circles: Vec<Place>,
    /// What the parser leaves out without a word.
    pub(super) unread: Vec<Warning>,
}

/// Counts, and refuses what is too much.
///
/// # Errors
/// [`Error::Limit`] for more elements than allowed, [`Error::Parse`] for a circle which no attribute
/// closes.
pub(super) fn check(xml: &Document, style_sheet: Option<&str>, limits: &Limits) -> Result<Census, Error> {
    arcs::check(xml)?;
    let finder = Finder::new(xml, style_sheet)?;
    let links = finder.links(xml);
    let has_text = xml.descendants().any(|n| n.is_element() && n.tag_name().name() == "text");
    let from_gradient = |link: &&Link| xml.get_node(NodeId::from(link.from as u32)).is_some_and(is_gradient);
    let mut gradients: Vec<_> = links.iter().filter(from_gradient).map(|link| (link.to, link.from)).collect();
    gradients.sort_unstable();
    let marks = vec![Mark::default(); xml.descendants().count()];
    let mut walk = Walk { links: &links, gradients, marks };
    let circles = walk.from(xml)?;
    let root = walk.marks[index(xml.root().id())];
    if root.elements > limits.elements || root.visits > limits.elements.saturating_mul(VISITS) {
        return Err(Error::Limit(format!(
            "it repeats its elements (use, marker, pattern, mask) too often: more than {} of them",
            limits.elements
        )));
    }
    Ok(Census { has_text, depth: root.depth, circles, unread: unread::find(xml, &finder) })
}

/// `text` with these links cut.
pub(super) fn cut(text: &str, circles: &[Place]) -> String {
    let mut places: Vec<&Place> = circles.iter().collect();
    places.sort_by_key(|place| place.bytes.start);
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for place in places {
        // Two links in one attribute may have been found at the same place.
        if place.bytes.start >= at {
            out.push_str(&text[at..place.bytes.start]);
            out.push_str(place.instead);
            at = place.bytes.end;
        }
    }
    out.push_str(&text[at..]);
    out
}

/// What is known of a node and all that it draws.
#[derive(Clone, Copy, Default)]
struct Mark {
    state: State,
    /// Elements that the parser will make, itself among them.
    elements: u64,
    /// Elements that it will look at: as `elements`, but with what is made once and shared counted
    /// wherever it is used.
    visits: u64,
    depth: usize,
}

#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum State {
    #[default]
    New,
    /// The walk is inside it: a link to it closes a circle.
    Open,
    Done,
}

/// A walk through the document and along its links, depth first, each node once.
struct Walk<'l> {
    links: &'l [Link],
    /// Links from gradients: to and from, sorted.
    gradients: Vec<(usize, usize)>,
    marks: Vec<Mark>,
}

/// A node the walk is inside of.
struct Step<'d, 'l> {
    node: Node<'d, 'd>,
    next_child: Option<Node<'d, 'd>>,
    next_link: usize,
    /// The link by which the walk came; `None` if it came from the parent.
    by: Option<&'l Link>,
}

impl<'l> Walk<'l> {
    /// The links which close circles.
    fn from(&mut self, xml: &Document) -> Result<Vec<Place>, Error> {
        let mut circles = Vec::new();
        let mut steps = vec![self.enter(xml.root(), None)];
        while let Some(step) = steps.last_mut() {
            let at = index(step.node.id());
            let (node, by) = if let Some(child) = step.next_child {
                step.next_child = child.next_sibling();
                (child, None)
            } else if let Some(link) = self.links.get(step.next_link).filter(|link| link.from == at) {
                step.next_link += 1;
                let Some(target) = xml.get_node(NodeId::from(link.to as u32)) else { continue };
                (target, Some(link))
            } else {
                let by = step.by;
                self.marks[at].state = State::Done;
                steps.pop();
                if let Some(outer) = steps.last() {
                    self.add(index(outer.node.id()), at, by);
                }
                continue;
            };
            match self.marks[index(node.id())].state {
                State::New => steps.push(self.enter(node, by)),
                State::Done => self.add(at, index(node.id()), by),
                State::Open => circles.extend(self.link_on_circle(&steps, node, by)?),
            }
        }
        Ok(circles)
    }

    fn enter<'d>(&mut self, node: Node<'d, 'd>, by: Option<&'l Link>) -> Step<'d, 'l> {
        let at = index(node.id());
        self.marks[at] = Mark { state: State::Open, elements: 1, visits: 1, depth: 1 };
        let next_link = self.links.partition_point(|link| link.from < at);
        Step { node, next_child: node.first_child(), next_link, by }
    }

    /// `outer` draws `inner`, as its child or by a link.
    fn add(&mut self, outer: usize, inner: usize, by: Option<&Link>) {
        let times = by.map_or(1, |link| link.times);
        let inner = self.marks[inner];
        let outer = &mut self.marks[outer];
        outer.elements = outer.elements.saturating_add(inner.elements.saturating_mul(times));
        outer.visits = outer.visits.saturating_add(inner.visits.saturating_mul(times.max(1)));
        outer.depth = outer.depth.max(inner.depth + 1);
    }

    /// The link to cut on the circle from the open `node` through the steps back to it: one with a place in
    /// the text, and the last, but a property rather than a `use`, whose element is drawn elsewhere as well.
    /// `None` if the circle can be left to the parser.
    fn link_on_circle(
        &self,
        steps: &[Step],
        node: Node,
        closing: Option<&Link>,
    ) -> Result<Option<Place>, Error> {
        let first = steps.iter().rposition(|step| step.node == node).unwrap_or(0);
        let circle = &steps[first..];
        if self.is_followed_to_its_start(circle) {
            return Ok(None);
        }
        let links = || std::iter::once(closing).chain(circle[1..].iter().rev().map(|step| step.by));
        let by_property =
            links().zip(circle.iter().rev()).filter(|(_, from)| from.node.tag_name().name() != "use");
        let places = by_property.map(|(link, _)| link).chain(links()).flatten();
        if let Some(place) = places.into_iter().find_map(|link| link.place.clone()) {
            return Ok(Some(place));
        }
        let inside = || circle[1..].iter();
        let is_marker = |node: &Node| node.tag_name().name() == "marker";
        if is_marker(&node) && inside().filter(|step| step.by.is_some()).all(|step| is_marker(&step.node)) {
            return Ok(None);
        }
        let tag = node.tag_name().name();
        let id = node.attribute("id").map(|id| format!(" '{id}'")).unwrap_or_default();
        Err(Error::Parse(format!(
            "the <{tag}>{id} is drawn with itself, by a style sheet or by what it inherits (give its shapes a paint of their own)"
        )))
    }

    /// Is this a circle of gradients whose stops the parser looks for from one of them on? There it stops
    /// where it began; from a gradient outside it would never.
    fn is_followed_to_its_start(&self, circle: &[Step]) -> bool {
        let before = circle.iter().cycle().skip(circle.len() - 1);
        circle.iter().zip(before).all(|(step, before)| {
            let (at, before) = (index(step.node.id()), index(before.node.id()));
            let first = self.gradients.partition_point(|&(to, _)| to < at);
            let leading_here = self.gradients[first..].iter().take_while(|&&(to, _)| to == at);
            is_gradient(step.node) && leading_here.into_iter().all(|&(_, from)| from == before)
        })
    }
}

fn is_gradient(node: Node) -> bool {
    node.tag_name().name().ends_with("Gradient")
}
