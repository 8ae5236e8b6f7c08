//! The motion at one time, whichever scheme made it.

pub(crate) mod energies;
pub(crate) mod moment;
pub(crate) mod observer;
pub(crate) mod observers;
pub(crate) mod reaction;
pub(crate) mod support_reactions;
pub(crate) mod system;
pub(crate) mod work;

use nalgebra::Vector3;
use rigid_kin::Attitude;

use crate::body::physics::DrivenMotion;
use crate::matrix::four::all_finite;
use crate::observation::reaction::Reaction;
use crate::observation::work::Work;

/// Motion of a point, global components.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointMotion {
    /// Displacement from where the point was in the undeformed body at the beginning.
    pub displacement: Vector3<f64>,
    /// Velocity.
    pub velocity: Vector3<f64>,
    /// Acceleration.
    pub acceleration: Vector3<f64>,
    /// Acceleration of the embedded rigid motion at the point: `a + α×X + ω×(ω×X)`.
    pub rigid_acceleration: Vector3<f64>,
    /// Displacement by deformation alone, body components: Ψ ξ at the point.
    pub elastic_displacement_body: Vector3<f64>,
    /// The same, global components.
    pub elastic_displacement_global: Vector3<f64>,
}

/// The motion at one time. Lists have one entry for each flexible mode, or for each point that was asked for.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Observation {
    /// Time.
    pub time: f64,
    /// Attitude of the body frame.
    pub attitude: Attitude,
    /// Position of the body's origin, global components: of a free body, that of its centre of mass.
    pub origin_global: Vector3<f64>,
    /// Acceleration of the body's origin, global components; zero in the formulation of the paper.
    pub origin_acceleration_global: Vector3<f64>,
    /// Position of the centre of mass, global components.
    pub position_global: Vector3<f64>,
    /// Velocity of the centre of mass, global components.
    pub velocity_global: Vector3<f64>,
    /// Angular velocity of the body frame, body components.
    pub omega_body: Vector3<f64>,
    /// Angular acceleration of the body frame, body components.
    pub alpha_body: Vector3<f64>,
    /// Flexible modal displacements.
    pub modal_displacement: Vec<f64>,
    /// Flexible modal velocities.
    pub modal_velocity: Vec<f64>,
    /// Flexible modal accelerations.
    pub modal_acceleration: Vec<f64>,
    /// Kinetic energy.
    pub kinetic_energy: f64,
    /// Strain energy.
    pub strain_energy: f64,
    /// Work of loads and dissipation since the beginning.
    pub work: Work,
    /// Linear momentum, global components.
    pub linear_momentum_global: Vector3<f64>,
    /// Angular momentum about the centre of mass, or the fixed point of a body that is held, global components.
    pub angular_momentum_global: Vector3<f64>,
    /// Reaction of the constraints on the body.
    pub reaction: Reaction,
    /// Motion of the points, in the order in which they were asked for.
    pub points: Vec<PointMotion>,
}

impl Observation {
    /// The acceleration of the body along a driven motion: of its origin along a slide, its angular one about the axis of a turn.
    pub fn acceleration_of(&self, motion: &DrivenMotion) -> f64 {
        match motion {
            DrivenMotion::Slide { direction } => self.attitude.to_body(&self.origin_acceleration_global).dot(direction),
            DrivenMotion::Turn { axis } => self.alpha_body.dot(axis),
        }
    }

    /// Zeros, for `flexible` modes and `points` points: room for a motion.
    pub fn new(flexible: usize, points: usize) -> Self {
        let list = || vec![0.0; flexible];
        Self {
            time: 0.0,
            attitude: Attitude::identity(),
            origin_global: Vector3::zeros(),
            origin_acceleration_global: Vector3::zeros(),
            position_global: Vector3::zeros(),
            velocity_global: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            alpha_body: Vector3::zeros(),
            modal_displacement: list(),
            modal_velocity: list(),
            modal_acceleration: list(),
            kinetic_energy: 0.0,
            strain_energy: 0.0,
            work: Work::default(),
            linear_momentum_global: Vector3::zeros(),
            angular_momentum_global: Vector3::zeros(),
            reaction: Reaction::default(),
            points: vec![PointMotion::default(); points],
        }
    }

    /// True if all quantities are finite numbers.
    pub fn is_finite(&self) -> bool {
        // All fields by name, so that none that is added is forgotten.
        let Self {
            time,
            attitude,
            origin_global,
            origin_acceleration_global,
            position_global,
            velocity_global,
            omega_body,
            alpha_body,
            modal_displacement,
            modal_velocity,
            modal_acceleration,
            kinetic_energy,
            strain_energy,
            work: Work { work, dissipation, impulse_global, angular_impulse_global },
            linear_momentum_global,
            angular_momentum_global,
            reaction,
            points,
        } = self;
        let modal = [modal_displacement, modal_velocity, modal_acceleration];
        let vectors =
            [origin_global, origin_acceleration_global, position_global, velocity_global, omega_body, alpha_body];
        let momenta = [impulse_global, angular_impulse_global, linear_momentum_global, angular_momentum_global];
        let of_points = |point: &PointMotion| {
            let PointMotion {
                displacement,
                velocity,
                acceleration,
                rigid_acceleration,
                elastic_displacement_body,
                elastic_displacement_global,
            } = *point;
            let elastic = 0.0 * elastic_displacement_body + 0.0 * elastic_displacement_global;
            (0.0 * displacement + 0.0 * velocity + 0.0 * acceleration + 0.0 * rigid_acceleration + elastic).sum()
        };
        // 0·x = 0 only for finite x.
        let [w, x, y, z] = attitude.wxyz();
        let numbers = [*time, *kinetic_energy, *strain_energy, *work, *dissipation, w, x, y, z];
        let zeros = numbers.into_iter().chain(reaction.numbers().copied()).map(|number| 0.0 * number).sum::<f64>()
            + vectors.into_iter().chain(momenta).map(|vector| 0.0 * vector).sum::<Vector3<f64>>().sum()
            + points.iter().map(of_points).sum::<f64>();
        zeros == 0.0 && modal.into_iter().all(|list| all_finite(list))
    }

    /// Kinetic + strain energy.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy + self.strain_energy
    }

    /// Kinetic + strain energy − work of the loads + dissipation: a constant of the motion.
    pub fn energy_balance(&self) -> f64 {
        self.energy() - self.work.work + self.work.dissipation
    }

    /// Linear momentum less the impulse of the loads: a constant of the motion.
    pub fn linear_balance_global(&self) -> Vector3<f64> {
        self.linear_momentum_global - self.work.impulse_global
    }

    /// Angular momentum less the angular impulse of the loads: a constant of the motion.
    pub fn angular_balance_global(&self) -> Vector3<f64> {
        self.angular_momentum_global - self.work.angular_impulse_global
    }
}
