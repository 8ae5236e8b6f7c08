//! Static responses, by conjugate gradients on K in the space that the support allows.
//!
//! ```text
//! K u = f − M R Rᵀ f,   Rᵀ M u = 0
//! ```
//!
//! R are the rigid modes that the support leaves: the force is balanced by the inertia of the motion that it causes
//! (inertia relief). The factor of K + sM preconditions: the spectrum is λ/(λ + s), between about a half and one. Of bulky bodies
//! multigrid cycles take its place, of which most of the spectrum is between a half and one as well.

use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, ColMut, ColRef, Mat, MatRef, Scale, unzip, zip};

use crate::eigen::lanczos::FIXED;
use crate::eigen::ritz::{RitzPairs, rayleigh_ritz};
use crate::error::ModalError;
use crate::factor::shifted::{Shifted, SolveScratch};
use crate::input::{check_finite_columns, check_rows};
use crate::matrix::products::Packed;
use crate::matrix::tall;
use crate::memory_estimate::{MemoryEstimate, of_vectors};
use crate::multigrid::{CycledInverse, Cycles};
use crate::solve::{Inverse, Modes, Solver};
use crate::statics::inertia_relief::InertiaRelief;

/// The norm of (K + sM)⁻¹ of the residual, relative to that of the force: the error of an answer in the norm of the energy
/// that is accepted. It is what rounding in K may leave on slender bodies (9e-7 on a bar of 220 times its thickness).
pub(crate) const ACCEPTED: f64 = 1e-5;
const MAX_ITERATIONS: usize = 300;
/// The same with cycles.
const MAX_ITERATIONS_BY_CYCLES: usize = 100;
/// Forces answered together at the most: the factor is read once for all of them.
const BLOCK: usize = 16;
/// Smallest part of a static response beside the modes with which it is added.
const DEPENDENT: f64 = 1e-8;

/// How well static responses are to balance their forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StaticAccuracy {
    /// To rounding.
    Full,
    /// As well as shapes need that are made of the answers, and whose coordinates come from the forces anew, as those of
    /// [`LargeShapes`](crate::LargeShapes): what is missing of the answers counts with its square.
    Shapes,
}

impl StaticAccuracy {
    /// The norm of (K + sM)⁻¹ of the residual, relative to that of the force, that an answer is to have. The iteration ends
    /// where a last solution, with the residual evaluated anew, will get there by what the steps before it have gained.
    fn tolerance(self) -> f64 {
        match self {
            Self::Full => 1e-11,
            Self::Shapes => ACCEPTED,
        }
    }
}

