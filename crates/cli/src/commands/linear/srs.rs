//! `flexframe srs`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::frequencies::Frequencies;
use flexframe::given_file::GivenFile;
use flexframe::outputs::Outputs;
use flexframe::srs::{self, SrsSettings};
use scene::Interpolation;

use crate::arguments::FolderArgs;
use crate::arguments::values::{finite, frequencies, interpolation};
use crate::session::Session;

/// Find shock response spectra of a base motion: CSV, and a diagram (docs/method/shock.md).
///
/// A spectrum has the peaks of oscillators on the base, against their frequency: displacement relative to the base, and
/// acceleration of the mass in both directions, during the motion and in the free vibration after it.
#[derive(Debug, Args)]
pub struct Srs {
    /// CSV file of two columns, time and acceleration of the base; zero after the last line.
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// Frequencies in cycles per time, at equal ratios: from start to end, both included, count in all.
    #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies, allow_hyphen_values = true)]
    frequencies: Frequencies,
    /// The way of the acceleration from line to line: linear or monotone-cubic.
    #[arg(long, value_name = "WAY", default_value = "linear", value_parser = interpolation)]
    interpolation: Interpolation,
    /// Damping ratios, 0 or more: a spectrum for each.
    #[arg(long, value_name = "ZETA,ZETA,…", value_delimiter = ',', default_values_t = [0.05], value_parser = finite, allow_hyphen_values = true)]
    damping: Vec<f64>,
    #[command(flatten)]
    out: FolderArgs,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

impl Srs {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { table, frequencies, interpolation, damping, out, json } = self;
        GivenFile::expect(
            &table,
            &[GivenFile::Table],
            "a CSV file of times and accelerations (docs/reference/cli.md)",
        )?;
        out.check()?;
        let outputs = Outputs::new(vec![table.clone()], out.files.overwrite);
        let settings = SrsSettings { frequencies, damping_ratios: damping, interpolation };
        session.report(outputs, &out.folder(&table)?, &srs::FILES, json, |_| srs::srs(&table, &settings))
    }
}
