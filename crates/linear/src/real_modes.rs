//! Real modes of equations of second order: those of K, each with its own damping.

use faer::{Mat, Side};

use crate::error::LinearError;
use crate::second_order::SecondOrder;

/// An antisymmetric part of K or C above this part of the matrix couples modes out of phase.
const SYMMETRIC: f64 = 1e-9;

/// Modes of K over coordinates of unit mass.
#[derive(Debug, Clone)]
pub struct RealModes {
    /// Circular frequencies ω, rising, rad per time.
    pub circular_frequencies: Vec<f64>,
    /// Damping ratios, of each mode alone.
    pub damping_ratios: Vec<f64>,
    /// Shapes v (n×n, a column a mode) of unit length.
    pub shapes: Mat<f64>,
    /// Largest damping between two modes as a part of their own, |c_ij|/√(c_ii c_jj): what the modes leave out.
    pub coupling: f64,
}

impl SecondOrder {
    /// The modes of K, without what the damping couples.
    ///
    /// # Errors
    /// As [`Self::check`]; [`LinearError::Value`] for motions without stiffness, and in a spin, where no mode is real;
    /// [`LinearError::Eigen`].
    pub fn real_modes(&self) -> Result<RealModes, LinearError> {
        self.check()?;
        let refuse = |what, found, expected| Err(LinearError::Value { what, found, expected });
        for (what, matrix) in [
            ("the part of the stiffness that is not symmetric", &self.stiffness),
            ("the part of the damping that is not symmetric", &self.damping),
        ] {
            let part = (matrix - matrix.transpose()).norm_max() / matrix.norm_max();
            if part > SYMMETRIC {
                return refuse(what, part, "none: real modes, without a spin and loads that turn with the body");
            }
        }
        let size = self.size();
        let eigen = self.stiffness.self_adjoint_eigen(Side::Lower).map_err(|_| LinearError::Eigen { size })?;
        let squares: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
        let largest = squares.last().copied().unwrap_or(0.0);
        if let Some(square) = squares.iter().copied().find(|square| *square <= f64::EPSILON * size as f64 * largest) {
            let expected = "more than 0: a body that is held; where a support or joints leave motions, take them out";
            return refuse("the square of a circular frequency", square, expected);
        }
        let shapes = eigen.U().to_owned();
        let damping = shapes.transpose() * &self.damping * &shapes;
        let circular_frequencies: Vec<f64> = squares.into_iter().map(f64::sqrt).collect();
        let own = |k: usize| damping[(k, k)];
        let damping_ratios = circular_frequencies.iter().enumerate().map(|(k, omega)| 0.5 * own(k) / omega).collect();
        let pairs = (0..size).flat_map(|i| (0..i).map(move |j| (i, j)));
        let coupling = pairs.filter(|(i, j)| damping[(*i, *j)] != 0.0);
        let coupling =
            coupling.map(|(i, j)| damping[(i, j)].abs() / (own(i) * own(j)).abs().sqrt()).fold(0.0, f64::max);
        Ok(RealModes { circular_frequencies, damping_ratios, shapes, coupling })
    }
}
