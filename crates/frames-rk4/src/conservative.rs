//! The conservative form: a body in its mean-axis frame, with momenta for its state.
//!
//! ```text
//! x = r + Aᵀ (X + Ψ_f q)
//! J(q)_ij = J0_ij + 2 c_ij·q + qᵀ N_ij q          S(q)_i = b_i + G_i q
//! ω = (J − SᵀS)⁻¹ (π − Sᵀp),      q̇ = p − S ω
//! π' = π × ω + Σ (X_k + u_k) × F_k(body)
//! p' = −Λq − D q̇ + Ψ_fᵀF + Σ_ij ω_i ω_j (c_ij + N_ij q) − Σ_i ω_i G_i q̇
//! P' = Σ F (global),   r' = P/m
//! energy = P²/2m + ½ π·ω + ½ p·q̇ + ½ q·Λq
//! ```
//!
//! Of a body that turns freely and whose inertia follows its deformation, S and the G_i leave J and q̇ for the locked
//! inertia and p: q̇ = p − S ω need not be known for its forces, and one pass through the matrices gives all that a state
//! is asked for.
//!
//! ```text
//! 𝕁 = J − SᵀS = J0 + 2 c_ij·q + qᵀ N̂_ij q,      N̂_ij = N_ij + ½ (G_iG_j + G_jG_i)
//! Σ_ij ω_i ω_j (c_ij + N_ij q) − Σ_i ω_i G_i q̇ = Σ_ij ω_i ω_j (c_ij + N̂_ij q) − Σ_i ω_i G_i p
//! ```
//!
//! Hamiltonian without damping and loads: energy and `Aᵀπ` are constants of the motion for any number of modes.
//! The part of q' and p' that is linear in the modes, `q' = p, p' = −Λq − Dp`, is left to the integrators.
//!
//! i and j count the axes that the body turns about: three, the one of a hinge, or none. Where something drives the
//! body, ω is given, and the modes, which are those of the driven part held still, have a momentum b in its motion; b is
//! zero otherwise.
//!
//! With geometric stiffening the displacement is `Ψ_f q + u₂`, to second order in q, and each field of forces does its work
//! on u₂, too: of the centrifugal field, N_ij becomes `N_ij − Ψ_fᵀ K_ij Ψ_f`; the inertia of a driven motion of speed v adds
//! `v' K q` to p'; a load has its own in [`SecondOrder`](crate::SecondOrder).
//!
//! The momentum of a driven motion has −(K q)·q̇ besides, which changes the Lagrangian by `−v (½ qᵀK q)'`. That is
//! `½ v' qᵀK q` but for a total derivative: in p, −v K q would be as large as the momenta of stiff modes. Where v jumps, p
//! jumps by K q times as much.
//!
//! On the manifold of large deflection K acts on q: on ξ it would work on what the modes draw in, and that is of fourth
//! order, where the strain energy has terms of its own size against it. Of the spin alone, its parts between a large mode
//! and another act on ξ, which is of third order.
//!
//! With large deflection the equations are those of the extended shapes, with coordinates ξ(q) and their slopes D on a
//! curved manifold ([`Manifold`]). The constants are those of the coordinates z by which ξ = E z, the modes and the products
//! of the large ones; D is E ∂z/∂q:
//!
//! ```text
//! S = Dᵀ S_ext(ξ),  M = DᵀD:      p = M q̇ + S ω,   π = J(ξ) ω + Sᵀ q̇,   ν = D q̇,   μ = ν + S_ext ω
//! ω = (J − SᵀM⁻¹S)⁻¹ (π − SᵀM⁻¹p),      q̇ = M⁻¹ (p − S ω)
//! p' = Dᵀ [Σ ω_iω_j (c_ij + N_ij ξ) − Σ ω_i G_i ν + Ψ_extᵀF] + Ḋᵀμ − Λq − D q̇ − ∂V_n/∂q
//! ```

mod energy;
mod state;

use faer::Mat;
use modal::ReducedBody;
use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};
use rigid_kin::{Attitude, f_inverse, transformation_matrix};

use crate::blocked_matrix::BlockedMatrix;
use crate::column_major::{add_product, columns, dot, dot_of_sum, multiply};
use crate::effect::{Effect, EffectMap};
use crate::error::{RateError, SetupError, StepError};
use crate::initial::Initial;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};
use crate::manifold::{Manifold, ManifoldPoint};
use crate::motion::CenterOfMass;
use crate::own_coupling::own_coupling;
use crate::physics::{Drive, DrivenMotion, Physics};
use crate::reaction::Held;
use crate::spin_stiffness::SpinStiffness;
use crate::state::MotionState;
use crate::symmetric;
pub use state::ConservativeState;
pub(crate) use state::{Slow, get, part, set};

/// How the origin moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Translation {
    /// It does not.
    None,
    /// As the momentum takes it.
    Free,
    /// Along a direction, as the momentum takes it.
    Along(Vector3<f64>),
    /// Along a direction, as it is driven.
    Driven(Vector3<f64>),
}

