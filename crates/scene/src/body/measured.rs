//! Modes as a test has measured them.

use std::path::PathBuf;

/// A table of measured modes, which replaces frequencies and damping of the model: key `measured` of `[modes]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The CSV file, already resolved against the folder of the scene file.
    pub file: PathBuf,
    /// Point of the output and axis (0 to 2) of each entry of the shapes; none where the modes are matched by their order.
    pub places: Vec<(String, usize)>,
    /// The measured modes, at least one.
    pub modes: Vec<MeasuredMode>,
}

/// A measured mode.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredMode {
    /// Line of the CSV file, from 1.
    pub line: usize,
    /// Frequency > 0, cycles per time.
    pub frequency: f64,
    /// Standard deviation of the frequency, > 0, where the table states it.
    pub deviation: Option<f64>,
    /// Damping ratio ≥ 0; `None` leaves that of the scene.
    pub damping_ratio: Option<f64>,
    /// The shape at the places, in any scale.
    pub shape: Vec<f64>,
}
