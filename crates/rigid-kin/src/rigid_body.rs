//! Motion of a rigid body under forces: Newton and Euler by a fourth-order Lie-group scheme.

use nalgebra::{Matrix3, Matrix3x4, Vector3};

use crate::attitude::Attitude;
use crate::inertia::{Inertia, InertiaError};
use crate::reference_points::euler_angular_acceleration;
use crate::rotation::{BeyondFullTurn, f_inverse};

/// Errors of numbers that make no rigid body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidBodyError {
    /// The mass is zero, negative or not finite.
    #[error("the mass of a rigid body is {mass}; give a finite number above zero")]
    Mass {
        /// The mass given.
        mass: f64,
    },
    /// The inertia tensor is not one of a body.
    #[error(transparent)]
    Inertia(#[from] InertiaError),
}

/// Errors of a step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidStepError {
    /// The body turns too far within the step.
    #[error(
        "in the step from t = {time} to {} the body turns by {angle} rad, a full turn or more; take a step well \
         below the period of the spin",
        time + step
    )]
    TurnTooLarge {
        /// Time at the start of the step.
        time: f64,
        /// Length of the step.
        step: f64,
        /// Angle turned within the step (rad).
        angle: f64,
    },
    /// The state after the step is not finite.
    #[error(
        "the state of the rigid body is not finite after the step from t = {time} to {}; look at \
         the initial state, and at the forces and moments at these times",
        time + step
    )]
    NotFinite {
        /// Time at the start of the step.
        time: f64,
        /// Length of the step.
        step: f64,
    },
}

/// Force and moment on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Force, global components.
    pub force_global: Vector3<f64>,
    /// Moment about the centre of mass, body components.
    pub moment_body: Vector3<f64>,
}

impl Wrench {
    /// No force and no moment.
    pub fn zero() -> Self {
        Self { force_global: Vector3::zeros(), moment_body: Vector3::zeros() }
    }

    /// A force that keeps its global direction, at a point of the body: the moment is X × A F.
    ///
    /// `point_body` is X, from the centre of mass in body components; `force_global` is F.
    pub fn dead_force(attitude: &Attitude, point_body: &Vector3<f64>, force_global: &Vector3<f64>) -> Self {
        Self { force_global: *force_global, moment_body: point_body.cross(&attitude.to_body(force_global)) }
    }
}

/// State of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidState {
    /// Attitude of the body axes.
    pub attitude: Attitude,
    /// Angular velocity (rad/s), body components.
    pub omega_body: Vector3<f64>,
    /// Position of the centre of mass, global components.
    pub position_global: Vector3<f64>,
    /// Velocity of the centre of mass, global components.
    pub velocity_global: Vector3<f64>,
}

/// A rigid body: mass, and inertia about the centre of mass in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    mass: f64,
    inertia: Inertia,
}

impl RigidBody {
    /// Takes the mass and the inertia tensor about the centre of mass, body axes.
    ///
    /// # Errors
    /// [`RigidBodyError`] if the mass is not positive, or as [`Inertia::new`].
    pub fn new(mass: f64, inertia: Matrix3<f64>) -> Result<Self, RigidBodyError> {
        if mass.is_finite() && mass > 0.0 {
            Ok(Self { mass, inertia: Inertia::new(inertia)? })
        } else {
            Err(RigidBodyError::Mass { mass })
        }
    }

    /// The mass.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The inertia tensor about the centre of mass.
    pub fn inertia(&self) -> &Inertia {
        &self.inertia
    }

    /// Angular acceleration by Euler's equation, J⁻¹(moment − ω×Jω) (rad/s², body components), of
    /// a moment about the centre of mass and an angular velocity, both in body components.
    pub fn angular_acceleration_body(&self, omega_body: &Vector3<f64>, moment_body: &Vector3<f64>) -> Vector3<f64> {
        euler_angular_acceleration(&(self.inertia.inverse() * moment_body), &self.inertia, omega_body)
    }

    /// Angular momentum about the centre of mass, global components.
    pub fn angular_momentum_global(&self, state: &RigidState) -> Vector3<f64> {
        state.attitude.to_global(&(self.inertia.matrix() * state.omega_body))
    }

