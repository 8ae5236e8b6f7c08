//! Large deflection: the manifold that the large modes of a body move on.

use faer::{Mat, MatRef};
use fem_tet10::{GeometricTerms, second_order_energies, second_order_forces};
use frames_rk4::{Effect, Manifold};
use modal::{Modes, ReducedBody, SecondOrderShapes};

use super::error::{BuildError, modal};
use super::mesh_model::MeshModel;
use super::stress::{LOADS, Stress};
use crate::effects::Choice;
use crate::modes::Large;
use crate::scene::Scene;

/// How many modes are large where the scene does not say which.
const DEFAULT_LARGE: usize = 4;

/// The shapes of second order of the large modes, and the body in them.
pub(super) struct LargeDeflection {
    pub shapes: SecondOrderShapes,
    pub manifold: Manifold,
    /// The geometric stiffness of each large mode in the modes (nf × nf).
    stiffness: Vec<Mat<f64>>,
    /// The same with the terms that loads have.
    of_stress: Vec<Mat<f64>>,
}

/// Which of the `natural` modes that are kept are large, numbered from 0. What is left open is on where the scene names
/// them.
pub(super) fn large_modes(scene: &Scene, natural: usize) -> Vec<usize> {
    let first = |count: usize| (0..natural.min(count)).collect();
    match (scene.effects.choices[Effect::LargeDeflection], &scene.modes.large) {
        (Choice::Off, _) | (Choice::Auto, None) => Vec::new(),
        (Choice::Auto, _) if scene.time.method.is_of_paper() => Vec::new(),
        (Choice::On, None) => first(DEFAULT_LARGE),
        (_, Some(Large::Count(count))) => first(*count),
        (_, Some(Large::List(list))) => list.iter().map(|mode| mode - 1).filter(|k| *k < natural).collect(),
    }
}

impl LargeDeflection {
    /// Of some `large` ones of the modes.
    pub fn new(model: &MeshModel<'_>, modes: &Modes, large: &[usize]) -> Result<Self, BuildError> {
        let &MeshModel { scene, mesh, solver, .. } = model;
        let materials = &model.body.materials;
        let of_large = Mat::from_fn(modes.shapes.nrows(), large.len(), |i, j| modes.shapes[(i, large[j])]);
        let pairs = SecondOrderShapes::pairs(large.len());
        let quadruples: Vec<[usize; 4]> =
            pairs.iter().flat_map(|[i, j]| pairs.iter().map(move |[k, l]| [*i, *j, *k, *l])).collect();
        let forces = second_order_forces(mesh, materials, of_large.as_ref(), &pairs)?;
        let energies = second_order_energies(mesh, materials, of_large.as_ref(), &quadruples)?;
        let shapes = solver.second_order_shapes(modes.clone(), large, forces.as_ref()).map_err(modal(scene))?;
        let body = ReducedBody::new(&shapes.modes, model.matrices.mass(), mesh.positions()).map_err(modal(scene))?;
        let manifold = Manifold::new(body, &shapes, &energies)?;
        let stiffness = |terms| model.stress_stiffness(of_large.as_ref(), modes, terms);
        let (stiffness, of_stress) = (stiffness(GeometricTerms::All)?, stiffness(LOADS)?);
        Ok(Self { shapes, manifold, stiffness, of_stress })
    }

    /// The geometric stiffness `k` (nf × nf) of a static `answer` (3n × 1) in the extended shapes. Between two large modes
    /// it is zero, since the manifold has it. Between a large mode and another it is without that of the answer's parts along
    /// the large modes, which are coordinates that move.
    fn extended(
        &self,
        model: &MeshModel<'_>,
        answer: MatRef<'_, f64>,
        k: &Mat<f64>,
        of_large: &[Mat<f64>],
    ) -> Mat<f64> {
        let SecondOrderShapes { modes, large, dynamic, .. } = &self.shapes;
        let momentum = model.solver.mass().product(answer);
        let along: Vec<f64> = large
            .iter()
            .map(|j| (0..momentum.nrows()).map(|i| modes.shapes[(i, *j)] * momentum[(i, 0)]).sum())
            .collect();
        let extended = modes.shapes.ncols();
        Mat::from_fn(extended, extended, |a, b| {
            if a >= *dynamic || b >= *dynamic {
                return 0.0;
            }
            match (large.contains(&a), large.contains(&b)) {
                (true, true) => 0.0,
                (false, false) => k[(a, b)],
                _ => k[(a, b)] - along.iter().zip(of_large).map(|(part, of)| part * of[(a, b)]).sum::<f64>(),
            }
        })
    }

    /// The manifold of a body that its spin stiffens by `k`, by the static answers (3n × 6) to it.
    pub fn stiffened(
        self,
        model: &MeshModel<'_>,
        answers: MatRef<'_, f64>,
        k: &[Mat<f64>; 6],
    ) -> Result<Self, BuildError> {
        let extended =
            std::array::from_fn(|pair| self.extended(model, answers.subcols(pair, 1), &k[pair], &self.stiffness));
        let body = self.manifold.body().clone().with_stress_stiffness(Some(extended)).map_err(modal(model.scene))?;
        Ok(Self { manifold: self.manifold.with_body(body)?, ..self })
    }

    /// The stress of loads and of a drive in the extended shapes.
    pub fn stressed(&self, model: &MeshModel<'_>, statics: &super::statics::Statics, mut stress: Stress) -> Stress {
        if let Some(of_loads) = &statics.of_loads {
            for (i, directed) in stress.of_loads.iter_mut().enumerate() {
                for (j, directed) in directed.iter_mut().enumerate() {
                    directed.stiffness = self.extended(
                        model,
                        of_loads.answers_to(i).subcols(j, 1),
                        &directed.stiffness,
                        &self.of_stress,
                    );
                }
            }
        }
        if let (Some(answer), Some(k)) = (&statics.of_drive, stress.of_drive.take()) {
            stress.of_drive = Some(self.extended(model, answer.as_ref(), &k, &self.of_stress));
        }
        stress
    }
}
