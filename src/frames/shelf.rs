//! Takes what was made for frames, keeps it by print for those to come.
//!
//! Promises: bounded memory.

use crate::scene::print::Print;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Frames whose things are always kept: those that several threads may be at.
const RECENT: u64 = 16;

/// What was made lately.
#[derive(Debug)]
pub(super) struct Shelf<T> {
    board: Mutex<Board<T>>,
    /// Things of frames long ago are dropped when all take more than this, in bytes.
    room: usize,
}

#[derive(Debug)]
struct Board<T> {
    things: HashMap<Print, Kept<T>>,
    weight: usize,
    /// Frames so far.
    now: u64,
}

#[derive(Debug)]
struct Kept<T> {
    thing: Arc<T>,
    weight: usize,
    used: u64,
}

impl<T> Shelf<T> {
    /// With room for so many bytes, and what the latest frames need.
    pub fn new(room: usize) -> Shelf<T> {
        Shelf { board: Mutex::new(Board { things: HashMap::new(), weight: 0, now: 0 }), room }
    }

    /// What is there for a frame, and the frame's number.
    pub fn find(&self, prints: impl IntoIterator<Item = Option<Print>>) -> (Vec<Option<Arc<T>>>, u64) {
        let mut board = self.lock();
        board.now += 1;
        let now = board.now;
        let mut find = |print| {
            let kept = board.things.get_mut(&print)?;
            kept.used = now;
            Some(kept.thing.clone())
        };
        (prints.into_iter().map(|print| print.and_then(&mut find)).collect(), now)
    }

    /// Keeps what was made for a frame: each thing with its weight in bytes.
    pub fn keep(&self, new: impl IntoIterator<Item = (Print, Arc<T>, usize)>, now: u64) {
        let mut board = self.lock();
        let board = &mut *board;
        for (print, thing, weight) in new {
            board.weight += weight;
            if let Some(old) = board.things.insert(print, Kept { thing, weight, used: now }) {
                board.weight -= old.weight;
            }
        }
        if board.weight > self.room {
            let oldest = board.now.saturating_sub(RECENT);
            board.things.retain(|_, kept| kept.used > oldest);
            board.weight = board.things.values().map(|kept| kept.weight).sum();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Board<T>> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_found_until_there_is_no_room_and_newer_frames_have_come() {
        let shelf = Shelf::new(100);
        let print = |n: u64| Print::new(n);
        for n in 0..RECENT + 4 {
            let (found, now) = shelf.find([Some(print(n)), None, n.checked_sub(1).map(print)]);
            assert_eq!(
                found.iter().map(|thing| thing.as_deref().copied()).collect::<Vec<_>>(),
                [None, None, n.checked_sub(1)]
            );
            shelf.keep([(print(n), Arc::new(n), 10)], now);
        }
        // The first were dropped when the eleventh came and they were old enough.
        let (found, _) = shelf.find([0, 1, RECENT].map(|n| Some(print(n))));
        assert_eq!(found.iter().map(|thing| thing.is_some()).collect::<Vec<_>>(), [false, false, true]);
    }
}
