//! The beginning of a run of bodies with joints: its settings, and how the joints are closed.

use nalgebra::Vector3;

use crate::body::motion_state::MotionState;
use crate::body::shapes::PointShapes;
use crate::conservative::ConservativeBody;
use crate::error::{RateError, SetupError};
use crate::history::positive;
use crate::scheme::mode_limit::stable_step_of_modes;
use crate::simulation::plan::{Rows, StepControl};
use crate::system::collocation::SystemScheme;
use crate::system::description::System;
use crate::system::frame::GAP;
use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::equation::{Misfit, misfit};
use crate::system::joint::row::Row;
use crate::system::radau::SystemMotion;
use crate::system::relaxed::RelaxError;
use crate::system::run::second_order::Branching;
use crate::system::stage::{OF_PLACES, vector};
use crate::vibration::system::configuration::Configuration;
use crate::vibration::system::{CommonSpin, Stability};

/// Residuals of positions beyond this part of the size of the system are not closed.
const CLOSED: f64 = 1e-9;

/// Where bodies in joints begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Start {
    /// As they are placed.
    #[default]
    AsPlaced,
    /// As they are placed, deformed as the forces of their motion and their joints ask, so that nothing rings.
    Relaxed,
    /// Where the forces on them balance, down the energy from where they are placed.
    Equilibrium,
}

impl Start {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsPlaced => "as placed",
            Self::Relaxed => "relaxed",
            Self::Equilibrium => "equilibrium",
        }
    }
}

/// Everything that a run of bodies with joints needs.
#[derive(Debug, Clone)]
pub struct SystemSetup {
    /// The bodies and the joints.
    pub system: System,
    /// The motion of each body at the beginning, as far as the joints let it be.
    pub states: Vec<MotionState>,
    /// Where they begin.
    pub start: Start,
    /// How it is stepped.
    pub scheme: SystemScheme,
    /// How long the steps are. A tolerance bounds the sum of the errors of all steps, as it does of a body alone.
    pub control: StepControl,
    /// When it ends.
    pub end: f64,
    /// When it is observed.
    pub rows: Rows,
    /// Points of each body whose motion is observed.
    pub points: Vec<Vec<PointShapes>>,
}

/// Change of a body by which the joints close at the beginning.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Assembled {
    /// Distance that its origin was moved by.
    pub moved: f64,
    /// Angle that it was turned by, rad.
    pub turned: f64,
    /// Change of the velocity of its origin.
    pub velocity: f64,
    /// Change of its angular velocity.
    pub angular_velocity: f64,
}

impl SystemSetup {
    /// Refuses times and steps that are out of range.
    pub(super) fn check(&self) -> Result<(), SetupError> {
        positive("the end", self.end)?;
        match self.control {
            StepControl::Fixed(step) => {
                positive("the step", step)?;
                if let Some(ShapeLimit { body, frequency, limit }) = self.shape_limit().filter(|of| of.limit < step) {
                    let body = self.system.named(body);
                    return Err(SetupError::StepBeyondBody { step, limit, body, frequency });
                }
            }
            StepControl::Tolerance(tolerance) => positive("the tolerance", tolerance)?,
        }
        match self.rows {
            Rows::EverySteps(_) => Ok(()),
            Rows::Interval(interval) => positive("the interval of the rows", interval),
        }
    }

    /// The limit that shapes set for the steps, if the scheme is one that they limit.
    pub(super) fn shape_limit(&self) -> Option<ShapeLimit> {
        if !self.scheme.is_limited_by_modes() {
            return None;
        }
        let of_body = |(body, of): (usize, &ConservativeBody)| {
            let (mode, limit) = stable_step_of_modes(&of.with_highest, &of.damping_ratios);
            let omega = of.with_highest.get(mode)?;
            Some(ShapeLimit { body, frequency: omega / std::f64::consts::TAU, limit })
        };
        let limits = self.system.bodies().iter().enumerate().filter_map(of_body);
        limits.min_by(|a, b| a.limit.total_cmp(&b.limit))
    }
}

