//! A body of a system whose numbers vary: Eqs. (D19) and (D20) of `docs/method/gradients.md`.

use faer::{Mat, c64};
use model::{BodyInJoints, Model, RatesInJoints};

use super::damping::Damped;

/// Eigenvalues that are apart by less than this part are one.
pub(super) const REPEATED: f64 = 1e-8;

/// A body of it with the rates of some of its numbers.
pub(super) struct Varying<'a> {
    pub model: &'a Model,
    /// First of its coordinates.
    pub first: usize,
    pub body: BodyInJoints,
    pub damping: Vec<Damped>,
}

impl Varying<'_> {
    /// Its part of a motion of the system.
    pub fn own<'x>(&self, motion: &'x [c64]) -> &'x [c64] {
        &motion[self.first..self.first + 6 + self.model.body.flexible()]
    }

    /// xᵀ(s²M' + sC' + K')y − wᵀ(FᵀX)'y − vᵀ(FᵀX)'x of two motions x and y as exp(st), with the forces w and v that its markers bear in them beside
    /// forces on its coordinates.
    pub fn change(&self, s: c64, [x, y]: [&[c64]; 2], forces: [&[f64]; 2], rates: &RatesInJoints) -> c64 {
        let [x, y] = [x, y].map(|motion| self.own(motion));
        let [x_bent, y_bent] = [&x[6..], &y[6..]];
        let by_damping = match self.damping.is_empty() {
            true => c64::ZERO,
            false => s * product(&self.damping_rate(rates), x_bent, y_bent),
        };
        let own = s * s * product(&rates.mass, x, y) + by_damping + product(&rates.stiffness, x_bent, y_bent);
        own - product(&rates.markers, &self.borne(s, x, forces[0]), y_bent)
            - product(&rates.markers, &self.borne(s, y, forces[1]), x_bent)
    }

    /// Forces of the markers in a motion x as exp(st): (s²M + sC + K) x by them and by other forces, of which an empty list is none.
    fn borne(&self, s: c64, x: &[c64], others: &[f64]) -> Vec<c64> {
        let BodyInJoints { mass, bearing, .. } = &self.body;
        let mut force = times(mass, x);
        force.iter_mut().for_each(|force| *force *= s * s);
        for (k, omega) in self.model.body.circular_frequencies.iter().enumerate() {
            let damping = self.damping.get(k).map_or(0.0, |mode| mode.damping);
            force[6 + k] += (s * damping + omega * omega) * x[6 + k];
        }
        force.iter_mut().zip(others).for_each(|(force, other)| *force -= other);
        times(bearing, &force)
    }

    /// C' of the modes, whose damping is a function of their eigenvalues: of divided differences.
    fn damping_rate(&self, rates: &RatesInJoints) -> Mat<f64> {
        let omegas = &self.model.body.circular_frequencies;
        let lambda = |k: usize| omegas[k] * omegas[k];
        Mat::from_fn(omegas.len(), omegas.len(), |j, k| {
            let (first, second) = (&self.damping[j], &self.damping[k]);
            let apart = lambda(k) - lambda(j);
            let [of_stiffness, of_mass] = if apart.abs() <= REPEATED * lambda(k) {
                let slope = second.slope / (2.0 * omegas[k]);
                [slope, second.damping - lambda(k) * slope]
            } else {
                let mixed = lambda(k) * first.damping - lambda(j) * second.damping;
                [(second.damping - first.damping) / apart, mixed / apart]
            };
            rates.stiffness[(j, k)] * of_stiffness + rates.mass[(6 + j, 6 + k)] * of_mass
        })
    }
}

pub(super) fn times(matrix: &Mat<f64>, x: &[c64]) -> Vec<c64> {
    (0..matrix.nrows()).map(|i| x.iter().enumerate().map(|(k, x)| *x * matrix[(i, k)]).sum()).collect()
}

/// xᵀ A y
pub(super) fn product(matrix: &Mat<f64>, x: &[c64], y: &[c64]) -> c64 {
    x.iter().zip(times(matrix, y)).map(|(x, y)| x * y).sum()
}
