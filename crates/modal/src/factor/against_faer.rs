//! The factor of K + sM and its substitution against faer's supernodal LLᵀ of the same matrix: `./dev factor` measures them in turn
//! and prints the table of `docs/evidence/factor.md`.

use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side, Spec};
use fem_tet10::{Material, Materials, assemble, read_msh};

use crate::factor::cholesky::Problem;
use crate::factor::interleave::interleave;
use crate::factor::shifted_matrix::ShiftedMatrix;
use crate::factor::substitution::{self, Factor};
use crate::factor::symbolic::{Supernodal, Symbolic};
use crate::matrix::mass::NodalMass;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::{NodalStiffness, StiffnessMatrix};
use crate::solve::Solver;
use crate::support::constraints::Constraints;
use crate::support::held::Support;

const STEEL: Material = Material { young_modulus: 2.1e5, poisson_ratio: 0.3, density: 7.85e-9 };
/// Turns, of which the fastest counts.
const TURNS: usize = 9;
/// Columns that are solved for.
const COLUMNS: [usize; 3] = [1, 10, 16];

/// The fastest times of a factor and of its solutions, seconds.
#[derive(Clone, Copy)]
struct Times {
    factor: f64,
    solve: [f64; COLUMNS.len()],
}

impl Times {
    const NONE: Self = Self { factor: f64::INFINITY, solve: [f64::INFINITY; COLUMNS.len()] };

    fn or_faster(&mut self, factor: Duration, solve: [Duration; COLUMNS.len()]) {
        self.factor = self.factor.min(factor.as_secs_f64());
        self.solve.iter_mut().zip(solve).for_each(|(fastest, time)| *fastest = fastest.min(time.as_secs_f64()));
    }
}

/// The time of some work: on one thread that of the processor, which other programs do not lengthen by taking turns with it.
fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let on_processor = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
    };
    let (started, before) = (Instant::now(), on_processor());
    let done = work();
    let elapsed = started.elapsed();
    match (before, on_processor()) {
        (Some(before), Some(after)) if rayon::current_num_threads() == 1 => (done, after - before),
        _ => (done, elapsed),
    }
}

/// faer's factor in some order: its pattern and its times.
struct ByFaer {
    symbolic: SymbolicCholesky<usize>,
    times: Times,
}

impl ByFaer {
    fn new(pattern: SymbolicSparseColMatRef<'_, usize>, order: SymmetricOrdering<'_, usize>) -> Self {
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, order, Default::default()).unwrap();
        Self { symbolic, times: Times::NONE }
    }

    /// Bytes of its numbers and of its pattern.
    fn bytes(&self) -> usize {
        let SymbolicCholeskyRaw::Supernodal(pattern) = self.symbolic.raw() else { panic!("no supernodes") };
        8 * (self.symbolic.len_val() + pattern.row_idx().len() + 4 * pattern.n_supernodes())
    }

    /// A turn: solves for the columns of `forces`.
    fn measure(&mut self, matrix: &SparseColMat<usize, f64>, forces: &Mat<f64>, par: Par) -> Mat<f64> {
        let Self { symbolic, times } = self;
        let mut values = vec![0.0; symbolic.len_val()];
        let mut scratch = MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(par, Spec::default()));
        let (_, factor_time) = timed(|| {
            let (stack, spec) = (MemStack::new(&mut scratch), Spec::default());
            symbolic
                .factorize_numeric_llt(&mut values, matrix.as_ref(), Side::Lower, Default::default(), par, stack, spec)
                .unwrap();
        });
        let mut last = Mat::new();
        let solve = COLUMNS.map(|columns| {
            let mut scratch = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(columns, par));
            last = forces.subcols(0, columns).to_owned();
            let stack = MemStack::new(&mut scratch);
            timed(|| {
                LltRef::new(symbolic, &values).solve_in_place_with_conj(Conj::No, last.as_mut(), par, stack);
            })
            .1
        });
        times.or_faster(factor_time, solve);
        last
    }
}

