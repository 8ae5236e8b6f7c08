//! Report of a diagram.

use std::path::PathBuf;

use serde::Serialize;

use super::branches::Branch;
use super::critical::{Critical, SwingLimit};
use crate::commands::system_modes::SpinningRotor;
use crate::files::json;
use crate::report::MeshReport;

/// Natural frequencies against spin speed.
#[derive(Debug, Clone, Serialize)]
pub struct CampbellReport {
    /// Title of the scene.
    pub title: String,
    /// Label of the unit of time.
    pub time_unit: String,
    /// Label of the unit of length.
    pub length_unit: String,
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// The finite-element model.
    pub mesh: Option<MeshReport>,
    /// Names of the bodies of a system; none of one body alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<String>,
    /// The body of a system that spins, where the others are its support; none where all spin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotor: Option<String>,
    /// Rotors beside it that spin as they do at the start of the scene, at the same speed at all speeds of the diagram.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rotors: Vec<SpinningRotor>,
    /// Turns that are left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The spin axis: unit vector, axes of the mesh; of a system global.
    pub axis: [f64; 3],
    /// The point that the axis goes through, mesh axes; of a system global.
    pub origin: [f64; 3],
    /// The effects of the spin that are computed; none of a rotor, whose spin does nothing to the bodies of its support.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effects: Option<SpinEffects>,
    /// Spin speeds, radians per time.
    pub speeds: Vec<f64>,
    /// Largest displacement of a node by deformation at each speed, where the vibrations are about the rest of the full body; none where
    /// they are about the undeformed body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deflection: Vec<f64>,
    /// The reason that the rest of the full body cannot be found, and how far the spin bends the body; none where it can, and of a system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_rest: Option<String>,
    /// The lines of the diagram, in the order of their frequencies at the lowest speed.
    pub branches: Vec<Branch>,
    /// The spin speed at which the body loses its stability because K + Ω²(K_σ − N) is no longer positive definite; none
    /// if it never does. Of a system, and about the rest of the full body, the lowest of the speeds at which a vibration grows; none if none does within them.
    pub stable_below: Option<f64>,
    /// Where orders and branches cross, by order and speed; order 0 where a frequency is zero, or growth begins or ends.
    pub critical_speeds: Vec<Critical>,
    /// Where vibrations that are damped so much that they only decay begin to swing, or stop to, by speed: no limits of stability.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub swing_limits: Vec<SwingLimit>,
    /// Files written.
    #[serde(serialize_with = "json::paths")]
    pub files: Vec<PathBuf>,
}

/// Effects of the spin that are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SpinEffects {
    /// Coriolis forces, G.
    pub coriolis: bool,
    /// The centrifugal forces of the deformation, N.
    pub softening: bool,
    /// The stress of the centrifugal field, K_σ.
    pub stiffening: bool,
}

impl SpinEffects {
    /// True if all are computed.
    pub(super) fn all(self) -> bool {
        self.coriolis && self.softening && self.stiffening
    }
}
