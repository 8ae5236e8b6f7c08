//! `flexframe animate`: a scene as a moving picture.

use std::path::{Path, PathBuf};

use figures::{Animation, FigureError, Frame, View};
use frames_rk4::{Reached, StepError};
use nalgebra::Vector3;
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
    /// A step failed, and no picture is drawn.
    #[error("{}: {source}", scene.display())]
    Step {
        /// The scene file.
        scene: PathBuf,
        /// Why.
        source: StepError,
    },
    /// There is nothing to draw.
    #[error("{}: a rigid body without a mesh has no surface to draw; give it a mesh and `flexible = 0`", scene.display())]
    NoMesh {
        /// The scene file.
        scene: PathBuf,
    },
    /// The name is not that of a GIF: it may be that of a file which is not to be replaced.
    #[error("{}: the animation is a GIF; give its file a name that ends in .gif", path.display())]
    NotGif {
        /// Where it was to go.
        path: PathBuf,
    },
    /// The picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// Runs a scene and draws it into a GIF at `path`, which ends in `.gif`; colours are the deformation.
///
/// # Errors
/// [`AnimationError`].
pub fn animate(
    scene: &Scene,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(), AnimationError> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif")) {
        return Err(AnimationError::NotGif { path: path.to_owned() });
    }
    let model = Model::build(scene, |p| progress(RunProgress::Build(p))).map_err(RunError::from)?;
    let mut simulation =
        model.start(scene).map_err(|source| RunError::Setup { scene: scene.path.clone(), source: Box::new(source) })?;
    let Some(meshed) = &model.meshed else {
        return Err(AnimationError::NoMesh { scene: scene.path.clone() });
    };
    let surface = Surface::new(&meshed.mesh);
    let last = settings.frames.max(2) - 1;
    let mut frames = Vec::new();
    for frame in 0..=last {
        // The first step at or after the frame's time.
        let due = scene.time.end * (frame as f64 / last as f64) * (1.0 - 1e-12);
        let failed = |source| AnimationError::Step { scene: scene.path.clone(), source };
        while simulation.time() < due && simulation.advance(1).map_err(failed)? != Reached::End {}
        let now = simulation.observation().map_err(failed)?;
        let u = surface.displacements(meshed, &model.coordinates(&now.modal_displacement));
        let drawn: Vec<Vector3<f64>> = u.iter().map(|u| u * settings.magnification).collect();
        frames.push(Frame {
            points: surface.placed(&model, &now.origin_global, &now.attitude, &drawn),
            values: u.iter().map(Vector3::norm).collect(),
            caption: format!("t = {:.3} {}", now.time, scene.units.time),
        });
        progress(RunProgress::Motion(simulation.time() / simulation.end()));
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
