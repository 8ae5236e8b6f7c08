//! A scene with its models, ready to be run by any method.

use dynamics::{Method, Rows, Run, SetupError, StepControl};
use model::{Model, StartError};
use scene::{Body, Scene};

use super::run::Scales;
use crate::commands::run::{RunBody, RunFailure};
use crate::motion::{BeginError, StartSettings, begin};

/// Times at which runs are compared; runs with longer steps are compared at a divisor of this.
const COMPARED: u64 = 100;

/// A scene with a model of each body.
pub(super) struct PreparedScene<'a> {
    system: Scene,
    models: Vec<&'a Model>,
    scales: Vec<Scales>,
}

impl<'a> PreparedScene<'a> {
    pub(super) fn new(scene: Scene, models: Vec<&'a Model>) -> Self {
        let bodies = scene.bodies.iter().zip(&models);
        let scales = bodies.map(|(body, model)| Scales::of_body(model, body.time.end)).collect();
        Self { system: scene, models, scales }
    }

    /// One body.
    pub(super) fn alone(body: &Body, model: &'a Model) -> Self {
        Self::new(body.clone().into(), vec![model])
    }

    /// The bodies.
    pub(super) fn bodies(&self) -> impl Iterator<Item = RunBody<'_>> {
        self.system.bodies.iter().zip(&self.models).map(|(body, model)| RunBody { body, model })
    }

    pub(super) fn end(&self) -> f64 {
        self.system.time.end
    }

    /// Sizes of each body below which a quantity does not move.
    pub(super) fn scales(&self) -> &[Scales] {
        &self.scales
    }

    /// The run from its start, with rows at the times of comparison.
    pub(super) fn begin(&self, method: Method, control: StepControl) -> Result<Run, RunFailure> {
        Ok(self.try_begin(method, control)?)
    }

    fn try_begin(&self, method: Method, control: StepControl) -> Result<Run, BeginError> {
        let rows = Rows::Interval(self.end() / self.intervals(control) as f64);
        let beginning = StartSettings::of(&self.system, &self.models);
        begin(&self.system, &self.models, &StartSettings { method, control, rows, ..beginning })
    }

    /// Equal parts of the run at whose ends it is compared: the most that leave the steps as long as asked.
    fn intervals(&self, control: StepControl) -> u64 {
        match control {
            StepControl::Tolerance(_) => COMPARED,
            StepControl::Fixed(step) => (1..=COMPARED)
                .filter(|count| COMPARED.is_multiple_of(*count))
                .filter(|count| *count as f64 * step <= self.end() * (1.0 + 1e-9))
                .max()
                .unwrap_or(1),
        }
    }

    /// The longest fixed step that a method allows for all bodies, at most the whole run.
    pub(super) fn longest_step(&self, method: Method) -> f64 {
        let mut longest = self.end();
        // Each body has a limit of its own, and the first that is met is told.
        for _ in &self.models {
            match self.try_begin(method, StepControl::Fixed(longest)) {
                Err(BeginError::Start { source, .. }) => match *source {
                    StartError::Setup(
                        SetupError::StepBeyondLimit { limit, .. }
                        | SetupError::StepBeyondBody { limit, .. }
                        | SetupError::StepBeyondSpin { limit, .. },
                    ) if limit < longest => longest = limit,
                    _ => break,
                },
                _ => break,
            }
        }
        longest
    }
}
