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
use pulp::Arch;
use rayon::prelude::*;

use crate::deformation::{OTHERS, check_field};
use crate::error::AssemblyError;
use crate::integration::{IntegrationPoint, Rules};
use crate::lanes::{Grouped, LANES, Lanes, Tensors, gradient};
use crate::material::Materials;
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
    element_forces(mesh, materials, fields, pairs, |[a, of_a], [b, of_b], lame| {
        a.second_strain(b).stress(lame).plus(&b.times(of_a)).plus(&a.times(of_b))
    })
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
    let pairs: Vec<[usize; 2]> = (0..columns).map(|field| [field, columns]).collect();
    element_forces(mesh, materials, all.as_ref(), &pairs, |[a, _], [_, of_u], _| a.times(of_u))
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
    if quadruples.is_empty() {
        return Ok(Vec::new());
    }
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
    let (arch, fields, groups) = (Arch::new(), Grouped::new(fields), in_groups(&pairs));
    // A row for each pair, with the products of its stress and the strains of all pairs.
    let of_element = |e: usize| -> Vec<Lanes> {
        let points = rules.fine_points(&mesh.element_positions(e));
        let mut rows = vec![[0.0; LANES]; LANES * groups.len() * groups.len()];
        arch.dispatch(|| {
            let mut here = AtPoint::new(&fields, &mesh.elements()[e]);
            let mut strains = Vec::with_capacity(groups.len());
            for point in &points {
                let lame = materials[e].lame();
                here.go_to(point, lame);
                strains.clear();
                for pairs in &groups {
                    let (a, b) = (here.gathered(pairs, 0, GRADIENT), here.gathered(pairs, 1, GRADIENT));
                    strains.push(a.second_strain(&b));
                }
                for (pair, row) in rows.chunks_exact_mut(groups.len()).enumerate() {
                    let strain = strains[pair / LANES].all_alike(pair % LANES);
                    let stress = strain.stress(lame).scaled(point.volume);
                    for (sums, strain) in row.iter_mut().zip(&strains) {
                        add_dots(sums, &stress, strain);
                    }
                }
            }
        });
        rows
    };
    let mut sums = vec![[0.0; LANES]; LANES * groups.len() * groups.len()];
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    for block in elements.chunks(BLOCK) {
        let parts: Vec<Vec<Lanes>> = block.par_iter().map(|e| of_element(*e)).collect();
        for part in parts {
            for (sum, part) in sums.as_flattened_mut().iter_mut().zip(part.as_flattened()) {
                *sum += part;
            }
        }
    }
    let energy = |[first, second]: &[usize; 2]| sums[first * groups.len() + second / LANES][second % LANES];
    Ok(products.iter().map(energy).collect())
}

const GRADIENT: usize = 0;
const STRESS: usize = 1;

/// Pairs of fields in groups; the last group is filled up with its last pair.
fn in_groups(pairs: &[[usize; 2]]) -> Vec<[[usize; 2]; LANES]> {
    let group = |pairs: &[[usize; 2]]| std::array::from_fn(|lane| pairs[lane.min(pairs.len() - 1)]);
    pairs.chunks(LANES).map(group).collect()
}

/// The fields of an element at one of its points.
struct AtPoint {
    relative: Vec<[[Lanes; 3]; OTHERS]>,
    /// ∇u and C:ε(u) of each group, by [`GRADIENT`] and [`STRESS`].
    of_groups: Vec<[Tensors; 2]>,
}

impl AtPoint {
    #[inline(always)]
    fn new(fields: &Grouped, nodes: &[u32; 10]) -> Self {
        let mut relative = Vec::with_capacity(fields.groups);
        fields.relative(nodes, &mut relative);
        Self { of_groups: Vec::with_capacity(relative.len()), relative }
    }

    #[inline(always)]
    fn go_to(&mut self, point: &IntegrationPoint, lame: (f64, f64)) {
        self.of_groups.clear();
        for relative in &self.relative {
            self.of_groups.push(gradient(relative, point).with_stress(lame));
        }
    }

