//! From modes to the reduced body and its points, Eqs. (M7)–(M10) of `docs/method/modes.md`.

use faer::sparse::SparseColMatRef;
use faer::{Mat, MatRef};
use nalgebra::Vector3;
use reduced_body::{BodyPoint, Constants, ReducedBody};

use crate::error::ModalError;
use crate::input::check_finite_entries;
use crate::matrix::mass_matrix::{MassMatrix, Turning};
use crate::reduction::general::general_products;
use crate::reduction::inertia_products::Products;
use crate::reduction::nodal::nodal_products;
use crate::solve::Modes;

/// Weights of a point sum to one but for this.
const WEIGHTS: f64 = 1e-6;

impl Modes {
    /// The reduced body of the mass matrix `mass` and the nodes `positions`.
    ///
    /// The part of M that a large rotation uses, where M is constant in body axes:
    ///
    /// * A scalar mass for each pair of nodes ([`crate::NodalMass`]) commutes with rotations: every constant is exact. So it is with points that
    ///   move with nodes ([`crate::TiedPoint`]).
    /// * Any other M, with three or six degrees of freedom a node: J₀, b_i and t_i are exact. The deformed body takes the
    ///   velocities of a node for `ω×(X + u) + u̇` and `ω + ω×θ + θ̇` (body axes): c_ij is exact for a rotary inertia that
    ///   sits on a node, and turns with it. Left out is what M gives because it does not commute with rotations: the
    ///   symmetric part of `Ψᵀ M (I⊗[e_i×]) Ψ`, the momentum `Eᵀ M (I⊗[ω×]) Ψ q` (the centre of mass of a free body stays
    ///   at its origin), couplings of translations with rotations that turn with a node, and all that is of second order in
    ///   the rotations of nodes. With consistent masses of beams and shells this vanishes with the square of the element
    ///   length; energy and momenta of the motion are conserved in any case.
    /// * The formulation of the paper has no rotations of nodes: it is right for masses of the first kind only.
    ///
    /// # Errors
    /// [`ModalError::NoRigidBodyMass`] where M does not give translations the mass of a rigid body to 1e-9,
    /// [`ModalError::NotSymmetric`]; [`ModalError::Length`] and [`ModalError::Size`] where the modes or the positions are
    /// not those of its nodes.
    pub fn reduced(
        &self,
        mass: SparseColMatRef<'_, usize, f64>,
        positions: &[[f64; 3]],
    ) -> Result<ReducedBody, ModalError> {
        self.reduced_by(&MassMatrix::new(mass, positions.len())?, positions)
    }

    /// The same, with the mass matrix of a [`crate::Solver`].
    ///
    /// # Errors
    /// As [`reduced`](Self::reduced).
    pub fn reduced_by(&self, mass: &MassMatrix<'_>, positions: &[[f64; 3]]) -> Result<ReducedBody, ModalError> {
        let rigid = &self.rigid;
        let n = positions.len();
        let nf = self.shapes.ncols();
        check_size("the rows of the mode shapes", self.shapes.nrows(), mass.dofs() * n)?;
        check_size("the rows of the rigid mode shapes", rigid.shapes.nrows(), mass.dofs() * n)?;
        check_size("the list of eigenvalues", self.eigenvalues.len(), nf)?;
        let Products {
            rotation_products,
            position_products,
            inertia_first,
            inertia_second,
            gyroscopic,
            translation_first,
            rotation_first,
        } = match mass.turning() {
            Turning::Nodal(mass) => nodal_products(self, mass, positions)?,
            Turning::Tied(tied) => {
                let mut modes = self.clone();
                modes.rigid.shapes = tied.with_points(rigid.shapes.as_ref());
                modes.shapes = tied.with_points(self.shapes.as_ref());
                nodal_products(&modes, &tied.extended(), &tied.positions(positions))?
            }
            Turning::Anisotropic(mass) => general_products(self, mass, positions)?,
        };
        Ok(ReducedBody::from_constants(Constants {
            mass: rigid.mass,
            center_of_mass: rigid.center_of_mass,
            motion: rigid.motion,
            origin: rigid.origin,
            inertia: rigid.inertia,
            translation_basis: rigid.translation_basis,
            rotation_basis: rigid.rotation_basis,
            circular_frequencies: self.eigenvalues.iter().map(|lambda| lambda.sqrt()).collect(),
            natural_modes: self.natural(),
            rotation_products,
            position_products,
            inertia_first,
            inertia_second,
            gyroscopic,
            translation_first,
            rotation_first,
            stress_stiffness: None,
        })?)
    }

    /// The point that moves as `Σ weights_i u(nodes_i)`, where the weights sum to one. Rotations of nodes do not move it.
    ///
    /// # Errors
    /// [`ModalError::NoNode`] for a node that the mesh does not have, [`ModalError::Length`] for lists of other lengths,
    /// [`ModalError::NotFinite`], [`ModalError::Weights`].
    pub fn point(&self, positions: &[[f64; 3]], nodes: &[u32], weights: &[f64]) -> Result<BodyPoint, ModalError> {
        let count = positions.len();
        check_size("the list of weights", weights.len(), nodes.len())?;
        let dofs = if self.shapes.nrows() == 6 * count { 6 } else { 3 };
        check_size("the rows of the mode shapes", self.shapes.nrows(), dofs * count)?;
        check_finite_entries("weight", weights.iter().copied())?;
        let sum = weights.iter().sum::<f64>();
        if (sum - 1.0).abs() > WEIGHTS {
            return Err(ModalError::Weights { sum });
        }
        if let Some(node) = nodes.iter().copied().find(|node| *node as usize >= count) {
            return Err(ModalError::NoNode { node, count });
        }
        let carried = || nodes.iter().map(|node| *node as usize).zip(weights);
        let position: Vector3<f64> = carried().map(|(node, w)| Vector3::from(positions[node]) * *w).sum();
        let shapes: MatRef<'_, f64> = self.shapes.as_ref();
        Ok(BodyPoint {
            position_body: position - self.rigid.origin,
            shapes: Mat::from_fn(3, shapes.ncols(), |axis, k| {
                carried().map(|(node, w)| shapes[(dofs * node + axis, k)] * w).sum()
            }),
        })
    }
}

/// Refuses a list of another length.
fn check_size(what: &'static str, found: usize, expected: usize) -> Result<(), ModalError> {
    if found == expected { Ok(()) } else { Err(ModalError::Length { what, found, expected }) }
}
