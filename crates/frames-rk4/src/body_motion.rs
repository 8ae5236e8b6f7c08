//! The motion of the body at a state, as a whole and of its points.

use dynamics::faer::Mat;
use dynamics::nalgebra::{Matrix3, Vector3};
use dynamics::reduced_body::{ReducedBody, RigidMotion};
use dynamics::rigid_kin::{Attitude, Inertia, InertiaError, euler_angular_acceleration};
use dynamics::{
    CenterOfMass, Energies, Initial, MotionState, Observation, PointMotion, PointShapes, SetupError, StepError, Work,
};

use crate::attitude_account::AttitudeAccount;
use crate::cross_products::{cross_products, multiply};
use crate::state::{State, rotation, translation};

/// Reads the motion of a body off its states.
#[derive(Debug, Clone)]
pub struct BodyMotion {
    motion: RigidMotion,
    mass: f64,
    /// The origin at the beginning, global components.
    origin: Vector3<f64>,
    /// Attitude of the body frame at the beginning.
    initial_attitude: Attitude,
    center: CenterOfMass,
    inertia: Inertia,
    translation_basis: Matrix3<f64>,
    rotation_basis: Matrix3<f64>,
    /// G_i = Ψᵀ M (I⊗[e_i×]) Ψ (6+nf square).
    cross_products: [Mat<f64>; 3],
    stiffness: Vec<f64>,
}

impl BodyMotion {
    /// Prepares the constants.
    ///
    /// # Errors
    /// An inertia that no rigid body has.
    pub fn new(body: &ReducedBody) -> Result<Self, InertiaError> {
        Ok(Self {
            motion: body.motion,
            mass: body.mass,
            origin: body.origin,
            initial_attitude: Attitude::identity(),
            center: CenterOfMass::new(body),
            inertia: Inertia::new(body.inertia)?,
            translation_basis: body.translation_basis,
            rotation_basis: body.rotation_basis,
            cross_products: cross_products(body),
            stiffness: body.circular_frequencies.iter().map(|omega| omega * omega).collect(),
        })
    }

    /// Begins in the attitude and at the position of a motion: displacements of points are counted from there.
    #[must_use]
    pub fn beginning_at(self, initial: &Initial) -> Self {
        let origin = initial.origin.unwrap_or(self.origin);
        Self { initial_attitude: initial.attitude, origin, ..self }
    }

    /// Displacement or velocity of the origin: `T y[..3]`.
    pub(crate) fn of_origin(&self, modal: &[f64]) -> Vector3<f64> {
        self.translation_basis * translation(modal)
    }

    /// Angular rate of the rotation modes: `B y[3..6]`.
    pub(crate) fn angular_rate(&self, rotation: &Vector3<f64>) -> Vector3<f64> {
        self.rotation_basis * rotation
    }

    /// Fills `out` with the motion at a state, and that of `points`.
    pub(crate) fn observe(&self, state: &State, work: &Work, points: &[PointShapes], out: &mut Observation) {
        out.time = state.time;
        out.attitude = state.attitude;
        out.origin_global = state.origin_global + state.attitude.to_global(&self.of_origin(&state.modal_displacement));
        out.position_global = self.position_global(state);
        out.velocity_global = self.velocity_global(state);
        out.omega_body = state.omega_body;
        out.alpha_body = state.alpha_body;
        for (list, all) in [
            (&mut out.modal_displacement, &state.modal_displacement),
            (&mut out.modal_velocity, &state.modal_velocity),
            (&mut out.modal_acceleration, &state.modal_acceleration),
        ] {
            list.clear();
            list.extend_from_slice(&all[6..]);
        }
        out.kinetic_energy = self.kinetic_energy(state);
        out.strain_energy = self.strain_energy(state);
        self.observe_momenta(state, work, out);
        out.points.clear();
        out.points.extend(points.iter().map(|point| self.point(state, point)));
    }

    /// Momenta and what has been done to them. What holds a body gives it whatever its momenta need, so there only the
    /// rotations that it has left are balanced.
    fn observe_momenta(&self, state: &State, work: &Work, out: &mut Observation) {
        out.work = *work;
        out.linear_momentum_global = self.linear_momentum_global(state);
        out.angular_momentum_global = self.angular_momentum_global(state);
        if !self.motion.is_free() {
            out.work.impulse_global = out.linear_momentum_global;
        }
        if self.motion.rotations().len() == 3 {
            return;
        }
        // An axis is the same in body and global axes but for the attitude at the beginning.
        let to_global = self.initial_attitude.global_to_body().transpose();
        let left = to_global * self.motion.rotation_projector() * to_global.transpose();
        out.angular_momentum_global = left * out.angular_momentum_global;
        out.work.angular_impulse_global = left * out.work.angular_impulse_global;
    }