impl Solver<'_> {
    /// Static responses u (N×k) to the forces f (N×k), relative to the rigid motion that f causes: M-orthogonal to the
    /// rigid modes. Zero for a force that gives every part of the body the same rigid acceleration.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::StaticNotConverged`], and what refuses the factor
    /// of K + sM.
    pub fn static_response(&self, forces: MatRef<'_, f64>) -> Result<Mat<f64>, ModalError> {
        self.static_response_from(&self.modes(0, |_| ())?, forces, StaticAccuracy::Full)
    }

    /// The same, where natural `modes` are known: the answers begin with their parts along them, `Σ φ (φ·f)/λ`. What is left
    /// is far stiffer than the shift, so that each iteration gives more digits.
    ///
    /// # Errors
    /// As [`static_response`](Self::static_response).
    pub fn static_response_from(
        &self,
        modes: &Modes,
        forces: MatRef<'_, f64>,
        accuracy: StaticAccuracy,
    ) -> Result<Mat<f64>, ModalError> {
        let expected = self.rigid.shapes.nrows();
        check_rows("forces", forces.nrows(), expected)?;
        check_rows("mode shapes", modes.shapes.nrows(), expected)?;
        check_finite_columns("forces", forces)?;
        // Shapes that are coupled are no natural modes.
        let none = modes.answer.is_some().then(|| modes.truncated(0));
        let modes = none.as_ref().unwrap_or(modes);
        if let Some(engine) = &self.engine {
            return self.static_response_by(engine.as_ref(), forces);
        }
        memory::check("static responses", of_vectors(expected, modes.natural() + forces.ncols() + 10 * BLOCK))?;
        let search = |memory: &MemoryEstimate| memory.of_search(FIXED, BLOCK, 0);
        let inverse = self.inverse(modes.natural(), search, &mut |_| ())?;
        match (inverse, self.static_response_with(inverse, modes, forces, accuracy)) {
            (Inverse::Cycles(_), Err(error)) => {
                self.without_cycles(error.into());
                let factor = Inverse::Factor(self.factor(search, &mut |_| ())?);
                self.static_response_with(factor, modes, forces, accuracy)
            }
            (_, answers) => answers,
        }
    }

    fn static_response_with(
        &self,
        inverse: Inverse<'_>,
        modes: &Modes,
        forces: MatRef<'_, f64>,
        accuracy: StaticAccuracy,
    ) -> Result<Mat<f64>, ModalError> {
        let mut statics = Statics::new(self, Preconditioner::new(inverse)?, modes)?;
        let expected = forces.nrows();
        let mut answers = Mat::zeros(expected, forces.ncols());
        let blocks = forces.ncols().div_ceil(BLOCK);
        let at_once = forces.ncols().div_ceil(blocks.max(1)).max(1);
        for first in (0..forces.ncols()).step_by(at_once) {
            let width = at_once.min(forces.ncols() - first);
            let block = statics.respond(forces.subcols(first, width), first, accuracy.tolerance())?;
            answers.as_mut().subcols_mut(first, width).copy_from(&block);
        }
        Ok(answers)
    }

    /// The modes, with shapes appended that make them span the static `answers` (N×k, see
    /// [`static_response`](Self::static_response)): a few modes then give the right static displacement, Eq. (M11) of `docs/method/modes.md`.
    ///
    /// The part of the responses beside the rigid modes and `modes` is made into Rayleigh–Ritz vectors of (K, M), together
    /// with the static shapes that `modes` has already; answers that add less than 1e-8 of themselves add nothing.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::NotPositiveDefinite`], [`ModalError::DenseEigen`].
    pub fn with_static_shapes(&self, modes: Modes, answers: MatRef<'_, f64>) -> Result<Modes, ModalError> {
        let added = self.beside(&modes, answers, DEPENDENT)?;
        // Static shapes are no eigenvectors: what is M-orthogonal to them is not K-orthogonal, unless all are combined.
        let natural = modes.natural();
        let before = modes.shapes.ncols() - natural;
        let added = tall::side_by_side(&[modes.shapes.subcols(natural, before), added.as_ref()]);
        let RitzPairs { eigenvalues, shapes, .. } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, added)?;
        let mut modes = modes;
        modes.eigenvalues.truncate(natural);
        modes.eigenvalues.extend(eigenvalues);
        modes.shapes = tall::side_by_side(&[modes.shapes.get(.., ..natural), shapes.as_ref()]);
        Ok(modes)
    }

    /// The part of `answers` (N×k) beside the rigid modes and `modes`, M-orthonormal; without those that add less than
    /// `least` of themselves.
    pub(crate) fn beside(&self, modes: &Modes, answers: MatRef<'_, f64>, least: f64) -> Result<Mat<f64>, ModalError> {
        let expected = modes.shapes.nrows();
        check_rows("static responses", answers.nrows(), expected)?;
        check_finite_columns("static responses", answers)?;
        memory::check("static shapes", of_vectors(expected, modes.shapes.ncols() + 4 * answers.ncols()))?;
        let mut rests = answers.to_owned();
        let mut m_rests = self.mass.product(answers);
        let mut wholes: Vec<f64> = dots(&rests, &m_rests).into_iter().map(f64::sqrt).collect();
        // What is left of an answer may be small: a second round takes out what rounding has left in it.
        for _ in 0..2 {
            for basis in [self.rigid.shapes.as_ref(), modes.shapes.as_ref()] {
                let parts = tall::inner(basis, m_rests.as_ref());
                tall::multiply(rests.as_mut(), Accum::Add, basis, parts.as_ref(), -1.0);
            }
            m_rests = self.mass.product(rests.as_ref());
            let count = orthonormalize([&mut rests, &mut m_rests], &wholes, least);
            wholes = vec![1.0; count];
        }
        Ok(rests)
    }
}

