//! `flexframe campbell`.

use clap::Args;
use diagnostic::Failure;
use flexframe::campbell::{self, AboutRest, CampbellSettings, Speeds};
use flexframe::outputs::outputs_of_scene;

use crate::arguments::values::{about_rest, axis, positive, speeds};
use crate::arguments::{FolderArgs, ModeCountArgs, SceneArgs};
use crate::session::Session;

/// Find natural frequencies against spin speed: table, CSV and Campbell diagram, with critical speeds.
///
/// The body spins steadily about an axis through its origin: the centre of mass of a free body, a fixed point of a
/// held one (the mean of the nodes of a clamp). Coriolis terms, softening and stiffening are on unless the scene's
/// [effects] say false; loads are left out. Frequencies are those in the rotating frame: order n is a load that
/// passes n times in a revolution. Branches are followed by their mode shapes and numbered by their order at the
/// lowest speed. Where two branches meet they cross, or veer if the spin couples them.
#[derive(Debug, Args)]
pub struct Campbell {
    #[command(flatten)]
    scene: SceneArgs,
    /// Spin axis in the axes of the mesh: x, y, z, or three numbers such as 0,0.6,0.8. Of bodies in joints it is global and goes
    /// through their center of mass.
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    axis: Option<[f64; 3]>,
    /// A joint about whose axis the bodies of a system spin, or the rigid rotor beyond it alone where other joints hold the others [default: the
    /// one that a drive turns].
    #[arg(long, value_name = "NAME", conflicts_with = "axis")]
    joint: Option<String>,
    /// Spin speeds in radians per time: from start to end, both included, count in all.
    #[arg(long, value_name = "START:END:COUNT", value_parser = speeds, allow_hyphen_values = true)]
    speeds: Speeds,
    /// Engine orders, per revolution.
    #[arg(
        long,
        value_name = "N,N,…",
        value_delimiter = ',',
        default_values_t = [1.0, 2.0, 3.0, 4.0],
        value_parser = positive
    )]
    orders: Vec<f64>,
    /// Vibrations about the rest of the full nonlinear body at each speed: auto (where the spin bends the body so far that a low
    /// frequency at the highest speed is off by 1 % without), always, or never.
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = about_rest)]
    about_rest: AboutRest,
    #[command(flatten)]
    modes: ModeCountArgs,
    #[command(flatten)]
    out: FolderArgs,
}

impl Campbell {
    pub fn execute(self, session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, axis, joint, speeds, orders, about_rest, modes, out } = self;
        out.check()?;
        let scene = session.read_one(scene, modes)?;
        let outputs = outputs_of_scene(&scene, &session.builder, out.files.overwrite);
        let settings = CampbellSettings { axis, joint, speeds, orders, about_rest };
        session.report(outputs, &out.folder(&scene.path)?, &campbell::FILES, json, |session| {
            let report = campbell::campbell(&scene, &session.builder, &settings, |p| session.bar.campbell(p));
            report.map_err(|error| modes.refusal(error))
        })
    }
}
