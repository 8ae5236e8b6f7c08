//! The body beyond the first order in its modes: relieving displacements, forces and energies.

use faer::{Mat, MatRef, Scale};
use fem_tet10::{Expansion, second_order_energies, second_order_forces};
use modal::{Modes, StaticAccuracy};
use reduced_body::LargeProducts;

use crate::error::BuildError;
use crate::structure::kept::{Extended, OwnSecondOrder, SecondOrder};
use crate::structure::{Structure, shapes_of};

impl Structure<'_> {
    /// The second order of some modes, each with itself: forces, responses and energy, and beside them for each
    /// `φᵀMu` and `uᵀMu` of its response u.
    pub fn own_second_order(&self, modes: &Modes, list: &[usize]) -> Result<OwnSecondOrder, BuildError> {
        let asked = self.of_held_body("own second order").with_natural(modes).with("list", list);
        self.ask(asked, [self.rows(), list.len()], || {
            let (shapes, places) = (shapes_of(modes, list), 0..list.len());
            let pairs: Vec<[usize; 2]> = places.clone().map(|j| [j; 2]).collect();
            let quadruples: Vec<[usize; 4]> = places.map(|j| [j; 4]).collect();
            let second = self.find_second_order(modes, shapes.as_ref(), &pairs, &quadruples)?;
            let momenta = self.solver()?.mass().product(second.responses.as_ref());
            let along = |fields: &Mat<f64>| {
                fields
                    .col_iter()
                    .zip(momenta.col_iter())
                    .map(|(field, momentum)| field.transpose() * momentum)
                    .collect()
            };
            Ok(OwnSecondOrder { along: along(&shapes), inertia: along(&second.responses), second })
        })
    }

    /// The part of the strain energy of second order of each pair of some modes that each of these relieves: pairs j ≤ k within
    /// modes.
    pub fn relieved(&self, modes: &Modes, list: &[usize]) -> Result<Vec<f64>, BuildError> {
        let pairs: Vec<[usize; 2]> = (0..list.len()).flat_map(|j| (j..list.len()).map(move |k| [j, k])).collect();
        let asked = self.of_held_body("relieved energies").with_natural(modes).with("list", list);
        self.ask(asked, list.len() * pairs.len(), || {
            let (mesh, materials, shapes) = (&self.assembled.mesh, self.assembled.materials()?, shapes_of(modes, list));
            let quadruples: Vec<[usize; 4]> = pairs.iter().map(|[j, k]| [*j, *k, *j, *k]).collect();
            self.pass_elements();
            let energies = second_order_energies(mesh, materials, shapes.as_ref(), &quadruples)?;
            self.pass_elements();
            let forces = second_order_forces(mesh, materials, shapes.as_ref(), &pairs)?;
            let along = shapes.transpose() * forces;
            let part = |a: usize, pair: usize| along[(a, pair)].powi(2) / (modes.eigenvalues[list[a]] * energies[pair]);
            Ok((0..list.len())
                .flat_map(|a| (0..pairs.len()).map(move |pair| (a, pair)))
                .map(|(a, p)| part(a, p))
                .collect())
        })
    }

    fn find_second_order(
        &self,
        modes: &Modes,
        shapes: MatRef<'_, f64>,
        pairs: &[[usize; 2]],
        quadruples: &[[usize; 4]],
    ) -> Result<SecondOrder, BuildError> {
        let (mesh, materials) = (&self.assembled.mesh, self.assembled.materials()?);
        self.pass_elements();
        let energies = second_order_energies(mesh, materials, shapes, quadruples)?;
        self.pass_elements();
        let forces = second_order_forces(mesh, materials, shapes, pairs)?;
        let responses = self.solve(modes, forces.as_ref(), StaticAccuracy::Shapes)?;
        Ok(SecondOrder { forces, responses, energies })
    }

    /// The shapes of large modes and of those that follow them, the body in the extended shapes, and the strain energies.
    pub fn large_shapes(&self, modes: &Modes, large: &[usize], following: &[usize]) -> Result<Extended, BuildError> {
        let asked = self.of_held_body("large shapes, uncoupled").with_modes(modes).with("natural", &modes.natural());
        let asked = asked.with("large", large).with("following", following);
        self.ask(asked, (modes, large, following), || self.find_large_shapes(modes, large, following))
    }

    fn find_large_shapes(&self, modes: &Modes, large: &[usize], following: &[usize]) -> Result<Extended, BuildError> {
        let (mesh, materials) = (&self.assembled.mesh, self.assembled.materials()?);
        let list = [large, following].concat();
        let (bent, uncoupled) = (shapes_of(modes, &list), modes.uncoupled(&list));
        let products = LargeProducts { large: large.len(), following: following.len() };
        let reference = self.reference().map(|reference| reference.displacement.as_ref());
        let mut known: Vec<Vec<usize>> = (0..products.coordinates()).map(|k| vec![k]).collect();
        let mut fields = bent.clone();
        // Measured, of moments on rods, blades and arcs: those of three without coupling make the errors three to four times larger.
        for (wanted, of) in [(products.second(), &uncoupled), (products.third(), &bent)] {
            let expansion = Expansion { products: &known, fields: fields.as_ref(), reference };
            self.pass_elements();
            let forces = expansion.forces(mesh, materials, &wanted)?;
            let answers = self.solve(modes, forces.as_ref(), StaticAccuracy::Shapes)? * Scale(-1.0);
            let freed = |count: usize| {
                let [shapes, of] = [&bent, of].map(|shapes| shapes.subcols(0, count));
                self.solver()?.freed(answers.as_ref(), shapes, of).map_err(|error| self.modal(error))
            };
            let (of_large, of_all) = (freed(large.len())?, freed(list.len())?);
            let first = fields.ncols();
            fields = Mat::from_fn(fields.nrows(), first + wanted.len(), |i, j| match j.checked_sub(first) {
                None => fields[(i, j)],
                Some(k) if products.follows(&wanted[k]) => of_all[(i, k)],
                Some(k) => of_large[(i, k)],
            });
            known.extend(wanted);
        }
        let expansion = Expansion { products: &known, fields: fields.as_ref(), reference };
        self.pass_elements();
        let energies = expansion.energies(mesh, materials, &products.of_energy())?;
        let of_products = fields.get(.., products.coordinates()..);
        let shapes = self.solver()?.large_shapes(modes.clone(), large, following, of_products);
        let shapes = shapes.map_err(|error| self.modal(error))?;
        Ok(Extended { body: self.reduced(&shapes.modes)?, shapes, energies })
    }
}
