//! The state that linear equations are about.

use std::fmt;

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

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&in_words(self.omega_global, self.time))
    }
}

/// The state in words.
pub(super) fn in_words(omega_global: [f64; 3], time: f64) -> String {
    let [x, y, z] = omega_global;
    let motion = match omega_global == [0.0; 3] {
        true => "rest".to_owned(),
        false => format!("a spin of ({x:.6}, {y:.6}, {z:.6}) rad per time, global"),
    };
    if time == 0.0 { motion } else { format!("{motion}, at time {time}") }
}
