//! Takes what the SVG parser logs while it reads a drawing, makes one warning a kind of it.
//!
//! Where the parser drops an element or takes another value for one that it cannot read, its log is the only one
//! to tell. What it says of drawings nested so deep that it needs a thread of its own is heard verbosely only.

use super::report;
use std::cell::RefCell;
use std::collections::HashSet;

/// Messages of one drawing that are kept: what comes later is not told.
const MOST: usize = 10_000;

/// Of shapes without a size, which are rightly not drawn.
const NO_SIZE: [&str; 5] =
    ["invalid 'width'", "invalid 'height'", "invalid 'rx'", "invalid 'ry'", "invalid 'r'"];

/// Is this told otherwise, or nothing to tell of?
fn is_idle(target: &str, message: &str) -> bool {
    // The loader tells what comes of fonts that are not there; keyframes are ours to animate by.
    target == "usvg::text"
        || message.starts_with("The @keyframes rule")
        || NO_SIZE.iter().any(|what| message.contains(what))
}

thread_local! {
    /// Since the drawing was begun that this thread reads.
    static HEARD: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Hears the parser from now on, unless only errors are to be said. Verbosely, all that it says goes to standard error at
/// once, with the part of it that speaks.
pub fn hear(quiet: bool, verbose: bool) {
    static KEEPS: Logger = Logger { verbose: false };
    static SAYS: Logger = Logger { verbose: true };
    if !quiet && log::set_logger(if verbose { &SAYS } else { &KEEPS }).is_ok() {
        log::set_max_level(log::LevelFilter::Warn);
    }
}

/// Forgets what this thread has read so far.
pub fn begin() {
    HEARD.with_borrow_mut(Vec::clear);
}

/// Warns of what has been heard of the drawing called `name`.
pub fn tell(name: &str) {
    for (first, count) in by_kind(&HEARD.take()) {
        let others = if count > 1 { format!(" (and {} more like it)", count - 1) } else { String::new() };
        report::line(&format!("{name}: warning: {first}{others}"));
    }
}

struct Logger {
    verbose: bool,
}

impl log::Log for Logger {
    fn enabled(&self, metadata: &log::Metadata) -> bool {
        metadata.level() <= log::Level::Warn
    }

    fn log(&self, record: &log::Record) {
        if self.verbose {
            report::line(&format!("{}: {}", record.target(), record.args()));
        } else {
            HEARD.with_borrow_mut(|heard| {
                if heard.len() < MOST {
                    let message = record.args().to_string();
                    heard.extend((!is_idle(record.target(), &message)).then_some(message));
                }
            });
        }
    }

    fn flush(&self) {}
}

/// The first message of each kind, without its full stop, and how many different ones there are.
fn by_kind(heard: &[String]) -> Vec<(&str, usize)> {
    let mut seen = HashSet::new();
    let mut kinds: Vec<(String, &str, usize)> = Vec::new();
    for message in heard.iter().filter(|message| seen.insert(message.as_str())) {
        let kind = kind_of(message);
        match kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((_, _, count)) => *count += 1,
            None => kinds.push((kind, message.trim_end_matches('.'), 1)),
        }
    }
    kinds.into_iter().map(|(_, first, count)| (first, count)).collect()
}

/// A message without what it quotes, and without numbers.
fn kind_of(message: &str) -> String {
    let said = message.split('\'').step_by(2).flat_map(str::chars);
    said.filter(|c| !c.is_ascii_digit()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_in_quotes_and_numbers_is_one_kind_and_what_is_said_again_counts_once() {
        let heard = ["Bad fill 'a'.", "Path ends at 7", "Bad fill 'b'.", "Bad fill 'a'.", "Path ends at 12"];
        let heard = heard.map(str::to_string);
        assert_eq!(by_kind(&heard), [("Bad fill 'a'", 2), ("Path ends at 7", 2)]);
    }
}
