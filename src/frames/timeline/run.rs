//! Takes the declarations of an element, makes the animations that they ask for, and how far each is in
//! its keyframes at a time. After CSS Animations 1.

use super::easing::Easing;

/// `animation-…` of one animation.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub name: String,
    pub duration: f64,
    pub easing: Easing,
    pub delay: f64,
    pub count: f64,
    pub direction: Direction,
    pub before: bool,
    pub after: bool,
    pub paused: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Normal,
    Reverse,
    Alternate,
    AlternateReverse,
}

impl Run {
    /// Where in its keyframes it is, 0..=1; `None` where it has no effect.
    pub(super) fn share(&self, time: f64) -> Option<f64> {
        let elapsed = if self.paused { 0.0 } else { time } - self.delay;
        let active = if self.count == 0.0 { 0.0 } else { self.duration * self.count };
        let (elapsed, over) = if elapsed < -1e-9 {
            self.before.then_some((0.0, false))?
        } else if elapsed >= active - 1e-9 {
            self.after.then_some((active, true))?
        } else {
            (elapsed, false)
        };
        let rounds = if self.duration > 0.0 {
            elapsed / self.duration
        } else if over {
            self.count
        } else {
            0.0
        };
        let rounds = if rounds.is_finite() { rounds } else { 1.0 };
        let whole = if (rounds - rounds.round()).abs() < 1e-9 { rounds.round() } else { rounds.floor() };
        let (iteration, share) = match over && whole > 0.0 && rounds - whole < 1e-9 {
            true => (whole - 1.0, 1.0),
            false => (whole, (rounds - whole).clamp(0.0, 1.0)),
        };
        let odd = iteration % 2.0 == 1.0;
        let backwards = match self.direction {
            Direction::Normal => false,
            Direction::Reverse => true,
            Direction::Alternate => odd,
            Direction::AlternateReverse => !odd,
        };
        Some(if backwards { 1.0 - share } else { share })
    }
}

/// The animations that an element's declarations ask for.
pub(super) fn runs(declarations: &[(&str, &str)]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut longhands: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, value) in declarations {
        let name = name.trim_start_matches("-webkit-");
        if name == "animation" {
            runs = split(value, ',').into_iter().map(shorthand).collect();
            longhands.clear();
        } else if let Some(part) = name.strip_prefix("animation-") {
            longhands.push((part, split(value, ',')));
        }
    }
    if let Some((_, names)) = longhands.iter().rfind(|(part, _)| *part == "name") {
        runs.resize(names.len(), shorthand(""));
        names
            .iter()
            .zip(&mut runs)
            .for_each(|(name, run)| run.name = name.trim_matches(['"', '\'']).to_string());
    }
    for (part, values) in &longhands {
        for (run, value) in runs.iter_mut().zip(values.iter().cycle()) {
            run.set(part, value);
        }
    }
    // A negative delay is fine, a negative duration is not.
    runs.retain(|run| run.name != "none" && !run.name.is_empty() && run.duration >= 0.0);
    runs
}

impl Run {
    fn set(&mut self, part: &str, value: &str) {
        match part {
            "duration" => self.duration = seconds(value).unwrap_or(0.0),
            "delay" => self.delay = seconds(value).unwrap_or(0.0),
            "timing-function" => self.easing = Easing::from_css(value).unwrap_or(Easing::EASE),
            "iteration-count" => self.count = count(value).unwrap_or(1.0),
            "direction" => self.direction = direction(value).unwrap_or(Direction::Normal),
            "fill-mode" => {
                self.before = matches!(value, "backwards" | "both");
                self.after = matches!(value, "forwards" | "both");
            }
            "play-state" => self.paused = value == "paused",
            _ => {}
        }
    }
}

/// One animation of the `animation` property: its words are known by what they look like.
pub(super) fn shorthand(text: &str) -> Run {
    let mut run = Run {
        name: String::new(),
        duration: 0.0,
        easing: Easing::EASE,
        delay: 0.0,
        count: 1.0,
        direction: Direction::Normal,
        before: false,
        after: false,
        paused: false,
    };
    let mut times = 0;
    for word in split(text, ' ') {
        if let Some(time) = seconds(word) {
            *[&mut run.duration, &mut run.delay][times.min(1)] = time;
            times += 1;
        } else if let Some(easing) = Easing::from_css(word) {
            run.easing = easing;
        } else if let Some(count) = count(word) {
            run.count = count;
        } else if let Some(direction) = direction(word) {
            run.direction = direction;
        } else {
            match word {
                "forwards" | "backwards" | "both" => run.set("fill-mode", word),
                "paused" | "running" => run.set("play-state", word),
                "none" if !run.name.is_empty() => {}
                name => run.name = name.trim_matches(['"', '\'']).to_string(),
            }
        }
    }
    run
}

/// Parts between separators that stand outside of parentheses; a space is any white space.
fn split(text: &str, separator: char) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut depth, mut from) = (0_usize, 0);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            c if depth == 0 && (c == separator || (separator == ' ' && c.is_whitespace())) => {
                parts.push(text[from..at].trim());
                from = at + c.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(text[from..].trim());
    parts.retain(|part| !part.is_empty());
    parts
}

fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e-3),
        None => (text.strip_suffix('s')?, 1.0),
    };
    number.parse::<f64>().ok().filter(|n| n.is_finite()).map(|n| n * unit)
}

fn count(text: &str) -> Option<f64> {
    match text {
        "infinite" => Some(f64::INFINITY),
        _ => text.parse().ok().filter(|&n: &f64| n >= 0.0 && n.is_finite()),
    }
}

fn direction(text: &str) -> Option<Direction> {
    Some(match text {
        "normal" => Direction::Normal,
        "reverse" => Direction::Reverse,
        "alternate" => Direction::Alternate,
        "alternate-reverse" => Direction::AlternateReverse,
        _ => return None,
    })
}
