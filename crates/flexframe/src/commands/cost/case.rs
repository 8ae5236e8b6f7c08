//! A scene with its model, ready to be run in any way.

use dynamics::{Method, Rows, SetupError, Simulation, StepControl};
use model::{Model, StartError};
use scene::Scene;

use super::run::Scales;

/// Times at which runs are compared; runs with longer steps are compared at a divisor of this.
const COMPARED: u64 = 100;

/// A scene with its model.
pub(super) struct PreparedScene<'a> {
    scene: &'a Scene,
    model: &'a Model,
    scales: Scales,
}

impl<'a> PreparedScene<'a> {
    pub(super) fn new(scene: &'a Scene, model: &'a Model) -> Self {
        Self { scene, model, scales: Scales::of_body(model, scene.time.end) }
    }

    pub(super) fn end(&self) -> f64 {
        self.scene.time.end
    }

    /// Sizes below which a quantity does not move.
    pub(super) fn scales(&self) -> &Scales {
        &self.scales
    }

    /// The motion from its beginning, with rows at the times of comparison.
    pub(super) fn begin(&self, method: Method, control: StepControl) -> Result<Simulation, StartError> {
        let interval = self.end() / self.intervals(control) as f64;
        self.model.start_with(self.scene, method, control, Rows::Interval(interval))
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

    /// The longest fixed step that the method allows, at most the whole run.
    pub(super) fn longest_step(&self, method: Method) -> f64 {
        match self.begin(method, StepControl::Fixed(self.end())) {
            Err(StartError::Setup(
                SetupError::StepBeyondLimit { limit, .. } | SetupError::StepBeyondSpin { limit, .. },
            )) => limit,
            _ => self.end(),
        }
    }
}
