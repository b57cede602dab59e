//! Takes the segments of one row of pixels, makes its colours: finds the runs without edges and
//! composites each once, and sweeps the pixels which hold edges.

use super::cell::{Cell, Edge, Steps, Sweep};
use super::clip::Cover;
use super::drawing::{Drawing, Geometry};
use super::gradient::Gradient;
use super::outline::Segment;
use super::paint::{light_of, Brush, Mixture};
use super::turns::{self, Trapezoid, Turn, PIXEL};
use super::{Colour, Options};
use kurbo::Point;
use std::collections::BTreeSet;
use std::ops::Range;

/// One row of the true picture.
pub(super) struct PaintedRow {
    /// Premultiplied, sRGB-encoded, in levels 0..=255.
    pub(super) pixels: Vec<[f64; 4]>,
    pub(super) swept: usize,
    pub(super) approximate: usize,
    pub(super) area_defect: f64,
}

/// Segments by the rows that they touch, each row's in order of geometry.
pub(super) struct Rows<'a> {
    segments: &'a [Segment],
    numbers: Vec<u32>,
    /// Row y has `numbers[starts[y]..starts[y + 1]]`.
    starts: Vec<usize>,
}

/// A counting sort: a segment is listed in every row [y, y + 1) that it enters.
pub(super) fn sort_into_rows(segments: &[Segment], height: usize) -> Rows<'_> {
    let rows = |s: &Segment| -> Range<usize> {
        let first = s.y_top.max(0.0) as usize;
        let end = (s.y_bottom.ceil() as usize).min(height);
        first..end
    };
    let mut starts = vec![0; height + 1];
    for row in segments.iter().flat_map(rows) {
        starts[row + 1] += 1;
    }
    for row in 0..height {
        starts[row + 1] += starts[row];
    }
    let mut free = starts.clone();
    let mut numbers = vec![0; starts[height]];
    for (number, segment) in segments.iter().enumerate() {
        for row in rows(segment) {
            numbers[free[row]] = number as u32;
            free[row] += 1;
        }
    }
    Rows { segments, numbers, starts }
}

impl<'a> Rows<'a> {
    pub(super) fn segments(&self, y: usize) -> impl Iterator<Item = &'a Segment> + '_ {
        self.numbers[self.starts[y]..self.starts[y + 1]].iter().map(|&n| &self.segments[n as usize])
    }
}

/// A segment clipped to the row; y from 0 (the row's top) to 1, x in pixels.
#[derive(Clone, Copy)]
struct Piece {
    x_top: f64,
    y_top: f64,
    x_bottom: f64,
    y_bottom: f64,
    winding: i32,
}

impl Piece {
    fn of(segment: &Segment, row: f64) -> Option<Piece> {
        let &Segment { x_top, y_top, x_bottom, y_bottom, winding, .. } = segment;
        let slope = (x_bottom - x_top) / (y_bottom - y_top);
        let x_at = |y: f64| (x_top + (y - y_top) * slope).clamp(x_top.min(x_bottom), x_top.max(x_bottom));
        let (mut piece_top, mut piece_bottom) = ((x_top, y_top - row), (x_bottom, y_bottom - row));
        if y_top < row {
            piece_top = (x_at(row), 0.0);
        }
        if y_bottom > row + 1.0 {
            piece_bottom = (x_at(row + 1.0), 1.0);
        }
        (piece_top.1 < piece_bottom.1).then_some(Piece {
            x_top: piece_top.0,
            y_top: piece_top.1,
            x_bottom: piece_bottom.0,
            y_bottom: piece_bottom.1,
            winding,
        })
    }

    fn x_min(&self) -> f64 {
        self.x_top.min(self.x_bottom)
    }

    fn x_max(&self) -> f64 {
        self.x_top.max(self.x_bottom)
    }

