//! `grid`, `random`, `jitter` and `poisson`: supersampling. Takes a pixel's irregular pieces, asks at each
//! point of a pattern whether it lies inside; a fragment is the set of points that do.
//!
//! As the pattern may be another one in each pixel, pieces are kept as in the exact method, and x-buckets
//! and sweep are its own.

use super::patterns::Pattern;
use super::sets::{self, Bits, Sets};
use super::tally::Windings;
use crate::band::Picture;
use crate::bitmap::Bitmap;
use crate::coverage::{BandPlace, Coverage, Style, TakeSpans};
use crate::edges::{Edge, ONE};
use crate::pixel::fragment::{Cover, PieceSet, PieceSteps};
use crate::pixel::resolve::Surroundings;
use crate::scene::FillRule;
use crate::strips::{Buckets, Cell, Piece, NO_PIECE};
use crate::sweep::{self, FindCover};
use crate::zlist::{Entry, Head};

/// Fragments as sets of points.
pub(crate) struct Sampled<B> {
    buckets: Buckets,
    pieces: Vec<Piece>,
    finder: Finder<B>,
    parts: Sets<B>,
}

impl<B: Bits> Sampled<B> {
    pub fn new(width: u32, pattern: Pattern) -> Sampled<B> {
        Sampled {
            buckets: Buckets::new(width),
            pieces: Vec::new(),
            finder: Finder {
                pattern,
                y: 0,
                points: Vec::new(),
                windings: Windings::default(),
                set: PieceSet::default(),
            },
            parts: Sets::default(),
        }
    }
}

impl<B: Bits> Coverage for Sampled<B> {
    type Parts = Sets<B>;

    fn start(&mut self, _: &Picture) {
        self.pieces.clear();
    }

    fn parts(&mut self) -> &mut Sets<B> {
        &mut self.parts
    }

    #[inline]
    fn add(&mut self, edge: &Edge, place: BandPlace, _: Style, finished: &Bitmap) {
        self.buckets.add(edge, place, finished, &mut self.pieces);
    }

    fn row(
        &mut self,
        row: usize,
        columns: (usize, usize),
        place: BandPlace,
        style: Style,
        take: &mut impl TakeSpans<Sets<B>>,
    ) {
        let Sampled { buckets, pieces, finder, parts } = self;
        finder.y = place.top + row as u32;
        sweep::row(buckets, (row, columns), style, (finder, pieces), parts, take);
    }

    fn resolve(
        &mut self,
        head: Head,
        entries: &mut [Entry<B>],
        at: (u32, u32),
        around: &Surroundings,
    ) -> [u8; 4] {
        let finder = &self.finder;
        let all = finder.all();
        sets::resolve(head, entries, all, |set| finder.middle(set, at), at, around)
    }
}

/// Asks at the points of a pattern.
struct Finder<B> {
    pattern: Pattern,
    /// The picture's row at hand.
    y: u32,
    points: Vec<(i32, i32)>,
    windings: Windings<B>,
    set: PieceSet,
}

impl<B: Bits> FindCover for Finder<B> {
    type Fragment = B;

    fn find_cover(
        &mut self,
        cell: Cell,
        cover_left: i32,
        x: usize,
        style: Style,
        pieces: &mut Vec<Piece>,
    ) -> Cover<B> {
        let inside = if style.crisp {
            self.set.gather(cell.pieces, cover_left, pieces);
            if style.rule.inside(self.set.winding_at_half_units(ONE, ONE)) {
                self.all()
            } else {
                B::NONE
            }
        } else {
            self.pattern.points((x as u32, self.y), &mut self.points);
            self.inside(cell.pieces, cover_left, style.rule, pieces)
        };
        match inside {
            set if set == B::NONE => Cover::Empty,
            set if set == self.all() => Cover::Full,
            set => Cover::Part(set),
        }
    }
}

impl<B: Bits> Finder<B> {
    /// All points.
    fn all(&self) -> B {
        B::where_true(self.pattern.count(), |_| true)
    }

    /// The points that lie inside, by the list that ends with piece `last`.
    fn inside(&mut self, last: u32, cover_left: i32, rule: FillRule, pieces: &[Piece]) -> B {
        let all = self.all();
        let Finder { points, windings, .. } = self;
        windings.clear();
        let mut base = PieceSteps::new(cover_left);
        let mut next = last;
        while next != NO_PIECE {
            let piece = &pieces[next as usize];
            next = piece.next;
            if let Some((y, step)) = base.step(piece) {
                let below = B::where_true(points.len(), |i| points[i].1 >= i32::from(y));
                windings.add_number(below, step);
            }
            let [x0, y0, x1, y1] = [piece.x0, piece.y0, piece.x1, piece.y1].map(i32::from);
            let (dx, dy) = (x1 - x0, y1 - y0);
            let right = B::where_true(points.len(), |i| {
                let (x, y) = points[i];
                (y0 <= y) & (y < y1) & (dx * (y - y0) <= (x - x0) * dy)
            });
            windings.add_number(right, i32::from(piece.winding));
        }
        windings.add_number(all, base.corner());
        self.windings.inside(rule)
    }

    /// The mean place of some points of a pixel, within it.
    fn middle(&self, set: B, at: (u32, u32)) -> (f64, f64) {
        let mut points = Vec::new();
        self.pattern.points(at, &mut points);
        let mut sum = (0, 0);
        for (i, (x, y)) in points.iter().enumerate() {
            if set.has(i as u32) {
                sum = (sum.0 + i64::from(*x), sum.1 + i64::from(*y));
            }
        }
        let scale = 1.0 / f64::from(set.count()) / f64::from(ONE);
        (sum.0 as f64 * scale, sum.1 as f64 * scale)
    }
}
