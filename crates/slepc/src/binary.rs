//! PETSc's binary form: numbers of four and eight bytes, the highest first.
//!
//! A matrix is its kind, rows, columns and entries, then the number of entries of each row, the columns of all entries, their
//! values. A vector is its kind, its length and its values; a file may have several.

use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use diagnostic::Failure;
use faer::{Mat, MatRef};
use foreign_program::open_ordinary;
use modal::HeldMatrix;

use crate::error::{self, failed};

/// The kind of a sparse matrix (`MAT_FILE_CLASSID`).
const MATRIX: i32 = 1_211_216;
/// The kind of a vector (`VEC_FILE_CLASSID`).
const VECTOR: i32 = 1_211_214;

/// Writes a sparse matrix.
pub(crate) fn write_matrix(matrix: &HeldMatrix<'_>, file: &mut impl Write) -> io::Result<()> {
    let size = matrix.size();
    let lengths: Vec<usize> = (0..size)
        .map(|row| {
            let mut length = 0;
            matrix.for_each_in_row(row, |_, _| length += 1);
            length
        })
        .collect();
    // What 32 bits cannot number, PETSc reads from the lengths of the rows.
    let entries = i32::try_from(lengths.iter().sum::<usize>()).unwrap_or(i32::MAX);
    for number in [MATRIX, whole(size)?, whole(size)?, entries] {
        file.write_all(&number.to_be_bytes())?;
    }
    for length in lengths {
        file.write_all(&whole(length)?.to_be_bytes())?;
    }
    let each = |write: &mut dyn FnMut(usize, f64) -> io::Result<()>| {
        (0..size).try_for_each(|row| {
            let mut done = Ok(());
            matrix.for_each_in_row(row, |column, value| {
                if done.is_ok() {
                    done = write(column, value);
                }
            });
            done
        })
    };
    each(&mut |column, _| file.write_all(&whole(column)?.to_be_bytes()))?;
    each(&mut |_, value| file.write_all(&value.to_be_bytes()))
}

/// Writes the columns of a matrix as vectors.
pub(crate) fn write_vectors(vectors: MatRef<'_, f64>, file: &mut impl Write) -> io::Result<()> {
    for vector in vectors.col_iter() {
        for number in [VECTOR, whole(vector.nrows())?] {
            file.write_all(&number.to_be_bytes())?;
        }
        vector.iter().try_for_each(|value| file.write_all(&value.to_be_bytes()))?;
    }
    Ok(())
}

/// Reads a number of vectors with a number of rows each.
pub(crate) fn read_vectors(path: &Path, rows: usize, count: usize) -> Result<Mat<f64>, Failure> {
    let file = open_ordinary(path).map_err(failed(path, "open it"))?;
    let damaged = |words: String| error::damaged(path, words);
    // Before any memory is taken for what a file merely claims.
    let found = file.metadata().map_err(failed(path, "open it"))?.len();
    let whole = (rows as u64).saturating_mul(8).saturating_add(8);
    if found < whole.saturating_mul(count as u64) {
        return Err(damaged(format!("it ends in vector {} of {count}", found / whole + 1)));
    }
    let mut file = BufReader::new(file);
    let mut vectors = Mat::zeros(rows, count);
    for k in 0..count {
        let cut = |_| damaged(format!("it ends in vector {} of {count}", k + 1));
        let mut word = [0; 4];
        for expected in [VECTOR as usize, rows] {
            file.read_exact(&mut word).map_err(cut)?;
            let found = i32::from_be_bytes(word);
            if usize::try_from(found) != Ok(expected) {
                return Err(damaged(format!("found {found} at the head of vector {}, expected {expected}", k + 1)));
            }
        }
        let mut bytes = vec![0; 8 * rows];
        file.read_exact(&mut bytes).map_err(cut)?;
        for (value, bytes) in vectors.col_mut(k).iter_mut().zip(bytes.as_chunks().0) {
            *value = f64::from_be_bytes(*bytes);
        }
        if let Some(value) = vectors.col(k).iter().copied().find(|value| !value.is_finite()) {
            return Err(damaged(format!("vector {} has a {value}", k + 1)));
        }
    }
    Ok(vectors)
}

/// A number of 32 bits, which is what PETSc numbers rows with.
fn whole(number: usize) -> io::Result<i32> {
    let too_large = |_| io::Error::new(io::ErrorKind::InvalidInput, format!("{number} is no number of 32 bits"));
    i32::try_from(number).map_err(too_large)
}
