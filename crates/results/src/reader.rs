//! Reads a results file back, finished or not.

use crate::checkpoint::{Checkpoint, Sums};
use crate::column::{of_point, present};
use crate::container::description::Description;
use crate::container::seal;
use crate::container::store::Store;
use crate::{Column, FileError, Metadata, Shapes};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

/// A results file in memory; rows are output times.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Metadata of the run as a whole; the points in the order in which they were given.
    pub metadata: Metadata,
    /// True if the run came to its end.
    pub complete: bool,
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
    /// [`FileError::NoSeal`], [`FileError::OtherVersion`] and [`FileError::Damaged`] if it is not what a [`Writer`](crate::Writer) wrote, or those of
    /// [`Writer::create`](crate::Writer::create) for its metadata; [`FileError::Busy`] if another process writes it;
    /// [`FileError::System`] if it cannot be read.
    pub fn open<R>(path: impl AsRef<Path>, columns: &'static [Column<R>]) -> Result<Self, FileError> {
        let path = path.as_ref();
        Ok(Self::read_with_checkpoint(&Store::open(path, columns)?, path, columns)?.0)
    }

    /// The same, with the shapes of the body, if the file carries them.
    ///
    /// # Errors
    /// As [`Results::open`].
    pub fn open_with_shapes<R>(
        path: impl AsRef<Path>,
        columns: &'static [Column<R>],
    ) -> Result<(Self, Option<Shapes>), FileError> {
        let path = path.as_ref();
        let store = Store::open(path, columns)?;
        Ok((Self::read_with_checkpoint(&store, path, columns)?.0, store.read_shapes(path)?))
    }

    /// Metadata of a file, without a look at its rows.
    ///
    /// # Errors
    /// [`FileError::NoSeal`], [`FileError::Damaged`] and [`FileError::System`], as [`Results::open`].
    pub fn metadata_of(path: impl AsRef<Path>) -> Result<Metadata, FileError> {
        let path = path.as_ref();
        // To open a pipe is to wait for who writes into it.
        if path.exists() && !path.is_file() {
            return Err(FileError::NoSeal { path: path.to_path_buf() });
        }
        let file = File::open(path).map_err(|error| FileError::system(path, "open the file", &error))?;
        let metadata = Description::from_json(path, &seal::description(&file, path)?)?.metadata;
        metadata.check(path)?;
        Ok(metadata)
    }

    /// With the last checkpoint of an unfinished file whose rows are as they were then, and their sums.
    pub(crate) fn read_with_checkpoint<R>(
        store: &Store,
        path: &Path,
        table: &'static [Column<R>],
    ) -> Result<(Self, Option<(Checkpoint, Sums)>), FileError> {
        let metadata = store.metadata().clone();
        let complete = store.is_complete();
        let (rows, columns) = store.read(path)?;
        // Whole ones, the last first.
        let places = store.read_checkpoints(path)?;
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
            return Err(FileError::Damaged { path: path.to_path_buf(), what });
        }
        let mut histories = BTreeMap::new();
        for (column, (mut values, width)) in present(table, &metadata).zip(columns.into_iter().zip(store.widths())) {
            values.truncate(rows * width);
            let each = column.per_point();
            if each == 0 {
                histories.insert(column.path.to_owned(), ColumnTable { rows, width, values });
                continue;
            }
            for (point, name) in column.places(&metadata).iter().enumerate() {
                let its_part = each * point..each * (point + 1);
                let values = values.chunks_exact(width).flat_map(|row| &row[its_part.clone()]).copied().collect();
                histories.insert(of_point(column.path, name), ColumnTable { rows, width: each, values });
            }
        }
        Ok((Self { metadata, complete, rows, histories }, checkpoint))
    }

    /// Number of rows, T.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The history of this path, such as "modal/displacement", or "points/P1/velocity" of the point P1 and
    /// "supports/2/force" of the support 2, if there is one.
    pub fn table(&self, path: &str) -> Option<&ColumnTable> {
        self.histories.get(path)
    }

    /// The history of this path, if there is one with one value a row, such as "energy/work".
    pub fn numbers(&self, path: &str) -> Option<&[f64]> {
        self.vectors(path).map(<[[f64; 1]]>::as_flattened)
    }

    /// The history of this path, if there is one with `N` values a row, such as "position".
    pub fn vectors<const N: usize>(&self, path: &str) -> Option<&[[f64; N]]> {
        let table = self.table(path).filter(|table| table.width == N)?;
        Some(table.values.as_chunks().0)
    }

    /// All values of a column, row by row, as they are in its dataset: of a column with a value for each point, those of all
    /// points of a row beside each other. Empty if the file does not have the column.
    pub fn dataset<R>(&self, column: &Column<R>) -> Vec<f64> {
        let names = column.places(&self.metadata);
        if column.per_point() == 0 {
            return self.table(column.path).map_or_else(Vec::new, |table| table.values.clone());
        }
        let tables: Vec<&ColumnTable> =
            names.iter().filter_map(|name| self.table(&of_point(column.path, name))).collect();
        (0..self.rows).flat_map(|i| tables.iter().filter_map(move |table| table.row(i)).flatten().copied()).collect()
    }

    /// True if row `i` is this one, to the last bit of every column.
    pub fn is_row<R>(&self, i: usize, columns: &'static [Column<R>], row: &R) -> bool {
        let mut values = Vec::new();
        let is = |path: &str, values: &[f64]| self.table(path).and_then(|table| table.row(i)) == Some(values);
        present(columns, &self.metadata).all(|column| {
            values.clear();
            column.append(row, &self.metadata, &mut values);
            let names = column.places(&self.metadata);
            match column.per_point() {
                0 => is(column.path, &values),
                each => {
                    let mut of_points = names.iter().zip(values.chunks_exact(each));
                    values.len() == each * names.len()
                        && of_points.all(|(name, values)| is(&of_point(column.path, name), values))
                }
            }
        })
    }

    /// Keeps the first `rows` rows only.
    pub(crate) fn truncate(&mut self, rows: usize) {
        self.rows = self.rows.min(rows);
        self.histories.values_mut().for_each(|table| table.truncate(rows));
    }
}
