//! Takes the XML of a drawing, makes its template: the same drawing in one spelling, with a hole in
//! the start tag of each animated element. Filled with values, it is the document at one time.
//!
//! Promises: what is animated is not in the text around the holes, so values are set in one place;
//! animation elements are empty (they still count as siblings); elements and attributes of other
//! namespaces say nothing; no recursion.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::ops::Range;
use usvg::roxmltree::{Document, Node};

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";
const XML: &str = "http://www.w3.org/XML/1998/namespace";

/// Elements that tell how others move.
pub(super) const ANIMATION_ELEMENTS: &[&str] =
    &["animate", "set", "animateTransform", "animateMotion", "animateColor"];

/// Number of an element, over all nodes in document order.
pub(super) type Element = usize;

pub(super) fn element(node: Node) -> Element {
    node.id().get_usize()
}

/// A place in the document whose value changes, without namespace: `href` is also `xlink:href`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Name {
    /// An attribute.
    Attribute(String),
    /// A property, set at the end of `style`, where it wins over style sheets.
    Property(String),
}

impl Name {
    /// Its value among `values`, whether it is set as a property or as an attribute.
    pub(super) fn in_any_way<'v>(&self, values: &'v BTreeMap<Name, String>) -> Option<&'v String> {
        let (Name::Attribute(name) | Name::Property(name)) = self;
        let property = values.get(&Name::Property(name.clone()));
        property.or_else(|| values.get(&Name::Attribute(name.clone())))
    }
}

/// A drawing with holes.
#[derive(Debug)]
pub(super) struct Template {
    text: String,
    holes: Vec<Hole>,
}

#[derive(Debug)]
struct Hole {
    /// Where in the text.
    at: usize,
    /// Number of the element whose attributes go there.
    element: Element,
    /// The element's own `style`.
    style: Option<String>,
    /// Its own values of what is animated.
    own: Vec<(String, String)>,
}

/// Values of animated elements at one time.
pub(super) type Values = BTreeMap<Element, BTreeMap<Name, String>>;

impl Template {
    /// `animated` lists the attributes and properties that will be set.
    pub(super) fn new(xml: &Document, animated: &BTreeSet<(Element, Name)>) -> Template {
        let mut template = Template { text: String::new(), holes: Vec::new() };
        let root = xml.root_element();
        let mut node = root;
        loop {
            let goes_in = template.open(node, root, animated);
            if let Some(child) = node.first_child().filter(|_| goes_in) {
                node = child;
                continue;
            }
            if goes_in {
                template.close(node);
            }
            loop {
                if node == root {
                    return template;
                }
                if let Some(next) = node.next_sibling() {
                    node = next;
                    break;
                }
                let Some(parent) = node.parent() else { return template };
                node = parent;
                template.close(node);
            }
        }
    }

    /// The document with these values; an element's own where none is given.
    pub(super) fn filled(&self, values: &Values) -> String {
        let mut out = String::with_capacity(self.text.len() + 64 * self.holes.len());
        self.fill(0..self.text.len(), values, &mut out);
        out
    }

    /// Writes some bytes of the text, and the values in the holes there.
    pub(super) fn fill(&self, bytes: Range<usize>, values: &Values, out: &mut String) {
        let mut from = bytes.start;
        let first = self.holes.partition_point(|hole| hole.at < bytes.start);
        for hole in self.holes[first..].iter().take_while(|hole| hole.at < bytes.end) {
            out.push_str(&self.text[from..hole.at]);
            from = hole.at;
            hole.fill(values.get(&hole.element), out);
        }
        out.push_str(&self.text[from..bytes.end]);
    }

