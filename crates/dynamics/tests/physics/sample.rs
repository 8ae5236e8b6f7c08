//! A body of made-up constants, and runs of it.

use std::sync::Arc;

use dynamics::{
    History, Initial, Method, Observation, Physics, PointForce, PointShapes, Rows, Setup, SharedLoad, Simulation,
    StepControl,
};
use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, Constants, ReducedBody, RigidMotion};

pub const EXPONENTIAL: Method = Method::EXPONENTIAL;
pub const RKMK4: Method = Method::RKMK4;

/// A dead force.
pub fn dead_force(point: PointShapes, force: Vector3<f64>, history: History) -> SharedLoad {
    Arc::new(PointForce::dead(point, force, history))
}

pub const MASS: f64 = 1.5;

/// A number in (−1, 1) that looks random.
fn noise(seed: usize) -> f64 {
    (seed as f64 * 12.9898).sin() * 43758.5453 % 1.0
}

/// Rigid motions `motion`, flexible modes of the given circular frequencies.
pub fn body(motion: RigidMotion, circular_frequencies: &[f64]) -> ReducedBody {
    let nf = circular_frequencies.len();
    let inertia = Matrix3::new(2.0, 0.1, -0.2, 0.1, 3.0, 0.15, -0.2, 0.15, 4.0);
    let vectors = |seed: usize, size: f64| -> [Vec<f64>; 3] {
        std::array::from_fn(|i| (0..nf).map(|k| size * noise(seed + 10 * i + k)).collect())
    };
    let symmetric = |seed: usize| Mat::from_fn(nf, nf, |i, j| 0.3 * noise(seed + 7 * i.max(j) + 3 * i.min(j)));
    let skew =
        |seed: usize| Mat::from_fn(nf, nf, |i, j| 0.3 * (noise(seed + 5 * i + 11 * j) - noise(seed + 5 * j + 11 * i)));
    let held = !motion.is_free();
    let clamped = motion.count() == 0;
    let constants = Constants {
        mass: MASS,
        center_of_mass: if held { Vector3::new(0.4, -0.3, 0.5) } else { Vector3::zeros() },
        motion,
        origin: Vector3::zeros(),
        inertia,
        translation_basis: Matrix3::identity() / MASS.sqrt(),
        rotation_basis: inertia.cholesky().unwrap().l().transpose().try_inverse().unwrap(),
        circular_frequencies: circular_frequencies.to_vec(),
        natural_modes: nf,
        rotation_products: std::array::from_fn(|_| std::array::from_fn(|_| Mat::zeros(6 + nf, 6 + nf))),
        position_products: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; 6 + nf])),
        inertia_first: std::array::from_fn(|pair| (0..nf).map(|k| 0.2 * noise(100 + 13 * pair + k)).collect()),
        inertia_second: std::array::from_fn(|pair| symmetric(200 + 17 * pair)),
        gyroscopic: std::array::from_fn(|i| skew(300 + 19 * i)),
        translation_first: if held { vectors(400, 0.3) } else { vectors(400, 0.0) },
        rotation_first: if clamped { vectors(500, 0.3) } else { vectors(500, 0.0) },
        stress_stiffness: None,
    };
    ReducedBody::from_constants(constants).unwrap()
}

/// The body with other constants.
pub fn changed(body: ReducedBody, change: impl FnOnce(&mut Constants)) -> ReducedBody {
    let mut constants = (*body).clone();
    change(&mut constants);
    ReducedBody::from_constants(constants).unwrap()
}

/// A point of the body with made-up shapes.
pub fn point(body: &ReducedBody, at: [f64; 3]) -> PointShapes {
    let shapes = Mat::from_fn(3, body.flexible(), |i, k| 0.5 * noise(600 + 3 * k + i));
    PointShapes::new(body, &BodyPoint { position_body: at.into(), shapes })
}

/// A start with everything in motion.
pub fn start(flexible: usize) -> Initial {
    Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::new(0.3, -0.2, 0.5),
        omega: Vector3::new(1.0, -0.6, 0.8),
        modal_displacement: (0..flexible).map(|k| 0.2 * noise(700 + k)).collect(),
        modal_velocity: (0..flexible).map(|k| noise(800 + k)).collect(),
    }
}

pub struct Run<'a> {
    pub body: &'a ReducedBody,
    pub damping_ratio: f64,
    pub loads: Vec<SharedLoad>,
    pub physics: Physics,
    pub initial: Initial,
    pub end: f64,
}

impl<'a> Run<'a> {
    pub fn new(body: &'a ReducedBody, end: f64) -> Self {
        let initial = start(body.flexible());
        Self { body, damping_ratio: 0.0, loads: Vec::new(), physics: Physics::default(), initial, end }
    }

    pub fn start(&self, method: Method, control: StepControl, rows: Rows) -> Simulation {
        Simulation::new(&Setup {
            body: self.body,
            damping_ratios: &vec![self.damping_ratio; self.body.flexible()],
            loads: &self.loads,
            physics: &self.physics,
            initial: &self.initial,
            method: &method,
            control,
            end: self.end,
            rows,
            points: &[],
        })
        .unwrap()
    }

    /// Beginning and end.
    pub fn ends(&self, method: Method, step: f64) -> [Observation; 2] {
        let mut simulation = self.start(method, StepControl::Fixed(step), Rows::Interval(self.end));
        let first = simulation.observation().unwrap();
        [first, simulation.last().unwrap().unwrap()]
    }

    /// How far the balance of energy is off at the end, relative to the larger of the energies.
    pub fn energy_gap(&self, method: Method, step: f64) -> f64 {
        let [first, last] = self.ends(method, step);
        (last.energy_balance() - first.energy_balance()).abs() / first.energy().max(last.energy())
    }
}
