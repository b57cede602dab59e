//! Properties which every picture has, on seeded random scenes. Coordinates are multiples of 1/64,
//! which single precision holds exactly, wherever bytes must match.

mod support;

use support::*;
use toon_raster::kurbo::Affine;
use toon_raster::{Error, Pixmap, Renderer, Settings, Viewport};

const SIDE: u32 = 32;

/// A piece of a path from one point to the next.
#[derive(Clone, Copy, Debug)]
enum Piece {
    Line(Point),
    Quadratic(Point, Point),
    Cubic(Point, Point, Point),
}

impl Piece {
    fn end(self) -> Point {
        match self {
            Piece::Line(p) | Piece::Quadratic(_, p) | Piece::Cubic(_, _, p) => p,
        }
    }
}

/// A closed sub-path which may be walked in several ways.
#[derive(Clone, Debug)]
struct Outline {
    start: Point,
    pieces: Vec<Piece>,
}

impl Outline {
    /// Of three to seven pieces, all straight or some of them curved; its last piece ends where it began.
    fn random(rng: &mut Rng, curved: bool) -> Outline {
        let point = |rng: &mut Rng| rng.point(-2.0, f64::from(SIDE) + 2.0);
        let start = point(rng);
        let count = 3 + rng.below(5);
        let mut pieces = Vec::new();
        for i in 0..count {
            let end = if i + 1 == count { start } else { point(rng) };
            pieces.push(match rng.below(if curved { 3 } else { 1 }) {
                0 => Piece::Line(end),
                1 => Piece::Quadratic(point(rng), end),
                _ => Piece::Cubic(point(rng), point(rng), end),
            });
        }
        Outline { start, pieces }
    }

    fn data(&self) -> String {
        let mut d = format!("M{} {}", self.start[0], self.start[1]);
        for piece in &self.pieces {
            d += &match *piece {
                Piece::Line(p) => format!("L{} {}", p[0], p[1]),
                Piece::Quadratic(a, p) => format!("Q{} {} {} {}", a[0], a[1], p[0], p[1]),
                Piece::Cubic(a, b, p) => {
                    format!("C{} {} {} {} {} {}", a[0], a[1], b[0], b[1], p[0], p[1])
                }
            };
        }
        d + "Z"
    }

    fn reversed(&self) -> Outline {
        let mut starts = vec![self.start];
        starts.extend(self.pieces.iter().map(|piece| piece.end()));
        let pieces = self.pieces.iter().zip(starts).collect::<Vec<_>>().into_iter().rev();
        let pieces = pieces.map(|(piece, start)| match *piece {
            Piece::Line(_) => Piece::Line(start),
            Piece::Quadratic(a, _) => Piece::Quadratic(a, start),
            Piece::Cubic(a, b, _) => Piece::Cubic(b, a, start),
        });
        Outline { start: self.start, pieces: pieces.collect() }
    }

    /// Begins `by` pieces later.
    fn shifted(&self, by: usize) -> Outline {
        let mut pieces = self.pieces.clone();
        pieces.rotate_left(by % self.pieces.len());
        Outline { start: pieces[pieces.len() - 1].end(), pieces }
    }

    /// Stays at each of its vertices for a second, empty line.
    fn doubled(&self) -> Outline {
        let pieces = self.pieces.iter().flat_map(|&piece| [piece, Piece::Line(piece.end())]);
        Outline { start: self.start, pieces: pieces.collect() }
    }

    fn mapped(&self, map: impl Fn(Point) -> Point) -> Outline {
        let pieces = self.pieces.iter().map(|piece| match *piece {
            Piece::Line(p) => Piece::Line(map(p)),
            Piece::Quadratic(a, p) => Piece::Quadratic(map(a), map(p)),
            Piece::Cubic(a, b, p) => Piece::Cubic(map(a), map(b), map(p)),
        });
        Outline { start: map(self.start), pieces: pieces.collect() }
    }
}

