//! The bodies of a scene with their models, ready to be run in any way.

use dynamics::{Method, Rows, SetupError, Simulation, StepControl};
use model::{Model, StartError};
use scene::Scene;

use super::run::Scales;
use crate::commands::run::RunBody;

/// Times at which runs are compared; runs with longer steps are compared at a divisor of this.
const COMPARED: u64 = 100;

/// Bodies with their models.
pub(super) struct PreparedScene<'a> {
    bodies: Vec<RunBody<'a>>,
    scales: Vec<Scales>,
}

impl<'a> PreparedScene<'a> {
    pub(super) fn new(bodies: Vec<RunBody<'a>>) -> Self {
        let scales = bodies.iter().map(|body| Scales::of_body(body.model, body.scene.time.end)).collect();
        Self { bodies, scales }
    }

    /// One body.
    pub(super) fn alone(scene: &'a Scene, model: &'a Model) -> Self {
        Self::new(vec![RunBody { scene, model }])
    }

    pub(super) fn end(&self) -> f64 {
        self.bodies.first().map_or(0.0, |body| body.scene.time.end)
    }

    /// Sizes of each body below which a quantity does not move.
    pub(super) fn scales(&self) -> &[Scales] {
        &self.scales
    }

    /// The motion of each body from its beginning, with rows at the times of comparison.
    pub(super) fn begin(&self, method: Method, control: StepControl) -> Result<Vec<Simulation>, StartError> {
        self.bodies.iter().map(|body| self.begin_body(body, method, control)).collect()
    }

    fn begin_body(&self, body: &RunBody<'_>, method: Method, control: StepControl) -> Result<Simulation, StartError> {
        let interval = self.end() / self.intervals(control) as f64;
        body.model.start_with(body.scene, method, control, Rows::Interval(interval))
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

    /// The longest fixed step that the method allows for all bodies, at most the whole run.
    pub(super) fn longest_step(&self, method: Method) -> f64 {
        let of_body = |body| match self.begin_body(body, method, StepControl::Fixed(self.end())) {
            Err(StartError::Setup(
                SetupError::StepBeyondLimit { limit, .. } | SetupError::StepBeyondSpin { limit, .. },
            )) => limit,
            _ => self.end(),
        };
        self.bodies.iter().map(of_body).fold(self.end(), f64::min)
    }
}
