//! The contract of a results file: its time histories, their shapes, units and frames.
//!
//! A file with T rows, nf flexible modes and the points `<name>` holds
//!
//! | dataset | shape | frame |
//! |---|---|---|
//! | `time` | T | |
//! | `attitude` (unit quaternion w x y z) | T×4 | body to global |
//! | `position`, `velocity` (centre of mass) | T×3 | global |
//! | `angular_velocity`, `angular_acceleration` | T×3 | body |
//! | `modal/displacement`, `modal/velocity` | T×nf | |
//! | `energy/kinetic`, `energy/strain` | T | |
//! | `energy/work` (of the loads), `energy/dissipation`, `energy/balance` | T | |
//! | `momentum/linear`, `momentum/angular` (about the centre of mass) | T×3 | global |
//! | `momentum/linear_balance`, `momentum/angular_balance` (less the impulse of the loads) | T×3 | global |
//! | `points/<name>/displacement`, `velocity`, `acceleration`, `rigid_acceleration` | T×3 | global |
//! | `body/mass`, `center_of_mass`, `inertia` | 1, 3, 3×3 | body |
//! | `body/frequencies`, `body/damping_ratios` | nf | |
//!
//! Every dataset has the attributes `unit`, `frame` and `description`. The root has `title`, `scene`
//! (the scene file's text), `scene_file` (where it was), `formulation`, `scheme`, `step` or `tolerance`,
//! `program_version`, `fingerprint`, `units_length`, `units_mass`, `units_time` and `complete`: 1, or 0 in an unfinished
//! file.
//!
//! In an unfinished file, T is the number of rows that there is room for. Those that have not been written are NaN. It
//! has the dataset `checkpoint` besides (2×words): two places for the state of the run, written in turns, each with
//! its number, the rows before it, their check sum, the words of the state, and a check sum of itself.

use crate::{Sample, Units};
use std::slice::from_ref;

/// The datasets of one point, in the order of [`Quantity::Point`]'s second number.
const POINT_QUANTITIES: [&str; 4] = ["displacement", "velocity", "acceleration", "rigid_acceleration"];

/// One time history of a results file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Attitude,
    Position,
    Velocity,
    AngularVelocity,
    AngularAcceleration,
    ModalDisplacement,
    ModalVelocity,
    KineticEnergy,
    StrainEnergy,
    Work,
    Dissipation,
    EnergyBalance,
    LinearMomentum,
    AngularMomentum,
    LinearBalance,
    AngularBalance,
    /// Index of the point, index into [`POINT_QUANTITIES`].
    Point(usize, usize),
}

use Quantity::*;

impl Quantity {
    /// All histories of a file with so many points.
    pub(crate) fn all(points: usize) -> impl Iterator<Item = Quantity> {
        [
            Time,
            Attitude,
            Position,
            Velocity,
            AngularVelocity,
            AngularAcceleration,
            ModalDisplacement,
            ModalVelocity,
            KineticEnergy,
            StrainEnergy,
            Work,
            Dissipation,
            EnergyBalance,
            LinearMomentum,
            AngularMomentum,
            LinearBalance,
            AngularBalance,
        ]
        .into_iter()
        .chain((0..points).flat_map(|i| (0..POINT_QUANTITIES.len()).map(move |k| Point(i, k))))
    }

    /// Path of the dataset in the file.
    pub(crate) fn path(self, point_names: &[String]) -> String {
        match self {
            Time => "time".into(),
            Attitude => "attitude".into(),
            Position => "position".into(),
            Velocity => "velocity".into(),
            AngularVelocity => "angular_velocity".into(),
            AngularAcceleration => "angular_acceleration".into(),
            ModalDisplacement => "modal/displacement".into(),
            ModalVelocity => "modal/velocity".into(),
            KineticEnergy => "energy/kinetic".into(),
            StrainEnergy => "energy/strain".into(),
            Work => "energy/work".into(),
            Dissipation => "energy/dissipation".into(),
            EnergyBalance => "energy/balance".into(),
            LinearMomentum => "momentum/linear".into(),
            AngularMomentum => "momentum/angular".into(),
            LinearBalance => "momentum/linear_balance".into(),
            AngularBalance => "momentum/angular_balance".into(),
            Point(i, k) => format!("points/{}/{}", point_names[i], POINT_QUANTITIES[k]),
        }
    }

