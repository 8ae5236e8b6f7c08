//! Frequencies of a system under the forces of its joints and of its motion.

use faer::{Mat, c64};

use crate::system::radau::SystemMotion;
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::linearization::Linearization;
use crate::vibration::system::mode::SystemMode;
use crate::vibration::system::steady::SteadyState;

/// Part of the elastic energy of a mode from which a body bends in it.
const BENDS: f64 = 0.01;
/// Modes that are told of a body.
const TOLD: usize = 3;

/// Forces on a body in its present motion, with the deflection and the frequencies that they give it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyStiffening {
    /// The largest force that a joint, spring or bushing puts on one marker of it.
    pub force: f64,
    /// The largest moment.
    pub moment: f64,
    /// Modal displacements by all forces.
    pub modal_displacement: Vec<f64>,
    /// The slowest vibrations in which it bends.
    pub modes: Vec<StiffenedMode>,
}

/// The circular frequencies of one vibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffenedMode {
    /// In the present motion.
    pub moving: f64,
    /// The same if the stress of the forces of joints and elements stiffened no body.
    pub without_stress: f64,
    /// At rest in this place, if no forces acted.
    pub unloaded: f64,
}

impl SystemMotion {
    /// For each body, the forces on it in the present motion and the frequencies that they change: Eq. (L11) of
    /// `docs/method/systems.md`.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn stiffening(&self) -> Result<Vec<BodyStiffening>, SteadyError> {
        let moving = self.moving_state()?;
        let modes = moving.linear.vibrations()?.modes;
        let [without, unloaded] = [moving.without_joint_stress(), moving.unloaded()];
        let [without, unloaded] = [without.vibrations()?.modes, unloaded.vibrations()?.modes];
        let of_body = |(body, borne): (usize, &crate::vibration::system::tie::Borne)| {
            let bends = |mode: &&SystemMode| mode.circular_frequency() > 0.0 && mode.elastic[body] >= BENDS;
            let compared = |mode: &SystemMode| StiffenedMode {
                moving: mode.circular_frequency(),
                without_stress: like(&moving.linear, mode, &without),
                unloaded: like(&moving.linear, mode, &unloaded),
            };
            BodyStiffening {
                force: borne.force,
                moment: borne.moment,
                modal_displacement: moving.modal_displacement(body).to_vec(),
                modes: modes.iter().filter(bends).take(TOLD).map(compared).collect(),
            }
        };
        Ok(moving.terms.borne.iter().enumerate().map(of_body).collect())
    }
}

impl SteadyState {
    /// The linearised equations at rest if no forces acted.
    fn unloaded(&self) -> Linearization {
        let mut linear = self.linear.clone();
        let mut strained = linear.basis.clone();
        for (row, strain) in strained.row_iter_mut().zip(&linear.strain) {
            row.iter_mut().for_each(|x| *x *= strain.sqrt());
        }
        linear.stiffness = self.terms.unloaded.reduced(&linear.basis) + strained.transpose() * &strained;
        linear.damping.fill(0.0);
        linear
    }

    /// The linearised equations if the stress of the forces of joints and elements stiffened no body.
    fn without_joint_stress(&self) -> Linearization {
        let mut linear = self.linear.clone();
        for (borne, first) in self.terms.borne.iter().zip(&linear.first) {
            let modes = borne.stiffening.nrows();
            let own: Mat<f64> = linear.basis.get(first + 6..first + 6 + modes, ..).to_owned();
            linear.stiffness -= own.transpose() * (&borne.stiffening * &own);
        }
        linear
    }
}

/// The circular frequency of the mode whose motion is the most like that of another, by the masses.
fn like(linear: &Linearization, mode: &SystemMode, others: &[SystemMode]) -> f64 {
    let heavy: Vec<c64> = linear
        .masses
        .iter()
        .zip(&linear.first)
        .flat_map(|(mass, first)| {
            let own = &mode.motion[*first..*first + mass.nrows()];
            (0..mass.nrows()).map(move |i| own.iter().enumerate().map(|(j, x)| *x * mass[(i, j)]).sum::<c64>())
        })
        .collect();
    let likeness = |other: &SystemMode| {
        let product: c64 = heavy.iter().zip(&other.motion).map(|(a, b)| a.conj() * *b).sum();
        // Each has a length of its own.
        product.norm_sqr() / other.coordinates.iter().map(|x| x.norm_sqr()).sum::<f64>()
    };
    others.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).map_or(f64::NAN, SystemMode::circular_frequency)
}