/// A body with its loads in the conservative form.
#[derive(Debug, Clone)]
pub struct ConservativeBody {
    pub(crate) mass: f64,
    pub(crate) origin: Vector3<f64>,
    pub(crate) center: CenterOfMass,
    pub(crate) translation: Translation,
    /// Unit vectors that the body turns about: three, one or none.
    pub(crate) axes: Vec<Vector3<f64>>,
    /// Whether the turning is driven.
    pub(crate) turn_driven: bool,
    pub(crate) drive: Option<Drive>,
    /// J₀ in the axes of rotation; 1 on the diagonal of axes that are missing.
    inertia: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    /// ω_k of the flexible modes.
    pub(crate) circular_frequencies: Vec<f64>,
    pub(crate) damping_ratios: Vec<f64>,
    /// Largest of ω_k and 2 ζ_k ω_k.
    fastest_rate: f64,
    /// 2 ζ_k ω_k.
    damping: Vec<f64>,
    damped: bool,
    /// ij of the terms of the inertia that follow the deformation; empty where none does.
    pub(crate) pairs: Vec<(usize, usize)>,
    /// Whether the equations are those of the locked inertia, which only momenta enter: of a body that turns freely, with
    /// Coriolis terms, inertia that follows its deformation, and no large modes.
    locked: bool,
    /// S and c_ij + N_ij q of the undeformed body: b_i of driven axes or zeros (`s_rows`), then the c_ij of `pairs`.
    undeformed: Vec<f64>,
    /// b of a driven translation (nf).
    pub(crate) sliding: Vec<f64>,
    /// Rows of S: nf for each axis, or none where it is zero.
    pub(crate) s_rows: usize,
    /// Rows of the G_i: as those of S, or none without Coriolis terms.
    pub(crate) g_rows: usize,
    /// The G_i, one below another.
    gyroscopic: BlockedMatrix,
    /// The N_ij, less by K_ij and of a `locked` body more by ½ (G_iG_j + G_jG_i), one below another.
    inertia_second: BlockedMatrix,
    /// Largest N_ij and G_i that couple each mode to itself and its like (nf).
    pub(crate) own_coupling: Vec<[f64; 2]>,
    /// K of a unit acceleration of what is driven in the modes, column by column, or empty.
    pub(crate) drive_stiffness: Vec<f64>,
    loads: Vec<SharedLoad>,
    /// Of a body with large modes.
    pub(crate) manifold: Option<Manifold>,
    /// Of a body that something holds.
    pub(crate) held: Option<Held>,
}

/// Rates of a [`ConservativeState`].
#[derive(Debug, Clone, PartialEq)]
pub struct ConservativeRates {
    /// Angular velocity of the body frame, body components: the attitude turns with it.
    pub omega_body: Vector3<f64>,
    /// Rate of the position of the origin, global components.
    pub velocity_global: Vector3<f64>,
    /// Rate of the linear momentum, global components.
    pub force_global: Vector3<f64>,
    /// Rate of the angular momentum π, one component for each axis that the body turns about.
    pub moment_body: Vector3<f64>,
    /// q̇ (nf).
    pub modal_velocity: Vec<f64>,
    /// p' (nf).
    pub modal_force: Vec<f64>,
}

/// Rates without the linear part of the modes, and what was found on the way to them.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    pub slow: Slow,
    /// q' − p = −S ω (nf).
    pub displacement: Vec<f64>,
    /// p' + Λq + D p (nf).
    pub momentum: Vec<f64>,
    /// S_i, c_ij + N_ij z, and G_i ż or, of a locked body, G_i p.
    pub products: Vec<f64>,
    /// G_i ż of a locked body: for its accelerations only.
    pub coupling_rate: Vec<f64>,
    /// q̇ (nf).
    pub modal_velocity: Vec<f64>,
    /// z and ż: q and q̇ but on a manifold.
    pub coordinates: Vec<f64>,
    pub velocity: Vec<f64>,
    /// On a manifold, ξ, ν and ν' in the extended shapes, and forces there and on z.
    pub in_shapes: [Vec<f64>; 3],
    force_in_shapes: Vec<f64>,
    force: Vec<f64>,
    /// Momenta of the products in z.
    pub momenta_of_products: Vec<f64>,
    /// The place on the manifold. There, with the Cholesky factor M = L Lᵀ, are S and L⁻¹S (a row for each axis), and b of
    /// a driven translation.
    pub place: ManifoldPoint,
    pub s: Vec<f64>,
    pub forward_s: Vec<f64>,
    pub modal_sliding: Vec<f64>,
    /// q̈ and what it is made of.
    pub acceleration: Vec<f64>,
    pub change: Vec<f64>,
    /// What z̈ has without q̈, on a manifold.
    pub curvature: Vec<f64>,
    /// K q of the stiffness of what is driven (nf).
    pub drive_stress: Vec<f64>,
    /// Angular velocity, one component for each axis.
    pub spin: Vector3<f64>,
    pub omega_body: Vector3<f64>,
    /// Angular velocity or velocity of what is driven; zero without a drive.
    pub driven_speed: f64,
    /// π of a driven turn or the P of a driven slide, along its axis.
    pub driven_momentum: f64,
    /// Torque or force of the drive.
    pub drive_effort: f64,
    /// Resultants of the loads about the origin, body components.
    pub load_force: Vector3<f64>,
    pub load_moment: Vector3<f64>,
    /// J − SᵀS.
    pub locked_inertia: Matrix3<f64>,
}

/// The rates of a state, in the widest vectors that the processor has.
struct Rates<'a> {
    body: &'a ConservativeBody,
    times: [f64; 2],
    attitude: &'a Attitude,
    slow: &'a Slow,
    q: &'a [f64],
    p: &'a [f64],
    e: &'a mut Evaluation,
}

impl WithSimd for Rates<'_> {
    type Output = Result<(), RateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { body, times, attitude, slow, q, p, e } = self;
        body.find_rates(times, attitude, slow, q, p, e)
    }
}

