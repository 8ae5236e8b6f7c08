//! Large deflection: modes that bend the body, on a curved (quadratic) manifold.
//!
//! ```text
//! u = Ψ_ext ξ(q)        ξ_a = q_a + s_a,   s_a = ½ Σ_jk T_a,jk q_j q_k   (j, k of the large modes; zero for a among them)
//! D = ∂ξ/∂q = [I; 0] + T q        ν = D q̇        M = DᵀD
//! V = ½ qᵀΛq + V_n,   V_n = ⅙ Σ g_ijk q_i q_j q_k + ⅛ Σ w_ijkl q_i q_j q_k q_l
//! ```
//!
//! The extended shapes Ψ_ext are the modes q of the motion and, after them, shapes that only follow: what a large mode
//! draws in, twists or stretches. T, g and w are constants of the mesh ([`modal::SecondOrderShapes`]).

use std::sync::Arc;

use modal::{ReducedBody, SecondOrderShapes};

use crate::column_major::dot;
use crate::error::SetupError;

/// Most modes that may be large.
pub const MOST_LARGE: usize = 8;

/// The manifold that a body with large modes moves on.
#[derive(Debug, Clone)]
pub struct Manifold(Arc<Constants>);

#[derive(Debug)]
struct Constants {
    /// The body in the extended shapes.
    body: ReducedBody,
    /// Number of modes of the motion.
    modes: usize,
    /// Which of them are large.
    large: Vec<usize>,
    /// T_jk (extended shapes), for j and then k of the large modes.
    slopes: Vec<Vec<f64>>,
    /// g_ijk and w_ijkl, symmetric.
    cubic: Vec<f64>,
    quartic: Vec<f64>,
}

/// The place on the manifold.
#[derive(Debug, Clone, Default)]
pub(crate) struct ManifoldPoint {
    /// Columns of T q for the large modes.
    slopes: Vec<Vec<f64>>,
    /// Columns of T q̇.
    rates: Vec<Vec<f64>>,
    /// Cholesky factor of what M leaves to the large modes, row by row.
    factor: Vec<f64>,
}

impl Manifold {
    /// By the shapes of second order, the body in the extended shapes, and `energies`: the `∫ ε₂(i,j):C:ε₂(k,l) dV` of the
    /// large modes, for each pair of pairs (i ≤ j, k ≤ l) as in [`SecondOrderShapes::pairs`], row by row.
    ///
    /// # Errors
    /// [`SetupError`] for more large modes than [`MOST_LARGE`], sizes that do not fit together, and numbers that are not
    /// finite.
    pub fn new(body: ReducedBody, shapes: &SecondOrderShapes, energies: &[f64]) -> Result<Self, SetupError> {
        let SecondOrderShapes { dynamic, large, slopes, cubic, relief, .. } = shapes;
        let (count, pairs) = (large.len(), SecondOrderShapes::pairs(large.len()));
        for (what, found, expected) in [
            ("the list of energies of second order", energies.len(), pairs.len() * pairs.len()),
            ("the body in the extended shapes", body.flexible(), shapes.modes.shapes.ncols()),
            ("the slopes of the manifold", slopes.ncols(), pairs.len()),
        ] {
            if found != expected {
                return Err(SetupError::Length { what, expected, found });
            }
        }
        if count == 0 || count > MOST_LARGE {
            let expected = "1 to 8";
            return Err(SetupError::Value { what: "the number of large modes", found: count as f64, expected });
        }
        if let Some(found) = energies.iter().copied().find(|energy| !energy.is_finite()) {
            let what = "an energy of second order";
            return Err(SetupError::Value { what, found, expected: "a finite number" });
        }
        let pair = |i: usize, j: usize| pairs.iter().position(|p| *p == [i.min(j), i.max(j)]).unwrap_or_default();
        // The energy of a pair of pairs, less what the shapes that follow relieve; symmetric in all four.
        let of_pairs = |a: usize, b: usize| energies[a * pairs.len() + b] - relief[(a, b)];
        let quartic = (0..count.pow(4)).map(|index| {
            let [i, j, k, l] = [0, 1, 2, 3].map(|digit| index / count.pow(digit) % count);
            [[i, j, k, l], [i, k, j, l], [i, l, j, k]]
                .map(|[a, b, c, d]| 0.5 * (of_pairs(pair(a, b), pair(c, d)) + of_pairs(pair(c, d), pair(a, b))))
                .iter()
                .sum::<f64>()
                / 3.0
        });
        let cubic = (0..count.pow(3)).map(|index| {
            let [i, j, k] = [0, 1, 2].map(|digit| index / count.pow(digit) % count);
            (cubic[(i, pair(j, k))] + cubic[(j, pair(i, k))] + cubic[(k, pair(i, j))]) / 3.0
        });
        let column = |index: usize| slopes.col(pair(index / count, index % count)).iter().copied().collect();
        Ok(Self(Arc::new(Constants {
            modes: *dynamic,
            large: large.clone(),
            slopes: (0..count * count).map(column).collect(),
            cubic: cubic.collect(),
            quartic: quartic.collect(),
            body,
        })))
    }

