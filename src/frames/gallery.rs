//! Takes pictures as they are made, keeps the latest: for frames that show the same document, and for
//! those that show the same in some of their tiles. Pictures that nobody looks at any more are painted over.
//!
//! Promises: bounded memory; what comes out does not depend on what is there, or on who made it.

use crate::render::Canvas;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Pictures whose tiles a new one may take over.
const LENDERS: usize = 4;

/// A picture, or why there is none.
pub type Made<E> = Arc<Result<Canvas, E>>;

/// The latest pictures, by what they show.
pub struct Gallery<E> {
    rooms: Mutex<Rooms<E>>,
    most: usize,
}

/// A place for one picture, which may still be in the making.
type Wall<E> = Arc<OnceLock<Made<E>>>;

struct Rooms<E> {
    /// The oldest first.
    shown: VecDeque<(String, Wall<E>)>,
    /// Taken down, but somebody may still look at them.
    stored: VecDeque<Made<E>>,
}

impl<E> Gallery<E> {
    /// Keeps up to `most` pictures, and as many that are on their way out.
    pub fn new(most: usize) -> Gallery<E> {
        let rooms = Rooms { shown: VecDeque::new(), stored: VecDeque::new() };
        Gallery { rooms: Mutex::new(rooms), most: most.max(1) }
    }

    /// The picture called `key`; if it is not there it is made, and if it is being made on another thread,
    /// waited for. `make` gets a canvas to paint on and some pictures to take tiles from
    /// ([`crate::Renderer::render_onto`]).
    pub fn picture(&self, key: &str, make: impl FnOnce(Canvas, &[&Canvas]) -> Result<Canvas, E>) -> Made<E> {
        let (wall, canvas, lenders) = self.hang(key);
        let paint = || {
            let lenders: Vec<&Canvas> =
                lenders.iter().filter_map(|made| made.as_ref().as_ref().ok()).collect();
            Arc::new(make(canvas, &lenders))
        };
        wall.get_or_init(paint).clone()
    }

    /// The place of a picture; what is needed to make it.
    fn hang(&self, key: &str) -> (Wall<E>, Canvas, Vec<Made<E>>) {
        let mut rooms = self.lock();
        let Rooms { shown, stored } = &mut *rooms;
        if let Some((_, wall)) = shown.iter().find(|(other, _)| other == key) {
            // Whoever began it makes it; should that have failed with a panic, this one starts from nothing.
            return (wall.clone(), Canvas::new(1, 1), Vec::new());
        }
        let made = shown.iter().rev().filter_map(|(_, wall)| wall.get().cloned());
        let lenders = made.take(LENDERS).collect();
        let wall = Wall::default();
        shown.push_back((key.to_string(), wall.clone()));
        if shown.len() > self.most {
            let old = shown.pop_front().and_then(|(_, wall)| wall.get().cloned());
            stored.extend(old);
        }
        let unseen = stored.iter().position(|made| Arc::strong_count(made) == 1);
        let canvas = unseen.and_then(|at| stored.remove(at)).and_then(|made| Arc::into_inner(made)?.ok());
        if stored.len() > self.most {
            stored.pop_front();
        }
        (wall, canvas.unwrap_or_else(|| Canvas::new(1, 1)), lenders)
    }

    fn lock(&self) -> MutexGuard<'_, Rooms<E>> {
        self.rooms.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pixmap;

    fn dot(byte: u8) -> Canvas {
        let mut dot = Pixmap::new(1, 1);
        dot.data_mut().fill(byte);
        dot.into()
    }

    #[test]
    fn the_same_document_is_painted_once() {
        let gallery: Gallery<()> = Gallery::new(2);
        let mut made = 0;
        for (key, byte) in [("a", 1), ("a", 1), ("b", 2), ("a", 1), ("c", 3), ("a", 1)] {
            let picture = gallery.picture(key, |_, _| {
                made += 1;
                Ok(dot(byte))
            });
            assert_eq!(picture.as_ref().as_ref().unwrap().picture().data()[0], byte);
        }
        // "a" is forgotten when "c" comes, as the oldest of three.
        assert_eq!(made, 4);
    }

    #[test]
    fn a_picture_is_painted_over_only_when_nobody_looks_at_it() {
        let gallery: Gallery<()> = Gallery::new(1);
        let seen = gallery.picture("a", |_, _| Ok(dot(1)));
        let over = |key: &str| {
            let mut found = 0;
            gallery.picture(key, |canvas, _| {
                found = canvas.picture().data()[0];
                Ok(dot(9))
            });
            found
        };
        assert_eq!(over("b"), 0);
        drop(seen);
        assert_eq!(over("c"), 1);
        assert_eq!(over("d"), 9);
    }

    #[test]
    fn a_failure_lends_nothing_and_is_told_again() {
        let gallery: Gallery<&str> = Gallery::new(3);
        for _ in 0..2 {
            let failed = gallery.picture("a", |_, _| Err("broken"));
            assert_eq!(failed.as_ref().as_ref().err(), Some(&"broken"));
        }
        gallery.picture("b", |_, lenders| {
            assert!(lenders.is_empty());
            Ok(dot(1))
        });
    }
}
