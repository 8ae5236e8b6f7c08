//! Euler–Bernoulli beams in space with six degrees of freedom a node.

use faer::sparse::{SparseColMat, Triplet};
use modal::{ModalError, Modes, Solver, Support};
use nalgebra::{DMatrix, Matrix3, Vector3};

pub type Sparse = SparseColMat<usize, f64>;

/// A straight beam of two-node elements, with consistent mass.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    pub length: f64,
    pub elements: usize,
    /// EA, GJ, EI about y, EI about z.
    pub stiffness: [f64; 4],
    /// Mass a length, and rotary inertia a length about x.
    pub mass: [f64; 2],
    /// Takes the axes of the beam, which lies along its x, to those of the mesh.
    pub turn: Matrix3<f64>,
}

impl Default for Beam {
    fn default() -> Self {
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3).into_inner();
        Self { length: 2.0, elements: 12, stiffness: [3e5, 4e3, 90.0, 90.0], mass: [1.5, 0.01], turn }
    }
}

pub struct BeamModel {
    pub positions: Vec<[f64; 3]>,
    pub stiffness: Sparse,
    pub mass: Sparse,
}

impl Beam {
    pub fn model(&self) -> BeamModel {
        let nodes = self.elements + 1;
        let h = self.length / self.elements as f64;
        let start = Vector3::new(3.0, -1.0, 0.5);
        let positions = (0..nodes).map(|i| (start + self.turn * Vector3::x() * (h * i as f64)).into()).collect();
        let [k, m] = self.element(h);
        // Each of the four vectors of an element turned.
        let turn = DMatrix::from_fn(12, 12, |i, j| if i / 3 == j / 3 { self.turn[(i % 3, j % 3)] } else { 0.0 });
        let assembled = |element: DMatrix<f64>| -> Sparse {
            let element = &turn * element * turn.transpose();
            let entries: Vec<_> = (0..self.elements)
                .flat_map(|e| (0..12).flat_map(move |i| (0..12).map(move |j| (e, i, j))))
                .map(|(e, i, j)| Triplet::new(6 * e + i, 6 * e + j, 0.5 * (element[(i, j)] + element[(j, i)])))
                .collect();
            SparseColMat::try_new_from_triplets(6 * nodes, 6 * nodes, &entries).unwrap()
        };
        BeamModel { positions, stiffness: assembled(k), mass: assembled(m) }
    }

    /// K and M of an element along x.
    fn element(&self, h: f64) -> [DMatrix<f64>; 2] {
        let ([ea, gj, ei_y, ei_z], [mass, rotary]) = (self.stiffness, self.mass);
        let (mut k, mut m) = (DMatrix::zeros(12, 12), DMatrix::zeros(12, 12));
        for (row, stiffness, inertia) in [(0, ea, mass), (3, gj, rotary)] {
            for (i, j) in [(0, 0), (0, 6), (6, 0), (6, 6)] {
                let is_same = i == j;
                k[(row + i, row + j)] = if is_same { stiffness / h } else { -stiffness / h };
                m[(row + i, row + j)] = inertia * h / if is_same { 3.0 } else { 6.0 };
            }
        }
        let bending =
            [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
        let inertia = [
            [156.0, 22.0, 54.0, -13.0],
            [22.0, 4.0, 13.0, -3.0],
            [54.0, 13.0, 156.0, -22.0],
            [-13.0, -3.0, -22.0, 4.0],
        ];
        // A slope of v is a rotation about z, one of w a rotation about −y.
        for (rows, sign, ei) in [([1, 5, 7, 11], 1.0, ei_z), ([2, 4, 8, 10], -1.0, ei_y)] {
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                let slopes = i32::from(i % 2 == 1) + i32::from(j % 2 == 1);
                let scale = h.powi(slopes) * f64::powi(sign, slopes);
                k[(rows[i], rows[j])] = ei / h.powi(3) * bending[i][j] * scale;
                m[(rows[i], rows[j])] = mass * h / 420.0 * inertia[i][j] * scale;
            }
        }
        [k, m]
    }
}

impl BeamModel {
    pub fn solver(&self, support: &Support) -> Result<Solver<'_>, ModalError> {
        Solver::new(self.stiffness.as_ref(), self.mass.as_ref(), &self.positions, support)
    }

    pub fn modes(&self, support: &Support, count: usize) -> Modes {
        self.solver(support).unwrap().modes(count, |_| ()).unwrap()
    }
}

/// Slope of the logarithm of the errors over that of the element lengths.
pub fn order(elements: &[usize], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> =
        elements.iter().zip(errors).map(|(n, error)| (-(*n as f64).ln(), error.abs().ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
