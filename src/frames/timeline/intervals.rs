//! Takes when animations begin and end, by the clock and by each other, makes the intervals in which
//! each is active. After SMIL 3.0, 5.4.3 (computing the active duration) and 5.6 (the timing model).
//!
//! Every list of times is a set that only grows while intervals are found, so animations are gone
//! through again until nothing changes. Promises to end: the work is capped, and cut short it says so.

use std::collections::VecDeque;

/// Work beyond which no more intervals are looked for.
const MOST_WORK: usize = 4_000_000;
/// Most intervals of one animation.
const MOST_INTERVALS: usize = 20_000;
/// Times closer than this are one, in seconds.
pub(super) const SAME: f64 = 1e-9;

/// When an animation begins and ends.
#[derive(Clone, Debug, Default)]
pub(super) struct Timed {
    /// Offsets from the start of the document.
    pub begins: Vec<f64>,
    pub ends: Vec<f64>,
    pub begin_syncs: Vec<Sync>,
    pub end_syncs: Vec<Sync>,
    /// Whether `end` is given at all, and whether it may still come by an event.
    pub has_end: bool,
    pub end_may_come: bool,
    /// Length of one repetition; `None` is indefinite.
    pub simple: Option<f64>,
    /// May be infinite.
    pub repeat_count: Option<f64>,
    pub repeat_duration: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub restart: Restart,
}

/// A time relative to another animation's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sync {
    /// Number of the other animation.
    pub other: usize,
    pub moment: Moment,
    pub offset: f64,
}

/// A moment of each interval of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    Begin,
    End,
    /// When this repetition begins, if it does: the first after the beginning is number 1.
    Repeat(u32),
}

/// What a begin time within an interval does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Restart {
    #[default]
    Always,
    WhenNotActive,
    Never,
}

/// When an animation is active: [begin, end), in seconds; the end may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub begin: f64,
    pub end: f64,
}

/// Intervals of all animations that begin up to the horizon.
#[derive(Debug)]
pub(super) struct Schedule {
    pub horizon: f64,
    pub intervals: Vec<Vec<Interval>>,
    /// The work was cut short.
    pub cut: bool,
}

impl Schedule {
    pub(super) fn new(all: &[Timed], horizon: f64) -> Schedule {
        let mut dependents: Vec<Vec<usize>> = vec![Vec::new(); all.len()];
        for (i, timed) in all.iter().enumerate() {
            for sync in timed.begin_syncs.iter().chain(&timed.end_syncs) {
                dependents[sync.other].push(i);
            }
        }
        let mut intervals: Vec<Vec<Interval>> = vec![Vec::new(); all.len()];
        let mut queue: VecDeque<usize> = (0..all.len()).collect();
        let mut waits = vec![true; all.len()];
        let mut work = 0;
        while let Some(i) = queue.pop_front() {
            waits[i] = false;
            let begins = times(&all[i].begins, &all[i].begin_syncs, all, &intervals, horizon);
            let ends = times(&all[i].ends, &all[i].end_syncs, all, &intervals, f64::INFINITY);
            let found = all[i].intervals(&begins, &ends);
            work += 1 + begins.len() + ends.len();
            if work > MOST_WORK {
                return Schedule { horizon, intervals, cut: true };
            }
            if found != intervals[i] {
                intervals[i] = found;
                for &dependent in &dependents[i] {
                    if !std::mem::replace(&mut waits[dependent], true) {
                        queue.push_back(dependent);
                    }
                }
            }
        }
        Schedule { horizon, intervals, cut: false }
    }

    /// The last interval of an animation that has begun.
    pub(super) fn current(&self, animation: usize, time: f64) -> Option<Interval> {
        let intervals = &self.intervals[animation];
        let begun = intervals.partition_point(|interval| interval.begin <= time + SAME);
        begun.checked_sub(1).map(|last| intervals[last])
    }
}

/// All times of a list, sorted, without repetition.
fn times(
    fixed: &[f64],
    syncs: &[Sync],
    all: &[Timed],
    intervals: &[Vec<Interval>],
    horizon: f64,
) -> Vec<f64> {
    let mut times = fixed.to_vec();
    for sync in syncs {
        let base = intervals[sync.other].iter().filter_map(|interval| match sync.moment {
            Moment::Begin => Some(interval.begin),
            Moment::End => Some(interval.end),
            Moment::Repeat(number) => all[sync.other].repetition(number, interval),
        });
        times.extend(base.map(|time| time + sync.offset).filter(|time| time.is_finite()));
    }
    times.retain(|&time| time <= horizon);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() <= SAME);
    times.truncate(MOST_INTERVALS);
    times
}

impl Timed {
    fn intervals(&self, begins: &[f64], ends: &[f64]) -> Vec<Interval> {
        let mut found: Vec<Interval> = Vec::new();
        let mut next = 0;
        while let Some(&begin) = begins.get(next) {
            next += 1;
            let end = match ends.get(ends.partition_point(|&end| end < begin - SAME)) {
                Some(&end) => end,
                None if !self.has_end || self.end_may_come || ends.is_empty() => f64::INFINITY,
                None => break,
            };
            let mut end = begin + self.active_duration(end - begin);
            match self.restart {
                Restart::Always => {
                    if let Some(&again) = begins.get(next) {
                        end = end.min(again);
                    }
                }
                Restart::WhenNotActive | Restart::Never => {
                    next += begins[next..].partition_point(|&later| later < end - SAME);
                }
            }
            // What is over when the document starts has never been.
            if end > SAME || (begin.abs() <= SAME && end.abs() <= SAME) {
                found.push(Interval { begin, end });
                if self.restart == Restart::Never {
                    break;
                }
            }
        }
        found
    }

