//! Where the strain energy of each mode is, and the error of its frequency that the mesh makes.
//!
//! The frequency that a mesh gives is too high by the energy of the error of the shape, Eq. (M15) of `docs/method/modes.md`. That is
//! estimated from the difference between the stress of the elements and the recovered one.

use std::fmt;

use fem_tet10::{AssemblyError, Material, Materials, Mesh, StressError, StressRecovery};
use model::Meshed;
use serde::Serialize;

use crate::files::json;

/// Part of the strain energy of each mode by materials and groups, and the errors of the frequencies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StrainEnergyReport {
    /// Estimated errors of the frequencies by the mesh, relative: it makes them too high by this.
    #[serde(serialize_with = "json::numbers")]
    pub mesh_errors: Vec<f64>,
    /// Parts by materials; they sum to 1.
    pub by_material: Vec<EnergyPart>,
    /// Parts by the groups of volumes of the mesh, which may overlap.
    pub by_group: Vec<EnergyPart>,
}

/// The part of the energy of each mode that is in one material or group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergyPart {
    /// Name of the group; of a material, the groups that it is given to.
    pub name: String,
    /// The part of each mode, 0 to 1.
    #[serde(serialize_with = "json::numbers")]
    pub parts: Vec<f64>,
}

impl StrainEnergyReport {
    /// The report of the modes of a body of elements; none of a body of matrices.
    ///
    /// # Errors
    /// [`AssemblyError`]: not enough memory.
    pub fn new(meshed: &Meshed) -> Result<Option<Self>, AssemblyError> {
        let Meshed { mesh, modes, elements: Some(elements), .. } = meshed else { return Ok(None) };
        let recovery = StressRecovery::new(mesh, &elements.materials)?;
        let of_elements = elements.materials.of_elements(mesh)?;
        let materials = named_materials(mesh, &elements.materials);
        let part = |name: String| EnergyPart { name, parts: Vec::new() };
        let mut report = Self {
            mesh_errors: Vec::new(),
            by_material: materials.iter().map(|(name, _)| part(name.clone())).collect(),
            by_group: mesh.groups().iter().cloned().map(part).collect(),
        };
        let groups: Vec<Vec<bool>> = (0..mesh.groups().len())
            .map(|group| (0..of_elements.len()).map(|e| mesh.element_groups(e).contains(&group)).collect())
            .collect();
        meshed.mesh_errors(&recovery, modes.shapes.as_ref(), |count, energies| {
            for k in 0..count {
                let of_shape = || energies.iter().skip(k).step_by(count);
                let whole: StressError = of_shape().copied().sum();
                let share = |is_in: &dyn Fn(usize) -> bool| {
                    let of = of_shape().enumerate().filter(|(e, _)| is_in(*e));
                    of.map(|(_, energy)| energy.energy).sum::<f64>() / whole.energy
                };
                report.mesh_errors.push(0.5 * whole.error / whole.energy);
                for ((_, material), part) in materials.iter().zip(&mut report.by_material) {
                    part.parts.push(share(&|e| of_elements[e] == *material));
                }
                for (group, part) in groups.iter().zip(&mut report.by_group) {
                    part.parts.push(share(&|e| group[e]));
                }
            }
        })?;
        Ok(Some(report))
    }
}

/// Materials that differ, each with the names of its groups.
fn named_materials(mesh: &Mesh, materials: &Materials) -> Vec<(String, Material)> {
    match materials {
        Materials::Uniform(material) => vec![("the whole mesh".to_owned(), *material)],
        Materials::ByGroup(by_group) => {
            let mut named: Vec<(String, Material)> = Vec::new();
            for (group, material) in by_group.iter().filter(|(group, _)| mesh.groups().contains(group)) {
                match named.iter_mut().find(|(_, known)| known == material) {
                    Some((name, _)) => *name = format!("{name}, {group}"),
                    None => named.push((group.clone(), *material)),
                }
            }
            named
        }
    }
}

impl fmt::Display for StrainEnergyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tables = [("material", &self.by_material), ("group", &self.by_group)];
        for (what, table) in tables.into_iter().filter(|(_, table)| table.len() > 1) {
            writeln!(f, "\n  strain energy by {what}, %")?;
            for EnergyPart { name, parts } in table {
                write!(f, "  {name:>14}")?;
                parts.iter().try_for_each(|part| write!(f, "  {:>5.1}", 100.0 * part))?;
                writeln!(f)?;
            }
        }
        Ok(())
    }
}
