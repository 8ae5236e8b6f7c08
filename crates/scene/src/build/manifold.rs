//! Large deflection: the manifold that the large modes of a body move on.

use faer::{Mat, MatRef};
use fem_tet10::GeometricTerms;
use frames_rk4::Manifold;
use modal::{Modes, SecondOrderShapes};

use super::error::{BuildError, modal};
use super::mesh_model::MeshModel;
use super::statics::Statics;
use super::stress::{DRIVE, Stress};

/// The manifold of the large modes, and the shapes that it is made of.
pub(super) struct LargeDeflection {
    pub manifold: Manifold,
    large: LargeShapes,
}

/// The shapes of second order of the large modes.
struct LargeShapes {
    shapes: SecondOrderShapes,
    /// The geometric stiffness of each large mode in the modes (nf × nf): of its initial stress, and in full.
    of_stress: Vec<Mat<f64>>,
    in_full: Vec<Mat<f64>>,
}

impl LargeDeflection {
    /// Of some `large` ones of the modes. `stress_stiffness` (6 of nf × nf) is by the static answers to the spin.
    pub fn new(
        model: &MeshModel<'_>,
        modes: &Modes,
        large: &[usize],
        stress_stiffness: Option<&[Mat<f64>; 6]>,
        statics: &Statics,
    ) -> Result<Self, BuildError> {
        let solver = model.solver;
        let of_large = Mat::from_fn(modes.shapes.nrows(), large.len(), |i, j| modes.shapes[(i, large[j])]);
        let pairs = SecondOrderShapes::pairs(large.len());
        let quadruples: Vec<[usize; 4]> =
            pairs.iter().flat_map(|[i, j]| pairs.iter().map(move |[k, l]| [*i, *j, *k, *l])).collect();
        let forces = solver.second_order_forces(of_large.as_ref(), &pairs)?;
        let energies = solver.second_order_energies(of_large.as_ref(), &quadruples)?;
        let shapes = solver.second_order_shapes(modes.clone(), large, forces.as_ref())?;
        let of_stress = solver.stress_stiffness(of_large.as_ref(), modes, GeometricTerms::InitialStress)?;
        let in_full = solver.stress_stiffness(of_large.as_ref(), modes, GeometricTerms::All)?;
        let large = LargeShapes { shapes, of_stress, in_full };
        let extended = match (&statics.of_spin, stress_stiffness) {
            (Some(of_spin), Some(k)) => {
                let answer = |pair| of_spin.answers.subcols(pair, 1);
                let mut of_pairs = Vec::with_capacity(k.len());
                for (pair, k) in k.iter().enumerate() {
                    of_pairs.push(large.extended(model, answer(pair), k, GeometricTerms::All)?);
                }
                of_pairs.try_into().ok()
            }
            _ => None,
        };
        let shapes = &large.shapes;
        let body = solver.reduced_body(&shapes.modes)?.with_stress_stiffness(extended).map_err(modal(model.scene))?;
        Ok(Self { manifold: Manifold::new(body, shapes, &energies)?, large })
    }

    /// The extended shapes.
    pub fn modes(&self) -> &Modes {
        &self.large.shapes.modes
    }

    /// The extended shapes after the modes.
    pub fn following(&self) -> Mat<f64> {
        let SecondOrderShapes { modes, dynamic, .. } = &self.large.shapes;
        modes.shapes.get(.., *dynamic..).to_owned()
    }

    /// The stress of loads and of a drive in the extended shapes.
    pub fn stressed(&self, model: &MeshModel<'_>, statics: &Statics, mut stress: Stress) -> Result<Stress, BuildError> {
        if let Some(of_loads) = &statics.of_loads {
            for (i, directed) in stress.of_loads.iter_mut().enumerate() {
                for (j, directed) in directed.iter_mut().enumerate() {
                    let answer = of_loads.answers_to(i).subcols(j, 1);
                    directed.stiffness = self.large.extended(model, answer, &directed.stiffness, directed.terms)?;
                }
            }
        }
        if let (Some(answer), Some(k)) = (&statics.of_drive, stress.of_drive.take()) {
            stress.of_drive = Some(self.large.extended(model, answer.as_ref(), &k, DRIVE)?);
        }
        Ok(stress)
    }
}

impl LargeShapes {
    /// The geometric stiffness `k` (nf × nf) of a static `answer` (3n × 1) in the extended shapes. Between two large modes
    /// it is zero, since the manifold has it. Between a large mode and another it is without that of the answer's parts along
    /// the large modes, which are coordinates that move, with the same `terms`.
    fn extended(
        &self,
        model: &MeshModel<'_>,
        answer: MatRef<'_, f64>,
        k: &Mat<f64>,
        terms: GeometricTerms,
    ) -> Result<Mat<f64>, BuildError> {
        let of_large = match terms {
            GeometricTerms::InitialStress => &self.of_stress,
            GeometricTerms::All => &self.in_full,
        };
        let SecondOrderShapes { modes, large, dynamic, .. } = &self.shapes;
        let momentum = model.solver.mass_product(answer)?;
        let along: Vec<f64> = large
            .iter()
            .map(|j| (0..momentum.nrows()).map(|i| modes.shapes[(i, *j)] * momentum[(i, 0)]).sum())
            .collect();
        let extended = modes.shapes.ncols();
        Ok(Mat::from_fn(extended, extended, |a, b| {
            if a >= *dynamic || b >= *dynamic {
                return 0.0;
            }
            match (large.contains(&a), large.contains(&b)) {
                (true, true) => 0.0,
                (false, false) => k[(a, b)],
                _ => k[(a, b)] - along.iter().zip(of_large).map(|(part, of)| part * of[(a, b)]).sum::<f64>(),
            }
        }))
    }
}
