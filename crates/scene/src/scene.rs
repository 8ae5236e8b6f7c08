//! What a scene says, as plain data.
//!
//! All quantities are in one consistent set of units of the user's choice (mm, Mg, s, N, MPa or
//! m, kg, s, N, Pa, …); nothing is converted. Positions are in the axes of the mesh, which are
//! the body axes; at t = 0 the body axes are the global ones.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

use crate::constraint::Constraint;
use crate::effects::Effects;
use crate::load::Load;
use crate::modes::Modes;

/// A scene that obeys every rule which needs no mesh: all numbers are finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What the run is about, for headings.
    pub title: String,
    /// Labels of the units, for axes and tables.
    pub units: Units,
    /// The body.
    pub body: Body,
    /// The modes kept and their damping.
    pub modes: Modes,
    /// Which effects are simulated.
    pub effects: Effects,
    /// The reference points of the floating frame; `None` leaves the choice to the program.
    pub frame: Option<Frame>,
    /// The state at t = 0.
    pub initial: Initial,
    /// What holds the body; `None` is a free one.
    pub constraint: Option<Constraint>,
    /// Any number of loads, in the order of the file.
    pub loads: Vec<Load>,
    /// How far and how to step.
    pub time: Time,
    /// What is written out.
    pub output: Output,
    /// The scene file, as it was named to [`Scene::read`] or [`Scene::parse`].
    pub path: PathBuf,
    /// The text of the scene file, for the results file and for the places of later errors.
    pub source: String,
}

/// Labels of the units. The program never converts: they are shown, not used.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Label of the unit of length, e.g. `mm`.
    pub length: String,
    /// Label of the unit of mass, e.g. `Mg`.
    pub mass: String,
    /// Label of the unit of time, e.g. `s`.
    pub time: String,
}

/// The body: the scene has exactly one of the two keys.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// Key `mesh`: a body that can deform.
    Meshed(MeshedBody),
    /// Key `rigid`: mass properties without a mesh.
    Rigid(RigidBody),
}

/// A body of finite elements.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshedBody {
    /// The mesh file, already resolved against the folder of the scene file.
    pub mesh: PathBuf,
    /// What the elements are made of.
    pub materials: Materials,
    /// Masses added at points; default none.
    pub point_masses: Vec<PointMass>,
}

/// A rigid body without a mesh. Its axes are those of the scene's positions ("mesh axes" elsewhere).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// Mass > 0.
    pub mass: f64,
    /// Centre of mass, length, body axes.
    pub center_of_mass: [f64; 3],
    /// Inertia tensor about the centre of mass, mass · length², body axes: symmetric, its principal moments positive
    /// and none above the sum of the others. The file may give it about another point.
    pub inertia: [[f64; 3]; 3],
}

/// What the elements are made of: the scene has exactly one of the two keys.
#[derive(Clone, Debug, PartialEq)]
pub enum Materials {
    /// Key `material`: one material for the whole mesh.
    Whole(Material),
    /// Key `materials`: by the name of the physical group in the mesh; at least one.
    ByGroup(BTreeMap<String, Material>),
}

/// A linear elastic, isotropic material.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E > 0, force per area.
    pub young_modulus: f64,
    /// Poisson's ratio, −1 < ν < 0.5.
    pub poisson_ratio: f64,
    /// Density > 0, mass per volume.
    pub density: f64,
}

/// A mass without extent, added to the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointMass {
    /// Position, length, mesh axes.
    pub at: [f64; 3],
    /// Mass > 0.
    pub mass: f64,
    /// Radius > 0, length, of the ball whose nodes share the mass; `None` puts it on the node
    /// at `at`.
    pub spread: Option<f64>,
}

/// The paper's reference points: three points of the body that are not on one line.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
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

/// The state at t = 0, where the body axes are the global ones. Every key is optional; default 0.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Initial {
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

/// How far and how to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// Time > 0 at the end of the run, which starts at 0.
    pub end: f64,
    /// What sets the length of a step.
    pub stepping: Stepping,
    /// The equations of motion and the way from one step to the next.
    pub method: Method,
}

/// What sets the length of a step: the scene has exactly one of the two keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// Key `step`: steps of at most this length, 1e-12 end ≤ step ≤ end.
    Step(f64),
    /// Key `tolerance`: what the estimated relative errors of all steps may sum to, 0 < tolerance < 1. Only with
    /// [`Method::Rkmk4`] and [`Method::Exponential`].
    Tolerance(f64),
}

/// The equations of motion and the way from one step to the next: keys `formulation` and `scheme`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Formulation and scheme of the paper, Eqs. 36–40.
    Paper,
    /// Formulation of the paper, in the limit of short steps, by the scheme `rkmk4`.
    PaperRkmk4,
    /// Conservative formulation, scheme `rkmk4`: Runge–Kutta–Munthe-Kaas of fourth order.
    Rkmk4,
    /// Conservative formulation, scheme `exponential`: Krogstad's ETD-RK4. The default.
    Exponential,
    /// Conservative formulation, scheme `strang`: a splitting of second order.
    Strang,
}

impl Method {
    /// Whether the formulation is the paper's, which has the effects that it has.
    pub fn is_of_paper(self) -> bool {
        matches!(self, Self::Paper | Self::PaperRkmk4)
    }
}

/// What is written out.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// When a state is written, besides the first and the last.
    pub rows: Rows,
    /// Points whose motion is written: name, and position (length, mesh axes); default none.
    /// A name is not empty, `.` or `..` and has no `/` and no control character, since it names
    /// a group of the results file.
    pub points: BTreeMap<String, [f64; 3]>,
}

/// When a state is written: the scene has at most one of the two keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rows {
    /// Key `every`: after every so many steps, ≥ 1. Only with [`Stepping::Step`], where 1 is the
    /// default.
    EverySteps(u64),
    /// Key `interval`: at the multiples of this time, 1e-12 end ≤ interval ≤ end. With
    /// [`Stepping::Tolerance`] the default is a 500th of the end.
    Interval(f64),
}
