//! `flexframe advise`.

use clap::Args;
use diagnostic::Failure;
use flexframe::advise;

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
        let report = advise::advise(&scene, &session.builder, verify, |p| session.bar.advise(p))?;
        drop(session.bar);
        output::print(&report, json)
    }
}
