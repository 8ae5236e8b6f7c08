//! The numbers of an open results file, written and read at their places without HDF5.

use crate::checkpoint::{Sums, little_endian};
use crate::column::SystemRow;
use crate::container::description::{Description, Ranges};
use crate::container::lock::Locked;
use crate::container::room::Room;
use crate::container::seal::Apart;
use crate::container::{seal, structure};
use crate::history::histories;
use crate::shapes::Shapes;
use crate::shapes::stored::{Datasets, StoredArray};
use crate::{Column, FileError, Metadata};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 14;

/// Bytes of a number.
const NUMBER: usize = size_of::<f64>();

/// The open file, locked. All its room is there from the beginning, so that rows are written without a change to the
/// structure of the file: it is a whole HDF5 file at any moment. The time of a row is NaN until the whole row is there.
#[derive(Debug)]
pub(crate) struct Store {
    file: Locked,
    description: Description,
    /// Bytes of the times and the histories, and their values per row.
    columns: Vec<(Range<u64>, usize)>,
    /// Bytes of the two places for a checkpoint.
    checkpoints: Range<u64>,
    /// Bytes of the arrays.
    arrays: Vec<Range<u64>>,
}

/// Where the shapes of a new file come from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ShapeSource<'a> {
    /// Those of each body, in order; none of the bodies after the last.
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
        let count = 1 + histories(columns, metadata).count();
        let starts = vec![u64::MAX; count + usize::from(room.checkpoint_words.is_some())];
        let mut description = Description {
            rows: room.rows,
            checkpoint_words: room.checkpoint_words,
            starts,
            arrays: shapes.arrays(),
            metadata: metadata.clone(),
        };
        // No other places take more digits.
        let user_block = seal::room(description.to_json().len() as u64);
        let [starts, of_arrays] =
            structure::make(place, path, metadata, &description.arrays, columns, room, user_block)
                .map_err(|error| error.with_reason_from_system(place))?;
        description.starts = starts;
        description.arrays.iter_mut().zip(of_arrays).for_each(|(array, start)| array.start = start);
        let file = OpenOptions::new().read(true).write(true).open(place);
        let file = file.map_err(|error| FileError::system(path, "open the file for writing", &error))?;
        let file = locked(file, path, File::try_lock)?;
        if room.checkpoint_words.is_some() {
            reserve(&file).map_err(|error| FileError::system(path, "make room for the rows", &error))?;
        }
        let described = description.to_json().len();
        let store = Self::new(file, path, columns, description, described)?;
        store.put(shapes).map_err(|error| FileError::system(path, "write the shapes of the body", &error))?;
        Ok(store)
    }

    /// Opens a sealed file for reading.
    pub(crate) fn open<R: SystemRow>(path: &Path, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        Self::open_as(path, columns, "open the file", OpenOptions::new().read(true), File::try_lock_shared)
    }

    /// Opens a sealed file for writing.
    pub(crate) fn open_to_write<R: SystemRow>(path: &Path, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        let options = OpenOptions::new().read(true).write(true).clone();
        Self::open_as(path, columns, "open the file for writing", &options, File::try_lock)
    }

    fn open_as<R: SystemRow>(
        path: &Path,
        columns: &'static [Column<R>],
        action: &str,
        options: &OpenOptions,
        try_lock: fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, FileError> {
        let failed = |error| FileError::system(path, action, &error);
        // To open a pipe is to wait for who writes into it.
        if !std::fs::metadata(path).map_err(failed)?.is_file() {
            return Err(FileError::NoSeal { path: path.to_path_buf() });
        }
        let file = options.open(path).map_err(failed)?;
        let file = locked(file, path, try_lock)?;
        let json = seal::description(&file, path)?;
        let store = Self::new(file, path, columns, Description::from_json(path, &json)?, json.len())?;
        seal::check(&store.file, path, &store.changing())?;
        // Who makes a file on purpose can make its seal, too.
        store.metadata().check(path)?;
        Ok(store)
    }

    /// A description may be any: what it claims must be within the file after it, each in a place of its own.
    fn new<R: SystemRow>(
        file: Locked,
        path: &Path,
        columns: &'static [Column<R>],
        description: Description,
        described: usize,
    ) -> Result<Self, FileError> {
        let failed = |error| FileError::system(path, "read the file", &error);
        let length = file.metadata().map_err(failed)?.len();
        let metadata = &description.metadata;
        let of_histories = histories(columns, metadata).map(|history| history.width(metadata));
        let widths: Vec<usize> = std::iter::once(1).chain(of_histories).collect();
        let ranges = description.ranges(widths.iter().copied(), seal::HEAD + described as u64..length);
        let Some(Ranges { histories, checkpoints, arrays }) = ranges else {
            let what = "its histories are not within it, each in a place of its own".into();
            return Err(FileError::Damaged { path: path.to_path_buf(), what });
        };
        let columns = histories.into_iter().zip(widths).collect();
        Ok(Self { file, description, columns, checkpoints, arrays })
    }

    /// The bytes that change when the file has been sealed, in order: those of the numbers of an unfinished file.
    fn changing(&self) -> Vec<Apart<'_>> {
        if self.is_complete() {
            return Vec::new();
        }
        let columns = self.columns.iter().map(|(range, _)| range);
        in_order(columns.chain([&self.checkpoints]).map(|range| Apart { range: range.clone(), sum: None }))
    }

    /// Seals the file as it is now. Histories whose check sums are known are not read for it.
    pub(crate) fn seal(&self, path: &Path, sums: Option<&Sums>) -> Result<(), FileError> {
        let apart = match sums.filter(|_| self.is_complete()) {
            Some(sums) => {
                let columns = self.columns.iter().zip(sums.of_columns());
                in_order(columns.map(|((range, _), sum)| Apart { range: range.clone(), sum: Some(sum) }))
            }
            None => self.changing(),
        };
        seal::put(&self.file, path, self.description.to_json().as_bytes(), &apart)
    }

    /// Metadata of the file.
    pub(crate) fn metadata(&self) -> &Metadata {
        &self.description.metadata
    }

    /// True if the run came to its end.
    pub(crate) fn is_complete(&self) -> bool {
        self.description.checkpoint_words.is_none()
    }

    /// Rows that it has room for.
    pub(crate) fn rows(&self) -> usize {
        self.description.rows
    }

    /// Values per row of all histories.
    pub(crate) fn widths(&self) -> impl Iterator<Item = usize> {
        self.columns.iter().map(|(_, width)| *width)
    }

    /// Words of each of the two places for a checkpoint.
    pub(crate) fn checkpoint_words(&self) -> usize {
        self.description.checkpoint_words.unwrap_or(0)
    }

    /// Writes rows of all histories, the time last: whoever finds it finds the rest of the row.
    pub(crate) fn write<'a>(
        &self,
        path: &Path,
        rows: Range<usize>,
        values: impl Iterator<Item = &'a [f64]>,
    ) -> Result<(), FileError> {
        let mut histories = self.columns.iter().zip(values);
        let time = histories.next();
        for ((bytes, width), values) in histories.chain(time) {
            let start = bytes.start + (rows.start * width * NUMBER) as u64;
            self.write_at(start, &little_endian(values))
                .map_err(|error| FileError::system(path, format!("write rows {rows:?}"), &error))?;
        }
        Ok(())
    }

    /// The number of rows, and the numbers of all histories in these, or in more of them. Of an unfinished file, the rows
    /// before the first number that is not finite: no run writes one.
    pub(crate) fn read(&self, path: &Path) -> Result<(usize, Vec<Vec<f64>>), FileError> {
        let mut rows = self.rows();
        let columns = self.columns.iter().map(|(bytes, width)| {
            // The time comes first, so that the room for rows to come is not read.
            let bytes = bytes.start..bytes.start + (rows * width * NUMBER) as u64;
            let column = self.read_words(&bytes, f64::from_bits)?;
            if !self.is_complete() {
                let finite = column.iter().position(|value| !value.is_finite()).unwrap_or(usize::MAX);
                rows = rows.min(finite / (*width).max(1));
            }
            Ok(column)
        });
        let columns = columns.collect::<io::Result<_>>();
        let columns = columns.map_err(|error| FileError::system(path, "read the histories", &error))?;
        Ok((rows, columns))
    }

    /// The two places for a checkpoint.
    pub(crate) fn read_checkpoints(&self, path: &Path) -> Result<Vec<u64>, FileError> {
        self.read_words(&self.checkpoints, |word| word)
            .map_err(|error| FileError::system(path, "read the checkpoints", &error))
    }

    /// Copies the first `rows` rows of another store of the same run.
    pub(crate) fn copy_rows(&self, path: &Path, other: &Self, rows: usize) -> Result<(), FileError> {
        for ((to, width), (from, _)) in self.columns.iter().zip(&other.columns) {
            self.copy(to.start, other, from.start, (rows * width * NUMBER) as u64)
                .map_err(|error| FileError::system(path, "copy the rows", &error))?;
        }
        Ok(())
    }

    /// Writes one of the two places for a checkpoint.
    pub(crate) fn write_checkpoint(&self, path: &Path, place: usize, words: &[u64]) -> Result<(), FileError> {
        let start = self.checkpoints.start + (place * self.checkpoint_words() * NUMBER) as u64;
        self.write_at(start, &little_endian(words))
            .map_err(|error| FileError::system(path, "write the checkpoint", &error))
    }

    /// The shapes of each body, if the file has them.
    pub(crate) fn read_shapes(&self, path: &Path) -> Result<Vec<Option<Shapes>>, FileError> {
        (0..self.metadata().bodies.len()).map(|body| self.read_shapes_of(body, path)).collect()
    }

    fn read_shapes_of(&self, body: usize, path: &Path) -> Result<Option<Shapes>, FileError> {
        if self.description.arrays.iter().all(|array| array.body != body) {
            return Ok(None);
        }
        let read = Shapes::read(&OfBody { store: self, body });
        let read = read.map_err(|error| FileError::system(path, "read the shapes of the body", &error))?;
        let Some(shapes) = read else {
            let what = "its shapes of a body are not whole".into();
            return Err(FileError::Damaged { path: path.to_path_buf(), what });
        };
        shapes.check(path)?;
        Ok(Some(shapes))
    }

    /// Writes the shapes to their places.
    fn put(&self, shapes: ShapeSource<'_>) -> io::Result<()> {
        match shapes {
            ShapeSource::Given(bodies) => {
                let lists = bodies.iter().flatten().flat_map(Shapes::stored);
                for ((_, _, lists), range) in lists.zip(&self.arrays) {
                    let mut start = range.start;
                    for bytes in lists.bytes() {
                        self.write_at(start, &bytes)?;
                        start += bytes.len() as u64;
                    }
                }
                Ok(())
            }
            ShapeSource::File(other) => (self.arrays.iter().zip(&other.arrays))
                .try_for_each(|(to, from)| self.copy(to.start, other, from.start, from.end - from.start)),
        }
    }

    fn write_at(&self, start: u64, bytes: &[u8]) -> io::Result<()> {
        let mut file = &*self.file;
        file.seek(SeekFrom::Start(start))?;
        file.write_all(bytes)
    }

    fn read_words<T>(&self, bytes: &Range<u64>, from_bits: impl Fn(u64) -> T) -> io::Result<Vec<T>> {
        self.read_numbers(bytes, |word| from_bits(u64::from_le_bytes(word)))
    }

    /// Numbers of N bytes each.
    fn read_numbers<const N: usize, T>(
        &self,
        bytes: &Range<u64>,
        from_bytes: impl Fn([u8; N]) -> T,
    ) -> io::Result<Vec<T>> {
        let mut file = &*self.file;
        let mut rest = (bytes.end - bytes.start) as usize;
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(rest / N).map_err(|_| io::ErrorKind::OutOfMemory)?;
        file.seek(SeekFrom::Start(bytes.start))?;
        let mut block = [0; BLOCK];
        while rest > 0 {
            let part = &mut block[..rest.min(BLOCK)];
            file.read_exact(part)?;
            numbers.extend(part.as_chunks().0.iter().map(|bytes| from_bytes(*bytes)));
            rest -= part.len();
        }
        Ok(numbers)
    }

    fn copy(&self, to: u64, other: &Self, from: u64, bytes: u64) -> io::Result<()> {
        let (mut to_file, mut from_file) = (&*self.file, &*other.file);
        from_file.seek(SeekFrom::Start(from))?;
        to_file.seek(SeekFrom::Start(to))?;
        match io::copy(&mut from_file.take(bytes), &mut to_file)? {
            copied if copied == bytes => Ok(()),
            _ => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }
}

