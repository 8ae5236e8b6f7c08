//! The velocities of the modes, and what damping takes.

use pulp::Simd;

use crate::conservative::body::ConservativeBody;
use crate::conservative::rates::evaluation::Evaluation;
use crate::matrix::four::{Four, WIDTH};
use crate::matrix::side_by_side::combine;

impl ConservativeBody {
    /// On a manifold, puts L⁻¹ (p − b v) into the place of q̇.
    #[inline(always)]
    pub(in crate::conservative) fn start_velocities(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        e.modal_velocity.copy_from_slice(e.at.p());
        if !self.sliding.is_empty() {
            e.modal_sliding.fill(0.0);
            manifold.add_projection(&e.place, &self.sliding, &mut e.modal_sliding);
            e.modal_velocity.iter_mut().zip(&e.modal_sliding).for_each(|(v, b)| *v -= b * speed);
        }
        manifold.substitute_forward(&e.place, &mut e.modal_velocity);
    }

    /// q̇ and ż, at the spin of `e`; starts p' with what damping takes beside −D p, which is in the linear part. Returns the
    /// dissipation.
    #[inline(always)]
    pub(in crate::conservative) fn find_velocities<S: Simd>(&self, simd: S, speed: f64, e: &mut Evaluation) -> f64 {
        let Some(manifold) = &self.manifold else {
            if self.sliding.is_empty() {
                return match self.s_count {
                    0 => self.find_modal_velocities::<S, 0>(simd, e),
                    1 => self.find_modal_velocities::<S, 1>(simd, e),
                    _ => self.find_modal_velocities::<S, 3>(simd, e),
                };
            }
            let factors = -e.spin;
            let [displacement, _] = e.rates.groups_mut();
            combine(simd, self.s_lists(&e.products), &factors.as_slice()[..self.s_count], displacement);
            let [displacement, _] = e.rates.modes_mut();
            displacement.iter_mut().zip(&self.sliding).for_each(|(rate, b)| *rate -= b * speed);
            let ([_, p], [displacement, _]) = (e.at.groups(), e.rates.groups());
            for ((v, p), rate) in e.modal_velocity.groups_mut().iter_mut().zip(p).zip(displacement) {
                Four::load(simd, p).add(simd, Four::load(simd, rate)).store(v);
            }
            return self.damp(simd, e);
        };
        let w = e.spin;
        for (s, w) in e.forward_s.iter().zip(w.iter()) {
            let factor = Four::splat(simd, -w);
            for (v, s) in e.modal_velocity.groups_mut().iter_mut().zip(s.groups()) {
                Four::load(simd, s).mul_add(simd, factor, Four::load(simd, v)).store(v);
            }
        }
        manifold.substitute_back(&e.place, &mut e.modal_velocity);
        let ([_, p], [displacement, _]) = (e.at.groups(), e.rates.groups_mut());
        for ((rate, p), v) in displacement.iter_mut().zip(p).zip(e.modal_velocity.groups()) {
            Four::load(simd, v).sub(simd, Four::load(simd, p)).store(rate);
        }
        manifold.go_along(&e.modal_velocity, &mut e.place, &mut e.velocity);
        self.damp(simd, e)
    }

    /// q̇ with M lists of S, and as much of p' as [`Self::damp`] finds.
    #[inline(always)]
    fn find_modal_velocities<S: Simd, const M: usize>(&self, simd: S, e: &mut Evaluation) -> f64 {
        let (zero, mut dissipation, mut factors) =
            (Four::splat(simd, 0.0), Four::splat(simd, 0.0), [Four::splat(simd, 0.0); M]);
        for (factor, w) in factors.iter_mut().zip(e.spin.iter()) {
            *factor = Four::splat(simd, -w);
        }
        let Evaluation { products, at, rates, modal_velocity, .. } = e;
        let mut lists = self.s_lists(products).rows();
        let ([_, p], [displacement, momentum]) = (at.groups(), rates.groups_mut());
        let rates = displacement.iter_mut().zip(modal_velocity.groups_mut());
        let given = p.iter().zip(self.damping.groups());
        for (((rate, v), momentum), (p, damping)) in rates.zip(momentum).zip(given) {
            let mut sum = zero;
            if let Some(row) = lists.next().and_then(|row| row.first_chunk::<M>()) {
                for k in 0..M {
                    sum = Four::load(simd, &row[k]).mul_add(simd, factors[k], sum);
                }
            }
            let (velocity, damping) = (Four::load(simd, p).add(simd, sum), Four::load(simd, damping));
            sum.store(rate);
            velocity.store(v);
            zero.sub(simd, damping.mul(simd, sum)).store(momentum);
            dissipation = damping.mul(simd, velocity).mul_add(simd, velocity, dissipation);
        }
        dissipation.sum()
    }

    /// p' = −D (q̇ − p): the rest of −D q̇ is in the linear part. Returns q̇ᵀD q̇.
    #[inline(always)]
    fn damp<S: Simd>(&self, simd: S, e: &mut Evaluation) -> f64 {
        let Evaluation { rates, modal_velocity, .. } = e;
        let [displacement, momentum] = rates.groups_mut();
        if !self.damped {
            momentum.fill([0.0; WIDTH]);
            return 0.0;
        }
        let (zero, mut dissipation) = (Four::splat(simd, 0.0), Four::splat(simd, 0.0));
        let rates = displacement.iter().zip(modal_velocity.groups());
        for ((momentum, (rate, v)), damping) in momentum.iter_mut().zip(rates).zip(self.damping.groups()) {
            let [damping, v] = [damping, v].map(|group| Four::load(simd, group));
            let of_rate = damping.mul(simd, Four::load(simd, rate));
            zero.sub(simd, of_rate).store(momentum);
            dissipation = damping.mul(simd, v).mul_add(simd, v, dissipation);
        }
        dissipation.sum()
    }
}
