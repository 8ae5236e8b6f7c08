//! Isotropic linear elasticity, and which physical group is made of what.

use std::collections::BTreeMap;

use crate::error::{AssemblyError, AssemblyFault};
use crate::mesh::checked::Mesh;

/// An isotropic, linearly elastic material.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E, force per area.
    pub young_modulus: f64,
    /// Poisson's ratio ν, in the open interval (−1, 0.5).
    pub poisson_ratio: f64,
    /// Mass per volume ρ.
    pub density: f64,
}

impl Material {
    /// Lamé's constants (λ, μ): σ = λ tr(ε) I + 2 μ ε.
    pub fn lame(&self) -> (f64, f64) {
        let (e, nu) = (self.young_modulus, self.poisson_ratio);
        (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)))
    }

    fn check(&self, group: &str) -> Result<(), AssemblyError> {
        let outside = |quantity, found, expected| {
            AssemblyFault::MaterialConstant { group: group.to_owned(), quantity, found, expected }.into()
        };
        // Written so that NaN fails each test.
        if !(self.young_modulus > 0.0 && self.young_modulus.is_finite()) {
            return Err(outside("Young's modulus", self.young_modulus, "a positive number"));
        }
        if !(self.poisson_ratio > -1.0 && self.poisson_ratio < 0.5) {
            return Err(outside("Poisson's ratio", self.poisson_ratio, "a number between -1 and 0.5, both excluded"));
        }
        if !(self.density > 0.0 && self.density.is_finite()) {
            return Err(outside("density", self.density, "a positive number"));
        }
        Ok(())
    }
}

/// The materials of a body.
#[derive(Debug, Clone, PartialEq)]
pub enum Materials {
    /// One material for the whole mesh.
    Uniform(Material),
    /// A material for each volume physical group, by the group's name. Groups may overlap where their materials are
    /// equal, and a group may be left out where others cover it.
    ByGroup(BTreeMap<String, Material>),
}

impl Materials {
    /// The material of each element of `mesh`.
    ///
    /// # Errors
    /// A constant outside its range, a named group that the mesh does not have, an element without a material or
    /// with two different ones.
    pub fn of_elements(&self, mesh: &Mesh) -> Result<Vec<Material>, AssemblyError> {
        match self {
            Self::Uniform(material) => {
                material.check("the whole mesh")?;
                Ok(vec![*material; mesh.elements().len()])
            }
            Self::ByGroup(by_name) => {
                for (name, material) in by_name {
                    material.check(name)?;
                    if !mesh.groups().contains(name) {
                        return Err(AssemblyFault::MissingGroup {
                            group: name.clone(),
                            present: mesh.groups().to_vec(),
                        }
                        .of(mesh.source()));
                    }
                }
                let of_group: Vec<Option<Material>> =
                    mesh.groups().iter().map(|name| by_name.get(name).copied()).collect();
                (0..mesh.elements().len())
                    .map(|e| {
                        let groups = mesh.element_groups(e);
                        let name = |group: &usize| mesh.groups()[*group].clone();
                        let mut given = groups.iter().filter_map(|g| Some((g, of_group[*g]?)));
                        let (first, material) = given.next().ok_or_else(|| {
                            AssemblyFault::NoMaterial {
                                element: mesh.element_tags()[e],
                                groups: groups.iter().map(name).collect(),
                            }
                            .of(mesh.source())
                        })?;
                        match given.find(|(_, other)| *other != material) {
                            None => Ok(material),
                            Some((second, _)) => Err(AssemblyFault::TwoMaterials {
                                element: mesh.element_tags()[e],
                                groups: [name(first), name(second)],
                            }
                            .of(mesh.source())),
                        }
                    })
                    .collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conserved: E and ν from λ and μ.
    #[test]
    fn lame_constants_give_back_young_and_poisson() {
        let (lambda, mu) = Material { young_modulus: 70e3, poisson_ratio: 0.33, density: 1.0 }.lame();
        assert!((mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu) / 70e3 - 1.0).abs() < 1e-14);
        assert!((lambda / (2.0 * (lambda + mu)) / 0.33 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn constants_outside_their_range_are_refused() {
        let good = Material { young_modulus: 70e3, poisson_ratio: 0.33, density: 2.7e-9 };
        assert!(good.check("g").is_ok());
        for bad in [
            Material { poisson_ratio: 0.5, ..good },
            Material { poisson_ratio: -1.0, ..good },
            Material { poisson_ratio: f64::NAN, ..good },
            Material { young_modulus: 0.0, ..good },
            Material { young_modulus: f64::INFINITY, ..good },
            Material { density: -1.0, ..good },
        ] {
            let message = bad.check("tip").unwrap_err().to_string();
            assert!(message.contains("tip"), "{message}");
        }
    }
}
