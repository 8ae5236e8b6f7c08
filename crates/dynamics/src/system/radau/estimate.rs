//! The estimated error of a step: Eq. (J24) of `docs/method/systems.md`.

use nalgebra::Vector3;
use rigid_kin::{f_inverse, rotation_vector, transformation_matrix};

use crate::conservative::ConservativeBody;
use crate::matrix::lists::larger;
use crate::system::collocation::STAGES;
use crate::system::collocation::two_step::TwoStepWeights;
use crate::system::description::System;
use crate::system::elimination::newton::Frozen;
use crate::system::radau::bound::Estimate;
use crate::system::radau::{Room, SystemMotion};
use crate::system::stage::{put, vector};
use crate::tolerance::ErrorKinds;

/// A velocity counts by what it moves in the run: springs and shapes hold it back within this part of it.
const HELD_WITHIN: f64 = 0.25;
/// Errors of places that nothing holds back count this many times: the motion carries them on, and often makes them larger.
const CARRIED: f64 = 4.0;
/// Times 1/(ζ_k ω_k) after which a mode has forgotten its errors.
const FORGOTTEN: f64 = 3.0;
/// Error of the order of the scheme, over that of the embedded formula to this power, of an oscillation whose amplitude is one.
const OF_EMBEDDED: [f64; 2] = [1.5, 1.5];

/// A motion in a run over the size of the largest body, below which the run is rest: its velocities are the rounding of forces that balance.
const STILL: f64 = 1e-12;

/// The two estimates e4 and e6 of an oscillation of amplitude a have e6/e4 = ρ and e4 = 5 ρ² a, up to this ρ.
const OF_AMPLITUDE: f64 = 5.0;
const LARGEST_RATIO: f64 = 0.25;

impl SystemMotion {
    /// The estimated errors of a step whose stages are known, in a run of some span: of each kind the smaller of two estimates. Without a
    /// span, what nobody bounds is only looked at for NaN.
    pub(super) fn errors(&mut self, h: f64, span: f64) -> Estimate {
        let energy = self.energy_so_far();
        let energy = if energy < self.still_energy(span) { 0.0 } else { energy };
        let Self { stages, system, matrices, patterns, scheme, .. } = self;
        let kappa = scheme.real / (HELD_WITHIN * span);
        let is_in_run = span.is_finite();
        let is_regular = !is_in_run || matrices.factor_drift(system, patterns, &stages[1], kappa);
        let kinds = |motion: &mut Self| {
            let errors = motion.errors_of_places([h, span], energy);
            if !is_in_run {
                return errors;
            }
            let [place, drift] = if is_regular { motion.lasting(kappa, energy) } else { [f64::NAN; 2] };
            ErrorKinds { place: larger(errors.place, CARRIED * place), drift, ..errors }
        };
        let fine = (is_in_run && self.find_two_step(h)).then(|| {
            self.filter_twice();
            kinds(self)
        });
        self.find_embedded(h);
        let embedded = kinds(self);
        let is_gauss = self.scheme.at_end.is_some();
        let errors = match &fine {
            Some(fine) => fine.with(&embedded, |fine, embedded| {
                let of_gauss = if embedded > 0.0 { (0.5 * (fine / embedded).sqrt()).min(1.0) } else { 1.0 };
                let fine = if is_gauss { fine * of_gauss } else { fine };
                if fine <= embedded { fine } else { embedded }
            }),
            None => embedded.of_scheme(OF_EMBEDDED),
        };
        let largest = errors.largest();
        // What Gauss does not resolve it keeps: only Radau forgets.
        let amplitude = fine.filter(|_| !is_gauss).map(|fine| {
            let ratio = (fine.deformation / embedded.deformation).min(LARGEST_RATIO);
            embedded.deformation / (OF_AMPLITUDE * ratio * ratio)
        });
        let amplitude = if is_gauss { Some(f64::INFINITY) } else { amplitude };
        Estimate { errors, amplitude, has_order_of_scheme: fine.is_none() || largest < embedded.largest() }
    }

    /// Keeps what later estimates need of a step that is taken, before its stages are changed.
    pub(super) fn keep_past(&mut self) {
        let Self { past, stages: [.., last], stage_rates: [.., rates], system, start, .. } = self;
        past.steps = if past.steps == 0 { 1 } else { 2 };
        std::mem::swap(&mut past.start, &mut past.end);
        let [x, y] = &mut past.end;
        x.copy_from_slice(&last.velocities);
        for (b, attitude) in last.attitudes.iter().enumerate() {
            let first = system.first[b];
            let velocity = attitude.tr_mul(&vector(x, first));
            put(x, first, &velocity);
        }
        y.copy_from_slice(&rates.y);
        for (b, largest) in past.largest_deformations.iter_mut().enumerate() {
            *largest = largest.max(deformation(system, b, &start.q, None));
            *largest = largest.max(deformation(system, b, &start.q, Some(&last.x)));
        }
    }

