//! How exact a pixel's coverage is, here and in tiny-skia, both held against the analytic area.
//!
//! `cargo test --test against_tiny_skia -- --nocapture` prints the table.

mod support;

use std::f64::consts::TAU;
use support::*;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Stroke, Transform};

const SIDE: u32 = 32;

/// Errors of one renderer over the pixels which edges touch, in coverage (1 is a full pixel).
#[derive(Default)]
struct Errors {
    count: f64,
    sum: f64,
    squares: f64,
    max: f64,
}

impl Errors {
    /// Adds each pixel in which the true coverage or the found one is partial.
    fn add(&mut self, found: impl Fn(u32, u32) -> u8, truth: &Truth) {
        for y in 0..truth.height {
            for x in 0..truth.width {
                let (found, truth) = (f64::from(found(x, y)) / 255.0, truth.pixel(x, y)[0] / 255.0);
                if (1e-9..=1.0 - 1e-9).contains(&truth) || (found - truth).abs() > 1e-9 {
                    let off = (found - truth).abs();
                    self.count += 1.0;
                    self.sum += off;
                    self.squares += off * off;
                    self.max = self.max.max(off);
                }
            }
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}

/// What is drawn: disjoint rings, and how either renderer is asked for them.
struct Drawing {
    /// The covered area.
    area: Vec<Point>,
    /// The line whose stroke the area is, and its width; `None` for a fill.
    line: Option<([Point; 2], f64)>,
}

impl Drawing {
    fn fill(area: Vec<Point>) -> Drawing {
        let area = area.iter().map(|p| p.map(|v| f64::from(v as f32))).collect();
        Drawing { area, line: None }
    }

    fn line(a: Point, b: Point, width: f64) -> Drawing {
        let [a, b] = [a, b].map(|p| p.map(|v| f64::from(v as f32)));
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let half = width / 2.0 / dx.hypot(dy);
        let n = [-dy * half, dx * half];
        let at = |p: Point, side: f64| [p[0] + side * n[0], p[1] + side * n[1]];
        Drawing { area: vec![at(a, 1.0), at(b, 1.0), at(b, -1.0), at(a, -1.0)], line: Some(([a, b], width)) }
    }

    fn ours(&self) -> toon_raster::Pixmap {
        let body = match self.line {
            None => path(&ring(&self.area), "#fff", ""),
            Some((ends, width)) => {
                let d = ring(&ends).replace('Z', "");
                path(&d, "none", &format!("stroke=\"#fff\" stroke-width=\"{width}\""))
            }
        };
        render(&svg(SIDE, SIDE, &(rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#000") + &body)))
    }

    fn tiny_skia(&self) -> Pixmap {
        let mut pixmap = Pixmap::new(SIDE, SIDE).expect("a size");
        pixmap.fill(Color::BLACK);
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(Color::WHITE);
        let points: &[Point] = match &self.line {
            None => &self.area,
            Some((ends, _)) => ends,
        };
        let mut builder = PathBuilder::new();
        for (i, p) in points.iter().enumerate() {
            let (x, y) = (p[0] as f32, p[1] as f32);
            if i == 0 {
                builder.move_to(x, y);
            } else {
                builder.line_to(x, y);
            }
        }
        match self.line {
            None => {
                builder.close();
                let path = builder.finish().expect("a path");
                pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
            }
            Some((_, width)) => {
                let path = builder.finish().expect("a path");
                let stroke = Stroke { width: width as f32, ..Stroke::default() };
                pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
            }
        }
        pixmap
    }
}

/// Half-planes through the middle of the picture at every angle of `count` from 0 to 1 turn.
fn half_planes(count: u32, near_axis: bool) -> Vec<Drawing> {
    let mut rng = Rng::new(1);
    (0..count)
        .map(|i| {
            let turn = f64::from(i) / f64::from(count);
            // Near an axis: within 2 degrees of one.
            let quarter = (f64::from(i) % 4.0) / 4.0;
            let angle = TAU * if near_axis { quarter + (turn - 0.5) / 90.0 } else { turn };
            let (sin, cos) = angle.sin_cos();
            let at = [16.0 + rng.between(-1.0, 1.0), 16.0 + rng.between(-1.0, 1.0)];
            let point = |u: f64, v: f64| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos];
            Drawing::fill(vec![point(-64.0, 0.0), point(64.0, 0.0), point(64.0, 64.0), point(-64.0, 64.0)])
        })
        .collect()
}

/// Convex polygons of random corners on an ellipse.
fn polygons(count: u32) -> Vec<Drawing> {
    let mut rng = Rng::new(2);
    (0..count)
        .map(|_| {
            let mut angles: Vec<f64> = (0..3 + rng.below(6)).map(|_| rng.between(0.0, TAU)).collect();
            angles.sort_by(f64::total_cmp);
            let (a, b) = (rng.between(1.0, 15.0), rng.between(1.0, 15.0));
            Drawing::fill(angles.iter().map(|t| [16.0 + a * t.cos(), 16.0 + b * t.sin()]).collect())
        })
        .collect()
}

fn slivers(count: u32) -> Vec<Drawing> {
    let mut rng = Rng::new(3);
    (0..count)
        .map(|_| {
            let mut point = || [rng.between(1.0, 31.0), rng.between(1.0, 31.0)];
            let (a, b) = (point(), point());
            Drawing::fill(vec![a, b, [b[0] + 0.125, b[1] + 0.125]])
        })
        .collect()
}

fn lines(count: u32, width: f64) -> Vec<Drawing> {
    let mut rng = Rng::new(4);
    (0..count)
        .map(|_| {
            let mut point = || [rng.between(2.0, 30.0), rng.between(2.0, 30.0)];
            Drawing::line(point(), point(), width)
        })
        .collect()
}

#[test]
fn coverage_is_within_half_a_level_of_the_area_and_nearer_than_tiny_skias() {
    let rows = [
        ("half-planes at 360 angles", half_planes(360, false), STRAIGHT),
        ("half-planes within 2° of an axis", half_planes(120, true), STRAIGHT),
        ("random convex polygons", polygons(200), STRAIGHT),
        ("slivers of 1/8 px", slivers(100), STRAIGHT),
        ("lines 0.25 px wide", lines(100, 0.25), CURVED),
        ("lines 1 px wide", lines(100, 1.0), CURVED),
        ("lines 2.5 px wide", lines(100, 2.5), CURVED),
    ];
    println!("| error of coverage (1 is a full pixel) | toon-raster: mean | rms | max | tiny-skia: mean | rms | max |");
    println!("|---|---|---|---|---|---|---|");
    let mut measured = Vec::new();
    for (name, drawings, levels) in rows {
        let (mut ours, mut theirs) = (Errors::default(), Errors::default());
        for drawing in &drawings {
            let truth = coverage(SIDE, SIDE, std::slice::from_ref(&drawing.area));
            let picture = drawing.ours();
            ours.add(|x, y| picture.pixel(x, y)[0], &truth);
            let picture = drawing.tiny_skia();
            theirs.add(|x, y| picture.pixel(x, y).expect("inside").red(), &truth);
        }
        println!(
            "| {name} | {:.5} | {:.5} | {:.5} | {:.5} | {:.5} | {:.5} |",
            ours.mean(),
            ours.rms(),
            ours.max,
            theirs.mean(),
            theirs.rms(),
            theirs.max
        );
        measured.push((name, ours, theirs, levels));
    }
    for (name, ours, theirs, levels) in measured {
        assert!(ours.max * 255.0 <= levels, "{name}: off by {} levels", ours.max * 255.0);
        assert!(ours.mean() < theirs.mean(), "{name}: mean {} and {}", ours.mean(), theirs.mean());
        assert!(ours.rms() < theirs.rms(), "{name}: rms {} and {}", ours.rms(), theirs.rms());
        assert!(ours.max < theirs.max, "{name}: max {} and {}", ours.max, theirs.max);
    }
}

#[test]
fn both_renderers_draw_the_same_shapes() {
    // What the table compares is one drawing: tiny-skia's area agrees with the analytic one coarsely.
    for drawing in polygons(20).iter().chain(&half_planes(20, false)).chain(&lines(20, 2.5)) {
        let truth = coverage(SIDE, SIDE, std::slice::from_ref(&drawing.area));
        let picture = drawing.tiny_skia();
        let light: f64 = picture.pixels().iter().map(|p| f64::from(p.red())).sum();
        let expected: f64 = truth.data.iter().map(|p| p[0]).sum();
        assert!((light - expected).abs() < 0.02 * expected + 255.0, "light {light}, area {expected}");
    }
}
