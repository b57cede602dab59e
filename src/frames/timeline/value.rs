//! Takes the text of an attribute or property, makes a value that can be mixed with others, added to
//! others and written again: numbers with units, lists of them, colours, paths; anything else is text,
//! which only jumps.

use std::fmt::Write;
use svgtypes::{LengthListParser, LengthUnit, PathParser, PathSegment};

/// Most numbers in a value that is mixed; longer ones jump.
const MOST_NUMBERS: usize = 1_000_000;

/// A value of an attribute or property.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Numbers(Vec<(f64, LengthUnit)>),
    /// Red, green, blue 0..=255 and alpha 0..=1, sRGB-encoded.
    Color([f64; 4]),
    /// Absolute commands with their numbers; the flags of an arc are 0 or 1.
    Path(Vec<(char, Vec<f64>)>),
    Text(String),
}

/// Names whose values never mix, whatever they look like.
const TEXTS: &[&str] = &[
    "href",
    "class",
    "id",
    "display",
    "visibility",
    "fill-rule",
    "clip-rule",
    "font-family",
    "font-style",
    "font-variant",
    "font-weight",
    "preserveAspectRatio",
    "result",
    "in",
    "in2",
    "type",
    "mode",
    "operator",
];
const COLORS: &[&str] = &["fill", "stroke", "stop-color", "flood-color", "lighting-color", "color"];

/// Whether values of this name are colours.
pub(super) fn is_color(name: &str) -> bool {
    COLORS.contains(&name)
}

impl Value {
    /// Reads a value of the attribute or property `name`; `current` is what `currentColor` means.
    pub(super) fn parse(name: &str, text: &str, current: Option<&str>) -> Value {
        let text = text.trim();
        let value = match name {
            name if TEXTS.contains(&name) => None,
            name if is_color(name) => color(text, current),
            "d" => path(text),
            "offset" => numbers(text).map(Value::without_percent),
            name if name.ends_with("opacity") => numbers(text).map(Value::without_percent),
            _ => numbers(text),
        };
        value.unwrap_or_else(|| Value::Text(text.to_string()))
    }

    /// Of a share: 50% is .5.
    fn without_percent(self) -> Value {
        let Value::Numbers(list) = self else { return self };
        let plain = |(number, unit)| match unit {
            LengthUnit::Percent => (number / 100.0, LengthUnit::None),
            unit => (number, unit),
        };
        Value::Numbers(list.into_iter().map(plain).collect())
    }

    /// Between `self` (at 0) and `other` (at 1); `None` if they do not mix.
    pub(super) fn mix(&self, other: &Value, share: f64) -> Option<Value> {
        self.combine(other, |a, b| a + (b - a) * share)
    }

    /// The same as CSS has it: what is transparent lends no colour.
    pub(super) fn mix_as_css(&self, other: &Value, share: f64) -> Option<Value> {
        let (Value::Color(a), Value::Color(b)) = (self, other) else { return self.mix(other, share) };
        let alpha = a[3] + (b[3] - a[3]) * share;
        let channel = |i: usize| match alpha > 0.0 {
            true => (a[i] * a[3] * (1.0 - share) + b[i] * b[3] * share) / alpha,
            false => 0.0,
        };
        Some(Value::Color([channel(0), channel(1), channel(2), alpha]))
    }

    /// `self` and `times` times `other`; `None` if they do not add up.
    pub(super) fn plus(&self, other: &Value, times: f64) -> Option<Value> {
        self.combine(other, |a, b| a + b * times)
    }

    fn combine(&self, other: &Value, f: impl Fn(f64, f64) -> f64) -> Option<Value> {
        match (self, other) {
            (Value::Numbers(a), Value::Numbers(b)) if a.len() == b.len() => {
                let pairs = a.iter().zip(b).map(|(&a, &b)| {
                    let (a, b, unit) = same_unit(a, b)?;
                    Some((f(a, b), unit))
                });
                pairs.collect::<Option<_>>().map(Value::Numbers)
            }
            (Value::Color(a), Value::Color(b)) => Some(Value::Color(std::array::from_fn(|i| f(a[i], b[i])))),
            (Value::Path(a), Value::Path(b)) if a.len() == b.len() => {
                let pairs = a.iter().zip(b).map(|((command, a), (other, b))| {
                    let numbers = a.iter().zip(b).map(|(&a, &b)| f(a, b)).collect();
                    (command == other && a.len() == b.len()).then_some((*command, numbers))
                });
                pairs.collect::<Option<_>>().map(Value::Path)
            }
            _ => None,
        }
    }

