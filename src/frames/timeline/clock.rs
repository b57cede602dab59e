//! Takes the text of one time (`1.5s`, `02:30.5`, `logo.end-250ms`), makes seconds or a condition.
//! After SMIL 3.0, 5.4.1 (begin and end values) and 5.4.2 (clock values).

use super::intervals::Moment;

/// A condition in `begin` or `end`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum When {
    /// Seconds from the start of the document.
    At(f64),
    /// Seconds from a moment of another animation's intervals.
    Sync { id: String, moment: Moment, offset: f64 },
    /// Never by itself: `indefinite`.
    Never,
    /// Something that happens to the viewer: a click, a key, the time of the day.
    Event,
}

/// The conditions of a `begin` or `end` list.
pub(super) fn list(text: &str) -> Vec<When> {
    text.split(';').map(str::trim).filter(|item| !item.is_empty()).map(when).collect()
}

fn when(text: &str) -> When {
    if text == "indefinite" {
        return When::Never;
    }
    if let Some(seconds) = offset(text) {
        return When::At(seconds);
    }
    // The last mark: an id may hold others.
    for (mark, moment) in [(".begin", Moment::Begin), (".end", Moment::End), (".repeat", Moment::Repeat(0))] {
        let Some(at) = text.rfind(mark) else { continue };
        let Some((moment, after)) = moment_after(moment, text[at + mark.len()..].trim()) else { continue };
        let offset = if after.is_empty() { Some(0.0) } else { signed(after) };
        if let Some(offset) = offset {
            // A backslash keeps a dot or minus inside an id.
            return When::Sync { id: text[..at].replace('\\', ""), moment, offset };
        }
    }
    When::Event
}

/// What follows a mark: the events of beginning and end are as good as these; a repetition has its number.
fn moment_after(moment: Moment, text: &str) -> Option<(Moment, &str)> {
    match moment {
        Moment::Repeat(_) => {
            let (number, after) = text.strip_prefix('(')?.split_once(')')?;
            let number = number.trim().parse().ok().filter(|&n: &u32| n > 0)?;
            Some((Moment::Repeat(number), after.trim()))
        }
        _ => Some((moment, text.strip_prefix("Event").unwrap_or(text).trim())),
    }
}

/// An offset with or without its sign.
fn offset(text: &str) -> Option<f64> {
    signed(text).or_else(|| clock(text))
}

fn signed(text: &str) -> Option<f64> {
    if let Some(rest) = text.strip_prefix('-') {
        return clock(rest.trim()).map(|seconds| -seconds);
    }
    clock(text.strip_prefix('+')?.trim())
}

/// A clock value in seconds: `1h`, `2.5min`, `3s`, `40ms`, `5`, `1:30:05.5`, `02:30`.
pub(super) fn clock(text: &str) -> Option<f64> {
    let text = text.trim();
    if text.contains(':') {
        let parts: Vec<f64> = text.split(':').map(number).collect::<Option<_>>()?;
        return match parts[..] {
            [minutes, seconds] if seconds < 60.0 => Some(minutes * 60.0 + seconds),
            [hours, minutes, seconds] if minutes < 60.0 && seconds < 60.0 => {
                Some(hours * 3600.0 + minutes * 60.0 + seconds)
            }
            _ => None,
        };
    }
    for (unit, seconds) in [("ms", 1e-3), ("min", 60.0), ("h", 3600.0), ("s", 1.0), ("", 1.0)] {
        if let Some(digits) = text.strip_suffix(unit) {
            return number(digits).map(|value| value * seconds);
        }
    }
    None
}

/// Digits with an optional fraction; no sign, no exponent.
fn number(text: &str) -> Option<f64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    text.parse().ok().filter(|_| plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_values_of_the_specification() {
        for (text, seconds) in [
            ("02:30:03", 9003.0),
            ("50:00:10.25", 180_010.25),
            ("02:33", 153.0),
            ("00:10.5", 10.5),
            ("3.2h", 11_520.0),
            ("45min", 2700.0),
            ("30s", 30.0),
            ("5ms", 0.005),
            ("12.467", 12.467),
            (".5s", 0.5),
        ] {
            assert!((clock(text).unwrap() - seconds).abs() < 1e-9, "{text}");
        }
        for text in ["", "s", "1:75", "-3", "1e3", "fast", "1 s2"] {
            assert_eq!(clock(text), None, "{text}");
        }
    }

    #[test]
    fn begin_lists_hold_offsets_syncs_and_events() {
        let sync = |id: &str, moment, offset| When::Sync { id: id.to_string(), moment, offset };
        assert_eq!(
            list("0; -1.5s ;a.end;b.begin + 0.2s; c.d.end-100ms;indefinite;e.click;accessKey(a);f.endEvent+1s;g.repeat(2);h.repeat(0)"),
            [
                When::At(0.0),
                When::At(-1.5),
                sync("a", Moment::End, 0.0),
                sync("b", Moment::Begin, 0.2),
                sync("c.d", Moment::End, -0.1),
                When::Never,
                When::Event,
                When::Event,
                sync("f", Moment::End, 1.0),
                sync("g", Moment::Repeat(2), 0.0),
                When::Event
            ]
        );
    }
}
