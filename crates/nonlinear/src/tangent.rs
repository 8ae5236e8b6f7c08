//! The tangent K*, Eq. (K3) of `docs/method/check.md`, factored in the space that the support allows.
//!
//! ```text
//! K* = ∫ B(u)ᵀ C B(u) + G(S) + (M_s ⊗ m)        m = −W of a spin
//!
//! ⎡ A    E    K*C   M R  ⎤        A: K* + c E Eᵀ without the held rows; E: a few degrees of freedom that hold the rigid modes;
//! ⎢ Eᵀ   1/c             ⎥        C: motions of the held rows; R: rigid modes that the support leaves, along which there is
//! ⎢ CᵀK*      CᵀK*C CᵀMR ⎥        no displacement
//! ⎣ RᵀM       RᵀMC   0   ⎦
//! ```
//!
//! K* of a body that can move is singular at rest: with springs c on E, A is not, and elimination of the second row takes them out again.
//! The rest beside A is a matrix of at most 18 rows. By Sylvester's law the negative eigenvalues of K* in the space without
//! rigid modes are those of A and of what is left, less one for each of R.

use faer::{Mat, MatRef};
use fem_tet10::Stresses;
use modal::IndefiniteFactor;
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::body::{FullBody, spin};
use crate::error::NonlinearError;
use crate::vectors::list;

/// Terms of a tangent.
pub struct TangentTerms<'a> {
    /// Displacements that B is of.
    pub displacement: &'a [f64],
    /// The stress S.
    pub stresses: &'a Stresses,
    /// Factor on the elastic terms.
    pub scale: f64,
    /// The 3×3 matrix m of M_s ⊗ m: −W of a spin, or a shift times 1.
    pub mass: Matrix3<f64>,
    /// True if displacements have no part along the rigid modes. Without, and with no shift, K* of a free body is singular.
    pub without_rigid: bool,
}

impl<'a> TangentTerms<'a> {
    /// K* of a spin `omega_body`.
    pub fn spinning(displacement: &'a [f64], stresses: &'a Stresses, omega_body: &Vector3<f64>) -> Self {
        Self { displacement, stresses, scale: 1.0, mass: -spin(omega_body), without_rigid: true }
    }

    /// `shift M + scale K_T`, of which the shift keeps rigid modes from being singular.
    pub fn shifted(displacement: &'a [f64], stresses: &'a Stresses, shift: f64, scale: f64) -> Self {
        let mass = Matrix3::from_diagonal_element(shift);
        Self { displacement, stresses, scale, mass, without_rigid: false }
    }
}

/// K*, factored.
pub struct Tangent<'a> {
    body: &'a FullBody<'a>,
    /// K* by nodes.
    values: Vec<f64>,
    factor: IndefiniteFactor<'a>,
    /// [E, K*C, M R] on the rows that are not held, and A⁻¹ of it (3n×m).
    border: Mat<f64>,
    through: Mat<f64>,
    /// The Schur complement beside A, inverted (m×m), and the number of its negative eigenvalues.
    inverse: DMatrix<f64>,
    negative: usize,
    /// Columns of E.
    anchors: usize,
}

