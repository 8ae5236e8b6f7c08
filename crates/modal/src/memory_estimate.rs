//! Memory and time of a solution, estimated by the symbolic factorisation before the numeric one.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::{Mat, Par, Spec};
use rayon::prelude::*;

use crate::factor::symbolic::{Supernodal, Symbolic};
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::products::WIDTH;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::reduction::parts::{general_vectors, nodal_vectors, products_bytes};

/// Bytes of a number or an index.
const WORD: usize = 8;
/// Rigid modes at the most.
const RIGID: usize = 6;
/// Blocks of vectors beside the basis: the new one, products with M of it and of two more, a packed one and scratch of the
/// solver.
const BLOCKS: usize = 6;
/// Scratch of faer's products of matrices where the processor does not tell the size of its caches.
const CACHE: usize = 32 << 20;

/// Factors of fewer multiplications take less than about a second: their time is not estimated.
const SHORT: f64 = 5e9;
/// Rows of the dense matrix whose factorisation tells how fast this machine is.
const TRIAL: usize = 768;
/// A sparse factor is made at this part of the speed of that dense one.
const SPARSE_SPEED: f64 = 0.6;

/// Memory and time of the numeric factorisation, by the symbolic one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Entries of the factor.
    pub factor_entries: usize,
    /// Multiplications (each with an addition) that make it.
    pub multiplications: f64,
    /// Bytes that are held at the most until the modes are found, with K and M.
    pub peak_bytes: usize,
    /// True for the problem on the corners of the elements, which multigrid cycles use.
    pub on_corners: bool,
    /// Time of the factorisation, by a trial on this machine; only where it may come to a second and more.
    pub time: Option<Duration>,
}

impl Forecast {
    pub(crate) fn new(symbolic: &Symbolic, peak_bytes: usize, threads: usize) -> Self {
        let (factor_entries, multiplications) = (symbolic.entries(), symbolic.multiplications());
        let speed = if multiplications > SHORT { speed(threads) } else { None };
        let time = speed.and_then(|speed| Duration::try_from_secs_f64(multiplications / (SPARSE_SPEED * speed)).ok());
        Self { factor_entries, multiplications, peak_bytes, on_corners: false, time }
    }
}

/// Multiplications a second in the factorisation of a dense matrix.
fn speed(threads: usize) -> Option<f64> {
    // One on each thread: the tasks of the factorisation do not share their products.
    let factored = |_: usize| {
        let mut matrix = Mat::from_fn(TRIAL, TRIAL, |i, j| if i == j { TRIAL as f64 } else { 0.5 });
        let scratch = cholesky_in_place_scratch::<f64>(TRIAL, Par::Seq, Spec::default());
        let mut scratch = MemBuffer::try_new(scratch).ok()?;
        let stack = MemStack::new(&mut scratch);
        cholesky_in_place(matrix.as_mut(), Default::default(), Par::Seq, stack, Spec::default()).ok()
    };
    let started = Instant::now();
    (0..threads).into_par_iter().map(factored).collect::<Option<Vec<_>>>()?;
    Some(threads as f64 * (TRIAL as f64).powi(3) / 6.0 / started.elapsed().as_secs_f64())
}

/// Sizes of K and M, and what follows from them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MemoryEstimate {
    unknowns: usize,
    entries: usize,
    /// K, M, rigid modes.
    matrices: usize,
    /// A mass matrix over nodes; none of a general one.
    nodal_mass: Option<usize>,
    /// Bytes of the mass matrix and of the rigid modes in the order of a factor with supernodes, which a search keeps.
    in_order: usize,
    /// Entries of the pattern that the factor's is found by.
    pattern: usize,
    /// The factor of K + sM, with its pattern.
    factor: usize,
    /// K + sM itself, where it is put together.
    shifted: usize,
    /// Scratch of the numeric factorisation.
    scratch: usize,
}

