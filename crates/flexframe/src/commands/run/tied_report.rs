//! The part of the report of `flexframe run` that is of bodies tied together.

use std::fmt;

use dynamics::{ErrorKinds, Joint, Marker, ShapeLimit, Simulation, Stability};
use serde::Serialize;

use crate::files::json;
use crate::report::{counted, quantity, rounded};

/// Changes of a body at the beginning below these parts of the size of the system and of its speeds are not told.
const TOLD: f64 = 1e-9;
/// Moves over the size of the system, and turns (rad), above which a place in the scene may be wrong.
const FAR: f64 = 0.1;

/// Rounding of places over the tolerance above which it is told, and the tolerance that fixed steps are taken to have.
const COARSE: f64 = 0.01;
const FIXED: f64 = 1e-6;
/// Part of the run above which friction that holds is told.
const HELD: f64 = 0.01;

/// Report of bodies that joints, springs or bushings tie together.
#[derive(Debug, Clone, Serialize)]
pub struct TiedReport {
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Bodies whose constraints are joints to the ground, since joints, springs or bushings hold them, too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub constrained: Vec<String>,
    /// Rows of the joints.
    pub rows: usize,
    /// Degrees of freedom that they leave rigid bodies at the beginning.
    pub rigid_dofs: usize,
    /// Joints with rows that others imply where bodies are rigid, and how many.
    pub redundant: Vec<(String, usize)>,
    /// The largest residual of all rows of joints and couplings at the ends of the steps, as a length over the size of the system.
    #[serde(serialize_with = "json::number")]
    pub largest_residual: f64,
    /// The first time at which the rounding of places of the ground far away decides how a linkage goes on.
    pub undecided_at: Option<f64>,
    /// Where it begins at an equilibrium: independent motions along which it is unstable, and those that nothing resists.
    pub equilibrium: Option<Stability>,
    /// Where the motion branches at the beginning: joints, with their rates on the branch that was taken and on the other.
    pub branches: Vec<(String, [f64; 2])>,
    /// Changes by which the joints closed at the beginning, of the bodies that were not where they had to be.
    pub assembled: Vec<AssembledReport>,
    /// The largest rounding of places of bodies, over the size of the largest.
    #[serde(serialize_with = "json::number")]
    pub rounding_of_places: f64,
    /// Tolerance of the steps; none of fixed ones.
    #[serde(skip)]
    tolerance: Option<f64>,
    /// Size of the system.
    #[serde(skip)]
    size: f64,
    /// Steps taken.
    pub steps: u64,
    /// The limit that the shapes of a body set for the steps of an explicit scheme, where steps came near to it.
    pub step_limit: Option<StepLimitReport>,
    /// Errors that set the lengths of the steps under a tolerance.
    pub step_errors: Option<StepErrorsReport>,
    /// Joints whose friction has held.
    pub held: Vec<HeldReport>,
    /// Joints with stops on flexible bodies.
    pub flexible_stops: Vec<String>,
}

/// Sums over the steps of the errors that they state, and the kind that set their lengths.
#[derive(Debug, Clone, Serialize)]
pub struct StepErrorsReport {
    /// The name of the kind; none where errors were far below the tolerance.
    pub ruled_by: Option<&'static str>,
    /// Sums of each kind: place over the size of the largest body, and attitude; deformation over its largest; velocities that nothing
    /// holds back over the largest speed; energy made or lost at laws over twice the largest. In the order of [`ErrorKinds::NAMES`].
    #[serde(serialize_with = "json::numbers")]
    pub sums: [f64; 4],
}

/// Friction that has held.
#[derive(Debug, Clone, Serialize)]
pub struct HeldReport {
    /// The joint.
    pub joint: String,
    /// Time for which it has held.
    #[serde(serialize_with = "json::number")]
    pub time: f64,
    /// Path by which it has crept in that time: rad, or a length.
    #[serde(serialize_with = "json::number")]
    pub path: f64,
}

/// The longest step that the fastest shape of a body allows.
#[derive(Debug, Clone, Serialize)]
pub struct StepLimitReport {
    /// The body.
    pub body: String,
    /// Frequency of the shape, cycles per time.
    #[serde(serialize_with = "json::number")]
    pub frequency: f64,
    /// The longest step.
    #[serde(serialize_with = "json::number")]
    pub limit: f64,
}

