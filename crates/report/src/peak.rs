//! The greatest value that a field of shapes reaches over all rows and vertices.

/// Greatest ‖Σ_k q_k(t) s_k(i)‖ over the rows t and the vertices i, for a seminorm of the `N` components of the field, such
/// as the length of a displacement or the von Mises stress. `coordinates` holds the rows one after the other.
///
/// By the triangle inequality no vertex exceeds Σ_k max_t |q_k| ‖s_k(i)‖, and no row Σ_k |q_k(t)| max_i ‖s_k(i)‖. Rows
/// and vertices whose bound is below what has been found are left out, which in most runs are nearly all.
pub(crate) fn peak<const N: usize>(
    shapes: &[&[[f32; N]]],
    coordinates: &[f64],
    seminorm: impl Fn(&[f64; N]) -> f64,
) -> f64 {
    let Some(vertices) = shapes.first().map(|shape| shape.len()).filter(|count| *count > 0) else { return 0.0 };
    let rows: Vec<&[f64]> = coordinates.chunks_exact(shapes.len()).collect();
    let norm = |k: usize, i: usize| seminorm(&shapes[k][i].map(f64::from));
    let greatest_coordinate = |k: usize| rows.iter().map(|row| f64::abs(row[k])).fold(0.0, f64::max);
    let greatest_norm = |k: usize| (0..vertices).map(|i| norm(k, i)).fold(0.0, f64::max);
    let greatest_coordinates: Vec<f64> = (0..shapes.len()).map(greatest_coordinate).collect();
    let greatest_norms: Vec<f64> = (0..shapes.len()).map(greatest_norm).collect();
    let vertex_bound = |i: usize| (0..shapes.len()).map(|k| greatest_coordinates[k] * norm(k, i)).sum::<f64>();
    let row_bound = |row: &[f64]| row.iter().zip(&greatest_norms).map(|(q, norm)| q.abs() * norm).sum::<f64>();
    let by_bound = descending((0..vertices).map(vertex_bound));

    let mut found = 0.0_f64;
    for (row, bound) in descending(rows.iter().map(|row| row_bound(row))) {
        if bound <= found {
            break;
        }
        for (vertex, bound) in &by_bound {
            if *bound <= found {
                break;
            }
            let mut sum = [0.0; N];
            for (shape, q) in shapes.iter().zip(rows[row]) {
                for (sum, s) in sum.iter_mut().zip(&shape[*vertex]) {
                    *sum += q * f64::from(*s);
                }
            }
            found = found.max(seminorm(&sum));
        }
    }
    found
}

/// Indices with their values, the greatest first.
fn descending(values: impl Iterator<Item = f64>) -> Vec<(usize, f64)> {
    let mut sorted: Vec<(usize, f64)> = values.enumerate().collect();
    sorted.sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
    sorted
}

/// Length of a vector.
pub(crate) fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Von Mises stress of xx, yy, zz, xy, yz, zx.
pub(crate) fn von_mises([xx, yy, zz, xy, yz, zx]: &[f64; 6]) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (normal / 2.0 + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{length, peak, von_mises};

    /// Numbers between -1 and 1 that have no order.
    fn noise(n: usize) -> f64 {
        (n as f64 * 12.9898).sin() * 43_758.545 % 1.0
    }

    /// Independent reference: a plain loop in double precision.
    #[test]
    fn the_peak_is_that_of_all_rows_and_vertices() {
        let (vertices, rows) = (37, 53);
        let shapes: Vec<Vec<[f32; 3]>> = (0..4)
            .map(|k| (0..vertices).map(|i| [0, 1, 2].map(|axis| noise(1000 * k + 3 * i + axis) as f32)).collect())
            .collect();
        let shapes: Vec<&[[f32; 3]]> = shapes.iter().map(Vec::as_slice).collect();
        let coordinates: Vec<f64> = (0..4 * rows).map(|n| noise(7 * n + 5)).collect();
        let mut expected = 0.0_f64;
        for row in coordinates.chunks_exact(4) {
            expected = (0..vertices)
                .map(|i| [0, 1, 2].map(|axis| (0..4).map(|k| row[k] * f64::from(shapes[k][i][axis])).sum()))
                .fold(expected, |expected, sum| expected.max(length(&sum)));
        }
        assert_eq!(peak(&shapes, &coordinates, length), expected);
        assert_eq!(peak::<3>(&[], &[], length), 0.0);
    }

    /// Closed form: von Mises stress of tension, shear and pressure.
    #[test]
    fn von_mises_of_tension_shear_and_pressure() {
        assert_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises(&[4.0, 4.0, 4.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