impl MemoryEstimate {
    /// Sizes of K and M, which take `matrices` bytes.
    pub(crate) fn new(stiffness: StiffnessMatrix<'_>, mass: &MassMatrix<'_>, matrices: usize, rigid: usize) -> Self {
        let (unknowns, entries) = (stiffness.ncols(), stiffness.entries());
        let matrices = matrices + WORD * rigid * unknowns;
        let pattern = match stiffness {
            StiffnessMatrix::Nodal(_) => entries / 9,
            StiffnessMatrix::General(_) => entries,
        };
        let nodal_mass = match mass {
            MassMatrix::Nodal(_) => Some(mass.bytes()),
            MassMatrix::General(_) => None,
        };
        Self { unknowns, entries, matrices, nodal_mass, in_order: 0, pattern, factor: 0, shifted: 0, scratch: 0 }
    }

    /// With the factor, of which the numeric factorisation takes `scratch` bytes beside it.
    pub(crate) fn with_factor(mut self, symbolic: &Symbolic, scratch: usize) -> Self {
        let pattern = match symbolic {
            Symbolic::Simplicial(simplicial) => {
                self.shifted = WORD * (2 * self.entries + self.unknowns);
                WORD * (simplicial.len_val() + 3 * self.unknowns)
            }
            Symbolic::Supernodal(Supernodal { supernodes, .. }) => {
                self.in_order = self.nodal_mass.map_or(0, |mass| mass + of_vectors(self.unknowns, RIGID));
                supernodes.bytes() + (WORD * 2 + 4) * self.unknowns
            }
        };
        self.factor = WORD * symbolic.entries() + pattern;
        self.scratch = scratch;
        self
    }

    /// The most that is held here where an engine has the factor and the search, for `shapes` shapes.
    pub(crate) fn peak_beside_engine(&self, shapes: usize) -> usize {
        self.matrices + self.of_ritz(shapes).max(self.of_reduction(shapes))
    }

    /// Bytes for the ordering of K + sM and the pattern of its factor.
    pub(crate) fn of_ordering(&self) -> usize {
        // The graph grows by doubling.
        let graph =
            crate::factor::ordering::ordering_bytes(self.unknowns / 3, self.entries / 9) + 2 * 4 * self.entries / 9;
        graph.max(2 * WORD * (self.pattern + 3 * self.unknowns))
    }

    /// From the numeric factorisation on, beside K and M: the factor, and what comes with it or after it.
    pub(crate) fn of_factor(&self, search: usize) -> usize {
        self.factor + (self.shifted + self.scratch).max(search)
    }

    /// The search for modes with a basis of `vectors` vectors, beside the factor, the `shapes` that come of it at its end, and, in
    /// the order of the factor, the mass matrix and the rigid modes. Static responses have no shapes here, and no such order.
    fn of_basis(&self, vectors: usize, block: usize, shapes: usize) -> usize {
        let in_order = if shapes > 0 { self.in_order } else { 0 };
        of_vectors(self.unknowns, vectors + RIGID + BLOCKS * block + shapes) + in_order
    }

    /// Rayleigh–Ritz for `shapes` shapes: them, their products with K and M, and a packed block.
    fn of_ritz(&self, shapes: usize) -> usize {
        of_vectors(self.unknowns, 3 * shapes + WIDTH)
    }

    /// The search for `shapes` modes with a basis of `size` vectors, and their reduction.
    pub(crate) fn of_search(&self, size: usize, block: usize, shapes: usize) -> usize {
        self.of_basis(size, block, shapes).max(self.of_ritz(shapes)).max(self.of_reduction(shapes))
    }

    /// The reduction to `shapes` shapes: they and the rigid modes, and what is held beside them.
    fn of_reduction(&self, shapes: usize) -> usize {
        let (beside, sums) = match self.nodal_mass {
            Some(_) => (nodal_vectors(shapes), products_bytes(self.unknowns / 3, shapes)),
            None => (general_vectors(shapes), 0),
        };
        of_vectors(self.unknowns, shapes + RIGID + beside) + sums
    }

