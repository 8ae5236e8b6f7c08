//! A body with its loads, as the conservative form has it.

use faer::Mat;
use keys::{Key, Keyed};
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::body::center_of_mass::CenterOfMass;
use crate::body::initial::Initial;
use crate::body::physics::Drive;
use crate::conservative::frame::Frame;
use crate::conservative::manifold::Manifold;
use crate::conservative::reference::Reference;
use crate::conservative::state::BodyList;
use crate::load::SharedLoad;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::four::{Group, Padded};
use crate::matrix::side_by_side::Lists;
use crate::matrix::stack::Stack;
use crate::observation::reaction::Held;
use crate::state::{Layout, State};

/// How the origin moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Translation {
    /// It does not.
    None,
    /// As the momentum takes it.
    Free,
    /// Along a direction, as the momentum takes it.
    Along(Vector3<f64>),
    /// Along a direction, as it is driven.
    Driven(Vector3<f64>),
}

/// The stress of a drive: a unit of its acceleration stiffens the modes by −K, and the deformed body draws it in.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    /// Velocity of the origin and angular velocity by a unit of the drive's speed.
    pub along: [Vector3<f64>; 2],
    /// K q, and K (nf×nf).
    pub momenta: Vec<f64>,
    pub stiffness: Mat<f64>,
}

/// A body with its loads in the conservative form.
#[derive(Debug, Clone)]
pub struct ConservativeBody {
    pub(super) layout: Layout,
    /// Attitude at the beginning: displacements of points are counted from there.
    pub(super) initial_attitude: Attitude,
    pub(super) mass: f64,
    /// Position of the origin at the beginning, global.
    pub(super) origin: Vector3<f64>,
    /// The frame that positions, momenta and work in a state are in.
    pub(crate) frame: Frame,
    pub(super) center: CenterOfMass,
    pub(super) translation: Translation,
    /// Unit vectors that the body turns about: three, one or none.
    pub(crate) axes: Vec<Vector3<f64>>,
    /// They as columns; zeros for those that are missing.
    pub(super) axis_columns: Matrix3<f64>,
    /// True if the turning is driven.
    pub(super) turn_driven: bool,
    pub(crate) drive: Option<Drive>,
    /// J₀ in the axes of rotation; 1 on the diagonal of axes that are missing.
    pub(super) inertia: Matrix3<f64>,
    pub(super) inverse_inertia: Matrix3<f64>,
    /// ω_k of the flexible modes.
    pub(crate) circular_frequencies: Vec<f64>,
    /// The same with the highest of coordinates that are coupled.
    pub(crate) with_highest: Vec<f64>,
    pub(crate) damping_ratios: Vec<f64>,
    /// Number of natural modes; the coordinates after them are those of static shapes.
    pub(crate) natural_modes: usize,
    /// Λ, the squares of ω_k.
    pub(super) stiffness: Vec<f64>,
    /// Largest of these and 2 ζ_k ω_k.
    pub(super) fastest_rate: f64,
    /// 2 ζ_k ω_k.
    pub(super) damping: Padded,
    pub(super) damped: bool,
    /// ij of the terms of the inertia that follow the deformation; empty where none does.
    pub(super) pairs: Vec<(usize, usize)>,
    /// True if the equations are those of the locked inertia, which only momenta enter: for a body that turns freely, with
    /// Coriolis terms, inertia that follows its deformation, and no large modes.
    pub(super) locked: bool,
    /// S and c_ij + N_ij q of the undeformed body, side by side: b_i of driven axes or zeros, then the c_ij of `pairs`.
    pub(super) undeformed: Vec<Group>,
    /// b of a driven translation (nf).
    pub(super) sliding: Vec<f64>,
    /// Lists of S: one for each axis, or none where it is zero.
    pub(super) s_count: usize,
    /// Number of the G_i: as that of the lists of S, or none without Coriolis terms.
    pub(super) g_count: usize,
    /// The G_i.
    pub(super) gyroscopic: Stack,
    /// The G_i, then the N_ij, less by K_ij and of a `locked` body more by ½ (G_iG_j + G_jG_i).
    pub(super) matrices: Stack,
    /// Largest N_ij and G_i that couple each mode to itself and its like (nf).
    pub(crate) own_coupling: Vec<[f64; 2]>,
    /// K of a unit acceleration of what is driven in the modes, column by column, or empty.
    pub(super) drive_stiffness: Option<BlockedMatrix>,
    pub(super) loads: Vec<SharedLoad>,
    /// Manifold of a body with large modes.
    pub(crate) manifold: Option<Manifold>,
    /// Forces of the bent body that the modes are about.
    pub(crate) reference: Option<Reference>,
    /// Constants of a body that something holds.
    pub(super) held: Option<Held>,
}

/// The numbers by which two bodies differ, but for their loads: their rigid inertia, frequencies and damping, and how modes couple.
impl Keyed for ConservativeBody {
    fn key(&self, key: Key) -> Key {
        let Self { mass, inertia, with_highest, damping_ratios, own_coupling, .. } = self;
        let key = key.of("conservative body", 1).with("mass", mass).with("inertia", inertia);
        let key = key.with("frequencies", with_highest).with("damping", damping_ratios);
        key.with("coupling", own_coupling.as_flattened()).with("coordinates", &self.coordinates())
    }
}