/// A shape of a random scene.
#[derive(Clone, Debug)]
struct Shape {
    outlines: Vec<Outline>,
    colour: [u8; 3],
    opacity: f64,
    rule: Rule,
    clip: Option<Outline>,
}

/// Several shapes, back to front: opaque and translucent, of both rules, some clipped.
fn random_shapes(rng: &mut Rng, curved: bool) -> Vec<Shape> {
    (0..10)
        .map(|_| Shape {
            outlines: (0..1 + rng.below(3)).map(|_| Outline::random(rng, curved)).collect(),
            colour: rng.colour(),
            opacity: [1.0, 1.0, 0.5, 0.25][rng.below(4) as usize],
            rule: [Rule::NonZero, Rule::EvenOdd][rng.below(2) as usize],
            clip: (rng.below(4) == 0).then(|| Outline::random(rng, curved)),
        })
        .collect()
}

/// The elements of these shapes, whose outlines are walked as `walk` says; the first shape is
/// number `first`, for the ids of the clips.
fn elements(first: usize, shapes: &[Shape], walk: impl Fn(&[Outline]) -> Vec<Outline>) -> String {
    let mut body = String::new();
    for (i, shape) in shapes.iter().enumerate() {
        let data = |outlines: &[Outline]| walk(outlines).iter().map(Outline::data).collect::<String>();
        let rule = if shape.rule == Rule::EvenOdd { "evenodd" } else { "nonzero" };
        let mut attributes = format!("fill-opacity=\"{}\" fill-rule=\"{rule}\"", shape.opacity);
        if let Some(clip) = &shape.clip {
            let (id, clip) = (first + i, data(std::slice::from_ref(clip)));
            body += &format!("<clipPath id=\"c{id}\"><path d=\"{clip}\"/></clipPath>");
            attributes += &format!(" clip-path=\"url(#c{id})\"");
        }
        body += &path(&data(&shape.outlines), &hex(shape.colour), &attributes);
    }
    body
}

/// The document of these shapes, whose outlines are walked as `walk` says.
fn walked(shapes: &[Shape], walk: impl Fn(&[Outline]) -> Vec<Outline>) -> String {
    svg(SIDE, SIDE, &elements(0, shapes, walk))
}

fn document(shapes: &[Shape]) -> String {
    walked(shapes, <[Outline]>::to_vec)
}

/// Walks the outlines of random scenes in another way, which must change no byte.
#[track_caller]
fn assert_walk_is_free(seed: u64, what: &str, walk: impl Fn(&[Outline]) -> Vec<Outline>) {
    let mut rng = Rng::new(seed);
    for round in 0..16 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let expected = render(&document(&shapes));
        assert_same_bytes(&render(&walked(&shapes, &walk)), &expected, &format!("{what}, round {round}"));
    }
}

// -------------------------------------------------------------------------------------------- truth

/// The layers of straight shapes and their clips, and of each shape which layers are its own.
fn layers(shapes: &[Shape]) -> (Vec<Layer>, Vec<(usize, Option<usize>)>) {
    let ring = |outline: &Outline| {
        let ends = outline.pieces.iter().map(|piece| piece.end());
        std::iter::once(outline.start).chain(ends).collect::<Vec<Point>>()
    };
    let (mut layers, mut own) = (Vec::new(), Vec::new());
    for shape in shapes {
        own.push((layers.len(), shape.clip.as_ref().map(|_| layers.len() + 1)));
        layers.push(Layer { rings: shape.outlines.iter().map(ring).collect(), rule: shape.rule });
        layers.extend(shape.clip.as_ref().map(|clip| Layer::new(&ring(clip))));
    }
    (layers, own)
}

/// Premultiplied colour, 0 to 1, in front of another.
fn over(front: [f64; 4], back: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| front[i] + (1.0 - front[3]) * back[i])
}

