//! Streams samples into an HDF5 file while a run goes on.

use crate::layout::Quantity;
use crate::{FileError, Metadata, Sample, Units};
use hdf5::plist::group_create::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use ndarray::{ArrayView1, ArrayView2, aview0, aview1, s};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Rows that are gathered before they are appended; also the rows of an HDF5 chunk. A row at a time
/// costs about nine times as much.
const ROWS_PER_CHUNK: usize = 512;

/// A process killed without a flush leaves an unreadable file, so this is what can be lost.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

/// Appends [`Sample`]s to an HDF5 file whose names and shapes are those of [`mod@crate::layout`].
///
/// The file can be read after [`Writer::finish`], after the writer was dropped without it, and after
/// the process was killed (up to the last flush, about a second before); `complete` is 1 only after
/// `finish`. While it is being written HDF5 keeps the file locked.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    file: hdf5::File,
    point_names: Vec<String>,
    modes: usize,
    columns: Vec<Column>,
    rows_written: usize,
    rows_buffered: usize,
    last_flush: Instant,
}

#[derive(Debug)]
struct Column {
    quantity: Quantity,
    width: Option<usize>,
    dataset: hdf5::Dataset,
    buffer: Vec<f64>,
}

impl Writer {
    /// Creates the file (an old one of that name is overwritten) with the metadata and empty histories.
    ///
    /// # Errors
    /// [`FileError::PointName`] for a name that is empty, ".", "..", contains "/" or NUL or occurs
    /// twice, [`FileError::WrongLength`] if there are not as many damping ratios as frequencies,
    /// [`FileError::NulInText`], and [`FileError::Hdf5`] if the file cannot be created.
    pub fn create(path: impl AsRef<Path>, metadata: &Metadata) -> Result<Self, FileError> {
        let path = path.as_ref();
        check_point_names(path, &metadata.point_names)?;
        let modes = metadata.body.frequencies.len();
        check_length(path, "body/damping_ratios", modes, metadata.body.damping_ratios.len())?;

        // The format of HDF5 1.8 has checksums on all that is not numbers: damage is noticed before it is believed.
        let file = hdf5::File::with_options()
            .with_fapl(|access| access.libver_v18())
            .create(path)
            .map_err(hdf5_error(path, "create the file"))?;
        write_root_attributes(path, &file, metadata)?;
        write_body(path, &file, metadata)?;
        create_point_groups(&file, &metadata.point_names).map_err(hdf5_error(path, "create the points"))?;
        let columns = Quantity::all(metadata.point_names.len())
            .map(|quantity| Column::create(path, &file, quantity, modes, metadata))
            .collect::<Result<Vec<_>, _>>()?;
        let mut writer = Self {
            path: path.to_path_buf(),
            file,
            point_names: metadata.point_names.clone(),
            modes,
            columns,
            rows_written: 0,
            rows_buffered: 0,
            last_flush: Instant::now(),
        };
        writer.flush()?;
        Ok(writer)
    }

