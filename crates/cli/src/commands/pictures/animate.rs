//! `flexframe animate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use diagnostic::Failure;
use flexframe::animation::{AnimationSettings, Coloured, MAX_FRAMES, animate, animate_mode, animate_results};
use flexframe::figures::View;
use flexframe::outputs::{Written, outputs_of_results, outputs_of_scene};
use model::Needs;

use crate::arguments::FileArgs;
use crate::arguments::values::{finite, view};
use crate::cli_error::option;
use crate::output;
use crate::scene_input::SceneInput;
use crate::session::Session;

/// Draw a scene or a results file as a moving picture: a GIF, or a film.
///
/// A scene is run for it; of a results file (.h5) each frame is a row, and no mesh is needed. Colours run from 0 to the largest
/// value of the frames that are shown. A warning says where the frames are too few to show how the body turns. With `--mode`
/// the scene is not run: one of its modes swings through one period.
#[derive(Debug, Args)]
pub struct Animate {
    #[command(flatten)]
    scene: SceneInput,
    /// The picture to write: a GIF (.gif), or with ffmpeg a film (.mp4, .webm).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    files: FileArgs,
    /// Number of frames; each is shown for 0.05 s.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(2..=MAX_FRAMES))]
    frames: u64,
    /// Time of the first frame [default: 0].
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    from: Option<f64>,
    /// Time of the last frame [default: the end of the scene or of the results].
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    to: Option<f64>,
    /// Draw this mode of the scene, from 1 as `flexframe modes` counts them; of bodies in joints, one of the whole.
    #[arg(long, value_name = "N", conflicts_with_all = ["from", "to"], value_parser = clap::value_parser!(u64).range(1..))]
    mode: Option<u64>,
    /// The coloured quantity: the displacement by deformation, or the von Mises stress.
    #[arg(long, value_enum, default_value_t)]
    colour: Colour,
    /// Viewpoint: iso; xy, xz or yz (right and up); x, y, z, -x, -y or -z (where the viewer is); or the angles of the viewer
    /// in degrees, about z from x and above the xy plane [default: -60,25].
    #[arg(long, value_name = "VIEW", value_parser = view, allow_hyphen_values = true)]
    view: Option<View>,
    /// Factor on the deformation that is drawn; of a mode, on 8 % of the size of the body.
    #[arg(long, default_value_t = 1.0, value_parser = finite, allow_hyphen_values = true)]
    magnify: f64,
}

impl Animate {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        let Self { scene, output, files, frames, from, to, mode, colour, view, magnify } = self;
        output::require_file("--output", Some(&output))?;
        let coloured = match colour {
            Colour::Displacement => Coloured::Displacement,
            Colour::Stress => Coloured::Stress,
        };
        let view = view.unwrap_or_default();
        let settings = AnimationSettings { frames, magnification: magnify, from, to, view, coloured };
        let warning = match scene.results()? {
            Some(_) if mode.is_some() => {
                let help = "name the scene of the run, whose modes are found again";
                return Err(option("--mode", "a results file", "a scene", help));
            }
            Some(file) => {
                outputs_of_results(file, files.overwrite).claim_as(&Written::ANIMATION, &output)?;
                animate_results(file, &output, settings, |p| session.bar.run(p))?
            }
            None => {
                let scene = session.read_scene(scene)?;
                let builder = session.builder.needing(Needs::without_rows());
                outputs_of_scene(&scene, &session.builder, files.overwrite).claim_as(&Written::ANIMATION, &output)?;
                match mode {
                    Some(mode) => {
                        let mode = usize::try_from(mode).unwrap_or(usize::MAX);
                        animate_mode(&scene, &builder, mode, &output, settings, |p| session.bar.run(p))?;
                        None
                    }
                    None => animate(&scene, &builder, &output, settings, |p| session.bar.run(p))?,
                }
            }
        };
        drop(session.bar);
        output::list(&[output])?;
        output::warn(warning.as_deref())
    }
}

/// The coloured quantity of a moving picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum Colour {
    #[default]
    Displacement,
    Stress,
}
