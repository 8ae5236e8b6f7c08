//! `flexframe animate`: a scene as a moving picture.

use std::path::{Path, PathBuf};

use frames_rk4::BodyMotion;
use nalgebra::Vector3;
use results::{Animation, FigureError, Frame, View};
use scene::{Model, Scene};

use crate::run::{RunError, RunProgress};
use crate::surface::Surface;

/// How the picture is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnimationSettings {
    /// Number of frames, first and last state among them (at least two).
    pub frames: u64,
    /// Factor on the deformation that is drawn.
    pub magnification: f64,
}

/// An animation that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum AnimationError {
    /// The scene could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// Runs a scene and draws it into a GIF at `path`; colours are the deformation.
///
/// # Errors
/// [`AnimationError`].
pub fn animate(
    scene: &Scene,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(), AnimationError> {
    let model = Model::build(scene, |p| progress(RunProgress::Build(p))).map_err(RunError::from)?;
    let (steps, step) = scene.steps();
    let mut scheme =
        model.start(scene, step).map_err(|source| RunError::Setup { scene: scene.path.clone(), source })?;
    let motion = BodyMotion::new(&model.body).map_err(RunError::from)?;
    let surface = Surface::new(&model);
    let last = settings.frames.max(2) - 1;
    let mut frames = Vec::new();
    let mut done = 0;
    for frame in 0..=last {
        while done < steps * frame / last {
            scheme.step().map_err(|source| RunError::Step { results: PathBuf::from("no file"), source })?;
            done += 1;
        }
        let state = scheme.state();
        let u = surface.displacements(&model, &state.modal_displacement[6..]);
        let drawn: Vec<Vector3<f64>> = u.iter().map(|u| u * settings.magnification).collect();
        frames.push(Frame {
            points: surface.placed(&model, &motion.position_global(state), &state.attitude, &drawn),
            values: u.iter().map(Vector3::norm).collect(),
            caption: format!("t = {:.3} {}", state.time, scene.units.time),
        });
        progress(RunProgress::Steps { done, total: steps });
    }
    Animation {
        title: scene.title.clone(),
        triangles: &surface.triangles,
        edges: &surface.edges,
        frames: &frames,
        frame_milliseconds: 50,
        view: View::default(),
        ground: true,
        traced_point: None,
    }
    .save_gif(path)?;
    Ok(())
}
