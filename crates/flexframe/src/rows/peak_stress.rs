//! The largest von Mises stress of a run, over the whole body and all rows.

use dynamics::Observation;
use fem_tet10::{StressError, StressRecovery};
use model::{Meshed, Model, StressPeak};
use serde::Serialize;

use crate::files::json;
use crate::report::quantity;
use crate::rows::units::UnitLabels;

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
    /// The von Mises stress that the modes leave out there and then, of the static response to what acts on the body; not known where
    /// large modes bend the body far.
    #[serde(serialize_with = "json::optional")]
    pub left_out: Option<f64>,
    /// The largest one then, anywhere in the body.
    #[serde(serialize_with = "json::optional")]
    pub max_left_out: Option<f64>,
    /// The error of the mesh, in the norm of the energy of the whole body, relative to the stress then; not known with large
    /// deflection.
    #[serde(serialize_with = "json::optional")]
    pub mesh_error: Option<f64>,
}

/// Deflection over the length of the body from which on what large modes leave out is not known: of the linear answers, which is all that
/// can be told without the full body, it is less by the square of the deflection. It is 3 % of the largest stress at a deflection of
/// 0.2, where nothing of the linear answers is left out (`crates/model/tests/bent/stress.rs`).
const FAR: f64 = 0.02;

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
    pub(crate) fn report(&self, model: &Model) -> Option<PeakStress> {
        let meshed = model.meshed.as_ref()?;
        let StressPeak { von_mises, node, left_out, max_left_out } = self.peak;
        let mesh = &meshed.mesh;
        let is_large = model.physics.large_deflection.is_some();
        let is_known = !is_large || model.deflection(&self.modal_displacement) < FAR;
        let [left_out, max_left_out] = [left_out, max_left_out].map(|stress| is_known.then_some(stress));
        Some(PeakStress {
            von_mises,
            time: self.time,
            node: mesh.node_tags()[node as usize],
            at: mesh.positions()[node as usize],
            groups: mesh.groups_of_node(node).into_iter().map(str::to_owned).collect(),
            left_out,
            max_left_out,
            mesh_error: if is_large { None } else { self.mesh_error(meshed) },
        })
    }

    fn mesh_error(&self, meshed: &Meshed) -> Option<f64> {
        let elements = meshed.elements.as_ref()?;
        let recovery = StressRecovery::new(&meshed.mesh, &elements.materials).ok()?;
        let of_elements = meshed.mesh_error_of_state(&recovery, &self.modal_displacement).ok()?;
        Some(of_elements.into_iter().sum::<StressError>().relative())
    }
}

impl PeakStress {
    /// Such as "largest von Mises stress 41.2 MPa at 0.01 s at (0, 5, 0) mm; the modes leave out …".
    pub(crate) fn in_words(&self, units: &UnitLabels<'_>) -> String {
        let (stress, UnitLabels { length, time, .. }) = (units.stress(), units);
        let [x, y, z] = self.at.map(quantity);
        let groups = if self.groups.is_empty() { String::new() } else { format!(" in {}", self.groups.join(", ")) };
        let mesh_error = match self.mesh_error {
            Some(error) => format!(", the mesh is {:.1} % off in the mean", 100.0 * error),
            None => String::new(),
        };
        let left_out = match (self.left_out, self.max_left_out) {
            (Some(here), Some(most)) => {
                format!("the modes leave out {here:.1e} {stress} there and {most:.1e} {stress} at most anywhere")
            }
            _ => "the body bends too far to tell what the modes leave out, which `flexframe check` knows".to_owned(),
        };
        format!(
            "largest von Mises stress {} {stress} at {} {time} at ({x}, {y}, {z}) {length}{groups}; {left_out}{mesh_error}",
            quantity(self.von_mises),
            quantity(self.time),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_its_unit_behind_it() {
        let stress = PeakStress {
            von_mises: 41.25,
            time: 0.5,
            node: 7,
            at: [0.0, 5.0, 10.0],
            groups: vec!["root".to_owned()],
            left_out: Some(0.125),
            max_left_out: Some(0.25),
            mesh_error: Some(0.03),
        };
        let words = stress.in_words(&UnitLabels { length: "mm", mass: "Mg", time: "s" });
        let quantities = [41.25, 0.5, 5.0, 10.0].map(quantity);
        let [peak, time, y, z] = &quantities;
        let expected = [
            format!("stress {peak} MPa at {time} s at (0, {y}, {z}) mm in root; "),
            "leave out 1.2e-1 MPa there and 2.5e-1 MPa at most anywhere, the mesh is 3.0 % off".to_owned(),
        ];
        assert!(expected.iter().all(|part| words.contains(part)), "{words}");
        let far = PeakStress { left_out: None, max_left_out: None, mesh_error: None, ..stress };
        let words = far.in_words(&UnitLabels { length: "mm", mass: "Mg", time: "s" });
        assert!(words.contains("too far to tell") && words.contains("flexframe check"), "{words}");
    }
}
