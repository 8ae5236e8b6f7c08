//! Steps of a smoothing with all nodes, in single precision: half the bytes, and twice as many numbers in a vector.
//!
//! ```text
//! r ← r − K d,   x ← x + d,   d ← α d + β D⁻¹ r        D: the diagonal blocks of K
//! ```
//!
//! A row has as many numbers as there are columns, rounded up to whole [`LANES`]; the three rows of a node follow each other.
//! K is measured in its largest diagonal entry, and the first r of a column in its largest force: no number is too small or
//! too large.

use faer::{MatMut, MatRef};
use nalgebra::Matrix3;
use pulp::{Arch, Scalar, Simd, WithSimd};
use rayon::prelude::*;

use crate::matrix::node_pairs::NodePairs;
use crate::matrix::packed_rows::prefetch;
use crate::matrix::products::NODES_PER_TASK;
use crate::matrix::row_chunks::row_chunks_mut;
use crate::matrix::stiffness::NodalStiffness;

/// Numbers that rows are made of.
const LANES: usize = 8;
/// Columns handled in one pass over the matrix: the sums of a node take nine of the processor's sixteen vectors.
pub(crate) const MAX_COLUMNS: usize = 3 * LANES;
/// Neighbours of a node whose rows are asked for ahead of their use.
const AHEAD: usize = 6;
/// Numbers that are fetched together.
const LINE: usize = 16;

/// Degree of the polynomials.
const DEGREE: usize = 3;
/// They damp what is between this part of the largest eigenvalue of D⁻¹K and itself; the corners have what is below.
const RANGE: f64 = 10.0;
/// The largest eigenvalue is less than this times what the power method finds in [`POWER_STEPS`] steps.
const SAFETY: f64 = 1.1;
const POWER_STEPS: usize = 10;

type Block = [[f32; 3]; 3];

/// The smoother of all nodes.
pub(crate) struct Smoother {
    start: Vec<usize>,
    nodes: Vec<u32>,
    /// K by the rows of each node: a block for each of the nodes that it is coupled to.
    blocks: Vec<Block>,
    /// D⁻¹, node by node.
    inverse_diagonal: Vec<Block>,
    /// The unit in which K is measured.
    pub unit: f64,
    /// α and β of each step of a smoothing.
    factors: [[f32; 2]; DEGREE],
}

impl Smoother {
    /// None where a diagonal block has no inverse in single precision.
    pub(crate) fn new(stiffness: NodalStiffness<'_>) -> Option<Self> {
        let pairs = stiffness.pairs();
        let diagonal: Vec<Matrix3<f64>> =
            (0..pairs.count()).map(|node| diagonal_block(stiffness, node)).collect::<Option<_>>()?;
        let unit = diagonal.iter().fold(0.0, |most: f64, block| most.max(block.amax()));
        let inverse = |block: &Matrix3<f64>| block.try_inverse().map(|inverse| single(|i, j| unit * inverse[(i, j)]));
        let mut smoother = Self {
            start: pairs.start.to_vec(),
            nodes: pairs.nodes.to_vec(),
            blocks: blocks(stiffness, unit),
            inverse_diagonal: diagonal.iter().map(inverse).collect::<Option<_>>()?,
            unit,
            factors: [[0.0; 2]; DEGREE],
        };
        let is_finite = |blocks: &[Block]| blocks.iter().flatten().flatten().all(|entry| entry.is_finite());
        if !is_finite(&smoother.blocks) || !is_finite(&smoother.inverse_diagonal) {
            return None;
        }
        let largest = Smoothing::new(&smoother, LANES).largest_eigenvalue();
        smoother.factors = chebyshev(SAFETY * largest);
        largest.is_normal().then_some(smoother)
    }

    fn pairs(&self) -> NodePairs<'_> {
        NodePairs { start: &self.start, nodes: &self.nodes }
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.pairs().bytes() + (self.blocks.len() + self.inverse_diagonal.len()) * size_of::<Block>()
    }
}

/// The rows that a smoother works on.
pub(crate) struct Smoothing<'a> {
    pub smoother: &'a Smoother,
    /// Numbers in a row.
    pub width: usize,
    pub r: Vec<f32>,
    pub x: Vec<f32>,
    pub d: Vec<f32>,
    next: Vec<f32>,
}

impl<'a> Smoothing<'a> {
    /// Scratch for rows of at most `width` numbers.
    pub(crate) fn new(smoother: &'a Smoother, width: usize) -> Self {
        let zeros = || vec![0.0; 3 * smoother.pairs().count() * width];
        Self { smoother, width, r: zeros(), x: zeros(), d: zeros(), next: zeros() }
    }