/// The longest step of an explicit scheme in which no shape of a body grows. Joints do not make shapes faster; stiff springs and
/// bushings do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeLimit {
    /// The body with the fastest shape, by its number in the system.
    pub body: usize,
    /// Frequency of that shape, cycles per time.
    pub frequency: f64,
    /// The longest step.
    pub limit: f64,
}

/// Largest distance of bodies from the first, or the largest radius of gyration.
pub(super) fn size(motion: &SystemMotion, states: &[MotionState]) -> f64 {
    let system = motion.system();
    let first = states.first().map_or_else(Vector3::zeros, |state| state.origin_global);
    let spread = states.iter().map(|state| (state.origin_global - first).norm());
    let size = spread.chain(system.radii.iter().copied()).fold(0.0, f64::max);
    // One point mass.
    if size > 0.0 { size } else { motion.size() }
}

/// Part of the velocities that does not fit joints, over the rounding of places on the ground as a part of the size.
const OF_ROUNDING: f64 = 100.0;
/// Gap of a joint, over what places of the ground may be off by in binary numbers, that decimal numbers with a few digits less may make.
const OPEN_BY_ROUNDING: f64 = 1e4;

/// The error of joints that stay open; where that may be rounding of places of the ground far from the origin, it says so.
fn not_assembled(motion: &SystemMotion, joint: Box<str>, [left, rate]: [f64; 2]) -> SetupError {
    let rounding = motion.system().rounding;
    if left < OPEN_BY_ROUNDING * rounding {
        return SetupError::TooFar { joint, left, distance: rounding / (GAP * f64::EPSILON), rounding };
    }
    SetupError::NotAssembled { joint, left, rate }
}

/// Where bodies in joints have been put.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    /// The change of each body.
    pub changes: Vec<Assembled>,
    pub branching: Option<Branching>,
    /// The stability of the equilibrium that they begin at.
    pub stability: Option<Stability>,
}

/// Moves the bodies so that the joints close, and finds by how much; and the branches of the motion, if there are two.
pub(super) fn assemble(
    motion: &mut SystemMotion,
    states: &[MotionState],
    start: Start,
    [size, end]: [f64; 2],
) -> Result<Placed, SetupError> {
    refuse_wrong_derivatives(motion)?;
    refuse_axes_of_points(motion.system())?;
    let open = motion.largest_gap().map_err(|_| SetupError::SINGULAR)?;
    let done = match start {
        Start::AsPlaced => motion.assemble().map(|left| (left, None)).map_err(RelaxError::from),
        Start::Relaxed => motion.relax().map(|left| (left, None)),
        Start::Equilibrium => motion.put_at_equilibrium().map(|(left, stability)| (left, Some(stability))),
    };
    let ([left, rates], stability) = match (done, open) {
        (Ok(done), _) => done,
        (Err(RelaxError::Rest(error)), _) => return Err(error.into()),
        (Err(RelaxError::NoEquilibrium(error)), _) => return Err(SetupError::NoEquilibrium(error)),
        (Err(RelaxError::Wound { joint, turn }), _) => return Err(SetupError::Wound { joint, turn }),
        // Bodies that are too far from where they have to be.
        (Err(_), Some((joint, [left, rate]))) => {
            return Err(not_assembled(motion, joint.into(), [left, rate]));
        }
        (Err(_), None) => return Err(SetupError::SINGULAR),
    };
    let fastest = states.iter().map(|state| state.velocity_global.norm() + size * state.omega_body.norm());
    let is_open = |left: f64, closed: f64| left.is_nan() || left > closed;
    // Places of the ground far away are known to rounding only; so is what velocities fit between them.
    let rounding = motion.system().rounding;
    let is_rounding =
        rounding > 0.0 && motion.largest_residual().is_ok_and(|part| part * size <= CLOSED * size + rounding);
    let of_rates = CLOSED.max(OF_ROUNDING * rounding / size) * (size / end + fastest.fold(0.0, f64::max));
    if is_open(left, CLOSED * size) && !is_rounding || is_open(rates, of_rates) {
        let open = motion.largest_gap().ok().flatten();
        let joint = open.map_or_else(Box::default, |(joint, _)| joint.into());
        return Err(not_assembled(motion, joint, [left, rates]));
    }
    refuse_turned_points(motion)?;
    let branching = motion.test_start()?;
    let changed = |(body, state): (usize, &MotionState)| {
        let now = motion.state(body).map_err(|_| SetupError::SINGULAR)?;
        Ok(Assembled {
            moved: (now.origin_global - state.origin_global).norm(),
            turned: now.attitude.angle_to(&state.attitude),
            velocity: (now.velocity_global - state.velocity_global).norm(),
            angular_velocity: (now.omega_body - state.omega_body).norm(),
        })
    };
    let changes = states.iter().enumerate().map(changed).collect::<Result<_, SetupError>>()?;
    Ok(Placed { changes, branching, stability })
}

