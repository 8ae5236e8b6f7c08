//! The motion as fields for ParaView, a step at a time.

use std::path::Path;

use results::{Field, VtkHdf, write_pvd, write_vtu};

use super::Exported;
use super::error::ExportError;
use super::fields::fields;
use super::motion::{Motion, Placed};
use super::rows::ExportRows;
use crate::commands::modes::frequency_unit;
use crate::files::outputs::{OutputError, Written, outputs_of_results};
use crate::files::write_error::WriteError;

impl Motion {
    /// The rows to export and their times.
    fn chosen(&self, file: &Path, rows: &ExportRows) -> Result<(Vec<usize>, Vec<f64>), ExportError> {
        let times = self.results.numbers("time").unwrap_or_default();
        let chosen = rows.of(file, &self.results)?;
        let times = chosen.iter().map(|row| times[*row]).collect();
        Ok((chosen, times))
    }
}

/// Writes a VTKHDF file with a step for each row. `progress` hears the part that is done, 0 to 1.
///
/// # Errors
/// [`ExportError`]; nothing has been written then.
pub fn export_vtkhdf(
    file: &Path,
    motion: &Motion,
    to: &Path,
    rows: &ExportRows,
    mut progress: impl FnMut(f64),
) -> Result<Exported, ExportError> {
    let (chosen, times) = motion.chosen(file, rows)?;
    outputs_of_results(file, rows.overwrite).claim_as(&Written::VTKHDF, to)?;
    let (fields, described) = fields(&motion.shapes);
    let out = VtkHdf::create(to, &motion.grid, Some(&times), &described, rows.overwrite)?;
    let mut placed = Placed::default();
    for (step, row) in chosen.iter().enumerate() {
        motion.place(*row, &mut placed);
        fields.iter().enumerate().try_for_each(|(i, field)| out.write(step, i, (field.values)(&placed)))?;
        progress((step + 1) as f64 / chosen.len() as f64);
    }
    out.finish()?;
    Ok(Exported { files: vec![to.to_owned()], warning: motion.warning() })
}

/// Writes a folder with a VTU file for each row and a PVD file, which lists them and is written last: for ParaView before
/// 5.12.
///
/// # Errors
/// [`ExportError`]; without the PVD file, what there is of the others is a part.
pub fn export_vtu(
    file: &Path,
    motion: &Motion,
    folder: &Path,
    rows: &ExportRows,
    mut progress: impl FnMut(f64),
) -> Result<Exported, ExportError> {
    let (chosen, times) = motion.chosen(file, rows)?;
    Written::FOLDER.check(folder).map_err(OutputError::from)?;
    let stem = file.file_stem().unwrap_or("results".as_ref()).to_string_lossy().into_owned();
    let list = folder.join(format!("{stem}.pvd"));
    let name = |step: usize| format!("{stem}_{step:06}.vtu");
    let all: Vec<_> =
        (0..chosen.len()).map(|step| folder.join(name(step))).chain(std::iter::once(list.clone())).collect();
    outputs_of_results(file, rows.overwrite).claim(&all)?;
    std::fs::create_dir_all(folder).map_err(WriteError::of(folder))?;
    let (fields, described) = fields(&motion.shapes);
    let mut placed = Placed::default();
    let mut files = Vec::new();
    for (step, (row, time)) in chosen.iter().zip(times).enumerate() {
        motion.place(*row, &mut placed);
        let values: Vec<(&Field, &[f64])> =
            described.iter().zip(&fields).map(|(described, field)| (described, (field.values)(&placed))).collect();
        let name = name(step);
        write_vtu(folder.join(&name), &motion.grid, &values, rows.overwrite)?;
        files.push((time, name));
        progress((step + 1) as f64 / chosen.len() as f64);
    }
    write_pvd(&list, &files, rows.overwrite)?;
    Ok(Exported { files: vec![list], warning: motion.warning() })
}

/// Writes a VTKHDF file with the shape of each mode, and of each static shape, as a field of its own, mass-normalised, and
/// then the stress of each. They are numbered as everywhere: from 1.
///
/// # Errors
/// [`ExportError`]; nothing has been written then.
pub fn export_modes(file: &Path, motion: &Motion, to: &Path, rows: &ExportRows) -> Result<Exported, ExportError> {
    let body = &motion.results.metadata.body;
    if body.frequencies.is_empty() {
        return Err(ExportError::NoModes { path: file.to_owned() });
    }
    let unit = frequency_unit(&motion.results.metadata.units.time);
    let digits = body.frequencies.len().to_string().len();
    let name = |(k, (kind, frequency)): (usize, (&str, &f64))| match kind {
        "natural mode" => format!("mode {:0digits$}: {frequency:.4} {}", k + 1, unit.replace('/', " per ")),
        kind => format!("{kind} {:0digits$}", k + 1),
    };
    let names = body.kinds().zip(&body.frequencies).enumerate().map(name);
    let shapes: Vec<Field> = names.map(|name| Field { name, components: 3 }).collect();
    let stress = motion.shapes.stress.as_ref();
    let of_stress = |shape: &Field| Field { name: format!("stress of {}", shape.name), components: 6 };
    let fields: Vec<Field> =
        shapes.iter().cloned().chain(stress.iter().flat_map(|_| shapes.iter().map(of_stress))).collect();
    outputs_of_results(file, rows.overwrite).claim_as(&Written::VTKHDF, to)?;
    let out = VtkHdf::create(to, &motion.grid, None, &fields, rows.overwrite)?;
    for (k, shape) in motion.shapes.displacements.iter().take(shapes.len()).enumerate() {
        out.write(0, k, shape.as_flattened())?;
        if let Some(stress) = stress {
            out.write(0, shapes.len() + k, &motion.stress_of(stress, k))?;
        }
    }
    out.finish()?;
    Ok(Exported { files: vec![to.to_owned()], warning: motion.without_stress.clone() })
}