    /// Memory held, bytes.
    pub(crate) fn bytes(nodes: usize) -> usize {
        4 * 3 * MAX_COLUMNS * size_of::<f32>() * nodes
    }

    /// Takes columns of forces for r, each divided by the number that is returned for it; x is zero.
    pub(crate) fn begin(&mut self, forces: MatRef<'_, f64>) -> [f64; MAX_COLUMNS] {
        self.width = forces.ncols().next_multiple_of(LANES);
        let largest = |column: usize| match forces.col(column).norm_max() {
            0.0 => 1.0,
            largest => largest,
        };
        let units: [f64; MAX_COLUMNS] = std::array::from_fn(|c| if c < forces.ncols() { largest(c) } else { 1.0 });
        let used = self.used();
        pack(forces, units.map(|unit| 1.0 / unit), &mut self.r[..used]);
        self.x[..used].par_chunks_mut(3 * NODES_PER_TASK * self.width).for_each(|x| x.fill(0.0));
        units
    }

    /// The steps of a smoothing. The d before them is taken in, should there be one; the last d is left to be.
    pub(crate) fn smooth(&mut self, takes_first: bool) {
        for (k, factors) in self.smoother.factors.into_iter().enumerate() {
            self.step(takes_first || k > 0, Some(factors));
        }
    }

    /// Takes d in, without a step.
    pub(crate) fn take_in(&mut self) {
        self.step(true, None);
    }

    /// x + d for forces that were divided by `units`.
    pub(crate) fn end(&self, units: [f64; MAX_COLUMNS], displacements: MatMut<'_, f64>) {
        let used = self.used();
        unpack([&self.x[..used], &self.d[..used]], units.map(|unit| unit / self.smoother.unit), displacements);
    }

    fn used(&self) -> usize {
        3 * self.smoother.pairs().count() * self.width
    }

    fn step(&mut self, takes_in: bool, factors: Option<[f32; 2]>) {
        match self.width / LANES {
            1 => self.step_of::<1>(takes_in, factors),
            2 => self.step_of::<2>(takes_in, factors),
            _ => self.step_of::<3>(takes_in, factors),
        }
    }

    /// A step with rows of V times [`LANES`].
    fn step_of<const V: usize>(&mut self, takes_in: bool, factors: Option<[f32; 2]>) {
        let Self { smoother, x, r, d, next, .. } = self;
        let Smoother { blocks, inverse_diagonal, .. } = *smoother;
        let pairs = &smoother.pairs();
        let (of_node, arch) = (3 * V * LANES, Arch::new());
        let (used, of_task) = (of_node * pairs.count(), of_node * NODES_PER_TASK);
        let d = &d[..used];
        let [x, r, next] = [x, r, next].map(|rows| rows[..used].par_chunks_mut(of_task));
        x.zip(r).zip(next).enumerate().for_each(|(task, ((x, r), next))| {
            let first = NODES_PER_TASK * task;
            let inverse = &inverse_diagonal[first..];
            arch.dispatch(Step::<V> { pairs, blocks, inverse, first, takes_in, factors, d, x, r, next });
        });
        if factors.is_some() {
            std::mem::swap(&mut self.d, &mut self.next);
        }
    }

    /// The largest eigenvalue of D⁻¹K by the power method, from below.
    fn largest_eigenvalue(&mut self) -> f64 {
        let used = self.used();
        let mut seed = 7_u64;
        for x in &mut self.d[..used] {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            *x = ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) as f32;
        }
        let mut largest = 0.0;
        for _ in 0..POWER_STEPS {
            self.r[..used].fill(0.0);
            let before = squares(&self.d[..used]);
            self.step(true, Some([0.0, -1.0]));
            let after = squares(&self.d[..used]);
            largest = before.iter().zip(after).fold(0.0, |most: f64, (before, after)| most.max(after / before)).sqrt();
            self.d[..used].iter_mut().for_each(|x| *x /= largest as f32);
        }
        largest
    }
}

/// The squares of columns in rows of [`LANES`].
fn squares(rows: &[f32]) -> [f64; LANES] {
    let add = |sums: [f64; LANES], row: &[f32; LANES]| std::array::from_fn(|c| sums[c] + f64::from(row[c]).powi(2));
    rows.as_chunks().0.iter().fold([0.0; LANES], add)
}

/// The block of a node and itself.
fn diagonal_block(stiffness: NodalStiffness<'_>, node: usize) -> Option<Matrix3<f64>> {
    let place = stiffness.pairs().of(node).binary_search(&(node as u32)).ok()?;
    Some(Matrix3::from_fn(|i, j| stiffness.column(node, j).1[place][i]))
}

