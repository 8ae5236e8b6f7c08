//! The conservative form: a free body in its mean-axis frame, with momenta for its state.
//!
//! ```text
//! x = r + Aᵀ (X + Ψ_f q)
//! J(q)_ij = J0_ij + 2 c_ij·q + qᵀ N_ij q          S(q) = [G_1 q, G_2 q, G_3 q]
//! ω = (J − SᵀS)⁻¹ (π − Sᵀp),      q̇ = p − S ω
//! π' = π × ω + Σ (X_k + u_k) × F_k(body),         P' = Σ F (global),   r' = P/m
//! p' = −Λq − D q̇ + Ψ_fᵀF + Σ_ij ω_i ω_j (c_ij + N_ij q) − Σ_i ω_i G_i q̇
//! energy = P²/2m + ½ π·ω + ½ p·q̇ + ½ q·Λq
//! ```
//!
//! Hamiltonian without damping and loads: energy and `Aᵀπ` are constants of the motion for any number of modes.
//! The part of q' and p' that is linear in the modes, `q' = p, p' = −Λq − Dp`, is left to the integrators.

use modal::ReducedBody;
use nalgebra::{Matrix3, SVector, Vector3};
use rigid_kin::{Attitude, f_inverse, transformation_matrix};

use crate::error::{RateError, SetupError};
use crate::initial::Initial;
use crate::load::DeadForce;
use crate::motion::{PointMotion, PointShapes};
use crate::observation::Observation;
use crate::work::Work;

/// ij of c_ij and N_ij.
const PAIRS: [(usize, usize); 6] = ReducedBody::PAIRS;

/// What moves slowly, beside the modes: see [`part`].
pub(crate) type Slow = SVector<f64, 20>;

/// First entries of the parts of [`Slow`].
pub(crate) mod part {
    /// Rotation vector since the start of the step, body axes.
    pub const THETA: usize = 0;
    /// Position of the centre of mass, global.
    pub const POSITION: usize = 3;
    /// Linear momentum P, global.
    pub const MOMENTUM: usize = 6;
    /// Angular momentum π about the centre of mass, body axes.
    pub const PI: usize = 9;
    /// Work of the loads.
    pub const WORK: usize = 12;
    /// Energy that damping has taken.
    pub const DISSIPATION: usize = 13;
    /// Angular impulse of the loads about the centre of mass, global.
    pub const ANGULAR_IMPULSE: usize = 14;
    /// Impulse of the loads, global.
    pub const IMPULSE: usize = 17;
}

pub(crate) fn get(slow: &Slow, first: usize) -> Vector3<f64> {
    slow.fixed_rows::<3>(first).into()
}

fn set(slow: &mut Slow, first: usize, value: &Vector3<f64>) {
    slow.fixed_rows_mut::<3>(first).copy_from(value);
}

/// A free body with its loads in the conservative form.
#[derive(Debug, Clone)]
pub struct ConservativeBody {
    mass: f64,
    center_of_mass: Vector3<f64>,
    inertia: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    /// ω_k of the flexible modes.
    pub(crate) circular_frequencies: Vec<f64>,
    pub(crate) damping_ratios: Vec<f64>,
    /// 2 ζ_k ω_k.
    damping: Vec<f64>,
    damped: bool,
    /// c_ij (6 × nf).
    first: [Vec<f64>; 6],
    /// Column by column, G_1 G_2 G_3 N_11 … N_12 one below another (9 nf × nf).
    stacked: Vec<f64>,
    loads: Vec<DeadForce>,
}

/// State at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct ConservativeState {
    /// Time.
    pub time: f64,
    /// Attitude of the mean-axis frame.
    pub attitude: Attitude,
    pub(crate) slow: Slow,
    /// Modal displacements q (nf).
    pub modal_displacement: Vec<f64>,
    /// Modal momenta p = q̇ + S ω (nf).
    pub modal_momentum: Vec<f64>,
}

impl ConservativeState {
    /// Takes over another state of the same body, without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.attitude = other.attitude;
        self.slow = other.slow;
        self.modal_displacement.copy_from_slice(&other.modal_displacement);
        self.modal_momentum.copy_from_slice(&other.modal_momentum);
    }
}

