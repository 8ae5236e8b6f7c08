//! The body: a St. Venant–Kirchhoff solid of second-order tetrahedra, total Lagrangian.
//!
//! ```text
//! F = 1 + ∇u      E = ½ (FᵀF − 1)      S = λ tr E 1 + 2μ E      f_i = ∫ F S ∇N_i dV      W = ½ ∫ E : S dV
//! ```

use faer::Side;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use fem_tet10::{Material, Materials, Matrices, Mesh, PointMass, assemble, quadrature, shape_gradients};
use nalgebra::{Matrix3, Vector3};

use crate::nonlinear::error::SolidError;

/// An integration point of an element.
struct Point {
    /// ∇N of its ten nodes.
    gradients: [Vector3<f64>; 10],
    volume: f64,
}

/// A solid with one material. Displacements are lists of 3n lengths, row `3·node + axis`, global axes.
pub struct Solid {
    mesh: Mesh,
    lame: (f64, f64),
    matrices: Matrices,
    /// The integration points of each element.
    points: Vec<Vec<Point>>,
    /// For each element, where the block of two of its nodes begins in the columns of the second (100·3).
    places: Vec<Vec<[usize; 3]>>,
    /// Which degrees of freedom are held.
    held: Vec<bool>,
    symbolic: SymbolicLlt<usize>,
}

impl Solid {
    /// The solid of a mesh whose `held` nodes do not move.
    ///
    /// # Errors
    /// Errors of the material and of the matrices.
    pub fn new(mesh: Mesh, material: Material, held: impl Fn(Vector3<f64>) -> bool) -> Result<Self, SolidError> {
        Self::with_masses(mesh, material, &[], held)
    }

    /// With masses at points.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_masses(
        mesh: Mesh,
        material: Material,
        masses: &[PointMass],
        held: impl Fn(Vector3<f64>) -> bool,
    ) -> Result<Self, SolidError> {
        let matrices = assemble(&mesh, &Materials::Uniform(material), masses)?;
        let rule: Vec<_> = quadrature::degree_5().into_iter().map(|p| (p.weight, shape_gradients(p.at))).collect();
        let points = mesh.elements().iter().map(|nodes| {
            let at = nodes.map(|node| Vector3::from(mesh.positions()[node as usize]));
            rule.iter().map(|(weight, slopes)| point(*weight, slopes, &at)).collect()
        });
        let pattern = matrices.mass().symbolic();
        let places = mesh.elements().iter().map(|nodes| {
            let pairs = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (*a as usize, *b as usize)));
            let place = |(a, b): (usize, usize)| {
                [0, 1, 2].map(|axis| {
                    let column = 3 * b + axis;
                    let rows = pattern.row_idx_of_col_raw(column);
                    pattern.col_ptr()[column] + rows.partition_point(|row| *row < 3 * a)
                })
            };
            pairs.map(place).collect()
        });
        let symbolic = SymbolicLlt::try_new(pattern, Side::Lower).map_err(|_| SolidError::Factor)?;
        let is_held = mesh.positions().iter().flat_map(|x| [held(Vector3::from(*x)); 3]).collect();
        Ok(Self {
            lame: material.lame(),
            points: points.collect(),
            places: places.collect(),
            held: is_held,
            symbolic,
            matrices,
            mesh,
        })
    }

    /// Its mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Its consistent mass (3n×3n).
    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        self.matrices.mass()
    }

    /// Number of degrees of freedom, those that are held among them.
    pub fn dofs(&self) -> usize {
        self.held.len()
    }

    /// True if a degree of freedom is held.
    pub fn is_held(&self, dof: usize) -> bool {
        self.held[dof]
    }

    /// M v.
    pub fn momentum(&self, v: &[f64]) -> Vec<f64> {
        product(self.matrices.mass(), v)
    }

    /// W.
    pub fn strain_energy(&self, u: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (nodes, points) in self.mesh.elements().iter().zip(&self.points) {
            let of_nodes = displacements(nodes, u);
            for point in points {
                let strain = strain(&deformation(&of_nodes, point));
                energy += 0.5 * point.volume * strain.dot(&stress(self.lame, &strain));
            }
        }
        energy
    }

    /// The internal forces of a step from `u` to `next`: `∫ ½(F + F') ½(S + S') ∇N_i dV`. Their work on the step is the
    /// change of W, and they have neither a resultant nor a moment about the positions half-way (Simo and Tarnow 1992).
    /// With both alike they are the forces there.
    pub fn internal_forces(&self, u: &[f64], next: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        for (nodes, points) in self.mesh.elements().iter().zip(&self.points) {
            let (before, after) = (displacements(nodes, u), displacements(nodes, next));
            for point in points {
                let (f, stress) = self.half_way(&before, &after, point);
                let first = f * stress * point.volume;
                for (node, gradient) in nodes.iter().zip(&point.gradients) {
                    let force = first * gradient;
                    for axis in 0..3 {
                        forces[3 * *node as usize + axis] += force[axis];
                    }
                }
            }
        }
        forces
    }

    /// The factor of `shift M + scale K_T`, K_T the tangent stiffness half-way from `u` to `next`. It stands in for that of
    /// the step, which lacks symmetry by the change of F over the step.
    pub fn tangent(&self, u: &[f64], next: &[f64], shift: f64, scale: f64) -> Result<Factor, SolidError> {
        let mass = self.matrices.mass();
        let mut values: Vec<f64> = mass.val().iter().map(|m| shift * m).collect();
        let (lambda, mu) = self.lame;
        for ((nodes, points), places) in self.mesh.elements().iter().zip(&self.points).zip(&self.places) {
            let (before, after) = (displacements(nodes, u), displacements(nodes, next));
            let mut blocks = [[Matrix3::<f64>::zeros(); 10]; 10];
            for point in points {
                let (f, stress) = self.half_way(&before, &after, point);
                let volume = scale * point.volume;
                let turned = point.gradients.map(|gradient| f * gradient);
                let both = f * f.transpose() * (mu * volume);
                for (j, row) in blocks.iter_mut().enumerate() {
                    let (g_j, t_j) = (&point.gradients[j], &turned[j]);
                    let traction = stress * g_j * volume;
                    let (along, across) = (t_j * (lambda * volume), t_j * (mu * volume));
                    for (i, block) in row.iter_mut().enumerate() {
                        let (g_i, t_i) = (&point.gradients[i], &turned[i]);
                        *block += t_i * along.transpose() + across * t_i.transpose() + both * g_i.dot(g_j);
                        let initial = g_i.dot(&traction);
                        (0..3).for_each(|axis| block[(axis, axis)] += initial);
                    }
                }
            }
            for (j, row) in blocks.iter().enumerate() {
                for (i, block) in row.iter().enumerate() {
                    for (axis, place) in places[10 * i + j].iter().enumerate() {
                        (0..3).for_each(|k| values[place + k] += block[(k, axis)]);
                    }
                }
            }
        }
        let pattern = mass.symbolic();
        for column in 0..self.held.len() {
            let range = pattern.col_range(column);
            for (row, value) in pattern.row_idx()[range.clone()].iter().zip(&mut values[range]) {
                if self.held[column] || self.held[*row] {
                    *value = f64::from(u8::from(*row == column));
                }
            }
        }
        let matrix = SparseColMatRef::new(pattern, &values[..]);
        let factor = Llt::try_new_with_symbolic(self.symbolic.clone(), matrix, Side::Lower);
        Ok(Factor { factor: factor.map_err(|_| SolidError::Factor)?, held: self.held.clone() })
    }

    /// F half-way and the mean of the stresses.
    fn half_way(
        &self,
        before: &[Vector3<f64>; 10],
        after: &[Vector3<f64>; 10],
        point: &Point,
    ) -> (Matrix3<f64>, Matrix3<f64>) {
        let (f, g) = (deformation(before, point), deformation(after, point));
        (0.5 * (f + g), stress(self.lame, &(0.5 * (strain(&f) + strain(&g)))))
    }
}

