//! Geometric stiffness: what a small displacement u adds to the tangent stiffness, reduced to a few shapes.
//!
//! ```text
//! K(u)_ab = ∫ ε(u):C:ε₂(a,b) + ε(a):C:ε₂(u,b) + ε(b):C:ε₂(u,a) dV        reduced: Ψᵀ K(u) Ψ
//! ```
//!
//! The first term is the initial stress, the other two are the initial displacement: together the third derivative of the
//! strain energy of a St. Venant–Kirchhoff body along u. The terms of the initial displacement couple bending to
//! stretching, where their effect is of second order in u and others of that order, which are not there, balance it: a
//! body that u bends by more than its thickness may lose all stiffness by them.
//!
//! K(u) of the whole body is never made. In an element its rows sum to zero over the nodes, so only displacements
//! *against the element's first node* count. With those, a translation of the element drops out exactly, and rounding is
//! measured against the deformation and not against the motion.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::error::AssemblyError;
use crate::integration::{IntegrationPoint, Rules};
use crate::material::{Material, Materials};
use crate::mesh::Mesh;

/// The elements are cut into so many parts, whatever the number of threads, and the parts are summed in their order.
const PARTS: usize = 64;
/// Elements that are multiplied at once.
const BLOCK: usize = 32;
/// Nodes of an element besides its first.
pub(crate) const OTHERS: usize = 9;
/// Their displacements.
const FREEDOMS: usize = 3 * OTHERS;

/// Which terms of K(u) are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GeometricTerms {
    /// The initial stress.
    InitialStress,
    /// The initial stress and the initial displacement.
    All,
}

/// For each displacement field u (column of `displacements`, N×s with N = 3n, length) the matrix `Ψᵀ K(u) Ψ` (f×f, force
/// per length), where Ψ is `shapes` (N×f, row `3·node + axis`). Symmetric to the last bit, and the same for any number of
/// threads. `v·K(u)·b` is also `u·g_vb` of [`second_order_forces`](crate::second_order_forces).
///
/// Exact on straight elements. On curved ones by the rule that [`assemble`](crate::assemble) has for them, so that
/// `K(u) (θ × X) = θ × K u − K (θ × u)`, of the initial stress alone `θ × K u`, holds at every node there too, for any small rotation θ.
///
/// It holds 64·s·f² numbers, and for each thread the products of 32 elements: no more for a larger mesh.
///
/// # Errors
/// Materials that do not fit the mesh; a matrix whose rows are not the degrees of freedom, or with an entry that is not
/// finite.
pub fn reduced_geometric_stiffness(
    mesh: &Mesh,
    materials: &Materials,
    displacements: MatRef<'_, f64>,
    shapes: MatRef<'_, f64>,
    terms: GeometricTerms,
) -> Result<Vec<Mat<f64>>, AssemblyError> {
    check_field(mesh, "displacements", displacements)?;
    check_field(mesh, "shapes", shapes)?;
    let materials = materials.of_elements(mesh)?;
    let f = shapes.ncols();
    memory::check("the geometric stiffness", f.saturating_mul(f).saturating_mul(8 * PARTS * displacements.ncols()))?;
    let zeros = || vec![Mat::<f64>::zeros(f, f); displacements.ncols()];
    let rules = Rules::new();
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    let parts: Vec<Vec<Mat<f64>>> = elements
        .par_chunks(elements.len().div_ceil(PARTS))
        .map(|part| {
            let mut sums = zeros();
            for block in part.chunks(BLOCK) {
                let relative: Vec<f64> =
                    block.iter().flat_map(|e| relative_displacements(shapes, &mesh.elements()[*e])).collect();
                let points: Vec<_> = block.iter().map(|e| rules.fine_points(&mesh.element_positions(*e))).collect();
                let mut forces = vec![0.0; relative.len()];
                for (sum, u) in sums.iter_mut().zip(displacements.col_iter()) {
                    for (i, e) in block.iter().enumerate() {
                        let u = relative_displacements(u.as_mat(), &mesh.elements()[*e]);
                        let stiffness = element_stiffness(&points[i], &materials[*e], &u, terms);
                        let of_element = i * f * FREEDOMS..(i + 1) * f * FREEDOMS;
                        matmul(
                            MatMut::from_column_major_slice_mut(&mut forces[of_element.clone()], f, FREEDOMS),
                            Accum::Replace,
                            MatRef::from_column_major_slice(&relative[of_element], f, FREEDOMS),
                            MatRef::from_column_major_slice(stiffness.as_flattened(), FREEDOMS, FREEDOMS),
                            1.0,
                            Par::Seq,
                        );
                    }
                    let columns = FREEDOMS * block.len();
                    triangular::matmul(
                        sum.as_mut(),
                        BlockStructure::TriangularLower,
                        Accum::Add,
                        MatRef::from_column_major_slice(&relative, f, columns),
                        BlockStructure::Rectangular,
                        MatRef::from_column_major_slice(&forces, f, columns).transpose(),
                        BlockStructure::Rectangular,
                        1.0,
                        Par::Seq,
                    );
                }
            }
            sums
        })
        .collect();
    let mut sums = zeros();
    for part in parts {
        for (sum, part) in sums.iter_mut().zip(part) {
            *sum += part;
        }
    }
    for sum in &mut sums {
        for j in 0..f {
            for i in 0..j {
                sum[(i, j)] = sum[(j, i)];
            }
        }
    }
    Ok(sums)
}