/// Change of a body at the beginning.
#[derive(Debug, Clone, Serialize)]
pub struct AssembledReport {
    /// The body.
    pub body: String,
    /// Distance by which it was moved.
    #[serde(serialize_with = "json::number")]
    pub moved: f64,
    /// Angle by which it was turned, rad.
    #[serde(serialize_with = "json::number")]
    pub turned: f64,
    /// Change of its velocity.
    #[serde(serialize_with = "json::number")]
    pub velocity: f64,
    /// Change of its angular velocity.
    #[serde(serialize_with = "json::number")]
    pub angular_velocity: f64,
}

impl TiedReport {
    /// The report of a run in progress; `None` without joints.
    pub(super) fn new(simulation: &Simulation, bodies: Vec<String>, constrained: Vec<String>) -> Option<Self> {
        let (run, motion) = (simulation.system()?, simulation.system_motion()?);
        let (system, size) = (motion.system(), run.size());
        let speed = size / simulation.end();
        let assembled = run.assembled().iter().zip(&bodies);
        let assembled = assembled.map(|(change, body)| AssembledReport {
            body: body.clone(),
            moved: change.moved,
            turned: change.turned,
            velocity: change.velocity,
            angular_velocity: change.angular_velocity,
        });
        let is_told = |of: &AssembledReport| {
            let AssembledReport { moved, turned, velocity, angular_velocity, .. } = *of;
            moved.max(turned * size) > TOLD * size || velocity.max(angular_velocity * size) > TOLD * speed
        };
        let held = motion.held().map(|(joint, [time, path])| HeldReport {
            joint: system.joints()[joint].name.clone(),
            time,
            path,
        });
        let is_flexible = |marker: &Marker| marker.body().is_some_and(|body| system.bodies()[body].flexible() > 0);
        let has_stops = |joint: &&Joint| {
            [&joint.turn_force, &joint.slide_force].into_iter().flatten().any(|force| force.stops.is_some())
        };
        let stops = system.joints().iter().filter(has_stops).filter(|joint| joint.markers.iter().any(is_flexible));
        Some(Self {
            held: held.filter(|of| of.time > HELD * simulation.end()).collect(),
            flexible_stops: stops.map(|joint| joint.name.clone()).collect(),
            joints: system.joints().iter().map(|joint| joint.name.clone()).collect(),
            constrained,
            rows: system.joints().iter().map(|joint| joint.row_count()).sum(),
            rigid_dofs: run.rigid_dofs(),
            redundant: run.redundant().to_vec(),
            largest_residual: run.largest_residual(),
            undecided_at: run.undecided_at(),
            equilibrium: run.stability(),
            branches: run.branching().map(|of| of.joints.clone()).unwrap_or_default(),
            assembled: assembled.filter(is_told).collect(),
            rounding_of_places: run.rounding_of_places(),
            tolerance: simulation.tolerance(),
            size,
            steps: simulation.stats().accepted,
            step_errors: simulation.stats().error.zip(simulation.tolerance()).map(|(stated, tolerance)| {
                let mut sums = [0.0; 4];
                sums.iter_mut().zip(stated.kinds.named()).for_each(|(sum, (_, of_kind))| *sum = of_kind);
                StepErrorsReport { ruled_by: stated.ruling(tolerance), sums }
            }),
            step_limit: run.met_shape_limit().map(|ShapeLimit { body, frequency, limit }| StepLimitReport {
                body: bodies[body].clone(),
                frequency,
                limit,
            }),
            bodies,
        })
    }
}

impl TiedReport {
    /// Warnings of bodies that were moved far, and of ways that rounding has chosen.
    pub(super) fn doubts(&self) -> impl Iterator<Item = String> {
        let is_far =
            |of: &&AssembledReport| self.equilibrium.is_none() && (of.moved > FAR * self.size || of.turned > FAR);
        self.assembled.iter().filter(is_far).map(|AssembledReport { body, moved, turned, .. }| {
            let [moved, turned] = [moved, turned].map(|x| quantity(rounded(*x, 4)));
            format!(
                "{body} does not begin where its scene has it, but moved by {moved} and turned by {turned} rad, since its joints do not \
                 close there: if this was not meant, a position, an attitude, a marker or the start of a drive is wrong"
            )
        }).chain(self.equilibrium.as_ref().filter(|of| of.unstable > 0).map(|of| {
            format!(
                "the equilibrium at the start is unstable along {}: the least disturbance leads away from it; `flexframe equilibrium` looks for \
                 others near by",
                counted(of.unstable, ["motion", "motions"])
            )
        })).chain(self.undecided_at.map(|time| {
            format!(
                "at time {} the linkage passes a singular position, nearer than its places on the ground are known so far from the origin: \
                 their rounding decides which way it goes on; put the origin of the scene near its bodies",
                quantity(rounded(time, 4))
            )
        }))
        .chain((self.rounding_of_places > COARSE * self.tolerance.unwrap_or(FIXED)).then(|| {
            format!(
                "bodies have come so far from where joints hold them to the ground that their places are rounded to {:.1e} of their size: \
                 velocities and reactions there have as few digits; hold them to a ground that is nearer",
                self.rounding_of_places
            )
        }))
    }
}

