//! Excitation of the rigid motions and of each mode, in modal coordinates: with mass-normalised shapes, forces and motions
//! of all of them are on one scale.

use dynamics::{DrivenMotion, History, SharedLoad};
use nalgebra::{Matrix3, Vector3};

use crate::motion::case::Case;
use crate::motion::course::Course;
use crate::motion::source::Source;
use crate::motion::turning::{Histories, Turning};

/// How the body turns, bounded above.
#[derive(Debug, Clone)]
pub(crate) struct Spin {
    /// Largest |ω|.
    pub largest: f64,
    /// |ω| that is there without doubt: at the beginning, or driven.
    pub certain: f64,
    /// √(2 × energy of rotation): largest, and without doubt.
    pub momentum: f64,
    pub certain_momentum: f64,
    /// Largest |ω̇|.
    pub acceleration: f64,
    /// Directions of ω that are possible: I, aaᵀ, or zero.
    pub directions: Matrix3<f64>,
    /// Largest angle turned.
    pub turn: f64,
    /// True if ω is steady.
    pub steady: bool,
}

/// A deformation of a tenth of the length adds as much to the arms of the loads; beyond it [`crate::Review`] warns.
const ARMS: f64 = 1.1;
/// Angles that are tried before the loads are allowed all directions.
const TRIES: usize = 20;

impl Spin {
    /// Bounds that hold for the body with its undeformed inertia, and the loads in the directions they may come to have.
    pub(crate) fn new(case: &Case) -> (Self, Vec<Source>) {
        let body = case.body;
        let of = |load: &'_ SharedLoad| load.history().cloned().unwrap_or(History::Constant);
        let histories = case.loads.iter().map(of);
        let courses: Vec<Course> =
            histories.map(|history| Course::new(&history, case.end, case.costly_histories())).collect();
        if let Some(drive) = case.drive {
            let course = Course::new(&drive.speed.history, case.end, case.costly_histories());
            let (axis, speed) = match drive.motion {
                DrivenMotion::Turn { axis } => (axis, drive.speed.amplitude.abs() * course.largest),
                DrivenMotion::Slide { .. } => (Vector3::zeros(), 0.0),
            };
            let momentum = speed * axis.dot(&(body.inertia * axis)).max(0.0).sqrt();
            let turn = drive.speed.amplitude.abs() * course.magnitude_integral * axis.norm();
            let acceleration = drive.speed.amplitude.abs() * course.steepest() * axis.norm();
            let spin = Self {
                largest: speed,
                certain: speed,
                momentum,
                certain_momentum: momentum,
                acceleration,
                directions: axis * axis.transpose(),
                turn,
                steady: acceleration == 0.0,
            };
            return (spin, Source::all(case, &courses, turn));
        }
        let basis = body.rotation_basis;
        let initial = (basis.transpose() * body.inertia * case.initial.omega).norm();
        let largest_of = |momentum: f64| basis.singular_values().max() * momentum;
        let histories = Histories::new(case);
        let met = |turn: f64| {
            let sources = Source::all(case, &courses, turn);
            let turning = Turning::new(&sources, &histories, turn);
            (sources, turning, initial + ARMS * turning.impulse)
        };
        // As long as the body has turned by no more than `turn`, its spin is bounded; where that spin turns it no
        // further to the end, it never gets there.
        let mut turn = 0.0;
        let (mut sources, mut turning, mut momentum) = met(turn);
        for _ in 0..TRIES {
            let reached = largest_of(momentum) * case.end;
            if reached <= turn {
                break;
            }
            turn = 1.05 * reached;
            (sources, turning, momentum) = met(turn);
        }
        if largest_of(momentum) * case.end > turn {
            (sources, turning, momentum) = met(f64::INFINITY);
        }
        let directions = body.motion.rotation_projector();
        let certain = (directions * case.initial.omega).norm();
        let torque_free = turning.impulse <= 1e-12 * initial;
        let omega = case.initial.omega;
        let about_principal =
            (body.inertia * omega).cross(&omega).norm() <= 1e-9 * omega.dot(&(body.inertia * omega)).abs();
        let steady = torque_free && (about_principal || body.motion.count() < 3);
        let largest = if steady {
            certain
        } else if torque_free && body.motion.count() >= 3 {
            polhode(&body.inertia, &omega).min(largest_of(momentum))
        } else {
            largest_of(momentum)
        };
        let tumbling = if steady || body.motion.count() < 3 { 0.0 } else { largest * largest };
        let caused = sources.iter().map(|s| s.rotation * s.impulse()).fold(0.0, f64::max).min(turning.impulse);
        let spin = Self {
            largest,
            certain,
            momentum,
            certain_momentum: initial.max(0.1 * caused),
            acceleration: largest_of(turning.force) + tumbling,
            directions: if steady && omega.norm() > 0.0 {
                let axis = omega.normalize();
                axis * axis.transpose()
            } else {
                directions
            },
            turn: largest * case.end,
            steady,
        };
        (spin, sources)
    }
}

impl Spin {
    /// Coriolis force 2Ω G q̇ and Euler force ω̇ G q of a unit of a mode at `omega`.
    pub(crate) fn pull(&self, gyroscopic: f64, omega: f64) -> f64 {
        gyroscopic * (2.0 * self.largest * omega + self.acceleration)
    }
}

/// Largest factor by which a small deformation raises the spin of a body that tumbles freely.
const DEFORMED: f64 = 1.05;

/// Largest |ω| of a free rigid body that begins at `omega`: its squares x_i along the principal axes keep Σ J_i x_i and
/// Σ J_i² x_i, so that the largest sum is at a corner, where one of them is zero.
fn polhode(inertia: &Matrix3<f64>, omega: &Vector3<f64>) -> f64 {
    let j = inertia.symmetric_eigenvalues();
    let energy = omega.dot(&(inertia * omega));
    let momentum = (inertia * omega).norm_squared();
    let mut largest = omega.norm_squared();
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let x_b = (momentum - j[a] * energy) / (j[b] * (j[b] - j[a]));
        let x_a = (energy - j[b] * x_b) / j[a];
        if x_a >= 0.0 && x_b >= 0.0 {
            largest = largest.max(x_a + x_b);
        }
    }
    DEFORMED * largest.sqrt()
}