    /// How far apart two values are, for `calcMode="paced"`.
    pub(super) fn distance(&self, other: &Value) -> Option<f64> {
        let difference = self.combine(other, |a, b| a - b)?;
        let square = match difference {
            Value::Numbers(list) => list.iter().map(|(x, _)| x * x).sum(),
            Value::Color(channels) => channels[..3].iter().map(|x| x * x).sum::<f64>(),
            Value::Path(_) | Value::Text(_) => return None,
        };
        Some(square.sqrt())
    }

    /// As it stands in an attribute.
    pub(super) fn text(&self) -> String {
        let mut out = String::new();
        match self {
            Value::Text(text) => out.push_str(text),
            Value::Numbers(list) => {
                for (i, &(value, unit)) in list.iter().enumerate() {
                    let _ =
                        write!(out, "{}{}{}", if i > 0 { " " } else { "" }, Short(value), unit_name(unit));
                }
            }
            Value::Color([r, g, b, a]) => {
                let [r, g, b] = [r, g, b].map(|c| c.round().clamp(0.0, 255.0));
                let _ = match a {
                    a if *a >= 1.0 => write!(out, "rgb({r},{g},{b})"),
                    a => write!(out, "rgba({r},{g},{b},{})", Short(a.max(0.0))),
                };
            }
            Value::Path(segments) => {
                for (command, numbers) in segments {
                    out.push(*command);
                    for (i, &value) in numbers.iter().enumerate() {
                        let is_flag = *command == 'A' && (i == 3 || i == 4);
                        let value = if is_flag { f64::from(u8::from(value >= 0.5)) } else { value };
                        let _ = write!(out, "{}{}", if i > 0 { " " } else { "" }, Short(value));
                    }
                }
            }
        }
        out
    }
}

/// A number as short as it can be at a billionth: sums like .1 + .2 leave no tail of digits.
pub(super) struct Short(pub f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const FINEST: f64 = 1e9;
        let rounded = (self.0 * FINEST).round() / FINEST;
        let value = if rounded.is_finite() { rounded } else { self.0 };
        // No minus before a zero.
        write!(f, "{}", value + 0.0)
    }
}

fn color(text: &str, current: Option<&str>) -> Option<Value> {
    let text = if text.eq_ignore_ascii_case("currentcolor") { current? } else { text };
    let color: svgtypes::Color = text.trim().parse().ok()?;
    let [r, g, b] = [color.red, color.green, color.blue].map(f64::from);
    Some(Value::Color([r, g, b, f64::from(color.alpha) / 255.0]))
}

fn numbers(text: &str) -> Option<Value> {
    let list: Vec<_> = LengthListParser::from(text)
        .map(|length| length.map(|l| (l.number, l.unit)))
        .take(MOST_NUMBERS + 1)
        .collect::<Result<_, _>>()
        .ok()?;
    (!list.is_empty() && list.len() <= MOST_NUMBERS).then_some(Value::Numbers(list))
}

/// Both numbers in one unit; a zero takes any.
fn same_unit((a, unit): (f64, LengthUnit), (b, other): (f64, LengthUnit)) -> Option<(f64, f64, LengthUnit)> {
    let plain = |unit| matches!(unit, LengthUnit::None | LengthUnit::Px);
    if unit == other || (plain(unit) && plain(other)) {
        return Some((a, b, unit));
    }
    match (pixels(unit), pixels(other)) {
        (Some(x), Some(y)) => Some((a * x, b * y, LengthUnit::Px)),
        _ if a == 0.0 => Some((a, b, other)),
        _ if b == 0.0 => Some((a, b, unit)),
        _ => None,
    }
}

/// CSS pixels in a unit, where that does not depend on anything else.
fn pixels(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::None | LengthUnit::Px => Some(1.0),
        LengthUnit::In => Some(96.0),
        LengthUnit::Cm => Some(96.0 / 2.54),
        LengthUnit::Mm => Some(96.0 / 25.4),
        LengthUnit::Pt => Some(96.0 / 72.0),
        LengthUnit::Pc => Some(16.0),
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => None,
    }
}