    /// The largest kinetic and strain energy so far, with that at the end of the step that is tried.
    pub(super) fn energy_so_far(&mut self) -> f64 {
        let Self { largest_moving, stages: [.., last], system, .. } = self;
        let [moving, _] = last.energies(system, 0.0);
        largest_moving.max(moving)
    }

    /// Energy of bodies that move by a part of their size in a span which is rounding: less than that is rest.
    fn still_energy(&self, span: f64) -> f64 {
        let mass: f64 = self.system.bodies.iter().map(ConservativeBody::mass).sum();
        energy_of_way(mass, STILL * self.size, span)
    }

    /// Way of a body in its frame in the last step, as it moves and turns.
    pub(in crate::system) fn way_of_last_step(&self, body: usize) -> f64 {
        let [.., last] = &self.stages;
        let [moved, turned] = [0, 3].map(|part| vector(&last.x, self.system.first[body] + part).norm());
        moved + self.size * turned
    }

    /// Finds the estimate of the embedded formula, in the axes of the bodies.
    fn find_embedded(&mut self, h: f64) {
        let Self { stages, scheme, system, room, matrices, patterns, first, .. } = self;
        let real = &mut room.real;
        for k in 0..system.coordinates() {
            let mut difference = [first.x_rates[k], first.y_rates[k]];
            for i in 0..STAGES {
                let rate = (0..STAGES).map(|j| scheme.inverse[(i, j)] * stages[j].x[k]).sum::<f64>() / h;
                difference[0] -= scheme.at_start[i] * rate;
                difference[1] -= scheme.at_start[i] * stages[i].y_rates[k];
            }
            [real.x[k], real.y[k]] = difference;
        }
        stages[1].to_body_axes(system, &mut real.x, &mut real.y);
        real.lambda.fill(0.0);
        real.mu.fill(0.0);
        let frozen = Frozen { system, stage: &stages[1], patterns, matrices };
        frozen.solve(real, &matrices.real);
    }

    /// Finds the estimate of two steps, unfiltered, in the axes of the bodies. False where there is none.
    fn find_two_step(&mut self, h: f64) -> bool {
        let needed = if self.scheme.at_end.is_some() { 1 } else { 2 };
        if self.past.steps < needed || self.last_length == 0.0 {
            return false;
        }
        let Some(weights) = self.scheme.two_step_weights(self.last_length / h) else { return false };
        let Self {
            stages,
            scheme,
            system,
            room,
            first,
            past,
            last,
            last_length,
            multipliers,
            velocity_multipliers,
            ..
        } = self;
        let Room { real, y_rates: [rates, ..], .. } = room;
        let TwoStepWeights { now, before, start: of_start, rate_before, rate_now } = weights;
        if rate_now != 0.0 {
            // The forces of the joints at the start, by the polynomial of the stages.
            let [lambda, ..] = velocity_multipliers;
            for (row, lambda) in lambda.iter_mut().enumerate() {
                *lambda = (0..STAGES).map(|i| scheme.at_start[i] * multipliers[i][row]).sum();
            }
            first.find_y_rates(system, lambda, rates);
        } else {
            rates.fill(0.0);
        }
        let at_end = scheme.at_end.unwrap_or([0.0, 0.0, 1.0]);
        for (which, (out, rates)) in [(&mut real.x, &first.x_rates), (&mut real.y, &*rates)].into_iter().enumerate() {
            for (k, out) in out.iter_mut().enumerate() {
                let of_stage = |i: usize| if which == 0 { stages[i].x[k] } else { stages[i].y[k] };
                let end: f64 = (0..STAGES).map(|i| at_end[i] * last[i][which][k]).sum();
                let of_last: f64 = (0..STAGES).map(|i| before[i] * (last[i][which][k] - end)).sum();
                *out = (0..STAGES).map(|i| now[i] * of_stage(i)).sum::<f64>() + of_last - of_start * end
                    + rate_before * *last_length * past.start[which][k]
                    + rate_now * h * rates[k];
            }
        }
        // Turns of the step before, as seen from its end.
        for b in 0..system.bodies.len() {
            let at = system.first[b] + 3;
            let turn = |i: usize| vector(&last[i][0], at);
            let end = (0..STAGES).map(|i| at_end[i] * turn(i)).sum::<Vector3<f64>>();
            let back = transformation_matrix(&end).transpose();
            let mut sum = (0..STAGES).map(|i| now[i] * vector(&stages[i].x, at)).sum::<Vector3<f64>>();
            for (i, before) in before.into_iter().enumerate().filter(|(_, before)| *before != 0.0) {
                let Ok(turned) = rotation_vector(&(transformation_matrix(&turn(i)) * back)) else { return false };
                sum += before * turned;
            }
            sum -= of_start * end;
            if rate_before != 0.0 {
                let Ok(rate) = f_inverse(&-end, &vector(&past.start[0], at)) else { return false };
                sum += rate_before * *last_length * rate;
            }
            sum += rate_now * h * vector(&first.x_rates, at);
            put(&mut real.x, at, &sum);
        }
        stages[1].to_body_axes(system, &mut real.x, &mut real.y);
        true
    }

