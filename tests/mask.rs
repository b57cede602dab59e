//! The A-buffer's two methods against the exact areas, and what its sets promise by construction: the
//! sets of abutting shapes tile.

mod support;

use std::f64::consts::TAU;
use support::*;
use toon_raster::{Method, Pixmap, Settings};

const MASKS: [Method; 2] = [Method::Mask, Method::Mask64];

/// The same flattening for all, so that only the sets differ.
fn by(method: Method) -> Settings {
    Settings { method, ..settings() }
}

/// What a method may err by in the mean: half a sample of four a side, or of eight.
fn promised(method: Method) -> f64 {
    if method == Method::Mask {
        1.0 / 32.0
    } else {
        1.0 / 64.0
    }
}

/// Mean difference over all premultiplied channels, in levels.
fn mean_difference(a: &Pixmap, b: &Pixmap) -> f64 {
    let pixels = |p: &Pixmap| -> Vec<[f64; 4]> {
        p.data().chunks(4).map(|p| premultiplied([p[0], p[1], p[2], p[3]])).collect()
    };
    let (a, b) = (pixels(a), pixels(b));
    let sum: f64 = a.iter().zip(&b).flat_map(|(a, b)| (0..4).map(move |i| (a[i] - b[i]).abs())).sum();
    sum / a.len() as f64 / 4.0
}

// --------------------------------------------------------------------------- half-planes

/// Stripes at an angle, so wide apart that a pixel sees one border at most.
fn stripes(rng: &mut Rng, side: u32, angle: f64) -> String {
    let (cos, sin) = (angle.cos(), angle.sin());
    let middle = f64::from(side) / 2.0;
    let at =
        |along: f64, across: f64| [middle + across * cos - along * sin, middle + across * sin + along * cos];
    let reach = 1.5 * middle;
    let mut across = -reach;
    let mut stripes = Vec::new();
    while across < reach {
        let (from, to) = (across + rng.between(3.0, 6.0), across + rng.between(9.0, 12.0));
        stripes.push(vec![at(-reach, from), at(reach, from), at(reach, to), at(-reach, to)]);
        across = to;
    }
    svg(side, side, &path(&rings(&stripes), "#fff", ""))
}

#[test]
fn a_half_plane_errs_by_less_than_half_a_sample_in_the_mean() {
    const SIDE: u32 = 160;
    let mut rng = Rng::new(1);
    let mut sums = [(0.0, 0.0f64, 0.0); 2];
    println!(
        "coverage error of a half-plane\n{:>7} {:>21} {:>21}",
        "angle", "mask mean, worst", "mask64 mean, worst"
    );
    for step in 0..45 {
        let angle = f64::from(step) * TAU / 2.0 / 45.0;
        let document = stripes(&mut rng, SIDE, angle);
        let exact = render_with(&document, by(Method::Exact));
        let mut line = format!("{:>6.0}°", angle.to_degrees());
        for (method, (sum, worst, count)) in MASKS.into_iter().zip(&mut sums) {
            let picture = render_with(&document, by(method));
            let (mut mean, mut most, mut pixels) = (0.0, 0.0f64, 0.0);
            for (is, should) in picture.data().chunks(4).zip(exact.data().chunks(4)) {
                if (1..255).contains(&should[3]) {
                    let off = (f64::from(is[3]) - f64::from(should[3])).abs() / 255.0;
                    (mean, most, pixels) = (mean + off, most.max(off), pixels + 1.0);
                }
            }
            line += &format!(" {:>12.4} {most:>8.4}", mean / pixels);
            (*sum, *worst, *count) = (*sum + mean / pixels, worst.max(most), *count + 1.0);
        }
        println!("{line}");
    }
    for (method, (sum, worst, count)) in MASKS.into_iter().zip(sums) {
        let mean = sum / count;
        println!("{method}: mean {mean:.4}, worst {worst:.4}");
        assert!(mean <= promised(method), "{method}: mean {mean}");
        // A quantum of eight bits may be added.
        assert!(worst <= 6.0 * promised(method), "{method}: worst {worst}");
    }
}

#[test]
fn borders_near_the_axes_err_by_half_a_row_at_most() {
    let mut rng = Rng::new(2);
    for step in 0..200 {
        let angle = f64::from(step % 4) * TAU / 4.0;
        let document = stripes(&mut rng, 32, angle);
        let exact = render_with(&document, by(Method::Exact));
        for (method, samples) in MASKS.into_iter().zip([16.0, 64.0]) {
            assert_within(
                &render_with(&document, by(method)),
                &exact,
                255.0 / samples / 2.0 + 1.0,
                "upright",
            );
        }
    }
}

// -------------------------------------------------------------------------------- tiling

const SIDE: u32 = 64;

