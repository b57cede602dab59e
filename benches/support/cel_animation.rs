//! Makes a drawing as cel animation is: a character that walks over a detailed background which stays.

use super::random::Random;
use std::f64::consts::TAU;
use std::fmt::Write;

const WIDTH: f64 = 1920.0;
const HEIGHT: f64 = 1080.0;

/// Outlined leaves of the background.
const LEAVES: usize = 800;

/// 100 frames at 24 a second.
pub fn drawing() -> String {
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}"><defs><linearGradient id="sky" x2="0" y2="1"><stop stop-color="#8cf"/><stop offset="1" stop-color="#fec"/></linearGradient></defs><rect width="{WIDTH}" height="{HEIGHT}" fill="url(#sky)"/>"##
    );
    let mut random = Random::new(7);
    for leaf in 0..LEAVES {
        // From far to near: larger and lower.
        let near = leaf as f64 / LEAVES as f64;
        let (x, y) = (random.within(0.0, WIDTH), 300.0 + 700.0 * near + random.within(-60.0, 60.0));
        let radius = random.within(10.0, 30.0 + 60.0 * near);
        let fill = random.pick(&["#385", "#496", "#2a5", "#573", "#7a4"]);
        let path = blob(&mut random, x, y, radius);
        let _ = write!(svg, r##"<path d="{path}" fill="{fill}" stroke="#222" stroke-width="1.5"/>"##);
    }
    let body = blob(&mut random, 0.0, 0.0, 80.0);
    let leg = |from: f64, x: f64| {
        format!(
            r#"<path d="M{x} 60L{:.0} 160"><animateTransform attributeName="transform" type="rotate" values="{from};{};{from}" dur=".5s" repeatCount="8"/></path>"#,
            2.0 * x,
            -from
        )
    };
    let _ = write!(
        svg,
        r##"<g transform="translate(100 760)"><g stroke="#000" stroke-width="4"><animateTransform attributeName="transform" type="translate" from="0 0" to="1700 0" dur="4.1666s" fill="freeze"/>{}{}<path d="{body}" fill="#e63"/><circle cy="-100" r="50" fill="#fc8"/><circle cx="-15" cy="-110" r="8" fill="#fff"/><circle cx="20" cy="-110" r="8" fill="#fff"/></g></g></svg>"##,
        leg(20.0, -10.0),
        leg(-20.0, 10.0)
    );
    svg
}

/// A closed smooth curve around a point (Catmull-Rom, as cubic Béziers), as path data.
fn blob(random: &mut Random, x: f64, y: f64, radius: f64) -> String {
    let count = 12 + random.below(5);
    let points: Vec<(f64, f64)> = (0..count)
        .map(|i| {
            let (sin, cos) = (TAU * i as f64 / count as f64).sin_cos();
            let r = radius * random.within(0.75, 1.25);
            (x + r * cos, y + r * sin)
        })
        .collect();
    let at = |i: usize| points[i % points.len()];
    let mut path = format!("M{:.1} {:.1}", points[0].0, points[0].1);
    for i in 0..points.len() {
        let (before, from, to, after) = (at(i + points.len() - 1), at(i), at(i + 1), at(i + 2));
        let c1 = (from.0 + (to.0 - before.0) / 6.0, from.1 + (to.1 - before.1) / 6.0);
        let c2 = (to.0 - (after.0 - from.0) / 6.0, to.1 - (after.1 - from.1) / 6.0);
        let _ = write!(path, "C{:.1} {:.1} {:.1} {:.1} {:.1} {:.1}", c1.0, c1.1, c2.0, c2.1, to.0, to.1);
    }
    path + "Z"
}
