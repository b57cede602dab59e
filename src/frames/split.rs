//! Takes the text of a drawing, makes its pieces: the drawn elements that stand side by side, what they may
//! link to, and the tags around all of it. What a piece draws depends on itself, on the tags, and on the
//! pieces that it links to, and on nothing else; where that is not so, a drawing is not split.

use crate::scene::load::{check_selectors, Styled};
use crate::scene::parts::CUT_ID;
use crate::scene::print::{of_bytes, Print};
use simplecss::{DeclarationTokenizer, StyleSheet};
use std::collections::HashMap;
use std::ops::Range;
use usvg::roxmltree::{Document, Node};

/// Groups within one another beyond this are not looked into.
const DEEPEST: usize = 32;

/// Properties by which a group is more than its children one after the other; or is none at all.
const COMPOSITING: &[&str] =
    &["opacity", "filter", "mask", "clip-path", "clip", "mix-blend-mode", "isolation", "display"];
/// Attributes that do the same.
const CONDITIONS: &[&str] = &["systemLanguage", "requiredFeatures", "requiredExtensions"];
/// Elements that are drawn only where something links to them.
const LINKED: &[&str] = &[
    "clipPath",
    "cursor",
    "defs",
    "filter",
    "font",
    "font-face",
    "linearGradient",
    "marker",
    "mask",
    "pattern",
    "radialGradient",
    "symbol",
    "view",
];
/// Elements that draw nothing.
const SILENT: &[&str] = &["title", "desc", "metadata"];

/// A part of the text.
#[derive(Debug)]
pub(super) struct Piece {
    pub bytes: Range<usize>,
    pub role: Role,
    /// The start tag that it stands in; of the drawing's own, itself.
    pub within: usize,
    /// Pieces that its text links to, holes aside.
    pub links: Vec<usize>,
    /// Of its text; `None` if that has holes.
    pub print: Option<Print>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A tag around others.
    Tag,
    StyleSheet,
    Linked,
    Drawn,
}

/// A drawing in pieces.
#[derive(Debug)]
pub(super) struct Split {
    /// In the order of the text.
    pub pieces: Vec<Piece>,
    ids: HashMap<String, Target>,
}

/// Where an id is.
#[derive(Debug)]
enum Target {
    /// Several, if it is there more than once.
    Pieces(Vec<usize>),
    /// A group around others.
    Frame,
}

impl Split {
    /// Of `text`, whose start tags have `holes` at some places, in order; `None` if it is better not split.
    /// `injected` is a style sheet of the user's.
    pub fn new(text: &str, injected: Option<&str>, holes: &[usize]) -> Option<Split> {
        let options = usvg::roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let xml = Document::parse_with_options(text, options).ok()?;
        let root = xml.root_element();
        let escaped = text.contains(CUT_ID) || text.contains("&#35;") || text.contains("&#x23;");
        let prolog = &text[..root.range().start];
        let entities = || prolog.split("<!ENTITY").skip(1).any(|entity| entity.contains(['#', '<']));
        if escaped || (prolog.contains("<!ENTITY") && entities()) || !has_fixed_size(root) {
            return None;
        }
        let styles = styles(&xml, injected)?;
        let mut cutter =
            Cutter { text, holes, styles, pieces: Vec::new(), ids: Vec::new(), homes: Vec::new() };
        if cutter.composites(root) {
            return None;
        }
        cutter.frame(root, 0, 0)?;
        let Cutter { mut pieces, ids: framed, homes, .. } = cutter;
        // A style sheet in a piece is one for all.
        let in_piece = |node: Node| homes.iter().any(|(home, _)| node.ancestors().any(|a| a == *home));
        if xml.descendants().any(|node| node.tag_name().name() == "style" && in_piece(node)) {
            return None;
        }
        let mut ids: HashMap<String, Target> = HashMap::new();
        for (home, piece) in homes {
            for id in home.descendants().filter_map(|node| node.attribute("id")) {
                match ids.entry(id.to_string()).or_insert_with(|| Target::Pieces(Vec::new())) {
                    Target::Pieces(pieces) if pieces.last() != Some(&piece) => pieces.push(piece),
                    _ => {}
                }
            }
        }
        for id in framed {
            ids.insert(id, Target::Frame);
        }
        let plain = |c: char| c.is_alphanumeric() || "_-.:".contains(c);
        if !ids.keys().all(|id| id.chars().all(plain)) {
            return None;
        }
        let mut split = Split { pieces: Vec::new(), ids };
        for piece in &mut pieces {
            piece.links = split.links(&text[piece.bytes.clone()])?;
        }
        split.pieces = pieces;
        Some(split)
    }