#[test]
fn random_scenes_of_rules_veils_clips_and_a_group_are_the_exact_picture() {
    let mut rng = Rng::new(21);
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, false);
        let (back, front) = shapes.split_at(6);
        // Six shapes in a group of opacity 3/4, four before it, on white.
        let same = <[Outline]>::to_vec;
        let body = format!(
            "{}<g opacity=\".75\">{}</g>{}",
            rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#fff"),
            elements(0, back, same),
            elements(6, front, same)
        );
        let (layers, own) = layers(&shapes);
        let truth = Sweep::exact(&layers).picture(SIDE, SIDE, |inside| {
            let seen = |range: std::ops::Range<usize>, mut below: [f64; 4]| {
                for i in range {
                    let (shape, clip) = own[i];
                    if inside[shape] && clip.is_none_or(|clip| inside[clip]) {
                        let [r, g, b] = shapes[i].colour.map(|c| f64::from(c) / 255.0 * shapes[i].opacity);
                        below = over([r, g, b, shapes[i].opacity], below);
                    }
                }
                below
            };
            let group = seen(0..6, [0.0; 4]).map(|channel| 0.75 * channel);
            seen(6..10, over(group, [1.0; 4])).map(|channel| 255.0 * channel)
        });
        assert_matches(&render(&svg(SIDE, SIDE, &body)), &truth, STRAIGHT, &format!("round {round}"));
    }
}

// ------------------------------------------------------------------------------- how a path is walked

#[test]
fn a_path_walked_backwards_gives_the_same_bytes() {
    assert_walk_is_free(1, "backwards", |outlines| outlines.iter().map(Outline::reversed).collect());
}

#[test]
fn a_path_begun_at_another_vertex_gives_the_same_bytes() {
    for by in 1..4 {
        assert_walk_is_free(2, "shifted", |outlines| outlines.iter().map(|o| o.shifted(by)).collect());
    }
}

#[test]
fn doubled_vertices_give_the_same_bytes() {
    assert_walk_is_free(3, "doubled", |outlines| outlines.iter().map(Outline::doubled).collect());
}

#[test]
fn sub_paths_in_another_order_give_the_same_bytes() {
    assert_walk_is_free(4, "reordered", |outlines| outlines.iter().rev().cloned().collect());
}

#[test]
fn a_line_cut_at_its_exact_middle_gives_the_same_picture() {
    // Ends on the grid of 1/64: the middle is on that of 1/128, exact in single precision.
    let cut = |outline: &Outline| {
        let mut from = outline.start;
        let mut pieces = Vec::new();
        for &piece in &outline.pieces {
            if let Piece::Line(to) = piece {
                pieces.push(Piece::Line(middle(from, to)));
            }
            pieces.push(piece);
            from = piece.end();
        }
        Outline { start: outline.start, pieces }
    };
    let mut rng = Rng::new(5);
    for round in 0..16 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let halves = walked(&shapes, |outlines| outlines.iter().map(cut).collect());
        assert_within(&render(&halves), &render(&document(&shapes)), 1.0, &format!("round {round}"));
    }
}

#[test]
fn a_stroke_walked_backwards_is_the_same_picture() {
    let mut rng = Rng::new(6);
    for round in 0..12 {
        let outline = Outline::random(&mut rng, round % 2 == 1);
        let join = ["miter", "round", "bevel"][round % 3];
        let attributes = format!("stroke=\"#fff\" stroke-width=\"2.5\" stroke-linejoin=\"{join}\"");
        let draw = |o: &Outline| {
            let body =
                rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#000") + &path(&o.data(), "none", &attributes);
            render(&svg(SIDE, SIDE, &body))
        };
        assert_within(&draw(&outline.reversed()), &draw(&outline), CURVED, &format!("stroke {round}"));
    }
}

// ------------------------------------------------------------------------------------------ movement

