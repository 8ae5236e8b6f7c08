//! Room for the rates of a state, and for what is found on the way to them.

use nalgebra::{Matrix3, Vector3};

use crate::conservative::body::ConservativeBody;
use crate::conservative::manifold::{Manifold, ManifoldPoint};
use crate::conservative::state::BodyList;
use crate::matrix::four::{Group, Padded, WIDTH};

/// Where the rates are asked for, the rates without the linear part of the modes, and what was found on the way to them.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// The place: its attitude is that at the start of the step.
    pub(crate) at: BodyList<Vec<f64>>,
    /// The rates, of q' − p = −S ω and p' + Λq + D p in place of q' and p'.
    pub(crate) rates: BodyList<Vec<f64>>,
    /// S_i, c_ij + N_ij z, and G_i ż or, of a locked body, G_i p: side by side.
    pub(crate) products: Vec<Group>,
    /// G_i ż of a locked body, side by side: for its accelerations only.
    pub(crate) coupling_rate: Vec<Group>,
    /// q̇ (nf).
    pub(crate) modal_velocity: Padded,
    /// On a manifold, z and ż: else they are q and q̇.
    pub(in crate::conservative) coordinates: Padded,
    pub(in crate::conservative) velocity: Padded,
    /// On a manifold, ξ, ν and ν' in the extended shapes, and forces there and on z.
    pub(crate) in_shapes: [Vec<f64>; 3],
    pub(in crate::conservative) force_in_shapes: Vec<f64>,
    pub(in crate::conservative) force: Padded,
    /// Momenta of the products in z.
    pub(crate) momenta_of_products: Vec<f64>,
    /// The place on the manifold. There, with the Cholesky factor M = L Lᵀ, are S and L⁻¹S (a list for each axis), and b of a
    /// driven translation.
    pub(crate) place: ManifoldPoint,
    pub(crate) s: Vec<Padded>,
    pub(crate) forward_s: Vec<Padded>,
    pub(crate) modal_sliding: Vec<f64>,
    /// q̈ and what it is made of.
    pub(crate) acceleration: Padded,
    pub(crate) change: Padded,
    /// Part of z̈ without q̈, on a manifold.
    pub(crate) curvature: Padded,
    /// K q of the stiffness of what is driven (nf).
    pub(crate) drive_stress: Vec<f64>,
    /// Angular velocity, one component for each axis.
    pub(crate) spin: Vector3<f64>,
    pub(crate) omega_body: Vector3<f64>,
    /// Angular velocity or velocity of what is driven; zero without a drive.
    pub(crate) driven_speed: f64,
    /// π of a driven turn or the P of a driven slide, along its axis.
    pub(crate) driven_momentum: f64,
    /// Torque or force of the drive.
    pub(crate) drive_effort: f64,
    /// Resultants of the loads about the origin, body components.
    pub(crate) load_force: Vector3<f64>,
    pub(crate) load_moment: Vector3<f64>,
    /// J − SᵀS.
    pub(crate) locked_inertia: Matrix3<f64>,
    /// Sᵀp of a locked body.
    pub(in crate::conservative) s_by_momentum: Vector3<f64>,
}

impl ConservativeBody {
    pub(in crate::conservative) fn room(&self) -> Evaluation {
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
            at: BodyList { values: self.layout.zeros(), flexible: modes },
            rates: BodyList { values: vec![0.0; self.layout.len()], flexible: modes },
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
            drive_stress: vec![0.0; if self.drive_stiffness.is_some() { modes } else { 0 }],
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

    /// ż.
    pub(in crate::conservative) fn velocity_of_coordinates<'e>(&self, e: &'e Evaluation) -> &'e Padded {
        if self.manifold.is_some() { &e.velocity } else { &e.modal_velocity }
    }
}