/// Meshes, second-order tetrahedra of steel in mm, t and s, are named in `FLEXFRAME_MESHES`, with `:` between them.
#[test]
#[ignore = "a measurement: just factor"]
fn measured() {
    let meshes = std::env::var("FLEXFRAME_MESHES").expect("FLEXFRAME_MESHES names meshes");
    println!("| body | unknowns | threads | | factor, s | solution, {COLUMNS:?} columns, ms | memory, MB |");
    println!("|---|---:|---:|---|---:|---:|---:|");
    for path in meshes.split(':') {
        let mesh = read_msh(path).unwrap();
        let matrices = assemble(&mesh, &Materials::Uniform(STEEL), &[]).unwrap();
        let stiffness = NodalStiffness::of_checked(matrices.start(), matrices.nodes(), matrices.stiffness_by_nodes());
        let mass = NodalMass::of_checked_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes());
        let solver = Solver::of_nodes(stiffness, mass.clone(), mesh.positions(), &Support::free()).unwrap();
        let mass = MassMatrix::Nodal(mass);
        let constraints = Constraints::new(&Support::free(), mesh.positions(), 3).unwrap();
        let stiffness = StiffnessMatrix::Nodal(stiffness);
        let matrix = ShiftedMatrix::new(stiffness, &mass, solver.shift().unwrap(), &constraints);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| compare(path, &matrix, threads));
        }
    }
}

/// Measures a matrix in turn on the threads of this pool, and prints the rows of the table.
fn compare(name: &str, matrix: &ShiftedMatrix<'_>, threads: usize) {
    let Symbolic::Supernodal(ours) = Symbolic::new(matrix).unwrap() else { panic!("no supernodes") };
    let Supernodal { order, supernodes, subtrees } = &ours;
    let pattern = matrix.pattern().unwrap();
    let assembled = matrix.assembled(&pattern).unwrap();
    let par = if threads == 1 { Par::Seq } else { Par::rayon(threads) };
    let ordered = |order| ByFaer::new(pattern.as_ref(), order);
    let mut by_faer = [
        ("faer, in our order", ordered(SymmetricOrdering::Custom(order.as_ref()))),
        ("faer, in its own order", ordered(SymmetricOrdering::Amd)),
    ];
    let forces = Mat::from_fn(matrix.size(), 16, |i, j| ((i * 7 + j * 13) as f64).cos());
    let mut own = Times::NONE;
    for _ in 0..TURNS {
        let mut values = vec![0.0; supernodes.factor_entries()];
        let (done, factor_time) = timed(|| {
            let problem = Problem { supernodes, subtrees, order: order.as_ref(), matrix };
            let done = problem.factor(&mut values).is_ok();
            interleave(supernodes, subtrees, &mut values);
            done
        });
        assert!(done);
        let factor = Factor { supernodes, subtrees, values: &values };
        let mut scratch = substitution::Scratch::default();
        let mut last = Mat::new();
        let solve = COLUMNS.map(|columns| {
            last = forces.subcols(0, columns).to_owned();
            timed(|| substitution::solve(factor, Some(order.as_ref()), last.as_mut(), &mut scratch)).1
        });
        own.or_faster(factor_time, solve);
        for (_, by_faer) in &mut by_faer {
            let expected = by_faer.measure(&assembled, &forces, par);
            assert!((&last - &expected).norm_max() < 1e-6 * expected.norm_max());
        }
    }
    let row = |who: &str, times: Times, bytes: usize| {
        let of = |time: f64, own: f64| format!("{time:.3} ({:.2})", time / own);
        let solve = times.solve.iter().zip(own.solve).map(|(time, own)| of(1e3 * time, 1e3 * own)).collect::<Vec<_>>();
        let (factor, solve, megabytes) = (of(times.factor, own.factor), solve.join(", "), bytes as f64 / 1e6);
        println!("| {name} | {} | {threads} | {who} | {factor} | {solve} | {megabytes:.0} |", matrix.size());
    };
    row("ours", own, 8 * supernodes.factor_entries() + supernodes.bytes());
    for (who, by_faer) in &by_faer {
        row(who, by_faer.times, by_faer.bytes() + 16 * assembled.row_idx().len());
    }
}
