//! Reads a results file back, finished or not.

use crate::checkpoint::{Checkpoint, Sums};
use crate::column::SystemRow;
use crate::container::store::{Store, is_complete, metadata_of};
use crate::history::{History, histories};
use crate::{BodyMetadata, Column, FileError, Metadata, Shapes};
use sealed::{Format, SealedFile};
use std::collections::BTreeMap;
use std::path::Path;

/// A results file in memory; rows are output times, the same for all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Metadata of the run as a whole; bodies and points in the order in which they were given.
    pub metadata: Metadata,
    /// True if the run came to its end.
    pub complete: bool,
    /// Time of the first row that no check sum covers: of an unfinished file, of the one after its last checkpoint.
    pub unchecked_from: Option<f64>,
    rows: usize,
    /// By path.
    histories: BTreeMap<String, ColumnTable>,
}

/// A T×n table, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnTable {
    rows: usize,
    width: usize,
    values: Vec<f64>,
}

impl ColumnTable {
    /// Number of rows, T.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Values per row, n.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Row `i`, if there is one.
    pub fn row(&self, i: usize) -> Option<&[f64]> {
        (i < self.rows).then(|| &self.values[i * self.width..(i + 1) * self.width])
    }

    /// All values, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The history of column `k`, if there is one.
    pub fn column(&self, k: usize) -> Option<impl Iterator<Item = f64>> {
        (k < self.width).then(|| self.values.iter().skip(k).step_by(self.width).copied())
    }

    fn truncate(&mut self, rows: usize) {
        self.rows = self.rows.min(rows);
        self.values.truncate(self.rows * self.width);
    }
}

impl Results {
    /// Reads the whole file, whose columns are those it was written with. Of an unfinished one, the rows that every
    /// dataset has.
    ///
    /// # Errors
    /// [`FileError::Sealed`] if it is not what a [`Writer`](crate::Writer) wrote or cannot be read, or those of
    /// [`Writer::create`](crate::Writer::create) for its metadata; [`FileError::Busy`] if another process writes it.
    pub fn open<R: SystemRow>(path: impl AsRef<Path>, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        let path = path.as_ref();
        Ok(Self::read_with_checkpoint(&Store::open(path, columns)?, columns)?.0)
    }

    /// The same, with the shapes of each body, if the file carries them.
    ///
    /// # Errors
    /// As [`Results::open`].
    pub fn open_with_shapes<R: SystemRow>(
        path: impl AsRef<Path>,
        columns: &'static [Column<R>],
    ) -> Result<(Self, Vec<Option<Shapes>>), FileError> {
        let path = path.as_ref();
        let store = Store::open(path, columns)?;
        Ok((Self::read_with_checkpoint(&store, columns)?.0, store.read_shapes()?))
    }

    /// Metadata of a file, without a look at its rows.
    ///
    /// # Errors
    /// [`FileError::Sealed`], as [`Results::open`].
    pub fn metadata_of(path: impl AsRef<Path>) -> Result<Metadata, FileError> {
        let path = path.as_ref();
        metadata_of(&SealedFile::open(path, Format::RESULTS)?)
    }

    /// True if the run of a file came to its end, without a look at its rows.
    ///
    /// # Errors
    /// [`FileError::Sealed`], as [`Results::open`].
    pub fn is_complete(path: impl AsRef<Path>) -> Result<bool, FileError> {
        Ok(is_complete(&SealedFile::open(path.as_ref(), Format::RESULTS)?))
    }

    /// With the last checkpoint of an unfinished file whose rows are as they were then, and their sums.
    pub(crate) fn read_with_checkpoint<R: SystemRow>(
        store: &Store,
        table: &'static [Column<R>],
    ) -> Result<(Self, Option<(Checkpoint, Sums)>), FileError> {
        let metadata = store.metadata().clone();
        let complete = store.is_complete();
        let (rows, columns) = store.read()?;
        // Whole ones, the last first.
        let places = store.read_checkpoints()?;
        let mut checkpoints: Vec<Checkpoint> =
            places.chunks(store.checkpoint_words().max(1)).filter_map(Checkpoint::read).collect();
        checkpoints.sort_unstable_by_key(|checkpoint| std::cmp::Reverse(checkpoint.serial));
        let sums = |checkpoint: &Checkpoint| {
            let mut sums = Sums::new(columns.len());
            sums.add(columns.iter().zip(store.widths()).map(|(column, width)| &column[..checkpoint.rows * width]));
            sums
        };
        let known = checkpoints.iter().map(|checkpoint| checkpoint.rows).max();
        let checkpoint = checkpoints.into_iter().filter(|checkpoint| checkpoint.rows <= rows).find_map(|checkpoint| {
            let sums = sums(&checkpoint);
            (sums.total() == checkpoint.sum_of_rows).then_some((checkpoint, sums))
        });
        if let (Some(known), None) = (known, &checkpoint) {
            let what = format!("its first {known} rows are not those that its checkpoint is for");
            return Err(store.damaged(what));
        }
        let mut tables = BTreeMap::new();
        let mut columns = columns.into_iter();
        let mut times = columns.next().unwrap_or_default();
        times.truncate(rows);
        let checked = checkpoint.as_ref().map_or(0, |(checkpoint, _)| checkpoint.rows);
        let unchecked_from = times.get(checked).copied().filter(|_| !complete);
        tables.insert("time".to_owned(), ColumnTable { rows, width: 1, values: times });
        for (history, mut values) in histories(table, &metadata).zip(columns) {
            let (width, each) = (history.width(&metadata), history.values_of_each(&metadata));
            values.truncate(rows * width);
            if !history.is_of_places() {
                tables.insert(history.path(&metadata), ColumnTable { rows, width, values });
                continue;
            }
            for (place, name) in history.places(&metadata).iter().enumerate() {
                let its_part = each * place..each * (place + 1);
                let values = values.chunks_exact(width).flat_map(|row| &row[its_part.clone()]).copied().collect();
                tables.insert(history.path_of(&metadata, Some(name)), ColumnTable { rows, width: each, values });
            }
        }
        Ok((Self { metadata, complete, unchecked_from, rows, histories: tables }, checkpoint))
    }