impl ConservativeBody {
    /// A body with one damping ratio for each flexible mode, and loads.
    ///
    /// # Errors
    /// [`SetupError`] for a list of the wrong length, numbers that are negative or not finite, and a drive of a body
    /// that is not clamped.
    pub fn new(
        body: &ReducedBody,
        damping_ratios: &[f64],
        loads: Vec<SharedLoad>,
        physics: &Physics,
    ) -> Result<Self, SetupError> {
        crate::model::check_motion(body)?;
        crate::model::check_damping(damping_ratios, body.flexible())?;
        let Physics { effects, drive, drive_stiffness, large_deflection } = physics;
        let modes = body;
        let body = large_deflection.as_ref().map_or(modes, Manifold::body);
        if let Some(found) = large_deflection.as_ref().map(Manifold::modes).filter(|found| *found != modes.flexible()) {
            let what = "the modes of the manifold of large deflection";
            return Err(SetupError::Length { what, expected: modes.flexible(), found });
        }
        let nf = body.flexible();
        loads.iter().try_for_each(|load| load.check(nf))?;
        let drive_stiffness = drive_stiffness.as_ref().filter(|_| drive.is_some());
        let mut sizes = drive_stiffness.iter().flat_map(|k| [k.nrows(), k.ncols()]);
        if let Some(found) = sizes.find(|found| *found != nf) {
            let what = "a row or column of the geometric stiffness of the drive";
            return Err(SetupError::Length { what, expected: nf, found });
        }
        let driven = match drive {
            Some(drive) => {
                drive.check()?;
                if body.motion.count() > 0 {
                    return Err(SetupError::DriveOfFreeBody { motion: Box::new(body.motion) });
                }
                Some(drive.motion)
            }
            None => None,
        };
        let (translation, axes) = degrees_of_freedom(body, effects, driven);
        let turn_driven = matches!(driven, Some(DrivenMotion::Turn { .. }));
        let damping: Vec<f64> =
            modes.circular_frequencies.iter().zip(damping_ratios).map(|(omega, zeta)| 2.0 * zeta * omega).collect();
        let inertia = along_axes(&axes, &body.inertia);

        let manifold = large_deflection.as_ref();
        let follows = effects[Effect::DeformedInertia];
        // It needs the N_ij: where they are off, it would cost more than it saves.
        let locked = effects[Effect::Coriolis] && follows && !turn_driven && manifold.is_none();
        let pairs: Vec<(usize, usize)> = match axes.len() {
            3 if nf > 0 && follows => ReducedBody::PAIRS.to_vec(),
            1 if nf > 0 && follows => vec![(0, 0)],
            _ => Vec::new(),
        };
        let size = manifold.map_or(nf, Manifold::size);
        let g_rows = if effects[Effect::Coriolis] { axes.len() * size } else { 0 };
        let s_rows = if effects[Effect::Coriolis] || turn_driven { axes.len() * size } else { 0 };
        let stiffness = body.stress_stiffness.as_ref().filter(|_| effects[Effect::GeometricStiffening]);
        let stiffness = stiffness.map(|stiffness| SpinStiffness::new(stiffness, manifold));
        // Weights of the constants of PAIRS in those of a pair of axes.
        let weights = |(i, j): (usize, usize)| {
            ReducedBody::PAIRS.map(|(k, l)| {
                let product = axes[i][k] * axes[j][l];
                if k == l { product } else { product + axes[i][l] * axes[j][k] }
            })
        };
        let on_coordinates = |matrix: Mat<f64>| match manifold.map(Manifold::shapes_by_coordinates) {
            Some(e) => e.transpose() * matrix * e,
            None => matrix,
        };
        let gyroscopic = |axis: &Vector3<f64>| {
            on_coordinates(Mat::from_fn(nf, nf, |i, j| {
                axis.iter().zip(&body.gyroscopic).map(|(a, g)| a * g[(i, j)]).sum()
            }))
        };
        let of = |matrices: &[Mat<f64>; 6], weights: &[f64; 6], i: usize, j: usize| -> f64 {
            matrices.iter().zip(weights).map(|(m, w)| w * m[(i, j)]).sum()
        };
        let pair_weights: Vec<[f64; 6]> = pairs.iter().map(|pair| weights(*pair)).collect();
        let second = |weights: &[f64; 6]| {
            let mut second = on_coordinates(Mat::from_fn(nf, nf, |i, j| {
                of(&body.inertia_second, weights, i, j)
                    - stiffness.as_ref().map_or(0.0, |stiffness| of(&stiffness.on_shapes, weights, i, j))
            }));
            if let Some(on_modes) = stiffness.as_ref().and_then(|stiffness| stiffness.on_modes.as_ref()) {
                for (i, j) in (0..modes.flexible()).flat_map(|j| (0..modes.flexible()).map(move |i| (i, j))) {
                    second[(i, j)] -= of(on_modes, weights, i, j);
                }
            }
            second
        };
        let turning = if g_rows > 0 { &axes[..] } else { &[] };
        let gyroscopic: Vec<Mat<f64>> = turning.iter().map(gyroscopic).collect();
        let mut second: Vec<Mat<f64>> = pair_weights.iter().map(second).collect();
        let coupling = own_coupling(&modes.circular_frequencies, [&second, &gyroscopic]);
        if locked {
            for (second, (i, j)) in second.iter_mut().zip(&pairs) {
                let product = &gyroscopic[*i] * &gyroscopic[*j];
                *second += (&product + product.transpose()) * faer::Scale(0.5);
            }
        }
        // Eᵀ of a list.
        let list_on_coordinates = |list: Vec<f64>| match manifold.map(Manifold::shapes_by_coordinates) {
            Some(e) => e.col_iter().map(|column| column.iter().zip(&list).map(|(e, x)| e * x).sum()).collect(),
            None => list,
        };
        let along = |unit: &Vector3<f64>, of: &[Vec<f64>; 3]| -> Vec<f64> {
            list_on_coordinates((0..nf).map(|k| (0..3).map(|i| unit[i] * of[i][k]).sum()).collect())
        };
        let mut undeformed = vec![0.0; s_rows];
        if turn_driven {
            undeformed = axes.iter().flat_map(|axis| along(axis, &body.rotation_first)).collect();
        }
        for weights in &pair_weights {
            let of_shape = |k: usize| weights.iter().zip(&body.inertia_first).map(|(w, c)| w * c[k]).sum();
            undeformed.extend(list_on_coordinates((0..nf).map(of_shape).collect()));
        }
        let rates = modes.circular_frequencies.iter().chain(&damping);
        Ok(Self {
            mass: body.mass,
            origin: body.origin,
            center: CenterOfMass::new(body),
            inverse_inertia: inertia.try_inverse().unwrap_or_else(Matrix3::zeros),
            inertia,
            circular_frequencies: modes.circular_frequencies.clone(),
            damping_ratios: damping_ratios.to_vec(),
            fastest_rate: rates.copied().fold(0.0, f64::max),
            damped: damping.iter().any(|d| *d > 0.0),
            damping,
            pairs,
            locked,
            undeformed,
            sliding: match translation {
                Translation::Driven(direction) => along(&direction, &body.translation_first),
                _ => Vec::new(),
            },
            translation,
            axes,
            turn_driven,
            drive: drive.clone(),
            s_rows,
            g_rows,
            own_coupling: coupling,
            gyroscopic: below_one_another(&gyroscopic),
            inertia_second: below_one_another(&second),
            drive_stiffness: drive_stiffness
                .map_or_else(Vec::new, |k| columns(k.get(..modes.flexible(), ..modes.flexible()))),
            loads,
            manifold: large_deflection.clone(),
            held: Held::new(body, stiffness.as_ref(), effects),
        })
    }

