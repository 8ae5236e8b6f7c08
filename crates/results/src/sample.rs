//! The state of the body at one output time.

/// The motion of one point of the body, all in global components.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointSample {
    /// Displacement from the point's place at t = 0 in the undeformed body, rigid motion included.
    pub displacement: [f64; 3],
    /// Velocity.
    pub velocity: [f64; 3],
    /// Acceleration, deformation included.
    pub acceleration: [f64; 3],
    /// The part of the acceleration that belongs to the rigid motion alone.
    pub rigid_acceleration: [f64; 3],
}

/// One row of every time history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a> {
    /// Time.
    pub time: f64,
    /// Unit quaternion (w, x, y, z) that takes body components to global ones.
    pub attitude: [f64; 4],
    /// Position of the centre of mass, global.
    pub position: [f64; 3],
    /// Velocity of the centre of mass, global.
    pub velocity: [f64; 3],
    /// Angular velocity, body axes.
    pub angular_velocity: [f64; 3],
    /// Angular acceleration, body axes.
    pub angular_acceleration: [f64; 3],
    /// Coordinates of the mass-normalised flexible modes (nf).
    pub modal_displacement: &'a [f64],
    /// Their rates (nf).
    pub modal_velocity: &'a [f64],
    /// Kinetic energy.
    pub kinetic_energy: f64,
    /// Strain energy.
    pub strain_energy: f64,
    /// Work of the loads since t = 0.
    pub work: f64,
    /// Energy that damping has taken since t = 0.
    pub dissipation: f64,
    /// Kinetic + strain energy − work + dissipation: constant in exact motion.
    pub energy_balance: f64,
    /// Linear momentum, global.
    pub linear_momentum: [f64; 3],
    /// Angular momentum about the centre of mass, global.
    pub angular_momentum: [f64; 3],
    /// Linear momentum less the impulse of the loads since t = 0, global: constant in exact motion.
    pub linear_balance: [f64; 3],
    /// Angular momentum less the angular impulse of the loads since t = 0, both about the centre of
    /// mass, global: constant in exact motion.
    pub angular_balance: [f64; 3],
    /// The points, in the order of [`Metadata::point_names`](crate::Metadata::point_names).
    pub points: &'a [PointSample],
}
