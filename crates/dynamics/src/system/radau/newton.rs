//! Newton's method for the stages of a step.

use nalgebra::Complex;

use crate::error::RateError;
use crate::matrix::lists::larger;
use crate::system::collocation::STAGES;
use crate::system::constraints::Compliant;
use crate::system::description::System;
use crate::system::elimination::newton::{Frozen, sizes};
use crate::system::joint::force::FrictionSlope;
use crate::system::radau::bound::Bound;
use crate::system::radau::rows::NEAR_SINGULAR;
use crate::system::radau::{Failed, Room, SystemMotion};
use crate::system::stage::Stage;

/// A change of positions that is rounding.
const ROUNDING: f64 = 1e-13;
/// Part of the energy that forces give bodies which no joint holds, below which what there is of it is rounding.
const STILL: f64 = 1e-8;
/// The rate of convergence that is counted on at most where forces are stiff.
const STIFF_RATE: f64 = 0.1;
/// Where rounding keeps Newton's method from the end, what velocities may be off by, over what places may.
const OF_VELOCITIES: f64 = 1e3;
/// The rate of convergence above which laws are asked anew, and how many times in a step.
const SLOW: f64 = 0.2;
const MAX_RENEWALS: usize = 3;
/// Rounding of the time over a step that is an instant.
const INSTANT: f64 = 1e-10;
/// Passes of Newton's method before a step is given up.
const MAX_PASSES: usize = 20;

impl SystemMotion {
    /// First values of the stages: the polynomials of the last step, continued.
    pub(super) fn predict(&mut self, h: f64) {
        for (i, stage) in self.stages.iter_mut().enumerate() {
            let c = self.scheme.times[i];
            if self.last_length > 0.0 {
                let factors = self.scheme.continued(1.0 + c * h / self.last_length);
                for (which, list) in [&mut stage.x, &mut stage.y].into_iter().enumerate() {
                    for (k, value) in list.iter_mut().enumerate() {
                        *value = factors.iter().zip(&self.last).map(|(factor, last)| factor * last[which][k]).sum();
                    }
                }
            } else {
                stage.x.iter_mut().zip(&self.first.x_rates).for_each(|(x, rate)| *x = c * h * rate);
                stage.y.iter_mut().zip(&self.first.y_rates).for_each(|(y, rate)| *y = c * h * rate);
            }
        }
        self.raise_energies(h);
        let [others @ .., last] = &mut self.multipliers;
        others.iter_mut().for_each(|lambda| lambda.copy_from_slice(last));
        self.velocity_multipliers.iter_mut().for_each(|mu| mu.fill(0.0));
    }

    /// Factors of the Newton matrix with the geometry of the second stage, where there are none yet, where laws are asked anew, or a
    /// compliant row has changed much. Returns whether they are new.
    fn factor(&mut self, h: f64, of_laws: bool, by: FrictionSlope) -> Result<bool, Failed> {
        // Forces that grow beyond all bounds near a singular position say nothing of a tension.
        let bears = if self.weakest_row() < NEAR_SINGULAR { 0.0 } else { 1.0 };
        let Self { matrices, system, stages, scheme, patterns, start, multipliers, .. } = self;
        let kappa = scheme.real / h;
        if !system.connections.is_rigid() {
            for (stage, c) in stages.iter_mut().zip(scheme.times) {
                stage.linearize(system, [start.time + c * h, start.time + 0.5 * h], by, of_laws);
            }
            if of_laws {
                take_stiffest(stages, system, kappa);
            }
        }
        let mut is_new = of_laws;
        // Tangents of friction are those of the middle stage: the largest of all would hold what slides.
        let mut frictions = system.connections.joint_forces().map(|(.., force)| force.friction.is_some());
        for (row, frozen) in matrices.compliant.iter_mut().enumerate() {
            let largest = stages.iter().map(|stage| stage.constraints.compliant[row]).reduce(Compliant::or);
            let mut largest = largest.unwrap_or_default();
            if by == FrictionSlope::Tangent && frictions.next().is_some_and(|is_held| is_held) {
                largest = stages[1].constraints.compliant[row];
            }
            if of_laws || largest.is_far_from(*frozen, kappa) {
                (*frozen, is_new) = (largest, true);
            }
        }
        is_new |= matrices.tension.find(system, &stages[1], (&multipliers[1], bears), kappa);
        if is_new {
            matrices.tension.freeze();
        }
        let is_regular = !is_new
            || matrices.factor_real(system, patterns, &stages[1], kappa, true)
                && matrices.factor_complex(system, patterns, &stages[1], scheme.complex / h);
        if is_regular { Ok(is_new) } else { Err(Failed::Newton) }
    }