/// The blocks of K, measured in `unit`. Its columns are its rows.
fn blocks(stiffness: NodalStiffness<'_>, unit: f64) -> Vec<Block> {
    let pairs = stiffness.pairs();
    let mut blocks = Vec::with_capacity(pairs.nodes.len());
    for node in 0..pairs.count() {
        let columns = [0, 1, 2].map(|axis| stiffness.column(node, axis).1);
        blocks.extend((0..pairs.of(node).len()).map(|place| single(|i, j| columns[i][place][j] / unit)));
    }
    blocks
}

fn single(entry: impl Fn(usize, usize) -> f64) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j) as f32))
}

/// The step of some nodes from a first one on. A type rather than a closure: what a closure calls is compiled without the
/// vector instructions.
struct Step<'a, const V: usize> {
    pairs: &'a NodePairs<'a>,
    blocks: &'a [Block],
    inverse: &'a [Block],
    first: usize,
    /// True if d is added; it is zero otherwise.
    takes_in: bool,
    /// α and β, should there be a next d.
    factors: Option<[f32; 2]>,
    d: &'a [f32],
    x: &'a mut [f32],
    r: &'a mut [f32],
    next: &'a mut [f32],
}

impl<const V: usize> WithSimd for Step<'_, V> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match LANES / S::F32_LANES {
            1 => self.of_vectors::<S, 1>(simd),
            2 => self.of_vectors::<S, 2>(simd),
            _ => self.of_vectors::<Scalar, LANES>(Scalar),
        }
    }
}

/// A row: V times L vectors.
type Row<T, const V: usize, const L: usize> = [[T; L]; V];
/// The rows of a node.
type Rows<T, const V: usize, const L: usize> = [Row<T, V, L>; 3];

impl<const V: usize> Step<'_, V> {
    /// With L vectors to [`LANES`].
    #[inline(always)]
    fn of_vectors<S: Simd, const L: usize>(self, simd: S) {
        assert_eq!(L * S::F32_LANES, LANES);
        let Self { pairs, blocks, inverse, first, takes_in, factors, d, x, r, next } = self;
        let d = S::as_simd_f32s(d).0.as_chunks().0.as_chunks().0.as_chunks().0;
        let [x, r, next] =
            [x, r, next].map(|rows| S::as_mut_simd_f32s(rows).0.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0);
        for (k, (((x, r), next), inverse)) in x.iter_mut().zip(r).zip(next).zip(inverse).enumerate() {
            let node = first + k;
            let mut left: Rows<S::f32s, V, L> = *r;
            if takes_in {
                take_product(simd, &mut left, pairs, blocks, node, d);
                (0..3).for_each(|axis| add_multiple(simd, &mut x[axis], 1.0, &d[node][axis]));
                *r = left;
            }
            if let Some([alpha, beta]) = factors {
                for axis in 0..3 {
                    let mut sum = [[simd.splat_f32s(0.0); L]; V];
                    if takes_in {
                        add_multiple(simd, &mut sum, alpha, &d[node][axis]);
                    }
                    for (factor, left) in inverse[axis].iter().zip(&left) {
                        add_multiple(simd, &mut sum, beta * factor, left);
                    }
                    next[axis] = sum;
                }
            }
        }
    }
}

/// Subtracts the rows of a node in K d.
#[inline(always)]
fn take_product<S: Simd, const V: usize, const L: usize>(
    simd: S,
    left: &mut Rows<S::f32s, V, L>,
    pairs: &NodePairs<'_>,
    blocks: &[Block],
    node: usize,
    d: &[Rows<S::f32s, V, L>],
) {
    let range = pairs.start[node]..pairs.start[node + 1];
    // Sums of their own: these stay in the processor's vectors.
    let mut sums = *left;
    for (entry, (other, block)) in range.clone().zip(pairs.nodes[range.clone()].iter().zip(&blocks[range])) {
        if let Some(soon) = pairs.nodes.get(entry + AHEAD) {
            let soon: *const f32 = d[*soon as usize].as_ptr().cast();
            (0..3 * V * LANES).step_by(LINE).for_each(|number| prefetch(soon.wrapping_add(number)));
        }
        let rows = &d[*other as usize];
        for (j, row) in rows.iter().enumerate() {
            for (sum, factors) in sums.iter_mut().zip(block) {
                add_multiple(simd, sum, -factors[j], row);
            }
        }
    }
    *left = sums;
}

/// row += factor · other.
#[inline(always)]
fn add_multiple<S: Simd, const V: usize, const L: usize>(
    simd: S,
    row: &mut Row<S::f32s, V, L>,
    factor: f32,
    other: &Row<S::f32s, V, L>,
) {
    let factor = simd.splat_f32s(factor);
    for v in 0..V {
        for l in 0..L {
            row[v][l] = simd.mul_add_e_f32s(factor, other[v][l], row[v][l]);
        }
    }
}

