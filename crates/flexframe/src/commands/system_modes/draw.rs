//! Pictures of the mode shapes of a system, and files of them for ParaView.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use faer::c64;
use figures::{Panel, ShapeGrid, View};
use model::Model;
use nalgebra::Vector3;
use results::{Block, CellKind, Field, Grid, VtkHdf};
use scene::Scene;

use super::report::{SystemModes, body_names};
use super::shape::SystemSurface;

/// Largest displacement drawn, as a fraction of the system's size.
const DRAWN: f64 = 0.08;
/// More modes than this do not fit a page.
const MAX_PANELS: usize = 20;

/// Draws the vibrations of a system, numbered from 1, to `<stem>.svg`, `<stem>.pdf` and `<stem>.png`; of damped ones and those in
/// spin the real part.
///
/// # Errors
/// [`Failure`].
pub fn draw(
    scene: &Scene,
    models: &[Model],
    modes: &SystemModes,
    stem: &Path,
) -> Result<Option<[PathBuf; 3]>, Failure> {
    let surface = SystemSurface::new(scene, models, modes, false)?;
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

/// A part of a motion below which it is rounding.
const ROUNDING: f64 = 1e-6;

/// Writes a VTKHDF file with the vibrations of a system for ParaView: a collection of the surfaces of the bodies where they stand, with
/// the displacements of each vibration as a field; of one whose points are not in phase, those a quarter of a period later, too.
///
/// # Errors
/// [`Failure`]; false, and no file, where no body has a mesh.
pub fn write_fields(
    scene: &Scene,
    models: &[Model],
    modes: &SystemModes,
    to: &Path,
    overwrite: bool,
) -> Result<bool, Failure> {
    let surface = SystemSurface::new(scene, models, modes, false)?;
    if surface.points.is_empty() || modes.vibrations.modes.is_empty() {
        return Ok(false);
    }
    let unit = modes.report.frequency_unit.replace('/', " per ");
    let digits = modes.vibrations.modes.len().to_string().len();
    let (mut fields, mut motions) = (Vec::new(), Vec::new());
    for (k, (mode, row)) in modes.vibrations.modes.iter().zip(&modes.report.modes).enumerate() {
        let name = format!("mode {:0digits$}: {:.4} {unit}", k + 1, row.frequency);
        // The phase in which most of it is.
        let phase = -0.5 * mode.motion.iter().map(|x| x * x).sum::<c64>().arg();
        let [now, later] = [phase, phase + FRAC_PI_2].map(|phase| surface.displacements(&mode.motion, phase));
        let [of_now, of_later] =
            [&now, &later].map(|shape| shape.iter().map(Vector3::norm).fold(f64::MIN_POSITIVE, f64::max));
        let scaled = |shape: &[Vector3<f64>]| shape.iter().map(|u| (u / of_now).into()).collect::<Vec<[f64; 3]>>();
        motions.push(scaled(&now));
        fields.push(Field { name: name.clone(), components: 3 });
        if of_later > ROUNDING * of_now {
            motions.push(scaled(&later));
            fields.push(Field { name: format!("{name}, a quarter later"), components: 3 });
        }
    }
    let (mut first, mut parts) = (0, Vec::new());
    for (number, triangles, points) in surface.bodies() {
        let grid = Grid {
            points: surface.points[first..first + points].to_vec(),
            connectivity: triangles.as_flattened().to_vec(),
            cells: CellKind::Triangle,
        };
        parts.push((body_names(scene, &[number]).concat(), grid, first..first + points));
        first += points;
    }
    let blocks: Vec<Block<'_>> = parts.iter().map(|(name, grid, _)| Block { name, grid, fields: &fields }).collect();
    let out = VtkHdf::create_collection(to, &blocks, None, overwrite)?;
    for (block, (.., range)) in parts.iter().enumerate() {
        for (field, motion) in motions.iter().enumerate() {
            out.write(block, 0, field, motion[range.clone()].as_flattened())?;
        }
    }
    out.finish()?;
    Ok(true)
}
