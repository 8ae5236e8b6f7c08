//! Large deflection: the manifold that the large modes of a body move on.

use dynamics::Manifold;
use faer::Mat;
use modal::{LargeShapes, Modes};
use reduced_body::LargeCoordinates;

use crate::error::{BuildError, modal};
use crate::reduction::bent::Bent;
use crate::reduction::mesh_model::MeshModel;
use crate::stress::{Stress, in_shapes};
use crate::structure::kept::Extended;

/// A mode that relieves more than this part of the strain energy of second order of others is drawn in by them. Measured: 0.17
/// of the first mode that stretches a cantilever, 3e-8 at most of those that bend or twist it.
const DRAWN_IN: f64 = 0.02;
/// A mode that is drawn in has a frequency of more than this times theirs. What is as slow as they are moves by itself: the
/// bending of the plate in its plane relieves 9 % of its twist with its bending out of it, and the walls of a tube that bulge, at 4.2
/// times the frequency, 9 % of its bending. The first mode that stretches a rod has 24 times that of its bending.
const STIFFER: f64 = 6.0;
/// Number of the slowest modes that are asked whether they draw in what the program would take as large.
const SLOWEST: usize = 4;

impl Bent {
    /// Without large modes that others draw in, which follow by themselves: as large modes of their own they would not relieve
    /// the others as they should, and the motion would blow up. Those that the program takes by itself are held against the slowest
    /// modes, too, even if these are not large: a mode that stretches the body holds nothing of the stiffness of a bent one.
    ///
    /// The static derivative of a pair has the part `φ·g/ω²` along a mode φ, which relieves the strain energy of the pair by
    /// `(φ·g)²/ω²`.
    pub fn settled(self, model: &MeshModel<'_, '_>, modes: &Modes) -> Result<Self, BuildError> {
        let Self { large, following } = &self;
        let stiffest = large.iter().map(|a| modes.eigenvalues[*a]).fold(0.0, f64::max);
        let is_asked = |k: &usize| {
            model.scene.modes.large.is_none()
                && !large.contains(k)
                && stiffest > STIFFER * STIFFER * modes.eigenvalues[*k]
        };
        let slowest = (0..modes.natural().min(SLOWEST)).filter(is_asked);
        let asked: Vec<usize> = large.iter().copied().chain(slowest).collect();
        if asked.len() < 2 {
            return Ok(self);
        }
        let relieved = model.structure.relieved(modes, &asked)?;
        let pairs: Vec<[usize; 2]> = (0..asked.len()).flat_map(|j| (j..asked.len()).map(move |k| [j, k])).collect();
        let square = |a: usize| modes.eigenvalues[asked[a]];
        let draws_in = |a: usize, index: usize| {
            let [j, k] = pairs[index];
            let is_stiffer = square(a) > STIFFER * STIFFER * square(j).max(square(k));
            is_stiffer && relieved[a * pairs.len() + index] > DRAWN_IN
        };
        let found = (0..large.len()).find_map(|a| Some((a, (0..pairs.len()).find(|index| draws_in(a, *index))?)));
        let Some((follower, index)) = found else { return Ok(self) };
        let others: Vec<usize> = large.iter().copied().filter(|k| *k != large[follower]).collect();
        if model.scene.modes.large.is_none() {
            return Self { large: others, following: following.clone() }.settled(model, modes);
        }
        Err(refuse_drawn_in(model, large[follower], pairs[index].map(|j| asked[j]), &others))
    }
}

/// The manifold of the large modes, and the shapes that it is made of.
pub(crate) struct LargeDeflection {
    pub manifold: Manifold,
    /// B (modes × modes): the work of the internal forces of a bent reference on displacements of second order is ½ qᵀBq.
    pub reference_work: Option<Mat<f64>>,
    shapes: LargeShapes,
}

impl LargeDeflection {
    /// The manifold of the modes that bend the body. `spin` is the stiffness by the stress of the spin in the modes, beside what
    /// the manifold has of it.
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        Bent { large, following }: &Bent,
        spin: Option<&[Mat<f64>; 6]>,
    ) -> Result<Self, BuildError> {
        let Extended { shapes, body, mut energies } = model.structure.large_shapes(modes, large, following)?;
        let reference_work = model.reference.map(|reference| {
            let forces = reference.modal_forces(&shapes.modes);
            reference_work(&shapes.coordinates, &forces, &mut energies)
        });
        let extended = spin.map(|spin| spin.each_ref().map(|k| in_shapes(k, body.flexible())));
        let body = body.with_stress_stiffness(extended).map_err(modal(model.scene))?;
        Ok(Self { manifold: Manifold::new(body, shapes.coordinates.clone(), &energies)?, reference_work, shapes })
    }

    /// The extended shapes.
    pub fn modes(&self) -> &Modes {
        &self.shapes.modes
    }

    /// The extended shapes after the modes.
    pub fn following(&self) -> Mat<f64> {
        let LargeShapes { modes, coordinates } = &self.shapes;
        modes.shapes.get(.., coordinates.dynamic..).to_owned()
    }

    /// The stress of loads and of a drive in the extended shapes: on the modes alone.
    pub fn stressed(&self, mut stress: Stress) -> Stress {
        let count = self.manifold.body().flexible();
        for directed in stress.of_loads.iter_mut().flatten() {
            directed.stiffness = in_shapes(&directed.stiffness, count);
        }
        stress.of_drive = stress.of_drive.map(|k| in_shapes(&k, count));
        stress
    }
}

/// The work of forces in the extended shapes on the displacements of products: that of third order is added to the energies, that of
/// second order is given as a stiffness.
fn reference_work(coordinates: &LargeCoordinates, forces: &[f64], energies: &mut [f64]) -> Mat<f64> {
    let (products, of_energy) = (coordinates.products(), coordinates.products().of_energy());
    let bent = [&coordinates.large[..], &coordinates.following].concat();
    let mut stiffness = Mat::zeros(coordinates.dynamic, coordinates.dynamic);
    for (product, displacement) in products.of_displacement().iter().zip(coordinates.coefficients.col_iter()) {
        let work: f64 = displacement.iter().zip(forces).map(|(a, force)| a * force).sum();
        if let [j, k] = product[..] {
            stiffness[(bent[j], bent[k])] += work;
            stiffness[(bent[k], bent[j])] += work;
        } else if let Some(place) = of_energy.iter().position(|other| other == product) {
            energies[place] += work;
        }
    }
    stiffness
}

/// Refuses a list of large modes, numbered from 0, with one that others draw in.
fn refuse_drawn_in(model: &MeshModel<'_, '_>, follower: usize, [j, k]: [usize; 2], others: &[usize]) -> BuildError {
    let by = if j == k { format!("mode {} bends", j + 1) } else { format!("modes {} and {} bend", j + 1, k + 1) };
    let others: Vec<String> = others.iter().map(|mode| (mode + 1).to_string()).collect();
    let found = format!("mode {}, which is drawn in where {by} the body, and follows by itself", follower + 1);
    let help = format!("leave it out: `large = [{}]`", others.join(", "));
    model.scene.refuse("modes.large", found, "modes that bend or twist the body", help).into()
}