/// Triangles that tile the square, all corners inside it moved at random: a mesh with a fan in each cell.
fn mesh(rng: &mut Rng, cells: usize) -> Vec<Vec<Point>> {
    let pitch = f64::from(SIDE) / cells as f64;
    let mut corners = vec![vec![[0.0; 2]; cells + 1]; cells + 1];
    for (j, row) in corners.iter_mut().enumerate() {
        for (i, corner) in row.iter_mut().enumerate() {
            let inner = |k: usize| k > 0 && k < cells;
            let off = |rng: &mut Rng, k: usize| if inner(k) { rng.between(-0.2, 0.2) * pitch } else { 0.0 };
            *corner = [i as f64 * pitch + off(rng, i), j as f64 * pitch + off(rng, j)];
        }
    }
    let mut triangles = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let ring = [corners[j][i], corners[j][i + 1], corners[j + 1][i + 1], corners[j + 1][i]];
            let share = rng.between(0.3, 0.7);
            let centre = [0, 1].map(|c| share * ring[0][c] + (1.0 - share) * ring[2][c]);
            // No corner is moved so far that the ring's diagonal does not lie inside.
            for k in 0..4 {
                triangles.push(vec![centre, ring[k], ring[(k + 1) % 4]]);
            }
        }
    }
    triangles
}

/// A fan of many blades about a point, as wide as the picture.
fn fan(rng: &mut Rng, blades: usize) -> Vec<Vec<Point>> {
    let centre = [rng.between(20.0, 44.0), rng.between(20.0, 44.0)];
    let mut angles: Vec<f64> =
        (0..blades).map(|i| (i as f64 + 0.9 * rng.between(0.0, 1.0)) / blades as f64).collect();
    angles.push(angles[0] + 1.0);
    let at = |turn: f64| [centre[0] + 120.0 * (turn * TAU).cos(), centre[1] + 120.0 * (turn * TAU).sin()];
    angles.windows(2).map(|pair| vec![centre, at(pair[0]), at(pair[1])]).collect()
}

/// Each as a shape of its own, every second one walked the other way round.
fn shapes(polygons: &[Vec<Point>], fill: &str, attributes: &str) -> String {
    let mut body = String::new();
    for (i, polygon) in polygons.iter().enumerate() {
        let mut polygon = polygon.clone();
        if i % 2 == 1 {
            polygon.reverse();
        }
        body += &path(&ring(&polygon), fill, attributes);
    }
    svg(SIDE, SIDE, &body)
}

fn tilings() -> impl Iterator<Item = Vec<Vec<Point>>> {
    let mut rng = Rng::new(3);
    (0..24).map(move |round| match round % 3 {
        0 => mesh(&mut rng, 5 + round),
        1 => mesh(&mut rng, 64 + round),
        _ => fan(&mut rng, 3 + 4 * round),
    })
}

#[test]
fn the_sets_of_abutting_shapes_leave_no_gap() {
    for (round, tiling) in tilings().enumerate() {
        for method in MASKS {
            let picture = render_with(&shapes(&tiling, "#fff", ""), by(method));
            let seams = picture.data().chunks(4).filter(|p| p[3] != 255).count();
            assert_eq!(seams, 0, "{method}, round {round}: pixels let light through");
        }
    }
}

#[test]
fn the_sets_of_abutting_shapes_do_not_overlap() {
    for (round, tiling) in tilings().enumerate() {
        for method in MASKS {
            let picture = render_with(&shapes(&tiling, "#fff", "fill-opacity=\".5\""), by(method));
            let doubled = picture.data().chunks(4).filter(|p| p[3] != 128).count();
            assert_eq!(doubled, 0, "{method}, round {round}: pixels are not covered once");
        }
    }
}

#[test]
fn a_clip_beside_its_complement_leaves_no_seam() {
    let document = svg(
        SIDE,
        SIDE,
        r##"<clipPath id="in"><circle cx="31.3" cy="30.2" r="21.7"/></clipPath>
        <clipPath id="out"><path clip-rule="evenodd" d="M0 0H64V64H0zM53 30.2A21.7 21.7 0 0 1 9.6 30.2A21.7 21.7 0 0 1 53 30.2z"/></clipPath>
        <clipPath id="left"><path d="M0 0H22.3L39.9 64H0z"/></clipPath>
        <clipPath id="right"><path d="M64 0H22.3L39.9 64H64z"/></clipPath>
        <g clip-path="url(#left)"><rect width="64" height="64" fill="#fff"/></g>
        <g clip-path="url(#right)"><rect width="64" height="64" fill="#fff" clip-path="url(#in)"/>
        <rect width="64" height="64" fill="#fff"/></g>"##,
    );
    for method in MASKS {
        let picture = render_with(&document, by(method));
        assert!(picture.data().chunks(4).all(|p| p == [255; 4]), "{method}");
    }
}

// ------------------------------------------------------------------------ rules, clips, groups