    /// The pieces that a text links to; `None` if it links to a group around others. Whatever looks like a
    /// link is one.
    pub fn links(&self, text: &str) -> Option<Vec<usize>> {
        let mut links = Vec::new();
        for rest in text.split('#').skip(1) {
            let end = rest.find(|c: char| !(c.is_alphanumeric() || "_-.:".contains(c))).unwrap_or(rest.len());
            match self.ids.get(&rest[..end]) {
                Some(Target::Pieces(pieces)) => links.extend_from_slice(pieces),
                Some(Target::Frame) => return None,
                None => {}
            }
        }
        links.sort_unstable();
        links.dedup();
        Some(links)
    }
}

/// Is the drawing's size known without what it draws? Else the parser takes it from there.
fn has_fixed_size(root: Node) -> bool {
    let absolute = |name| root.attribute(name).is_some_and(|length| !length.contains('%'));
    root.has_attribute("viewBox") || (absolute("width") && absolute("height"))
}

/// The style sheets, if they neither look at what stands beside an element or directly around it, nor link.
fn styles<'a>(xml: &'a Document<'a>, injected: Option<&'a str>) -> Option<StyleSheet<'a>> {
    let mut styles = StyleSheet::new();
    styles.parse_more(injected.unwrap_or_default());
    for style in xml.descendants().filter(|node| node.tag_name().name() == "style") {
        for text in style.children().filter_map(|node| node.text()) {
            styles.parse_more(text);
        }
    }
    let is_local = |rule: &simplecss::Rule| {
        let links = rule.declarations.iter().any(|declaration| declaration.value.contains("url"));
        !links && !rule.selector.to_string().contains(['+', '>', ':'])
    };
    // What would be refused goes the long way, which says so.
    (styles.rules.iter().all(is_local) && check_selectors(xml, &styles).is_ok()).then_some(styles)
}

/// Cuts a drawing.
struct Cutter<'a> {
    text: &'a str,
    holes: &'a [usize],
    styles: StyleSheet<'a>,
    pieces: Vec<Piece>,
    /// Ids of those around others.
    ids: Vec<String>,
    /// Each element that is a piece, and the piece's number.
    homes: Vec<(Node<'a, 'a>, usize)>,
}

impl<'a> Cutter<'a> {
    /// Cuts what an element holds; `None` if it cannot be told where its tags end.
    fn frame(&mut self, node: Node<'a, 'a>, outer: usize, depth: usize) -> Option<()> {
        let (first, last) = (node.first_child()?, node.last_child()?);
        let within = self.pieces.len();
        self.ids.extend(node.attribute("id").map(str::to_string));
        // What stands before the drawing belongs to its tag.
        let start = if depth == 0 { 0 } else { node.range().start };
        self.piece(start..first.range().start, Role::Tag, outer);
        for child in node.children().filter(Node::is_element) {
            let tag = child.tag_name().name();
            if tag == "style" {
                self.piece(child.range(), Role::StyleSheet, within);
            } else if self.is_frame(child, depth) {
                self.frame(child, within, depth + 1)?;
            } else if !SILENT.contains(&tag) {
                // All that is in `defs` is there to be linked to.
                let linked = LINKED.contains(&tag) || node.tag_name().name() == "defs";
                self.homes.push((child, self.pieces.len()));
                self.piece(child.range(), if linked { Role::Linked } else { Role::Drawn }, within);
            }
        }
        self.piece(last.range().end..node.range().end, Role::Tag, within);
        Some(())
    }

