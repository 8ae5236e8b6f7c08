//! Options that several commands have.

pub mod values;

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::{Diagnosis, Failure, Kind};
use flexframe::linearize::LinearSettings;
use flexframe::outputs::{OutputError, Written};
use scene::{Flexible, Scene};

use crate::arguments::values::{angular_velocity, finite, mode_count};
use crate::output;
use crate::scene_input::SceneInput;

#[derive(Debug, Args)]
pub struct SceneArgs {
    #[command(flatten)]
    pub scene: SceneInput,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    pub json: bool,
}

/// A number of modes in the place of the scene's.
#[derive(Debug, Clone, Copy, Args)]
pub struct ModeCountArgs {
    /// Number of flexible modes, instead of the scene's.
    #[arg(short = 'n', long, value_name = "N", value_parser = mode_count, allow_hyphen_values = true)]
    flexible: Option<usize>,
}

impl ModeCountArgs {
    pub fn set(self, scene: &mut Scene) {
        for body in &mut scene.bodies {
            body.modes.flexible = self.flexible.map_or(body.modes.flexible, Flexible::Count);
        }
    }

    /// The refusal of a number of modes, at the option where that has replaced what the scene says.
    pub fn refusal(self, error: Failure) -> Failure {
        let known = error.diagnosis();
        match known.key.as_deref() {
            Some("modes.flexible") if self.flexible.is_some() => {
                Diagnosis { kind: Kind::Usage, file: None, line: None, key: Some("--flexible".to_owned()), ..known }
                    .into()
            }
            _ => error,
        }
    }
}

/// The state that a linear model is about.
#[derive(Debug, Args)]
pub struct AboutArgs {
    /// Angular velocity of the steady spin about the center of mass or the axis of a driven joint to the ground, radians per time, global; 0,0,0 is rest
    /// [default: that of the scene's free body or drive].
    #[arg(long, value_name = "X,Y,Z", value_parser = angular_velocity, allow_hyphen_values = true)]
    pub spin: Option<[f64; 3]>,
    /// Time of the run at which bodies are where they then are, under the loads of that time [default: the beginning].
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// Take out the motions that deform no body.
    #[arg(long)]
    pub without_rigid: bool,
}

impl AboutArgs {
    pub fn settings(&self, inputs: Vec<String>, outputs: Vec<String>) -> LinearSettings {
        LinearSettings { spin: self.spin, time: self.time, without_rigid: self.without_rigid, inputs, outputs }
    }
}

/// A linear model: its state and its channels.
#[derive(Debug, Args)]
pub struct LinearArgs {
    #[command(flatten)]
    pub about: AboutArgs,
    /// Inputs, such as loads[0], base.acceleration.z, drive or hinge.drive [default: loads, and forces along the coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub inputs: Vec<String>,
    /// Outputs, such as tip.acceleration, tip, reaction.force or hinge.moment [default: points, stresses and coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub outputs: Vec<String>,
}

impl LinearArgs {
    pub fn settings(self) -> LinearSettings {
        self.about.settings(self.inputs, self.outputs)
    }
}

#[derive(Debug, Args)]
pub struct FileArgs {
    /// Replace files that are there, once the new one is complete; of a run, an unfinished one at once. A file that the command reads
    /// is never replaced.
    #[arg(long)]
    pub overwrite: bool,
}

/// The folder for the files of a report.
#[derive(Debug, Args)]
pub struct FolderArgs {
    /// Folder for the files: tables as CSV, figures and pages [default: out/<name of the file that the command reads>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    pub files: FileArgs,
}

impl FolderArgs {
    /// Refuses standard output.
    pub fn check(&self) -> Result<(), Failure> {
        output::require_file("--output", self.output.as_deref())
    }

    /// The folder, or one named after the file that the command reads.
    pub fn folder(&self, input: &Path) -> Result<PathBuf, OutputError> {
        folder(input, self.output.clone())
    }
}

/// The folder asked for, or one named after the file that the command reads.
pub fn folder(input: &Path, output: Option<PathBuf>) -> Result<PathBuf, OutputError> {
    if let Some(folder) = &output {
        Written::FOLDER.check(folder)?;
    }
    Ok(output.unwrap_or_else(|| Path::new("out").join(input.file_stem().unwrap_or("scene".as_ref()))))
}
