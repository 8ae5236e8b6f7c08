//! Account of the energy: a motion must have what its start, its loads and its damping leave it.
//!
//! The start, the work of the loads and the dissipation account for the energy of every state. A scheme whose steps are
//! too long breaks this long before a number overflows. The account is an observer that every run has: it needs no
//! evaluation of the rates, ends the run, and is part of its checkpoint.

use serde::{Deserialize, Serialize};

use crate::error::StepError;
use crate::matrix::lists::larger;
use crate::motion::facts::Balance;
use crate::observation::energies::Energies;
use crate::simulation::checkpoint::{CheckpointError, equal_room, finite};

/// The account of a run.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct EnergyAccount {
    #[serde(with = "equal_room")]
    start: Option<Energies>,
    /// Largest of the energies at the start, put in and taken out so far.
    scale: f64,
    /// The least that it is.
    least_scale: f64,
    /// Largest sum of the work and the dissipation of one step: where a load sets in, they are no better known than that.
    largest_exchange: f64,
    #[serde(with = "equal_room")]
    last: Option<Energies>,
    exchanged: Exchanged,
    /// Energy scale of the loads: that of modes that follow them within a step, where no stage sees it, and of a load that
    /// sets in.
    of_loads: f64,
    /// Largest energy at a row for which nothing accounts.
    largest_open: f64,
}

/// Energy that has come and gone.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct Exchanged {
    /// Sum of |work| + |dissipation| of all steps.
    sum: f64,
    /// Work and dissipation after the last step.
    done: [f64; 2],
}

impl Exchanged {
    /// Adds a step, after which work and dissipation since the beginning are these.
    pub(crate) fn add(&mut self, done: [f64; 2]) {
        self.sum += (done[0] - self.done[0]).abs() + (done[1] - self.done[1]).abs();
        self.done = done;
    }

    /// Sum of |work| + |dissipation| of all steps.
    pub(crate) fn sum(&self) -> f64 {
        self.sum
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check(&self) -> Result<(), CheckpointError> {
        finite("the energy exchanged", [&self.sum, &self.done[0], &self.done[1]])
    }
}

/// A step of this many radians of every mode, and with this much damping, lets the stages see the work and the
/// dissipation as they are.
const RESOLVED: f64 = 0.5;
/// Part of the energies that may be missing or too much where steps are resolved: far beyond what is of any use.
const OFF: f64 = 0.5;
/// The same where they are not, for too much alone: work and dissipation are then known in their size only.
const OFF_UNRESOLVED: f64 = 4.0;
/// Part of the energy scale of the loads that may be missing or too much: a formula may grow from nothing by many orders
/// of magnitude within a step, as a bell curve does, and the work of that step is not known.
const SETTING_IN: f64 = 1e-6;
/// Part of all that was exchanged that the stages may have summed wrongly: work that goes to and fro leaves an error in
/// every period. Measured: 1.2e-5 in steps of a sixteenth of the period.
const SUMMED: f64 = 1e-4;
/// Rounding in the energy of the origin's motion.
const ROUNDING: f64 = 1e-9;

/// True if steps are short enough for the stages to see work and dissipation; the `rate` is the largest of ω_k and
/// 2 ζ_k ω_k.
pub(crate) fn is_resolved(rate: f64, step: f64) -> bool {
    rate * step <= RESOLVED
}

impl EnergyAccount {
    /// The account of a run that begins with these energies, if they are known, and of loads that would, one by one, give
    /// the body this energy.
    pub(crate) fn new(start: Option<Energies>, of_loads: f64) -> Self {
        Self { start, of_loads, ..Self::default() }
    }

    /// With an energy that flows from the beginning on, such as the strain energy of a bent reference that nothing holds.
    pub(crate) fn of_scale(self, least: f64) -> Self {
        Self { scale: self.scale.max(least), least_scale: least, ..self }
    }

