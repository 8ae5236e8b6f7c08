//! Streams rows into an HDF5 file while a run goes on.

use crate::block::Block;
use crate::checkpoint::{self, Checkpoint, Sums};
use crate::column::{SystemRow, Values};
use crate::container::paths::ResultsPaths;
use crate::container::store::{Room, ShapeSource, Store};
use crate::error::check_length;
use crate::history::{History, histories};
use crate::reader::Results;
use crate::{Column, FileError, Metadata, Shapes, TrustLine};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use whole_file::TemporaryFile;

/// Most rows that are gathered before they are written. A row at a time costs about nine times as much.
const ROWS_PER_WRITE: usize = 512;

/// Numbers that are gathered at the most (2 MiB), so that rows of many points are fewer: they stay near the processor until
/// they are written.
const NUMBERS_PER_WRITE: usize = 1 << 18;

/// Longest stretch of a run that the kill of a process can lose.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

/// Room that is made at once for a run whose rows are expected to need more, in numbers (64 MiB).
const FIRST_ROOM: usize = 8 << 20;

/// Sizes and choices that a [`Writer`] needs before the run begins.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Expected {
    /// Rows, where they are known: the room for them is made at once. More are no error.
    pub rows: usize,
    /// Words of each checkpoint.
    pub checkpoint: usize,
    /// True if files that are there may be replaced: a results file or another, and an unfinished run of the same name.
    pub overwrite: bool,
}

/// Appends rows of type `R` to an HDF5 file whose datasets are those of a table of [`Column`]s.
///
/// While the run goes on, the rows are in an unfinished file beside the place of the results ([`unfinished`]), which is
/// locked. It is a whole HDF5 file at any moment, whenever the process is killed, and holds the rows up to the last
/// flush. [`Writer::finish`] writes the results file and puts it into its place in one go: what is there is always
/// whole, and is as it was until then.
#[derive(Debug)]
pub struct Writer<R: SystemRow + 'static> {
    place: ResultsPaths,
    overwrite: bool,
    metadata: Metadata,
    columns: &'static [Column<R>],
    store: Store,
    /// The histories that the file has, and their values per row.
    present: Vec<(History<R>, usize)>,
    /// The rows that have not been written.
    waiting: Block,
    rows_per_write: usize,
    /// Sums of the rows that have been written.
    sums: Sums,
    rows_written: usize,
    rows_buffered: usize,
    /// The last checkpoint as it is in the file, and its number.
    checkpoint: Vec<u64>,
    serial: u64,
    last_flush: Instant,
}

/// The unfinished file of a results file: `run.part.h5` of `run.h5`.
pub fn unfinished(path: impl AsRef<Path>) -> PathBuf {
    ResultsPaths::of(path.as_ref()).part
}

/// A run that can go on.
#[derive(Debug)]
pub struct Resumed<R: SystemRow + 'static> {
    /// Goes on after the rows.
    pub writer: Writer<R>,
    /// The rows up to the checkpoint.
    pub results: Results,
    /// The last checkpoint; of a run that was cut off before its first there is none, nor are there rows.
    pub checkpoint: Option<Vec<u64>>,
}

