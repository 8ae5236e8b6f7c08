//! `flexframe shock`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::given_file::GivenFile;
use flexframe::shock;
use scene::Interpolation;

use crate::arguments::values::interpolation;
use crate::arguments::{AboutArgs, SceneArgs};
use crate::session::Session;

/// Sum the peaks of the modes under a shock of the base or of a load: absolute, SRSS and CQC.
///
/// The input follows the table. Modes and damping are those of the scene; outputs are those of `flexframe linearize` but for velocities. A run
/// with the table as history of the load has the peaks themselves.
#[derive(Debug, Args)]
pub struct Shock {
    #[command(flatten)]
    scene: SceneArgs,
    /// CSV file of times and values of the input, such as accelerations of the base.
    #[arg(long, value_name = "TABLE")]
    table: PathBuf,
    /// The way of the input between rows of the table: linear or monotone-cubic.
    #[arg(long, value_name = "WAY", default_value = "linear", value_parser = interpolation)]
    interpolation: Interpolation,
    /// The input, such as base.acceleration.z or loads[0].
    #[arg(long, value_name = "NAME")]
    input: String,
    #[command(flatten)]
    about: AboutArgs,
    /// Outputs, such as tip.acceleration or tip [default: points, stresses and coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    outputs: Vec<String>,
}

impl Shock {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, table, interpolation, input, about, outputs } = self;
        GivenFile::expect(&table, &[GivenFile::Table], "a CSV file of times and values (docs/reference/cli.md)")?;
        let scene = session.read_scene(scene)?;
        let settings = about.settings(vec![input], outputs);
        let table = (table.as_path(), interpolation);
        let report = shock::shock(&scene, &session.builder, table, &settings, |p| session.bar.build(p))?;
        session.print(&report, json)
    }
}
