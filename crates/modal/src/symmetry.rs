//! Whether both triangles of a sparse matrix are stored, and alike.

use crate::error::ModalError;

/// A difference between the triangles above this, relative to the diagonal, is no rounding.
const TOLERANCE: f64 = 1e-10;

/// Compares the triangles of a matrix in compressed columns with sorted rows, in one pass: the entries below the
/// diagonal, column by column, ask each row's own column for its entries above the diagonal one after the other.
///
/// `row` and `value` give the entry with a number; an index of the matrix stands for `step` degrees of freedom.
pub(crate) fn check_symmetric(
    what: &'static str,
    step: usize,
    start: &[usize],
    row: impl Fn(usize) -> usize,
    value: impl Fn(usize) -> f64,
) -> Result<(), ModalError> {
    let columns = start.windows(2).enumerate().map(|(column, range)| (column, range[0]..range[1]));
    let mut diagonal = vec![0.0; start.len().saturating_sub(1)];
    for (column, entries) in columns.clone() {
        for entry in entries.filter(|entry| row(*entry) == column) {
            diagonal[column] = value(entry).abs();
        }
    }
    let mut next = start.to_vec();
    for (column, entries) in columns {
        for entry in entries {
            let i = row(entry);
            let refuse = |mirrored| {
                let (row, column) = (step * i, step * column);
                Err(ModalError::NotSymmetric { what, row, column, value: value(entry), mirrored })
            };
            if i < column && entry >= next[column] {
                // All entries above the diagonal of this column have been asked for by now.
                return refuse(0.0);
            } else if i > column {
                let mirror = next[i];
                if mirror >= start[i + 1] || row(mirror) != column {
                    return refuse(0.0);
                }
                if (value(entry) - value(mirror)).abs() > TOLERANCE * diagonal[i].max(diagonal[column]) {
                    return refuse(value(mirror));
                }
                next[i] += 1;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of a 3×3 matrix from its dense form; zeros are not stored.
    fn check(dense: [[f64; 3]; 3]) -> Result<(), ModalError> {
        let (mut start, mut rows, mut values) = (vec![0], vec![], vec![]);
        for column in 0..3 {
            for (row, line) in dense.iter().enumerate().filter(|(_, line)| line[column] != 0.0) {
                rows.push(row);
                values.push(line[column]);
            }
            start.push(rows.len());
        }
        check_symmetric("stiffness", 1, &start, |entry| rows[entry], |entry| values[entry])
    }

    #[test]
    fn a_missing_or_different_mirror_image_is_named() {
        assert!(check([[2.0, 1.0, 0.0], [1.0, 2.0, 3.0], [0.0, 3.0, 2.0]]).is_ok());
        assert!(check([[2.0, 1.0, 0.0], [1.0 + 1e-12, 2.0, 0.0], [0.0, 0.0, 0.0]]).is_ok());
        for (dense, at) in [
            ([[2.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 3.0, 2.0]], (1, 0)),
            ([[2.0, 1.0, 0.0], [0.0, 2.0, 3.0], [0.0, 0.0, 2.0]], (0, 1)),
            ([[2.0, 1.0, 5.0], [1.0, 2.0, 3.0], [0.0, 3.0, 2.0]], (2, 1)),
            ([[2.0, 1.0, 0.0], [1.0, 2.0, 3.0], [0.0, 3.1, 2.0]], (2, 1)),
        ] {
            match check(dense) {
                Err(ModalError::NotSymmetric { row, column, .. }) => assert_eq!((row, column), at),
                other => panic!("{other:?}"),
            }
        }
    }
}
