//! Takes style sheets, `style` and attributes, makes the value that an element has for a property: the
//! cascade in the parser's own order, with inheritance and initial values.

use crate::scene::load::{check_selectors, Styled};
use crate::Error;
use simplecss::{DeclarationTokenizer, StyleSheet};
use usvg::roxmltree::{Document, Node};

/// Properties which an element without its own takes from its parent.
const INHERITED: &[&str] = &[
    "clip-rule",
    "color",
    "color-interpolation",
    "color-interpolation-filters",
    "direction",
    "dominant-baseline",
    "fill",
    "fill-opacity",
    "fill-rule",
    "font-family",
    "font-size",
    "font-size-adjust",
    "font-stretch",
    "font-style",
    "font-variant",
    "font-weight",
    "image-rendering",
    "letter-spacing",
    "marker-end",
    "marker-mid",
    "marker-start",
    "paint-order",
    "shape-rendering",
    "stroke",
    "stroke-dasharray",
    "stroke-dashoffset",
    "stroke-linecap",
    "stroke-linejoin",
    "stroke-miterlimit",
    "stroke-opacity",
    "stroke-width",
    "text-anchor",
    "text-rendering",
    "visibility",
    "word-spacing",
    "writing-mode",
];
/// Properties which are not inherited.
const OWN: &[&str] = &[
    "alignment-baseline",
    "baseline-shift",
    "clip-path",
    "display",
    "filter",
    "flood-color",
    "flood-opacity",
    "isolation",
    "lighting-color",
    "mask",
    "mask-type",
    "mix-blend-mode",
    "opacity",
    "overflow",
    "stop-color",
    "stop-opacity",
    "text-decoration",
    "transform-origin",
    "vector-effect",
];
/// Values where nothing is said, for what may be mixed or added to.
const INITIAL: &[(&str, &str)] = &[
    ("color", "black"),
    ("fill", "black"),
    ("fill-opacity", "1"),
    ("flood-color", "black"),
    ("flood-opacity", "1"),
    ("lighting-color", "white"),
    ("opacity", "1"),
    ("stop-color", "black"),
    ("stop-opacity", "1"),
    ("stroke", "none"),
    ("stroke-dasharray", "none"),
    ("stroke-dashoffset", "0"),
    ("stroke-miterlimit", "4"),
    ("stroke-opacity", "1"),
    ("stroke-width", "1"),
    ("visibility", "visible"),
    ("display", "inline"),
    ("transform", ""),
];

/// Whether the parser takes `name` from style sheets; `transform` is apart.
pub(super) fn is_property(name: &str) -> bool {
    INHERITED.contains(&name) || OWN.contains(&name)
}

/// The style sheets of a drawing.
pub(super) struct Cascade<'a> {
    sheet: StyleSheet<'a>,
}

impl<'a> Cascade<'a> {
    /// `injected` comes before the drawing's own.
    ///
    /// # Errors
    /// Those of [`check_selectors`].
    pub(super) fn new(xml: &'a Document<'a>, injected: Option<&'a str>) -> Result<Cascade<'a>, Error> {
        let mut sheet = StyleSheet::new();
        for text in injected.into_iter().chain(style_texts(xml)) {
            sheet.parse_more(text);
        }
        check_selectors(xml, &sheet)?;
        Ok(Cascade { sheet })
    }

    /// All declarations for an element, the weakest first, but for attributes.
    pub(super) fn declarations(&self, node: Node<'a, 'a>) -> Vec<(&'a str, &'a str)> {
        let rules = self.sheet.rules.iter().filter(|rule| rule.selector.matches(&Styled(node)));
        let sheet = rules.flat_map(|rule| rule.declarations.iter().copied());
        let own = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
        let mut all: Vec<_> = sheet.chain(own).collect();
        all.sort_by_key(|declaration| declaration.important);
        all.into_iter().map(|declaration| (declaration.name, declaration.value)).collect()
    }

    /// What style sheets and `style` say of an element's property.
    pub(super) fn declared(&self, node: Node<'a, 'a>, name: &str) -> Option<&'a str> {
        self.declarations(node).into_iter().rfind(|(other, _)| *other == name).map(|(_, value)| value)
    }

    /// The value of a property or attribute before anything moves.
    pub(super) fn value(&self, node: Node<'a, 'a>, name: &str) -> String {
        let mut at = Some(node);
        while let Some(node) = at {
            let own = match is_property(name) || name == "transform" {
                true => self.declared(node, name).or_else(|| attribute(node, name)),
                false => attribute(node, name),
            };
            match own {
                Some("inherit") => {}
                Some(value) => return value.to_string(),
                None if INHERITED.contains(&name) => {}
                None => break,
            }
            at = node.parent_element();
        }
        INITIAL.iter().find(|(other, _)| *other == name).map_or("", |(_, value)| value).to_string()
    }

    /// What `currentColor` means there.
    pub(super) fn current_color(&self, node: Node<'a, 'a>) -> String {
        self.value(node, "color")
    }
}

/// A plain `href` is stronger than one of XLink.
fn attribute<'a>(node: Node<'a, 'a>, name: &str) -> Option<&'a str> {
    const XLINK: &str = "http://www.w3.org/1999/xlink";
    node.attribute(name).or_else(|| node.attribute((XLINK, name)).filter(|_| name == "href"))
}

/// The text of each `style` element.
pub(super) fn style_texts<'a>(xml: &'a Document<'a>) -> impl Iterator<Item = &'a str> {
    let is_css = |node: &Node| matches!(node.attribute("type"), None | Some("" | "text/css"));
    xml.descendants()
        .filter(move |node| node.tag_name().name() == "style" && is_css(node))
        .filter_map(|node| node.text())
}
