//! Takes points, makes a plot as SVG: two logarithmic axes, a line a series, and for a cloud of methods
//! the Pareto front. The page styles it by its classes; [`Plot::standalone`] brings its own style, for
//! light and dark grounds.

use std::fmt::Write;

/// Room for the axes' labels.
const LEFT: f64 = 76.0;
const RIGHT: f64 = 34.0;
const TOP: f64 = 22.0;
const BOTTOM: f64 = 62.0;
/// Of a label's characters, on average.
const CHARACTER: f64 = 7.1;
const LINE: f64 = 16.0;
/// Colours of series, legible on light and on dark.
const COLOURS: usize = 8;

/// One point.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Across, above 0.
    pub x: f64,
    /// Up, above 0.
    pub y: f64,
    /// Written beside it.
    pub label: String,
    /// Shown when pointed at.
    pub title: String,
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// Written at the line's end; empty for a cloud of single points.
    pub name: String,
    /// In the order of the line.
    pub marks: Vec<Mark>,
}

/// What to draw.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Below the axis across.
    pub x_label: String,
    /// Beside the axis up.
    pub y_label: String,
    /// One line each; those without a name are clouds.
    pub series: Vec<Series>,
    /// Draw the line of points that no other betters in both.
    pub front: bool,
    /// For those who cannot see it.
    pub title: String,
    /// Width and height of the whole, in its own units; text is 13 high.
    pub size: (f64, f64),
}

/// Of standalone plots. Dark grounds are asked for by the reader's system.
const STYLE: &str = "text{font:13px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#24292f}\
.tick{fill:#57606a;font-size:12px}.axis{fill:#24292f}.grid{stroke:#8c959f;stroke-opacity:.28}.grid.minor{stroke-opacity:.12}\
.frame{fill:none;stroke:#8c959f;stroke-opacity:.6}.front{fill:none;stroke:#d9480f;stroke-width:2;stroke-dasharray:6 5;stroke-opacity:.75}\
.better{fill:#d9480f;fill-opacity:.07}.dot{stroke:#fff;stroke-width:1.5}.leader{stroke:#8c959f;stroke-opacity:.7}\
.line{fill:none;stroke-width:2}.halo{stroke:#fff;stroke-width:4;stroke-linejoin:round;paint-order:stroke}\
.s0{fill:#6e7781;stroke:#6e7781}.best{fill:#d9480f}\
@media(prefers-color-scheme:dark){text,.axis{fill:#e6edf3}.tick{fill:#9ea7b3}.dot,.halo{stroke:#0d1117}.front{stroke:#ff922b}\
.best{fill:#ff922b}.better{fill:#ff922b}}";

impl Plot {
    /// For a page that styles it.
    pub fn inline(&self) -> String {
        let ((width, height), title) = (self.size, escape(&self.title));
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">{}</svg>",
            self.body()
        )
    }

    /// A file of its own.
    pub fn standalone(&self) -> String {
        let (width, height) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\"><title>{}</title><style>{STYLE}</style>\n{}</svg>\n",
            escape(&self.title),
            self.body()
        )
    }

    fn body(&self) -> String {
        let marks = || self.series.iter().flat_map(|series| &series.marks);
        let (right, bottom) = (self.size.0 - RIGHT, self.size.1 - BOTTOM);
        let x = Axis::around(marks().map(|m| m.x), LEFT, right);
        let y = Axis::around(marks().map(|m| m.y), bottom, TOP);
        let mut out = String::new();
        self.grid(&x, &y, &mut out);
        let best = if self.front { front(marks()) } else { Vec::new() };
        if self.front {
            draw_front(&best, &x, &y, right, &mut out);
        }
        let mut labels = Labels::new(marks().map(|m| (x.place(m.x), y.place(m.y))).collect(), right, bottom);
        // Lines first, then points, then words, so that words stay legible.
        for (i, series) in self.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()) {
            let points: Vec<String> =
                series.marks.iter().map(|m| format!("{:.1},{:.1}", x.place(m.x), y.place(m.y))).collect();
            let _ = writeln!(
                out,
                "<polyline class=\"line s{}\" points=\"{}\"/>",
                i % COLOURS + 1,
                points.join(" ")
            );
        }
        let mut words = String::new();
        for (i, series) in self.series.iter().enumerate() {
            let last = series.marks.len().saturating_sub(1);
            for (k, mark) in series.marks.iter().enumerate() {
                let is_best = best.iter().any(|b| std::ptr::eq(*b, mark));
                let class = match (series.name.is_empty(), is_best) {
                    (true, true) => "best".to_string(),
                    (true, false) => "s0".to_string(),
                    _ => format!("s{}", i % COLOURS + 1),
                };
                let (px, py) = (x.place(mark.x), y.place(mark.y));
                let radius = if series.name.is_empty() { 6.0 } else { 4.0 };
                let _ = writeln!(
                    out,
                    "<circle class=\"dot {class}\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"{radius}\"><title>{}</title></circle>",
                    escape(&mark.title)
                );
                let text = if k == last && !series.name.is_empty() {
                    format!("{} {}", series.name, mark.label)
                } else {
                    mark.label.clone()
                };
                labels.write(&text, px, py, k == last && !series.name.is_empty(), &mut words);
            }
        }
        out + &words
    }

    fn grid(&self, x: &Axis, y: &Axis, out: &mut String) {
        let (right, bottom) = (self.size.0 - RIGHT, self.size.1 - BOTTOM);
        for (value, named) in x.ticks() {
            let at = x.place(value);
            let minor = if value.log10().fract().abs() < 1e-9 { "" } else { " minor" };
            let _ = writeln!(out, "<path class=\"grid{minor}\" d=\"M{at:.1} {TOP}V{bottom}\"/>");
            if named {
                let y = bottom + 20.0;
                let _ = writeln!(
                    out,
                    "<text class=\"tick\" x=\"{at:.1}\" y=\"{y}\" text-anchor=\"middle\">{}</text>",
                    short(value)
                );
            }
        }
        for (value, named) in y.ticks() {
            let at = y.place(value);
            let minor = if value.log10().fract().abs() < 1e-9 { "" } else { " minor" };
            let _ = writeln!(out, "<path class=\"grid{minor}\" d=\"M{LEFT} {at:.1}H{right}\"/>");
            if named {
                let (x, y) = (LEFT - 10.0, at + 4.0);
                let _ = writeln!(
                    out,
                    "<text class=\"tick\" x=\"{x}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>",
                    short(value)
                );
            }
        }
        let (width, height) = (right - LEFT, bottom - TOP);
        let _ = writeln!(
            out,
            "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\"/>"
        );
        let (middle, below) = (LEFT + width / 2.0, self.size.1 - 14.0);
        let _ = writeln!(
            out,
            "<text class=\"axis\" x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">{}</text>",
            escape(&self.x_label)
        );
        let middle = TOP + height / 2.0;
        let _ = writeln!(
            out,
            "<text class=\"axis\" transform=\"translate(20 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escape(&self.y_label)
        );
    }
}