    /// Adds a row. It reaches the file with the next chunk, flush, or at the end.
    ///
    /// # Errors
    /// [`FileError::WrongLength`] and [`FileError::NotFinite`] leave the row out and everything before
    /// it in; [`FileError::Hdf5`] if the file cannot be extended.
    pub fn push(&mut self, sample: &Sample) -> Result<(), FileError> {
        check_length(&self.path, "points", self.point_names.len(), sample.points.len())?;
        check_length(&self.path, "modal/displacement", self.modes, sample.modal_displacement.len())?;
        check_length(&self.path, "modal/velocity", self.modes, sample.modal_velocity.len())?;
        for column in &self.columns {
            if let Some(&value) = column.quantity.of(sample).iter().find(|value| !value.is_finite()) {
                return Err(FileError::NotFinite {
                    path: self.path.clone(),
                    time: sample.time,
                    quantity: column.quantity.path(&self.point_names),
                    value,
                });
            }
        }
        for column in &mut self.columns {
            column.buffer.extend_from_slice(column.quantity.of(sample));
        }
        self.rows_buffered += 1;

        if self.rows_buffered == ROWS_PER_CHUNK {
            self.append_buffers()?;
        }
        if self.last_flush.elapsed() >= FLUSH_INTERVAL {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes what is left, marks the file as complete and closes it.
    ///
    /// # Errors
    /// [`FileError::Hdf5`] if the file cannot be written.
    pub fn finish(mut self) -> Result<(), FileError> {
        self.append_buffers()?;
        self.file
            .attr("complete")
            .and_then(|complete| complete.write_scalar(&1_i64))
            .map_err(hdf5_error(&self.path, "mark the file as complete"))?;
        self.flush()
    }

    fn flush(&mut self) -> Result<(), FileError> {
        self.append_buffers()?;
        self.last_flush = Instant::now();
        self.file.flush().map_err(hdf5_error(&self.path, "flush the file"))
    }

    fn append_buffers(&mut self) -> Result<(), FileError> {
        if self.rows_buffered == 0 {
            return Ok(());
        }
        let rows = self.rows_written..self.rows_written + self.rows_buffered;
        // Counted first: should an append fail, the rows are given up, and no later call repeats them.
        self.rows_written = rows.end;
        self.rows_buffered = 0;
        let mut outcome = Ok(());
        for column in &mut self.columns {
            if outcome.is_ok() {
                outcome = column.append(rows.clone()).map_err(|source| FileError::Hdf5 {
                    path: self.path.clone(),
                    action: format!("append to {}", column.quantity.path(&self.point_names)),
                    source,
                });
            }
            column.buffer.clear();
        }
        outcome
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // Best effort: there is nobody left to tell. After `finish` there is nothing to do.
        let _ = self.flush();
    }
}

impl Column {
    fn create(
        path: &Path,
        file: &hdf5::File,
        quantity: Quantity,
        modes: usize,
        metadata: &Metadata,
    ) -> Result<Self, FileError> {
        let name = quantity.path(&metadata.point_names);
        let width = quantity.width(modes);
        let builder = file.new_dataset::<f64>();
        let dataset = match width {
            None => builder.chunk(ROWS_PER_CHUNK).shape(0..).create(name.as_str()),
            // HDF5 wants no chunk of width 0, and no chunk wider than a fixed width.
            Some(0) => builder.chunk((ROWS_PER_CHUNK, 1)).shape((0.., 0..)).create(name.as_str()),
            Some(width) => builder.chunk((ROWS_PER_CHUNK, width)).shape((0.., width)).create(name.as_str()),
        }
        .map_err(hdf5_error(path, format!("create dataset {name}")))?;
        describe(path, &dataset, &quantity.unit(&metadata.units), quantity.frame(), quantity.description())?;
        let buffer = Vec::with_capacity(ROWS_PER_CHUNK * width.unwrap_or(1));
        Ok(Self { quantity, width, dataset, buffer })
    }

    fn append(&self, rows: std::ops::Range<usize>) -> hdf5::Result<()> {
        match self.width {
            None => {
                self.dataset.resize(rows.end)?;
                self.dataset.write_slice(ArrayView1::from(&self.buffer), rows)
            }
            Some(width) => {
                self.dataset.resize((rows.end, width))?;
                let block = ArrayView2::from_shape((rows.len(), width), &self.buffer)?;
                self.dataset.write_slice(block, s![rows, ..])
            }
        }
    }
}

fn hdf5_error(path: &Path, action: impl Into<String>) -> impl FnOnce(hdf5::Error) -> FileError {
    let (path, action) = (path.to_path_buf(), action.into());
    move |source| FileError::Hdf5 { path, action, source }
}

fn check_length(path: &Path, quantity: &str, expected: usize, found: usize) -> Result<(), FileError> {
    if expected == found {
        return Ok(());
    }
    Err(FileError::WrongLength { path: path.to_path_buf(), quantity: quantity.into(), expected, found })
}

fn check_point_names(path: &Path, names: &[String]) -> Result<(), FileError> {
    for (i, name) in names.iter().enumerate() {
        let reason = match name.as_str() {
            "" => "it is empty",
            "." | ".." => "HDF5 gives dots a meaning of their own",
            name if name.contains('/') => "HDF5 takes / as the separator of a path",
            name if name.contains('\0') => "it holds a NUL character",
            _ if names[..i].contains(name) => "it occurs twice",
            _ => continue,
        };
        return Err(FileError::PointName { path: path.to_path_buf(), name: name.clone(), reason });
    }
    Ok(())
}

/// The groups keep the order in which they were made, so that the reader lists the points as given.
fn create_point_groups(file: &hdf5::File, names: &[String]) -> hdf5::Result<()> {
    let points = file
        .create_group_builder()
        .with_create_plist(|plist| plist.link_creation_order(LinkCreationOrder::Indexed))
        .create("points")?;
    for name in names {
        points.create_group(name)?;
    }
    Ok(())
}

fn write_root_attributes(path: &Path, file: &hdf5::File, metadata: &Metadata) -> Result<(), FileError> {
    let texts = [
        ("title", &metadata.title),
        ("scene", &metadata.scene_text),
        ("formulation", &metadata.formulation),
        ("scheme", &metadata.scheme),
        ("program_version", &metadata.program_version),
        ("units_length", &metadata.units.length),
        ("units_mass", &metadata.units.mass),
        ("units_time", &metadata.units.time),
    ];
    for (name, text) in texts {
        write_text(path, file, name, text)?;
    }
    for (name, number) in [("step", metadata.step), ("tolerance", metadata.tolerance)] {
        let Some(number) = number else { continue };
        file.new_attr::<f64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&number))
            .map_err(hdf5_error(path, format!("write the attribute {name}")))?;
    }
    file.new_attr::<i64>()
        .create("complete")
        .and_then(|complete| complete.write_scalar(&0_i64))
        .map_err(hdf5_error(path, "write the attribute complete"))
}

