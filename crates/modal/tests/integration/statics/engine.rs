//! Modes and static responses from an engine: here the dense solution of the problem that it is given.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};
use modal::{
    Eigenpairs, Engine, EngineError, EngineStats, HeldMatrix, HeldProblem, ModalError, Progress, StaticAnswers,
};

use crate::held::supports::{body, supports};

const NF: usize = 10;

/// Solves the dense problem, and spoils its answers.
struct Dense {
    modes: fn(&mut Eigenpairs),
    statics: fn(&mut StaticAnswers),
}

fn dense(matrix: &HeldMatrix<'_>) -> Mat<f64> {
    let mut all = Mat::zeros(matrix.size(), matrix.size());
    for row in 0..matrix.size() {
        let mut last = None;
        matrix.for_each_in_row(row, |column, value| {
            assert!(last.is_none_or(|last| last < column) && value != 0.0, "row {row}, column {column}");
            last = Some(column);
            all[(row, column)] = value;
        });
    }
    assert!((&all - all.transpose()).norm_max() <= 1e-12 * all.norm_max());
    all
}

impl Engine for Dense {
    fn eigenpairs(
        &self,
        problem: &HeldProblem<'_>,
        count: usize,
        _: &mut dyn FnMut(Progress),
    ) -> Result<Eigenpairs, EngineError> {
        let (stiffness, mass) = (dense(&problem.stiffness), dense(&problem.mass));
        // M = L Lᵀ: y = Lᵀ x are the eigenvectors of Lᵀ (K + sM)⁻¹ L, in which the low modes keep their digits.
        let factor = mass.llt(Side::Lower).unwrap();
        let shifted = (&stiffness + &mass * faer::Scale(problem.shift)).llt(Side::Lower).unwrap();
        let eigen = (factor.L().transpose() * shifted.solve(factor.L())).self_adjoint_eigen(Side::Lower).unwrap();
        let size = mass.nrows();
        let values: Vec<f64> = (0..size).rev().map(|k| 1.0 / eigen.S()[k] - problem.shift).collect();
        let mut vectors = Mat::from_fn(size, size, |i, k| eigen.U()[(i, size - 1 - k)]);
        let upper = factor.L().transpose();
        faer::linalg::triangular_solve::solve_upper_triangular_in_place(upper, vectors.as_mut(), faer::Par::Seq);
        let rigid = problem.rigid.ncols();
        assert_eq!(problem.available, values.len() - rigid);
        let below = 0.5 * (values[rigid + count] + values[rigid + count - 1]);
        let stats = EngineStats {
            below,
            counted: rigid + count,
            ranks: 1,
            petsc: [0; 3],
            slepc: [0; 3],
            factor_entries: 0,
            megabytes: 0,
            factor_time: Default::default(),
            search_time: Default::default(),
            count_time: Default::default(),
        };
        let mut pairs = Eigenpairs {
            eigenvalues: values[rigid..rigid + count].to_vec(),
            vectors: vectors.subcols(rigid, count).to_owned(),
            residuals: vec![1e-12; count],
            stats,
        };
        (self.modes)(&mut pairs);
        Ok(pairs)
    }

    fn static_answers(&self, problem: &HeldProblem<'_>, forces: MatRef<'_, f64>) -> Result<StaticAnswers, EngineError> {
        // The forces do no work on the rigid modes, so that a stiffness against these changes nothing else.
        let momenta = dense(&problem.mass) * &problem.rigid;
        let stiffness = dense(&problem.stiffness) + &momenta * momenta.transpose() * faer::Scale(problem.shift);
        let displacements = stiffness.llt(Side::Lower).unwrap().solve(forces);
        let count = forces.ncols();
        let mut answers = StaticAnswers { displacements, iterations: vec![1; count], residuals: vec![1e-13; count] };
        (self.statics)(&mut answers);
        Ok(answers)
    }
}