    /// Number of rows, T.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The history of this path, such as "time", "bodies/ring/modal/displacement", "bodies/ring/points/P1/velocity" of the point
    /// P1 and "bodies/ring/supports/2/force" of the support 2, if there is one. Of a single body the path may begin after its
    /// name, as "points/P1/velocity".
    pub fn table(&self, path: &str) -> Option<&ColumnTable> {
        let of_body = || self.histories.get(&self.metadata.only_body()?.path(path));
        self.histories.get(path).or_else(of_body)
    }

    /// The histories of each body.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyResults<'_>> {
        self.metadata.bodies.iter().map(|metadata| BodyResults { results: self, metadata })
    }

    /// The history of this path, if there is one with one value a row, such as "system/energy/work".
    pub fn numbers(&self, path: &str) -> Option<&[f64]> {
        self.vectors(path).map(<[[f64; 1]]>::as_flattened)
    }

    /// The history of this path, if there is one with `N` values a row, such as "system/momentum/linear".
    pub fn vectors<const N: usize>(&self, path: &str) -> Option<&[[f64; N]]> {
        let table = self.table(path).filter(|table| table.width == N)?;
        Some(table.values.as_chunks().0)
    }

    /// All values of a history, row by row, as they are in its dataset: with a value for each point, those of all points of a
    /// row beside each other.
    pub fn dataset<R: SystemRow>(&self, history: History<R>) -> Vec<f64> {
        let metadata = &self.metadata;
        if !history.is_of_places() {
            return self.table(&history.path(metadata)).map_or_else(Vec::new, |table| table.values.clone());
        }
        let of_place = |name: &String| self.table(&history.path_of(metadata, Some(name)));
        let tables: Vec<&ColumnTable> = history.places(metadata).iter().filter_map(of_place).collect();
        (0..self.rows).flat_map(|i| tables.iter().filter_map(move |table| table.row(i)).flatten().copied()).collect()
    }

    /// True if row `i` is this one, to the last bit of every column.
    pub fn is_row<R: SystemRow>(&self, i: usize, columns: &'static [Column<R>], row: &R) -> bool {
        let metadata = &self.metadata;
        let is = |path: &str, values: &[f64]| self.table(path).and_then(|table| table.row(i)) == Some(values);
        let mut values = Vec::new();
        row.bodies().len() == metadata.bodies.len()
            && row.joints().len() == metadata.joints.len()
            && is("time", &[row.time()])
            && histories(columns, metadata).all(|history| {
                values.clear();
                history.append(row, metadata, &mut values);
                if !history.is_of_places() {
                    return is(&history.path(metadata), &values);
                }
                let (names, each) = (history.places(metadata), history.values_of_each(metadata));
                let mut of_places = names.iter().zip(values.chunks_exact(each.max(1)));
                values.len() == each * names.len()
                    && of_places.all(|(name, values)| is(&history.path_of(metadata, Some(name)), values))
            })
    }

    /// Keeps the first `rows` rows only.
    pub(crate) fn truncate(&mut self, rows: usize) {
        self.rows = self.rows.min(rows);
        self.histories.values_mut().for_each(|table| table.truncate(rows));
        let last = self.numbers("time").and_then(|times| times.last().copied());
        self.unchecked_from = self.unchecked_from.filter(|from| last.is_some_and(|last| *from <= last));
    }
}

/// The histories of one body.
#[derive(Debug, Clone, Copy)]
pub struct BodyResults<'a> {
    results: &'a Results,
    /// Everything of it that does not change with time.
    pub metadata: &'a BodyMetadata,
}

impl<'a> BodyResults<'a> {
    /// The history of this path, such as "modal/displacement" or "points/P1/velocity", if there is one.
    pub fn table(&self, path: &str) -> Option<&'a ColumnTable> {
        self.results.histories.get(&self.metadata.path(path))
    }

    /// As [`Results::numbers`].
    pub fn numbers(&self, path: &str) -> Option<&'a [f64]> {
        self.vectors(path).map(<[[f64; 1]]>::as_flattened)
    }

    /// As [`Results::vectors`].
    pub fn vectors<const N: usize>(&self, path: &str) -> Option<&'a [[f64; N]]> {
        let table = self.table(path).filter(|table| table.width == N)?;
        Some(table.values.as_chunks().0)
    }
}
