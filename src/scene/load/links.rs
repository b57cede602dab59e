//! Takes the XML of a drawing, makes its links: which element draws which other one, by `href` or
//! `url(#…)`, in an attribute or in a style sheet.
//!
//! Only links that make the parser go through the other element are kept.

use super::selectors;
use crate::Error;
use simplecss::{DeclarationTokenizer, StyleSheet};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use usvg::roxmltree::{Attribute, Document, Node, NodeId};

/// Properties whose value may be `url(#…)`.
const LINKING: &[&str] =
    &["clip-path", "mask", "filter", "fill", "stroke", "marker", "marker-start", "marker-mid", "marker-end"];
/// Those of them which an element without its own takes from its parents.
const INHERITED: &[&str] = &["fill", "stroke", "marker", "marker-start", "marker-mid", "marker-end"];
/// Elements whose `href` brings another element in.
const FOLLOWING: &[&str] =
    &["use", "pattern", "linearGradient", "radialGradient", "filter", "feImage", "mask", "clipPath", "tref"];
/// Elements which are drawn where something links to them, with what they inherit at home.
const DRAWN_ELSEWHERE: &[&str] = &["pattern", "mask", "clipPath", "marker", "filter"];
const SHAPES: &[&str] =
    &["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "use", "image"];
/// Bytes of path data that can make a vertex, at least.
const BYTES_PER_VERTEX: u64 = 2;

/// One element makes the parser go through another.
#[derive(Clone, Debug)]
pub(super) struct Link {
    /// Index of the element that has the link, in document order over all nodes.
    pub(super) from: usize,
    pub(super) to: usize,
    /// How many times the parser goes through it.
    pub(super) times: u64,
    /// Where the link stands in the text; `None` if it stands in a style sheet or is inherited.
    pub(super) place: Option<Place>,
}

/// Bytes of the text, and what to put in their place to cut the link.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) bytes: Range<usize>,
    pub(super) instead: &'static str,
}

pub(super) fn index(id: NodeId) -> usize {
    id.get_usize()
}

/// What elements are called and what style sheets say of them.
pub(super) struct Finder<'a> {
    /// The parser takes the first element of an id for `href`, the last for `url(#…)`.
    first: HashMap<&'a str, Node<'a, 'a>>,
    last: HashMap<&'a str, Node<'a, 'a>>,
    styles: StyleSheet<'a>,
    /// The properties that these speak of.
    styled: HashSet<&'a str>,
    styles_link: bool,
    text: &'a str,
    /// For each node: elements below it with itself, and vertices of the paths among them.
    sizes: Vec<(u64, u64)>,
}

