//! Entries of each body in a price list.

use serde::Serialize;

use super::modes::{ModesRow, modes_warning};

/// A body of a price list.
#[derive(Debug, Clone, Serialize)]
pub struct CostBody {
    /// Its name.
    pub name: String,
    /// Flexible modes kept.
    pub flexible: usize,
    /// Their highest frequency, cycles per time; none for a rigid body.
    pub highest_frequency: Option<f64>,
    /// |ω| at the beginning.
    pub initial_spin: f64,
    /// Points whose velocity and acceleration are compared.
    pub points: usize,
    /// The same motion with fewer and with more modes, fewest first; empty where they could not be compared.
    pub modes: Vec<ModesRow>,
    /// Reason of the missing comparison.
    pub modes_failure: Option<String>,
}

impl CostBody {
    /// Says of which bodies more digits than a target's need more modes.
    pub(super) fn modes_warning(bodies: &[Self], target: f64) -> Option<String> {
        let of_body = |body: &Self| {
            let words = modes_warning(&body.modes, body.flexible, target)?;
            Some(if bodies.len() == 1 { words } else { format!("Body {}: {words}", body.name) })
        };
        let words: Vec<String> = bodies.iter().filter_map(of_body).collect();
        (!words.is_empty()).then(|| words.join("\n\n"))
    }
}
