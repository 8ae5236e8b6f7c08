//! K and M in the space of the displacements that a support allows, row by row, for who solves them elsewhere.
//!
//! With T the basis of that space (see [`Constraints`]), the matrices are Tᵀ K T and Tᵀ M T: the rows of the degrees of freedom
//! that are not held, in their order, then one for each motion of the held ones. Nothing is copied but the few rows of the
//! motions.

use faer::{Mat, MatRef};

use crate::error::ModalError;
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::memory_estimate::of_vectors;
use crate::support::constraints::Constraints;
use crate::support::rigid::RigidModes;

/// `K φ = λ M φ` of a body with its support.
pub struct HeldProblem<'a> {
    /// Tᵀ K T.
    pub stiffness: HeldMatrix<'a>,
    /// Tᵀ M T.
    pub mass: HeldMatrix<'a>,
    /// The rigid modes that the support leaves, M-orthonormal (unknowns × 0 to 6). K has nothing against them.
    pub rigid: Mat<f64>,
    /// The shift s, about the first eigenvalue, (rad/time)².
    pub shift: f64,
    /// Eigenpairs that there are beside the rigid modes.
    pub available: usize,
}

/// One of the matrices. It is symmetric.
pub struct HeldMatrix<'a> {
    matrix: Symmetric<'a>,
    /// Degrees of freedom of the rows; the motions follow.
    free: Vec<usize>,
    /// The row of each degree of freedom, the number of unknowns for those that are held.
    row_of: Vec<usize>,
    /// A C (N×k), C the motions.
    forces: Mat<f64>,
    /// Cᵀ A C.
    corner: Mat<f64>,
}

/// The matrix of the body that a held one comes from.
enum Symmetric<'a> {
    Stiffness(StiffnessMatrix<'a>),
    Mass(&'a MassMatrix<'a>),
}

impl Symmetric<'_> {
    fn product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        match self {
            Self::Stiffness(matrix) => matrix.product(x),
            Self::Mass(matrix) => matrix.product(x),
        }
    }

    fn for_each_in_column(&self, column: usize, entry: impl FnMut(usize, f64)) {
        match self {
            Self::Stiffness(matrix) => matrix.for_each_in_column(column, entry),
            Self::Mass(matrix) => matrix.for_each_in_column(column, entry),
        }
    }
}

impl<'a> HeldProblem<'a> {
    pub(crate) fn new(
        stiffness: StiffnessMatrix<'a>,
        mass: &'a MassMatrix<'a>,
        constraints: &Constraints,
        rigid: &RigidModes,
        shift: f64,
        available: usize,
    ) -> Result<Self, ModalError> {
        memory::check("the matrices of the held body", of_vectors(stiffness.ncols(), 16))?;
        let is_there = |column: &usize| rigid.shapes.col(*column).iter().any(|u| *u != 0.0);
        let moving: Vec<usize> = (0..rigid.shapes.ncols()).filter(is_there).collect();
        let rigid = Mat::from_fn(rigid.shapes.nrows(), moving.len(), |i, j| rigid.shapes[(i, moving[j])]);
        Ok(Self {
            stiffness: HeldMatrix::new(Symmetric::Stiffness(stiffness), constraints),
            mass: HeldMatrix::new(Symmetric::Mass(mass), constraints),
            rigid: constraints.reduced(rigid.as_ref()),
            shift,
            available,
        })
    }
}

impl<'a> HeldMatrix<'a> {
    fn new(matrix: Symmetric<'a>, constraints: &Constraints) -> Self {
        let motions = constraints.motions();
        let forces = matrix.product(motions.as_ref());
        let free = constraints.free_rows();
        let unknowns = free.len() + motions.ncols();
        let mut row_of = vec![unknowns; forces.nrows()];
        free.iter().enumerate().for_each(|(row, dof)| row_of[*dof] = row);
        let corner = motions.transpose() * &forces;
        Self { matrix, free, row_of, forces, corner }
    }

    /// Rows and columns.
    pub fn size(&self) -> usize {
        self.free.len() + self.corner.ncols()
    }

    /// Calls `entry` with the column and the value of each entry of a row that is not zero, in the order of the columns;
    /// of a row that there is not, none.
    pub fn for_each_in_row(&self, row: usize, mut entry: impl FnMut(usize, f64)) {
        let (free, motions) = (self.free.len(), self.corner.ncols());
        let mut not_zero = |column: usize, value: f64| {
            if value != 0.0 {
                entry(column, value);
            }
        };
        match self.free.get(row) {
            Some(dof) => {
                // A column of a symmetric matrix is its row.
                self.matrix.for_each_in_column(*dof, |other, value| {
                    if self.row_of[other] < free {
                        not_zero(self.row_of[other], value);
                    }
                });
                (0..motions).for_each(|motion| not_zero(free + motion, self.forces[(*dof, motion)]));
            }
            None if row >= self.size() => {}
            None => {
                let motion = row - free;
                self.free.iter().enumerate().for_each(|(at, dof)| not_zero(at, self.forces[(*dof, motion)]));
                (0..motions).for_each(|other| not_zero(free + other, self.corner[(motion, other)]));
            }
        }
    }
}
