//! Which steps lead through a run: they end exactly at output times and at the discontinuities of load histories.

use keys::{Key, Keyed};
use serde::{Deserialize, Serialize};

use crate::simulation::checkpoint::{CheckpointError, counts, expect, finite};

/// How long the steps are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum StepControl {
    /// Steps of at most this length; between two stops all are equally long.
    Fixed(f64),
    /// As long as the estimated errors of all steps stay below this in sum: a step of length h may err by h/end of it.
    Tolerance(f64),
}

/// When the motion is observed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Rows {
    /// At the beginning, after every N-th step, and at the end.
    EverySteps(u64),
    /// At the beginning, at every multiple of this time, and at the end.
    Interval(f64),
}

/// A stretch of time without a discontinuity or an output time inside.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Segment {
    pub start: f64,
    pub end: f64,
    /// `end − start`; segments that are equally long but for rounding have the very same length, so that what belongs
    /// to a step's length need not be computed again.
    pub length: f64,
    /// True if the end is a discontinuity.
    pub discontinuity: bool,
}

impl Segment {
    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("a segment of the run", [&self.start, &self.end, &self.length])
    }
}

/// The segments of a run.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    end: f64,
    /// Discontinuities within the run, sorted, and how many of them have been passed.
    discontinuities: Vec<f64>,
    passed: usize,
    interval: Option<f64>,
    /// Output times passed.
    outputs: u64,
    reached: f64,
    last_length: f64,
    /// A time to stop at.
    stop: Option<f64>,
}

/// How far a plan has come.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Progress {
    #[serde(with = "postcard::fixint::le")]
    outputs: u64,
    reached: f64,
    last_length: f64,
}

impl Plan {
    pub(crate) fn new(end: f64, discontinuities: impl Iterator<Item = f64>, rows: Rows) -> Self {
        let mut discontinuities: Vec<f64> = discontinuities.filter(|t| *t > 0.0 && *t < end).collect();
        discontinuities.sort_by(f64::total_cmp);
        let interval = match rows {
            Rows::Interval(interval) => Some(interval),
            Rows::EverySteps(_) => None,
        };
        Self { end, discontinuities, passed: 0, interval, outputs: 0, reached: 0.0, last_length: 0.0, stop: None }
    }

    /// How far it has come.
    pub(crate) fn progress(&self) -> Progress {
        Progress { outputs: self.outputs, reached: self.reached, last_length: self.last_length }
    }

    /// Goes on from there.
    pub(crate) fn set_progress(&mut self, progress: &Progress) -> Result<(), CheckpointError> {
        let Progress { outputs, reached, last_length } = *progress;
        counts(&[outputs])?;
        finite("the end of the segment", [&reached, &last_length])?;
        self.passed = self.discontinuities_passed(reached);
        (self.outputs, self.reached, self.last_length) = (outputs, reached, last_length);
        Ok(())
    }

    fn discontinuities_passed(&self, time: f64) -> usize {
        let same = self.same();
        self.discontinuities.partition_point(|discontinuity| *discontinuity <= time + same)
    }

    /// Sets or takes back a time to stop at.
    pub(crate) fn set_stop(&mut self, time: Option<f64>) {
        self.stop = time;
    }

    /// The time to stop at.
    pub(crate) fn stop(&self) -> Option<f64> {
        self.stop
    }

    /// True, once, if a time is the stop time, or beyond it.
    pub(crate) fn take_stop(&mut self, time: f64) -> bool {
        let same = self.same();
        self.stop.take_if(|stop| *stop <= time + same).is_some()
    }

    /// True if two times are one but for rounding.
    pub(crate) fn are_same(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= self.same()
    }

    /// True if a time is the end, or beyond it.
    pub(crate) fn is_over(&self, time: f64) -> bool {
        time >= self.end - self.same()
    }

    /// The segments to come start at this time.
    pub(crate) fn go_to(&mut self, time: f64) {
        let same = self.same();
        self.reached = time;
        self.passed = self.discontinuities_passed(time);
        self.outputs = self.interval.map_or(0, |interval| ((time + same) / interval).floor().max(0.0) as u64);
    }