/// Makes vectors, given with M times them, M-orthonormal one after the other, and leaves out those of which not more than
/// `least` of their `wholes` is left. Returns how many there are.
fn orthonormalize(vectors: [&mut Mat<f64>; 2], wholes: &[f64], least: f64) -> usize {
    let [vectors, momenta] = vectors;
    let size = vectors.nrows();
    let mut count = 0;
    for (k, whole) in wholes.iter().enumerate() {
        let parts = tall::inner(momenta.subcols(0, count), vectors.subcols(k, 1));
        for list in [&mut *vectors, &mut *momenta] {
            let (before, mut from) = list.as_mut().split_at_col_mut(count);
            for (part, unit) in parts.col(0).iter().zip(before.rb().col_iter()) {
                add(from.as_mut().col_mut(k - count), -part, unit);
            }
        }
        let norm = (vectors.col(k).transpose() * momenta.col(k)).max(0.0).sqrt();
        if norm > least * whole {
            for list in [&mut *vectors, &mut *momenta] {
                let unit = list.col(k) * Scale(1.0 / norm);
                list.col_mut(count).copy_from(unit);
            }
            count += 1;
        }
    }
    vectors.truncate(size, count);
    momenta.truncate(size, count);
    count
}

/// The data that the iterations share.
struct Statics<'a> {
    solver: &'a Solver<'a>,
    preconditioner: Preconditioner<'a>,
    modes: &'a Modes,
    relief: InertiaRelief<'a>,
    /// M φ of the natural modes.
    m_natural: Mat<f64>,
    packed: Vec<Packed>,
}

impl<'a> Statics<'a> {
    fn new(solver: &'a Solver<'_>, preconditioner: Preconditioner<'a>, modes: &'a Modes) -> Result<Self, ModalError> {
        let mut m_natural = solver.mass.product(modes.shapes.get(.., ..modes.natural()));
        solver.constraints.project(m_natural.as_mut());
        let (relief, packed) = (InertiaRelief::new(solver), Vec::new());
        Ok(Self { solver, preconditioner, modes, relief, m_natural, packed })
    }