    /// Values per row; `None` for a plain column (shape T instead of T×width).
    pub(crate) fn width(self, modes: usize) -> Option<usize> {
        match self {
            Time | KineticEnergy | StrainEnergy | Work | Dissipation | EnergyBalance => None,
            Attitude => Some(4),
            ModalDisplacement | ModalVelocity => Some(modes),
            _ => Some(3),
        }
    }

    /// The unit in terms of the run's units. Modes are mass-normalised, hence the root of the mass.
    pub(crate) fn unit(self, Units { length, mass, time }: &Units) -> String {
        match self {
            Time => time.clone(),
            Attitude => "1".into(),
            Position | Point(_, 0) => length.clone(),
            Velocity | Point(_, 1) => format!("{length}/{time}"),
            Point(..) => format!("{length}/{time}^2"),
            AngularVelocity => format!("rad/{time}"),
            AngularAcceleration => format!("rad/{time}^2"),
            ModalDisplacement => format!("{length} {mass}^(1/2)"),
            ModalVelocity => format!("{length} {mass}^(1/2)/{time}"),
            KineticEnergy | StrainEnergy | Work | Dissipation | EnergyBalance => {
                format!("{mass} {length}^2/{time}^2")
            }
            LinearMomentum | LinearBalance => format!("{mass} {length}/{time}"),
            AngularMomentum | AngularBalance => format!("{mass} {length}^2/{time}"),
        }
    }

    /// The frame of the components.
    pub(crate) fn frame(self) -> &'static str {
        match self {
            Time | ModalDisplacement | ModalVelocity => "none",
            KineticEnergy | StrainEnergy | Work | Dissipation | EnergyBalance => "none",
            Attitude => "body to global",
            AngularVelocity | AngularAcceleration => "body",
            _ => "global",
        }
    }

    /// A sentence for people.
    pub(crate) fn description(self) -> &'static str {
        match self {
            Time => "time of each row",
            Attitude => "unit quaternion (w, x, y, z) that takes body components to global ones",
            Position => "position of the centre of mass",
            Velocity => "velocity of the centre of mass",
            AngularVelocity => "angular velocity of the body frame",
            AngularAcceleration => "angular acceleration of the body frame",
            ModalDisplacement => "coordinates of the mass-normalised flexible modes and static shapes",
            ModalVelocity => "rates of the modal coordinates",
            KineticEnergy => "kinetic energy",
            StrainEnergy => "strain energy",
            Work => "work of the loads since t = 0",
            Dissipation => "energy that damping has taken since t = 0",
            EnergyBalance => "kinetic + strain energy - work + dissipation: constant in exact motion",
            LinearMomentum => "linear momentum",
            AngularMomentum => "angular momentum about the centre of mass",
            LinearBalance => "linear momentum less the impulse of the loads: constant in exact motion",
            AngularBalance => {
                "angular momentum less the angular impulse of the loads, both about the centre of mass: \
                 constant in exact motion"
            }
            Point(_, 0) => "displacement of the point from its place at t = 0 in the undeformed body",
            Point(_, 1) => "velocity of the point",
            Point(_, 2) => "acceleration of the point",
            Point(..) => "part of the point's acceleration that belongs to the rigid motion",
        }
    }

    /// The row's values of this quantity. The sample must have the points that are asked for.
    pub(crate) fn of<'a>(self, sample: &'a Sample) -> &'a [f64] {
        match self {
            Time => from_ref(&sample.time),
            Attitude => &sample.attitude,
            Position => &sample.position,
            Velocity => &sample.velocity,
            AngularVelocity => &sample.angular_velocity,
            AngularAcceleration => &sample.angular_acceleration,
            ModalDisplacement => sample.modal_displacement,
            ModalVelocity => sample.modal_velocity,
            KineticEnergy => from_ref(&sample.kinetic_energy),
            StrainEnergy => from_ref(&sample.strain_energy),
            Work => from_ref(&sample.work),
            Dissipation => from_ref(&sample.dissipation),
            EnergyBalance => from_ref(&sample.energy_balance),
            LinearMomentum => &sample.linear_momentum,
            AngularMomentum => &sample.angular_momentum,
            LinearBalance => &sample.linear_balance,
            AngularBalance => &sample.angular_balance,
            Point(i, 0) => &sample.points[i].displacement,
            Point(i, 1) => &sample.points[i].velocity,
            Point(i, 2) => &sample.points[i].acceleration,
            Point(i, _) => &sample.points[i].rigid_acceleration,
        }
    }
}
