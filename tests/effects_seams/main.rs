//! No seam through an effect: shapes that abut under one effect, beside their complement, or across a
//! group's border, held against the analytic area of every region at many angles and offsets.

mod blends;
mod clips_and_masks;
mod filters;
mod gradients;
mod groups;

use toon_raster::{Options, Pixmap, Renderer, Scene, Settings, Viewport};

const SIDE: u32 = 12;

/// 8-bit levels that a premultiplied component may be off by: half a level of rounding, once in colour and
/// once in alpha, and a quarter in the mean.
const TOLERANCE: f64 = 1.25;

fn render(body: &str) -> Pixmap {
    let svg = format!("<svg xmlns='http://www.w3.org/2000/svg' width='{SIDE}' height='{SIDE}'>{body}</svg>");
    let scene = Scene::from_bytes(svg.as_bytes(), &Options::default()).expect("a drawing");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    let mut renderer = Renderer::new(Settings { threads: 1, ..Settings::default() }).expect("a renderer");
    renderer.render(&scene, &Viewport::fit(&scene, SIDE, SIDE)).expect("a picture")
}

type Point = (f64, f64);

/// A straight border across the picture. A point is inside where its distance is not negative.
#[derive(Clone, Copy)]
struct Border {
    a: f64,
    b: f64,
    c: f64,
}

impl Border {
    /// Turned by an angle in degrees, `off` pixels from the picture's middle.
    fn new(degrees: f64, off: f64) -> Border {
        let (b, a) = degrees.to_radians().sin_cos();
        let middle = f64::from(SIDE) / 2.0;
        Border { a, b, c: -(a + b) * middle - off }
    }

    fn distance(self, (x, y): Point) -> f64 {
        self.a * x + self.b * y + self.c
    }

    fn reversed(self) -> Border {
        Border { a: -self.a, b: -self.b, c: -self.c }
    }

    /// Path data of the half of a large square that lies inside, as coordinates which both halves share.
    fn half(self) -> String {
        let far = 40.0;
        let square = [(-far, -far), (far, -far), (far, far), (-far, far)];
        let corners = cut(&square, self);
        let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x:.4} {y:.4}")).collect();
        format!("M{}z", points.join("L"))
    }
}

/// The part of a convex polygon on a border's inside. The crossing is found from the same end whichever
/// way the border runs.
fn cut(polygon: &[Point], border: Border) -> Vec<Point> {
    let mut inside = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (dp, dq) = (border.distance(p), border.distance(q));
        if dp >= 0.0 {
            inside.push(p);
        }
        if (dp >= 0.0) != (dq >= 0.0) {
            let t = dp / (dp - dq);
            inside.push((p.0 + (q.0 - p.0) * t, p.1 + (q.1 - p.1) * t));
        }
    }
    inside
}

fn area(polygon: &[Point]) -> f64 {
    let next = |i: usize| polygon[(i + 1) % polygon.len()];
    0.5 * (0..polygon.len()).map(|i| polygon[i].0 * next(i).1 - next(i).0 * polygon[i].1).sum::<f64>()
}

/// Premultiplied, 0 ..= 1.
type Color = [f64; 4];

/// The mean over one pixel, where the colour depends only on the sides of some borders.
fn truth(
    pixel: Vec<Point>,
    borders: &[Border],
    sides: &mut Vec<bool>,
    color: &dyn Fn(&[bool]) -> Color,
) -> Color {
    let Some((&border, rest)) = borders.split_first() else {
        return color(sides).map(|v| v * area(&pixel));
    };
    let mut sum = [0.0; 4];
    for (side, border) in [(true, border), (false, border.reversed())] {
        sides.push(side);
        let part = truth(cut(&pixel, border), rest, sides, color);
        sides.pop();
        (0..4).for_each(|i| sum[i] += part[i]);
    }
    sum
}