fn unit_name(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::None => "",
        LengthUnit::Px => "px",
        LengthUnit::In => "in",
        LengthUnit::Cm => "cm",
        LengthUnit::Mm => "mm",
        LengthUnit::Pt => "pt",
        LengthUnit::Pc => "pc",
        LengthUnit::Em => "em",
        LengthUnit::Ex => "ex",
        LengthUnit::Percent => "%",
    }
}

/// Path data with absolute commands.
fn path(text: &str) -> Option<Value> {
    use PathSegment as S;
    let mut segments = Vec::new();
    // The current point and the start of the subpath.
    let (mut x0, mut y0, mut start) = (0.0, 0.0, (0.0, 0.0));
    for segment in PathParser::from(text) {
        let segment = segment.ok()?;
        let (dx, dy) = if segment.is_abs() { (0.0, 0.0) } else { (x0, y0) };
        let (command, numbers) = match segment {
            S::MoveTo { x, y, .. } => ('M', vec![x + dx, y + dy]),
            S::LineTo { x, y, .. } => ('L', vec![x + dx, y + dy]),
            S::HorizontalLineTo { x, .. } => ('H', vec![x + dx]),
            S::VerticalLineTo { y, .. } => ('V', vec![y + dy]),
            S::CurveTo { x1, y1, x2, y2, x, y, .. } => {
                ('C', vec![x1 + dx, y1 + dy, x2 + dx, y2 + dy, x + dx, y + dy])
            }
            S::SmoothCurveTo { x2, y2, x, y, .. } => ('S', vec![x2 + dx, y2 + dy, x + dx, y + dy]),
            S::Quadratic { x1, y1, x, y, .. } => ('Q', vec![x1 + dx, y1 + dy, x + dx, y + dy]),
            S::SmoothQuadratic { x, y, .. } => ('T', vec![x + dx, y + dy]),
            S::EllipticalArc { rx, ry, x_axis_rotation, large_arc, sweep, x, y, .. } => {
                let flag = |on: bool| f64::from(u8::from(on));
                ('A', vec![rx, ry, x_axis_rotation, flag(large_arc), flag(sweep), x + dx, y + dy])
            }
            S::ClosePath { .. } => ('Z', vec![]),
        };
        match (command, &numbers[..]) {
            ('H', &[x]) => x0 = x,
            ('V', &[y]) => y0 = y,
            ('Z', _) => (x0, y0) = start,
            (_, &[.., x, y]) => (x0, y0) = (x, y),
            _ => {}
        }
        if command == 'M' {
            start = (x0, y0);
        }
        segments.push((command, numbers));
    }
    (!segments.is_empty()).then_some(Value::Path(segments))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half(name: &str, from: &str, to: &str) -> Option<String> {
        Value::parse(name, from, None).mix(&Value::parse(name, to, None), 0.5).map(|v| v.text())
    }

    #[test]
    fn numbers_mix_within_their_units() {
        assert_eq!(half("x", "1", "4").as_deref(), Some("2.5"));
        assert_eq!(half("x", "10%", "20%").as_deref(), Some("15%"));
        assert_eq!(half("x", "0", "20%").as_deref(), Some("10%"));
        assert_eq!(half("x", "1in", "48px").as_deref(), Some("72px"));
        assert_eq!(half("x", "1em", "20%"), None);
        assert_eq!(half("fill-opacity", "1", "30%").as_deref(), Some("0.65"));
        assert_eq!(half("points", "0,0 2,2", "2 4-2 0").as_deref(), Some("1 2 0 1"));
        assert_eq!(half("points", "0,0", "1"), None);
    }

    #[test]
    fn colors_mix_channel_by_channel() {
        assert_eq!(half("fill", "red", "#00f").as_deref(), Some("rgb(128,0,128)"));
        assert_eq!(half("fill", "none", "#00f"), None);
        let current = Value::parse("fill", "currentColor", Some("lime"));
        assert_eq!(current.text(), "rgb(0,255,0)");
    }

    #[test]
    fn paths_mix_if_their_commands_are_equal() {
        assert_eq!(half("d", "M0 0l10 0z", "M0 0L20 10Z").as_deref(), Some("M0 0L15 5Z"));
        assert_eq!(half("d", "M0 0h10", "M0 0v10"), None);
    }

    #[test]
    fn names_and_links_never_mix() {
        assert_eq!(half("href", "1", "2"), None);
        assert_eq!(half("visibility", "hidden", "visible"), None);
    }
}