/// A factored matrix.
pub struct Factor {
    factor: Llt<usize, f64>,
    held: Vec<bool>,
}

impl Factor {
    /// Solves in place; degrees of freedom that are held get zero.
    pub fn solve(&self, forces: &mut [f64]) {
        forces.iter_mut().zip(&self.held).filter(|(_, held)| **held).for_each(|(f, _)| *f = 0.0);
        let rows = forces.len();
        let mut column = faer::MatMut::from_column_major_slice_mut(forces, rows, 1);
        faer::linalg::solvers::Solve::solve_in_place(&self.factor, column.as_mut());
    }
}

/// A sparse matrix times a vector.
pub fn product(matrix: SparseColMatRef<'_, usize, f64>, v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; v.len()];
    for (column, v) in v.iter().enumerate() {
        for (row, value) in matrix.row_idx_of_col(column).zip(matrix.val_of_col(column)) {
            out[row] += value * v;
        }
    }
    out
}

fn point(weight: f64, slopes: &[[f64; 3]; 10], at: &[Vector3<f64>; 10]) -> Point {
    let mut jacobian = Matrix3::zeros();
    for (x, slope) in at.iter().zip(slopes) {
        jacobian += x * Vector3::from(*slope).transpose();
    }
    // A mesh that has been checked has no singular Jacobian.
    let inverse = jacobian.try_inverse().unwrap_or_default().transpose();
    Point { gradients: slopes.map(|slope| inverse * Vector3::from(slope)), volume: weight * jacobian.determinant() }
}

fn displacements(nodes: &[u32; 10], u: &[f64]) -> [Vector3<f64>; 10] {
    nodes.map(|node| Vector3::from_column_slice(&u[3 * node as usize..3 * node as usize + 3]))
}

fn deformation(u: &[Vector3<f64>; 10], point: &Point) -> Matrix3<f64> {
    let mut f = Matrix3::identity();
    for (u, gradient) in u.iter().zip(&point.gradients) {
        f += u * gradient.transpose();
    }
    f
}

fn strain(f: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (f.transpose() * f - Matrix3::identity())
}

fn stress((lambda, mu): (f64, f64), strain: &Matrix3<f64>) -> Matrix3<f64> {
    lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain
}
