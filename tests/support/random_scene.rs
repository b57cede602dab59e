//! Takes a seed, makes a small drawing of random shapes, paints and groups; the same on every machine.

use crate::support::Rng;

/// What the drawing may have besides flat shapes.
#[derive(Clone, Copy, Default)]
pub struct Kinds {
    pub opacity: bool,
    pub clips: bool,
    pub masks: bool,
    pub blends: bool,
    pub patterns: bool,
    /// So many shapes in front of the others blend with all behind them, each in a group of its own.
    pub stack: usize,
    /// So many shapes in front of the others are painted with one each.
    pub gradients: usize,
}

pub struct RandomScene {
    rng: Rng,
    kinds: Kinds,
    size: f64,
    definitions: String,
    count: usize,
}

const BLEND_MODES: [&str; 16] = [
    "multiply",
    "screen",
    "overlay",
    "darken",
    "lighten",
    "color-dodge",
    "color-burn",
    "hard-light",
    "soft-light",
    "difference",
    "exclusion",
    "hue",
    "saturation",
    "color",
    "luminosity",
    "plus-lighter",
];

impl RandomScene {
    pub fn new(seed: u64, kinds: Kinds, size: u32) -> RandomScene {
        let rng = Rng::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        RandomScene { rng, kinds, size: size.into(), definitions: String::new(), count: 0 }
    }