    /// The text without what moves.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Where in it something moves, in order.
    pub(super) fn holes(&self) -> impl Iterator<Item = usize> + '_ {
        self.holes.iter().map(|hole| hole.at)
    }

    /// Writes a node up to its content; whether it has content to be written.
    fn open(&mut self, node: Node, root: Node, animated: &BTreeSet<(Element, Name)>) -> bool {
        if node.is_text() {
            escape(node.text().unwrap_or_default(), &mut self.text);
            return false;
        }
        if !node.is_element() {
            return false;
        }
        let tag = node.tag_name();
        if !matches!(tag.namespace(), None | Some("" | SVG)) {
            self.text.push_str("<metadata/>");
            return false;
        }
        self.text.push('<');
        self.text.push_str(tag.name());
        if ANIMATION_ELEMENTS.contains(&tag.name()) {
            self.text.push_str("/>");
            return false;
        }
        if node == root {
            let _ = write!(self.text, r#" xmlns="{SVG}" xmlns:xlink="{XLINK}""#);
        }
        self.attributes(node, animated);
        self.text.push('>');
        true
    }

    fn attributes(&mut self, node: Node, animated: &BTreeSet<(Element, Name)>) {
        let first = (element(node), Name::Attribute(String::new()));
        let names: Vec<&Name> = animated
            .range(first..)
            .take_while(|(id, _)| *id == element(node))
            .map(|(_, name)| name)
            .collect();
        let moves = |name: &str| names.iter().any(|n| matches!(n, Name::Attribute(a) if a == name));
        let mut own: Vec<(String, String)> = Vec::new();
        for attribute in node.attributes() {
            let prefix = match attribute.namespace() {
                None => "",
                Some(XLINK) => "xlink:",
                Some(XML) => "xml:",
                Some(_) => continue,
            };
            let (name, value) = (attribute.name(), attribute.value());
            if !names.is_empty() && name == "style" && prefix.is_empty() {
                continue;
            }
            if moves(name) {
                // A plain `href` is stronger than one of XLink.
                match own.iter_mut().find(|(other, _)| other == name) {
                    Some(other) if prefix.is_empty() => other.1 = value.to_string(),
                    Some(_) => {}
                    None => own.push((name.to_string(), value.to_string())),
                }
                continue;
            }
            write_attribute(prefix, name, value, &mut self.text);
        }
        if !names.is_empty() {
            let style = node.attribute("style").map(str::to_string);
            self.holes.push(Hole { at: self.text.len(), element: element(node), style, own });
        }
    }

    fn close(&mut self, node: Node) {
        let _ = write!(self.text, "</{}>", node.tag_name().name());
    }
}

impl Hole {
    fn fill(&self, values: Option<&BTreeMap<Name, String>>, out: &mut String) {
        let none = BTreeMap::new();
        let values = values.unwrap_or(&none);
        for (name, value) in &self.own {
            if !values.contains_key(&Name::Attribute(name.clone())) {
                write_attribute("", name, value, out);
            }
        }
        let mut style = self.style.clone().unwrap_or_default();
        for (name, value) in values {
            match name {
                Name::Attribute(name) => write_attribute("", name, value, out),
                Name::Property(name) => {
                    let _ = write!(style, ";{name}:{value}");
                }
            }
        }
        if !style.is_empty() {
            write_attribute("", "style", style.trim_start_matches(';'), out);
        }
    }
}

fn write_attribute(prefix: &str, name: &str, value: &str, out: &mut String) {
    let _ = write!(out, " {prefix}{name}=\"");
    escape(value, out);
    out.push('"');
}

fn escape(text: &str, out: &mut String) {
    let mut from = 0;
    for (at, byte) in text.bytes().enumerate() {
        let instead = match byte {
            b'<' => "&lt;",
            b'>' => "&gt;",
            b'&' => "&amp;",
            b'"' => "&quot;",
            b'\t' => "&#9;",
            b'\n' => "&#10;",
            b'\r' => "&#13;",
            _ => continue,
        };
        out.push_str(&text[from..at]);
        out.push_str(instead);
        from = at + 1;
    }
    out.push_str(&text[from..]);
}
