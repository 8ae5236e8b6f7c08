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
use faer::{Accum, Mat, MatRef, Par};
use pulp::Arch;
use rayon::prelude::*;

use crate::deformation::check_field;
use crate::error::AssemblyError;
use crate::integration::{IntegrationPoint, Rules};
use crate::lanes::{Grouped, LANES, Lanes, Tensors, gradient};
use crate::material::{Material, Materials};
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
    extended_geometric_stiffness(mesh, materials, displacements, shapes, terms, &[])
}

/// The same where the matrices `known` of the first of the shapes are known, one for each displacement field; none for no
/// shapes at all. Only what is new is computed.
///
/// # Errors
/// As [`reduced_geometric_stiffness`].
///
/// # Panics
/// Where `known` are not as many as the displacements, of one size, or larger than the shapes are many.
pub fn extended_geometric_stiffness(
    mesh: &Mesh,
    materials: &Materials,
    displacements: MatRef<'_, f64>,
    shapes: MatRef<'_, f64>,
    terms: GeometricTerms,
    known: &[Mat<f64>],
) -> Result<Vec<Mat<f64>>, AssemblyError> {
    check_field(mesh, "displacements", displacements)?;
    check_field(mesh, "shapes", shapes)?;
    assert!(known.is_empty() || known.len() == displacements.ncols());
    let first = known.first().map_or(0, Mat::ncols);
    assert!(first <= shapes.ncols() && known.iter().all(|known| known.nrows() == first && known.ncols() == first));
    let materials = materials.of_elements(mesh)?;
    let f = shapes.ncols();
    if f == first {
        return Ok(if known.is_empty() { vec![Mat::zeros(0, 0); displacements.ncols()] } else { known.to_vec() });
    }
    let bytes = f.saturating_mul(f).saturating_mul(8 * PARTS * displacements.ncols());
    let copies = 8 * shapes.nrows() * (f + displacements.ncols() + 2 * LANES);
    memory::check("the geometric stiffness", bytes.saturating_add(copies))?;
    // The columns of the shapes that are new.
    let zeros = || vec![Mat::<f64>::zeros(f, f - first); displacements.ncols()];
    let rules = Rules::new();
    let arch = Arch::new();
    let (shapes, displacements) = (Grouped::new(shapes), Grouped::new(displacements));
    let elements: Vec<usize> = (0..mesh.elements().len()).collect();
    let parts: Vec<Vec<Mat<f64>>> = elements
        .par_chunks(elements.len().div_ceil(PARTS))
        .map(|part| {
            let mut sums = zeros();
            let mut here = Block::default();
            let mut products: Vec<Lanes> = Vec::new();
            for block in part.chunks(BLOCK) {
                let of_element = |e: &usize| (*e, rules.cubic_points(&mesh.element_positions(*e)));
                let points: Vec<(usize, Vec<IntegrationPoint>)> = block.iter().map(of_element).collect();
                arch.dispatch(|| here.fill(mesh, &materials, &points, &shapes, &displacements));
                products.resize(here.gradients.len(), [0.0; LANES]);
                for (u, sum) in sums.iter_mut().enumerate() {
                    arch.dispatch(|| here.products(u, terms, first / LANES, &mut products));
                    let (gradients, products) = (matrix(&here.gradients, f), matrix(&products, f));
                    let new = products.subcols(first, f - first);
                    matmul(sum.as_mut(), Accum::Add, gradients.transpose(), new, 1.0, Par::Seq);
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
    let full = |(u, new): (usize, &Mat<f64>)| {
        Mat::from_fn(f, f, |i, j| {
            let (row, column) = (i.max(j), i.min(j));
            if row < first {
                known[u][(i, j)]
            } else if column < first {
                new[(column, row - first)]
            } else {
                new[(row, column - first)]
            }
        })
    };
    Ok(sums.iter().enumerate().map(full).collect())
}

/// Rows of groups as a matrix of `columns` columns.
fn matrix(groups: &[Lanes], columns: usize) -> MatRef<'_, f64> {
    let width = LANES * columns.div_ceil(LANES);
    let numbers = groups.as_flattened();
    MatRef::from_row_major_slice(numbers, numbers.len() / width, width).subcols(0, columns)
}

/// The fields at the points of a few elements.
#[derive(Default)]
struct Block {
    /// Lamé's λ and μ at each point.
    lame: Vec<(f64, f64)>,
    /// Groups of shapes.
    groups: usize,
    /// ∇a of the shapes: nine rows for each point, a column for each group.
    gradients: Vec<Lanes>,
    /// ∇a and C:ε(a): for each point those of all groups.
    of_shapes: Vec<[Tensors; 2]>,
    /// Groups of displacements.
    groups_of_displacements: usize,
    /// ∇u and C:ε(u), times the volume of the point: for each point those of all groups.
    of_displacements: Vec<[Tensors; 2]>,
}

impl Block {
    #[inline(always)]
    fn fill(
        &mut self,
        mesh: &Mesh,
        materials: &[Material],
        elements: &[(usize, Vec<IntegrationPoint>)],
        shapes: &Grouped,
        displacements: &Grouped,
    ) {
        let count: usize = elements.iter().map(|(_, points)| points.len()).sum();
        (self.groups, self.groups_of_displacements) = (shapes.groups, displacements.groups);
        self.lame.clear();
        self.of_shapes.clear();
        self.of_displacements.clear();
        self.gradients.resize(9 * count * shapes.groups, [0.0; LANES]);
        let mut rows = self.gradients.chunks_exact_mut(9 * shapes.groups);
        let (mut of_shapes, mut of_displacements) = (Vec::new(), Vec::new());
        for (e, points) in elements {
            let lame = materials[*e].lame();
            shapes.relative(&mesh.elements()[*e], &mut of_shapes);
            displacements.relative(&mesh.elements()[*e], &mut of_displacements);
            for (point, rows) in points.iter().zip(&mut rows) {
                self.lame.push(lame);
                for (group, relative) in of_shapes.iter().enumerate() {
                    let gradient = gradient(relative, point);
                    gradient.store(rows, shapes.groups, group);
                    self.of_shapes.push(gradient.with_stress(lame));
                }
                for relative in &of_displacements {
                    self.of_displacements.push(gradient(relative, point).scaled(point.volume).with_stress(lame));
                }
            }
        }
    }

    /// P_a of the shapes from a group on for the displacement `u`, laid out as the gradients.
    #[inline(always)]
    fn products(&self, u: usize, terms: GeometricTerms, from: usize, out: &mut [Lanes]) {
        let points = out.chunks_exact_mut(9 * self.groups).zip(self.of_shapes.chunks_exact(self.groups));
        let displacements = self.of_displacements.chunks_exact(self.groups_of_displacements);
        for (((rows, of_shapes), of_displacements), lame) in points.zip(displacements).zip(&self.lame) {
            let [gradients, stresses] = &of_displacements[u / LANES];
            let (u, of_u) = (gradients.all_alike(u % LANES), stresses.all_alike(u % LANES));
            for (group, [a, of_a]) in of_shapes.iter().enumerate().skip(from) {
                let initial_stress = a.times(&of_u);
                let product = match terms {
                    GeometricTerms::InitialStress => initial_stress,
                    GeometricTerms::All => initial_stress.plus(&u.times(of_a)).plus(&u.second_strain(a).stress(*lame)),
                };
                product.store(rows, self.groups, group);
            }
        }
    }
}
