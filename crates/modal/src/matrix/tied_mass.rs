//! Masses at points beside the body that move as rigid parts of its nodes: `M = M_s ⊗ I₃ + Σ m Wᵀ W`.

use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, MatRef};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::ModalError;
use crate::matrix::mass::NodalMass;

/// An eigenvalue of the inertia of the nodes, relative to the largest, below which they do not tell the turn.
const LINE: f64 = 1e-10;
/// Error of a rigid motion at the point, relative to its arm, that is rounding.
const RIGID: f64 = 1e-9;

/// A mass at a point that moves with the rigid motion that fits the displacements of some nodes best (least squares).
#[derive(Debug, Clone, PartialEq)]
pub struct TiedPoint {
    /// The mass.
    pub mass: f64,
    /// The point, in the frame of the mesh.
    pub position: [f64; 3],
    /// The nodes.
    pub nodes: Vec<u32>,
    /// A matrix W_a for each node, with which the displacement of the point is `Σ W_a u_a`.
    pub shares: Vec<Matrix3<f64>>,
}

impl TiedPoint {
    /// The point of nodes, Eq. (M19) of `docs/method/modes.md`; `None` where they do not tell how it turns with them: a single one, or nodes on a line
    /// beside which it is.
    ///
    /// # Panics
    /// Where a node has no position.
    pub fn new(mass: f64, position: [f64; 3], nodes: Vec<u32>, positions: &[[f64; 3]]) -> Option<Self> {
        let at = |node: &u32| Vector3::from(positions[*node as usize]);
        let count = nodes.len() as f64;
        let center = nodes.iter().map(at).sum::<Vector3<f64>>() / count;
        let size = nodes.iter().map(|node| (at(node) - center).norm()).fold(f64::MIN_POSITIVE, f64::max);
        // In units of the farthest node.
        let arms: Vec<Matrix3<f64>> = nodes.iter().map(|node| ((at(node) - center) / size).cross_matrix()).collect();
        let arm = ((Vector3::from(position) - center) / size).cross_matrix();
        let inertia: Matrix3<f64> = arms.iter().map(|arm| arm.transpose() * arm).sum();
        let eigen = SymmetricEigen::new(inertia);
        let largest = eigen.eigenvalues.max();
        let mut inverse = Matrix3::zeros();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > LINE * largest {
                inverse += vector * vector.transpose() / *value;
            }
        }
        let turns = arm * inverse;
        // Written so that NaN is refused too.
        let is_told = (turns * inertia - arm).norm() <= RIGID * arm.norm().max(1.0);
        let shares = arms.iter().map(|arm| Matrix3::identity() / count - turns * arm).collect();
        is_told.then_some(Self { mass, position, nodes, shares })
    }

    /// Displacement of the point in each field (3n×k).
    fn displacements(&self, fields: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(3, fields.ncols(), |axis, k| {
            let of_node = |(node, share): (&u32, &Matrix3<f64>)| -> f64 {
                (0..3).map(|other| share[(axis, other)] * fields[(3 * *node as usize + other, k)]).sum()
            };
            self.nodes.iter().zip(&self.shares).map(of_node).sum()
        })
    }
}

/// The mass of a body with such points, by its parts.
#[derive(Debug, Clone)]
pub(crate) struct TiedMass<'a> {
    nodal: NodalMass<'a>,
    points: &'a [TiedPoint],
}

impl<'a> TiedMass<'a> {
    pub(crate) fn new(nodal: NodalMass<'a>, points: &'a [TiedPoint]) -> Self {
        Self { nodal, points }
    }

    /// The mass with a node of its own for each point.
    pub(crate) fn extended(&self) -> NodalMass<'static> {
        self.nodal.with_nodes(&self.points.iter().map(|point| point.mass).collect::<Vec<_>>())
    }

    /// The positions with the points after them.
    pub(crate) fn positions(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        positions.iter().copied().chain(self.points.iter().map(|point| point.position)).collect()
    }

    /// Fields (3n×k) with the displacements of the points after them.
    pub(crate) fn with_points(&self, fields: MatRef<'_, f64>) -> Mat<f64> {
        let rows = fields.nrows();
        let mut all = Mat::zeros(rows + 3 * self.points.len(), fields.ncols());
        all.as_mut().subrows_mut(0, rows).copy_from(fields);
        for (i, point) in self.points.iter().enumerate() {
            all.as_mut().subrows_mut(rows + 3 * i, 3).copy_from(point.displacements(fields));
        }
        all
    }

    /// Forces on the nodes (3n×k) of mass times accelerations of the nodes and of the points after them.
    pub(crate) fn forces(&self, accelerations: MatRef<'_, f64>) -> Mat<f64> {
        let rows = accelerations.nrows() - 3 * self.points.len();
        let mut forces = self.nodal.product(accelerations.subrows(0, rows));
        for (i, point) in self.points.iter().enumerate() {
            for k in 0..accelerations.ncols() {
                let of_point = Vector3::from_fn(|axis, _| point.mass * accelerations[(rows + 3 * i + axis, k)]);
                for (node, share) in point.nodes.iter().zip(&point.shares) {
                    let force = share.tr_mul(&of_point);
                    (0..3).for_each(|axis| forces[(3 * *node as usize + axis, k)] += force[axis]);
                }
            }
        }
        forces
    }
}

/// M (3n×3n, both triangles stored) of a mass over pairs of nodes and of points that move with nodes.
///
/// # Errors
/// [`ModalError::Factorization`] where it does not fit into an index.
pub fn mass_with_points(nodal: &NodalMass<'_>, points: &[TiedPoint]) -> Result<SparseColMat<usize, f64>, ModalError> {
    let size = 3 * nodal.node_count();
    let more: usize = points.iter().map(|point| 9 * point.nodes.len() * point.nodes.len()).sum();
    memory::check("the mass matrix with masses beside the body", 40 * (3 * nodal.values().len() + more))?;
    let mut entries = Vec::with_capacity(3 * nodal.values().len() + more);
    for Triplet { row, col, val } in nodal.entries() {
        entries.extend((0..3).map(|axis| Triplet::new(3 * row + axis, 3 * col + axis, val)));
    }
    for TiedPoint { mass, nodes, shares, .. } in points {
        for (i, (a, of_a)) in nodes.iter().zip(shares).enumerate() {
            for (b, of_b) in nodes.iter().zip(shares).skip(i) {
                let block = of_a.tr_mul(of_b) * *mass;
                for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
                    // The two triangles are the same to the last bit.
                    let value = if a == b { block[(row.min(column), row.max(column))] } else { block[(row, column)] };
                    let (row, column) = (3 * *a as usize + row, 3 * *b as usize + column);
                    entries.push(Triplet::new(row, column, value));
                    if a != b {
                        entries.push(Triplet::new(column, row, value));
                    }
                }
            }
        }
    }
    SparseColMat::try_new_from_triplets(size, size, &entries)
        .map_err(|error| ModalError::Factorization { size, reason: error.to_string() })
}