/// Rates without the linear part of the modes, and what was found on the way to them.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    pub slow: Slow,
    /// q' − p = −S ω (nf).
    pub displacement: Vec<f64>,
    /// p' + Λq + D p (nf).
    pub momentum: Vec<f64>,
    /// G_i q and N_ij q (9 nf).
    products: Vec<f64>,
    /// G_i q̇ (3 nf).
    gyroscopic: Vec<f64>,
    /// q̇ (nf).
    velocity: Vec<f64>,
    pub omega_body: Vector3<f64>,
    /// J(q) and J − SᵀS.
    inertia: Matrix3<f64>,
    locked_inertia: Matrix3<f64>,
}

impl Evaluation {
    pub(crate) fn new(flexible: usize) -> Self {
        let zeros = |n: usize| vec![0.0; n];
        Self {
            slow: Slow::zeros(),
            displacement: zeros(flexible),
            momentum: zeros(flexible),
            products: zeros(9 * flexible),
            gyroscopic: zeros(3 * flexible),
            velocity: zeros(flexible),
            omega_body: Vector3::zeros(),
            inertia: Matrix3::zeros(),
            locked_inertia: Matrix3::zeros(),
        }
    }
}

impl ConservativeBody {
    /// A body with one damping ratio for each flexible mode, and dead forces at its points.
    ///
    /// # Errors
    /// [`SetupError`] for a list of the wrong length, and numbers that are negative or not finite.
    pub fn new(body: &ReducedBody, damping_ratios: &[f64], loads: Vec<DeadForce>) -> Result<Self, SetupError> {
        let nf = body.flexible();
        crate::model::check_damping(damping_ratios, nf)?;
        crate::model::check_loads(&loads, nf)?;
        let stacked = (0..nf)
            .flat_map(|j| {
                body.gyroscopic.iter().chain(&body.inertia_second).flat_map(move |m| (0..nf).map(move |i| m[(i, j)]))
            })
            .collect();
        let damping: Vec<f64> =
            body.circular_frequencies.iter().zip(damping_ratios).map(|(omega, zeta)| 2.0 * zeta * omega).collect();
        Ok(Self {
            mass: body.mass,
            center_of_mass: body.center_of_mass,
            inertia: body.inertia,
            // B Bᵀ = J0⁻¹
            inverse_inertia: body.rotation_basis * body.rotation_basis.transpose(),
            circular_frequencies: body.circular_frequencies.clone(),
            damping_ratios: damping_ratios.to_vec(),
            damped: damping.iter().any(|d| *d > 0.0),
            damping,
            first: body.inertia_first.clone(),
            stacked,
            loads,
        })
    }

    /// Number of flexible modes nf.
    pub fn flexible(&self) -> usize {
        self.circular_frequencies.len()
    }

    /// The loads.
    pub fn loads(&self) -> &[DeadForce] {
        &self.loads
    }

