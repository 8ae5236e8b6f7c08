//! Equations of motion: what a scheme integrates.

pub(crate) mod sizes;

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::equations::sizes::Sizes;
use crate::error::{RateError, SetupError};
use crate::observation::Observation;
use crate::observation::energies::Energies;
use crate::state::{Layout, State};

/// Equations of motion `y' = L y + N(t, y)` on one flat list of numbers, some of which are attitudes.
///
/// A step counts the turn of each attitude by a rotation vector, which starts at zero: [`Layout::turn`]. L may be zero; a
/// scheme that integrates it exactly asks for [`Oscillators`].
pub trait Equations: fmt::Debug + Clone + Send + Sync + 'static {
    /// Room for the rates at a place, and for what is found on the way to them.
    type Evaluation: Evaluation;

    /// Constants that all evaluations of a step share.
    type Frame: fmt::Debug + Copy;

    /// The order of the numbers.
    fn layout(&self) -> &Layout;

    /// Room for one evaluation.
    fn evaluation(&self) -> Self::Evaluation;

    /// The constants of a step from a state.
    fn frame(&self, from: &State) -> Self::Frame;

    /// Finds N at the place of `e` and the time `times[0]`, in a step with this frame. Laws with branches are taken as they
    /// are at the time `times[1]`.
    ///
    /// # Errors
    /// [`RateError`].
    fn rates(&self, times: [f64; 2], frame: &Self::Frame, e: &mut Self::Evaluation) -> Result<(), RateError>;

    /// Adds L y to the rates.
    fn add_linear(&self, e: &mut Self::Evaluation) {
        let _ = e;
    }

    /// Fills `out` with the motion at a state, and that of `points`; `e` has N there.
    ///
    /// # Errors
    /// [`RateError`].
    fn observe(
        &self,
        state: &State,
        e: &mut Self::Evaluation,
        points: &[PointShapes],
        out: &mut Observation,
    ) -> Result<(), RateError>;

    /// The motion at the place of an evaluation, as far as it is known without more work.
    fn glance<'e>(&self, e: &'e Self::Evaluation) -> Glance<'e>;

    /// Energies at the place of an evaluation and this time; `None` where they say nothing, as under a drive.
    fn energies(&self, time: f64, e: &Self::Evaluation) -> Option<Energies>;

    /// Work of the loads and energy that damping has taken, since the beginning.
    fn work_and_dissipation(&self, state: &State) -> [f64; 2];

    /// A state in quantities that every formulation has.
    ///
    /// # Errors
    /// [`RateError`] where the velocities cannot be found.
    fn motion_state(&self, state: &State) -> Result<MotionState, RateError>;

    /// The state of a motion; work and impulses are counted from it anew.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    fn state_of(&self, motion: &MotionState) -> Result<State, SetupError>;

    /// Takes a state past a discontinuity of what acts at its time; `e` is room.
    ///
    /// # Errors
    /// [`RateError`].
    fn pass_discontinuity(&self, state: &mut State, e: &mut Self::Evaluation) -> Result<(), RateError> {
        let _ = (state, e);
        Ok(())
    }

    /// True if what acts does the same at a time by the branches that hold at either of two branch times.
    fn acts_alike(&self, time: f64, branch_times: [f64; 2]) -> bool;

    /// Number of flexible modes.
    fn flexible(&self) -> usize;

    /// Largest of ω_k and 2 ζ_k ω_k.
    fn fastest_rate(&self) -> f64;

    /// Sizes of the motions that the loads would cause from rest until `end`.
    fn sizes_of_loads(&self, end: f64) -> Sizes {
        let _ = end;
        Sizes::default()
    }

    /// The measure of the errors of steps in a run until `end`.
    fn error_norm(&self, end: f64) -> Arc<dyn ErrorNorm<Self>> {
        let _ = end;
        Arc::new(PlainNorm)
    }
}

/// The rates at a place.
pub trait Evaluation: fmt::Debug + Clone + Send + Sync {
    /// The place, a list as in a [`State`], with attitudes as at the start of the step.
    fn place(&self) -> &[f64];

    /// The place.
    fn place_mut(&mut self) -> &mut [f64];

    /// The rates, in the same order; those of attitudes are zero.
    fn rates(&self) -> &[f64];

    /// The rates.
    fn rates_mut(&mut self) -> &mut [f64];
}

/// Equations whose linear part is that of damped oscillators: `q' = p + …, p' = −ω² q − 2 ζ ω p + …`.
pub trait Oscillators: Equations {
    /// ω_k.
    fn circular_frequencies(&self) -> &[f64];

    /// ζ_k.
    fn damping_ratios(&self) -> &[f64];

    /// First places of the q_k and of the p_k in the list; each begins at a multiple of four, and they are the last parts.
    fn first_modes(&self) -> [usize; 2];
}

/// The motion at a place, as far as its evaluation knows it.
#[derive(Debug, Clone, Copy)]
pub struct Glance<'a> {
    /// Angular velocity of the body frame, body components.
    pub omega_body: Vector3<f64>,
    /// Flexible modal displacements (nf).
    pub modal_displacement: &'a [f64],
    /// Flexible modal velocities (nf).
    pub modal_velocity: &'a [f64],
}

/// A measure of the errors of steps in one run, so that the errors of all steps add up to that at the end.
pub trait ErrorNorm<E: Equations>: fmt::Debug + Send + Sync {
    /// Sizes of the motion at a state, where `e` has the rates.
    fn motion(&self, equations: &E, state: &State, e: &E::Evaluation) -> Sizes;

    /// Sizes of the difference of two states at the end of a `step`, of which the first was reached by halves of it. An error
    /// of first order in time counts `gain` times, since all are divided by it.
    fn difference(&self, equations: &E, states: [&State; 2], step: f64, gain: f64) -> Sizes;

    /// Sizes of an error of a step that steps of half its length do not show.
    fn unseen(&self, equations: &E, step: f64, end: &StepDone<'_, E>) -> Sizes {
        let _ = (equations, step, end);
        Sizes::default()
    }

    /// Lowest ω_k; infinite without modes.
    fn lowest_frequency(&self, equations: &E) -> f64 {
        let _ = equations;
        f64::INFINITY
    }
}

/// The end of a step, and the rates some time before it.
#[derive(Debug)]
pub struct StepDone<'a, E: Equations> {
    /// The state at the end.
    pub state: &'a State,
    /// The rates there, without the linear part.
    pub e: &'a E::Evaluation,
    /// Rates before.
    pub before: &'a E::Evaluation,
    /// Time between the two.
    pub since: f64,
}

/// The root of the sum of all squares.
#[derive(Debug, Clone, Copy)]
pub struct PlainNorm;

impl<E: Equations> ErrorNorm<E> for PlainNorm {
    fn motion(&self, _: &E, state: &State, _: &E::Evaluation) -> Sizes {
        Sizes { displacement: state.values.iter().map(|x| x * x).sum(), ..Sizes::default() }
    }

    fn difference(&self, _: &E, [a, b]: [&State; 2], _: f64, _: f64) -> Sizes {
        let squares = a.values.iter().zip(&b.values).map(|(a, b)| (a - b) * (a - b));
        Sizes { displacement: squares.sum(), ..Sizes::default() }
    }
}