impl<R: SystemRow> Writer<R> {
    /// Begins the results file `path` with the metadata, the shapes of each body that is to carry them, and empty histories.
    ///
    /// # Errors
    /// [`FileError::PlaceName`] for a name that is empty, contains "/" or NUL or occurs twice, [`FileError::WrongLength`] if there are not as many damping ratios as frequencies,
    /// [`FileError::ConstantNotFinite`], [`FileError::NulInText`]; [`FileError::Busy`] if another process writes it,
    /// [`FileError::Unfinished`], [`FileError::Exists`], [`FileError::NotResults`] and [`FileError::Link`] for what would be lost;
    /// [`FileError::Sealed`] if the file cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        metadata: &Metadata,
        shapes: &[Option<Shapes>],
        columns: &'static [Column<R>],
        expected: Expected,
    ) -> Result<Self, FileError> {
        let place = ResultsPaths::of(path.as_ref());
        metadata.check(&place.path)?;
        shapes.iter().flatten().try_for_each(|shapes| shapes.check(&place.path))?;
        place.check(expected.overwrite)?;

        let present = with_widths(columns, metadata);
        let numbers_per_row = numbers_per_row(&present);
        let rows_per_write = rows_per_write(numbers_per_row);
        let rows = expected.rows.min(FIRST_ROOM / numbers_per_row.max(1)).max(rows_per_write);
        let checkpoint = vec![0; checkpoint::FRAME + expected.checkpoint];
        let room = Room { rows, checkpoint_words: Some(checkpoint.len()) };
        let (file, store) = make_room(&place, metadata, ShapeSource::Given(shapes), columns, room)?;
        place.put_part(file, expected.overwrite)?;
        Ok(Self {
            place,
            overwrite: expected.overwrite,
            metadata: metadata.clone(),
            columns,
            store,
            sums: Sums::new(1 + present.len()),
            waiting: waiting(&present, rows_per_write),
            present,
            rows_per_write,
            rows_written: 0,
            rows_buffered: 0,
            checkpoint,
            serial: 0,
            last_flush: Instant::now(),
        })
    }

    /// Checks that [`Writer::create`] would begin, for those who have long work to do before.
    ///
    /// # Errors
    /// [`FileError::Busy`], [`FileError::Unfinished`], [`FileError::Exists`], [`FileError::NotResults`], [`FileError::Link`], and
    /// [`FileError::Sealed`] if no file can be made in the folder.
    pub fn check(path: impl AsRef<Path>, overwrite: bool) -> Result<(), FileError> {
        let place = ResultsPaths::of(path.as_ref());
        place.check(overwrite)?;
        place.temporary().map(drop)
    }

    /// Opens an unfinished file, by its own name or that of the results file that it would become, to go on from its
    /// last checkpoint. Rows after that are written anew. With `overwrite`, a results file that is there is replaced in the end.
    ///
    /// # Errors
    /// [`FileError::Complete`] and [`FileError::NothingToResume`] if there is no unfinished file, [`FileError::Link`],
    /// [`FileError::Exists`] and [`FileError::NotResults`] for what would be lost,
    /// [`FileError::Busy`] if its run goes on, [`FileError::Sealed`] if no file can be made
    /// in the folder, and those of [`Results::open`].
    pub fn resume(
        path: impl AsRef<Path>,
        columns: &'static [Column<R>],
        overwrite: bool,
    ) -> Result<Resumed<R>, FileError> {
        let place = ResultsPaths::of(path.as_ref());
        place.check_resumable(overwrite)?;
        let part = &place.part;
        let store = Store::open_to_write(part, columns)?;
        if store.is_complete() {
            return Err(FileError::Complete { path: part.clone() });
        }
        let (mut results, last) = Results::read_with_checkpoint(&store, columns)?;
        let (rows, serial, frame, state, sums) = match last {
            Some((last, sums)) => (last.rows, last.serial, last.words(), Some(last.state), sums),
            None => (0, 0, vec![0; store.checkpoint_words()], None, Sums::new(store.widths().count())),
        };
        results.truncate(rows);
        let present = with_widths(columns, &results.metadata);
        let rows_per_write = rows_per_write(numbers_per_row(&present));
        let writer = Self {
            metadata: results.metadata.clone(),
            columns,
            place,
            overwrite,
            store,
            waiting: waiting(&present, rows_per_write),
            present,
            rows_per_write,
            sums,
            rows_written: rows,
            rows_buffered: 0,
            checkpoint: frame,
            serial,
            last_flush: Instant::now(),
        };
        Ok(Resumed { writer, results, checkpoint: state })
    }

    /// The unfinished file.
    pub fn unfinished(&self) -> &Path {
        &self.place.part
    }

    /// The results file.
    pub fn path(&self) -> &Path {
        &self.place.path
    }

    /// Adds a row. It reaches the file with the next block of rows, flush, or at the end.
    ///
    /// # Errors
    /// All leave the row out and everything before it in: [`FileError::WrongLength`], [`FileError::NotFinite`], and
    /// [`FileError::Sealed`] if the rows before it cannot be written. Those wait for another try.
    pub fn push(&mut self, row: &R) -> Result<(), FileError> {
        if self.rows_buffered >= self.rows_per_write {
            self.write_waiting()?;
        }
        let Self { present, waiting: Block { values, .. }, metadata, .. } = self;
        let before = values.len();
        let mut is_whole = row.bodies().len() == metadata.bodies.len() && row.joints().len() == metadata.joints.len();
        values.push(row.time());
        for (history, width) in &*present {
            let first = values.len();
            history.append(row, metadata, values);
            is_whole &= values.len() == first + width && !history.has_more(row, metadata);
        }
        if !(is_whole && are_finite(&values[before..])) {
            self.waiting.truncate(self.rows_buffered);
            return self.refuse(row);
        }
        self.rows_buffered += 1;
        Ok(())
    }

    /// Refuses a row that lacks a value, has more than there are places for, or one that is not finite.
    fn refuse(&self, row: &R) -> Result<(), FileError> {
        let (path, metadata) = (&self.place.part, &self.metadata);
        check_length(path, "bodies", metadata.bodies.len(), row.bodies().len())?;
        check_length(path, "joints", metadata.joints.len(), row.joints().len())?;
        if let Some((history, _)) = self.present.iter().find(|(history, _)| history.has_more(row, metadata)) {
            let places = history.places(metadata).len();
            let what = if matches!(history.column.values, Values::OfSupports(_)) { "supports" } else { "points" };
            return check_length(path, what, places, places + 1);
        }
        let time = row.time();
        let not_finite = |quantity, value| Err(FileError::NotFinite { path: path.clone(), time, quantity, value });
        if !time.is_finite() {
            return not_finite("time".to_owned(), time);
        }
        let mut values = Vec::new();
        for (history, width) in &self.present {
            values.clear();
            history.append(row, metadata, &mut values);
            check_length(path, &history.short_path_of(metadata, None), *width, values.len())?;
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return not_finite(history.quantity(metadata, index), values[index]);
            }
        }
        Ok(())
    }

    /// True if the last flush is about a second ago.
    pub fn flush_is_due(&self) -> bool {
        self.last_flush.elapsed() >= FLUSH_INTERVAL
    }

    /// Hands all rows to the operating system, and then the state of the run after them.
    ///
    /// # Errors
    /// [`FileError::WrongLength`] for a checkpoint of another length than expected; [`FileError::Sealed`]
    /// if the file cannot be written.
    pub fn flush(&mut self, checkpoint: &[u64]) -> Result<(), FileError> {
        let path = &self.place.part;
        let expected = self.checkpoint.len().saturating_sub(checkpoint::FRAME);
        check_length(path, "the checkpoint", expected, checkpoint.len())?;
        self.write_waiting()?;
        let serial = self.serial.saturating_add(1); // a forged file may have any
        let (rows, sum_of_rows) = (self.rows_written, self.sums.total());
        let words = Checkpoint { serial, rows, sum_of_rows, state: checkpoint.to_vec() }.words();
        // In turns, so that one of the two is whole at any moment: after a failure it is this one's turn again.
        self.store.write_checkpoint((serial % 2) as usize, &words)?;
        (self.serial, self.checkpoint) = (serial, words);
        self.last_flush = Instant::now();
        Ok(())
    }

    /// Keeps warnings of the run for [`Writer::finish`] to store; an unfinished file has none.
    pub fn warn(&mut self, warnings: Vec<String>) {
        self.metadata.warnings = warnings;
    }

    /// Keeps the trust card of the run for [`Writer::finish`] to store; an unfinished file has none.
    pub fn trust(&mut self, lines: Vec<TrustLine>) {
        self.metadata.trust = lines;
    }

    /// The rows so far, as a reader would find them.
    ///
    /// # Errors
    /// [`FileError::Sealed`] if they cannot be written and read back.
    pub fn results(&mut self) -> Result<Results, FileError> {
        self.write_waiting()?;
        let (mut results, _) = Results::read_with_checkpoint(&self.store, self.columns)?;
        results.truncate(self.rows_written);
        Ok(results)
    }

    /// Writes the results file, puts it into its place, and removes the unfinished one.
    ///
    /// # Errors
    /// [`FileError::Exists`] where a file has come there meanwhile that may not be replaced; [`FileError::Sealed`] if the file cannot be written; the unfinished file stays.
    pub fn finish(mut self) -> Result<(), FileError> {
        self.write_waiting()?;
        let file = complete(&self.place, &self.metadata, &self.store, self.rows_written, self.columns)?;
        self.place.put_results(file, self.overwrite)?;
        self.place.remove_part()
    }

    fn write_waiting(&mut self) -> Result<(), FileError> {
        if self.rows_buffered == 0 {
            return Ok(());
        }
        let rows = self.rows_written..self.rows_written + self.rows_buffered;
        // Should any of this fail, the rows wait on for the next call.
        if rows.end > self.store.rows() {
            self.grow(rows.end)?;
        }
        let columns = self.waiting.columns();
        self.store.write(rows.clone(), columns.clone())?;
        self.sums.add(columns);
        self.waiting.truncate(0);
        self.rows_buffered = 0;
        self.rows_written = rows.end;
        Ok(())
    }

    /// Goes over to a file with room for `rows` rows or more, by another one that takes the name.
    fn grow(&mut self, rows: usize) -> Result<(), FileError> {
        let rows = rows.max(2 * self.store.rows());
        let room = Room { rows, checkpoint_words: Some(self.checkpoint.len()) };
        let (file, mut store) =
            make_room(&self.place, &self.metadata, ShapeSource::File(&self.store), self.columns, room)?;
        store.copy_rows(&self.store, self.rows_written)?;
        store.write_checkpoint((self.serial % 2) as usize, &self.checkpoint)?;
        self.place.exchange_part(file)?;
        self.store = store;
        Ok(())
    }
}

