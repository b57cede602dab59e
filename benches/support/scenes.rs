//! Makes the drawings that are timed, as SVG text on a square of 1000 x 1000 user units.
//!
//! They need no files: the same text comes out everywhere. Each stresses one thing; the notes in
//! [`SCENES`] say what.

use super::random::Random;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// A drawing with the name that the tables use.
pub struct Drawing {
    pub name: String,
    pub svg: Vec<u8>,
}

/// Makes a scene's SVG text.
type Maker = fn() -> String;

/// Name and maker of each scene, in the tables' order.
const SCENES: [(&str, Maker); 8] = [
    ("tiger", tiger),             // 203 shapes of many curves, half of them stroked, layered
    ("emoji", emoji),             // 64 small pictures: short curves, no strokes
    ("map", map),                 // 3,000 regions which share fractal borders exactly
    ("mesh", mesh),               // 20,000 triangles, every edge shared
    ("blobs-300", blobs_300),     // opaque, outlined, some 6 layers deep
    ("blobs-3000", blobs_3000),   // the same, some 25 layers deep
    ("translucent", translucent), // 300 blobs at half opacity: nothing hides anything
    ("world", world),             // 100,000 segments of stroked coast
];

/// Every generated scene.
pub fn all() -> Vec<Drawing> {
    SCENES
        .iter()
        .map(|(name, make)| Drawing { name: (*name).to_string(), svg: make().into_bytes() })
        .collect()
}

type Point = (f64, f64);

const OPEN: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 1000">"#;
const CLOSE: &str = "</svg>\n";

/// A closed smooth curve through `points` (Catmull-Rom, as cubic Béziers), as path data.
fn smooth(points: &[Point]) -> String {
    let n = points.len();
    let at = |i: usize| points[i % n];
    let mut d = format!("M{:.2} {:.2}", at(0).0, at(0).1);
    for i in 0..n {
        let (before, from, to, after) = (at(i + n - 1), at(i), at(i + 1), at(i + 2));
        let c1 = (from.0 + (to.0 - before.0) / 6.0, from.1 + (to.1 - before.1) / 6.0);
        let c2 = (to.0 - (after.0 - from.0) / 6.0, to.1 - (after.1 - from.1) / 6.0);
        write!(d, "C{:.2} {:.2} {:.2} {:.2} {:.2} {:.2}", c1.0, c1.1, c2.0, c2.1, to.0, to.1)
            .expect("a string takes all");
    }
    d + "Z"
}

/// A wobbly ring of `count` points around `centre`.
fn ring(random: &mut Random, centre: Point, radius: Point, wobble: f64, count: usize) -> Vec<Point> {
    let turn = random.within(0.0, TAU);
    (0..count)
        .map(|i| {
            let angle = turn + TAU * i as f64 / count as f64;
            let r = 1.0 + random.within(-wobble, wobble);
            (centre.0 + radius.0 * r * angle.cos(), centre.1 + radius.1 * r * angle.sin())
        })
        .collect()
}

/// Halves each part of a line again and again, moving the middles sideways: a coast from `a` to `b`
/// of 2^`depth` parts, without its last point. The caller stores it once, so that two neighbours
/// share it exactly.
fn coast(random: &mut Random, a: Point, b: Point, depth: u32, roughness: f64) -> Vec<Point> {
    if depth == 0 {
        return vec![a];
    }
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let shift = random.within(-roughness, roughness);
    let middle = (a.0 + dx / 2.0 - dy * shift, a.1 + dy / 2.0 + dx * shift);
    let mut points = coast(random, a, middle, depth - 1, roughness);
    points.extend(coast(random, middle, b, depth - 1, roughness));
    points
}

/// Straight path data through `points`, to `digits` decimals.
fn polygon(points: &[Point], digits: usize) -> String {
    let mut d = String::with_capacity(points.len() * 12);
    for (i, (x, y)) in points.iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        write!(d, "{letter}{x:.digits$} {y:.digits$}").expect("a string takes all");
    }
    d + "Z"
}