    pub fn svg(mut self) -> String {
        let mut body = String::new();
        for _ in 0..1 + self.below(6) {
            body += &self.node(0);
        }
        for _ in 0..self.kinds.stack {
            body += &self.blended();
        }
        for _ in 0..self.kinds.gradients {
            let fill = self.gradient();
            body += &self.shape(self.size, &format!("fill='{fill}'"));
        }
        let (size, definitions) = (self.size, self.definitions);
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='{size}' height='{size}'><defs>{definitions}</defs>{body}</svg>"
        )
    }

    fn below(&mut self, end: u64) -> u64 {
        self.rng.below(end)
    }

    /// A multiple of 1/100.
    fn real(&mut self, from: f64, to: f64) -> f64 {
        (self.rng.between(from, to) * 100.0).round() / 100.0
    }

    fn once_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    fn one_of<'a>(&mut self, all: &[&'a str]) -> &'a str {
        all[self.below(all.len() as u64) as usize]
    }

    fn color(&mut self) -> String {
        format!("#{:06x}", self.below(1 << 24))
    }

    fn define(&mut self, element: &str, attributes: &str, content: &str) -> String {
        self.count += 1;
        let id = format!("i{}", self.count);
        self.definitions += &format!("<{element} id='{id}' {attributes}>{content}</{element}>");
        format!("url(#{id})")
    }

    fn transform(&mut self) -> String {
        let middle = 0.5 * self.size;
        match self.below(4) {
            0 => format!("rotate({} {middle} {middle})", self.real(0.0, 360.0)),
            1 => format!("skewX({})", self.real(-40.0, 40.0)),
            2 => format!("scale({} {})", self.real(0.5, 1.5), self.real(0.5, 1.5)),
            _ => String::new(),
        }
    }

    /// A shape about a square of this size.
    fn shape(&mut self, size: f64, attributes: &str) -> String {
        let mut at = || self.real(-0.1 * size, 1.1 * size);
        let [a, b, c, d, e, f, g, h] = std::array::from_fn(|_| at());
        match self.below(4) {
            0 => format!("<rect x='{a}' y='{b}' width='{}' height='{}' {attributes}/>", c.abs(), d.abs()),
            1 => {
                format!(
                    "<ellipse cx='{a}' cy='{b}' rx='{}' ry='{}' {attributes}/>",
                    c.abs() / 2.0,
                    d.abs() / 2.0
                )
            }
            2 => format!("<path d='M{a} {b}L{c} {d}L{e} {f}L{g} {h}z' {attributes}/>"),
            _ => format!("<path d='M{a} {b}C{c} {d} {e} {f} {g} {h}z' {attributes}/>"),
        }
    }

    /// A shape or two that blend as one.
    fn blended(&mut self) -> String {
        let mode = self.one_of(&BLEND_MODES);
        let mut shapes = String::new();
        for _ in 0..1 + self.below(4) / 3 {
            let (fill, opacity) = (self.color(), [0.3, 1.0][self.below(2) as usize]);
            shapes += &self.shape(self.size, &format!("fill='{fill}' fill-opacity='{opacity}'"));
        }
        let opacity = [0.7, 1.0, 1.0][self.below(3) as usize];
        format!("<g style='mix-blend-mode:{mode}' opacity='{opacity}'>{shapes}</g>")
    }

    fn paint(&mut self) -> String {
        if self.kinds.patterns && self.once_in(3) {
            self.pattern()
        } else {
            self.color()
        }
    }

    fn pattern(&mut self) -> String {
        let (width, height) = (self.real(6.0, 30.0), self.real(6.0, 30.0));
        let mut content = String::new();
        for _ in 0..1 + self.below(2) {
            let fill = self.color();
            content += &self.shape(width.max(height), &format!("fill='{fill}'"));
        }
        let attributes = format!(
            "patternUnits='userSpaceOnUse' x='{}' y='{}' width='{width}' height='{height}' patternTransform='{}'",
            self.real(0.0, 20.0),
            self.real(0.0, 20.0),
            self.transform()
        );
        self.define("pattern", &attributes, &content)
    }

    fn gradient(&mut self) -> String {
        let mut offsets: Vec<f64> = (0..2 + self.below(3)).map(|_| self.real(0.0, 1.0)).collect();
        offsets.sort_by(f64::total_cmp);
        if offsets.len() > 2 && self.once_in(2) {
            // A jump.
            offsets[1] = offsets[2];
        }
        let mut stops = String::new();
        for offset in offsets {
            let (color, opacity) = (self.color(), self.real(0.2, 1.0));
            stops += &format!("<stop offset='{offset}' stop-color='{color}' stop-opacity='{opacity}'/>");
        }
        let spread = self.one_of(&["pad", "repeat", "reflect"]);
        let transform = self.transform();
        let common =
            format!("gradientUnits='userSpaceOnUse' spreadMethod='{spread}' gradientTransform='{transform}'");
        let size = self.size;
        let mut at = || self.real(0.0, size);
        let [x, y, toward_x, toward_y] = std::array::from_fn(|_| at());
        if self.once_in(2) {
            let place = format!("x1='{x}' y1='{y}' x2='{toward_x}' y2='{toward_y}'");
            return self.define("linearGradient", &format!("{common} {place}"), &stops);
        }
        let (radius, aside) = (self.real(6.0, 30.0), self.real(0.0, 0.8));
        let (fx, fy) = (x + 0.6 * aside * radius, y + 0.8 * aside * radius);
        let place = format!("cx='{x}' cy='{y}' r='{radius}' fx='{fx}' fy='{fy}'");
        self.define("radialGradient", &format!("{common} {place}"), &stops)
    }

    /// Attributes of what is composited as one.
    fn grouping(&mut self) -> String {
        let (size, mut attributes) = (self.size, String::new());
        if self.kinds.clips && self.once_in(4) {
            let shapes = self.shape(size, "") + &self.shape(size, "");
            attributes += &format!("clip-path='{}' ", self.define("clipPath", "", &shapes));
        }
        if self.kinds.masks && self.once_in(4) {
            let kind = self.one_of(&["luminance", "alpha"]);
            let (one, other) = (self.color(), self.color());
            let shapes = self.shape(size, &format!("fill='{one}'"))
                + &self.shape(size, &format!("fill='{other}' fill-opacity='.6'"));
            attributes +=
                &format!("mask='{}' ", self.define("mask", &format!("mask-type='{kind}'"), &shapes));
        }
        if self.kinds.blends && self.once_in(4) {
            attributes += &format!("style='mix-blend-mode:{}' ", self.one_of(&BLEND_MODES));
        }
        if self.kinds.opacity && self.once_in(3) {
            attributes += &format!("opacity='{}' ", self.real(0.2, 1.0));
        }
        attributes
    }

    fn node(&mut self, depth: usize) -> String {
        let grouping = self.grouping();
        if depth < 2 && self.once_in(3) {
            let mut children = String::new();
            for _ in 0..1 + self.below(3) {
                children += &self.node(depth + 1);
            }
            let transform = self.transform();
            return format!("<g {grouping} transform='{transform}'>{children}</g>");
        }
        let fill = self.paint();
        let mut attributes = format!("fill='{fill}' {grouping}");
        if self.kinds.opacity && self.once_in(3) {
            attributes += &format!("fill-opacity='{}' ", self.real(0.2, 1.0));
        }
        if self.once_in(4) {
            attributes += &format!("stroke='{}' stroke-width='{}' ", self.paint(), self.real(0.5, 6.0));
        }
        self.shape(self.size, &attributes)
    }
}