impl ShapeSource<'_> {
    /// The arrays that they are in a file, at no place yet: no place takes more digits.
    fn arrays(&self) -> Vec<StoredArray> {
        let array = |body, path: &str, shape| StoredArray { body, path: path.to_owned(), shape, start: u64::MAX };
        match self {
            Self::Given(bodies) => {
                let of_body = |(body, shapes): (usize, &Option<Shapes>)| {
                    let stored = shapes.as_ref().map_or_else(Vec::new, Shapes::stored);
                    stored.into_iter().map(|(path, shape, _)| array(body, path, shape)).collect::<Vec<_>>()
                };
                bodies.iter().enumerate().flat_map(of_body).collect()
            }
            Self::File(store) => (store.description.arrays.iter())
                .map(|found| array(found.body, &found.path, found.shape.clone()))
                .collect(),
        }
    }
}

/// The arrays of one body in a store.
struct OfBody<'a> {
    store: &'a Store,
    body: usize,
}

impl OfBody<'_> {
    /// The array of a path, and its bytes.
    fn array(&self, path: &str) -> Option<(&StoredArray, &Range<u64>)> {
        let mut arrays = self.store.description.arrays.iter().zip(&self.store.arrays);
        arrays.find(|(array, _)| array.body == self.body && array.path == path)
    }
}