    /// When a repetition begins within an interval.
    fn repetition(&self, number: u32, interval: &Interval) -> Option<f64> {
        let time = interval.begin + f64::from(number) * self.simple?;
        let last = interval.end.min(interval.begin + self.repeated());
        (time < last - SAME).then_some(time)
    }

    /// How long its repetitions take: past that it holds still or is gone, even if it is still active.
    pub(super) fn repeated(&self) -> f64 {
        let simple = self.simple.unwrap_or(f64::INFINITY);
        match (self.repeat_count, self.repeat_duration) {
            (None, None) => simple,
            (count, duration) => {
                count.map_or(f64::INFINITY, |count| count * simple).min(duration.unwrap_or(f64::INFINITY))
            }
        }
    }

    /// How long it is active if nothing begins it again, `until_end` being the time to its end.
    fn active_duration(&self, until_end: f64) -> f64 {
        let natural = self.repeated();
        let (min, max) = (self.min.unwrap_or(0.0), self.max.unwrap_or(f64::INFINITY));
        let asked = natural.min(until_end.max(0.0));
        if min > max {
            asked
        } else {
            asked.max(min).min(max)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn once(begin: f64, simple: f64) -> Timed {
        Timed { begins: vec![begin], simple: Some(simple), ..Timed::default() }
    }

    fn found(all: &[Timed], horizon: f64) -> Vec<Vec<(f64, f64)>> {
        let round = |x: f64| (x * 1e6).round() / 1e6;
        let pair = |i: &Interval| (round(i.begin), round(i.end));
        Schedule::new(all, horizon).intervals.iter().map(|list| list.iter().map(pair).collect()).collect()
    }

    #[test]
    fn two_animations_that_begin_each_other_alternate() {
        let sync = |other| vec![Sync { other, moment: Moment::End, offset: 0.0 }];
        let a = Timed { begin_syncs: sync(1), ..once(0.0, 0.4) };
        let b = Timed { begins: vec![], begin_syncs: sync(0), ..once(0.0, 0.6) };
        assert_eq!(
            found(&[a, b], 2.5),
            [vec![(0.0, 0.4), (1.0, 1.4), (2.0, 2.4)], vec![(0.4, 1.0), (1.4, 2.0), (2.4, 3.0)]]
        );
    }

    #[test]
    fn a_begin_within_an_interval_restarts_unless_told_otherwise() {
        let begins = vec![0.0, 1.0, 5.0];
        let with = |restart| found(&[Timed { begins: begins.clone(), restart, ..once(0.0, 2.0) }], 9.0);
        assert_eq!(with(Restart::Always), [[(0.0, 1.0), (1.0, 3.0), (5.0, 7.0)].to_vec()]);
        assert_eq!(with(Restart::WhenNotActive), [[(0.0, 2.0), (5.0, 7.0)].to_vec()]);
        assert_eq!(with(Restart::Never), [[(0.0, 2.0)].to_vec()]);
    }

    #[test]
    fn repeats_and_bounds_make_the_active_duration() {
        let base = once(0.0, 2.0);
        let end = |timed: Timed| found(&[timed], 9.0)[0][0].1;
        assert_eq!(end(Timed { repeat_count: Some(2.5), ..base.clone() }), 5.0);
        assert_eq!(end(Timed { repeat_duration: Some(3.0), ..base.clone() }), 3.0);
        assert_eq!(end(Timed { repeat_count: Some(2.0), repeat_duration: Some(9.0), ..base.clone() }), 4.0);
        assert_eq!(end(Timed { repeat_count: Some(f64::INFINITY), ..base.clone() }), f64::INFINITY);
        assert_eq!(end(Timed { ends: vec![1.5], has_end: true, ..base.clone() }), 1.5);
        assert_eq!(end(Timed { min: Some(3.0), ..base.clone() }), 3.0);
        assert_eq!(end(Timed { max: Some(1.0), ..base.clone() }), 1.0);
        assert_eq!(end(Timed { min: Some(4.0), max: Some(1.0), ..base }), 2.0);
    }

    #[test]
    fn a_repetition_begins_others_unless_it_never_comes() {
        let after = |number| {
            let sync = Sync { other: 0, moment: Moment::Repeat(number), offset: 0.5 };
            let one = Timed { repeat_count: Some(2.5), ..once(1.0, 2.0) };
            found(&[one, Timed { begins: vec![], begin_syncs: vec![sync], ..once(0.0, 1.0) }], 20.0)[1]
                .clone()
        };
        assert_eq!(after(1), [(3.5, 4.5)]);
        assert_eq!(after(2), [(5.5, 6.5)]);
        assert_eq!(after(3), []);
    }

    #[test]
    fn what_ended_before_the_document_began_never_was() {
        assert_eq!(found(&[once(-5.0, 2.0)], 9.0), [[].to_vec()]);
        assert_eq!(found(&[once(-1.0, 2.0)], 9.0), [[(-1.0, 1.0)].to_vec()]);
    }

    #[test]
    fn a_chain_of_restarts_without_end_is_cut_short() {
        let itself = Sync { other: 0, moment: Moment::Begin, offset: 1e-7 };
        let timed = Timed { begin_syncs: vec![itself], ..once(0.0, 1.0) };
        assert!(Schedule::new(&[timed], 1e9).cut);
    }
}
