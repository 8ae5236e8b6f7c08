//! A cycle of two levels in the place of K⁻¹: smoothing with all nodes, and the solution on the corners.
//!
//! ```text
//! before:    x = S r,   r' = r − K x            S: Chebyshev polynomial of D⁻¹K times D⁻¹, D the diagonal blocks of K
//! corners:   x += P (PᵀKP + s PᵀMP)⁻¹ Pᵀ r'
//! after:     x += S (r − K x)
//! ```
//!
//! Symmetric and positive definite, and as near to K⁻¹ for any size of the mesh where its elements are about as long as they
//! are thick: of flat ones the corners alone are far too stiff in bending. Brandt (1977); of second-order elements the step
//! to the corners is a step in the order of the polynomials ("p-multigrid").

use faer::{Mat, MatMut, MatRef};
use nalgebra::Matrix3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::coarse::Corners;
use crate::error::ModalError;
use crate::products::{NODES_PER_TASK, NodeBlocks, NodeRows, Packed, WIDTH};
use crate::shifted::{Shifted, SolveScratch};
use crate::stiffness::NodalStiffness;

/// Degree of the polynomials.
const DEGREE: usize = 3;
/// They damp what is between this part of the largest eigenvalue of D⁻¹K and itself; the corners have what is below.
const RANGE: f64 = 10.0;
/// The largest eigenvalue is less than this times what the power method finds in so many steps.
const SAFETY: f64 = 1.1;
const POWER_STEPS: usize = 10;

/// The cycle.
pub(crate) struct Multigrid<'a> {
    stiffness: NodeBlocks<'a>,
    /// D⁻¹, node by node.
    inverse_diagonal: Vec<[[f64; 3]; 3]>,
    /// α and β of d ← α d + β D⁻¹ r in each step of a smoothing.
    steps: [[f64; 2]; DEGREE],
    corners: &'a Corners,
    factor: &'a Shifted,
    scratch: Scratch,
}

/// Blocks of rows, which are used again.
struct Scratch {
    /// x, r, and the direction of the step and of the next.
    x: Vec<Packed>,
    r: Vec<Packed>,
    d: Vec<Packed>,
    next: Vec<Packed>,
    of_corners: Vec<Packed>,
    columns: Mat<f64>,
    solve: SolveScratch,
}