    /// Number of flexible modes nf.
    pub fn flexible(&self) -> usize {
        self.circular_frequencies.len()
    }

    /// Number of coordinates z: that of the modes, but on a manifold.
    pub(crate) fn coordinates(&self) -> usize {
        self.manifold.as_ref().map_or(self.flexible(), Manifold::size)
    }

    /// Number of extended shapes: that of the modes, but on a manifold.
    pub(crate) fn extended(&self) -> usize {
        self.manifold.as_ref().map_or(self.flexible(), |manifold| manifold.body().flexible())
    }

    /// The loads.
    pub fn loads(&self) -> &[SharedLoad] {
        &self.loads
    }

    /// Numbers in the matrices that an evaluation reads: what an effect that is off does not cost.
    pub fn matrix_entries(&self) -> usize {
        let of_loads: usize = self.loads.iter().map(|load| load.matrix_entries()).sum();
        self.gyroscopic.len() + self.inertia_second.len() + self.drive_stiffness.len() + of_loads
    }

    pub(crate) fn evaluation(&self) -> Evaluation {
        let (modes, nf) = (self.flexible(), self.coordinates());
        let zeros = |n: usize| vec![0.0; n];
        let on_manifold = |n: usize| if self.manifold.is_some() { zeros(n) } else { Vec::new() };
        let s_axes = self.s_rows.checked_div(nf).unwrap_or(0);
        Evaluation {
            slow: Slow::zeros(),
            displacement: zeros(modes),
            momentum: zeros(modes),
            products: zeros(self.undeformed.len() + self.g_rows),
            coupling_rate: zeros(if self.locked { self.g_rows } else { 0 }),
            modal_velocity: zeros(modes),
            coordinates: zeros(nf),
            velocity: zeros(nf),
            in_shapes: std::array::from_fn(|_| on_manifold(self.extended())),
            force_in_shapes: on_manifold(self.extended()),
            force: on_manifold(nf),
            momenta_of_products: on_manifold(nf - modes),
            acceleration: zeros(modes),
            change: zeros(nf),
            curvature: on_manifold(nf),
            place: self.manifold.as_ref().map_or_else(ManifoldPoint::default, Manifold::place),
            s: on_manifold(s_axes * modes),
            forward_s: on_manifold(s_axes * modes),
            modal_sliding: if self.sliding.is_empty() { Vec::new() } else { on_manifold(modes) },
            drive_stress: zeros(if self.drive_stiffness.is_empty() { 0 } else { modes }),
            spin: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            driven_speed: 0.0,
            driven_momentum: 0.0,
            drive_effort: 0.0,
            load_force: Vector3::zeros(),
            load_moment: Vector3::zeros(),
            locked_inertia: self.inertia,
        }
    }

    /// The state at the beginning: π = J ω + Sᵀ q̇, p = q̇ + S ω. Parts of the velocities that the body has not got are
    /// left out; driven ones are as they are driven.
    ///
    /// # Errors
    /// [`SetupError`] for lists of the wrong length and numbers that are not finite.
    pub fn start(&self, initial: &Initial) -> Result<ConservativeState, SetupError> {
        initial.check(self.flexible())?;
        let mut e = self.evaluation();
        self.deform(&initial.modal_displacement, None, &mut e);
        let speed = self.drive.as_ref().map_or(0.0, |drive| drive.speed_at(0.0, 0.0));
        let mut spin = Vector3::zeros();
        for (w, axis) in spin.iter_mut().zip(&self.axes) {
            *w = if self.turn_driven { speed } else { axis.dot(&initial.omega) };
        }
        self.extend_rate(&initial.modal_velocity, &mut e);
        let mut pi: Vector3<f64> = self.deformed_inertia(&e) * spin;
        for (i, s) in e.products[..self.s_rows].chunks_exact(self.coordinates().max(1)).enumerate() {
            pi[i] += dot(s, &e.velocity);
        }
        let mut mu = match &self.manifold {
            Some(manifold) => {
                let Evaluation { velocity, in_shapes: [_, in_shapes, _], .. } = &mut e;
                manifold.in_shapes(velocity, in_shapes);
                let mut mu = vec![0.0; velocity.len()];
                manifold.add_from_shapes(in_shapes, &mut mu);
                mu
            }
            None => e.velocity.clone(),
        };
        self.add_rigid_momenta(&e.products[..self.s_rows], &spin, speed, &mut mu);
        let momentum = match &self.manifold {
            Some(manifold) => {
                let mut momentum = vec![0.0; self.flexible()];
                manifold.add_projection(&e.place, &mu, &mut momentum);
                momentum
            }
            None => mu,
        };
        for k in self.axes.len()..3 {
            pi[k] = 0.0;
        }
        let mut slow = Slow::zeros();
        set(&mut slow, part::POSITION, &self.origin);
        let velocity = match self.translation {
            Translation::Free => initial.velocity,
            Translation::Along(direction) => along(&initial.attitude.to_global(&direction), &initial.velocity),
            Translation::None | Translation::Driven(_) => Vector3::zeros(),
        };
        set(&mut slow, part::MOMENTUM, &(velocity * self.mass));
        set(&mut slow, part::PI, &pi);
        Ok(ConservativeState {
            time: 0.0,
            attitude: initial.attitude,
            slow,
            turned: 0.0,
            modal_displacement: initial.modal_displacement.clone(),
            modal_momentum: momentum,
        })
    }