    /// The most that is held at a time where the `search` for modes takes that number of bytes beside the factor.
    pub(crate) fn peak(&self, search: usize) -> usize {
        self.matrices + self.of_ordering().max(self.shifted + self.factor + self.scratch).max(self.factor + search)
    }
}

/// Bytes of `vectors` vectors.
pub(crate) fn of_vectors(unknowns: usize, vectors: usize) -> usize {
    WORD.saturating_mul(unknowns).saturating_mul(vectors)
}

/// The address space that faer's products of dense matrices reserve for each thread that makes some: twice the last-level
/// caches of the machine.
pub fn reserve_of_dense_products(threads: usize) -> usize {
    2 * threads * last_level_caches(Path::new("/sys/devices/system/cpu")).max(CACHE)
}

/// Bytes of all caches of the last level, each counted once however many processors share it; 0 where the system does not
/// tell.
fn last_level_caches(processors: &Path) -> usize {
    let folders = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let cache = |folder: PathBuf| {
        let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
        let level: usize = text("level")?.trim().parse().ok()?;
        let kibibytes: usize = text("size")?.trim().strip_suffix('K')?.parse().ok()?;
        Some((level, text("shared_cpu_list")?, kibibytes.checked_mul(1024)?))
    };
    let caches: BTreeSet<_> =
        folders(processors).flat_map(|one| folders(&one.join("cache"))).filter_map(cache).collect();
    let last = caches.iter().map(|(level, ..)| *level).max();
    caches.iter().filter(|(level, ..)| Some(*level) == last).map(|(.., bytes)| bytes).sum()
}

#[cfg(test)]
mod tests {
    use faer::Side;
    use faer::perm::Perm;
    use faer::sparse::SymbolicSparseColMat;
    use faer::sparse::linalg::cholesky::{
        CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
    };

    use super::*;
    use crate::factor::supernodes::Supernodes;

    /// Closed form: Σ j²/2 multiplications over the columns.
    #[test]
    fn a_dense_factor_takes_a_sixth_of_the_cube_of_its_size() {
        let n = 240;
        let (start, rows) = ((0..=n).map(|j| n * j).collect(), (0..n * n).map(|entry| entry % n).collect());
        let pattern = SymbolicSparseColMat::new_checked(n, n, start, None, rows);
        let params = CholeskySymbolicParams::default();
        let symbolic =
            factorize_symbolic_cholesky(pattern.as_ref(), Side::Lower, SymmetricOrdering::Identity, params).unwrap();
        let SymbolicCholeskyRaw::Supernodal(symbolic) = symbolic.raw() else { panic!() };
        let identity: Box<[usize]> = (0..n).collect();
        let order = Perm::new_checked(identity.clone(), identity, n);
        let forecast = Forecast::new(&Symbolic::supernodal(order, Supernodes::new(symbolic, 1)), 0, 1);
        let exact = (1..=n).map(|column| (column as f64).powi(2) / 2.0).sum::<f64>();
        assert_eq!(forecast.multiplications, exact);
        assert_eq!(forecast.time, None);
        assert!(speed(1).is_some());
    }

    #[test]
    fn every_cache_of_the_last_level_counts_once() {
        let machine = tempfile::tempdir().unwrap();
        // Four processors, of which two share a cache of 32 MiB each.
        for processor in 0..4 {
            for (index, level, size, shared) in [
                (0, 1, "48K", format!("{processor}")),
                (1, 2, "2048K", format!("{processor}")),
                (2, 3, "32768K", format!("{}-{}", processor / 2 * 2, processor / 2 * 2 + 1)),
            ] {
                let folder = machine.path().join(format!("cpu{processor}/cache/index{index}"));
                std::fs::create_dir_all(&folder).unwrap();
                for (name, text) in [("level", level.to_string()), ("size", size.into()), ("shared_cpu_list", shared)] {
                    std::fs::write(folder.join(name), text + "\n").unwrap();
                }
            }
        }
        assert_eq!(last_level_caches(machine.path()), 2 * (32 << 20));
        assert_eq!(last_level_caches(&machine.path().join("nothing")), 0);
    }
}