/// A logarithmic axis.
struct Axis {
    /// Logarithms to base 10 of the ends.
    from: f64,
    to: f64,
    /// Where the ends lie.
    start: f64,
    end: f64,
}

impl Axis {
    /// With a tenth of the whole to spare on each side.
    fn around(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Axis {
        let (low, high) = values
            .map(f64::log10)
            .filter(|v| v.is_finite())
            .fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let spare = ((high - low) * 0.1).max(0.12);
        Axis { from: low - spare, to: high + spare, start, end }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (value.log10() - self.from) / (self.to - self.from);
        self.start + share.clamp(0.0, 1.0) * (self.end - self.start)
    }

    /// Values with a line, and whether they are written, too: powers of ten, and digits between them as
    /// there is room.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let decades = self.to - self.from;
        let (drawn, named): (&[u32], &[u32]) = match decades {
            d if d < 0.6 => (&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 3, 4, 5, 6, 8]),
            d if d < 2.2 => (&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 5]),
            d if d < 4.0 => (&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 3]),
            _ => (&[1], &[1]),
        };
        let powers = self.from.floor() as i32..=self.to.ceil() as i32;
        let all = powers.flat_map(|power| drawn.iter().map(move |&digit| (digit, power)));
        all.map(|(digit, power)| (f64::from(digit) * 10f64.powi(power), named.contains(&digit)))
            .filter(|(value, _)| (self.from..=self.to).contains(&value.log10()))
            .collect()
    }
}

/// The marks that no other betters in both, from the fastest on.
fn front<'a>(marks: impl Iterator<Item = &'a Mark>) -> Vec<&'a Mark> {
    let mut all: Vec<&Mark> = marks.collect();
    all.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut best: Vec<&Mark> = Vec::new();
    for mark in all {
        if best.last().is_none_or(|last| mark.y < last.y) {
            best.push(mark);
        }
    }
    best
}

/// A staircase: all above and right of it is bettered by a point on it.
fn draw_front(best: &[&Mark], x: &Axis, y: &Axis, right: f64, out: &mut String) {
    let Some(first) = best.first() else { return };
    let mut path = format!("M{:.1} {TOP}V{:.1}", x.place(first.x), y.place(first.y));
    for mark in &best[1..] {
        let _ = write!(path, "H{:.1}V{:.1}", x.place(mark.x), y.place(mark.y));
    }
    let _ = writeln!(out, "<path class=\"better\" d=\"{path}H{right}V{TOP}Z\"/>");
    let _ = writeln!(out, "<path class=\"front\" d=\"{path}H{right}\"/>");
}

/// Labels placed so far; each goes where it covers nothing.
struct Labels {
    dots: Vec<(f64, f64)>,
    taken: Vec<[f64; 4]>,
    right: f64,
    bottom: f64,
}

impl Labels {
    fn new(dots: Vec<(f64, f64)>, right: f64, bottom: f64) -> Labels {
        Labels { dots, taken: Vec::new(), right, bottom }
    }

