//! Vibrations of the full body about its rest in a steady spin.
//!
//! ```text
//! M ẍ + 2 M (ω×) ẋ + K* x = 0        K* = K_T(u₀) − M W
//! V = K*⁻¹ M [B, ω×B]                B: real and imaginary parts of the vibrations found before
//! ```
//!
//! A subspace iteration with both terms of inertia: an eigenvector x of λ is `−K*⁻¹ M (λ² + 2λ ω×) x`. What is left of an error goes
//! with the square of the ratio of a frequency to the lowest one that is left out.

use faer::complex::Complex;
use faer::{Mat, MatRef};
use nalgebra::{DMatrix, Vector3};

use crate::body::FullBody;
use crate::equilibrium::Equilibrium;
use crate::error::NonlinearError;
use crate::frequencies::turned;
use crate::tangent::{Tangent, TangentTerms};

/// Vibrations that are found beside those asked for, so that these are right.
const GUARD: usize = 4;
/// Most iterations, and the change of a frequency that ends them.
const MOST: usize = 12;
const SETTLED: f64 = 1e-8;
/// A part of a vector beside others that is rounding.
const DEPENDENT: f64 = 1e-7;

/// A vibration `Re[(re + i·im) exp((growth + i·circular_frequency) t)]` of the nodes.
#[derive(Debug, Clone)]
pub struct SpinVibration {
    /// Radians per time, not negative.
    pub circular_frequency: f64,
    /// 1 per time: positive where it grows.
    pub growth: f64,
    /// Real and imaginary part of the displacements (3n each).
    pub shape: [Vec<f64>; 2],
}

/// The slowest vibrations of the body about its rest in the spin `omega_body`, as it sees them, as many as `count`; `start` (3n×k)
/// has displacements to begin with, such as modes at rest, `count` of them at least.
///
/// # Errors
/// Errors of the factor; [`NonlinearError::Singular`] where displacements are not independent.
pub fn spin_vibrations(
    body: &FullBody<'_>,
    rest: &Equilibrium,
    omega_body: &Vector3<f64>,
    start: MatRef<'_, f64>,
    count: usize,
) -> Result<Vec<SpinVibration>, NonlinearError> {
    let terms = TangentTerms::spinning(&rest.displacement, &rest.stresses, omega_body);
    let tangent = Tangent::new(body, &terms)?;
    let mut basis = start.to_owned();
    let mut last: Vec<f64> = Vec::new();
    for iteration in 1.. {
        let mut momenta = body.momenta_of(basis.as_ref());
        if *omega_body != Vector3::zeros() {
            let turning = body.momenta_of(turned(&basis, omega_body).as_ref());
            let columns = momenta.ncols();
            momenta = Mat::from_fn(momenta.nrows(), 2 * columns, |i, j| match j.checked_sub(columns) {
                None => momenta[(i, j)],
                Some(j) => turning[(i, j)],
            });
        }
        let v = orthonormal(body, &tangent.solve(momenta.as_ref())?);
        let stiffness = v.transpose() * tangent.product(v.as_ref());
        let gyroscopic = v.transpose() * body.momenta_of(turned(&v, omega_body).as_ref()) * faer::Scale(2.0);
        let found = roots(&gyroscopic, &stiffness)?;
        let kept = &found[..found.len().min(count + GUARD)];
        let now: Vec<f64> = kept.iter().take(count).map(|(root, _)| root.norm()).collect();
        let is_settled = last.len() == now.len()
            && last.iter().zip(&now).all(|(last, now)| (last - now).abs() <= SETTLED * now.abs());
        if is_settled || iteration >= MOST {
            return Ok(kept.iter().take(count).map(|(root, y)| vibration(*root, y, &v)).collect());
        }
        last = now;
        let parts: Vec<[Vec<f64>; 2]> = kept.iter().map(|(root, y)| vibration(*root, y, &v).shape).collect();
        basis = Mat::from_fn(v.nrows(), 2 * parts.len(), |i, j| parts[j / 2][j % 2][i]);
    }
    Ok(Vec::new())
}

