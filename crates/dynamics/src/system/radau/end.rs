//! The end of a step: momenta and the projections.

use nalgebra::Vector3;

use crate::conservative::{get, part};
use crate::error::RateError;
use crate::matrix::lists::larger;
use crate::state::attitude_at;
use crate::system::collocation::STAGES;
use crate::system::joint::force::FrictionSlope;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::stage::{about_center, put, vector};

/// The largest turn of a body, rad, for which the matrices of where it began are good. Only an assembly goes beyond.
const FAR: f64 = 0.3;
/// Passes of the projection of positions.
const MAX_PROJECTIONS: usize = 20;

impl SystemMotion {
    /// Takes the increments to the end of the step.
    pub(super) fn reach_end(&mut self) {
        let Self { stages: [first, middle, last], scheme, .. } = self;
        let Some([a, b, c]) = scheme.at_end else { return };
        for (last, [first, middle]) in [(&mut last.x, [&first.x, &middle.x]), (&mut last.y, [&first.y, &middle.y])] {
            let others = first.iter().zip(middle);
            last.iter_mut().zip(others).for_each(|(last, (first, middle))| *last = a * first + b * middle + c * *last);
        }
    }

    /// Takes the last stage, which has been brought to the end of a step, for the state, with what the step sums up by the weights of
    /// its stages; what flies freely gets the momenta that the loads have given it.
    pub(super) fn land(&mut self, times: [f64; 2], h: f64, weights: [f64; STAGES]) -> Result<(), Failed> {
        self.correct_momenta(weights);
        self.keep_spring_energies();
        self.keep_coordinates();
        let since = self.time;
        // Newton's method knows the laws by now.
        let is_explicit = self.scheme.is_explicit;
        self.project_positions(times, h, is_explicit)?;
        self.watch(times)?;
        if self.stages[STAGES - 1].hold_points(&self.system, &self.start) {
            // They have no spin that takes up what the projection has moved them by.
            self.correct_momenta(weights);
        }
        self.project_velocities(times)?;
        self.count_held(self.time - since);
        self.add_exchange(weights);
        self.settle_springs(weights);
        self.settle_laws(weights);
        Ok(())
    }

    /// Gives what flies freely the momenta that the loads have given it, by the weights of the stages.
    fn correct_momenta(&mut self, weights: [f64; STAGES]) {
        let Self { stages: [.., last], system, stage_rates, .. } = self;
        last.correct_momenta(system, |k| {
            stage_rates.iter().zip(weights).map(|(rates, weight)| weight * rates.y[k]).sum::<f64>()
        });
    }

    /// Projects the end of a step, and takes it for the state. Returns the largest residual and rate that are left.
    /// The second time says which branches of the drives hold.
    pub(super) fn end(&mut self, times: [f64; 2], h: f64) -> Result<[f64; 2], Failed> {
        let left = self.project_positions(times, h, true)?;
        Ok([left, self.project_velocities(times)?])
    }

