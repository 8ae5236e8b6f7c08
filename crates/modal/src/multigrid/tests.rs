//! The cycle of two levels on a bulky block: symmetric, positive, and near to K⁻¹.

use faer::Mat;
use nalgebra::Vector3;

use crate::eigen::lanczos::random_block;
use crate::error::ModalError;
use crate::factor::shifted::{Ordered, Shifted};
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::matrix::tall;
use crate::memory_estimate::MemoryEstimate;
use crate::multigrid::coarse::CoarseMatrices;
use crate::multigrid::coarse::tests::Block;
use crate::multigrid::cycle::Multigrid;
use crate::multigrid::smoother::Smoother;
use crate::multigrid::{Cycles, NoCycles};
use crate::solve::{Inverse, Solver};
use crate::statics::response::StaticAccuracy;
use crate::support::constraints::Constraints;
use crate::support::held::Support;
use crate::support::rigid_fields::rigid_fields;

/// The cycle may work with single precision.
const ROUNDING: f64 = 1e-5;
/// More vectors than are worked on together, and no multiple of them.
const VECTORS: usize = 11;

/// A block with what the cycle is made of.
struct Levels {
    block: Block,
    coarse: CoarseMatrices,
    shift: f64,
    smoother: Smoother,
    /// An orthonormal basis of the rigid motions.
    rigid: Mat<f64>,
}

impl Levels {
    /// With a part of the shift that the search for modes has.
    fn new(cells: [usize; 3], part_of_shift: f64) -> Self {
        let block = Block::new(cells);
        let coarse = block.corners.matrices(block.stiffness(), &block.mass());
        let positions = block.mesh.positions();
        let solver = Solver::of_nodes(block.stiffness(), block.mass(), positions, &Support::free()).unwrap();
        let shift = part_of_shift * solver.shift().unwrap();
        let rigid = rigid_fields(positions, &Vector3::from(positions[0]), 3).qr().compute_thin_Q();
        let smoother = Smoother::new(block.stiffness()).unwrap();
        Self { block, coarse, shift, smoother, rigid }
    }

    /// The factor of K_c + sM_c.
    fn factor(&self) -> Shifted {
        let stiffness = StiffnessMatrix::Nodal(self.coarse.stiffness());
        let mass = MassMatrix::Nodal(self.coarse.mass());
        let constraints = Constraints::new(&Support::free(), &self.block.corner_positions(), 3).unwrap();
        let memory = MemoryEstimate::new(stiffness, &mass, 0, 0);
        let ordered = Ordered::new(stiffness, &mass, self.shift, &constraints, &memory).unwrap();
        Shifted::factor(ordered, &constraints, memory, |_| 0, |_| ()).unwrap()
    }

    fn cycle<'a>(&'a self, factor: &'a Shifted) -> Multigrid<'a> {
        Multigrid::new(&self.smoother, &self.block.corners, factor).unwrap()
    }

    fn random(&self, seed: u64) -> Mat<f64> {
        random_block(self.rigid.nrows(), VECTORS, &mut seed.clone())
    }

    /// Random vectors that are orthogonal to the rigid motions.
    fn balanced(&self, seed: u64) -> Mat<f64> {
        let random = self.random(seed);
        // Once more for what rounding leaves.
        (0..2).fold(random, |x, _| &x - &self.rigid * (self.rigid.transpose() * &x))
    }

    /// K X.
    fn forces(&self, x: &Mat<f64>) -> Mat<f64> {
        StiffnessMatrix::Nodal(self.block.stiffness()).product(x.as_ref())
    }
}

/// B F.
fn applied(cycle: &mut Multigrid<'_>, forces: &Mat<f64>) -> Mat<f64> {
    let mut x = forces.clone();
    cycle.apply(x.as_mut());
    x
}

/// Conserved: symmetry.
#[test]
fn the_cycle_is_symmetric_and_positive() {
    let levels = Levels::new([5, 6, 4], 1.0);
    let factor = levels.factor();
    let mut cycle = levels.cycle(&factor);
    // Of forces that are not balanced, the rigid motions are nearly all of the answer.
    for forces in [levels.balanced(5), levels.random(6)] {
        let answers = applied(&mut cycle, &forces);
        let work = tall::inner(forces.as_ref(), answers.as_ref());
        assert!((0..VECTORS).all(|i| work[(i, i)] > 0.0), "{work:?}");
        for (i, j) in (0..VECTORS).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let off = (work[(i, j)] - work[(j, i)]).abs() / (work[(i, i)] * work[(j, j)]).sqrt();
            assert!(off < ROUNDING, "{i} {j}: {off:e}");
        }
    }
}

/// Conserved: each column alone gives the same.
#[test]
fn columns_do_not_depend_on_those_beside_and_before_them() {
    let levels = Levels::new([3, 4, 3], 1.0);
    let factor = levels.factor();
    let mut cycle = levels.cycle(&factor);
    let forces = levels.balanced(7);
    let together = applied(&mut cycle, &forces);
    for k in (0..VECTORS).rev() {
        let alone = applied(&mut cycle, &forces.subcols(k, 1).to_owned());
        let off = (alone.col(0) - together.col(k)).norm_l2() / together.col(k).norm_l2();
        assert!(off < ROUNDING, "column {k}: {off:e}");
    }
    let nothing = applied(&mut cycle, &Mat::zeros(forces.nrows(), 2));
    assert_eq!(nothing.norm_max(), 0.0);
}