    /// A state in quantities that every formulation has.
    pub(crate) fn motion_state(&self, state: &ConservativeState) -> Result<MotionState, RateError> {
        let mut e = self.evaluation();
        let (q, p) = (&state.modal_displacement, &state.modal_momentum);
        self.evaluate([state.time, state.time], &state.attitude, &state.slow, q, p, &mut e)?;
        Ok(MotionState {
            time: state.time,
            attitude: state.attitude,
            origin_global: state.origin_global(),
            velocity_global: get(&e.slow, part::POSITION),
            omega_body: e.omega_body,
            modal_displacement: q.clone(),
            modal_velocity: e.modal_velocity,
        })
    }

    /// The momenta of a motion. Work and impulses are counted from it anew.
    pub(crate) fn state_of(&self, motion: &MotionState) -> Result<ConservativeState, SetupError> {
        motion.check(self.flexible())?;
        let initial = Initial {
            attitude: motion.attitude,
            velocity: motion.velocity_global,
            omega: motion.omega_body,
            modal_displacement: motion.modal_displacement.clone(),
            modal_velocity: motion.modal_velocity.clone(),
        };
        let mut state = self.start(&initial)?;
        state.time = motion.time;
        state.set_origin_global(&motion.origin_global);
        Ok(state)
    }

    /// Rates of a state, for an integrator of one's own. Laws with branches are taken as they are at `branch_time`.
    ///
    /// # Errors
    /// [`StepError`] where the inertia of the deformed body is singular.
    pub fn rates(&self, state: &ConservativeState, branch_time: f64) -> Result<ConservativeRates, StepError> {
        let mut e = self.evaluation();
        let (q, p) = (&state.modal_displacement, &state.modal_momentum);
        self.evaluate([state.time, branch_time], &state.attitude, &state.slow, q, p, &mut e)
            .map_err(|error| error.in_step(state.time, 0.0))?;
        self.add_linear(q, p, &mut e);
        Ok(ConservativeRates {
            omega_body: e.omega_body,
            velocity_global: get(&e.slow, part::POSITION),
            force_global: get(&e.slow, part::MOMENTUM),
            moment_body: get(&e.slow, part::PI),
            modal_velocity: e.displacement,
            modal_force: e.momentum,
        })
    }

    /// q̇ and ż.
    fn extend_rate(&self, rate: &[f64], e: &mut Evaluation) {
        e.modal_velocity.copy_from_slice(rate);
        match &self.manifold {
            Some(manifold) => manifold.go_along(rate, &mut e.place, &mut e.velocity),
            None => e.velocity.copy_from_slice(rate),
        }
    }

    /// z, and there S, c_ij + N_ij z, K q and the locked inertia; of a locked body with momenta, G_i p as well.
    #[inline(always)]
    fn deform(&self, q: &[f64], p: Option<&[f64]>, e: &mut Evaluation) {
        match &self.manifold {
            Some(manifold) => manifold.go(q, &mut e.place, &mut e.coordinates),
            None => e.coordinates.copy_from_slice(q),
        }
        if !self.drive_stiffness.is_empty() {
            multiply(&self.drive_stiffness, q.len(), q, &mut e.drive_stress);
        }
        let z = &e.coordinates;
        let nf = z.len();
        if self.undeformed.is_empty() {
            return;
        }
        let (products, turned) = e.products.split_at_mut(self.undeformed.len());
        products.copy_from_slice(&self.undeformed);
        let (s, n_z) = products.split_at_mut(self.s_rows);
        if self.g_rows > 0 {
            match p {
                Some(p) if self.locked => self.gyroscopic.two_products([z, p], [s, turned]),
                _ => self.gyroscopic.add_product(z, s),
            }
        }
        if !self.pairs.is_empty() {
            self.inertia_second.add_product(z, n_z);
        }
        let mut inertia = self.inertia;
        let first = self.undeformed[self.s_rows..].chunks_exact(nf.max(1));
        for ((pair, first), n_z) in self.pairs.iter().zip(first).zip(n_z.chunks_exact(nf.max(1))) {
            symmetric::add(&mut inertia, *pair, dot_of_sum(first, n_z, z));
        }
        if let Some(manifold) = &self.manifold {
            let modes = q.len();
            let on_modes = e.s.chunks_exact_mut(modes.max(1)).zip(e.forward_s.chunks_exact_mut(modes.max(1)));
            for (s, (on_modes, forward)) in s.chunks_exact(nf.max(1)).zip(on_modes) {
                on_modes.fill(0.0);
                manifold.add_projection(&e.place, s, on_modes);
                forward.copy_from_slice(on_modes);
                manifold.substitute_forward(&e.place, forward);
            }
        }
        e.locked_inertia = inertia;
        if !self.locked {
            e.locked_inertia -= self.inertia_of_modes(e);
        }
    }