    fn piece(&mut self, bytes: Range<usize>, role: Role, within: usize) {
        let print = (!self.has_holes(&bytes)).then(|| of_bytes(&self.text.as_bytes()[bytes.clone()]));
        self.pieces.push(Piece { bytes, role, within, links: Vec::new(), print });
    }

    fn has_holes(&self, bytes: &Range<usize>) -> bool {
        let next = self.holes.partition_point(|&hole| hole < bytes.start);
        self.holes.get(next).is_some_and(|&hole| hole < bytes.end)
    }

    /// Is an element no more than what it holds, one after the other?
    fn is_frame(&self, node: Node, depth: usize) -> bool {
        let tag = node.tag_name().name();
        let Some(first) = node.first_child() else { return false };
        let moves = self.has_holes(&(node.range().start..first.range().start));
        let below_defs = node.ancestors().skip(1).any(|a| a.tag_name().name() == "defs");
        (tag == "defs" || (tag == "g" && !below_defs))
            && depth < DEEPEST
            && !moves
            && self.text[..node.range().end].ends_with('>')
            && !self.composites(node)
    }

    fn composites(&self, node: Node) -> bool {
        let in_style = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
        let in_sheets = self.styles.rules.iter().filter(|rule| rule.selector.matches(&Styled(node)));
        node.attributes().any(|a| COMPOSITING.contains(&a.name()) || CONDITIONS.contains(&a.name()))
            || in_style.into_iter().any(|d| COMPOSITING.contains(&d.name))
            || in_sheets.flat_map(|rule| &rule.declarations).any(|d| COMPOSITING.contains(&d.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(content: &str) -> Option<String> {
        let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{content}</svg>"#);
        let split = Split::new(&text, None, &[])?;
        let roles = split.pieces.iter().map(|piece| match piece.role {
            Role::Tag => 'T',
            Role::StyleSheet => 'S',
            Role::Linked => 'L',
            Role::Drawn => 'D',
        });
        Some(roles.collect())
    }

    #[test]
    fn drawn_elements_are_pieces_down_to_the_first_that_composites() {
        let cut = |content: &str| split(content).unwrap_or_else(|| panic!("{content}"));
        assert_eq!(cut("<path/><title>a</title><g><rect/><circle/></g>"), "TDTDDTT");
        assert_eq!(cut(r#"<g opacity=".5"><rect/><circle/></g>"#), "TDT");
        assert_eq!(cut(r#"<g style="filter:none"><rect/></g>"#), "TDT");
        assert_eq!(cut(r#"<style>.a{mask:none}</style><g class="a"><rect/></g><g><rect/></g>"#), "TSDTDTT");
        assert_eq!(cut(r#"<defs><g><rect/></g></defs><clipPath/><use/>"#), "TTLTLDT");
    }

    #[test]
    fn a_drawing_whose_elements_depend_on_each_other_is_not_split() {
        for content in [
            "<style>a + b {fill:red}</style><path/>",
            "<style>g > path {fill:red}</style><path/>",
            "<style>path {fill:url(#a)}</style><path/>",
            "<svg><style>path {fill:red}</style></svg>",
            r##"<g id="a"><path/></g><use href="#a"/>"##,
            r#"<path id="toon-raster-cut"/>"#,
        ] {
            assert_eq!(split(content), None, "{content}");
        }
        let text = r#"<svg xmlns="http://www.w3.org/2000/svg"><path/></svg>"#;
        assert!(Split::new(text, None, &[]).is_none(), "its size depends on what it draws");
    }

    #[test]
    fn links_are_found_whatever_they_are_for() {
        let text = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">
            <linearGradient id="a"/><g opacity="1"><path id="b"/></g><path fill="url( '#a' )"/><use href="#b"/></svg>"##;
        let split = Split::new(text, None, &[]).unwrap();
        let links: Vec<_> = split.pieces.iter().map(|piece| piece.links.clone()).collect();
        assert_eq!(links, [vec![], vec![], vec![], vec![1], vec![2], vec![]]);
    }
}
