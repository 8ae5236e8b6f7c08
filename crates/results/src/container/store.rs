//! The numbers of an open results file, written and read at their places without HDF5.

use crate::column::SystemRow;
use crate::container::lock::Locked;
use crate::container::structure;
use crate::history::{History, histories};
use crate::shapes::Shapes;
use crate::shapes::stored::{DATASETS, Datasets, Lists};
use crate::{BodyMetadata, Column, FileError, Metadata};
use keys::Hash;
use sealed::{Declared, Format, Kind, Made, SealedError, SealedFile, little_endian};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::ops::Range;
use std::path::Path;

/// Name of the text with the metadata.
const METADATA: &str = "metadata";
/// Dataset of the times.
const TIME: &str = "time";
/// Dataset of the two places for a checkpoint.
const CHECKPOINT: &str = "checkpoint";

/// How much a file has room for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    /// Rows.
    pub rows: usize,
    /// Words of a checkpoint; none in a finished file.
    pub checkpoint_words: Option<usize>,
}

/// The open file, locked. All its room is there from the beginning, so that rows are written without a change to the
/// structure of the file: it is a whole HDF5 file at any moment. The time of a row is NaN until the whole row is there.
#[derive(Debug)]
pub(crate) struct Store {
    file: SealedFile,
    metadata: Metadata,
    room: Room,
    /// Datasets of the times and the histories, and their values per row.
    columns: Vec<(String, usize)>,
    _lock: Locked,
}

