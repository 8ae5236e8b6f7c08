//! Large deflection: the manifold that the large modes of a body move on.

use faer::{Mat, MatRef};
use fem_tet10::GeometricTerms;
use frames_rk4::Manifold;
use modal::{Modes, SecondOrderShapes, StaticAccuracy};

use super::backbones::Derivatives;
use super::error::{BuildError, modal};
use super::mesh_model::{MeshModel, shapes_of};
use super::spin_stress::SpinStress;
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
    /// What is known of the geometric stiffness of the large modes.
    known: Vec<OfLarge>,
}

/// The shapes of second order of the large modes.
struct LargeShapes {
    shapes: SecondOrderShapes,
    /// M φ of each large mode (3n × …).
    momenta: Mat<f64>,
    /// The forces of second order of their pairs in the modes of the motion (nf × pairs).
    of_pairs: Mat<f64>,
}

/// The geometric stiffness of each large mode in the modes (nf × nf), with some of its terms; of interest between a large
/// mode and another.
#[derive(Clone)]
struct OfLarge {
    terms: GeometricTerms,
    stiffness: Vec<Mat<f64>>,
}

impl LargeDeflection {
    /// Of some `large` ones of the modes, of which some `derivatives` are known. `spin` is the stress
    /// stiffness by the static answers to the spin.
    pub fn new(
        model: &MeshModel<'_>,
        modes: &Modes,
        large: &[usize],
        derivatives: &Derivatives,
        statics: &Statics,
        spin: Option<&SpinStress>,
    ) -> Result<Self, BuildError> {
        let solver = model.solver;
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
        let mut energies = vec![0.0; pairs.len() * pairs.len()];
        for ([a, b], energy) in halves.zip(solver.second_order_energies(of_large.as_ref(), &quadruples)?) {
            energies[a * pairs.len() + b] = energy;
            energies[b * pairs.len() + a] = energy;
        }
        let [forces, answers] = second_order_forces(model, modes, large, &pairs, derivatives)?;
        let squares: Vec<f64> = large.iter().map(|k| modes.eigenvalues[*k]).collect();
        if let Some((follower, pair)) = drawn_in(of_large.as_ref(), &squares, forces.as_ref(), &energies) {
            let others: Vec<usize> = large.iter().copied().filter(|k| *k != large[follower]).collect();
            if model.scene.modes.large.is_none() {
                return Self::new(model, modes, &others, derivatives, statics, spin);
            }
            return Err(refuse_drawn_in(model, large[follower], pair.map(|j| large[j]), &others));
        }
        let momenta = solver.mass_product(of_large.as_ref())?;
        let of_pairs =
            Mat::from_fn(modes.shapes.ncols(), pairs.len(), |a, b| modes.shapes.col(a).transpose() * forces.col(b));
        let shapes = solver.second_order_shapes(modes.clone(), large, forces.as_ref(), answers.as_ref())?;
        let large = LargeShapes { shapes, momenta, of_pairs };
        let mut known = Vec::new();
        let extended = match (&statics.of_spin, spin) {
            (Some(answers), Some(spin)) => {
                let all = large.stiffness(model, modes, GeometricTerms::All, &mut known)?.to_vec();
                let initial = large.stiffness(model, modes, GeometricTerms::InitialStress, &mut known)?;
                let of_pair = |(pair, k): (usize, &Mat<f64>)| {
                    let of_mode = |(all, initial)| spin.settled(pair, all, initial);
                    let of_large: Vec<_> = all.iter().zip(initial).map(of_mode).collect();
                    large.extended(answers.answers.subcols(pair, 1), k, &of_large)
                };
                spin.stiffness().iter().enumerate().map(of_pair).collect::<Vec<_>>().try_into().ok()
            }
            _ => None,
        };
        let shapes = &large.shapes;
        let body = solver.reduced_body(&shapes.modes)?.with_stress_stiffness(extended).map_err(modal(model.scene))?;
        Ok(Self { manifold: Manifold::new(body, shapes, &energies)?, large, known })
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
        model: &MeshModel<'_>,
        modes: &Modes,
        statics: &Statics,
        mut stress: Stress,
    ) -> Result<Stress, BuildError> {
        // What is computed is what the stress of some load or drive has.
        let mut known = self.known.clone();
        let mut extended =
            |answer: MatRef<'_, f64>, k: &Mat<f64>, terms: GeometricTerms| -> Result<Mat<f64>, BuildError> {
                Ok(self.large.extended(answer, k, self.large.stiffness(model, modes, terms, &mut known)?))
            };
        if let Some(of_loads) = &statics.of_loads {
            for (i, directed) in stress.of_loads.iter_mut().enumerate() {
                for (j, directed) in directed.iter_mut().enumerate() {
                    let answer = of_loads.answers_to(i).subcols(j, 1);
                    directed.stiffness = extended(answer, &directed.stiffness, directed.terms)?;
                }
            }
        }
        if let (Some(answer), Some(k)) = (&statics.of_drive, stress.of_drive.take()) {
            stress.of_drive = Some(extended(answer.as_ref(), &k, DRIVE)?);
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

/// Forces of second order of pairs of large modes, and the static answers to them; those that are known are not computed.
fn second_order_forces(
    model: &MeshModel<'_>,
    modes: &Modes,
    large: &[usize],
    pairs: &[[usize; 2]],
    derivatives: &Derivatives,
) -> Result<[Mat<f64>; 2], BuildError> {
    let of_large = shapes_of(modes, large);
    let known = |[j, k]: [usize; 2]| derivatives.of_mode(large[j]).filter(|_| j == k);
    let missing: Vec<[usize; 2]> = pairs.iter().copied().filter(|pair| known(*pair).is_none()).collect();
    let forces = model.solver.second_order_forces(of_large.as_ref(), &missing)?;
    let answers = model.solver.static_response(modes, forces.as_ref(), StaticAccuracy::Shapes)?;
    let mut found = [(); 2].map(|()| Mat::zeros(of_large.nrows(), pairs.len()));
    let mut computed = forces.col_iter().zip(answers.col_iter());
    for (column, pair) in pairs.iter().enumerate() {
        let known = known(*pair).or_else(|| computed.next().map(|(force, answer)| [force, answer]));
        for (all, one) in found.iter_mut().zip(known.into_iter().flatten()) {
            all.col_mut(column).copy_from(one);
        }
    }
    Ok(found)
}

impl LargeShapes {
    /// The geometric stiffness of each large mode in the `modes` of the motion, where it is not `known`. With all terms `φ_a·K(φ_j)·φ_b` is
    /// `φ_a·g_jb`, whichever of the three is large.
    fn stiffness<'k>(
        &self,
        model: &MeshModel<'_>,
        modes: &Modes,
        terms: GeometricTerms,
        known: &'k mut Vec<OfLarge>,
    ) -> Result<&'k [Mat<f64>], BuildError> {
        let place = match known.iter().position(|of_large| of_large.terms == terms) {
            Some(place) => place,
            None => {
                known.push(OfLarge { terms, stiffness: self.computed(model, modes, terms)? });
                known.len() - 1
            }
        };
        Ok(&known[place].stiffness)
    }

