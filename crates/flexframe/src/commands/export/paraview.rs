//! The motion as fields for ParaView, a step at a time.

use std::path::Path;

use diagnostic::{Failure, Kind};
use results::kind::NATURAL_MODE;
use results::{Block, Field, PvdEntry, VtkHdf, write_pvd, write_vtu};

use super::Exported;
use super::fields::fields;
use super::motion::{DrawnMotion, DrawnSurface, Placed};
use super::rows::ExportRows;
use crate::commands::modes::frequency_unit;
use crate::files::outputs::{OutputError, Written, outputs_of_results};
use crate::files::write_error::WriteError;

impl DrawnMotion {
    /// The rows to export and their times.
    fn chosen(&self, file: &Path, rows: &ExportRows) -> Result<(Vec<usize>, Vec<f64>), Failure> {
        let times = self.results.numbers("time").unwrap_or_default();
        let chosen = rows.of(file, &self.results)?;
        let times = chosen.iter().map(|row| times[*row]).collect();
        Ok((chosen, times))
    }

    /// A file with a mesh and these fields for each body: of a single one its mesh alone, and not a collection.
    fn create(
        &self,
        to: &Path,
        bodies: &[(&DrawnSurface, Vec<Field>)],
        times: Option<&[f64]>,
        overwrite: bool,
    ) -> Result<VtkHdf, Failure> {
        let created = match bodies {
            [(body, fields)] if self.is_single() => VtkHdf::create(to, &body.grid, times, fields, overwrite),
            _ => {
                let blocks = bodies.iter().map(|(body, fields)| {
                    let name = &body.metadata(self).name;
                    Block { name, grid: &body.grid, fields }
                });
                VtkHdf::create_collection(to, &blocks.collect::<Vec<_>>(), times, overwrite)
            }
        };
        Ok(created?)
    }
}

/// Writes a VTKHDF file with a step for each row: the mesh of a single body, or a collection of the meshes of all bodies by their
/// names. `progress` hears the part that is done, 0 to 1.
///
/// # Errors
/// [`Failure`]; nothing has been written then.
pub fn export_vtkhdf(
    file: &Path,
    motion: &DrawnMotion,
    to: &Path,
    rows: &ExportRows,
    mut progress: impl FnMut(f64),
) -> Result<Exported, Failure> {
    let (chosen, times) = motion.chosen(file, rows)?;
    outputs_of_results(file, rows.overwrite).claim_as(&Written::VTKHDF, to)?;
    let described: Vec<_> = motion.bodies.iter().map(|body| (body, fields(&body.shapes).1)).collect();
    let out = motion.create(to, &described, Some(&times), rows.overwrite)?;
    let mut placed = Placed::default();
    for (step, row) in chosen.iter().enumerate() {
        for (i, body) in motion.bodies.iter().enumerate() {
            body.place(motion, *row, &mut placed);
            let fields = fields(&body.shapes).0;
            fields.iter().enumerate().try_for_each(|(k, field)| out.write(i, step, k, (field.values)(&placed)))?;
        }
        progress((step + 1) as f64 / chosen.len() as f64);
    }
    out.finish()?;
    Ok(Exported { files: vec![to.to_owned()], warning: motion.warning() })
}

