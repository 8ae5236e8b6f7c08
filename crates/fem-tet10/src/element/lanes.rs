//! Elements in groups of four, and 3×3 matrices at a point of each of them at once.
//!
//! The four numbers lie side by side, and the compiler makes vector instructions of the loops over them. Each element meets
//! the same operations in the same order as it would alone, so the results do not depend on the processor.

use faer::MatRef;

use crate::element::deformation::OTHERS;
use crate::element::integration::{RulePoint, Rules, is_straight};
use crate::material::Material;
use crate::mesh::checked::Mesh;

/// Elements in a group.
pub(crate) const LANES: usize = 4;

/// Number of parts that the groups are cut into, for any number of threads: sums over the elements are taken over
/// the parts in their order.
pub(crate) const PARTS: usize = 64;

/// A number of each element of a group.
pub(crate) type Lanes = [f64; LANES];

/// A 3×3 matrix at a point of each element of a group: row, column, element.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tensors(pub [[Lanes; 3]; 3]);

/// Lamé's λ and μ of each element of a group.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lame {
    pub lambda: Lanes,
    pub mu: Lanes,
}

// Plain loops: closures, as those of `array::from_fn`, are compiled apart, without the vector instructions.
impl Tensors {
    pub const ZERO: Self = Self([[[0.0; LANES]; 3]; 3]);

    #[inline(always)]
    pub fn scaled(mut self, factor: &Lanes) -> Self {
        for numbers in self.0.as_flattened_mut() {
            for (number, factor) in numbers.iter_mut().zip(factor) {
                *number *= factor;
            }
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
        self.plus(&self.transpose()).scaled(&[0.5; LANES])
    }

    /// sym(Aᵀ B).
    #[inline(always)]
    pub fn second_strain(&self, other: &Self) -> Self {
        self.transpose().times(other).strain()
    }

    /// λ tr(ε) + 2μ ε.
    #[inline(always)]
    pub fn stress(&self, lame: &Lame) -> Self {
        let mut stress = *self;
        for lane in 0..LANES {
            let pressure = lame.lambda[lane] * (self.0[0][0][lane] + self.0[1][1][lane] + self.0[2][2][lane]);
            for i in 0..3 {
                for j in 0..3 {
                    stress.0[i][j][lane] *= 2.0 * lame.mu[lane];
                }
                stress.0[i][i][lane] += pressure;
            }
        }
        stress
    }

    /// The upper triangle of a symmetric matrix: the three on the diagonal, then the three others times `factor`.
    #[inline(always)]
    pub fn upper(&self, factor: f64) -> [Lanes; 6] {
        let mut upper = [self.0[0][0], self.0[1][1], self.0[2][2], self.0[0][1], self.0[1][2], self.0[2][0]];
        for number in upper[3..].as_flattened_mut() {
            *number *= factor;
        }
        upper
    }

    /// A gradient ∇u and C:ε(u).
    #[inline(always)]
    pub fn with_stress(self, lame: &Lame) -> [Self; 2] {
        [self, self.strain().stress(lame)]
    }
}

/// Elements that are computed side by side, all straight or all curved.
#[derive(Debug)]
pub(crate) struct Group {
    /// The last ones again where there are not enough of them.
    pub elements: [usize; LANES],
    /// How many there are.
    pub count: usize,
    is_straight: bool,
}

impl Group {
    /// All elements of a mesh: the straight ones, then the curved ones.
    pub fn all(mesh: &Mesh) -> Vec<Self> {
        let is_straight = |e: &usize| is_straight(&mesh.element_positions(*e));
        let (straight, curved): (Vec<usize>, Vec<usize>) = (0..mesh.elements().len()).partition(is_straight);
        let group = |elements: &[usize], is_straight: bool| Self {
            elements: std::array::from_fn(|lane| elements[lane.min(elements.len() - 1)]),
            count: elements.len(),
            is_straight,
        };
        let straight = straight.chunks(LANES).map(|elements| group(elements, true));
        straight.chain(curved.chunks(LANES).map(|elements| group(elements, false))).collect()
    }

    /// Points of integration for products of three gradients, see [`Rules::cubic`].
    pub fn cubic_points<'a>(&self, rules: &'a Rules) -> &'a [RulePoint] {
        rules.cubic(self.is_straight)
    }

    #[inline(always)]
    pub fn lame(&self, materials: &[Material]) -> Lame {
        let mut lame = Lame { lambda: [0.0; LANES], mu: [0.0; LANES] };
        for (lane, element) in self.elements.iter().enumerate() {
            (lame.lambda[lane], lame.mu[lane]) = materials[*element].lame();
        }
        lame
    }

    #[inline(always)]
    pub fn positions(&self, mesh: &Mesh) -> [[Lanes; 3]; 10] {
        let mut positions = [[[0.0; LANES]; 3]; 10];
        for (lane, element) in self.elements.iter().enumerate() {
            for (position, node) in positions.iter_mut().zip(&mesh.elements()[*element]) {
                for (position, x) in position.iter_mut().zip(&mesh.positions()[*node as usize]) {
                    position[lane] = *x;
                }
            }
        }
        positions
    }
}

/// One integration point of each element of a group.
pub(crate) struct GroupPoint {
    /// ∂N_a/∂x of the nodes 1 to 9, per length.
    pub gradients: [[Lanes; 3]; OTHERS],
    /// The volumes that the points stand for; none of elements that are there again.
    pub volume: Lanes,
}