fn vibration(root: Complex<f64>, y: &[Complex<f64>], v: &Mat<f64>) -> SpinVibration {
    let part = |of: fn(&Complex<f64>) -> f64| -> Vec<f64> {
        let mut sum = vec![0.0; v.nrows()];
        for (column, y) in v.col_iter().zip(y) {
            sum.iter_mut().zip(column.iter()).for_each(|(sum, v)| *sum += of(y) * v);
        }
        sum
    };
    SpinVibration { circular_frequency: root.im, growth: root.re, shape: [part(|y| y.re), part(|y| y.im)] }
}

/// M-orthonormal vectors that span the columns.
fn orthonormal(body: &FullBody<'_>, columns: &Mat<f64>) -> Mat<f64> {
    let mut found: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for column in columns.col_iter() {
        let mut v: Vec<f64> = column.iter().copied().collect();
        let size = dot(&v, &body.momentum(&v)).max(0.0).sqrt();
        for _ in 0..2 {
            for (other, momentum) in &found {
                let part = dot(momentum, &v);
                v.iter_mut().zip(other).for_each(|(v, other)| *v -= part * other);
            }
        }
        let momentum = body.momentum(&v);
        let left = dot(&v, &momentum).max(0.0).sqrt();
        if left > DEPENDENT * size {
            let unit = |list: Vec<f64>| list.into_iter().map(|x| x / left).collect();
            found.push((unit(v), unit(momentum)));
        }
    }
    Mat::from_fn(columns.nrows(), found.len(), |i, j| found[j].0[i])
}

/// A root with its vector.
type Root = (Complex<f64>, Vec<Complex<f64>>);

/// Roots of `(λ² + λ G + K) y = 0` without their conjugates, by size.
fn roots(g: &Mat<f64>, k: &Mat<f64>) -> Result<Vec<Root>, NonlinearError> {
    let size = k.nrows();
    // Frequencies scale the rates, so that both halves are of one size.
    let norm = |a: &Mat<f64>| DMatrix::from_fn(size, size, |i, j| a[(i, j)]).norm();
    let rate = norm(k).sqrt().max(norm(g)).max(f64::MIN_POSITIVE);
    let companion = Mat::from_fn(2 * size, 2 * size, |i, j| match (i < size, j < size) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(i == j - size)),
        // Both are what they are but for rounding: K symmetric, G skew.
        (false, true) => -0.5 * (k[(i - size, j)] + k[(j, i - size)]) / (rate * rate),
        (false, false) => -0.5 * (g[(i - size, j - size)] - g[(j - size, i - size)]) / rate,
    });
    let eigen = companion.eigen().map_err(|_| NonlinearError::Singular)?;
    let values: Vec<Complex<f64>> = eigen.S().column_vector().iter().copied().collect();
    let zero = 1e-9 * values.iter().map(|value| value.norm()).fold(f64::INFINITY, f64::min).max(f64::MIN_POSITIVE);
    let one_of_pair = |value: &Complex<f64>| value.im > zero || (value.im.abs() <= zero && value.re >= 0.0);
    let mut found: Vec<Root> = values
        .iter()
        .enumerate()
        .filter(|(_, value)| one_of_pair(value))
        .map(|(at, value)| {
            let y = (0..size).map(|i| eigen.U()[(i, at)]).collect();
            let re = if value.re.abs() <= 1e-7 * value.norm() { 0.0 } else { rate * value.re };
            (Complex::new(re, if value.im > zero { rate * value.im } else { 0.0 }), y)
        })
        .collect();
    found.sort_by(|(a, _), (b, _)| a.norm().total_cmp(&b.norm()));
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: a mass on two equal springs ω in a frame that turns at Ω has ω ± Ω there, each a circle; K = ω² − Ω².
    #[test]
    fn a_mass_in_a_turning_frame_circles_both_ways() {
        let (omega, spin) = (7.0_f64, 2.0);
        let k = Mat::from_fn(2, 2, |i, j| if i == j { omega * omega - spin * spin } else { 0.0 });
        let g = Mat::from_fn(2, 2, |i, j| [[0.0, -2.0 * spin], [2.0 * spin, 0.0]][i][j]);
        let found = roots(&g, &k).unwrap();
        assert_eq!(found.len(), 2);
        for ((root, y), expected) in found.iter().zip([5.0, 9.0]) {
            assert!((root.im - expected).abs() < 1e-12 && root.re == 0.0, "{root}");
            // y_2 is ±i y_1.
            assert!(((y[1] / y[0]).im.abs() - 1.0).abs() < 1e-9);
        }
    }
}
