//! Data of a run that are known before it.

use diagnostic::{Diagnosis, Diagnostic, Kind};
use dynamics::{Drive, History, Initial, Manifold, SharedLoad};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::strain::backbone::Backbone;

/// A run before it is made. Units are any consistent set, angles rad.
#[derive(Debug, Clone, Copy)]
pub struct Case<'a> {
    /// The body, with all modes that there are to choose from; [`stress_stiffness`](reduced_body::Constants::stress_stiffness) where it is known.
    pub body: &'a ReducedBody,
    /// One damping ratio for each mode (nf).
    pub damping_ratios: &'a [f64],
    /// The loads.
    pub loads: &'a [SharedLoad],
    /// True for each load that is gravity. Empty where none is, or where the share of gravity is of no interest.
    pub is_gravity: &'a [bool],
    /// The drive of the held part.
    pub drive: Option<&'a Drive>,
    /// How it begins (nf modal coordinates).
    pub initial: &'a Initial,
    /// When it ends.
    pub end: f64,
    /// Largest distance of two points of the body.
    pub length: f64,
    /// Name of the unit of length, for people.
    pub length_unit: &'a str,
    /// Largest displacement of a node in each mode (nf).
    pub peaks: &'a [f64],
    /// Compliance for each load. Empty where not known.
    pub static_compliances: &'a [StaticCompliance],
    /// `√(uᵀMu − Σ(Φ_kᵀMu)²)` of the static response u to the centrifugal field of each pair of spins, in the order of
    /// [`ReducedBody::PAIRS`]: what the modes leave out of it (6). Empty where not known.
    pub centrifugal_remainders: &'a [f64],
    /// The same of the static response to the inertia of a unit acceleration of the drive. None where not known.
    pub drive_remainder: Option<f64>,
    /// How the frequency of each of the first modes goes with its amplitude, where that is known.
    pub backbones: &'a [Option<Backbone>],
    /// The manifold that the large modes move on, if there is one.
    pub manifold: Option<&'a Manifold>,
    /// Stiffness between coordinates of the modes that are coupled, beside that of each (nf×nf).
    pub coupling: Option<&'a Mat<f64>>,
}

/// The work f·u of a load where its history is 1 and of its whole static response u (`modal::Solver::static_response`).
#[derive(Debug, Clone, PartialEq)]
pub struct StaticCompliance {
    /// In the first attitude.
    pub at_start: f64,
    /// Other forces or moments that a dead load may become as the body turns, each in body axes with its work.
    pub turned: Vec<(Vector3<f64>, f64)>,
}

/// A case that no advice can be given on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AdviceError {
    /// A list of the wrong length.
    #[error("{what} has {found} entries where {expected} are needed; give one for each")]
    Length {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A number out of range.
    #[error("{what} is {found}; give {expected}")]
    Value {
        /// Which number.
        what: &'static str,
        /// The number found.
        found: f64,
        /// The range expected.
        expected: &'static str,
    },
    /// An eigenvalue problem without an answer.
    #[error("{0}")]
    Eigen(#[from] dynamics::SteadyError),
}

impl Case<'_> {
    /// The histories of the loads that have one, and of the drive.
    fn histories(&self) -> impl Iterator<Item = &History> {
        let of_loads = self.loads.iter().filter_map(|load| load.history());
        of_loads.chain(self.drive.map(|drive| &drive.speed.history))
    }

    /// How many histories cost more to evaluate than closed forms do: they share a budget of samples.
    pub(crate) fn costly_histories(&self) -> usize {
        self.histories().filter(|history| history.cost() > 1.0).count()
    }

    /// Refuses lists of the wrong length and numbers that are not finite or not positive.
    pub(crate) fn check(&self, tolerance: f64) -> Result<(), AdviceError> {
        let nf = self.body.flexible();
        let mut lists = vec![
            ("the list of damping ratios", self.damping_ratios.len(), nf),
            ("the list of largest displacements", self.peaks.len(), nf),
            ("the list of initial modal displacements", self.initial.modal_displacement.len(), nf),
            ("the list of initial modal velocities", self.initial.modal_velocity.len(), nf),
        ];
        lists.extend(self.manifold.map(|manifold| ("the list of modes of the manifold", manifold.modes(), nf)));
        let loads = self.loads.len();
        let optional = [
            ("the list that marks gravity", self.is_gravity.len(), loads),
            ("the list of static compliances", self.static_compliances.len(), loads),
            ("the list of centrifugal remainders", self.centrifugal_remainders.len(), 6),
        ];
        lists.extend(optional.into_iter().filter(|(_, found, _)| *found > 0));
        for (what, found, expected) in lists {
            if found != expected {
                return Err(AdviceError::Length { what, found, expected });
            }
        }
        let mut positive =
            vec![("the end", self.end), ("the length of the body", self.length), ("the tolerance", tolerance)];
        positive.extend(self.body.circular_frequencies.iter().map(|omega| ("a circular frequency", *omega)));
        for (what, found) in positive {
            if !(found > 0.0 && found.is_finite()) {
                return Err(AdviceError::Value { what, found, expected: "a positive number" });
            }
        }
        let initial = self.initial;
        let works = |c: &StaticCompliance| {
            std::iter::once(c.at_start).chain(c.turned.iter().map(|(_, work)| *work)).collect::<Vec<_>>()
        };
        let compliances: Vec<f64> = self.static_compliances.iter().flat_map(works).collect();
        let finite = [
            ("the remainder of the drive", self.drive_remainder.as_slice()),
            ("a damping ratio", self.damping_ratios),
            ("a largest displacement", self.peaks),
            ("a static compliance", &compliances),
            ("a centrifugal remainder", self.centrifugal_remainders),
            ("an initial velocity", initial.velocity.as_slice()),
            ("an initial angular velocity", initial.omega.as_slice()),
            ("an initial modal displacement", &initial.modal_displacement),
            ("an initial modal velocity", &initial.modal_velocity),
        ];
        for (what, list) in finite {
            if let Some(found) = list.iter().copied().find(|x| !x.is_finite()) {
                return Err(AdviceError::Value { what, found, expected: "a finite number" });
            }
        }
        for history in self.histories() {
            let found = history.largest(self.end);
            if !found.is_finite() {
                return Err(AdviceError::Value { what: "a history", found, expected: "one that is finite to the end" });
            }
        }
        Ok(())
    }
}

impl Diagnostic for AdviceError {
    fn diagnosis(&self) -> Diagnosis {
        if matches!(self, Self::Eigen(_)) { Kind::Run.alone() } else { Kind::Input.alone() }
    }
}
