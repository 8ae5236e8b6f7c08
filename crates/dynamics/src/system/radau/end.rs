//! The end of a step: momenta, works, and the projections.

use nalgebra::Vector3;

use crate::conservative::{get, part};
use crate::error::RateError;
use crate::state::attitude_at;
use crate::system::radau::{Failed, SystemMotion};
use crate::system::stage::{about_global_origin, put, vector};

/// The largest turn of a body, rad, for which the matrices of where it began are good. Only an assembly goes beyond.
const FAR: f64 = 0.3;
/// Passes of the projection of positions.
const MAX_PROJECTIONS: usize = 20;

impl SystemMotion {
    /// Takes the increments to the end of the step, and gives what flies freely the momenta that the loads have given it.
    pub(super) fn reach_end(&mut self, h: f64) {
        let Self { stages, system, multipliers, scheme, room, .. } = self;
        for (i, stage) in stages.iter_mut().enumerate() {
            stage.find_y_rates(system, &multipliers[i], &mut room.y_rates[i]);
        }
        let [first, middle, last] = stages;
        if let Some([a, b, c]) = scheme.at_end {
            for (last, [first, middle]) in [(&mut last.x, [&first.x, &middle.x]), (&mut last.y, [&first.y, &middle.y])]
            {
                let others = first.iter().zip(middle);
                last.iter_mut()
                    .zip(others)
                    .for_each(|(last, (first, middle))| *last = a * first + b * middle + c * *last);
            }
        }
        let rates = &room.y_rates;
        last.correct_momenta(system, |k| {
            h * rates.iter().zip(scheme.weights).map(|(rates, weight)| weight * rates[k]).sum::<f64>()
        });
    }

    /// Adds the integrals over a step: works, impulses, dissipation. What joints and elements do to a body counts as its loads do,
    /// so that its balances close.
    pub(super) fn add_work(&mut self, h: f64) {
        let Self { stages, multipliers, scheme, bodies, system, joint_works, .. } = self;
        for ((stage, lambda), weight) in stages.iter_mut().zip(&*multipliers).zip(scheme.weights) {
            let mut of_rows = lambda.iter().zip(&stage.constraints.own_rates);
            for (joint, work) in system.connections.joints.iter().zip(&mut *joint_works) {
                let power: f64 = of_rows.by_ref().take(joint.row_count()).map(|(lambda, rate)| -lambda * rate).sum();
                work.drive += h * weight * power;
            }
            for ((joint, ..), power) in system.connections.joint_forces().zip(&stage.joint_powers) {
                let work = &mut joint_works[joint];
                work.drive += h * weight * power.motor;
                work.spring += h * weight * power.spring;
                work.loss -= h * weight * power.friction;
            }
            self.element_work += h * weight * stage.element_power;
            stage.find_joint_forces(lambda);
            for (b, state) in bodies.iter_mut().enumerate() {
                let mut list = system.bodies[b].list_mut(state);
                let mut slow = *list.slow();
                let mut rates = *stage.evaluations[b].rates.slow();
                stage.add_joint_exchange(system, b, &mut rates);
                for k in part::WORK..slow.len() {
                    slow[k] += h * weight * rates[k];
                }
                list.set_slow(&slow);
            }
        }
    }

    /// Projects the end of a step, and takes it for the state. Returns the largest residual and rate that are left.
    /// The second time says which branches of the drives hold.
    pub(super) fn end(&mut self, times: [f64; 2], h: f64) -> Result<[f64; 2], Failed> {
        let Self { stages: [.., last], system, start, matrices, patterns, room, scheme, .. } = self;
        last.place(system, start);
        last.find_constraints(system, start, times);
        last.linearize(system, times);
        matrices.compliant.copy_from_slice(&last.constraints.compliant);
        if !matrices.factor_real(system, patterns, last, scheme.real / h) {
            return Err(Failed::Rates(RateError::Inertia));
        }
        // Positions.
        let (mut left, real) = (f64::INFINITY, &mut room.real);
        for _ in 0..MAX_PROJECTIONS {
            let largest = last.constraints.residuals.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            if largest >= 0.5 * left || largest == 0.0 {
                left = largest.min(left);
                break;
            }
            left = largest;
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
        // Velocities.
        last.evaluate(system, start, times)?;
        self.evaluations += 1;
        real.y.fill(0.0);
        let rates = last.project_velocities(system, &mut real.y, |rates| matrices.of_mass.solve(&patterns.rows, rates));
        for (b, state) in self.bodies.iter_mut().enumerate() {
            let body = &system.bodies[b];
            let (first, end_of_body) = (system.first[b], system.first[b + 1]);
            let [impulse, angular_impulse] =
                [0, 3].map(|part| last.attitudes[b].tr_mul(&vector(&real.y, first + part)));
            about_global_origin(&mut real.y[first..end_of_body], &last.positions[b], &last.attitudes[b]);
            let turned = attitude_at(&state.values, 0).advanced_by(&vector(&last.x, first + 3));
            let momentum = start.bodies[b].momentum + vector(&last.y, first) + vector(&real.y, first);
            let angular_momentum =
                start.bodies[b].angular_momentum + vector(&last.y, first + 3) + vector(&real.y, first + 3);
            let position = last.positions[b];
            let pi = turned.to_body(&(angular_momentum - position.cross(&momentum)));
            let mut list = body.list_mut(state);
            list.set_attitude(turned);
            let mut slow = *list.slow();
            put(&mut slow, part::THETA, &Vector3::zeros());
            put(&mut slow, part::POSITION, &position);
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
            start.joints[joint] = last.joint_coordinates(system, joint, start.turn(joint, times[0]));
        }
        self.time = times[0];
        Ok([left, rates])
    }
}
