//! What a St. Venant–Kirchhoff body adds to the linear one: the strain of second order, its forces and its energy.
//!
//! ```text
//! E = ε(u) + ½ ε₂(u,u)        ε(a) = sym ∇a        ε₂(a,b) = sym(∇aᵀ ∇b)        W = ½ ∫ E : C : E dV
//!
//! v·g_ab = ∫ ε(v):C:ε₂(a,b) + ε(a):C:ε₂(v,b) + ε(b):C:ε₂(v,a) dV        g_ab = ∂²f_int/∂q_a∂q_b at rest
//! ```
//!
//! All integrands are sums of products of ∇v with a matrix P, so a force on a node is `∫ P ∇N_i dV`. As in the reduced
//! geometric stiffness, displacements count against the element's first node, whose force is what balances the others.

use faer::{Mat, MatRef};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::deformation::{
    OTHERS, check_field, displacement_gradients, relative_displacements, second_strain, strain, stress,
};
use crate::error::AssemblyError;
use crate::integration::Rules;
use crate::material::{Material, Materials};
use crate::mesh::Mesh;

/// Elements whose forces are held at once, before they are added in the order of the elements: the sums are the same for
/// any number of threads.
const BLOCK: usize = 1024;

/// The forces g_ab (N×p, force per squared unit of the fields) of each pair (a, b) of columns of `fields` (N×k, length,
/// row `3·node + axis`): the second derivatives of the internal forces of a St. Venant–Kirchhoff body at rest.
///
/// `u·g_ab` is symmetric in u, a and b. With `r = ω × X`, `g_rb = ω × K b − K (ω × b)`.
///
/// # Errors
/// Materials that do not fit the mesh; fields whose rows are not the degrees of freedom, or with an entry that is not
/// finite.
///
/// # Panics
/// Where a pair names a column that `fields` does not have.
pub fn second_order_forces(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    pairs: &[[usize; 2]],
) -> Result<Mat<f64>, AssemblyError> {
    let forces =
        |Deformation { gradients, stresses }: &Deformation, material: &Material, out: &mut Vec<Matrix3<f64>>| {
            for [a, b] in pairs {
                let of_second = stress(material, &second_strain(&gradients[*a], &gradients[*b]));
                out.push(of_second + gradients[*b] * stresses[*a] + gradients[*a] * stresses[*b]);
            }
        };
    element_forces(mesh, materials, fields, pairs.len(), forces)
}

/// `K(u) V` (N×k, force) for the columns V of `fields` (N×k, length), where K(u) is the initial stress of `displacement`
/// (N×1, length), as in [`reduced_geometric_stiffness`](crate::reduced_geometric_stiffness).
///
/// # Errors
/// As [`second_order_forces`].
pub fn geometric_stiffness_product(
    mesh: &Mesh,
    materials: &Materials,
    displacement: MatRef<'_, f64>,
    fields: MatRef<'_, f64>,
) -> Result<Mat<f64>, AssemblyError> {
    check_field(mesh, "displacements", displacement)?;
    check_field(mesh, "fields", fields)?;
    let columns = fields.ncols();
    let column = |i: usize, j: usize| if j < columns { fields[(i, j)] } else { displacement[(i, 0)] };
    let all = Mat::from_fn(fields.nrows(), columns + 1, column);
    let forces = |Deformation { gradients, stresses }: &Deformation, _: &Material, out: &mut Vec<Matrix3<f64>>| {
        out.extend(gradients[..columns].iter().map(|gradient| gradient * stresses[columns]));
    };
    element_forces(mesh, materials, all.as_ref(), columns, forces)
}