    /// Writes `text` beside (x, y). A label that finds no room is left out unless `must`.
    fn write(&mut self, text: &str, x: f64, y: f64, must: bool, out: &mut String) {
        let width = text.chars().count() as f64 * CHARACTER;
        // Offset of the box's nearer side and of its middle line, and which side of the dot it is on.
        let right = |dx: f64, dy: f64| (x + dx, y + dy);
        let left = |dx: f64, dy: f64| (x - dx - width, y + dy);
        let middle = |dy: f64| (x - width / 2.0, y + dy);
        let mut places = vec![right(11.0, 0.0), left(11.0, 0.0), middle(-17.0), middle(17.0)];
        for distance in [1.0, 1.8, 2.7, 3.7] {
            for (dx, dy) in [(9.0, -13.0), (9.0, 13.0)] {
                places.push(right(dx * distance, dy * distance));
                places.push(left(dx * distance, dy * distance));
            }
            places.push(middle(-17.0 * distance));
            places.push(middle(17.0 * distance));
        }
        let boxes =
            |&(left, middle): &(f64, f64)| [left, middle - LINE / 2.0, left + width, middle + LINE / 2.0];
        let free = places.iter().map(boxes).find(|b| self.is_free(b, (x, y)));
        let Some(found) = free.or_else(|| must.then(|| boxes(&places[0]))) else { return };
        let (from, middle) = (found[0], (found[1] + found[3]) / 2.0);
        let (nearest_x, nearest_y) = (x.clamp(found[0], found[2]), y.clamp(found[1], found[3]));
        if (nearest_x - x).hypot(nearest_y - y) > 13.0 {
            let _ =
                writeln!(out, "<path class=\"leader\" d=\"M{x:.1} {y:.1}L{nearest_x:.1} {nearest_y:.1}\"/>");
        }
        let _ = writeln!(
            out,
            "<text class=\"halo\" x=\"{from:.1}\" y=\"{:.1}\">{}</text>",
            middle + 4.5,
            escape(text)
        );
        self.taken.push(found);
    }

    fn is_free(&self, b: &[f64; 4], own: (f64, f64)) -> bool {
        let inside = b[0] > LEFT && b[2] < self.right + 24.0 && b[1] > TOP && b[3] < self.bottom;
        let apart = |t: &[f64; 4]| b[2] < t[0] || t[2] < b[0] || b[3] < t[1] || t[3] < b[1];
        let clear = |&(x, y): &(f64, f64)| {
            (x, y) == own || x < b[0] - 7.0 || x > b[2] + 7.0 || y < b[1] - 6.0 || y > b[3] + 6.0
        };
        inside && self.taken.iter().all(apart) && self.dots.iter().all(clear)
    }
}

/// A number in few characters.
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_string(),
        v if v >= 99.5 => format!("{value:.0}"),
        v if v >= 9.95 => trimmed(format!("{value:.1}")),
        v if v >= 0.995 => trimmed(format!("{value:.2}")),
        v if v >= 0.0995 => trimmed(format!("{value:.3}")),
        v if v >= 0.00995 => trimmed(format!("{value:.4}")),
        _ => format!("{value:.0e}"),
    }
}

fn trimmed(text: String) -> String {
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// For text and attributes of XML and HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(x: f64, y: f64) -> Mark {
        Mark { x, y, label: format!("{x}<&{y}"), title: String::new() }
    }

    #[test]
    fn the_front_holds_what_no_other_betters() {
        let marks = [mark(1.0, 9.0), mark(2.0, 4.0), mark(3.0, 5.0), mark(2.0, 7.0), mark(8.0, 1.0)];
        let best: Vec<_> = front(marks.iter()).iter().map(|m| (m.x, m.y)).collect();
        assert_eq!(best, [(1.0, 9.0), (2.0, 4.0), (8.0, 1.0)]);
    }

    #[test]
    fn a_plot_is_an_svg_that_can_be_read() {
        let cloud = Series {
            name: String::new(),
            marks: (1..20).map(|i| mark(f64::from(i), 0.3 / f64::from(i))).collect(),
        };
        let plot = Plot {
            x_label: "a < b".into(),
            y_label: "e".into(),
            series: vec![cloud],
            front: true,
            title: "t & t".into(),
            size: (600.0, 400.0),
        };
        let svg = plot.standalone();
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
        assert_eq!((tree.size().width(), tree.size().height()), (600.0, 400.0));
    }

    #[test]
    fn a_plot_of_one_point_has_room_around_it() {
        let axis = Axis::around([5.0].into_iter(), 0.0, 100.0);
        assert_eq!(axis.place(5.0), 50.0);
        assert!(axis.ticks().iter().any(|(_, named)| *named));
    }

    #[test]
    fn numbers_are_short() {
        let shorts: Vec<String> =
            [0.0, 0.5, 12.0, 1234.5, 0.001, 0.02, 2.71929].iter().map(|&v| short(v)).collect();
        assert_eq!(shorts, ["0", "0.5", "12", "1234", "1e-3", "0.02", "2.72"]);
    }
}
