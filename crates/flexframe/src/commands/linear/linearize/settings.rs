//! Settings of a linear model.

/// Settings of a linear model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinearSettings {
    /// Angular velocity of the steady spin, global, radians per time, about the center of mass, or the axis of the joint to the ground that a
    /// drive turns; `None` is that which a free body of the scene has at the time, or of the drive of a held body or of that joint.
    pub spin: Option<[f64; 3]>,
    /// Time of the run whose state the model is about; `None` is the beginning.
    pub time: Option<f64>,
    /// True where coordinates that deform nothing are taken out.
    pub without_rigid: bool,
    /// Names of inputs, or beginnings of them; loads and forces at joints where there are none.
    pub inputs: Vec<String>,
    /// Names of outputs, or beginnings of them; points and coordinates of joints where there are none.
    pub outputs: Vec<String>,
}