    /// The state at the beginning: π = J ω + Sᵀ q̇, p = q̇ + S ω.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn start(&self, initial: &Initial) -> Result<ConservativeState, SetupError> {
        initial.check(self.flexible())?;
        let nf = self.flexible();
        let mut evaluation = Evaluation::new(nf);
        self.deform(&initial.modal_displacement, &mut evaluation);
        let s = |i: usize| &evaluation.products[i * nf..(i + 1) * nf];
        let mut momentum = initial.modal_velocity.clone();
        for i in 0..3 {
            for (p, s) in momentum.iter_mut().zip(s(i)) {
                *p += s * initial.omega[i];
            }
        }
        let coupled = Vector3::from_fn(|i, _| dot(s(i), &initial.modal_velocity));
        let mut slow = Slow::zeros();
        set(&mut slow, part::POSITION, &self.center_of_mass);
        set(&mut slow, part::MOMENTUM, &(initial.velocity * self.mass));
        set(&mut slow, part::PI, &(evaluation.inertia * initial.omega + coupled));
        Ok(ConservativeState {
            time: 0.0,
            attitude: Attitude::identity(),
            slow,
            modal_displacement: initial.modal_displacement.clone(),
            modal_momentum: momentum,
        })
    }

    /// S(q), N_ij q and J(q).
    fn deform(&self, q: &[f64], e: &mut Evaluation) {
        let nf = q.len();
        multiply(&self.stacked, 9 * nf, q, &mut e.products);
        let (s, n_q) = e.products.split_at(3 * nf);
        let mut inertia = self.inertia;
        let mut locked = Matrix3::zeros();
        for (pair, (i, j)) in PAIRS.into_iter().enumerate() {
            let n_q = &n_q[pair * nf..(pair + 1) * nf];
            let change: f64 = self.first[pair].iter().zip(n_q).zip(q).map(|((c, n), q)| (2.0 * c + n) * q).sum();
            let s_s = dot(&s[i * nf..(i + 1) * nf], &s[j * nf..(j + 1) * nf]);
            inertia[(i, j)] += change;
            locked[(i, j)] = inertia[(i, j)] - s_s;
            if i != j {
                inertia[(j, i)] += change;
                locked[(j, i)] = locked[(i, j)];
            }
        }
        e.inertia = inertia;
        e.locked_inertia = locked;
    }

    /// All rates at time `t`, with the rotation vector counted from `attitude`.
    pub(crate) fn evaluate(
        &self,
        t: f64,
        attitude: &Attitude,
        slow: &Slow,
        q: &[f64],
        p: &[f64],
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        let nf = q.len();
        self.deform(q, e);
        let pi = get(slow, part::PI);
        let s_p = Vector3::from_fn(|i, _| dot(&e.products[i * nf..(i + 1) * nf], p));
        let inverse = e
            .locked_inertia
            .try_inverse()
            .filter(|inverse| inverse.iter().all(|x| x.is_finite()))
            .ok_or(RateError::Inertia)?;
        let omega = inverse * (pi - s_p);
        e.omega_body = omega;

        let (s, n_q) = e.products.split_at(3 * nf);
        for k in 0..nf {
            let s_omega = s[k] * omega.x + s[nf + k] * omega.y + s[2 * nf + k] * omega.z;
            e.displacement[k] = -s_omega;
            e.velocity[k] = p[k] - s_omega;
        }
        multiply_top(&self.stacked, 9 * nf, &e.velocity, &mut e.gyroscopic);
        let squares: [f64; 6] =
            PAIRS.map(|(i, j)| if i == j { omega[i] * omega[j] } else { 2.0 * omega[i] * omega[j] });
        for k in 0..nf {
            let coriolis =
                omega.x * e.gyroscopic[k] + omega.y * e.gyroscopic[nf + k] + omega.z * e.gyroscopic[2 * nf + k];
            let centrifugal: f64 = (0..6).map(|pair| squares[pair] * (self.first[pair][k] + n_q[pair * nf + k])).sum();
            e.momentum[k] = centrifugal - coriolis;
        }
        let mut dissipation = 0.0;
        if self.damped {
            for k in 0..nf {
                // −D q̇ = −D p + D S ω; the first term is in the linear part.
                e.momentum[k] -= self.damping[k] * e.displacement[k];
                dissipation += self.damping[k] * e.velocity[k] * e.velocity[k];
            }
        }

        let theta = get(slow, part::THETA);
        let momentum = get(slow, part::MOMENTUM);
        let theta_rate = f_inverse(&theta, &omega).map_err(RateError::Turn)?;
        let mut pi_rate = pi.cross(&omega);
        let (mut force_rate, mut power, mut impulse_rate) = (Vector3::zeros(), 0.0, Vector3::zeros());
        if !self.loads.is_empty() {
            let global_to_body = transformation_matrix(&theta) * attitude.global_to_body();
            let mut moment = Vector3::zeros();
            for load in &self.loads {
                let force_global = load.force_global * load.history.at(t, t);
                let force_body = global_to_body * force_global;
                let u = load.point.deformation(q);
                moment += (load.point.position_body() + u).cross(&force_body);
                power += load.point.add_flexible_force(&force_body, &e.velocity, &mut e.momentum);
                force_rate += force_global;
            }
            power += force_rate.dot(&momentum) / self.mass + moment.dot(&omega);
            pi_rate += moment;
            impulse_rate = global_to_body.tr_mul(&moment);
        }
        set(&mut e.slow, part::THETA, &theta_rate);
        set(&mut e.slow, part::POSITION, &(momentum / self.mass));
        set(&mut e.slow, part::MOMENTUM, &force_rate);
        set(&mut e.slow, part::PI, &pi_rate);
        e.slow[part::WORK] = power;
        e.slow[part::DISSIPATION] = dissipation;
        set(&mut e.slow, part::ANGULAR_IMPULSE, &impulse_rate);
        set(&mut e.slow, part::IMPULSE, &force_rate);
        Ok(())
    }

    /// Adds the linear part of the modes to an evaluation: q' += p, p' −= Λq + Dp.
    pub(crate) fn add_linear(&self, q: &[f64], p: &[f64], e: &mut Evaluation) {
        for k in 0..q.len() {
            let omega = self.circular_frequencies[k];
            e.displacement[k] += p[k];
            e.momentum[k] -= omega * omega * q[k] + self.damping[k] * p[k];
        }
    }

    /// Energy of rotation, vibration and strain of a state whose rates are in `e`: all but that of the centre's motion.
    pub(crate) fn internal_energy(&self, state: &ConservativeState, e: &Evaluation) -> f64 {
        let (kinetic, strain) = self.energies(state, e);
        kinetic + strain - 0.5 * get(&state.slow, part::MOMENTUM).norm_squared() / self.mass
    }

    /// Energy that the difference of two states at one time would have: ½ P²/m + ½ π·J0⁻¹π + ½ Σ (ω_k² q² + p²).
    pub(crate) fn energy_of_difference(&self, a: &ConservativeState, b: &ConservativeState) -> f64 {
        let slow = a.slow - b.slow;
        let rigid = self.rigid_energy(&get(&slow, part::MOMENTUM), &get(&slow, part::PI));
        let q = a.modal_displacement.iter().zip(&b.modal_displacement);
        let p = a.modal_momentum.iter().zip(&b.modal_momentum);
        rigid + q.zip(p).enumerate().map(|(k, (q, p))| self.modal_energy(k, q.0 - q.1, p.0 - p.1)).sum::<f64>()
    }

    /// Energies that the impulses of the loads, one by one, would give the rigid body at rest: the scale of a motion
    /// that begins without any.
    pub(crate) fn energy_of_loads(&self) -> f64 {
        let energy = |load: &DeadForce| {
            let impulse = load.force_global * load.history.integral();
            self.rigid_energy(&impulse, &load.point.position_body().cross(&impulse))
        };
        self.loads.iter().map(energy).sum()
    }

    /// ½ P²/m + ½ π·J0⁻¹π
    fn rigid_energy(&self, momentum: &Vector3<f64>, pi: &Vector3<f64>) -> f64 {
        0.5 * (momentum.norm_squared() / self.mass + pi.dot(&(self.inverse_inertia * pi)))
    }

    /// ½ (ω_k² q² + p²)
    pub(crate) fn modal_energy(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega_q = self.circular_frequencies[k] * q;
        0.5 * (omega_q * omega_q + p * p)
    }

    /// Energies of a state whose rates are in `e`: (kinetic, strain).
    fn energies(&self, state: &ConservativeState, e: &Evaluation) -> (f64, f64) {
        let momentum = get(&state.slow, part::MOMENTUM);
        let kinetic = 0.5
            * (momentum.norm_squared() / self.mass
                + get(&state.slow, part::PI).dot(&e.omega_body)
                + dot(&state.modal_momentum, &e.velocity));
        let strain = state.modal_displacement.iter().enumerate().map(|(k, q)| self.modal_energy(k, *q, 0.0)).sum();
        (kinetic, strain)
    }

    /// Reads the motion off a state. `e` is overwritten.
    pub(crate) fn observe(
        &self,
        state: &ConservativeState,
        points: &[PointShapes],
        e: &mut Evaluation,
        out: &mut Observation,
    ) -> Result<(), RateError> {
        let nf = self.flexible();
        let (q, p) = (&state.modal_displacement, &state.modal_momentum);
        self.evaluate(state.time, &state.attitude, &state.slow, q, p, e)?;
        let (kinetic, strain) = self.energies(state, e);
        self.add_linear(q, p, e);
        let omega = e.omega_body;
        let momentum = get(&state.slow, part::MOMENTUM);

        // π = J ω + Sᵀq̇ and p = q̇ + S ω, differentiated: with S' = S(q̇) and S'ᵀq̇ = 0 (G is skew),
        // (J − SᵀS) ω' = π' − J'ω − Sᵀ(p' − S'ω),  q̈ = p' − S'ω − S ω'.
        let (s, n_q) = e.products.split_at(3 * nf);
        let inertia_rate = symmetric(|pair| {
            let n_q = &n_q[pair * nf..(pair + 1) * nf];
            2.0 * self.first[pair].iter().zip(n_q).zip(&e.velocity).map(|((c, n), v)| (c + n) * v).sum::<f64>()
        });
        out.modal_acceleration.clear();
        out.modal_acceleration.extend((0..nf).map(|k| {
            let s_rate_omega: f64 = (0..3).map(|i| omega[i] * e.gyroscopic[i * nf + k]).sum();
            e.momentum[k] - s_rate_omega
        }));
        let s_t = Vector3::from_fn(|i, _| dot(&s[i * nf..(i + 1) * nf], &out.modal_acceleration));
        let right = get(&e.slow, part::PI) - inertia_rate * omega - s_t;
        let alpha = e.locked_inertia.try_inverse().ok_or(RateError::Inertia)? * right;
        for (k, a) in out.modal_acceleration.iter_mut().enumerate() {
            *a -= (0..3).map(|i| alpha[i] * s[i * nf + k]).sum::<f64>();
        }

        out.time = state.time;
        out.attitude = state.attitude;
        out.position_global = get(&state.slow, part::POSITION);
        out.velocity_global = momentum / self.mass;
        out.omega_body = omega;
        out.alpha_body = alpha;
        out.modal_displacement.clone_from(q);
        out.modal_velocity.clone_from(&e.velocity);
        out.kinetic_energy = kinetic;
        out.strain_energy = strain;
        out.work = Work {
            work: state.slow[part::WORK],
            dissipation: state.slow[part::DISSIPATION],
            impulse_global: get(&state.slow, part::IMPULSE),
            angular_impulse_global: get(&state.slow, part::ANGULAR_IMPULSE),
        };
        out.linear_momentum_global = momentum;
        out.angular_momentum_global = state.attitude.to_global(&get(&state.slow, part::PI));
        let acceleration_of_center = get(&e.slow, part::MOMENTUM) / self.mass;
        let moved = out.position_global - self.center_of_mass;
        out.points.clear();
        out.points.extend(points.iter().map(|point| {
            let x = point.position_body();
            let (u, v, a) =
                (point.deformation(q), point.deformation(&e.velocity), point.deformation(&out.modal_acceleration));
            let arm = x + u;
            let global = |v_body: Vector3<f64>| state.attitude.to_global(&v_body);
            PointMotion {
                displacement: moved + (global(arm) - x),
                velocity: out.velocity_global + global(omega.cross(&arm) + v),
                acceleration: acceleration_of_center
                    + global(alpha.cross(&arm) + omega.cross(&omega.cross(&arm)) + 2.0 * omega.cross(&v) + a),
                rigid_acceleration: acceleration_of_center + global(alpha.cross(&x) + omega.cross(&omega.cross(&x))),
            }
        }));
        Ok(())
    }
}

/// A symmetric matrix from its six entries in the order of [`PAIRS`].
fn symmetric(entry: impl Fn(usize) -> f64) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for (pair, (i, j)) in PAIRS.into_iter().enumerate() {
        matrix[(i, j)] = entry(pair);
        matrix[(j, i)] = matrix[(i, j)];
    }
    matrix
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// y = M x for M with `rows` rows, column by column.
pub(crate) fn multiply(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    if rows == 0 {
        return;
    }
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        for (y, m) in y.iter_mut().zip(column) {
            *y += m * x;
        }
    }
}

/// The first `y.len()` rows of M x.
fn multiply_top(matrix: &[f64], rows: usize, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    if rows == 0 {
        return;
    }
    let top = y.len();
    for (column, x) in matrix.chunks_exact(rows).zip(x) {
        for (y, m) in y.iter_mut().zip(&column[..top]) {
            *y += m * x;
        }
    }
}