    /// The energy of [`Self::of_scale`].
    pub(crate) fn least_scale(&self) -> f64 {
        self.least_scale
    }

    /// Time since the beginning; none before it has been seen.
    pub(crate) fn elapsed(&self, time: f64) -> f64 {
        self.start.map_or(0.0, |start| time - start.time)
    }

    /// Energy scale of the loads.
    pub(crate) fn of_loads(&self) -> f64 {
        self.of_loads
    }

    /// Loads that have been changed would give the body this energy.
    pub(crate) fn raise_of_loads(&mut self, energy: f64) {
        self.of_loads = self.of_loads.max(energy);
    }

    /// Refuses numbers that are not finite.
    pub(crate) fn check_saved(&self) -> Result<(), CheckpointError> {
        let Self { start, scale, least_scale, largest_exchange, last, exchanged, of_loads, largest_open } = self;
        start.iter().chain(last).try_for_each(Energies::check)?;
        exchanged.check()?;
        finite("the account of the energy", [scale, least_scale, largest_exchange, of_loads, largest_open])
    }

    /// Takes a step into account, after which work and dissipation since the beginning are these.
    pub(crate) fn exchange(&mut self, done: [f64; 2]) {
        self.exchanged.add(done);
    }

    /// Sum of |work| + |dissipation| of all steps.
    pub(crate) fn exchanged(&self) -> f64 {
        self.exchanged.sum()
    }

    /// The energy beyond what the start, work and dissipation leave.
    fn open(&self, now: &Energies) -> f64 {
        let balance = |of: &Energies| of.internal + of.translation - of.work + of.dissipation;
        self.start.map_or(0.0, |start| balance(now) - balance(&start))
    }

    /// Largest energy at the rows so far, beyond what the start, work and dissipation leave. What joints pass from one body to another has
    /// no part in it.
    pub(crate) fn largest_open(&self) -> f64 {
        self.largest_open
    }

    /// Checks the energy at a row; the `rate` is the largest of ω_k and 2 ζ_k ω_k.
    pub(crate) fn check_row(&mut self, now: &Balance, rate: f64, step: f64) -> Result<(), StepError> {
        let Balance { energies, scale, unseen } = now;
        self.scale = self.scale.max(*scale);
        self.largest_open = larger(self.largest_open, self.open(energies).abs());
        self.check_beyond(*unseen, energies, rate, step)
    }

    /// Checks the energy at a time where the scheme has found it: of the conservative form that is the start of the last step or
    /// the last observation, since it takes an evaluation of the rates.
    pub(crate) fn check(&mut self, now: &Energies, rate: f64, step: f64) -> Result<(), StepError> {
        self.check_beyond(0.0, now, rate, step)
    }