    /// The body in the extended shapes.
    pub fn body(&self) -> &ReducedBody {
        &self.0.body
    }

    /// Number of modes of the motion.
    pub fn modes(&self) -> usize {
        self.0.modes
    }

    /// Which modes are large, numbered from 0.
    pub fn large(&self) -> &[usize] {
        &self.0.large
    }

    /// T_jk (extended shapes) of large modes j and k, numbered among the large ones.
    ///
    /// # Panics
    /// Where there are no such large modes.
    pub fn slopes(&self, j: usize, k: usize) -> &[f64] {
        &self.0.slopes[j * self.0.large.len() + k]
    }

    /// ξ(q) in the extended shapes, as many as the body has.
    pub fn coordinates(&self, q: &[f64], xi: &mut [f64]) {
        let Constants { large, modes, slopes, .. } = &*self.0;
        xi[..*modes].copy_from_slice(q);
        xi[*modes..].fill(0.0);
        for (index, slope) in slopes.iter().enumerate() {
            let product = 0.5 * q[large[index / large.len()]] * q[large[index % large.len()]];
            xi.iter_mut().zip(slope).for_each(|(xi, slope)| *xi += slope * product);
        }
    }

    fn extended(&self) -> usize {
        self.0.body.flexible()
    }

    pub(crate) fn place(&self) -> ManifoldPoint {
        let count = self.0.large.len();
        let columns = || vec![vec![0.0; self.extended()]; count];
        ManifoldPoint { slopes: columns(), rates: columns(), factor: vec![0.0; count * count] }
    }

    /// Goes to q: ξ, and the slopes there.
    pub(crate) fn go(&self, q: &[f64], place: &mut ManifoldPoint, xi: &mut [f64]) {
        let Constants { large, modes, .. } = &*self.0;
        self.columns(q, &mut place.slopes);
        xi[..*modes].copy_from_slice(q);
        xi[*modes..].fill(0.0);
        for (j, column) in large.iter().zip(&place.slopes) {
            xi.iter_mut().zip(column).for_each(|(xi, slope)| *xi += 0.5 * slope * q[*j]);
        }
        // Of M, the modes that are not large leave to the large ones 1 + tᵀt of the shapes that only follow.
        let count = large.len();
        for i in 0..count {
            for j in 0..=i {
                let mut sum = f64::from(u8::from(i == j)) + dot(&place.slopes[i][*modes..], &place.slopes[j][*modes..]);
                for k in 0..j {
                    sum -= place.factor[i * count + k] * place.factor[j * count + k];
                }
                place.factor[i * count + j] = if i == j { sum.sqrt() } else { sum / place.factor[j * count + j] };
            }
        }
    }

    /// Σ_k T_jk x_k for each large mode j.
    fn columns(&self, x: &[f64], columns: &mut [Vec<f64>]) {
        let Constants { large, slopes, .. } = &*self.0;
        for (column, slopes) in columns.iter_mut().zip(slopes.chunks_exact(large.len())) {
            column.fill(0.0);
            for (slope, k) in slopes.iter().zip(large) {
                column.iter_mut().zip(slope).for_each(|(sum, slope)| *sum += slope * x[*k]);
            }
        }
    }

    /// Goes along with q̇: the rates of the slopes.
    pub(crate) fn go_along(&self, rate: &[f64], place: &mut ManifoldPoint) {
        self.columns(rate, &mut place.rates);
    }

    /// D x of modal velocities or accelerations x (modes), in the extended shapes.
    pub(crate) fn extend(&self, place: &ManifoldPoint, x: &[f64], out: &mut [f64]) {
        out[..x.len()].copy_from_slice(x);
        out[x.len()..].fill(0.0);
        self.add_columns(&place.slopes, x, out);
    }

