//! How strongly the spin couples modes of like frequency.

/// Frequencies that differ by less than this part are alike.
const ALIKE: f64 = 0.2;

/// The largest entries of the N_ij and of the G_i, `stacked` matrices of a `size`, by which each mode is coupled to itself and
/// to modes of like frequency. The modes are the first rows and columns of each.
pub(crate) fn own_coupling(circular_frequencies: &[f64], size: usize, stacked: &[f64], g_rows: usize) -> Vec<[f64; 2]> {
    let nf = circular_frequencies.len();
    let rows = stacked.len().checked_div(size).unwrap_or(0);
    let mut coupling = vec![[0.0_f64; 2]; nf];
    for (column, b) in stacked.chunks_exact(rows.max(1)).zip(circular_frequencies) {
        for (row, entry) in column.iter().enumerate() {
            let k = row % size;
            let Some(a) = circular_frequencies.get(k) else { continue };
            if (a - b).abs() <= ALIKE * a {
                let largest = &mut coupling[k][usize::from(row < g_rows)];
                *largest = largest.max(entry.abs());
            }
        }
    }
    coupling
}
