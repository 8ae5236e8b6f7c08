//! The beginning of the motions of a scene, as the scene has it or otherwise.

use std::sync::Arc;

use diagnostic::{Diagnosis, Diagnostic};
use dynamics::{
    Coordinate, DescribedBody, ForceElement, Island, JointEquation, JointLaw, MarkerForce, MarkerLaw, Method, Physics,
    PointShapes, RowTimes, Rows, Run, RunDescription, Setup, SetupError, SharedLoad, Simulation, Start, StepControl,
};
use model::{BuildError, Model, StartError, Tied, physics_in_system, tie_models};
use scene::{Body, End, Scene};

/// Forces on a body, and the damping and effects that they call for.
#[derive(Debug, Clone)]
pub struct BodyForces {
    /// All its loads.
    pub loads: Vec<SharedLoad>,
    /// Damping ratio of each mode.
    pub damping_ratios: Vec<f64>,
    /// Effects, gravity, drive.
    pub physics: Physics,
}

/// A law for the force along a coordinate of a joint, by the number of the joint in the scene.
#[derive(Debug, Clone)]
pub struct JointForces {
    /// The joint.
    pub joint: usize,
    /// Its turn or its slide.
    pub along: Coordinate,
    /// The law.
    pub law: Arc<dyn JointLaw>,
}

/// A law for the force and the moment between two markers, by their ends in the scene.
#[derive(Debug, Clone)]
pub struct MarkerForces {
    /// Its name.
    pub name: String,
    /// The ends.
    pub between: [End; 2],
    /// The law.
    pub law: Arc<dyn MarkerLaw>,
}

/// An equation from outside at a joint, by the number of the joint in the scene.
#[derive(Debug, Clone)]
pub struct OwnEquation {
    /// The joint.
    pub joint: usize,
    /// The equation.
    pub equation: Arc<dyn JointEquation>,
}

/// How the motions of a scene begin: at first as the scene says.
#[derive(Debug, Clone)]
pub struct StartSettings {
    /// Formulation and scheme. Tied bodies move by its scheme of joints, where it has one, else by the default; bodies that nothing ties by
    /// [`Method::without_joints`].
    pub method: Method,
    /// Steps.
    pub control: StepControl,
    /// Time of the end.
    pub end: f64,
    /// Rows.
    pub rows: Rows,
    /// Forces on each body.
    pub bodies: Vec<BodyForces>,
    /// Laws from outside at joints.
    pub laws: Vec<JointForces>,
    /// Equations from outside at joints.
    pub equations: Vec<OwnEquation>,
    /// Laws from outside between markers.
    pub marker_laws: Vec<MarkerForces>,
    /// Where tied bodies begin.
    pub start: Start,
    /// True if all bodies are stepped as one system, also those that nothing ties; laws between markers want that, too.
    pub together: bool,
}

impl StartSettings {
    /// Beginning of a scene with a model of each body.
    pub fn of(scene: &Scene, models: &[&Model]) -> Self {
        let forces = |model: &&Model| BodyForces {
            loads: model.loads().to_vec(),
            damping_ratios: model.damping_ratios().to_vec(),
            physics: model.physics.clone(),
        };
        Self {
            method: scene.time.method,
            control: scene.time.control,
            end: scene.time.end,
            rows: scene.rows,
            bodies: models.iter().map(forces).collect(),
            laws: Vec::new(),
            equations: Vec::new(),
            marker_laws: Vec::new(),
            start: scene.start,
            together: false,
        }
    }

    /// Times of the rows of all bodies.
    pub fn row_times(&self) -> RowTimes {
        RowTimes::new(self.rows, self.control, self.end)
    }
}

