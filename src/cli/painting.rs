//! Takes frames, makes their pictures: what they share with frames before is not made again.

use super::input;
use super::perf::SequenceWork;
use super::places::Source;
use super::report::Failure;
use super::size::{self, Part};
use super::view::{Seen, View};
use std::sync::atomic::{AtomicU64, Ordering};
use toon_raster::frames::cels::Cels;
use toon_raster::frames::gallery::{Gallery, Made};
use toon_raster::frames::packing::Packing;
use toon_raster::frames::sequence::AHEAD;
use toon_raster::frames::{blur, Timeline};
use toon_raster::render::{Canvas, TileCount};
use toon_raster::scene::load;
use toon_raster::{usvg, Pixmap, Renderer, Scene, Settings, Viewport};

/// One frame to be made.
pub struct Frame {
    pub number: u64,
    /// For messages.
    pub name: String,
    pub what: What,
}

pub enum What {
    /// The animated drawing at this many seconds.
    At(f64),
    Drawing(Source),
}

/// An open shutter.
#[derive(Clone, Copy)]
pub struct Shutter {
    /// How long it is open, in seconds.
    pub open: f64,
    /// Moments that are seen meanwhile.
    pub samples: u32,
}

/// An animated drawing, and the viewport of all its frames, whatever moves.
pub struct Film {
    pub timeline: Timeline,
    pub viewport: Viewport,
}

/// Makes pictures, on all threads.
pub struct Studio<'j> {
    view: &'j View,
    film: Option<&'j Film>,
    shutter: Option<Shutter>,
    /// Make each frame once more, from nothing, and compare.
    verify: bool,
    /// Of each renderer.
    threads: usize,
    cels: Cels,
    gallery: Gallery<Failure>,
    pub packing: Packing,
    painted: AtomicU64,
    tiles: AtomicU64,
    rendered: AtomicU64,
}

/// What each thread has of its own.
pub struct Painter {
    renderer: Option<Renderer>,
    /// For moments of a blurred frame.
    moment: Canvas,
}

