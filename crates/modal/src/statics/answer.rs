//! Modes with a static answer as one of their coordinates.
//!
//! ```text
//! u = Ψ c      t = c without its parts along the modes that are kept, |t| = 1
//! Q = [kept, t, rest]      Ψ' = Ψ Q      Ψ'ᵀKΨ' = QᵀΛQ
//! ```
//!
//! The rest are Rayleigh–Ritz vectors of what is left. So only t is coupled to them by K, and the kept modes to none.

use faer::linalg::solvers::Solve;
use faer::{Mat, Scale, Side};

use crate::error::ModalError;
use crate::input::check_finite_entries;
use crate::memory_estimate::of_vectors;
use crate::solve::Modes;
use crate::statics::answered::StaticAnswer;

impl Modes {
    /// The same motions by other coordinates: the modes `kept` in their places; in the first place that is left, the part that a static
    /// answer of these `amplitudes` has beside them; in the others, slowest first, what else there is.
    /// `None` where the answer has no more than `least` of itself beside the modes that are kept, or these are all that there are.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::NotFinite`], [`ModalError::LargeModes`], [`ModalError::DenseEigen`], [`ModalError::Memory`].
    pub fn with_answer(&self, amplitudes: &[f64], kept: &[usize], least: f64) -> Result<Option<Self>, ModalError> {
        let (size, found) = (self.shapes.ncols(), amplitudes.len());
        if found != size {
            return Err(ModalError::Length { what: "the amplitudes of a static answer", expected: size, found });
        }
        check_finite_entries("amplitudes of a static answer", amplitudes.iter().copied())?;
        if kept.iter().any(|k| *k >= size) {
            return Err(ModalError::LargeModes { found: kept.to_vec(), count: size });
        }
        let places: Vec<usize> = (0..size).filter(|k| !kept.contains(k)).collect();
        let norm = |list: &mut dyn Iterator<Item = f64>| list.map(|c| c * c).sum::<f64>().sqrt();
        let beside = norm(&mut places.iter().map(|k| amplitudes[*k]));
        let is_there = beside > least * norm(&mut amplitudes.iter().copied());
        let Some(place) = places.first().copied().filter(|_| is_there) else { return Ok(None) };
        let failed = || ModalError::DenseEigen { size };
        // Of the coordinates that are not kept: t, and an orthonormal basis of what is left.
        let t = Mat::from_fn(1, places.len(), |_, k| amplitudes[places[k]] / beside);
        let svd = t.svd().map_err(|_| failed())?;
        let left = svd.V().subcols(1, places.len() - 1);
        let stiff = Mat::from_fn(places.len(), left.ncols(), |i, j| self.eigenvalues[places[i]] * left[(i, j)]);
        let ritz = (left.transpose() * stiff).self_adjoint_eigen(Side::Lower).map_err(|_| failed())?;
        let rest = left * ritz.U();
        let mut q = Mat::<f64>::identity(size, size);
        for (i, row) in places.iter().enumerate() {
            for (j, column) in places.iter().enumerate() {
                q[(*row, *column)] = if j == 0 { t[(0, i)] } else { rest[(i, j - 1)] };
            }
        }
        let stiffness =
            |a: usize, b: usize| (0..size).map(|i| q[(i, a)] * self.eigenvalues[i] * q[(i, b)]).sum::<f64>();
        let eigenvalues = (0..size).map(|k| stiffness(k, k)).collect();
        let mut coupling = vec![0.0; size];
        places[1..].iter().for_each(|other| coupling[*other] = stiffness(place, *other));
        memory::check("modes with a static answer", of_vectors(self.shapes.nrows(), size))?;
        Ok(Some(Self {
            rigid: self.rigid.clone(),
            eigenvalues,
            shapes: &self.shapes * &q,
            // Those of eigenvectors, which most of these are not.
            residuals: Vec::new(),
            force_residuals: Vec::new(),
            answer: Some(StaticAnswer { place, coupling, natural: self.natural() }),
            stats: self.stats,
        }))
    }

