//! Takes two CSS or SVG transform lists and a share, makes the transform between them as one matrix.
//! After CSS Transforms 1, 11–13: equal lists are mixed function by function, others as decomposed
//! matrices.

use super::cascade::Cascade;
use super::value::Short;
use kurbo::Affine;
use usvg::roxmltree::Node;

/// What lengths of a CSS transform refer to.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    /// `transform-box: fill-box` (or `content-box`, the same in SVG).
    fill_box: bool,
    /// `transform-origin` as given.
    origin: String,
    /// x, y, width and height that percentages refer to, in user units.
    reference: [f64; 4],
}

impl Frame {
    pub(super) fn of<'a>(node: Node<'a, 'a>, cascade: &Cascade<'a>) -> Frame {
        let declared = |name: &str| cascade.declared(node, name).or_else(|| node.attribute(name));
        let fill_box = matches!(declared("transform-box"), Some("fill-box" | "content-box" | "stroke-box"));
        let origin = declared("transform-origin").unwrap_or("").to_string();
        let svg = node.ancestors().skip(1).find(|n| n.tag_name().name() == "svg");
        let number = |text: &str| text.trim().trim_end_matches("px").parse::<f64>().ok();
        let side = |name: &str, index: usize| {
            let svg = svg?;
            let view_box = svg.attribute("viewBox");
            let parts = view_box.map(|v| v.split([' ', ',', '\t', '\n']).filter(|n| !n.is_empty()));
            parts.and_then(|mut p| number(p.nth(index)?)).or_else(|| number(svg.attribute(name)?))
        };
        let reference = [0.0, 0.0, side("width", 2).unwrap_or(0.0), side("height", 3).unwrap_or(0.0)];
        Frame { fill_box, origin, reference }
    }

    /// Whether [`Frame::set_box`] is to be called.
    pub(super) fn needs_box(&self) -> bool {
        self.fill_box
    }

    /// The element's own box: x, y, width, height.
    pub(super) fn set_box(&mut self, reference: [f64; 4]) {
        self.reference = reference;
    }

    /// The origin where the parser would not know it.
    pub(super) fn origin(&self) -> Option<String> {
        let words: Vec<&str> = self.origin.split_whitespace().collect();
        let [x, y, width, height] = self.reference;
        // Keywords may stand in either order; alone, the other is the centre.
        let (first, second) = match words[..] {
            [] => ("50%", "50%"),
            [only @ ("top" | "bottom")] => ("50%", only),
            [only] => (only, "50%"),
            [first @ ("top" | "bottom"), second, ..] => (second, first),
            [first, second, ..] => (first, second),
        };
        let place = |word: &str, start: f64, size: f64| match word {
            "left" | "top" => Some(start),
            "center" => Some(start + 0.5 * size),
            "right" | "bottom" => Some(start + size),
            word => length(word, size).map(|offset| start + offset),
        };
        let (x, y) = (place(first, x, width)?, place(second, y, height)?);
        self.fill_box.then(|| format!("{}px {}px", Short(x), Short(y)))
    }
}

/// A transform function with its numbers: user units, degrees or plain factors.
#[derive(Clone, Debug, PartialEq)]
struct Function {
    name: &'static str,
    numbers: Vec<f64>,
}

/// The transform at `share` of the way, as it stands in an attribute; a jump where a list is not known.
pub(super) fn mix(from: &str, to: &str, share: f64, frame: &Frame) -> String {
    let (Some(mut a), Some(mut b)) = (parse(from, frame), parse(to, frame)) else {
        return if share < 0.5 { from } else { to }.to_string();
    };
    // `none` is the identity of whatever the other list has.
    if a.is_empty() {
        a = b.iter().map(Function::identity).collect();
    } else if b.is_empty() {
        b = a.iter().map(Function::identity).collect();
    }
    let alike = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.name == b.name && a.name != "matrix");
    let matrix = if alike {
        let pairs = a.iter().zip(&b).map(|(a, b)| {
            let numbers = a.numbers.iter().zip(&b.numbers).map(|(a, b)| a + (b - a) * share);
            Function { name: a.name, numbers: numbers.collect() }
        });
        pairs.fold(Affine::IDENTITY, |whole, function| whole * function.matrix())
    } else {
        let whole = |list: &[Function]| list.iter().fold(Affine::IDENTITY, |m, f| m * f.matrix());
        mix_matrices(whole(&a), whole(&b), share)
    };
    let numbers = matrix.as_coeffs().map(|n| Short(n).to_string());
    format!("matrix({})", numbers.join(" "))
}