/// α and β of the steps of Chebyshev's iteration for eigenvalues up to `largest`: Saad (2003), algorithm 12.1.
fn chebyshev(largest: f64) -> [[f32; 2]; DEGREE] {
    let [center, radius] = [0.5 * (1.0 + 1.0 / RANGE), 0.5 * (1.0 - 1.0 / RANGE)].map(|part| part * largest);
    let mut rho = radius / center;
    let factors: [[f64; 2]; DEGREE] = std::array::from_fn(|k| {
        if k == 0 {
            return [0.0, 1.0 / center];
        }
        let before = rho;
        rho = 1.0 / (2.0 * center / radius - before);
        [rho * before, 2.0 * rho / radius]
    });
    factors.map(|of_step| of_step.map(|factor| factor as f32))
}

/// Columns, each times its factor, to rows; zeros in the place of those that are missing.
pub(crate) fn pack(columns: MatRef<'_, f64>, factors: [f64; MAX_COLUMNS], rows: &mut [f32]) {
    let width = columns.ncols().next_multiple_of(LANES);
    rows.par_chunks_mut(3 * NODES_PER_TASK * width).enumerate().for_each(|(task, rows)| {
        let columns = columns.subrows(3 * NODES_PER_TASK * task, rows.len() / width);
        rows.fill(0.0);
        for (c, (column, factor)) in columns.col_iter().zip(factors).enumerate() {
            let values = rows.iter_mut().skip(c).step_by(width);
            values.zip(column.iter()).for_each(|(to, value)| *to = (factor * value) as f32);
        }
    });
}

/// And the sums of blocks of rows back.
pub(crate) fn unpack<const K: usize>(blocks: [&[f32]; K], factors: [f64; MAX_COLUMNS], columns: MatMut<'_, f64>) {
    let width = columns.ncols().next_multiple_of(LANES);
    row_chunks_mut(columns, 3 * NODES_PER_TASK).enumerate().for_each(|(task, columns)| {
        let blocks = blocks.map(|rows| &rows[3 * NODES_PER_TASK * task * width..]);
        for (c, (column, factor)) in columns.col_iter_mut().zip(factors).enumerate() {
            for (row, value) in column.iter_mut().enumerate() {
                *value = factor * blocks.iter().map(|rows| f64::from(rows[width * row + c])).sum::<f64>();
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    /// Blocks of a chain in which each node is coupled to the next three.
    fn chain(nodes: usize) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
        let (mut start, mut coupled, mut values) = (vec![0], Vec::new(), Vec::new());
        for node in 0..nodes {
            let near = node.saturating_sub(3)..(node + 4).min(nodes);
            for axis in 0..3 {
                values
                    .extend(near.clone().flat_map(|other| (0..3).map(move |i| entry(3 * node + axis, 3 * other + i))));
            }
            coupled.extend(near.map(|other| other as u32));
            start.push(coupled.len());
        }
        (start, coupled, values)
    }

    fn entry(i: usize, j: usize) -> f64 {
        if i == j { 3e11 } else { 1e10 * ((i.min(j) * 7 + i.max(j) * 13) as f64).cos() }
    }

    /// Conserved: f − K x of the dense matrix, and the symmetry of the smoothing.
    #[test]
    fn a_smoothing_is_symmetric_and_leaves_what_it_says() {
        let nodes = 2 * NODES_PER_TASK + 11;
        let (start, coupled, values) = chain(nodes);
        let stiffness = NodalStiffness::of_checked(&start, &coupled, &values);
        let k = Mat::from_fn(3 * nodes, 3 * nodes, |i, j| if (i / 3).abs_diff(j / 3) <= 3 { entry(i, j) } else { 0.0 });
        let smoother = Smoother::new(stiffness).unwrap();
        let mut smoother = Smoothing::new(&smoother, MAX_COLUMNS);
        for columns in [1, 8, 13, 24] {
            let forces = Mat::from_fn(3 * nodes, columns, |i, j| 1e6 * ((i * 3 + j * 11) as f64).sin());
            let units = smoother.begin(forces.as_ref());
            smoother.smooth(false);
            let mut answers = Mat::zeros(3 * nodes, columns);
            smoother.end(units, answers.as_mut());
            smoother.take_in();
            let mut left = Mat::zeros(3 * nodes, columns);
            unpack([&smoother.r[..3 * nodes * smoother.width]], units, left.as_mut());
            assert!((&forces - &k * &answers - left).norm_max() < 1e-5 * forces.norm_max());
            let works = forces.transpose() * &answers;
            assert!((&works - works.transpose()).norm_max() < 1e-6 * works.norm_max());
        }
    }
}
