//! An HDF5 file with room for so many rows, laid out as [`mod@crate::layout`] says.

use crate::layout::Quantity;
use crate::{FileError, Metadata, Units, seal};
use hdf5::dataset::Layout;
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::plist::group_create::LinkCreationOrder;
use hdf5::types::VarLenUnicode;
use ndarray::{ArrayView1, ArrayView2, aview0, aview1, s};
use std::ops::Range;
use std::path::Path;

/// Rows that are copied at a time.
const ROWS_PER_COPY: usize = 8192;

/// Bytes of HDF5's superblock that say whether a program has the file open for writing.
const CONSISTENCY_FLAGS: Range<u64> = 20..24;

/// What a store is to hold.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    /// Rows.
    pub rows: usize,
    /// Words of a checkpoint; none in a finished file.
    pub checkpoint: Option<usize>,
    /// The attribute `complete`.
    pub complete: bool,
}

/// The open file. All its room is there from the beginning, NaN where nothing has been written yet, so that rows are
/// written without a change to the structure of the file: it is a whole HDF5 file at any moment.
#[derive(Debug)]
pub(crate) struct Store {
    columns: Vec<Column>,
    checkpoint: Option<hdf5::Dataset>,
    rows: usize,
    // Last, so that it is closed after its data sets.
    file: hdf5::File,
}

#[derive(Debug)]
struct Column {
    width: Option<usize>,
    dataset: hdf5::Dataset,
}

impl Store {
    /// Makes the file at `place`; in messages it is called `path`. Gives the ranges of bytes that change from then on.
    pub(crate) fn create(
        place: &Path,
        path: &Path,
        metadata: &Metadata,
        room: Room,
    ) -> Result<Vec<Range<u64>>, FileError> {
        let quantities: Vec<Quantity> = Quantity::all(metadata.point_names.len()).collect();
        let mut builder = hdf5::File::with_options();
        // Without times of creation, so that equal runs give equal files; the seal goes into the user block.
        let user_block = seal::room(quantities.len() + 2);
        builder.with_fcpl(|plist| plist.obj_track_times(false).userblock(user_block));
        // Numbers do not straddle the pages of the file, which may be written one by one.
        builder.with_fapl(|plist| plist.alignment(1, 8));
        let file = builder.create(place).map_err(FileError::hdf5(path, "create the file"))?;
        write_root_attributes(path, &file, metadata, room.complete)?;
        write_body(path, &file, metadata)?;
        create_point_groups(&file, &metadata.point_names).map_err(FileError::hdf5(path, "create the points"))?;
        let mut datasets = quantities
            .into_iter()
            .map(|quantity| create_column(path, &file, quantity, metadata, room.rows))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some(words) = room.checkpoint {
            let checkpoint = file
                .new_dataset::<u64>()
                .layout(Layout::Contiguous)
                .alloc_time(Some(AllocTime::Early))
                .obj_track_times(false)
                .shape((2, words))
                .create("checkpoint")
                .map_err(FileError::hdf5(path, "create dataset checkpoint"))?;
            datasets.push(checkpoint);
        }
        // An empty dataset has no place.
        let place_of = |dataset: &hdf5::Dataset| dataset.offset().map(|start| start..start + dataset.storage_size());
        let mut changing: Vec<Range<u64>> = datasets.iter().filter_map(place_of).collect();
        changing.push(user_block + CONSISTENCY_FLAGS.start..user_block + CONSISTENCY_FLAGS.end);
        changing.sort_unstable_by_key(|range| range.start);
        drop(datasets);
        // HDF5 gives back what room it has left over when it closes the file: from then on its structure stays.
        file.close().map_err(FileError::hdf5(path, "write the file"))?;
        Ok(changing)
    }

    /// Opens the file at `place`, called `path` in messages, for writing.
    pub(crate) fn open(place: &Path, path: &Path, metadata: &Metadata) -> Result<Self, FileError> {
        let modes = metadata.body.frequencies.len();
        let file = hdf5::File::open_rw(place).map_err(FileError::hdf5(path, "open the file for writing"))?;
        let dataset = |name: &str| file.dataset(name).map_err(FileError::hdf5(path, format!("open dataset {name}")));
        let mut rows = usize::MAX;
        let mut columns = Vec::new();
        for quantity in Quantity::all(metadata.point_names.len()) {
            let dataset = dataset(&quantity.path(&metadata.point_names))?;
            rows = rows.min(dataset.shape().first().copied().unwrap_or(0));
            columns.push(Column { width: quantity.width(modes), dataset });
        }
        let checkpoint = file.link_exists("checkpoint").then(|| dataset("checkpoint")).transpose()?;
        Ok(Self { columns, checkpoint, rows, file })
    }

    /// Rows that it has room for.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Words of each of the two places for a checkpoint.
    pub(crate) fn checkpoint_words(&self) -> usize {
        self.checkpoint.as_ref().and_then(|dataset| dataset.shape().get(1).copied()).unwrap_or(0)
    }

