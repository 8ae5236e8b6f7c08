//! Rows and columns of bent modes, with large modes, in the mass and in the Newton matrix of a body's modes.
//!
//! With C the columns of M of the bent modes b in the rows of the others, and z of these on the diagonal,
//!
//! ```text
//! Z = [z  κC; κCᵀ  κM_b + D_b + K_b/κ],   K_b = Λ_b + ∂²V/∂q_b²,   M_b = (M_b − CᵀC) + CᵀC
//! B = κ (M_b − CᵀC) + κ Cᵀ(1 − κz⁻¹)C + D_b + K_b/κ        what the others leave to the bent ones
//! ```
//!
//! M is the same with κ = 1 and without D and K.

use crate::conservative::manifold::{BentTerms, Manifold};
use crate::matrix::triangle::entry;
use crate::system::elimination::number::Number;

/// M of the modes of a body with large modes, and its inverse.
#[derive(Debug, Clone)]
pub(crate) struct BentInertia {
    pub terms: BentTerms,
    /// M⁻¹S.
    pub solved: [Vec<f64>; 3],
    inverse: Factor<f64>,
}

impl BentInertia {
    pub fn new(manifold: &Manifold, flexible: usize) -> Self {
        let terms = manifold.bent_terms();
        let inverse = Factor::new(terms.modes.len());
        Self { terms, solved: std::array::from_fn(|_| vec![0.0; flexible]), inverse }
    }

    /// Finds M⁻¹ of the terms, and M⁻¹S.
    pub fn solve_coupling(&mut self, coupling: &[Vec<f64>; 3]) {
        let Self { terms, inverse, .. } = self;
        inverse.find(terms.modes.len(), |i, j| terms.left[i * terms.modes.len() + j]);
        for (axis, s) in coupling.iter().enumerate() {
            let mut list = std::mem::take(&mut self.solved[axis]);
            list.copy_from_slice(s);
            self.solve(&mut list);
            self.solved[axis] = list;
        }
    }

    /// x = M x
    pub fn multiply<T: Number>(&self, x: &mut [T]) {
        let BentTerms { modes, left, .. } = &self.terms;
        let own = bent_of(modes, x);
        for (a, own) in own.iter().enumerate().take(modes.len()) {
            x.iter_mut().zip(self.terms.row(a)).for_each(|(x, c)| *x += own.scale(*c));
        }
        for (a, mode) in modes.iter().enumerate() {
            let mut sum = T::from_real(0.0);
            x.iter().zip(self.terms.row(a)).for_each(|(x, c)| sum += x.scale(*c));
            own.iter().zip(&left[a * modes.len()..][..modes.len()]).for_each(|(x, m)| sum += x.scale(*m));
            x[*mode] = sum;
        }
    }

    /// x = M⁻¹ x
    pub fn solve<T: Number>(&self, x: &mut [T]) {
        let BentTerms { modes, .. } = &self.terms;
        let mut own = bent_of(modes, x);
        for (a, own) in own.iter_mut().enumerate().take(modes.len()) {
            x.iter().zip(self.terms.row(a)).for_each(|(x, c)| *own -= x.scale(*c));
        }
        self.inverse.solve(&mut own[..modes.len()], |factor| T::from_real(factor));
        for (a, own) in own.iter().enumerate().take(modes.len()) {
            x.iter_mut().zip(self.terms.row(a)).for_each(|(x, c)| *x -= own.scale(*c));
        }
        modes.iter().zip(own).for_each(|(mode, own)| x[*mode] = own);
    }

    /// Adds factor × ∂²V/∂q² x to forces.
    pub fn add_stiffness<T: Number>(&self, factor: T, x: &[T], forces: &mut [T]) {
        let BentTerms { modes, stiffness, .. } = &self.terms;
        for (row, mode) in stiffness.chunks_exact(modes.len()).zip(modes) {
            row.iter().zip(modes).for_each(|(k, of)| forces[*mode] += factor * x[*of].scale(*k));
        }
    }
}

/// The bent ones of a list over all modes.
fn bent_of<T: Number>(modes: &[usize], x: &[T]) -> [T; BentTerms::MOST] {
    let mut own = [T::from_real(0.0); BentTerms::MOST];
    own.iter_mut().zip(modes).for_each(|(own, mode)| *own = x[*mode]);
    own
}

/// Z⁻¹ of the modes of a body with large modes.
#[derive(Debug, Clone)]
pub(crate) struct BentInverse<T> {
    modes: Vec<usize>,
    /// κC, a list over all modes for each bent one.
    across: Vec<T>,
    /// Z⁻¹S.
    pub solved: [Vec<T>; 3],
    factor: Factor<T>,
}