impl fmt::Display for TiedReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bodies, joints, rows, rigid_dofs, redundant, largest_residual, branches, assembled, .. } = self;
        let s = |count: usize| if count == 1 { "" } else { "s" };
        writeln!(
            f,
            "  joints   {} bod{} and {} joint{} with {rows} rows: {rigid_dofs} degree{} of freedom of rigid bodies",
            bodies.len(),
            if bodies.len() == 1 { "y" } else { "ies" },
            joints.len(),
            s(joints.len()),
            s(*rigid_dofs),
        )?;
        if !self.constrained.is_empty() {
            writeln!(
                f,
                "           constraints of {} are joints to the ground, for joints, springs or bushings hold the body, too: its modes and \
                 their damping are those of the free body",
                self.constrained.join(", ")
            )?;
        }
        if !redundant.is_empty() {
            let list: Vec<String> = redundant.iter().map(|(joint, rows)| format!("{joint} ({rows})")).collect();
            writeln!(
                f,
                "           others imply rows of {}: the reactions there are not determined by rigid bodies, but by how the \
                 bodies give",
                list.join(", ")
            )?;
        }
        if *largest_residual > TOLD {
            let residual = quantity(rounded(*largest_residual, 2));
            writeln!(
                f,
                "           joints were open by up to {residual} of the size of the system at the ends of steps"
            )?;
        }
        if !branches.is_empty() {
            let of = |which: usize| {
                let rates =
                    branches.iter().map(|(joint, rates)| format!("{joint} {}", quantity(rounded(rates[which], 4))));
                rates.collect::<Vec<_>>().join(", ")
            };
            writeln!(
                f,
                "  branches the motion can begin in two ways; it goes by the one that is nearest to the velocities in the scene, with \
                 the rates {}; the other has {}",
                of(0),
                of(1)
            )?;
        }
        for AssembledReport { body, moved, turned, velocity, angular_velocity } in assembled {
            let [moved, turned, velocity, angular_velocity] =
                [moved, turned, velocity, angular_velocity].map(|x| quantity(rounded(*x, 4)));
            let aim = if self.equilibrium.is_some() { "the forces balance" } else { "the joints hold" };
            writeln!(
                f,
                "  closed   {body} moved by {moved} and turned by {turned} rad, its velocity changed by {velocity} and \
                 its angular velocity by {angular_velocity} rad per time, so that {aim} at the start"
            )?;
        }
        if let Some(StepErrorsReport { ruled_by, sums }) = &self.step_errors {
            let kinds: Vec<String> =
                ErrorKinds::NAMES.iter().zip(sums).map(|(name, sum)| format!("{name} {sum:.1e}")).collect();
            let rule = match ruled_by {
                Some(name) => format!("set by the error of {name}"),
                None => "set by convergence, events and the length of the run: errors are far below the tolerance"
                    .to_owned(),
            };
            writeln!(f, "  lengths  of steps were {rule}; sums of errors: {}", kinds.join(", "))?;
        }
        for HeldReport { joint, time, path } in &self.held {
            let [time, path] = [time, path].map(|x| quantity(rounded(*x, 4)));
            writeln!(
                f,
                "  held     by friction of {joint} for {time}, in which it creeps by {path}; with a smaller `rate` it creeps less"
            )?;
        }
        if !self.flexible_stops.is_empty() {
            writeln!(
                f,
                "  stops    of {} act on a flexible body: an impact also gives energy to shapes beyond its modes, which are not there, so that it \
                 bounces off faster than the part",
                self.flexible_stops.join(", ")
            )?;
        }
        if let Some(StepLimitReport { body, frequency, limit }) = &self.step_limit {
            let [frequency, limit] = [frequency, limit].map(|x| quantity(rounded(*x, 4)));
            writeln!(
                f,
                "  steps    of `rkmk4` are at most {limit} long, which the fastest shape of {body} allows ({frequency} cycles per \
                 time); `radau` has no such limit"
            )?;
        }
        Ok(())
    }
}