    /// SᵀM⁻¹S
    #[inline(always)]
    fn inertia_of_modes(&self, e: &Evaluation) -> Matrix3<f64> {
        let s = if self.manifold.is_some() { &e.forward_s[..] } else { &e.products[..self.s_rows] };
        let modes = self.flexible().max(1);
        let mut sum = Matrix3::zeros();
        for (i, a) in s.chunks_exact(modes).enumerate() {
            for (j, b) in s.chunks_exact(modes).enumerate().take(i + 1) {
                symmetric::add(&mut sum, (i, j), dot(a, b));
            }
        }
        sum
    }

    /// J(q) where `e` is.
    pub(crate) fn deformed_inertia(&self, e: &Evaluation) -> Matrix3<f64> {
        e.locked_inertia + self.inertia_of_modes(e)
    }

    /// (J − SᵀS)⁻¹ x in the axes of rotation.
    pub(crate) fn solve_locked(&self, e: &Evaluation, x: &Vector3<f64>) -> Result<Vector3<f64>, RateError> {
        if self.undeformed.is_empty() {
            return Ok(self.inverse_inertia * x);
        }
        let inverse = if self.axes.len() == 1 {
            Matrix3::from_diagonal(&Vector3::new(1.0 / e.locked_inertia[(0, 0)], 1.0, 1.0))
        } else {
            e.locked_inertia.try_inverse().ok_or(RateError::Inertia)?
        };
        if inverse.iter().all(|x| x.is_finite()) { Ok(inverse * x) } else { Err(RateError::Inertia) }
    }

    /// All rates at time `t`, with the rotation vector counted from `attitude`. Loads and drives follow the branches of their histories that
    /// hold at `branch_time`.
    pub(crate) fn evaluate(
        &self,
        times: [f64; 2],
        attitude: &Attitude,
        slow: &Slow,
        q: &[f64],
        p: &[f64],
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        Arch::new().dispatch(Rates { body: self, times, attitude, slow, q, p, e })
    }

    #[inline(always)]
    fn find_rates(
        &self,
        [t, branch_time]: [f64; 2],
        attitude: &Attitude,
        slow: &Slow,
        q: &[f64],
        p: &[f64],
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        self.deform(q, Some(p), e);
        let speed = self.drive.as_ref().map_or(0.0, |drive| drive.speed_at(t, branch_time));
        let driven_acceleration = self.drive.as_ref().map_or(0.0, |drive| drive.acceleration_at(t, branch_time));
        e.driven_speed = speed;
        self.start_velocities(p, speed, e);
        let pi = get(slow, part::PI);
        if self.turn_driven {
            e.spin = Vector3::new(speed, 0.0, 0.0);
        } else if !self.axes.is_empty() {
            let mut right = pi;
            let (s, p) =
                if self.manifold.is_some() { (&e.forward_s[..], &e.modal_velocity[..]) } else { (self.s(e), p) };
            for (i, s) in s.chunks_exact(q.len().max(1)).enumerate() {
                right[i] -= dot(s, p);
            }
            e.spin = self.solve_locked(e, &right)?;
        }
        let w = e.spin;
        e.omega_body = self.axes.iter().zip(w.iter()).map(|(axis, w)| axis * *w).sum();

        self.find_velocities(p, speed, e);

        let momentum = get(slow, part::MOMENTUM);
        let velocity = match self.translation {
            Translation::None => Vector3::zeros(),
            Translation::Free | Translation::Along(_) => momentum / self.mass,
            Translation::Driven(direction) => attitude.to_global(&direction) * speed,
        };
        let theta = get(slow, part::THETA);
        let turning = !self.axes.is_empty();
        let theta_rate =
            if turning { f_inverse(&theta, &e.omega_body).map_err(RateError::Turn)? } else { Vector3::zeros() };
        // Forces on z are gathered in a list that is put back below: nothing may fail in between.
        let mut modal_force = std::mem::take(if self.manifold.is_some() { &mut e.force } else { &mut e.momentum });
        self.inertia_forces(e, &mut modal_force);
        let mut pi_rate = if self.axes.len() == 3 { pi.cross(&w) } else { Vector3::zeros() };
        let mut power = 0.0;
        let (mut force, mut angular_impulse) = (Vector3::zeros(), Vector3::zeros());
        if self.manifold.is_some() {
            e.momentum.fill(0.0);
        }
        if !self.loads.is_empty() {
            let first_attitude = attitude.global_to_body();
            let body_from_global =
                if turning { transformation_matrix(&theta) * first_attitude } else { first_attitude };
            self.find_in_shapes(e);
            let on_manifold = self.manifold.as_ref().map(|_| [q, &e.modal_velocity[..]]);
            let (xi, nu, on_shapes) = match &self.manifold {
                Some(_) => {
                    let [xi, nu, _] = &e.in_shapes;
                    e.force_in_shapes.fill(0.0);
                    (xi, nu, &mut e.force_in_shapes)
                }
                None => (&e.coordinates, &e.velocity, &mut modal_force),
            };
            let coordinates = Coordinates { first: 6, displacement: xi, velocity: nu, on_manifold };
            let motion = Kinematics {
                time: t,
                branch_time,
                body_from_global: &body_from_global,
                origin_global: get(slow, part::POSITION),
                velocity_global: velocity,
                omega_body: e.omega_body,
                coordinates,
                unit: false,
            };
            let mut applied = Applied::new(coordinates, Vector3::zeros(), on_shapes);
            if self.manifold.is_some() {
                applied = applied.on_manifold(&mut e.momentum);
            }
            self.loads.iter().for_each(|load| load.apply(&motion, &mut applied));
            let moment = applied.moment_body;
            (e.load_force, e.load_moment) = (applied.force_body, moment);
            power = applied.modal_power + moment.dot(&e.omega_body);
            force = body_from_global.tr_mul(&applied.force_body);
            let mut left = Vector3::zeros();
            for (i, axis) in self.axes.iter().enumerate() {
                let component = axis.dot(&moment);
                pi_rate[i] += component;
                left += axis * component;
            }
            angular_impulse = body_from_global.tr_mul(&left);
            power += force.dot(&velocity);
            if let Some(manifold) = &self.manifold {
                manifold.add_from_shapes(&e.force_in_shapes, &mut modal_force);
            }
        }
        self.project_forces(speed, modal_force, e);
        e.momentum.iter_mut().zip(&e.drive_stress).for_each(|(rate, k_q)| *rate += driven_acceleration * k_q);
        let mut dissipation = 0.0;
        if self.damped {
            for k in 0..q.len() {
                // −D q̇ = −D p + D (p − q̇); the first term is in the linear part.
                e.momentum[k] -= self.damping[k] * e.displacement[k];
                dissipation += self.damping[k] * e.modal_velocity[k] * e.modal_velocity[k];
            }
        }
        let force_rate = match self.translation {
            Translation::Free => force,
            Translation::Along(direction) => along(&attitude.to_global(&direction), &force),
            Translation::None | Translation::Driven(_) => Vector3::zeros(),
        };
        if self.drive.is_some() {
            let force_body = attitude.to_body(&force);
            self.drive_effort(driven_acceleration, [q, p], &force_body, pi_rate[0], e);
            power += e.drive_effort * speed;
            pi_rate = Vector3::zeros();
        }
        set(&mut e.slow, part::THETA, &theta_rate);
        set(&mut e.slow, part::POSITION, &velocity);
        set(&mut e.slow, part::MOMENTUM, &force_rate);
        set(&mut e.slow, part::PI, &pi_rate);
        e.slow[part::WORK] = power;
        e.slow[part::DISSIPATION] = dissipation;
        set(&mut e.slow, part::ANGULAR_IMPULSE, &angular_impulse);
        set(&mut e.slow, part::IMPULSE, &force_rate);
        Ok(())
    }