impl<'a> Tangent<'a> {
    /// Assembles and factors K*.
    ///
    /// # Errors
    /// Memory; [`NonlinearError::Singular`]; [`NonlinearError::NotFinite`].
    pub fn new(body: &'a FullBody<'a>, terms: &TangentTerms<'_>) -> Result<Self, NonlinearError> {
        let values = assembled(body, terms);
        if !values.iter().all(|value| value.is_finite()) {
            return Err(NonlinearError::NotFinite { what: "a tangent stiffness" });
        }
        let rigid = if terms.without_rigid { body.rigid.ncols() } else { 0 };
        let anchors = if rigid > 0 { anchors(body) } else { Vec::new() };
        let (start, nodes) = (body.matrices().start(), body.matrices().nodes());
        let diagonal = |row: usize| place(start, nodes, row, row);
        let springs: Vec<f64> = anchors
            .iter()
            .map(|row| diagonal(*row).map_or(0.0, |at| body.matrices().stiffness_by_nodes()[at] * terms.scale))
            .collect();
        let mut with_springs = values.clone();
        for (row, spring) in anchors.iter().zip(&springs) {
            if let Some(at) = diagonal(*row) {
                with_springs[at] += spring;
            }
        }
        let factor = body.order()?.factor(&with_springs, &body.held)?;

        let of_motions = product(body, &values, body.motions.as_ref());
        let (a, c, all) = (anchors.len(), body.motions.ncols(), anchors.len() + body.motions.ncols() + rigid);
        let border = Mat::from_fn(body.dofs(), all, |row, k| {
            if body.held[row] {
                0.0
            } else if k < a {
                f64::from(u8::from(row == anchors[k]))
            } else if k < a + c {
                of_motions[(row, k - a)]
            } else {
                body.momenta[(row, k - a - c)]
            }
        });
        let mut through = border.clone();
        factor.solve_in_place(through.as_mut())?;
        let taken = border.transpose() * &through;
        let corner = body.motions.transpose() * &of_motions;
        let rigid_corner = body.motions.transpose() * &body.momenta;
        let left = DMatrix::from_fn(all, all, |i, j| {
            let (low, high) = (i.min(j), i.max(j));
            let own = if high < a {
                if i == j { 1.0 / springs[i] } else { 0.0 }
            } else if low >= a && high < a + c {
                corner[(low - a, high - a)]
            } else if (a..a + c).contains(&low) {
                rigid_corner[(low - a, high - a - c)]
            } else {
                0.0
            };
            own - 0.5 * (taken[(i, j)] + taken[(j, i)])
        });
        let (inverse, negative) = inverted(left)?;
        let anchors = a;
        Ok(Self { body, values, factor, border, through, inverse, negative, anchors })
    }

    /// Number of negative eigenvalues of K* in the space of the displacements that the support allows, without rigid modes. K* is
    /// without the change L of forces that follow the displacements: under those the number says nothing of stability.
    pub fn negative_pivots(&self) -> usize {
        let rigid = self.inverse.nrows() - self.anchors - self.body.motions.ncols();
        (self.factor.negative_pivots() + self.negative).saturating_sub(rigid)
    }

    /// K*⁻¹ of forces (3n×k). Forces along the rigid modes are left to the inertia of the body.
    ///
    /// # Errors
    /// Memory.
    pub fn solve(&self, forces: MatRef<'_, f64>) -> Result<Mat<f64>, NonlinearError> {
        let mut answers = forces.to_owned();
        self.factor.solve_in_place(answers.as_mut())?;
        let all = self.inverse.nrows();
        if all == 0 {
            return Ok(answers);
        }
        let (motions, anchors) = (&self.body.motions, self.anchors);
        let on_motions = motions.transpose() * forces;
        let taken = self.border.transpose() * &answers;
        let right = DMatrix::from_fn(all, forces.ncols(), |i, j| {
            let own =
                if (anchors..anchors + motions.ncols()).contains(&i) { on_motions[(i - anchors, j)] } else { 0.0 };
            own - taken[(i, j)]
        });
        let found = &self.inverse * right;
        let found = Mat::from_fn(all, forces.ncols(), |i, j| found[(i, j)]);
        answers -= &self.through * &found;
        answers += motions * found.subrows(anchors, motions.ncols());
        Ok(answers)
    }

    /// The same of one list of forces.
    ///
    /// # Errors
    /// Memory.
    pub fn answer(&self, forces: &[f64]) -> Result<Vec<f64>, NonlinearError> {
        Ok(list(&self.solve(crate::vectors::column(forces))?, 0))
    }

    /// K* V (3n×k), whatever is held.
    pub fn product(&self, v: MatRef<'_, f64>) -> Mat<f64> {
        product(self.body, &self.values, v)
    }
}

/// K* V of terms that are not factored (3n×k), whatever is held.
pub(crate) fn product_of(body: &FullBody<'_>, terms: &TangentTerms<'_>, v: MatRef<'_, f64>) -> Mat<f64> {
    product(body, &assembled(body, terms), v)
}

/// K* by nodes.
fn assembled(body: &FullBody<'_>, terms: &TangentTerms<'_>) -> Vec<f64> {
    let matrices = body.matrices();
    let mut values = body.strain().stiffness(terms.displacement, terms.stresses, matrices);
    if terms.scale != 1.0 {
        values.iter_mut().for_each(|value| *value *= terms.scale);
    }
    if terms.mass != Matrix3::zeros() {
        let (start, mass) = (matrices.start(), matrices.mass_by_nodes());
        for node in 0..start.len() - 1 {
            let count = start[node + 1] - start[node];
            for (place, mass) in mass[start[node]..start[node + 1]].iter().enumerate() {
                for j in 0..3 {
                    let first = 9 * start[node] + 3 * (j * count + place);
                    for (i, value) in values[first..first + 3].iter_mut().enumerate() {
                        *value += mass * terms.mass[(i, j)];
                    }
                }
            }
        }
    }
    values
}

