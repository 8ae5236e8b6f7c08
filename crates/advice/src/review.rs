//! After, or during, the run: whether what was assumed has held.

use frames_rk4::{Effects, Observation};
use nalgebra::Vector3;

use crate::case::{AdviceError, Case};
use crate::limits::{Refusal, SOFTENED, refusal};
use crate::response::{norm, relative};
use crate::row::Effect;
use crate::table::{Advice, LINEAR, held};

/// An assumption that has broken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Broken {
    /// The spin rose above what the estimates allow for.
    #[error(
        "at time {time:.6} the spin was {found:.4}, above the {assumed:.4} that the estimates allow for: set {off} = true in [effects]"
    )]
    Spin {
        /// When it was so for the first time.
        time: f64,
        /// The largest |ω| there was.
        found: f64,
        /// The largest that was assumed.
        assumed: f64,
        /// The effects that were left out.
        off: String,
    },
    /// The deflection rose above what the estimates allow for.
    #[error(
        "at time {time:.6} the deflection was {found:.3e} of the length, above the {assumed:.3e} that the estimates allow for: set {off} = true in [effects]"
    )]
    Deflection {
        /// When it was so for the first time.
        time: f64,
        /// The largest there was.
        found: f64,
        /// The largest that was assumed.
        assumed: f64,
        /// The effects that were left out.
        off: String,
    },
    /// The strain is not linear.
    #[error(
        "at time {time:.6} the deflection passed 10 % of the length, up to {found:.3e}: linear strain ends there; trust the answer to some per cent only"
    )]
    Linear {
        /// When it was so for the first time.
        time: f64,
        /// The largest there was.
        found: f64,
    },
    /// The modes do not carry what the spin does to the body.
    #[error(
        "at time {time:.6} the modes held only {held:.1e} of the static answer to the spin, and the answer lacks the rest, \
         {influence:.1e} of the deformation: take static_correction = true with the scheme exponential, or more modes"
    )]
    Stretch {
        /// When most was missing.
        time: f64,
        /// Part of the static answer that the modes held.
        held: f64,
        /// Part of the whole deformation that was missing.
        influence: f64,
    },
    /// A spin was reached at which the model is known to be wrong.
    #[error("at time {time:.6}: {refusal}")]
    Limit {
        /// When it was so for the first time.
        time: f64,
        /// The reason.
        refusal: Refusal,
    },
}

/// Watches a run.
#[derive(Debug, Clone)]
pub struct Review<'a> {
    case: Case<'a>,
    effects: Effects,
    spin: f64,
    deflection: f64,
    /// The last |ω| whose limit was looked up, and its direction.
    looked_up: (f64, Vector3<f64>),
    tolerance: f64,
    /// The most that the modes left out of the static answer to the spin, when, and the part that they held.
    left_out: (f64, f64, f64),
    /// Largest √(qᵀq).
    deformation: f64,
    broken: Vec<Broken>,
}

/// What rounding and the change of inertia by a small deformation may add to a bound.
const MARGIN: f64 = 1.01;
/// Deflection over length that is rounding.
const ROUNDING: f64 = 1e-10;

impl<'a> Review<'a> {
    /// Of a run with these effects that `advice` was given on. The case has the modes that are simulated.
    pub fn new(case: Case<'a>, effects: Effects, advice: &Advice) -> Self {
        Self {
            case,
            effects,
            spin: advice.spin,
            deflection: advice.deflection,
            looked_up: (0.0, Vector3::zeros()),
            tolerance: advice.tolerance,
            left_out: (0.0, 0.0, 1.0),
            deformation: 0.0,
            broken: Vec::new(),
        }
    }