    /// Clips to column [x, x + 1): the part inside becomes an edge, the part to the left a step of
    /// the winding number, the part to the right nothing.
    fn clip(&self, x: f64, edges: &mut Vec<Edge>, steps: &mut Steps) {
        let y_at = |x: f64| {
            let slope = (self.y_bottom - self.y_top) / (self.x_bottom - self.x_top);
            (self.y_top + (x - self.x_top) * slope).clamp(self.y_top, self.y_bottom)
        };
        let (mut top, mut bottom) = ((self.x_top - x, self.y_top), (self.x_bottom - x, self.y_bottom));
        if top.0 < 0.0 {
            top = (0.0, y_at(x));
            steps.add(self.y_top, top.1, self.winding);
        } else if top.0 > 1.0 {
            top = (1.0, y_at(x + 1.0));
        }
        if bottom.0 < 0.0 {
            bottom = (0.0, y_at(x));
            steps.add(bottom.1, self.y_bottom, self.winding);
        } else if bottom.0 > 1.0 {
            bottom = (1.0, y_at(x + 1.0));
        }
        if top.1 < bottom.1 {
            edges.push(Edge {
                x_top: top.0,
                y_top: top.1,
                x_bottom: bottom.0,
                y_bottom: bottom.1,
                winding: self.winding,
                local: 0,
            });
        }
    }
}

/// The first column whose centre, at height `y`, lies on the segment or right of it; at most `width`.
/// The side is told by the sign of an area, without a division: exact where the coordinates are short.
fn first_centre(segment: &Segment, y: f64, width: usize) -> usize {
    let &Segment { x_top, y_top, x_bottom, y_bottom, .. } = segment;
    let is_left_of = |column: usize| {
        (x_bottom - x_top) * (y - y_top) <= (column as f64 + 0.5 - x_top) * (y_bottom - y_top)
    };
    let x = x_top + (x_bottom - x_top) * ((y - y_top) / (y_bottom - y_top));
    let mut column = ((x - 0.5).ceil().max(0.0) as usize).min(width);
    // The division may have been off by a little, so that x lies on the other side of a centre.
    if column > 0 && is_left_of(column - 1) {
        column -= 1;
    } else if column < width && !is_left_of(column) {
        column += 1;
    }
    column
}

/// A geometry's full pixels, or its edges in one pixel.
struct Run {
    columns: Range<usize>,
    geometry: u32,
}

/// Paints rows; keeps its buffers from one to the next.
pub(super) struct RowPainter<'a> {
    drawing: &'a Drawing,
    width: usize,
    linear: bool,
    background: Colour,
    runs: Vec<Run>,
    cells: Vec<Cell>,
    covers: Vec<Cover>,
    sweep: Sweep,
}

impl<'a> RowPainter<'a> {
    pub(super) fn new(drawing: &'a Drawing, width: usize, options: &Options) -> RowPainter<'a> {
        let background = options.background.map_or([0.0; 4], |straight| {
            let [r, g, b, a] = straight.map(|byte| f64::from(byte) / 255.0);
            [r * a, g * a, b * a, a]
        });
        RowPainter {
            drawing,
            width,
            linear: options.linear,
            background,
            runs: Vec::new(),
            cells: Vec::new(),
            covers: vec![Cover::Outside; drawing.geometries.len()],
            sweep: Sweep::default(),
        }
    }

    /// Row `y`, of which `segments` come in order of geometry.
    pub(super) fn paint<'s>(&mut self, y: usize, segments: impl Iterator<Item = &'s Segment>) -> PaintedRow {
        self.runs.clear();
        self.cells.clear();
        let mut shape = Vec::new();
        for segment in segments {
            if shape.first().is_some_and(|first: &&Segment| first.geometry != segment.geometry) {
                self.scan(y, &shape);
                shape.clear();
            }
            shape.push(segment);
        }
        self.scan(y, &shape);
        self.cells.sort_by_key(|cell| (cell.column, cell.geometry));
        self.colour(y)
    }

