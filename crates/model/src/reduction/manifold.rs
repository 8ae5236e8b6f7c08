//! Large deflection: the manifold that the large modes of a body move on.

use std::cell::OnceCell;

use dynamics::Manifold;
use faer::{Mat, MatRef, Scale};
use fem_tet10::GeometricTerms;
use modal::{Modes, SecondOrderShapes};

use crate::error::{BuildError, modal};
use crate::reduction::backbones::Derivatives;
use crate::reduction::mesh_model::MeshModel;
use crate::stress::spin::SpinStress;
use crate::stress::{DRIVE, Stress};
use crate::structure::kept::Extended;
use crate::structure::shapes_of;
use crate::structure::statics::{OfSpin, Statics};

/// A mode that relieves more than this part of the strain energy of second order of others is drawn in by them. Measured: 0.17
/// of the first mode that stretches a cantilever, 3e-8 at most of those that bend or twist it.
const DRAWN_IN: f64 = 0.02;
/// A mode that is drawn in has a frequency of more than this times theirs. What is as slow as they are moves by itself: the
/// bending of the plate in its plane relieves 9 % of its twist with its bending out of it.
const STIFFER: f64 = 4.0;

/// The manifold of the large modes, and the shapes that it is made of.
pub(crate) struct LargeDeflection {
    pub manifold: Manifold,
    large: LargeShapes,
}

/// The shapes of second order of the large modes, and the geometric stiffness of each large mode in the modes of the motion
/// (nf × nf); of interest is that between a large mode and another.
struct LargeShapes {
    shapes: SecondOrderShapes,
    /// M φ of each large mode (3n × …).
    momenta: Mat<f64>,
    /// The stiffness by all terms.
    by_all_terms: Vec<Mat<f64>>,
    /// By the initial stress alone; it takes a pass over the elements.
    by_initial_stress: OnceCell<Vec<Mat<f64>>>,
}

