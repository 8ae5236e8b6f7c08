//! Balanced truncation (Moore 1981), Eq. (F5), with the error bound of Glover (1984) and Enns (1984).

use faer::linalg::solvers::Solve;
use faer::{Mat, Side, c64};

use crate::error::LinearError;
use crate::state_space::{StateSpace, complex};

/// A model of lower order.
#[derive(Debug, Clone)]
pub struct Balanced {
    /// The model: states that do not decay, then balanced ones.
    pub model: StateSpace,
    /// Number of states that do not decay: rigid motions, undamped vibrations, unstable motions. They are kept as they are.
    pub lasting: usize,
    /// Hankel values σ of what decays, falling.
    pub hankel_values: Vec<f64>,
    /// 2 Σ σ of what is left out: no response differs by more, at no frequency, in the largest singular value.
    pub error_bound: f64,
}

impl StateSpace {
    /// Balanced truncation to an order, which counts all states. What does not decay has no Hankel values, and stays.
    ///
    /// # Errors
    /// [`LinearError::Order`] for an order below the number of states that do not decay, [`LinearError::Unconnected`],
    /// [`LinearError::Eigen`].
    pub fn balanced(&self, order: usize) -> Result<Balanced, LinearError> {
        let parts = self.parts()?;
        let lasting = parts.lasting.a.nrows();
        let (least, most) = (lasting.max(1), self.a.nrows());
        if !(least..=most).contains(&order) {
            return Err(LinearError::Order { found: order, least, most });
        }
        if order == lasting && parts.decaying.a.nrows() == 0 {
            let model = parts.lasting.beside(&parts.decaying, "balanced");
            return Ok(Balanced { model, lasting, hankel_values: Vec::new(), error_bound: 0.0 });
        }
        let Balanced { model, hankel_values, error_bound, .. } = parts.decaying.balanced_decaying(order - lasting)?;
        Ok(Balanced { model: parts.lasting.beside(&model, "balanced"), lasting, hankel_values, error_bound })
    }

    /// Balanced truncation of a model that decays.
    fn balanced_decaying(&self, order: usize) -> Result<Balanced, LinearError> {
        let n = self.a.nrows();
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
        let model = self.in_states(&right, &left.transpose().to_owned(), self.d.clone());
        let error_bound = 2.0 * hankel_values[kept..].iter().sum::<f64>();
        Ok(Balanced { model, lasting: 0, hankel_values, error_bound })
    }

    /// P of A P + P Aᵀ + B Bᵀ = 0, and Q of Aᵀ Q + Q A + Cᵀ C = 0, in the eigenvectors of A.
    fn gramians(&self) -> Result<[Mat<f64>; 2], LinearError> {
        let n = self.a.nrows();
        let failed = LinearError::Eigen { size: n };
        let eigen = self.a.eigen().map_err(|_| failed)?;
        let poles: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
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
