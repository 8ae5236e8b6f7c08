//! The inverse of Z = κ M + D + Λ/κ of one body, by a 3×3 matrix: Eq. (J8) of `docs/method/systems.md`.

use nalgebra::{Matrix3, Vector3};

use crate::conservative::ConservativeBody;
use crate::system::elimination::bent::{BentInertia, BentInverse};
use crate::system::elimination::number::Number;

/// The inertia of a body where it is.
#[derive(Debug, Clone)]
pub(crate) struct Inertia {
    pub mass: f64,
    /// J − SᵀM⁻¹S, with M of the modes: 1, but with large modes.
    pub locked: Matrix3<f64>,
    pub locked_inverse: Matrix3<f64>,
    /// S, a list (nf) for each axis.
    pub coupling: [Vec<f64>; 3],
    /// M of the modes beside 1, with large modes.
    pub bent: Option<BentInertia>,
}

impl Inertia {
    pub fn new(flexible: usize) -> Self {
        let coupling = std::array::from_fn(|_| vec![0.0; flexible]);
        Self { mass: 1.0, locked: Matrix3::identity(), locked_inverse: Matrix3::identity(), coupling, bent: None }
    }

    /// Room for that of a body.
    pub fn of(body: &ConservativeBody) -> Self {
        let bent = body.manifold.as_ref().map(|manifold| BentInertia::new(manifold, body.flexible()));
        Self { bent, ..Self::new(body.flexible()) }
    }

    /// True of a point mass, which does not turn.
    pub fn is_point(&self) -> bool {
        self.locked == Matrix3::zeros()
    }

    /// M⁻¹S.
    fn solved_coupling(&self) -> &[Vec<f64>; 3] {
        self.bent.as_ref().map_or(&self.coupling, |bent| &bent.solved)
    }

