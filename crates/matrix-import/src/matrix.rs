//! One matrix: both triangles, checked.

use std::ops::ControlFlow;

use faer::sparse::{SparseColMat, Triplet};

use crate::entries::{Form, Index, Rows, Written, each_entry};
use crate::error::MatrixError;
use crate::source::Source;

/// A difference between the triangles above this, relative to the larger diagonal entry, is no rounding.
const SYMMETRIC: f64 = 1e-10;

/// Bytes that are taken for a byte of the file, at the most: `1 1 1` with its line break is an entry of 16 bytes, and twice as
/// many while the list grows.
const BYTES: usize = 6;

/// An entry by the places of its row and its column.
type Entry = (u32, u32, f64);

/// A symmetric matrix by its lower triangle, entries once each.
pub(crate) struct Symmetric {
    pub form: Form,
    /// Largest number of a row, for matrices whose rows have numbers.
    pub size: usize,
    lower: Vec<Entry>,
    /// Largest difference of the triangles, relative to the diagonal; `None` where the file has only one.
    pub asymmetry: Option<f64>,
}

impl Symmetric {
    /// Reads a file. Rows with labels are added to `rows`; `most` rows can have numbers.
    pub fn read(source: &Source<'_>, rows: &mut Rows, most: usize) -> Result<Self, MatrixError> {
        memory::check("the entries of a matrix file", BYTES.saturating_mul(source.length()?))?;
        let mut entries: Vec<Entry> = Vec::new();
        let mut size = 0;
        let form = each_entry(source, |_, Written { line, row, column, value }| {
            if let Some(number) = [row, column].into_iter().find_map(|index| beyond(index, most)) {
                let expected = format!("rows and columns up to {most}: six for each node, or as many as `dofs` lists");
                let help = "give all nodes of the matrices, and the list of rows that was written with them";
                return Err(source.refuse(Some(line), format!("row or column {number}"), expected, help));
            }
            let mut place = |index| match index {
                Index::Number(number) => {
                    size = size.max(number);
                    number - 1
                }
                Index::Of { .. } => rows.place(index),
            };
            entries.push((place(row), place(column), value));
            Ok(ControlFlow::Continue(()))
        })?;
        let size = match form {
            Form::MatrixMarket { size, .. } => size,
            Form::Triplets | Form::Labelled => size as usize,
        };
        let (lower, asymmetry) = lower_triangle(source, form, entries, rows)?;
        Ok(Self { form, size, lower, asymmetry })
    }

    /// The matrix with both triangles, its row with each place at the row that `to` says.
    pub fn permuted(&self, source: &Source<'_>, to: &[usize]) -> Result<SparseColMat<usize, f64>, MatrixError> {
        memory::check("a matrix", 2 * 4 * 24 * self.lower.len())?;
        let mut triplets = Vec::with_capacity(2 * self.lower.len());
        for &(i, j, value) in &self.lower {
            let (i, j) = (to[i as usize], to[j as usize]);
            triplets.push(Triplet::new(i, j, value));
            if i != j {
                triplets.push(Triplet::new(j, i, value));
            }
        }
        SparseColMat::try_new_from_triplets(to.len(), to.len(), &triplets).map_err(|error| {
            source.refuse(None, format!("entries that make no matrix: {error:?}"), "a sparse matrix", "write it again")
        })
    }
}

/// The number of a row that there cannot be.
fn beyond(index: Index, most: usize) -> Option<u32> {
    match index {
        Index::Number(number) => Some(number).filter(|number| *number as usize > most),
        Index::Of { .. } => None,
    }
}

