//! Frequencies of small vibrations about a state of the full body, Eq. (K6) of `docs/method/check.md`, in the space of one
//! inverse iteration from a model's shapes.
//!
//! ```text
//! V = K*⁻¹ M D        VᵀMV q̈ + 2 VᵀM(ω×)V q̇ + Vᵀ(K* − L)V q = 0
//! ```
//!
//! D: displacements of the full body by each coordinate of the model at its state. Without the solution, the projection on D itself
//! is off by 10 to 90 % of an error: D does not hold the stretch that bending of a bent body takes along.

use faer::complex::Complex;
use faer::{Mat, MatRef};
use nalgebra::Vector3;

use crate::body::FullBody;
use crate::error::NonlinearError;
use crate::followers::load_change;
use crate::state_error::{FullState, StateError};
use crate::tangent::{TangentTerms, product_of};
use crate::vectors::{list, sum};

/// A vibration `exp((growth + i·circular_frequency) t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vibration {
    /// Radians per time, not negative.
    pub circular_frequency: f64,
    /// 1 per time: positive where it grows.
    pub growth: f64,
}

/// The vibrations of the full body about a state, slowest first, one for each column of `shapes` (3n×k): its displacements by the coordinates
/// of a model. Of a body that spins freely, its frame's spin is held.
///
/// # Errors
/// Errors of the solutions; [`NonlinearError::Singular`] where shapes are not independent.
pub fn true_frequencies(
    body: &FullBody<'_>,
    state: &FullState,
    found: &StateError<'_>,
    shapes: MatRef<'_, f64>,
) -> Result<Vec<Vibration>, NonlinearError> {
    let v = found.tangent.solve(body.momenta_of(shapes).as_ref())?;
    let u = sum(&state.displacement, 1.0, &found.error);
    let terms = TangentTerms::spinning(&u, &found.stresses, &state.omega_body);
    let mut forces = product_of(body, &terms, v.as_ref());
    if state.forces.follow() {
        for k in 0..v.ncols() {
            let changed = load_change(body, &state.forces, &u, &list(&v, k))?;
            forces.col_mut(k).iter_mut().zip(changed).for_each(|(to, f)| *to -= f);
        }
    }
    let stiffness = v.transpose() * &forces;
    let mass = v.transpose() * body.momenta_of(v.as_ref());
    let turned = turned(&v, &state.omega_body);
    let gyroscopic = v.transpose() * body.momenta_of(turned.as_ref()) * faer::Scale(2.0);
    quadratic(&mass, &gyroscopic, &stiffness)
}

/// ω × each node's displacement.
pub(crate) fn turned(v: &Mat<f64>, omega: &Vector3<f64>) -> Mat<f64> {
    Mat::from_fn(v.nrows(), v.ncols(), |row, k| {
        let first = row - row % 3;
        omega.cross(&Vector3::new(v[(first, k)], v[(first + 1, k)], v[(first + 2, k)]))[row % 3]
    })
}

/// Roots of `det(λ² M + λ G + K) = 0` with their conjugates left out, slowest first.
pub(crate) fn quadratic(mass: &Mat<f64>, g: &Mat<f64>, k: &Mat<f64>) -> Result<Vec<Vibration>, NonlinearError> {
    let size = mass.nrows();
    if size == 0 {
        return Ok(Vec::new());
    }
    // In coordinates of which the mass is the unit matrix.
    let lower = nalgebra::DMatrix::from_fn(size, size, |i, j| 0.5 * (mass[(i, j)] + mass[(j, i)]));
    let scale: Vec<f64> = (0..size).map(|i| 1.0 / lower[(i, i)].max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = nalgebra::DMatrix::from_fn(size, size, |i, j| lower[(i, j)] * scale[i] * scale[j]);
    let lower = scaled.cholesky().ok_or(NonlinearError::Singular)?.l();
    let inverse = lower.try_inverse().ok_or(NonlinearError::Singular)?;
    let whitened = |a: &Mat<f64>| {
        let a = nalgebra::DMatrix::from_fn(size, size, |i, j| a[(i, j)] * scale[i] * scale[j]);
        &inverse * a * inverse.transpose()
    };
    let (g, k) = (whitened(g), whitened(k));
    // Frequencies scale the rates, so that both halves are of one size.
    let rate = k.norm().sqrt().max(g.norm()).max(f64::MIN_POSITIVE);
    let companion = Mat::from_fn(2 * size, 2 * size, |i, j| match (i < size, j < size) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(i == j - size)),
        (false, true) => -k[(i - size, j)] / (rate * rate),
        (false, false) => -g[(i - size, j - size)] / rate,
    });
    let roots: Vec<Complex<f64>> = companion.eigenvalues().map_err(|_| NonlinearError::Singular)?;
    let mut found: Vec<Vibration> = roots
        .iter()
        .filter(|root| root.im > 0.0 || (root.im == 0.0 && root.re >= 0.0))
        .map(|root| Vibration { circular_frequency: rate * root.im, growth: rate * root.re })
        .collect();
    found.sort_by(|a, b| a.circular_frequency.total_cmp(&b.circular_frequency));
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: two oscillators of 3 and 5 without gyroscopic terms; a mass on two equal springs ω in a frame that
    /// turns at Ω has ω ± Ω there; one that is pushed away grows with √2.
    #[test]
    fn vibrations_of_small_systems_are_those_in_closed_form() {
        let matrix = |rows: [[f64; 2]; 2]| Mat::from_fn(2, 2, |i, j| rows[i][j]);
        let none = matrix([[0.0; 2]; 2]);
        let found = quadratic(&matrix([[2.0, 0.0], [0.0, 4.0]]), &none, &matrix([[18.0, 0.0], [0.0, 100.0]])).unwrap();
        assert!((found[0].circular_frequency - 3.0).abs() < 1e-12 && (found[1].circular_frequency - 5.0).abs() < 1e-12);

        let (omega, spin) = (7.0_f64, 2.0);
        let k = omega * omega - spin * spin;
        let turning = matrix([[0.0, -2.0 * spin], [2.0 * spin, 0.0]]);
        let found = quadratic(&matrix([[1.0, 0.0], [0.0, 1.0]]), &turning, &matrix([[k, 0.0], [0.0, k]])).unwrap();
        assert!((found[0].circular_frequency - 5.0).abs() < 1e-12 && (found[1].circular_frequency - 9.0).abs() < 1e-12);

        let found = quadratic(&matrix([[1.0, 0.0], [0.0, 1.0]]), &none, &matrix([[-2.0, 0.0], [0.0, 4.0]])).unwrap();
        assert!((found[0].growth - 2.0_f64.sqrt()).abs() < 1e-12 && found[0].circular_frequency == 0.0);
    }
}