/// Holds both methods against the exact one on a document with straight edges: mean error of the pixels
/// that the methods could have wrong.
#[track_caller]
fn assert_near_exact(document: &str, what: &str) {
    let exact = render_with(document, by(Method::Exact));
    for method in MASKS {
        let picture = render_with(document, by(method));
        let (mut sum, mut count) = (0.0, 1.0);
        for (is, should) in picture.data().chunks(4).zip(exact.data().chunks(4)) {
            let pixel = |p: &[u8]| premultiplied([p[0], p[1], p[2], p[3]]);
            let off = distance(pixel(is), pixel(should));
            assert!(off <= 255.0 * 8.0 * promised(method), "{what}, {method}: {is:?} for {should:?}");
            if off > 0.0 {
                (sum, count) = (sum + off, count + 1.0);
            }
        }
        let mean = sum / count / 255.0;
        assert!(mean <= 1.5 * promised(method), "{what}, {method}: mean {mean} where they differ");
    }
}

#[test]
fn a_star_is_filled_by_its_rule() {
    let star = "M32 2L50.6 60.3L2.1 23.9H61.9L13.4 60.3Z";
    for (rule, middle) in [("nonzero", 255), ("evenodd", 0)] {
        let document = svg(SIDE, SIDE, &path(star, "#fff", &format!("fill-rule=\"{rule}\"")));
        for method in MASKS {
            assert_eq!(render_with(&document, by(method)).pixel(32, 34)[3], middle, "{method}, {rule}");
        }
        assert_near_exact(&document, rule);
    }
}

#[test]
fn windings_of_any_number_are_counted() {
    // Turns over turns, there and back: windings from -40 to 40 in one pixel and beside each other.
    let turn = |n: usize, x: f64, back: bool| {
        let square = if back { "m0 0v9.3h9.3v-9.3z" } else { "m0 0h9.3v9.3h-9.3z" };
        format!("M{x} {}", x / 2.0 + 3.7) + &square.repeat(n)
    };
    for rule in ["nonzero", "evenodd"] {
        let attributes = format!("fill-rule=\"{rule}\"");
        for n in [1, 2, 3, 4, 7, 8, 40, 300] {
            let d = turn(n, 5.3, false) + &turn(n, 9.4, true) + &turn(1, 20.6, false) + &turn(n, 25.1, false);
            assert_near_exact(
                &svg(SIDE, SIDE, &path(&d, "#fff", &attributes)),
                &format!("{rule}, {n} turns"),
            );
            // All of it left of the picture but for its inside.
            let wide = format!("M-20 {}", 9.6) + &"h50.3v20.1h-50.3z".repeat(n);
            assert_near_exact(
                &svg(SIDE, SIDE, &path(&wide, "#fff", &attributes)),
                &format!("{rule}, {n} wide"),
            );
        }
    }
}

#[test]
fn clips_within_clips_and_groups_are_as_in_the_exact_method() {
    let mut rng = Rng::new(4);
    for round in 0..12 {
        let mut shape = || {
            let points: Vec<Point> = (0..3).map(|_| rng.point(-6.0, 70.0)).collect();
            ring(&points)
        };
        let defs = format!(
            r##"<clipPath id="a"><path d="{}"/><path d="{}"/></clipPath>
            <clipPath id="b" clip-path="url(#a)"><path d="{}"/></clipPath>"##,
            shape(),
            shape(),
            shape()
        );
        let body = format!(
            r##"{defs}<path d="{}" fill="#06c"/><g opacity=".5" clip-path="url(#b)"><path d="{}" fill="#fa0"/>
            <path d="{}" fill="#0a4" fill-opacity=".7"/></g><path d="{}" fill="#fff" clip-path="url(#a)"/>"##,
            shape(),
            shape(),
            shape(),
            shape()
        );
        let document = svg(SIDE, SIDE, &body);
        let exact = render_with(&document, by(Method::Exact));
        for (method, most) in MASKS.into_iter().zip([1.0, 0.4]) {
            let mean = mean_difference(&render_with(&document, by(method)), &exact);
            assert!(mean <= most, "{method}, round {round}: {mean} levels in the mean");
        }
    }
}

#[test]
fn the_samples_are_near_the_exact_picture() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut seen = 0;
    println!("{:>24} {:>8} {:>8}  levels off exact in the mean", "", "mask", "mask64");
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|extension| extension != "svg") {
            continue;
        }
        let document = std::fs::read_to_string(&file).unwrap();
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let exact = render_with(&document, by(Method::Exact));
        let means = MASKS.map(|method| {
            // As people use it: with the flattening that is its default.
            let settings = Settings { threads: 1, ..Settings::of(method) };
            mean_difference(&render_with(&document, settings), &exact)
        });
        println!("{name:>24} {:>8.3} {:>8.3}", means[0], means[1]);
        // Half of what a border may err by, were there one in every pixel (as in rings.svg); all of it where
        // there are but few pixels (catmull-pixel.svg), or several borders in most (zone-plate.svg).
        let is_dense = exact.data().len() < 4 * 1000 || name == "zone-plate";
        let share = if is_dense { 1.0 } else { 0.5 };
        for (method, mean) in MASKS.into_iter().zip(means) {
            assert!(mean <= share * 255.0 * promised(method), "{name}, {method}: {mean}");
        }
        seen += 1;
    }
    assert!(seen > 10, "{seen} samples");
}