/// Bytes of the numbers of a row.
pub fn bytes_per_row<R: SystemRow>(columns: &'static [Column<R>], metadata: &Metadata) -> u64 {
    (numbers_per_row(&with_widths(columns, metadata)) * size_of::<f64>()) as u64
}

/// The histories that a file has, and their values per row.
fn with_widths<R: SystemRow>(columns: &'static [Column<R>], metadata: &Metadata) -> Vec<(History<R>, usize)> {
    histories(columns, metadata).map(|history| (history, history.width(metadata))).collect()
}

/// Numbers of the histories, and the time.
fn numbers_per_row<R: SystemRow>(present: &[(History<R>, usize)]) -> usize {
    1 + present.iter().map(|(_, width)| width).sum::<usize>()
}

/// Room for rows that wait: the time, and the histories.
fn waiting<R: SystemRow>(present: &[(History<R>, usize)], rows: usize) -> Block {
    Block::new(std::iter::once(1).chain(present.iter().map(|(_, width)| *width)).collect(), rows)
}

/// True if all are finite numbers.
fn are_finite(values: &[f64]) -> bool {
    let (groups, rest) = values.as_chunks::<4>();
    let mut zeros = [0.0; 4];
    for group in groups {
        for (zero, value) in zeros.iter_mut().zip(group) {
            // Zero, but of infinity and NaN.
            *zero += value * 0.0;
        }
    }
    zeros.iter().all(|zero| *zero == 0.0) && rest.iter().all(|value| value.is_finite())
}