    /// What one geometry has in row `y`.
    fn scan(&mut self, y: usize, segments: &[&Segment]) {
        let Some(first) = segments.first() else { return };
        let drawing = self.drawing;
        let shape = &drawing.geometries[first.geometry as usize];
        let row = y as f64;
        if shape.jagged {
            self.scan_centres(first.geometry, shape, row + 0.5, segments);
        } else {
            let mut pieces: Vec<Piece> = segments.iter().filter_map(|s| Piece::of(s, row)).collect();
            self.scan_columns(first.geometry, shape, &mut pieces);
        }
    }

    /// A jagged shape covers the pixels whose centre it holds; a centre on an edge belongs to what
    /// lies right of the edge, or below a horizontal one. `y` is where the centres are.
    fn scan_centres(&mut self, geometry: u32, shape: &Geometry, y: f64, segments: &[&Segment]) {
        let mut steps: Vec<(usize, i32)> = segments
            .iter()
            .filter(|s| s.y_top <= y && y < s.y_bottom)
            .map(|s| (first_centre(s, y, self.width), s.winding))
            .collect();
        // Nothing beyond the right border has segments: what is inside there may not end.
        steps.push((self.width, 0));
        steps.sort_unstable();
        let mut winding = 0;
        for pair in steps.windows(2) {
            winding += pair[0].1;
            let columns = pair[0].0..pair[1].0;
            if shape.holds(winding) && !columns.is_empty() {
                self.runs.push(Run { columns, geometry });
            }
        }
    }

    /// Walks the row from the left: where no piece is near, the winding number decides for a whole
    /// run; every other column gets a cell.
    fn scan_columns(&mut self, geometry: u32, shape: &Geometry, pieces: &mut [Piece]) {
        pieces.sort_by(|a, b| a.x_min().total_cmp(&b.x_min()));
        let mut left = Steps::default();
        let mut active: Vec<Piece> = Vec::new();
        let (mut next, mut column) = (0, 0);
        while column < self.width {
            let x = column as f64;
            while next < pieces.len() && pieces[next].x_min() < x + 1.0 {
                active.push(pieces[next]);
                next += 1;
            }
            active.retain(|piece| {
                let passed = piece.x_max() <= x;
                if passed {
                    left.add(piece.y_top, piece.y_bottom, piece.winding);
                }
                !passed
            });
            if !active.is_empty() {
                self.cut(geometry, column, &active, &left);
                column += 1;
                continue;
            }
            let until = pieces.get(next).map_or(self.width, |piece| (piece.x_min() as usize).min(self.width));
            match left.constant() {
                Some(winding) if shape.holds(winding) => {
                    self.runs.push(Run { columns: column..until, geometry });
                }
                Some(_) => {}
                None => (column..until).for_each(|column| self.cut(geometry, column, &[], &left)),
            }
            column = until;
        }
    }

    /// A cell for the pieces which pass through `column`, with what lies to its left.
    fn cut(&mut self, geometry: u32, column: usize, pieces: &[Piece], left: &Steps) {
        let mut cell = Cell { column, geometry, edges: Vec::new(), steps: left.clone() };
        for piece in pieces {
            piece.clip(column as f64, &mut cell.edges, &mut cell.steps);
        }
        self.cells.push(cell);
    }