    /// A state in quantities that every formulation has. The small rotation that a state's rigid coordinates may hold
    /// beside its attitude is not among them.
    ///
    /// The modal velocities of the state are those of an inertial frame, y = y_rigid + G(ω) q + q̇. With ω = B z,
    /// `y_rotation = z + (G(B z) q)_rotation` gives z.
    pub(crate) fn state(&self, state: &State) -> MotionState {
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        let size = q.len();
        // [e_i×]: G_i q of all modes.
        let turned: [Vec<f64>; 3] = std::array::from_fn(|i| {
            let mut product = vec![0.0; size];
            multiply(&self.cross_products[i], q, &mut product);
            product
        });
        let of_spin = |omega: &Vector3<f64>, k: usize| (0..3).map(|i| omega[i] * turned[i][k]).sum::<f64>();
        let coupled = Matrix3::from_fn(|row, k| {
            f64::from(u8::from(row == k)) + of_spin(&self.rotation_basis.column(k).into(), 3 + row)
        });
        let z = coupled.lu().solve(&rotation(y)).unwrap_or_else(|| rotation(y));
        let omega_body = self.angular_rate(&z);
        let translating = Vector3::from_fn(|k, _| y[k] - of_spin(&omega_body, k));
        MotionState {
            time: state.time,
            attitude: state.attitude,
            origin_global: state.origin_global + state.attitude.to_global(&self.of_origin(q)),
            velocity_global: state.attitude.to_global(&(self.translation_basis * translating)),
            omega_body,
            modal_displacement: q[6..].to_vec(),
            modal_velocity: (6..size).map(|k| y[k] - of_spin(&omega_body, k)).collect(),
        }
    }