impl<'j> Studio<'j> {
    /// For frames that `workers` make at once.
    pub fn new(
        (view, film): (&'j View, Option<&'j Film>),
        shutter: Option<Shutter>,
        verify: bool,
        workers: usize,
        packing: Packing,
    ) -> Studio<'j> {
        let gallery = Gallery::new((AHEAD + 1) * workers);
        // Renderers have one thread each, but for a frame alone.
        let threads = if workers > 1 { 1 } else { view.settings.threads };
        let [painted, tiles, rendered] = Default::default();
        let cels = Cels::new();
        Studio { view, film, shutter, verify, threads, cels, gallery, packing, painted, tiles, rendered }
    }

    pub fn painter(&self) -> Painter {
        Painter { renderer: None, moment: Canvas::new(1, 1) }
    }

    /// What was done so far.
    pub fn work(&self) -> SequenceWork {
        let [painted, tiles, rendered] =
            [&self.painted, &self.tiles, &self.rendered].map(|count| count.load(Ordering::Relaxed));
        SequenceWork { painted, tiles, rendered }
    }

    /// One frame's pixels.
    pub fn picture(&self, painter: &mut Painter, frame: &Frame) -> Made<Failure> {
        let made = match (&frame.what, self.film) {
            (What::Drawing(source), _) => self.gallery.picture(&frame.name, |canvas, lenders| {
                let (scene, viewport) = self.drawing(&input::read(source)?, &frame.name)?;
                self.paint(painter, (canvas, lenders), &scene, &viewport)
            }),
            (&What::At(time), Some(film)) => self.moving(painter, film, time, &frame.name),
            (What::At(_), None) => unreachable!("times are of an animated drawing"),
        };
        match made.as_ref() {
            Ok(canvas) if self.verify => match self.check(frame, canvas.picture()) {
                Ok(()) => made,
                Err(failure) => Made::new(Err(failure)),
            },
            _ => made,
        }
    }

    /// A frame of an animated drawing.
    fn moving(&self, painter: &mut Painter, film: &Film, time: f64, name: &str) -> Made<Failure> {
        let document = film.timeline.document_at(time);
        let moves = |time: &f64| film.timeline.document_at(*time) != document;
        match self.moments(time).skip(1).any(|time| moves(&time)) {
            false => self.gallery.picture(&document, |canvas, lenders| {
                self.paint(painter, (canvas, lenders), &self.moment(film, time)?, &film.viewport)
            }),
            true => self.gallery.picture(name, |canvas, lenders| {
                let scene = self.moment(film, time)?;
                let first = self.paint(painter, (canvas, lenders), &scene, &film.viewport)?;
                self.blur(painter, film, (first, time))
            }),
        }
    }

    /// The mean of a frame's moments, of which the first is painted.
    fn blur(
        &self,
        painter: &mut Painter,
        film: &Film,
        (mut first, time): (Canvas, f64),
    ) -> Result<Canvas, Failure> {
        let mut exposure = blur::Exposure::new(self.view.settings.linear);
        let mut last = String::new();
        for time in self.moments(time).skip(1) {
            let document = film.timeline.document_at(time);
            if document != last {
                let canvas = std::mem::replace(&mut painter.moment, Canvas::new(1, 1));
                let scene = self.moment(film, time)?;
                painter.moment = self.paint(painter, (canvas, &[&first]), &scene, &film.viewport)?;
                last = document;
            }
            exposure.add(&first, &painter.moment);
        }
        exposure.develop(&mut first);
        Ok(first)
    }

    /// When a frame is seen; once, or as long as the shutter is open.
    fn moments(&self, time: f64) -> impl Iterator<Item = f64> {
        let Shutter { open, samples } = self.shutter.unwrap_or(Shutter { open: 0.0, samples: 1 });
        (0..samples).map(move |k| time + open * f64::from(k) / f64::from(samples))
    }

    /// Paints what is new in a scene onto a canvas.
    fn paint(
        &self,
        painter: &mut Painter,
        (mut canvas, lenders): (Canvas, &[&Canvas]),
        scene: &Scene,
        viewport: &Viewport,
    ) -> Result<Canvas, Failure> {
        let renderer = match &mut painter.renderer {
            Some(renderer) => renderer,
            none => none.insert(self.renderer()?),
        };
        let TileCount { all, rendered } = renderer.render_onto(&mut canvas, lenders, scene, viewport)?;
        self.painted.fetch_add(1, Ordering::Relaxed);
        self.tiles.fetch_add(all, Ordering::Relaxed);
        self.rendered.fetch_add(rendered, Ordering::Relaxed);
        Ok(canvas)
    }

    fn renderer(&self) -> Result<Renderer, Failure> {
        Ok(Renderer::new(Settings { threads: self.threads, ..self.view.settings.clone() })?)
    }

    /// What an animated drawing shows at a time.
    fn moment(&self, film: &Film, time: f64) -> Result<Scene, Failure> {
        let options = &self.view.options;
        match &self.view.part {
            Part::Element { .. } => {
                let document = film.timeline.document_at(time);
                self.view.scene(&load::tree_from_bytes(document.as_bytes(), options)?)
            }
            Part::Page | Part::Drawing => Ok(film.timeline.scene_at(time, &self.cels, options)?),
        }
    }

    /// What a drawing shows, and its viewport. What it calls for and is not drawn is told.
    fn drawing(&self, bytes: &[u8], name: &str) -> Result<(Scene, Viewport), Failure> {
        let View { options, part, fit, max_pixels, .. } = self.view;
        let kept = match part {
            Part::Page => self.cels.scene(bytes, options),
            Part::Element { .. } | Part::Drawing => None,
        };
        let Some(scene) = kept else {
            let Seen { scene, viewport, .. } = self.view.see(bytes, name)?;
            return Ok((scene, viewport));
        };
        let size = usvg::Size::from_wh(scene.size().width as f32, scene.size().height as f32);
        let size = size.ok_or_else(|| Failure::input("the drawing has no size"))?;
        Ok((scene, size::page(size, *fit, *max_pixels)?))
    }

    /// Makes a frame from nothing, and compares.
    fn check(&self, frame: &Frame, picture: &Pixmap) -> Result<(), Failure> {
        let whole = self.whole(frame)?;
        match differ(picture, &whole) {
            None => Ok(()),
            Some(what) => Err(Failure::io(format!(
                "--verify-reuse: {what} rendered whole (a fault of this program: please report it)"
            ))),
        }
    }

    /// A frame made from nothing.
    fn whole(&self, frame: &Frame) -> Result<Pixmap, Failure> {
        let mut renderer = self.renderer()?;
        let View { options, part, fit, max_pixels, .. } = self.view;
        let mut render = |bytes: &[u8]| {
            let tree = load::tree_from_bytes(bytes, options)?;
            let viewport = match self.film {
                Some(film) => film.viewport,
                None => size::viewport(&tree, part, *fit, *max_pixels)?,
            };
            Ok::<_, Failure>(renderer.render(&self.view.scene(&tree)?, &viewport)?)
        };
        let (time, film) = match (&frame.what, self.film) {
            (What::Drawing(source), _) => return render(&input::read(source)?),
            (What::At(time), film) => (*time, film.expect("times are of an animated drawing")),
        };
        let mut exposure = blur::Exposure::new(self.view.settings.linear);
        let mut moments = self.moments(time);
        let mut moment = |time| Ok::<_, Failure>(render(film.timeline.document_at(time).as_bytes())?.into());
        let mut first: Canvas = moment(moments.next().expect("there is a moment"))?;
        for time in moments {
            exposure.add(&first, &moment(time)?);
        }
        exposure.develop(&mut first);
        Ok(first.into_picture())
    }
}

/// Where two pictures differ, in words that go on with how the second was made.
fn differ(one: &Pixmap, other: &Pixmap) -> Option<String> {
    let size = |picture: &Pixmap| (picture.width(), picture.height());
    let ((width, height), whole) = (size(one), size(other));
    if (width, height) != whole {
        return Some(format!("it has {width} x {height} pixels, and {} x {}", whole.0, whole.1));
    }
    let (one, other) = (one.data().as_chunks::<4>().0, other.data().as_chunks::<4>().0);
    let at = one.iter().zip(other).position(|(a, b)| a != b)?;
    let (x, y) = (at % width as usize, at / width as usize);
    Some(format!("the pixel at {x}, {y} is {:?}, and {:?}", one[at], other[at]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_pixel_that_differs_is_named() {
        let one = Pixmap::new(3, 2);
        let mut other = one.clone();
        assert_eq!(differ(&one, &other), None);
        other.data_mut()[4 * 4 + 1] = 9;
        let said = differ(&one, &other).unwrap();
        assert_eq!(said, "the pixel at 1, 1 is [0, 0, 0, 0], and [0, 9, 0, 0]");
        assert!(differ(&one, &Pixmap::new(2, 3)).is_some());
    }
}
