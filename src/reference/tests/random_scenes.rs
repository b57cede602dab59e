//! Random scenes, by two other ways to their areas: exact fractions, and counting samples.

use super::super::rational::{visible_areas, Polygon};
use super::*;
use kurbo::{BezPath, Shape};
use usvg::FillRule;

const UNITS_PER_PIXEL: i64 = 16;
const SIZE: u32 = 8;

/// Opaque polygons of 3 to `corners` corners, some beyond the picture; every fifth takes two corners
/// from the one before it, so that edges are shared.
fn polygons(dice: &mut Dice, count: usize, corners: i64) -> Vec<Polygon> {
    let reach = i64::from(SIZE) * UNITS_PER_PIXEL;
    let mut all: Vec<Polygon> = Vec::new();
    for number in 0..count {
        let mut points: Vec<(i64, i64)> = (0..dice.whole(3, corners + 1))
            .map(|_| (dice.whole(-20, reach + 20), dice.whole(-20, reach + 20)))
            .collect();
        if number % 5 == 4 {
            (points[0], points[1]) = (all[number - 1].points[1], all[number - 1].points[0]);
        }
        let rule = if dice.whole(0, 2) == 0 { FillRule::NonZero } else { FillRule::EvenOdd };
        all.push(Polygon { points, rule });
    }
    all
}

/// The polygons as SVG, in colours of which no two are alike.
fn svg(polygons: &[Polygon], colours: &[[u8; 3]]) -> String {
    let shapes = polygons.iter().zip(colours).map(|(polygon, [r, g, b])| {
        let rule = if polygon.rule == FillRule::NonZero { "nonzero" } else { "evenodd" };
        let points: Vec<String> = polygon.points.iter().map(|(x, y)| format!("{x},{y}")).collect();
        format!("<polygon fill='rgb({r},{g},{b})' fill-rule='{rule}' points='{}'/>", points.join(" "))
    });
    format!("<g transform='scale({})'>{}</g>", 1.0 / UNITS_PER_PIXEL as f64, shapes.collect::<String>())
}

#[test]
fn random_stacks_of_polygons_have_the_areas_that_exact_fractions_give() {
    let mut dice = Dice(1978);
    let mut worst: f64 = 0.0;
    for scene in 0..40 {
        let polygons = polygons(&mut dice, 1 + scene % 8, 3 + scene as i64 % 9);
        let colours: Vec<[u8; 3]> =
            polygons.iter().map(|_| std::array::from_fn(|_| dice.whole(0, 256) as u8)).collect();
        let exact = visible_areas(&polygons, UNITS_PER_PIXEL, SIZE, SIZE).expect("small coordinates");
        let truth = truth(SIZE, SIZE, &svg(&polygons, &colours));
        for (pixel, areas) in truth.premultiplied().iter().zip(&exact) {
            assert_near(areas.iter().sum(), 1.0, 1e-14);
            for channel in 0..4 {
                let level = |c: &[u8; 3]| if channel < 3 { f64::from(c[channel]) } else { 255.0 };
                let wanted: f64 = areas.iter().zip(&colours).map(|(area, c)| area * level(c)).sum();
                worst = worst.max((pixel[channel] - wanted).abs());
            }
        }
    }
    println!("worst difference from exact fractions: {worst:e} levels");
    assert!(worst < 1e-9, "{worst} levels");
}

/// The colours of a scene's regular samples, 64 x 64 a pixel, by winding numbers from [`kurbo`].
fn sampled(shapes: &[(BezPath, FillRule, [f64; 4])], x: u32, y: u32) -> [f64; 4] {
    const SAMPLES: u32 = 64;
    let near: Vec<_> = shapes
        .iter()
        .filter(|(path, ..)| {
            let pixel = kurbo::Rect::new(x.into(), y.into(), f64::from(x) + 1.0, f64::from(y) + 1.0);
            path.bounding_box().overlaps(pixel)
        })
        .collect();
    let mut sum = [0.0; 4];
    for i in 0..SAMPLES * SAMPLES {
        let at = |cell: u32, sample: u32| f64::from(cell) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
        let point = kurbo::Point::new(at(x, i % SAMPLES), at(y, i / SAMPLES));
        let mut colour = [0.0; 4];
        for (path, rule, front) in &near {
            let winding = path.winding(point);
            let inside = if *rule == FillRule::NonZero { winding != 0 } else { winding % 2 != 0 };
            if inside {
                colour = std::array::from_fn(|c| front[c] + colour[c] * (1.0 - front[3]));
            }
        }
        sum = std::array::from_fn(|c| sum[c] + colour[c] * 255.0 / f64::from(SAMPLES * SAMPLES));
    }
    sum
}

#[test]
fn random_scenes_with_curves_and_opacity_agree_with_64_by_64_samples() {
    let mut dice = Dice(1984);
    let (mut worst, mut squares, mut count): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for _ in 0..6 {
        let mut shapes = Vec::new();
        let mut body = String::new();
        for number in 0..7 {
            let mut at = || dice.real(-1.0, 9.0) as f32;
            let mut d = format!("M{} {}", at(), at());
            for _ in 0..3 {
                d += &format!("C{} {} {} {} {} {}L{} {}", at(), at(), at(), at(), at(), at(), at(), at());
            }
            d += "z";
            let [r, g, b]: [u8; 3] = std::array::from_fn(|_| dice.whole(0, 256) as u8);
            let opacity = [1.0, 0.5, 0.25][number % 3];
            let (rule, rule_name) =
                [(FillRule::NonZero, "nonzero"), (FillRule::EvenOdd, "evenodd")][number % 2];
            body += &format!(
                "<path fill='rgb({r},{g},{b})' fill-opacity='{opacity}' fill-rule='{rule_name}' d='{d}'/>"
            );
            let level = |byte: u8| f64::from(byte) / 255.0 * opacity;
            let colour = [level(r), level(g), level(b), opacity];
            shapes.push((BezPath::from_svg(&d).expect("a path"), rule, colour));
        }
        let truth = truth(SIZE, SIZE, &body);
        for (at, pixel) in truth.premultiplied().iter().enumerate() {
            let samples = sampled(&shapes, at as u32 % SIZE, at as u32 / SIZE);
            for channel in 0..4 {
                let error = (pixel[channel] - samples[channel]).abs();
                worst = worst.max(error);
                squares += error * error;
                count += 1.0;
            }
        }
    }
    let rms = (squares / count).sqrt();
    println!("from 64 x 64 samples: rms {rms:.3}, worst {worst:.3} levels");
    // One edge near an axis is off by up to a column of samples, 4 levels; all together far less.
    assert!(rms < 0.35 && worst < 4.0, "rms {rms}, worst {worst} levels");
}
