//! Report of an answer to a shock.

use std::fmt;

use scene::{Interpolation, Shared};
use serde::Serialize;
use shock::BaseMotion;

use super::peaks::{ModePeaks, ShockOutput};
use crate::commands::modes::frequency_unit;

/// Most modes in the summary.
const SHOWN: usize = 12;

/// Report of `flexframe shock`.
#[derive(Debug, Clone, Serialize)]
pub struct ShockReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// The input that follows the table.
    pub input: String,
    /// The way of the input between rows of the table.
    pub interpolation: Interpolation,
    /// Duration of the table.
    pub duration: f64,
    /// Largest magnitude in the table.
    pub peak: f64,
    /// Modes, rising.
    pub modes: Vec<ShockMode>,
    /// Outputs.
    pub outputs: Vec<ShockOutput>,
    /// Reservations about the state and the modes.
    pub warnings: Vec<String>,
}

/// The peak of a mode.
#[derive(Debug, Clone, Serialize)]
pub struct ShockMode {
    /// Frequency, cycles per time.
    pub frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Force of a unit input on the mode of unit mass; of a base the participation factor, with its sign turned.
    pub factor: f64,
    /// Largest displacement of its oscillator relative to the base.
    pub displacement: f64,
    /// Largest acceleration of its mass.
    pub acceleration: f64,
    /// Its correlation with the table: 1 of a mode that is fast beside it.
    pub follows: f64,
}

impl ShockReport {
    pub(super) fn new(
        scene: &Shared,
        (input, interpolation): (&str, Interpolation),
        motion: &BaseMotion,
        peaks: &ModePeaks,
        outputs: Vec<ShockOutput>,
        warnings: Vec<String>,
    ) -> Self {
        let mode = |k: usize| ShockMode {
            frequency: peaks.frequencies[k],
            damping_ratio: peaks.damping_ratios[k],
            factor: peaks.factors[k],
            displacement: peaks.following[k].peaks.displacement,
            acceleration: peaks.following[k].peaks.acceleration(),
            follows: peaks.following[k].correlation,
        };
        Self {
            title: scene.title.clone(),
            frequency_unit: frequency_unit(&scene.units.time),
            input: input.to_owned(),
            interpolation,
            duration: motion.duration(),
            peak: motion.peak(),
            modes: (0..peaks.following.len()).map(mode).collect(),
            outputs,
            warnings,
        }
    }
}

impl fmt::Display for ShockReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { title, frequency_unit: unit, input, interpolation, duration, peak, modes, outputs, warnings } = self;
        let between = interpolation.words();
        writeln!(f, "{title}")?;
        writeln!(f, "  shock    {input} for {duration:.6}, at most {peak:.6e}, {between} between rows of the table")?;
        write!(
            f,
            "  {:>4}  {:>16}  {:>8}  {:>12}  {:>12}  {:>12}  {:>7}",
            "mode", unit, "damping", "factor", "displacement", "acceleration", "follows"
        )?;
        for (k, mode) in modes.iter().take(SHOWN).enumerate() {
            let ShockMode { frequency, damping_ratio, factor, displacement, acceleration, follows } = mode;
            let number = k + 1;
            write!(
                f,
                "\n  {number:>4}  {frequency:>16.6}  {damping_ratio:>8.4}  {factor:>12.4e}  {displacement:>12.4e}  {acceleration:>12.4e}  {follows:>7.4}"
            )?;
        }
        if modes.len() > SHOWN {
            write!(f, "\n  and {} more modes (--json has them)", modes.len() - SHOWN)?;
        }
        write!(f, "\n  {:<32}  {:>12}  {:>12}  {:>12}", "largest values", "absolute", "SRSS", "CQC")?;
        for ShockOutput { output, unit, absolute, srss, cqc, largest_mode, .. } in outputs {
            let by = largest_mode.map_or_else(|| "rigid".to_owned(), |mode| format!("mode {mode}"));
            write!(f, "\n  {output:<32}  {absolute:>12.4e}  {srss:>12.4e}  {cqc:>12.4e}  {unit}, most by {by}")?;
        }
        for warning in warnings {
            write!(f, "\n  warning  {warning}")?;
        }
        Ok(())
    }
}