    /// S on the modes, a row for each axis.
    pub(crate) fn s<'e>(&self, e: &'e Evaluation) -> &'e [f64] {
        if self.manifold.is_some() { &e.s } else { &e.products[..self.s_rows] }
    }

    /// On a manifold, puts L⁻¹ (p − b v) into the place of q̇.
    #[inline(always)]
    fn start_velocities(&self, p: &[f64], speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        e.modal_velocity.copy_from_slice(p);
        if !self.sliding.is_empty() {
            e.modal_sliding.fill(0.0);
            manifold.add_projection(&e.place, &self.sliding, &mut e.modal_sliding);
            e.modal_velocity.iter_mut().zip(&e.modal_sliding).for_each(|(v, b)| *v -= b * speed);
        }
        manifold.substitute_forward(&e.place, &mut e.modal_velocity);
    }

    /// q̇ and ż, at the spin of `e`.
    #[inline(always)]
    fn find_velocities(&self, p: &[f64], speed: f64, e: &mut Evaluation) {
        let modes = p.len();
        let negative = -e.spin;
        let Some(manifold) = &self.manifold else {
            multiply(&e.products[..self.s_rows], modes, negative.as_slice(), &mut e.displacement);
            e.displacement.iter_mut().zip(&self.sliding).for_each(|(rate, b)| *rate -= b * speed);
            for ((v, p), rate) in e.velocity.iter_mut().zip(p).zip(&e.displacement) {
                *v = p + rate;
            }
            e.modal_velocity.copy_from_slice(&e.velocity);
            return;
        };
        add_product(&e.forward_s, modes, negative.as_slice(), &mut e.modal_velocity);
        manifold.substitute_back(&e.place, &mut e.modal_velocity);
        for ((rate, p), v) in e.displacement.iter_mut().zip(p).zip(&e.modal_velocity) {
            *rate = v - p;
        }
        manifold.go_along(&e.modal_velocity, &mut e.place, &mut e.velocity);
    }

    /// Σ ω_iω_j (c_ij + N_ij z) − Σ ω_i G_i ż, which of a locked body has p for ż.
    #[inline(always)]
    fn inertia_forces(&self, e: &mut Evaluation, force: &mut [f64]) {
        let nf = force.len();
        let (pairs, turning) = (self.pairs.len(), self.g_rows.checked_div(nf).unwrap_or(0));
        let mut factors = [0.0; 9];
        for (square, pair) in factors.iter_mut().zip(&self.pairs) {
            *square = spin_product(&e.spin, *pair);
        }
        for (factor, w) in factors[pairs..pairs + turning].iter_mut().zip(e.spin.iter()) {
            *factor = -w;
        }
        if self.g_rows > 0 && !self.locked {
            self.gyroscopic.multiply(&e.velocity, &mut e.products[self.undeformed.len()..]);
        }
        multiply(&e.products[self.s_rows..], nf, &factors[..pairs + turning], force);
    }

    /// Finds S' = G_i ż, a row for each axis.
    pub(crate) fn coupling_rate<'e>(&self, e: &'e mut Evaluation) -> (&'e [f64], &'e mut Vec<f64>) {
        if self.locked && self.g_rows > 0 {
            self.gyroscopic.multiply(&e.velocity, &mut e.coupling_rate);
        }
        (if self.locked { &e.coupling_rate } else { &e.products[self.undeformed.len()..] }, &mut e.change)
    }

    /// p' without its linear part and damping: Dᵀ of the forces on z, Ḋᵀμ and −∂V_n/∂q.
    #[inline(always)]
    fn project_forces(&self, speed: f64, force: Vec<f64>, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else {
            e.momentum = force;
            return;
        };
        manifold.add_projection(&e.place, &force, &mut e.momentum);
        e.force = force;
        self.find_momenta_of_products(speed, e);
        manifold.add_projected_rate(&e.place, &e.momenta_of_products, &mut e.momentum);
        manifold.subtract_force(&e.place, &e.coordinates, &mut e.momentum);
    }

    /// μ of the products.
    #[inline(always)]
    fn find_momenta_of_products(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let momenta = &mut e.momenta_of_products;
        let (modes, size) = (e.modal_velocity.len(), e.velocity.len());
        manifold.momenta_of_products(&e.velocity, momenta);
        for (s, w) in e.products[..self.s_rows].chunks_exact(size).zip(e.spin.iter()) {
            momenta.iter_mut().zip(&s[modes..]).for_each(|(mu, s)| *mu += s * w);
        }
        momenta.iter_mut().zip(self.sliding.iter().skip(modes)).for_each(|(mu, b)| *mu += b * speed);
    }

    /// On a manifold, finds ξ and ν.
    #[inline(always)]
    pub(crate) fn find_in_shapes(&self, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let [xi, nu, _] = &mut e.in_shapes;
        manifold.in_shapes(&e.coordinates, xi);
        manifold.in_shapes(&e.velocity, nu);
    }

    /// Adds S ω + b v.
    fn add_rigid_momenta(&self, s_ext: &[f64], spin: &Vector3<f64>, speed: f64, mu: &mut [f64]) {
        for (s, w) in s_ext.chunks_exact(mu.len().max(1)).zip(spin.iter()) {
            mu.iter_mut().zip(s).for_each(|(mu, s)| *mu += s * w);
        }
        mu.iter_mut().zip(&self.sliding).for_each(|(mu, b)| *mu += b * speed);
    }

    /// Takes a state past a jump of the speed of the drive at its time. The drive does its impulse times the mean of the
    /// speeds.
    pub(crate) fn pass_jump(&self, state: &mut ConservativeState, e: &mut Evaluation) -> Result<(), RateError> {
        if self.drive.is_none() {
            return Ok(());
        }
        // The corner itself is where it is but for rounding.
        let aside = 1e-12 * state.time.abs();
        let on_side =
            |state: &ConservativeState, branch_time: f64, e: &mut Evaluation| -> Result<[f64; 2], RateError> {
                let (q, p) = (&state.modal_displacement, &state.modal_momentum);
                self.evaluate([state.time, branch_time], &state.attitude, &state.slow, q, p, e)?;
                Ok([e.driven_speed, e.driven_momentum])
            };
        let [after, _] = on_side(state, state.time + aside, e)?;
        let [before, held] = on_side(state, state.time - aside, e)?;
        let jump = after - before;
        let push = state.modal_momentum.iter_mut().zip(&e.drive_stress);
        push.for_each(|(p, k_q)| *p += jump * k_q);
        let [_, given] = on_side(state, state.time + aside, e)?;
        state.slow[part::WORK] += 0.5 * (before + after) * (given - held);
        Ok(())
    }

    /// Adds the linear part of the modes to an evaluation: q' += p, p' −= Λq + Dp.
    pub(crate) fn add_linear(&self, q: &[f64], p: &[f64], e: &mut Evaluation) {
        for k in 0..q.len() {
            e.displacement[k] += p[k];
            e.momentum[k] += self.linear_rate(k, q[k], p[k]);
        }
    }

    /// −Λq − Dp
    pub(crate) fn linear_rate(&self, k: usize, q: f64, p: f64) -> f64 {
        let omega = self.circular_frequencies[k];
        -(omega * omega * q + self.damping[k] * p)
    }
}

