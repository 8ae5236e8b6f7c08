//! Quantities of the deformed body: S, the inertia, and the spin that a momentum stands for.

use nalgebra::{Matrix3, Vector3};
use pulp::Simd;

use crate::conservative::body::ConservativeBody;
use crate::conservative::manifold::BentPlace;
use crate::conservative::rates::evaluation::Evaluation;
use crate::error::RateError;
use crate::matrix::four::Group;
use crate::matrix::lists::dot;
use crate::matrix::side_by_side::{Lists, dots, locked_dots, own_products};
use crate::matrix::stack::Places;
use crate::matrix::symmetric;

impl ConservativeBody {
    /// z, and there S, c_ij + N_ij z, K q and the locked inertia; of a locked body G_i p and Sᵀp as well.
    #[inline(always)]
    pub(in crate::conservative) fn deform<S: Simd>(&self, simd: S, e: &mut Evaluation) {
        if let Some(manifold) = &self.manifold {
            manifold.go(e.at.q(), &mut e.place, &mut e.coordinates);
        }
        if let Some(stiffness) = &self.drive_stiffness {
            stiffness.multiply(e.at.q(), &mut e.drive_stress);
        }
        let Evaluation { products, coordinates, at, .. } = e;
        if products.is_empty() {
            return;
        }
        let [q, p] = at.groups();
        let z = if self.manifold.is_some() { coordinates.groups() } else { q };
        let width = self.lists();
        if self.locked {
            let both = [z, p];
            self.matrices.multiply_two(simd, both, &self.undeformed, products);
            if self.pairs.len() == 1 {
                let ([s], [pair]) = locked_dots::<S, 1, 1, 2, 3>(simd, products, &self.undeformed, both);
                (e.s_by_momentum.x, e.locked_inertia) = (s, self.inertia);
                e.locked_inertia[(0, 0)] += pair;
            } else {
                let (s, pairs) = locked_dots::<S, 3, 6, 9, 12>(simd, products, &self.undeformed, both);
                (e.s_by_momentum, e.locked_inertia) = (s.into(), self.inertia + symmetric::of_pairs(&pairs));
            }
            return;
        }
        // Without Coriolis terms S is that of the undeformed body.
        let fixed = self.s_count - self.g_count;
        let start = Lists { groups: &self.undeformed, width: self.lists_of_undeformed(), first: fixed };
        self.matrices.multiply(simd, z, start, Places { groups: products, width, first: fixed });
        let first = Lists { groups: &self.undeformed, width: self.lists_of_undeformed(), first: self.s_count };
        e.locked_inertia =
            self.inertia + self.pair_products(simd, self.pair_lists(products), z) + self.pair_products(simd, first, z);
        if let Some(manifold) = &self.manifold {
            for (k, (s, forward)) in e.s.iter_mut().zip(&mut e.forward_s).enumerate() {
                self.s_lists(products).copy(k, e.change.groups_mut());
                s.fill(0.0);
                manifold.add_projection(&e.place, &e.change, s);
                forward.copy_from_slice(s);
                manifold.substitute_forward(&e.place, forward);
            }
        }
        e.locked_inertia -= self.inertia_of_modes(simd, e);
    }

    /// Goes to z of q on a manifold of large modes, where its markers are then.
    pub(crate) fn bend(&self, q: &[f64], e: &mut Evaluation) {
        if let Some(manifold) = &self.manifold {
            manifold.go_to(q, &mut e.place, &mut e.coordinates);
        }
    }

    /// The place on the manifold of large modes.
    pub(crate) fn bent_place<'a>(&'a self, e: &'a Evaluation) -> Option<BentPlace<'a>> {
        let manifold = self.manifold.as_ref()?;
        Some(BentPlace { manifold, point: &e.place, z: &e.coordinates })
    }

    /// SᵀM⁻¹S
    #[inline(always)]
    fn inertia_of_modes<S: Simd>(&self, simd: S, e: &Evaluation) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        if self.manifold.is_some() {
            for (i, a) in e.forward_s.iter().enumerate() {
                for (j, b) in e.forward_s.iter().enumerate().take(i + 1) {
                    symmetric::add(&mut sum, (i, j), dot(a, b));
                }
            }
            return sum;
        }
        match self.s_count {
            0 => {}
            1 => sum[(0, 0)] = own_products::<S, 1>(simd, self.s_lists(&e.products))[0][0],
            _ => {
                let rows = own_products::<S, 3>(simd, self.s_lists(&e.products));
                sum = Matrix3::from_fn(|i, j| rows[i.max(j)][i.min(j)]);
            }
        }
        sum
    }

    /// J(q) where `e` is.
    #[inline(always)]
    pub(crate) fn deformed_inertia<S: Simd>(&self, simd: S, e: &Evaluation) -> Matrix3<f64> {
        e.locked_inertia + self.inertia_of_modes(simd, e)
    }

    /// Copies S where `e` is, a list (nf) for each axis; zeros where it is zero.
    pub(crate) fn copy_coupling(&self, e: &Evaluation, out: &mut [Vec<f64>; 3]) {
        if self.manifold.is_some() {
            out.iter_mut().zip(&e.s).for_each(|(list, s)| list.copy_from_slice(s));
            return;
        }
        for (axis, list) in out.iter_mut().enumerate().take(self.s_count) {
            let values = self.s_lists(&e.products).rows().flat_map(|row| row[axis]);
            list.iter_mut().zip(values).for_each(|(s, value)| *s = value);
        }
    }

    /// (J − SᵀS)⁻¹ x in the axes of rotation.
    #[inline(always)]
    pub(in crate::conservative) fn solve_locked(
        &self,
        e: &Evaluation,
        x: &Vector3<f64>,
    ) -> Result<Vector3<f64>, RateError> {
        if e.products.is_empty() {
            return Ok(self.inverse_inertia * x);
        }
        let solution = symmetric::solve(&e.locked_inertia, x);
        if solution.sum().is_finite() { Ok(solution) } else { Err(RateError::Inertia) }
    }

    /// Sᵀx, with S on z.
    #[inline(always)]
    pub(in crate::conservative) fn s_products<S: Simd>(
        &self,
        simd: S,
        products: &[Group],
        x: &[Group],
    ) -> Vector3<f64> {
        self.axis_products(simd, self.s_lists(products), x)
    }

    /// list_iᵀx in the entry i, of lists for each axis.
    #[inline(always)]
    pub(in crate::conservative) fn axis_products<S: Simd>(
        &self,
        simd: S,
        lists: Lists<'_>,
        x: &[Group],
    ) -> Vector3<f64> {
        match self.s_count {
            0 => Vector3::zeros(),
            1 => Vector3::new(dots::<S, 1>(simd, lists, x)[0], 0.0, 0.0),
            _ => Vector3::from(dots::<S, 3>(simd, lists, x)),
        }
    }

    /// Σ_ij list_ijᵀx in the entries ij and ji, of lists for each pair.
    #[inline(always)]
    pub(in crate::conservative) fn pair_products<S: Simd>(
        &self,
        simd: S,
        lists: Lists<'_>,
        x: &[Group],
    ) -> Matrix3<f64> {
        match self.pairs.len() {
            0 => Matrix3::zeros(),
            1 => Matrix3::from_diagonal(&Vector3::new(dots::<S, 1>(simd, lists, x)[0], 0.0, 0.0)),
            _ => symmetric::of_pairs(&dots::<S, 6>(simd, lists, x)),
        }
    }
}
