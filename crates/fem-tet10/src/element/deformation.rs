//! How fields deform an element: their gradients, strains and stresses at its points.
//!
//! ```text
//! ε(a) = sym ∇a        ε₂(a,b) = sym(∇aᵀ ∇b)        C:ε = λ tr(ε) + 2μ ε
//! ```

use faer::MatRef;
use nalgebra::Matrix3;

use crate::element::integration::IntegrationPoint;
use crate::error::{AssemblyError, AssemblyFault};
use crate::material::Material;
use crate::mesh::checked::Mesh;

/// Nodes of an element besides its first.
pub(crate) const OTHERS: usize = 9;

/// Refuses a field whose rows are not the degrees of freedom, or with an entry that is not finite.
pub(crate) fn check_field(mesh: &Mesh, what: &'static str, field: MatRef<'_, f64>) -> Result<(), AssemblyError> {
    let expected = 3 * mesh.positions().len();
    if field.nrows() != expected {
        return Err(AssemblyFault::FieldRows { what, expected, found: field.nrows() }.into());
    }
    for (column, values) in field.col_iter().enumerate() {
        if let Some((row, found)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(AssemblyFault::FieldNotFinite { what, row, column, found: *found }.into());
        }
    }
    Ok(())
}

/// Displacements of the nodes 1 to 9 of an element against node 0: by node, then axis, then column of `fields`.
#[inline]
pub(crate) fn relative_displacements(fields: MatRef<'_, f64>, nodes: &[u32; 10]) -> Vec<f64> {
    let first = 3 * nodes[0] as usize;
    let mut relative = Vec::with_capacity(3 * OTHERS * fields.ncols());
    for node in &nodes[1..] {
        for axis in 0..3 {
            let row = 3 * *node as usize + axis;
            relative.extend((0..fields.ncols()).map(|k| fields[(row, k)] - fields[(first + axis, k)]));
        }
    }
    relative
}

/// ∇u of each field at a point, `(∇u)_ab = ∂u_a/∂x_b`. `relative` is by node, then axis, then field.
#[inline]
pub(crate) fn displacement_gradients(
    relative: &[f64],
    point: &IntegrationPoint,
    count: usize,
    out: &mut Vec<Matrix3<f64>>,
) {
    out.clear();
    out.resize(count, Matrix3::zeros());
    for (node, gradient) in point.gradients[1..].iter().enumerate() {
        for axis in 0..3 {
            let of_fields = &relative[(3 * node + axis) * count..(3 * node + axis + 1) * count];
            for (sum, u) in out.iter_mut().zip(of_fields) {
                for b in 0..3 {
                    sum[(axis, b)] += u * gradient[b];
                }
            }
        }
    }
}

#[inline]
pub(crate) fn strain(gradient: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (gradient + gradient.transpose())
}

#[inline]
pub(crate) fn second_strain(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Matrix3<f64> {
    strain(&(a.transpose() * b))
}

#[inline]
pub(crate) fn stress(material: &Material, strain: &Matrix3<f64>) -> Matrix3<f64> {
    let (lambda, mu) = material.lame();
    lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain
}
