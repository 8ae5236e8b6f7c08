//! A picture of the mode shapes of a scene.

use std::path::{Path, PathBuf};

use diagnostic::Failure;
use figures::{Panel, ShapeGrid, View};
use model::{Meshed, Model};
use nalgebra::Vector3;
use scene::Body;

use crate::commands::modes::{frequency_unit, require_flexible, require_surface};
use crate::surface::Surface;

/// Largest displacement drawn, as a fraction of the body's size.
const DRAWN: f64 = 0.08;
/// More modes than this do not fit a page.
const MAX_PANELS: usize = 20;

/// Draws the flexible mode shapes, numbered from 1, to `<stem>.svg`, `<stem>.pdf` and `<stem>.png`.
///
/// # Errors
/// [`Failure`], also where there are no flexible modes to draw.
pub fn draw(given: &Body, model: &Model, stem: &Path) -> Result<[PathBuf; 3], Failure> {
    require_surface(given)?;
    let meshed = require_flexible(given, model)?;
    let Meshed { mesh, modes, .. } = meshed;
    let surface = Surface::of_model(model);
    let unit = frequency_unit(&given.units.time);
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
        title: format!("{}: mode shapes", given.title),
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
