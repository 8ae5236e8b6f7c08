//! A body of a scene, as plain data.
//!
//! All quantities are in one consistent set of units of the user's choice (mm, Mg, s, N, MPa or
//! m, kg, s, N, Pa, …); nothing is converted. Positions are in the axes of the mesh, which are
//! the body axes; at t = 0 the body axes are the global ones.

pub(crate) mod constraint;
pub(crate) mod effects;
pub(crate) mod measured;
pub(crate) mod modes;

use std::collections::BTreeMap;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use dynamics::Method;
use fem_tet10::{Materials, PointMass};
use matrix_import::MatrixFiles;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::body::constraint::Constraint;
use crate::body::effects::Effects;
use crate::body::modes::Modes;
use crate::loads::load::Load;
use crate::shared::Shared;
use crate::tie::marker::Marker;

/// A body of a scene, which obeys every rule that needs no mesh: all numbers are finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name among `bodies`; `None` of the only `body`.
    pub name: Option<String>,
    /// The part of the scene that all bodies share.
    pub shared: Arc<Shared>,
    /// Its mesh, body file, matrices or rigid mass.
    pub source: BodySource,
    /// The modes kept and their damping.
    pub modes: Modes,
    /// Which effects are simulated.
    pub effects: Effects,
    /// The reference points of the floating frame; `None` leaves the choice to the program.
    pub frame: Option<Frame>,
    /// The state at t = 0.
    pub initial: Initial,
    /// The constraint of the body; `None` is a free one.
    pub constraint: Option<Constraint>,
    /// Places with axes, in the order of the file: the ends of joints. Those that its constraints hold come last.
    pub markers: Vec<Marker>,
    /// True if joints, springs or bushings of the scene file hold the body: then it does not move alone.
    pub tied: bool,
    /// Any number of loads, in the order of the file.
    pub loads: Vec<Load>,
    /// The choice of outputs.
    pub output: Output,
    /// The text of a scene of this body alone, for its body file.
    pub text_alone: String,
}

impl Body {
    /// The constraint that its modes respect: beside joints, springs or bushings it is a joint to the ground, and the body has free modes.
    pub fn reduced_constraint(&self) -> Option<&Constraint> {
        self.constraint.as_ref().filter(|_| !self.tied)
    }
}

impl Deref for Body {
    type Target = Shared;

    fn deref(&self) -> &Shared {
        &self.shared
    }
}

/// A change of what is shared is one of this body alone.
impl DerefMut for Body {
    fn deref_mut(&mut self) -> &mut Shared {
        Arc::make_mut(&mut self.shared)
    }
}

/// The source of a body: the scene has exactly one of the keys.
#[derive(Clone, Debug, PartialEq)]
pub enum BodySource {
    /// Key `mesh`: a body that can deform.
    Meshed(MeshedBody),
    /// Key `file`: such a body from its body file.
    File(FileBody),
    /// Key `matrices`: mass and stiffness of a body that can deform, from another program. The files are already resolved
    /// against the folder of the scene file.
    Matrices(MatrixFiles),
    /// Key `rigid`: mass properties without a mesh.
    Rigid(RigidBody),
}

impl BodySource {
    /// The files that it names.
    pub fn files(&self) -> Vec<&Path> {
        match self {
            Self::Meshed(MeshedBody { mesh: file, .. }) | Self::File(FileBody { file, .. }) => vec![file],
            Self::Matrices(matrices) => matrices.list().map(|(_, file)| file).collect(),
            Self::Rigid(_) => Vec::new(),
        }
    }

    /// True if its elements are known, and with them stress and its consequences.
    pub fn has_elements(&self) -> bool {
        matches!(self, Self::Meshed(_) | Self::File(_))
    }

    /// True if its elements are all there is of it: then its motion may bend far.
    pub fn bends_far(&self) -> bool {
        self.not_by_elements().is_none()
    }

    /// The body in words where it is not made of elements alone, so that its motion cannot bend far.
    pub fn not_by_elements(&self) -> Option<&'static str> {
        match self {
            Self::Meshed(meshed) if !meshed.tied_masses.is_empty() => {
                Some("a body with masses beside it (`tied_masses`)")
            }
            Self::Meshed(_) | Self::File(_) => None,
            Self::Matrices(_) => Some("a body of matrices, whose elements are not known"),
            Self::Rigid(_) => Some("a rigid body"),
        }
    }
}