fn rows_per_write(numbers_per_row: usize) -> usize {
    (NUMBERS_PER_WRITE / numbers_per_row.max(1)).clamp(1, ROWS_PER_WRITE)
}

/// A sealed results file that has no name yet, of the shapes and the first `rows` rows of another.
fn complete<R: SystemRow>(
    place: &ResultsPaths,
    metadata: &Metadata,
    from: &Store,
    rows: usize,
    columns: &'static [Column<R>],
) -> Result<TemporaryFile, FileError> {
    let file = place.temporary()?;
    let room = Room { rows, checkpoint_words: None };
    let mut store = Store::create(&file, &place.path, metadata, ShapeSource::File(from), columns, room)?;
    store.copy_rows(from, rows)?;
    store.seal()?;
    Ok(file)
}

/// Replaces the trust card of the results file of a run that has come to its end. The new file takes the place of the old one in one go.
///
/// # Errors
/// [`FileError::NotComplete`] for an unfinished file, [`FileError::Link`]; those of [`Results::open`]; [`FileError::Sealed`] if the file cannot be written:
/// the old one stays.
pub fn replace_trust<R: SystemRow>(
    path: impl AsRef<Path>,
    columns: &'static [Column<R>],
    lines: Vec<TrustLine>,
) -> Result<(), FileError> {
    let path = path.as_ref();
    let place = ResultsPaths { path: path.to_owned(), part: unfinished(path) };
    place.refuse_links()?;
    let store = Store::open(path, columns)?;
    if !store.is_complete() {
        return Err(FileError::NotComplete { path: path.to_owned() });
    }
    let metadata = Metadata { trust: lines, ..store.metadata().clone() };
    let file = complete(&place, &metadata, &store, store.rows(), columns)?;
    place.put_results(file, true)
}

/// A sealed unfinished file that has no name yet.
fn make_room<R: SystemRow>(
    place: &ResultsPaths,
    metadata: &Metadata,
    shapes: ShapeSource<'_>,
    columns: &'static [Column<R>],
    room: Room,
) -> Result<(TemporaryFile, Store), FileError> {
    let file = place.temporary()?;
    let store = Store::create(&file, &place.part, metadata, shapes, columns, room)?;
    store.seal()?;
    Ok((file, store))
}

impl<R: SystemRow> Drop for Writer<R> {
    fn drop(&mut self) {
        // Best effort: there is nobody left to tell. After `finish` there is nothing to do.
        let _ = self.write_waiting();
    }
}
