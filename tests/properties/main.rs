//! Properties which every picture has, on seeded random scenes. Coordinates are multiples of 1/64,
//! which single precision holds exactly, wherever bytes must match.

mod hidden;
mod movement;
mod rendering;
#[path = "../support/mod.rs"]
mod support;
mod tilings;
mod truth;
mod walks;

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

fn middle(a: Point, b: Point) -> Point {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
}