/// The run of a scene: its islands are first bodies that nothing ties, then those that are tied. There is a model of each body.
///
/// # Errors
/// [`BuildError`], or the scene of a body whose motion cannot start, and why.
pub fn begin(scene: &Scene, models: &[&Model], beginning: &StartSettings) -> Result<Run, BeginError> {
    let mut islands = Vec::new();
    let tied = tied(scene, models, beginning)?;
    for (number, (body, model)) in scene.bodies.iter().zip(models).enumerate() {
        if tied.iter().all(|tied| !tied.bodies.contains(&number)) {
            let alone = alone(body, model, &beginning.bodies[number], beginning);
            let motion = alone.map_err(|source| BeginError::start(number, body, source))?;
            islands.push(Island { motion, bodies: vec![number], joints: Vec::new(), elements: Vec::new() });
        }
    }
    for tied in tied {
        islands.push(begin_island(scene, models, tied, beginning)?);
    }
    Ok(Run::new(islands, beginning.row_times()))
}

/// The islands of the tied bodies alone.
///
/// # Errors
/// As [`begin`].
pub(crate) fn begin_tied(
    scene: &Scene,
    models: &[&Model],
    beginning: &StartSettings,
) -> Result<Vec<Island>, BeginError> {
    let tied = tied(scene, models, beginning)?;
    tied.into_iter().map(|tied| begin_island(scene, models, tied, beginning)).collect()
}

fn begin_island(scene: &Scene, models: &[&Model], tied: Tied, beginning: &StartSettings) -> Result<Island, BeginError> {
    let (bodies, joints, elements) = (tied.bodies.clone(), tied.joints.clone(), elements_in_rows(scene, &tied));
    let motion = run_of_system(scene, models, tied, beginning).begin().map_err(StartError::from);
    let motion = motion.map_err(|source| {
        // At the body that is meant, where it is one.
        let number = bodies[source.body_of_system().unwrap_or(0)];
        BeginError::start(number, &scene.bodies[number], source)
    })?;
    Ok(Island { motion, bodies, joints, elements })
}

/// Numbers in rows of the springs and bushings of a system, in its order; laws from outside come after them.
fn elements_in_rows(scene: &Scene, tied: &Tied) -> Vec<usize> {
    let springs = scene.springs.iter().map(|spring| &spring.name);
    let names = springs.chain(scene.bushings.iter().map(|bushing| &bushing.name));
    let of_system = (scene.joints.len()..).zip(names).filter(|(_, name)| tied.elements.contains(name));
    of_system.map(|(number, _)| number).collect()
}

/// The systems of a scene, with the laws from outside.
///
/// # Errors
/// [`BuildError`], also for laws and equations at joints and markers that are not there.
pub(super) fn tied(scene: &Scene, models: &[&Model], beginning: &StartSettings) -> Result<Vec<Tied>, BuildError> {
    let StartSettings { laws, equations, marker_laws, together, .. } = beginning;
    let all = tie_models(scene, models, *together || !marker_laws.is_empty())?;
    let mut named = laws.iter().map(|law| law.joint).chain(equations.iter().map(|own| own.joint));
    if let Some(joint) = named.find(|joint| all.iter().all(|tied| !tied.joints.contains(joint))) {
        let what = "the number of the joint of a law or an equation";
        return Err(
            SetupError::Value { what, found: joint as f64, expected: "that of a joint of the scene, from 0" }.into()
        );
    }
    let with_laws = |mut tied: Tied| -> Result<Tied, BuildError> {
        for JointForces { joint, along, law } in laws {
            if let Some(here) = tied.joints.iter().position(|number| number == joint) {
                tied.system = tied.system.with_law(here, *along, Arc::clone(law))?;
            }
        }
        for OwnEquation { joint, equation } in equations {
            if let Some(here) = tied.joints.iter().position(|number| number == joint) {
                tied.system = tied.system.with_equation(here, Arc::clone(equation))?;
            }
        }
        let mut elements = tied.system.elements().to_vec();
        for MarkerForces { name, between, law } in marker_laws {
            let markers = tied.markers(scene, models, *between)?;
            elements.push(Arc::new(MarkerForce { markers, law: Arc::clone(law) }) as Arc<dyn ForceElement>);
            tied.elements.push(name.clone());
        }
        Ok(Tied { system: tied.system.with_elements(elements)?, ..tied })
    };
    all.into_iter().map(with_laws).collect()
}

