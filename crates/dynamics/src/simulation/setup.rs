//! Everything that a run begins with: the body and what acts on it, the method, and how long its steps are.

use std::fmt;

use keys::Key;
use reduced_body::ReducedBody;

use crate::body::initial::Initial;
use crate::body::model::check_model;
use crate::body::physics::{DrivenMotion, Physics};
use crate::body::shapes::PointShapes;
use crate::conservative::ConservativeBody;
use crate::equations::Equations;
use crate::error::SetupError;
use crate::history::{History, positive};
use crate::load::SharedLoad;
use crate::motion::Motion;
use crate::scheme::abilities::Abilities;
use crate::scheme::mode_limit::check_step_of_modes;
use crate::simulation::account;
use crate::simulation::plan::{Rows, StepControl};
use crate::system::collocation::{STAGES, SystemScheme};

/// Everything that a run needs.
#[derive(Debug, Clone)]
pub struct Setup<'a> {
    /// The body.
    pub body: &'a ReducedBody,
    /// One damping ratio for each flexible mode.
    pub damping_ratios: &'a [f64],
    /// The loads.
    pub loads: &'a [SharedLoad],
    /// Effects, drives and stress.
    pub physics: &'a Physics,
    /// How it begins.
    pub initial: &'a Initial,
    /// How it is stepped.
    pub method: &'a dyn Begin,
    /// How long the steps are.
    pub control: StepControl,
    /// When it ends.
    pub end: f64,
    /// When it is observed.
    pub rows: Rows,
    /// Points whose motion is observed.
    pub points: &'a [PointShapes],
}

/// Limit of the step of a scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum StepLimit {
    /// The fastest mode, at about 2.83/ω_max.
    Modes,
    /// The spin: the largest angle in rad that the body may turn through in a step.
    Turn(f64),
}

/// Beginning of a motion for a [`Setup`]: a [`Method`], or one with data of its own.
pub trait Begin: fmt::Debug + Send + Sync {
    /// Its name and what it can do.
    fn method(&self) -> Method;

    /// Begins a motion.
    ///
    /// # Errors
    /// [`SetupError`].
    fn begin(&self, setup: &Setup) -> Result<Beginning, SetupError>;

    /// The key with its names, and with data of its own if it has any, by which a checkpoint knows it.
    fn key(&self, key: Key) -> Key {
        let Method { formulation, scheme, .. } = self.method();
        key.of("method", 1).with("formulation", formulation).with("scheme", scheme)
    }
}

/// A formulation with a scheme that a scene can name.
///
/// One of your own is a constant of this type: a [`Setup`] takes it like those of this crate.
#[derive(Clone, Copy)]
pub struct Method {
    /// The name of its formulation: "paper" or "conservative".
    pub formulation: &'static str,
    /// Its name.
    pub scheme: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// Evaluations of the rates that a step takes.
    pub evaluations_per_step: u32,
    /// Limit of its step.
    pub limit: StepLimit,
    /// True if it estimates the error of a step.
    pub estimates_error: bool,
    /// Abilities of its formulation.
    pub abilities: Abilities,
    /// Its scheme of bodies in joints; `None` of a method of bodies that nothing ties.
    pub joints: Option<SystemScheme>,
    /// Begins the motion of a body that nothing ties.
    pub begin: fn(&Setup) -> Result<Beginning, SetupError>,
}

/// A motion that begins.
#[derive(Debug)]
pub struct Beginning {
    /// The state and what steps it.
    pub motion: Box<dyn Motion>,
    /// Scale of the energy that the loads may give the body: [`Setup::energy_of_loads`].
    pub energy_of_loads: f64,
}

