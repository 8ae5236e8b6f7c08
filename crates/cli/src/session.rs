//! Means that every command has: where bodies come from, signals and the progress bar.

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use flexframe::modes;
use flexframe::outputs::{OutputError, Outputs, Written, outputs_of_scene, outputs_of_system};
use flexframe::plausible;
use flexframe::report::{File, Report};
use flexframe::run::RunSettings;
use model::Builder;
use scene::{Scene, Shared, System};
use slepc::files_of_folder;

use crate::arguments::{FolderArgs, ModeCountArgs, SceneArgs};
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
}

impl Session {
    /// The scene of one body, after doubts about it have been told.
    pub fn read(&self, input: SceneInput) -> Result<Scene, Failure> {
        let scene = input.read()?;
        if !self.json_errors {
            output::doubts(plausible::doubts_of_scene(&scene));
        }
        Ok(scene)
    }

    /// As [`Self::read`], of any number of bodies.
    pub fn read_system(&self, input: SceneInput) -> Result<System, Failure> {
        let system = input.read_system()?;
        self.tell_doubts(&system);
        Ok(system)
    }

    /// A scene of one body, or of bodies in joints; of several that nothing ties one has to be named.
    pub fn read_one(&self, input: SceneInput, modes: ModeCountArgs) -> Result<System, Failure> {
        let mut system = input.clone().read_system()?;
        if !system.has_connections() && system.bodies.len() > 1 {
            system = input.read()?.into();
        }
        self.tell_doubts(&system);
        modes.set(&mut system);
        Ok(system)
    }

    /// Reads a scene, runs a command, writes the files of its report to the folder and prints it. The command reads `tables` beside the scene.
    pub fn answer(
        self,
        SceneArgs { scene, json }: SceneArgs,
        out: &FolderArgs,
        files: &[File],
        tables: &[&Path],
        command: impl FnOnce(&mut Self, &System) -> Result<Report, Failure>,
    ) -> Result<(), Failure> {
        out.check()?;
        let system = self.read_system(scene)?;
        let outputs = outputs_of_system(&system, &self.builder, out.files.overwrite);
        let outputs = tables.iter().fold(outputs, |outputs, table| outputs.and_input(table));
        self.report(outputs, &out.folder(&system.path), files, json, |session| command(session, &system))
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
        drop(self.bar);
        output::print(&report, json)
    }

    pub fn tell_doubts(&self, system: &System) {
        if !self.json_errors {
            output::doubts(plausible::doubts_of_system(system));
        }
    }

    pub fn settings(&self, overwrite: bool) -> RunSettings {
        RunSettings { overwrite, stop: self.signals.stop(), builder: self.builder.clone(), ..RunSettings::default() }
    }

    /// Writes the modes that a scene asks for as a problem for SLEPc.
    pub fn write_only(mut self, scene: &Scene, to: &WriteOnly, overwrite: bool) -> Result<(), Failure> {
        Written::FOLDER.check(&to.folder).map_err(OutputError::from)?;
        outputs_of_scene(scene, &self.builder, overwrite).claim(&files_of_folder(&to.folder))?;
        let files = modes::write_problem(scene, &self.builder, &to.folder, to.ranks, |p| self.bar.build(p))?;
        drop(self.bar);
        output::list(&files)
    }
}

/// Kind of file that export and report take.
pub const RESULTS: &str = "a results file of `flexframe run`";

/// The folder asked for, or one named after the scene.
pub fn folder(scene: &Shared, output: Option<PathBuf>) -> Result<PathBuf, OutputError> {
    if let Some(folder) = &output {
        Written::FOLDER.check(folder)?;
    }
    Ok(output.unwrap_or_else(|| Path::new("out").join(scene.path.file_stem().unwrap_or("scene".as_ref()))))
}
