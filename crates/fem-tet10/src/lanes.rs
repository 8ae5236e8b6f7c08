//! Fields in groups of four, and 3×3 matrices of the four fields of a group at once.
//!
//! The four numbers lie side by side, and the compiler makes vector instructions of the loops over them. Each field meets
//! the same operations in the same order as it would alone, so the results do not depend on the processor.

use faer::MatRef;

use crate::deformation::OTHERS;
use crate::integration::IntegrationPoint;

/// Fields in a group.
pub(crate) const LANES: usize = 4;

/// A number of each field of a group.
pub(crate) type Lanes = [f64; LANES];

/// A 3×3 matrix of each field of a group: row, column, field.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tensors(pub [[Lanes; 3]; 3]);

// Plain loops: closures, as those of `array::from_fn`, are compiled apart, without the vector instructions.
impl Tensors {
    pub const ZERO: Self = Self([[[0.0; LANES]; 3]; 3]);

    /// One field's matrix for all four.
    #[inline(always)]
    pub fn all_alike(&self, lane: usize) -> Self {
        let mut all = Self::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                all.0[i][j] = [self.0[i][j][lane]; LANES];
            }
        }
        all
    }

    #[inline(always)]
    pub fn scaled(mut self, factor: f64) -> Self {
        for number in self.0.as_flattened_mut().as_flattened_mut() {
            *number *= factor;
        }
        self
    }

    #[inline(always)]
    pub fn plus(mut self, other: &Self) -> Self {
        for (number, other) in
            self.0.as_flattened_mut().as_flattened_mut().iter_mut().zip(other.0.as_flattened().as_flattened())
        {
            *number += other;
        }
        self
    }

    /// A B.
    #[inline(always)]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    for lane in 0..LANES {
                        product.0[i][j][lane] += self.0[i][k][lane] * other.0[k][j][lane];
                    }
                }
            }
        }
        product
    }

    /// Aᵀ.
    #[inline(always)]
    pub fn transpose(&self) -> Self {
        let mut transpose = Self::ZERO;
        for i in 0..3 {
            for j in 0..3 {
                transpose.0[i][j] = self.0[j][i];
            }
        }
        transpose
    }

    /// sym(A).
    #[inline(always)]
    pub fn strain(&self) -> Self {
        self.plus(&self.transpose()).scaled(0.5)
    }

    /// sym(Aᵀ B).
    #[inline(always)]
    pub fn second_strain(&self, other: &Self) -> Self {
        self.transpose().times(other).strain()
    }

    /// λ tr(ε) + 2μ ε.
    #[inline(always)]
    pub fn stress(&self, (lambda, mu): (f64, f64)) -> Self {
        let mut stress = self.scaled(2.0 * mu);
        for lane in 0..LANES {
            let pressure = lambda * (self.0[0][0][lane] + self.0[1][1][lane] + self.0[2][2][lane]);
            for i in 0..3 {
                stress.0[i][i][lane] += pressure;
            }
        }
        stress
    }

    /// Of a gradient ∇u: it, and C:ε(u).
    #[inline(always)]
    pub fn with_stress(self, lame: (f64, f64)) -> [Self; 2] {
        [self, self.strain().stress(lame)]
    }

    /// Puts the matrix of a group into the nine rows of a point (9 × groups).
    #[inline(always)]
    pub fn store(&self, rows: &mut [Lanes], groups: usize, group: usize) {
        for (row, numbers) in rows.chunks_exact_mut(groups).zip(self.0.as_flattened()) {
            row[group] = *numbers;
        }
    }
}

/// Fields (N×k) row by row, in groups; the last group is filled up with zeros.
pub(crate) struct Grouped {
    pub groups: usize,
    rows: Vec<Lanes>,
}

impl Grouped {
    pub fn new(fields: MatRef<'_, f64>) -> Self {
        let groups = fields.ncols().div_ceil(LANES);
        let mut rows = vec![[0.0; LANES]; groups * fields.nrows()];
        for (column, field) in fields.col_iter().enumerate() {
            for (row, value) in rows.chunks_exact_mut(groups).zip(field.iter()) {
                row[column / LANES][column % LANES] = *value;
            }
        }
        Self { groups, rows }
    }

    /// Displacements of the nodes 1 to 9 of an element against node 0, one group after the other, by node, then axis.
    #[inline(always)]
    pub fn relative(&self, nodes: &[u32; 10], out: &mut Vec<[[Lanes; 3]; OTHERS]>) {
        out.clear();
        for group in 0..self.groups {
            let mut relative = [[[0.0; LANES]; 3]; OTHERS];
            for axis in 0..3 {
                let row = |node: u32| self.rows[(3 * node as usize + axis) * self.groups + group];
                let first = row(nodes[0]);
                for (relative, node) in relative.iter_mut().zip(&nodes[1..]) {
                    let u = row(*node);
                    for lane in 0..LANES {
                        relative[axis][lane] = u[lane] - first[lane];
                    }
                }
            }
            out.push(relative);
        }
    }
}

/// ∇u at a point, `(∇u)_ab = ∂u_a/∂x_b`, by the displacements of an element's nodes against its first.
#[inline(always)]
pub(crate) fn gradient(relative: &[[Lanes; 3]; OTHERS], point: &IntegrationPoint) -> Tensors {
    let mut sum = Tensors::ZERO;
    for (u, gradient) in relative.iter().zip(&point.gradients[1..]) {
        for (sum, u) in sum.0.iter_mut().zip(u) {
            for (sum, gradient) in sum.iter_mut().zip(gradient) {
                for (sum, u) in sum.iter_mut().zip(u) {
                    *sum += u * gradient;
                }
            }
        }
    }
    sum
}
