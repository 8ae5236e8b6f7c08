//! A run put together part by part.

use std::sync::Arc;

use reduced_body::ReducedBody;

use crate::body::initial::Initial;
use crate::body::physics::Physics;
use crate::body::shapes::PointShapes;
use crate::error::SetupError;
use crate::load::{Load, SharedLoad};
use crate::simulation::Simulation;
use crate::simulation::plan::{Rows, StepControl};
use crate::simulation::setup::{Begin, Method, Setup};

/// Puts a run together; what is not named is as [`Simulation::builder`] says.
///
/// ```
/// use dynamics::nalgebra::{Matrix3, Vector3};
/// use dynamics::{Initial, Simulation, StepControl};
/// use reduced_body::{ReducedBody, RigidMotion};
///
/// let body = ReducedBody::rigid(2.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free())?;
/// let spinning = Initial { omega: Vector3::new(0.0, 0.0, 3.0), ..Initial::at_rest(0) };
/// let simulation = Simulation::builder(&body, StepControl::Fixed(0.01), 1.0).initial(spinning).build()?;
/// let rows = simulation.collect::<Result<Vec<_>, _>>()?;
/// assert_eq!((rows[0].time, rows.len()), (0.0, 101));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SimulationBuilder<'a> {
    body: &'a ReducedBody,
    damping_ratios: Vec<f64>,
    loads: Vec<SharedLoad>,
    physics: Physics,
    initial: Initial,
    method: Arc<dyn Begin>,
    control: StepControl,
    end: f64,
    rows: Rows,
    points: Vec<PointShapes>,
}

impl Simulation {
    /// A run of a body from time 0 to `end`: undamped, without loads, with all effects, at rest at the start, by the
    /// exponential scheme, with a row after every step and no points.
    pub fn builder(body: &ReducedBody, control: StepControl, end: f64) -> SimulationBuilder<'_> {
        SimulationBuilder {
            body,
            damping_ratios: vec![0.0; body.flexible()],
            loads: Vec::new(),
            physics: Physics::default(),
            initial: Initial::at_rest(body.flexible()),
            method: Arc::new(Method::EXPONENTIAL),
            control,
            end,
            rows: Rows::EverySteps(1),
            points: Vec::new(),
        }
    }
}

impl SimulationBuilder<'_> {
    /// One damping ratio for all flexible modes.
    #[must_use]
    pub fn damping_ratio(mut self, ratio: f64) -> Self {
        self.damping_ratios.fill(ratio);
        self
    }

    /// One damping ratio for each flexible mode.
    #[must_use]
    pub fn damping_ratios(mut self, ratios: Vec<f64>) -> Self {
        self.damping_ratios = ratios;
        self
    }

    /// Adds a load.
    #[must_use]
    pub fn load(self, load: impl Load) -> Self {
        self.loads([Arc::new(load) as SharedLoad])
    }

    /// Adds loads.
    #[must_use]
    pub fn loads(mut self, loads: impl IntoIterator<Item = SharedLoad>) -> Self {
        self.loads.extend(loads);
        self
    }

    /// Effects, a drive with its geometric stiffness, and the manifold of large modes.
    #[must_use]
    pub fn physics(mut self, physics: Physics) -> Self {
        self.physics = physics;
        self
    }

    /// The motion at time 0.
    #[must_use]
    pub fn initial(mut self, initial: Initial) -> Self {
        self.initial = initial;
        self
    }

    /// The formulation and its scheme.
    #[must_use]
    pub fn method(mut self, method: impl Begin + 'static) -> Self {
        self.method = Arc::new(method);
        self
    }

    /// When the motion is observed.
    #[must_use]
    pub fn rows(mut self, rows: Rows) -> Self {
        self.rows = rows;
        self
    }

    /// Adds a point whose motion is observed.
    #[must_use]
    pub fn point(mut self, point: PointShapes) -> Self {
        self.points.push(point);
        self
    }

    /// Checks everything, and begins the run.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn build(&self) -> Result<Simulation, SetupError> {
        let Self { body, damping_ratios, loads, physics, initial, method, control, end, rows, points } = self;
        Simulation::new(&Setup {
            body,
            damping_ratios,
            loads,
            physics,
            initial,
            method: &**method,
            control: *control,
            end: *end,
            rows: *rows,
            points,
        })
    }
}
