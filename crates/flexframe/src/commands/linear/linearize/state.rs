//! The state that linear equations are about.

use std::fmt;

use model::Model;

/// The state that equations are about.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time of the run.
    pub time: f64,
    /// Angular velocity, global.
    pub omega_global: [f64; 3],
    /// Rotors that spin against the others, in words.
    pub rotors: Vec<String>,
    /// Number of coordinates that deform nothing.
    pub rigid: usize,
    /// Damping of the modes, in words.
    pub damping: String,
    /// Reservations about it.
    pub warnings: Vec<String>,
}

/// Damping of the modes of some bodies in words.
pub(super) fn damping_in_words<'a>(models: impl IntoIterator<Item = &'a Model>) -> String {
    let ratios = models.into_iter().flat_map(|model| model.damping_ratios().iter().copied());
    let extremes = ratios.fold(None, |extremes: Option<[f64; 2]>, ratio| {
        let [least, most] = extremes.unwrap_or([ratio; 2]);
        Some([least.min(ratio), most.max(ratio)])
    });
    match extremes {
        None => "no modes to damp".to_owned(),
        Some([_, 0.0]) => "no damping".to_owned(),
        Some([least, most]) if least == most => format!("damping ratio {least} in each mode"),
        Some([least, most]) => format!("damping ratios {least:.6} to {most:.6}"),
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.omega_global {
            [0.0, 0.0, 0.0] => write!(f, "rest")?,
            [x, y, z] => write!(f, "a spin of ({x:.6}, {y:.6}, {z:.6}) rad per time, global")?,
        }
        self.rotors.iter().try_for_each(|rotor| write!(f, ", {rotor}"))?;
        if self.time != 0.0 {
            write!(f, ", at time {}", self.time)?;
        }
        write!(f, "; {}", self.damping)
    }
}
