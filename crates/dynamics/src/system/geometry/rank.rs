//! Rows that others imply, by a pivoted factor of the rows that close loops: Eq. (J31) of `docs/method/systems.md`.

use nalgebra::{DMatrix, RowDVector};

use crate::system::description::System;
use crate::system::geometry::loops::Loops;
use crate::system::geometry::posture::Posture;
use crate::system::geometry::tree::Tree;

/// Part of a row over its size, beside others, below which they imply it where the joints are closed.
pub(crate) const IMPLIED: f64 = 1e-7;
/// The same over the rounding of places of the ground as a part of the shortest loop; and at most.
const OF_ROUNDING: f64 = 10.0;
const LARGEST_IMPLIED: f64 = 1e-3;
/// Part of a row, over the root of that rounding, below which the rounding decides how a linkage goes on.
const UNDECIDED: f64 = 4.0;
/// Rows that were held before stay so, unless others are this many times better.
const HELD: f64 = 4.0;

/// Numbers in the rows that close loops above which they are judged only where something fails.
const MANY: usize = 10_000;

/// Rows of a system, by whether others imply them.
#[derive(Debug, Clone)]
pub(crate) struct Rank {
    /// For each row of the system, true if others imply it.
    pub is_implied: Vec<bool>,
    /// Multipliers of rows that do nothing to the bodies, one list over the rows of the system for each row that is implied.
    pub idle: Vec<Vec<f64>>,
    /// The free motions of the tree that all rows allow, if that is one.
    pub free: Option<Vec<f64>>,
    /// The smallest part of a row that is kept.
    pub smallest: f64,
    /// True if the position is singular but for what places of the ground are rounded by.
    pub is_undecided: bool,
}

/// The loops of a system where its bodies are, and which rows the others imply there.
#[derive(Debug, Clone)]
pub(crate) struct Judgement {
    pub tree: Tree,
    pub loops: Loops,
    pub rank: Rank,
}

impl Judgement {
    /// Judges the rows of bodies with their modes, or as if they were rigid, with nothing known before.
    pub fn first(system: &System, at: &Posture<'_>, with_modes: bool) -> Self {
        let tree = Tree::new(system, at);
        let loops = Loops::new(system, at, &tree, with_modes);
        let rank = Rank::new(&loops, &vec![false; loops.sizes.len()], system.rounding);
        Self { tree, loops, rank }
    }

    /// Judges them again where the bodies have moved.
    pub fn again(&mut self, system: &System, at: &Posture<'_>) {
        let held: Vec<bool> = self.rank.is_implied.iter().map(|is_implied| !is_implied).collect();
        self.tree.middle = Tree::middle_of(at);
        self.loops = Loops::new(system, at, &self.tree, true);
        self.rank = Rank::new(&self.loops, &held, system.rounding);
    }

    /// True if the rows are judged wherever the system is.
    pub fn is_of_now(&self) -> bool {
        self.work() <= MANY
    }

    /// Number of numbers that are judged.
    fn work(&self) -> usize {
        self.loops.matrix.len()
    }
}

impl Rank {
    /// Judges the rows; `held` are left out last. Places of the ground are off by `rounding`, which turns rows that others imply a little.
    pub fn new(loops: &Loops, held: &[bool], rounding: f64) -> Self {
        let shortest = loops.rows.iter().map(|row| loops.lengths[*row]).fold(f64::INFINITY, f64::min);
        let rounding = rounding / shortest;
        let implied = IMPLIED.max((OF_ROUNDING * rounding).min(LARGEST_IMPLIED));
        let mut is_implied = vec![false; loops.sizes.len()];
        let (columns, count) = loops.matrix.shape();
        let factor = |a: usize| if held[loops.rows[a]] { HELD } else { 1.0 };
        let weighted = DMatrix::from_fn(columns, count, |i, a| loops.matrix[(i, a)] * factor(a));
        if columns == 0 || count == 0 {
            loops.rows.iter().for_each(|row| is_implied[*row] = true);
            let idle = (0..count).map(|a| loops.idle_row(&[(a, 1.0)])).collect();
            let free = (columns == 1).then(|| vec![1.0]);
            return Self { is_implied, idle, free, smallest: f64::INFINITY, is_undecided: false };
        }
        let qr = weighted.col_piv_qr();
        let (q, r) = (qr.q(), qr.r());
        let mut order = RowDVector::from_iterator(count, 0..count);
        qr.p().permute_columns(&mut order);
        let rank = (0..r.nrows().min(count)).take_while(|i| r[(*i, *i)].abs() > implied).count();
        let kept = r.view((0, 0), (rank, rank)).into_owned();
        let mut idle = Vec::new();
        for k in rank..count {
            is_implied[loops.rows[order[k]]] = true;
            let Some(parts) = kept.solve_upper_triangular(&r.view((0, k), (rank, 1))) else { continue };
            // Weighted columns w_a c_a: what is left of column k is nothing.
            let of_kept = (0..rank).map(|i| (order[i], -parts[i] * factor(order[i])));
            let list: Vec<(usize, f64)> = of_kept.chain([(order[k], factor(order[k]))]).collect();
            idle.push(loops.idle_row(&list));
        }
        let free = (columns == rank + 1).then(|| {
            let q = q.columns(0, rank);
            let left = DMatrix::identity(columns, columns) - q * q.transpose();
            let best = (0..columns).max_by(|a, b| left.column(*a).norm().total_cmp(&left.column(*b).norm()));
            let column = left.column(best.unwrap_or(0)).into_owned();
            (&column / column.norm()).as_slice().to_vec()
        });
        let smallest = (0..rank).map(|i| r[(i, i)].abs() / factor(order[i])).fold(f64::INFINITY, f64::min);
        // A gap g bends the ways through a singular position within √g of it.
        let is_undecided = rounding > 0.0 && smallest < UNDECIDED * rounding.sqrt();
        Self { is_implied, idle, free, smallest, is_undecided }
    }
}

impl Rank {
    /// The part of residuals in the idle rows, over the rows of the system.
    pub fn idle_part(&self, residuals: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; residuals.len()];
        for idle in &self.idle {
            let part: f64 = idle.iter().zip(residuals).map(|(u, g)| u * g).sum();
            out.iter_mut().zip(idle).for_each(|(out, u)| *out += part * u);
        }
        out
    }
}
