//! The manifold as markers and the Newton matrix of a system know it.

use crate::conservative::manifold::{Bent, Constants, MAX_BENT, Manifold, ManifoldPoint, along, bent_of};
use crate::matrix::triangle::entry;

/// M and the strain energy V beyond ½ qᵀΛq in the rows and columns of the bent modes; M of the other modes is 1.
#[derive(Debug, Clone, Default)]
pub(crate) struct BentTerms {
    /// The bent modes b.
    pub modes: Vec<usize>,
    /// Rows b of M: a list over all modes each, zero along the bent ones.
    pub across: Vec<f64>,
    /// M_bb less what the other modes have of it (b×b).
    pub left: Vec<f64>,
    /// ∂²V/∂q_b² (b×b).
    pub stiffness: Vec<f64>,
}

/// A place on a manifold of large modes, with its coordinates z.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BentPlace<'a> {
    pub manifold: &'a Manifold,
    pub point: &'a ManifoldPoint,
    pub z: &'a [f64],
}

impl BentTerms {
    /// The most bent modes that there are.
    pub const MOST: usize = MAX_BENT;

    /// The row of a bent mode, by its number among them, over all modes.
    pub fn row(&self, number: usize) -> &[f64] {
        let modes = self.across.len() / self.modes.len();
        &self.across[number * modes..][..modes]
    }
}

impl Manifold {
    /// Room for the terms of the bent modes.
    pub(crate) fn bent_terms(&self) -> BentTerms {
        let Constants { bent, modes, .. } = &*self.0;
        let square = vec![0.0; bent.len() * bent.len()];
        BentTerms {
            modes: bent.clone(),
            across: vec![0.0; bent.len() * modes],
            left: square.clone(),
            stiffness: square,
        }
    }

    /// Finds the terms of the bent modes at a place that has its M.
    pub(crate) fn find_bent_terms(&self, place: &ManifoldPoint, terms: &mut BentTerms) {
        let Constants { bent, stiffness, .. } = &*self.0;
        let n = bent.len();
        terms.across.copy_from_slice(&place.slopes);
        let mut of_energy = [0.0; MAX_BENT * (MAX_BENT + 1) / 2];
        stiffness.find(&place.monomials, &mut of_energy[..n * (n + 1) / 2]);
        for i in 0..n {
            for j in 0..=i {
                // L Lᵀ, with the reciprocals of the diagonal of L.
                let of = |i: usize, k: usize| {
                    let factor = place.factor[entry(i, k)];
                    if i == k { factor.recip() } else { factor }
                };
                let left = (0..=j).map(|k| of(i, k) * of(j, k)).sum();
                for (place, value) in [(&mut terms.left, left), (&mut terms.stiffness, of_energy[entry(i, j)])] {
                    (place[i * n + j], place[j * n + i]) = (value, value);
                }
            }
        }
    }