    /// Walks the row once more, over all geometries, and colours it.
    fn colour(&mut self, y: usize) -> PaintedRow {
        let mut row =
            PaintedRow { pixels: Vec::with_capacity(self.width), swept: 0, approximate: 0, area_defect: 0.0 };
        let (mut starts, mut ends): (Vec<&Run>, Vec<&Run>) =
            (self.runs.iter().collect(), self.runs.iter().collect());
        starts.sort_by_key(|run| run.columns.start);
        ends.sort_by_key(|run| run.columns.end);
        let (mut starts, mut ends) = (starts.into_iter().peekable(), ends.into_iter().peekable());
        let mut whole: BTreeSet<u32> = BTreeSet::new();
        let mut cells = self.cells.as_slice();
        let mut column = 0;
        while column < self.width {
            while let Some(run) = ends.next_if(|run| run.columns.end == column) {
                whole.remove(&run.geometry);
                self.covers[run.geometry as usize] = Cover::Outside;
            }
            while let Some(run) = starts.next_if(|run| run.columns.start == column) {
                whole.insert(run.geometry);
                self.covers[run.geometry as usize] = Cover::Inside;
            }
            let (here, rest) = cells.split_at(cells.partition_point(|cell| cell.column == column));
            cells = rest;
            let mut pixel = Pixel {
                drawing: self.drawing,
                covers: &mut self.covers,
                at: Point::new(column as f64, y as f64),
                background: self.background,
                linear: self.linear,
            };
            if here.is_empty() {
                let until = [
                    Some(self.width),
                    starts.peek().map(|run| run.columns.start),
                    ends.peek().map(|run| run.columns.end),
                    cells.first().map(|cell| cell.column),
                ];
                let until = until.into_iter().flatten().min().expect("at least the row's end");
                pixel.run(&whole, until - column, &mut row.pixels);
                column = until;
            } else {
                pixel.swept(&whole, here, &mut self.sweep, &mut row);
                column += 1;
            }
        }
        for run in &self.runs {
            self.covers[run.geometry as usize] = Cover::Outside;
        }
        row
    }
}

/// One pixel, or the first of a run.
struct Pixel<'a> {
    drawing: &'a Drawing,
    /// How each geometry stands to the pixel.
    covers: &'a mut [Cover],
    /// Its top left corner.
    at: Point,
    background: Colour,
    linear: bool,
}

