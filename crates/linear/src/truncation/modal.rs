//! Modal truncation with the static response of what is left out in D.

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::channel::Channel;
use crate::error::LinearError;
use crate::state_space::{StateSpace, complex};

/// Poles whose imaginary part is below this part of their magnitude are real.
const REAL: f64 = 1e-12;

impl StateSpace {
    /// The slowest modes that decay, and what does not decay, with the static response of all other modes in D, Eq. (F9): the response at
    /// frequency 0 is that of the whole. `order` counts all states; of a conjugate pair none is kept alone.
    ///
    /// # Errors
    /// [`LinearError::Order`] for an order below the number of states that do not decay, or that splits a pair; [`LinearError::Eigen`].
    pub fn modal(&self, order: usize) -> Result<Self, LinearError> {
        let n = self.a.nrows();
        let parts = self.parts()?;
        let lasting = parts.lasting.a.nrows();
        let refuse = || LinearError::Order { found: order, least: lasting.max(1), most: n };
        if !(lasting.max(1)..=n).contains(&order) {
            return Err(refuse());
        }
        let whole = &parts.decaying;
        let size = whole.a.nrows();
        let failed = |_| LinearError::Eigen { size };
        if size == 0 {
            return Ok(parts.lasting.beside(whole, "mode"));
        }
        let eigen = whole.a.eigen().map_err(failed)?;
        let poles: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
        let mut places: Vec<usize> = (0..size).collect();
        places.sort_by(|a, b| {
            let (a, b) = (poles[*a], poles[*b]);
            a.norm().total_cmp(&b.norm()).then(b.im.total_cmp(&a.im))
        });
        let vectors = eigen.U().to_owned();
        let forced = vectors.partial_piv_lu().solve(complex(&whole.b));
        let seen = complex(&whole.c) * &vectors;
        let (m, p) = (whole.b.ncols(), whole.c.nrows());
        let kept = order - lasting;
        let (mut d, mut blocks, mut count) = (whole.d.clone(), Vec::new(), 0);
        let mut rest = &places[..];
        while let [k, left @ ..] = rest {
            rest = left;
            let (k, pole) = (*k, poles[*k]);
            let is_pair = pole.im.abs() > REAL * pole.norm();
            // A pair stands together: equal magnitudes, opposite imaginary parts.
            if is_pair && pole.im < 0.0 {
                continue;
            }
            let width = if is_pair { 2 } else { 1 };
            if count + width <= kept {
                count += width;
                blocks.push((k, is_pair));
                continue;
            }
            if count < kept {
                return Err(refuse());
            }
            let times = if is_pair { 2.0 } else { 1.0 };
            for (i, j) in (0..p).flat_map(|i| (0..m).map(move |j| (i, j))) {
                d[(i, j)] -= times * (seen[(i, k)] * forced[(k, j)] / pole).re;
            }
        }
        let (mut a, mut b, mut c) = (Mat::zeros(kept, kept), Mat::zeros(kept, m), Mat::zeros(p, kept));
        let mut first = 0;
        for (k, is_pair) in blocks {
            let pole = poles[k];
            if is_pair {
                // z = ξ_k, real and imaginary: y = 2 Re(c ξ).
                a[(first, first)] = pole.re;
                a[(first, first + 1)] = -pole.im;
                a[(first + 1, first)] = pole.im;
                a[(first + 1, first + 1)] = pole.re;
                for j in 0..m {
                    b[(first, j)] = forced[(k, j)].re;
                    b[(first + 1, j)] = forced[(k, j)].im;
                }
                for i in 0..p {
                    c[(i, first)] = 2.0 * seen[(i, k)].re;
                    c[(i, first + 1)] = -2.0 * seen[(i, k)].im;
                }
                first += 2;
            } else {
                a[(first, first)] = pole.re;
                (0..m).for_each(|j| b[(first, j)] = forced[(k, j)].re);
                (0..p).for_each(|i| c[(i, first)] = seen[(i, k)].re);
                first += 1;
            }
        }
        let states = (1..=kept).map(|k| Channel::new(format!("z{k}"), "")).collect();
        let (inputs, outputs) = (self.inputs.clone(), self.outputs.clone());
        Ok(parts.lasting.beside(&StateSpace { a, b, c, d, states, inputs, outputs }, "mode"))
    }
}
