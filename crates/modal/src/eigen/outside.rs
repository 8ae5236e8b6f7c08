//! Modes and static responses that an engine has found: checked, and brought into the form of those that are found here.

use std::time::Instant;

use faer::{Mat, MatRef};

use crate::eigen::engine::{Eigenpairs, Engine, StaticAnswers};
use crate::eigen::ritz::{RitzPairs, rayleigh_ritz};
use crate::error::ModalError;
use crate::matrix::columns::Columns;
use crate::memory_estimate::of_vectors;
use crate::progress::Progress;
use crate::solve::{Modes, SolveStats, Solver};
use crate::statics::inertia_relief::InertiaRelief;
use crate::statics::response::ACCEPTED;

/// Largest residual ‖(K + sM)⁻¹Mφ − μφ‖_M that an engine may say of a pair, relative to 1/s, the largest μ that there can be.
const RESIDUAL: f64 = 1e-8;
/// Largest ‖Kφ − λMφ‖ of a pair, or ‖f − Ku‖ of a static response, relative to ‖Kφ‖ or ‖f‖, beside what rounding leaves.
const UNBALANCED: f64 = 1e-4;
/// Rounding error of a product Kφ, in units of ε ‖|K||φ|‖.
const ROUNDINGS: f64 = 10.0;
/// Largest difference of an eigenvalue that an engine says and the Rayleigh quotient of its vector.
const SAME: f64 = 1e-8;
/// Error of the μ of an engine, in units of ε/s.
const ROUNDED: f64 = 100.0;