fn write_body(path: &Path, file: &hdf5::File, metadata: &Metadata) -> Result<(), FileError> {
    let body = &metadata.body;
    let Units { length, mass, time } = &metadata.units;
    let frequency_unit = if time == "s" { "Hz".into() } else { format!("1/{time}") };
    let inertia_unit = format!("{mass} {length}^2");
    let inertia = ArrayView2::from(&body.inertia);
    for (name, values, unit, frame, description) in [
        ("mass", aview0(&body.mass).into_dyn(), mass, "none", "total mass"),
        ("center_of_mass", aview1(&body.center_of_mass).into_dyn(), length, "mesh", "centre of mass"),
        ("inertia", inertia.into_dyn(), &inertia_unit, "body", "undeformed inertia about the centre of mass"),
        (
            "frequencies",
            aview1(&body.frequencies).into_dyn(),
            &frequency_unit,
            "none",
            "natural frequencies of the flexible modes",
        ),
        (
            "damping_ratios",
            aview1(&body.damping_ratios).into_dyn(),
            &"1".into(),
            "none",
            "damping ratios of the flexible modes",
        ),
    ] {
        let name = format!("body/{name}");
        let dataset = file
            .new_dataset_builder()
            .with_data(values)
            .create(name.as_str())
            .map_err(hdf5_error(path, format!("write {name}")))?;
        describe(path, &dataset, unit, frame, description)?;
    }
    Ok(())
}

fn describe(path: &Path, dataset: &hdf5::Dataset, unit: &str, frame: &str, description: &str) -> Result<(), FileError> {
    write_text(path, dataset, "unit", unit)?;
    write_text(path, dataset, "frame", frame)?;
    write_text(path, dataset, "description", description)
}

/// A variable-length UTF-8 string, which h5py reads as `str`.
fn write_text(path: &Path, owner: &hdf5::Location, name: &str, text: &str) -> Result<(), FileError> {
    let value: VarLenUnicode =
        text.parse().map_err(|_| FileError::NulInText { path: path.to_path_buf(), attribute: name.into() })?;
    owner
        .new_attr::<VarLenUnicode>()
        .create(name)
        .and_then(|attribute| attribute.write_scalar(&value))
        .map_err(hdf5_error(path, format!("write the attribute {name}")))
}