/// Where the entry of a row and a column stands in a matrix by nodes.
fn place(start: &[usize], nodes: &[u32], row: usize, column: usize) -> Option<usize> {
    let range = start[column / 3]..start[column / 3 + 1];
    let at = nodes[range.clone()].binary_search(&((row / 3) as u32)).ok()?;
    Some(9 * range.start + 3 * (column % 3 * range.len() + at) + row % 3)
}

/// A matrix by nodes times columns.
fn product(body: &FullBody<'_>, values: &[f64], v: MatRef<'_, f64>) -> Mat<f64> {
    let (start, nodes) = (body.matrices().start(), body.matrices().nodes());
    let mut products = Mat::zeros(v.nrows(), v.ncols());
    for k in 0..v.ncols() {
        let x: Vec<f64> = v.col(k).iter().copied().collect();
        let mut y = vec![0.0; x.len()];
        for node in 0..start.len() - 1 {
            let rows = &nodes[start[node]..start[node + 1]];
            for (axis, column) in
                values[9 * start[node]..9 * start[node + 1]].chunks_exact(3 * rows.len().max(1)).enumerate()
            {
                let factor = x[3 * node + axis];
                if factor == 0.0 {
                    continue;
                }
                for (row, block) in rows.iter().zip(column.chunks_exact(3)) {
                    let first = 3 * *row as usize;
                    y[first..first + 3].iter_mut().zip(block).for_each(|(y, a)| *y += a * factor);
                }
            }
        }
        products.col_mut(k).iter_mut().zip(y).for_each(|(to, y)| *to = y);
    }
    products
}

/// As many degrees of freedom as there are rigid modes, far from each other: held, they hold the body.
fn anchors(body: &FullBody<'_>) -> Vec<usize> {
    let count = body.rigid.ncols();
    let mut rows: Vec<Vec<f64>> =
        (0..body.dofs()).map(|row| (0..count).map(|k| body.rigid[(row, k)]).collect()).collect();
    let mut chosen = Vec::with_capacity(count);
    let size = |row: &[f64]| row.iter().map(|r| r * r).sum::<f64>();
    for _ in 0..count {
        let free = (0..rows.len()).filter(|row| !body.held[*row]);
        let Some(best) = free.max_by(|a, b| size(&rows[*a]).total_cmp(&size(&rows[*b]))) else { break };
        let norm = size(&rows[best]).sqrt();
        let direction: Vec<f64> = rows[best].iter().map(|r| r / norm).collect();
        // A row that is none: the rest of the rigid modes moves held rows alone.
        if !(norm > 0.0 && direction.iter().all(|d| d.is_finite())) {
            break;
        }
        for row in &mut rows {
            let part: f64 = row.iter().zip(&direction).map(|(r, d)| r * d).sum();
            row.iter_mut().zip(&direction).for_each(|(r, d)| *r -= part * d);
        }
        chosen.push(best);
    }
    chosen
}

/// The inverse of a symmetric matrix, and the number of its negative eigenvalues; its rows may differ by many powers of ten.
fn inverted(matrix: DMatrix<f64>) -> Result<(DMatrix<f64>, usize), NonlinearError> {
    let size = matrix.nrows();
    if size == 0 {
        return Ok((matrix, 0));
    }
    let scales: Vec<f64> = (0..size)
        .map(|i| {
            let largest = if matrix[(i, i)] != 0.0 { matrix[(i, i)].abs() } else { matrix.row(i).amax() };
            1.0 / largest.sqrt()
        })
        .collect();
    let scaled = DMatrix::from_fn(size, size, |i, j| matrix[(i, j)] * scales[i] * scales[j]);
    if !scaled.iter().all(|value| value.is_finite()) {
        return Err(NonlinearError::Singular);
    }
    let negative = scaled.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
    let inverse = scaled.lu().try_inverse().ok_or(NonlinearError::Singular)?;
    Ok((DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * scales[i] * scales[j]), negative))
}
