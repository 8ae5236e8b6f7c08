//! `flexframe psd`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::outputs::outputs_of_system;
use flexframe::psd::{self, PsdSettings};

use crate::arguments::values::{band, positive};
use crate::arguments::{AboutArgs, FileArgs, SceneArgs};
use crate::output;
use crate::session::{Session, folder};

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
    /// Folder for psd.csv, the chart and the page [default: out/<name of the scene file>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Psd {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, spectra, about, outputs, band, structural, output, files } = self;
        GivenFile::expect(
            &spectra,
            &[GivenFile::Table],
            "a CSV file of frequencies and densities (docs/reference/cli.md)",
        )?;
        output::require_file("--output", output.as_deref())?;
        let system = session.read_system(scene)?;
        let folder = folder(&system, output)?;
        outputs_of_system(&system, &session.builder, files.overwrite)
            .and_input(&spectra)
            .claim(&psd::files(&folder))?;
        let settings = PsdSettings { linear: about.settings(Vec::new(), outputs), band, loss_factor: structural };
        let report = psd::psd(&system, &session.builder, &spectra, &folder, &settings, |p| session.bar.build(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