    /// Times closer than rounding makes them are one.
    pub(crate) fn same(&self) -> f64 {
        1e-13 * self.end
    }

    /// The next segment; `None` at the end.
    pub(crate) fn next_segment(&mut self) -> Option<Segment> {
        let same = self.same();
        if self.is_over(self.reached) {
            return None;
        }
        let output = self.interval.map_or(f64::INFINITY, |interval| (self.outputs + 1) as f64 * interval);
        while self.discontinuities.get(self.passed).is_some_and(|discontinuity| *discontinuity <= self.reached + same) {
            self.passed += 1;
        }
        let discontinuity = self.discontinuities.get(self.passed).copied().unwrap_or(f64::INFINITY);
        let mut stop = discontinuity.min(output).min(self.end);
        let is_output = (output - stop).abs() <= same;
        if is_output {
            self.outputs += 1;
            stop = output.min(self.end);
        }
        if (self.end - stop).abs() <= same {
            stop = self.end;
        }
        if let Some(asked) = self.stop.filter(|asked| *asked > self.reached + same && *asked < stop - same) {
            self.outputs -= u64::from(is_output);
            stop = asked;
        }
        let mut length = stop - self.reached;
        if (length - self.last_length).abs() <= 8.0 * f64::EPSILON * self.end {
            length = self.last_length;
        }
        self.last_length = length;
        let segment =
            Segment { start: self.reached, end: stop, length, discontinuity: (discontinuity - stop).abs() <= same };
        self.reached = stop;
        Some(segment)
    }
}

/// Equal steps through a segment.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct EqualSteps {
    pub segment: Segment,
    #[serde(with = "postcard::fixint::le")]
    count: u64,
    #[serde(with = "postcard::fixint::le")]
    done: u64,
}

impl EqualSteps {
    /// The fewest steps of at most `step`.
    pub(crate) fn new(segment: Segment, step: f64) -> Self {
        // A step that divides the segment but for rounding is left as it is.
        let count = (segment.length / step * (1.0 - 1e-12)).ceil().max(1.0) as u64;
        Self { segment, count, done: 0 }
    }

    /// Refuses what no run leaves.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        self.segment.check()?;
        counts(&[self.count])?;
        expect("the number of steps done", self.done <= self.count)
    }

    /// True if all steps have been handed out.
    pub(crate) fn is_done(&self) -> bool {
        self.done == self.count
    }

    /// Length and end of the next step; `None` at the segment's end.
    pub(crate) fn next_step(&mut self) -> Option<(f64, f64)> {
        if self.is_done() {
            return None;
        }
        self.done += 1;
        let h = self.segment.length / self.count as f64;
        let end = if self.done == self.count { self.segment.end } else { self.segment.start + self.done as f64 * h };
        Some((h, end))
    }
}

/// Steps through a segment whose lengths are its length over a power of two, so that they end exactly at its end and
/// few different lengths occur.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct HalvedSteps {
    pub segment: Segment,
    /// Steps are `length / 2^level` long.
    level: u32,
    /// Level of the longest step allowed.
    lowest_level: u32,
    /// Steps of this length that have been done.
    #[serde(with = "postcard::fixint::le")]
    done: u64,
}

/// A step shorter than the segment over 2 to this power makes no progress.
const DEEPEST: u32 = 40;

impl HalvedSteps {
    /// Through `segment` in steps not above `longest`, beginning with one not above `step`.
    pub(crate) fn new(segment: Segment, step: f64, longest: f64) -> Self {
        let level_of =
            |step: f64| (segment.length / step * (1.0 - 1e-9)).log2().ceil().clamp(0.0, f64::from(DEEPEST)) as u32;
        let lowest_level = level_of(longest);
        Self { segment, level: level_of(step).max(lowest_level), lowest_level, done: 0 }
    }