impl LargeDeflection {
    /// The manifold of some `large` modes, of which some `derivatives` are known. `spin` is the stress
    /// stiffness by the static responses to the spin.
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        large: &[usize],
        derivatives: &Derivatives,
        statics: &Statics,
        spin: Option<&SpinStress>,
    ) -> Result<Self, BuildError> {
        let structure = model.structure;
        let of_large = shapes_of(modes, large);
        let pairs = SecondOrderShapes::pairs(large.len());
        // The energy is the same with the pairs in each other's place.
        let halves = (0..pairs.len()).flat_map(|a| (a..pairs.len()).map(move |b| [a, b]));
        let quadruples: Vec<[usize; 4]> = halves
            .clone()
            .map(|[a, b]| {
                let ([i, j], [k, l]) = (pairs[a], pairs[b]);
                [i, j, k, l]
            })
            .collect();
        let known = |[j, k]: [usize; 2]| derivatives.of_mode(large[j]).filter(|_| j == k);
        let missing: Vec<[usize; 2]> = pairs.iter().copied().filter(|pair| known(*pair).is_none()).collect();
        let found = structure.second_order(modes, large, &missing, &quadruples)?;
        let mut energies = vec![0.0; pairs.len() * pairs.len()];
        for ([a, b], energy) in halves.zip(&found.energies) {
            energies[a * pairs.len() + b] = *energy;
            energies[b * pairs.len() + a] = *energy;
        }
        let mut computed = found.forces.col_iter().zip(found.responses.col_iter()).map(|(f, u)| [f, u]);
        let columns: Vec<_> = pairs.iter().filter_map(|pair| known(*pair).or_else(|| computed.next())).collect();
        let [forces, responses] =
            [0, 1].map(|which| Mat::from_fn(of_large.nrows(), pairs.len(), |i, pair| columns[pair][which][i]));
        let squares: Vec<f64> = large.iter().map(|k| modes.eigenvalues[*k]).collect();
        if let Some((follower, pair)) = drawn_in(of_large.as_ref(), &squares, forces.as_ref(), &energies) {
            let others: Vec<usize> = large.iter().copied().filter(|k| *k != large[follower]).collect();
            if model.scene.modes.large.is_none() {
                return Self::new(model, modes, &others, derivatives, statics, spin);
            }
            return Err(refuse_drawn_in(model, large[follower], pair.map(|j| large[j]), &others));
        }
        let by_all_terms = stiffness_by_pairs(modes, large, &pairs, forces.as_ref());
        let Extended { shapes, body, momenta } =
            structure.second_order_shapes(modes, large, forces.as_ref(), responses.as_ref())?;
        let large = LargeShapes { shapes, momenta, by_all_terms, by_initial_stress: OnceCell::new() };
        let extended = match (&statics.of_spin, spin) {
            (Some(OfSpin { responses, .. }), Some(spin)) => {
                let all = large.stiffness(model, modes, GeometricTerms::All)?;
                let of_large = if spin.is_by_all_terms() {
                    all.to_vec()
                } else {
                    let initial = large.stiffness(model, modes, GeometricTerms::InitialStress)?;
                    all.iter().zip(initial).map(|(all, initial)| spin.settled(all, initial)).collect()
                };
                let k = spin.stiffness();
                Some(std::array::from_fn(|pair| large.extended(responses.subcols(pair, 1), &k[pair], &of_large)))
            }
            _ => None,
        };
        let shapes = &large.shapes;
        let body = body.with_stress_stiffness(extended).map_err(modal(model.scene))?;
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

    /// The stress of loads and of a drive in the extended shapes. `modes` are those of the motion.
    pub fn stressed(
        &self,
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        statics: &Statics,
        mut stress: Stress,
    ) -> Result<Stress, BuildError> {
        let extended = |response: MatRef<'_, f64>, k: &Mat<f64>, terms| -> Result<Mat<f64>, BuildError> {
            Ok(self.large.extended(response, k, self.large.stiffness(model, modes, terms)?))
        };
        if let Some(of_loads) = &statics.of_loads {
            for (i, directed) in stress.of_loads.iter_mut().enumerate() {
                let responses = of_loads.of_unit(i) * Scale(model.loads[i].size());
                for (j, directed) in directed.iter_mut().enumerate() {
                    directed.stiffness = extended(responses.subcols(j, 1), &directed.stiffness, directed.terms)?;
                }
            }
        }
        if let (Some(response), Some(k)) = (&statics.of_drive, stress.of_drive.take()) {
            stress.of_drive = Some(extended(response.as_ref(), &k, DRIVE)?);
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
fn refuse_drawn_in(model: &MeshModel<'_, '_>, follower: usize, [j, k]: [usize; 2], others: &[usize]) -> BuildError {
    let by = if j == k { format!("mode {} bends", j + 1) } else { format!("modes {} and {} bend", j + 1, k + 1) };
    let others: Vec<String> = others.iter().map(|mode| (mode + 1).to_string()).collect();
    let found = format!("mode {}, which is drawn in where {by} the body, and follows by itself", follower + 1);
    let help = format!("leave it out: `large = [{}]`", others.join(", "));
    model.scene.refuse("modes.large", found, "modes that bend or twist the body", help).into()
}

/// The geometric stiffness by all terms of each large mode in the `modes` of the motion, between a large mode and another:
/// `φ_a·K(φ_j)·φ_b` is `φ_a·g_jb`, whichever of the three is large, with the `forces` g of second order of the pairs.
fn stiffness_by_pairs(modes: &Modes, large: &[usize], pairs: &[[usize; 2]], forces: MatRef<'_, f64>) -> Vec<Mat<f64>> {
    let count = modes.shapes.ncols();
    let along = Mat::from_fn(count, pairs.len(), |a, b| modes.shapes.col(a).transpose() * forces.col(b));
    let place = |mode: usize| large.iter().position(|k| *k == mode);
    let of_pair = |mode: usize, j: usize, k: usize| {
        let pair = pairs.iter().position(|pair| *pair == [j.min(k), j.max(k)]);
        pair.map_or(0.0, |pair| along[(mode, pair)])
    };
    let of = |j: usize, a: usize, b: usize| match (place(a), place(b)) {
        (_, Some(k)) => of_pair(a, j, k),
        (Some(k), None) => of_pair(b, j, k),
        (None, None) => 0.0,
    };
    (0..large.len()).map(|j| Mat::from_fn(count, count, |a, b| of(j, a, b))).collect()
}

impl LargeShapes {
    /// The geometric stiffness of each large mode in the `modes` of the motion.
    fn stiffness(
        &self,
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        terms: GeometricTerms,
    ) -> Result<&[Mat<f64>], BuildError> {
        match (terms, self.by_initial_stress.get()) {
            (GeometricTerms::All, _) => Ok(&self.by_all_terms),
            (GeometricTerms::InitialStress, Some(known)) => Ok(known),
            (GeometricTerms::InitialStress, None) => {
                let large = shapes_of(modes, &self.shapes.large);
                let found = model.structure.stress_stiffness(large.as_ref(), modes, terms, &[])?;
                Ok(self.by_initial_stress.get_or_init(|| found))
            }
        }
    }

    /// The geometric stiffness `k` (nf × nf) of a static `response` (3n × 1) in the extended shapes. Between two large modes
    /// it is zero, since the manifold has it. Between a large mode and another it is without that of the response's parts along
    /// the large modes, which are coordinates that move, with the same terms.
    fn extended(&self, response: MatRef<'_, f64>, k: &Mat<f64>, of_large: &[Mat<f64>]) -> Mat<f64> {
        let SecondOrderShapes { modes, large, dynamic, .. } = &self.shapes;
        let along: Vec<f64> = self.momenta.col_iter().map(|momentum| momentum.transpose() * response.col(0)).collect();
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
}
