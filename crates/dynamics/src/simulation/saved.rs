//! The state of a run in a checkpoint.

use serde::{Deserialize, Serialize};

use crate::simulation::account::EnergyAccount;
use crate::simulation::checkpoint::{CheckpointError, counts, decode, encode, expect, fixed_room};
use crate::simulation::checkpoint::{from_words, to_words};
use crate::simulation::due::Due;
use crate::simulation::fingerprint::Fingerprint;
use crate::simulation::plan::Progress;
use crate::simulation::stats::Stats;
use crate::simulation::walk::Walk;
use crate::simulation::{Phase, Simulation};

/// Version of the data, in front of them.
const VERSION: u32 = 3;

#[derive(Serialize, Deserialize)]
struct Saved {
    motion: Vec<u8>,
    /// The motion at the start of the last step, where rows may still be within it.
    before: Option<Vec<u8>>,
    plan: Progress,
    walk: Walk,
    #[serde(with = "fixed_room")]
    steps_since_row: u64,
    due: Due,
    phase: Phase,
    account: EnergyAccount,
    stats: Stats,
}

impl Simulation {
    /// The state that has been reached, as words; they are equally many for all states of a run.
    ///
    /// # Errors
    /// [`CheckpointError::Encoding`], from a scheme of one's own.
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        let last_step = self.last_step.as_ref().filter(|_| self.facts.is_free());
        let saved = Saved {
            motion: self.motion.save()?,
            before: last_step.map(|step| step.before.save()).transpose()?,
            plan: self.plan.progress(),
            walk: self.walk.clone(),
            steps_since_row: self.steps_since_row,
            due: self.due,
            phase: self.phase,
            account: self.account,
            stats: self.stats,
        };
        Ok(to_words(&encode(&(VERSION, &self.fingerprint, encode(&saved)?))?))
    }

    /// Takes up the state of a [`Self::checkpoint`] of a run with the same set-up: what follows is what would have
    /// followed there, bit for bit.
    ///
    /// # Errors
    /// [`CheckpointError`] for a checkpoint of another run, with what differs: the body, the damping, a load, a joint ... Of a load
    /// from a closure only its name, discontinuities and longest step are compared, and of a scheme of one's own what it checks.
    pub fn restored(mut self, checkpoint: &[u64]) -> Result<Self, CheckpointError> {
        let (fingerprint, saved): (Fingerprint, Vec<u8>) = from_words(VERSION, checkpoint)?;
        self.fingerprint.check(&fingerprint)?;
        let saved: Saved = decode(&saved)?;
        counts(&[saved.steps_since_row])?;
        saved.due.check()?;
        saved.stats.check()?;
        saved.account.check_saved()?;
        self.walk.check_saved(&saved.walk)?;
        self.motion.restore(&saved.motion)?;
        self.plan.set_progress(&saved.plan)?;
        (self.walk, self.account, self.stats) = (saved.walk, saved.account, saved.stats);
        (self.due, self.phase, self.steps_since_row) = (saved.due, saved.phase, saved.steps_since_row);
        self.pending_event = None;
        self.events.forget();
        let last_step = self.last_step.as_mut().filter(|_| self.facts.is_free());
        expect("the last step", last_step.is_some() == saved.before.is_some())?;
        if let (Some(step), Some(before)) = (last_step, saved.before) {
            step.before.restore(&before)?;
            let span = [step.before.time(), self.motion.time()];
            expect("the start of the last step", span[0] <= span[1])?;
            if let Some(time) = self.due.within {
                expect("the time of the row", (span[0]..=span[1]).contains(&time))?;
                expect("the row", step.interpolate(&*self.motion, time).is_ok())?;
            }
        } else {
            expect("the time of the row", self.due.within.is_none())?;
        }
        Ok(self)
    }
}
