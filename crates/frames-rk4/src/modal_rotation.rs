//! The turn T followed by the inverse modal expansion, Eqs. (30), (31), in modal space, Eq. (P1) of `docs/method/paper.md`.

use dynamics::nalgebra::Matrix3;
use dynamics::reduced_body::ReducedBody;

/// `E(R) = Ψᵀ M (I ⊗ R) Ψ = Σ R_ab E_ab`, for rotations R of the components of every node's vector.
#[derive(Debug, Clone)]
pub struct ModalRotation {
    size: usize,
    /// E_ab, column by column, one after another for ab = 11, 12, … 33.
    products: Vec<f64>,
    /// E(R) of the last rotation, column by column.
    sum: Vec<f64>,
}

impl ModalRotation {
    /// Takes the nine E_ab from the reduced body.
    pub fn new(body: &ReducedBody) -> Self {
        let size = 6 + body.flexible();
        let products = body
            .rotation_products
            .iter()
            .flatten()
            .flat_map(|e| (0..size).flat_map(move |j| (0..size).map(move |i| e[(i, j)])))
            .collect();
        Self { size, products, sum: vec![0.0; size * size] }
    }

    /// Forms E(R) for the rotations to come.
    pub fn set(&mut self, rotation: &Matrix3<f64>) {
        let entries = self.size * self.size;
        self.sum.fill(0.0);
        for (ab, product) in self.products.chunks_exact(entries).enumerate() {
            let factor = rotation[(ab / 3, ab % 3)];
            for (sum, e) in self.sum.iter_mut().zip(product) {
                *sum += factor * e;
            }
        }
    }

    /// `rotated = E(R) coordinates`.
    pub fn apply(&self, coordinates: &[f64], rotated: &mut [f64]) {
        rotated.fill(0.0);
        for (column, x) in self.sum.chunks_exact(self.size).zip(coordinates) {
            for (y, e) in rotated.iter_mut().zip(column) {
                *y += e * x;
            }
        }
    }
}
