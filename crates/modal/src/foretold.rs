//! The memory that a solution takes, foretold from sizes: by the symbolic factorisation before the numeric one.

use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};

/// Bytes of a number or an index.
const WORD: usize = 8;
/// Blocks of vectors beside the basis: the new one, its product with M, a spare, a packed one and scratch of the solver.
const BLOCKS: usize = 5;
/// What faer's products of matrices take as scratch where the processor does not tell the size of its caches.
const CACHE: usize = 32 << 20;

/// Sizes of K and M, and what follows from them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foretold {
    unknowns: usize,
    entries: usize,
    /// K, M, M over nodes, rigid modes.
    matrices: usize,
    /// The factor of K + sM, with its pattern.
    factor: usize,
    /// K + sM itself.
    shifted: usize,
    /// Scratch of the numeric factorisation.
    scratch: usize,
}

impl Foretold {
    pub(crate) fn new(
        stiffness: SparseColMatRef<'_, usize, f64>,
        mass: SparseColMatRef<'_, usize, f64>,
        rigid: usize,
    ) -> Self {
        let (unknowns, entries) = (stiffness.ncols(), stiffness.row_idx().len());
        let of = |indices: usize, values: usize| WORD * (indices + values + unknowns);
        let shared = std::ptr::eq(stiffness.row_idx(), mass.row_idx());
        let of_mass = if shared { WORD * mass.val().len() } else { of(mass.row_idx().len(), mass.val().len()) };
        // A nodal index has four bytes, and a node has nine entries of K for one of M.
        let nodal = (WORD + 4) * entries / 9 + WORD * unknowns / 3;
        let matrices = of(entries, entries) + of_mass + nodal + WORD * rigid * unknowns;
        Self { unknowns, entries, matrices, factor: 0, shifted: of(entries, entries), scratch: 0 }
    }

    /// With the factor, of which the numeric factorisation takes so many bytes of scratch.
    pub(crate) fn with_factor(mut self, symbolic: &SymbolicCholesky<usize>, scratch: usize) -> Self {
        let pattern = match symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => simplicial.len_val() + self.unknowns,
            SymbolicCholeskyRaw::Supernodal(supernodal) => supernodal.row_idx().len() + 3 * supernodal.n_supernodes(),
        };
        self.factor = WORD * (symbolic.len_val() + pattern + 2 * self.unknowns);
        self.scratch = scratch;
        self
    }

    /// K + sM, what orders it, and what finds the pattern of its factor.
    pub(crate) fn of_ordering(&self) -> usize {
        // The graph grows by doubling.
        let graph = crate::ordering::ordering_bytes(self.unknowns / 3, self.entries / 9) + 2 * 4 * self.entries / 9;
        self.shifted + graph.max(WORD * (self.entries + 5 * self.unknowns))
    }

    /// From the numeric factorisation on, beside K, M and K + sM: the factor, and what comes with it or after it.
    pub(crate) fn of_factor(&self, search: usize) -> usize {
        self.factor + self.scratch.max(search.saturating_sub(self.shifted))
    }

    /// The search for modes with a basis of so many vectors, beside the factor.
    pub(crate) fn of_basis(&self, vectors: usize, block: usize) -> usize {
        WORD * self.unknowns * (2 * vectors + BLOCKS * block)
    }

    /// Rayleigh–Ritz for so many shapes: them, as they come and go, and twice their products with K and M.
    pub(crate) fn of_ritz(&self, shapes: usize) -> usize {
        of_vectors(self.unknowns, 6 * shapes)
    }

    /// The reduction to so many shapes, which are there besides: they, their products with M, and both by axes.
    pub(crate) fn of_reduction(&self, shapes: usize) -> usize {
        of_vectors(self.unknowns, 5 * shapes + 4 * REDUCED)
    }

    /// The most that is held at a time where `size` vectors come up in the search for `shapes`.
    pub(crate) fn peak(&self, size: usize, block: usize, shapes: usize) -> usize {
        let search = self.of_basis(size, block).max(self.of_ritz(shapes)).max(self.of_reduction(shapes));
        self.matrices + self.of_ordering().max(self.shifted + self.factor + self.scratch).max(self.factor + search)
    }
}

/// Columns beside the flexible shapes in the reduction: six rigid ones, X and 1.
const REDUCED: usize = 8;

/// Bytes of so many vectors.
pub(crate) fn of_vectors(unknowns: usize, vectors: usize) -> usize {
    WORD.saturating_mul(unknowns).saturating_mul(vectors)
}

/// The address space that faer's products of dense matrices reserve for each thread: twice the processor's last cache.
pub(crate) fn of_dense_products(threads: usize) -> usize {
    let size = |index: usize| {
        let text = std::fs::read_to_string(format!("/sys/devices/system/cpu/cpu0/cache/index{index}/size")).ok()?;
        text.trim().strip_suffix('K')?.parse::<usize>().ok()?.checked_mul(1024)
    };
    2 * threads * (0..4).filter_map(size).fold(CACHE, usize::max)
}
