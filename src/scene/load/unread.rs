//! Takes the XML of a drawing, finds what the parser leaves out without a word.

use super::links::{urls, Finder};
use super::name_of;
use crate::scene::Warning;
use usvg::roxmltree::{Document, Node};

/// One warning a kind, which names the first element.
pub(super) fn find<'a>(xml: &'a Document<'a>, finder: &Finder<'a>) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = Vec::new();
    for node in xml.descendants().filter(Node::is_element) {
        let mut warn = |kind: &'static str| match warnings.iter_mut().find(|warning| warning.kind == kind) {
            Some(warning) => warning.count += 1,
            None => warnings.push(Warning { kind, element: name_of(&node), count: 1 }),
        };
        if is(&node, "foreignObject") && !has_another(&node) {
            warn("foreign objects");
        }
        if is(&node, "use") && leads_elsewhere(&node) {
            warn("elements of other files");
        }
        if finder.value(node, "vector-effect").is_some_and(|value| value.trim() == "non-scaling-stroke") {
            warn("vector effects");
        }
        if is(&node, "mask") && mixes_linearly(node, finder) {
            warn("linear colours of masks");
        }
        let filter = finder.value(node, "filter").and_then(only_link);
        if filter.is_some_and(|id| !finder.target(id).is_some_and(|target| is(&target, "filter"))) {
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

fn leads_elsewhere(node: &Node) -> bool {
    let href = node.attributes().find(|attribute| attribute.name() == "href");
    href.is_some_and(|href| !matches!(href.value().trim().bytes().next(), None | Some(b'#')))
}

fn mixes_linearly<'a>(mask: Node<'a, 'a>, finder: &Finder<'a>) -> bool {
    let value = mask.ancestors().find_map(|node| finder.value(node, "color-interpolation"));
    value.is_some_and(|value| value.trim() == "linearRGB")
}

/// The id in a property that is one link and no more: in lists the parser passes over what it does not find.
fn only_link(value: &str) -> Option<&str> {
    let value = value.trim();
    let is_one = value.find(')') == value.len().checked_sub(1);
    urls(value).next().filter(|_| is_one && value.starts_with("url("))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(body: &str) -> Vec<(&'static str, String, usize)> {
        let text = format!("<svg xmlns:xlink='http://www.w3.org/1999/xlink'>\n{body}</svg>");
        let xml = Document::parse(&text).expect("a document");
        let finder = Finder::new(&xml, None).expect("links");
        find(&xml, &finder)
            .into_iter()
            .map(|warning| (warning.kind, warning.element, warning.count))
            .collect()
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
            found("<style>.a{vector-effect:non-scaling-stroke}</style><rect id='r' class='a'/>"),
            [("vector effects", "r".to_owned(), 1)]
        );
        for inside in [
            "<mask id='m' color-interpolation='linearRGB'/>",
            "<g style='color-interpolation:linearRGB'><mask id='m'/></g>",
        ] {
            assert_eq!(found(inside), [("linear colours of masks", "m".to_owned(), 1)]);
        }
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
            "<g color-interpolation='linearRGB'><mask color-interpolation='sRGB'/><rect/></g>",
            "<filter id='f'/><g filter='url(#f)'/><g filter='blur(2px)'/><g style='filter:url(#f)' filter='url(#g)'/>
             <g filter='url(#g) blur(2px)'/><g filter='url(#f) url(#g)'/>",
        ] {
            assert_eq!(found(body), [], "{body}");
        }
    }
}