    /// Adds Ḋ q̇.
    pub(crate) fn add_curvature(&self, place: &ManifoldPoint, rate: &[f64], out: &mut [f64]) {
        self.add_columns(&place.rates, rate, out);
    }

    fn add_columns(&self, columns: &[Vec<f64>], x: &[f64], out: &mut [f64]) {
        for (j, column) in self.0.large.iter().zip(columns) {
            out.iter_mut().zip(column).for_each(|(out, slope)| *out += slope * x[*j]);
        }
    }

    /// Dᵀ y of forces or momenta y in the extended shapes, on the modes.
    pub(crate) fn project(&self, place: &ManifoldPoint, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.add_projection(place, y, out);
    }

    /// Adds Dᵀ y.
    pub(crate) fn add_projection(&self, place: &ManifoldPoint, y: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(y).for_each(|(out, y)| *out += y);
        self.add_products(&place.slopes, y, out);
    }

    /// Adds Ḋᵀ y.
    pub(crate) fn add_projected_rate(&self, place: &ManifoldPoint, y: &[f64], out: &mut [f64]) {
        self.add_products(&place.rates, y, out);
    }

    fn add_products(&self, columns: &[Vec<f64>], y: &[f64], out: &mut [f64]) {
        for (j, column) in self.0.large.iter().zip(columns) {
            out[*j] += dot(column, y);
        }
    }

    /// M⁻¹ y in place (modes).
    pub(crate) fn solve(&self, place: &ManifoldPoint, y: &mut [f64]) {
        let Constants { large, modes, .. } = &*self.0;
        let count = large.len();
        let mut x = [0.0; MOST_LARGE];
        // The slopes are zero along the large modes, so that these rows of y stay out of the products.
        for (i, (mode, column)) in large.iter().zip(&place.slopes).enumerate() {
            x[i] = y[*mode] - dot(&column[..*modes], y);
        }
        let factor = |i: usize, j: usize| place.factor[i * count + j];
        for i in 0..count {
            x[i] = (x[i] - (0..i).map(|k| factor(i, k) * x[k]).sum::<f64>()) / factor(i, i);
        }
        for i in (0..count).rev() {
            x[i] = (x[i] - (i + 1..count).map(|k| factor(k, i) * x[k]).sum::<f64>()) / factor(i, i);
        }
        for (x, column) in x.iter().zip(&place.slopes) {
            y.iter_mut().zip(&column[..*modes]).for_each(|(y, slope)| *y -= slope * x);
        }
        for (x, mode) in x.iter().zip(large) {
            y[*mode] = *x;
        }
    }

    /// Subtracts ∂V_n/∂q from modal forces.
    pub(crate) fn subtract_force(&self, q: &[f64], force: &mut [f64]) {
        let count = self.0.large.len();
        let x = self.large_of(q);
        let x = &x[..count];
        for (i, mode) in self.0.large.iter().enumerate() {
            let cubic = &self.0.cubic[i * count * count..(i + 1) * count * count];
            let quartic = &self.0.quartic[i * count.pow(3)..(i + 1) * count.pow(3)];
            force[*mode] -= 0.5 * (contract(cubic, x, 2) + contract(quartic, x, 3));
        }
    }

    /// V_n: the strain energy beyond ½ qᵀΛq.
    pub fn energy(&self, q: &[f64]) -> f64 {
        let count = self.0.large.len();
        let x = self.large_of(q);
        let x = &x[..count];
        contract(&self.0.cubic, x, 3) / 6.0 + contract(&self.0.quartic, x, 4) / 8.0
    }

    /// The large ones of q, then zeros.
    fn large_of(&self, q: &[f64]) -> [f64; MOST_LARGE] {
        let mut large = [0.0; MOST_LARGE];
        large.iter_mut().zip(&self.0.large).for_each(|(x, k)| *x = q[*k]);
        large
    }
}

/// Σ tensor_i…l x_i … x_l of a tensor of an `order`.
fn contract(tensor: &[f64], x: &[f64], order: u32) -> f64 {
    if order == 1 {
        return dot(tensor, x);
    }
    let parts = tensor.chunks_exact(x.len().pow(order - 1));
    parts.zip(x).map(|(part, x_i)| x_i * contract(part, x, order - 1)).sum()
}
