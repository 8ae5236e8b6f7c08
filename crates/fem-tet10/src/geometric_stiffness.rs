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

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, ColRef, Mat, MatRef, Par};
use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::deformation::{check_field, second_strain, strain, stress};
use crate::error::AssemblyError;
use crate::integration::{IntegrationPoint, Rules};
use crate::material::Materials;
use crate::mesh::Mesh;

/// The elements are cut into so many parts, whatever the number of threads, and the parts are summed in their order.
const PARTS: usize = 64;
/// Elements that are multiplied at once.
const BLOCK: usize = 8;

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
/// With the gradients at the integration points, K(u)_ab is `Σ P_a : ∇b` with
/// `P_a = ∇a C:ε(u) + ∇u C:ε(a) + C:ε₂(u,a)`: gradients and stresses of the shapes are found once for all u.
///
/// Exact on straight elements. On curved ones by the rule that [`assemble`](crate::assemble) has for them, so that
/// `K(u) (θ × X) = θ × K u − K (θ × u)`, of the initial stress alone `θ × K u`, holds at every node there too, for any small rotation θ.
///
/// It holds 64·s·f² numbers, and for each thread the gradients in 8 elements: no more for a larger mesh.
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
                let points: Vec<(usize, IntegrationPoint)> = block
                    .iter()
                    .flat_map(|e| {
                        rules.cubic_points(&mesh.element_positions(*e)).into_iter().map(move |point| (*e, point))
                    })
                    .collect();
                let of_shapes: Vec<[[f64; 3]; 3]> =
                    shapes.col_iter().flat_map(|shape| gradients(shape, mesh, &points)).collect();
                let stresses: Vec<Matrix3<f64>> = match terms {
                    GeometricTerms::InitialStress => Vec::new(),
                    GeometricTerms::All => {
                        let of_points = of_shapes.iter().zip(points.iter().cycle());
                        of_points.map(|(a, (e, _))| stress(&materials[*e], &strain(&Matrix3::from(*a)))).collect()
                    }
                };
                let mut products = vec![[[0.0; 3]; 3]; of_shapes.len()];
                for (sum, u) in sums.iter_mut().zip(displacements.col_iter()) {
                    let of_u: Vec<(Matrix3<f64>, Matrix3<f64>)> = gradients(u, mesh, &points)
                        .zip(&points)
                        .map(|(gradient, (e, point))| {
                            let gradient = Matrix3::from(gradient) * point.volume;
                            (gradient, stress(&materials[*e], &strain(&gradient)))
                        })
                        .collect();
                    let here = || of_u.iter().zip(&points).cycle();
                    let of_both = products.iter_mut().zip(&of_shapes);
                    match terms {
                        GeometricTerms::InitialStress => {
                            for ((product, a), ((_, of_u), _)) in of_both.zip(here()) {
                                *product = (Matrix3::from(*a) * of_u).into();
                            }
                        }
                        GeometricTerms::All => {
                            for (((product, a), of_a), ((u, of_u), (e, _))) in of_both.zip(&stresses).zip(here()) {
                                let a = Matrix3::from(*a);
                                let of_second = stress(&materials[*e], &second_strain(u, &a));
                                *product = (a * of_u + u * of_a + of_second).into();
                            }
                        }
                    }
                    let rows = 9 * points.len();
                    triangular::matmul(
                        sum.as_mut(),
                        BlockStructure::TriangularLower,
                        Accum::Add,
                        MatRef::from_column_major_slice(of_shapes.as_flattened().as_flattened(), rows, f).transpose(),
                        BlockStructure::Rectangular,
                        MatRef::from_column_major_slice(products.as_flattened().as_flattened(), rows, f),
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

/// ∇u of a field at points of elements, column by column; displacements count against the element's first node.
fn gradients<'a>(
    field: ColRef<'a, f64>,
    mesh: &'a Mesh,
    points: &'a [(usize, IntegrationPoint)],
) -> impl Iterator<Item = [[f64; 3]; 3]> + 'a {
    points.iter().map(move |(e, point)| {
        let nodes = mesh.elements()[*e].map(|node| 3 * node as usize);
        let mut sum = [[0.0; 3]; 3];
        for (node, gradient) in nodes[1..].iter().zip(&point.gradients[1..]) {
            let u: [f64; 3] = std::array::from_fn(|axis| field[node + axis] - field[nodes[0] + axis]);
            for (sum, gradient) in sum.iter_mut().zip(gradient) {
                for (sum, u) in sum.iter_mut().zip(u) {
                    *sum += u * gradient;
                }
            }
        }
        sum
    })
}