    /// Refuses what no run leaves.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        self.segment.check()?;
        expect("the halvings of the step", self.level.max(self.lowest_level) <= DEEPEST)?;
        expect("the number of steps done", self.done <= 1 << self.level)
    }

    /// Length and end of the next step; `None` at the segment's end.
    pub(crate) fn next_step(&self) -> Option<(f64, f64)> {
        let count = 1u64 << self.level;
        if self.done == count {
            return None;
        }
        let h = self.length();
        let done = self.done + 1;
        let end = if done == count { self.segment.end } else { self.segment.start + done as f64 * h };
        Some((h, end))
    }

    /// Length of the present steps.
    pub(crate) fn length(&self) -> f64 {
        self.segment.length / (1u64 << self.level) as f64
    }

    /// The step was taken; the next may be twice as long where that is allowed and ends with the segment.
    pub(crate) fn accept(&mut self, may_double: bool) {
        self.done += 1;
        if may_double && self.level > self.lowest_level && self.done.is_multiple_of(2) {
            self.level -= 1;
            self.done /= 2;
        }
    }

    /// The step was not taken: shorter ones from here. `false` where they are as short as can be.
    pub(crate) fn reject(&mut self, error: f64) -> bool {
        let halvings = if error.is_finite() { (error / 0.8).log2() / 4.0 } else { 2.0 };
        let halvings = halvings.ceil().clamp(1.0, 6.0) as u32;
        if self.level + halvings > DEEPEST {
            return false;
        }
        self.level += halvings;
        self.done <<= halvings;
        true
    }
}

impl Keyed for StepControl {
    fn key(&self, key: Key) -> Key {
        match self {
            Self::Fixed(step) => key.of("step", 1).with("length", step),
            Self::Tolerance(tolerance) => key.of("tolerance", 1).with("error", tolerance),
        }
    }
}

impl Keyed for Rows {
    fn key(&self, key: Key) -> Key {
        match self {
            Self::EverySteps(steps) => key.of("every steps", 1).with("steps", steps),
            Self::Interval(interval) => key.of("interval", 1).with("time", interval),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_at_discontinuities_and_output_times_and_equal_ones_have_equal_lengths() {
        let mut plan = Plan::new(0.5, [0.02013, 0.0, 0.1, 0.7].into_iter(), Rows::Interval(0.1));
        let mut ends = Vec::new();
        let mut lengths = Vec::new();
        while let Some(segment) = plan.next_segment() {
            ends.push(segment.end);
            lengths.push(segment.length);
        }
        assert_eq!(ends, [0.02013, 0.1, 0.2, 3.0 * 0.1, 0.4, 0.5]);
        assert!(lengths[3].to_bits() == lengths[4].to_bits() && lengths[4].to_bits() == lengths[5].to_bits());
    }

    #[test]
    fn a_step_that_divides_the_end_is_kept_and_another_is_shortened() {
        let whole = Segment { start: 0.0, end: 0.5, length: 0.5, discontinuity: false };
        for (step, count) in [(1e-4, 5000), (0.3, 2), (0.5, 1), (2.0, 1), (0.1, 5)] {
            let mut steps = EqualSteps::new(whole, step);
            let mut taken = Vec::new();
            while let Some((h, end)) = steps.next_step() {
                assert!(h <= step * (1.0 + 1e-11));
                taken.push(end);
            }
            assert_eq!(taken.len(), count);
            assert_eq!(taken.last(), Some(&0.5));
        }
    }

    #[test]
    fn halved_steps_land_on_the_end_whatever_is_accepted_and_rejected() {
        let segment = Segment { start: 1.0, end: 1.3, length: 1.3 - 1.0, discontinuity: false };
        let mut steps = HalvedSteps::new(segment, 0.11, f64::INFINITY);
        let mut time = 1.0;
        let mut tries = 0;
        while let Some((h, end)) = steps.next_step() {
            tries += 1;
            let error = if tries % 3 == 0 { 5.0 } else { 1e-3 };
            if error > 1.0 {
                assert!(steps.reject(error));
            } else {
                assert!((end - time - h).abs() < 1e-15);
                time = end;
                steps.accept(32.0 * error <= 1.0);
            }
        }
        assert_eq!(time, 1.3);
    }

    #[test]
    fn steps_cannot_shrink_for_ever() {
        let mut steps =
            HalvedSteps::new(Segment { start: 0.0, end: 1.0, length: 1.0, discontinuity: false }, 1.0, f64::INFINITY);
        assert!((0..100).any(|_| !steps.reject(f64::NAN)));
    }
}