    /// Writes rows of all columns, in the order of [`Quantity::all`].
    pub(crate) fn write<'a>(
        &self,
        path: &Path,
        rows: Range<usize>,
        values: impl Iterator<Item = &'a [f64]>,
    ) -> Result<(), FileError> {
        for (column, values) in self.columns.iter().zip(values) {
            column.write(rows.clone(), values).map_err(FileError::hdf5(path, format!("write rows {rows:?}")))?;
        }
        Ok(())
    }

    /// Copies the first `rows` rows of another store of the same run.
    pub(crate) fn copy_rows(&self, path: &Path, other: &Self, rows: usize) -> Result<(), FileError> {
        for start in (0..rows).step_by(ROWS_PER_COPY) {
            let block = start..rows.min(start + ROWS_PER_COPY);
            for (to, from) in self.columns.iter().zip(&other.columns) {
                from.read(block.clone())
                    .and_then(|values| to.write(block.clone(), &values))
                    .map_err(FileError::hdf5(path, "copy the rows"))?;
            }
        }
        Ok(())
    }

    /// Writes one of the two places for a checkpoint.
    pub(crate) fn write_checkpoint(&self, path: &Path, place: usize, words: &[u64]) -> Result<(), FileError> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(()) };
        checkpoint.write_slice(words, s![place, ..]).map_err(FileError::hdf5(path, "write the checkpoint"))
    }

    /// Hands everything to the operating system, and is done.
    pub(crate) fn close(self, path: &Path) -> Result<(), FileError> {
        let Self { columns, checkpoint, rows: _, file } = self;
        drop((columns, checkpoint));
        file.close().map_err(FileError::hdf5(path, "write the file"))
    }

    /// Hands everything to the operating system.
    pub(crate) fn flush(&self, path: &Path) -> Result<(), FileError> {
        self.file.flush().map_err(FileError::hdf5(path, "flush the file"))
    }
}

impl Column {
    fn write(&self, rows: Range<usize>, values: &[f64]) -> hdf5::Result<()> {
        match self.width {
            None => self.dataset.write_slice(ArrayView1::from(values), rows),
            Some(0) => Ok(()),
            Some(width) => self.dataset.write_slice(ArrayView2::from_shape((rows.len(), width), values)?, s![rows, ..]),
        }
    }

    fn read(&self, rows: Range<usize>) -> hdf5::Result<Vec<f64>> {
        match self.width {
            None => self.dataset.read_slice_1d(rows).map(|values| values.into_raw_vec_and_offset().0),
            Some(0) => Ok(Vec::new()),
            Some(_) => self.dataset.read_slice_2d(s![rows, ..]).map(|values| values.into_raw_vec_and_offset().0),
        }
    }
}

/// Room for so many rows, NaN where nothing has been written.
fn create_column(
    path: &Path,
    file: &hdf5::File,
    quantity: Quantity,
    metadata: &Metadata,
    rows: usize,
) -> Result<hdf5::Dataset, FileError> {
    let name = quantity.path(&metadata.point_names);
    let builder = file
        .new_dataset::<f64>()
        .layout(Layout::Contiguous)
        .alloc_time(Some(AllocTime::Early))
        .fill_time(FillTime::Alloc)
        .fill_value(f64::NAN)
        .obj_track_times(false);
    let dataset = match quantity.width(metadata.body.frequencies.len()) {
        None => builder.shape(rows).create(name.as_str()),
        Some(width) => builder.shape((rows, width)).create(name.as_str()),
    }
    .map_err(FileError::hdf5(path, format!("make room for {name}")))?;
    describe(path, &dataset, &quantity.unit(&metadata.units), quantity.frame(), quantity.description())?;
    Ok(dataset)
}

/// The groups keep the order in which they were made, so that the reader lists the points as given.
fn create_point_groups(file: &hdf5::File, names: &[String]) -> hdf5::Result<()> {
    let points = file
        .create_group_builder()
        .with_create_plist(|plist| plist.link_creation_order(LinkCreationOrder::Indexed).obj_track_times(false))
        .create("points")?;
    for name in names {
        points.create_group(name)?;
    }
    Ok(())
}

fn write_root_attributes(path: &Path, file: &hdf5::File, metadata: &Metadata, complete: bool) -> Result<(), FileError> {
    let texts = [
        ("title", &metadata.title),
        ("scene", &metadata.scene_text),
        ("scene_file", &metadata.scene_file),
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
            .map_err(FileError::hdf5(path, format!("write the attribute {name}")))?;
    }
    for (name, number) in [("fingerprint", metadata.fingerprint.into()), ("complete", i64::from(complete))] {
        file.new_attr::<i64>()
            .create(name)
            .and_then(|attribute| attribute.write_scalar(&number))
            .map_err(FileError::hdf5(path, format!("write the attribute {name}")))?;
    }
    Ok(())
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
            .obj_track_times(false)
            .create(name.as_str())
            .map_err(FileError::hdf5(path, format!("write {name}")))?;
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
        .map_err(FileError::hdf5(path, format!("write the attribute {name}")))
}
