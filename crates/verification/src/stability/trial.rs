//! A run of a case, and its largest error.

use dynamics::{Initial, Method, Observation, Physics, PointShapes, Rows, Setup, SharedLoad, Simulation, StepControl};
use frames_rk4::Paper;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::{Attitude, Inertia, TorqueFreeMotion};

use crate::stability::TrialOutcome;

/// A run.
#[derive(Debug, Clone)]
pub struct Trial<'a> {
    /// The body.
    pub body: &'a ReducedBody,
    /// One damping ratio for each flexible mode.
    pub damping_ratios: Vec<f64>,
    /// The loads.
    pub loads: Vec<SharedLoad>,
    /// R, P, Q from the centre of mass.
    pub reference_points: [Vector3<f64>; 3],
    /// How it begins.
    pub initial: Initial,
    /// Longest step.
    pub step: f64,
    /// End.
    pub end: f64,
    /// Number of times at which the error is looked at.
    pub rows: u32,
    /// Points that are watched.
    pub points: Vec<PointShapes>,
}

impl<'a> Trial<'a> {
    /// A free motion without loads and damping.
    pub fn free(body: &'a ReducedBody, initial: Initial, step: f64, end: f64) -> Self {
        Self {
            body,
            damping_ratios: vec![0.0; body.flexible()],
            loads: Vec::new(),
            reference_points: [Vector3::zeros(), Vector3::x(), Vector3::y()],
            initial,
            step,
            end,
            rows: 100,
            points: Vec::new(),
        }
    }

    /// The observations, the first one included, one after the other; the largest of their errors.
    pub fn largest(&self, method: Method, mut error: impl FnMut(&Observation, &Observation) -> f64) -> TrialOutcome {
        let paper = Paper { reference_points: self.reference_points };
        let setup = Setup {
            body: self.body,
            damping_ratios: &self.damping_ratios,
            loads: &self.loads,
            physics: &Physics::default(),
            initial: &self.initial,
            method: paper.or(&method),
            control: StepControl::Fixed(self.step),
            end: self.end,
            rows: Rows::Interval(self.end / f64::from(self.rows)),
            points: &self.points,
        };
        let mut simulation = match Simulation::new(&setup) {
            Ok(simulation) => simulation,
            Err(refusal) => return TrialOutcome::Refused(refusal.to_string()),
        };
        let first = match simulation.observation() {
            Ok(first) => first,
            Err(refusal) => return TrialOutcome::Refused(refusal.to_string()),
        };
        let mut largest = error(&first, &first);
        for row in simulation {
            match row {
                Ok(row) => largest = worse(largest, error(&first, &row)),
                Err(refusal) => return TrialOutcome::Refused(refusal.to_string()),
            }
        }
        TrialOutcome::Ran(largest)
    }

    /// The largest relative gap in the balances of energy and angular momentum.
    pub fn drift(&self, method: Method) -> TrialOutcome {
        let mut energy_scale = 0.0_f64;
        let mut momentum_scale = 0.0_f64;
        self.largest(method, |first, row| {
            energy_scale = energy_scale.max(internal_energy(row));
            momentum_scale = momentum_scale.max(row.angular_momentum_global.norm());
            let energy = row.energy_balance() - first.energy_balance();
            let momentum = (row.angular_balance_global() - first.angular_balance_global()).norm();
            worse(relative(energy.abs(), energy_scale), relative(momentum, momentum_scale))
        })
    }

    /// The largest distance from the torque-free motion in closed form: of the attitude in rad, and of the angular
    /// velocity relative to its size.
    pub fn off_closed_form(&self, method: Method) -> TrialOutcome {
        let exact = Inertia::new(self.body.inertia).map_err(|e| e.to_string()).and_then(|i| {
            TorqueFreeMotion::new(&i, Attitude::identity(), self.initial.omega).map_err(|e| e.to_string())
        });
        let exact = match exact {
            Ok(exact) => exact,
            Err(refusal) => return TrialOutcome::Refused(refusal),
        };
        self.largest(method, |_, row| {
            let Ok(now) = exact.at(row.time) else { return f64::NAN };
            let spin = (row.omega_body - now.omega_body).norm() / self.initial.omega.norm();
            worse(worse(row.attitude.angle_to(&now.attitude), spin), unorthonormality(&row.attitude))
        })
    }
}

/// The larger of two errors; NaN where one of them is.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// Zero of zero.
fn relative(difference: f64, scale: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / scale }
}

/// Energy less that of the centre's motion.
fn internal_energy(row: &Observation) -> f64 {
    row.energy() - 0.5 * row.linear_momentum_global.dot(&row.velocity_global)
}

/// Largest entry of A Aᵀ − I.
fn unorthonormality(attitude: &Attitude) -> f64 {
    let a = attitude.global_to_body();
    (a * a.transpose() - nalgebra::Matrix3::identity()).amax()
}
