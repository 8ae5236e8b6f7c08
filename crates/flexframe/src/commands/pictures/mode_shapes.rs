//! A picture of the mode shapes of a scene.

use std::path::{Path, PathBuf};

use figures::{FigureError, Panel, ShapeGrid, View};
use model::{BuildError, Meshed, Model};
use nalgebra::Vector3;
use scene::{Scene, SceneError};

use crate::commands::modes::{frequency_unit, require_flexible, require_surface};
use crate::surface::Surface;

/// Largest displacement drawn, as a fraction of the body's size.
const DRAWN: f64 = 0.08;
/// More modes than this do not fit a page.
const MAX_PANELS: usize = 20;

/// Mode shapes that could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum ShapesError {
    /// The body has no flexible modes.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The surface of a body is not known.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The picture could not be drawn.
    #[error("{0}")]
    Figure(#[from] FigureError),
}

/// Draws the flexible mode shapes, numbered from 1, to `<stem>.svg`, `<stem>.pdf` and `<stem>.png`.
///
/// # Errors
/// [`ShapesError`], also where there are no flexible modes to draw.
pub fn draw(scene: &Scene, model: &Model, stem: &Path) -> Result<[PathBuf; 3], ShapesError> {
    require_surface(scene)?;
    let meshed = require_flexible(scene, model)?;
    let Meshed { mesh, modes, .. } = meshed;
    let surface = Surface::of_model(model);
    let unit = frequency_unit(&scene.units.time);
    let panels = modes
        .natural_frequencies()
        .iter()
        .take(MAX_PANELS)
        .enumerate()
        .map(|(k, frequency)| {
            let mut q = vec![0.0; k + 1];
            q[k] = 1.0;
            let shape = surface.displacements(&q);
            let largest = shape.iter().map(Vector3::norm).fold(0.0, f64::max);
            let scale = DRAWN * mesh.diagonal() / largest;
            Panel {
                title: format!("Mode {}: {frequency:.4} {unit}", k + 1),
                points: surface
                    .shapes
                    .positions
                    .iter()
                    .zip(&shape)
                    .map(|(x, u)| (Vector3::from(*x) + u * scale).into())
                    .collect(),
                values: shape.iter().map(|u| u.norm() / largest).collect(),
            }
        })
        .collect();
    let pictures = ShapeGrid {
        title: format!("{}: mode shapes", scene.title),
        value_label: "displacement / largest of the mode".to_owned(),
        triangles: &surface.triangles,
        edges: &surface.edges,
        undeformed: &surface.shapes.positions,
        panels,
        columns: 2,
        view: View::default(),
    }
    .save(stem)?;
    Ok(pictures)
}
