//! Takes a style sheet, refuses selectors that the parser would try in too many ways: for `a b c` it goes
//! through all elements around one for `b`, and for each of them through all around that for `a`.

use crate::Error;
use simplecss::{Selector, StyleSheet};
use usvg::roxmltree::{Document, Node};

/// Ways in which one selector may be tried on all elements together: a few seconds.
const MOST_WAYS: f64 = 5e7;

/// Looks at the style sheets of a document before anybody matches them.
///
/// # Errors
/// [`Error::Limit`] for a selector with too many elements around one another in a document that is nested deep.
pub(crate) fn check(xml: &Document, styles: &StyleSheet) -> Result<(), Error> {
    let selectors = styles.rules.iter().map(|rule| (elements_around(&rule.selector), &rule.selector));
    let Some((around, longest)) =
        selectors.max_by_key(|(around, _)| *around).filter(|(around, _)| *around > 1)
    else {
        return Ok(());
    };
    let mut by_depth = Vec::new();
    for depth in xml.descendants().filter(Node::is_element).map(|node| node.ancestors().skip(1).count()) {
        by_depth.resize(by_depth.len().max(depth + 1), 0.0);
        by_depth[depth] += 1.0;
    }
    let ways = |around: usize| {
        let of_depth = |(depth, elements): (usize, &f64)| elements * choices(depth, around);
        by_depth.iter().enumerate().map(of_depth).sum::<f64>()
    };
    // A selector is tried from its end, whether or not there are enough elements around for its beginning.
    if (2..=around).all(|around| ways(around) <= MOST_WAYS) {
        return Ok(());
    }
    Err(Error::Limit(format!(
        "its style sheet has selectors like '{}', with up to {around} elements around one another, which would be \
         tried in too many ways, as elements are nested {} deep (use classes, or '>' between elements)",
        longest,
        by_depth.len() - 1,
    )))
}

/// How many elements around the one selected are named, but for those with `>` behind them.
fn elements_around(selector: &Selector) -> usize {
    let mut in_brackets = false;
    let outside: String = selector
        .to_string()
        .chars()
        .filter(|c| {
            in_brackets = *c == '[' || in_brackets && *c != ']';
            !in_brackets
        })
        .collect();
    let parts = outside.split_whitespace();
    let direct = parts.clone().filter(|part| matches!(*part, ">" | "+")).count();
    parts.count().saturating_sub(1 + 2 * direct)
}

/// Ways to choose so many of `from`.
fn choices(from: usize, count: usize) -> f64 {
    (0..count).map(|i| from.saturating_sub(i) as f64 / (i + 1) as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_around_are_counted() {
        for (selector, expected) in [
            ("rect", 0),
            ("g rect", 1),
            ("a > b + c", 0),
            ("a b > c d", 2),
            ("a [b='c d'] .e", 2),
            (".a.b #c", 1),
        ] {
            let selector = Selector::parse(selector).expect("a selector");
            assert_eq!(elements_around(&selector), expected, "{selector}");
        }
    }

    #[test]
    fn only_what_would_take_forever_is_refused() {
        let refused = |selector: &str, depth: usize| {
            let text = format!("{}<rect/>{}", "<g>".repeat(depth), "</g>".repeat(depth));
            let xml = Document::parse(&text).expect("a document");
            let mut styles = StyleSheet::new();
            let rule = format!("{selector}{{fill:red}}");
            styles.parse_more(&rule);
            check(&xml, &styles).is_err()
        };
        assert!(refused("x g g g g g g g g rect", 60));
        assert!(!refused("x > g > g > g > g > g > g > g > g > rect", 60));
        assert!(!refused("svg g g rect", 100));
        assert!(!refused(".a .b .c .d .e rect", 30));
        // It fits nowhere, and is tried all the same.
        assert!(refused(&format!("{}rect", "g ".repeat(90)), 60));
    }
}