    /// J.
    pub fn whole(&self) -> Matrix3<f64> {
        let mut sum = self.locked;
        for (i, a) in self.solved_coupling().iter().enumerate() {
            for (j, b) in self.coupling.iter().enumerate() {
                sum[(i, j)] += a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        sum
    }

    /// Turns generalised forces (F, τ, Q) into the velocities M⁻¹ of them.
    pub fn solve<T: Number>(&self, x: &mut [T]) {
        let (rigid, modal) = x.split_at_mut(6);
        rigid[..3].iter_mut().for_each(|force| *force = force.unscale(self.mass));
        if let Some(bent) = &self.bent {
            bent.solve(modal);
        }
        let mut right = Vector3::new(rigid[3], rigid[4], rigid[5]);
        for (right, s) in right.iter_mut().zip(&self.coupling) {
            s.iter().zip(&*modal).for_each(|(s, q)| *right -= q.scale(*s));
        }
        let spin = product(&self.locked_inverse, &right);
        rigid[3..].copy_from_slice(spin.as_slice());
        for (s, w) in self.solved_coupling().iter().zip(spin.iter()) {
            modal.iter_mut().zip(s).for_each(|(q, s)| *q -= w.scale(*s));
        }
    }

    /// Turns velocities (V, ω, q̇) into the momenta M of them.
    pub fn multiply<T: Number>(&self, x: &mut [T]) {
        let (rigid, modal) = x.split_at_mut(6);
        rigid[..3].iter_mut().for_each(|velocity| *velocity = velocity.scale(self.mass));
        let spin = Vector3::new(rigid[3], rigid[4], rigid[5]);
        for (s, w) in self.solved_coupling().iter().zip(spin.iter()) {
            modal.iter_mut().zip(s).for_each(|(q, s)| *q += w.scale(*s));
        }
        let mut moment = product(&self.locked, &spin);
        for (moment, s) in moment.iter_mut().zip(&self.coupling) {
            s.iter().zip(&*modal).for_each(|(s, q)| *moment += q.scale(*s));
        }
        rigid[3..].copy_from_slice(moment.as_slice());
        if let Some(bent) = &self.bent {
            bent.multiply(modal);
        }
    }
}

/// A x of a real matrix.
pub(crate) fn product<T: Number>(a: &Matrix3<f64>, x: &Vector3<T>) -> Vector3<T> {
    Vector3::from_fn(|i, _| x[0].scale(a[(i, 0)]) + x[1].scale(a[(i, 1)]) + x[2].scale(a[(i, 2)]))
}

/// Z⁻¹ of a body.
#[derive(Debug, Clone)]
pub(crate) struct Inverse<T> {
    kappa: T,
    mass: T,
    /// z⁻¹ of each mode (nf); without large modes that of the modes is this diagonal.
    modes: Vec<T>,
    bent: Option<BentInverse<T>>,
    coupling: [Vec<f64>; 3],
    /// K of the body: see [`super::tension`].
    pub tension: Matrix3<f64>,
    /// (κ J − κ² Sᵀ z⁻¹ S + K/κ)⁻¹
    spin: Matrix3<T>,
}

impl<T: Number> Inverse<T> {
    pub fn new(flexible: usize) -> Self {
        let one = T::from_real(1.0);
        let coupling = std::array::from_fn(|_| vec![0.0; flexible]);
        let (spin, tension) = (Matrix3::identity(), Matrix3::zeros());
        Self { kappa: one, mass: one, modes: vec![one; flexible], bent: None, coupling, tension, spin }
    }

    /// Room for that of a body.
    pub fn of(body: &ConservativeBody) -> Self {
        let bent = body.manifold.as_ref().map(|manifold| BentInverse::new(manifold, body.flexible()));
        Self { bent, ..Self::new(body.flexible()) }
    }

    /// Finds M⁻¹. False where M is singular.
    pub fn find_of_mass(&mut self, inertia: &Inertia) -> bool {
        let one = T::from_real(1.0);
        self.begin(one, inertia);
        self.modes.fill(one);
        if let (Some(bent), Some(of_mass)) = (&mut self.bent, &inertia.bent) {
            bent.copy_of_mass(of_mass);
        }
        self.invert(&inertia.locked.map(T::from_real), inertia)
    }

    /// Finds it for κ; `oscillators` are Λ_k and D_k of each mode. False where Z is singular.
    pub fn find(&mut self, kappa: T, inertia: &Inertia, oscillators: impl Fn(usize) -> [f64; 2]) -> bool {
        self.begin(kappa, inertia);
        for (k, inverse) in self.modes.iter_mut().enumerate() {
            let [stiffness, damping] = oscillators(k);
            *inverse = (kappa + T::from_real(damping) + T::from_real(stiffness) / kappa).recip();
        }
        // J = (J − SᵀM⁻¹S) + SᵀM⁻¹S, so that the sum is κ (J − SᵀM⁻¹S) + κ Sᵀ (M⁻¹ − κ z⁻¹) S.
        let mut spin = inertia
            .locked
            .zip_map(&self.tension, |entry, tension| kappa * T::from_real(entry) + T::from_real(tension) / kappa);
        if let (Some(bent), Some(of_mass)) = (&mut self.bent, &inertia.bent) {
            bent.find(kappa, &of_mass.terms, &self.modes, oscillators);
            bent.solve_coupling(&self.modes, &inertia.coupling);
            for (i, a) in inertia.coupling.iter().enumerate() {
                for j in 0..3 {
                    for (a, (of_mass, inverse)) in a.iter().zip(of_mass.solved[j].iter().zip(&bent.solved[j])) {
                        spin[(i, j)] += kappa * (T::from_real(*of_mass) - kappa * *inverse).scale(*a);
                    }
                }
            }
        } else {
            for (i, a) in inertia.coupling.iter().enumerate() {
                for (j, b) in inertia.coupling.iter().enumerate().take(i + 1) {
                    let mut sum = T::from_real(0.0);
                    for ((a, b), inverse) in a.iter().zip(b).zip(&self.modes) {
                        sum += (T::from_real(1.0) - kappa * *inverse).scale(a * b);
                    }
                    sum *= kappa;
                    spin[(i, j)] += sum;
                    if i != j {
                        spin[(j, i)] += sum;
                    }
                }
            }
        }
        self.invert(&spin, inertia)
    }

    fn begin(&mut self, kappa: T, inertia: &Inertia) {
        (self.kappa, self.mass) = (kappa, kappa * T::from_real(inertia.mass));
        for (own, s) in self.coupling.iter_mut().zip(&inertia.coupling) {
            own.copy_from_slice(s);
        }
    }

    /// Takes the inverse of what the modes leave to the spin; a point mass has none. False where that is singular.
    fn invert(&mut self, spin: &Matrix3<T>, inertia: &Inertia) -> bool {
        if inertia.is_point() {
            self.spin = Matrix3::zeros();
            return true;
        }
        match spin.try_inverse() {
            Some(inverse) => self.spin = inverse,
            None => return false,
        }
        self.spin.iter().all(|entry| entry.is_finite())
    }

    /// Turns (F, τ, Q) into (V, ω, q̇).
    pub fn apply(&self, x: &mut [T]) {
        let (rigid, modal) = x.split_at_mut(6);
        let inverse_mass = self.mass.recip();
        rigid[..3].iter_mut().for_each(|force| *force *= inverse_mass);
        let mut right = Vector3::new(rigid[3], rigid[4], rigid[5]);
        match &self.bent {
            Some(bent) => bent.apply(&self.modes, modal),
            None => modal.iter_mut().zip(&self.modes).for_each(|(q, inverse)| *q *= *inverse),
        }
        for (i, s) in self.coupling.iter().enumerate() {
            let mut sum = T::from_real(0.0);
            s.iter().zip(&*modal).for_each(|(s, q)| sum += q.scale(*s));
            right[i] -= self.kappa * sum;
        }
        let spin = self.spin * right;
        rigid[3..].copy_from_slice(spin.as_slice());
        for (axis, w) in spin.iter().enumerate() {
            let w = self.kappa * *w;
            match &self.bent {
                Some(bent) => modal.iter_mut().zip(&bent.solved[axis]).for_each(|(q, s)| *q -= w * *s),
                None => {
                    for ((q, s), inverse) in modal.iter_mut().zip(&self.coupling[axis]).zip(&self.modes) {
                        *q -= *inverse * w.scale(*s);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    /// Conserved: Z Z⁻¹ = 1, with Z applied term by term.
    #[test]
    fn the_inverse_is_that_of_the_sum() {
        let locked = Matrix3::new(2.0, 0.1, -0.2, 0.1, 3.0, 0.3, -0.2, 0.3, 1.5);
        let coupling = [vec![0.3, -0.2], vec![0.1, 0.5], vec![-0.4, 0.2]];
        let inertia =
            Inertia { mass: 2.5, locked, locked_inverse: locked.try_inverse().unwrap(), coupling, bent: None };
        let oscillators = [[9.0, 0.1], [4e6, 3.0]];
        let kappa = Complex::new(20.0, 30.0);
        let mut inverse = Inverse::new(2);
        assert!(inverse.find(kappa, &inertia, |k| oscillators[k]));
        let start: Vec<Complex<f64>> = (0..8).map(|k| Complex::new(f64::from(k) - 3.0, 0.5 * f64::from(k))).collect();
        let mut velocity = start.clone();
        inverse.apply(&mut velocity);
        let mut back = velocity.clone();
        inertia.multiply(&mut back);
        back.iter_mut().for_each(|x| *x *= kappa);
        for (k, [stiffness, damping]) in oscillators.into_iter().enumerate() {
            back[6 + k] += velocity[6 + k] * (damping + stiffness / kappa);
        }
        start.iter().zip(&back).for_each(|(a, b)| assert!((a - b).norm() < 1e-12, "{a} {b}"));
        let mut there = start.clone();
        inertia.solve(&mut there);
        inertia.multiply(&mut there);
        start.iter().zip(&there).for_each(|(a, b)| assert!((a - b).norm() < 1e-13));
    }
}