    /// Answers to up to [`BLOCK`] forces, of which `first` is the number of the first.
    fn respond(&mut self, forces: MatRef<'_, f64>, first: usize, tolerance: f64) -> Result<Mat<f64>, ModalError> {
        let forces = self.relief.straining(forces);
        let (mut answer, mut residual, along) = self.along_modes(&forces);
        self.relief.balance(&mut residual);
        let zeros = || Mat::<f64>::zeros(forces.nrows(), forces.ncols());
        // Directions p, and (K + sM) p, which are residuals, and so need no product: K p = (K + sM) p − s M p.
        let (mut search, mut shifted) = (zeros(), zeros());
        let (mut conditioned, mut stiff) = (zeros(), zeros());
        let mut before: Vec<f64> = vec![f64::INFINITY; forces.ncols()];
        self.precondition(&residual, &mut conditioned);
        let mut squared = dots(&residual, &conditioned);
        let scale: Vec<f64> = squared.iter().zip(&along).map(|(squared, along)| squared + along).collect();
        // Along a mode that is not known, (K + sM)⁻¹ K is more than 1 − s/λ of the last that is, and 1 at most.
        let known = self.modes.eigenvalues[..self.modes.natural()].last();
        let of_first = known.map_or(f64::INFINITY, |lambda| (self.preconditioner.shift() / lambda).powi(2));
        // What a last cycle gains is not told by the step before it.
        let (mut iterations, mut may_end_early) = (0, matches!(self.preconditioner, Preconditioner::Factor { .. }));
        loop {
            let end = loop {
                let is_open = |squared: f64, k: usize| squared > tolerance * tolerance * scale[k];
                let open: Vec<usize> = (0..squared.len()).filter(|k| is_open(squared[*k], *k)).collect();
                if open.is_empty() {
                    break End::Converged;
                }
                if iterations == self.preconditioner.max_iterations() {
                    break End::Iterations;
                }
                iterations += 1;
                for k in &open {
                    let part = squared[*k] / before[*k];
                    follow(search.as_mut().col_mut(*k), part, conditioned.col(*k));
                    follow(shifted.as_mut().col_mut(*k), part, residual.col(*k));
                }
                self.stiff(&search, &shifted, &mut stiff);
                let curvature = dots(&search, &stiff);
                for k in &open {
                    let step = squared[*k] / curvature[*k];
                    add(answer.as_mut().col_mut(*k), step, search.col(*k));
                    add(residual.as_mut().col_mut(*k), -step, stiff.col(*k));
                }
                // This step and the last solution gain about as much each as the step before.
                let gain = |k: usize| if iterations == 1 { of_first } else { squared[k] / before[k] };
                let ends = open.iter().all(|k| !is_open(squared[*k] * gain(*k) * gain(*k), *k));
                open.iter().for_each(|k| before[*k] = squared[*k]);
                if ends && may_end_early {
                    break End::Early;
                }
                self.relief.balance(&mut residual);
                self.precondition(&residual, &mut conditioned);
                squared = dots(&residual, &conditioned);
            };
            residual = &forces - self.relief.stiff(&answer);
            self.relief.balance(&mut residual);
            self.precondition(&residual, &mut conditioned);
            squared = dots(&residual, &conditioned);
            let left = |k: usize| {
                // The last solution gains as much as the step before it, or nothing where rounding is reached.
                let gain = (squared[k] / before[k]).min(1.0);
                (squared[k] * gain / scale[k]).sqrt()
            };
            let accepted = self.preconditioner.accepted(end, tolerance);
            let is_refused = |k: &usize| scale[*k] > 0.0 && (left(*k).is_nan() || left(*k) >= accepted);
            match (0..squared.len()).find(is_refused) {
                None => break,
                // The last step has gained less than those before it: go on from here.
                Some(_) if end == End::Early => may_end_early = false,
                Some(k) => {
                    let (column, residual) = (first + k, left(k));
                    return Err(ModalError::StaticNotConverged { column, iterations, residual, tolerance: accepted });
                }
            }
        }
        answer += conditioned;
        self.relief.unmove(&mut answer);
        Ok(answer)
    }

    /// The answers to forces along the modes, what is left of the forces, and the square of what is not in the norm of
    /// (K + sM)⁻¹.
    fn along_modes(&self, forces: &Mat<f64>) -> (Mat<f64>, Mat<f64>, Vec<f64>) {
        let natural = self.modes.shapes.get(.., ..self.modes.natural());
        let mut left = forces.clone();
        let mut parts = tall::take_out(&mut left, self.m_natural.as_ref(), natural);
        let mut squared = vec![0.0; forces.ncols()];
        for (part, squared) in parts.col_iter_mut().zip(&mut squared) {
            for (part, lambda) in part.iter_mut().zip(&self.modes.eigenvalues) {
                *squared += *part * *part / (lambda + self.preconditioner.shift());
                *part /= lambda;
            }
        }
        (tall::product(natural, parts.as_ref()), left, squared)
    }

