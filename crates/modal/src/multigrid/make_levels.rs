//! The bodies whose modes and static responses come by cycles, and the levels for them.
//!
//! The factor of a thin body has few entries for each unknown; that of a bulky one, and of a very large thin one, has so many
//! that the cycles take less time and memory.

use std::time::Instant;

use faer::Mat;

use crate::eigen::lanczos::{FIXED, random_block};
use crate::error::ModalError;
use crate::factor::shifted::{Ordered, Shifted};
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::MassMatrix;
use crate::matrix::products::WIDTH;
use crate::matrix::stiffness::StiffnessMatrix;
use crate::memory_estimate::{Forecast, MemoryEstimate, of_vectors};
use crate::multigrid::coarse::Corners;
use crate::multigrid::cycle::Multigrid;
use crate::multigrid::davidson;
use crate::multigrid::levels::{Levels, modes_beside};
use crate::multigrid::smoother::Smoother;
use crate::multigrid::spatial_order::spatial_order;
use crate::progress::Progress;
use crate::solve::Solver;
use crate::support::constraints::Constraints;
use crate::support::motion::Support;

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

impl Solver<'_> {
    /// The levels, should cycles for `modes` modes be better than the factor of K + sM. None for bodies whose factor is soon made,
    /// bodies that something holds, flat elements.
    pub(crate) fn levels_for(
        &self,
        modes: usize,
        ordered: &Ordered<'_>,
        progress: &mut dyn FnMut(Progress),
    ) -> Option<Levels> {
        let long = LONG * self.stiffness.ncols() as f64 * modes.max(FEW) as f64;
        if ordered.multiplications() <= long {
            return None;
        }
        // What refuses them is no reason to refuse the body.
        let levels = self.make_levels(modes, progress).ok().flatten()?;
        Some(Levels { ordering_time: levels.ordering_time + ordered.time(), ..levels })
    }

    /// The same of a body of any size.
    pub(crate) fn make_levels(
        &self,
        modes: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Levels>, ModalError> {
        let (Some(edge_ends), StiffnessMatrix::Nodal(stiffness), MassMatrix::Nodal(mass)) =
            (&self.edge_ends, self.stiffness, &self.mass)
        else {
            return Ok(None);
        };
        if !self.constraints.is_empty() {
            return Ok(None);
        }
        let started = Instant::now();
        let order = spatial_order(self.positions);
        let ends: Vec<[u32; 2]> =
            order.sorted(edge_ends).into_iter().map(|ends| ends.map(|node| order.place(node))).collect();
        let corners = Corners::new(&ends);
        if !corners.are_enough_for(davidson::start(modes)) || 2 * corners.count() > self.positions.len() {
            return Ok(None);
        }
        memory::check("K and M with the nodes in spatial order", 2 * self.matrix_bytes)?;
        let matrices = order.matrices(stiffness, mass);
        let Some(smoother) = Smoother::new(matrices.stiffness()) else { return Ok(None) };

        let coarse = corners.matrices(matrices.stiffness(), &matrices.mass());
        let positions = order.sorted(self.positions);
        let positions: Vec<[f64; 3]> = corners.nodes.iter().map(|node| positions[*node as usize]).collect();
        let constraints = Constraints::new(&Support::free(), &positions, 3)?;
        let stiffness = StiffnessMatrix::Nodal(coarse.stiffness());
        let mass = MassMatrix::Nodal(coarse.mass());
        let held =
            2 * self.matrix_bytes + smoother.bytes() + coarse.bytes() + of_vectors(self.stiffness.ncols(), FIXED);
        let memory = MemoryEstimate::new(stiffness, &mass, held, FIXED);
        let on_corners = Ordered::new(stiffness, &mass, self.shift()?, &constraints, &memory)?;
        let beside = modes_beside(modes, &corners);
        let factor = Shifted::factor(
            on_corners,
            &constraints,
            memory,
            |_| beside,
            |forecast| {
                progress(Progress::Factorizing(Forecast { on_corners: true, ..forecast }));
            },
        )?;
        let multigrid = Multigrid::new(&smoother, &corners, &factor)?;
        let left = left_by_cycle(StiffnessMatrix::Nodal(matrices.stiffness()), multigrid);
        if left.is_none_or(|left| left > LEFT_BY_CYCLE) {
            return Ok(None);
        }
        let ordering_time = factor.ordering_time;
        let time = started.elapsed().saturating_sub(ordering_time);
        Ok(Some(Levels { order, matrices, smoother, corners, coarse, factor, ordering_time, time }))
    }
}

/// The largest part of the strain energy of an error that a cycle leaves, after a few of them. None where one leaves more than
/// there was.
fn left_by_cycle(stiffness: StiffnessMatrix<'_>, mut multigrid: Multigrid<'_>) -> Option<f64> {
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
            return None;
        }
        left = parts.into_iter().fold(0.0, f64::max);
        before = now;
    }
    Some(left)
}