impl<'a> Multigrid<'a> {
    /// With the factor of the matrices over corners. None where a diagonal block has no inverse.
    pub(crate) fn new(
        stiffness: NodalStiffness<'a>,
        corners: &'a Corners,
        factor: &'a Shifted,
    ) -> Result<Option<Self>, ModalError> {
        let n = stiffness.pairs().count();
        let inverse = |node: usize| {
            let place = stiffness.pairs().of(node).binary_search(&(node as u32)).ok()?;
            let block = Matrix3::from_fn(|i, j| stiffness.column(node, j).1[place][i]);
            block.try_inverse().map(|inverse| inverse.transpose().into())
        };
        let Some(inverse_diagonal) = (0..n).map(inverse).collect::<Option<Vec<[[f64; 3]; 3]>>>() else {
            return Ok(None);
        };
        memory::check("the multigrid cycle", 3 * n * 4 * size_of::<Packed>())?;
        let rows = || vec![[0.0; WIDTH]; 3 * n];
        let scratch = Scratch {
            x: rows(),
            r: rows(),
            d: rows(),
            next: rows(),
            of_corners: vec![[0.0; WIDTH]; 3 * corners.count()],
            columns: Mat::zeros(3 * corners.count(), WIDTH),
            solve: factor.solve_scratch(WIDTH)?,
        };
        let steps = [[0.0; 2]; DEGREE];
        let mut found = Self { stiffness: stiffness.blocks(), inverse_diagonal, steps, corners, factor, scratch };
        found.steps = chebyshev(SAFETY * found.largest_eigenvalue());
        Ok(Some(found))
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(nodes: usize, corners: usize) -> usize {
        3 * nodes * 4 * size_of::<Packed>() + 72 * nodes + 2 * 3 * corners * size_of::<Packed>()
    }

    /// The largest eigenvalue of D⁻¹K by the power method, from below.
    fn largest_eigenvalue(&mut self) -> f64 {
        let mut seed = 7_u64;
        for row in &mut self.scratch.d {
            for x in row {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                *x = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            }
        }
        let mut largest = 0.0_f64;
        for _ in 0..POWER_STEPS {
            self.scratch.r.fill([0.0; WIDTH]);
            let [of_d, of_next] = self.step([0.0, -1.0], false);
            largest = (0..WIDTH).map(|c| of_next[c] / of_d[c]).fold(0.0, f64::max).sqrt();
            let scale = 1.0 / largest;
            let Scratch { d, next, .. } = &mut self.scratch;
            std::mem::swap(d, next);
            d.iter_mut().flatten().for_each(|x| *x *= scale);
        }
        largest
    }

    /// r ← r − K d, next ← α d + β D⁻¹ r, x ← x + next, where d may be zero. Returns the squares of d and of next.
    fn step(&mut self, factors: [f64; 2], d_is_zero: bool) -> [Packed; 2] {
        let Self { stiffness, inverse_diagonal, scratch: Scratch { x, r, d, next, .. }, .. } = self;
        let (arch, rows) = (Arch::new(), 3 * NODES_PER_TASK);
        let (x, r, next) = (x.par_chunks_mut(rows), r.par_chunks_mut(rows), next.par_chunks_mut(rows));
        let parts: Vec<[Packed; 2]> = x
            .zip(r)
            .zip(next)
            .enumerate()
            .map(|(task, ((x, r), next))| {
                let first = NODES_PER_TASK * task;
                let inverse = &inverse_diagonal[first..];
                arch.dispatch(Step { stiffness, inverse, first, factors, d, d_is_zero, x, r, next })
            })
            .collect();
        let add = |sum: Packed, part: &Packed| std::array::from_fn(|c| sum[c] + part[c]);
        parts.iter().fold([[0.0; WIDTH]; 2], |sum, part| [add(sum[0], &part[0]), add(sum[1], &part[1])])
    }

    /// Replaces forces (3n×k) by displacements.
    pub(crate) fn apply(&mut self, mut forces: MatMut<'_, f64>) {
        for first in (0..forces.ncols()).step_by(WIDTH) {
            let width = WIDTH.min(forces.ncols() - first);
            let mut columns = forces.as_mut().subcols_mut(first, width);
            pack(columns.as_ref(), &mut self.scratch.r);
            self.cycle();
            unpack(&self.scratch.x, columns.as_mut());
        }
    }

    /// The cycle for r, to x.
    fn cycle(&mut self) {
        self.scratch.x.fill([0.0; WIDTH]);
        self.scratch.d.fill([0.0; WIDTH]);
        self.smooth(true);
        // What is left of r, without a step.
        self.step([0.0, 0.0], false);
        let Scratch { x, r, d, of_corners, columns, solve, .. } = &mut self.scratch;
        self.corners.restrict(r, of_corners);
        unpack(of_corners, columns.as_mut());
        self.factor.solve_in_place(columns.as_mut(), solve);
        pack(columns.as_ref(), of_corners);
        self.corners.prolong(of_corners, d);
        x.par_iter_mut().zip(&*d).with_min_len(NODES_PER_TASK).for_each(|(x, d)| {
            x.iter_mut().zip(d).for_each(|(x, d)| *x += d);
        });
        self.smooth(false);
    }

    /// The steps of a smoothing, at the beginning of which K d is still to be taken from r.
    fn smooth(&mut self, d_is_zero: bool) {
        for (k, factors) in self.steps.into_iter().enumerate() {
            self.step(factors, d_is_zero && k == 0);
            let Scratch { d, next, .. } = &mut self.scratch;
            std::mem::swap(d, next);
        }
    }
}

/// Rows of a step, from those of a first node on. A type rather than a closure: what a closure calls is compiled without the
/// vector instructions.
struct Step<'a, 'b> {
    stiffness: &'a NodeBlocks<'b>,
    inverse: &'a [[[f64; 3]; 3]],
    first: usize,
    factors: [f64; 2],
    d: &'a [Packed],
    d_is_zero: bool,
    x: &'a mut [Packed],
    r: &'a mut [Packed],
    next: &'a mut [Packed],
}

impl WithSimd for Step<'_, '_> {
    type Output = [Packed; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Packed; 2] {
        let Self { stiffness, inverse, first, factors: [alpha, beta], d, d_is_zero, x, r, next } = self;
        let rows = x.as_chunks_mut::<3>().0.iter_mut().zip(r.as_chunks_mut::<3>().0).zip(next.as_chunks_mut::<3>().0);
        let mut squares = [[0.0; WIDTH]; 2];
        for (k, (((x, r), next), inverse)) in rows.zip(inverse).enumerate() {
            let node = first + k;
            if !d_is_zero {
                let product = stiffness.product(simd, node, d);
                for (r, product) in r.iter_mut().zip(&product) {
                    r.iter_mut().zip(product).for_each(|(r, product)| *r -= product);
                }
            }
            for axis in 0..3 {
                let (of_d, [i, j, k]) = (&d[3 * node + axis], inverse[axis]);
                for c in 0..WIDTH {
                    let step = alpha * of_d[c] + beta * (i * r[0][c] + j * r[1][c] + k * r[2][c]);
                    next[axis][c] = step;
                    x[axis][c] += step;
                    squares[0][c] += of_d[c] * of_d[c];
                    squares[1][c] += step * step;
                }
            }
        }
        squares
    }
}

/// α and β of the steps of Chebyshev's iteration for eigenvalues up to `largest`: Saad (2003), algorithm 12.1.
fn chebyshev(largest: f64) -> [[f64; 2]; DEGREE] {
    let [center, radius] = [0.5 * (1.0 + 1.0 / RANGE), 0.5 * (1.0 - 1.0 / RANGE)].map(|part| part * largest);
    let mut rho = radius / center;
    std::array::from_fn(|k| {
        if k == 0 {
            return [0.0, 1.0 / center];
        }
        let before = rho;
        rho = 1.0 / (2.0 * center / radius - before);
        [rho * before, 2.0 * rho / radius]
    })
}

/// Columns to rows of [`WIDTH`].
fn pack(columns: MatRef<'_, f64>, rows: &mut [Packed]) {
    rows.par_chunks_mut(3 * NODES_PER_TASK).enumerate().for_each(|(task, rows)| {
        let columns = columns.subrows(3 * NODES_PER_TASK * task, rows.len());
        rows.fill([0.0; WIDTH]);
        for (c, column) in columns.col_iter().enumerate() {
            rows.iter_mut().zip(column.iter()).for_each(|(row, value)| row[c] = *value);
        }
    });
}

/// And back.
fn unpack(rows: &[Packed], columns: MatMut<'_, f64>) {
    columns.par_row_chunks_mut(3 * NODES_PER_TASK).enumerate().for_each(|(task, columns)| {
        let rows = &rows[3 * NODES_PER_TASK * task..];
        for (c, column) in columns.col_iter_mut().enumerate() {
            column.iter_mut().zip(rows).for_each(|(value, row)| *value = row[c]);
        }
    });
}