impl Datasets for OfBody<'_> {
    fn shape(&self, path: &str) -> Option<&[usize]> {
        self.array(path).map(|(array, _)| &*array.shape)
    }

    fn whole(&self, path: &str) -> io::Result<Vec<u32>> {
        self.array(path).map_or_else(|| Ok(Vec::new()), |(_, bytes)| self.store.read_numbers(bytes, u32::from_le_bytes))
    }

    fn numbers(&self, path: &str) -> io::Result<Vec<Vec<f64>>> {
        let Some((array, bytes)) = self.array(path) else { return Ok(Vec::new()) };
        let lists = array.shape.first().copied().unwrap_or_default() as u64;
        let each = (bytes.end - bytes.start).checked_div(lists).unwrap_or_default();
        let list = |i: u64| {
            let start = bytes.start + i * each;
            self.store.read_words(&(start..start + each), f64::from_bits)
        };
        (0..lists).map(list).collect()
    }
}

/// Reserves the room that a file has on the disk, where the file system can: a disk without it is found out now.
#[cfg(target_os = "linux")]
fn reserve(file: &File) -> io::Result<()> {
    use rustix::fs::{FallocateFlags, fallocate};
    use rustix::io::Errno;

    match fallocate(file, FallocateFlags::empty(), 0, file.metadata()?.len()) {
        Err(Errno::OPNOTSUPP | Errno::NOSYS) => Ok(()),
        outcome => Ok(outcome?),
    }
}

#[cfg(not(target_os = "linux"))]
fn reserve(_: &File) -> io::Result<()> {
    Ok(())
}

/// Ranges that are not empty, in the order of the file.
fn in_order<'s>(ranges: impl Iterator<Item = Apart<'s>>) -> Vec<Apart<'s>> {
    let mut ranges: Vec<_> = ranges.filter(|apart| !apart.range.is_empty()).collect();
    ranges.sort_unstable_by_key(|apart| apart.range.start);
    ranges
}

fn locked(file: File, path: &Path, try_lock: fn(&File) -> Result<(), TryLockError>) -> Result<Locked, FileError> {
    Locked::new(file, try_lock).ok_or_else(|| FileError::Busy { path: path.to_path_buf() })
}
