//! Takes a share of a time, 0..=1, makes the share of the way: cubic Bézier curves (SMIL's
//! `keySplines`, CSS's `cubic-bezier()`), steps and CSS's `linear()`. After CSS Easing Functions 2.

/// A curve from (0, 0) to (1, 1), or steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Easing {
    Linear,
    /// The two inner control points: x1, y1, x2, y2, both x within 0..=1.
    Bezier([f64; 4]),
    Steps {
        count: u32,
        jump: Jump,
    },
    /// Straight from point to point: shares of the time, which only grow, and of the way.
    Points(Vec<(f64, f64)>),
}

/// Where steps jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Jump {
    Start,
    End,
    None,
    Both,
}

impl Easing {
    pub(super) const EASE: Easing = Easing::Bezier([0.25, 0.1, 0.25, 1.0]);

    /// A Bézier curve, if its x are within 0..=1.
    pub(super) fn bezier(points: [f64; 4]) -> Option<Easing> {
        let ok =
            points.iter().all(|p| p.is_finite()) && [0, 2].iter().all(|&i| (0.0..=1.0).contains(&points[i]));
        ok.then_some(Easing::Bezier(points))
    }

    /// CSS's names and functions.
    pub(super) fn from_css(text: &str) -> Option<Easing> {
        Some(match text.trim() {
            "linear" => Easing::Linear,
            "ease" => Easing::EASE,
            "ease-in" => Easing::Bezier([0.42, 0.0, 1.0, 1.0]),
            "ease-out" => Easing::Bezier([0.0, 0.0, 0.58, 1.0]),
            "ease-in-out" => Easing::Bezier([0.42, 0.0, 0.58, 1.0]),
            "step-start" => Easing::Steps { count: 1, jump: Jump::Start },
            "step-end" => Easing::Steps { count: 1, jump: Jump::End },
            text => {
                let (name, arguments) = text.strip_suffix(')')?.split_once('(')?;
                let arguments: Vec<&str> = arguments.split(',').map(str::trim).collect();
                return match name.trim() {
                    "cubic-bezier" => {
                        let points: Vec<f64> =
                            arguments.iter().map(|a| a.parse().ok()).collect::<Option<_>>()?;
                        Easing::bezier(points.try_into().ok()?)
                    }
                    "steps" => steps(&arguments),
                    "linear" => points(&arguments),
                    _ => None,
                };
            }
        })
    }

    /// The share of the way at this share of the time.
    pub(super) fn at(&self, x: f64) -> f64 {
        match self {
            Easing::Linear => x,
            Easing::Bezier(points) => bezier_at(*points, x),
            Easing::Points(points) => {
                let after = points.partition_point(|&(time, _)| time <= x).clamp(1, points.len() - 1);
                let ((x0, y0), (x1, y1)) = (points[after - 1], points[after]);
                if x1 > x0 {
                    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
                } else {
                    y1
                }
            }
            &Easing::Steps { count, jump } => {
                let n = f64::from(count);
                let done = (x * n + 1e-9).floor().clamp(0.0, n);
                match jump {
                    Jump::End => done / n,
                    Jump::Start => ((done + 1.0) / n).min(1.0),
                    Jump::None => done.min(n - 1.0) / (n - 1.0),
                    Jump::Both => ((done + 1.0) / (n + 1.0)).min(1.0),
                }
            }
        }
    }
}

fn steps(arguments: &[&str]) -> Option<Easing> {
    let count: u32 = arguments.first()?.parse().ok().filter(|&n| n >= 1)?;
    let jump = match arguments.get(1).copied() {
        None | Some("end" | "jump-end") => Jump::End,
        Some("start" | "jump-start") => Jump::Start,
        Some("jump-none") if count > 1 => Jump::None,
        Some("jump-both") => Jump::Both,
        _ => return None,
    };
    Some(Easing::Steps { count, jump })
}

