//! Check that both triangles of a sparse matrix are stored, and alike.

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

/// The same for a matrix of 3×3 blocks, a block for each of the pairs of `nodes` in compressed columns. `values` are its
/// entries by columns: those of the three axes of a node, in each the rows of the three axes of the others.
pub(crate) fn check_symmetric_blocks(
    what: &'static str,
    start: &[usize],
    nodes: &[u32],
    values: &[f64],
) -> Result<(), ModalError> {
    let count = start.len().saturating_sub(1);
    let columns = |node: usize| Columns::new(values, start[node], start[node + 1]);
    let mut diagonal = vec![0.0; count];
    for (node, least) in diagonal.iter_mut().enumerate() {
        if let Ok(place) = nodes[start[node]..start[node + 1]].binary_search(&(node as u32)) {
            let block = columns(node).block(place);
            *least = block[0][0].abs().min(block[1][1].abs()).min(block[2][2].abs());
        }
    }
    let mut next = start.to_vec();
    for node in 0..count {
        let own = columns(node);
        for (place, other) in nodes[start[node]..start[node + 1]].iter().enumerate() {
            let (other, entry) = (*other as usize, start[node] + place);
            let refuse = |row: usize, column: usize, value: f64, mirrored: f64| {
                Err(ModalError::NotSymmetric { what, row: 3 * other + row, column: 3 * node + column, value, mirrored })
            };
            if other < node {
                // All blocks above the diagonal of this column have been asked for by now.
                if entry >= next[node] {
                    return refuse(0, 0, own.block(place)[0][0], 0.0);
                }
                continue;
            }
            let block = own.block(place);
            let mirror = if other == node { entry } else { next[other] };
            if mirror >= start[other + 1] || nodes[mirror] as usize != node {
                return refuse(0, 0, block[0][0], 0.0);
            }
            if other > node {
                next[other] += 1;
            }
            let mirrored = columns(other).block(mirror - start[other]);
            let limit = TOLERANCE * diagonal[node].max(diagonal[other]);
            let mut worst = 0.0_f64;
            for column in 0..3 {
                for row in 0..3 {
                    worst = worst.max((block[column][row] - mirrored[row][column]).abs());
                }
            }
            if worst <= limit {
                continue;
            }
            for column in 0..3 {
                for row in 0..3 {
                    if (block[column][row] - mirrored[row][column]).abs() > limit {
                        return refuse(row, column, block[column][row], mirrored[row][column]);
                    }
                }
            }
        }
    }
    Ok(())
}

/// The three columns of a node in a matrix of blocks.
struct Columns<'a>([&'a [[f64; 3]]; 3]);

impl<'a> Columns<'a> {
    /// The cursor over the pairs from `start` to `end`.
    #[inline(always)]
    fn new(values: &'a [f64], start: usize, end: usize) -> Self {
        let (x, rest) = values[9 * start..9 * end].as_chunks().0.split_at(end - start);
        let (y, z) = rest.split_at(end - start);
        Self([x, y, z])
    }

    /// A block: axis of the column, axis of the row.
    #[inline(always)]
    fn block(&self, place: usize) -> [[f64; 3]; 3] {
        let Self([x, y, z]) = self;
        [x[place], y[place], z[place]]
    }
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

    /// A ring of nodes with blocks that are not diagonal, in compressed columns.
    fn blocks(nodes: usize) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
        let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        let entry = |i: usize, j: usize| ((i.min(j) * 7 + i.max(j) * 13) as f64).sin() + if i == j { 9.0 } else { 0.0 };
        for node in 0..nodes {
            let mut own = [node, (node + 1) % nodes, (node + nodes - 1) % nodes];
            own.sort_unstable();
            for column in 3 * node..3 * node + 3 {
                values.extend(own.iter().flat_map(|i| 3 * i..3 * i + 3).map(|row| entry(row, column)));
            }
            rows.extend(own.iter().map(|i| *i as u32));
            start.push(rows.len());
        }
        (start, rows, values)
    }

    #[test]
    fn a_block_that_is_missing_or_different_is_named() {
        let (start, nodes, values) = blocks(6);
        assert!(check_symmetric_blocks("stiffness", &start, &nodes, &values).is_ok());
        // Node 2 has the nodes 1, 2 and 3: in its first column, the row along z of node 3.
        let place = 9 * start[2] + 8;
        let mut different = values.clone();
        different[place] += 1e-3;
        match check_symmetric_blocks("stiffness", &start, &nodes, &different) {
            Err(ModalError::NotSymmetric { row, column, .. }) => assert_eq!([row, column], [11, 6]),
            other => panic!("{other:?}"),
        }
        // Without the block of node 3 in the columns of node 2.
        let (mut fewer, mut left) = (nodes.clone(), values.clone());
        fewer.remove(start[2] + 2);
        (0..3).rev().for_each(|axis| drop(left.drain(9 * start[2] + 9 * axis + 6..9 * start[2] + 9 * axis + 9)));
        let shorter: Vec<usize> = start.iter().enumerate().map(|(i, s)| if i > 2 { s - 1 } else { *s }).collect();
        match check_symmetric_blocks("stiffness", &shorter, &fewer, &left) {
            Err(ModalError::NotSymmetric { row, column, .. }) => assert_eq!([row / 3, column / 3], [2, 3]),
            other => panic!("{other:?}"),
        }
    }
}
