//! Accelerations of the conservative form.
//!
//! ```text
//! p = Dᵀμ,  μ = ν + S_ext ω + b v:      Dᵀμ' = p' − Ḋᵀμ
//! μ' = D q̈ + Ḋ q̇ + S_ext' ω + b' v + b v' + S_ext ω',      S_ext' = G ν
//! q̈ = M⁻¹ [p' − Ḋᵀμ − Dᵀ(Ḋ q̇ + S_ext' ω + b' v + b v')] − M⁻¹ S ω'
//! π = J ω + S_extᵀν:      (J − SᵀM⁻¹S) ω' = π' − J' ω − S_ext'ᵀν − S_extᵀ(ν' at ω' = 0)
//! ```
//!
//! D is 1, and Ḋ is zero, but on a manifold. Of what is driven v or ω is given.
//!
//! For a locked body, the rate of `𝕁 ω = π − Sᵀp` gives ω' from what its forces were found with. The G_i are skew:
//!
//! ```text
//! 𝕁 ω' = π' − 𝕁' ω + (G_i p)·q̇ − Sᵀp',      𝕁' = 2 (c_ij + N̂_ij q)·q̇
//! ```

use nalgebra::{Matrix3, Vector3};
use pulp::Simd;

use crate::conservative::body::{ConservativeBody, Translation};
use crate::conservative::rates::evaluation::Evaluation;
use crate::conservative::state::{get, part};
use crate::error::RateError;
use crate::matrix::lists::dot;
use crate::matrix::side_by_side::{Lists, add_combined, combine};

impl ConservativeBody {
    /// Turns `e.acceleration` from the whole of p' into the q̈ that there would be without ω'.
    #[inline(always)]
    fn without_spin_rate<S: Simd>(&self, simd: S, driven_acceleration: f64, e: &mut Evaluation) {
        let factors = -e.spin;
        let (coupling_rate, change) = self.coupling_rate(simd, e);
        // Ḋ q̇ + S_ext' ω + b' v + b v', by −; then μ.
        combine(simd, coupling_rate, &factors.as_slice()[..self.g_count], change.groups_mut());
        change.iter_mut().zip(&self.sliding).for_each(|(c, b)| *c -= b * driven_acceleration);
        let Some(manifold) = &self.manifold else {
            e.acceleration.iter_mut().zip(&*e.change).for_each(|(a, c)| *a += *c);
            return;
        };
        let change = &mut e.change;
        e.curvature.fill(0.0);
        manifold.add_curvature(&e.place, &mut e.curvature);
        manifold.subtract_mass_of_products(&e.curvature, change);
        manifold.add_projection(&e.place, change, &mut e.acceleration);
        let negative = &mut change[e.modal_velocity.len()..];
        negative.iter_mut().zip(&e.momenta_of_products).for_each(|(negative, mu)| *negative = -mu);
        manifold.add_projected_rate(&e.place, negative, &mut e.acceleration);
        manifold.solve(&e.place, &mut e.acceleration);
    }

    /// Turns `e.acceleration` from the whole of p' into q̈, and gives the rate of the spin. `e` has the rates of the state.
    #[inline(always)]
    pub(in crate::conservative) fn accelerate<S: Simd>(
        &self,
        simd: S,
        driven_acceleration: f64,
        e: &mut Evaluation,
    ) -> Result<Vector3<f64>, RateError> {
        let locked_spin_rate = match self.locked {
            true => Some(self.locked_spin_rate(simd, e)?),
            false => None,
        };
        self.without_spin_rate(simd, driven_acceleration, e);
        let spin_rate = if let Some(spin_rate) = locked_spin_rate {
            spin_rate
        } else if self.turn_driven {
            Vector3::new(driven_acceleration, 0.0, 0.0)
        } else if self.axes.is_empty() {
            Vector3::zeros()
        } else {
            let mut right = get(e.rates.slow(), part::PI) - self.inertia_rate(simd, e) * e.spin;
            if self.manifold.is_some() {
                for (i, s) in e.s.iter().enumerate() {
                    right[i] -= dot(s, &e.acceleration);
                }
                right -= self.s_products(simd, &e.products, e.curvature.groups());
            } else {
                right -= self.s_products(simd, &e.products, e.acceleration.groups());
            }
            self.solve_locked(e, &right)?
        };
        self.add_spin_rate(simd, &spin_rate, e);
        Ok(spin_rate)
    }

