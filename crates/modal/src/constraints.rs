//! The space of the displacements that a support allows.
//!
//! A held node moves as one of the support's rigid motions takes it along, so the held nodes together have one unknown
//! for each motion that moves them: none at the point of a pin, one for a patch around a hinge.
//!
//! Vectors keep their 3n rows. With T the orthonormal basis of the space (a column for each degree of freedom of the
//! other nodes, one for each motion of the held ones), [`Constraints::project`] is `T Tᵀ`. It takes any displacement
//! into the space, and takes out of a force what the support's reactions balance.

use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Mat, MatMut};
use nalgebra::{DMatrix, Vector3};

use crate::error::ModalError;
use crate::support::{RigidMotion, Support};

/// A motion that moves the held nodes by less than this, relative to the size of the body, does not move them.
const NEGLIGIBLE: f64 = 1e-7;

/// What the held nodes may do.
#[derive(Clone)]
pub(crate) struct Constraints {
    /// Held nodes, in rising order.
    nodes: Vec<usize>,
    /// Whether each node is held.
    held: Vec<bool>,
    /// The displacements of the held nodes that the support allows (3h×k, orthonormal).
    motions: Mat<f64>,
}

impl Constraints {
    /// # Errors
    /// [`ModalError::NoSuchNode`], [`ModalError::Underheld`], and what [`RigidMotion::check`] refuses.
    pub(crate) fn new(support: &Support, positions: &[[f64; 3]]) -> Result<Self, ModalError> {
        support.motion.check()?;
        let count = positions.len();
        if let Some(node) = support.nodes.iter().find(|node| **node as usize >= count) {
            return Err(ModalError::NoSuchNode { node: *node, count });
        }
        let mut nodes: Vec<usize> = support.nodes.iter().map(|node| *node as usize).collect();
        nodes.sort_unstable();
        nodes.dedup();

        let places: Vec<Vector3<f64>> = nodes.iter().map(|node| Vector3::from(positions[*node])).collect();
        let (center, radius) = extent(positions);
        let displaced = |motion: &RigidMotion| {
            let columns: Vec<_> = places.iter().map(|x| motion.displacements(x, &center, radius)).collect();
            DMatrix::from_fn(3 * places.len(), motion.count(), |i, j| columns[i / 3][j][i % 3])
        };
        let limit = NEGLIGIBLE * (places.len() as f64).sqrt();
        let allowed = range(displaced(&support.motion), limit);
        let any = displaced(&RigidMotion::free());
        let prevented = &any - &allowed * (allowed.transpose() * &any);
        let (left, expected) = (6 - range(prevented, limit).ncols(), support.motion.count());
        if left > expected {
            return Err(ModalError::Underheld { held: places.len(), left, expected });
        }
        let mut held = vec![false; count];
        nodes.iter().for_each(|node| held[*node] = true);
        Ok(Self { nodes, held, motions: Mat::from_fn(allowed.nrows(), allowed.ncols(), |i, j| allowed[(i, j)]) })
    }

    /// Number of unknowns of the held nodes.
    pub(crate) fn motion_count(&self) -> usize {
        self.motions.ncols()
    }

    /// Whether nothing is held.
    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Whether a node is held.
    pub(crate) fn holds(&self, node: usize) -> bool {
        self.held[node]
    }

    /// The motions of the held nodes, zero on all others (3n×k).
    pub(crate) fn motions(&self) -> Mat<f64> {
        let mut all = Mat::zeros(3 * self.held.len(), self.motion_count());
        self.scatter(&self.motions, all.as_mut());
        all
    }

    /// Replaces X by T Tᵀ X.
    pub(crate) fn project(&self, mut x: MatMut<'_, f64>) {
        if !self.is_empty() {
            let coefficients = self.motions.transpose() * self.gather(x.rb_mut());
            self.scatter(&(&self.motions * coefficients), x);
        }
    }

    /// Sets the rows of the held nodes to zero.
    pub(crate) fn clear(&self, x: MatMut<'_, f64>) {
        self.scatter(&Mat::zeros(3 * self.nodes.len(), x.ncols()), x);
    }

    /// The rows of the held nodes.
    fn gather(&self, x: MatMut<'_, f64>) -> Mat<f64> {
        let x = x.rb();
        Mat::from_fn(3 * self.nodes.len(), x.ncols(), |i, j| x[(3 * self.nodes[i / 3] + i % 3, j)])
    }

    /// Replaces the rows of the held nodes.
    fn scatter(&self, rows: &Mat<f64>, mut x: MatMut<'_, f64>) {
        for j in 0..x.ncols() {
            for i in 0..rows.nrows() {
                x[(3 * self.nodes[i / 3] + i % 3, j)] = rows[(i, j)];
            }
        }
    }
}

/// Centre and half diagonal of the bounding box.
fn extent(positions: &[[f64; 3]]) -> (Vector3<f64>, f64) {
    let fold = |start: f64, choose: fn(f64, f64) -> f64| {
        Vector3::from_fn(|axis, _| positions.iter().map(|x| x[axis]).fold(start, choose))
    };
    let (low, high) = (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max));
    (0.5 * (low + high), 0.5 * (high - low).norm())
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
