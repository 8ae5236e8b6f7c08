//! The constants of a body in its coordinates z: those of its shapes, ξ = z, but on a manifold of large deflection, ξ = E z.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;

use crate::body::spin_stiffness::SpinStiffness;
use crate::conservative::body::ConservativeBody;
use crate::conservative::manifold::Manifold;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::four::Padded;
use crate::matrix::side_by_side::Lists;
use crate::observation::reaction::Held;

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

    fn matrix(&self, a: Mat<f64>) -> Mat<f64> {
        matrix_over_coordinates(self.manifold, a)
    }

    fn list(&self, x: Vec<f64>) -> Vec<f64> {
        list_over_coordinates(self.manifold, x)
    }
}

/// Eᵀ A E
fn matrix_over_coordinates(manifold: Option<&Manifold>, a: Mat<f64>) -> Mat<f64> {
    match manifold.map(Manifold::shapes_by_coordinates) {
        Some(e) => e.transpose() * a * e,
        None => a,
    }
}

/// Eᵀ x
fn list_over_coordinates(manifold: Option<&Manifold>, x: Vec<f64>) -> Vec<f64> {
    match manifold.map(Manifold::shapes_by_coordinates) {
        Some(e) => e.col_iter().map(|column| column.iter().zip(&x).map(|(e, x)| e * x).sum()).collect(),
        None => x,
    }
}

fn weighted(matrices: &[Mat<f64>; 6], weights: &[f64; 6], i: usize, j: usize) -> f64 {
    matrices.iter().zip(weights).map(|(m, w)| w * m[(i, j)]).sum()
}

/// The constants of a body that moves freely or is held, each zero where its effect is off.
pub(crate) struct InertiaConstants {
    /// J₀ about the origin.
    pub inertia: Matrix3<f64>,
    /// Mass times the place of the center of mass from the origin, and what each coordinate adds; of a free body zero and none.
    pub moment: Vector3<f64>,
    pub translation: Vec<Vector3<f64>>,
    /// b_i.
    pub coupling: [Vec<f64>; 3],
    /// c_ij of the pairs.
    pub first: [Vec<f64>; 6],
    /// N_ij of the pairs.
    pub second: [Mat<f64>; 6],
    /// G_i.
    pub gyroscopic: [Mat<f64>; 3],
}

impl ConservativeBody {
    /// Its constants of inertia in z; it moves freely, or something holds it.
    pub(crate) fn inertia_constants(&self) -> InertiaConstants {
        if let Some(held) = &self.held {
            return self.constants_of_held(held);
        }
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
        InertiaConstants {
            inertia: self.inertia,
            moment: Vector3::zeros(),
            translation: vec![Vector3::zeros(); size],
            coupling: std::array::from_fn(|_| vec![0.0; size]),
            first,
            second,
            gyroscopic,
        }
    }

    /// The constants about all three axes, over the coordinates: N_ij less by K_ij.
    fn constants_of_held(&self, held: &Held) -> InertiaConstants {
        let manifold = self.manifold.as_ref();
        let shapes = held.coupling[0].len();
        let of = |list: &[BlockedMatrix], k: usize| {
            let dense = list.get(k).map_or_else(|| Mat::zeros(shapes, shapes), BlockedMatrix::dense);
            matrix_over_coordinates(manifold, dense)
        };
        let over = |list: Vec<f64>| list_over_coordinates(manifold, list);
        let columns = self.center.columns();
        let [x, y, z] = [0, 1, 2].map(|i| over(columns.iter().map(|column| self.mass * column[i]).collect()));
        InertiaConstants {
            inertia: held.inertia,
            moment: self.center.undeformed_body * self.mass,
            translation: (0..x.len()).map(|k| Vector3::new(x[k], y[k], z[k])).collect(),
            coupling: held.coupling.clone().map(over),
            first: std::array::from_fn(|k| over(held.first.get(k).cloned().unwrap_or_else(|| vec![0.0; shapes]))),
            second: std::array::from_fn(|k| {
                let mut second = of(&held.second, k);
                if let Some(stress) = held.stress.get(k).map(BlockedMatrix::dense) {
                    let mut of_modes = second.get_mut(..stress.nrows(), ..stress.ncols());
                    of_modes -= stress;
                }
                second
            }),
            gyroscopic: std::array::from_fn(|k| of(&held.gyroscopic, k)),
        }
    }
}