/// Independent reference: dense solutions by faer.
#[test]
fn modes_and_static_answers_are_those_of_this_program() {
    let body = body();
    for (support, rigid) in supports(&body.positions) {
        let ours = body.held(&support);
        let theirs = body.held(&support).with_engine(Box::new(Dense { modes: |_| (), statics: |_| () }));
        let (expected, found) = (ours.modes(NF, |_| ()).unwrap(), theirs.modes(NF, |_| ()).unwrap());
        let counted = found.stats.engine.unwrap().counted;
        assert_eq!((found.natural(), counted), (NF, rigid + NF), "{:?}", support.motion);
        for (found, expected) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{:?}: {found} {expected}", support.motion);
        }
        // Shapes with their signs; M-orthonormal, so that products are cosines.
        let cosines = expected.shapes.transpose() * (body.matrices.mass() * &found.shapes);
        assert!((&cosines - Mat::<f64>::identity(NF, NF)).norm_max() < 1e-7, "{:?}", support.motion);

        let size = expected.shapes.nrows();
        let forces = Mat::from_fn(size, 2, |i, j| ((7 * i + 3 * j) as f64).sin());
        let (expected, found) = (ours.static_response(forces.as_ref()), theirs.static_response(forces.as_ref()));
        let (expected, found) = (expected.unwrap(), found.unwrap());
        let off = (&found - &expected).norm_l2() / expected.norm_l2();
        assert!(off < 1e-8, "{:?}: {off:e}", support.motion);
        assert_eq!(theirs.solved(), [0; 2], "nothing was factored here");
    }
}

#[test]
fn wrong_answers_are_refused() {
    let body = body();
    let supports = supports(&body.positions);
    let refused = |modes: fn(&mut Eigenpairs), says: &str| {
        for (support, _) in [&supports[0], &supports[4]] {
            let solver = body.held(support).with_engine(Box::new(Dense { modes, statics: |_| () }));
            let error = solver.modes(NF, |_| ()).unwrap_err();
            assert!(matches!(&error, ModalError::WrongAnswers { .. }), "{error}");
            assert!(error.to_string().contains(says), "{says} is not in: {error}");
        }
    };
    refused(|pairs| pairs.stats.counted += 1, "as the count of the pivots has it");
    refused(|pairs| pairs.stats.below *= 0.5, "as the count of the pivots has it");
    refused(|pairs| pairs.eigenvalues[3] *= 1.0 + 1e-6, "mode 4 with the eigenvalue");
    refused(|pairs| pairs.residuals[9] = 1e-3, "a residual of 1.0e-3 of mode 10");
    refused(|pairs| pairs.residuals[0] = f64::NAN, "a residual of NaN of mode 1");
    refused(|pairs| pairs.vectors[(17, 2)] += 0.01 * pairs.vectors.col(2).norm_l2(), "mode ");
    refused(|pairs| pairs.vectors.truncate(5, NF), "5 rows");
    refused(|pairs| pairs.eigenvalues.truncate(NF - 1), "10 vectors");
    // A mode that was missed: all others are right, and the count tells.
    refused(
        |pairs| {
            pairs.eigenvalues.remove(4);
            pairs.residuals.remove(4);
            pairs.vectors =
                Mat::from_fn(pairs.vectors.nrows(), NF - 1, |i, j| pairs.vectors[(i, j + usize::from(j >= 4))]);
        },
        "9 modes",
    );

    let force = Mat::from_fn(3 * body.positions.len(), 1, |i, _| (i as f64).cos());
    let refused = |statics: fn(&mut StaticAnswers), says: &str| {
        let solver = body.held(&supports[4].0).with_engine(Box::new(Dense { modes: |_| (), statics }));
        let error = solver.static_response(force.as_ref()).unwrap_err().to_string();
        assert!(error.contains(says), "{says} is not in: {error}");
    };
    refused(|answers| answers.residuals[0] = 1e-3, "a residual of 1.000e-3");
    refused(|answers| answers.displacements[(5, 0)] *= 1.1, "a static response 1 with forces unbalanced");
    refused(|answers| answers.displacements.truncate(5, 1), "displacements of (5, 1)");
}