fn shape(svg: &mut String, data: &str, attributes: &str) {
    writeln!(svg, r#"<path d="{data}" {attributes}/>"#).expect("a string takes all");
}

/// A striped cat's head: big soft shapes, tufts of fur, some 100 tapered stripes, whiskers; no
/// background, as the well-known tiger has none.
fn tiger() -> String {
    let mut random = Random::new(1);
    let mut svg = String::from(OPEN);
    let outline = r##"stroke="#2b1608" stroke-width="3""##;
    for side in [-1.0, 1.0] {
        for (size, fill) in [(150.0, "#d97a1e"), (110.0, "#f2c28b"), (70.0, "#8a4a3a")] {
            let points = ring(&mut random, (500.0 + side * 290.0, 230.0), (size, size), 0.06, 9);
            shape(&mut svg, &smooth(&points), &format!(r#"fill="{fill}" {outline}"#));
        }
    }
    for (centre, radius, fill) in [
        ((500.0, 520.0), (400.0, 400.0), "#e88b25"),
        ((500.0, 560.0), (340.0, 330.0), "#f3a445"),
        ((330.0, 660.0), (170.0, 150.0), "#fbe6c6"),
        ((670.0, 660.0), (170.0, 150.0), "#fbe6c6"),
        ((500.0, 800.0), (180.0, 110.0), "#fff5e4"),
        ((500.0, 420.0), (110.0, 220.0), "#f7bc6e"),
    ] {
        let points = ring(&mut random, centre, radius, 0.05, 16);
        shape(&mut svg, &smooth(&points), &format!(r#"fill="{fill}" {outline}"#));
    }
    fur(&mut svg, &mut random);
    stripes(&mut svg, &mut random);
    eyes_and_nose(&mut svg, &mut random);
    whiskers(&mut svg, &mut random);
    svg + CLOSE
}

/// Tufts like combs: a smooth inner line, and teeth which point outwards.
fn fur(svg: &mut String, random: &mut Random) {
    const TEETH: usize = 12;
    for i in 0..36 {
        let radius = 400.0 - 4.5 * f64::from(i);
        let start = random.within(0.0, TAU);
        let polar = |r: f64, a: f64| (500.0 + r * a.cos(), 520.0 + r * a.sin());
        let step = random.within(0.035, 0.055);
        let mut points = Vec::new();
        for tooth in 0..TEETH {
            let angle = start + step * tooth as f64;
            points.push(polar(radius, angle));
            points.push(polar(radius + random.within(14.0, 40.0), angle + step * random.within(0.4, 1.2)));
        }
        for back in (0..TEETH).rev() {
            points.push(polar(radius - 16.0, start + step * back as f64));
        }
        let fill = random.pick(&["#f6b25a", "#d97a1e", "#fbe0b4", "#c9691a"]);
        let pen = if i % 4 == 0 { r##"stroke="#7a3d10" stroke-width="1""## } else { "" };
        shape(svg, &smooth(&points), &format!(r#"fill="{fill}" {pen}"#));
    }
}

/// Pairs of tapered stripes which point at the middle of the face, mirrored.
fn stripes(svg: &mut String, random: &mut Random) {
    for i in 0..52 {
        let angle = PI * (0.62 + 0.76 * f64::from(i) / 51.0) + random.within(-0.03, 0.03);
        let angle = if i % 13 == 0 { angle - 0.4 } else { angle };
        let (outer, inner) = (random.within(300.0, 395.0), random.within(150.0, 260.0));
        let width = random.within(0.018, 0.045);
        let bend = random.within(-0.12, 0.12);
        let dark = random.pick(&["#1d120c", "#2e1a10", "#3a2417"]);
        for side in [1.0, -1.0] {
            let polar = |r: f64, a: f64| (500.0 + side * r * a.cos(), 520.0 + r * a.sin());
            let middle = (outer + inner) / 2.0;
            let points = [
                polar(outer, angle - width),
                polar(middle, angle + bend - width * 1.4),
                polar(inner, angle + bend / 2.0),
                polar(middle, angle + bend + width * 1.4),
                polar(outer, angle + width),
                polar(outer * 1.02, angle),
            ];
            let pen = if i % 3 == 0 { r##"stroke="#120a06" stroke-width="1.5""## } else { "" };
            shape(svg, &smooth(&points), &format!(r#"fill="{dark}" {pen}"#));
        }
    }
}

fn eyes_and_nose(svg: &mut String, random: &mut Random) {
    let outline = r##"stroke="#000" stroke-width="4""##;
    for side in [-1.0, 1.0] {
        let centre = (500.0 + side * 150.0, 480.0);
        for (radius, fill, pen) in [
            ((78.0, 52.0), "#2a1a10", outline),
            ((64.0, 42.0), "#f7f3d0", ""),
            ((40.0, 40.0), "#7fae3c", outline),
            ((28.0, 30.0), "#b5d05f", ""),
            ((15.0, 30.0), "#0a0a0a", ""),
        ] {
            let points = ring(random, centre, radius, 0.03, 10);
            shape(svg, &smooth(&points), &format!(r#"fill="{fill}" {pen}"#));
        }
        shape(
            svg,
            &smooth(&ring(random, (centre.0 - 12.0, centre.1 - 14.0), (8.0, 8.0), 0.02, 8)),
            r##"fill="#fff""##,
        );
    }
    shape(
        svg,
        "M430 640C460 615 540 615 570 640C560 690 520 705 500 720C480 705 440 690 430 640Z",
        r##"fill="#c4574d" stroke="#3b0f0a" stroke-width="5""##,
    );
    shape(
        svg,
        "M500 720C500 770 440 800 390 775M500 720C500 770 560 800 610 775",
        r##"fill="none" stroke="#2a1208" stroke-width="9" stroke-linecap="round""##,
    );
    shape(
        svg,
        "M440 805C470 850 530 850 560 805C540 880 460 880 440 805Z",
        r##"fill="#a8323a" stroke="#2a1208" stroke-width="4""##,
    );
}

fn whiskers(svg: &mut String, random: &mut Random) {
    for i in 0..18 {
        let (x, y) = (random.within(250.0, 400.0), 650.0 + 8.0 * f64::from(i % 9));
        let (far, drop) = (random.within(180.0, 330.0), random.within(-90.0, 110.0));
        for side in [1.0, -1.0] {
            let at = |dx: f64| 500.0 + side * (x - 500.0 - dx);
            let d = format!(
                "M{:.1} {y:.1}Q{:.1} {:.1} {:.1} {:.1}",
                at(0.0),
                at(far * 0.6),
                y + drop * 0.2,
                at(far),
                y + drop
            );
            let width = random.within(1.5, 4.0);
            shape(
                svg,
                &d,
                &format!(
                    r##"fill="none" stroke="#fffdf5" stroke-width="{width:.1}" stroke-linecap="round""##
                ),
            );
        }
    }
}

/// Real emoji (samples/corpus/LICENSES.md), eight to a row, at a pitch which is no whole pixel.
fn emoji() -> String {
    const PICTURES: [(&str, f64); 5] = [
        (include_str!("../../samples/corpus/twemoji-pinata.svg"), 36.0),
        (include_str!("../../samples/corpus/fluent-mirror-ball.svg"), 32.0),
        (include_str!("../../samples/corpus/twemoji-nest.svg"), 36.0),
        (include_str!("../../samples/corpus/fluent-moose.svg"), 32.0),
        (include_str!("../../samples/corpus/twemoji-zebra.svg"), 36.0),
    ];
    let mut svg = format!("{OPEN}<path d=\"M0 0H1000V1000H0Z\" fill=\"#fff\"/>\n");
    for place in 0..64 {
        let (picture, size) = PICTURES[place % PICTURES.len()];
        let start = picture.find('>').expect("a root element") + 1;
        let end = picture.rfind("</svg>").expect("its end");
        let (x, y) = ((place % 8) as f64 * 124.6 + 6.3, (place / 8) as f64 * 124.6 + 6.3);
        let scale = 115.0 / size;
        write!(
            svg,
            r#"<g transform="translate({x:.1} {y:.1}) scale({scale:.4})">{}</g>"#,
            &picture[start..end]
        )
        .expect("a string takes all");
    }
    svg + CLOSE
}

/// A grid of 60 x 50 jittered cells; each of their borders is one fractal line of 4 or 8 parts,
/// walked one way by one neighbour and the other way by the other.
fn map() -> String {
    const COLUMNS: usize = 60;
    const ROWS: usize = 50;
    let mut random = Random::new(3);
    let mut corners = Vec::new();
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let (x, y) = (column as f64 / COLUMNS as f64, row as f64 / ROWS as f64);
            let jitter = (random.within(-4.5, 4.5), random.within(-5.0, 5.0));
            corners.push((30.0 + 940.0 * x + jitter.0, 30.0 + 940.0 * y + jitter.1));
        }
    }
    let corner = |column: usize, row: usize| corners[row * (COLUMNS + 1) + column];
    let mut border = |a: Point, b: Point| {
        let depth = if random.below(3) == 0 { 3 } else { 2 };
        coast(&mut random, a, b, depth, 0.22)
    };
    let across: Vec<Vec<Point>> = (0..(ROWS + 1) * COLUMNS)
        .map(|i| border(corner(i % COLUMNS, i / COLUMNS), corner(i % COLUMNS + 1, i / COLUMNS)))
        .collect();
    let down: Vec<Vec<Point>> = (0..ROWS * (COLUMNS + 1))
        .map(|i| {
            border(
                corner(i % (COLUMNS + 1), i / (COLUMNS + 1)),
                corner(i % (COLUMNS + 1), i / (COLUMNS + 1) + 1),
            )
        })
        .collect();
    let mut svg = format!("{OPEN}<path d=\"M0 0H1000V1000H0Z\" fill=\"#bcd8e8\"/>\n");
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let mut points = across[row * COLUMNS + column].clone();
            points.extend(&down[row * (COLUMNS + 1) + column + 1]);
            points.push(corner(column + 1, row + 1));
            points.extend(across[(row + 1) * COLUMNS + column].iter().skip(1).rev());
            points.push(corner(column, row + 1));
            points.extend(down[row * (COLUMNS + 1) + column].iter().skip(1).rev());
            let fill = random.pick(&["#f2e6b8", "#e8c99b", "#cfe0a8", "#d9b7c4", "#f6d2b0", "#b9d3a4"]);
            shape(&mut svg, &polygon(&points, 2), &format!(r#"fill="{fill}""#));
        }
    }
    svg + CLOSE
}

/// 100 x 100 jittered cells of two triangles each, shaded like a hilly country.
fn mesh() -> String {
    const CELLS: usize = 100;
    let mut random = Random::new(4);
    let mut corners = Vec::new();
    for row in 0..=CELLS {
        for column in 0..=CELLS {
            let inside = |i: usize| i > 0 && i < CELLS;
            let mut move_by = |free: bool| if free { random.within(-3.2, 3.2) } else { 0.0 };
            corners.push((
                column as f64 * 10.0 + move_by(inside(column)),
                row as f64 * 10.0 + move_by(inside(row)),
            ));
        }
    }
    let mut svg = String::from(OPEN);
    for row in 0..CELLS {
        for column in 0..CELLS {
            let at = |dx: usize, dy: usize| corners[(row + dy) * (CELLS + 1) + column + dx];
            let (a, b, c, d) = (at(0, 0), at(1, 0), at(1, 1), at(0, 1));
            let halves = if random.below(2) == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for half in halves {
                let (x, y) = half.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / 3.0, sum.1 + p.1 / 3.0));
                let height = (x / 140.0).sin() * (y / 110.0).cos() + 0.5 * ((x + y) / 60.0).sin();
                let light = 130.0 + 70.0 * height + random.within(-10.0, 10.0);
                let fill = format!(
                    r##"fill="#{:02x}{:02x}{:02x}""##,
                    (light * 0.8) as u8,
                    light as u8,
                    (light * 0.5 + 60.0) as u8
                );
                shape(&mut svg, &polygon(&half, 2), &fill);
            }
        }
    }
    svg + CLOSE
}

const CRAYONS: [&str; 8] =
    ["#e4572e", "#f3a712", "#a8c686", "#669bbc", "#29335c", "#d4a5a5", "#76b041", "#f7e1a0"];

fn blobs(seed: u64, count: usize, radius: (f64, f64), attributes: &str) -> String {
    let mut random = Random::new(seed);
    let mut svg = format!("{OPEN}<path d=\"M0 0H1000V1000H0Z\" fill=\"#fff\"/>\n");
    for _ in 0..count {
        let centre = (random.within(0.0, 1000.0), random.within(0.0, 1000.0));
        let size = random.within(radius.0, radius.1);
        let stretch = random.within(0.7, 1.4);
        let corners = 8 + random.below(9);
        let points = ring(&mut random, centre, (size * stretch, size / stretch), 0.25, corners);
        shape(&mut svg, &smooth(&points), &format!(r#"fill="{}" {attributes}"#, random.pick(&CRAYONS)));
    }
    svg + CLOSE
}

fn blobs_300() -> String {
    blobs(5, 300, (40.0, 120.0), r##"stroke="#1a1a1a" stroke-width="3""##)
}

fn blobs_3000() -> String {
    blobs(6, 3_000, (20.0, 80.0), r##"stroke="#1a1a1a" stroke-width="2""##)
}

fn translucent() -> String {
    blobs(7, 300, (40.0, 120.0), r#"fill-opacity=".5""#)
}

/// Continents and islands of all sizes with fractal coasts, each outlined.
fn world() -> String {
    let mut random = Random::new(8);
    let mut svg = format!("{OPEN}<path d=\"M0 0H1000V1000H0Z\" fill=\"#a9cfe6\"/>\n");
    let pen = r##"stroke="#4a5a3a" stroke-width=".6" stroke-linejoin="round""##;
    for island in 0..400 {
        // Sides x 2^depth segments: 8 continents of 4,096, 60 lands of 512, 332 islets of 64 to 128.
        let (size, sides, depth) = match island {
            0..8 => (random.within(90.0, 170.0), 8, 9),
            8..68 => (random.within(14.0, 50.0), 8, 6),
            _ => (random.within(2.0, 12.0), 6, if island % 4 == 0 { 5 } else { 4 }),
        };
        let centre = (random.within(20.0, 980.0), random.within(20.0, 980.0));
        let hull = ring(&mut random, centre, (size * 1.2, size), 0.3, sides);
        let mut points = Vec::new();
        for (i, from) in hull.iter().enumerate() {
            points.extend(coast(&mut random, *from, hull[(i + 1) % sides], depth, 0.25));
        }
        let fill = random.pick(&["#dfe3b4", "#c9d8a0", "#efe0b9", "#d8c8a0"]);
        shape(&mut svg, &polygon(&points, 3), &format!(r#"fill="{fill}" {pen}"#));
    }
    svg + CLOSE
}
