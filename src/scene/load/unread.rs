//! Takes the XML of a drawing, finds what the parser leaves out without a word.

use crate::scene::Warning;
use simplecss::DeclarationTokenizer;
use std::collections::HashSet;
use usvg::roxmltree::{Document, Node};

/// One warning a kind, which names the first element.
pub(super) fn find(xml: &Document) -> Vec<Warning> {
    let elements = || xml.descendants().filter(Node::is_element);
    let filters: HashSet<&str> =
        elements().filter(|node| is(node, "filter")).filter_map(|node| node.attribute("id")).collect();
    let mut warnings: Vec<Warning> = Vec::new();
    for node in elements() {
        let mut warn = |kind: &'static str| match warnings.iter_mut().find(|warning| warning.kind == kind) {
            Some(warning) => warning.count += 1,
            None => warnings.push(Warning { kind, element: name(&node), count: 1 }),
        };
        if is(&node, "foreignObject") && !has_another(&node) {
            warn("foreign objects");
        }
        let elsewhere = |href: &str| !href.trim().is_empty() && !href.trim().starts_with('#');
        if is(&node, "use") && href(&node).is_some_and(elsewhere) {
            warn("elements of other files");
        }
        if property(&node, "vector-effect").is_some_and(|value| value == "non-scaling-stroke") {
            warn("vector effects");
        }
        if property(&node, "filter").and_then(linked).is_some_and(|id| !filters.contains(id)) {
            warn("elements with filters that are not there");
        }
    }
    warnings
}

fn is(node: &Node, tag: &str) -> bool {
    node.tag_name().name() == tag
}

/// Will a switch show another element in its place?
fn has_another(node: &Node) -> bool {
    node.parent().is_some_and(|parent| is(&parent, "switch")) && node.next_sibling_element().is_some()
}

fn href<'a>(node: &Node<'a, '_>) -> Option<&'a str> {
    const XLINK: &str = "http://www.w3.org/1999/xlink";
    node.attribute("href").or_else(|| node.attribute((XLINK, "href")))
}

/// By the `style` attribute, or else the one of that name.
fn property<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let styled = node.attribute("style").filter(|style| style.contains(name)).and_then(|style| {
        DeclarationTokenizer::from(style).filter(|declaration| declaration.name == name).last()
    });
    styled.map(|declaration| declaration.value).or_else(|| node.attribute(name)).map(str::trim)
}

/// The id in a property that is one link, `url(#id)`.
fn linked(value: &str) -> Option<&str> {
    let inside = value.strip_prefix("url(")?.strip_suffix(')')?;
    inside.trim_matches(|c: char| c.is_whitespace() || matches!(c, '"' | '\'')).strip_prefix('#')
}

/// What messages call an element: its id, or where it stands.
pub(super) fn name(node: &Node) -> String {
    node.attribute("id").map_or_else(
        || {
            let line = node.document().text_pos_at(node.range().start).row;
            format!("the <{}> in line {line}", node.tag_name().name())
        },
        str::to_owned,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(body: &str) -> Vec<(&'static str, String, usize)> {
        let text = format!("<svg xmlns:xlink='http://www.w3.org/1999/xlink'>\n{body}</svg>");
        let xml = Document::parse(&text).expect("a document");
        find(&xml).into_iter().map(|warning| (warning.kind, warning.element, warning.count)).collect()
    }

    #[test]
    fn what_the_parser_leaves_out_is_named() {
        assert_eq!(
            found("<foreignObject/><foreignObject id='b'/>"),
            [("foreign objects", "the <foreignObject> in line 2".to_owned(), 2)]
        );
        assert_eq!(
            found("<use id='u' xlink:href='other.svg#a'/>"),
            [("elements of other files", "u".to_owned(), 1)]
        );
        assert_eq!(
            found("<rect id='r' style='fill:red; vector-effect: non-scaling-stroke'/>"),
            [("vector effects", "r".to_owned(), 1)]
        );
        assert_eq!(
            found("<g id='g' filter=\"url( '#typo' )\"/>"),
            [("elements with filters that are not there", "g".to_owned(), 1)]
        );
    }

    #[test]
    fn what_is_drawn_is_not_named() {
        for body in [
            "<switch><foreignObject/><text/></switch>",
            "<use href='#a'/><use/><use href=''/>",
            "<rect vector-effect='none'/>",
            "<filter id='f'/><g filter='url(#f)'/><g filter='blur(2px)'/><g style='filter:url(#f)' filter='url(#g)'/>",
        ] {
            assert_eq!(found(body), [], "{body}");
        }
    }
}
