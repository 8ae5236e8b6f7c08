//! Static answers, by conjugate gradients on K in the space that the support allows.
//!
//! ```text
//! K u = f − M R Rᵀ f,   Rᵀ M u = 0
//! ```
//!
//! R are the rigid modes that the support leaves: the force is balanced by the inertia of the motion that it causes
//! (inertia relief). The factor of K + sM preconditions: the spectrum is λ/(λ + s), between about a half and one.

use faer::{Col, ColMut, ColRef, Mat, MatRef, Scale};

use crate::error::ModalError;
use crate::foretold::of_vectors;
use crate::inertia_relief::InertiaRelief;
use crate::products::Packed;
use crate::ritz::{RitzPairs, rayleigh_ritz};
use crate::shifted::{Shifted, SolveScratch};
use crate::solve::{Modes, Solver};
use crate::tall;

/// The norm of (K + sM)⁻¹ of the residual, relative to that of the force, that an answer is to have. The iteration ends
/// where a last solution, with the residual evaluated anew, will get there by what the steps before it have gained.
const TOLERANCE: f64 = 1e-11;
/// The norm of that residual, which is the error of the answer in the norm of the energy: what rounding in K may leave on
/// slender bodies (9e-7 on a bar of 220 times its thickness).
pub(crate) const ACCEPTED: f64 = 1e-5;
const MAX_ITERATIONS: usize = 300;
/// Forces answered together at the most: the factor is read once for all of them.
const BLOCK: usize = 16;
/// What a static answer adds to the modes must be more than this part of it.
const DEPENDENT: f64 = 1e-8;

