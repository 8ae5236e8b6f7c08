//! The motion that a state of the conservative form stands for.

use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::column_major::dot;
use crate::conservative::{ConservativeBody, ConservativeState, Evaluation, Translation, get, part};
use crate::error::RateError;
use crate::motion::PointShapes;
use crate::observation::{Observation, PointMotion};
use crate::work::Work;

impl ConservativeBody {
    /// Reads the motion off a state. `e` is overwritten.
    pub(crate) fn observe(
        &self,
        state: &ConservativeState,
        initial_attitude: &Attitude,
        points: &[PointShapes],
        e: &mut Evaluation,
        out: &mut Observation,
    ) -> Result<(), RateError> {
        let (q, p) = (&state.modal_displacement, &state.modal_momentum);
        self.evaluate([state.time, state.time], &state.attitude, &state.slow, q, p, e)?;
        let (kinetic, strain) = self.energies(state, e);
        self.add_linear(q, p, e);
        let driven_acceleration = self.drive.as_ref().map_or(0.0, |drive| drive.acceleration(state.time, state.time));
        let spin_rate = self.accelerations(driven_acceleration, e, &mut out.modal_acceleration)?;
        let alpha = self.axes.iter().zip(spin_rate.iter()).map(|(axis, a)| axis * *a).sum::<Vector3<f64>>();
        let omega = e.omega_body;

        let global = |v_body: Vector3<f64>| state.attitude.to_global(&v_body);
        let velocity_of_origin = get(&e.slow, part::POSITION);
        let acceleration_of_origin = match self.translation {
            Translation::None => Vector3::zeros(),
            Translation::Free | Translation::Along(_) => get(&e.slow, part::MOMENTUM) / self.mass,
            Translation::Driven(direction) => global(direction) * driven_acceleration,
        };
        let position = get(&state.slow, part::POSITION);
        let center = self.center.position_body(q);
        out.time = state.time;
        out.attitude = state.attitude;
        out.origin_global = position;
        out.position_global = position + global(center);
        out.velocity_global = velocity_of_origin + global(omega.cross(&center) + self.center.deformation(&e.velocity));
        out.omega_body = omega;
        out.alpha_body = alpha;
        out.modal_displacement.clone_from(q);
        out.modal_velocity.clone_from(&e.velocity);
        out.kinetic_energy = kinetic;
        out.strain_energy = strain;
        self.observe_momenta(state, e, out);
        let moved = position - self.origin;
        out.points.clear();
        out.points.extend(points.iter().map(|point| {
            let x = point.position_body();
            let (u, v, a) =
                (point.deformation(q), point.deformation(&e.velocity), point.deformation(&out.modal_acceleration));
            let arm = x + u;
            PointMotion {
                displacement: moved + (global(arm) - initial_attitude.to_global(&x)),
                velocity: velocity_of_origin + global(omega.cross(&arm) + v),
                acceleration: acceleration_of_origin
                    + global(alpha.cross(&arm) + omega.cross(&omega.cross(&arm)) + 2.0 * omega.cross(&v) + a),
                rigid_acceleration: acceleration_of_origin + global(alpha.cross(&x) + omega.cross(&omega.cross(&x))),
            }
        }));
        Ok(())
    }

    /// Modal accelerations into `modal`, and the rate of the spin.
    ///
    /// π = J ω + Sᵀq̇ and p = q̇ + S ω, differentiated: with S' = S(q̇) − b, where S'ᵀq̇ = 0 (G is skew) but for what is driven,
    /// (J − SᵀS) ω' = π' − J'ω − Sᵀ(p' − S'ω),  q̈ = p' − S'ω − S ω'.
    fn accelerations(
        &self,
        driven_acceleration: f64,
        e: &Evaluation,
        modal: &mut Vec<f64>,
    ) -> Result<Vector3<f64>, RateError> {
        let nf = self.flexible();
        let (s, n_q) = e.products.split_at(self.s_rows);
        modal.clear();
        modal.extend_from_slice(&e.momentum);
        for (g, w) in e.gyroscopic.chunks_exact(nf.max(1)).zip(e.spin.iter()) {
            modal.iter_mut().zip(g).for_each(|(a, g)| *a -= g * w);
        }
        modal.iter_mut().zip(&e.sliding).for_each(|(a, b)| *a -= b * driven_acceleration);
        modal.iter_mut().zip(&e.drive_stiffened).for_each(|(a, k_v)| *a += k_v * e.driven_speed);
        let spin_rate = if self.turn_driven {
            Vector3::new(driven_acceleration, 0.0, 0.0)
        } else if self.axes.is_empty() {
            Vector3::zeros()
        } else {
            let mut inertia_rate = Matrix3::zeros();
            for (((i, j), first), n_q) in self.pairs.iter().zip(&self.first).zip(n_q.chunks_exact(nf.max(1))) {
                let rate: f64 = first.iter().zip(n_q).zip(&e.velocity).map(|((c, n), v)| 2.0 * (c + n) * v).sum();
                inertia_rate[(*i, *j)] = rate;
                inertia_rate[(*j, *i)] = rate;
            }
            let mut right = get(&e.slow, part::PI) - inertia_rate * e.spin;
            for (i, s) in s.chunks_exact(nf.max(1)).enumerate() {
                right[i] -= dot(s, modal);
            }
            self.solve_locked(e, &right)?
        };
        for (s, w) in s.chunks_exact(nf.max(1)).zip(spin_rate.iter()) {
            modal.iter_mut().zip(s).for_each(|(a, s)| *a -= s * w);
        }
        Ok(spin_rate)
    }

    /// Momenta and what has been done to them. What holds or drives a body gives it whatever its momenta need, so there
    /// only the motions that it has left are balanced.
    fn observe_momenta(&self, state: &ConservativeState, e: &Evaluation, out: &mut Observation) {
        let along_axes = |components: Vector3<f64>| -> Vector3<f64> {
            self.axes.iter().zip(components.iter()).map(|(axis, c)| axis * *c).sum()
        };
        out.work = Work {
            work: state.slow[part::WORK],
            dissipation: state.slow[part::DISSIPATION],
            impulse_global: get(&state.slow, part::IMPULSE),
            angular_impulse_global: get(&state.slow, part::ANGULAR_IMPULSE),
        };
        if self.turn_driven {
            out.angular_momentum_global = along_axes(Vector3::new(e.driven_momentum, 0.0, 0.0));
            out.work.angular_impulse_global = out.angular_momentum_global;
        } else {
            out.angular_momentum_global = state.attitude.to_global(&along_axes(get(&state.slow, part::PI)));
        }
        match self.translation {
            Translation::Free => out.linear_momentum_global = get(&state.slow, part::MOMENTUM),
            _ => {
                out.linear_momentum_global = out.velocity_global * self.mass;
                out.work.impulse_global = out.linear_momentum_global;
            }
        }
    }
}
