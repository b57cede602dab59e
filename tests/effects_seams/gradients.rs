//! Gradients, their hard stops, and what turns within a pixel.

use super::*;

/// A gradient of the picture's whole width; and the mean colours of its pixels.
const GRADIENT: &str = "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='0' x2='12'>
    <stop offset='0' stop-color='#f00'/><stop offset='1' stop-color='#00f'/></linearGradient>";

#[test]
fn shapes_that_abut_under_one_gradient_leave_no_seam() {
    for (degrees, off) in places() {
        let border = Border::new(degrees, off);
        let (a, b) = (border.half(), border.reversed().half());
        let picture =
            render(&format!("{GRADIENT}<path d='{a}' fill='url(#g)'/><path d='{b}' fill='url(#g)'/>"));
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let blue = 255.0 * (f64::from(x) + 0.5) / 12.0;
            let [r, g, b, a] = picture.pixel(x, y);
            let off_by = (f64::from(b) - blue).abs().max((f64::from(r) - 255.0 + blue).abs());
            assert!(
                off_by < 1.0 && g == 0 && a == 255,
                "({x}, {y}) at {degrees}°, {off} px: {r} {g} {b} {a}"
            );
        }
    }
}

#[test]
fn a_hard_stop_is_as_exact_as_an_edge_and_beside_an_edge() {
    assert_exact(
        |a, _, c| {
            // The gradient's vector from a point on the border along its normal.
            let points: Vec<f64> =
                a[1..a.len() - 1].split(['L', ' ']).map(|number| number.parse().expect("a number")).collect();
            let corners: Vec<Point> = points.chunks(2).map(|p| (p[0], p[1])).collect();
            let side = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
            let inner = |&(p, q): &(Point, Point)| {
                // The one side that is not the large square's.
                (p.0 != q.0 || p.0.abs() < 39.9) && (p.1 != q.1 || p.1.abs() < 39.9)
            };
            let (p, q) = (0..corners.len()).map(side).find(inner).expect("a side");
            let normal = (p.1 - q.1, q.0 - p.0);
            let (x2, y2) = (p.0 + normal.0, p.1 + normal.1);
            let (x1, y1) = (p.0 - normal.0, p.1 - normal.1);
            format!(
                "{PAPER}<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='{x1:.5}' y1='{y1:.5}' x2='{x2:.5}' y2='{y2:.5}'>
                <stop offset='.5' stop-color='#00f'/><stop offset='.5' stop-color='#f00'/></linearGradient>
                <path d='{c}' fill='url(#g)'/>"
            )
        },
        |sides| if sides[1] { of_halves(sides) } else { WHITE },
    );
}

/// Holds red on the inside of a border, painted by a gradient, against the mean of 128 x 128 points a
/// pixel; `red` is the colour at a point.
#[track_caller]
fn assert_gradient(gradient: &str, red: impl Fn(f64, f64) -> f64) {
    const POINTS: u32 = 128;
    let mut worst = (0.0f64, String::new());
    for (degrees, off) in [(12.0, 0.3), (77.0, -1.3), (130.0, 2.1), (283.0, 0.0)] {
        let border = Border::new(degrees, off);
        let body = format!("{gradient}<path d='{}' fill='url(#g)'/>", border.half());
        let picture = render(&format!("<rect width='12' height='12'/>{body}"));
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let mut sum = 0.0;
            for point in 0..POINTS * POINTS {
                // A lattice by the golden ratio: even along every line, so that edges are exact.
                let count = f64::from(POINTS * POINTS);
                let v = (f64::from(point) * 0.618_033_988_749_894_9).fract();
                let (px, py) = (f64::from(x) + (f64::from(point) + 0.5) / count, f64::from(y) + v);
                if border.distance((px, py)) >= 0.0 {
                    sum += red(px, py) / count;
                }
            }
            let off_by = (f64::from(picture.pixel(x, y)[0]) - 255.0 * sum).abs();
            if off_by > worst.0 {
                let found = picture.pixel(x, y)[0];
                worst = (off_by, format!("({x}, {y}): {found} is not {:.2}\n{body}", 255.0 * sum));
            }
        }
    }
    assert!(worst.0 <= 1.0, "off by {:.2} levels: {}", worst.0, worst.1);
}

#[test]
fn a_gradient_that_turns_within_pixels_is_its_mean_over_what_is_seen() {
    let stops = "<stop offset='.2' stop-color='#f00'/><stop offset='.4' stop-color='#000'/>
        <stop offset='.4' stop-color='#900'/><stop offset='.9' stop-color='#f00' stop-opacity='.2'/>";
    let red = |t: f64| match t {
        t if t < 0.2 => 1.0,
        t if t < 0.4 => 1.0 - (t - 0.2) / 0.2,
        t => {
            let u = ((t - 0.4) / 0.5).min(1.0);
            (0.6 + 0.4 * u) * (1.0 - 0.8 * u)
        }
    };
    for (x2, y2) in [(3.0, 0.0), (0.3, 0.4), (-1.1, 1.7), (0.02, 0.05)] {
        for (spread, spreading) in [
            ("pad", (|t: f64| t.clamp(0.0, 1.0)) as fn(f64) -> f64),
            ("repeat", |t| t - t.floor()),
            ("reflect", |t| 1.0 - (t - 2.0 * (t / 2.0).floor() - 1.0).abs()),
        ] {
            let gradient = format!(
                "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='6' y1='5.5' x2='{}' y2='{}' spreadMethod='{spread}'>{stops}</linearGradient>",
                6.0 + x2,
                5.5 + y2
            );
            let square = x2 * x2 + y2 * y2;
            assert_gradient(&gradient, |x, y| red(spreading(((x - 6.0) * x2 + (y - 5.5) * y2) / square)));
        }
    }
}

#[test]
fn a_steep_gradient_is_its_mean_over_what_is_seen() {
    let gradient = "<linearGradient id='g' gradientUnits='userSpaceOnUse' x1='1' y1='2' x2='10' y2='8'>
        <stop offset='0' stop-color='#000'/><stop offset='1' stop-color='#f00'/></linearGradient>";
    let square = 81.0 + 36.0;
    assert_gradient(gradient, |x, y| (((x - 1.0) * 9.0 + (y - 2.0) * 6.0) / square).clamp(0.0, 1.0));
}

#[test]
fn the_rings_of_a_radial_gradient_are_their_mean_over_what_is_seen() {
    // Its middle is outside: there rings are no straight lines.
    let gradient = "<radialGradient id='g' gradientUnits='userSpaceOnUse' cx='-20' cy='-17' r='1.7' spreadMethod='repeat'>
        <stop offset='.5' stop-color='#000'/><stop offset='.5' stop-color='#f00'/></radialGradient>";
    assert_gradient(gradient, |x, y| {
        let t = ((x + 20.0).powi(2) + (y + 17.0).powi(2)).sqrt() / 1.7;
        if t - t.floor() < 0.5 {
            0.0
        } else {
            1.0
        }
    });
}
