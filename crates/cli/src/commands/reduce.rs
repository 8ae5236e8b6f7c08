//! `flexframe reduce`.

use std::path::PathBuf;

use clap::Args;
use diagnostic::Failure;
use flexframe::hand_over::{self, Form};
use flexframe::modes;
use flexframe::outputs::{Written, outputs_of_body};

use crate::arguments::{FileArgs, SceneArgs};
use crate::output;
use crate::session::Session;
use crate::solver_input::SolverInput;

/// Reduce a scene's body and write it to a file (docs/reference/body.md) that scenes name as `file` in [body].
#[derive(Debug, Args)]
pub struct Reduce {
    #[command(flatten)]
    scene: SceneArgs,
    /// The body file to write; for other programs a file that ends in .op4 or .op2 (Nastran), .fem (MBDyn), .flex42 (NASA's 42), .sid_fem
    /// (SIMPACK, Modelica) or .glb (pictures).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    solver: SolverInput,
    /// Write the mass and stiffness matrices, too.
    #[arg(long)]
    matrices: bool,
    /// Write the stress of all nodes in each shape, too, as where the scene asks for stress.
    #[arg(long)]
    stress: bool,
}

impl Reduce {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene: SceneArgs { scene, json }, output, files, solver, matrices, stress } = self;
        output::require_file("--output", Some(&output))?;
        let scene = session.read(scene)?;
        if let Some(to) = solver.take(&mut session.builder, session.signals.slepc())? {
            return session.write_only(&scene, &to, files.overwrite);
        }
        let form = Form::of(&output);
        let written = form.map_or(Written::BODY, Form::written);
        outputs_of_body(&scene, &session.builder, files.overwrite).claim_as(&written, &output)?;
        let progress = |p| session.bar.build(p);
        let mut report = match form {
            Some(form) => hand_over::hand_over(&scene, &session.builder, form, &output, progress)?,
            None => modes::reduce(&scene, &session.builder, &output, matrices, stress, progress)?,
        };
        drop(session.bar);
        report.files.push(output);
        output::print(&report, json)
    }
}