pub(crate) fn check_field(mesh: &Mesh, what: &'static str, field: MatRef<'_, f64>) -> Result<(), AssemblyError> {
    let expected = 3 * mesh.positions().len();
    if field.nrows() != expected {
        return Err(AssemblyError::FieldRows { what, expected, found: field.nrows() });
    }
    for (column, values) in field.col_iter().enumerate() {
        if let Some((row, found)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(AssemblyError::FieldNotFinite { what, row, column, found: *found });
        }
    }
    Ok(())
}

/// Displacements of the nodes 1 to 9 of an element against node 0: by node, then axis, then column of `fields`.
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

/// K(u) of an element for the displacements of its nodes 1 to 9 against node 0, of which `relative` are those of u. Rows
/// and columns are by node, then axis.
///
/// With H = ∇u, whose row a is h_a, and g_i = ∇N_i, the displacement e_a N_i has `ε₂(u, e_a N_i) = sym(h_a g_iᵀ)`.
fn element_stiffness(
    points: &[IntegrationPoint],
    material: &Material,
    relative: &[f64],
    terms: GeometricTerms,
) -> [[f64; FREEDOMS]; FREEDOMS] {
    let (lambda, mu) = material.lame();
    let mut stiffness = [[0.0; FREEDOMS]; FREEDOMS];
    for point in points {
        let gradients: [Vector3<f64>; OTHERS] = std::array::from_fn(|i| point.gradients[i + 1].into());
        let mut displacement_gradient = Matrix3::zeros();
        for (u, gradient) in relative.chunks_exact(3).zip(&gradients) {
            displacement_gradient += Vector3::new(u[0], u[1], u[2]) * gradient.transpose();
        }
        let strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
        let stress = (lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain) * point.volume;
        let (lambda, mu) = (lambda * point.volume, mu * point.volume);
        let turned = gradients.map(|gradient| displacement_gradient * gradient);
        let both = mu * (displacement_gradient + displacement_gradient.transpose());
        for j in 0..OTHERS {
            let (g_j, turned_j) = (&gradients[j], &turned[j]);
            let traction = stress * g_j;
            for i in 0..=j {
                let (g_i, turned_i) = (&gradients[i], &turned[i]);
                let (initial_stress, product) = (g_i.dot(&traction), g_i.dot(g_j));
                for b in 0..3 {
                    stiffness[3 * j + b][3 * i + b] += initial_stress;
                }
                if terms == GeometricTerms::InitialStress {
                    continue;
                }
                for b in 0..3 {
                    for a in 0..3 {
                        // ε(a):C:ε₂(u,b), and the same with a and b in each other's place.
                        stiffness[3 * j + b][3 * i + a] += lambda * (g_i[a] * turned_j[b] + turned_i[a] * g_j[b])
                            + mu * (turned_i[b] * g_j[a] + turned_j[a] * g_i[b])
                            + both[(a, b)] * product;
                    }
                }
            }
        }
    }
    for row in 1..FREEDOMS {
        let (above, below) = stiffness.split_at_mut(row);
        above.iter_mut().zip(&below[0]).for_each(|(upper, lower)| upper[row] = *lower);
    }
    stiffness
}