impl Solver<'_> {
    /// The modes that an engine finds.
    pub(crate) fn modes_by(
        &self,
        engine: &dyn Engine,
        flexible: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Modes, ModalError> {
        let started = Instant::now();
        let problem = self.held_problem()?;
        let (shift, unknowns) = (problem.shift, problem.stiffness.size());
        let preparation_time = self.preparation_time() + started.elapsed();
        let Eigenpairs { eigenvalues: said, vectors, residuals, stats } =
            engine.eigenpairs(&problem, flexible, progress).map_err(ModalError::Engine)?;
        let rigid = problem.rigid.ncols();
        drop(problem);

        let started = Instant::now();
        for (what, found, expected) in [
            ("rows", vectors.nrows(), unknowns),
            ("vectors", vectors.ncols(), said.len()),
            ("residuals", residuals.len(), said.len()),
        ] {
            expect(found == expected, || (format!("{found} {what}"), expected.to_string()))?;
        }
        expect(said.len() >= flexible, || (format!("{} modes", said.len()), format!("{flexible} or more")))?;
        for (k, (residual, lambda)) in residuals.iter().zip(&said).enumerate() {
            let allowed = RESIDUAL * (lambda / shift).max(1.0);
            expect(*residual <= allowed, || {
                (format!("a residual of {residual:.1e} of mode {}", k + 1), format!("{allowed:.0e} or less"))
            })?;
        }
        let mut shapes = self.constraints.expanded(vectors.as_ref());
        drop(vectors);
        memory::check("the eigenvectors", of_vectors(shapes.nrows(), shapes.ncols() + 6))?;
        InertiaRelief::new(self).unmove(&mut shapes);
        let RitzPairs { eigenvalues, shapes, force_residuals } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, shapes).map_err(dependent)?;
        self.refuse_soft(&eigenvalues, &shapes, shift)?;
        let rounding = self.rounding_of_products(&shapes);
        for (k, (lambda, said)) in eigenvalues.iter().zip(&said).enumerate() {
            let of_mu = ROUNDED * f64::EPSILON * (lambda + shift).powi(2) / shift;
            let allowed = SAME * lambda.abs() + self.stiffness.rounding(shapes.col(k)) + of_mu;
            expect((lambda - said).abs() <= allowed, || {
                (format!("mode {} with the eigenvalue {said:.12e}", k + 1), format!("{lambda:.12e}, as its shape has"))
            })?;
            let (force, allowed) = (force_residuals[k], UNBALANCED + rounding[k]);
            expect(force <= allowed, || {
                (format!("mode {} with forces unbalanced by {force:.1e}", k + 1), format!("{allowed:.1e} or less"))
            })?;
        }
        let inside = eigenvalues.iter().filter(|lambda| **lambda < stats.below).count();
        expect(inside >= flexible && rigid + inside == stats.counted, || {
            (
                format!("{inside} modes and {rigid} rigid motions below {:.6e} (rad/time)²", stats.below),
                format!("{}, as the count of the pivots has it, and all {flexible} modes below", stats.counted),
            )
        })?;
        let stats = SolveStats {
            shift,
            unknowns: self.stiffness.ncols(),
            peak_bytes: self.peak_beside_engine(said.len()),
            preparation_time,
            factor_time: stats.factor_time,
            lanczos_time: stats.search_time,
            ritz_time: started.elapsed(),
            engine: Some(stats),
            ..SolveStats::default()
        };
        let rigid = self.rigid.clone();
        Ok(Modes { rigid, eigenvalues, shapes, residuals, force_residuals, answer: None, stats }.truncated(flexible))
    }

    /// Rounding error of the product Kφ with each shape, relative to it.
    fn rounding_of_products(&self, shapes: &Mat<f64>) -> Vec<f64> {
        let k = self.stiffness;
        let products = k.product(shapes.as_ref());
        let of_shape = |column: usize| {
            let shape = shapes.col(column);
            let squared: f64 = k.absolute_product(shape).iter().map(|force| force.powi(2)).sum();
            ROUNDINGS * f64::EPSILON * squared.sqrt() / products.col(column).norm_l2()
        };
        (0..shapes.ncols()).map(of_shape).collect()
    }

    /// The static responses that an engine finds.
    pub(crate) fn static_response_by(
        &self,
        engine: &dyn Engine,
        forces: MatRef<'_, f64>,
    ) -> Result<Mat<f64>, ModalError> {
        memory::check("static responses", of_vectors(forces.nrows(), 6 * forces.ncols()))?;
        let relief = InertiaRelief::new(self);
        let straining = relief.straining(forces);
        let problem = self.held_problem()?;
        let reduced = self.constraints.reduced(straining.as_ref());
        let StaticAnswers { displacements, iterations, residuals } =
            engine.static_answers(&problem, reduced.as_ref()).map_err(ModalError::Engine)?;
        let (found, expected) = ((displacements.nrows(), displacements.ncols()), (reduced.nrows(), reduced.ncols()));
        let counted = [iterations.len(), residuals.len()] == [expected.1; 2];
        expect(found == expected && counted, || (format!("displacements of {found:?}"), format!("{expected:?}")))?;
        for (column, (iterations, residual)) in iterations.into_iter().zip(residuals).enumerate() {
            if residual.is_nan() || residual >= ACCEPTED {
                return Err(ModalError::StaticNotConverged { column, iterations, residual, tolerance: ACCEPTED });
            }
        }
        let mut answers = self.constraints.expanded(displacements.as_ref());
        relief.unmove(&mut answers);
        let mut rest = &straining - relief.stiff(&answers);
        relief.balance(&mut rest);
        let rounding = self.rounding_of_products(&answers);
        for (k, force) in straining.col_iter().enumerate() {
            let (relative, allowed) = (rest.col(k).norm_l2() / force.norm_l2(), UNBALANCED + rounding[k]);
            expect(force.norm_l2() == 0.0 || relative <= allowed, || {
                let found = format!("a static response {} with forces unbalanced by {relative:.1e}", k + 1);
                (found, format!("{allowed:.1e} or less"))
            })?;
        }
        Ok(answers)
    }
}

/// Vectors without a Gram matrix that is one.
fn dependent(error: ModalError) -> ModalError {
    match error {
        ModalError::NotPositiveDefinite { size, .. } => ModalError::WrongAnswers {
            found: format!("{size} vectors that depend on each other or on the rigid motions"),
            expected: "independent ones".to_owned(),
        },
        other => other,
    }
}

/// Refuses what an engine gave, unless it is as it should be.
fn expect(is_so: bool, words: impl FnOnce() -> (String, String)) -> Result<(), ModalError> {
    if is_so {
        return Ok(());
    }
    let (found, expected) = words();
    Err(ModalError::WrongAnswers { found, expected })
}
