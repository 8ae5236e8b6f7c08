//! The state of a run of a system in a checkpoint.

use serde::{Deserialize, Serialize};

use crate::simulation::account::EnergyAccount;
use crate::simulation::checkpoint::{CheckpointError, counts, decode, encode, expect, finite};
use crate::simulation::checkpoint::{equal_room, fixed_room, from_words, to_words};
use crate::simulation::plan::Progress;
use crate::simulation::stats::Stats;
use crate::system::collocation::STAGES;
use crate::system::radau::stage_rates::StageRates;
use crate::system::saved::SavedMotion;
use crate::system::simulation::{Due, SystemSimulation, Walk};
use crate::tolerance::ErrorMeasure;

#[derive(Serialize, Deserialize)]
struct Saved {
    motion: SavedMotion,
    plan: Progress,
    walk: Walk,
    #[serde(with = "fixed_room")]
    steps_since_row: u64,
    due: Due,
    account: EnergyAccount,
    exchanged: Vec<f64>,
    gone: Vec<f64>,
    open_energy: f64,
    stats: Stats,
    #[serde(with = "equal_room")]
    measure: Option<ErrorMeasure>,
    last_step: Option<SavedStep>,
}

/// The last step, where it is kept: rows may still be within it.
#[derive(Serialize, Deserialize)]
struct SavedStep {
    before: SavedMotion,
    end: f64,
    bend: [Vec<f64>; 2],
    rates: [StageRates; STAGES],
}

impl SystemSimulation {
    /// The state that has been reached, as words; they are equally many for all states of a run.
    ///
    /// # Errors
    /// [`CheckpointError::Encoding`].
    pub fn checkpoint(&self) -> Result<Vec<u64>, CheckpointError> {
        let last_step = self.last_step.as_ref().map(|step| SavedStep {
            before: step.before.saved(),
            end: step.end,
            bend: self.motion.bend.clone(),
            rates: self.motion.stage_rates.clone(),
        });
        Ok(to_words(&encode(&encode(&Saved {
            motion: self.motion.saved(),
            plan: self.plan.progress(),
            walk: self.walk,
            steps_since_row: self.steps_since_row,
            due: self.due,
            account: self.account,
            exchanged: self.exchanged.clone(),
            gone: self.gone.clone(),
            open_energy: self.open_energy,
            stats: self.stats,
            measure: self.measure,
            last_step,
        })?)?))
    }

    /// Takes up the state of a [`Self::checkpoint`] of a run with the same set-up: what follows is what would have followed
    /// there, bit for bit.
    ///
    /// # Errors
    /// [`CheckpointError`] for a checkpoint of another run.
    pub fn restored(mut self, checkpoint: &[u64]) -> Result<Self, CheckpointError> {
        let saved: Vec<u8> = from_words(checkpoint)?;
        let saved: Saved = decode(&saved)?;
        let Saved {
            motion,
            plan,
            walk,
            steps_since_row,
            due,
            account,
            exchanged,
            gone,
            open_energy,
            stats,
            measure,
            last_step,
        } = saved;
        counts(&[steps_since_row, due.rows])?;
        stats.check()?;
        match (&self.measure, &measure) {
            (Some(own), Some(saved)) => own.check_saved(saved)?,
            (own, saved) => expect("the kind of step control", own.is_none() && saved.is_none())?,
        }
        expect("the number of bodies", [&exchanged, &gone].iter().all(|list| list.len() == self.exchanged.len()))?;
        finite("the energy exchanged", exchanged.iter())?;
        finite("the ways of the bodies and the energy that is open", gone.iter().chain([&open_energy]))?;
        walk.equal.check()?;
        expect("the next step", walk.next > 0.0 && walk.longest > 0.0)?;
        account.check_saved()?;
        self.motion.take_up(motion)?;
        self.plan.set_progress(&plan)?;
        (self.walk, self.account, self.exchanged, self.stats) = (walk, account, exchanged, stats);
        (self.due, self.steps_since_row, self.measure) = (due, steps_since_row, measure);
        (self.gone, self.open_energy) = (gone, open_energy);
        self.events.forget();
        self.pending_event = None;
        expect("the last step", last_step.is_some() == self.last_step.is_some())?;
        if let (Some(step), Some(SavedStep { before, end, bend, rates })) = (&mut self.last_step, last_step) {
            rates.iter().zip(&self.motion.stage_rates).try_for_each(|(saved, own)| saved.check(own))?;
            expect("the bend of the last step", bend.iter().all(|list| list.len() == self.motion.bend[0].len()))?;
            finite("the bend of the last step", bend.iter().flatten())?;
            step.before.take_up(before)?;
            let now = self.motion.time();
            finite("the end of the last step", [&end])?;
            expect("the end of the last step", step.before.time() <= end && end <= now)?;
            (step.end, self.motion.bend, self.motion.stage_rates) = (end, bend, rates);
            if let Some(time) = self.due.within {
                expect("the time of the row", step.before.time() <= time && time <= end)?;
                let found = step.interpolate(&self.motion, time);
                expect("the row", found.is_ok())?;
            }
        }
        Ok(self)
    }
}
