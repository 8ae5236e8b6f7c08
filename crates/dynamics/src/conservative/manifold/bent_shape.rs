//! The manifold about a place on it, as linearised equations know it.
//!
//! Eq. (L12) of `docs/method/systems.md`.
//!
//! ```text
//! δz = B δq + ½ Σ_ij z_ij δq_i δq_j        B = ∂z/∂q,  z_ij = ∂²z/∂q_i∂q_j
//! ```

use faer::Mat;

use crate::conservative::ConservativeBody;
use crate::conservative::manifold::{BentPlace, BentTerms, Manifold, ManifoldPoint};

/// A shape of a body with large modes.
#[derive(Debug, Clone)]
pub(crate) struct BentShape {
    manifold: Manifold,
    point: ManifoldPoint,
    z: Vec<f64>,
}

impl BentShape {
    /// The shape of a body at some modal displacements; `None` without large modes.
    pub fn of(body: &ConservativeBody, q: &[f64]) -> Option<Self> {
        let manifold = body.manifold.clone()?;
        let mut shape = Self { point: manifold.place(), z: vec![0.0; manifold.size()], manifold };
        shape.go(q);
        Some(shape)
    }

    /// Goes to other ones.
    pub fn go(&mut self, q: &[f64]) {
        self.manifold.go(q, &mut self.point, &mut self.z);
    }

    pub fn place(&self) -> BentPlace<'_> {
        BentPlace { manifold: &self.manifold, point: &self.point, z: &self.z }
    }
}

impl Manifold {
    /// The rates of ξ, then of the products, at q and a unit velocity of each mode: a list for each.
    pub fn slopes(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let (mut point, mut z) = (self.place(), vec![0.0; self.size()]);
        self.go_to(q, &mut point, &mut z);
        let of_mode = |slope: Vec<f64>| {
            let mut rates = vec![0.0; self.0.body.flexible()];
            self.in_shapes(&slope, &mut rates);
            rates.extend(&slope[self.0.modes..]);
            rates
        };
        BentPlace { manifold: self, point: &point, z: &z }.slopes().into_iter().map(of_mode).collect()
    }
}

impl BentPlace<'_> {
    /// The shape, of its own.
    pub fn to_shape(self) -> BentShape {
        BentShape { manifold: self.manifold.clone(), point: self.point.clone(), z: self.z.to_vec() }
    }

    /// B, column by column: one for each mode.
    pub fn slopes(&self) -> Vec<Vec<f64>> {
        let modes = self.manifold.modes();
        let column = |k: usize| {
            let mut unit = vec![0.0; modes];
            unit[k] = 1.0;
            let mut out = vec![0.0; self.z.len()];
            self.manifold.extend(self.point, &unit, &mut out);
            out
        };
        (0..modes).map(column).collect()
    }

    /// Σ y z_ij of forces or momenta y on z (modes × modes).
    pub fn curvature(&self, y: impl Iterator<Item = f64>) -> Mat<f64> {
        let modes = self.manifold.modes();
        let bent = self.manifold.bent();
        let mut sums = Mat::zeros(modes, modes);
        let x = &self.point.displacement;
        for ([i, j, k], y) in self.manifold.0.factors.iter().zip(y.skip(modes)) {
            for (a, b, rest) in [(*i, *j, *k), (*i, *k, *j), (*j, *k, *i)] {
                // A product of two modes has a one as its third factor.
                if let (Some(a), Some(b)) = (bent.get(a), bent.get(b)) {
                    sums[(*a, *b)] += x[rest] * y;
                    sums[(*b, *a)] += x[rest] * y;
                }
            }
        }
        sums
    }

    /// M (modes × modes).
    pub fn mass(&self) -> Mat<f64> {
        let slopes = self.slopes();
        let of_shapes = |z: &Vec<f64>| {
            let mut xi = vec![0.0; self.manifold.body().flexible()];
            self.manifold.in_shapes(z, &mut xi);
            xi
        };
        let columns: Vec<Vec<f64>> = slopes.iter().map(of_shapes).collect();
        let product = |i: usize, j: usize| columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
        Mat::from_fn(columns.len(), columns.len(), product)
    }

    /// The terms of the bent modes.
    pub fn terms(&self) -> BentTerms {
        let mut terms = self.manifold.bent_terms();
        self.manifold.find_bent_terms(self.point, &mut terms);
        terms
    }

    /// ξ.
    pub fn coordinates(&self) -> Vec<f64> {
        let mut xi = vec![0.0; self.manifold.body().flexible()];
        self.manifold.in_shapes(self.z, &mut xi);
        xi
    }

    /// The rates of ξ at modal velocities.
    pub fn rates_of_coordinates(&self, rate: &[f64]) -> Vec<f64> {
        let mut along = vec![0.0; self.z.len()];
        self.manifold.extend(self.point, rate, &mut along);
        let mut nu = vec![0.0; self.manifold.body().flexible()];
        self.manifold.in_shapes(&along, &mut nu);
        nu
    }

    /// Adds Dᵀ of forces on ξ to modal forces.
    pub fn add_from_shapes(&self, force: &[f64], modal: &mut [f64]) {
        let mut on_z = vec![0.0; self.z.len()];
        self.manifold.add_from_shapes(force, &mut on_z);
        self.manifold.add_projection(self.point, &on_z, modal);
    }

    /// Subtracts the derivatives of the strain energy beyond ½ qᵀΛq from modal forces.
    pub fn subtract_force(&self, modal: &mut [f64]) {
        self.manifold.subtract_force(self.point, modal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conservative::manifold::in_joints::tests::sample;

    /// Independent reference: central differences of z, and of its slopes.
    #[test]
    fn slopes_and_curvatures_are_those_of_differences() {
        let manifold = sample();
        let (modes, q) = (manifold.modes(), [0.4, -0.3, 0.5, 0.2]);
        let at = |k: usize, by: f64| {
            let mut q = q.to_vec();
            q[k] += by;
            let mut shape =
                BentShape { point: manifold.place(), z: vec![0.0; manifold.size()], manifold: manifold.clone() };
            shape.go(&q);
            shape
        };
        let here = at(0, 0.0);
        let y: Vec<f64> = (0..manifold.size()).map(|k| 0.3 - 0.1 * k as f64).collect();
        let curvature = here.place().curvature(y.iter().copied());
        let step = 1e-4;
        for k in 0..modes {
            let [ahead, back] = [at(k, step), at(k, -step)];
            let slope = &here.place().slopes()[k];
            for (slope, (ahead, back)) in slope.iter().zip(ahead.z.iter().zip(&back.z)) {
                let expected = (ahead - back) / (2.0 * step);
                assert!((slope - expected).abs() < 1e-7, "{k}: {slope} {expected}");
            }
            for j in 0..modes {
                let along = |shape: &BentShape| -> f64 {
                    shape.place().slopes()[j].iter().zip(&y).map(|(slope, y)| slope * y).sum()
                };
                let expected = (along(&ahead) - along(&back)) / (2.0 * step);
                assert!((curvature[(j, k)] - expected).abs() < 1e-8, "{j} {k}: {} {expected}", curvature[(j, k)]);
            }
        }
    }
}
