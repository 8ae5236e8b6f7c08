//! `flexframe advise`.

use clap::Args;
use diagnostic::Failure;
use flexframe::advise;
use flexframe::report::OfBodies;
use flexframe::system_modes::{self, AdviceOnSystems};

use crate::arguments::SceneArgs;
use crate::output;
use crate::session::Session;

/// Say which effects a scene calls for, and why.
///
/// A table shows the error of linear strain in each mode that may bend the body far: frequency, phase and static
/// force at its expected amplitude; and the modes that are among the large ones.
#[derive(Debug, Args)]
pub struct Advise {
    #[command(flatten)]
    scene: SceneArgs,
    /// Run the scene with each effect switched, and show the real influence beside the estimate.
    #[arg(long)]
    verify: bool,
}

impl Advise {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, verify } = self;
        let scene = session.read_scene(scene)?;
        let mut reports = Vec::new();
        for body in &scene.bodies {
            let report = advise::advise(body, &session.builder, verify, |p| session.bar.advise(p))?;
            reports.push((body.name.clone(), report));
        }
        if scene.has_connections() {
            let systems = system_modes::system_advice(&scene, &session.builder, |p| session.bar.build(p))?;
            drop(session.bar);
            return output::print(&AdviceOnSystems { bodies: reports, systems }, json);
        }
        drop(session.bar);
        output::print(&OfBodies(reports), json)
    }
}
