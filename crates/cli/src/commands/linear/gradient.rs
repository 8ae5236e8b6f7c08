//! `flexframe gradient`.

use clap::Args;
use diagnostic::Failure;
use flexframe::frequencies::Frequencies;
use flexframe::gradient::{self, GradientSettings};
use flexframe::outputs::outputs_of_scene;

use crate::arguments::values::frequencies;
use crate::arguments::{FolderArgs, ModeCountArgs, SceneArgs};
use crate::session::Session;

/// Find the rates of frequencies, effective masses and static displacements with the numbers that a body is made with.
///
/// They are exact, not differences (docs/method/gradients.md). Static displacements are those of the points of [output] under each load
/// of a body that is held. Of bodies in joints, the parameters are the stiffnesses of springs, bushings and joints, and the materials and
/// point masses of bodies with a mesh; frequencies and responses have rates.
#[derive(Debug, Args)]
pub struct Gradient {
    #[command(flatten)]
    scene: SceneArgs,
    /// Parameters: paths of keys, such as body.material.young_modulus or body.point_masses[0].mass, and thickness.AXIS or
    /// thickness.GROUP.AXIS for a factor that stretches the mesh or a physical volume along x, y or z; of bodies in joints such as
    /// springs[0].stiffness or bodies.arm.material.density [default: all keys of materials and point masses, and all stiffnesses].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    parameters: Vec<String>,
    /// Frequencies, cycles per time, at which the responses of points to the loads have rates, too: from start to end, both included,
    /// count in all. Of one body they are sums over the modes that are kept, with the damping of the scene.
    #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies)]
    frequencies: Option<Frequencies>,
    #[command(flatten)]
    modes: ModeCountArgs,
    #[command(flatten)]
    out: FolderArgs,
}

impl Gradient {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, parameters, frequencies, modes, out } = self;
        out.check()?;
        let scene = session.read_one(scene, modes)?;
        let outputs = outputs_of_scene(&scene, &session.builder, out.files.overwrite);
        let settings = GradientSettings { parameters, frequencies };
        let files = gradient::files(&settings);
        session.report(outputs, &out.folder(&scene.path)?, &files, json, |session| {
            let report = gradient::gradient(&scene, &session.builder, &settings, |p| session.bar.build(p));
            report.map_err(|error| modes.refusal(error))
        })
    }
}