#[test]
fn a_drawing_moved_by_whole_pixels_gives_the_same_bytes_moved() {
    let mut rng = Rng::new(7);
    for round in 0..10 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let still = render(&document(&shapes));
        let (dx, dy) = (rng.below(9) as u32, rng.below(9) as u32);
        let by = |p: Point| [p[0] + f64::from(dx), p[1] + f64::from(dy)];
        let moved = render(&walked(&shapes, |outlines| outlines.iter().map(|o| o.mapped(by)).collect()));
        assert_overlap(&moved, &still, dx, dy, &format!("moved in the file, round {round}"));
        let transform = Affine::translate((dx.into(), dy.into()));
        let viewport = Viewport { width: SIDE, height: SIDE, transform };
        let scene = scene(&document(&shapes));
        let moved = Renderer::new(settings()).expect("good settings").render(&scene, &viewport);
        let moved = moved.expect("a picture");
        assert_overlap(&moved, &still, dx, dy, &format!("moved by the viewport, round {round}"));
    }
}

#[track_caller]
fn assert_overlap(moved: &Pixmap, still: &Pixmap, dx: u32, dy: u32, what: &str) {
    assert_drawn(still, what);
    for y in dy..SIDE {
        for x in dx..SIDE {
            assert_eq!(moved.pixel(x, y), still.pixel(x - dx, y - dy), "{what}: pixel ({x}, {y})");
        }
    }
}

#[test]
fn a_drawing_in_a_mirror_is_the_same_picture_in_a_mirror() {
    let mut rng = Rng::new(8);
    let side = f64::from(SIDE);
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let plain = render(&document(&shapes));
        let mirrored = |map: &dyn Fn(Point) -> Point| {
            render(&walked(&shapes, |outlines| outlines.iter().map(|o| o.mapped(map)).collect()))
        };
        let last = SIDE - 1;
        let sideways = mirrored(&|p| [side - p[0], p[1]]);
        assert_mapped_within(&sideways, &plain, CURVED, "sideways", |x, y| (last - x, y));
        let upside_down = mirrored(&|p| [p[0], side - p[1]]);
        assert_mapped_within(&upside_down, &plain, CURVED, "upside down", |x, y| (x, last - y));
        let transposed = mirrored(&|p| [p[1], p[0]]);
        assert_mapped_within(&transposed, &plain, CURVED, "transposed", |x, y| (y, x));
    }
}

// ------------------------------------------------------------------------------- cut and hidden shapes

/// The two parts of a ring on the sides of the line through `at` along `along`.
fn parts(polygon: &[Point], at: Point, along: Point) -> [Vec<Point>; 2] {
    let normal = [along[1], -along[0]];
    let offset = normal[0] * at[0] + normal[1] * at[1];
    let single =
        |part: Vec<Point>| -> Vec<Point> { part.iter().map(|p| p.map(|v| f64::from(v as f32))).collect() };
    [
        single(clip_to_half_plane(polygon, normal, offset)),
        single(clip_to_half_plane(polygon, [-normal[0], -normal[1]], -offset)),
    ]
}

#[test]
fn a_shape_cut_in_two_along_any_line_is_the_same_picture() {
    let mut rng = Rng::new(9);
    for round in 0..40 {
        let polygon: Vec<Point> = (0..3 + rng.below(4)).map(|_| rng.point(0.0, SIDE.into())).collect();
        let (at, along) = (rng.point(8.0, 24.0), [rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)]);
        let back =
            path(&ring(&[rng.point(0.0, 32.0), rng.point(0.0, 32.0), rng.point(0.0, 32.0)]), "#f40", "");
        let black = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#000") + &back;
        // Self-crossing outlines make rings of several turns: the same rule must hold for the parts.
        let opacity = ["1", ".5"][round % 2];
        let attributes = format!("fill-opacity=\"{opacity}\"");
        let whole = render(&svg(SIDE, SIDE, &(black.clone() + &path(&ring(&polygon), "#4af", &attributes))));
        let [left, right] = parts(&polygon, at, along);
        let mut halves = black;
        for part in [left, right].iter().filter(|part| part.len() > 2) {
            halves += &path(&ring(part), "#4af", &attributes);
        }
        let halves = render(&svg(SIDE, SIDE, &halves));
        assert_within(&halves, &whole, CURVED, &format!("round {round}"));
    }
}

