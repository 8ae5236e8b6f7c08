//! A picture of the mode shapes of a system.

use std::path::{Path, PathBuf};

use figures::{Panel, ShapeGrid, View};
use model::Model;
use nalgebra::Vector3;
use scene::System;

use super::report::SystemModes;
use crate::commands::mode_shapes::ShapesError;
use crate::commands::modes::require_surface;
use crate::surface::Surface;

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
    let mut first = 0;
    let mut parts = Vec::new();
    for (number, state) in modes.bodies.iter().zip(&modes.states) {
        let (scene, model) = (&system.bodies[*number], &models[*number]);
        let range = first..first + 6 + state.modal_displacement.len();
        first = range.end;
        if model.meshed.is_some() {
            require_surface(scene)?;
            if let Some(surface) = Surface::of_model(model) {
                parts.push((surface, Vector3::from(model.body.origin), state, range));
            }
        }
    }
    if parts.is_empty() || modes.vibrations.modes.is_empty() {
        return Ok(None);
    }
    let (mut triangles, mut edges, mut undeformed) = (Vec::new(), Vec::new(), Vec::<[f64; 3]>::new());
    for (surface, origin, state, _) in &parts {
        let offset = u32::try_from(undeformed.len()).unwrap_or(u32::MAX);
        triangles.extend(surface.triangles.iter().map(|corners| corners.map(|corner| corner + offset)));
        edges.extend(surface.edges.iter().map(|ends| ends.map(|end| end + offset)));
        let bent = surface.displacements(&state.modal_displacement);
        undeformed.extend(surface.placed(origin, &state.origin_global, &state.attitude, &bent));
    }
    let diagonal = {
        let bound =
            |axis: usize, pick: fn(f64, f64) -> f64| undeformed.iter().map(|x| x[axis]).reduce(pick).unwrap_or(0.0);
        (0..3).map(|axis| (bound(axis, f64::max) - bound(axis, f64::min)).powi(2)).sum::<f64>().sqrt()
    };
    let unit = &modes.report.frequency_unit;
    let panels =
        modes.vibrations.modes.iter().zip(&modes.report.modes).take(MAX_PANELS).enumerate().map(|(k, (mode, row))| {
            let shape: Vec<Vector3<f64>> = parts
                .iter()
                .flat_map(|(surface, origin, state, range)| {
                    let own: Vec<f64> = mode.motion[range.clone()].iter().map(|x| x.re).collect();
                    let [moved, turned] = [0, 3].map(|at| Vector3::new(own[at], own[at + 1], own[at + 2]));
                    let bent = surface.displacements(&own[6..]);
                    let displaced = surface.shapes.positions.iter().zip(bent).map(move |(x, u)| {
                        state.attitude.to_global(&(moved + turned.cross(&(Vector3::from(*x) - origin)) + u))
                    });
                    displaced.collect::<Vec<_>>()
                })
                .collect();
            let largest = shape.iter().map(Vector3::norm).fold(f64::MIN_POSITIVE, f64::max);
            let scale = DRAWN * diagonal / largest;
            Panel {
                title: format!("Mode {}: {:.4} {unit}", k + 1, row.frequency),
                points: undeformed.iter().zip(&shape).map(|(x, u)| (Vector3::from(*x) + u * scale).into()).collect(),
                values: shape.iter().map(|u| u.norm() / largest).collect(),
            }
        });
    let pictures = ShapeGrid {
        title: format!("{}: mode shapes", modes.report.title),
        value_label: "displacement / largest of the mode".to_owned(),
        triangles: &triangles,
        edges: &edges,
        undeformed: &undeformed,
        panels: panels.collect(),
        columns: 2,
        view: View::default(),
    }
    .save(stem)?;
    Ok(Some(pictures))
}
