//! Motion of a rigid body under forces: Newton and Euler by a fourth-order Lie-group scheme.

use nalgebra::{Matrix3, Matrix3x4, Vector3};

use crate::attitude::Attitude;
use crate::inertia::{Inertia, InertiaError};
use crate::reference_points::euler_angular_acceleration;
use crate::rotation::{BeyondFullTurn, f_inverse};

/// Why numbers make no rigid body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RigidBodyError {
    /// The mass is zero, negative or not finite.
    #[error("the mass of a rigid body is {mass}; give a finite number above zero")]
    Mass {
        /// The mass given.
        mass: f64,
    },
    /// The inertia tensor is none.
    #[error(transparent)]
    Inertia(#[from] InertiaError),
}

/// Why a step could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The body turns too far within the step.
    #[error("in the step from t = {time} to {}: {source}", time + step)]
    Rotation {
        /// Time at the start of the step.
        time: f64,
        /// Length of the step.
        step: f64,
        /// The angle found.
        source: BeyondFullTurn,
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

/// State of a rigid body. Without loads both momenta are constant to the last digit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidState {
    /// Attitude of the body axes.
    pub attitude: Attitude,
    /// Position of the centre of mass, global components.
    pub position_global: Vector3<f64>,
    /// Linear momentum, global components.
    pub linear_momentum_global: Vector3<f64>,
    /// Angular momentum about the centre of mass, global components.
    pub angular_momentum_global: Vector3<f64>,
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

    /// The state with these velocities: `velocity_global` of the centre of mass, and
    /// `omega_body` (rad/s) in body components.
    pub fn state(
        &self,
        attitude: Attitude,
        position_global: Vector3<f64>,
        velocity_global: &Vector3<f64>,
        omega_body: &Vector3<f64>,
    ) -> RigidState {
        RigidState {
            attitude,
            position_global,
            linear_momentum_global: self.mass * velocity_global,
            angular_momentum_global: attitude.to_global(&(self.inertia.matrix() * omega_body)),
        }
    }

    /// Velocity of the centre of mass, global components.
    pub fn velocity_global(&self, state: &RigidState) -> Vector3<f64> {
        state.linear_momentum_global / self.mass
    }

    /// Angular velocity (rad/s), body components.
    pub fn omega_body(&self, state: &RigidState) -> Vector3<f64> {
        self.inertia.inverse() * state.attitude.to_body(&state.angular_momentum_global)
    }

    /// Angular acceleration by Euler's equation, J⁻¹(moment − ω×Jω) (rad/s², body components).
    pub fn angular_acceleration_body(&self, state: &RigidState, moment_body: &Vector3<f64>) -> Vector3<f64> {
        let alpha_modal = self.inertia.inverse() * moment_body;
        euler_angular_acceleration(&alpha_modal, &self.inertia, &self.omega_body(state))
    }

    /// Kinetic energy of translation and rotation.
    pub fn kinetic_energy(&self, state: &RigidState) -> f64 {
        let omega = self.omega_body(state);
        0.5 * state.linear_momentum_global.norm_squared() / self.mass + 0.5 * omega.dot(&(self.inertia.matrix() * omega))
    }

    /// The state after one step from `time` to `time + step`, by the classical Runge–Kutta scheme
    /// on the rotation vector of the step (Runge–Kutta–Munthe-Kaas, fourth order):
    ///
    /// ```text
    /// θ' = f⁻¹(θ) ω,    r' = P/m,    P' = force,    L' = Aᵀ moment,    ω = J⁻¹ A(θ) L
    /// ```
    ///
    /// `wrench` gives force and moment at a time and attitude.
    ///
    /// # Errors
    /// [`StepError`] if the body turns by 2π or more within the step, or the result is not
    /// finite.
    pub fn step(
        &self,
        state: &RigidState,
        time: f64,
        step: f64,
        wrench: impl Fn(f64, &Attitude) -> Wrench,
    ) -> Result<RigidState, StepError> {
        // Columns: rotation vector since the start of the step, position, linear momentum,
        // angular momentum.
        let rate = |t: f64, y: &Matrix3x4<f64>| {
            let columns = [0, 1, 2, 3].map(|i| Vector3::from(y.column(i)));
            let [theta, _, linear_momentum, angular_momentum] = columns;
            let attitude = state.attitude.advanced_by(&theta);
            let omega = self.inertia.inverse() * attitude.to_body(&angular_momentum);
            let load = wrench(t, &attitude);
            let theta_rate =
                f_inverse(&theta, &omega).map_err(|source| StepError::Rotation { time, step, source })?;
            Ok(Matrix3x4::from_columns(&[
                theta_rate,
                linear_momentum / self.mass,
                load.force_global,
                attitude.to_global(&load.moment_body),
            ]))
        };
        let start = Matrix3x4::from_columns(&[
            Vector3::zeros(),
            state.position_global,
            state.linear_momentum_global,
            state.angular_momentum_global,
        ]);
        let k1 = rate(time, &start)?;
        let k2 = rate(time + 0.5 * step, &(start + 0.5 * step * k1))?;
        let k3 = rate(time + 0.5 * step, &(start + 0.5 * step * k2))?;
        let k4 = rate(time + step, &(start + step * k3))?;
        let end = start + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        if !end.iter().all(|entry| entry.is_finite()) {
            return Err(StepError::NotFinite { time, step });
        }
        Ok(RigidState {
            attitude: state.attitude.advanced_by(&end.column(0).into()),
            position_global: end.column(1).into(),
            linear_momentum_global: end.column(2).into(),
            angular_momentum_global: end.column(3).into(),
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

    #[test]
    fn order_is_four_under_a_dead_force() {
        let body = RigidBody::new(2.0, Samples::new(9).inertia_matrix()).unwrap();
        let start = body.state(
            Attitude::identity().advanced_by(&Vector3::new(0.3, 1.0, -0.4)),
            Vector3::new(1.0, 2.0, 3.0),
            &Vector3::new(0.1, -0.2, 0.3),
            &Vector3::new(2.0, -3.0, 1.0),
        );
        let errors = |steps: u32| {
            let (coarse, fine) = (run(&body, start, 2.0, steps, loaded), run(&body, start, 2.0, 8 * steps, loaded));
            [
                coarse.attitude.angle_to(&fine.attitude),
                (coarse.position_global - fine.position_global).norm(),
                (coarse.angular_momentum_global - fine.angular_momentum_global).norm(),
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

    #[test]
    fn free_motion_follows_the_closed_form() {
        let mut samples = Samples::new(10);
        for _ in 0..5 {
            let body = RigidBody::new(1.5, samples.inertia_matrix()).unwrap();
            let attitude = Attitude::identity().advanced_by(&samples.vector());
            let omega = 2.0 * samples.vector();
            let velocity = samples.vector();
            let start = body.state(attitude, Vector3::zeros(), &velocity, &omega);
            let end = run(&body, start, 5.0, 5000, |_, _| Wrench::zero());

            let exact = TorqueFreeMotion::new(body.inertia(), attitude, omega).unwrap().at(5.0).unwrap();
            assert!(end.attitude.angle_to(&exact.attitude) < 1e-9);
            assert!((body.omega_body(&end) - exact.omega_body).norm() < 1e-9);
            assert!((end.position_global - 5.0 * velocity).norm() < 1e-13);
            assert_eq!(end.linear_momentum_global, start.linear_momentum_global);
            assert_eq!(end.angular_momentum_global, start.angular_momentum_global);
            let energy = body.kinetic_energy(&start);
            let drift = (body.kinetic_energy(&end) - energy).abs() / energy;
            assert!(drift < 1e-11, "{drift:e}");
        }
    }

    /// Heavy symmetrical top of Simo & Wong (1991): the inertia is about the fixed point, and
    /// the translation of the body is not used.
    #[test]
    fn heavy_top_keeps_energy_spin_and_vertical_momentum() {
        let top = RigidBody::new(20.0, diagonal(5.0, 5.0, 1.0)).unwrap();
        let (to_center, weight) = (Vector3::z(), -20.0 * Vector3::z());
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.05, 0.0, 0.0));
        let start = top.state(attitude, Vector3::zeros(), &Vector3::zeros(), &Vector3::new(0.0, 0.0, 50.0));
        let energy = |state: &RigidState| {
            let omega = top.omega_body(state);
            0.5 * omega.dot(&(top.inertia().matrix() * omega)) - weight.dot(&state.attitude.to_global(&to_center))
        };
        assert!((energy(&start) - 1269.975).abs() < 1e-4);
        let end = run(&top, start, 1.0, 4000, |_, attitude| Wrench {
            force_global: Vector3::zeros(),
            ..Wrench::dead_force(attitude, &to_center, &weight)
        });
        let tilt = |state: &RigidState| state.attitude.to_global(&to_center).z.acos();
        println!("tilt {} energy drift {:e}", tilt(&end), energy(&end) - energy(&start));
        assert!((energy(&end) - energy(&start)).abs() < 1e-8);
        assert!((top.omega_body(&end).z - 50.0).abs() < 1e-9);
        assert!((end.angular_momentum_global.z - start.angular_momentum_global.z).abs() < 1e-13);
        assert!((tilt(&end) - tilt(&start)).abs() > 1e-3, "the top must nutate");
    }

    #[test]
    fn a_constant_force_gives_a_parabola_and_a_dead_pair_a_pendulum() {
        let body = RigidBody::new(2.0, diagonal(1.0, 2.0, 2.5)).unwrap();
        let start = body.state(Attitude::identity(), Vector3::zeros(), &Vector3::x(), &Vector3::zeros());
        let force = Vector3::new(0.0, 4.0, 0.0);
        let end = run(&body, start, 3.0, 7, |_, attitude| Wrench::dead_force(attitude, &Vector3::zeros(), &force));
        assert!((end.position_global - Vector3::new(3.0, 9.0, 0.0)).norm() < 1e-14);

        // A force along y at X = x̂ turns the body about z: I3 θ'' = F cos θ, so that
        // ½ I3 θ'² = F sin θ.
        let end = run(&body, start, 1.0, 1000, |_, attitude| Wrench::dead_force(attitude, &Vector3::x(), &force));
        let x_axis = end.attitude.to_global(&Vector3::x());
        let spin = body.omega_body(&end);
        assert!(spin.xy().norm() < 1e-15 && spin.z.abs() > 0.5);
        assert!((0.5 * 2.5 * spin.z * spin.z - 4.0 * x_axis.y).abs() < 1e-12);
    }

    #[test]
    fn angular_acceleration_is_the_derivative_of_angular_velocity() {
        let body = RigidBody::new(2.0, Samples::new(11).inertia_matrix()).unwrap();
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.2, 0.4, -0.1));
        let start = body.state(attitude, Vector3::zeros(), &Vector3::zeros(), &Vector3::new(1.0, -2.0, 0.5));
        let h = 1e-3;
        let omega = |t: f64| body.omega_body(&body.step(&start, 0.0, t, loaded).unwrap());
        let slope = (8.0 * (omega(h) - omega(-h)) - omega(2.0 * h) + omega(-2.0 * h)) / (12.0 * h);
        let found = body.angular_acceleration_body(&start, &loaded(0.0, &attitude).moment_body);
        assert!((slope - found).norm() < 1e-9, "{:e}", (slope - found).norm());
    }

    #[test]
    fn what_cannot_move_is_refused() {
        assert_eq!(RigidBody::new(0.0, Matrix3::identity()), Err(RigidBodyError::Mass { mass: 0.0 }));
        assert!(matches!(RigidBody::new(f64::NAN, Matrix3::identity()), Err(RigidBodyError::Mass { .. })));
        assert!(matches!(RigidBody::new(1.0, Matrix3::zeros()), Err(RigidBodyError::Inertia(_))));

        let body = RigidBody::new(1.0, Matrix3::identity()).unwrap();
        let state = |spin| {
            body.state(Attitude::identity(), Vector3::zeros(), &Vector3::zeros(), &Vector3::new(0.0, 0.0, spin))
        };
        let too_far = body.step(&state(100.0), 0.0, 0.2, |_, _| Wrench::zero());
        assert!(matches!(too_far, Err(StepError::Rotation { source, .. }) if source.angle > 6.3));
        let no_number = Wrench { force_global: Vector3::repeat(f64::NAN), moment_body: Vector3::zeros() };
        let refused = body.step(&state(1.0), 2.0, 0.1, |_, _| no_number);
        assert_eq!(refused, Err(StepError::NotFinite { time: 2.0, step: 0.1 }));
    }
}
