//! Large deflection: the manifold that the large modes of a body move on.

use faer::{Mat, MatRef};
use fem_tet10::GeometricTerms;
use frames_rk4::Manifold;
use modal::{Modes, SecondOrderShapes};

use super::error::{BuildError, modal};
use super::mesh_model::MeshModel;
use super::statics::Statics;
use super::stress::{DRIVE, Stress};

/// A mode that relieves more than this part of the strain energy of second order of others is drawn in by them. Measured: 0.17
/// of the first mode that stretches a cantilever, 3e-8 at most of those that bend or twist it.
const DRAWN_IN: f64 = 0.02;
/// A mode that is drawn in has a frequency of more than this times theirs. What is as slow as they are moves by itself: the
/// bending of the plate in its plane relieves 9 % of its twist with its bending out of it.
const STIFFER: f64 = 4.0;

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
        let squares: Vec<f64> = large.iter().map(|k| modes.eigenvalues[*k]).collect();
        if let Some((follower, pair)) = drawn_in(of_large.as_ref(), &squares, forces.as_ref(), &energies) {
            let others: Vec<usize> = large.iter().copied().filter(|k| *k != large[follower]).collect();
            if model.scene.modes.large.is_none() {
                return Self::new(model, modes, &others, stress_stiffness, statics);
            }
            return Err(refuse_drawn_in(model, large[follower], pair.map(|j| large[j]), &others));
        }
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

/// A large mode that others draw in, and the pair of these: it stretches where they bend. It follows them, and is far
/// stiffer than they are; as a large mode of its own it would not relieve them as it should when they move far, and the
/// motion would blow up. All are numbered within the large ones.
///
/// The static derivative of a pair has the part `φ·g/ω²` along a mode φ, which relieves the strain energy of the pair by
/// `(φ·g)²/ω²`.
fn drawn_in(
    large: MatRef<'_, f64>,
    squares: &[f64],
    forces: MatRef<'_, f64>,
    energies: &[f64],
) -> Option<(usize, [usize; 2])> {
    let pairs = SecondOrderShapes::pairs(large.ncols());
    let part = |a: usize, pair: usize| {
        let along = large.col(a).transpose() * forces.col(pair);
        along * along / (squares[a] * energies[pair * pairs.len() + pair])
    };
    let is_stiffer = |a: usize, [j, k]: [usize; 2]| squares[a] > STIFFER * STIFFER * squares[j].max(squares[k]);
    (0..large.ncols()).find_map(|a| {
        let draws_in = |index: &usize| is_stiffer(a, pairs[*index]) && part(a, *index) > DRAWN_IN;
        (0..pairs.len()).find(draws_in).map(|index| (a, pairs[index]))
    })
}

/// Refuses a list of large modes, numbered from 0, with one that others draw in.
fn refuse_drawn_in(model: &MeshModel<'_>, follower: usize, [j, k]: [usize; 2], others: &[usize]) -> BuildError {
    let by = if j == k { format!("mode {} bends", j + 1) } else { format!("modes {} and {} bend", j + 1, k + 1) };
    let others: Vec<String> = others.iter().map(|mode| (mode + 1).to_string()).collect();
    let found = format!("mode {}, which is drawn in where {by} the body, and follows by itself", follower + 1);
    let cure = format!("leave it out: `large = [{}]`", others.join(", "));
    model.scene.refuse("modes.large", found, "modes that bend or twist the body", cure).into()
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