    /// The rates of the products at the modal velocities x.
    pub(crate) fn rates_of_products<'a>(
        &'a self,
        place: &'a ManifoldPoint,
        x: &[f64],
    ) -> impl Iterator<Item = f64> + use<'a> {
        let Constants { bent, factors, .. } = &*self.0;
        let mut of_bent = Bent::default();
        bent_of(bent, x, 0.0, &mut of_bent);
        place.partials.iter().zip(factors).map(move |(partials, factors)| along(partials, factors, &of_bent))
    }

    /// Adds the modal forces of forces on the products.
    pub(crate) fn add_forces_of_products(
        &self,
        place: &ManifoldPoint,
        forces: impl Iterator<Item = f64>,
        out: &mut [f64],
    ) {
        self.add_products(&place.partials, forces, out);
    }

    /// Shapes of the extended coordinates as shapes of z: columns Ψ E.
    pub(crate) fn by_coordinates<T>(&self, columns: &[T]) -> Vec<T>
    where
        T: Copy + std::iter::Sum + std::ops::Mul<f64, Output = T>,
    {
        let of = |column: faer::ColRef<'_, f64>| columns.iter().zip(column.iter()).map(|(shape, e)| *shape * *e).sum();
        self.0.shapes_by_coordinates.col_iter().map(of).collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use faer::Mat;
    use nalgebra::{DMatrix, Matrix3, Vector3};
    use reduced_body::{Constants, LargeProducts, ReducedBody, RigidMotion};

    use super::*;
    use crate::conservative::manifold::Parts;

    /// Made-up numbers.
    pub fn noise(seed: usize) -> f64 {
        (seed as f64 * 12.9898).sin() * 43_758.545_3 % 1.0
    }

    /// Four modes, of which one is large and one follows, and two shapes more.
    pub fn sample() -> Manifold {
        let (dynamic, extended, large, following) = (4, 6, vec![0], vec![2]);
        let rigid = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free()).unwrap();
        let zeros = || Mat::zeros(extended, extended);
        let constants = Constants {
            circular_frequencies: (0..extended).map(|k| 1.0 + k as f64).collect(),
            natural_modes: dynamic,
            rotation_products: std::array::from_fn(|_| std::array::from_fn(|_| Mat::zeros(6 + extended, 6 + extended))),
            position_products: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; 6 + extended])),
            inertia_first: std::array::from_fn(|_| vec![0.0; extended]),
            inertia_second: std::array::from_fn(|_| zeros()),
            gyroscopic: std::array::from_fn(|_| zeros()),
            translation_first: std::array::from_fn(|_| vec![0.0; extended]),
            rotation_first: std::array::from_fn(|_| vec![0.0; extended]),
            ..(*rigid).clone()
        };
        let products = LargeProducts { large: 1, following: 1 };
        let count = products.of_displacement().len();
        Manifold::of_parts(Parts {
            body: ReducedBody::from_constants(constants).unwrap(),
            dynamic,
            large,
            following,
            coefficients: Mat::from_fn(extended, count, |i, j| 0.4 * noise(3 + 7 * i + 31 * j)),
            energies: (0..products.of_energy().len()).map(|k| 2.0 * noise(200 + k)).collect(),
        })
        .unwrap()
    }

    /// Independent reference: differences of the coordinates of the shapes, of which M is DᵀD, and of the energy.
    #[test]
    fn the_terms_of_bent_modes_are_those_of_differences() {
        let manifold = sample();
        let (n, q) = (manifold.modes(), [0.4, -0.3, 0.5, 0.2]);
        let (mut place, mut z) = (manifold.place(), vec![0.0; manifold.size()]);
        manifold.go(&q, &mut place, &mut z);
        let mut terms = manifold.bent_terms();
        manifold.find_bent_terms(&place, &mut terms);
        let step = 1e-4;
        let moved = |by: &[(usize, f64)]| {
            let mut q = q;
            by.iter().for_each(|(k, step)| q[*k] += step);
            q
        };
        let xi = |by: &[(usize, f64)]| {
            let mut xi = vec![0.0; manifold.body().flexible()];
            manifold.coordinates(&moved(by), &mut xi);
            xi
        };
        let slope = |k: usize| -> Vec<f64> {
            let [ahead, back] = [step, -step].map(|step| xi(&[(k, step)]));
            ahead.iter().zip(&back).map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let slopes: Vec<Vec<f64>> = (0..n).map(slope).collect();
        let mass = DMatrix::from_fn(n, n, |i, j| slopes[i].iter().zip(&slopes[j]).map(|(a, b)| a * b).sum::<f64>());
        let bent = manifold.bent().len();
        for (a, i) in terms.modes.iter().enumerate() {
            for k in (0..n).filter(|k| !terms.modes.contains(k)) {
                assert!((terms.row(a)[k] - mass[(*i, k)]).abs() < 1e-7, "{i} {k}");
            }
            for (b, j) in terms.modes.iter().enumerate() {
                let of_others: f64 = terms.row(a).iter().zip(terms.row(b)).map(|(a, b)| a * b).sum();
                assert!((terms.left[a * bent + b] + of_others - mass[(*i, *j)]).abs() < 1e-7, "{i} {j}");
                let energy = |x: f64, y: f64| manifold.energy(&moved(&[(*i, x), (*j, y)]));
                let around = energy(step, step) - energy(step, -step) - energy(-step, step) + energy(-step, -step);
                assert!((terms.stiffness[a * bent + b] - around / (4.0 * step * step)).abs() < 1e-6, "{i} {j}");
            }
        }
    }
}
