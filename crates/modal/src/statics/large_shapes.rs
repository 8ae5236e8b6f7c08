//! Shapes of large modes and of the modes that follow them: what bending draws in, twists and stretches.
//!
//! ```text
//! u = Ψ q + Σ_α u_α q^α      α: products of two or three large modes, of a large and a following one, of two following ones
//! K u_α = −g_α,  then freed of its parts along the large modes, those with a following factor along these, too:
//! u_α ← u_α − W ΨᵀM u_α,  ΨᵀM W = 1;  of two factors: W without coupling by K to the other modes
//! Ψ_ext = [Ψ, H]      u_α = Ψ_ext a_α,  a_α = Ψ_extᵀ M u_α
//! ```
//!
//! g_α are the forces of lower products (`fem_tet10::Expansion`), H M-orthonormal vectors of what the u_α have beside the modes
//! Ψ. To free them is a choice of what the coordinates mean. W are the modes themselves, but for a static answer
//! ([`Modes::uncoupled`]): then the other modes have no energy with a product, as K u_α is against what they have with its strain.

use faer::{Mat, MatRef};
use reduced_body::{LargeCoordinates, LargeProducts};

use crate::error::ModalError;
use crate::input::{check_finite_columns, check_rows};
use crate::matrix::tall;
use crate::memory_estimate::of_vectors;
use crate::solve::{Modes, Solver};

/// Smallest part of a static response beside the modes with which it is added: less is rounding.
const DEPENDENT: f64 = 1e-6;

/// Large modes, modes that follow them, and the shapes of their products.
#[derive(Debug, Clone)]
pub struct LargeShapes {
    /// The modes of the motion, then the vectors H; K-orthogonality is lost.
    pub modes: Modes,
    /// The coordinates in these shapes.
    pub coordinates: LargeCoordinates,
}

impl Solver<'_> {
    /// Fields (N×k) without their parts along M-orthonormal `shapes` (N×s), by taking off as much `of` other shapes (N×s), whose parts along
    /// these are 1: the shapes themselves, as a rule.
    ///
    /// # Errors
    /// [`ModalError::Size`].
    pub fn freed(
        &self,
        fields: MatRef<'_, f64>,
        shapes: MatRef<'_, f64>,
        of: MatRef<'_, f64>,
    ) -> Result<Mat<f64>, ModalError> {
        check_rows("fields", fields.nrows(), shapes.nrows())?;
        check_rows("what is taken off", of.nrows(), shapes.nrows())?;
        let parts = tall::inner(shapes, self.mass.product(fields).as_ref());
        Ok(fields - of * parts)
    }

    /// The shapes of the `large` ones of `modes` and of those that follow them, by the `fields` (N×products) of
    /// [`LargeProducts::of_displacement`], which have been freed.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::LargeModes`],
    /// [`ModalError::Memory`].
    pub fn large_shapes(
        &self,
        modes: Modes,
        large: &[usize],
        following: &[usize],
        fields: MatRef<'_, f64>,
    ) -> Result<LargeShapes, ModalError> {
        let (size, dynamic) = (modes.shapes.nrows(), modes.shapes.ncols());
        let products = LargeProducts { large: large.len(), following: following.len() };
        let of_displacement = products.of_displacement();
        if fields.ncols() != of_displacement.len() {
            let (expected, found) = (of_displacement.len(), fields.ncols());
            return Err(ModalError::Length { what: "fields of products", expected, found });
        }
        check_rows("fields of products", fields.nrows(), size)?;
        check_finite_columns("fields of products", fields)?;
        let is_list = |list: &[usize]| list.is_sorted_by(|a, b| a < b) && list.last().is_none_or(|k| *k < dynamic);
        if !is_list(large) || !is_list(following) || following.iter().any(|k| large.contains(k)) {
            let found = [large, following].concat();
            return Err(ModalError::LargeModes { found, count: dynamic });
        }
        memory::check("shapes of large modes", of_vectors(size, 3 * (dynamic + fields.ncols())))?;
        let beside = self.beside(&modes, fields, DEPENDENT)?;
        let shapes = tall::side_by_side(&[modes.shapes.as_ref(), beside.as_ref()]);
        let momenta = self.mass.product(fields);
        let mut coefficients = tall::inner(shapes.as_ref(), momenta.as_ref());
        for (column, product) in of_displacement.iter().enumerate() {
            let freed_of = large.iter().chain(following.iter().filter(|_| products.follows(product)));
            freed_of.for_each(|k| coefficients[(*k, column)] = 0.0);
        }
        let stiff = self.stiffness.product(beside.as_ref());
        let of_beside = (0..beside.ncols()).map(|k| beside.col(k).transpose() * stiff.col(k));
        let mut modes = modes;
        modes.append(of_beside, shapes);
        let (large, following) = (large.to_vec(), following.to_vec());
        Ok(LargeShapes { modes, coordinates: LargeCoordinates { dynamic, large, following, coefficients } })
    }
}
