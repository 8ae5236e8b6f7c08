//! Point masses, and what carries them.

use nalgebra::{Matrix4, SymmetricEigen, Vector3, Vector4};

use crate::error::{AssemblyError, AssemblyFault};
use crate::mesh::checked::Mesh;
use crate::mesh::locate::Location;

/// Most nodes that carry one mass. k nodes couple each to each, with 9k² entries in the pattern: 54 MB for 500.
const MAX_CARRIERS: usize = 500;

/// A mass at a point of the body, Eq. (M4) of `docs/method/modes.md`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PointMass {
    /// Its place, mesh axes.
    pub at: [f64; 3],
    /// Its mass.
    pub mass: f64,
    /// Where given, the radius within which all nodes carry the mass together. A mass on one node has a local
    /// compliance that grows without limit as the mesh is refined; spread over a fixed radius it has not.
    /// At most 500 nodes carry one mass, since each of them is coupled to all the others.
    pub spread: Option<f64>,
}

impl PointMass {
    /// Nodes and weights w that carry the mass: it moves with `Σ w_i u_i`, so that the mass matrix gains
    /// `m w wᵀ ⊗ I₃`.
    ///
    /// As the weights reproduce linear fields (`Σ w_i = 1`, `Σ w_i X_i = at`), the mass, its first and its second
    /// moments are exactly those of the mass at the point.
    ///
    /// # Errors
    /// A mass or a radius that is not positive, a point off the body, too few or too many nodes within the radius.
    pub(crate) fn location(&self, mesh: &Mesh) -> Result<Location, AssemblyError> {
        if !(self.mass > 0.0 && self.mass.is_finite()) {
            return Err(AssemblyFault::PointMass { at: self.at, found: self.mass }.into());
        }
        match self.spread {
            None => mesh.locate(self.at),
            Some(radius) if radius > 0.0 && radius.is_finite() => spread(mesh, self.at, radius),
            Some(radius) => Err(AssemblyFault::SpreadRadius { at: self.at, found: radius }.into()),
        }
    }
}

/// The affine field that fits the displacements of all nodes within `radius` best (least squares), taken at `at`.
fn spread(mesh: &Mesh, at: [f64; 3], radius: f64) -> Result<Location, AssemblyError> {
    let near: Vec<(u32, Vector3<f64>)> = (0..)
        .zip(mesh.positions())
        .map(|(node, x)| (node, Vector3::from(*x) - Vector3::from(at)))
        .filter(|(_, offset)| offset.norm() <= radius)
        .collect();
    if near.len() > MAX_CARRIERS {
        return Err(
            AssemblyFault::SpreadTooWide { at, radius, count: near.len(), limit: MAX_CARRIERS }.of(mesh.source())
        );
    }
    // Offsets in units of the farthest, so that the fit is well scaled in any unit of length, whatever the radius.
    let farthest = near.iter().map(|(_, offset)| offset.norm()).fold(0.0, f64::max);
    let scale = if farthest > 0.0 { farthest } else { 1.0 };
    let within: Vec<(u32, Vector4<f64>)> =
        near.into_iter().map(|(node, offset)| (node, (offset / scale).insert_row(0, 1.0))).collect();
    let refuse = || {
        AssemblyFault::Spread { at, radius, count: within.len(), distance: mesh.nearest_node(at).1 }.of(mesh.source())
    };
    let normal: Matrix4<f64> = within.iter().map(|(_, z)| z * z.transpose()).sum();
    // Nodes in a plane or on a line determine the fit there if the point is in it too: a pseudo-inverse serves all.
    let eigen = SymmetricEigen::new(normal);
    let largest = eigen.eigenvalues.max();
    let mut coefficients = Vector4::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > 1e-10 * largest {
            coefficients += vector * (vector.x / value);
        }
    }
    let weights: Vec<f64> = within.iter().map(|(_, z)| z.dot(&coefficients)).collect();
    let moments: Vector4<f64> = within.iter().zip(&weights).map(|((_, z), w)| z * *w).sum();
    // Written so that NaN is refused too.
    if (moments - Vector4::x()).iter().all(|off| off.abs() < 1e-9) {
        Ok(Location { nodes: within.into_iter().map(|(node, _)| node).collect(), weights })
    } else {
        Err(refuse())
    }
}
