//! The constants of a body in its coordinates z: those of its shapes, ξ = z, but on a manifold of large deflection, ξ = E z.

use faer::Mat;
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::body::spin_stiffness::SpinStiffness;
use crate::conservative::body::ConservativeBody;
use crate::conservative::manifold::Manifold;
use crate::matrix::four::Padded;
use crate::matrix::side_by_side::Lists;

/// The body whose shapes ξ counts, and what leads from z to ξ.
pub(crate) struct InCoordinates<'a> {
    pub body: &'a ReducedBody,
    pub manifold: Option<&'a Manifold>,
}

impl InCoordinates<'_> {
    /// G of an axis (n × n).
    pub fn gyroscopic(&self, axis: &Vector3<f64>) -> Mat<f64> {
        let shapes = self.body.flexible();
        self.matrix(Mat::from_fn(shapes, shapes, |i, j| {
            axis.iter().zip(&self.body.gyroscopic).map(|(a, g)| a * g[(i, j)]).sum()
        }))
    }

    /// Σ weight · (N − K) (n × n), with K of the stress of the spin.
    pub fn inertia_second(&self, weights: &[f64; 6], stiffness: Option<&SpinStiffness>) -> Mat<f64> {
        let shapes = self.body.flexible();
        let of_shapes = |i, j| weighted(&self.body.inertia_second, weights, i, j);
        let mut second = self.matrix(Mat::from_fn(shapes, shapes, of_shapes));
        if let Some(of_pairs) = stiffness.map(SpinStiffness::of_pairs) {
            let modes = of_pairs[0].nrows();
            for (i, j) in (0..modes).flat_map(|j| (0..modes).map(move |i| (i, j))) {
                second[(i, j)] -= weighted(of_pairs, weights, i, j);
            }
        }
        second
    }

    /// Σ weight · c (n).
    pub fn inertia_first(&self, weights: &[f64; 6]) -> Vec<f64> {
        let of_shape = |k: usize| weights.iter().zip(&self.body.inertia_first).map(|(w, c)| w * c[k]).sum();
        self.list((0..self.body.flexible()).map(of_shape).collect())
    }

    /// The momenta of a motion along or about a unit vector (n), by those along or about x, y and z.
    pub fn along(&self, unit: &Vector3<f64>, momenta: &[Vec<f64>; 3]) -> Vec<f64> {
        self.list((0..self.body.flexible()).map(|k| (0..3).map(|i| unit[i] * momenta[i][k]).sum()).collect())
    }

    /// Eᵀ A E
    fn matrix(&self, a: Mat<f64>) -> Mat<f64> {
        match self.manifold.map(Manifold::shapes_by_coordinates) {
            Some(e) => e.transpose() * a * e,
            None => a,
        }
    }

    /// Eᵀ x
    fn list(&self, x: Vec<f64>) -> Vec<f64> {
        match self.manifold.map(Manifold::shapes_by_coordinates) {
            Some(e) => e.col_iter().map(|column| column.iter().zip(&x).map(|(e, x)| e * x).sum()).collect(),
            None => x,
        }
    }
}

fn weighted(matrices: &[Mat<f64>; 6], weights: &[f64; 6], i: usize, j: usize) -> f64 {
    matrices.iter().zip(weights).map(|(m, w)| w * m[(i, j)]).sum()
}

/// c_ij, N_ij − K_ij and G_i of a body that turns freely, each zero where its effect is off.
pub(crate) struct InertiaConstants {
    /// c_ij of the pairs.
    pub first: [Vec<f64>; 6],
    /// N_ij of the pairs.
    pub second: [Mat<f64>; 6],
    /// G_i.
    pub gyroscopic: [Mat<f64>; 3],
}

impl ConservativeBody {
    /// Its constants of inertia in z; it turns freely about three axes.
    pub(crate) fn inertia_constants(&self) -> InertiaConstants {
        let size = self.coordinates();
        let zeros = || Mat::zeros(size, size);
        let gyroscopic: [Mat<f64>; 3] =
            std::array::from_fn(|k| if k < self.g_count { self.matrices.matrix(k) } else { zeros() });
        let undeformed = Lists { groups: &self.undeformed, width: self.lists_of_undeformed(), first: self.s_count };
        let first = std::array::from_fn(|k| {
            let mut list = Padded::zeros(size);
            if k < self.pairs.len() {
                undeformed.copy(k, list.groups_mut());
            }
            list.to_vec()
        });
        let second = std::array::from_fn(|k| {
            if k >= self.pairs.len() {
                return zeros();
            }
            let matrix = self.matrices.matrix(self.g_count + k);
            if !self.locked {
                return matrix;
            }
            let (i, j) = self.pairs[k];
            let product = &gyroscopic[i] * &gyroscopic[j];
            matrix - (&product + product.transpose()) * faer::Scale(0.5)
        });
        InertiaConstants { first, second, gyroscopic }
    }
}
