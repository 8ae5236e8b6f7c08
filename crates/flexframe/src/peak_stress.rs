//! The largest von Mises stress of a run, over the whole body and all rows.

use std::fmt;

use faer::Col;
use fem_tet10::{StressError, StressRecovery};
use frames_rk4::Observation;
use scene::{Body, Meshed, Model, Scene, StressPeak};
use serde::Serialize;

use crate::json;
use crate::report::quantity;

/// The largest von Mises stress of a run, and what is known of its error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PeakStress {
    /// The stress, force per area.
    #[serde(serialize_with = "json::number")]
    pub von_mises: f64,
    /// When.
    #[serde(serialize_with = "json::number")]
    pub time: f64,
    /// Where: the node, in the numbering of the mesh.
    pub node: u64,
    /// Its position in the undeformed body, mesh axes.
    pub at: [f64; 3],
    /// The physical groups that it is in.
    pub groups: Vec<String>,
    /// The von Mises stress that the modes leave out there and then, of the static answer to what acts on the body.
    #[serde(serialize_with = "json::number")]
    pub left_out: f64,
    /// The largest one then, anywhere in the body.
    #[serde(serialize_with = "json::number")]
    pub most_left_out: f64,
    /// The error of the mesh, in the norm of the energy of the whole body, relative to the stress then; not known with large
    /// deflection.
    #[serde(serialize_with = "json::optional")]
    pub mesh_error: Option<f64>,
}

/// The largest one so far.
#[derive(Debug, Clone)]
pub(crate) struct Largest {
    peak: StressPeak,
    time: f64,
    modal_displacement: Vec<f64>,
}

impl Largest {
    /// Takes one more row into account.
    pub(crate) fn watch(so_far: &mut Option<Self>, model: &Model, now: &Observation) {
        let Some(peak) = model.stress.as_ref().and_then(|stress| stress.peak(now)) else { return };
        if so_far.as_ref().is_none_or(|largest| peak.von_mises > largest.peak.von_mises) {
            *so_far = Some(Self { peak, time: now.time, modal_displacement: now.modal_displacement.clone() });
        }
    }

    /// With its place and what the mesh makes of it.
    pub(crate) fn report(&self, scene: &Scene, model: &Model) -> Option<PeakStress> {
        let meshed = model.meshed.as_ref()?;
        let StressPeak { von_mises, node, left_out, most_left_out } = self.peak;
        let mesh = &meshed.mesh;
        Some(PeakStress {
            von_mises,
            time: self.time,
            node: mesh.node_tags()[node as usize],
            at: mesh.positions()[node as usize],
            groups: mesh.groups_of_node(node).into_iter().map(str::to_owned).collect(),
            left_out,
            most_left_out,
            mesh_error: if model.physics.large_deflection.is_some() { None } else { self.mesh_error(scene, meshed) },
        })
    }

    fn mesh_error(&self, scene: &Scene, meshed: &Meshed) -> Option<f64> {
        let Body::Meshed(body) = &scene.body else { return None };
        let displacement = &meshed.modes.shapes * Col::from_iter(self.modal_displacement.iter().copied());
        let recovery = StressRecovery::new(&meshed.mesh, &body.materials).ok()?;
        let nodal = recovery.nodal_stress(displacement.as_mat()).ok()?;
        let of_elements = recovery.error_estimate(displacement.as_ref(), nodal.col(0)).ok()?;
        Some(of_elements.into_iter().sum::<StressError>().relative())
    }
}

impl fmt::Display for PeakStress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at.map(quantity);
        write!(
            f,
            "largest von Mises stress {} at time {} at ({x}, {y}, {z})",
            quantity(self.von_mises),
            quantity(self.time)
        )?;
        if !self.groups.is_empty() {
            write!(f, " in {}", self.groups.join(", "))?;
        }
        write!(f, "; the modes leave out {:.1e} there and {:.1e} at most anywhere", self.left_out, self.most_left_out)?;
        match self.mesh_error {
            Some(error) => write!(f, ", the mesh is {:.1} % off in the mean", 100.0 * error),
            None => Ok(()),
        }
    }
}
