//! The space of the displacements that a support allows.
//!
//! A held node moves as one of the support's rigid motions takes it along, so the held nodes together have one unknown
//! for each motion that moves them: none at the point of a pin, one for a patch around a hinge. A degree of freedom that is
//! held by itself is a row that none of the motions moves.
//!
//! Vectors keep the rows of all degrees of freedom. With T the orthonormal basis of the space (a column for each degree of freedom of the
//! other nodes, one for each motion of the held ones), [`Constraints::project`] is `T Tᵀ`. It takes any displacement
//! into the space, and takes out of a force what the support's reactions balance.

use faer::reborrow::Reborrow;
use faer::{Mat, MatMut, MatRef};
use nalgebra::{DMatrix, Vector3};

use crate::error::ModalError;
use crate::input::check_held;
use crate::matrix::renumbering::Renumbering;
use crate::support::held::Support;
use reduced_body::RigidMotion;

/// A motion that moves the held nodes by less than this, relative to the size of the body, does not move them.
pub(crate) const NEGLIGIBLE: f64 = 1e-7;

/// The constraints of the held degrees of freedom.
#[derive(Debug, Clone)]
pub struct Constraints {
    /// Held degrees of freedom, in the order of the rows of `motions`.
    rows: Vec<usize>,
    /// True for each degree of freedom that is held.
    held: Vec<bool>,
    /// The displacements of the held rows that the support allows (as many rows × k, orthonormal).
    motions: Mat<f64>,
}

impl Constraints {
    /// `dofs` is the number of degrees of freedom of a node, 3 or 6.
    ///
    /// # Errors
    /// [`ModalError::HeldNode`], [`ModalError::HeldFreedom`], [`ModalError::Underheld`], and the errors of points
    /// that are not finite and directions that are not unit vectors.
    pub fn new(support: &Support, positions: &[[f64; 3]], dofs: usize) -> Result<Self, ModalError> {
        support.motion.check()?;
        check_held(&support.nodes, &support.dofs, positions.len(), dofs)?;
        let of_nodes = support.nodes.iter().flat_map(|node| (0..dofs).map(move |dof| (*node, dof)));
        let mut rows: Vec<usize> =
            of_nodes.chain(support.dofs.iter().copied()).map(|(node, dof)| dofs * node as usize + dof).collect();
        rows.sort_unstable();
        rows.dedup();
        let mut held_nodes: Vec<usize> = rows.iter().map(|row| row / dofs).collect();
        held_nodes.dedup();

        let (center, radius) = extent(positions);
        // Rotations count times the radius, so that the units of length do not matter.
        let displaced = |motion: &RigidMotion| {
            let turns = motion.turns(radius);
            let moved: Vec<Vec<_>> = held_nodes
                .iter()
                .map(|node| motion.displacements(&Vector3::from(positions[*node]), &center, radius))
                .collect();
            DMatrix::from_fn(rows.len(), motion.count(), |i, j| {
                let (node, dof) = (rows[i] / dofs, rows[i] % dofs);
                if dof >= 3 {
                    return turns[j][dof - 3] * radius;
                }
                held_nodes.binary_search(&node).map_or(0.0, |place| moved[place][j][dof])
            })
        };
        let limit = NEGLIGIBLE * (held_nodes.len() as f64).sqrt();
        let mut allowed = range(displaced(&support.motion), limit);
        let any = displaced(&RigidMotion::free());
        let prevented = &any - &allowed * (allowed.transpose() * &any);
        let (left, expected) = (6 - range(prevented, limit).ncols(), support.motion.count());
        if left > expected {
            return Err(ModalError::Underheld { held: held_nodes.len(), left, expected });
        }
        if dofs == 6 {
            for (i, mut row) in allowed.row_iter_mut().enumerate() {
                if rows[i] % dofs >= 3 {
                    row /= radius;
                }
            }
            allowed = range(allowed, 0.0);
        }
        let mut held = vec![false; dofs * positions.len()];
        rows.iter().for_each(|row| held[*row] = true);
        Ok(Self { rows, held, motions: Mat::from_fn(allowed.nrows(), allowed.ncols(), |i, j| allowed[(i, j)]) })
    }

