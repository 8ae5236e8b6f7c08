//! `flexframe equilibrium`.

use clap::Args;
use diagnostic::Failure;
use flexframe::equilibrium;

use crate::arguments::SceneArgs;
use crate::output;
use crate::session::Session;

/// Find where the forces on bodies in joints balance: places, reactions, stability, and other equilibria near by.
///
/// Weight, loads at the time 0, springs, bushings and stops count; drives stand at their values of that time, and friction does not hold.
/// A run begins there with `initial = "equilibrium"` at the root of the scene.
#[derive(Debug, Args)]
pub struct Equilibrium {
    #[command(flatten)]
    scene: SceneArgs,
}

impl Equilibrium {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let SceneArgs { scene, json } = self.scene;
        let scene = session.read_scene(scene)?;
        let report = equilibrium::equilibrium(&scene, &session.builder, |p| session.bar.build(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
