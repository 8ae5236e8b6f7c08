//! Where the strain energy of each mode is, and the error of its frequency that the mesh makes.
//!
//! The frequency that a mesh gives is too high by the energy of the error of the shape, Eq. (M15) of `docs/method/modes.md`. That is
//! estimated from the difference between the stress of the elements and the recovered one.

use fem_tet10::{AssemblyError, Material, Materials, Mesh, StressError, StressRecovery};
use model::Meshed;
use report::{Form, Report, Table};

/// Part of the strain energy of each mode by materials and groups, and the errors of the frequencies.
pub(super) struct StrainEnergy {
    /// Estimated errors of the frequencies by the mesh, relative: it makes them too high by this.
    pub mesh_errors: Vec<f64>,
    /// Parts by materials, with the groups that each is given to; they sum to 1.
    by_material: Vec<EnergyPart>,
    /// Parts by the groups of volumes of the mesh, which may overlap.
    by_group: Vec<EnergyPart>,
}

/// The name of a material or group, and the part of the energy of each mode that is in it, 0 to 1.
type EnergyPart = (String, Vec<f64>);

impl StrainEnergy {
    /// The energy of the modes of a body of elements; none of a body of matrices.
    ///
    /// # Errors
    /// [`AssemblyError`]: not enough memory.
    pub fn new(meshed: &Meshed) -> Result<Option<Self>, AssemblyError> {
        let Meshed { mesh, modes, elements: Some(elements), .. } = meshed else { return Ok(None) };
        let recovery = StressRecovery::new(mesh, &elements.materials)?;
        let of_elements = elements.materials.of_elements(mesh)?;
        let materials = named_materials(mesh, &elements.materials);
        let part = |name: String| (name, Vec::new());
        let mut found = Self {
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
                found.mesh_errors.push(0.5 * whole.error / whole.energy);
                for ((_, material), (_, part)) in materials.iter().zip(&mut found.by_material) {
                    part.push(share(&|e| of_elements[e] == *material));
                }
                for (group, (_, part)) in groups.iter().zip(&mut found.by_group) {
                    part.push(share(&|e| group[e]));
                }
            }
        })?;
        Ok(Some(found))
    }

    /// Adds it to a report.
    pub fn add_to(&self, report: &mut Report) {
        report.put("strain_energy.mesh_errors", &self.mesh_errors[..]);
        let tables = [
            ("material", "strain_energy.by_material", &self.by_material),
            ("group", "strain_energy.by_group", &self.by_group),
        ];
        for (of, path, rows) in tables {
            let names = || rows.iter().map(|(name, _)| name);
            let mut table = Table::new(of, path).column("name", names());
            table = table.column("parts", rows.iter().map(|(_, parts)| &parts[..]));
            if rows.len() > 1 {
                table = table.titled(format!("strain energy by {of}, %")).all().text_only("mode", Form::Plain, names());
                for k in 0..self.mesh_errors.len() {
                    let of_mode = rows.iter().map(|(_, parts)| 100.0 * parts[k]);
                    table = table.text_only((k + 1).to_string(), Form::Fixed(1), of_mode);
                }
            }
            report.table(table);
        }
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
