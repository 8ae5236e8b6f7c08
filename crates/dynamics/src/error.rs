//! Errors of a motion that cannot start, or cannot go on.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use diagnostic::{Diagnosis, Diagnostic, Kind};

use crate::vibration::system::error::SteadyError;

/// A body of a system, as messages name it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BodyName {
    /// Its number in the system, from 0.
    pub number: usize,
    /// Its name, if it has one.
    pub name: Option<Box<str>>,
}

impl fmt::Display for BodyName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "the body \"{name}\""),
            None => write!(f, "body {} of the system", self.number + 1),
        }
    }
}

/// A motion that cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SetupError {
    /// A list with one number for each flexible mode has another length.
    #[error("{what} has {found} entries; expected one for each of the {expected} flexible modes")]
    Length { what: &'static str, expected: usize, found: usize },
    /// A number that is NaN or infinite, or outside its range.
    #[error("{what} is {found}; expected {expected}")]
    Value { what: &'static str, found: f64, expected: &'static str },
    /// A list that is too short or not as long as its partner.
    #[error("{what} has {found} entries; expected {expected}")]
    Entries { what: &'static str, found: usize, expected: String },
    /// Times that do not rise. `row`: from 1.
    #[error(
        "{what}: the time {found} in row {row} is not later than {previous} in the row before; the times of a table rise from row to row (a jump is two tables, each multiplied by a step)"
    )]
    NotRising { what: &'static str, row: usize, found: f64, previous: f64 },
    /// A text that is not an expression in t. `position`: in characters, from 1.
    #[error("the expression \"{text}\" at character {position}: {problem}; {help}")]
    Expression { text: Box<str>, position: usize, problem: Box<str>, help: Box<str> },
    /// An expression that is too long.
    #[error(
        "an expression of {found} bytes is longer than {most}; write it shorter, as a product of several, or as a table"
    )]
    LongExpression { found: usize, most: usize },
    /// A history that is not a number at some time.
    #[error(
        "the history is {found} at time {time}; an expression must be finite through the whole run: write it so that it is, or multiply it by what is zero there in a form without a division by zero"
    )]
    HistoryNotFinite { time: f64, found: f64 },
    /// A formula that changes within the shortest steps that are tried, between two discontinuities or the ends of the run.
    #[error(
        "the expression \"{text}\" changes too fast: between the times {from} and {to}, even steps of {shortest:.3e} do not see it as it is; write it as a sine or a sweep, or name the times between which it changes so fast as discontinuities"
    )]
    FormulaTooFast { text: String, from: f64, to: f64, shortest: f64 },
    /// A step at which RK4 amplifies a mode. `mode`: from 1.
    #[error(
        "a step of {step:e} is beyond the stability limit {limit:.4e} that flexible mode {mode} ({frequency:.6} cycles per time) sets for RK4; take a smaller step or fewer modes"
    )]
    StepBeyondLimit { step: f64, limit: f64, mode: usize, frequency: f64 },
    /// The same of a system of bodies.
    #[error(
        "a step of {step:e} is beyond the stability limit {limit:.4e} that the fastest shape of {body} ({frequency:.6} cycles per time) sets for the explicit scheme rkmk4; take a smaller step, or the scheme radau, which has no such limit"
    )]
    StepBeyondBody { step: f64, limit: f64, body: BodyName, frequency: f64 },
    /// A step that the spin is too fast for. `spin`: the largest known before the run, |ω| at the beginning or the
    /// driven speed, rad/time.
    #[error(
        "a step of {step:e} is too long for a spin of {spin:.6} rad per time, which this scheme follows up to a step of {limit:.3e}; take a smaller step"
    )]
    StepBeyondSpin { step: f64, limit: f64, spin: f64 },
    /// A tolerance for a method that does not estimate its error.
    #[error(
        "scheme {scheme} of formulation {formulation} has no error estimate for a tolerance; give a step, or take the scheme exponential or rkmk4 of the conservative formulation"
    )]
    NoErrorEstimate { formulation: &'static str, scheme: &'static str },
    /// A scheme of bodies in joints for a body that nothing ties.
    #[error(
        "the scheme {scheme} moves bodies in joints, and nothing ties this body; take the scheme exponential or rkmk4"
    )]
    OfJoints { scheme: &'static str },
    /// A drive of a body whose modes are not those of the driven part held still.
    #[error(
        "a drive moves a body whose modes are those of a clamped one; what holds this one leaves it {motion}: hold it altogether, or remove the drive"
    )]
    DriveOfFreeBody { motion: Box<reduced_body::RigidMotion> },
    /// Rigid motions that there are no equations for.
    #[error(
        "what holds the body leaves it {motion}; a run needs a body that is free, turns about a point (3 rotations) or an axis (1 rotation), slides along a line (1 translation), or is held altogether: let [[constraints]] hold more directions, or fewer (`flexframe modes` finds its modes as it is)"
    )]
    MotionLeft { motion: Box<reduced_body::RigidMotion> },
    /// Physics that the formulation does not have.
    #[error("the formulation {formulation} has no {what}; take the conservative one")]
    NotInFormulation { formulation: &'static str, what: &'static str },
    /// A point mass that something would turn.
    #[error(
        "{body} is a point mass, without moments of inertia, and {by} would turn it: give it an inertia, or let what acts on it act at its own point and hold none of its turns (a spherical joint, a spring, an equation between points)"
    )]
    PointTurned { body: BodyName, by: Box<str> },
    /// A body alone without moments of inertia.
    #[error(
        "a point mass, without moments of inertia, moves in a system of bodies that joints or springs tie: give it an inertia"
    )]
    LonePoint,
    /// Joints that cannot be closed.
    #[error(
        "the joints cannot be closed at the beginning: \"{joint}\" stays open by {left:.3e} and its rate by {rate:.3e}; put its bodies so that its markers meet, give velocities that the joints allow, or remove a joint that contradicts the others"
    )]
    NotAssembled { joint: Box<str>, left: f64, rate: f64 },
    /// Joints that cannot be closed between places of the ground so far from the origin that their numbers are too coarse.
    #[error(
        "the joints cannot be closed at the beginning: \"{joint}\" stays open by {left:.3e}; places of the ground are {distance:.3e} from the origin, where gaps of {rounding:.1e} are rounding: give them with all digits of 64-bit numbers, or put the origin of the scene near its bodies"
    )]
    TooFar { joint: Box<str>, left: f64, distance: f64, rounding: f64 },
    /// Joints that no motion fits, though they are closed and their rates are.
    #[error(
        "the joints contradict each other at the beginning: {joints} are closed there, but their accelerations do not fit each other by {acceleration:.3e} (length per time²), so the mechanism cannot move as it has to; free a direction of one of them, let a drive or a gear go, or put a bushing in place of one of these joints"
    )]
    Contradiction { joints: Box<str>, acceleration: f64 },
    /// An equation of a joint from outside whose derivatives are not its own.
    #[error(
        "at the beginning {name} of the equation {equation} of the joint \"{joint}\" is {found}, and differences of its residual give {expected}; let `by_position` and `by_turn` be the derivatives of `residual`, in the axes of the first marker"
    )]
    NotItsDerivative { joint: Box<str>, equation: Box<str>, name: &'static str, found: f64, expected: f64 },
    /// An equation of a joint from outside that holds nothing where it begins.
    #[error(
        "at the beginning all derivatives of the equation {equation} of the joint \"{joint}\" are zero, so that it holds nothing; write it with a residual that changes there: an equation for each direction in the place of a sum of squares"
    )]
    NoDerivative { joint: Box<str>, equation: Box<str> },
    /// Bodies that find no shape for a start without ringing.
    #[error("at the relaxed start: {0}; or take `relaxed = false`")]
    NotRelaxed(#[from] SteadyError),
    /// Bodies without an equilibrium to begin at.
    #[error("at the start: {0}")]
    NoEquilibrium(SteadyError),
    /// A joint of the equilibrium that is turned by more than half a turn, from which a run counts.
    #[error(
        "at the equilibrium the joint \"{joint}\" is turned by {turn:.4} rad, and a run begins within half a turn: place the bodies nearer, and \
         give its spring the rest as a preload"
    )]
    Wound { joint: Box<str>, turn: f64 },
    /// An error of a method or a load from outside.
    #[error(transparent)]
    Custom(#[from] CustomError),
    /// The reference points lie on a line.
    #[error(transparent)]
    CollinearPoints(#[from] rigid_kin::CollinearPoints),
    /// The inertia is not one of a rigid body.
    #[error(transparent)]
    Inertia(#[from] rigid_kin::InertiaError),
}

impl SetupError {
    /// A body that does not resist a motion.
    pub(crate) const SINGULAR: Self = Self::Value { what: "the inertia of a body", found: 0.0, expected: "above 0" };
}

/// Somebody else's error: of equations, schemes, methods and observers from outside. Two of them are equal if they are copies of
/// one.
#[derive(Debug, Clone)]
pub struct CustomError(Arc<dyn Error + Send + Sync>);

impl CustomError {
    /// Any error, or a text.
    pub fn new(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self(Arc::from(error.into()))
    }

    /// The error itself.
    pub fn get(&self) -> &(dyn Error + Send + Sync + 'static) {
        &*self.0
    }
}

impl fmt::Display for CustomError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Error for CustomError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}

impl PartialEq for CustomError {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A step that failed. The state before it is kept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum StepError {
    /// The body turns by more than a full turn within a step.
    #[error("at time {time}: the body turns by {angle:.3} rad within a step of {step:.3e}; take a step of at most {:.1e}", step / angle)]
    TurnTooLarge { time: f64, step: f64, angle: f64 },
    /// A point mass that a moment would turn.
    #[error(
        "at time {time}: a moment acts on {body}, a point mass without moments of inertia: give it an inertia, or let forces act at its own point"
    )]
    PointTurned { time: f64, body: BodyName },
    /// An energy that nothing accounts for. `energy`: without that of the motion of the origin; `step`: the longest so
    /// far.
    #[error(
        "at time {time}: the energy is {energy:.6e}, where the start, the loads and the damping account for {accounted:.6e}; a step of {step:.3e} is too long for this motion or its scheme: take a smaller step, or the scheme exponential of the conservative formulation"
    )]
    Energy { time: f64, energy: f64, accounted: f64, step: f64 },
    /// An attitude that may be any. `angle`: sum of the turns, rad; `step`: the longest so far.
    #[error(
        "at time {time}: the attitude is lost: angular momentum that neither the start nor the loads account for has turned the body by {angle:.3} rad; a step of {step:.3e} is too long for this motion or its scheme: take a smaller step, or the scheme exponential of the conservative formulation"
    )]
    Attitude { time: f64, angle: f64, step: f64 },
    /// No step is short enough for the tolerance.
    #[error(
        "at time {time}: even a step of {step:.3e} does not keep the error below the tolerance {tolerance:e}; allow a larger tolerance"
    )]
    Tolerance { time: f64, step: f64, tolerance: f64 },
    /// Newton's method does not converge in a fixed step.
    #[error(
        "at time {time}: the equations of a step of {step:.3e} could not be solved; take a smaller step, or `tolerance` instead of `step`; where a mechanism passes a singular position, no step may do"
    )]
    Newton { time: f64, step: f64 },
    /// Newton's method does not converge in a fixed step into stops. `contact`: how long the shortest touch lasts.
    #[error(
        "at time {time}: the equations of a step of {step:.3e} could not be solved, in which {joints} goes into its stops: a touch there lasts some {contact:.1e}, and a fixed step is to be at most a quarter of that; take a step of {:.1e}, `tolerance` instead of `step`, or softer stops", 0.25 * contact
    )]
    Stops { time: f64, step: f64, joints: Box<str>, contact: f64 },
    /// Joints that lock, and no step goes on.
    #[error(
        "at time {time}: the joints lock: {joints} hold each other, and no motion of the bodies satisfies them all; let the motion stop before it stretches its links there, put a spring or a bushing in place of one of these joints, or let a body bend"
    )]
    Locked { time: f64, joints: Box<str> },
    /// Rows of joints that contradict each other. `gap`: the largest residual, as a length.
    #[error(
        "at time {time}: {joints} contradict each other: their joints open by {gap:.3e}, and no place of the bodies near by closes them all, so the mechanism cannot move as it has to; free a direction of one of them, let a drive or a gear go, put a bushing in place of one of these joints, or let a body bend"
    )]
    Open { time: f64, joints: Box<str>, gap: f64 },
    /// Step control of a scheme that does not estimate its error.
    #[error("at time {time}: this scheme does not estimate its error; give it a step instead of a tolerance")]
    NoErrorEstimate { time: f64 },
    /// A time that is not inside the last step.
    #[error(
        "time {time} is not inside the last step, from {from} to {to}; ask for the steps to be kept before they are taken"
    )]
    OutsideLastStep { time: f64, from: f64, to: f64 },
    /// A law that tells its kinks by no number. `law`: with the place that it acts at.
    #[error(
        "at time {time}: the function by which {law} tells its kinks is not a number; let it give a number at every time, which passes through zero at a kink"
    )]
    Switch { time: f64, law: Box<str> },
    /// An event's function that gives no finite number.
    #[error(
        "at time {time}: the function of an event gives {found}; let it give a finite number at every time, which passes through zero at the event"
    )]
    EventFunction { time: f64, found: f64 },
    /// An error of equations, a scheme or an observer from outside.
    #[error("at time {time}: {error}")]
    Custom { time: f64, error: CustomError },
    /// A NaN or an overflow.
    #[error(
        "at time {time}: {what} is no longer a finite number; the motion has blown up: take a smaller step, and check loads and initial velocities"
    )]
    NotFinite { time: f64, what: &'static str },
    /// The same of a body of a system.
    #[error(
        "at time {time}: a quantity of the motion of {body} is no longer a finite number; the motion has blown up: take a smaller step, and check loads and initial velocities"
    )]
    BodyNotFinite { time: f64, body: BodyName },
}