/// `∫ ε₂(a,b) : C : ε₂(c,d) dV` (energy, one for each of `quadruples`) of columns a, b, c, d of `fields` (N×k, length).
///
/// An eighth of it, with all four alike, is the strain energy of fourth order of `u`, before the body has found the
/// displacements of second order that relieve it.
///
/// # Errors
/// As [`second_order_forces`].
///
/// # Panics
/// Where a quadruple names a column that `fields` does not have.
pub fn second_order_energies(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    quadruples: &[[usize; 4]],
) -> Result<Vec<f64>, AssemblyError> {
    check_field(mesh, "fields", fields)?;
    let materials = materials.of_elements(mesh)?;
    let rules = Rules::new();
    // The strain and the stress of a pair are found once at a point, in how many quadruples it may be.
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    let mut number = |a: usize, b: usize| {
        let pair = [a.min(b), a.max(b)];
        pairs.iter().position(|other| *other == pair).unwrap_or_else(|| {
            pairs.push(pair);
            pairs.len() - 1
        })
    };
    let products: Vec<[usize; 2]> = quadruples.iter().map(|[a, b, c, d]| [number(*a, *b), number(*c, *d)]).collect();
    let of_element = |e: usize| -> Vec<f64> {
        let relative = relative_displacements(fields, &mesh.elements()[e]);
        let mut gradients = Vec::with_capacity(fields.ncols());
        let mut of_pairs = Vec::with_capacity(pairs.len());
        let mut energies = vec![0.0; quadruples.len()];
        for point in rules.fine_points(&mesh.element_positions(e)) {
            displacement_gradients(&relative, &point, fields.ncols(), &mut gradients);
            of_pairs.clear();
            of_pairs.extend(pairs.iter().map(|[a, b]| {
                let strain = second_strain(&gradients[*a], &gradients[*b]);
                (strain, stress(&materials[e], &strain) * point.volume)
            }));
            for (energy, [first, second]) in energies.iter_mut().zip(&products) {
                *energy += of_pairs[*first].1.dot(&of_pairs[*second].0);
            }
        }
        energies
    };
    let mut sums = vec![0.0; quadruples.len()];
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    for block in elements.chunks(BLOCK) {
        let parts: Vec<Vec<f64>> = block.par_iter().map(|e| of_element(*e)).collect();
        for part in parts {
            sums.iter_mut().zip(part).for_each(|(sum, energy)| *sum += energy);
        }
    }
    Ok(sums)
}

/// The fields at a point: ∇u and C:ε(u) of each.
struct Deformation {
    gradients: Vec<Matrix3<f64>>,
    stresses: Vec<Matrix3<f64>>,
}

/// Forces (N×outputs) whose virtual work is `Σ ∫ ∇v : P dV`; `forces` gives the `outputs` matrices P of a point, which are
/// products of two gradients, from the fields there.
fn element_forces(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    outputs: usize,
    forces: impl Fn(&Deformation, &Material, &mut Vec<Matrix3<f64>>) + Sync,
) -> Result<Mat<f64>, AssemblyError> {
    check_field(mesh, "fields", fields)?;
    let materials = materials.of_elements(mesh)?;
    let rules = Rules::new();
    // By output, then node but the first.
    let of_element = |e: usize| -> Vec<Vector3<f64>> {
        let relative = relative_displacements(fields, &mesh.elements()[e]);
        let mut fields_here = Deformation { gradients: Vec::new(), stresses: Vec::new() };
        let mut matrices = Vec::with_capacity(outputs);
        let mut sums = vec![Vector3::zeros(); outputs * OTHERS];
        for point in rules.cubic_points(&mesh.element_positions(e)) {
            let Deformation { gradients, stresses } = &mut fields_here;
            displacement_gradients(&relative, &point, fields.ncols(), gradients);
            stresses.clear();
            stresses.extend(gradients.iter().map(|gradient| stress(&materials[e], &strain(gradient))));
            matrices.clear();
            forces(&fields_here, &materials[e], &mut matrices);
            for (sums, matrix) in sums.chunks_exact_mut(OTHERS).zip(&matrices) {
                let matrix = matrix * point.volume;
                for (sum, gradient) in sums.iter_mut().zip(&point.gradients[1..]) {
                    *sum += matrix * Vector3::from(*gradient);
                }
            }
        }
        sums
    };
    let mut result = Mat::zeros(fields.nrows(), outputs);
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    for block in elements.chunks(BLOCK) {
        let parts: Vec<Vec<Vector3<f64>>> = block.par_iter().map(|e| of_element(*e)).collect();
        for (e, sums) in block.iter().zip(parts) {
            let nodes = &mesh.elements()[*e];
            for (output, sums) in sums.chunks_exact(OTHERS).enumerate() {
                for (node, force) in nodes[1..].iter().zip(sums) {
                    for axis in 0..3 {
                        result[(3 * *node as usize + axis, output)] += force[axis];
                        result[(3 * nodes[0] as usize + axis, output)] -= force[axis];
                    }
                }
            }
        }
    }
    Ok(result)
}
