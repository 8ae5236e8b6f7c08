//! `flexframe linearize`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::linearize::{self, Reduction};
use flexframe::outputs::outputs_of_scene;

use crate::arguments::{FileArgs, LinearArgs, SceneArgs, folder};
use crate::output;
use crate::session::Session;

/// Write the linear model of small motions, x' = A x + B u and y = C x + D u, for control and for other programs.
///
/// It is about rest, or about the steady spin that a free body begins with, or a driven hinge or joint has. Inputs are the loads of the scene (the factor
/// that multiplies each, in the place of its history) and forces along the coordinates of joints; outputs are displacement,
/// velocity and acceleration of the points of [output], along the axes of the body, and joint coordinates.
#[derive(Debug, Args)]
pub struct Linearize {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    about: LinearArgs,
    /// Lower the order to N states, by balanced truncation (balanced:N; the summary says by how much a response is wrong at the most) or to
    /// the slowest modes with the static response of the others (modal:N). Rigid, undamped and unstable motions stay.
    #[arg(long, value_name = "WAY:N")]
    reduce: Option<Reduction>,
    /// The file: .mat (MATLAB, version 5) or .json [default: out/<name of the scene file>/linear.mat].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
}

impl Linearize {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, about, reduce, output, files } = self;
        output::require_file("--output", output.as_deref())?;
        let scene = session.read_scene(scene)?;
        let file = match output {
            Some(file) => file,
            None => folder(&scene.path, None)?.join("linear.mat"),
        };
        outputs_of_scene(&scene, &session.builder, files.overwrite).claim(std::slice::from_ref(&file))?;
        let report =
            linearize::linearize(&scene, &session.builder, &about.settings(), reduce, &file, |p| session.bar.build(p))?;
        session.print(&report, json)
    }
}