    /// ∇u or C:ε(u) of the first or of the second field of each of four pairs.
    #[inline(always)]
    fn gathered(&self, pairs: &[[usize; 2]; LANES], which: usize, what: usize) -> Tensors {
        let mut found = Tensors::ZERO;
        for (lane, pair) in pairs.iter().enumerate() {
            let field = pair[which];
            let from = &self.of_groups[field / LANES][what];
            for (to, from) in found.0.as_flattened_mut().iter_mut().zip(from.0.as_flattened()) {
                to[lane] = from[field % LANES];
            }
        }
        found
    }
}

/// Adds A:B of the one matrix `a` and of the four in `b` in a row of `sums`.
#[inline(always)]
fn add_dots(sums: &mut Lanes, a: &Tensors, b: &Tensors) {
    for (a, b) in a.0.as_flattened().iter().zip(b.0.as_flattened()) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
}

/// Forces (N×pairs) whose virtual work is `Σ ∫ ∇v : P dV`; `force` gives the matrix P of a pair of fields, which is a sum of
/// products of two gradients, from ∇u and C:ε(u) of the first and of the second field and from Lamé's λ and μ.
fn element_forces(
    mesh: &Mesh,
    materials: &Materials,
    fields: MatRef<'_, f64>,
    pairs: &[[usize; 2]],
    force: impl Fn(&[Tensors; 2], &[Tensors; 2], (f64, f64)) -> Tensors + Sync,
) -> Result<Mat<f64>, AssemblyError> {
    check_field(mesh, "fields", fields)?;
    let materials = materials.of_elements(mesh)?;
    if pairs.is_empty() {
        return Ok(Mat::zeros(fields.nrows(), 0));
    }
    let rules = Rules::new();
    let (arch, fields, groups) = (Arch::new(), Grouped::new(fields), in_groups(pairs));
    // By node but the first, then axis, then group of pairs.
    let of_element = |e: usize| -> Vec<Lanes> {
        let points = rules.cubic_points(&mesh.element_positions(e));
        let mut sums = vec![[0.0; LANES]; 3 * OTHERS * groups.len()];
        arch.dispatch(|| {
            let mut here = AtPoint::new(&fields, &mesh.elements()[e]);
            for point in &points {
                let lame = materials[e].lame();
                here.go_to(point, lame);
                for (group, pairs) in groups.iter().enumerate() {
                    let a = [here.gathered(pairs, 0, GRADIENT), here.gathered(pairs, 0, STRESS)];
                    let b = [here.gathered(pairs, 1, GRADIENT), here.gathered(pairs, 1, STRESS)];
                    let Tensors(force) = force(&a, &b, lame).scaled(point.volume);
                    for (sums, gradient) in sums.chunks_exact_mut(3 * groups.len()).zip(&point.gradients[1..]) {
                        for (axis, force) in force.iter().enumerate() {
                            let sum = &mut sums[axis * groups.len() + group];
                            for (force, gradient) in force.iter().zip(gradient) {
                                for lane in 0..LANES {
                                    sum[lane] += force[lane] * gradient;
                                }
                            }
                        }
                    }
                }
            }
        });
        sums
    };
    let rows = 3 * mesh.positions().len();
    let mut result = vec![[0.0; LANES]; rows * groups.len()];
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    for block in elements.chunks(BLOCK) {
        let parts: Vec<Vec<Lanes>> = block.par_iter().map(|e| of_element(*e)).collect();
        for (e, sums) in block.iter().zip(parts) {
            let nodes = &mesh.elements()[*e];
            for (node, forces) in nodes[1..].iter().zip(sums.chunks_exact(3 * groups.len())) {
                for (k, force) in forces.iter().enumerate() {
                    for (node, sign) in [(*node, 1.0), (nodes[0], -1.0)] {
                        let sum = &mut result[3 * groups.len() * node as usize + k];
                        for lane in 0..LANES {
                            sum[lane] += sign * force[lane];
                        }
                    }
                }
            }
        }
    }
    Ok(Mat::from_fn(rows, pairs.len(), |row, pair| result[row * groups.len() + pair / LANES][pair % LANES]))
}