    /// The same of vectors that have the rows of the nodes, three each, in another order.
    pub(crate) fn reordered(&self, order: &Renumbering) -> Self {
        let place = |row: &usize| 3 * order.place((row / 3) as u32) as usize + row % 3;
        let rows: Vec<usize> = self.rows.iter().map(place).collect();
        let mut held = vec![false; self.held.len()];
        rows.iter().for_each(|row| held[*row] = true);
        Self { rows, held, motions: self.motions.clone() }
    }

    /// Number of unknowns of the held rows.
    pub(crate) fn motion_count(&self) -> usize {
        self.motions.ncols()
    }

    /// True if nothing is held.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// True if a degree of freedom is held.
    pub fn holds(&self, row: usize) -> bool {
        self.held[row]
    }

    /// The motions of the held rows, zero on all others (N×k).
    pub fn motions(&self) -> Mat<f64> {
        let mut all = Mat::zeros(self.held.len(), self.motion_count());
        self.scatter(&self.motions, all.as_mut());
        all
    }

    /// Replaces X by T Tᵀ X.
    pub fn project(&self, x: MatMut<'_, f64>) {
        if !self.is_empty() {
            let coefficients = self.motions.transpose() * self.gather(x.rb());
            self.scatter(&(&self.motions * coefficients), x);
        }
    }

    /// The degrees of freedom that are not held, in rising order.
    pub(crate) fn free_rows(&self) -> Vec<usize> {
        (0..self.held.len()).filter(|row| !self.held[*row]).collect()
    }

    /// Tᵀ X, a row for each column of T.
    pub(crate) fn reduced(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let free = self.free_rows();
        let motions = self.motions.transpose() * self.gather(x);
        Mat::from_fn(free.len() + motions.nrows(), x.ncols(), |i, j| match free.get(i) {
            Some(row) => x[(*row, j)],
            None => motions[(i - free.len(), j)],
        })
    }

    /// T Y.
    pub(crate) fn expanded(&self, y: MatRef<'_, f64>) -> Mat<f64> {
        let free = self.free_rows();
        let mut x = Mat::zeros(self.held.len(), y.ncols());
        for j in 0..y.ncols() {
            for (i, row) in free.iter().enumerate() {
                x[(*row, j)] = y[(i, j)];
            }
        }
        let moved = &self.motions * y.subrows(free.len(), self.motion_count());
        self.scatter(&moved, x.as_mut());
        x
    }

    /// Sets the held rows to zero.
    pub(crate) fn clear(&self, x: MatMut<'_, f64>) {
        self.scatter(&Mat::zeros(self.rows.len(), x.ncols()), x);
    }

    /// The held rows.
    fn gather(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(self.rows.len(), x.ncols(), |i, j| x[(self.rows[i], j)])
    }

    /// Replaces the held rows.
    fn scatter(&self, rows: &Mat<f64>, mut x: MatMut<'_, f64>) {
        for j in 0..x.ncols() {
            for (i, row) in self.rows.iter().enumerate() {
                x[(*row, j)] = rows[(i, j)];
            }
        }
    }
}

/// Centre and half diagonal of the bounding box (1 where all nodes are at one place).
pub(crate) fn extent(positions: &[[f64; 3]]) -> (Vector3<f64>, f64) {
    let fold = |start: f64, choose: fn(f64, f64) -> f64| {
        Vector3::from_fn(|axis, _| positions.iter().map(|x| x[axis]).fold(start, choose))
    };
    let (low, high) = (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max));
    let radius = 0.5 * (high - low).norm();
    (0.5 * (low + high), if radius == 0.0 { 1.0 } else { radius })
}

/// An orthonormal basis of the columns, without directions below `limit`.
fn range(columns: DMatrix<f64>, limit: f64) -> DMatrix<f64> {
    if columns.is_empty() {
        return DMatrix::zeros(columns.nrows(), 0);
    }
    let factors = columns.col_piv_qr();
    let r = factors.r();
    // R has fewer rows than columns where a single node is held.
    let rank = (0..r.nrows()).take_while(|i| r[(*i, *i)].abs() > limit).count();
    factors.q().columns(0, rank).into_owned()
}
