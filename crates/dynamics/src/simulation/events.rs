//! Events: where a function of the motion passes through zero, found inside a step.

use std::fmt;
use std::sync::Arc;

use crate::error::StepError;
use crate::observation::Observation;
use crate::observation::system::SystemObservation;
use crate::simulation::last_step::Inside;

/// Which way an event function passes through zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Crossing {
    /// From below zero to zero or above.
    Rising,
    /// From above zero to zero or below.
    Falling,
    /// Either.
    #[default]
    Any,
}

/// A function of the motion; a run stops where it passes through zero.
#[derive(Clone)]
pub struct Event {
    name: String,
    crossing: Crossing,
    function: Arc<dyn Fn(&SystemObservation) -> f64 + Send + Sync>,
}

impl Event {
    /// An event with a name for messages. The function sees the first body, and the motion of the points of the run.
    pub fn new(
        name: impl Into<String>,
        crossing: Crossing,
        function: impl Fn(&Observation) -> f64 + Send + Sync + 'static,
    ) -> Self {
        // Every run has a body.
        Self::of_system(name, crossing, move |now| now.bodies.first().map_or(f64::NAN, &function))
    }

    /// The same, where the function sees all bodies, joints and force elements.
    pub fn of_system(
        name: impl Into<String>,
        crossing: Crossing,
        function: impl Fn(&SystemObservation) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), crossing, function: Arc::new(function) }
    }

    /// Value of its function at a motion.
    fn value(&self, now: &SystemObservation) -> Result<f64, StepError> {
        let value = (self.function)(now);
        if value.is_finite() { Ok(value) } else { Err(StepError::EventFunction { time: now.time, found: value }) }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// True if the function has passed through zero between these values.
    fn is_passed(&self, before: f64, after: f64) -> bool {
        let rising = before < 0.0 && after >= 0.0;
        let falling = before > 0.0 && after <= 0.0;
        match self.crossing {
            Crossing::Rising => rising,
            Crossing::Falling => falling,
            Crossing::Any => rising || falling,
        }
    }
}

impl fmt::Debug for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event").field("name", &self.name).field("crossing", &self.crossing).finish_non_exhaustive()
    }
}

/// An event that is passed in a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passed {
    pub number: usize,
    /// True if it is at the end of the step but for rounding; if not, the step was last looked at there.
    pub at_end: bool,
}

/// The events of a run, with their values at the start of the step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Events {
    list: Vec<Event>,
    values: Vec<f64>,
    after: Vec<f64>,
    /// True if the values are those of another state.
    stale: bool,
}

/// Halvings of a step are enough of these to reach rounding, and the secants come sooner.
const MAX_TRIES: usize = 100;

impl Events {
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds an event, and returns its number.
    pub(crate) fn add(&mut self, event: Event, now: &SystemObservation) -> Result<usize, StepError> {
        self.values.push(event.value(now)?);
        self.after.push(0.0);
        self.list.push(event);
        Ok(self.list.len() - 1)
    }

    pub(crate) fn get(&self, number: usize) -> Option<&Event> {
        self.list.get(number)
    }

    /// True if the values are to be found again, after a change of the state.
    pub(crate) fn is_stale(&self) -> bool {
        self.stale && !self.list.is_empty()
    }

    /// The state has been changed.
    pub(crate) fn forget(&mut self) {
        self.stale = true;
    }

    /// Finds the values of the events at a motion.
    pub(crate) fn reset(&mut self, now: &SystemObservation) -> Result<(), StepError> {
        for (value, event) in self.values.iter_mut().zip(&self.list) {
            *value = event.value(now)?;
        }
        self.stale = false;
        Ok(())
    }

    /// The first event that is passed in the last step, at whose end the motion is `now`, on the far side of the crossing to
    /// rounding. Times closer than `same` are one.
    pub(crate) fn first_passed(
        &mut self,
        step: &mut Inside<'_>,
        now: &SystemObservation,
        same: f64,
    ) -> Result<Option<Passed>, StepError> {
        let [start, end] = step.span();
        let mut first: Option<(usize, f64)> = None;
        for (k, event) in self.list.iter().enumerate() {
            self.after[k] = event.value(now)?;
            if !event.is_passed(self.values[k], self.after[k]) {
                continue;
            }
            let time = locate(event, [start, end], [self.values[k], self.after[k]], step)?;
            if first.is_none_or(|(_, earliest)| time < earliest) {
                first = Some((k, time));
            }
        }
        let Some((number, time)) = first else {
            self.values.copy_from_slice(&self.after);
            return Ok(None);
        };
        let at_end = end - time <= same;
        if !at_end {
            let there = step.at(time)?;
            for (after, event) in self.after.iter_mut().zip(&self.list) {
                *after = event.value(there)?;
            }
        }
        for (k, event) in self.list.iter().enumerate() {
            // Of several at one time the others come next: they are still before their crossing.
            if k == number || !event.is_passed(self.values[k], self.after[k]) {
                self.values[k] = self.after[k];
            }
        }
        Ok(Some(Passed { number, at_end }))
    }
}

/// The time, to rounding, at which an event function has passed through zero between two times: regula falsi in the
/// Illinois form, which halves the value at an end that stays.
fn locate(
    event: &Event,
    [mut from, mut to]: [f64; 2],
    [mut before, mut after]: [f64; 2],
    step: &mut Inside<'_>,
) -> Result<f64, StepError> {
    // At the start of the step is what has waited for another event there.
    if event.is_passed(before, event.value(step.at(from)?)?) {
        return Ok(from);
    }
    let mut stayed = 0;
    for _ in 0..MAX_TRIES {
        let spacing = 2.0 * f64::EPSILON * to.abs().max(to - from);
        if to - from <= spacing || after == 0.0 {
            break;
        }
        let secant = to - (to - from) * (after / (after - before));
        let time = secant.clamp(from + 0.5 * spacing, to - 0.5 * spacing);
        let value = event.value(step.at(time)?)?;
        if event.is_passed(before, value) {
            (to, after) = (time, value);
            if stayed == 1 {
                before *= 0.5;
            }
            stayed = 1;
        } else {
            (from, before) = (time, value);
            if stayed == -1 {
                after *= 0.5;
            }
            stayed = -1;
        }
    }
    Ok(to)
}
