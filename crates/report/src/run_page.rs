//! Contents of a page.

use serde::Serialize;

/// Everything that a page shows, as plain data. The caller chooses the units and names them.
#[derive(Debug, Clone, PartialEq)]
pub struct RunPage {
    /// Title of the run.
    pub title: String,
    /// Name and version of the program that made the run.
    pub program: String,
    /// State of the run: complete or not.
    pub state: RunState,
    /// Names of units.
    pub units: PageUnits,
    /// Lines for the top of the page, such as the time and the scheme.
    pub facts: Vec<Fact>,
    /// Time of each row of the run, increasing.
    pub times: Vec<f64>,
    /// The bodies, at least one.
    pub bodies: Vec<PageBody>,
    /// Courses over the rows.
    pub histories: Vec<PageHistory>,
    /// Balances of energy and momentum.
    pub balances: Vec<PageBalance>,
    /// The scene.
    pub scene: SceneText,
    /// Warnings of the run, each a sentence or more.
    pub warnings: Vec<String>,
    /// The places where the answer may be wrong, the worst first, and what the list does not see.
    pub trust: Trust,
    /// The run as data, of a page that computes.
    pub live: Option<Live>,
    /// Another run beside it.
    pub compared: Option<Compared>,
}

/// How far the answer of a run can be trusted.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Trust {
    /// A line for each place, the worst first; none is not shown.
    pub lines: Vec<PageTrustLine>,
    /// Limits of the list.
    pub unseen: String,
}

/// A place where the answer may be wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageTrustLine {
    /// The place, such as "mesh".
    pub place: String,
    /// The body that it is worst in; empty for all.
    pub body: String,
    /// The error, relative; `None` where it is not known.
    pub error: Option<f64>,
    /// Meaning of the error.
    pub meaning: String,
    /// The way in which it is known; may be empty.
    pub known: String,
    /// Means that would make it smaller, or known; may be empty.
    pub next: String,
}

/// Another run that is shown beside the first: its bodies as ghosts. Its courses are components of the histories.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Its name, such as the name of its file.
    pub name: String,
    /// Time of each of its rows, increasing.
    pub times: Vec<f64>,
    /// Its bodies.
    pub bodies: Vec<PageBody>,
}

/// A run that the page leads on by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Live {
    /// The data of the run, as the program of the page reads them.
    pub run: Vec<u8>,
    /// The bodies, in the order of the page.
    pub bodies: Vec<LiveBody>,
    /// Controls of what may be changed.
    pub controls: Vec<Control>,
    /// Names of the units of force, energy, momentum and angular momentum.
    pub units: [String; 4],
}

/// A body of a run that the page leads on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiveBody {
    /// Its mass.
    pub mass: f64,
}

/// A number of the run that may be changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// Name of the body or the joint that it is of.
    pub group: String,
    /// Its name.
    pub name: String,
    /// Unit; empty for a factor.
    pub unit: String,
    /// How the program of the page knows it.
    pub change: [usize; 3],
    /// Least and greatest value that is offered.
    pub range: [f64; 2],
    /// Value of the recorded run.
    pub recorded: f64,
}

/// A body of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct PageBody {
    /// Its name; that of a single one is not shown.
    pub name: String,
    /// Lines about it, such as its mass and the size of its mesh.
    pub facts: Vec<Fact>,
    /// Surface or nodes of the undeformed body; none where the results file has none.
    pub surface: Option<PageSurface>,
    /// Shapes of the body, in the order of the coordinates.
    pub shapes: Vec<Shape>,
    /// Stresses of the shapes.
    pub stress: Option<PageStress>,
    /// Its rows.
    pub motion: PageMotion,
    /// Which effects were on, and why.
    pub effects: Vec<Effect>,
}

/// State of the run: complete or not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RunState {
    /// It did.
    Complete,
    /// It did not. The words say so, and how to continue it.
    Unfinished(String),
}

/// Names of units, as they stand after a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageUnits {
    /// Unit of lengths, such as mm.
    pub length: String,
    /// Unit of times, such as s.
    pub time: String,
    /// Unit of natural frequencies, such as Hz.
    pub frequency: String,
}

