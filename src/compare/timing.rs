//! Takes clock readings, makes what is reported of them: the median, how far they spread, and ratios
//! of runs that took turns.

use serde::Serialize;
use std::time::Duration;

/// Several runs of one thing, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the runs took less.
    pub median: f64,
    /// The shortest.
    pub min: f64,
    /// The longest.
    pub max: f64,
    /// The distance between the quartiles: half of the runs lie within it.
    pub spread: f64,
    /// How many.
    pub runs: usize,
}

impl Spread {
    /// `None` of no run.
    pub fn of(times: impl IntoIterator<Item = Duration>) -> Option<Spread> {
        let mut ms: Vec<f64> = times.into_iter().map(milliseconds).collect();
        ms.sort_by(f64::total_cmp);
        Some(Spread {
            median: quantile(&ms, 0.5)?,
            min: *ms.first()?,
            max: *ms.last()?,
            spread: quantile(&ms, 0.75)? - quantile(&ms, 0.25)?,
            runs: ms.len(),
        })
    }
}

/// Of a time.
pub fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// How many times as long as `base` the thing took: the median over the rounds in which both ran, so
/// that a busy moment of the machine falls on both.
pub fn ratio(times: &[Option<Duration>], base: &[Option<Duration>]) -> Option<f64> {
    let both = times.iter().zip(base).filter_map(|(a, b)| Some((*a)?.as_secs_f64() / (*b)?.as_secs_f64()));
    let mut ratios: Vec<f64> = both.filter(|r| r.is_finite()).collect();
    ratios.sort_by(f64::total_cmp);
    quantile(&ratios, 0.5)
}

/// Of sorted values, interpolated between the two nearest.
fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let at = (sorted.len().checked_sub(1)?) as f64 * q;
    let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
    Some(low + (high - low) * at.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(ms: &[u64]) -> Vec<Option<Duration>> {
        ms.iter().map(|&ms| (ms > 0).then(|| Duration::from_millis(ms))).collect()
    }

    #[test]
    fn one_slow_run_moves_the_maximum_alone() {
        let spread = Spread::of(times(&[4, 2, 3, 90, 1]).into_iter().flatten()).unwrap();
        assert_eq!((spread.median, spread.min, spread.max, spread.spread), (3.0, 1.0, 90.0, 2.0));
        assert_eq!(Spread::of([]), None);
    }

    #[test]
    fn a_ratio_takes_only_rounds_in_which_both_ran() {
        assert_eq!(ratio(&times(&[2, 4, 6]), &times(&[1, 2, 0])), Some(2.0));
        assert_eq!(ratio(&times(&[2]), &times(&[0])), None);
    }
}