/// The largest part of its error, in the energy norm, that each step of x += B (K exact − K x) leaves of a column.
fn left_by_steps(levels: &Levels, cycle: &mut Multigrid<'_>, exact: &Mat<f64>, steps: usize) -> Vec<f64> {
    let mut error = exact.clone();
    let energies = |error: &Mat<f64>, residual: &Mat<f64>| -> Vec<f64> {
        (0..VECTORS).map(|k| error.col(k).transpose() * residual.col(k)).collect()
    };
    let mut residual = levels.forces(&error);
    let mut before = energies(&error, &residual);
    let mut left = Vec::new();
    for _ in 0..steps {
        error -= applied(cycle, &residual);
        residual = levels.forces(&error);
        let after = energies(&error, &residual);
        left.push(after.iter().zip(&before).map(|(after, before)| (after / before).sqrt()).fold(0.0, f64::max));
        before = after;
    }
    left
}

/// Conserved: the part of a known error that a step leaves does not depend on the number of elements.
#[test]
fn the_cycle_is_near_to_the_inverse_for_any_size_of_the_elements() {
    // With the shift of the search, which is about the lowest eigenvalue, and with next to none: there a step to the corners
    // that is too long would show, which the first one hides.
    for (cells, part_of_shift) in [([4, 4, 4], 1.0), ([4, 4, 4], 0.01), ([8, 8, 8], 1.0), ([8, 8, 8], 0.01)] {
        let levels = Levels::new(cells, part_of_shift);
        let factor = levels.factor();
        let mut cycle = levels.cycle(&factor);
        // Random displacements are rough: the first steps take more than half of the error. Measured: 0.05, 0.23, 0.45.
        let rough = left_by_steps(&levels, &mut cycle, &levels.balanced(8), 10);
        assert!(rough[..3].iter().all(|left| *left < 0.5), "{cells:?}, {part_of_shift}: {rough:?}");
        // Those by random forces are smooth.
        let smooth = applied(&mut cycle, &levels.balanced(9));
        let smooth = left_by_steps(&levels, &mut cycle, &smooth, 10);
        for left in [rough, smooth] {
            // Measured: 0.63 at worst, where a mode is damped by s/(λ + s) and by little else.
            assert!(left.iter().all(|left| *left < 0.7), "{cells:?}, {part_of_shift}: {left:?}");
        }
    }
}

fn solver(block: &Block) -> Solver<'_> {
    Solver::of_nodes(block.stiffness(), block.mass(), block.mesh.positions(), &Support::free()).unwrap()
}

fn cycles(solver: &Solver<'_>, modes: usize) -> Result<Cycles, NoCycles> {
    Cycles::new(&solver.cycled_body().unwrap(), modes, |_| ())
}

/// One that has its answers from cycles, in spite of the few unknowns.
fn solver_by_cycles(block: &Block) -> Solver<'_> {
    let solver = solver(block).with_edge_ends(block.ends()).unwrap();
    let cycles = cycles(&solver, 20).unwrap();
    assert!(solver.cycles.set(cycles).is_ok());
    solver
}

/// Independent reference: the modes by the factor.
#[test]
fn modes_by_cycles_are_those_by_the_factor() {
    let block = Block::new([6, 5, 4]);
    let expected = solver(&block).modes(20, |_| ()).unwrap();
    let found = solver_by_cycles(&block).modes(20, |_| ()).unwrap();
    assert_eq!(expected.stats.cycles, 0);
    assert!(found.stats.cycles > 0);
    for (found, expected) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
        assert!((found / expected - 1.0).abs() < 1e-11, "{found} instead of {expected}");
    }
    let momenta = solver(&block).mass().product(expected.shapes.as_ref());
    let cosines = tall::inner(found.shapes.as_ref(), momenta.as_ref());
    for k in 0..20 {
        assert!((cosines[(k, k)] - 1.0).abs() < 1e-12, "mode {k}: {}", cosines[(k, k)] - 1.0);
    }
}

/// Independent reference: the static responses by the factor.
#[test]
fn static_answers_by_cycles_are_those_by_the_factor() {
    let block = Block::new([6, 5, 4]);
    let (by_factor, by_cycles) = (solver(&block), solver_by_cycles(&block));
    // A force at a node, and one that is spread.
    let rows = 3 * block.mesh.positions().len();
    let forces = Mat::from_fn(rows, 2, |row, k| if k == 0 { f64::from(row == 100) } else { (row as f64).sin() });
    let known = by_factor.modes(6, |_| ()).unwrap();
    let none = by_factor.modes(0, |_| ()).unwrap();
    for modes in [&known, &none] {
        for (accuracy, part) in [(StaticAccuracy::Full, 1e-10), (StaticAccuracy::Shapes, 1e-4)] {
            let respond = |solver: &Solver<'_>| solver.static_response_from(modes, forces.as_ref(), accuracy).unwrap();
            let (found, expected) = (respond(&by_cycles), respond(&by_factor));
            for k in 0..forces.ncols() {
                let off = (found.col(k) - expected.col(k)).norm_l2() / expected.col(k).norm_l2();
                assert!(off < part, "{accuracy:?}, force {k}: {off:e}");
            }
        }
    }
    assert!(by_cycles.solved()[0] > 0);
}