/// A transform as it stands in an attribute: without units.
pub(super) fn still(transform: &str, frame: &Frame) -> String {
    mix(transform, transform, 0.0, frame)
}

impl Function {
    fn identity(&self) -> Function {
        let neutral = match self.name {
            "scale" => vec![1.0; 2],
            "matrix" => vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            "rotate" => vec![0.0, self.numbers[1], self.numbers[2]],
            _ => vec![0.0; self.numbers.len()],
        };
        Function { name: self.name, numbers: neutral }
    }

    fn matrix(&self) -> Affine {
        let n = &self.numbers;
        match self.name {
            "translate" => Affine::translate((n[0], n[1])),
            "scale" => Affine::scale_non_uniform(n[0], n[1]),
            "rotate" => Affine::rotate_about(n[0].to_radians(), (n[1], n[2])),
            "skew" => Affine::new([1.0, n[1].to_radians().tan(), n[0].to_radians().tan(), 1.0, 0.0, 0.0]),
            _ => Affine::new([n[0], n[1], n[2], n[3], n[4], n[5]]),
        }
    }
}

fn parse(text: &str, frame: &Frame) -> Option<Vec<Function>> {
    let text = text.trim();
    if text.is_empty() || text == "none" {
        return Some(Vec::new());
    }
    let mut list = Vec::new();
    for part in text.split_inclusive(')') {
        let part = part.trim().trim_start_matches(',');
        let (name, arguments) = part.strip_suffix(')')?.split_once('(')?;
        let words = arguments.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
        list.push(function(name.trim(), &words.collect::<Vec<_>>(), frame)?);
    }
    Some(list)
}

fn function(name: &str, words: &[&str], frame: &Frame) -> Option<Function> {
    let [.., width, height] = frame.reference;
    let x = |i: usize| words.get(i).map_or(Some(0.0), |w| length(w, width));
    let y = |i: usize| words.get(i).map_or(Some(0.0), |w| length(w, height));
    let factor = |i: usize| match words.get(i)?.strip_suffix('%') {
        Some(percent) => percent.parse::<f64>().ok().map(|p| p / 100.0),
        None => words[i].parse().ok(),
    };
    let turn = |i: usize| words.get(i).map_or(Some(0.0), |w| degrees(w));
    let (name, numbers) = match (name, words.len()) {
        ("translate", 1..=2) | ("translate3d", 3) => ("translate", vec![x(0)?, y(1)?]),
        ("translateX", 1) => ("translate", vec![x(0)?, 0.0]),
        ("translateY", 1) => ("translate", vec![0.0, y(0)?]),
        ("scale", 1) => ("scale", vec![factor(0)?; 2]),
        ("scale", 2) | ("scale3d", 3) => ("scale", vec![factor(0)?, factor(1)?]),
        ("scaleX", 1) => ("scale", vec![factor(0)?, 1.0]),
        ("scaleY", 1) => ("scale", vec![1.0, factor(0)?]),
        ("rotate" | "rotateZ", 1) => ("rotate", vec![turn(0)?, 0.0, 0.0]),
        ("rotate", 3) => ("rotate", vec![turn(0)?, x(1)?, y(2)?]),
        ("skew", 1..=2) => ("skew", vec![turn(0)?, turn(1)?]),
        ("skewX", 1) => ("skew", vec![turn(0)?, 0.0]),
        ("skewY", 1) => ("skew", vec![0.0, turn(0)?]),
        ("matrix", 6) => ("matrix", (0..6).map(|i| words[i].parse().ok()).collect::<Option<_>>()?),
        _ => return None,
    };
    Some(Function { name, numbers })
}

/// A length in user units; `whole` is what percentages are of.
fn length(word: &str, whole: f64) -> Option<f64> {
    if let Some(percent) = word.strip_suffix('%') {
        return percent.parse::<f64>().ok().map(|p| p / 100.0 * whole);
    }
    word.strip_suffix("px").unwrap_or(word).parse().ok()
}