impl Setup<'_> {
    /// Refuses what the method cannot do.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        self.check_abilities()?;
        match self.control {
            StepControl::Fixed(step) => self.check_step(step),
            StepControl::Tolerance(_) if self.method.method().estimates_error => Ok(()),
            StepControl::Tolerance(_) => {
                let Method { formulation, scheme, .. } = self.method.method();
                Err(SetupError::NoErrorEstimate { formulation, scheme })
            }
        }
    }

    /// Refuses physics that the formulation does not have.
    fn check_abilities(&self) -> Result<(), SetupError> {
        if self.body.motion.is_free() && self.body.inertia == nalgebra::Matrix3::zeros() {
            return Err(SetupError::LonePoint);
        }
        let Method { formulation, abilities, .. } = self.method.method();
        let asked_for = [
            (self.physics.drive.is_some(), abilities.drives, "driven motion"),
            (self.physics.large_deflection.is_some(), abilities.large_deflection, "large deflection"),
        ];
        match asked_for.into_iter().find(|(is_there, is_able, _)| *is_there && !is_able) {
            Some((_, _, what)) => Err(SetupError::NotInFormulation { formulation, what }),
            None => Ok(()),
        }
    }

    /// Refuses times and tolerances that are not positive.
    pub(crate) fn check_times(&self) -> Result<(), SetupError> {
        positive("the end", self.end)?;
        match self.control {
            StepControl::Fixed(step) => positive("the step", step)?,
            StepControl::Tolerance(tolerance) => positive("the tolerance", tolerance)?,
        }
        match self.rows {
            Rows::EverySteps(0) => {
                let (what, expected) = ("the number of steps for a row", "1 or more");
                Err(SetupError::Value { what, found: 0.0, expected })
            }
            Rows::EverySteps(_) => Ok(()),
            Rows::Interval(interval) => positive("the interval of the rows", interval),
        }
    }

    /// Refuses a step beyond the limit of the method: that of the fastest mode, or that of the spin.
    fn check_step(&self, step: f64) -> Result<(), SetupError> {
        check_model(self.body, self.damping_ratios, self.loads)?;
        let StepLimit::Turn(longest_turn) = self.method.method().limit else {
            let frequencies = self.physics.with_highest(&self.body.circular_frequencies);
            return check_step_of_modes(&frequencies, self.damping_ratios, step);
        };
        positive("the step", step)?;
        let driven = self.physics.drive.as_ref().map_or(0.0, |drive| match drive.motion {
            DrivenMotion::Turn { .. } => drive.speed.largest(self.end).abs(),
            DrivenMotion::Slide { .. } => 0.0,
        });
        let spin = self.initial.omega.norm().max(driven);
        let limit = longest_turn / spin;
        if step <= limit { Ok(()) } else { Err(SetupError::StepBeyondSpin { step, limit, spin }) }
    }

    /// Scale of the energy that the loads may give the body, where it is needed: where steps do not resolve the fastest
    /// mode, and for formulas, which may rise from nothing within a step.
    ///
    /// # Errors
    /// [`SetupError`] where the body has no conservative form.
    pub fn energy_of_loads(&self) -> Result<f64, SetupError> {
        if self.method.method().is_limited_by_modes() && !self.has_formula() {
            return Ok(0.0);
        }
        let body = ConservativeBody::new(self.body, self.damping_ratios, self.loads.to_vec(), self.physics)?;
        let is_needed = self.may_miss_work(body.fastest_rate());
        Ok(if is_needed { body.sizes_of_loads(self.end).energy } else { 0.0 })
    }

    /// The energy that the forces of a bent reference set free where nothing balances them: Σ g²/λ.
    pub(crate) fn energy_of_reference(&self) -> f64 {
        let forces = self.physics.reference.iter().flat_map(|reference| &reference.force);
        forces.zip(&self.body.circular_frequencies).map(|(g, omega)| (g / omega).powi(2)).sum()
    }

    /// True if steps may be blind to work of the loads: they do not resolve a mode of this rate, the largest of ω_k and
    /// 2 ζ_k ω_k, or a formula rises from nothing within one.
    pub(crate) fn may_miss_work(&self, fastest_rate: f64) -> bool {
        let is_resolved = match self.control {
            StepControl::Fixed(step) => account::is_resolved(fastest_rate, step),
            StepControl::Tolerance(_) => false,
        };
        !is_resolved || self.has_formula()
    }

    fn has_formula(&self) -> bool {
        self.loads.iter().filter_map(|load| load.history()).any(History::has_formula)
    }
}

impl Begin for Method {
    fn method(&self) -> Method {
        *self
    }

    fn begin(&self, setup: &Setup) -> Result<Beginning, SetupError> {
        (self.begin)(setup)
    }
}

impl Method {
    /// True if its step is limited by the fastest mode; otherwise by the spin.
    pub fn is_limited_by_modes(&self) -> bool {
        self.limit == StepLimit::Modes
    }

    /// All methods of bodies that joints, springs or bushings tie together.
    pub const OF_JOINTS: [Self; 3] = [
        Self::of_joints(SystemScheme::Radau),
        Self::of_joints(SystemScheme::Gauss),
        Self::of_joints(SystemScheme::Rkmk4),
    ];

    /// The conservative form of bodies in joints by a scheme. Beside them, bodies that nothing ties move by [`Self::without_joints`].
    pub const fn of_joints(scheme: SystemScheme) -> Self {
        let (limit, evaluations_per_step) = match scheme {
            SystemScheme::Rkmk4 => (StepLimit::Modes, 4),
            SystemScheme::Radau | SystemScheme::Gauss => (Self::EXPONENTIAL.limit, STAGES as u32),
        };
        let (order, joints) = (scheme.order(), Some(scheme));
        Self { scheme: scheme.name(), order, limit, evaluations_per_step, joints, begin: refuse, ..Self::EXPONENTIAL }
    }

    /// The method of a body that nothing ties: of one of bodies in joints the default.
    #[must_use]
    pub fn without_joints(&self) -> &Self {
        if self.joints.is_some() { &Self::EXPONENTIAL } else { self }
    }
}

fn refuse(setup: &Setup) -> Result<Beginning, SetupError> {
    Err(SetupError::OfJoints { scheme: setup.method.method().scheme })
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        let of = |method: &Self| (method.formulation, method.scheme, method.joints);
        of(self) == of(other)
    }
}

impl Eq for Method {}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.formulation, self.scheme)
    }
}