    /// The shapes (N×k) of a list of modes; a static answer among them with so much of the modes that are not in the list that K couples it
    /// to none of these. Its part along itself stays one.
    pub fn uncoupled(&self, list: &[usize]) -> Mat<f64> {
        let mut shapes = Mat::from_fn(self.shapes.nrows(), list.len(), |i, j| self.shapes[(i, list[j])]);
        let place = self.answer.as_ref().and_then(|answer| list.iter().position(|k| *k == answer.place));
        if let (Some(StaticAnswer { coupling, .. }), Some(column)) = (&self.answer, place) {
            for (k, (between, eigenvalue)) in coupling.iter().zip(&self.eigenvalues).enumerate() {
                if *between != 0.0 && !list.contains(&k) {
                    let mut column = shapes.col_mut(column);
                    column += self.shapes.col(k) * Scale(-between / eigenvalue);
                }
            }
        }
        shapes
    }

    /// Lets `shapes` that have more columns take the place of its own, with `eigenvalues` of those that follow, to which K couples none.
    pub fn append(&mut self, eigenvalues: impl IntoIterator<Item = f64>, shapes: Mat<f64>) {
        self.eigenvalues.extend(eigenvalues);
        if let Some(answer) = &mut self.answer {
            answer.coupling.resize(self.eigenvalues.len(), 0.0);
        }
        self.shapes = shapes;
    }

    /// ΨᵀKΨ (nf×nf).
    pub(crate) fn stiffness(&self) -> Mat<f64> {
        let size = self.eigenvalues.len();
        let mut stiffness = self.answer.as_ref().map_or_else(|| Mat::zeros(size, size), StaticAnswer::stiffness);
        self.eigenvalues.iter().enumerate().for_each(|(k, eigenvalue)| stiffness[(k, k)] = *eigenvalue);
        stiffness
    }

