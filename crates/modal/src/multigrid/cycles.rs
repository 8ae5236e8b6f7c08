//! The door of this room: cycles for a body, its modes by them, and the inverse that static responses come from.
//!
//! The factor of a thin body has few entries for each unknown; that of a bulky one, and of a very large thin one, has many, so
//! that the cycles take less time and memory.

use std::time::{Duration, Instant};

use faer::{Mat, MatRef};

use crate::eigen::lanczos::{FIXED, LanczosPairs, largest_pairs, random_block};
use crate::error::ModalError;
use crate::factor::shifted::{Ordered, Shifted};
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::products::WIDTH;
use crate::matrix::renumbering::{Renumbering, Reordered};
use crate::matrix::stiffness::StiffnessMatrix;
use crate::memory_estimate::{Forecast, MemoryEstimate, of_vectors};
use crate::multigrid::coarse::{CoarseMatrices, Corners};
use crate::multigrid::cycle::Multigrid;
use crate::multigrid::davidson;
use crate::multigrid::no_cycles::NoCycles;
use crate::multigrid::smoother::Smoother;
use crate::multigrid::spatial_order::spatial_order;
use crate::support::constraints::Constraints;
use crate::support::held::Support;

/// Multiplications in the factor of K + sM, for each unknown and mode, from which on it takes longer than the cycles: of
/// blocks, with 80 000 unknowns and twenty modes.
const LONG: f64 = 1.2e4;
/// Cycles for fewer modes than this take nearly as long as for this number.
const FEW: usize = 16;
/// Largest part of the strain energy of an error that a cycle may leave: 0.5 on elements five times as long as thick; on those ten
/// times as long, 0.8, the search does not end. It does not tell the steps of a search: 12 of a ring with 0.5, 33 of flat elements
/// with 0.4.
const LEFT_BY_CYCLE: f64 = 0.75;
/// The cycles by which it is found.
const TRIAL_CYCLES: usize = 4;

/// True if the factor of K + sM, of this number of multiplications, takes longer than cycles for `modes` modes.
pub(crate) fn are_faster(multiplications: f64, unknowns: usize, modes: usize) -> bool {
    multiplications > LONG * unknowns as f64 * modes.max(FEW) as f64
}

/// A body of any kind, of which cycles may be made.
pub(crate) struct CycledBody<'a> {
    pub stiffness: StiffnessMatrix<'a>,
    pub mass: &'a MassMatrix<'a>,
    pub positions: &'a [[f64; 3]],
    pub edge_ends: Option<&'a [[u32; 2]]>,
    pub constraints: &'a Constraints,
    /// The shift s.
    pub shift: f64,
    /// Bytes of K and M.
    pub matrix_bytes: usize,
}

/// Cycles for a body: both levels, with the nodes in spatial order.
pub(crate) struct Cycles {
    order: Renumbering,
    /// K and M.
    matrices: Reordered,
    smoother: Smoother,
    corners: Corners,
    /// K_c and M_c of the corners.
    coarse: CoarseMatrices,
    /// The factor of K_c + sM_c.
    pub factor: Shifted,
    /// Time that they took to make, without the ordering of the factor.
    pub time: Duration,
}

impl Cycles {
    /// Makes them for `modes` modes of a body of any size. `progress` hears what the factor of the corners takes.
    pub(crate) fn new(body: &CycledBody<'_>, modes: usize, progress: impl FnOnce(Forecast)) -> Result<Self, NoCycles> {
        let (Some(edge_ends), StiffnessMatrix::Nodal(stiffness), MassMatrix::Nodal(mass)) =
            (body.edge_ends, body.stiffness, body.mass)
        else {
            return Err(NoCycles::NoCorners);
        };
        if !body.constraints.is_empty() {
            return Err(NoCycles::Held);
        }
        let started = Instant::now();
        let order = spatial_order(body.positions);
        let ends: Vec<[u32; 2]> =
            order.sorted(edge_ends).into_iter().map(|ends| ends.map(|node| order.place(node))).collect();
        let corners = Corners::new(&ends);
        check_corners(&corners, modes)?;
        memory::check("K and M with the nodes in spatial order", 2 * body.matrix_bytes)?;
        let matrices = order.matrices(stiffness, mass);
        let smoother = Smoother::new(matrices.stiffness()).ok_or(NoCycles::NoInverse)?;

        let coarse = corners.matrices(matrices.stiffness(), &matrices.mass());
        let positions = order.sorted(body.positions);
        let positions: Vec<[f64; 3]> = corners.nodes.iter().map(|node| positions[*node as usize]).collect();
        let constraints = Constraints::new(&Support::free(), &positions, 3)?;
        let stiffness = StiffnessMatrix::Nodal(coarse.stiffness());
        let mass = MassMatrix::Nodal(coarse.mass());
        let held =
            2 * body.matrix_bytes + smoother.bytes() + coarse.bytes() + of_vectors(body.stiffness.ncols(), FIXED);
        let memory = MemoryEstimate::new(stiffness, &mass, held, FIXED);
        let on_corners = Ordered::new(stiffness, &mass, body.shift, &constraints, &memory)?;
        let search = search_bytes(modes, &corners);
        let factor = Shifted::factor(
            on_corners,
            &constraints,
            memory,
            |_| search,
            |forecast| {
                progress(Forecast { on_corners: true, ..forecast });
            },
        )?;
        let left =
            left_by_cycle(StiffnessMatrix::Nodal(matrices.stiffness()), Multigrid::new(&smoother, &corners, &factor)?);
        if left > LEFT_BY_CYCLE {
            return Err(NoCycles::FlatElements { left, limit: LEFT_BY_CYCLE });
        }
        let time = started.elapsed().saturating_sub(factor.ordering_time);
        Ok(Self { order, matrices, smoother, corners, coarse, factor, time })
    }