/// Where the shapes of a new file come from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ShapeSource<'a> {
    /// Shapes of each body, in order; none of the bodies after the last.
    Given(&'a [Option<Shapes>]),
    File(&'a Store),
}

impl Store {
    /// Makes the file at `place`, called `path` in messages. It has no seal yet.
    pub(crate) fn create<R: SystemRow>(
        place: &Path,
        path: &Path,
        metadata: &Metadata,
        shapes: ShapeSource<'_>,
        columns: &'static [Column<R>],
        room: Room,
    ) -> Result<Self, FileError> {
        let of_shapes = shapes.declared(metadata);
        let mut datasets = structure::declared(columns, metadata, room.rows);
        datasets.extend(of_shapes.iter().cloned());
        datasets.extend(room.checkpoint_words.map(|words| Declared {
            path: CHECKPOINT.to_owned(),
            kind: Kind::U64,
            shape: vec![2, words],
            attributes: Vec::new(),
            same_as: None,
        }));
        let json = serde_json::to_string(metadata).unwrap_or_default(); // no map whose keys are no text: it cannot fail
        let texts = BTreeMap::from([(METADATA.to_owned(), json)]);
        let is_complete = room.checkpoint_words.is_none();
        let made = Made { place, path, format: Format::RESULTS, texts: &texts, datasets: &datasets };
        let file = made.by_hdf5(|file| structure::write(path, file, metadata, is_complete))?;
        let lock = locked(file.file(), path, File::try_lock)?;
        let columns = of_metadata(columns, metadata);
        let mut store = Self { file, metadata: metadata.clone(), room, columns, _lock: lock };
        if !is_complete {
            reserve(store.file.file()).map_err(SealedError::system(path, "make room for the rows"))?;
            store.file.write_at(TIME, 0, &vec![f64::NAN; room.rows])?;
        }
        store.put(shapes, &of_shapes)?;
        Ok(store)
    }

    /// Opens a sealed file for reading.
    pub(crate) fn open<R: SystemRow>(path: &Path, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        Self::open_as(path, columns, OpenOptions::new().read(true), File::try_lock_shared)
    }

    /// Opens a sealed file for writing.
    pub(crate) fn open_to_write<R: SystemRow>(path: &Path, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        Self::open_as(path, columns, OpenOptions::new().read(true).write(true), File::try_lock)
    }

    fn open_as<R: SystemRow>(
        path: &Path,
        columns: &'static [Column<R>],
        options: &OpenOptions,
        try_lock: fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, FileError> {
        let failed = |error| SealedError::system(path, "open the file")(error);
        // To open a pipe is to wait for who writes into it.
        if !std::fs::metadata(path).map_err(failed)?.is_file() {
            return Err(SealedError::NoSeal { path: path.to_path_buf(), format: Format::RESULTS }.into());
        }
        let file = options.open(path).map_err(failed)?;
        let lock = locked(&file, path, try_lock)?;
        let file = SealedFile::of(file, path, Format::RESULTS)?;
        let metadata = metadata_of(&file)?;
        let shape = |dataset: &str| file.described(dataset).map_or(&[][..], |(_, shape, _)| shape);
        let rows = shape(TIME).first().copied().unwrap_or_default();
        let room =
            Room { rows, checkpoint_words: file.has(CHECKPOINT).then(|| shape(CHECKPOINT).iter().skip(1).product()) };
        // A description may be any: the histories must be those of the metadata, and sealed when the run has ended.
        let is_complete = room.checkpoint_words.is_none();
        let fits = |declared: &Declared| {
            let found = file.described(&declared.path);
            found.is_some_and(|(kind, shape, hash)| {
                (kind, shape) == (declared.kind, &*declared.shape) && hash.is_some() == is_complete
            })
        };
        let fits_checkpoint = is_complete || matches!(file.described(CHECKPOINT), Some((Kind::U64, [2, _], None)));
        if !(structure::declared(columns, &metadata, rows).iter().all(fits) && fits_checkpoint) {
            return Err(file.damaged("its histories are not those of its metadata").into());
        }
        let columns = of_metadata(columns, &metadata);
        Ok(Self { file, metadata, room, columns, _lock: lock })
    }

    /// Seals the file as it is now.
    pub(crate) fn seal(&self) -> Result<(), FileError> {
        Ok(self.file.write_head()?)
    }

    /// Metadata of the file.
    pub(crate) fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// True if the run came to its end.
    pub(crate) fn is_complete(&self) -> bool {
        self.room.checkpoint_words.is_none()
    }

    /// Rows that it has room for.
    pub(crate) fn rows(&self) -> usize {
        self.room.rows
    }

    /// Values per row of all histories.
    pub(crate) fn widths(&self) -> impl Iterator<Item = usize> {
        self.columns.iter().map(|(_, width)| *width)
    }

    /// Words of each of the two places for a checkpoint.
    pub(crate) fn checkpoint_words(&self) -> usize {
        self.room.checkpoint_words.unwrap_or(0)
    }

    /// The error of a content that is not what it should be.
    pub(crate) fn damaged(&self, what: impl Into<String>) -> FileError {
        self.file.damaged(what).into()
    }

    /// Writes rows of all histories, the time last: whoever finds it finds the rest of the row.
    pub(crate) fn write<'a>(
        &self,
        rows: Range<usize>,
        values: impl Iterator<Item = &'a [f64]>,
    ) -> Result<(), FileError> {
        let mut histories = self.columns.iter().zip(values);
        let time = histories.next();
        for ((dataset, width), values) in histories.chain(time) {
            self.file.write_at(dataset, rows.start * width, values)?;
        }
        Ok(())
    }

    /// The number of rows, and the numbers of all histories in these, or in more of them. Of an unfinished file, the rows
    /// before the first number that is not finite: no run writes one.
    pub(crate) fn read(&self) -> Result<(usize, Vec<Vec<f64>>), FileError> {
        let mut rows = self.rows();
        let columns = self.columns.iter().map(|(dataset, width)| {
            if self.is_complete() {
                return Ok(self.file.read(dataset)?.values);
            }
            // The time comes first, so that the room for rows to come is not read.
            let column: Vec<f64> = self.file.read_first(dataset, rows * width)?;
            let finite = column.iter().position(|value| !value.is_finite()).unwrap_or(usize::MAX);
            rows = rows.min(finite / (*width).max(1));
            Ok(column)
        });
        let columns = columns.collect::<Result<_, FileError>>()?;
        Ok((rows, columns))
    }

    /// The two places for a checkpoint.
    pub(crate) fn read_checkpoints(&self) -> Result<Vec<u64>, FileError> {
        if self.is_complete() { Ok(Vec::new()) } else { Ok(self.file.read_first(CHECKPOINT, usize::MAX)?) }
    }

    /// Copies the first `rows` rows of another store of the same run; a finished file has these rows and no others.
    pub(crate) fn copy_rows(&mut self, other: &Self, rows: usize) -> Result<(), FileError> {
        for (dataset, width) in &self.columns {
            let hash = self.file.copy_from(&other.file, dataset, (rows * width * size_of::<f64>()) as u64)?;
            if self.room.checkpoint_words.is_none() {
                self.file.seal(dataset, &hash);
            }
        }
        Ok(())
    }

    /// Writes one of the two places for a checkpoint.
    pub(crate) fn write_checkpoint(&self, place: usize, words: &[u64]) -> Result<(), FileError> {
        Ok(self.file.write_at(CHECKPOINT, place * self.checkpoint_words(), words)?)
    }

    /// The shapes of each body, if the file has them.
    pub(crate) fn read_shapes(&self) -> Result<Vec<Option<Shapes>>, FileError> {
        let of_body = |body: &BodyMetadata| {
            if DATASETS.iter().all(|dataset| !self.file.has(&body.path(dataset.path))) {
                return Ok(None);
            }
            let read = Shapes::read(&OfBody { file: &self.file, body })?;
            let shapes = read.ok_or_else(|| self.damaged("its shapes of a body are not whole"))?;
            shapes.check(self.file.path())?;
            Ok(Some(shapes))
        };
        self.metadata.bodies.iter().map(of_body).collect()
    }

    /// Writes the shapes to their places.
    fn put(&mut self, shapes: ShapeSource<'_>, datasets: &[Declared]) -> Result<(), FileError> {
        match shapes {
            ShapeSource::Given(bodies) => {
                let lists = bodies.iter().flatten().flat_map(Shapes::stored);
                for ((_, _, lists), Declared { path, kind, .. }) in lists.zip(datasets) {
                    let mut hashed = Vec::new();
                    let mut first = 0;
                    for list in lists.numbers() {
                        if *kind == Kind::F32 {
                            let list: Vec<f32> = list.iter().map(|x| *x as f32).collect();
                            self.file.write_at(path, first, &list)?;
                            hashed.push(little_endian(&list).into_owned().into());
                        } else {
                            self.file.write_at(path, first, list)?;
                            hashed.push(little_endian(list));
                        }
                        first += list.len();
                    }
                    if let Some(list) = lists.whole() {
                        self.file.write_at(path, 0, list)?;
                        hashed.push(little_endian(list));
                    }
                    self.file.seal(path, &Hash::of_lists(hashed));
                }
            }
            ShapeSource::File(other) => {
                for Declared { path, kind, shape, .. } in datasets {
                    let bytes = (shape.iter().product::<usize>() * kind.bytes()) as u64;
                    let hash = self.file.copy_from(&other.file, path, bytes)?;
                    self.file.seal(path, &hash);
                }
            }
        }
        Ok(())
    }
}

/// True if the run of a file came to its end.
pub(crate) fn is_complete(file: &SealedFile) -> bool {
    !file.has(CHECKPOINT)
}

/// Metadata of a results file, without a look at its rows.
pub(crate) fn metadata_of(file: &SealedFile) -> Result<Metadata, FileError> {
    let json = file.text(METADATA).unwrap_or_default();
    let metadata: Metadata = serde_json::from_str(json).map_err(|error| {
        // Without what stands there.
        file.damaged(format!("its metadata cannot be read from byte {} on", error.column()))
    })?;
    // Who makes a file on purpose can make its seal, too.
    metadata.check(file.path())?;
    Ok(metadata)
}

/// Datasets of the times and the histories, and their values per row.
fn of_metadata<R: SystemRow>(columns: &'static [Column<R>], metadata: &Metadata) -> Vec<(String, usize)> {
    let of_history = |history: History<R>| (history.path(metadata), history.width(metadata));
    std::iter::once((TIME.to_owned(), 1)).chain(histories(columns, metadata).map(of_history)).collect()
}

impl ShapeSource<'_> {
    /// The datasets that they are in a file.
    fn declared(&self, metadata: &Metadata) -> Vec<Declared> {
        match self {
            Self::Given(bodies) => {
                let of_body = |(body, shapes): (&BodyMetadata, &Option<Shapes>)| {
                    let stored = shapes.as_ref().map_or_else(Vec::new, Shapes::stored);
                    let declared = |(path, shape, lists): (&'static str, Vec<usize>, Lists<'_>)| {
                        let dataset = DATASETS.iter().find(|dataset| dataset.path == path)?;
                        Some(dataset.declared(body, (lists.kind(), &shape), &metadata.units))
                    };
                    stored.into_iter().filter_map(declared).collect::<Vec<_>>()
                };
                metadata.bodies.iter().zip(*bodies).flat_map(of_body).collect()
            }
            Self::File(store) => {
                let of_body = |body| {
                    DATASETS.iter().filter_map(move |dataset| {
                        let (kind, shape, _) = store.file.described(&BodyMetadata::path(body, dataset.path))?;
                        Some(dataset.declared(body, (kind, shape), &metadata.units))
                    })
                };
                metadata.bodies.iter().flat_map(of_body).collect()
            }
        }
    }
}