    /// Newton's method for the stages. Returns the number of passes.
    pub(super) fn newton(&mut self, h: f64, bound: &Bound, by: FrictionSlope) -> Result<usize, Failed> {
        let Bound { exactness, enough, .. } = *bound;
        // With compliant rows, and in taut chains, the first changes fall faster than the later ones, which turn the axes of stiff forces.
        let is_rigid = self.system.connections.is_rigid();
        // Near a singular position what rounds off in a residual moves bodies by more.
        let weakest = self.weakest_row();
        let rounding = ROUNDING.max(self.rounding_over_gyration()) / weakest;
        // Momenta that are guessed by forces without joints may be far off where places are not. What a motor begins to turn within an instant
        // has work by what rounds in its times.
        let is_instant = f64::EPSILON * self.time.abs() > INSTANT * h;
        let guessed = usize::from(self.last_length == 0.0 && !is_instant);
        let ([mut last_position, mut last], mut since) = ([f64::INFINITY; 2], 0);
        let mut renewals = if self.system.connections.has_laws() { MAX_RENEWALS } else { 0 };
        let mut asks_laws = true;
        for pass in 1..=MAX_PASSES {
            self.evaluate_stages(h)?;
            self.find_energy(h);
            since = if self.factor(h, asks_laws, by)? { 1 } else { since + 1 };
            let [position, change] = self.improve(h, bound.span.is_finite());
            if !change.is_finite() {
                // The next try begins with them.
                self.multipliers.iter_mut().chain(&mut self.velocity_multipliers).for_each(|of| of.fill(0.0));
                return Err(Failed::Newton);
            }
            let rate = if since == 1 { 0.5 } else { change / last };
            asks_laws = since > 1 && rate > SLOW && renewals > 0;
            renewals -= usize::from(asks_laws);
            if position <= rounding && rate > 0.3 && pass > guessed {
                return Ok(pass);
            }
            if rate > 2.0 || (rate > 0.9 && since > 3 && change > rounding) {
                // Where rows nearly imply each other rounding comes early.
                let is_enough = position.max(last_position) <= enough && change.max(last) <= OF_VELOCITIES * enough;
                return if is_enough { Ok(pass) } else { Err(Failed::Newton) };
            }
            (last_position, last) = (position, change);
            let slowest = if is_rigid && !self.matrices.tension.is_taut() { 0.0 } else { STIFF_RATE };
            // The error that is left, by the rate of convergence.
            let left = change * rate.max(slowest) / (1.0 - rate.min(0.9));
            if (left <= exactness || change <= rounding) && pass > guessed {
                return Ok(pass);
            }
        }
        if last_position <= enough && last <= OF_VELOCITIES * enough { Ok(MAX_PASSES) } else { Err(Failed::Newton) }
    }

    /// Takes the energy at the start of a step of length `h` into account.
    pub(super) fn raise_energies(&mut self, h: f64) {
        let [moving, pushed] = self.first.energies(&self.system, h);
        self.largest_moving = self.largest_moving.max(moving);
        // From rest a step has what forces give it; later on that is far above what joints and springs let be of it.
        let scale = self.energy_scale();
        self.largest_energy = if scale == 0.0 { pushed } else { scale.max(STILL * pushed) };
    }

    /// The energy that changes are measured by, where the start has none: that of bodies at rest, on which loads begin to act within the
    /// step, or which drives have begun to move in the pass before.
    fn find_energy(&mut self, h: f64) {
        let Self { stages, system, largest_energy, .. } = self;
        if *largest_energy == 0.0 {
            *largest_energy = stages.iter_mut().flat_map(|stage| stage.energies(system, h)).fold(0.0, f64::max);
        }
    }

    fn evaluate_stages(&mut self, h: f64) -> Result<(), RateError> {
        let Self { stages, scheme, system, start, multipliers, velocity_multipliers, room, .. } = self;
        for (i, stage) in stages.iter_mut().enumerate() {
            let time = start.time + scheme.times[i] * h;
            stage.evaluate(system, start, [time, start.time + 0.5 * h])?;
            stage.find_x_rates(system, &velocity_multipliers[i])?;
            stage.find_y_rates(system, &multipliers[i], &mut room.y_rates[i]);
        }
        self.evaluations += STAGES as u64;
        Ok(())
    }

