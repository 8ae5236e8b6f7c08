//! Means that every command has: where bodies come from, signals and the progress bar.

use std::cell::OnceCell;
use std::fmt::Display;
use std::path::Path;
use std::rc::Rc;

use diagnostic::Failure;
use flexframe::modes;
use flexframe::outputs::{OutputError, Outputs, Written, outputs_of_body, outputs_of_scene};
use flexframe::plausible;
use flexframe::report::{File, Report};
use flexframe::run::RunSettings;
use model::Builder;
use scene::{Body, Scene};
use serde::Serialize;
use serde_json::Value;
use slepc::files_of_folder;

use crate::arguments::{FolderArgs, ModeCountArgs, SceneArgs};
use crate::cli_error::no_json;
use crate::output;
use crate::progress::Bar;
use crate::scene_input::SceneInput;
use crate::signals::Signals;
use crate::solver_input::WriteOnly;

pub struct Session {
    pub builder: Builder,
    pub signals: Signals,
    pub bar: Bar,
    /// True if standard error has an error as JSON, and nothing else.
    pub json_errors: bool,
    /// The place of the report, where it is not printed.
    pub taken: Option<Taken>,
}

/// A report that a command of this program has asked another one for.
pub type Taken = Rc<OnceCell<Value>>;

impl Session {
    /// The scene of one body, after doubts about it have been told.
    pub fn read(&self, input: SceneInput) -> Result<Body, Failure> {
        let scene = input.read()?;
        if !self.json_errors {
            output::doubts(plausible::doubts_of_body(&scene));
        }
        Ok(scene)
    }

    /// As [`Self::read`], of any number of bodies.
    pub fn read_scene(&self, input: SceneInput) -> Result<Scene, Failure> {
        let scene = input.read_scene()?;
        self.tell_doubts(&scene);
        Ok(scene)
    }

    /// A scene of one body, or of bodies in joints; of several that nothing ties one has to be named.
    pub fn read_one(&self, input: SceneInput, modes: ModeCountArgs) -> Result<Scene, Failure> {
        let mut scene = input.clone().read_scene()?;
        if !scene.has_connections() && scene.bodies.len() > 1 {
            scene = input.read()?.into();
        }
        self.tell_doubts(&scene);
        modes.set(&mut scene);
        Ok(scene)
    }

    /// Reads a scene, runs a command, writes the files of its report to the folder and prints it. The command reads `tables` beside the scene.
    pub fn answer(
        self,
        SceneArgs { scene, json }: SceneArgs,
        out: &FolderArgs,
        files: &[File],
        tables: &[&Path],
        command: impl FnOnce(&mut Self, &Scene) -> Result<Report, Failure>,
    ) -> Result<(), Failure> {
        out.check()?;
        let scene = self.read_scene(scene)?;
        let outputs = outputs_of_scene(&scene, &self.builder, out.files.overwrite);
        let outputs = tables.iter().fold(outputs, |outputs, table| outputs.and_input(table));
        self.report(outputs, &out.folder(&scene.path)?, files, json, |session| command(session, &scene))
    }

    /// Claims the files of a command, runs it, writes the files of its report to the folder and prints it.
    pub fn report(
        mut self,
        outputs: Outputs,
        folder: &Path,
        files: &[File],
        json: bool,
        command: impl FnOnce(&mut Self) -> Result<Report, Failure>,
    ) -> Result<(), Failure> {
        outputs.claim(&File::paths(files, folder))?;
        let mut report = command(&mut self)?;
        report.write(files, folder, &flexframe::report::program())?;
        self.print(&report, json)
    }

    /// Prints a report, or hands it to the command that has asked for it.
    pub fn print<R: Serialize + Display>(self, report: &R, json: bool) -> Result<(), Failure> {
        let Self { bar, taken, .. } = self;
        drop(bar);
        match taken {
            Some(taken) => {
                // It is set once: each command has one report.
                let _ = taken.set(serde_json::to_value(report).map_err(|error| no_json(&error))?);
                Ok(())
            }
            None => output::print(report, json),
        }
    }

    pub fn tell_doubts(&self, scene: &Scene) {
        if !self.json_errors {
            output::doubts(plausible::doubts_of_scene(scene));
        }
    }

    pub fn settings(&self, overwrite: bool) -> RunSettings {
        RunSettings { overwrite, stop: self.signals.stop(), builder: self.builder.clone(), ..RunSettings::default() }
    }

    /// Writes the modes that a scene asks for as a problem for SLEPc.
    pub fn write_only(mut self, body: &Body, to: &WriteOnly, overwrite: bool) -> Result<(), Failure> {
        Written::FOLDER.check(&to.folder).map_err(OutputError::from)?;
        outputs_of_body(body, &self.builder, overwrite).claim(&files_of_folder(&to.folder))?;
        let files = modes::write_problem(body, &self.builder, &to.folder, to.ranks, |p| self.bar.build(p))?;
        drop(self.bar);
        output::list(&files)
    }
}

/// Kind of file that export and report take.
pub const RESULTS: &str = "a results file of `flexframe run`";
