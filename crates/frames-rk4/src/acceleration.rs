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

use nalgebra::{Matrix3, Vector3};

use crate::column_major::{add_product, dot, multiply};
use crate::conservative::{ConservativeBody, Evaluation, Translation, get, part};
use crate::error::RateError;
use crate::symmetric;

impl ConservativeBody {
    /// Turns `e.acceleration` from the whole of p' into the q̈ that there would be without ω'.
    fn without_spin_rate(&self, driven_acceleration: f64, e: &mut Evaluation) {
        let nf = self.coordinates();
        let spin = e.spin;
        let (coupling_rate, change) = self.coupling_rate(e);
        // Ḋ q̇ + S_ext' ω + b' v + b v', by −; then μ.
        change.fill(0.0);
        for (g, w) in coupling_rate.chunks_exact(nf.max(1)).zip(spin.iter()) {
            change.iter_mut().zip(g).for_each(|(c, g)| *c -= g * w);
        }
        change.iter_mut().zip(&self.sliding).for_each(|(c, b)| *c -= b * driven_acceleration);
        let Some(manifold) = &self.manifold else {
            e.acceleration.iter_mut().zip(&e.change).for_each(|(a, c)| *a += *c);
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
    pub(crate) fn accelerate(&self, driven_acceleration: f64, e: &mut Evaluation) -> Result<Vector3<f64>, RateError> {
        let (modes, nf) = (self.flexible(), self.coordinates());
        self.without_spin_rate(driven_acceleration, e);
        let spin_rate = if self.turn_driven {
            Vector3::new(driven_acceleration, 0.0, 0.0)
        } else if self.axes.is_empty() {
            Vector3::zeros()
        } else {
            let mut right = get(&e.slow, part::PI) - self.inertia_rate(e) * e.spin;
            for (i, s) in self.s(e).chunks_exact(modes.max(1)).enumerate() {
                right[i] -= dot(s, &e.acceleration);
            }
            for (i, s) in e.products[..self.s_rows].chunks_exact(nf.max(1)).enumerate() {
                right[i] -= dot(s, &e.curvature);
            }
            self.solve_locked(e, &right)?
        };
        self.add_spin_rate(&spin_rate, e);
        Ok(spin_rate)
    }

    /// J' = 2 (c_ij + N_ij z)·ż, and of a locked body S'ᵀS + SᵀS' besides, which its N_ij have not got. S' is in `e`.
    fn inertia_rate(&self, e: &Evaluation) -> Matrix3<f64> {
        let n_z = e.products[self.s_rows..].chunks_exact(self.coordinates().max(1));
        let mut inertia_rate = Matrix3::zeros();
        for (pair, n_z) in self.pairs.iter().zip(n_z) {
            symmetric::add(&mut inertia_rate, *pair, 2.0 * dot(n_z, &e.velocity));
        }
        let modes = self.flexible().max(1);
        for (i, rate) in e.coupling_rate.chunks_exact(modes).enumerate() {
            for (j, s) in self.s(e).chunks_exact(modes).enumerate() {
                let both = dot(rate, s);
                inertia_rate[(i, j)] += both;
                inertia_rate[(j, i)] += both;
            }
        }
        inertia_rate
    }

    /// q̈ −= M⁻¹ S ω'
    fn add_spin_rate(&self, spin_rate: &Vector3<f64>, e: &mut Evaluation) {
        let modes = self.flexible();
        let Some(manifold) = &self.manifold else {
            add_product(&e.products[..self.s_rows], modes, (-spin_rate).as_slice(), &mut e.acceleration);
            return;
        };
        let solved = &mut e.change[..modes];
        multiply(&e.forward_s, modes, spin_rate.as_slice(), solved);
        manifold.substitute_back(&e.place, solved);
        e.acceleration.iter_mut().zip(solved).for_each(|(a, solved)| *a -= *solved);
    }

    /// Puts z̈ of q̈ into `e.change`.
    pub(crate) fn extend_acceleration(&self, e: &mut Evaluation) {
        match &self.manifold {
            Some(manifold) => {
                manifold.extend(&e.place, &e.acceleration, &mut e.change);
                e.change.iter_mut().zip(&e.curvature).for_each(|(a, curvature)| *a += curvature);
            }
            None => e.change.copy_from_slice(&e.acceleration),
        }
    }

    /// Finds the torque π' − M or the force P' − F of what drives the body: with π = J ω + S·ν and P = m v + b·ν along the
    /// driven axis, both less (K q)·q̇. `e` has all other rates, its momentum without the linear part at q and p.
    pub(crate) fn drive_effort(
        &self,
        acceleration: f64,
        [q, p]: [&[f64]; 2],
        force_body: &Vector3<f64>,
        moment: f64,
        e: &mut Evaluation,
    ) {
        let (speed, nf) = (e.driven_speed, self.coordinates());
        for (k, rate) in e.acceleration.iter_mut().enumerate() {
            *rate = e.momentum[k] + self.linear_rate(k, q[k], p[k]);
        }
        self.without_spin_rate(acceleration, e);
        if self.turn_driven {
            self.add_spin_rate(&Vector3::new(acceleration, 0.0, 0.0), e);
        }
        self.extend_acceleration(e);
        // (K q)·q̇ and its rate.
        let stressed = dot(&e.drive_stress, &e.modal_velocity);
        let mut changing = -dot(&e.drive_stress, &e.acceleration) - self.drive_stress_power(&e.modal_velocity);
        if let Translation::Driven(direction) = self.translation {
            e.driven_momentum = self.mass * speed + dot(&self.sliding, &e.velocity) - stressed;
            changing += dot(&self.sliding, &e.change);
            e.drive_effort = self.mass * acceleration + changing - direction.dot(force_body);
            return;
        }
        let s = &e.products[..nf];
        let (inertia, inertia_rate) = (self.deformed_inertia(e)[(0, 0)], self.inertia_rate(e)[(0, 0)]);
        // G ν does no work on ν.
        changing += dot(s, &e.change);
        e.driven_momentum = inertia * speed + dot(s, &e.velocity) - stressed;
        e.drive_effort = inertia_rate * speed + inertia * acceleration + changing - moment;
    }

    /// q̇ᵀK q̇
    fn drive_stress_power(&self, velocity: &[f64]) -> f64 {
        let columns = self.drive_stiffness.chunks_exact(velocity.len().max(1));
        columns.zip(velocity).map(|(column, v)| v * dot(column, velocity)).sum()
    }
}