/// The datasets of one body in a file.
struct OfBody<'a> {
    file: &'a SealedFile,
    body: &'a BodyMetadata,
}

impl Datasets for OfBody<'_> {
    fn shape(&self, path: &str) -> Option<&[usize]> {
        self.file.described(&self.body.path(path)).map(|(_, shape, _)| shape)
    }

    fn whole(&self, path: &str) -> Result<Vec<u32>, SealedError> {
        Ok(self.file.read(&self.body.path(path))?.values)
    }

    fn numbers(&self, path: &str) -> Result<Vec<Vec<f64>>, SealedError> {
        let path = self.body.path(path);
        let (shape, values) = match self.file.described(&path) {
            Some((Kind::F32, ..)) => {
                let array = self.file.read::<f32>(&path)?;
                (array.shape, array.values.into_iter().map(f64::from).collect())
            }
            _ => {
                let array = self.file.read::<f64>(&path)?;
                (array.shape, array.values)
            }
        };
        let each = shape.iter().skip(1).product::<usize>().max(1);
        Ok(values.chunks_exact(each).map(<[f64]>::to_vec).collect())
    }
}

/// Reserves the room that a file has on the disk, where the file system can: a disk without it is found out now.
#[cfg(target_os = "linux")]
fn reserve(file: &File) -> std::io::Result<()> {
    use rustix::fs::{FallocateFlags, fallocate};
    use rustix::io::Errno;

    match fallocate(file, FallocateFlags::empty(), 0, file.metadata()?.len()) {
        Err(Errno::OPNOTSUPP | Errno::NOSYS) => Ok(()),
        outcome => Ok(outcome?),
    }
}

#[cfg(not(target_os = "linux"))]
fn reserve(_: &File) -> std::io::Result<()> {
    Ok(())
}

fn locked(file: &File, path: &Path, try_lock: fn(&File) -> Result<(), TryLockError>) -> Result<Locked, FileError> {
    let file = file.try_clone().map_err(SealedError::system(path, "lock the file"))?;
    Locked::new(file, try_lock).ok_or_else(|| FileError::Busy { path: path.to_path_buf() })
}
