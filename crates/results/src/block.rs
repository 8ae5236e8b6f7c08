//! Rows that wait to be written: they come row by row, and go column by column.

/// Rows, each with the values of all columns beside each other.
#[derive(Debug)]
pub(crate) struct Block {
    /// Values per row of each column.
    widths: Vec<usize>,
    /// Row by row.
    pub values: Vec<f64>,
    /// The same column by column, when that was last asked for.
    by_columns: Vec<f64>,
}

impl Block {
    /// A block with room for a number of rows.
    pub(crate) fn new(widths: Vec<usize>, rows: usize) -> Self {
        let numbers = rows * widths.iter().sum::<usize>();
        Self { widths, values: Vec::with_capacity(numbers), by_columns: vec![0.0; numbers] }
    }

    /// Keeps the first rows only.
    pub(crate) fn truncate(&mut self, rows: usize) {
        self.values.truncate(rows * self.widths.iter().sum::<usize>());
    }

    /// The values of each column.
    pub(crate) fn columns(&mut self) -> impl Iterator<Item = &[f64]> + Clone {
        let Self { widths, values, by_columns } = self;
        let row = widths.iter().sum::<usize>().max(1);
        let rows = values.len() / row;
        let (mut rest, mut first) = (&mut by_columns[..rows * row], 0);
        for width in &*widths {
            let (column, others) = rest.split_at_mut(rows * width);
            // Of known length, a copy is no call.
            match width {
                1 => gather::<1>(values, row, first, column),
                3 => gather::<3>(values, row, first, column),
                4 => gather::<4>(values, row, first, column),
                6 => gather::<6>(values, row, first, column),
                _ => {
                    for (column, row) in column.chunks_exact_mut((*width).max(1)).zip(values.chunks_exact(row)) {
                        column.copy_from_slice(&row[first..first + width]);
                    }
                }
            }
            (rest, first) = (others, first + width);
        }
        let mut rest = &by_columns[..rows * row];
        widths.iter().map(move |width| {
            let (column, others) = rest.split_at(rows * width);
            rest = others;
            column
        })
    }
}

/// Copies N values of each row, from the one at `first` on.
fn gather<const N: usize>(values: &[f64], row: usize, first: usize, column: &mut [f64]) {
    for (column, row) in column.as_chunks_mut::<N>().0.iter_mut().zip(values.chunks_exact(row)) {
        if let Some(of_row) = row[first..].first_chunk::<N>() {
            *column = *of_row;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_the_values_of_their_rows_whatever_their_widths() {
        let widths = [1, 4, 0, 3, 7, 1, 6, 3, 2];
        let numbers: usize = widths.iter().sum();
        let mut block = Block::new(widths.to_vec(), 5);
        for rows in [0, 1, 5, 3] {
            block.truncate(0);
            block.values.extend((0..rows * numbers).map(|i| i as f64));
            let mut first = 0;
            let columns = block.columns();
            assert_eq!(columns.clone().count(), widths.len());
            for (column, width) in columns.zip(widths) {
                let of_row = |row: usize| (first..first + width).map(move |k| (row * numbers + k) as f64);
                assert_eq!(column, (0..rows).flat_map(of_row).collect::<Vec<_>>(), "{rows} rows, width {width}");
                first += width;
            }
        }
    }
}
