//! Geometric stiffness: what the stress of a small displacement u adds to the tangent stiffness, reduced to a few shapes.
//!
//! ```text
//! K(u)_ab = ∫ ε(u):C:ε₂(a,b) dV        reduced: Ψᵀ K(u) Ψ
//! ```
//!
//! About a reference u₀ with F₀ = 1 + ∇u₀ the stress is that of a small change u of it: sym(F₀ᵀ∇u) is in the place of ε(u).
//!
//! K(u) of the whole body is never made. In an element its rows sum to zero over the nodes, so only displacements
//! *against the element's first node* count. With those, a translation of the element drops out exactly, and rounding is
//! measured against the deformation and not against the motion.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use crate::element::deformation::check_field;
use crate::element::integration::Rules;
use crate::element::lanes::{Group, GroupPoint, LANES, Lanes, PARTS, Rows, Tensors};
use crate::element::vectorized::vectorized;
use crate::error::AssemblyError;
use crate::material::{Material, Materials};
use crate::mesh::checked::Mesh;

/// Groups of elements that are multiplied at once.
const BLOCK: usize = 2;

/// For each displacement field u (column of `displacements`, N×s with N = 3n, length) the matrix `Ψᵀ K(u) Ψ` (f×f, force
/// per length), where Ψ is `shapes` (N×f, row `3·node + axis`). Symmetric to the last bit, and the same for any number of
/// threads.
///
/// With the gradients at the integration points, K(u)_ab is `Σ P_a : ∇b` with `P_a = ∇a C:ε(u)`: gradients of the shapes are
/// found once for all u.
///
/// Exact on straight elements. On curved ones by the rule that [`assemble`](crate::assemble) has for them, so that
/// `K(u) (θ × X) = θ × K u` holds at every node there too, for any small rotation θ.
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
) -> Result<Vec<Mat<f64>>, AssemblyError> {
    extended_geometric_stiffness(mesh, materials, displacements, shapes, &[], None)
}

/// The same where the matrices `known` of the first of the shapes are known, one for each displacement field; none for no
/// shapes at all. Only what is new is computed. With a `reference` (N×1) the displacements are small changes of it.
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
    known: &[Mat<f64>],
    reference: Option<MatRef<'_, f64>>,
) -> Result<Vec<Mat<f64>>, AssemblyError> {
    check_field(mesh, "displacements", displacements)?;
    if let Some(reference) = reference {
        check_field(mesh, "the reference", reference)?;
    }
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
    let copies = 8 * shapes.nrows() * (f + displacements.ncols());
    memory::check("the geometric stiffness", bytes.saturating_add(copies))?;
    // The columns of the shapes that are new.
    let zeros = || vec![Mat::<f64>::zeros(f, f - first); displacements.ncols()];
    let rules = Rules::new();
    let (shapes, displacements) = (Rows::new(shapes), Rows::new(displacements));
    let reference = reference.map(Rows::new);
    let groups = Group::all(mesh);
    let parts: Vec<Vec<Mat<f64>>> = groups
        .par_chunks(groups.len().div_ceil(PARTS))
        .map(|part| {
            let mut sums = zeros();
            let mut here = Block::default();
            let mut products = Vec::new();
            for groups in part.chunks(BLOCK) {
                vectorized(
                    #[inline(always)]
                    || here.fill(mesh, &materials, &rules, groups, [&shapes, &displacements], reference.as_ref()),
                );
                for (u, sum) in sums.iter_mut().enumerate() {
                    vectorized(
                        #[inline(always)]
                        || here.products(u, first, &mut products),
                    );
                    let rows = here.count;
                    let (gradients, products) = (matrix(&here.gradients, rows), matrix(&products, rows));
                    matmul(sum.as_mut(), Accum::Add, gradients.transpose(), products, 1.0, Par::Seq);
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

/// Matrices at some points as columns of their numbers.
fn matrix(tensors: &[[[Lanes; 3]; 3]], points: usize) -> MatRef<'_, f64> {
    let numbers = tensors.as_flattened().as_flattened().as_flattened();
    MatRef::from_column_major_slice(numbers, 9 * LANES * points, tensors.len() / points)
}

/// The fields at the points of a few groups of elements. All lists of matrices are by field, then point.
#[derive(Default)]
struct Block {
    /// Number of points.
    count: usize,
    /// ∇a of the shapes.
    gradients: Vec<[[Lanes; 3]; 3]>,
    /// C:ε(u) of the displacements, times the volume of the point.
    of_displacements: Vec<Tensors>,
}

impl Block {
    #[inline(always)]
    fn fill(
        &mut self,
        mesh: &Mesh,
        materials: &[Material],
        rules: &Rules,
        groups: &[Group],
        [shapes, displacements]: [&Rows; 2],
        reference: Option<&Rows>,
    ) {
        // Of a bent reference the stress is of the second degree.
        let points = |group: &Group| if reference.is_some() { rules.fine() } else { group.cubic_points(rules) };
        self.count = groups.iter().map(|group| points(group).len()).sum();
        self.gradients.resize(self.count * shapes.columns, Tensors::ZERO.0);
        self.of_displacements.resize(self.count * displacements.columns, Tensors::ZERO);
        let (mut of_shapes, mut of_displacements, mut of_reference, mut row) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for group in groups {
            let (lame, positions) = (group.lame(materials), group.positions(mesh));
            shapes.relative(mesh, group, &mut of_shapes);
            displacements.relative(mesh, group, &mut of_displacements);
            if let Some(reference) = reference {
                reference.relative(mesh, group, &mut of_reference);
            }
            for rule in points(group) {
                let point = GroupPoint::new(&positions, rule, group.count);
                for (a, relative) in of_shapes.iter().enumerate() {
                    self.gradients[self.count * a + row] = point.gradient(relative).0;
                }
                let bent = of_reference.first().map(|relative| point.gradient(relative));
                for (u, relative) in of_displacements.iter().enumerate() {
                    let gradient = point.gradient(relative).scaled(&point.volume);
                    self.of_displacements[self.count * u + row] = match &bent {
                        None => {
                            let [_, stress] = gradient.with_stress(&lame);
                            stress
                        }
                        Some(bent) => gradient.strain().plus(&bent.second_strain(&gradient)).stress(&lame),
                    };
                }
                row += 1;
            }
        }
    }

    /// P_a of the shapes from `first` on for the displacement `u`, laid out as the gradients.
    #[inline(always)]
    fn products(&self, u: usize, first: usize, out: &mut Vec<[[Lanes; 3]; 3]>) {
        let of_u = &self.of_displacements[self.count * u..][..self.count];
        out.resize(self.gradients.len() - self.count * first, Tensors::ZERO.0);
        let shapes = self.gradients.chunks_exact(self.count).skip(first);
        for (out, gradients) in out.chunks_exact_mut(self.count).zip(shapes) {
            for ((out, gradient), stress) in out.iter_mut().zip(gradients).zip(of_u) {
                *out = Tensors(*gradient).times(stress).0;
            }
        }
    }
}
