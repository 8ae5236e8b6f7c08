//! Mass properties as the paper has them: the mass of each element at its centroid.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::assembly::point_mass::PointMass;
use crate::element::integration::Rules;
use crate::element::shape::shape_functions;
use crate::error::AssemblyError;
use crate::material::Materials;
use crate::mesh::checked::Mesh;

/// Mass and principal moments of inertia of a body whose elements are points at their centroids.
///
/// Coarser than the consistent mass matrix; it is here because the printed values of the paper come from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LumpedInertia {
    /// Total mass.
    pub mass: f64,
    /// Principal moments about the centre of mass, smallest first.
    pub principal_moments: [f64; 3],
}

/// Lumps each element's mass at its centroid and adds the point masses.
///
/// # Errors
/// As [`assemble`](crate::assemble), for materials and masses.
pub fn centroid_lumped_inertia(
    mesh: &Mesh,
    materials: &Materials,
    point_masses: &[PointMass],
) -> Result<LumpedInertia, AssemblyError> {
    let rules = Rules::new();
    let at_centroid = shape_functions([0.25; 3]);
    let mut lumps: Vec<(f64, Vector3<f64>)> = Vec::with_capacity(mesh.elements().len() + point_masses.len());
    for (e, material) in materials.of_elements(mesh)?.iter().enumerate() {
        let positions = mesh.element_positions(e);
        let volume: f64 = rules.points(&positions).iter().map(|p| p.volume).sum();
        let centroid = positions.iter().zip(at_centroid).map(|(x, n)| Vector3::from(*x) * n).sum();
        lumps.push((material.density * volume, centroid));
    }
    for point_mass in point_masses {
        point_mass.location(mesh)?;
        lumps.push((point_mass.mass, Vector3::from(point_mass.at)));
    }
    let mass: f64 = lumps.iter().map(|(m, _)| m).sum();
    let center: Vector3<f64> = lumps.iter().map(|(m, x)| x * *m).sum::<Vector3<f64>>() / mass;
    let inertia: Matrix3<f64> = lumps
        .iter()
        .map(|(m, x)| {
            let r = x - center;
            (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * *m
        })
        .sum();
    let mut principal_moments: [f64; 3] = SymmetricEigen::new(inertia).eigenvalues.into();
    principal_moments.sort_by(f64::total_cmp);
    Ok(LumpedInertia { mass, principal_moments })
}
