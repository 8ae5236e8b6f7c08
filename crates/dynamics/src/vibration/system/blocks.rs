//! Matrices over the coordinates of all bodies, in blocks of bodies that meet: of a million of them a chain of a thousand bodies has three thousand.

use std::collections::BTreeMap;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

/// A matrix by the first row and the first column of each block; all else is zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct Blocks(BTreeMap<[usize; 2], Mat<f64>>);

impl Blocks {
    /// Adds a multiple of a block.
    pub fn add(&mut self, at: [usize; 2], factor: f64, block: &Mat<f64>) {
        if block.norm_max() == 0.0 {
            return;
        }
        let sum = self.0.entry(at).or_insert_with(|| Mat::zeros(block.nrows(), block.ncols()));
        for j in 0..block.ncols() {
            for i in 0..block.nrows() {
                sum[(i, j)] += factor * block[(i, j)];
            }
        }
    }

    /// Its blocks.
    pub fn iter(&self) -> impl Iterator<Item = (&[usize; 2], &Mat<f64>)> {
        self.0.iter()
    }

    /// The product with columns (n×k).
    pub fn times(&self, columns: &Mat<f64>) -> Mat<f64> {
        let mut product = Mat::zeros(columns.nrows(), columns.ncols());
        for ([row, column], block) in &self.0 {
            let of = columns.get(*column..column + block.ncols(), ..);
            let to = product.get_mut(*row..row + block.nrows(), ..);
            matmul(to, Accum::Add, block.as_ref(), of, 1.0, Par::Seq);
        }
        product
    }

    /// The product with a list.
    pub fn times_list(&self, list: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; list.len()];
        for ([row, column], block) in &self.0 {
            for j in 0..block.ncols() {
                (0..block.nrows()).for_each(|i| product[row + i] += block[(i, j)] * list[column + j]);
            }
        }
        product
    }

    /// Nᵀ A N of columns N (n×k).
    pub fn reduced(&self, columns: &Mat<f64>) -> Mat<f64> {
        if self.0.is_empty() {
            return Mat::zeros(columns.ncols(), columns.ncols());
        }
        columns.transpose() * self.times(columns)
    }

    /// The magnitudes of its entries.
    pub fn absolute(&self) -> Self {
        let magnitudes = |block: &Mat<f64>| Mat::from_fn(block.nrows(), block.ncols(), |i, j| block[(i, j)].abs());
        Self(self.0.iter().map(|(at, block)| (*at, magnitudes(block))).collect())
    }

    /// With all zeros (n×n).
    pub fn whole(&self, n: usize) -> Mat<f64> {
        let mut whole = Mat::zeros(n, n);
        for ([row, column], block) in &self.0 {
            whole.get_mut(*row..row + block.nrows(), *column..column + block.ncols()).copy_from(block);
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: the same by the whole matrix.
    #[test]
    fn products_are_those_of_the_whole_matrix() {
        let mut blocks = Blocks::default();
        blocks.add([0, 0], 1.0, &Mat::from_fn(2, 2, |i, j| (i + 3 * j) as f64 - 1.0));
        blocks.add([2, 0], -2.0, &Mat::from_fn(3, 2, |i, j| (i * j) as f64 + 0.5));
        blocks.add([2, 0], 1.0, &Mat::from_fn(3, 2, |i, _| i as f64));
        blocks.add([2, 2], 1.0, &Mat::zeros(3, 3));
        assert_eq!(blocks.iter().count(), 2);
        let whole = blocks.whole(5);
        let columns = Mat::from_fn(5, 2, |i, j| (1 + i) as f64 * (0.3 + j as f64));
        assert!((blocks.times(&columns) - &whole * &columns).norm_max() < 1e-14);
        assert!((blocks.reduced(&columns) - columns.transpose() * (&whole * &columns)).norm_max() < 1e-12);
        let list: Vec<f64> = columns.col(1).iter().copied().collect();
        let product = blocks.times_list(&list);
        (0..5).for_each(|i| assert!((product[i] - (&whole * &columns)[(i, 1)]).abs() < 1e-14));
        assert_eq!(blocks.absolute().whole(5)[(2, 0)], 1.0);
    }
}