impl<T: Number> BentInverse<T> {
    pub fn new(manifold: &Manifold, flexible: usize) -> Self {
        let BentTerms { modes, across, .. } = manifold.bent_terms();
        let zero = T::from_real(0.0);
        Self {
            across: vec![zero; across.len()],
            solved: std::array::from_fn(|_| vec![zero; flexible]),
            factor: Factor::new(modes.len()),
            modes,
        }
    }

    /// Takes M⁻¹ and M⁻¹S for it.
    pub fn copy_of_mass(&mut self, of_mass: &BentInertia) {
        let solved = self.solved.iter_mut().zip(&of_mass.solved);
        let lists = [(&mut self.across, &of_mass.terms.across), (&mut self.factor.0, &of_mass.inverse.0)];
        for (own, list) in solved.chain(lists) {
            own.iter_mut().zip(list).for_each(|(own, number)| *own = T::from_real(*number));
        }
    }

    /// Finds it, by z⁻¹ of each mode and by Λ and D of each.
    pub fn find(&mut self, kappa: T, terms: &BentTerms, inverses: &[T], oscillators: impl Fn(usize) -> [f64; 2]) {
        let (n, modes) = (self.modes.len(), &self.modes);
        self.across.iter_mut().zip(&terms.across).for_each(|(own, c)| *own = kappa.scale(*c));
        self.factor.find(n, |i, j| {
            let mut of_others = T::from_real(0.0);
            for ((a, b), inverse) in terms.row(i).iter().zip(terms.row(j)).zip(inverses) {
                of_others += (T::from_real(1.0) - kappa * *inverse).scale(a * b);
            }
            let mut sum = kappa * (T::from_real(terms.left[i * n + j]) + of_others);
            sum += T::from_real(terms.stiffness[i * n + j]) / kappa;
            if i == j {
                let [stiffness, damping] = oscillators(modes[i]);
                sum += T::from_real(damping) + T::from_real(stiffness) / kappa;
            }
            sum
        });
    }

    /// Finds Z⁻¹S.
    pub fn solve_coupling(&mut self, inverses: &[T], coupling: &[Vec<f64>; 3]) {
        for (axis, s) in coupling.iter().enumerate() {
            let mut list = std::mem::take(&mut self.solved[axis]);
            list.iter_mut().zip(s).for_each(|(own, s)| *own = T::from_real(*s));
            self.apply(inverses, &mut list);
            self.solved[axis] = list;
        }
    }

    /// x = Z⁻¹ x
    pub fn apply(&self, inverses: &[T], x: &mut [T]) {
        let rows = || self.across.chunks_exact(inverses.len().max(1));
        let mut own = bent_of(&self.modes, x);
        x.iter_mut().zip(inverses).for_each(|(x, inverse)| *x *= *inverse);
        for (row, own) in rows().zip(&mut own) {
            x.iter().zip(row).for_each(|(x, c)| *own -= *c * *x);
        }
        self.factor.solve(&mut own[..self.modes.len()], |factor| factor);
        for (row, own) in rows().zip(&own) {
            x.iter_mut().zip(row.iter().zip(inverses)).for_each(|(x, (c, inverse))| *x -= *inverse * *c * *own);
        }
        self.modes.iter().zip(own).for_each(|(mode, own)| x[*mode] = own);
    }
}

/// L and d⁻¹ of a symmetric matrix L diag(d) Lᵀ: entries i ≥ j, row by row, d⁻¹ on the diagonal.
#[derive(Debug, Clone)]
struct Factor<T>(Vec<T>);

impl<T: Number> Factor<T> {
    fn new(size: usize) -> Self {
        Self(vec![T::from_real(1.0); size * (size + 1) / 2])
    }

    /// Finds them from the entries i ≥ j of a matrix.
    fn find(&mut self, size: usize, of: impl Fn(usize, usize) -> T) {
        let Self(factor) = self;
        for i in 0..size {
            // The row times d first.
            for j in 0..=i {
                let mut sum = of(i, j);
                for k in 0..j {
                    let other = factor[entry(j, k)];
                    sum -= factor[entry(i, k)] * if i == j { factor[entry(i, k)] * factor[entry(k, k)] } else { other };
                }
                factor[entry(i, j)] = sum;
            }
            for j in 0..i {
                let scaled = factor[entry(i, j)] * factor[entry(j, j)];
                factor[entry(i, j)] = scaled;
            }
            factor[entry(i, i)] = factor[entry(i, i)].recip();
        }
    }