impl Pixel<'_> {
    /// The painted shapes which can be seen in the pixel, the front first: none behind an opaque one
    /// which covers it whole. `whole` and `cut` are the geometries which touch it.
    fn visible(&self, whole: &BTreeSet<u32>, cut: &[Cell]) -> Vec<u32> {
        let mut visible = Vec::new();
        let mut whole = whole.iter().rev().copied().peekable();
        let mut cut = cut.iter().rev().map(|cell| cell.geometry).peekable();
        loop {
            let (shape, covers_whole) = match (whole.peek(), cut.peek()) {
                (Some(&w), Some(&c)) if c > w => (cut.next(), false),
                (Some(_), _) => (whole.next(), true),
                (None, _) => (cut.next(), false),
            };
            let Some(shape) = shape else { return visible };
            if self.drawing.geometries[shape as usize].brush.is_none() {
                continue;
            }
            let clip = self.drawing.clip_cover(shape, self.covers);
            if clip == Cover::Outside {
                continue;
            }
            visible.push(shape);
            if covers_whole && clip == Cover::Inside && self.drawing.is_opaque(shape) {
                return visible;
            }
        }
    }

    /// A run of pixels without edges.
    fn run(&mut self, whole: &BTreeSet<u32>, length: usize, out: &mut Vec<[f64; 4]>) {
        let visible = self.visible(whole, &[]);
        let seen = self.drawing.covering(&visible, self.covers);
        if self.gradients(&seen).next().is_none() {
            out.resize(out.len() + length, self.uniform(&seen));
            return;
        }
        for _ in 0..length {
            out.push(self.uniform(&seen));
            self.at.x += 1.0;
        }
    }

    /// The whole pixel, covered by `seen`.
    fn uniform(&self, seen: &[u32]) -> [f64; 4] {
        let mut mixture = Mixture::new(self.linear);
        self.add(seen, 1.0, &[PIXEL], &self.turns(seen), &mut mixture);
        mixture.levels()
    }

    fn gradients<'s>(&'s self, shapes: &'s [u32]) -> impl Iterator<Item = &'s Gradient> {
        let brush = |&shape: &u32| self.drawing.geometries[shape as usize].brush.as_ref();
        shapes.iter().filter_map(brush).filter_map(Brush::gradient)
    }

    /// Where the colours of shapes turn in the pixel.
    fn turns(&self, shapes: &[u32]) -> Turns {
        let mut gradients = self.gradients(shapes).peekable();
        if gradients.peek().is_none() {
            return Turns::Flat;
        }
        let all: Option<Vec<Vec<Turn>>> = gradients.map(|gradient| gradient.turns(self.at)).collect();
        all.map_or(Turns::TooMany, |all| Turns::At(all.into_iter().flatten().collect()))
    }

    /// Adds a region's colour, which `seen` cover, the front first; of the pixel's parts `area` is the
    /// sum.
    fn add(&self, seen: &[u32], area: f64, parts: &[Trapezoid], turns: &Turns, mixture: &mut Mixture) {
        let colour = |at: Point| self.drawing.composite(seen, at, self.background);
        if matches!(turns, Turns::Flat) || self.gradients(seen).next().is_none() {
            return mixture.add(colour(self.at), area);
        }
        let light = |at: Point| light_of(self.linear, colour(at));
        for part in parts {
            let part = part.moved(self.at.to_vec2());
            mixture.add_integral(match turns {
                Turns::At(turns) => turns::integral(&part, turns, light),
                Turns::TooMany | Turns::Flat => turns::sampled(&part, light),
            });
        }
    }

    /// A pixel with edges.
    fn swept(&mut self, whole: &BTreeSet<u32>, cells: &[Cell], sweep: &mut Sweep, row: &mut PaintedRow) {
        for cell in cells {
            self.covers[cell.geometry as usize] = Cover::Cut;
        }
        let visible = self.visible(whole, cells);
        let mut needed = BTreeSet::new();
        for &shape in &visible {
            if self.covers[shape as usize] == Cover::Cut {
                needed.insert(shape);
            }
            for &layer in self.drawing.chain(shape) {
                if let Some(clip) = self.drawing.layers[layer as usize].clip {
                    self.drawing.clips.cutting(clip, self.covers, &mut |geometry| {
                        needed.insert(geometry);
                    });
                }
            }
        }
        let cells_needed: Vec<&Cell> = cells.iter().filter(|cell| needed.contains(&cell.geometry)).collect();
        if cells_needed.is_empty() {
            row.pixels.push(self.uniform(&self.drawing.covering(&visible, self.covers)));
        } else {
            row.swept += 1;
            let levels = self.mix(&visible, &cells_needed, sweep, row);
            row.pixels.push(levels);
        }
        for cell in cells {
            self.covers[cell.geometry as usize] = Cover::Outside;
        }
    }

    fn mix(&mut self, visible: &[u32], cells: &[&Cell], sweep: &mut Sweep, row: &mut PaintedRow) -> [f64; 4] {
        let geometries = &self.drawing.geometries;
        let holds = |local: usize, winding: i32| geometries[cells[local].geometry as usize].holds(winding);
        let turns = self.turns(visible);
        let exact = sweep.run(cells, !matches!(turns, Turns::Flat), holds);
        row.approximate += usize::from(!exact || matches!(turns, Turns::TooMany));
        let total: f64 = sweep.regions().map(|(_, region)| region.area).sum();
        row.area_defect = row.area_defect.max((total - 1.0).abs());
        let mut mixture = Mixture::new(self.linear);
        for (covered, region) in sweep.regions() {
            for (local, cell) in cells.iter().enumerate() {
                let inside = covered[local / 64] >> (local % 64) & 1 == 1;
                self.covers[cell.geometry as usize] = if inside { Cover::Inside } else { Cover::Outside };
            }
            let seen = self.drawing.covering(visible, self.covers);
            self.add(&seen, region.area / total, &region.trapezoids, &turns, &mut mixture);
        }
        mixture.levels()
    }
}

/// How colours vary within a pixel.
enum Turns {
    Flat,
    /// Smoothly, but at these curves.
    At(Vec<Turn>),
    TooMany,
}
