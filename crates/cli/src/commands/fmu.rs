//! `flexframe fmu`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::fmu::{self, FmuSettings};
use flexframe::outputs::{Written, outputs_of_scene};
use flexframe::plausible;

use crate::arguments::{FileArgs, SceneArgs};
use crate::output;
use crate::session::Session;

/// Pack a scene as an FMU (FMI 2.0 for co-simulation), for Simulink, OpenModelica, Dymola, FMPy (docs/reference/fmu.md).
///
/// Inputs are forces and moments at the points of the output, factors on the loads and the acceleration of a drive;
/// outputs are the columns of a results file.
#[derive(Debug, Args)]
pub struct Fmu {
    #[command(flatten)]
    scene: SceneArgs,
    /// The FMU to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    files: FileArgs,
    /// The library that goes into it [default: FLEXFRAME_FMU_LIBRARY, or libflexframe_fmi beside the program].
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

impl Fmu {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, output, files, library } = self;
        output::require_file("--output", Some(&output))?;
        let scene = scene.read_scene_or_body_file()?;
        if !json {
            output::doubts(plausible::doubts_of_scene(&scene));
        }
        let outputs = outputs_of_scene(&scene, &session.builder, files.overwrite);
        outputs.and_input(&fmu::library_path(library.as_deref())).claim_as(&Written::FMU, &output)?;
        let report = fmu::pack(&scene, &session.builder, &output, &FmuSettings { library }, |p| session.bar.build(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
