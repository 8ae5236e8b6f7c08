//! The state that linear equations are about.

/// The state that equations are about.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time of the run.
    pub time: f64,
    /// Angular velocity, global.
    pub omega_global: [f64; 3],
    /// Number of coordinates that deform nothing.
    pub rigid: usize,
    /// Reservations about it.
    pub warnings: Vec<String>,
}