/// `linear(0, .6 20% 40%, 1)`: a share of the way each, with none, one or two shares of the time.
fn points(arguments: &[&str]) -> Option<Easing> {
    let mut points: Vec<(Option<f64>, f64)> = Vec::new();
    for argument in arguments {
        let (times, way): (Vec<&str>, Vec<&str>) =
            argument.split_whitespace().partition(|word| word.ends_with('%'));
        let [way] = way[..] else { return None };
        let way = way.parse().ok().filter(|w: &f64| w.is_finite())?;
        let number = |word: &&str| word.trim_end_matches('%').parse::<f64>().ok();
        let time = |word: &&str| number(word).filter(|p| p.is_finite()).map(|p| p / 100.0);
        match &times[..] {
            [] => points.push((None, way)),
            [_] | [_, _] => points.extend(times.iter().map(|word| (time(word), way))),
            _ => return None,
        }
    }
    let last = points.len().checked_sub(1).filter(|&last| last > 0)?;
    points[0].0.get_or_insert(0.0);
    points[last].0.get_or_insert(1.0);
    // What is missing is shared out evenly; time never runs back.
    let mut placed: Vec<(f64, f64)> = Vec::new();
    for (at, &(time, way)) in points.iter().enumerate() {
        let before = placed.last().map_or(f64::NEG_INFINITY, |&(time, _)| time);
        let time = time.unwrap_or_else(|| {
            let known = (at..).find(|&next| points[next].0.is_some()).unwrap_or(last);
            before + (points[known].0.unwrap_or(1.0).max(before) - before) / (known + 1 - at) as f64
        });
        placed.push((time.max(before), way));
    }
    Some(Easing::Points(placed))
}

/// y where the curve's x is `x`: x grows along the curve, so bisection finds the place.
fn bezier_at([x1, y1, x2, y2]: [f64; 4], x: f64) -> f64 {
    /// Halvings: more than a double's digits.
    const HALVINGS: usize = 60;
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    let along = |a: f64, b: f64, s: f64| {
        let r = 1.0 - s;
        3.0 * r * r * s * a + 3.0 * r * s * s * b + s * s * s
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if along(x1, x2, middle) < x {
            low = middle;
        } else {
            high = middle;
        }
    }
    along(y1, y2, 0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn css(text: &str, x: f64) -> f64 {
        Easing::from_css(text).unwrap().at(x)
    }

    #[test]
    fn curves_pass_where_css_says() {
        assert!((css("ease", 0.5) - 0.802_403).abs() < 1e-5);
        assert!((css("ease-in-out", 0.5) - 0.5).abs() < 1e-9);
        assert!((css("cubic-bezier(0, 0, 1, 1)", 0.3) - 0.3).abs() < 1e-9);
        assert_eq!(css("ease", 1.0), 1.0);
        assert_eq!(Easing::from_css("cubic-bezier(2, 0, 1, 1)"), None);
    }

    #[test]
    fn points_are_joined_by_straight_lines() {
        assert!((css("linear(0, 1)", 0.3) - 0.3).abs() < 1e-9);
        assert!((css("linear(0, .5 20% 40%, 1)", 0.1) - 0.25).abs() < 1e-9);
        assert_eq!(css("linear(0, .5 20% 40%, 1)", 0.3), 0.5);
        assert!((css("linear(0, .8, .2, 1)", 0.5) - 0.5).abs() < 1e-9);
        assert!((css("linear(0, 2 50%, 1 20%)", 0.75) - 1.0).abs() < 1e-9);
        assert_eq!(Easing::from_css("linear(1)"), None);
        assert_eq!(css("linear(0, 1 nan%, 0 inf%, 1)", 1.0), 1.0);
    }

    #[test]
    fn steps_jump_where_they_say() {
        let at = |text: &str| [0.0, 0.3, 0.5, 1.0].map(|x| css(text, x));
        assert_eq!(at("steps(2)"), [0.0, 0.0, 0.5, 1.0]);
        assert_eq!(at("steps(2, start)"), [0.5, 0.5, 1.0, 1.0]);
        assert_eq!(at("steps(2, jump-none)"), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(at("steps(3, jump-both)"), [0.25, 0.25, 0.5, 1.0]);
        assert_eq!(at("step-end"), [0.0, 0.0, 0.0, 1.0]);
    }
}
