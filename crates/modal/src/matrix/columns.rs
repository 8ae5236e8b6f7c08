//! The interface that K and M share as sparse symmetric matrices.

use faer::ColRef;
use rayon::prelude::*;

/// A sparse symmetric matrix with both triangles at hand.
pub(crate) trait Columns: Sync {
    /// Number of columns.
    fn ncols(&self) -> usize;

    /// Calls `entry` with the row and the value of each entry of a column.
    fn for_each_in_column(&self, column: usize, entry: impl FnMut(usize, f64));

    /// |A||φ|, which tells what rounding may leave of Aφ.
    fn absolute_product(&self, shape: ColRef<'_, f64>) -> Vec<f64> {
        let magnitudes: Vec<f64> = shape.iter().map(|u| u.abs()).collect();
        let of_row = |row: usize| {
            let mut sum = 0.0;
            // A column of a symmetric matrix is its row.
            self.for_each_in_column(row, |i, value| sum += magnitudes[i] * value.abs());
            sum
        };
        (0..self.ncols()).into_par_iter().map(of_row).collect()
    }

    /// Bound of the rounding error in φᵀAφ from that of the entries: ε |φ|ᵀ|A||φ|.
    fn rounding(&self, shape: ColRef<'_, f64>) -> f64 {
        let products = self.absolute_product(shape);
        f64::EPSILON * products.iter().zip(shape.iter()).map(|(product, u)| product * u.abs()).sum::<f64>()
    }
}