fn degrees(word: &str) -> Option<f64> {
    for (unit, factor) in
        [("deg", 1.0), ("grad", 0.9), ("rad", 180.0 / std::f64::consts::PI), ("turn", 360.0)]
    {
        if let Some(number) = word.strip_suffix(unit) {
            return number.parse::<f64>().ok().map(|n| n * factor);
        }
    }
    word.parse().ok()
}

/// Translation, scale, angle and the rest of a matrix, mixed one by one.
fn mix_matrices(a: Affine, b: Affine, share: f64) -> Affine {
    let (mut a, mut b) = (Parts::of(a), Parts::of(b));
    // A mirrored axis is a half turn the other way.
    if (a.scale[0] < 0.0 && b.scale[1] < 0.0) || (a.scale[1] < 0.0 && b.scale[0] < 0.0) {
        a.scale = a.scale.map(|s| -s);
        a.angle += if a.angle < 0.0 { 180.0 } else { -180.0 };
    }
    // The short way round.
    if (a.angle - b.angle).abs() > 180.0 {
        let larger = if a.angle > b.angle { &mut a.angle } else { &mut b.angle };
        *larger -= 360.0;
    }
    let between = |a: f64, b: f64| a + (b - a) * share;
    let two = |a: [f64; 2], b: [f64; 2]| [between(a[0], b[0]), between(a[1], b[1])];
    let rest: [f64; 4] = std::array::from_fn(|i| between(a.rest[i], b.rest[i]));
    let (place, scale) = (two(a.place, b.place), two(a.scale, b.scale));
    Affine::translate((place[0], place[1]))
        * Affine::new([rest[0], rest[1], rest[2], rest[3], 0.0, 0.0])
        * Affine::rotate(between(a.angle, b.angle).to_radians())
        * Affine::scale_non_uniform(scale[0], scale[1])
}

struct Parts {
    place: [f64; 2],
    scale: [f64; 2],
    /// Degrees.
    angle: f64,
    /// What is left once scale and turn are taken off: a skew.
    rest: [f64; 4],
}

impl Parts {
    /// CSS Transforms 1, 12.1.1, "decomposing a 2D matrix".
    fn of(matrix: Affine) -> Parts {
        let [a, b, c, d, e, f] = matrix.as_coeffs();
        let mut scale = [a.hypot(b), c.hypot(d)];
        if a * d - b * c < 0.0 {
            // The axis that is nearer to being turned round is mirrored.
            scale[usize::from(a >= d)] *= -1.0;
        }
        let unit = |x: f64, s: f64| if s == 0.0 { x } else { x / s };
        let (a, b, c, d) = (unit(a, scale[0]), unit(b, scale[0]), unit(c, scale[1]), unit(d, scale[1]));
        let angle = b.atan2(a);
        let [a, b, c, d, ..] = (Affine::new([a, b, c, d, 0.0, 0.0]) * Affine::rotate(-angle)).as_coeffs();
        Parts { place: [e, f], scale, angle: angle.to_degrees(), rest: [a, b, c, d] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_lists_mix_function_by_function() {
        let frame = Frame { reference: [0.0, 0.0, 200.0, 100.0], ..Frame::default() };
        let half = |a: &str, b: &str| mix(a, b, 0.5, &frame);
        assert_eq!(half("translateX(10px)", "translateX(30px)"), "matrix(1 0 0 1 20 0)");
        assert_eq!(half("translate(10%, 10%)", "none"), "matrix(1 0 0 1 10 5)");
        assert_eq!(half("rotate(0deg)", "rotate(1turn)"), "matrix(-1 0 0 -1 0 0)");
        assert_eq!(half("none", "scale(3, 1)"), "matrix(2 0 0 1 0 0)");
        assert_eq!(half("rotate(0 5 5)", "rotate(180 5 5)"), "matrix(0 1 -1 0 10 0)");
    }

    #[test]
    fn other_lists_mix_as_matrices() {
        let half = |a: &str, b: &str| mix(a, b, 0.5, &Frame::default());
        assert_eq!(half("rotate(90deg)", "translate(8px) rotate(0deg) scale(2)"), {
            let s = 1.5 * std::f64::consts::FRAC_1_SQRT_2;
            format!("matrix({0} {0} -{0} {0} 4 0)", Short(s))
        });
    }
}