/// Writes a folder with a VTU file for each row and body and a PVD file, which lists them and is written last: for ParaView
/// before 5.12.
///
/// # Errors
/// [`Failure`]; without the PVD file, what there is of the others is a part.
pub fn export_vtu(
    file: &Path,
    motion: &DrawnMotion,
    folder: &Path,
    rows: &ExportRows,
    mut progress: impl FnMut(f64),
) -> Result<Exported, Failure> {
    let (chosen, times) = motion.chosen(file, rows)?;
    Written::FOLDER.check(folder).map_err(OutputError::from)?;
    let stem = file.file_stem().unwrap_or("results".as_ref()).to_string_lossy().into_owned();
    let list = folder.join(format!("{stem}.pvd"));
    let name = |step: usize, body: &DrawnSurface| match motion.is_single() {
        true => format!("{stem}_{step:06}.vtu"),
        false => format!("{stem}.{}_{step:06}.vtu", body.metadata(motion).name),
    };
    let of_step = |step: usize| motion.bodies.iter().map(move |body| (step, body));
    let all: Vec<_> = (0..chosen.len())
        .flat_map(of_step)
        .map(|(step, body)| folder.join(name(step, body)))
        .chain(std::iter::once(list.clone()))
        .collect();
    outputs_of_results(file, rows.overwrite).claim(&all)?;
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let mut placed = Placed::default();
    let mut files = Vec::new();
    for (step, (row, time)) in chosen.iter().zip(times).enumerate() {
        for (part, body) in motion.bodies.iter().enumerate() {
            let (fields, described) = fields(&body.shapes);
            body.place(motion, *row, &mut placed);
            let values: Vec<(&Field, &[f64])> =
                described.iter().zip(&fields).map(|(described, field)| (described, (field.values)(&placed))).collect();
            let file = name(step, body);
            write_vtu(folder.join(&file), &body.grid, &values, rows.overwrite)?;
            files.push(PvdEntry { time, part, name: body.metadata(motion).name.clone(), file });
        }
        progress((step + 1) as f64 / chosen.len() as f64);
    }
    write_pvd(&list, &files, rows.overwrite)?;
    Ok(Exported { files: vec![list], warning: motion.warning() })
}

/// Writes a VTKHDF file with the shape of each mode, and of each static shape, as a field of its own, mass-normalised, and
/// then the stress of each. They are numbered as everywhere: from 1. Bodies without modes are left out.
///
/// # Errors
/// [`Failure`]; nothing has been written then.
pub fn export_modes(file: &Path, motion: &DrawnMotion, to: &Path, rows: &ExportRows) -> Result<Exported, Failure> {
    let with_modes = motion.bodies.iter().filter(|body| !body.metadata(motion).model.frequencies.is_empty());
    let unit = frequency_unit(&motion.results.metadata.units.time);
    let described: Vec<_> = with_modes.map(|body| (body, fields_of_modes(body, motion, &unit))).collect();
    if described.is_empty() {
        let help = "leave --modes out, or run its scene again with flexible modes ([modes] flexible = 10)";
        return Err(Kind::Input.of(file).help(help).says("the body has no flexible modes to export"));
    }
    outputs_of_results(file, rows.overwrite).claim_as(&Written::VTKHDF, to)?;
    let out = motion.create(to, &described, None, rows.overwrite)?;
    for (i, (body, _)) in described.iter().enumerate() {
        let count = body.metadata(motion).model.frequencies.len();
        for (k, shape) in body.shapes.displacements.iter().take(count).enumerate() {
            out.write(i, 0, k, shape.as_flattened())?;
            if let Some(stress) = &body.shapes.stress {
                out.write(i, 0, count + k, &body.stress_of(stress, k))?;
            }
        }
    }
    out.finish()?;
    Ok(Exported { files: vec![to.to_owned()], warning: motion.warning_without_rows() })
}

/// A field for each shape, and then one for the stress of each.
fn fields_of_modes(body: &DrawnSurface, motion: &DrawnMotion, unit: &str) -> Vec<Field> {
    let model = &body.metadata(motion).model;
    let digits = model.frequencies.len().to_string().len();
    let name = |(k, (kind, frequency)): (usize, (&str, &f64))| match kind {
        NATURAL_MODE => format!("mode {:0digits$}: {frequency:.4} {}", k + 1, unit.replace('/', " per ")),
        kind => format!("{kind} {:0digits$}", k + 1),
    };
    let names = model.kinds().zip(&model.frequencies).enumerate().map(name);
    let shapes: Vec<Field> = names.map(|name| Field { name, components: 3 }).collect();
    let of_stress = |shape: &Field| Field { name: format!("stress of {}", shape.name), components: 6 };
    let stress = body.shapes.stress.iter().flat_map(|_| shapes.iter().map(of_stress));
    shapes.iter().cloned().chain(stress).collect()
}
