//! The forces of inertia on the modes, and on a manifold their projection.

use nalgebra::Vector3;
use pulp::Simd;
use reduced_body::ReducedBody;

use crate::conservative::body::ConservativeBody;
use crate::conservative::rates::evaluation::Evaluation;
use crate::matrix::four::{Padded, WIDTH};
use crate::matrix::side_by_side::{Lists, add_combined, combine};
use crate::matrix::stack::Places;

impl ConservativeBody {
    /// Adds Σ ω_iω_j (c_ij + N_ij z) − Σ ω_i G_i ż, which of a locked body has p for ż, to p' or, on a manifold, puts it
    /// into the forces on z.
    #[inline(always)]
    pub(in crate::conservative) fn inertia_forces<S: Simd>(&self, simd: S, e: &mut Evaluation) {
        let width = self.lists();
        if self.g_count > 0 && !self.locked {
            let Evaluation { products, velocity, modal_velocity, .. } = &mut *e;
            let rate = if self.manifold.is_some() { velocity.groups() } else { modal_velocity.groups() };
            let places = Places { groups: products, width, first: self.lists_of_undeformed() };
            self.gyroscopic.multiply(simd, rate, Lists::ZEROS, places);
        }
        let (pairs, w) = (self.pairs.len(), e.spin);
        let mut factors = [0.0; 9];
        if pairs == 6 {
            // By constant numbers, which are not checked one by one.
            factors[..6].copy_from_slice(&ReducedBody::PAIRS.map(|pair| spin_product(&w, pair)));
        } else if pairs == 1 {
            factors[0] = w.x * w.x;
        }
        for (factor, w) in factors[pairs..].iter_mut().zip(&w.as_slice()[..self.g_count]) {
            *factor = -w;
        }
        let factors = &factors[..pairs + self.g_count];
        let lists = self.pair_lists(&e.products);
        if self.manifold.is_some() {
            combine(simd, lists, factors, e.force.groups_mut());
        } else {
            let [_, momentum] = e.rates.groups_mut();
            add_combined(simd, lists, factors, momentum);
        }
    }

    /// Finds S' = G_i ż, the lists side by side.
    #[inline(always)]
    pub(in crate::conservative) fn coupling_rate<'e, S: Simd>(
        &self,
        simd: S,
        e: &'e mut Evaluation,
    ) -> (Lists<'e>, &'e mut Padded) {
        if self.locked && self.g_count > 0 {
            let places = Places { groups: &mut e.coupling_rate, width: self.g_count, first: 0 };
            self.gyroscopic.multiply(simd, e.modal_velocity.groups(), Lists::ZEROS, places);
            return (Lists { groups: &e.coupling_rate, width: self.g_count, first: 0 }, &mut e.change);
        }
        let first = self.lists_of_undeformed();
        (Lists { groups: &e.products, width: self.lists(), first }, &mut e.change)
    }

    /// On a manifold, adds Dᵀ of the forces on z, Ḋᵀμ and the forces of the strain energy beyond ½ qᵀΛq to p'.
    #[inline(always)]
    pub(in crate::conservative) fn project_forces(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let [_, momentum] = e.rates.modes_mut();
        manifold.add_projection(&e.place, &e.force, momentum);
        self.find_momenta_of_products(speed, e);
        let [_, momentum] = e.rates.modes_mut();
        manifold.add_projected_rate(&e.place, &e.momenta_of_products, momentum);
        manifold.subtract_force(&e.place, momentum);
    }

    /// μ of the products.
    #[inline(always)]
    fn find_momenta_of_products(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let momenta = &mut e.momenta_of_products;
        let modes = e.modal_velocity.len();
        manifold.momenta_of_products(&e.velocity, momenta);
        for (i, mu) in momenta.iter_mut().enumerate() {
            let (group, lane) = ((modes + i) / WIDTH, (modes + i) % WIDTH);
            let s = &e.products[group * self.lists()..][..self.s_count];
            for (s, w) in s.iter().zip(e.spin.iter()) {
                *mu += s[lane] * w;
            }
        }
        momenta.iter_mut().zip(self.sliding.iter().skip(modes)).for_each(|(mu, b)| *mu += b * speed);
    }

    /// On a manifold, finds ξ and ν.
    #[inline(always)]
    pub(in crate::conservative) fn find_in_shapes(&self, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let [xi, nu, _] = &mut e.in_shapes;
        manifold.in_shapes(&e.coordinates, xi);
        manifold.in_shapes(&e.velocity, nu);
    }
}

/// Sum of ω_iω_j and ω_jω_i in a sum over all pairs.
fn spin_product(spin: &Vector3<f64>, (i, j): (usize, usize)) -> f64 {
    let product = spin[i] * spin[j];
    if i == j { product } else { 2.0 * product }
}
