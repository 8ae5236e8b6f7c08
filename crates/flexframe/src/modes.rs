//! `flexframe modes`: natural frequencies and mode shapes of a scene's body.

use std::fmt;

use scene::{BuildError, BuildProgress, Model, Scene};
use serde::Serialize;

use crate::report::{BodyReport, MeshReport, Times, quantity};

/// What `flexframe modes` says.
#[derive(Debug, Clone, Serialize)]
pub struct ModesReport {
    /// Title of the scene.
    pub title: String,
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// The finite-element model.
    pub mesh: MeshReport,
    /// Mass properties and modes.
    pub body: BodyReport,
    /// Where the time went, seconds.
    pub times: Times,
}

/// Finds the modes of a scene's body.
///
/// # Errors
/// [`BuildError`].
pub fn modes(scene: &Scene, progress: impl FnMut(BuildProgress)) -> Result<(Model, ModesReport), BuildError> {
    let model = Model::build(scene, progress)?;
    let report = ModesReport {
        title: scene.title.clone(),
        frequency_unit: frequency_unit(&scene.units.time),
        mesh: MeshReport::new(scene, &model),
        body: BodyReport::new(&model),
        times: Times::of_model(&model),
    };
    Ok((model, report))
}

/// "Hz" where time is in seconds.
pub(crate) fn frequency_unit(time: &str) -> String {
    if time == "s" { "Hz".to_owned() } else { format!("1/{time}") }
}

impl fmt::Display for ModesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  mesh   {}", self.mesh)?;
        writeln!(f, "  mass   {}", quantity(self.body.mass))?;
        writeln!(f, "\n  mode  frequency, {:<6}  damping  residual", self.frequency_unit)?;
        let modes = self.body.natural_frequencies.iter().zip(&self.body.damping_ratios).zip(&self.body.residuals);
        for (k, ((frequency, damping), residual)) in modes.enumerate() {
            writeln!(f, "  {:>4}  {frequency:>17.6}  {damping:>7}  {residual:.0e}", k + 7)?;
        }
        write!(f, "\n  time   {}", self.times)
    }
}