impl<'a> Finder<'a> {
    /// # Errors
    /// Those of [`selectors::check`].
    pub fn new(xml: &'a Document<'a>, injected: Option<&'a str>) -> Result<Finder<'a>, Error> {
        let mut first = HashMap::new();
        let mut last = HashMap::new();
        for node in xml.descendants() {
            if let Some(id) = node.attribute("id") {
                first.entry(id).or_insert(node);
                last.insert(id, node);
            }
        }
        let mut styles = StyleSheet::new();
        styles.parse_more(injected.unwrap_or_default());
        for node in xml.descendants().filter(|n| n.tag_name().name() == "style") {
            styles.parse_more(node.text().unwrap_or_default());
        }
        selectors::check(xml, &styles)?;
        let declarations = || styles.rules.iter().flat_map(|rule| &rule.declarations);
        let styles_link = declarations().any(|d| d.value.contains("url("));
        let styled = declarations().map(|d| d.name).collect();
        Ok(Finder { first, last, styles, styled, styles_link, text: xml.input_text(), sizes: sizes(xml) })
    }

    /// All links, sorted by the element that has them.
    pub fn links(&self, xml: &'a Document<'a>) -> Vec<Link> {
        let mut links = Vec::new();
        for node in xml.descendants().filter(Node::is_element) {
            self.links_of(node, &mut links);
        }
        // Already in order but for what is inherited; stable, so that a run is deterministic.
        links.sort_by_key(|link| link.from);
        links
    }

    /// The element that `url(#…)` finds.
    pub fn target(&self, id: &str) -> Option<Node<'a, 'a>> {
        self.last.get(id).copied()
    }

    fn links_of(&self, node: Node<'a, 'a>, links: &mut Vec<Link>) {
        let tag = node.tag_name().name();
        for attribute in node.attributes() {
            match attribute.name() {
                "href" if FOLLOWING.contains(&tag) => self.href(node, &attribute, links),
                "style" => {
                    for declaration in DeclarationTokenizer::from(attribute.value()) {
                        let place = |id: &str| Some(self.url_in(&attribute, id));
                        self.declared(node, declaration.name, declaration.value, &place, links);
                    }
                }
                name => {
                    let place = |_: &str| Some(Place { bytes: attribute.range_value(), instead: "none" });
                    self.declared(node, name, attribute.value(), &place, links);
                }
            }
        }
        if self.styles_link {
            for declaration in self.declarations(node) {
                self.declared(node, declaration.name, declaration.value, &|_| None, links);
            }
        }
        if DRAWN_ELSEWHERE.contains(&tag) {
            self.inherited(node, links);
        }
    }

    fn href(&self, node: Node, attribute: &Attribute, links: &mut Vec<Link>) {
        let Some(target) = attribute.value().trim().strip_prefix('#').and_then(|id| self.first.get(id))
        else {
            return;
        };
        let times = u64::from(!target.tag_name().name().ends_with("Gradient"));
        let place = Some(Place { bytes: attribute.range_value(), instead: "" });
        links.push(Link { from: index(node.id()), to: index(target.id()), times, place });
    }

    /// Adds the link of one property, if it has one.
    fn declared(
        &self,
        node: Node,
        name: &str,
        value: &str,
        place: &dyn Fn(&str) -> Option<Place>,
        links: &mut Vec<Link>,
    ) {
        if !LINKING.contains(&name) || !value.contains("url(") {
            return;
        }
        for id in urls(value) {
            let Some(&target) = self.last.get(id) else { continue };
            let times = self.times(node, name, target);
            links.push(Link { from: index(node.id()), to: index(target.id()), times, place: place(id) });
        }
    }

    /// How often the parser goes through `target` for this property of `node`.
    fn times(&self, node: Node, name: &str, target: Node) -> u64 {
        let (elements, vertices) = self.sizes[index(node.id())];
        let user = |attribute: &str, default: bool| match target.attribute(attribute) {
            Some("userSpaceOnUse") => true,
            Some(_) => false,
            None => default,
        };
        // What is in user space is parsed once and shared.
        let shared = match target.tag_name().name() {
            "clipPath" => user("clipPathUnits", true),
            "mask" => user("maskUnits", false) && user("maskContentUnits", true),
            "pattern" => user("patternUnits", false) && user("patternContentUnits", true),
            "filter" => user("filterUnits", false) && user("primitiveUnits", true),
            "linearGradient" | "radialGradient" => true,
            _ => false,
        };
        match name {
            _ if shared => 0,
            "marker" | "marker-mid" => vertices,
            _ if INHERITED.contains(&name) => elements,
            _ => 1,
        }
    }

    /// A pattern inside a group which is filled with it passes that fill on to its own shapes, unless
    /// they have another.
    fn inherited(&self, home: Node<'a, 'a>, links: &mut Vec<Link>) {
        for &name in INHERITED {
            let Some(value) = home.ancestors().skip(1).find_map(|n| self.value(n, name)) else { continue };
            if !value.contains("url(") || self.value(home, name).is_some() || !self.passes_on(home, name) {
                continue;
            }
            for target in urls(value).filter_map(|id| self.last.get(id)) {
                let times = self.times(home, name, *target);
                links.push(Link { from: index(home.id()), to: index(target.id()), times, place: None });
            }
        }
    }

    /// Whether a shape below `home` has no value of its own for this property.
    fn passes_on(&self, home: Node<'a, 'a>, name: &str) -> bool {
        home.descendants()
            .filter(|n| SHAPES.contains(&n.tag_name().name()))
            .any(|shape| shape.ancestors().take_while(|n| *n != home).all(|n| self.value(n, name).is_none()))
    }

    /// The value that this element itself gives to a property.
    pub fn value(&self, node: Node<'a, 'a>, name: &str) -> Option<&'a str> {
        let in_style = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default())
            .filter(|d| d.name == name)
            .map(|d| d.value)
            .last();
        let in_sheet = || {
            let own = self.declarations(node).filter(|d| d.name == name).map(|d| d.value);
            if self.styled.contains(name) {
                own.last()
            } else {
                None
            }
        };
        in_style.or_else(in_sheet).or_else(|| node.attribute(name)).filter(|value| *value != "inherit")
    }

    fn declarations<'s>(
        &'s self,
        node: Node<'a, 'a>,
    ) -> impl Iterator<Item = &'s simplecss::Declaration<'a>> {
        let rules = self.styles.rules.iter().filter(move |rule| rule.selector.matches(&Styled(node)));
        rules.flat_map(|rule| &rule.declarations)
    }

    /// Where `url(#id)` stands in the text of a style attribute; all of it, if it is not found
    /// because it came from an entity.
    fn url_in(&self, attribute: &Attribute, id: &str) -> Place {
        let value = attribute.range_value();
        let text = &self.text[value.clone()];
        let found = text.match_indices("url(").find_map(|(start, _)| {
            let end = start + text[start..].find(')')? + 1;
            text[start..end].contains(id).then_some(value.start + start..value.start + end)
        });
        match found {
            Some(bytes) => Place { bytes, instead: "none" },
            None => Place { bytes: value, instead: "" },
        }
    }
}

/// The ids in `url(#id)`, `url('#id')` and `url("#id")`.
pub(super) fn urls(value: &str) -> impl Iterator<Item = &str> {
    value.split("url(").skip(1).filter_map(|rest| {
        let inside = rest.split(')').next()?;
        inside.trim().trim_matches(['\'', '"']).trim().strip_prefix('#')
    })
}

fn sizes(xml: &Document) -> Vec<(u64, u64)> {
    let mut sizes = Vec::new();
    for node in xml.descendants() {
        let data = node.attribute("d").or(node.attribute("points")).map_or(4, str::len) as u64;
        sizes.push(if node.is_element() { (1, data / BYTES_PER_VERTEX + 1) } else { (0, 0) });
    }
    // Children come after their parents: backwards, each is whole when it is added to its parent.
    let parents: Vec<Option<usize>> = xml.descendants().map(|n| n.parent().map(|p| index(p.id()))).collect();
    for child in (0..sizes.len()).rev() {
        if let Some(parent) = parents[child] {
            let (elements, vertices) = sizes[child];
            sizes[parent].0 += elements;
            sizes[parent].1 += vertices;
        }
    }
    sizes
}

/// An element as style sheets see it.
pub(crate) struct Styled<'a>(pub(crate) Node<'a, 'a>);

impl simplecss::Element for Styled<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: simplecss::AttributeOperator) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: simplecss::PseudoClass) -> bool {
        matches!(class, simplecss::PseudoClass::FirstChild) && self.prev_sibling_element().is_none()
    }
}