#[test]
fn a_shape_added_behind_an_opaque_one_changes_no_byte() {
    let mut rng = Rng::new(10);
    for round in 0..30 {
        let shapes = random_shapes(&mut rng, false);
        let (before, after) = shapes.split_at(5);
        // A triangle, and in it another one: its own double, one with two of its corners, one inside.
        let front: Vec<Point> = (0..3).map(|_| rng.point(0.0, SIDE.into())).collect();
        let inner = [
            front.clone(),
            front.iter().rev().copied().collect(),
            vec![front[0], front[1], middle(front[1], front[2])],
            vec![middle(front[0], front[1]), middle(front[1], front[2]), middle(front[2], front[0])],
        ][round % 4]
            .clone();
        let triangle = |points: &[Point], colour: [u8; 3]| Shape {
            outlines: vec![Outline {
                start: points[0],
                pieces: [1, 2, 0].map(|i| Piece::Line(points[i])).into(),
            }],
            colour,
            opacity: 1.0,
            rule: Rule::NonZero,
            clip: None,
        };
        let without = [before, &[triangle(&front, [18, 52, 86])], after].concat();
        let with = [before, &[triangle(&inner, [255, 0, 0]), triangle(&front, [18, 52, 86])], after].concat();
        let expected = render(&document(&without));
        assert_same_bytes(&render(&document(&with)), &expected, &format!("round {round}"));
    }
}

fn middle(a: Point, b: Point) -> Point {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
}

#[test]
fn shapes_behind_an_opaque_backdrop_change_no_byte() {
    let mut rng = Rng::new(11);
    let backdrop = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#abc");
    for round in 0..8 {
        let front = elements(0, &random_shapes(&mut rng, round % 2 == 1), <[Outline]>::to_vec);
        let hidden = elements(100, &random_shapes(&mut rng, round % 2 == 1), <[Outline]>::to_vec);
        let without = render(&svg(SIDE, SIDE, &format!("{backdrop}{front}")));
        let with = render(&svg(SIDE, SIDE, &format!("{hidden}{backdrop}{front}")));
        assert_same_bytes(&with, &without, &format!("round {round}"));
    }
}

// ------------------------------------------------------------------------------------------- tilings

/// A triangulation of more than the picture: a jittered grid whose cells are cut along either diagonal.
fn triangulation(rng: &mut Rng, pitch: f64) -> Vec<Vec<Point>> {
    let count = (f64::from(SIDE) / pitch) as usize + 4;
    let mut grid = vec![vec![[0.0; 2]; count]; count];
    for (j, row) in grid.iter_mut().enumerate() {
        for (i, point) in row.iter_mut().enumerate() {
            let jitter = |rng: &mut Rng| rng.on_grid(-0.3 * pitch, 0.3 * pitch);
            *point = [(i as f64 - 1.0) * pitch + jitter(rng), (j as f64 - 1.0) * pitch + jitter(rng)];
        }
    }
    let mut triangles = Vec::new();
    for j in 0..count - 1 {
        for i in 0..count - 1 {
            let [a, b, c, d] = [grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]];
            let (first, second) =
                if rng.below(2) == 0 { ([a, b, c], [a, c, d]) } else { ([a, b, d], [b, c, d]) };
            triangles.push(first.to_vec());
            triangles.push(second.into_iter().rev().collect());
        }
    }
    triangles
}

#[test]
fn a_tiling_in_one_colour_is_that_colour_exactly() {
    let mut rng = Rng::new(12);
    for pitch in [7.25, 2.5, 0.75] {
        let body: String =
            triangulation(&mut rng, pitch).iter().map(|t| path(&ring(t), "#4e8a2c", "")).collect();
        for settings in [settings(), Settings { linear: true, ..settings() }] {
            let picture = render_with(&svg(SIDE, SIDE, &body), settings);
            assert!(picture.data().chunks(4).all(|p| p == [0x4e, 0x8a, 0x2c, 255]), "pitch {pitch}");
        }
    }
}

