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
use rigid_kin::{f_inverse, transformation_matrix};

use crate::column_major::{columns, dot, multiply};
use crate::effect::{Effect, EffectMap};
use crate::error::{RateError, SetupError, StepError};
use crate::four::{Four, Group, Padded, WIDTH};
use crate::initial::Initial;
use crate::load::{Applied, Coordinates, Kinematics, SharedLoad};
use crate::manifold::{Manifold, ManifoldPoint};
use crate::motion::CenterOfMass;
use crate::own_coupling::own_coupling;
use crate::physics::{Drive, DrivenMotion, Physics};
use crate::reaction::Held;
use crate::side_by_side::{Lists, add_combined, combine, dots, locked_dots, own_products, side_by_side};
use crate::spin_stiffness::SpinStiffness;
use crate::stack::{Places, Stack};
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
    /// They as columns; zeros for those that are missing.
    pub(crate) axis_columns: Matrix3<f64>,
    /// Whether the turning is driven.
    pub(crate) turn_driven: bool,
    pub(crate) drive: Option<Drive>,
    /// J₀ in the axes of rotation; 1 on the diagonal of axes that are missing.
    inertia: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    /// ω_k of the flexible modes.
    pub(crate) circular_frequencies: Vec<f64>,
    pub(crate) damping_ratios: Vec<f64>,
    /// Λ, the squares of ω_k.
    pub(crate) stiffness: Vec<f64>,
    /// Largest of ω_k and 2 ζ_k ω_k.
    fastest_rate: f64,
    /// 2 ζ_k ω_k.
    damping: Padded,
    damped: bool,
    /// ij of the terms of the inertia that follow the deformation; empty where none does.
    pub(crate) pairs: Vec<(usize, usize)>,
    /// Whether the equations are those of the locked inertia, which only momenta enter: of a body that turns freely, with
    /// Coriolis terms, inertia that follows its deformation, and no large modes.
    pub(crate) locked: bool,
    /// S and c_ij + N_ij q of the undeformed body, side by side: b_i of driven axes or zeros, then the c_ij of `pairs`.
    undeformed: Vec<Group>,
    /// b of a driven translation (nf).
    pub(crate) sliding: Vec<f64>,
    /// Lists of S: one for each axis, or none where it is zero.
    pub(crate) s_count: usize,
    /// Number of the G_i: as that of the lists of S, or none without Coriolis terms.
    pub(crate) g_count: usize,
    /// The G_i.
    gyroscopic: Stack,
    /// The G_i, then the N_ij, less by K_ij and of a `locked` body more by ½ (G_iG_j + G_jG_i).
    matrices: Stack,
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

/// Where the rates are asked for, the rates without the linear part of the modes, and what was found on the way to them.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    /// q and p (nf).
    pub q: Padded,
    pub p: Padded,
    pub slow: Slow,
    /// q' − p = −S ω (nf).
    pub displacement: Padded,
    /// p' + Λq + D p (nf).
    pub momentum: Padded,
    /// S_i, c_ij + N_ij z, and G_i ż or, of a locked body, G_i p: side by side.
    pub products: Vec<Group>,
    /// G_i ż of a locked body, side by side: for its accelerations only.
    pub coupling_rate: Vec<Group>,
    /// q̇ (nf).
    pub modal_velocity: Padded,
    /// On a manifold, z and ż: else they are q and q̇.
    coordinates: Padded,
    velocity: Padded,
    /// On a manifold, ξ, ν and ν' in the extended shapes, and forces there and on z.
    pub in_shapes: [Vec<f64>; 3],
    force_in_shapes: Vec<f64>,
    force: Padded,
    /// Momenta of the products in z.
    pub momenta_of_products: Vec<f64>,
    /// The place on the manifold. There, with the Cholesky factor M = L Lᵀ, are S and L⁻¹S (a list for each axis), and b of a
    /// driven translation.
    pub place: ManifoldPoint,
    pub s: Vec<Padded>,
    pub forward_s: Vec<Padded>,
    pub modal_sliding: Vec<f64>,
    /// q̈ and what it is made of.
    pub acceleration: Padded,
    pub change: Padded,
    /// What z̈ has without q̈, on a manifold.
    pub curvature: Padded,
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
    /// Sᵀp of a locked body.
    s_by_momentum: Vector3<f64>,
}

/// The rates of a state, in the widest vectors that the processor has.
struct Rates<'a> {
    body: &'a ConservativeBody,
    times: [f64; 2],
    first_attitude: &'a Matrix3<f64>,
    slow: &'a Slow,
    e: &'a mut Evaluation,
}

