//! `flexframe frf`.

use clap::Args;
use diagnostic::Failure;
use flexframe::frequencies::Frequencies;
use flexframe::frf::{self, FrfSettings};

use crate::arguments::values::{frequencies, positive};
use crate::arguments::{FolderArgs, LinearArgs, SceneArgs};
use crate::session::Session;

/// Compute frequency responses of points and joints to loads: table, CSV and chart.
///
/// Inputs and outputs are those of `flexframe linearize`. Static shapes of the loads, where the model has them, are the
/// residual flexibility of the modes that are left out.
#[derive(Debug, Args)]
pub struct Frf {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    about: LinearArgs,
    /// Frequencies in cycles per time: from start to end, both included, count in all.
    #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies)]
    frequencies: Frequencies,
    /// Space the frequencies by equal ratios.
    #[arg(long)]
    log: bool,
    /// Loss factor of structural damping, in the place of the scene's damping.
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    structural: Option<f64>,
    #[command(flatten)]
    out: FolderArgs,
}

impl Frf {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { scene, about, frequencies, log, structural, out } = self;
        let settings = FrfSettings { linear: about.settings(), frequencies, logarithmic: log, loss_factor: structural };
        session.answer(scene, &out, &frf::FILES, &[], |session, scene| {
            frf::frf(scene, &session.builder, &settings, |p| session.bar.build(p))
        })
    }
}