/// A body of finite elements.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshedBody {
    /// The mesh file, already resolved against the folder of the scene file.
    pub mesh: PathBuf,
    /// Key `mesh_size`: the largest size of an element where geometry is meshed, length; `None` leaves it to the mesher.
    pub mesh_size: Option<f64>,
    /// Key `raise_order`: true if straight edges of first-order elements get a node in their middle.
    pub raise_order: bool,
    /// Materials of the elements: key `material` for the whole mesh, or `materials` by the name of the physical group.
    pub materials: Materials,
    /// Masses added at points; default none.
    pub point_masses: Vec<PointMass>,
    /// Masses beside the body that move with some of its nodes; default none.
    pub tied_masses: Vec<TiedMass>,
}

impl MeshedBody {
    /// The way out where masses beside a body cannot be.
    pub const WITHOUT_TIED_MASSES: &str =
        "mesh the masses as parts of the body, or hold rigid bodies of their mass by fixed joints";
}

/// A mass at a point on the body or beside it, which moves with the rigid motion that fits the displacements of some nodes best, Eq. (M19) of
/// `docs/method/modes.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TiedMass {
    /// The point, in the frame of the mesh.
    pub at: [f64; 3],
    /// The mass.
    pub mass: f64,
    /// The nodes: a group of the mesh with three or more that are not on a line, at most 500.
    pub group: String,
}

/// A body from a body file. The file says what it was made of, and what the scene says besides must be the same.
#[derive(Clone, Debug, PartialEq)]
pub struct FileBody {
    /// The body file, already resolved against the folder of the scene file.
    pub file: PathBuf,
    /// The mesh file, already resolved.
    pub mesh: Option<PathBuf>,
    /// As [`MeshedBody::mesh_size`].
    pub mesh_size: Option<f64>,
    /// As [`MeshedBody::raise_order`].
    pub raise_order: bool,
    /// As [`MeshedBody::materials`].
    pub materials: Option<Materials>,
    /// As [`MeshedBody::point_masses`].
    pub point_masses: Option<Vec<PointMass>>,
}

/// A rigid body without a mesh. Its axes are those of the scene's positions ("mesh axes" elsewhere).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// Mass > 0.
    pub mass: f64,
    /// Centre of mass, length, body axes.
    pub center_of_mass: [f64; 3],
    /// Inertia tensor about the centre of mass, mass · length², body axes: symmetric, its principal moments positive
    /// and none above the sum of the others, or zeros for a point mass. The file may give it about another point.
    pub inertia: [[f64; 3]; 3],
}

impl RigidBody {
    /// True if it is a point mass, without moments of inertia.
    pub fn is_point(&self) -> bool {
        self.inertia == [[0.0; 3]; 3]
    }
}

/// The paper's reference points: three points of the body that are not on one line.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Point R, length, mesh axes.
    #[serde(rename = "R")]
    pub r: [f64; 3],
    /// Point P, length, mesh axes.
    #[serde(rename = "P")]
    pub p: [f64; 3],
    /// Point Q, length, mesh axes.
    #[serde(rename = "Q")]
    pub q: [f64; 3],
}

/// The state at t = 0. Every key is optional; default 0.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Initial {
    /// Attitude as a quaternion [w, x, y, z] that takes body components to global ones; its length is made one. Without
    /// it the body axes are along the global ones.
    pub attitude: Option<[f64; 4]>,
    /// Place of the origin of the mesh axes, length, global. Without it the body is where its mesh is, turned about its centre
    /// of mass or the point that is held.
    pub position: Option<[f64; 3]>,
    /// Velocity of the centre of mass, length per time, global.
    pub velocity: [f64; 3],
    /// Angular velocity, radians per time, body axes.
    pub angular_velocity: [f64; 3],
    /// Modal displacements of the flexible modes (mass-normalised), lowest mode first. At most
    /// [`Flexible::most`](crate::Flexible::most) entries; those not given are 0.
    pub modal_displacement: Vec<f64>,
    /// Modal velocities, as [`Initial::modal_displacement`].
    pub modal_velocity: Vec<f64>,
}

/// The choice of outputs of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Points whose motion is written: name, and position (length, mesh axes); default none.
    /// A name is not empty, `.` or `..` and has no `/` and no control character, since it names
    /// a group of the results file.
    pub points: BTreeMap<String, [f64; 3]>,
    /// True if the stress at the points is written, too; default no.
    pub stress: bool,
    /// True if the largest von Mises stress of the whole body among the rows is looked for; default no.
    pub peak_stress: bool,
}

impl Body {
    /// The method by which the body moves: of joints only where joints, springs or bushings hold it.
    pub fn method(&self) -> &Method {
        if self.tied { &self.time.method } else { self.time.method.without_joints() }
    }
}