#[test]
fn a_tiling_hides_what_is_behind_it() {
    let mut rng = Rng::new(13);
    for pitch in [6.5, 1.25] {
        let mut body = rect(0.0, 0.0, SIDE.into(), SIDE.into(), "#f00");
        for triangle in triangulation(&mut rng, pitch) {
            let [_, g, b] = rng.colour();
            body += &path(&ring(&triangle), &hex([0, g, b]), "");
        }
        let picture = render(&svg(SIDE, SIDE, &body));
        assert!(picture.data().chunks(4).all(|p| p[0] == 0 && p[3] == 255), "red shows at pitch {pitch}");
    }
}

#[test]
fn a_tiling_shows_no_seam_under_opacity_clip_or_gradient() {
    let mut rng = Rng::new(14);
    let triangles = triangulation(&mut rng, 3.75);
    let tiles = |fill: &str, attributes: &str| -> String {
        triangles.iter().map(|t| path(&ring(t), fill, attributes)).collect()
    };
    let whole = |fill: &str, attributes: &str| path("M-9 -9H99V99H-9Z", fill, attributes);
    let defs = "<clipPath id=\"c\"><path d=\"M3 2.5L30 5.25L26.5 29L2 20Z\"/></clipPath>\
                <linearGradient id=\"g\" gradientUnits=\"userSpaceOnUse\" x1=\"0\" x2=\"32\" y2=\"16\">\
                <stop stop-color=\"#f60\"/><stop offset=\"1\" stop-color=\"#06f\"/></linearGradient>";
    let half = "fill-opacity=\".5\"";
    let cases = [
        ("each tile half opaque", tiles("#8c4", half), whole("#8c4", half), 0.0),
        (
            "the group half opaque",
            format!("<g opacity=\".5\">{}</g>", tiles("#8c4", "")),
            format!("<g opacity=\".5\">{}</g>", whole("#8c4", "")),
            0.0,
        ),
        (
            "the group clipped",
            format!("<g clip-path=\"url(#c)\">{}</g>", tiles("#8c4", "")),
            format!("<g clip-path=\"url(#c)\">{}</g>", whole("#8c4", "")),
            1.0,
        ),
        (
            "each tile clipped",
            tiles("#8c4", "clip-path=\"url(#c)\""),
            whole("#8c4", "clip-path=\"url(#c)\""),
            1.0,
        ),
        ("one gradient", tiles("url(#g)", ""), whole("url(#g)", ""), 1.0),
    ];
    for (what, tiled, plain, levels) in cases {
        let draw = |body: &str| render(&svg(SIDE, SIDE, &format!("{defs}{body}")));
        let plain = draw(&plain);
        assert_within(&draw(&tiled), &plain, levels, what);
    }
}

/// A fence of 90 slanted bars narrower than half a pixel, moved by `shift`, inside 128 × 128 pixels.
///
/// The widths are no multiples of a 64th: 255 levels times such a part would all round upwards.
fn fence(shift: f64) -> Vec<Vec<Point>> {
    let mut rng = Rng::new(20);
    let bar = |i: i32| {
        let left = 8.0 + f64::from(i) * 57.0 / 64.0 + rng.between(0.0, 0.25);
        let right = left + rng.between(0.2, 0.5);
        let slant = 23.0;
        let points = [[left, 8.0], [right, 8.0], [right + slant, 116.0], [left + slant, 116.0]];
        points.map(|p| p.map(|v| f64::from((v + shift) as f32))).to_vec()
    };
    (0..90).map(bar).collect()
}

