//! Balanced truncation (Moore 1981), Eq. (F5), with the error bound of Glover (1984) and Enns (1984).

use faer::linalg::solvers::Solve;
use faer::{Mat, Side, c64};

use crate::channel::Channel;
use crate::error::LinearError;
use crate::state_space::StateSpace;

/// A model of lower order.
#[derive(Debug, Clone)]
pub struct Balanced {
    /// The model, in balanced states.
    pub model: StateSpace,
    /// Hankel values σ of the whole model, falling.
    pub hankel_values: Vec<f64>,
    /// 2 Σ σ of what is left out: no response differs by more, at no frequency, in the largest singular value.
    pub error_bound: f64,
}

impl StateSpace {
    /// Balanced truncation to an order.
    ///
    /// # Errors
    /// [`LinearError::NotStable`] for a model with a pole that does not decay, [`LinearError::Order`],
    /// [`LinearError::Unconnected`], [`LinearError::Eigen`].
    pub fn balanced(&self, order: usize) -> Result<Balanced, LinearError> {
        let n = self.a.nrows();
        if !(1..=n).contains(&order) {
            return Err(LinearError::Order { found: order, most: n });
        }
        let [reach, sight] = self.gramians()?;
        // In states of like size, so that squares lose little.
        let sizes: Vec<f64> = (0..n).map(|i| if reach[(i, i)] > 0.0 { reach[(i, i)].sqrt() } else { 1.0 }).collect();
        let reach = Mat::from_fn(n, n, |i, j| reach[(i, j)] / (sizes[i] * sizes[j]));
        let sight = Mat::from_fn(n, n, |i, j| sight[(i, j)] * (sizes[i] * sizes[j]));
        let (reach, sight) = (root(&reach)?, root(&sight)?);
        let svd = (sight.transpose() * &reach).svd().map_err(|_| LinearError::Eigen { size: n })?;
        let hankel_values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        if hankel_values[0] == 0.0 {
            return Err(LinearError::Unconnected);
        }
        // What is not reached or not seen has no balanced state.
        let least = f64::EPSILON * hankel_values[0];
        let kept = order.min(hankel_values.iter().filter(|value| **value > least).count());
        let roots: Vec<f64> = hankel_values[..kept].iter().map(|value| value.sqrt()).collect();
        let right = reach * svd.V().get(.., ..kept);
        let left = sight * svd.U().get(.., ..kept);
        let right = Mat::from_fn(n, kept, |i, k| sizes[i] * right[(i, k)] / roots[k]);
        let left = Mat::from_fn(n, kept, |i, k| left[(i, k)] / (sizes[i] * roots[k]));
        let model = StateSpace {
            a: left.transpose() * (&self.a * &right),
            b: left.transpose() * &self.b,
            c: &self.c * &right,
            d: self.d.clone(),
            states: (1..=kept).map(|k| Channel::new(format!("balanced{k}"), "")).collect(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        };
        let error_bound = 2.0 * hankel_values[kept..].iter().sum::<f64>();
        Ok(Balanced { model, hankel_values, error_bound })
    }

    /// P of A P + P Aᵀ + B Bᵀ = 0, and Q of Aᵀ Q + Q A + Cᵀ C = 0, in the eigenvectors of A.
    fn gramians(&self) -> Result<[Mat<f64>; 2], LinearError> {
        let n = self.a.nrows();
        let failed = LinearError::Eigen { size: n };
        let eigen = self.a.eigen().map_err(|_| failed)?;
        let poles: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
        let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        if let Some(pole) = poles.iter().find(|pole| pole.re.is_nan() || pole.re >= -1e-13 * fastest) {
            return Err(LinearError::NotStable { real: pole.re, imaginary: pole.im.abs() });
        }
        let complex =
            |matrix: &Mat<f64>| Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| c64::new(matrix[(i, j)], 0.0));
        let vectors = eigen.U().to_owned();
        let lu = vectors.partial_piv_lu();
        let forced = lu.solve(complex(&self.b));
        let seen = complex(&self.c) * &vectors;
        let reach = Mat::from_fn(n, n, |i, j| {
            let product: c64 = (0..self.b.ncols()).map(|k| forced[(i, k)] * forced[(j, k)].conj()).sum();
            -product / (poles[i] + poles[j].conj())
        });
        let sight = Mat::from_fn(n, n, |i, j| {
            let product: c64 = (0..self.c.nrows()).map(|k| seen[(k, i)].conj() * seen[(k, j)]).sum();
            -product / (poles[i].conj() + poles[j])
        });
        let reach = &vectors * reach * vectors.adjoint();
        let inverse = lu.solve(Mat::<c64>::identity(n, n));
        let sight = inverse.adjoint() * sight * &inverse;
        let real = |matrix: Mat<c64>| Mat::from_fn(n, n, |i, j| 0.5 * (matrix[(i, j)].re + matrix[(j, i)].re));
        Ok([real(reach), real(sight)])
    }
}

/// L of a positive semidefinite matrix L Lᵀ.
fn root(matrix: &Mat<f64>) -> Result<Mat<f64>, LinearError> {
    let n = matrix.nrows();
    let eigen = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| LinearError::Eigen { size: n })?;
    let values = eigen.S().column_vector();
    Ok(Mat::from_fn(n, n, |i, k| eigen.U()[(i, k)] * values[k].max(0.0).sqrt()))
}
