//! `flexframe psd`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::psd::{self, PsdSettings};

use crate::arguments::values::{band, positive};
use crate::arguments::{AboutArgs, FolderArgs, SceneArgs};
use crate::session::Session;

/// Compute the response to stationary random inputs: root mean squares, apparent frequencies, CSV and chart.
///
/// A column of the table is the one-sided power spectral density of an input, in its unit² per cycle per time. Outputs are those of
/// `flexframe linearize`; with `stress = true` in [output] the equivalent stress of von Mises is among them.
#[derive(Debug, Args)]
pub struct Psd {
    #[command(flatten)]
    scene: SceneArgs,
    /// CSV file: frequency, then an input by its name each, and for two of them `coherence A & B` and `phase A & B` (degrees, of B before
    /// A). Densities are straight between rows on logarithmic axes.
    #[arg(long, value_name = "TABLE")]
    spectra: PathBuf,
    #[command(flatten)]
    about: AboutArgs,
    /// Outputs, such as tip.acceleration or tip [default: points, stresses and coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    outputs: Vec<String>,
    /// Lowest and highest frequency in cycles per time [default: those of the table].
    #[arg(long, value_name = "START:END", value_parser = band)]
    band: Option<[f64; 2]>,
    /// Loss factor of structural damping, in the place of the scene's damping.
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    structural: Option<f64>,
    #[command(flatten)]
    out: FolderArgs,
}

impl Psd {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { scene, spectra, about, outputs, band, structural, out } = self;
        GivenFile::expect(
            &spectra,
            &[GivenFile::Table],
            "a CSV file of frequencies and densities (docs/reference/cli.md)",
        )?;
        let settings = PsdSettings { linear: about.settings(Vec::new(), outputs), band, loss_factor: structural };
        session.answer(scene, &out, &psd::FILES, &[&spectra], |session, scene| {
            psd::psd(scene, &session.builder, &spectra, &settings, |p| session.bar.build(p))
        })
    }
}