impl GroupPoint {
    /// By the positions of the nodes of `count` elements.
    #[inline(always)]
    pub fn new(positions: &[[Lanes; 3]; 10], rule: &RulePoint, count: usize) -> Self {
        // J_ij = ∂x_i/∂ξ_j.
        let mut jacobian = Tensors::ZERO;
        for (x, dn) in positions.iter().zip(&rule.gradients) {
            for (row, x) in jacobian.0.iter_mut().zip(x) {
                for (sum, dn) in row.iter_mut().zip(dn) {
                    for (sum, x) in sum.iter_mut().zip(x) {
                        *sum += x * dn;
                    }
                }
            }
        }
        let Tensors(j) = &jacobian;
        // The inverse times the determinant, by the cross products of the columns.
        let mut adjugate = Tensors::ZERO;
        let (mut determinant, mut volume) = ([0.0; LANES], [0.0; LANES]);
        for (row, adjugate) in adjugate.0.iter_mut().enumerate() {
            let (b, c) = ((row + 1) % 3, (row + 2) % 3);
            for (column, entry) in adjugate.iter_mut().enumerate() {
                let (m, n) = ((column + 1) % 3, (column + 2) % 3);
                let [[mb, mc], [nb, nc]] = [[&j[m][b], &j[m][c]], [&j[n][b], &j[n][c]]];
                for (lane, entry) in entry.iter_mut().enumerate() {
                    *entry = mb[lane] * nc[lane] - nb[lane] * mc[lane];
                }
            }
        }
        for (adjugate, j) in adjugate.0[0].iter().zip(j) {
            for lane in 0..LANES {
                determinant[lane] += adjugate[lane] * j[0][lane];
            }
        }
        for lane in 0..LANES {
            if lane < count {
                volume[lane] = rule.point.weight * determinant[lane];
            }
            determinant[lane] = 1.0 / determinant[lane];
        }
        let inverse = adjugate.scaled(&determinant);
        // ∂N/∂x = J⁻ᵀ ∂N/∂ξ; a mesh that has been checked has no singular Jacobian at these points.
        let mut gradients = [[[0.0; LANES]; 3]; OTHERS];
        for (gradient, dn) in gradients.iter_mut().zip(&rule.gradients[1..]) {
            for (dn, inverse) in dn.iter().zip(&inverse.0) {
                for (sum, inverse) in gradient.iter_mut().zip(inverse) {
                    for (sum, inverse) in sum.iter_mut().zip(inverse) {
                        *sum += inverse * dn;
                    }
                }
            }
        }
        Self { gradients, volume }
    }

    /// ∇u, `(∇u)_ab = ∂u_a/∂x_b`, by the displacements of the nodes against the first.
    #[inline(always)]
    pub fn gradient(&self, relative: &[[Lanes; 3]; OTHERS]) -> Tensors {
        let mut sum = Tensors::ZERO;
        for (u, gradient) in relative.iter().zip(&self.gradients) {
            for (sum, u) in sum.0.iter_mut().zip(u) {
                for (sum, gradient) in sum.iter_mut().zip(gradient) {
                    for lane in 0..LANES {
                        sum[lane] += u[lane] * gradient[lane];
                    }
                }
            }
        }
        sum
    }

    /// Adds the forces `P ∇N_a dV` on the nodes 1 to 9; P is times the volume.
    #[inline(always)]
    pub fn add_forces(&self, p: &Tensors, forces: &mut [[Lanes; 3]; OTHERS]) {
        for (force, gradient) in forces.iter_mut().zip(&self.gradients) {
            for (force, p) in force.iter_mut().zip(&p.0) {
                for (p, gradient) in p.iter().zip(gradient) {
                    for lane in 0..LANES {
                        force[lane] += p[lane] * gradient[lane];
                    }
                }
            }
        }
    }
}

/// Fields (N×k) row by row.
pub(crate) struct Rows {
    pub columns: usize,
    numbers: Vec<f64>,
}

impl Rows {
    pub fn new(fields: MatRef<'_, f64>) -> Self {
        let columns = fields.ncols();
        let mut numbers = vec![0.0; columns * fields.nrows()];
        for (k, field) in fields.col_iter().enumerate() {
            for (row, value) in numbers.chunks_exact_mut(columns.max(1)).zip(field.iter()) {
                row[k] = *value;
            }
        }
        Self { columns, numbers }
    }

    /// Displacements of the nodes 1 to 9 of the elements of a group against node 0, one field after the other, by node, then
    /// axis.
    #[inline(always)]
    pub fn relative(&self, mesh: &Mesh, group: &Group, out: &mut Vec<[[Lanes; 3]; OTHERS]>) {
        out.resize(self.columns, [[[0.0; LANES]; 3]; OTHERS]);
        for (lane, element) in group.elements.iter().enumerate() {
            let nodes = &mesh.elements()[*element];
            for axis in 0..3 {
                let row = |node: u32| &self.numbers[(3 * node as usize + axis) * self.columns..][..self.columns];
                let first = row(nodes[0]);
                for (place, node) in nodes[1..].iter().enumerate() {
                    for ((out, u), first) in out.iter_mut().zip(row(*node)).zip(first) {
                        out[place][axis][lane] = u - first;
                    }
                }
            }
        }
    }
}
