//! Steps of a system with error control, and jumps between them.

use crate::conservative::part;
use crate::error::{RateError, StepError};
use crate::system::radau::bound::Bound;
use crate::system::radau::rows::NEAR_SINGULAR;
use crate::system::radau::{Failed, SystemMotion, Tried};
use crate::tolerance::ErrorMeasure;

/// Error of a step that is rounding.
pub(in crate::system) const ROUNDING: f64 = 1e-13;
/// The most that a step may grow by: the estimate of two steps is a bad one where the second is much longer. Before there is one, it may
/// grow by more.
const GROWTH: f64 = 1.6;
const FIRST_GROWTH: f64 = 4.0;
/// After a step that has forgotten vibration, the next may be longer by this.
const FORGETTING_GROWTH: f64 = 1.25;

/// Tries of a step to end at a kink of a law, before it goes over one.
const KINK_TRIES: usize = 3;

impl SystemMotion {
    /// Goes to `end` with steps whose estimated errors sum to at most `tolerance`; `h` is the first try, and the next one after.
    /// Returns the number of steps. Where a load or a drive jumps, end a call there.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough.
    pub fn advance(&mut self, end: f64, tolerance: f64, h: &mut f64) -> Result<u64, StepError> {
        let mut measure = ErrorMeasure::new(tolerance, end - self.time, ROUNDING);
        let mut steps = 0;
        while self.time < end {
            self.follow_islands();
            let taken = self.try_towards(end, &mut measure, h);
            steps += u64::from(taken.map_err(|error| self.reason_or(error))?.is_some());
        }
        Ok(steps)
    }

    /// Tries one step towards `end` whose estimated error is at most its share of the tolerance, about as long as `h`, which becomes
    /// the length of the next try. Returns the length of the step where it was taken.
    ///
    /// # Errors
    /// [`StepError`] where no step is short enough.
    pub(in crate::system) fn try_towards(
        &mut self,
        end: f64,
        measure: &mut ErrorMeasure,
        h: &mut f64,
    ) -> Result<Option<f64>, StepError> {
        let (start, left) = (self.time, end - self.time);
        let parts = (left / *h).ceil().max(1.0);
        let length = if *h * 1.01 >= left { left } else { left / parts };
        let to = if length == left { end } else { self.time + length };
        let growth = if self.past.steps < 2 { FIRST_GROWTH } else { GROWTH };
        let (mut length, mut to, mut taken, mut is_cut) = (length, to, None, false);
        let mut bound = Bound::of(measure, length);
        let mut tried = self.try_step_of(length, to, &bound, false);
        for cut in 1..=KINK_TRIES {
            let Ok(Tried { kink: Some(before), .. }) = tried else { break };
            (length, to, is_cut) = (before, self.time + before, true);
            bound = Bound::of(measure, length);
            tried = self.try_step_of(length, to, &bound, cut == KINK_TRIES);
        }
        match tried {
            Ok(Tried { errors, forgotten, has_order_of_scheme, passes, .. }) => {
                let ratio = bound.ratio(&errors);
                // What is allowed falls with the step as well.
                let power = if has_order_of_scheme { 1.0 / 5.0 } else { 1.0 / 3.0 };
                let mut factor = (0.9 * ratio.max(1e-300).powf(-power)).clamp(0.2, growth);
                if ratio <= 1.0 {
                    let was_refused = measure.is_refused;
                    measure.taken(to, &errors, forgotten);
                    if forgotten > 0.0 {
                        factor = FORGETTING_GROWTH;
                    }
                    if was_refused {
                        // What was too long is tried again after one more step.
                        factor = factor.min(1.0);
                    }
                    taken = Some(length);
                    if is_cut {
                        // Beyond the kink the polynomials do not go on.
                        self.forget_last_step();
                    }
                    if passes > 7 {
                        factor = factor.min(0.7);
                    } else if passes > 5 {
                        factor = factor.min(1.0);
                    }
                    // A last step that was cut short says little of the next.
                    *h = if factor >= 1.0 { h.max(length * factor) } else { length * factor };
                } else {
                    measure.refused(start, to);
                    *h = length * factor.min(0.9);
                }
            }
            Err(Failed::Newton) => *h = 0.4 * length,
            Err(Failed::Open { joints, gap }) => return Err(StepError::Open { time: to, joints, gap }),
            Err(Failed::Rates(error)) if length < 1e-12 * end => return Err(error.in_step(self.time, length)),
            Err(Failed::Rates(_)) => *h = 0.25 * length,
        }
        if taken.is_none() && self.last_length > 0.0 && self.weakest_row() < NEAR_SINGULAR {
            self.forget_last_step();
            *h = length;
        }
        if *h < 1e-13 * end {
            return Err(StepError::Tolerance { time: self.time, step: *h, tolerance: measure.tolerance });
        }
        Ok(taken)
    }

    /// Takes the motion past a jump of a load or a drive at its time: where the rate of a drive jumps, so do the velocities. The
    /// energy that this takes is work of the drives.
    ///
    /// # Errors
    /// [`RateError`] where the inertia of a body is singular.
    pub(in crate::system) fn pass_discontinuity(&mut self) -> Result<(), RateError> {
        self.forget_last_step();
        if self.system.connections.joints.iter().all(|joint| joint.drive.is_none()) {
            return Ok(());
        }
        // The discontinuity itself is where it is but for rounding.
        let [branch_before, branch_time] = [-1.0, 1.0].map(|side| self.time + side * 1e-12 * self.time.abs());
        self.begin();
        self.evaluate_first(branch_before)?;
        let rates_before = self.first.constraints.own_rates.clone();
        let energies = |motion: &Self| {
            (0..motion.bodies.len()).map(|body| motion.energy_of(body)).collect::<Result<Vec<f64>, _>>()
        };
        let before = energies(self)?;
        match self.assemble_by(branch_time) {
            Ok(_) => {}
            Err(Failed::Rates(error)) => return Err(error),
            Err(Failed::Newton | Failed::Open { .. }) => return Err(RateError::Inertia),
        }
        let after = energies(self)?;
        self.jump_work -= self.count_impulses(&rates_before);
        for (body, (before, after)) in before.into_iter().zip(after).enumerate() {
            let mut list = self.system.bodies[body].list_mut(&mut self.bodies[body]);
            let mut slow = *list.slow();
            slow[part::WORK] += after - before;
            list.set_slow(&slow);
            self.jump_work += after - before;
        }
        Ok(())
    }

    /// Counts what the last impulses of the rows have done as work of the drives of their joints, between these rates of the rows and those
    /// of now. Returns the sum.
    fn count_impulses(&mut self, rates_before: &[f64]) -> f64 {
        let Self { stages: [.., last], room, system, joint_works, .. } = self;
        let of_row = |((impulse, before), after): ((&f64, &f64), &f64)| -0.5 * impulse * (before + after);
        let mut of_rows = room.impulses.iter().zip(rates_before).zip(&last.constraints.own_rates).map(of_row);
        let joints = system.connections.joints.iter().zip(joint_works);
        joints
            .map(|(joint, work)| {
                let of_joint: f64 = of_rows.by_ref().take(joint.row_count()).sum();
                work.drive += of_joint;
                of_joint
            })
            .sum()
    }
}