impl WithSimd for Rates<'_> {
    type Output = Result<(), RateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { body, times, first_attitude, slow, e } = self;
        body.find_rates(simd, times, first_attitude, slow, e)
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
        let turning = if size > 0 { axes.len() } else { 0 };
        let g_count = if effects[Effect::Coriolis] { turning } else { 0 };
        let s_count = if effects[Effect::Coriolis] || turn_driven { turning } else { 0 };
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
        let gyroscopic: Vec<Mat<f64>> = axes[..g_count].iter().map(gyroscopic).collect();
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
        let of_axis = |axis: &Vector3<f64>| match turn_driven {
            true => along(axis, &body.rotation_first),
            false => vec![0.0; size],
        };
        let of_pair = |weights: &[f64; 6]| {
            let of_shape = |k: usize| weights.iter().zip(&body.inertia_first).map(|(w, c)| w * c[k]).sum();
            list_on_coordinates((0..nf).map(of_shape).collect())
        };
        let undeformed: Vec<Vec<f64>> =
            axes[..s_count].iter().map(of_axis).chain(pair_weights.iter().map(of_pair)).collect();
        let rates = modes.circular_frequencies.iter().chain(&damping);
        Ok(Self {
            mass: body.mass,
            origin: body.origin,
            center: CenterOfMass::new(body),
            inverse_inertia: inertia.try_inverse().unwrap_or_else(Matrix3::zeros),
            inertia,
            circular_frequencies: modes.circular_frequencies.clone(),
            damping_ratios: damping_ratios.to_vec(),
            stiffness: modes.circular_frequencies.iter().map(|omega| omega * omega).collect(),
            fastest_rate: rates.copied().fold(0.0, f64::max),
            damped: damping.iter().any(|d| *d > 0.0),
            damping: Padded::from_slice(&damping),
            pairs,
            locked,
            undeformed: side_by_side(&undeformed),
            sliding: match translation {
                Translation::Driven(direction) => along(&direction, &body.translation_first),
                _ => Vec::new(),
            },
            translation,
            axis_columns: Matrix3::from_fn(|i, k| axes.get(k).map_or(0.0, |axis| axis[i])),
            axes,
            turn_driven,
            drive: drive.clone(),
            s_count,
            g_count,
            own_coupling: coupling,
            matrices: Stack::new(&gyroscopic.iter().chain(&second).cloned().collect::<Vec<_>>()),
            gyroscopic: Stack::new(&gyroscopic),
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

    /// Whether what acts on the body does the same at a time by the branches that hold at two branch times, whenever it is
    /// asked.
    pub(crate) fn acts_alike(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.drive.is_none() && self.loads.iter().all(|load| load.is_same(time, branch_times))
    }

    /// Numbers in the matrices that an evaluation reads: what an effect that is off does not cost.
    pub fn matrix_entries(&self) -> usize {
        let of_loads: usize = self.loads.iter().map(|load| load.matrix_entries()).sum();
        self.matrices.len() + self.drive_stiffness.len() + of_loads
    }

    pub(crate) fn evaluation(&self) -> Evaluation {
        let (modes, nf) = (self.flexible(), self.coordinates());
        let lists = Padded::zeros;
        let on_manifold = |n: usize| if self.manifold.is_some() { n } else { 0 };
        let groups = |lists: usize, n: usize| vec![[0.0; WIDTH]; lists * n.div_ceil(WIDTH)];
        let mut products = groups(self.lists(), nf);
        // S stays as it is without Coriolis terms.
        for (products, undeformed) in products
            .chunks_exact_mut(self.lists().max(1))
            .zip(self.undeformed.chunks_exact(self.lists_of_undeformed().max(1)))
        {
            products[..undeformed.len()].copy_from_slice(undeformed);
        }
        Evaluation {
            q: lists(modes),
            p: lists(modes),
            slow: Slow::zeros(),
            displacement: lists(modes),
            momentum: lists(modes),
            products,
            coupling_rate: groups(if self.locked { self.g_count } else { 0 }, nf),
            modal_velocity: lists(modes),
            coordinates: lists(on_manifold(nf)),
            velocity: lists(on_manifold(nf)),
            in_shapes: std::array::from_fn(|_| vec![0.0; on_manifold(self.extended())]),
            force_in_shapes: vec![0.0; on_manifold(self.extended())],
            force: lists(on_manifold(nf)),
            momenta_of_products: vec![0.0; on_manifold(nf - modes)],
            acceleration: lists(modes),
            change: lists(nf),
            curvature: lists(on_manifold(nf)),
            place: self.manifold.as_ref().map_or_else(ManifoldPoint::default, Manifold::place),
            s: vec![lists(modes); on_manifold(self.s_count)],
            forward_s: vec![lists(modes); on_manifold(self.s_count)],
            modal_sliding: vec![0.0; if self.sliding.is_empty() { 0 } else { on_manifold(modes) }],
            drive_stress: vec![0.0; if self.drive_stiffness.is_empty() { 0 } else { modes }],
            spin: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            driven_speed: 0.0,
            driven_momentum: 0.0,
            drive_effort: 0.0,
            load_force: Vector3::zeros(),
            load_moment: Vector3::zeros(),
            locked_inertia: self.inertia,
            s_by_momentum: Vector3::zeros(),
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
        e.q.copy_from_slice(&initial.modal_displacement);
        let scalar = pulp::Scalar::new();
        self.deform(scalar, &mut e);
        let speed = self.drive.as_ref().map_or(0.0, |drive| drive.speed_at(0.0, 0.0));
        let mut spin = Vector3::zeros();
        for (w, axis) in spin.iter_mut().zip(&self.axes) {
            *w = if self.turn_driven { speed } else { axis.dot(&initial.omega) };
        }
        self.extend_rate(&initial.modal_velocity, &mut e);
        let s_by_velocity = self.s_products(scalar, &e.products, self.velocity_of_coordinates(&e).groups());
        let pi: Vector3<f64> = self.deformed_inertia(scalar, &e) * spin + s_by_velocity;
        let mut mu = match &self.manifold {
            Some(manifold) => {
                let Evaluation { velocity, in_shapes: [_, in_shapes, _], .. } = &mut e;
                manifold.in_shapes(velocity, in_shapes);
                let mut mu = vec![0.0; velocity.len()];
                manifold.add_from_shapes(in_shapes, &mut mu);
                mu
            }
            None => e.modal_velocity.to_vec(),
        };
        let mut s_by_spin = Padded::zeros(mu.len());
        combine(scalar, self.s_lists(&e.products), &spin.as_slice()[..self.s_count], s_by_spin.groups_mut());
        mu.iter_mut().zip(&*s_by_spin).for_each(|(mu, s)| *mu += s);
        mu.iter_mut().zip(&self.sliding).for_each(|(mu, b)| *mu += b * speed);
        let momentum = match &self.manifold {
            Some(manifold) => {
                let mut momentum = vec![0.0; self.flexible()];
                manifold.add_projection(&e.place, &mu, &mut momentum);
                momentum
            }
            None => mu,
        };
        let pi = Vector3::from_fn(|k, _| if k < self.axes.len() { pi[k] } else { 0.0 });
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
        self.evaluate_at(state, state.time, &mut e)?;
        Ok(MotionState {
            time: state.time,
            attitude: state.attitude,
            origin_global: state.origin_global(),
            velocity_global: get(&e.slow, part::POSITION),
            omega_body: e.omega_body,
            modal_displacement: state.modal_displacement.clone(),
            modal_velocity: e.modal_velocity.to_vec(),
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
        self.evaluate_at(state, branch_time, &mut e).map_err(|error| error.in_step(state.time, 0.0))?;
        self.add_linear(&mut e);
        Ok(ConservativeRates {
            omega_body: e.omega_body,
            velocity_global: get(&e.slow, part::POSITION),
            force_global: get(&e.slow, part::MOMENTUM),
            moment_body: get(&e.slow, part::PI),
            modal_velocity: e.displacement.to_vec(),
            modal_force: e.momentum.to_vec(),
        })
    }

    /// q̇ and ż.
    fn extend_rate(&self, rate: &[f64], e: &mut Evaluation) {
        e.modal_velocity.copy_from_slice(rate);
        if let Some(manifold) = &self.manifold {
            manifold.go_along(rate, &mut e.place, &mut e.velocity);
        }
    }

    /// Number of the lists of products.
    pub(crate) fn lists(&self) -> usize {
        self.lists_of_undeformed() + self.g_count
    }

    /// Number of the lists of products that the undeformed body has.
    fn lists_of_undeformed(&self) -> usize {
        self.s_count + self.pairs.len()
    }

    /// S among the products.
    pub(crate) fn s_lists<'e>(&self, products: &'e [Group]) -> Lists<'e> {
        Lists { groups: products, width: self.lists(), first: 0 }
    }

    /// c_ij + N_ij z among the products.
    pub(crate) fn pair_lists<'e>(&self, products: &'e [Group]) -> Lists<'e> {
        Lists { first: self.s_count, ..self.s_lists(products) }
    }

    /// Sᵀx, with S on z.
    #[inline(always)]
    pub(crate) fn s_products<S: Simd>(&self, simd: S, products: &[Group], x: &[Group]) -> Vector3<f64> {
        self.axis_products(simd, self.s_lists(products), x)
    }

    /// list_iᵀx in the entry i, of lists for each axis.
    #[inline(always)]
    pub(crate) fn axis_products<S: Simd>(&self, simd: S, lists: Lists<'_>, x: &[Group]) -> Vector3<f64> {
        match self.s_count {
            0 => Vector3::zeros(),
            1 => Vector3::new(dots::<S, 1>(simd, lists, x)[0], 0.0, 0.0),
            _ => Vector3::from(dots::<S, 3>(simd, lists, x)),
        }
    }

    /// Σ_ij list_ijᵀx in the entries ij and ji, of lists for each pair.
    #[inline(always)]
    pub(crate) fn pair_products<S: Simd>(&self, simd: S, lists: Lists<'_>, x: &[Group]) -> Matrix3<f64> {
        match self.pairs.len() {
            0 => Matrix3::zeros(),
            1 => Matrix3::from_diagonal(&Vector3::new(dots::<S, 1>(simd, lists, x)[0], 0.0, 0.0)),
            _ => symmetric::of_pairs(&dots::<S, 6>(simd, lists, x)),
        }
    }

    /// ż.
    pub(crate) fn velocity_of_coordinates<'e>(&self, e: &'e Evaluation) -> &'e Padded {
        if self.manifold.is_some() { &e.velocity } else { &e.modal_velocity }
    }

    /// z, and there S, c_ij + N_ij z, K q and the locked inertia; of a locked body G_i p and Sᵀp as well.
    #[inline(always)]
    fn deform<S: Simd>(&self, simd: S, e: &mut Evaluation) {
        if let Some(manifold) = &self.manifold {
            manifold.go(&e.q, &mut e.place, &mut e.coordinates);
        }
        if !self.drive_stiffness.is_empty() {
            multiply(&self.drive_stiffness, e.q.len(), &e.q, &mut e.drive_stress);
        }
        let Evaluation { products, coordinates, q, p, .. } = e;
        if products.is_empty() {
            return;
        }
        let z = if self.manifold.is_some() { coordinates.groups() } else { q.groups() };
        let width = self.lists();
        if self.locked {
            let both = [z, p.groups()];
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

    /// (J − SᵀS)⁻¹ x in the axes of rotation.
    #[inline(always)]
    pub(crate) fn solve_locked(&self, e: &Evaluation, x: &Vector3<f64>) -> Result<Vector3<f64>, RateError> {
        if e.products.is_empty() {
            return Ok(self.inverse_inertia * x);
        }
        let solution = symmetric::solve(&e.locked_inertia, x);
        if solution.sum().is_finite() { Ok(solution) } else { Err(RateError::Inertia) }
    }

    /// All rates at time `t` and the q and p of `e`, with the rotation vector counted from the attitude of which this is the
    /// transformation matrix. Loads and drives follow the branches of their histories that hold at `branch_time`.
    pub(crate) fn evaluate(
        &self,
        times: [f64; 2],
        first_attitude: &Matrix3<f64>,
        slow: &Slow,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        Arch::new().dispatch(Rates { body: self, times, first_attitude, slow, e })
    }

    /// All rates of a state.
    pub(crate) fn evaluate_at(
        &self,
        state: &ConservativeState,
        branch_time: f64,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        e.q.copy_from_slice(&state.modal_displacement);
        e.p.copy_from_slice(&state.modal_momentum);
        self.evaluate([state.time, branch_time], &state.attitude.global_to_body(), &state.slow, e)
    }

    #[inline(always)]
    fn find_rates<S: Simd>(
        &self,
        simd: S,
        [t, branch_time]: [f64; 2],
        first_attitude: &Matrix3<f64>,
        slow: &Slow,
        e: &mut Evaluation,
    ) -> Result<(), RateError> {
        self.deform(simd, e);
        let (mut speed, mut driven_acceleration) = (0.0, 0.0);
        if let Some(drive) = &self.drive {
            (speed, driven_acceleration) = (drive.speed_at(t, branch_time), drive.acceleration_at(t, branch_time));
        }
        e.driven_speed = speed;
        self.start_velocities(speed, e);
        let pi = get(slow, part::PI);
        if self.turn_driven {
            e.spin = Vector3::new(speed, 0.0, 0.0);
        } else if !self.axes.is_empty() {
            let mut right = pi;
            if self.manifold.is_some() {
                for (i, s) in e.forward_s.iter().enumerate() {
                    right[i] -= dot(s, &e.modal_velocity);
                }
            } else if self.locked {
                right -= e.s_by_momentum;
            } else {
                right -= self.s_products(simd, &e.products, e.p.groups());
            }
            e.spin = self.solve_locked(e, &right)?;
        }
        let w = e.spin;
        e.omega_body = self.axis_columns * w;
        let dissipation = self.find_velocities(simd, speed, e);

        let momentum = get(slow, part::MOMENTUM);
        let velocity = match self.translation {
            Translation::None => Vector3::zeros(),
            Translation::Free | Translation::Along(_) => momentum / self.mass,
            Translation::Driven(direction) => first_attitude.tr_mul(&direction) * speed,
        };
        let theta = get(slow, part::THETA);
        let turning = !self.axes.is_empty();
        let theta_rate =
            if turning { f_inverse(&theta, &e.omega_body).map_err(RateError::Turn)? } else { Vector3::zeros() };
        self.inertia_forces(simd, e);
        let mut pi_rate = if self.axes.len() == 3 { pi.cross(&w) } else { Vector3::zeros() };
        let mut power = 0.0;
        let (mut force, mut angular_impulse) = (Vector3::zeros(), Vector3::zeros());
        if !self.loads.is_empty() {
            let body_from_global =
                if turning { transformation_matrix(&theta) * first_attitude } else { *first_attitude };
            self.find_in_shapes(e);
            let omega_body = e.omega_body;
            let Evaluation { q, modal_velocity, in_shapes: [xi, nu, _], force_in_shapes, momentum, .. } = &mut *e;
            let (coordinates, mut applied);
            let (first, on_manifold) = (6, Some([&**q, &**modal_velocity]));
            if self.manifold.is_some() {
                force_in_shapes.fill(0.0);
                coordinates = Coordinates { first, displacement: xi, velocity: nu, on_manifold };
                applied = Applied::new(coordinates, Vector3::zeros(), force_in_shapes).on_manifold(momentum);
            } else {
                coordinates = Coordinates { first, displacement: q, velocity: modal_velocity, on_manifold: None };
                applied = Applied::new(coordinates, Vector3::zeros(), momentum);
            }
            let motion = Kinematics {
                time: t,
                branch_time,
                body_from_global: &body_from_global,
                origin_global: get(slow, part::POSITION),
                velocity_global: velocity,
                omega_body,
                coordinates,
                unit: false,
            };
            self.loads.iter().for_each(|load| load.apply(&motion, &mut applied));
            let Applied { force_body, moment_body: moment, modal_power, .. } = applied;
            (e.load_force, e.load_moment) = (force_body, moment);
            power = modal_power + moment.dot(&omega_body);
            force = body_from_global.tr_mul(&force_body);
            let components = self.axis_columns.tr_mul(&moment);
            pi_rate += components;
            angular_impulse = body_from_global.tr_mul(&(self.axis_columns * components));
            power += force.dot(&velocity);
            if let Some(manifold) = &self.manifold {
                manifold.add_from_shapes(&e.force_in_shapes, &mut e.force);
            }
        }
        self.project_forces(speed, e);
        e.momentum.iter_mut().zip(&e.drive_stress).for_each(|(rate, k_q)| *rate += driven_acceleration * k_q);
        let force_rate = match self.translation {
            Translation::Free => force,
            Translation::Along(direction) => along(&first_attitude.tr_mul(&direction), &force),
            Translation::None | Translation::Driven(_) => Vector3::zeros(),
        };
        if self.drive.is_some() {
            let force_body = first_attitude * force;
            self.drive_effort(simd, driven_acceleration, &force_body, pi_rate[0], e);
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

    /// On a manifold, puts L⁻¹ (p − b v) into the place of q̇.
    #[inline(always)]
    fn start_velocities(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        e.modal_velocity.copy_from_slice(&e.p);
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
    fn find_velocities<S: Simd>(&self, simd: S, speed: f64, e: &mut Evaluation) -> f64 {
        let Some(manifold) = &self.manifold else {
            if self.sliding.is_empty() {
                return match self.s_count {
                    0 => self.find_modal_velocities::<S, 0>(simd, e),
                    1 => self.find_modal_velocities::<S, 1>(simd, e),
                    _ => self.find_modal_velocities::<S, 3>(simd, e),
                };
            }
            let factors = -e.spin;
            let displacement = e.displacement.groups_mut();
            combine(simd, self.s_lists(&e.products), &factors.as_slice()[..self.s_count], displacement);
            e.displacement.iter_mut().zip(&self.sliding).for_each(|(rate, b)| *rate -= b * speed);
            for ((v, p), rate) in
                e.modal_velocity.groups_mut().iter_mut().zip(e.p.groups()).zip(e.displacement.groups())
            {
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
        for ((rate, p), v) in e.displacement.groups_mut().iter_mut().zip(e.p.groups()).zip(e.modal_velocity.groups()) {
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
        let Evaluation { products, p, displacement, modal_velocity, momentum, .. } = e;
        let mut lists = self.s_lists(products).rows();
        let rates = displacement.groups_mut().iter_mut().zip(modal_velocity.groups_mut());
        let given = p.groups().iter().zip(self.damping.groups());
        for (((rate, v), momentum), (p, damping)) in rates.zip(momentum.groups_mut()).zip(given) {
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
        let Evaluation { momentum, displacement, modal_velocity, .. } = e;
        if !self.damped {
            momentum.fill(0.0);
            return 0.0;
        }
        let (zero, mut dissipation) = (Four::splat(simd, 0.0), Four::splat(simd, 0.0));
        let rates = displacement.groups().iter().zip(modal_velocity.groups());
        for ((momentum, (rate, v)), damping) in momentum.groups_mut().iter_mut().zip(rates).zip(self.damping.groups()) {
            let [damping, v] = [damping, v].map(|group| Four::load(simd, group));
            let of_rate = damping.mul(simd, Four::load(simd, rate));
            zero.sub(simd, of_rate).store(momentum);
            dissipation = damping.mul(simd, v).mul_add(simd, v, dissipation);
        }
        dissipation.sum()
    }

    /// Adds Σ ω_iω_j (c_ij + N_ij z) − Σ ω_i G_i ż, which of a locked body has p for ż, to p' or, on a manifold, puts it
    /// into the forces on z.
    #[inline(always)]
    fn inertia_forces<S: Simd>(&self, simd: S, e: &mut Evaluation) {
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
            add_combined(simd, lists, factors, e.momentum.groups_mut());
        }
    }

    /// Finds S' = G_i ż, the lists side by side.
    #[inline(always)]
    pub(crate) fn coupling_rate<'e, S: Simd>(&self, simd: S, e: &'e mut Evaluation) -> (Lists<'e>, &'e mut Padded) {
        if self.locked && self.g_count > 0 {
            let places = Places { groups: &mut e.coupling_rate, width: self.g_count, first: 0 };
            self.gyroscopic.multiply(simd, e.modal_velocity.groups(), Lists::ZEROS, places);
            return (Lists { groups: &e.coupling_rate, width: self.g_count, first: 0 }, &mut e.change);
        }
        let first = self.lists_of_undeformed();
        (Lists { groups: &e.products, width: self.lists(), first }, &mut e.change)
    }

    /// On a manifold, adds Dᵀ of the forces on z, Ḋᵀμ and −∂V_n/∂q to p'.
    #[inline(always)]
    fn project_forces(&self, speed: f64, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        manifold.add_projection(&e.place, &e.force, &mut e.momentum);
        self.find_momenta_of_products(speed, e);
        manifold.add_projected_rate(&e.place, &e.momenta_of_products, &mut e.momentum);
        manifold.subtract_force(&e.place, &e.coordinates, &mut e.momentum);
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
    pub(crate) fn find_in_shapes(&self, e: &mut Evaluation) {
        let Some(manifold) = &self.manifold else { return };
        let [xi, nu, _] = &mut e.in_shapes;
        manifold.in_shapes(&e.coordinates, xi);
        manifold.in_shapes(&e.velocity, nu);
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
                self.evaluate_at(state, branch_time, e)?;
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
    pub(crate) fn add_linear(&self, e: &mut Evaluation) {
        for k in 0..e.q.len() {
            e.displacement[k] += e.p[k];
            e.momentum[k] += self.linear_rate(k, e.q[k], e.p[k]);
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
