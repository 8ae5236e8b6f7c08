//! A run of a body, with what the tests vary, and how far its end is from that of another.

use dynamics::{
    Initial, Method, Observation, Physics, PointShapes, Rows, Setup, SetupError, SharedLoad, Simulation, StepControl,
};
use frames_rk4::Paper;
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::common::Specimen;

pub const RKMK4: Method = Method::RKMK4;
pub const EXPONENTIAL: Method = Method::EXPONENTIAL;

#[derive(Debug, Clone)]
pub struct Run<'a> {
    pub body: &'a ReducedBody,
    pub reference_points: [Vector3<f64>; 3],
    pub damping_ratio: f64,
    pub loads: Vec<SharedLoad>,
    pub initial: Initial,
    pub end: f64,
    pub points: Vec<PointShapes>,
}

impl<'a> Run<'a> {
    /// Free and undamped.
    pub fn free(specimen: &'a Specimen, initial: Initial, end: f64) -> Self {
        Self {
            body: &specimen.body,
            reference_points: specimen.reference_points_body(),
            damping_ratio: 0.0,
            loads: Vec::new(),
            initial,
            end,
            points: Vec::new(),
        }
    }

    pub fn try_start(&self, method: Method, control: StepControl, rows: Rows) -> Result<Simulation, SetupError> {
        Simulation::new(&Setup {
            body: self.body,
            damping_ratios: &vec![self.damping_ratio; self.body.flexible()],
            loads: &self.loads,
            initial: &self.initial,
            method: Paper { reference_points: self.reference_points }.or(&method),
            control,
            end: self.end,
            rows,
            points: &self.points,
            physics: &Physics::default(),
        })
    }

    pub fn start(&self, method: Method, control: StepControl, rows: Rows) -> Simulation {
        self.try_start(method, control, rows).unwrap()
    }

    /// The motion at the end, by steps of `step` or somewhat less.
    pub fn end(&self, method: Method, step: f64) -> Observation {
        self.start(method, StepControl::Fixed(step), Rows::Interval(self.end)).last().unwrap().unwrap()
    }

    /// The motion at the beginning.
    pub fn beginning(&self) -> Observation {
        self.start(EXPONENTIAL, StepControl::Fixed(1e-5), Rows::EverySteps(1)).observation().unwrap()
    }
}

pub fn energy(observation: &Observation) -> f64 {
    observation.kinetic_energy + observation.strain_energy
}

/// |a − b| / |b|
pub fn relative(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square = |x: f64| x * x;
    (a.iter().zip(b).map(|(a, b)| square(a - b)).sum::<f64>() / b.iter().map(|b| square(*b)).sum::<f64>()).sqrt()
}

/// Relative difference of two vectors.
pub fn relative_3(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    relative(a.as_slice(), b.as_slice())
}

/// Difference of two motions at a time: attitude in rad, modal displacements relative to their norm.
#[derive(Debug, Clone, Copy)]
pub struct Error {
    pub attitude: f64,
    pub modal: f64,
}

impl Error {
    pub fn between(found: &Observation, expected: &Observation) -> Self {
        assert_eq!(found.time, expected.time);
        Self {
            attitude: found.attitude.angle_to(&expected.attitude),
            modal: relative(&found.modal_displacement, &expected.modal_displacement),
        }
    }
}

/// Slope of log error over log step, by least squares.
pub fn fitted_order<const N: usize>(steps: [f64; N], errors: [f64; N]) -> f64 {
    let mean = |list: [f64; N]| list.iter().sum::<f64>() / N as f64;
    let (x, y) = (steps.map(f64::ln), errors.map(f64::ln));
    let (mean_x, mean_y) = (mean(x), mean(y));
    let products: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    products / x.iter().map(|x| (x - mean_x).powi(2)).sum::<f64>()
}