    /// The lowest `count` pairs that are M-orthogonal to `rigid`; `report` hears after each step how far the search has come, as a
    /// number of pairs.
    pub(crate) fn lowest_pairs(
        &self,
        rigid: MatRef<'_, f64>,
        count: usize,
        report: impl FnMut(usize),
    ) -> Result<LanczosPairs, NoCycles> {
        let Self { order, matrices, corners, coarse, factor, .. } = self;
        check_corners(corners, count)?;
        let rigid = order.rows(rigid);
        let at_corners = corners.at_corners(rigid.as_ref());
        let (wanted, available) = (davidson::start(count), 3 * corners.count() - rigid.ncols());
        let mass = MassMatrix::Nodal(coarse.mass());
        let on_corners = largest_pairs(factor, &mass, at_corners.as_ref(), wanted, available, |_| ())?.vectors;
        let guess = corners.prolonged(on_corners.as_ref());
        drop((at_corners, on_corners));
        let (stiffness, mass) = (StiffnessMatrix::Nodal(matrices.stiffness()), MassMatrix::Nodal(matrices.mass()));
        let mut multigrid = Multigrid::new(&self.smoother, corners, factor)?;
        let mut pairs = davidson::lowest_pairs(stiffness, &mass, rigid.as_ref(), &mut multigrid, guess, count, report)?;
        order.restore(&mut pairs.vectors);
        Ok(pairs)
    }

    /// The cycle, for vectors in the order of the nodes.
    pub(crate) fn inverse(&self) -> Result<CycledInverse<'_>, ModalError> {
        let multigrid = Multigrid::new(&self.smoother, &self.corners, &self.factor)?;
        Ok(CycledInverse { order: &self.order, multigrid })
    }

    /// The most that is held at a time where `modes` modes are found, bytes.
    pub(crate) fn peak_bytes(&self, modes: usize) -> usize {
        self.factor.memory.peak(search_bytes(modes, &self.corners))
    }
}

/// A cycle in the place of (K + sM)⁻¹.
pub(crate) struct CycledInverse<'a> {
    order: &'a Renumbering,
    multigrid: Multigrid<'a>,
}

impl CycledInverse<'_> {
    /// Replaces forces by displacements.
    pub(crate) fn apply(&mut self, x: &mut Mat<f64>) {
        let mut in_order = self.order.rows(x.as_ref());
        self.multigrid.apply(in_order.as_mut());
        self.order.restore(&mut in_order);
        *x = in_order;
    }
}

fn check_corners(corners: &Corners, modes: usize) -> Result<(), NoCycles> {
    let (found, nodes, needed) = (corners.count(), corners.nodes_in_all(), Corners::needed_for(davidson::start(modes)));
    if needed > found {
        return Err(NoCycles::FewCorners { modes, needed, found });
    }
    if 2 * found > nodes {
        return Err(NoCycles::ManyCorners { corners: found, nodes });
    }
    Ok(())
}

/// Bytes of the search for `modes` modes, beside the levels.
fn search_bytes(modes: usize, corners: &Corners) -> usize {
    // The rigid modes twice: in the basis, and in the order of the levels.
    let vectors = 2 * FIXED + davidson::room(modes) + davidson::beside(modes);
    Multigrid::bytes(corners) + of_vectors(3 * corners.nodes_in_all(), vectors)
}

/// The largest part of the strain energy of an error that a cycle leaves, after a few of them; infinite where one leaves more than
/// there was.
fn left_by_cycle(stiffness: StiffnessMatrix<'_>, mut multigrid: Multigrid<'_>) -> f64 {
    let mut error = random_block(stiffness.ncols(), WIDTH, &mut 1);
    // By random forces: smooth, and with that what a cycle does least about.
    multigrid.apply(error.as_mut());
    let mut forces = stiffness.product(error.as_ref());
    let energies = |error: &Mat<f64>, forces: &Mat<f64>| -> Vec<f64> {
        error.col_iter().zip(forces.col_iter()).map(|(e, f)| e.transpose() * f).collect()
    };
    let mut before = energies(&error, &forces);
    let mut left = 0.0;
    for _ in 0..TRIAL_CYCLES {
        multigrid.apply(forces.as_mut());
        error -= &forces;
        forces = stiffness.product(error.as_ref());
        let now = energies(&error, &forces);
        let parts: Vec<f64> = now.iter().zip(&before).map(|(now, before)| now / before).collect();
        // What is no number is not within these, either.
        if !parts.iter().all(|part| (0.0..=1.0).contains(part)) {
            return f64::INFINITY;
        }
        left = parts.into_iter().fold(0.0, f64::max);
        before = now;
    }
    left
}