    /// One pass. Returns the size of the change of positions, and that with its energy and, where the errors of steps are measured, with
    /// the change of deformation.
    fn improve(&mut self, h: f64, is_measured: bool) -> [f64; 2] {
        let Self {
            stages,
            scheme,
            system,
            room,
            matrices,
            patterns,
            multipliers,
            velocity_multipliers,
            largest_energy,
            past,
            largest_moving,
            size,
            ..
        } = self;
        let Room { real, complex, y_rates, change: residuals, .. } = room;
        // Residuals in the axes of the bodies at each stage, transformed.
        real.clear();
        complex.clear();
        for i in 0..STAGES {
            let [x, y] = residuals;
            for k in 0..system.coordinates() {
                let sum = |of: fn(&Stage) -> &Vec<f64>| -> f64 {
                    (0..STAGES).map(|j| scheme.inverse[(i, j)] * of(&stages[j])[k]).sum::<f64>() / h
                };
                x[k] = stages[i].x_rates[k] - sum(|stage| &stage.x);
                y[k] = y_rates[i][k] - sum(|stage| &stage.y);
            }
            stages[i].to_body_axes(system, x, y);
            for k in 0..x.len() {
                for (residual, of_real, of_complex) in
                    [(x[k], &mut real.x[k], &mut complex.x[k]), (y[k], &mut real.y[k], &mut complex.y[k])]
                {
                    *of_real += scheme.to_real[i] * residual;
                    *of_complex += scheme.to_complex[i] * residual;
                }
            }
        }
        for row in 0..patterns.rows.len() {
            let (mut of_real, mut of_complex) = ([0.0; 2], [Complex::new(0.0, 0.0); 2]);
            for (i, stage) in stages.iter().enumerate() {
                let residuals = [-stage.constraints.residuals[row], -stage.constraint_rates[row]];
                for (which, residual) in residuals.into_iter().enumerate() {
                    of_real[which] += scheme.to_real[i] * residual;
                    of_complex[which] += scheme.to_complex[i] * residual;
                }
            }
            [real.lambda[row], real.mu[row]] = of_real;
            [complex.lambda[row], complex.mu[row]] = of_complex;
        }
        let frozen = Frozen { system, stage: &stages[1], patterns, matrices };
        frozen.solve(real, &matrices.real);
        frozen.solve(complex, &matrices.complex);
        let [mut moved, mut largest] = [0.0_f64; 2];
        for i in 0..STAGES {
            let change = |real: f64, complex: Complex<f64>| {
                scheme.from_real[i] * real + 2.0 * (scheme.from_complex[i] * complex).re
            };
            let [dx, dy] = residuals;
            for k in 0..dx.len() {
                (dx[k], dy[k]) = (change(real.x[k], complex.x[k]), change(real.y[k], complex.y[k]));
            }
            let [position, mut energy] = sizes(system, dx, [h, *size]);
            energy += matrices.strain_energy(&stages[1], dx);
            moved = larger(moved, position);
            let of_energy = if energy == 0.0 {
                0.0
            } else if *largest_energy == 0.0 {
                // Drives move what was at rest: the change is all that there is.
                1.0
            } else {
                (energy / *largest_energy).sqrt()
            };
            // Where energies are large and stiff bodies hardly bend, the norm of the energy does not see what they bend by.
            let of_deformation = if is_measured { past.relative_deformation(system, dx, *largest_moving) } else { 0.0 };
            largest = larger(larger(largest, larger(position, of_deformation)), of_energy);
            stages[i].add_in_body_axes(system, dx, dy);
            for row in 0..multipliers[i].len() {
                multipliers[i][row] += change(real.lambda[row], complex.lambda[row]);
                velocity_multipliers[i][row] += change(real.mu[row], complex.mu[row]);
            }
        }
        [moved, largest]
    }

    /// Keeps the bend of the step, after [`Self::errors`], which has found it: what is stiff has none.
    pub(super) fn find_bend(&mut self) {
        let Self { stages, system, room, scheme, bend: [x, y], .. } = self;
        for (bend, change) in [(&mut *x, &room.real.x), (&mut *y, &room.real.y)] {
            bend.iter_mut().zip(change).for_each(|(bend, change)| *bend = scheme.real * change);
        }
        stages[1].to_global_axes(system, x, y);
    }
}

/// Takes the directions of each element at the stage at which they are stiffest for all stages: those of one stage belong together.
fn take_stiffest(stages: &mut [Stage; STAGES], system: &System, kappa: f64) {
    let connections = &system.connections;
    let mut first = connections.joint_forces().count();
    for element in &connections.elements {
        let rows = first..first + element.directions();
        first = rows.end;
        let resistance = |stage: &Stage| {
            stage.constraints.compliant[rows.clone()].iter().map(|row| row.resistance(kappa)).sum::<f64>()
        };
        let mut stiffest = (1, resistance(&stages[1]));
        for stage in [0, 2] {
            let here = resistance(&stages[stage]);
            if here > stiffest.1 {
                stiffest = (stage, here);
            }
        }
        for to in (0..STAGES).filter(|to| *to != stiffest.0) {
            if let Ok([to, from]) = stages.get_disjoint_mut([to, stiffest.0]) {
                to.constraints.take_compliant(&from.constraints, rows.clone());
            }
        }
    }
}