    fn computed(
        &self,
        model: &MeshModel<'_>,
        modes: &Modes,
        terms: GeometricTerms,
    ) -> Result<Vec<Mat<f64>>, BuildError> {
        let large = &self.shapes.large;
        Ok(match terms {
            GeometricTerms::InitialStress => {
                model.solver.stress_stiffness(shapes_of(modes, large).as_ref(), modes, terms, &[])?
            }
            GeometricTerms::All => {
                let pairs = SecondOrderShapes::pairs(large.len());
                let place = |mode: usize| large.iter().position(|k| *k == mode);
                let of_pair = |mode: usize, j: usize, k: usize| {
                    let pair = pairs.iter().position(|pair| *pair == [j.min(k), j.max(k)]);
                    pair.map_or(0.0, |pair| self.of_pairs[(mode, pair)])
                };
                let of = |j: usize, a: usize, b: usize| match (place(a), place(b)) {
                    (_, Some(k)) => of_pair(a, j, k),
                    (Some(k), None) => of_pair(b, j, k),
                    (None, None) => 0.0,
                };
                let count = modes.shapes.ncols();
                (0..large.len()).map(|j| Mat::from_fn(count, count, |a, b| of(j, a, b))).collect()
            }
        })
    }

    /// The geometric stiffness `k` (nf × nf) of a static `answer` (3n × 1) in the extended shapes. Between two large modes
    /// it is zero, since the manifold has it. Between a large mode and another it is without that of the answer's parts along
    /// the large modes, which are coordinates that move, with the same terms.
    fn extended(&self, answer: MatRef<'_, f64>, k: &Mat<f64>, of_large: &[Mat<f64>]) -> Mat<f64> {
        let SecondOrderShapes { modes, large, dynamic, .. } = &self.shapes;
        let along: Vec<f64> = self.momenta.col_iter().map(|momentum| momentum.transpose() * answer.col(0)).collect();
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
