//! Takes effects as they run, one within another, makes the record of them: which ran, how often, how
//! long each took by itself, and which highlights alias.
//!
//! Promises: no clock is read unless times are asked for, and a scene without effects has no log.

use std::cell::RefCell;
use std::time::{Duration, Instant};

/// One kind of effect, all of its runs in one picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectRuns {
    /// What SVG and CSS call it: `feGaussianBlur`, `mask`, `mix-blend-mode`, `pattern`, `image`.
    /// `layer content` is the drawing of groups that filters work on. `gradient` counts gradients and `colour
    /// map` the tables made for them; their time is a part of the bands', as is that of masks and blend modes
    /// for methods which evaluate these in every region of a pixel.
    pub name: &'static str,
    /// How often it ran.
    pub runs: u64,
    /// How long all of that took, other effects within it left out; zero unless
    /// [`crate::Settings::stage_times`] asks for times.
    pub time: Duration,
}

/// What aliases of one feSpecularLighting, were it drawn as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct LitSurface {
    /// The filter's id.
    pub filter: String,
    /// Phong's exponent.
    pub exponent: f32,
    /// Pixels of the lit surface.
    pub pixels: u64,
    /// Those where the highlight is sampled too sparsely.
    pub aliasing: u64,
    /// As many samples along a pixel's side would cure the worst of them; 1 or less: nothing aliases.
    pub sampling_rate: f32,
}

/// What has run for one scene.
#[derive(Debug, Default)]
pub(crate) struct Log {
    timed: bool,
    entries: RefCell<Entries>,
}

/// What a [`Log`] holds at the end.
#[derive(Debug, Default)]
pub(crate) struct Entries {
    pub effects: Vec<EffectRuns>,
    pub lit: Vec<LitSurface>,
    /// Time that went to effects within the one that runs.
    within: Duration,
}

impl Log {
    pub fn new(timed: bool) -> Log {
        Log { timed, entries: RefCell::default() }
    }

    pub fn is_timed(&self) -> bool {
        self.timed
    }

    /// Runs an effect. What it runs itself has its time to itself.
    pub fn run<T>(&self, name: &'static str, effect: impl FnOnce() -> T) -> T {
        if !self.timed {
            self.entries.borrow_mut().add(name, 1, Duration::ZERO);
            return effect();
        }
        let outer = std::mem::take(&mut self.entries.borrow_mut().within);
        let start = Instant::now();
        let made = effect();
        let whole = start.elapsed();
        let mut entries = self.entries.borrow_mut();
        let own = whole.saturating_sub(entries.within);
        entries.add(name, 1, own);
        entries.within = outer + whole;
        made
    }

    /// Counts what has no time of its own.
    pub fn count(&self, name: &'static str, runs: u64) {
        if runs > 0 {
            self.entries.borrow_mut().add(name, runs, Duration::ZERO);
        }
    }

    pub fn lit(&self, surface: LitSurface) {
        self.entries.borrow_mut().lit.push(surface);
    }

    /// Takes over what another renderer did within the effect that runs.
    pub fn absorb(&self, effects: &[EffectRuns], lit: &[LitSurface]) {
        let mut entries = self.entries.borrow_mut();
        for EffectRuns { name, runs, time } in effects {
            entries.add(name, *runs, *time);
            entries.within += *time;
        }
        entries.lit.extend_from_slice(lit);
    }

    pub fn into_entries(self) -> Entries {
        self.entries.into_inner()
    }
}

impl Entries {
    fn add(&mut self, name: &'static str, runs: u64, time: Duration) {
        match self.effects.iter_mut().find(|effect| effect.name == name) {
            Some(known) => {
                known.runs += runs;
                known.time += time;
            }
            None => self.effects.push(EffectRuns { name, runs, time }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAP: Duration = Duration::from_millis(3);

    #[test]
    fn an_effect_within_another_has_its_time_to_itself() {
        let log = Log::new(true);
        log.run("outer", || {
            log.run("inner", || std::thread::sleep(NAP));
            log.run("inner", || std::thread::sleep(NAP));
        });
        let effects = log.into_entries().effects;
        let [inner, outer] = &effects[..] else { panic!("{effects:?}") };
        assert_eq!((inner.name, inner.runs, outer.name, outer.runs), ("inner", 2, "outer", 1));
        assert!(inner.time >= 2 * NAP);
        // Whatever the machine does meanwhile, the outer one did not sleep.
        assert!(outer.time < inner.time, "{outer:?} {inner:?}");
    }

    #[test]
    fn without_times_runs_are_counted_and_no_clock_is_read() {
        let log = Log::new(false);
        log.run("mask", || std::thread::sleep(NAP));
        log.count("gradient", 0);
        assert_eq!(log.into_entries().effects, [EffectRuns { name: "mask", runs: 1, time: Duration::ZERO }]);
    }
}