/// How the origin moves, and what the body turns about.
fn degrees_of_freedom(
    body: &ReducedBody,
    effects: &EffectMap<bool>,
    driven: Option<DrivenMotion>,
) -> (Translation, Vec<Vector3<f64>>) {
    let (translation, axes) = match driven {
        Some(DrivenMotion::Turn { axis }) => (Translation::None, vec![axis]),
        Some(DrivenMotion::Slide { direction }) => (Translation::Driven(direction), Vec::new()),
        None => {
            let translation = match body.motion.translations() {
                [] => Translation::None,
                [direction] => Translation::Along(*direction),
                _ => Translation::Free,
            };
            (translation, body.motion.rotations().to_vec())
        }
    };
    let is_driven = driven.is_some();
    (
        if effects[Effect::Translation] || is_driven { translation } else { Translation::None },
        if effects[Effect::Rotation] || is_driven { axes } else { Vec::new() },
    )
}

fn below_one_another(matrices: &[Mat<f64>]) -> BlockedMatrix {
    let parts: Vec<_> = matrices.iter().map(Mat::as_ref).collect();
    BlockedMatrix::below_one_another(&parts)
}

/// A matrix in the axes of rotation, 1 on the diagonal of those that are missing.
fn along_axes(axes: &[Vector3<f64>], matrix: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| match (axes.get(i), axes.get(j)) {
        (Some(a), Some(b)) => a.dot(&(matrix * b)),
        _ => f64::from(u8::from(i == j)),
    })
}

/// What ω_iω_j and ω_jω_i come to together in a sum over all pairs.
fn spin_product(spin: &Vector3<f64>, (i, j): (usize, usize)) -> f64 {
    let product = spin[i] * spin[j];
    if i == j { product } else { 2.0 * product }
}

/// The part of a vector along a unit vector.
fn along(unit: &Vector3<f64>, vector: &Vector3<f64>) -> Vector3<f64> {
    unit * unit.dot(vector)
}