/// Rounding in K, of a body of 400 times its thickness.
const ROUNDING_IN_K: f64 = 1e-6;

/// Independent reference: the modes and the static response by the factor.
#[test]
fn cycles_end_where_rounding_leaves_no_more() {
    let block = Block::new([400, 1, 1]);
    let (by_factor, by_cycles) = (solver(&block), solver_by_cycles(&block));
    let (expected, found) = (by_factor.modes(20, |_| ()).unwrap(), by_cycles.modes(20, |_| ()).unwrap());
    for (found, expected) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
        assert!((found / expected - 1.0).abs() < ROUNDING_IN_K, "{found} instead of {expected}");
    }
    let forces = Mat::from_fn(3 * block.mesh.positions().len(), 1, |row, _| f64::from(row == 100));
    let respond =
        |solver: &Solver<'_>, modes| solver.static_response_from(modes, forces.as_ref(), StaticAccuracy::Full).unwrap();
    let (found, expected) = (respond(&by_cycles, &found), respond(&by_factor, &expected));
    assert!((&found - &expected).norm_l2() < ROUNDING_IN_K * expected.norm_l2());
    // The factor did not have to help.
    assert!(matches!(by_cycles.inverse(1, |_| 0, &mut |_| ()), Ok(Inverse::Cycles(_))));
}

#[test]
fn where_cycles_are_no_help_they_say_why() {
    let refused = |solver: Solver<'_>, block: &Block, modes| {
        cycles(&solver.with_edge_ends(block.ends()).unwrap(), modes).err().unwrap()
    };
    let block = Block::new([6, 5, 4]);
    assert!(matches!(cycles(&solver(&block), 20), Err(NoCycles::NoCorners)));
    // The corners do not have that many modes.
    let few = refused(solver(&block), &block, 250);
    assert!(matches!(few, NoCycles::FewCorners { modes: 250, needed: 256, found: 210 }), "{few}");
    let support = Support { nodes: vec![0, 1, 2, 3], ..Support::free() };
    let held = Solver::of_nodes(block.stiffness(), block.mass(), block.mesh.positions(), &support).unwrap();
    assert!(matches!(refused(held, &block, 20), NoCycles::Held));
    // The corners alone are far too stiff where elements are flat.
    let flat = Block::stretched([8, 8, 1], [1.0, 1.0, 0.02]);
    let left = refused(solver(&flat), &flat, 20);
    assert!(matches!(left, NoCycles::FlatElements { left, .. } if left > 0.75), "{left}");
    assert!(left.to_string().contains("about as long as they are thick"), "{left}");
}

/// Independent reference: the modes by the factor.
#[test]
fn the_factor_takes_the_place_of_cycles_that_give_up_and_the_reason_is_told() {
    let block = Block::new([6, 5, 4]);
    let by_cycles = solver_by_cycles(&block);
    assert!(by_cycles.no_cycles().is_none());
    let found = by_cycles.modes(250, |_| ()).unwrap();
    assert_eq!(found.stats.cycles, 0);
    assert_eq!(found.eigenvalues, solver(&block).modes(250, |_| ()).unwrap().eigenvalues);
    let reason = by_cycles.no_cycles().unwrap();
    assert!(matches!(reason, NoCycles::FewCorners { modes: 250, .. }), "{reason}");
    // The factor of a small body takes no time: nothing has to be said.
    let solver = solver(&block).with_edge_ends(block.ends()).unwrap();
    assert_eq!(solver.modes(4, |_| ()).unwrap().stats.cycles, 0);
    assert!(solver.no_cycles().is_none());
}

#[test]
fn ends_of_edges_that_do_not_fit_are_refused() {
    let block = Block::new([2, 2, 2]);
    let refused = |change: &dyn Fn(&mut Vec<[u32; 2]>)| {
        let mut ends = block.ends();
        change(&mut ends);
        solver(&block).with_edge_ends(ends).err().unwrap()
    };
    let middle = block.ends().iter().zip(0..).find(|(ends, _)| ends[0] != ends[1]).unwrap().1;
    assert!(matches!(refused(&|ends| ends.truncate(124)), ModalError::Length { expected: 125, found: 124, .. }));
    assert!(matches!(refused(&|ends| ends[3] = [0, 125]), ModalError::NoNode { node: 125, count: 125 }));
    assert!(matches!(refused(&|ends| ends[3] = [middle, 0]), ModalError::NoCorner { node: 3, end } if end == middle));
}