    /// Approximates (K + sM)⁻¹ of forces.
    fn precondition(&mut self, forces: &Mat<f64>, displacements: &mut Mat<f64>) {
        displacements.copy_from(forces);
        self.preconditioner.apply(displacements);
    }

    /// K u, without reactions, of displacements for which (K + sM) u is known where there is its factor.
    fn stiff(&mut self, displacements: &Mat<f64>, shifted: &Mat<f64>, forces: &mut Mat<f64>) {
        let Self { solver, preconditioner, packed, .. } = self;
        match preconditioner {
            Preconditioner::Factor { factor, .. } => {
                solver.mass.product_into(displacements.as_ref(), forces.as_mut(), packed);
                solver.constraints.project(forces.as_mut());
                for (force, shifted) in forces.col_iter_mut().zip(shifted.col_iter()) {
                    follow(force, -factor.shift, shifted);
                }
            }
            Preconditioner::Cycles { .. } => {
                solver.stiffness.product_into(displacements.as_ref(), forces.as_mut(), packed);
            }
        }
    }
}

/// Reason of the end of an iteration.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// By the residuals that it carries along, all answers are as good as was asked.
    Converged,
    /// A last solution will make them so.
    Early,
    /// No more iterations are allowed.
    Iterations,
}

/// Approximation of (K + sM)⁻¹, which also gives the norm of the rest of forces.
enum Preconditioner<'a> {
    Factor {
        factor: &'a Shifted,
        scratch: SolveScratch,
    },
    /// Cycles for a body that nothing holds.
    Cycles {
        cycles: &'a Cycles,
        inverse: Box<CycledInverse<'a>>,
    },
}

impl<'a> Preconditioner<'a> {
    fn new(inverse: Inverse<'a>) -> Result<Self, ModalError> {
        Ok(match inverse {
            Inverse::Factor(factor) => Self::Factor { factor, scratch: factor.solve_scratch(BLOCK)? },
            Inverse::Cycles(cycles) => Self::Cycles { cycles, inverse: Box::new(cycles.inverse()?) },
        })
    }

    fn shift(&self) -> f64 {
        match self {
            Self::Factor { factor, .. } => factor.shift,
            Self::Cycles { cycles, .. } => cycles.factor.shift,
        }
    }

    fn max_iterations(&self) -> usize {
        match self {
            Self::Factor { .. } => MAX_ITERATIONS,
            Self::Cycles { .. } => MAX_ITERATIONS_BY_CYCLES,
        }
    }

    /// The error of an answer that is accepted, where `tolerance` was asked for.
    fn accepted(&self, end: End, tolerance: f64) -> f64 {
        match (self, end) {
            // What is left is rounding.
            (Self::Factor { .. }, _) | (Self::Cycles { .. }, End::Converged) => ACCEPTED,
            (Self::Cycles { .. }, _) => tolerance,
        }
    }

    /// Replaces forces by displacements.
    fn apply(&mut self, x: &mut Mat<f64>) {
        match self {
            Self::Factor { factor, scratch } => factor.solve_in_place(x.as_mut(), scratch),
            Self::Cycles { inverse, .. } => inverse.apply(x),
        }
    }
}

/// y ← x + part·y.
fn follow(mut y: ColMut<'_, f64>, part: f64, x: ColRef<'_, f64>) {
    zip!(y.rb_mut(), x).for_each(|unzip!(y, x)| *y = x + part * *y);
}

/// y ← y + part·x.
fn add(mut y: ColMut<'_, f64>, part: f64, x: ColRef<'_, f64>) {
    zip!(y.rb_mut(), x).for_each(|unzip!(y, x)| *y += part * x);
}

/// Products of the columns with each other.
fn dots(a: &Mat<f64>, b: &Mat<f64>) -> Vec<f64> {
    a.col_iter().zip(b.col_iter()).map(|(a, b)| a.transpose() * b).collect()
}