impl ConservativeBody {
    /// Number of flexible modes nf.
    pub fn flexible(&self) -> usize {
        self.circular_frequencies.len()
    }

    /// Number of coordinates z: that of the modes, but on a manifold.
    pub(crate) fn coordinates(&self) -> usize {
        self.manifold.as_ref().map_or(self.flexible(), Manifold::size)
    }

    /// Number of extended shapes: that of the modes, but on a manifold.
    pub(super) fn extended(&self) -> usize {
        self.manifold.as_ref().map_or(self.flexible(), |manifold| manifold.body().flexible())
    }

    /// Begins in the attitude and at the position of a motion. A body that moves freely has numbers in a frame that goes along with it.
    #[must_use]
    pub fn beginning_at(mut self, initial: &Initial) -> Self {
        let origin = initial.origin.unwrap_or(self.origin);
        let velocity = if self.translation == Translation::Free { initial.velocity } else { Vector3::zeros() };
        let anchor = Frame::anchor_near(&origin, self.radius_of_gyration());
        self.begin_at(initial.attitude, origin, Frame::new(anchor, velocity, 0.0, origin));
        self
    }

    /// Counts displacements of points from another attitude and position of the origin, and has its numbers in a frame.
    pub(crate) fn begin_at(&mut self, attitude: Attitude, origin_global: Vector3<f64>, frame: Frame) {
        (self.initial_attitude, self.origin, self.frame) = (attitude, origin_global, frame);
    }

    /// The numbers of a state.
    #[inline(always)]
    pub(crate) fn list<'s>(&self, state: &'s State) -> BodyList<&'s [f64]> {
        BodyList { values: &state.values, flexible: self.flexible() }
    }

    /// True if it moves and turns freely and is not driven.
    pub(crate) fn is_free(&self) -> bool {
        self.translation == Translation::Free && self.axes.len() == 3 && self.drive.is_none()
    }

    /// Numbers of the components of π that the body turns freely with: none of a driven one.
    pub(crate) fn free_turns(&self) -> std::ops::Range<usize> {
        0..if self.turn_driven { 0 } else { self.axes.len() }
    }

    /// The motion of its frame that is driven: velocity of the origin and angular velocity, by a unit of the speed.
    pub(crate) fn driven(&self) -> Option<[Vector3<f64>; 2]> {
        match (self.translation, &self.axes[..]) {
            (Translation::Driven(direction), _) => Some([direction, Vector3::zeros()]),
            (_, [axis]) if self.turn_driven => Some([Vector3::zeros(), *axis]),
            _ => None,
        }
    }

    /// The stress of its drive at some modal displacements.
    pub(crate) fn drawn(&self, q: &[f64]) -> Option<Drawn> {
        let (along, of_drive) = (self.driven()?, self.drive_stiffness.as_ref()?);
        let mut momenta = vec![0.0; q.len()];
        of_drive.multiply(q, &mut momenta);
        Some(Drawn { along, momenta, stiffness: of_drive.dense() })
    }

    /// Its mass.
    pub(crate) fn mass(&self) -> f64 {
        self.mass
    }

    /// Its radius of gyration: of J₀ about the origin, √(trace/2m).
    pub(crate) fn radius_of_gyration(&self) -> f64 {
        (0.5 * self.inertia.trace() / self.mass).sqrt()
    }

    /// True if it is a point mass: without moments of inertia it does not turn, and no moment may act on it.
    pub(crate) fn is_point(&self) -> bool {
        self.inertia == Matrix3::zeros()
    }

    /// J₀ about the origin, body axes.
    pub(crate) fn undeformed_inertia(&self) -> &Matrix3<f64> {
        &self.inertia
    }

    /// The numbers of a state, to be changed.
    pub(crate) fn list_mut<'s>(&self, state: &'s mut State) -> BodyList<&'s mut [f64]> {
        BodyList { values: &mut state.values, flexible: self.flexible() }
    }

    /// The loads.
    pub fn loads(&self) -> &[SharedLoad] {
        &self.loads
    }

    /// Numbers in the matrices that an evaluation reads: what an effect that is off does not cost.
    pub fn matrix_entries(&self) -> usize {
        let of_loads: usize = self.loads.iter().map(|load| load.matrix_entries()).sum();
        self.matrices.len() + self.drive_stiffness.as_ref().map_or(0, BlockedMatrix::len) + of_loads
    }

    /// Number of the lists of products.
    pub(super) fn lists(&self) -> usize {
        self.lists_of_undeformed() + self.g_count
    }

    /// Number of the lists of products that the undeformed body has.
    pub(super) fn lists_of_undeformed(&self) -> usize {
        self.s_count + self.pairs.len()
    }

    /// S among the products.
    pub(super) fn s_lists<'e>(&self, products: &'e [Group]) -> Lists<'e> {
        Lists { groups: products, width: self.lists(), first: 0 }
    }

    /// c_ij + N_ij z among the products.
    pub(super) fn pair_lists<'e>(&self, products: &'e [Group]) -> Lists<'e> {
        Lists { first: self.s_count, ..self.s_lists(products) }
    }
}

/// The part of a vector along a unit vector.
pub(super) fn along(unit: &Vector3<f64>, vector: &Vector3<f64>) -> Vector3<f64> {
    unit * unit.dot(vector)
}
