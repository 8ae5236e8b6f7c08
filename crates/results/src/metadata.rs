//! What a results file says about the run as a whole.

/// Labels of the units; any consistent set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units {
    /// For instance "mm".
    pub length: String,
    /// For instance "Mg".
    pub mass: String,
    /// For instance "s".
    pub time: String,
}

/// Rigid-body and modal properties of the body, in its undeformed state.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyProperties {
    /// Total mass.
    pub mass: f64,
    /// Centre of mass in the mesh's coordinates.
    pub center_of_mass: [f64; 3],
    /// Inertia about the centre of mass, body axes, row by row.
    pub inertia: [[f64; 3]; 3],
    /// Natural frequencies of the flexible modes, in cycles per unit of time (Hz if that is s).
    pub frequencies: Vec<f64>,
    /// Damping ratios of the flexible modes, as many as frequencies.
    pub damping_ratios: Vec<f64>,
}

/// Everything in a results file that does not change with time.
#[derive(Debug, Clone, PartialEq)]
pub struct Metadata {
    /// Title of the scene.
    pub title: String,
    /// Labels of the units.
    pub units: Units,
    /// Name of the formulation of the equations of motion.
    pub formulation: String,
    /// Name of the time-integration scheme.
    pub scheme: String,
    /// Length of its steps, where they have one.
    pub step: Option<f64>,
    /// Relative error allowed in a step, where that sets its length.
    pub tolerance: Option<f64>,
    /// Version of the program that made the run.
    pub program_version: String,
    /// A check sum of all that determines the motion, the files that the scene names included: where it is another, a
    /// run cannot go on.
    pub fingerprint: u32,
    /// The scene file, word for word.
    pub scene_text: String,
    /// Where the scene file was, so that the files that it names can be found again; empty if nowhere.
    pub scene_file: String,
    /// The body.
    pub body: BodyProperties,
    /// Names of the points whose motion is stored, in the order of [`Sample::points`](crate::Sample::points).
    pub point_names: Vec<String>,
}
