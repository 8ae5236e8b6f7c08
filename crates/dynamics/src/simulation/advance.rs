//! The steps of a run, and what comes with them: rows, events and stops.

use crate::error::StepError;
use crate::observation::moment::Moment;
use crate::observation::observer::StepEnd;
use crate::simulation::last_step::Inside;
use crate::simulation::plan::Rows;
use crate::simulation::{Phase, Reached, Simulation};

impl Simulation {
    /// Goes on to the next row, event or stop, or as far as `max_steps` tries lead. Where a row falls on an event or the stop
    /// time, it comes next, without a step. Allocates nothing once each length of step has
    /// occurred.
    ///
    /// # Errors
    /// [`StepError`]; the motion stays where it was before the step that failed, or at the end of the step where its energy was
    /// found wrong, or the function of an event or an observer failed. A row that is due there comes next.
    pub fn advance(&mut self, max_steps: u64) -> Result<Reached, StepError> {
        self.advance_watched(max_steps, |_, _| ())
    }

    /// As [`Self::advance`]; `watch` sees the motion of each body once for each step that is taken, rows or not.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_watched(
        &mut self,
        max_steps: u64,
        mut watch: impl FnMut(usize, &Moment),
    ) -> Result<Reached, StepError> {
        self.phase = Phase::Steps;
        self.stop_within_last_step()?;
        if let Some(reached) = self.next_due()? {
            return Ok(reached);
        }
        if self.events.is_stale() {
            self.looked_at.find(&mut *self.motion, &self.points)?;
            self.events.reset(&self.looked_at)?;
        }
        for _ in 0..max_steps {
            if !self.enter_segment() {
                return Ok(Reached::End);
            }
            let Self { motion, walk, stats, last_step, facts, .. } = self;
            motion.begin_step();
            last_step.iter_mut().for_each(|step| step.keep(&**motion));
            let Some((steps, length)) = walk.try_step(&mut **motion, stats)? else { continue };
            (0..facts.flexible.len()).for_each(|body| watch(body, &motion.moment(body)));
            if walk.is_at_discontinuity() {
                motion.pass_discontinuity()?;
            }
            stats.take(steps, length);
            self.finish_step(steps)?;
            if let Some(reached) = self.next_due()? {
                return Ok(reached);
            }
        }
        Ok(Reached::Between)
    }

    /// Goes back to the first event in the steps that have been taken, and notes what has come with them.
    fn finish_step(&mut self, steps: u64) -> Result<(), StepError> {
        let event = self.go_to_event();
        // An event may have cut the step short; where one has failed, the step is done all the same.
        let Self { motion, account, facts, stats, points, looked_at, observers, .. } = self;
        account.exchange(motion.step_is_done());
        self.steps_since_row += steps;
        let time = motion.time();
        if let Rows::EverySteps(every) = self.rows
            && (self.steps_since_row >= every || self.plan.is_over(time))
        {
            (self.due.row, self.steps_since_row) = (true, 0);
        }
        let is_stop = self.plan.take_stop(time);
        self.pending_event = event?;
        if let Some(energies) = motion.energies() {
            account.check(&energies, facts.fastest_rate, stats.longest)?;
        }
        observers.step(&mut StepEnd {
            motion: &mut **motion,
            points,
            longest_step: stats.longest,
            observation: looked_at,
            is_observed: false,
        })?;
        self.due.stop = is_stop && self.pending_event.is_none();
        Ok(())
    }

    /// Goes into the next segment, where none is left to go through. False at the end.
    fn enter_segment(&mut self) -> bool {
        while self.walk.is_done() {
            let Some(segment) = self.plan.next_segment() else { return false };
            self.walk.enter(segment, self.longest_step.in_segment(&segment));
        }
        true
    }

    /// The steps to come start at the time that the motion has reached, wherever the plan was.
    pub(super) fn go_on_from_here(&mut self) {
        self.plan.go_to(self.motion.time());
        self.walk.leave();
    }

    /// The next row, event or stop within the step that has been done, or at its end.
    fn next_due(&mut self) -> Result<Option<Reached>, StepError> {
        let (now, same) = (self.motion.time(), self.plan.same());
        self.due.within = None;
        let row = self.next_row();
        if self.facts.is_free()
            && let (Some(time), Some(step)) = (row.filter(|row| *row < now - same), &mut self.last_step)
        {
            step.interpolate(&*self.motion, time)?;
            (self.due.within, self.due.rows) = (Some(time), self.due.rows + 1);
            return Ok(Some(Reached::Row));
        }
        if let Some(event) = self.pending_event.take() {
            return Ok(Some(Reached::Event(event)));
        }
        if std::mem::take(&mut self.due.stop) {
            return Ok(Some(Reached::Stop));
        }
        let is_row = row.is_some_and(|row| row <= now + same);
        self.due.rows += u64::from(is_row);
        Ok((std::mem::take(&mut self.due.row) || is_row).then_some(Reached::Row))
    }

    /// Number of the first row at an interval after a time.
    pub(super) fn row_after(&self, time: f64) -> u64 {
        match self.rows {
            Rows::Interval(interval) => ((time + self.plan.same()) / interval).floor().max(0.0) as u64 + 1,
            Rows::EverySteps(_) => 1,
        }
    }

    /// Time of the next row at an interval; `None` after the last, which is at the end.
    fn next_row(&self) -> Option<f64> {
        let Rows::Interval(interval) = self.rows else { return None };
        let time = |row: u64| row as f64 * interval;
        let (next, last) = (time(self.due.rows), time(self.due.rows - 1));
        if self.plan.is_over(next) { (!self.plan.is_over(last)).then_some(self.end) } else { Some(next) }
    }

    /// True if a row falls on the event or the stop that has been reached, and comes next without a step.
    pub fn row_is_due(&self) -> bool {
        let end = self.motion.time() + self.plan.same();
        self.due.row || self.next_row().is_some_and(|row| row <= end)
    }

    /// True if neither a step nor a row is to come.
    pub fn is_over(&self) -> bool {
        let is_told = !self.due.stop && self.due.within.is_none() && self.pending_event.is_none();
        is_told && !self.due.row && self.plan.is_over(self.motion.time()) && self.next_row().is_none()
    }

    /// Leaves what the last step has done beyond the row within it that has been reached.
    pub(super) fn stay_here(&mut self) {
        if let (Some(_), Some(step)) = (self.due.within.take(), &mut self.last_step) {
            self.motion.copy_state(&*step.probe);
            self.motion.loads_have_changed();
            step.keep(&*self.motion);
            (self.pending_event, self.due.stop) = (None, false);
            self.events.forget();
            self.go_on_from_here();
        }
    }

    /// Goes back to a stop that has been set within the step that has been done, beyond the row there that has been reached.
    fn stop_within_last_step(&mut self) -> Result<(), StepError> {
        let Some(stop) = self.plan.stop().filter(|stop| self.due.within.is_some_and(|row| row < *stop)) else {
            return Ok(());
        };
        if stop < self.motion.time() - self.plan.same() {
            let retaken = self.retaken();
            if let Some(step) = &mut self.last_step {
                step.go_to(stop, retaken)?;
                self.motion.copy_state(&*step.probe);
            }
            self.go_on_from_here();
            self.pending_event = None;
            self.events.forget();
        }
        self.due.stop |= self.plan.take_stop(self.motion.time());
        Ok(())
    }

    /// Finds the first event in the step that has been done, and goes back there.
    fn go_to_event(&mut self) -> Result<Option<usize>, StepError> {
        if self.events.is_empty() {
            return Ok(None);
        }
        let retaken = self.retaken();
        let Self { motion, events, last_step: Some(step), looked_at, points, plan, .. } = self else { return Ok(None) };
        looked_at.find(&mut **motion, points)?;
        let end = motion.time();
        let passed = events.first_passed(&mut Inside { step, points, retaken, end }, looked_at, plan.same())?;
        let Some(passed) = passed else { return Ok(None) };
        // At the end the motion is there already, and beyond the discontinuity that may be there.
        if !passed.at_end {
            motion.copy_state(&*step.probe);
            self.go_on_from_here();
        }
        Ok(Some(passed.number))
    }
}
