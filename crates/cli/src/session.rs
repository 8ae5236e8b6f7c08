//! Means that every command has: where bodies come from, signals and the progress bar.

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use flexframe::modes;
use flexframe::outputs::{OutputError, Written, outputs_of_scene};
use flexframe::plausible;
use flexframe::run::RunSettings;
use model::Builder;
use scene::{Scene, Shared, System};
use slepc::files_of_folder;

use crate::arguments::ModeCountArgs;
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