    /// x = A⁻¹ x
    fn solve<X: Number>(&self, x: &mut [X], number: impl Fn(T) -> X) {
        let Self(factor) = self;
        for i in 0..x.len() {
            for k in 0..i {
                let known = x[k];
                x[i] -= number(factor[entry(i, k)]) * known;
            }
        }
        for i in 0..x.len() {
            x[i] *= number(factor[entry(i, i)]);
        }
        for i in (0..x.len()).rev() {
            for k in i + 1..x.len() {
                let known = x[k];
                x[i] -= number(factor[entry(k, i)]) * known;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix, DVector};

    use super::*;

    fn terms() -> BentTerms {
        let (modes, flexible) = (vec![3, 0], 5);
        let mut across = vec![0.0; 2 * flexible];
        for (place, value) in [(1, 0.3), (2, -0.2), (4, 0.5), (6, 0.1), (7, 0.4), (9, -0.3)] {
            across[place] = value;
        }
        BentTerms { modes, across, left: vec![1.5, 0.2, 0.2, 1.2], stiffness: vec![3.0, -1.0, -1.0, 2.0] }
    }

    /// M, entry by entry.
    fn mass(BentTerms { modes, across, left, .. }: &BentTerms) -> DMatrix<f64> {
        let n = across.len() / modes.len();
        let mut m = DMatrix::identity(n, n);
        for (a, i) in modes.iter().enumerate() {
            for (b, j) in modes.iter().enumerate() {
                let of_others: f64 = (0..n).map(|k| across[a * n + k] * across[b * n + k]).sum();
                m[(*i, *j)] = left[a * modes.len() + b] + of_others;
            }
            for k in (0..n).filter(|k| !modes.contains(k)) {
                (m[(*i, k)], m[(k, *i)]) = (across[a * n + k], across[a * n + k]);
            }
        }
        m
    }

    /// Conserved: M and Z entry by entry times the answers.
    #[test]
    fn inverses_are_those_of_the_sums() {
        let terms = terms();
        let m = mass(&terms);
        let oscillators = [[9.0, 0.1], [4e4, 3.0], [2.0, 0.0], [1e2, 0.5], [7.0, 0.2]];
        let coupling = std::array::from_fn(|axis| (0..5).map(|k| (k + axis) as f64 * 0.1 - 0.2).collect::<Vec<_>>());
        let mut inertia = BentInertia {
            solved: std::array::from_fn(|_| vec![0.0; 5]),
            inverse: Factor::new(2),
            terms: terms.clone(),
        };
        inertia.solve_coupling(&coupling);
        let x: Vec<f64> = vec![0.3, -1.0, 2.0, 0.7, -0.4];
        let mut times = x.clone();
        inertia.multiply(&mut times);
        assert!((DVector::from_vec(times.clone()) - &m * DVector::from_vec(x.clone())).norm() < 1e-14);
        inertia.solve(&mut times);
        times.iter().zip(&x).for_each(|(a, b)| assert!((a - b).abs() < 1e-14));
        assert!(
            (&m * DVector::from_vec(inertia.solved[1].clone()) - DVector::from_vec(coupling[1].clone())).norm() < 1e-14
        );

        let kappa = Complex::new(20.0, 30.0);
        let mut z = m.map(|entry| kappa * entry);
        for (k, [stiffness, damping]) in oscillators.into_iter().enumerate() {
            z[(k, k)] += damping + stiffness / kappa;
        }
        for (a, i) in terms.modes.iter().enumerate() {
            for (b, j) in terms.modes.iter().enumerate() {
                z[(*i, *j)] += terms.stiffness[a * 2 + b] / kappa;
            }
        }
        let mut inverse: BentInverse<Complex<f64>> = BentInverse {
            modes: terms.modes.clone(),
            across: vec![Complex::new(0.0, 0.0); 10],
            solved: std::array::from_fn(|_| vec![Complex::new(0.0, 0.0); 5]),
            factor: Factor::new(2),
        };
        let inverses = oscillators.map(|[stiffness, damping]| (kappa + damping + stiffness / kappa).inv());
        inverse.find(kappa, &terms, &inverses, |k| oscillators[k]);
        let y: Vec<Complex<f64>> = x.iter().map(|x| Complex::new(*x, 0.5 - x)).collect();
        let mut found = y.clone();
        inverse.apply(&inverses, &mut found);
        assert!((z * DVector::from_vec(found) - DVector::from_vec(y)).norm() < 1e-12);
    }
}