/// Rates that cannot be evaluated, before it is known in which step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum RateError {
    /// The rotation vector left the domain of f⁻¹.
    Turn(rigid_kin::BeyondFullTurn),
    /// The inertia of the deformed body has no inverse.
    Inertia,
    /// A moment on a point mass.
    PointTurned {
        /// The body.
        body: BodyName,
    },
    /// A law that tells its kinks by NaN.
    Switch {
        /// The place that the law acts at.
        law: Box<str>,
    },
    /// An error of equations, a scheme or an observer from outside.
    Custom(CustomError),
}

impl RateError {
    /// The error of the step that began at `time`.
    pub fn in_step(self, time: f64, step: f64) -> StepError {
        match self {
            Self::Turn(rigid_kin::BeyondFullTurn { angle }) if angle.is_finite() => {
                StepError::TurnTooLarge { time, step, angle }
            }
            Self::Turn(_) => StepError::NotFinite { time, what: "the angular velocity" },
            Self::Inertia => StepError::NotFinite { time, what: "the inverse of the deformed inertia" },
            Self::PointTurned { body } => StepError::PointTurned { time, body },
            Self::Switch { law } => StepError::Switch { time, law },
            Self::Custom(error) => StepError::Custom { time, error },
        }
    }
}

impl Diagnostic for SetupError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::FormulaTooFast { .. }
            | Self::StepBeyondLimit { .. }
            | Self::StepBeyondBody { .. }
            | Self::StepBeyondSpin { .. }
            | Self::MotionLeft { .. }
            | Self::CollinearPoints(_)
            | Self::Inertia(_) => Kind::Refused.alone(),
            _ => Kind::Input.alone(),
        }
    }
}

impl Diagnostic for StepError {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Run.alone()
    }
}
