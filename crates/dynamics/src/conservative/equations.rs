//! The conservative form as [`Equations`].

use std::sync::Arc;

use nalgebra::Matrix3;

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::body::ConservativeBody;
use crate::conservative::errors::ErrorSize;
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::first_modes;
use crate::equations::sizes::Sizes;
use crate::equations::{self, Equations, ErrorNorm, Glance, Oscillators};
use crate::error::{RateError, SetupError};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::state::{Layout, State};

impl equations::Evaluation for Evaluation {
    fn place(&self) -> &[f64] {
        &self.at.values
    }

    fn place_mut(&mut self) -> &mut [f64] {
        &mut self.at.values
    }

    fn rates(&self) -> &[f64] {
        &self.rates.values
    }

    fn rates_mut(&mut self) -> &mut [f64] {
        &mut self.rates.values
    }
}

impl Equations for ConservativeBody {
    type Evaluation = Evaluation;

    /// The transformation matrix of the attitude at the start of the step.
    type Frame = Matrix3<f64>;

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn evaluation(&self) -> Evaluation {
        self.room()
    }

    fn frame(&self, from: &State) -> Matrix3<f64> {
        self.list(from).attitude().global_to_body()
    }

    fn rates(&self, times: [f64; 2], frame: &Matrix3<f64>, e: &mut Evaluation) -> Result<(), RateError> {
        self.evaluate(times, frame, e)
    }

    fn add_linear(&self, e: &mut Evaluation) {
        self.add_oscillators(e);
    }

    fn observe(
        &self,
        state: &State,
        e: &mut Evaluation,
        points: &[PointShapes],
        out: &mut Observation,
    ) -> Result<(), RateError> {
        self.read_motion(state, points, e, out)
    }

    fn glance<'e>(&self, e: &'e Evaluation) -> Glance<'e> {
        Glance { omega_body: e.omega_body, modal_displacement: e.at.q(), modal_velocity: &e.modal_velocity }
    }

    fn energies(&self, time: f64, e: &Evaluation) -> Option<Energies> {
        self.energies_at(time, e)
    }

    fn work_and_dissipation(&self, state: &State) -> [f64; 2] {
        self.work_and_dissipation_of(state)
    }

    fn motion_state(&self, state: &State) -> Result<MotionState, RateError> {
        self.motion_of(state)
    }

    fn state_of(&self, motion: &MotionState) -> Result<State, SetupError> {
        self.state_from(motion)
    }

    /// The speed of a drive may jump.
    fn pass_discontinuity(&self, state: &mut State, e: &mut Evaluation) -> Result<(), RateError> {
        self.pass_jump(state, e)
    }

    fn acts_alike(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.drive.is_none() && self.loads.iter().all(|load| load.is_same(time, branch_times))
    }

    fn flexible(&self) -> usize {
        self.circular_frequencies.len()
    }

    fn fastest_rate(&self) -> f64 {
        self.fastest_rate
    }

    fn sizes_of_loads(&self, end: f64) -> Sizes {
        self.largest_by_loads(end)
    }

    fn error_norm(&self, end: f64) -> Arc<dyn ErrorNorm<Self>> {
        Arc::new(ErrorSize::new(self, end))
    }
}

impl Oscillators for ConservativeBody {
    fn circular_frequencies(&self) -> &[f64] {
        &self.circular_frequencies
    }

    fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    fn first_modes(&self) -> [usize; 2] {
        first_modes(self.circular_frequencies.len())
    }
}
