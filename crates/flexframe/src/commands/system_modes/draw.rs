//! A picture of the mode shapes of a system.

use std::path::{Path, PathBuf};

use figures::{Panel, ShapeGrid, View};
use model::Model;
use nalgebra::Vector3;
use scene::System;

use super::report::SystemModes;
use super::shape::SystemSurface;
use crate::commands::pictures::mode_shapes::ShapesError;

/// Largest displacement drawn, as a fraction of the system's size.
const DRAWN: f64 = 0.08;
/// More modes than this do not fit a page.
const MAX_PANELS: usize = 20;

/// Draws the vibrations of a system, numbered from 1, to `<stem>.svg`, `<stem>.pdf` and `<stem>.png`; of damped ones and those in
/// spin the real part. Bodies without a mesh are not drawn.
///
/// # Errors
/// [`ShapesError`]; nothing is drawn where no body has a mesh.
pub fn draw(
    system: &System,
    models: &[Model],
    modes: &SystemModes,
    stem: &Path,
) -> Result<Option<[PathBuf; 3]>, ShapesError> {
    let surface = SystemSurface::new(system, models, modes, false)?;
    if surface.points.is_empty() || modes.vibrations.modes.is_empty() {
        return Ok(None);
    }
    let diagonal = surface.diagonal();
    let unit = &modes.report.frequency_unit;
    let panels =
        modes.vibrations.modes.iter().zip(&modes.report.modes).take(MAX_PANELS).enumerate().map(|(k, (mode, row))| {
            let shape = surface.displacements(&mode.motion, 0.0);
            let largest = shape.iter().map(Vector3::norm).fold(f64::MIN_POSITIVE, f64::max);
            let scale = DRAWN * diagonal / largest;
            Panel {
                title: format!("Mode {}: {:.4} {unit}", k + 1, row.frequency),
                points: surface
                    .points
                    .iter()
                    .zip(&shape)
                    .map(|(x, u)| (Vector3::from(*x) + u * scale).into())
                    .collect(),
                values: shape.iter().map(|u| u.norm() / largest).collect(),
            }
        });
    let pictures = ShapeGrid {
        title: format!("{}: mode shapes", modes.report.title),
        value_label: "displacement / largest of the mode".to_owned(),
        triangles: &surface.triangles,
        edges: &surface.edges,
        undeformed: &surface.points,
        panels: panels.collect(),
        columns: 2,
        view: View::default(),
    }
    .save(stem)?;
    Ok(Some(pictures))
}