/// Motions that cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// The system cannot be put together.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// A motion cannot start. `scene`: that of its first body.
    #[error("{}", source.in_scene(scene))]
    Start {
        /// Number of the body in the scene.
        body: usize,
        /// The scene file.
        scene: std::path::PathBuf,
        /// The reason.
        source: Box<StartError>,
    },
}

impl BeginError {
    fn start(body: usize, of: &Body, source: StartError) -> Self {
        Self::Start { body, scene: of.path.clone(), source: Box::new(source) }
    }

    /// At the key of the scene, where that names the step.
    #[must_use]
    pub fn at_key(self, of: &Scene) -> Self {
        match self {
            Self::Start { body, scene, source } => {
                Self::Start { body, scene, source: Box::new(source.at_key(&of.bodies[body])) }
            }
            Self::Build(_) => self,
        }
    }
}

fn points(model: &Model) -> Vec<PointShapes> {
    model.points.iter().map(|(_, point)| point.clone()).collect()
}

fn alone(body: &Body, model: &Model, forces: &BodyForces, of: &StartSettings) -> Result<Simulation, StartError> {
    StartError::refuse_tied(body)?;
    if let Some(refusal) = model.refusal.filter(|_| body.effects.refuse) {
        return Err(refusal.into());
    }
    let (initial, points, method) = (model.initial(body), points(model), of.method.without_joints());
    Ok(Simulation::new(&Setup {
        damping_ratios: &forces.damping_ratios,
        loads: &forces.loads,
        physics: &forces.physics,
        method: model.paper.or(method),
        control: of.control,
        end: of.end,
        rows: of.rows,
        points: &points,
        ..model.setup(body, &initial)
    })?)
}

/// A body with what acts on it.
fn described_body(body: &Body, model: &Model, forces: &BodyForces) -> DescribedBody {
    DescribedBody {
        name: body.name.as_deref().map(Into::into),
        body: model.body.clone(),
        damping_ratios: forces.damping_ratios.clone(),
        loads: forces.loads.clone(),
        physics: forces.physics.clone(),
        points: points(model),
    }
}

/// The run of a body that nothing ties, as data have it: all but the reference points of the paper's formulation.
pub(super) fn run_of_body(body: &Body, model: &Model, forces: &BodyForces, of: &StartSettings) -> RunDescription {
    RunDescription {
        bodies: vec![described_body(body, model, forces)],
        joints: Vec::new(),
        couplings: Vec::new(),
        elements: Vec::new(),
        states: vec![model.initial(body).state(&model.body)],
        start: Start::AsPlaced,
        method: *of.method.without_joints(),
        control: of.control,
        end: of.end,
        rows: of.rows,
    }
}

/// The run of tied bodies.
pub(super) fn run_of_system(scene: &Scene, models: &[&Model], tied: Tied, of: &StartSettings) -> RunDescription {
    RunDescription {
        bodies: {
            let described = |number: &usize| {
                let (body, forces) = (&scene.bodies[*number], &of.bodies[*number]);
                let physics = physics_in_system(body, &forces.physics);
                DescribedBody { physics, ..described_body(body, models[*number], forces) }
            };
            tied.bodies.iter().map(described).collect()
        },
        joints: tied.system.joints().to_vec(),
        couplings: tied.system.couplings().to_vec(),
        elements: tied.system.elements().to_vec(),
        states: tied.states,
        start: of.start,
        method: Method::of_joints(of.method.joints.unwrap_or_default()),
        control: of.control,
        end: of.end,
        rows: of.row_times().of_systems(),
    }
}

impl Diagnostic for BeginError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Build(error) => error.diagnosis(),
            Self::Start { scene, source, .. } => source.diagnosis().in_file(scene),
        }
    }
}
