//! A motion of a run on its way to the next row, with the bodies that it moves.

use dynamics::{Reached, StepError};

use super::body::FollowedBody;
use super::tied_report::TiedReport;
use crate::motion::Motion;
use crate::motion::row_times::RowTimes;
use crate::rows::row::{BodyRow, Row};

/// Steps between two reports of progress, where no row comes first.
const STEPS_PER_REPORT: u64 = 4096;

/// A motion on its way, and the bodies and joints in it.
pub(super) struct Mover<'a> {
    pub motion: Motion,
    pub bodies: Vec<FollowedBody<'a>>,
    /// Numbers of its joints in the scene.
    pub joints: Vec<usize>,
    /// Numbers of its springs and bushings in rows.
    pub elements: Vec<usize>,
}

/// The place where a motion goes next.
#[derive(Debug, Clone, Copy)]
pub(super) enum Next {
    /// Its own next row.
    Row,
    /// A time, or beyond it by less than a step.
    Time(f64),
}

impl Mover<'_> {
    /// Its report where its bodies are tied together.
    pub fn tied_report(&self) -> Option<TiedReport> {
        let Motion::Tied(simulation) = &self.motion else { return None };
        Some(TiedReport::new(simulation, self.bodies.iter().map(|body| body.of.name().to_owned()).collect()))
    }

    /// Goes on, at the most by as many steps as there are between two reports. Gives [`Reached::Row`] where it has come to.
    ///
    /// # Errors
    /// A step that failed; but the refusal of a body comes before it.
    pub fn go(&mut self, next: Next, times: Option<&RowTimes>) -> Result<Reached, StepError> {
        let Self { motion, bodies, .. } = self;
        let mut watch = |body: usize, moment: &dynamics::Moment| bodies[body].look(moment);
        match (next, times) {
            (Next::Time(time), Some(times)) => {
                let before = motion.tried();
                while motion.time() < time && !times.are_same(motion.time(), time) {
                    let left = STEPS_PER_REPORT.saturating_sub(motion.tried() - before);
                    if left == 0 {
                        return Ok(Reached::Between);
                    }
                    // Its own rows may be beyond the time by many steps.
                    let tries = if times.may_be_between_steps() { 1 } else { left };
                    motion.advance(tries, &mut watch)?;
                }
                Ok(Reached::Row)
            }
            _ => motion.advance(STEPS_PER_REPORT, watch),
        }
    }

    /// Shows its bodies how far they would have bent at the end of the step that has failed: a body may be thrown out of its
    /// model within one step.
    pub fn look_ahead(&mut self) {
        let Ok(states) = self.motion.states() else { return };
        let step = self.motion.stats().longest;
        for (state, body) in states.iter().zip(&mut self.bodies) {
            body.look_ahead(state, step);
        }
    }

    /// Observes its bodies and joints at the time that it has come to, or at the time of a row within its last step.
    pub fn observe(&mut self, within: Option<f64>, row: &mut Row) -> Result<(), StepError> {
        let Self { motion, bodies, joints, elements } = self;
        let mut rows: Vec<&mut BodyRow> = Vec::with_capacity(bodies.len());
        // Its bodies are in the order of the scene.
        let mut rest = row.bodies.iter_mut().enumerate();
        for body in &*bodies {
            rows.extend(rest.by_ref().find(|(number, _)| *number == body.number).map(|(_, row)| row));
        }
        motion.observe(within, rows.iter_mut().map(|row| &mut row.motion))?;
        rows.into_iter().zip(&*bodies).for_each(|(row, body)| row.complete(body.of.model));
        motion.observe_ties([joints, elements], &mut row.joints);
        Ok(())
    }
}