    /// Looks at the motion at a time; times rise.
    ///
    /// # Errors
    /// An eigenvalue problem without an answer; a list of modal displacements of another length.
    pub fn observe(&mut self, observation: &Observation) -> Result<(), AdviceError> {
        let (q, peaks) = (&observation.modal_displacement, self.case.peaks);
        if q.len() != peaks.len() {
            let what = "the list of modal displacements";
            return Err(AdviceError::Length { what, found: q.len(), expected: peaks.len() });
        }
        let time = observation.time;
        let deflection = q.iter().zip(peaks).map(|(q, a)| (q * a).abs()).sum::<f64>() / self.case.length;
        let speed = observation.omega_body.norm();
        if self.something_is_off() && speed > MARGIN * self.spin {
            self.note(Broken::Spin { time, found: speed, assumed: self.spin, off: self.off() });
        }
        if self.something_is_off() && deflection > MARGIN * self.deflection + ROUNDING {
            self.note(Broken::Deflection { time, found: deflection, assumed: self.deflection, off: self.off() });
        }
        if self.effects.deformed_inertia && !self.case.centrifugal_remainders.is_empty() {
            let omega = &observation.omega_body;
            let (held, left) = held(&self.case, &(omega * omega.transpose()));
            if left > self.left_out.0 {
                self.left_out = (left, time, held);
            }
            self.deformation = self.deformation.max(norm(q));
        }
        if deflection > LINEAR {
            self.note(Broken::Linear { time, found: deflection });
        }
        if speed >= SOFTENED * self.lowest() && !self.is_known(&observation.omega_body, speed) {
            let axis = observation.omega_body / speed;
            self.looked_up = (speed, axis);
            if let Some(refusal) = refusal(&self.case, &axis, speed, &self.effects)? {
                self.broken.push(Broken::Limit { time, refusal });
            }
        }
        Ok(())
    }

    /// What has broken so far: each assumption once, with the first time and the worst.
    pub fn broken(&self) -> Vec<Broken> {
        let (left, time, held) = self.left_out;
        let influence = relative(left, self.deformation.hypot(left));
        let stretch = (influence >= self.tolerance).then_some(Broken::Stretch { time, held, influence });
        self.broken.iter().cloned().chain(stretch).collect()
    }

    /// Whether an effect of turning and bending was left out, for which the estimates had to hold.
    fn something_is_off(&self) -> bool {
        !(self.effects.deformed_inertia && self.effects.coriolis && self.effects.geometric_stiffening)
    }

    /// The names of those effects.
    fn off(&self) -> String {
        let Effects { deformed_inertia, coriolis, geometric_stiffening, .. } = self.effects;
        let all = [
            (deformed_inertia, Effect::DeformedInertia),
            (coriolis, Effect::Coriolis),
            (geometric_stiffening, Effect::GeometricStiffening),
        ];
        all.iter().filter(|(on, _)| !on).map(|(_, effect)| effect.name()).collect::<Vec<_>>().join(" = true, ")
    }

    /// Lowest natural frequency, rad per time. The centrifugal force takes at most Ω² from the stiffness of a mode, so
    /// that below it nothing can be lost.
    fn lowest(&self) -> f64 {
        self.case.body.circular_frequencies.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether a limit has broken, or was looked up for about this spin: it costs an eigenvalue problem.
    fn is_known(&self, omega_body: &Vector3<f64>, speed: f64) -> bool {
        let (fastest, axis) = &self.looked_up;
        self.broken.iter().any(|broken| matches!(broken, Broken::Limit { .. }))
            || speed < 1.02 * fastest && omega_body.dot(axis).abs() > 0.999 * speed
    }

    fn note(&mut self, new: Broken) {
        for old in &mut self.broken {
            match (old, &new) {
                (Broken::Spin { found, .. }, Broken::Spin { found: now, .. })
                | (Broken::Deflection { found, .. }, Broken::Deflection { found: now, .. })
                | (Broken::Linear { found, .. }, Broken::Linear { found: now, .. }) => {
                    *found = found.max(*now);
                    return;
                }
                _ => {}
            }
        }
        self.broken.push(new);
    }
}