    /// Kinetic energy of translation and rotation.
    pub fn kinetic_energy(&self, state: &RigidState) -> f64 {
        let RigidState { omega_body, velocity_global, .. } = state;
        0.5 * self.mass * velocity_global.norm_squared() + 0.5 * omega_body.dot(&(self.inertia.matrix() * omega_body))
    }

    /// The state after one step from `time` to `time + step`, by the classical Runge–Kutta scheme
    /// on the rotation vector of the step (Runge–Kutta–Munthe-Kaas, fourth order):
    ///
    /// ```text
    /// θ' = f⁻¹(θ) ω,    ω' = J⁻¹(moment − ω×Jω),    r' = v,    v' = force/m
    /// ```
    ///
    /// `wrench` gives force and moment at a time and attitude.
    ///
    /// # Errors
    /// [`RigidStepError`] if the body turns by 2π or more within the step, or the result is not
    /// finite.
    pub fn step(
        &self,
        state: &RigidState,
        time: f64,
        step: f64,
        wrench: impl Fn(f64, &Attitude) -> Wrench,
    ) -> Result<RigidState, RigidStepError> {
        let refusal = |BeyondFullTurn { angle }| {
            if angle.is_finite() {
                RigidStepError::TurnTooLarge { time, step, angle }
            } else {
                RigidStepError::NotFinite { time, step }
            }
        };
        // Columns: rotation vector since the start of the step, ω, position, velocity.
        let rate = |t: f64, y: &Matrix3x4<f64>| {
            let [theta, omega, _, velocity] = [0, 1, 2, 3].map(|i| Vector3::from(y.column(i)));
            let load = wrench(t, &state.attitude.advanced_by(&theta));
            Ok(Matrix3x4::from_columns(&[
                f_inverse(&theta, &omega).map_err(refusal)?,
                self.angular_acceleration_body(&omega, &load.moment_body),
                velocity,
                load.force_global / self.mass,
            ]))
        };
        let start = Matrix3x4::from_columns(&[
            Vector3::zeros(),
            state.omega_body,
            state.position_global,
            state.velocity_global,
        ]);
        let k1 = rate(time, &start)?;
        let k2 = rate(time + 0.5 * step, &(start + 0.5 * step * k1))?;
        let k3 = rate(time + 0.5 * step, &(start + 0.5 * step * k2))?;
        let k4 = rate(time + step, &(start + step * k3))?;
        let end = start + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        if !end.iter().all(|entry| entry.is_finite()) {
            return Err(RigidStepError::NotFinite { time, step });
        }
        Ok(RigidState {
            attitude: state.attitude.advanced_by(&end.column(0).into()),
            omega_body: end.column(1).into(),
            position_global: end.column(2).into(),
            velocity_global: end.column(3).into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Samples;
    use crate::torque_free::TorqueFreeMotion;

    fn diagonal(a: f64, b: f64, c: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(a, b, c))
    }

    fn run(
        body: &RigidBody,
        start: RigidState,
        end: f64,
        steps: u32,
        wrench: impl Fn(f64, &Attitude) -> Wrench,
    ) -> RigidState {
        let step = end / f64::from(steps);
        (0..steps).fold(start, |state, n| body.step(&state, f64::from(n) * step, step, &wrench).unwrap())
    }

    /// A tumbling body with a dead force at a corner and a force that grows with time.
    fn loaded(t: f64, attitude: &Attitude) -> Wrench {
        let force = Vector3::new(3.0 * (2.0 * t).sin(), -1.0 + t * t, 2.0);
        Wrench::dead_force(attitude, &Vector3::new(0.5, -0.3, 0.8), &force)
    }

    /// Conserved: order 4.
    #[test]
    fn order_is_four_under_a_dead_force() {
        let body = RigidBody::new(2.0, Samples::new(9).inertia_matrix()).unwrap();
        let start = RigidState {
            attitude: Attitude::identity().advanced_by(&Vector3::new(0.3, 1.0, -0.4)),
            omega_body: Vector3::new(2.0, -3.0, 1.0),
            position_global: Vector3::new(1.0, 2.0, 3.0),
            velocity_global: Vector3::new(0.1, -0.2, 0.3),
        };
        let errors = |steps: u32| {
            let (coarse, fine) = (run(&body, start, 2.0, steps, loaded), run(&body, start, 2.0, 8 * steps, loaded));
            [
                coarse.attitude.angle_to(&fine.attitude),
                (coarse.position_global - fine.position_global).norm(),
                (coarse.omega_body - fine.omega_body).norm(),
            ]
        };
        let (coarse, fine) = (errors(200), errors(400));
        let orders: Vec<f64> = (0..3).filter(|&i| fine[i] > 1e-14).map(|i| (coarse[i] / fine[i]).log2()).collect();
        println!("errors {coarse:?} {fine:?} orders {orders:?}");
        assert!(orders.len() >= 2);
        for order in orders {
            assert!((order - 4.0).abs() < 0.15, "{order}");
        }
    }

    fn spinning(attitude: Attitude, omega_body: Vector3<f64>) -> RigidState {
        RigidState { attitude, omega_body, position_global: Vector3::zeros(), velocity_global: Vector3::zeros() }
    }

    /// Closed form: the torque-free motion in elliptic functions.
    #[test]
    fn free_motion_follows_the_closed_form_and_conserves() {
        let mut samples = Samples::new(10);
        for _ in 0..5 {
            let body = RigidBody::new(1.5, samples.inertia_matrix()).unwrap();
            let attitude = Attitude::identity().advanced_by(&samples.vector());
            let start = RigidState { velocity_global: samples.vector(), ..spinning(attitude, 2.0 * samples.vector()) };
            let end = run(&body, start, 5.0, 5000, |_, _| Wrench::zero());

            let exact = TorqueFreeMotion::new(body.inertia(), attitude, start.omega_body).unwrap().at(5.0).unwrap();
            let attitude_error = end.attitude.angle_to(&exact.attitude);
            let omega_error = (end.omega_body - exact.omega_body).norm();
            let momentum = body.angular_momentum_global(&start);
            let momentum_drift = (body.angular_momentum_global(&end) - momentum).norm() / momentum.norm();
            let energy_drift = (body.kinetic_energy(&end) / body.kinetic_energy(&start) - 1.0).abs();
            println!("{attitude_error:e} {omega_error:e} momentum {momentum_drift:e} energy {energy_drift:e}");
            assert!(attitude_error < 1e-9 && omega_error < 1e-9);
            assert!(momentum_drift < 1e-9 && energy_drift < 1e-9);
            assert!((end.position_global - 5.0 * start.velocity_global).norm() < 1e-12);
            assert_eq!(end.velocity_global, start.velocity_global);
        }
    }

    /// Conserved: order 4 of the momentum.
    #[test]
    fn momentum_drift_is_of_fourth_order_and_energy_drift_above() {
        let body = RigidBody::new(1.0, diagonal(1.0, 2.0, 3.0)).unwrap();
        let start = spinning(Attitude::identity(), Vector3::new(1.0, 2.0, 3.0));
        let drifts = |steps| {
            let end = run(&body, start, 10.0, steps, |_, _| Wrench::zero());
            let momentum = body.angular_momentum_global(&end) - body.angular_momentum_global(&start);
            [momentum.norm(), (body.kinetic_energy(&end) - body.kinetic_energy(&start)).abs()]
        };
        let (coarse, fine) = (drifts(500), drifts(1000));
        let orders = [0, 1].map(|i: usize| (coarse[i] / fine[i]).log2());
        println!("drifts {coarse:?} {fine:?} orders {orders:?}");
        assert!((orders[0] - 4.0).abs() < 0.05, "{orders:?}");
        assert!(orders[1] > 5.0, "{orders:?}");
    }

    /// Conserved: energy, spin and vertical momentum of the heavy symmetrical top of Simo & Wong (1991): the inertia
    /// is about the fixed point, and the translation of the body is not used.
    #[test]
    fn heavy_top_keeps_energy_spin_and_vertical_momentum() {
        let top = RigidBody::new(20.0, diagonal(5.0, 5.0, 1.0)).unwrap();
        let (to_center, weight) = (Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.0, 0.0, -20.0));
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.05, 0.0, 0.0));
        let start = spinning(attitude, Vector3::new(0.0, 0.0, 50.0));
        let energy = |state: &RigidState| {
            let omega = state.omega_body;
            0.5 * omega.dot(&(top.inertia().matrix() * omega)) - weight.dot(&state.attitude.to_global(&to_center))
        };
        assert!((energy(&start) - 1269.975).abs() < 1e-4);
        let end = run(&top, start, 1.0, 4000, |_, attitude| Wrench {
            force_global: Vector3::zeros(),
            ..Wrench::dead_force(attitude, &to_center, &weight)
        });
        let vertical = |state| top.angular_momentum_global(state).z;
        let tilt = |state: &RigidState| state.attitude.to_global(&to_center).z.acos();
        let drift = energy(&end) - energy(&start);
        let vertical_drift = vertical(&end) - vertical(&start);
        println!("tilt {}, drift of energy {drift:e}, of momentum {vertical_drift:e}", tilt(&end));
        assert!(drift.abs() < 1e-8 && vertical_drift.abs() < 1e-8);
        assert!((end.omega_body.z - 50.0).abs() < 1e-11);
        assert!((tilt(&end) - tilt(&start)).abs() > 1e-3, "the top must nutate");
    }

    /// Closed form: a parabola, and ½ I θ'² = F sin θ.
    #[test]
    fn a_constant_force_gives_a_parabola_and_a_dead_force_a_pendulum() {
        let body = RigidBody::new(2.0, diagonal(1.0, 2.0, 2.5)).unwrap();
        let at_rest = spinning(Attitude::identity(), Vector3::zeros());
        let start = RigidState { velocity_global: Vector3::x(), ..at_rest };
        let force = Vector3::new(0.0, 4.0, 0.0);
        let end = run(&body, start, 3.0, 7, |_, attitude| Wrench::dead_force(attitude, &Vector3::zeros(), &force));
        assert!((end.position_global - Vector3::new(3.0, 9.0, 0.0)).norm() < 1e-14);

        // A force along y at X = x̂ turns the body about z: I3 θ'' = F cos θ, so that
        // ½ I3 θ'² = F sin θ.
        let end = run(&body, start, 1.0, 1000, |_, attitude| Wrench::dead_force(attitude, &Vector3::x(), &force));
        let x_axis = end.attitude.to_global(&Vector3::x());
        let spin = end.omega_body;
        assert!(spin.xy().norm() < 1e-15 && spin.z.abs() > 0.5);
        assert!((0.5 * 2.5 * spin.z * spin.z - 4.0 * x_axis.y).abs() < 1e-12);
    }

    /// Independent reference: differences in time.
    #[test]
    fn angular_acceleration_is_the_derivative_of_angular_velocity() {
        let body = RigidBody::new(2.0, Samples::new(11).inertia_matrix()).unwrap();
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.2, 0.4, -0.1));
        let start = spinning(attitude, Vector3::new(1.0, -2.0, 0.5));
        let h = 1e-3;
        let omega = |t: f64| body.step(&start, 0.0, t, loaded).unwrap().omega_body;
        let slope = (8.0 * (omega(h) - omega(-h)) - omega(2.0 * h) + omega(-2.0 * h)) / (12.0 * h);
        let found = body.angular_acceleration_body(&start.omega_body, &loaded(0.0, &attitude).moment_body);
        assert!((slope - found).norm() < 1e-9, "{:e}", (slope - found).norm());
    }

    #[test]
    fn what_cannot_move_is_refused() {
        assert_eq!(RigidBody::new(0.0, Matrix3::identity()), Err(RigidBodyError::Mass { mass: 0.0 }));
        assert!(matches!(RigidBody::new(f64::NAN, Matrix3::identity()), Err(RigidBodyError::Mass { .. })));
        assert!(matches!(RigidBody::new(1.0, Matrix3::zeros()), Err(RigidBodyError::Inertia(_))));

        let body = RigidBody::new(1.0, Matrix3::identity()).unwrap();
        let state = |spin| spinning(Attitude::identity(), Vector3::new(0.0, 0.0, spin));
        let too_far = body.step(&state(100.0), 0.0, 0.2, |_, _| Wrench::zero());
        assert!(matches!(too_far, Err(RigidStepError::TurnTooLarge { angle, .. }) if angle > 6.3));
        let (nan, zero) = (Vector3::repeat(f64::NAN), Vector3::zeros());
        for load in [Wrench { force_global: nan, moment_body: zero }, Wrench { force_global: zero, moment_body: nan }] {
            let refused = body.step(&state(1.0), 2.0, 0.1, |_, _| load);
            assert_eq!(refused, Err(RigidStepError::NotFinite { time: 2.0, step: 0.1 }));
        }
    }
}