    /// The same where steps may miss or add this energy.
    fn check_beyond(&mut self, unseen: f64, now: &Energies, rate: f64, step: f64) -> Result<(), StepError> {
        let Energies { time, internal, .. } = *now;
        let start = *self.start.get_or_insert(*now);
        let put_in = (now.work - start.work) - (now.translation - start.translation);
        let taken_out = now.dissipation - start.dissipation;
        let accounted = start.internal + put_in - taken_out;
        let excess = internal - accounted;
        if !excess.is_finite() {
            return Err(StepError::NotFinite { time, what: "the energy" });
        }
        self.scale = self.scale.max(start.internal.abs()).max(put_in.abs()).max(taken_out);
        let rounding = ROUNDING * (now.translation + start.translation);
        let last = self.last.replace(*now).unwrap_or(start);
        let exchange = (now.work - last.work).abs() + (now.dissipation - last.dissipation).abs();
        self.largest_exchange = self.largest_exchange.max(exchange);
        let unknown =
            self.largest_exchange + SUMMED * self.exchanged.sum() + rounding + SETTING_IN * self.of_loads + unseen;
        let is_off = if is_resolved(rate, step) {
            excess.abs() > OFF * self.scale + unknown
        } else {
            excess > OFF_UNRESOLVED * (self.scale + self.of_loads) + unknown
        };
        if is_off { Err(StepError::Energy { time, energy: internal, accounted, step }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energies(time: f64, internal: f64, work: f64, dissipation: f64) -> Energies {
        Energies { time, internal, translation: 0.0, work, dissipation }
    }

    #[test]
    fn what_work_and_damping_account_for_passes_and_what_they_do_not_is_found() {
        let mut account = EnergyAccount::default();
        for (time, internal, work, dissipation) in [(0.0, 2.0, 0.0, 0.0), (1.0, 5.0, 4.0, 1.0), (2.0, 1.5, 1.0, 2.0)] {
            account.check(&energies(time, internal, work, dissipation), 1.0, 0.1).unwrap();
        }
        // Half of the largest of start, work and dissipation, 4, and the work of a step, 5, may be missing.
        assert!(account.check(&energies(3.0, 7.9, 1.0, 2.0), 1.0, 0.1).is_ok());
        let error = account.check(&energies(3.0, 8.1, 1.0, 2.0), 1.0, 0.1).unwrap_err();
        assert_eq!(error, StepError::Energy { time: 3.0, energy: 8.1, accounted: 1.0, step: 0.1 });
        // Where steps do not see the modes, only much too much counts.
        assert!(account.check(&energies(3.0, 8.1, 1.0, 2.0), 10.0, 0.1).is_ok());
        assert!(account.check(&energies(3.0, 23.0, 1.0, 2.0), 10.0, 0.1).is_err());
    }

    #[test]
    fn an_energy_far_below_that_of_the_loads_passes() {
        let check = |energy: f64| {
            let mut account = EnergyAccount::new(None, 2.0);
            account.check(&energies(0.0, 0.0, 0.0, 0.0), 1.0, 0.1).unwrap();
            account.check(&energies(1.0, energy, 0.0, 0.0), 1.0, 0.1)
        };
        assert!(check(1.9e-6).is_ok() && check(2.1e-6).is_err());
    }

    #[test]
    fn work_that_goes_to_and_fro_is_known_less_well_with_every_period() {
        let check = |periods: u32, energy: f64| {
            let mut account = EnergyAccount::default();
            account.check(&energies(0.0, 0.0, 0.0, 0.0), 1.0, 0.1).unwrap();
            (0..periods).for_each(|_| [[1.0, 0.0], [0.0, 0.0]].into_iter().for_each(|done| account.exchange(done)));
            assert_eq!(account.exchanged(), 2.0 * f64::from(periods));
            account.check(&energies(1.0, energy, 0.0, 0.0), 1.0, 0.1)
        };
        assert!(check(5000, 0.99).is_ok() && check(5000, 1.01).is_err());
        assert!(check(0, 1e-9).is_err());
    }

    #[test]
    fn the_motion_of_the_origin_hides_nothing_but_its_own_rounding() {
        let mut account = EnergyAccount::default();
        let moving = |internal: f64| Energies { translation: 1e6, ..energies(1.0, internal, 0.0, 0.0) };
        account.check(&moving(1.0), 1.0, 0.1).unwrap();
        assert!(account.check(&moving(1.4), 1.0, 0.1).is_ok() && account.check(&moving(1.6), 1.0, 0.1).is_err());
    }

    #[test]
    fn an_energy_that_is_no_number_is_found_before_a_coordinate_is_none() {
        for energy in [f64::NAN, f64::INFINITY, 1e200 * 1e200] {
            let mut account = EnergyAccount::default();
            account.check(&energies(0.0, 1.0, 0.0, 0.0), 1.0, 0.1).unwrap();
            let error = account.check(&energies(7.0, energy, 0.0, 0.0), 1.0, 0.1).unwrap_err();
            assert_eq!(error, StepError::NotFinite { time: 7.0, what: "the energy" });
        }
    }
}