/// Refuses equations from outside whose derivatives are not theirs.
fn refuse_wrong_derivatives(motion: &SystemMotion) -> Result<(), SetupError> {
    let system = motion.system();
    if system.joints().iter().all(|joint| joint.equations().next().is_none()) {
        return Ok(());
    }
    let at = Configuration::of(motion, &CommonSpin::REST);
    for joint in system.joints() {
        for (markers, equation) in joint.equations() {
            let length = markers.iter().map(|marker| system.length_at(marker)).fold(0.0, f64::max);
            let misfit = misfit(equation, at.places(markers).each_ref(), length);
            let (joint, named) = (joint.name.as_str().into(), format!("{equation:?}").into());
            match misfit {
                None => {}
                Some(Misfit::Nothing) => return Err(SetupError::NoDerivative { joint, equation: named }),
                Some(Misfit::Differs { name, stated: found, difference: expected }) => {
                    return Err(SetupError::NotItsDerivative { joint, equation: named, name, found, expected });
                }
            }
        }
    }
    Ok(())
}

/// Refuses rows and forces along axes that a point mass would have to carry.
fn refuse_axes_of_points(system: &System) -> Result<(), SetupError> {
    for joint in system.joints() {
        for (markers, rows) in joint.groups() {
            for (k, body) in markers.iter().enumerate().filter_map(|(k, marker)| Some((k, marker.body()?))) {
                // Three rows of a point need no axes.
                let along = rows.iter().filter(|row| matches!(row, Row::Point { of, .. } if *of == k)).count();
                let has_force = joint.forces().any(|(along, _)| along == Coordinate::Turn || k == 0);
                if system.bodies()[body].is_point() && (along % 3 != 0 || has_force) {
                    return Err(SetupError::PointTurned { body: system.named(body), by: named(&joint.name) });
                }
            }
        }
    }
    Ok(())
}

/// Refuses moments on point masses, of rows, loads and force elements, where the joints are closed.
fn refuse_turned_points(motion: &mut SystemMotion) -> Result<(), SetupError> {
    let is_point: Vec<bool> = motion.system().bodies().iter().map(ConservativeBody::is_point).collect();
    if !is_point.contains(&true) {
        return Ok(());
    }
    match motion.residuals() {
        Ok(_) => {}
        Err(RateError::PointTurned { body }) => {
            return Err(SetupError::PointTurned { body, by: "a load or a force element".into() });
        }
        Err(_) => return Err(SetupError::SINGULAR),
    }
    let size = motion.size();
    let names: Vec<&str> = motion.system().connections.names().collect();
    for (row, ends) in motion.first.constraints.ends.iter().enumerate() {
        for end in ends.iter().filter(|end| is_point[end.body]) {
            let [force, moment] = [0, 3].map(|part| vector(&end.entries, part).norm());
            if moment > OF_PLACES * size * force {
                let by = names.get(row).map_or_else(|| "a force element".into(), |name| named(name));
                return Err(SetupError::PointTurned { body: motion.system().named(end.body), by });
            }
        }
    }
    Ok(())
}

fn named(joint: &str) -> Box<str> {
    format!("the joint \"{joint}\"").into()
}