impl Solver<'_> {
    /// Static answers u (N×k) to the forces f (N×k), relative to the rigid motion that f causes: M-orthogonal to the
    /// rigid modes. Zero for a force that gives every part of the body the same rigid acceleration.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::StaticNotConverged`], and what refuses the factor
    /// of K + sM.
    pub fn static_response(&self, forces: MatRef<'_, f64>) -> Result<Mat<f64>, ModalError> {
        self.static_response_from(&self.modes(0, |_| ())?, forces)
    }

    /// The same, where natural `modes` are known: the answers begin with their parts along them, `Σ φ (φ·f)/λ`. What is left
    /// is far stiffer than the shift, so that each iteration gives more digits.
    ///
    /// # Errors
    /// As [`static_response`](Self::static_response).
    pub fn static_response_from(&self, modes: &Modes, forces: MatRef<'_, f64>) -> Result<Mat<f64>, ModalError> {
        let expected = self.rigid.shapes.nrows();
        if forces.nrows() != expected {
            return Err(ModalError::Size { what: "forces", expected, found: forces.nrows() });
        }
        if modes.shapes.nrows() != expected {
            return Err(ModalError::Size { what: "mode shapes", expected, found: modes.shapes.nrows() });
        }
        check_finite("forces", forces)?;
        if let Some(engine) = &self.engine {
            return self.static_response_by(engine.as_ref(), forces);
        }
        memory::check("static answers", of_vectors(expected, modes.natural() + forces.ncols() + 10 * BLOCK))?;
        let mut statics = Statics::new(self, self.factor()?, modes)?;
        let mut answers = Mat::zeros(expected, forces.ncols());
        let blocks = forces.ncols().div_ceil(BLOCK);
        let at_once = forces.ncols().div_ceil(blocks.max(1)).max(1);
        for first in (0..forces.ncols()).step_by(at_once) {
            let width = at_once.min(forces.ncols() - first);
            let block = statics.respond(forces.subcols(first, width), first)?;
            answers.as_mut().subcols_mut(first, width).copy_from(&block);
        }
        Ok(answers)
    }

    /// The modes, with shapes appended that make them span the static `answers` (N×k, see
    /// [`static_response`](Self::static_response)): a few modes then give the right static displacement.
    ///
    /// What the answers have beside the rigid modes and `modes` is made into Rayleigh–Ritz vectors of (K, M), together
    /// with the static shapes that `modes` has already; answers that add less than 1e-8 of themselves add nothing.
    ///
    /// # Errors
    /// [`ModalError::Size`], [`ModalError::NotFinite`], [`ModalError::DenseEigen`].
    pub fn with_static_shapes(&self, modes: Modes, answers: MatRef<'_, f64>) -> Result<Modes, ModalError> {
        let added = self.beside(&modes, answers, DEPENDENT)?;
        // Static shapes are no eigenvectors: what is M-orthogonal to them is not K-orthogonal, unless all are combined.
        let (expected, natural) = (modes.shapes.nrows(), modes.natural());
        let before = modes.shapes.ncols() - natural;
        let added = Mat::from_fn(expected, before + added.ncols(), |i, j| {
            if j < before { modes.shapes[(i, natural + j)] } else { added[(i, j - before)] }
        });
        let RitzPairs { eigenvalues, shapes, .. } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, &added)?;
        let mut modes = modes;
        modes.eigenvalues.truncate(natural);
        modes.eigenvalues.extend(eigenvalues);
        modes.shapes.truncate(expected, natural);
        modes.shapes.resize_with(expected, natural + shapes.ncols(), |i, j| shapes[(i, j - natural)]);
        Ok(modes)
    }

    /// What `answers` (N×k) have beside the rigid modes and `modes`, M-orthonormal; without those that add less than
    /// `least` of themselves.
    pub(crate) fn beside(&self, modes: &Modes, answers: MatRef<'_, f64>, least: f64) -> Result<Mat<f64>, ModalError> {
        let (expected, found) = (modes.shapes.nrows(), answers.nrows());
        if found != expected {
            return Err(ModalError::Size { what: "static answers", expected, found });
        }
        check_finite("static answers", answers)?;
        let (rigid, flexible) = (6, modes.shapes.ncols());
        memory::check("static shapes", of_vectors(expected, 2 * (rigid + flexible + answers.ncols()) + flexible))?;
        let mut basis = Mat::zeros(expected, rigid + flexible);
        basis.as_mut().subcols_mut(0, rigid).copy_from(&self.rigid.shapes);
        basis.as_mut().subcols_mut(rigid, flexible).copy_from(&modes.shapes);
        let m_basis = self.mass.product(basis.as_ref());
        let mut rests = answers.to_owned();
        let mut wholes: Vec<f64> = dots(&rests, &self.mass.product(answers)).into_iter().map(f64::sqrt).collect();
        // What is left of an answer may be small: a second round takes out what rounding has left in it.
        for _ in 0..2 {
            tall::take_out(&mut rests, basis.as_ref(), m_basis.as_ref());
            let m_rests = self.mass.product(rests.as_ref());
            let mut unit: Vec<[Col<f64>; 2]> = Vec::with_capacity(rests.ncols());
            for (k, whole) in wholes.iter().enumerate() {
                let [mut rest, mut momentum] = [rests.col(k).to_owned(), m_rests.col(k).to_owned()];
                for [other, m_other] in &unit {
                    let part = Scale(m_other.transpose() * &rest);
                    rest -= other * part;
                    momentum -= m_other * part;
                }
                let norm = (rest.transpose() * &momentum).max(0.0).sqrt();
                if norm > least * whole {
                    unit.push([rest, momentum].map(|list| list * Scale(1.0 / norm)));
                }
            }
            rests = Mat::from_fn(expected, unit.len(), |i, j| unit[j][0][i]);
            wholes = vec![1.0; unit.len()];
        }
        Ok(rests)
    }
}

fn check_finite(what: &'static str, vectors: MatRef<'_, f64>) -> Result<(), ModalError> {
    for (index, vector) in vectors.col_iter().enumerate() {
        if let Some(value) = vector.iter().copied().find(|value| !value.is_finite()) {
            return Err(ModalError::NotFinite { what, index, value });
        }
    }
    Ok(())
}

/// What the iterations share.
struct Statics<'a> {
    solver: &'a Solver<'a>,
    factor: &'a Shifted,
    modes: &'a Modes,
    relief: InertiaRelief<'a>,
    /// M φ of the natural modes.
    m_natural: Mat<f64>,
    scratch: SolveScratch,
    packed: Vec<Packed>,
}

impl<'a> Statics<'a> {
    fn new(solver: &'a Solver<'_>, factor: &'a Shifted, modes: &'a Modes) -> Result<Self, ModalError> {
        let mut m_natural = solver.mass.product(modes.shapes.get(.., ..modes.natural()));
        solver.constraints.project(m_natural.as_mut());
        let (relief, scratch, packed) = (InertiaRelief::new(solver), factor.solve_scratch(BLOCK)?, Vec::new());
        Ok(Self { solver, factor, modes, relief, m_natural, scratch, packed })
    }

