//! Explicit steps: classical Runge–Kutta on the increments (Munthe-Kaas), with multipliers of index 1, projected at the end of the step.
//!
//! Eqs. (J18) of `docs/method/systems.md`.

use crate::system::elimination::newton::Solution;
use crate::system::radau::bound::Bound;
use crate::system::radau::stage_rates::StageRates;
use crate::system::radau::{Failed, SystemMotion, Tried};
use crate::system::reactions::Index1;
use crate::tolerance::ErrorKinds;

/// Error of the scheme over that of the embedded formula to this power, of an oscillation whose amplitude is a hundredth of the size.
const OF_EMBEDDED: [f64; 2] = [4.0, 1.25];

/// Where in the step a stage is.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Increments are so much of the step times the rates of the stage before, which are at this number.
    from: usize,
    part: f64,
    /// Number of its own rates, and true if they are the mean with those that are there.
    to: usize,
    is_mean: bool,
}

/// The stages after the first.
const PLACES: [Place; 3] = [
    Place { from: 0, part: 0.5, to: 1, is_mean: false },
    Place { from: 1, part: 0.5, to: 1, is_mean: true },
    Place { from: 2, part: 1.0, to: 2, is_mean: false },
];

impl SystemMotion {
    /// Tries a step from where the first stage has been evaluated, at whose end and by whose branches the times are.
    pub(super) fn try_explicit_step(
        &mut self,
        h: f64,
        times: [f64; 2],
        bound: &Bound,
        over_kinks: bool,
    ) -> Result<Tried, Failed> {
        let [end, branch_time] = times;
        self.first_rates(h, branch_time)?;
        for place in PLACES {
            self.next_rates(h, branch_time, place)?;
        }
        self.explicit_error(h, times)?;
        let energy = self.largest_energy;
        self.raise_energies(h);
        let embedded = self.errors_of_places([h, bound.span], self.largest_moving);
        let errors = ErrorKinds { energy: self.energy_error(h), ..embedded.of_scheme(OF_EMBEDDED) };
        let kink = if over_kinks { None } else { self.length_to_kink(h)? };
        if bound.ratio(&errors) <= 1.0 && kink.is_none() {
            self.last_length = h;
            self.keep_past();
            let weights = self.scheme.weights.map(|weight| h * weight);
            self.land([end, branch_time], h, weights)?;
        } else {
            // That of a step that is too long says nothing about a shorter one.
            self.largest_energy = energy;
        }
        if errors.largest().is_nan() {
            return Err(Failed::Newton);
        }
        Ok(Tried { errors, forgotten: 0.0, has_order_of_scheme: true, passes: 1, kink })
    }

    /// Rates at the start of the step.
    fn first_rates(&mut self, h: f64, branch_time: f64) -> Result<(), Failed> {
        let Self {
            first,
            stages: [scratch, ..],
            system,
            start,
            matrices,
            patterns,
            multipliers,
            last,
            stage_rates,
            ..
        } = self;
        let lambda = &mut multipliers[0];
        Index1 { system, start, matrices, patterns, scratch }.find(first, [start.time, branch_time], lambda)?;
        stage_rates[0].find(system, first, lambda);
        let [x, y] = &mut last[0];
        scaled(h, &first.x_rates, x);
        scaled(h, &stage_rates[0].y, y);
        Ok(())
    }

    /// Rates at the next stage.
    fn next_rates(&mut self, h: f64, branch_time: f64, Place { from, part, to, is_mean }: Place) -> Result<(), Failed> {
        let Self {
            stages: [scratch, stage, _],
            system,
            start,
            matrices,
            patterns,
            multipliers,
            velocity_multipliers,
            last,
            stage_rates,
            room,
            evaluations,
            ..
        } = self;
        // The third stage has rates of its own until the fourth has been found.
        scaled(part, &last[from][0], &mut stage.x);
        scaled(part, &last[from][1], &mut stage.y);
        let times = [start.time + part * h, branch_time];
        stage.evaluate(system, start, times)?;
        stage.find_x_rates(system, &velocity_multipliers[0])?;
        *evaluations += 1;
        let lambda = &mut multipliers[to];
        Index1 { system, start, matrices, patterns, scratch }.find(stage, times, lambda)?;
        let rates: &mut StageRates = &mut room.stage_rates;
        rates.find(system, stage, lambda);
        let kept = if is_mean { 2 } else { to };
        scaled(h, &stage.x_rates, &mut last[kept][0]);
        scaled(h, &rates.y, &mut last[kept][1]);
        if is_mean {
            stage_rates[to].average(rates);
            let [_, middle, third] = last;
            for (middle, third) in middle.iter_mut().zip(&*third) {
                middle.iter_mut().zip(third).for_each(|(mean, other)| *mean = 0.5 * (*mean + other));
            }
        } else {
            stage_rates[to].copy_from(rates);
        }
        Ok(())
    }

    /// Takes the last stage to the end of the step, and finds the estimate of its error: the difference of a formula of order three that has the
    /// velocities there in place of the ones of the fourth stage.
    fn explicit_error(&mut self, h: f64, times: [f64; 2]) -> Result<(), Failed> {
        let Self { stages: [.., stage], system, start, scheme, velocity_multipliers, last, room, evaluations, .. } =
            self;
        for (which, list) in [&mut stage.x, &mut stage.y].into_iter().enumerate() {
            for (k, value) in list.iter_mut().enumerate() {
                *value = scheme.weights.iter().zip(&*last).map(|(weight, last)| weight * last[which][k]).sum();
            }
        }
        stage.evaluate(system, start, times)?;
        stage.find_x_rates(system, &velocity_multipliers[0])?;
        *evaluations += 1;
        let Solution { x, y, .. } = &mut room.real;
        for (k, x) in x.iter_mut().enumerate() {
            *x = (last[2][0][k] - h * stage.x_rates[k]) / 6.0;
        }
        y.fill(0.0);
        stage.to_body_axes(system, x, y);
        Ok(())
    }
}

/// out = factor × list
fn scaled(factor: f64, list: &[f64], out: &mut [f64]) {
    out.iter_mut().zip(list).for_each(|(out, value)| *out = factor * value);
}
