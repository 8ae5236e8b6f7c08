//! `flexframe fit`.

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::Failure;
use flexframe::fit::{self, FitSettings};
use flexframe::outputs::{Written, outputs_of_scene};
use scene::{Measured, Shared};

use crate::arguments::values::positive;
use crate::arguments::{FileArgs, ModeCountArgs, SceneArgs};
use crate::cli_error::option;
use crate::output;
use crate::session::Session;

/// Fit parameters of a body to measured frequencies, with intervals of confidence.
///
/// Modes are matched by their shapes at points of [output] where the table has them, and else by their order. The intervals have the
/// true value in them with 95 % confidence: by the stated deviations of the frequencies, or by what is left of them.
#[derive(Debug, Args)]
pub struct Fit {
    #[command(flatten)]
    scene: SceneArgs,
    /// CSV file with a column `frequency`, and if wanted `deviation` and POINT.x, POINT.y, POINT.z [default: `measured` in [modes]].
    #[arg(long, value_name = "TABLE")]
    measured: Option<PathBuf>,
    /// Parameters: paths of keys of materials and point masses, such as body.material.young_modulus, thickness.AXIS or
    /// thickness.GROUP.AXIS, or of bodies in joints stiffnesses, such as bushings[0].stiffness.rotation[2], and
    /// bodies.arm.material.density.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    parameters: Vec<String>,
    /// Standard deviation of the measured frequencies, relative to each, such as 0.01, of those that have none in the table.
    #[arg(long, value_name = "PART", value_parser = positive)]
    deviation: Option<f64>,
    #[command(flatten)]
    modes: ModeCountArgs,
    /// The scene with the fitted parameters, in the folder of the scene file [default: what to set is printed].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Fit {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, measured, parameters, deviation, modes, output, files } = self;
        output::require_file("--output", output.as_deref())?;
        let scene = session.read_one(scene, modes)?;
        if let Some(output) = &output {
            let mut outputs = outputs_of_scene(&scene, &session.builder, files.overwrite);
            if let Some(measured) = &measured {
                outputs = outputs.and_input(measured);
            }
            outputs.claim_as(&Written::SCENE, output)?;
            check_beside(&scene, output)?;
        }
        let measured = measured.as_deref().map(Measured::read).transpose()?;
        let settings = FitSettings { parameters, measured, deviation };
        let report = fit::fit(&scene, &session.builder, &settings, output.as_deref(), |p| session.bar.build(p))
            .map_err(|error| modes.refusal(error))?;
        session.print(&report, json)
    }
}

/// Refuses a scene in another folder than that of the scene which it is made of: its paths are relative to it.
fn check_beside(scene: &Shared, output: &Path) -> Result<(), Failure> {
    let folder = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        parent.canonicalize().ok()
    };
    if folder(&scene.path).is_some_and(|own| folder(output) == Some(own)) {
        return Ok(());
    }
    let found = format!("{}, in another folder than the scene", output.display());
    let expected = "a file beside the scene, since the paths in it are relative to its folder";
    let help = "leave --output out, and set the values with --set, or name a file beside the scene";
    Err(option("--output", found, expected, help))
}