    /// Answers to up to [`BLOCK`] forces, of which `first` is the number of the first.
    fn respond(&mut self, forces: MatRef<'_, f64>, first: usize) -> Result<Mat<f64>, ModalError> {
        let forces = self.relief.straining(forces);
        let (mut answer, mut residual, along) = self.along_modes(&forces);
        self.relief.balance(&mut residual);
        let zeros = || Mat::<f64>::zeros(forces.nrows(), forces.ncols());
        // Directions p, and (K + sM) p, which are residuals, and so need no product: K p = (K + sM) p − s M p.
        let (mut search, mut shifted) = (zeros(), zeros());
        let (mut conditioned, mut stiff) = (zeros(), zeros());
        let mut before: Vec<f64> = vec![f64::INFINITY; forces.ncols()];
        let mut scale: Vec<f64> = Vec::new();
        let mut iterations = 0;
        loop {
            self.precondition(&residual, &mut conditioned);
            let squared = dots(&residual, &conditioned);
            if iterations == 0 {
                scale = squared.iter().zip(&along).map(|(squared, along)| squared + along).collect();
            }
            let is_open = |squared: f64, k: usize| squared > TOLERANCE * TOLERANCE * scale[k];
            let open: Vec<usize> = (0..squared.len()).filter(|k| is_open(squared[*k], *k)).collect();
            if open.is_empty() || iterations == MAX_ITERATIONS {
                break;
            }
            iterations += 1;
            for k in &open {
                let part = squared[*k] / before[*k];
                follow(search.as_mut().col_mut(*k), part, conditioned.col(*k));
                follow(shifted.as_mut().col_mut(*k), part, residual.col(*k));
            }
            self.unshift(&search, &shifted, &mut stiff);
            let curvature = dots(&search, &stiff);
            for k in &open {
                let step = squared[*k] / curvature[*k];
                add(answer.as_mut().col_mut(*k), step, search.col(*k));
                add(residual.as_mut().col_mut(*k), -step, stiff.col(*k));
            }
            // This step and the last solution gain about as much each as the step before.
            let gain = |k: usize| squared[k] / before[k];
            if open.iter().all(|k| iterations > 1 && !is_open(squared[*k] * gain(*k) * gain(*k), *k)) {
                break;
            }
            self.relief.balance(&mut residual);
            before = squared;
        }
        let mut residual = forces - self.relief.stiff(&answer);
        self.relief.balance(&mut residual);
        self.precondition(&residual, &mut conditioned);
        for (k, (squared, scale)) in dots(&residual, &conditioned).iter().zip(&scale).enumerate() {
            let residual = (squared / scale).sqrt();
            if *scale > 0.0 && (residual.is_nan() || residual >= ACCEPTED) {
                let column = first + k;
                return Err(ModalError::StaticNotConverged { column, iterations, residual, tolerance: ACCEPTED });
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
                *squared += *part * *part / (lambda + self.factor.shift);
                *part /= lambda;
            }
        }
        (tall::product(natural, parts.as_ref()), left, squared)
    }

    /// (K + sM)⁻¹ of forces.
    fn precondition(&mut self, forces: &Mat<f64>, displacements: &mut Mat<f64>) {
        displacements.copy_from(forces);
        self.factor.solve_in_place(displacements.as_mut(), &mut self.scratch);
    }

    /// K u of displacements for which (K + sM) u is known, without reactions.
    fn unshift(&mut self, displacements: &Mat<f64>, shifted: &Mat<f64>, forces: &mut Mat<f64>) {
        self.solver.mass.product_into(displacements.as_ref(), forces.as_mut(), &mut self.packed);
        self.solver.constraints.project(forces.as_mut());
        for (force, shifted) in forces.col_iter_mut().zip(shifted.col_iter()) {
            follow(force, -self.factor.shift, shifted);
        }
    }
}

/// y ← x + part·y.
fn follow(y: ColMut<'_, f64>, part: f64, x: ColRef<'_, f64>) {
    for (y, x) in y.iter_mut().zip(x.iter()) {
        *y = x + part * *y;
    }
}

/// y ← y + part·x.
fn add(y: ColMut<'_, f64>, part: f64, x: ColRef<'_, f64>) {
    for (y, x) in y.iter_mut().zip(x.iter()) {
        *y += part * x;
    }
}

/// Products of the columns with each other.
fn dots(a: &Mat<f64>, b: &Mat<f64>) -> Vec<f64> {
    a.col_iter().zip(b.col_iter()).map(|(a, b)| a.transpose() * b).collect()
}