    /// ω' of a locked body, with the whole of p' in `e.acceleration`.
    #[inline(always)]
    fn locked_spin_rate<S: Simd>(&self, simd: S, e: &Evaluation) -> Result<Vector3<f64>, RateError> {
        let of_momenta = Lists { first: self.lists() - self.g_count, ..self.s_lists(&e.products) };
        let right = get(e.rates.slow(), part::PI) - self.inertia_rate(simd, e) * e.spin
            + self.axis_products(simd, of_momenta, e.modal_velocity.groups())
            - self.s_products(simd, &e.products, e.acceleration.groups());
        self.solve_locked(e, &right)
    }

    /// J' = 2 (c_ij + N_ij z)·ż, or 𝕁' of a locked body.
    #[inline(always)]
    fn inertia_rate<S: Simd>(&self, simd: S, e: &Evaluation) -> Matrix3<f64> {
        let rate = self.velocity_of_coordinates(e).groups();
        self.pair_products(simd, self.pair_lists(&e.products), rate) * 2.0
    }

    /// q̈ −= M⁻¹ S ω'
    #[inline(always)]
    fn add_spin_rate<S: Simd>(&self, simd: S, spin_rate: &Vector3<f64>, e: &mut Evaluation) {
        let factors = -spin_rate;
        let Some(manifold) = &self.manifold else {
            let factors = &factors.as_slice()[..self.s_count];
            add_combined(simd, self.s_lists(&e.products), factors, e.acceleration.groups_mut());
            return;
        };
        let solved = &mut e.change[..self.flexible()];
        solved.fill(0.0);
        for (s, factor) in e.forward_s.iter().zip(&factors) {
            solved.iter_mut().zip(&**s).for_each(|(solved, s)| *solved += factor * s);
        }
        manifold.substitute_back(&e.place, solved);
        e.acceleration.iter_mut().zip(solved).for_each(|(a, solved)| *a += *solved);
    }

    /// Puts z̈ of q̈ into `e.change`.
    pub(in crate::conservative) fn extend_acceleration(&self, e: &mut Evaluation) {
        match &self.manifold {
            Some(manifold) => {
                manifold.extend(&e.place, &e.acceleration, &mut e.change);
                e.change.iter_mut().zip(&*e.curvature).for_each(|(a, curvature)| *a += curvature);
            }
            None => e.change.copy_from_slice(&e.acceleration),
        }
    }

    /// Finds the torque π' − M or the force P' − F of what drives the body: with π = J ω + S·ν and P = m v + b·ν along the
    /// driven axis, both less (K q)·q̇. `e` has all other rates, its momentum without the linear part.
    #[inline(always)]
    pub(in crate::conservative) fn drive_effort<S: Simd>(
        &self,
        simd: S,
        acceleration: f64,
        force_body: &Vector3<f64>,
        moment: f64,
        e: &mut Evaluation,
    ) {
        let speed = e.driven_speed;
        for (k, rate) in e.acceleration.iter_mut().enumerate() {
            *rate = e.rates.p()[k] + self.linear_rate(k, e.at.q()[k], e.at.p()[k]);
        }
        self.without_spin_rate(simd, acceleration, e);
        if self.turn_driven {
            self.add_spin_rate(simd, &Vector3::new(acceleration, 0.0, 0.0), e);
        }
        self.extend_acceleration(e);
        // (K q)·q̇ and its rate.
        let stressed = dot(&e.drive_stress, &e.modal_velocity);
        let of_rates = self.drive_stiffness.as_ref().map_or(0.0, |stiffness| stiffness.quadratic(&e.modal_velocity));
        let mut changing = -dot(&e.drive_stress, &e.acceleration) - of_rates;
        if let Translation::Driven(direction) = self.translation {
            e.driven_momentum = self.mass * speed + dot(&self.sliding, self.velocity_of_coordinates(e)) - stressed;
            changing += dot(&self.sliding, &e.change);
            e.drive_effort = self.mass * acceleration + changing - direction.dot(force_body);
            return;
        }
        let (inertia, inertia_rate) = (self.deformed_inertia(simd, e)[(0, 0)], self.inertia_rate(simd, e)[(0, 0)]);
        // G ν does no work on ν.
        changing += self.s_products(simd, &e.products, e.change.groups())[0];
        let velocity = self.velocity_of_coordinates(e).groups();
        e.driven_momentum = inertia * speed + self.s_products(simd, &e.products, velocity)[0] - stressed;
        e.drive_effort = inertia_rate * speed + inertia * acceleration + changing - moment;
    }
}