    /// Takes out of an estimate what the step damps in it, and what joints forbid.
    fn filter_twice(&mut self) {
        let Self { stages, system, room, matrices, patterns, .. } = self;
        let real = &mut room.real;
        let frozen = Frozen { system, stage: &stages[1], patterns, matrices };
        for _ in 0..2 {
            real.lambda.fill(0.0);
            real.mu.fill(0.0);
            frozen.solve(real, &matrices.real);
            for change in real.x.iter_mut().chain(&mut real.y) {
                *change *= matrices.real.kappa;
            }
        }
    }

    /// Errors of places and of deformation by an estimate.
    pub(super) fn errors_of_places(&self, [h, span]: [f64; 2], energy: f64) -> ErrorKinds {
        let Self { stages: [.., last], system, room, past, start, size, matrices, .. } = self;
        let x = &room.real.x;
        let kappa = self.scheme.real / (HELD_WITHIN * span);
        let (mut place, mut deformed) = (0.0, 0.0);
        for (b, body) in system.bodies.iter().enumerate() {
            let own = system.first[b]..system.first[b + 1];
            let of_place = largest_place(&x[own.clone()], *size);
            // Light links of a taut chain follow what they hang between, and vibrate about it as a string that deforms.
            if span.is_finite() && matrices.tension.holds(b, kappa) {
                deformed = larger(deformed, of_place);
            } else {
                place = larger(place, of_place);
            }
            let shapes = &x[own.start + 6..own.end];
            let [shift, turn] = [0, 3].map(|part| vector(x, own.start + part));
            let rigid = body.mass() * shift.norm_squared() + turn.dot(&(body.undeformed_inertia() * turn));
            let bent: f64 = shapes.iter().map(|q| q * q).sum();
            // Of a vibration in which the body moves as well as bends, as joints make it, only the bending is damped.
            let part_bent = if bent > 0.0 { bent / (bent + rigid) } else { 1.0 };
            let mut square = 0.0;
            for (k, q) in shapes.iter().enumerate() {
                let (omega, zeta) = (body.circular_frequencies[k], body.damping_ratios[k]);
                let memory = FORGOTTEN / (omega * zeta.min(zeta.recip()) * part_bent * span);
                let weight = if span.is_finite() { memory.max(h / span).min(1.0) } else { 1.0 };
                square += (q * weight).powi(2);
            }
            if square == 0.0 {
                continue;
            }
            let now = deformation(system, b, &start.q, Some(&last.x));
            deformed = larger(deformed, square.sqrt() / past.scale_of_deformation(system, b, energy).max(now));
        }
        ErrorKinds { place, deformation: deformed, ..ErrorKinds::default() }
    }

    /// The parts of an estimate that springs and shapes do not hold back in a run, through the matrix of that κ: the largest change of
    /// place; and the change of velocities, over the largest speed so far.
    fn lasting(&mut self, kappa: f64, energy: f64) -> [f64; 2] {
        let Self { stages, system, room, matrices, patterns, size, .. } = self;
        let Room { real, held, .. } = room;
        let frozen = Frozen { system, stage: &stages[1], patterns, matrices };
        held.clear();
        held.x.copy_from_slice(&real.x);
        frozen.solve(held, &matrices.drift);
        let of_body = |body: usize| largest_place(&held.x[system.first[body]..], *size);
        let lasts = |body: &usize| !matrices.tension.holds(*body, kappa);
        let place = kappa * (0..system.bodies.len()).filter(lasts).map(of_body).fold(0.0, larger);
        if energy == 0.0 {
            return [place, 0.0];
        }
        held.clear();
        held.y.copy_from_slice(&real.y);
        frozen.solve(held, &matrices.drift);
        let of_body = |(b, body): (usize, &ConservativeBody)| {
            let [velocity, spin] = [0, 3].map(|part| kappa * kappa * vector(&held.x, system.first[b] + part));
            body.mass() * velocity.norm_squared() + spin.dot(&(body.undeformed_inertia() * spin))
        };
        let square: f64 = system.bodies.iter().enumerate().filter(|(b, _)| lasts(b)).map(of_body).sum();
        [place, (square / (2.0 * energy)).sqrt()]
    }
}

/// Kinetic energy of a mass that goes so far in a time: every floor of an energy, below which there is rest.
pub(in crate::system) fn energy_of_way(mass: f64, way: f64, time: f64) -> f64 {
    0.5 * mass * (way / time).powi(2)
}

/// Place over the size of bodies, or attitude, of a body whose coordinates come first.
fn largest_place(x: &[f64], size: f64) -> f64 {
    larger(vector(x, 0).norm() / size, vector(x, 3).norm())
}

/// The deformation of a body, as root mean square over its mass, at the start of a step or after changes since.
fn deformation(system: &System, body: usize, start: &[f64], changes: Option<&[f64]>) -> f64 {
    let flexible = system.bodies[body].flexible();
    let first = system.first[body] + 6;
    let of_mode = |k: usize| start[k] + changes.map_or(0.0, |changes| changes[k]);
    (first..first + flexible).map(|k| of_mode(k).powi(2)).sum::<f64>().sqrt()
}