/// The lower triangle of entries that are one triangle, in whatever order, or both alike.
fn lower_triangle(
    source: &Source<'_>,
    form: Form,
    mut entries: Vec<Entry>,
    rows: &Rows,
) -> Result<(Vec<Entry>, Option<f64>), MatrixError> {
    let sorted_by = |&(i, j, _): &Entry| (i.max(j), i.min(j), i < j);
    entries.sort_unstable_by_key(sorted_by);
    let same = |a: &Entry, b: &Entry| (a.0, a.1) == (b.0, b.1);
    if let Some(pair) = entries.windows(2).find(|pair| same(&pair[0], &pair[1])) {
        let (row, column, _) = pair[0];
        return Err(source.refuse(
            last_line(source, rows, row, column)?,
            format!("the entry of row {} and column {} a second time", name(form, rows, row), name(form, rows, column)),
            "each entry once",
            "add up the parts of an entry before the matrix is written",
        ));
    }
    let largest = entries.iter().map(|(i, j, _)| 1 + i.max(j)).max().unwrap_or_default() as usize;
    let mut diagonal = vec![0.0; largest];
    entries.iter().filter(|(i, j, _)| i == j).for_each(|(i, _, value)| diagonal[*i as usize] = *value);

    let mut lower: Vec<Entry> = Vec::new();
    let (mut asymmetry, mut alone, mut has_pairs) = (0.0_f64, None, false);
    let mut rest = &entries[..];
    while let [first, after @ ..] = rest {
        let (row, column, value) = *first;
        let mirrored = after.first().filter(|next| row != column && (next.0, next.1) == (column, row));
        let place = (row.max(column), row.min(column));
        let scale = diagonal[row as usize].abs().max(diagonal[column as usize].abs());
        match mirrored {
            Some((_, _, other)) => {
                has_pairs = true;
                if (value - other).abs() > SYMMETRIC * scale {
                    return Err(not_symmetric(source, form, rows, *first, *other));
                }
                if scale > 0.0 {
                    asymmetry = asymmetry.max((value - other).abs() / scale);
                }
                lower.push((place.0, place.1, 0.5 * value + 0.5 * other));
                rest = &after[1..];
            }
            None => {
                if row != column && value.abs() > SYMMETRIC * scale {
                    alone = alone.or(Some(*first));
                }
                lower.push((place.0, place.1, value));
                rest = after;
            }
        }
    }
    // A list of triplets may be one triangle without saying so.
    let has_both = has_pairs || matches!(form, Form::MatrixMarket { symmetric: false, .. });
    if let Some(entry) = alone.filter(|_| has_both) {
        return Err(not_symmetric(source, form, rows, entry, 0.0));
    }
    Ok((lower, has_pairs.then_some(asymmetry)))
}

fn not_symmetric(source: &Source<'_>, form: Form, rows: &Rows, entry: Entry, mirrored: f64) -> MatrixError {
    let (row, column, value) = entry;
    let line = last_line(source, rows, row, column).unwrap_or_default();
    let (i, j) = (name(form, rows, row), name(form, rows, column));
    source.refuse(
        line,
        format!("a matrix that is not symmetric: the entry of row {i} and column {j} is {value:e}, that of row {j} and column {i} {mirrored:e}"),
        "the symmetric matrix of an elastic structure",
        "leave out what makes it unsymmetric (gyroscopic terms, follower loads, friction), or write both triangles whole; if it is \
         rounding, write (A + Aᵀ)/2",
    )
}

/// Name of the row with a place in the file.
fn name(form: Form, rows: &Rows, place: u32) -> Index {
    match form {
        Form::Labelled => rows.list[place as usize],
        Form::MatrixMarket { .. } | Form::Triplets => Index::Number(place + 1),
    }
}

/// The line of the last entry of a row and a column, looked up in the file: lines are not kept.
fn last_line(source: &Source<'_>, rows: &Rows, row: u32, column: u32) -> Result<Option<usize>, MatrixError> {
    let mut found = None;
    each_entry(source, |form, written| {
        if written.row == name(form, rows, row) && written.column == name(form, rows, column) {
            found = Some(written.line);
        }
        Ok(ControlFlow::Continue(()))
    })?;
    Ok(found)
}