#[test]
fn a_fence_finer_than_a_pixel_keeps_its_light_while_it_moves() {
    let light = |bars: &[Vec<Point>], as_shapes: bool| {
        let body = if as_shapes {
            bars.iter().map(|bar| path(&ring(bar), "#fff", "")).collect()
        } else {
            path(&rings(bars), "#fff", "")
        };
        let picture = render(&svg(128, 128, &(rect(0.0, 0.0, 128.0, 128.0, "#000") + &body)));
        picture.data().chunks(4).map(|p| f64::from(p[0])).sum::<f64>() / 255.0
    };
    for step in (0..=64).step_by(8).chain([1, 5, 13]) {
        let bars = fence(f64::from(step) / 64.0);
        let expected: f64 = bars.iter().map(|bar| area(bar)).sum();
        for as_shapes in [false, true] {
            let found = light(&bars, as_shapes);
            let off = (found / expected - 1.0).abs();
            assert!(off < 1e-4, "step {step}: light {found}, should be {expected}: off by {off}");
        }
    }
}

// --------------------------------------------------------------------------------- the way of rendering

#[test]
fn the_number_of_threads_changes_no_byte() {
    let mut rng = Rng::new(15);
    for round in 0..6 {
        let scene = scene(&document(&random_shapes(&mut rng, true)));
        let viewport = Viewport::fit(&scene, 97, 131);
        let draw = |threads| {
            let settings = Settings { threads, ..settings() };
            Renderer::new(settings).expect("good settings").render(&scene, &viewport).expect("a picture")
        };
        let one = draw(1);
        for threads in [0, 2, 3, 7] {
            assert_same_bytes(&draw(threads), &one, &format!("round {round}, {threads} threads"));
        }
    }
}

#[test]
fn a_stride_wider_than_a_row_leaves_the_padding_alone() {
    let mut rng = Rng::new(16);
    let scene = scene(&document(&random_shapes(&mut rng, true)));
    let viewport = Viewport::fit(&scene, 37, 41);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let plain = renderer.render(&scene, &viewport).expect("a picture");
    assert_drawn(&plain, "plain");
    for padding in [1, 4, 100] {
        let stride = 37 * 4 + padding;
        // The last row needs no padding.
        let mut buffer = vec![0xa5; stride * 40 + 37 * 4];
        renderer.render_into(&scene, &viewport, &mut buffer, stride).expect("a picture");
        for (y, row) in buffer.chunks(stride).enumerate() {
            assert_eq!(&row[..37 * 4], &plain.data()[y * 37 * 4..(y + 1) * 37 * 4], "row {y}");
            assert!(row[37 * 4..].iter().all(|&b| b == 0xa5), "padding of row {y}");
        }
    }
}

#[test]
fn a_buffer_or_a_stride_too_small_is_an_error_and_nothing_is_written() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let viewport = Viewport::fit(&scene, 8, 8);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut buffer = vec![7; 8 * 8 * 4 - 1];
    let result = renderer.render_into(&scene, &viewport, &mut buffer, 32);
    assert!(
        matches!(result, Err(Error::Buffer { width: 8, height: 8, needed: 256, given: 255 })),
        "{result:?}"
    );
    assert!(buffer.iter().all(|&b| b == 7));
    let mut buffer = vec![7; 999];
    assert!(renderer.render_into(&scene, &viewport, &mut buffer, 31).is_err(), "a stride below a row");
}

#[test]
fn bands_are_the_rows_of_the_picture_from_top_to_bottom() {
    let mut rng = Rng::new(17);
    let scene = scene(&document(&random_shapes(&mut rng, true)));
    for threads in [1, 3] {
        for (width, height) in [(1, 1), (61, 1), (1, 67), (64, 200), (100, 333)] {
            let viewport = Viewport::fit(&scene, width, height);
            let settings = Settings { threads, ..settings() };
            let mut renderer = Renderer::new(settings).expect("good settings");
            let whole = renderer.render(&scene, &viewport).expect("a picture");
            assert!(width * height < 1000 || whole.data().iter().any(|&b| b != 0), "an empty picture");
            let mut rows = Vec::new();
            let sink = |band: &[u8]| {
                assert!(
                    !band.is_empty() && band.len().is_multiple_of(width as usize * 4),
                    "a band of whole rows"
                );
                rows.extend_from_slice(band);
                Ok(())
            };
            renderer.render_bands(&scene, &viewport, sink).expect("a picture");
            assert!(rows == whole.data(), "{width} x {height}, {threads} threads");
        }
    }
}