/// A line of the summary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// Its name.
    pub label: String,
    /// Its text.
    pub value: String,
}

impl Fact {
    /// By its name and its text.
    pub fn new(label: &str, value: impl Into<String>) -> Self {
        Self { label: label.to_owned(), value: value.into() }
    }
}

/// Surface of the undeformed body, or its nodes alone where nothing is known of a surface: then there are no triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct PageSurface {
    /// Vertices in the reference shape, body axes, from the origin of the body frame.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles by indices of vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Edges of the outline by indices of vertices.
    pub edges: Vec<[u32; 2]>,
}

/// A shape of the body, which one coordinate of the motion scales.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Name, such as "mode 3" or "static shape of load 1".
    pub name: String,
    /// Kind of the shape.
    pub kind: ShapeKind,
    /// Displacement of each vertex of the surface where the coordinate is 1, body axes. Without a surface it is empty.
    pub displacement: Vec<[f32; 3]>,
}

/// Kind of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShapeKind {
    /// A vibration mode.
    Natural {
        /// Natural frequency, in the unit of frequencies.
        frequency: f64,
        /// Damping ratio.
        damping_ratio: f64,
    },
    /// A static shape: the answer to a load beyond the modes. It has no natural frequency.
    Static,
    /// A shape that a product of coordinates scales, such as the shortening of a bent beam.
    SecondOrder,
}

/// Stresses on the surface: the sum over the shapes, each times its coordinate, and over products of two or three coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct PageStress {
    /// Unit of stress, such as MPa.
    pub unit: String,
    /// For each shape, and then for each product, the stress of each vertex where the coordinate or the product is 1: xx, yy,
    /// zz, xy, yz, zx in body axes.
    pub shapes: Vec<Vec<[f32; 6]>>,
    /// The coordinates of each product, numbered from 0; none where stress is linear in the coordinates.
    pub products: Vec<Vec<usize>>,
}

/// The rows of a body. A vertex X is at `origin` + attitude (X + Σ coordinate × shape).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PageMotion {
    /// Position of the origin of the body frame, global axes.
    pub origins: Vec<[f64; 3]>,
    /// Attitudes as unit quaternions (w, x, y, z), which take body components to global ones.
    pub attitudes: Vec<[f64; 4]>,
    /// Coordinates of the shapes, row after row.
    pub coordinates: Vec<f64>,
}

/// A quantity over the rows of the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct PageHistory {
    /// The group it belongs to, such as "point P1", or "point ring.P1" of one of several bodies. Histories of a group are shown
    /// together.
    pub group: String,
    /// Name, such as "displacement (global)".
    pub name: String,
    /// Unit; empty for a plain number.
    pub unit: String,
    /// The axis of its plot is at least so long: what is less may be rounding. 0 where that is not known.
    pub least_range: f64,
    /// Its components, at least one.
    pub components: Vec<Component>,
}

/// A component of a history.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Name, such as "x"; empty for the only one.
    pub name: String,
    /// Value in each row of the motion.
    pub values: Vec<f64>,
}

/// A balance that holds in exact motion.
#[derive(Debug, Clone, PartialEq)]
pub struct PageBalance {
    /// The group it belongs to, such as the name of a body. Balances of a group are shown together.
    pub group: String,
    /// Name, such as "energy".
    pub name: String,
    /// The law in words.
    pub law: String,
    /// Unit of the terms and of the error.
    pub unit: String,
    /// The axes of its plots are at least so long: what is less may be rounding. 0 where that is not known.
    pub least_range: f64,
    /// The terms.
    pub terms: Vec<Component>,
    /// The imbalance: zero in exact motion. More than one for a vector.
    pub errors: Vec<Component>,
}

/// An effect of the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Effect {
    /// Name.
    pub name: String,
    /// On, off, or other words.
    pub state: String,
    /// The number that decides, in words; may be empty.
    pub measure: String,
    /// The reason.
    pub reason: String,
}

/// The scene as it was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneText {
    /// Name of the file.
    pub file: String,
    /// Its text.
    pub text: String,
}