    /// Replaces modal forces (nf×k) by the amplitudes of the static answers to them.
    ///
    /// # Errors
    /// [`ModalError::NotPositiveDefinite`].
    pub fn answer(&self, forces: &mut Mat<f64>) -> Result<(), ModalError> {
        match &self.answer {
            Some(_) => {
                let (stiffness, size) = (self.stiffness(), self.eigenvalues.len());
                let failed = |_| ModalError::NotPositiveDefinite { matrix: "stiffness", size };
                stiffness.llt(Side::Lower).map_err(failed)?.solve_in_place(forces);
            }
            None => {
                for (k, eigenvalue) in self.eigenvalues.iter().enumerate() {
                    forces.row_mut(k).iter_mut().for_each(|force| *force /= eigenvalue);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::solve::SolveStats;
    use crate::support::rigid::RigidModes;
    use reduced_body::RigidMotion;

    /// Modes of a body whose M is 1 and whose K is diagonal.
    fn modes(eigenvalues: &[f64]) -> Modes {
        let size = eigenvalues.len();
        Modes {
            rigid: RigidModes {
                motion: RigidMotion::clamp(Vector3::zeros()),
                mass: 1.0,
                center_of_mass: Vector3::zeros(),
                origin: Vector3::zeros(),
                inertia: Matrix3::identity(),
                translation_basis: Matrix3::zeros(),
                rotation_basis: Matrix3::zeros(),
                shapes: Mat::zeros(size, 6),
            },
            eigenvalues: eigenvalues.to_vec(),
            shapes: Mat::identity(size, size),
            residuals: vec![0.0; size],
            force_residuals: vec![0.0; size],
            answer: None,
            stats: SolveStats::default(),
        }
    }

    /// Closed form: of K = diag(1, 4, 9) the vector that K couples to nothing across (1, 1, 1)/√3 and the first axis is K⁻¹ times what is left of the
    /// former, (0, 1/4, 1/9).
    #[test]
    fn an_answer_is_uncoupled_by_parts_of_the_other_modes() {
        let found = modes(&[1.0, 4.0, 9.0]).with_answer(&[1.0, 1.0, 1.0], &[0], 1e-3).unwrap().unwrap();
        let uncoupled = found.uncoupled(&[0, 1]);
        let (kept, answer) = (uncoupled.col(0), uncoupled.col(1));
        assert!((kept[0] - 1.0).abs() + kept[1].abs() + kept[2].abs() < 1e-15);
        assert!(answer[0].abs() < 1e-15 && (answer[1] / answer[2] - 9.0 / 4.0).abs() < 1e-14, "{answer:?}");
        // Its part along the answer is one.
        assert!((answer[1] + answer[2] - 2.0_f64.sqrt()).abs() < 1e-14, "{answer:?}");
        // With all modes in the list there is nothing to take.
        assert_eq!(found.uncoupled(&[0, 1, 2]), found.shapes);
    }

    /// Conserved: M and K of the same motions.
    #[test]
    fn the_answer_and_what_is_kept_are_coordinates() {
        let eigenvalues = [1.0, 4.0, 9.0, 25.0, 400.0];
        let answer = [0.5, 3.0, 0.1, -0.4, 0.02];
        let found = modes(&eigenvalues).with_answer(&answer, &[1], 1e-3).unwrap().unwrap();
        assert_eq!((found.answer.as_ref().unwrap().place, found.natural()), (0, 5));
        // They are those of eigenvectors.
        assert!(found.residuals.is_empty() && found.force_residuals.is_empty());
        let of_found = found.stiffness();
        let q = &found.shapes;
        for (i, j) in (0..5).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let mass: f64 = (0..5).map(|k| q[(k, i)] * q[(k, j)]).sum();
            let stiffness: f64 = (0..5).map(|k| q[(k, i)] * eigenvalues[k] * q[(k, j)]).sum();
            let identity = f64::from(u8::from(i == j));
            assert!((mass - identity).abs() < 1e-13 && (stiffness - of_found[(i, j)]).abs() < 1e-11, "{i} {j}");
        }
        assert_eq!(q.col(1).iter().copied().collect::<Vec<_>>(), [0.0, 1.0, 0.0, 0.0, 0.0]);
        assert!(found.eigenvalues[2..].is_sorted());
        // All of the answer is along the two.
        let along: f64 = [0, 1].map(|j| (0..5).map(|i| q[(i, j)] * answer[i]).sum::<f64>().powi(2)).iter().sum();
        assert!((along - answer.iter().map(|c| c * c).sum::<f64>()).abs() < 1e-13);
    }

    #[test]
    fn an_answer_that_the_kept_modes_have_adds_nothing() {
        let modes = modes(&[1.0, 4.0]);
        assert!(modes.with_answer(&[1.0, 1e-4], &[0], 1e-3).unwrap().is_none());
        assert!(modes.with_answer(&[1.0, 1.0], &[0, 1], 1e-3).unwrap().is_none());
    }

    #[test]
    fn what_is_no_answer_is_refused() {
        let modes = modes(&[1.0, 4.0]);
        assert!(matches!(modes.with_answer(&[1.0], &[0], 1e-3), Err(ModalError::Length { .. })));
        assert!(matches!(modes.with_answer(&[1.0, f64::NAN], &[0], 1e-3), Err(ModalError::NotFinite { .. })));
        assert!(matches!(modes.with_answer(&[1.0, 1.0], &[2], 1e-3), Err(ModalError::LargeModes { .. })));
        let mut soft = modes.with_answer(&[1.0, 1.0], &[], 1e-3).unwrap().unwrap();
        soft.eigenvalues[0] = 0.0;
        let failure = soft.answer(&mut Mat::zeros(2, 1));
        assert!(matches!(failure, Err(ModalError::NotPositiveDefinite { .. })), "{failure:?}");
    }

    /// Closed form: of modes that are forbidden to move along the first the frequencies are those of the others, in any coordinates.
    #[test]
    fn what_is_restricted_may_have_an_answer() {
        let found = modes(&[1.0, 4.0, 9.0]).with_answer(&[0.5, 3.0, 0.1], &[], 1e-3).unwrap().unwrap();
        let row = Mat::from_fn(1, 3, |_, k| found.shapes[(0, k)]);
        let restricted = found.restricted(row.as_ref()).unwrap();
        let errors = restricted.eigenvalues.iter().zip([4.0, 9.0]).map(|(found, expected)| (found - expected).abs());
        assert!(errors.fold(0.0, f64::max) < 1e-12, "{:?}", restricted.eigenvalues);
    }
}