#[test]
fn an_error_of_the_sink_ends_the_rendering_and_comes_back() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let viewport = Viewport::fit(&scene, 64, 4000);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut calls = 0;
    let result = renderer.render_bands(&scene, &viewport, |_| {
        calls += 1;
        Err(std::io::Error::other("full").into())
    });
    assert!(matches!(&result, Err(Error::Io(error)) if error.to_string() == "full"), "{result:?}");
    assert_eq!(calls, 1, "nothing is sent after an error");
}

#[test]
fn a_renderer_used_before_gives_the_bytes_of_a_new_one() {
    let mut rng = Rng::new(18);
    let mut used = Renderer::new(settings()).expect("good settings");
    for round in 0..12 {
        let shapes = random_shapes(&mut rng, round % 2 == 1);
        let scene = scene(&document(&shapes));
        let (width, height) = ([97, 16, 200][round % 3], [33, 150, 7, 64][round % 4]);
        let viewport = Viewport::fit(&scene, width, height);
        let fresh = Renderer::new(settings()).expect("good settings").render(&scene, &viewport);
        let (again, fresh) = (used.render(&scene, &viewport).expect("a picture"), fresh.expect("a picture"));
        assert_same_bytes(&again, &fresh, &format!("round {round}"));
    }
}

#[test]
fn every_pixel_of_the_callers_buffer_is_written() {
    let scene = scene(&svg(16, 16, &rect(4.0, 4.0, 12.0, 12.0, "#fff")));
    let viewport = Viewport::fit(&scene, 16, 16);
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let mut buffer = vec![0xa5; 16 * 16 * 4];
    renderer.render_into(&scene, &viewport, &mut buffer, 64).expect("a picture");
    assert!(buffer == renderer.render(&scene, &viewport).expect("a picture").data());
    assert_eq!(&buffer[..4], &[0; 4], "what is empty is transparent");
    assert_eq!(&buffer[8 * 64 + 32..][..4], &[255; 4], "the square is white");
}

#[test]
fn settings_out_of_range_are_errors() {
    for tolerance in [0.0, -1.0, 1e-5, 101.0, f64::NAN, f64::INFINITY] {
        let result = Renderer::new(Settings { tolerance, ..settings() });
        assert!(matches!(result, Err(Error::Setting(_))), "tolerance {tolerance}");
    }
    for tolerance in [1e-4, 0.1, 100.0] {
        assert!(Renderer::new(Settings { tolerance, ..settings() }).is_ok(), "tolerance {tolerance}");
    }
}

#[test]
fn a_viewport_of_no_size_or_not_finite_is_an_error() {
    let scene = scene(&svg(8, 8, &rect(0.0, 0.0, 8.0, 8.0, "#fff")));
    let mut renderer = Renderer::new(settings()).expect("good settings");
    let good = Viewport::fit(&scene, 8, 8);
    let nan = Affine::new([f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0]);
    for bad in [
        Viewport { width: 0, ..good },
        Viewport { height: 0, ..good },
        Viewport { transform: nan, ..good },
        Viewport { transform: Affine::translate((f64::INFINITY, 0.0)), ..good },
    ] {
        let result = renderer.render(&scene, &bad);
        assert!(matches!(result, Err(Error::Size(_))), "{bad:?} gives {:?}", result.map(|_| "a picture"));
    }
}

#[test]
fn a_finer_tolerance_changes_curves_by_less_than_a_level() {
    let mut rng = Rng::new(19);
    for round in 0..8 {
        let document = document(&random_shapes(&mut rng, true));
        let fine = render_with(&document, Settings { tolerance: 1e-3, ..settings() });
        assert_within(&render(&document), &fine, CURVED, &format!("round {round}"));
    }
}
