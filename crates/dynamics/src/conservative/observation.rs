//! The motion that a state of the conservative form stands for.

use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::body::shapes::PointShapes;
use crate::conservative::body::{ConservativeBody, Translation};
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::{get, part, set};
use crate::error::RateError;
use crate::observation::reaction::HeldMotion;
use crate::observation::work::Work;
use crate::observation::{Observation, PointMotion};
use crate::state::State;

/// The rates of a motion made accelerations, in the widest vectors that the processor has.
struct Accelerate<'a> {
    body: &'a ConservativeBody,
    driven_acceleration: f64,
    e: &'a mut Evaluation,
}

impl WithSimd for Accelerate<'_> {
    type Output = Result<Vector3<f64>, RateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.body.accelerate(simd, self.driven_acceleration, self.e)
    }
}

impl ConservativeBody {
    /// Finds q̈, and gives the rate of the spin, where `e` has the rates of a state.
    pub(crate) fn find_accelerations(
        &self,
        driven_acceleration: f64,
        e: &mut Evaluation,
    ) -> Result<Vector3<f64>, RateError> {
        for (k, rate) in e.acceleration.iter_mut().enumerate() {
            *rate = e.rates.p()[k] + self.linear_rate(k, e.at.q()[k], e.at.p()[k]);
        }
        Arch::new().dispatch(Accelerate { body: self, driven_acceleration, e })
    }

    /// Adds a force (global), a moment about the origin (body axes) and modal forces to the rates of a free body.
    pub(crate) fn add_forces(
        &self,
        [force_global, moment_body]: [&Vector3<f64>; 2],
        modal: &[f64],
        e: &mut Evaluation,
    ) {
        let mut rates = *e.rates.slow();
        for (first, vector) in [(part::MOMENTUM, force_global), (part::PI, moment_body)] {
            let sum = get(&rates, first) + vector;
            set(&mut rates, first, &sum);
        }
        e.rates.set_slow(&rates);
        let [_, momentum] = e.rates.modes_mut();
        momentum.iter_mut().zip(modal).for_each(|(rate, force)| *rate += force);
    }

    /// Reads the motion off a state whose rates are in `e`, and leaves these as they are.
    pub(super) fn read_motion(
        &self,
        state: &State,
        points: &[PointShapes],
        e: &mut Evaluation,
        out: &mut Observation,
    ) -> Result<(), RateError> {
        let [translation, kinetic, strain] = self.energies(state, e);
        let driven_acceleration =
            self.drive.as_ref().map_or(0.0, |drive| drive.acceleration_at(state.time, state.time));
        let spin_rate = self.find_accelerations(driven_acceleration, e)?;
        out.modal_acceleration.copy_from_slice(&e.acceleration);
        let alpha = self.axis_columns * spin_rate;
        let omega = e.omega_body;

        let list = self.list(state);
        let (time, attitude) = (state.time, list.attitude());
        let global = |v_body: Vector3<f64>| attitude.to_global(&v_body);
        let velocity_of_origin = get(e.rates.slow(), part::POSITION) + self.frame.velocity();
        let acceleration_of_origin = match self.translation {
            Translation::None => Vector3::zeros(),
            Translation::Free | Translation::Along(_) => get(e.rates.slow(), part::MOMENTUM) / self.mass,
            Translation::Driven(direction) => global(direction) * driven_acceleration,
        };
        let position = get(list.slow(), part::POSITION);
        self.extend_acceleration(e);
        self.find_in_shapes(e);
        if let Some(manifold) = &self.manifold {
            manifold.in_shapes(&e.change, &mut e.in_shapes[2]);
        }
        let e = &*e;
        let shapes = match &self.manifold {
            Some(_) => e.in_shapes.each_ref().map(Vec::as_slice),
            None => [e.at.q(), &*e.modal_velocity, &*e.change],
        };
        let center = self.center.position_body(shapes[0]);
        out.time = time;
        out.attitude = attitude;
        out.origin_global = self.frame.global_place(&position, time);
        out.origin_acceleration_global = acceleration_of_origin;
        out.position_global = self.frame.global_place(&(position + global(center)), time);
        out.velocity_global = velocity_of_origin + global(omega.cross(&center) + self.center.deformation(shapes[1]));
        out.omega_body = omega;
        out.alpha_body = alpha;
        out.modal_displacement.copy_from_slice(e.at.q());
        out.modal_velocity.copy_from_slice(&e.modal_velocity);
        out.kinetic_energy = translation + kinetic + self.energy_of_frame(&get(list.slow(), part::MOMENTUM));
        out.strain_energy = strain;
        self.observe_momenta(state, e, out);
        let moved = self.moved(&position, time);
        let acceleration_body = attitude.to_body(&acceleration_of_origin);
        self.observe_reaction(state, shapes, [&alpha, &acceleration_body], e, out);
        let to_global = attitude.global_to_body().transpose();
        let to_initial = self.initial_attitude.global_to_body().transpose();
        out.points.clear();
        out.points.extend(points.iter().map(|point| {
            let (of_reference, [u, v, a]) = (point.of_reference(), point.deformations(shapes));
            let x = point.position_body() - of_reference;
            let u = u + of_reference;
            let arm = x + u;
            PointMotion {
                displacement: moved + (to_global * arm - to_initial * x),
                velocity: velocity_of_origin + to_global * (omega.cross(&arm) + v),
                acceleration: acceleration_of_origin
                    + to_global * (alpha.cross(&arm) + omega.cross(&omega.cross(&arm)) + 2.0 * omega.cross(&v) + a),
                rigid_acceleration: acceleration_of_origin
                    + to_global * (alpha.cross(&x) + omega.cross(&omega.cross(&x))),
                elastic_displacement_body: u,
                elastic_displacement_global: to_global * u,
            }
        }));
        Ok(())
    }