/// Renders a drawing made of the two halves at a border, at many angles and offsets, and holds it against
/// the colour of each side of this border, and of a second one that lies across.
#[track_caller]
fn assert_exact(drawing: impl Fn(&str, &str, &str) -> String, color: impl Fn(&[bool]) -> Color) {
    assert_exact_within(TOLERANCE, drawing, color);
}

#[track_caller]
fn assert_exact_within(
    tolerance: f64,
    drawing: impl Fn(&str, &str, &str) -> String,
    color: impl Fn(&[bool]) -> Color,
) {
    let mut worst = (0.0f64, String::new());
    for (degrees, off) in places() {
        let border = Border::new(degrees, off);
        let across = Border::new(degrees * 0.37 + 71.0, off * 0.5 + 0.21);
        let body = drawing(&border.half(), &border.reversed().half(), &across.half());
        let picture = render(&body);
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let (left, top) = (f64::from(x), f64::from(y));
            let square = vec![(left, top), (left + 1.0, top), (left + 1.0, top + 1.0), (left, top + 1.0)];
            let expected = truth(square, &[border, across], &mut Vec::new(), &color);
            let [r, g, b, a] = picture.pixel(x, y).map(f64::from);
            let found = [r * a / 255.0, g * a / 255.0, b * a / 255.0, a];
            for (found, expected) in found.iter().zip(expected) {
                let off_by = (found - 255.0 * expected).abs();
                if off_by > worst.0 {
                    let expected = 255.0 * expected;
                    worst = (
                        off_by,
                        format!(
                            "{degrees}°, {off} px, pixel ({x}, {y}): {found:.1} is not {expected:.1}\n{body}"
                        ),
                    );
                }
            }
        }
    }
    assert!(worst.0 <= tolerance, "off by {:.2} levels: {}", worst.0, worst.1);
}

/// Angles in degrees and offsets in pixels: along the axes, nearly so, and in between.
fn places() -> Vec<(f64, f64)> {
    let angles = [0.0, 0.7, 14.0, 33.0, 45.0, 62.0, 89.5, 90.0, 117.0, 151.0, 201.0, 263.0, 307.0];
    let offsets = [0.0, 0.13, 0.25, 0.5, 0.71, -1.9];
    angles.iter().flat_map(|&angle| offsets.map(|off| (angle, off))).collect()
}

const RED: Color = [1.0, 0.0, 0.0, 1.0];
const BLUE: Color = [0.0, 0.0, 1.0, 1.0];
const WHITE: Color = [1.0; 4];
const CLEAR: Color = [0.0; 4];

fn mixed(one: Color, other: Color, share: f64) -> Color {
    std::array::from_fn(|i| one[i] * (1.0 - share) + other[i] * share)
}

fn fade(color: Color, share: f64) -> Color {
    color.map(|v| v * share)
}

fn over(front: Color, behind: Color) -> Color {
    std::array::from_fn(|i| front[i] + (1.0 - front[3]) * behind[i])
}

/// A red half beside a blue one.
fn halves(a: &str, b: &str) -> String {
    format!("<path d='{a}' fill='#f00'/><path d='{b}' fill='#00f'/>")
}

fn of_halves(sides: &[bool]) -> Color {
    if sides[0] {
        RED
    } else {
        BLUE
    }
}

const PAPER: &str = "<rect width='12' height='12' fill='#fff'/>";

/// Holds a shape that has this attribute, and its neighbour that has not, whichever is in front.
fn assert_neighbours_are_exact(definitions: &str, attribute: &str) {
    for order in [false, true] {
        assert_exact(
            |a, b, _| {
                let grouped = format!("<path d='{a}' fill='#f00' {attribute}/>");
                let plain = format!("<path d='{b}' fill='#00f'/>");
                match order {
                    false => format!("{PAPER}{definitions}{grouped}{plain}"),
                    true => format!("{PAPER}{definitions}{plain}{grouped}"),
                }
            },
            of_halves,
        );
    }
}