    /// Moves the bodies at the end of a step so that the rows that are kept close. Returns the largest residual that is left.
    fn project_positions(&mut self, times: [f64; 2], h: f64, of_laws: bool) -> Result<f64, Failed> {
        let Self { stages: [.., last], system, start, matrices, patterns, room, scheme, .. } = self;
        last.place(system, start);
        last.find_constraints(system, start, times);
        last.linearize(system, times, FrictionSlope::Secant, of_laws);
        matrices.compliant.copy_from_slice(&last.constraints.compliant);
        if !matrices.factor_real(system, patterns, last, scheme.real / h, false) {
            return Err(Failed::Rates(RateError::Inertia));
        }
        // Positions.
        let is_rigid = system.coordinates() == 6 * system.bodies.len();
        let (mut left, real) = (f64::INFINITY, &mut room.real);
        for pass in 0..MAX_PROJECTIONS {
            let largest = last.constraints.residuals.iter().fold(0.0, |most, g| larger(most, g.abs()));
            if largest.is_nan() {
                return Err(Failed::Newton);
            }
            let is_slow = largest >= 0.5 * left;
            left = largest.min(left);
            // The first may be slow where flexible bodies have far to go; later ones are where rounding is all that is left.
            if is_slow && (pass > 1 || is_rigid) || largest == 0.0 {
                break;
            }
            real.lambda.fill(0.0);
            real.lambda.iter_mut().zip(&last.constraints.residuals).for_each(|(lambda, g)| *lambda = -g);
            matrices.real.rows.solve(&patterns.newton, &mut real.lambda);
            real.x.fill(0.0);
            last.constraints.add_forces(&real.lambda, &mut real.x);
            for (b, inverse) in matrices.real.bodies.iter().enumerate() {
                let (first, end) = (system.first[b], system.first[b + 1]);
                inverse.apply(&mut real.x[first..end]);
            }
            real.y.fill(0.0);
            let bodies = system.first[..system.bodies.len()].iter();
            let turned = bodies.map(|first| vector(&real.x, first + 3).norm()).fold(0.0, f64::max);
            let is_far = turned > FAR;
            if is_far {
                real.x.iter_mut().for_each(|x| *x *= FAR / turned);
            }
            last.add_in_body_axes(system, &mut real.x, &mut real.y);
            last.place(system, start);
            last.find_constraints(system, start, times);
            if is_far {
                break;
            }
        }
        Ok(left)
    }

    /// Projects the velocities at the end of a step, and takes it for the state. Returns the largest rate that is left.
    fn project_velocities(&mut self, times: [f64; 2]) -> Result<f64, Failed> {
        let Self { stages: [.., last], system, start, matrices, patterns, room, .. } = self;
        let real = &mut room.real;
        last.evaluate(system, start, times)?;
        self.evaluations += 1;
        real.y.fill(0.0);
        room.impulses.fill(0.0);
        let rates = last.project_velocities(system, &mut real.y, |rates| {
            matrices.of_mass.solve(&patterns.rows, rates);
            room.impulses.iter_mut().zip(&*rates).for_each(|(impulse, found)| *impulse -= found);
        });
        if rates.is_nan() {
            return Err(Failed::Newton);
        }
        for (b, state) in self.bodies.iter_mut().enumerate() {
            let body = &system.bodies[b];
            let (first, end_of_body) = (system.first[b], system.first[b + 1]);
            let [impulse, angular_impulse] =
                [0, 3].map(|part| last.attitudes[b].tr_mul(&vector(&real.y, first + part)));
            about_center(&mut real.y[first..end_of_body], &last.arms[b], &last.attitudes[b]);
            let turned = attitude_at(&state.values, 0).advanced_by(&vector(&last.x, first + 3));
            let momentum = start.bodies[b].momentum + vector(&last.y, first) + vector(&real.y, first);
            let angular_momentum =
                start.bodies[b].angular_momentum + vector(&last.y, first + 3) + vector(&real.y, first + 3);
            let pi = turned.to_body(&(angular_momentum - last.arms[b].cross(&momentum)));
            let mut list = body.list_mut(state);
            list.set_attitude(turned);
            let mut slow = *list.slow();
            put(&mut slow, part::THETA, &Vector3::zeros());
            put(&mut slow, part::POSITION, &last.positions[b]);
            put(&mut slow, part::MOMENTUM, &momentum);
            put(&mut slow, part::PI, &pi);
            let impulse = impulse + get(&slow, part::IMPULSE);
            put(&mut slow, part::IMPULSE, &impulse);
            let angular_impulse = angular_impulse + get(&slow, part::ANGULAR_IMPULSE);
            put(&mut slow, part::ANGULAR_IMPULSE, &angular_impulse);
            list.set_slow(&slow);
            let [q, p] = list.modes_mut();
            for k in 0..q.len() {
                let at = first + 6 + k;
                q[k] = start.q[at] + last.x[at];
                p[k] = start.p[at] + last.y[at] + real.y[at];
            }
            state.time = times[0];
        }
        for joint in 0..start.joints.len() {
            start.joints[joint] = last.joint_coordinates(system, start, joint);
        }
        self.time = times[0];
        Ok(rates)
    }
}