    /// The way of the origin since the beginning, global, from a place in the frame.
    fn moved(&self, position: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.frame.way(time) + (position - (self.origin - self.frame.anchor()))
    }

    /// Reaction of the constraints, at ξ, ν and ν' of the shapes. `e` has all rates; the accelerations, of the turning and
    /// of the origin, are body components.
    fn observe_reaction(
        &self,
        state: &State,
        shapes: [&[f64]; 3],
        [alpha, acceleration_of_origin]: [&Vector3<f64>; 2],
        e: &Evaluation,
        out: &mut Observation,
    ) {
        let Some(held) = &self.held else { return };
        let state = self.list(state);
        let [displacement, velocity, shape_acceleration] = shapes;
        let (omega, center) = (e.omega_body, self.center.position_body(displacement));
        let [center_rate, center_change] = [velocity, shape_acceleration].map(|of| self.center.deformation(of));
        let center_acceleration = acceleration_of_origin
            + alpha.cross(&center)
            + omega.cross(&omega.cross(&center))
            + 2.0 * omega.cross(&center_rate)
            + center_change;
        let [force, moment] = held.momentum_rates(&HeldMotion {
            omega,
            alpha: *alpha,
            acceleration: *acceleration_of_origin,
            center,
            center_acceleration,
            displacement,
            velocity,
            shape_acceleration,
            modal_displacement: state.q(),
            modal_velocity: &e.modal_velocity,
        });
        let reaction = &mut out.reaction;
        reaction.force_body = force - e.load_force;
        reaction.moment_body = moment - e.load_moment;
        // The drive knows the momentum of what its own stress draws in, too.
        let along = match (self.translation, &self.axes[..]) {
            (Translation::Driven(direction), _) => Some((direction, &mut reaction.force_body)),
            (_, [axis]) if self.turn_driven => Some((*axis, &mut reaction.moment_body)),
            _ => None,
        };
        if let Some((axis, vector)) = along {
            *vector += axis * (e.drive_effort - axis.dot(vector));
            reaction.drive = e.drive_effort;
            reaction.drive_power = e.drive_effort * e.driven_speed;
        }
        if self.axes.len() == 1 {
            reaction.hinge_angle = state.hinge_angle();
            reaction.hinge_rate = e.spin[0];
        }
        if let Translation::Along(direction) | Translation::Driven(direction) = self.translation {
            let direction = state.attitude().to_global(&direction);
            reaction.slider_position = direction.dot(&self.moved(&get(state.slow(), part::POSITION), out.time));
            reaction.slider_velocity = direction.dot(&get(e.rates.slow(), part::POSITION));
        }
    }

    /// Momenta and what has been done to them. What holds or drives a body gives it whatever its momenta need, so there
    /// only the motions that it has left are balanced.
    fn observe_momenta(&self, state: &State, e: &Evaluation, out: &mut Observation) {
        let along_axes = |components: Vector3<f64>| -> Vector3<f64> {
            self.axes.iter().zip(components.iter()).map(|(axis, c)| axis * *c).sum()
        };
        let list = self.list(state);
        let slow = list.slow();
        let [work, dissipation] = self.work_and_dissipation_of(state);
        out.work = Work {
            work,
            dissipation,
            impulse_global: get(slow, part::IMPULSE),
            angular_impulse_global: get(slow, part::ANGULAR_IMPULSE),
        };
        if self.turn_driven {
            out.angular_momentum_global = along_axes(Vector3::new(e.driven_momentum, 0.0, 0.0));
            out.work.angular_impulse_global = out.angular_momentum_global;
        } else {
            out.angular_momentum_global = list.attitude().to_global(&along_axes(get(slow, part::PI)));
        }
        match self.translation {
            Translation::Free => {
                out.linear_momentum_global = get(slow, part::MOMENTUM) + self.frame.velocity() * self.mass;
            }
            _ => {
                out.linear_momentum_global = out.velocity_global * self.mass;
                out.work.impulse_global = out.linear_momentum_global;
            }
        }
    }
}
