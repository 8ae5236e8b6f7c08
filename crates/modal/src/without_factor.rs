//! The modes of a bulky body without the factor of K + sM.
//!
//! The factor of a thin body has few entries; that of a bulky one has so many that the search by multigrid cycles takes half
//! the time and a fifth of the memory.

use std::time::Instant;

use crate::columns::Columns;
use crate::coarse::Corners;
use crate::constraints::Constraints;
use crate::davidson;
use crate::error::ModalError;
use crate::foretold::{Foretold, of_vectors};
use crate::lanczos::{FIXED, largest_pairs, random_block};
use crate::mass_matrix::MassMatrix;
use crate::multigrid::Multigrid;
use crate::products::WIDTH;
use crate::progress::Progress;
use crate::ritz::{RitzPairs, rayleigh_ritz};
use crate::shifted::{Ordered, Shifted};
use crate::solve::{Modes, SolveStats, Solver};
use crate::spatial_order::SpatialOrder;
use crate::stiffness::StiffnessMatrix;
use crate::support::Support;

/// Multiplications from which on the factor of K + sM takes longer.
const LONG: f64 = 6e10;
/// Modes at the most: the basis of the search grows with them.
const MOST_MODES: usize = 24;
/// What a cycle leaves of the strain energy of an error at the most, and the cycles by which that is found. On compact elements
/// it leaves 0.2 to 0.5; of flat or stretched ones 0.95, and the search would take longer than the factor.
const LEFT_BY_CYCLE: f64 = 0.75;
const TRIAL_CYCLES: usize = 4;

impl Solver<'_> {
    /// The modes by multigrid cycles, or none where the factor of K + sM is the better way: of thin bodies, of those that
    /// something holds, of flat elements, for many modes.
    pub(crate) fn modes_without_factor(
        &self,
        flexible: usize,
        ordered: &Ordered<'_>,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Modes>, ModalError> {
        let is_for_it = flexible <= MOST_MODES && ordered.multiplications() > LONG;
        let found = if is_for_it { self.modes_by_cycles(flexible, progress)? } else { None };
        Ok(found.map(|mut modes| {
            modes.stats.ordering_time += ordered.time();
            modes
        }))
    }

    /// The same of a body of any size.
    pub(crate) fn modes_by_cycles(
        &self,
        flexible: usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Modes>, ModalError> {
        let (Some(edge_ends), StiffnessMatrix::Nodal(stiffness), MassMatrix::Nodal(mass)) =
            (&self.edge_ends, self.stiffness, &self.mass)
        else {
            return Ok(None);
        };
        if !self.constraints.is_empty() {
            return Ok(None);
        }

        let started = Instant::now();
        let order = SpatialOrder::new(self.positions);
        let ends = order.sorted(edge_ends).into_iter().map(|ends| ends.map(|node| order.place(node)));
        let corners = &Corners::new(&ends.collect::<Vec<_>>());
        if davidson::start(flexible) > 3 * corners.count() / 2 {
            return Ok(None);
        }
        memory::check("the matrices in spatial order", self.matrix_bytes)?;
        let reordered = order.matrices(stiffness, mass);
        let (stiffness, mass) = (reordered.stiffness(), reordered.mass());
        let coarse = corners.matrices(stiffness, &mass);
        let positions = order.sorted(self.positions);
        let positions: Vec<[f64; 3]> = corners.nodes.iter().map(|node| positions[*node as usize]).collect();
        let constraints = Constraints::new(&Support::free(), &positions, 3)?;
        let (coarse_stiffness, coarse_mass) =
            (StiffnessMatrix::Nodal(coarse.stiffness()), MassMatrix::Nodal(coarse.mass()));
        let memory = Foretold::new(coarse_stiffness, coarse.bytes(), FIXED);
        let on_corners = Ordered::new(coarse_stiffness, &coarse_mass, self.shift()?, &constraints, &memory)?;
        let ordering_time = on_corners.time();
        let nodes = self.positions.len();
        let beside = 2 * self.matrix_bytes
            + Multigrid::bytes(&stiffness.pairs(), corners.count())
            + of_vectors(3 * nodes, FIXED + davidson::room(flexible) + davidson::beside(flexible));
        let factor = Shifted::factor(
            on_corners,
            &constraints,
            memory,
            |_| beside,
            |forecast| {
                progress(Progress::Factorizing(forecast));
            },
        )?;
        let Some(mut multigrid) = Multigrid::new(stiffness, corners, &factor)? else { return Ok(None) };
        let (stiffness, mass) = (StiffnessMatrix::Nodal(stiffness), MassMatrix::Nodal(mass));
        if left_by_cycle(stiffness, &mut multigrid) > LEFT_BY_CYCLE {
            return Ok(None);
        }
        let factor_time = started.elapsed().saturating_sub(ordering_time);

        let started = Instant::now();
        let rigid = order.rows(self.rigid.shapes.as_ref());
        let at_corners = corners.at_corners(rigid.as_ref());
        let (wanted, available) = (davidson::start(flexible), 3 * corners.count() - rigid.ncols());
        let pairs = largest_pairs(&factor, &coarse_mass, at_corners.as_ref(), wanted, available, |_| ())?;
        let start = corners.prolonged(pairs.vectors.as_ref());
        let (rigid, start) = (rigid.as_ref(), start.as_ref());
        let pairs = davidson::lowest_pairs(stiffness, &mass, rigid, &mut multigrid, start, flexible, |converged| {
            progress(Progress::Lanczos { converged, requested: flexible });
        })?;
        let Some(pairs) = pairs else { return Ok(None) };
        let vectors = order.rows_of_nodes(pairs.vectors.as_ref());
        let lanczos_time = started.elapsed();

        let started = Instant::now();
        let RitzPairs { eigenvalues, shapes, force_residuals } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, &vectors)?;
        self.refuse_soft(&eigenvalues, &shapes, factor.shift)?;
        let stats = SolveStats {
            shift: factor.shift,
            unknowns: shapes.nrows(),
            factor_entries: factor.entries(),
            peak_bytes: factor.memory.peak(beside),
            block_solves: pairs.block_solves,
            basis_size: pairs.basis_size,
            cycles: pairs.block_solves,
            preparation_time: self.preparation_time(),
            ordering_time,
            factor_time,
            lanczos_time,
            ritz_time: started.elapsed(),
            engine: None,
        };
        let (rigid, residuals) = (self.rigid.clone(), pairs.residuals);
        Ok(Some(Modes { rigid, eigenvalues, shapes, residuals, force_residuals, stats }))
    }
}

/// The largest part of the strain energy of random displacements that a cycle leaves, after a few of them.
fn left_by_cycle(stiffness: StiffnessMatrix<'_>, multigrid: &mut Multigrid<'_>) -> f64 {
    let mut error = random_block(stiffness.ncols(), WIDTH, &mut 1);
    let mut before = vec![f64::INFINITY; error.ncols()];
    let mut left = 0.0;
    for _ in 0..=TRIAL_CYCLES {
        let mut forces = stiffness.product(error.as_ref());
        let energies: Vec<f64> = error.col_iter().zip(forces.col_iter()).map(|(e, f)| e.transpose() * f).collect();
        left = energies.iter().zip(&before).map(|(now, before)| now / before).fold(0.0, f64::max);
        before = energies;
        multigrid.apply(forces.as_mut());
        error -= forces;
    }
    left
}
