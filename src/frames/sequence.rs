//! Takes a way to make one frame, makes many: on all threads, handed out in order, in bounded memory.
//!
//! Promises: what is handed out does not depend on the number of threads; no more than [`AHEAD`] frames
//! a thread are made before their turn.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Frames that a thread may be ahead of the one to be handed out.
pub const AHEAD: usize = 2;

/// Stack of a working thread: drawings may be nested a thousand levels deep. Touched only so far.
const DEEP_STACK: usize = 64 << 20;

/// Makes frames `0..count` on `threads` threads, each with its own `worker`, and hands them to `sink` in
/// order, on this thread, until it says `false`.
///
/// # Errors
/// When no thread can be started.
pub fn in_order<W, T: Send>(
    count: usize,
    threads: usize,
    worker: impl Fn() -> W + Sync,
    make: impl Fn(&mut W, usize) -> T + Sync,
    mut sink: impl FnMut(usize, T) -> bool,
) -> std::io::Result<()> {
    let threads = threads.clamp(1, count.max(1));
    let queue = Queue { state: Mutex::new(State::default()), changed: Condvar::new() };
    std::thread::scope(|scope| {
        // However this ends, those who wait are told.
        let _stop = Stop(&queue);
        for _ in 0..threads {
            let (queue, worker, make) = (&queue, &worker, &make);
            let work = move || {
                let _end = End(queue);
                let mut worker = worker();
                while let Some(number) = queue.take(count, AHEAD * threads) {
                    let made = make(&mut worker, number);
                    queue.put(number, made);
                }
            };
            std::thread::Builder::new().stack_size(DEEP_STACK).spawn_scoped(scope, work)?;
        }
        for number in 0..count {
            let Some(made) = queue.wait_for(number, threads) else { break };
            if !sink(number, made) {
                break;
            }
        }
        Ok(())
    })
}

struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

struct State<T> {
    next: usize,
    made: BTreeMap<usize, T>,
    handed_out: usize,
    /// Working threads that have ended.
    ended: usize,
    stop: bool,
}

impl<T> Default for State<T> {
    fn default() -> Self {
        State { next: 0, made: BTreeMap::new(), handed_out: 0, ended: 0, stop: false }
    }
}

impl<T> Queue<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next number to be made, once it is not too far ahead.
    fn take(&self, count: usize, window: usize) -> Option<usize> {
        let mut state = self.lock();
        loop {
            if state.stop || state.next >= count {
                return None;
            }
            if state.next < state.handed_out + window {
                state.next += 1;
                return Some(state.next - 1);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn put(&self, number: usize, made: T) {
        self.lock().made.insert(number, made);
        self.changed.notify_all();
    }

    /// What was made of this number; `None` if all threads are gone without it.
    fn wait_for(&self, number: usize, threads: usize) -> Option<T> {
        let mut state = self.lock();
        loop {
            if let Some(made) = state.made.remove(&number) {
                state.handed_out = number + 1;
                self.changed.notify_all();
                return Some(made);
            }
            if state.ended == threads {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Counts a working thread out when it ends, by whatever way.
struct End<'q, T>(&'q Queue<T>);

impl<T> Drop for End<'_, T> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.ended += 1;
        state.stop |= std::thread::panicking();
        drop(state);
        self.0.changed.notify_all();
    }
}

/// Sends the working threads home once nothing more is handed out.
struct Stop<'q, T>(&'q Queue<T>);

impl<T> Drop for Stop<'_, T> {
    fn drop(&mut self) {
        self.0.lock().stop = true;
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn frames_come_in_order_whoever_made_them() {
        for threads in [1, 2, 7] {
            let mut seen = Vec::new();
            let make = |_: &mut (), n: usize| {
                std::thread::sleep(std::time::Duration::from_micros((n * 7919 % 13) as u64 * 50));
                n * n
            };
            in_order(
                50,
                threads,
                || (),
                make,
                |n, square| {
                    seen.push((n, square));
                    true
                },
            )
            .unwrap();
            assert_eq!(seen, (0..50).map(|n| (n, n * n)).collect::<Vec<_>>(), "{threads} threads");
        }
    }

    #[test]
    fn no_frame_is_made_far_ahead_of_its_turn() {
        let handed_out = AtomicUsize::new(0);
        let make = |_: &mut (), n: usize| {
            assert!(n <= handed_out.load(Ordering::SeqCst) + 3 * AHEAD);
            n
        };
        in_order(
            200,
            3,
            || (),
            make,
            |n, _| {
                handed_out.store(n + 1, Ordering::SeqCst);
                true
            },
        )
        .unwrap();
        assert_eq!(handed_out.load(Ordering::SeqCst), 200);
    }

    #[test]
    fn the_sink_can_end_it() {
        let mut seen = 0;
        in_order(
            1_000_000,
            2,
            || (),
            |(), n| n,
            |n, _| {
                seen += 1;
                n < 9
            },
        )
        .unwrap();
        assert_eq!(seen, 10);
    }
}