    /// Puts `state` to another motion; its accelerations are left to be found.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub(crate) fn set_state(&self, to: &MotionState, state: &mut State) -> Result<(), SetupError> {
        to.check(state.modal_displacement.len() - 6)?;
        // T⁻¹ = m Tᵀ and B⁻¹ = Bᵀ J₀, since T Tᵀ = I/m and B Bᵀ = J₀⁻¹.
        let z = self.rotation_basis.tr_mul(&(self.inertia.matrix() * to.omega_body));
        let translating = self.translation_basis.tr_mul(&to.attitude.to_body(&to.velocity_global)) * self.mass;
        let omega_body = self.angular_rate(&z);
        (state.time, state.attitude, state.origin_global) = (to.time, to.attitude, to.origin_global);
        state.modal_displacement[..6].fill(0.0);
        state.modal_displacement[6..].copy_from_slice(&to.modal_displacement);
        let size = state.modal_displacement.len();
        let mut turned = vec![0.0; size];
        let y = &mut state.modal_velocity;
        for (k, y) in y.iter_mut().enumerate() {
            *y = if k < 3 {
                translating[k]
            } else if k < 6 {
                z[k - 3]
            } else {
                to.modal_velocity[k - 6]
            };
        }
        for (i, products) in self.cross_products.iter().enumerate() {
            multiply(products, &state.modal_displacement, &mut turned);
            y.iter_mut().zip(&turned).for_each(|(y, turned)| *y += omega_body[i] * turned);
        }
        Ok(())
    }

    /// Position of the centre of mass, global components.
    pub fn position_global(&self, state: &State) -> Vector3<f64> {
        let q = &state.modal_displacement;
        state.origin_global + state.attitude.to_global(&(self.of_origin(q) + self.center.position_body(&q[6..])))
    }

    /// Velocity of the centre of mass, global components.
    pub fn velocity_global(&self, state: &State) -> Vector3<f64> {
        let y = &state.modal_velocity;
        let turning = self.angular_rate(&rotation(y)).cross(&self.center.undeformed_body);
        state.attitude.to_global(&(self.of_origin(y) + turning + self.center.deformation(&y[6..])))
    }

    /// Angular acceleration by Euler's equation, `α_modal − J₀⁻¹(ω×J₀ω)`, body components. It is right for any body,
    /// where h of Eq. (37) is so for plane motion about one of e1, e3, e3×e1 of its points, and nearly so for long thin
    /// plates.
    pub fn euler_alpha_body(&self, state: &State) -> Vector3<f64> {
        let alpha_modal = self.rotation_basis * rotation(&state.modal_acceleration);
        euler_angular_acceleration(&alpha_modal, &self.inertia, &state.omega_body)
    }

    /// Energies of a state.
    pub(crate) fn energies_of(&self, state: &State, work: &Work) -> Energies {
        let translation = 0.5 * translation(&state.modal_velocity).norm_squared();
        let others = 0.5 * state.modal_velocity[3..].iter().map(|y| y * y).sum::<f64>();
        Energies {
            time: state.time,
            internal: others + self.strain_energy(state),
            translation,
            work: work.work,
            dissipation: work.dissipation,
        }
    }

    /// Checks the angular momentum that the loads have not put in: less their impulse.
    ///
    /// # Errors
    /// [`StepError::Attitude`].
    pub(crate) fn check_attitude(
        &self,
        state: &State,
        work: &Work,
        account: &mut AttitudeAccount,
        step: f64,
    ) -> Result<(), StepError> {
        let balance_global = self.angular_momentum_global(state) - work.angular_impulse_global;
        account.check(state.time, balance_global, |momentum| self.spin_of(state, momentum), step)
    }

    /// The spin of the undeformed body, in the motions that it has, with this angular momentum: B Bᵀ H in body axes.
    /// Both in global components.
    fn spin_of(&self, state: &State, angular_momentum_global: &Vector3<f64>) -> Vector3<f64> {
        let basis = &self.rotation_basis;
        state.attitude.to_global(&(basis * basis.tr_mul(&state.attitude.to_body(angular_momentum_global))))
    }

    /// Kinetic energy ½ q̇ᵀ q̇ (the modes are mass-normalised).
    pub fn kinetic_energy(&self, state: &State) -> f64 {
        0.5 * state.modal_velocity.iter().map(|y| y * y).sum::<f64>()
    }

    /// Strain energy ½ qᵀ Λ q.
    pub fn strain_energy(&self, state: &State) -> f64 {
        let flexible = &state.modal_displacement[6..];
        0.5 * flexible.iter().zip(&self.stiffness).map(|(q, lambda)| lambda * q * q).sum::<f64>()
    }

    /// Linear momentum, global components.
    pub fn linear_momentum_global(&self, state: &State) -> Vector3<f64> {
        self.velocity_global(state) * self.mass
    }

    /// Angular momentum about the centre of mass, or the fixed point of a body that is held, global components:
    /// `∫ρ (X + u)×v dV` less that of the centre.
    pub fn angular_momentum_global(&self, state: &State) -> Vector3<f64> {
        let (q, y) = (&state.modal_displacement, &state.modal_velocity);
        // ∫ρ X×v: the rotation modes are B_ik [e_i×]X, so Bᵀ H = y[3..6].
        let undeformed = self.inertia.matrix() * self.rotation_basis * rotation(y);
        let deformed = Vector3::from_fn(|i, _| {
            let columns = self.cross_products[i].col_iter().zip(y);
            -columns.map(|(column, y)| y * column.iter().zip(q).map(|(g, q)| g * q).sum::<f64>()).sum::<f64>()
        });
        let of_center = self.of_origin(q).cross(&self.of_origin(y)) * self.mass;
        state.attitude.to_global(&(undeformed + deformed - of_center))
    }

    /// Motion of a point.
    pub fn point(&self, state: &State, point: &PointShapes) -> PointMotion {
        let global = |v_body: Vector3<f64>| state.attitude.to_global(&v_body);
        let x = point.position_body();
        let (omega, alpha) = (state.omega_body, state.alpha_body);
        let of_origin = self.of_origin(&state.modal_acceleration);
        let elastic = point.deformation(&state.modal_displacement[6..]);
        PointMotion {
            elastic_displacement_body: elastic,
            elastic_displacement_global: global(elastic),
            displacement: (state.origin_global - self.origin)
                + (global(x + point.expand(&state.modal_displacement)) - self.initial_attitude.to_global(&x)),
            velocity: global(point.expand(&state.modal_velocity)),
            acceleration: global(point.expand(&state.modal_acceleration)),
            rigid_acceleration: global(of_origin + alpha.cross(&x) + omega.cross(&omega.cross(&x))),
        }
    }
}
